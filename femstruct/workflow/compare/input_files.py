"""What differs in the input files of finished runs, and in what they were run with."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from femstruct.errors import InputErrors
from femstruct.language.yaml import Mistakes, lines_of_keys, parse_value
from femstruct.study.result import StudyResult
from femstruct.study.study import Plan

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
    gone = removed if isinstance(removed, list) else [removed]
    return {*map(str, case), *(map(str, added) if isinstance(added, dict) else ()), *map(str, gone)}


def _changed(mine: Sequence[_File], theirs: Sequence[_File]) -> Iterator[str]:
    pairs = _pairs(mine, theirs)
    for one, other in pairs:
        yield from _between(one, other)
    for told, files in (("the first", mine), ("the second", theirs)):
        alone = [one.name for one in files if not any(one is paired for pair in pairs for paired in pair)]
        if alone:
            yield f"only {told} has {', '.join(alone)}"


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
    told = " | ".join(text.strip() for _, text in rows[:LINES])
    if len(rows) > 1 and len(told) > LONGEST:
        told = f"{told[:LONGEST]} .."
    more = f" (and {len(rows) - LINES} more lines)" if rows[LINES:] else ""
    return f"{told}{more}" if rows else "(nothing)"
