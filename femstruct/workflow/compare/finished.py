"""Finished runs side by side: their cases as those of one study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import log10
from pathlib import Path
from typing import Final

from femstruct.errors import Finding, InputError
from femstruct.findings.catalogue import ranked
from femstruct.study.machine import GroundForce, Machine
from femstruct.study.result import CaseResult, StudyResult
from femstruct.study.study import Plan
from femstruct.workflow.compare.at_modes import Spectra
from femstruct.workflow.compare.compare import compare
from femstruct.workflow.compare.input_files import differences
from femstruct.workflow.run.provenance import provenance
from femstruct.workflow.stages.recorded.peaks import change_findings

CHANGE: Final = "change-not-converged"  # a finding beside a baseline
ALONE: Final = "as given"  # the case of a study without cases
BETWEEN: Final = ": "  # run and case


def names_of(paths: Sequence[str | Path]) -> list[str]:
    """A name for each run: that of its folder, with as much of the path before it as tells them apart.

    Raises InputError for a run that is given twice.

    >>> names_of(["results/a/results.h5", "results/b", "old/b"])
    ['a', 'results/b', 'old/b']
    """
    folders = [path.parent if path.suffix == ".h5" else path for path in map(Path, paths)]
    whole = [folder.absolute().parts for folder in folders]
    if len(set(whole)) < len(whole):
        raise InputError("results", got="a run that is given twice", expected="different runs")
    names = []
    for parts in whole:
        length = 1
        while sum(other[-length:] == parts[-length:] for other in whole) > 1:
            length += 1
        names.append("/".join(parts[-length:]))
    return names


def beside(runs: Mapping[str, StudyResult], command: str = "") -> StudyResult:
    """Several runs as one, the baseline of the first being that of all.

    runs : by name, two or more. Cases are named "RUN: CASE", those of a run with one case "RUN".

    Returns a result as of one study with all cases, and what differs in the input files; what is not compared is as it
    was in each run.
    """
    named = {(run, case): _named(run, case, result) for run, result in runs.items() for case in result.cases}
    first, reference = next(iter(runs.items()))
    baseline = named[first, reference.plan.baseline]
    cases = {
        named[run, case]: replace(one, case=replace(one.case, name=named[run, case]))
        for run, result in runs.items()
        for case, one in result.cases.items()
    }
    comparison = replace(compare(baseline, cases, Spectra()), inputs=differences(runs))
    told = {name: replace(one, findings=_findings(cases[baseline], one)) for name, one in cases.items()}
    whole = StudyResult(
        plan=_plan(runs, named, baseline),
        bases={key: one for result in runs.values() for key, one in result.bases.items()},
        models={key: one for result in runs.values() for key, one in result.models.items()},
        cases=told,
        comparison=comparison,
        findings=tuple(dict.fromkeys(one for result in runs.values() for one in result.findings)),
        timings={},
        provenance=provenance(command),
        verdicts={named[run, case]: one for run, result in runs.items() for case, one in result.verdicts.items()},
        machine={named[run, case]: one for run, result in runs.items() for case, one in result.machine.items()},
    )
    return replace(whole, machine=_grounded(whole.machine, baseline))


def _findings(baseline: CaseResult, one: CaseResult) -> tuple[Finding, ...]:
    """What is to be known of a case, beside the baseline that it has now."""
    changes = change_findings(baseline.channels, one.channels)
    return ranked((*(known for known in one.findings if known.code != CHANGE), *changes))


def _named(run: str, case: str, result: StudyResult) -> str:
    return run if len(result.cases) == 1 and case == ALONE else f"{run}{BETWEEN}{case}"


def _plan(runs: Mapping[str, StudyResult], named: Mapping[tuple[str, str], str], baseline: str) -> Plan:
    cases = tuple(
        replace(case, name=named[run, case.name])
        for run, result in runs.items()
        for case in result.plan.cases
        if (run, case.name) in named
    )
    sources = {f"{run}/{name}": text for run, result in runs.items() for name, text in result.plan.sources.items()}
    return Plan(" beside ".join(runs), cases, baseline, sources)


def _grounded(machine: Mapping[str, Machine], baseline: str) -> dict[str, Machine]:
    """The forces on the ground beside that of the baseline."""
    reference = machine[baseline].ground if baseline in machine else None

    def told(name: str, ground: GroundForce | None) -> GroundForce | None:
        if ground is None:
            return None
        if reference is None or name == baseline or not (reference.dynamic and ground.dynamic):
            return replace(ground, percent=None, attenuation_db=None)
        share = ground.dynamic / reference.dynamic
        return replace(ground, percent=100.0 * (share - 1.0), attenuation_db=-20.0 * log10(share))

    return {name: replace(one, ground=told(name, one.ground)) for name, one in machine.items()}
