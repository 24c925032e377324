"""Maps of the pressure on a plane of a room."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
import scipy
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from acoustics.levels.decibels import decibels
from acoustics.levels.sound_levels import REFERENCE_PA
from acoustics.receivers import Receiver
from acoustics.room_response import RoomResponse
from acoustics.rooms.pressure_maps import PressureMap
from femstruct.arrays import Floats
from femstruct.sound.surface import surface_velocity
from femstruct.study.result import StudyResult
from femstruct.study.room_surfaces import placed_room
from femstruct.view.figures.drawing import new_figure, panels
from femstruct.view.figures.undrawn import no_closed_room

MOST: Final = 4
PROMINENT: Final = 6.0  # dB a peak stands above the valleys beside it
SILENCE: Final = 1e-6  # share of the loudest line below which there are no peaks, only rounding
NEAR: Final = 0.02
COLUMNS: Final = 2  # of panes: what is wider cannot be read on paper
PHASES: Final = "Re P / max |P|, red and blue of opposite phase"
RIM: Final = (withStroke(linewidth=2.5, foreground="white"),)  # to be read on any colour


def pressure_maps(result: StudyResult, room: str) -> Figure | None:
    """Pressure on the horizontal plane of a room's first receiver, at the most prominent peaks of the baseline.

    None where `no_pressure_map` says why.
    """
    if no_pressure_map(result, room):
        return None
    case, frequencies = result.cases[result.plan.baseline], heard_peaks(result, room)
    plan = next(item for item in case.case.study.rooms if item.name == room)
    model = result.models[case.basis_key]
    assert model is not None and case.response is not None
    moving = surface_velocity(case.response, placed_room(plan, model.surfaces))
    height = float(plan.receivers[0].position[2])
    drawn = plan.room.pressure_map(moving, list(frequencies.values()), at=height)
    title = f"{result.plan.baseline}: pressure in {room} at z = {height:g} m"
    return draw_map(drawn, list(frequencies), plan.receivers, title, lines_apart(case.rooms[room]))


def no_pressure_map(result: StudyResult, room: str) -> str:
    """Why there is no map of a room, "" where there is one."""
    return no_closed_room(result, room) or ("" if heard_peaks(result, room) else "no peak stands out of the spectrum")


def heard_peaks(result: StudyResult, room: str) -> dict[str, float]:
    """The loudest peaks of the baseline's sound at a room's first receiver: names and frequencies [Hz].

    Only those that stand out of what is beside them, and none above the modal basis or the room's own modes, where the
    answer is not complete.
    A peak within 2 % of a mode of the structure carries that mode's number, any other is one of the room's or of the
    force.
    """
    case = result.cases[result.plan.baseline]
    heard = case.rooms[room]
    spectrum = np.abs(heard.spectrum[0])
    level = 20.0 * np.log10(np.maximum(spectrum, SILENCE * spectrum.max(initial=0.0)) + np.finfo(float).tiny)
    tops, _ = scipy.signal.find_peaks(level, prominence=PROMINENT)
    tops = tops[heard.frequency_hz[tops] <= min(case.basis.complete_below_hz, heard.complete_below_hz)]
    chosen = np.sort(tops[np.argsort(-level[tops])[:MOST]])
    elastic = np.flatnonzero([kind == "elastic" for kind in case.basis.kind])
    named = {}
    for frequency in heard.frequency_hz[chosen].tolist():
        away = np.abs(case.basis.frequency_hz[elastic] / frequency - 1.0)
        near = int(elastic[away.argmin()]) + 1 if elastic.size and away.min() < NEAR else 0
        named[f"mode {near}, {frequency:.1f} Hz" if near else f"{frequency:.1f} Hz"] = frequency
    return named


def lines_apart(heard: RoomResponse) -> float:
    """Distance of the lines of a record's spectrum [Hz]."""
    return float(heard.frequency_hz[1])


def line_level(size: Floats, apart_hz: float) -> Floats:
    """Levels of lines [dB re 20 uPa] with the magnitude |P| [Pa/Hz] of a record's Fourier transform, as spectra have
    them: the rms of a line is sqrt(2) |P| df.

    >>> float(line_level(np.array([1.0 / np.sqrt(2.0)]), 1.0).round(2)[0])  # 1 Pa
    93.98
    """
    return decibels((np.sqrt(2.0) * apart_hz * size / REFERENCE_PA) ** 2)


def draw_map(
    drawn: PressureMap, names: Sequence[str], receivers: Sequence[Receiver], title: str, apart_hz: float
) -> Figure:
    """A pane a frequency: the pressure in phase with its largest value, red compressed and blue rarefied.

    drawn : normal to z. names : one a frequency. The range of the level over the plane stands above each pane; apart_hz
    : of the lines that have these levels [Hz].
    """
    count = len(drawn.frequency_hz)
    columns = min(count, COLUMNS)
    rows = -(-count // columns)
    width, height = 1.6 + 3.3 * columns, 0.6 + 3.3 * rows
    figure = new_figure(width, height, f"{title}; levels of lines {apart_hz:.3g} Hz apart\n{PHASES}")
    grid = panels(figure, rows, columns, between=0.9, top=0.95, right=0.85)
    for unused in grid.ravel()[count:]:
        unused.remove()
    images = []
    for axes, spectrum, name in zip(grid.ravel()[:count], drawn.spectrum, names, strict=True):
        level = line_level(np.abs(spectrum), apart_hz)
        level = level[np.isfinite(level)]  # nan outside the room
        largest = spectrum.ravel()[np.nanargmax(np.abs(spectrum))]
        shown = np.real(spectrum / largest) if largest else np.zeros(spectrum.shape)
        half = [0.5 * (along[1] - along[0]) for along in (drawn.first, drawn.second)]  # a pixel is centred on its point
        ends = [(along[0], along[-1]) for along in (drawn.first, drawn.second)]
        sides = np.ravel([(low - by, high + by) for (low, high), by in zip(ends, half, strict=True)]).tolist()
        image = axes.imshow(
            shown.T, origin="lower", extent=sides, cmap="RdBu_r", vmin=-1.0, vmax=1.0, interpolation="bilinear"
        )
        axes.set_xlim(*ends[0])
        axes.set_ylim(*ends[1])
        images.append(image)
        for receiver in receivers:
            axes.plot(*receiver.position[:2], "k+", markersize=9, path_effects=RIM)
            axes.annotate(
                receiver.name, receiver.position[:2], (5, 5), textcoords="offset points", fontsize=8, path_effects=RIM
            )  # fmt: skip
        axes.set_aspect("equal")
        axes.set_title(f"{name}\n{level.min():.0f} to {level.max():.0f} dB re 20 µPa", fontsize=8)
        axes.set_xlabel("x in m")
        axes.tick_params(labelsize=8)
    for axes in grid[:, 0]:
        axes.set_ylabel("y in m")
    scale = figure.add_axes((1.0 - 0.65 / width, 0.6 / height, 0.13 / width, 1.0 - 1.5 / height))
    figure.colorbar(images[-1], cax=scale, ticks=(-1.0, 0.0, 1.0), label="of the largest")
    return figure
