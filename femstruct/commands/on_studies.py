"""Commands on a study: run it, parts of it, or fit its parameters."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from femstruct.commands.shared import NONE, AsJson, OnlyCase, Sets, StudyFile, Verbose, command
from femstruct.commands.study_answers import on_stderr, print_json, progress, shown, solved, stages, watched
from femstruct.exits import GOOD, NOT_TRUSTED


@command
def run(
    study: StudyFile,
    case: OnlyCase = "",
    set_: Sets = NONE,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="default: results/<study>/")
    ] = None,
    no_pictures: Annotated[
        bool, typer.Option("--no-pictures", help="numbers, tables and sound only, in half the time")
    ] = False,
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
    from femstruct.files.atomic import refuse_unwritable
    from femstruct.workflow.run.output import write_all

    folder = output or Path("results") / study.name.removesuffix(".yaml").removesuffix(".study")
    refuse_unwritable(folder)
    keep = None if replace else on_stderr
    if watch:
        return watched(study, set_, case, folder, as_json, verbose, not no_pictures, keep)
    _, result = solved(study, set_, case)
    with progress() as tell:
        seconds, told = write_all(result, folder, tell, not no_pictures, keep)
    return shown(result, seconds, str(folder), as_json, verbose, told)


@command
def impact(
    study: StudyFile,
    case: OnlyCase = "",
    set_: Sets = NONE,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Simulate the impacts of a study. Prints peaks, contacts and energies; no files are written."""
    return stages(study, case, set_, as_json, verbose, with_rooms=False)


@command
def sound(
    study: StudyFile,
    case: OnlyCase = "",
    set_: Sets = NONE,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Simulate impacts and the sound in rooms. No files are written."""
    return stages(study, case, set_, as_json, verbose, with_rooms=True)


@command
def identify(
    study: StudyFile,
    measured: Annotated[Path, typer.Option("--measured", metavar="F.csv", help="columns of time and value")],
    channel: Annotated[str, typer.Option("--channel", metavar="NAME", help="recorded channel: 'ball on O_f force'")],
    fit: Annotated[
        list[str], typer.Option("--fit", metavar="PATH=START", help="a parameter to fit and its start value")
    ],
    delay: Annotated[bool, typer.Option("--delay", help="also fit the time shift of the measured history")] = False,
    picture: Annotated[
        Path | None, typer.Option("--picture", metavar="F.png", help="draw both histories and their difference")
    ] = None,
    case: OnlyCase = "",
    set_: Sets = NONE,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Fit parameters to a measured history. Confidence intervals are printed with them."""
    from femstruct.workflow.identify.identify import identify as identified

    if picture is not None:
        from femstruct.view.figures.fitted import refuse_picture

        refuse_picture(picture)
    with progress() as tell:
        found = identified(study, measured, channel, fit, delay, case, tuple(set_), tell)
    if picture is not None:
        from femstruct.view.figures.drawing import save
        from femstruct.view.figures.fitted import fit_figure

        save(fit_figure(found.t, found.measured, found.computed, found.channel, found.unit), picture)
    table = found.table()
    if as_json:
        print_json(table)
    else:
        from femstruct.view.tables.identified_table import show_identification

        show_identification(table, verbose)
    return NOT_TRUSTED if any(finding["severe"] for finding in table["findings"]) else GOOD
