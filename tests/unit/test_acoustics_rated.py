"""A room rated from its receivers: against the functions it is made of, done by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acoustics import AcousticsError, Losses, Room, losses_from_t60, rate_room, sound_levels
from acoustics.ratings import A_THIRDS

ROOM = Room([5.0, 4.0, 2.5], losses=losses_from_t60(0.5))  # 50 m^3, .5 s: what levels are standardised to
SILENCE = sound_levels(np.zeros(4800), 1 / 48e3)


def heard(level: float):
    return replace(SILENCE, bands_db=dict.fromkeys(A_THIRDS, level))


def test_the_reference_room_changes_nothing_and_levels_are_averaged_as_energy():
    rated = rate_room([heard(60.0), heard(70.0)], ROOM)
    mean = 10 * np.log10((1e6 + 1e7) / 2)
    assert list(rated.bands_db.values()) == pytest.approx([mean] * 12)
    assert list(rated.spread_db.values()) == pytest.approx([10.0] * 12)
    total = mean + 10 * np.log10(sum(10 ** (a / 10) for a in A_THIRDS.values()))
    assert rated.rating is not None
    assert rated.rating.unrounded_db == pytest.approx(total)
    assert (rated.rating.deciding_hz, rated.rating_spread_db, rated.receivers) == (630.0, pytest.approx(10.0), 2)
    assert rated.quantity == "L'_iA,Fmax,V,T"


def test_half_the_volume_takes_3_db():
    """10 lg(V / 50 m^3): ISO 16283-2 formula 4; the unstandardised levels do not know the volume."""
    small = Room([5.0, 2.0, 2.5], losses=losses_from_t60(0.5))
    assert rate_room([heard(60.0)], small).bands_db[63.0] == pytest.approx(60.0 - 10 * np.log10(2))
    plain = rate_room([heard(60.0)], small, ["ISO 717-2"])
    assert (plain.bands_db[63.0], plain.quantity) == (60.0, "L_iA,Fmax")


def test_a_standard_alone_does_its_own_part():
    alone = rate_room([heard(60.0)], ROOM, ["ISO 16283-2"])
    assert alone.rating is None
    assert alone.rating_spread_db is None


@pytest.mark.parametrize(
    ("levels", "room", "standards", "told"),
    [
        ([], ROOM, ["ISO 717-2"], "no receiver"),
        ([heard(60.0)], ROOM, ["ISO 717-1"], "got ISO 717-1, expected ISO 16283-2 or ISO 717-2"),
        ([heard(60.0)], Room([5, 4, 2.5], losses=Losses()), ["ISO 16283-2"], "room.losses: got none"),
        ([sound_levels(np.zeros(1000), 1e-3)], ROOM, ["ISO 717-2"], "nothing at 500 Hz"),
    ],
)
def test_what_cannot_be_rated_is_refused(levels, room, standards, told):
    with pytest.raises(AcousticsError, match=told):
        rate_room(levels, room, standards)
