"""The page of a study: well-formed, what the terminal shows, nothing from a network, names with marks kept harmless."""

from __future__ import annotations

import re
import runpy
from base64 import b64encode
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from femstruct.errors import Finding
from femstruct.view.figures.loudness import levels_over_time, rated_bands
from femstruct.view.report import report, write_report
from femstruct.view.tables.terminal import study_tables

BY_HAND = runpy.run_path(str(Path(__file__).parents[1] / "data" / "study_by_hand.py"))
ALONE = {"meta", "img"}


class Page(HTMLParser):
    """Opens and closes tags; fails where they do not pair."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.words: list[str] = []
        self.sources: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        if tag not in ALONE:
            self.open.append(tag)
        self.sources += [value for name, value in attrs if name in ("src", "href")]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)


@pytest.fixture(scope="module")
def result():
    return BY_HAND["study_by_hand"]()


def test_every_cell_of_every_table_is_on_the_page(result):
    page = Page(report(result, {"energy.png": b"one", "a b&c.gif": b"two"}, {"listen.box.mic #2.wav": b"three"}))
    assert page.open == []
    kinds = ("audio/wav", b"three"), ("image/png", b"one"), ("image/gif", b"two")
    assert page.sources == [f"data:{kind};base64,{b64encode(file).decode()}" for kind, file in kinds]
    assert "a b&c.gif" in page.words
    words = set(page.words)
    grids = [grid for grid in study_tables(result) if grid.rows]
    assert len(grids) > 3
    for grid in grids:
        assert grid.title in words
        for row in grid.rows:
            assert {cell for cell in row if cell} <= words, grid.title


def test_marks_in_names_and_findings_are_text(result, tmp_path):
    case = result.cases[result.plan.baseline]
    told = Finding("odd<code>", 'a <script>alert("x")</script> & more', {}, severe=True)
    odd = replace(result, cases={**result.cases, result.plan.baseline: replace(case, findings=(told,))})
    path = write_report(odd, tmp_path / "report.html")
    text = path.read_text(encoding="utf-8")
    assert "<script" not in text
    assert not re.search(r"(src|href)=\"?https?:", text)
    page = Page(text)
    assert any('a <script>alert("x")</script> & more' in word for word in page.words)
    assert 'class="severe"' in text


def test_levels_over_time_show_the_largest_of_the_levels(result):
    figure = levels_over_time(result, "box")
    lines = figure.axes[0].get_lines()
    assert len(lines) == len(result.cases)
    for line, (name, case) in zip(lines, result.cases.items(), strict=True):
        largest = case.levels["box.mic"].l_afmax_db
        assert line.get_label() == f"{name}: largest {largest:.1f} dB"
        assert np.max(line.get_ydata()) == pytest.approx(largest, abs=0.01)
    assert rated_bands(result, "box") is None
    assert levels_over_time(result, "no such room") is None
