"""Modes of a basis whose damping couples them: what rings, how fast and how long."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.modal.basis import ModalBasis
from femstruct.modal.coupled_damping.kept import oscillators_of


class DampedModes(NamedTuple):
    """Modes that swing: |eigenvalue| / 2 pi [m] [Hz], damping ratios [m], below 1, and effective masses [3, m] [kg]
    along x, y, z, as far as places move in step."""

    frequency_hz: Floats
    damping_ratio: Floats
    modal_mass: Floats


def damped_modes(basis: ModalBasis) -> DampedModes | None:
    """The modes of structure, air and wool together that swing, ascending, up to where no mode is missing; None where
    damping couples no modes.

    Wool couples modes so strongly that the diagonal of the damping matrix is not the damping of any motion: a ceiling
    over wool rings with some per cent where its diagonal is above 100 %. What creeps back without swinging is left out.

    >>> from femstruct.modal.analytic import given_modes
    >>> basis, _ = given_modes([20.0, 50.0], [0.02, 0.03], {"P": [0.5, -0.4]})
    >>> damped_modes(basis) is None
    True
    """
    found = oscillators_of(basis)
    if found is None:
        return None
    swings = (found.damping < 2.0 * found.omega) & (found.omega <= 2.0 * np.pi * basis.complete_below_hz)
    numbers = np.flatnonzero(swings)
    numbers = numbers[np.argsort(found.omega[numbers], kind="stable")]
    omega = found.omega[numbers]
    taken = (basis.momentum @ found.places)[:, numbers] * (found.drives @ basis.momentum.T).T[:, numbers]
    return DampedModes(omega / (2.0 * np.pi), found.damping[numbers] / (2.0 * omega), taken)
