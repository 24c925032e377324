"""Nothing of a deck vanishes: every card, keyword, option and field is used, without effect, named, or refused; what
makes stiffness, mass or supports and is not in the model forbids trust, unless the model states it itself."""

from __future__ import annotations

from pathlib import Path

import pytest

import femstruct as fs
from femstruct.decks import abaqus, nastran, nastran_cards
from femstruct.errors import Finding, InputError
from femstruct.model.imported_mesh import HARMLESS, ImportedMesh, Makes
from femstruct.model.lay_ups import Laminate, Layer
from femstruct.model.sections import rectangle
from femstruct.model.unused import unused_findings

STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
NODES = [(1 + i + 3 * j, 0.5 * i, 0.5 * j) for j in range(3) for i in range(3)]
CELLS = [(1 + i + 2 * j, 1 + i + 3 * j, 2 + i + 3 * j, 5 + i + 3 * j, 4 + i + 3 * j) for j in (0, 1) for i in (0, 1)]


def bulk(shell: str = "PSHELL,1,1,.01,1,,1", element: str = "", more: str = "", control: str = "") -> str:
    """A square plate of four cells of two properties, 1 and 2, of one material."""
    lines = ["SOL 103", "CEND", *([control] if control else []), "BEGIN BULK", "MAT1,1,2.1+11,,.3,7850."]
    lines += [shell, "PSHELL,2,1,.01,1,,1", *(f"GRID,{n},,{x},{y},0." for n, x, y in NODES)]
    lines += [f"CQUAD4,{n},{1 if n < 3 else 2},{','.join(map(str, of))}{element}" for n, *of in CELLS]
    return "\n".join([*lines, *([more] if more else []), "ENDDATA"]) + "\n"


def inp(section: str = "*SHELL SECTION, ELSET=SKIN, MATERIAL=STEEL\n0.01", more: str = "") -> str:
    """The same plate; cells 1 and 2 are of set A, 3 and 4 of B."""
    lines = ["*NODE", *(f"{n}, {x}, {y}" for n, x, y in NODES), "*ELEMENT, TYPE=S4, ELSET=SKIN"]
    lines += [", ".join(map(str, one)) for one in CELLS]
    lines += ["*ELSET, ELSET=A", "1, 2", "*ELSET, ELSET=B", "3, 4", "*MATERIAL, NAME=STEEL", "*ELASTIC", "2.1e11, 0.3"]
    lines += ["*DENSITY", "7850.", "*MATERIAL, NAME=ALU", "*ELASTIC", "7e10, 0.33", "*DENSITY", "2700."]
    return "\n".join([*lines, section, *([more] if more else [])]) + "\n"


def mesh_of(tmp_path: Path, text: str) -> ImportedMesh:
    name = "a.inp" if text.startswith("*") else "a.bdf"
    (tmp_path / name).write_text(text, encoding="utf-8")
    return fs.read_mesh_file(tmp_path / name)


def told(mesh: ImportedMesh, *others: object, joints: tuple[fs.Joint, ...] = (), **written: object) -> list[Finding]:
    shell = fs.Shell("skin", mesh, **({"material": STEEL} | written))  # type: ignore[arg-type]
    found = unused_findings(fs.Structure("a", (shell, *others), joints))  # type: ignore[arg-type]
    return [one for one in found if one.code != "nodes-alone"]


def severe(found: list[Finding]) -> str:
    return "".join(one.message for one in found if one.severe)


