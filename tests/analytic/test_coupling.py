"""Structure and air in one basis: a piston on a box in closed form, sealed and leaking; a plate on a cavity.

The piston's equation is exact: (k - m w^2 + j w c + S K kappa cot(kappa L)) x = f, K the bulk modulus and kappa the
wave number of the lossy air. The plate's reference is a dynamic stiffness of closed-form plate modes and, cosine by
cosine, the exact impedance of the air column: no cavity modes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import maximum_filter1d
from scipy.optimize import brentq
from scipy.sparse import csr_array

from acoustics.air import Air
from acoustics.fields.rectangular import Room
from acoustics.fields.shaped import ShapedRoom
from acoustics.losses import Losses, losses_from_beta, losses_from_loss_factor, losses_from_t60
from acoustics.meshed.cavity_mesh import box_mesh
from acoustics.meshed.walls import Wall
from acoustics.receivers import Receiver
from acoustics.rooms.box_coupling import Leak
from acoustics.rooms.box_pressure import pressure
from femstruct.assembly.matrices import assemble
from femstruct.errors import InputError
from femstruct.impact.scene import Clock, HalfSine, Load, Scene
from femstruct.impact.simulate import simulate
from femstruct.language.models import read_model_file
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import oscillator
from femstruct.modal.damping import Damping, LossFactor, Ratio, with_damping
from femstruct.modal.frf import frf
from femstruct.modal.reduction import modal_basis
from femstruct.model.mesher import mesh_structure
from femstruct.model.probe import Surface
from femstruct.model.structure import Structure
from femstruct.sound.coupling import with_cavity
from femstruct.sound.placed import placed
from femstruct.sound.surfaces import pressure_per_force, surface_velocity
from femstruct.workflow.coupled_air import static_stiffness

ROUNDING = 1e-12  # rounding: 8e-15 here at most

C, RHO, LX, LY, L = 340.0, 1.29, 0.58, 0.47, 0.1
S, V, MASS, STIFFNESS = LX * LY, LX * LY * L, 29.68, 4.641e5
BULK = RHO * C**2
LOSSES = {"none": Losses(), "kelvin-voigt": losses_from_beta(0.0116, 293.0), "decay": losses_from_t60(0.5)}


def box(losses: Losses = LOSSES["none"], height: float = L) -> Room:
    return Room([LX, LY, height], Air(C, RHO), losses)


def underside(n: int = 16) -> Surface:
    """The rigid underside of an oscillator, n x n Gauss points: they integrate the cosines used here to rounding."""
    nodes, weights = np.polynomial.legendre.leggauss(n)
    x, y = (part.ravel() for part in np.meshgrid(0.5 * LX * nodes, 0.5 * LY * nodes, indexing="ij"))
    area = np.outer(0.5 * LX * weights, 0.5 * LY * weights).ravel()
    rows = csr_array(np.tile([[0, 0, -1.0, 0, 0, 0, 0]], (len(x), 1)))
    points = np.column_stack([x, y, 0 * x])
    corners = np.array([[-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]]) * [LX / 2, LY / 2, 0]
    return Surface("under", points, area, np.tile([0, 0, -1], (len(x), 1)), [[1, 0, 0], [0, -1, 0]], corners, rows)


def piston(ratio: float = 0.0) -> ModalBasis:
    return with_damping(oscillator(MASS, stiffness=STIFFNESS, axis="z")[0], Damping(Ratio(ratio)))


PLACE = oscillator(MASS, stiffness=STIFFNESS, axis="z")[1]["m"].probe("z")


def test_static_stiffness_of_a_piston_is_that_of_its_springs() -> None:
    sealed = with_cavity(piston(), placed(box(), underside()), up_to_hz=1000.0)
    assert static_stiffness(piston(), PLACE) == pytest.approx(STIFFNESS, rel=ROUNDING)
    assert static_stiffness(sealed, PLACE) == pytest.approx(STIFFNESS + BULK * S / L, rel=ROUNDING)
    leaking = with_cavity(piston(), placed(box(), underside()), leak=Leak(20.0, 2000.0), up_to_hz=1000.0)
    assert static_stiffness(leaking, PLACE) == pytest.approx(STIFFNESS, rel=ROUNDING)
    assert static_stiffness(oscillator(MASS, frequency_hz=0.0, axis="z")[0], PLACE) == 0.0


def column(s: np.ndarray, losses: Losses, z: float, height: float = L) -> np.ndarray:
    """Pressure at z over a uniform displacement of the ceiling into the room [Pa/m], s = j omega + a."""
    modulus = BULK * (1 + s * losses.relaxation_time)
    inertia = RHO * (s**2 + 2 * losses.decay_rate * s)
    gamma = np.sqrt(inertia / modulus)  # exp(+- gamma z)
    return inertia / gamma * np.cosh(gamma * z) / np.sinh(gamma * height)


def dynamic(s: np.ndarray, losses: Losses, ratio: float = 0.0) -> np.ndarray:
    dashpot = 2 * ratio * np.sqrt(STIFFNESS * MASS)
    return STIFFNESS + s * dashpot + s**2 * MASS + S * column(s, losses, L)


@pytest.mark.parametrize(
    ("up_to", "first", "second"),
    [(1500.0, 4e-8, None), (1750.0, 4e-9, 4e-9)],  # the errors of the remaining added mass: 3.3e-8; 2.5e-9, 3.0e-9
)
def test_sealed_box(up_to: float, first: float, second: float | None) -> None:
    def root(low: float, high: float) -> float:
        return brentq(lambda f: dynamic(np.array(2j * np.pi * f), Losses()).real, low, high, xtol=1e-12)

    exact = root(25.0, 30.0), root(1700.01, 1710.0)  # a pole of the cotangent is at 1700
    assert exact == pytest.approx((27.253028, 1700.2041), rel=5e-8)  # independent, of their digits
    basis = with_cavity(piston(), placed(box(), underside()), up_to_hz=up_to)
    assert basis.frequency_hz[0] == pytest.approx(exact[0], rel=first)
    if second is not None:
        assert np.abs(basis.frequency_hz / exact[1] - 1).min() < second
    assert basis.residual_norm.max() < ROUNDING
    (told,) = [finding for finding in basis.findings if finding.code == "two-way-coupling"]
    assert told.values["in_vacuo_hz"] == pytest.approx(19.90, abs=0.01)  # two decimals
    assert told.values["coupled_hz"] == basis.frequency_hz[0]
    assert "19.90 Hz in vacuo, is mode 1 at 27.25 Hz" in told.message


def test_sealed_box_of_finite_elements() -> None:
    """The static answer of the column is a parabola, which second-order cells have.

    1e-6: the points of the surface, which do not match the cells, see a little of the modes across.
    """
    exact = brentq(lambda f: dynamic(np.array(2j * np.pi * f), Losses()).real, 25.0, 30.0, xtol=1e-12)
    room = ShapedRoom(box_mesh((LX, LY, L), (4, 3, 2)), "z1", Air(C, RHO), up_to_hz=500.0)
    basis = with_cavity(piston(), placed(room, underside()))
    assert basis.frequency_hz[0] == pytest.approx(exact, rel=1e-6)
    # modes that the room has and the coupling leaves out are a mass, whether or not they were found
    more = replace(room, up_to_hz=2000.0)
    assert len(more.frequency_hz) > len(room.frequency_hz) + 10
    basis = with_cavity(piston(), placed(more, underside()), up_to_hz=500.0)
    assert basis.frequency_hz[0] == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize(("beta", "rough"), [(2e-4, False), (2e-2, True)])
def test_a_wall_that_takes_up_sound_pushes_back_less(beta: float, rough: bool) -> None:
    """The column over a resistive floor: rho c (cosh + beta sinh) / (sinh + beta cosh) of a wave down and up.

    With little to take up the response is right; with more the uniform pressure that the wall lets go is missing, which
    is told. The mode along the column is damped as it should be in any case: 2 % near its resonance for a loss factor
    of 1.3 %, which shifts phases by as much.
    """
    wall = {"z0": Wall({100.0: beta})}
    room = ShapedRoom(box_mesh((LX, LY, L), (4, 3, 4)), "z1", Air(C, RHO), walls=wall, up_to_hz=3500.0)
    basis = with_cavity(piston(0.03), placed(room, underside()))

    def pressed(f: np.ndarray) -> np.ndarray:
        """Pressure on the piston over its displacement into the room."""
        jk = 2j * np.pi * f / C
        wave = np.cosh(jk * L) + beta * np.sinh(jk * L)
        return 2j * np.pi * f * RHO * C * wave / (np.sinh(jk * L) + beta * np.cosh(jk * L))

    def exact(f: np.ndarray) -> np.ndarray:
        s = 2j * np.pi * f
        return 1 / (STIFFNESS + s * 0.06 * np.sqrt(STIFFNESS * MASS) + s**2 * MASS + S * pressed(f))

    told = [finding for finding in basis.findings if finding.code == "two-way-absorption"]
    assert len(told) == rough
    f = np.linspace(5.0, 400.0, 80)
    error = np.abs(frf(basis, PLACE, PLACE, f) - exact(f)).max() / np.abs(exact(f)).max()
    lost = C * beta / L / (2 * np.pi * 27.25)
    if rough:
        # 27.25 has four digits: 1e-4 here
        assert told[0].values["uniform_loss_factor"] == pytest.approx(lost, rel=1e-3)
        assert error > 0.1  # the finding is right
        # a wave down and up, 2 L / c, is left (1 - beta) / (1 + beta) of itself
        column_mode = int(np.abs(basis.frequency_hz - 1700.2).argmin())
        decay = -np.log((1 - beta) / (1 + beta)) * C / (2 * L)
        # one mode for the wave: 6e-4 here
        assert basis.viscous[column_mode, column_mode] / 2 == pytest.approx(decay, rel=1e-3)
        resonant = np.linspace(1690.0, 1715.0, 26)
        found = frf(basis, PLACE, PLACE, resonant)
        assert np.abs(found - exact(resonant)).max() < 0.02 * np.abs(exact(resonant)).max()
    else:
        assert error < 0.02  # half the loss factor, 0.4 %, over that of the piston's dashpot and its own


@pytest.mark.parametrize("law", LOSSES)
def test_frequency_responses(law: str) -> None:
    """Displacement and pressure at three heights, past the first mode of the column at 1700 Hz.

    3e-6 of the largest: two cavity modes along z are kept, the others follow statically (as omega^4 / omega_3^4).
    """
    losses = LOSSES[law]
    basis = with_cavity(piston(0.03), placed(box(losses), underside()), up_to_hz=3500.0)
    f = np.concatenate([np.linspace(1, 60, 200), np.linspace(60, 400, 50)])
    s = 2j * np.pi * f
    exact = 1 / dynamic(s, losses, 0.03)
    assert np.abs(frf(basis, PLACE, PLACE, f) - exact).max() < 1e-6 * np.abs(exact).max()  # as said above: 1e-7 here
    heard, _ = pressure_per_force(
        basis, PLACE, placed(box(losses), underside()), [Receiver(f"{z:g}", [0.2, 0.1, z]) for z in (0.0, 0.06, L)], f
    )
    for z, p in zip((0.0, 0.06, L), heard, strict=True):
        wanted = -column(s, losses, z) * exact  # a force up moves the ceiling out of the room
        assert np.abs(p - wanted).max() < 3e-6 * np.abs(wanted).max(), z


@pytest.mark.parametrize("law", ["kelvin-voigt", "decay"])
def test_blow_in_time_and_frequency(law: str) -> None:
    """A half-sine of 5 ms: the engine and the room's formula against the exact equation on a shifted frequency axis."""
    losses, fs, T = LOSSES[law], 48e3, 0.5
    basis = with_cavity(piston(0.03), placed(box(losses), underside()), up_to_hz=1750.0)
    push = Load("push", PLACE, HalfSine(-100.0, 100.0))
    response = simulate(basis, Scene(loads=(push,)), Clock(T, fs))
    assert response.ledger.residual < 1e-9  # what the steps leave open
    assert response.ledger.dissipated[-1] > 0.5 * response.ledger.work[-1]
    mic = Receiver("mic", [0.29, 0.235, 0.05])
    sound = pressure(*surface_velocity(response, placed(box(losses), underside())), box(losses), [mic])
    n, a = len(response.t), 7 / T
    s = a + 2j * np.pi * np.fft.rfftfreq(4 * n, 1 / fs)
    omega = 2 * np.pi * 100.0
    force = 100.0 * omega * (1 + np.exp(-s * np.pi / omega)) / (s**2 + omega**2)  # Laplace transform of the half-sine
    x = force / dynamic(s, losses, 0.03)
    weight = np.exp(a * response.t)
    displacement, p = (fs * np.fft.irfft(part)[:n] * weight for part in (x, column(s, losses, 0.05) * x))
    moved = -PLACE.of(basis.shapes) @ response.q
    # modes of the column from 1750 Hz on, statically
    assert np.abs(moved - displacement).max() < 1e-6 * np.abs(displacement).max()
    early = response.t < 0.95 * T
    # 1e-4: damping off the diagonal of the modes is left out, and the half-sine's kink is sampled
    assert np.abs(sound.p[0] - p)[early].max() < 1e-4 * np.abs(p).max()
    alone = simulate(piston(0.03), Scene(loads=(push,)), Clock(T, fs))
    deaf = pressure(*surface_velocity(alone, placed(box(losses), underside())), box(losses), [mic])
    assert np.abs(sound.p).max() / np.abs(deaf.p).max() - 1 < -0.2  # the air pushes back


