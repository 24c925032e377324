"""Levels against the tables of IEC 61672-1:2013 and IEC 61260-1:2014."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import sosfreqz

from acoustics.levels.bands import band_filter, octave_bands, third_octave_bands
from acoustics.levels.sound_levels import sound_levels
from acoustics.levels.weighting import frequency_weighting, time_weighted, weighted

# IEC 61672-1:2013 table 3, A-weighting [dB] at nominal frequencies, rounded there to 0.1 dB
TABLE_A = {
    10: -70.4, 12.5: -63.4, 16: -56.7, 20: -50.5, 25: -44.7, 31.5: -39.4, 40: -34.6, 50: -30.2, 63: -26.2, 80: -22.5,
    100: -19.1, 125: -16.1, 160: -13.4, 200: -10.9, 250: -8.6, 315: -6.6, 400: -4.8, 500: -3.2, 630: -1.9, 800: -0.8,
    1000: 0.0, 1250: 0.6, 1600: 1.0, 2000: 1.2, 2500: 1.3, 3150: 1.2, 4000: 1.0, 5000: 0.5, 6300: -0.1, 8000: -1.1,
    10000: -2.5, 12500: -4.3, 16000: -6.6, 20000: -9.3,
}  # fmt: skip

# IEC 61260-1:2014 table 1, class 1: octave-scaled exponent of G = 10^0.3 for octave filters, least and most attenuation
CLASS_1 = [
    (0, -0.4, 0.4), (1 / 8, -0.4, 0.5), (1 / 4, -0.4, 0.7), (3 / 8, -0.4, 1.4), (1 / 2 - 1e-9, -0.4, 5.3),
    (1 / 2 + 1e-9, 1.2, np.inf), (1, 16.6, np.inf), (2, 40.5, np.inf), (3, 60, np.inf), (4, 70, np.inf),
]  # fmt: skip
FS = 48e3


def test_a_weighting_is_that_of_the_table():
    exact = 1000 * 10 ** (np.round(10 * np.log10(np.array(list(TABLE_A)) / 1000)) / 10)
    got = 20 * np.log10(np.abs(frequency_weighting(exact, "A")))
    np.testing.assert_allclose(got, list(TABLE_A.values()), rtol=0, atol=0.1)  # the table's rounding is 0.05


@pytest.mark.parametrize("f", [31.5, 100, 1000, 8000])
def test_a_weighting_of_a_tone(f):
    t = np.arange(24000) / FS
    tone = weighted(np.sqrt(2) * np.sin(2 * np.pi * f * t), 1 / FS, "A")
    # after 0.25 s the start is forgotten; 12000 samples are whole periods of 4 Hz, so of all four but 31.5 Hz (0.05 dB)
    assert 10 * np.log10((tone[12000:] ** 2).mean()) == pytest.approx(TABLE_A[f], abs=0.15)


def third_octave_frequency(centre, exponent):
    """IEC 61260-1 equations 10 and 11: the octave's breakpoint carried over to a fraction 1/3."""
    g, b = 10**0.3, 3
    step = 1 + (g ** (1 / (2 * b)) - 1) / (g**0.5 - 1) * (g ** abs(exponent) - 1)
    return centre * (step if exponent >= 0 else 1 / step)


def test_third_octaves_are_class_1_from_25_hz_to_20_khz():
    for nominal, centre in third_octave_bands(FS).items():
        sos = band_filter(centre, FS)
        for exponent, least, most in CLASS_1:
            for sign in (1, -1):
                f = third_octave_frequency(centre, sign * exponent)
                if f >= 0.49 * FS:
                    continue
                attenuation = -20 * np.log10(np.abs(sosfreqz(sos, [f], fs=FS)[1][0]) + 1e-30)
                assert least <= attenuation <= most, (nominal, sign * exponent, attenuation)


def test_an_order_3_filter_would_leave_the_mask():
    """The mask can fail: the limit that an order-3 band pass at 12.5 kHz breaks is among those checked."""
    from scipy.signal import butter

    centre = 1000 * 10**1.1
    sos = butter(3, [centre * 10**-0.05, centre * 10**0.05], "bandpass", fs=FS, output="sos")
    worst = [
        -20 * np.log10(abs(sosfreqz(sos, [third_octave_frequency(centre, -e)], fs=FS)[1][0])) - least
        for e, least, _ in CLASS_1
    ]
    assert min(worst) < 0