LAYERS = Laminate((Layer(STEEL, 0.005), Layer(STEEL, 0.005)))
LAMINATE = "*SHELL SECTION, ELSET=SKIN, COMPOSITE\n0.004, , STEEL\n0.006, , ALU"
BARS = "*ELEMENT, TYPE={}, ELSET=ROD\n11, 1, 2\n12, 2, 3\n*SOLID SECTION, ELSET=ROD, MATERIAL=STEEL\n1e-4"
LOADED = "*STEP\n*STATIC\n*CLOAD\n2, 3, 1.\n*END STEP\n*STEP{}\n*FREQUENCY\n3\n*END STEP"
FORBIDS = {
    "offset": (inp("*SHELL SECTION, ELSET=SKIN, MATERIAL=STEEL, OFFSET=0.5\n0.01"), "OFFSET of *SHELL SECTION (line "),
    "offset by a face": (inp("*SHELL SECTION, ELSET=skin, MATERIAL=STEEL, OFFSET=SNEG\n0.01"), "of 4 cells [the middl"),
    "nodal thickness": (
        inp("*SHELL SECTION, ELSET=SKIN, MATERIAL=STEEL, NODAL THICKNESS\n0.01", "*NODAL THICKNESS\n1, 0.02"),
        "NODAL THICKNESS of *SHELL SECTION (line 30) of 4 cells [a thickness at each node; write 'thickness']",
    ),
    "two materials": (
        inp("*SHELL SECTION, ELSET=A, MATERIAL=STEEL\n0.01\n*SHELL SECTION, ELSET=B, MATERIAL=ALU\n0.01"),
        "2 materials where skin has one: STEEL of 2 cells (E 2.1e+11, rho 7850); ALU of 2 cells (E 7e+10, rho 2700)",
    ),
    "rods": (inp(more=BARS.format("T3D2")), "2 T3D2 elements (set ROD) [stiffness and mass; write frames]"),
    "a membrane": (inp("*MEMBRANE SECTION, ELSET=SKIN, MATERIAL=STEEL\n0.01"), "*MEMBRANE SECTION (line 30) of 4 cell"),
    "preload": (inp(more=LOADED.format(", PERTURBATION")), "*FREQUENCY after a step of loads (line 37) [a body under"),
    "large displacements": (inp(more=LOADED.replace("*STEP\n", "*STEP, NLGEOM\n", 1).format("")), "after a step of lo"),
    "initial stress": (inp(more="*INITIAL CONDITIONS, TYPE=STRESS\n1, 1e6"), "*INITIAL CONDITIONS, TYPE=STRESS (line "),
    "a sector": (inp(more="*CYCLIC SYMMETRY MODEL, N=4, TIE=T\n0,0,0,0,0,1"), "1 *CYCLIC SYMMETRY MODEL (line 32)"),
    "a second line of data": (inp(more="*SHELL SECTION, ELSET=A\n0.01\n0.02"), "data line 2 of *SHELL SECTION (line"),
    "a misspelt keyword": (inp(more="*BOUNDRY\n1, 1, 3"), "1 *BOUNDRY (line 32) [a keyword that is not known: is it m"),
    "an unknown option": (inp("*SHELL SECTION, ELSET=SKIN, MATERIAL=STEEL, TWIST=3\n0.01"), "option TWIST of *SHELL S"),
    "nsm of elements that no shell is": (
        bulk(more="NSM,7,PBAR,1,12.5", control="NSM = 7"),
        "1 NSM (line 21) [mass of cells, where the case control chooses it",
    ),
    "mass on bars": (
        bulk(more="CBAR,11,7,1,2,0.,0.,1.\nPBAR,7,1,1.-4,1.-8,1.-8,1.-8,3."),
        "1 NSM of PBAR 7 (line 21) [3 of mass per length on bars; write masses]",
    ),
    "mass on rods": (bulk(more="CROD,11,7,1,2\nPROD,7,1,1.-4,,,4."), "1 NSM of PROD 7 (line 21) [4 of mass per len"),
    "a sum of sets": (
        bulk(more="NSM1,8,PSHELL,3.,1\nNSMADD,7,8", control="NSM = 7"),
        "1 NSM1 (line 21) [mass of cells, where the case control chooses it",
    ),
    "mass per length": (inp(more="*NONSTRUCTURAL MASS, ELSET=A, UNITS=MASS PER LENGTH\n3."), "1 *NONSTRUCTURAL MASS ("),
    "corners": (bulk(element=",,\n,,,.02,.02,.02,.02"), "T1, T2, .. of CQUAD4 (line 16) of 4 cells [a thick"),
    "zoffs": (bulk(element=",,.002"), "ZOFFS of CQUAD4 (line 16) of 4 cells"),
    "a blank MID2": (bulk("PSHELL,1,1,.01"), "PSHELL 1 without MID2 (line 5) of 2 cells [a membrane, without"),
    "another MID2": (
        bulk("PSHELL,1,1,.01,9,,1", more="MAT1,9,7.+10,,.3,2700."),
        "MID2 of PSHELL 1 (line 5) of 2 cells [another material of bending than in the plane",
    ),
    "a sandwich": (bulk("PSHELL,1,1,.01,1,12.,1"), "12I/T^3 of PSHELL 1 (line 5) of 2 cells [stiffness in bending tim"),
    "soft in shear": (bulk("PSHELL,1,1,.01,1,,1,.1"), "MID3 or TS/T of PSHELL 1"),
    "two MAT1": (bulk("PSHELL,1,9,.01,9,,9", more="MAT1,9,7.+10,,.3,2700."), "2 materials where skin has one: materia"),
    "bars": (bulk(more="CBAR,11,7,1,2,0.,0.,1.\nPBAR,7,1,1.-4,1.-8,1.-8,1.-8"), "1 CBAR elements (set property 7) [st"),
    "rods of Nastran": (bulk(more="CROD,11,7,1,2\nCROD,12,7,2,3\nPROD,7,1,1.-4"), "2 CROD (line 20) [rods: stiffness"),
    "springs": (bulk(more="CELAS2,11,1.+6,2,3"), "1 CELAS2 (line 20) [springs or dashpots between nodes; write spring"),
    "wedges": (bulk(more="CPENTA,11,7,1,2,3,4,5,6"), "1 CPENTA (line 20) [wedges and pyramids: stiffness and mass; no"),
    "static load first": (bulk(control="STATSUB = 3"), "1 STATSUB of the case control (line 3) [the vibration of a bo"),
    "an equation": (bulk(more="MPC,1,1,1,1.,2,1,-1."), None),
    "a chosen equation": (bulk(more="MPC,1,1,1,1.,2,1,-1.", control="MPC = 1"), "1 MPC (line 21) [rigid links or equ"),
    "a misspelt card": (bulk(more="SPC11,1,123,1"), "1 SPC11 (line 20) [a card that is not known: is it misspelt?"),
    "a field too many": (bulk(more="CONM2,11,2,,1.,,,,7."), "field 9 of CONM2 (line 20) [a field that is not read"),
}  # fmt: skip


