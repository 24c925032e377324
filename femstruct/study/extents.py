"""How many modes of a structure in closed form a study asks for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from femstruct.errors import InputError
from femstruct.modal.analytic import beam, rod
from femstruct.study.asked import Extent
from femstruct.study.structures import BeamModel, ModesModel, RodModel, StructureModel


def as_many(structure: StructureModel, extent: Extent) -> StructureModel:
    """The structure with the modes that a study asks for, where it is given modes, a rod or a beam.

    It never gets more than it has. Of others the solver finds as many as are asked for; an oscillator has one.

    Raises InputError where no mode is left.

    >>> two = ModesModel((6.0, 280.0), (0.0, 0.01), {"bed": (0.14, 0.39)})
    >>> as_many(two, Extent(up_to_hz=100.0))
    ModesModel(frequency_hz=(6.0,), ratio=(0.0,), points={'bed': (0.14,)}, at={})
    """
    match structure:
        case ModesModel(frequency_hz, ratio, points, _):
            few = _count(extent, frequency_hz)
            shapes = {name: shape[:few] for name, shape in points.items()}
            return replace(structure, frequency_hz=frequency_hz[:few], ratio=ratio[:few], points=shapes)
        case RodModel(length, E, rho, area, modes, _):
            return replace(structure, modes=_count(extent, rod(length, E, rho, area, modes)[0].frequency_hz))
        case BeamModel(length, ends, EI, mass_per_length, modes, _):
            found = beam(length, EI, mass_per_length, ends, modes)[0]
            return replace(structure, modes=_count(extent, found.frequency_hz[found.modes]))
    return structure


def _count(extent: Extent, frequency_hz: tuple[float, ...] | np.ndarray) -> int:
    if extent.count is not None:
        return min(extent.count, len(frequency_hz))
    if extent.up_to_hz is None:
        return len(frequency_hz)
    few = int(np.sum(np.asarray(frequency_hz) <= extent.up_to_hz))
    if len(frequency_hz) and not few:
        raise InputError(
            "modes.up_to",
            got=f"{extent.up_to_hz:g} Hz",
            expected=f"the first mode or more, {frequency_hz[0]:.5g} Hz",
            do="a plain number is in Hz",
        )
    return few
