"""Levels that blows on a plate make in a diffuse room, by energies: from textbooks, nothing of the packages.

Waves of a plate are eigenvectors of its stiffness at a wave vector; a point drives each by its share of Weyl's count of
modes. What a rectangle radiates is integrated over its far field, or of isotropic plates over the distance. Blows are
marched through their contact, and energies through plate, room, filter and meter by the exponential of their matrix.

L. Cremer, M. Heckl, B. A. T. Petersson, Structure-Borne Sound; R. D. Mindlin, J. Appl. Mech. 18, 31 (1951);
C. E. Wallace, J. Acoust. Soc. Am. 51, 946 (1972); R. V. Waterhouse, J. Acoust. Soc. Am. 27, 247 (1955).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, hypot, inf, log, pi
from typing import Final

import numpy as np
from scipy.integrate import quad, simpson, solve_ivp
from scipy.linalg import expm
from scipy.optimize import minimize_scalar
from scipy.signal import butter
from scipy.special import j0, j1

from tests.independent.contact_events import Law
from tests.independent.levels import P0, exact

Floats = np.ndarray
_ANGLES: Final = 64  # in a quarter turn
_HALF: Final = {3: 10**0.05, 1: 10**0.15}  # a band's upper edge over its centre
_BUTTERWORTH: Final = 4  # order of band filters, IEC 61260-1 class 1


# ---- waves of an infinite plate


@dataclass(frozen=True)
class Plate:
    """mass [kg/m^2]; D [3, 3] [N m]; S [2] [N/m], inf of a thin plate; rotary [kg]."""

    mass: float
    D: Floats
    S: tuple[float, float] = (inf, inf)
    rotary: float = 0.0

    @property
    def thin(self) -> Plate:
        """Without shear and rotary inertia."""
        return replace(self, S=(inf, inf), rotary=0.0)

    @property
    def isotropic(self) -> bool:
        """Whether waves are alike in all directions."""
        D = self.D
        round_about = abs(D[0, 0] - D[1, 1]) + abs(D[0, 1] + 2 * D[2, 2] - D[0, 0])
        return bool(round_about < 1e-9 * D[0, 0]) and self.S[0] == self.S[1]

    def bent(self, k: Floats, angle: Floats) -> tuple[Floats, Floats, Floats]:
        """Of the lowest wave at k [nf, na] along angles [na]: its frequency squared, the slope of that along k, and
        the share of the inertia that moves across.

        Motion w cos(k.x) with rotations sin(k.x): energies of curvatures and of shear, and of both motions.
        """
        nx, ny = (np.broadcast_to(each, k.shape) for each in (np.cos(angle), np.sin(angle)))
        zero, one = np.zeros(k.shape), np.ones(k.shape)

        def rows(*some: Sequence[Floats]) -> Floats:
            return np.stack([np.stack(each, axis=-1) for each in some], axis=-2)

        curvature = rows([zero, nx, zero], [zero, zero, ny], [zero, ny, nx])  # over k, of (w, psi_x, psi_y)
        bends = np.swapaxes(curvature, -1, -2) @ self.D @ curvature
        if not np.isfinite(self.S).all():
            along = np.stack([zero, nx, ny], axis=-1)  # rotations are slopes
            stiff = np.einsum("...i,...ij,...j->...", along, bends, along)
            return stiff * k**4 / self.mass, 4 * stiff * k**3 / self.mass, one
        S = np.diag(self.S)
        turns = rows([zero, one, zero], [zero, zero, one])
        slopes = rows([nx, zero, zero], [ny, zero, zero])
        wide = k[..., None, None]
        shear = turns - wide * slopes
        stiffness = wide**2 * bends + np.swapaxes(shear, -1, -2) @ S @ shear
        crossed = np.swapaxes(slopes, -1, -2) @ S @ shear
        rising = 2 * wide * bends - crossed - np.swapaxes(crossed, -1, -2)
        inertia = np.array([self.mass, self.rotary, self.rotary])
        unit = 1 / np.sqrt(inertia)
        values, vectors = np.linalg.eigh(unit[:, None] * stiffness * unit)
        moved = unit * vectors[..., 0]  # of unit inertia
        slope = np.einsum("...i,...ij,...j->...", moved, rising, moved)
        return values[..., 0], slope, self.mass * moved[..., 0] ** 2


@dataclass(frozen=True)
class Waves:
    """k, what each direction adds to Re Y, share of its inertia that moves across [nf, na]; k dk/dw; angles [na]."""

    k: Floats
    mobility: Floats
    across: Floats
    count: Floats
    angle: Floats


def waves(plate: Plate, f: Floats, patch: float = 0.0, angles: int = _ANGLES) -> Waves:
    """Waves at frequencies [nf], and what a force over a disc of a radius gives to those of each direction.

    A mode of unit mass takes pi/2 phi^2 for every one in a radian per second: S k dk da / (2 pi)^2 modes lie in a
    direction, with phi^2 = share / (m S) on the mean of the plate. The mean of a wave over a disc is 2 J1(kr)/kr.
    """
    angle = (np.arange(angles) + 0.5) * pi / 2 / angles
    squared = (2 * pi * np.asarray(f)[:, None]) ** 2
    k = np.sqrt(np.sqrt(squared * plate.mass / plate.thin.bent(np.ones((1, angles)), angle)[0] / plate.mass))
    for _ in range(60):  # Newton's, of frequencies that grow along k
        found, slope, _ = plate.bent(k, angle)
        step = (np.sqrt(found) - np.sqrt(squared)) / (slope / 2 / np.sqrt(found))
        k = np.where(step < k / 2, k - step, k / 2)
        if np.abs(step).max() < 1e-11 * k.max():
            break
    found, slope, across = plate.bent(k, angle)
    count = k * 2 * np.sqrt(squared) / slope
    spread = np.ones(k.shape) if patch == 0 else 2 * j1(k * patch) / (k * patch)
    return Waves(k, count * across / (4 * plate.mass) * spread**2, across, count, angle)


def modes_per_hz(plate: Plate, f: Floats, area: float) -> Floats:
    """Weyl's count: S / (2 pi)^2 int k dk/dw da over all directions, for 2 pi radians a hertz."""
    return np.asarray(area * waves(plate, f).count.mean(axis=1))


