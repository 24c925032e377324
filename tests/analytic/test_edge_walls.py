"""Walls at edges: strips against complex roots of their characteristic equation, responses against direct ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from femstruct.assembly.matrices import assemble
from femstruct.errors import InputError, InputErrors
from femstruct.impact.scene import Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.language.models import read_model_file
from femstruct.laws.linear import Linear
from femstruct.modal.basis import ModalBasis
from femstruct.modal.by_frequency import own_modes
from femstruct.modal.complex_modes import complex_modes
from femstruct.modal.damping import Damping, FromMaterials, LossFactor, with_damping
from femstruct.modal.frf import direct_frf, frf
from femstruct.modal.reduction import modal_basis
from femstruct.modal.statics import statics
from femstruct.model.materials import EdgeWall, LossByFrequency, Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.model import Model
from femstruct.model.structure import PlaceOn, Structure, Support
from femstruct.parts.plate import Plate
from femstruct.workflow.structure_findings import structure_findings_before

L, WIDTH, HEIGHT = 4.0, 0.5, 0.1  # m: a strip that only bends along x, since its nu is 0
CONCRETE = Material("concrete", E=30e9, nu=0.0, rho=2400.0)
BENDING, MASS = CONCRETE.E * HEIGHT**3 / 12.0, CONCRETE.rho * HEIGHT
MATERIALS = Damping(FromMaterials())
ROOTS = {  # (walls, q): real part of beta^2 and loss factor of modes 1 to 4, real_floors edge-walls
    (1, 1.0): ([15.39475, 49.837226, 104.12806, 178.14959], [0.3607146, 0.19646247, 0.13593641, 0.10389839]),
    (1, 0.25): ([11.439587, 42.579004, 93.467057, 164.09348], [0.2318798, 0.11817873, 0.07980075, 0.060219948]),
    (2, 1.0): ([18.104322, 54.520007, 110.83576, 186.87872], [0.27961119, 0.159269, 0.11170867, 0.086014129]),
}  # fmt: skip


def strip(walls: int, q: float, material: Material = CONCRETE, loss: float | LossByFrequency = 0.0) -> Model:
    """q = B_w k_w / (B k): of walls of the strip's own material the ratio of thicknesses to the power of 2.5."""
    own = Material("concrete", E=30e9, nu=0.0, rho=2400.0, loss_factor=loss)
    part = Plate("strip", own, HEIGHT, origin=(0.0, 0.0, 0.0), size=(L, WIDTH), mesh=(32, 1))
    kept = Support("kept", ("x", "y"), on="strip")
    stand = (EdgeWall(material, HEIGHT * q**0.4),) * walls
    ends = tuple(Support(end, "roller", on="strip", edge=end, walls=stand) for end in ("x0", "x1"))
    points = (PlaceOn("a", "strip", ((1.3, 0.25),)), PlaceOn("b", "strip", ((2.9, 0.25),)))
    return mesh_structure(Structure("strip", (part,), supports=(*ends, kept), points=points))


def squared(basis: ModalBasis) -> np.ndarray:
    """beta^2 of the modes."""
    return np.asarray(basis.omega[basis.modes] * L**2 * np.sqrt(MASS / BENDING))


@pytest.mark.parametrize(("walls", "q"), ROOTS)
def test_modes_are_those_of_the_complex_roots(walls: int, q: float) -> None:
    """Frequency and decay of every mode at its own frequency; by strain energy they are 6 % low and 8 % high."""
    basis = with_damping(modal_basis(assemble(strip(walls, q)), up_to=600.0), MATERIALS)
    beta, eta = ROOTS[walls, q]
    places = [int(np.argmin(np.abs(squared(basis) - one))) for one in beta]
    assert squared(basis)[places] == pytest.approx(beta, rel=2e-5)  # 32 cubic elements: 1e-5 in the fourth
    assert 2 * basis.damping_ratio[places] == pytest.approx(eta, rel=3e-4)  # what residual vectors leave in the fourth
    k, damping = len(basis.omega), basis.time_damping
    assert np.abs(damping - np.diag(np.diag(damping))).max() == 0.0 and k >= 4  # fast in time: nothing couples
    told = [one for one in basis.findings if one.code == "walls-damp-much"]
    assert told and told[0].values["loss_factor"] == pytest.approx(eta[0], rel=1e-3)  # printed digits
    lost = sum(np.diag(basis.part_stiffness[f"{end} walls"]) for end in ("x0", "x1"))
    assert lost[places] / basis.omega[places] ** 2 == pytest.approx(eta, rel=3e-4)  # walls alone take it


