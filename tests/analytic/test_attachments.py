"""Supports, rigid links and masses that a mesh file states, against the same model written by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import femstruct as fs
from femstruct.model.unused import unused_findings
from femstruct.workflow.structure_findings import structure_findings_before

SIDE, CELLS = 600.0, 6  # mm, and how many cells along each side
HUB = (250.0, 300.0, 80.0)  # middle of the spider, off the plate
MASS, OFFSET, MOMENTS = 0.012, (10.0, -20.0, 50.0), (30.0, 42.0, 50.0)  # t, mm, t mm^2
STEEL = "materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}\n"
PLATE = "  plate: {type: shell, mesh: a.bdf, scale: mm, material: steel}\n"
REST = "  rest: {type: attachments, mesh: a.bdf, scale: mm, take: [supports, links, masses]}\n"


def number(i: int, j: int) -> int:
    return 1 + i + (CELLS + 1) * j


LEGS = [number(i, j) for i in (2, 3) for j in (2, 3, 4)]
RIM = [number(i, j) for i in (0, CELLS) for j in range(CELLS + 1)]


def bulk(follows: str = "123456", more: str = "", control: str = "") -> str:
    """A plate of 8 mm of steel, held along two sides; a spider to a mass beside its middle, in N, mm, t."""
    step = SIDE / CELLS
    lines = ["SOL 103", *([control] if control else []), "BEGIN BULK"]
    lines += [f"GRID,{number(i, j)},,{i * step},{j * step},0." for j in range(CELLS + 1) for i in range(CELLS + 1)]
    lines += [f"GRID,900,,{HUB[0]},{HUB[1]},{HUB[2]}"]
    corners = ((0, 0), (1, 0), (1, 1), (0, 1))
    for j in range(CELLS):
        for i in range(CELLS):
            nodes = ",".join(str(number(i + a, j + b)) for a, b in corners)
            lines.append(f"CQUAD4,{1001 + i + CELLS * j},1,{nodes}")
    lines += ["PSHELL,1,1,8.,1,,1", "MAT1,1,210000.,,.3,7.85-9"]
    for at in range(0, len(RIM), 6):
        lines.append("SPC1,4,1234," + ",".join(map(str, RIM[at : at + 5])))
    lines += [f"SPC1,4,1234,{node}" for node in RIM[5::6]]
    lines.append(f"RBE2,801,900,{follows}," + ",".join(map(str, LEGS[:5])) + ",+")
    lines.append("+," + ",".join(map(str, LEGS[5:])))
    x, y, z = OFFSET
    lines.append(f"CONM2,802,900,0,{MASS},{x},{y},{z},,+")
    lines.append(f"+,{MOMENTS[0]},,{MOMENTS[1]},,,{MOMENTS[2]}")
    lines += [f"SET1,5,{','.join(map(str, LEGS))}", f"SET1,6,{','.join(map(str, RIM[:7]))}"]
    lines += [f"SET1,7,{','.join(map(str, RIM[7:]))}", *([more] if more else []), "ENDDATA"]
    return "\n".join(lines) + "\n"


def model(folder: Path, text: str, parts: str, rest: str = "") -> fs.Model:
    (folder / "a.bdf").write_text(text, encoding="utf-8")
    (folder / "a.yaml").write_text(STEEL + "parts:\n" + parts + rest, encoding="utf-8")
    return fs.read_model(folder / "a.yaml")


def frequencies(found: fs.Model, count: int = 10) -> np.ndarray:
    basis = fs.modal_basis(fs.assemble(found), count=count)
    return np.asarray(basis.frequency_hz[basis.modes])


def by_hand(folder: Path, directions: str = "") -> fs.Model:
    """The mass as a block with its centre where the file has it, its point a spider's middle."""
    hub, off = 1e-3 * np.array(HUB), 1e-3 * np.array(OFFSET)
    moments = ", ".join(f"{1e-3 * one} kg*m^2" for one in MOMENTS)
    low = hub - 0.1
    parts = PLATE + (
        f"  lump: {{type: block, mass: {1e3 * MASS}, origin: {low.tolist()}, size: [0.2, 0.2, 0.2], "
        f"center: {(0.1 + off).tolist()}, inertia: [{moments}]}}\n"
    )
    rest = "points: {hub: {on: lump, at: [0.1, 0.1, 0.1]}}\n"
    rest += f"constraints: {{spider: {{rigid: hub, to: {{on: plate, set: SET 5}}{directions}}}}}\n"
    fix = "fix: [x, y, z, rx]"
    rest += f"supports: {{one: {{on: plate, set: SET 6, {fix}}}, two: {{on: plate, set: SET 7, {fix}}}}}\n"
    return model(folder, bulk(), parts, rest)


