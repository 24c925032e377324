"""Pressure in the room below (or above) a moving surface, in time and frequency.

One-way: the velocity of the ceiling is given. The answer is then exact, whatever moved it; whether the air pushes
back on the structure is another question, to which `room.air_stiffness_ratio` gives the scale.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass
from functools import cached_property, lru_cache
from math import erfc, inf, log
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acoustics.arrays import Complexes, Floats, Integers
from acoustics.receivers import Receiver, positions
from acoustics.room_response import RoomResponse
from acoustics.rooms.box import (
    ENOUGH,
    SEEN,
    Box,
    audible,
    cosines,
    horizontal_wavenumber,
    motion_products,
    order_blocks,
    order_grid,
    orders_not_in,
    overlaps,
    project,
    refuse_off_ceiling,
    refuse_outside,
    transfer,
    undriven,
    wavenumber_squared,
)
from acoustics.rooms.room_advice import non_causal_advice, source_advice, truncation
from acoustics.source import SurfaceShapes, SurfaceVelocity, refuse_unlike

# ----------------------------------------------------------------------------------------------------------------------
# From the rates of a ceiling's modes to the pressure at places of the room, at any complex frequencies.
# ----------------------------------------------------------------------------------------------------------------------

LINES: Final = 64  # handled at once
MOST: Final = 4.0  # of the fastest wave's wavenumber, where places are at the ceiling
LEAST: Final = 1e-2  # of an evanescent wave's pressure at the ceiling that reaches the highest place


def room_transfers(room: Box, surface: SurfaceShapes, places: Floats, s: Complexes) -> Complexes:
    """Pressure over modal rate [r, k, nf] at places [r, 3] of modes of the ceiling, at complex frequencies s [nf].

    Notes
    -----
    Cosines that propagate at a frequency, or whose wave falls to no less than 1/100 on its way down to the highest
    place: levels of third octaves are right to 0.05 dB. `pressures` looks for all.
    """
    heights, plane = np.unique(places[:, 2], return_inverse=True)
    nearest = float(room.size[2] - heights.max())
    wave = np.sqrt(np.abs(wavenumber_squared(room.losses, room.air, s)))
    reach = np.minimum(np.hypot(wave, -log(LEAST) / nearest if nearest > 0 else inf), MOST * wave.max())
    orders = order_grid(*(int(reach.max() * length / np.pi) + 1 for length in room.size[:2].tolist()))
    k_lm = horizontal_wavenumber(room, orders)
    order = np.argsort(k_lm, kind="stable")
    orders, k_lm = orders[order], k_lm[order]
    factor = np.where(orders > 0, 2.0, 1.0).prod(axis=1) / room.ceiling_area
    coefficients = factor[:, None] * overlaps(room, orders, surface.points, surface.weights[:, None] * surface.shapes)
    mix = cosines(room, orders, places)
    found = np.zeros((len(places), surface.shapes.shape[1], len(s)), dtype=np.complex128)
    for start in range(0, len(s), LINES):
        lines = slice(start, start + LINES)
        near = int(np.searchsorted(k_lm, reach[lines].max(), side="right"))
        transfers = transfer(room, s[lines], k_lm[:near], heights)
        for row, height in enumerate(plane):
            shares = (coefficients[:near] * mix[row, :near, None]).T
            found[row, :, lines] = (shares @ transfers[height].view(np.float64)).view(np.complex128)
    return found


# ----------------------------------------------------------------------------------------------------------------------
# What a velocity does after its record ends: the part that a discrete Fourier transform invents if nobody says.
# ----------------------------------------------------------------------------------------------------------------------

PADDING: Final = 1.5  # length of the transform over that of the record
FADE: Final = 0.8  # share of half the sampling from which a spectrum is faded out
_FLANK: Final = 5.0  # half the width of the Gaussian flank: 8e-13 is left of it at either end
WINDOW: Final = 13.5  # a T: wrap-around is exp(-a T PADDING) = 2e-9, rounding is amplified by exp(a T) to 2e-10


def transform_axis(nt: int, dt: float, *, damped: bool = True) -> tuple[Complexes, Floats]:
    """Complex frequencies s [nf] [1/s] and weights [length] of the transform of a record of `nt` samples.

    Parameters
    ----------
    damped : bool
        S = a + j omega, the record weighted with exp(-a t), a T = 13.5; otherwise s = j omega and weights of 1.
    """
    length = fast_length(int(np.ceil(PADDING * nt)))
    decay = WINDOW / (nt * dt) if damped else 0.0
    s = np.asarray(decay + 2j * np.pi * np.fft.rfftfreq(length, dt), dtype=np.complex128)
    return s, np.exp(-decay * dt * np.arange(length))


@lru_cache(maxsize=256)  # it is asked for every band of every record
def fast_length(n: int) -> int:
    """Smallest even number >= `n` without prime factors above 5, at which Fourier transforms are fast.

    >>> fast_length(192000), fast_length(97)
    (192000, 100)
    """
    odd: list[int] = [3**j * 5**k for j in range(20) for k in range(14)]
    return min(part << max(1, (-(-n // part) - 1).bit_length()) for part in odd)


def band_end(nf: int) -> Floats:
    """Weights [nf] of a spectrum from 0 to half the sampling: 1, from 0.8 of it down to 0 as half a cosine.

    Notes
    -----
    A spectrum that is cut at half the sampling is heard before its cause, as sin(x)/x; wrapped around to the end of
    the record that is amplified by exp(a T), to more than the sound itself where the sampling is coarse.
    """
    above = np.clip((np.arange(nf) / (nf - 1) - FADE) / (1 - FADE), 0, 1)
    return np.asarray(0.5 * (1 + np.cos(np.pi * above)))


def band_cut(frequency_hz: Floats, up_to_hz: float) -> Floats:
    """Weights [nf] of a spectrum that is not wanted above a frequency: 1 to a third octave beyond it, 0 an octave on.

    Notes
    -----
    As the integral of a Gaussian, whose transform is over within some periods of `up_to_hz`: a fade with corners rings
    for the whole record, which is amplified by exp(a T).
    """
    low, high = up_to_hz * 10**0.1, 2 * up_to_hz * 10**0.1
    flank = _FLANK * (2 * (frequency_hz - low) / (high - low) - 1)
    return 0.5 * np.array([erfc(place) for place in flank.tolist()])


def extend_to_rest(velocity: Floats, length: int) -> Floats:
    """`velocity` [n, nt] continued to `length` samples and brought smoothly to rest there.

    Notes
    -----
    Reflected about its last sample, so that value and slope go on, and faded out by half a cosine. A causal room
    cannot hear it within the record; a jump to zero would ring, through the band limit, back into the last 5 %.
    """
    nt = velocity.shape[1]
    tail = min(nt - 1, length - nt - 1)
    fade = 0.5 * (1 + np.cos(np.pi * np.arange(1, tail + 1) / (tail + 1)))
    mirrored = 2 * velocity[:, -1:] - velocity[:, -2 : -2 - tail : -1]
    whole = np.zeros((len(velocity), length))
    whole[:, :nt] = velocity
    whole[:, nt : nt + tail] = mirrored * fade
    return whole


def extend_and_return(velocity: Floats, length: int) -> Floats:
    """`extend_to_rest`, with a smooth pulse in the padding that brings the displacement back to where it started."""
    whole = extend_to_rest(velocity, length)
    nt = velocity.shape[1]
    pulse = 1 - np.cos(2 * np.pi * np.arange(length - nt) / (length - nt))
    whole[:, nt:] -= np.outer(whole.sum(axis=1), pulse / pulse.sum())
    return whole


def fade_out(p: Floats, samples: int) -> Floats:
    """`p` [nt] and after it its last value, fading to zero as half a cosine over `samples`."""
    return np.concatenate([p, p[-1] * 0.5 * (1 + np.cos(np.pi * np.arange(1, samples + 1) / (samples + 1)))])


def source_bandwidth(velocity: Floats, dt: float) -> float:
    """Frequency [Hz] below which all but 1e-6 of the energy of the velocities [n, nt] lies."""
    length = fast_length(2 * velocity.shape[1])
    energy = (np.abs(np.fft.rfft(extend_to_rest(velocity, length), axis=1)) ** 2).sum(axis=0)
    total = np.cumsum(energy)
    highest = int(np.searchsorted(total, (1 - 1e-6) * total[-1])) if total[-1] > 0 else 0
    return float(np.fft.rfftfreq(length, dt)[highest])


# ----------------------------------------------------------------------------------------------------------------------
# The sound at many places, kept as few histories of cosines until the end: one product of matrices a height.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Plane:
    """The sound at the receivers of one height so far: histories [n_here, nt], those of cosines not yet mixed.

    rows : which of all receivers. places : theirs [n_here, 3] [m]. own : a part of their sound, None for nothing.
    mixes, histories : the other parts, each mix [n_here, n] times histories [n, nt] of cosines. Where cosines are
        fewer than listeners they are mixed only once, at the end: a thousand histories are too much to be added up
        again and again.
    """

    rows: Integers
    places: Floats
    own: Floats | None = None
    mixes: tuple[Floats, ...] = ()
    histories: tuple[Floats, ...] = ()


Histories = tuple[Plane, ...]  # at all heights, from the lowest


def silence(places: Floats) -> Histories:
    """Receivers at places [n, 3] [m] by their heights, without sound yet."""
    heights, plane = np.unique(places[:, 2], return_inverse=True)
    rows = [np.flatnonzero(plane == number) for number in range(len(heights))]
    return tuple(Plane(here, places[here]) for here in rows)


def add_histories(plane: Plane, mix: Floats | None, history: Floats) -> Plane:
    """With histories [n, nt] of cosines, mixed by mix [n_here, n]; of the listeners themselves where it is None."""
    if mix is None:
        own = history if plane.own is None else plane.own + history
        return Plane(plane.rows, plane.places, own, plane.mixes, plane.histories)
    return Plane(plane.rows, plane.places, plane.own, (*plane.mixes, mix), (*plane.histories, history))


def energies(histories: Histories) -> Floats:
    """Energy at every listener [n], sums of squares."""
    energy = np.zeros(sum(len(plane.rows) for plane in histories))
    for plane in histories:
        if plane.own is None and plane.mixes:
            energy[plane.rows] = energy_of(np.hstack(plane.mixes), np.vstack(plane.histories))
        elif plane.own is not None:
            energy[plane.rows] = energy_of(None, _mixed(plane, plane.own.shape[1]))
    return energy


def pressure_of(histories: Histories, nt: int) -> Floats:
    """Pressure at every listener [n, nt], read-only."""
    wholes = [_mixed(plane, nt) for plane in histories]
    p = wholes[0]
    if len(wholes) > 1:
        p = np.empty((sum(map(len, wholes)), nt))
        for plane, whole in zip(histories, wholes, strict=True):
            p[plane.rows] = whole
    p.flags.writeable = False
    return p


def _mixed(plane: Plane, nt: int) -> Floats:
    if not plane.mixes:
        return np.zeros((len(plane.rows), nt)) if plane.own is None else plane.own
    mixed: Floats = np.hstack(plane.mixes) @ np.vstack(plane.histories)
    if plane.own is not None:
        mixed += plane.own
    return mixed


def energy_of(mix: Floats | None, history: Floats) -> Floats:
    """Sums of squares [n_here] of mix @ history, by the products of the histories; of histories where mix is None.

    From about 16,000 samples at least, which tell well enough.
    """
    every = max(1, history.shape[1] // SEEN)
    history = history[:, ::every]
    if mix is None:
        return np.asarray(every * np.einsum("rt,rt->r", history, history))
    mix = mix * np.sqrt(every)
    energy: Floats = np.einsum("rn,rn->r", mix @ (history @ history.T), mix)
    return energy.clip(0.0)


# ----------------------------------------------------------------------------------------------------------------------
# Pressure in the room below (or above) a moving surface, in time and frequency.
# ----------------------------------------------------------------------------------------------------------------------

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

    Parameters
    ----------
    orders : int | None
        Cosines l, m = 0 .. orders - 1 of the ceiling in both directions; None: those of the source's band, and then
        more until the last ones add less than 1e-4 of the pressure (rms, at the worst receiver).

    Returns
    -------
    RoomResponse
        RoomResponse; its findings say whether the orders, the sampling, the decay of the record and the losses allow
        the result to be trusted.

    Raises
    ------
    AcousticsError
        Points off the ceiling, a receiver outside the room, no receivers, orders below 1.

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

    Examples
    --------
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

    Parameters
    ----------
    surfaces : Sequence[SurfaceVelocity]
        Of the same points, weights, shapes and sampling; they differ in their rates.
    up_to_hz : float
        The highest frequency of interest; what lies more than a third octave above it fades within an octave.

    Raises
    ------
    AcousticsError
        As `pressure` does, and for no surface or surfaces that differ.
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
    refuse_unlike(surfaces)
    refuse_off_ceiling(surfaces[0], room)
    places = positions(receivers)
    for receiver in receivers:
        refuse_outside(room, f"receiver {receiver.name}", receiver.position[None, :])
    first = surfaces[0]
    broad = project(first, room, order_grid(2, 2))
    highest_hz = [source_bandwidth(broad @ surface.rates, surface.dt) for surface in surfaces]
    top = min(max(highest_hz), 2 * up_to_hz)
    products = [motion_products(surface) for surface in surfaces] if orders is None else []
    motion = _motion(surfaces, room, up_to_hz)
    sums = [silence(places) for _ in surfaces]
    done, shares = np.zeros((0, 2), dtype=np.int64), [0.0] * len(surfaces)
    blocks = []
    for block in order_blocks(room, orders, top):
        new = orders_not_in(block, done)
        coefficients = project(first, room, new)
        chosen = _driven(surfaces, coefficients)
        if orders is None and len(done):
            chosen &= audible(coefficients, products, room, new, [energies(histories).min() for histories in sums])
        complete = orders is None or len(done) + len(new) == orders**2  # of fewer cosines than asked for nobody hears
        sums, shares = _with_cosines(motion, room, new[chosen], coefficients[chosen], sums, complete)
        done = np.concatenate([done, new])
        blocks.append(new[chosen])
        more = len(done) > len(new) and max(shares) < ENOUGH
        if orders is None and more and undriven(surfaces, room, done, top):
            break
    found = []
    for surface, histories, share, highest in zip(surfaces, sums, shares, highest_hz, strict=True):
        findings = (*source_advice(surface, room, done, highest), *truncation(share, done), *non_causal_advice(room))
        found.append(RoomResponse(tuple(receivers), surface.t, pressure_of(histories, len(surface.t)), findings))
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
    passband = band_end(len(s))
    if up_to_hz < inf:
        passband *= band_cut(s.imag / (2 * np.pi), up_to_hz)
    spectra, displaced = [], []
    largest = np.abs(first.shapes).max(axis=0, initial=0)
    size = np.zeros(len(s))
    for surface in surfaces:
        future = (
            extend_to_rest(surface.rates, len(weight)) if weighted else extend_and_return(surface.rates, len(weight))
        )
        if weighted:
            future *= weight
        else:
            steps = future * first.dt
            displaced.append((np.cumsum(steps, axis=1) - 0.5 * steps).sum(axis=1))
        spectrum = np.fft.rfft(future, axis=1).astype(np.complex128, copy=False)
        if weighted:
            spectrum *= passband
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
    motion: _Motion, room: Box, orders: Integers, coefficients: Floats, sums: Sequence[Histories], complete: bool
) -> tuple[list[Histories], list[float]]:
    """The sound of every motion with what the cosines `orders` of the ceiling make, and their shares of it.

    Parameters
    ----------
    coefficients : Floats [n, k]
        Of the modes in the cosines.
    complete : bool
        Whether the shares are wanted; 0 where not.
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
        for number, (histories, energy, parts) in enumerate(zip(sums, made, found, strict=True)):
            planes = []
            for plane, part, mix in zip(histories, parts, mixes, strict=True):
                history = np.fft.irfft(part, length, axis=1)[:, :nt] / motion.weight[:nt]
                shared = None if _few(mix) else mix
                planes.append(add_histories(plane, shared, history))
                if complete:
                    energy[plane.rows] += energy_of(shared, history)
            sums[number] = tuple(planes)
    return sums, [
        _worst_share(part, energies(histories)) if complete else 0.0 for part, histories in zip(made, sums, strict=True)
    ]


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

    Parameters
    ----------
    orders : Integers [n, 2]
        By rising wavenumber.
    coefficients : Floats [n, k]
        Of the modes in them.
    mixes : list[Floats]
        Share [n_here, n] of each cosine at the listeners of each height.

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
            transfers = transfer(room, motion.s[band], own_k, heights)
            for own, spectra in zip(parts, motion.spectra, strict=True):
                driving = (coefficients[tile] @ spectra[:, band].view(np.float64)).view(np.complex128)
                for height, at_height in enumerate(transfers):
                    driven, mix = at_height * driving, mixes[height]
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


