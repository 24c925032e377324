"""Slips of the unit of length of a mesh from a file, by its size, mass, thickness and the sides of its cells."""

from __future__ import annotations

from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.model.imported.flat_cells import FlatCells
from femstruct.model.imported.imported_mesh import ImportedMesh

# Typical side of a cell over the thickness: sheet metal of 0.5 mm in cells of 50 mm has 100, a wall of 200 mm in cells
# of 20 mm a tenth; a mesh in millimetres that is read as metres has a thousand times as much.
WIDEST, NARROWEST = 200.0, 0.05
LARGEST, SMALLEST = 200.0, 2e-3  # largest side of the box round a part [m]: a large building, a chip
LEAST_SHELL: Final = 0.05  # m: as a structure that is struck; a shell of less is asked for its unit, not its thickness
HEAVIEST: Final = 1e7  # kg of a solid: a block of concrete of 16 m a side, or one of steel of 11 mm read as metres
HEAVIEST_SHELL: Final = 5e3  # kg/m^2, thickness from the file: 2 m of concrete; 0.7 mm of steel read as metres has more
MM: Final = 1e-3


def shell_slips(
    name: str, mesh: ImportedMesh, cells: FlatCells, thickness: Floats, mass: float, stated: bool
) -> tuple[Finding, ...]:
    """A shell that is too large or too heavy, or whose cells do not fit its thickness.

    thickness : of each cell [m]. mass [kg]. stated : whether the thickness is from the file, in its unit.
    """
    size, t = _size(cells.points), float(np.median(thickness))
    area = float(cells.areas.sum())
    if size > LARGEST or (stated and mass / area > HEAVIEST_SHELL):
        thick = f" and {t:.4g} m thick" if stated else ""
        to_mm = MM / mesh.scale
        then = f" and {1e3 * t * to_mm:.4g} mm thick" if stated else ""
        return (_too_large(name, mesh, size, mass, mass * to_mm ** (3 if stated else 2), thick, then),)
    side = float(np.median(np.sqrt(cells.areas)))
    ratio = side / t
    if NARROWEST <= ratio <= WIDEST:
        return ()
    meant = _meant_thickness(size, side, t, ratio)
    other = size * (MM if ratio > WIDEST else 1.0) / mesh.scale
    if other != size and LEAST_SHELL <= other <= LARGEST:
        meant.append("'scale: mm' for a file in millimetres" if ratio > WIDEST else "no 'scale' for a file in metres")
    advice = f"Did you mean {', or '.join(meant)}?" if meant else "Check the thickness"
    return (
        Finding(
            "mesh-in-other-units",
            f"{name}: the mesh is {size:.4g} m large. A typical cell has sides of {side:.4g} m, {ratio:.3g} times the "
            f"thickness of {t:.4g} m. {advice}",
            {"size_m": size, "side_m": side, "times_the_thickness": ratio},
        ),
    )


def _meant_thickness(size: float, side: float, t: float, ratio: float) -> list[str]:
    """A thickness in millimetres that fits cells of a mesh of a plausible size."""
    fits = ratio < NARROWEST and NARROWEST <= side / (MM * t) <= WIDEST
    return [f"a thickness of {t:.4g} mm"] if fits and size >= LEAST_SHELL else []


def solid_slips(name: str, mesh: ImportedMesh, points: Floats, mass: float) -> tuple[Finding, ...]:
    """A solid that is too large, too small or too heavy. points [n, 3] : its nodes [m]. mass [kg]."""
    size = _size(points)
    if size > LARGEST or mass > HEAVIEST:
        return (_too_large(name, mesh, size, mass, mass * (MM / mesh.scale) ** 3),)
    if size >= SMALLEST:
        return ()
    meant = "Did you mean no 'scale' for a file in metres?" if mesh.scale != 1.0 else "Check its 'scale'"
    return (Finding("mesh-in-other-units", f"{name}: the mesh is {size:.4g} m large. {meant}", {"size_m": size}),)


def in_millimetres(mesh: ImportedMesh, points: Floats) -> str:
    """What to do about a place that is not on a mesh: another unit of length where its size asks for one, else ""."""
    size = _size(points)
    if size <= LARGEST:
        return ""
    do = "write 'scale: mm' for a file in millimetres" if _fits_in_mm(mesh, size) else "check its 'scale'"
    return f"the mesh is {size:.4g} m large; {do}"


def _size(points: Floats) -> float:
    return float(np.ptp(points, axis=0).max())


def _too_large(
    name: str, mesh: ImportedMesh, size: float, mass: float, mass_in_mm: float, thick: str = "", then: str = ""
) -> Finding:
    in_mm = size * MM / mesh.scale
    return Finding(
        "mesh-in-other-units",
        f"{name}: the mesh is {size:.4g} m large{thick} as read, with {mass:.4g} kg; in millimetres it would be "
        f"{in_mm:.4g} m{then}, with {mass_in_mm:.4g} kg. {_advice(mesh, size)}",
        {"size_m": size, "size_if_in_mm_m": in_mm, "mass_kg": mass},
    )


def _advice(mesh: ImportedMesh, size: float) -> str:
    return "Did you mean 'scale: mm'?" if _fits_in_mm(mesh, size) else f"Check its 'scale', which is {mesh.scale:g} m"


def _fits_in_mm(mesh: ImportedMesh, size: float) -> bool:
    return SMALLEST <= size * MM / mesh.scale <= LARGEST and mesh.scale != MM
