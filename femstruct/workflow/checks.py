"""Reasons not to believe a result that no single stage can see."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from acoustics.errors import Advice
from femstruct.arrays import Floats
from femstruct.elements.plate import rigidity
from femstruct.errors import Finding
from femstruct.impact.response import Response
from femstruct.modal.basis import ModalBasis
from femstruct.model.model import Model, PlateMesh
from femstruct.model.probe import Probe

CELLS_PER_WAVE = 6.0  # bending wavelengths of bfs16 and acm12 are right to about 1 % with six cells
SLENDER = 10.0  # bending wavelength over thickness below which shear takes more than about 3 % off a frequency
CONTENT = 0.01  # share of a contact force's spectrum beyond the last mode that a basis may miss


def mesh_findings(model: Model, up_to_hz: float) -> tuple[Finding, ...]:
    """Plates whose cells are too large, or that are too thick, for the bending waves of the highest frequency."""
    found = []
    for name, plate in model.plates.items():
        wave = bending_wavelength(plate, up_to_hz)
        cell = float(max(np.diff(plate.x).max(), np.diff(plate.y).max()))
        if wave / cell < CELLS_PER_WAVE:
            found.append(
                Finding(
                    "coarse-mesh",
                    f"{name}: a bending wave of {up_to_hz:g} Hz is {1e3 * wave:.0f} mm long and the largest cell "
                    f"{1e3 * cell:.0f} mm, {wave / cell:.1f} cells a wave where {CELLS_PER_WAVE:g} are needed",
                    {"wavelength_m": wave, "cell_m": cell},
                )
            )
        if wave / plate.part.thickness < SLENDER:
            found.append(
                Finding(
                    "shear-left-out",
                    f"{name}: a bending wave of {up_to_hz:g} Hz is {wave / plate.part.thickness:.1f} times as long as "
                    f"the plate is thick; below {SLENDER:g} the plate without shear is too stiff",
                    {"wavelength_m": wave, "thickness_m": plate.part.thickness},
                )
            )
    return tuple(found)


def carried_hz(model: Model) -> float:
    """The highest frequency that all plates have cells enough for [Hz]; infinite without plates."""
    carried = [np.inf]
    for plate in model.plates.values():
        cell = float(max(np.diff(plate.x).max(), np.diff(plate.y).max()))
        carried.append((bending_wavelength(plate, 1.0) / (CELLS_PER_WAVE * cell)) ** 2)
    return min(carried)


def bending_wavelength(plate: PlateMesh, frequency_hz: float) -> float:
    """Length of a free bending wave of a thin plate [m]: 2 pi (D / rho h omega^2)^(1/4)."""
    part = plate.part
    stiffness = rigidity(part.material.E, part.material.nu, part.thickness)[0, 0]
    omega = 2.0 * np.pi * frequency_hz
    return float(2.0 * np.pi * (stiffness / (part.material.rho * part.thickness * omega**2)) ** 0.25)


def impact_findings(basis: ModalBasis, response: Response) -> tuple[Finding, ...]:
    """Contact forces with content beyond the modes of the basis."""
    found = []
    on_structure = {c.name for c in response.scene.contacts if isinstance(c.upper, Probe) or isinstance(c.lower, Probe)}
    for name, contact in response.contacts.items():
        if not contact.closings or name not in on_structure:
            continue
        share = content_above(contact.force, response.clock.sampling, basis.complete_below_hz)
        if share > CONTENT:
            found.append(
                Finding(
                    "basis-truncated",
                    f"{name}: {100 * share:.1f} % of the force's spectrum lies beyond {basis.complete_below_hz:.0f} "
                    "Hz, where modes are left out (their static share is kept); accelerations there are too small",
                    {"share": share, "complete_below_hz": basis.complete_below_hz},
                )
            )
    return tuple(found)


def content_above(force: Floats, sampling: float, frequency_hz: float) -> float:
    """Share of the energy of a force's spectrum above a frequency [1]."""
    energy = np.abs(np.fft.rfft(force)) ** 2
    total = float(energy.sum())
    above = np.fft.rfftfreq(len(force), 1.0 / sampling) > frequency_hz
    return float(energy[above].sum()) / total if total > 0.0 else 0.0


def room_findings(told: Iterable[tuple[str, Advice | Finding]]) -> list[Finding]:
    """What was told of rooms ("box") and receivers ("box.mic"), each once and with the names of all it holds for.

    >>> advice = Advice("ringing", "it rings")
    >>> [found.message for found in room_findings([("box", advice), ("hall", advice)])]
    ['box, hall: it rings']
    """
    names: dict[tuple[str, str], list[str]] = {}
    first: dict[tuple[str, str], Advice | Finding] = {}
    for name, found in told:
        key = (found.code, found.message)
        names.setdefault(key, []).append(name)
        first.setdefault(key, found)
    return [
        Finding(
            found.code,
            f"{', '.join(names[key])}: {found.message}",
            found.values,
            severe=isinstance(found, Finding) and found.severe,
        )
        for key, found in first.items()
    ]
