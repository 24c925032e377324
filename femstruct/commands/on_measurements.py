"""The command that fits a model or a study to what was measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from femstruct.commands.shared import NONE, AsJson, Near, OnlyCase, Sets, Verbose, command
from femstruct.commands.study_answers import print_json, progress
from femstruct.exits import GOOD, NOT_TRUSTED

if TYPE_CHECKING:
    from femstruct.study.matched import Beside


@command
def identify(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="a study, or a model where modes and frequency responses are enough")
    ],
    fit: Annotated[
        list[str],
        typer.Option("--fit", metavar="PATH=START[:LOW:HIGH]", help="a parameter, its start value, and its bounds"),
    ],
    modes: Annotated[
        list[str],
        typer.Option(
            "--modes", metavar="'F +- 1 %'", help="natural frequencies: a table, or a universal file with shapes"
        ),
    ] = NONE,
    shapes: Annotated[
        str, typer.Option("--shapes", metavar="SCATTER", help="fit the shapes of it, too; else they only pair modes")
    ] = "",
    frf: Annotated[
        list[str],
        typer.Option("--frf", metavar="'F +- 5 %'", help="frequency responses: of 'frf --to csv', or a universal file"),
    ] = NONE,
    band: Annotated[
        str, typer.Option("--band", metavar="A:B", help="frequencies of the responses (default: all)")
    ] = "",
    levels: Annotated[
        list[str],
        typer.Option("--levels", metavar="'F +- 1 dB'", help="levels by band, as 'export --to csv' writes them"),
    ] = NONE,
    measured: Annotated[
        str, typer.Option("--measured", metavar="'F +- 1 N'", help="a history: columns of time and value")
    ] = "",
    channel: Annotated[
        str, typer.Option("--channel", metavar="NAME", help="recorded channel of it: 'ball on O_f force'")
    ] = "",
    delay: Annotated[bool, typer.Option("--delay", help="also fit the time shift of the measured history")] = False,
    near: Near = "1 %",
    length: Annotated[
        str, typer.Option("--length", metavar="UNIT", help="unit of length of universal files that do not state it")
    ] = "m",
    picture: Annotated[
        Path | None, typer.Option("--picture", metavar="F.png", help="draw measured beside computed")
    ] = None,
    table: Annotated[
        Path | None, typer.Option("--csv", metavar="F.csv", help="write measured beside computed as a table")
    ] = None,
    case: OnlyCase = "",
    set_: Sets = NONE,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Fit parameters to what was measured. Modes, frequency responses, levels and a history, alone or together;
    confidence intervals are printed with the values, and what the data cannot distinguish."""
    from femstruct.workflow.identify.identify import identify as identified
    from femstruct.workflow.identify.measured_data import MeasuredFiles

    if picture is not None:
        from femstruct.view.figures.fitted import refuse_picture

        refuse_picture(picture)
    if table is not None:
        from femstruct.files.atomic import refuse_unwritable_file

        refuse_unwritable_file(table)
    files = MeasuredFiles(measured, channel, tuple(modes), tuple(frf), tuple(levels), shapes, band, near, length)
    with progress() as tell:
        found = identified(file, files, "", fit, delay, case, tuple(set_), tell)
    told = found.table()
    _write(told, found.beside, picture, table)
    if as_json:
        print_json(told)
    else:
        from femstruct.view.tables.identified_table import show_identification

        show_identification(told, found.beside, verbose)
    return NOT_TRUSTED if any(finding["severe"] for finding in told["findings"]) else GOOD


def _write(found: Mapping[str, Any], beside: Sequence[Beside], picture: Path | None, table: Path | None) -> None:
    """Files of measured beside computed."""
    if picture is not None:
        from femstruct.view.figures.drawing import save
        from femstruct.view.figures.fitted import fit_figure
        from femstruct.view.tables.identified_table import found_lines

        save(fit_figure(beside, found["title"], found_lines(found)), picture)
    if table is not None:
        from femstruct.files.tables.beside_table import write_beside

        write_beside(beside, table)
