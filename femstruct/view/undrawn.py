"""Why a picture of a study has nothing to show: a sentence of each, "" where it can be drawn."""

from __future__ import annotations

from typing import Final

from femstruct.study.results import CaseResult, StudyResult
from femstruct.view.spectra import spectrum_end_hz

FEWEST_LINES: Final = 8  # of a spectrum that is drawn
WITH_SPECTRUM: Final = ("velocity", "acceleration", "net force")  # what a channel's name ends or begins with
_AT_REST: Final = "nothing is simulated"


def no_spectrum(result: StudyResult, channel: str) -> str:
    """Of a channel: one that has decibels, of a point, and a record with enough lines below the end of the basis."""
    cases = [case for case in result.cases.values() if channel in case.channels]
    responses = [case.response for case in cases if case.response is not None]
    if not any(channel.endswith(word) or channel.startswith(word) for word in WITH_SPECTRUM):
        return "only velocities, accelerations and net forces have a spectrum"
    if any(response.blows for response in responses):
        return "the blows are repeated: the spectrum is a comb of their interval"
    if any(channel.rpartition(" ")[0] in response.bodies for response in responses):
        return "it is the motion of a body by itself"
    if not any(case.channels[channel].whole for case in cases):
        return "it is zero"
    top = min(spectrum_end_hz(_baseline(result).basis, response.clock.sampling) for response in responses)
    short = top * min(response.clock.duration for response in responses) < FEWEST_LINES
    return "the record is too short for the modes of the structure" if short else ""


def no_stresses(result: StudyResult) -> str:
    """Of the largest stresses of parts."""
    stressed = any(channel.stressed is not None for case in result.cases.values() for channel in case.channels.values())
    return "" if stressed else "no stress is recorded: add 'record: {PART: stress}'"


def no_contact_forces(result: StudyResult) -> str:
    """Of contacts that are no recorded channels, which have pictures of their own."""
    recorded = {name for case in result.cases.values() for name in case.channels}
    contacts = {name for case in result.cases.values() if case.response is not None for name in case.response.contacts}
    if not contacts:
        return "there are no contacts"
    return "" if any(f"{name} force" not in recorded for name in contacts) else "all contact forces are recorded"


def no_bodies(result: StudyResult) -> str:
    """Of the motion of bodies."""
    moves = any(case.response.bodies for case in result.cases.values() if case.response is not None)
    return "" if moves else "there are no bodies"


def no_energy(result: StudyResult) -> str:
    """Of the energy over time."""
    return "" if any(case.response is not None for case in result.cases.values()) else _AT_REST


def no_sound_energy(result: StudyResult, room: str) -> str:
    """Of what a surface radiates into a half space."""
    energies = [case.radiated[room].energy.energy_j for case in result.cases.values() if room in case.radiated]
    return "" if any(energy > 0 for energy in energies) else "nothing radiates there"


def no_levels(result: StudyResult, room: str) -> str:
    """Of the levels over time."""
    received = any(room in case.rooms and case.rooms[room].receivers for case in result.cases.values())
    return "" if received else "the room has no receivers"


def no_own_sound(result: StudyResult, room: str) -> str:
    """Of the sound of the bodies themselves."""
    radiated = any(room in case.heard.own for case in result.cases.values())
    return "" if radiated else "no body radiates there: only one with a 'radius' beside a half space does"


def no_rating(result: StudyResult, room: str) -> str:
    """Of rated bands."""
    rated = any(room in case.rated for case in result.cases.values())
    return "" if rated else "the room is not rated: 'levels:' names the standards"


def no_closed_room(result: StudyResult, room: str) -> str:
    """Of the pressure inside a room of the baseline."""
    case = _baseline(result)
    plan = next((item for item in case.case.study.rooms if item.name == room), None)
    if plan is None or room not in case.rooms:
        return "the baseline has no such room"
    if not plan.room.bounded:
        return "open air has no walls"
    if result.models.get(case.basis_key) is None:
        return "the structure is in closed form"
    return "" if case.response is not None else _AT_REST


def no_model(result: StudyResult) -> str:
    """Of the structure of the baseline."""
    model = result.models.get(_baseline(result).basis_key)
    if model is None:
        return "the structure is in closed form"
    return "" if model.parts else "there is no structure"


def no_shapes(result: StudyResult) -> str:
    """Of the modes of any case."""
    if all(model is None for model in result.models.values()):
        return "the structure is in closed form"
    elastic = any("elastic" in case.basis.kind for case in result.cases.values())
    return "" if elastic else "all modes are rigid-body modes"


def _baseline(result: StudyResult) -> CaseResult:
    return result.cases[result.plan.baseline]
