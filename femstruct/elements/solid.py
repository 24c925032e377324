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
scikit-fem; elasticities are made by `hooke`.

The stiffness of hex8 has the nine incompatible modes of Wilson with Taylor's correction, which makes it pass the
patch test in any shape: a plain trilinear cell bends as if it were many times stiffer. They are condensed; mass and
motion are trilinear.

References: E. L. Wilson, R. L. Taylor, W. P. Doherty, J. Ghaboussi, in Numerical and Computer Methods in Structural
Mechanics (Academic Press 1973) 43-57. R. L. Taylor, P. J. Beresford, E. L. Wilson, International Journal for
Numerical Methods in Engineering 10 (1976) 1211-1219, doi:10.1002/nme.1620100602.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any, Final, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats, Integers
from femstruct.elements.members import densities
from femstruct.elements.polynomials import positive
from femstruct.errors import InputError

# ----------------------------------------------------------------------------------------------------------------------
# Hooke's law of isotropic and orthotropic solids, in the order xx yy zz xy yz zx.
# ----------------------------------------------------------------------------------------------------------------------


def isotropic(E: float, nu: float) -> Floats:
    """Stresses [6, 6] in Pa of unit strains of an isotropic solid; shear strains twice the tensor's.

    Parameters
    ----------
    E : float
        Young's modulus [Pa].
    nu : float
        Poisson's ratio, between -1 and 0.5.

    Raises
    ------
    InputError
        For others.

    Examples
    --------
    >>> isotropic(2.0, 0.0).diagonal()
    array([2., 2., 2., 1., 1., 1.])
    """
    positive("E", E)
    if not -1.0 < nu < 0.5:
        raise InputError("nu", got=str(nu), expected="a value between -1 and 0.5")
    shear = E / (2.0 * (1.0 + nu))
    lame = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    C = np.diag([shear] * 6)
    C[:3, :3] = lame + 2.0 * shear * np.eye(3)
    return C


def compliance(E: Sequence[float], G: Sequence[float], nu: Sequence[float]) -> Floats:
    """Strains [6, 6] in 1/Pa of unit stresses, shear strains twice the tensor's.

    Parameters
    ----------
    E : Sequence[float]
        (Ex, Ey, Ez) [Pa].
    G : Sequence[float]
        (Gxy, Gyz, Gzx) [Pa].
    nu : Sequence[float]
        (nuxy, nuyz, nuzx) [1], nuij being the contraction along j under stress along i; nuij / Ei = nuji / Ej.

    Examples
    --------
    >>> compliance((2.0, 1.0, 1.0), (1.0, 1.0, 4.0), (0.5, 0.0, 0.0))[:2, :2].tolist()
    [[0.5, -0.25], [-0.25, 1.0]]
    """
    S = np.diag(1.0 / np.array([*E, *G], dtype=np.float64))
    for i, (j, value) in enumerate(zip((1, 2, 0), nu, strict=True)):
        S[i, j] = S[j, i] = -value / E[i]
    return S


def hooke(E: Sequence[float], G: Sequence[float], nu: Sequence[float]) -> Floats:
    """Stresses [6, 6] in Pa of unit strains; arguments as `compliance`.

    Raises InputError, with the numbers, for constants with which a solid could give energy without having got any.

    >>> hooke((1.0,) * 3, (0.5,) * 3, (0.0,) * 3).diagonal()
    array([1. , 1. , 1. , 0.5, 0.5, 0.5])
    """
    pairs = (("xy", 0, 1), ("yz", 1, 2), ("zx", 2, 0))
    for (pair, i, j), value in zip(pairs, nu, strict=True):
        limit = float(np.sqrt(E[i] / E[j]))
        if not abs(value) < limit:
            first, second = pair[0], pair[1]
            other = value * E[i] / E[j] if abs(value) < 1.0 else 0.0
            hint = f"; if {value:g} is nu{second}{first}, write {other:.4g}" if 0.0 < other < limit else ""
            raise InputError(
                "nu",
                got=f"nu{pair} = {value:g} with E{first} = {E[i]:g} Pa and E{second} = {E[j]:g} Pa",
                expected=f"less than sqrt(E{first} / E{second}) = {limit:.4g}",
                do=f"nu{pair} is the contraction along {second} under stress along {first}{hint}",
            )
    S = compliance(E, G, nu)
    left = float(np.linalg.det(S[:3, :3]) * np.prod(E))
    if not left > 0.0:
        raise InputError(
            "nu",
            got=f"1 - nuxy nuyx - nuyz nuzy - nuzx nuxz - 2 nuxy nuyz nuzx = {left:.4g} with "
            f"nuxy, nuyz, nuzx = {', '.join(f'{value:g}' for value in nu)}",
            expected="a sum above 0",
            do="lower the ratios, the largest first",
        )
    C = np.linalg.inv(S)
    return np.asarray((C + C.T) / 2.0)


