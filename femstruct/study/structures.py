"""What a study is about: a structure of parts, or one known in closed form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from femstruct.declared import checked
from femstruct.model.structure import Structure
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
