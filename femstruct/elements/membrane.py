"""Membrane action of flat quadrilaterals with a drilling rotation: stretch and shear in their own plane.

The element of Ibrahimbegovic, Taylor and Wilson. The DOFs at each corner are, in the cell's own axes, u, v and the
right-hand rotation RZ about the normal. Across each side the displacement is a parabola whose slopes at the ends
differ as the rotations there do, so the element bends in its plane as a beam does; a bubble in the middle is
eliminated. A last term ties RZ to the rotation (v_x - u_y) / 2 of the displacements.

Corner n stands at `femstruct.elements.plate.CORNERS[n]` of the unit square: xi runs from corner 0 to corner 3, eta from
corner 0 to corner 1. The corners may go round the cell either way. For a cell a x b of `femstruct.elements.plate` give
`rectangle(a, b)`: corners, xi and eta are then the same in both.

Two choices were measured on Cook's membrane, beams, cylinders and a hemisphere. The strain energy takes 0.99 of 2 x 2
Gauss points and 0.01 of 3 x 3: the first alone leave a seventh zero-energy mode in a lone cell, the second alone are
too stiff in curved shells. The tie of RZ has one point in the centre: four make coarse meshes up to 10 % too stiff. A
factor of 0.1 to 10 on it changes the deflection of Cook's membrane by less than 0.5 % with 4 x 4 cells, 0.1 % with 32 x
32.

References: A. Ibrahimbegovic, R. L. Taylor, E. L. Wilson, Int. J. Numer. Methods Eng. 30 (1990) 445-457,
doi:10.1002/nme.1620300305. T. J. R. Hughes, F. Brezzi, Comput. Methods Appl. Mech. Eng. 72 (1989) 105-121,
doi:10.1016/0045-7825(89)90124-2.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, partial
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.elements.flat_elements import (
    cells,
    gradients,
    in_plane_inertia,
    in_plane_rows,
    matrices_by_kind,
    per_area,
    side_displacements,
    slopes,
    square_points,
    symmetric,
    symmetric_rigidity,
    value_products,
    values,
)
from femstruct.elements.plate import CORNERS
from femstruct.elements.polynomials import positive

N_DOFS: Final = 12
FEW_POINTS: Final = 0.99
"""Share of 2 x 2 points in the strain energy; the rest has 3 x 3 points."""

BY_CORNER: Final = np.arange(N_DOFS).reshape(3, 4).T.ravel()
"""Where u v RZ of each corner in turn stand in the order of `Strains`: all u, all v, all RZ."""

_U, _V, _RZ = slice(0, 4), slice(4, 8), slice(8, 12)
_CORNER, _SIDE, _BUBBLE = slice(0, 4), slice(4, 8), slice(8, 9)


def rectangle(a: ArrayLike, b: ArrayLike) -> Floats:
    """Corners [n, 4, 2] of rectangles a x b in the order of `femstruct.elements.plate`: (0,0) (0,b) (a,b) (a,0).

    >>> rectangle(2.0, 1.0)[0].tolist()
    [[0.0, 0.0], [0.0, 1.0], [2.0, 1.0], [2.0, 0.0]]
    """
    sizes = np.stack(np.broadcast_arrays(np.atleast_1d(positive("a", a)), np.atleast_1d(positive("b", b))), axis=-1)
    corners: Floats = sizes[:, None, :] * np.array(CORNERS, dtype=np.float64)
    return corners


def stiffness(xy: ArrayLike, A: ArrayLike, drilling: float = 1.0, share: ArrayLike | None = None) -> Floats:
    """Stiffness matrices of membrane cells.

    Parameters
    ----------
    xy : ArrayLike [n, 4, 2]
        Corners [m].
    A : ArrayLike [3, 3] or [n, 3, 3]
        Membrane stiffness [N/m] in (Nx, Ny, Nxy) = A (u_x, v_y, u_y + v_x).
    drilling : float
        Factor on the stiffness A66 that ties RZ to the rotation of the displacements.
    share : ArrayLike | None
        A part of A, as of some layers, whose part of the energy is wanted.

    Returns
    -------
    Floats
        [n, 12, 12], DOFs u v RZ at every corner, exactly symmetric.

    Raises
    ------
    InputError
        For a cell that is not convex and for an A that is not symmetric.

    Examples
    --------
    >>> A = np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]])
    >>> K = stiffness(rectangle(2.0, 1.0), A)
    >>> stretch = np.array([0, 0, 0, 0, 0, 0, 2, 0, 0, 2, 0, 0])  # u = x
    >>> round(float(stretch @ K[0] @ stretch), 12)  # strain 1 on an area of 2
    2.0
    """
    corners, given = cells(xy), [symmetric_rigidity("A", of) for of in (A, share) if of is not None]
    each = [np.broadcast_to(rigidity, (len(corners), 3, 3)) for rigidity in given]
    return matrices_by_kind(N_DOFS, partial(_stiffness, drilling), corners - corners[:, :1], *each)


def mass(xy: ArrayLike, m0: ArrayLike, m2: ArrayLike) -> Floats:
    """Consistent mass matrices of membrane cells, exactly integrated.

    Parameters
    ----------
    xy : ArrayLike [n, 4, 2]
        Corners [m]; m0 [n] or one value : mass per area [kg/m^2]; m2 [n] or one value : rotary inertia of RZ per area
        [kg], rho t^3 / 12 of a plate. Both may be zero.

    Returns
    -------
    Floats
        [n, 12, 12], exactly symmetric. The displacements are those of `interpolate`, without the bubble. Where m2 is
        zero, equal RZ at all corners have no mass.

    Examples
    --------
    >>> M = mass(rectangle(2.0, 1.0), 10.0, 0.0)
    >>> along_x = np.tile([1.0, 0.0, 0.0], 4)
    >>> round(float(along_x @ M[0] @ along_x), 12)
    20.0
    """
    corners = cells(xy)
    given = (per_area(name, of, len(corners)) for name, of in (("m0", m0), ("m2", m2)))
    return matrices_by_kind(N_DOFS, _mass, corners - corners[:, :1], *given)


def interpolate(xy: ArrayLike, xi: ArrayLike, eta: ArrayLike) -> Floats:
    """Rows that give u, v and RZ at places of cells from the DOFs of the cells.

    Parameters
    ----------
    xy : ArrayLike [m, 4, 2]
        Corners of the cell of each place [m].
    xi, eta : ArrayLike [m]
        Place in it, 0 to 1.

    Returns
    -------
    Floats
        [m, 3, 12].

    Examples
    --------
    >>> rows = interpolate(rectangle(2.0, 1.0), [0.5], [0.0])
    >>> rows[0, 1, [2, 11]]  # the side from corner 0 to corner 3 bends as a beam: v = L / 8 (RZ0 - RZ3)
    array([ 0.25, -0.25])
    """
    corners = cells(xy)
    return in_plane_rows(values(xi, eta)[:, :8], side_displacements(corners))[..., BY_CORNER]


def resultants(xy: ArrayLike, xi: ArrayLike, eta: ArrayLike, A: ArrayLike) -> Floats:
    """Rows that give the membrane forces (Nx, Ny, Nxy) per length [N/m] at places of cells from the DOFs of the cells.

    Arguments as `interpolate`.

    Parameters
    ----------
    A : ArrayLike [3, 3] or [m, 3, 3]
        The membrane stiffness given to `stiffness` [N/m].

    Returns
    -------
    Floats
        [m, 3, 12]; positive Nx is tension. The bubble's share is included.
    """
    corners, rigidity = cells(xy), symmetric_rigidity("A", A)
    there = strains_at(corners, xi, eta)
    bubble = elimination(strains(corners).energy(rigidity))
    forces: Floats = rigidity @ (there[..., :N_DOFS] - there[..., N_DOFS:] @ bubble)
    return forces[..., BY_CORNER]


@dataclass(frozen=True)
class Strains:
    """Rows of the strains (u_x, v_y, u_y + v_x) of cells at `integration_points`.

    rows [n, g, 3, 14] : from all u, all v, all RZ and, last, the two displacements of the bubble.
    areas [n, g] : area of each point [m^2]; they sum to the area of the cell.

    Who couples other strains to these has rows at the same points, adds up the energy of all and then eliminates the
    bubble (`elimination`).
    """

    rows: Floats
    areas: Floats

    def energy(self, rigidity: Floats) -> Floats:
        """Twice the strain energy for a rigidity [3, 3] or [n, 3, 3]: [n, 14, 14], the bubble last."""
        return strain_energy(self.rows, rigidity, self.rows, self.areas)


def strain_energy(left: Floats, rigidity: Floats, right: Floats, areas: Floats) -> Floats:
    """Integrals of left' rigidity right: rows [n, g, r, k], [r, s] or [n, r, s], [n, g, s, l], [n, g] -> [n, k, l]."""
    n, g, r, k = left.shape
    forces = (rigidity[:, None] if rigidity.ndim == 3 else rigidity) @ right
    forces *= areas[:, :, None, None]
    product: Floats = left.reshape(n, g * r, k).swapaxes(1, 2) @ forces.reshape(n, g * r, -1)
    return product


