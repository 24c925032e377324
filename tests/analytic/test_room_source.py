"""A point source in a room: reciprocity with a force on the structure, the same system with the source on every
coordinate of the air, a piston in a tube in closed form, digits of a study."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import csr_array

from acoustics.air import Air
from acoustics.errors import AcousticsError
from acoustics.fields.half_space import HalfSpace
from acoustics.fields.rectangular import Room
from acoustics.fields.shaped import ShapedRoom
from acoustics.losses import Losses, losses_from_beta, losses_from_t60, losses_from_t60_bands
from acoustics.meshed.cavity_mesh import box_mesh
from acoustics.meshed.walls import YieldingWall, absorbing
from acoustics.receivers import Receiver
from acoustics.rooms.box import room_modes
from acoustics.rooms.box_coupling import Leak
from acoustics.rooms.box_walls import wall_loads
from acoustics.source import SurfaceShapes
from femstruct.assembly.matrices import assemble
from femstruct.errors import FemstructError, InputErrors
from femstruct.files.results_file import read_results, write_results
from femstruct.language.cases import read_study
from femstruct.language.models import read_model
from femstruct.modal.closed_form import oscillator
from femstruct.modal.damping import Damping, Ratio, with_damping
from femstruct.modal.reduction import modal_basis
from femstruct.model.probe import Surface
from femstruct.sound.coupling import with_cavity
from femstruct.sound.placed import placed
from femstruct.sound.surfaces import pressure_per_force, velocity_per_source
from femstruct.workflow.run import run_study, without_rooms

AIR, SIZE = Air(343.0, 1.21), np.array([4.0, 3.0, 4.0])
HZ = np.array([12.0, 31.0, 42.9, 57.0, 63.0, 85.0, 110.0])
CORNER = Receiver("speaker", [3.5, 0.6, 0.4])  # far from both surfaces: cosines end within rounding
MODEL = """
title: A slab on a wall
materials:
  concrete: {E: 30 GPa, nu: 0.2, rho: 2400}
  brick: {E: 8 GPa, nu: 0.2, rho: 1600}
parts:
  slab: {type: plate, material: concrete, thickness: 120 mm, origin: [0, 0, 2.5], size: [4, 3], mesh: 500 mm}
  wall: {type: plate, material: brick, thickness: 115 mm, origin: [0, 0, 0], size: [3, 2.5], mesh: 500 mm,
    normal: [1, 0, 0], x_direction: [0, 1, 0]}
joints: {top: {connect: [wall, slab]}}
points: {drop: {on: slab, at: [1.3, 1.1]}, face middle: {on: wall, at: [1.2, 1.4]}}
supports:
  feet: {on: wall, edge: y0, fix: simple}
  side: {on: wall, edge: x0, fix: roller}
  far: {on: slab, edge: x1, fix: simple}
  front: {on: slab, edge: y0, fix: simple}
  back: {on: slab, edge: y1, fix: simple}
