"""Reasons not to trust an impact: few samples, forces beyond the modes, sources unlike their standards."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from math import ceil, log10
from typing import Final, NamedTuple

import numpy as np

from acoustics.errors import Advice
from acoustics.levels.sound_levels import LEAST_SAMPLING_HZ, force_exposure_levels
from femstruct.arrays import Floats
from femstruct.errors import Finding, NotConverged, list_some
from femstruct.impact.resampled import (
    ENOUGH,
    FOLDED,
    factor_for,
    factor_of,
    last_mode_hz,
    pulses_hz,
    resample,
    samples_of_a_pulse,
)
from femstruct.impact.response import Outcome, Response
from femstruct.impact.scene import (
    CONTACT_S,
    DROPPED,
    EXPOSURE_ALLOWED_DB,
    RESTITUTION,
    TAPPING_MACHINE,
    Contact,
    HalfSine,
    Table,
)
from femstruct.impact.simulate import simulate
from femstruct.modal.basis import ModalBasis
from femstruct.model.lay_ups import section_of
from femstruct.model.probe import Probe
from femstruct.model.structure import Structure
from femstruct.parts.plate import Plate
from femstruct.parts.slab import Slab
from femstruct.sound.floor_blows import LONGEST_S, impact_on_resistance, infinite_plate
from femstruct.study.acting import PlacedBody, PlannedLoad
from femstruct.study.asked import RoomPlan
from femstruct.study.recorded import NET_FORCE, Channel
from femstruct.study.study import Study
from femstruct.units import readable_unit
from femstruct.workflow.bases import Places, planned_contacts
from femstruct.workflow.recorded_channels import CONVERGED, LessStatic, OtherImpulse

# ----------------------------------------------------------------------------------------------------------------------
# Samples too few for what vibrates: of recorded histories, of the motion that is heard, of peaks between them.
# ----------------------------------------------------------------------------------------------------------------------

SAMPLES_FOR_SOUND = 10.0  # samples in a period of the last mode that are advised where sound is computed from them
FEW = 8.0  # samples in a period of a pulse, 4 in its half sine, below which peaks are 8 % low: (pi / 8)^2 / 2
RECORDED_PEAK_MISSED = 0.05  # of a recorded peak, by which the samples of its history may miss it


def coarse_sampling(study: Study, last_hz: float, modes: int) -> Iterator[Finding]:
    """What the sampling of a study says against it, of modes up to a frequency [Hz].

    Parameters
    ----------
    modes : int
        How many of them.
    """
    time = study.time
    if time is None or time.sampling >= ENOUGH * last_hz:
        return
    factor = factor_for(last_hz, modes + len(study.bodies), max(round(time.duration * time.sampling), 1), time.sampling)
    period = f"the last mode, {last_hz:.5g} Hz, has {time.sampling / last_hz:.2g} samples in a period"
    values = {
        "last_mode_hz": last_hz,
        "sampling_hz": time.sampling,
        "samples": time.sampling / last_hz,
        "peaks_at_hz": factor * time.sampling,
    }
    if factor == 0:
        yield Finding(
            "motion-coarsely-sampled",
            f"At the sampling of {time.sampling:g} Hz {period}, and the {ENOUGH:g} samples that peaks need do not fit "
            f"into memory with a window of {time.duration:g} s. Peaks are blank and their limits are not known. Use a "
            "shorter window or fewer modes",
            values | {"needed": ENOUGH},
            severe=True,
        )
        return
    with_sound = any(_has_receivers(plan) for plan in study.rooms)
    if time.sampling >= FOLDED * last_hz or not (study.records or with_sound):
        return
    needed = SAMPLES_FOR_SOUND if with_sound else FOLDED
    sound = "sound is computed from these samples: pressures, levels and ratings are wrong, and peaks of pressures are "
    shown = f"recorded histories and their spectra show what is above {time.sampling / 2.0:g} Hz at lower frequencies. "
    hold = f"Peaks and limits of the structure are found at {factor * time.sampling:g} Hz and hold. "
    yield Finding(
        "motion-coarsely-sampled",
        f"At the sampling of {time.sampling:g} Hz {period}: "
        + (f"{sound}blank" + ("; " if study.records else ". ") if with_sound else "")
        + (shown + hold if study.records else "")
        + f"Sample at {ceil(needed * last_hz)} Hz or more",
        values | {"needed": needed},
        severe=with_sound,
    )


def missed_pulses(study: Study, response: Response) -> Iterator[Finding]:
    """A pulse that even the grid of the peaks does not follow: they are lower bounds."""
    samples, factor = samples_of_a_pulse(response), factor_of(response)
    if samples >= ENOUGH or not factor or not study.records:
        return
    name = max(pulses_hz(response).items(), key=lambda one: one[1], default=("a load", 0.0))[0]
    yield Finding(
        "motion-coarsely-sampled",
        f"{name}: its pulse has {0.5 * samples:.2g} samples at the {factor * response.clock.sampling:g} Hz with which "
        f"peaks are found, and {0.5 * ENOUGH:g} do not fit into memory with a window of {response.clock.duration:g} s. "
        "Peaks are lower bounds, but for that of its force: a limit is exceeded or not known. Use a shorter window",
        {"samples": 0.5 * samples, "needed": 0.5 * ENOUGH, "sampling_hz": response.clock.sampling},
        severe=samples < FEW,
    )


def _has_receivers(plan: RoomPlan) -> bool:
    return bool(plan.receivers) or plan.room.open_air is not None


def missed_peaks(study: Study, response: Response, channels: Mapping[str, Channel]) -> Iterator[Finding]:
    """Recorded histories whose samples miss their peak, the worst first, as one finding."""
    if study.peaks.lowpass_hz is not None or factor_of(response) <= 1:
        return
    found = []
    for record in study.records:
        channel = channels.get(str(record))
        if channel is None or record.target in response.contacts:  # of a contact its own finding says it
            continue
        sampled = float(np.abs(channel.values).max(initial=0.0))
        if sampled < (1.0 - RECORDED_PEAK_MISSED) * channel.whole:
            found.append((sampled / channel.whole, sampled, channel))
    if found:
        share, sampled, worst = min(found, key=lambda one: one[0])
        more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
        factor, unit = readable_unit(worst.unit, worst.whole)
        yield Finding(
            "motion-coarsely-sampled",
            f"{worst.name}: the largest sample of the history is {factor * sampled:.4g} {unit}; the peak is "
            f"{factor * worst.whole:.4g} {unit} and lies between two samples at {response.clock.sampling:g} Hz{more}. "
            "Peaks and limits are found there too; histories, pictures and spectra do not show it. Sample faster",
            {"sampled_peak": sampled, "peak": worst.whole, "share": share, "allowed": RECORDED_PEAK_MISSED},
        )


# ----------------------------------------------------------------------------------------------------------------------
# Whether a standard source satisfies, on this floor and sampling, what its standard requires on a rigid one.
# ----------------------------------------------------------------------------------------------------------------------

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
            velocity = rebound_velocity(body.name, f"{body.name} on {body.target}", response)
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


def rebound_velocity(body: str, contact: str, response: Response) -> float:
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
        (f"{band:g} Hz", levels[band], nominal, EXPOSURE_ALLOWED_DB[band], "dB")
        for band, nominal in source.exposure_db.items()
    ]
    measured += [("restitution", after / source.speed, *RESTITUTION, "")]
    measured += [("contact", 1e3 * opens, 1e3 * CONTACT_S[0], 1e3 * CONTACT_S[1], "ms")]
    missed = [one for one in measured if abs(one[1] - one[2]) > one[3]]
    if not missed:
        return []
    deviations = "; ".join(
        f"{what} {value:.3g} {unit}, required {nominal:g} +- {allowed:g} {unit}".replace("  ", " ")
        for what, value, nominal, allowed, unit in missed
    )
    values = {what: value for what, value, _, _, _ in missed} | {f"{one[0]} wanted": one[2] for one in missed}
    return [
        Finding(
            "source-off-standard",
            f"{body.name}: on this floor the {body.source} does not satisfy what its standard requires on a rigid "
            f"floor: {deviations}",
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


# ----------------------------------------------------------------------------------------------------------------------
# Forces of contacts that reach beyond the modes, each with what it is by another way: the static share of the modes
# left out gives way like a spring, where a plate takes energy away like a dashpot.
# ----------------------------------------------------------------------------------------------------------------------

Beyond = Mapping[
    str, tuple[float, float]
]  # of contacts that reach beyond the modes, as `force_shares_beyond_modes` has them
SEEN_DB: Final = 0.2  # of levels at low frequencies, which are told
LONG: Final = 4.0  # closings of the contact that the blow on an infinite plate is looked at


class OtherPeak(NamedTuple):
    """The peak of a contact force beyond the modes [N] and the same by another way; rebound, other_rebound [1] : of the
    body, of its speed at the blow, None where they are not compared. point : what is struck, "" between two. share [1]
    of the force's spectrum above end [Hz]."""

    peak: float
    other_peak: float
    method: str
    rebound: float | None = None
    other_rebound: float | None = None
    point: str = ""
    share: float = 0.0
    end: float = 0.0

    @property
    def apart(self) -> float:
        """How far the peaks are apart, as a share of the larger."""
        return abs(self.peak - self.other_peak) / max(self.peak, self.other_peak)


