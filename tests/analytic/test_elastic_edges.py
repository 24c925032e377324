"""Edges on springs: strips against the roots of their characteristic equations, losses on every path."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import scipy

from femstruct.assembly.matrices import assemble
from femstruct.errors import InputError, InputErrors
from femstruct.impact.scene import Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.language.models import read_model_file
from femstruct.laws.linear import Linear
from femstruct.modal.basis import ModalBasis
from femstruct.modal.complex_modes import complex_modes
from femstruct.modal.damping import Damping, FromMaterials, LossFactor, with_damping
from femstruct.modal.frf import direct_frf, frf
from femstruct.modal.reduction import modal_basis
from femstruct.modal.statics import statics
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.model import Model
from femstruct.model.regions import Region
from femstruct.model.structure import PlaceOn, Structure, Support
from femstruct.parts.plate import Plate
from femstruct.parts.slab import Slab

L, WIDTH, HEIGHT = 4.0, 0.5, 0.1  # m: a strip that only bends along x, since its nu is 0
CONCRETE = Material("concrete", E=30e9, nu=0.0, rho=2400.0, loss_factor=0.01)
BENDING, MASS = CONCRETE.E * HEIGHT**3 / 12.0, CONCRETE.rho * HEIGHT
MATERIALS = Damping(FromMaterials())
ENDS = ("x0", "x1")


def strip(*supports: Support) -> Model:
    part = Plate("strip", CONCRETE, HEIGHT, origin=(0.0, 0.0, 0.0), size=(L, WIDTH), mesh=(32, 1))
    points = (PlaceOn("a", "strip", ((1.3, 0.25),)), PlaceOn("b", "strip", ((2.9, 0.25),)))
    return mesh_structure(Structure("strip", (part,), supports=supports, points=points))


def springs(fix: str | tuple[str, ...], **stiffness: float) -> tuple[Support, ...]:
    given = {key.replace("_", " "): value for key, value in stiffness.items()}
    return tuple(
        Support(end, fix or (), on="strip", edge=end, stiffness=given, loss_factor=0.2)  # type: ignore[arg-type]
        for end in ENDS
    )


def solved(model: Model, up_to: float = 250.0) -> ModalBasis:
    return modal_basis(assemble(model), up_to=up_to)


def beta(basis: ModalBasis) -> np.ndarray:
    """k L of the modes."""
    return np.asarray((basis.omega[basis.modes] ** 2 * MASS / BENDING) ** 0.25 * L)


def root(equation: object, low: float, high: float) -> float:
    return float(scipy.optimize.brentq(equation, low, high, xtol=1e-13))


@pytest.mark.parametrize("r", [1.0, 20.0])
def test_a_pinned_edge_with_a_rotational_spring(r: float) -> None:
    """Even modes of a strip about its middle: r (tan k/2 + tanh k/2) + 2 k = 0; real_floors: 3.398799, 4.373711."""
    k = root(lambda x: r * (np.tan(x / 2) + np.tanh(x / 2)) + 2 * x, np.pi + 1e-9, 3 * np.pi - 1e-9)
    basis = solved(strip(*springs("roller", about_edge=r * BENDING / L)))
    first = int(np.argmin(np.abs(beta(basis) - k)))
    assert beta(basis)[first] == pytest.approx(k, rel=1e-6)  # 3e-7: 32 cubic elements
    x = np.linspace(-0.5, 0.5, 4001)
    shape = np.cos(k * x) / np.cos(k / 2) - np.cosh(k * x) / np.cosh(k / 2)
    slope = k * (np.tan(k / 2) + np.tanh(k / 2))
    share = 2 * r * slope**2 / (k**4 * scipy.integrate.simpson(shape**2, x=x))
    assert share == pytest.approx({1.0: 0.24644428, 20.0: 0.24658944}[r], rel=1e-6)  # real_floors' elements
    held = sum(basis.part_stiffness[f"{end} springs"][first, first] for end in ENDS)
    assert held / basis.omega[first] ** 2 == pytest.approx(share, rel=1e-5)  # square of the error of the shape
    eta = 0.2 * share + 0.01 * (1.0 - share)
    assert 2 * with_damping(basis, MATERIALS).damping_ratio[first] == pytest.approx(eta, rel=1e-5)


@pytest.mark.parametrize("t", [100.0, 1000.0])
def test_an_edge_on_springs_across_the_plate(t: float) -> None:
    """k^3 (tan k/2 + tanh k/2) = 2 t for even modes; real_floors: 2.876751 and 3.111063."""
    k = root(lambda x: x**3 * (np.sin(x / 2) + np.tanh(x / 2) * np.cos(x / 2)) - 2 * t * np.cos(x / 2), 0.5, np.pi)
    assert k == pytest.approx({100.0: 2.8767507, 1000.0: 3.1110635}[t], rel=1e-7)  # its digits
    basis = solved(strip(*springs("", z=t * BENDING / L**3)))
    assert np.abs(beta(basis) / k - 1.0).min() < 1e-6  # 32 cubic elements


def test_a_slab_and_a_plate_on_the_same_springs_agree() -> None:
    """The slab shears: thin enough that it does not matter. Its motion along an edge is that of its cells."""
    thin, stiffness = 0.02, {"z": 2e4, "about edge": 3e3}
    material = Material("concrete", E=30e9, nu=0.2, rho=2400.0)
    corners = ((0.0, 0.0), (2.0, 0.0), (2.0, 1.5), (0.0, 1.5))
    slab = Slab("floor", material, thin, corners, mesh=0.1)
    plate = Plate("floor", material, thin, origin=(0.0, 0.0, 0.0), size=(2.0, 1.5), mesh=(20, 15))
    on_slab = Support("rim", on="floor", region=Region("set", named="rim"), stiffness=stiffness)
    on_plate = Support("rim", on="floor", edge="all", stiffness=stiffness)
    one, other = (
        solved(mesh_structure(Structure("floor", (part,), supports=(support,))), 60.0)
        for part, support in ((slab, on_slab), (plate, on_plate))
    )
    f, g = (basis.frequency_hz[[kind == "elastic" for kind in basis.kind]][:6] for basis in (one, other))
    assert f == pytest.approx(g, rel=0.01)  # bilinear cells of 0.1 m, 0.5 % in the sixth mode
    shares = [np.diag(b.part_stiffness["rim"])[b.n_rigid :][:6] / b.omega[b.n_rigid :][:6] ** 2 for b in (one, other)]
    assert shares[0] == pytest.approx(shares[1], abs=0.01) and shares[1].max() > 0.3


def test_a_line_and_an_edge_carry_the_weight() -> None:
    """Rigid on soft springs: it sinks by its weight over the stiffness, and the forces are those of the springs."""
    soft = {"z": 1e3}
    line = Support("line", on="strip", line=((2.0, 0.0), (2.0, WIDTH)), stiffness=soft)
    model = strip(*springs("", z=1e3), line, Support("kept", ("x", "y"), on="strip"))
    rest = statics(model, assemble(model), [], weight=True)
    weight = 9.80665 * MASS * L * WIDTH
    forces = sum(rest.forces[name][2] for name in (*ENDS, "line"))
    # rounding times the stiffest over the softest motion, 3e10, is 8e-6; 8e-9 on one of two processors
    assert forces == pytest.approx(-weight, rel=1e-6) == rest.forces["ground"][2]
    assert rest.displacement[:, 2].mean() == pytest.approx(-weight / (3 * 1e3 * WIDTH), rel=2e-3)  # it bends a little


def test_springs_across_an_edge_that_is_kept_in_the_plane() -> None:
    """One support holds in the plane what two would, and its springs are those of an edge that is free there."""
    kept = (Support(f"kept {end}", ("x", "y"), on="strip", edge=end) for end in ENDS)
    one, two = (solved(strip(*some)) for some in (springs(("x", "y"), z=1e6), (*springs("", z=1e6), *kept)))
    assert (one.n_rigid, two.n_rigid) == (0, 0)
    assert one.omega == pytest.approx(two.omega, rel=1e-9)  # rounding
    with pytest.raises(InputError, match=r"x0\.stiffness\.z: got .* fix: \[x, z\], which holds strip along its normal"):
        strip(*springs(("x", "z"), z=1e6))


def test_losses_of_edges_are_those_of_direct_responses_and_of_complex_modes() -> None:
    model = strip(*springs("", z=300 * BENDING / L**3, about_edge=BENDING / L))
    assembly = assemble(model)
    drive, at = (model.points[name].probe("z") for name in "ab")
    basis = with_damping(modal_basis(assembly, up_to=1500.0, probes=[drive, at]), MATERIALS)
    lines = np.array([5.0, 12.0, 30.0, 55.0, 90.0])
    modal, direct = frf(basis, drive, at, lines), direct_frf(assembly, drive, at, lines, MATERIALS)
    assert np.abs(modal / direct - 1.0).max() < 2e-3  # 8e-4: losses of 20 % couple to modes above 1.5 kHz, too
    force, check = (
        one(which, drive, row, lines, *law, kind="transmissibility")
        for one, which, row, law in (
            (frf, basis, basis.outputs["x0.z"], ()),
            (direct_frf, assembly, "x0.z", (MATERIALS,)),
        )
    )
    assert np.abs(force / check - 1.0).max() < 0.02  # a part's loss at each mode
    found = complex_modes(assembly, MATERIALS, 100.0)
    squares = np.linalg.eigvals(np.diag(basis.omega**2) + 1j * basis.hysteretic)
    roots = np.sqrt(squares[np.argsort(np.abs(squares))][basis.n_rigid :])
    assert found.eigenvalues[:3] == pytest.approx(1j * roots[:3], rel=1e-4)  # modes above 1.5 kHz left out


def test_energy_of_a_blow_on_elastic_edges_closes() -> None:
    model = strip(*springs("", z=300 * BENDING / L**3, about_edge=BENDING / L))
    drive = model.points["a"].probe("z")
    basis = with_damping(modal_basis(assemble(model), up_to=300.0, probes=[drive]), MATERIALS)
    contact = Contact("contact", upper="ball", lower=drive, law=Linear(1e6))
    response = simulate(basis, Scene((Body("ball", 5.0, -1.0),), (contact,)), Clock(0.05, 20000.0))
    assert response.ledger.residual < 1e-9  # steps and rounding
    assert response.ledger.end.lost_modes > 0.1  # of 2.5 J
    assert np.abs(basis.hysteretic - np.diag(np.diag(basis.hysteretic))).max() > 0.0  # the matrix is full


def test_losses_that_a_general_law_leaves_out_are_told() -> None:
    basis = solved(strip(*springs("roller", about_edge=BENDING / L)))
    told = [one for one in with_damping(basis, Damping(LossFactor(0.02))).findings if one.code == "loss-unused"]
    assert [one.message.partition(":")[0] for one in told] == ["x0 springs", "x1 springs"]
    assert told[0].values["unused_loss_factor"] == pytest.approx(0.2 * 0.24644428 / 2, rel=1e-4)  # digits of the share
    assert not [one for one in with_damping(basis, MATERIALS).findings if one.code == "loss-unused"]
    assert not [one for one in with_damping(basis, Damping(LossFactor(0.6))).findings if one.code == "loss-unused"]


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"fix": ()}, "fix"),
        ({"stiffness": {"z": 1e6}, "fix": "simple"}, r"stiffness\.z: got a stiffness beside simple"),
        ({"stiffness": {"about edge": 1e6}, "fix": "clamped"}, "clamped beside springs"),
        ({"stiffness": {"rx": 1e6}}, "rx: 1e\\+06"),
        ({"stiffness": {"z": -1.0}}, "z: -1"),
        ({"stiffness": {"z": 1.0}, "edge": None}, "springs or walls of no edge"),
        ({"fix": "simple", "loss_factor": 0.2}, "a loss factor without springs"),
        ({"stiffness": {"z": 1.0}, "loss_factor": 2.0}, "loss_factor"),
    ],
)
def test_springs_that_cannot_be_are_refused(given: dict[str, object], told: str) -> None:
    with pytest.raises(InputError, match=told):
        Support("e", **{"on": "strip", "edge": "x0", **given})  # type: ignore[arg-type]


MODEL = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400, loss_factor: 1 %}}
parts:
  slab: {type: plate, material: concrete, thickness: 0.2 m, origin: [0, 0, 0], size: [5, 4], mesh: [4, 3]}
points: {corner: {on: slab, at: [0, 0]}}
supports:
  strip: {on: slab, edge: all, stiffness: {z: 5 MN/m^2, about edge: 40 kN*m/m}, loss_factor: 20 %}
damping: {from: materials}
"""


