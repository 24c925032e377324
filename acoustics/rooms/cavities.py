"""Cavities: the air and the wool between two surfaces, as a mechanical system joined to both, passive by its form."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, Literal, NamedTuple

import numpy as np
from scipy.linalg import block_diag
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from acoustics.air import Air
from acoustics.arrays import Complexes, Floats, Integers, freeze, frozen, positive
from acoustics.errors import AcousticsError
from acoustics.rooms.box import Box, horizontal_wavenumber, order_grid, orders_not_in, overlaps, resolved_orders
from acoustics.source import SurfaceShapes

# ----------------------------------------------------------------------------------------------------------------------
# Wool as an equivalent fluid that is causal and passive at all frequencies: Darcy drag and one thermal pole.
# ----------------------------------------------------------------------------------------------------------------------

Frame = Literal["limp", "held"]
GAMMA: Final = 1.4  # ratio of the specific heats of air
PRANDTL: Final = 0.71  # of air
LEAST, MOST = 5e3, 30e3
"""Flow resistivities between which the model was compared with Johnson-Champoux-Allard, 20 Hz to 1 kHz [Pa s/m^2]."""


@dataclass(frozen=True)
class Wool:
    """Mineral wool and the like, light and with open pores.

    flow_resistivity : pressure gradient over the velocity of a steady flow [Pa s/m^2]. density : of the bulk [kg/m^3].
    frame : "limp", fibres that the air carries along, or "held", fibres at rest.
    porosity, tortuosity [1] : of the pores. thermal_rate : between isothermal and adiabatic compression [1/s]; 0 is
    adiabatic at all frequencies, None is that of the flow resistivity.

    Raises AcousticsError: numbers that cannot be.

    Notes
    -----
    Per volume flux, with s = j omega,

        rho(s) = tortuosity rho / porosity + sigma / s,    limp: sigma / s in series with the density of the bulk,
        K(s) = P0 / porosity (s + w) / (s / gamma + w),    w = sigma porosity / (4 tortuosity rho Pr),

    w being 8 eta / (L^2 rho Pr) with a thermal length L twice the viscous one, sqrt(8 eta tortuosity / sigma porosity).
    Against Johnson-Champoux-Allard with these lengths, 5 to 30 kPa s/m^2, 20 Hz to 1 kHz: resistance and Re K within
    6.5 %, Im K within 0.09 P0; Re rho is up to 20 % low, which does not matter where the resistance rules, below 1 kHz.

    The formulas of Delany and Bazley, and of Miki, are not used: below f / sigma = 0.01 m^3/kg (100 Hz at 10 kPa s/m^2)
    they describe a medium that gives energy.

    References: J.-F. Allard, N. Atalla, Propagation of Sound in Porous Media, 2nd ed., 2009, chapter 5 (Darcy limit,
    thermal length); limp frame: R. Panneton, J. Acoust. Soc. Am. 122 (2007) EL217, for a porosity of 1.

    >>> wool = Wool(flow_resistivity=10e3, density=40.0)
    >>> round(wool.rate(Air(343.25, 1.204)) / (2 * np.pi))
    465
    """

    flow_resistivity: float
    density: float = 40.0
    frame: Frame = "limp"
    porosity: float = 1.0
    tortuosity: float = 1.0
    thermal_rate: float | None = None

    def __post_init__(self) -> None:
        freeze(
            self,
            flow_resistivity=positive("fill.flow_resistivity", self.flow_resistivity, "Pa s/m^2"),
            density=positive("fill.density", self.density, "kg/m^3"),
        )
        if self.frame not in ("limp", "held"):
            raise AcousticsError("fill.frame", got=f"'{self.frame}'", expected="limp or held")
        if not 0.5 <= self.porosity <= 1.0:
            raise AcousticsError("fill.porosity", got=f"{self.porosity:g}", expected="a number from 0.5 to 1")
        if not 1.0 <= self.tortuosity <= 5.0:
            raise AcousticsError("fill.tortuosity", got=f"{self.tortuosity:g}", expected="a number from 1 to 5")
        if self.thermal_rate is not None and not (np.isfinite(self.thermal_rate) and self.thermal_rate >= 0):
            raise AcousticsError("fill.thermal_rate", got=f"{self.thermal_rate:g} 1/s", expected="a number >= 0")

    def rate(self, air: Air) -> float:
        """Circular frequency below which compression is isothermal [1/s]; 0 where it never is."""
        if self.thermal_rate is not None:
            return self.thermal_rate
        return self.flow_resistivity * self.porosity / (4.0 * self.tortuosity * air.rho * PRANDTL)

    def pores(self, air: Air) -> Air:
        """The air in the pores per volume flux, without drag and adiabatic."""
        return Air(air.c / self.tortuosity**0.5, air.rho * self.tortuosity / self.porosity)

    def density_at(self, s: Complexes, air: Air) -> Complexes:
        """Equivalent density [nf] [kg/m^3] at s [1/s].

        >>> still, carried = (Wool(10e3, frame=one).density_at(np.array([60j]), Air()) for one in ("held", "limp"))
        >>> still.round(2).tolist(), carried.round(2).tolist()
        ([(1.21-166.67j)], [(39.03-9.08j)])
        """
        drag: Complexes = self.flow_resistivity / s
        if self.frame == "limp":
            drag = drag * self.density / (drag + self.density)
        return self.pores(air).rho + drag

    def modulus_at(self, s: Complexes, air: Air) -> Complexes:
        """Bulk modulus [nf] [Pa] at s [1/s].

        >>> (Wool(10e3).modulus_at(np.array([1e-3j, 1e9j]), Air()).real / Air().bulk_modulus).round(3).tolist()
        [0.714, 1.0]
        """
        adiabatic, rate = self.pores(air).bulk_modulus, self.rate(air)
        modulus: Complexes = adiabatic / GAMMA * (1.0 + (GAMMA - 1.0) * s / (s + GAMMA * rate))
        return modulus


# ----------------------------------------------------------------------------------------------------------------------
# The noun of a cavity: a flat box of air between two surfaces, with wool in all or a part of its depth.
# ----------------------------------------------------------------------------------------------------------------------

AIR_FACTOR: Final = 2.0
WOOL_FACTOR: Final[Mapping[Frame, float]] = {"limp": 2.0, "held": 5.0}
_WHOLE: Final = 1e-9  # of the depth: wool this much thinner fills it


@dataclass(frozen=True, eq=False)
class Cavity:
    """Air between two parallel surfaces that move, its four sides rigid.

    size : lengths of the sides and the depth [3] [m]. wool : what fills it, against the second surface; thickness : of
    the wool [m], all of the depth if left out.

    Raises AcousticsError: lengths that cannot be, wool thicker than the cavity, a thickness without wool.

    >>> cavity = Cavity([4.0, 0.6, 0.2], wool=Wool(10e3), thickness=0.1)
    >>> [(float(layer.box.size[2]), layer.wool is None) for layer in cavity.layers]
    [(0.1, False), (0.1, True)]
    """

    size: Floats
    air: Air = field(default_factory=Air)
    wool: Wool | None = None
    thickness: float | None = None

    def __post_init__(self) -> None:
        size = frozen("cavity.size", self.size, (3,))
        if (size <= 0).any():
            raise AcousticsError("cavity.size", got=f"{size.tolist()} m", expected="positive lengths")
        if self.thickness is not None:
            thickness = positive("fill.thickness", self.thickness, "m")
            if self.wool is None:
                raise AcousticsError("fill.thickness", got="a thickness without wool", expected="wool")
            if thickness > size[2] * (1 + _WHOLE):
                raise AcousticsError(
                    "fill.thickness", got=f"{thickness:g} m", expected=f"at most the depth, {size[2]:g} m"
                )
        freeze(self, size=size)

    @property
    def layers(self) -> tuple[FluidLayer, ...]:
        """From the second surface to the first."""
        depth = float(self.size[2])
        if self.wool is None:
            return (FluidLayer(Box(self.size, self.air), None),)
        within = self.wool.pores(self.air)
        if self.thickness is None or self.thickness >= depth * (1 - _WHOLE):
            return (FluidLayer(Box(self.size, within), self.wool, self.wool.rate(self.air)),)
        flat = self.size[:2]
        return (
            FluidLayer(Box(np.append(flat, self.thickness), within), self.wool, self.wool.rate(self.air)),
            FluidLayer(Box(np.append(flat, depth - self.thickness), self.air), None),
        )

    def kept_hz(self, top_hz: float) -> float:
        """Up to where modes of the air are to be coordinates of their own, for motions up to `top_hz` [Hz].

        Notes
        -----
        Modes left out follow statically. Of air without losses that leaves (f / f_n)^2 of them, and 2 of the top is
        kept. In wool a mode follows only below f_n^2 2 pi rho / sigma: WOOL_FACTOR times the frequency for which that
        is the top is kept, which leaves 1 % at the top of the band and less below: loose wool in 4 x 3 x 0.2 m and in
        eight smaller cavities, held wool in these, where a factor of 2 left up to 2.8 %. Held wool drags more, for the
        air does not carry it along.

        >>> Cavity([4, 3, 0.2]).kept_hz(100.0), round(Cavity([4, 3, 0.2], wool=Wool(10e3)).kept_hz(100.0))
        (200.0, 725)
        """
        if self.wool is None:
            return AIR_FACTOR * top_hz
        slow = np.sqrt(top_hz * self.wool.flow_resistivity / (2 * np.pi * self.wool.pores(self.air).rho))
        return float(max(AIR_FACTOR * top_hz, WOOL_FACTOR[self.wool.frame] * slow))


@dataclass(frozen=True, eq=False)
class FluidLayer:
    """A part of the depth with one fluid. box : its size and the air in its pores. rate : of its thermal pole [1/s]."""

    box: Box
    wool: Wool | None
    rate: float = 0.0


# ----------------------------------------------------------------------------------------------------------------------
# One fluid between two moving boundaries: its modes, what the boundaries displace of them, and the mass of the rest.
#
# Both boundaries displace INTO the fluid. P_n are the modes of the box with rigid walls, L_n the integral of P_n psi
# over both boundaries, P_n being (-1)^nz at the upper one. With kappa = rho c^2 / V and the amplitudes y_n of the
# displacement along the gradient of P_n, of unit modal mass,
#
#     p_n = kappa L_n q - sqrt(kappa) omega_n y_n,        as in `acoustics.rooms.box_coupling`.
#
# The modes left out are a mass of both boundaries. Summed over nz, those of the cosine (l, m) weigh, per product of the
# boundaries' integrals I, rho eps_l eps_m / S times
#
#     g_11 = coth(k h) / k, g_12 = 1 / (k sinh(k h));        (0, 0): g_11 = h / 3, g_12 = -h / 6,
#
# less the terms 2 (+-1) / (h k_n^2) of those that are kept. Along I_1 + I_2 and I_1 - I_2 both are diagonal: even nz
# take from the one, odd nz from the other, and neither becomes negative.
# ----------------------------------------------------------------------------------------------------------------------

SETTLED: Final = 1e-8  # largest mass the last cosines may add to a unit modal mass
BEYOND: Final = 8  # cosines of a block beyond the last one
ROUNDING: Final = 1e-14  # of a unit modal mass

Boundaries = Callable[[Integers], tuple[Floats, Floats]]
"""Integrals of cosines [n, 2] times displacements into the fluid over the lower and the upper boundary, each [n, N]."""


class LayerFields(NamedTuple):
    """What N coordinates of the boundaries displace.

    frequency_hz [n] : of the modes kept. displaced [1 + n, N] : L of the uniform mode and of those kept. remainder
    [r, N] : fields of the modes left out, R^T R is their mass; first those of the cosines with modes, one by one.
    """

    frequency_hz: Floats
    displaced: Floats
    remainder: Floats


def multiplicity(orders: Integers) -> Floats:
    """Product over the directions of 1 for order 0 and 2 for the others [n]."""
    product: Floats = np.where(orders > 0, 2.0, 1.0).prod(axis=1)
    return product


def layer_fields(box: Box, orders: Integers, up_to_hz: float, boundaries: Boundaries, finest: Integers) -> LayerFields:
    """Modes up to a frequency of the cosines `orders` [n, 2], and the others as mass.

    A piston of 1 m^2 on air 0.2 m deep, no mode kept: a third of the air's mass moves with it.

    Parameters
    ----------
    finest : Integers [2]
        Highest cosines that the boundaries resolve.

    Examples
    --------
    >>> from acoustics.air import Air
    >>> box, only = Box([1, 1, 0.2], Air(343, 1.2)), np.zeros((1, 2), dtype=np.int64)
    >>> moved = lambda orders: (np.zeros((len(orders), 1)), (orders == 0).all(axis=1)[:, None] * 1.0)
    >>> rest = layer_fields(box, only, 100.0, moved, np.zeros(2, dtype=np.int64)).remainder
    >>> (rest.T @ rest).round(6).tolist()
    [[0.08]]
    """
    indices = _kept(box, orders, up_to_hz)
    flat, place = np.unique(np.concatenate([np.zeros((1, 2), np.int64), indices[:, :2]]), axis=0, return_inverse=True)
    lower, upper = (part[place.ravel()] for part in boundaries(flat))
    with_uniform = np.concatenate([np.zeros((1, 3), np.int64), indices])
    upwards = np.where(with_uniform[:, 2] % 2 == 0, 1.0, -1.0)[:, None]
    displaced = np.sqrt(multiplicity(with_uniform))[:, None] * (lower + upwards * upper)
    frequency_hz: Floats = box.air.c / 2 * np.sqrt(((indices / box.size) ** 2).sum(axis=1))
    return LayerFields(frequency_hz, displaced, _remainder(box, orders, indices, boundaries, finest))


def _kept(box: Box, orders: Integers, up_to_hz: float) -> Integers:
    """Indices [n, 3] of the modes of these cosines up to a frequency, without the uniform one."""
    most = int(2 * up_to_hz * float(box.size[2]) / box.air.c) + 1
    every = np.concatenate([np.repeat(orders, most + 1, axis=0), np.tile(np.arange(most + 1), len(orders))[:, None]], 1)
    hz = box.air.c / 2 * np.sqrt(((every / box.size) ** 2).sum(axis=1))
    kept: Integers = every[(hz > 0) & (hz <= up_to_hz)].astype(np.int64)
    return kept


def _remainder(box: Box, orders: Integers, kept: Integers, boundaries: Boundaries, finest: Integers) -> Floats:
    """Fields [r, N] of the modes that are not kept: of the cosines `orders` one by one, then of finer ones, added until
    the last ones weigh nothing, together."""
    own = _fields(box, orders, kept, boundaries)
    resolved = [int(order) + 1 for order in finest]
    size = [int(orders[:, axis].max(initial=0)) + 1 for axis in (0, 1)]
    done, mass = orders, np.zeros((own.shape[1], own.shape[1]))
    while True:
        new = orders_not_in(order_grid(*size), done)
        part = np.zeros_like(mass)
        if len(new):
            rows = _fields(box, new, kept[:0], boundaries)
            part = rows.T @ rows
            mass += part
        settled = len(done) > len(orders) and np.diag(part).max(initial=0.0) < SETTLED
        done = np.concatenate([done, new])
        if settled or all(have >= most for have, most in zip(size, resolved, strict=True)):
            break
        size = [max(have, min(have + BEYOND, most)) for have, most in zip(size, resolved, strict=True)]
    squared, along = np.linalg.eigh(mass)
    heavy = squared > ROUNDING * max(float(squared.max(initial=0.0)), 1.0)
    return np.concatenate([own, np.sqrt(squared[heavy])[:, None] * along[:, heavy].T])


def _fields(box: Box, orders: Integers, kept: Integers, boundaries: Boundaries) -> Floats:
    """Two fields of every cosine [2 n, N]: boundaries against each other and together."""
    lower, upper = boundaries(orders)
    factor = box.air.rho / float(box.size[0] * box.size[1]) * multiplicity(orders)
    even, odd = np.sqrt(factor * _left_out(box, orders, kept))
    fields: Floats = np.concatenate([even[:, None] * (lower + upper), odd[:, None] * (lower - upper)])
    return fields


def _left_out(box: Box, orders: Integers, kept: Integers) -> Floats:
    """(g_11 + g_12) / 2 and (g_11 - g_12) / 2 of the cosines [n, 2] less the modes kept: [2, n] [m]."""
    h = float(box.size[2])
    k = horizontal_wavenumber(box, orders)
    uniform = k == 0
    safe = np.where(uniform, 1.0, k)
    half = np.tanh(0.5 * safe * h)
    # coth x + 1 / sinh x = coth(x / 2), coth x - 1 / sinh x = tanh(x / 2)
    even = np.where(uniform, h / 12, 0.5 / (safe * half))
    odd = np.where(uniform, h / 4, 0.5 * half / safe)
    whole = np.stack([even, odd])
    number = {tuple(pair): i for i, pair in enumerate(orders.tolist())}
    at = np.array([number.get(tuple(index[:2]), -1) for index in kept.tolist()], dtype=np.int64)
    own = kept[at >= 0]
    terms = np.where(own[:, 2] > 0, 2.0, 1.0) / h
    squared = ((own / box.size) ** 2).sum(axis=1) * np.pi**2
    np.subtract.at(whole, (own[:, 2] % 2, at[at >= 0]), terms / squared)
    return whole.clip(0.0)


# ----------------------------------------------------------------------------------------------------------------------
# The air and the wool of a cavity as a mechanical system joined to its two surfaces, passive by its form.
#
# Coordinates: q of the surfaces, the amplitudes y of the modes kept, and where wool fills a part of the depth the
# displacement w of the face between wool and air, by cosines. Two layers are two boxes with that face between them: air
# slides along it, as it does. Mass, compression and drag are sums over the layers (`layer_fields`).
#
# Motions of the face that displace no volume have no stiffness. They are written so that the modes follow them without
# compression, and have no part in the stiffness at all (`loose`).
#
# Wool adds, per field a of unit mass (y, and what the boundaries move of the modes left out):
# - held: a dashpot sigma / rho on a' to the ground. Modes left out drag as well as weigh.
# - limp: the same dashpot between a' and the velocity of a frame of mass rho_1 / rho.
# - compression: isothermal, with the rest of the adiabatic stiffness, 1 - 1 / gamma, as a spring in series with a
#   dashpot. A mass on the joint of the two, so small that it resonates at `STILL_HZ`, makes it a coordinate
#   like all others.
# ----------------------------------------------------------------------------------------------------------------------

MOST_MODES: Final = 400  # modes of a cavity kept where nobody says how many
FINEST: Final = 64  # cosines in one direction at most
STILL_HZ: Final = 30e3  # of the thermal coordinates: they miss 2e-4 of the modulus at 1 kHz, 3e-6 at 100 Hz
LIGHT: Final = 1e-6  # of a unit modal mass: frames that weigh less are left out


@dataclass(frozen=True, eq=False)
class CavityAir:
    """The air of a cavity over [q; inner; loose], N in all, and more coordinates that only drag moves.

    frequency_hz [n] : of the modes kept. compression [r, N] : the potential energy is |compression x|^2 / 2. mass
    [N, N] : of the air. face : how many of the first inner coordinates are the mean motion of a face between wool and
    air. loose : how many of the last coordinates have no stiffness. viscous [N + e, N + e] : damping.
    frames : how many of the e are frames of limp wool, at 0 Hz; the others are thermal, at STILL_HZ. complete_below_hz
    : no mode is left out below it.
    """

    frequency_hz: Floats
    compression: Floats
    mass: Floats
    face: int
    loose: int
    viscous: Floats
    frames: int
    complete_below_hz: float


def cavity_air(cavity: Cavity, first: SurfaceShapes, second: SurfaceShapes, up_to_hz: float) -> CavityAir:
    """The air of a cavity joined to the shapes of its surfaces, modes up to a frequency as coordinates.

    Two pistons of 1 kg/m^2 over air 0.2 m deep, against each other: the spring rho c^2 / d (1 / m_1 + 1 / m_2)

    Parameters
    ----------
    first, second : SurfaceShapes
        At z = depth and z = 0, points in the cavity's own x and y; displacements into the cavity [p, k] in the same k
        coordinates.

    Examples
    --------
    >>> cavity = Cavity([1.0, 1.0, 0.2])
    >>> one, other = (SurfaceShapes([[0.5, 0.5, 0]], [1.0], [row]) for row in ([1.0, 0.0], [0.0, 1.0]))
    >>> air = cavity_air(cavity, one, other, up_to_hz=100.0)
    >>> round(float((air.compression.T @ air.compression).sum()) / (4 * cavity.air.bulk_modulus / 0.2), 9)
    1.0
    """
    flat, finest, complete = _flat(cavity, (first, second), up_to_hz)
    layers = cavity.layers
    k, face = first.shapes.shape[1], flat if len(layers) == 2 else flat[:0]
    found = [
        _fields_of_air(
            cavity, layers, number=i, surfaces=(first, second), face=face, flat=flat, up_to_hz=up_to_hz, finest=finest
        )
        for i in range(len(layers))
    ]
    n_boundary = k + len(face)
    counts = [len(one.frequency_hz) for one in found]
    starts = n_boundary + np.concatenate([[0], np.cumsum(counts)]).astype(int)
    total = int(starts[-1])
    rest = np.concatenate([one.remainder for one in found])
    mass = block_diag(rest.T @ rest, np.eye(total - n_boundary))
    rows, fields = [], []
    for layer, one, at in zip(layers, found, starts.tolist(), strict=False):
        rows.append(_compressed(layer, one, at, total))
        fields.append(_unit_fields(one, at, total) if layer.wool is not None else np.zeros((0, total)))
    turn = _arranged(rows, k, len(face), total)
    loose = max(len(face) - 1, 0)
    rows, fields = [row @ turn for row in rows], [field @ turn for field in fields]
    for row in rows:  # by construction; what is left is rounding
        row[:, total - loose :] = 0.0
        row[1:, : k + min(len(face), 1)] = 0.0
    viscous, frames = _losses(layers, rows, fields, total)
    relaxed = [row / np.sqrt(GAMMA) if layer.rate > 0 else row for layer, row in zip(layers, rows, strict=True)]
    return CavityAir(
        frequency_hz=np.sort(np.concatenate([one.frequency_hz for one in found])),
        compression=np.concatenate(relaxed),
        mass=turn.T @ mass @ turn,
        face=min(len(face), 1),
        loose=loose,
        viscous=viscous,
        frames=frames,
        complete_below_hz=complete,
    )


def _flat(cavity: Cavity, surfaces: tuple[SurfaceShapes, ...], up_to_hz: float) -> tuple[Integers, Integers, float]:
    """Cosines [m, 2] with modes up to a frequency, the highest that both surfaces resolve [2], and where modes end."""
    box = Box(cavity.size, cavity.air)
    finest = np.min([resolved_orders(box, one.points) for one in surfaces], axis=0).clip(0, FINEST)
    slowest = min(layer.box.air.c for layer in cavity.layers)
    counts = (2 * up_to_hz * cavity.size[:2] / slowest).astype(int) + 1
    orders = np.stack(np.meshgrid(*map(np.arange, counts + 1), indexing="ij"), axis=-1).reshape(-1, 2).astype(np.int64)
    hz = slowest / 2 * np.sqrt(((orders / cavity.size[:2]) ** 2).sum(axis=1))
    beyond = (orders > finest).any(axis=1)
    complete = float(hz[beyond].min(initial=up_to_hz))
    kept = orders[(hz <= up_to_hz) & ~beyond]
    return kept[np.argsort(hz[(hz <= up_to_hz) & ~beyond], kind="stable")], finest, complete


def _fields_of_air(
    cavity: Cavity,
    layers: tuple[FluidLayer, ...],
    number: int,
    surfaces: tuple[SurfaceShapes, SurfaceShapes],
    face: Integers,
    flat: Integers,
    up_to_hz: float,
    finest: Integers,
) -> LayerFields:
    """The fields of one layer over [q; w]."""
    first, second = surfaces
    k = first.shapes.shape[1]
    box = Box(cavity.size, cavity.air)
    # w of unit size moves about a unit mass
    scale = np.sqrt(box.ceiling_area / (cavity.air.rho * float(cavity.size[2]) * multiplicity(face)))

    def outer(surface: SurfaceShapes, orders: Integers) -> Floats:
        weighted = surface.weights[:, None] * surface.shapes
        return np.hstack([overlaps(box, orders, surface.points, weighted), np.zeros((len(orders), len(face)))])

    def between(orders: Integers, sign: float) -> Floats:
        same = (orders[:, None] == face).all(axis=2)
        return np.hstack([np.zeros((len(orders), k)), sign * scale * same])

    def boundaries(orders: Integers) -> tuple[Floats, Floats]:
        lower = outer(second, orders) if number == 0 else between(orders, 1.0)
        upper = outer(first, orders) if number == len(layers) - 1 else between(orders, -1.0)
        return lower, upper

    return layer_fields(layers[number].box, flat, up_to_hz, boundaries, finest)


def _compressed(layer: FluidLayer, one: LayerFields, at: int, total: int) -> Floats:
    """Rows b of a layer over all coordinates: its adiabatic energy is |b x|^2 / 2."""
    rows = np.zeros((len(one.displaced), total))
    rows[:, : one.displaced.shape[1]] = np.sqrt(layer.box.air.bulk_modulus / layer.box.volume) * one.displaced
    rows[1:, at : at + len(one.frequency_hz)] = -np.diag(2 * np.pi * one.frequency_hz)
    return rows


def _unit_fields(one: LayerFields, at: int, total: int) -> Floats:
    """Rows a of a layer over all coordinates: its kinetic energy is |a x'|^2 / 2, of modes kept and left out."""
    n = len(one.frequency_hz)
    fields = np.zeros((n + len(one.remainder), total))
    fields[:n, at : at + n] = np.eye(n)
    fields[n:, : one.remainder.shape[1]] = one.remainder
    return fields