def point_mobility(plate: Plate, f: float) -> float:
    """Real part of the mobility at a point."""
    return float(waves(plate, np.array([f])).mobility.mean())


# ---- radiation of a rectangle in a baffle


def efficiency(f: float, c: float, plate: Plate, sides: tuple[float, float]) -> float:
    """Radiation efficiency of waves of all directions, each by what a point drives of it."""
    own = waves(plate, np.array([f]))
    if plate.isotropic:
        return by_distance(2 * pi * f / c, float(own.k.mean()), sides)
    count = ceil(16 + 0.35 * own.k.max() * hypot(*sides))  # more where waves part across the rectangle
    own = waves(plate, np.array([f]), angles=max(count, 32))
    return by_far_field(2 * pi * f / c, own.k[0], own.angle, own.mobility[0], sides)


def by_distance(k: float, bending: float, sides: tuple[float, float]) -> float:
    """k / (2 pi S) int J0(k_B r) sin(k r) g(r) dr, g dr the pairs of places r apart: closed form of a rectangle."""
    a, b = max(sides), min(sides)

    def pairs(r: float) -> float:
        low = np.arccos(min(1.0, a / r)) if r > 0 else 0.0
        high = np.arcsin(min(1.0, b / r)) if r > 0 else pi / 2

        def whole(t: float) -> float:  # of (a - r cos t)(b - r sin t)
            return float(a * b * t + a * r * np.cos(t) - b * r * np.sin(t) + (r * np.sin(t)) ** 2 / 2)

        return 4 * (whole(high) - whole(low))

    edges = [0.0, b, a, hypot(a, b)]
    total = 0.0
    for low, high in pairwise(edges):
        if high - low < 1e-12:
            continue
        count = ceil((k + bending) * (high - low) / 12) + 1  # pieces of two periods
        cuts = np.linspace(low, high, count + 1)
        for start, end in pairwise(cuts.tolist()):
            total += quad(lambda r: j0(bending * r) * np.sin(k * r) * pairs(r), start, end, epsabs=1e-9, epsrel=1e-8)[0]
    return float(k / (2 * pi * a * b) * total)


def by_far_field(k: float, bending: Floats, angle: Floats, share: Floats, sides: tuple[float, float]) -> float:
    """k^2 / (4 pi^2 S) of the power over a half space of what waves along angles [na] of a quarter turn send there.

    The directivity of a wave on a rectangle is a product of two sinc; waves in the other quarters are its mirror
    images, which send as much.
    """
    a, b = sides
    reach = k * hypot(a, b)
    nodes, weights = np.polynomial.legendre.leggauss(ceil(reach / 2) + 20)
    tilt, around = pi / 4 * (nodes + 1), np.arange(ceil(reach) + 40) * 2 * pi / (ceil(reach) + 40)
    x, y = k * np.sin(tilt)[:, None] * np.cos(around), k * np.sin(tilt)[:, None] * np.sin(around)
    total = 0.0
    for wave, along, part in zip(bending, angle, share / share.sum(), strict=True):
        u, v = (x - wave * np.cos(along)) * a / 2 / pi, (y - wave * np.sin(along)) * b / 2 / pi
        sent = (np.sinc(u) * np.sinc(v)) ** 2
        total += part * float(weights @ (np.sin(tilt) * sent.sum(axis=1)))
    return a * b * (k / 2 / pi) ** 2 * total * pi / 4 * (2 * pi / len(around))


