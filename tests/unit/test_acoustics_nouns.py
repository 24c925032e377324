"""What the acoustic wing refuses, advises and keeps."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from acoustics.air import Air
from acoustics.errors import AcousticsError
from acoustics.fields.rectangular import Room
from acoustics.fields.sound_field import air_stiffness_ratio
from acoustics.levels.bands import third_octave_bands
from acoustics.levels.sound_levels import level_spectrum, sound_levels
from acoustics.losses import Losses, losses_from_beta, losses_from_loss_factor, losses_from_t60, modal_damping_ratio
from acoustics.receivers import Receiver
from acoustics.room_response import RoomResponse
from acoustics.rooms.box import band_orders
from acoustics.rooms.box_harmonic import pressure_map
from acoustics.rooms.box_pressure import pressure
from acoustics.rooms.room_advice import third_octave_missed_db
from acoustics.source import SurfaceVelocity

ROUNDING = 1e-12  # rounding: 3e-15 here at most

BOX = Room([0.58, 0.47, 0.1], Air(340, 1.29), losses_from_beta(0.0116, 293))
MIC = Receiver("mic", [0.2, 0.3, 0.05])


def surface(z=0.1, weight=0.2726 / 144, rates=None, shape=None, dt=1 / 24e3):
    x, y = (np.arange(12) + 0.5) / 12 * 0.58, (np.arange(12) + 0.5) / 12 * 0.47
    grid = np.array([[a, b, z] for a in x for b in y])
    t = np.arange(2400) * dt
    if rates is None:
        rates = np.exp(-(((t - 0.02) / 2e-3) ** 2))
    return SurfaceVelocity(
        grid, np.full(144, weight), np.ones((144, 1)) if shape is None else shape(grid), np.atleast_2d(rates), dt
    )


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Air(c=-1), "air.c: got -1 m/s, expected a positive"),
        (lambda: Room([1, 2], Air()), r"room.size: got shape \(2,\), expected shape \(3,\)"),
        (lambda: Room([1, 2, 0], Air()), "room.size: got .* expected positive"),
        (lambda: Losses("magic"), "losses.kind: got 'magic', expected one of none, kelvin_voigt"),
        (lambda: Losses("kelvin_voigt"), "losses.relaxation_time: got 0, expected a positive"),
        (lambda: Losses("none", beta=0.1), "losses.beta: got 0.1, expected nothing with kind none; leave it out"),
        (lambda: Losses("source", beta=1.16), "losses.beta: got 1.16, expected less than 1"),
        (lambda: losses_from_beta(0.01, 293, "anti"), "losses.form: got 'anti', expected causal or source"),
        (lambda: losses_from_t60(0), "losses.t60"),
        (lambda: surface(weight=-1), "surface.weights: got -1 m"),
        (lambda: surface(rates=np.full(9, np.nan)), "surface.rates: got nan or infinity"),
        (lambda: pressure(surface(z=0.11), BOX, [MIC]), "surface.points: got z = 0.11 m, expected the ceiling"),
        (lambda: pressure(surface(weight=0.01), BOX, [MIC]), "surface.weights: got a sum of 1.44"),
        (lambda: pressure(surface(), BOX, []), "receivers: got none"),
        (lambda: pressure(surface(), BOX, [MIC], orders=0), "orders: got 0"),
        (lambda: pressure(surface(), BOX, [Receiver("far", [0.1, 0.1, 0.2])]), "receiver far: got .* lower corner"),
        (lambda: pressure_map(surface(), BOX, [0.0], at=0.05), "map.frequency: got 0 Hz"),
        (lambda: pressure_map(surface(), BOX, [50.0], normal="n", at=0.05), "map.normal: got 'n'"),
        (lambda: pressure_map(surface(), BOX, [50.0], at=0.5), "map.at: got"),
        (lambda: sound_levels(np.zeros((2, 3)), 1e-3), r"p: got shape \(2, 3\)"),
    ],
)
def test_refusals(make, message):
    with pytest.raises(AcousticsError, match=message):
        make()


def test_losses_are_what_they_say():
    assert losses_from_loss_factor(0.0232, 293).relaxation_time == losses_from_beta(0.0116, 293).relaxation_time
    for f, kelvin_voigt in ((19.9, 0.0116 * 19.9 / 293), (293, 0.0116), (1700, 0.0116 * 1700 / 293)):
        assert modal_damping_ratio(losses_from_beta(0.0116, 293), f) == pytest.approx(kelvin_voigt, rel=ROUNDING)
        assert modal_damping_ratio(losses_from_beta(0.0116, 293, "source"), f) == 0.0116
        # 60 dB in T60: exp(-zeta omega T60) = 1e-3
        decay = np.exp(-modal_damping_ratio(losses_from_t60(0.7), f) * 2 * np.pi * f * 0.7)
        assert decay == pytest.approx(1e-3, rel=ROUNDING)


def test_air_stiffness_of_the_box():
    air = air_stiffness_ratio(BOX, BOX.ceiling_area, 1.0)
    assert air == pytest.approx(4.065e5, rel=1e-4)  # rho c^2 S^2 / V in N/m, to the digits given
    ratio = air_stiffness_ratio(BOX, BOX.ceiling_area, 4.641e5)
    assert 19.9 * np.sqrt(1 + ratio) == pytest.approx(27.253, abs=0.01)  # the coupled heave, to the digits given


def test_arrays_are_read_only_and_not_the_callers():
    mine = np.array([0.58, 0.47, 0.1])
    room = Room(mine)
    mine[0] = 9
    assert room.size[0] == 0.58
    with pytest.raises(ValueError, match="read-only"):
        pressure(surface(), BOX, [MIC], orders=2).p[0, 0] = 1


def test_parseval():
    heard = pressure(surface(), BOX, [MIC], orders=2)
    df = heard.frequency_hz[1]
    twice = np.full(len(heard.frequency_hz), 2.0)
    twice[[0, -1]] = 1
    in_time = (heard.p[0] ** 2).sum() * heard.dt
    assert (twice * np.abs(heard.spectrum[0]) ** 2).sum() * df == pytest.approx(in_time, rel=ROUNDING)
    for n in (2400, 2399):
        _, lines = level_spectrum(heard.p[0, :n], heard.dt)
        mean_square = (heard.p[0, :n] ** 2).mean()
        assert (10 ** (lines / 10)).sum() * 20e-6**2 == pytest.approx(mean_square, rel=ROUNDING)


def test_map_agrees_with_the_record_that_has_decayed():
    rates = np.gradient(np.exp(-(((np.arange(19200) / 24e3 - 0.03) / 3e-3) ** 2)))
    tilt = surface(rates=rates, shape=lambda grid: grid[:, :1] - 0.1)
    heard = pressure(tilt, BOX, [Receiver("a", [0.29, 0.235, 0.05]), Receiver("b", [0.58, 0, 0.1])], orders=12)
    for normal, at, pick in (("z", 0.05, (2, 2, 0)), ("y", 0.235, (2, 2, 0)), ("x", 0.58, (0, 4, 1))):
        field = pressure_map(tilt, BOX, [100.0, 350.0], normal=normal, at=at, divisions=(4, 4), orders=12)
        i, j, receiver = pick
        bins = [80, 280]  # 0.8 s: 1.25 Hz apart
        # the record's last sample is 1e-6 of its peak (box modes decay by exp(-21 x 0.77 s))
        np.testing.assert_allclose(
            field.spectrum[:, i, j], heard.spectrum[receiver, bins], atol=1e-5 * np.abs(heard.spectrum).max()
        )


def test_superposition_over_heights_and_numbers_of_receivers():
    """Few receivers are summed before the inverse transform, many after it: the same pressures."""
    tilt = surface(shape=lambda grid: grid[:, :1] ** 2)
    many = [Receiver(str(i), [0.02 * i, 0.3, 0.05]) for i in range(28)] + [Receiver("low", [0.1, 0.2, 0.01])]
    together = pressure(tilt, BOX, many, orders=4).p
    for i in (3, 28):
        # rounding: 2e-12 here
        np.testing.assert_allclose(pressure(tilt, BOX, [many[i]], orders=4).p[0], together[i], atol=1e-9)


def test_orders_are_added_until_they_do_not_matter():
    tilt = surface(shape=lambda grid: np.exp(-((grid[:, :1] - 0.2) ** 2 + (grid[:, 1:2] - 0.2) ** 2) / 0.02))
    chosen, many = (pressure(tilt, BOX, [MIC], orders=n).p[0] for n in (None, 12))
    assert np.abs(chosen - many).max() < 1e-4 * np.abs(many).max()  # where the search ends: ENOUGH
    codes = {finding.code for finding in pressure(tilt, BOX, [Receiver("at", [0.2, 0.2, 0.1])], orders=4).findings}
    assert "orders-truncated" in codes


@pytest.mark.parametrize(("highest_hz", "orders"), [(100.0, (4, 4)), (300.0, (5, 4)), (2000.0, (10, 9))])
def test_orders_of_a_band_are_those_that_propagate_and_three_more(highest_hz, orders):
    """Cosine l propagates above l c / (2 L): across 0.58 m from 0, 293, 586 .. Hz, across 0.47 m from 0, 362, 723 .."""
    assert band_orders(BOX, highest_hz) == orders


def test_advice_on_the_record():
    t = np.arange(2400) / 24e3
    codes = {a.code for a in pressure(surface(rates=np.cos(2 * np.pi * 4000 * t)), BOX, [MIC], orders=2).findings}
    assert {"surface-starts-moving", "surface-not-decayed", "surface-coarsely-sampled"} <= codes
    assert pressure(surface(), BOX, [MIC], orders=2).findings == ()
    codes = {a.code for a in pressure(surface(shape=lambda g: g[:, :1]), BOX, [MIC], orders=13).findings}
    assert "ceiling-points-coarse" in codes
    short = sound_levels(np.sin(2 * np.pi * 100 * t), 1 / 24e3)
    assert [a.code for a in short.findings] == ["band-not-settled"]


def test_sampling_is_called_low_before_levels_miss_anything_that_is_told():
    """A push that begins with a kink, as impacts do, with 82, 13 and 2 samples in a period of its highest frequency."""
    fine, tau = 1 / 96e3, 1e-2
    since = np.maximum(np.arange(28800) * fine - 0.02, 0) / tau
    rates = since * np.exp(1 - since)
    found = []
    for every in (1, 6, 64):
        heard = pressure(surface(rates=rates[::every], dt=every * fine), BOX, [MIC], orders=2)
        low = [finding for finding in heard.findings if finding.code == "surface-coarsely-sampled"]
        found.append((heard.p[0], low, sound_levels(heard.p[0], every * fine)))
    (truth, no, whole), (enough, none, near), (few, told, far) = found
    assert not no and not none and len(told) == 1
    peak = np.abs(truth).max()
    missed = [np.abs(p - truth[::every]).max() / peak for p, every in ((enough, 6), (few, 64))]
    assert missed[0] < 2e-3 and missed[1] > 10.0 * missed[0]
    assert abs(near.l_afmax_db - whole.l_afmax_db) < 0.02
    assert abs(far.l_afmax_db - whole.l_afmax_db) > 0.02
    assert told[0].values["sampling_hz"] == pytest.approx(1500.0)
    assert 2.0 <= 1500.0 / told[0].values["source_highest_hz"] < 10.0


@pytest.mark.parametrize(("samples", "missed_db"), [(2.0, 2.0), (5.477, 0.1), (7.5, 0.05), (60.0, 0.001)])
def test_what_sampling_misses_is_read_from_the_measured_table(samples, missed_db):
    # between 4 and 7.5 samples a power: sqrt(4 * 7.5) samples miss sqrt(0.2 * 0.05) dB, its digits given
    assert third_octave_missed_db(samples) == pytest.approx(missed_db, rel=1e-3)


def test_a_still_surface_is_silent():
    heard = pressure(surface(rates=np.zeros(200)), BOX, [MIC])
    assert not heard.p.any()
    assert np.isnan(sound_levels(heard.p[0], heard.dt).l_peak_db)  # the level of nothing is no number


def test_bands_end_where_the_sampling_does():
    assert list(third_octave_bands(8000))[-1] == 3150
    assert next(iter(third_octave_bands(48000))) == 25
    assert len(third_octave_bands(48000)) == 30


def test_a_response_knows_its_shapes():
    with pytest.raises(AcousticsError, match=r"response.p: got shape \(2, 4\), expected shape \(1, 4\)"):
        RoomResponse((MIC,), np.arange(4.0), np.zeros((2, 4)))


def test_importing_the_wing_fetches_no_filters_and_no_femstruct():
    code = "import sys, acoustics; print([m for m in ('scipy', 'femstruct', 'h5py', 'matplotlib') if m in sys.modules])"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert told.strip() == "[]"
    code = "import acoustics; assert callable(acoustics.pressure) and callable(acoustics.sound_levels)"
    subprocess.run([sys.executable, "-c", code], check=True)
