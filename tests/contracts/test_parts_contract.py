"""What every kind of part with nodes must have, run on all: rigid motions, mass, points, and what is drawn of them."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import csr_array

import femstruct as fs
from femstruct.conventions import N_COMPONENTS
from femstruct.elements import frame, plate
from femstruct.language.model_file import PART_KINDS
from femstruct.model.component import Component
from femstruct.model.imported_mesh import ImportedMesh, Stated, StatedLink, StatedMass
from femstruct.model.model import Model
from femstruct.model.part import Meshed, Part
from femstruct.model.sections import rectangle

STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
TILTED = (0.0, -0.6, 0.8)  # normal of a plate
TRAY = ImportedMesh(  # a bottom of 2 m^2 and a side of 1.25 m^2, folded; one cell of the side runs the other way
    "tray.msh",
    [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0], [0, -0.3, 0.4], [1, -0.3, 0.4], [2, -0.6, 0.8]],
    np.arange(1, 10),
    {"quad4": [[0, 1, 4, 3], [0, 1, 7, 6], [2, 8, 7, 1]], "tri3": [[1, 2, 5], [4, 1, 5]]},
    {"quad4": np.arange(1, 4), "tri3": [4, 5]},
    cell_sets={"bottom": {"quad4": [0], "tri3": [0, 1]}, "side": {"quad4": [1, 2]}},
)
BRICKS = ImportedMesh(  # two bricks, 2 m x 1 m x 0.4 m
    "bricks.msh",
    [[x, y, z] for z in (0.0, 0.4) for y in (0.0, 1.0) for x in (0.0, 1.0, 2.0)],
    np.arange(1, 13),
    {"hex8": [[0, 1, 4, 3, 6, 7, 10, 9], [1, 2, 5, 4, 7, 8, 11, 10]]},
    {"hex8": [1, 2]},
)
SPIDER = ImportedMesh(  # the tray, and two nodes off it that lead links to it
    "spider.bdf",
    [*TRAY.points.tolist(), [0.5, 0.5, 0.4], [1.5, 0.5, 0.4]],
    np.arange(1, 12),
    TRAY.cells,
    TRAY.cell_numbers,
    stated=Stated(
        masses=(StatedMass(9, 3.0, (0.0, 0.1, 0.2), (1.0, 1.5, 2.0, 0.0, 0.1, 0.0)),),
        links=(StatedLink(9, np.array([0, 1, 3, 10]), tuple(range(6))), StatedLink(10, np.array([1, 2]), (0, 1, 2))),
    ),
)
PAIR = Component(  # two masses of 3 and 2 kg on springs between them, and a modal coordinate of the second
    "pair.npz",
    csr_array(np.diag([3.0, 3.0, 3.0, 2.0, 2.0, 2.0, 1.0])),
    csr_array((7, 7)),
    csr_array(np.kron(np.array([[1e3, -1e3, 0.0], [-1e3, 1e3, 0.0], [0.0, 0.0, 0.0]]), np.eye(3))[:7, :7])
    + csr_array(np.diag([0.0] * 6 + [5e3])),
    csr_array(np.block([[np.eye(3, 7)], [np.zeros((4, 7))], [np.eye(3, 7, 3)], [np.zeros((4, 7))]])),
    [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]],
    5.0,
    (*(f"node {node} {axis}" for node in (0, 1) for axis in ("UX", "UY", "UZ")), "mode 1"),
    [0],
)
sys.path.insert(0, str(Path(__file__).parents[1] / "data"))
Strut = importlib.import_module("femstruct_guest.strut").Strut  # a kind of another package keeps to the same
del sys.path[0]

SPRUCE = fs.Orthotropic("spruce", E=(11e9, 370e6), G=(690e6, 50e6, 600e6), nu=0.35, rho=420.0)
LAYERS = fs.Laminate((fs.Layer(SPRUCE, 0.01, 0.3), fs.Layer(STEEL, 0.005), fs.Layer(SPRUCE, 0.015, -1.0)))
PARTS: dict[str, Part] = {
    **{
        f"plate {kind}": fs.Plate(
            "part", STEEL, 0.01, (0.3, -0.2, 0.5), (1.2, 0.7), (3, 2), kind, TILTED, (1.0, 0.0, 0.0)
        )
        for kind in plate.KINDS
    },
    **{
        f"plate {kind} elastic": fs.Plate(
            "part", STEEL, 0.01, (0.3, -0.2, 0.5), (1.2, 0.7), (3, 2), kind, TILTED, (1.0, 0.0, 0.0), "elastic"
        )
        for kind in plate.KINDS
        if kind != "hermite12"
    },
    "plate of layers": fs.Plate(
        "part", LAYERS, 0.03, (0.3, -0.2, 0.5), (1.2, 0.7), (3, 2), "bfs16", TILTED, (1.0, 0.0, 0.0), "elastic"
    ),
    "frame of timber": fs.Frame(
        "part",
        SPRUCE,
        rectangle("bar", 0.04, 0.03),
        (((0.0, 0.0, 0.0), (0.3, 0.4, 0.7), (1.0, 0.4, 0.7)),),
        mesh=0.3,
        start_offset=(0.0, 0.0, 0.05),
        end_offset=(0.0, 0.0, 0.05),
    ),
    **{
        f"frame {kind}": fs.Frame(
            "part",
            STEEL,
            rectangle("bar", 0.04, 0.03),
            (((0.0, 0.0, 0.0), (0.3, 0.4, 0.7), (1.0, 0.4, 0.7)),),
            mesh=0.3,
            element=kind,
            start_offset=(0.0, 0.0, 0.05),
            end_offset=(0.0, 0.0, 0.05),
        )
        for kind in frame.KINDS
    },
    "block": fs.Block("part", 120.0, (0.1, 0.2, 0.3), (1.0, 0.8, 0.5), center=(0.4, 0.4, 0.2)),
    "shell": fs.Shell("part", TRAY, STEEL, {"bottom": 2e-3, "side": 3e-3}, offset=5e-3),
    "solid": fs.Solid("part", BRICKS, STEEL),
    "slab": fs.Slab(
        "part",
        STEEL,
        0.02,
        ((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)),
        0.5,
        (((0.5, 0.25), (0.5, 1.5)),),
        normal=TILTED,
        offset=0.01,
    ),
    "substructure": fs.Substructure("part", PAIR, origin=(0.1, 0.2, 0.3)),
    "attachments": fs.Attachments("part", SPIDER, ("links", "masses")),
    "strut": Strut("part", STEEL, 1e-4, (0.1, 0.2, 0.3), (0.5, 0.9, 1.3)),
}
BESIDE = {"attachments": (fs.Shell("tray", SPIDER, STEEL, 2e-3),)}  # what a kind cannot be without
every_part = pytest.mark.parametrize("name", PARTS)


def meshed(name: str) -> tuple[Model, Meshed]:
    model = fs.mesh_structure(fs.Structure("one part", (PARTS[name], *BESIDE.get(name, ()))))
    return model, model.parts["part"]


def shifts(part: Meshed) -> np.ndarray:
    """Nodal components [n * 7, 3] of unit shifts along x, y and z."""
    nodal = np.zeros((len(part.places), N_COMPONENTS, 3))
    nodal[:, :3] = np.eye(3)
    return nodal.reshape(-1, 3)


def test_every_kind_with_nodes_is_here() -> None:
    here = {type(part) for part in PARTS.values()}
    assert {spec.makes for spec in PART_KINDS if "part" in spec.known_as} <= here


@every_part
def test_unit_shifts_of_the_degrees_of_freedom_shift_every_node(name: str) -> None:
    _, part = meshed(name)
    own = part.dofs()
    nodal = np.zeros((len(part.places) * N_COMPONENTS, 3))
    np.add.at(nodal, own.rows, own.values[:, None] * own.translations[own.columns])
    assert nodal == pytest.approx(shifts(part), abs=1e-14)  # rounding of products of unit vectors
    assert own.count == len(own.translations) == len(own.labels) * len(part.places) + len(own.extra)
    assert len({*own.labels, *own.extra}) == len(own.labels) + len(own.extra)


@every_part
def test_a_shift_strains_nothing_and_moves_the_mass(name: str) -> None:
    _, part = meshed(name)
    K, M = part.stiffness_and_mass()
    moved = part.dofs().translations
    assert abs(M - M.T).max() <= 1e-15 * abs(M).max()  # rounding
    if K is not None:
        assert abs(K - K.T).max() <= 1e-15 * abs(K).max()  # rounding
        assert np.abs(K @ moved).max() <= 1e-12 * abs(K).max()  # rounding of sums that cancel
    assert moved.T @ (M @ moved) == pytest.approx(part.mass * np.eye(3), rel=1e-12, abs=1e-12 * part.mass)  # rounding


@every_part
def test_its_particles_weigh_what_it_weighs(name: str) -> None:
    _, part = meshed(name)
    assert part.lumps.shape == (len(part.places),)
    assert part.lumps.sum() == pytest.approx(part.mass, rel=1e-13)  # rounding
    assert part.lumps.min() >= 0.0


@every_part
def test_its_nodes_cells_and_groups_are_its_own(name: str) -> None:
    model, part = meshed(name)
    for nodes in (part.quads.ravel(), part.lines.ravel(), *part.held_together):
        assert np.isin(nodes, part.nodes).all()
    assert part.nodes.tolist() == model.mesh.nodes["part"].tolist()
    assert part.clamped.shape[1] == part.flat.shape[1] == part.along(np.array([1.0, 0.0, 0.0])).shape[1] == N_COMPONENTS


@every_part
def test_what_is_drawn_shifts_with_it(name: str) -> None:
    model, part = meshed(name)
    drawn = part.drawn(3, 4, model.mesh.n_nodes)
    own = shifts(part)  # its nodes are the first
    moved = (drawn.rows[:, : len(own)] @ own).reshape(-1, 3, 3)
    assert moved == pytest.approx(np.broadcast_to(np.eye(3), moved.shape), abs=1e-12)  # rounding
    for cells in (drawn.quads, drawn.lines):
        assert cells.size == 0 or (cells.min() >= 0 and cells.max() < len(drawn.points))


@every_part
def test_what_is_spread_over_it_shifts_with_it(name: str) -> None:
    _, part = meshed(name)
    spread = part.spread("here", fs.Region("whole"), 1e-9, 3)
    if spread is None:
        return
    nodal = shifts(part).reshape(-1, N_COMPONENTS, 3)[spread.nodes - part.first]
    moved = np.einsum("pikc,pkcd->pid", spread.rows[:, :3], nodal)
    assert moved == pytest.approx(np.broadcast_to(np.eye(3), moved.shape), abs=1e-12)  # rounding
    sizes = {"plate": 1.2 * 0.7, "frame": np.hypot(0.5, 0.7) + 0.7, "shell": 3.25, "slab": 2.875, "solid": 6.4}
    size = sizes[name.split()[0]]
    assert spread.weights.sum() == pytest.approx(size, rel=1e-12)  # rounding