def elimination(matrices: Floats) -> Floats:
    """Rows that give minus the two last unknowns from the others, where nothing acts on them: [n, k, k] -> [n, 2, k-2].

    >>> elimination(np.array([[[3.0, 1.0, 2.0], [1.0, 2.0, 0.0], [2.0, 0.0, 4.0]]]))
    array([[[0.5],
            [0.5]]])
    """
    inner, outer = matrices[:, -2:, -2:], matrices[:, -2:, :-2]
    determinant = inner[:, 0, 0] * inner[:, 1, 1] - inner[:, 0, 1] * inner[:, 1, 0]
    adjugate = np.stack([inner[:, 1, 1], -inner[:, 0, 1], -inner[:, 1, 0], inner[:, 0, 0]], axis=1).reshape(-1, 2, 2)
    product: Floats = (adjugate / determinant[:, None, None]) @ outer
    return product


def condense(matrices: Floats) -> Floats:
    """Matrices without their two last unknowns, which are eliminated: [n, k, k] -> [n, k-2, k-2]."""
    product: Floats = matrices[:, :-2, :-2] - matrices[:, :-2, -2:] @ elimination(matrices)
    return product


def condensed_share(whole: Floats, share: Floats) -> Floats:
    """A part of the energy of matrices whose two last unknowns follow the others as `condense` has it of the whole:
    [n, k, k] twice -> [n, k-2, k-2]. The parts of a sum add up to `condense` of it."""
    inner = elimination(whole)
    mixed = share[:, :-2, -2:] @ inner
    product: Floats = share[:, :-2, :-2] - mixed - mixed.swapaxes(1, 2)
    product += inner.swapaxes(1, 2) @ (share[:, -2:, -2:] @ inner)
    return product


