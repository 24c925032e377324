"""What every kind of sound field must have, run on all registered ones: sums over surfaces, refusals by name, one
answer in time, in frequency and in pictures."""

from __future__ import annotations

import ast
import json
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import femstruct
from acoustics.air import Air
from acoustics.errors import AcousticsError
from acoustics.fields.half_space import HalfSpace
from acoustics.fields.known_fields import KINDS
from acoustics.fields.rectangular import Room
from acoustics.fields.shaped import ShapedRoom
from acoustics.fields.sound_field import SoundField, air_stiffness_ratio
from acoustics.losses import losses_from_t60
from acoustics.meshed.cavity_mesh import box_mesh
from acoustics.receivers import Receiver
from acoustics.source import SurfaceShapes, SurfaceVelocity, SurfaceVibration, combine_surfaces, side_by_side
from femstruct.files.stored_values import Stored, restore_value, store_value

SIZE = (1.2, 0.9, 0.7)
AIR = Air(340.0, 1.2)
DT = 1 / 8000
T = DT * np.arange(1600)
PULSE = np.where(T < 0.02, np.sin(np.pi * T / 0.02) ** 3, 0.0)
ROUNDING = 1e-9  # of numbers of the size of 1
HZ = np.array([20.0, 55.0, 130.0])


class Example(NamedTuple):
    """A field of a kind, two surfaces on its walls with normals into it, and who listens."""

    field: SoundField
    walls: tuple[str, str]
    surfaces: tuple[SurfaceShapes, SurfaceShapes]
    normals: tuple[list[float], list[float]]
    receivers: list[Receiver]


def patch(corner: list[float], along: list[list[float]], bend: float) -> SurfaceShapes:
    """12 x 10 midpoints of a parallelogram, moved as a whole and, in a second shape, as half a sine."""
    x, y = (((np.arange(n) + 0.5) / n) for n in (12, 10))
    at = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    area = float(np.linalg.norm(np.cross(*np.array(along))))
    shapes = np.column_stack([np.ones(120), bend * np.sin(np.pi * at[:, 0]) * np.sin(np.pi * at[:, 1])])
    return SurfaceShapes(np.array(corner) + at @ np.array(along), np.full(120, area / 120), shapes)


def hears(*places: list[float]) -> list[Receiver]:
    return [Receiver(f"mic {i}", place) for i, place in enumerate(places)]


LX, LY, LZ = SIZE
LEFT = patch([0, 0, LZ], [[LX / 2, 0, 0], [0, LY, 0]], 1.0)
RIGHT = patch([LX / 2, 0, LZ], [[LX / 2, 0, 0], [0, LY, 0]], -2.0)
WALL = patch([0, 0, 0], [[0, LY, 0], [0, 0, LZ]], 0.5)
NEAR, FAR = (
    patch([-0.5, -0.4, 0], [[1, 0, 0], [0, 0.8, 0]], 1.0),
    patch([1, 0, 0], [[0.6, 0.6, 0], [-0.3, 0.3, 0]], 1.0),
)
MICS = hears([0.3, 0.2, 0.25], [0.9, 0.7, 0.1])
LOSSES = losses_from_t60(0.05)
EXAMPLES = [
    Example(Room(SIZE, AIR, LOSSES), ("ceiling", "ceiling"), (LEFT, RIGHT), ([0, 0, -1], [0, 0, -1]), MICS),
    Example(Room(SIZE, AIR, LOSSES), ("ceiling", "x0"), (LEFT, WALL), ([0, 0, -1], [1, 0, 0]), MICS),
    Example(
        ShapedRoom(box_mesh(SIZE, [6, 5, 4]), "z1", AIR, LOSSES, up_to_hz=450.0),
        ("z1", "x0"),
        (LEFT, WALL),
        ([0, 0, -1], [1, 0, 0]),
        MICS,
    ),
    Example(
        HalfSpace(AIR), ("plane", "plane"), (NEAR, FAR), ([0, 0, 1], [0, 0, 1]), hears([0.2, 0.3, 0.8], [-1, 1, 1.5])
    ),
]
every_field = pytest.mark.parametrize("example", EXAMPLES, ids=lambda one: type(one.field).__name__)


