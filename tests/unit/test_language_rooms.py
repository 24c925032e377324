"""Kinds of rooms are told by their keys; each is one file, and what is no key of a kind is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from acoustics.fields.half_space import HalfSpace
from acoustics.fields.rectangular import Room
from acoustics.fields.shaped import ShapedRoom
from femstruct.errors import InputErrors
from femstruct.language.cases import json_schema, read_study
from femstruct.language.rooms import RoomSpec
from femstruct.language.studies import ROOM_KINDS
from femstruct.yaml.reader import read_yaml

MODEL = """
materials: {wood: {E: 10 GPa, nu: 0.3, rho: 500}}
parts: {slab: {type: plate, material: wood, thickness: 20 mm, origin: [0, 0, 0], size: [1, 1], mesh: [2, 2]}}
points: {P: {on: slab, at: center}}
surfaces: {ceiling: {on: slab, side: below}, top: {on: slab}}
supports: {walls: {on: slab, edge: all, fix: simple}}
"""
STUDY = """
model: model.yaml
modes: {count: 4}
bodies: {ball: {mass: 50 g, above: P, drop_height: 5 cm, contact: {type: linear, stiffness: 1 MN/m}}}
time: {duration: 1 s, sampling: 1 kHz}
rooms: {bed: {%s}}
"""
KEYS = {
    "size: [1, 1, 1], under: ceiling": Room,
    "size: [1, 1, 1], under: ceiling, walls: {floor: {absorption: 10 %}}, modes: {up_to: 100 Hz}": ShapedRoom,
    "above: top": HalfSpace,
    "receivers: {mic: [[0, 0, -1], [0, 0, -2]]}, below: ceiling": HalfSpace,
}


def study(tmp_path: Path, keys: str) -> Any:
    (tmp_path / "model.yaml").write_text(MODEL)
    (tmp_path / "a.study.yaml").write_text(STUDY % keys)
    return read_study(tmp_path / "a.study.yaml").cases[0].study


@pytest.mark.parametrize("keys", KEYS)
def test_a_room_is_of_the_kind_that_its_keys_tell(tmp_path: Path, keys: str) -> None:
    (room,) = study(tmp_path, keys).rooms
    assert type(room.room) is KEYS[keys]


@pytest.mark.parametrize(
    ("keys", "told"),
    [
        (
            "size: [1, 1, 1]",
            r"rooms\.bed: got none of under, above, below, expected exactly one of .*, or surfaces",
        ),
        ("size: [1, 1, 1], above: top", r"rooms\.bed: got 'size' beside 'above', expected air and receivers"),
        ("under: ceiling", r"rooms\.bed: got none of size, mesh, expected exactly one of size, mesh"),
        ("size: [1, 1, 1], under: ceiling, wals: {}", r"rooms\.bed\.wals: got the unknown key .*did you mean 'walls'"),
        ("size: [1, 1, 1], under: ceiling, directivity: 1 Hz", r"got 'directivity' beside 'under', expected open air"),
        ("size: [1, 1, 1], under: ceiling, walls: {}", r"got 'walls' of a room with a size, expected 'modes' beside"),
        ("size: [1, 1, 1], under: ceiling, ceiling: a", r"got ceiling without mesh, expected 'mesh' beside 'ceiling'"),
    ],
)
def test_keys_that_no_kind_has_together_are_refused(tmp_path: Path, keys: str, told: str) -> None:
    with pytest.raises(InputErrors, match=told) as refused:
        study(tmp_path, keys)
    assert len(refused.value.errors) == 1


def fits(kind: dict[str, Any], room: dict[str, Any]) -> bool:
    """Whether an editor takes the keys of a room for those of a kind."""
    signs = kind.get("anyOf", [{"required": []}])
    needed = set(kind.get("required", ()))
    return needed <= room.keys() <= kind["properties"].keys() and any(
        set(one["required"]) <= room.keys() for one in signs
    )


@pytest.mark.parametrize("keys", KEYS)
def test_an_editor_takes_a_room_for_one_kind_alone(tmp_path: Path, keys: str) -> None:
    """The schema says oneOf: a room that fits two kinds would be marked as a mistake."""
    path = tmp_path / "room.yaml"
    path.write_text(f"{{{keys}}}")
    schema = json_schema("study")["$defs"]
    assert sum(fits(schema[kind.__name__], read_yaml(path).value) for kind in ROOM_KINDS) == 1


def test_every_kind_is_in_the_schema_with_its_own_keys() -> None:
    kinds = json_schema("study")["$defs"]
    assert {kind.__name__ for kind in ROOM_KINDS} <= kinds.keys()
    assert "directivity" in kinds["HalfSpaceSpec"]["properties"]
    assert not {"directivity", "mesh"} & kinds["BoxRoomSpec"]["properties"].keys()


def test_a_kind_of_room_must_say_what_it_makes() -> None:
    class NoRoomSpec(RoomSpec):
        signs = ("cave",)

    with pytest.raises(TypeError, match=r"abstract method '?build"):
        NoRoomSpec()