@pytest.mark.parametrize("shape", ["box", "cells"])
@pytest.mark.parametrize("law", ["kelvin-voigt", "decay"])
def test_what_the_room_takes_is_what_the_structure_loses(law: str, shape: str) -> None:
    """The work of the room's pressure on the ceiling, by the one-way formula, closes the structure's own energy."""
    losses, fs = LOSSES[law], 96e3
    room: Room | ShapedRoom = box(losses)
    if shape == "cells":
        room = ShapedRoom(box_mesh((LX, LY, L), (4, 3, 3)), "z1", Air(C, RHO), losses, up_to_hz=1750.0)
    basis = with_cavity(piston(), placed(room, underside()), up_to_hz=1750.0)
    push = Load("push", PLACE, HalfSine(-100.0, 100.0))
    response = simulate(basis, Scene(loads=(push,)), Clock(0.2, fs))
    (moving,) = surface_velocity(response, placed(room, underside()))
    places = moving.points if shape == "cells" else [[0.29, 0.2, L]]  # of a box it is the same all over the piston
    (found,) = room.pressures([[moving]], [Receiver("on the ceiling", place) for place in places])
    row = -PLACE.of(basis.shapes)
    x, v = row @ response.q, row @ response.qd
    own = 0.5 * MASS * v**2 + 0.5 * STIFFNESS * x**2
    power = (moving.weights if shape == "cells" else np.array([S])) @ found.p * v
    slope = np.gradient(power, 1 / fs)
    steps = 0.5 * (power[1:] + power[:-1]) / fs - (slope[1:] - slope[:-1]) / 12 / fs**2  # Euler and Maclaurin
    given = np.concatenate([[0.0], np.cumsum(steps)])
    work = response.ledger.work[-1]
    after = slice(int(0.02 * fs), int(0.19 * fs))  # the push is over
    assert np.abs(own + given - work)[after].max() < 1e-6 * work  # the same, and the rule's next term
    assert given.max() > 0.3 * own.max()


