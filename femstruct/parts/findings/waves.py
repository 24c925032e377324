"""Meshes and theories beside the waves of the highest frequency: cells and bars that are too long, plates too thick."""

from __future__ import annotations

import numpy as np

from femstruct.elements.plate import rigidity
from femstruct.errors import Finding
from femstruct.model.material import Material
from femstruct.model.model import Model
from femstruct.parts.findings.frame_waves import frame_waves
from femstruct.parts.frame import FrameMesh, frames_of
from femstruct.parts.plate import PlateMesh, plates_of

CELLS_PER_WAVE = 6.0  # bending wavelengths of bfs16 and acm12 are right to about 1 % with six cells
NO_WAVE = 2.0  # cells a wave below which it is none any more: modes there are those of the mesh
SLENDER = 10.0  # bending wavelength over thickness below which shear takes more than about 3 % off a frequency


def mesh_findings(model: Model, up_to_hz: float) -> tuple[Finding, ...]:
    """Plates and frames whose cells and bars are too long, and plates that are too thick, for the waves of the highest
    frequency."""
    found = []
    for frame in frames_of(model) if 0.0 < up_to_hz < np.inf else ():
        found += _long_bars(frame, up_to_hz)
    for plate in plates_of(model):
        name = plate.name
        wave = bending_wavelength(plate, up_to_hz)
        cell = float(max(np.diff(plate.x).max(), np.diff(plate.y).max()))
        if wave / cell < CELLS_PER_WAVE:
            found.append(
                Finding(
                    "coarse-mesh",
                    f"{name}: the bending wavelength at {up_to_hz:.4g} Hz is {1e3 * wave:.0f} mm and the largest cell "
                    f"{1e3 * cell:.0f} mm: {wave / cell:.1f} cells a wavelength, {CELLS_PER_WAVE:g} are needed. "
                    f"Use cells of {1e3 * wave / CELLS_PER_WAVE:.3g} mm or less",
                    {"wavelength_m": wave, "cell_m": cell},
                    severe=wave / cell < NO_WAVE,
                )
            )
        if wave / plate.part.thickness < SLENDER:
            denser = with_shear(plate.part.material, plate.part.thickness, up_to_hz)[1]
            found.append(
                Finding(
                    "thick-for-short-waves",
                    f"{name}: the bending wavelength at {up_to_hz:.4g} Hz is {wave / plate.part.thickness:.1f} times "
                    f"the thickness; {SLENDER:g} times is asked for. The theory of thin plates leaves out shear: there "
                    f"its modal density is too low by a factor of {denser:.3g}, and levels of a blow by up to "
                    f"{10 * np.log10(denser):.1f} dB; less at lower frequencies",
                    {"wavelength_m": wave, "thickness_m": plate.part.thickness, "density_ratio": denser},
                )
            )
    return tuple(found)


def _long_bars(frame: FrameMesh, up_to_hz: float) -> list[Finding]:
    """The kind of wave that a frame has the fewest bars for, beside what it takes."""
    longest = float(frame.lengths.max())
    waves = [wave for wave in frame_waves(frame) if wave.length(up_to_hz) < wave.needed * longest]
    if not waves:
        return []
    worst = min(waves, key=lambda wave: wave.length(up_to_hz) / wave.needed)
    length = worst.length(up_to_hz)
    return [
        Finding(
            "coarse-mesh",
            f"{frame.part.name}: the {worst.kind} wavelength at {up_to_hz:.4g} Hz is {1e3 * length:.0f} mm and the "
            f"longest bar {1e3 * longest:.0f} mm: {length / longest:.2f} bars a wavelength, {frame.part.element} needs "
            f"{worst.needed:g}. Use bars of {1e3 * length / worst.needed:.3g} mm or less",
            {"wavelength_m": length, "bar_m": longest},
        )
    ]


def with_shear(material: Material, thickness: float, frequency_hz: float) -> tuple[float, float]:
    """Wavenumber and density of modes of a Mindlin plate (shear factor 5/6) over those of a thin one at a frequency.

    Notes
    -----
    k^2 = omega^2 (a + b) / 2 + sqrt(omega^4 (a - b)^2 / 4 + omega^2 rho h / D) with a = rho / (5/6 G) and
    b = rho (1 - nu^2) / E; modes are as dense as k^2 grows with omega.
    """
    omega = 2.0 * np.pi * frequency_hz
    a = material.rho / (5.0 / 6.0 * material.G)
    b = material.rho * (1.0 - material.nu**2) / material.E
    thin = material.rho * thickness / rigidity(material.E, material.nu, thickness)[0, 0]
    root = np.sqrt(omega**4 * (a - b) ** 2 / 4.0 + omega**2 * thin)
    squared = omega**2 * (a + b) / 2.0 + root
    growth = omega * (a + b) + (omega**3 * (a - b) ** 2 / 2.0 + omega * thin) / root
    return float(np.sqrt(squared / (omega * np.sqrt(thin)))), float(growth / np.sqrt(thin))


def carried_hz(model: Model) -> float:
    """The highest frequency that all plates and frames have cells and bars enough for [Hz]; infinite without any."""
    carried = [np.inf]
    for frame in frames_of(model):
        carried += [wave.carried_hz(float(frame.lengths.max())) for wave in frame_waves(frame)]
    for plate in plates_of(model):
        cell = float(max(np.diff(plate.x).max(), np.diff(plate.y).max()))
        carried.append((bending_wavelength(plate, 1.0) / (CELLS_PER_WAVE * cell)) ** 2)
    return min(carried)


def bending_wavelength(plate: PlateMesh, frequency_hz: float) -> float:
    """Length of a free bending wave of a thin plate [m]: 2 pi (D / rho h omega^2)^(1/4); infinite without mass."""
    part = plate.part
    if part.material.rho == 0.0:
        return np.inf
    stiffness = rigidity(part.material.E, part.material.nu, part.thickness)[0, 0]
    omega = 2.0 * np.pi * frequency_hz
    return float(2.0 * np.pi * (stiffness / (part.material.rho * part.thickness * omega**2)) ** 0.25)
