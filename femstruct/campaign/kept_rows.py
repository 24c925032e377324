"""What a campaign leaves behind: rows in a file, a table and a picture."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from femstruct.files.results_file.found_file import write_found, write_front_table
from femstruct.files.results_file.swept_file import SWEEP, TABLE, write_swept, write_table
from femstruct.study.campaign.front import Front
from femstruct.study.campaign.sought import Found
from femstruct.study.campaign.swept import UNROUNDED, Swept
from femstruct.workflow.progress import Progress

PICTURE, PAGE = "sweep.png", "sweep.html"
OPTIMUM = ("optimise.h5", "optimise.csv", "optimise.png", "optimise.html")
FRONT = "optimise.front.csv"


def write_rows(
    rows: Swept,
    folder: Path,
    names: Sequence[str] = (),
    progress: Progress = lambda line: None,
    pictures: bool = True,
) -> list[Path]:
    """Write sweep.h5 with all numbers, sweep.csv, pictures and the page sweep.html with some; returns what was written.

    names : of the numbers in the table and in the picture, the main ones if none.
    """
    folder.mkdir(parents=True, exist_ok=True)
    progress("writing the rows")
    write_swept(folder / SWEEP, rows)
    write_table(folder / TABLE, rows, names)
    written, saved = [folder / SWEEP, folder / TABLE], list[Path]()
    if pictures:
        from femstruct.view.campaigns.bands_figure import bands_figure
        from femstruct.view.campaigns.parallel_figure import swept_parallel
        from femstruct.view.campaigns.swept_figure import swept_figure

        progress("pictures")
        asked = names or rows.main
        figures = (swept_figure(rows, asked), swept_parallel(rows, asked), bands_figure(rows))
        saved = _saved(folder, zip((PICTURE, "sweep.parallel.png", "sweep.bands.png"), figures, strict=True))
    return [*written, *saved, _page(folder / PAGE, rows, saved, names)]


def write_optimum(
    found: Found | Front, folder: Path, progress: Progress = lambda line: None, pictures: bool = True
) -> list[Path]:
    """Write optimise.h5 with the answer and all numbers of all designs, optimise.csv, pictures, the page optimise.html,
    of a front optimise.front.csv too; returns what was written."""
    folder.mkdir(parents=True, exist_ok=True)
    answer, table = (folder / name for name in OPTIMUM[:2])
    progress("writing the rows")
    write_found(answer, found)
    goals = [one.name for one in found.search.goals]
    finer = [name + UNROUNDED for name in goals if name + UNROUNDED in found.rows.names]
    write_table(
        table, found.rows, [name for name in (*goals, *finer, *found.search.limits) if name in found.rows.names]
    )
    written, saved = [answer, table], list[Path]()
    if isinstance(found, Front):
        write_front_table(folder / FRONT, found)
        written.append(folder / FRONT)
    if pictures:
        from femstruct.view.campaigns.front_figure import front_figure
        from femstruct.view.campaigns.optimum_figure import optimum_figure
        from femstruct.view.campaigns.parallel_figure import front_parallel

        progress("pictures")
        figures = (front_figure(found), front_parallel(found)) if isinstance(found, Front) else (optimum_figure(found),)
        saved = _saved(folder, zip((OPTIMUM[2], "optimise.parallel.png"), figures, strict=False))
    return [*written, *saved, _page(folder / OPTIMUM[3], found, saved)]


def _page(path: Path, answer: Swept | Found | Front, pictures: Sequence[Path], names: Sequence[str] = ()) -> Path:
    from femstruct.view.campaigns.campaign_page import write_page

    return write_page(path, answer, {one.name: one.read_bytes() for one in pictures}, names)


def _saved(folder: Path, figures: Iterable[tuple[str, Any]]) -> list[Path]:
    """Write figures by name; those that are None are taken away, where they are of rows that were there before."""
    from femstruct.view.figures.drawing import save

    written = []
    for name, figure in figures:
        if figure is None:
            (folder / name).unlink(missing_ok=True)
        else:
            written.append(save(figure, folder / name))
    return written
