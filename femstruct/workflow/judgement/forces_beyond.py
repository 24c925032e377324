"""Forces of contacts that reach beyond the modes, each with what it is by another way: the static share of the modes
left out gives way like a spring, where a plate takes energy away like a dashpot."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from math import log10
from typing import Final, NamedTuple

import numpy as np

from femstruct.errors import Finding, NotConverged
from femstruct.impact.result.response import Outcome, Response
from femstruct.impact.scene.bodies import Contact
from femstruct.impact.simulate import simulate
from femstruct.model.materials.lay_up import section_of
from femstruct.model.probe import Probe
from femstruct.model.structure import Structure
from femstruct.parts.plate import Plate
from femstruct.parts.slab import Slab
from femstruct.study.recorded import NET_FORCE, Channel
from femstruct.study.study import Study
from femstruct.workflow.continuation.bare_plates import infinite
from femstruct.workflow.continuation.blow_forces import LONGEST_S, on_resistance
from femstruct.workflow.judgement.source_findings import after_blow
from femstruct.workflow.stages.recorded.evaluated import LessStatic, OtherPush
from femstruct.workflow.stages.recorded.peaks import CONVERGED
from femstruct.workflow.stages.rest import planned_contacts

Beyond = Mapping[str, tuple[float, float]]  # of contacts that reach beyond the modes, as `shares_beyond` has them
SEEN_DB: Final = 0.2  # of levels at low frequencies, which are told
LONG: Final = 4.0  # closings of the contact that the blow on an infinite plate is looked at


class Beside(NamedTuple):
    """The peak of a contact force beyond the modes [N] and the same by another way; rebound, other_rebound [1] : of the
    body, of its speed at the blow, None where they are not compared. point : what is struck, "" between two. share [1]
    of the force's spectrum above end [Hz]."""

    peak: float
    other_peak: float
    way: str
    rebound: float | None = None
    other_rebound: float | None = None
    point: str = ""
    share: float = 0.0
    end: float = 0.0

    @property
    def apart(self) -> float:
        """How far the peaks are apart, as a share of the larger."""
        return abs(self.peak - self.other_peak) / max(self.peak, self.other_peak)


def with_less(study: Study, response: Response, beyond: Beyond) -> tuple[LessStatic, ...]:
    """The same impact with half of the static share of the modes left out, and with none, where a study evaluates
    histories and contacts reach beyond the modes: what later blows make of their forces is not seen in the first peak.

    What changes in proportion changes twice as much without it as with its half.
    """
    true = np.array([kind != "residual" for kind in response.basis.kind])
    if true.all() or not beyond or not study.evaluations:
        return ()
    found = []
    for share, short, way, allowed in (
        (0.5, "half static", "with half of", CONVERGED),
        (0.0, "nothing static", "where contacts do not feel", 2.0 * CONVERGED),
    ):
        scales = np.where(true, 1.0, np.sqrt(share))
        basis = replace(response.basis, shapes=response.basis.shapes * scales)
        with suppress(NotConverged):  # a comparison that fails is none
            run = simulate(basis, response.scene, response.clock)
            found.append(LessStatic(run, scales, short, way, allowed))
    return tuple(found)


def forces_beside(study: Study, response: Response, beyond: Beyond) -> dict[str, Beside]:
    """Contacts whose force reaches beyond the modes and is another one by another way, by name."""
    found: dict[str, Beside] = {}
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


def other_pushes(found: Mapping[str, Beside]) -> tuple[OtherPush, ...]:
    """What first blows on infinite plates give the structure, over what they give here: of a body 1 + rebound."""
    return tuple(
        OtherPush((1.0 + one.other_rebound) / (1.0 + one.rebound), f"with the rebound of {name} {one.way}")
        for name, one in found.items()
        if one.rebound is not None and one.other_rebound is not None
    )


def marked(channels: Mapping[str, Channel], found: Mapping[str, Beside]) -> dict[str, Channel]:
    """Recorded forces with the peaks that they have by another way beside them, which are then not to be quoted."""
    kept = dict(channels)
    for name, one in found.items():
        for channel in (f"{name} force", f"{NET_FORCE}{one.point}"):
            if (old := kept.get(channel)) is not None:
                times = one.other_peak / one.peak
                kept[channel] = replace(old, by_modes=(times * old.first_impact, times * old.whole))
    return kept


def force_findings(found: Mapping[str, Beside]) -> Iterator[Finding]:
    """What is to be known of them."""
    for name, one in found.items():
        told = ""
        if one.rebound is not None and one.other_rebound is not None:
            told = f"The body keeps {one.rebound:z.2f} of its speed, and {one.other_rebound:z.2f}"
            told += f"{_below(one.rebound, one.other_rebound)}. "
        values = {"peak": one.peak, "beside": one.other_peak, "apart": one.apart, "allowed": CONVERGED}
        rebounds = {"rebound": one.rebound, "rebound_beside": one.other_rebound}
        yield Finding(
            "force-beyond-modes",
            f"{name} force: do not quote its peak. It is {one.peak:.4g} N, and {one.other_peak:.4g} N {one.way}: "
            f"{100 * one.share:.1f} % of the energy of its spectrum lies above {one.end:.5g} Hz, where modes are left "
            f"out. {told}Compute more modes, until both agree",
            values | {key: value for key, value in rebounds.items() if value is not None},
        )


def _below(rebound: float, other: float) -> str:
    """What that changes well below the length of the blow, where only the momentum counts that the body gives, m v (1 +
    rebound)."""
    db = 20.0 * log10((1.0 + rebound) / (1.0 + other))
    return f": sound and vibration at low frequencies are {abs(db):.1f} dB apart" if abs(db) >= SEEN_DB else ""


def _on_infinite_plate(study: Study, response: Response, contact: Contact, point: str, end_hz: float) -> Beside | None:
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
    blow = on_resistance(mass, speed, contact.law, resistance, duration)
    while blow.outcome is Outcome.CLOSED_AT_END and duration < LONGEST_S:
        duration *= LONG
        blow = on_resistance(mass, speed, contact.law, resistance, duration)
    towards = np.sign(response.bodies[body].velocity[sample])
    left = -float(towards) * after_blow(body, contact.name, response) / speed
    other = float(blow.bodies["body"].velocity[-1]) / speed
    way = "on an infinite plate of the same kind (Zener)"
    return Beside(response.contacts[contact.name].peak_force, blow.contacts["blow"].peak_force, way, left, other)


def _resistance(study: Study, point: str, end_hz: float) -> float | None:
    """Of the infinite plate of the part on which a point lies [N s/m], beyond the modes; None for other parts."""
    if not isinstance(study.structure, Structure):
        return None
    names = (point, point.rpartition(".")[0])
    on = next((one.on for one in study.structure.points if one.name in names), None)
    part = next((one for one in study.structure.parts if one.name == on), None)
    if not isinstance(part, Plate | Slab):
        return None
    plate = infinite(section_of(part.material, part.thickness))
    plate = plate.thin if isinstance(part, Plate) else plate
    return 1.0 / float(plate.mobility(np.array([end_hz]))[0])


def _by_modes(response: Response, contact: Contact) -> Beside | None:
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
    way = "without the residual vectors (the static correction for the modes that are left out)"
    return Beside(whole.peak_force, other, way)
