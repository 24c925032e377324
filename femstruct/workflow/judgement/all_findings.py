"""The one judgement that every command goes through: what is to be known before a solution, and with the modes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from femstruct.errors import Finding, some_of
from femstruct.findings.catalogue import ranked
from femstruct.modal.basis import ModalBasis
from femstruct.study.asked import FrfRequest
from femstruct.study.study import Case, Study
from femstruct.workflow.judgement.structure_findings import (
    structure_findings,
    structure_findings_before,
)
from femstruct.workflow.judgement.study_findings import study_findings
from femstruct.workflow.judgement.undamped import undamped_motion
from femstruct.workflow.stages.modal_bases import Meshed, Solved
from femstruct.workflow.stages.responses import undamped_findings
from femstruct.workflow.stages.vibrations import beyond_modes


def early_findings(case: Case, own: Meshed) -> tuple[Finding, ...]:
    """All that can be said of a case without its modes, by rank."""
    before = structure_findings_before(own.structure, own.model, case.studies, case.study.extent.up_to_hz)
    return ranked((*before, *study_findings(case, own.places)))


def all_findings(
    solved: Solved,
    basis: ModalBasis,
    studies: Sequence[Study] = (),
    requests: Sequence[FrfRequest] = (),
    up_to_hz: float | None = None,
) -> tuple[Finding, ...]:
    """All that can be said of a structure and its modes, by rank.

    basis : with its damping. studies : of one case; they excite it alike. requests : frequency responses that are asked
    of it. up_to_hz : the highest frequency that is looked at [Hz]; without it the mesh is judged as far as the modes
    are complete.
    """
    return ranked(
        (
            *structure_findings(solved, basis, studies, up_to_hz),
            *undamped_motion(studies, basis),
            *(finding for request in requests for finding in undamped_findings(basis, request)),
            *(finding for study in studies[:1] for one in study.vibration for finding in beyond_modes(one, basis)),
            *(
                told
                for study in studies[:1]
                for one in study.evaluations
                for told in one.doubts(basis.complete_below_hz)
            ),
        )
    )


def of_cases(told: Mapping[str, Sequence[Finding]]) -> tuple[Finding, ...]:
    """Findings of cases by name, each once, with the names of its cases where it is not of all; by rank.

    >>> sags, rings = Finding("a", "It sags."), Finding("b", "It rings.")
    >>> [finding.message for finding in of_cases({"as given": [sags], "stiffer": [sags, rings]})]
    ['It sags.', 'It rings. (case stiffer)']
    """
    names: dict[tuple[str, str], list[str]] = {}
    first: dict[tuple[str, str], Finding] = {}
    for case, findings in told.items():
        for finding in findings:
            key = (finding.code, finding.message)
            names.setdefault(key, [])
            if case not in names[key]:
                names[key].append(case)
            first.setdefault(key, finding)

    def placed(key: tuple[str, str]) -> Finding:
        own = names[key]
        if len(own) == len(told):
            return first[key]
        return replace(first[key], message=f"{key[1]} (case{'s' if len(own) > 1 else ''} {some_of(own)})")

    return ranked([placed(key) for key in first])
