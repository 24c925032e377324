"""Pressure in the room below (or above) a moving surface, in time and frequency.

One-way: the velocity of the ceiling is given. The answer is then exact, whatever moved it; whether the air pushes
back on the structure is another question, to which `room.air_stiffness_ratio` gives the scale.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from acoustics.arrays import Complexes, Floats, Integers, freeze, frozen, positive
from acoustics.cavity import cosines, horizontal_wavenumber, project, transfer
from acoustics.errors import AcousticsError, Advice
from acoustics.extension import extended, fast_length, returned, source_bandwidth
from acoustics.judgement import one_way, source_advice, truncation
from acoustics.room import Receiver, Room, inside, modal_damping_ratio
from acoustics.source import SurfaceVelocity, on_ceiling

PADDING: Final = 1.5  # length of the transform over that of the record
WINDOW: Final = 13.5  # a T: wrap-around is exp(-a T PADDING) = 2e-9, rounding is amplified by exp(a T) to 2e-10
ENOUGH: Final = 1e-4  # share (rms, 0.001 dB) of the last orders in the pressure at which no more are added
SILENT: Final = 1e-9  # share of the velocity below which a cosine is not driven: symmetry, but for rounding
NEGLIGIBLE: Final = 1e-9  # share of the summed velocity spectrum above the highest frequency that is evaluated
FIRST_ORDERS: Final = 3  # cosines l, m to begin with, all of them evaluated
FINER: Final = 0.1  # share of the most driven cosine above which one that is left out keeps the search going
MOST: Final = 40  # orders beyond those of the band that the search for convergence may add
_BLOCK: Final = 1 << 15  # complex numbers handled at once: they stay in the cache
_MEMORY: Final = 1 << 24  # complex numbers of one batch of cosines


@dataclass(frozen=True, eq=False)
class RoomResponse:
    """Pressure at the receivers of a room.

    receivers : who listened, in the order of the rows.
    t : [nt], times from 0, equally spaced [s].
    p : [n_receivers, nt], pressure, positive when compressed [Pa].
    findings : advice on how far to believe it.

    Notes
    -----
    `spectrum` is the finite Fourier transform P(f) = dt rfft(p) [Pa/Hz] of the record as it stands, no window, at
    `frequency_hz` = 0, 1/T, ..., f_s/2. Parseval: sum p^2 dt = df (|P_0|^2 + 2 sum |P_q|^2 + |P_N/2|^2).
    """

    receivers: tuple[Receiver, ...]
    t: Floats
    p: Floats
    findings: tuple[Advice, ...] = ()

    def __post_init__(self) -> None:
        t = frozen("response.t", self.t, (None,))
        if len(t) < 2:
            raise AcousticsError("response.t", got=f"{len(t)} samples", expected="at least 2")
        p = frozen("response.p", self.p, (len(self.receivers), len(t)))
        freeze(self, t=t, p=p, receivers=tuple(self.receivers), findings=tuple(self.findings))

    @property
    def dt(self) -> float:
        """Sampling interval [s]."""
        return float((self.t[-1] - self.t[0]) / (len(self.t) - 1))

    @property
    def frequency_hz(self) -> Floats:
        """Frequencies of the spectrum [nf] [Hz]."""
        return np.asarray(np.fft.rfftfreq(len(self.t), self.dt), dtype=np.float64)

    @property
    def spectrum(self) -> Complexes:
        """Fourier transform of the pressure [n_receivers, nf] [Pa/Hz], made anew at each call."""
        return self.dt * np.fft.rfft(self.p, axis=1)


def pressure(
    surface: SurfaceVelocity, room: Room, receivers: Sequence[Receiver], *, orders: int | None = None
) -> RoomResponse:
    """Pressure at the receivers of a rigid-walled room whose ceiling moves with the given velocity.

    orders : cosines l, m = 0 .. orders - 1 of the ceiling in both directions; None: those of the source's band, and
        then more until the last ones add less than 1e-4 of the pressure (rms, at the worst receiver).

    Returns RoomResponse; its findings say whether the orders, the sampling, the decay of the record and the losses
    allow the result to be believed.
    Raises AcousticsError: points off the ceiling, a receiver outside the room, no receivers, orders below 1.

    Notes
    -----
    The velocity is continued smoothly beyond the record's end T to 1.5 T, where it no longer matters (the room is
    causal), weighted with exp(-a t), a = 13.5 / T, transformed, multiplied with the transfer function at omega - j a,
    including the bin at zero, transformed back and weighted with exp(a t). Against exact modal equations the error
    is below 1e-6 of the peak where the sampling rate is 30 times the source's highest frequency.
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
    on_ceiling(surface, room)
    if not receivers:
        raise AcousticsError("receivers", got="none", expected="at least one", do="name a place to listen")
    places = np.stack([receiver.position for receiver in receivers])
    for receiver in receivers:
        inside(room, f"receiver {receiver.name}", receiver.position[None, :])
    highest_hz = source_bandwidth(project(surface, room, _square(2, 2)) @ surface.rates, surface.dt)
    p = np.zeros((len(receivers), surface.rates.shape[1]))
    done, share = np.zeros((0, 2), dtype=np.int64), 0.0
    for block in _order_blocks(room, orders, highest_hz):
        new = _not_in(block, done)
        audible = new if orders is not None or not len(done) else _audible(surface, room, new, p)
        part = _synthesise(surface, room, audible, places)
        p += part
        done = np.concatenate([done, new])
        share = _worst_share(part, p)
        if orders is None and len(done) > len(new) and share < ENOUGH and _undriven(surface, room, done, highest_hz):
            break
    findings = (
        *source_advice(surface, room, done, highest_hz),
        *truncation(share, done),
        *one_way(room),
    )
    p.flags.writeable = False
    return RoomResponse(tuple(receivers), surface.t, p, findings)


