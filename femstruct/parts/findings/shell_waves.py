"""Cells of shells beside the bending waves of the highest frequency."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.model.model import Model
from femstruct.parts.of_meshes.shell_mesh import ShellMesh

CELLS = 8.0  # linear cells a bending wave: 2.6 % too high along the sides, (k h)^2 / 24, 1.7 % too low aslant
NO_WAVE = 2.0  # cells a wave below which it is none any more


def shells_of(model: Model) -> list[ShellMesh]:
    """The shells of a model."""
    return [part for part in model.parts.values() if isinstance(part, ShellMesh)]


def shell_mesh_findings(model: Model, up_to_hz: float) -> list[Finding]:
    """Shells with cells that are too long for the bending waves of a frequency."""
    found = []
    for shell in shells_of(model) if 0.0 < up_to_hz < np.inf else ():
        waves, sides = bending_wavelengths(shell, up_to_hz), shell.cells.longest_sides
        worst = int(np.argmin(waves / sides))
        wave, side = float(waves[worst]), float(sides[worst])
        if wave / side < CELLS:
            few = int((waves / sides < CELLS).sum())
            found.append(
                Finding(
                    "coarse-mesh",
                    f"{shell.name}: the bending wavelength at {up_to_hz:.4g} Hz is {1e3 * wave:.0f} mm where a cell "
                    f"has a side of {1e3 * side:.0f} mm: {wave / side:.1f} cells a wavelength, {CELLS:g} are needed. "
                    f"{few} of {len(sides)} cells are too long. Use cells of {1e3 * wave / CELLS:.3g} mm or less",
                    {"wavelength_m": wave, "cell_m": side},
                    severe=wave / side < NO_WAVE,
                )
            )
    return found


def carried_by_cells_hz(shell: ShellMesh) -> float:
    """The highest frequency that all cells of a shell are short enough for [Hz], shear left out."""
    of = shell.sections
    ratio = bending_wavelengths(shell, 1.0, shear=False) / shell.cells.longest_sides
    return float(((ratio / CELLS) ** 2).min()) if (of.m0 > 0.0).all() else np.inf


def bending_wavelengths(shell: ShellMesh, frequency_hz: float, shear: bool = True) -> Floats:
    """Lengths of free bending waves in each cell [q + t] [m], the shorter of those along the two axes of the cell, with
    transverse shear or without; infinite without mass."""
    of = shell.sections
    return wavelengths(of.D, of.As, of.m0, frequency_hz, shear)


def wavelengths(D: Floats, As: Floats, m0: Floats, frequency_hz: float, shear: bool = True) -> Floats:
    """The same of sections: D [n, 3, 3] [N m], As [n, 2, 2] [N/m], m0 [n] [kg/m^2].

    Notes
    -----
    k^2 = omega^2 a / 2 + sqrt(omega^4 a^2 / 4 + omega^2 m0 / D) with a = m0 / As; rotary inertia is left out.
    """
    omega = 2.0 * np.pi * frequency_hz
    D = np.minimum(D[:, 0, 0], D[:, 1, 1])
    a = m0 / np.minimum(As[:, 0, 0], As[:, 1, 1]) if shear else np.zeros_like(D)
    squared = omega**2 * a / 2.0 + np.sqrt(omega**4 * a**2 / 4.0 + omega**2 * m0 / D)
    with np.errstate(divide="ignore"):
        lengths: Floats = 2.0 * np.pi / np.sqrt(squared)
    return lengths
