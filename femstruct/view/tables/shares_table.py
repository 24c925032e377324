"""Rooms that several surfaces move: who makes which band."""

from __future__ import annotations

from math import isnan

from femstruct.sound.flanking import SurfaceShares, summed_db
from femstruct.study.result import StudyResult
from femstruct.view.tables.grid import Grid


def shares_by_surface(result: StudyResult) -> Grid:
    """A row for every surface: its part of the energy that the air takes up, how loud it is alone, where it is most."""
    grid = Grid(
        "sound by surface, all third octaves that are complete, whole window",
        ("room", "case", "surface", "wall", "active energy", "L_E alone [dB]", "together [dB]", "most at [Hz]"),
        keys=4,
    )
    for case, found in result.cases.items():
        for room, shares in found.by_surface.items():
            whole = float(shares.energy_j.sum())
            for row, name in enumerate(shares.surfaces):
                part = float(shares.energy_j[row].sum()) / whole if whole > 0 else float("nan")
                most = shares.bands_hz[shares.alone_db[row].argmax()] if not isnan(shares.over_db(row)) else None
                grid.add(
                    room,
                    case,
                    name,
                    shares.walls[row],
                    "-" if isnan(part) else f"{100 * part:.3g} %",
                    _decibel(shares.over_db(row)),
                    _decibel(summed_db(shares.together_db)),
                    "-" if most is None else f"{most:g}",
                )
    return grid


def bands_by_surface(result: StudyResult) -> Grid:
    """The baseline's bands: level of all surfaces together, of each alone, and its part of the active energy."""
    rooms = result.cases[result.comparison.baseline].by_surface
    names = dict.fromkeys(name for shares in rooms.values() for name in shares.surfaces)
    grid = Grid(
        f"sound by surface in third octaves, {result.comparison.baseline}: L_E alone [dB], part of the active energy",
        ("room", "f [Hz]", "together", *names),
        keys=2,
    )
    for room, shares in rooms.items():
        for band in range(len(shares.bands_hz)):
            cells = (_cell(shares, name, band) for name in names)
            grid.add(room, f"{shares.bands_hz[band]:g}", _decibel(float(shares.together_db[band])), *cells)
    return grid


def _cell(shares: SurfaceShares, name: str, band: int) -> str:
    if name not in shares.surfaces:
        return ""
    row = shares.surfaces.index(name)
    level, part = float(shares.alone_db[row, band]), float(shares.share[row, band])
    return f"{_decibel(level)}, {'-' if isnan(part) else f'{100 * part:.0f} %'}"


def _decibel(value: float) -> str:
    return "-" if isnan(value) else f"{value:.1f}"
