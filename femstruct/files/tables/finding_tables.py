"""Findings as tables for machines, JSON and HDF5: all of them, each with its rank."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

from acoustics.errors import Advice
from femstruct.errors import Finding
from femstruct.files.tables.json_numbers import number
from femstruct.findings.catalogue import place_of, rank_of
from femstruct.study.recorded import NET_FORCE

if TYPE_CHECKING:  # tables of one structure need nothing of impacts
    from femstruct.study.result import CaseResult, StudyResult

OF_PEAKS: Final = (
    "peak-not-converged",
    "stress-uneven",
    "force-beyond-modes",
)  # findings of one channel, whose name begins their message

OF_EVALUATIONS: Final = "evaluation-not-converged"  # of one evaluation, whose kind and name begin its message


def finding_table(found: Finding | Advice) -> dict[str, Any]:
    """A finding as a table."""
    severe = isinstance(found, Finding) and found.severe
    return {
        "code": found.code,
        "message": found.message,
        "values": {name: number(value) for name, value in found.values.items()},
        "severe": severe,
        "rank": rank_of(found.code, severe).value,
    }


def finding_from(table: Mapping[str, Any]) -> Finding:
    """A finding back from its table.

    >>> finding_from(finding_table(Finding("sags-far", "Far.")))
    Finding(code='sags-far', message='Far.', values={}, severe=False)
    """
    return Finding(table["code"], table["message"], table["values"], table["severe"])


def unquotable(case: CaseResult) -> dict[str, str]:
    """Recorded channels of a case whose peaks are not to be quoted, each with the code of the finding that says so."""
    found = [one for one in case.findings if one.code in OF_PEAKS]
    told = {name: one.code for one in found for name in case.channels if one.message.startswith(f"{name}: ")}
    study = case.case.study
    ends = {one.name: one.between for one in study.contacts}
    ends |= {f"{one.name} on {one.target}": (one.name, one.target) for one in study.bodies}
    net = {f"{NET_FORCE}{end}": "force-beyond-modes" for name in doubtful_forces(case) for end in ends.get(name, ())}
    return told | {name: code for name, code in net.items() if name in case.channels}


def doubtful_forces(case: CaseResult) -> tuple[str, ...]:
    """Contacts of a case whose peak forces are not to be quoted."""
    told = [one.message for one in case.findings if one.code == "force-beyond-modes"]
    contacts = () if case.response is None else case.response.contacts
    return tuple(name for name in contacts if any(one.startswith(f"{name} force: ") for one in told))


def doubtful_answers(case: CaseResult, kind: str, name: str) -> tuple[str, ...]:
    """Numbers of an evaluation that are not to be quoted, as the finding that says so names them."""
    told = [one for one in case.findings if one.code == OF_EVALUATIONS]
    return tuple(number for one in told if one.message.startswith(f"{kind}.{name}: ") for number in one.values)


def findings_by_case(result: StudyResult) -> tuple[tuple[Finding, tuple[str, ...]], ...]:
    """Every distinct finding of a run by rank, and the cases it holds for; none for one of the run as a whole."""
    own = {(finding.code, finding.message): finding for case in result.cases.values() for finding in case.findings}
    holds = {
        key: tuple(
            name
            for name, case in result.cases.items()
            if key in {(finding.code, finding.message) for finding in case.findings}
        )
        for key in own
    }
    found = (*((finding, ()) for finding in result.findings), *((own[key], cases) for key, cases in holds.items()))
    return tuple(sorted(found, key=lambda one: place_of(one[0])))


def study_findings_table(result: StudyResult) -> list[dict[str, Any]]:
    """All findings of a run as tables, each with the cases it holds for."""
    return [finding_table(found) | {"cases": list(cases)} for found, cases in findings_by_case(result)]
