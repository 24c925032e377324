"""Rectangular rooms that any walls move: two opposite walls in closed form, one wall against digits of a study, walls
against the formulas of a turned room, powers by surface, and air that pushes back on walls that meet at edges."""

from __future__ import annotations

import numpy as np
import pytest

from acoustics.air import Air
from acoustics.errors import AcousticsError
from acoustics.fields.half_space import HalfSpace
from acoustics.fields.rectangular import Room
from acoustics.fields.shaped import ShapedRoom
from acoustics.fields.sound_field import SoundField
from acoustics.losses import Losses
from acoustics.meshed.cavity_mesh import box_mesh
from acoustics.receivers import Receiver
from acoustics.rooms.box_walls import WALLS, Turn
from acoustics.source import SurfaceShapes, SurfaceVelocity, SurfaceVibration, combine_surfaces

AIR = Air(343.26, 1.204)
GAMMA = 13.82
DECAY = Losses("constant_decay", decay_rate=GAMMA)
# Computed apart from this project, in closed form and as a modal sum: f [Hz], pressure [Pa s/m] at x = 0.7 m between
# two walls 5 m apart that move into the room: one of them, both, both with opposite signs.
OPPOSITE = [
    (5.0, 35.18282 - 864.56668j, 7.8085038 - 1797.5077j, 62.557137 + 68.374312j),
    (20.0, 73.381549 - 6.4889964j, 9.703402 - 412.45956j, 137.0597 + 399.48157j),
    (34.3, 1867.6664 - 308.63342j, 15.771138 - 177.08553j, 3719.5616 - 440.18131j),
    (50.0, 45.811606 - 290.95447j, 44.68079 + 37.199771j, 46.942422 - 619.10872j),
    (80.0, 42.993806 - 471.51368j, 75.513718 - 711.67716j, 10.473895 - 231.3502j),
    (125.0, -15.377763 - 416.21272j, -29.454674 - 428.61938j, -1.3008525 - 403.80607j),
]
# The same of a room 4.2 x 3.4 x 2.6 m whose wall x = 0, 100 kg/m^2, moves in its first mode at 30 Hz with a loss factor
# of 5 % under a force at y 1.1, z 0.9 m: pressure per force [Pa/N] at (2.9, 1.2, 1.5) m.
SIDE = [
    (10.0, 0.0015770877 - 0.00014003226j),
    (20.0, 0.0031637263 - 0.0005330801j),
    (30.0, -0.010846191 - 0.059820455j),
    (40.9, -0.00059815188 + 0.015965646j),
    (63.0, 0.00014587607 + 8.9418039e-05j),
    (80.0, -0.00094590488 + 0.0017940759j),
    (100.0, 0.0008182037 - 0.00095680706j),
]
DIGITS = 1e-7  # eight digits were written down
SIZE = np.array([1.2, 0.9, 0.7])


