"""What flat elements of shells are made of: axes in space, rigidities, motion inside, images of the unit square."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats, Integers
from femstruct.elements import laminate
from femstruct.elements.plate import CORNERS
from femstruct.elements.polynomials import LINEAR, QUADRATIC, derivative, gauss_interval, powers
from femstruct.errors import InputError

# ----------------------------------------------------------------------------------------------------------------------
# Axes of flat elements in space: each element's own frame, rigidities turned into it, matrices turned out of it.
# ----------------------------------------------------------------------------------------------------------------------

_OF_SHIFTS: Final = [3, 4, 0]  # u, v, w among own DOFs
PARALLEL: Final = 1e-3
"""Sine of the angle to the normal below which a direction has no place in the plane of an element."""


def frames(corners: ArrayLike) -> Floats:
    """Own axes of flat elements: x and y in the plane, z the normal, about which the corners go counterclockwise.

    Parameters
    ----------
    corners : ArrayLike [n, 3, 3] or [n, 4, 3]
        Corners of triangles or quadrilaterals in space [m].

    Returns
    -------
    Floats
        R [n, 3, 3]: rows are x, y and z in global components, as of `femstruct.elements.members.directions`.

    Raises
    ------
    InputError
        For an element without area.

    Notes
    -----
    x of a quadrilateral lies as near as can be to two of its sides, so that it depends on the corner to start with by
    quarter turns alone; x of a triangle lies along its first side. Rigidities that depend on direction are given in
    these axes: `rotate_rigidities` brings them here.

    Examples
    --------
    >>> bool(np.allclose(frames([[[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]]])[0], np.eye(3)))
    True
    """
    points = np.asarray(corners, dtype=np.float64)
    if points.ndim != 3 or points.shape[1] not in (3, 4) or points.shape[2] != 3:
        raise InputError("corners", got=f"shape {points.shape}", expected="shape (n, 3, 3) or (n, 4, 3)")
    if points.shape[1] == 3:
        along, other = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
        normal = _unit(np.cross(along, other))
        x = _unit(along)
    else:
        first, second = points[:, 2] - points[:, 0], points[:, 3] - points[:, 1]
        normal = _unit(np.cross(first, second))
        r, s = _unit(first - second), _unit(first + second)
        x = _unit(_unit(r + s) + _unit(r - s))
    return np.stack([x, np.cross(normal, x), normal], axis=1)


def flatten(corners: Floats, R: Floats) -> tuple[Floats, Floats]:
    """Corners in the plane of each element and their heights above it: [n, k, 2] and [n, k] [m], about the centre."""
    own = (corners - corners.mean(axis=1, keepdims=True)) @ R.swapaxes(1, 2)
    return own[..., :2], own[..., 2]


def angles(R: ArrayLike, direction: ArrayLike) -> Floats:
    """Angles [n] [rad] about z from the x axes of frames R [n, 3, 3] to a direction in space, laid into each plane.

    direction [3] or [n, 3]. Raises InputError for a direction along the normal of an element.

    >>> round(float(angles(np.eye(3)[None], [1.0, 1.0, 5.0])[0] / np.pi), 12)
    0.25
    """
    axes = np.asarray(R, dtype=np.float64)
    directions = np.broadcast_to(np.asarray(direction, dtype=np.float64), (len(axes), 3))
    along, across, _ = np.einsum("nij,nj->in", axes, directions)
    lost = ~(np.hypot(along, across) > PARALLEL * np.linalg.norm(directions, axis=1))
    if lost.any():
        where = f"orientation at cell {np.flatnonzero(lost)[0]}"
        raise InputError(where, got="the direction of its normal", expected="a direction along the surface")
    result: Floats = np.arctan2(across, along)
    return result


def rotate_rigidities(rigidity: ArrayLike, angle: ArrayLike) -> Floats:
    """Rigidities in the axes of elements from those in the axes of the material.

    Parameters
    ----------
    rigidity : ArrayLike [3, 3] or [n, 3, 3]
        A, B or D for (xx, yy, 2 xy); [2, 2] or [n, 2, 2] : As for the shear strains of x and y.
    angle : ArrayLike [n]
        From x of the element to x of the material about z [rad], of `angles`.

    Returns
    -------
    Floats
        [n, 3, 3] or [n, 2, 2].

    Examples
    --------
    >>> rotate_rigidities(np.diag([4.0, 1.0, 0.5]), [np.pi / 2])[0].round(12).diagonal()
    array([1. , 4. , 0.5])
    """
    matrix = np.asarray(rigidity, dtype=np.float64)
    return laminate.rotate_shear(matrix, angle) if matrix.shape[-1] == 2 else laminate.rotate_stiffness(matrix, angle)


def rotate_resultants(rows: ArrayLike, angle: ArrayLike) -> Floats:
    """Rows of (Nx Ny Nxy Mx My Mxy Qx Qy) in axes turned by angles about z: [m, 8, k], [m] [rad] -> [m, 8, k].

    >>> rotate_resultants(np.eye(8)[None, :, :1], [np.pi / 2])[0, :, 0].round(12)
    array([ 0.,  1., -0.,  0.,  0.,  0.,  0.,  0.])
    """
    forces, turn = np.asarray(rows, dtype=np.float64), np.asarray(angle, dtype=np.float64)
    stress_turn = laminate.strain_turn(-turn).swapaxes(1, 2)
    parts = [
        stress_turn @ forces[:, :3],
        stress_turn @ forces[:, 3:6],
        laminate.shear_strain_turn(turn) @ forces[:, 6:],
    ]
    return np.concatenate(parts, axis=1)


def own_motion(R: Floats, heights: Floats) -> Floats:
    """Motion of the corners of a mean plane from that of the nodes: T [n, 6 k, 6 k].

    Columns: UX UY UZ RX RY RZ of every node in global axes. Rows, in own axes: all w, all beta_x, all beta_y, all u,
    all v, all RZ, with beta_x = RY and beta_y = -RX the lean of the fibres across the plate: shear (w, beta), bending
    (beta) and stretching (u, v, RZ) each have DOFs side by side, and beta bends as u and v stretch.

    Parameters
    ----------
    R : Floats [n, 3, 3]
        Axes of the elements.
    heights : Floats [n, k]
        Of the nodes above the mean plane [m], to which arms along the normal join them: u = u_node - z RY, v = v_node +
        z RX.
    """
    count, nodes = heights.shape
    T = np.zeros((count, 6, nodes, nodes, 2, 3))
    shift, turn = 0, 1
    for node in range(nodes):
        T[:, _OF_SHIFTS, node, node, shift] = R
        T[:, 1, node, node, turn], T[:, 2, node, node, turn] = R[:, 1], -R[:, 0]
        T[:, 5, node, node, turn] = R[:, 2]
        T[:, 3, node, node, turn] = -heights[:, node, None] * R[:, 1]
        T[:, 4, node, node, turn] = heights[:, node, None] * R[:, 0]
    return T.reshape(count, 6 * nodes, 6 * nodes)


def out_of_own_axes(rows: Floats, R: Floats) -> Floats:
    """Rows [m, 6, k] that give shifts and rotations in axes R [m, 3, 3], made to give them in global ones."""
    parts = rows.reshape(len(rows), 2, 3, -1)
    result: Floats = (R.swapaxes(1, 2)[:, None] @ parts).reshape(rows.shape)
    return result


def congruence(matrices: Floats, T: Floats) -> Floats:
    """T' matrices T, exactly symmetric."""
    return symmetric(T.swapaxes(1, 2) @ (matrices @ T))