@dataclass(frozen=True, eq=False)
class PressureMap:
    """Pressure on a plane of the room, for pictures.

    normal : axis the plane is normal to, ``x``, ``y`` or ``z``.
    first, second : [n1], [n2], coordinates along the two other axes, in the order x, y, z [m].
    frequency_hz : [nf].
    spectrum : [nf, n1, n2], Fourier transform of the pressure [Pa/Hz].
    """

    normal: str
    at: float
    first: Floats
    second: Floats
    frequency_hz: Floats
    spectrum: Complexes

    def __post_init__(self) -> None:
        first = frozen("map.first", self.first, (None,))
        second = frozen("map.second", self.second, (None,))
        frequency_hz = frozen("map.frequency_hz", self.frequency_hz, (None,))
        spectrum = np.array(self.spectrum, dtype=np.complex128)
        if spectrum.shape != (expected := (len(frequency_hz), len(first), len(second))):
            raise AcousticsError("map.spectrum", got=f"shape {spectrum.shape}", expected=f"shape {expected}")
        spectrum.flags.writeable = False
        freeze(self, first=first, second=second, frequency_hz=frequency_hz, spectrum=spectrum)


def pressure_map(
    surface: SurfaceVelocity,
    room: Room,
    frequencies_hz: Sequence[float] | Floats,
    *,
    normal: str = "z",
    at: float,
    divisions: tuple[int, int] = (48, 40),
    orders: int = 24,
) -> PressureMap:
    """Spectrum of the pressure at chosen frequencies on a plane of the room.

    frequencies_hz : [nf], above 0 [Hz].
    normal, at : the plane x, y or z = `at` [m].
    divisions : intervals along the two other axes.

    Raises AcousticsError: a plane outside the room, a frequency not above 0, a room without losses at resonance.

    Notes
    -----
    The Fourier transform of the velocity's record times the transfer function at that frequency: what a record long
    enough for the air to fall silent would give, the surface standing still after the record's end. It equals
    `RoomResponse.spectrum` when the record has decayed.
    """
    on_ceiling(surface, room)
    if normal not in ("x", "y", "z"):
        raise AcousticsError("map.normal", got=repr(normal), expected="x, y or z")
    fixed = "xyz".index(normal)
    axes = [axis for axis in range(3) if axis != fixed]
    first, second = (np.linspace(0, room.size[axis], n + 1) for axis, n in zip(axes, divisions, strict=True))
    corner = np.zeros((1, 3))
    corner[0, fixed] = at
    inside(room, "map.at", corner)
    frequency_hz = np.array([positive("map.frequency", float(f), "Hz") for f in frequencies_hz])
    s = 2j * np.pi * frequency_hz
    chosen = _square(orders, orders)
    kernel = surface.dt * np.exp(-np.outer(surface.t, s))
    velocity = project(surface, room, chosen) @ (surface.rates @ kernel)
    heights = np.array([at]) if normal == "z" else second
    with np.errstate(divide="ignore", invalid="ignore"):  # a resonance without losses is refused just below
        parts = np.stack(transfer(room, s, horizontal_wavenumber(room, chosen), heights)) * velocity
    if not np.isfinite(parts).all():
        raise AcousticsError("map.frequency", got="a resonance of a room without losses", expected="losses")
    if normal == "z":
        grid = np.stack(np.meshgrid(first, second, indexing="ij"), axis=-1).reshape(-1, 2)
        spectrum = (cosines(room, chosen, grid) @ parts[0]).T.reshape(-1, len(first), len(second))
    else:
        line = np.zeros((len(first), 2))
        line[:, fixed], line[:, 1 - fixed] = at, first
        spectrum = np.einsum("ic,zcf->fiz", cosines(room, chosen, line), parts, optimize=True)
    return PressureMap(normal, at, first, second, frequency_hz, spectrum)


