"""One table says who refers to whom; what it says is what files are checked by and cases remove."""

from __future__ import annotations

from pathlib import Path

import pytest

from femstruct.errors import InputErrors
from femstruct.language.cases import read_study
from femstruct.language.model_file import ModelSpec
from femstruct.language.studies import StudySpec
from femstruct.yaml.spec import names_at, references

STUDY = """
model: {model}
bodies:
  ball: {{mass: 1 kg, above: m, drop_height: 5 cm, contact: {{type: linear, stiffness: 1 MN/m}}}}
  damper: {{mass: 1 kg, below: m}}
contacts: {{bumper: {{between: [damper, ball], law: {{type: linear, stiffness: 1 MN/m}}}}}}
links: {{hanger: {{between: [damper, m], stiffness: 1 kN/m}}}}
loads: {{push: {{body: damper, half_sine: {{amplitude: 1 N, frequency: 10 Hz}}}}}}
record: {{hanger: force, bumper: force, damper: travel, m.z: velocity}}
limits: {{hanger force: 1 N}}
time: {{duration: 1 s, sampling: 1 kHz}}
cases: {{with it: {{}}, without: {{remove: [bodies.damper]}}}}
"""


def test_all_that_names_a_body_goes_with_it(tmp_path: Path) -> None:
    (tmp_path / "model.yaml").write_text("structure: {type: oscillator, mass: 1, stiffness: 100}\npoints: {m: {}}")
    (tmp_path / "a.study.yaml").write_text(STUDY.format(model="model.yaml"))
    before, after = (case.study for case in read_study(tmp_path / "a.study.yaml").cases)
    assert [len(group) for group in (before.contacts, before.links, before.loads, before.limits)] == [1, 1, 1, 1]
    assert [len(group) for group in (after.contacts, after.links, after.loads, after.limits)] == [0, 0, 0, 0]
    assert [str(record) for record in after.records] == ["m.z velocity"]


def test_the_table_knows_who_refers_to_whom() -> None:
    table = {one.path: one.refers for schema in (ModelSpec, StudySpec) for one in references(schema)}
    assert table["parts", "*", ("type", "plate"), "material"].kind == "material"
    assert table["parts", "*", ("type", "foundation"), "between", 1].kind == "plate, slab or block"
    assert table["surfaces", "*", "on"].kind == "plate or shell"
    assert table["rooms", "*", "under"].kind == "surface"
    assert table["loads", "*", "along", "*"].kind == "point"
    going = {path[0] for path, refers in table.items() if refers.goes_with == "bodies"}
    assert going == {"contacts", "links", "loads"}
    assert {path[0] for path, refers in table.items() if refers.goes_with == "parts"} == {"joints"}


def test_names_are_found_in_a_tree() -> None:
    tree = {"loads": {"a": {"along": ["P", "Q"]}, "b": {"along": "R"}, "c": {"at": "S.z"}, "d": 5}}
    steps = [("loads", "a", "along", 0), ("loads", "a", "along", 1), ("loads", "b", "along")]
    assert list(names_at(tree, ("loads", "*", "along", "*"))) == list(zip(steps, "PQR", strict=True))
    assert list(names_at(tree, ("loads", "*", ("type", "x"), "along"))) == []


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("body: damper", "body: dampr", r"loads\.push\.body: got 'dampr', expected the name of a body; .*'damper'"),
        ("below: m", "below: n", r"bodies\.damper\.below: got 'n', expected the name of a point, body or ground"),
    ],
)
def test_a_name_of_nothing_is_told_where_it_stands(tmp_path: Path, old: str, new: str, told: str) -> None:
    (tmp_path / "model.yaml").write_text("structure: {type: oscillator, mass: 1, stiffness: 100}\npoints: {m: {}}")
    (tmp_path / "a.study.yaml").write_text(STUDY.format(model="model.yaml").replace(old, new, 1))
    with pytest.raises(InputErrors, match=told):
        read_study(tmp_path / "a.study.yaml")
