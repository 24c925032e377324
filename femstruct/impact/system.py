"""A scene compiled to arrays: every contact, link and load is a row over the coordinates [modes; bodies]."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.compiled.records import (
    CONSTANT,
    HALF_SINE,
    INTERFACE,
    LINK,
    LOAD,
    NUMBERS,
    STRIKE,
    TABLE,
    InterfaceRecord,
    LoadRecord,
    Records,
    StrikeRecord,
    System,
    uncoupled,
)
from femstruct.errors import FemstructError
from femstruct.impact.propagation import FINEST_HALVINGS
from femstruct.impact.scene import Clock, Contact, End, Ground, HalfSine, Link, Load, Scene
from femstruct.laws.law import Law
from femstruct.laws.registry import CODES
from femstruct.laws.registry import force as force_of
from femstruct.modal.basis import ModalBasis
from femstruct.modal.oscillators import Oscillators, oscillators_of, under_forces
from femstruct.model.probe import Probe

SETTLED: Final = 1e-9  # of a preload: what rounding makes of it


@dataclass(frozen=True, eq=False)
class Compiled:
    """A System, the start of its coordinates, and which rows carry which name.

    start [2, n]; scale [n] : coordinate over displacement (1 for modes, sqrt(m) for bodies). rows [r, K + b] : over
    modes and bodies, whatever couples them; oscillators : of modes that damping couples, None where it couples none.
    contacts : rows of a contact by name (two for a stop); links : row of a link by name.
    """

    system: System
    start: Floats
    scale: Floats
    contacts: Mapping[str, tuple[int, ...]]
    links: Mapping[str, int]
    n_samples: int
    halvings: int
    rows: Floats
    oscillators: Oscillators | None

    @property
    def pushed(self) -> Floats:
        """The rows over the modes alone [r, K]."""
        bodies = len(self.system.omega) - self.system.n_modes
        return self.rows[:, : self.rows.shape[1] - bodies]

    @property
    def turn(self) -> Floats:
        """Places, tilts, swings and rates of the oscillators [4, K, k], empty without."""
        return np.zeros((4, 0, 0)) if self.oscillators is None else self.oscillators.turn


def compile_scene(basis: ModalBasis, scene: Scene, clock: Clock, finest: int = FINEST_HALVINGS) -> Compiled:
    """The scene as rows over [modes; bodies].

    Parameters
    ----------
    finest : int
        Halvings of the sampling interval to a tick, at most.

    Raises
    ------
    FemstructError
        For a name used twice, an end that is no body, a preloaded stop, a modal velocity of the wrong length, or
        nothing that could move.
    """
    n_samples, halvings, tick = _ticks(clock, finest)
    on = _coordinates(basis, scene, tick)
    k, bodies = len(basis.omega), on.bodies
    interfaces = _Interfaces()
    contact_rows = {contact.name: interfaces.add_contact(contact, on) for contact in scene.contacts}
    link_rows = {link.name: interfaces.add_link(link, on) for link in scene.links}
    loads = _Loads()
    bends = [loads.add(load, on, clock.duration) for load in scene.loads]
    weights = loads.add_weights(scene, on)
    _refuse_held(scene, bodies)
    strikes = _strikes(scene, bodies, k, on.scale, tick, n_samples << halvings)
    over = [
        on.row(blows.over, f"bodies.{blows.body}.blows") * on.scale[k + bodies[blows.body]] for blows in scene.blows
    ]
    releases = {round(link.release_at / tick) for link in scene.links}
    kinks = releases.union(weights, {int(strike["tick"]) for strike in strikes}, *bends)

    matrix = np.array(interfaces.rows + loads.rows).reshape(-1, len(on.scale))
    damping = basis.own_damping
    system = System(
        omega=np.concatenate((basis.omega, np.zeros(len(bodies)))),
        damping=np.append(damping, np.zeros(len(bodies))),
        n_modes=k,
        rows=np.ascontiguousarray(matrix),
        sign=np.concatenate((-np.ones(len(interfaces.rows)), np.ones(len(loads.rows)))),
        mobility=(matrix**2).sum(axis=1),
        interfaces=np.array(interfaces.laws, dtype=INTERFACE),
        curves=np.concatenate((np.zeros((0, NUMBERS)), *interfaces.curves)),
        loads=np.array(loads.laws, dtype=LOAD),
        table=np.array([loads.times, loads.values], dtype=np.float64).T.copy(),
        strikes=strikes,
        over=np.array(over, dtype=np.float64).reshape(-1, len(on.scale)),
        kinks=np.array(sorted(kink for kink in kinks if kink > 0), dtype=np.int64),
        tick=tick,
        tilts=np.zeros((0, 0)),
        kicks=np.zeros((0, 0)),
        drives=np.zeros((0, 0)),
        over_tilts=np.zeros((0, 0)),
        modes=np.zeros(0),
        turn=np.zeros((0, 0, 0)),
        surplus=np.zeros((0, 0)),
        misses=np.zeros(0),
        reach=np.array([np.max(basis.omega, initial=0.0) ** 2, np.max(damping, initial=0.0)]),
    )
    _settle(system)
    start, scale, found = _start(scene, on), on.scale, oscillators_of(basis)
    if found is not None:
        if not start[1, :k].any():
            found = under_forces(found, matrix[:, :k])
        system, start = uncoupled(system, start, found)
        scale = np.append(np.ones(system.n_modes), on.scale[k:])
    return Compiled(
        system,
        start,
        scale=scale,
        contacts=contact_rows,
        links=link_rows,
        n_samples=n_samples,
        halvings=halvings,
        rows=matrix,
        oscillators=found,
    )


def _settle(system: System) -> None:
    """Preloads as the laws have them at rest: the last digit beside the one that is given would be a force for ever."""
    for a, one in enumerate(system.interfaces):
        if one["kind"] != LINK and one["preload"] > 0.0:
            held = force_of(system, a, float(one["offset"]), 0.0)[0]
            if abs(held - one["preload"]) < SETTLED * one["preload"]:
                system.interfaces["preload"][a] = held


A_PLACE: Final = 'a place of the structure is a Probe, model.points["NAME"].probe("z")'


@dataclass(frozen=True, eq=False)
class _Coordinates:
    """Modes, then bodies by name. scale [n] : as in `Compiled`; first_blow : its tick, by body that strikes again."""

    basis: ModalBasis
    bodies: Mapping[str, int]
    scale: Floats
    first_blow: Mapping[str, int]
    tick: float

    def row(self, end: End, where: str) -> Floats:
        """How an end moves with the coordinates [n]."""
        k = len(self.basis.omega)
        values = np.zeros(len(self.scale))
        if isinstance(end, Probe):
            values[:k] = end.of(self.basis.shapes)
        elif isinstance(end, str):
            if end not in self.bodies:
                known = ", ".join(self.bodies) or "there is none"
                raise FemstructError(where, got=f"'{end}'", expected=f"a body: {known}", do=A_PLACE)
            values[k + self.bodies[end]] = 1.0 / self.scale[k + self.bodies[end]]
        else:
            assert isinstance(end, Ground)
        return values

    def approach(self, upper: End, lower: End, where: str) -> Floats:
        return self.row(lower, where) - self.row(upper, where)


def _coordinates(basis: ModalBasis, scene: Scene, tick: float) -> _Coordinates:
    k, bodies = len(basis.omega), {body.name: i for i, body in enumerate(scene.bodies)}
    _refuse_duplicates("bodies", [body.name for body in scene.bodies])
    _refuse_duplicates("contacts and links", [c.name for c in scene.contacts] + [link.name for link in scene.links])
    if k + len(bodies) == 0:
        raise FemstructError("scene", got="no mode and no body", expected="something that moves")
    scale = np.concatenate((np.ones(k), np.sqrt([body.mass for body in scene.bodies])))
    return _Coordinates(basis, bodies, scale, {b.body: round(float(b.times[0]) / tick) for b in scene.blows}, tick)


def _start(scene: Scene, on: _Coordinates) -> Floats:
    """Displacements and velocities of the coordinates at the start [2, n]; bodies that strike again still lie."""
    k = len(on.basis.omega)
    velocity = np.zeros(k) if scene.velocity is None else np.asarray(scene.velocity, dtype=np.float64)
    if velocity.shape != (k,):
        raise FemstructError("scene velocity", got=f"shape {velocity.shape}", expected=f"({k},)")
    start = np.zeros((2, len(on.scale)))
    moving = [body.velocity if on.first_blow.get(body.name, 0) == 0 else 0.0 for body in scene.bodies]
    start[1] = np.concatenate((velocity, moving)) * on.scale
    return start


class _Interfaces:
    """Rows and laws of contacts and links while they are collected."""

    def __init__(self) -> None:
        self.rows: list[Floats] = []
        self.laws: list[InterfaceRecord] = []
        self.curves: list[Floats] = []

    def add_contact(self, contact: Contact, on: _Coordinates) -> tuple[int, ...]:
        """A row for each side on which its law acts; returns their numbers."""
        where, law, first = f"contacts.{contact.name}", contact.law, len(self.rows)
        approach = on.approach(contact.upper, contact.lower, where)
        if len(law.sides) > 1 and contact.preload:
            raise FemstructError(where, got="a preload on a stop", expected="none", do="replace it by a contact")
        static_indentation = law.indentation(contact.preload) if contact.preload else 0.0
        release = max(on.first_blow.get(e, 0) if isinstance(e, str) else 0 for e in (contact.upper, contact.lower))
        for side in law.sides:
            self._add(side * approach, law, static_indentation - contact.gap, contact.preload, release)
        return tuple(range(first, len(self.rows)))

    def add_link(self, link: Link, on: _Coordinates) -> int:
        """Returns the number of its row."""
        self.rows.append(on.approach(link.upper, link.lower, f"links.{link.name}"))
        release = round(link.release_at / on.tick)
        self.laws.append(
            InterfaceRecord(
                kind=LINK,
                straight=True,
                stiffness=link.stiffness,
                closing=link.closing,
                opening=link.opening,
                preload=link.preload,
                release=release,
            )
        )
        return len(self.rows) - 1

    def _add(self, row: Floats, law: Law, offset: float, preload: float, release: int) -> None:
        self.rows.append(row)
        stored, first = law.stored, sum(map(len, self.curves))
        self.curves.append(stored.rows)
        self.laws.append(
            InterfaceRecord(
                kind=CODES.index(law.code),
                factor=law.code.force is None,
                straight=law.straight,
                stiffness=stored.stiffness,
                closing=stored.damping,
                opening=stored.damping,
                offset=offset,
                preload=preload,
                tensile=law.tensile,
                release=release,
                shape=stored.shape,
                first=first,
                length=len(stored.rows),
                force_at=stored.force_at,
                energy_at=stored.energy_at,
            )
        )


class _Loads:
    """Rows and histories of loads while they are collected."""

    def __init__(self) -> None:
        self.rows: list[Floats] = []
        self.laws: list[LoadRecord] = []
        self.times: list[float] = []
        self.values: list[float] = []

    def add(self, load: Load, on: _Coordinates, duration: float) -> set[int]:
        """Returns the ticks at which its formula changes."""
        self.rows.append(on.row(load.on, f"loads.{load.name}"))
        history = load.history
        if isinstance(history, HalfSine):
            bends = np.array([0.0, 0.5 / history.frequency])
            law = LoadRecord(HALF_SINE, load.first, value=history.amplitude, frequency=history.frequency)
        else:
            bends = np.asarray(history.times)
            law = LoadRecord(TABLE, load.first, first=len(self.times), length=len(bends))
            self.times.extend(history.times)
            self.values.extend(history.values)
        self.laws.append(law._replace(every=load.every, repeats=load.count, span=bends[-1]))
        starts = load.first + load.every * np.arange(load.count)
        changes = np.add.outer(starts[starts < duration], bends).ravel()
        return set(np.rint(changes[changes < duration] / on.tick).astype(np.int64).tolist())

    def add_weights(self, scene: Scene, on: _Coordinates) -> set[int]:
        """One load for all bodies that begin to fall at one tick; returns these ticks."""
        since = [on.first_blow.get(body.name, 0) for body in scene.bodies]
        falling = {at for at, body in zip(since, scene.bodies, strict=True) if body.falls} if scene.gravity else set()
        for begin in sorted(falling):
            falls = [float(body.falls and at == begin) for at, body in zip(since, scene.bodies, strict=True)]
            self.rows.append(np.concatenate((np.zeros(len(on.basis.omega)), falls)) * on.scale)
            self.laws.append(LoadRecord(CONSTANT, begin * on.tick, value=-scene.gravity))
        return falling


def _strikes(scene: Scene, bodies: Mapping[str, int], k: int, scale: Floats, tick: float, end: int) -> Records:
    """All blows before the end, in the order of time; those of one instant in the order of the scene."""
    found = []
    for number, blows in enumerate(scene.blows):
        i = bodies[blows.body]
        velocity = scene.bodies[i].velocity * scale[k + i]
        ticks = np.rint(blows.times / tick)
        times = ticks[ticks < end].astype(np.int64)  # later ones may be beyond whole numbers
        found += [StrikeRecord(int(at), over=number, coordinate=k + i, velocity=velocity) for at in times]
    return np.array(sorted(found, key=lambda strike: strike.tick), dtype=STRIKE)


def _refuse_held(scene: Scene, bodies: Mapping[str, int]) -> None:
    """A body that is lifted again and again is held by nothing but its contacts."""
    _refuse_duplicates("blows", [blows.body for blows in scene.blows])
    for blows in scene.blows:
        where = f"bodies.{blows.body}.blows"
        if blows.body not in bodies:
            raise FemstructError(where, got=f"'{blows.body}'", expected=f"a body: {', '.join(bodies)}")
        held = [link.name for link in scene.links if blows.body in (link.upper, link.lower)]
        held += [c.name for c in scene.contacts if c.preload and blows.body in (c.upper, c.lower)]
        if held:
            raise FemstructError(
                where,
                got=f"a body that '{held[0]}' holds",
                expected="a free body: it is lifted off at every blow",
                do="remove its link or preload, or its blows",
            )


def _ticks(clock: Clock, finest: int) -> tuple[int, int, float]:
    """Number of samples, halvings of the sampling interval to a tick, tick [s]."""
    n_samples = max(round(clock.duration * clock.sampling), 1)
    halvings = min(finest, 61 - n_samples.bit_length())
    return n_samples, halvings, 1.0 / clock.sampling / 2.0**halvings


def _refuse_duplicates(where: str, names: list[str]) -> None:
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise FemstructError(where, got=f"'{twice[0]}' twice", expected="different names")