def moving(surface: SurfaceShapes, *rates: np.ndarray) -> SurfaceVelocity:
    return SurfaceVelocity(surface.points, surface.weights, surface.shapes, np.array(rates), DT)


def vibrating(surface: SurfaceShapes, *rates: complex) -> SurfaceVibration:
    each = np.outer(rates, np.ones(len(HZ)))
    return SurfaceVibration(surface.points, surface.weights, surface.shapes, each, HZ)


def both(example: Example) -> list[SurfaceVelocity]:
    one, other = example.surfaces
    return [moving(one, PULSE, np.roll(PULSE, 40)), moving(other, -0.5 * np.roll(PULSE, 80), PULSE)]


def test_all_kinds_are_here() -> None:
    assert {type(one.field) for one in EXAMPLES} == set(KINDS)
    assert len({kind.word for kind in KINDS}) == len(KINDS)


@every_field
def test_pressures_are_those_of_the_sum_over_surfaces(example: Example) -> None:
    """In time, of surfaces with rates of their own; a box ends its search for cosines where they add less than 1e-4."""
    field, surfaces = example.field, both(example)
    whole, doubled = field.pressures([surfaces, [moving(one, *(2 * one.rates)) for one in surfaces]], example.receivers)
    parts = [field.pressures([[one]], example.receivers)[0].p for one in surfaces]
    largest = np.abs(whole.p).max()
    assert all(np.abs(part).max() > 0.05 * largest for part in parts)
    assert np.abs(whole.p - sum(parts)).max() < 1e-3 * largest
    assert np.abs(doubled.p - 2 * whole.p).max() < 1e-12 * largest  # rounding
    assert whole.p.shape == (len(example.receivers), len(T)) and not whole.p.flags.writeable


@every_field
def test_harmonic_pressures_are_those_of_the_sum_over_surfaces(example: Example) -> None:
    field, (one, other) = example.field, example.surfaces
    first, second = vibrating(one, 1.0, 0.3j), vibrating(other, 0.5j, -0.2)
    whole, _ = field.harmonic([first, second], example.receivers)
    parts = [field.harmonic([each], example.receivers)[0] for each in (first, second)]
    # a box adds cosines until the last ones make 1e-5 of the pressure
    assert np.abs(whole - sum(parts)).max() < 1e-4 * np.abs(whole).max()
    turned, _ = field.harmonic([vibrating(one, 1j, -0.3), vibrating(other, -0.5, -0.2j)], example.receivers)
    assert np.abs(turned - 1j * whole).max() < 1e-12 * np.abs(whole).max()  # rounding


@every_field
def test_a_source_does_to_held_surfaces_what_they_do_to_its_place(example: Example) -> None:
    """Reciprocity: its pressure on a shape is the pressure of that shape, moved with unit speed, where it stands."""
    one, other = example.surfaces
    for source in example.receivers:
        loads, _ = example.field.loads(example.surfaces, source, HZ)
        for row, rates in enumerate(((1.0, 0.0), (0.0, 1.0))):
            heard = example.field.harmonic([vibrating(one, *rates), vibrating(other, *rates)], [source])[0][0]
            # a box adds cosines until the last ones make 1e-5 of the pressure
            assert np.abs(loads[row] - heard).max() < 1e-4 * np.abs(heard).max()
    with pytest.raises(AcousticsError):
        example.field.loads(example.surfaces, Receiver("far", [0.1, 0.1, -3.0]), HZ)


@every_field
def test_surfaces_of_one_structure_share_their_rates(example: Example) -> None:
    """Shapes one below the other in the same coordinates, or each surface with coordinates of its own: one motion."""
    one, other = (moving(surface, PULSE, np.roll(PULSE, 40)) for surface in example.surfaces)
    shared, apart = (
        combine_surfaces([one, other]),
        combine_surfaces([one, moving(other, *(1.0 * other.rates[::-1])[::-1])]),
    )
    assert shared.rates.shape == (2, len(T))
    own = combine_surfaces([one, SurfaceVelocity(other.points, other.weights, 0.5 * other.shapes, 2 * other.rates, DT)])
    assert own.rates.shape == (4, len(T))
    for each in (apart, own):
        assert np.abs(each.shapes @ each.rates - shared.shapes @ shared.rates).max() < ROUNDING
    heard = [example.field.pressures([[each]], example.receivers)[0].p for each in (shared, own)]
    assert np.abs(heard[1] - heard[0]).max() < 1e-4 * np.abs(heard[0]).max()  # answers at rest to 2 shapes, or 4