def runs_with_less_static_share(study: Study, response: Response, beyond: Beyond) -> tuple[LessStatic, ...]:
    """The same impact with half of the static share of the modes left out, and with none, where a study evaluates
    histories and contacts reach beyond the modes: what later blows make of their forces is not seen in the first peak.

    What changes in proportion changes twice as much without it as with its half.
    """
    true = np.array([kind != "residual" for kind in response.basis.kind])
    if true.all() or not beyond or not study.evaluations:
        return ()
    found = []
    for share, short, method, allowed in (
        (0.5, "half static", "with half of", CONVERGED),
        (0.0, "nothing static", "where contacts do not feel", 2.0 * CONVERGED),
    ):
        scales = np.where(true, 1.0, np.sqrt(share))
        basis = replace(response.basis, shapes=response.basis.shapes * scales)
        with suppress(NotConverged):  # a comparison that fails is none
            run = simulate(basis, response.scene, response.clock)
            found.append(LessStatic(run, scales, short, method, allowed))
    return tuple(found)


def sensitive_forces(study: Study, response: Response, beyond: Beyond) -> dict[str, OtherPeak]:
    """Contacts whose force reaches beyond the modes and is another one by another way, by name."""
    found: dict[str, OtherPeak] = {}
    ends = {planned.name: planned.between for planned in planned_contacts(study)}
    for contact in response.scene.contacts:
        if contact.name not in beyond or contact.name not in ends:
            continue
        points = [end for end in ends[contact.name] if end not in response.bodies]
        point = points[0] if len(points) == 1 else ""
        share, end = beyond[contact.name]
        plate = _on_infinite_plate(study, response, contact, point, end)
        if plate is not None and plate.apart <= CONVERGED:
            continue
        alone = _by_modes(response, contact)
        if alone is not None and alone.apart > CONVERGED:  # else what is left out matters little: waves may come back
            found[contact.name] = (plate or alone)._replace(point=point, share=share, end=end)
    return found


