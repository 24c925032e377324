"""Mesh files written by hand: what each format can say reaches the mesh, and every mistake has its file and line."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from femstruct.decks.mesh_file import read_mesh_file
from femstruct.errors import InputError
from femstruct.model.imported_mesh import HARMLESS, ImportedMesh

ABAQUS = """*HEADING
a tray
** a comment
*NODE, NSET=ALL
1, 0., 0., 0.
2, 100., 0.
3, 100., 100., 0.
*NODE
4, 0., 100., 0.
5, 200., 0., 0.
6, 50., 50., 30.
*ELEMENT, TYPE=S4R, ELSET=FLOOR
11, 1, 2, 3, 4
*Element, type=S3
12, 2,
5, 3
*NSET, NSET=FOOT, GENERATE
1, 5, 4
*NSET, NSET=MORE
FOOT, 3
*ELSET, ELSET=BOTH
floor, 12
*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*DENSITY
7.85E-9,
*SHELL SECTION, ELSET=BOTH,
MATERIAL=STEEL
2.5, 5
*BOUNDARY
FOOT, 1, 3
4, ENCASTRE
*TIE, NAME=T
a, b
*STEP
*CLOAD
1, 3, -1.
"""
NASTRAN = """SOL 103
SET 4 = 11,
        12
SET 5 = 1 THRU 3
BEGIN BULK
$ a comment
PARAM,POST,-1
GRID           1              0.      0.      0.
GRID,2,,100.,0.,0.
GRID*                  3                            1.+2            1.D2
*                     0.
GRID,4,,0.,100.
GRID,5,,200.,0.,0.
GRID,6,,50.,50.,30.
CQUAD4        11       7       1       2       3       4
CTRIA3,12,7,2,5,3
PSHELL,7,1,2.5,1
MAT1    1       210000.         .3      7.85-9
MAT8,2,1.1+4,370.,.44,690.,690.,50.,4.2-10
SPC1,3,123,1,THRU,2
SPC1,3,456,4
RBE2,20,6,123456,1,2,3,4,+
+,5
CONM2,21,6,0,.005,0.,0.,10.
,2.,0.,3.,0.,0.,4.
PLOAD4,1,11,1.
SET1,9,1,4,5
ENDDATA
"""
UNV = """    -1
   164
         1Meter (newton)         2
    -1
    -1
  2411
         1         1         1        11
   0.0000000000000000D+00   0.0000000000000000D+00   0.0000000000000000D+00
         2         1         1        11
   1.0000000000000000D+02   0.0000000000000000D+00   0.0000000000000000D+00
         3         1         1        11
   1.0000000000000000D+02   1.0000000000000000D+02   0.0000000000000000D+00
         4         1         1        11
   0.0000000000000000D+00   1.0000000000000000D+02   0.0000000000000000D+00
         5         1         1        11
   2.0000000000000000D+02   0.0000000000000000D+00   0.0000000000000000D+00
    -1
    -1
  2412
        11        94         1         1         7         4
         1         2         3         4
        12        91         1         1         7         3
         2         5         3
        13        21         1         1         7         2
         0         1         1
         1         2
    -1
    -1
  2467
         1         0         0         0         0         0         0         2
FLOOR AND SIDE
         8        11         0         0         8        12         0         0
         2         0         0         0         0         0         0         3
FOOT
         7         1         0         0         7         2         0         0
         7         5         0         0
    -1
    -1
    55
    -1
"""
GMSH = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 1 "floor"
2 2 "both of them"
$EndPhysicalNames
$Nodes
5
1 0 0 0
2 100 0 0
3 100 100 0
4 0 100 0
5 200 0 0
$EndNodes
$Elements
3
1 3 2 1 1 1 2 3 4
2 3 2 2 1 4 1 2 3
3 2 2 2 1 2 5 3
$EndElements
"""
FILES = {"a.inp": ABAQUS, "a.bdf": NASTRAN, "a.unv": UNV, "a.msh": GMSH}


def mesh_of(tmp_path: Path, name: str, text: str, scale: float = 1e-3) -> ImportedMesh:
    (tmp_path / name).write_text(text, encoding="utf-8")
    return read_mesh_file(tmp_path / name, scale)


