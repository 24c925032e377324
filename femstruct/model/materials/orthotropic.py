"""Linear elastic, orthotropic materials: timber, fibre composites, corrugated and cored boards."""

from __future__ import annotations

from dataclasses import dataclass

from femstruct.arrays import Floats, freeze
from femstruct.declared import checked
from femstruct.elements import elasticity
from femstruct.errors import InputError
from femstruct.model.material import Material
from femstruct.model.materials.loss_by_frequency import Loss
from femstruct.tags import stored_as


@stored_as("orthotropic material/1")
@dataclass(frozen=True)
@checked("materials")
class Orthotropic:
    """Linear elastic orthotropic material by nine constants along its own axes x, y, z, z being across a plate.

    E : Young's moduli (Ex, Ey, Ez) [Pa]; (Ex, Ey) has Ez = Ey. G : shear moduli (Gxy, Gyz, Gzx) [Pa]; (Gxy, Gyz) has
    Gzx = Gxy. Gyz is the rolling shear of timber, which decides how crosswise layers shear, and is never guessed.
    nu : (nuxy, nuyz, nuzx) [1], nuij being the contraction along j under stress along i, so nuxy / Ex = nuyx / Ey; a
    number alone is nuxy, with nuyz = nuxy and nuzx = nuxy Ez / Ex (nuxz = nuxy). rho : density [kg/m^3]. loss_factor :
    eta in K (1 + j eta) [1], one number or a table by frequency. completed : the constants that were not given, with
    what they follow from. A plate uses Ex, Ey, nuxy and the shear moduli; a solid uses all.

    Raises InputError for moduli that are not positive, and for ratios with which the elastic energy could be
    negative, with both numbers.

    >>> spruce = Orthotropic("spruce", E=(11e9, 370e6), G=(690e6, 69e6), nu=0.35, rho=420.0)
    >>> spruce.E[2] / 1e6, spruce.completed
    (370.0, ('Ez = Ey', 'Gzx = Gxy', 'nuyz = nuxy', 'nuzx = nuxy Ez / Ex'))
    """

    name: str
    E: tuple[float, ...]
    G: tuple[float, ...]
    nu: float | tuple[float, ...]
    rho: float
    loss_factor: Loss = 0.0
    completed: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        where = f"materials.{self.name}"
        for key, values in (("E", self.E), ("G", self.G)):
            if len(values) not in (2, 3) or not all(value > 0 for value in values):
                got = f"({', '.join(f'{one:g}' for one in values)}) Pa"
                raise InputError(f"{where}.{key}", got=got, expected="two or three positive moduli")
        E, G, completed = self.E, self.G, list(self.completed)
        if len(E) == 2:
            E, completed = (*E, E[1]), [*completed, "Ez = Ey"]
        if len(G) == 2:
            G, completed = (*G, G[0]), [*completed, "Gzx = Gxy"]
        nu = self.nu if isinstance(self.nu, tuple) else (self.nu,)
        if len(nu) == 1:
            nu = (nu[0], nu[0], nu[0] * E[2] / E[0])
            completed += ["nuyz = nuxy", "nuzx = nuxy Ez / Ex"]
        if len(nu) != 3:
            raise InputError(f"{where}.nu", got=f"{len(nu)} ratios", expected="nuxy, or nuxy, nuyz and nuzx")
        freeze(self, E=E, G=G, nu=nu, completed=tuple(completed))
        Material(
            self.name, E=min(E), nu=0.0, rho=self.rho, loss_factor=self.loss_factor
        )  # refuses what no material has
        try:
            elasticity.stiffness(self.E, self.G, self.ratios)  # refuses ratios that would give energy away
        except InputError as error:
            raise InputError(f"{where}.nu", got=error.got, expected=error.expected, do=error.do) from None

    @property
    def ratios(self) -> tuple[float, float, float]:
        """nuxy, nuyz, nuzx [1]."""
        xy, yz, zx = self.nu if isinstance(self.nu, tuple) else (self.nu,) * 3
        return xy, yz, zx

    @property
    def elasticity(self) -> Floats:
        """Stresses xx yy zz xy yz zx [6, 6] in Pa of unit strains along its axes, for solids."""
        return elasticity.stiffness(self.E, self.G, self.ratios)


AnyMaterial = Material | Orthotropic