def _square(n_l: int, n_m: int) -> Integers:
    grid = np.stack(np.meshgrid(np.arange(n_l), np.arange(n_m), indexing="ij"), axis=-1)
    return grid.reshape(-1, 2).astype(np.int64)


def _not_in(block: Integers, done: Integers) -> Integers:
    known = {tuple(pair) for pair in done.tolist()}
    return np.array([pair for pair in block.tolist() if tuple(pair) not in known], dtype=np.int64).reshape(-1, 2)


def _order_blocks(room: Room, orders: int | None, highest_hz: float) -> list[Integers]:
    """Growing sets of cosines; the last two orders, which tell the truncation, are a block of their own."""
    if orders is not None:
        if orders < 1:
            raise AcousticsError("orders", got=str(orders), expected="at least 1")
        return [_square(n, n) for n in sorted({max(1, orders - 2), orders})]
    most = max(_band_orders(room, highest_hz)) + MOST
    return [_square(n, n) for n in range(FIRST_ORDERS, max(most, FIRST_ORDERS + 2) + 1, 2)]


def _band_orders(room: Room, highest_hz: float) -> tuple[int, int]:
    """Cosines that propagate below a frequency, in both directions, and three more."""
    n_l, n_m = (int(np.ceil(2 * length * highest_hz / room.air.c)) + 3 for length in room.size[:2].tolist())
    return n_l, n_m


def _undriven(surface: SurfaceVelocity, room: Room, done: Integers, highest_hz: float) -> bool:
    """Whether no cosine of the source's band that is left out is driven nearly as much as those that are in.

    Blocks that add nothing end the search; a surface that moves in a pattern finer than the last block would end it
    too early.
    """
    left = _not_in(_square(*_band_orders(room, highest_hz)), done)
    speeds = [np.abs(project(surface, room, some)) @ surface.sizes for some in (left, done)]
    return bool(speeds[0].max(initial=0.0) <= FINER * speeds[1].max())


def _audible(surface: SurfaceVelocity, room: Room, orders: Integers, p: Floats) -> Integers:
    """The cosines that could matter: the others, each in resonance all the time, would together stay below ENOUGH.

    Notes
    -----
    A resonance of cosine (l, m) makes no more than rho c^2 v / (Lz zeta omega_lm) of the velocity v; motions that only
    rounding or a mesh without symmetry excites are left out so.
    """
    k_lm = horizontal_wavenumber(room, orders)
    omega = room.air.c * np.where(k_lm > 0, k_lm, np.pi / float(room.size[:2].max()))
    ratio = np.array([modal_damping_ratio(room.losses, w / (2 * np.pi)) for w in omega.tolist()])
    velocity = project(surface, room, orders) @ surface.rates
    loudest = np.sqrt(np.einsum("nt,nt->n", velocity, velocity)) * room.air.bulk_modulus / float(room.size[2])
    bound = np.divide(loudest, ratio * omega, out=np.full_like(loudest, np.inf), where=ratio > 0)
    quiet = np.argsort(bound)
    together = np.sqrt(np.cumsum(bound[quiet] ** 2))
    left_out = quiet[together < ENOUGH * np.sqrt(np.einsum("rt,rt->r", p, p).min())]
    return np.delete(orders, left_out, axis=0)


