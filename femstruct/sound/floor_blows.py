"""One blow on a floor: its force on an infinite plate, and how the modes of a floor move after it, as spectra."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from math import sqrt
from typing import Final

import numpy as np

from acoustics.arrays import Complexes
from acoustics.levels.bands import nominal_bands
from acoustics.levels.statistical import InfinitePlate, band_exposures
from femstruct.arrays import Floats, Integers
from femstruct.conventions import GRAVITY
from femstruct.impact.response import Response
from femstruct.impact.scene import Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.law import Law
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import oscillator
from femstruct.modal.damping import Damping, FromMaterials, LossFactor, Ratio, Rayleigh
from femstruct.modal.oscillators import Oscillators, oscillators_of
from femstruct.model.lay_ups import PlateSection
from femstruct.model.materials import loss_at

# ----------------------------------------------------------------------------------------------------------------------
# The infinite plate of a section, and what it loses along frequency.
# ----------------------------------------------------------------------------------------------------------------------


def infinite_plate(section: PlateSection) -> InfinitePlate:
    """The infinite plate of a section; its bending about the neutral surface."""
    D = section.bending
    rigidity = (float(D[0, 0]), float(D[1, 1]), float(D[0, 1]), float(D[2, 2]))
    shear = (float(section.As[0, 0]), float(section.As[1, 1]))
    return InfinitePlate(section.m0, rigidity, shear, section.m2 - section.m1**2 / section.m0)


def loss_law(damping: Damping, section: PlateSection) -> Callable[[Floats], Floats]:
    """Loss factor [nf] of frequencies [nf] [Hz] by the general law of a structure's damping; what single modes have
    instead counts for these alone."""

    def of(frequency_hz: Floats) -> Floats:
        omega, base = 2 * np.pi * frequency_hz, damping.base
        match base:
            case Ratio(value):
                return np.full(len(omega), 2.0 * value)
            case LossFactor(value):
                return np.full(len(omega), value)
            case Rayleigh(alpha, beta):
                return np.asarray(alpha / omega + beta * omega)
            case FromMaterials():
                return loss_at(section.loss_factor, frequency_hz)

    return of


# ----------------------------------------------------------------------------------------------------------------------
# The force of one blow on an infinite plate: the source's own mass and law before the plate's resistance.
# ----------------------------------------------------------------------------------------------------------------------

SAMPLES: Final = 4000  # of a blow
FIRST_S: Final = 5e-3  # how long it is looked at first, ...
LONGER: Final = 4.0  # ... and how many times longer as long as the contact is closed
LONGEST_S: Final = 2.0
GONE: Final = 1e-6  # of the peak: less of a force that dies away and never ends, as of a stiff hammer, is over
NO_MASS_S: Final = 1e-7  # mass of what is struck over its resistance: gone before any blow has begun


def blow_exposures(
    blows: Iterable[tuple[float, float, Law]], plate: InfinitePlate, bands_hz: Sequence[float]
) -> dict[float, float]:
    """Force exposures {nominal third octave [Hz]: [N^2 s]} of one blow on an infinite plate, the mean over several.

    Parameters
    ----------
    blows : Iterable[tuple[float, float, Law]]
        Of bodies: mass [kg], speed [m/s], law of the contact.

    Notes
    -----
    The plate resists with 1 / Re Y at the middle of the bands: exact for a thin isotropic plate, for others close
    enough, since a blow is decided by its own mass and spring on all floors that are much heavier.
    """
    resistance = 1.0 / float(plate.mobility(np.array([sqrt(bands_hz[0] * bands_hz[-1])]))[0])
    every = nominal_bands(3)
    centres = {band: every[band] for band in bands_hz}
    alike: dict[tuple[float, float, Law], int] = {}
    for one in blows:
        alike[one] = alike.get(one, 0) + 1
    found: list[Mapping[float, float]] = []
    for mass, speed, law in alike:
        found.append(band_exposures(*blow(mass, speed, law, resistance), centres))
    counts = np.array(list(alike.values()))
    return {band: float(np.average([one[band] for one in found], weights=counts)) for band in bands_hz}


def blow(mass: float, speed: float, law: Law, resistance: float) -> tuple[Floats, float]:
    """Force [nt] [N] and its step [s] of a mass [kg] with a speed [m/s] on a resistance [N s/m].

    A hammer on a spring and a rigid floor hands over 2 m v:

    >>> from femstruct.laws.linear import Linear
    >>> force, dt = blow(0.5, 0.886, Linear(1e6), 1e9)
    >>> round(float(force.sum() * dt), 4)
    0.886
    """
    duration = FIRST_S
    while True:
        history = impact_on_resistance(mass, speed, law, resistance, duration).contacts["blow"]
        if history.force[-1] <= GONE * history.peak_force or duration >= LONGEST_S:
            return np.array([*history.force, 0.0]), duration / SAMPLES
        duration *= LONGER


def impact_on_resistance(mass: float, speed: float, law: Law, resistance: float, duration: float) -> Response:
    """The contact "blow" of a "body" of a mass [kg] with a speed [m/s] on a resistance [N s/m]; duration [s]."""
    basis, points = oscillator(resistance * NO_MASS_S, stiffness=0.0, axis="z")
    rate = np.array([[1.0 / NO_MASS_S]])
    basis = replace(basis, viscous=rate, dashpots=rate)
    contact = Contact("blow", "body", points["m"].probe("z"), law)
    return simulate(basis, Scene((Body("body", mass, -speed),), (contact,)), Clock(duration, SAMPLES / duration))


# ----------------------------------------------------------------------------------------------------------------------
# How a floor moves after one blow, as spectra of its modes: of a simulated blow, at its place or at others.
# ----------------------------------------------------------------------------------------------------------------------

BLOW_S: Final = 0.25  # after its start, within which a blow is over
STILL: Final = 1e-9  # of a blow's largest push, below which a body is free
DIAGONAL: Final = 1e-9  # of the largest damping: what couples modes less is rounding
_CHUNK: Final = 2**22  # complex numbers held at once: 64 MB


def blow_spectrum(response: Response, body: Body, s: Complexes, *, weighs: bool) -> Complexes:
    """Spectrum [nf] [N s] of the force of a body's first blow, from its start on, at complex frequencies s [1/s].

    From the momentum of the body at the samples: exact for waves that are long beside the sampling, however short the
    blow.

    Parameters
    ----------
    weighs : bool
        Whether gravity acts on it.
    """
    history, sampling = response.bodies[body.name], response.clock.sampling
    start = next((blow.t for blow in response.blows if blow.body == body.name), 0.0)
    first = round(start * sampling)
    velocity = np.append(history.velocity, history.end_velocity)[first : first + round(BLOW_S * sampling) + 1].copy()
    velocity[0] = body.velocity  # before it is given its start it is still
    pushes = body.mass * (np.diff(velocity) + (GRAVITY / sampling if weighs else 0.0))
    loaded = np.flatnonzero(np.abs(pushes) > STILL * np.abs(pushes).max(initial=0.0))
    last = int(loaded[-1]) + 1 if len(loaded) else 0
    t = (np.arange(last) + 0.5) / sampling
    return np.asarray(np.exp(-np.outer(s, t)) @ pushes[:last])


def coupled_oscillators(basis: ModalBasis, modes: Integers) -> Oscillators | None:
    """Oscillators of the whole basis [K] where damping couples any of these modes [k] to each other, else None.

    Parameters
    ----------
    basis : ModalBasis
        Damped.
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

    Parameters
    ----------
    basis : ModalBasis
        Damped.
    found : Oscillators | None
        What `coupled_oscillators` found of these modes and those they move with. Modes it does not couple move by
        themselves.
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
    """Rates [n, k, nf] of oscillators that forces [n, nf] kick and drive by [K, n], each.

    s z = v + kick f and s v = -w^2 z - c v + drive f, for every oscillator by itself.

    Parameters
    ----------
    reads : Floats [k, 2 K]
        Of [z, v].
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