@pytest.mark.parametrize("what", FORBIDS)
def test_what_a_deck_states_and_the_model_has_not_forbids_trust(what: str, tmp_path: Path) -> None:
    text, message = FORBIDS[what]
    found = severe(told(mesh_of(tmp_path, text)))
    assert found == "" if message is None else message in found


SILENT = {
    "offset": (FORBIDS["offset"][0], {"offset": 0.005}),
    "an offset of 0": (FORBIDS["offset"][0], {"offset": 0.0}),
    "zoffs": (FORBIDS["zoffs"][0], {"offset": 0.002}),
    "nodal thickness": (FORBIDS["nodal thickness"][0], {"thickness": 0.02}),
    "corners": (FORBIDS["corners"][0], {"thickness": 0.02}),
    "equal corners": (bulk(element=",,\n,,,.01,.01,.01,.01"), {}),
    "layers": (inp(LAMINATE), {"material": LAYERS, "orientation": (1.0, 0.0, 0.0)}),
    "a set of one material": (FORBIDS["two materials"][0], {"named": "A"}),
    "one material by two names": (bulk("PSHELL,1,9,.01,9,,9", more="MAT1,9,2.1+11,,.3,7850."), {}),
    "a direction of steel": (bulk(element=",30."), {}),
    "an orientation of steel": (
        inp("*SHELL SECTION, ELSET=SKIN, MATERIAL=STEEL, ORIENTATION=O\n0.01", "*ORIENTATION, NAME=O\n1,0,0,0,1,0"),
        {},
    ),
    "no offset": (inp("*SHELL SECTION, ELSET=SKIN, MATERIAL=STEEL, OFFSET=0.\n0.01"), {}),
    "edges": (inp(more=BARS.format("T3D2").partition("*SOLID")[0].rstrip()), {}),  # as mesh programs write them
    "a step without a load": (inp(more="*STEP, PERTURBATION\n*FREQUENCY\n3\n*END STEP"), {}),
}  # fmt: skip


@pytest.mark.parametrize("what", SILENT)
def test_what_the_model_states_itself_or_does_not_take_forbids_nothing(what: str, tmp_path: Path) -> None:
    text, written = SILENT[what]
    assert severe(told(mesh_of(tmp_path, text), **written)) == ""


