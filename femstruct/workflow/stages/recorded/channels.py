"""What a study records: histories of points, forces, bodies and rooms, with their peaks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import nan

import numpy as np

from acoustics.room_response import RoomResponse
from femstruct.arrays import Floats
from femstruct.conventions import GRAVITY
from femstruct.errors import InputError
from femstruct.impact.closer import closer
from femstruct.impact.result.averaged import averaged
from femstruct.impact.result.force_on_ground import on_the_ground, passed_on
from femstruct.impact.result.response import Response
from femstruct.modal.basis import ForceRow, ModalBasis
from femstruct.model.probe import StressPlaces
from femstruct.study.asked import PeakRule, Record, RoomPlan
from femstruct.study.recorded import GROUND_WITH_WEIGHT, NET_FORCE, Channel
from femstruct.study.structures import ModesModel
from femstruct.study.study import Study
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.recorded.stresses import largest_stress, walked
from femstruct.workflow.stages.recorded.windowed_peaks import (
    AT_REST,
    Before,
    Peaks,
    between,
    beyond,
    first_alone,
    first_window,
    in_band,
    raised,
)
from femstruct.workflow.stages.rest import axis_of, planned_contacts, weighs, weight_of_bodies
from femstruct.workflow.stages.staging import ordered

STRESS = "stress"
UNITS = {
    "displacement": "m",
    "velocity": "m/s",
    "acceleration": "m/s^2",
    "force": "N",
    "travel": "m",
    "pressure": "Pa",
    STRESS: "Pa",
}

MOTIONS = ("displacement", "velocity", "acceleration")
AXES = "xyz"
GROUND = "ground"
SIDEWAYS = 1e-6  # of the largest: the eigen solver leaves shapes a residual of 1e-9, their forces about 1e-7


def record(study: Study, places: Places, response: Response, rooms: Mapping[str, RoomResponse]) -> dict[str, Channel]:
    """All channels of a case: what the study records, the net force where contacts meet the structure, and pressures.

    Their peaks are those between the samples too (`femstruct.impact.closer`), nan where they cannot be found.

    Raises InputError when a record names something that has no such quantity.
    """
    seen, kept = closer(response), histories(study, places, response)
    pressures: dict[str, tuple[Floats, str]] = {}
    for plan in study.rooms:
        if plan.name in rooms:
            pressures |= _pressures(plan, rooms[plan.name])
    stresses = {str(wanted): wanted.target for wanted in study.records if wanted.what == STRESS}
    if seen is None:
        for name, part in stresses.items():
            rows = places.stresses(part, f"record.{part}")
            kept[name] = walked(rows, response.basis.shapes, response.q).history, UNITS[STRESS]
        told = _known_without_samples(study, response)
        blank = (nan, nan)
        return {
            name: Channel(name, values, unit, *told.get(name, blank))
            for name, (values, unit) in (kept | pressures).items()
        }
    plain = study.peaks.lowpass_hz is None
    onward = seen if plain else beyond(seen, study.peaks)
    moves = onward if plain else averaged(onward)
    fine = kept if moves is response else kept | histories(study, places, moves)
    peaks = Peaks(study.peaks, seen.clock.sampling, first_window(study.peaks, seen), len(seen.t))
    alone = first_alone(seen, peaks.window)
    moving = alone if plain else None  # a filter needs what comes later
    rest = before_start(study, places, seen)
    found = {name: peaks.of(fine[name][0], rest.get(name, AT_REST)) for name in kept}
    if moving is not None:
        found = {n: raised(found[n], values) for n, (values, _) in histories(study, places, moving).items()}
    for name, one in _contacts(study, seen).items():
        found[name] = peaks.of_contact(fine[name][0], seen.contacts[one])
        if alone is not None:
            found[name] = raised(found[name], np.array([alone.contacts[one].peak_force]))
    silent: dict[str, tuple[float, float]] = {}
    for name, (pressure, _) in pressures.items():
        values, factor = between(pressure, response)
        heard = replace(peaks, sampling=factor * response.clock.sampling, count=values.shape[-1])
        found[name] = heard.of(values)
        if not plain:
            silent[name] = heard.of(np.append(values, 0.0))
    channels = {
        name: Channel(name, values, unit, *found[name], silent_after=silent.get(name))
        for name, (values, unit) in (kept | pressures).items()
    }
    true = np.array([kind != "residual" for kind in response.basis.kind])
    for name, (what, row) in motion_rows(study, places, response.basis).items() if not true.all() else ():
        pair = peaks.of(moved(moves, what, row * true), rest.get(name, AT_REST))
        by_modes = pair if moving is None else raised(pair, moved(moving, what, row * true))
        channels[name] = replace(channels[name], by_modes=by_modes)
    if stresses:
        channels |= _stresses(stresses, study.peaks, places, response, seen, onward, moving)
    met = bool(response.contacts)
    return channels if met else {name: replace(channel, struck=False) for name, channel in channels.items()}


def _stresses(
    wanted: Mapping[str, str],
    rule: PeakRule,
    places: Places,
    response: Response,
    seen: Response,
    onward: Response,
    alone: Response | None,
) -> dict[str, Channel]:
    """Histories of the largest equivalent stress of parts, by channel, their peaks as `seen`, filtered with what comes
    after it (`onward`), and `alone` in the first impact. What is filtered is the motion: the stress of von Mises of a
    filtered motion is one, a filtered stress of von Mises is not."""
    shapes, q = seen.basis.shapes, seen.q
    if rule.lowpass_hz is not None:
        q = in_band(onward.q, seen.clock.sampling, (0.0, rule.lowpass_hz))[:, : len(seen.t)]
    kept = q if seen is response and rule.lowpass_hz is None else response.q
    true = np.array([kind != "residual" for kind in seen.basis.kind])
    early = seen.t <= first_window(rule, seen)

    def largest(history: Floats, rows: StressPlaces, shapes: Floats) -> tuple[float, float]:
        pair = float(history[early].max(initial=0.0)), float(history.max())
        return pair if alone is None else raised(pair, walked(rows, shapes, alone.q).history)

    found: dict[str, Channel] = {}
    for name, part in wanted.items():
        rows = places.stresses(part, f"record.{part}")
        peaks, stressed = largest_stress(rows, seen, q)
        values = peaks if kept is q else walked(rows, shapes, kept).history
        by_modes = None if true.all() else largest(walked(rows, shapes * true, q).history, rows, shapes * true)
        found[name] = Channel(name, values, UNITS[STRESS], *largest(peaks, rows, shapes), by_modes, stressed)
    return found


def histories(study: Study, places: Places, response: Response) -> dict[str, tuple[Floats, str]]:
    """What a study records of the motion and of forces, and the net forces, by channel: values [nt] and their unit.
    Stresses are no sums of modes and are not among them."""
    found: dict[str, tuple[Floats, str]] = {}
    for wanted in study.records:
        if wanted.what != STRESS:
            found |= _recorded(wanted, study, places, response)
    if (weight := _limited_weight(study, response.basis)) is not None:
        found[GROUND_WITH_WEIGHT] = (found["ground force"][0] - weight, "N")  # z is up: a negative force on the ground
    return found | {f"{NET_FORCE}{name}": (force, "N") for name, force in _net_forces(study, places, response).items()}


def weight_on_ground(study: Study, basis: ModalBasis) -> float | None:
    """Weight of all that stands on the ground [N]; None without gravity, and where modes are given, which do not say
    their mass."""
    known = basis.total_mass > 0.0 or not basis.modes.stop
    return basis.total_mass * GRAVITY + weight_of_bodies(study) if weighs(study) and known else None


def _limited_weight(study: Study, basis: ModalBasis) -> float | None:
    """The same where a limit is of the force with it, else None."""
    if all(limit.name != GROUND_WITH_WEIGHT for limit in study.limits):
        return None
    weight, recorded = weight_on_ground(study, basis), any(str(one) == "ground force" for one in study.records)
    if weight is None or not recorded:
        got = "modes that do not say their mass" if weighs(study) and recorded else "no gravity, or no record of ground"
        expected, do = "a structure whose mass is known, gravity: true and record: {ground: force}", ""
        raise InputError(f"limits.{GROUND_WITH_WEIGHT}", got=got, expected=expected, do=do)
    return weight


def before_start(study: Study, places: Places, response: Response) -> dict[str, Before]:
    """What the recorded histories were before the first sample, by channel, where that is not nothing: bodies and free
    structures flew, preloads and weights were held. Supported structures, and all accelerations and forces that come
    with the blow, were not there."""
    scene, found = response.scene, dict[str, Before]()
    held = {contact.name: contact.preload for contact in scene.contacts}
    pressed = held | {link.name: link.preload for link in scene.links if link.release_at == 0.0}
    rigid = np.array([kind == "rigid" for kind in response.basis.kind], dtype=bool)
    flown = None if scene.velocity is None else np.where(rigid, scene.velocity, 0.0)
    late = {blows.body for blows in scene.blows if blows.times[0] > 0.0}
    pulled = {body.name: -scene.gravity * (body.falls and body.name not in late) for body in scene.bodies}

    def speed(name: str, row: Floats | None = None) -> float:
        if name in response.bodies:
            return float(response.bodies[name].velocity[0])
        return 0.0 if flown is None or row is None else float(row @ flown)

    rows = {} if flown is None else motion_rows(study, places, response.basis)
    for name, (what, row) in rows.items():
        found[name] = {"displacement": Before(0.0, speed("", row)), "velocity": Before(speed("", row))}.get(
            what, AT_REST
        )
    targets = {body.name: body.target for body in study.bodies}
    for wanted in study.records:
        name, what = wanted.target, wanted.what
        if what == "force" and name in pressed:
            found[str(wanted)] = Before(pressed[name])
        elif name in response.bodies and what in ("displacement", "velocity", "travel"):
            at, rate = float(response.bodies[name].displacement[0]), speed(name)
            if what == "travel" and targets[name] != GROUND:
                rate -= speed(targets[name], _row_along(targets[name], study, places, response))
            found[str(wanted)] = Before(rate, pulled[name]) if what == "velocity" else Before(at, rate)
        elif name in response.bodies and what == "acceleration":
            found[str(wanted)] = Before(pulled[name])
    if (weight := _limited_weight(study, response.basis)) is not None:
        found[GROUND_WITH_WEIGHT] = Before(-weight)
    for name, contact, sign in _touched(study, places, response):
        net = f"{NET_FORCE}{name}"
        found[net] = Before(found.get(net, AT_REST).level + sign * held[contact])
    return found


def refuse_absent_forces(study: Study, basis: ModalBasis) -> None:
    """Raise InputError for a recorded force that nothing of the structure, its contacts and links has."""
    pairs = {contact.name: contact.between for contact in planned_contacts(study)}
    pairs |= {link.name: link.between for link in study.links}
    on_ground = any(GROUND in between for between in pairs.values())
    rows = {name.rpartition(".")[0] for name in basis.outputs}
    for wanted in study.records:
        target = wanted.target
        if wanted.what != "force" or target in pairs or target in rows or (target == GROUND and on_ground):
            continue
        if target != GROUND:
            expected, do = "a part, joint or support that carries a force", "record another one"
        elif isinstance(study.structure, ModesModel):
            expected = "given modes and a link or contact between one of their points and the ground"
            do = "write what is fixed to the ground as a link, and give the modes of the structure without it"
        else:
            expected = "a support, spring, foundation, link or contact that is fixed to the ground"
            do = "add one, or do not record it"
        raise InputError(f"record.{target}", got=f"no force of '{target}'", expected=expected, do=do)


def _contacts(study: Study, response: Response) -> dict[str, str]:
    """The contacts whose forces are recorded, by channel."""
    recorded = {str(one): one.target for one in study.records if one.what == "force"}
    return {name: target for name, target in recorded.items() if target in response.contacts}


def _known_without_samples(study: Study, response: Response) -> dict[str, tuple[float, float]]:
    """Peaks of contact forces, that of the first impact nan where it is not the largest of all."""
    end = first_window(study.peaks, response)
    contacts = {name: response.contacts[one] for name, one in _contacts(study, response).items()}
    return {name: (c.peak_force if c.peak_time <= end else nan, c.peak_force) for name, c in contacts.items()}


def _recorded(wanted: Record, study: Study, places: Places, response: Response) -> dict[str, tuple[Floats, str]]:
    target, what, unit = wanted.target, wanted.what, UNITS[wanted.what]
    bodies = {body.name: body for body in study.bodies}
    if target in response.bodies:
        body = response.bodies[target]
        if what == "travel":
            placed_on = motion_of(bodies[target].target, study, places, response)
            return {str(wanted): (body.displacement - placed_on, unit)}
        if what in MOTIONS:
            return {str(wanted): (getattr(body, what), unit)}
    if what == "force":
        if target in response.contacts:
            return {str(wanted): (response.contacts[target].force, unit)}
        if target in response.links:
            return {str(wanted): (response.links[target], unit)}
        rows = {
            axis: response.basis.outputs[key] for axis in AXES if (key := f"{target}.{axis}") in response.basis.outputs
        }
        direct = on_the_ground(response) if target == GROUND else None
        if rows or direct is not None:
            return _forces(target, rows, response, {} if direct is None else {axis_of(study): direct})
    name, _, direction = target.rpartition(".")
    if what in MOTIONS and name:
        row = places.point(name, f"record.{target}").probe(direction).of(response.basis.shapes)
        return {str(wanted): (moved(response, what, row), unit)}
    raise InputError(
        f"record.{target}",
        got=f"'{what}' of '{target}'",
        expected="motion of POINT.x, displacement, velocity, acceleration or travel of a body, or force of a contact, "
        "link, spring, foundation, support, joint or ground",
    )


def motion_rows(study: Study, places: Places, basis: ModalBasis) -> dict[str, tuple[str, Floats]]:
    """What a study records of the motion of points, by channel: which motion, and its modal row [k]."""
    rows: dict[str, tuple[str, Floats]] = {}
    bodies = {body.name for body in study.bodies}
    for wanted in study.records:
        name, _, direction = wanted.target.rpartition(".")
        if wanted.what in MOTIONS and name and wanted.target not in bodies:
            probe = places.point(name, f"record.{wanted.target}").probe(direction)
            rows[str(wanted)] = (wanted.what, probe.of(basis.shapes))
    return rows


def moved(response: Response, what: str, row: Floats) -> Floats:
    """Displacement, velocity or acceleration of a row of modes [nt]."""
    return {"displacement": response.displacement, "velocity": response.velocity}.get(what, response.acceleration)(row)


def _forces(
    target: str, rows: Mapping[str, ForceRow], response: Response, beside: Mapping[str, Floats]
) -> dict[str, tuple[Floats, str]]:
    """The vertical force under the plain name, and the horizontal ones that are more than the rounding of mode shapes
    beside the largest; beside : what else there is along an axis."""
    found = {axis: _summed(response, row) + passed_on(response, row.direct) for axis, row in rows.items()}
    found |= {axis: force + found.get(axis, 0.0) for axis, force in beside.items()}
    largest = max((np.abs(force).max() for force in found.values()), default=0.0)
    named = {f"{target} force": (found["z"], "N")} if "z" in found else {}
    for axis in "xy":
        if axis in found and np.abs(found[axis]).max() > SIDEWAYS * largest:
            named[f"{target} force {axis}"] = (found[axis], "N")
    return named


def _summed(response: Response, row: ForceRow) -> Floats:
    """What the motion makes of a force [nt] [N]; its parts that are zero take no time."""
    parts = (
        (response.displacement, row.stiffness),
        (response.velocity, row.damping),
        (response.acceleration, row.inertia),
    )
    return sum((motion(of) for motion, of in parts if of.any()), np.zeros(len(response.t)))


def motion_of(name: str, study: Study, places: Places, response: Response) -> Floats:
    """Displacement [nt] of a body, a point or the ground along the axis of the bodies [m]."""
    if name in response.bodies:
        return response.bodies[name].displacement
    if name == "ground":
        return np.zeros(len(response.t))
    row = _row_along(name, study, places, response)
    return np.zeros(len(response.t)) if row is None else response.displacement(row)


def _row_along(name: str, study: Study, places: Places, response: Response) -> Floats | None:
    """Modal row [k] of a point along the axis of the bodies; None for a body and the ground."""
    if name in response.bodies or name == GROUND:
        return None
    return places.point(name, "bodies").probe(axis_of(study)).of(response.basis.shapes)


def _net_forces(study: Study, places: Places, response: Response) -> dict[str, Floats]:
    """Sum of all contact forces on every point of the structure that contacts touch, positive along the axis."""
    sums: dict[str, Floats] = {}
    for name, contact, sign in _touched(study, places, response):
        sums[name] = sums.get(name, 0.0) + sign * response.contacts[contact].force
    return sums


def _touched(study: Study, places: Places, response: Response) -> Iterator[tuple[str, str, float]]:
    """Points of the structure that contacts touch, each with its contact and which way that pushes it."""
    for planned in planned_contacts(study):
        for name, sign in zip(ordered(study, places, planned), (1.0, -1.0), strict=True):
            if name != GROUND and name not in response.bodies:
                yield name, planned.name, sign


def _pressures(plan: RoomPlan, room: RoomResponse) -> dict[str, tuple[Floats, str]]:
    return {f"{plan.name}.{receiver.name} pressure": (room.p[i], "Pa") for i, receiver in enumerate(plan.receivers)}
