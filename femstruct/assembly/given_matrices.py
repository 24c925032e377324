"""Matrices of another program -> Assembly."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csc_array, csr_array

from femstruct.arrays import frozen, frozen_integers
from femstruct.assembly.matrices import Assembly, DofMap
from femstruct.conventions import COMPONENTS, N_COMPONENTS
from femstruct.declared import expect
from femstruct.errors import FemstructError, InputError

ASYMMETRIC = 1e-9  # of the largest entry: matrices that were written to a file with ten digits differ by less
ROUNDED = 1e-6  # of an entry beside the diagonal: single precision leaves 1e-7
NO_MASS, NO_DASHPOTS = "a kinetic energy below 0", "dashpots that give energy"


def given_matrices(
    M: Any,
    K: Any,
    nodes: ArrayLike,
    components: ArrayLike,
    points: ArrayLike,
    C: Any = None,
    loss_factor: float = 0.0,
) -> Assembly:
    """The assembly of matrices that were made elsewhere.

    Two masses of 1 and 2 kg on springs in a row, k = 1 kN/m each, along x: omega^2 = k (5 -+ sqrt(17)) / (4 kg).

    Parameters
    ----------
    M, K : Any [n, n]
        Mass and stiffness, dense or sparse [kg, N/m]; supports are already taken out of them, and of C.
    nodes, components : ArrayLike [n]
        Which node and which of its components (`femstruct.conventions`: UX .. RZ) each degree of freedom is.
    points : ArrayLike [n_nodes, 3]
        Where the nodes are [m].
    C : Any [n, n]
        Dashpots that damp beside the structure itself [N s/m].
    loss_factor : float
        Of all of it, for `FromMaterials`; the stiffness has the name "given".

    Returns
    -------
    Assembly
        An Assembly without forces by name: what holds the structure is not in the matrices.

    Raises
    ------
    FemstructError
        For a matrix of another size, with other than real numbers or that is not symmetric, for M and C that two
        degrees of freedom can move with negative energy or loss, for a node or component that is not there, and for two
        degrees of freedom that are one.

    Examples
    --------
    >>> from femstruct import modal_basis
    >>> from femstruct.conventions import UX
    >>> k = 1e3
    >>> assembly = given_matrices(np.diag([1.0, 2.0]), [[2 * k, -k], [-k, k]], [0, 1], [UX, UX], np.eye(2, 3))
    >>> (modal_basis(assembly, up_to=10.0).omega ** 2).round(6).tolist()
    [219.223594, 2280.776406]

    Where a force acts or a motion is read is a `Probe` of nodes and components. A ball of 0.5 kg strikes the second
    mass, through so stiff a contact that the springs play no part: 2 m v / (m + M) is 0.4 m/s.

    >>> from femstruct import Body, Clock, Contact, Linear, Probe, Scene, simulate
    >>> basis, second = modal_basis(assembly, up_to=10.0), Probe([1], [UX], [1.0])
    >>> hit = Contact("hit", upper="ball", lower=second, law=Linear(1e9))
    >>> response = simulate(basis, Scene((Body("ball", 0.5, -1.0),), (hit,)), Clock(1e-3, 10e3))
    >>> round(float(response.velocity(second.of(basis.shapes))[2]), 3)
    -0.4
    """
    where = "given matrices"
    points = frozen(f"{where} points", points, (None, 3))
    nodes = frozen_integers(f"{where} nodes", nodes, (None,))
    components = frozen_integers(f"{where} components", components, (len(nodes),))
    n = len(nodes)
    for name, numbers, most in (("nodes", nodes, len(points)), ("components", components, N_COMPONENTS)):
        if n and not (numbers.min() >= 0 and numbers.max() < most):
            raise FemstructError(
                f"{where} {name}", got=f"{numbers.min()} to {numbers.max()}", expected=f"0 to {most - 1}"
            )
    columns = nodes * N_COMPONENTS + components
    if len(np.unique(columns)) < n:
        twice = np.flatnonzero(np.bincount(columns) > 1)[0]
        got = f"two degrees of freedom at node {twice // N_COMPONENTS} {COMPONENTS[twice % N_COMPONENTS]}"
        raise FemstructError(where, got=got, expected="one each")
    labels = tuple(f"node {node} {COMPONENTS[component]}" for node, component in zip(nodes, components, strict=True))
    T = csr_array((np.ones(n), (columns, np.arange(n))), shape=(len(points) * N_COMPONENTS, n))
    translations = (components[:, None] == np.arange(3)).astype(np.float64)
    momentum = np.asarray((_symmetric(f"{where} M", M, n) @ translations).T)
    total_mass = float((momentum * translations.T).sum(axis=1).max())
    return mapped_matrices(
        M,
        K,
        dofs=DofMap(T, labels),
        points=points,
        momentum=momentum,
        total_mass=total_mass,
        C=C,
        loss_factor=loss_factor,
    )


def mapped_matrices(
    M: Any,
    K: Any,
    dofs: DofMap,
    points: ArrayLike,
    momentum: ArrayLike,
    total_mass: float,
    C: Any = None,
    loss_factor: float = 0.0,
) -> Assembly:
    """The assembly of matrices whose degrees of freedom move the nodes by a map, as after ties and reductions.

    As `given_matrices`, but dofs : how the nodes follow.

    A rigid bar of 3 kg that shifts along z: one degree of freedom for both of its ends.

    Parameters
    ----------
    momentum : ArrayLike [3, n]
        Of the structure when each degree of freedom moves at unit rate, along x, y, z [kg]. total_mass [kg].

    Raises
    ------
    FemstructError
        For a matrix of another size or that is not symmetric, for M and C that two degrees of freedom can move with
        negative energy or loss, and for a map to other nodes.

    Examples
    --------
    >>> ends = DofMap(csr_array(([1.0, 1.0], ([2, 9], [0, 0])), shape=(14, 1)), ("bar UZ",))
    >>> bar = mapped_matrices([[3.0]], [[12.0]], ends, np.eye(2, 3), [[0.0], [0.0], [3.0]], 3.0)
    >>> from femstruct import modal_basis
    >>> basis = modal_basis(bar, count=1)
    >>> basis.omega.round(9).tolist(), basis.shapes[:, 2, 0].round(6).tolist()
    ([2.0], [0.57735, 0.57735])
    """
    where = "given matrices"
    points = frozen(f"{where} points", points, (None, 3))
    expect(f"{where} loss_factor", loss_factor, float)
    if loss_factor < 0.0:
        raise InputError(f"{where} loss_factor", got=f"{loss_factor:g}", expected="a value >= 0")
    rows, n = dofs.T.shape
    if rows != len(points) * N_COMPONENTS:
        expected = f"{len(points)} nodes x {N_COMPONENTS}"
        raise FemstructError(f"{where} map", got=f"{rows} rows", expected=expected)
    stiffness = _symmetric(f"{where} K", K, n)
    return Assembly(
        M=_without_gain(f"{where} M", _symmetric(f"{where} M", M, n), NO_MASS),
        K=stiffness,
        C=csc_array((n, n)) if C is None else _without_gain(f"{where} C", _symmetric(f"{where} C", C, n), NO_DASHPOTS),
        dofs=dofs,
        points=points,
        part_stiffness={"given": stiffness},
        loss_factors={"given": loss_factor},
        forces={},
        momentum=frozen(f"{where} momentum", momentum, (3, n)),
        total_mass=total_mass,
    )


def _symmetric(where: str, matrix: Any, n: int) -> csc_array:
    """A matrix as it is kept, exactly symmetric."""
    try:
        given = csc_array(matrix)
        if given.dtype.kind not in "biuf":
            raise ValueError(f"entries of type {given.dtype}")
        sparse = csc_array(given, dtype=np.float64)
    except (ValueError, TypeError) as error:
        raise InputError(where, got=str(error), expected="a matrix of real numbers, dense or sparse") from None
    if sparse.shape != (n, n):
        raise FemstructError(where, got=f"{sparse.shape}", expected=f"{(n, n)}, a row for each degree of freedom")
    if not np.isfinite(sparse.data).all():
        raise FemstructError(where, got="a value that is not finite", expected="finite values")
    off = abs(sparse - sparse.T)
    if off.max() > ASYMMETRIC * abs(sparse).max():
        row, column = np.unravel_index(int(off.argmax()), off.shape)
        got = f"{sparse[row, column]:g} at ({row}, {column}) and {sparse[column, row]:g} at ({column}, {row})"
        raise FemstructError(where, got=got, expected="a symmetric matrix")
    return csc_array((sparse + sparse.T) * 0.5)


def _without_gain(where: str, matrix: csc_array, gain: str) -> csc_array:
    """A symmetric matrix with which no motion of one or two degrees of freedom has a negative energy or loss."""
    diagonal, entries = matrix.diagonal(), matrix.tocoo()
    if (diagonal < 0.0).any():
        at = int(diagonal.argmin())
        got = f"{gain}: {diagonal[at]:g} at ({at}, {at})"
        raise InputError(where, got=got, expected="no negative value on the diagonal", do="look for a sign")
    row, column = entries.coords
    most = np.sqrt(diagonal[row]) * np.sqrt(diagonal[column])
    over = np.abs(entries.data) - (1.0 + ROUNDED) * most - ASYMMETRIC * diagonal.max(initial=0.0)
    if (over > 0.0).any():
        at = int(over.argmax())
        got = f"{gain}: {entries.data[at]:g} at ({row[at]}, {column[at]}), with {diagonal[row[at]]:g} and "
        got += f"{diagonal[column[at]]:g} on the diagonal"
        raise InputError(where, got=got, expected=f"at most their geometric mean, {most[at]:g}")
    return matrix
