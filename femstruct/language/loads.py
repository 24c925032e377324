"""Measured structure-borne sources as they are written."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from typing import Annotated, Any, Final, Literal, NamedTuple

from pydantic import Field, ValidationInfo, model_validator

from femstruct.conventions import GRAVITY
from femstruct.declared import Refers
from femstruct.errors import FemstructError, InputError, quote_value
from femstruct.files.columns import read_columns, read_footstep, read_history
from femstruct.files.text_tables import Head, beside, scale_of
from femstruct.impact.scene import PACES_HZ, HalfSine, Walk, design_harmonics
from femstruct.language.not_computed import BASE_IN_TIME, GROUND, instead_of
from femstruct.language.requests import parse_spot
from femstruct.language.rooms import RoomSpec
from femstruct.modal.installed_sources import BandMobility, ForceSource, MeasuredMobility, RigidMass, SourceMobility
from femstruct.modal.steady import BandSpectrum, Spectrum
from femstruct.quantities import (
    FREQUENCY,
    Band,
    Duration,
    Frequency,
    Instant,
    MassKg,
    Measured,
    Quantity,
    Ratio,
    refuse,
)
from femstruct.study.acting import MeasuredSource, PlannedLoad, PlannedWalk, Repeat
from femstruct.study.asked import Vibration
from femstruct.units import DIMENSIONS, QuantityError, quantity_of
from femstruct.yaml.reader import Here
from femstruct.yaml.spec import (
    BandFile,
    Count,
    PointName,
    Spec,
    SurfaceName,
    Text,
    band_file,
    each_band,
    made_of_file,
    read_by,
    several,
)

INFINITE: Final = "infinite"
_LEVEL: Final = re.compile(r"\s*([+-]?[\d.]+)\s*(dB\b.*)")
_BANDS: Final = "write it like {50 Hz: 1.2 N, 63 Hz: 0.8 N}, {file: NAME} or {psd: [[20 Hz, 1 N^2/Hz], ..]}"
Bands = tuple[tuple[float, float], ...]


def _amplitude(value: object, dimension: str) -> float:
    """A quantity that is not negative, or a level over its reference: 80 dB re 1e-6 N."""
    level = _LEVEL.fullmatch(value) if isinstance(value, str) else None
    if level is None:
        return float(Quantity((dimension,), least=0.0).read(value))
    try:
        return scale_of(Head("", level[2], str(value)), dimension)(float(level[1]))
    except InputError as error:
        raise refuse(error.got, error.expected, error.do) from None


def _by_band(value: dict[str, Any], dimension: str, info: ValidationInfo) -> Bands:
    """Values by band, rising, of a mapping or of a file."""
    if "file" in value:
        found = band_file(value, Quantity((dimension,), least=0.0), info)
    else:
        found = each_band(value, lambda one: _amplitude(one, dimension))
    return tuple(sorted(found.items()))


def _spectra(dimension: str) -> Callable[[object, ValidationInfo], object]:
    """Reader of one spectrum, or of one for each contact: values by band, or a power spectral density."""

    def one(value: object, info: ValidationInfo) -> Bands | Spectrum:
        if not isinstance(value, dict) or not value:
            raise refuse(quote_value(value), "values by band, or a power spectral density", _BANDS)
        if "psd" not in value:
            return _by_band(value, dimension, info)
        psd = value["psd"]
        if len(value) > 1 or not isinstance(psd, dict | list):
            raise refuse(quote_value(value), "'psd' with pairs [frequency, value] or {file: NAME}", _BANDS)
        named = f"{dimension} psd"
        if isinstance(psd, dict):
            return made_of_file(
                psd, info, lambda path, sources: read_columns(path, ("frequency", named), sources, _lines)
            )
        if any(not isinstance(pair, list) or len(pair) != 2 for pair in psd):
            raise refuse(quote_value(psd), "pairs [frequency, value]", _BANDS)
        try:
            return Spectrum(tuple((FREQUENCY.read(f), Quantity((named,), above=0.0).read(v)) for f, v in psd))
        except FemstructError as error:
            raise refuse(error.got, error.expected, error.do) from None

    def read(value: object, info: ValidationInfo) -> object:
        return tuple(one(part, info) for part in (value if isinstance(value, list) and value else [value]))

    return read


def _lines(frequency_hz: Any, values: Any) -> Spectrum:
    return Spectrum(tuple(zip(frequency_hz, values, strict=True)))


def _mobility(dimension: str) -> Callable[[object, ValidationInfo], object]:
    """Reader of magnitudes by frequency, of lines with real and imaginary part in a file, or of the word infinite."""

    def read(value: object, info: ValidationInfo) -> object:
        inverse = dimension == "damping"  # an impedance has the dimension of a dashpot
        if value == INFINITE and not inverse:
            return ForceSource()
        if not isinstance(value, dict) or not value:
            do = "write it like {50 Hz: 1e-4 m/s/N, 63 Hz: ..}, {file: NAME}, {lines: NAME}"
            raise refuse(quote_value(value), "values by band, or lines with their phase", do)
        try:
            if "lines" in value:
                found = {"file": value["lines"], **{key: one for key, one in value.items() if key != "lines"}}
                columns = ("frequency", dimension, dimension)
                return made_of_file(
                    found, info, lambda path, sources: read_columns(path, columns, sources, _complex(inverse))
                )
            known = _by_band(value, dimension, info)
            return BandMobility(tuple((f, 1.0 / one if inverse and one else one) for f, one in known))
        except InputError as error:
            raise refuse(error.got, error.expected, error.do) from None

    return read


def _complex(inverse: bool) -> Callable[[Any, Any, Any], MeasuredMobility]:
    def made(frequency_hz: Any, real: Any, imaginary: Any) -> MeasuredMobility:
        values = [complex(*pair) for pair in zip(real, imaginary, strict=True)]
        if inverse:
            values = [1.0 / one if one else 0j for one in values]
        return MeasuredMobility(tuple((f, v.real, v.imag) for f, v in zip(frequency_hz, values, strict=True)))

    return made


_Table = dict[str, Text | float] | list[dict[str, Text | float]]


class MeasuredSourceSpec(Spec):
    """A machine as it was measured by itself (EN 15657): blocked force, or free velocity, at its contacts, and its
    mobility there. Values are rms in bands, {50 Hz: 1.2 N, ..} or {file: NAME}, levels with their reference, or {psd:
    [[20 Hz, 1 N^2/Hz], ..]}; one for all contacts, or a list.

    at: POINT.direction, or a list; every place of a point is a contact. mobility or impedance: magnitudes by band, or
    {lines: FILE} of frequency, real and imaginary part; mass: of a rigid source at each contact; mobility: infinite of
    one that gives way to everything.
    """

    makes = MeasuredSource
    one_of = (("blocked_force", "free_velocity"), ("mobility", "impedance", "mass"))

    at: Annotated[tuple[Text, ...], read_by(several(lambda one: one), Text | list[Text])]
    blocked_force: Annotated[tuple[Any, ...] | None, read_by(_spectra("force"), BandFile | _Table)] = None
    free_velocity: Annotated[tuple[Any, ...] | None, read_by(_spectra("speed"), BandFile | _Table)] = None
    bands: Literal["third octave", "octave"] = "third octave"
    mobility: Annotated[
        SourceMobility | None, read_by(_mobility("mobility"), Literal["infinite"] | BandFile | _Table)
    ] = None
    impedance: Annotated[SourceMobility | None, read_by(_mobility("damping"), BandFile | _Table)] = None
    mass: MassKg | None = None

    def check_in(self, here: Here) -> None:
        """Note what is wrong with its contacts."""
        for number, text in enumerate(self.at):
            there = here.at("at") if len(self.at) == 1 else here.at("at", number)
            name, _, what = text.rpartition(".")
            count = here.names.points.get(name, 1)
            there.spot(f"{name}.1.{what}" if count > 1 else text)
            there.need(
                what not in ("rx", "ry", "rz"), f"'{text}', a rotation", "a direction x, y, z or n", "forces only"
            )

    def given(self) -> dict[str, Any]:
        fraction: Literal[1, 3] = 3 if self.bands == "third octave" else 1
        force = self.blocked_force is not None
        spectra = self.blocked_force if self.blocked_force is not None else self.free_velocity or ()
        mobility = RigidMass(self.mass) if self.mass is not None else self.mobility or self.impedance
        return {
            "at": tuple(parse_spot(text) for text in self.at),
            "what": "blocked force" if force else "free velocity",
            "spectra": tuple(one if isinstance(one, Spectrum) else BandSpectrum(one, fraction) for one in spectra),
            "mobility": mobility,
        }


# ----------------------------------------------------------------------------------------------------------------------
# Loads as they are written: histories of forces and pressures, and walking persons.
# ----------------------------------------------------------------------------------------------------------------------


class HalfSineSpec(Spec):
    """The first half period of a sine."""

    makes = HalfSine
    amplitude: Annotated[Measured, Quantity(("force", "pressure"), which=True)]
    frequency: Frequency

    def given(self) -> dict[str, Any]:
        return {**super().given(), "amplitude": self.amplitude.value}


class WalkingSpec(Spec):
    """A walking person: mass, steps per second, number of steps, and amplitudes of the harmonics of the force over the
    weight, by default those of CCIP-016 for this pace."""

    makes = Walk
    mass: MassKg
    pace: Frequency
    steps: Count
    harmonics: Annotated[list[Ratio], Field(min_length=1, max_length=20)] | None = None

    @model_validator(mode="after")
    def _known_pace(self) -> WalkingSpec:
        low, high = PACES_HZ
        if self.harmonics is None and not low <= self.pace <= high:
            raise refuse(f"a pace of {self.pace:g} Hz", f"{low:g} to {high:g} Hz", "or give its 'harmonics: [..]'")
        if self.steps < 2:
            raise refuse("1 step", "2 or more: the force increases over the first and decreases over the last")
        return self

    def given(self) -> dict[str, Any]:
        harmonics = design_harmonics(self.pace) if self.harmonics is None else tuple(self.harmonics)
        return {**super().given(), "harmonics": harmonics}


class LoadSpec(Spec):
    """A force history on a point's direction or a body, or a pressure history on a surface; once or repeated. Or a
    person who walks along places. A force is positive along its direction: downwards it is negative. A file has two
    columns, time and value; what comes before t = 0 is left out. footstep: a file of the force of a foot, recorded with
    a stiff force plate, positive downwards, at POINT.z."""

    one_of = (("at", "body", "on", "along"), ("half_sine", "file", "walking", "footstep"))
    instead = instead_of(BASE_IN_TIME, "base", "acceleration", "displacement", "velocity")
    only_with = (("along", ("walking",)), ("walking", ("along",)), ("footstep", ("at",)))

    at: Text | None = None
    along: Annotated[tuple[PointName, ...] | None, read_by(several(lambda one: one), Text | list[Text])] = None
    walking: WalkingSpec | None = None
    body: Annotated[Text, Refers(goes_with="bodies")] | None = None
    on: SurfaceName | None = None
    half_sine: HalfSineSpec | None = None
    file: Text | None = None
    footstep: Text | None = None
    first: Instant = 0.0
    every: Duration | None = None
    count: Count | None = None

    @property
    def kind(self) -> Any:
        """What it acts on."""
        return "point" if self.at is not None else "body" if self.body is not None else "surface"

    def check_in(self, here: Here, bodies: Collection[str]) -> None:
        """Note what is wrong with it.

        Parameters
        ----------
        bodies : Collection[str]
            Names of all, those of arrays too.
        """
        if self.at is not None:
            if here.at("at").need(
                not self.at.startswith(GROUND), f"'{self.at}'", "a direction of a point", BASE_IN_TIME
            ):
                here.at("at").spot(self.at)
            vertical = self.footstep is None or self.at.endswith(".z")
            here.at("at").need(vertical, f"a footstep along '{self.at}'", "POINT.z: feet press downwards")
        if self.body is not None and self.body not in bodies:
            here.at("body").known(self.body, "body", bodies)
        given, missing = ("count", "every") if self.every is None else ("every", "count")
        here.at(given).need(
            (self.count is None) == (self.every is None),
            f"'{given}' without '{missing}'",
            "both or none",
            f"add '{missing}: ...'",
        )
        if self.half_sine is not None:
            right, got = "pressure" if self.on is not None else "force", self.half_sine.amplitude.dimension
            here.at("half_sine", "amplitude").need(
                got in (None, right), f"a {got}", f"a {right}", "surfaces take Pa, points N"
            )

    def build(self, here: Here, name: str, sources: dict[str, str]) -> PlannedLoad | PlannedWalk | None:
        """The load it describes; None with a mistake noted.

        Parameters
        ----------
        sources : dict[str, str]
            Is given the text of its file, by its name.
        """
        repeat = Repeat(self.count or 1, self.every or 0.0, self.first)
        if self.walking is not None:
            return PlannedWalk(name, self.along or (), self.walking.noun(), repeat)
        on = parse_spot(self.at) if self.at is not None else self.body or self.on or ""
        if self.half_sine is not None:
            return PlannedLoad(name, on, self.kind, self.half_sine.noun(), repeat)
        if self.footstep is not None:
            step = self.footstep
            record = here.at("footstep").make(lambda: read_footstep(beside(here.tree.file, step), sources))
            return None if record is None else PlannedLoad(name, on, "point", record, repeat, footstep=True)
        what, file = "pressure" if self.on is not None else "force", self.file or ""
        history = here.at("file").make(lambda: read_history(beside(here.tree.file, file), what, sources))
        return None if history is None else PlannedLoad(name, on, self.kind, history, repeat)


# ----------------------------------------------------------------------------------------------------------------------
# Harmonic and random excitations as they are asked for.
# ----------------------------------------------------------------------------------------------------------------------

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
            raise refuse(quote_value(value), "a value above 0", "remove the sign" if number < 0.0 else "")
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
            raise refuse(quote_value(value), "a value, or two or more pairs [frequency, value]", _EXAMPLE)
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
    only_with = (("duration", ("psd",)),)

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
        is_recorded = any(answers & set(quantities) for quantities in records.values())
        here.need(is_recorded, "nothing that is recorded", "what answers", "add 'record: {POINT.z: acceleration}'")

    @property
    def _dimension(self) -> str:
        """Of an amplitude."""
        turning = (self.at or "").rpartition(".")[2].startswith("r")
        return "acceleration" if self.base else "pressure" if self.on else "moment" if turning else "force"

    def given(self) -> dict[str, Any]:
        kind = "base" if self.base is not None else "surface" if self.on is not None else "point"
        on = parse_spot(self.at) if self.at is not None else self.base or self.on
        what, spectrum = self.level[0], Spectrum(self.points)
        return {"on": on, "kind": kind, "what": what, "spectrum": spectrum, "duration": self.duration}