@pytest.mark.parametrize("name", FILES)
def test_nodes_and_cells_are_those_of_the_file_in_metres(name: str, tmp_path: Path) -> None:
    mesh = mesh_of(tmp_path, name, FILES[name])
    at = dict(zip(mesh.numbers.tolist(), mesh.points.tolist(), strict=True))
    for node, place in {1: (0, 0, 0), 2: (0.1, 0, 0), 3: (0.1, 0.1, 0), 4: (0, 0.1, 0), 5: (0.2, 0, 0)}.items():
        assert at[node] == pytest.approx(place, abs=1e-15)  # rounding of the scale
    assert mesh.numbers[mesh.cells["quad4"]].tolist() == [[1, 2, 3, 4]]
    assert mesh.numbers[mesh.cells["tri3"]].tolist() == [[2, 5, 3]]


def left(mesh: ImportedMesh, harmless: bool = False) -> list[str]:
    """What is left out and has an effect, or has none, with its count and line."""
    return [one.named for one in mesh.stated.left_out if (one.makes in HARMLESS) == harmless]


def numbers(mesh: ImportedMesh, name: str) -> list[int]:
    return sorted(mesh.numbers[mesh.nodes_of(name)].tolist())


def test_all_that_an_input_file_of_abaqus_says(tmp_path: Path) -> None:
    mesh = mesh_of(tmp_path, "a.inp", ABAQUS)
    assert numbers(mesh, "FOOT") == [1, 5] and numbers(mesh, "MORE") == [1, 3, 5] and numbers(mesh, "ALL") == [1, 2, 3]
    assert mesh.cell_sets == {"FLOOR": {"quad4": [0]}, "BOTH": {"quad4": [0], "tri3": [0]}}
    (one,) = mesh.stated.properties
    # rounding of the scale
    assert (one.cells, one.material) == ("BOTH", "STEEL") and one.thickness == pytest.approx(2.5e-3, rel=1e-15)
    assert dict(mesh.stated.materials[0].constants) == {"E": 210000.0, "nu": 0.3, "rho": 7.85e-9}
    assert [(mesh.numbers[one.nodes].tolist(), one.held) for one in mesh.stated.holds] == [
        ([1, 5], (0, 1, 2)),
        ([4], (0, 1, 2, 3, 4, 5)),
    ]
    assert left(mesh) == ["1 *TIE (line 34)"]
    assert left(mesh, harmless=True) == ["1 *HEADING (line 1)", "1 *STEP (line 36)", "1 *CLOAD (line 37)"]


def test_all_that_a_bulk_data_file_says(tmp_path: Path) -> None:
    mesh = mesh_of(tmp_path, "a.bdf", NASTRAN)
    assert mesh.cell_sets == {"PSHELL 7": {"quad4": [0], "tri3": [0]}, "SET 4": {"quad4": [0], "tri3": [0]}}
    assert (
        numbers(mesh, "SET 5") == [1, 2, 3]
        and numbers(mesh, "SET 9") == [1, 4, 5]
        and numbers(mesh, "SPC 3") == [1, 2, 4]
    )
    stated = mesh.stated
    (one,) = stated.properties
    # rounding of the scale
    assert (one.cells, one.material) == ("PSHELL 7", "material 1") and one.thickness == pytest.approx(2.5e-3, rel=1e-15)
    assert {m.name: dict(m.constants) for m in stated.materials} == {
        "material 1": {"E": 210000.0, "nu": 0.3, "rho": 7.85e-9},
        "material 2": {"E1": 1.1e4, "E2": 370.0, "nu12": 0.44, "G12": 690.0, "G1z": 690.0, "G2z": 50.0, "rho": 4.2e-10},
    }
    (link,), (mass,) = stated.links, stated.masses
    assert (mesh.numbers[link.node], mesh.numbers[link.nodes].tolist()) == (6, [1, 2, 3, 4, 5])
    assert link.follows == (0, 1, 2, 3, 4, 5)
    assert (mesh.numbers[mass.node], mass.mass) == (6, 0.005)
    assert mass.offset == pytest.approx((0.0, 0.0, 0.01), rel=1e-15)  # rounding of the scale
    assert mass.inertia == pytest.approx((2e-6, 3e-6, 4e-6, 0.0, 0.0, 0.0), rel=1e-15)  # rounding of the scale
    assert [(mesh.numbers[one.nodes].tolist(), one.held) for one in stated.holds] == [
        ([1, 2], (0, 1, 2)),
        ([4], (3, 4, 5)),
    ]
    assert left(mesh) == []
    assert left(mesh, harmless=True) == ["1 PSHELL 7 without MID3 (line 17)", "1 PARAM (line 7)", "1 PLOAD4 (line 26)"]


