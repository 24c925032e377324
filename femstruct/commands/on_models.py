"""Commands on a model: check it, its modes, statics and frequency responses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from femstruct.commands.shared import (
    NONE,
    AsJson,
    FirstModes,
    ModelFile,
    Modes,
    Near,
    OnlyCase,
    OutputHere,
    Sets,
    Verbose,
    as_typed,
    command,
    print_json,
    progress,
    responses,
)
from femstruct.exits import GOOD, NOT_TRUSTED

if TYPE_CHECKING:
    from femstruct.study.asked import Beside


@command
def check(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="a model or a study (YAML)")],
    picture: Annotated[
        Path | None, typer.Option("--picture", metavar="F.png", help="draw the model with its names")
    ] = None,
    set_: Sets = NONE,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Check a file and describe it. Geometry, masses, sags, degrees of freedom, rigid-body modes, findings."""
    from femstruct.campaign.designs import campaigns_of
    from femstruct.workflow.check import inspect_file

    with progress() as tell:
        inspection = inspect_file(file, tuple(set_), tell)
        campaigns = campaigns_of(file, set_)
    if picture is not None:
        from femstruct.view.model_scene import picture_model

        picture_model(inspection.model, inspection.rooms, picture)
    if as_json:
        print_json({**inspection.table(), **({"campaigns": campaigns} if campaigns else {})})
    else:
        from femstruct.view.structure_tables import show_inspection

        show_inspection({**inspection.table(), "campaigns": campaigns}, str(picture or ""), verbose)
    return NOT_TRUSTED if any(finding.severe for finding in inspection.findings) else GOOD


