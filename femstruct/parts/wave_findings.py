"""Meshes and theories beside the waves of the highest frequency: cells and bars that are too long, plates too thick."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.elements import laminate
from femstruct.elements.frame import nodes_per_bar
from femstruct.elements.plate import twist_excess
from femstruct.errors import Finding, InputError, list_some
from femstruct.model.imported_mesh import KINDS
from femstruct.model.lay_ups import PlateSection, section_of
from femstruct.model.materials import Material
from femstruct.model.model import Model
from femstruct.model.part import Part
from femstruct.model.regions import intersection_line
from femstruct.parts.frame import FrameMesh, frames_of
from femstruct.parts.joint_findings import held_with_joined
from femstruct.parts.plate import Plate, PlateMesh, plates_of, rigid_plates
from femstruct.parts.shell import ShellMesh
from femstruct.parts.slab import Slab
from femstruct.parts.solid import SolidMesh
from femstruct.parts.substructure import SubstructureMesh

# ----------------------------------------------------------------------------------------------------------------------
# How well the bars of a frame carry waves of a frequency: bars to a wavelength, and how many it takes.
# ----------------------------------------------------------------------------------------------------------------------

LINEAR_BARS = 13.0  # bars to a wave where an element errs by (k h)^2 / 24: 1 % of a frequency
CUBIC = 4.0  # where it errs by (k h)^4 / 1440: 0.4 %


@dataclass(frozen=True)
class FrameWave:
    """A kind of wave in a frame: its length [m] at 1 Hz, and the bars a wave needs.

    power : the length falls with this power of the frequency: 1, or 1/2 for bending.
    """

    kind: str
    length_at_1_hz: float
    power: float
    needed: float

    def length(self, frequency_hz: float) -> float:
        """Length of the wave at a frequency [m]."""
        return float(self.length_at_1_hz / frequency_hz**self.power)

    def carried_hz(self, bar: float) -> float:
        """The highest frequency of which bars of a length [m] are short enough [Hz]."""
        return float((self.length_at_1_hz / (self.needed * bar)) ** (1.0 / self.power))


def frame_waves(mesh: FrameMesh) -> tuple[FrameWave, ...]:
    """Bending about the weaker axis, shear, torsion and stretch of a frame; none without mass.

    Notes
    -----
    Bending of a slender bar, with any of the elements, is that of cubic deflections. Bars of two nodes have straight
    lines for stretch and torsion and, for "timoshenko", constant shear strain: of a frequency its share is
    (k_s h)^2 / 24 with the wavenumber of shear waves, k_s^2 = omega^2 rho / k G (measured: `test_frame_waves`). The
    torsional wave of a thin open section is slow: c^2 = G J / rho (I_y + I_z).
    """
    (E, G, section), rho = mesh.part.along, mesh.part.material.rho
    if rho == 0.0:
        return ()
    modulus = E * min(section.Iy, section.Iz)
    bending = float(np.sqrt(2.0 * np.pi) * (modulus / (rho * section.A)) ** 0.25)
    torsion = float(np.sqrt(G * section.J / (rho * (section.Iy + section.Iz))))
    straight = CUBIC if nodes_per_bar(mesh.part.element) == 3 else LINEAR_BARS
    waves = [
        FrameWave("bending", bending, 0.5, CUBIC),
        FrameWave("torsional", torsion, 1.0, straight),
        FrameWave("longitudinal", float(np.sqrt(E / rho)), 1.0, straight),
    ]
    if mesh.part.element == "timoshenko":
        shear = float(np.sqrt(min(section.ky, section.kz) * G / rho))
        waves.append(FrameWave("shear", shear, 1.0, LINEAR_BARS))
    return tuple(waves)


# ----------------------------------------------------------------------------------------------------------------------
# Cells of solids beside the shortest waves of the highest frequency: shear waves, and bending waves of thin ones.
# ----------------------------------------------------------------------------------------------------------------------

LINEAR, QUADRATIC = 16.0, 8.0
"""Cells a wave: with fewer, bending frequencies of hex8 are more than 2 % too high, those of hex20 more than 1.5 %."""


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


# ----------------------------------------------------------------------------------------------------------------------
# Meshes and theories beside the waves of the highest frequency.
# ----------------------------------------------------------------------------------------------------------------------

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
    bends: Floats = laminate.rotate_stiffness(section.bending, -DIRECTIONS)[:, 0, 0]
    shears: Floats = laminate.rotate_shear(section.As, -DIRECTIONS)[:, 0, 0]
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


def mesh_limit_hz(model: Model) -> float:
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


# ----------------------------------------------------------------------------------------------------------------------
# Cells of shells beside the bending waves of the highest frequency.
# ----------------------------------------------------------------------------------------------------------------------

CELLS = 8.0  # linear cells a bending wave: 2.6 % too high along the sides, (k h)^2 / 24, 1.7 % too low aslant


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


# ----------------------------------------------------------------------------------------------------------------------
# Plates beside their theory: too thick for Kirchhoff's, too stiff in twist by their element, with layers that couple
# stretching and bending.
# ----------------------------------------------------------------------------------------------------------------------

NOTABLE_SHEAR, GROSS_SHEAR = 0.005, 0.5
"""Estimated error of a plate's first frequency from here on is worth a finding; from there on it is no plate."""


