"""Attenuations at modes: only of modes that the record shows, from a spectrum that short records cannot blow up."""

import runpy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from femstruct.study.recorded import Channel
from femstruct.workflow import case_comparison as module
from femstruct.workflow.case_comparison import NO_NODE, Spectra, compare, spectral_size

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


def decaying(case, sampling, duration, size=1.0, frequency=151.1, ratio=0.02):
    """A case whose one channel is size exp(-s t) sin(w t), sampled."""
    t = np.arange(round(sampling * duration)) / sampling
    w = 2 * np.pi * frequency
    values = size * np.exp(-ratio * w * t) * np.sin(w * t)
    clock = replace(case.response.clock, sampling=sampling, duration=duration)
    channels = {"c velocity": Channel("c velocity", values, "m/s", size, size)}
    return replace(case, response=replace(case.response, clock=clock), channels=channels)


def beside(**other):
    """A decaying motion in mode 3 at 10 kHz for half a second, and another one beside it."""
    first, second = BY_HAND["study_by_hand"]().cases.values()
    cases = {"a": decaying(first, 10e3, 0.5), "b": decaying(second, **{"sampling": 10e3, "duration": 0.5, **other})}
    return compare("a", cases, Spectra()).cases["b"]


@pytest.mark.parametrize(("sampling", "duration"), [(12e3, 0.5), (20e3, 0.5), (11025.0, 0.5), (12e3, 0.7), (6e3, 0.4)])
@pytest.mark.parametrize("size", [1.0, 0.5])
def test_one_motion_sampled_twice_is_the_same_motion(sampling, duration, size):
    """The same closed form at another sampling, over another window: 0 dB, and 6.02 dB where it is half as large."""
    found = beside(sampling=sampling, duration=duration, size=size)
    # 0.01: folding at a quarter of 6 kHz and less; |FFT| without the sampling in it is 1.6 dB off at 12 kHz, 4.4 at 6
    assert found.modes_db["c velocity"][3] == pytest.approx(-20 * np.log10(size), abs=0.01)
    assert any("modes are compared up to" in note for note in found.notes)


def test_a_longer_window_of_a_motion_that_has_not_decayed_is_cut_to_the_other():
    """0.02 % of critical: in 0.4 of 0.5 s the spectrum of a lasting motion is 1.9 dB smaller."""
    first, second = BY_HAND["study_by_hand"]().cases.values()
    cases = {"a": decaying(first, 10e3, 0.5, ratio=2e-4), "b": decaying(second, 10e3, 0.4, ratio=2e-4)}
    found = compare("a", cases, Spectra()).cases["b"]
    assert found.modes_db["c velocity"][3] == pytest.approx(0.0, abs=1e-9)  # rounding: the same samples
    assert len(found.notes) == 1 and "modes are compared over the first 0.4 s" in found.notes[0]


def test_modes_above_a_quarter_of_the_lower_sampling_are_not_compared():
    """Mode 3, 151.1 Hz, at 600 Hz is just above, and at 610 Hz below."""
    assert 3 not in beside(sampling=600.0).modes_db["c velocity"]
    assert 3 in beside(sampling=610.0).modes_db["c velocity"]


def test_the_size_of_a_spectrum_is_that_of_the_integral():
    """A cosine that decays, which starts with a jump: (s + i w) / ((s + i w)^2 + wd^2)."""
    t, s, wd = np.arange(20_000) / 10e3, 20.0, 2 * np.pi * 150.0
    for f in (0.0, 100.0, 150.0, 400.0):
        z = s + 2j * np.pi * f
        exact = abs(z / (z**2 + wd**2))
        found = spectral_size(np.exp(-s * t) * np.cos(wd * t), 10e3, f)
        assert found == pytest.approx(exact, rel=0.01)  # (w dt)^2 / 12 of the trapezoidal rule: 0.5 % at 400 Hz


def test_cases_that_differ_in_nothing_have_no_notes():
    assert beside().notes == ()


def test_modes_of_structures_without_a_common_node_are_not_compared():
    first, second = BY_HAND["study_by_hand"]().cases.values()
    away = replace(second, basis=replace(second.basis, points=second.basis.points + 10.0))
    found = compare("a", {"a": decaying(first, 10e3, 0.5), "b": decaying(away, 10e3, 0.5)}, Spectra()).cases["b"]
    assert found.notes == (NO_NODE,) and not found.modes_db and not found.frequencies
    assert found.peaks["c velocity"].whole_percent == 0.0
