"""Blow by blow: what each brought, how hard it struck, and whether the structure came to rest before the next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.impact.contact_events import ENERGY, HELD, MOMENTUM, SINCE, RunRecord, rests_on_contact
from femstruct.impact.motion import Motion, modal_motions
from femstruct.impact.response import Blow, Event, Outcome
from femstruct.impact.scene import Blows, Clock, Contact, Scene
from femstruct.impact.system import Compiled

CHUNK = 32  # modes whose samples are in memory at a time
AT_REST = 1e-2  # share of the largest energy after a blow that counts as rest


def blow_table(
    record: RunRecord,
    motion: Motion,
    omega: Floats,
    compiled: Compiled,
    scene: Scene,
    clock: Clock,
    log: Sequence[Event],
) -> tuple[Blow, ...]:
    """All blows of a run in the order of time.

    Parameters
    ----------
    omega : Floats [k]
        Of the modes [rad/s].
    """
    system, end = compiled.system, compiled.n_samples / clock.sampling
    strikes, times = system.strikes, system.strikes["tick"] * system.tick
    if not len(strikes):
        return ()
    energy = structure_energy(motion, omega)
    following = np.append(times, np.inf)[np.searchsorted(times, times, side="right")]
    found: list[Blow] = [None] * len(strikes)  # type: ignore[list-item]
    for over, plan in enumerate(scene.blows):
        names = [contact.name for contact in scene.contacts if plan.body in (contact.upper, contact.lower)]
        rows = [a for name in names for a in compiled.contacts[name]]
        closed = np.array([event.t for event in log if event.what == "closes" and event.contact in names])
        mine = np.flatnonzero(strikes["over"] == over)
        for i, number in enumerate(mine):
            t, again = float(times[number]), mine[i + 1] if i + 1 < len(mine) else None
            until = float(following[number]) if np.isfinite(following[number]) else t + plan.every
            low, high = (_sample(time, clock, len(energy)) for time in (t, min(until, end)))
            largest = float(energy[low:high].max(initial=0.0))
            peaks = record.strike_peak[number, rows]
            hardest = peaks[peaks[:, 0].argmax()] if rows else np.array([0.0, t])
            held = record.strikes[again] if again is not None else np.zeros(4)
            found[number] = Blow(
                body=plan.body,
                number=i + 1,
                t=t,
                energy=float(record.strikes[number, ENERGY]),
                impulse=float(record.strikes[number, MOMENTUM] * compiled.scale[strikes[number]["coordinate"]]),
                peak_force=float(hardest[0]),
                peak_time=float(hardest[1]),
                closings=int(np.sum((closed >= t) & (closed < (times[again] if again is not None else np.inf)))),
                largest_energy=largest,
                left_energy=float(energy[high - 1]) if high > low else 0.0,
                rest_after=_settling_time(energy[low:high], largest, low / clock.sampling - t, clock),
                interval=min(until, end) - t,
                seen=bool(until <= end * (1.0 + 1e-12)),
                held_force=float(held[HELD]),
                held_since=float(held[SINCE]) if held[HELD] > 0.0 else None,
            )
    return tuple(found)


def structure_energy(motion: Motion, omega: Floats) -> Floats:
    """Kinetic and elastic energy of the first modes, of these frequencies [k], at all samples [nt] [J]."""
    energy = np.zeros(motion.n_samples)
    for first in range(0, len(omega), CHUNK):
        last = min(first + CHUNK, len(omega))
        place, rate = modal_motions(motion, first, last)
        energy += 0.5 * (omega[first:last] ** 2 @ place**2 + (rate**2).sum(axis=0))
    return energy


def _sample(t: float, clock: Clock, count: int) -> int:
    """The first sample at or after a time, rounding allowed for: at the end of an interval the next blow has begun."""
    return min(int(np.ceil(t * clock.sampling - 1e-6)), count)


def _settling_time(energy: Floats, largest: float, after: float, clock: Clock) -> float | None:
    """How long after the blow the energy is below its share for good [s]; None when it is not before the next.

    Parameters
    ----------
    energy : Floats
        At samples, the first of them `after` [s] the blow.
    """
    loud = np.flatnonzero(energy > AT_REST * largest)
    last = int(loud[-1]) + 1 if loud.size else 0
    return after + last / clock.sampling if last < len(energy) else None


def blow_findings(blows: Sequence[Blow], scene: Scene, clock: Clock) -> tuple[Finding, ...]:
    """Blows that come too early: before the contact is open, before the structure is at rest; blows left out."""
    found = []
    for plan in scene.blows:
        mine = [blow for blow in blows if blow.body == plan.body]
        weight = scene.gravity * sum(body.mass for body in scene.bodies if body.name == plan.body)
        held = [blow for blow in mine if blow.held_since is not None and not rests_on_contact(blow.held_force, weight)]
        if held:
            first = held[0]
            since = float(plan.times[first.number]) - (first.held_since or 0.0)
            found.append(lifted_finding(plan, len(held), first.number, first.held_force, since))
        if len(mine) < plan.count:
            found.append(left_out_finding(plan, len(mine), clock.duration))
    restless = [blow for blow in blows if blow.seen and blow.rest_after is None]
    if restless:
        worst = max(restless, key=lambda blow: blow.left_energy / blow.largest_energy)
        left = worst.left_energy / worst.largest_energy
        found.append(
            Finding(
                "blow-before-rest",
                f"After {len(restless)} of {_some(len(blows), 'blow')} the structure does not come to rest before the "
                f"next: {100 * left:.2g} % of its energy is left {worst.interval:.3g} s after blow {worst.number} of "
                f"{worst.body}; {100 * AT_REST:g} % counts as rest. Later blows depend on those before",
                {"blows": len(restless), "energy_left": left, "allowed": AT_REST, "interval_s": worst.interval},
            )
        )
    return tuple(found)


def lifted_finding(plan: Blows, lifts: int, number: int, force: float, since: float) -> Finding:
    """A body that is lifted off while its contact acts.

    Parameters
    ----------
    number, force, since : int [s], float [N], float [s]
        Of the first such lift.
    """
    return Finding(
        "lifted-in-contact",
        f"{plan.body} is still in contact when it is lifted off for {_some(lifts, 'blow')} (first after blow {number}, "
        f"with {force:.3g} N, {since:.3g} s after it closed). The interval of {plan.every:g} s is too short",
        {"blows": lifts, "force_n": force, "contact_s": since, "every_s": plan.every},
    )


def left_out_finding(plan: Blows, seen: int, duration: float) -> Finding:
    """Blows that the window does not reach."""
    return Finding(
        "blows-left-out",
        f"{plan.body}: {seen} of {plan.count} blows fall into the window of {duration:g} s",
        {"blows": seen, "count": plan.count, "duration_s": duration},
    )


def _some(count: int, word: str) -> str:
    """A number of things.

    >>> _some(1, "blow"), _some(5, "blow")
    ('1 blow', '5 blows')
    """
    return f"{count} {word}{'' if count == 1 else 's'}"


# ----------------------------------------------------------------------------------------------------------------------
# Reasons to trust a run less, from a few of its numbers: a run alone and each of a batch are judged here.
# ----------------------------------------------------------------------------------------------------------------------

ENERGY_DRIFT = 1e-8  # of the energy put in: what a run keeps; told from there on
NOT_TRUSTED = 1e-6  # and severe from here on
SAMPLES_PER_CONTACT = 10
TICKS_PER_CONTACT = 100  # peaks are wrong by (pi / ticks)^2 / 2 by a linear law, 3.3 / ticks^2.5 by Hertz: below 1e-3
NOT_DECAYED = 1e-2  # of the structure's largest energy


@dataclass(frozen=True)
class JudgedRun:
    """What a run is judged by: the residual of its ledger, its outcome, its window [s] and the resolution of its events
    [s], zero for an exact integration; of contacts, since when those that are closed at the end are [s], the largest
    indentation [m], and how long the shortest closing lasted [s], infinite where none ended."""

    residual: float
    outcome: Outcome
    duration: float
    tick: float
    closed_since: Mapping[str, float]
    deepest: Mapping[str, float]
    lasting: Mapping[str, float]


def run_findings(contacts: Sequence[Contact], run: JudgedRun) -> tuple[Finding, ...]:
    """What the numbers of a run say against it."""
    found = []
    if drifts(np.float64(run.residual)):
        found.append(
            Finding(
                "energy-drift",
                f"The residual of the energy balance is {run.residual:.1e} of the energy put in; {ENERGY_DRIFT:g} "
                "is allowed.",
                {"ledger_residual": run.residual, "allowed": ENERGY_DRIFT},
                severe=not run.residual <= NOT_TRUSTED,
            )
        )
    if run.outcome is Outcome.CLOSED_AT_END:
        name = max(run.closed_since, key=lambda name: run.closed_since[name])
        since = run.closed_since[name]
        found.append(
            Finding(
                "contact-closed-at-end",
                f"Contact '{name}', closed since {since:.4g} s, is still closed at the end of the window of "
                f"{run.duration:g} s.",
                {"closed_since_s": since, "duration_s": run.duration},
            )
        )
    for name, shortest in run.lasting.items():
        if unresolved(np.float64(shortest), run.tick, np.float64(run.residual)):
            found.append(
                Finding(
                    "contact-unresolved",
                    f"The shortest closing of contact '{name}' lasts {shortest:.3g} s, {shortest / run.tick:.1f} "
                    "times the "
                    f"event resolution of a window of {run.duration:g} s; {TICKS_PER_CONTACT} times are needed for the "
                    "energy balance to close. Shorten the window.",
                    {"contact_s": shortest, "resolved_s": run.tick, "needed": float(TICKS_PER_CONTACT)},
                )
            )
    for contact in contacts:
        found += contact.law.findings(contact.name, run.deepest[contact.name])
    return tuple(found)


def unresolved(shortest: Floats | np.float64, tick: float, residual: Floats | np.float64) -> NDArray[np.bool_]:
    """Whether a closing was too short for the integration, whose step is a tick where a contact closes, and energy
    shows it: a faint touch may be as short as it likes."""
    return np.asarray((shortest < TICKS_PER_CONTACT * tick) & drifts(residual))


def drifts(residual: Floats | np.float64, allowed: float = ENERGY_DRIFT) -> NDArray[np.bool_]:
    """Whether a ledger is open by more than is allowed."""
    return np.asarray(np.logical_not(residual <= allowed))


def decay_findings(largest: float, left: float, duration: float) -> tuple[Finding, ...]:
    """A damped structure that still rings when its record ends; its energies [J]."""
    if left <= NOT_DECAYED * largest:
        return ()
    return (
        Finding(
            "structure-not-decayed",
            f"The structure still has {100 * left / largest:.2g} % of its largest vibration energy at the end, after "
            f"{duration:g} s: in the spectra of this truncated record, resonances are too low and too wide. Give the "
            "study a longer time.",
            {"energy_left": left / largest, "allowed": NOT_DECAYED, "duration_s": duration},
        ),
    )


def sampling_findings(lasting: Mapping[str, float], peaks: Mapping[str, float], sampling: float) -> tuple[Finding, ...]:
    """Contacts that last for few samples.

    Parameters
    ----------
    lasting : Mapping[str, float] [s]
        Of the shortest of each, infinite for none; peaks [N].
    """
    return tuple(
        Finding(
            "contact-coarsely-sampled",
            f"Contact '{name}': its shortest contact lasts {1e3 * shortest:.3g} ms, {shortest * sampling:.1f} samples: "
            "the recorded force may miss its peak, which the table of contacts has. Sample faster for its spectrum.",
            {"contact_s": shortest, "samples": shortest * sampling, "peak_force_n": peaks[name]},
        )
        for name, shortest in lasting.items()
        if shortest * sampling < SAMPLES_PER_CONTACT
    )
