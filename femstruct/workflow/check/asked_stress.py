"""The stress of a part along a frequency response, as the command line asks for it."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from femstruct.elements.stresses import von_mises_in_a_cycle
from femstruct.errors import Finding, InputError
from femstruct.modal.basis import ModalBasis
from femstruct.modal.steady.excitation import pushing
from femstruct.modal.steady.steady_stresses import harmonic_stress, stress_components
from femstruct.model.probe import StressPlaces
from femstruct.model.structure import Structure
from femstruct.study.asked import FrfRequest
from femstruct.workflow.stages.modal_bases import Solved
from femstruct.workflow.stages.recorded.stresses import judged, orthotropic_findings, stress_findings

STRESS: Final = "stress"
KIND: Final = "equivalent stress (von Mises), largest of a cycle,"
Table = dict[str, Any]


def stress_response(request: FrfRequest, solved: Solved, basis: ModalBasis) -> tuple[Table, tuple[Finding, ...]]:
    """What a stress per unit force adds to the table of a frequency response, and its findings.

    request : its response is PART.stress, the largest anywhere in the part at each frequency, or POINT.stress, that at
    the place nearest to the point where its part has stresses.

    Returns real and imag of the equivalent stress [Pa/N], at each frequency the largest of all places, and at the one
    place where it is largest in the band the equivalent stress and the complex components along the local axes.

    Raises InputError for what has no stresses, and at 0 Hz of a structure that is free.
    """
    low, high = request.band
    lines = np.arange(int(np.floor((high - low) / request.step + 1e-9)) + 1, dtype=np.float64)
    frequency = low + request.step * lines
    if basis.n_rigid and low == 0.0:
        raise InputError("--band", got="0 Hz", expected="a frequency > 0: the structure is free")
    drive = solved.places.point(request.drive.name, "--drive").probe(request.drive.what)
    part, rows, near = _places(request.response.name, solved)
    excitation = pushing(basis, drive)
    found = harmonic_stress(basis, excitation, rows, np.ones(len(frequency)), frequency)
    stressed = judged(rows, basis.shapes, found.largest, found.amount)
    components = stress_components(basis, excitation, rows, stressed.worst, frequency)
    told = {
        "kind": KIND,
        "frequency_hz": frequency.tolist(),
        "real": found.along.tolist(),
        "imag": np.zeros(len(frequency)).tolist(),
        "unit": "Pa/(N m)" if request.drive.what.startswith("r") else "Pa/N",
        "place": f"{stressed.where}{near}",
        "equivalent_there": von_mises_in_a_cycle(components[None], rows.components)[0].tolist(),
        "components": {
            name: {"real": values.real.tolist(), "imag": values.imag.tolist()}
            for name, values in zip(rows.components, components, strict=True)
        },
    }
    findings = stress_findings({f"{request.response} per unit force": stressed})
    return told, (*findings, *orthotropic_findings(solved.structure, (part,)))


def _places(name: str, solved: Solved) -> tuple[str, StressPlaces, str]:
    """A part and where it is stressed, all of it or near a point of it; and how near, in words."""
    places = solved.places
    if name in places.parts:
        return name, places.stresses(name, "--response"), ""
    point = places.point(name, "--response")
    points = solved.structure.points if isinstance(solved.structure, Structure) else ()
    on = next((one.on for one in points if name in (one.name, f"{one.name}.{name.rpartition('.')[2]}")), "")
    rows = places.stresses(on, "--response")
    positions = rows.places.reshape(-1, len(rows.sides), 3).mean(axis=1)
    apart = np.linalg.norm(positions - point.position, axis=1)
    nearest = int(apart.argmin())
    beside = rows.some(nearest * len(rows.sides) + np.arange(len(rows.sides)))
    return on, beside, f", {round(float(apart[nearest]), 9):.3g} m from {name}"
