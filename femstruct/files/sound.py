"""Pressures and levels in the results file."""

from __future__ import annotations

import json
from math import isfinite

import h5py
import numpy as np

from acoustics.levels import REFERENCE_PA, Levels
from acoustics.pressure import RoomResponse
from acoustics.rated import RatedRoom
from femstruct.files.hdf5 import axis, put


def write_room(target: h5py.Group, response: RoomResponse) -> None:
    """Pressure histories and spectra at the receivers of one room."""
    time = axis(target, "time", response.t, "s", "Time since the start")
    frequency = axis(target, "frequency_hz", response.frequency_hz, "Hz", "Frequency")
    receiver = axis(target, "receiver", [item.name for item in response.receivers], "1", "Receiver")
    direction = axis(target, "direction", ["x", "y", "z"], "1", "Axis of the room, from its lower corner")
    places = np.array([item.position for item in response.receivers])
    put(target, "position", places, "m", "Where the receivers are", (receiver, direction))
    put(target, "pressure", response.p, "Pa", "Pressure, positive when compressed", (receiver, time))
    put(target, "spectrum", response.spectrum, "Pa/Hz", "dt rfft(pressure), no window", (receiver, frequency))


def write_levels(target: h5py.Group, levels: Levels) -> None:
    """Band levels and single numbers at one receiver."""
    reference = f"dB re {levels.reference_pa:g} Pa"
    target.attrs.update(
        peak_pa=levels.peak_pa,
        **levels.single_numbers,
        reference_pa=levels.reference_pa,
        findings=json.dumps([[advice.code, advice.message] for advice in levels.findings]),
    )
    band = axis(target, "band_hz", list(levels.bands_db), "Hz", "Nominal centre of the third octave")
    put(target, "l_fmax", list(levels.bands_db.values()), reference, "Largest Fast level in the band", (band,))
    octave = axis(target, "octave_hz", list(levels.octaves_db), "Hz", "Nominal centre of the octave")
    put(target, "octave_l_fmax", list(levels.octaves_db.values()), reference, "Largest Fast level in it", (octave,))
    put(target, "sel", list(levels.exposure_db.values()), reference, "Sound exposure level of the band", (band,))


def write_rated(target: h5py.Group, rated: RatedRoom) -> None:
    """A room as the standards state it."""
    target.attrs.update(
        standards=", ".join(rated.standards),
        quantity=rated.quantity,
        band_quantity=rated.band_quantity,
        receivers=rated.receivers,
    )
    if rated.rating is not None and rated.rating_spread_db is not None:
        target.attrs.update(
            rating_db=rated.rating.rating_db,
            unrounded_db=rated.rating.unrounded_db,
            deciding_hz=rated.rating.deciding_hz,
            rating_spread_db=rated.rating_spread_db,
        )
    band = axis(target, "band_hz", list(rated.bands_db), "Hz", "Nominal centre of the third octave")
    averaged = f"{rated.band_quantity}, energy average over the receivers"
    put(target, "level", list(rated.bands_db.values()), f"dB re {REFERENCE_PA:g} Pa", averaged, (band,))
    put(target, "spread", list(rated.spread_db.values()), "dB", "Largest less smallest of the receivers", (band,))
    times = [time if isfinite(time) else np.nan for time in rated.t60_s.values()]
    put(target, "t60", times, "s", "Reverberation time of the room; nan without losses", (band,))