def symmetric(matrices: Floats) -> Floats:
    """The symmetric part: products of matrices round differently above and below the diagonal."""
    result: Floats = matrices + matrices.swapaxes(-1, -2)
    result *= 0.5
    return result


def _unit(vectors: Floats) -> Floats:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    if not (length > 0).all():
        where = f"cell {np.flatnonzero(~(length[..., 0] > 0))[0]}"
        raise InputError(
            where, got="corners without an area between them", expected="corners of a flat element in turn"
        )
    result: Floats = vectors / length
    return result


# ----------------------------------------------------------------------------------------------------------------------
# Matrices of many elements: blocks that stay in the cache, and elements that are alike computed once.
# ----------------------------------------------------------------------------------------------------------------------

AT_ONCE: Final = 500
"""Elements of a block: their strain rows take 2 MB."""
SAMPLE: Final = 500
"""Elements that are looked at before all are compared: the next ones of a regular mesh are alike."""
ALIKE: Final = 1e-12
"""Of the largest number: what differs by less is the same, since coordinates of equal elements differ by rounding."""
_KEPT: Final = 31 * 2**20  # bytes


def matrices_by_kind(size: int, matrices: Callable[..., Floats], *arrays: Floats) -> Floats:
    """Matrices [n, size, size] of elements by a function of arrays that have one entry an element [n, ..].

    Elements with the same entries but for rounding get the matrix of the first of them; a mesh whose first
    elements differ is computed element by element.

    >>> def squares(sides):
    ...     return sides[:, None, None] ** 2
    >>> matrices_by_kind(1, squares, np.array([1.0, 2.0, 1.0, 2.0, 2.0])).ravel()
    array([1., 4., 1., 4., 4.])
    """
    count = len(arrays[0])
    first = of = np.arange(count)
    if 2 * len(kinds_of_elements(*(array[:SAMPLE] for array in arrays))[0]) <= min(count, SAMPLE):
        first, of = kinds_of_elements(*arrays)
    # A freed array of this size makes glibc keep what is freed: a third of the time went into getting memory again.
    np.empty(_KEPT, np.uint8)
    found = np.empty((len(first), size, size))
    for start in range(0, len(first), AT_ONCE):
        block = first[start : start + AT_ONCE]
        found[start : start + AT_ONCE] = matrices(*(array[block] for array in arrays))
    return found if len(first) == count else found[of]


