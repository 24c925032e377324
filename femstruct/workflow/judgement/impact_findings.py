"""Reasons not to trust a result that no single stage can see."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import ceil

import numpy as np

from acoustics.errors import Advice
from femstruct.arrays import Floats
from femstruct.errors import Finding, some_of
from femstruct.impact.closer import FOLDED, closer, last_mode_hz, pulses_hz
from femstruct.impact.result.response import Response
from femstruct.impact.scene.bodies import HalfSine, Table
from femstruct.impact.scene.impact_sources import TAPPING_MACHINE
from femstruct.modal.basis import ModalBasis
from femstruct.model.probe import Probe
from femstruct.study.acting import PlannedLoad
from femstruct.study.study import Study
from femstruct.workflow.stages.places import Places

ALIASED = 0.05  # share of an acceleration's rms that modes above half the sampling may have
HAMMERS_APART, HAMMERS_WITHIN = 0.1, 0.003  # of a tapping machine, ISO 10140-5 annex E [m]
CUT = 0.01  # share of a load's impulse outside the window that is told
PEAK_MISSED = 0.05  # share of a contact's peak by which samples of its force may miss it
CONTENT = 0.01  # share of a contact force's spectrum beyond the last mode that a basis may miss


def impact_findings(basis: ModalBasis, response: Response) -> tuple[Finding, ...]:
    """Contact forces with content beyond the modes of the basis."""
    found = []
    given = not basis.complete_below_hz  # a list of modes is complete to no frequency
    for name, (share, top) in shares_beyond(basis, response).items():
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


def shares_beyond(basis: ModalBasis, response: Response) -> dict[str, tuple[float, float]]:
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
    return response if response.clock.sampling >= FOLDED * fastest else closer(response) or response


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

    accelerations : the rows [k] of what is recorded, by channel. Displacements and velocities of such modes are small;
    their accelerations are not, and samples show them at frequencies where nothing is.
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
    told = {response.contacts[name].peak_force for name in missed}
    others = [
        one
        for one in response.findings
        if one.code != "contact-coarsely-sampled" or one.values.get("peak_force_n") not in told
    ]
    return (*missed.values(), *others)


def room_findings(told: Iterable[tuple[str, Advice | Finding]]) -> list[Finding]:
    """What was told of rooms ("box") and receivers ("box.mic"), each once and with the names of all it holds for.

    >>> advice = Advice("ringing", "it rings")
    >>> [found.message for found in room_findings([("box", advice), ("hall", advice)])]
    ['box, hall: it rings']
    """
    names: dict[tuple[str, str], list[str]] = {}
    first: dict[tuple[str, str], Advice | Finding] = {}
    for name, found in told:
        key = (found.code, found.message)
        names.setdefault(key, []).append(name)
        first.setdefault(key, found)
    return [
        Finding(
            found.code,
            f"{some_of(names[key])}: {found.message}",
            found.values,
            severe=isinstance(found, Finding) and found.severe,
        )
        for key, found in first.items()
    ]
