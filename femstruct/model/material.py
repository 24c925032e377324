"""Linear elastic, isotropic materials."""

from __future__ import annotations

from dataclasses import dataclass

from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.model.materials.loss_by_frequency import Loss, check_loss
from femstruct.tags import stored_as

DENSEST = 23_000.0
"""Density [kg/m^3] that no solid exceeds: osmium has 22 600."""
IMPOSSIBLE = 1e5  # kg/m^3: beyond it a density is none, not even that of a sheet that stands for what it carries


@stored_as("material/1")
@dataclass(frozen=True)
@checked("materials")
class Material:
    """Linear elastic isotropic material.

    E : Young's modulus [Pa]. nu : Poisson's ratio [1]. rho : density [kg/m^3]. loss_factor : eta in K (1 + j eta) [1],
    one number or a table by frequency. completed : what was taken from the library, with the works that print it.

    Raises InputError for values that cannot be: E not above zero, nu not between -1 and 0.5, a density below zero
    or beyond 1e5 kg/m^3, a loss factor below zero or beyond 1.5.

    >>> round(Material("steel", E=210e9, nu=0.3, rho=7850.0).G / 1e9, 2)
    80.77
    """

    name: str
    E: float
    nu: float
    rho: float
    loss_factor: Loss = 0.0
    completed: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        where = f"materials.{self.name}"
        if not self.E > 0:
            raise InputError(f"{where}.E", got=f"{self.E:g} Pa", expected="a positive modulus")
        if not -1 < self.nu < 0.5:
            raise InputError(f"{where}.nu", got=f"{self.nu:g}", expected="a Poisson's ratio between -1 and 0.5")
        if not self.rho >= 0:
            raise InputError(f"{where}.rho", got=f"{self.rho:g} kg/m^3", expected="a density >= 0")
        if not self.rho <= IMPOSSIBLE:
            raise InputError(
                f"{where}.rho",
                got=f"{self.rho:g} kg/m^3",
                expected=f"a density; the densest solid has {DENSEST:.0f} kg/m^3",
                do="plain numbers are kg/m^3" + (f": {self.rho / 1e3:g}?" if self.rho <= 1e3 * DENSEST else ""),
            )
        check_loss(f"{where}.loss_factor", self.loss_factor)

    @property
    def G(self) -> float:
        """Shear modulus E / 2(1 + nu) [Pa]."""
        return self.E / (2.0 * (1.0 + self.nu))