def impulse_ratios(found: Mapping[str, OtherPeak]) -> tuple[OtherImpulse, ...]:
    """What first blows on infinite plates give the structure, over what they give here: of a body 1 + rebound."""
    return tuple(
        OtherImpulse((1.0 + one.other_rebound) / (1.0 + one.rebound), f"with the rebound of {name} {one.method}")
        for name, one in found.items()
        if one.rebound is not None and one.other_rebound is not None
    )


def mark_forces(channels: Mapping[str, Channel], found: Mapping[str, OtherPeak]) -> dict[str, Channel]:
    """Recorded forces with the peaks that they have by another way beside them, which are then not to be quoted."""
    kept = dict(channels)
    for name, one in found.items():
        for channel in (f"{name} force", f"{NET_FORCE}{one.point}"):
            if (old := kept.get(channel)) is not None:
                times = one.other_peak / one.peak
                kept[channel] = replace(old, by_modes=(times * old.first_impact, times * old.whole))
    return kept


def force_findings(found: Mapping[str, OtherPeak]) -> Iterator[Finding]:
    """What is to be known of them."""
    for name, one in found.items():
        rebound_text = ""
        if one.rebound is not None and one.other_rebound is not None:
            rebound_text = f"The body keeps {one.rebound:z.2f} of its speed, and {one.other_rebound:z.2f}"
            rebound_text += f"{_below(one.rebound, one.other_rebound)}. "
        values = {"peak": one.peak, "beside": one.other_peak, "apart": one.apart, "allowed": CONVERGED}
        rebounds = {"rebound": one.rebound, "rebound_beside": one.other_rebound}
        yield Finding(
            "force-beyond-modes",
            f"{name} force: do not quote its peak. It is {one.peak:.4g} N, and {one.other_peak:.4g} N {one.method}: "
            f"{100 * one.share:.1f} % of the energy of its spectrum lies above {one.end:.5g} Hz, where modes are left "
            f"out. {rebound_text}Compute more modes, until both agree",
            values | {key: value for key, value in rebounds.items() if value is not None},
        )


