"""Cavities that are written wrongly: one line each, at its place; and those that can be doubted."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from femstruct.errors import FemstructError, InputErrors
from femstruct.language.models import read_model_file
from femstruct.model.mesher import mesh_structure
from femstruct.model.structure import Structure
from femstruct.study.asked import Extent
from femstruct.workflow.check import inspect_file
from femstruct.workflow.exchange import Ending, export_source
from femstruct.workflow.model_answers import frf_of
from femstruct.workflow.modes import complex_modes_of, modes_of
from femstruct.workflow.structure_findings import structure_findings_before

MODEL = """\
title: two plates
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts:
  upper: {type: plate, material: steel, thickness: 1 mm, origin: [0, 0, 0.1], size: [0.6, 0.5], mesh: [6, 5]}
  lower: {type: plate, material: steel, thickness: 1 mm, origin: [0, 0, 0], size: [0.6, 0.5], mesh: [6, 5]}
surfaces:
  under: {on: upper, side: below}
  top: {on: lower, side: above}
  face: {on: lower, side: below}
cavities:
  void: {between: [under, top], depth: 100 mm, fill: {flow_resistivity: 10 kPa*s/m^2, density: 40 kg/m^3}}
supports:
  rim: {on: upper, edge: all, fix: simple}
  edge: {on: lower, edge: all, fix: simple}
