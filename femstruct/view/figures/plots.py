"""All figures of a study, to a folder."""

from __future__ import annotations

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


def figures(result: StudyResult) -> dict[str, Figure]:
    """All figures of a study by file name: frequency responses, channels and their spectra, contacts, bodies, energy,
    sound, sound energy and where it goes, levels over time, the sound of striking bodies themselves, ratings, maps."""
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
    made: dict[str, Figure | None] = {
        **{file_name("frf", name): frequency_response(result, name) for name in responses if name not in powers},
        **{file_name("frf", name): sound_power(result, name) for name in powers},
        **{file_name("directivity", name): power_directivity(result, name) for name in powers},
        **{file_name("history", name): history(result, name) for name in channels if not _drawn_already(result, name)},
        **{file_name("spectrum", name): spectrum(result, name) for name in channels},
        file_name("contact_forces"): contact_forces(result),
        file_name("bodies"): travels(result),
        file_name("energy"): energy(result),
        **{file_name("sound", name): sound(result, name) for name in receivers},
        **{file_name("sound_energy", name): sound_energy(result, name) for name in open_rooms},
        **{file_name("directivity", name): room_directivity(result, name) for name in open_rooms},
        **{file_name("level", name): levels_over_time(result, name) for name in rooms},
        **{file_name("own_sound", name): own_sounds(result, name) for name in rooms},
        **{file_name("rated", name): rated_bands(result, name) for name in rooms},
        **{file_name("pressure_map", name): pressure_maps(result, name) for name in rooms},
    }
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
