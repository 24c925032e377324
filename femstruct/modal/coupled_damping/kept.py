"""Oscillators of the last few bases that were asked for, by the value of their damping: making them takes a second."""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from threading import Lock
from typing import Final
from weakref import WeakKeyDictionary

import numpy as np

from femstruct.modal.basis import ModalBasis
from femstruct.modal.coupled_damping.oscillator_set import Oscillators
from femstruct.modal.coupled_damping.oscillators import oscillators

KEPT: Final = 4  # bases of a study that are worked on at a time; 600 modes take 35 MB
_found: OrderedDict[bytes, Oscillators] = OrderedDict()
_asked: WeakKeyDictionary[ModalBasis, bytes | None] = WeakKeyDictionary()
_lock: Final = Lock()


def oscillators_of(basis: ModalBasis) -> Oscillators | None:
    """The `oscillators` of a basis, or None where its damping couples no modes; the same value for the same numbers.

    >>> from femstruct.modal.analytic import given_modes
    >>> oscillators_of(given_modes([10.0, 20.0], [0.01, 0.02], {})[0]) is None
    True
    """
    with _lock:  # threads that ask for the same wait for it
        if basis not in _asked:
            _asked[basis] = _key(basis)
        key = _asked[basis]
        if key is None:
            return None
        if key not in _found:
            _found[key] = oscillators(basis.omega, basis.time_damping, _rests(basis))
            while len(_found) > KEPT:
                _found.popitem(last=False)
        _found.move_to_end(key)
        return _found[key]


def _key(basis: ModalBasis) -> bytes | None:
    """What oscillators depend on; None where no modes are coupled."""
    damping = basis.time_damping
    if not (damping - np.diag(np.diag(damping))).any():
        return None
    digest = hashlib.blake2b(np.ascontiguousarray(basis.omega).tobytes() + damping.tobytes())
    digest.update(bytes([_rests(basis)]))
    return digest.digest()


def _rests(basis: ModalBasis) -> bool:
    """Whether anything is read of where modes without stiffness are: nothing is of frames of wool, and of air that
    slides over it."""
    still = basis.omega == 0.0
    rows = [basis.momentum, *basis.volumes.values(), *(row.stiffness for row in basis.outputs.values())]
    return bool(basis.shapes[..., still].any() or any(row[..., still].any() for row in rows))
