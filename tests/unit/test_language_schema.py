"""The JSON Schema accepts the shipped files and refuses what the readers refuse: a small validator of our own."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from acoustics.levels.standards import STANDARDS
from femstruct.language.cases import json_schema
from femstruct.yaml.reader import read_yaml

MODELS = Path(__file__).parents[2] / "models"
TYPES: dict[str, type | tuple[type, ...]] = {
    "object": dict, "array": list, "string": str, "integer": int, "number": (int, float), "boolean": bool,
    "null": type(None),
}  # fmt: skip


def fits(schema: dict[str, Any], value: Any, root: dict[str, Any]) -> bool:
    """Whether a value fits the keywords of JSON Schema that pydantic writes."""
    if "$ref" in schema:
        return fits(root["$defs"][schema["$ref"].rpartition("/")[2]], value, root)
    for word in ("anyOf", "oneOf"):
        if word in schema and not any(fits(option, value, root) for option in schema[word]):
            return False
    if "const" in schema and value != schema["const"]:
        return False
    if "enum" in schema and value not in schema["enum"]:
        return False
    if "type" in schema and (
        not isinstance(value, TYPES[schema["type"]]) or (isinstance(value, bool) and schema["type"] != "boolean")
    ):
        return False
    if isinstance(value, str) and "pattern" in schema and not re.search(schema["pattern"], value):
        return False
    if isinstance(value, list):
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
            return False
        ordered = schema.get("prefixItems", [])
        rest = schema.get("items", {})
        return all(fits(ordered[i] if i < len(ordered) else rest, item, root) for i, item in enumerate(value))
    if isinstance(value, dict):
        known, more = schema.get("properties", {}), schema.get("additionalProperties", True)
        if any(key not in value for key in schema.get("required", [])):
            return False
        for key, item in value.items():
            inner = known.get(key, more)
            if inner is False or (isinstance(inner, dict) and not fits(inner, item, root)):
                return False
    return True


@pytest.mark.parametrize("path", sorted(MODELS.glob("*.yaml")), ids=lambda path: path.name)
def test_shipped_files_fit_the_schema(path: Path) -> None:
    schema = json_schema("study" if path.name.endswith(".study.yaml") else "model")
    assert fits(schema, read_yaml(path).value, schema)


def test_all_standards_are_in_the_schema_and_no_other() -> None:
    room = {"size": [5, 4, 2.5], "under": "ceiling", "receivers": {"mic": [1, 1, 1]}}
    for levels, wanted in ((list(STANDARDS), True), *((one, True) for one in STANDARDS), ("ISO 717-1", False)):
        schema = json_schema("study")
        study = {"model": "m.yaml", "rooms": {"room": room | {"levels": levels}}}
        assert fits(schema, study, schema) == wanted


def test_keys_whose_name_does_not_say_it_are_described() -> None:
    """Editors show it; every mesh, region and between of both files, and the cases."""
    found: dict[str, list[dict[str, Any]]] = {}
    for kind in ("model", "study"):
        schema = json_schema(kind)  # type: ignore[arg-type]
        for one in (schema, *schema["$defs"].values()):
            for key, what in one.get("properties", {}).items():
                found.setdefault(key, []).append(what)
    assert "the first is the baseline" in found["cases"][0]["description"]
    for key, words in (("mesh", "largest side|file"), ("region", "sides and centre"), ("between", "two|point|carries")):
        told = [json.dumps(one) for one in found[key]]
        whole = [re.search(words, text) for text in told]
        assert len(told) >= 3 and all(whole), (key, told)


def test_the_schema_says_which_standard_is_of_which_source() -> None:
    """KS F 2863-2 of a rubber ball is refused: a source of its rating was not found."""
    levels = json_schema("study")["$defs"]["BoxRoomSpec"]["properties"]["levels"]["description"]
    assert "KS F 2863-2: of a bang machine" in levels
    assert "ISO 717-2: of a rubber ball or a tapping machine; JIS A 1419-2: of a bang machine or a tapping" in levels


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("parts", "floor", "thickness"), True),
        (("parts", "floor", "thicknes"), "5 mm"),
        (("parts", "floor", "mesh"), ["a", "b"]),
        (("parts", "floor", "element"), "hermit12"),
        (("points", "O_f", "at"), "middle"),
        (("surfaces", "ceiling", "region"), {"circle": 1}),
    ],
)
def test_mistakes_do_not_fit_the_schema(path: tuple[str, ...], value: object) -> None:
    schema = json_schema("model")
    tree = read_yaml(MODELS / "floor_frame_slab.yaml").value
    parent = tree
    for step in path[:-1]:
        parent = parent[step]
    parent[path[-1]] = value
    assert not fits(schema, tree, schema)
