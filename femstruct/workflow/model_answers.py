"""A model at rest, one frequency response, a stress along it, as the command line asks for them."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from acoustics.errors import Advice
from femstruct.assembly.matrices import GROUND, assemble
from femstruct.conventions import DIRECTIONS, GRAVITY
from femstruct.elements.stresses import von_mises_in_a_cycle
from femstruct.errors import Finding, InputError
from femstruct.files.tables import finding_table
from femstruct.findings.catalogue import rank_findings
from femstruct.language.models import read_model_file
from femstruct.modal.basis import ModalBasis
from femstruct.modal.damping import Damping, with_damping
from femstruct.modal.frf import KINDS, direct_frf
from femstruct.modal.statics import AtRest, statics
from femstruct.modal.steady import Highest, force_excitation, harmonic_stress, stress_components
from femstruct.model.component import Component, rigid_resistance
from femstruct.model.mesher import mesh_structure
from femstruct.model.model import Model
from femstruct.model.part import Meshed
from femstruct.model.probe import Probe, StressPlaces
from femstruct.model.structure import Structure
from femstruct.parts.substructure import Substructure
from femstruct.study.asked import Extent, FrfRequest, Spot
from femstruct.study.recorded import LargestStress
from femstruct.study.results import Frf
from femstruct.study.study import Study
from femstruct.units import quantity
from femstruct.workflow.bases import Places, Solved, add_cavities, solve, with_positions
from femstruct.workflow.impact_findings import room_findings
from femstruct.workflow.modes import frequency_option
from femstruct.workflow.provenance import Progress
from femstruct.workflow.recorded_channels import judged, orthotropic_findings, stress_at_rest, stress_findings
from femstruct.workflow.responses import force_axis, frequency_response
from femstruct.workflow.structure_findings import structure_findings_before
from femstruct.workflow.study_findings import all_findings

# ----------------------------------------------------------------------------------------------------------------------
# A model at rest under its weight and constant forces, as the command line asks for it.
# ----------------------------------------------------------------------------------------------------------------------

Table = dict[str, Any]
_SOLVED: Final = 1e-6  # of the load, or of the stiffness: less is rounding of a file or a solution


def statics_table(path: Path, forces: list[str], weight: bool, overrides: tuple[str, ...] = ()) -> Table:
    """Table of a model at rest: displacements of its points and parts, forces that hold it, largest stresses.

    Parameters
    ----------
    forces : list[str]
        Each "POINT.direction=FORCE".

    Raises
    ------
    InputError
        Where nothing acts, for a force it cannot read, and for a structure in closed form or one that can move as a
        whole.
    """
    if not forces and not weight:
        got, do = "nothing that acts", "such as --force 'P.z=-10 kN'"
        raise InputError("--force and --weight", got=got, expected="one of them", do=do)
    source = read_model_file(path, overrides)
    with with_positions(source):
        if not isinstance(source.structure, Structure):
            raise InputError(str(path), got="a structure in closed form", expected="a model with parts")
        model = mesh_structure(source.structure)
        places = Places(model.points, model.surfaces, model.parts)
        assembly = assemble(model)
        static_state = statics(model, assembly, [_force(text, places) for text in forces], weight)
    stresses = _stresses(model, places, static_state, weight)
    return {
        "title": source.title,
        "load_n": static_state.load.tolist(),
        "points": {
            name: [static_state.of(point.probe(direction)) for direction in DIRECTIONS]
            for name, point in model.points.items()
        },
        "parts_m": {name: _largest(part, static_state, weight) for name, part in model.parts.items()},
        "forces_n": {name: force.tolist() for name, force in static_state.forces.items()},
        "on_the_ground": [name for name in static_state.forces if name in (*assembly.grounded, GROUND)],
        "held_inside": _held_inside(source.structure, static_state),
        "stresses": {
            name: {"largest_pa": float(one.largest.max()), "where": one.where} for name, one in stresses.items()
        },
        "findings": [
            finding_table(finding)
            for finding in (
                *structure_findings_before(source.structure, model),
                *stress_findings(stresses),
                *orthotropic_findings(source.structure, stresses),
            )
        ],
    }


def _largest(part: Meshed, static_state: AtRest, weight: bool) -> float:
    """Largest displacement of a part [m]: of its nodes; of a block, of its corners: its only node is in it."""
    if part.box is None:
        moved = part.moved(static_state.displacement, GRAVITY if weight else 0.0)
    else:
        corners = np.array(list(product(*part.box.T)))
        nodes, rows = part.motion_at(corners, 0.0)
        moved = np.einsum("pikc,pkc->pi", rows[:, :3], static_state.displacement[nodes])
    return float((moved**2).sum(axis=1).max() ** 0.5)


def _held_inside(structure: Structure, static_state: AtRest) -> Table | None:
    """What of the load reaches no support, since matrices of parts are held inside; None where all of it does."""
    held = [part.name for part in structure.parts if isinstance(part, Substructure) and _holds(part.component)]
    missing = static_state.load - static_state.forces[GROUND]
    if not held or np.abs(missing).max() <= _SOLVED * np.abs(static_state.load).max():
        return None
    return {"parts": held, "force_n": missing.tolist()}


def _holds(component: Component) -> bool:
    """Whether something inside of it stands on the ground."""
    return not component.free or float(rigid_resistance(component)[:3].max()) > _SOLVED


def _force(text: str, places: Places) -> tuple[Probe, float]:
    """A force as it is written on the command line, at its probe."""
    spot, equals, amount = text.partition("=")
    name, _, direction = spot.strip().rpartition(".")
    if not equals or not name:
        raise InputError("--force", got=f"'{text}'", expected="POINT.direction=FORCE, such as 'P.z=-10 kN'")
    point = places.point(name, "--force")
    try:
        value = quantity(amount.strip(), "force")
    except InputError as error:
        raise InputError("--force", got=error.got, expected=error.expected, do=error.do) from error
    if direction not in (*DIRECTIONS[:3], "n"):
        raise InputError("--force", got=f"direction '{direction}'", expected="x, y, z or n")
    return point.probe(direction), value


def _stresses(model: Model, places: Places, static_state: AtRest, weight: bool) -> dict[str, LargestStress]:
    """Of the parts that have stresses."""
    found: dict[str, LargestStress] = {}
    for name in model.parts:
        try:
            rows = places.stresses(name, name)
        except InputError:  # a part without stresses, such as a block, or a bar without an outline
            continue
        found[name] = stress_at_rest(rows, static_state.displacement, weight)
    return found


# ----------------------------------------------------------------------------------------------------------------------
# The stress of a part along a frequency response, as the command line asks for it.
# ----------------------------------------------------------------------------------------------------------------------

STRESS: Final = "stress"
KIND: Final = "equivalent stress (von Mises), largest of a cycle,"


def stress_response(request: FrfRequest, solved: Solved, basis: ModalBasis) -> tuple[Table, tuple[Finding, ...]]:
    """What a stress per unit force adds to the table of a frequency response, and its findings.

    Parameters
    ----------
    request : FrfRequest
        Its response is PART.stress, the largest anywhere in the part at each frequency, or POINT.stress, that at the
        place nearest to the point where its part has stresses.

    Returns
    -------
    tuple[Table, tuple[Finding, ...]]
        Real and imag of the equivalent stress [Pa/N], at each frequency the largest of all places, and at the one place
        where it is largest in the band the equivalent stress and the complex components along the local axes.

    Raises
    ------
    InputError
        For what has no stresses, and at 0 Hz of a structure that is free.
    """
    low, high = request.band
    lines = np.arange(int(np.floor((high - low) / request.step + 1e-9)) + 1, dtype=np.float64)
    frequency = low + request.step * lines
    if basis.n_rigid and low == 0.0:
        raise InputError("--band", got="0 Hz", expected="a frequency > 0: the structure is free")
    drive = solved.places.point(request.drive.name, "--drive").probe(request.drive.what)
    part, rows, near = _places(request.response.name, solved)
    excitation = force_excitation(basis, drive)
    found = harmonic_stress(basis, excitation, rows, np.ones(len(frequency)), frequency)
    stressed = judged(rows, basis.shapes, found.largest, found.amount)
    components = stress_components(basis, excitation, rows, stressed.worst, frequency)
    answer = {
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
    return answer, (*findings, *orthotropic_findings(solved.structure, (part,)))


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


# ----------------------------------------------------------------------------------------------------------------------
# One frequency response of a model, as the command line asks for it.
# ----------------------------------------------------------------------------------------------------------------------

DEFAULT_LINES = 500
MOST_BY_DEFAULT = 20_000
MOST_LINES = 1_000_000


def frf_of(
    path: Path,
    drive: str,
    response: str,
    band: str,
    step: str,
    kind: str,
    method: str,
    overrides: tuple[str, ...] = (),
    progress: Progress = lambda line: None,
) -> Table:
    """One frequency response of a model file, by modes with residuals or, as their check, line by line.

    Parameters
    ----------
    kind : str
        "" for accelerance, and transmissibility of a force.

    Notes
    -----
    The basis holds all modes up to 2.5 times the upper end of the band, where residual vectors leave 1e-3.
    """
    request = checked_frf_request(drive, response, band, step, kind)
    if method not in ("modal", "direct"):
        raise InputError("--method", got=f"'{method}'", expected="modal or direct")
    if method == "direct" and request.response.what == STRESS:
        raise InputError("--method", got="'direct' of a stress", expected="modal")
    source = read_model_file(path, overrides)
    with with_positions(source):
        progress("modes")
        asking = Study(source.title, source.structure, source.damping, Extent(), frf=(request,))
        solved = solve(source.structure, Extent(up_to_hz=2.5 * request.band[1]), (asking,))
        basis = add_cavities(with_damping(solved.basis, source.damping), solved)
        findings = all_findings(solved, basis, requests=(request,), up_to_hz=request.band[1])
        progress("frequency response")
        if request.response.what == STRESS:
            content, uneven = stress_response(request, solved, basis)
            findings = rank_findings((*findings, *uneven))
        else:
            answer, known = _response(request, solved, basis, progress)
            largest = answer.highest
            if not step and method == "modal" and largest is not None and largest.needed < largest.step:
                request = replace(request, step=finer(request, largest.needed))
                answer, known = _response(request, solved, basis, progress, largest)
            findings = rank_findings((*findings, *room_findings([(f"{response} / {drive}", one) for one in known])))
            values = _direct(request, solved, source.damping, answer) if method == "direct" else answer.values
            content = {
                "kind": request.kind,
                "frequency_hz": answer.frequency_hz.tolist(),
                "real": np.real(values).tolist(),
                "imag": np.imag(values).tolist(),
                "unit": answer.unit,
            }
    about = {"title": source.title, "drive": drive, "response": response, "method": method}
    return {**about, **content, "findings": [finding_table(finding) for finding in findings]}


def _response(
    request: FrfRequest, solved: Solved, basis: ModalBasis, progress: Progress, known: Highest | None = None
) -> tuple[Frf, tuple[Advice | Finding, ...]]:
    def tell(how_far: str) -> None:
        progress(f"frequency response: {how_far}")

    return frequency_response(request, solved.places, basis, progress=tell, known=known)


def finer(request: FrfRequest, needed: float) -> float:
    """The step [Hz] of a response whose step was not asked for: that which its largest value needs, if it is smaller;
    at most 20,000 lines."""
    low, high = request.band
    return max(min(request.step, needed), (high - low) / MOST_BY_DEFAULT)


def _direct(request: FrfRequest, solved: Solved, damping: Damping, answer: Frf) -> NDArray[np.complex128]:
    if solved.model is None:
        raise InputError(
            "--method", got="'direct' of a closed-form structure", expected="modal", do="it has no matrices"
        )
    if solved.model.structure.cavities:
        do = "it has the matrices of the structure alone"
        raise InputError("--method", got="'direct' of a model with cavities", expected="modal", do=do)
    response: Probe | str = f"{request.response.name}.{force_axis(request.response)}"
    if not request.response.what.startswith("force"):
        response = solved.places.point(request.response.name, "--response").probe(request.response.what)
    drive = solved.places.point(request.drive.name, "--drive").probe(request.drive.what)
    assert request.kind != "pressure" and request.kind != "power"  # a model has no rooms
    return direct_frf(assemble(solved.model), drive, response, answer.frequency_hz, damping, request.kind)


def checked_frf_request(drive: str, response: str, band: str, step: str, kind: str) -> FrfRequest:
    """What the command line asks for, checked.

    Raises InputError that begins with the option's own name.
    """
    response_spot = _spot(response, "--response")
    chosen = kind or ("transmissibility" if response_spot.what.startswith("force") else "accelerance")
    if response_spot.what == STRESS:
        if kind:
            raise InputError("--kind", got=f"'{kind}' of a stress", expected="no kind: stress is per force")
        chosen = "receptance"
    if chosen not in KINDS:
        raise InputError("--kind", got=f"'{kind}'", expected=", ".join(KINDS))
    low, high = _band(band)
    width = frequency_option(step, "--step") if step else (high - low) / DEFAULT_LINES
    if not width > 0 or (high - low) / width > MOST_LINES:
        raise InputError("--step", got=f"'{step}'", expected=f"a positive step, for at most {MOST_LINES:,} lines")
    return FrfRequest("", _spot(drive, "--drive"), response_spot, chosen, (low, high), width)


def _band(text: str) -> tuple[float, float]:
    low, colon, high = text.partition(":")
    if not colon:
        raise InputError("--band", got=f"'{text}'", expected="two frequencies, such as '1 Hz:500 Hz'")
    band = frequency_option(low.strip(), "--band"), frequency_option(high.strip(), "--band")
    if not 0 <= band[0] < band[1]:
        raise InputError("--band", got=f"'{text}'", expected="a lower and a higher frequency")
    return band


def _spot(text: str, where: str) -> Spot:
    name, _, what = text.rpartition(".")
    if not name:
        raise InputError(where, got=f"'{text}'", expected="POINT.direction, NAME.force or PART.stress, such as O_s.z")
    return Spot(name, what)