@every_field
def test_what_does_not_move_is_silent(example: Example) -> None:
    still = [moving(one, 0 * PULSE, 0 * PULSE) for one in example.surfaces]
    assert not example.field.pressures([still], example.receivers)[0].p.any()
    assert not example.field.harmonic([vibrating(one, 0, 0) for one in example.surfaces], example.receivers)[0].any()


@every_field
def test_the_spectrum_is_that_of_the_record(example: Example) -> None:
    """T60 50 ms: after 150 ms nothing is left of two pulses that cancel in volume."""
    balanced = [moving(one, PULSE - np.roll(PULSE, 200), 0 * PULSE) for one in example.surfaces]  # no volume is left
    (heard,) = example.field.pressures([balanced], example.receivers)
    points = np.stack([one.position for one in example.receivers])
    kernel = DT * np.exp(-2j * np.pi * np.outer(T, HZ))
    wanted = example.field.spectrum(balanced, HZ, points)
    # 2e-3: what has not decayed, cosines that are left out, and the sampling
    assert np.abs(heard.p @ kernel - wanted).max() < 2e-3 * np.abs(wanted).max()


@every_field
def test_it_says_what_it_is(example: Example) -> None:
    field = example.field
    assert field.volume > 0 and field.complete_up_to_hz > 0 and field.word.split()[0] in ("a", "an")
    assert all(isinstance(value, (str, float, list, dict)) for value in field.described().values())
    assert np.linalg.norm(field.facing) == pytest.approx(1.0)
    axes = field.axes(np.eye(3)[:2], field.facing)
    assert axes @ axes.T == pytest.approx(np.eye(3))
    assert (field.open_air is None) == np.isfinite(field.volume)
    assert air_stiffness_ratio(field, 1.0, 1.0) == pytest.approx(AIR.rho * AIR.c**2 / field.volume)


@every_field
def test_surfaces_that_it_cannot_take_are_refused_by_name(example: Example) -> None:
    field = example.field
    for wall, surface, normal in zip(example.walls, example.surfaces, example.normals, strict=True):
        assert wall in field.movable
        directions = np.tile(normal, (len(surface.points), 1))
        field.accept(wall, surface.points, directions)
        with pytest.raises(AcousticsError, match=r"surface\.points: got .* m"):
            field.accept(wall, surface.points + 0.05 * directions, directions)
        with pytest.raises(AcousticsError, match=f"surface.normals: got a surface on '{wall}' that faces out"):
            field.accept(wall, surface.points, -directions)
        with pytest.raises(AcousticsError, match="'x9'"):
            field.on_wall("x9")
        with pytest.raises(AcousticsError, match="'x9'"):
            field.accept("x9", surface.points, directions)


@every_field
def test_who_listens_elsewhere_is_refused(example: Example) -> None:
    field, first = example.field, moving(example.surfaces[0], PULSE, PULSE)
    wanted = np.stack([one.position for one in example.receivers])
    np.testing.assert_array_equal(field.places(example.receivers), wanted)
    for far, message in (([Receiver("far", [50, 50, -50])], "got"), ([], "receivers: got none")):
        with pytest.raises(AcousticsError, match=message):
            field.places(far)
        with pytest.raises(AcousticsError, match=message):
            field.pressures([[first]], far)


@every_field
def test_air_that_pushes_back_is_a_mechanical_system(example: Example) -> None:
    """Its stiffness at rest is that of uniform compression by all surfaces; or it is refused by the kind's name."""
    field = example.field
    if not field.pushes_back:
        with pytest.raises(AcousticsError, match=f"coupling: got two-way with {field.word}, expected one-way"):
            field.coupled_air(example.surfaces, 200.0)
        return
    air = field.coupled_air(example.surfaces, 200.0)
    displaced = sum(one.weights @ one.shapes for one in example.surfaces)
    uniform = np.sqrt(AIR.rho * AIR.c**2 / field.volume) * displaced
    assert air.compression[0, :2] == pytest.approx(uniform, rel=ROUNDING)
    assert np.linalg.eigvalsh(air.mass).min() > 0 and air.mass == pytest.approx(air.mass.T, abs=ROUNDING)
    assert air.mass.shape == (2 + len(air.frequency_hz),) * 2 and len(air.frequency_hz) > 0
    assert not field.coupling_advice(30.0)  # walls that take nothing up
    assert field.identity


