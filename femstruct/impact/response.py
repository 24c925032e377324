"""Response: what happened in an impact, and where its energy went."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from math import inf
from types import MappingProxyType
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats, Integers
from femstruct.errors import FemstructError, Finding
from femstruct.impact.motion import (
    DISPLACEMENT,
    VELOCITY,
    Motion,
    coordinates,
    modal_motion,
    modal_states,
    weighted_motion,
)
from femstruct.impact.scene import Clock, Contact, End, Ground, Scene
from femstruct.modal.basis import ModalBasis
from femstruct.model.probe import Probe
from femstruct.reported import Reported
from femstruct.tags import stored_as

_TIME = ("time",)  # the axis of histories in the results file


@stored_as("outcome/1")
class Outcome(Enum):
    """How a simulation ended; the value is the sentence to show."""

    SEPARATED = "All contacts opened and stayed open to the end."
    CLOSED_AT_END = "A contact is closed at the end of the window: the collision is not over."
    RESTING = "Bodies under gravity came to rest on their contacts."
    HELD = "Contacts that were closed at the start are at rest; no other is closed."
    TOGETHER = "Bodies that a contact with restitution 0 joins stay together to the end."
    NEVER_TOUCHED = "No contact ever closed."
    NO_CONTACTS = "There is no contact: a forced or free vibration."


@stored_as("contact event/1")
@dataclass(frozen=True)
class Event:
    """A contact closed or opened: time [s], contact name, "closes" or "opens".

    Open is: without force (a clamped dashpot may end it before the indentation), or below the preload.
    """

    t: Annotated[float, Reported("s", "When", "time")]
    contact: Annotated[str, Reported("1", "Which contact")]
    what: Annotated[str, Reported("1", "closes or opens")]


@stored_as("contact history/1")
@dataclass(frozen=True, eq=False)
class ContactHistory:
    """One contact over the window: force [nt] [N], indentation [nt] [m] (negative when open), both at the samples;
    peak_force [N] and peak_time [s] from the dense solution; closings beyond rounding; first_open [s] or None."""

    force: Annotated[Floats, Reported("N", "Contact force, compressive", along=_TIME)]
    indentation: Annotated[Floats, Reported("m", "Indentation, negative when open", along=_TIME)]
    peak_force: Annotated[float, Reported("N", "Peak force, between the samples too", "peak_force_n")]
    peak_time: Annotated[float, Reported("s", "Time of the peak force", "peak_time_s")]
    closings: Annotated[int, Reported("1", "How often the contact closed, a preloaded one: rose above its preload")]
    first_open: Annotated[float | None, Reported("s", "First opening after a closing", "first_open_s")]


@stored_as("body history/1")
@dataclass(frozen=True, eq=False)
class BodyHistory:
    """One body: displacement [nt] [m], velocity [nt] [m/s], acceleration [nt] [m/s^2] along its axis, at the samples;
    end_velocity [m/s] at the end of the window, an interval after the last of them."""

    displacement: Annotated[Floats, Reported("m", "Displacement", along=_TIME)]
    velocity: Annotated[Floats, Reported("m/s", "Velocity", along=_TIME)]
    acceleration: Annotated[Floats, Reported("m/s^2", "Acceleration", along=_TIME)]
    end_velocity: Annotated[float, Reported("m/s", "Velocity at the end of the window")]

    @property
    def travel(self) -> Annotated[float, Reported("m", "Distance between its furthest places")]:
        """Distance between its furthest places [m]."""
        return float(self.displacement.max() - self.displacement.min())


@stored_as("blow/1")
@dataclass(frozen=True)
class Blow:
    """One blow of a body that strikes several times; interval [s] : to the next blow of any body, after the last one
    as long as the body waits between two, at most to the end of the window (`seen` is False where that cuts it).

    t [s] : when it is given its starting state. energy [J], impulse [N s] : what it brings then less what it takes
    along when it is lifted off (the first blow at t = 0 brings what the run starts with). peak_force [N] at peak_time
    [s] of its contacts, and how often they close, until its own next blow.
    largest_energy, left_energy [J] : of the structure in the interval and at its end. rest_after [s] : when the
    structure's energy is below 1 % of the largest for good, None when not in the interval.
    held_force [N] : contact force at the lift that ends this blow, and since when the contact is closed: 0 and None
    when it is open, as it should be.
    """

    body: str
    number: Annotated[int, Reported("1", "Number among the blows of its body")]
    t: Annotated[float, Reported("s", "When it is given its starting state", "t_s")]
    energy: Annotated[float, Reported("J", "What it brings less what it takes along when lifted off", "input_j")]
    impulse: Annotated[float, Reported("N s", "Momentum it brings less what it takes along", "impulse_ns")]
    peak_force: Annotated[float, Reported("N", "Peak contact force until its next blow", "peak_force_n")]
    peak_time: Annotated[float, Reported("s", "Time of the peak force", "peak_time_s")]
    closings: Annotated[int, Reported("1", "How often its contacts close until its next blow")]
    largest_energy: Annotated[
        float, Reported("J", "Largest energy of the structure in the interval", "structure_largest_j")
    ]
    left_energy: Annotated[float, Reported("J", "Energy of the structure at its end", "structure_left_j")]
    rest_after: Annotated[
        float | None,
        Reported("s", "From when on less than 1 % of that is left", "rest_after_s"),
    ]
    interval: Annotated[float, Reported("s", "To the next blow of any body", "interval_s")]
    seen: bool
    held_force: Annotated[float, Reported("N", "Contact force when it is lifted off; 0 when open", "held_force_n")]
    held_since: float | None


@stored_as("energy balance/1")
@dataclass(frozen=True)
class EnergyBalance:
    """Energy at one instant t [s], in J: every term integrated or evaluated by itself, none a remainder.

    bodies : kinetic energy by name (gravity is in the work). structure : kinetic and elastic energy of the modes.
    contacts, links : stored energy by name, from zero at rest; a link's preload counts from the start.
    lost_modes (all damping of the structure, its own dashpots too), lost_contacts, lost_links : dissipated until t.
    work : done by loads and gravity until t. blows : what repeated blows brought until t, less what bodies took along
    when they were lifted off; lifting works against no weight, gravity works on bodies only while they move.
    """

    t: float
    bodies: Mapping[str, float]
    structure: float
    contacts: Mapping[str, float]
    links: Mapping[str, float]
    lost_modes: float
    lost_contacts: Mapping[str, float]
    lost_links: Mapping[str, float]
    work: float
    blows: float

    @property
    def dissipated(self) -> float:
        """All losses until t [J]."""
        return self.lost_modes + sum(self.lost_contacts.values()) + sum(self.lost_links.values())

    @property
    def total(self) -> float:
        """Stored and dissipated energy less work and blows since the start [J]: constant when the ledger closes."""
        stored = sum(self.bodies.values()) + sum(self.contacts.values()) + sum(self.links.values()) + self.structure
        return stored + self.dissipated - self.work - self.blows


@stored_as("energy ledger/1")
@dataclass(frozen=True, eq=False)
class EnergyLedger:
    """Energies over time, each term by itself [J].

    start, end : balances at t = 0 and at the end. at_separation : at the end of the collision (the first instant after
    the first closing at which all contacts are open and none closes again within `quiet`), None if never.
    t [m] and the histories [m] are for pictures: bodies, structure, stored (contacts and links), lost_modes,
    lost_contacts and lost_links by name, work, blows. At a blow there are two rows, before and after.
    residual : largest |total(t) - total(0)| over the larger of the starting energy and what work and blows
    brought [1].
    """

    start: EnergyBalance
    at_separation: EnergyBalance | None
    end: EnergyBalance
    t: Floats
    bodies: Mapping[str, Floats]
    structure: Annotated[Floats, Reported("J", "Energy of the structure, with the coupled air", along=_TIME)]
    stored: Annotated[Floats, Reported("J", "Elastic energy of contacts and links", along=_TIME)]
    lost_modes: Floats
    lost_contacts: Mapping[str, Floats]
    lost_links: Mapping[str, Floats]
    work: Annotated[Floats, Reported("J", "Done by loads and gravity until now", along=_TIME)]
    blows: Annotated[Floats, Reported("J", "Brought by repeated blows less what was lifted off", along=_TIME)]
    residual: Annotated[float, Reported("1", "Largest error of the sum of all terms, as a share")]

    @property
    def dissipated(
        self,
    ) -> Annotated[Floats, Reported("J", "Lost in modes, contacts and links", along=_TIME)]:
        """All losses until then [m] [J]."""
        total = self.lost_modes.copy()
        for lost in (*self.lost_contacts.values(), *self.lost_links.values()):
            total += lost
        return total


@stored_as("response/1")
@dataclass(frozen=True, eq=False)
class Response:
    """Motion and forces of a simulated impact; it remembers its problem.

    t [nt] [s]; motion : of the modes, then the bodies, kept at the starts of steps: its samples follow when asked for.
    pushed [p, k], pushes [p, nt] : rows of all that pushes the modes, and their forces [N]: what accelerations need.
    bodies, contacts by name; links : force by name [nt] [N], positive in compression (pushing its ends apart).
    blows : of all bodies that strike several times, in the order of time.

    The motion of a point is a row of its mode shapes, `point.probe("z").of(basis.shapes)`, through `displacement`,
    `velocity` or `acceleration`. A ball of 1 kg hands its speed of 1 m/s over to a mass of 1 kg:

    >>> from femstruct.impact.scene import Body, Clock, Contact, Scene
    >>> from femstruct.laws.linear import Linear
    >>> from femstruct.impact.simulate import simulate
    >>> from femstruct.modal.closed_form import oscillator
    >>> basis, points = oscillator(1.0, frequency_hz=0.0, axis="z")
    >>> mass = points["m"].probe("z")
    >>> hit = Contact("hit", upper="ball", lower=mass, law=Linear(1e6))
    >>> response = simulate(basis, Scene((Body("ball", 1.0, -1.0),), (hit,)), Clock(0.01, 10e3))
    >>> round(float(response.velocity(mass.of(basis.shapes))[-1]), 9), response.contacts["hit"].closings
    (-1.0, 1)
    """

    basis: ModalBasis
    scene: Scene
    clock: Clock
    t: Floats
    motion: Motion
    pushed: Floats
    pushes: Floats
    bodies: Mapping[str, BodyHistory]
    contacts: Mapping[str, ContactHistory]
    links: Mapping[str, Floats]
    events: tuple[Event, ...]
    blows: tuple[Blow, ...]
    ledger: EnergyLedger
    outcome: Outcome
    findings: tuple[Finding, ...]

    def displacement(self, row: Floats) -> Floats:
        """Weighted sum of the modal coordinates [nt], row [k]: exact at every sample."""
        total: Floats = weighted_motion(self.motion, DISPLACEMENT, row[None])[0]
        return total

    def velocity(self, row: Floats) -> Floats:
        """Weighted sum of the modal velocities [nt], row [k]: exact at every sample."""
        total: Floats = weighted_motion(self.motion, VELOCITY, row[None])[0]
        return total

    def acceleration(self, row: Floats) -> Floats:
        """Weighted sum of the modal accelerations [nt], row [k]: q'' = pushes - damping q' - omega^2 q."""
        basis = self.basis
        inner: Floats = self.displacement(row * basis.omega**2) + self.velocity(row @ basis.time_damping)
        return (self.pushed @ row) @ self.pushes - inner

    @property
    def q(self) -> Floats:
        """Modal coordinates [k, nt] [kg^.5 m]: large, and evaluated at each use; `displacement` needs no such room."""
        return coordinates(self.motion, DISPLACEMENT, 0, len(self.basis.omega))

    @property
    def qd(self) -> Floats:
        """Modal velocities [k, nt] [kg^.5 m/s]: large, and evaluated at each use; `velocity` needs no such room."""
        return coordinates(self.motion, VELOCITY, 0, len(self.basis.omega))

    def velocities(self, modes: Integers) -> Floats:
        """Velocities of some modes at all samples [len(modes), nt] [kg^.5 m/s]."""
        return modal_motion(self.motion, VELOCITY, modes)

    def amplitudes(self) -> Floats:
        """Largest velocity that each mode's energy allows [k] [kg^.5 m/s], over the starts of all steps."""
        k = len(self.basis.omega)
        z, v = (modal_states(self.motion, what)[:, :k] for what in (DISPLACEMENT, VELOCITY))
        speeds: Floats = np.hypot(v, self.basis.omega * z).max(axis=0)
        return speeds

    @property
    def qdd(self) -> Floats:
        """Modal accelerations [k, nt] [kg^.5 m/s^2], evaluated at each use."""
        basis = self.basis
        return self.pushed.T @ self.pushes - (basis.omega**2)[:, None] * self.q - basis.time_damping @ self.qd


