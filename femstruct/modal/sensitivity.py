"""Derivatives by a parameter: of matrices, natural frequencies and shapes, frequency responses."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import splu

from femstruct.arrays import Floats, Integers
from femstruct.assembly.matrices import Assembly
from femstruct.conventions import N_COMPONENTS
from femstruct.errors import NotConverged
from femstruct.modal.basis import ModalBasis
from femstruct.modal.damping import Damping, FromMaterials, LossFactor, Ratio, Rayleigh, with_damping
from femstruct.modal.eigen import Pencil, factorise
from femstruct.modal.frf import Complex, FrfKind, modal_amplitudes
from femstruct.modal.residuals import project
from femstruct.model.materials import LossByFrequency
from femstruct.model.probe import Probe

# ----------------------------------------------------------------------------------------------------------------------
# Derivatives of the matrices of a structure by one number of its description, from a few assemblies.
# ----------------------------------------------------------------------------------------------------------------------

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

    Parameters
    ----------
    here : Assembly
        The assembly at `at`.
    sides : Sequence[int]
        Steps in the order in which they are taken, CENTRED, FORWARD or BACKWARD.

    Notes
    -----
    Exact, but for rounding, for matrices that are polynomials of up to the fourth degree in the parameter: linear in
    Young's modulus, springs, densities and masses, of the third degree in thickness. Two assemblies are enough where
    the matrices lie on a straight line. Otherwise the error is of the fourth power of the step.

    Examples
    --------
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


# ----------------------------------------------------------------------------------------------------------------------
# Derivatives of natural frequencies, shapes and frequency responses by one parameter, from those of the matrices.
# ----------------------------------------------------------------------------------------------------------------------

ORDERS: Final = 4
"""Residual vectors of a probe where responses are differentiated: the motion is then good to 1e-8 (with two: 1e-6)."""
POWERS: Final = {"receptance": 0, "mobility": 1, "accelerance": 2}  # of j omega
_SOLVES: Final = 500
_SETTLED: Final = 1e-12  # of a shape


@dataclass(frozen=True, eq=False)
class ModalSlopes:
    """Derivatives by one parameter in the modes as they are [k, k]: phi^T dA phi of stiffness [rad^2/s^2], mass [1],
    viscous [rad/s] and hysteretic [rad^2/s^2] damping."""

    stiffness: Floats
    mass: Floats
    viscous: Floats
    hysteretic: Floats


def free_shapes(assembly: Assembly, basis: ModalBasis) -> Floats:
    """Shapes of a basis on the free degrees of freedom of its assembly [n_free, k]."""
    T = assembly.dofs.T
    nodal = basis.shapes.reshape(len(assembly.points) * N_COMPONENTS, -1)
    found: Floats = splu(csc_array(T.T @ T)).solve(T.T @ nodal)
    return found


def modal_slopes(basis: ModalBasis, damping: Damping, shapes: Floats, slopes: MatrixSlopes) -> ModalSlopes | None:
    """Derivatives in the modes of a basis without its damping; None where those of the damping are not known:
    exceptions for single modes, and loss factors by frequency.

    Parameters
    ----------
    shapes : Floats [n_free, k]
        `free_shapes`.
    slopes : MatrixSlopes
        Of the matrices. The law of damping itself is as it is: see `damping_slopes` for its own numbers.

    Notes
    -----
    Equal ratios of all modes are C with C M^-1 C = 4 zeta^2 K, so that in the modes dC_rs = 2 zeta (dK_rs + omega_r
    omega_s dM_rs) / (omega_r + omega_s).
    """
    stiffness, mass = project(slopes.K, shapes), project(slopes.M, shapes)
    viscous, hysteretic = project(slopes.C, shapes), np.zeros_like(stiffness)
    law, omega = damping.base, basis.omega
    if damping.modes:
        return None
    if isinstance(law, Ratio) and law.value:
        both = omega[:, None] + omega
        change = stiffness + np.outer(omega, omega) * mass
        viscous = viscous + 2.0 * law.value * np.divide(change, both, out=np.zeros_like(change), where=both > 0.0)
    elif isinstance(law, LossFactor):
        hysteretic = law.value * stiffness
    elif isinstance(law, Rayleigh):
        viscous = viscous + law.alpha * mass + law.beta * stiffness
    elif isinstance(law, FromMaterials):
        changing = {name: project(part, shapes) for name, part in slopes.parts.items()}
        for name, change in changing.items():
            loss = basis.loss_factors[name]
            if isinstance(loss, LossByFrequency):
                return None
            hysteretic = hysteretic + loss * change
        for name, slope in slopes.loss_factors.items():
            hysteretic = hysteretic + slope * basis.part_stiffness[name]
    return ModalSlopes(stiffness, mass, viscous, hysteretic)


def damping_slopes(basis: ModalBasis, lower: Damping, upper: Damping, apart: float) -> ModalSlopes:
    """Derivatives by a number of the law of damping, which is linear in it.

    Parameters
    ----------
    basis : ModalBasis
        Without damping.
    apart : float
        By how much the number differs between the two laws.
    """
    less, more = with_damping(basis, lower), with_damping(basis, upper)
    none = np.zeros_like(basis.viscous)
    viscous, hysteretic = more.viscous - less.viscous, more.hysteretic - less.hysteretic
    return ModalSlopes(none, none, viscous / apart, hysteretic / apart)


def added(one: ModalSlopes, other: ModalSlopes) -> ModalSlopes:
    """The sum of two."""
    return replace(
        one, viscous=one.viscous + other.viscous, hysteretic=one.hysteretic + other.hysteretic,
        stiffness=one.stiffness + other.stiffness, mass=one.mass + other.mass,
    )  # fmt: skip


def eigenvalue_slopes(omega: Floats, slopes: ModalSlopes, groups: Integers) -> Floats:
    """Derivatives [k] of omega^2 [rad^2/s^2]: phi^T (dK - omega^2 dM) phi; equal ones as a space.

    Source: I. W. Lee, G. H. Jung, Computers & Structures 62 (1997) 429-435, for equal frequencies.

    Parameters
    ----------
    groups : Integers [k]
        Number of the group of equal frequencies that a mode belongs to (`near_equal`). The derivatives of a group are
        the eigenvalues of the matrix that its shapes make, ascending: its modes are those that separate when the
        parameter changes. Their sum is smooth whatever the shapes.

    Examples
    --------
    >>> none, turned = np.zeros((2, 2)), np.array([[0.0, 1.0], [1.0, 0.0]])
    >>> slopes = ModalSlopes(turned, none, none, none)
    >>> eigenvalue_slopes(np.ones(2), slopes, np.array([0, 0])).tolist()
    [-1.0, 1.0]
    """
    square = omega**2
    found = np.diag(slopes.stiffness)[: len(omega)] - square * np.diag(slopes.mass)[: len(omega)]
    for group in np.flatnonzero(np.bincount(groups, minlength=1) > 1):
        members = np.flatnonzero(groups == group)
        inside = np.ix_(members, members)
        roots = np.sqrt(np.outer(square[members], square[members]))
        found[members] = np.linalg.eigvalsh(slopes.stiffness[inside] - roots * slopes.mass[inside])
    return found


def shape_slopes(
    assembly: Assembly, omega: Floats, shapes: Floats, slopes: MatrixSlopes, chosen: Integers, groups: Integers
) -> Floats:
    """Derivatives [n_free, w] of the shapes of some modes, without what stays in the space of their own group.

    Parameters
    ----------
    omega, shapes : Floats [k], Floats [n_free, k]
        All modes up to well above the wanted ones, ascending, without pseudo-modes.
    chosen : Integers [w]
        Which of them.
    groups : Integers [k]
        Of equal frequencies; one mode by itself is a group.

    Raises
    ------
    NotConverged
        Where a mode above those given is too close to a wanted one.

    Notes
    -----
    (K - omega^2 M) dphi = -(dK - omega^2 dM) phi: within the modes given by their amplitudes, and what is beyond them
    by iteration with one factor.
    """
    K, M, square = assembly.K, assembly.M, omega**2
    own = square[chosen]
    loads = -(slopes.K @ shapes[:, chosen] - (slopes.M @ shapes[:, chosen]) * own)
    apart = square[:, None] - own
    other = groups[:, None] != groups[chosen]
    within = np.divide(shapes.T @ loads, apart, out=np.zeros_like(apart), where=other & (apart != 0.0))
    beyond = _beyond(K, M, shapes, loads, own)
    return shapes @ within + beyond


def _beyond(K: csc_array, M: csc_array, shapes: Floats, loads: Floats, own: Floats) -> Floats:
    """(K - own M)^-1 loads of what is M-orthogonal to the shapes, each column for its own eigenvalue."""
    weighted = M @ shapes
    top = max(float(own.max(initial=0.0)), 1.0)
    factor = factorise(Pencil.of(K, M), -0.1 * top)

    def without(vectors: Floats) -> Floats:
        return vectors - shapes @ (weighted.T @ vectors)

    right = loads - weighted @ (shapes.T @ loads)
    answer = without(factor.solve(right))
    for _ in range(_SOLVES):
        better = without(factor.solve(right + (own - factor.sigma) * (M @ answer)))
        change, answer = np.linalg.norm(better - answer), better
        if change <= _SETTLED * np.linalg.norm(answer):
            return answer
    raise NotConverged("derivative of a shape", got=f"{_SOLVES} solves", do="ask for more modes above those measured")


def motions(damped: ModalBasis, drive: Probe, response: Probe, frequency_hz: Floats) -> tuple[Complex, Complex]:
    """Modal coordinates u, v [nf, k] under harmonic unit forces at the drive and at the response [sqrt(kg) m/N].

    Parameters
    ----------
    damped : ModalBasis
        The basis with its damping, with ORDERS residual vectors for both probes.
    """
    u, v = (modal_amplitudes(damped, probe, frequency_hz).T for probe in (drive, response))
    return u, v


def frf_slopes(moving: tuple[Complex, Complex], slopes: ModalSlopes, frequency_hz: Floats, kind: FrfKind) -> Complex:
    """Derivative [nf] of a frequency response of motion by one parameter: -v . dZ u.

    Parameters
    ----------
    moving : tuple[Complex, Complex]
        `motions` of its drive and response.
    kind : FrfKind
        Receptance, mobility or accelerance.

    Notes
    -----
    The response is the best one in the space of the basis, so that its own change needs no derivative of the space; u
    and v must be right, not only their product, which is what the residual vectors of higher order are for.
    """
    omega = 2.0 * np.pi * frequency_hz
    u, v = moving
    answer = -(v * (u @ (slopes.stiffness + 1j * slopes.hysteretic))).sum(axis=1)
    answer = answer - 1j * omega * (v * (u @ slopes.viscous)).sum(axis=1)
    answer = answer + omega**2 * (v * (u @ slopes.mass)).sum(axis=1)
    return np.asarray(answer * (1j * omega) ** POWERS[kind], dtype=np.complex128)