# ----------------------------------------------------------------------------------------------------------------------
# A room's transfer from the modes of its ceiling to its listeners, which a next motion of that ceiling takes again.
# ----------------------------------------------------------------------------------------------------------------------

_KEPT_TILE: Final = 256  # cosines handled at once
_KEPT_BLOCK: Final = 1 << 15  # complex numbers handled at once: they stay in the cache
_LEAST_WEIGHT: Final = 1e-12  # weight of a line from which on it is left out


@dataclass(frozen=True, eq=False)
class RoomTransfer:
    """From the rates of a ceiling's modes to the pressures at receivers of a room, on the lines of one record.

    surface : the first of the motions whose cosines were searched for. blocks : the cosines [n, 2] that were evaluated,
    block by block. orders [m, 2] : all that were looked at.
    """

    room: Box
    receivers: tuple[Receiver, ...]
    surface: SurfaceVelocity
    up_to_hz: float
    blocks: tuple[Integers, ...]
    orders: Integers

    @cached_property
    def transfers(self) -> tuple[Complexes, Complexes]:
        """Pressure over modal rate [r, k, nf], of all cosines and of those added last, weighted for the record's
        transform."""
        before, last = (
            _transfers_of_orders(self, block) for block in (np.concatenate(self.blocks[:-1]), self.blocks[-1])
        )
        return before + last, last

    def prepare(self) -> None:
        """Find the ways now."""
        _ = self.transfers

    @property
    def per_rate(self) -> Complexes:
        """Pressure over modal rate [r, k, nf] on the first of the lines `transform_axis` gives for the record."""
        return self.transfers[0]

    def of(self, surface: SurfaceVelocity, room: object, receivers: Sequence[Receiver], up_to_hz: float) -> bool:
        """Whether a motion is one of this ceiling in this room, in a record of the same length and sampling."""
        mine = self.surface
        words = ("points", "weights", "shapes")
        return (
            isinstance(room, Box)
            and (up_to_hz, _values(room)) == (self.up_to_hz, _values(self.room))
            and [one.name for one in receivers] == [one.name for one in self.receivers]
            and np.array_equal(positions(receivers), positions(self.receivers))
            and (mine.rates.shape, mine.dt) == (surface.rates.shape, surface.dt)
            and all(np.array_equal(getattr(mine, word), getattr(surface, word)) for word in words)
        )

    def pressures(self, surfaces: Sequence[SurfaceVelocity]) -> list[RoomResponse] | None:
        """Pressures of other motions, to rounding those of the ceiling's cosines; None where they need other cosines.

        Parameters
        ----------
        surfaces : Sequence[SurfaceVelocity]
            Motions of the transfer's own ceiling, see `of`.

        Notes
        -----
        Cosines that were left out as inaudible must be so now, those added last must add no more than they may, and
        none of the motions' band must be missing: the tests of the search that found them.
        """
        refuse_unlike(surfaces)
        first, room, orders, (whole, last) = surfaces[0], self.room, self.orders, self.transfers
        nt = first.rates.shape[1]
        broad = project(first, room, order_grid(2, 2))
        highest_hz = [source_bandwidth(broad @ surface.rates, surface.dt) for surface in surfaces]
        _, weight = transform_axis(nt, first.dt)
        found, quietest = [], []
        for surface, highest in zip(surfaces, highest_hz, strict=True):
            spectra = np.fft.rfft(extend_to_rest(surface.rates, len(weight)) * weight, axis=1)[:, : whole.shape[2]]
            p, share = _receiver_pressure(whole, spectra, weight, nt), _receiver_pressure(last, spectra, weight, nt)
            energy, part = (np.einsum("rt,rt->r", one, one) for one in (p, share))
            worst = float(np.sqrt(np.divide(part, energy, out=np.zeros_like(energy), where=energy > 0).max()))
            if worst >= ENOUGH:
                return None
            quietest.append(float(energy.min()) * len(self.blocks))  # each block left out as much as it may
            findings = (
                *source_advice(surface, room, orders, highest),
                *truncation(worst, orders),
                *non_causal_advice(room),
            )
            found.append(RoomResponse(self.receivers, surface.t, p, findings))
        top = min(max(highest_hz), 2 * self.up_to_hz)
        if not undriven(surfaces, room, orders, top):
            return None
        products, left = (
            [motion_products(surface) for surface in surfaces],
            orders_not_in(orders, np.concatenate(self.blocks)),
        )
        missed = len(left) and audible(project(first, room, left), products, room, left, quietest).any()
        return None if missed else found


