"""What a plate or a shell is per area: rigidities, mass and loss factor, whatever it is made of."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from femstruct.arrays import Floats, freeze, frozen
from femstruct.elements import laminate
from femstruct.model.materials.loss_by_frequency import Loss, of_plate

COUPLED = 1e-9  # of what B could be: beyond the rounding of a lay-up that is the same from above and below


@dataclass(frozen=True, eq=False)
class SectionShare:
    """What layers of one loss factor have of the energy of a plate: their part of its A, B, D and As.

    name : of their materials. loss_factor [1]. The parts of all layers sum to the rigidities of the plate.

    >>> from femstruct.model.material import Material
    >>> from femstruct.model.materials.lay_up import Laminate, Layer
    >>> skin, core = Material("skin", 30e9, 0.2, 2400.0, 0.01), Material("core", 5e9, 0.2, 800.0, 0.1)
    >>> shares = Laminate((Layer(skin, 0.01), Layer(core, 0.1), Layer(skin, 0.01))).section.shares
    >>> [(one.name, one.loss_factor, round(float(one.A[2, 2]) / 1e6)) for one in shares]
    [('skin', 0.01, 250), ('core', 0.1, 208)]
    """

    name: str
    loss_factor: Loss
    A: Floats
    B: Floats
    D: Floats
    As: Floats

    def __post_init__(self) -> None:
        matrices = {name: frozen(f"SectionShare {name}", getattr(self, name), (3, 3)) for name in ("A", "B", "D")}
        freeze(self, **matrices, As=frozen("SectionShare As", self.As, (2, 2)))

    def about(self, offset: float) -> SectionShare:
        """As `PlateSection.about`."""
        return replace(self, **_about(self, offset))

    def turned(self, angle: float) -> SectionShare:
        """As `PlateSection.turned`."""
        return replace(self, **_turned(self, angle))


@dataclass(frozen=True, eq=False)
class PlateSection:
    """Rigidities and masses of a plate per area, about its reference surface, along its own axes x and y.

    A [3, 3] [N/m], B [3, 3] [N], D [3, 3] [N m] : (N, M) of membrane strains (eps_x, eps_y, gamma_xy) and curvatures.
    As [2, 2] : transverse shear stiffness of (gamma_xz, gamma_yz) [N/m], from the lay-up: no correction is to be added.
    m0 [kg/m^2], m1 [kg/m], m2 [kg] : mass per area and its moments. low, high : heights of its faces above the
    reference surface [m], which is in the middle unless it was moved (`about`). loss_factor, shear_loss_factor : of
    bending and of transverse shear, the layers weighted by their share of its energy [1], for what asks for one
    number. shares : of layers by their loss factor, of layers that lose differently: in its modes each loses by its
    part of the energy of any motion.

    >>> from femstruct.model.material import Material
    >>> from femstruct.model.materials.lay_up import section_of
    >>> slab = section_of(Material("concrete", E=30e9, nu=0.2, rho=2400.0), 0.18)
    >>> round(float(slab.D[0, 0]) / 1e6, 4), round(slab.m0, 1), round(float(slab.As[0, 0]) / 1e9, 4)
    (15.1875, 432.0, 1.875)
    """

    A: Floats
    B: Floats
    D: Floats
    As: Floats
    m0: float
    m1: float
    m2: float
    low: float
    high: float
    loss_factor: Loss
    shear_loss_factor: Loss
    shares: tuple[SectionShare, ...] = ()

    def __post_init__(self) -> None:
        matrices = {name: frozen(f"PlateSection {name}", getattr(self, name), (3, 3)) for name in ("A", "B", "D")}
        losses = {name: of_plate(getattr(self, name), self.m0) for name in ("loss_factor", "shear_loss_factor")}
        freeze(self, **matrices, **losses, As=frozen("PlateSection As", self.As, (2, 2)))

    @property
    def thickness(self) -> float:
        """From face to face [m]."""
        return self.high - self.low

    @property
    def coupled(self) -> bool:
        """Whether it bends when it is stretched: its reference surface is not its neutral surface."""
        return float(np.abs(self.B).max()) > COUPLED * float(np.abs(self.A).max()) * self.thickness

    @property
    def bending(self) -> Floats:
        """Bending rigidity [3, 3] of a plate that nothing holds in its plane [N m]: D - B A^-1 B, about its neutral
        surface."""
        return laminate.free_to_stretch(self.A, self.B, self.D) if self.coupled else self.D

    def bending_of(self, share: SectionShare) -> Floats:
        """Part [3, 3] of layers in the energy of `bending` [N m]."""
        if not self.coupled:
            return share.D
        stretch = -np.linalg.solve(self.A, self.B)
        part: Floats = stretch.T @ share.A @ stretch + stretch.T @ share.B + share.B @ stretch + share.D
        return (part + part.T) / 2.0

    def stretching(self, angle: float = 0.0) -> float:
        """Membrane stiffness along a direction at an angle from x [rad], its sides free to draw in [N/m]: E h."""
        return float(1.0 / np.linalg.inv(laminate.turned(self.A, -angle))[0, 0])

    def about(self, offset: float) -> PlateSection:
        """The same about a reference surface from which its own is `offset` away along z [m]."""
        return replace(
            self,
            **_about(self, offset),
            shares=tuple(one.about(offset) for one in self.shares),
            m1=self.m1 + offset * self.m0,
            m2=self.m2 + 2.0 * offset * self.m1 + offset**2 * self.m0,
            low=self.low + offset,
            high=self.high + offset,
        )

    def turned(self, angle: float) -> PlateSection:
        """The same along axes from which its own x is turned by an angle about z [rad]."""
        return replace(self, **_turned(self, angle), shares=tuple(one.turned(angle) for one in self.shares))


def _about(of: PlateSection | SectionShare, offset: float) -> dict[str, Any]:
    return {"B": of.B + offset * of.A, "D": of.D + 2.0 * offset * of.B + offset**2 * of.A}


def _turned(of: PlateSection | SectionShare, angle: float) -> dict[str, Any]:
    in_plane = {name: laminate.turned(getattr(of, name), angle) for name in ("A", "B", "D")}
    return {**in_plane, "As": laminate.turned_shear(of.As, angle)}
