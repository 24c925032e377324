"""Hard and soft simple supports of slabs and shells: Navier's solution with shear is that of hard ones, and soft ones
are lower; corners, curved edges, and what the table of inputs says."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import femstruct as fs
from femstruct.errors import FemstructError, InputErrors
from femstruct.language.models import read_model_file
from femstruct.model.imported_mesh import ImportedMesh
from femstruct.study.asked import Extent
from femstruct.study.inputs import inputs
from femstruct.study.study import Study
from tests.data.command_line import femstruct

CONCRETE = fs.Material("concrete", 30e9, 0.2, 2400.0)
A, B, THICK = 2.0, 1.6, 0.25  # thick: 5 % between hard and soft


def slab(fix: Any, mesh: float = 0.1, turn: float = 0.0) -> fs.Structure:
    """On its rim, its outline turned from its axes' global ones by an angle about z, which is in its plane's normal."""
    part = fs.Slab(
        "s", CONCRETE, THICK, ((0, 0), (A, 0), (A, B), (0, B)), mesh,
        x_direction=(float(np.cos(turn)), float(np.sin(turn)), 0.0),
    )  # fmt: skip
    rim = fs.Support("rim", fix, on="s", region=fs.Region("set", named="rim"))
    return fs.Structure("slab", (part,), supports=(rim,))


def frequencies(structure: fs.Structure, count: int = 3) -> Any:
    basis = fs.modal_basis(fs.assemble(fs.mesh_structure(structure)), count=count)
    return basis.frequency_hz[basis.modes][:count]


def navier(m: int, n: int) -> float:
    """First-order plate with 5/6 of the shear modulus and rotary inertia: w, beta_x, beta_y as half waves."""
    E, nu, h = CONCRETE.E, CONCRETE.nu, THICK
    D, S, x, y = E * h**3 / 12 / (1 - nu**2), 5 / 6 * E / 2 / (1 + nu) * h, m * np.pi / A, n * np.pi / B
    K = np.array([
        [S * (x**2 + y**2), S * x, S * y],
        [S * x, D * (x**2 + (1 - nu) / 2 * y**2) + S, D * (1 + nu) / 2 * x * y],
        [S * y, D * (1 + nu) / 2 * x * y, D * (y**2 + (1 - nu) / 2 * x**2) + S],
    ])  # fmt: skip
    M = 2400.0 * np.array([h, h**3 / 12, h**3 / 12])
    return float(np.sqrt(np.linalg.eigvals(K / M[:, None]).real.min()) / 2 / np.pi)


@pytest.mark.parametrize("turn", [0.0, 0.4])
def test_hard_edges_have_naviers_frequencies(turn: float) -> None:
    exact = sorted(navier(m, n) for m in (1, 2) for n in (1, 2))[:3]
    coarse, fine = (frequencies(slab("simple hard", mesh, turn)) for mesh in (0.2, 0.1))
    assert (4.0 * fine - coarse) / 3.0 == pytest.approx(exact, rel=2e-3)  # extrapolated: h^2; corners are of a mesh
    assert fine[0] == pytest.approx(exact[0], rel=5e-3)  # h^2
    soft = frequencies(slab("simple soft", 0.1, turn))
    assert soft[0] < 0.97 * exact[0]
    assert soft == pytest.approx(frequencies(slab("simple", 0.1, turn)), rel=1e-12)  # it is what simple is there
    assert soft == pytest.approx(frequencies(slab(("x", "y", "z"), 0.1, turn)), rel=1e-12)  # rounding


def test_a_polygon_for_a_circle_is_no_clamped_edge() -> None:
    """At its corners the mean direction is held: both would clamp it, twice as stiff."""
    rings, around = 6, 32
    points, quads, triangles = [[0.0, 0.0, 0.0]], [], []
    for ring in range(1, rings + 1):
        angles = 2 * np.pi * np.arange(around) / around
        points += [[ring / rings * np.cos(at), ring / rings * np.sin(at), 0.0] for at in angles]
    for at in range(around):
        after = (at + 1) % around
        triangles.append([0, 1 + at, 1 + after])
        for ring in range(rings - 1):
            first, second = 1 + ring * around, 1 + (ring + 1) * around
            quads.append([first + at, second + at, second + after, first + after])
    numbers = np.arange(1, len(points) + 1)
    cells = {"quad4": np.array(quads), "tri3": np.array(triangles)}
    edge = {"edge": np.arange(1 + (rings - 1) * around, 1 + rings * around)}
    mesh = ImportedMesh(
        "disc", points, numbers, cells, {"quad4": np.arange(len(quads)), "tri3": np.arange(around)}, edge
    )
    found = {}
    for fix in ("simple soft", "simple hard", "clamped"):
        part = fs.Shell("disc", mesh, CONCRETE, 0.02)
        held = fs.Support("edge", fix, on="disc", region=fs.Region("set", named="edge"))
        found[fix] = frequencies(fs.Structure("disc", (part,), supports=(held,)), 1)[0]
    # thin, nu 0.2: lambda^2 4.8601 of a simple, 10.2158 of a clamped edge (Leissa 1969, table 2.1 and eq. 2.12)
    D, m = 30e9 * 0.02**3 / 12 / (1 - 0.2**2), 2400.0 * 0.02
    thin = np.sqrt(D / m) / (2 * np.pi)
    assert found["clamped"] == pytest.approx(10.2158 * thin, rel=0.02)  # 6 cells a radius
    assert found["simple hard"] == pytest.approx(4.8601 * thin, rel=0.03)  # 6 cells a radius, a polygon
    assert found["simple soft"] <= found["simple hard"]


MODEL = """
materials: {c: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts:
  s: {type: slab, material: c, thickness: 250 mm, outline: [[0, 0], [2, 0], [2, 1.6], [0, 1.6]], mesh: 200 mm}
  p: {type: plate, material: c, thickness: 20 mm, origin: [5, 0, 0], size: [2, 1.6], mesh: [4, 4]}
points: {q: {on: s, at: [1, 0.8]}}
supports:
  rim: {on: s, set: rim, fix: simple}
  edges: {on: p, edge: all, fix: simple}
"""


def test_the_table_of_inputs_says_which_they_are(tmp_path: Path) -> None:
    (tmp_path / "m.yaml").write_text(MODEL, encoding="utf-8")
    source = read_model_file(tmp_path / "m.yaml")
    assert isinstance(source.structure, fs.Structure)
    asked = inputs(Study("hit", source.structure, source.damping, Extent(count=1)))
    told = {one.name: {row.what: row.value for row in one.given} for one in asked.groups["supports"]}
    assert told["rim"]["fix"] == "simple soft"
    assert told["edges"]["fix"] == "simple hard"  # a thin plate has no other
    (tmp_path / "m.yaml").write_text(MODEL.replace("rim, fix: simple", "rim, fix: simple hard"), encoding="utf-8")
    hard = read_model_file(tmp_path / "m.yaml").structure
    assert isinstance(hard, fs.Structure) and hard.supports[0].fix == "simple hard"


def test_check_says_which_they_are(tmp_path: Path) -> None:
    (tmp_path / "m.yaml").write_text(MODEL, encoding="utf-8")
    assert "simple supports of edges: rim soft, edges hard" in femstruct("check", tmp_path / "m.yaml").stdout
    for fix, told in (("simple hard", {"rim": "hard"}), ("[x, y, z]", {"rim": "soft"}), ("[z, rx, ry]", {})):
        text = MODEL.replace("rim, fix: simple", f"rim, fix: {fix}")
        (tmp_path / "m.yaml").write_text(text, encoding="utf-8")
        table = json.loads(femstruct("check", tmp_path / "m.yaml", "--json").stdout)
        assert table["simple_supports"] == {**told, "edges": "hard"}


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("all, fix: simple", "all, fix: simple soft", r"supports\.edges\.fix: got 'simple soft' of a thin plate"),
        ("on: s, set: rim, fix: simple", "on: s, fix: simple hard", r"fix: got 'simple hard' of a whole part"),
        ("on: s, set: rim, fix: simple", "at: q, fix: simple hard", r"fix: got 'simple hard' of a point"),
        ("rim, fix: simple", "rim, fix: hard", r"clamped, simple hard, simple soft or a list"),
    ],
)
def test_what_has_no_hard_or_soft_edge_is_refused(old: str, new: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "m.yaml").write_text(MODEL.replace(old, new), encoding="utf-8")
    with pytest.raises(InputErrors, match=told):
        read_model_file(tmp_path / "m.yaml")


def test_a_set_without_an_edge_has_no_hard_one() -> None:
    structure = slab("simple hard")
    inside = replace(structure.supports[0], region=fs.Region("box", box=((0.35, 0.35, -1.0), (0.65, 0.65, 1.0))))
    with pytest.raises(FemstructError, match="without a free edge"):
        fs.mesh_structure(replace(structure, supports=(inside,)))
