"""What is printed: whole cells at every width, findings with their cases, modes without a mass."""

import runpy
from dataclasses import replace
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from femstruct.errors import Finding
from femstruct.study.asked import PeakRule
from femstruct.view import structure_tables as structure
from femstruct.view import terminal
from femstruct.view.case_tables import energies, first_impact
from femstruct.view.console import Grid

BY_HAND = runpy.run_path(str(Path(__file__).parents[1] / "data" / "study_by_hand.py"))
MODES = {
    "solver": "LAPACK fronts",
    "title": "given",
    "frequency_hz": [10.0],
    "damping_ratio": [0.02],
    "kind": ["elastic"],
    "modal_mass_kg": {"x": [0.0], "y": [0.0], "z": [0.0]},
    "mass_kg": 0.0,
    "complete_below_hz": None,
    "findings": [],
}


def table(result, begins):
    """The table of a study whose title begins so."""
    (found,) = (grid for grid in terminal.study_tables(result) if grid.title.startswith(begins))
    return found


@pytest.mark.parametrize("width", [36, 50, 200])  # the narrowest holds the name of a row and one cell
def test_no_cell_is_broken(width):
    grid = Grid("peaks", ("", *(f"case {i}" for i in range(5))))
    grid.add("O_f.z velocity", *(f"0.{i}2345 / 0.{i}6789\n+10{i}.0 % / +20{i}.0 %" for i in range(5)))
    console = Console(width=width, file=StringIO())
    grid.show(console)
    text = console.file.getvalue()
    assert all(f"0.{i}2345 / 0.{i}6789" in text for i in range(5))
    assert all(f"+10{i}.0 % / +20{i}.0 %" in text for i in range(5))
    assert max(map(len, text.splitlines())) <= width


def test_findings_of_some_cases_name_them(capsys):
    result = BY_HAND["study_by_hand"]()
    second = list(result.cases)[1]
    case = result.cases[second]
    changed = replace(case, findings=(*case.findings, Finding("own", "Of one alone.")))
    terminal.show_study(replace(result, cases={**result.cases, second: changed}), {})
    printed = capsys.readouterr().out
    (common,) = case.findings[:1]
    assert f"{common.code}: {common.message}\n" in printed  # of all cases, so none is named
    assert f"own: Of one alone. (case {second})\n" in printed


@pytest.mark.parametrize(
    ("below_hz", "plates", "told"),
    [
        (None, [], "all modes of this model are listed\n"),
        (0.0, ["floor"], ""),
        (99.0, [], "no mode of this model is missing below 99 Hz\n"),
        (99.0, ["floor", "slab"], "missing below 99 Hz; its plates (floor, slab) have none in their own planes\n"),
        (None, ["floor"], "all modes of this model are listed; its plates (floor) have none in their own planes\n"),
    ],
)
def test_modes_without_a_mass(capsys, below_hz, plates, told):
    structure.show_modes({**MODES, "complete_below_hz": below_hz, "rigid_in_plane": plates})
    printed = capsys.readouterr().out
    assert printed.splitlines()[2].split()[-3:] == ["-", "-", "-"]
    assert "mass 0" not in printed and "inf" not in printed
    assert told in printed and ("missing" in printed) == ("missing" in told)


def test_cases_that_ended_alike_share_a_line(capsys):
    result = BY_HAND["study_by_hand"]()
    terminal.show_study(result, {})
    printed = capsys.readouterr().out
    outcome = next(iter(result.cases.values())).response.outcome.value
    assert printed.count(outcome) == 1 and f"all cases: {outcome}" in printed


def test_a_title_longer_than_its_table_is_not_broken():
    console = Console(width=80, file=StringIO())
    grid = Grid("where the energy went [% at the separation / at the end]", ("", "a"))
    grid.add("ball", "1 / 2")
    grid.show(console)
    assert console.file.getvalue().splitlines()[0] == grid.title


def test_energies_are_told_in_a_unit_that_fits_and_nothing_as_nothing():
    result = BY_HAND["study_by_hand"]()
    for case in result.cases.values():
        ledger = case.response.ledger
        end = replace(ledger.end, structure=1e-15)
        object.__setattr__(ledger, "end", end)
    grid = energies(result)
    assert grid.title == "energy [mJ]"  # 120 mJ, made by hand
    ends = [row for row in grid.rows if row[1] == "end"]
    assert ends and all(row[grid.columns.index("structure")] == "0" for row in ends)


def test_a_ledger_says_what_later_blows_and_work_put_in():
    """Of hammers that strike one after the other, the energy of the first alone was to be seen at the start."""
    result = BY_HAND["study_by_hand"]()
    ledger = next(iter(result.cases.values())).response.ledger
    object.__setattr__(ledger, "end", replace(ledger.end, blows=0.5, work=0.25))
    grid = energies(result)
    put_in = [row[grid.columns.index("put in")] for row in grid.rows[:3]]
    first = ledger.start.total + ledger.at_separation.work + ledger.at_separation.blows
    assert put_in == [f"{1e3 * one:.4g}" for one in (ledger.start.total, first, ledger.start.total + 0.75)]


