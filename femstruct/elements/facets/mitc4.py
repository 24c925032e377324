"""Transverse shear of flat quadrilaterals by Mindlin's theory, with the shear strains of MITC4.

The fibres across the plate lean by beta_x = RY and beta_y = -RX, bilinear in the cell as w is. Shear strains are (w_x +
beta_x, w_y + beta_y); that along each side is taken in its middle alone and carried linearly into the cell, which is
what keeps thin plates from locking.

Reference: K. J. Bathe, E. N. Dvorkin, Int. J. Numer. Methods Eng. 21 (1985) 367-383, doi:10.1002/nme.1620210213.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.elements.facets.motion import side_shears
from femstruct.elements.facets.quadrilateral import gradients

N_SHEAR: Final = 12


def shear_rows(corners: Floats, xi: Floats, eta: Floats) -> tuple[Floats, Floats]:
    """Rows of the shear strains from all w, all beta_x, all beta_y, and areas: [n, g, 2, 12] and [n, g].

    corners [n, 4, 2]; xi, eta : places as `femstruct.elements.facets.quadrilateral.gradients` takes them.
    """
    xi, eta = np.asarray(xi)[..., None], np.asarray(eta)[..., None]
    first, second, third, last = np.moveaxis(side_shears(corners), 1, 0)[:, :, None]
    along_xi = second * eta - last * (1.0 - eta)
    along_eta = first * (1.0 - xi) - third * xi
    rows = np.empty((*along_xi.shape[:2], 2, N_SHEAR))
    rows[:, :, 0], rows[:, :, 1], areas = gradients(corners, xi[..., 0], eta[..., 0], (along_xi, along_eta))
    return rows, areas
