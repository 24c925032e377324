"""Names that are formulas, markup or patterns elsewhere are just names: in tables, pictures, files and the page."""

from __future__ import annotations

from pathlib import Path

import h5py

from femstruct.files.results_file import read_results
from femstruct.language.cases import read_study
from femstruct.workflow.run import run_study, write_all

MODEL = """
materials: {$\\foo$: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts:
  "$\\\\foo$ {x}":
    {type: plate, material: $\\foo$, thickness: 2 mm, origin: [0, 0, 0.3], size: [0.4, 0.3], mesh: [8, 6]}
supports: {"<b>": {on: "$\\\\foo$ {x}", edge: all, fix: simple}}
points: {"$_$": {on: "$\\\\foo$ {x}", at: [0.17, 0.11]}}
surfaces: {"%s": {on: "$\\\\foo$ {x}", side: below}}
damping: {ratio: 2 %}
"""
STUDY = """
model: model.yaml
title: "$\\\\frac{1}$ <i> [red]"
modes: {up_to: 500 Hz}
frf: {"$^$": {drive: $_$.z, response: $_$.z, kind: mobility, band: [10 Hz, 400 Hz], step: 1 Hz}}
bodies: {"$\\\\ball$": {mass: 10 g, above: $_$, speed: 1 m/s, contact: {type: hertz, stiffness: 1e8}}}
record: {$_$.z: velocity}
time: {duration: 50 ms, sampling: 8 kHz}
rooms:
  "$x^$": {size: [0.4, 0.3, 0.2], under: "%s", losses: {t60: 0.1 s}, receivers: {"..\\\\$m$/": [0.1, 0.1, 0.1]}}
cases:
  $\\foo$: {}
  "<script>alert(1)</script>/${y}": {bodies.$\\ball$.mass: 20 g}
  x_: {bodies.$\\ball$.mass: 30 g}
  한국어 日本語 éß: {bodies.$\\ball$.mass: 5 g}
"""


def test_a_study_of_strange_names_runs(tmp_path: Path) -> None:
    (tmp_path / "model.yaml").write_text(MODEL, encoding="utf-8")
    (tmp_path / "a.study.yaml").write_text(STUDY, encoding="utf-8")
    result = run_study(read_study(tmp_path / "a.study.yaml"))
    write_all(result, tmp_path / "out")
    stored = read_results(tmp_path / "out" / "results.h5")
    assert list(stored.cases) == list(result.cases)
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "<script>alert(1)" not in page and "한국어" in page
    with h5py.File(tmp_path / "out" / "results.h5") as file:
        assert len(file["cases"]) == 4
    assert len(list((tmp_path / "out").glob("*.png"))) >= 6
