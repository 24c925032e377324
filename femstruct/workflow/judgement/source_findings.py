"""Whether a standard source satisfies, on this floor and sampling, what its standard requires on a rigid one."""

from __future__ import annotations

import numpy as np

from acoustics.levels.exposure import LEAST_SAMPLING_HZ, force_exposure_levels
from femstruct.errors import Finding
from femstruct.impact.result.response import Response
from femstruct.impact.scene.impact_sources import CONTACT_S, DROPPED, EXPOSURE_ALLOWED_DB, RESTITUTION, TAPPING_MACHINE
from femstruct.modal.basis import ModalBasis
from femstruct.study.acting import PlacedBody
from femstruct.study.study import Study

SAME = 1e-6  # of an interval: rounding of times


def source_findings(study: Study, response: Response) -> tuple[Finding, ...]:
    """Sources whose force exposure, restitution or contact time leaves the table of their standard, and how tapping
    hammers rebound."""
    found = _rebound(study, response)
    for body in study.bodies:
        contact = response.contacts.get(f"{body.name} on {body.target}")
        if body.source in DROPPED and contact is not None and contact.first_open is not None:
            found += _beyond(body, response, contact.first_open)
    return tuple(found)


def _rebound(study: Study, response: Response) -> list[Finding]:
    """What the hammers of a tapping machine keep of their speed: what no standard fixes, and levels depend on."""
    kept: dict[str, list[float]] = {}
    for body in study.bodies:
        contact = response.contacts.get(f"{body.name} on {body.target}")
        if body.source == TAPPING_MACHINE and contact is not None and contact.closings:
            velocity = after_blow(body.name, f"{body.name} on {body.target}", response)
            kept.setdefault(body.name.rpartition(".")[0], []).append(velocity / body.speed)
    found = []
    for machine, shares in kept.items():
        share = float(np.mean(shares))
        lower, higher = 20 * np.log10(1 + share), 20 * np.log10(2 / (1 + share))
        found.append(
            Finding(
                "hammers-rebound",
                f"{machine}: the hammers rebound from this floor with a coefficient of restitution of {share:.2f}. For "
                f"real machines 0 to 1 is reported (Acta Acustica 9, 14, 2025): a real machine may give levels "
                + (f"{lower:.1f} dB lower" if lower >= 0.0 else f"{-lower:.1f} dB")  # below 0: the floor gives way
                + f" to {higher:.1f} dB higher",
                {"restitution": share, "lower_db": lower, "higher_db": higher},
            )
        )
    return found


def after_blow(body: str, contact: str, response: Response) -> float:
    """Velocity with which a body leaves at the end of its first blow [m/s]: a light floor that comes back meets it
    again before that. Where the contact stays closed, the velocity just before it is lifted."""
    lifted = min((one.t for one in response.blows if one.body == body and one.number == 2), default=float("inf"))
    left = [one for one in response.events if one.contact == contact and one.t < lifted]
    last = min(lifted, float(response.t[-1]))
    at = left[-1].t if left and left[-1].what == "opens" else last
    after = int(np.ceil(at * response.clock.sampling - SAME))
    before = int(np.ceil(last * response.clock.sampling - SAME)) - (lifted <= response.t[-1])
    return float(response.bodies[body].velocity[max(min(after, before), 0)])


def walking_findings(study: Study, basis: ModalBasis) -> tuple[Finding, ...]:
    """Walkers on floors that none of their harmonics can bring to resonance, and rooms that listen to them."""
    found = []
    elastic = [f for f, kind in zip(basis.frequency_hz.tolist(), basis.kind, strict=True) if kind == "elastic"]
    for walker in study.walks:
        highest = walker.walk.highest_hz
        if elastic and elastic[0] > highest:
            found.append(
                Finding(
                    "walking-below-modes",
                    f"{walker.name}: the highest harmonic of the walker, {highest:g} Hz, is below the first mode, "
                    f"{elastic[0]:.4g} Hz: such a floor responds to heel strikes, which a Fourier series does not "
                    "contain",
                    {"highest_hz": highest, "first_mode_hz": elastic[0]},
                )
            )
        if any(plan.receivers for plan in study.rooms):
            found.append(
                Finding(
                    "walking-low-frequency-only",
                    f"{walker.name}: the walking model, a Fourier series up to {highest:g} Hz, covers low-frequency "
                    "vibration "
                    "only. Use a measured force history ('loads.NAME.file') for audible footsteps",
                    {"highest_hz": highest},
                )
            )
    return tuple(found)


def _beyond(body: PlacedBody, response: Response, opens: float) -> list[Finding]:
    """What the first contact of a dropped source, from t = 0 until it opens [s], has beyond what is allowed."""
    source, sampling = DROPPED[str(body.source)], response.clock.sampling
    if sampling < LEAST_SAMPLING_HZ:
        return [source_unresolved(body, sampling)]
    end = int(np.ceil(opens * sampling))
    force = response.contacts[f"{body.name} on {body.target}"].force[:end]
    levels = force_exposure_levels(force, 1.0 / sampling)
    after = response.bodies[body.name].velocity[min(end, len(response.t) - 1)]
    measured = [
        (f"{band:g} Hz", levels[band], wanted, EXPOSURE_ALLOWED_DB[band], "dB")
        for band, wanted in source.exposure_db.items()
    ]
    measured += [("restitution", after / source.speed, *RESTITUTION, "")]
    measured += [("contact", 1e3 * opens, 1e3 * CONTACT_S[0], 1e3 * CONTACT_S[1], "ms")]
    missed = [one for one in measured if abs(one[1] - one[2]) > one[3]]
    if not missed:
        return []
    told = "; ".join(
        f"{what} {value:.3g} {unit}, required {wanted:g} +- {allowed:g} {unit}".replace("  ", " ")
        for what, value, wanted, allowed, unit in missed
    )
    values = {what: value for what, value, _, _, _ in missed} | {f"{one[0]} wanted": one[2] for one in missed}
    return [
        Finding(
            "source-off-standard",
            f"{body.name}: on this floor the {body.source} does not satisfy what its standard requires on a rigid "
            f"floor: {told}",
            values,
        )
    ]


def source_unresolved(body: PlacedBody, sampling: float) -> Finding:
    """A sampling [Hz] at which the force of a standard source cannot be compared with its table."""
    return Finding(
        "source-coarsely-sampled",
        f"{body.name}: with a sampling of {sampling:g} Hz the force of a {body.source} cannot be compared with its "
        "standard, "
        f"whose octaves need {LEAST_SAMPLING_HZ:g} Hz",
        {"sampling_hz": sampling, "needed_hz": LEAST_SAMPLING_HZ},
    )