def _arranged(rows: list[Floats], k: int, n_face: int, total: int) -> Floats:
    """The coordinates in terms of [q; uniform motion of the face; modes; other motions of the face], modes being
    counted from where they follow the boundaries without compression."""
    turn = np.eye(total)
    first = k + n_face
    for row in rows:
        modes = row[1:, first:]
        own = np.flatnonzero(modes.any(axis=0))
        turn[first + own, :first] = row[1:, :first] / -np.diag(modes[:, own])[:, None]
    order = np.concatenate([np.arange(min(k + 1, first)), np.arange(first, total), np.arange(k + 1, first)])
    return turn[:, order.astype(int)]


def _losses(layers: tuple[FluidLayer, ...], rows: list[Floats], fields: list[Floats], total: int) -> tuple[Floats, int]:
    """Damping [N + e, N + e] of drag and heat, and how many of the e are frames."""
    dashpots: list[tuple[Floats, Floats]] = []  # rows over the coordinates, and what is added over their own
    held = np.zeros((total, total))
    frames, thermal = [], []
    for layer, row, motion in zip(layers, rows, fields, strict=True):
        if layer.wool is None:
            continue
        rho = layer.box.air.rho
        drag, bulk = layer.wool.flow_resistivity / rho, layer.wool.density / rho
        if layer.wool.frame == "held":
            held += drag * motion.T @ motion
        else:
            heavy = (motion**2).sum(axis=1) * bulk > LIGHT
            frames.append((np.sqrt(drag) * motion[heavy], np.sqrt(drag / bulk)))
        if layer.rate > 0:
            moved = row[row.any(axis=1)]
            share = 1.0 - 1.0 / GAMMA
            still = 2 * np.pi * STILL_HZ
            thermal.append((np.sqrt(share / (GAMMA * layer.rate)) * moved, still / np.sqrt(GAMMA * layer.rate)))
    dashpots = [*frames, *thermal]
    sizes = [len(row) for row, _ in dashpots]
    added = sum(sizes)
    viscous = np.zeros((total + added, total + added))
    viscous[:total, :total] = held
    at = total
    for (row, own), size in zip(dashpots, sizes, strict=True):
        both = np.hstack([row, np.zeros((size, added))])
        both[np.arange(size), at + np.arange(size)] = -own
        viscous += both.T @ both
        at += size
    return viscous, sum(len(row) for row, _ in frames)


