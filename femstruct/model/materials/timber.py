"""Structural timber by strength class."""

from __future__ import annotations

from typing import Final

from femstruct.model.materials.loss_by_frequency import Loss
from femstruct.model.materials.orthotropic import Orthotropic

SOURCE: Final = "EN 338"
ROLLING: Final = 0.1
"""Rolling shear over shear modulus, the usual assumption. Measured on boards: 65 to 101 MPa (cedar and cypress,
doi:10.1186/s10086-021-01954-y, table 5); it is the least known number of cross-laminated timber."""
NU: Final = 0.35
"""Poisson's ratio, for which the standard has none; plates hardly depend on it."""
_MEANS: Final = {  # E along and across the grain, shear modulus [MPa], density [kg/m^3], all means
    "C18": (9000.0, 300.0, 560.0, 380.0),
    "C24": (11000.0, 370.0, 690.0, 420.0),
    "C30": (12000.0, 400.0, 750.0, 460.0),
}
CLASSES: Final = tuple(_MEANS)


def timber(
    name: str,
    strength_class: str,
    G: tuple[float, ...] | None = None,
    rho: float | None = None,
    loss_factor: Loss = 0.0,
) -> Orthotropic:
    """Softwood of a strength class, x along the grain, with the means of EN 338 as makers print them (KVH structural
    timber, kvh.eu, "Strength, rigidity and density characteristics"); what the standard does not say is `completed`.

    G, rho : in place of those of the class, where they are known better.

    >>> spruce = timber("boards", "C24")
    >>> spruce.E[:2], spruce.G[1], spruce.rho
    ((11000000000.0, 370000000.0), 69000000.0, 420.0)
    >>> spruce.completed
    ('C24 of EN 338', 'Ez = Ey', 'Gyz = 0.1 Gxy', 'Gzx = Gxy', 'nuxy = nuyz = nuxz = 0.35')
    """
    along, across, shear, density = _MEANS[strength_class]
    completed = [f"{strength_class} of {SOURCE}", "Ez = Ey", f"nuxy = nuyz = nuxz = {NU:g}"]
    if G is None:
        G, completed[2:2] = (1e6 * shear, 1e6 * ROLLING * shear, 1e6 * shear), [f"Gyz = {ROLLING:g} Gxy", "Gzx = Gxy"]
    E = (1e6 * along, 1e6 * across, 1e6 * across)
    nu = (NU, NU, NU * across / along)
    return Orthotropic(name, E, G, nu, density if rho is None else rho, loss_factor, tuple(completed))
