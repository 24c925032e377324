"""One frequency response of a model, as the command line asks for it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acoustics.errors import Advice
from femstruct.assembly.assemble import assemble
from femstruct.errors import Finding, InputError
from femstruct.files.tables.finding_tables import finding_table
from femstruct.findings.catalogue import ranked
from femstruct.language import read_model_file
from femstruct.modal.basis import ModalBasis
from femstruct.modal.damping import Damping, with_damping
from femstruct.modal.frf import KINDS, direct_frf
from femstruct.modal.steady.between_lines import Highest
from femstruct.model.probe import Probe
from femstruct.study.asked import Extent, FrfRequest, Spot
from femstruct.study.result import Frf
from femstruct.study.study import Study
from femstruct.workflow.check.asked_modes import frequency_option
from femstruct.workflow.check.asked_stress import STRESS, stress_response
from femstruct.workflow.judgement.all_findings import all_findings
from femstruct.workflow.judgement.impact_findings import room_findings
from femstruct.workflow.progress import Progress
from femstruct.workflow.stages.modal_bases import Solved, in_air, solve
from femstruct.workflow.stages.positions import positioned
from femstruct.workflow.stages.responses import force_axis, frequency_response

DEFAULT_LINES = 500
MOST_BY_DEFAULT = 20_000
MOST_LINES = 1_000_000
Table = dict[str, Any]


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

    kind : "" for accelerance, and transmissibility of a force.

    Notes
    -----
    The basis holds all modes up to 2.5 times the upper end of the band, where residual vectors leave 1e-3.
    """
    request = asked_for(drive, response, band, step, kind)
    if method not in ("modal", "direct"):
        raise InputError("--method", got=f"'{method}'", expected="modal or direct")
    if method == "direct" and request.response.what == STRESS:
        raise InputError("--method", got="'direct' of a stress", expected="modal")
    source = read_model_file(path, overrides)
    with positioned(source):
        progress("modes")
        asking = Study(source.title, source.structure, source.damping, Extent(), frf=(request,))
        solved = solve(source.structure, Extent(up_to_hz=2.5 * request.band[1]), (asking,))
        basis = in_air(with_damping(solved.basis, source.damping), solved)
        findings = all_findings(solved, basis, requests=(request,), up_to_hz=request.band[1])
        progress("frequency response")
        if request.response.what == STRESS:
            told, uneven = stress_response(request, solved, basis)
            findings = ranked((*findings, *uneven))
        else:
            answer, known = _response(request, solved, basis, progress)
            largest = answer.highest
            if not step and method == "modal" and largest is not None and largest.needed < largest.step:
                request = replace(request, step=finer(request, largest.needed))
                answer, known = _response(request, solved, basis, progress, largest)
            findings = ranked((*findings, *room_findings([(f"{response} / {drive}", one) for one in known])))
            values = _direct(request, solved, source.damping, answer) if method == "direct" else answer.values
            told = {
                "kind": request.kind,
                "frequency_hz": answer.frequency_hz.tolist(),
                "real": np.real(values).tolist(),
                "imag": np.imag(values).tolist(),
                "unit": answer.unit,
            }
    about = {"title": source.title, "drive": drive, "response": response, "method": method}
    return {**about, **told, "findings": [finding_table(finding) for finding in findings]}


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


def asked_for(drive: str, response: str, band: str, step: str, kind: str) -> FrfRequest:
    """What the command line asks for, checked.

    Raises InputError that begins with the option's own name.
    """
    listened = _spot(response, "--response")
    chosen = kind or ("transmissibility" if listened.what.startswith("force") else "accelerance")
    if listened.what == STRESS:
        if kind:
            raise InputError("--kind", got=f"'{kind}' of a stress", expected="no kind: stress is per force")
        chosen = "receptance"
    if chosen not in KINDS:
        raise InputError("--kind", got=f"'{kind}'", expected=", ".join(KINDS))
    low, high = _band(band)
    width = frequency_option(step, "--step") if step else (high - low) / DEFAULT_LINES
    if not width > 0 or (high - low) / width > MOST_LINES:
        raise InputError("--step", got=f"'{step}'", expected=f"a positive step, for at most {MOST_LINES:,} lines")
    return FrfRequest("", _spot(drive, "--drive"), listened, chosen, (low, high), width)


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