# ----------------------------------------------------------------------------------------------------------------------
# Fewer coordinates for the air of a cavity: those that its surfaces move in a band, by how much they react on them.
#
# The surfaces are moved harmonically in each of their coordinates, and what follows is kept in its principal
# directions: modes of the air, layers that slide, frames and thermal coordinates each for themselves. Mass, stiffness
# and damping are projected on them from both sides, so that they stay symmetric and passive, and what is left out of
# the reaction is the square of what is left out of the motion.
# ----------------------------------------------------------------------------------------------------------------------

ALLOWED: Final = 0.02
"""Motion left out, as the root of its energy over that of a unit modal mass: costs 0.03 dB of the motion, or less."""
LINES: Final = 10  # frequencies at which the surfaces are moved
DECADES: Final = 1.7  # the lowest of them is the band's end over 50
_APART: Final = 1e-13  # of what two coordinates have of their own: rounding


def condense_air(air: CavityAir, omega: Floats, top_hz: float, allowed: float = ALLOWED) -> CavityAir:
    """The same air with fewer coordinates of its own, for motions up to a frequency.

    Parameters
    ----------
    omega : Floats [k]
        Circular frequencies of the coordinates of the surfaces: below its own, one reacts as a stiffness, and less is
        needed of what it moves.

    Examples
    --------
    Two pistons with limp wool between them keep the frame that goes with both, and little else:

    >>> from acoustics.rooms.cavities import Cavity
    >>> from acoustics.rooms.cavities import cavity_air
    >>> from acoustics.rooms.cavities import Wool
    >>> from acoustics.source import SurfaceShapes
    >>> one, other = (SurfaceShapes([[0.5, 0.5, 0]], [1.0], [row]) for row in ([0.1, 0.0], [0.0, 0.2]))
    >>> whole = cavity_air(Cavity([1.0, 1.0, 0.2], wool=Wool(10e3)), one, other, up_to_hz=3000.0)
    >>> few = condense_air(whole, np.zeros(2), top_hz=100.0)
    >>> len(whole.viscous), len(few.viscous)
    (14, 8)
    """
    n, k = len(air.mass), len(omega)
    total = len(air.viscous)
    bound = k + air.face
    groups = [
        np.arange(bound, n - air.loose),
        np.arange(n - air.loose, n),
        np.arange(n, n + air.frames),
        np.arange(n + air.frames, total),
    ]
    mass, stiffness = _whole(air)
    own = np.diag(mass).copy()
    own[:bound] = 1.0
    scale = 1.0 / np.sqrt(own)
    mass, stiffness, damping = (scale[:, None] * one * scale for one in (mass, stiffness, air.viscous))
    lines = 2 * np.pi * top_hz * 10.0 ** -np.linspace(0.0, DECADES, LINES)
    middle = float(np.sqrt(lines[0] * lines[-1]))
    weigh = np.sqrt(1.0 + np.diag(damping) / middle + np.diag(stiffness) / middle**2)
    energy = [np.zeros((len(group), len(group))) for group in groups]
    blocks = _blocks(mass, stiffness, damping, bound)
    for w in lines.tolist():
        moved = _followed(mass, stiffness, damping, blocks, bound, w)
        moved[:, :k] *= np.minimum(1.0, np.divide(w, omega, out=np.ones(k), where=omega > w))
        moved *= weigh[:, None] * np.sqrt(middle / w)
        for gathered, group in zip(energy, groups, strict=True):
            part = moved[group]
            gathered += part.real @ part.real.T + part.imag @ part.imag.T
    kept = [_directions(gathered, weigh[group], allowed) for gathered, group in zip(energy, groups, strict=True)]
    turn = scale[:, None] * block_diag(np.eye(bound), *kept)
    turn[:bound, :bound] = np.eye(bound)
    moving = bound + kept[0].shape[1] + kept[1].shape[1]
    within = turn[:n, :moving]
    return replace(
        air,
        compression=air.compression @ within,
        mass=within.T @ air.mass @ within,
        loose=kept[1].shape[1],
        viscous=turn.T @ air.viscous @ turn,
        frames=kept[2].shape[1],
    )


