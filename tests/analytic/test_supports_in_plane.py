"""What supports hold in the planes of plates that stretch, and which plates do where nothing is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve
from scipy.spatial.transform import Rotation

import femstruct as fs
from femstruct.model.sections import rectangle
from femstruct.parts.rib_findings import arched_findings

STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
CONCRETE = fs.Material("concrete", 32e9, 0.2, 2400.0)
SIMPLE = (fs.Support("edges", "simple", on="plate", edge="all"),)
BOTH_ENDS = tuple(fs.Support(f"s {edge}", "simple", on="plate", edge=edge) for edge in ("x0", "x1"))
LYING = fs.Plate("plate", STEEL, 0.01, (0.0, 0.0, 0.0), (1.2, 0.8), (12, 8), in_plane="elastic")


def basis_of(*parts: fs.Plate | fs.Frame, supports=(), joints=(), count: int = 12, points=()) -> fs.ModalBasis:
    structure = fs.Structure("s", parts, joints, points=points, supports=supports)
    return fs.modal_basis(fs.assemble(fs.mesh_structure(structure)), count=count)


def ribbed(length: float = 6.0, wide: float = 0.7, mesh: float = 0.1) -> tuple[fs.Plate, fs.Frame, fs.Joint]:
    """The T strip of concrete of `test_plates_that_stretch`."""
    plate = fs.Plate("plate", CONCRETE, 0.06, (0.0, -wide / 2.0, 0.0), (length, wide), mesh)
    down, line = (0.0, 0.0, -0.155), ((0.0, 0.0, 0.0), (length, 0.0, 0.0))
    rib = fs.Frame("rib", CONCRETE, rectangle("r", 0.12, 0.25), (line,), start_offset=down, end_offset=down)
    return plate, rib, fs.Joint("weld", "rib", "plate")


def lift(basis: fs.ModalBasis) -> float:
    """The frequency of the mode that carries most of the weight [Hz]."""
    return float(basis.frequency_hz[np.argmax(basis.modal_mass[2, :12])])


def test_simple_edges_hold_a_flat_plate_and_leave_its_bending_as_it_was() -> None:
    """No rigid motion in the plane and no slow sway; modes of bending are those of a plate that is rigid there."""
    stiff = basis_of(replace(LYING, in_plane="rigid"), supports=SIMPLE, count=12).frequency_hz[:12]
    for supports in (SIMPLE, BOTH_ENDS):
        basis = basis_of(LYING, supports=supports, count=60)
        assert basis.n_rigid == 0
        moved = basis.modal_mass[:2].sum(axis=0)
        print(basis.frequency_hz[moved > 1e-6])
    found = basis_of(LYING, supports=SIMPLE, count=12).frequency_hz[:12]
    assert found == pytest.approx(stiff, rel=1e-9)  # rounding of the solver


@pytest.mark.parametrize("turn", [(0.3, 0.0, 0.0), (0.0, -0.6, 0.0), (0.3, -0.5, 0.8), (0.7, 0.1, -2.0)])
@pytest.mark.parametrize(("supports", "rigid"), [(SIMPLE, 0), (BOTH_ENDS[:1], 1)])
def test_simple_edges_hold_a_plate_that_slopes_as_one_that_lies(
    turn: tuple[float, ...], supports: tuple[fs.Support, ...], rigid: int
) -> None:
    """A roof has the modes of the floor that it is when it lies; on one edge it turns about that alone.
    The rounding of its axes was taken for what holds it in its plane, and it slid."""
    axes = Rotation.from_rotvec(turn).as_matrix()
    roof = replace(LYING, normal=tuple(axes[:, 2].tolist()), x_direction=tuple(axes[:, 0].tolist()), mesh=(6, 4))
    lying, sloping = (basis_of(one, supports=supports, count=8) for one in (replace(LYING, mesh=(6, 4)), roof))
    assert (lying.n_rigid, sloping.n_rigid) == (rigid, rigid)
    assert sloping.frequency_hz[rigid:8] == pytest.approx(
        lying.frequency_hz[rigid:8], rel=1e-9
    )  # rounding of the solver


@pytest.mark.parametrize("supports", [SIMPLE, BOTH_ENDS, BOTH_ENDS[:1]])
def test_simple_edges_do_not_resist_stretching(supports: tuple[fs.Support, ...]) -> None:
    """Pulled apart at its ends, it gets longer by F L / E A and narrower by nu of that, as a free one does; pushed
    sideways as a whole, it stays, and what holds it has the whole force."""
    flat = fs.Support("flat", ("z", "rx", "ry"), on="plate")
    model = fs.mesh_structure(fs.Structure("s", (LYING,), supports=(*supports, flat)))
    assembly, plate = fs.assemble(model), model.parts["plate"]
    load = np.zeros((len(assembly.points), 7))
    for x, pull in ((0.0, -1e6), (1.2, 1e6)):
        nodes, rows, weights, *_ = plate.spread("here", fs.Region("line", line=((x, 0.0), (x, 0.8))), 1e-9, 3)
        np.add.at(load, nodes, pull * weights[:, None, None] * rows[:, 0])
    moved = (assembly.dofs.T @ spsolve(assembly.K, assembly.dofs.T.T @ load.ravel())).reshape(-1, 7)
    strain = 1e6 / (210e9 * 0.01)
    assert np.ptp(moved[plate.grid[:, 3], 0]) == pytest.approx(1.2 * strain, rel=1e-9)  # rounding
    assert np.ptp(moved[plate.grid[5], 1]) == pytest.approx(0.3 * 0.8 * strain, rel=1e-9)  # rounding
    load[:] = 0.0
    load[plate.grid[4, 2], :2] = 300.0, 500.0
    moved = spsolve(assembly.K, assembly.dofs.T.T @ load.ravel())
    assert np.abs(moved).max() < 500.0 / (0.05 * 210e9 * 0.01)  # the plate gives way around a point force
    ground = assembly.forces["ground"]
    felt = ground.stiffness @ moved + ground.direct @ load.ravel()
    assert felt == pytest.approx([300.0, 500.0, 0.0], abs=1e-6)  # rounding


def test_a_ribbed_floor_is_no_arch() -> None:
    """Simple at both ends is what holds it in the middle lengthways; held lengthways at both ends it is an arch."""
    plate, rib, joint = ribbed()
    rollers = tuple(replace(support, fix="roller") for support in BOTH_ENDS)
    middle = fs.Support("middle", ("x",), on="plate", line=((3.0, 0.0), (3.0, 0.7)))
    straight = fs.Support("straight", ("y",), on="plate", line=((0.0, 0.35), (6.0, 0.35)))
    simple, held = (
        lift(basis_of(plate, rib, supports=(*supports, straight), joints=(joint,)))
        for supports in (BOTH_ENDS, (*rollers, middle))
    )
    assert simple == pytest.approx(held, rel=1e-9)  # rounding: in a symmetric mode neither has a force lengthways
    arch = tuple(replace(support, fix="clamped") for support in BOTH_ENDS)
    ends = tuple(fs.Support(f"x {edge}", ("x",), on="plate", edge=edge) for edge in ("x0", "x1"))
    arched = lift(basis_of(plate, rib, supports=(*rollers, *ends, straight), joints=(joint,)))
    # T of areas 0.042 and 0.030 m^2 with axes 0.155 m apart: the plate is z = 0.0646 m above the axis of both
    second = 0.7 * 0.06**3 / 12 + 0.12 * 0.25**3 / 12 + 0.042 * 0.0646**2 + 0.030 * 0.0904**2
    bound = np.sqrt(1 + 8 / np.pi**2 * 0.072 * 0.0646**2 / second)
    assert 1 + 0.85 * (bound - 1) < arched / simple < bound  # less: its ends turn back a little; 0.89 of it here
    assert lift(basis_of(plate, rib, supports=arch, joints=(joint,))) > arched


def arches(supports: tuple[fs.Support, ...], **changes) -> list[fs.Finding]:
    plate, rib, joint = ribbed()
    structure = fs.Structure("s", (replace(plate, **changes), rib), (joint,), supports=supports)
    return list(arched_findings(fs.mesh_structure(structure)))


def test_supports_that_make_an_arch_are_told() -> None:
    rollers = tuple(replace(support, fix="roller") for support in BOTH_ENDS)
    ends = tuple(fs.Support(f"x {edge}", ("x",), on="plate", edge=edge) for edge in ("x0", "x1"))
    for supports in (BOTH_ENDS, rollers, (*rollers, ends[0]), SIMPLE):
        assert arches(supports) == []
    (found,) = arches((*rollers, *ends))
    assert (found.code, found.severe) == ("arched-plate", False)
    assert "frequencies of bending are up to 19 % higher than with ends that can slide" in found.message
    clamped = tuple(replace(support, fix="clamped") for support in BOTH_ENDS)
    assert [one.message for one in arches(clamped)] == [found.message]
    assert arches(clamped, in_plane="rigid") == []  # eccentric-bars says more of that


@pytest.mark.parametrize("kind", ["slab", "shell"])
def test_slabs_and_shells_arch_where_simple_holds_both_ends(kind: str) -> None:
    """`simple` on a set holds x, y and z of its nodes: as much an arch as the plate held lengthways; 19 % as of it."""
    plate, rib, joint = ribbed()
    outline = ((0.0, 0.0), (6.0, 0.0), (6.0, 0.7), (0.0, 0.7))
    slab = fs.Slab("plate", plate.material, plate.thickness, outline, 0.35, origin=(0.0, -0.35, 0.0))
    floor = slab if kind == "slab" else slab.shell()
    low, high = ((x, -0.4, -1.0) for x in (0.0, 6.0)), ((x, 0.4, 1.0) for x in (0.0, 6.0))
    ends = [fs.Region("box", box=box) for box in zip(low, high, strict=True)]

    def held(*fixes: tuple[str, ...] | str) -> fs.Structure:
        supports = [fs.Support(f"end {at}", fix, on="plate", region=ends[at]) for at, fix in enumerate(fixes)]
        return fs.Structure("s", (floor, rib), (joint,), supports=tuple(supports))

    (found,) = arched_findings(fs.mesh_structure(held("simple", "simple")))
    assert "Supports hold plate lengthways at both ends of its eccentric rib" in found.message
    assert "up to 19 % higher than with ends that can slide" in found.message
    assert arched_findings(fs.mesh_structure(held("simple", ("y", "z")))) == ()
    assert arched_findings(fs.mesh_structure(held(("z",), ("z",)))) == ()
    models = [fs.mesh_structure(held("simple", other)) for other in ("simple", ("y", "z"))]
    arched, free = (lift(fs.modal_basis(fs.assemble(model), count=8)) for model in models)
    assert 1.0 + 0.85 * 0.19 < arched / free < 1.20  # 19 % is a bound: the ends turn back a little


def test_one_edge_and_a_clamp_opposite_hold_no_arch_either() -> None:
    """What another support holds already, a simple one does not hold again."""
    plate, rib, joint = ribbed()
    clamp = fs.Support("clamp", "clamped", on="plate", edge="x0")
    ends = [fs.Support("end", fix, on="plate", edge="x1") for fix in ("simple", "roller")]
    simple, roller = (basis_of(plate, rib, supports=(clamp, end), joints=(joint,)).frequency_hz for end in ends)
    assert simple == pytest.approx(roller, rel=1e-9)  # rounding


def test_two_plates_in_one_plane_are_held_as_one() -> None:
    whole = basis_of(replace(LYING, size=(1.2, 0.8)), supports=BOTH_ENDS, count=40).frequency_hz[:40]
    halves = [
        replace(LYING, name=name, origin=(x, 0.0, 0.0), size=(0.6, 0.8), mesh=(6, 8))
        for name, x in (("plate", 0.0), ("other", 0.6))
    ]
    ends = (BOTH_ENDS[0], replace(BOTH_ENDS[1], on="other"))
    joined = basis_of(*halves, supports=ends, joints=(fs.Joint("seam", "plate", "other"),), count=40)
    assert joined.n_rigid == 0
    assert joined.frequency_hz[:40] == pytest.approx(whole, rel=1e-9)  # rounding


def test_a_wall_stands_on_its_simple_foot() -> None:
    """It carries its weight along all of the foot, on which it can lean: c / 4 H in its plane, without contraction."""
    metal = replace(STEEL, nu=0.0)
    wall = fs.Plate(
        "plate",
        metal,
        0.1,
        (0, 0, 0),
        (4.0, 2.0),
        0.1,
        normal=(0, -1.0, 0),
        x_direction=(1.0, 0, 0),
        in_plane="elastic",
    )
    foot = fs.Support("foot", "simple", on="plate", edge="y0")
    basis = basis_of(wall, supports=(foot,), count=60)
    assert basis.n_rigid == 1
    rises = basis.frequency_hz[np.argmax(basis.modal_mass[2])]
    assert rises == pytest.approx(np.sqrt(metal.E / metal.rho) / 8.0, rel=1e-3)  # 20 cells: (pi h / 4 H)^2 / 6


def test_a_roller_leaves_the_plane_free() -> None:
    rolling = tuple(replace(support, fix="roller") for support in SIMPLE)
    for plate in (LYING, replace(LYING, in_plane="rigid")):
        basis = basis_of(plate, supports=rolling)
        assert basis.n_rigid == 3
        simple = basis_of(replace(plate, in_plane="rigid"), supports=SIMPLE).frequency_hz[:9]
        assert basis.frequency_hz[3:12] == pytest.approx(simple, rel=1e-9)  # rounding
    with pytest.raises(fs.InputError, match="a roller that is no edge or line"):
        basis_of(LYING, supports=(fs.Support("s", "roller", on="plate"),))


def is_rigid(*parts: fs.Plate | fs.Frame, joints=()) -> list[str]:
    model = fs.mesh_structure(fs.Structure("s", parts, joints))
    return [name for name, part in model.parts.items() if part.rigid_in_plane]


def test_what_is_joined_to_a_plate_decides_whether_it_stretches() -> None:
    plain = replace(LYING, in_plane=None)
    assert is_rigid(plain) == ["plate"]
    assert is_rigid(replace(plain, in_plane="elastic")) == []
    section, weld = rectangle("r", 0.05, 0.05), (fs.Joint("weld", "plate", "bar"),)
    along = fs.Frame("bar", STEEL, section, (((0.0, 0.4, 0.0), (1.2, 0.4, 0.0)),))
    assert is_rigid(plain, along, joints=weld) == ["plate"]  # it lies in the plate
    below = (0.0, 0.0, -0.03)
    assert is_rigid(plain, replace(along, start_offset=below, end_offset=below), joints=weld) == []
    post = replace(along, lines=(((0.6, 0.4, 0.0), (0.6, 0.4, 0.5)),))
    assert is_rigid(plain, post, joints=weld) == []
    assert is_rigid(replace(plain, element="hermite12"), post, joints=weld) == ["plate"]
    assert is_rigid(replace(plain, in_plane="rigid"), post, joints=weld) == ["plate"]
    beside = replace(plain, name="beside", origin=(1.2, 0.0, 0.0))
    seam = fs.Joint("seam", "plate", "beside")
    assert is_rigid(plain, beside, joints=(seam,)) == ["plate", "beside"]
    assert is_rigid(plain, beside, post, joints=(seam, *weld)) == []  # and takes what lies beside it along
    upright = replace(plain, name="beside", normal=(0.0, -1.0, 0.0), x_direction=(1.0, 0.0, 0.0))
    assert is_rigid(plain, upright, joints=(seam,)) == []


def test_a_layer_as_stiff_as_glue_makes_plates_stretch() -> None:
    """Two plates that act as one section of twice the thickness, against that as one plate."""
    h, steel = 0.01, replace(STEEL, nu=0.0)
    low = fs.Plate("plate", steel, h, (0, 0, 0), (1.0, 0.2), (20, 4))
    top = replace(low, name="top", origin=(0.0, 0.0, h + 1e-4))
    layer = fs.Foundation("glue", "top", fs.Region("whole"), 1e14, 1e14, to="plate")
    assert is_rigid(low, top, layer) == []
    assert is_rigid(low, top, replace(layer, shear=1e5)) == ["plate", "top"]
    held = tuple(fs.Support(f"{edge}", "roller", on="plate", edge=edge) for edge in ("x0", "x1"))
    glued = lift(basis_of(low, top, layer, supports=held, count=12))
    d = (2 * h + 1e-4) ** 3 / 12.0
    exact = np.pi / 2.0 * np.sqrt(steel.E * d / (2 * h * steel.rho))
    assert glued == pytest.approx(exact, rel=5e-3)  # a slit of 1 %, full of glue; held at the lower plate's middle