@pytest.mark.parametrize(("follows", "directions"), [("123456", ""), ("123", ", directions: [x, y, z]")])
def test_what_the_file_states_is_what_is_written_by_hand(follows: str, directions: str, tmp_path: Path) -> None:
    taken = model(tmp_path, bulk(follows), PLATE + REST)
    # rounding: the same matrices, eliminated in another order
    np.testing.assert_allclose(frequencies(taken), frequencies(by_hand(tmp_path, directions)), rtol=1e-9)
    assert taken.parts["rest"].places.tolist() == [pytest.approx([1e-3 * one for one in HUB])]
    # rounding
    assert fs.assemble(taken).total_mass == pytest.approx(0.6**2 * 8e-3 * 7850 + 1e3 * MASS, rel=1e-12)


def test_an_average_is_what_is_written_by_hand(tmp_path: Path) -> None:
    """RBE3 with a node of twice the weight of the others: as if it were named twice."""
    lines = bulk().splitlines()
    first = next(at for at, one in enumerate(lines) if one.startswith("RBE2"))
    heavy, *others = LEGS
    first_two, later = ",".join(map(str, others[:2])), ",".join(map(str, others[2:]))
    card = [f"RBE3,801,,900,123456,1.0,123,{first_two},+", f"+,{later},2.0,123,{heavy}"]
    text = "\n".join([*lines[:first], *card, *lines[first + 2 :]]) + "\n"
    taken = model(tmp_path, text, PLATE + REST)
    step = 1e-3 * SIDE / CELLS
    spots = {f"p{n}": [(n - 1) % (CELLS + 1) * step, (n - 1) // (CELLS + 1) * step, 0.0] for n in LEGS}
    spots["again"] = spots[f"p{heavy}"]
    hub, off = 1e-3 * np.array(HUB), 1e-3 * np.array(OFFSET)
    moments = ", ".join(f"{1e-3 * one} kg*m^2" for one in MOMENTS)
    lump = f"  lump: {{type: block, mass: {1e3 * MASS}, origin: {(hub - 0.1).tolist()}, size: [0.2, 0.2, 0.2], "
    lump += f"center: {(0.1 + off).tolist()}, inertia: [{moments}]}}\n"
    points = ", ".join(f"{name}: {{on: plate, at: {at}}}" for name, at in spots.items())
    rest = f"points: {{hub: {{on: lump, at: [0.1, 0.1, 0.1]}}, {points}}}\n"
    rest += f"constraints: {{mean: {{average: hub, of: [{', '.join(spots)}]}}}}\n"
    fix = "fix: [x, y, z, rx]"
    rest += f"supports: {{one: {{on: plate, set: SET 6, {fix}}}, two: {{on: plate, set: SET 7, {fix}}}}}\n"
    by_points = frequencies(model(tmp_path, text, PLATE + lump, rest))
    np.testing.assert_allclose(frequencies(taken), by_points, rtol=1e-9)  # rounding
    rigid = frequencies(model(tmp_path, bulk(), PLATE + REST))
    assert np.abs(by_points / rigid - 1.0).max() > 1e-2
    line = text.replace(card[0], f"RBE3,801,,900,123456,1.0,123,{RIM[0]},{RIM[2]},+").replace(card[1], f"+,{RIM[4]}")
    with pytest.raises(fs.InputError, match=r"parts\.rest.*: got the mean motion of 3 nodes at node 900, which do not"):
        model(tmp_path, line, PLATE + REST)


def test_a_rotation_that_nothing_uses_is_no_mechanism(tmp_path: Path) -> None:
    """A mass without moments at a node that follows the mean shift of others alone, or their rotation, too."""
    lines = [one for one in bulk().splitlines() if not one.startswith(("RBE2", "CONM2", "+,"))]
    later = ",".join(map(str, LEGS[2:]))

    def found(follows: str) -> fs.Model:
        cards = f"RBE3,801,,900,{follows},1.0,123,{LEGS[0]},{LEGS[1]},+\n+,{later}\nCONM2,802,900,0,{MASS}"
        return model(tmp_path, "\n".join(lines).replace("ENDDATA", cards + "\nENDDATA") + "\n", PLATE + REST)

    alone, turning = (frequencies(found(follows)) for follows in ("123", "123456"))
    np.testing.assert_allclose(alone, turning, rtol=1e-9)  # rounding


def test_each_of_them_matters(tmp_path: Path) -> None:
    whole = frequencies(model(tmp_path, bulk(), PLATE + REST))
    for less in ("[supports, links]", "[supports]"):
        other = frequencies(model(tmp_path, bulk(), PLATE + REST.replace("[supports, links, masses]", less)))
        assert np.abs(other / whole - 1.0).max() > 0.05


def test_products_of_inertia_have_the_signs_of_the_card(tmp_path: Path) -> None:
    """A body turned by 30 degrees about z: its tensor has Ixy = integral of x y dm, as CONM2 has I21."""
    a, b, c = MOMENTS
    turn = np.radians(30.0)
    s, t = np.sin(turn), np.cos(turn)
    R = np.array([[t, -s, 0.0], [s, t, 0.0], [0.0, 0.0, 1.0]])
    tensor = R @ np.diag([a, b, c]) @ R.T
    text = bulk().replace(f"+,{a},,{b},,,{c}", f"+,{tensor[0, 0]},{-tensor[0, 1]},{tensor[1, 1]},,,{c}")
    taken = frequencies(model(tmp_path, text, PLATE + REST))
    moments = ", ".join(f"{1e-3 * one}" for one in (tensor[0, 0], tensor[1, 1], c, -tensor[0, 1], 0.0, 0.0))
    parts = PLATE + REST.replace(", masses", "")
    parts += f"  lump: {{type: inertia, at: hub, mass: {1e3 * MASS}, inertia: [{moments}], "
    parts += f"offset: {[1e-3 * one for one in OFFSET]}}}\n"
    hand = model(tmp_path, text, parts, f"points: {{hub: {{on: rest, at: {[1e-3 * one for one in HUB]}}}}}\n")
    np.testing.assert_allclose(taken, frequencies(hand), rtol=1e-9)  # rounding
    other = text.replace(f",{-tensor[0, 1]},", f",{tensor[0, 1]},")
    assert np.abs(frequencies(model(tmp_path, other, PLATE + REST)) / taken - 1.0).max() > 1e-4


def test_a_spider_on_a_solid_turns_with_it(tmp_path: Path) -> None:
    """A node of a solid has no rotation; one that leads a link has."""
    corners = [(x, y, z) for z in (0.0, 0.1) for y in (0.0, 0.1, 0.2) for x in (0.0, 0.1, 0.2)]
    lines = ["BEGIN BULK"] + [f"GRID,{n},,{x},{y},{z}" for n, (x, y, z) in enumerate(corners, 1)]
    for at, first in enumerate((1, 2, 4, 5), 1):
        low = [first, first + 1, first + 4, first + 3]
        lines.append(f"CHEXA,{at},1,{','.join(map(str, low))},{low[0] + 9},{low[1] + 9},+")
        lines.append(f"+,{low[2] + 9},{low[3] + 9}")
    lines += ["PSOLID,1,1", "MAT1,1,2.1+11,,.3,7850.", "SPC1,1,123456,1,3,7,9"]
    lines += ["RBE2,50,14,123456,10,12,16,18", "CONM2,60,14,0,300.,0.,0.,.25,,+", "+,4.,,5.,,,6."]
    (tmp_path / "a.bdf").write_text("\n".join(lines) + "\nENDDATA\n", encoding="utf-8")
    parts = "parts:\n  body: {type: solid, mesh: a.bdf, material: steel}\n"
    rest = "  rest: {type: attachments, mesh: a.bdf, take: [supports, links, masses]}\n"
    (tmp_path / "a.yaml").write_text(STEEL + parts + rest, encoding="utf-8")
    taken = fs.read_model(tmp_path / "a.yaml")
    block = "  lump: {type: block, mass: 300, origin: [0, 0, 0], size: [0.2, 0.2, 0.4], center: [0.1, 0.1, 0.35], "
    block += "inertia: [4, 5, 6]}\n"
    points = ", ".join(f"p{n}: {{on: body, at: {list(corners[n - 1])}}}" for n in (10, 12, 14, 16, 18))
    hand = STEEL + parts + block + f"points: {{hub: {{on: lump, at: [0.1, 0.1, 0.1]}}, {points}}}\n"
    hand += "constraints: {spider: {rigid: hub, to: [p10, p12, p14, p16, p18], directions: [x, y, z]}}\n"
    hand += "supports: {feet: {on: body, set: SPC 1, fix: [x, y, z]}}\n"
    (tmp_path / "b.yaml").write_text(hand, encoding="utf-8")
    by_points = frequencies(fs.read_model(tmp_path / "b.yaml"))
    np.testing.assert_allclose(frequencies(taken), by_points, rtol=1e-9)  # rounding


def test_a_node_of_two_parts_is_one_node(tmp_path: Path) -> None:
    """Cells in two parts that are joined: held and led at all copies of a node, as where they are one part."""
    lines = bulk().splitlines()
    split = [
        one.replace(",1,", ",2,", 1) if one.startswith("CQUAD4") and int(one.split(",")[1]) > 1018 else one
        for one in lines
    ]
    text = "\n".join(split).replace("PSHELL,1,1,8.,1,,1", "PSHELL,1,1,8.,1,,1\nPSHELL,2,1,8.,1,,1") + "\n"
    both = "".join(
        PLATE.replace("plate:", f"{n}:").replace("scale", f"set: PSHELL {k}, scale") for n, k in (("a", 1), ("b", 2))
    )
    two = model(tmp_path, text, both + REST, "joints: {seam: {connect: [a, b]}}\n")
    one = model(tmp_path, bulk(), PLATE + REST)
    np.testing.assert_allclose(frequencies(two), frequencies(one), rtol=1e-8)  # rounding of equations said twice


def test_a_middle_that_is_held_holds_what_follows(tmp_path: Path) -> None:
    lines = [one for one in bulk().splitlines() if not one.startswith("SPC1")]
    text = "\n".join(lines).replace("ENDDATA", "SPC1,4,123456,900\nENDDATA") + "\n"
    found = model(tmp_path, text, PLATE + REST)
    feet = "supports: {feet: {on: plate, set: SET 5, fix: clamped}}\n"
    np.testing.assert_allclose(
        frequencies(found), frequencies(model(tmp_path, text, PLATE, feet)), rtol=1e-9
    )  # rounding
    assert found.structure.parts[1].attaches(found.structure.parts[0].taken()).left == ()


def test_the_force_of_the_supports_carries_the_weight(tmp_path: Path) -> None:
    from femstruct.modal.statics import statics

    found = model(tmp_path, bulk(), PLATE + REST)
    rest = statics(found, fs.assemble(found), [], weight=True)
    weight = 9.80665 * (0.6**2 * 8e-3 * 7850 + 1e3 * MASS)
    np.testing.assert_allclose(rest.forces["rest"][2], -weight, rtol=1e-6)  # the solution's rounding
    np.testing.assert_allclose(rest.forces["ground"], rest.forces["rest"], rtol=1e-12, atol=1e-9)  # rounding


def test_attachments_are_nodes_of_others_and_sag_with_them(tmp_path: Path) -> None:
    from femstruct.workflow.bases import sags

    found = model(tmp_path, bulk(), PLATE + REST)
    basis = fs.modal_basis(fs.assemble(found), count=10)
    assert len(found.parts) == 2 and [one.part for one in sags(found, basis)] == ["plate"]


def test_what_is_taken_is_not_named_and_what_is_not_is_offered(tmp_path: Path) -> None:
    def told(parts: str, text: str = "") -> str:
        found = model(tmp_path, text or bulk(), PLATE + parts)
        return "".join(one.message for one in unused_findings(found.structure))

    assert told(REST) == ""
    offered = told("")
    assert "no part uses: 1 held sets, 1 links, 1 masses" in offered
    assert "{type: attachments, mesh: a.bdf, scale: mm, take: [supports, links, masses]}" in offered
    less = told(REST.replace("[supports, links, masses]", "[supports, links]"))
    assert "no part uses: 1 masses" in less and "take: [masses]}" in less
    stray = bulk(
        more="GRID,950,,0.,0.,900.\nCONM2,803,950,0,1.\nRBE2,804,950,123,951\nGRID,951,,0.,5.,9.\nSPC1,4,1,950"
    )
    far = told(REST, stray)
    assert "1 held nodes that no part has, 1 links between nodes that no part has, 1 masses at nodes" in far


def test_masses_in_the_wrong_unit_are_found(tmp_path: Path) -> None:
    text = bulk().replace(f"0,{MASS},", f"0,{1e3 * MASS},")  # kg in a file in mm
    found = model(tmp_path, text, PLATE + REST)
    (slip,) = [one for one in structure_findings_before(found.structure, found) if one.code == "mesh-in-other-units"]
    assert slip.message.startswith("rest: the masses of a.bdf are 1.2e+04 kg in all, with a unit of mass of 1000 kg")
    kg = REST.replace("take", "mass_unit: kg, take")
    meant = model(tmp_path, text.replace("30.0,,42.0,,,50.0", "3.+4,,4.2+4,,,5.+4"), PLATE + kg)
    np.testing.assert_allclose(
        frequencies(meant), frequencies(model(tmp_path, bulk(), PLATE + REST)), rtol=1e-9
    )  # rounding
    factor = bulk(more="PARAM,WTMASS,.5")
    assert model(tmp_path, factor, PLATE + REST).inerts[0].total == pytest.approx(500.0 * MASS, rel=1e-14)  # rounding


WRONG = {
    "[supports, links, masses]": ("[supports, glue]", r"parts\.rest\.take\[2\]|'glue'"),
    "take: [supports, links, masses]": (
        "take: [supports], supports: [SPC 9]",
        r"got 'SPC 9', expected sets of supports: SPC 4",
    ),
    "scale: mm, take": (
        "scale: cm, take",
        r"take: got masses of a file whose unit of length is 0\.01 m, expected 'mass_unit' beside",
    ),
    "rest: {type: attachments, mesh: a.bdf, scale: mm": (
        "rest: {type: attachments, mesh: a.bdf",
        r"mesh: got a\.bdf with a unit of length of 1 m, of which no part has a node",
    ),
    "masses]}": ("masses], set: SET 5}", r"'set'"),
    "take: [supports, links, masses]}": ("take: [supports], mass_unit: t}", r"mass_unit: got a unit of mass, expected"),
}


@pytest.mark.parametrize("old", WRONG)
def test_what_cannot_be_taken_is_refused_with_its_line(old: str, tmp_path: Path) -> None:
    import re

    new, message = WRONG[old]
    assert old in REST
    with pytest.raises(fs.InputError) as caught:
        model(tmp_path, bulk(), PLATE + REST.replace(old, new))
    assert re.search(r"a\.yaml:4:\d+: parts\.rest", str(caught.value)), str(caught.value)
    assert re.search(message, str(caught.value)), str(caught.value)


def test_which_supports_hold_is_said_by_the_file_or_asked(tmp_path: Path) -> None:
    more = "SPC1,6,3,25\nSPCADD,9,4,6"
    with pytest.raises(
        fs.InputError, match=r"rest\.?\w*: got supports of a\.bdf, which has 2 sets of them, expected 'supp"
    ):
        model(tmp_path, bulk(more=more), PLATE + REST)
    of = {"SPC = 4": ["SPC 4"], "SPC = 6": ["SPC 6"], "SPC = 9": ["SPC 4", "SPC 6"]}
    for control, names in of.items():
        part = model(tmp_path, bulk(more=more, control=control), PLATE + REST).structure.parts[1]
        assert sorted({one.name for one in part.holds}) == names
    chosen = REST.replace("take", "supports: [SPC 6], take")
    assert {one.name for one in model(tmp_path, bulk(more=more), PLATE + chosen).structure.parts[1].holds} == {"SPC 6"}


def test_a_mass_that_would_turn_a_node_of_a_solid_is_refused(tmp_path: Path) -> None:
    lines = ["BEGIN BULK"] + [f"GRID,{n},,{n & 1}.,{(n >> 1) & 1}.,{n >> 2}." for n in range(8)]
    text = "\n".join(lines).replace("GRID,0", "GRID,8") + "\nCHEXA,1,1,8,1,3,2,4,5,+\n+,7,6\nPSOLID,1,1\n"
    text += "CONM2,60,7,0,3.,0.,0.,.25\nENDDATA\n"
    (tmp_path / "a.bdf").write_text(text, encoding="utf-8")
    parts = "parts:\n  body: {type: solid, mesh: a.bdf, material: steel}\n"
    rest = "  rest: {type: attachments, mesh: a.bdf, take: masses}\n"
    (tmp_path / "a.yaml").write_text(STEEL + parts + rest, encoding="utf-8")
    with pytest.raises(fs.InputError, match=r"a\.yaml:4:\d+: parts\.rest\.take: got the mass at node 7, with moments"):
        fs.read_model(tmp_path / "a.yaml")
