"""Commands on a study: run it, or parts of it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from femstruct.commands.shared import NONE, AsJson, OnlyCase, Sets, StudyFile, Verbose, WithoutPictures, command
from femstruct.commands.study_answers import on_stderr, progress, shown, solved, stages, watched


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