def kinds_of_elements(*arrays: Floats) -> tuple[Integers, Integers]:
    """The first elements of each kind [k] and the kind of every element [n], by arrays with one entry an element.

    >>> [numbers.tolist() for numbers in kinds_of_elements(np.array([[0.1, 1.0], [0.3, 1.0], [0.1 + 1e-16, 1.0]]))]
    [[0, 1], [0, 1, 0]]
    """
    steps = np.concatenate([_steps(array) for array in arrays], axis=1)
    factors = np.random.default_rng(1).integers(1, 2**62, steps.shape[1]) | 1
    _, first, of = np.unique(steps @ factors, return_index=True, return_inverse=True)
    if (steps[first][of] != steps).any():  # two kinds with one sum: none is alike
        return np.arange(len(steps)), np.arange(len(steps))
    order = np.argsort(first)
    return first[order], np.argsort(order)[of]


def _steps(array: Floats) -> Integers:
    """Entries of each element in whole steps [n, k]; none for an array that is the same for all."""
    flat = np.reshape(array, (len(array), -1))
    largest = np.abs(flat).max(initial=0.0)
    if largest == 0.0 or array.strides[0] == 0:
        return np.zeros((len(array), 0), dtype=np.int64)
    steps: Integers = np.rint(flat / (ALIKE * largest)).astype(np.int64)
    return steps


# ----------------------------------------------------------------------------------------------------------------------
# Motion inside flat elements of any number of corners, and its inertia.
#
# The rotations follow the shape functions of the corners. u, v and w have parabolas along the sides beside these: a
# side bows as a beam does that is bent by its ends, by an eighth of its length times the difference of the rotations
# there: RZ for u and v, the lean of the fibres along the side for w ("linked" interpolation: the shear strain along a
# side is then constant). Rigid motions bow nothing.
#
# Shape functions come as arrays with those of the corners first and those of the sides behind, 1 in the middle of their
# side; side k runs from corner k to the next. Own DOFs are in the order of
# `own_motion`: all w, all beta_x, all beta_y, all u, all v, all RZ.
# ----------------------------------------------------------------------------------------------------------------------


