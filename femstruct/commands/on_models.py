"""Commands on a model: check it, its modes, statics and frequency responses."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from femstruct.commands.shared import NONE, AsJson, FirstModes, ModelFile, Modes, OutputHere, Sets, Verbose, command
from femstruct.commands.study_answers import print_json, progress, responses
from femstruct.exits import GOOD, NOT_TRUSTED


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
    from femstruct.campaign.tried import campaigns_of
    from femstruct.workflow.check.inspect import inspect_file

    with progress() as tell:
        inspection = inspect_file(file, tuple(set_), tell)
        campaigns = campaigns_of(file, set_)
    if picture is not None:
        from femstruct.view.scenes.scene import picture_model

        picture_model(inspection.model, inspection.rooms, picture)
    if as_json:
        print_json({**inspection.table(), **({"campaigns": campaigns} if campaigns else {})})
    else:
        from femstruct.view.tables.structure_tables import show_inspection

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
    from femstruct.workflow.check.asked_modes import complex_modes_of, extent_of, modes_of

    if complex_:
        from femstruct.view.tables.structure_tables import show_complex_modes

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
        from femstruct.view.tables.structure_tables import show_modes

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
    from femstruct.workflow.check.at_rest import at_rest

    with progress() as tell:
        tell("statics")
        table = at_rest(model, force, weight, tuple(set_))
    if as_json:
        print_json(table)
    else:
        from femstruct.view.tables.rest_table import show_rest

        show_rest(table, verbose)
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
        return responses(model, drive, response, (band, step, kind, method), to, output, tuple(set_), as_json, verbose)
    from femstruct.workflow.check.asked_response import frf_of

    with progress() as tell:
        table = frf_of(model, drive[0], response[0], band, step, kind, method, tuple(set_), tell)
    if as_json:
        print_json(table)
    else:
        from femstruct.view.tables.structure_tables import show_frf

        show_frf(table, verbose)
    return NOT_TRUSTED if any(finding["severe"] for finding in table["findings"]) else GOOD