def gauss(a: float, b: float, cells: tuple[int, int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points of a rectangle [n], [n] and weights, three by three in each cell."""
    node, share = np.polynomial.legendre.leggauss(3)
    x, y = (
        ((np.arange(n)[:, None] + (node + 1) / 2) / n).ravel() * side for side, n in zip((a, b), cells, strict=True)
    )
    each = np.outer(np.tile(share, cells[0]) * a / cells[0], np.tile(share, cells[1]) * b / cells[1]).ravel() / 4
    x, y = (one.ravel() for one in np.meshgrid(x, y, indexing="ij"))
    return x, y, each


def on_wall(wall: str, size: np.ndarray, *waves: tuple[int, int]) -> SurfaceShapes:
    """A whole wall that moves in halves of sines along its two sides."""
    turn = Turn(wall)
    first, second = sorted(turn.axes[:2])
    a, b = float(size[first]), float(size[second])
    x, y, weights = gauss(a, b, (round(10 * a), round(10 * b)))
    points = np.full((len(x), 3), size[turn.axis] if turn.at_end else 0.0)
    points[:, first], points[:, second] = x, y
    shapes = [np.sin(m * np.pi * x / a) * np.sin(n * np.pi * y / b) for m, n in waves]
    return SurfaceShapes(points, weights, np.column_stack(shapes))


def vibrating(surface: SurfaceShapes, hz: np.ndarray, rates: np.ndarray) -> SurfaceVibration:
    return SurfaceVibration(surface.points, surface.weights, surface.shapes, rates, hz)


def four_walls(hz: np.ndarray) -> list[SurfaceVibration]:
    """Ceiling, floor and two side walls, each at random in shapes of its own."""
    rng = np.random.default_rng(3)
    walls = [("ceiling", (1, 1), (2, 1)), ("x0", (1, 1), (1, 2)), ("y1", (2, 1)), ("floor", (1, 2))]
    moving = [on_wall(wall, SIZE, *waves) for wall, *waves in walls]
    rates = [rng.standard_normal((2, one.shapes.shape[1], len(hz))) for one in moving]
    return [vibrating(one, hz, real + 1j * imag) for one, (real, imag) in zip(moving, rates, strict=True)]


@pytest.mark.parametrize("column", [1, 2, 3], ids=["one", "in phase", "opposite"])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_two_opposite_walls(axis: int, column: int) -> None:
    """With s + 2 gamma as the source; with s alone 5 Hz is off by 66 %."""
    size = np.array([1.3, 1.3, 1.3])
    size[axis] = 5.0
    room, hz = Room(size, AIR, DECAY), np.array([line[0] for line in OPPOSITE])
    names = [("x0", "x1"), ("y0", "y1"), ("floor", "ceiling")][axis]
    moved = []
    for wall, speed in zip(names, {1: (1.0, 0.0), 2: (1.0, 1.0), 3: (1.0, -1.0)}[column], strict=True):
        moved.append(SurfaceVibration([room.middle_of(wall)], [1.69], [[1.0]], np.full((1, 6), speed), hz))
    place = np.full(3, 0.4)
    place[axis] = 0.7
    found = room.harmonic(moved, [Receiver("mic", place)])[0][0]
    assert found == pytest.approx(np.array([line[column] for line in OPPOSITE]), rel=DIGITS)


def test_a_side_wall() -> None:
    size, hz = np.array([4.2, 3.4, 2.6]), np.array([line[0] for line in SIDE])
    shape = np.sin(np.pi * 1.1 / 3.4) * np.sin(np.pi * 0.9 / 2.6)
    omega = 2 * np.pi * hz
    speed = 1j * omega * shape / (100.0 * 3.4 * 2.6 / 4 * ((60 * np.pi) ** 2 * (1 + 0.05j) - omega**2))
    moved = vibrating(on_wall("x0", size, (1, 1)), hz, speed[None])
    found = Room(size, AIR, DECAY).harmonic([moved], [Receiver("mic", [2.9, 1.2, 1.5])])[0][0]
    assert found == pytest.approx(np.array([line[1] for line in SIDE]), rel=1e-6)  # cosines end at 1e-5 of the rest


@pytest.fixture(scope="module")
def meshed() -> ShapedRoom:
    return ShapedRoom(box_mesh(SIZE, [6, 5, 4]), "z1", AIR, DECAY, up_to_hz=500.0)


@pytest.mark.parametrize("wall", WALLS)
def test_every_wall_as_finite_elements_have_it(wall: str, meshed: ShapedRoom) -> None:
    """In frequency, in time, and in a picture of the room, against a mesh of the same room."""
    hz = np.array([60.0, 110.0, 160.0])
    surface = on_wall(wall, SIZE, (1, 1), (2, 1))
    room = Room(SIZE, AIR, DECAY)
    mics = [Receiver("a", [0.4, 0.3, 0.2]), Receiver("b", [1.0, 0.75, 0.55])]
    moved = vibrating(surface, hz, np.array([[1.0, 1.0, 1.0], [0.5j, -0.5, 1.0]]))
    one, other = (field.harmonic([moved], mics)[0] for field in (room, meshed))
    assert np.abs(one - other).max() < 3e-3 * np.abs(one).max()  # ten cells to a wave, modes above 500 Hz at rest
    t = np.arange(1200) / 6000
    push = np.array([np.sin(np.pi * t / 0.01) ** 3 * (t < 0.01), -0.4 * np.sin(np.pi * t / 0.02) ** 3 * (t < 0.02)])
    rates = SurfaceVelocity(surface.points, surface.weights, surface.shapes, push, 1 / 6000)
    one, other = (field.pressures([[rates]], mics)[0].p for field in (room, meshed))
    assert np.abs(one - other).max() < 3e-3 * np.abs(one).max()
    drawn = room.pressure_map([rates], [90.0], normal="y", at=0.3, divisions=(5, 4))
    x, z = np.meshgrid(drawn.first, drawn.second, indexing="ij")
    points = np.column_stack([x.ravel(), np.full(x.size, 0.3), z.ravel()])
    wanted = room.spectrum([rates], drawn.frequency_hz, points)[:, 0]
    assert np.abs(drawn.spectrum[0].ravel() - wanted).max() < 5e-3 * np.abs(wanted).max()  # 24 cosines, up to the wall


def test_the_kept_transfer_of_walls_hears_further_motions_as_the_room_does() -> None:
    room, mics, t = Room(SIZE, AIR, DECAY), [Receiver("a", [0.4, 0.3, 0.2])], np.arange(1200) / 6000
    push = np.sin(np.pi * t / 0.02) ** 3 * (t < 0.02)
    surfaces = [on_wall(wall, SIZE, (1, 1)) for wall in ("ceiling", "y0")]
    first, second = (
        [
            SurfaceVelocity(one.points, one.weights, one.shapes, [rate], 1 / 6000)
            for one, rate in zip(surfaces, both, strict=True)
        ]
        for both in ((push, np.roll(push, 60)), (np.roll(push, 90), -push))
    )
    (found,), kept = room.pressures_to_keep([first], mics, 400.0)
    assert kept is not None
    assert kept.of(combine_surfaces(second), room, mics, 400.0) and not kept.of(second[0], room, mics, 400.0)
    assert not kept.of(combine_surfaces(second), Room(2 * SIZE, AIR, DECAY), mics, 400.0)
    kept.prepare()
    again = kept.pressures([combine_surfaces(first), combine_surfaces(second)])
    assert again is not None
    anew = room.pressures([second], mics, 400.0)[0]
    assert np.abs(again[0].p - found.p).max() < 1e-4 * np.abs(found.p).max()  # what was inaudible of 400 Hz and above
    assert np.abs(again[1].p - anew.p).max() < 1e-4 * np.abs(anew.p).max()  # the searches end by 1e-4


def test_powers_by_surface_are_those_of_the_pressure_on_them() -> None:
    """Modes of the room against its closed form at the points of the surfaces; they sum to what is given to the air."""
    hz = np.array([30.0, 100.0, 142.0, 190.0, 240.0, 300.0])
    room, surfaces = Room(SIZE, AIR, Losses("constant_decay", decay_rate=20.0)), four_walls(hz)
    found, direct = room.powers(surfaces), SoundField.powers(room, surfaces)
    assert found.shape == (4, 6) and (found.sum(axis=0) > 0).all() and (found < 0).any()
    # modes above three times the frequency at rest; cosines on a wall itself end slowly
    assert np.abs(found - direct).max(axis=0) == pytest.approx(np.zeros(6), abs=2e-3 * np.abs(found).max())


def test_powers_sum_to_what_the_room_takes_up() -> None:
    """Against the losses of the same air as a mechanical system: v . C v of all coordinates, structure and modes."""
    hz = np.array([30.0, 142.0, 240.0])
    room, surfaces = Room(SIZE, AIR, Losses("constant_decay", decay_rate=20.0)), four_walls(hz)
    columns = np.cumsum([0, *(one.shapes.shape[1] for one in surfaces)])
    shapes = []
    for one, a, b in zip(surfaces, columns[:-1], columns[1:], strict=True):
        own = np.zeros((len(one.weights), columns[-1]))
        own[:, a:b] = one.shapes
        shapes.append(SurfaceShapes(one.points, one.weights, own))
    air = room.coupled_air(shapes, 3 * 240.0)
    k, rates = columns[-1], np.concatenate([one.rates for one in surfaces])
    taken = []
    for line, omega in enumerate(2 * np.pi * hz):
        dynamic = air.compression.T @ air.compression + 1j * omega * air.viscous - omega**2 * air.mass
        q = rates[:, line] / (1j * omega)
        whole = np.concatenate([q, -np.linalg.solve(dynamic[k:, k:], dynamic[k:, :k] @ q)])
        taken.append(0.5 * omega**2 * float((whole.conj() @ air.viscous @ whole).real))
    assert room.powers(surfaces).sum(axis=0) == pytest.approx(np.array(taken), rel=1e-9)  # rounding


def test_the_air_pushes_back_between_walls_as_the_pressure_on_them() -> None:
    """The mechanical system of the air against its closed form, over all pairs of four walls."""
    hz = np.array([25.0, 70.0])
    room, surfaces = Room(SIZE, AIR, DECAY), four_walls(hz)
    points = np.concatenate([one.points for one in surfaces])
    mics = [Receiver(str(number), place) for number, place in enumerate(points)]
    ends = np.cumsum([0, *(len(one.points) for one in surfaces)])
    columns = np.cumsum([0, *(one.shapes.shape[1] for one in surfaces)])
    shapes = []
    for one, a, b in zip(surfaces, columns[:-1], columns[1:], strict=True):
        own = np.zeros((len(one.weights), columns[-1]))
        own[:, a:b] = one.shapes
        shapes.append(SurfaceShapes(one.points, one.weights, own))
    air = room.coupled_air(shapes, 1500.0)
    assert np.linalg.eigvalsh(air.mass).min() > 0
    k = columns[-1]
    for number, one in enumerate(surfaces):
        alone = vibrating(one, hz, np.ones_like(one.rates))
        p = room.harmonic([alone], mics)[0]
        for line, omega in enumerate(2 * np.pi * hz):
            dynamic = air.compression.T @ air.compression + 1j * omega * air.viscous - omega**2 * air.mass
            pushed = dynamic[:k, :k] - dynamic[:k, k:] @ np.linalg.solve(dynamic[k:, k:], dynamic[k:, :k])
            force = pushed[:, columns[number] : columns[number + 1]].sum(axis=1) / (1j * omega)
            parts = zip(surfaces, ends[:-1], ends[1:], strict=True)
            wanted = np.concatenate([(two.shapes.T * two.weights) @ p[a:b, line] for two, a, b in parts])
            # modes between 1500 Hz and the end at rest, cosines on the wall itself
            assert np.abs(force - wanted).max() < 2e-4 * np.abs(wanted).max()


def test_walls_carried_along_rigidly_compress_nothing() -> None:
    """All four walls of a room in translation displace no volume; at 0.1 Hz one alone makes rho c^2 / V of it."""
    room, hz = Room(SIZE, AIR, DECAY), np.array([0.1])
    areas = {"x0": 0.63, "x1": 0.63}
    both = [
        SurfaceVibration([room.middle_of(wall)], [area], [[1.0]], [[sign]], hz)
        for (wall, area), sign in zip(areas.items(), (1.0, -1.0), strict=True)
    ]
    alone, moved = (room.harmonic(some, [Receiver("mic", [0.6, 0.4, 0.3])])[0][0, 0] for some in (both[:1], both))
    uniform = AIR.rho * AIR.c**2 * 0.63 / room.volume / (2j * np.pi * 0.1)
    assert alone == pytest.approx(uniform, rel=1e-3)  # the mass of the air and its losses
    assert abs(moved) < 1e-3 * abs(alone)


def test_half_spaces_refuse_powers_by_surface_and_points_on_no_wall_are_refused() -> None:
    hz = np.array([50.0])
    adrift = SurfaceVibration([[0.6, 0.4, 0.3]], [0.1], [[1.0]], [[1.0]], hz)
    with pytest.raises(AcousticsError, match="got powers by surface in a half space, expected a closed room"):
        HalfSpace().powers([adrift])
    with pytest.raises(AcousticsError, match=r"surface.points: got a point 0\.3 m off the walls"):
        Room(SIZE).harmonic([adrift], [Receiver("mic", [0.1, 0.1, 0.1])])
