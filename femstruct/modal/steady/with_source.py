"""Where a structure resonates with a measured source on it: between its own natural frequencies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.modal.basis import ModalBasis
from femstruct.modal.steady.installed import receiver_mobility
from femstruct.modal.steady.resonances import Resonances
from femstruct.modal.steady.source_mobility import SourceMobility
from femstruct.modal.superposition import Complex
from femstruct.model.probe import Probe

ROUNDS: Final = 12  # of false position: between two lines a susceptance is nearly straight
CLOSE: Final = 1e-4  # of a frequency: from where to where a slope is taken


def resonances_with(
    basis: ModalBasis, contacts: Sequence[Probe], source: SourceMobility, lines_hz: Floats
) -> Resonances:
    """Resonances of a structure and a source at all its contacts together, between lines that follow the structure's
    own. lines_hz [nf] : rising [Hz]. None for a source of forces, or one whose phase is not known.

    Notes
    -----
    Forces are largest where the mobilities of both cancel but for their losses. Susceptances of what is passive rise
    with frequency and fall only at their own resonances (R. M. Foster, Bell System Technical Journal 3 (1924) 259-267),
    so one of their sum that comes from below zero has such a frequency between two lines. Half of the half-power
    bandwidth is the conductance there over the slope of the susceptance.

    A mass of 3 kg on one of 1 kg whose spring is tuned to 10 Hz: 5 Hz, with half of its damping ratio.

    >>> from femstruct.modal.analytic import oscillator
    >>> from femstruct.modal.damping import Damping, Ratio, with_damping
    >>> from femstruct.modal.steady.source_mobility import RigidMass
    >>> bare, points = oscillator(1.0, frequency_hz=10.0)
    >>> basis, here = with_damping(bare, Damping(Ratio(0.001))), points["m"].probe("x")
    >>> found = resonances_with(basis, [here], RigidMass(3.0), np.arange(1.0, 20.0, 0.9))
    >>> found.hz.round(5), (found.half / found.hz).round(6)
    (array([5.]), array([0.0005]))
    """
    if not source.has_phase or not np.abs(source.impedance(lines_hz[:1])).any():
        return Resonances(np.zeros(0), np.zeros(0))

    def both(hz: Floats) -> Complex:
        """Mobilities of structure and source together [n, contact, contact]."""
        own = np.moveaxis(receiver_mobility(basis, contacts, hz), 2, 0)
        return np.asarray(own + np.eye(len(contacts)) / source.impedance(hz)[:, None, None], dtype=np.complex128)

    def rising(hz: Floats, which: np.ndarray) -> Floats:
        """The susceptance of this number at each frequency."""
        return np.asarray(np.take_along_axis(np.linalg.eigvalsh(both(hz).imag), which[:, None], axis=1)[:, 0])

    sizes = np.linalg.eigvalsh(both(lines_hz).imag)
    at, which = np.nonzero((sizes[:-1] < 0.0) & (sizes[1:] >= 0.0))
    low, high, below, above = lines_hz[at], lines_hz[at + 1], sizes[at, which], sizes[at + 1, which]
    if not len(at):
        return Resonances(low, low)
    hz, before = high.copy(), np.zeros(len(at))
    for _ in range(ROUNDS):
        hz = low - below * (high - low) / (above - below)
        size = rising(hz, which)
        side = np.sign(size)
        again = np.where(side == before, 0.5, 1.0)  # an end that stays twice counts half: the Illinois rule
        left = size < 0.0
        low, high = np.where(left, hz, low), np.where(left, high, hz)
        below, above = np.where(left, size, again * below), np.where(left, again * above, size)
        before = side
    step = np.minimum(CLOSE * hz, 0.5 * np.diff(lines_hz)[at])
    slope = (rising(hz + step, which) - rising(hz - step, which)) / (2.0 * step)
    there = both(hz)
    _, vectors = np.linalg.eigh(there.imag)
    vector = np.take_along_axis(vectors, which[:, None, None], axis=2)[:, :, 0]
    lost = np.einsum("ia,iab,ib->i", vector, there.real, vector)
    sharp = (slope > 0.0) & (lost > 0.0)
    return Resonances(hz[sharp], (lost / np.where(sharp, slope, 1.0))[sharp])