def _whole(air: CavityAir) -> tuple[Floats, Floats]:
    """Mass and stiffness of all coordinates of the air."""
    added = len(air.viscous) - len(air.mass)
    still = np.concatenate([np.zeros(air.frames), np.full(added - air.frames, (2 * np.pi * STILL_HZ) ** 2)])
    return block_diag(air.mass, np.eye(added)), block_diag(air.compression.T @ air.compression, np.diag(still))


def _blocks(mass: Floats, stiffness: Floats, damping: Floats, bound: int) -> list[Integers]:
    """Coordinates of the air that do not act on each other [blocks, m], blocks of one size together."""
    joined = np.zeros_like(mass[bound:, bound:], dtype=bool)
    for matrix in (mass, stiffness, damping):
        part = matrix[bound:, bound:]
        root = np.sqrt(np.abs(np.diag(part)))
        joined |= np.abs(part) > _APART * np.outer(root, root)
    _, label = connected_components(csr_array(joined), directed=False)
    order = np.argsort(label, kind="stable")
    sizes = np.bincount(label, minlength=int(label.max(initial=-1)) + 1)
    found = []
    for size in np.unique(sizes):
        some = order[np.isin(label[order], np.flatnonzero(sizes == size))]
        found.append((bound + some.reshape(-1, int(size))).astype(np.int64))
    return found