@every_field
def test_modes_beside_surfaces_are_those_that_are_drawn(example: Example) -> None:
    field, surfaces = example.field, example.surfaces
    found = field.modes_on(surfaces, 330.0)
    whole = side_by_side(surfaces)
    hz, drawn = field.mode_shapes(whole.points, len(found.frequency_hz))
    assert hz == pytest.approx(found.frequency_hz)
    unit = np.sqrt(field.volume / found.squares) if len(hz) else np.ones(0)
    exact = whole.shapes.T @ (whole.weights[:, None] * drawn)
    assert np.abs(found.products) * unit == pytest.approx(np.abs(exact), abs=ROUNDING)
    # the box has the squares' sums from cosines of twice the order, the others from the shapes: rounding
    assert found.sizes * unit == pytest.approx(np.sqrt(whole.weights @ drawn**2), rel=1e-6)


@every_field
def test_pictures_show_what_is_heard(example: Example) -> None:
    field, surfaces = example.field, both(example)
    if not field.bounded:
        assert not len(field.outline)
        with pytest.raises(AcousticsError, match=field.word):
            field.grid()
        with pytest.raises(AcousticsError, match=field.word):
            field.pressure_map(surfaces, [55.0], at=0.1)
        return
    low, high = (end(field.outline.reshape(-1, 3), axis=0) for end in (np.min, np.max))
    assert high - low == pytest.approx(SIZE) and (field.middle <= high + ROUNDING).all()
    grid = field.grid()
    assert (
        (grid.points >= low - ROUNDING).all()
        and (grid.points <= high + ROUNDING).all()
        and grid.cells.max() < len(grid.points)
    )
    drawn = field.pressure_map(surfaces, [55.0, 130.0], at=0.2, divisions=(6, 4))
    x, y = np.meshgrid(drawn.first, drawn.second, indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 0.2)])
    wanted = field.spectrum(surfaces, drawn.frequency_hz, points)
    # a map of a box has 24 cosines in each direction, which is 1 % where it reaches a wall that moves
    missed = np.abs(drawn.spectrum.reshape(2, -1) - wanted.T)
    assert missed[:, x.ravel() > 0.1].max() < 1e-3 * np.abs(wanted).max()
    assert missed.max() < 2e-2 * np.abs(wanted).max()


@every_field
def test_it_is_read_back_from_results_as_it_was(example: Example) -> None:
    kept: list[np.ndarray] = []
    tables = store_value(example.field, lambda array: kept.append(array) or len(kept) - 1)
    again = restore_value(Stored(*json.loads(json.dumps(tables))), kept.__getitem__)
    assert type(again) is type(example.field) and again.described() == example.field.described()
    moved = [both(example)]
    one, other = (field.pressures(moved, example.receivers)[0].p for field in (example.field, again))
    assert np.abs(one - other).max() < ROUNDING * np.abs(one).max()


def test_nobody_else_asks_which_kind_it_is() -> None:
    """`femstruct` asks the protocol: no module tests for the class of a field, or matches on it."""
    names = {base.__name__ for kind in KINDS for base in kind.__mro__} - {"object", "ABC"}
    assert {"Room", "ShapedRoom", "HalfSpace", "SoundField", "Box", "Baffle"} <= names
    for path in Path(femstruct.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            asked: list[ast.AST] = []
            if (
                isinstance(node, ast.Call)
                and isinstance(node.func, ast.Name)
                and node.func.id in ("isinstance", "type")
            ):
                asked = [*node.args]
            if isinstance(node, ast.MatchClass):
                asked = [node.cls]
            used = {one.id for each in asked for one in ast.walk(each) if isinstance(one, ast.Name)}
            assert not used & names, f"{path}: {used & names}"