SLITS = {0.2e-3: (27.3, 0.02), 0.3e-3: (27.2, 0.07), 0.5e-3: (22.1, 0.25), 1e-3: (19.4, 0.03)}


def slit(gap: float) -> Leak:
    """A slit 2.1 m long and 30 mm deep: viscous flow between plates."""
    length, depth, viscosity = 2.1, 0.03, 1.8e-5
    return Leak(1.2 * RHO * depth / (gap * length), 12 * viscosity * depth / (gap**3 * length))


@pytest.mark.parametrize("gap", SLITS)
def test_leak(gap: float) -> None:
    """Frequency and damping of heave by an independent calculation, to its digits; a slit of 1 mm is open at 20 Hz."""
    basis = with_cavity(piston(), placed(box(), underside(), name="box"), leak=slit(gap), up_to_hz=500.0)
    k = len(basis.omega)
    state = np.block([[np.zeros((k, k)), np.eye(k)], [-np.diag(basis.omega**2), -basis.viscous]])
    roots = np.linalg.eigvals(state)
    heave = roots[(roots.imag > 1) & (roots.imag < 200)]
    heave = heave[np.argmin(-heave.real / np.abs(heave))]
    frequency, ratio = SLITS[gap]
    assert abs(heave) / (2 * np.pi) == pytest.approx(frequency, rel=0.01)  # three digits: 0.2 % here
    assert -heave.real / abs(heave) == pytest.approx(ratio, abs=0.005)  # two decimals
    # the air column and the plug's impedance in parallel
    f = np.linspace(5.0, 60.0, 100)
    s, leak = 2j * np.pi * f, slit(gap)
    stiff = column(s, Losses(), L)
    pressed = stiff / (1 + stiff / S / (leak.inertance * s**2 + leak.resistance * s))  # pressure over displacement
    exact = 1 / (STIFFNESS + s**2 * MASS + S * pressed)
    # 1e-5: cavity modes above 500 Hz follow statically
    assert np.abs(frf(basis, PLACE, PLACE, f) - exact).max() < 1e-5 * np.abs(exact).max()
    lumped = S / (V / BULK + 1 / (leak.inertance * s**2 + leak.resistance * s))
    assert np.abs(pressed / lumped - 1).max() < 0.02  # the column is 1/60 of a wave
    mic, middle = Receiver("mic", [0.29, 0.235, 0.05]), column(s, Losses(), 0.05) / stiff
    heard, _ = pressure_per_force(basis, PLACE, placed(box(), underside(), name="box"), [mic], f)
    assert np.abs(heard[0] + middle * pressed * exact).max() < 1e-5 * np.abs(pressed * exact).max()
    assert np.abs(np.diag(np.diag(basis.viscous)) - basis.viscous).max() > 0.0  # a modal ratio would be wrong


