"""Meshes and theories beside the waves of the highest frequency: cells and bars that are too long, plates too thick."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats
from femstruct.elements import laminate
from femstruct.errors import Finding
from femstruct.model.material import Material
from femstruct.model.materials.lay_up import section_of
from femstruct.model.materials.plate_section import PlateSection
from femstruct.model.model import Model
from femstruct.model.part import Part
from femstruct.parts.findings.frame_waves import frame_waves
from femstruct.parts.findings.shell_waves import CELLS, carried_by_cells_hz, shell_mesh_findings, shells_of, wavelengths
from femstruct.parts.findings.solid_waves import carried_by_solid_hz, solid_mesh_findings, solids_of
from femstruct.parts.of_frames.frame_mesh import FrameMesh, frames_of
from femstruct.parts.of_plates.plate_mesh import PlateMesh, plates_of
from femstruct.parts.plate import Plate
from femstruct.parts.slab import Slab

CELLS_PER_WAVE = 6.0  # bending wavelengths of bfs16 and acm12 are right to about 1 % with six cells
NO_WAVE = 2.0  # cells a wave below which it is none any more: modes there are those of the mesh
SLENDER = (
    10.0  # bending wavelength over thickness below which shear takes more than 3 % off a wavelength, 5 % off a mode
)
SHEARED, GROSSLY_SHEARED = 0.1, 1.0 / 6.0
"""Share of shear in the deflection over half a bending wave of layers: without it frequencies are 5, 10 % too high."""
DIRECTIONS = np.radians(np.arange(0.0, 180.0, 15.0))


def mesh_findings(model: Model, up_to_hz: float) -> tuple[Finding, ...]:
    """Plates, shells, solids and frames whose cells and bars are too long, and plates that are too thick, for the waves
    of the highest frequency."""
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
        if not isinstance(plate.part.material, Material):
            found += _sheared_layers(plate, up_to_hz)
        elif wave / plate.part.thickness < SLENDER:
            denser = with_shear(plate.part.section, up_to_hz)[1]
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
    return (*found, *shell_mesh_findings(model, up_to_hz), *solid_mesh_findings(model, up_to_hz))


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


def _sheared_layers(plate: PlateMesh, up_to_hz: float) -> list[Finding]:
    """Layers that would shear at the highest frequency, in the direction where they do so most."""
    section = plate.part.section
    if not (section.m0 > 0.0 and 0.0 < up_to_hz < np.inf):
        return []
    bends, shears = _by_direction(section)
    worst = int(np.argmax(np.sqrt(bends) / shears))
    per_hz = 2.0 * np.pi * float(np.sqrt(section.m0 * bends[worst]) / shears[worst])  # k^2 D / S of a thin wave at 1 Hz
    ratio = per_hz * up_to_hz
    share = ratio / (1.0 + ratio)
    if share <= SHEARED:
        return []
    wave = 2.0 * np.pi * float((bends[worst] / section.m0) ** 0.25 / np.sqrt(2.0 * np.pi * up_to_hz))
    carried = SHEARED / (1.0 - SHEARED) / per_hz
    return [
        Finding(
            "layers-shear",
            f"{plate.name}: at {up_to_hz:.4g} Hz shear would be {100 * share:.0f} % of the deflection over half a "
            f"bending wave of {1e3 * wave:.0f} mm at {np.degrees(DIRECTIONS[worst]):.0f} degrees to its x; "
            f"{100 * SHEARED:.0f} % is the limit, reached at {carried:.3g} Hz. Plates leave out shear: frequencies "
            f"are about {100 * (np.sqrt(1.0 + ratio) - 1.0):.0f} % too high there",
            {"shear_share": share, "wavelength_m": wave, "carried_hz": carried},
            severe=share > GROSSLY_SHEARED,
        )
    ]


def _by_direction(section: PlateSection) -> tuple[Floats, Floats]:
    """Bending rigidity [N m] and shear stiffness [N/m] for waves in directions all around."""
    bends: Floats = laminate.turned(section.bending, -DIRECTIONS)[:, 0, 0]
    shears: Floats = laminate.turned_shear(section.As, -DIRECTIONS)[:, 0, 0]
    return bends, shears


def with_shear(section: PlateSection, frequency_hz: float) -> tuple[float, float]:
    """Wavenumber along x and density of modes of a plate with shear and rotary inertia over those of a thin one at a
    frequency.

    Notes
    -----
    k^2 = omega^2 (a + b) / 2 + sqrt(omega^4 (a - b)^2 / 4 + omega^2 m0 / D) with a = m0 / As and b = m2 / D; modes are
    as dense as k^2 grows with omega.
    """
    omega, D = 2.0 * np.pi * frequency_hz, float(section.bending[0, 0])
    a, b, thin = section.m0 / float(section.As[0, 0]), section.m2 / D, section.m0 / D
    root = np.sqrt(omega**4 * (a - b) ** 2 / 4.0 + omega**2 * thin)
    squared = omega**2 * (a + b) / 2.0 + root
    growth = omega * (a + b) + (omega**3 * (a - b) ** 2 / 2.0 + omega * thin) / root
    return float(np.sqrt(squared / (omega * np.sqrt(thin)))), float(growth / np.sqrt(thin))


def carried_hz(model: Model) -> float:
    """The highest frequency that all parts have cells and bars enough for [Hz]; infinite without plates, shells,
    solids and frames."""
    carried = [np.inf]
    for frame in frames_of(model):
        carried += [wave.carried_hz(float(frame.lengths.max())) for wave in frame_waves(frame)]
    for plate in plates_of(model):
        cell = float(max(np.diff(plate.x).max(), np.diff(plate.y).max()))
        carried.append((bending_wavelength(plate, 1.0) / (CELLS_PER_WAVE * cell)) ** 2)
    carried += [carried_by_cells_hz(shell) for shell in shells_of(model)]
    return min([*carried, *(carried_by_solid_hz(solid) for solid in solids_of(model))])


def bending_wavelength(plate: PlateMesh, frequency_hz: float) -> float:
    """Length of a free bending wave of a thin plate [m]: 2 pi (D / m0 omega^2)^(1/4), the shortest of all directions;
    infinite without mass."""
    return _thin_wavelength(plate.part.section, isinstance(plate.part.material, Material), frequency_hz)


def cell_for(part: Part, frequency_hz: float) -> float | None:
    """Largest cell [m] of a plate or slab that its bending waves of a frequency allow; None of other parts."""
    if not isinstance(part, Plate | Slab):
        return None
    section = section_of(part.material, part.thickness)
    if isinstance(part, Plate):
        return _thin_wavelength(section, isinstance(part.material, Material), frequency_hz) / CELLS_PER_WAVE
    D, As, m0 = section.D[None], section.As[None], np.array([section.m0])
    return float(wavelengths(D, As, m0, frequency_hz)[0]) / CELLS


def _thin_wavelength(section: PlateSection, isotropic: bool, frequency_hz: float) -> float:
    if section.m0 == 0.0:
        return np.inf
    softest = section.D[0, 0] if isotropic else _by_direction(section)[0].min()
    omega = 2.0 * np.pi * frequency_hz
    return float(2.0 * np.pi * (softest / (section.m0 * omega**2)) ** 0.25)