points: {P: {on: upper, at: center}}
damping: {loss_factor: 2 %}
"""
FILL = "{flow_resistivity: 10 kPa*s/m^2, density: 40 kg/m^3}"
# what is replaced, by what, text whose position is told, what is said there
WRITTEN = {
    "unit": (
        "10 kPa*s/m^2",
        "10 kPa*s/m",
        "10 kPa*s/m,",
        r"flow_resistivity: .*expected a flow resistivity \[Pa\*s/m\^2\]",
    ),
    "thousand": ("10 kPa*s/m^2", "10", "10,", r"flow_resistivity: got 10, .*mineral wool has 5 to 30 kPa"),
    "fibres": ("density: 40 kg", "density: 2500 kg", "2500 kg", r"density: .*not of its fibres"),
    "frame": ("40 kg/m^3}", "40 kg/m^3, frame: rigid}", "rigid", r"frame: got 'rigid'.*limp"),
    "surface": ("[under, top]", "[under, topp]", "topp", r"between\[1\]: got 'topp'.*'top'"),
    "twice": ("[under, top]", "[top, top]", "[top, top]", r"between: got 'top' twice, expected two surfaces"),
    "depth": ("depth: 100 mm, ", "", "void:", r"depth: got nothing, expected 'depth'"),
    "negative": ("depth: 100 mm", "depth: -100 mm", "-100 mm", r"depth: got '-100 mm'"),
    "thick": ("40 kg/m^3}", "40 kg/m^3, thickness: 20 cm}", "20 cm", r"thickness: got 0\.2 m of wool .* 0\.1 m deep"),
    "law": (
        FILL,
        "{law: Delany-Bazley, flow_resistivity: 10 kPa*s/m^2, density: 40}",
        "law:",
        r"got the unknown key 'law'",
    ),
    "name": (
        "  void:",
        "  top:",
        "top: {between",
        r"cavities\.top: got 'top', which names one of the surfaces already",
    ),
    "wool": (FILL, "{like: glas wool 14 kg/m^3}", "glas", r"fill\.like: got 'glas wool.*did you mean 'glass wool 14"),
    "no number": (FILL, "{like: hemp fibres}", "hemp", r"fill\.like: got 'hemp fibres'.*femstruct materials wool"),
    "misspelt key": (FILL, "{lik: glass wool 14 kg/m^3}", "lik:", r"unknown key 'lik'.*did you mean 'like'"),
    "axis": (FILL, FILL + ", bays: {across: z, at: 0.3}", "z,", r"bays\.across: got 'z'.*x.*y"),
}
PLACED = {
    "behind": ("[under, top]", "[under, face]", r"'face' with normal .* not opposite to 'under'"),
    "beside": ("origin: [0, 0, 0.1]", "origin: [0.5, 0, 0.1]", r"share 0\.1 x 0\.5 m .*one over the other"),
    "far side": ("origin: [0, 0, 0.1]", "origin: [0, 0, -0.1]", r"'top' 0\.1 m behind 'under'"),
    "outside": (FILL, FILL + ", bays: {across: x, at: [0.3, 0.7]}", r"bays\.at: got 0\.3 m, 0\.7 m, .* 0 and 0\.6 m"),
    "broad": (FILL, FILL + ", bays: {across: x, at: 0.3, width: 0.7}", r"bays\.width: got 0\.7 m, expected less than"),
    "narrow": (FILL, FILL + ", bays: {across: x, at: [0.30, 0.31]}", r"bays\.at: got a bay of 0\.01 x 0\.5 m without"),
}
DOUBTED = {
    "cavity-depth": ("depth: 100 mm", "depth: 60 mm"),
    "cavity-sizes-differ": ("[0, 0, 0], size: [0.6, 0.5]", "[0, 0, 0], size: [0.5, 0.5]"),
    "wool-out-of-range": ("10 kPa*s/m^2", "60 kPa*s/m^2"),
    "held-wool": ("40 kg/m^3}", "40 kg/m^3, frame: held}"),
    "cavity-modes-few": (FILL, FILL + ", up_to: 60 Hz"),
    "cavity-coupling": ("two plates", "two plates with wool"),
}


def written(tmp_path: Path, old: str = "", new: str = "") -> Path:
    assert old in MODEL
    file = tmp_path / "model.yaml"
    file.write_text(MODEL.replace(old, new, 1), encoding="utf-8")
    return file


@pytest.mark.parametrize("mistake", WRITTEN)
def test_a_mistake_is_told_at_its_place(tmp_path: Path, mistake: str) -> None:
    old, new, at, says = WRITTEN[mistake]
    file = written(tmp_path, old, new)
    with pytest.raises(InputErrors) as caught:
        read_model_file(file)
    lines = str(caught.value).splitlines()
    text = file.read_text(encoding="utf-8").splitlines()
    number = next(i for i, line in enumerate(text) if at in line and "cavities" not in line and i > 9)
    assert len(lines) == 1
    assert lines[0].startswith(f"{file}:{number + 1}:{text[number].index(at) + 1}: ")
    assert re.search(says, lines[0]), lines[0]


@pytest.mark.parametrize("mistake", PLACED)
def test_a_cavity_that_cannot_be_is_refused_at_its_line(tmp_path: Path, mistake: str) -> None:
    old, new, says = PLACED[mistake]
    with pytest.raises(FemstructError) as caught:
        modes_of(written(tmp_path, old, new), Extent(count=3))
    (line,) = str(caught.value).splitlines()
    assert "model.yaml:11:" in line, line
    assert re.search(says, line), line


@pytest.mark.parametrize("code", DOUBTED)
def test_a_cavity_that_can_be_doubted_is(tmp_path: Path, code: str) -> None:
    told = {one.code for one in inspect_file(written(tmp_path, *DOUBTED[code])).findings}
    assert code in told
    clean = {one.code for one in inspect_file(written(tmp_path)).findings}
    assert "parts-not-joined" not in clean  # the air joins them
    assert code not in clean or code == "cavity-coupling"


def test_air_that_is_in_two_cavities_is_refused_and_neighbours_are_not(tmp_path: Path) -> None:
    """One over all of another; and two halves, 40 mm of which are in common, over one surface."""
    again = "  more: {between: [under, top], depth: 100 mm}\nsupports:"
    told = r"12:\d+: cavities\.more\.between: got 'under', 0\.3 m\^2 .* of 'void' already"
    with pytest.raises(InputErrors, match=told):
        modes_of(written(tmp_path, "supports:", again), Extent(count=3))
    halves = "".join(
        f"  {name}: {{on: upper, side: below, region: {{rectangle: [0.32 m, 0.5 m], at: [{x} m, 0.25 m]}}}}\n"
        for name, x in (("left", 0.16), ("right", 0.44))
    )
    text = MODEL.replace("cavities:", f"{halves}cavities:").replace("[under, top]", "[left, top]")
    text = text.replace("supports:", "  more: {between: [right, top], depth: 100 mm}\nsupports:")
    (tmp_path / "model.yaml").write_text(text, encoding="utf-8")
    assert modes_of(tmp_path / "model.yaml", Extent(count=3))["frequency_hz"]


# where a frame runs, the bays of the cavity, and the finding
JOISTS = {
    "crosses": ("y", 0.2, "", "cavity-crossed", "joist runs through the cavity void"),
    "at the edge": ("y", 0.0, "", "", ""),
    "closes": ("y", 0.2, ", bays: {across: y, at: 0.2}", "", ""),
    "closes with its width": ("y", 0.2, ", bays: {across: y, at: 0.22, width: 50 mm}", "", ""),
    "beside": ("y", 0.2, ", bays: {across: y, at: [0.2, 0.3]}", "bays-beside-joists",
        "void: no bar of joist lies where its bays end, at y = 0.3 m from the corner of the cavity; bars that close it "
        "lie at y = 0.2 m. Is 'across' the other axis"),
    "the other axis": ("y", 0.2, ", bays: {across: x, at: 0.2}", "bays-beside-joists", "; no bar closes it across x. "),
    "another corner": ("x", 0.2, ", bays: {across: x, at: 0.4}", "bays-beside-joists", "lie at x = 0.2 m"),
    "no bar there": ("y", 0.0, ", bays: {across: x, at: 0.2}", "", ""),
}  # fmt: skip


@pytest.mark.parametrize("name", JOISTS)
def test_joists_that_cross_a_cavity_or_do_not_lie_at_its_bays_are_found(tmp_path: Path, name: str) -> None:
    across, at, bays, code, says = JOISTS[name]
    ends = f"[0, {at}, 0.1], [0.6, {at}, 0.1]" if across == "y" else f"[{at}, 0, 0.1], [{at}, 0.5, 0.1]"
    frame = (
        f"  joist: {{type: frame, material: steel, section: bar, lines: [[{ends}]], "
        "offsets: {start: [0, 0, -30 mm], end: [0, 0, -30 mm]}, mesh: 0.1}\nsurfaces:"
    )
    text = MODEL.replace("surfaces:", frame, 1).replace(FILL, FILL + bays)
    text = text.replace("parts:", "sections: {bar: {shape: rectangle, width: 10 mm, height: 60 mm}}\nparts:", 1)
    text = text.replace("supports:", "joints: {weld: {connect: [joist, upper]}}\nsupports:", 1)
    (tmp_path / "model.yaml").write_text(text, encoding="utf-8")
    structure = read_model_file(tmp_path / "model.yaml").structure
    assert isinstance(structure, Structure)
    findings = structure_findings_before(structure, mesh_structure(structure))
    told = {one.code: one.message for one in findings if one.code in ("cavity-crossed", "bays-beside-joists")}
    assert list(told) == ([code] if code else [])
    assert says in told.get(code, ""), told


def test_wool_of_the_library_is_wool_with_its_numbers(tmp_path: Path) -> None:
    """Isover Piano as the library has it; what is given besides stands in place of it."""
    for fill, flow, density, thickness in (
        ("{like: glass wool 14 kg/m^3}", 7e3, 14.0, None),
        ("{like: glass wool 14 kg/m^3, density: 20, thickness: 50 mm}", 7e3, 20.0, 0.05),
    ):
        structure = read_model_file(written(tmp_path, FILL, fill)).structure
        assert isinstance(structure, Structure)
        wool = structure.cavities[0].fill
        assert wool is not None and wool.like.startswith("glass wool 14 kg/m^3: Isover")
        assert (wool.flow_resistivity, wool.density, wool.thickness, wool.frame) == (flow, density, thickness, "limp")


def test_what_knows_the_structure_alone_refuses_its_air(tmp_path: Path) -> None:
    file = written(tmp_path)
    with pytest.raises(FemstructError, match=r"--complex: got a model with cavities"):
        complex_modes_of(file, Extent(up_to_hz=100.0))
    with pytest.raises(FemstructError, match=r"--method: got 'direct' of a model with cavities"):
        frf_of(file, "P.z", "P.z", "10 Hz:20 Hz", "5 Hz", "", "direct")
    formats: tuple[Ending, ...] = ("npz", "mtx")
    for to in formats:
        with pytest.raises(FemstructError, match=r"got a model with cavities, expected a structure without air"):
            export_source(file, to, tmp_path, None, (), "", lambda line: None)


THICK = """\
title: void of {depth}
materials: {{c: {{E: 30 GPa, nu: 0.2, rho: 2400}}, g: {{E: 2.5 GPa, nu: 0.3, rho: 900}}}}
parts:
  upper: {upper}
  lower: {lower}
