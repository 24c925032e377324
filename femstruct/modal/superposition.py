"""Harmonic motion as a sum of modes: modal coordinates along frequency, and what is read off them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError
from femstruct.modal.basis import ForceRow, ModalBasis
from femstruct.modal.coupled_damping.along_frequency import CoupledModes

Complex = NDArray[np.complex128]
Rows = tuple[Complex, Complex, Complex]
"""What is read off modal coordinates at omega: (rows[0] + omega rows[1] + omega^2 rows[2]) . q, each [k]."""
Tell = Callable[[int], None]
_CHUNK: Final = 2**22  # complex numbers held at once: 64 MB


def amplitudes(basis: ModalBasis, pushed: Floats, omega: Floats) -> Iterator[tuple[Integers, Complex]]:
    """Modal coordinates under harmonic modal forces [k]: numbers of some lines and theirs [lines, k], as many at once
    as memory allows, until all have been.

    Raises InputError for a line at the natural frequency of a mode without damping, where they are infinite.
    """
    squared, k = basis.omega**2, len(basis.omega)
    if any(np.any(A - np.diag(np.diag(A))) for A in (basis.viscous, basis.hysteretic)):
        yield from CoupledModes(squared, basis.viscous, basis.hysteretic).along(pushed, omega)
        return
    step = max(1, _CHUNK // max(1, k))
    for start in range(0, len(omega), step):
        lines = np.arange(start, min(start + step, len(omega)))
        w = omega[lines, None]
        losses = w * np.diag(basis.viscous) + np.diag(basis.hysteretic)
        dynamic = squared - w**2 + 1j * losses
        met = np.argwhere((dynamic == 0.0) & (pushed != 0.0))
        if len(met):
            got = f"{omega[lines[met[0, 0]]] / (2.0 * np.pi):g} Hz, a natural frequency without damping"
            do = "give the model a 'damping', or take lines beside it"
            raise InputError("frf frequency", got=got, expected="a finite response", do=do)
        yield lines, np.divide(pushed, dynamic, out=np.zeros_like(dynamic), where=dynamic != 0.0)


def superposed(basis: ModalBasis, pushed: Floats, rows: Rows, omega: Floats, tell: Tell = lambda done: None) -> Complex:
    """What `rows` read of the motion under harmonic modal forces [k], at each omega [nf].

    tell : is given the number of lines that are done.
    """
    answer: Complex = np.empty(len(omega), dtype=np.complex128)
    done = 0
    for lines, q in amplitudes(basis, pushed, omega):
        answer[lines] = read(rows, q, omega[lines])
        done += len(lines)
        tell(done)
    return answer


def read(rows: Rows, q: Complex, omega: Floats) -> Complex:
    """What `rows` read of modal coordinates [lines, k] at omega [lines]."""
    w = omega[:, None]
    found: Complex = ((rows[0] + w * rows[1] + w**2 * rows[2]) * q).sum(axis=1)
    return found


def of_force(basis: ModalBasis, row: ForceRow) -> Rows:
    """Rows of a force of the structure: losses of its parts act as + j hysteretic, those of dashpots with omega.

    >>> from femstruct.modal.analytic import oscillator
    >>> basis, _ = oscillator(4.0, stiffness=100.0)
    >>> of_force(basis, basis.outputs["ground.x"])[0].real
    array([50.])
    """
    structural = np.divide(row.hysteretic, basis.omega, out=np.zeros_like(basis.omega), where=basis.omega > 0)
    return (
        np.asarray(row.stiffness + 1j * row.hysteretic, dtype=np.complex128),
        np.asarray(1j * (row.damping - structural), dtype=np.complex128),
        np.asarray(-row.inertia, dtype=np.complex128),
    )


def of_motion(row: Floats) -> Rows:
    """Rows of a displacement, from its values in the shapes [k]."""
    still = np.zeros_like(row, dtype=np.complex128)
    return row.astype(np.complex128), still, still
