"""What the commands of a study share: read, simulate, print, watch, and the exit code it deserves."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from femstruct.commands.shared import as_typed
from femstruct.exits import GOOD, INTERRUPTED, NOT_TRUSTED

if TYPE_CHECKING:
    from femstruct.study.result import StudyResult
    from femstruct.study.study import Plan
    from femstruct.workflow.progress import Progress


def stages(study: Path, case: str, sets: list[str], as_json: bool, verbose: bool, with_rooms: bool) -> int:
    """Simulate a study and print it; nothing is written. Returns the exit code."""
    _, result = solved(study, sets, case, with_rooms=with_rooms)
    return shown(result, {}, "", as_json, verbose)


def shown(
    result: StudyResult, seconds: Mapping[str, float], folder: str, as_json: bool, verbose: bool, told: str = ""
) -> int:
    """Print a result, as tables or as JSON; returns its exit code.

    seconds : of CPU, by stage, for writing to the folder. told : what more there is to say, not in JSON.
    """
    if as_json:
        from femstruct.files.tables.study_tables import summary

        print_json(summary(result))
    else:
        from femstruct.view.tables.terminal import show_study

        show_study(result, seconds, folder, verbose)
        if told:
            print(told)
    return verdict(result)


def solved(study: Path, sets: list[str], case: str, with_rooms: bool = True) -> tuple[Plan, StudyResult]:
    """A study as it was read, and its result."""
    from femstruct.language import read_study
    from femstruct.workflow.run.run import run_study, without_rooms
    from femstruct.workflow.stages.positions import positioned

    plan = read_study(study, tuple(sets), only=case or None)
    if not with_rooms:
        plan = without_rooms(plan)
    with progress() as tell, positioned(plan):
        return plan, run_study(plan, tell, as_typed())


def watched(
    study: Path,
    sets: list[str],
    case: str,
    folder: Path,
    as_json: bool,
    verbose: bool,
    pictures: bool,
    keep: Progress | None,
) -> int:
    """Rounds of a study until Ctrl-C; then all files of the last one are written. keep : as for `rounds`."""
    from femstruct.exits import tell
    from femstruct.workflow.run.output import write_all
    from femstruct.workflow.run.watch import rounds

    code, last = GOOD, None
    try:
        with progress() as told:
            for one in rounds(study, sets, case, folder, told, command=as_typed(), keep=keep):
                if one.error is not None:
                    code = tell(one.error)
                    said = "Not run: the last results are unchanged"
                elif one.result is not None:
                    code, last = verdict(one.result), one.result
                    shown(last, {}, str(folder), as_json, verbose)
                    said = f"{one.seconds:.2f} s, reused: {one.reused}"
                print(f"{said}; waiting for a change, Ctrl-C ends", file=sys.stderr)
                told("waiting for a change of the study's files")
    except KeyboardInterrupt:
        if last is not None:
            print("writing results.h5 and pictures of the last run too; Ctrl-C again leaves them out", file=sys.stderr)
            with progress() as told:
                write_all(last, folder, told, pictures)
    return code


def verdict(result: StudyResult) -> int:
    """The exit code of a result: 3 if any finding forbids to trust it."""
    if any(finding.code == "interrupted" for finding in result.findings):
        return INTERRUPTED
    severe = [finding for case in result.cases.values() for finding in case.findings if finding.severe]
    return NOT_TRUSTED if severe else GOOD


def on_stderr(line: str) -> None:
    """A line beside what is printed, for a person."""
    print(line, file=sys.stderr)


def progress() -> Any:
    """A line that says what is being computed, on a terminal."""
    from femstruct.view.tables.console import progress as shown

    return shown()


def print_json(table: Any) -> None:
    """A table as JSON on stdout."""
    print(json.dumps(table, indent=1, allow_nan=False))


def responses(
    model: Path,
    drives: list[str],
    heard: list[str],
    asked: tuple[str, str, str, str],
    to: Literal["csv", "npz", "uff"] | None,
    folder: Path,
    sets: tuple[str, ...],
    as_json: bool,
    verbose: bool,
) -> int:
    """Print several frequency responses of a model, or write them to a file; returns the exit code.

    asked : band, step, kind and method.
    """
    from femstruct.files.atomic import refuse_unwritable
    from femstruct.view.tables.structure_tables import show_frfs, show_written
    from femstruct.workflow.exchange.asked_responses import frfs_of, refuse_unknown, write_frfs

    band, step, kind, method = asked
    refuse_unknown(to or "", method)
    if to is not None:
        refuse_unwritable(folder)
    with progress() as tell:
        tell("modes and frequency responses")
        table, told, positions = frfs_of(model, drives, heard, band, step, kind, sets)
    if to is not None:
        path = write_frfs(table, positions, to, folder, model, as_typed())
        written = {"written": [str(path)], "findings": told["findings"]}
        print_json(written) if as_json else show_written(written, verbose)
    else:
        print_json(told) if as_json else show_frfs(told, verbose)
    return NOT_TRUSTED if any(finding["severe"] for finding in told["findings"]) else GOOD
