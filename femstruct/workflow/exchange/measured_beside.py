"""Measured modes of a universal file beside the modes of a model, as the command line asks for it."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np

from femstruct.errors import InputError
from femstruct.files.exchange.uff_reading import read_uff
from femstruct.files.tables.json_numbers import number
from femstruct.language import read_model_file
from femstruct.modal.basis import ModalBasis
from femstruct.modal.measured.correlation import Correlation, correlation
from femstruct.modal.measured.measurement import MeasuredModes
from femstruct.model.refine import refined
from femstruct.study.asked import Extent
from femstruct.units import quantity
from femstruct.workflow.check.asked_modes import damped_as_far_as_solved
from femstruct.workflow.progress import Progress
from femstruct.workflow.stages.modal_bases import shown_in_air, solve
from femstruct.workflow.stages.positions import positioned

BEYOND: Final = 1.5  # times the highest measured frequency: a model too stiff by a third still has its partner
DIVISIONS: Final = 4
_TOO_FEW: Final = (
    "a group of near-equal frequencies has as many modes as displacements were measured, so everything is like it; "
    "use a smaller --near, or more places"
)
Table = dict[str, Any]


def measured_beside(
    path: Path,
    file: Path,
    extent: Extent | None,
    near: str,
    length: str,
    overrides: tuple[str, ...],
    tell: Progress,
) -> Table:
    """Table of measured modes with their partners in a model, and of the MAC of all of them.

    extent : of the model's modes; None for all up to 1.5 times the highest measured frequency.

    Raises InputError for a file without modes, and as `correlation` and `read_uff`.
    """
    width, unit = _option(near, "--near", "ratio"), _option(f"1 {length}", "--length", "length")
    if not 0.0 <= width < 1.0:
        raise InputError("--near", got=near, expected="0 % to below 100 %")
    measurement = read_uff(file, unit)
    measured = measurement.modes
    if measured is None:
        raise InputError(str(file), got="no modes", expected="modes in data sets 55 or 2414")
    highest = BEYOND * float(measured.frequency_hz[-1])
    if extent is None and not highest > 0.0:
        raise InputError(str(file), got="rigid modes alone", expected="a frequency above 0 Hz", do="give --count")
    source = read_model_file(path, overrides)
    with positioned(source):
        tell("modes")
        solved = solve(source.structure, extent or Extent(up_to_hz=highest))
        if solved.model is None:
            raise InputError(str(path), got="a structure in closed form", expected="a model with parts")
        basis = shown_in_air(damped_as_far_as_solved(solved.basis, source.damping), solved)
        found = correlation(measured, basis, refined(solved.model, DIVISIONS), width)
    return {
        "title": source.title,
        "measured": measurement.title or file.name,
        "places": len(measured.points),
        "directions": found.directions,
        "farthest_m": float(found.distances.max(initial=0.0)),
        "notes": [*measurement.notes, *([_TOO_FEW] if found.too_few else [])],
        "modes": [_row(measured, basis, found, mode) for mode in range(len(measured.frequency_hz))],
        "model_frequency_hz": basis.frequency_hz[basis.modes].tolist(),
        "mac": found.pairs.mac.tolist(),
    }


def _row(measured: MeasuredModes, basis: ModalBasis, found: Correlation, mode: int) -> Table:
    pairs = found.pairs
    partner = int(pairs.partner[mode])
    own, hz = float(measured.frequency_hz[mode]), float(basis.frequency_hz[partner])
    together = np.flatnonzero(pairs.groups_b == pairs.groups_b[partner])
    return {
        "mode": mode + 1,
        "frequency_hz": own,
        "damping_ratio": float(measured.damping_ratio[mode]),
        "model_mode": partner + 1,
        "model_frequency_hz": hz,
        "model_damping_ratio": number(basis.damping_ratio[partner]),
        "difference": hz / own - 1.0 if own else None,
        "mac": float(pairs.mac[mode, partner]),
        "group_mac": pairs.alike(mode),
        "group": (together + 1).tolist(),
    }


def _option(text: str, option: str, dimension: str) -> float:
    try:
        return quantity(text, dimension)
    except InputError as error:
        raise InputError(option, got=error.got, expected=error.expected, do=error.do) from error