# ----------------------------------------------------------------------------------------------------------------------
# How runs ended, as a sentence: one run, or all of a batch at once.
# ----------------------------------------------------------------------------------------------------------------------

LAST = 0.125  # share of the window in which bodies that rest no longer bounce
REST_ACCELERATION = 0.1  # share of gravity that their mean acceleration may have in it

Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Endings:
    """What the outcomes of runs are told from, each [runs].

    duration [s] : of the window. last [s] : when each contact closed or opened for the last time, nan if never; closed
    : whether it was closed then. gain [m/s^2] : mean acceleration of each body over the last part of the window, either
    way.
    """

    duration: float
    last: Mapping[str, Floats]
    closed: Mapping[str, Flags]
    gain: Mapping[str, Floats]


def outcomes_of(
    scene: Scene, endings: Endings, runs: int, columns: Mapping[str, Floats] = MappingProxyType({})
) -> tuple[Outcome, ...]:
    """The outcome of every run of a scene; gravity and kinds of contacts are the same in all.

    Parameters
    ----------
    columns : Mapping[str, Floats]
        What differs [runs], by BODY.mass, CONTACT.stiffness, CONTACT.damping.
    """
    touched, closed, together = (np.zeros(runs, dtype=bool) for _ in range(3))
    still = {}
    for contact in scene.contacts:
        last, shut = endings.last[contact.name], endings.closed[contact.name]
        touched |= ~np.isnan(last)
        closed |= shut
        still[contact.name] = shut & (endings.duration - last > _settling(scene, contact, columns))
        together |= still[contact.name]
    held = any(contact.preload > 0.0 for contact in scene.contacts)
    kinds = (*Outcome,)
    which = np.full(runs, kinds.index(Outcome.SEPARATED))
    which[closed] = kinds.index(Outcome.CLOSED_AT_END)
    at_rest = closed & _rest(scene, endings, still)
    which[at_rest] = kinds.index(Outcome.RESTING if scene.gravity > 0.0 else Outcome.HELD)
    if not scene.gravity > 0.0:
        which[at_rest & together] = kinds.index(Outcome.TOGETHER)
    untouched = Outcome.HELD if held else Outcome.NEVER_TOUCHED if scene.contacts else Outcome.NO_CONTACTS
    which[~touched] = kinds.index(untouched)
    return tuple(kinds[i] for i in which)