def test_rigid_modes_and_forces_of_the_ground() -> None:
    free, _ = oscillator(MASS, frequency_hz=0.0, axis="z")
    closed = with_cavity(free, placed(box(), underside()), up_to_hz=500.0)
    assert closed.n_rigid == 0
    assert closed.kind[0] == "elastic"
    open_ = with_cavity(free, placed(box(), underside()), leak=Leak(100.0), up_to_hz=500.0)
    assert (open_.n_rigid, open_.omega[0], open_.kind[0]) == (1, 0.0, "rigid")
    across = replace(free, shapes=free.shapes[:, [1, 2, 0, 3, 4, 5, 6]])  # moves along y: displaces nothing
    assert with_cavity(across, placed(box(), underside()), up_to_hz=500.0).n_rigid == 1
    # at rest under a force the ground and the air share it as their stiffnesses
    basis = with_cavity(piston(), placed(box(), underside()), up_to_hz=500.0)
    air = BULK * S**2 / V
    share = frf(basis, PLACE, basis.outputs["ground.z"], [0.0], "transmissibility")[0]
    assert share.real == pytest.approx(STIFFNESS / (STIFFNESS + air), rel=ROUNDING)
    assert basis.momentum[2] @ basis.momentum[2] == pytest.approx(MASS, rel=1e-3)  # less the added mass
    with pytest.raises(InputError, match=r"rooms\.hall: got a basis in closed form.*give up_to_hz"):
        with_cavity(piston(), placed(box(), underside(), name="hall"))


