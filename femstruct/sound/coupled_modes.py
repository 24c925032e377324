"""What bases of structure and air share: their forces in the new modes, and whether damping couples them."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.modal.basis import ForceRow

Bools = NDArray[np.bool_]
NEGLIGIBLE_DAMPING_COUPLING: Final = (
    1e-3  # of the structure's motion: damping between modes that makes less is left out
)
_LOADS: Final = 8
_LIGHT: Final = 1e-6


def stray_share(damping: Floats, omega: Floats, structure: Floats, true: Bools) -> float:
    """Share of the structure's motion that damping between modes makes: rms over the resonances, under broad loads.

    damping [k, k] [rad/s]; omega [k]; structure [m, k] : motion of the structure in every mode; true [k] : has a
    resonance that means something.

    To first order: off the diagonal it drives a mode with what the others do.
    """
    between = damping - np.diag(np.diag(damping))
    if not between.any():
        return 0.0
    loads = structure.T @ np.random.default_rng(1).standard_normal((len(structure), _LOADS))
    at = omega[true & (omega > 0.0)][:, None]
    own = np.maximum(np.diag(damping), _LIGHT * omega)  # a mode without damping: its peak stays finite
    answer = 1.0 / (omega**2 - at**2 + 1j * at * own)
    motion = answer[:, :, None] * loads
    change = answer[:, :, None] * (at[:, :, None] * (between @ motion))
    sizes = [float(np.linalg.norm(np.tensordot(structure, part, axes=(1, 1)))) for part in (change, motion)]
    return sizes[0] / sizes[1] if sizes[1] > 0.0 else 0.0


def padded(matrix: Floats, size: int) -> Floats:
    padded = np.zeros((size, size))
    padded[: len(matrix), : len(matrix)] = matrix
    return padded


def turned_row(row: ForceRow, before: Floats, after: Floats, own: Floats) -> ForceRow:
    """A force in the new modes; its structural damping acts in time as at their frequencies."""
    hysteretic = row.hysteretic @ own
    at_own = np.divide(row.hysteretic, before, out=np.zeros_like(before), where=before > 0)
    at_new = np.divide(hysteretic, after, out=np.zeros_like(after), where=after > 0)
    damping = (row.damping - at_own) @ own + at_new
    return ForceRow(row.stiffness @ own, damping, row.inertia @ own, hysteretic, row.direct, row.carried)
