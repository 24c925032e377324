"""How a floor moves after one blow, as spectra of its modes: of a simulated blow, at its place or at others."""

from __future__ import annotations

from typing import Final

import numpy as np

from acoustics.arrays import Complexes
from femstruct.arrays import Floats, Integers
from femstruct.conventions import GRAVITY
from femstruct.impact.result.response import Response
from femstruct.modal.basis import ModalBasis
from femstruct.study.acting import PlacedBody

BLOW_S: Final = 0.25  # after its start, within which a blow is over
STILL: Final = 1e-9  # of a blow's largest push, below which a body is free
DIAGONAL: Final = 1e-9  # of the largest damping: what couples modes less is rounding


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


def driven_rates(basis: ModalBasis, modes: Integers, rows: Floats, forces: Complexes, s: Complexes) -> Complexes:
    """Spectra of modal rates [n, k, nf] of forces [n, nf] at places whose rows are [n, k], of some modes [k].

    basis : damped.
    """
    damping, squared = basis.time_damping[np.ix_(modes, modes)], basis.omega[modes] ** 2
    driven = s * forces[:, None, :] * rows[:, :, None]
    own = np.diag(damping)
    if np.abs(damping - np.diag(own)).max(initial=0.0) <= DIAGONAL * np.abs(own).max(initial=0.0):
        return np.asarray(driven / (s**2 + own[:, None] * s + squared[:, None]))
    every = s[:, None, None] ** 2 * np.eye(len(modes)) + s[:, None, None] * damping + np.diag(squared)
    return np.asarray(np.linalg.solve(every, driven.transpose(2, 1, 0)).transpose(2, 1, 0))


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
