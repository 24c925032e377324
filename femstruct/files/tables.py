"""Numbers, findings and entries of the library as plain tables, for JSON and HDF5."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import TYPE_CHECKING, Any, Final

from acoustics.errors import Advice
from femstruct.errors import Finding
from femstruct.findings.catalogue import rank_of, rank_order
from femstruct.model.library import LibraryEntry
from femstruct.study.recorded import NET_FORCE

if TYPE_CHECKING:
    from femstruct.study.results import CaseResult, StudyResult


# ----------------------------------------------------------------------------------------------------------------------
# Numbers as JSON takes them.
# ----------------------------------------------------------------------------------------------------------------------


def number(value: float | None) -> float | None:
    """A number for JSON, which knows neither nan nor infinity: None instead.

    >>> number(1), number(float("nan"))
    (1.0, None)
    """
    return None if value is None or not isfinite(value) else float(value)


def label(value: float) -> str:
    """A frequency as a key of a table, without a trailing zero.

    >>> label(63.0), label(31.5)
    ('63', '31.5')
    """
    return f"{float(value):.6g}"


# ----------------------------------------------------------------------------------------------------------------------
# Findings as tables for machines, JSON and HDF5: all of them, each with its rank.
# ----------------------------------------------------------------------------------------------------------------------

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
    codes = {name: one.code for one in found for name in case.channels if one.message.startswith(f"{name}: ")}
    study = case.case.study
    ends = {one.name: one.between for one in study.contacts}
    ends |= {f"{one.name} on {one.target}": (one.name, one.target) for one in study.bodies}
    net = {f"{NET_FORCE}{end}": "force-beyond-modes" for name in doubtful_forces(case) for end in ends.get(name, ())}
    return codes | {name: code for name, code in net.items() if name in case.channels}


def doubtful_forces(case: CaseResult) -> tuple[str, ...]:
    """Contacts of a case whose peak forces are not to be quoted."""
    messages = [one.message for one in case.findings if one.code == "force-beyond-modes"]
    contacts = () if case.response is None else case.response.contacts
    return tuple(name for name in contacts if any(one.startswith(f"{name} force: ") for one in messages))


def doubtful_answers(case: CaseResult, kind: str, name: str) -> tuple[str, ...]:
    """Numbers of an evaluation that are not to be quoted, as the finding that says so names them."""
    findings = [one for one in case.findings if one.code == OF_EVALUATIONS]
    return tuple(number for one in findings if one.message.startswith(f"{kind}.{name}: ") for number in one.values)


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
    return tuple(sorted(found, key=lambda one: rank_order(one[0])))


def study_findings_table(result: StudyResult) -> list[dict[str, Any]]:
    """All findings of a run as tables, each with the cases it holds for."""
    return [finding_table(found) | {"cases": list(cases)} for found, cases in findings_by_case(result)]


# ----------------------------------------------------------------------------------------------------------------------
# Entries of the library for JSON.
# ----------------------------------------------------------------------------------------------------------------------


def library_table(entry: LibraryEntry) -> dict[str, Any]:
    """An entry with all of its values in SI units, and where each is printed.

    >>> from femstruct.model.library_entries import library
    >>> table = library_table(library()["screed sand-cement"])
    >>> table["family"], table["values"]["rho"]["value"], table["values"]["rho"]["unit"]
    ('screeds', 2000.0, 'kg/m^3')
    """
    return {
        "name": entry.name,
        "family": entry.family,
        "what": entry.what,
        "use": entry.use.value,
        "layers": [{"thickness_m": thickness, "angle_deg": angle} for thickness, angle in entry.layers] or None,
        "values": {
            one.key: {
                "value": one.value,
                "unit": one.unit or "1",
                "between": one.between,
                "note": one.note or None,
                "source": one.source.work,
                "read_at": one.source.read or None,
            }
            for one in entry.facts
        },
    }
