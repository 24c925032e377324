"""What differs in the input files of finished runs, and in what they were run with."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import log10
from pathlib import Path
from typing import Any, Final

from femstruct.errors import Finding, InputError, InputErrors
from femstruct.findings.catalogue import rank_findings
from femstruct.study.asked import GroundForce, Machine
from femstruct.study.results import CaseResult, StudyResult
from femstruct.study.study import Plan
from femstruct.workflow.case_comparison import Spectra, compare
from femstruct.workflow.provenance import provenance
from femstruct.workflow.recorded_channels import change_findings
from femstruct.yaml.reader import Mistakes, lines_of_keys, parse_value

MOST: Final = 40  # lines of differences for each file
LINES: Final = 4  # of the files in one of them
LONGEST: Final = 120  # characters of several of them
OF_CAMPAIGNS: Final = ("vary", "samples", "optimise")  # blocks of a study that a run does not read
STUDY, MODEL, OTHER = "study", "model", "other"


@dataclass(frozen=True)
class _File:
    """An input file: its name, its text, and as YAML its keys with their values and the lines [from 1] of each."""

    name: str
    text: str
    value: Mapping[str, Any]
    lines: Mapping[str, range]

    @property
    def kind(self) -> str:
        return STUDY if "model" in self.value else MODEL if self.value else OTHER


def differences(runs: Mapping[str, StudyResult]) -> tuple[str, ...]:
    """What differs between the files of the first run and those of each other, a line each, and what --set changed.

    Blocks that only sweeps and optimisations read are named, and not listed. Files are paired by their names, those of
    other names by what they are: studies, models, tables.
    """
    first, *others = runs
    files = {name: _files(result.plan) for name, result in runs.items()}
    lines: list[str] = []
    for name in others:
        changed = list(_changed(files[first], files[name]))
        same = "the same input files" if files[first] or files[name] else "made in Python, without input files"
        lines += [f"{first} and {name}: {same}"] if not changed else []
        lines += [f"{first} -> {name}: {line}" for line in changed]
    for name, result in runs.items():
        given = _set_by_hand(result, files[name])
        lines += [f"{name} was run with {', '.join(f'--set {one}' for one in given)}"] if given else []
    return tuple(lines)


def _files(plan: Plan) -> list[_File]:
    return [_file(name, text) for name, text in plan.sources.items()]


def _file(name: str, text: str) -> _File:
    if not name.lower().endswith((".yaml", ".yml")):
        return _File(name, text, {}, {})
    try:
        value = parse_value(text, name, Mistakes()).value
        return _File(name, text, value if isinstance(value, dict) else {}, lines_of_keys(text, name))
    except InputErrors:  # of an older version, or made by a program
        return _File(name, text, {}, {})


def _set_by_hand(result: StudyResult, files: Sequence[_File]) -> list[str]:
    """Changes of the cases that no case of the study file has: they are of the command line. Of runs that stand side by
    side already it is stated by them."""
    listed = next((one.value.get("cases") for one in files if one.kind == STUDY), None)
    if result.comparison.inputs or not files:
        return []
    cases = listed if isinstance(listed, dict) else {}
    found = (
        f"{path}={text}"
        for case in result.plan.cases
        for path, text in case.changes.items()
        if path not in _own(cases.get(case.name))
    )
    return list(dict.fromkeys(found))


def _own(case: Any) -> set[str]:
    """The paths that a case of a study file changes, adds or removes."""
    if not isinstance(case, dict):
        return set()
    added, removed = case.get("add"), case.get("remove")
    removed_names = removed if isinstance(removed, list) else [removed]
    return {*map(str, case), *(map(str, added) if isinstance(added, dict) else ()), *map(str, removed_names)}


def _changed(mine: Sequence[_File], theirs: Sequence[_File]) -> Iterator[str]:
    pairs = _pairs(mine, theirs)
    for one, other in pairs:
        yield from _between(one, other)
    for word, files in (("the first", mine), ("the second", theirs)):
        alone = [one.name for one in files if not any(one is paired for pair in pairs for paired in pair)]
        if alone:
            yield f"only {word} has {', '.join(alone)}"


def _pairs(mine: Sequence[_File], theirs: Sequence[_File]) -> list[tuple[_File, _File]]:
    """Files of one kind: of the same name, then of others in their order."""
    pairs: list[tuple[_File, _File]] = []
    left = list(theirs)
    for by_name in (True, False):
        for one in mine:
            if any(one is taken for taken, _ in pairs):
                continue
            fits = (o for o in left if o.kind == one.kind and (o.name == one.name or not by_name))
            if (other := next(fits, None)) is not None:
                left.remove(other)
                pairs.append((one, other))
    return sorted(pairs, key=lambda pair: next(i for i, one in enumerate(mine) if one is pair[0]))


def _between(one: _File, other: _File) -> Iterator[str]:
    named = one.name if one.name == other.name else f"{one.name} / {other.name}"
    rows = (_rows(one), _rows(other))
    mine, theirs = ([text for _, text in side] for side in rows)
    matcher = difflib.SequenceMatcher(None, mine, theirs, autojunk=False)
    found = [
        f"{named}:{_line(rows[0], start, one)}: {_cut(rows[0][start:end])} -> {_cut(rows[1][begin:stop])}"
        for tag, *ends in matcher.get_opcodes()
        for start, end, begin, stop in (_line_by_line(*ends) if tag != "equal" else ())
    ]
    yield from found[:MOST]
    if len(found) > MOST:
        yield f"{named}: {len(found) - MOST} more"
    unread = [key for key in OF_CAMPAIGNS if one.kind == STUDY and one.value.get(key) != other.value.get(key)]
    if unread:
        yield f"{named}: other blocks, which a run does not read: {', '.join(unread)}"


def _line_by_line(start: int, end: int, begin: int, stop: int) -> Iterator[tuple[int, int, int, int]]:
    """A block that is replaced by one of as many lines, line by line; any other as it is.

    >>> list(_line_by_line(4, 6, 5, 7)), list(_line_by_line(4, 6, 5, 6))
    ([(4, 5, 5, 6), (5, 6, 6, 7)], [(4, 6, 5, 6)])
    """
    if end - start != stop - begin:
        yield start, end, begin, stop
    else:
        yield from ((start + i, start + i + 1, begin + i, begin + i + 1) for i in range(end - start))


def _rows(file: _File) -> list[tuple[int, str]]:
    """The lines of a file with their numbers, without blocks that a run does not read."""
    unread = [file.lines[key] for key in OF_CAMPAIGNS if key in file.lines] if file.kind == STUDY else []
    rows = enumerate(file.text.splitlines(), 1)
    return [(number, text) for number, text in rows if not any(number in block for block in unread)]


def _line(rows: Sequence[tuple[int, str]], start: int, file: _File) -> int:
    return rows[start][0] if start < len(rows) else len(file.text.splitlines()) + 1


def _cut(rows: Sequence[tuple[int, str]]) -> str:
    """Some lines of a file as one, of many the beginning.

    >>> _cut([(1, "a: 1"), (2, "  b: 2")]), _cut([]), len(_cut([(1, 300 * "a"), (2, "b")])) < 140
    ('a: 1 | b: 2', '(nothing)', True)
    """
    line = " | ".join(text.strip() for _, text in rows[:LINES])
    if len(rows) > 1 and len(line) > LONGEST:
        line = f"{line[:LONGEST]} .."
    more = f" (and {len(rows) - LINES} more lines)" if rows[LINES:] else ""
    return f"{line}{more}" if rows else "(nothing)"


# ----------------------------------------------------------------------------------------------------------------------
# Finished runs side by side: their cases as those of one study.
# ----------------------------------------------------------------------------------------------------------------------

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


def combine_runs(runs: Mapping[str, StudyResult], command: str = "") -> StudyResult:
    """Several runs as one, the baseline of the first being that of all.

    Parameters
    ----------
    runs : Mapping[str, StudyResult]
        By name, two or more. Cases are named "RUN: CASE", those of a run with one case "RUN".

    Returns
    -------
    StudyResult
        A result as of one study with all cases, and what differs in the input files; what is not compared is as it was
        in each run.
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
    complete = {name: replace(one, findings=_findings(cases[baseline], one)) for name, one in cases.items()}
    whole = StudyResult(
        plan=_plan(runs, named, baseline),
        bases={key: one for result in runs.values() for key, one in result.bases.items()},
        models={key: one for result in runs.values() for key, one in result.models.items()},
        cases=complete,
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
    return rank_findings((*(known for known in one.findings if known.code != CHANGE), *changes))


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
