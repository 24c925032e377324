"""Walls at the edges of plates in an assembly: at another frequency, left out, on modes, and what they bend it to."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array

from femstruct.arrays import Floats
from femstruct.assembly.matrices import Assembly
from femstruct.errors import Finding
from femstruct.modal.by_frequency.own_modes import DEPENDENT, OwnModes
from femstruct.modal.factor import factorise
from femstruct.modal.outputs import projected
from femstruct.modal.residuals import complement_solve
from femstruct.modal.solve import Modes
from femstruct.model.materials.loss_by_frequency import loss_at

Complex = NDArray[np.complex128]
TRACES: Final = 1e-4  # of the largest: moments along edges that are nearly those of other modes
ALIKE: Final = 3.0  # ratio of loss factors up to which modes do not couple by them
STRONG: Final = 0.1  # loss factor from which on a sum of real modes is off by half a decibel
OFF_DB: Final = 4.0  # dB for a loss factor of one: measured 1.5 at 0.36 and 0.6 at 0.23


def referred(assembly: Assembly, frequency_hz: float) -> Assembly:
    """The assembly with the walls at its edges as they are at another frequency [Hz]."""
    scales = {name: (frequency_hz / at) ** 0.5 for name, at in assembly.growing.items()}
    parts = {name: csc_array(scales.get(name, 1.0) * part) for name, part in assembly.part_stiffness.items()}
    return replace(
        assembly,
        K=_sum(list(parts.values())),
        part_stiffness=parts,
        growing=dict.fromkeys(assembly.growing, frequency_hz),
    )


def without_walls(assembly: Assembly) -> Assembly:
    """The assembly without the walls at its edges: as it is at rest."""
    if not assembly.growing:
        return assembly
    parts = {name: part for name, part in assembly.part_stiffness.items() if name not in assembly.growing}
    losses = {name: loss for name, loss in assembly.loss_factors.items() if name not in assembly.growing}
    K = _sum([*parts.values(), csc_array(assembly.K.shape)])
    return replace(assembly, K=K, part_stiffness=parts, loss_factors=losses, growing={})


def _sum(matrices: Sequence[csc_array]) -> csc_array:
    total = matrices[0]
    for matrix in matrices[1:]:
        total = csc_array(total + matrix)
    return total


def complex_walls(assembly: Assembly, shapes: Floats) -> dict[str, Complex]:
    """Complex stiffness [k, k] of every wall on shapes [n_free, k]."""
    found: dict[str, Complex] = {}
    for name in assembly.growing:
        loss = assembly.loss_factors[name]
        assert isinstance(loss, float)
        found[name] = np.asarray((1.0 + 1j * loss) * projected(assembly.part_stiffness[name], shapes))
    return found


def losses_alike(assembly: Assembly) -> bool:
    """Whether the loss factors of all parts but walls are within a factor of three: then what couples modes through
    them changes nothing that shows, and is left out, which makes simulations sixty times as fast."""
    hz = np.array([50.0, 500.0])
    parts = [name for name in assembly.part_stiffness if name not in assembly.growing]
    losses = np.array([loss_at(assembly.loss_factors.get(name, 0.0), hz) for name in parts]).reshape(-1, len(hz))
    return bool((losses.max(axis=0, initial=0.0) <= ALIKE * losses.min(axis=0, initial=np.inf)).all())


def edge_vectors(assembly: Assembly, found: Modes, shapes: Floats) -> Floats:
    """What walls bend a structure to beside its modes [n_free, e]: static deflections under the moments that they give
    to the modes, orthonormal to the mass and to shapes [n_free, k]: modes and residual vectors.

    Without them the modes of one stiffness of the walls cannot be those of another: their sum converges slowly there.
    """
    loads = np.concatenate([assembly.part_stiffness[name] @ found.shapes for name in assembly.growing], axis=1)
    size = np.linalg.norm(loads, axis=0)
    span, sizes, _ = np.linalg.svd(loads[:, size > 0.0] / size[size > 0.0], full_matrices=False)
    moments = span[:, sizes > TRACES * sizes.max(initial=0.0)]
    if not moments.shape[1]:
        return moments
    bent = complement_solve(assembly.M, found.shapes, factorise(found.pencil, found.sigma), moments)
    for _ in range(3):
        bent = bent - shapes @ (shapes.T @ (assembly.M @ bent))
        left, sizes, _ = np.linalg.svd(bent.T @ (assembly.M @ bent))
        bent = bent @ (left / np.sqrt(sizes.clip(1e-300)))[:, sizes > DEPENDENT**2 * sizes.max()]
    return bent


def wall_findings(own: OwnModes, names: Iterable[str]) -> tuple[Finding, ...]:
    """A finding where walls take so much that a sum of real modes is inexact."""
    if not own.loss.size or own.loss.max() < STRONG:
        return ()
    worst = int(np.argmax(own.loss))
    hz, loss = float(own.omega[worst] / (2.0 * np.pi)), float(own.loss[worst])
    return (
        Finding(
            "walls-damp-much",
            f"{', '.join(names)}: the mode at {hz:.4g} Hz has a loss factor of {100 * loss:.3g} % by the walls alone "
            f"({100 * own.first_order[worst]:.3g} % by strain energy). Its frequency and decay are exact; a response "
            f"as the sum of real modes is lower than the exact one by up to {OFF_DB * loss:.1f} dB near it, and by "
            "more below the first mode, where the walls are softer than at any mode",
            {"loss_factor": loss, "first_order": float(own.first_order[worst]), "frequency_hz": hz},
        ),
    )
