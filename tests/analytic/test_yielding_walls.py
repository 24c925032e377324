"""Walls that yield, against a wave between a ceiling that moves and an end of impedance r + s m + k / s.

With g^2 = kx^2 + s (s + 2 gamma) / (c^2 (1 + s tau)) the pressure under a ceiling that moves as cos(kx x) is
rho (s + 2 gamma) / g (cosh g z + b sinh g z) / (sinh g L + b cosh g L), b = rho (s + 2 gamma) / (g Z), over its
velocity: no cavity modes, no coordinates of a wall.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.sparse import csr_array

from acoustics.air import Air
from acoustics.errors import AcousticsError
from acoustics.fields.shaped import ShapedRoom
from acoustics.losses import Losses, losses_from_beta, losses_from_t60
from acoustics.meshed.cavity_mesh import box_mesh
from acoustics.meshed.meshed_pressure import cavity_pressure
from acoustics.meshed.walls import Wall, YieldingWall
from acoustics.receivers import Receiver
from acoustics.rooms.box_coupling import Leak
from acoustics.source import SurfaceVelocity, SurfaceVibration
from femstruct.impact.scene import Clock, HalfSine, Load, Scene
from femstruct.impact.simulate import simulate
from femstruct.modal.closed_form import oscillator
from femstruct.modal.damping import Damping, Ratio, with_damping
from femstruct.modal.frf import frf
from femstruct.model.probe import Surface
from femstruct.sound.coupling import with_cavity
from femstruct.sound.placed import placed
from femstruct.sound.surfaces import pressure_per_force, surface_velocity

AIR = Air(343.0, 1.21)
LAWS = {
    "none": Losses(),
    "decay": losses_from_t60(0.3),
    "kelvin-voigt": losses_from_beta(0.01, 170.0),
    "both": Losses("decay_and_relaxation", relaxation_time=1e-5, decay_rate=20.0),
}
TUBE = (0.1, 0.1, 1.0)
PANEL = YieldingWall(mass=2.0, stiffness=2.0 * (2 * np.pi * 250.0) ** 2, resistance=50.0)  # amid the modes of the tube


def impedance(wall, s):
    return wall.resistance + s * wall.mass + wall.stiffness / s


def column(s, losses, end, z, length, air=AIR, across=0.0):
    """Pressure over the velocity of the ceiling; `end`: impedance at z = 0 [nf]; across: kx [1/m]."""
    inertia = air.rho * (s + 2 * losses.decay_rate)
    g = np.sqrt(across**2 + s * (s + 2 * losses.decay_rate) / (1 + s * losses.relaxation_time) / air.c**2)
    b = inertia / (g * end)
    return inertia / g * (np.cosh(g * z) + b * np.sinh(g * z)) / (np.sinh(g * length) + b * np.cosh(g * length))


SPRING = YieldingWall(stiffness=AIR.rho * AIR.c * 2 * np.pi * 150.0)  # as stiff as the air resists at 150 Hz
SOFT = replace(SPRING, resistance=0.5 * AIR.rho * AIR.c)


meshed = cache(box_mesh)  # of many rooms that differ in their walls


def tube(walls, losses, up_to_hz=800.0, cells=40):
    return ShapedRoom(meshed(TUBE, (1, 1, cells)), "z1", AIR, losses, walls, up_to_hz)


def piston_tone(room, f, heights):
    """Pressure over the velocity of a piston that is the whole ceiling of the tube."""
    receivers = [Receiver(f"{z:g}", [0.05, 0.05, z]) for z in heights]
    top, area = np.array([[0.05, 0.05, TUBE[2]]]), np.array([TUBE[0] * TUBE[1]])
    tone = np.ones((1, len(f)), dtype=np.complex128)
    return room.harmonic([SurfaceVibration(top, area, np.ones((1, 1)), tone, f)], receivers)[0]


@pytest.mark.parametrize("law", LAWS)
def test_a_tube_closed_by_a_wall_that_yields(law):
    """5 to 400 Hz, past the wall's own 250 Hz: 2e-4 of the largest, 0.05 dB where not within 40 dB of a node."""
    f, heights = np.linspace(5.0, 400.0, 300), (0.0, 0.3, 0.9)
    s = 2j * np.pi * f
    found = piston_tone(tube({"z0": PANEL}, LAWS[law]), f, heights)
    for z, p in zip(heights, found, strict=True):
        exact = column(s, LAWS[law], impedance(PANEL, s), z, TUBE[2])
        largest = np.abs(exact).max()
        assert np.abs(p - exact).max() < 2e-4 * largest
        loud = np.abs(exact) > 0.01 * largest
        assert np.abs(20 * np.log10(np.abs(p / exact)))[loud].max() < 0.05
    rigid = column(s, LAWS[law], 1e15, 0.0, TUBE[2])
    assert np.abs(found[0] - rigid).max() > 0.5 * np.abs(found[0]).max()  # the wall matters


