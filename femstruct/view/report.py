"""A study's results as one page for a browser: tables, findings and pictures, case beside case."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from types import MappingProxyType
from typing import Final

from femstruct.files.atomic import replacing
from femstruct.files.finding_tables import findings_by_case
from femstruct.findings.entry import Rank
from femstruct.study.result import StudyResult
from femstruct.view.tables.accuracy_table import outcomes, trust
from femstruct.view.tables.finding_lines import finding_lines
from femstruct.view.tables.grid import Grid
from femstruct.view.tables.rated_table import first_drop
from femstruct.view.tables.terminal import study_tables

_STYLE: Final = """
body { font: 15px/1.5 system-ui, sans-serif; margin: 2em auto; max-width: 72em; padding: 0 1em; color: #222; }
h1 { font-size: 1.5em; } h2 { font-size: 1.1em; margin: 2em 0 .4em; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .15em .8em; text-align: right; white-space: pre-line; border-bottom: 1px solid #ddd; }
td { white-space: pre; } /* a number is not broken; what is too wide is scrolled */
th.key, td.key { text-align: left; padding-left: 0; }
.wide { overflow-x: auto; } figure { margin: 1em 0; }
img { max-width: 100%; } .severe { color: #b00020; } figcaption { color: #666; }
"""
_KINDS: Final = {".png": "image/png", ".gif": "image/gif", ".wav": "audio/wav"}
_NOTHING: Final[Mapping[str, bytes]] = MappingProxyType({})


def write_report(
    result: StudyResult,
    path: str | Path,
    pictures: Mapping[str, bytes] = _NOTHING,
    sounds: Mapping[str, bytes] = _NOTHING,
) -> Path:
    """Write the page to a path, in one step: what the terminal shows, and the files of pictures and sounds by name.

    All is inside the page: it asks nothing of a network or of its folder, and can be sent as one file.
    """
    path = Path(path)
    with replacing(path) as temporary:
        temporary.write_text(report(result, pictures, sounds), encoding="utf-8")
    return path


def report(
    result: StudyResult, pictures: Mapping[str, bytes] = _NOTHING, sounds: Mapping[str, bytes] = _NOTHING
) -> str:
    """The page as HTML, with the files of pictures (png, gif) and sounds (wav) by name."""
    title = escape(result.plan.title)
    parts = [f"<h1>{title}</h1>", _outcomes(result), _findings(result)]
    parts += [_table(grid) for grid in study_tables(result) if grid.rows]
    if sounds:
        heard = [(name, case) for name, case in result.cases.items() if case.rooms]
        cases = ", ".join(f"{name}, {name} with the bodies' own sound" if c.heard.total else name for name, c in heard)
        parts.append(f"<h2>Sounds of all cases in turn, at one scale: {escape(cases)}</h2>")
    parts += [_sound(name, file) for name, file in sounds.items()]
    parts += [_picture(name, file) for name, file in pictures.items()]
    told = ", ".join(f"{name} {value}" for name, value in result.provenance.items() if value)
    screen = '<meta name="viewport" content="width=device-width, initial-scale=1">'  # a telephone's own width
    head = f'<meta charset="utf-8">{screen}<title>{title}</title><style>{_STYLE}</style>'
    body = "\n".join(part for part in parts if part)
    return (
        f'<!doctype html>\n<html lang="en"><head>{head}</head>\n<body>\n{body}\n<p>{escape(told)}</p>\n</body></html>\n'
    )


def _outcomes(result: StudyResult) -> str:
    """How every case ended, and how far its numbers may be off."""
    about = [first_drop(result)] if first_drop(result) else []
    lines = [f"<li>{escape(line)}</li>" for line in (*outcomes(result), *trust(result), *about)]
    return f"<ul>{''.join(lines)}</ul>" if lines else ""


def _findings(result: StudyResult) -> str:
    """All findings by rank, remarks among them."""
    told = [
        (finding, f" ({', '.join(cases)})" if 0 < len(cases) < len(result.cases) else "")
        for finding, cases in findings_by_case(result)
    ]
    marks = {Rank.FORBIDS: ' class="severe"'}
    lines = [
        f"<li{marks.get(rank, '') if rank else ''}>{escape(line)}</li>"
        for rank, line in finding_lines(told, verbose=True)
    ]
    return f"<h2>Findings</h2>\n<ul>{''.join(lines)}</ul>" if lines else ""


def _table(grid: Grid) -> str:
    def row(cells: Sequence[str], tag: str) -> str:
        made = (
            f"<{tag}{' class=key' if number < grid.keys else ''}>{escape(cell)}</{tag}>"
            for number, cell in enumerate(cells)
        )
        return f"<tr>{''.join(made)}</tr>"

    rows = "".join(row(cells, "td") for cells in grid.rows)
    return f'<h2>{escape(grid.title)}</h2>\n<div class="wide"><table>{row(grid.columns, "th")}{rows}</table></div>'


def _picture(name: str, file: bytes) -> str:
    image = f'<img src="{_inside(name, file)}" alt="{escape(name)}">'
    return f"<figure>{image}<figcaption>{escape(name)}</figcaption></figure>"


def _sound(name: str, file: bytes) -> str:
    player = f'<audio controls preload="metadata" src="{_inside(name, file)}"></audio>'
    return f"<figure>{player}<figcaption>{escape(name)}</figcaption></figure>"


def _inside(name: str, file: bytes) -> str:
    """A file as its own address."""
    return f"data:{_KINDS[Path(name).suffix]};base64,{b64encode(file).decode('ascii')}"
