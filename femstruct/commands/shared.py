"""What commands share: how they end, and the arguments that several of them have."""

from __future__ import annotations

import functools
import json
import sys
from collections.abc import Callable, Mapping
from difflib import get_close_matches
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

import typer

from femstruct.errors import InputError, InputErrors, sentence
from femstruct.exits import GOOD, INTERRUPTED, NOT_TRUSTED, refuse_unreadable_words

if TYPE_CHECKING:
    from femstruct.study.results import StudyResult
    from femstruct.study.study import Plan
    from femstruct.workflow.provenance import Progress


StudyFile = Annotated[Path, typer.Argument(metavar="STUDY", help="a study: what happens to a structure (YAML)")]
ModelFile = Annotated[Path, typer.Argument(metavar="MODEL", help="a model: what the structure is (YAML)")]
AsJson = Annotated[bool, typer.Option("--json", help="print JSON to stdout")]
Sets = Annotated[list[str], typer.Option("--set", metavar="PATH=VALUE", help="change one value of the input files")]
Verbose = Annotated[bool, typer.Option("-v", "--verbose", help="also print findings that are remarks")]
OnlyCase = Annotated[str, typer.Option("--case", metavar="CASE", help="run only this case")]
Modes = Annotated[int | None, typer.Option("--count", min=1, help="number of modes")]
FirstModes = Annotated[
    str, typer.Option("--up-to", metavar="F", help="all modes up to a frequency (default: the first 30)")
]
Near = Annotated[
    str, typer.Option("--near", metavar="PERCENT", help="width of a group of near-equal frequencies, one space")
]
Workers = Annotated[int, typer.Option("--workers", metavar="N", min=0, help="processes", show_default="one a core")]
Cluster = Annotated[str, typer.Option("--cluster", metavar="ADDRESS", help="of a Dask scheduler")]
NumbersOnly = Annotated[bool, typer.Option("--no-pictures", help="numbers and tables only")]
WithoutPictures = Annotated[
    bool,
    typer.Option("--no-pictures", help="numbers, tables and sound only, in half the time; removes earlier pictures"),
]
OutputHere = Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="folder", show_default="here")]
NONE: Final[list[str]] = []  # typer gives each call a list of its own


def as_typed() -> str:
    """The command that runs, for results that name it."""
    return " ".join(["femstruct", *sys.argv[1:]])


def command(function: Callable[..., int]) -> Callable[..., None]:
    """A command that exits with the code its function returns; an interruption is not a failure."""

    @functools.wraps(function)
    def called(*args: Any, **options: Any) -> None:
        refuse_unreadable_words(options)
        try:
            code = function(*args, **options)
        except KeyboardInterrupt:
            print("Interrupted. No partial files were written; existing files are unchanged.", file=sys.stderr)
            code = INTERRUPTED
        raise typer.Exit(code)

    return called


# ----------------------------------------------------------------------------------------------------------------------
# What the commands that read a results file share: find it, draw of it what is asked for. Nothing is solved.
# ----------------------------------------------------------------------------------------------------------------------

LINE: Final = 110  # characters of a line of names
SOLID: Final = ("model", "mode_shapes", "rooms", "stress")  # pictures in three dimensions, some of several files


def pictures_of(result: StudyResult) -> dict[str, str]:
    """The pictures that a study may have, by the names of the files without their ending: "" of those that can be
    drawn, of others why not."""
    from femstruct.view.plots import drawings
    from femstruct.view.room_scene import no_room_pictures
    from femstruct.view.undrawn import no_model, no_shapes, no_stresses

    flat = {name.removesuffix(".png"): one.why_not() for name, one in drawings(result).items()}
    solid = (no_model(result), no_shapes(result), no_room_pictures(result), no_stresses(result))
    return flat | dict(zip(SOLID, solid, strict=True))


def plot_picture(result: StudyResult, what: str, folder: Path) -> list[Path]:
    """Draw one picture of a study, or all shapes of modes, or all of its rooms, to a folder; returns the files.

    Raises InputError for a name that is none of `pictures_of`, and for a picture with nothing to show, with the reason.
    """
    from femstruct.view.drawing import save
    from femstruct.view.plots import drawings

    known = pictures_of(result)
    if what not in known:
        names = [name for name, why_not in known.items() if not why_not]
        near = get_close_matches(what, names, n=1)
        do = f"did you mean '{near[0]}'?" if near else ""
        listed = wrap(", ".join(names), LINE, break_long_words=False, break_on_hyphens=False)
        raise InputErrors((sentence("WHAT", f"'{what}'", "one of these names", do), *listed))
    if known[what]:
        got = f"nothing to show in this study: {known[what]}"
        raise InputError(what, got=got, expected="a picture that can be drawn", do="choose another one")
    folder.mkdir(parents=True, exist_ok=True)
    if what not in SOLID:
        figure = drawings(result)[f"{what}.png"].draw()
        return [save(figure, folder / f"{what}.png")] if figure is not None else []
    from femstruct.view.model_scene import draw_in_process, model_picture, shapes_all
    from femstruct.view.room_scene import room_pictures, stress_pictures

    draw = dict(zip(SOLID, (model_picture, shapes_all, room_pictures, stress_pictures), strict=True))[what]
    paths, left_out = draw_in_process(lambda: draw(result, folder))()
    if not paths:
        raise InputError(what, got=left_out, expected="a picture that can be drawn", do="choose another one")
    return paths


