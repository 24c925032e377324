"""Solid elements in three dimensions, isoparametric: tetrahedra and hexahedra, linear and quadratic.

======  ============================================  ==================================================
kind    shape functions                               converges to
======  ============================================  ==================================================
tet4    linear                                        the solid, frequencies O(h^2), far too stiff in bending
tet10   quadratic                                     the solid, O(h^4)
hex8    trilinear with three incompatible bubbles     the solid, O(h^2), bends without locking
hex20   quadratic without the inner products          the solid, O(h^4)
hex27   triquadratic                                  the solid, O(h^4)
======  ============================================  ==================================================

The DOFs are ux uy uz of each node in global axes. Nodes, shape functions and quadrature are those of
`femstruct.elements.solid_shapes`; elasticities stand in `femstruct.elements.elasticity`.

The stiffness of hex8 has the nine incompatible modes of Wilson with Taylor's correction, which makes it pass the patch
test in any shape: a plain trilinear cell bends as if it were many times stiffer. They are condensed; mass and motion
are trilinear.

References: E. L. Wilson, R. L. Taylor, W. P. Doherty, J. Ghaboussi, in Numerical and Computer Methods in Structural
Mechanics (Academic Press 1973) 43-57. R. L. Taylor, P. J. Beresford, E. L. Wilson, International Journal for Numerical
Methods in Engineering 10 (1976) 1211-1219, doi:10.1002/nme.1620100602.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.elements.members import densities
from femstruct.elements.solid_shapes import at_quadrature, node_count, quadrature, shapes
from femstruct.errors import InputError

AT_ONCE: Final = 256
"""Cells that are integrated at once: strain rows of hex27 at all points take 105 kB a cell."""


def least_sizes(kind: str, nodes: ArrayLike) -> Floats:
    """Least volume per reference volume of each cell [n] [m^3] at the points of its quadrature: zero or below where it
    is folded or turned inside out.

    >>> from femstruct.elements.solid_shapes import reference_nodes
    >>> least_sizes("hex8", reference_nodes("hex8")[None][:, [4, 5, 6, 7, 0, 1, 2, 3]]) > 0.0
    array([False])
    """
    places = _places(kind, nodes)
    result: Floats = np.linalg.det(_jacobians(places, at_quadrature(kind)[1])).min(axis=1)
    return result


def stiffness(kind: str, nodes: ArrayLike, C: ArrayLike) -> Floats:
    """Stiffness matrices of solid cells.

    kind : one of KINDS; nodes [n, k, 3] [m]; C [6, 6] or [n, 6, 6] : elasticity [Pa], symmetric, global axes.

    Returns [n, 3 k, 3 k], exactly symmetric. Raises InputError for cells of another shape than the kind's, for cells
    turned inside out, and for a C that is not symmetric.

    Notes
    -----
    Integrated exactly for cells with straight edges and parallel faces. tet4 is many times too stiff in bending.

    >>> from femstruct.elements.elasticity import isotropic
    >>> from femstruct.elements.solid_shapes import reference_nodes
    >>> unit = reference_nodes("hex8")[None]
    >>> K = stiffness("hex8", unit, isotropic(1.0, 0.3))
    >>> stretched = np.zeros((8, 3)); stretched[:, 0] = unit[0, :, 0]
    >>> round(float(stretched.ravel() @ K[0] @ stretched.ravel()), 9)  # E (1 - nu) / (1 + nu) / (1 - 2 nu)
    1.346153846
    """
    places = _places(kind, nodes)
    moduli = _moduli(C, len(places))
    matrices = np.empty((len(places), 3 * places.shape[1], 3 * places.shape[1]))
    for first in range(0, len(places), AT_ONCE):
        some = slice(first, first + AT_ONCE)
        matrices[some] = _stiffness(kind, places[some], moduli[some])
    return matrices


def mass(kind: str, nodes: ArrayLike, rho: ArrayLike) -> Floats:
    """Consistent mass matrices of solid cells.

    kind : one of KINDS; nodes [n, k, 3] [m]; rho [n] or one value [kg/m^3], zero allowed.

    Returns [n, 3 k, 3 k], exactly symmetric.

    >>> from femstruct.elements.solid_shapes import reference_nodes
    >>> M = mass("tet10", 2.0 * reference_nodes("tet10")[None], 3.0)
    >>> round(float(M[0, ::3, ::3].sum()), 9)  # 3 times a sixth of 8
    4.0
    """
    places = _places(kind, nodes)
    density = densities(rho, places[:, 0, 0])
    values, slopes, weights = at_quadrature(kind)
    _, sizes = _global_slopes(places, slopes)
    k = places.shape[1]
    products = (values[:, :, None] * values[:, None, :]).reshape(len(weights), k * k)  # exactly symmetric
    scalar = ((density[:, None] * sizes * weights) @ products).reshape(-1, k, k)
    matrices = np.zeros((len(places), k, 3, k, 3))
    for axis in range(3):
        matrices[:, :, axis, :, axis] = scalar
    return matrices.reshape(len(places), 3 * k, 3 * k)


def stresses(kind: str, nodes: ArrayLike, at: ArrayLike, C: ArrayLike) -> Floats:
    """Rows [m, 6, 3 k] that give the stresses xx yy zz xy yz zx [Pa] at places of cells from the DOFs of the cells.

    nodes [m, k, 3] : the cell of each place [m]; at [m, 3] : the place in its reference cell; C [6, 6] or [m, 6, 6] :
    the elasticity the stiffness was made with. Raises InputError as `stiffness`.

    Notes
    -----
    With the incompatible modes of hex8. Stresses are one order less exact than displacements, and best at the points
    of the quadrature of the next lower order: in the middle of linear cells, at the 2 x 2 x 2 points of quadratic ones.

    >>> from femstruct.elements.elasticity import isotropic
    >>> from femstruct.elements.solid_shapes import reference_nodes
    >>> unit = reference_nodes("hex8")[None]
    >>> rows = stresses("hex8", unit, [[0.5, 0.5, 0.5]], isotropic(2.0, 0.0))
    >>> stretched = np.zeros((8, 3)); stretched[:, 0] = unit[0, :, 0]
    >>> (rows[0] @ stretched.ravel()).round(9)
    array([2., 0., 0., 0., 0., 0.])
    """
    places = _places(kind, nodes)
    moduli = _moduli(C, len(places))
    spots = np.atleast_2d(np.asarray(at, dtype=np.float64))
    found, sizes = _global_slopes(places, shapes(kind, spots)[1][:, None])
    rows = _strain_rows(found)[:, 0]
    if kind == "hex8":
        bubbles = _strain_rows(_bubble_slopes(places, spots[:, None], sizes))[:, 0]
        rows = rows - bubbles @ _bubbles_from_nodes(_with_bubbles(places, moduli))
    result: Floats = moduli @ rows
    return result


def volumes(kind: str, nodes: ArrayLike) -> Floats:
    """Volumes [n] of cells [m^3].

    >>> from femstruct.elements.solid_shapes import reference_nodes
    >>> volumes("hex27", reference_nodes("hex27")[None] * [1.0, 2.0, 3.0]).round(9)
    array([6.])
    """
    _, slopes, weights = at_quadrature(kind)
    _, sizes = _global_slopes(_places(kind, nodes), slopes)
    result: Floats = sizes @ weights
    return result


def _places(kind: str, nodes: ArrayLike) -> Floats:
    """Nodes of cells as an array [n, k, 3]."""
    places = np.asarray(nodes, dtype=np.float64)
    expected = (node_count(kind), 3)
    if places.ndim != 3 or places.shape[1:] != expected:
        raise InputError("nodes", got=f"shape {places.shape}", expected=f"[n, {expected[0]}, 3] for {kind}")
    return places


def _moduli(C: ArrayLike, count: int) -> Floats:
    """Elasticities [n, 6, 6] of cells."""
    moduli = np.asarray(C, dtype=np.float64)
    if moduli.shape[-2:] != (6, 6) or not np.array_equal(moduli, np.swapaxes(moduli, -1, -2)):
        raise InputError("C", got=f"shape {moduli.shape}", expected="symmetric matrices 6 x 6")
    result: Floats = np.broadcast_to(moduli, (count, 6, 6))
    return result


def _jacobians(places: Floats, slopes: Floats) -> Floats:
    """Derivatives of the global coordinates along the reference axes [n, q, 3, 3]; slopes [q, 3, k] or [n, q, 3, k]."""
    result: Floats = slopes @ (places if places.ndim == 4 else places[:, None])
    return result


def _global_slopes(places: Floats, slopes: Floats) -> tuple[Floats, Floats]:
    """Derivatives along the global axes [n, q, 3, k], and volumes per reference volume [n, q]."""
    J = _jacobians(places, slopes)
    sizes = np.linalg.det(J)
    if not (sizes > 0.0).all():
        worst = int(np.argmin(np.nan_to_num(sizes.min(axis=1), nan=-np.inf)))
        raise InputError(
            f"cell {worst}",
            got=f"a volume of {sizes[worst].min():.3g} m^3 per reference volume at a point of its quadrature",
            expected="one above zero",
            do="turn its nodes to the order of VTK, or mesh better there",
        )
    return _solved(J, np.broadcast_to(slopes, (*J.shape[:2], *slopes.shape[-2:]))), sizes


def _strain_rows(slopes: Floats) -> Floats:
    """Strains xx yy zz xy yz zx [n, q, 6, 3 k] from the displacements whose shape functions have these derivatives."""
    n, q, _, k = slopes.shape
    rows = np.zeros((n, q, 6, k, 3))
    for axis in range(3):
        rows[:, :, axis, :, axis] = slopes[:, :, axis]
        after = (axis + 1) % 3
        rows[:, :, 3 + axis, :, axis] = slopes[:, :, after]
        rows[:, :, 3 + axis, :, after] = slopes[:, :, axis]
    return rows.reshape(n, q, 6, 3 * k)


def _energy(rows: Floats, weights: Floats, moduli: Floats) -> Floats:
    """Sums over q of weights [n, q] times rows^T C rows [n, d, d], for strain rows [n, q, 6, d]."""
    n, q, _, d = rows.shape
    stresses = (moduli[:, None] @ rows) * weights[:, :, None, None]
    return _mean_with_transpose(rows.reshape(n, 6 * q, d).transpose(0, 2, 1) @ stresses.reshape(n, 6 * q, d))


def _stiffness(kind: str, places: Floats, moduli: Floats) -> Floats:
    if kind == "hex8":
        full = _with_bubbles(places, moduli)
        return _mean_with_transpose(full[:, :24, :24] - full[:, :24, 24:] @ _bubbles_from_nodes(full))
    _, slopes, weights = at_quadrature(kind)
    found, sizes = _global_slopes(places, slopes)
    return _energy(_strain_rows(found), sizes * weights, moduli)


def _mean_with_transpose(matrices: Floats) -> Floats:
    """The product of matrices rounds differently above and below the diagonal."""
    result: Floats = (matrices + matrices.transpose(0, 2, 1)) / 2.0
    return result


def _bubble_slopes(places: Floats, at: Floats, sizes: Floats) -> Floats:
    """Derivatives [n, q, 3, 3] of the three bubbles 1 - (2 s - 1)^2 of cells hex8 at places [q, 3] or [n, q, 3], with
    the axes of the middle of the cell: their strains then have no mean (Taylor, Beresford, Wilson 1976)."""
    middle = _jacobians(places, shapes("hex8", np.full((1, 3), 0.5))[1])
    own = -4.0 * (2.0 * np.asarray(at) - 1.0)[..., None] * np.eye(3)
    shares: Floats = np.linalg.det(middle) / sizes
    return _solved(middle, np.broadcast_to(own, (*sizes.shape, 3, 3))) * shares[:, :, None, None]


def _with_bubbles(places: Floats, moduli: Floats) -> Floats:
    """Stiffness [n, 33, 33] of cells hex8 on the nodes and the nine incompatible modes."""
    _, slopes, weights = at_quadrature("hex8")
    found, sizes = _global_slopes(places, slopes)
    bubbles = _bubble_slopes(places, quadrature("hex8")[0], sizes)
    rows = np.concatenate([_strain_rows(found), _strain_rows(bubbles)], axis=-1)
    return _energy(rows, sizes * weights, moduli)


def _bubbles_from_nodes(full: Floats) -> Floats:
    """Matrix [n, 9, 24] whose product with the DOFs of a cell is, with its sign turned, what its bubbles do."""
    return _solved(full[:, 24:, 24:], full[:, 24:, :24])


def _solved(matrices: Floats, right: Floats) -> Floats:
    result: Floats = np.asarray(np.linalg.solve(matrices, right), dtype=np.float64)
    return result