# IEC 61672-1:2013 table 4: duration of a 4 kHz burst [s]; largest F and S level below that of the steady tone [dB]
BURSTS = [
    (1.0, 0.0, -2.0), (0.5, -0.1, -4.1), (0.2, -1.0, -7.4), (0.1, -2.6, -10.2), (0.05, -4.8, -13.1),
    (0.02, -8.3, -17.0), (0.01, -11.1, -20.0), (0.005, -14.1, -23.0), (0.002, -18.0, -27.0),
]  # fmt: skip
SHORT_BURSTS = [(0.001, -21.0), (0.0005, -24.0), (0.00025, -27.0)]  # F only: S ends at 2 ms in the table


@pytest.mark.parametrize(("duration", "fast", "slow"), BURSTS)
def test_tone_bursts(duration, fast, slow):
    t = np.arange(72000) / FS
    burst = np.where(t < duration, np.sqrt(2) * np.sin(2 * np.pi * 4000 * t), 0)
    # the table is rounded to 0.1; of a burst the maximum is 10 lg(1 - exp(-T / tau))
    assert 10 * np.log10(time_weighted(burst**2, 1 / FS, "F").max()) == pytest.approx(fast, abs=0.06)
    assert 10 * np.log10(time_weighted(burst**2, 1 / FS, "S").max()) == pytest.approx(slow, abs=0.06)
    # table 4 again, exposure: 10 lg(T / 1 s)
    assert sound_levels(burst[: int(1.2 * FS)], 1 / FS).l_ae_db - 93.979 - 0.97 == pytest.approx(
        10 * np.log10(duration), abs=0.1 if duration >= 0.005 else 0.4
    )  # A at 4 kHz is +0.97 dB; a burst of 8 periods has a band of its own


@pytest.mark.parametrize(("duration", "fast"), SHORT_BURSTS)
def test_tone_bursts_too_short_for_slow(duration, fast):
    """Bursts of four, two and one period: the end of table 4."""
    t = np.arange(24000) / FS
    burst = np.where(t < duration - 1e-9, np.sqrt(2) * np.sin(2 * np.pi * 4000 * t), 0)
    # the table is rounded to 0.1 dB
    assert 10 * np.log10(time_weighted(burst**2, 1 / FS, "F").max()) == pytest.approx(fast, abs=0.06)


@pytest.mark.parametrize("sampling", [2e3, 8e3, 20e3])
def test_rated_third_octaves_are_class_1_at_coarse_samplings(sampling):
    """50 to 630 Hz, what heavy impacts are rated by, at the samplings that studies use."""
    for nominal, centre in third_octave_bands(sampling).items():
        sos = band_filter(centre, sampling)
        for exponent, least, most in CLASS_1 if 50 <= nominal <= 630 else ():
            for sign in (1, -1):
                f = third_octave_frequency(centre, sign * exponent)
                if f < 0.49 * sampling:
                    attenuation = -20 * np.log10(np.abs(sosfreqz(sos, [f], fs=sampling)[1][0]) + 1e-30)
                    assert least <= attenuation <= most, (nominal, sign * exponent, attenuation)


@pytest.mark.parametrize(("duration", "level"), [(0.02, -3.6), (0.005, -8.8), (0.002, -12.6)])
def test_impulse_of_single_bursts(duration, level):
    """IEC 60651 table 9 (2 kHz bursts): I is 3.6, 8.8 and 12.6 dB below the steady tone."""
    t = np.arange(72000) / FS
    burst = np.where(t < duration, np.sqrt(2) * np.sin(2 * np.pi * 2000 * t), 0)
    # the table is rounded to 0.1 dB
    assert 10 * np.log10(time_weighted(burst**2, 1 / FS, "I").max()) == pytest.approx(level, abs=0.06)


