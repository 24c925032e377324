"""Pressure in the room below (or above) a moving surface, in time and frequency.

One-way: the velocity of the ceiling is given. The answer is then exact, whatever moved it; whether the air pushes
back on the structure is another question, to which `room.air_stiffness_ratio` gives the scale.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acoustics.arrays import Complexes, Floats, Integers
from acoustics.receivers import Receiver, positions
from acoustics.room_response import RoomResponse
from acoustics.rooms.box import Box, inside, on_ceiling
from acoustics.rooms.box_transfer import cosines, horizontal_wavenumber, project, transfer, wavenumber_squared
from acoustics.rooms.continuation import band_cut, band_end, extended, returned, source_bandwidth, transform_axis
from acoustics.rooms.cosine_orders import ENOUGH, audible, moved, not_in, order_blocks, square, undriven
from acoustics.rooms.cosine_sums import Heard, added, energies, energy_of, pressure_of, silence
from acoustics.rooms.room_advice import one_way, source_advice, truncation
from acoustics.source import SurfaceVelocity, alike

LEAST_DRIVE: Final = 1e-9  # share of the velocity below which a cosine is not driven: symmetry, but for rounding
NEGLIGIBLE: Final = 1e-9  # share of the summed velocity spectrum above the highest frequency that is evaluated
LEAST_EVANESCENT: Final = (
    1e-9  # of an evanescent wave's pressure at the ceiling, below which it is not evaluated further down
)
_TILE: Final = 512  # cosines handled at once
_BLOCK: Final = 1 << 15  # complex numbers handled at once: they stay in the cache
_MEMORY: Final = 1 << 24  # complex numbers of one batch of cosines


def pressure(
    surface: SurfaceVelocity, room: Box, receivers: Sequence[Receiver], *, orders: int | None = None
) -> RoomResponse:
    """Pressure at the receivers of a rigid-walled room whose ceiling moves with the given velocity.

    orders : cosines l, m = 0 .. orders - 1 of the ceiling in both directions; None: those of the source's band, and
        then more until the last ones add less than 1e-4 of the pressure (rms, at the worst receiver).

    Returns RoomResponse; its findings say whether the orders, the sampling, the decay of the record and the losses
    allow the result to be trusted.
    Raises AcousticsError: points off the ceiling, a receiver outside the room, no receivers, orders below 1.

    Notes
    -----
    The velocity is continued smoothly beyond the record's end T to 1.5 T, where it no longer matters (the room is
    causal), weighted with exp(-a t), a = 13.5 / T, transformed, faded out above 0.8 of half the sampling, multiplied
    with the transfer function at omega - j a, including the bin at zero, transformed back and weighted with exp(a t).
    Against exact modal equations the error is below 1e-6 of the peak for a smooth source and 30 samples in a period of
    its highest frequency. Impacts are not smooth: their peaks are right to 1e-4 then, and to 2e-3 with 10
    (`acoustics.rooms.room_advice`).
    With losses of kind ``source``, which are not analytic off the frequency axis, there is no weighting: the surface
    is returned smoothly to its place during the padding, and the response is not strictly causal.
    One plane of receivers costs a matrix product; each further height z costs the transfer functions again.

    Examples
    --------
    A piston of 1 mm/s for 10 ms compresses the box by 1/10 of a millimetre in 100: rho c^2 / 10^4.

    >>> import numpy as np
    >>> from acoustics import Air, Receiver, Room, SurfaceVelocity, losses_from_beta, pressure
    >>> room = Room([0.58, 0.47, 0.1], Air(c=340, rho=1.29), losses_from_beta(0.0116, 293))
    >>> t = np.arange(4800) / 48e3
    >>> push = np.where(t < 0.02, 1e-3 * (1 - np.cos(2 * np.pi * t / 0.02)) / 2, 0)
    >>> ceiling = SurfaceVelocity([[0.29, 0.235, 0.1]], [0.58 * 0.47], [[1]], [push], dt=1 / 48e3)
    >>> heard = pressure(ceiling, room, [Receiver("mic", [0.29, 0.235, 0.05])], orders=1)
    >>> round(float(heard.p[0, -1]), 2)
    14.91
    """
    return pressures([surface], room, receivers, orders=orders)[0]


def pressures(
    surfaces: Sequence[SurfaceVelocity],
    room: Box,
    receivers: Sequence[Receiver],
    *,
    orders: int | None = None,
    up_to_hz: float = inf,
) -> list[RoomResponse]:
    """Pressure at the receivers for each of several motions of one ceiling: as `pressure` of each, but what the room
    costs, its transfer functions and the cosines of the ceiling, is paid once.

    surfaces : of the same points, weights, shapes and sampling; they differ in their rates.
    up_to_hz : the highest frequency of interest; what lies more than a third octave above it fades within an octave.

    Raises AcousticsError as `pressure` does, and for no surface or surfaces that differ.
    """
    return pressures_and_orders(surfaces, room, receivers, orders=orders, up_to_hz=up_to_hz)[0]


def pressures_and_orders(
    surfaces: Sequence[SurfaceVelocity],
    room: Box,
    receivers: Sequence[Receiver],
    *,
    orders: int | None = None,
    up_to_hz: float = inf,
) -> tuple[list[RoomResponse], list[Integers], Integers]:
    """`pressures`, the cosines [n, 2] that were evaluated for them by blocks, and all that were looked at [m, 2]."""
    alike(surfaces)
    on_ceiling(surfaces[0], room)
    places = positions(receivers)
    for receiver in receivers:
        inside(room, f"receiver {receiver.name}", receiver.position[None, :])
    first = surfaces[0]
    broad = project(first, room, square(2, 2))
    highest_hz = [source_bandwidth(broad @ surface.rates, surface.dt) for surface in surfaces]
    top = min(max(highest_hz), 2 * up_to_hz)
    products = [moved(surface) for surface in surfaces] if orders is None else []
    motion = _motion(surfaces, room, up_to_hz)
    sums = [silence(places) for _ in surfaces]
    done, shares = np.zeros((0, 2), dtype=np.int64), [0.0] * len(surfaces)
    blocks = []
    for block in order_blocks(room, orders, top):
        new = not_in(block, done)
        coefficients = project(first, room, new)
        chosen = _driven(surfaces, coefficients)
        if orders is None and len(done):
            chosen &= audible(coefficients, products, room, new, [energies(heard).min() for heard in sums])
        told = orders is None or len(done) + len(new) == orders**2  # of fewer cosines than asked for nobody hears
        sums, shares = _with_cosines(motion, room, new[chosen], coefficients[chosen], sums, told)
        done = np.concatenate([done, new])
        blocks.append(new[chosen])
        more = len(done) > len(new) and max(shares) < ENOUGH
        if orders is None and more and undriven(surfaces, room, done, top):
            break
    found = []
    for surface, heard, share, highest in zip(surfaces, sums, shares, highest_hz, strict=True):
        findings = (*source_advice(surface, room, done, highest), *truncation(share, done), *one_way(room))
        found.append(RoomResponse(tuple(receivers), surface.t, pressure_of(heard, len(surface.t)), findings))
    return found, blocks, done


@dataclass(frozen=True, eq=False)
class _Motion:
    """Motions of one ceiling of nt samples in frequency: s [nf] and weights [length] of the transform, the spectra
    [k, nf] of each one's rates up to the last frequency that carries anything, and where s lies on the frequency axis
    the sums over the samples of each one's displacements [k], else none."""

    nt: int
    s: Complexes
    weight: Floats
    spectra: tuple[Complexes, ...]
    displaced: tuple[Floats, ...]