surfaces: {under: {on: slab, side: below}, over: {on: slab, side: above}, face: {on: wall, side: x}}
"""


@pytest.fixture(scope="module")
def corner(tmp_path_factory):
    path = tmp_path_factory.mktemp("corner") / "corner.yaml"
    path.write_text(MODEL, encoding="utf-8")
    model = read_model(path)
    basis = with_damping(modal_basis(assemble(model), up_to=160.0), Damping(Ratio(0.02)))
    return basis, model.surfaces, model.points


def off(basis, room, source: Receiver, probe, hz=HZ) -> float:
    """By how much the two ways differ, of each line."""
    pressure = pressure_per_force(basis, probe, room, [source], hz)[0][0]
    velocity = velocity_per_source(basis, room, source, probe, hz)[0]
    return float((np.abs(velocity + pressure) / np.abs(pressure)).max())


LOSSES = {
    "t60": losses_from_t60(0.5),
    "beta": losses_from_beta(0.01, 40.0),
    "bands": losses_from_t60_bands({63.0: 0.9, 125.0: 0.8, 500.0: 0.5}),
    "source": losses_from_beta(0.01, 40.0, "source"),
}


@pytest.mark.parametrize(("kind", "walls"), [("t60", False), *((kind, True) for kind in LOSSES)])
def test_velocity_per_source_is_minus_pressure_per_force(kind: str, walls: bool, corner) -> None:
    """Motion to pressure by sums of cosines of the moving walls, source to motion by waves from the source on walls
    that are held; in vacuo, with air that reacts, and with a leak. 1e-9 as the issue asks; 1e-11 is found."""
    basis, surfaces, points = corner
    room = placed(Room(SIZE, AIR, LOSSES[kind]), surfaces["under"], walls={"x0": surfaces["face"]} if walls else {})
    for coupled in (basis, with_cavity(basis, room, up_to_hz=270.0)):
        assert off(coupled, room, CORNER, points["drop"].probe("z")) < 1e-9
        assert off(coupled, room, CORNER, points["face middle"].probe("x")) < 1e-9
    assert np.abs(coupled.viscous - np.diag(np.diag(coupled.viscous))).max() > 0  # losses couple the modes
    leaking = with_cavity(basis, room, leak=Leak(20.0, 2000.0), up_to_hz=270.0)
    assert off(leaking, room, CORNER, points["drop"].probe("z")) < 1e-9


def test_reciprocity_of_rooms_whose_walls_absorb_and_yield_and_of_the_open_air(corner) -> None:
    """By finite elements, with complex modes of the air; and by Rayleigh's integral."""
    basis, surfaces, points = corner
    size, probe = np.array([4.0, 3.0, 2.5]), points["drop"].probe("z")
    walls = {"y1": absorbing(0.3), "z0": absorbing(0.2), "x1": YieldingWall(20.0, 5e5, 300.0)}
    field = ShapedRoom(box_mesh(size, [3, 2, 2]), "z1", AIR, losses_from_t60(0.5), walls=walls, up_to_hz=60.0)
    room = placed(field, surfaces["under"], walls={"x0": surfaces["face"]})
    for coupled in (basis, with_cavity(basis, room, up_to_hz=60.0)):
        assert off(coupled, room, CORNER, probe, HZ[:4]) < 1e-9  # as the issue asks; rounding, 1e-14
    yard = placed(HalfSpace(AIR), surfaces["over"])
    assert off(basis, yard, Receiver("speaker", [1.0, 0.5, 1.5]), probe) < 1e-9


def test_a_source_on_every_coordinate_of_the_air(corner) -> None:
    """Structure and modes of the air in one system, the source a volume that enters every mode of the air: no pressure
    on held walls, no closed form. Its modes end, so that it comes nearer with more of them."""
    basis, surfaces, points = corner
    field = Room(SIZE, AIR, LOSSES["t60"])
    room = placed(field, surfaces["under"], walls={"x0": surfaces["face"]})
    probe, w = points["drop"].probe("z").of(basis.shapes), 2 * np.pi * HZ
    wrong = []
    for up_to in (270.0, 540.0):
        air = field.coupled_air(room.shapes(basis), up_to)
        count, k = len(air.frequency_hz), len(basis.omega)
        indices = room_modes(field, up_to)[1][:count]
        cosines = np.sqrt(2.0 ** (indices > 0).sum(axis=1)) * np.cos(np.pi * indices * CORNER.position / SIZE).prod(1)
        upside = 1.0 - 2.0 * (indices[:, 2] % 2)  # modes are positive at the ceiling
        entering = np.sqrt(AIR.bulk_modulus / field.volume) * np.append(1.0, upside * cosines)
        own = np.zeros((k + count, k + count))
        stiffness, mass = air.compression.T @ air.compression, air.mass + np.diag([1.0] * k + [0.0] * count)
        stiffness[:k, :k] += np.diag(basis.omega**2)
        own[:k, :k] = basis.viscous
        whole = stiffness + 1j * w[:, None, None] * (own + air.viscous) - w[:, None, None] ** 2 * mass
        q = np.linalg.solve(whole, -(air.compression.T @ entering)[None, :, None] / (1j * w[:, None, None]))[:, :k, 0]
        coupled = with_cavity(basis, room, up_to_hz=up_to)
        found = velocity_per_source(coupled, room, CORNER, points["drop"].probe("z"), HZ)[0]
        wrong.append(np.abs(1j * w * (q @ probe) - found).max() / np.abs(found).max())
    assert wrong[0] < 3e-2 and wrong[1] < 5e-3, (
        wrong
    )  # of the modes left out: nothing weighs what they do to the source


