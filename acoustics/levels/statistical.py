"""Levels that a force on a plate makes in a room with a diffuse field: energies of plate and room, third by third."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import ceil, hypot, inf, isfinite, log, log10, pi
from types import MappingProxyType
from typing import Annotated, Final

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Complexes, Floats, freeze, frozen, positive
from acoustics.errors import AcousticsError
from acoustics.levels.bands import Fraction, band_edges, decibels, nominal_bands
from acoustics.losses import Losses, t60_of
from acoustics.reported import Axis, Reported
from acoustics.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Waves and point mobility of infinite plates: thin or with shear, isotropic, layered or orthotropic.
# ----------------------------------------------------------------------------------------------------------------------

ANGLES: Final = 48  # in a quarter turn: mobilities of cross-laminated timber are right to 1e-9 with half of them
_SERIES: Final = 1e-3  # argument of J1 below which its series is taken


@dataclass(frozen=True, eq=False)
class Waves:
    """Bending waves of a plate at frequencies [nf] along directions [na] of a quarter turn, evenly spaced.

    angle [na] : from the plate's x [rad]. wavenumber [nf, na] [1/m]. mobility [nf, na] : what the waves of each
    direction add to the real part of the point mobility [s/kg]; the mean over the angles is that. across [nf, na] :
    share of the kinetic energy that is in the motion across the plate, the rest is in the rotation of its sections.
    """

    angle: Floats
    wavenumber: Floats
    mobility: Floats
    across: Floats


@dataclass(frozen=True, eq=False)
class InfinitePlate:
    """An infinite plate, whose waves are those of a finite one above its first few modes.

    mass : per area [kg/m^2]. rigidity : bending rigidities Dx, Dy, D12, D66 about its neutral surface [N m]. shear :
    transverse shear stiffnesses Sx, Sy [N/m], infinite for a thin plate. rotary : mass moment of its sections per area
    [kg], 0 for a thin plate.

    Raises AcousticsError: numbers that are not positive, D12 that makes bending unstable.

    Notes
    -----
    Of a thick plate the lowest branch is taken, that of bending; above the cut-off frequency of thickness shear there
    are others.

    A concrete slab of 140 mm, thin and with shear, at 1 kHz [s/kg]; a harder push on the thick one:

    >>> thin, thick = isotropic_plate(30e9, 0.2, 2400.0, 0.14, thin=True), isotropic_plate(30e9, 0.2, 2400.0, 0.14)
    >>> y = [float(plate.mobility(np.array([1000.0]))[0]) for plate in (thin, thick)]
    >>> f"{y[0]:.4e}", f"{10 * np.log10(y[1] / y[0]):.2f} dB"
    ('2.5510e-06', '0.88 dB')
    """

    mass: float
    rigidity: tuple[float, float, float, float]
    shear: tuple[float, float] = (inf, inf)
    rotary: float = 0.0

    def __post_init__(self) -> None:
        positive("plate.mass", self.mass, "kg/m^2")
        dx, dy, d12, d66 = self.rigidity
        for name, value in (("Dx", dx), ("Dy", dy), ("D66", d66)):
            positive(f"plate.{name}", value, "N m")
        if not d12**2 < dx * dy:
            raise AcousticsError("plate.D12", got=f"{d12:g} N m", expected=f"less than {(dx * dy) ** 0.5:g} N m")
        if not all(one > 0 for one in self.shear):
            raise AcousticsError("plate.shear", got=f"{self.shear} N/m", expected="positive stiffnesses")
        if not (isfinite(self.rotary) and self.rotary >= 0):
            raise AcousticsError("plate.rotary", got=f"{self.rotary:g} kg", expected="0 or more")

    @property
    def thin(self) -> InfinitePlate:
        """The same without shear and rotary inertia."""
        return InfinitePlate(self.mass, self.rigidity)

    def waves(self, frequency_hz: Floats, patch_m: float = 0.0) -> Waves:
        """Its bending waves at frequencies [nf] [Hz], and what a force drives of them.

        Parameters
        ----------
        patch_m : float
            Radius of a disc over which the force is spread evenly [m]; 0 for a point.
        """
        frequency = frozen("frequency", frequency_hz, (None,))
        angle: Floats = np.asarray((np.arange(ANGLES) + 0.5) * (pi / 2 / ANGLES), dtype=np.float64)
        squared: Floats = np.asarray((2 * pi * frequency[:, None]) ** 2, dtype=np.float64)
        x, slope, inertia = (
            _with_shear(self, angle, squared) if all(map(isfinite, self.shear)) else _thin(self, angle, squared)
        )
        k = np.sqrt(x)
        # Y = j w / 4 pi^2 int int x / (K - w^2 M) k dk da: the real part is that of the poles, pi / 2 dK/dx of each
        mobility = np.sqrt(squared) / (4.0 * slope) * _spread(k * patch_m) ** 2
        return Waves(angle, k, mobility, self.mass / inertia)

    def mobility(self, frequency_hz: Floats, patch_m: float = 0.0) -> Floats:
        """Real part of the mobility of a force on the infinite plate [nf] [s/kg]: the power it takes over F^2.

        Notes
        -----
        Thin plates have 1/(8 sqrt(m D)); orthotropic thin plates Y_g (2/pi) K((1 - h)/2), Y_g = 1/(8 sqrt(m sqrt(Dx
        Dy))), h = (D12 + 2 D66)/sqrt(Dx Dy). The imaginary part of a plate with shear is infinite under a point, its
        real part is not.
        """
        return np.asarray(self.waves(frequency_hz, patch_m).mobility.mean(axis=1))

    def modes_per_hz(self, frequency_hz: Floats, area: float) -> Floats:
        """Modes per hertz [nf] of a plate of an area [m^2]: S/2 sqrt(m/D) of a thin isotropic one.

        The mean of the squared shape of a mode is the share of the mass that moves across, over the mass of the plate.
        """
        waves = self.waves(frequency_hz)
        return np.asarray(4.0 * self.mass * area * (waves.mobility / waves.across).mean(axis=1))


def isotropic_plate(E: float, nu: float, rho: float, thickness: float, *, thin: bool = False) -> InfinitePlate:
    """An infinite plate of one isotropic material: Young's modulus [Pa], Poisson's ratio, density [kg/m^3], thickness
    [m]; with shear and rotary inertia (R. D. Mindlin, J. Appl. Mech. 18, 31 (1951), with 5/6 for his pi^2/12) or thin.

    >>> isotropic_plate(30e9, 0.2, 2400.0, 0.15, thin=True).mass
    360.0
    """
    d = E * thickness**3 / 12.0 / (1.0 - nu**2)
    g, m = 5.0 / 6.0 * E * thickness / (2.0 * (1.0 + nu)), rho * thickness
    rigidity = (d, d, nu * d, (1.0 - nu) / 2.0 * d)
    return InfinitePlate(m, rigidity) if thin else InfinitePlate(m, rigidity, (g, g), m * thickness**2 / 12.0)


def _thin(plate: InfinitePlate, angle: Floats, squared: Floats) -> tuple[Floats, Floats, Floats]:
    """k^2, the slope of K - w^2 M along it, and the inertia of waves [nf, na] of unit motion across the plate."""
    dx, dy, d12, d66 = plate.rigidity
    c, s = np.cos(angle) ** 2, np.sin(angle) ** 2
    d = dx * c**2 + 2.0 * (d12 + 2.0 * d66) * c * s + dy * s**2
    x = np.sqrt(plate.mass * squared / d)
    return x, 2.0 * d * x, np.full(x.shape, plate.mass)


def _with_shear(plate: InfinitePlate, angle: Floats, squared: Floats) -> tuple[Floats, Floats, Floats]:
    """The same of a plate whose sections turn by themselves.

    With motion w exp(-j k.x) and rotations j psi, condensed: P(x) = N(x) (x s0 - w^2 m) - x Q(x), N the determinant of
    the rotations' stiffness, x = k^2. Its largest real root is the bending wave.
    """
    dx, dy, d12, d66 = plate.rigidity
    (sx, sy), (c, s) = plate.shear, (np.cos(angle), np.sin(angle))
    a, b, d = dx * c**2 + d66 * s**2, (d12 + d66) * c * s, dy * s**2 + d66 * c**2
    p, q = sx - plate.rotary * squared, sy - plate.rotary * squared  # [nf, 1]
    s0 = sx * c**2 + sy * s**2
    n = [a * d - b**2, a * q + d * p, p * q]  # of x^2, x, 1
    m = plate.mass * squared
    cross = [(sx * c) ** 2 * d - 2.0 * sx * sy * c * s * b + (sy * s) ** 2 * a, (sx * c) ** 2 * q + (sy * s) ** 2 * p]
    cubic = [s0 * n[0], s0 * n[1] - m * n[0] - cross[0], s0 * n[2] - m * n[1] - cross[1], -m * n[2]]
    x = _largest_root([np.broadcast_to(one, np.broadcast_shapes(s0.shape, m.shape)) for one in cubic])
    rotations = n[0] * x**2 + n[1] * x + n[2]
    slope = (3.0 * cubic[0] * x**2 + 2.0 * cubic[1] * x + cubic[2]) / rotations
    k = np.sqrt(x)
    # the rotations that go with unit motion across: (p + a x, b x; b x, q + d x) psi = -k (sx c, sy s)
    turned_x = -k * (sx * c * (q + d * x) - sy * s * b * x) / rotations
    turned_y = -k * (sy * s * (p + a * x) - sx * c * b * x) / rotations
    return x, slope, plate.mass + plate.rotary * (turned_x**2 + turned_y**2)


def _largest_root(cubic: list[Floats]) -> Floats:
    """Largest real root of cubics c0 x^3 + c1 x^2 + c2 x + c3, by the eigenvalues of their companions."""
    companion = np.zeros((*cubic[0].shape, 3, 3))
    scale = np.cbrt(np.abs(cubic[3] / cubic[0]))  # roots of the order of 1
    for column, power in enumerate((1, 2, 3)):
        companion[..., 0, column] = -cubic[column + 1] / cubic[0] / scale**power
    companion[..., 1, 0] = companion[..., 2, 1] = 1.0
    roots: Complexes = np.linalg.eigvals(companion).astype(np.complex128)
    real = np.where(np.abs(roots.imag) < 1e-6 * np.abs(roots), roots.real, -inf)
    return np.asarray(scale * real.max(axis=-1))


def _spread(argument: Floats) -> Floats:
    """Mean of a wave over a disc, 2 J1(k r)/(k r), at k r."""
    import scipy

    small = np.abs(argument) < _SERIES
    safe = np.where(small, 1.0, argument)
    return np.where(small, 1.0 - argument**2 / 8.0, 2.0 * scipy.special.j1(safe) / safe)


# ----------------------------------------------------------------------------------------------------------------------
# Radiation efficiency of a rectangle in a rigid baffle that carries a diffuse field of bending waves.
# ----------------------------------------------------------------------------------------------------------------------

_MORE: Final = 16  # nodes of a Gauss rule beyond half a node for each radian
_DIRECTIONS: Final = (16, 0.35)  # of waves in a quarter turn: at least, and for each radian over the diagonal


def diffuse_radiation(waves: Waves, frequency_hz: Floats, sides: tuple[float, float], air: Air) -> Floats:
    """Radiation efficiency [nf] of bending waves of all directions on a rectangle, smooth through coincidence.

    Parameters
    ----------
    waves : Waves
        At the frequencies [nf] [Hz]; each direction has the share of the motion that its mobility has.
    sides : tuple[float, float]
        Of the rectangle, along the plate's x and y [m].

    Notes
    -----
    The sound power of a motion with the correlation C(u, v) between places u, v apart, over that of a plane wave:

        sigma = 2 k / (pi a b) int_0^a int_0^b (a - u)(b - v) C(u, v) sin(k r) / r du dv,  r^2 = u^2 + v^2,

    C the mean of cos(k_x u) cos(k_y v) over the directions, J0(k_B r) of an isotropic plate. Edges move as the middle
    does: the field is that of an infinite plate. sigma tends to 1/sqrt(1 - f_c/f) far above the critical frequency.

    References
    ----------
    X. Yu, C. Hopkins, JASA Express Lett. 1, 062801 (2021), of isotropic plates: one integral over r.

    Examples
    --------
    A concrete slab of 5 x 4 m above and below its critical frequency of 98 Hz:

    >>> from acoustics.levels.statistical import isotropic_plate
    >>> f, slab = np.array([50.0, 160.0, 630.0]), isotropic_plate(30e9, 0.2, 2400.0, 0.18, thin=True)
    >>> diffuse_radiation(slab.waves(f), f, (5.0, 4.0), Air()).round(2).tolist()
    [0.33, 1.57, 1.09]
    """
    a, b = (positive("sides", side, "m") for side in sides)
    frequency = frozen("frequency", frequency_hz, (len(waves.wavenumber),))
    return np.array(
        [_efficiency(2 * pi * f / air.c, waves, number, a, b) for number, f in enumerate(frequency.tolist())]
    )


def _efficiency(k: float, waves: Waves, number: int, a: float, b: float) -> float:
    """At one frequency: a double Gauss rule, whose kernel is a product in every direction."""
    share = waves.mobility[number] / waves.mobility[number].sum()
    plate = waves.wavenumber[number]
    angle, plate, share = _finer(waves.angle, plate, share, float(plate.max()) * hypot(a, b))
    fastest = k + float(plate.max())
    (u, du), (v, dv) = (_gauss(side, fastest) for side in (a, b))
    correlation = (np.cos(np.outer(plate * np.cos(angle), u)) * share[:, None]).T @ np.cos(
        np.outer(plate * np.sin(angle), v)
    )
    r = np.hypot(u[:, None], v)
    return float(2 * k / (pi * a * b) * (du * (a - u)) @ (correlation * np.sin(k * r) / r) @ (dv * (b - v)))


def _finer(angle: Floats, plate: Floats, share: Floats, reach: float) -> tuple[Floats, Floats, Floats]:
    """More directions, where waves from neighbours would part before they have crossed the rectangle."""
    count = ceil(_DIRECTIONS[0] + _DIRECTIONS[1] * reach)
    if count <= len(angle):
        return angle, plate, share
    more: Floats = np.asarray((np.arange(count) + 0.5) * (pi / 2 / count), dtype=np.float64)
    # both are smooth, and even about the plate's axes
    known = np.concatenate([-angle[:2][::-1], angle, pi - angle[-2:][::-1]])
    found = [np.interp(more, known, np.concatenate([one[:2][::-1], one, one[-2:][::-1]])) for one in (plate, share)]
    return more, found[0], found[1] / found[1].sum()


def _gauss(side: float, fastest: float) -> tuple[Floats, Floats]:
    """Nodes and weights over a side for waves up to a wavenumber."""
    nodes, weights = np.polynomial.legendre.leggauss(ceil(0.5 * fastest * side) + _MORE)
    return side / 2 * (nodes + 1), side / 2 * weights


# ----------------------------------------------------------------------------------------------------------------------
# Levels that a force on a plate makes in a room with a diffuse field.
# ----------------------------------------------------------------------------------------------------------------------

P0_SQUARED: Final = (20e-6) ** 2  # Pa^2
FAST_RATE: Final = 8.0  # 1/s: the meter's 125 ms
FILTER_RATE: Final = 0.765 * pi  # of the bandwidth: energy of an order-4 Butterworth band pass after a click
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

    >>> from acoustics.levels.statistical import isotropic_plate
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

    Parameters
    ----------
    force_squared : Mapping[float, float]
        Of a force that acts on the plate, as of a tapping machine whose blows are uncorrelated, or a
        measured blocked force.

    Raises
    ------
    AcousticsError
        Bands that are no third octaves, a plate without losses.

    Examples
    --------
    LAB of our studies, a tapping machine of 0.866 N s a blow on 140 mm of concrete:

    >>> from acoustics.losses import losses_from_t60
    >>> from acoustics.levels.statistical import isotropic_plate
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

    Parameters
    ----------
    exposure : Mapping[float, float]
        Int 2 |F|^2 df over each third octave, `band_exposures`.
    fraction : Fraction
        3, or 1 for levels of the octaves whose three thirds are all given.

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
    octaves = {one: [other for other in thirds if _within(other, one)] for one in nominal_bands(1)}
    bands = {one: [one] for one in thirds} if fraction == 3 else {o: t for o, t in octaves.items() if len(t) == 3}
    found = []
    for band, members in bands.items():
        low, high = band_edges(_exact(band, fraction), fraction)
        at = [thirds.index(one) for one in members]
        rates = [np.array([decay[i], room.decay(f[i : i + 1])[0], FAST_RATE, FILTER_RATE * (high - low)]) for i in at]
        found.append(_largest(first[at], rates))
    return _in_decibels(bands, np.array(found))


def band_exposures(force: Floats, dt: float, bands_hz: Mapping[float, float]) -> dict[float, float]:
    """Force exposure int 2 |F|^2 df {nominal third octave [Hz]: [N^2 s]} of a force [nt] [N] that begins and ends at
    0.

    Parameters
    ----------
    bands_hz : Mapping[float, float]
        {nominal: exact centre} [Hz]. Bands have the gain of the filters, order-4 Butterworth, which let through 2.6 %
        more of a flat spectrum than the band is wide, and of a steep one what lies beside it.

    Examples
    --------
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
    centres = nominal_bands(fraction)
    if nominal_hz not in centres:
        raise AcousticsError("bands", got=f"{nominal_hz:g} Hz", expected="nominal centres of third octaves")
    return centres[nominal_hz]