def _followed(
    mass: Floats, stiffness: Floats, damping: Floats, blocks: list[Integers], bound: int, w: float
) -> Complexes:
    """Motion [all, bound] of the coordinates of the air when the others are moved by one each."""
    moved = np.zeros((len(mass), bound), dtype=np.complex128)
    for at in blocks:
        inside = np.ix_(at.ravel(), np.arange(bound))
        push = (w**2 * mass[inside] - 1j * w * damping[inside] - stiffness[inside]).reshape(*at.shape, bound)
        rows, columns = at[:, :, None], at[:, None, :]
        dynamic = stiffness[rows, columns] + 1j * w * damping[rows, columns] - w**2 * mass[rows, columns]
        moved[at] = np.linalg.solve(dynamic, push)
    return moved


def _directions(energy: Floats, weigh: Floats, allowed: float) -> Floats:
    """Orthonormal directions [n, m] in which coordinates move by more than what may be left out."""
    if not len(energy):
        return np.zeros((0, 0))
    squared, along = np.linalg.eigh(energy)
    needed = along[:, squared > allowed**2] / weigh[:, None]
    return np.linalg.qr(needed[:, ::-1])[0] if needed.size else needed


# ----------------------------------------------------------------------------------------------------------------------
# Several cavities beside the surfaces of one structure as one: they share its coordinates and nothing else.
# ----------------------------------------------------------------------------------------------------------------------