@cache
def integration_points() -> tuple[Floats, Floats, Floats]:
    """xi, eta and weights [13] of the points at which the strain energy is taken; the weights sum to 1."""
    few, many = square_points(2), square_points(3)
    xi, eta = (np.concatenate([few[k], many[k]]) for k in (0, 1))
    return xi, eta, np.concatenate([FEW_POINTS * few[2], (1.0 - FEW_POINTS) * many[2]])


@cache
def _slopes_at_points() -> Floats:
    return slopes(*integration_points()[:2])


def strains(corners: Floats) -> Strains:
    """Rows of strains at the points of integration of cells with `corners` [n, 4, 2].

    The bubble's strains have no mean over these points, whatever the shape of the cell: it passes patch tests as it is.

    >>> of = strains(rectangle([2.0, 1.0], 1.0))
    >>> of.rows.shape, of.areas.sum(axis=1)
    ((2, 13, 3, 14), array([2., 1.]))
    """
    xi, eta, weights = integration_points()
    by_x, by_y, areas = gradients(corners, xi, eta, _slopes_at_points()[:, None])
    areas *= weights
    return Strains(_strain_rows(by_x, by_y, side_displacements(corners)), areas)


def strains_at(corners: Floats, xi: ArrayLike, eta: ArrayLike) -> Floats:
    """Rows of strains at one place xi, eta [m] in each of the cells [m, 4, 2], as `strains` has them: [m, 3, 14]."""
    along, across = (np.asarray(place, dtype=np.float64)[:, None] for place in (xi, eta))
    by_x, by_y, _ = gradients(corners, along, across, slopes(along, across))
    return _strain_rows(by_x, by_y, side_displacements(corners))[:, 0]