def test_what_the_model_states_in_place_of_the_file_is_a_remark(tmp_path: Path) -> None:
    mesh = mesh_of(tmp_path, FORBIDS["offset"][0])
    (one,) = [one for one in told(mesh, offset=0.002) if one.code == "mesh-stated-otherwise"]
    assert one.message.endswith("which holds: OFFSET of *SHELL SECTION (line 30) of 4 cells")
    (one,) = [one for one in told(mesh_of(tmp_path, inp()), thickness=0.02) if one.code == "mesh-stated-otherwise"]
    assert one.message.endswith("which holds: thickness 10 mm of 4 cells of SKIN, 20 mm of skin")
    assert not [one for one in told(mesh_of(tmp_path, inp()), thickness=0.01) if one.code == "mesh-stated-otherwise"]
    wood = fs.Orthotropic("wood", E=(11e9, 370e6), G=(690e6, 50e6), nu=0.35, rho=420.0)
    turned = told(mesh_of(tmp_path, bulk(element=",30.")), material=wood, orientation=(1.0, 0.0, 0.0))
    (one,) = [one for one in turned if one.code == "mesh-stated-otherwise"]
    assert "THETA or MCID of CQUAD4 (line 16) of 4 cells" in one.message and severe(turned) == ""
    light = fs.Material("alu", E=70e9, nu=0.33, rho=2700.0)
    (one,) = [one for one in told(mesh_of(tmp_path, inp()), material=light) if one.code == "mesh-stated-otherwise"]
    assert "E 2.1e+11 Pa of STEEL, 7e+10 Pa of skin; rho 7850 kg/m^3 of STEEL, 2700 kg/m^3 of skin" in one.message