def test_an_attenuation_of_nothing_has_no_sign():
    result = BY_HAND["study_by_hand"]()
    name = next(iter(result.comparison.cases))
    beside = replace(result.comparison.cases[name], modes_db={"O_f.z velocity": {1: -1e-4}})
    assert terminal._mode_db(beside, "O_f.z velocity", 1) == "0.00"


def test_modes_that_are_attenuated_alike_share_a_row():
    """Those that follow each other: mode 3 is not known, so that 4 is no part of them."""
    result = BY_HAND["study_by_hand"]()
    values = {1: 3.0, 2: 3.001, 4: 3.0, 5: -1.0}
    others = {name: replace(one, modes_db={"O_f.z velocity": values}) for name, one in result.comparison.cases.items()}
    grid = table(replace(result, comparison=replace(result.comparison, cases=others)), "attenuation")
    f = result.cases[result.comparison.baseline].basis.frequency_hz
    assert [row[1] for row in grid.rows] == ["1 to 2", "4", "5"]
    assert [row[2] for row in grid.rows] == [f"{f[0]:.1f} to {f[1]:.1f}", f"{f[3]:.1f}", f"{f[4]:.1f}"]
    assert [row[3] for row in grid.rows] == ["3.00", "3.00", "-1.00"]


def test_of_many_receivers_two_are_told_and_the_others_counted():
    result = BY_HAND["study_by_hand"]()
    (room,) = {name.partition(".")[0] for name in result.cases["without damper"].channels if name.endswith("pressure")}
    names = [f"{room}.{place} pressure" for place in ("a", "b", "c", "d")]
    cases = {
        name: replace(case, channels={**case.channels, **dict.fromkeys(names, case.channels[f"{room}.mic pressure"])})
        for name, case in result.cases.items()
    }
    others = {
        name: replace(beside, modes_db={one: {1: 3.0} for one in (*names, f"{room}.mic pressure")})
        for name, beside in result.comparison.cases.items()
    }
    grid = table(replace(result, cases=cases, comparison=replace(result.comparison, cases=others)), "attenuation")
    told = [row[0] for row in grid.rows if row[0].endswith("pressure")]
    assert told == [f"{room}.mic pressure", f"{room}.a pressure"]
    assert grid.title.endswith("(3 more receivers in summary.json)")


def test_an_acceleration_is_told_where_no_velocity_is():
    result = BY_HAND["study_by_hand"]()
    case = result.cases["without damper"]
    channel = case.channels["O_f.z velocity"]
    both = replace(
        case, channels={"P.z acceleration": channel, "O_f.z velocity": channel, "O_f.z acceleration": channel}
    )
    assert terminal._only_accelerates(both, "P.z acceleration")
    assert not terminal._only_accelerates(both, "O_f.z acceleration")
    assert not terminal._only_accelerates(both, "O_f.z velocity")


def test_without_contacts_there_is_no_first_impact():
    result = BY_HAND["study_by_hand"]()
    cases = {name: replace(case, response=replace(case.response, contacts={})) for name, case in result.cases.items()}
    grid = table(replace(result, cases=cases), "peaks")
    assert grid.title == "peaks: whole window (no filter)"
    assert not any("/" in cell for row in grid.rows for cell in row[1:])
    assert "first impact (20 ms) / whole" in table(result, "peaks").title
    until = {
        name: replace(case, case=replace(case.case, study=replace(case.case.study, peaks=PeakRule(first_impact=None))))
        for name, case in result.cases.items()
    }
    assert "first impact (until a contact closes again) / whole" in table(replace(result, cases=until), "peaks").title
    mixed = {**result.cases, "another": next(iter(until.values()))}
    assert first_impact(replace(result, cases=mixed)) == ""


def test_peaks_that_are_rounding_beside_others_are_0():
    result = BY_HAND["study_by_hand"]()
    name, case = next((name, case) for name, case in result.cases.items() if case.channels)
    channel = next(iter(case.channels.values()))
    few = replace(channel, name="few", first_impact=1e-12 * channel.whole, whole=1e-12 * channel.whole)
    case = replace(case, channels={**case.channels, "few": few})
    shown = table(replace(result, cases={**result.cases, name: case}), "peaks")
    (row,) = (row for row in shown.rows if row[0].startswith("few ["))
    cell = row[1 + list(result.cases).index(name)]
    assert set(cell.partition("\n")[0].split(" / ")) == {"0"}
    assert "; 0: below 1e-09 of the largest in its unit" in shown.title
    assert "; 0: below" not in table(result, "peaks").title
