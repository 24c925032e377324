"""Bands by transforms against the recursion of scipy.signal, which is what the standard's filters are tested with."""

from __future__ import annotations

import subprocess
import sys
from math import ceil

import numpy as np
import pytest
import scipy.signal

from acoustics.levels.bands import band_filter, band_passes, octave_bands, ringing_time, third_octave_bands
from acoustics.levels.sound_levels import sound_levels
from acoustics.levels.weighting import time_weighted
from acoustics.rooms.box_pressure import fade_out

RATE, SAMPLES = 48e3, 48000


def sounds() -> list[np.ndarray]:
    random, t = np.random.default_rng(3), np.arange(SAMPLES) / RATE
    noise = random.standard_normal(SAMPLES) * np.exp(-t / 0.2)
    return [noise, np.sin(2 * np.pi * 80 * t), np.exp(-(((t - 0.3) / 2e-3) ** 2))]


@pytest.mark.parametrize("fraction", [1, 3])
def test_every_sample_is_that_of_the_recursion(fraction) -> None:
    centres = octave_bands(RATE) if fraction == 1 else third_octave_bands(RATE)
    passes = band_passes(SAMPLES, RATE, fraction, thinned=False)
    assert list(passes) == list(centres)
    for p in sounds():
        spectrum = np.fft.rfft(p, next(iter(passes.values())).length)
        for nominal, one in passes.items():
            heard = one.of(spectrum, float(p[-1])).values
            wanted = scipy.signal.sosfilt(band_filter(centres[nominal], RATE, fraction), fade_out(p, one.tail))
            # what has fallen by 60 dB twice, after the fade and the ringing of a tone that does not end, comes round
            assert np.abs(heard - wanted).max() < 1e-5 * np.abs(p).max(), nominal


def test_levels_are_those_of_the_recursion() -> None:
    """Largest Fast levels and exposures of all bands, of which few samples are kept."""
    keep = np.exp(-1 / RATE / 0.125)
    for p in sounds():
        found = sound_levels(p, 1 / RATE)
        for fraction, centres, levels in (
            (3, third_octave_bands(RATE), found.bands_db),
            (1, octave_bands(RATE), found.octaves_db),
        ):
            for nominal, centre in centres.items():
                tail = ceil(ringing_time(centre, fraction) * RATE)
                heard = scipy.signal.sosfilt(band_filter(centre, RATE, fraction), fade_out(p, tail))
                fast = scipy.signal.lfilter([1 - keep], [1, -keep], heard**2).max()
                wanted = 10 * np.log10(max(fast, 1e-30) / 4e-10)
                if wanted > max(levels.values()) - 80:
                    # maxima between the samples that are kept: 6e-4 dB here
                    assert levels[nominal] == pytest.approx(wanted, abs=2e-3), nominal
                    if fraction == 3:
                        exposure = 10 * np.log10(heard @ heard / RATE / 4e-10)
                        # of the samples that are kept: 2e-6 dB here
                        assert found.exposure_db[nominal] == pytest.approx(exposure, abs=2e-4), nominal


def test_time_weightings_are_those_of_the_recursion() -> None:
    for p in sounds():
        for kind, tau in (("F", 0.125), ("S", 1.0)):
            keep = np.exp(-1 / RATE / tau)
            wanted = scipy.signal.lfilter([1 - keep], [1, -keep], p**2)
            # rounding: 1e-14 here
            assert np.abs(time_weighted(p**2, 1 / RATE, kind) - wanted).max() < 1e-11 * wanted.max()
    long = np.ones(400_000)  # 400 s, longer than the exponent of Fast reaches
    assert time_weighted(long, 1e-3, "F")[-1] == pytest.approx(1.0)


@pytest.mark.parametrize("fraction", [1, 3])
def test_ringing_time_is_that_of_the_slowest_pole(fraction) -> None:
    """60 dB of the pole of the analogue filter that is nearest the axis."""
    edge = 10 ** (0.15 / fraction)
    poles = scipy.signal.butter(4, [1 / edge, edge], "bandpass", analog=True, output="zpk")[1]
    wanted = 3 * np.log(10) / (2 * np.pi * 125.0 * np.abs(poles.real).min())
    assert ringing_time(125.0, fraction) == pytest.approx(wanted, rel=1e-9)  # poles of a polynomial by scipy


def test_levels_need_no_signal_package() -> None:
    """Importing scipy.signal takes longer than the levels of a record."""
    code = (
        "import sys, numpy as np; from acoustics.levels.sound_levels import sound_levels; "
        "sound_levels(np.ones(4800), 1 / 48e3); "
        "print('scipy.signal' in sys.modules)"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert told.strip() == "False"