def pressures_and_transfer(
    surfaces: Sequence[SurfaceVelocity], room: Box, receivers: Sequence[Receiver], up_to_hz: float = inf
) -> tuple[list[RoomResponse], RoomTransfer | None]:
    """Pressures as `pressures` has them, and the transfer through the cosines they took.

    None for losses of kind ``source``, whose transform has no weighting. Raises AcousticsError as `pressures` does.
    """
    responses, blocks, orders = pressures_and_orders(surfaces, room, receivers, up_to_hz=up_to_hz)
    if room.losses.kind == "source":
        return responses, None
    return responses, RoomTransfer(room, tuple(receivers), surfaces[0], up_to_hz, tuple(blocks), orders)


def _values(room: Box) -> tuple[object, ...]:
    """All that a room is made of, to be compared."""
    return (*room.size.tolist(), *astuple(room.air), *astuple(room.losses))


def _receiver_pressure(transfers: Complexes, spectra: Complexes, weight: Floats, nt: int) -> Floats:
    """Pressures [r, nt] of modal rates with spectra [k, nf]."""
    p = np.fft.irfft(np.einsum("rkf,kf->rf", transfers, spectra), len(weight), axis=1)[:, :nt] / weight[:nt]
    p.flags.writeable = False
    return np.asarray(p)


