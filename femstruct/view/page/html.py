"""Pieces of the page: tables, lists, folds, pictures and sounds inside it."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path
from typing import Final

from femstruct.view.page.pictures import kind_of, told
from femstruct.view.tables.grid import Grid, fitting

_KINDS: Final = {".png": "image/png", ".gif": "image/gif", ".wav": "audio/wav"}
WIDEST: Final = 126  # characters of a table that fits on A4; what is wider goes on in another one below
LONGEST: Final = 44  # characters of a cell; a column with a longer one is text, and broken
EXCEEDED: Final = "exceeded"  # begins the cells of limits that are
HEADING: Final = 14  # characters of a heading, which is broken anywhere


def table(grid: Grid) -> str:
    """A table with its title, in pieces that fit on paper, each with the columns that name its rows; "" for none."""
    if not grid.rows:
        return ""
    widest = [max(_width(row[i]) for row in grid.rows) for i in range(len(grid.columns))]
    kinds = ["text" if width > LONGEST else "key" if i < grid.keys else "" for i, width in enumerate(widest)]
    widths = [
        max(min(LONGEST, width), min(HEADING, _width(head))) for width, head in zip(widest, grid.columns, strict=True)
    ]
    pieces = [_piece(grid, kinds, shown) for shown in fitting(widths, min(grid.keys, len(widths)), WIDEST)]
    return f"<h3>{escape(grid.title)}</h3>\n" + "\n".join(pieces)


def _piece(grid: Grid, kinds: Sequence[str], shown: Sequence[int]) -> str:
    def row(cells: Sequence[str], tag: str) -> str:
        marks = [f"{kinds[i]} severe".strip() if cells[i].startswith(EXCEEDED) else kinds[i] for i in shown]
        starts = [f'<{tag} class="{mark}">' if mark else f"<{tag}>" for mark in marks]
        return f"<tr>{''.join(f'{a}{escape(cells[i])}</{tag}>' for a, i in zip(starts, shown, strict=True))}</tr>"

    head, rows = row(grid.columns, "th"), "".join(row(cells, "td") for cells in grid.rows)
    return f'<div class="wide"><table><thead>{head}</thead><tbody>{rows}</tbody></table></div>'


def _width(cell: str) -> int:
    return max(map(len, cell.split("\n")))


def fold(title: str, parts: Iterable[str], kind: str = "") -> str:
    """What is read on demand, under a title, which is repeated inside for paper; "" where there is nothing of it."""
    inside = "\n".join(part for part in parts if part)
    start = f'<details class="{kind}">' if kind else "<details>"
    heading = f'<summary>{escape(title)}</summary>\n<h2 class="paper">{escape(title)}</h2>'
    return f"{start}{heading}\n{inside}\n</details>" if inside else ""


def listed(lines: Iterable[str], kind: str = "") -> str:
    """A list of sentences; "" for none."""
    start = f'<li class="{kind}">' if kind else "<li>"
    items = "".join(f"{start}{escape(line)}</li>" for line in lines)
    return f"<ul>{items}</ul>" if items else ""


def picture(name: str, file: bytes) -> str:
    """A picture with what it shows, and the name of its file."""
    image = f'<img src="{_inside(name, file)}" alt="{escape(told(name))}">'
    return f'<figure class="{kind_of(name).begins or "other"}">{image}<figcaption>{escape(name)}</figcaption></figure>'


def sound(name: str, file: bytes) -> str:
    """A sound to play, with the name of its file."""
    player = f'<audio controls preload="metadata" src="{_inside(name, file)}"></audio>'
    return f"<figure>{player}<figcaption>{escape(name)}</figcaption></figure>"


def _inside(name: str, file: bytes) -> str:
    """A file as its own address."""
    return f"data:{_KINDS[Path(name).suffix]};base64,{b64encode(file).decode('ascii')}"
