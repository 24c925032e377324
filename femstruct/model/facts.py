"""Facts of a meshed model for its reader: masses, the box around it, how many nodes and cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from femstruct.arrays import Floats, freeze, frozen
from femstruct.conventions import DIRECTIONS
from femstruct.errors import InputError
from femstruct.model.model import Model
from femstruct.model.structure import HARD, SIMPLE


def part_masses(model: Model) -> dict[str, float]:
    """Mass of every part that has one, by name [kg]."""
    masses = {name: part.mass for name, part in model.parts.items()}
    for inert in model.inerts:
        masses[inert.name] = masses.get(inert.name, 0.0) + inert.total
    return {name: mass for name, mass in masses.items() if mass > 0}


def simple_edges(model: Model) -> dict[str, str]:
    """Whether simple supports of edges are "hard" or "soft", by name: those of thin plates, and of sets and boxes of
    slabs and shells that hold no rotation, or the tangential one alone."""
    found = {}
    for item in model.structure.supports:
        part = None if item.on is None else model.parts.get(item.on)
        if part is None or not part.has_rotations or not len(part.quads):
            continue
        if item.region is None:
            if item.fix in (*SIMPLE, "roller") and (item.edge is not None or item.line is not None):
                found[item.name] = "hard"
        elif item.fix == HARD:
            found[item.name] = "hard"
        elif item.fix and item.fix != "clamped" and (item.fix in SIMPLE or set(item.fix) <= set(DIRECTIONS[:3])):
            found[item.name] = "soft"
    return found


def refuse_unweighed(model: Model, axes: str, what: str) -> None:
    """Raise InputError for parts that accelerations along some of the axes push as is not known."""
    for name, part in model.parts.items():
        if lost := [axis for axis in axes if axis in part.unweighed]:
            raise InputError(
                f"parts.{name}",
                got=f"{what} of matrices that hold some of their nodes along {lost[0]}, and do not say what mass lies "
                "between those and the rest",
                expected="matrices without supports, a lumped mass matrix, or a file of femstruct export",
                do="write the supports in the model",
            )


@dataclass(frozen=True, eq=False)
class ModelFacts:
    """What `check` reports of a model.

    masses : by part [kg]; total_mass [kg]; low, high [3] : corners of the box around nodes and blocks [m].
    counts : nodes, faces of cells (of plates, shells and solids), bars, blocks where there are any.
    """

    masses: dict[str, float]
    total_mass: float
    low: Floats
    high: Floats
    counts: dict[str, int]

    def __post_init__(self) -> None:
        freeze(self, low=frozen("low", self.low, (3,)), high=frozen("high", self.high, (3,)))


def model_facts(model: Model) -> ModelFacts:
    """Masses by part, the box around the structure, and the numbers of nodes and cells."""
    masses = part_masses(model)
    mesh = model.mesh
    corners = np.concatenate([mesh.points, *(part.bounds for part in model.parts.values())])
    counts = {"nodes": mesh.n_nodes, "faces of cells": len(mesh.quads), "bars": len(mesh.bars)}
    rigid = sum(part.rigid for part in model.parts.values())
    counts |= {"blocks": rigid} if rigid else {}
    return ModelFacts(masses, sum(masses.values()), corners.min(axis=0), corners.max(axis=0), counts)