@pytest.mark.parametrize("law", ["decay", "kelvin-voigt", "both"])
@pytest.mark.parametrize("end", [SPRING, SOFT], ids=["spring", "spring and dashpot"])
def test_a_tube_closed_by_a_wall_without_mass(end, law):
    """With modes of the tube to four times the band, of which 1e-4 or 0.01 dB are left: 3e-5 and 0.01 dB measured."""
    f, heights = np.linspace(5.0, 400.0, 300), (0.0, 0.3, 0.9)
    s = 2j * np.pi * f
    found = piston_tone(tube({"z0": end}, LAWS[law], 1600.0), f, heights)
    for z, p in zip(heights, found, strict=True):
        exact = column(s, LAWS[law], impedance(end, s), z, TUBE[2])
        largest = np.abs(exact).max()
        assert np.abs(p - exact).max() < 1e-4 * largest
        loud = np.abs(exact) > 0.01 * largest
        assert np.abs(20 * np.log10(np.abs(p / exact)))[loud].max() < 0.01


def test_resonances_of_a_tube_closed_by_a_spring():
    """Where the pressure of the closed form has its poles, the tube's has: s / k joins the air, and nothing is lost."""
    room = tube({"z0": SPRING}, LAWS["none"], 1600.0)

    def inverse(f):
        return 1 / piston_tone(room, np.array([f]), (0.0,))[0, 0].imag

    def exact(f):
        s = np.array(2j * np.pi * f)
        return 1 / column(s, LAWS["none"], impedance(SPRING, s), 0.0, TUBE[2]).imag

    for low, high in ((100.0, 150.0), (250.0, 300.0)):
        # cells of second order: 2e-7 here
        assert brentq(inverse, low, high) == pytest.approx(brentq(exact, low, high), rel=1e-5)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("end", [PANEL, SPRING, SOFT], ids=["panel", "spring", "spring and dashpot"])
def test_a_tube_in_time(end, law):
    """A push of 10 ms that leaves a displacement, on a shifted axis as the transform of the room itself has."""
    fs, nt = 24e3, 4800
    t = np.arange(nt) / fs
    push = np.where(t < 0.01, 1 - np.cos(2 * np.pi * t / 0.01), 0.0)
    moving = SurfaceVelocity([[0.05, 0.05, 1.0]], [0.01], [[1]], [push], dt=1 / fs)
    room = tube({"z0": end}, LAWS[law])
    receivers = [Receiver(f"{z:g}", [0.05, 0.05, z]) for z in (0.0, 0.7)]
    heard_ = cavity_pressure(moving, room.modes, AIR, LAWS[law], receivers, room.walls).p
    a, padded = 7 / t[-1], 4 * nt
    s = a + 2j * np.pi * np.fft.rfftfreq(padded, 1 / fs)
    driven = np.fft.rfft(push * np.exp(-a * t), padded)
    for z, p in zip((0.0, 0.7), heard_, strict=True):
        answer = column(s, LAWS[law], impedance(end, s), z, TUBE[2])
        exact = np.fft.irfft(driven * answer, padded)[:nt] * np.exp(a * t)
        # 0.3 %: modes beyond 800 Hz follow as at rest; a quarter of it with all up to 1600 Hz
        assert np.abs(p - exact)[: int(0.95 * nt)].max() < 3e-3 * np.abs(exact).max()


