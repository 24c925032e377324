"""Attenuations at modes: only of modes that the record shows, from a spectrum that short records cannot blow up."""

import runpy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from femstruct.study.result import Channel
from femstruct.workflow.compare import compare as module
from femstruct.workflow.compare.compare import Spectra, compare

BY_HAND = runpy.run_path(str(Path(__file__).parents[1] / "data" / "study_by_hand.py"))


def test_attenuations_of_modes_are_those_of_the_record():
    result = BY_HAND["study_by_hand"]()
    table = compare("without damper", result.cases, Spectra()).cases["damper 0.6 / new"].modes_db["O_f.z velocity"]
    assert set(table) == {2, 3, 4, 5, 6}  # all elastic ones, 19.9 to 448.3 Hz, in 250 ms
    # half of everything: 6.02 dB; 1e-9: rounding of a Fourier transform
    assert list(table.values()) == pytest.approx([20 * np.log10(2)] * 5, abs=1e-9)


@pytest.mark.parametrize(("away", "belongs"), [(0.015, True), (-0.015, True), (0.03, False), (-0.03, False)])
def test_a_peak_belongs_to_a_mode_within_2_percent(away, belongs):
    """A burst of 9 Hz bandwidth has one peak, 1.5 or 3 % beside mode 3; a channel half as large beside it."""
    result = BY_HAND["study_by_hand"](duration=1.0)
    cases = {}
    for size, (name, case) in zip((1.0, 0.5), result.cases.items(), strict=True):
        t = case.response.t - 0.5
        burst = size * np.cos(2 * np.pi * 151.1 * (1 + away) * t) * np.exp(-((t / 0.1) ** 2))
        cases[name] = replace(case, channels={"burst": Channel("burst", burst, "m", 1.0, 1.0)})
    found = compare("without damper", cases, Spectra()).cases["damper 0.6 / new"].modes_db["burst"]
    assert (3 in found) == belongs  # at the other modes there is rounding only


def test_a_record_shorter_than_a_period_does_not_show_the_mode():
    result = BY_HAND["study_by_hand"](duration=20e-3)
    table = compare("without damper", result.cases, Spectra()).cases["damper 0.6 / new"].modes_db
    assert all(2 not in modes for modes in table.values())  # 19.9 Hz: 50.3 ms
    net = {
        name: replace(case, channels={"net force on O_f": replace(case.channels["ball on floor force"])})
        for name, case in result.cases.items()
    }
    table = compare("without damper", net, Spectra()).cases["damper 0.6 / new"].modes_db
    assert set(table["net force on O_f"]) == {3, 4, 5, 6}  # a net force is compared at all modes but that one


@pytest.mark.parametrize(("samples", "sampling"), [(400, 500e3), (400, 5e3), (100_000, 500e3), (3, 1e9)])
def test_spectra_are_fine_but_not_finer_than_the_record_can_use(samples, sampling, monkeypatch):
    lengths = []
    monkeypatch.setattr(np.fft, "rfft", lambda values, length: lengths.append(length) or np.zeros(1))
    Spectra().of(Channel("c", np.zeros(samples), "m", 0.0, 0.0), sampling)
    duration = samples / sampling
    # two lines at least in 2 % of what has one period in the record, or 0.2 Hz; a power of two: up to twice as many
    assert sampling / lengths[0] <= max(module.FINENESS, 0.5 * module.NEAR / duration)
    assert 2 * samples <= lengths[0] <= 2 * module.PADDING * samples


def test_a_spectrum_is_found_once_and_again_where_the_sampling_is_another(monkeypatch):
    lengths, transform = [], np.fft.rfft
    monkeypatch.setattr(np.fft, "rfft", lambda values, length: lengths.append(length) or transform(values, length))
    channel = Channel("c", np.arange(4000.0), "m", 0.0, 0.0)
    kept = Spectra()
    spectra = [kept.of(channel, sampling) for sampling in (2e3, 2e3, 8e4)]
    assert spectra[0] is spectra[1]
    assert len(lengths) == 2 and lengths[0] != lengths[1]