def test_a_piston_in_a_tube() -> None:
    """A piston that is the whole ceiling knows only plane waves: source, spring, mass and air in closed form."""
    size, z, mass, spring = np.array([0.5, 0.4, 3.0]), 0.7, 3.0, 9e3
    gamma, area = LOSSES["t60"].decay_rate, 0.2
    basis, points = oscillator(mass, stiffness=spring, axis="z")
    x, y = ((np.arange(12) + 0.5) / 12 * side for side in size[:2])
    flat = np.array([[a - 0.25, b - 0.2, 0.0] for a in x for b in y])
    corners = [[-0.25, -0.2, 0], [0.25, -0.2, 0], [0.25, 0.2, 0], [-0.25, 0.2, 0]]
    rows = csr_array(np.tile([0, 0, -1.0, 0, 0, 0, 0], (144, 1)))
    under = Surface(
        "under", flat, np.full(144, area / 144), np.tile([0, 0, -1.0], (144, 1)), [[1, 0, 0], [0, 1, 0]], corners, rows
    )
    room = placed(Room(size, AIR, LOSSES["t60"]), under)
    hz = np.array([5.0, 11.0, 30.0, 57.2, 90.0])
    s = 2j * np.pi * hz
    k = np.sqrt(-(s**2 + 2 * gamma * s)) / AIR.c
    driving = -AIR.rho * (s + 2 * gamma) / (k * np.sin(3.0 * k))
    held, reacting = driving * np.cos(k * z) / area, driving * np.cos(3.0 * k)
    down = -area * held / (s * mass + spring / s + area * reacting)
    speaker, probe, wrong = Receiver("speaker", [0.1, 0.3, z]), points["m"].probe("z"), []
    for up_to in (600.0, 1200.0):
        coupled = with_cavity(basis, room, up_to_hz=up_to)
        wrong.append(np.abs(velocity_per_source(coupled, room, speaker, probe, hz)[0] / -down - 1).max())
    # modes of the air that are left out weigh, but do not swing: what is wrong falls with the third power of where
    assert wrong[1] < 6e-6 and wrong[1] < wrong[0] / 7, wrong


def test_digits_of_a_wall_at_the_side() -> None:
    """One-way, a mode of the wall x = 0: reference/real_floors.json, side-wall-and-reciprocity, p/F and v/Q."""
    size, hz = np.array([4.2, 3.4, 2.6]), np.array([10.0, 20, 30, 40.9, 63, 80, 100])
    stack = [
        0.0015770877 - 0.00014003226j,
        0.0031637263 - 0.0005330801j,
        -0.010846191 - 0.059820455j,
        -0.00059815188 + 0.015965646j,
        0.00014587607 + 8.9418039e-05j,
        -0.00094590488 + 0.0017940759j,
        0.0008182037 - 0.00095680706j,
    ]
    modal = [
        -0.0015770883 + 0.00014003257j,
        -0.0031637302 + 0.00053308134j,
        0.010846205 + 0.059820556j,
        0.00059816281 - 0.015965647j,
        -0.00014586955 - 8.9418398e-05j,
        0.00094591074 - 0.0017940762j,
        -0.00081819817 + 0.00095680685j,
    ]
    ended = np.array([4.4e-7, 1.3e-6, 1.7e-6, 6.9e-7, 3.9e-5, 2.9e-6, 4.4e-6])  # of 400 modes, as the study states
    node, share = np.polynomial.legendre.leggauss(40)
    (y, dy), (z, dz) = (((node + 1) / 2 * side, share / 2 * side) for side in size[1:])
    shape = np.outer(np.sin(np.pi * y / 3.4), np.sin(np.pi * z / 2.6)).ravel()
    at = np.array([[0.0, b, c] for b in y for c in z])
    moving = SurfaceShapes(at, np.outer(dy, dz).ravel(), shape[:, None])
    room = Room(size, Air(343.26, 1.204), Losses("constant_decay", decay_rate=13.82))
    loads = wall_loads(room, moving, np.array([2.9, 1.2, 1.5]), hz)[0][0]
    omega, force_at = 2 * np.pi * hz, np.sin(np.pi * 1.1 / 3.4) * np.sin(np.pi * 0.9 / 2.6)
    stiff = 100.0 * 3.4 * 2.6 / 4 * ((60 * np.pi) ** 2 * (1 + 0.05j) - omega**2)
    found = -loads * 1j * omega * force_at / stiff
    assert found == pytest.approx(-np.array(stack), rel=1e-7)  # eight digits were written down
    assert (np.abs(found / np.array(modal) - 1) < ended + 1e-7).all()


