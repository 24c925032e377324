"""The command line: `femstruct run | report | plot | export | check | modes | frf | impact | sound | ..`."""

from __future__ import annotations

import functools
import gc
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from femstruct.exits import GOOD, INTERRUPTED, NOT_TRUSTED, end, heed_signals, leave_with, refuse_unreadable_words
from femstruct.study_commands import print_json, progress, responses, shown, solved, stages, watched

app = typer.Typer(
    help="Impact vibration of structures and the sound it makes in a room.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

StudyFile = Annotated[Path, typer.Argument(metavar="STUDY", help="a study: what happens to a structure (YAML)")]
ModelFile = Annotated[Path, typer.Argument(metavar="MODEL", help="a model: what the structure is (YAML)")]
AsJson = Annotated[bool, typer.Option("--json", help="print JSON to stdout")]
Sets = Annotated[list[str], typer.Option("--set", metavar="PATH=VALUE", help="change one value of the input files")]
Verbose = Annotated[bool, typer.Option("-v", "--verbose", help="also print findings that are remarks")]
Kind = Literal["model", "study"]
OnlyCase = Annotated[str, typer.Option("--case", metavar="CASE", help="run only this case")]


def _tell_version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        print(f"femstruct {version('femstruct')}")
        raise typer.Exit(GOOD)


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_tell_version, is_eager=True, help="print the version and exit")
    ] = False,
) -> None:
    """Impact vibration of structures and the sound it makes in a room."""


def main() -> None:
    """Entry point: exit 0 good, 1 our bug, 2 bad input, 3 a result not to be trusted, 130 interrupted.

    A limit of the study that is exceeded is a result: exit 0.
    """
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "LP_NUM_THREADS"):
        os.environ.setdefault(name, "1")  # two threads are slower on the small blocks of an eigensolution
    gc.set_threshold(200_000)  # what is imported lives to the end: looking through it again and again finds nothing
    heed_signals()
    end(leave_with(app))


def _command(function: Callable[..., int]) -> Callable[..., None]:
    """A command that exits with the code its function returns; an interruption is not a failure."""

    @functools.wraps(function)
    def command(*args: Any, **options: Any) -> None:
        refuse_unreadable_words(options)
        try:
            code = function(*args, **options)
        except KeyboardInterrupt:
            print("Interrupted. No partial files were written; existing files are unchanged.", file=sys.stderr)
            code = INTERRUPTED
        raise typer.Exit(code)

    return app.command()(command)


@_command
def run(
    study: StudyFile,
    case: OnlyCase = "",
    set_: Sets = [],  # noqa: B006 (typer copies the default)
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="default: results/<study>/")
    ] = None,
    no_pictures: Annotated[
        bool, typer.Option("--no-pictures", help="numbers, tables and sound only, in half the time")
    ] = False,
    watch: Annotated[
        bool, typer.Option("--watch", help="run again whenever a file of the study is saved; Ctrl-C ends it")
    ] = False,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Run a study and write its results. Modes, responses, impacts, sound and levels become numbers, pictures, tables
    in a folder."""
    from femstruct.files.atomic import refuse_unwritable
    from femstruct.workflow.run.output import write_all

    folder = output or Path("results") / study.name.removesuffix(".yaml").removesuffix(".study")
    refuse_unwritable(folder)
    if watch:
        return watched(study, set_, case, folder, as_json, verbose, not no_pictures)
    _, result = solved(study, set_, case)
    with progress() as tell:
        seconds, told = write_all(result, folder, tell, pictures=not no_pictures)
    return shown(result, seconds, str(folder), as_json, verbose, told)


ResultsFile = Annotated[
    Path, typer.Argument(metavar="RESULTS", help="results.h5 of a run, or the folder that it is in")
]


@_command
def report(
    results: ResultsFile,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="default: the folder of the results")
    ] = None,
    no_pictures: Annotated[
        bool, typer.Option("--no-pictures", help="numbers, tables and sound alone: half the time")
    ] = False,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Write page, tables, pictures and sounds of a results file again. Nothing is computed anew."""
    from femstruct.files.atomic import refuse_unwritable
    from femstruct.files.results_file.stored import results_file
    from femstruct.workflow.run.output import redraw

    source = results_file(results)
    folder = output or source.parent
    refuse_unwritable(folder)
    with progress() as tell:
        result, told = redraw(source, folder, tell, not no_pictures)
    code = shown(result, {}, str(folder), as_json, verbose, told)
    return NOT_TRUSTED if code == INTERRUPTED else code  # the run was interrupted, not this command