def test_complex_modes_are_exact() -> None:
    found = complex_modes(assemble(strip(1, 1.0)), MATERIALS, 300.0)
    omega = found.eigenvalues / 1j * L**2 * np.sqrt(MASS / BENDING)
    for beta, eta in zip(*ROOTS[1, 1.0], strict=True):
        nearest = omega[np.argmin(np.abs(omega.real - beta))]
        assert nearest.real == pytest.approx(beta, rel=3e-5)  # 32 cubic elements
        assert 2 * nearest.imag / nearest.real == pytest.approx(eta, rel=5e-5)  # the same
    assert found.residual.max() < 1e-10  # rounding


def test_complex_modes_have_tables_at_their_own_frequencies() -> None:
    """Of one part with a table and nothing else eta(f) is that of each mode: lambda^2 = -omega^2 (1 + j eta(f))."""
    table = LossByFrequency(((5.0, 0.2), (50.0, 0.05)))
    lossy = Material("m", 30e9, 0.0, 2400.0, table)
    part = Plate("strip", lossy, HEIGHT, origin=(0.0, 0.0, 0.0), size=(L, WIDTH), mesh=(16, 1))
    ends = tuple(Support(end, "simple", on="strip", edge=end) for end in ("x0", "x1"))
    assembly = assemble(mesh_structure(Structure("strip", (part,), supports=ends)))
    real = modal_basis(assembly, up_to=70.0)
    found = complex_modes(assembly, MATERIALS, 70.0)
    eta = table.at(found.frequency_hz)
    omega = real.omega[real.modes][: len(eta)]
    assert -(found.eigenvalues**2) == pytest.approx(omega**2 * (1 + 1j * eta), rel=1e-8)  # rounding of two solvers


def test_responses_by_modes_against_direct_ones() -> None:
    """Energy in third octaves: a sum of real modes is low by up to four decibels times the loss factor of the walls."""
    model = strip(2, 0.165, loss=0.01)
    assembly = assemble(model)
    drive = model.points["a"].probe("z")
    basis = with_damping(modal_basis(assembly, up_to=900.0, probes=[drive]), MATERIALS)
    first = float(basis.frequency_hz[basis.n_rigid])
    lines = np.geomspace(first / 2 ** (1 / 6), 12 * first, 200)
    by_modes, at_lines = frf(basis, drive, drive, lines), direct_frf(assembly, drive, drive, lines, MATERIALS)
    bands = np.floor(3 * np.log2(lines / lines[0] + 1e-12)).astype(int)
    modal, direct = (np.bincount(bands, (lines * np.abs(one)) ** 2)[:10] for one in (by_modes, at_lines))
    off = 10 * np.log10(modal / direct)
    strongest = 2 * basis.damping_ratio[basis.n_rigid]
    assert 0.2 < strongest < 0.35
    assert np.abs(off).max() < 4.0 * strongest  # what the finding says: 0.9 dB here
    assert np.abs(off).max() > 0.2  # and it is no exaggeration


