"""Rooms that several surfaces move: a wall beside a ceiling against a box lying on its side, and a ceiling in two parts
against the whole of it, in time, in frequency and with air that pushes back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from acoustics.air import Air
from acoustics.fields.half_space import HalfSpace
from acoustics.fields.rectangular import Room
from acoustics.fields.shaped import ShapedRoom
from acoustics.fields.sound_field import SoundField
from acoustics.losses import losses_from_t60
from acoustics.meshed.cavity_mesh import box_mesh
from acoustics.receivers import Receiver
from acoustics.rooms.box_coupling import Leak
from acoustics.source import SurfaceVibration
from femstruct.assembly.matrices import assemble
from femstruct.errors import FemstructError, InputError, InputErrors
from femstruct.impact.scene import Clock, HalfSine, Load, Scene
from femstruct.impact.simulate import simulate
from femstruct.language.cases import read_study
from femstruct.language.models import read_model
from femstruct.modal.damping import Damping, Ratio, with_damping
from femstruct.modal.reduction import modal_basis
from femstruct.sound.coupling import with_cavity
from femstruct.sound.placed import placed
from femstruct.sound.radiated_power import power_per_force
from femstruct.sound.surfaces import air_stiffness, coupling_findings, pressure_per_force, surface_velocity
from femstruct.study.asked import RoomPlan
from femstruct.workflow.run import run_study

SIZE = np.array([1.2, 0.9, 0.7])
AIR = Air(340.0, 1.2)
LOSSES = losses_from_t60(0.3)
HZ = np.linspace(15.0, 320.0, 120)


def gauss(a: float, b: float, cells: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points of a rectangle [n], [n] and weights, three by three in each cell."""
    node, share = np.polynomial.legendre.leggauss(3)
    along = [((np.arange(cells)[:, None] + (node + 1) / 2) / cells).ravel() * side for side in (a, b)]
    each = np.outer(np.tile(share, cells), np.tile(share, cells)).ravel() * a * b / (2 * cells) ** 2
    x, y = (one.ravel() for one in np.meshgrid(*along, indexing="ij"))
    return x, y, each


def test_a_wall_and_a_ceiling_are_two_boxes_one_lying_on_its_side() -> None:
    """By finite elements both at once; by cosines each alone, the wall as the ceiling of the box turned about y.

    The wall x = 0 becomes the ceiling: (x, y, z) -> (z, y, Lx - x).
    """
    lx, ly, lz = SIZE
    x, y, area = gauss(lx, ly, 6)
    across = np.cos(np.pi * x / lx) + 0.4
    above = SurfaceVibration(np.column_stack([x, y, np.full(x.size, lz)]), area, across[:, None], np.ones((1, 120)), HZ)
    b, a, area = gauss(ly, lz, 6)
    bulge = (np.sin(np.pi * a / lz) * np.sin(np.pi * b / ly))[:, None]
    rates = np.full((1, 120), 0.7j)
    beside = SurfaceVibration(np.column_stack([np.zeros(a.size), b, a]), area, bulge, rates, HZ)
    places = np.array([[0.4, 0.3, 0.2], [1.1, 0.8, 0.05], [0.7, 0.15, 0.5]])
    mics = [Receiver(str(i), place) for i, place in enumerate(places)]
    room = ShapedRoom(box_mesh(SIZE, [12, 9, 7]), "z1", AIR, LOSSES, up_to_hz=750.0)
    found, _ = room.harmonic([above, beside], mics)

    lying = Room([lz, ly, lx], AIR, LOSSES)
    turned = replace(beside, points=np.column_stack([a, b, np.full(a.size, lx)]))
    there = [Receiver(str(i), [z, y, lx - x]) for i, (x, y, z) in enumerate(places)]
    parts = [Room(SIZE, AIR, LOSSES).harmonic([above], mics)[0], lying.harmonic([turned], there)[0]]
    assert np.abs(parts[1]).max() > 0.1 * np.abs(parts[0]).max()
    # 0.13 %: nine cells to a wave at 320 Hz, modes above 750 Hz at rest; 6e-2 with the sign of one surface turned
    assert np.abs(found - sum(parts)).max() < 3e-3 * np.abs(found).max()


MODEL = """
title: A slab with parts of its underside
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts: {slab: {type: plate, material: concrete, thickness: 8 mm, origin: [0, 0, 0.7], size: [1.2, 0.9], mesh: [12, 9]}}
supports: {edges: {on: slab, edge: all, fix: simple}}
points: {drop: {on: slab, at: [0.35, 0.3]}}
surfaces:
  whole: {on: slab, side: below}
  left: {on: slab, side: below, region: {rectangle: [0.7 m, 0.9 m], at: [0.35 m, 0.45 m]}}
  right: {on: slab, side: below, region: {rectangle: [0.5 m, 0.9 m], at: [0.95 m, 0.45 m]}}
  top: {on: slab, side: above}
  high: {on: slab, side: above, region: {rectangle: [0.7 m, 0.9 m], at: [0.35 m, 0.45 m]}}
  far: {on: slab, side: above, region: {rectangle: [0.5 m, 0.9 m], at: [0.95 m, 0.45 m]}}
"""
TO_LEFT = (-0.25, 0.0)  # of the left part's centre from the middle of the ceiling


