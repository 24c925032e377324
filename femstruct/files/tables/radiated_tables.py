"""Sound energies, powers and directivities as tables, for JSON and the results file."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

from acoustics.open_air.directivity import Directivity
from femstruct.arrays import Floats
from femstruct.files.results_file.datasets import axis, group, put
from femstruct.files.tables.described import described, write_described
from femstruct.files.tables.json_numbers import label, number
from femstruct.sound.flanking import SurfaceShares
from femstruct.sound.power import PowerResponse, Radiated
from femstruct.study.result import CaseResult

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py

Table = dict[str, Any]


def radiated_table(radiated: Radiated) -> Table:
    """What a surface radiated into a half space; levels re 1 pJ, None in silence."""
    pattern = {"directivity": _pattern_table(radiated.pattern)}
    return described(radiated.energy) | described(radiated) | pattern


def radiated_beside(case: CaseResult, baseline: CaseResult | None) -> Table:
    """By half space, what the level of the sound energy is above the baseline's [dB]; None in silence."""
    before = {} if baseline is None else baseline.radiated
    return {
        room: number(one.energy.level_db - before[room].energy.level_db)
        for room, one in case.radiated.items()
        if room in before and isfinite(before[room].energy.level_db)
    }


def _pattern_table(pattern: Directivity) -> Table:
    """By frequency [Hz]: how much louder the loudest direction is than the mean of the half sphere, and where it is."""
    table = {}
    for line, (frequency, index) in enumerate(zip(pattern.frequency_hz, pattern.index_db, strict=True)):
        circle, angle = pattern.loudest(line)
        table[label(frequency)] = {"index_db": number(index), "along": pattern.sides[circle], "angle_deg": angle}
    return table


def write_radiated(target: h5py.Group, radiated: Radiated) -> None:
    """The same in the results file, with the density of the energy and the directivities."""
    write_described(target, radiated.energy)
    write_described(target, radiated)
    write_pattern(group(target, "directivity", "Where the sound goes"), radiated.pattern, "Pa m/Hz")


def write_power(target: h5py.Group, sound: PowerResponse, frequency: str, unit: str) -> None:
    """What goes with a sound power over frequency: its efficiency, the power put in, directivities."""
    put(target, "efficiency", sound.efficiency, "1", "Radiation efficiency", (frequency,))
    put(target, "put_in", sound.put_in, unit, "Power that the force puts in", (frequency,))
    pattern = group(target, "directivity", "Where the sound goes")
    write_pattern(pattern, sound.pattern, "Pa/N" if unit.endswith("m)^2") else "Pa m/N")


def write_pattern(target: h5py.Group, pattern: Directivity, unit: str) -> None:
    """Far field on two half circles through the surface's normal."""
    frequency = axis(target, "frequency_hz", pattern.frequency_hz, "Hz", "Frequency")
    side = axis(target, "side", list(pattern.sides), "1", "Side of the surface along which the half circle lies")
    angle = axis(target, "angle_deg", pattern.angle_deg, "deg", "From the normal, positive along the side")
    put(target, "pressure", pattern.pressure, unit, "|p| times the distance, far away", (frequency, side, angle))
    mean = "Root of its mean square over the half sphere"
    put(target, "half_sphere", pattern.half_sphere, unit, mean, (frequency,))


def shares_table(shares: SurfaceShares) -> Table:
    """What each surface gives the air of a room: by surface, by third octave; None where nothing is known."""
    bands = [label(band) for band in shares.bands_hz]

    def by_band(values: Floats) -> Table:
        return {band: number(value) for band, value in zip(bands, values, strict=True)}

    each = {
        name: {
            "wall": shares.walls[row],
            "energy_j": by_band(shares.energy_j[row]),
            "share": by_band(shares.share[row]),
            "alone_db": by_band(shares.alone_db[row]),
        }
        for row, name in enumerate(shares.surfaces)
    }
    return {"surfaces": each, "total_j": by_band(shares.total_j), "together_db": by_band(shares.together_db)}


def write_shares(target: h5py.Group, shares: SurfaceShares) -> None:
    """The same in the results file."""
    axis(target, "surface", list(shares.surfaces), "1", "Surface that moves the air")
    put(target, "wall", list(shares.walls), "1", "Wall of the room that it moves", ("surface",))
    write_described(target, shares)