def _settling(scene: Scene, contact: Contact, columns: Mapping[str, Floats]) -> Floats:
    """How long after its closing [s] a contact that never lets its bodies part has brought them to rest together
    [runs] or [1]; infinite for all others."""
    bodies = [body for body in scene.bodies if body.name in (contact.upper, contact.lower)]
    if not bodies:
        return np.array([inf])
    mass = 1.0 / sum(1.0 / columns.get(f"{body.name}.mass", np.array([body.mass])) for body in bodies)
    prefix = f"{contact.name}."
    own = {name.removeprefix(prefix): one for name, one in columns.items() if name.startswith(prefix)}
    found = contact.law.settling_time(np.asarray(mass), own)
    return np.array([inf]) if found is None else found


def _rest(scene: Scene, endings: Endings, still: Mapping[str, Flags]) -> Flags:
    """Whether all contacts that are closed at the end carry a body that gravity pulls, were closed at the start or
    hold their bodies together, and did so for a while: no event in the last part of the window, in which the body
    hardly gained speed. A ball in the middle of a bounce gains speed at many times gravity.

    Parameters
    ----------
    still : Mapping[str, Flags]
        Of the contacts that hold bodies together, whether these are at rest on each other.
    """
    at_rest = np.ones(len(next(iter(still.values()), np.ones(1))), dtype=bool)
    weighing = {body.name for body in scene.bodies if body.falls and scene.gravity > 0.0}
    for contact in scene.contacts:
        last, closed = endings.last[contact.name], endings.closed[contact.name]
        at_rest &= ~(last > (1.0 - LAST) * endings.duration)
        held = contact.preload > 0.0  # by a weight that lies on it, or by what it clamps
        bodies = [end for end in (contact.upper, contact.lower) if isinstance(end, str)]
        carried = [name for name in bodies if name in weighing or held]
        quiet = still[contact.name] | bool(carried) | held
        for name in carried if scene.gravity > 0.0 else ():
            quiet = quiet & (endings.gain[name] <= REST_ACCELERATION * scene.gravity)
        at_rest &= quiet | ~closed
    return at_rest