def _transfers_of_orders(kept: RoomTransfer, orders: Integers) -> Complexes:
    """Pressure over modal rate [r, k, nf] that some cosines make, weighted as spectra of the record are."""
    surface, room, receivers, up_to_hz = kept.surface, kept.room, kept.receivers, kept.up_to_hz
    s, _ = transform_axis(surface.rates.shape[1], surface.dt)
    passband = band_end(len(s)) * (band_cut(s.imag / (2 * np.pi), up_to_hz) if up_to_hz < inf else 1.0)
    nf = int(np.flatnonzero(passband > _LEAST_WEIGHT)[-1]) + 1
    s, places = s[:nf], positions(receivers)
    heights, plane = np.unique(places[:, 2], return_inverse=True)
    found = np.zeros((len(receivers), surface.shapes.shape[1], nf), dtype=np.complex128)
    if not len(orders):
        return found
    orders = orders[np.argsort(horizontal_wavenumber(room, orders), kind="stable")]
    k_lm, coefficients, mix = (
        horizontal_wavenumber(room, orders),
        project(surface, room, orders),
        cosines(room, orders, places),
    )
    nearest = float(room.size[2] - heights.max())
    reach = np.sqrt(np.abs(wavenumber_squared(room.losses, room.air, s)))
    reach = np.hypot(reach, -np.log(LEAST_EVANESCENT) / nearest) if nearest > 0 else np.full(nf, inf)
    for low in range(0, len(orders), _KEPT_TILE):
        tile = slice(low, low + _KEPT_TILE)
        width = max(1, _KEPT_BLOCK // len(k_lm[tile]))
        for start in range(int(np.searchsorted(reach, k_lm[tile][0])), nf, width):
            band = slice(start, min(start + width, nf))
            transfers = transfer(room, s[band], k_lm[tile], heights)
            for row, height in enumerate(plane):
                shares = (coefficients[tile] * mix[row, tile, None]).T
                found[row, :, band] += (shares @ transfers[height].view(np.float64)).view(np.complex128)
    found *= passband[:nf]
    return found
