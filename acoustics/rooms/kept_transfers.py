"""A room's transfer from the modes of its ceiling to its listeners, which a next motion of that ceiling takes again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass
from functools import cached_property
from math import inf
from typing import Final

import numpy as np

from acoustics.arrays import Complexes, Floats, Integers
from acoustics.receivers import Receiver, positions
from acoustics.room_response import RoomResponse
from acoustics.rooms.box import Box
from acoustics.rooms.box_pressure import LEAST_EVANESCENT, pressures_and_orders
from acoustics.rooms.box_transfer import cosines, horizontal_wavenumber, project, transfer, wavenumber_squared
from acoustics.rooms.continuation import band_cut, band_end, extended, source_bandwidth, transform_axis
from acoustics.rooms.cosine_orders import ENOUGH, audible, moved, not_in, square, undriven
from acoustics.rooms.room_advice import one_way, source_advice, truncation
from acoustics.source import SurfaceVelocity, alike

_TILE: Final = 256  # cosines handled at once
_BLOCK: Final = 1 << 15  # complex numbers handled at once: they stay in the cache
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
    def ways(self) -> tuple[Complexes, Complexes]:
        """Pressure over modal rate [r, k, nf], of all cosines and of those added last, weighted for the record's
        transform."""
        before, last = (_ways(self, block) for block in (np.concatenate(self.blocks[:-1]), self.blocks[-1]))
        return before + last, last

    def prepare(self) -> None:
        """Find the ways now."""
        _ = self.ways

    @property
    def per_rate(self) -> Complexes:
        """Pressure over modal rate [r, k, nf] on the first of the lines `transform_axis` gives for the record."""
        return self.ways[0]

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

        surfaces : motions of the transfer's own ceiling, see `of`.

        Notes
        -----
        Cosines that were left out as inaudible must be so now, those added last must add no more than they may, and
        none of the motions' band must be missing: the tests of the search that found them.
        """
        alike(surfaces)
        first, room, orders, (whole, last) = surfaces[0], self.room, self.orders, self.ways
        nt = first.rates.shape[1]
        broad = project(first, room, square(2, 2))
        highest_hz = [source_bandwidth(broad @ surface.rates, surface.dt) for surface in surfaces]
        _, weight = transform_axis(nt, first.dt)
        found, quietest = [], []
        for surface, highest in zip(surfaces, highest_hz, strict=True):
            spectra = np.fft.rfft(extended(surface.rates, len(weight)) * weight, axis=1)[:, : whole.shape[2]]
            p, share = _heard(whole, spectra, weight, nt), _heard(last, spectra, weight, nt)
            energy, part = (np.einsum("rt,rt->r", one, one) for one in (p, share))
            worst = float(np.sqrt(np.divide(part, energy, out=np.zeros_like(energy), where=energy > 0).max()))
            if worst >= ENOUGH:
                return None
            quietest.append(float(energy.min()) * len(self.blocks))  # each block left out as much as it may
            findings = (
                *source_advice(surface, room, orders, highest),
                *truncation(worst, orders),
                *one_way(room),
            )
            found.append(RoomResponse(self.receivers, surface.t, p, findings))
        top = min(max(highest_hz), 2 * self.up_to_hz)
        if not undriven(surfaces, room, orders, top):
            return None
        products, left = [moved(surface) for surface in surfaces], not_in(orders, np.concatenate(self.blocks))
        missed = len(left) and audible(project(first, room, left), products, room, left, quietest).any()
        return None if missed else found


def search(
    surfaces: Sequence[SurfaceVelocity], room: Box, receivers: Sequence[Receiver], up_to_hz: float = inf
) -> tuple[list[RoomResponse], RoomTransfer | None]:
    """Pressures as `acoustics.rooms.box_pressure.pressures` has them, and the transfer through the cosines they took.

    None for losses of kind ``source``, whose transform has no weighting. Raises AcousticsError as `pressures` does.
    """
    responses, blocks, orders = pressures_and_orders(surfaces, room, receivers, up_to_hz=up_to_hz)
    if room.losses.kind == "source":
        return responses, None
    return responses, RoomTransfer(room, tuple(receivers), surfaces[0], up_to_hz, tuple(blocks), orders)


def _values(room: Box) -> tuple[object, ...]:
    """All that a room is made of, to be compared."""
    return (*room.size.tolist(), *astuple(room.air), *astuple(room.losses))


def _heard(ways: Complexes, spectra: Complexes, weight: Floats, nt: int) -> Floats:
    """Pressures [r, nt] of modal rates with spectra [k, nf]."""
    p = np.fft.irfft(np.einsum("rkf,kf->rf", ways, spectra), len(weight), axis=1)[:, :nt] / weight[:nt]
    p.flags.writeable = False
    return np.asarray(p)


def _ways(kept: RoomTransfer, orders: Integers) -> Complexes:
    """Pressure over modal rate [r, k, nf] that some cosines make, weighted as spectra of the record are."""
    surface, room, receivers, up_to_hz = kept.surface, kept.room, kept.receivers, kept.up_to_hz
    s, _ = transform_axis(surface.rates.shape[1], surface.dt)
    wanted = band_end(len(s)) * (band_cut(s.imag / (2 * np.pi), up_to_hz) if up_to_hz < inf else 1.0)
    nf = int(np.flatnonzero(wanted > _LEAST_WEIGHT)[-1]) + 1
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
    for low in range(0, len(orders), _TILE):
        tile = slice(low, low + _TILE)
        width = max(1, _BLOCK // len(k_lm[tile]))
        for start in range(int(np.searchsorted(reach, k_lm[tile][0])), nf, width):
            band = slice(start, min(start + width, nf))
            ways = transfer(room, s[band], k_lm[tile], heights)
            for row, height in enumerate(plane):
                shares = (coefficients[tile] * mix[row, tile, None]).T
                found[row, :, band] += (shares @ ways[height].view(np.float64)).view(np.complex128)
    found *= wanted[:nf]
    return found