def test_energy_of_a_blow_closes_and_walls_are_still_at_rest() -> None:
    model = strip(2, 0.25)
    drive = model.points["a"].probe("z")
    assembly = assemble(model)
    basis = with_damping(modal_basis(assembly, up_to=300.0, probes=[drive]), MATERIALS)
    contact = Contact("contact", upper="ball", lower=drive, law=Linear(1e6))
    response = simulate(basis, Scene((Body("ball", 5.0, -1.0),), (contact,)), Clock(0.05, 20000.0))
    assert response.ledger.residual < 1e-9  # steps and rounding
    rest = statics(model, assembly, [(model.points["a"].probe("z"), -100.0)])
    free = (*(Support(end, "roller", on="strip", edge=end) for end in ("x0", "x1")), model.structure.supports[-1])
    bare = mesh_structure(Structure("strip", model.structure.parts, supports=free, points=model.structure.points))
    same = statics(bare, assemble(bare), [(bare.points["a"].probe("z"), -100.0)])
    assert rest.displacement == pytest.approx(same.displacement, rel=1e-9, abs=1e-15)  # rounding


def test_forces_on_walls_that_damp_much_are_nearly_those_of_the_modes() -> None:
    """What an edge carries is what the strip does not accelerate: to second order in the losses."""
    model = strip(2, 0.25)
    basis = modal_basis(assemble(model), up_to=600.0)
    place = int(np.argmin(np.abs(squared(basis) - 12.947215)))
    ground = basis.outputs["ground.z"]
    carried = ground.stiffness[place] / (-(basis.omega[place] ** 2) * basis.momentum[2, place])
    assert abs(carried) == pytest.approx(1.0, abs=0.11)  # the square of its loss factor; 0.07 here


def test_a_wall_has_its_closed_form() -> None:
    """w = A (exp(-jkx) - exp(-kx)) at a pinned edge: moment over rotation is B k (1 + j)."""
    wall = EdgeWall(Material("m", 5e9, 0.2, 1400.0), 0.175)
    B, m, w = 5e9 * 0.175**3 / 12 / 0.96, 245.0, 2 * np.pi * 80.0
    k = (m * w**2 / B) ** 0.25
    expected = B * (-(k**2) - k**2) / (-1j * k + k) * -1.0
    assert wall.stiffness(80.0) * (1 + 1j * wall.loss_factor) == pytest.approx(expected, rel=1e-12)  # rounding
    lossy = EdgeWall(Material("m", 5e9, 0.2, 1400.0, 0.1), 0.175)
    expected = expected * (1 + 0.1j) ** 0.75
    assert lossy.stiffness(80.0) * (1 + 1j * lossy.loss_factor) == pytest.approx(expected, rel=1e-12)  # rounding


@pytest.mark.parametrize(("q", "absorbed"), [(0.1, 0.16528926), (0.5, 0.44444444), (1.0, 0.5), (2.0, 0.44444444)])
def test_walls_absorb_what_the_reflection_at_a_pinned_edge_leaves(q: float, absorbed: float) -> None:
    """w = exp(-jkx) + r exp(jkx) + t exp(kx) where w = 0 and B w'' = -k_r w'; real_floors: 2 q / (1 + q)^2."""
    wall = EdgeWall(CONCRETE, HEIGHT * q**0.4)
    k = (MASS * (2 * np.pi * 63.0) ** 2 / BENDING) ** 0.25
    spring = wall.stiffness(63.0) * (1 + 1j * wall.loss_factor) / (BENDING * k)
    left = np.array([[1.0, 1.0], [-1.0 + 1j * spring, 1.0 + spring]])
    r, _ = np.linalg.solve(left, np.array([-1.0, 1.0 + 1j * spring]))
    assert 1.0 - abs(r) ** 2 == pytest.approx(absorbed, rel=1e-7)  # its digits


def test_losses_of_walls_that_a_general_law_leaves_out_are_told() -> None:
    basis = with_damping(modal_basis(assemble(strip(1, 0.25)), up_to=100.0), Damping(LossFactor(0.02)))
    assert [one.message.partition(":")[0] for one in basis.findings if one.code == "loss-unused"] == [
        "x0 walls",
        "x1 walls",
    ]


def test_a_wall_of_an_implausible_material_is_told() -> None:
    slip = Material("steel", E=210e6, nu=0.3, rho=7850.0)  # MPa for GPa
    model = strip(2, 0.25, slip)
    told = [one.code for one in structure_findings_before(model.structure, model) if "steel" in one.message]
    assert told == ["implausible-material"]