def _centres(bands: Mapping[float, float], fraction: Fraction) -> Floats:
    return np.array([_exact(band, fraction) for band in bands])


def _in_decibels(bands: Mapping[float, object], squares: Floats) -> dict[float, float]:
    return dict(zip(bands, decibels(squares / P0_SQUARED).tolist(), strict=True))


# ----------------------------------------------------------------------------------------------------------------------
# Bands of a rated room from statistical energies: beside the bands of modes, and in place of those that are blank.
# ----------------------------------------------------------------------------------------------------------------------

_BAND: Final = Axis("band_hz", "Hz", "Nominal centre of the band")
_DB: Final = "dB re 20 µPa"
FEWEST: Final = 1.0  # modes in a band below which it is not stated: its level is that of a mode beside it, or of none
MANY: Final = 4.0  # modes in a band from which on its level is that of statistical energies, within their scatter
SYSTEMATIC_DB: Final = 1.0  # what the mean may always be: edges and corners are in no infinite plate
_OF_SHAPES: Final = 1.25  # relative variance of the squared shape sin^2 sin^2 of a mode at a random place
_OF_ROOM: Final = 0.238  # degrees of freedom of a microphone's mean square, of bandwidth times T60
_DB_PER: Final = 10 / np.log(10)  # of a level, of a small relative change of a mean square


