"""What the matrices of all straight members share: checked arrays of properties, and where their DOFs stand."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats
from femstruct.elements.polynomials import positive
from femstruct.errors import InputError


def property_arrays(**values: ArrayLike) -> list[Floats]:
    """Positive properties as arrays of one length; InputError names the one that is not."""
    return list(np.broadcast_arrays(*(np.atleast_1d(positive(name, value)) for name, value in values.items())))


def densities(rho: ArrayLike, like: Floats) -> Floats:
    """Densities [n] [kg/m^3], zero allowed; InputError for others."""
    density: Floats = np.broadcast_to(np.asarray(rho, dtype=np.float64), like.shape)
    if not (np.isfinite(density) & (density >= 0)).all():
        raise InputError("rho", got=str(density.min()), expected="finite values, zero or above")
    return density


def block(dofs: list[int]) -> tuple[slice, list[list[int]], list[int]]:
    """Index of the rows and columns of some DOFs in matrices [n, nd, nd]."""
    return slice(None), [[dof] for dof in dofs], dofs


def outer(scale: Floats) -> Floats:
    """Products [n, k, k] of the factors [n, k] of each element."""
    return scale[:, :, None] * scale[:, None, :]