def test_without_walls_nothing_is_turned() -> None:
    values = np.array([1.0, 4.0, 9.0, 100.0])
    own = own_modes(np.diag(values), [np.zeros((4, 4), dtype=np.complex128)], 1.0, 0, 3, 1)
    assert own.omega == pytest.approx([1.0, 2.0, 3.0], rel=1e-12) and (own.loss == 0.0).all()  # rounding
    assert np.abs(own.turn) == pytest.approx(np.eye(4), abs=1e-12) and own.residual_squared == pytest.approx(
        [100.0]
    )  # rounding


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"stiffness": {"about edge": 1.0}}, "a stiffness beside walls"),
        ({"fix": "clamped"}, "clamped beside springs or walls"),
        ({"fix": ()}, "fix"),
        ({"edge": None}, "springs or walls of no edge"),
        ({"loss_factor": 0.1}, "a loss factor without springs"),
    ],
)
def test_walls_that_cannot_be_are_refused(given: dict[str, object], told: str) -> None:
    walls = (EdgeWall(CONCRETE, 0.1),)
    with pytest.raises(InputError, match=told):
        Support("e", **{"on": "strip", "edge": "x0", "fix": "simple", "walls": walls, **given})  # type: ignore[arg-type]


MODEL = """
materials:
  concrete: {E: 30 GPa, nu: 0.2, rho: 2400, loss_factor: 1 %}
  brick: {E: 5 GPa, nu: 0.2, rho: 1400, loss_factor: 1.5 %}
  clt: {E: [11 GPa, 370 MPa], G: [690 MPa, 69 MPa], nu: 0.3, rho: 450}
parts:
  slab: {type: plate, material: concrete, thickness: 0.2 m, origin: [0, 0, 0], size: [5, 4], mesh: [4, 3]}
points: {corner: {on: slab, at: [0, 0]}}
supports:
  edges: {on: slab, edge: all, walls: 2, wall: {material: brick, thickness: 175 mm}}
damping: {from: materials}
"""


def test_walls_are_read(tmp_path: Path) -> None:
    (tmp_path / "slab.yaml").write_text(MODEL, encoding="utf-8")
    structure = read_model_file(tmp_path / "slab.yaml").structure
    assert isinstance(structure, Structure)
    wall = EdgeWall(Material("brick", 5e9, 0.2, 1400.0, 0.015), 0.175)
    assert structure.supports == (Support("edges", "simple", on="slab", edge="all", walls=(wall, wall)),)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("walls: 2", "walls: 0", r"edges\.walls: got 0, expected 1 to 4: how many walls"),
        ("walls: 2", "walls: 2.5", r"edges\.walls: got 2\.5"),
        (", wall: {material: brick, thickness: 175 mm}", "", r"edges: got walls without wall"),
        ("material: brick", "material: brik", r"wall\.material: got 'brik'.*did you mean 'brick'"),
        ("material: brick", "material: clt", r"supports\.edges: got a wall of 'clt', orthotropic, expected an iso"),
        ("175 mm", "175", r"wall\.thickness"),
        (
            "walls: 2",
            "walls: 2, fix: clamped",
            r"edges\.fix: got 'clamped' beside walls, expected simple, roller",
        ),
        ("walls: 2", "walls: 2, stiffness: {z: 5 MN/m^2}", r"both stiffness and walls"),
        ("on: slab, edge: all", "at: corner", r"walls of no edge"),
    ],
)
def test_a_mistake_in_walls_has_its_place(old: str, new: str, told: str, tmp_path: Path) -> None:
    assert old in MODEL
    (tmp_path / "slab.yaml").write_text(MODEL.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputErrors, match=told) as caught:
        read_model_file(tmp_path / "slab.yaml")
    assert f"slab.yaml:{MODEL.splitlines().index('supports:') + 2}:" in str(caught.value)