def side_displacements(corners: Floats) -> Floats:
    """Displacements x and y of the middle of each side from RZ at the corners [n, k, 2]: [2, n, k sides, k corners]."""
    to_next = (np.roll(corners, -1, axis=1) - corners) / 8.0
    count = corners.shape[1]
    start, end = np.arange(count), (np.arange(count) + 1) % count
    result = np.zeros((2, len(corners), count, count))
    for of, normal in zip(result, (-to_next[..., 1], to_next[..., 0]), strict=True):
        of[:, start, start], of[:, start, end] = normal, -normal
    return result


def side_bows(of_sides: Floats) -> Floats:
    """Deflection w of the middle of each side from beta_x and beta_y at the corners: [2, n, k sides, k corners].

    Parameters
    ----------
    of_sides : Floats
        `side_displacements`. The normal of a side in the plane, turned by a right angle, is its direction.
    """
    return np.stack([-of_sides[1], of_sides[0]])


def side_shears(corners: Floats) -> Floats:
    """Shear strain in the middle of each side times its length, from all w, beta_x, beta_y: [n, k, 2] -> [n, k, 3 k].

    w at its end less w at its start, and the mean lean of the fibres along it.
    """
    count = corners.shape[1]
    x, y = np.moveaxis(np.roll(corners, -1, axis=1) - corners, -1, 0) / 2.0
    start, end = np.arange(count), (np.arange(count) + 1) % count
    rows = np.zeros((len(corners), count, 3, count))
    for corner, sign in ((start, -1.0), (end, 1.0)):
        rows[:, start, 0, corner], rows[:, start, 1, corner], rows[:, start, 2, corner] = sign, x, y
    return rows.reshape(len(corners), count, 3 * count)


def in_plane_rows(at: Floats, of_sides: Floats) -> Floats:
    """Rows of u, v and RZ from all u, all v, all RZ: shape functions [m, 2 k], [2, m, k, k] -> [m, 3, 3 k]."""
    count = of_sides.shape[-1]
    rows = np.zeros((len(at), 3, 3, count))
    rows[:, 0, 0] = rows[:, 1, 1] = rows[:, 2, 2] = at[:, :count]
    for component, of in enumerate(of_sides):
        rows[:, component, 2] = (at[:, None, count:] @ of)[:, 0]
    return rows.reshape(len(at), 3, 3 * count)


def in_plane_inertia(products: Floats, of_sides: Floats, m0: Floats, m2: Floats) -> Floats:
    """Mass of u and v and rotary inertia of RZ: [n, 3 k, 3 k] with all u, all v, all RZ, exactly symmetric.

    Parameters
    ----------
    products : Floats [n, 2 k, 2 k]
        Integrals of products of shape functions [m^2].
    of_sides : Floats
        `side_displacements`.
    m0, m2 : Floats [n]
        Mass [kg/m^2] and rotary inertia [kg] per area.
    """
    count = of_sides.shape[-1]
    matrices = np.zeros((len(products), 3, count, 3, count))
    _in_plane(matrices, products, _of_bows(products, of_sides, m0), m0, m2)
    return symmetric(matrices.reshape(-1, 3 * count, 3 * count))


class _OfBows(NamedTuple):
    """Mass of the bows of the sides along x and y: with the straight motion of the corners [2, n, k, k], and between
    each other [2, 2, n, k, k]; columns are the rotations that bow them."""

    with_corners: Floats
    between: Floats


def _of_bows(products: Floats, of_sides: Floats, m0: Floats) -> _OfBows:
    count = of_sides.shape[-1]
    moved = (m0[:, None, None] * products[:, :, count:]) @ of_sides
    return _OfBows(moved[:, :, :count], of_sides[:, None].swapaxes(-1, -2) @ moved[None, :, :, count:])


def _in_plane(matrices: Floats, products: Floats, bows: _OfBows, m0: Floats, m2: Floats) -> None:
    """Fill u, v and RZ of matrices [n, 3, k, 3, k]."""
    count = products.shape[1] // 2
    between = products[:, :count, :count]
    straight = m0[:, None, None] * between
    matrices[:, 2, :, 2] = m2[:, None, None] * between + bows.between[0, 0] + bows.between[1, 1]
    for component, with_rotations in enumerate(bows.with_corners):
        matrices[:, component, :, component] = straight
        matrices[:, component, :, 2] = with_rotations
        matrices[:, 2, :, component] = with_rotations.swapaxes(1, 2)


