"""docs/tapping.md: the formulas beside the tapping study, and the study itself (`-m stress`)."""

from __future__ import annotations

import re
import runpy
from math import log10, pi, sqrt
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPT = runpy.run_path(str(ROOT / "scripts" / "tapping_page.py"), run_name="page")
PAGE = (ROOT / "docs" / "tapping.md").read_text(encoding="utf-8")


def rows() -> dict[float, list[str]]:
    found = re.findall(r"^\| (\d+) \| (.*) \|$", PAGE, re.MULTILINE)
    return {float(band): cells.split(" | ") for band, cells in found}


def test_the_closed_form_by_two_routes() -> None:
    """322 kg/m^2, 500 Hz, eta 0.006 + m / (485 sqrt f): ISO 12354-2 (B.2), and force, mobility, losses and
    radiation one after the other; both to the digits of the study that has them."""
    assert SCRIPT["by_standard"](500.0, 322.0, 0.035691294) == pytest.approx(
        67.66293, abs=1e-4
    )  # eta of four digits there
    width, stiffness = 500.0 * (2 ** (1 / 6) - 2 ** (-1 / 6)), 7.15e6
    force = 20.0 * (0.5 * 0.886) ** 2 * width
    velocity = force / (8 * sqrt(stiffness * 322.0)) / (2 * pi * 500.0 * 0.035691294 * 322.0)  # times the area
    power = 1.204 * 343.25 * velocity
    # the study takes L_p = L_W + 10 lg(4 m^2 / A), which is that of air of 400 Pa s/m: 0.14 dB
    assert 10 * log10(4.0 * power / 10.0 / 1e-12) == pytest.approx(67.34064, abs=1e-3)  # eta of 4 digits
    assert 10 * log10(4.0 * 1.204 * 343.25 * power / 10.0 / 4e-10) == pytest.approx(67.48, abs=0.01)  # its digits


def test_the_page_has_table_c1_and_the_closed_form() -> None:
    table = rows()
    assert [float(cells[3]) for cells in table.values()] == list(SCRIPT["C1"])
    closed = {band: float(cells[2]) for band, cells in table.items() if cells[2] != "-"}
    assert min(closed) == 315.0
    for band, level in closed.items():
        sigma = 1 / sqrt(1 - SCRIPT["critical_hz"]() / band)
        assert level == pytest.approx(SCRIPT["by_standard"](band, sigma=sigma), abs=0.051)  # a digit
    for level, normalised, _, c1, more in table.values():
        assert float(normalised) - float(level) == pytest.approx(10 * log10(0.032 * SCRIPT["VOLUME"]), abs=0.101)
        assert float(more) == pytest.approx(float(normalised) - float(c1), abs=0.101)  # of rounded numbers


@pytest.mark.stress  # the bare case of the shipped study: some 15 s of CPU time
def test_the_page_is_of_the_study_as_it_is() -> None:
    found = SCRIPT["computed"]()
    for band, cells in rows().items():
        assert float(cells[0]) == pytest.approx(found[band], abs=0.1), band  # its digit; modes of another machine
