"""Harmonic and random excitations as they are asked for."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from typing import Annotated, Any, Final, Literal, NamedTuple

from femstruct.conventions import GRAVITY
from femstruct.dimensions import DIMENSIONS
from femstruct.errors import shown_as
from femstruct.language.not_computed import BASE_IN_TIME, instead_of
from femstruct.language.rooms.room import RoomSpec
from femstruct.language.study.request import spot_of
from femstruct.language.yaml import (
    FREQUENCY,
    Band,
    Duration,
    Here,
    Measured,
    Quantity,
    Spec,
    SurfaceName,
    Text,
    read_by,
    refuse,
)
from femstruct.modal.steady.spectrum import Spectrum
from femstruct.study.steady_vibration import Vibration
from femstruct.units import QuantityError, quantity_of

_G: Final = re.compile(r"\s*([^\sA-Za-z]+(?:[eE][+-]?\d+)?)\s*g(\^2/Hz|²/Hz)?\s*")
_AMPLITUDE: Final = ("force", "moment", "pressure", "acceleration")
_DENSITY: Final = tuple(f"{name} psd" for name in _AMPLITUDE)
_SAMPLES: Final = {True: "0.01 g^2/Hz of a base, 2 N^2/Hz of a force", False: "1 g of a base, 100 N of a force"}
_EXAMPLE: Final = "write it like [[20 Hz, 0.01 g^2/Hz], [500 Hz, 0.01 g^2/Hz]]"


class Level(NamedTuple):
    """A constant value, or a table of frequencies [Hz] and values; dimensions : of these, None for plain numbers."""

    constant: float | None
    points: tuple[tuple[float, float], ...]
    dimensions: tuple[str | None, ...]


def _value(value: object, dimensions: tuple[str, ...]) -> Measured:
    """A quantity; of accelerations g and g^2/Hz too, which mean no gram here."""
    found: Any = _G.fullmatch(value) if isinstance(value, str) else None
    if found is not None and bool(found[2]) == dimensions[0].endswith("psd"):
        number = Quantity(("ratio",)).read(found[1])
        if not number > 0.0:
            raise refuse(shown_as(value), "a value above 0", "remove the sign" if number < 0.0 else "")
        return Measured(number * GRAVITY ** (2 if found[2] else 1), dimensions[-1])
    text = value.replace("(m/s^2)^2", "m^2/s^4").replace("(m/s²)²", "m^2/s^4") if isinstance(value, str) else value
    try:
        quantity_of(text, dimensions)
    except QuantityError as error:
        likely = error.do.startswith("write it like")
        do = f"write it like {_SAMPLES[dimensions[0].endswith('psd')]}" if likely else error.do
        raise refuse(error.got, error.expected, do) from None
    return Quantity(dimensions, above=0.0, which=True).read(text)  # type: ignore[no-any-return]


def _level(dimensions: tuple[str, ...]) -> Any:
    """Reader of a value, or of a list of pairs of frequency and value."""

    def read(value: object) -> object:
        if not isinstance(value, list):
            one = _value(value, dimensions)
            return Level(one.value, (), (one.dimension,))
        pairs = [pair for pair in value if isinstance(pair, list) and len(pair) == 2]
        if len(pairs) < max(2, len(value)):
            raise refuse(shown_as(value), "a value, or two or more pairs [frequency, value]", _EXAMPLE)
        points = [(FREQUENCY.read(frequency), _value(one, dimensions)) for frequency, one in pairs]
        return Level(None, tuple((f, one.value) for f, one in points), tuple(one.dimension for _, one in points))

    return read


_WRITTEN: Final = str | float | list[tuple[str | float, str | float]]


class VibrationSpec(Spec):
    """A steady excitation, harmonic or random, of the structure by itself: a force at POINT.z, a uniform pressure on a
    surface, or the acceleration of its base, with which all moves that stands on the ground. harmonic is an
    amplitude, psd a one-sided power spectral density (g^2/Hz of a base); a value in a band, or pairs [frequency, value]
    with straight lines between them in double logarithmic paper. What is recorded answers."""

    makes = Vibration
    instead = instead_of(BASE_IN_TIME, "file", "half_sine", "history", "time")
    one_of = (("at", "on", "base"), ("harmonic", "psd"))
    needs = (("duration", ("psd",)),)

    at: Text | None = None
    on: SurfaceName | None = None
    base: Literal["x", "y", "z"] | None = None
    harmonic: Annotated[Level, read_by(_level(_AMPLITUDE), _WRITTEN)] | None = None
    psd: Annotated[Level, read_by(_level(_DENSITY), _WRITTEN)] | None = None
    band: Band | None = None
    duration: Duration | None = None

    @property
    def level(self) -> tuple[Literal["harmonic", "psd"], Level]:
        """What is given, and how much."""
        if self.psd is not None:
            return "psd", self.psd
        assert self.harmonic is not None  # one of both is given
        return "harmonic", self.harmonic

    @property
    def points(self) -> tuple[tuple[float, float], ...]:
        """Frequencies [Hz] and values of its spectrum."""
        constant, points, _ = self.level[1]
        return points if constant is None or self.band is None else tuple((f, constant) for f in self.band)

    def check_in(self, here: Here, records: Mapping[str, Collection[str]], rooms: Mapping[str, RoomSpec]) -> None:
        """Note what is wrong with its place, its dimensions and its band, or that nothing can answer."""
        what, level = self.level
        if self.at is not None:
            here.at("at").spot(self.at)
        there = here.at(what)
        right = self._dimension + (" psd" if what == "psd" else "")
        named = DIMENSIONS[right]
        example = "0.01 g^2/Hz" if right == "acceleration psd" else named.example
        for got in dict.fromkeys(level.dimensions):
            expected, words = f"{named.words} [{named.unit}]", DIMENSIONS[got or right].words
            there.need(got in (None, right), words, expected, f"write it like {example}")
        if level.constant is None:
            here.at("band").need(self.band is None, "a band beside pairs of frequency and value", "one of both")
            there.make(lambda: Spectrum(level.points))
        elif here.need(self.band, "no band", "from where to where", "add 'band: [20 Hz, 500 Hz]'") and self.band:
            low, high = self.band
            here.at("band").need(0.0 < low < high, f"{low:g} to {high:g} Hz", "a rising band above 0 Hz")
        coupled = [name for name, room in rooms.items() if getattr(room, "coupling", "") == "two-way"]
        if self.base is not None and coupled:
            here.at("base").wrong(
                f"a base that moves beside the air of '{coupled[0]}', which reacts on the structure",
                "a force, a pressure, or coupling: one-way",
            )
        answers = {"displacement", "velocity", "acceleration", "force", "stress"}
        asked = any(answers & set(wanted) for wanted in records.values())
        here.need(asked, "nothing that is recorded", "what answers", "add 'record: {POINT.z: acceleration}'")

    @property
    def _dimension(self) -> str:
        """Of an amplitude."""
        turning = (self.at or "").rpartition(".")[2].startswith("r")
        return "acceleration" if self.base else "pressure" if self.on else "moment" if turning else "force"

    def given(self) -> dict[str, Any]:
        kind = "base" if self.base is not None else "surface" if self.on is not None else "point"
        on = spot_of(self.at) if self.at is not None else self.base or self.on
        what, spectrum = self.level[0], Spectrum(self.points)
        return {"on": on, "kind": kind, "what": what, "spectrum": spectrum, "duration": self.duration}