def rows(at: Floats, heights: Floats, of_sides: Floats) -> Floats:
    """Rows of UX UY UZ RX RY RZ in own axes, on the surface through the nodes, from own DOFs: [m, 6, 6 k].

    Parameters
    ----------
    at : Floats [m, 2 k]
        Shape functions.
    heights : Floats [m, k]
        Of the nodes above the mean plane [m].
    """
    count = heights.shape[1]
    here, height = at[:, :count], (at[:, :count] * heights).sum(axis=1)[:, None]
    by_dof = np.zeros((len(at), 6, 6, count))
    by_dof[:, 2, 0], by_dof[:, 3, 2], by_dof[:, 4, 1] = here, -here, here
    for lean, bow in zip((1, 2), side_bows(of_sides), strict=True):
        by_dof[:, 2, lean] = (at[:, None, count:] @ bow)[:, 0]
    by_dof[:, 0, 1] = by_dof[:, 1, 2] = height * here
    result: Floats = by_dof.reshape(len(at), 6, 6 * count)
    result[:, [0, 1, 5], 3 * count :] = in_plane_rows(at, of_sides)
    return result


def inertia(products: Floats, of_sides: Floats, m0: Floats, m1: Floats, m2: Floats) -> Floats:
    """Mass and inertia of own DOFs [n, 6 k, 6 k]; arguments as `in_plane_inertia`, m1 the first moment [kg/m]."""
    count = of_sides.shape[-1]
    between = products[:, :count, :count]
    bows = _of_bows(products, of_sides, m0)
    own = np.zeros((len(products), 6, count, 6, count))
    _in_plane(own[:, 3:, :, 3:], products, bows, m0, m2)
    own[:, 0, :, 0] = m0[:, None, None] * between
    # beta_x and beta_y bow w as RZ bows -v and u (`side_bows`)
    for lean, side, sign in ((1, 1, -1.0), (2, 0, 1.0)):
        own[:, 0, :, lean] = sign * bows.with_corners[side]
        own[:, lean, :, 0] = own[:, 0, :, lean].swapaxes(1, 2)
        own[:, lean, :, lean] = m2[:, None, None] * between + bows.between[side, side]
    own[:, 1, :, 2], own[:, 2, :, 1] = -bows.between[1, 0], -bows.between[0, 1]
    first = m1[:, None, None] * products[:, :count]
    if first.any():
        for lean, shift, of in zip((1, 2), (3, 4), of_sides, strict=True):
            own[:, lean, :, shift] = own[:, shift, :, lean] = first[..., :count]
            own[:, lean, :, 5] = first[..., count:] @ of
            own[:, 5, :, lean] = own[:, lean, :, 5].swapaxes(1, 2)
    return own.reshape(-1, 6 * count, 6 * count)


# ----------------------------------------------------------------------------------------------------------------------
# Checked matrices of rigidity and densities, as the flat elements take them.
# ----------------------------------------------------------------------------------------------------------------------

Rigidities = tuple[ArrayLike, ArrayLike, ArrayLike, ArrayLike]
"""A, B, D and As."""
ROUNDING: Final = 1e-12
"""Asymmetry that the products of matrices leave, beside the largest entry."""


def finite_rigidity(name: str, matrix: ArrayLike, size: int = 3) -> Floats:
    """Matrices [size, size] or [n, size, size] as float64; InputError for another shape and for nan or infinity.

    >>> finite_rigidity("B", np.zeros((3, 3))).shape
    (3, 3)
    """
    rigidity = np.asarray(matrix, dtype=np.float64)
    if rigidity.shape[-2:] != (size, size):
        expected = f"shape ({size}, {size}) or (n, {size}, {size})"
        raise InputError(name, got=f"shape {rigidity.shape}", expected=expected)
    if not np.isfinite(rigidity).all():
        raise InputError(name, got="nan or infinity", expected="finite numbers")
    return rigidity


