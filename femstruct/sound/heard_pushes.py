"""What is heard of forces without the motion between: transfers from what pushes the modes to the listeners of a room.

A thousand impacts on one structure differ in their forces alone. The room's answer to each mode and each mode's answer
to a force are the same in all of them; their sum over the modes is made once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acoustics.arrays import Complexes
from acoustics.fields.returned import KeptTransfer
from acoustics.rooms.continuation import transform_axis
from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError
from femstruct.modal.basis import ModalBasis


@dataclass(frozen=True, eq=False)
class PushTransfer:
    """Pressures at receivers of a room from forces on a structure, in a record of nt samples dt [s] apart.

    per_push [receivers, r, nf] : pressure over the moments of each force, on the first lines of the record's transform;
    weight [length] : of that transform.
    """

    nt: int
    dt: float
    per_push: Complexes
    weight: Floats

    def pressures(self, moments: Floats) -> Floats:
        """Pressures [runs, receivers, nt] of forces with these moments [runs, r, cells + 2] in cells of dt."""
        length, nf = len(self.weight), self.per_push.shape[2]
        weighted = moments[:, :, : self.nt] * self.weight[: self.nt]
        spectra = np.fft.rfft(weighted, length, axis=2)[:, :, :nf]
        heard = np.einsum("xrf,crf->cxf", self.per_push, spectra)
        found: Floats = np.fft.irfft(heard, length, axis=2)[:, :, : self.nt] / self.weight[: self.nt]
        return found


def push_transfer(
    basis: ModalBasis, shares: Floats, kept: KeptTransfer, moving: Integers, nt: int, dt: float
) -> PushTransfer:
    """The transfer of forces that act on the modes with shares [r, k].

    basis : with damping that couples no modes. kept : of the room, for the modes `moving` of the basis, in a record of
    nt samples dt apart.

    Raises InputError for modes that damping couples.

    Notes
    -----
    On the lines s of the record's transform, weighted with exp(-a t) so that nothing wraps around, a force of transform
    F has the rates q'_k = s phi_k F / (s^2 + c_k s + omega_k^2), each of which is heard as `kept` knows. Moments m_j,
    integrals of the force times hats of width dt around t_j, have the transform sum m_j exp(-s t_j) = F (2 sinh(s dt /
    2) / (s dt))^2 and what lies beyond half the sampling, which is folded back with that square: 1e-3 of a force at a
    seventh of the sampling as large there as beyond.
    """
    damping = basis.time_damping
    if np.any(damping - np.diag(np.diag(damping))):
        raise InputError("damping", got="modes that it couples", expected="each mode by itself")
    whole = kept.per_rate
    s, weight = transform_axis(nt, dt)
    s = s[: whole.shape[2]]
    omega, losses = basis.omega[moving], np.diag(damping)[moving]
    hat = (2.0 * np.sinh(0.5 * s * dt) / (s * dt)) ** 2
    rate = s / (s**2 + losses[:, None] * s + (omega**2)[:, None])
    per_push = np.einsum("xkf,rk,kf->xrf", whole, shares[:, moving], rate, optimize=True) / (hat * dt)
    return PushTransfer(nt, dt, np.asarray(per_push, dtype=np.complex128), weight)
