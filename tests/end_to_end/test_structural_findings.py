"""Structures that would silently give wrong numbers: each is told by `check`, `modes` and `run`, with its exit code."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from femstruct.errors import Finding, InputErrors
from femstruct.language.cases import read_study
from femstruct.language.models import read_model_file
from femstruct.model.mesher import mesh_structure
from femstruct.study.asked import Extent
from femstruct.workflow.bases import solve
from femstruct.workflow.check import inspect_file
from femstruct.workflow.modes import modes_of
from femstruct.workflow.run import run_study
from femstruct.workflow.structure_findings import structure_findings_after, structure_findings_before
from tests.data.command_line import femstruct

ROOT = Path(__file__).parents[2]
MODELS = ROOT / "models"
SLAB = """
materials:
  concrete: {E: 30 GPa, nu: 0.2, rho: 2400}
  steel: {E: 210 GPa, nu: 0.3, rho: 7850}
sections:
  bar: {shape: rectangle, width: 100 mm, height: 200 mm}
parts:
  slab: {type: plate, material: concrete, thickness: 180 mm, origin: [0,0,0], size: [5,4], in_plane: rigid, mesh: 0.5 m}
  # more
supports:
  walls: {on: slab, edge: all, fix: simple}
points:
  middle: {on: slab, at: center}
# end
"""
STUDY = """
model: slab.yaml
modes: {up_to: 200 Hz}
bodies: {ball: {mass: 2.5 kg, above: middle, drop_height: 1 m, contact: {type: linear, stiffness: 65 kN/m}}}
record: {middle.z: velocity}
time: {duration: 30 ms, sampling: 8 kHz, gravity: true}
"""
RIB = """
  ribs:
    type: frame
    material: steel
    section: bar
    lines: [[[0, 2, 0], [5, 2, 0]]]
    offsets: {start: [0, 0, -0.19], end: [0, 0, -0.19]}
joints:
  cast: {connect: [ribs, slab]}
"""
WALL = """
  wall:
    {type: plate, material: concrete, thickness: 200 mm, origin: [0, 1, -2], size: [5, 2], mesh: 0.5 m,
     normal: [0, -1, 0], x_direction: [1, 0, 0], in_plane: rigid}
joints:
  cast: {connect: [wall, slab]}