surfaces: {{under: {{on: upper, side: below}}, top: {{on: lower, side: above}}}}
cavities: {{void: {{between: [under, top], depth: {depth}}}}}
supports: {{rim: {{on: upper, fix: [x, y, z, rx, ry]}}, edge: {{on: lower, fix: [x, y, z, rx, ry]}}}}
damping: {{loss_factor: 2 %}}
"""
OUTLINE = "outline: [[0, 0], [2, 0], [2, 1], [0, 1]], mesh: 250 mm"
UPPER = {  # faces 100 mm above the lower part's
    "plate": "{type: plate, material: c, thickness: 300 mm, origin: [0, 0, 2.75], size: [2, 1], mesh: 250 mm}",
    "slab": f"{{type: slab, material: c, thickness: 300 mm, origin: [0, 0, 2.75], {OUTLINE}}}",
    "slab, raised": f"{{type: slab, material: c, thickness: 300 mm, origin: [0, 0, 2.65], offset: 0.1, {OUTLINE}}}",
    "slab, turned": (
        "{type: slab, material: c, thickness: 300 mm, origin: [0, 1, 2.8], offset: 50 mm, normal: [0, 0, -1], "
        f"x_direction: [1, 0, 0], {OUTLINE}}}"
    ),
}
LOWER = "{type: plate, material: g, thickness: 25 mm, origin: [0, 0, 2.4875], size: [2, 1], mesh: 250 mm}"


@pytest.mark.parametrize("upper", UPPER)
def test_a_cavity_is_as_deep_as_its_faces_are_apart(tmp_path: Path, upper: str) -> None:
    """Its mid-surfaces are 262.5 mm apart, which was said of a void of the right depth."""
    told = {}
    for depth in ("100 mm", "262.5 mm"):
        file = tmp_path / "model.yaml"
        file.write_text(THICK.format(depth=depth, upper=UPPER[upper], lower=LOWER), encoding="utf-8")
        structure = read_model_file(file).structure
        assert isinstance(structure, Structure)
        found = structure_findings_before(structure, mesh_structure(structure))
        told[depth] = [one for one in found if one.code == "cavity-depth"]
    assert not told["100 mm"]
    (finding,) = told["262.5 mm"]
    assert finding.values["distance_m"] == pytest.approx(0.1, rel=1e-9)  # rounding of coordinates
    assert "are 100 mm apart, from face to face" in finding.message


def test_faces_that_overlap_are_told(tmp_path: Path) -> None:
    file = tmp_path / "model.yaml"
    low = UPPER["plate"].replace("2.75", "2.5875")
    file.write_text(THICK.format(depth="100 mm", upper=low, lower=LOWER), encoding="utf-8")
    structure = read_model_file(file).structure
    assert isinstance(structure, Structure)
    found = structure_findings_before(structure, mesh_structure(structure))
    (finding,) = (one for one in found if one.code == "cavity-depth")
    assert "its surfaces overlap by 62.5 mm" in finding.message
