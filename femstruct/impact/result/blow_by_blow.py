"""Blow by blow: what each brought, how hard it struck, and whether the structure came to rest before the next."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.impact.engine.motion import Motion, modal_motions
from femstruct.impact.engine.sampling import Record
from femstruct.impact.engine.strikes import ENERGY, HELD, MOMENTUM, SINCE, lies
from femstruct.impact.engine.system import Compiled
from femstruct.impact.result.response import Blow, Event
from femstruct.impact.scene.bodies import Blows, Clock, Scene

CHUNK = 32  # modes whose samples are in memory at a time
AT_REST = 1e-2  # share of the largest energy after a blow that counts as rest


def blow_table(
    record: Record,
    motion: Motion,
    omega: Floats,
    compiled: Compiled,
    scene: Scene,
    clock: Clock,
    log: Sequence[Event],
) -> tuple[Blow, ...]:
    """All blows of a run in the order of time. omega [k] : of the modes [rad/s]."""
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
                rest_after=_rest(energy[low:high], largest, low / clock.sampling - t, clock),
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


def _rest(energy: Floats, largest: float, after: float, clock: Clock) -> float | None:
    """How long after the blow the energy is below its share for good [s]; None when it is not before the next.

    energy : at samples, the first of them `after` [s] the blow.
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
        held = [blow for blow in mine if blow.held_since is not None and not lies(blow.held_force, weight)]
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
    """A body that is lifted off while its contact acts; number, force [N], since [s] : of the first such lift."""
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
