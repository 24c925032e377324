"""Commands on many runs of a study: sweep what varies."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from femstruct.commands.shared import NONE, AsJson, OnlyCase, Sets, StudyFile, command
from femstruct.commands.study_answers import print_json, progress
from femstruct.exits import GOOD, INTERRUPTED, NOT_TRUSTED


@command
def sweep(
    study: StudyFile,
    vary: Annotated[
        list[str],
        typer.Option("--vary", metavar="PATH=FROM:TO:STEPS", help="or PATH=FROM:TO:STEPS:log, PATH=VALUE,VALUE"),
    ] = NONE,
    samples: Annotated[int, typer.Option("--samples", metavar="N", help="of a Latin hypercube, instead of a grid")] = 0,
    results: Annotated[
        list[str], typer.Option("--result", metavar="NAME", help="numbers to print and draw; without it the main ones")
    ] = NONE,
    case: OnlyCase = "",
    set_: Sets = NONE,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="default: results/<study>.sweep/")
    ] = None,
    workers: Annotated[int, typer.Option("--workers", metavar="N", min=0, help="processes; default: one a core")] = 0,
    cluster: Annotated[str, typer.Option("--cluster", metavar="ADDRESS", help="of a Dask scheduler")] = "",
    plan: Annotated[bool, typer.Option("--plan", help="only print what would be computed")] = False,
    no_pictures: Annotated[bool, typer.Option("--no-pictures", help="numbers and tables only")] = False,
    as_json: AsJson = False,
) -> int:
    """Run a study for many values of its numbers. They stand in the study under 'vary:', or are given by --vary. Rows
    are kept as they come; the same command goes on where it was interrupted."""
    from femstruct.campaign.kept_rows import planned, write_rows
    from femstruct.campaign.sweep import set_aside
    from femstruct.campaign.sweep import sweep as swept
    from femstruct.files.atomic import refuse_unwritable
    from femstruct.language.campaigns import read_campaign
    from femstruct.view.campaigns.swept_table import show_swept

    asked = read_campaign(study, vary, set_, case, samples or None)
    if plan:
        with progress() as tell:
            told = planned(asked, tell)
        print_json(told) if as_json else print("\n".join(f"{words}: {count}" for words, count in told.items()))
        return GOOD
    folder = output or Path("results") / f"{study.name.removesuffix('.yaml').removesuffix('.study')}.sweep"
    refuse_unwritable(folder)
    with progress() as tell:
        moved = set_aside(asked, folder)
        rows = swept(asked, folder, workers or None, cluster, tell, " ".join(["femstruct", *sys.argv[1:]]))
        names = [name for name in results if rows.of(name) is not None]
        written = write_rows(rows, folder, names, tell, pictures=not no_pictures)
    if as_json:
        from femstruct.files.tables.sweep_tables import sweep_table

        print_json(sweep_table(rows, names))
    else:
        show_swept(rows, names)
        if moved is not None:
            print(f"The rows of an earlier, different sweep are now in {moved}")
        print(f"written: {', '.join(map(str, written))}")
    if not rows.done.all():
        return INTERRUPTED
    return GOOD if any(rows.trusted(one).any() for one in rows.cases) else NOT_TRUSTED
