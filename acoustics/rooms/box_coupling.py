"""The air of a closed room as a mechanical system joined to its moving ceiling: two-way coupling.

The ceiling moves by q_i psi_i into the room, P_n are the modes of the room with rigid walls (P_0 = 1, the integral
of P_n P_m is V delta_nm) and L_ni the integral of P_n psi_i over the ceiling. With kappa = rho c^2 / V,

    p_n'' + omega_n^2 p_n = kappa L_n q'',        force of the air on q_i: -sum_n L_ni p_n,

which is not symmetric. With the amplitudes y_n of the displacement along the gradient of P_n, of unit modal mass,

    p_n = kappa L_n q - sqrt(kappa) omega_n y_n,

the energies of the air are |y'|^2 / 2 and |b_0 q|^2 / 2 + |B [q; y]|^2 / 2, B = [sqrt(kappa) L, -diag(omega)] and
b_0 = sqrt(kappa) L_0: symmetric, so that structure and air have real modes. A mode left out follows statically, its
stiffness kappa L_n^T L_n taken up by y_n: what remains of it is the mass kappa L_n^T L_n / omega_n^2. Its stiffness
must not be added; the sum over all modes would not even converge.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from scipy.linalg import block_diag

from acoustics.air import Air
from acoustics.arrays import Floats, Integers, freeze, frozen, positive
from acoustics.errors import AcousticsError
from acoustics.losses import Losses
from acoustics.rooms.box import (
    Box,
    horizontal_wavenumber,
    order_grid,
    orders_not_in,
    overlaps,
    refuse_outside,
    resolved_orders,
    room_modes,
)
from acoustics.source import SurfaceShapes
from acoustics.tags import stored_as

MOST: Final = 300  # cavity modes kept: coordinates cost as much as modes of the structure
SETTLED: Final = 1e-6  # largest mass the last cosines may add to a unit modal mass
BEYOND: Final = 4  # cosines of a block beyond the last one
FINEST: Final = 64  # cosines in one direction at most
NO_END: Final = 1 << 30  # an order that no mode has


@stored_as("leak of a room/1")
@dataclass(frozen=True, eq=False)
class Leak:
    """An opening of the room to still air outside, as a plug of air that moves in it.

    inertance : pressure over volume acceleration [kg/m^4]: rho l / A of an opening of area A and effective length l.
    resistance : pressure over volume velocity [Pa s/m^3].

    Notes
    -----
    The plug's flow is spread over the ceiling: where the opening is makes no difference below the first mode of the
    room, and above it the plug hardly moves.

    >>> Leak(inertance=1.2 * 1.29 * 0.03 / (1e-3 * 2.1)).resistance
    0.0
    """

    inertance: float
    resistance: float = 0.0

    def __post_init__(self) -> None:
        resistance = float(self.resistance)
        if not (np.isfinite(resistance) and resistance >= 0):
            raise AcousticsError("leak.resistance", got=f"{resistance:g} Pa s/m^3", expected="a number >= 0")
        freeze(self, inertance=positive("leak.inertance", self.inertance, "kg/m^4"), resistance=resistance)


@dataclass(frozen=True, eq=False)
class CoupledAir:
    """The air of a room over the coordinates [q; y]: k of its ceiling, n of the cavity modes kept.

    frequency_hz [n] : of the cavity modes kept, ascending, without the uniform one.
    compression [1 + n, k + n] : rows of b_0 and B; the air's potential energy is |compression [q; y]|^2 / 2.
    mass [k + n, k + n] : of the air: unity for y, for q the added mass of the modes left out.
    Walls that yield are coordinates between q and y, with their own mass, and each a last row of compression,
    its spring.
    walls [k + n] : what of the diagonal of `mass` is of walls themselves; zero if left out.
    resisted : whether walls yield with a resistance.
    viscous, hysteretic [k + n, k + n] : damping of the air, as - v . viscous v and, in frequency, + j hysteretic.
    complete_below_hz : no cavity mode is left out below it.
    """

    frequency_hz: Floats
    compression: Floats
    mass: Floats
    viscous: Floats
    hysteretic: Floats
    complete_below_hz: float
    walls: Floats = field(default_factory=lambda: np.zeros(0))
    resisted: bool = False

    def __post_init__(self) -> None:
        frequency_hz = frozen("coupled.frequency_hz", self.frequency_hz, (None,))
        compression = frozen("coupled.compression", self.compression, (None, None))
        square_of = (compression.shape[1], compression.shape[1])
        freeze(
            self,
            frequency_hz=frequency_hz,
            compression=compression,
            mass=frozen("coupled.mass", self.mass, square_of),
            viscous=frozen("coupled.viscous", self.viscous, square_of),
            hysteretic=frozen("coupled.hysteretic", self.hysteretic, square_of),
            walls=frozen("coupled.walls", self.walls if np.size(self.walls) else np.zeros(square_of[0]), square_of[:1]),
        )


def coupled_air(room: Box, surface: SurfaceShapes, up_to_hz: float) -> CoupledAir:
    """The air of a closed room joined to the shapes of its ceiling.

    Parameters
    ----------
    up_to_hz : float
        Cavity modes up to it are kept [Hz], at most the 300 lowest, and none finer than the points resolve; the others
        act as added mass.

    Notes
    -----
    Summed over the vertical orders, the modes of the cosine (l, m) weigh rho coth(k_lm Lz) / k_lm (rho Lz / 3 for the
    uniform cosine, whose mode at 0 Hz is the stiffness b_0); those that are kept are taken off term by term, so that
    the added mass is never negative. Cosines are added until the last ones weigh less than 1e-6 of a modal mass, or
    pass what the points resolve.

    The losses of the room act as in `acoustics.rooms.box_pressure`: Kelvin-Voigt air is tau times its stiffness, a
    constant decay rate 2 gamma times its mass; losses of kind ``source`` are hysteretic, for frequency responses.

    Examples
    --------
    A piston of 29.68 kg on 4.641e5 N/m over a sealed box, all cavity modes as added mass:

    >>> box = Box([0.58, 0.47, 0.1], Air(340, 1.29))
    >>> shape = np.array([[29.68**-0.5]])
    >>> air = coupled_air(box, SurfaceShapes([[0.29, 0.235, 0.1]], [box.ceiling_area], shape), up_to_hz=200.0)
    >>> stiffness, mass = 4.641e5 / 29.68 + air.compression[0, 0] ** 2, 1 + air.mass[0, 0]
    >>> round(float(np.sqrt(stiffness / mass) / (2 * np.pi)), 4)
    27.253
    """
    points = surface.points
    refuse_outside(room, "surface.points", points)
    finest = resolved_orders(room, points).clip(0, FINEST)
    frequency_hz, indices, complete = kept_modes(room, up_to_hz, np.append(finest, NO_END))
    weighted = surface.weights[:, None] * surface.shapes
    flat, place = np.unique(indices[:, :2], axis=0, return_inverse=True)
    integrals = np.sqrt(multiplicity(indices))[:, None] * overlaps(room, flat, points, weighted)[place.ravel()]
    displaced = np.vstack([weighted.sum(axis=0), integrals])
    added = added_mass(room, points, weighted, indices, finest)
    return join_air(room.air, room.losses, room.volume, frequency_hz, displaced, added, complete_below_hz=complete)


def join_air(
    air: Air,
    losses: Losses,
    volume: float,
    frequency_hz: Floats,
    displaced: Floats,
    added: Floats,
    *,
    complete_below_hz: float,
    absorbed: Floats | None = None,
) -> CoupledAir:
    """The air of a room from its modes, however they were found.

    Parameters
    ----------
    volume : float
        Of the room [m^3].
    frequency_hz : Floats [n]
        Of the modes kept, without the uniform one.
    displaced : Floats [1 + n, k]
        Integrals of the modes, the uniform one first, times the shapes over what moves.
    added : Floats [k, k]
        Mass of the modes left out.
    absorbed : Floats | None [n]
        Rate of decay of each mode's energy by what walls absorb [1/s]; None for none.
    """
    n, k = len(frequency_hz), displaced.shape[1]
    compression = np.zeros((1 + n, k + n))
    compression[:, :k] = np.sqrt(air.bulk_modulus / volume) * displaced
    compression[1:, k:] = -np.diag(2 * np.pi * frequency_hz)
    mass = block_diag(added, np.eye(n))
    modulus = (1 - 1j * losses.beta) ** -2  # of the bulk modulus under losses of kind "source"
    compression *= np.sqrt(modulus.real)
    stiffness = compression.T @ compression
    viscous = losses.relaxation_time * stiffness + 2 * losses.decay_rate * mass
    if absorbed is not None:
        viscous[k:, k:] += np.diag(absorbed)
    return CoupledAir(
        frequency_hz=frequency_hz,
        compression=compression,
        mass=mass,
        viscous=viscous,
        hysteretic=modulus.imag / modulus.real * stiffness,
        complete_below_hz=complete_below_hz,
    )


def kept_modes(room: Box, up_to_hz: float, finest: Integers, most: int = MOST) -> tuple[Floats, Integers, float]:
    """Frequencies [n], indices [n, 3] of the cavity modes kept, and the frequency below which none is left out.

    Parameters
    ----------
    finest : Integers [3]
        Highest order along every axis that what moves can tell.

    Notes
    -----
    A room has at least as many modes up to f, the uniform one counted, as cubes of one order fill an octant: 4 pi V
    f^3 / (3 c^3). Where that is more than are kept, no higher ones are made.
    """
    enough = room.air.c * (3 * (most + 2) / (4 * np.pi * room.volume)) ** (1 / 3)
    frequency_hz, indices = room_modes(room, min(positive("up_to_hz", up_to_hz, "Hz"), enough))
    beyond = (np.arange(len(indices)) >= most) | (indices > finest).any(axis=1)
    if not beyond.any():
        return frequency_hz, indices, up_to_hz
    first = float(frequency_hz[beyond.argmax()])
    low = frequency_hz < first * (1 - 1e-9)  # modes of one frequency are kept or left out together
    return frequency_hz[low], indices[low], first


def multiplicity(orders: Integers) -> Floats:
    """Product over the directions of 1 for order 0 and 2 for the others [n]: one over the mean of cos^2."""
    product: Floats = np.where(orders > 0, 2.0, 1.0).prod(axis=1)
    return product


def added_mass(room: Box, points: Floats, weighted: Floats, kept: Integers, finest: Integers) -> Floats:
    """Mass [k, k] of the air in the cavity modes that are not kept, on a ceiling of weighted shapes [p, k]."""
    resolved = [int(order) + 1 for order in finest]
    size = [int(kept[:, axis].max(initial=0)) + 1 for axis in (0, 1)]
    mass = np.zeros((weighted.shape[1], weighted.shape[1]))
    done = np.zeros((0, 2), dtype=np.int64)
    while True:
        new = orders_not_in(order_grid(*size), done)
        integrals = overlaps(room, new, points, weighted)
        factor = room.air.rho / room.ceiling_area * multiplicity(new) * _left_out(room, new, kept)
        part: Floats = (factor[:, None] * integrals).T @ integrals
        mass += part
        done = np.concatenate([done, new])
        settled = len(done) > len(new) and np.diag(part).max(initial=0.0) < SETTLED
        if settled or all(have >= most for have, most in zip(size, resolved, strict=True)):
            return mass
        size = [max(have, min(have + BEYOND, most)) for have, most in zip(size, resolved, strict=True)]


def _left_out(room: Box, orders: Integers, kept: Integers) -> Floats:
    """coth(k Lz) / k of the cosines [n, 2] [m], 0 of which Lz / 3, less the terms of the modes kept [n]."""
    height = float(room.size[2])
    k = horizontal_wavenumber(room, orders)
    uniform = k == 0
    safe = np.where(uniform, 1.0, k)
    whole = np.where(uniform, height / 3, 1 / (safe * np.tanh(safe * height)))
    number = {tuple(pair): i for i, pair in enumerate(orders.tolist())}
    at = np.array([number.get(tuple(index[:2]), -1) for index in kept.tolist()], dtype=np.int64)
    own = kept[at >= 0]
    terms = np.where(own[:, 2] > 0, 2.0, 1.0) / height
    squared = ((own / room.size) ** 2).sum(axis=1) * np.pi**2
    np.subtract.at(whole, at[at >= 0], terms / squared)
    return whole.clip(0.0)
