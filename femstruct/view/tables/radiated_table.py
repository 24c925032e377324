"""Sound energy into the open, what measured sources send into structures and rooms, and rooms that several surfaces
move: who makes which band."""

from __future__ import annotations

from math import isfinite, isnan, nan

from femstruct.sound.flanking import SurfaceShares, summed_db
from femstruct.study.result import StudyResult
from femstruct.view.tables.grid import Grid
from femstruct.view.tables.scales import scaled


def radiated(result: StudyResult) -> Grid:
    """Levels re 1 pJ, energy, difference to the baseline, efficiency, share of what was put in, loudest band."""
    rooms = dict.fromkeys(room for case in result.cases.values() for room in case.radiated)
    rows = [(room, name, c.radiated[room]) for room in rooms for name, c in result.cases.items() if room in c.radiated]
    factor, unit = scaled("J", max((one.energy.energy_j for _, _, one in rows), default=0.0))
    grid = Grid(
        "sound energy radiated by surfaces into the open, whole window",
        (
            "room",
            "case",
            "L_J [dB re 1 pJ]",
            "L_JA [dB]",
            "difference [dB]",
            f"energy [{unit}]",
            "efficiency",
            "of the energy put into the structure",
            "most at [Hz]",
        ),
        keys=2,
    )
    baseline = result.cases[result.comparison.baseline].radiated
    for room, name, one in rows:
        energy = one.energy
        first = baseline.get(room)
        bands = {band: one for band, one in energy.bands_j.items() if isfinite(one)}
        change = energy.level_db - first.energy.level_db if first is not None else float("nan")
        grid.add(
            room,
            name,
            _decibel(energy.level_db),
            _decibel(energy.weighted_db),
            "" if name == result.comparison.baseline else f"{change:+.1f}" if isfinite(change) else "-",
            f"{factor * energy.energy_j:.4g}",
            f"{energy.efficiency:.3g}" if isfinite(energy.efficiency) else "-",
            f"{100 * one.share:.2g} %" if isfinite(one.share) else "-",
            f"{max(bands, key=lambda band: bands[band]):g}" if energy.energy_j > 0 and bands else "-",
        )
    return grid


def installed(result: StudyResult) -> Grid:
    """A row for every measured source, quantity and case: its bands, and the A-weighted level of a receiver."""
    found = [(name, case, one) for case, own in result.cases.items() for name, one in own.sources.items()]
    bands = sorted({band for _, _, one in found for band in one.power_db})
    title = "measured sources: sound power into the structure [dB re 1 pW], levels [dB re 20 µPa] (-: beyond the modes)"
    grid = Grid(title, ("source", "", "case", *(f"{band:g} Hz" for band in bands), "A"), keys=3)
    for name, case, one in found:
        grid.add(name, "L_Ws", case, *(_decibel(one.power_db.get(band, nan)) for band in bands), "")
        for receiver, heard in one.levels.items():
            levels = (_decibel(heard.bands_db.get(band, nan)) for band in bands)
            grid.add(name, receiver, case, *levels, _decibel(heard.l_aeq_db))
    return grid


def _decibel(value: float) -> str:
    return f"{value:.1f}" if isfinite(value) else "-"


def shares_by_surface(result: StudyResult) -> Grid:
    """A row for every surface: its part of the energy that the air takes up, how loud it is alone, where it is most."""
    grid = Grid(
        "sound by surface, all third octaves that are complete, whole window; - of a surface: it does not move",
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
                    _level(shares.over_db(row)),
                    _level(summed_db(shares.together_db)),
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
            grid.add(room, f"{shares.bands_hz[band]:g}", _level(float(shares.together_db[band])), *cells)
    return grid


def _cell(shares: SurfaceShares, name: str, band: int) -> str:
    if name not in shares.surfaces:
        return ""
    row = shares.surfaces.index(name)
    level, part = float(shares.alone_db[row, band]), float(shares.share[row, band])
    return f"{_level(level)}, {'-' if isnan(part) else f'{100 * part:.0f} %'}"


def _level(value: float) -> str:
    return "-" if isnan(value) else f"{value:.1f}"
