"""Commands on a study: run it, or parts of it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from femstruct.commands.shared import (
    NONE,
    AsJson,
    OnlyCase,
    OutputHere,
    Sets,
    StudyFile,
    Verbose,
    WithoutPictures,
    as_typed,
    command,
    on_stderr,
    print_json,
    progress,
    read_and_run,
    show_result,
    simulate_and_show,
    verdict,
    watch_study,
)
from femstruct.exits import GOOD, INTERRUPTED, NOT_TRUSTED


@command
def run(
    study: StudyFile,
    case: OnlyCase = "",
    set_: Sets = NONE,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="default: results/<study>/")
    ] = None,
    no_pictures: WithoutPictures = False,
    watch: Annotated[
        bool, typer.Option("--watch", help="run again whenever a file of the study is saved; Ctrl-C ends it")
    ] = False,
    replace: Annotated[
        bool, typer.Option("--replace", help="a run of other inputs in the folder too; else it is kept with a number")
    ] = False,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Run a study and write its results. Modes, responses, impacts, sound and levels become numbers, pictures, tables
    in a folder; a run of other inputs that is there is kept as FOLDER.1."""
    from femstruct.files.writing import refuse_unwritable
    from femstruct.workflow.run import write_all

    folder = output or Path("results") / study.name.removesuffix(".yaml").removesuffix(".study")
    refuse_unwritable(folder)
    keep = None if replace else on_stderr
    if watch:
        return watch_study(
            study, set_, case=case, folder=folder, as_json=as_json, verbose=verbose, pictures=not no_pictures, keep=keep
        )
    _, result = read_and_run(study, set_, case)
    with progress() as tell:
        seconds, message = write_all(result, folder, tell, not no_pictures, keep)
    return show_result(result, seconds, str(folder), as_json, verbose, message)


@command
def impact(
    study: StudyFile,
    case: OnlyCase = "",
    set_: Sets = NONE,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Simulate the impacts of a study. Prints peaks, contacts and energies; no files are written."""
    return simulate_and_show(study, case, set_, as_json, verbose, with_rooms=False)


@command
def sound(
    study: StudyFile,
    case: OnlyCase = "",
    set_: Sets = NONE,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Simulate impacts and the sound in rooms. No files are written."""
    return simulate_and_show(study, case, set_, as_json, verbose, with_rooms=True)


# ----------------------------------------------------------------------------------------------------------------------
# Commands on results: the page and the pictures again, and runs side by side.
# ----------------------------------------------------------------------------------------------------------------------

ResultsFile = Annotated[
    Path, typer.Argument(metavar="RESULTS", help="results.h5 of a run, or the folder that it is in")
]


@command
def report(
    results: ResultsFile,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="default: the folder of the results")
    ] = None,
    no_pictures: WithoutPictures = False,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Write page, tables, pictures, sounds of a results file again. Nothing is computed anew."""
    from femstruct.files.results_file import results_file
    from femstruct.files.writing import refuse_unwritable
    from femstruct.workflow.run import redraw

    source = results_file(results)
    folder = output or source.parent
    refuse_unwritable(folder)
    with progress() as tell:
        result, message = redraw(source, folder, tell, not no_pictures, on_stderr)
    code = show_result(result, {}, str(folder), as_json, verbose, message)
    return NOT_TRUSTED if code == INTERRUPTED else code  # the run was interrupted, not this command


@command
def plot(
    results: ResultsFile,
    what: Annotated[
        str, typer.Argument(metavar="[WHAT]", help="a picture; without it, those that can be drawn are listed")
    ] = "",
    output: OutputHere = Path(),
    as_json: AsJson = False,
    verbose: Annotated[
        bool, typer.Option("-v", "--verbose", help="also list pictures without content, with the reason")
    ] = False,
) -> int:
    """Draw one picture of a results file. Nothing is computed anew."""
    from femstruct.commands.shared import pictures_of, plot_picture
    from femstruct.files.results_file import read_results, results_file
    from femstruct.files.writing import refuse_unwritable

    refuse_unwritable(output)
    result = read_results(results_file(results))
    if what:
        with progress() as tell:
            tell(f"picture {what}")
            lines = [str(path) for path in plot_picture(result, what, output)]
        table: dict[str, Any] = {"written": lines}
    else:
        known = pictures_of(result)
        lines = [name for name, why_not in known.items() if not why_not]
        without = {name: why_not for name, why_not in known.items() if why_not}
        table = {"pictures": lines, "without content": without}
        lines += [f"{name}: without content; {why_not}" for name, why_not in without.items()] if verbose else []
    if as_json:
        print_json(table)
    else:
        print(*lines, sep="\n")
    return GOOD


@command
def compare(
    results: Annotated[
        list[Path],
        typer.Argument(metavar="RESULTS RESULTS ..", help="results.h5 of two or more runs, or folders"),
    ],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="also write page, tables, pictures there"),
    ] = None,
    no_pictures: WithoutPictures = False,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Print finished runs side by side. Their cases stand as those of one study, beside the baseline of the first run,
    after what differs in the input files and in --set. Nothing is computed anew."""
    from femstruct.errors import InputError
    from femstruct.files.results_file import read_results, results_file
    from femstruct.files.study_tables import summary
    from femstruct.files.writing import refuse_unwritable
    from femstruct.workflow.run import write_all
    from femstruct.workflow.run_comparison import combine_runs, names_of

    if len(results) < 2:
        raise InputError("compare", got="one run", expected="two or more", do="name another results.h5 or its folder")
    if output is not None:
        refuse_unwritable(output)
    names = names_of(results)
    with progress() as tell:
        tell("reading")
        runs = {name: read_results(results_file(path)) for name, path in zip(names, results, strict=True)}
        whole = combine_runs(runs, as_typed())
        seconds, message = ({}, "") if output is None else write_all(whole, output, tell, not no_pictures, on_stderr)
    if as_json:
        print_json(summary(whole) | {"differences": list(whole.comparison.inputs)})
        return verdict(whole)
    return show_result(whole, seconds, str(output or ""), as_json, verbose, message)
