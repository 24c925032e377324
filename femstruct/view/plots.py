"""All figures of a study, to a folder."""

from __future__ import annotations

from pathlib import Path

from matplotlib.figure import Figure

from femstruct.study.result import StudyResult
from femstruct.view.figures import file_name, save
from femstruct.view.histories import contact_forces, energy, history, travels
from femstruct.view.loudness import levels_over_time, rated_bands
from femstruct.view.maps import pressure_maps
from femstruct.view.spectra import frequency_response, sound
from femstruct.view.vibration import spectrum


def figures(result: StudyResult) -> dict[str, Figure]:
    """All figures of a study by file name: frequency responses, channels and their spectra, contacts, bodies, energy,
    sound, levels over time, ratings, maps."""
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
    made: dict[str, Figure | None] = {
        **{file_name("frf", name): frequency_response(result, name) for name in responses},
        **{file_name("history", name): history(result, name) for name in channels},
        **{file_name("spectrum", name): spectrum(result, name) for name in channels},
        file_name("contact_forces"): contact_forces(result),
        file_name("bodies"): travels(result),
        file_name("energy"): energy(result),
        **{file_name("sound", name): sound(result, name) for name in receivers},
        **{file_name("level", name): levels_over_time(result, name) for name in rooms},
        **{file_name("rated", name): rated_bands(result, name) for name in rooms},
        **{file_name("pressure_map", name): pressure_maps(result, name) for name in rooms},
    }
    return {name: figure for name, figure in made.items() if figure is not None}


def plot_all(result: StudyResult, folder: str | Path) -> list[Path]:
    """Draw all figures of a study as PNG files in a folder that is there; returns their paths.

    Each file is replaced in one step.
    """
    return [save(figure, Path(folder) / name) for name, figure in figures(result).items()]
