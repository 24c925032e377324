"""Waves and point mobility of infinite plates: thin or with shear, isotropic, layered or orthotropic."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite, pi
from typing import Final

import numpy as np

from acoustics.arrays import Complexes, Floats, frozen, positive
from acoustics.errors import AcousticsError

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

        patch_m : radius of a disc over which the force is spread evenly [m]; 0 for a point.
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
