"""A study's results as one page, for a browser and for paper: what was asked, what came out, what forbids trust; the
rest in folds."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from pathlib import Path
from types import MappingProxyType
from typing import Final

from femstruct.errors import some_of
from femstruct.files.atomic import replacing
from femstruct.files.tables.finding_tables import findings_by_case
from femstruct.findings.entry import Rank
from femstruct.study.result import StudyResult
from femstruct.view.page.html import fold, listed, picture, sound, table
from femstruct.view.page.input_tables import baseline_inputs, cases_table, further_inputs, input_tables
from femstruct.view.page.natural_frequencies import natural_frequencies
from femstruct.view.page.pictures import MODEL, RATED, RESPONSE, by_kind, kind_of
from femstruct.view.page.style import STYLE
from femstruct.view.tables.accuracy_table import outcomes, trust
from femstruct.view.tables.finding_lines import finding_lines
from femstruct.view.tables.rated_table import first_drop
from femstruct.view.tables.terminal import asked_tables, notes, other_tables

_NO_FILES: Final[Mapping[str, bytes]] = MappingProxyType({})


def write_report(
    result: StudyResult,
    path: str | Path,
    pictures: Mapping[str, bytes] = _NO_FILES,
    sounds: Mapping[str, bytes] = _NO_FILES,
) -> Path:
    """Write the page to a path, in one step: what the terminal shows, and the files of pictures and sounds by name.

    All is inside the page: it asks nothing of a network or of its folder, and can be sent as one file.
    """
    path = Path(path)
    with replacing(path) as temporary:
        temporary.write_text(report(result, pictures, sounds), encoding="utf-8")
    return path


def report(
    result: StudyResult, pictures: Mapping[str, bytes] = _NO_FILES, sounds: Mapping[str, bytes] = _NO_FILES
) -> str:
    """The page as HTML, with the files of pictures (png, gif) and sounds (wav) by name."""
    title = escape(result.plan.title)
    screen = '<meta name="viewport" content="width=device-width, initial-scale=1">'  # a telephone's own width
    head = f'<meta charset="utf-8">{screen}<title>{title}</title><style>{STYLE}</style>'
    ranks = _ranked(result)
    parts = [
        f"<h1>{title}</h1>",
        _warning(result, ranks[Rank.FORBIDS]),
        *_asked(result, pictures),
        *_found(result, pictures),
        *_trust(result, ranks),
        *_folds(result, pictures, sounds),
    ]
    versions = ", ".join(f"{name} {value}" for name, value in result.provenance.items() if value)
    body = "\n".join(part for part in parts if part)
    return (
        f'<!doctype html>\n<html lang="en"><head>{head}</head>\n<body>\n{body}\n'
        f"<footer>{escape(versions)}</footer>\n</body></html>\n"
    )


def _warning(result: StudyResult, forbids: list[str]) -> str:
    """Before anything is read: that the results must not be trusted."""
    if not forbids:
        return ""
    codes = some_of(dict.fromkeys(line.partition(":")[0] for line in forbids))
    return f'<p class="severe">Do not trust these results: {escape(codes)}. The reasons are under “Trust”.</p>'


def _asked(result: StudyResult, pictures: Mapping[str, bytes]) -> list[str]:
    """The model, the inputs of the baseline, and the cases."""
    models = [picture(name, file) for name, file in pictures.items() if kind_of(name).begins == MODEL]
    cases = table(cases_table(result.plan, list(result.cases)))
    inputs = [table(grid) for grid in input_tables(baseline_inputs(result.plan))]
    changed = listed(result.comparison.inputs)
    between = ["<h2>What differs in the input files</h2>", changed] if changed else []
    return ["<h2>Model and inputs</h2>", *models, *inputs, *(["<h2>Cases</h2>", cases] if cases else []), *between]


def _found(result: StudyResult, pictures: Mapping[str, bytes]) -> list[str]:
    """The results that were asked for: ratings, limits, levels, peaks, and how the cases ended; where none is asked
    for, natural frequencies and frequency responses."""
    about = [first_drop(result)] if first_drop(result) else []
    tables = [table(grid) for grid in asked_tables(result)]
    if not any(tables):
        tables = [table(natural_frequencies(result))]
    shown = [picture(name, file) for name, file in pictures.items() if kind_of(name).begins in _front(result)]
    return ["<h2>Results</h2>", listed([*outcomes(result), *about, *notes(result)]), *tables, *shown]


def _front(result: StudyResult) -> tuple[str, ...]:
    """Kinds of pictures among the results."""
    return (RATED,) if any(grid.rows for grid in asked_tables(result)) else (RATED, RESPONSE)


def _ranked(result: StudyResult) -> dict[Rank, list[str]]:
    """All findings as lines by rank, each with the cases it holds for."""
    told = [
        (finding, f" ({', '.join(cases)})" if 0 < len(cases) < len(result.cases) else "")
        for finding, cases in findings_by_case(result)
    ]
    lines = finding_lines(told, verbose=True)
    return {rank: [line.removeprefix(f"{rank.value}, ") for own, line in lines if own is rank] for rank in Rank}


def _trust(result: StudyResult, ranks: Mapping[Rank, list[str]]) -> list[str]:
    """What forbids trust; how far the numbers may be off; what limits trust and what is remarked, in folds."""
    forbids = listed(ranks[Rank.FORBIDS], "severe") or "<p>No finding forbids trust.</p>"
    limits, remarks = ranks[Rank.LIMITS], ranks[Rank.REMARK]
    return [
        "<h2>Trust</h2>",
        forbids,
        listed(trust(result)),
        fold(f"Findings that limit trust ({len(limits)})", [listed(limits)]),
        fold(f"Remarks ({len(remarks)})", [listed(remarks)]),
    ]


def _folds(result: StudyResult, pictures: Mapping[str, bytes], sounds: Mapping[str, bytes]) -> list[str]:
    """All else: further inputs, other tables, sounds, pictures by kind."""
    kinds = {kind: names for kind, names in by_kind(pictures).items() if kind.begins not in (MODEL, *_front(result))}
    heard = [(name, case) for name, case in result.cases.items() if case.rooms]
    order = ", ".join(f"{name}, {name} with the bodies' own sound" if c.heard.total else name for name, c in heard)
    listen = [f"<p>All cases in turn, at one scale: {escape(order)}</p>"] if sounds else []
    grids = (natural_frequencies(result), *other_tables(result))
    return [
        fold("Further inputs", [table(further_inputs(baseline_inputs(result.plan)))]),
        fold("More tables", [table(grid) for grid in grids]),
        fold("Sounds", [*listen, *(sound(name, file) for name, file in sounds.items())], kind="sounds"),
        *(fold(kind.heading, [picture(name, pictures[name]) for name in names]) for kind, names in kinds.items()),
    ]