@_command
def plot(
    results: ResultsFile,
    what: Annotated[
        str, typer.Argument(metavar="[WHAT]", help="a picture; without it, those that can be drawn are listed")
    ] = "",
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="default: here")] = Path(),
    as_json: AsJson = False,
    verbose: Annotated[
        bool, typer.Option("-v", "--verbose", help="also list pictures without content, with the reason")
    ] = False,
) -> int:
    """Draw one picture of a results file. Nothing is computed anew."""
    from femstruct.files.atomic import refuse_unwritable
    from femstruct.files.results_file.stored import read_results, results_file
    from femstruct.results_commands import pictures_of, plotted

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


@_command
def reduce(
    model: ModelFile,
    part: Annotated[str, typer.Option("--part", metavar="NAME", help="the part to reduce")],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE", help="NAME.npz")],
    up_to: Annotated[
        str, typer.Option("--up-to", metavar="F", help="modes with the interface held; twice the band, as a rule")
    ] = "",
    count: Annotated[int | None, typer.Option("--count", min=1, help="how many of these modes")] = None,
    set_: Sets = [],  # noqa: B006
    as_json: AsJson = False,
) -> int:
    """Reduce a part of a model for other models. To what others touch of it and to its points; they take the file as a
    part {type: reduced}."""
    from femstruct.workflow.check.asked_modes import extent_of
    from femstruct.workflow.exchange.reduced_model import reduce_model

    command = " ".join(["femstruct", *sys.argv[1:]])
    with progress() as tell:
        found = reduce_model(model, part, extent_of(count, up_to), output, tuple(set_), command, tell)
    if as_json:
        print_json(found)
    else:
        print(*(f"{word}: {value}" for word, value in found.items()), sep="\n")
    return GOOD


@_command
def export(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE", help="csv, xlsx: results.h5 of a run, or its folder; npz, mtx: a model; others: either"
        ),
    ],
    to: Annotated[
        Literal["csv", "xlsx", "npz", "mtx", "uff", "vtu"],
        typer.Option("--to", metavar="KIND", help="csv, xlsx: tables of results; npz, mtx: matrices; uff, vtu: modes"),
    ] = "csv",
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="default: here")] = Path(),
    count: Annotated[int | None, typer.Option("--count", min=1, help="number of modes")] = None,
    up_to: Annotated[
        str, typer.Option("--up-to", metavar="F", help="all modes up to a frequency (default: the first 30)")
    ] = "",
    data_sets: Annotated[
        str, typer.Option("--data-sets", metavar="N,N", help="uff: 15 or 2411 of nodes, 55 or 2414 of modes")
    ] = "",
    set_: Sets = [],  # noqa: B006
    as_json: AsJson = False,
) -> int:
    """Write files for other programs. Tables of results for a spreadsheet; matrices or modes of a model."""
    from femstruct.files.atomic import refuse_unwritable
    from femstruct.workflow.check.asked_modes import extent_of
    from femstruct.workflow.exchange.exported import exported

    refuse_unwritable(output)
    extent = extent_of(count, up_to) if count is not None or up_to else None
    with progress() as tell:
        command = " ".join(["femstruct", *sys.argv[1:]])
        written = exported(file, to, output, extent, tuple(set_), command, tell, data_sets)
    paths = [str(path) for path in written]
    if as_json:
        print_json({"written": paths})
    else:
        print(*paths, sep="\n")
    return GOOD


