"""Motion inside flat elements of any number of corners, and its inertia.

The rotations follow the shape functions of the corners. u, v and w have parabolas along the sides beside these: a side
bows as a beam does that is bent by its ends, by an eighth of its length times the difference of the rotations there: RZ
for u and v, the lean of the fibres along the side for w ("linked" interpolation: the shear strain along a side is then
constant). Rigid motions bow nothing.

Shape functions come as arrays with those of the corners first and those of the sides behind, 1 in the middle of their
side; side k runs from corner k to the next. Own DOFs are in the order of `femstruct.elements.facets.axes.own_motion`:
all w, all beta_x, all beta_y, all u, all v, all RZ.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.elements.facets.axes import symmetric


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

    of_sides : `side_displacements`. The normal of a side in the plane, turned by a right angle, is its direction.
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

    products [n, 2 k, 2 k] : integrals of products of shape functions [m^2]; of_sides : `side_displacements`; m0, m2 [n]
    : mass [kg/m^2] and rotary inertia [kg] per area.
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

    at [m, 2 k] : shape functions; heights [m, k] : of the nodes above the mean plane [m].
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