"""
MORE, END, WALLS = "  # more\n", "# end\n", "supports:\n  walls: {on: slab, edge: all, fix: simple}\n"
TWICE = "  slab2: {type: plate, material: concrete, thickness: 180 mm, origin: [0, 0, 0], size: [5, 4], mesh: 0.5 m}\n"
RAIL = "  rail: {type: frame, material: steel, section: bar, lines: [[[0, 1, 1], [5, 1, 1]], [[1, 1, 1], [2, 1, 1]]]}\n"
MASSES = "  m1: {type: mass, at: middle, mass: 50 kg}\n  m2: {type: mass, at: middle, mass: 50 kg}\n"
HEAVY = "  lump: {type: mass, at: middle, mass: 2e10 kg}\n"
LOOSE = "  loose: {type: frame, material: steel, section: bar, lines: [[[0, 1, 1], [5, 1, 1]]]}\n"

# what is replaced in the slab, and the code and a part of the message of what must be told, severe
SEVERE = {
    "a weight for a density": ("rho: 2400", "rho: 24000", "implausible-material", "rho 2447 kg/m^3?"),
    "MPa for GPa, concrete": ("E: 30 GPa", "E: 30 MPa", "implausible-material", "E 30 GPa?"),
    "MPa for GPa, steel": (
        "material: concrete", "material: soft",
        "implausible-material", "E 210 GPa?",
    ),
    "a slab of 0.18 mm": ("thickness: 180 mm", "thickness: 0.18 mm", "implausible-thickness", "180 mm?"),
    "ribs beside the slab": (MORE, RIB, "eccentric-bars", "times too stiff in bending"),
    "a wall below the slab": (MORE, WALL, "folded-plates", "bend in their planes from about"),
    "a part that nothing joins": (MORE, LOOSE, "parts-not-joined", "loose: no connection to slab. It can"),
    "two parts in one place": (MORE, TWICE, "overlapping-parts", "slab and slab2 overlap: 5 x 4 m"),
    "a line given twice": (MORE, RAIL, "overlapping-lines", "rail has a line twice, 1 straight piece of 1 m"),
    "a mass given twice": (MORE, MASSES, "duplicate-part", "m1 and m2 are one mass in one place"),
    "a mass of a million times the rest": (MORE, HEAVY, "one-mass-dominates", "lump has 2e+10 kg, all other parts"),
    "no support under gravity": (WALLS, "", "nothing-carries-weight", "carries 8640 kg:"),
    "all nodes held": ("mesh: 0.5 m", "mesh: [1, 1]", "nothing-moves", "the deflection of every node (4)"),
}  # fmt: skip
SOFT = "  steel: {E: 210 GPa, nu: 0.3, rho: 7850}\n", "  soft: {E: 210 MPa, nu: 0.3, rho: 7850}\n"


def files(folder: Path, old: str = "", new: str = "") -> Path:
    """The slab with a change, and a ball that falls on it."""
    assert old in SLAB
    text = SLAB.replace(old, new, 1)
    if "soft" in new:
        text = text.replace(*SOFT)
    (folder / "slab.yaml").write_text(text, encoding="utf-8")
    (folder / "slab.study.yaml").write_text(STUDY, encoding="utf-8")
    return folder / "slab.study.yaml"


def told(found: tuple[Finding, ...], code: str) -> list[Finding]:
    return [finding for finding in found if finding.code == code]


def before(study: Path) -> tuple[Finding, ...]:
    """What is said before any mode is solved for."""
    case = read_study(study).cases[0]
    structure = case.study.structure
    return structure_findings_before(
        structure, mesh_structure(structure), case.studies, up_to_hz=case.study.extent.up_to_hz
    )


def test_the_slab_as_it_is_has_no_severe_finding(tmp_path: Path) -> None:
    study = files(tmp_path)
    assert not [finding for finding in inspect_file(study).findings if finding.severe]
    assert not [finding for finding in before(study) if finding.severe]


@pytest.mark.parametrize("name", SEVERE)
def test_check_tells_it_and_so_does_what_needs_no_modes(name: str, tmp_path: Path) -> None:
    old, new, code, words = SEVERE[name]
    study = files(tmp_path, old, new)
    for found in (inspect_file(study).findings, before(study)):
        severe = [finding for finding in told(found, code) if finding.severe]
        assert severe, (name, [finding.code for finding in found])
        assert words in severe[0].message
        assert found[0].severe  # the worst first


@pytest.mark.parametrize("name", ["MPa for GPa, concrete", "ribs beside the slab", "no support under gravity"])
def test_a_run_has_them(name: str, tmp_path: Path) -> None:
    old, new, code, _ = SEVERE[name]
    result = run_study(read_study(files(tmp_path, old, new)))
    (case,) = result.cases.values()
    assert [finding.severe for finding in told(case.findings, code)] == [True]


def test_commands_leave_with_3_and_with_0(tmp_path: Path) -> None:
    files(tmp_path, MORE, RIB)
    for words in (("check", "slab.study.yaml"), ("modes", "slab.yaml", "--count", "5"), ("impact", "slab.study.yaml")):
        done = femstruct(*words, cwd=tmp_path)
        assert done.returncode == 3, done.stderr
        assert "forbids trust, eccentric-bars: ribs on slab: the bars are 190 mm from" in done.stdout
    files(tmp_path)
    done = femstruct("check", "slab.study.yaml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    files(tmp_path, MORE, RIB)
    slab = (tmp_path / "slab.yaml").read_text(encoding="utf-8")
    (tmp_path / "slab.yaml").write_text(slab.replace(" in_plane: rigid,", ""), encoding="utf-8")
    done = femstruct("modes", "slab.yaml", "--count", "5", cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    assert "in their own planes" not in done.stdout
    files(tmp_path)
    done = femstruct("modes", "slab.yaml", "--count", "5", cwd=tmp_path)
    assert done.returncode == 0
    assert "no mode of this model is missing below" in done.stdout
    assert "; its plates (slab) have none in their own planes" in done.stdout


# what is replaced, and the line and the words of what is refused
REFUSED = {
    "a density of a million": (
        "rho: 2400",
        "rho: 2.4e6",
        "slab.yaml:3:39: materials.concrete.rho: got 2.4e+06 kg/m^3",
    ),
    "a thickness of 210 m": ("thickness: 180 mm", "thickness: 210", "slab.yaml:8:54: parts.slab.thickness: got 210 m"),
    "nothing left to move": (
        "mesh: 0.5 m}",
        "mesh: [1, 1]}",
        "slab.yaml:10:1: supports: got every motion of slab held",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_mean_anything_leaves_with_2_and_its_line(name: str, tmp_path: Path) -> None:
    old, new, words = REFUSED[name]
    files(tmp_path, old, new)
    if "move" in name:
        text = (tmp_path / "slab.yaml").read_text(encoding="utf-8").replace("fix: simple", "fix: clamped")
        (tmp_path / "slab.yaml").write_text(text, encoding="utf-8")
    done = femstruct("check", "slab.yaml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith(words), done.stderr
    assert "Traceback" not in done.stderr


def test_a_study_joins_parts_by_its_contacts_and_by_bodies_between_them(tmp_path: Path) -> None:
    """A lid that a damper's spring and contact hold on the slab: through the body, and no longer without it."""
    lid = "  lid: {type: plate, material: steel, thickness: 20 mm, origin: [0, 0, 1], size: [5, 4], mesh: 1 m}\n"
    study = files(tmp_path, MORE, lid)
    text = (tmp_path / "slab.yaml").read_text(encoding="utf-8")
    points = "points:\n  under: {on: lid, at: center, side: below}\n"
    (tmp_path / "slab.yaml").write_text(text.replace("points:\n", points), encoding="utf-8")
    damper = "bodies:\n  damper: {mass: 10 kg, above: middle}\n"
    links = "links: {spring: {between: [damper, under], stiffness: 1 kN/m}}\n"
    contact = "contacts: {rest: {between: [damper, middle], law: {type: linear, stiffness: 1 MN/m}}}\n"
    rest = "model: slab.yaml\nmodes: {up_to: 200 Hz}\nrecord: {middle.z: velocity}\n"
    rest += "time: {duration: 1 ms, sampling: 8 kHz}\n"
    for extra, loose in ((links + contact, False), (links, True), (contact, True)):
        study.write_text(rest + damper + extra, encoding="utf-8")
        assert bool(told(before(study), "parts-not-joined")) == loose