def test_supports_of_other_cards_and_a_factor_of_masses(tmp_path: Path) -> None:
    """SPC, what GRID holds itself, sets that the case control puts to use, and masses times PARAM, WTMASS."""
    text = NASTRAN.replace("SOL 103\n", "SOL 103\nSPC = 8\n").replace("GRID,4,,0.,100.", "GRID,4,,0.,100.,,,25")
    text = text.replace("SET1,9", "SPC,3,5,12,0.,1,3\nSPC,3,2,3,-.1\nSPCADD,8,3\nPARAM,WTMASS,.5\nSET1,9")
    mesh = mesh_of(tmp_path, "a.bdf", text)
    stated = mesh.stated
    held = {(one.name, one.held): one.nodes.tolist() for one in stated.holds}
    assert held[("GRID PS", (1, 4))] == [3] and held[("SPC 3", (0, 1))] == [4] and held[("SPC 3", (2,))] == [0]
    assert stated.active == ("SPC 3", "GRID PS")
    assert mesh_of(tmp_path, "a.bdf", text.replace("SPC = 8\n", "")).stated.active == ("SPC 3", "GRID PS")
    assert stated.masses[0].mass == 0.0025 and stated.masses[0].inertia[0] == pytest.approx(1e-6, rel=1e-15)  # rounding
    assert left(mesh) == ["1 SPC that moves a node (line 29)"]


def test_a_range_of_held_nodes_may_have_gaps(tmp_path: Path) -> None:
    """FIRST THRU LAST of SPC1 holds those that there are; a node that is named must be there."""
    held = mesh_of(tmp_path, "a.bdf", NASTRAN.replace("SPC1,3,456,4", "SPC1,3,456,4,THRU,70")).stated.holds
    assert held[1].nodes.tolist() == [3, 4, 5]
    with pytest.raises(InputError, match="node 70, which it does not have"):
        mesh_of(tmp_path, "a.bdf", NASTRAN.replace("SPC1,3,456,4", "SPC1,3,456,4,70"))


def test_couplings_of_abaqus(tmp_path: Path) -> None:
    """Kinematic ones are rigid links, distributing ones averages; those on faces of elements are named."""
    more = "*SURFACE, TYPE=NODE, NAME=ring\nMORE, 2.\n4, 1.\n*SURFACE, NAME=faces\nBOTH, S1\n"
    more += "*COUPLING, CONSTRAINT NAME=a, REF NODE=6, SURFACE=RING\n*KINEMATIC\n1, 3\n5, 5\n"
    more += "*COUPLING, CONSTRAINT NAME=b, REF NODE=2, SURFACE=ring\n*DISTRIBUTING\n"
    more += "*COUPLING, CONSTRAINT NAME=c, REF NODE=2, SURFACE=faces\n*KINEMATIC\n"
    more += "*KINEMATIC COUPLING, REF NODE=6\nFOOT, 1, 3\n*TIE"
    mesh = mesh_of(tmp_path, "a.inp", ABAQUS.replace("*TIE", more))
    links = mesh.stated.links
    assert [int(mesh.numbers[one.node]) for one in links] == [6, 2, 6]
    assert [sorted(mesh.numbers[one.nodes].tolist()) for one in links] == [[1, 3, 4, 5], [1, 3, 4, 5], [1, 5]]
    assert [one.follows for one in links] == [(0, 1, 2, 4), (0, 1, 2, 3, 4, 5), (0, 1, 2)]
    assert [one.weights for one in links] == [None, (2.0, 2.0, 2.0, 1.0), None]
    assert left(mesh) == ["1 *COUPLING (line 45)", "1 *TIE (line 49)"]
    with pytest.raises(InputError, match=r"a\.inp:34:1: got \*KINEMATIC alone, expected \*COUPLING before it"):
        mesh_of(tmp_path, "a.inp", ABAQUS.replace("*TIE", "*KINEMATIC\n*TIE"))