def test_nouns_of_the_model_may_stand_for_those_of_a_deck(tmp_path: Path) -> None:
    """A frame for its bars, a joint for its ties: the finding limits trust then."""
    mesh = mesh_of(tmp_path, inp(more=BARS.format("B31") + "\n*TIE, NAME=T\na, b"))
    beam = fs.Frame("rib", STEEL, rectangle("s", 0.01, 0.02), (((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),), 0.5)
    one, other = severe(told(mesh)), told(mesh, beam, joints=(fs.Joint("w", "skin", "rib"),))
    assert "2 B31 elements" in one and "1 *TIE" in one and severe(other) == ""
    (limits,) = [one for one in other if one.code == "mesh-states-more"]
    assert "states what no part uses: 1 *TIE (line 37), 2 B31 elements (set ROD)" in limits.message


def test_a_composite_is_named_with_what_to_write(tmp_path: Path) -> None:
    message = r"got none, and layers of '.*' in a\..*, expected 'layers' in place of 'material'"
    for text in (inp(LAMINATE), bulk("PCOMP,1,,,,,,,,\n,1,.004,0.,,2,.006,30.", more="MAT1,2,7.+10,,.33,2700.")):
        mesh = mesh_of(tmp_path, text.replace("PSHELL,2", "PCOMP,2,,,,,,,,\n,1,.004,0.,,2,.006,30.\n$"))
        with pytest.raises(InputError, match=message) as e:
            fs.mesh_structure(fs.Structure("a", (fs.Shell("skin", mesh, STEEL),)))
        assert "4 mm], [" in str(e.value) and "6 mm" in str(e.value)
        assert "2 layers; write 'layers'" in severe(told(mesh, thickness=0.01))


def every_card() -> list[str]:
    known = (*nastran_cards.WITHOUT_EFFECT, *nastran_cards.LEFT_OUT)
    assert not set(known) & {*nastran._CELLS, *nastran._READERS}
    return [*known, *(f"XQ{n}" for n in range(100))]


def test_no_card_is_passed_over(tmp_path: Path) -> None:
    """Each card of the tables and a hundred unknown ones, all in one file: each is counted once, in its class."""
    cards = every_card()
    mesh = mesh_of(tmp_path, bulk(more="\n".join(f"{one},1" for one in cards), control="MPC=1\nNSM=1\nK2GG=A"))
    found = {one.what: one for one in mesh.stated.left_out}
    assert set(cards) <= set(found) and all(found[one].count == 1 and found[one].line for one in cards)
    for one in cards:
        none, left = one in nastran_cards.WITHOUT_EFFECT, nastran_cards.LEFT_OUT.get(one)
        assert (
            found[one].makes is (Makes.NOTHING if none else left[0] if left else Makes.UNKNOWN) and found[one].changes
        )
    shown = "".join(one.message for one in told(mesh) if one.code == "mesh-without-effect")
    assert all(f"1 {one} (line" in shown for one in nastran_cards.WITHOUT_EFFECT)


def test_no_keyword_is_passed_over(tmp_path: Path) -> None:
    words = [*abaqus.WITHOUT_EFFECT, *abaqus.LEFT_OUT, *(f"XQ{n}" for n in range(100))]
    assert not set(words) & {*abaqus._READERS, *abaqus._MOVES}
    outside = [one for one in words if one not in ("STEP", "STATIC", "FREQUENCY")]
    mesh = mesh_of(tmp_path, inp(more="\n".join(f"*{one}" for one in outside)))
    found = {one.what: one for one in mesh.stated.left_out}
    for one in outside:
        none, left = one in abaqus.WITHOUT_EFFECT, abaqus.LEFT_OUT.get(one)
        got = found[f"*{one}"]
        assert got.count == 1 and got.changes
        assert got.makes is (Makes.NOTHING if none else left[0] if left else Makes.UNKNOWN)
    in_step = mesh_of(tmp_path, inp(more="*STEP\n" + "\n".join(f"*{one}" for one in outside)))
    assert {one.what for one in in_step.stated.left_out} >= set(found)


@pytest.mark.parametrize("card", sorted({*nastran._CELLS, *nastran._READERS} - {"PARAM", "GRDSET"}))
def test_no_field_is_passed_over(card: str, tmp_path: Path) -> None:
    """A field far behind all that a card has is refused, or named; lists of numbers take it."""
    lists = ("RBE2", "RBE3", "SPC1", "SPCADD", "SET1", "SET3", "PCOMP", "PCOMPG")
    good = {
        "GRID": "GRID,90,,0.,0.,0.",
        "PSHELL": "PSHELL,9,1,.01,1,,1",
        "CONM2": "CONM2,90,1,,1.",
        "SPC": "SPC,1,1,123",
    }
    row = good.get(card, f"{card},90,1,1,2,3,4,5,6,7,8")
    long = row.split(",") + [""] * (60 - len(row.split(","))) + ["77"]
    lines = [",".join(["" if at else long[0], *long[1 + at : 9 + at]]) for at in range(0, len(long) - 1, 8)]
    try:
        mesh = mesh_of(tmp_path, bulk(more="\n".join(lines)))
    except InputError as error:
        assert "got" in str(error)
        return
    named = [one.what for one in mesh.stated.left_out if one.makes not in HARMLESS]
    assert card in lists or f"field 61 of {card}" in named, named


def test_parameters_and_commands_are_known_or_named(tmp_path: Path) -> None:
    more = "DISPLACEMENT(PLOT) = ALL\nMETHOD = 1\nABRACADABRA = 3"
    mesh = mesh_of(tmp_path, bulk(control=more, more="PARAM,POST,-1\nPARAM,COUPMASS,1\nPARAM,CK2,2.\nPARAM,XYZZY,1"))
    found = {one.what: one.makes for one in mesh.stated.left_out}
    assert found["METHOD of the case control"] is Makes.NOTHING is found["DISPLACEMENT of the case control"]
    assert found["ABRACADABRA of the case control"] is Makes.SLIGHT
    assert found["PARAM"] is Makes.NOTHING and found["PARAM, COUPMASS"] is Makes.SLIGHT
    assert found["PARAM, CK2"] is Makes.SECTION and found["PARAM, XYZZY"] is Makes.SLIGHT


def test_supports_that_are_not_read_are_the_reason_why_there_are_none(tmp_path: Path) -> None:
    text = inp(more="*NSET, NSET=E\n1, 2\n*TRANSFORM, NSET=E\n1, 1, 0, -1, 1, 0\n*BOUNDARY\nE, 1, 2")
    mesh = mesh_of(tmp_path, text)
    with pytest.raises(
        InputError, match=r"got supports, which a\.inp states only as 2 held nodes in directions of \*TR"
    ):
        fs.Attachments("rest", mesh, ("supports",))


def test_sets_of_springs_sets_below_and_short_nodes_are_read(tmp_path: Path) -> None:
    more = (
        "*ELEMENT, TYPE=SPRINGA\n91, 1, 9\n*ELSET, ELSET=SPR\n91\n*ELSET, ELSET=MIXED\n91, 1\n*BOUNDARY\nLATE, 1, 3\n"
    )
    mesh = mesh_of(tmp_path, inp(more=more + "*NSET, NSET=LATE\n2, 3").replace("1, 0.0, 0.0", "1, 0.", 1))
    assert "SPR" not in mesh.cell_sets and mesh.cell_sets["MIXED"] == {"quad4": [0]}
    assert mesh.numbers[mesh.stated.holds[0].nodes].tolist() == [2, 3] and mesh.points[0].tolist() == [0.0, 0.0, 0.0]


def test_included_files_and_general_supports_of_nastran(tmp_path: Path) -> None:
    """INCLUDE beside the file, also over two lines; GRDSET gives what GRID leaves out, wherever it stands."""
    head, _, body = bulk(more="GRDSET,,,,,,,6").partition("BEGIN BULK\n")
    body = body.replace("GRID,9,,1.0,1.0,0.", "GRID,9,,1.0,1.0,0.,,3")
    (tmp_path / "inner.dat").write_text(body.replace("ENDDATA\n", ""), encoding="utf-8")
    for include in ("INCLUDE 'inner.dat'", "include 'inn\n   er.dat'"):
        mesh = mesh_of(tmp_path, f"{head}BEGIN BULK\n{include}\nENDDATA\n")
        held = {one.held: mesh.numbers[one.nodes].tolist() for one in mesh.stated.holds}
        assert held == {(5,): [1, 2, 3, 4, 5, 6, 7, 8], (2,): [9]}
    (tmp_path / "inner.dat").write_text("GRID,1,,O.\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"inner\.dat:1:1: got GRID with 'O\.' in field 4, expected a number"):
        mesh_of(tmp_path, f"{head}BEGIN BULK\nINCLUDE 'inner.dat'\nENDDATA\n")
    with pytest.raises(InputError, match=r"a\.bdf:4:1: got"):
        mesh_of(tmp_path, f"{head}BEGIN BULK\nINCLUDE 'none.dat'\nENDDATA\n")


SYSTEMS = """CORD2R,5,,1.,0.,0.,1.,0.,1.,+
+,1.,1.,0.
CORD2C,6,5,0.,0.,0.,0.,0.,1.,+
+,1.,0.,0.
CORD2S,7,,0.,0.,0.,0.,0.,1.,+
+,1.,0.,0.
CORD1R,8,1,3,7
GRID,21,6,.5,90.,.2
GRID,22,7,2.,90.,90.
GRID,23,8,1.,2.,3.
"""


def test_nodes_in_coordinate_systems_are_where_they_are(tmp_path: Path) -> None:
    """By hand: system 5 stands at (1, 0, 0) with its x along y; 6 is cylindrical in it; 7 is spherical; the z of 8 is
    along x, its x along y, so that its y is along z."""
    mesh = mesh_of(tmp_path, bulk(more=SYSTEMS.rstrip()))
    at = dict(zip(mesh.numbers.tolist(), mesh.points.tolist(), strict=True))
    assert at[21] == pytest.approx((0.5, 0.0, 0.2), abs=1e-15)  # rounding
    assert at[22] == pytest.approx((0.0, 2.0, 0.0), abs=1e-15)  # rounding
    assert at[23] == pytest.approx((3.0, 1.0, 2.0), abs=1e-15)  # rounding


def test_supports_in_other_directions_are_named_and_those_in_all_are_held(tmp_path: Path) -> None:
    """Node 23 moves along system 6, node 24 along one that is parallel to the basic one."""
    parallel = "GRID,24,,0.,0.,5.,9\nCORD2R,9,,0.,0.,7.,0.,0.,8.,+\n+,1.,0.,7.\n"
    more = SYSTEMS.replace("GRID,23,8,1.,2.,3.", "GRID,23,8,1.,2.,3.,6") + parallel
    mesh = mesh_of(tmp_path, bulk(more=more + "SPC1,1,123,23\nSPC1,2,1,23,24\nSPC1,3,4,23"))
    held = {one.name: (mesh.numbers[one.nodes].tolist(), one.held) for one in mesh.stated.holds}
    assert held == {"SPC 1": ([23], (0, 1, 2)), "SPC 2": ([24], (0,))}
    (left,) = [one for one in mesh.stated.left_out if one.makes is Makes.SUPPORTS]
    assert left.named == "1 held nodes in directions of CD of GRID (line 29)"


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("CORD2C,6,5", "CORD2C,6,6", "got CORD2C with the coordinate system 6, which is defined by itself"),
        ("+,1.,1.,0.", "+,1.,0.,9.", "got CORD2R with three points on a line, expected three that span its plane"),
        ("CORD1R,8,1,3,7", "CORD1R,8,1,3,77", "got CORD1R with node 77, which the file does not have"),
        ("CORD2S,7", "CORD2S,5", "got CORD2S with the number 5 again, expected systems whose numbers differ"),
        ("GRID,22,7", "GRID,22,4", "got GRID with the coordinate system 4, which the file does not have"),
    ],
)
def test_systems_that_cannot_be_are_refused_with_their_line(old: str, new: str, told: str, tmp_path: Path) -> None:
    assert old in SYSTEMS
    with pytest.raises(InputError) as caught:
        mesh_of(tmp_path, bulk(more=SYSTEMS.rstrip().replace(old, new)))
    assert told in str(caught.value) and "a.bdf:2" in str(caught.value)


