"""Cells of solids beside the shortest waves of the highest frequency: shear waves, and bending waves of thin ones."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.model.imported.cell_kinds import KINDS
from femstruct.model.material import Material
from femstruct.model.model import Model
from femstruct.parts.of_meshes.solid_mesh import SolidMesh

LINEAR, QUADRATIC = 16.0, 8.0
"""Cells a wave: with fewer, bending frequencies of hex8 are more than 2 % too high, those of hex20 more than 1.5 %."""
NO_WAVE = 2.0  # cells a wave below which it is none any more


def solids_of(model: Model) -> list[SolidMesh]:
    """The solids of a model."""
    return [part for part in model.parts.values() if isinstance(part, SolidMesh)]


def solid_mesh_findings(model: Model, up_to_hz: float) -> list[Finding]:
    """Solids with cells that are too long for the waves of a frequency."""
    found = []
    for solid in solids_of(model) if 0.0 < up_to_hz < np.inf else ():
        wave, ratios, sides = shortest_wave(solid, up_to_hz), *_cells(solid)
        worst = int(np.argmax(sides * ratios))
        side, needed = float(sides[worst]), float(ratios[worst])
        if wave < needed * side:
            few = int((wave < ratios * sides).sum())
            found.append(
                Finding(
                    "coarse-mesh",
                    f"{solid.name}: the shortest waves at {up_to_hz:.4g} Hz are {1e3 * wave:.0f} mm long and the "
                    f"longest side of a cell {1e3 * side:.0f} mm: {wave / side:.1f} cells a wavelength, {needed:g} are "
                    "needed. "
                    f"{few} of {len(sides)} cells are too long. Use cells of {1e3 * wave / needed:.3g} mm or less",
                    {"wavelength_m": wave, "cell_m": side},
                    severe=wave / side < NO_WAVE,
                )
            )
    return found


def carried_by_solid_hz(solid: SolidMesh) -> float:
    """The highest frequency that all cells of a solid are short enough for [Hz]; infinite without mass."""
    if not solid.part.material.rho > 0.0:
        return np.inf
    ratios, sides = _cells(solid)
    longest = float((ratios * sides).max())
    shear, bending = _waves(solid)
    return min(shear / longest, (bending / longest) ** 2)


def shortest_wave(solid: SolidMesh, frequency_hz: float) -> float:
    """Length of the shorter of shear waves and, in a plate of its mean thickness, bending waves [m]; infinite without
    mass. The mean thickness is twice the volume over the area of its faces, which is on the safe side for bars."""
    if not solid.part.material.rho > 0.0:
        return np.inf
    shear, bending = _waves(solid)
    return min(shear / frequency_hz, float(bending / np.sqrt(frequency_hz)))


def _waves(solid: SolidMesh) -> tuple[float, float]:
    """Lengths of shear and of bending waves at 1 Hz [m]."""
    material, cells = solid.part.material, solid.cells
    E, G = (material.E, material.G) if isinstance(material, Material) else (min(material.E), min(material.G))
    thickness = 2.0 * sum(float(one.sum()) for one in cells.volumes.values()) / float(cells.facets.areas.sum())
    return float(np.sqrt(G / material.rho)), float((np.pi**2 * E * thickness**2 / (3.0 * material.rho)) ** 0.25)


def _cells(solid: SolidMesh) -> tuple[Floats, Floats]:
    """Cells a wave that each cell needs, and the longest of its edges [m]."""
    needed, sides = [], []
    for kind, nodes in solid.cells.cells.items():
        known = KINDS[kind]
        first, second = (solid.places[nodes[:, list(ends)]] for ends in zip(*known.edges, strict=True))
        sides.append(np.linalg.norm(second - first, axis=2).max(axis=1))
        needed.append(np.full(len(nodes), QUADRATIC if known.quadratic else LINEAR))
    return np.concatenate(needed), np.concatenate(sides)