@pytest.mark.parametrize(
    ("body", "code"),
    [("drop_height: 12 m", "high-drop"), ("speed: 60 m/s", "fast-body"), ("drop_height: 9 m", ""), ("speed: 40", "")],
)
def test_bodies_faster_than_most_that_is_tested_are_told(body: str, code: str, tmp_path: Path) -> None:
    study = files(tmp_path)
    study.write_text(STUDY.replace("drop_height: 1 m", body), encoding="utf-8")
    found = [finding.code for finding in before(study) if finding.code in ("high-drop", "fast-body")]
    assert found == [code] * bool(code)


@pytest.mark.parametrize(
    ("pad", "severe"), [("{normal: 1.6 GN/m^3, shear: 0}", False), ("{normal: 0 N/m^3, shear: 0.5 GN/m^3}", True)]
)
def test_a_layer_without_stiffness_in_a_direction_is_a_mechanism_and_no_nan(pad: str, severe: bool) -> None:
    """The anvil slides on its pad, or lifts off it: both were a nan in the convergence of its modes."""
    inspection = inspect_file(MODELS / "forging_hammer.study.yaml", (f"parts.pad.stiffness={pad}",))
    assert inspection.basis.n_rigid == 3
    assert (inspection.basis.residual_norm[3:] < 1e-10).all()  # rounding
    (found,) = told(inspection.findings, "mechanism")
    assert found.severe == severe  # under gravity it falls where nothing is below it
    assert found.values == {"mechanisms": 3, "rigid_modes": 3}