def test_lines_that_would_be_lost_are_refused(tmp_path: Path) -> None:
    """Numbers behind the eighth field of a line in free format, and data before all keywords."""
    with pytest.raises(
        InputError, match=r"a\.bdf:20:1: got 9 fields behind SPC1, expected 8 in a line; write the others"
    ):
        mesh_of(tmp_path, bulk(more="SPC1,1,123,1,2,3,4,5,6,7"))
    mesh = mesh_of(tmp_path, bulk(more="SPC1,1,123,1,2,3,4,5,6,AB\n+AB,7"))  # a mark of continuation
    assert mesh.numbers[mesh.stated.holds[0].nodes].tolist() == [1, 2, 3, 4, 5, 6, 7]
    (tmp_path / "b.inp").write_text("NODE\n1, 0, 0\n*NODE\n2, 0, 0\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"b\.inp:1:1: got 'NODE' before all keywords, expected a keyword, such as"):
        fs.read_mesh_file(tmp_path / "b.inp")
    (tmp_path / "nodes.txt").write_text("91, 7, 8, 9\n", encoding="utf-8")  # an included file within a block of data
    mesh = mesh_of(tmp_path, inp(more="*NODE\n90, 1, 2, 3\n*INCLUDE, INPUT=nodes.txt\n92, 4, 5, 6"))
    assert mesh.points[-3:].tolist() == [[1.0, 2.0, 3.0], [7.0, 8.0, 9.0], [4.0, 5.0, 6.0]]
    three = inp("*SHELL SECTION,\nELSET=SKIN,\nOFFSET=0.5,\nMATERIAL=STEEL\n0.01")  # a keyword over four lines
    assert "OFFSET of *SHELL SECTION" in severe(told(mesh_of(tmp_path, three)))
    more = bulk().replace("ENDDATA", "BEGIN SUPER = 1\nENDDATA")
    assert "1 BEGIN (line 20) [superelements: other parts" in severe(told(mesh_of(tmp_path, more)))


def test_supports_of_steps_are_those_of_the_model_where_modes_are_asked_for(tmp_path: Path) -> None:
    """As many preprocessors write them. Those of steps before the one of the modes hold on, unless OP=NEW lets go."""

    def held(more: str) -> list[tuple[list[int], tuple[int, ...]]]:
        mesh = mesh_of(tmp_path, inp(more=more))
        return [(mesh.numbers[one.nodes].tolist(), one.held) for one in mesh.stated.holds]

    modes = "*STEP\n*FREQUENCY\n3\n*BOUNDARY\n2, 3, 3\n*END STEP"
    own, load = "*BOUNDARY\n1, 1, 3\n", "*STEP\n*STATIC\n*BOUNDARY\n4, 1\n*END STEP\n"
    assert held(own + modes) == held(own + "*BOUNDARY\n2, 3, 3") == [([1], (0, 1, 2)), ([2], (2,))]
    assert held(own + load + modes) == [([1], (0, 1, 2)), ([4], (0,)), ([2], (2,))]
    anew = modes.replace("*BOUNDARY", "*BOUNDARY, OP=NEW\n9, 1\n*BOUNDARY, OP=NEW")
    assert held(own + load + anew) == [([9], (0,)), ([2], (2,))]
    assert held(own + modes + "\n" + load) == [([1], (0, 1, 2)), ([2], (2,))]
    later = mesh_of(tmp_path, inp(more=own + modes + "\n" + load)).stated.left_out
    assert "*BOUNDARY of a later step" in [one.what for one in later]


NSM = bulk("PSHELL,1,1,.01,1,,1,,12.5")  # on 0.5 m^2
SPREAD = {  # a deck, and the mass that lies on its 1 m^2 beside 78.5 kg [kg]
    "PSHELL": (NSM, 6.25),
    "with the factor of all masses": (bulk("PSHELL,1,1,.01,1,,1,,50.", more="PARAM,WTMASS,.25"), 6.25),
    "NSM": (bulk(more="NSM,7,PSHELL,1,12.,2,8.", control="NSM = 7"), 10.0),
    "NSM1": (bulk(more="NSM1,7,ELEMENT,12.,1,THRU,3", control="NSM = 7"), 9.0),
    "NSML": (bulk(more="NSML,7,PSHELL,1,12.,2,8.", control="NSM = 7"), 20.0),
    "NSML1": (bulk(more="NSML1,7,PSHELL,12.,1,2", control="NSM = 7"), 12.0),
    "not chosen": (bulk(more="NSM1,8,ELEMENT,12.,1", control="NSM = 7"), 0.0),
    "per area": (inp(more="*NONSTRUCTURAL MASS, ELSET=a, UNITS=MASS PER AREA\n12."), 6.0),
    "per volume": (inp(more="*NONSTRUCTURAL MASS, ELSET=A, UNITS=MASS PER VOLUME\n1200."), 6.0),
    "in total": (inp(more="*NONSTRUCTURAL MASS, ELSET=SKIN, UNITS=Total Mass\n12."), 12.0),
}


def mass_of(shell: fs.Shell) -> float:
    return float(fs.mesh_structure(fs.Structure("a", (shell,))).parts["skin"].mass)


@pytest.mark.parametrize("how", SPREAD)
def test_mass_on_cells_that_a_deck_states_is_theirs(how: str, tmp_path: Path) -> None:
    """Amount times area; of a part of the cells, what lies on those."""
    text, on_it = SPREAD[how]
    mesh = mesh_of(tmp_path, text)
    assert mass_of(fs.Shell("skin", mesh, STEEL, 0.01)) == pytest.approx(78.5 + on_it, rel=1e-12)  # rounding
    assert not severe(told(mesh, thickness=0.01))


def test_mass_of_a_total_is_spread_over_all_cells_that_have_it(tmp_path: Path) -> None:
    mesh = mesh_of(tmp_path, SPREAD["in total"][0])
    assert mass_of(fs.Shell("skin", mesh, STEEL, 0.01, named="A")) == pytest.approx(39.25 + 6.0, rel=1e-12)  # rounding


def test_a_deck_in_millimetres_and_tonnes(tmp_path: Path) -> None:
    """12.5 kg/m^2 are 1.25e-8 t/mm^2; of a unit of length beside which none of mass is usual, it forbids trust."""
    text = NSM.replace("12.5", "1.25-8")
    for length in ("0.5", "1.0"):
        text = text.replace(f",{length}", f",{float(length) * 1e3:g}")
    (tmp_path / "a.bdf").write_text(text, encoding="utf-8")
    mesh = fs.read_mesh_file(tmp_path / "a.bdf", scale=1e-3)
    assert mass_of(fs.Shell("skin", mesh, STEEL, 0.01)) == pytest.approx(78.5 + 6.25, rel=1e-12)  # rounding
    inches = fs.read_mesh_file(tmp_path / "a.bdf", scale=0.0254)
    assert "NSM of PSHELL 1 (line 5) of 2 cells [1.25e-08 of mass per area, which does not stiffen; write 'nonstr" in (
        severe(told(inches, thickness=0.01))
    )


def test_what_the_model_states_of_it_holds(tmp_path: Path) -> None:
    mesh = mesh_of(tmp_path, NSM)
    assert mass_of(fs.Shell("skin", mesh, STEEL, 0.01, nonstructural=3.0)) == pytest.approx(81.5, rel=1e-12)  # rounding
    assert not told(mesh)
    assert "mesh-stated-otherwise" in {one.code for one in told(mesh, nonstructural=3.0)}
    with pytest.raises(InputError, match=r"parts.skin.nonstructural: got -3 kg/m\^2, expected a mass per area"):
        fs.Shell("skin", mesh, STEEL, 0.01, nonstructural=-3.0)


def test_frequencies_follow_the_root_of_the_mass(tmp_path: Path) -> None:
    """As much mass as the plate has makes every frequency lower by the root of two: the cells have no rotary inertia
    to speak of, t^2 / 12 of it."""
    found = []
    for nsm in ("", ",,78.5"):
        text = bulk(f"PSHELL,1,1,.01,1,,1{nsm}").replace("PSHELL,2,1,.01,1,,1", f"PSHELL,2,1,.01,1,,1{nsm}")
        shell = fs.Shell("skin", mesh_of(tmp_path, text), STEEL)
        found.append(fs.modal_basis(fs.assemble(fs.mesh_structure(fs.Structure("a", (shell,)))), count=8).frequency_hz)
    assert found[1][6:] == pytest.approx(found[0][6:] / 2**0.5, rel=1e-3)  # rotary inertia, (pi t / L)^2 / 12
