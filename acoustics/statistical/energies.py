"""Levels that a force on a plate makes in a room with a diffuse field: energies of plate and room, third by third."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import log, log10, pi
from typing import Final

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Floats, frozen, positive
from acoustics.errors import AcousticsError
from acoustics.levels.bands import Fraction, band_edges, octave_bands, third_octave_bands
from acoustics.levels.decibels import decibels
from acoustics.losses import Losses, t60_of
from acoustics.statistical.diffuse_radiation import diffuse_radiation
from acoustics.statistical.infinite_plate import InfinitePlate

P0_SQUARED: Final = (20e-6) ** 2  # Pa^2
FAST_RATE: Final = 8.0  # 1/s: the meter's 125 ms
FILTER_RATE: Final = 0.765 * pi  # of the bandwidth: energy of an order-4 Butterworth band pass after a click
_MOST_HZ: Final = 1e6
_APART: Final = 1e-4  # relative distance of rates that the sum of exponentials needs
_BESIDE: Final = 0.3  # decades to each side of a band that its filter is looked at, where it has fallen by 60 dB
_LINES: Final = 161
_TIMES: Final = 2000  # of a level's history


@dataclass(frozen=True, eq=False)
class DiffuseRoom:
    """A room with a diffuse sound field: volume [m^3], surface of its walls [m^2], losses, air.

    Raises AcousticsError: numbers that are not positive, a room without losses.

    >>> from acoustics.losses import losses_from_t60
    >>> room = DiffuseRoom(50.0, 85.0, losses_from_t60(0.5))
    >>> room.absorption(np.array([100.0, 1000.0])).round(2).tolist(), room.away_from_walls(np.array([100.0])).round(3)
    ([16.11, 16.11], array([0.578]))
    """

    volume: float
    surface: float
    losses: Losses
    air: Air = field(default_factory=Air)

    def __post_init__(self) -> None:
        positive("room.volume", self.volume, "m^3")
        positive("room.surface", self.surface, "m^2")
        if self.losses.kind == "none":
            raise AcousticsError("room.losses", got="none", expected="a reverberation time")

    def decay(self, frequency_hz: Floats) -> Floats:
        """Rate of the decay of its energy [nf] [1/s], 6 ln(10) / T60."""
        return 6 * log(10) / np.array([t60_of(self.losses, f) for f in frequency_hz.tolist()])

    def absorption(self, frequency_hz: Floats) -> Floats:
        """Equivalent absorption area [nf] [m^2], 24 ln(10) V / (c T60)."""
        return 4 * self.volume * self.decay(frequency_hz) / self.air.c

    def away_from_walls(self, frequency_hz: Floats) -> Floats:
        """Mean square of the pressure away from the walls over its mean over the room [nf]: 1 / (1 + S c / (8 V f)),
        since sound is louder by up to 9 dB at walls and corners (R. V. Waterhouse, J. Acoust. Soc. Am. 27, 247 (1955)).
        """
        return np.asarray(1 / (1 + self.surface * self.air.c / (8 * self.volume * frequency_hz)))


@dataclass(frozen=True, eq=False)
class RadiatingPlate:
    """A plate that is struck and radiates into a room.

    plate : its waves. area : of the whole plate [m^2]. sides : of the rectangle of it that radiates into the room,
    along the plate's x and y [m]. loss_factor : of frequencies [nf] [Hz] -> [nf] [1], without what the plate radiates.
    patch_m : radius of the disc over which blows are spread [m].

    Raises AcousticsError: lengths that are not positive, a rectangle larger than the plate.

    A concrete slab with losses of its own of 2 %, and with what it radiates, rho c sigma / (w m):

    >>> from acoustics.statistical.infinite_plate import isotropic_plate
    >>> slab = isotropic_plate(30e9, 0.2, 2400.0, 0.14)
    >>> floor = RadiatingPlate(slab, 12.0, (4.0, 3.0), lambda f: np.full(len(f), 0.02))
    >>> sigma, loss = floor.losses(np.array([500.0]), Air(343.0, 1.21))
    >>> loss.round(4).tolist(), (0.02 + 1.21 * 343.0 * sigma / (2 * pi * 500.0 * 336.0)).round(4).tolist()
    ([0.0205], [0.0205])
    """

    plate: InfinitePlate
    area: float
    sides: tuple[float, float]
    loss_factor: Callable[[Floats], Floats]
    patch_m: float = 0.0

    def __post_init__(self) -> None:
        radiating = positive("plate.sides", self.sides[0], "m") * positive("plate.sides", self.sides[1], "m")
        if radiating > positive("plate.area", self.area, "m^2") * (1 + 1e-6):
            got, expected = f"{radiating:g} m^2 that radiate", f"no more than the plate has, {self.area:g} m^2"
            raise AcousticsError("plate.sides", got=got, expected=expected)

    def losses(self, frequency_hz: Floats, air: Air) -> tuple[Floats, Floats]:
        """(radiation efficiency, total loss factor) [nf]: its own and what it radiates, rho c sigma / (w m)."""
        own = frozen("loss factor", self.loss_factor(frequency_hz), (len(frequency_hz),))
        sigma = diffuse_radiation(self.plate.waves(frequency_hz), frequency_hz, self.sides, air)
        share = self.sides[0] * self.sides[1] / self.area
        return sigma, own + share * air.rho * air.c * sigma / (2 * pi * frequency_hz * self.plate.mass)

    def power_per_force(self, frequency_hz: Floats, air: Air) -> tuple[Floats, Floats]:
        """(sound power over mean-square force [nf] [W/N^2], decay of the plate's energy [nf] [1/s]).

        W = rho c sigma S v^2, v^2 = F^2 Re Y s / (w eta m S_plate): s is the share of the kinetic energy of motion
        across, which falls below 1 where short waves turn the sections of a thick plate.
        """
        waves = self.plate.waves(frequency_hz, self.patch_m)
        driven = (waves.mobility * waves.across).mean(axis=1)
        sigma, loss = self.losses(frequency_hz, air)
        decay = 2 * pi * frequency_hz * loss
        if not (decay > 0).all():
            raise AcousticsError("plate.loss_factor", got="0", expected="losses: without them levels grow for ever")
        area = self.sides[0] * self.sides[1]
        return air.rho * air.c * sigma * area * driven / (decay * self.plate.mass * self.area), decay


def steady_levels(plate: RadiatingPlate, room: DiffuseRoom, force_squared: Mapping[float, float]) -> dict[float, float]:
    """Levels L_i {nominal third octave [Hz]: [dB]} of mean-square forces in the same bands {..: [N^2]}.

    force_squared : of a force that acts on the plate, as of a tapping machine whose blows are uncorrelated,
        `blow_forces`, or a measured blocked force.

    Raises AcousticsError: bands that are no third octaves, a plate without losses.

    LAB of our studies, a tapping machine of 0.866 N s a blow on 140 mm of concrete:

    >>> from acoustics.losses import losses_from_t60
    >>> from acoustics.statistical.infinite_plate import isotropic_plate
    >>> slab = isotropic_plate(30e9, 0.2, 2400.0, 0.14)
    >>> floor = RadiatingPlate(slab, 12.0, (4.0, 3.0), lambda f: np.full(len(f), 0.02))
    >>> room = DiffuseRoom(52.0, 86.8, losses_from_t60(1.2))
    >>> force = {250.0: 2 * 10.0 * 0.866**2 * 57.7}
    >>> round(steady_levels(floor, room, force)[250.0], 1)
    77.6
    """
    f = _centres(force_squared, 3)
    power, _ = plate.power_per_force(f, room.air)
    square = power * np.array(list(force_squared.values())) * 4 * room.air.rho * room.air.c / room.absorption(f)
    return _in_decibels(force_squared, square * room.away_from_walls(f))


def largest_levels(
    plate: RadiatingPlate, room: DiffuseRoom, exposure: Mapping[float, float], fraction: Fraction = 3
) -> dict[float, float]:
    """Largest Fast levels L_i,Fmax {nominal band [Hz]: [dB]} of a blow of force exposures {..: [N^2 s]}.

    exposure : int 2 |F|^2 df over each third octave, `band_exposures`. fraction : 3, or 1 for levels of the octaves
        whose three thirds are all given.

    Notes
    -----
    The blow gives its energy to the plate at once; from there it goes through the room, the meter's Fast average and
    the band filter, each with a rate of its own: a sum of four exponentials, of which the largest value is taken.
    The idea is that of transient statistical energies (C. Robinson, C. Hopkins, Acta Acust. 100, 1046 (2014)).
    """
    f = _centres(exposure, 3)
    power, decay = plate.power_per_force(f, room.air)
    # of the energy E that the blow leaves, W = decay E / ... : the power per mean-square force is per its rate of decay
    first = power * decay * np.array(list(exposure.values())) * room.air.rho * room.air.c**2 / room.volume
    first *= room.away_from_walls(f)
    thirds = list(exposure)
    octaves = {one: [other for other in thirds if _within(other, one)] for one in octave_bands(_MOST_HZ)}
    bands = {one: [one] for one in thirds} if fraction == 3 else {o: t for o, t in octaves.items() if len(t) == 3}
    found = []
    for band, members in bands.items():
        low, high = band_edges(_exact(band, fraction), fraction)
        at = [thirds.index(one) for one in members]
        rates = [np.array([decay[i], room.decay(f[i : i + 1])[0], FAST_RATE, FILTER_RATE * (high - low)]) for i in at]
        found.append(_largest(first[at], rates))
    return _in_decibels(bands, np.array(found))


def band_exposures(force: Floats, dt: float, bands_hz: Mapping[float, float]) -> dict[float, float]:
    """Force exposure int 2 |F|^2 df {nominal third octave [Hz]: [N^2 s]} of a force [nt] [N] that begins and ends at 0.

    bands_hz : {nominal: exact centre} [Hz]. Bands have the gain of the filters, order-4 Butterworth, which let through
    2.6 % more of a flat spectrum than the band is wide, and of a steep one what lies beside it.

    A blow of 1 N s that is short beside all periods, 1.026 x 2 B:

    >>> blow = np.array([0.0, 1e5, 0.0])
    >>> round(band_exposures(blow, 1e-5, {100.0: 100.0})[100.0], 2)
    47.36
    """
    force = frozen("force", force, (None,))
    acts = np.flatnonzero(force)  # most of a record is without contact
    t, force = positive("dt", dt, "s") * acts, force[acts]
    found = {}
    for nominal, centre in bands_hz.items():
        low, high = band_edges(centre)
        lines = centre * 10 ** np.linspace(-_BESIDE, _BESIDE, _LINES)
        spectrum = dt * np.exp(-2j * pi * np.outer(lines, t)) @ force
        gain = 1 / (1 + ((lines**2 - low * high) / (lines * (high - low))) ** 8)
        found[nominal] = float(np.trapezoid(2 * np.abs(spectrum) ** 2 * gain, lines))
    return found


def _largest(first: Floats, rates: list[Floats]) -> float:
    """Largest value over time of several energies that each go through four stages one after the other."""
    slowest = min(float(one.min()) for one in rates)
    t = np.linspace(0.0, 6.0 / slowest, _TIMES)
    total = np.zeros(_TIMES)
    for energy, own in zip(first.tolist(), rates, strict=True):
        a = own * (1 + _APART * np.arange(4))  # equal rates have another form, which this is close to
        others = a[None, :] - a[:, None]
        np.fill_diagonal(others, 1.0)
        total += energy * own[2] * own[3] * (np.exp(-np.outer(t, a)) @ (1 / others.prod(axis=1)))
    return float(total.max())


def _within(third_hz: float, octave_hz: float) -> bool:
    """Whether a third octave is one of the three of an octave, by nominal centres."""
    return abs(round(10 * log10(third_hz / 1000)) - round(10 * log10(octave_hz / 1000))) <= 1


def _exact(nominal_hz: float, fraction: Fraction) -> float:
    centres = octave_bands(_MOST_HZ) if fraction == 1 else third_octave_bands(_MOST_HZ)
    if nominal_hz not in centres:
        raise AcousticsError("bands", got=f"{nominal_hz:g} Hz", expected="nominal centres of third octaves")
    return centres[nominal_hz]


def _centres(bands: Mapping[float, float], fraction: Fraction) -> Floats:
    return np.array([_exact(band, fraction) for band in bands])


def _in_decibels(bands: Mapping[float, object], squares: Floats) -> dict[float, float]:
    return dict(zip(bands, decibels(squares / P0_SQUARED).tolist(), strict=True))
