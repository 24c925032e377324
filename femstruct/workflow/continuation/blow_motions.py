"""How a floor moves after one blow, as spectra of its modes: of a simulated blow, at its place or at others."""

from __future__ import annotations

from typing import Final

import numpy as np

from acoustics.arrays import Complexes
from femstruct.arrays import Floats, Integers
from femstruct.conventions import GRAVITY
from femstruct.impact.result.response import Response
from femstruct.modal.basis import ModalBasis
from femstruct.modal.coupled_damping.kept import oscillators_of
from femstruct.modal.coupled_damping.oscillator_set import Oscillators
from femstruct.study.acting import PlacedBody

BLOW_S: Final = 0.25  # after its start, within which a blow is over
STILL: Final = 1e-9  # of a blow's largest push, below which a body is free
DIAGONAL: Final = 1e-9  # of the largest damping: what couples modes less is rounding
_CHUNK: Final = 2**22  # complex numbers held at once: 64 MB


def blow_spectrum(response: Response, body: PlacedBody, s: Complexes, *, weighs: bool) -> Complexes:
    """Spectrum [nf] [N s] of the force of a body's first blow, from its start on, at complex frequencies s [1/s].

    From the momentum of the body at the samples: exact for waves that are long beside the sampling, however short the
    blow. weighs : whether gravity acts on it.
    """
    history, sampling = response.bodies[body.name], response.clock.sampling
    start = next((blow.t for blow in response.blows if blow.body == body.name), 0.0)
    first = round(start * sampling)
    velocity = np.append(history.velocity, history.end_velocity)[first : first + round(BLOW_S * sampling) + 1].copy()
    towards = 1.0 if body.side in ("below", "before") else -1.0
    velocity[0] = towards * body.speed  # before it is given its start it is still
    pushes = body.mass * (np.diff(velocity) + (GRAVITY / sampling if weighs else 0.0))
    struck = np.flatnonzero(np.abs(pushes) > STILL * np.abs(pushes).max(initial=0.0))
    last = int(struck[-1]) + 1 if len(struck) else 0
    t = (np.arange(last) + 0.5) / sampling
    return np.asarray(np.exp(-np.outer(s, t)) @ pushes[:last])


def coupled(basis: ModalBasis, modes: Integers) -> Oscillators | None:
    """Oscillators of the whole basis [K] where damping couples any of these modes [k] to each other, else None.

    basis : damped.
    """
    damping = basis.time_damping
    among = damping[np.ix_(modes, modes)]
    own = np.diag(among)
    if np.abs(among - np.diag(own)).max(initial=0.0) <= DIAGONAL * np.abs(own).max(initial=0.0):
        return None
    return oscillators_of(basis)


def driven_rates(
    basis: ModalBasis, modes: Integers, found: Oscillators | None, rows: Floats, forces: Complexes, s: Complexes
) -> Complexes:
    """Spectra of the rates [n, k, nf] of some modes [k] by forces [n, nf] at places whose rows are [n, K], of all.

    basis : damped. found : what `coupled` found of these modes and those they move with. Modes it does not couple
    move by themselves.
    """
    if found is None:
        own, squared = np.diag(basis.time_damping)[modes], basis.omega[modes] ** 2
        driven = s * forces[:, None, :] * rows[:, modes, None]
        return np.asarray(driven / (s**2 + own[:, None] * s + squared[:, None]))
    kicks, drives = found.kicks @ rows.T, found.drives @ rows.T
    reads = np.hstack([found.places[modes], found.tilts[modes]])
    answer = np.empty((len(rows), len(modes), len(s)), dtype=np.complex128)
    step = max(1, _CHUNK // max(1, 2 * kicks.size))
    for start in range(0, len(s), step):
        lines = slice(start, start + step)
        answer[:, :, lines] = _of_oscillators(found, kicks, drives, reads, forces[:, lines], s[lines])
    return answer


def _of_oscillators(
    found: Oscillators, kicks: Floats, drives: Floats, reads: Floats, forces: Complexes, s: Complexes
) -> Complexes:
    """Rates [n, k, nf] of oscillators that forces [n, nf] kick and drive by [K, n], each; reads [k, 2 K] : of [z, v].

    s z = v + kick f and s v = -w^2 z - c v + drive f, for every oscillator by itself.
    """
    squared, damping = found.omega[:, None] ** 2, found.damping[:, None]
    motion = np.empty((2, *kicks.shape, len(s)), dtype=np.complex128)
    motion[0] = (s + damping)[:, None] * kicks[:, :, None] + drives[:, :, None]
    motion[1] = s * drives[:, :, None] - (squared * kicks)[:, :, None]
    motion *= (s / (s**2 + damping * s + squared))[:, None]
    motion *= forces
    parts = motion.reshape(reads.shape[1], -1).view(np.float64)  # real and imaginary side by side: a real product
    rates = (reads @ parts).view(np.complex128).reshape(len(reads), *forces.shape)
    return np.asarray(rates.transpose(1, 0, 2))


def simulated_rates(response: Response, modes: Integers, s: Complexes, start: float, lasts: float) -> Complexes:
    """Spectra of modal rates [k, nf] of a run, from a time on and for as long as it lasts [s], at complex frequencies
    s that are evenly spaced multiples of their spacing."""
    sampling, step_hz = response.clock.sampling, float((s[1] - s[0]).imag) / (2 * np.pi)
    first, count = round(start * sampling), round(lasts * sampling)
    rates = response.velocities(modes)[:, first : first + count]
    length = round(sampling / step_hz)
    rates = rates[:, :length] * np.exp(-float(s[0].real) / sampling * np.arange(rates[:, :length].shape[1]))
    lines = np.rint(s.imag / (2 * np.pi * step_hz)).astype(np.int64)
    return np.asarray(np.fft.rfft(rates, length, axis=1)[:, lines] / sampling)