@pytest.mark.parametrize("resistance", [500.0, 2000.0])
def test_damping_between_modes_is_weighed_beside_rigid_ones(resistance: float) -> None:
    """A free mass over a leaking column floats as a whole: what the leak's resistance between the modes makes of the
    motion, against the responses by the whole matrix of damping and by its diagonal, at the resonances."""
    free, _ = oscillator(MASS, frequency_hz=0.0, axis="z")
    leaking = Leak(20.0, resistance)
    basis = with_cavity(free, placed(box(LOSSES["kelvin-voigt"]), underside()), leak=leaking, up_to_hz=1000.0)
    assert basis.n_rigid == 1
    (told,) = [finding.values for finding in basis.findings if finding.code == "two-way-coupling"]
    shape = basis.shapes[0, 2]

    def motion(damping: np.ndarray) -> np.ndarray:
        elastic = basis.omega[basis.n_rigid :]
        systems = np.array([np.diag(basis.omega**2 - at**2) + 1j * at * damping for at in elastic])
        return np.linalg.solve(systems, np.broadcast_to(shape, (len(elastic), len(shape)))[..., None])[..., 0] @ shape

    alone = motion(np.diag(np.diag(basis.viscous)))
    share = np.linalg.norm(motion(basis.viscous) - alone) / np.linalg.norm(alone)
    assert 0.01 < share < 0.1
    assert told["damping_between_modes"] == pytest.approx(share, rel=share)  # it is of first order


