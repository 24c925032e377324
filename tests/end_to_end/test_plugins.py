"""A package outside femstruct adds a kind of part, a contact law and an evaluation of histories, by entry points alone;
a broken one is named."""

from __future__ import annotations

import json
import math
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from femstruct.errors import FemstructError
from femstruct.language import parts
from femstruct.language.parts import PartSpec
from femstruct.laws.law import Law
from femstruct.plugins import added_kinds
from femstruct.yaml.spec import kinds_of

ROOT = Path(__file__).parents[2]
GUEST = ROOT / "tests" / "data" / "femstruct_guest"
ENTRIES = """
[femstruct.language.parts]
strut = femstruct_guest.strut_words:StrutSpec
[femstruct.evaluations]
crest = femstruct_guest.crest:CrestRequest
[femstruct.laws]
barrier = femstruct_guest.barrier:Barrier
"""
EA, RHO_A, LUMP = 210e9 * 1e-4, 7850 * 1e-4, 3.0
TRUSS = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
sections: {tube: {shape: tube, outer: 30 mm, thickness: 2 mm}}
parts:
  left:  {type: strut, material: steel, area: 1 cm^2, start: [-0.8, 0, 0], end: [0, 0, 0.6]}
  right: {type: strut, material: steel, area: 1 cm^2, start: [0.8, 0, 0], end: [0, 0, 0.6]}
  lump:  {type: mass, mass: 3 kg, at: apex}
joints: {hinge: {connect: [left, right], kind: pinned}}
points:
  apex: {on: left, at: [0, 0, 0.6]}
  l: {on: left, at: [-0.8, 0, 0]}
  r: {on: right, at: [0.8, 0, 0]}
supports:
  left foot: {at: l, fix: simple}
  right foot: {at: r, fix: simple}
  in plane: {at: apex, fix: [y]}
