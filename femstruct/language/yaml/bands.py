"""Quantities by frequency: one for all, one for each band, or a table of bands in a file beside the YAML file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Final

from pydantic import ValidationInfo
from pydantic_core import PydanticCustomError

from femstruct.errors import FemstructError, InputError, InputErrors, shown_as
from femstruct.files.inputs.band_tables import read_bands
from femstruct.files.inputs.grids import wrong_in
from femstruct.files.inputs.opening import beside
from femstruct.language.yaml.spec import FREQUENCY, Quantity, Spec, Text, refuse

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
        return {FREQUENCY.read(band): quantity.read(one) for band, one in value.items()}

    return read


def band_file(value: dict[str, Any], quantity: Quantity, info: ValidationInfo) -> dict[float, float]:
    """Values by band of a table {file: NAME, column: NAME}, each within the limits of its quantity."""
    others = [key for key in value if key not in BandFile.model_fields]
    if others:
        raise refuse(f"the key '{others[0]}' beside 'file'", "'file' and 'column'", "remove it")
    name, column, opened = value["file"], value.get("column") or "", info.context
    if not isinstance(name, str) or not isinstance(column, str):
        raise refuse(
            shown_as(value), "the name of a file and of a column", "write it like {file: t60.csv, column: T20}"
        )
    if not isinstance(opened, Opened):
        raise refuse(f"the file '{name}'", "values by band", "files are read where a YAML file names them")
    try:
        path = beside(opened.file, name)
        found = read_bands(path, quantity.dimensions[0], opened.sources, column)
        for one in found.values():
            try:
                quantity.read(one.value)
            except PydanticCustomError as error:
                told = error.context or {}
                wrong = InputError("", got=f"{one.value:g}", expected=told["expected"], do=told["do"])
                raise wrong_in(path, one.line, wrong) from None
    except InputErrors as errors:
        raise PydanticCustomError(OF_FILE, OF_FILE, {"lines": "\n".join(errors.errors)}) from None
    except FemstructError as error:
        raise refuse(error.got, error.expected, error.do) from None
    return {band: one.value for band, one in found.items()}