def test_two_rooms_in_either_order() -> None:
    """Two boxes on one piston: the exact equation with both columns, whichever is coupled first."""
    low, high = box(), box(height=0.25)
    both = [
        with_cavity(
            with_cavity(piston(), placed(a, underside()), up_to_hz=800.0), placed(b, underside()), up_to_hz=800.0
        )
        for a, b in ((low, high), (high, low))
    ]
    assert both[0].frequency_hz == pytest.approx(both[1].frequency_hz, rel=ROUNDING)

    def equation(f: float) -> float:
        s = np.array(2j * np.pi * f)
        return float((dynamic(s, Losses()) + S * column(s, Losses(), 0.25, 0.25)).real)

    # modes from 800 Hz on, statically: 9e-8 here
    assert both[0].frequency_hz[0] == pytest.approx(brentq(equation, 28.0, 33.0, xtol=1e-12), rel=1e-6)


PLATE = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {plate: {type: plate, material: steel, thickness: 5 mm, origin: [0, 0, 2], size: [1, 1], mesh: [20, 20]}}
supports: {edges: {on: plate, edge: all, fix: simple}}
points: {P: {on: plate, at: [0.6, 0.4]}}
surfaces: {under: {on: plate, side: below}}
"""
AIR = Air(343.0, 1.21)
RECEIVERS = [Receiver(f"z = {z:g}", [0.5, 0.5, z]) for z in (1.0, 0.0, 2.0)]


def overlap(m: np.ndarray, l: np.ndarray) -> np.ndarray:  # noqa: E741
    """Integral of sin(m pi x) cos(l pi x) over 0..1."""
    unlike = np.where(m == l, 1, m * m - l * l)
    return np.where(m == l, 0.0, m / np.pi * (1 - np.cos(np.pi * (m + l))) / unlike)


class PlateOnAir:
    """Closed-form modes of the simply supported plate, and the air column of every cosine."""

    def __init__(self) -> None:
        mass, bending = 7850 * 0.005, 210e9 * 0.005**3 / 12 / (1 - 0.3**2)
        self.mn = np.array([(m, n) for m in range(1, 17) for n in range(1, 17) if m * m + n * n <= 256])
        self.lm = np.stack(np.meshgrid(*2 * [np.arange(40)], indexing="ij"), axis=-1).reshape(-1, 2)
        self.omega = np.sqrt(bending / mass) * np.pi**2 * (self.mn**2).sum(axis=1)
        self.at_drive = 2 / np.sqrt(mass) * np.sin(np.pi * 0.6 * self.mn[:, 0]) * np.sin(np.pi * 0.4 * self.mn[:, 1])
        x, y = (overlap(self.mn[None, :, i], self.lm[:, None, i]) for i in (0, 1))
        self.integrals = 2 / np.sqrt(mass) * x * y
        self.weight = np.where(self.lm > 0, 2.0, 1.0).prod(axis=1)
        self.at_receiver = np.cos(0.5 * np.pi * self.lm).prod(axis=1)

    def stiffness(self, omega: float, plate: complex, air: complex) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Dynamic stiffness, vertical wave numbers and pressure factors; plate, air: 1 + j times their loss factors."""
        mu = np.sqrt(omega**2 / (AIR.c**2 * air) - np.pi**2 * (self.lm**2).sum(axis=1) + 0j)
        factor = AIR.rho * omega**2 / (mu * np.sin(2.0 * mu))
        own = np.diag(self.omega**2 * plate - omega**2)
        return own + (self.integrals.T * (self.weight * factor * np.cos(2.0 * mu))) @ self.integrals, mu, factor

    def pressures(self, f: np.ndarray, plate: complex, air: Callable[[float], complex]) -> np.ndarray:
        """At the receivers, per unit force upwards [3, nf]."""
        exact = np.zeros((len(RECEIVERS), len(f)), dtype=complex)
        for line, frequency in enumerate(f):
            matrix, mu, factor = self.stiffness(2 * np.pi * frequency, plate, air(frequency))
            moved = self.weight * (self.integrals @ np.linalg.solve(matrix, -self.at_drive))
            for row, receiver in enumerate(RECEIVERS):
                exact[row, line] = (self.at_receiver * moved * factor * np.cos(mu * receiver.position[2])).sum()
        return exact