"""
TOP = (
    "  other: {type: plate, material: steel, thickness: 5 mm, origin: [-0.5, -0.5, 0.6], size: [1, 1], mesh: 0.35 m}\n"
)
POST = "  other: {type: frame, material: steel, section: tube, lines: [[[0, 0, 0], [0, 0, 1]]], mesh: 0.35 m}\n"
FALL = """
model: nothing.yaml
bodies: {ball: {mass: 100 g, above: ground, speed: 2 m/s}}
contacts: {hit: {between: [ball, ground], law: {type: barrier, stiffness: 50 kN/m, depth: 1.5 mm}}}
record: {ball: velocity, hit: force}
time: {duration: 20 ms, sampling: 200 kHz}
"""
HIT = """
model: truss.yaml
modes: {up_to: 1 kHz}
bodies: {ball: {mass: 100 g, above: apex, speed: 2 m/s, contact: {type: linear, stiffness: 50 kN/m}}}
record: {apex.z: velocity, ball on apex: force}
crest_factors: {top: {of: apex.z}}
time: {duration: 20 ms, sampling: 20 kHz}
"""


def installed(site: Path, name: str, entries: str) -> None:
    """The metadata of an installed package, as pip leaves it."""
    folder = site / f"{name.replace('-', '_')}-0.1.dist-info"
    folder.mkdir(parents=True)
    (folder / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 0.1\n", encoding="utf-8")
    (folder / "entry_points.txt").write_text(entries, encoding="utf-8")


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """A folder of packages with the guest, and files to read."""
    installed(tmp_path / "site", "femstruct-guest", ENTRIES)
    shutil.copytree(GUEST, tmp_path / "site" / "femstruct_guest", ignore=shutil.ignore_patterns("__pycache__"))
    for name, text in (("truss", TRUSS), ("nothing", "structure: none\n"), ("fall.study", FALL)):
        (tmp_path / f"{name}.yaml").write_text(text, encoding="utf-8")
    return tmp_path / "site"


def python(site: Path, *words: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(ROOT), str(site)))}
    command = [sys.executable, *words]
    return subprocess.run(command, capture_output=True, text=True, cwd=site.parent, env=environment)


def test_struts_of_another_package_carry_a_mass(site: Path) -> None:
    """Two struts under 36.87 degrees: k = 2 E A / L sin^2, cos^2, and a third of the mass of each at the apex."""
    told = python(site, "-m", "femstruct", "modes", "truss.yaml", "--json")
    assert told.returncode == 0, told.stderr
    found = json.loads(told.stdout)["frequency_hz"]
    moving = LUMP + 2 * RHO_A / 3
    expected = [math.sqrt(2 * EA * share / moving) / (2 * math.pi) for share in (0.36, 0.64)]
    assert found == pytest.approx(expected, rel=1e-9)  # rounding of an eigenvalue of two unknowns


@pytest.mark.parametrize("other", [POST, TOP], ids=["frame", "plate"])
def test_a_part_has_a_node_where_a_strut_ends_on_it(site: Path, other: str) -> None:
    """The end at 0.6 m lies between the nodes that a size of 0.35 m gives; a rigid joint to a hinge is refused."""
    path = site.parent / "truss.yaml"
    text = path.read_text(encoding="utf-8").replace("  lump:", f"{other}  lump:")
    path.write_text(text.replace("hinge: {connect: [left, right]", "hinge: {connect: [left, other]"), encoding="utf-8")
    read = "from femstruct import read_model; print(read_model('truss.yaml').parts['other'].places.round(9).tolist())"
    told = python(site, "-c", read)
    assert [0.0, 0.0, 0.6] in json.loads(told.stdout), told.stderr
    path.write_text(path.read_text(encoding="utf-8").replace("kind: pinned", "kind: rigid"), encoding="utf-8")
    told = python(site, "-m", "femstruct", "modes", "truss.yaml")
    assert (told.returncode, told.stdout) == (2, "")
    assert "joints.hinge: got rigid, and nodes of left that have no rotations, expected pinned" in told.stderr


def test_the_words_of_another_package_are_checked_and_in_the_schema(site: Path) -> None:
    path = site.parent / "truss.yaml"
    for right, wrong, expected in (
        ("area: 1 cm^2", "area: 1 cm", r":5:\d+: parts.left.area: got '1 cm', which is a length, expected an area"),
        ("left, at: [0, 0, 0.6]", "left, at: top", r":10:\d+: points.apex.at: got top of a strut, expected global co"),
    ):
        path.write_text(TRUSS.replace(right, wrong, 1), encoding="utf-8")
        told = python(site, "-m", "femstruct", "check", "truss.yaml")
        assert told.returncode == 2
        assert re.search(expected, told.stderr)
    schema = json.loads(python(site, "-m", "femstruct", "schema", "model").stdout)
    assert "StrutSpec" in schema["$defs"]


def test_a_study_of_struts_is_stored_and_read_back(site: Path) -> None:
    """All results and the page; without the package the file says which one is missing. What the package asks of a
    history is in the summary, in tables and on the page."""
    no_law = ENTRIES.split("[femstruct.laws]")[0]  # another law would have all kernels compiled anew
    (site / "femstruct_guest-0.1.dist-info" / "entry_points.txt").write_text(no_law, encoding="utf-8")
    (site.parent / "hit.study.yaml").write_text(HIT, encoding="utf-8")
    told = python(site, "-m", "femstruct", "run", "hit.study.yaml", "--no-pictures", "-o", "out")
    assert told.returncode == 0, told.stderr
    page = (site.parent / "out" / "report.html").read_text(encoding="utf-8")
    assert "strut" in page and "crest factors" in page and "crest factors" in told.stdout
    crest = json.loads((site.parent / "out" / "summary.json").read_text(encoding="utf-8"))["cases"]["as given"]
    assert 1.0 < crest["crest_factors"]["top"]["factor"] < 20.0 and crest["perception"] == {}
    read = "from femstruct import read_results; print(read_results('out/results.h5').plan.cases[0].study.structure)"
    assert "Strut(name='left'" in python(site, "-c", read).stdout
    told = python(site.parent / "nowhere", "-c", read)
    assert "install the package 'femstruct_guest'" in told.stderr


def test_a_law_of_another_package_is_read_and_dispatched_to(site: Path) -> None:
    """Force, slope and energy of its kernel as the engine calls it, against the law's own formulas in Python."""
    script = """
from femstruct import Clock, read_study
from femstruct.impact.system import compile_scene
from femstruct.laws.registry import spring
from femstruct.impact.scene import GROUND, Body, Contact, Scene
from femstruct.modal.closed_form import given_modes
law = read_study("fall.study.yaml").cases[0].study.contacts[0].law
scene = Scene((Body("b", 1.0, -1.0),), (Contact("c", "b", GROUND, law),))
system = compile_scene(given_modes([], [], {})[0], scene, Clock(1.0, 1.0)).system
force, slope, energy = spring(system, 0, 1.2e-3)
print([float(one) for one in (force, law.force(1.2e-3), energy, law.energy(1.2e-3), slope)])
"""
    told = python(site, "-c", script)
    assert told.returncode == 0, told.stderr
    force, expected, energy, held, slope = json.loads(told.stdout)
    assert (force, energy) == pytest.approx((expected, held), rel=1e-14)  # rounding of a few products
    assert slope == pytest.approx(50e3 * (1 + 5 * 0.8**4), rel=1e-14)  # rounding of a few products