@pytest.fixture(scope="module")
def slab(tmp_path_factory):
    path = tmp_path_factory.mktemp("slab") / "slab.yaml"
    path.write_text(MODEL, encoding="utf-8")
    model = read_model(path)
    basis = with_damping(modal_basis(assemble(model), up_to=400.0), Damping(Ratio(0.01)))
    return basis, model.surfaces, model.points["drop"].probe("z")


FIELDS = [
    pytest.param(Room(SIZE, AIR, LOSSES), id="box"),
    pytest.param(ShapedRoom(box_mesh(SIZE, [7, 5, 4]), "z1", AIR, LOSSES, up_to_hz=450.0), id="mesh"),
    pytest.param(HalfSpace(AIR), id="half space"),
]
MICS = [Receiver("a", [0.4, 0.3, 0.2]), Receiver("b", [0.9, 0.7, 0.5])]


def rooms(field: SoundField, surfaces):
    """One room under the whole slab, and the same under its two parts."""
    if field.open_air is not None:
        shift = surfaces["high"].centre - surfaces["top"].centre
        return placed(field, surfaces["top"]), placed(
            field, surfaces["high"], (shift[0], shift[1]), walls={"plane": surfaces["far"]}
        )
    ceiling = field.movable[0]
    parts = placed(field, surfaces["left"], TO_LEFT, walls={ceiling: surfaces["right"]})
    return placed(field, surfaces["whole"]), parts


@pytest.mark.parametrize("field", FIELDS)
def test_a_ceiling_in_two_parts_is_heard_as_the_whole(field: SoundField, slab) -> None:
    basis, surfaces, drive = slab
    whole, parts = rooms(field, surfaces)
    assert len(parts.surfaces) == 2 and parts.origin == pytest.approx(whole.origin, abs=1e-12)  # rounding
    at = [np.concatenate(one.points) for one in (whole, parts)]
    assert len(at[0]) == len(at[1]) and {*map(tuple, at[0].round(9))} == {*map(tuple, at[1].round(9))}
    one, other = (pressure_per_force(basis, drive, room, MICS, HZ)[0] for room in (whole, parts))
    assert np.abs(one - other).max() < 1e-9 * np.abs(one).max()  # rounding
    push = Scene(loads=(Load("push", drive, HalfSine(10.0, 100.0)),))
    response = simulate(basis, push, Clock(0.2, 8e3))
    motions = [surface_velocity(response, room) for room in (whole, parts)]
    assert np.array_equal(motions[1][0].rates, motions[1][1].rates)
    heard = [field.pressures([motion], MICS)[0].p for motion in motions]
    # modes that move only one of the parts by more than rounding are with both; a box ends its search by 1e-4
    assert np.abs(heard[0] - heard[1]).max() < 1e-6 * np.abs(heard[0]).max()
    assert air_stiffness(basis, parts) == pytest.approx(air_stiffness(basis, whole), rel=1e-9)


@pytest.mark.parametrize("leak", [None, Leak(20.0, 2000.0)])
@pytest.mark.parametrize("field", FIELDS[:2])
def test_the_air_pushes_back_on_both_parts(field: SoundField, leak: Leak | None, slab) -> None:
    basis, surfaces, drive = slab
    whole, parts = rooms(field, surfaces)
    one, other = (with_cavity(basis, room, leak=leak, up_to_hz=300.0) for room in (whole, parts))
    assert one.frequency_hz[0] != pytest.approx(basis.frequency_hz[0], rel=0.01)  # the air does push back
    assert other.frequency_hz == pytest.approx(one.frequency_hz, rel=1e-9)
    # of shapes, which are coarser than frequencies
    assert np.abs(other.viscous) == pytest.approx(np.abs(one.viscous), rel=1e-6, abs=1e-9)
    heard = [pressure_per_force(each, drive, room, MICS, HZ)[0] for each, room in ((one, whole), (other, parts))]
    assert np.abs(heard[0] - heard[1]).max() < 1e-9 * np.abs(heard[0]).max()  # rounding


def test_a_half_space_takes_up_the_power_of_both_parts(slab) -> None:
    basis, surfaces, drive = slab
    (one, _), (other, _) = (
        power_per_force(basis, drive, room, HZ, [100.0]) for room in rooms(HalfSpace(AIR), surfaces)
    )
    assert other.power == pytest.approx(one.power, rel=1e-6)  # nodes of the far field are placed round the points
    alone, _ = power_per_force(basis, drive, placed(HalfSpace(AIR), surfaces["high"]), HZ, [100.0])
    assert (alone.power > 1.2 * one.power).any() or (alone.power < one.power / 1.2).any()


