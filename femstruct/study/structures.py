"""What a study is about: a structure of parts, or one known in closed form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.modal.closed_form import beam, rod
from femstruct.model.structure import Structure
from femstruct.study.asked import Extent
from femstruct.tags import stored_as

BeamEnd = Literal["pinned", "free", "clamped"]


@stored_as("oscillator model/1")
@dataclass(frozen=True)
@checked("structure")
class OscillatorModel:
    """`structure: {type: oscillator}`: a mass on a spring, moving along z; frequency or stiffness is given.

    >>> OscillatorModel(mass=2.0, frequency_hz=10.0, stiffness=None, points={"top": 1.0}).mass
    2.0
    """

    mass: float
    frequency_hz: float | None
    stiffness: float | None
    points: Mapping[str, float]


@stored_as("rod model/1")
@dataclass(frozen=True)
@checked("structure")
class RodModel:
    """`structure: {type: rod}`: a free elastic rod along x; points by their position [m] along it.

    A rod of steel, 1 m long, struck at one end:

    >>> RodModel(1.0, E=210e9, rho=7850.0, area=1e-4, modes=50, points={"tip": 0.0, "end": 1.0}).points["end"]
    1.0
    """

    length: float
    E: float
    rho: float
    area: float
    modes: int
    points: Mapping[str, float]


@stored_as("beam model/1")
@dataclass(frozen=True)
@checked("structure")
class BeamModel:
    """`structure: {type: beam}`: a beam along x deflecting along z; points by their position [m] along it.

    A pinned beam of steel, 20 mm x 10 mm x 1 m:

    >>> BeamModel(1.0, ("pinned", "pinned"), EI=350.0, mass_per_length=1.57, modes=20, points={"middle": 0.5}).ends
    ('pinned', 'pinned')
    """

    length: float
    ends: tuple[BeamEnd, BeamEnd]
    EI: float
    mass_per_length: float
    modes: int
    points: Mapping[str, float]


@stored_as("structure by its modes/1")
@dataclass(frozen=True)
@checked("structure")
class ModesModel:
    """`structure: {type: modes}`: given modes [Hz], damping ratios [1] and mass-normalised shapes at points, along the
    axis their study moves along; at : positions along it [m], of the points that have one.

    Two measured modes of a frame, with their shapes at one point:

    >>> ModesModel((12.4, 31.0), (0.01, 0.02), {"head": (0.71, -0.33)}).points["head"]
    (0.71, -0.33)
    """

    frequency_hz: tuple[float, ...]
    ratio: tuple[float, ...]
    points: Mapping[str, tuple[float, ...]]
    at: Mapping[str, float] = field(default_factory=dict)


@stored_as("no structure/1")
@dataclass(frozen=True)
class NoStructure:
    """`structure: none`: only bodies and the ground.

    Two balls that meet in the air have none; `Study` says what they do:

    >>> NoStructure()
    NoStructure()
    """


StructureModel = Structure | OscillatorModel | RodModel | BeamModel | ModesModel | NoStructure


# ----------------------------------------------------------------------------------------------------------------------
# How many modes of a structure in closed form a study asks for.
# ----------------------------------------------------------------------------------------------------------------------


def with_mode_count(structure: StructureModel, extent: Extent) -> StructureModel:
    """The structure with the modes that a study asks for, where it is given modes, a rod or a beam.

    It never gets more than it has. Of others the solver finds as many as are asked for; an oscillator has one.

    Raises InputError where no mode is left.

    >>> two = ModesModel((6.0, 280.0), (0.0, 0.01), {"bed": (0.14, 0.39)})
    >>> with_mode_count(two, Extent(up_to_hz=100.0))
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