@pytest.fixture(scope="module")
def plate(tmp_path_factory: pytest.TempPathFactory) -> tuple[ModalBasis, Surface, object]:
    path = Path(tmp_path_factory.mktemp("plate"), "plate.yaml")
    path.write_text(PLATE)
    structure = read_model_file(path).structure
    assert isinstance(structure, Structure)
    model = mesh_structure(structure)
    drive, surface = model.points["P"].probe("z"), model.surfaces["under"]
    return modal_basis(assemble(model), up_to=1500.0, probes=[drive, surface.pressure()]), surface, drive


@pytest.mark.parametrize(
    ("losses", "air"),
    [
        (losses_from_loss_factor(0.01, 85.75, "source"), lambda f: (1 - 0.005j) ** -2),  # 1 + 0.01j, but for 4e-5
        (losses_from_loss_factor(0.01, 85.75), lambda f: 1 + 0.01j * f / 85.75),
    ],
    ids=["hysteretic", "kelvin-voigt"],
)
def test_plate_on_a_cavity(plate, losses, air) -> None:  # type: ignore[no-untyped-def]
    """1 N at (0.6, 0.4), pressures at three heights, every 4 Hz to 400 Hz, within 0.1 dB.

    On lines within 20 dB of the largest within 25 Hz. The basis holds modes to 1.5 kHz and cavity modes to 600 Hz.
    """
    vacuo, surface, drive = plate
    room = Room([1.0, 1.0, 2.0], AIR, losses)
    basis = with_cavity(with_damping(vacuo, Damping(LossFactor(0.01))), placed(room, surface), up_to_hz=600.0)
    f = np.arange(2.0, 401.0, 4.0)
    found, advice = pressure_per_force(basis, drive, placed(room, surface), RECEIVERS, f)
    assert not advice
    agree(found, PlateOnAir().pressures(f, 1 + 0.01j, air), 13)


