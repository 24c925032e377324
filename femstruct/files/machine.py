"""Verdicts on limits and the row of a machine as tables, for JSON and the results file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from femstruct.files.hdf5 import axis, put
from femstruct.study.machine import EnergyShare, Machine, Verdict

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py

Table = dict[str, Any]


def verdict_word(verdict: Verdict) -> str:
    """What a verdict says in a word.

    >>> verdict_word(Verdict("ground force", 7.0, 6.0, "N", False))
    'exceeded'
    """
    unknown = "not known" if verdict.least else "not seen"
    return unknown if verdict.met is None else "met" if verdict.met else "exceeded"


def verdict_tables(verdicts: Sequence[Verdict]) -> Table:
    """By name of the limit: value, limit, margin (negative where exceeded), the verdict, and of several drops the place
    of the worst."""
    return {
        one.name: {
            "value": one.value,
            "limit": one.limit,
            "margin": one.margin,
            "unit": one.unit,
            "verdict": verdict_word(one),
            "at_least": one.least,
            "at": one.at or None,
        }
        for one in verdicts
    }


def write_verdicts(target: h5py.Group, verdicts: Sequence[Verdict]) -> None:
    """The same in the results file."""
    limit = axis(target, "limit", [one.name for one in verdicts], "1", "What is limited")
    put(target, "limit_unit", [one.unit for one in verdicts], "1", "Unit of value, most and margin", (limit,))
    for name, values, what in (
        ("value", [one.value for one in verdicts], "What came out; nan where it is not at rest in time, or not known"),
        ("most", [one.limit for one in verdicts], "What it should not exceed"),
        ("margin", [one.margin for one in verdicts], "What is left up to that, negative beyond"),
    ):
        put(target, name, [np.nan if one is None else one for one in values], "see limit_unit", what, (limit,))
    put(target, "at", [one.at for one in verdicts], "1", "Place of the worst drop, where there are several", (limit,))
    put(
        target,
        "verdict",
        [verdict_word(one) for one in verdicts],
        "1",
        "met, exceeded, not seen, not known",
        (limit,),
    )


def machine_table(machine: Machine) -> Table:
    """A row of the machine table; numbers that do not exist are None."""
    ground, rest = machine.ground, machine.rest
    return {
        "ground_force": None
        if ground is None
        else {
            "dynamic_n": ground.dynamic,
            "with_weight_n": ground.with_weight,
            "percent": ground.percent,
            "attenuation_db": ground.attenuation_db,
        },
        "travel_m": dict(machine.travels),
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
            name: {"travel_m": one.travel, "closings": one.closings, "seated": one.seated}
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