def model_findings(model: Model) -> tuple[Finding, ...]:
    """Reasons to trust the model less: the twist defect of hermite12, plates too thick for Kirchhoff's theory, layers
    that are not symmetric."""
    plates = plates_of(model)
    found = [_twist_defect(plate) for plate in plates if plate.part.element == "hermite12"]
    for plate in plates:
        excess = shear_excess(plate)
        if excess > NOTABLE_SHEAR:
            ratio = plate.part.thickness / min(plate.part.size)
            found.append(
                Finding(
                    "thick-plate",
                    f"The thickness of {plate.name} is {ratio:.2g} of its shorter side. The theory of thin plates "
                    f"leaves out shear and rotary inertia: simply supported, its first natural frequency is about "
                    f"{100 * excess:.1f} % too high, higher ones more",
                    {"thickness_to_side": ratio, "first_frequency_excess": excess},
                    severe=excess > GROSS_SHEAR,
                )
            )
        if plate.part.section.coupled:
            found.append(_unsymmetric(plate))
    return tuple(found)


def shear_excess(plate: PlateMesh) -> float:
    """Estimated relative excess of the first frequency of a plate for leaving out shear and rotary inertia [1].

    Half the shear energy V . As^-1 V / 2 over that of bending, V the shear forces of one half wave along each side, and
    half the rotary inertia m2 k^2 over the mass. For one isotropic material that is (k h)^2 / 24 (1 + 2 / (kappa (1 -
    nu))) with kappa = 5/6, the first term of the exact solution of a simply supported Mindlin plate,
    doi:10.1115/1.4010217.
    """
    section = plate.part.section
    D, (x, y) = section.bending, np.pi / np.asarray(plate.part.size)
    both = D[0, 1] + 2.0 * D[2, 2]
    forces = np.array([D[0, 0] * x**3 + both * x * y**2, D[1, 1] * y**3 + both * x**2 * y])
    energy = D[0, 0] * x**4 + 2.0 * both * x**2 * y**2 + D[1, 1] * y**4
    sheared = forces @ np.linalg.solve(section.As, forces) / energy
    turned = section.m2 * (x**2 + y**2) / section.m0 if section.m0 > 0.0 else 0.0
    return float((sheared + turned) / 2.0)


def _unsymmetric(plate: PlateMesh) -> Finding:
    """Layers whose neutral surface is not the mid-surface, in the direction where the difference is largest."""
    section = plate.part.section
    middle, free = section.D.diagonal()[:2], section.bending.diagonal()[:2]
    worst = int(np.argmin(free / middle))
    off = float(section.B[worst, worst] / section.A[worst, worst])
    return Finding(
        "unsymmetric-layers",
        f"{plate.part.name}: its layers are not symmetric. The neutral surface along {'xy'[worst]} is "
        f"{1e3 * abs(off):.3g} mm off the mid-surface. It bends about it with {free[worst]:.4g} N m, as a plate that "
        f"nothing holds in its plane; with its mid-surface held it would have {middle[worst]:.4g} N m. Forces in its "
        "plane do not bend it here",
        {"off_m": off, "free_n_m": float(free[worst]), "held_n_m": float(middle[worst])},
    )


