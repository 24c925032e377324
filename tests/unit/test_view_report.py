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
from femstruct.modal.basis import Holder
from femstruct.sound.cavity_coupling import WOOL
from femstruct.view.console import Grid
from femstruct.view.page import natural_frequencies, report, table, write_report
from femstruct.view.sound_figures import levels_over_time, rated_bands
from femstruct.view.terminal import study_tables

BY_HAND = runpy.run_path(str(Path(__file__).parents[1] / "data" / "study_by_hand.py"))
ALONE = {"meta", "img"}


class Page(HTMLParser):
    """Opens and closes tags; fails where they do not pair."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.sources: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
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


def test_the_page_begins_with_what_was_asked_and_folds_all_else(result):
    names = ("history_B.z_velocity.png", "rated_box.png", "model.png", "frf_floor.png", "energy.png")
    text = report(result, dict.fromkeys(names, b"a picture"), {"listen.box.mic.wav": b"a sound"})
    marks = [
        "<h1>By hand",
        "<h2>Model and inputs",
        'alt="Model"',
        "<h3>rooms",
        "<h3>analysis",
        "<h2>Cases",
    ]
    marks += ["<h2>Results", "<h3>levels", "<h3>peaks", 'alt="Rated bands: box"', "<h2>Trust", "<details"]
    places = [text.find(mark) for mark in marks]
    assert -1 not in places and places == sorted(places), dict(zip(marks, places, strict=True))
    front, folds = text[: places[-1]], text[places[-1] :]
    assert front.count("<img") == 2 and folds.count("<img") == 3 and "<audio" not in front
    assert folds.index("Frequency response:") < folds.index("History:") < folds.index('alt="Energy"')
    page = Page(text)
    assert all(attributes["alt"] for tag, attributes in page.tags if tag == "img")
    folded = [attributes for tag, attributes in page.tags if tag == "details"]
    assert len(folded) > 4 and not any("open" in attributes for attributes in folded)
    assert "<tbody></tbody>" not in text and "<ul></ul>" not in text
    cases = text[text.index("<h2>Cases") : text.index("<h2>Results")]
    assert all(f">{name}<" in cases for name in result.cases)


def test_what_forbids_trust_is_said_before_anything_else(result):
    sound = report(result)
    assert "No finding forbids trust" in sound and "Do not trust" not in sound
    case = result.cases[result.plan.baseline]
    told = Finding("energy-drift", "It drifts by 3 %, 0.1 % are allowed.", {}, severe=True)
    odd = report(replace(result, cases={**result.cases, result.plan.baseline: replace(case, findings=(told,))}))
    assert odd.index("Do not trust these results: energy-drift") < odd.index("<h2>")
    assert (
        odd.index("<h2>Trust") < odd.index("energy-drift: It drifts by 3 %, 0.1 % are allowed.") < odd.index("<details")
    )
    assert "No finding forbids trust" not in odd


def test_a_study_that_asks_for_responses_alone_shows_them_and_its_modes(result):
    cases = {name: replace(case, channels={}, levels={}) for name, case in result.cases.items()}
    alone = replace(result, cases=cases, verdicts={}, machine={})
    text = report(alone, {"mode_shapes.png": b"one", "frf_floor.png": b"two"})
    front, folds = text[text.index("<h2>Results") : text.index("<h2>Trust")], text[text.index("<details") :]
    assert "natural frequencies" in front and "<td>19.90, 2 %</td>" in front
    assert "Frequency response: floor" in front and "Frequency response: floor" not in folds
    assert 'alt="Mode shapes"' in folds and 'alt="Mode shapes"' not in front


def test_modes_stand_beside_each_other_where_cases_have_their_own(result):
    (first, case), *others = result.cases.items()
    shared = natural_frequencies(result)
    assert shared.columns == ("mode", ", ".join(result.cases))
    assert [row[1] for row in shared.rows[:2]] == ["0.00", "19.90, 2 %"]
    damped = replace(case.basis, viscous=2.0 * case.basis.viscous)
    apart = natural_frequencies(replace(result, cases={first: replace(case, basis=damped), **dict(others)}))
    assert apart.columns == ("mode", first, ", ".join(name for name, _ in others))
    assert apart.rows[1][1:] == ("19.90, 4 %", "19.90, 2 %")


def test_over_wool_the_damped_modes_are_listed(result):
    """Two modes that a strong dashpot couples: their eigenvalues, of which the diagonal (400 %) knows nothing."""
    case = next(iter(result.cases.values()))
    count, at = len(case.basis.omega), slice(case.basis.n_rigid, case.basis.n_rigid + 2)
    pushed = np.zeros((count, count))
    pushed[at, at] = 8.0 * case.basis.omega[at][0] * np.array([[1.0, 1.0], [1.0, 1.0]])
    coupled = replace(case.basis, viscous=pushed, hysteretic=np.zeros((count, count)))
    over_wool = replace(coupled, holders={WOOL: Holder(np.zeros((0, count)), np.zeros((0, count)))})
    shown = [
        natural_frequencies(replace(result, cases={"one": replace(case, basis=basis)})).rows
        for basis in (coupled, over_wool)
    ]
    assert shown[0][case.basis.n_rigid][1].endswith(", 400 %")
    state = np.block([[np.zeros((count, count)), np.eye(count)], [-np.diag(case.basis.omega**2), -pushed]])
    values = np.linalg.eigvals(state)
    swinging = np.sort_complex(values[values.imag > 1e-6 * case.basis.omega.max()])
    swinging = swinging[np.argsort(np.abs(swinging))]
    wanted = [f"{abs(s) / 2 / np.pi:.2f}, {-100 * s.real / abs(s):.3g} %" for s in swinging]
    told = [row[1] for row in shown[1]][case.basis.n_rigid :]
    assert told[0] == wanted[0] and not told[0].startswith(shown[0][case.basis.n_rigid][1][:4])


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
        assert np.max(line.get_ydata()) == pytest.approx(largest, abs=0.01)  # points of the line, thinned
    assert rated_bands(result, "box") is None
    assert levels_over_time(result, "no such room") is None


def test_limits_that_are_exceeded_and_wide_tables_on_paper():
    grid = Grid("limits", ("", "at most", "soft", "hard"), keys=2)
    grid.add("settled", "1 s", "met\n0.4 s, 0.6 s left", "exceeded by 0.2 s\n1.2 s")
    made = table(grid)
    assert made.count('class="severe"') == 1 and '<td class="severe">exceeded by 0.2 s' in made
    many = Grid("peaks", ("", *(f"case {number}" for number in range(30))))
    many.add("O_f.z acceleration [m/s^2]", *(f"{number}.25 / {number}.75" for number in range(30)))
    pieces = table(many)
    assert pieces.count("<table>") > 2 and pieces.count(">O_f.z acceleration") == pieces.count("<table>")
    assert all(f">{number}.25 / {number}.75<" in pieces for number in range(30))