def combine_cavities(airs: Sequence[CavityAir], k: int) -> CavityAir:
    """The air of several cavities over the k coordinates of the structure and all of their own.

    >>> from acoustics.rooms.cavities import Cavity
    >>> from acoustics.rooms.cavities import cavity_air
    >>> from acoustics.source import SurfaceShapes
    >>> still, moves = (SurfaceShapes([[0.5, 0.5, 0]], [1.0], [[x]]) for x in (0.0, 1.0))
    >>> one = cavity_air(Cavity([1.0, 1.0, 0.2]), moves, still, up_to_hz=200.0)
    >>> both = combine_cavities([one, one], 1)
    >>> bool((both.compression**2).sum() == 2 * (one.compression**2).sum()), float(both.mass[0, 0] / one.mass[0, 0])
    (True, 2.0)
    """
    thermal = [len(air.viscous) - len(air.mass) - air.frames for air in airs]
    modes = [len(air.mass) - k - air.face - air.loose for air in airs]
    sizes = np.array([[air.face for air in airs], modes, [air.loose for air in airs]])
    sizes = np.concatenate([sizes, [[air.frames for air in airs], thermal]])
    starts = k + np.concatenate([[0], np.cumsum(sizes.ravel())])[:-1].reshape(sizes.shape)
    total = k + int(sizes.sum())
    moving = k + int(sizes[:3].sum())
    mass, viscous = np.zeros((moving, moving)), np.zeros((total, total))
    rows: list[Floats] = []
    for air, start, size in zip(airs, starts.T, sizes.T, strict=True):
        at = np.concatenate([np.arange(k), *(np.arange(a, a + n) for a, n in zip(start, size, strict=True))])
        at = at.astype(np.int64)
        own = at[: len(air.mass)]
        mass[np.ix_(own, own)] += air.mass
        viscous[np.ix_(at, at)] += air.viscous
        row = np.zeros((len(air.compression), moving))
        row[:, own] = air.compression
        rows.append(row)
    return CavityAir(
        frequency_hz=np.sort(np.concatenate([air.frequency_hz for air in airs])),
        compression=np.concatenate(rows),
        mass=mass,
        face=int(sizes[0].sum()),
        loose=int(sizes[2].sum()),
        viscous=viscous,
        frames=int(sizes[3].sum()),
        complete_below_hz=min(air.complete_below_hz for air in airs),
    )