STUDY = """
model: corner.yaml
modes: {up_to: 160 Hz}
frf:
  heard: {drive: drop.z, response: hall.speaker.1.pressure, kind: pressure, band: [20 Hz, 110 Hz], step: 10 Hz}
  moved: {drive: hall.speaker.1.volume_velocity, response: drop.z, kind: mobility, band: [20 Hz, 110 Hz], step: 10 Hz}
  tilted: {drive: hall.speaker.2.volume_velocity, response: drop.rx, kind: mobility, band: [20 Hz, 110 Hz], step: 10 Hz}
rooms:
  hall:
    size: [4, 3, 4]
    surfaces: {ceiling: under, x0: face}
    coupling: two-way
    losses: {t60: 0.5 s}
    receivers: {speaker: [[3.5, 0.6, 0.4], [1.0, 2.0, 1.5]]}
"""


def written(folder: Path, old: str = "", new: str = "") -> Path:
    (folder / "corner.yaml").write_text(MODEL + "damping: {ratio: 2 %}\n", encoding="utf-8")
    assert old in STUDY
    (folder / "corner.study.yaml").write_text(STUDY.replace(old, new, 1) if old else STUDY, encoding="utf-8")
    return folder / "corner.study.yaml"


def test_a_study_asks_for_what_a_loudspeaker_moves(tmp_path: Path) -> None:
    plan = read_study(written(tmp_path))
    result = run_study(plan)
    found = result.cases["as given"].frf
    assert (found["moved"].unit, found["tilted"].unit) == ("1/m^2", "rad/m^3")
    assert found["moved"].values == pytest.approx(-found["heard"].values, rel=1e-9)  # as the issue asks
    assert np.abs(found["tilted"].values).min() > 0
    write_results(tmp_path / "results.h5", result)
    again = read_results(tmp_path / "results.h5").cases["as given"].frf["moved"]
    assert str(again.request.drive) == "hall.speaker.1.volume_velocity" and again.unit == "1/m^2"
    assert all(not case.study.frf for case in without_rooms(plan).cases)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("hall.speaker.1.volume_velocity", "hall.speeker.1.volume_velocity",
         r":6:18: frf\.moved\.drive: got 'hall\.speeker\.1\.volume_velocity', expected ROOM\.RECEIVER\.volume_"
         r"velocity; did you mean 'hall\.speaker\.1\.volume_velocity'\?"),
        ("hall.speaker.1.volume_velocity", "drop.volume_velocity",
         r":6:18: frf\.moved\.drive: got 'drop\.volume_velocity', expected ROOM\.RECEIVER\.volume_velocity"),
        ("response: drop.z, kind: mobility", "response: drop.z, kind: accelerance",
         r"frf\.moved\.kind: got 'accelerance' of a volume velocity, expected mobility; write 'kind: mobility'"),
        ("response: drop.z, kind: mobility", "response: hall.speaker.2.pressure, kind: mobility",
         r"frf\.moved\.response: got 'hall\.speaker\.2\.pressure', expected POINT\."),
        ("kind: mobility, band: [20 Hz", "kind: mobility, band: [0 Hz",
         r"frf\.moved\.band: got 0 Hz, expected a band above 0 Hz"),
        ("response: drop.z, kind: mobility", "response: hall.speaker.1.volume_velocity, kind: mobility",
         r"frf\.moved\.response: got 'hall\.speaker\.1\.volume_velocity', expected POINT\."),
    ],
)  # fmt: skip
def test_sources_are_refused_where_they_are_written(tmp_path: Path, old: str, new: str, message: str) -> None:
    with pytest.raises(InputErrors, match=message) as caught:
        run_study(read_study(written(tmp_path, old, new)))
    assert len(str(caught.value).splitlines()) == 1


def test_what_no_source_can_do_is_refused(corner) -> None:
    basis, surfaces, points = corner
    room = placed(Room(SIZE, AIR, LOSSES["t60"]), surfaces["under"])
    probe = points["drop"].probe("z")
    with pytest.raises(AcousticsError, match=r"receiver far: got \[9.*expected a point of the room"):
        velocity_per_source(basis, room, Receiver("far", [9.0, 1.0, 1.0]), probe, HZ)
    still, where = oscillator(1.0, stiffness=1.0, axis="z")
    with pytest.raises(FemstructError, match="response: got a direction without motion"):
        velocity_per_source(still, room, CORNER, where["m"].probe("x"), HZ)
