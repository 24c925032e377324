"""Stresses of plates and bars against closed forms, in any position."""

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from femstruct.assembly.matrices import assemble
from femstruct.elements.stresses import principal, von_mises
from femstruct.errors import InputError
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.sections import Section, box, circle, i_section, rectangle, tube
from femstruct.model.structure import PlaceOn, Structure, Support, SurfaceOn
from femstruct.parts.frame import Frame
from femstruct.parts.plate import Plate

STEEL = Material("steel", E=210e9, nu=0.3, rho=7850.0)


def deflected(model, load):
    """Nodal components [node, 7, 1] under a static load, a row over all components."""
    assembly = assemble(model)
    u = spsolve(assembly.K, np.asarray((load @ assembly.dofs.T).todense()).ravel())
    return (assembly.dofs.T @ u).reshape(-1, 7, 1)


@pytest.mark.parametrize("edges", ["simple", "clamped"])
def test_square_plate_under_pressure(edges):
    """Moments of a square plate over p a^2, nu = 0.3: simply supported 0.0479 in the middle (Timoshenko, Woinowsky-
    Krieger, Theory of Plates and Shells, table 8); clamped 0.02291 there and -0.05133 in the middle of an edge (Taylor,
    Govindjee, doi:10.1002/cnm.717; the older book has 0.0231 and -0.0513)."""
    plate = Plate("p", STEEL, 0.01, origin=(0.0, 0.0, 0.0), size=(1.0, 1.0), mesh=(24, 24))
    support = Support("rim", edges, on="p", edge="all")
    model = mesh_structure(Structure("p", (plate,), supports=(support,), surfaces=(SurfaceOn("top", "p"),)))
    moved = deflected(model, 1e3 * model.surfaces["top"].pressure().row(model.mesh.n_nodes))
    places = model.parts["p"].stresses(model.mesh.n_nodes)
    found = places.of(moved)[:, :, 0]
    scale = 1e3 * 6 / 0.01**2  # p a^2 over t^2 / 6

    def at(x, y, z):
        return found[np.argmin(np.linalg.norm(places.places - [x, y, z], axis=1))]

    middle = 0.0479 if edges == "simple" else 0.02291
    # the pressure pushes down: the upper face is pressed in the middle
    np.testing.assert_allclose(at(0.5, 0.5, 0.005)[:2], -middle * scale, rtol=3e-3)  # three digits of the tables
    np.testing.assert_allclose(at(0.5, 0.5, -0.005)[:2], middle * scale, rtol=3e-3)  # three digits of the tables
    if edges == "clamped":
        assert at(0.5, 0.0, 0.005)[1] == pytest.approx(0.05133 * scale, rel=1e-2)  # h^2 at an edge, 24 cells
    side = places.sides[np.argmin(np.linalg.norm(places.places - [0.5, 0.5, 0.005], axis=1)) % 2]
    assert side == "above"


def test_a_plate_in_any_position_is_stressed_alike():
    flat = Plate("p", STEEL, 0.01, origin=(0.0, 0.0, 0.0), size=(1.0, 0.7), mesh=(6, 5))
    wall = Plate(
        "p",
        STEEL,
        0.01,
        origin=(3.0, 1.0, 0.0),
        size=(1.0, 0.7),
        mesh=(6, 5),
        normal=(0, 1.0, 0),
        x_direction=(0, 0, 1.0),
    )
    moved = np.random.default_rng(3).normal(size=(42, 7))
    found = []
    for plate in (flat, wall):
        mesh = mesh_structure(Structure("p", (plate,))).parts["p"]
        turned = np.concatenate([moved[:, :3] @ mesh.axes, moved[:, 3:6] @ mesh.axes, moved[:, 6:]], axis=1)
        found.append(mesh.stresses(42).of(turned[:, :, None]))
    np.testing.assert_allclose(found[1], found[0], rtol=1e-9, atol=1e-6 * np.abs(found[0]).max())  # rounding


@pytest.mark.parametrize(("cells", "within"), [(2, 0.02), (4, 0.006), (8, 0.004)])
def test_a_plate_bent_in_its_plane_is_stressed_as_a_beam(cells, within):
    """A cantilever on edge, 1 m by 0.1 m, one load across its tip in its plane: N / t is M y / I at both faces, the
    nearer the more cells stand over its depth; what is left is how the ends are held and loaded."""
    plate = Plate(
        "p", STEEL, 0.01, origin=(0.0, 0.0, 0.0), size=(1.0, 0.1), mesh=(10 * cells, cells), in_plane="elastic"
    )
    points = tuple(PlaceOn(f"tip{i}", "p", at=((1.0, 0.05 * i),)) for i in range(3))
    model = mesh_structure(
        Structure("p", (plate,), points=points, supports=(Support("wall", "clamped", on="p", edge="x0"),))
    )
    n_nodes = model.mesh.n_nodes
    load = sum(share * model.points[f"tip{i}"].probe("y").row(n_nodes) for i, share in enumerate((0.25, 0.5, 0.25)))
    places = model.parts["p"].stresses(n_nodes)
    found = places.of(deflected(model, 1e3 * load))[:, 0, 0]
    x, y, _ = places.places.T
    exact = -1e3 * (1.0 - x) * (y - 0.05) / (0.01 * 0.1**3 / 12)
    inside = (x > 0.15) & (x < 0.85)  # away from the ends by more than the depth
    np.testing.assert_allclose(found[inside], exact[inside], atol=within * np.abs(exact[inside]).max())  # see `within`


