"""All figures of a study, to a folder."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from femstruct.files.writing import file_name
from femstruct.study.recorded import NET_FORCE
from femstruct.study.results import StudyResult
from femstruct.view import undrawn
from femstruct.view.drawing import save
from femstruct.view.histories import contact_forces, energy, history, spectrum, travels
from femstruct.view.sound_figures import (
    levels_over_time,
    no_power_directivity,
    no_pressure_map,
    no_room_directivity,
    own_sounds,
    power_directivity,
    pressure_maps,
    rated_bands,
    room_directivity,
    sound_energy,
    sound_power,
)
from femstruct.view.spectra import (
    answered,
    frequency_response,
    range_spectrum,
    shock_spectra,
    sound,
    spectra_of,
    vibration_answer,
)

Draw = Callable[..., Figure | None]
Missing = Callable[..., str]


class Drawing(NamedTuple):
    """A figure of a study. why_not : a sentence where it has nothing to show, else ""."""

    draw: Callable[[], Figure | None]
    why_not: Callable[[], str]


def drawings(result: StudyResult) -> dict[str, Drawing]:
    """The figures that a study may have, by file name.

    Frequency responses, channels and their spectra, contacts, bodies, energy, sound, sound energy and where it goes,
    levels over time, the sound of striking bodies themselves, ratings, maps.
    """

    def each(word: str, draw: Draw, names: Iterable[str], why_not: Missing = lambda *_: "") -> dict[str, Drawing]:
        return {
            file_name(word, name): Drawing(partial(draw, result, name), partial(why_not, result, name))
            for name in names
        }

    def one(word: str, draw: Draw, why_not: Missing) -> dict[str, Drawing]:
        return {file_name(word): Drawing(partial(draw, result), partial(why_not, result))}

    cases = result.cases.values()
    responses = dict.fromkeys(name for case in cases for name in case.frf)
    channels = dict.fromkeys(name for case in cases for name in case.channels)
    receivers = dict.fromkeys(
        f"{room}.{receiver.name}"
        for case in cases
        for room, response in case.rooms.items()
        for receiver in response.receivers
    )
    rooms = dict.fromkeys(name for case in cases for name in case.rooms)
    powers = [name for name in responses if any(name in case.frf and case.frf[name].sound for case in cases)]
    open_rooms = dict.fromkeys(name for case in cases for name in case.radiated)
    return {
        **each("frf", frequency_response, [name for name in responses if name not in powers]),
        **each("frf", sound_power, powers),
        **each("directivity", power_directivity, powers, no_power_directivity),
        **each("history", history, [name for name in channels if not _drawn_already(result, name)]),
        **each("spectrum", spectrum, channels, undrawn.no_spectrum),
        **each("shock_spectrum", shock_spectra, dict.fromkeys(name for case in cases for name in spectra_of(case))),
        **each("fatigue", range_spectrum, dict.fromkeys(name for case in cases for name in case.fatigue)),
        **each("vibration", vibration_answer, answered(result.cases)),
        **one("contact_forces", contact_forces, undrawn.no_contact_forces),
        **one("bodies", travels, undrawn.no_bodies),
        **one("energy", energy, undrawn.no_energy),
        **each("sound", sound, receivers),
        **each("sound_energy", sound_energy, open_rooms, undrawn.no_sound_energy),
        **each("directivity", room_directivity, open_rooms, no_room_directivity),
        **each("level", levels_over_time, rooms, undrawn.no_levels),
        **each("own_sound", own_sounds, rooms, undrawn.no_own_sound),
        **each("rated", rated_bands, rooms, undrawn.no_rating),
        **each("pressure_map", pressure_maps, rooms, no_pressure_map),
    }


def figures(result: StudyResult) -> dict[str, Figure]:
    """All figures of a study that have something to show, by file name."""
    made = {name: one.draw() for name, one in drawings(result).items()}
    return {name: figure for name, figure in made.items() if figure is not None}


def _drawn_already(result: StudyResult, channel: str) -> bool:
    """Whether a net force is that of a single contact in every case, which has a picture of its own."""
    if not channel.startswith(NET_FORCE):
        return False
    forces = {
        name: [np.abs(one.force) for one in case.response.contacts.values()]
        for name, case in result.cases.items()
        if channel in case.channels and case.response is not None
    }
    return all(
        any(np.array_equal(np.abs(result.cases[name].channels[channel].values), force) for force in of_contacts)
        for name, of_contacts in forces.items()
    )


def plot_all(result: StudyResult, folder: str | Path) -> list[Path]:
    """Draw all figures of a study as PNG files in a folder that is there; returns their paths.

    Each file is replaced in one step.
    """
    return [save(figure, Path(folder) / name) for name, figure in figures(result).items()]
