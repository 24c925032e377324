"""The same Abaqus file solved by CalculiX and read by us: a solid and a folded shell, clamped at one end.

Skipped where `ccx` is not installed: it is in Debian's package calculix-ccx, version 2.20 here.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import femstruct as fs
from femstruct.elements import solid

CCX = shutil.which("ccx")
needs_ccx = pytest.mark.skipif(CCX is None, reason="ccx is not installed: Debian's package calculix-ccx")
STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
THICKNESS = 4e-3
MODES = 6


def brick_mesh() -> tuple[np.ndarray, np.ndarray]:
    """An L of bricks of 20 nodes: 0.4 m x 0.06 m x 0.04 m, with an upright of 0.12 m at its end."""
    cells = [(i, j, k) for i in range(20) for j in range(3) for k in range(2)]
    cells += [(i, j, k) for i in (18, 19) for j in range(3) for k in range(2, 8)]
    places = np.array(cells)[:, None] + solid.reference_nodes("hex20")
    whole, numbers = np.unique(np.rint(2 * places.reshape(-1, 3)).astype(int), axis=0, return_inverse=True)
    return whole / 2.0 * 0.02, numbers.reshape(-1, 20)


def folded_mesh() -> tuple[np.ndarray, np.ndarray]:
    """A shelf of 0.3 m x 0.2 m with a flange of 0.05 m along one side, of quadrilaterals of 8 nodes."""
    side, high, unit = 20, 20, [(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0), (1, 0.5), (0.5, 1), (0, 0.5)]
    shares = np.concatenate(
        [np.array([(i + u, j + v) for u, v in unit]) for i in range(side) for j in range(high)]
    ).reshape(-1, 8, 2)
    doubled = np.rint(2 * shares).astype(int)
    whole, numbers = np.unique(doubled.reshape(-1, 2), axis=0, return_inverse=True)
    along = whole[:, 1] / 2.0 * 0.0125  # over 0.2 m of the shelf, then down the flange
    flat, down = np.minimum(along, 0.2), np.maximum(along - 0.2, 0.0)
    return np.column_stack([whole[:, 0] / 2.0 * 0.015, flat, -down]), numbers.reshape(-1, 8)


def written(path: Path, points: np.ndarray, cells: np.ndarray, word: str, section: str, held: str) -> None:
    """An input file of CalculiX for the first natural frequencies."""
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{i}, {x:.9g}, {y:.9g}, {z:.9g}" for i, (x, y, z) in enumerate(points, 1)]
    lines += [f"*ELEMENT, TYPE={word}, ELSET=BODY"]
    for i, cell in enumerate(cells + 1, 1):
        numbers = [i, *cell]
        pieces = [numbers[k : k + 11] for k in range(0, len(numbers), 11)]
        lines.append(",\n".join(", ".join(map(str, piece)) for piece in pieces))
    lines += ["*NSET, NSET=WALL"]
    lines += [str(i) for i in np.flatnonzero(points[:, 0] < 1e-9) + 1]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", "210e9, 0.3", "*DENSITY", "7850", section]
    lines += ["*BOUNDARY", held, "*STEP", "*FREQUENCY", str(MODES), "*NODE PRINT, NSET=WALL", "U", "*END STEP"]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def by_calculix(path: Path) -> np.ndarray:
    """Natural frequencies [Hz] from the table that ccx writes."""
    subprocess.run([str(CCX), path.stem], cwd=path.parent, check=True, capture_output=True, timeout=300)
    found = []
    for line in path.with_suffix(".dat").read_text(encoding="ascii").splitlines():
        words = line.split()
        if len(words) == 5 and words[0] == str(len(found) + 1):
            found.append(float(words[3]))
    return np.array(found[:MODES])


def by_us(part: fs.Solid | fs.Shell, fix: tuple[str, ...]) -> np.ndarray:
    wall = fs.Support("wall", fix, on="body", region=fs.Region("set", named="WALL"))
    basis = fs.modal_basis(fs.assemble(fs.mesh_structure(fs.Structure("a", (part,), supports=(wall,)))), count=MODES)
    return np.asarray(basis.frequency_hz[basis.modes])


@needs_ccx
@pytest.mark.parametrize("kind", ["solid", "shell"])
def test_the_same_file_has_the_same_frequencies(kind: str, tmp_path: Path) -> None:
    """C3D20R is integrated with fewer points than our bricks, S8R is a solid inside: 0.5 % is asked for."""
    path = tmp_path / f"{kind}.inp"
    if kind == "solid":
        written(path, *brick_mesh(), "C3D20R", "*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL", "WALL, 1, 3")
        own = by_us(fs.Solid("body", fs.read_mesh_file(path), STEEL), ("x", "y", "z"))
    else:
        section = f"*SHELL SECTION, ELSET=BODY, MATERIAL=STEEL\n{THICKNESS}"
        written(path, *folded_mesh(), "S8R", section, "WALL, 1, 6")
        own = by_us(fs.Shell("body", fs.read_mesh_file(path), STEEL, THICKNESS), ("x", "y", "z", "rx", "ry", "rz"))
    theirs = by_calculix(path)
    np.testing.assert_allclose(own, theirs, rtol=5e-3, err_msg=f"{kind}: ours {own}, CalculiX {theirs}")  # asked for


@needs_ccx
@pytest.mark.parametrize("how", ["rigid body", "kinematic coupling"])
def test_supports_a_spider_and_a_mass_of_the_file_are_taken(how: str, tmp_path: Path) -> None:
    """A spider on the top of the upright, to a node 0.1 m above it with a mass as heavy as the brick."""
    path = tmp_path / "lumped.inp"
    points, cells = brick_mesh()
    written(path, points, cells, "C3D20R", "*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL", "WALL, 1, 3")
    middle, top = len(points) + 1, np.flatnonzero(points[:, 2] > 0.16 - 1e-9) + 1
    more = ["*NODE", f"{middle}, 0.38, 0.03, 0.26", "*NSET, NSET=TOP", *map(str, top)]
    if how == "rigid body":
        more += [f"*RIGID BODY, NSET=TOP, REF NODE={middle}"]
    else:
        more += ["*SURFACE, TYPE=NODE, NAME=ON", "TOP", f"*COUPLING, REF NODE={middle}, SURFACE=ON, CONSTRAINT NAME=C"]
        more += ["*KINEMATIC", "1, 3"]
    more += ["*ELEMENT, TYPE=MASS, ELSET=LUMP", f"100000, {middle}"]
    more += ["*MASS, ELSET=LUMP", "7.5", "*BOUNDARY"]
    path.write_text(path.read_text(encoding="ascii").replace("*BOUNDARY", "\n".join(more), 1), encoding="ascii")
    mesh = fs.read_mesh_file(path)
    parts = (fs.Solid("body", mesh, STEEL), fs.Attachments("rest", mesh, ("supports", "links", "masses")))
    basis = fs.modal_basis(fs.assemble(fs.mesh_structure(fs.Structure("a", parts))), count=MODES)
    own, theirs = basis.frequency_hz[basis.modes], by_calculix(path)
    np.testing.assert_allclose(own, theirs, rtol=5e-3, err_msg=f"ours {own}, CalculiX {theirs}")  # asked for
    bare = fs.modal_basis(
        fs.assemble(fs.mesh_structure(fs.Structure("a", (parts[0], fs.Attachments("rest", mesh, ("supports",)))))),
        count=2,
    )
    assert bare.frequency_hz[bare.modes][0] > 1.5 * own[0]


@needs_ccx
def test_supports_of_the_step_of_the_modes_are_taken(tmp_path: Path) -> None:
    """A strip whose ends are pinned in the step, as preprocessors of CalculiX write it."""
    unit = [(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0), (1, 0.5), (0.5, 1), (0, 0.5)]
    corners = np.array([[(i + u, j + v) for u, v in unit] for i in range(20) for j in (0, 1)])
    doubled = np.rint(2 * corners).astype(int)
    whole, numbers = np.unique(doubled.reshape(-1, 2), axis=0, return_inverse=True)
    points = np.column_stack([whole[:, 0] / 40.0, whole[:, 1] / 20.0, np.zeros(len(whole))])
    path = tmp_path / "strip.inp"
    section = "*SHELL SECTION, ELSET=BODY, MATERIAL=STEEL\n0.05"
    written(path, points, numbers.reshape(-1, 8), "S8R", section, "")
    ends = "\n".join(str(i) for i in np.flatnonzero(np.abs(points[:, 0] - 0.5) > 0.5 - 1e-9) + 1)
    text = path.read_text(encoding="ascii").replace("*BOUNDARY\n\n*STEP", f"*NSET, NSET=ENDS\n{ends}\n*STEP")
    path.write_text(text.replace("*NODE PRINT", "*BOUNDARY\nENDS, 1, 3\n*NODE PRINT"), encoding="ascii")
    mesh = fs.read_mesh_file(path)
    body, rest = fs.Shell("body", mesh, STEEL), fs.Attachments("rest", mesh, ("supports",))
    basis = fs.modal_basis(fs.assemble(fs.mesh_structure(fs.Structure("a", (body, rest)))), count=1)
    # 0.05 %: a quadrilateral of 8 nodes is four of 4 here
    assert basis.frequency_hz[basis.modes][0] == pytest.approx(by_calculix(path)[0], rel=1e-3)