def test_pressure_that_varies_along_the_wall():
    """A ceiling that moves as cos(pi x / Lx), which every bit of the floor answers by itself."""
    size, f = (0.6, 0.4, 0.5), np.linspace(20.0, 450.0, 150)
    wall = YieldingWall(5.0, 5.0 * (2 * np.pi * 150.0) ** 2, 200.0)
    room = ShapedRoom(box_mesh(size, (12, 3, 12)), "z1", AIR, LAWS["decay"], {"z0": wall}, 1000.0)
    gauss = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3)
    x, y = (np.concatenate([(i + gauss) / n * side for i in range(n)]) for n, side in ((24, size[0]), (6, size[1])))
    points = np.array([[one, other, size[2]] for one in x for other in y])
    weights = np.full(len(points), size[0] * size[1] / len(points))
    shape = np.cos(np.pi * points[:, :1] / size[0])
    places = [[0.1, 0.1, 0.0], [0.2, 0.3, 0.4]]
    receivers = [Receiver(str(i), place) for i, place in enumerate(places)]
    tone = np.ones((1, len(f)), dtype=np.complex128)
    found, _ = room.harmonic([SurfaceVibration(points, weights, shape, tone, f)], receivers)
    s = 2j * np.pi * f
    for place, p in zip(places, found, strict=True):
        exact = np.cos(np.pi * place[0] / size[0]) * column(
            s, LAWS["decay"], impedance(wall, s), place[2], size[2], across=np.pi / size[0]
        )
        assert np.abs(p - exact).max() < 6e-4 * np.abs(exact).max()  # 4e-4; 2e-3 with 8 cells: h^4


def test_a_stiff_light_wall_is_rigid_and_a_light_dashpot_is_an_impedance():
    f = np.linspace(5.0, 400.0, 100)
    rigid = piston_tone(tube({}, LAWS["both"]), f, (0.0, 0.7))
    off = []
    for stiffness in (1e9, 1e10, 1e12):
        stiff = piston_tone(tube({"z0": YieldingWall(1e-3, stiffness)}, LAWS["both"]), f, (0.0, 0.7))
        off.append(np.abs(stiff - rigid).max() / np.abs(rigid).max())
    assert off[0] / off[1] == pytest.approx(10, rel=0.05)  # as its compliance
    assert off[2] < 2e-4  # modes beyond 800 Hz, which the rigid tube lacks
    beta, soft = 0.2, Wall({100.0: 0.3})
    resistance = AIR.rho * AIR.c / beta
    plain = piston_tone(tube({"z0": Wall({100.0: beta}), "x0": soft}, LAWS["both"]), f, (0.0, 0.7))
    light = piston_tone(tube({"z0": YieldingWall(1e-3, 0.0, resistance), "x0": soft}, LAWS["both"]), f, (0.0, 0.7))
    assert np.abs(light - plain).max() < 1e-3 * np.abs(plain).max()  # omega m / r = 1.2e-3 at 400 Hz


