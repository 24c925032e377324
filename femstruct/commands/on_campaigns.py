"""Commands on many runs of a study: sweep what varies, optimise what may be chosen."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from femstruct.commands.shared import (
    NONE,
    AsJson,
    Cluster,
    NumbersOnly,
    OnlyCase,
    Sets,
    StudyFile,
    Workers,
    as_typed,
    command,
    print_json,
    progress,
)
from femstruct.errors import FemstructError
from femstruct.exits import GOOD, INTERRUPTED, NOT_TRUSTED

if TYPE_CHECKING:  # slow to import
    from femstruct.study.campaigns import Swept
    from femstruct.study.optima import Found, Front


@command
def sweep(
    study: StudyFile,
    vary: Annotated[
        list[str],
        typer.Option(
            "--vary",
            metavar="PATH=FROM:TO:STEPS",
            help="or FROM:TO:STEPS:log, VALUE,VALUE, normal(MEAN, SD)",
        ),
    ] = NONE,
    samples: Annotated[
        int, typer.Option("--samples", metavar="N", help="of a Latin hypercube, instead of a grid", show_default=False)
    ] = 0,
    results: Annotated[
        list[str], typer.Option("--result", metavar="NAME", help="numbers to print and draw; without it the main ones")
    ] = NONE,
    only: Annotated[
        list[str],
        typer.Option("--only", metavar="NAME", help="numbers to keep; those of impacts take seconds for thousands"),
    ] = NONE,
    case: OnlyCase = "",
    set_: Sets = NONE,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="default: results/<study>.sweep/")
    ] = None,
    workers: Workers = 0,
    cluster: Cluster = "",
    plan: Annotated[
        bool, typer.Option("--plan", help="only print what would be computed, and how long it takes")
    ] = False,
    no_pictures: NumbersOnly = False,
    as_json: AsJson = False,
) -> int:
    """Run a study for many values of its numbers. They stand in the study under 'vary:', or are given by --vary. Rows
    are kept as they come; the same command goes on where it was interrupted."""
    from femstruct.campaign.forecast import forecast_campaign
    from femstruct.campaign.rows import write_rows
    from femstruct.campaign.sweep import ROWS, set_aside
    from femstruct.campaign.sweep import sweep as swept
    from femstruct.files.writing import refuse_unwritable
    from femstruct.language.campaigns import read_campaign
    from femstruct.view.campaign_answers import swept_pieces
    from femstruct.view.console import console, show

    campaign = read_campaign(study, vary, set_, case, samples or None, only)
    if plan:
        with progress() as tell:
            forecast = forecast_campaign(campaign, workers or None, tell)
        return _show_plan(forecast, as_json)
    folder = output or _folder(study, "sweep")
    refuse_unwritable(folder)
    with _interruptible(folder / ROWS), progress() as tell:
        moved = set_aside(campaign, folder)
        rows = swept(campaign, folder, workers or None, cluster, tell, as_typed(), results)
        names = rows.finer(results)
        written = write_rows(rows, folder, names, tell, pictures=not no_pictures)
    if as_json:
        from femstruct.files.campaign_tables import sweep_table

        print_json(sweep_table(rows, names))
    else:
        show(swept_pieces(rows, names), console())
        _print_files("sweep", moved, written)
    if not rows.done.all():
        return INTERRUPTED
    return GOOD if any(rows.trusted(one).any() for one in rows.cases) else NOT_TRUSTED


@command
def optimise(
    study: StudyFile,
    minimise: Annotated[
        list[str], typer.Option("--minimise", metavar="NAME", help="the number that is to be small; several: a front")
    ] = NONE,
    maximise: Annotated[
        list[str], typer.Option("--maximise", metavar="NAME", help="the number that is to be large; several: a front")
    ] = NONE,
    limit: Annotated[
        list[str], typer.Option("--limit", metavar="NAME=VALUE", help="what a number should not exceed")
    ] = NONE,
    vary: Annotated[
        list[str],
        typer.Option("--vary", metavar="PATH=FROM:TO", help="what may be chosen; or FROM:TO:log, or VALUE,VALUE"),
    ] = NONE,
    runs: Annotated[int, typer.Option("--runs", metavar="N", help="of the study at most", show_default="400")] = 0,
    case: OnlyCase = "",
    set_: Sets = NONE,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="default: results/<study>.optimise/")
    ] = None,
    workers: Workers = 0,
    cluster: Cluster = "",
    plan: Annotated[bool, typer.Option("--plan", help="only print what would be tried, and how long it takes")] = False,
    no_pictures: NumbersOnly = False,
    as_json: AsJson = False,
) -> int:
    """Find the best design of a study. For two or three goals, those of which none is better in all. Goals, limits, and
    what may be chosen stand in the study under 'optimise:', or are given here. Rows are kept as they come; the same
    command goes on."""
    from femstruct.campaign.forecast import forecast_search
    from femstruct.campaign.front_search import pareto_front
    from femstruct.campaign.optimise import ROWS, set_aside
    from femstruct.campaign.optimise import optimise as optimised
    from femstruct.campaign.rows import write_optimum
    from femstruct.files.campaign_tables import front_table, optimum_table
    from femstruct.files.writing import refuse_unwritable
    from femstruct.language.campaigns import read_search
    from femstruct.study.optima import Front
    from femstruct.view.campaign_page import answer_pieces
    from femstruct.view.console import console, show

    goals = [f"minimise {one}" for one in minimise] + [f"maximise {one}" for one in maximise]
    search = read_search(study, goals, vary, limit, set_, case, runs or None)
    if plan:
        with progress() as tell:
            forecast = forecast_search(search, workers or None, tell)
        return _show_plan(forecast, as_json)
    folder = output or _folder(study, "optimise")
    refuse_unwritable(folder)
    with _interruptible(folder / ROWS), progress() as tell:
        moved = set_aside(search, folder)
        if search.also:
            found: Found | Front = pareto_front(search, folder, workers or None, cluster, tell, as_typed())
        else:
            seen = _sweep_beside(folder, _folder(study, "sweep"))
            found = optimised(search, folder, workers or None, cluster, tell, as_typed(), seen)
        written = write_optimum(found, folder, tell, pictures=not no_pictures)
    if as_json:
        print_json(front_table(found) if isinstance(found, Front) else optimum_table(found))
    else:
        show(answer_pieces(found), console())
        _print_files("optimisation", moved, written)
    if found.interrupted:
        return INTERRUPTED
    return GOOD if found.feasible else NOT_TRUSTED


def _show_plan(forecast: Mapping[str, int | str], as_json: bool) -> int:
    """What would be computed."""
    print_json(dict(forecast)) if as_json else print(
        "\n".join(f"{words}: {count}" for words, count in forecast.items())
    )
    return GOOD


def _print_files(what: str, moved: Path | None, written: Iterable[Path]) -> None:
    """Which files are written, and where those of an earlier campaign in the same folder are now."""
    if moved is not None:
        print(f"An earlier, different {what} is kept: its files are now {moved.with_suffix('.*')}")
    print(f"Written: {', '.join(map(str, written))}")


def _sweep_beside(*folders: Path) -> Swept | None:
    """The first sweep in some folders; one that cannot be read is named and left."""
    from femstruct.files.campaign_files import SWEEP, read_swept

    for folder in folders:
        if (folder / SWEEP).exists():
            try:
                return read_swept(folder)
            except FemstructError as error:
                print(f"The search begins without the designs of a sweep. {error}", file=sys.stderr)
    return None


@contextmanager
def _interruptible(rows: Path) -> Iterator[None]:
    """Ctrl-C before there is an answer: what is finished is kept."""
    try:
        yield
    except KeyboardInterrupt:
        if not rows.exists():
            raise
        print(f"Interrupted. Finished runs are kept in {rows}; the same command goes on", file=sys.stderr)
        raise typer.Exit(INTERRUPTED) from None


def _folder(study: Path, what: str) -> Path:
    return Path("results") / f"{study.name.removesuffix('.yaml').removesuffix('.study')}.{what}"
