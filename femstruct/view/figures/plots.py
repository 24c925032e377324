"""All figures of a study, to a folder."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from femstruct.files.atomic import file_name
from femstruct.study.result import NET_FORCE, StudyResult
from femstruct.view.figures.drawing import save
from femstruct.view.figures.histories import contact_forces, energy, history, travels
from femstruct.view.figures.loudness import levels_over_time, rated_bands
from femstruct.view.figures.maps import pressure_maps
from femstruct.view.figures.power_figures import power_directivity, room_directivity, sound_energy, sound_power
from femstruct.view.figures.spectra import frequency_response, sound
from femstruct.view.figures.struck_sound import own_sounds
from femstruct.view.figures.vibration import spectrum

Drawing = Callable[[], Figure | None]


def drawings(result: StudyResult) -> dict[str, Drawing]:
    """What draws each figure of a study, by file name; None comes of one that has nothing to show.

    Frequency responses, channels and their spectra, contacts, bodies, energy, sound, sound energy and where it goes,
    levels over time, the sound of striking bodies themselves, ratings, maps.
    """

    def each(word: str, draw: Callable[[StudyResult, str], Figure | None], names: Iterable[str]) -> dict[str, Drawing]:
        return {file_name(word, name): partial(draw, result, name) for name in names}

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
        **each("directivity", power_directivity, powers),
        **each("history", history, [name for name in channels if not _drawn_already(result, name)]),
        **each("spectrum", spectrum, channels),
        file_name("contact_forces"): partial(contact_forces, result),
        file_name("bodies"): partial(travels, result),
        file_name("energy"): partial(energy, result),
        **each("sound", sound, receivers),
        **each("sound_energy", sound_energy, open_rooms),
        **each("directivity", room_directivity, open_rooms),
        **each("level", levels_over_time, rooms),
        **each("own_sound", own_sounds, rooms),
        **each("rated", rated_bands, rooms),
        **each("pressure_map", pressure_maps, rooms),
    }


def figures(result: StudyResult) -> dict[str, Figure]:
    """All figures of a study that have something to show, by file name."""
    made = {name: draw() for name, draw in drawings(result).items()}
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