# ----------------------------------------------------------------------------------------------------------------------
# What the commands of a study share: read, simulate, print, watch, and the exit code it deserves.
# ----------------------------------------------------------------------------------------------------------------------


def simulate_and_show(study: Path, case: str, sets: list[str], as_json: bool, verbose: bool, with_rooms: bool) -> int:
    """Simulate a study and print it; nothing is written. Returns the exit code."""
    _, result = read_and_run(study, sets, case, with_rooms=with_rooms)
    return show_result(result, {}, "", as_json, verbose)


def show_result(
    result: StudyResult, seconds: Mapping[str, float], folder: str, as_json: bool, verbose: bool, message: str = ""
) -> int:
    """Print a result, as tables or as JSON; returns its exit code.

    Parameters
    ----------
    seconds : Mapping[str, float]
        Of CPU, by stage, for writing to the folder.
    message : str
        What more there is to say, not in JSON.
    """
    if as_json:
        from femstruct.files.study_tables import summary

        print_json(summary(result))
    else:
        from femstruct.view.terminal import show_study

        show_study(result, seconds, folder, verbose)
        if message:
            print(message)
    return verdict(result)


def read_and_run(study: Path, sets: list[str], case: str, with_rooms: bool = True) -> tuple[Plan, StudyResult]:
    """A study as it was read, and its result."""
    from femstruct.language.cases import read_study
    from femstruct.workflow.bases import with_positions
    from femstruct.workflow.run import run_study, without_rooms

    plan = read_study(study, tuple(sets), only=case or None)
    if not with_rooms:
        plan = without_rooms(plan)
    with progress() as tell, with_positions(plan):
        return plan, run_study(plan, tell, as_typed())


def watch_study(
    study: Path,
    sets: list[str],
    case: str,
    folder: Path,
    as_json: bool,
    verbose: bool,
    pictures: bool,
    keep: Progress | None,
) -> int:
    """Rounds of a study until Ctrl-C; then all files of the last one are written.

    Parameters
    ----------
    keep : Progress | None
        As for `rounds`.
    """
    from femstruct.exits import tell
    from femstruct.workflow.run import write_all
    from femstruct.workflow.watch import rounds

    code, last = GOOD, None
    try:
        with progress() as report:
            for one in rounds(study, sets, case, folder, report, command=as_typed(), keep=keep):
                if one.error is not None:
                    code = tell(one.error)
                    message = "Not run: the last results are unchanged"
                elif one.result is not None:
                    code, last = verdict(one.result), one.result
                    show_result(last, {}, str(folder), as_json, verbose)
                    message = f"{one.seconds:.2f} s, reused: {one.reused}"
                print(f"{message}; waiting for a change, Ctrl-C ends", file=sys.stderr)
                report("waiting for a change of the study's files")
    except KeyboardInterrupt:
        if last is not None:
            print("writing results.h5 and pictures of the last run too; Ctrl-C again leaves them out", file=sys.stderr)
            with progress() as report:
                write_all(last, folder, report, pictures)
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
    from femstruct.view.console import progress as shown

    return shown()


def print_json(table: Any) -> None:
    """A table as JSON on stdout."""
    print(json.dumps(table, indent=1, allow_nan=False))


def responses(
    model: Path,
    drives: list[str],
    receivers: list[str],
    asked: tuple[str, str, str, str],
    to: Literal["csv", "npz", "uff"] | None,
    folder: Path,
    sets: tuple[str, ...],
    as_json: bool,
    verbose: bool,
) -> int:
    """Print several frequency responses of a model, or write them to a file; returns the exit code.

    Parameters
    ----------
    asked : tuple[str, str, str, str]
        Band, step, kind and method.
    """
    from femstruct.files.writing import refuse_unwritable
    from femstruct.view.structure_tables import show_frfs, show_written
    from femstruct.workflow.exchange import frfs_of, refuse_unknown, write_frfs

    band, step, kind, method = asked
    refuse_unknown(to or "", method)
    if to is not None:
        refuse_unwritable(folder)
    with progress() as tell:
        tell("modes and frequency responses")
        table, answer, positions = frfs_of(model, drives, receivers, band, step, kind, sets)
    if to is not None:
        path = write_frfs(table, positions, to, folder, model, as_typed())
        written = {"written": [str(path)], "findings": answer["findings"]}
        print_json(written) if as_json else show_written(written, verbose)
    else:
        print_json(answer) if as_json else show_frfs(answer, verbose)
    return NOT_TRUSTED if any(finding["severe"] for finding in answer["findings"]) else GOOD
