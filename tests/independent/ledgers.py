"""Where the energy of a motion by events is: what moves, springs and contacts hold, what all took and loads gave.

Each term by itself: a contact takes what is done on it less what its spring holds; none is what is left over.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.integrate import quad

from tests.independent.contact_events import Floats, Path, Touch

_GAUSS = np.polynomial.legendre.leggauss(6)


@dataclass(frozen=True)
class Ledger:
    """Energies [J] at one time, by name."""

    bodies: dict[str, float]
    structure: float
    stored: float
    modes: float
    contacts: dict[str, float]
    links: list[float]
    work: float
    blows: float

    @property
    def taken(self) -> float:
        return self.modes + sum(self.contacts.values()) + sum(self.links)

    @property
    def total(self) -> float:
        return sum(self.bodies.values()) + self.structure + self.stored + self.taken - self.work - self.blows


def spring_energy(touch: Touch, depth: float) -> float:
    """What the spring of a contact holds at an indentation, by quadrature along its pieces."""
    if depth <= 0.0:
        return 0.0
    edges = [0.0, *(one for one in touch.law.breaks if one < depth), depth]
    return float(sum(quad(lambda d, p=piece: touch.law.force(d, 0.0, p), low, high, epsabs=0, epsrel=1e-12)[0]
                     for piece, (low, high) in enumerate(pairwise(edges))))  # fmt: skip


def ledger_at(path: Path, until: float) -> Ledger:
    """All terms at a time: a motion's integrals over every step of the solution up to it."""
    chain, n, modes = path.chain, path.chain.size, len(path.chain.omega)
    omega, ratio = np.asarray(chain.omega, float), np.asarray(chain.ratio, float)
    masses = np.concatenate([np.ones(modes), list(chain.bodies.values())])
    rows = [chain.row(one.lower) - chain.row(one.upper) for one in chain.touches]
    spans = [chain.row(one.upper) - chain.row(one.lower) for one in chain.springs]
    lost, links, by_modes, work = np.zeros(len(rows)), np.zeros(len(spans)), 0.0, 0.0
    blows, begun, stretched = 0.0, {}, {}
    for index, (solution, on, pieces, t0, t1) in enumerate(path.segments):
        if t0 >= until:
            break
        if index and any(t0 in one.times for one in chain.again):
            blows += _brought(path, index, masses)
        for number, spring in enumerate(chain.springs):
            if number not in begun and t0 >= spring.since:
                begun[number], stretched[number] = t0, float(spans[number] @ solution(t0)[:n])
        stops = np.array([t0, *(t for t in solution.ts if t0 < t < min(t1, until)), min(t1, until)])
        times = (stops[:-1, None] + np.diff(stops)[:, None] * (1 + _GAUSS[0]) / 2).ravel()
        dt = (np.diff(stops)[:, None] * _GAUSS[1] / 2).ravel()
        states = solution(times)
        z, v = states[:n], states[n:]
        by_modes += float((2 * ratio * omega) @ v[:modes] ** 2 @ dt)
        for number, touch in enumerate(chain.touches):
            if on[number]:
                depths, rates = _depth(touch, rows[number], z), rows[number] @ v
                pairs = zip(depths, rates, strict=True)
                felt = [touch.law.force(float(d), float(u), pieces[number]) for d, u in pairs]
                lost[number] += float((np.array(felt) * rates) @ dt)
        for number in begun:
            spring, rates = chain.springs[number], spans[number] @ v
            links[number] += float((np.where(rates < 0, spring.closing, spring.opening) * rates**2) @ dt)
        work += float(_given(path, times, v) @ dt)
    y = path.at(np.array([until]))[:, 0]
    z, v = y[:n], y[n:]
    stored = 0.0
    for number, touch in enumerate(chain.touches):
        rest, depth = touch.law.rest(touch.preload), _depth(touch, rows[number], z)
        held = spring_energy(touch, float(depth)) - spring_energy(touch, rest)
        jumped = _jumped(path, number, until)
        lost[number] -= held - jumped
        blows += jumped
        stored += held - touch.preload * float(rows[number] @ z - touch.gap)
    for number, spring in enumerate(chain.springs):
        moved = float(spans[number] @ z) - stretched[number] if number in begun else 0.0
        held = spring.push**2 / 2 / spring.k if spring.k else 0.0
        stored += spring.k * moved**2 / 2 - spring.push * moved + held
    kinetic = masses * v**2 / 2
    return Ledger(
        dict(zip(chain.bodies, kinetic[modes:].tolist(), strict=True)),
        float(kinetic[:modes].sum() + ((omega * z[:modes]) ** 2).sum() / 2), stored, by_modes,
        {one.name: float(size) for one, size in zip(chain.touches, lost, strict=True)}, links.tolist(), work, blows,
    )  # fmt: skip


def _depth(touch: Touch, row: Floats, z: Floats) -> Floats:
    return np.asarray(row @ z[: len(row)] - touch.gap + touch.law.rest(touch.preload))


def _given(path: Path, times: Floats, v: Floats) -> Floats:
    """Power of weights and loads."""
    chain, power = path.chain, np.zeros(len(times))
    for name, size in chain.weights.items():
        power += size * (chain.row(name) @ v)
    for push in chain.pushes:
        power += np.array([push.force(float(t)) for t in times]) * (chain.row(push.on) @ v)
    for pulse in chain.pulses:
        since = times - pulse.first
        acts = (since >= 0) & (since <= 0.5 / pulse.frequency)
        power += acts * pulse.amplitude * np.sin(2 * np.pi * pulse.frequency * since) * (chain.row(pulse.on) @ v)
    return power


def _brought(path: Path, index: int, masses: Floats) -> float:
    """Kinetic energy that a lift changes."""
    n, t = path.chain.size, path.segments[index][3]
    before, after = path.segments[index - 1][0](t), path.segments[index][0](t)
    return float(masses @ (after[n:] ** 2 - before[n:] ** 2)) / 2


def _jumped(path: Path, number: int, until: float) -> float:
    """What lifts took out of the spring of a contact: nothing of one that is open then."""
    touch, found = path.chain.touches[number], 0.0
    row, n = path.chain.row(touch.lower) - path.chain.row(touch.upper), path.chain.size
    for index, (solution, _, _, t, _) in enumerate(path.segments):
        if index and t < until and any(t in one.times for one in path.chain.again):
            before = path.segments[index - 1][0](t)
            found += spring_energy(touch, float(_depth(touch, row, solution(t)[:n])))
            found -= spring_energy(touch, float(_depth(touch, row, before[:n])))
    return found