def test_averages_of_a_bulk_data_file(tmp_path: Path) -> None:
    """RBE3 of two groups of weights; of other directions than 123, or with UM, it is named."""
    card = "RBE3,30,,6,123456,1.0,123,1,2,+\n+,3,2.5,123,4,5\n"
    stated = mesh_of(tmp_path, "a.bdf", NASTRAN.replace("PLOAD4", card + "PLOAD4")).stated
    _, one = stated.links
    assert (one.node, one.nodes.tolist(), one.follows) == (5, [0, 1, 2, 3, 4], (0, 1, 2, 3, 4, 5))
    assert one.weights == (1.0, 1.0, 1.0, 2.5, 2.5)
    other = card.replace("2.5,123,", "2.5,1236,") + card.replace("4,5", "4,5,UM,1,+\n+,123")
    mesh = mesh_of(tmp_path, "a.bdf", NASTRAN.replace("PLOAD4", other + "PLOAD4"))
    assert len(mesh.stated.links) == 1
    assert left(mesh) == ["1 RBE3 of directions 1236 (line 26)", "1 RBE3 with UM (line 28)"]


def test_what_an_input_file_of_abaqus_holds_joins_and_weighs(tmp_path: Path) -> None:
    more = "*ELEMENT, TYPE=MASS, ELSET=LUMPS\n81, 2\n82, 5\n*MASS, ELSET=lumps\n0.25\n*RIGID BODY, REF NODE=6, "
    more += "NSET=FOOT\n*RIGID BODY, REF NODE=4, PIN NSET=MORE\n*BOUNDARY\n3, XSYMM\n2, 4, 4, 0.1\n*TIE"
    mesh = mesh_of(tmp_path, "a.inp", ABAQUS.replace("*TIE", more))
    stated = mesh.stated
    assert [(mesh.numbers[one.node], one.mass) for one in stated.masses] == [(2, 0.25), (5, 0.25)]
    links = [(int(mesh.numbers[one.node]), mesh.numbers[one.nodes].tolist(), len(one.follows)) for one in stated.links]
    assert links == [(6, [1, 5], 6), (4, [3, 1, 5], 3)]
    assert [(mesh.numbers[one.nodes].tolist(), one.held) for one in stated.holds][2:] == [([3], (0, 4, 5))]
    assert left(mesh) == ["1 *TIE (line 44)", "1 *BOUNDARY that moves nodes (line 41)"]
    turning = more.replace("*TIE", "*TRANSFORM, NSET=TURNED\n1, 1, 0, -1, 1, 0\n*TIE")
    turned = mesh_of(
        tmp_path,
        "a.inp",
        ABAQUS.replace("*TIE", turning).replace("*BOUNDARY", "*NSET, NSET=TURNED\n1, 3\n*BOUNDARY", 1),
    )
    assert [(turned.numbers[one.nodes].tolist(), one.held) for one in turned.stated.holds] == [
        ([1, 5], (0, 1, 2)),  # held in all shifts, however they are turned
        ([4], (0, 1, 2, 3, 4, 5)),
    ]
    assert "1 held nodes in directions of *TRANSFORM (line 46)" in left(turned)
    along = turning.replace("-1, 1, 0", "0, 1, 0").replace("1, 1, 0,", "1, 0, 0,")
    same = mesh_of(
        tmp_path, "a.inp", ABAQUS.replace("*TIE", along).replace("*BOUNDARY", "*NSET, NSET=TURNED\n1, 3\n*BOUNDARY", 1)
    )
    assert len(same.stated.holds) == 3 and left(same) == ["1 *TIE (line 48)", "1 *BOUNDARY that moves nodes (line 43)"]


def test_all_that_a_universal_file_says(tmp_path: Path) -> None:
    mesh = mesh_of(tmp_path, "a.unv", UNV)
    assert mesh.cell_sets == {"FLOOR AND SIDE": {"quad4": [0], "tri3": [0]}}
    assert numbers(mesh, "FOOT") == [1, 2, 5]
    assert mesh.numbers[mesh.cells["line2"]].tolist() == [[1, 2]]
    assert left(mesh) == [] and left(mesh, harmless=True) == ["1 data set 55"]


