"""Plates beside their theory: too thick for Kirchhoff's, too stiff in twist by their element."""

from __future__ import annotations

import numpy as np

from femstruct.elements.plate import twist_excess
from femstruct.errors import Finding
from femstruct.model.model import Model
from femstruct.parts.plate import PlateMesh, plates_of

NOTABLE_SHEAR, GROSS_SHEAR = 0.005, 0.5
"""Estimated error of a plate's first frequency from here on is worth a finding; from there on it is no plate."""


def model_findings(model: Model) -> tuple[Finding, ...]:
    """Reasons to trust the model less: the twist defect of hermite12, plates too thick for Kirchhoff's theory."""
    plates = plates_of(model)
    found = [_twist_defect(plate) for plate in plates if plate.part.element == "hermite12"]
    for plate in plates:
        excess = shear_excess(plate)
        if excess > NOTABLE_SHEAR:
            ratio = plate.part.thickness / min(plate.part.size)
            found.append(
                Finding(
                    "thick-plate",
                    f"The thickness of {plate.name} is {ratio:.2g} of its shorter side. The theory of thin plates "
                    f"leaves out shear and rotary inertia: simply supported, its first natural frequency is about "
                    f"{100 * excess:.1f} % too high, higher ones more",
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
        f"{plate.part.name} uses hermite12, which is {100 * mean:.0f} % too stiff in twist with any mesh (up to "
        f"{100 * float(excess[worst]):.0f} % in cells of 1:{aspect:.2g}). Use bfs16",
        {"mean_excess": mean, "largest_excess": float(excess[worst]), "largest_cell_aspect": aspect},
    )
