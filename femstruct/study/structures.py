"""What a study is about: a structure of parts, or one known in closed form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from femstruct.model.structure import Structure

BeamEnd = Literal["pinned", "free", "clamped"]


@dataclass(frozen=True)
class OscillatorModel:
    """`structure: {type: oscillator}`: a mass on a spring, moving along z; frequency or stiffness is given."""

    mass: float
    frequency_hz: float | None
    stiffness: float | None
    points: Mapping[str, float]


@dataclass(frozen=True)
class RodModel:
    """`structure: {type: rod}`: a free elastic rod along x; points by their position [m] along it."""

    length: float
    E: float
    rho: float
    area: float
    modes: int
    points: Mapping[str, float]


@dataclass(frozen=True)
class BeamModel:
    """`structure: {type: beam}`: a beam along x deflecting along z; points by their position [m] along it."""

    length: float
    ends: tuple[BeamEnd, BeamEnd]
    EI: float
    mass_per_length: float
    modes: int
    points: Mapping[str, float]


@dataclass(frozen=True)
class ModesModel:
    """`structure: {type: modes}`: given modes [Hz], damping ratios [1] and mass-normalised shapes at points, along the
    axis their study moves along; at : positions along it [m], of the points that have one."""

    frequency_hz: tuple[float, ...]
    ratio: tuple[float, ...]
    points: Mapping[str, tuple[float, ...]]
    at: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class NoStructure:
    """`structure: none`: only bodies and the ground."""


StructureModel = Structure | OscillatorModel | RodModel | BeamModel | ModesModel | NoStructure