@pytest.mark.parametrize("law", ["none", "both"])
def test_walls_without_mass_from_no_wall_at_all_to_a_rigid_one(law):
    f = np.linspace(5.0, 400.0, 50)
    s = 2j * np.pi * f
    for stiffness in (1e-3, 1e6, 1e15):
        for resistance in (0.0, 1e-3, 1e7):
            end = YieldingWall(0.0, stiffness, resistance)
            (found,) = piston_tone(tube({"z0": end}, LAWS[law]), f, (0.7,))
            exact = column(s, LAWS[law], impedance(end, s), 0.7, TUBE[2])
            assert np.abs(found - exact).max() < 1e-3 * np.abs(exact).max()  # modes beyond 800 Hz


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("end", [SPRING, SOFT], ids=["spring", "spring and dashpot"])
def test_a_wall_without_mass_is_the_limit_of_a_light_one(end, law):
    """Beside a wall with mass and one that takes up sound: the mass that remains has omega^2 m / k = 3e-5 at 80 Hz."""
    f = np.linspace(5.0, 80.0, 40)
    others = {"x0": Wall({100.0: 0.05}), "y0": YieldingWall(8.0, 8.0 * (2 * np.pi * 60.0) ** 2, 100.0)}
    heavy, none = (piston_tone(tube({"z0": z0, **others}, LAWS[law]), f, (0.0, 0.7)) for z0 in (_light(end), end))
    assert np.abs(heavy - none).max() < 1e-4 * np.abs(none).max()  # 4e-5 measured


def _light(wall):
    return replace(wall, mass=3e-5 * wall.stiffness / (2 * np.pi * 80.0) ** 2)


@pytest.mark.parametrize(("beta", "within"), [(1e-3, 1e-2), (0.3, 5e-3)])  # each mode by itself; complex modes
@pytest.mark.parametrize("law", LAWS)
def test_losses_of_the_air_and_a_resistance_together(law, beta, within):
    """The end of resistance alone, from 0.05 Hz: pressure that it lets go does not stay."""
    f = np.concatenate([np.linspace(0.05, 20.0, 100), np.linspace(20.0, 60.0, 40)])
    s = 2j * np.pi * f
    found = piston_tone(tube({"z0": Wall({100.0: beta})}, LAWS[law]), f, (0.0, 0.7))
    for z, p in zip((0.0, 0.7), found, strict=True):
        exact = column(s, LAWS[law], AIR.rho * AIR.c / beta, z, TUBE[2])
        assert np.abs(p / exact - 1).max() < within


# A piston on a spring over a box, as in test_coupling, whose floor yields.
LX, LY, L, MASS, STIFFNESS, RATIO = 0.58, 0.47, 0.1, 29.68, 4.641e5, 0.03
AREA = LX * LY
BOX_AIR = Air(340.0, 1.29)
FLOOR = YieldingWall(40.0, 40.0 * (2 * np.pi * 60.0) ** 2, 800.0)
SHEET = YieldingWall(stiffness=5e6)  # three times as stiff as the air
FELT = replace(SHEET, resistance=1e3)  # whose loss factor is 1 at 800 Hz
PLACE = oscillator(MASS, stiffness=STIFFNESS, axis="z")[1]["m"].probe("z")


def box(wall, losses=LAWS["none"]):
    return ShapedRoom(meshed((LX, LY, L), (3, 3, 3)), "z1", BOX_AIR, losses, {"z0": wall}, 1750.0)


def underside(cells=3):
    """The rigid underside of the piston, Gauss points of the box's own cells: they integrate its modes exactly."""
    gauss, parts = np.polynomial.legendre.leggauss(3)
    nodes = (np.add.outer(2 * np.arange(cells) + 1, gauss).ravel() / cells) - 1
    weights = np.tile(parts, cells) / cells
    x, y = (part.ravel() for part in np.meshgrid(0.5 * LX * nodes, 0.5 * LY * nodes, indexing="ij"))
    area = np.outer(0.5 * LX * weights, 0.5 * LY * weights).ravel()
    rows = csr_array(np.tile([[0, 0, -1.0, 0, 0, 0, 0]], (len(x), 1)))
    points = np.column_stack([x, y, 0 * x])
    corners = np.array([[-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]]) * [LX / 2, LY / 2, 0]
    return Surface("under", points, area, np.tile([0, 0, -1], (len(x), 1)), [[1, 0, 0], [0, -1, 0]], corners, rows)


def piston(ratio=0.0):
    return with_damping(oscillator(MASS, stiffness=STIFFNESS, axis="z")[0], Damping(Ratio(ratio)))