def _motion(surfaces: Sequence[SurfaceVelocity], room: Box, up_to_hz: float) -> _Motion:
    """The rates, continued beyond their end and transformed once for all cosines, up to the frequencies wanted."""
    first = surfaces[0]
    weighted = room.losses.kind != "source"
    s, weight = transform_axis(first.rates.shape[1], first.dt, damped=weighted)
    wanted = band_end(len(s))
    if up_to_hz < inf:
        wanted *= band_cut(s.imag / (2 * np.pi), up_to_hz)
    spectra, displaced = [], []
    largest = np.abs(first.shapes).max(axis=0, initial=0)
    size = np.zeros(len(s))
    for surface in surfaces:
        future = extended(surface.rates, len(weight)) if weighted else returned(surface.rates, len(weight))
        if weighted:
            future *= weight
        else:
            steps = future * first.dt
            displaced.append((np.cumsum(steps, axis=1) - 0.5 * steps).sum(axis=1))
        spectrum = np.fft.rfft(future, axis=1).astype(np.complex128, copy=False)
        if weighted:
            spectrum *= wanted
        size += (largest[:, None] * np.abs(spectrum)).max(axis=0, initial=0)
        spectra.append(spectrum)
    above = np.cumsum(size[::-1])[::-1]
    last = int(np.count_nonzero(above > NEGLIGIBLE * above[0]))
    return _Motion(first.rates.shape[1], s, weight, tuple(one[:, :last] for one in spectra), tuple(displaced))


def _driven(surfaces: Sequence[SurfaceVelocity], coefficients: Floats) -> NDArray[np.bool_]:
    """Which cosines, of coefficients [n, k], any of the motions drives by more than rounding."""
    driven = np.zeros(len(coefficients), dtype=bool)
    for surface in surfaces:
        speed = np.abs(coefficients) @ surface.sizes
        driven |= speed > LEAST_DRIVE * (np.abs(surface.shapes).max(axis=0, initial=0) @ surface.sizes)
    return driven