def _twist_defect(plate: PlateMesh) -> Finding:
    a, b = plate.cell_sizes
    D = plate.part.section.D
    excess = twist_excess(b / a, D[0, 1] / D[0, 0])
    mean = float((excess * a * b).sum() / (a * b).sum())
    worst = int(np.argmax(excess))
    aspect = float(max(a[worst] / b[worst], b[worst] / a[worst]))
    return Finding(
        "twist-defect",
        f"{plate.part.name} uses hermite12, which is {100 * mean:.0f} % too stiff in twist with any mesh (up to "
        f"{100 * float(excess[worst]):.0f} % in cells of 1:{aspect:.2g}). Use bfs16",
        {"mean_excess": mean, "largest_excess": float(excess[worst]), "largest_cell_aspect": aspect},
    )


# ----------------------------------------------------------------------------------------------------------------------
# Findings on reduced parts that are asked for more than they were reduced for.
# ----------------------------------------------------------------------------------------------------------------------

BEYOND: Final = 0.75
"""Of the highest frequency of the modes kept: a floor of two parts erred by 2e-6 at 0.67 of it, by 3e-4 at 0.86."""


def reduced_findings(model: Model, up_to_hz: float) -> tuple[Finding, ...]:
    """Reduced parts that lack modes for what is looked at [Hz]."""
    found = []
    for name, part in model.parts.items():
        kept = part.part.component.reduced_to_hz if isinstance(part, SubstructureMesh) else None
        if kept is not None and up_to_hz > BEYOND * kept:
            found.append(
                Finding(
                    "reduced-beyond",
                    f"{name} was reduced with modes up to {kept:.4g} Hz, which is good to {BEYOND * kept:.4g} Hz: "
                    f"{up_to_hz:.4g} Hz is looked at. Above, modes may be missing and frequencies are too high. Reduce "
                    f"it with modes up to {2.0 * up_to_hz:.3g} Hz.",
                    {"reduced_to_hz": kept, "up_to_hz": up_to_hz},
                )
            )
    return tuple(found)


# ----------------------------------------------------------------------------------------------------------------------
# Plates joined at an angle: from which frequency on they would bend, shear or stretch in their own planes.
#
# These plates are said to be rigid in their own planes. Folded ones have modes in which that matters: an angle or a
# channel bends as a beam, which its plates can only follow by bending in their planes. The model has none of these
# modes, and those that it has near them are wrong.
#
# Plates joined along parallel lines are taken as a beam of the section they make together: its least second moment
# about its centroid, the shear stiffness of the plates that stand along the deflection, the mass of all of them, and
# the supports at its ends: 1 / f^2 = 1 / f_bending^2 + 1 / f_shear^2. A plate stretches from E / rho on as a rod.
#
# Checked against three-dimensional solids: an angle and an I-beam (first mode left out 46.3 and 10.5 Hz), and an open
# box, all of whose first twelve modes the model has to 0.2 % (`tests/analytic/test_rigid_in_plane.py`).
# ----------------------------------------------------------------------------------------------------------------------

NEAR = 0.5  # of the first frequency left out: from here on modes are raised by some percent
_PARALLEL = 1e-3  # sine of an angle
_SHARED = 1e-6  # of the structure's size
_HELD = 1e-9
_UPRIGHT = 0.5  # of a plate that resists a deflection: its width along it over its width
# (beta L)^2 of a beam by what holds its two ends (Free, Pinned, Clamped), and half waves of the shear beam.
_BENDING = {"FF": 22.373, "CF": 3.516, "CC": 22.373, "PP": 9.870, "CP": 15.418, "FP": 15.418}
_SHEAR = {"FF": 1.0, "CF": 0.5, "CC": 1.0, "PP": 1.0, "CP": 1.0, "FP": 1.0}


@dataclass(frozen=True)
class InPlaneLimit:
    """The lowest frequency [Hz] at which some plates would move in their planes, and how."""

    frequency_hz: float
    plates: tuple[str, ...]
    how: str


