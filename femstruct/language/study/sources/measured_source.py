"""Measured structure-borne sources as they are written."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Annotated, Any, Final, Literal

from pydantic import ValidationInfo

from femstruct.errors import FemstructError, InputError, shown_as
from femstruct.files.inputs.columns import read_columns
from femstruct.files.inputs.heads import Head, scale_of
from femstruct.language.study.request import spot_of
from femstruct.language.yaml import (
    FREQUENCY,
    BandFile,
    Here,
    MassKg,
    Quantity,
    Spec,
    Text,
    band_file,
    each_band,
    made_of_file,
    read_by,
    refuse,
    several,
)
from femstruct.modal.steady.band_spectrum import BandSpectrum
from femstruct.modal.steady.source_mobility import (
    BandMobility,
    ForceSource,
    MeasuredMobility,
    RigidMass,
    SourceMobility,
)
from femstruct.modal.steady.spectrum import Spectrum
from femstruct.study.measured_source import MeasuredSource

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
            raise refuse(shown_as(value), "values by band, or a power spectral density", _BANDS)
        if "psd" not in value:
            return _by_band(value, dimension, info)
        psd = value["psd"]
        if len(value) > 1 or not isinstance(psd, dict | list):
            raise refuse(shown_as(value), "'psd' with pairs [frequency, value] or {file: NAME}", _BANDS)
        named = f"{dimension} psd"
        if isinstance(psd, dict):
            return made_of_file(
                psd, info, lambda path, sources: read_columns(path, ("frequency", named), sources, _lines)
            )
        if any(not isinstance(pair, list) or len(pair) != 2 for pair in psd):
            raise refuse(shown_as(psd), "pairs [frequency, value]", _BANDS)
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
            raise refuse(shown_as(value), "values by band, or lines with their phase", do)
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
            "at": tuple(spot_of(text) for text in self.at),
            "what": "blocked force" if force else "free velocity",
            "spectra": tuple(one if isinstance(one, Spectrum) else BandSpectrum(one, fraction) for one in spectra),
            "mobility": mobility,
        }
