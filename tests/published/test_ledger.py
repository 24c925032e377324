"""The reproduction ledger: verdicts follow from the numbers it writes, and no disagreement is without a reason."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest
import reproduce
from ledger.row import Row

OURS = {
    "chapter_1": 6,
    "chapter_2": 52,
    "chapter_3": 50,
    "chapter_4": 67,
    "chapter_5": 61,
}  # rows that must not get lost


@pytest.fixture(scope="module")
def found() -> dict[str, list[Row]]:
    return reproduce.gather()


def test_verdicts_follow_from_the_numbers_of_the_file(found: dict[str, list[Row]], tmp_path: Path) -> None:
    rows = [row for some in found.values() for row in some]
    reproduce.write_csv(rows, tmp_path / "ledger.csv")
    with (tmp_path / "ledger.csv").open(encoding="utf-8") as file:
        written = list(csv.DictReader(file))
    assert len(written) == len(rows)
    for line in written:
        printed, ours, tolerance = (float(line[name]) for name in ("printed", "ours", "tolerance"))
        slack = tolerance + 1e-9 * max(abs(printed), tolerance)  # ten digits are written
        agrees = {
            "=": abs(ours - printed) <= slack,
            "<": ours <= printed + slack,
            ">": ours >= printed - slack,
        }[line["relation"]]
        verdict, note = line["verdict"], line["note"]
        assert agrees == verdict.startswith("reproduced"), line
        assert ("assumed: " in note) == ("assumption" in verdict) or not agrees, line
        if not agrees:
            assert "because " in note, line
            assert ("own numbers give" in note) == (verdict == "source inconsistent"), line


def test_no_row_is_lost(found: dict[str, list[Row]]) -> None:
    for module, least in OURS.items():
        assert len(found[module]) >= least
    places = [row.where for rows in found.values() for row in rows]
    assert len(set(places)) == len(places)


def test_markdown_has_every_row(found: dict[str, list[Row]], tmp_path: Path) -> None:
    reproduce.write_markdown(found, tmp_path / "ledger.md")
    lines = (tmp_path / "ledger.md").read_text(encoding="utf-8").splitlines()
    table = [line for line in lines if line.startswith("| ") and not line.startswith("| where")]
    assert len(table) == sum(len(rows) for rows in found.values())
    assert all(line.replace("\\|", "").count("|") == 7 for line in table)


def test_rows_that_contradict_themselves_are_refused() -> None:
    with pytest.raises(ValueError, match="nothing says why"):
        Row("somewhere", 1.0, 2.0, 0.1)
    with pytest.raises(ValueError, match="does not contradict"):
        Row("somewhere", 1.0, 2.0, 0.1, implied=1.05, why="of a reason")
    with pytest.raises(ValueError, match="tolerance"):
        Row("somewhere", 1.0, 1.0, -0.1)


def test_verdicts() -> None:
    assert Row("a", 1.0, 1.05, 0.1).verdict == "reproduced"
    assert Row("b", 1.0, 1.05, 0.1, assumption="steel").verdict == "reproduced with an assumption"
    assert Row("c", 1.0, 2.0, 0.1, why="r").verdict == "not reproducible"
    assert Row("d", 1.0, 2.0, 0.1, implied=2.0, why="r").verdict == "source inconsistent"
    assert Row("e", 0.01, 0.004, 0.0, relation="<").verdict == "reproduced"
    assert Row("f", 0.8, 0.7, 0.0, relation=">", why="r").verdict == "not reproducible"