def test_a_law_is_one_class_for_files_python_and_the_schema(site: Path) -> None:
    """What its one class declares is checked at its column, made of texts in Python, and in the schema."""
    study = site.parent / "fall.study.yaml"
    study.write_text(FALL.replace("depth: 1.5 mm", "depth: 1.5 N"), encoding="utf-8")
    told = python(site, "-m", "femstruct", "check", "fall.study.yaml")
    column = FALL.splitlines()[3].index("1.5 mm") + 1
    expected = f"fall.study.yaml:4:{column}: contacts.hit.law.depth: got '1.5 N', which is a force, expected a length"
    assert (told.returncode, expected in told.stderr) == (2, True), told.stderr
    made = "from femstruct_guest.barrier import Barrier as B; print(B('50 kN/m', '1.5 mm', restitution=1, at_speed=2))"
    told = python(site, "-c", f"{made}; B(1e4, '-1 mm')")
    assert "Barrier(stiffness=50000.0, depth=0.0015, dissipation=0.0, tensile=False)" in told.stdout, told.stderr
    assert "barrier law depth: got '-1 mm', expected a positive value: a length" in told.stderr
    schema = json.loads(python(site, "-m", "femstruct", "schema", "study").stdout)["$defs"]["BarrierSpec"]
    assert schema["required"] == ["type", "stiffness", "depth"]
    assert schema["properties"]["depth"]["description"].startswith("a length [m]")
    assert schema["description"].startswith("f = k d (1 + (d / depth)^4)")


def test_a_law_in_the_group_that_was_is_answered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    installed(tmp_path, "some-guest", "[femstruct.language.laws]\nthing = gone:Spec\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    message = (
        r"some-guest 0.1, entry point thing = gone:Spec: got the group femstruct.language.laws, expected one class, in "
        r"the group femstruct.laws; annotate its fields with their quantities, and leave 'thing' out of femstruct"
    )
    with pytest.raises(FemstructError, match=message):
        added_kinds("femstruct.laws", Law, "femstruct.language.laws")


def test_a_field_without_a_quantity_is_no_key(site: Path) -> None:
    path = site / "femstruct_guest" / "barrier.py"
    path.write_text(path.read_text(encoding="utf-8").replace("depth: Length", "depth: float"), encoding="utf-8")
    told = python(site, "-m", "femstruct", "check", "fall.study.yaml")
    expected = "femstruct_guest.barrier.Barrier: got depth: float, expected its quantity, as in `thickness: Length`"
    assert (told.returncode, expected in told.stderr) == (2, True), told.stderr


@pytest.mark.stress
def test_a_ball_falls_on_a_law_of_another_package(site: Path) -> None:
    """All its energy is in the spring at the peak: m v^2 / 2 = E(d), found here by bisection. Kernels are compiled."""
    told = python(site, "-m", "femstruct", "impact", "fall.study.yaml", "--json")
    assert told.returncode == 0, told.stderr
    low, high = 0.0, 0.01
    for _ in range(200):
        d = (low + high) / 2
        low, high = (d, high) if 50e3 * d**2 * (0.5 + (d / 1.5e-3) ** 4 / 6) < 0.2 else (low, d)
    peak = 50e3 * d * (1 + (d / 1.5e-3) ** 4)
    found = json.loads(told.stdout)["cases"]["as given"]["contacts"]["hit"]["peak_force_n"]
    assert found == pytest.approx(peak, rel=1e-9)  # what the steps are asked for