# ---- blows


def blow(mass: float, speed: float, law: Law, resistance: float) -> tuple[Floats, Floats]:
    """Times and force of a body that meets a resistance, until it has left it.

    What is struck goes away with F / Z; laws are straight in the rate of their depth.
    """

    def force(d: float, v: float) -> float:
        if d <= 0:
            return 0.0
        piece = int(np.searchsorted(law.breaks, d))
        still = law.force(d, 0.0, piece)
        more = law.force(d, 1.0, piece) - still
        return max(0.0, (still + more * v) / (1 + more / resistance))

    def slope(_: float, y: Floats) -> list[float]:
        push = force(y[0], y[1])
        return [y[1] - push / resistance, -push / mass]

    def left(_: float, y: Floats) -> float:
        return float(y[0]) if y[1] - force(y[0], y[1]) / resistance < 0 else 1.0

    left.terminal = True
    end = 2e-3
    while True:
        solved = solve_ivp(
            slope, (0, end), [1e-12, speed], "DOP853", events=left, rtol=1e-10, atol=1e-14, dense_output=True,
            max_step=end / 100,
        )  # fmt: skip
        t = np.linspace(0, solved.t[-1], 4001)
        y = solved.sol(t)
        pushes = np.array([force(d, v) for d, v in y.T.tolist()])
        if solved.status == 1 or pushes[-1] < 1e-8 * pushes.max() or end > 2:
            return t, pushes
        end *= 3


def exposure(f0: float, t: Floats, force: Floats) -> float:
    """Int 2 |F|^2 df through a Butterworth band pass of a third octave around a frequency [N^2 s]."""
    low, high = f0 / _HALF[3], f0 * _HALF[3]
    weights = np.where(np.arange(len(t)) % 2, 4, 2) * (t[1] - t[0]) / 3  # Simpson's
    weights[[0, -1]] /= 2
    f = f0 * 10 ** np.linspace(-0.4, 0.4, 321)
    spectrum = np.exp(-2j * pi * np.outer(f, t)) @ (force * weights)
    gain = 1 / (1 + ((f * f - low * high) / (f * (high - low))) ** (2 * _BUTTERWORTH))
    return float(simpson(2 * np.abs(spectrum) ** 2 * gain * f * log(10), x=np.log10(f)))


# ---- energies of plate and room


@dataclass(frozen=True)
class Room:
    """A box of air: size [3] [m], decay rate gamma [1/s] and relaxation time tau [s] of amplitudes, c, rho."""

    size: tuple[float, float, float]
    gamma: float
    tau: float = 0.0
    c: float = 343.0
    rho: float = 1.21

    @property
    def volume(self) -> float:
        return float(np.prod(self.size))

    def falls(self, f: float) -> float:
        """Rate of its energy's decay [1/s]."""
        return 2 * (self.gamma + self.tau * (2 * pi * f) ** 2 / 2)

    def t60(self, f: float) -> float:
        return 6 * log(10) / self.falls(f)

    def inside(self, f: float) -> float:
        """Mean square away from the walls over that of the whole room."""
        a, b, h = self.size
        return 1 / (1 + 2 * (a * b + b * h + h * a) * self.c / f / 8 / self.volume)


@dataclass(frozen=True)
class Floor:
    """A plate of a size, the rectangle of it that radiates, its loss factor at a frequency, radius of the struck disc;
    losses : at frequencies of its bands [Hz], without what it radiates."""

    plate: Plate
    area: float
    sides: tuple[float, float]
    losses: Mapping[float, float]
    patch: float = 0.0

    def sent(self, band: float, room: Room) -> tuple[float, float]:
        """(sound power at once of a blow of unit force exposure [W/(N^2 s)], decay of the plate's energy [1/s])."""
        f = exact(band)
        driven = waves(self.plate, np.array([f]), self.patch)
        radiating = room.rho * room.c * efficiency(f, room.c, self.plate, self.sides) * self.sides[0] * self.sides[1]
        weight = self.plate.mass * self.area
        moving = float((driven.mobility * driven.across).mean())  # of the energy that moves across
        return radiating * moving / weight, 2 * pi * f * self.losses[band] + radiating / weight


