"""Every key of the shipped files, misspelt: the first line is about that key and has its nearest name."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from femstruct.errors import InputErrors
from femstruct.language.cases import read_study
from femstruct.language.model_file import ModelSpec
from femstruct.language.studies import StudySpec
from femstruct.yaml.reader import Mistakes, Tree, read_yaml
from femstruct.yaml.validation import validate

FILES = sorted(Path(__file__).parents[2].joinpath("models").glob("*.yaml"))
NAMED = {
    "materials", "sections", "parts", "joints", "points", "surfaces", "supports", "constraints", "frf", "bodies",
    "contacts", "links", "equation", "loads", "record", "limits", "rooms", "receivers", "walls", "velocity",
    "thickness", "shock_spectra", "vibration", "fatigue", "cavities", "vary",
}  # fmt: skip
"""Whose keys are names; so are those of `modes` of a damping and of losses by band."""


def misspelt(key: str) -> str:
    """A key without its third letter, a short one with its last letter twice.

    >>> misspelt("stiffness"), misspelt("at")
    ('stffness', 'att')
    """
    return key[:2] + key[3:] if len(key) > 4 else key + key[-1]


def keys(value: Any, steps: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The steps of every key of the language in a file."""
    for key, inside in value.items() if isinstance(value, dict) else enumerate(value):
        name = isinstance(key, int) or (steps and steps[-1] in NAMED) or key[:1].isdigit()
        if not name:
            yield (*steps, key)
        if isinstance(inside, dict | list) and key != "cases":
            yield from keys(inside, (*steps, key))


def with_misspelt(value: Any, steps: tuple[Any, ...]) -> Any:
    first, *rest = steps
    if isinstance(value, list):
        return [with_misspelt(one, tuple(rest)) if number == first else one for number, one in enumerate(value)]
    if rest:
        return {key: with_misspelt(one, tuple(rest)) if key == first else one for key, one in value.items()}
    return {misspelt(key) if key == first else key: one for key, one in value.items()}


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_a_misspelt_key_is_the_first_mistake(path: Path) -> None:
    tree = read_yaml(path)
    schema = StudySpec if path.name.endswith(".study.yaml") else ModelSpec
    hidden = []
    for steps in keys(tree.value):
        changed, mistakes = with_misspelt(tree.value, steps), Mistakes()
        validate(schema, changed, Tree(tree.file, changed, {}, {}, ""), mistakes)
        told = mistakes.lines[0] if mistakes.lines else "nothing"
        if f"the unknown key '{misspelt(steps[-1])}'" not in told or f"did you mean '{steps[-1]}'?" not in told:
            hidden.append((steps, told))
    assert not hidden


@pytest.mark.parametrize(
    ("written", "told"),
    [
        # of a law the missing key was named, not the misspelt one that stood there
        ({"bodies": {"b": {"mass": 1, "above": "P", "contact": {"type": "linear", "stifness": 1e6}}}},
            "bodies.b.contact.stifness: got the unknown key 'stifness', expected a key of the language; "
            "did you mean 'stiffness'?"),
        ({"bodies": {"b": {"source": "rubber ball", "abve": "P"}}},
            "bodies.b.abve: got the unknown key 'abve', expected a key of the language; did you mean 'above'?"),
        ({"bodies": {"b": {"source": "tapping machine", "above": "P", "contct": {}}}},
            "bodies.b.contct: got the unknown key 'contct', expected a key of the language; did you mean 'contact'?"),
        ({"bodies": {"b": {"source": "tapping machine", "above": "P", "contact": {"type": "stop", "stiffness": 1e9},
            "blows": {"timng": "regular", "count": 3}}}},
            "bodies.b.blows.timng: got the unknown key 'timng', expected a key of the language; "
            "did you mean 'timing'?"),
        ({"rooms": {"r": {"size": [1, 1, 1], "under": "S", "losses": {"t06": 1}}}},
            "rooms.r.losses.t06: got the unknown key 't06', expected a key of the language; did you mean 't60'?"),
    ],
)  # fmt: skip
def test_nothing_else_is_told_of_a_misspelt_key(written: dict[str, Any], told: str) -> None:
    mistakes, study = Mistakes(), {"model": "m.yaml", **written}
    validate(StudySpec, study, Tree("s.yaml", study, {}, {}, ""), mistakes)
    assert mistakes.lines == [f"s.yaml:1:1: {told}"]


def test_a_section_of_nothing_that_is_known_lacks_its_shape() -> None:
    mistakes, model = Mistakes(), {"sections": {"bar": {"width": "1 mm", "height": "1 mm"}}}
    validate(ModelSpec, model, Tree("m.yaml", model, {}, {}, ""), mistakes)
    (line,) = mistakes.lines
    assert "sections.bar: got no 'shape', expected a key 'shape'; add shape: rectangle | circle" in line


MODEL = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {plate: {type: plate, material: steel, thickness: 8 mm, origin: [0, 0, 0], size: [1.2, 0.8], mesh: [4, 4]}}
points: {hit: {on: plate, at: center}}
"""
STUDY = """
model: model.yaml
modes: {up_to: 2 kHz}
bodies:
  body: {mass: 2 kg, above: hit, drop_height: 0.3 m, contact: {type: hertz, stiffness: 1e9}}
record: {hit.z: velocity, body on hit: force}
time: {duration: 0.5 s, sampling: 48 kHz, gravity: true}
limits: {hit.z velocity: 1 m/s}
"""


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        # a record was then none of a contact: "did you mean 'body on hitt'?"
        ("above: hit,", "above: hitt,", ":5:29: bodies.body.above: got 'hitt', .*; did you mean 'hit'\\?$"),
        # a limit was then none of a recorded channel: "did you mean 'hit.w velocity'?"
        ("{hit.z: velocity", "{hit.w: velocity", ":6:10: record.hit.w: got 'hit.w', .*; write it like hit.z$"),
        ("{hit.z: velocity", "{hit: velocity", ":6:10: record.hit: got 'hit', .*; did you mean 'hit.z'\\?$"),
    ],
)
def test_what_follows_of_a_mistake_is_not_told(old: str, new: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "model.yaml").write_text(MODEL, encoding="utf-8")
    assert old in STUDY
    (tmp_path / "a.study.yaml").write_text(STUDY.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputErrors) as caught:
        read_study(tmp_path / "a.study.yaml")
    (line,) = caught.value.errors
    assert re.search(told, line), line
