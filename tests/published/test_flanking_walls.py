"""The shipped slab with flanking walls beside EN 12354-1:2000 annex E: how far its walls are below it."""

from __future__ import annotations

from math import log10, pi, sqrt
from pathlib import Path

import numpy as np
import pytest

from femstruct.language.cases import read_study
from femstruct.workflow.run import run_study

MODELS = Path(__file__).parents[2] / "models"
SLAB, C0 = (20.0, 0.18 * 2400), 343.0  # m^2, kg/m^2; m/s


def below_slab_db(area: float, mass: float, length: float, hz: float, loss_factor: float) -> float:
    """Radiated power of a wall under a slab over that of the slab, both radiating fully: K_ij of a rigid T junction."""
    k_ij = 5.7 + 5.7 * log10(mass / SLAB[1]) ** 2
    t_s = 2.2 / (hz * loss_factor)
    absorption = [2.2 * pi**2 * s / (C0 * t_s) * sqrt(1000 / hz) for s in (SLAB[0], area)]
    difference = k_ij - 10 * log10(length / sqrt(absorption[0] * absorption[1]))
    return -difference + 10 * log10(area / SLAB[0])


def test_the_estimate_is_that_of_the_note() -> None:
    found = [below_slab_db(area, 0.175 * 1800, length, 250.0, 0.05) for area, length in ((10.0, 4.0), (12.5, 5.0))]
    assert found == pytest.approx([-12.9, -11.4], abs=0.06)  # one decimal


@pytest.mark.stress
def test_walls_are_as_far_below_the_slab_as_annex_e_has_them() -> None:
    """Bands of 200 and 250 Hz, above the critical frequencies, a few modes each: 3 dB, the scatter of such bands."""
    shares = (
        run_study(read_study(MODELS / "flanking_walls.study.yaml", only="175 mm")).cases["175 mm"].by_surface["living"]
    )
    rows = [shares.bands_hz.tolist().index(band) for band in (200.0, 250.0)]
    slab, left, back = (float(10 * np.log10((10 ** (one[rows] / 10)).mean())) for one in shares.alone_db)
    assert left - slab == pytest.approx(below_slab_db(10.0, 315.0, 4.0, 224.0, 0.05), abs=3.0)  # dB, the scatter
    assert back - slab == pytest.approx(below_slab_db(12.5, 315.0, 5.0, 224.0, 0.05), abs=3.0)  # dB, the scatter