@command
def modes(
    model: ModelFile,
    count: Modes = None,
    up_to: FirstModes = "",
    complex_: Annotated[
        bool, typer.Option("--complex", help="complex modes, with --up-to: where damping makes places move out of step")
    ] = False,
    set_: Sets = NONE,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Print natural frequencies and damping. No mode of the mesh is missing, which is proved of real modes."""
    from femstruct.workflow.modes import complex_modes_of, extent_of, modes_of

    if complex_:
        from femstruct.view.structure_tables import show_complex_modes

        with progress() as tell:
            tell("complex modes")
            found = complex_modes_of(model, extent_of(count, up_to), tuple(set_))
        print_json(found) if as_json else show_complex_modes(found)
        return GOOD
    with progress() as tell:
        tell("modes")
        table = modes_of(model, extent_of(count, up_to), tuple(set_))
    if as_json:
        print_json(table)
    else:
        from femstruct.view.structure_tables import show_modes

        show_modes(table, verbose)
    return NOT_TRUSTED if any(finding["severe"] for finding in table["findings"]) else GOOD


@command
def statics(
    model: ModelFile,
    force: Annotated[
        list[str], typer.Option("--force", metavar="P.z=F", help="a constant force at a point, such as 'P.z=-10 kN'")
    ] = NONE,
    weight: Annotated[bool, typer.Option("--weight", help="the structure's own weight acts, too")] = False,
    set_: Sets = NONE,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Print a model at rest under forces and weight. Displacements, forces of the supports, largest stresses."""
    from femstruct.workflow.model_answers import statics_table

    with progress() as tell:
        tell("statics")
        table = statics_table(model, force, weight, tuple(set_))
    if as_json:
        print_json(table)
    else:
        from femstruct.view.structure_tables import show_statics

        show_statics(table, verbose)
    return NOT_TRUSTED if any(finding["severe"] for finding in table["findings"]) else GOOD


@command
def frf(
    model: ModelFile,
    drive: Annotated[list[str], typer.Option("--drive", metavar="P.z", help="where the force acts; again for more")],
    response: Annotated[
        list[str],
        typer.Option(
            "--response", metavar="Q.z", help="place and direction, NAME.force, or PART.stress; again for more"
        ),
    ],
    band: Annotated[str, typer.Option("--band", metavar="A:B", help="frequencies, such as '1 Hz:500 Hz'")],
    step: Annotated[str, typer.Option("--step", metavar="F", help="default: 500 lines, more for narrow peaks")] = "",
    kind: Annotated[str, typer.Option("--kind", help="receptance, mobility, accelerance or transmissibility")] = "",
    method: Annotated[str, typer.Option("--method", help="modal, or direct as a check")] = "modal",
    to: Annotated[
        Literal["csv", "npz", "uff"] | None, typer.Option("--to", metavar="csv|npz|uff", help="write a file")
    ] = None,
    output: OutputHere = Path(),
    set_: Sets = NONE,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Print frequency responses of a model, or write them to a file. Several drives and responses: each to each."""
    if to is not None or len(drive) * len(response) > 1:
        asked = band, step, kind, method
        return responses(model, drive, response, asked, to, output, sets=tuple(set_), as_json=as_json, verbose=verbose)
    from femstruct.workflow.model_answers import frf_of

    with progress() as tell:
        table = frf_of(
            model, drive[0], response[0], band, step, kind=kind, method=method, overrides=tuple(set_), progress=tell
        )
    if as_json:
        print_json(table)
    else:
        from femstruct.view.structure_tables import show_frf

        show_frf(table, verbose)
    return NOT_TRUSTED if any(finding["severe"] for finding in table["findings"]) else GOOD


# ----------------------------------------------------------------------------------------------------------------------
# Commands that bring models and results to other programs and from them.
# ----------------------------------------------------------------------------------------------------------------------


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
    from femstruct.files.writing import refuse_unwritable
    from femstruct.workflow.exchange import export_source
    from femstruct.workflow.modes import extent_of

    refuse_unwritable(output)
    extent = extent_of(count, up_to) if count is not None or up_to else None
    with progress() as tell:
        written = export_source(
            file,
            to,
            folder=output,
            extent=extent,
            overrides=tuple(set_),
            command=as_typed(),
            tell=tell,
            data_sets=data_sets,
        )
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
    from femstruct.workflow.exchange import export_lines, reduce_model
    from femstruct.workflow.modes import extent_of

    with progress() as tell:
        found = reduce_model(model, part, extent_of(count, up_to), output, tuple(set_), as_typed(), tell)
    if as_json:
        print_json(found)
    else:
        print(*export_lines(found), sep="\n")
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
    from femstruct.workflow.exchange import compare_measured_modes
    from femstruct.workflow.modes import extent_of

    extent = extent_of(count, up_to) if count is not None or up_to else None
    with progress() as tell:
        table = compare_measured_modes(model, measured, extent, near, length, tuple(set_), tell)
    if as_json:
        print_json(table)
    else:
        from femstruct.view.structure_tables import show_mac

        show_mac(table)
    return GOOD


# ----------------------------------------------------------------------------------------------------------------------
# The command that fits a model or a study to what was measured.
# ----------------------------------------------------------------------------------------------------------------------


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
    from femstruct.workflow.identify import identify as identified
    from femstruct.workflow.measured_data import MeasuredFiles

    if picture is not None:
        from femstruct.view.fit_figures import refuse_picture

        refuse_picture(picture)
    if table is not None:
        from femstruct.files.writing import refuse_unwritable_file

        refuse_unwritable_file(table)
    files = MeasuredFiles(
        measured, channel, tuple(modes), tuple(frf), tuple(levels), shapes=shapes, band=band, near=near, length=length
    )
    with progress() as tell:
        found = identified(
            file, files, channel="", parameters=fit, delay=delay, case=case, overrides=tuple(set_), progress=tell
        )
    answer = found.table()
    _write(answer, found.beside, picture, table)
    if as_json:
        print_json(answer)
    else:
        from femstruct.view.structure_tables import show_identification

        show_identification(answer, found.beside, verbose)
    return NOT_TRUSTED if any(finding["severe"] for finding in answer["findings"]) else GOOD


def _write(found: Mapping[str, Any], beside: Sequence[Beside], picture: Path | None, table: Path | None) -> None:
    """Files of measured beside computed."""
    if picture is not None:
        from femstruct.view.drawing import save
        from femstruct.view.fit_figures import fit_figure
        from femstruct.view.structure_tables import found_lines

        save(fit_figure(beside, found["title"], found_lines(found)), picture)
    if table is not None:
        from femstruct.files.sheets import write_comparison

        write_comparison(beside, table)