def test_impulse_falls_by_2_9_db_a_second():
    """A decay of 1.5 s: 10 lg(e) / 1.5 = 2.895 dB/s. Beyond 900 s the running maximum begins anew without a step."""
    square = np.zeros(100_000)
    square[:200] = 1.0
    held = 10 * np.log10(time_weighted(square, 1e-2, "I"))
    np.testing.assert_allclose(np.diff(held[300:])[::7], -2.895e-2, rtol=1e-3)  # digits of 2.895; 1e-4 here


def test_c_weighting_is_that_of_the_table():
    """IEC 61672-1:2013 table 3 at octaves, rounded there to 0.1 dB."""
    table = {31.5: -3.0, 63: -0.8, 125: -0.2, 250: 0.0, 1000: 0.0, 4000: -0.8, 8000: -3.0, 16000: -8.5}
    exact = 1000 * 10 ** (np.round(10 * np.log10(np.array(list(table)) / 1000)) / 10)
    got = 20 * np.log10(np.abs(frequency_weighting(exact, "C")))
    np.testing.assert_allclose(got, list(table.values()), rtol=0, atol=0.06)  # rounded to 0.1 dB, see above
    assert frequency_weighting(exact, "Z").tolist() == [1.0] * len(exact)


def test_octaves_are_class_1():
    for nominal, centre in octave_bands(FS).items():
        sos = band_filter(centre, FS, 1)
        for exponent, least, most in CLASS_1:
            for f in (centre * 10 ** (0.3 * exponent), centre * 10 ** (-0.3 * exponent)):
                if f < 0.49 * FS:
                    attenuation = -20 * np.log10(np.abs(sosfreqz(sos, [f], fs=FS)[1][0]) + 1e-30)
                    assert least <= attenuation <= most, (nominal, f, attenuation)


def test_one_pascal_is_93_98_db():
    t = np.arange(96000) / FS
    tone = np.sqrt(2) * np.sin(2 * np.pi * 1000 * t)
    levels = sound_levels(tone, 1 / FS)
    for got in (levels.l_afmax_db, levels.bands_db[1000.0]):
        assert got == pytest.approx(93.979, abs=0.01)  # 2 s of Fast and the band's own ripple
    assert levels.l_peak_db == pytest.approx(93.979 + 3.010, abs=0.001)  # three decimals
    assert levels.exposure_db[1000.0] == pytest.approx(93.979 + 3.010, abs=0.02)  # 2 s
    assert levels.octaves_db[1000.0] == pytest.approx(93.979, abs=0.01)
    assert levels.l_aeq_db == pytest.approx(93.979, abs=0.01)
    assert levels.l_cpeak_db == pytest.approx(levels.l_peak_db, abs=0.5)  # its onset overshoots
    assert levels.bands_db[500.0] < 93.979 - 35  # its onset is heard everywhere
    assert levels.findings == ()


@pytest.mark.parametrize(("f", "c", "a"), [(31.5, -3.0, -39.4), (63, -0.8, -26.2)])
def test_the_c_weighted_peak_of_a_tone(f, c, a):
    """IEC 61672-1 table 3 for C and A: the peak is 3.01 dB above the mean square, and weighted by C."""
    t = np.arange(48000) / FS
    level = sound_levels(np.sqrt(2) * np.sin(2 * np.pi * f * t) * np.minimum(1, 8 * t), 1 / FS)
    # digits of the table and the onset: 0.03 dB here
    assert level.l_peak_db - level.l_cpeak_db == pytest.approx(-c, abs=0.1)
    assert level.l_aeq_db - level.l_cpeak_db < a - c  # and the mean square by A


def test_a_blow_at_the_end_of_the_record_is_heard_to_its_end():
    """The filters ring on after the record: 0.2 s of silence behind it change nothing."""
    blow = np.concatenate([np.zeros(9000), np.sin(np.pi * np.arange(241) / 240)])
    short, long = (sound_levels(one, 1 / FS) for one in (blow, np.concatenate([blow, np.zeros(9600)])))
    for one, other in ((short.bands_db, long.bands_db), (short.exposure_db, long.exposure_db)):
        # what rings on beyond 0.2 s: 1e-3 dB here
        assert {f: one[f] for f in one if f >= 50} == pytest.approx({f: other[f] for f in one if f >= 50}, abs=0.02)