BROKEN = {
    "no such module": ("gone:Spec", "", "ModuleNotFoundError: No module named 'gone'"),
    "an error of its own": ("MODULE:Spec", "1 / 0", "ZeroDivisionError: division by zero"),
    "no such name": ("MODULE:Spec", "", "has no attribute 'Spec'"),
    "no class": ("MODULE:Spec", "Spec = 3", "got 3, expected a class that extends femstruct.language.parts.Part"),
    "a law": ("MODULE:Spec", "from femstruct.laws.stop import Stop as Spec", "Stop'>, expected a cl"),
    "no word": (
        "MODULE:Spec",
        f"from {PartSpec.__module__} import PartSpec\nclass Spec(PartSpec): ...",
        'got no type, expected a word of its own, type: Literal["word"]',
    ),
    "a word that is taken": (
        "MODULE:Spec",
        "from femstruct.language.parts import PlateSpec as Spec",
        "got type: plate, taken by femstruct.language.parts, expected a word of its own",
    ),
}


@pytest.mark.parametrize("what", BROKEN)
def test_a_broken_package_is_named(what: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    value, text, told = BROKEN[what]
    module = f"broken_{what.replace(' ', '_')}"
    installed(tmp_path, "some-guest", f"[femstruct.language.parts]\nthing = {value.replace('MODULE', module)}\n")
    (tmp_path / f"{module}.py").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(FemstructError) as error:
        kinds_of(parts, PartSpec)
    message = str(error.value)
    assert message.startswith("package some-guest 0.1, entry point thing = ")
    assert told in message
    assert message.endswith("; repair or uninstall that package")


def test_half_a_law_is_told_what_it_lacks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    installed(tmp_path, "some-guest", "[femstruct.laws]\nthing = half_a_law:Half\n")
    text = "from femstruct.laws.law import Law\nclass Half(Law):\n    stored = None\n"
    (tmp_path / "half_a_law.py").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(FemstructError, match=r"some-guest 0.1, .*: got a class without indentation, expected"):
        added_kinds("femstruct.laws", Law)


def test_words_that_make_no_part_are_named(site: Path) -> None:
    words = site / "femstruct_guest" / "strut_words.py"
    words.write_text(words.read_text(encoding="utf-8").replace("    makes = Strut\n", ""), encoding="utf-8")
    told = python(site, "-m", "femstruct", "modes", "truss.yaml")
    assert told.returncode == 2
    expected = "parts.left: got a dict, expected a Part that femstruct_guest.strut_words.StrutSpec makes"
    assert expected in told.stderr


def test_a_command_names_the_broken_package_in_one_line(site: Path) -> None:
    installed(site, "some-guest", "[femstruct.language.parts]\nthing = gone:Thing\n")
    told = python(site, "-m", "femstruct", "modes", "truss.yaml")
    assert (told.returncode, told.stdout) == (2, "")
    assert told.stderr.count("\n") == 1
    assert "package some-guest 0.1, entry point thing = gone:Thing: got ModuleNotFoundError" in told.stderr


def test_the_words_of_another_package_may_be_imported_first(site: Path) -> None:
    """Its module imports ours, which look for kinds of other packages: that is no circle."""
    for module, name in (("strut_words", "StrutSpec"), ("barrier", "Barrier")):
        told = python(site, "-c", f"from femstruct_guest.{module} import {name}; import femstruct.laws.registry")
        assert (told.returncode, told.stderr) == (0, "")


def test_the_first_of_two_versions_on_the_path_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for folder, value in (("new", "collections:OrderedDict"), ("old", "gone:Thing")):
        installed(tmp_path / folder, "some-guest", f"[some.group]\nthing = {value}\n")
    for folder in ("old", "new"):
        monkeypatch.syspath_prepend(str(tmp_path / folder))
    assert [one.kind.__name__ for one in added_kinds("some.group", dict)] == ["OrderedDict"]


def test_nothing_is_added_where_nothing_is_installed() -> None:
    assert added_kinds("femstruct.laws", Law) == ()
