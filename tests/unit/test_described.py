"""A number that a noun declares is in JSON, in HDF5 and in the tables that are read, with no line elsewhere."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from io import BytesIO
from typing import Annotated

import h5py
import numpy as np
import pytest

from acoustics.levels.sound_energy import SoundEnergy
from acoustics.levels.sound_levels import Levels, sound_levels
from acoustics.reported import Reported as HeardReported
from femstruct.files.datasets import axis
from femstruct.files.described import columns, describe, write_described, write_held, write_rows
from femstruct.impact.numerical_error import Resolved
from femstruct.impact.response import Blow, BodyHistory, ContactHistory
from femstruct.reported import OWN_UNIT, Held, Reported, reported
from femstruct.sound.radiated_power import Radiated

NOUNS = (Levels, SoundEnergy, ContactHistory, BodyHistory, Blow, Resolved, Radiated)


@dataclass(frozen=True, eq=False)
class MoreLevels(Levels):
    """Levels with one more statistical level, as somebody would add it."""

    l_af5_db: Annotated[float, HeardReported("dB re 20 µPa", "Level exceeded in 5 % of the time", symbol="L_AF5")] = (
        71.5
    )


@pytest.fixture
def more() -> MoreLevels:
    t = np.arange(4800) / 48e3
    levels = sound_levels(np.sin(2 * np.pi * 500 * t), 1 / 48e3)
    return MoreLevels(**{one.name: getattr(levels, one.name) for one in fields(levels)})


def test_one_more_level_is_everywhere(more: MoreLevels) -> None:
    table = describe(more)
    assert table["l_af5_db"] == 71.5 and table["l_afmax_db"] == more.l_afmax_db
    assert table["bands_db"]["500"] == more.bands_db[500.0]
    with h5py.File(BytesIO(), "w") as file:
        write_described(file, more)
        assert file.attrs["l_af5_db"] == 71.5
        assert file["bands_db"].attrs["units"] == "dB re 20 µPa"
        assert file["bands_db"].dims[0][0][:].tolist() == list(more.bands_db)
        assert file["exposure_db"].dims[0][0] == file["bands_db"].dims[0][0], "one axis for both"
    assert more.single_numbers["l_af5_db"] == 71.5
    assert [one.symbol for one in reported(MoreLevels).values() if one.symbol] == ["L_peak", "L_AFmax", "L_AF5"]


@dataclass(frozen=True, eq=False)
class Answer:
    """One answer of a kind that nobody has heard of, in a unit of its own, with levels at its receivers."""

    unit: Annotated[str, Reported("1", "Unit of the size")]
    size: Annotated[float, Reported(OWN_UNIT, "How large")]
    lines: Annotated[np.ndarray, Reported(OWN_UNIT, "Line by line", along=("line",))]
    levels: Annotated[Mapping[str, Levels], Held("Levels by receiver", "Levels at one receiver")]


@dataclass(frozen=True, eq=False)
class Answers:
    """What somebody would add to the results of a case."""

    answers: Annotated[Mapping[str, Answer], Held("Answers by name", "One answer", key="told")]
    missing: Annotated[Answer | None, Held("An answer that there is not")] = None
    rated: Annotated[Mapping[str, Resolved], Held("One table", rows=("name", "1", "Name"))] = field(
        default_factory=lambda: {"a": Resolved(1.0, 0.1, 2.0), "b": Resolved(3.0, 0.2, 4.0)}
    )


def test_nouns_that_a_noun_holds_are_written_with_it(more: MoreLevels) -> None:
    """A new kind of answer is in JSON and in the results file, with its units, its axes and what it holds itself."""
    found = Answers({"one": Answer("kN", 2.0, np.array([1.0, 2.0, 4.0]), {"bed.mic": more})})
    table = describe(found)
    assert table["told"]["one"]["size"] == 2.0 and table["missing"] is None and table["rated"]["b"]["value"] == 3.0
    assert table["told"]["one"]["levels"]["bed.mic"]["l_af5_db"] == 71.5
    with h5py.File(BytesIO(), "w") as file:
        write_held(file, found)
        one = file["told/one"]
        assert one["lines"].attrs["units"] == "kN" and one["lines"].dims[0][0][:].tolist() == [1, 2, 3]
        heard, rated = one["levels/bed.mic"], file["rated/value"]
        assert heard.attrs["l_af5_db"] == 71.5
        assert [one["code"] for one in json.loads(heard.attrs["findings"])] == [one.code for one in more.findings]
        assert rated[:].tolist() == [1.0, 3.0] and rated.dims[0][0].asstr()[:].tolist() == ["a", "b"]
        assert "missing" not in file


def test_rows_of_several_nouns() -> None:
    """A dataset a number, histories at the times of the group; what does not exist is nan in HDF5, None in JSON."""
    first, second = (
        ContactHistory(np.full(3, n), np.zeros(3), n, 0.5 * n, 1, opened) for n, opened in ((1.0, 0.2), (2.0, None))
    )
    assert columns([first, second])["first_open_s"] == [0.2, None]
    with h5py.File(BytesIO(), "w") as file:
        axis(file, "time", [0.0, 1.0, 2.0], "s", "Time")
        axis(file, "contact", ["a", "b"], "1", "Name")
        write_rows(file, [first, second], "contact")
        assert file["force"][:].tolist() == [[1.0] * 3, [2.0] * 3] and file["force"].dims[1][0] == file["time"]
        np.testing.assert_array_equal(file["first_open"], [0.2, np.nan])
        assert file["peak_force"].attrs["long_name"] == "Peak force, between the samples too"


@pytest.mark.parametrize("noun", NOUNS)
def test_every_declaration_is_complete(noun: type) -> None:
    """A unit and a description, keys of JSON that are not given twice, the unit in the key where one is told."""
    found = reported(noun)
    assert found
    keys = [one.key or name for name, one in found.items()]
    assert len(keys) == len(set(keys))
    for name, one in found.items():
        assert one.unit and one.long_name and one.long_name[0].isupper(), name
    endings = {"N": "_n", "s": "_s", "J": "_j", "Pa": "_pa", "Hz": "_hz"}
    for name, one in found.items():
        if one.unit in endings and not one.along:
            assert (one.key or name).endswith(endings[one.unit]), name


def test_both_wings_declare_alike() -> None:
    """`acoustics` knows nothing of femstruct: the two words are one."""
    assert HeardReported._fields == Reported._fields and HeardReported._field_defaults == Reported._field_defaults
