"""The half space beside a surface in a rigid baffle: Rayleigh's integral, in frequency and in time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Complexes, Floats, freeze, frozen
from acoustics.errors import AcousticsError, Advice
from acoustics.receivers import Receiver, positions
from acoustics.room_response import RoomResponse
from acoustics.rooms.box_pressure import NEGLIGIBLE, PADDING, extend_to_rest, fast_length, source_bandwidth
from acoustics.source import SurfaceShapes, SurfaceVelocity, SurfaceVibration, refuse_unlike

# ----------------------------------------------------------------------------------------------------------------------
# The plane that the half space lies in front of, and its receivers.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Baffle:
    """An infinite plane, rigid except for what moves in it, and the air in front of it.

    normal : [3], unit vector into the air. The plane goes through the origin; so do receivers' coordinates.

    >>> Baffle(normal=[0, 0, -1]).normal.tolist()
    [0.0, 0.0, -1.0]
    """

    air: Air = field(default_factory=Air)
    normal: Floats = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))

    def __post_init__(self) -> None:
        normal = frozen("field.normal", self.normal, (3,))
        if abs(np.linalg.norm(normal) - 1) > 1e-9:
            raise AcousticsError("field.normal", got=f"{normal.tolist()}", expected="a unit vector")
        freeze(self, normal=normal)


def in_front(space: Baffle, receivers: Sequence[Receiver]) -> Floats:
    """Where the receivers are [n, 3] [m].

    Raises AcousticsError: none, or one that is not in front of the plane.
    """
    places = positions(receivers)
    for receiver, height in zip(receivers, places @ space.normal, strict=True):
        if not height > 0:
            raise AcousticsError(
                f"receiver {receiver.name}",
                got=f"{receiver.position.tolist()} m, {-height:g} m behind the surface",
                expected="a point in front of it",
            )
    return places


def on_plane(space: Baffle, points: Floats) -> None:
    off = np.abs(points @ space.normal)
    extent = float(np.ptp(points, axis=0).max())
    if off.max() > 1e-6 * extent:
        raise AcousticsError(
            "surface.points",
            got=f"a point {off.max():g} m off the plane of the baffle",
            expected="a flat surface through the origin",
        )


# ----------------------------------------------------------------------------------------------------------------------
# The half space beside a surface in a rigid baffle.
# ----------------------------------------------------------------------------------------------------------------------

POINTS_PER_WAVE: Final = 6.0  # of the surface, to a wave in air
NEAR: Final = 2.0  # distances between points within which a receiver hears the points one by one
_LINES: Final = 64  # frequencies whose phases are made from one table


def harmonic_field(
    surface: SurfaceVibration, space: Baffle, receivers: Sequence[Receiver]
) -> tuple[Complexes, tuple[Advice, ...]]:
    """Complex pressure [n_receivers, nf] [Pa] in front of a baffled surface that moves with exp(+j omega t).

    With it comes advice on the points and the receivers.

    Raises AcousticsError: a point off the plane, a receiver behind it, none at all.

    Notes
    -----
    Rayleigh's first integral, p = j omega rho / (2 pi) int v exp(-j k R) / R dS, summed over the points.

    A piston of 1 cm^2 and 1 m/s at 100 Hz, heard at 1 m: rho omega Q / (2 pi R):

    >>> piston = SurfaceVibration([[0, 0, 0]], [1e-4], [[1]], [[1]], [100.0])
    >>> heard, _ = harmonic_field(piston, Baffle(), [Receiver("mic", [0, 0, 1])])
    >>> print(f"{abs(heard[0, 0]):.5f} {1.21 * 2 * np.pi * 100 * 1e-4 / (2 * np.pi):.5f}")
    0.01210 0.01210
    """
    on_plane(space, surface.points)
    places = in_front(space, receivers)
    s = np.asarray(2j * np.pi * surface.frequency_hz)
    p = np.empty((len(places), len(s)), dtype=np.complex128)
    for row, place in enumerate(places):
        far = np.linalg.norm(surface.points - place, axis=1)
        kernel = np.exp(-np.outer(s / space.air.c, far))
        sums = kernel @ ((surface.weights / far)[:, None] * surface.shapes)
        p[row] = space.air.rho * s / (2 * np.pi) * (sums * surface.rates.T).sum(axis=1)
    return p, spacing_advice(space, surface.points, surface.weights, places, float(surface.frequency_hz.max()))


def field_loads(
    surface: SurfaceShapes, space: Baffle, source: Receiver, frequency_hz: Floats
) -> tuple[Complexes, tuple[Advice, ...]]:
    """Integrals [k, nf] over a surface in the baffle that is held, of the pressure that a point source in front of it
    makes per volume velocity, times its shapes; and advice as of `harmonic_field`.

    Notes
    -----
    The source and its mirror image behind the baffle: p = 2 j omega rho exp(-j k R) / (4 pi R).

    >>> loads, _ = field_loads(SurfaceShapes([[0, 0, 0]], [1e-4], [[1]]), Baffle(), Receiver("mic", [0, 0, 1]), [100.0])
    >>> print(f"{abs(loads[0, 0]):.5f}")
    0.01210
    """
    on_plane(space, surface.points)
    places = in_front(space, [source])
    hz = np.asarray(frequency_hz, dtype=np.float64)
    wave, far = 2j * np.pi * hz, np.linalg.norm(surface.points - places, axis=1)
    felt = (surface.weights / far)[:, None] * surface.shapes
    loads: Complexes = space.air.rho * wave / (2 * np.pi) * (felt.T @ np.exp(-np.outer(far, wave / space.air.c)))
    return loads, spacing_advice(space, surface.points, surface.weights, places, float(hz.max()))


def field_pressures(
    surfaces: Sequence[SurfaceVelocity], space: Baffle, receivers: Sequence[Receiver]
) -> list[RoomResponse]:
    """Pressure in front of a baffled surface for each of several of its motions.

    Parameters
    ----------
    surfaces : Sequence[SurfaceVelocity]
        Of the same points, weights, shapes and sampling; they differ in their rates. Points on the plane.

    Returns
    -------
    list[RoomResponse]
        RoomResponse of each, the sound's way included: silence for R / c; their findings name points too far apart for
        the highest frequency of the motion, and receivers too near.

    Raises
    ------
    AcousticsError
        As `harmonic_field` does, and for no surface or surfaces that differ.

    Notes
    -----
    By the transform of the motion, brought smoothly to rest after the record's end and followed by silence as long as
    the longest way, so that nothing wraps round. Sound that arrives after the record's end is not heard.

    Examples
    --------
    A piston of 1 cm^2 that speeds up by 1 m/s^2 is heard as rho a S / (2 pi R), later by R / c:

    >>> t = np.arange(2400) / 48e3
    >>> push = np.where(t < 0.02, t - np.sin(2 * np.pi * t / 0.02) * 0.02 / (2 * np.pi), 0.02 + 0 * t)
    >>> piston = SurfaceVelocity(np.zeros((1, 3)), [1e-4], [[1]], [push], dt=1 / 48e3)
    >>> from acoustics.air import Air
    >>> heard = field_pressures([piston], Baffle(Air(343, 1.21)), [Receiver("mic", [0, 0, 3.43])])[0].p[0]
    >>> print(f"{heard[960] * 2 * np.pi * 3.43 / (1.21 * 1e-4):.4f} {abs(heard[:470]).max() / heard.max():.4f}")
    2.0000 0.0000
    """
    refuse_unlike(surfaces)
    first = surfaces[0]
    on_plane(space, first.points)
    places = in_front(space, receivers)
    nt = first.rates.shape[1]
    longest = max(float(np.linalg.norm(first.points - place, axis=1).max()) for place in places) / space.air.c
    whole = int(np.ceil(PADDING * nt)) + 1
    length = fast_length(whole + int(np.ceil(longest / first.dt)))
    s = np.asarray(2j * np.pi * np.fft.rfftfreq(length, first.dt))
    spectra = [np.fft.rfft(extend_to_rest(one.rates, whole), length, axis=1) for one in surfaces]
    size = np.sum([np.abs(one).max(axis=0) for one in spectra], axis=0)
    above = np.cumsum(size[::-1])[::-1]
    last = max(1, int(np.count_nonzero(above > NEGLIGIBLE * above[0])))  # in silence none
    p = np.zeros((len(surfaces), len(places), len(s)), dtype=np.complex128)
    for row, place in enumerate(places if last else ()):  # of a surface that is still there is nothing to sum
        sums = _sums(space, first, place, s[:last])
        for one, spectrum in enumerate(spectra):
            p[one, row, :last] = (sums * spectrum[:, :last].T).sum(axis=1)
    p *= space.air.rho * s / (2 * np.pi)
    found = []
    for surface, transformed in zip(surfaces, p, strict=True):
        history = np.array(np.fft.irfft(transformed, length, axis=1)[:, :nt])
        history.flags.writeable = False
        loudest = np.abs(surface.shapes).max(axis=0)
        highest_hz = source_bandwidth(loudest[:, None] * surface.rates, surface.dt)
        advice = spacing_advice(space, surface.points, surface.weights, places, highest_hz)
        found.append(RoomResponse(tuple(receivers), surface.t, history, advice))
    return found


def _sums(space: Baffle, surface: SurfaceVelocity, place: Floats, s: Complexes) -> Complexes:
    """Sums over the points of weight, shape and exp(-s R / c) / R [nf, k], at equally spaced frequencies s."""
    delay = np.linalg.norm(surface.points - place, axis=1) / space.air.c
    shapes = (surface.weights / (delay * space.air.c))[:, None] * surface.shapes
    table = np.exp(-np.outer(s[:_LINES] - s[0], delay))
    sums = np.empty((len(s), shapes.shape[1]), dtype=np.complex128)
    for start in range(0, len(s), _LINES):
        stop = min(start + _LINES, len(s))
        sums[start:stop] = table[: stop - start] @ (np.exp(-s[start] * delay)[:, None] * shapes)
    return sums


def spacing_advice(
    space: Baffle, points: Floats, weights: Floats, places: Floats, highest_hz: float
) -> tuple[Advice, ...]:
    """Advice on points too far apart for a frequency, and on receivers too near."""
    apart = float(np.sqrt(weights.max()))
    found = []
    if highest_hz * apart * POINTS_PER_WAVE > space.air.c:
        found.append(
            Advice(
                "surface-points-coarse",
                f"the wavelength in air at {highest_hz:.4g} Hz is {space.air.c / highest_hz:.3g} m and the points "
                "of the "
                f"surface are {apart:.3g} m apart: {space.air.c / highest_hz / apart:.1f} points a wavelength, "
                f"{POINTS_PER_WAVE:g} are needed. Use a finer mesh",
                {"points_per_wave": space.air.c / highest_hz / apart, "needed": POINTS_PER_WAVE},
            )
        )
    nearest = min(float(np.linalg.norm(points - place, axis=1).min()) for place in places)
    if nearest < NEAR * apart:
        found.append(
            Advice(
                "field-receiver-near",
                f"a receiver is {nearest:.3g} m from the surface, whose points are {apart:.3g} m apart: single points "
                f"matter there. Keep a distance of {NEAR * apart:.2g} m, or use a finer mesh",
                {"distance_m": nearest, "spacing_m": apart},
            )
        )
    return tuple(found)