def test_a_cell_of_two_groups_of_gmsh_is_one_cell(tmp_path: Path) -> None:
    """Version 2.2 writes it once for each group; whoever counts both has twice the stiffness and mass."""
    mesh = mesh_of(tmp_path, "a.msh", GMSH)
    assert mesh.merged == 1
    assert mesh.cell_sets == {"floor": {"quad4": [0]}, "both of them": {"quad4": [0], "tri3": [0]}}


def test_cells_of_other_formats_that_are_there_twice_are_kept(tmp_path: Path) -> None:
    """Two shells on the same nodes are how skins are modelled; only Gmsh writes one cell twice."""
    mesh = mesh_of(tmp_path, "a.inp", ABAQUS.replace("11, 1, 2, 3, 4", "11, 1, 2, 3, 4\n13, 1, 2, 3, 4"))
    assert (mesh.merged, len(mesh.cells["quad4"])) == (0, 2)


def test_a_file_of_abaqus_with_one_part_in_an_assembly(tmp_path: Path) -> None:
    """As Abaqus/CAE writes it; a second instance, or one that is moved, would need parts of its own."""
    head, _, rest = ABAQUS.partition("*NSET, NSET=FOOT")
    body = f"*Part, name=Tray\n{head.partition('a tray')[2].lstrip()}*End Part\n*Assembly, name=Assembly\n"
    instance = "*Instance, name=Tray-1, part=Tray\n*End Instance\n"
    sets = "*Nset, nset=FOOT, internal, instance=Tray-1\n1, 5\n*Elset, elset=ONE, instance=Tray-1\n11,\n*End Assembly\n"
    mesh = mesh_of(tmp_path, "a.inp", body + instance + sets)
    assert numbers(mesh, "FOOT") == [1, 5] and mesh.cell_sets["ONE"] == {"quad4": [0]}
    moved = instance.replace("*End", "0., 0., 5.\n*End")
    for wrong in (moved, instance + instance.replace("Tray-1", "Tray-2")):
        with pytest.raises(InputError, match=r"got an instance that is moved, or a second one, expected one part"):
            mesh_of(tmp_path, "a.inp", body + wrong + sets)
    assert rest


def test_an_included_file_stands_in_its_place(tmp_path: Path) -> None:
    head, nodes, rest = ABAQUS.partition("*NODE\n4, 0., 100., 0.\n5, 200., 0., 0.\n6, 50., 50., 30.\n")
    (tmp_path / "nodes.inp").write_text(nodes, encoding="utf-8")
    mesh = mesh_of(tmp_path, "a.inp", f"{head}*INCLUDE, INPUT=nodes.inp\n{rest}")
    assert mesh.points.shape == (6, 3)
    sources: dict[str, str] = {}
    read_mesh_file(tmp_path / "a.inp", sources=sources)
    assert [Path(one).name for one in sources] == ["nodes.inp", "a.inp"]  # whoever changes it changes the mesh
    (tmp_path / "nodes.inp").write_text(nodes.replace("200.", "2OO."), encoding="utf-8")
    with pytest.raises(InputError, match=r"nodes\.inp:3:1: got '2OO\., 0\., 0\.', expected numbers"):
        read_mesh_file(tmp_path / "a.inp")


def test_values_of_arrays_of_vtk_name_sets_and_cells_that_meshio_drops_are_refused(tmp_path: Path) -> None:
    import pyvista

    grid = pyvista.UnstructuredGrid(
        np.array([4, 0, 1, 2, 3, 3, 1, 4, 2]),
        np.array([9, 5]),
        np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2.0, 0, 0]]),
    )
    grid.cell_data["region"] = np.array([3, 8])
    grid.cell_data["t"] = np.array([0.1, 0.2])
    grid.point_data["foot"] = np.array([1, 0, 0, 0, 1], dtype=bool).astype(np.uint8)
    grid.save(tmp_path / "a.vtu")
    mesh = read_mesh_file(tmp_path / "a.vtu")
    assert mesh.cell_sets == {"region=3": {"quad4": [0]}, "region=8": {"tri3": [0]}}
    assert mesh.node_sets["foot=1"].tolist() == [0, 4] and set(mesh.node_sets) == {"foot=0", "foot=1"}
    voxel = pyvista.ImageData(dimensions=(2, 2, 2)).cast_to_unstructured_grid()
    assert voxel.celltypes.tolist() == [11]
    voxel.save(tmp_path / "b.vtu")
    with pytest.raises(InputError, match=r"with 1 cells, of which 0 could be read"):
        read_mesh_file(tmp_path / "b.vtu")


