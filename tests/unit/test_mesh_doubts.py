"""What is doubtful about a mesh is found, with the cells by their numbers in the file, and nothing on a good one."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import femstruct as fs
from femstruct.errors import InputErrors
from femstruct.findings.catalogue import rank_of
from femstruct.findings.entry import FORBIDS, LIMITS
from femstruct.model.unused import unused_findings
from femstruct.workflow.structure_findings import structure_findings_before

GRID = [(1 + i + 5 * j, 0.1 * i, 0.1 * j, 0.0) for j in range(4) for i in range(5)]
QUADS = [
    (1 + i + 4 * j, 1 + i + 5 * j, 2 + i + 5 * j, 7 + i + 5 * j, 6 + i + 5 * j) for j in range(3) for i in range(4)
]


def text(nodes: object = GRID, cells: object = QUADS, more: str = "") -> str:
    lines = ["*NODE", *(", ".join(map(str, one)) for one in nodes), "*ELEMENT, TYPE=S4, ELSET=SKIN"]  # type: ignore[attr-defined]
    return "\n".join([*lines, *(", ".join(map(str, one)) for one in cells), more, ""])  # type: ignore[attr-defined]


def found(tmp_path: Path, written: str, scale: float = 1.0, thickness: float | None = 0.01) -> dict[str, str]:
    (tmp_path / "skin.inp").write_text(written, encoding="utf-8")
    steel = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
    part = fs.Shell("skin", fs.read_mesh_file(tmp_path / "skin.inp", scale), steel, thickness)
    structure = fs.Structure("a", (part,), supports=(fs.Support("all", ("z",), on="skin"),))
    findings = structure_findings_before(structure, fs.mesh_structure(structure))
    return {one.code: one.message for one in findings if not one.severe or one.code == "mesh-states-more"}


MESH = (
    "mesh-in-other-units",
    "bad-cells",
    "cells-twice",
    "open-seam",
    "mesh-states-more",
    "nodes-alone",
    "mesh-without-end",
)


def test_a_good_mesh_is_not_doubted(tmp_path: Path) -> None:
    assert not set(found(tmp_path, text())) & set(MESH)


def larger(times: float) -> list[tuple[float, ...]]:
    return [(n, times * x, times * y, times * z) for n, x, y, z in GRID]


@pytest.mark.parametrize(
    ("times", "scale", "thickness", "meant"),
    [
        (200.0, 1.0, 3e-3, "Did you mean 'scale: mm' for a file in millimetres?"),  # of 80 mm, thickness in metres
        (1.0, 1e-3, 0.01, "Did you mean no 'scale' for a file in metres?"),
        (0.4, 1.0, 0.9, "Did you mean a thickness of 0.9 mm?"),
        (400.0, 1e-3, 0.9, "Did you mean a thickness of 0.9 mm, or no 'scale' for a file in metres?"),
        (1.0, 1.0, 0.3e-3, "Check the thickness"),  # of 0.4 m, and a file in millimetres would be of 0.4 mm
    ],
)
def test_cells_that_do_not_fit_the_thickness_are_found(
    times: float, scale: float, thickness: float, meant: str, tmp_path: Path
) -> None:
    told = found(tmp_path, text(larger(times)), scale, thickness)["mesh-in-other-units"]
    assert told.startswith(f"skin: the mesh is {0.4 * times * scale:g} m large. A typical cell has sides of ")
    assert told.endswith(f"the thickness of {thickness:g} m. {meant}")


SECTION = "*SHELL SECTION, ELSET=SKIN, MATERIAL=ST\n{}"


@pytest.mark.parametrize(
    ("times", "scale", "do"), [(1e3, 1.0, "mm"), (1.0, 1e3, ""), (1e3, 1e3, "mm"), (300.0, 1.0, "mm")]
)
def test_a_mesh_and_its_thickness_in_millimetres_are_found(times: float, scale: float, do: str, tmp_path: Path) -> None:
    written = text(larger(times), more=SECTION.format(3e-3 * times))
    told = found(tmp_path, written, scale, None)["mesh-in-other-units"]
    size, thick = 0.4 * times * scale, 3e-3 * times * scale
    mass = 7850.0 * 0.4 * 0.3 * 3e-3 * (times * scale) ** 3
    assert f"is {size:.4g} m large and {thick:.4g} m thick as read, with {mass:.4g} kg; in mill" in told
    assert (
        f"would be {0.4e-3 * times:.4g} m and {3e-3 * times:.4g} mm thick, with {mass / (1e3 * scale) ** 3:.4g} kg"
        in told
    )
    assert told.endswith("Did you mean 'scale: mm'?" if do else "Check its 'scale', which is 1000 m")
    assert "mesh-in-other-units" not in found(tmp_path, written, 1.0 / times, None)


def test_a_point_off_a_mesh_in_millimetres_asks_for_its_unit(tmp_path: Path) -> None:
    (tmp_path / "skin.inp").write_text(text(larger(1e3)), encoding="utf-8")
    steel = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
    for scale, asks in ((1.0, True), (1e-3, False)):
        part = fs.Shell("skin", fs.read_mesh_file(tmp_path / "skin.inp", scale), steel, 0.01)
        point = fs.PlaceOn("top", "skin", at=((0.1, 0.1, 5.0),))
        with pytest.raises(fs.InputError, match="off skin") as refused:
            fs.mesh_structure(fs.Structure("a", (part,), points=(point,)))
        asked = "the mesh is 400 m large; write 'scale: mm' for a file in millimetres"
        assert refused.value.do == (asked if asks else "")


def test_a_shell_thicker_than_wide_is_refused(tmp_path: Path) -> None:
    meant = r"got 4 m, expected at most the shell's shorter side, 0\.3 m; plain numbers are metres: 4 mm\?"
    with pytest.raises(fs.InputError, match=r"parts\.skin\.thickness: " + meant):
        found(tmp_path, text(), thickness=4.0)
    steel, mesh = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0), fs.read_mesh_file(tmp_path / "skin.inp")
    layers = fs.Laminate((fs.Layer(steel, 2e-3), fs.Layer(steel, 4.0)))
    part = fs.Shell("skin", mesh, layers, orientation=(1.0, 0.0, 0.0))
    with pytest.raises(fs.InputError, match=r"parts\.skin\.layers: got 4\.002 m in all, .*: 4 mm\?"):
        fs.mesh_structure(fs.Structure("a", (part,)))


def test_bad_cells_are_named_with_their_place(tmp_path: Path) -> None:
    moved = [(n, x + 0.045, y + 0.045, z) if n == 13 else (n, x, y, z) for n, x, y, z in GRID]
    told = found(tmp_path, text(moved))["bad-cells"]
    assert (
        "1 of 12 cells have a bad shape: 1 with a blunt corner (element 11; the first at (0.2613, 0.2613, 0) m)" in told
    )
    lifted = [(n, x, y, 0.06) if n == 13 else (n, x, y, z) for n, x, y, z in GRID]
    assert "warped (element" in found(tmp_path, text(lifted))["bad-cells"]


def test_cells_twice_are_named(tmp_path: Path) -> None:
    told = found(tmp_path, text(cells=[*QUADS, (99, *QUADS[5][1:][::-1])]))["cells-twice"]
    assert told.startswith("skin: 1 cells have the nodes of others: element ") and "at (0.15, 0.15, 0) m" in told


def test_an_open_seam_is_found(tmp_path: Path) -> None:
    split = [*GRID, *((n + 100, x, y, z) for n, x, y, z in GRID if 11 <= n <= 15)]
    cells = [(n, *(m + 100 if n > 8 and m <= 15 else m for m in nodes)) for n, *nodes in QUADS]
    told = found(tmp_path, text(split, cells))["open-seam"]
    assert told.startswith("skin: 5 pairs of nodes are at one place and are not one node, such as 1")


def test_what_a_file_states_beside_its_mesh_is_named(tmp_path: Path) -> None:
    more = "*NSET, NSET=FEET\n1, 2\n*BOUNDARY\nFEET, 1, 6\n*TIE, NAME=A\n*MASS, ELSET=X\n20."
    (tmp_path / "skin.inp").write_text(text(more=more), encoding="utf-8")
    steel, mesh = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0), fs.read_mesh_file(tmp_path / "skin.inp")
    part = fs.Shell("skin", mesh, steel, 0.01)
    held = fs.Support("feet", ("x", "y", "z"), on="skin", region=fs.Region("set", named="FEET"))
    for supports, told in (((), True), ((held,), False)):
        structure = fs.Structure("a", (part,), supports=supports)
        findings = structure_findings_before(structure, fs.mesh_structure(structure))
        severe, *others = [one for one in findings if one.code == "mesh-states-more"]
        assert severe.message.startswith("skin: skin.inp states what the model does not have, so that it is another")
        assert "1 *TIE (line 39) [surfaces or nodes that are joined; write joints or constraints]" in severe.message
        assert "1 *MASS (line 40) [masses at nodes; write masses]" in severe.message
        assert rank_of(severe.code, severe.severe) is FORBIDS
        assert [one.message.partition(". ")[0] for one in others] == told * [
            "skin: skin.inp states what no part uses: 1 held sets"
        ]
        assert all(rank_of(one.code, one.severe) is LIMITS for one in others)


def test_elements_that_no_part_uses_are_named(tmp_path: Path) -> None:
    far = "*NODE\n91, 0, 0, 0.1\n92, 0.1, 0, 0.1\n93, 0.1, 0.1, 0.1\n94, 0, 0.1, 0.1"
    lump = f"{far}\n*ELEMENT, TYPE=C3D8, ELSET=LUMP\n90, 1, 2, 7, 6, 91, 92, 93, 94"
    beams = "*ELEMENT, TYPE=B31, ELSET=RIDGE\n95, 1, 2\n96, 2, 3\n*BEAM SECTION, ELSET=RIDGE, SECTION=RECT, MATERIAL=ST"
    marks = "*ELEMENT, TYPE=T3D2, ELSET=RIM\n97, 1, 2"  # as mesh programs write the edge of a shell
    assert "no part uses: 1 C3D8 elements (set LUMP). Their" in found(tmp_path, text(more=lump))["mesh-states-more"]
    told = found(tmp_path, text(more="\n".join((beams, marks))))["mesh-states-more"]
    assert "model does not have, so that it is another structure: 2 B31 elements (set RIDGE) [stiffness" in told
    rods = f"{marks}\n*SOLID SECTION, ELSET=RIM, MATERIAL=ST\n1e-4"  # with a section they are rods
    assert "1 T3D2 elements (set RIM) [stiffness" in found(tmp_path, text(more=rods))["mesh-states-more"]
    assert "mesh-states-more" not in found(tmp_path, text(more=marks))
    (tmp_path / "skin.inp").write_text(text(more=lump + "\n*ELSET, ELSET=LEFT\n1, 2"), encoding="utf-8")
    steel, mesh = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0), fs.read_mesh_file(tmp_path / "skin.inp")
    skin, lumped = fs.Shell("skin", mesh, steel, 0.01, "SKIN"), fs.Solid("lump", mesh, steel, "LUMP")
    left = fs.Shell("left", mesh, steel, 0.01, "LEFT")
    assert unused_findings(fs.Structure("a", (skin, lumped))) == ()
    (one,) = unused_findings(fs.Structure("a", (left, lumped)))
    assert one.message.startswith("left, lump: skin.inp states what no part uses: 10 S4 elements (set SKIN). Their")


def test_a_set_and_one_that_contains_it_are_in_one_place(tmp_path: Path) -> None:
    (tmp_path / "skin.inp").write_text(text(more="*ELSET, ELSET=LEFT\n1, 5, 9, 2"), encoding="utf-8")
    steel, mesh = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0), fs.read_mesh_file(tmp_path / "skin.inp")
    both = fs.Shell("skin", mesh, steel, 0.01), fs.Shell("doubler", mesh, steel, 0.02, "LEFT")
    structure = fs.Structure("a", both)
    told = structure_findings_before(structure, fs.mesh_structure(structure))
    (twice,) = [one for one in told if one.code == "overlapping-parts"]
    assert twice.severe and twice.message.startswith("skin and doubler have 4 cells in one place, 100 % of the smaller")
    glued = fs.Structure("a", both, (fs.Joint("glue", "skin", "doubler"),))
    told = structure_findings_before(glued, fs.mesh_structure(glued))
    assert "overlapping-parts" not in [one.code for one in told]


def test_solids_are_doubted_alike(tmp_path: Path) -> None:
    corners = [(1 + i + 2 * j + 4 * k, i, j, k) for k in (0, 1) for j in (0, 1) for i in (0, 1)]
    far = [(n + 10, x + 1, y, z) for n, x, y, z in corners]
    cells = [(1, 1, 2, 4, 3, 5, 6, 8, 7), (2, 11, 12, 14, 13, 15, 16, 18, 17), (9, 11, 12, 14, 13, 15, 16, 18, 17)]
    written = text([*corners, *far], cells).replace("TYPE=S4", "TYPE=C3D8")
    (tmp_path / "block.inp").write_text(written, encoding="utf-8")
    steel = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
    numbers = (
        "block: the mesh is {:g} m large as read, with {:.4g} kg; in millimetres it would be {:g} m, with {:.4g} kg. {}"
    )
    tons = 3 * 7850.0
    wrong_at = {
        1.0: None,
        1e3: numbers.format(2e3, 1e9 * tons, 2e-3, 1e-9 * tons, "Did you mean 'scale: mm'?"),
        20.0: numbers.format(40, 8e3 * tons, 2e-3, 1e-9 * tons, "Did you mean 'scale: mm'?"),  # by its mass
        1e-4: "block: the mesh is 0.0002 m large. Did you mean no 'scale' for a file in metres?",
    }
    for scale, wrong in wrong_at.items():
        block = fs.Solid("block", fs.read_mesh_file(tmp_path / "block.inp", scale), steel)
        told = {one.code: one.message for one in block.implausible(lies=False)}
        assert told.pop("cells-twice").startswith("block: 1 cells have the nodes of others: element 2; the first at (")
        assert told.pop("open-seam").startswith("block: 4 pairs of nodes are at one place")
        assert told.get("mesh-in-other-units") == wrong


def test_normals_and_areas_do_not_depend_on_the_numbering(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    turned = [
        (n, *np.roll(nodes if rng.random() < 0.5 else nodes[::-1], rng.integers(4)).tolist()) for n, *nodes in QUADS
    ]
    (tmp_path / "skin.inp").write_text(text(cells=turned), encoding="utf-8")
    steel = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
    part = fs.Shell("skin", fs.read_mesh_file(tmp_path / "skin.inp"), steel, 0.01)
    model = fs.mesh_structure(fs.Structure("a", (part,), surfaces=(fs.SurfaceOn("top", "skin"),)))
    assert (model.surfaces["top"].normals == [0.0, 0.0, 1.0]).all()


def test_nodes_without_elements_are_counted(tmp_path: Path) -> None:
    """A file that is cut among its elements: of 12 cells of 20 nodes 8 are left, which leaves the last row of 5."""
    told = found(tmp_path, text(cells=QUADS[:8]))["nodes-alone"]
    assert told.startswith(
        "skin: skin.inp has 5 nodes of 20 that no element, link or mass uses, such as 16, 17, 18, 19 "
    )
    mast = [*GRID, (50, 0.2, 0.2, 0.5)]
    assert "nodes-alone" in found(tmp_path, text(mast))
    link = "*NSET, NSET=FOOT\n1, 2\n*RIGID BODY, REF NODE=50, TIE NSET=FOOT"
    assert "nodes-alone" not in found(tmp_path, text(mast, more=link))


BULK = """GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
GRID,3,,1.,1.,0.
GRID,4,,0.,1.,0.
GRID,5,,.5,.5,1.
CQUAD4,1,1,1,2,3,4
PSHELL,1,1,.01,1,,1
RBE2,9,5,123456,1,2,3,4
"""


def test_bulk_data_without_its_end(tmp_path: Path) -> None:
    """A whole deck is refused, with its last line; bulk data alone gets a remark, and none with ENDDATA."""
    path = tmp_path / "skin.bdf"
    steel = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
    for end, codes in (("", ["mesh-without-end"]), ("ENDDATA\n", [])):
        path.write_text(BULK + end, encoding="utf-8")
        told = unused_findings(fs.Structure("a", (fs.Shell("skin", fs.read_mesh_file(path), steel, 0.01),)))
        assert [one.code for one in told if one.code != "mesh-states-more"] == codes
    assert fs.read_mesh_file(path).stated.open_end == ""
    for words, expected in (
        ("CEND\nBEGIN BULK\n" + BULK, "skin.bdf:10:1: got the end of the file after RBE2 of line 10, expected ENDDATA"),
        (
            BULK.rstrip() + ",+\n",
            "skin.bdf:8:1: got the end of the file within RBE2 of line 8, expected its continuation",
        ),
    ):
        path.write_text(words, encoding="utf-8")
        with pytest.raises(InputErrors, match=re.escape(expected)):
            fs.read_mesh_file(path)
