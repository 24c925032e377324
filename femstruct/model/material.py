"""Linear elastic, isotropic materials."""

from __future__ import annotations

from dataclasses import dataclass

from femstruct.errors import FemstructError


@dataclass(frozen=True)
class Material:
    """Linear elastic isotropic material.

    E : Young's modulus [Pa]. nu : Poisson's ratio [1]. rho : density [kg/m^3]. loss_factor : eta in K (1 + j eta) [1].

    >>> round(Material("steel", E=210e9, nu=0.3, rho=7850.0).G / 1e9, 2)
    80.77
    """

    name: str
    E: float
    nu: float
    rho: float
    loss_factor: float = 0.0

    def __post_init__(self) -> None:
        where = f"materials.{self.name}"
        if not self.E > 0:
            raise FemstructError(f"{where}.E", got=f"{self.E:g} Pa", expected="a positive modulus")
        if not -1 < self.nu < 0.5:
            raise FemstructError(f"{where}.nu", got=f"{self.nu:g}", expected="a Poisson's ratio between -1 and 0.5")
        if not self.rho >= 0:
            raise FemstructError(f"{where}.rho", got=f"{self.rho:g} kg/m^3", expected="a density >= 0")
        if not self.loss_factor >= 0:
            raise FemstructError(f"{where}.loss_factor", got=f"{self.loss_factor:g}", expected="a loss factor >= 0")

    @property
    def G(self) -> float:
        """Shear modulus E / 2(1 + nu) [Pa]."""
        return self.E / (2.0 * (1.0 + self.nu))
