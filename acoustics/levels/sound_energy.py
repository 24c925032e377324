"""Energy that a moving surface sends into the open air during a record: as a level, by third octaves, its efficiency.

Sound energy is the time integral of the sound power over the record, its level L_J = 10 lg(J / 1 pJ): the names of
ISO 3741 and ISO 3744 for a single event, whose clause was not at hand.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import inf, isnan, log10, nan
from types import MappingProxyType
from typing import Annotated, Final

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Complexes, Floats, freeze, frozen
from acoustics.errors import Advice
from acoustics.levels.bands import band_edges, is_below, third_octave_bands
from acoustics.levels.weighting import FrequencyWeighting, frequency_weighting
from acoustics.open_air.power import plane_wave_power, radiated_power
from acoustics.open_air.rayleigh import POINTS_PER_WAVE
from acoustics.reported import Axis, Reported
from acoustics.rooms.box_pressure import fast_length
from acoustics.source import SurfaceVelocity
from acoustics.tags import stored_as

REFERENCE_J: Final = 1e-12
_DB: Final = "dB re 1 pJ"
_BAND: Final = Axis("band_hz", "Hz", "Nominal centre of the third octave")
LOWEST_HZ: Final = 10.0  # nominal centre of the first third octave
FADE_OUT_SHARE: Final = 0.1  # share of the record, its end, over which the motion is brought to rest
FEWEST_POINTS: Final = 3.0  # to a wave in air, below which the sums over the points mean nothing
SHARE_ALLOWED: Final = 0.01  # share of the energy from which on what is missing is told
_LEFT_OUT: Final = 1e-6  # share of the energy that lines beyond the last one may have
_FAINT: Final = 1e-3  # of the largest peak of the density, below which a peak is not told
_JUMP: Final = 0.01  # mean square of the velocity at the start over that of the record


@stored_as("sound energy/1")
@dataclass(frozen=True, eq=False)
class SoundEnergy:
    """What a baffled surface radiates to one side in a record.

    frequency_hz [nf], density [nf] : spectral density of the energy, of positive frequencies [J/Hz].
    plane [nf] : that of a plane wave of the same motion, rho c S times the density of <v^2>, where counted [J/Hz].
    bands_hz {nominal: exact} : third octaves, from 10 Hz, that are wider than a line.
    weighted_j : the energy, A-weighted [J]. last_tenth : what the last tenth of the record has of it [1].
    spacing_hz : frequency at which the points are six to a wave [Hz]. complete_below_hz : where the motion ends; bands
    that reach above it are nan.
    """

    frequency_hz: Annotated[Floats, Reported("Hz", "Frequency", along=("frequency_hz",))]
    density: Annotated[Floats, Reported("J/Hz", "Sound energy, of positive frequencies", along=("frequency_hz",))]
    plane: Annotated[Floats, Reported("J/Hz", "That of plane waves of the same motion", along=("frequency_hz",))]
    bands_hz: Mapping[float, float]
    weighted_j: Annotated[float, Reported("J", "Sound energy, A-weighted", "energy_a_j")]
    last_tenth: Annotated[float, Reported("1", "Share of it in the last tenth of the record", "last_tenth_share")]
    spacing_hz: float
    findings: tuple[Advice, ...] = ()
    complete_below_hz: float = inf

    def __post_init__(self) -> None:
        frequency_hz = frozen("energy.frequency_hz", self.frequency_hz, (None,))
        lines = (len(frequency_hz),)
        freeze(
            self,
            frequency_hz=frequency_hz,
            density=frozen("energy.density", self.density, lines),
            plane=frozen("energy.plane", self.plane, lines),
            bands_hz=MappingProxyType(dict(self.bands_hz)),
        )

    @property
    def energy_j(self) -> Annotated[float, Reported("J", "Sound energy")]:
        """All of it [J]."""
        return float(self.density.sum()) * self.step_hz

    @property
    def level_db(self) -> Annotated[float, Reported(_DB, "Sound energy level", "l_j_db")]:
        """L_J [dB re 1 pJ]; -inf in silence."""
        return level(self.energy_j)

    @property
    def weighted_db(self) -> Annotated[float, Reported(_DB, "Sound energy level, A-weighted", "l_ja_db")]:
        """L_JA, A-weighted [dB re 1 pJ]; -inf in silence."""
        return level(self.weighted_j)

    @property
    def efficiency(self) -> Annotated[float, Reported("1", "Radiation efficiency")]:
        """Radiated energy over that of plane waves of the same motion [1]; nan where nothing moves."""
        plane = float(self.plane.sum()) * self.step_hz
        return self.energy_j / plane if plane > 0 else nan

    @property
    def step_hz(self) -> float:
        """Distance of the lines [Hz]."""
        return float(self.frequency_hz[1] - self.frequency_hz[0])

    @property
    def bands_j(self) -> Annotated[dict[float, float], Reported("J", "Sound energy in the band", axis=_BAND)]:
        """Energy of the third octaves {nominal: [J]}."""
        energies = _by_band(self.density, self.step_hz, self.bands_hz)
        return {
            band: energy if is_below(self.bands_hz[band], self.complete_below_hz) else nan
            for band, energy in energies.items()
        }

    @property
    def bands_db(self) -> Annotated[dict[float, float], Reported(_DB, "Sound energy level of the band", axis=_BAND)]:
        """L_J of the third octaves {nominal: [dB re 1 pJ]}; -inf where there is nothing."""
        return {band: level(energy) for band, energy in self.bands_j.items()}

    @property
    def bands_efficiency(
        self,
    ) -> Annotated[dict[float, float], Reported("1", "Its radiation efficiency", axis=_BAND)]:
        """Radiation efficiency of the third octaves {nominal: [1]}; nan where nothing moves."""
        plane = _by_band(self.plane, self.step_hz, self.bands_hz)
        return {band: e / plane[band] if plane[band] > 0 else nan for band, e in self.bands_j.items()}

    def share_above(self, frequency_hz: float, weighting: FrequencyWeighting = "Z") -> float:
        """What of the energy, maybe weighted, lies above a frequency [1]; 0 in silence."""
        density = self.density * np.abs(frequency_weighting(self.frequency_hz, weighting)) ** 2
        energy = float(density.sum()) * self.step_hz
        below = _until(density, self.step_hz, np.array([frequency_hz]))[0]
        return max(0.0, 1.0 - float(below) / energy) if energy > 0 else 0.0

    def loudest_hz(self, count: int) -> list[float]:
        """Frequencies of the largest density [Hz], as `loudest`."""
        return loudest(self.frequency_hz, self.density, count)


def loudest(frequency_hz: Floats, density: Floats, count: int) -> list[float]:
    """Frequencies of the highest peaks [Hz], ascending: a third octave apart, no less than 1e-3 of the highest; of the
    largest value where there is no peak; none in silence.

    >>> loudest(np.array([10.0, 20, 30, 40, 50]), np.array([0, 3.0, 1, 2, 0]), 2)
    [20.0, 40.0]
    """
    inner = (density[1:-1] >= density[:-2]) & (density[1:-1] > density[2:])
    heights = np.where(np.r_[False, inner, False], density, 0.0)
    if not heights.any():
        return [float(frequency_hz[density.argmax()])] if density.max() > 0 else []
    found: list[float] = []
    for line in np.argsort(-heights).tolist():
        f = float(frequency_hz[line])
        if len(found) == count or not heights[line] > _FAINT * heights.max():
            break
        if all(abs(log10(f / other)) >= 0.1 for other in found):
            found.append(f)
    return sorted(found)


def bring_to_rest(rates: Floats) -> Floats:
    """Velocities [k, nt] brought smoothly to rest over the last tenth of the record."""
    tail = max(2, round(FADE_OUT_SHARE * rates.shape[1]))
    faded = rates.copy()
    faded[:, -tail:] *= 0.5 * (1 + np.cos(np.pi * np.arange(1, tail + 1) / tail))
    return faded


def level(energy_j: float) -> float:
    """Sound energy level [dB re 1 pJ]; -inf of none, nan of what is not known.

    >>> round(level(2e-9), 2)
    33.01
    """
    return energy_j if isnan(energy_j) else 10 * log10(energy_j / REFERENCE_J) if energy_j > 0 else -np.inf


def radiated_energy(surface: SurfaceVelocity, air: Air) -> SoundEnergy:
    """Energy that a baffled surface radiates to one side while it moves as recorded.

    Its findings name a record that ends too early, points too far apart, and a motion that starts with a jump.

    Notes
    -----
    J = 4 int_0^inf W(V(f)) df, V the Fourier transform of the velocity and W the mean power of a harmonic motion with
    these peak values: two for positive and negative frequencies, two for peak and mean square. The motion is brought to
    rest over the last tenth of the record, then there is silence as long as sound takes across the surface, so that
    nothing wraps round. Lines beyond which there is less than 1e-6 of the energy are left out, and those at which the
    points are fewer than three to a wave. The last tenth is heard through a Hann window over the last fifth.

    A piston of 1 cm^2 that is pushed and stops, beside rho S^2 / (2 pi c) int a^2 dt of a small one:

    >>> t = np.arange(4800) / 48e3
    >>> speed = np.where(t < 0.05, np.sin(np.pi * t / 0.05) ** 4, 0.0)
    >>> piston = SurfaceVelocity(np.zeros((1, 3)), [1e-4], [[1]], [speed], dt=1 / 48e3)
    >>> small = 1.21 * 1e-8 / (2 * np.pi * 343) * (np.gradient(speed, t) ** 2).sum() / 48e3
    >>> print(f"{radiated_energy(piston, Air()).energy_j / small:.4f}")
    1.0000
    """
    nt, dt = surface.rates.shape[1], surface.dt
    apart = float(np.sqrt(surface.weights.max()))
    top = air.c / (FEWEST_POINTS * apart)
    frequency, density, plane, beyond = _densities(surface, bring_to_rest(surface.rates), air, top)
    energy = float(density.sum()) * float(frequency[1])
    # A Hann window has the energy of 3/8 of its length: that of the last fifth stands for .75 of a tenth.
    end = np.hanning(max(2, round(2 * FADE_OUT_SHARE * nt)) + 2)[1:-1]
    last, its_density, _, _ = _densities(surface, surface.rates[:, -len(end) :] * end, air, top)
    late = float(its_density.sum()) * float(last[1]) * FADE_OUT_SHARE * nt / (0.375 * len(end))
    weights = np.abs(frequency_weighting(frequency, "A")) ** 2
    bands = third_octave_bands(1 / dt, LOWEST_HZ)
    result = SoundEnergy(
        frequency_hz=frequency,
        density=density,
        plane=plane,
        bands_hz={
            nominal: exact
            for nominal, exact in bands.items()
            if np.subtract(*band_edges(exact)[::-1]) > frequency[1] and band_edges(exact)[1] <= top
        },
        weighted_j=float(weights @ density) * float(frequency[1]),
        last_tenth=late / energy if energy > 0 else 0.0,
        spacing_hz=air.c / (POINTS_PER_WAVE * apart),
    )
    return replace(result, findings=(*_short(result), *_coarse(result, apart, air, beyond), *_jump(surface)))


def truncate_energy(energy: SoundEnergy, complete_below_hz: float) -> SoundEnergy:
    """What of the energy lies below a frequency [Hz], above which the motion is not known."""
    below = energy.frequency_hz <= complete_below_hz
    density = np.where(below, energy.density, 0.0)
    weights = np.abs(frequency_weighting(energy.frequency_hz, "A")) ** 2
    return replace(
        energy,
        density=density,
        plane=np.where(below, energy.plane, 0.0),
        weighted_j=float(weights @ density) * energy.step_hz,
        complete_below_hz=complete_below_hz,
    )


def _densities(
    surface: SurfaceVelocity, rates: Floats, air: Air, top_hz: float
) -> tuple[Floats, Floats, Floats, float]:
    """Frequencies [nf], densities of the energy and of plane waves [J/Hz] of a motion that starts and ends at rest; and
    what energy [J] the lines above `top_hz` would have at most."""
    across = float(np.linalg.norm(np.ptp(surface.points, axis=0))) / air.c
    length = fast_length(rates.shape[1] + int(np.ceil(across / surface.dt)) + 1)
    frequency = np.asarray(np.fft.rfftfreq(length, surface.dt), dtype=np.float64)
    velocity: Complexes = surface.dt * np.fft.rfft(rates, length, axis=1)
    plane = 4 * plane_wave_power(surface.weights, surface.shapes, velocity, air)
    area = surface.area
    most = plane * np.minimum(1.0, (2 * np.pi * frequency / air.c) ** 2 * area / (2 * np.pi))
    left = np.cumsum(most[::-1])[::-1]
    needed = int(np.count_nonzero(left > _LEFT_OUT * left[0]))
    last = max(2, min(needed, int(np.searchsorted(frequency, top_hz))))
    plane[0] /= 2  # 0 Hz has no negative twin
    plane[last:] = 0.0
    density = np.zeros_like(plane)
    if left[0] > 0:
        density[1:last] = 4 * radiated_power(
            surface.points, surface.weights, surface.shapes, velocity[:, 1:last], frequency[1:last], air
        )
    beyond = float(left[last]) * float(frequency[1]) if last < min(needed, len(left)) else 0.0
    return frequency, density, plane, beyond


def _until(density: Floats, step_hz: float, frequency_hz: Floats) -> Floats:
    """Energy below frequencies [J], every line spread over its own width."""
    edges = step_hz * (np.arange(len(density) + 1) - 0.5)
    below: Floats = np.interp(frequency_hz, edges, np.r_[0.0, np.cumsum(density) * step_hz])
    return below


def _by_band(density: Floats, step_hz: float, bands_hz: Mapping[float, float]) -> dict[float, float]:
    edges = np.array([band_edges(exact) for exact in bands_hz.values()]).reshape(-1, 2)
    parts = np.diff(_until(density, step_hz, edges), axis=1)[:, 0]
    return dict(zip(bands_hz, parts.tolist(), strict=True))


def _short(result: SoundEnergy) -> tuple[Advice, ...]:
    if result.last_tenth <= SHARE_ALLOWED:
        return ()
    return (
        Advice(
            "sound-energy-not-decayed",
            f"the last tenth of the record has {100 * result.last_tenth:.2g} % of the sound energy; "
            f"{100 * SHARE_ALLOWED:g} % is allowed. Sound that is radiated after the end is missing: simulate longer",
            {"last_tenth": result.last_tenth, "allowed": SHARE_ALLOWED},
        ),
    )


def _coarse(result: SoundEnergy, apart: float, air: Air, beyond_j: float) -> tuple[Advice, ...]:
    whole = result.energy_j + beyond_j
    share = (result.share_above(result.spacing_hz) * result.energy_j + beyond_j) / whole if whole > 0 else 0.0
    if share <= SHARE_ALLOWED:
        return ()
    return (
        Advice(
            "sound-energy-points-coarse",
            f"{100 * share:.2g} % of the sound energy lies above {result.spacing_hz:.4g} Hz, where the points of the "
            f"surface, {apart:.3g} m apart, are fewer than {POINTS_PER_WAVE:g} a wavelength in air. Above "
            f"{air.c / (FEWEST_POINTS * apart):.4g} Hz it is not counted: use a finer mesh",
            {"share": share, "spacing_hz": result.spacing_hz, "allowed": SHARE_ALLOWED},
        ),
    )


def _jump(surface: SurfaceVelocity) -> tuple[Advice, ...]:
    both = surface.shapes.T @ (surface.weights[:, None] * surface.shapes)
    mean = float((both * (surface.rates @ surface.rates.T)).sum()) / surface.rates.shape[1]
    start = float(surface.rates[:, 0] @ both @ surface.rates[:, 0])
    if not (mean > 0 and start > _JUMP * mean):
        return ()
    share = start / mean
    return (
        Advice(
            "sound-energy-starts-moving",
            f"the surface moves when the record starts, with {share:.2g} of the mean square of its velocity: the jump "
            "radiates a click whose energy grows with the sampling",
            {"start_over_mean_square": share, "allowed": _JUMP},
        ),
    )
