"""Rated bands that the modes of a floor or of its room leave blank, reported before anything is computed and after."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import ceil, inf
from types import MappingProxyType
from typing import Final

from acoustics.levels.bands import octave_bands, third_octave_bands
from acoustics.levels.ending import filtered
from acoustics.levels.methods import Method
from femstruct.errors import Finding
from femstruct.model.structure import Structure
from femstruct.parts.findings.waves import cell_for
from femstruct.study.asked import RoomPlan
from femstruct.study.study import Case, Study
from femstruct.workflow.continuation.statistical_rooms import fillable, statistical_plate
from femstruct.workflow.stages.rated_rooms import method_for

_SOLVED: Final[Mapping[str, float]] = MappingProxyType({})
_FAST_HZ: Final = 1e6  # a sampling that has all bands


def blank_findings(plan: RoomPlan, study: Study, complete_below_hz: float) -> tuple[Finding, ...]:
    """A finding where modes that are complete below a frequency leave rated bands of a room blank.

    complete_below_hz : of the floor; a room of any shape has modes of its own that end.
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
    told = f"{blank[0]:g} Hz is" if len(blank) == 1 else f"{blank[0]:g} to {blank[-1]:g} Hz are"
    all_of_them = len(blank) == len(method.bands_hz)
    numbers = "there is no single number" if all_of_them else "single numbers are lower bounds ('at least')"
    whose = "floor" if complete_below_hz <= plan.complete_below_hz else "room"
    up_to = 10 * ceil(method.passed_hz / 10)
    cell = _cell(plan, study, up_to) if whose == "floor" else None
    return (
        Finding(
            "rating-beyond-modes",
            f"the filters of the rated {method.bands}s pass what is below {method.passed_hz:.0f} Hz, the modes of the "
            f"{whose} end at {end:.0f} Hz: {told} blank{f', and {numbers}' if method.numbers else ''}. Give the "
            f"{whose} 'modes: {{up_to: {up_to} Hz}}'{_mesh(cell)}{instead}",
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
    centres = octave_bands(_FAST_HZ) if method.fraction == 1 else third_octave_bands(_FAST_HZ)
    return tuple(band for band in method.bands_hz if not filtered(centres[band], end_hz, method.fraction))


def blanks_before(cases: Sequence[Case], solved: Mapping[str, float] = _SOLVED) -> list[tuple[str, Finding]]:
    """What the modes that cases ask for will leave blank of the rated bands of their rooms, by room; each once, with
    the smallest cell that any of its cases needs.

    solved : what the modes of cases are complete to [Hz], by case, where that is known; of others it is what they ask
        for, and nothing is told of a number of modes.
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