def in_plane_limit(model: Model) -> InPlaneLimit | None:
    """The lowest frequency of folded plates in their own planes; None where no plates are joined at an angle."""
    found: list[InPlaneLimit] = []
    held: Floats | None = None
    rigid = rigid_plates(model)
    for along, names in _prisms(model):
        held = held_with_joined(model) if held is None else held
        plates = [plate for name, plate in rigid.items() if name in names]
        found += [_stretching(plate) for plate in plates]
        found += _bending(model, plates, along, held)
    return min(found, key=lambda limit: limit.frequency_hz, default=None)


def folded_findings(model: Model, up_to_hz: float) -> tuple[Finding, ...]:
    """Whether modes up to a frequency [Hz] reach to where folded plates would move in their planes."""
    limit = in_plane_limit(model)
    if limit is None or not up_to_hz >= NEAR * limit.frequency_hz:
        return ()
    names = list_some(limit.plates)
    there = up_to_hz >= limit.frequency_hz
    requested = f"modes up to {up_to_hz:.4g} Hz" if np.isfinite(up_to_hz) else "all modes"
    return (
        Finding(
            "folded-plates",
            f"{names}: plates joined at an angle {limit.how} from about {limit.frequency_hz:.3g} Hz on, but "
            f"these are rigid there. {'The model lacks such modes. Modes' if there else 'Modes'} above "
            f"{NEAR * limit.frequency_hz:.3g} Hz are too high by some percent or more; {requested} are requested",
            {"in_plane_hz": limit.frequency_hz, "up_to_hz": up_to_hz},
            severe=there,
        ),
    )


def _prisms(model: Model) -> list[tuple[Floats, tuple[str, ...]]]:
    """Directions of fold lines [3], and the plates that are joined along lines of each, two of them at an angle."""
    size = float(np.ptp(model.mesh.points, axis=0).max())
    folds: list[tuple[Floats, str, str]] = []
    flat: list[tuple[str, str]] = []
    rigid = rigid_plates(model)
    for joint in model.structure.joints:
        one, other = rigid.get(joint.a), rigid.get(joint.b)
        if one is None or other is None:
            continue
        if np.linalg.norm(np.cross(one.axes[2], other.axes[2])) < _PARALLEL:
            flat.append((joint.a, joint.b))
            continue
        try:
            start, end = intersection_line(one.part, other.part, _SHARED * size)
        except InputError:  # joined with less precision than asked for here
            continue
        length = float(np.linalg.norm(end - start))
        if length > 10.0 * _SHARED * size:
            folds.append(((end - start) / length, joint.a, joint.b))
    found: list[tuple[Floats, tuple[str, ...]]] = []
    directions: list[Floats] = []
    for along, _, _ in folds:
        if all(np.linalg.norm(np.cross(along, other)) > _PARALLEL for other in directions):
            directions.append(along)
    for along in directions:
        pairs = [(a, b) for other, a, b in folds if np.linalg.norm(np.cross(along, other)) <= _PARALLEL]
        found += [(along, names) for names in _groups(pairs, flat)]
    return found


def _groups(folds: Sequence[tuple[str, str]], flat: Sequence[tuple[str, str]]) -> list[tuple[str, ...]]:
    """Names that pairs connect, of groups with at least one fold."""
    owner = {name: name for pair in (*folds, *flat) for name in pair}

    def root(name: str) -> str:
        while owner[name] != name:
            name = owner[name]
        return name

    for a, b in (*folds, *flat):
        owner[root(a)] = root(b)
    folded = {root(a) for a, _ in folds}
    return [tuple(name for name in owner if root(name) == one) for one in sorted(folded)]


def _stretching(plate: PlateMesh) -> InPlaneLimit:
    """Half a wave over the longer side, as of a rod with free ends."""
    section, (width, height) = plate.part.section, plate.part.size
    stretch = section.stretching(0.0 if width >= height else np.pi / 2.0)
    speed = np.sqrt(stretch / section.m0) if section.m0 > 0.0 else np.inf
    return InPlaneLimit(float(speed / (2.0 * max(plate.part.size))), (plate.part.name,), "stretch in their planes")


