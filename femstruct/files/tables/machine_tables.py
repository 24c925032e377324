"""Verdicts on limits and the row of a machine as tables, for JSON and the results file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from typing import TYPE_CHECKING, Any

from femstruct.files.results_file.datasets import axis
from femstruct.files.tables.described import described, write_rows
from femstruct.files.tables.json_numbers import number
from femstruct.study.machine import EnergyShare, Machine, Verdict

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py

Table = dict[str, Any]


def verdict_tables(verdicts: Sequence[Verdict]) -> Table:
    """By name of the limit: value, limit, margin (negative where exceeded), the verdict, and of several drops the place
    of the worst."""
    return {one.name: described(one) | {"at": one.at or None} for one in verdicts}


def write_verdicts(target: h5py.Group, verdicts: Sequence[Verdict]) -> None:
    """The same in the results file."""
    write_rows(target, verdicts, axis(target, "name", [one.name for one in verdicts], "1", "What is limited"))


def machine_table(machine: Machine) -> Table:
    """A row of the machine table; numbers that do not exist are None."""
    ground, rest = machine.ground, machine.rest
    return {
        "ground_force": None
        if ground is None
        else {
            "dynamic_n": number(ground.dynamic),
            "with_weight_n": number(ground.with_weight),
            "percent": ground.percent,
            "attenuation_db": ground.attenuation_db,
        },
        "travel_m": {name: number(travel) for name, travel in machine.travels.items()},
        "sags": {sag.part: {"sag_m": sag.sag, "tilt_rad": sag.tilt} for sag in machine.sags},
        "block_modes": [
            {
                "mode": mode.number,
                "frequency_hz": mode.frequency_hz,
                "damping_ratio": mode.ratio if isfinite(mode.ratio) else None,
                "shares": mode.shares,
            }
            for mode in machine.modes
        ],
        "rest": None if rest is None else {"after_s": rest.after, "interval_s": rest.interval},
        "companions": {
            name: {"travel_m": number(one.travel), "closings": one.closings, "seated": one.seated}
            for name, one in machine.companions.items()
        },
        "energy": {
            "at_separation": None if machine.at_separation is None else _share(machine.at_separation),
            "end": _share(machine.at_end),
        },
        "energy_growth": dict(machine.growth),
    }


def _share(share: EnergyShare) -> Table:
    terms = asdict(share)
    return {"t_s": terms.pop("t"), **{f"{name}_j": value for name, value in terms.items()}}
