"""Forces of springs, foundations, supports and joints against the equilibrium of the whole structure."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse.linalg import spsolve

from femstruct.assembly.matrices import Assembly, assemble
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.part import Part
from femstruct.model.probe import Point
from femstruct.model.regions import Region
from femstruct.model.sections import rectangle
from femstruct.model.structure import Joint, PlaceOn, Structure, Support
from femstruct.parts.foundation import Foundation
from femstruct.parts.frame import Frame
from femstruct.parts.plate import Plate
from femstruct.parts.spring import Spring

ROUNDING = 1e-9  # rounding: 6e-12 here at most

STEEL = Material("steel", 206e9, 0.3, 7850.0)
LOAD = np.array([3.0, -2.0, 7.0])
TILT = (0.2, -0.3, 1.0)
FEET = PlaceOn("feet", "p", ((0.1, 0.1), (0.5, 0.1), (0.5, 0.4), (0.1, 0.4)))
HIT = PlaceOn("hit", "p", ((0.23, 0.28),))
BY_THE_EDGE = PlaceOn("by the edge", "p", ((0.03, 0.46),))
CORNER = PlaceOn("corner", "p", ((0.0, 0.5),))


def structure(
    parts: tuple[Part, ...] = (), supports: tuple[Support, ...] = (), kind: Literal["hermite12", "bfs16"] = "bfs16"
) -> Structure:
    plate = Plate("p", STEEL, 0.01, (0.1, 0.2, 0.3), (0.6, 0.5), (6, 5), kind, normal=TILT)
    return Structure("held", (plate, *parts), points=(FEET, HIT, BY_THE_EDGE, CORNER), supports=supports)


HELD: dict[str, tuple[Structure, tuple[str, ...]]] = {
    "springs": (structure((Spring("mounts", "feet", None, (1e4, 2e4, 5e4, 0, 0, 0)),)), ("mounts",)),
    "rim": (structure((Foundation("foam", "p", Region("rim", (0.5, 0.4)), 2e5, 7e4),)), ("foam",)),
    "bed": (structure((Foundation("bed", "p", Region("whole"), 2e5, 7e4),)), ("bed",)),
    "simple": (structure(supports=(Support("rim", "simple", "p", edge="all"),)), ("rim",)),
    "clamped": (structure(supports=(Support("rim", "clamped", "p", edge="all"),), kind="hermite12"), ("rim",)),
    "two edges": (
        structure(supports=(Support("a", "simple", "p", edge="x0"), Support("b", "clamped", "p", edge="y1"))),
        ("a", "b"),
    ),
    "listed": (structure(supports=(Support("pins", ("x", "y", "z"), at="feet"),)), ("pins",)),
    "line": (structure(supports=(Support("line", "clamped", "p", line=((0.1, 0.1), (0.4, 0.1))),)), ("line",)),
    "mixed": (
        structure((Spring("mounts", "feet", None, (1e4, 2e4, 5e4, 0, 0, 0)),), (Support("a", ("z",), "p", edge="x0"),)),
        ("mounts", "a"),
    ),
}


def passed_on(assembly: Assembly, part: str, point: Point) -> NDArray[np.float64]:
    """What of LOAD reaches a support or joint without any motion."""
    nodal = sum(
        value * point.probe(direction).row(len(assembly.points)) for value, direction in zip(LOAD, "xyz", strict=True)
    )
    direct: NDArray[np.float64] = (assembly.forces[part].direct @ nodal.T).toarray().ravel()
    return direct


def load(assembly: Assembly, point: Point, force: NDArray[np.float64]) -> NDArray[np.float64]:
    rows = [point.probe(direction).row(len(assembly.points)) @ assembly.dofs.T for direction in "xyz"]
    return sum(value * row.toarray().ravel() for value, row in zip(force, rows, strict=True))


@pytest.mark.parametrize("name", HELD)
def test_what_reaches_the_ground_is_the_load(name: str) -> None:
    held, names = HELD[name]
    model = mesh_structure(held)
    assembly = assemble(model)
    for point in ("hit", "by the edge", "corner"):
        u = spsolve(assembly.K, load(assembly, model.points[point], LOAD))

        def force(part: str, at: Point = model.points[point], u: NDArray[np.float64] = u) -> NDArray[np.float64]:
            return assembly.forces[part].stiffness @ u + passed_on(assembly, part, at)

        # Equilibrium; spsolve leaves 1e-11 or so of a well-conditioned plate.
        assert force("ground") == pytest.approx(LOAD, abs=1e-9 * np.linalg.norm(LOAD))
        # N of 1e2, what spsolve leaves: 4e-11 here
        assert sum(force(part) for part in names) == pytest.approx(LOAD, abs=5e-9)


@pytest.mark.parametrize("name", HELD)
def test_in_motion_the_ground_takes_what_inertia_does_not(name: str) -> None:
    held, _ = HELD[name]
    model = mesh_structure(held)
    assembly = assemble(model)
    squared = (2 * np.pi * 7.3) ** 2
    for point in ("hit", "by the edge", "corner"):
        u = spsolve((assembly.K - squared * assembly.M).tocsc(), load(assembly, model.points[point], LOAD))
        ground = assembly.forces["ground"]
        reached = ground.stiffness @ u - squared * (ground.inertia @ u)
        reached += passed_on(assembly, "ground", model.points[point])
        balance = LOAD + squared * (assembly.momentum @ u)
        # what spsolve leaves: 1e-11 here
        assert reached == pytest.approx(balance, abs=1e-9 * np.linalg.norm(LOAD) + 1e-9 * np.abs(balance).max())


def test_dashpots_to_ground_are_in_the_ground_force() -> None:
    held, _ = HELD["springs"]
    plate = held.parts[0]
    damped = Spring("mounts", "feet", None, (1e4, 2e4, 5e4, 0, 0, 0), (10.0, 20.0, 30.0, 0, 0, 0))
    assembly = assemble(mesh_structure(Structure("damped", (plate, damped), points=(FEET,))))
    u = np.random.default_rng(1).standard_normal(assembly.K.shape[0])
    ground = assembly.forces["ground"]
    # rounding: 3e-16 here
    assert ground.damping @ u == pytest.approx(np.array([1e-3, 1e-3, 6e-4]) * (ground.stiffness @ u), rel=1e-13)
    assert ground.damping @ u == pytest.approx(rigid(assembly).T @ (assembly.C @ u), rel=ROUNDING)


def rigid(assembly: Assembly) -> NDArray[np.float64]:
    wanted = np.zeros((len(assembly.points), 7, 3))
    wanted[:, :3] = np.eye(3)
    solution: NDArray[np.float64] = np.linalg.lstsq(assembly.dofs.T.toarray(), wanted.reshape(-1, 3), rcond=None)[0]
    return solution


@pytest.mark.parametrize("kind", ["rigid", "pinned"])
def test_a_joint_carries_what_is_beyond_it(kind: Literal["rigid", "pinned"]) -> None:
    """A post clamped at its foot carries a plate: the force of the plate on the post is the load; the first part named
    acts on the second."""
    post = Frame(
        "posts",
        STEEL,
        rectangle("s", 0.03, 0.04),
        tuple(((x, y, 0.0), (x, y, 0.5)) for x, y in ((0.1, 0.1), (0.5, 0.1), (0.3, 0.4))),
        0.1,
    )
    plate = Plate("p", STEEL, 0.01, (0.0, 0.0, 0.5), (0.6, 0.5), (4, 4))
    held = Structure(
        "table",
        (post, plate),
        (Joint("top", "p", "posts", kind=kind),),
        (HIT, PlaceOn("feet", "posts", ((0.1, 0.1, 0.0), (0.5, 0.1, 0.0), (0.3, 0.4, 0.0)))),
        supports=(Support("footing", "clamped", at="feet"),),
    )
    model = mesh_structure(held)
    assembly = assemble(model)
    u = spsolve(assembly.K, load(assembly, model.points["hit"], LOAD))
    for name in ("top", "footing", "ground"):
        found = assembly.forces[name].stiffness @ u + passed_on(assembly, name, model.points["hit"])
        assert found == pytest.approx(LOAD, abs=ROUNDING)


def test_a_spring_between_places_pushes_on_the_second() -> None:
    lower = Plate("low", STEEL, 0.01, (0.0, 0.0, 0.0), (0.6, 0.5), (4, 4))
    upper = Plate("p", STEEL, 0.01, (0.0, 0.0, 0.2), (0.6, 0.5), (4, 4))
    mounts = Spring("mounts", "feet", "seats", (1e4, 1e4, 3e4, 0, 0, 0))
    seats = PlaceOn("seats", "low", FEET.at)
    held = Structure(
        "stack",
        (lower, upper, mounts),
        points=(FEET, HIT, seats),
        supports=(Support("rim", "simple", "low", edge="all"),),
    )
    model = mesh_structure(held)
    assembly = assemble(model)
    u = spsolve(assembly.K, load(assembly, model.points["hit"], LOAD))
    assert assembly.forces["mounts"].stiffness @ u == pytest.approx(LOAD, abs=ROUNDING)
    assert assembly.forces["ground"].stiffness @ u == pytest.approx(LOAD, abs=ROUNDING)


def test_an_elastic_joint_passes_the_load_too() -> None:
    lower = Plate("low", STEEL, 0.01, (0.0, 0.0, 0.0), (0.6, 0.5), (4, 4))
    upper = Plate("p", STEEL, 0.01, (0.0, 0.0, 0.0), (0.6, 0.5), (4, 4), normal=(0.0, -1.0, 0.0))
    joint = Joint("seat", "p", "low", stiffness={"z": 1e5, "rx": 10.0})
    held = Structure(
        "stack", (lower, upper), (joint,), points=(HIT,), supports=(Support("rim", "clamped", "low", edge="all"),)
    )
    model = mesh_structure(held)
    assembly = assemble(model)
    u = spsolve(assembly.K, load(assembly, model.points["hit"], LOAD))
    # Along x everything is held in its plane: that force goes straight on.
    for name in ("seat", "ground"):
        found = assembly.forces[name].stiffness @ u + passed_on(assembly, name, model.points["hit"])
        assert found == pytest.approx(LOAD, abs=3e-8)  # N, what spsolve leaves beside stiff joints: 2e-10 here
