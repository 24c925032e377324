"""Random trees and random damage: the readers give a noun or InputErrors, never anything else, and write nothing."""

from __future__ import annotations

import copy
import io
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ruamel.yaml import YAML

from femstruct.errors import InputErrors
from femstruct.language.cases import read_any, read_study
from femstruct.language.models import read_model_file

MODELS = Path(__file__).parents[2] / "models"
MODEL = YAML(typ="safe", pure=True).load((MODELS / "floor_frame_slab.yaml").read_text(encoding="utf-8"))
STUDY = YAML(typ="safe", pure=True).load((MODELS / "floor_acrylic_ball.study.yaml").read_text(encoding="utf-8"))
WORDS = st.sampled_from([
    "plate", "frame", "type", "floor", "slab", "O_f", "O_f.z", "ball", "ground", "center", "whole", "none", "hertz",
    "rod", "5 mm", "1,5 m", "40 rad/s", "2 %", "3 Hz", "1 N", "until next contact", "materials", "from", "at", "on",
    "region", "add", "remove", "bodies.damper", "parts.floor", "model", "between", "stiffness", "", " ", ".", "a.b",
])  # fmt: skip
SCALARS = st.one_of(
    WORDS, st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=8), st.sampled_from([10**30, -1, 0])
)
TREES = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(WORDS, inner, max_size=4), max_leaves=12
)


def paths(value: Any, here: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Every path of a tree."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [here, *(path for key, item in items for path in paths(item, (*here, key)))]


MODEL_PATHS, STUDY_PATHS = paths(MODEL)[1:], paths(STUDY)[1:]


def damaged(tree: Any, path: tuple[Any, ...], key: Any, value: Any) -> Any:
    """The tree with one value replaced, or with a key more beside it."""
    new = copy.deepcopy(tree)
    parent = new
    for step in path[:-1]:
        parent = parent[step]
    if key is not None and isinstance(parent, dict):
        parent[key] = value
    else:
        parent[path[-1]] = value
    return new


def dumped(tree: Any) -> str:
    stream = io.StringIO()
    YAML(typ="safe", pure=True).dump(tree, stream)
    return stream.getvalue()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("fuzz")


def read_or_refuse(read: Any, path: Path) -> None:
    before = sorted(path.parent.iterdir())
    try:
        read(path)
    except InputErrors as refused:
        assert refused.errors
        for line in refused.errors:
            assert "\n" not in line and line.startswith(str(path.parent)), line
    assert sorted(path.parent.iterdir()) == before


FUZZ = settings(max_examples=25)


@FUZZ
@given(st.dictionaries(st.sampled_from([*MODEL, *STUDY, "structure", "initial", "loads"]), TREES, max_size=5))
def test_random_trees(folder: Path, tree: dict[str, Any]) -> None:
    (folder / "any.yaml").write_text(dumped(tree), encoding="utf-8")
    read_or_refuse(read_any, folder / "any.yaml")
    read_or_refuse(read_model_file, folder / "any.yaml")
    read_or_refuse(read_study, folder / "any.yaml")


@FUZZ
@given(st.sampled_from(MODEL_PATHS), st.none() | WORDS, TREES)
def test_a_damaged_model(folder: Path, path: tuple[Any, ...], key: Any, value: Any) -> None:
    (folder / "model.yaml").write_text(dumped(damaged(MODEL, path, key, value)), encoding="utf-8")
    read_or_refuse(read_model_file, folder / "model.yaml")


@FUZZ
@given(st.sampled_from(STUDY_PATHS), st.none() | WORDS, TREES)
def test_a_damaged_study(folder: Path, path: tuple[Any, ...], key: Any, value: Any) -> None:
    (folder / "floor_frame_slab.yaml").write_bytes((MODELS / "floor_frame_slab.yaml").read_bytes())
    (folder / "study.yaml").write_text(dumped(damaged(STUDY, path, key, value)), encoding="utf-8")
    read_or_refuse(read_study, folder / "study.yaml")


@FUZZ
@given(st.binary(max_size=200) | st.text(alphabet="{}[]:,&*!|>'\"%@`#-? \n\tab1", max_size=60).map(str.encode))
def test_random_bytes(folder: Path, content: bytes) -> None:
    (folder / "bytes.yaml").write_bytes(content)
    read_or_refuse(read_any, folder / "bytes.yaml")


@FUZZ
@given(st.sampled_from([".".join(map(str, path)) for path in STUDY_PATHS + MODEL_PATHS]) | WORDS, st.text(max_size=12))
def test_random_overrides(path: str, value: str) -> None:
    try:
        read_study(MODELS / "floor_acrylic_ball.study.yaml", [f"{path}={value}"])
    except InputErrors as refused:
        assert refused.errors
