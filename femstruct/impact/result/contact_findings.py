"""Reasons to trust a run less, from a few of its numbers: a run alone and each of a batch are judged here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.impact.result.response import Outcome
from femstruct.impact.scene.bodies import Contact

ENERGY_DRIFT = 1e-8  # of the energy put in: what a run keeps; told from there on
NOT_TRUSTED = 1e-6  # and severe from here on
SAMPLES_PER_CONTACT = 10
TICKS_PER_CONTACT = 100  # peaks are wrong by (pi / ticks)^2 / 2 by a linear law, 3.3 / ticks^2.5 by Hertz: below 1e-3
NOT_DECAYED = 1e-2  # of the structure's largest energy


@dataclass(frozen=True)
class Measured:
    """What a run is judged by: the residual of its ledger, its outcome, its window [s] and the resolution of its events
    [s], zero for an exact march; of contacts, since when those that are closed at the end are [s], the largest
    indentation [m], and how long the shortest closing lasted [s], infinite where none ended."""

    residual: float
    outcome: Outcome
    duration: float
    tick: float
    closed_since: Mapping[str, float]
    deepest: Mapping[str, float]
    lasting: Mapping[str, float]


def run_findings(contacts: Sequence[Contact], run: Measured) -> tuple[Finding, ...]:
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
    """Whether a closing was too short for the march, whose step is a tick where a contact closes, and energy shows it:
    a faint touch may be as short as it likes."""
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
    """Contacts that last for few samples. lasting [s] : of the shortest of each, infinite for none; peaks [N]."""
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