def steady(floor: Floor, room: Room, band: float, force_squared: float) -> float:
    """Mean square away from the walls [Pa^2] of a force that goes on: what comes in goes out, in plate and room."""
    f = exact(band)
    first, decay = floor.sent(band, room)
    energy = first / decay * force_squared / room.falls(f)
    return energy * room.rho * room.c**2 / room.volume * room.inside(f)


def largest(floor: Floor, room: Room, exposures: Mapping[float, float], fraction: int) -> float:
    """Largest Fast mean square [Pa^2] of a blow, by thirds of one band: plate, room, filter, meter, one after another.

    A filter rings as the slowest of its poles.
    """
    centre = exact(sorted(exposures)[len(exposures) // 2])
    width = centre * (_HALF[fraction] - 1 / _HALF[fraction])
    _, poles, _ = butter(_BUTTERWORTH, 1.0, analog=True, output="zpk")
    rings = 2 * float(np.abs(poles.real).min()) * pi * width
    chains = []
    for band, one in exposures.items():
        f = exact(band)
        first, decay = floor.sent(band, room)
        start = one * first * room.rho * room.c**2 / room.volume * room.inside(f)
        falls = room.falls(f)
        chains.append(
            (start, np.array([[-decay, 0, 0, 0], [1, -falls, 0, 0], [0, rings, -rings, 0], [0, 0, 8.0, -8.0]]))
        )

    def heard(t: float) -> float:
        return float(sum(start * expm(matrix * t)[3, 0] for start, matrix in chains))

    coarse = np.geomspace(1e-3, 3.0, 60)
    top = int(np.argmax([heard(t) for t in coarse.tolist()]))
    around = (coarse[max(top - 1, 0)], coarse[min(top + 1, 59)])
    return -float(minimize_scalar(lambda t: -heard(t), bounds=around, method="bounded", options={"xatol": 1e-9}).fun)


def decibels(square: float) -> float:
    return float(10 * np.log10(square / P0**2))


def scatter(modes: float, width: float, t60: float, drops: int, receivers: int) -> float:
    """Of shapes sin^2 sin^2 at places of the source, <sin^4>^2/<sin^2>^4 - 1 = 5/4, and of receivers in a room, whose
    mean squares have 1 + 0.238 B T degrees of freedom (M. R. Schroeder, J. Acoust. Soc. Am. 46, 277 (1969))."""
    shapes = ((3 / 8) ** 2 / (1 / 2) ** 4 - 1) / (drops * modes)
    return float(10 / log(10) * np.sqrt(shapes + 1 / (receivers * (1 + 0.238 * width * t60))))


def width(band: float, fraction: int) -> float:
    """Of a band, by its nominal centre [Hz]."""
    return exact(band) * (_HALF[fraction] - 1 / _HALF[fraction])


# ---- sections


def layered(A: Floats, B: Floats, D: Floats, shear: tuple[float, float], mass: tuple[float, float, float]) -> Plate:
    """A plate by its rigidities about any plane: it bends about its neutral surface, and turns about its mass's."""
    own = D - B @ np.linalg.solve(A, B)
    return Plate(mass[0], own, shear, mass[2] - mass[1] ** 2 / mass[0])


def shear_stiffness(layers: Sequence[tuple[Floats, float, float]], axis: int) -> float:
    """Of a cross-ply along one of its axes [N/m], by the energy of Jourawski's stresses: tau' = -sigma' of a moment
    that grows by one a length.

    Parameters
    ----------
    layers : Sequence[tuple[Floats, float, float]]
        Plane stiffness [3, 3], shear modulus [Pa] in the plane of the axis, and thickness, from the lower face up.
    """
    z = np.cumsum([0.0, *(one[2] for one in layers)])
    z -= z[-1] / 2
    A, B, D = (
        sum(Q * (z[k + 1] ** n - z[k] ** n) / n for k, (Q, _, _) in enumerate(layers)) for n in (1, 2, 3)
    )  # fmt: skip
    strains = np.linalg.solve(np.block([[A, B], [B, D]]), np.eye(6)[3 + axis])
    below, energy = 0.0, 0.0
    for k, (Q, modulus, _) in enumerate(layers):
        c0, c1 = float(Q[axis] @ strains[:3]), float(Q[axis] @ strains[3:])
        tau = np.polynomial.Polynomial([0.0, c0, c1 / 2])
        tau = tau - tau(z[k]) + below
        work = (tau**2).integ()
        energy += (work(z[k + 1]) - work(z[k])) / modulus
        below = float(tau(z[k + 1]))
    return 1 / float(energy)
