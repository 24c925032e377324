"""Pressures and levels in the results file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from acoustics.levels.ensemble import Interval
from acoustics.levels.rated import RatedRoom
from acoustics.room_response import RoomResponse
from femstruct.files.results_file.datasets import axis, group, put
from femstruct.files.tables.described import write_described, write_rows

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py


def write_room(target: h5py.Group, response: RoomResponse) -> None:
    """Pressure histories and spectra at the receivers of one room."""
    time = axis(target, "time", response.t, "s", "Time since the start")
    frequency = axis(target, "frequency_hz", response.frequency_hz, "Hz", "Frequency")
    receiver = axis(target, "receiver", [item.name for item in response.receivers], "1", "Receiver")
    direction = axis(target, "direction", ["x", "y", "z"], "1", "Axis of the room, from its lower corner")
    places = np.array([item.position for item in response.receivers])
    put(target, "position", places, "m", "Where the receivers are", (receiver, direction))
    target.attrs["complete_below_hz"] = response.complete_below_hz  # the sound ends there
    put(target, "pressure", response.p, "Pa", "Pressure, positive when compressed", (receiver, time))
    put(target, "spectrum", response.spectrum, "Pa/Hz", "dt rfft(pressure), no window", (receiver, frequency))


def write_own(target: h5py.Group, own: RoomResponse, total: RoomResponse) -> None:
    """Beside the pressure that the structure radiates, that of the striking bodies themselves, and the sum."""
    both = ("receiver", "time")
    put(target, "own_pressure", own.p, "Pa", "Pressure that the striking bodies make themselves", both)
    put(target, "total_pressure", total.p, "Pa", "Sum of pressure and own_pressure", both)


def write_rated(target: h5py.Group, rated: RatedRoom) -> None:
    """A room as the standards state it, with the levels of every drop at every receiver that it is made of."""
    write_described(target, rated.method)
    if rated.numbers:
        symbol = axis(target, "symbol", list(rated.numbers), "1", "Single number, the first the one to state")
        write_rows(target, list(rated.numbers.values()), symbol)
        for name, spreads in (("drops", rated.drops_spread_db), ("receivers", rated.receivers_spread_db)):
            told = f"Standard deviation of the number over {name}; nan for one"
            put(target, f"{name}_spread_db", list(spreads.values()), "dB", told, (symbol,))
        blank = Interval(np.nan, np.nan, np.nan)
        own = np.array([rated.number_intervals.get(one, blank) for one in rated.numbers])
        for column, word in enumerate(("mean", "lower end of the 90 % interval", "upper end of it")):
            name, told = f"number_{('mean', 'low', 'high')[column]}_db", f"Number over rooms and places: {word}"
            put(target, name, own[:, column], "dB", told, (symbol,))
    axis(target, "band_hz", list(rated.bands_hz), "Hz", f"Nominal centre of the {rated.method.bands}")
    axis(target, "drop", np.arange(1, rated.drops + 1), "1", "Place of the source, in the order of the study")
    axis(target, "receiver", np.arange(1, rated.receivers + 1), "1", "Receiver, in the order of the room")
    write_described(target, rated)
    if rated.ensemble is not None:
        beside = group(target, "ensemble", "Low bands over rooms of nearly one size and places")
        axis(beside, "band_hz", list(rated.bands_hz), "Hz", f"Nominal centre of the {rated.method.bands}")
        axis(beside, "member", np.arange(1, len(rated.ensemble.members_db) + 1), "1", "Number of the member")
        write_described(beside, rated.ensemble)
    if rated.statistical is not None:
        beside = group(target, "statistical_bands", "The same bands by statistical energies of plate and room")
        axis(beside, "band_hz", list(rated.bands_hz), "Hz", f"Nominal centre of the {rated.method.bands}")
        write_described(beside, rated.statistical)
        if rated.agreement is not None:
            write_described(beside, rated.agreement)
