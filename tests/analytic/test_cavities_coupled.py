"""A structure with the air of its cavities as a modal basis: who holds its energy, rigid motions, bays, passivity."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csr_array

import femstruct as fs
from acoustics.air import Air
from acoustics.fields.rectangular import Room
from acoustics.rooms.cavities import Cavity, Wool, cavity_air
from acoustics.source import SurfaceShapes
from femstruct.modal.closed_form import given_modes
from femstruct.model.probe import Probe, Surface
from femstruct.sound.cavity_coupling import AIR, WOOL, PlacedCavity
from femstruct.sound.coupling import with_cavity
from tests.data.cavities_by_hand import exact, matrices, poles

ROUNDING = 1e-9  # of coordinates up to 30 kHz beside rigid ones
MASSES = 345.0, 20.0
UPPER, LOWER = Probe([0], [2], [1.0]), Probe([1], [2], [1.0])
SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1]]


def two_pistons(cavity: Cavity, hz: tuple[float, float] = (0.0, 0.0)) -> tuple[fs.ModalBasis, PlacedCavity, fs.Placed]:
    """Two pistons of 1 m^2, one over the other, on springs or free; the basis, the cavity, a room of 4 m under both."""
    shape = np.zeros((2, 7, 2))
    shape[0, 2, 0], shape[1, 2, 1] = MASSES[0] ** -0.5, MASSES[1] ** -0.5
    bare, _ = given_modes([1.0, 2.0], [0.0, 0.0], {"P": [0.0, 0.0]})
    basis = replace(
        bare,
        omega=2 * np.pi * np.array(hz),
        kind=tuple("elastic" if one else "rigid" for one in hz),
        shapes=shape,
        points=np.array([[0.5, 0.5, 0.2], [0.5, 0.5, 0.0]]),
        viscous=np.zeros((2, 2)),
        momentum=np.zeros((3, 2)),
        outputs={},
        part_stiffness={},
    )

    def surface(name: str, node: int, z: float, up: float) -> Surface:
        row = np.zeros((1, 14))
        row[0, 7 * node + 2] = up
        outline = [[*corner, z] for corner in SQUARE]
        return Surface(name, [[0.5, 0.5, z]], [1.0], [[0, 0, up]], [[1, 0, 0], [0, 1, 0]], outline, csr_array(row))

    wool = cavity.wool
    fill = None if wool is None else fs.Fill(wool.flow_resistivity, wool.density, cavity.thickness, wool.frame)
    between = fs.AirBetween("void", "under", "top", 0.2, cavity.air.c, cavity.air.rho, fill)
    surfaces = {"under": surface("under", 0, 0.2, -1.0), "top": surface("top", 1, 0.0, 1.0)}
    (placed,), findings = fs.placed_cavities(between, surfaces)
    assert not findings
    below = fs.placed(Room([1, 1, 4], Air(343.0, 1.21)), surface("face", 1, 0.0, -1.0))
    return basis, placed, below


@pytest.mark.parametrize("wool", [None, Wool(1e4, 40.0, "held"), Wool(1e4, 40.0, "limp")], ids=["air", "held", "limp"])
@pytest.mark.parametrize("thickness", [None, 0.1])
def test_a_basis_with_a_cavity_moves_as_the_exact_pistons(wool: Wool | None, thickness: float | None) -> None:
    if wool is None and thickness is not None:
        return
    cavity = Cavity([1, 1, 0.2], Air((1.4 * 101325 / 1.204) ** 0.5, 1.204), wool, thickness)
    basis, placed, _ = two_pistons(cavity)
    coupled = fs.with_cavities(basis, [placed], up_to_hz=3500.0)
    assert coupled.n_rigid == 1  # both together
    layers: list[tuple[float, Wool | None]] = [(0.2, wool)] if thickness is None else [(0.1, None), (0.1, wool)]
    for hz in (10.0, 25.0, 50.0, 125.0):
        expected = exact(layers, hz)
        found = [complex(fs.frf(coupled, UPPER, one, [hz], "mobility")[0]) for one in (UPPER, LOWER)]
        for ours, theirs in zip(found, expected, strict=True):
            # modes kept: 1e-4; coordinates left out: ALLOWED
            assert abs(ours / theirs - 1) < 2e-3


@pytest.mark.parametrize("wool", [None, Wool(1e4, 40.0)], ids=["air", "limp"])
def test_holders_have_all_the_energy(wool: Wool | None) -> None:
    cavity = Cavity([1, 1, 0.2], wool=wool, thickness=None if wool is None else 0.15)
    basis, placed, _ = two_pistons(cavity)
    coupled = fs.with_cavities(basis, [placed], up_to_hz=3000.0)
    assert set(coupled.holders) == {"structure", AIR} | ({WOOL} if wool else set())
    inertia = sum(one.inertia for one in coupled.holders.values())
    stiffness = sum(one.stiffness for one in coupled.holders.values())
    np.testing.assert_allclose(inertia, np.eye(len(coupled.omega)), atol=ROUNDING)
    scale = np.outer(coupled.omega + 1.0, coupled.omega + 1.0)
    np.testing.assert_allclose(stiffness / scale, np.diag(coupled.omega**2) / scale, atol=ROUNDING)


def test_a_room_under_a_ceiling_with_wool_over_it() -> None:
    """Wool in the cavity stays what it is when the room below is coupled, too: one after the other or the other way."""
    cavity = Cavity([1, 1, 0.2], wool=Wool(1e4, 40.0))
    basis, placed, below = two_pistons(cavity)
    before = fs.with_cavities(basis, [placed], up_to_hz=3000.0)
    one = with_cavity(before, below, up_to_hz=200.0)
    other = fs.with_cavities(with_cavity(basis, below, up_to_hz=200.0), [placed], up_to_hz=3000.0)
    # the mean of both pistons presses on the air of the room now: no rigid motion is left
    assert one.n_rigid == other.n_rigid == 0
    assert "wool of the cavities" in one.holders and f"air of {below.name}" in one.holders
    for hz in (8.0, 20.0, 45.0, 90.0):
        answers = [complex(fs.frf(each, UPPER, LOWER, [hz])[0]) for each in (one, other)]
        assert abs(answers[0] / answers[1] - 1) < 3e-3  # coordinates left out, twice
    assert one.modes.stop <= len(one.omega) - sum(~before.shapes.any(axis=(0, 1)))


FILLS = [
    None,
    (Wool(1e4, 40.0, "limp"), 1.0),
    (Wool(1e4, 40.0, "held"), 1.0),
    (Wool(1e4, 40.0, "limp"), 0.5),
    (Wool(3e4, 100.0, "held"), 0.3),
]


@pytest.mark.parametrize("seed", range(20))
def test_nothing_grows_in_any_cavity(seed: int) -> None:
    """200 random cavities, ten for every seed: every fill, all of the depth or a part of it."""
    rng = np.random.default_rng(seed)
    for number in range(10):
        size = [*rng.uniform(0.3, 5.0, 2), rng.uniform(0.02, 0.5)]
        fill = FILLS[number % len(FILLS)]
        wool, share = (None, 0.0) if fill is None else fill
        if wool is not None:
            wool = replace(wool, flow_resistivity=10 ** rng.uniform(3, 5), density=rng.uniform(10, 150))
        cavity = Cavity(size, Air(), wool, None if wool is None else share * size[2])
        points = np.column_stack([rng.uniform(0, 1, (40, 2)) * size[:2], np.zeros(40)])
        area = np.full(40, size[0] * size[1] / 40)
        moves = rng.standard_normal((2, 40, 4)) * 10 ** rng.uniform(-2, 0)
        first, second = (SurfaceShapes(points, area, one) for one in moves)
        air = cavity_air(cavity, first, second, 0.6 * cavity.air.c / min(size[:2]))
        M, C, K = matrices(air, 10 ** rng.uniform(0, 6, 4))
        for matrix in (M, C, K):
            np.testing.assert_allclose(matrix, matrix.T, atol=1e-12 * np.abs(matrix).max())  # rounding
        assert np.linalg.eigvalsh(M).min() > 0
        found = poles(M, C, K)
        # rounding of a double root at 0, and of values of 1e7 1/s
        assert found.real.max() <= 1e-6 * np.median(np.abs(found)) + 1e-9 * np.abs(found).max()


def test_two_bays_are_two_cavities() -> None:
    """A plate over a plate: bays given by their joists react as two cavities that are given one by one."""
    steel = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
    plates = [
        fs.Plate(name, steel, 0.001, origin=(0.0, 0.0, z), size=(1.2, 0.6), mesh=(12, 6))
        for name, z in (("floor", 0.1), ("ceiling", 0.0))
    ]
    halves = [
        fs.SurfaceOn(f"{name} {i}", name, side, fs.Region("rectangle", size=(0.6, 0.6), at=(0.3 + 0.6 * i, 0.3)))
        for name, side in (("floor", "below"), ("ceiling", "above"))
        for i in (0, 1)
    ]
    whole = [fs.SurfaceOn("under", "floor", "below"), fs.SurfaceOn("top", "ceiling", "above")]
    held = tuple(fs.Support(f"e {one.name}", "simple", on=one.name, edge="all") for one in plates)
    model = fs.mesh_structure(fs.Structure("s", tuple(plates), surfaces=(*whole, *halves), supports=held))
    basis = fs.modal_basis(fs.assemble(model), up_to=120.0)
    wool = fs.Fill(1e4, 40.0)
    bays = fs.AirBetween("void", "under", "top", 0.1, fill=wool, bays=fs.Bays("x", (0.6,)))
    one, _ = fs.placed_cavities(bays, model.surfaces)
    each = [fs.AirBetween(f"v{i}", f"floor {i}", f"ceiling {i}", 0.1, fill=wool) for i in (0, 1)]
    several = [placed for item in each for placed in fs.placed_cavities(item, model.surfaces)[0]]
    assert [placed.name for placed in one] == ["void 1", "void 2"]
    found = [fs.with_cavities(basis, placed) for placed in (one, several)]
    np.testing.assert_allclose(found[0].frequency_hz, found[1].frequency_hz, rtol=1e-6, atol=1e-4)  # rounding
    # air that cannot pass the joist is stiffer than air that can; in the first mode both plates move alike, and no air
    open_void = fs.placed_cavities(replace(bays, bays=None), model.surfaces)[0]
    pressed = fs.with_cavities(basis, open_void)
    assert pressed.frequency_hz[1] < 0.95 * found[0].frequency_hz[1]  # 12.05 below 13.61 Hz
    wide = replace(bays, bays=fs.Bays("x", (0.6,), width=0.1))
    assert [float(p.cavity.size[0]) for p in fs.placed_cavities(wide, model.surfaces)[0]] == pytest.approx([0.55, 0.55])