def _bending(model: Model, plates: Sequence[PlateMesh], along: Floats, held: Floats) -> list[InPlaneLimit]:
    """The beam that plates make along a direction [3], bending about either principal axis of its section."""
    nodes = np.concatenate([plate.nodes.ravel() for plate in plates])
    places = model.mesh.points[nodes] @ along
    low, length = float(places.min()), float(np.ptp(places))
    widths, centres = zip(*(_across(plate, along) for plate in plates), strict=True)
    shares = np.array([_extent(plate, along) / length for plate in plates])  # of shorter plates: spread over all of it
    across = shares * [np.linalg.norm(width) for width in widths]
    angles = [np.arctan2(plate.axes[1] @ along, plate.axes[0] @ along) for plate in plates]
    sections = [plate.part.section for plate in plates]
    stretch = across * [section.stretching(angle) for section, angle in zip(sections, angles, strict=True)]
    sheared = [section.turned(-angle).A[2, 2] for section, angle in zip(sections, angles, strict=True)]
    shear = 5.0 / 6.0 * across * sheared
    mass = float((across * [section.m0 for section in sections]).sum())
    middle = (stretch[:, None] * centres).sum(axis=0) / stretch.sum()
    moments = np.zeros((3, 3))
    for weight, width, centre in zip(stretch, widths, centres, strict=True):
        moments += weight * (np.outer(width, width) / 12.0 + np.outer(centre - middle, centre - middle))
    stiffness, axes = np.linalg.eigh(moments)
    found = []
    for value, axis in zip(stiffness, axes.T, strict=True):
        leaning = np.array([abs(axis @ width) / np.linalg.norm(width) for width in widths])
        if abs(axis @ along) > _UPRIGHT or not (leaning > _UPRIGHT).any() or value <= 0.0 or mass <= 0.0:
            continue
        upright = [plate for plate, share in zip(plates, leaning, strict=True) if share > _UPRIGHT]
        ends = _ends(model, upright, along, axis, held, (low, length))
        if ends is None:
            continue
        bends = _BENDING[ends] / (2.0 * np.pi * length**2) * np.sqrt(value / mass)
        shears = _SHEAR[ends] / (2.0 * length) * np.sqrt(float((shear * leaning**2).sum()) / mass)
        names = tuple(plate.part.name for plate in plates)
        found.append(InPlaneLimit(float(1.0 / np.hypot(1.0 / bends, 1.0 / shears)), names, "bend in their planes"))
    return found


def _across(plate: PlateMesh, along: Floats) -> tuple[Floats, Floats]:
    """Width of a plate across a direction as a vector [3], and where its middle is across it [3]."""
    inside = [float(abs(axis @ along)) for axis in plate.axes[:2]]
    side = int(np.argmin(inside))
    middle = np.asarray(plate.part.origin) + np.asarray(plate.part.size) @ plate.axes[:2] / 2.0
    width: Floats = plate.part.size[side] * plate.axes[side]
    centre: Floats = middle - (middle @ along) * along
    return width, centre


def _extent(plate: PlateMesh, along: Floats) -> float:
    """Length of a plate along a direction [m]."""
    return float(sum(side * abs(axis @ along) for side, axis in zip(plate.part.size, plate.axes[:2], strict=True)))


def _ends(
    model: Model,
    upright: Sequence[PlateMesh],
    along: Floats,
    axis: Floats,
    held: Floats,
    span: tuple[float, float],
) -> str | None:
    """What holds both ends against moving along an axis: a key of the tables; None where it is held in between."""
    nodes = np.concatenate([plate.nodes.ravel() for plate in upright])
    low, length = span
    place = (model.mesh.points[nodes] @ along - low) / length
    depth = model.mesh.points[nodes] @ axis
    across = np.einsum("i,nij,j->n", axis, held[nodes], axis) > _HELD
    lengthwise = np.einsum("i,nij,j->n", along, held[nodes], along) > _HELD
    if (across & (place > 0.02) & (place < 0.98)).any():
        return None
    kinds = []
    for end in (place <= 0.02, place >= 0.98):
        turns = lengthwise & end
        if not (across & end).any():
            kinds.append("F")
        elif turns.any() and np.ptp(depth[turns]) > 0.5 * np.ptp(depth):
            kinds.append("C")
        else:
            kinds.append("P")
    return "".join(sorted(kinds))
