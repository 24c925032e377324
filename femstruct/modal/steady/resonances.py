"""Where a structure resonates and how sharply, also where its damping couples modes."""

from __future__ import annotations

from threading import Lock
from typing import Final, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from femstruct.arrays import Floats
from femstruct.modal.basis import ModalBasis
from femstruct.modal.coupled_damping.eigenpairs import eigenvalues

BARE: Final = 1e-10  # of a frequency: a half-power bandwidth below it is rounding of an eigenvalue


class Resonances(NamedTuple):
    """hz [n] : natural frequencies [Hz]. half [n] : half of their half-power bandwidths, zeta f [Hz]; 0 undamped."""

    hz: Floats
    half: Floats

    def inside(self, low: float, high: float) -> Resonances:
        """Those in a band [Hz], without its ends."""
        kept = (self.hz > low) & (self.hz < high)
        return Resonances(self.hz[kept], self.half[kept])


_found: Final[WeakKeyDictionary[ModalBasis, Resonances]] = WeakKeyDictionary()  # each response of a study asks
_lock: Final = Lock()


def resonances(basis: ModalBasis) -> Resonances:
    """Resonances of a basis: its elastic modes, or where damping couples modes the motions that swing then.

    Notes
    -----
    A strong dashpot holds the place it acts on: the structure then resonates, with little damping, where none of the
    modes does that are free there, and what the diagonal of the damping says of these is the damping of no motion.

    A mass of 1 kg on a spring of 100 N/m to a plate of 1 kg that oil of 1000 N s/m holds resonates at 10 rad/s:

    >>> from dataclasses import replace
    >>> from femstruct.modal.analytic import given_modes
    >>> squares, shapes = np.linalg.eigh([[200.0, -100.0], [-100.0, 100.0]])
    >>> basis, _ = given_modes(np.sqrt(squares) / 2 / np.pi, [0.0, 0.0], {"plate": shapes[0], "mass": shapes[1]})
    >>> found = resonances(replace(basis, viscous=1000.0 * np.outer(shapes[0], shapes[0])))
    >>> (2 * np.pi * found.hz).round(3), (found.half / found.hz).round(4)
    (array([10.]), array([0.005]))
    """
    with _lock:
        if basis not in _found:
            _found[basis] = _of_coupled(basis) if _coupled(basis) else natural(basis)
        return _found[basis]


def natural(basis: ModalBasis) -> Resonances:
    """The elastic modes of a basis with what is their own of its damping, whatever couples them."""
    elastic = np.array([kind == "elastic" for kind in basis.kind], dtype=bool)
    return _told(basis.frequency_hz[elastic], (basis.damping_ratio * basis.frequency_hz)[elastic])


def _coupled(basis: ModalBasis) -> bool:
    damping = basis.time_damping
    return bool((damping - np.diag(np.diag(damping))).any())


def _of_coupled(basis: ModalBasis) -> Resonances:
    values = eigenvalues(basis.omega, basis.time_damping) / (2.0 * np.pi)
    swings = values[values.imag > 0.0]
    found, top = _told(np.abs(swings), -swings.real), float(natural(basis).hz.max(initial=0.0))
    true = (found.half > 0.0) | (found.hz <= top * (1.0 + BARE))  # an undamped residual vector is no resonance
    return Resonances(found.hz[true], found.half[true])


def _told(hz: Floats, half: Floats) -> Resonances:
    return Resonances(hz, np.where(half > BARE * hz, half, 0.0))