def _below(rebound: float, other: float) -> str:
    """What that changes well below the length of the blow, where only the momentum counts that the body gives, m v (1 +
    rebound)."""
    db = 20.0 * log10((1.0 + rebound) / (1.0 + other))
    return f": sound and vibration at low frequencies are {abs(db):.1f} dB apart" if abs(db) >= SEEN_DB else ""


def _on_infinite_plate(
    study: Study, response: Response, contact: Contact, point: str, end_hz: float
) -> OtherPeak | None:
    """The first blow of a free body on the infinite plate of the part that it strikes: C. Zener, Physical Review 59
    (1941) 669-673. None for other parts, and for bodies that something else holds."""
    body = next((one for one in (contact.upper, contact.lower) if isinstance(one, str) and one in response.bodies), "")
    resistance = _resistance(study, point, end_hz)
    scene = response.scene
    others = [one for one in scene.contacts if one is not contact] + list(scene.links)
    if not body or resistance is None or contact.preload or any(body in (one.upper, one.lower) for one in others):
        return None
    mine = [one for one in response.events if one.contact == contact.name]
    begins = next((one.t for one in mine if one.what == "closes"), None)
    if begins is None:
        return None
    sample = min(int(begins * response.clock.sampling), len(response.t) - 1)
    speed = abs(float(response.bodies[body].velocity[sample]))
    mass = next(one.mass for one in scene.bodies if one.name == body)
    if not speed:
        return None
    over = next((one.t for one in mine if one.what == "opens"), float(response.t[-1]))
    duration = LONG * max(over - begins, 1.0 / response.clock.sampling)
    blow = impact_on_resistance(mass, speed, contact.law, resistance, duration)
    while blow.outcome is Outcome.CLOSED_AT_END and duration < LONGEST_S:
        duration *= LONG
        blow = impact_on_resistance(mass, speed, contact.law, resistance, duration)
    towards = np.sign(response.bodies[body].velocity[sample])
    left = -float(towards) * rebound_velocity(body, contact.name, response) / speed
    other = float(blow.bodies["body"].velocity[-1]) / speed
    method = "on an infinite plate of the same kind (Zener)"
    return OtherPeak(response.contacts[contact.name].peak_force, blow.contacts["blow"].peak_force, method, left, other)


def _resistance(study: Study, point: str, end_hz: float) -> float | None:
    """Of the infinite plate of the part on which a point lies [N s/m], beyond the modes; None for other parts."""
    if not isinstance(study.structure, Structure):
        return None
    names = (point, point.rpartition(".")[0])
    on = next((one.on for one in study.structure.points if one.name in names), None)
    part = next((one for one in study.structure.parts if one.name == on), None)
    if not isinstance(part, Plate | Slab):
        return None
    plate = infinite_plate(section_of(part.material, part.thickness))
    plate = plate.thin if isinstance(part, Plate) else plate
    return 1.0 / float(plate.mobility(np.array([end_hz]))[0])


def _by_modes(response: Response, contact: Contact) -> OtherPeak | None:
    """The same scene without residual vectors, until the force has had its peak; None where there are none."""
    basis = response.basis
    true = np.array([kind != "residual" for kind in basis.kind])
    whole = response.contacts[contact.name]
    if true.all() or not whole.peak_force:
        return None
    bare = replace(basis, shapes=basis.shapes * true)
    begins = max(one.t for one in response.events if one.contact == contact.name and one.t <= whole.peak_time)
    until = whole.peak_time + max(whole.peak_time - begins, 10.0 / response.clock.sampling)
    clock = replace(response.clock, duration=min(until, response.clock.duration))
    other = simulate(bare, response.scene, clock).contacts[contact.name].peak_force
    if not other or (not isinstance(contact.upper, Probe) and not isinstance(contact.lower, Probe)):
        return None
    method = "without the residual vectors (the static correction for the modes that are left out)"
    return OtherPeak(whole.peak_force, other, method)


# ----------------------------------------------------------------------------------------------------------------------
# Reasons not to trust a result that no single stage can see.
# ----------------------------------------------------------------------------------------------------------------------

