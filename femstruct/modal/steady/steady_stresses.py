"""The equivalent stress of von Mises under harmonic and random excitations, over all places of a part."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final, NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.elements.stresses import von_mises, von_mises_in_a_cycle
from femstruct.modal.basis import ModalBasis
from femstruct.modal.steady.excitation import Excitation
from femstruct.modal.superposition import Complex, amplitudes
from femstruct.model.probe import StressPlaces

AT_ONCE: Final = 2_000_000
"""Complex stresses that are evaluated at once, 32 MB: of all places at as many lines as that makes."""
_NOTHING: Final = 1e-14  # of the largest eigenvalue of a covariance: the others are its rounding

Amount = Callable[[Floats], Floats]
"""From the stresses [p, c, k] of places in the shapes of a basis to their equivalent stress [p]."""


class Stressed(NamedTuple):
    """largest [p] : of every place. along [nf] : over frequency. amount : how `largest` follows from shapes."""

    largest: Floats
    along: Floats
    amount: Amount


def harmonic_stress(
    basis: ModalBasis, excitation: Excitation, places: StressPlaces, amplitude: Floats, frequency_hz: Floats
) -> Stressed:
    """The equivalent stress under a harmonic excitation: the largest of a cycle.

    amplitude [nf] : of what excites. along : the largest of all places at each frequency.
    """
    omega = 2.0 * np.pi * frequency_hz
    rows = _with_base(basis, excitation, places)
    count, components, k = rows.shape
    flat = rows.reshape(-1, k)
    along, largest = np.empty(len(omega)), np.full(count, -1.0)
    highest, there = -1.0, np.zeros(k, dtype=np.complex128)
    step = max(1, AT_ONCE // max(1, len(flat)))
    for lines, q in _driven(basis, excitation, omega):
        scaled = q * amplitude[lines, None]
        for first in range(0, len(scaled), step):
            part = scaled[first : first + step]
            stress = (flat @ part.T).reshape(count, components, -1)
            cycle = von_mises_in_a_cycle(stress, places.components)
            along[lines[first : first + step]] = cycle.max(axis=0)
            largest = np.maximum(largest, cycle.max(axis=1))
            if cycle.max() > highest:
                highest = float(cycle.max())
                there = part[int(cycle.max(axis=0).argmax())]

    def amount(stresses: Floats) -> Floats:
        return von_mises_in_a_cycle((stresses @ there[:-1])[:, :, None], places.components)[:, 0]

    return Stressed(largest, along, amount)


def random_stress(
    basis: ModalBasis, excitation: Excitation, places: StressPlaces, psd: Floats, frequency_hz: Floats
) -> Stressed:
    """The equivalent stress under a random excitation: its root mean square.

    psd [nf] : of what excites. along : the power spectral density at the place of the largest rms.

    Notes
    -----
    The mean square of the stress of von Mises is the trace of A C, A its quadratic form and C the covariance of the
    stresses: D. J. Segalman, C. W. G. Fulcher, G. M. Reese, R. V. Field, An Efficient Method for Calculating RMS von
    Mises Stress in a Random Vibration Environment, SAND98-0260 (1998). C follows from the covariance of the modal
    coordinates, which is the same for all places.
    """
    omega = 2.0 * np.pi * frequency_hz
    weights = psd * _trapezoids(frequency_hz)
    k = len(basis.omega) + 1
    covariance = np.zeros((k, k))
    for lines, q in _driven(basis, excitation, omega):
        scaled = q * np.sqrt(weights[lines, None])
        covariance += scaled.real.T @ scaled.real + scaled.imag.T @ scaled.imag
    values, vectors = np.linalg.eigh(covariance)
    kept = values > _NOTHING * values.max(initial=0.0)
    columns = vectors[:, kept] * np.sqrt(values[kept])

    def amount(stresses: Floats) -> Floats:
        rms: Floats = np.sqrt((von_mises(stresses @ columns[: stresses.shape[2]], places.components) ** 2).sum(axis=-1))
        return rms

    rows = _with_base(basis, excitation, places)
    largest = amount(rows)
    worst = rows[[int(largest.argmax())]]
    along = np.empty(len(omega))
    for lines, q in _driven(basis, excitation, omega):
        stress = worst @ q.T
        squares = von_mises(stress.real, places.components) ** 2 + von_mises(stress.imag, places.components) ** 2
        along[lines] = squares[0] * psd[lines]
    return Stressed(largest, along, amount)


def stress_components(
    basis: ModalBasis, excitation: Excitation, places: StressPlaces, place: int, frequency_hz: Floats
) -> Complex:
    """Complex components [c, nf] of the stress at one place, per unit of what excites [Pa]."""
    rows = _with_base(basis, excitation, places)[place]
    found: Complex = np.empty((len(rows), len(frequency_hz)), dtype=np.complex128)
    for lines, q in _driven(basis, excitation, 2.0 * np.pi * frequency_hz):
        found[:, lines] = rows @ q.T
    return found


def stress_moments(
    basis: ModalBasis,
    excitation: Excitation,
    places: StressPlaces,
    psd: Floats,
    frequency_hz: Floats,
    powers: tuple[int, ...],
) -> Floats:
    """Spectral moments of the components of the stress at every place [m, p, c, c], of these powers of the frequency
    [Pa^2 Hz^power], in phase. psd [nf] : of what excites. They follow from those of the modal coordinates."""
    k, weights = len(basis.omega) + 1, psd * _trapezoids(frequency_hz)
    moments = np.zeros((len(powers), k, k))
    for lines, q in _driven(basis, excitation, 2.0 * np.pi * frequency_hz):
        for found, power in zip(moments, powers, strict=True):
            scaled = q * np.sqrt(weights[lines] * frequency_hz[lines] ** power)[:, None]
            found += scaled.real.T @ scaled.real + scaled.imag.T @ scaled.imag
    rows = _with_base(basis, excitation, places)
    return np.array([rows @ one @ np.swapaxes(rows, 1, 2) for one in moments])


def _with_base(basis: ModalBasis, excitation: Excitation, places: StressPlaces) -> Floats:
    """Stresses [p, c, k + 1] in the shapes of a basis, and those of bars that are carried along by a base that moves,
    per acceleration of it: zero without one, and for other parts, whose strains have it."""
    rows = places.of(basis.shapes)
    carried = np.zeros((*rows.shape[:2], 1))
    if excitation.axis is not None and places.carried is not None:
        carried[..., 0] = places.carried[..., excitation.axis]
    return np.concatenate([rows, carried], axis=2)


def _driven(basis: ModalBasis, excitation: Excitation, omega: Floats) -> Iterator[tuple[Integers, Complex]]:
    """Lines and modal coordinates there [lines, k + 1], the last one being what excites."""
    for lines, q in amplitudes(basis, excitation.pushed, omega):
        yield lines, np.asarray(np.concatenate([q, np.ones((len(q), 1))], axis=1), dtype=np.complex128)


def _trapezoids(frequency_hz: Floats) -> Floats:
    """Weights [nf] of the trapezoidal rule [Hz]."""
    steps = np.diff(frequency_hz)
    weights = np.zeros(len(frequency_hz))
    weights[:-1] += 0.5 * steps
    weights[1:] += 0.5 * steps
    return weights