def test_springs_of_an_edge_are_read(tmp_path: Path) -> None:
    (tmp_path / "slab.yaml").write_text(MODEL, encoding="utf-8")
    structure = read_model_file(tmp_path / "slab.yaml").structure
    assert isinstance(structure, Structure)
    assert structure.supports == (
        Support("strip", on="slab", edge="all", stiffness={"z": 5e6, "about edge": 40e3}, loss_factor=0.2),
    )


def test_a_rim_of_a_slab_takes_them_too(tmp_path: Path) -> None:
    """A slab has sets in place of edges; of one that is written as a plate's the message says so."""
    slab = MODEL.replace("type: plate", "type: slab").replace(
        "origin: [0, 0, 0], size: [5, 4], mesh: [4, 3]", "outline: [[0, 0], [5, 0], [5, 4], [0, 4]], mesh: 0.5 m"
    )
    (tmp_path / "slab.yaml").write_text(slab, encoding="utf-8")
    with pytest.raises(InputErrors, match=r"strip\.on: got 'slab'.*of a slab write 'set: rim'"):
        read_model_file(tmp_path / "slab.yaml")
    (tmp_path / "slab.yaml").write_text(slab.replace("edge: all", "set: rim"), encoding="utf-8")
    structure = read_model_file(tmp_path / "slab.yaml").structure
    assert isinstance(structure, Structure)
    elastic = mesh_structure(structure).elastics[0]
    assert elastic.stiffness.sum() == pytest.approx(18.0 * (5e6 + 40e3), rel=1e-12)  # per length of the rim; rounding


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (
            "z: 5 MN/m^2",
            "z: 5 MN/m",
            r"strip\.stiffness\.z: got '5 MN/m', which is a stiffness, expected a stiffness per",
        ),
        ("about edge: 40 kN*m/m", "about edge: 40 kN*m", r"about edge: got '40 kN\*m', which is a .*N\*m/m"),
        ("about edge:", "about_edge:", r"unknown key 'about_edge'.*did you mean 'about edge'"),
        ("{z: 5 MN/m^2, about edge: 40 kN*m/m}", "{}", r"strip\.stiffness: got no stiffness, expected z, about edge"),
        ("edge: all,", "edge: all, fix: simple,", r"stiffness\.z: got a stiffness beside fix: simple, which holds z"),
        (
            "edge: all,",
            "edge: all, fix: [rx],",
            r"strip\.fix: got .*beside springs, expected simple, roller, directions",
        ),
        ("edge: all, ", "", r"strip.*: got a stiffness of no edge, expected an edge of a plate"),
        (
            "stiffness: {z: 5 MN/m^2, about edge: 40 kN*m/m}, loss_factor: 20 %",
            "",
            r"without 'fix', expected 'fix', or",
        ),
        ("stiffness: {z: 5 MN/m^2, about edge: 40 kN*m/m}", "fix: simple", r"loss_factor without stiffness"),
        ("on: slab, edge: all", "at: corner", r"a stiffness of no edge"),
    ],
)
def test_a_mistake_in_them_has_its_place(old: str, new: str, told: str, tmp_path: Path) -> None:
    head, tail = MODEL.split("supports:")
    assert old in tail
    (tmp_path / "slab.yaml").write_text(f"{head}supports:{tail.replace(old, new)}", encoding="utf-8")
    with pytest.raises(InputErrors, match=told) as caught:
        read_model_file(tmp_path / "slab.yaml")
    assert f"slab.yaml:{MODEL.splitlines().index('supports:') + 2}:" in str(caught.value)
