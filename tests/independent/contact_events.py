"""Bodies and modes that meet in unilateral contacts, by scipy's DOP853 with a restart at every event.

Textbook mechanics, nothing of the packages: modal coordinates with unit modal mass (or masses of their own) and point
masses, z'' = M^-1 (-K z - C z' - sum r (f - P) + loads). A contact has the indentation d = r.z - gap + d0 with
r = e_lower - e_upper, and pushes with f(d, d') while d > 0 and f > 0. Within a segment every contact is on or off,
every table on one of its pieces, every one-way dashpot closing or opening, so that the right-hand side is smooth
beyond the event, too; a segment ends where one of these changes, and the next begins there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, minimize_scalar

Floats = np.ndarray
Force = Callable[[float, float, int], float]  # of indentation, its rate, and the piece of the spring


@dataclass(frozen=True)
class Law:
    """force(d, u, piece) without a clamp; gate(d, u) > 0 where the clamp lets it push, None where it always does;
    breaks : depths at which the spring goes on along another piece."""

    force: Force
    gate: Callable[[float, float], float] | None = None
    breaks: tuple[float, ...] = ()

    def rest(self, load: float) -> float:
        """Indentation under a load at rest."""

        def miss(d: float) -> float:
            return self.force(d, 0.0, int(np.searchsorted(self.breaks, d))) - load

        top = 1e-9
        while miss(top) < 0.0:
            top *= 2.0
        return float(brentq(miss, 0.0, top, xtol=1e-18, rtol=1e-14)) if load else 0.0


def _power(d: float, exponent: float) -> float:
    return float(np.copysign(abs(d) ** exponent, d))


def linear(k: float, c: float = 0.0, tensile: bool = False) -> Law:
    """k d + c u."""
    return Law(lambda d, u, _: k * d + c * u, None if tensile or not c else lambda d, u: k * d + c * u)


def hertz(k: float, c: float = 0.0, tensile: bool = False) -> Law:
    """k d^1.5 + c d^0.5 u."""
    return Law(
        lambda d, u, _: k * _power(d, 1.5) + c * abs(d) ** 0.5 * u,
        None if tensile or not c else lambda d, u: k * d + c * u,
    )


def factored(spring: Callable[[float, int], float], chi: float, tensile: bool = False, breaks: Any = ()) -> Law:
    """s(d) (1 + chi u)."""
    return Law(
        lambda d, u, piece: spring(d, piece) * (1.0 + chi * u),
        None if tensile or not chi else lambda d, u: 1.0 + chi * u,
        tuple(breaks),
    )


def power(k: float, n: float, chi: float = 0.0, tensile: bool = False) -> Law:
    """k d^n (1 + chi u)."""
    return factored(lambda d, _: k * _power(d, n), chi, tensile)


def cubic(k: float, k3: float, chi: float = 0.0, tensile: bool = False) -> Law:
    """(k d + k3 d^3) (1 + chi u)."""
    return factored(lambda d, _: (k + k3 * d * d) * d, chi, tensile)


def table(depths: Sequence[float], forces: Sequence[float], chi: float = 0.0, tensile: bool = False) -> Law:
    """Straight lines between points, the last one going on."""
    x, y = np.asarray(depths, float), np.asarray(forces, float)
    slopes = np.diff(y) / np.diff(x)
    return factored(
        lambda d, piece: float(y[piece] + slopes[piece] * (d - x[piece])), chi, tensile, tuple(x[1:-1].tolist())
    )


def chi_of_restitution(e: float, v: float) -> float:
    """Dissipation with which s(d) (1 + chi u) parts with e times its meeting speed, for any spring.

    Of m u du = -s (1 + chi u) dd on the way in and out: integral of u du / (1 + chi u) from 0 to v equals that from
    -e v to 0, by quadrature-free antiderivatives u / chi - ln(1 + chi u) / chi^2.
    """
    if e == 1.0:
        return 0.0

    def held(u: float, chi: float) -> float:
        return u / chi - np.log1p(chi * u) / chi**2

    def miss(part: float) -> float:  # part of the limit chi e v < 1 at which nothing comes back
        chi = part / (e * v)
        return held(v, chi) - held(-e * v, chi)

    return float(brentq(miss, 1e-6, 1.0 - 1e-15, xtol=1e-15, rtol=1e-14)) / (e * v)


@dataclass(frozen=True)
class Touch:
    """A contact of an upper and a lower end, each a name or None for the ground."""

    name: str
    upper: str | None
    lower: str | None
    law: Law
    gap: float = 0.0
    preload: float = 0.0


@dataclass(frozen=True)
class Spring:
    """A spring and dashpot of an upper and a lower end; the dashpot may differ while the ends approach (closing).
    push : a constant force that drives the ends apart. since : when it begins to act, with no force but the push."""

    upper: str | None
    lower: str | None
    k: float
    closing: float = 0.0
    opening: float = 0.0
    push: float = 0.0
    since: float = 0.0


@dataclass(frozen=True)
class Push:
    """Any continuous force on an end, smooth but at its edges; positive upwards."""

    on: str
    force: Callable[[float], float]
    edges: tuple[float, ...]


@dataclass(frozen=True)
class Pulse:
    """A half sine on an end; positive upwards."""

    on: str
    amplitude: float
    frequency: float
    first: float = 0.0


@dataclass(frozen=True)
class Again:
    """A body that is lifted off and given its starting state again at these times, over an end. late : it rests before
    the first of them."""

    body: str
    over: str | None
    times: tuple[float, ...]
    late: bool = False


@dataclass(frozen=True)
class Chain:
    """Oscillators or modes, bodies, and what joins them.

    omega [rad/s], ratio, mass : of each mode; shapes : of each point, one value a mode. bodies : masses by name.
    weights : constant forces on bodies, such as -m g. start : velocities by name of a body; modal : of the modes.
    """

    omega: Sequence[float] = ()
    ratio: Sequence[float] = ()
    shapes: dict[str, Sequence[float]] = field(default_factory=dict)
    bodies: dict[str, float] = field(default_factory=dict)
    touches: Sequence[Touch] = ()
    springs: Sequence[Spring] = ()
    pulses: Sequence[Pulse] = ()
    weights: dict[str, float] = field(default_factory=dict)
    start: dict[str, float] = field(default_factory=dict)
    modal: Sequence[float] = ()
    places: dict[str, float] = field(default_factory=dict)
    again: Sequence[Again] = ()
    pushes: Sequence[Push] = ()

    @property
    def size(self) -> int:
        return len(self.omega) + len(self.bodies)

    def row(self, end: str | None) -> Floats:
        """What displaces an end."""
        row, modes = np.zeros(self.size), len(self.omega)
        if end in self.bodies:
            row[modes + list(self.bodies).index(end)] = 1.0
        elif end is not None:
            row[:modes] = self.shapes[end]
        return row


@dataclass(frozen=True)
class Path:
    """States in segments, with who was on in each."""

    chain: Chain
    segments: list[Any]  # (solution, on, pieces, from, to)

    def at(self, times: Floats) -> Floats:
        """[2 n, t] displacements and velocities."""
        ends = np.array([one[4] for one in self.segments])
        which = np.minimum(np.searchsorted(ends, times, side="left"), len(ends) - 1)
        states = np.empty((2 * self.chain.size, len(times)))
        for number in np.unique(which):
            states[:, which == number] = self.segments[number][0](times[which == number])
        return states

    def moved(self, end: str, times: Floats) -> Floats:
        """Displacement of an end."""
        return self.chain.row(end) @ self.at(times)[: self.chain.size]

    def speed(self, end: str, times: Floats) -> Floats:
        """Velocity of an end."""
        return self.chain.row(end) @ self.at(times)[self.chain.size :]

    def acceleration(self, end: str, times: Floats) -> Floats:
        """Acceleration of an end, from the forces; just after it where it jumps."""
        chain, runner = self.chain, _Run(self.chain, 1.0, np.inf)
        ends, row, states = np.array([one[4] for one in self.segments]), self.chain.row(end), self.at(times)
        which = np.minimum(np.searchsorted(ends, times, side="left"), len(ends) - 1)
        found = np.empty(len(times))
        for i, t in enumerate(times):
            y, (_, on, pieces, _, _) = states[:, i], self.segments[which[i]]
            closing = [float(span @ y[chain.size :]) < 0.0 for span in runner.spans]
            found[i] = row @ runner.slope(t, y, on, pieces, closing)[chain.size :]
        return found

    def force(self, name: str, times: Floats) -> Floats:
        """Force of a contact."""
        number = next(i for i, one in enumerate(self.chain.touches) if one.name == name)
        ends = np.array([one[4] for one in self.segments])
        which = np.minimum(np.searchsorted(ends, times, side="left"), len(ends) - 1)
        return np.array([_felt(self, which[i], number, t) for i, t in enumerate(times)])

    def peak(self, name: str, since: float = 0.0, until: float = np.inf) -> float:
        """Largest force of a contact, between two times at which segments end."""
        return self._top(name, since, until)[0]

    def peak_time(self, name: str, end: float = np.inf) -> float:
        """When it is largest up to a time; 0 of one that never pushes."""
        return self._top(name, end=end)[1]

    def peaks(self, name: str, end: float) -> list[float]:
        """Largest force of every time that it pushes, up to a time."""
        spans = [(a, b) for a, b in self.touching(name) if a < end]
        return [self._top(name, a, b, end)[0] for a, b in spans]

    def _top(self, name: str, since: float = 0.0, until: float = np.inf, end: float = np.inf) -> tuple[float, float]:
        number, most = next(i for i, one in enumerate(self.chain.touches) if one.name == name), (0.0, 0.0)
        for index, (_, on, _, t0, t1) in enumerate(self.segments):
            if not on[number] or not t1 > t0 or t0 < since or t1 > until or t0 >= end:
                continue
            times = np.linspace(t0, min(t1, end), 201)
            felt = np.array([_felt(self, index, number, t) for t in times])
            top = int(felt.argmax())
            most = max(most, (float(felt[top]), float(times[top])))
            bounds = (
                times[max(top - 1, 0)],
                times[min(top + 1, 200)],
            )  # an end's neighbour too: a dashpot's first push
            found = minimize_scalar(
                lambda t, i=index: -_felt(self, i, number, t), bounds=bounds, method="bounded",
                options={"xatol": 1e-9 * (bounds[1] - bounds[0])},
            )  # fmt: skip
            most = max(most, (-float(found.fun), float(found.x)))
        return most

    def touching(self, name: str) -> list[tuple[float, float]]:
        """From when to when a contact pushed."""
        number = next(i for i, one in enumerate(self.chain.touches) if one.name == name)
        found: list[tuple[float, float]] = []
        for _, on, _, t0, t1 in self.segments:
            if on[number] and found and found[-1][1] == t0:
                found[-1] = (found[-1][0], t1)
            elif on[number]:
                found.append((t0, t1))
        return found


def rises(path: Path, name: str) -> list[tuple[float, float]]:
    """From when to when a preloaded contact pushes by more than its preload."""
    touch = next(one for one in path.chain.touches if one.name == name)
    floor = 1e-7 * path.peak(name)  # at rest it pushes with the preload but for rounding
    found: list[tuple[float, float]] = []
    up, last = False, 0.0

    def more(t: float) -> float:
        return float(path.force(name, np.array([t]))[0]) - touch.preload

    for _, _, _, t0, t1 in path.segments:
        times = np.linspace(t0, t1, 80)[1:]
        for t, size in zip(times, path.force(name, times) - touch.preload, strict=True):
            if abs(size) > floor:
                if (size > 0) != up:
                    crossed = brentq(more, last, t, xtol=1e-14 * t1) if (more(last) > 0) != (size > 0) else last
                    found = [*found, (crossed, np.inf)] if size > 0 else [*found[:-1], (found[-1][0], crossed)]
                    up = not up
                last = float(t)
    return found


def _felt(path: Path, index: int, number: int, t: float) -> float:
    """Force of a contact within a segment."""
    solution, on, pieces, _, _ = path.segments[index]
    if not on[number]:
        return 0.0
    touch, z, n = path.chain.touches[number], solution(t), path.chain.size
    row = path.chain.row(touch.lower) - path.chain.row(touch.upper)
    depth = row @ z[:n] - touch.gap + touch.law.rest(touch.preload)
    return touch.law.force(depth, row @ z[n:], pieces[number])


def run(chain: Chain, duration: float, rtol: float = 1e-11, max_step: float = np.inf) -> Path:
    """The motion from 0 to a duration."""
    return _Run(chain, rtol, max_step).until(duration)


class _Run:
    def __init__(self, chain: Chain, rtol: float, max_step: float) -> None:
        self.chain, self.rtol, self.max_step = chain, rtol, max_step
        self.mass = np.concatenate([np.ones(len(chain.omega)), list(chain.bodies.values())])
        omega, bare = np.asarray(chain.omega, float), np.zeros(len(chain.bodies))
        self.stiff = np.concatenate([omega**2, bare])
        self.damp = np.concatenate([2.0 * np.asarray(chain.ratio, float) * omega, bare])
        self.rows = [chain.row(one.lower) - chain.row(one.upper) for one in chain.touches]
        self.rests = [one.law.rest(one.preload) for one in chain.touches]
        self.spans = [chain.row(one.upper) - chain.row(one.lower) for one in chain.springs]
        self.unstretched = [0.0] * len(self.spans)
        self.acting = [not one.since for one in chain.springs]
        self.constant = sum((force * chain.row(name) for name, force in chain.weights.items()), np.zeros(chain.size))

    def depth(self, number: int, y: Floats) -> float:
        n, touch = self.chain.size, self.chain.touches[number]
        return float(self.rows[number] @ y[:n]) - touch.gap + self.rests[number]

    def rate(self, number: int, y: Floats) -> float:
        return float(self.rows[number] @ y[self.chain.size :])

    def slope(self, t: float, y: Floats, on: list[bool], pieces: list[int], closing: list[bool]) -> Floats:
        n = self.chain.size
        z, v = y[:n], y[n:]
        pushed = self.constant - self.stiff * z - self.damp * v
        for number, touch in enumerate(self.chain.touches):
            felt = touch.law.force(self.depth(number, y), self.rate(number, y), pieces[number]) if on[number] else 0.0
            if felt or touch.preload:
                pushed = pushed - self.rows[number] * (felt - touch.preload)
        for number, (span, spring, shut) in enumerate(zip(self.spans, self.chain.springs, closing, strict=True)):
            if self.acting[number]:
                held = spring.k * (span @ z - self.unstretched[number]) - spring.push
                pushed = pushed - span * (held + (spring.closing if shut else spring.opening) * (span @ v))
        for push in self.chain.pushes:
            pushed = pushed + self.chain.row(push.on) * push.force(t)
        for pulse in self.chain.pulses:
            if 0.0 <= t - pulse.first <= 0.5 / pulse.frequency:
                pushed = pushed + self.chain.row(pulse.on) * pulse.amplitude * np.sin(
                    2.0 * np.pi * pulse.frequency * (t - pulse.first)
                )
        return np.concatenate([v, pushed / self.mass])

    def events(self, on: list[bool], inside: list[bool], pieces: list[int], closing: list[bool]) -> list[Any]:
        """(function, direction, what it changes)."""
        found: list[Any] = []
        for number, touch in enumerate(self.chain.touches):
            found.append((lambda y, a=number: self.depth(a, y), -1.0 if inside[number] else 1.0, ("inside", number)))
            gate = touch.law.gate
            if inside[number] and gate is not None:
                found.append(
                    (
                        lambda y, a=number, g=gate: g(self.depth(a, y), self.rate(a, y)),
                        -1.0 if on[number] else 1.0,
                        ("gate", number),
                    )
                )
            for step, edge in enumerate(touch.law.breaks):
                if inside[number] and step in (pieces[number] - 1, pieces[number]):
                    above = step == pieces[number]  # the edge is ahead
                    found.append(
                        (
                            lambda y, a=number, e=edge: self.depth(a, y) - e,
                            1.0 if above else -1.0,
                            ("piece", number, 1 if above else -1),
                        )
                    )
        for number, spring in enumerate(self.chain.springs):
            if spring.closing != spring.opening:
                found.append(
                    (
                        lambda y, a=number: float(self.spans[a] @ y[self.chain.size :]),
                        1.0 if closing[number] else -1.0,
                        ("way", number),
                    )
                )
        return found

    def until(self, duration: float) -> Path:
        chain = self.chain
        late = {one.body for one in chain.again if one.late}
        first = [0.0 if name in late else chain.start.get(name, 0.0) for name in chain.bodies]
        speeds = np.concatenate([chain.modal or np.zeros(len(chain.omega)), first])
        at = [chain.places.get(name, 0.0) for name in chain.bodies]
        y = np.concatenate([np.zeros(len(chain.omega)), at, speeds])
        on, inside, pieces, closing = self.state(y)
        edges = {one.first for one in chain.pulses} | {one.first + 0.5 / one.frequency for one in chain.pulses}
        edges |= {one.since for one in chain.springs if one.since} | {t for one in chain.pushes for t in one.edges}
        edges = sorted(edges | {time for one in chain.again for time in one.times})
        segments: list[Any] = []
        t = 0.0
        scale = max(np.abs(speeds).max(initial=0.0), 1e-3)
        while t < duration:
            end = next((edge for edge in edges if edge > t * (1 + 1e-14)), duration)
            end = min(end, duration)
            for number, spring in enumerate(chain.springs):
                if not self.acting[number] and t >= spring.since:
                    self.acting[number], self.unstretched[number] = True, float(self.spans[number] @ y[: chain.size])
            watched = self.events(on, inside, pieces, closing)
            functions = []
            for function, direction, _ in watched:
                # what stands exactly on the edge has not crossed it yet
                event: Any = lambda _, y, f=function, d=direction: f(y) or -1e-300 * d  # noqa: E731
                event.terminal, event.direction = True, direction
                functions.append(event)
            state = (list(on), list(pieces), list(closing))
            solved = solve_ivp(
                lambda t, y, s=state: self.slope(t, y, *s), (t, end), y, "DOP853", events=functions or None,
                rtol=self.rtol, atol=1e-15 * scale, dense_output=True, max_step=self.max_step,
            )  # fmt: skip
            segments.append((solved.sol, state[0], state[1], t, float(solved.t[-1])))
            t, y = float(solved.t[-1]), solved.y[:, -1]
            if any(t in one.times for one in chain.again):
                y = self.lifted(t, y)
                on, inside, pieces, closing = self.state(y)
            elif solved.status == 1:
                hit = [watched[i][2] for i, times in enumerate(solved.t_events) if len(times) and times[-1] == t]
                for what in hit:
                    self.change(what, y, on, inside, pieces, closing)
            if len(segments) > 5000:
                raise RuntimeError(f"5000 events up to {t:g} s")
        return Path(chain, segments)

    def state(self, y: Floats) -> tuple[list[bool], list[bool], list[int], list[bool]]:
        """Who pushes, who is indented, on which piece, and which dashpots close, at the start or after a jump."""
        touches = self.chain.touches
        depths = [self.depth(i, y) for i in range(len(touches))]
        rates = [self.rate(i, y) for i in range(len(touches))]
        inside = [d > 1e-15 or (abs(d) <= 1e-15 and u > 0.0) for d, u in zip(depths, rates, strict=True)]
        on = [
            held and (one.law.gate is None or one.law.gate(d, u) > 0.0)
            for held, one, d, u in zip(inside, touches, depths, rates, strict=True)
        ]
        pieces = [int(np.searchsorted(one.law.breaks, d)) for one, d in zip(touches, depths, strict=True)]
        return on, inside, pieces, [float(span @ y[self.chain.size :]) < 0.0 for span in self.spans]

    def lifted(self, t: float, y: Floats) -> Floats:
        """Bodies whose time it is stand over their ends again."""
        y, n = y.copy(), self.chain.size
        for one in self.chain.again:
            if t in one.times:
                at = len(self.chain.omega) + list(self.chain.bodies).index(one.body)
                y[at] = self.chain.row(one.over) @ y[:n]
                y[n + at] = self.chain.start.get(one.body, 0.0)
        return y

    def change(self, what: Any, y: Floats, on: Any, inside: Any, pieces: Any, closing: Any) -> None:
        """What an event changes."""
        kind, number = what[0], what[1]
        if kind == "way":
            closing[number] = not closing[number]
        elif kind == "piece":
            pieces[number] += what[2]
        elif kind == "gate":
            on[number] = not on[number]
        else:
            inside[number] = not inside[number]
            pieces[number] = 0
            gate = self.chain.touches[number].law.gate
            on[number] = inside[number] and (gate is None or gate(0.0, self.rate(number, y)) > 0.0)