def _worst_share(part: Floats, p: Floats) -> float:
    """Largest ratio over the receivers of the rms of `part` to that of `p`."""
    of_part, of_all = (np.einsum("rt,rt->r", x, x) for x in (part, p))
    return float(np.sqrt(np.divide(of_part, of_all, out=np.zeros_like(of_all), where=of_all > 0).max()))


def _synthesise(surface: SurfaceVelocity, room: Room, orders: Integers, places: Floats) -> Floats:
    """Pressure [n_places, nt] of the cosines `orders` of the ceiling velocity."""
    nt, dt = surface.rates.shape[1], surface.dt
    coefficients = project(surface, room, orders)
    speed = np.abs(coefficients) @ surface.sizes
    loudest = np.abs(surface.shapes).max(axis=0, initial=0) @ surface.sizes
    driven = speed > SILENT * loudest
    orders, coefficients = orders[driven], coefficients[driven]
    length = fast_length(int(np.ceil(PADDING * nt)))
    weighted = room.losses.kind != "source"
    decay = WINDOW / (nt * dt) if weighted else 0.0
    weight = np.exp(-decay * dt * np.arange(length))
    s = np.asarray(decay + 2j * np.pi * np.fft.rfftfreq(length, dt), dtype=np.complex128)
    heights, plane = np.unique(places[:, 2], return_inverse=True)
    p = np.zeros((len(places), nt))
    batch = max(1, _MEMORY // (len(s) * max(1, len(heights))))
    for start in range(0, len(orders), batch):
        chosen = orders[start : start + batch]
        velocity = coefficients[start : start + batch] @ surface.rates
        future = extended(velocity, length) if weighted else returned(velocity, length, dt)
        spectra = np.fft.rfft(future * weight, axis=1).astype(np.complex128, copy=False)
        parts = _through(room, chosen, s, heights, spectra, None if weighted else future * dt)
        at_places = cosines(room, chosen, places)
        for height, part in enumerate(parts):
            rows = np.flatnonzero(plane == height)
            here = at_places[rows]
            if len(rows) < len(chosen):  # few listeners: sum the cosines first, transform the sums
                p[rows] += np.fft.irfft((here @ part.view(np.float64)).view(np.complex128), length, axis=1)[:, :nt]
            else:
                p[rows] += here @ np.ascontiguousarray(np.fft.irfft(part, length, axis=1)[:, :nt])
    if weighted:
        p /= weight[:nt]
    return p


def _through(
    room: Room, orders: Integers, s: Complexes, heights: Floats, spectra: Complexes, steps: Floats | None
) -> list[Complexes]:
    """Pressure spectra [n, nf] at each height, up to the last frequency that carries anything.

    steps : velocity times dt [n, length] when s lies on the frequency axis, where the transfer of the uniform
        cosine is infinite at 0 and the displacement takes the velocity's place.
    """
    parts = [np.zeros_like(spectra) for _ in heights]
    k_lm = horizontal_wavenumber(room, orders)
    size = np.abs(spectra).max(axis=0)
    above = np.cumsum(size[::-1])[::-1]
    last = int(np.count_nonzero(above > NEGLIGIBLE * above[0]))
    width = max(1, _BLOCK // max(1, len(orders)))
    for start in range(0 if steps is None else 1, last, width):
        band = slice(start, min(start + width, last))
        for part, response in zip(parts, transfer(room, s[band], k_lm, heights), strict=True):
            np.multiply(response, spectra[:, band], out=part[:, band])
    if steps is not None:
        displacement = (np.cumsum(steps, axis=1) - 0.5 * steps).sum(axis=1)
        compression = room.air.bulk_modulus / room.size[2] * ((1 - 1j * room.losses.beta) ** -2).real
        for part in parts:
            part[:, 0] = np.where(k_lm == 0, compression * displacement, 0)
    return parts