ON_SPRINGS = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts:
  slab: {type: plate, material: concrete, thickness: 0.2, origin: [0,0,0], size: [1.9,1.8],
         mesh: [6,6], in_plane: rigid}
  load: {type: mass, on: slab, mass: 32 kg/m^2, region: {rectangle: [1.016, 0.697], at: [0.698, 0.635]}}
  ka: {type: spring, between: [a, ground], stiffness: {x: 1e5, y: 1e5, z: 1e5}}
  kb: {type: spring, between: [b, ground], stiffness: {x: 1e5, y: 1e5, z: 1e5}}
  kc: {type: spring, between: [c, ground], stiffness: {x: 1e5, y: 1e5, z: 1e5}}
points:
  a: {on: slab, at: [AT, 0.275]}
  b: {on: slab, at: [1.617, 0.183]}
  c: {on: slab, at: [0.571, 1.65]}
"""


@pytest.mark.parametrize(("at", "severe"), [("0.19", []), ("0.2", []), ("0.1903", [True]), ("0.1901", [True])])
def test_lines_of_a_plate_that_nearly_meet_are_told(at: str, severe: list[bool], tmp_path: Path) -> None:
    """Cells of 0.1 mm beside springs: 1.65 Hz became 0 Hz, 2.56 Hz became 2.36 Hz, told as a mechanism."""
    (tmp_path / "slab.yaml").write_text(ON_SPRINGS.replace("AT", at), encoding="utf-8")
    basis = solve(read_model_file(tmp_path / "slab.yaml").structure, Extent(count=6)).basis
    assert [one.severe for one in told(basis.findings, "lost-in-rounding")] == severe
    assert bool(severe) == (basis.n_rigid > 0)


def test_springs_of_a_thousandth_sag_far(tmp_path: Path) -> None:
    soft = "parts.isolators.stiffness={x: 7.7 kN/m, y: 7.7 kN/m, z: 11 kN/m}"
    for gravity in ("true", "false"):  # the slip of a unit is one without weight, too
        study = (soft, f"time.gravity={gravity}")
        inspection = inspect_file(MODELS / "forging_hammer.study.yaml", study)
        (found,) = told(inspection.findings, "sags-far")
        assert found.values["sag_m"] == pytest.approx(70e3 * 9.80665 / 44e3, rel=1e-3)  # m g / k, the pad's 0.17 mm


def test_the_rod_is_judged_as_other_materials_are(tmp_path: Path) -> None:
    text = (MODELS / "steel_rod.yaml").read_text(encoding="utf-8")
    (tmp_path / "rod.yaml").write_text(text.replace("E: 200 GPa", "E: 200 MPa"), encoding="utf-8")
    for path, codes in ((MODELS / "steel_rod.yaml", []), (tmp_path / "rod.yaml", ["implausible-material"])):
        structure = read_model_file(path).structure
        assert [finding.code for finding in structure_findings_before(structure, None)] == codes


def test_meshes_of_all_modes_are_judged_by_the_highest(tmp_path: Path) -> None:
    """All modes there are: no wave of infinite frequency, nor one of none for rigid modes alone."""
    files(tmp_path, "mesh: 0.5 m", "mesh: [1, 1]")
    structure = read_model_file(tmp_path / "slab.yaml").structure
    solved = solve(structure, Extent(count=30))
    found = structure_findings_after(solved.model, solved.basis)
    top = solved.basis.frequency_hz.max()
    assert any(f"the bending wavelength at {top:.4g} Hz" in finding.message for finding in told(found, "coarse-mesh"))


# every shipped model and study: nothing severe
SHIPPED = [  # clt_floor takes 2 s to mesh
    pytest.param(path, marks=pytest.mark.stress) if path.name.startswith("clt_floor.") else path
    for path in sorted(MODELS.glob("*.yaml"))
]


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.name)
def test_shipped_files_have_nothing_severe_before_their_modes(path: Path) -> None:
    if path.name.endswith(".study.yaml"):
        first = read_study(path).cases[0]
        cases = [(first.study.structure, first.studies, first.study.extent.up_to_hz)]
    else:
        cases = [(read_model_file(path).structure, (), None)]
    for structure, studies, up_to_hz in cases:
        model = mesh_structure(structure) if hasattr(structure, "parts") else None
        found = structure_findings_before(structure, model, studies, up_to_hz)
        assert {finding.code for finding in found if finding.severe} == set()


def test_the_table_of_modes_says_which_plates_have_none_in_their_planes() -> None:
    assert modes_of(MODELS / "portal.yaml", Extent(count=3))["rigid_in_plane"] == []
    assert modes_of(MODELS / "press.yaml", Extent(count=3))["rigid_in_plane"] == []
    assert modes_of(MODELS / "floor_frame_slab.yaml", Extent(count=3))["rigid_in_plane"] == ["floor", "slab"]


def test_refused_with_all_lines_at_once(tmp_path: Path) -> None:
    files(tmp_path)
    text = (tmp_path / "slab.yaml").read_text(encoding="utf-8")
    text = text.replace("rho: 2400", "rho: 2.4e6").replace("rho: 7850", "rho: 7.85e6")
    (tmp_path / "slab.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(InputErrors) as refused:
        read_model_file(tmp_path / "slab.yaml")
    assert len(refused.value.errors) == 2


@pytest.mark.parametrize(
    ("supports", "room", "severe"),
    [
        ("", "levels: [ISO 16283-2]", [True]),
        ("", "coupling: one-way", [False]),
        (WALLS, "levels: [ISO 16283-2]", []),
        ("supports:\n  walls: {on: slab, edge: all, stiffness: {z: 5 MN/m^2}}\n", "coupling: one-way", []),
    ],
    ids=["rated", "heard", "held", "on springs, free in its plane"],
)
def test_a_floor_that_nothing_holds_is_said_where_a_room_hears_it(
    tmp_path: Path, supports: str, room: str, severe: list[bool]
) -> None:
    """Without gravity a forgotten support gave a rating, and exit 0."""
    study = files(tmp_path, WALLS, supports)
    model = tmp_path / "slab.yaml"
    model.write_text(f"{model.read_text(encoding='utf-8')}surfaces: {{under: {{on: slab, side: below}}}}\n", "utf-8")
    heard = "receivers: {a: [1, 1, 1.2], b: [2, 3, 1.5], c: [4, 1, 1], d: [4, 3, 1.3]}, losses: {t60: 0.5 s}"
    rooms = f"rooms: {{bed: {{size: [5, 4, 2.5], under: under, {heard}, {room}}}}}\n"
    ball = "{source: rubber ball, above: middle}"
    text = re.sub(r"\{ball: .*\}", f"{{ball: {ball}}}", STUDY).replace("gravity: true", "gravity: false")
    study.write_text(text + rooms, encoding="utf-8")
    found = told(before(study), "nothing-holds-it")
    assert [one.severe for one in found] == severe
    assert all("holds its 8640 kg, and it moves the air of bed" in one.message for one in found)


@pytest.mark.parametrize(
    ("height", "levels", "near"), [(2.5, True, True), (2.1, True, True), (1.9, True, False), (2.5, False, False)]
)
def test_a_microphone_at_the_ceiling_of_a_rated_room_is_named(
    tmp_path: Path, height: float, levels: bool, near: bool
) -> None:
    """In the plane of the ceiling it was rated as any other. The ceiling is 2.5 m above the floor of the room."""
    study = files(tmp_path)
    model = tmp_path / "slab.yaml"
    model.write_text(f"{model.read_text(encoding='utf-8')}surfaces: {{under: {{on: slab, side: below}}}}\n", "utf-8")
    room = f"receivers: {{a: [1, 1, {height}], b: [2, 3, 1.5], c: [4, 1, 1], d: [4, 3, 1.3]}}, losses: {{t60: 0.5 s}}"
    rated = ", levels: [ISO 16283-2]" if levels else ""
    text = re.sub(r"\{ball: .*\}", "{ball: {source: rubber ball, above: middle}}", STUDY)
    study.write_text(f"{text}rooms: {{bed: {{size: [5, 4, 2.5], under: under, {room}{rated}}}}}\n", encoding="utf-8")
    found = told(inspect_file(study).findings, "microphone-near-surface")
    assert len(found) == near
    if near:
        assert found[0].values["distance_m"] == pytest.approx(2.5 - height, abs=1e-9)  # rounding
        assert found[0].message.startswith("bed: a: nearer than 0.5 m to a surface")