SHAPES = [rectangle("r", 0.04, 0.08), circle("c", 0.05), tube("t", 0.06, 0.004), box("b", 0.05, 0.09, 0.004)]
SHAPES.append(i_section("i", 0.05, 0.1, 0.005, 0.007))


@pytest.mark.parametrize("section", SHAPES, ids=lambda section: section.name)
@pytest.mark.parametrize("element", ["euler", "timoshenko", "timoshenko18"])
def test_cantilever_is_stressed_as_beams_are(section, element):
    """Bending both ways, tension and torsion by a load on the tip of a bar that stands askew."""
    tip = np.array([0.3, 0.5, 1.1])
    bar = Frame("bar", STEEL, section, (((0.0, 0.0, 0.0), tuple(tip)),), mesh=0.3, element=element)
    points = (PlaceOn("foot", "bar", at=((0.0, 0.0, 0.0),)), PlaceOn("tip", "bar", at=(tuple(tip),)))
    model = mesh_structure(Structure("b", (bar,), points=points, supports=(Support("wall", "clamped", at="foot"),)))
    axes = model.parts["bar"].axes[0]
    force = np.array([2e3, 300.0, -500.0])  # along the bar's own axes
    load = sum(
        f * model.points["tip"].probe(d).row(model.mesh.n_nodes) for f, d in zip(force @ axes, "xyz", strict=True)
    )
    twist = 40.0 * axes[0]
    load += sum(
        t * model.points["tip"].probe(f"r{d}").row(model.mesh.n_nodes) for t, d in zip(twist, "xyz", strict=True)
    )
    places = model.parts["bar"].stresses(model.mesh.n_nodes)
    found = places.of(deflected(model, load))[:, :, 0]
    x, y, z = (places.places @ axes.T).T
    arm = np.linalg.norm(tip) - x
    exact = force[0] / section.A - arm * force[2] * z / section.Iy - arm * force[1] * y / section.Iz
    np.testing.assert_allclose(found[:, 0], exact, rtol=1e-7, atol=1e-7 * np.abs(exact).max())  # of a solved system
    np.testing.assert_allclose(found[:, 1], 40.0 * section.twist_arm / section.J, rtol=1e-7)  # of a solved system


def test_torsion_of_a_square_and_a_flat_bar():
    """Timoshenko, Goodier, Theory of Elasticity, section 109: tau = T / (k b^2 h), k 0.208 and 0.246, 0.312 for ten."""
    for ratio, k in ((1.0, 0.208), (2.0, 0.246), (10.0, 0.312)):
        section = rectangle("bar", 0.01, 0.01 * ratio)
        assert section.twist_arm / section.J == pytest.approx(1 / (k * 0.01**3 * ratio), rel=3e-3)  # three digits


def test_bars_without_an_outline_have_no_stresses():
    section = Section("table", A=1e-3, Iy=1e-6, Iz=1e-6, J=2e-6)
    bar = Frame("bar", STEEL, section, (((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),))
    model = mesh_structure(Structure("b", (bar,)))
    with pytest.raises(InputError, match=r"parts\.bar\.section: got 'table' by its constants, without an outline"):
        model.parts["bar"].stresses(model.mesh.n_nodes)


def test_von_mises_and_principal_stresses_do_not_depend_on_axes():
    rng = np.random.default_rng(5)
    tensor = rng.normal(size=(3, 3))
    tensor += tensor.T
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    names = ("xx", "yy", "zz", "xy", "yz", "zx")
    at = ([0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0])
    both = np.stack([tensor[at], (turn @ tensor @ turn.T)[at]])
    deviator = tensor - np.trace(tensor) / 3 * np.eye(3)
    np.testing.assert_allclose(von_mises(both, names), np.sqrt(1.5 * (deviator**2).sum()), rtol=1e-12)  # rounding
    exact = np.linalg.eigvalsh(tensor)[::-1]
    np.testing.assert_allclose(principal(both, names), [exact, exact], atol=1e-12)  # rounding
    largest = np.sqrt(((exact[[0, 1, 2]] - exact[[1, 2, 0]]) ** 2).sum() / 2)
    assert von_mises(both, names)[0] == pytest.approx(largest, rel=1e-12)  # rounding
