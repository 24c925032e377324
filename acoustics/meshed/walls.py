"""What walls do: admittances of locally reacting walls, the absorption coefficients they stand for, and walls that
yield.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import log
from types import MappingProxyType
from typing import Final

import numpy as np
import scipy
from scipy.linalg import eig

from acoustics.air import Air
from acoustics.arrays import Complexes, Floats, freeze, frozen, positive
from acoustics.errors import AcousticsError, Advice
from acoustics.losses import Losses
from acoustics.meshed.finite_elements import CavityModes, wall_integrals, wall_traces
from acoustics.tags import stored_as

_RESISTANCE_OF_MOST: Final = 1.567  # specific resistance of the highest random-incidence absorption
MOST_ABSORBED: Final = 0.951  # which it is


@stored_as("wall of a room/1")
@dataclass(frozen=True, eq=False)
class Wall:
    """A locally reacting wall that absorbs sound: rho c over its impedance, a real number.

    admittance : {frequency [Hz]: rho c / Z [-]}; between them it is linear in log frequency, beyond them constant.

    Raises AcousticsError: no admittance, a frequency not above 0, a negative admittance.

    Notes
    -----
    A real admittance that depends on frequency is no causal wall; it damps each mode with its value there, and couples
    two modes with the geometric mean of both.

    >>> Wall({100.0: 0.0, 400.0: 0.02}).at(np.array([50.0, 200.0])).round(9).tolist()
    [0.0, 0.01]
    """

    admittance: Mapping[float, float]

    def __post_init__(self) -> None:
        if not self.admittance:
            raise AcousticsError("wall.admittance", got="nothing", expected="at least one value")
        for frequency, value in self.admittance.items():
            positive("wall.admittance", frequency, "Hz")
            if not (np.isfinite(value) and value >= 0):
                raise AcousticsError("wall.admittance", got=f"{value:g} at {frequency:g} Hz", expected="a number >= 0")
        freeze(self, admittance=MappingProxyType(dict(sorted(self.admittance.items()))))

    def __str__(self) -> str:
        """What it absorbs, in words."""
        return "admittance " + ", ".join(f"{value:.4g} at {f:g} Hz" for f, value in self.admittance.items())

    def at(self, frequency_hz: Floats) -> Floats:
        """Admittance [n] at frequencies [n] [Hz]."""
        known = np.log(list(self.admittance))
        logarithms = np.log(np.maximum(frequency_hz, float(np.exp(known[0]))))
        values: Floats = np.interp(logarithms, known, list(self.admittance.values()))
        return values

    @property
    def constant(self) -> bool:
        """Whether it is the same at all frequencies, and the wall therefore causal."""
        return len(set(self.admittance.values())) == 1


@stored_as("yielding wall of a room/1")
@dataclass(frozen=True, eq=False)
class YieldingWall:
    """A locally reacting wall that gives way: every bit of it a mass on a spring and a dashpot, held from behind.

    mass : per area [kg/m^2]; 0 for a wall far below its resonance. stiffness : per area [N/m^3]. resistance : per area
    [Pa s/m].

    Raises AcousticsError: one of them below 0, neither mass nor stiffness.

    Notes
    -----
    Its impedance r + j omega m + s / (j omega) is causal, so that it is exact in time. Neighbouring bits do not hold
    each other: a plate that bends is no such wall near and above the frequency at which its bending waves travel as
    fast as sound. A resistance alone is a `Wall`: rho c / r.

    >>> wall = YieldingWall(mass=25.0, stiffness=2e6)
    >>> round((wall.stiffness / wall.mass) ** 0.5 / (2 * np.pi), 2)
    45.02
    """

    mass: float = 0.0
    stiffness: float = 0.0
    resistance: float = 0.0

    def __str__(self) -> str:
        """How it yields, in words."""
        return f"{self.mass:g} kg/m^2, {self.stiffness:g} N/m^3, {self.resistance:g} Pa s/m"

    def __post_init__(self) -> None:
        for name, unit in (("mass", "kg/m^2"), ("stiffness", "N/m^3"), ("resistance", "Pa s/m")):
            value = float(getattr(self, name))
            if not (np.isfinite(value) and value >= 0):
                raise AcousticsError(f"wall.{name}", got=f"{value:g} {unit}", expected="a number >= 0")
            freeze(self, **{name: value})
        if self.mass == 0 and self.stiffness == 0:
            raise AcousticsError(
                "wall",
                got="neither mass nor stiffness",
                expected="one of them",
                do="give a wall with a resistance only as an impedance",
            )


AnyWall = Wall | YieldingWall


def absorbing(absorption: float | Mapping[float, float]) -> Wall:
    """The wall with a random-incidence absorption coefficient, one or {frequency [Hz]: alpha}.

    Raises AcousticsError: a coefficient below 0 or above 0.951, the most that a real admittance reaches.

    Notes
    -----
    Paris' formula for a specific resistance r: alpha = (8 / r) (1 + 1 / (1 + r) - (2 / r) ln(1 + r)), on its stiff
    side; 8 / r for a little. (H. Kuttruff, Room Acoustics, 5th ed., eq. 2.42.)

    >>> round(absorbing(0.1).at(np.array([100.0])).item(), 4)
    0.014
    """
    by_frequency = absorption if isinstance(absorption, Mapping) else {1000.0: absorption}
    return Wall({frequency: _admittance(alpha) for frequency, alpha in by_frequency.items()})


def random_incidence_absorption(admittance: float) -> float:
    """Absorption coefficient of a real specific admittance for sound from all directions; see `absorbing`."""
    if admittance == 0:
        return 0.0
    r = 1 / admittance
    return 8 / r * (1 + 1 / (1 + r) - 2 / r * log(1 + r))


def _admittance(alpha: float) -> float:
    most = random_incidence_absorption(1 / _RESISTANCE_OF_MOST)
    if not 0 <= alpha <= most:
        raise AcousticsError(
            "absorption", got=f"{alpha:g}", expected=f"0 to {most:.3f}, the largest of a locally reacting resistance"
        )
    if alpha == 0:
        return 0.0
    return float(
        scipy.optimize.brentq(
            lambda y: random_incidence_absorption(y) - alpha, alpha / 16, 1 / _RESISTANCE_OF_MOST, xtol=1e-15
        )
    )


# ----------------------------------------------------------------------------------------------------------------------
# Walls that yield as coordinates: oscillators that pressure drives and that take volume from the room.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class WallMotion:
    """The displacement of the walls that yield, in shapes w_j: one oscillator each.

    loads : integrals of a unit source at each node times w_j over their walls [dofs, r], as of
    `acoustics.meshed.finite_elements.drive`.
    mass, stiffness, resistance : of each [r] [kg/m^2], [N/m^3], [Pa s/m]; the shapes are orthonormal over their wall.
    """

    loads: Floats
    mass: Floats
    stiffness: Floats
    resistance: Floats

    def __post_init__(self) -> None:
        loads = frozen("motion.loads", self.loads, (None, None))
        ones = {name: frozen(f"motion.{name}", getattr(self, name), (loads.shape[1],)) for name in _OSCILLATOR}
        freeze(self, loads=loads, **ones)


_OSCILLATOR = ("mass", "stiffness", "resistance")


def wall_motion(modes: CavityModes, walls: Mapping[str, AnyWall]) -> WallMotion:
    """The displacement of all walls that yield, in the traces that the modes have on them.

    A locally reacting wall moves as the pressure on it: the traces of the modes are all that it needs.
    """
    yielding = {name: wall for name, wall in walls.items() if isinstance(wall, YieldingWall)}
    traces = [wall_traces(modes, name) for name in yielding]
    many = [trace.shape[1] for trace in traces]
    each = {
        name: np.repeat([getattr(wall, name) for wall in yielding.values()], many).astype(np.float64)
        for name in _OSCILLATOR
    }
    return WallMotion(np.hstack([np.zeros((len(modes.shapes), 0)), *traces]), **each)


# ----------------------------------------------------------------------------------------------------------------------
# What the walls of a room of any shape absorb: how they damp its modes, and couple them.
# ----------------------------------------------------------------------------------------------------------------------

COUPLED: Final = 0.05  # what walls couple two modes by, over the distance of their frequencies, to matter


def wall_absorption(modes: CavityModes, walls: Mapping[str, AnyWall], air: Air) -> Floats:
    """Integrals of beta psi_n psi_m over all walls, over the volume [n, n] [1/m]; beta is the two modes' geometric
    mean. Walls that yield are not among them."""
    frequency_hz = modes.wavenumber * air.c / (2 * np.pi)
    total = np.zeros((len(frequency_hz), len(frequency_hz)))
    for name, wall in walls.items():
        if isinstance(wall, Wall):
            root = np.sqrt(wall.at(frequency_hz))
            total += root[:, None] * wall_integrals(modes, name) * root / modes.mesh.volume
    return total


def coupling(modes: CavityModes, taken_up: Floats, air: Air) -> float:
    """Largest rate by which walls couple two modes, c |A_nm|, over the distance of their frequencies or, where they
    lie closer than that, over their own rates.

    Parameters
    ----------
    taken_up : Floats [n, n]
        Of `wall_absorption` [1/m].
    """
    distance = air.c * np.abs(modes.wavenumber[:, None] - modes.wavenumber)
    rates = air.c * np.abs(taken_up)
    off = rates - np.diag(np.diag(rates))
    span = np.hypot(distance, np.add.outer(np.diag(rates), np.diag(rates)))
    ratio = np.divide(off, span, out=np.zeros_like(off), where=off > 0)
    return float(ratio.max(initial=0.0))


def is_coupled(walls: Mapping[str, AnyWall], coupled: float) -> bool:
    """Whether the modes of a room are complex ones, which walls couple, rather than each damped by itself.

    Parameters
    ----------
    coupled : float
        Of `coupling`. However little it is: in a tube whose end couples two modes by 0.02, modes that are damped one by
        one have peaks that are 12 % off and dips between them that are 16 dB off.
    """
    return coupled > 0.0 or any(isinstance(wall, YieldingWall) for wall in walls.values())


def wall_coupling_advice(walls: Mapping[str, AnyWall], coupled: float) -> tuple[Advice, ...]:
    """Advice ``coupled-absorption`` where walls couple modes by what depends on frequency: two modes are coupled by the
    geometric mean of what damps each."""
    if coupled <= COUPLED or all(wall.constant for wall in walls.values() if isinstance(wall, Wall)):
        return ()
    return (
        Advice(
            "coupled-absorption",
            f"the walls couple two room modes by {coupled:.2g} of the distance of their frequencies; {COUPLED:g} is "
            "allowed where absorption depends on frequency. The geometric mean of the admittances at both frequencies "
            "is used, which is then an approximation between the modes",
            {"coupling": coupled, "allowed": COUPLED},
        ),
    )


def two_way_absorption(
    modes: CavityModes, walls: Mapping[str, AnyWall], air: Air, first_hz: float
) -> tuple[Advice, ...]:
    """Advice where walls absorb more than the damping of each mode by itself, which is what two-way coupling has.

    Parameters
    ----------
    first_hz : float
        The lowest mode of structure and air, 0 for none [Hz].
    """
    taken = wall_absorption(modes, walls, air)
    coupled = coupling(modes, taken, air)
    rate = air.c * float(taken[0, 0])  # at which walls let go of uniform pressure [1/s]
    lost = rate / (2 * np.pi * first_hz) if first_hz else 0.0
    if coupled <= COUPLED and lost <= COUPLED:
        return ()
    return (
        Advice(
            "two-way-absorption",
            f"The walls couple two room modes by {coupled:.2g} of the distance of their frequencies, and would absorb "
            f"uniform pressure with a loss factor of {lost:.2g} at the first mode, {first_hz:.4g} Hz. "
            f"Above {COUPLED:g}, two-way coupling is a rough approximation: its walls damp each room mode separately "
            "and do not damp uniform pressure. One-way coupling includes both, but not the reaction of the air",
            {"coupling": coupled, "uniform_loss_factor": lost, "allowed": COUPLED},
        ),
    )


# ----------------------------------------------------------------------------------------------------------------------
# Modes of a room that its walls couple: the complex modes of its pressures, its flows and the walls that yield.
# ----------------------------------------------------------------------------------------------------------------------

Answer = tuple[Floats | Complexes, Floats | Complexes, Callable[[Complexes], Complexes]]


def complex_modes(modes: CavityModes, air: Air, losses: Losses, absorbed: Floats, motion: WallMotion) -> Answer:
    """(left, right, term): pressures of the modes are left @ (term(s) * (right @ integrals of psi_n v)); the rest as
    `resonances`."""
    poles, left, right = resonances(modes, air, losses, absorbed, motion)

    def term(s: Complexes) -> Complexes:
        ratio: Complexes = (1 + losses.relaxation_time * s) / (s - poles[:, None])
        return ratio

    return left, right, term


def resonances(
    modes: CavityModes, air: Air, losses: Losses, absorbed: Floats, motion: WallMotion
) -> tuple[Complexes, Complexes, Complexes]:
    """Poles [m] [1/s] of a room and its walls, what of the pressures of its modes is in each [n, m], and how these
    drive it [m, n].

    Parameters
    ----------
    absorbed : Floats [n, n]
        A, of `wall_absorption` [1/m].

    Notes
    -----
    With tau the relaxation time, gamma the decay rate, w the displacement of the walls out of the room, L its integrals
    with the modes, kappa = rho c^2 / V, x_n = omega_n P_n / (s + 2 gamma) and the elastic part Q of the pressure,

        s Q = kappa (v - L s w) - c A P - omega x,        P = (1 + tau s) Q,
        m s^2 w + r s w + k w = L^T P.

    A wall without mass has a displacement, but no velocity, among the states. Without a resistance either, of its own
    or of the air that it compresses, it follows the pressure, and its compliance joins that of the air.
    """
    n, tau, kappa = len(absorbed), losses.relaxation_time, air.bulk_modulus / modes.mesh.volume
    heavy = motion.mass > 0
    still = ~heavy & (motion.resistance == 0) & (tau == 0)
    slow = ~heavy & ~still
    L = modes.shapes.T @ motion.loads
    along = np.vstack([np.zeros(n - 1), np.diag(air.c * modes.wavenumber[1:])])  # the uniform mode has no flow
    sizes = [n, n - 1, int(slow.sum()), int(heavy.sum()), int(heavy.sum()), n]
    parts = np.split(np.eye(sum(sizes)), np.cumsum(sizes)[:-1])  # rows over the states and, last, the motion
    elastic, flow, yielded, moved, moving, driven = parts
    give = np.linalg.inv(np.eye(n) + tau * air.c * absorbed)
    taken = kappa * (driven - L[:, heavy] @ moving) - along @ flow
    pressure = give @ (elastic + tau * taken)  # of walls without mass at rest
    resistance = np.diag(motion.resistance[slow]) + tau * kappa * L[:, slow].T @ give @ L[:, slow]
    yielding = np.linalg.solve(resistance, L[:, slow].T @ pressure - motion.stiffness[slow, None] * yielded)
    pressure = pressure - tau * kappa * give @ L[:, slow] @ yielding
    compliance = np.eye(n) + kappa * (L[:, still] / motion.stiffness[still]) @ L[:, still].T
    held = motion.resistance[heavy, None] * moving + motion.stiffness[heavy, None] * moved
    rates = np.vstack(
        [
            np.linalg.solve(compliance, taken - kappa * L[:, slow] @ yielding - air.c * absorbed @ pressure),
            along.T @ pressure - 2 * losses.decay_rate * flow,
            yielding,
            moving,
            (L[:, heavy].T @ pressure - held) / motion.mass[heavy, None],
        ]
    )
    poles, vectors = eig(rates[:, :-n])
    right = np.linalg.solve(vectors, rates[:, -n:].astype(np.complex128))
    return poles, vectors[:n], right