ALIASED = 0.05  # share of an acceleration's rms that modes above half the sampling may have
HAMMERS_APART, HAMMERS_WITHIN = 0.1, 0.003  # of a tapping machine, ISO 10140-5 annex E [m]
CUT = 0.01  # share of a load's impulse outside the window that is told
PEAK_MISSED = 0.05  # share of a contact's peak by which samples of its force may miss it
CONTENT = 0.01  # share of a contact force's spectrum beyond the last mode that a basis may miss


def impact_findings(basis: ModalBasis, response: Response) -> tuple[Finding, ...]:
    """Contact forces with content beyond the modes of the basis."""
    found = []
    given = not basis.complete_below_hz  # a list of modes is complete to no frequency
    for name, (share, top) in force_shares_beyond_modes(basis, response).items():
        left_out = (
            "the highest given mode: the response of the structure there is not known"
            if given
            else "where modes are left out (except their static response). Accelerations above it are too low"
        )
        found.append(
            Finding(
                "contact-beyond-modes",
                f"{name}: {100 * share:.1f} % of the energy of the force spectrum lies above {top:.5g} Hz, {left_out}",
                {"share": share, "complete_below_hz": basis.complete_below_hz, "highest_hz": top},
            )
        )
    return tuple(found)


def force_shares_beyond_modes(basis: ModalBasis, response: Response) -> dict[str, tuple[float, float]]:
    """Share of the energy of the force spectrum above the modes, and their end [Hz], of contacts where it counts."""
    near, found = _for_spectra(basis, response), {}
    on_structure = {c.name for c in response.scene.contacts if isinstance(c.upper, Probe) or isinstance(c.lower, Probe)}
    given = not basis.complete_below_hz
    top = float(basis.frequency_hz[basis.modes].max(initial=0.0)) if given else basis.complete_below_hz
    for name, contact in response.contacts.items():
        if contact.closings and name in on_structure and top > 0.0:
            share = content_above(near.contacts[name].force, near.clock.sampling, top)
            if share > CONTENT:
                found[name] = share, top
    return found


def _for_spectra(basis: ModalBasis, response: Response) -> Response:
    """A run whose samples show the spectra of its contacts: on a finer grid where those of this one are too few."""
    fastest = max(last_mode_hz(basis), *pulses_hz(response).values(), 0.0)
    return response if response.clock.sampling >= FOLDED * fastest else resample(response) or response


def load_findings(loads: Iterable[PlannedLoad], duration: float) -> tuple[Finding, ...]:
    """Force histories of which a part comes before t = 0 or after the end of the window [s], where nothing is."""
    found = []
    for load in loads:
        again = load.repeat
        begins = again.first + again.every * np.arange(again.count)
        t, size = _sizes(load.history)
        passed = np.concatenate([[0.0], np.cumsum(0.5 * (size[1:] + size[:-1]) * np.diff(t))])
        whole = float(again.count * passed[-1])
        inside = float((np.interp(duration - begins, t, passed) - np.interp(-begins, t, passed)).sum())
        if whole - inside > CUT * whole:
            unit = "Pa s" if load.kind == "surface" else "N s"
            found.append(
                Finding(
                    "load-cut",
                    f"{load.name}: only {inside:.4g} {unit} of its {whole:.4g} {unit} lie between 0 and "
                    f"{duration:g} s; the "
                    "rest is left out. Shift its times, or simulate longer",
                    {"whole": whole, "inside": inside, "duration_s": duration},
                    severe=inside <= CUT * whole,
                )
            )
    return tuple(found)


def _sizes(history: HalfSine | Table) -> tuple[Floats, Floats]:
    """Times and magnitudes of a history; a half sine by as many straight lines as leave 1e-4 of its impulse."""
    if isinstance(history, Table):
        return history.times, np.abs(history.values)
    t = np.linspace(0.0, 0.5 / history.frequency, 101)
    return t, np.abs(history.amplitude * np.sin(2.0 * np.pi * history.frequency * t))