def test_a_grid_of_vtk_that_cannot_be_read_says_why(tmp_path: Path) -> None:
    grid = (
        '<VTKFile type="UnstructuredGrid" version="0.1"><UnstructuredGrid><Piece NumberOfCells="1"/></UnstructuredGrid>'
    )
    (tmp_path / "c.vtu").write_text(grid, encoding="utf-8")
    with pytest.raises(InputError, match=r"'c\.vtu', an unstructured grid that meshio cannot read \(.+\), expected"):
        read_mesh_file(tmp_path / "c.vtu")


MISTAKES = {
    "a.inp": [
        ("5, 200., 0., 0.", "5, 200., O., 0.", r":10:1: got '200\., O\., 0\.', expected numbers"),
        ("5, 200., 0., 0.", "5, 200., 0., 0., 1., 2.", r":10:1: got 6 numbers of a node, expected a number"),
        ("11, 1, 2, 3, 4", "11, 1, 2, 3", r":13:1: got 4 numbers of the last element of type S4R, expected 5: its"),
        ("11, 1, 2, 3, 4", "10, 1, 2\n11, 1, 2, 3, 4", r":13:1: got 3 numbers of an element of type S4R, expected 5"),
        ("11, 1, 2, 3, 4", "11, 1, 2, 3, 4, 5, 6", r":13:1: got 7 numbers of the last element of type S4R, expected 5"),
        ("11, 1, 2, 3, 4", "11, 1, 2, 3, 40", r"'a\.inp' with node 40, which it does not have, expected"),
        ("12, 2,", "11, 2,", r"'a\.inp' with element 11 twice, expected numbers of elements that differ"),
        ("TYPE=S4R", "TYPE=C3D6", r":12:1: got elements of type C3D6, expected bars, shells, tetrahedra or hexahedra"),
        ("*NSET, NSET=MORE", "*NSET", r":19:1: got \*NSET without NSET, expected NSET=\.\.\."),
        ("FOOT, 3", "FEET, 3", r":20:1: got 'FEET', no set above, expected numbers or names of sets"),
        ("1, 5, 4", "1", r":18:1: got '1', expected first, last and step"),
        ("*MATERIAL, NAME=STEEL", "*NGEN\n1, 3", r":23:1: got \*NGEN, which makes or moves nodes or elements"),
        ("*NODE", "*NODES", r"without \*NODE, expected an input file"),
        ("*NODE, NSET", "*NODE, SYSTEM=C, NSET", r":4:1: got nodes in the coordinate system C, expected x, y, z"),
    ],
    "a.bdf": [
        ("GRID,2,,100.,0.,0.", "GRID,2,3,100.,0.,0.", r":9:1: got GRID with the coordinate system 3, which"),
        ("GRID,2,,100.,0.,0.", "GRID,2,,1OO.,0.,0.", r":9:1: got GRID with '1OO\.' in field 4, expected a number"),
        ("SET1,9,1,4,5", "INCLUDE 'b.bdf'", r":27:1: got '.*b\.bdf', which|:27:1: got"),
        ("PLOAD4,1,11,1.", "RBE3,9,,6,123,1.0,123", r":26:1: got RBE3 with 0 nodes with a weight, expected WT1"),
        ("CTRIA3,12,7,2,5,3", "CTRIA3,12,7,2,5", r":16:1: got CTRIA3 with 2 nodes, expected 3 nodes"),
        ("SPC1,3,456,4", "SPC1,3,789,4", r":21:1: got SPC1 with '789' in field 3, expected directions out of 1 to 6"),
        ("CTRIA3,12,7,2,5,3", "CTRIA3,12,7,2,9,3", r"'a\.bdf' with node 9, which it does not have"),
        ("SPC1,3,123,1,THRU,2", "SPC1,3,123,A", r":20:1: got SPC1 with 'A', expected whole numbers, or FIRST"),
    ],
    "a.unv": [
        ("         4         1         1        11", "         4         1        11", r":13:1: got 3 numbers"),
        ("        12        91", "        12       112", r":22:1: got an element of kind 112, expected bars, shells"),
        ("         2         5         3\n", "         2         5\n", r":22:1: got 8 nodes of an element of kind 91"),
        ("   2.0000000000000000D+02", "   2.0000000000000000X+02", r":16:1: got .*, expected numbers"),
        ("         5         0         0\n    -1", "         5         0         0\n", r"expected"),
    ],
    "a.msh": [
        ("2.2 0 8", "4.0 0 8", r":2:1: got version '4\.0' of the format, expected 2\.2 or 4\.1"),
        ("5 200 0 0", "5 200 O 0", r":15:1: got '5 200 O 0', expected numbers"),
        ("$EndElements", "", r":17:1: got \$Elements without its end, expected \$EndElements; the file is cut off"),
        ("3 2 2 2 1 2 5 3", "3 6 2 2 1 2 5 3 1 2 3", r":17:1: got an element of type 6, a wedge, expected lines"),
        ("3 2 2 2 1 2 5 3", "3 2 2 2 1 2 5", r":17:1: got 25 numbers in 3 elements, expected 26"),
        ("5 200 0 0", "4 200 0 0", r"'a\.msh' with node 4 twice, expected numbers of nodes that differ"),
    ],
}  # fmt: skip