@stored_as("statistical bands/1")
@dataclass(frozen=True, eq=False)
class StatisticalBands:
    """Levels in the room by statistical energies {nominal centre [Hz]: [dB]}, not standardised, and their worth.

    levels_db : with what the plate's shear adds. alike_db : of the same theory of plates as the modes', to hold beside
    them. modes : of the plate in each band, from `MANY` on levels of one floor follow the statistics. scatter_db : the
    standard deviation of one floor, averaged over its places, that is to be expected about them.
    """

    levels_db: Annotated[Mapping[float, float], Reported(_DB, "Level by statistical energies", axis=_BAND)]
    alike_db: Mapping[float, float]
    modes: Annotated[Mapping[float, float], Reported("1", "Modes of the plate in the band", axis=_BAND)]
    scatter_db: Annotated[
        Mapping[float, float], Reported("dB", "Standard deviation to expect of one floor", axis=_BAND)
    ]

    def __post_init__(self) -> None:
        for name in ("levels_db", "alike_db", "modes", "scatter_db"):
            freeze(self, **{name: MappingProxyType(dict(getattr(self, name)))})

    @property
    def stated_db(self) -> Mapping[float, float]:
        """Levels of the bands with a mode or more, which may stand where those of modes are not known."""
        return {band: level for band, level in self.levels_db.items() if self.modes[band] >= FEWEST}

    @property
    def reliable_hz(self) -> tuple[float, ...]:
        """Bands [Hz] in which the plate has enough modes."""
        return tuple(band for band, count in self.modes.items() if count >= MANY)