def agree(found: np.ndarray, exact: np.ndarray, lines: int, in_all: float = 2e-3) -> None:
    """Within 0.1 dB where the pressure is within 20 dB of the largest of so many lines around, 0.2 % in all."""
    heard = np.abs(exact) > 0.1 * maximum_filter1d(np.abs(exact), lines, axis=1)
    assert heard.mean() > 0.4
    decibels = 20 * np.log10(np.abs(found) / np.abs(exact))
    assert np.abs(decibels[heard]).max() < 0.1
    assert np.linalg.norm(found - exact) < in_all * np.linalg.norm(exact)


@pytest.mark.parametrize(
    ("cells", "up_to", "highest", "step"),
    [
        ((6, 6, 12), 450.0, 160.0, 2.0),
        pytest.param((14, 14, 28), 750.0, 400.0, 1.0, marks=pytest.mark.stress),
    ],
)
def test_plate_on_a_cavity_of_finite_elements(plate, cells, up_to, highest, step) -> None:  # type: ignore[no-untyped-def]
    """The same with the room's modes by scikit-fem, coupled two-way through them.

    Waves have 10 to 13 cells at the highest frequency: 5e-5 to 1e-4 in frequency, up to 2 % of a resonance's bandwidth
    and of its peak; over all lines much less.
    """
    vacuo, surface, drive = plate
    losses = losses_from_loss_factor(0.01, 85.75, "source")
    room = ShapedRoom(box_mesh((1.0, 1.0, 2.0), cells), "z1", AIR, losses, up_to_hz=up_to)
    basis = with_cavity(with_damping(vacuo, Damping(LossFactor(0.01))), placed(room, surface))
    f = np.arange(step, highest + step, step)
    found, advice = pressure_per_force(basis, drive, placed(room, surface), RECEIVERS, f)
    assert not advice
    agree(found, PlateOnAir().pressures(f, 1 + 0.01j, lambda f: (1 - 0.005j) ** -2), int(50 / step) + 1, in_all=4e-3)
    coupled_frequencies(basis, highest)


def test_coupled_frequencies_of_the_plate(plate) -> None:  # type: ignore[no-untyped-def]
    vacuo, surface, _ = plate
    basis = with_cavity(vacuo, placed(Room([1.0, 1.0, 2.0], AIR), surface), up_to_hz=600.0)
    assert basis.n_rigid == 0
    assert vacuo.frequency_hz[0] < basis.frequency_hz[0] * 0.99  # the air stiffens the first mode
    coupled_frequencies(basis, 300.0)


def coupled_frequencies(basis: ModalBasis, highest: float) -> None:
    """Each is a root of the exact dynamic stiffness, within 0.05 %: an eigenvalue of it crosses zero there."""
    reference = PlateOnAir()

    def negatives(f: float) -> int:
        """Wittrick-Williams: modes below f are the negative eigenvalues and the poles, modes of the rigid room."""
        matrix, _, _ = reference.stiffness(2 * np.pi * f, 1.0, 1.0)
        k = np.arange(20)
        rigid = AIR.c / 2 * np.sqrt(k[:, None, None] ** 2 + k[None, :, None] ** 2 + (k[None, None, :] / 2.0) ** 2)
        return int((np.linalg.eigvalsh(matrix.real) < 0).sum()) + int((rigid < f).sum()) - 1

    found = basis.frequency_hz[basis.frequency_hz < highest]
    assert len(found) > 8
    # the uniform mode, a pole at 0 Hz, is none of the modes of the coupled system
    for number, frequency in enumerate(found):
        # the mesh, by which all are told apart
        assert negatives(frequency * (1 - 5e-4)) <= number < negatives(frequency * (1 + 5e-4)), frequency