def test_what_cannot_move_a_wall_is_refused_before_anything_is_computed(slab) -> None:
    _, surfaces, _ = slab
    box, half = Room(SIZE, AIR, LOSSES), HalfSpace(AIR)
    mesh = ShapedRoom(box_mesh(SIZE, [3, 3, 3]), "z1", AIR, LOSSES)
    for field, first, walls, message in (
        (
            box,
            "left",
            {"x0": "right"},
            r"a surface on 'x0' that faces along \[0.0, 0.0, -1.0\] of the room, expected one that faces along \[1, ",
        ),
        (mesh, "left", {"x0": "right"}, "a surface that reaches beyond the wall 'x0' of the room"),
        (mesh, "left", {"z1": "far"}, "a surface on 'z1' that faces out, expected one that faces in"),
        (
            mesh,
            "left",
            {"roof": "right"},
            "a surface on 'roof' of a meshed room, expected one on z1, x0, x1, y0",
        ),
        (half, "high", {"ceiling": "far"}, "a surface on 'ceiling' of a half space, expected one on plane"),
    ):
        others = {wall: surfaces[name] for wall, name in walls.items()}
        with pytest.raises(InputError, match=rf"rooms\.hall(\.surfaces\.x0)?: got {message}"):
            placed(field, surfaces[first], TO_LEFT, "hall", others)
    with pytest.raises(InputError, match=r"reaches 0\.25 m beyond the ceiling of 1\.2 x 0\.9 m.*place its centre"):
        placed(box, surfaces["left"], walls={"ceiling": surfaces["right"]})
    with pytest.raises(InputError, match=r"rooms\.hall: got a surface with normal \(0, 0, 1\), expected .* down"):
        placed(box, surfaces["top"], name="hall")
    with pytest.raises(FemstructError, match=r"rooms\.yard\.coupling: got two-way with a half space, expected one-way"):
        RoomPlan("yard", half, "top", (), coupling="two-way")


class Vented(Room):
    """A box whose air is too free to act on anything."""

    pushes_back = False


def test_only_air_that_can_push_back_is_missed_in_one_way_coupling(slab) -> None:
    basis, surfaces, _ = slab
    found = [coupling_findings(basis, placed(kind(SIZE, AIR, LOSSES), surfaces["whole"])) for kind in (Room, Vented)]
    assert [[one.code for one in each] for each in found] == [["one-way-stiff-air"], []]


STUDY = """
model: slab.yaml
modes: {up_to: 400 Hz}
bodies: {ball: {mass: 50 g, above: drop, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
time: {duration: 0.1 s, sampling: 4 kHz}
rooms:
  hall: {size: [1.2, 0.9, 0.7], under: whole, losses: {t60: 0.3 s}, receivers: {mic: [0.4, 0.3, 0.2]}}
  parts:
    size: [1.2, 0.9, 0.7]
    under: left
    at: [0.35, 0.45]
    surfaces: {ceiling: right}
    losses: {t60: 0.3 s}
    receivers: {mic: [0.4, 0.3, 0.2]}
"""


def written(folder: Path, study: str = STUDY) -> Path:
    (folder / "slab.yaml").write_text(MODEL, encoding="utf-8")
    (folder / "hit.study.yaml").write_text(study, encoding="utf-8")
    return folder / "hit.study.yaml"


def test_a_study_has_further_surfaces(tmp_path: Path) -> None:
    case = run_study(read_study(written(tmp_path))).cases["as given"]
    assert case.case.study.rooms[1].walls == {"ceiling": "right"}
    whole, parts = (case.rooms[name].p for name in ("hall", "parts"))
    # modes that move one of the parts alone by less than 1e-9; a box ends its search by 1e-4
    assert np.abs(whole - parts).max() < 1e-6 * np.abs(whole).max()


@pytest.mark.parametrize(
    ("new", "message"),
    [
        ("x0: right", r"rooms\.parts: got a surface on 'x0' that faces along \[0.0, 0.0, -1.0\] of the room, expected"),
        ("x5: right", r":12:20: rooms\.parts\.surfaces\.x5: got a surface on 'x5' of .* one on ceiling, floor, x0, x1"),
        ("roof: right", r":12:22: rooms\.parts\.surfaces\.roof: got a surface on 'roof' of .* one on ceiling"),
        ("ceiling: rihgt", r":12:25: rooms\.parts\.surfaces\.ceiling: got 'rihgt'.*'right'"),
        ("ceiling: far", r"rooms\.parts: got a surface on 'ceiling' that faces out, expected one that faces in$"),
    ],
)
def test_further_surfaces_are_refused_where_they_are_written(tmp_path: Path, new: str, message: str) -> None:
    with pytest.raises((InputError, InputErrors), match=message):
        run_study(read_study(written(tmp_path, STUDY.replace("ceiling: right", new))))