@pytest.mark.parametrize(("name", "old", "new", "message"), [(n, *one) for n, some in MISTAKES.items() for one in some])
def test_a_mistake_has_its_file_and_line(name: str, old: str, new: str, message: str, tmp_path: Path) -> None:
    assert old in FILES[name]
    with pytest.raises(InputError) as caught:
        mesh_of(tmp_path, name, FILES[name].replace(old, new))
    assert re.search(message, str(caught.value)), str(caught.value)


@pytest.mark.parametrize("name", FILES)
def test_no_damage_gives_a_traceback(name: str, tmp_path: Path) -> None:
    """Files that are cut off anywhere, or have a character changed, are read or refused in a sentence."""
    text, random = FILES[name], np.random.default_rng(7)
    for _ in range(150):
        at = int(random.integers(len(text)))
        other = str(random.choice(list("0-9,*$ \nA.")))
        for damaged in (text[:at], text[:at] + other + text[at + 1 :]):
            try:
                mesh_of(tmp_path, name, damaged)
            except InputError as error:
                assert "got" in str(error) and "expected" in str(error)


def test_what_is_no_mesh_file_is_refused(tmp_path: Path) -> None:
    for name, message in {
        "a.stp": r"got 'a\.stp', expected a mesh file: \.msh, \.inp",
        "a.vtu": r"got 'a\.vtu', which is no unstructured grid, expected a \.vtu file",
        "b.msh": r"got 'b\.msh', which has no \$MeshFormat, expected a mesh of Gmsh",
        "b.unv": r"without data set 2411",
    }.items():
        with pytest.raises(InputError, match=message):
            mesh_of(tmp_path, name, "nothing\n")
    with pytest.raises(InputError, match="no file"):
        read_mesh_file(tmp_path / "none.msh")


def test_a_set_that_is_not_there_is_named_with_those_that_are(tmp_path: Path) -> None:
    mesh = mesh_of(tmp_path, "a.bdf", NASTRAN)
    with pytest.raises(InputError, match=r"got 'SKIN', no set of a\.bdf, expected PSHELL 7, SET 4, SPC 3"):
        mesh.nodes_of("SKIN")
    with pytest.raises(InputError, match=r"got 'SET 9', a set without triangles .*; sets with them: PSHELL 7, SET 4"):
        mesh.cells_of("SET 9", 2)
    with pytest.raises(InputError, match=r"got no tetrahedra or hexahedra in a\.bdf"):
        mesh.cells_of(None, 3)
    cut = ABAQUS[: ABAQUS.index("*ELEMENT")]
    with pytest.raises(InputError, match=r"got 'STRIP', no set of a\.inp, which has no elements.*; is the file cut\?"):
        mesh_of(tmp_path, "a.inp", cut).cells_of("STRIP", 2)