def pressed(s, wall, losses, z=L):
    """Pressure over the displacement of the piston into the room."""
    return s * column(s, losses, impedance(wall, s), z, L, BOX_AIR)


def dynamic(s, wall, losses, ratio, leak=None):
    air = pressed(s, wall, losses)
    if leak is not None:
        air = air / (1 + air / AREA / (leak.inertance * s**2 + leak.resistance * s))
    return STIFFNESS + 2 * s * ratio * np.sqrt(STIFFNESS * MASS) + s**2 * MASS + AREA * air


@pytest.mark.parametrize("leak", [None, Leak(20.0, 2000.0)])
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("wall", [FLOOR, replace(FLOOR, resistance=0.0), SHEET, FELT])
def test_the_air_and_a_wall_that_yields_push_back(law, wall, leak):
    """Motion of the piston and pressure below it: 1e-4 and 3e-4, as modes of the box beyond 1750 Hz are a mass."""
    losses = LAWS[law]
    room = box(wall, losses)
    basis = with_cavity(piston(RATIO), placed(room, underside(), name="box"), leak=leak)
    f = np.concatenate([np.linspace(5.0, 100.0, 200), np.linspace(100.0, 400.0, 30)])
    s = 2j * np.pi * f
    exact = 1 / dynamic(s, wall, losses, RATIO, leak)
    assert np.abs(frf(basis, PLACE, PLACE, f) - exact).max() < 1e-4 * np.abs(exact).max()
    (told,) = [finding.message for finding in basis.findings if finding.code == "two-way-coupling"]
    assert "mode shapes of its compliant walls" in told
    if leak is None:
        receivers = [Receiver(f"{z:g}", [0.2, 0.1, z]) for z in (0.0, 0.06)]
        found, _ = pressure_per_force(basis, PLACE, placed(room, underside()), receivers, f)
        for z, p in zip((0.0, 0.06), found, strict=True):
            wanted = -pressed(s, wall, losses, z) * exact
            assert np.abs(p - wanted).max() < 3e-4 * np.abs(wanted).max()


def test_resonances_of_piston_air_and_wall():
    """Roots of the exact equation: the piston's and the one in which the wall moves against it."""
    wall = replace(FLOOR, resistance=0.0)

    def exact(f):
        return dynamic(np.array(2j * np.pi * f), wall, LAWS["none"], 0.0).real

    basis = with_cavity(piston(), placed(box(wall), underside()))
    for low, high in ((20.0, 40.0), (67.9, 68.2)):  # a pole, the wall against the still piston, is at 67.4
        root = brentq(exact, low, high, xtol=1e-12)
        assert np.abs(basis.frequency_hz / root - 1).min() < 5e-6  # modes of the room left out: 5e-8 here
    assert basis.residual_norm.max() < 1e-11  # rounding: 1e-13 here
    assert basis.n_rigid == 0


@pytest.mark.parametrize("wall", [YieldingWall(10.0, 1e6), YieldingWall(0.0, 1e6), YieldingWall(0.0, 1e6, 50.0)])
def test_compliances_of_air_and_wall_add(wall):
    """At rest the box is a spring of 1 / (V / (rho c^2) + S / s'') [Pa/m^3]; one-way it is heard so."""
    room = box(wall)
    stiffness = 1 / (room.volume / BOX_AIR.bulk_modulus + AREA / wall.stiffness)
    assert stiffness < 0.5 * BOX_AIR.bulk_modulus / room.volume
    basis = with_cavity(piston(), placed(room, underside()))
    at_rest = frf(basis, PLACE, PLACE, [0.0])[0]
    assert 1 / at_rest.real == pytest.approx(STIFFNESS + AREA**2 * stiffness, rel=1e-13)  # rounding: 7e-16 here
    still = np.array([0.05])  # (omega / omega of the wall)^2 is 1e-6
    p, _ = pressure_per_force(piston(), PLACE, placed(room, underside()), [Receiver("a", [0.1, 0.1, 0.05])], still)
    # (omega / omega of the wall)^2, and 0.05 Hz of the piston: 6e-6 here
    assert p[0, 0].real == pytest.approx(-AREA * stiffness / STIFFNESS, rel=1e-5)