def rotate_elasticity(C: ArrayLike, axes: ArrayLike) -> Floats:
    """Elasticity [6, 6] [Pa] along global axes of a material whose own x, y, z are the rows of axes [3, 3].

    >>> quarter = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    >>> rotate_elasticity(np.diag([3.0, 2.0, 1.0, 1.0, 1.0, 1.0]), quarter).diagonal().round(9)
    array([2., 3., 1., 1., 1., 1.])
    """
    R = np.asarray(axes, dtype=np.float64)
    i, j = [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]
    # Strains along the own axes from those along the global ones; shear strains are twice the tensor's.
    halves = np.array([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
    both = R[i][:, i] * R[j][:, j] + R[i][:, j] * R[j][:, i]
    strains = both * halves / halves[:, None]
    strains[:, :3] /= 2.0
    result = strains.T @ np.asarray(C, dtype=np.float64) @ strains
    return np.asarray((result + result.T) / 2.0)


# ----------------------------------------------------------------------------------------------------------------------
# The reference cells of solid elements: their nodes, shape functions and quadrature, which are scikit-fem's.
#
# Nodes are in the order of VTK and meshio: corners, then the middles of edges, then for hex27 those of faces and of the
# cell.
# ----------------------------------------------------------------------------------------------------------------------

SolidElement = Literal["tet4", "tet10", "hex8", "hex20", "hex27"]
KINDS: Final = get_args(SolidElement)
_TETRAHEDRON: Final = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
_HEXAHEDRON: Final = tuple((x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))
_TET_EDGES: Final = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
_AROUND: Final = ((0, 1), (1, 2), (2, 3), (3, 0))
_HEX_EDGES: Final = (*_AROUND, *((i + 4, j + 4) for i, j in _AROUND), *((i, i + 4) for i in range(4)))
_HEX_FACES: Final = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (2, 3, 7, 6), (0, 1, 2, 3), (4, 5, 6, 7), range(8))
_ORDER: Final = {"tet4": 2, "tet10": 4, "hex8": 3, "hex20": 5, "hex27": 5}
"""Degree that the quadrature has exactly: that of the squared shape functions of a straight cell."""


def node_count(kind: str) -> int:
    """Nodes of a cell; InputError for an unknown kind.

    >>> node_count("hex20")
    20
    """
    return len(reference_nodes(kind))


@cache
def reference_nodes(kind: str) -> Floats:
    """Nodes [k, 3] of the reference cell, from 0 to 1 along its axes; InputError for an unknown kind.

    >>> reference_nodes("tet4").tolist()
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    if kind not in KINDS:
        raise InputError("element", got=repr(kind), expected=" or ".join(KINDS))
    corners = np.array(_TETRAHEDRON if kind.startswith("tet") else _HEXAHEDRON, dtype=np.float64)
    groups = {"tet4": (), "tet10": _TET_EDGES, "hex8": (), "hex20": _HEX_EDGES, "hex27": (*_HEX_EDGES, *_HEX_FACES)}
    nodes = np.array([*corners, *(corners[list(group)].mean(axis=0) for group in groups[kind])])
    nodes.flags.writeable = False
    return nodes


def interpolate(kind: str, at: ArrayLike) -> Floats:
    """Shape functions [m, k] at places [m, 3] of the reference cell (0 to 1 along its axes).

    >>> interpolate("hex8", [[0.5, 0.5, 0.5]])
    array([[0.125, 0.125, 0.125, 0.125, 0.125, 0.125, 0.125, 0.125]])
    """
    return shapes(kind, np.atleast_2d(np.asarray(at, dtype=np.float64)))[0]


@cache
def _element(kind: str) -> tuple[Any, Integers]:
    """The element of scikit-fem, and where its shape functions stand in the order of our nodes."""
    import skfem

    makes = {
        "tet4": skfem.ElementTetP1,
        "tet10": skfem.ElementTetP2,
        "hex8": skfem.ElementHex1,
        "hex20": skfem.ElementHexS2,
        "hex27": skfem.ElementHex2,
    }
    at = reference_nodes(kind).T
    element = makes[kind]()
    values = np.stack([element.lbasis(at, i)[0] for i in range(at.shape[1])])
    return element, np.argmax(values, axis=0)


def shapes(kind: str, at: Floats) -> tuple[Floats, Floats]:
    """Shape functions [m, k] and their derivatives along the reference axes [m, 3, k]."""
    element, order = _element(kind)
    found = [element.lbasis(at.T, int(i)) for i in order]
    values = np.stack([np.broadcast_to(value, len(at)) for value, _ in found], axis=-1)
    slopes = np.stack([np.broadcast_to(slope, (3, len(at))).T for _, slope in found], axis=-1)
    return values, slopes


@cache
def quadrature(kind: str) -> tuple[Floats, Floats]:
    """Places [q, 3] and weights [q] in the reference cell."""
    from skfem.quadrature import get_quadrature

    at, weights = get_quadrature(_element(kind)[0].refdom, _ORDER[kind])
    return at.T, weights


@cache
def at_quadrature(kind: str) -> tuple[Floats, Floats, Floats]:
    """Shape functions [q, k], their derivatives [q, 3, k] and weights [q]."""
    at, weights = quadrature(kind)
    return *shapes(kind, at), weights


# ----------------------------------------------------------------------------------------------------------------------
# Solid elements in three dimensions, isoparametric.
# ----------------------------------------------------------------------------------------------------------------------

AT_ONCE: Final = 256
"""Cells that are integrated at once: strain rows of hex27 at all points take 105 kB a cell."""


def least_sizes(kind: str, nodes: ArrayLike) -> Floats:
    """Least volume per reference volume of each cell [n] [m^3] at the points of its quadrature: zero or below where it
    is folded or turned inside out.

    >>> from femstruct.elements.solid import reference_nodes
    >>> least_sizes("hex8", reference_nodes("hex8")[None][:, [4, 5, 6, 7, 0, 1, 2, 3]]) > 0.0
    array([False])
    """
    places = _places(kind, nodes)
    result: Floats = np.linalg.det(_jacobians(places, at_quadrature(kind)[1])).min(axis=1)
    return result


def stiffness(kind: str, nodes: ArrayLike, C: ArrayLike) -> Floats:
    """Stiffness matrices of solid cells.

    Parameters
    ----------
    kind : str
        One of KINDS; nodes [n, k, 3] [m].
    C : ArrayLike [6, 6] or [n, 6, 6]
        Elasticity [Pa], symmetric, global axes.

    Returns
    -------
    Floats
        [n, 3 k, 3 k], exactly symmetric.

    Raises
    ------
    InputError
        For cells of another shape than the kind's, for cells turned inside out, and for a C that is not symmetric.

    Notes
    -----
    Integrated exactly for cells with straight edges and parallel faces. tet4 is many times too stiff in bending.

    Examples
    --------
    >>> from femstruct.elements.solid import isotropic
    >>> from femstruct.elements.solid import reference_nodes
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

    Parameters
    ----------
    kind : str
        One of KINDS; nodes [n, k, 3] [m]; rho [n] or one value [kg/m^3], zero allowed.

    Returns
    -------
    Floats
        [n, 3 k, 3 k], exactly symmetric.

    Examples
    --------
    >>> from femstruct.elements.solid import reference_nodes
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

    Parameters
    ----------
    nodes : ArrayLike [m, k, 3]
        The cell of each place [m].
    at : ArrayLike [m, 3]
        The place in its reference cell.
    C : ArrayLike [6, 6] or [m, 6, 6]
        The elasticity the stiffness was made with.

    Raises
    ------
    InputError
        As `stiffness`.

    Notes
    -----
    With the incompatible modes of hex8. Stresses are one order less exact than displacements, and best at the points
    of the quadrature of the next lower order: in the middle of linear cells, at the 2 x 2 x 2 points of quadratic ones.

    Examples
    --------
    >>> from femstruct.elements.solid import isotropic
    >>> from femstruct.elements.solid import reference_nodes
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

    >>> from femstruct.elements.solid import reference_nodes
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
