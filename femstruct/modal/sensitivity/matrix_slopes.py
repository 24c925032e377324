"""Derivatives of the matrices of a structure by one number of its description, from a few assemblies."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.sparse import csc_array, csr_array

from femstruct.arrays import Floats
from femstruct.assembly.matrices import Assembly
from femstruct.model.materials.loss_by_frequency import LossByFrequency

CENTRED, FORWARD, BACKWARD = (-1, 1, -2, 2), (1, 2, 3, 4), (-1, -2, -3, -4)
STRAIGHT: Final = 1e-7  # bend over change: the derivative from two assemblies is then as good as from four


@dataclass(frozen=True, eq=False)
class MatrixSlopes:
    """Derivatives of stiffness, mass, dashpots [n_free, n_free], of the stiffness of parts that change, and of loss
    factors, by one parameter."""

    K: csc_array
    M: csc_array
    C: csc_array
    parts: Mapping[str, csc_array]
    loss_factors: Mapping[str, float]


def matrix_slopes(
    assembled: Callable[[float], Assembly], here: Assembly, at: float, step: float, sides: Sequence[int] = CENTRED
) -> MatrixSlopes | None:
    """Derivatives at `at` by the assemblies at up to four steps from it; None where these have other degrees of
    freedom, places, or loss factors given by frequency that change.

    here : the assembly at `at`. sides : steps in the order in which they are taken, CENTRED, FORWARD or BACKWARD.

    Notes
    -----
    Exact, but for rounding, for matrices that are polynomials of up to the fourth degree in the parameter: linear in
    Young's modulus, springs, densities and masses, of the third degree in thickness. Two assemblies are enough where
    the matrices lie on a straight line. Otherwise the error is of the fourth power of the step.

    >>> from femstruct import Block, Spring, PlaceOn, Structure, assemble, mesh_structure
    >>> def one(k):
    ...     block = Block("block", 500.0, origin=(0.0, 0.0, 0.0), size=(1.0, 0.5, 0.2))
    ...     foot = PlaceOn("foot", "block", at=((0.5, 0.25, 0.0),))
    ...     spring = Spring("spring", "foot", None, stiffness=(0.0, 0.0, k, 0.0, 0.0, 0.0))
    ...     return assemble(mesh_structure(Structure("on a spring", (block, spring), points=(foot,))))
    >>> slopes = matrix_slopes(one, one(1e6), 1e6, 1e4)
    >>> float(slopes.K[2, 2].round(9)), slopes.M.nnz
    (1.0, 0)
    """
    found = {0: here}
    for number, side in enumerate(sides):
        found[side] = assembled(at + side * step)
        if not _alike(found[side], here):
            return None
        if number == 1 and _straight(found):
            break
    weights = _weights([*found]) / step
    ones = [*found.values()]
    names = [name for name in here.part_stiffness if _differ([one.part_stiffness[name] for one in ones])]
    losses = {name: one for name in here.loss_factors if (one := _loss_slope(name, ones, weights)) != 0.0}
    if None in losses.values():
        return None
    return MatrixSlopes(
        K=_combined([one.K for one in ones], weights),
        M=_combined([one.M for one in ones], weights),
        C=_combined([one.C for one in ones], weights),
        parts={name: _combined([one.part_stiffness[name] for one in ones], weights) for name in names},
        loss_factors={name: one for name, one in losses.items() if one is not None},
    )


def _alike(one: Assembly, other: Assembly) -> bool:
    """Whether degrees of freedom and places are the same, so that matrices can be compared entry by entry."""
    return (
        one.K.shape == other.K.shape
        and np.array_equal(one.points, other.points)
        and one.part_stiffness.keys() == other.part_stiffness.keys()
        and not csr_array(one.dofs.T - other.dofs.T).count_nonzero()
    )


def _straight(found: Mapping[int, Assembly]) -> bool:
    """Whether the matrices at three steps lie on a straight line."""
    (_, middle), (a, first), (b, second) = found.items()
    for name in ("K", "M", "C"):
        here, one, other = (getattr(each, name) for each in (middle, first, second))
        change = abs(one - here) / abs(a) + abs(other - here) / abs(b)
        bend = abs((one - here) / a - (other - here) / b)
        if bend.nnz and bend.max() > STRAIGHT * change.max():
            return False
    return True


def _weights(steps: list[int]) -> Floats:
    """What the values at these steps count in the derivative at 0, for a step of one."""
    powers = np.vander(np.array(steps, dtype=np.float64), increasing=True).T
    right = np.zeros(len(steps))
    right[1] = 1.0
    return np.asarray(np.linalg.solve(powers, right))


def _combined(matrices: Sequence[csc_array], weights: Floats) -> csc_array:
    """The weighted sum; the first is subtracted from all, so that what does not change leaves nothing."""
    total = csc_array(matrices[0].shape)
    for matrix, weight in zip(matrices[1:], weights[1:].tolist(), strict=True):
        total = csc_array(total + weight * (matrix - matrices[0]))
    total.eliminate_zeros()
    return total


def _differ(matrices: Sequence[csc_array]) -> bool:
    return any(csc_array(matrix - matrices[0]).count_nonzero() for matrix in matrices[1:])


def _loss_slope(name: str, ones: Sequence[Assembly], weights: Floats) -> float | None:
    """Derivative of a loss factor; None where it is given by frequency and changes."""
    losses = [one.loss_factors[name] for one in ones]
    if any(isinstance(loss, LossByFrequency) for loss in losses):
        return 0.0 if all(loss == losses[0] for loss in losses) else None
    values = np.array(losses, dtype=np.float64)
    return float((values - values[0]) @ weights)