def test_a_piston_on_air_and_a_sheet_has_three_springs():
    """Air and sheet are springs in series beside the piston's own; the air between them moves linearly along z."""
    slow = replace(BOX_AIR, c=34e3)  # air without a resonance below 29 kHz, as stiff as it was
    air = replace(slow, rho=BOX_AIR.rho * (BOX_AIR.c / slow.c) ** 2)
    room = replace(box(SHEET), air=air, up_to_hz=1000.0)
    wall, gas = SHEET.stiffness * AREA, air.bulk_modulus * AREA / L
    share = gas / (gas + wall)  # of the piston's displacement that the sheet makes
    moving = air.rho * AREA * L * (1 + share + share**2) / 3
    exact = np.sqrt((STIFFNESS + share * wall) / (MASS + moving)) / (2 * np.pi)
    # rounding: 2e-15 here
    assert with_cavity(piston(), placed(room, underside())).frequency_hz[0] == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize(("law", "wall"), [("kelvin-voigt", FLOOR), ("decay", FLOOR), ("decay", FELT)])
def test_what_room_and_wall_take_is_what_the_structure_loses(law, wall):
    """The work of the room's pressure on the ceiling, by the one-way formula, closes the structure's own energy."""
    fs, losses = 48e3, LAWS[law]
    room = box(wall, losses)
    basis = with_cavity(piston(), placed(room, underside()))
    push = Load("push", PLACE, HalfSine(-100.0, 50.0))
    response = simulate(basis, Scene(loads=(push,)), Clock(0.2, fs))
    assert response.ledger.residual < 1e-11  # rounding: 5e-14 here
    (moving,) = surface_velocity(response, placed(room, underside()))
    (found,) = room.pressures([[moving]], [Receiver("on the ceiling", place) for place in moving.points])
    row = -PLACE.of(basis.shapes)
    x, v = row @ response.q, row @ response.qd
    own = 0.5 * MASS * v**2 + 0.5 * STIFFNESS * x**2
    power = moving.weights @ found.p * v
    slope = np.gradient(power, 1 / fs)
    steps = 0.5 * (power[1:] + power[:-1]) / fs - (slope[1:] - slope[:-1]) / 12 / fs**2  # Euler and Maclaurin
    given = np.concatenate([[0.0], np.cumsum(steps)])
    work = response.ledger.work[-1]
    after = slice(int(0.02 * fs), int(0.19 * fs))  # the push is over
    assert np.abs(own + given - work)[after].max() < 2e-6 * work  # the rule's next term: 7e-8 here
    without = simulate(
        with_cavity(piston(), placed(box(replace(wall, resistance=0.0), losses), underside())),
        Scene(loads=(push,)),
        Clock(0.2, fs),
    )
    assert response.ledger.dissipated[-1] > 2 * without.ledger.dissipated[-1]  # the wall takes it


def test_what_is_no_wall_that_yields_is_refused():
    with pytest.raises(AcousticsError, match=r"wall\.mass"):
        YieldingWall(-1.0, 1e6)
    with pytest.raises(AcousticsError, match=r"wall: got neither mass nor stiffness.*as an impedance"):
        YieldingWall(0.0, 0.0, 400.0)
    with pytest.raises(AcousticsError, match=r"wall\.stiffness: got -1 N/m\^3"):
        YieldingWall(1.0, -1.0)
    with pytest.raises(AcousticsError, match=r"wall\.resistance"):
        YieldingWall(1.0, 1.0, float("nan"))
    with pytest.raises(AcousticsError, match=r"walls\.z1: got a compliant wall that is the ceiling"):
        tube({"z1": PANEL}, LAWS["none"])
    with pytest.raises(AcousticsError, match=r"walls\.z0: got a compliant wall without stiffness"):
        with_cavity(piston(), placed(box(YieldingWall(10.0)), underside()))
