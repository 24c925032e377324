"""Commands on results: the page and the pictures again, and runs side by side."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from femstruct.commands.shared import AsJson, OutputHere, Verbose, WithoutPictures, as_typed, command
from femstruct.commands.study_answers import on_stderr, print_json, progress, shown, verdict
from femstruct.exits import GOOD, INTERRUPTED, NOT_TRUSTED

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
    from femstruct.files.atomic import refuse_unwritable
    from femstruct.files.results_file.stored import results_file
    from femstruct.workflow.run.output import redraw

    source = results_file(results)
    folder = output or source.parent
    refuse_unwritable(folder)
    with progress() as tell:
        result, told = redraw(source, folder, tell, not no_pictures, on_stderr)
    code = shown(result, {}, str(folder), as_json, verbose, told)
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
    from femstruct.commands.drawn_again import pictures_of, plotted
    from femstruct.files.atomic import refuse_unwritable
    from femstruct.files.results_file.stored import read_results, results_file

    refuse_unwritable(output)
    result = read_results(results_file(results))
    if what:
        with progress() as tell:
            tell(f"picture {what}")
            lines = [str(path) for path in plotted(result, what, output)]
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
    from femstruct.files.atomic import refuse_unwritable
    from femstruct.files.results_file.stored import read_results, results_file
    from femstruct.files.tables.study_tables import summary
    from femstruct.workflow.compare.finished import beside, names_of
    from femstruct.workflow.run.output import write_all

    if len(results) < 2:
        raise InputError("compare", got="one run", expected="two or more", do="name another results.h5 or its folder")
    if output is not None:
        refuse_unwritable(output)
    names = names_of(results)
    with progress() as tell:
        tell("reading")
        runs = {name: read_results(results_file(path)) for name, path in zip(names, results, strict=True)}
        whole = beside(runs, as_typed())
        seconds, told = ({}, "") if output is None else write_all(whole, output, tell, not no_pictures, on_stderr)
    if as_json:
        print_json(summary(whole) | {"differences": list(whole.comparison.inputs)})
        return verdict(whole)
    return shown(whole, seconds, str(output or ""), as_json, verbose, told)
