"""Structure-borne sources in place: contact forces and the power they send into a structure, from what was measured of
the source alone (EN 15657: blocked force or free velocity, and mobility)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.modal.basis import ModalBasis
from femstruct.modal.frf import modal_amplitudes
from femstruct.modal.superposition import Complex
from femstruct.model.probe import Probe


class Contacts(NamedTuple):
    """Forces at contacts per blocked force of one of them, forces [n, n, nf] (at, of), and the power over the mean
    square of that blocked force, power [n, nf] [W/N^2].

    least, most [n, nf] : between which shares of this power the true one lies; 1 where the phase of the source's
    mobility is known.
    """

    forces: Complex
    power: Floats
    least: Floats
    most: Floats


def receiver_mobility(basis: ModalBasis, contacts: Sequence[Probe], frequency_hz: Floats) -> Complex:
    """Mobilities of a structure between contacts [n, n, nf] (at, of) [m/(N s)], by superposition of modes.

    basis : damped, with residual vectors for the contacts.

    >>> from femstruct.modal.analytic import oscillator
    >>> basis, points = oscillator(2.0, stiffness=0.0)  # a free mass: 1 / (j omega m)
    >>> abs(receiver_mobility(basis, [points["m"].probe("x")], np.array([100.0])) * 2 * np.pi * 100.0 * 2.0).round(9)
    array([[[1.]]])
    """
    rows = np.array([probe.of(basis.shapes) for probe in contacts])
    rate = 2j * np.pi * np.asarray(frequency_hz)
    columns = [rate * (rows @ modal_amplitudes(basis, probe, frequency_hz)) for probe in contacts]
    return np.asarray(np.stack(columns, axis=1), dtype=np.complex128)


def contact_forces(mobility: Complex, impedance: Complex, has_phase: bool = True) -> Contacts:
    """What reaches a structure of a source, per unit of the blocked force at each contact.

    mobility [n, n, nf] : of the structure [m/(N s)]. impedance [nf] : of the source at each contact [N s/m], 0 for a
    source of forces. has_phase : whether that is complex, or a magnitude only.

    Notes
    -----
    (Y_s + Y_r) F = Y_s F_b: with Z_s = 1 / Y_s, F = (1 + Z_s Y_r)^-1 F_b, all contacts together, and W = F^H Re(Y_r) F.
    At one contact that is F = F_b Y_s / (Y_s + Y_r), W = |v_free|^2 Re Y_r / |Y_s + Y_r|^2, v_free = Y_s F_b.

    Without phase, |Y_s + Y_r|^2 is taken as |Y_s|^2 + |Y_r|^2 at each contact by itself, as EN 15657 and EN 12354-5
    have it of magnitudes in bands; it lies between (|Y_s| - |Y_r|)^2, or (Re Y_r)^2 where that is more as both are
    passive, and (|Y_s| + |Y_r|)^2.

    A rigid mass m on a dashpot Z: 1 / (1 + j omega m / Z), the limit of a hammer that does not rebound:

    >>> found = contact_forces(np.full((1, 1, 1), 1 / 1620.0 + 0j), np.array([2j * np.pi * 500.0 * 0.5]))
    >>> bool(abs(found.forces[0, 0, 0] - 1 / (1 + 2j * np.pi * 500.0 * 0.5 / 1620.0)) < 1e-15)
    True
    """
    n, lines = len(mobility), mobility.shape[2]
    own = np.diagonal(mobility).T  # [n, nf]
    one = np.ones((n, lines))
    if has_phase:
        matrix = np.eye(n)[:, :, None] + impedance * mobility
        inverse = np.linalg.inv(np.moveaxis(matrix, 2, 0))
        forces: Complex = np.asarray(np.moveaxis(inverse, 0, 2), dtype=np.complex128)
        power = np.einsum("aif,abf,bif->if", forces.conj(), mobility.real, forces).real
        return Contacts(forces, np.asarray(power, dtype=np.float64), one, one)
    ratio = np.abs(impedance * own)  # |Y_r| / |Y_s|
    share = 1.0 / (1.0 + ratio**2)
    forces = np.zeros(mobility.shape, dtype=np.complex128)
    forces[range(n), range(n)] = np.sqrt(share)
    closest = np.maximum((1.0 - ratio) ** 2, (np.abs(impedance) * own.real) ** 2)
    return Contacts(forces, share * own.real, 1.0 / (1.0 + ratio) ** 2 / share, 1.0 / closest / share)


def band_integrals(values: Floats, frequency_hz: Floats, edges: Floats) -> Floats:
    """Integrals over bands [.., n] of values [.., nf] along lines [nf] [Hz], all of whose edges [n, 2] are lines.

    >>> band_integrals(np.ones(5), np.linspace(1.0, 5.0, 5), np.array([[2.0, 4.0]])).tolist()
    [2.0]
    """
    steps = 0.5 * (values[..., 1:] + values[..., :-1]) * np.diff(frequency_hz)
    total = np.concatenate([np.zeros((*values.shape[:-1], 1)), np.cumsum(steps, axis=-1)], axis=-1)
    low, high = np.searchsorted(frequency_hz, edges.T * (1.0 - 1e-12))
    found: Floats = total[..., high] - total[..., low]
    return found