def symmetric_rigidity(name: str, matrix: ArrayLike, size: int = 3) -> Floats:
    """Matrices as of `finite_rigidity`; InputError for those that are not symmetric.

    >>> symmetric_rigidity("A", np.eye(3)).shape
    (3, 3)
    """
    rigidity = finite_rigidity(name, matrix, size)
    if np.abs(rigidity - rigidity.swapaxes(-1, -2)).max(initial=0.0) > ROUNDING * np.abs(rigidity).max(initial=0.0):
        raise InputError(name, got="a matrix that is not symmetric", expected="a symmetric rigidity")
    return rigidity


def per_area(name: str, value: ArrayLike, count: int) -> Floats:
    """Masses or inertias per area [n] of n cells, zero allowed; InputError for others."""
    density = np.broadcast_to(np.asarray(value, dtype=np.float64), (count,))
    if not (np.isfinite(density) & (density >= 0)).all():
        raise InputError(name, got=str(density.min()), expected="finite values, zero or above")
    return density


def masses(count: int, m0: ArrayLike, m1: ArrayLike, m2: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """m0, m1 and m2 [count] of elements; InputError names the one that is none. m1 may have either sign."""
    first = np.broadcast_to(np.asarray(m1, dtype=np.float64), (count,))
    if not np.isfinite(first).all():
        raise InputError("m1", got="nan or infinity", expected="finite values")
    return per_area("m0", m0, count), first, per_area("m2", m2, count)


def section(
    count: int, A: ArrayLike, B: ArrayLike, D: ArrayLike, As: ArrayLike
) -> tuple[Floats, Floats, Floats, Floats]:
    """A, B, D [count, 3, 3] and As [count, 2, 2] of `count` elements; InputError names the one that is none."""
    symmetric = (symmetric_rigidity(name, of, size) for name, of, size in (("A", A, 3), ("D", D, 3), ("As", As, 2)))
    stretch, bend, shear = (np.broadcast_to(of, (count, *of.shape[-2:])) for of in symmetric)
    coupling = finite_rigidity("B", B)
    return stretch, np.broadcast_to(coupling, (count, 3, 3)), bend, shear


# ----------------------------------------------------------------------------------------------------------------------
# Convex quadrilaterals as images of the unit square: shape functions, gradients, integrals.
#
# Corner n of a cell stands at `femstruct.elements.plate.CORNERS[n]` of the unit square, so xi runs from corner 0 to
# corner 3 and eta from corner 0 to corner 1. The corners may go round the cell either way.
# ----------------------------------------------------------------------------------------------------------------------

N_CORNERS: Final = 4
N_SHAPES: Final = 9
"""Values at the corners, at the middles of the sides, and the bubble: the shape functions in this order."""


def cells(xy: ArrayLike) -> Floats:
    """Corners [n, 4, 2] as float64; InputError for another shape and for a cell that is not convex.

    >>> cells([[0, 0], [1, 0], [1, 1], [0, 1]]).shape
    (1, 4, 2)
    """
    corners = np.asarray(xy, dtype=np.float64)
    corners = corners[None] if corners.ndim == 2 else corners
    if corners.shape[1:] != (N_CORNERS, 2):
        raise InputError("corners of cells", got=f"shape {corners.shape}", expected="shape (n, 4, 2)")
    to_next = np.roll(corners, -1, axis=1) - corners
    turns = cross(to_next, np.roll(to_next, -1, axis=1))
    bad = ~((turns > 0).all(axis=1) | (turns < 0).all(axis=1))
    if bad.any():
        where = np.flatnonzero(bad)[0]
        got = ", ".join(f"({x:g}, {y:g})" for x, y in corners[where])
        raise InputError(f"cell {where}", got=got, expected="the corners of a convex quadrilateral in turn")
    return corners


def cross(a: Floats, b: Floats) -> Floats:
    """z component of the products of vectors in the plane."""
    product: Floats = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return product


@cache
def shapes() -> Floats:
    """Coefficients [9, 4, 4] of xi^i eta^j of the shape functions; those of sides and bubble are 1 in the middle."""
    middle = QUADRATIC[2]
    corner = [np.outer(LINEAR[i], LINEAR[j]) for i, j in CORNERS]
    side = [np.outer(LINEAR[0], middle), np.outer(middle, LINEAR[1])]
    side += [np.outer(LINEAR[1], middle), np.outer(middle, LINEAR[0])]
    return np.array([*corner, *side, np.outer(middle, middle)])


def values(xi: ArrayLike, eta: ArrayLike) -> Floats:
    """Shape functions at places: [m] -> [m, 9].

    >>> values([0.0], [0.5])[0]
    array([0.5, 0.5, 0. , 0. , 1. , 0. , 0. , 0. , 0. ])
    """
    result: Floats = np.einsum("kij,...i,...j->...k", shapes(), powers(xi), powers(eta), optimize=True)
    return result


def slopes(xi: ArrayLike, eta: ArrayLike) -> Floats:
    """Derivatives of the shape functions by xi and by eta at places: [m] -> [2, m, 9]."""
    by_xi, by_eta = derivative(shapes(), 1), derivative(shapes(), 2)
    return np.stack(
        [np.einsum("kij,...i,...j->...k", of, powers(xi), powers(eta), optimize=True) for of in (by_xi, by_eta)]
    )


def gradients(
    corners: Floats, xi: Floats, eta: Floats, of: Floats | tuple[Floats, Floats]
) -> tuple[Floats, Floats, Floats]:
    """Derivatives of functions by x and by y at places of cells, and the areas that a unit of the square has there.

    corners [n, 4, 2].

    Parameters
    ----------
    xi, eta : Floats
        Places, broadcast to [n, g].
    of : Floats | tuple[Floats, Floats] [2, .., k]
        Derivatives of the functions by xi and by eta there, broadcast to [2, n, g, k].

    Returns
    -------
    tuple[Floats, Floats, Floats]
        Two arrays [n, g, k], and [n, g], positive whichever way the corners go round.
    """
    along_xi, along_eta, twist = (part[:, None] for part in edges(corners))
    by_xi = along_xi + np.asarray(eta)[..., None] * twist
    by_eta = along_eta + np.asarray(xi)[..., None] * twist
    determinant = cross(by_xi, by_eta)
    by_xi, by_eta = by_xi / determinant[..., None], by_eta / determinant[..., None]
    by_x = by_eta[..., 1:] * of[0] - by_xi[..., 1:] * of[1]
    by_y = by_xi[..., :1] * of[1] - by_eta[..., :1] * of[0]
    return by_x, by_y, np.abs(determinant)


def edges(corners: Floats) -> tuple[Floats, Floats, Floats]:
    """Coefficients of xi, eta and xi eta in the place: each [n, 2] or, for corners in space, [n, 3]."""
    p0, p1, p2, p3 = np.moveaxis(corners, 1, 0)
    return p3 - p0, p1 - p0, p0 - p1 + p2 - p3


@cache
def square_points(n: int) -> tuple[Floats, Floats, Floats]:
    """n x n Gauss points of the unit square: xi, eta, weights [n n]; exact to the degree 2 n - 1 in either."""
    points, weights = gauss_interval(n)
    return np.repeat(points, n), np.tile(points, n), np.outer(weights, weights).ravel()


@cache
def _value_integrals() -> Floats:
    """[3, 8, 8]: integrals of products of the functions of corners and sides times 1, xi, eta; exact."""
    xi, eta, weights = square_points(3)
    each = values(xi, eta)[:, :8]
    factors = weights * np.stack([np.ones_like(xi), xi, eta])
    result: Floats = np.einsum("fg,gk,gl->fkl", factors, each, each, optimize=True)
    return result


def value_products(corners: Floats) -> Floats:
    """Integrals over cells of all products of the shape functions of corners and sides: [n, 8, 8] [m^2], exact."""
    along_xi, along_eta, twist = edges(corners)
    area = np.stack([cross(along_xi, along_eta), cross(along_xi, twist), cross(twist, along_eta)], axis=1)
    area *= np.sign(area[:, :1] * 2 + area[:, 1:2] + area[:, 2:])
    return (area @ _value_integrals().reshape(3, -1)).reshape(-1, 8, 8)
