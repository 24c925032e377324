"""Facts of a meshed model for its reader: masses, geometry, and what to know before believing its results."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from femstruct.arrays import Floats, freeze, frozen
from femstruct.elements.plate import twist_excess
from femstruct.errors import Finding
from femstruct.model.model import Model, PlateMesh

NOTABLE_SHEAR, GROSS_SHEAR = 0.005, 0.5
"""Estimated error of a plate's first frequency from here on is worth a finding; from there on it is no plate."""


def part_masses(model: Model) -> dict[str, float]:
    """Mass of every part that has one, by name [kg]."""
    masses: dict[str, float] = {}
    for name, plate in model.plates.items():
        width, height = plate.part.size
        masses[name] = plate.part.material.rho * plate.part.thickness * width * height
    for name, frame in model.frames.items():
        masses[name] = frame.part.material.rho * frame.part.section.A * float(frame.lengths.sum())
    for name, block in model.blocks.items():
        masses[name] = block.part.mass
    for inert in model.inerts:
        masses[inert.name] = float(inert.mass[::3].sum())
    return {name: mass for name, mass in masses.items() if mass > 0}


@dataclass(frozen=True, eq=False)
class ModelFacts:
    """What `check` reports of a model.

    masses : by part [kg]; total_mass [kg]; low, high [3] : corners of the box around nodes and blocks [m].
    counts : nodes, plate cells, bars, blocks where there are any.
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
    corners = np.concatenate([mesh.points, *(block.corners for block in model.blocks.values())])
    counts = {"nodes": mesh.n_nodes, "plate cells": len(mesh.quads), "bars": len(mesh.bars)}
    if model.blocks:
        counts["blocks"] = len(model.blocks)
    return ModelFacts(masses, sum(masses.values()), corners.min(axis=0), corners.max(axis=0), counts)


def model_findings(model: Model) -> tuple[Finding, ...]:
    """Reasons to believe the model less: the twist defect of hermite12, plates too thick for Kirchhoff's theory."""
    found = [_twist_defect(plate) for plate in model.plates.values() if plate.part.element == "hermite12"]
    for name, plate in model.plates.items():
        excess = shear_excess(plate)
        if excess > NOTABLE_SHEAR:
            ratio = plate.part.thickness / min(plate.part.size)
            found.append(
                Finding(
                    "thick-plate",
                    f"{name} is {ratio:.2g} of its shorter side thick; without shear and rotary inertia its first "
                    f"frequency is about {100 * excess:.1f} % too high, shorter waves more",
                    {"thickness_to_side": ratio, "first_frequency_excess": excess},
                    severe=excess > GROSS_SHEAR,
                )
            )
    return tuple(found)


def shear_excess(plate: PlateMesh) -> float:
    """Estimated relative excess of the first frequency of a plate for leaving out shear and rotary inertia [1].

    (k h)^2 / 24 (1 + 2 / (kappa (1 - nu))) with k the wave number of one half wave along each side and kappa = 5/6: the
    first term of the exact solution of a simply supported Mindlin plate, doi:10.1115/1.4010217.
    """
    width, height = plate.part.size
    squared = (np.pi / width) ** 2 + (np.pi / height) ** 2
    shear = 2.0 / (5.0 / 6.0 * (1.0 - plate.part.material.nu))
    return float(squared * plate.part.thickness**2 / 24.0 * (1.0 + shear))


def _twist_defect(plate: PlateMesh) -> Finding:
    a, b = plate.cell_sizes
    excess = twist_excess(b / a, plate.part.material.nu)
    mean = float((excess * a * b).sum() / (a * b).sum())
    worst = int(np.argmax(excess))
    aspect = float(max(a[worst] / b[worst], b[worst] / a[worst]))
    return Finding(
        "twist-defect",
        f"{plate.part.name} uses hermite12, which is {100 * mean:.0f} % too stiff in twist at any mesh (cells up to "
        f"1:{aspect:.2g}, where it is {100 * float(excess[worst]):.0f} %); bfs16 is not",
        {"mean_excess": mean, "largest_excess": float(excess[worst]), "largest_cell_aspect": aspect},
    )
