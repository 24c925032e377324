"""Rigid links, averages and equations: statics by hand, rigid motions, and what they must not stiffen."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse.linalg import spsolve

import femstruct as fs
from femstruct.assembly.constraint_findings import constraint_findings
from femstruct.assembly.matrices import Assembly
from femstruct.errors import InputError
from femstruct.modal.residuals import unit_diagonal
from femstruct.model.constraints import fitted_motion
from femstruct.model.imported_mesh import ImportedMesh
from femstruct.model.model import Model
from femstruct.model.part import Part
from femstruct.model.structure import Constraint

STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
ROUNDING = 1e-9  # of the largest: sums over a few hundred terms, with stiffnesses 1e6 apart


def block(name: str, x: float, mass: float = 2.0) -> fs.Block:
    return fs.Block(name, mass, (x, 0.0, 0.0), (0.1, 0.1, 0.1))


def upright(name: str) -> fs.Support:
    """What lets a block move along z alone; at its centre of mass, so that it turns nothing."""
    return fs.Support(f"guide {name}", ("x", "y", "rx", "ry", "rz"), at=name)


def spring(name: str, k: float) -> fs.Spring:
    return fs.Spring(f"spring {name}", name, None, (0.0, 0.0, k, 0.0, 0.0, 0.0))


def row_of_blocks(xs: dict[str, float], ks: dict[str, float], *constraints: Constraint) -> Model:
    """Blocks along x by name, each on a guide and on a spring where one is given."""
    blocks: tuple[Part, ...] = tuple(block(f"block {name}", x - 0.05) for name, x in xs.items())
    springs = tuple(spring(name, k) for name, k in ks.items())
    middle = ((0.05, 0.05, 0.05),)
    points = tuple(fs.PlaceOn(name, f"block {name}", middle) for name in xs)
    guides = tuple(upright(name) for name in ks)
    return fs.mesh_structure(
        fs.Structure("a row", blocks + springs, points=points, supports=guides, constraints=constraints)
    )


def at_rest(assembly: Assembly, model: Model, loads: dict[str, float]) -> NDArray[np.float64]:
    """Free degrees of freedom under forces by POINT.direction."""
    load = np.zeros(assembly.K.shape[0])
    for spot, force in loads.items():
        name, direction = spot.rsplit(".", 1)
        load += force * (model.points[name].probe(direction).row(model.mesh.n_nodes) @ assembly.dofs.T).toarray()[0]
    scale = unit_diagonal(assembly.K)
    return scale * spsolve((assembly.K * scale * scale[:, None]).tocsc(), scale * load)


def force(assembly: Assembly, model: Model, answer: NDArray[np.float64], loads: dict[str, float], name: str) -> Any:
    """A force of the structure [3]: of what moves, and of loads that pass on without moving anything."""
    nodal = sum(
        size * model.points[spot.rsplit(".", 1)[0]].probe(spot.rsplit(".", 1)[1]).row(model.mesh.n_nodes).toarray()[0]
        for spot, size in loads.items()
    )
    return assembly.forces[name].stiffness @ answer + assembly.forces[name].direct @ nodal


def moved(assembly: Assembly, model: Model, answer: NDArray[np.float64], spot: str) -> float:
    name, direction = spot.rsplit(".", 1)
    return float((model.points[name].probe(direction).row(model.mesh.n_nodes) @ assembly.dofs.T @ answer)[0])


def test_a_rigid_lever_shares_a_force_by_its_arms() -> None:
    """A beam without mass or weight on three springs at x = 0, 1, 3, pushed at 2: one rigid body, solved by hand."""
    at, k = np.array([0.0, 1.0, 3.0]), np.array([1e4, 3e4, 2e4])
    names = ("a", "b", "c")
    model = row_of_blocks(
        {"head": 2.0, **dict(zip(names, at, strict=True))},
        dict(zip(names, k, strict=True)),
        fs.RigidLink("lever", "head", names, directions=("z",)),
    )
    held = fs.Support("keel", ("x", "y", "rx", "rz"), at="head")
    structure = fs.Structure(
        "a lever",
        model.structure.parts,
        points=model.structure.points,
        supports=(*model.structure.supports, held),
        constraints=model.structure.constraints,
    )
    model = fs.mesh_structure(structure)
    assembly = fs.assemble(model)
    answer = at_rest(assembly, model, {"head.z": 100.0})
    arms = at - 2.0
    by_hand = np.linalg.solve([[k.sum(), k @ arms], [k @ arms, k @ arms**2]], [100.0, 0.0])
    for name, x in zip(names, arms, strict=True):
        assert moved(assembly, model, answer, f"{name}.z") == pytest.approx(by_hand @ [1.0, x], rel=ROUNDING)
    assert force(assembly, model, answer, {"head.z": 100.0}, "lever") == pytest.approx(
        [0.0, 0.0, 100.0], abs=100.0 * ROUNDING
    )  # all of it reaches the springs
    reactions = sum((assembly.forces[f"spring {name}"].stiffness @ answer)[2] for name in names)
    assert reactions == pytest.approx(100.0, rel=ROUNDING)


def test_equations_scale_masses_and_stiffnesses() -> None:
    """With u_b = r u_a, omega^2 = (k_a + r^2 k_b) / (m_a + r^2 m_b)."""
    r = -2.5
    model = row_of_blocks({"a": 0.0, "b": 1.0}, {"a": 5e4, "b": 3e4}, fs.Equation("lever", {"a.z": r, "b.z": -1.0}))
    assembly = fs.assemble(model)
    (omega,) = fs.modal_basis(assembly, count=1).omega
    assert omega**2 == pytest.approx((5e4 + r**2 * 3e4) / (2.0 + r**2 * 2.0), rel=ROUNDING)
    # By virtual work a force F on b is r F on a; the factor that balances b is what F and its spring leave.
    answer = at_rest(assembly, model, {"b.z": 30.0})
    a = 30.0 * r / (5e4 + r**2 * 3e4)
    assert moved(assembly, model, answer, "a.z") == pytest.approx(a, rel=ROUNDING)
    factor = 5e4 * a / r  # of the equation: r factor - k a = 0 on block a
    ground, pivot = (force(assembly, model, answer, {"b.z": 30.0}, name)[2] for name in ("ground", "lever"))
    assert pivot == pytest.approx((1.0 - r) * factor, rel=ROUNDING)
    assert ground == pytest.approx(30.0, rel=ROUNDING)  # springs and the pivot that is not there carry all of it


def test_an_equation_between_two_points_has_the_force_of_the_first_on_the_second() -> None:
    model = row_of_blocks({"a": 0.0, "b": 1.0}, {"a": 5e4, "b": 2e4}, fs.Equation("rod", {"a.z": 2.0, "b.z": -2.0}))
    assembly = fs.assemble(model)
    answer = at_rest(assembly, model, {"a.z": 70.0})
    assert force(assembly, model, answer, {"a.z": 70.0}, "rod")[2] == pytest.approx(70.0 * 2.0 / 7.0, rel=ROUNDING)
    assert "rod" not in assembly.grounded


PLATE = fs.Plate("plate", STEEL, 0.01, (0.0, 0.0, 0.0), (1.0, 0.8), (10, 8))
BOLTS = ((0.2, 0.2), (0.6, 0.2), (0.6, 0.5), (0.2, 0.5))
EDGES = fs.Support("edges", "simple", on="plate", edge="all")
SEAT = fs.Block("machine", 1.0, (0.2, 0.3, 0.1), (0.3, 0.2, 0.2))
POINTS = (fs.PlaceOn("bolts", "plate", BOLTS), fs.PlaceOn("foot", "machine", ((0.25, 0.1, 0.0),)))


def on_bolts(*constraints: Constraint) -> Model:
    return fs.mesh_structure(
        fs.Structure("on bolts", (PLATE, SEAT), points=POINTS, supports=(EDGES,), constraints=constraints)
    )


def test_an_average_shares_a_force_as_a_group_of_bolts_and_stiffens_nothing() -> None:
    """F / n on each bolt and M d / sum d^2, put on the same plate by hand: it moves alike everywhere."""
    joined = on_bolts(fs.Average("seat", "foot", ("bolts",)))
    alone = fs.mesh_structure(fs.Structure("plate", (PLATE,), points=POINTS[:1], supports=(EDGES,)))
    one, other = fs.assemble(joined), fs.assemble(alone)
    forces = {"foot.z": 120.0, "foot.rx": -7.0, "foot.ry": 11.0}
    answer = at_rest(one, joined, forces)
    off = np.array(BOLTS) - np.mean(BOLTS, axis=0)
    arm = np.array([0.45, 0.4]) - np.mean(BOLTS, axis=0)
    about_x, about_y = -7.0 + 120.0 * arm[1], 11.0 - 120.0 * arm[0]
    share = 120.0 / 4 + about_x * off[:, 1] / (off[:, 1] ** 2).sum() - about_y * off[:, 0] / (off[:, 0] ** 2).sum()
    by_hand = at_rest(other, alone, {f"bolts.{i + 1}.z": force for i, force in enumerate(share)})
    nodes = joined.mesh.nodes["plate"]
    for component in (2, 3, 4):
        found = (one.dofs.T @ answer).reshape(-1, 7)[nodes, component]
        exact = (other.dofs.T @ by_hand).reshape(-1, 7)[:, component]
        assert found == pytest.approx(exact, abs=1e-8 * np.abs(exact).max())  # in-plane motion: another elimination
    assert force(one, joined, answer, forces, "seat") == pytest.approx([0.0, 0.0, 120.0], abs=120 * ROUNDING)


def test_an_average_over_a_rectangle_pushes_as_an_even_pressure_does() -> None:
    """The force on the middle of a rectangle against that on a patch, which is spread evenly."""
    region = fs.Region("rectangle", size=(0.4, 0.3), at=(0.4, 0.35))
    machine = fs.Block("machine", 1.0, (0.3, 0.25, 0.1), (0.2, 0.2, 0.2))
    points = (
        fs.PlaceOn("foot", "machine", ((0.1, 0.1, 0.0),)),
        fs.PlaceOn("patch", "plate", ((0.4, 0.35),), patch=(0.4, 0.3)),
    )
    seat = fs.Average("seat", "foot", on="plate", over=region)
    model = fs.mesh_structure(
        fs.Structure("seat", (PLATE, machine), points=points, supports=(EDGES,), constraints=(seat,))
    )
    assembly = fs.assemble(model)
    through, direct = (at_rest(assembly, model, {spot: 100.0}) for spot in ("foot.z", "patch.z"))
    w = (assembly.dofs.T @ np.stack([through, direct], axis=1)).reshape(-1, 7, 2)[model.mesh.nodes["plate"], 2]
    assert w[:, 0] == pytest.approx(w[:, 1], abs=1e-3 * w.max())  # both rules have few Gauss points a cell


def test_the_fit_is_that_of_least_squares() -> None:
    rng = np.random.default_rng(3)
    places, weights, shifts = rng.normal(size=(6, 3)) + 2.0, rng.uniform(0.5, 2.0, 6), rng.normal(size=(6, 3))
    weights /= weights.sum()
    B = np.concatenate([[[1, 0, 0, 0, z, -y], [0, 1, 0, -z, 0, x], [0, 0, 1, y, -x, 0]] for x, y, z in places])
    root = np.sqrt(np.repeat(weights, 3))
    exact = np.linalg.lstsq(root[:, None] * B, root * shifts.ravel(), rcond=None)[0]
    fitted = fitted_motion(places, weights)
    assert fitted is not None
    assert fitted.motion @ shifts.ravel() == pytest.approx(exact, rel=1e-12)  # rounding


BRICK = ImportedMesh(
    "brick.msh",
    [[x, y, z] for z in (0.0, 0.4) for y in (0.0, 1.0) for x in (0.0, 1.0, 2.0)],
    np.arange(1, 13),
    {"hex8": [[0, 1, 4, 3, 6, 7, 10, 9], [1, 2, 5, 4, 7, 8, 11, 10]]},
    {"hex8": [1, 2]},
    node_sets={"end": [2, 5, 8, 11]},
)


@pytest.mark.parametrize("kind", ["rigid", "average"])
def test_a_free_structure_with_links_has_six_rigid_modes(kind: str) -> None:
    """A solid, a plate at an angle and a block: links keep every rigid motion and no other."""
    tilted = fs.Plate("plate", STEEL, 0.02, (2.5, 0.1, 0.3), (0.6, 0.5), (4, 3), normal=(-0.6, 0.0, 0.8))
    machine = fs.Block("machine", 40.0, (3.0, 0.2, 1.2), (0.3, 0.3, 0.2))
    points = (
        fs.PlaceOn("side", "machine", ((0.0, 0.1, 0.1),)),
        fs.PlaceOn("under", "machine", ((0.1, 0.1, 0.0),)),
        fs.PlaceOn("corners", "plate", ((0.1, 0.1), (0.5, 0.1), (0.5, 0.4))),
    )
    region = fs.Region("set", named="end")
    links: tuple[Constraint, ...] = (
        fs.RigidLink("beam", "side", on="brick", of=region),
        fs.RigidLink("spider", "under", ("corners",)),
    )
    if kind == "average":
        whole = fs.Region("box", box=((1.99, -0.1, -0.1), (2.01, 1.1, 0.5)))
        links = (fs.Average("beam", "side", on="brick", over=whole), fs.Average("spider", "under", ("corners",)))
    parts = (fs.Solid("brick", BRICK, STEEL), tilted, machine)
    model = fs.mesh_structure(fs.Structure("linked", parts, points=points, constraints=links))
    # An average of three corners leaves the machine to be carried by both averages: 12 equations for its 6 motions.
    basis = fs.modal_basis(fs.assemble(model), count=8)
    assert basis.n_rigid == 6
    assert basis.frequency_hz[6] > 1.0
    assert constraint_findings(model) == ()


def test_a_bar_end_is_released_by_a_link_without_that_direction() -> None:
    """A clamped beam with a hinge in its middle: each half is a cantilever, since shear and moment vanish there."""
    section = fs.Section("bar", A=1e-4, Iy=2e-9, Iz=8e-9, J=1e-8)
    halves = tuple(
        fs.Frame(name, STEEL, section, (((x, 0.0, 0.0), (x + 1.0, 0.0, 0.0)),), mesh=0.05, element="euler")
        for name, x in (("left", 0.0), ("right", 1.0))
    )
    places = {"wall": ("left", 0.0), "end": ("left", 1.0), "start": ("right", 1.0), "far": ("right", 2.0)}
    points = tuple(fs.PlaceOn(name, on, ((x, 0.0, 0.0),)) for name, (on, x) in places.items())
    walls = tuple(fs.Support(f"{name} held", "clamped", at=name) for name in ("wall", "far"))

    def first(*directions: str) -> NDArray[np.float64]:
        hinge = fs.RigidLink("hinge", "end", ("start",), directions=directions)
        structure = fs.Structure("hinged", halves, points=points, supports=walls, constraints=(hinge,))
        return fs.modal_basis(fs.assemble(fs.mesh_structure(structure)), count=4).frequency_hz

    def cantilever(moment: float) -> float:
        return float(1.8751041**2 / (2.0 * np.pi) * np.sqrt(210e9 * moment / (7850.0 * 1e-4)))

    def has(found: NDArray[np.float64], moment: float) -> bool:
        return bool(np.isclose(found, cantilever(moment), rtol=1e-4).any())  # 20 bars: 1e-6

    free_about_z, free_about_y = first("x", "y", "z", "rx", "ry"), first("x", "y", "z", "rx", "rz")
    assert (has(free_about_z, 8e-9), has(free_about_z, 2e-9)) == (True, False)
    assert (has(free_about_y, 8e-9), has(free_about_y, 2e-9)) == (False, True)
    both = first("x", "y", "z", "rx")
    assert has(both, 2e-9) and has(both, 8e-9)
    assert not has(first("x", "y", "z", "rx", "ry", "rz"), 2e-9)


def test_what_is_said_twice_is_named() -> None:
    model = row_of_blocks(
        {"a": 0.0, "b": 1.0, "c": 2.0},
        {"a": 1e4, "b": 1e4, "c": 1e4},
        fs.RigidLink("first", "a", ("b",), directions=("z",)),
        fs.Equation("second", {"b.z": 1.0, "c.z": -1.0}),
        fs.Equation("third", {"c.z": 3.0, "a.z": -3.0}),
    )
    (found,) = [one for one in constraint_findings(model) if one.code == "constraint-repeated"]
    assert found.message.startswith("constraints.third: 1 of 1 equations say nothing new: those of ")
    assert "first and second" in found.message
    assert fs.modal_basis(fs.assemble(model), count=1).omega[0] ** 2 == pytest.approx(1e4 / 2.0, rel=ROUNDING)


def test_what_is_held_without_a_support_is_named() -> None:
    model = row_of_blocks(
        {"a": 0.0, "b": 1.0, "c": 2.0},
        {"a": 1e4, "b": 1e4, "c": 1e4},
        fs.Equation("alike", {"a.z": 1.0, "b.z": -1.0}),
        fs.Equation("not alike", {"a.z": 1.0, "b.z": -2.0}),
    )
    (found,) = [one for one in constraint_findings(model) if one.code == "constraint-holds"]
    assert "alike and not alike together hold a.z, b.z at zero" in found.message


def test_a_link_to_what_a_support_holds_is_no_finding() -> None:
    model = row_of_blocks({"a": 0.0, "b": 1.0}, {"a": 1e4, "b": 1e4}, fs.Equation("alike", {"a.z": 1.0, "b.z": -1.0}))
    structure = model.structure
    held = fs.Support("stop", ("z",), at="a")
    held_model = fs.mesh_structure(
        fs.Structure(
            "held",
            structure.parts,
            points=structure.points,
            supports=(*structure.supports, held),
            constraints=structure.constraints,
        )
    )
    assert [one.code for one in constraint_findings(held_model)] == ["constraint-to-ground"]  # it resists a rotation


def test_an_average_of_places_on_a_line_is_refused() -> None:
    line = fs.PlaceOn("line", "plate", ((0.2, 0.3), (0.6, 0.3)))
    level = fs.Block("machine", 1.0, (0.2, 0.3, -0.1), (0.3, 0.2, 0.2))
    foot, on_line = fs.PlaceOn("foot", "machine", ((0.25, 0.1, 0.0),)), fs.PlaceOn("end", "machine", ((0.1, 0.0, 0.1),))

    def linked(point: str, *directions: str) -> Model:
        seat = fs.Average("seat", point, ("line",), directions=directions)
        return fs.mesh_structure(
            fs.Structure("line", (PLATE, level), points=(line, foot, on_line), constraints=(seat,))
        )

    for point, directions in (("foot", ("z",)), ("end", ("z", "rx"))):
        with pytest.raises(InputError, match="three places that are not on one line"):
            linked(point, *directions)
    (seat,) = (tie for tie in linked("end", "x", "y", "z", "ry", "rz").ties if tie.name == "seat")
    assert seat.rows.shape[0] == 5  # what a line does determine


@pytest.mark.parametrize(
    ("maker", "told"),
    [
        (lambda: fs.RigidLink("l", "a"), "constraints.l.to: got nothing"),
        (lambda: fs.RigidLink("l", "a", ("a",)), "constraints.l.to: got 'a' itself"),
        (lambda: fs.RigidLink("l", "a", ("b",), directions=()), "constraints.l.directions: got none"),
        (lambda: fs.RigidLink("l", "a", ("b",), directions=("w",)), "constraints.l.directions: got"),
        (lambda: fs.Average("l", "a"), "constraints.l.of: got nothing"),
        (lambda: fs.Average("l", "a", ("b",), on="plate"), "constraints.l.of: got points and a region"),
        (lambda: fs.Equation("l", {"a.z": 1.0}), "constraints.l.equation: got 1 term"),
        (lambda: fs.Equation("l", {"a.z": 1.0, "b.z": 0.0}), "constraints.l.equation: got 0 for b.z"),
        (lambda: fs.Equation("l", {"a.z": 1.0, "b": 1.0}), "constraints.l.equation: got 'b'"),
        (lambda: on_bolts(fs.RigidLink("l", "foot", ("nut",))), "constraints.l.to: got 'nut'"),
        (
            lambda: on_bolts(fs.RigidLink("l", "bolts", ("foot",))),
            "constraints.l.rigid: got 'bolts', which has 4 places",
        ),
        (lambda: on_bolts(fs.Average("l", "foot", on="seat")), "'seat'"),
        (lambda: on_bolts(fs.Equation("l", {"bolts.z": 1.0, "foot.z": 1.0})), "'bolts', which has 4 places"),
        (lambda: on_bolts(fs.RigidLink("edges", "foot", ("bolts",))), "a name taken by supports.edges"),
    ],
)
def test_what_cannot_be_is_refused(maker, told: str) -> None:
    with pytest.raises(InputError) as caught:
        maker()
    assert told in str(caught.value)
