"""What a study's own numbers say against it before anything is computed: window, samples, blows, loads, ratings."""

from __future__ import annotations

from collections.abc import Iterator

from acoustics.levels.exposure import LEAST_SAMPLING_HZ
from femstruct.errors import Finding
from femstruct.impact.result.blow_by_blow import left_out_finding
from femstruct.impact.scene.bodies import Blows, HalfSine
from femstruct.impact.scene.impact_sources import DROPPED
from femstruct.study.acting import PlacedBody, PlannedLoad
from femstruct.study.asked import TimePlan
from femstruct.study.study import Case, Study
from femstruct.workflow.judgement.flanking_findings import flanking_findings, near_microphones
from femstruct.workflow.judgement.impact_findings import hammer_findings, load_findings, room_findings
from femstruct.workflow.judgement.source_findings import source_unresolved
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.rated_rooms import rated_findings
from femstruct.workflow.stages.recorded.channels import STRESS
from femstruct.workflow.stages.recorded.stresses import orthotropic_findings

SAMPLES_OF_A_LOAD = 10  # in the shortest load: the peak of a half sine between samples is then missed by 1 %


def study_findings(case: Case, places: Places) -> list[Finding]:
    """All that can be said of what a case does to its structure, and of its receivers, without any solution.

    Notes
    -----
    The window and the samples beside loads, blows and standard sources; the places of a tapping machine's hammers; what
    rooms are rated for, and by what. Findings of a run that say the same have the same words.
    """
    study, time = case.study, case.study.time
    shown = (record.target for record in study.records if record.what == STRESS)
    found = [*orthotropic_findings(study.structure, shown)]
    about = [(plan.name, one) for plan in study.rooms for one in flanking_findings(plan, places)]
    about += [(plan.name, one) for plan in study.rooms for one in near_microphones(plan, study, places)]
    found += room_findings(about)
    if time is not None:
        found += _preloads_that_add(study)
        found += hammer_findings(study, places)
        found += load_findings(study.loads, time.duration)
        found += _coarse_loads(study, time)
        found += _blows_left_out(study, time)
        found += _sources_unresolved(study, time)
        told = [(plan.name, one) for plan in study.rooms for one in rated_findings(plan, study, len(case.studies))]
        found += room_findings(told)
    return found


def _preloads_that_add(study: Study) -> Iterator[Finding]:
    """Links that push from the start on bodies whose contacts have a preload, which something holds already."""
    bodies = {body.name for body in study.bodies}
    for link in (one for one in study.links if one.preload and not one.release_at):
        for contact in (one for one in study.contacts if one.preload):
            for body in sorted(bodies.intersection(link.between).intersection(contact.between)):
                yield Finding(
                    "preloads-add",
                    f"links.{link.name}: its preload of {link.preload:.4g} N pushes '{body}' from the start, beside "
                    f"the {contact.preload:.4g} N of contact '{contact.name}', which are in balance already. If "
                    "the link is what presses the contact, remove its preload",
                    {"link_n": link.preload, "contact_n": contact.preload},
                )


def _coarse_loads(study: Study, time: TimePlan) -> Iterator[Finding]:
    """Loads that last for few samples: histories and spectra do not show them as they are."""
    for load in study.loads:
        lasts = _duration(load)
        if lasts * time.sampling < SAMPLES_OF_A_LOAD:
            yield Finding(
                "load-coarsely-sampled",
                f"{load.name} lasts {lasts:.3g} s, {lasts * time.sampling:.1f} samples of {time.sampling:g} Hz: "
                f"recorded histories and spectra miss its effect. Sample at {SAMPLES_OF_A_LOAD / lasts:.3g} Hz or "
                "more",
                {"duration_s": lasts, "sampling_hz": time.sampling, "needed_hz": SAMPLES_OF_A_LOAD / lasts},
            )


def _duration(load: PlannedLoad) -> float:
    if isinstance(load.history, HalfSine):
        return 0.5 / load.history.frequency
    return float(load.history.times[-1] - load.history.times[0])


def _blows_left_out(study: Study, time: TimePlan) -> Iterator[Finding]:
    """Blows that the window does not reach."""
    for body in study.bodies:
        again = body.blows
        if again is None:
            continue
        plan = Blows(body.name, body.target, again.every, again.count, again.first, again.late)
        seen = int((plan.times < time.duration).sum())
        if seen < again.count:
            yield left_out_finding(plan, seen, time.duration)


def _sources_unresolved(study: Study, time: TimePlan) -> Iterator[Finding]:
    for body in study.bodies:
        if _is_standard(body) and time.sampling < LEAST_SAMPLING_HZ:
            yield source_unresolved(body, time.sampling)


def _is_standard(body: PlacedBody) -> bool:
    return body.source in DROPPED
