"""A campaign as one page, for a browser and for paper: what was asked, what was found, pictures, the input files."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from html import escape
from pathlib import Path

import numpy as np

from femstruct.files.writing import replacing
from femstruct.study.campaigns import Listed, Scattered, Swept
from femstruct.study.optima import Found, Front
from femstruct.view.campaign_answers import front_pieces, in_unit, optimum_pieces, range_of, swept_pieces, value_text
from femstruct.view.console import Grid, Piece, digits
from femstruct.view.page import STYLE, fold, picture, table


def write_page(
    path: Path, answer: Swept | Found | Front, pictures: Mapping[str, bytes], names: Iterable[str] = ()
) -> Path:
    """Write the page to a path, in one step, with the files of pictures (png) by name.

    Parameters
    ----------
    names : Iterable[str]
        Of the numbers of a sweep, the main ones if none.
    """
    with replacing(path) as temporary:
        temporary.write_text(campaign_page(answer, pictures, names), encoding="utf-8")
    return path


def campaign_page(answer: Swept | Found | Front, pictures: Mapping[str, bytes], names: Iterable[str] = ()) -> str:
    """The page as HTML; it asks nothing of a network or of its folder."""
    rows = answer if isinstance(answer, Swept) else answer.rows
    pieces = swept_pieces(rows, tuple(names)) if isinstance(answer, Swept) else answer_pieces(answer)
    screen = '<meta name="viewport" content="width=device-width, initial-scale=1">'
    title = escape(rows.title)
    parts = [
        f"<h1>{title}</h1>",
        "<h2>What was asked</h2>",
        *map(table, _input_tables(answer)),
        "<h2>What was found</h2>",
        *(table(one) if isinstance(one, Grid) else f"<p>{escape(one)}</p>" for one in pieces),
        *(picture(name, file) for name, file in pictures.items()),
        *(fold(name, [f"<pre>{escape(text)}</pre>"]) for name, text in rows.sources.items()),
    ]
    versions = ", ".join(f"{name} {value}" for name, value in rows.provenance.items() if value)
    body = "\n".join(part for part in parts if part)
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8">{screen}<title>{title}</title>'
        f"<style>{STYLE}</style></head>\n<body>\n{body}\n<footer>{escape(versions)}</footer>\n</body></html>\n"
    )


def answer_pieces(found: Found | Front) -> Iterator[Piece]:
    """The answer of an optimisation, for one goal or for several."""
    return front_pieces(found) if isinstance(found, Front) else optimum_pieces(found)


def _input_tables(answer: Swept | Found | Front) -> Iterator[Grid]:
    """What varied and in which range; goals and limits of an optimisation."""
    if isinstance(answer, Swept):
        yield _varied(answer)
        return
    search, rows = answer.search, answer.rows
    goals = Grid("goals and limits", ("number", "", "limit"))
    for one in search.goals:
        goals.add(one.name, "small" if one.sign > 0 else "large", "")
    for name, limit in search.limits.items():
        factor, unit = in_unit(rows.unit_of(name) if name in rows.names else "", abs(limit))
        goals.add(
            name,
            "within, as the study states" if name in search.of_study else "within",
            f"{digits(factor * limit)} {unit}".strip(),
        )
    yield goals
    yield _ranges("what may be chosen", search.designs)
    yield _ranges(f"what scatters, {search.scatter} samples of it", search.over)


def _ranges(title: str, varied: Iterable[Listed | Scattered]) -> Grid:
    grid = Grid(title, ("path", "values"))
    for one in varied:
        grid.add(one.path, range_of(one))
    return grid


def _varied(rows: Swept) -> Grid:
    how = "each value with each" if not rows.drawn else rows.method
    grid = Grid(f"what varied: {len(rows.texts)} samples, {how}", ("path", "smallest", "largest", "values"))
    for j, path in enumerate(rows.paths):
        texts, values = list(dict.fromkeys(one[j] for one in rows.texts)), rows.values[:, j]
        count = f"{len(texts)}"
        if np.isfinite(values).all():
            low, high = (int(where) for where in (values.argmin(), values.argmax()))
            ends = [value_text(float(values[i]), rows.units[j], rows.texts[i][j]) for i in (low, high)]
            grid.add(path, *ends, count)
        else:
            grid.add(path, ", ".join(texts), "", count)
    return grid