@_command
def mac(
    model: ModelFile,
    measured: Annotated[Path, typer.Argument(metavar="F.uff", help="a universal file with modes and their nodes")],
    count: Annotated[int | None, typer.Option("--count", min=1, help="number of modes of the model")] = None,
    up_to: Annotated[
        str, typer.Option("--up-to", metavar="F", help="(default: 1.5 times the highest measured frequency)")
    ] = "",
    near: Annotated[
        str, typer.Option("--near", metavar="PERCENT", help="width of a group of near-equal frequencies, one space")
    ] = "1 %",
    length: Annotated[
        str, typer.Option("--length", metavar="UNIT", help="unit of length of a file that does not say it")
    ] = "m",
    set_: Sets = [],  # noqa: B006
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


@_command
def warm_up() -> int:
    """Compile the simulation kernels now. This takes about 15 seconds, once; otherwise the first simulation does it."""
    from femstruct.impact.compiled.store import folder
    from femstruct.impact.compiled.workers import compilation
    from femstruct.impact.engine.needed_units import ALL

    with progress() as tell, compilation(ALL) as kernels:
        kernels.wait(tell)
    print(f"{len(kernels.units)} kernels compiled; they are kept in {folder()}")
    return GOOD


@_command
def impact(
    study: StudyFile,
    case: OnlyCase = "",
    set_: Sets = [],  # noqa: B006
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Simulate the impacts of a study. Prints peaks, contacts and energies; no files are written."""
    return stages(study, case, set_, as_json, verbose, with_rooms=False)


@_command
def sound(
    study: StudyFile,
    case: OnlyCase = "",
    set_: Sets = [],  # noqa: B006
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Simulate impacts and the sound in rooms. No files are written."""
    return stages(study, case, set_, as_json, verbose, with_rooms=True)


@_command
def check(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="a model or a study (YAML)")],
    picture: Annotated[
        Path | None, typer.Option("--picture", metavar="F.png", help="draw the model with its names")
    ] = None,
    set_: Sets = [],  # noqa: B006
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Check a file and describe it. Geometry, masses, sags, degrees of freedom, rigid-body modes, findings."""
    from femstruct.workflow.check.inspect import inspect_file

    with progress() as tell:
        inspection = inspect_file(file, tuple(set_), tell)
    if picture is not None:
        from femstruct.view.scenes.scene import picture_model

        picture_model(inspection.model, inspection.rooms, picture)
    if as_json:
        print_json(inspection.table())
    else:
        from femstruct.view.tables.structure_tables import show_inspection

        show_inspection(inspection.table(), str(picture or ""), verbose)
    return NOT_TRUSTED if any(finding.severe for finding in inspection.findings) else GOOD


@_command
def modes(
    model: ModelFile,
    count: Annotated[int | None, typer.Option("--count", min=1, help="number of modes")] = None,
    up_to: Annotated[
        str, typer.Option("--up-to", metavar="F", help="all modes up to a frequency (default: the first 30)")
    ] = "",
    complex_: Annotated[
        bool, typer.Option("--complex", help="complex modes, with --up-to: where damping makes places move out of step")
    ] = False,
    set_: Sets = [],  # noqa: B006
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


@_command
def statics(
    model: ModelFile,
    force: Annotated[
        list[str], typer.Option("--force", metavar="P.z=F", help="a constant force at a point, such as 'P.z=-10 kN'")
    ] = [],  # noqa: B006
    weight: Annotated[bool, typer.Option("--weight", help="the structure's own weight acts, too")] = False,
    set_: Sets = [],  # noqa: B006
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


@_command
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
    step: Annotated[str, typer.Option("--step", metavar="F", help="frequency step (default: 500 lines)")] = "",
    kind: Annotated[str, typer.Option("--kind", help="receptance, mobility, accelerance or transmissibility")] = "",
    method: Annotated[str, typer.Option("--method", help="modal, or direct as a check")] = "modal",
    to: Annotated[
        Literal["csv", "npz", "uff"] | None, typer.Option("--to", metavar="csv|npz|uff", help="write a file")
    ] = None,
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="default: here")] = Path(),
    set_: Sets = [],  # noqa: B006
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> int:
    """Print frequency responses of a model, or write them to a file. Several drives and responses: each to each."""
    if to is not None or len(drive) * len(response) > 1:
        return responses(model, drive, response, (band, step, kind, method), to, output, tuple(set_), as_json, verbose)
    from femstruct.workflow.check.asked_response import frf_of

    with progress() as tell:
        tell("modes and frequency response")
        table = frf_of(model, drive[0], response[0], band, step, kind, method, tuple(set_))
    if as_json:
        print_json(table)
    else:
        from femstruct.view.tables.structure_tables import show_frf

        show_frf(table, verbose)
    return NOT_TRUSTED if any(finding["severe"] for finding in table["findings"]) else GOOD


@_command
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
    set_: Sets = [],  # noqa: B006
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


@_command
def explain(
    code: Annotated[
        str, typer.Argument(metavar="[CODE]", help="code of a finding; without it, all codes are listed")
    ] = "",
    as_json: AsJson = False,
) -> int:
    """Explain a finding. What its code means, its thresholds, and what to do."""
    from femstruct.findings.catalogue import CATALOGUE, entry_of
    from femstruct.findings.explain import entry_table, explanation, listing

    if as_json:
        print_json(entry_table(entry_of(code)) if code else [entry_table(entry) for entry in CATALOGUE.values()])
    else:
        print(explanation(entry_of(code)) if code else listing())
    return GOOD


@_command
def schema(
    kind: Annotated[Kind, typer.Argument(metavar="model|study", help="kind of file")] = "model",
) -> int:
    """Print the JSON schema of a file. For editors, of a model or a study file."""
    from femstruct.language import json_schema

    print_json(json_schema(kind))
    return GOOD
