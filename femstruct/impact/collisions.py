"""Collisions by momentum and restitution: bodies in a row, without contact stiffness and without time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import beta

from femstruct.arrays import Floats, freeze, frozen
from femstruct.errors import FemstructError, InputError, NotConverged
from femstruct.laws.hertz import Hertz
from femstruct.laws.linear import Linear
from femstruct.laws.restitution import refuse_restitution

MOST_COLLISIONS = 10_000
AT_REST = 1e-12  # approach speed over the largest speed below which two bodies count as no longer closing


@dataclass(frozen=True, eq=False)
class Collision:
    """Speeds and energies of bodies in a row before and after they collided.

    masses [n] [kg]; before, after [n] : velocities [m/s] along the row, the first body behind the others.
    blows : pairs of bodies that collided, in order.
    """

    masses: Floats
    before: Floats
    after: Floats
    blows: tuple[tuple[int, int], ...]

    def __post_init__(self) -> None:
        masses = frozen("Collision masses", self.masses, (None,))
        freeze(
            self,
            masses=masses,
            before=frozen("Collision before", self.before, masses.shape),
            after=frozen("Collision after", self.after, masses.shape),
        )

    @property
    def energies(self) -> Floats:
        """Kinetic energies after, over all kinetic energy before [n]."""
        shares: Floats = self.masses * self.after**2 / (self.masses @ self.before**2)
        return shares

    @property
    def lost(self) -> float:
        """Energy dissipated in the blows, over all kinetic energy before."""
        return 1.0 - float(self.energies.sum())


def collide(masses: Sequence[float], velocities: Sequence[float], restitution: Sequence[float]) -> Collision:
    """Free bodies that touch, colliding one pair at a time until no pair closes any more.

    masses [n] [kg]; velocities [n] [m/s], the first body behind the others.

    Parameters
    ----------
    restitution : Sequence[float] [n - 1]
        Of each pair of neighbours, ratio of the speeds of separation and approach, 0 to 1.

    Raises
    ------
    InputError
        For values that cannot be; NotConverged when the blows do not end (small restitution lets three bodies collide
        infinitely often in a finite time).

    Notes
    -----
    Of pairs that close at the same time the one nearest the first body collides first. One pair at a time is the
    limit of contact springs that are each much softer than the one before: the middle body has left the first one
    before the last one feels anything. Stiff contact springs have other limits: `collide_as_one` where the later
    contact is much the stiffer one, and one that only a simulation knows where they are alike. Of a ball of half the
    mass of two equal bodies in a row the last one takes 8/9, 8/25 and 0.7547 of the energy in these limits.

    Source: Son and Matsuhisa's momentum-exchange damper, dissertation section 2.2.2, whose two blows (2.23 to 2.33)
    are the first two here; with e < 1 or a heavy last body there may be more.

    Examples
    --------
    >>> collide([0.5, 1.0, 1.0], [1.0, 0.0, 0.0], [1.0, 1.0]).energies.round(6)
    array([0.111111, 0.      , 0.888889])
    """
    m, before, e = _checked(masses, velocities, restitution)
    v, blows = before.copy(), list[tuple[int, int]]()
    top = float(np.abs(before).max())
    while True:
        closing = np.nonzero(v[:-1] - v[1:] > AT_REST * top)[0]
        if not len(closing):
            return Collision(m, before, v, tuple(blows))
        if len(blows) == MOST_COLLISIONS:
            raise NotConverged(
                "collide",
                got=f"{MOST_COLLISIONS} blows and bodies that still close",
                expected="bodies that separate",
                do="use a larger restitution, or simulate the contacts",
            )
        i = int(closing[0])
        v[i], v[i + 1] = _pair(m[i], m[i + 1], v[i], v[i + 1], e[i])
        blows.append((i, i + 1))


def collide_as_one(masses: Sequence[float], velocities: Sequence[float], restitution: float) -> Collision:
    """The first body hits the others, which move as one: contacts between them much stiffer than the first.

    masses [n], velocities [n] as in `collide`, those of the others equal.

    Parameters
    ----------
    restitution : float
        Of the blow, 0 to 1.

    Raises
    ------
    InputError
        For values that cannot be, or others that do not move together.

    Examples
    --------
    >>> collide_as_one([0.5, 1.0, 1.0], [1.0, 0.0, 0.0], 1.0).energies.round(6)
    array([0.36, 0.32, 0.32])
    """
    m, before, _ = _checked(masses, velocities, [restitution] * (len(masses) - 1))
    if np.ptp(before[1:]) > 0:
        raise InputError(
            "collide_as_one", got=f"velocities {list(velocities)[1:]}", expected="one velocity of all but the first"
        )
    after = before.copy()
    if before[0] <= before[1]:
        return Collision(m, before, after, ())
    after[0], after[1:] = _pair(m[0], float(m[1:].sum()), before[0], before[1], restitution)
    return Collision(m, before, after, ((0, 1),))


def _pair(m: float, n: float, v: float, w: float, e: float) -> tuple[float, float]:
    """Velocities of two bodies after a blow: J = m n / (m + n) (1 + e) (v - w), equations 2.26 and 2.30."""
    impulse = m * n / (m + n) * (1.0 + e) * (v - w)
    return v - impulse / m, w + impulse / n


def _checked(
    masses: Sequence[float], velocities: Sequence[float], restitution: Sequence[float]
) -> tuple[Floats, Floats, Floats]:
    m, v, e = (np.asarray(values, dtype=np.float64) for values in (masses, velocities, restitution))
    if m.ndim != 1 or len(m) < 2 or not (np.isfinite(m).all() and (m > 0).all()):
        raise InputError("masses", got=f"{list(masses)}", expected="two or more positive masses")
    if v.shape != m.shape or not np.isfinite(v).all():
        raise InputError("velocities", got=f"{list(velocities)}", expected=f"{len(m)} numbers, one a body")
    if e.shape != (len(m) - 1,) or not ((e >= 0) & (e <= 1)).all():
        raise InputError("restitution", got=f"{list(restitution)}", expected=f"{len(m) - 1} values from 0 to 1")
    return m, v, e


# ----------------------------------------------------------------------------------------------------------------------
# What a measured force pulse of one blow says in closed form: start values for its stiffness and damping.
# ----------------------------------------------------------------------------------------------------------------------

FLOOR = 0.1  # of the peak: where a rising and a falling flank are looked for; noise is below
# Contact time of a Hertz spring over d_max / v, 2 int_0^1 dx / sqrt(1 - x^2.5), and what c d^0.5 d' loses on its path,
# in and out, over c v d_max^1.5: 2 int_0^1 x^0.5 sqrt(1 - x^2.5) dx
LASTS, LOSES = 0.8 * float(beta(0.4, 0.5)), 0.8 * float(beta(0.6, 1.5))


@dataclass(frozen=True)
class Pulse:
    """A force pulse: start and duration [s], peak [N], impulse [N s]."""

    start: float
    duration: float
    peak: float
    impulse: float

    def restitution(self, mass: float, speed: float) -> float:
        """Of a free mass [kg] that came with a speed [m/s]: impulse / (mass speed) - 1.

        Raises FemstructError where that is not in (0, 1]: the force, the mass or the speed is another.
        """
        found = self.impulse / (mass * speed) - 1.0
        try:
            refuse_restitution(found)
        except FemstructError as error:
            raise FemstructError(
                "pulse",
                got=f"an impulse of {self.impulse:.4g} N s for {mass * speed:.4g} kg m/s: restitution {found:.3g}",
                expected="1 to 2 times mass times speed",
                do="check the gain of the sensor, the mass and the speed",
            ) from error
        return found

    def linear(self, mass: float, speed: float) -> Linear:
        """The linear law with this duration and impulse; k = m (pi / T)^2 where nothing is lost."""
        return Linear.returning(self.restitution(mass, speed), mass, duration=self.duration)

    def hertz(self, mass: float, speed: float) -> Hertz:
        """The Hertz law with this duration, and the dashpot that loses the energy lost: for weak damping.

        Without loss T = 2.943 d_max / v and m v^2 / 2 = 2/5 k d_max^2.5 (Johnson, Contact Mechanics, 11.24).
        """
        e = self.restitution(mass, speed)
        mean = 0.5 * (1.0 + e) * speed  # what goes in and what comes out take their time
        depth = mean * self.duration / LASTS
        stiffness = 1.25 * mass * mean**2 / depth**2.5
        return Hertz(stiffness, 0.5 * mass * speed**2 * (1.0 - e**2) / (LOSES * mean * depth**1.5))


def pulse_of(t: ArrayLike, force: ArrayLike) -> Pulse:
    """The largest pulse of a force history: t [n] [s], force [n] [N].

    Its ends are as far beyond the crossings of a tenth of the peak as those of a half sine are: 3.4 % of its duration.

    Raises FemstructError for a history whose pulse is not whole, or that never pushes.

    >>> t = np.linspace(-0.2, 1.5, 171)
    >>> found = pulse_of(t, 3.0 * np.sin(np.pi * t) * ((t > 0) & (t < 1)))
    >>> round(found.start, 2), round(found.duration, 2), round(found.impulse * np.pi / 6, 2)
    (0.0, 1.0, 1.0)
    """
    times = frozen("pulse times", t, (None,))
    values = frozen("pulse force", force, times.shape)
    top = int(np.argmax(values))
    peak = float(values[top])
    below = np.flatnonzero(values < FLOOR * peak)
    before, after = below[below < top], below[below > top]
    if not peak > 0.0 or not len(after):
        raise FemstructError("pulse", got="a force that does not return to zero", expected="one whole pulse")
    first, last = int(before[-1]) if len(before) else 0, int(after[0])
    rises = _crossing(times, values, first, FLOOR * peak) if len(before) else float(times[0])
    falls = _crossing(times, values, last - 1, FLOOR * peak)
    hidden = np.arcsin(FLOOR) / np.pi
    duration = float((falls - rises) / (1.0 - 2.0 * hidden))
    start = float(rises - hidden * duration)
    inside = (times >= start - 0.5 * hidden * duration) & (times <= start + (1.0 + hidden) * duration)
    return Pulse(start, duration, peak, float(np.trapezoid(values[inside], times[inside])))


def _crossing(times: Floats, values: Floats, i: int, level: float) -> float:
    """Where the straight line from sample i to the next has a level."""
    share = (level - values[i]) / (values[i + 1] - values[i])
    return float(times[i] + share * (times[i + 1] - times[i]))
