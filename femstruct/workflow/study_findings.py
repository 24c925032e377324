"""What a study's own numbers say against it before anything is computed: window, samples, blows, loads, ratings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import ceil, inf
from types import MappingProxyType
from typing import Final

from acoustics.errors import Advice
from acoustics.levels.bands import nominal_bands, passes_below
from acoustics.levels.sound_levels import LEAST_SAMPLING_HZ
from acoustics.levels.standards import Method
from femstruct.errors import Finding, list_some
from femstruct.findings.catalogue import rank_findings
from femstruct.impact.blow_by_blow import left_out_finding
from femstruct.impact.scene import DROPPED, Blows, HalfSine
from femstruct.modal.basis import ModalBasis
from femstruct.model.structure import Structure
from femstruct.parts.wave_findings import cell_for
from femstruct.study.acting import PlacedBody, PlannedLoad
from femstruct.study.asked import FrfRequest, RoomPlan, TimePlan
from femstruct.study.placed_rooms import placed_room
from femstruct.study.study import Case, Study
from femstruct.workflow.bases import MeshedStructure, Places, Solved
from femstruct.workflow.impact_findings import hammer_findings, load_findings, room_findings, source_unresolved
from femstruct.workflow.rated_floors import fillable, statistical_plate
from femstruct.workflow.rated_rooms import method_for, missed_times, rated_findings
from femstruct.workflow.recorded_channels import STRESS, orthotropic_findings
from femstruct.workflow.responses import beyond_modes, undamped_findings
from femstruct.workflow.structure_findings import structure_findings, structure_findings_before, undamped_motion

# ----------------------------------------------------------------------------------------------------------------------
# What a room is beside the surfaces that move it: walls that are left rigid, microphones too near to what radiates.
# ----------------------------------------------------------------------------------------------------------------------

COVERED: Final = 0.95  # share of a wall from which on all of it moves
ROUNDING: Final = 1e-9  # m
NEAR_M: Final = 0.5  # of a microphone from a boundary, at least: ISO 16283-2


def flanking_findings(plan: RoomPlan, places: Places) -> tuple[Finding, ...]:
    """A finding on a room among several surfaces, parts of whose walls are rigid."""
    if len(plan.moved) < 2 or not all(name in places.surfaces for _, name in plan.moved):
        return ()
    room = placed_room(plan, places.surfaces)
    areas = dict.fromkeys(plan.room.movable, 0.0)
    for (wall, _), surface in zip(plan.moved, room.surfaces, strict=True):
        areas[wall] += float(surface.weights.sum())
    shares = {wall: area / plan.room.wall_area(wall) for wall, area in areas.items()}
    rigid = [wall for wall, share in shares.items() if share == 0.0]
    partly = [f"{100 * (1 - share):.0f} % of {wall}" for wall, share in shares.items() if 0.0 < share < COVERED]
    if not rigid and not partly:
        return ()
    walls = ", ".join([*rigid, *partly])
    missing = sum(plan.room.wall_area(wall) - area for wall, area in areas.items())
    return (
        Finding(
            "flanking-incomplete",
            f"{walls} of the room has no surface that moves: what it would radiate is not in the levels, nor in the "
            "shares of the surfaces",
            {"walls_rigid": len(rigid), "rigid_m2": missing},
        ),
    )


def near_microphones(plan: RoomPlan, study: Study, places: Places) -> tuple[Finding, ...]:
    """A finding on a rated room with microphones nearer to a surface that moves than its standard allows."""
    if method_for(plan, study) is None or not all(name in places.surfaces for _, name in plan.moved):
        return ()
    room = placed_room(plan, places.surfaces)
    found: dict[str, tuple[float, str]] = {}
    for surface in room.surfaces:
        for one in plan.receivers:
            off = abs(float((room.from_room(one.position) - surface.centre) @ surface.normal))
            if off < NEAR_M - ROUNDING:
                found[one.name] = min((off, surface.name), found.get(one.name, (off, surface.name)))
    if not found:
        return ()
    nearest, (off, surface_name) = min(found.items(), key=lambda one: one[1][0])
    return (
        Finding(
            "microphone-near-surface",
            f"{list_some(found)}: nearer than {NEAR_M:g} m to a surface that radiates ({nearest}: {off:.2g} m from "
            f"{surface_name}). At a wall levels are up to 3 dB above those of the room",
            {"distance_m": off, "wanted_m": NEAR_M, "microphones": len(found)},
        ),
    )


# ----------------------------------------------------------------------------------------------------------------------
# Rated bands that the modes of a floor or of its room leave blank, reported before anything is computed and after.
# ----------------------------------------------------------------------------------------------------------------------

_SOLVED: Final[Mapping[str, float]] = MappingProxyType({})


def blank_findings(plan: RoomPlan, study: Study, complete_below_hz: float) -> tuple[Finding, ...]:
    """A finding where modes that are complete below a frequency leave rated bands of a room blank.

    Parameters
    ----------
    complete_below_hz : float
        Of the floor; a room of any shape has modes of its own that end.
    """
    method = method_for(plan, study)
    if method is None:
        return ()
    end = plan.heard_to_hz(complete_below_hz)
    plate = statistical_plate(plan, study)
    filled = () if isinstance(plate, str) else fillable(plate, study, method)
    blank = tuple(band for band in blank_bands(method, end) if band not in filled)
    if not blank:
        return ()
    why = plate if isinstance(plate, str) else "the plate has less than one mode in these bands"
    instead = f". There are no statistical levels: {why}" if why else ""
    bands = f"{blank[0]:g} Hz is" if len(blank) == 1 else f"{blank[0]:g} to {blank[-1]:g} Hz are"
    all_of_them = len(blank) == len(method.bands_hz)
    numbers = "there is no single number" if all_of_them else "single numbers are lower bounds ('at least')"
    limiting = "floor" if complete_below_hz <= plan.complete_below_hz else "room"
    up_to = 10 * ceil(method.passed_hz / 10)
    cell = _cell(plan, study, up_to) if limiting == "floor" else None
    return (
        Finding(
            "rating-beyond-modes",
            f"the filters of the rated {method.bands}s pass what is below {method.passed_hz:.0f} Hz, the modes of the "
            f"{limiting} end at {end:.0f} Hz: {bands} blank{f', and {numbers}' if method.numbers else ''}. Give the "
            f"{limiting} 'modes: {{up_to: {up_to} Hz}}'{_mesh(cell)}{instead}",
            {
                "highest_hz": method.passed_hz,
                "complete_below_hz": end,
                "blank_bands": len(blank),
                "first_blank_hz": blank[0],
                **({} if cell is None else {"cell_m": cell}),
            },
        ),
    )


def _mesh(cell: float | None) -> str:
    """What modes up to there need of the mesh [m], for the message."""
    return "" if cell is None else f", and cells of {1e3 * cell:.3g} mm or less, which such modes need"


def _cell(plan: RoomPlan, study: Study, up_to_hz: float) -> float | None:
    """Largest cell [m] of the plate above a room for modes up to a frequency; None of other parts."""
    structure = study.structure
    if not isinstance(structure, Structure):
        return None
    on = {surface.name: surface.on for surface in structure.surfaces}.get(plan.under)
    part = next((one for one in structure.parts if one.name == on), None)
    return None if part is None else cell_for(part, up_to_hz)


def room_silent() -> Finding:
    """A room whose surfaces do not move: it has no levels."""
    return Finding(
        "room-silent",
        "none of its surfaces moves: its levels are blank, and its pressures are 0. Join what moves it to what is "
        "struck, or leave the room out",
    )


def blank_bands(method: Method, end_hz: float) -> tuple[float, ...]:
    """Nominal centres [Hz] of the bands of a method whose filters pass what lies above a frequency."""
    centres = nominal_bands(method.fraction)
    return tuple(band for band in method.bands_hz if not passes_below(centres[band], end_hz, method.fraction))


def blanks_before(cases: Sequence[Case], solved: Mapping[str, float] = _SOLVED) -> list[tuple[str, Finding]]:
    """What the modes that cases ask for will leave blank of the rated bands of their rooms, by room; each once, with
    the smallest cell that any of its cases needs.

    Parameters
    ----------
    solved : Mapping[str, float]
        What the modes of cases are complete to [Hz], by case, where that is known; of others it is what they ask for,
        and nothing is told of a number of modes.
    """
    found: dict[tuple[str, str], tuple[list[str], Finding]] = {}
    for case in cases:
        end = solved.get(case.name, case.study.extent.up_to_hz or inf)
        for plan in case.study.rooms:
            for finding in blank_findings(plan, case.study, end):
                cell = finding.values.get("cell_m")
                key = plan.name, finding.message.replace(_mesh(cell), "")
                names, known = found.get(key, ([], finding))
                finest = finding if cell is not None and cell < known.values.get("cell_m", inf) else known
                found[key] = [*names, case.name], finest
    return [
        (
            room if len(names) == len(cases) else f"{room} ({', '.join(names)})",
            finding,
        )
        for (room, _), (names, finding) in found.items()
    ]


# ----------------------------------------------------------------------------------------------------------------------
# What a study's own numbers say against it before anything is computed.
# ----------------------------------------------------------------------------------------------------------------------

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
    about: list[tuple[str, Advice | Finding]] = []
    about += [(plan.name, one) for plan in study.rooms for one in flanking_findings(plan, places)]
    about += [(plan.name, one) for plan in study.rooms for one in near_microphones(plan, study, places)]
    about += [(plan.name, one) for plan in study.rooms for one in missed_times(plan)]
    found += room_findings(about)
    if time is not None:
        found += _preloads_that_add(study)
        found += hammer_findings(study, places)
        found += load_findings(study.loads, time.duration)
        found += _coarse_loads(study, time)
        found += _blows_left_out(study, time)
        found += _sources_unresolved(study, time)
        noted = [(plan.name, one) for plan in study.rooms for one in rated_findings(plan, study, len(case.studies))]
        found += room_findings(noted)
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


# ----------------------------------------------------------------------------------------------------------------------
# The one judgement that every command goes through: what is to be known before a solution, and with the modes.
# ----------------------------------------------------------------------------------------------------------------------


def early_findings(case: Case, own: MeshedStructure) -> tuple[Finding, ...]:
    """All that can be said of a case without its modes, by rank."""
    before = structure_findings_before(own.structure, own.model, case.studies, case.study.extent.up_to_hz)
    return rank_findings((*before, *study_findings(case, own.places)))


def all_findings(
    solved: Solved,
    basis: ModalBasis,
    studies: Sequence[Study] = (),
    requests: Sequence[FrfRequest] = (),
    up_to_hz: float | None = None,
) -> tuple[Finding, ...]:
    """All that can be said of a structure and its modes, by rank.

    Parameters
    ----------
    basis : ModalBasis
        With its damping.
    studies : Sequence[Study]
        Of one case; they excite it alike.
    requests : Sequence[FrfRequest]
        Frequency responses that are asked of it.
    up_to_hz : float | None
        The highest frequency that is looked at [Hz]; without it the mesh is judged as far as the modes are complete.
    """
    return rank_findings(
        (
            *structure_findings(solved, basis, studies, up_to_hz),
            *undamped_motion(studies, basis),
            *(finding for request in requests for finding in undamped_findings(basis, request)),
            *(finding for study in studies[:1] for one in study.vibration for finding in beyond_modes(one, basis)),
            *(
                doubt
                for study in studies[:1]
                for one in study.evaluations
                for doubt in one.doubts(basis.complete_below_hz)
            ),
        )
    )


def merge_case_findings(by_case: Mapping[str, Sequence[Finding]]) -> tuple[Finding, ...]:
    """Findings of cases by name, each once, with the names of its cases where it is not of all; by rank.

    >>> sags, rings = Finding("a", "It sags."), Finding("b", "It rings.")
    >>> [finding.message for finding in merge_case_findings({"as given": [sags], "stiffer": [sags, rings]})]
    ['It sags.', 'It rings. (case stiffer)']
    """
    names: dict[tuple[str, str], list[str]] = {}
    first: dict[tuple[str, str], Finding] = {}
    for case, findings in by_case.items():
        for finding in findings:
            key = (finding.code, finding.message)
            names.setdefault(key, [])
            if case not in names[key]:
                names[key].append(case)
            first.setdefault(key, finding)

    def placed(key: tuple[str, str]) -> Finding:
        own = names[key]
        if len(own) == len(by_case):
            return first[key]
        return replace(first[key], message=f"{key[1]} (case{'s' if len(own) > 1 else ''} {list_some(own)})")

    return rank_findings([placed(key) for key in first])