@dataclass(frozen=True)
class Agreement:
    """Bands that modes and statistical energies both have, with enough modes: the mean of modal less statistical
    levels, its standard deviation over the bands (nan for one), and what the mean may be by scatter alone."""

    bands: Annotated[int, Reported("1", "Bands that both have")]
    mean_db: Annotated[float, Reported("dB", "Mean of modal less statistical levels")]
    deviation_db: Annotated[float, Reported("dB", "Its standard deviation over the bands")]
    allowed_db: Annotated[float, Reported("dB", "What the mean may be: twice its deviation by scatter, 1 at least")]

    @property
    def agree(self) -> bool:
        """Whether the mean is within what scatter makes of it."""
        return abs(self.mean_db) <= self.allowed_db


def agreement(statistical: StatisticalBands, modal_db: Mapping[float, float]) -> Agreement | None:
    """Modal levels of a room {nominal centre [Hz]: [dB]}, nan where they are not known, beside statistical ones; None
    without a common band of enough modes.

    >>> flat = dict.fromkeys((400.0, 500.0), 60.0)
    >>> found = StatisticalBands(flat, flat, {400.0: 4.5, 500.0: 5.6}, dict.fromkeys(flat, 1.5))
    >>> both = agreement(found, {400.0: 61.0, 500.0: 60.0})
    >>> both.bands, both.mean_db, round(both.deviation_db, 2), round(both.allowed_db, 2)
    (2, 0.5, 0.71, 2.12)
    """
    both = [band for band in statistical.reliable_hz if np.isfinite(modal_db.get(band, np.nan))]
    if not both:
        return None
    off = np.array([modal_db[band] - statistical.alike_db[band] for band in both])
    scatter = np.array([statistical.scatter_db[band] for band in both])
    deviation = float(np.std(off, ddof=1)) if len(both) > 1 else float("nan")
    allowed = max(SYSTEMATIC_DB, float(2 * np.sqrt((scatter**2).sum()) / len(both)))
    return Agreement(len(both), float(off.mean()), deviation, allowed)


def expected_scatter(modes: Floats, width_hz: Floats, t60_s: Floats, drops: int, receivers: int) -> Floats:
    """Standard deviation [n] [dB] to expect of bands of one floor, averaged over places of the source and receivers.

    Parameters
    ----------
    modes, width_hz, t60_s : Floats [n]
        Of the plate in each band, the band's width, the room's reverberation time.

    Notes
    -----
    Of the plate: squared shapes sin^2 sin^2 have a relative variance of 5/4 at each place of the source. Of the room:
    1 + 0.238 B T degrees of freedom of the mean square at each receiver (M. R. Schroeder, J. Acoust. Soc. Am. 46, 277
    (1969)). Seen over ensembles of rooms: 1.6 dB at 250 Hz where this has 1.7, 0.6 at 1000 Hz where it has 0.9. With a
    single mode in a band it is too small.

    Examples
    --------
    >>> one = np.ones(1)
    >>> expected_scatter(2.5 * one, 57.7 * one, 0.5 * one, 4, 4).round(1)
    array([1.7])
    """
    shapes = _OF_SHAPES / (drops * modes)
    room = 1 / ((1 + _OF_ROOM * width_hz * t60_s) * receivers)
    return np.asarray(_DB_PER * np.sqrt(shapes + room))
