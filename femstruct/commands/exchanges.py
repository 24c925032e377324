"""Commands that bring models and results to other programs and from them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from femstruct.commands.shared import (
    NONE,
    AsJson,
    FirstModes,
    ModelFile,
    Modes,
    Near,
    OutputHere,
    Sets,
    as_typed,
    command,
)
from femstruct.commands.study_answers import print_json, progress
from femstruct.exits import GOOD


@command
def export(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="csv, xlsx: folder of a run, a sweep or an optimisation; npz, mtx: a model; others: run or model",
        ),
    ],
    to: Annotated[
        Literal["csv", "xlsx", "npz", "mtx", "uff", "vtu"],
        typer.Option("--to", metavar="KIND", help="csv, xlsx: tables of results; npz, mtx: matrices; uff, vtu: modes"),
    ] = "csv",
    output: OutputHere = Path(),
    count: Modes = None,
    up_to: FirstModes = "",
    data_sets: Annotated[
        str, typer.Option("--data-sets", metavar="N,N", help="uff: 15 or 2411 of nodes, 55 or 2414 of modes")
    ] = "",
    set_: Sets = NONE,
    as_json: AsJson = False,
) -> int:
    """Write files for other programs. Tables of results for a spreadsheet; matrices or modes of a model."""
    from femstruct.files.atomic import refuse_unwritable
    from femstruct.workflow.check.asked_modes import extent_of
    from femstruct.workflow.exchange.exported import exported

    refuse_unwritable(output)
    extent = extent_of(count, up_to) if count is not None or up_to else None
    with progress() as tell:
        written = exported(file, to, output, extent, tuple(set_), as_typed(), tell, data_sets)
    paths = [str(path) for path in written]
    if as_json:
        print_json({"written": paths})
    else:
        print(*paths, sep="\n")
    return GOOD


@command
def reduce(
    model: ModelFile,
    part: Annotated[str, typer.Option("--part", metavar="NAME", help="the part to reduce")],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE", help="NAME.npz")],
    up_to: Annotated[
        str, typer.Option("--up-to", metavar="F", help="modes with the interface held; twice the band, as a rule")
    ] = "",
    count: Annotated[int | None, typer.Option("--count", min=1, help="how many of these modes")] = None,
    set_: Sets = NONE,
    as_json: AsJson = False,
) -> int:
    """Reduce a part of a model for other models. To what others touch of it and to its points; they take the file as a
    part {type: reduced}."""
    from femstruct.workflow.check.asked_modes import extent_of
    from femstruct.workflow.exchange.reduced_model import reduce_model, told_of

    with progress() as tell:
        found = reduce_model(model, part, extent_of(count, up_to), output, tuple(set_), as_typed(), tell)
    if as_json:
        print_json(found)
    else:
        print(*told_of(found), sep="\n")
    return GOOD


@command
def mac(
    model: ModelFile,
    measured: Annotated[Path, typer.Argument(metavar="F.uff", help="a universal file with modes and their nodes")],
    count: Annotated[int | None, typer.Option("--count", min=1, help="number of modes of the model")] = None,
    up_to: Annotated[
        str, typer.Option("--up-to", metavar="F", help="(default: 1.5 times the highest measured frequency)")
    ] = "",
    near: Near = "1 %",
    length: Annotated[
        str, typer.Option("--length", metavar="UNIT", help="unit of length of a file that does not say it")
    ] = "m",
    set_: Sets = NONE,
    as_json: AsJson = False,
) -> int:
    """Compare a model with measured modes. Frequencies, damping, and the modal assurance criterion (MAC)."""
    from femstruct.workflow.check.asked_modes import extent_of
    from femstruct.workflow.exchange.measured_beside import measured_beside

    extent = extent_of(count, up_to) if count is not None or up_to else None
    with progress() as tell:
        table = measured_beside(model, measured, extent, near, length, tuple(set_), tell)
    if as_json:
        print_json(table)
    else:
        from femstruct.view.tables.structure_tables import show_mac

        show_mac(table)
    return GOOD