def gain_of(velocity: Floats, end_velocity: float, duration: float) -> float:
    """Mean acceleration of a body over the last part of the window [m/s^2], from its samples [nt] [m/s]."""
    first = min(round((1.0 - LAST) * len(velocity)), len(velocity) - 1)
    return abs(end_velocity - float(velocity[first])) / (duration * (1.0 - first / len(velocity)))


# ----------------------------------------------------------------------------------------------------------------------
# What reaches supports and the ground without moving the structure: forces on held nodes, and on the ground itself.
# ----------------------------------------------------------------------------------------------------------------------


def transmitted_share(response: Response, direct: Probe) -> Floats:
    """The share [nt] [N] of all that pushes the structure which reaches a support or joint without any motion.

    Parameters
    ----------
    direct : Probe
        Of a `ForceRow`.

    Raises
    ------
    FemstructError
        When the pushes of the response are not those of its scene.
    """
    if not len(direct.weights):
        return np.zeros(len(response.t))
    shapes = response.basis.shapes

    def seen(end: End) -> Floats:
        """Modal displacements of an end, and what a unit force there passes on."""
        if isinstance(end, Probe):
            return np.append(end.of(shapes), direct.meets(end))
        return np.zeros(shapes.shape[2] + 1)

    known = _each_push(response, seen)
    if not len(known) and not response.pushed.any():  # it was only started
        return np.zeros(len(response.t))
    if not np.array_equal(known[:, :-1], response.pushed[: len(known)]) or response.pushed[len(known) :].any():
        raise FemstructError("passed_on", got="pushes in another order than the scene's")
    passed: Floats = known[:, -1] @ response.pushes[: len(known)]
    return passed


def ground_contact_force(response: Response) -> Floats | None:
    """Force [nt] [N] of contacts and links on the ground itself, along the axis of the bodies; None where none ends
    there. It is measured from rest: what a preload or a body's weight presses with is left out."""
    share = _each_push(response, lambda end: np.array([float(isinstance(end, Ground))])).ravel()
    if not share.any():
        return None
    force: Floats = share @ response.pushes[: len(share)]
    return force


def _each_push(response: Response, seen: Callable[[End], Floats]) -> Floats:
    """What every push of a scene works on, a row each in the order of `Response.pushes`.

    Parameters
    ----------
    seen : Callable[[End], Floats]
        Of one of its ends.
    """
    rows: list[Floats] = []
    for contact in response.scene.contacts:
        approach = seen(contact.lower) - seen(contact.upper)
        rows += [side * approach for side in contact.law.sides]
    rows += [seen(link.lower) - seen(link.upper) for link in response.scene.links]
    rows += [seen(load.on) for load in response.scene.loads]
    return np.array(rows).reshape(len(rows), -1) if rows else np.zeros((0, 1))
