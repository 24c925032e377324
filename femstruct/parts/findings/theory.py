"""Plates beside their theory: too thick for Kirchhoff's, too stiff in twist by their element, with layers that couple
stretching and bending."""

from __future__ import annotations

import numpy as np

from femstruct.elements.plate import twist_excess
from femstruct.errors import Finding
from femstruct.model.model import Model
from femstruct.parts.of_plates.plate_mesh import PlateMesh, plates_of

NOTABLE_SHEAR, GROSS_SHEAR = 0.005, 0.5
"""Estimated error of a plate's first frequency from here on is worth a finding; from there on it is no plate."""


def model_findings(model: Model) -> tuple[Finding, ...]:
    """Reasons to trust the model less: the twist defect of hermite12, plates too thick for Kirchhoff's theory, layers
    that are not symmetric."""
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
        if plate.part.section.coupled:
            found.append(_unsymmetric(plate))
    return tuple(found)


def shear_excess(plate: PlateMesh) -> float:
    """Estimated relative excess of the first frequency of a plate for leaving out shear and rotary inertia [1].

    Half the shear energy V . As^-1 V / 2 over that of bending, V the shear forces of one half wave along each side, and
    half the rotary inertia m2 k^2 over the mass. For one isotropic material that is (k h)^2 / 24 (1 + 2 / (kappa (1 -
    nu))) with kappa = 5/6, the first term of the exact solution of a simply supported Mindlin plate,
    doi:10.1115/1.4010217.
    """
    section = plate.part.section
    D, (x, y) = section.bending, np.pi / np.asarray(plate.part.size)
    both = D[0, 1] + 2.0 * D[2, 2]
    forces = np.array([D[0, 0] * x**3 + both * x * y**2, D[1, 1] * y**3 + both * x**2 * y])
    energy = D[0, 0] * x**4 + 2.0 * both * x**2 * y**2 + D[1, 1] * y**4
    sheared = forces @ np.linalg.solve(section.As, forces) / energy
    turned = section.m2 * (x**2 + y**2) / section.m0 if section.m0 > 0.0 else 0.0
    return float((sheared + turned) / 2.0)


def _unsymmetric(plate: PlateMesh) -> Finding:
    """Layers whose neutral surface is not the mid-surface, in the direction where the difference is largest."""
    section = plate.part.section
    middle, free = section.D.diagonal()[:2], section.bending.diagonal()[:2]
    worst = int(np.argmin(free / middle))
    off = float(section.B[worst, worst] / section.A[worst, worst])
    return Finding(
        "unsymmetric-layers",
        f"{plate.part.name}: its layers are not symmetric. The neutral surface along {'xy'[worst]} is "
        f"{1e3 * abs(off):.3g} mm off the mid-surface. It bends about it with {free[worst]:.4g} N m, as a plate that "
        f"nothing holds in its plane; with its mid-surface held it would have {middle[worst]:.4g} N m. Forces in its "
        "plane do not bend it here",
        {"off_m": off, "free_n_m": float(free[worst]), "held_n_m": float(middle[worst])},
    )


def _twist_defect(plate: PlateMesh) -> Finding:
    a, b = plate.cell_sizes
    D = plate.part.section.D
    excess = twist_excess(b / a, D[0, 1] / D[0, 0])
    mean = float((excess * a * b).sum() / (a * b).sum())
    worst = int(np.argmax(excess))
    aspect = float(max(a[worst] / b[worst], b[worst] / a[worst]))
    return Finding(
        "twist-defect",
        f"{plate.part.name} uses hermite12, which is {100 * mean:.0f} % too stiff in twist with any mesh (up to "
        f"{100 * float(excess[worst]):.0f} % in cells of 1:{aspect:.2g}). Use bfs16",
        {"mean_excess": mean, "largest_excess": float(excess[worst]), "largest_cell_aspect": aspect},
    )
