"""Quantities by frequency: one for all, one for each band, or a table of bands in a file beside the YAML file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, TypeVar

from pydantic import ValidationInfo
from pydantic_core import PydanticCustomError

from femstruct.errors import FemstructError, InputError, InputErrors, shown_as
from femstruct.files.inputs.band_tables import read_bands
from femstruct.files.inputs.grids import wrong_in
from femstruct.files.inputs.opening import beside
from femstruct.language.yaml.spec import FREQUENCY, Quantity, Spec, Text, refuse

T = TypeVar("T")
OF_FILE: Final = "of_file"  # a mistake that has its own place, in another file


@dataclass(frozen=True)
class Opened:
    """What a YAML file that is checked may open. file : its name. sources : is given the texts of tables, by name."""

    file: str
    sources: dict[str, str] = field(default_factory=dict)


class BandFile(Spec):
    """A table of bands as an analyser wrote it, beside this file. column : of several columns of values, the name of
    the one that is meant."""

    file: Text
    column: Text | None = None


def by_band(quantity: Quantity, expected: str, do: str) -> Callable[[object, ValidationInfo], object]:
    """Reader of a quantity, of one for each frequency, or of a table of bands: {file: NAME, column: NAME}."""

    def read(value: object, info: ValidationInfo) -> object:
        if not isinstance(value, dict):
            return quantity.read(value)
        if not value:
            raise refuse("no band", expected, do)
        if "file" in value:
            return band_file(value, quantity, info)
        return each_band(value, quantity.read)

    return read


def each_band(value: Mapping[str, Any], read: Callable[[Any], T]) -> dict[float, T]:
    """What `read` makes of the value at each frequency [Hz], each of them once."""
    found: dict[float, T] = {}
    for band, one in value.items():
        frequency = FREQUENCY.read(band)
        if frequency in found:
            raise refuse(f"{frequency:g} Hz twice", "each frequency once", "remove one of them")
        found[frequency] = read(one)
    return found


def band_file(value: dict[str, Any], quantity: Quantity, info: ValidationInfo) -> dict[float, float]:
    """Values by band of a table {file: NAME, column: NAME}, each within the limits of its quantity."""
    column = value.get("column") or ""
    if not isinstance(column, str):
        raise refuse(shown_as(value), "the name of a column", "write it like {file: t60.csv, column: T20}")

    def made(path: Path, sources: dict[str, str]) -> dict[float, float]:
        found = read_bands(path, quantity.dimensions[0], sources, column)
        for one in found.values():
            try:
                quantity.read(one.value)
            except PydanticCustomError as error:
                told = error.context or {}
                wrong = InputError("", got=f"{one.value:g}", expected=told["expected"], do=told["do"])
                raise wrong_in(path, one.line, wrong) from None
        return {band: one.value for band, one in found.items()}

    return made_of_file(value, info, made, ("file", "column"))


def made_of_file(
    value: dict[str, Any],
    info: ValidationInfo,
    maker: Callable[[Path, dict[str, str]], T],
    keys: Sequence[str] = ("file",),
) -> T:
    """What `maker` makes of the path of {file: NAME} and the texts of files; its mistakes keep their own places."""
    others, name, opened = [key for key in value if key not in keys], value.get("file"), info.context
    if others:
        raise refuse(f"the key '{others[0]}' beside 'file'", " and ".join(f"'{key}'" for key in keys), "remove it")
    if not isinstance(name, str):
        raise refuse(shown_as(name), "the name of a file", "write it like {file: t60.csv}")
    if not isinstance(opened, Opened):
        raise refuse(f"the file '{name}'", "values", "files are read where a YAML file names them")
    try:
        return maker(beside(opened.file, name), opened.sources)
    except InputErrors as errors:
        raise PydanticCustomError(OF_FILE, OF_FILE, {"lines": "\n".join(errors.errors)}) from None
    except FemstructError as error:
        raise refuse(error.got, error.expected, error.do) from None