def _with_cosines(
    motion: _Motion, room: Box, orders: Integers, coefficients: Floats, sums: Sequence[Heard], told: bool
) -> tuple[list[Heard], list[float]]:
    """The sound of every motion with what the cosines `orders` of the ceiling make, and their shares of it.

    coefficients [n, k] : of the modes in the cosines. told : whether the shares are wanted; 0 where not.
    """
    length, nt = len(motion.weight), motion.nt
    inwards = np.argsort(horizontal_wavenumber(room, orders), kind="stable")
    orders, coefficients = orders[inwards], coefficients[inwards]
    places = [plane.places for plane in sums[0]]
    heights = np.array([there[0, 2] for there in places])
    batch = max(1, _MEMORY // (len(motion.s) * max(1, len(heights)) * len(sums)))
    if max(map(len, places)) < batch:
        batch = max(1, len(orders))  # few listeners: no spectrum of a cosine is kept
    sums = list(sums)
    made = [np.zeros(sum(map(len, places))) for _ in sums]  # energies of what is added
    for start in range(0, len(orders), batch):
        chosen = orders[start : start + batch]
        mixes = [cosines(room, chosen, there) for there in places]
        found = _through(motion, room, chosen, coefficients[start : start + batch], heights, mixes)
        for number, (heard, energy, parts) in enumerate(zip(sums, made, found, strict=True)):
            planes = []
            for plane, part, mix in zip(heard, parts, mixes, strict=True):
                history = np.fft.irfft(part, length, axis=1)[:, :nt] / motion.weight[:nt]
                shared = None if _few(mix) else mix
                planes.append(added(plane, shared, history))
                if told:
                    energy[plane.rows] += energy_of(shared, history)
            sums[number] = tuple(planes)
    return sums, [_worst_share(part, energies(heard)) if told else 0.0 for part, heard in zip(made, sums, strict=True)]


def _worst_share(of_part: Floats, of_all: Floats) -> float:
    """Largest ratio over the receivers of the rms of a part to that of all, from their energies."""
    return float(np.sqrt(np.divide(of_part, of_all, out=np.zeros_like(of_all), where=of_all > 0).max()))


def _few(mix: Floats) -> bool:
    """Whether there are fewer listeners [n_here, n] than cosines: then the cosines are summed before they are
    transformed."""
    return len(mix) < int(mix.shape[1])


def _through(
    motion: _Motion, room: Box, orders: Integers, coefficients: Floats, heights: Floats, mixes: list[Floats]
) -> list[list[Complexes]]:
    """Pressure spectra by motion and height, up to the last frequency that carries anything: [n_here, nf] of the
    listeners there where they are few, [n, nf] of the cosines elsewhere.

    orders [n, 2] : by rising wavenumber. coefficients [n, k] : of the modes in them. mixes : share [n_here, n] of each
        cosine at the listeners of each height.

    Notes
    -----
    On the frequency axis the transfer of the uniform cosine is infinite at 0; the displacement takes the velocity's
    place there. Cosines are left out where they have decayed to LEAST_EVANESCENT of their pressure on the way to the
    highest receiver.
    """
    nf = len(motion.s)
    parts = [[np.zeros((min(mix.shape), nf), dtype=np.complex128) for mix in mixes] for _ in motion.spectra]
    k_lm = horizontal_wavenumber(room, orders)
    last = motion.spectra[0].shape[1]
    nearest = float(room.size[2] - heights.max())
    spreading = np.sqrt(np.abs(wavenumber_squared(room.losses, room.air, motion.s[:last])))
    for low in range(0, len(orders), _TILE):
        tile = slice(low, low + _TILE)
        own_k = k_lm[tile]
        reach = np.hypot(spreading, -np.log(LEAST_EVANESCENT) / nearest) if nearest > 0 else np.full(last, np.inf)
        begin = max(1 if motion.displaced else 0, int(np.searchsorted(reach, own_k[0])))
        width = max(1, _BLOCK // len(own_k))
        for start in range(begin, last, width):
            band = slice(start, min(start + width, last))
            ways = transfer(room, motion.s[band], own_k, heights)
            for own, spectra in zip(parts, motion.spectra, strict=True):
                driving = (coefficients[tile] @ spectra[:, band].view(np.float64)).view(np.complex128)
                for height, way in enumerate(ways):
                    driven, mix = way * driving, mixes[height]
                    if _few(mix):
                        own[height][:, band] += (mix[:, tile] @ driven.view(np.float64)).view(np.complex128)
                    else:
                        own[height][tile, band] = driven
    for own, displaced in zip(parts, motion.displaced, strict=False):
        compression = room.air.bulk_modulus / room.size[2] * ((1 - 1j * room.losses.beta) ** -2).real
        for part, mix in zip(own, mixes, strict=True):
            still = np.where(k_lm == 0, compression * (coefficients @ displaced), 0)
            part[:, 0] = mix @ still if _few(mix) else still
    return parts
