"""Maps of the pressure on a plane of a room."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib.figure import Figure

from acoustics.levels import REFERENCE_PA
from acoustics.maps import PressureMap, pressure_map
from acoustics.room import Receiver
from femstruct.radiation import surface_velocity
from femstruct.study.result import StudyResult
from femstruct.view.figures import new_figure, panels

LOUDEST: Final = 4


def pressure_maps(result: StudyResult, room: str) -> Figure | None:
    """Pressure on the horizontal plane of a room's first receiver, at the loudest modes of the baseline.

    None where the baseline has no such room, no response or no mode that is heard.
    """
    case = result.cases[result.plan.baseline]
    plan = next((item for item in case.case.study.rooms if item.name == room), None)
    model = result.models.get(case.basis_key)
    if plan is None or room not in case.rooms or case.response is None or model is None:
        return None
    frequencies = loudest_modes(result, room)
    if not frequencies:
        return None
    ceiling = surface_velocity(case.response, model.surfaces[plan.under], plan.room, plan.offset)
    height = float(plan.receivers[0].position[2])
    drawn = pressure_map(ceiling, plan.room, list(frequencies.values()), at=height)
    names = [f"mode {mode}, {frequency:.1f} Hz" for mode, frequency in frequencies.items()]
    return draw_map(drawn, names, plan.receivers, f"{result.plan.baseline}: pressure in {room} at z = {height:g} m")


def loudest_modes(result: StudyResult, room: str) -> dict[int, float]:
    """Numbers and frequencies [Hz] of the baseline's elastic modes that are loudest at a room's first receiver."""
    case = result.cases[result.plan.baseline]
    heard = case.rooms[room]
    strength = np.interp(case.basis.frequency_hz, heard.frequency_hz, np.abs(heard.spectrum[0]))
    elastic = [mode for mode, kind in enumerate(case.basis.kind) if kind == "elastic"]
    within = [mode for mode in elastic if case.basis.frequency_hz[mode] < heard.frequency_hz[-1] and strength[mode] > 0]
    chosen = sorted(sorted(within, key=lambda mode: -strength[mode])[:LOUDEST])
    return {mode + 1: float(case.basis.frequency_hz[mode]) for mode in chosen}


def draw_map(drawn: PressureMap, names: Sequence[str], receivers: Sequence[Receiver], title: str) -> Figure:
    """A pane a frequency: the pressure in phase with its largest value, red compressed and blue rarefied.

    drawn : normal to z. names : one a frequency. The range of the level over the plane stands above each pane.
    """
    count = len(drawn.frequency_hz)
    width, height = 1.6 + 3.3 * count, 3.9
    figure = new_figure(width, height, f"{title};  Re P / max |P|, red and blue of opposite phase")
    (row,) = panels(figure, 1, count, between=0.0, top=0.85, right=0.85)
    images = []
    for axes, spectrum, name in zip(row, drawn.spectrum, names, strict=True):
        level = 20.0 * np.log10(np.maximum(np.abs(spectrum), np.finfo(float).tiny) / REFERENCE_PA)
        largest = spectrum.ravel()[np.abs(spectrum).argmax()]
        shown = np.real(spectrum / largest) if largest else np.zeros(spectrum.shape)
        half = drawn.first[1] / 2.0, drawn.second[1] / 2.0  # a pixel is centred on its point
        sides = (-half[0], drawn.first[-1] + half[0], -half[1], drawn.second[-1] + half[1])
        image = axes.imshow(
            shown.T, origin="lower", extent=sides, cmap="RdBu_r", vmin=-1.0, vmax=1.0, interpolation="bilinear"
        )
        axes.set_xlim(0.0, drawn.first[-1])
        axes.set_ylim(0.0, drawn.second[-1])
        images.append(image)
        for receiver in receivers:
            axes.plot(*receiver.position[:2], "k+", markersize=9)
            axes.annotate(receiver.name, receiver.position[:2], (5, 5), textcoords="offset points", fontsize=8)
        axes.set_aspect("equal")
        axes.set_title(f"{name}\n{level.min():.0f} to {level.max():.0f} dB re 20 µPa/Hz", fontsize=8)
        axes.set_xlabel("x in m")
        axes.tick_params(labelsize=8)
    row[0].set_ylabel("y in m")
    scale = figure.add_axes((1.0 - 0.65 / width, 0.6 / height, 0.13 / width, 1.0 - 1.5 / height))
    figure.colorbar(images[-1], cax=scale, ticks=(-1.0, 0.0, 1.0), label="of the largest")
    return figure