def drilling_stiffness(corners: Floats, modulus: ArrayLike) -> Floats:
    """modulus [n] or one [N/m] times the integral of (RZ - (v_x - u_y) / 2)^2, one point in the centre: [n, 12, 12].

    The DOFs are in the order of `Strains`.
    """
    middle = np.array([0.5])
    by_x, by_y, area = gradients(corners, middle, middle, slopes(middle, middle)[:, None])
    of_u, of_v = side_displacements(corners)
    row = np.empty((len(corners), 1, N_DOFS))
    row[..., _U], row[..., _V] = by_y[..., _CORNER] / 2.0, -by_x[..., _CORNER] / 2.0
    row[..., _RZ] = 0.25 - (by_x[..., _SIDE] @ of_v - by_y[..., _SIDE] @ of_u) / 2.0
    scale = np.asarray(modulus, dtype=np.float64) * area[:, 0]
    product: Floats = (scale[:, None, None] * row).swapaxes(1, 2) * row
    return product


def _stiffness(drilling: float, corners: Floats, A: Floats, share: Floats | None = None) -> Floats:
    energy = _energy(drilling, corners, A)
    own = condense(energy) if share is None else condensed_share(energy, _energy(drilling, corners, share))
    return by_corner(symmetric(own))


def _energy(drilling: float, corners: Floats, A: Floats) -> Floats:
    energy = strains(corners).energy(A)
    energy[:, :N_DOFS, :N_DOFS] += drilling_stiffness(corners, drilling * A[:, 2, 2])
    return energy


def _mass(corners: Floats, m0: Floats, m2: Floats) -> Floats:
    return by_corner(in_plane_inertia(value_products(corners), side_displacements(corners), m0, m2))


def by_corner(matrices: Floats) -> Floats:
    """Matrices [n, 12, 12] with u v RZ corner by corner, from those with all u, all v and all RZ in turn."""
    return matrices.reshape(-1, 3, 4, 3, 4).transpose(0, 2, 1, 4, 3).reshape(-1, N_DOFS, N_DOFS)


def _strain_rows(by_x: Floats, by_y: Floats, of_rotations: Floats) -> Floats:
    """[n, g, 3, 14] from gradients of the shape functions [n, g, 9] and side displacements [2, n, 4, 4]."""
    of_u, of_v = of_rotations
    rows = np.zeros((*by_x.shape[:2], 3, N_DOFS + 2))
    rows[:, :, 0, _U] = rows[:, :, 2, _V] = by_x[..., _CORNER]
    rows[:, :, 1, _V] = rows[:, :, 2, _U] = by_y[..., _CORNER]
    rows[:, :, 0, _RZ] = by_x[..., _SIDE] @ of_u
    rows[:, :, 1, _RZ] = by_y[..., _SIDE] @ of_v
    rows[:, :, 2, _RZ] = by_y[..., _SIDE] @ of_u + by_x[..., _SIDE] @ of_v
    rows[:, :, 0, -2] = rows[:, :, 2, -1] = by_x[..., -1]
    rows[:, :, 1, -1] = rows[:, :, 2, -2] = by_y[..., -1]
    return rows
