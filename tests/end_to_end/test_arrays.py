"""Arrays of dampers: a body at a point of several places is one body each, written once."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from femstruct.errors import InputErrors
from femstruct.files.study_tables import summary
from femstruct.language.cases import read_study
from femstruct.study.results import StudyResult
from femstruct.view.terminal import show_study
from femstruct.workflow.run import run_study

MODEL = """materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850, loss_factor: 1 %}}
parts: {plate: {type: plate, material: steel, thickness: 3 mm, origin: [0, 0, 0], size: [0.5, 0.4], mesh: [6, 6]}}
points:
  middle: {on: plate, at: center}
  feet: {on: plate, at: [[0.1, 0.1], [0.4, 0.1], [0.4, 0.3], [0.1, 0.3]]}
supports: {edges: {on: plate, edge: all, fix: simple}}
damping: {from: materials}
"""
STUDY = """model: model.yaml
modes: {up_to: 1 kHz}
bodies:
  ball:   {mass: 20 g, above: middle, speed: 2 m/s, contact: {type: hertz, stiffness: 1e7}}
  damper: {mass: 0.1 kg, below: feet}
contacts: {pad: {between: [feet, damper], law: {type: linear, stiffness: 0.5 MN/m, damping: 30 Ns/m}}}
links:    {hanger: {between: [damper, ground], stiffness: 2 kN/m, damping: 5 Ns/m}}
record: {middle.z: velocity, damper: travel, damper.3: displacement, pad: force, hanger.2: force}
time: {duration: 20 ms, sampling: 50 kHz}
"""


def write(folder: Path, study: str = STUDY) -> Path:
    (folder / "model.yaml").write_text(MODEL, encoding="utf-8")
    (folder / "array.study.yaml").write_text(study, encoding="utf-8")
    return folder / "array.study.yaml"


def written_out() -> str:
    """The same, every body by hand."""
    bodies = "".join(f"  d{i}: {{mass: 0.1 kg, below: feet.{i}}}\n" for i in range(1, 5))
    law = "{type: linear, stiffness: 0.5 MN/m, damping: 30 Ns/m}"
    pads = "".join(f"  p{i}: {{between: [feet.{i}, d{i}], law: {law}}}\n" for i in range(1, 5))
    link = "stiffness: 2 kN/m, damping: 5 Ns/m"
    hangers = "".join(f"  h{i}: {{between: [d{i}, ground], {link}}}\n" for i in range(1, 5))
    text = re.sub(r"  damper: .*\n", bodies, STUDY)
    text = re.sub(r"contacts: .*\n", f"contacts:\n{pads}", text)
    text = re.sub(r"links: .*\n", f"links:\n{hangers}", text)
    return re.sub(r"record: .*\n", "record: {middle.z: velocity}\n", text)


@pytest.fixture(scope="module")
def array(tmp_path_factory: pytest.TempPathFactory) -> StudyResult:
    return run_study(read_study(write(tmp_path_factory.mktemp("array"))))


def test_an_array_is_its_bodies_written_out(array: StudyResult, tmp_path: Path) -> None:
    apart = run_study(read_study(write(tmp_path, written_out()))).cases["as given"].response
    response = array.cases["as given"].response
    assert response is not None and apart is not None
    assert list(response.bodies) == ["ball", "damper.1", "damper.2", "damper.3", "damper.4"]
    assert list(response.contacts) == ["pad.1", "pad.2", "pad.3", "pad.4", "ball on middle"]
    assert np.array_equal(response.qd, apart.qd)
    for i in range(1, 5):
        assert np.array_equal(response.bodies[f"damper.{i}"].velocity, apart.bodies[f"d{i}"].velocity)
        assert np.array_equal(response.contacts[f"pad.{i}"].force, apart.contacts[f"p{i}"].force)
    assert response.contacts["pad.1"].closings > 0


def test_records_of_an_array_are_those_of_each(array: StudyResult) -> None:
    names = [name for name in array.cases["as given"].channels if not name.startswith("net force")]
    assert names == [
        "middle.z velocity", "damper.1 travel", "damper.2 travel", "damper.3 travel", "damper.3 displacement",
        "damper.4 travel", "pad.1 force", "pad.2 force", "pad.3 force", "pad.4 force", "hanger.2 force",
    ]  # fmt: skip


def test_the_ledger_of_each_and_their_sum(array: StudyResult, capsys: pytest.CaptureFixture[str]) -> None:
    response = array.cases["as given"].response
    assert response is not None and response.ledger.residual < 1e-12  # steps and rounding: 6e-15 here
    table = summary(array)["cases"]["as given"]["arrays"]["damper"]
    end, rows = response.ledger.end, table["end"]
    assert list(rows) == ["damper.1", "damper.2", "damper.3", "damper.4", "sum"]
    for i in range(1, 5):
        assert rows[f"damper.{i}"] == {
            "kinetic_j": end.bodies[f"damper.{i}"],
            "stored_j": end.contacts[f"pad.{i}"] + end.links[f"hanger.{i}"],
            "dissipated_j": end.lost_contacts[f"pad.{i}"] + end.lost_links[f"hanger.{i}"],
        }
        # the plate and the places are symmetric about its middle, and so is what happens there; 1e-6: the mode
        # shapes are symmetric to the eigensolver's 1e-9 and contacts magnify that
        assert rows[f"damper.{i}"]["kinetic_j"] == pytest.approx(rows["damper.1"]["kinetic_j"], rel=1e-6)
        assert table["peak_force_n"][f"damper.{i}"] == response.contacts[f"pad.{i}"].peak_force
    for term in ("kinetic_j", "stored_j", "dissipated_j"):
        each = sum(rows[f"damper.{i}"][term] for i in range(1, 5))
        assert rows["sum"][term] == pytest.approx(each, rel=1e-14) and each > 0  # steps and rounding: none here
    # all there is: ball, plate and its losses, and the array
    rest = end.structure + end.bodies["ball"] + end.contacts["ball on middle"] + end.lost_modes
    # steps and rounding: 6e-15 here
    assert rest + sum(rows["sum"].values()) == pytest.approx(response.ledger.start.total, rel=1e-12)
    show_study(array, {})
    told = capsys.readouterr().out
    assert any(line.startswith("damper, all") for line in told.splitlines())
    assert any(line.startswith("damper.4") and "as given" in line for line in told.splitlines())


MISTAKES = {
    "as many": ("between: [damper, ground]", "between: [damper, spots]", "damper, spots",
        r"links\.hanger\.between: got 4 damper and 2 spots, expected as many of both, or one"),
    "one too many": ("damper.3: displacement", "damper.5: displacement", "damper.5",
        r"record\.damper\.5: got .*"),
    "no body": ("[feet, damper]", "[feet, dampr]", "dampr", r"contacts\.pad\.between\[1\]: got 'dampr'.*'damper'\?"),
}  # fmt: skip


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes_say_where(name: str, tmp_path: Path) -> None:
    old, new, marked, said = MISTAKES[name]
    path = write(tmp_path, STUDY.replace(old, new, 1))
    model = MODEL.replace("supports:", "  spots: {on: plate, at: [[0.1, 0.2], [0.2, 0.2]]}\nsupports:")
    (tmp_path / "model.yaml").write_text(model)
    with pytest.raises(InputErrors) as told:
        read_study(path)
    number = next(i for i, text in enumerate(path.read_text().splitlines(), 1) if marked in text)
    assert any(re.match(rf"{re.escape(str(path))}:{number}:\d+: {said}", line) for line in told.value.errors), (
        told.value
    )
