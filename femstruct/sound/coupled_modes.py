"""What bases of structure and air share: all of the structure in the new modes, and whether damping couples them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.modal.basis import ForceRow, Kind, ModalBasis

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


def completing(basis: ModalBasis, own: Floats, n_rigid: int) -> Bools:
    """Which of new coordinates [n] complete a response and are no modes: as many as the basis has behind its modes,
    those that lie most along these. own [k, n] : the coordinates of the basis in each."""
    found = np.zeros(own.shape[1], dtype=bool)
    share = (own[basis.modes.stop :] ** 2).sum(axis=0)
    found[np.argsort(-share, kind="stable")[: len(basis.omega) - basis.modes.stop]] = True
    found[:n_rigid] = False
    return found


def in_new_modes(
    basis: ModalBasis,
    omega: Floats,
    kind: tuple[Kind, ...],
    own: Floats,
    losses: tuple[Floats, Floats],
    *,
    coupled: bool,
    **of_air: Any,
) -> ModalBasis:
    """The basis in the modes of structure and air, all that is the structure's in terms of them.

    omega [n] [rad/s]; own [k, n] : the coordinates of the basis in each. losses [n, n] : viscous and hysteretic.
    coupled : whether damping between modes is kept. of_air : fields that the air decides.
    """
    dashpots: Floats = own.T @ basis.dashpots @ own
    damping = [*losses, dashpots] if coupled else [np.diag(np.diag(one)) for one in (*losses, dashpots)]
    viscous, hysteretic, dashpots = (0.5 * (one + one.T) for one in damping)
    return replace(
        basis,
        omega=omega,
        kind=kind,
        shapes=basis.shapes @ own,
        viscous=viscous,
        hysteretic=hysteretic,
        dashpots=dashpots,
        outputs={key: turned_row(row, basis.omega, omega, own) for key, row in basis.outputs.items()},
        part_stiffness={key: own.T @ part @ own for key, part in basis.part_stiffness.items()},
        momentum=basis.momentum @ own,
        **of_air,
    )


def left_over(before: Floats, mass: Floats, compression: Floats, after: Floats, x: Floats) -> Floats:
    """|K x - omega^2 M x| over the terms it is summed from, for every coordinate [n].

    before [k], after [n] [rad/s] : of the structure, of both. mass [m, m], compression [r, m] : of the air over
    all coordinates, those of the structure first. x [m, n] : the new coordinates.
    """
    k, whole = len(before), len(x)
    structure = np.concatenate([before, np.zeros(whole - k)])[:, None] ** 2 * x
    pressed = compression.T @ (compression @ x)
    inertia = (mass @ x + np.concatenate([x[:k], np.zeros((whole - k, x.shape[1]))])) * after**2
    sizes = [np.linalg.norm(part, axis=0) for part in (structure, pressed, inertia)]
    left: Floats = np.linalg.norm(structure + pressed - inertia, axis=0)
    terms: Floats = np.sum(sizes, axis=0)
    share: Floats = np.divide(left, terms, out=np.zeros_like(left), where=terms > 0)
    return share


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