def hammer_findings(study: Study, places: Places) -> tuple[Finding, ...]:
    """Hammers of a tapping machine that do not stand beside each other, as those of the standard's one machine."""
    hammers = [body for body in study.bodies if body.source == TAPPING_MACHINE]
    if len(hammers) < 2:
        return ()
    at = np.array([places.point(body.target, f"bodies.{body.name}").position for body in hammers])
    apart = np.linalg.norm(np.diff(at, axis=0), axis=1)
    worst = float(apart[np.abs(apart - HAMMERS_APART).argmax()])
    if abs(worst - HAMMERS_APART) <= HAMMERS_WITHIN:
        return ()
    return (
        Finding(
            "tapping-hammer-spacing",
            f"{hammers[0].name} to {hammers[-1].name} are the hammers of one tapping machine, with a spacing of up to "
            f"{worst:.3g} m. The standard requires {HAMMERS_APART:g} m, in a line. Give five places for each "
            "position of "
            "the machine",
            {"apart_m": worst, "standard_m": HAMMERS_APART},
        ),
    )


def aliased_findings(response: Response, accelerations: Mapping[str, Floats]) -> tuple[Finding, ...]:
    """Recorded accelerations to which modes or residual vectors above half the sampling add more than a little.

    Parameters
    ----------
    accelerations : Mapping[str, Floats]
        The rows [k] of what is recorded, by channel. Displacements and velocities of such modes are small; their
        accelerations are not, and samples show them at frequencies where nothing is.
    """
    half, found = response.clock.sampling / 2.0, []
    fast = response.basis.frequency_hz > half
    for name, row in accelerations.items() if fast.any() else ():
        whole, part = (float(np.sqrt(np.mean(response.acceleration(r) ** 2))) for r in (row, row * fast))
        if part > ALIASED * whole:
            found.append(
                Finding(
                    "motion-coarsely-sampled",
                    f"{name}: modes and residual vectors above half the sampling frequency, {half:.5g} Hz, have an rms "
                    f"value of {part:.4g} m/s^2, all together {whole:.4g} m/s^2. They appear at wrong frequencies. "
                    f"Sample at {ceil(2.0 * response.basis.frequency_hz.max())} Hz or more, or use a low-pass on a "
                    "velocity",
                    {"above_half_m_s2": part, "rms_m_s2": whole, "allowed": ALIASED, "half_sampling_hz": half},
                )
            )
    return tuple(found)


def content_above(force: Floats, sampling: float, frequency_hz: float) -> float:
    """Share of the energy of a force's spectrum above a frequency [1]."""
    energy = np.abs(np.fft.rfft(force)) ** 2
    total = float(energy.sum())
    above = np.fft.rfftfreq(len(force), 1.0 / sampling) > frequency_hz
    return float(energy[above].sum()) / total if total > 0.0 else 0.0


def sampled_findings(study: Study, response: Response) -> tuple[Finding, ...]:
    """Findings of a run, those on contacts of few samples severe where the study records a force whose peak falls
    between samples."""
    forces = {record.target for record in study.records if record.what == "force"}
    missed = {}
    for name, contact in response.contacts.items():
        seen = float(np.abs(contact.force).max(initial=0.0))
        if name in forces and seen < (1.0 - PEAK_MISSED) * contact.peak_force:
            missed[name] = Finding(
                "contact-coarsely-sampled",
                f"{name} force: the largest sample is {seen:.3g} N, the peak of the contact is "
                f"{contact.peak_force:.3g} N, between two samples at {response.clock.sampling:g} Hz. "
                "The history does not show it, but peaks and limits are found there. Sample faster",
                {
                    "sampled_peak_n": seen,
                    "peak_force_n": contact.peak_force,
                    "sampling_hz": response.clock.sampling,
                    "allowed": PEAK_MISSED,
                },
            )
    peaks = {response.contacts[name].peak_force for name in missed}
    others = [
        one
        for one in response.findings
        if one.code != "contact-coarsely-sampled" or one.values.get("peak_force_n") not in peaks
    ]
    return (*missed.values(), *others)


def room_findings(findings: Iterable[tuple[str, Advice | Finding]]) -> list[Finding]:
    """What was told of rooms ("box") and receivers ("box.mic"), each once and with the names of all it holds for.

    >>> advice = Advice("ringing", "it rings")
    >>> [found.message for found in room_findings([("box", advice), ("hall", advice)])]
    ['box, hall: it rings']
    """
    names: dict[tuple[str, str], list[str]] = {}
    first: dict[tuple[str, str], Advice | Finding] = {}
    for name, found in findings:
        key = (found.code, found.message)
        names.setdefault(key, []).append(name)
        first.setdefault(key, found)
    return [
        Finding(
            found.code,
            f"{list_some(names[key])}: {found.message}",
            found.values,
            severe=isinstance(found, Finding) and found.severe,
        )
        for key, found in first.items()
    ]
