"""Who makes which band in a room that several surfaces move: the active energy of each, and what is heard of each
alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite, nan
from typing import Annotated, Final

import numpy as np

from acoustics.arrays import Complexes
from acoustics.fields.returned import KeptTransfer
from acoustics.levels.bands import band_edges, decibel, decibels, is_below, third_octave_bands
from acoustics.levels.sound_levels import REFERENCE_PA
from acoustics.receivers import Receiver
from acoustics.rooms.box_pressure import fast_length, transform_axis
from acoustics.source import SurfaceVelocity, SurfaceVibration
from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_with_gaps
from femstruct.errors import InputError
from femstruct.modal.basis import ModalBasis
from femstruct.reported import Reported
from femstruct.sound.placed import Placed
from femstruct.sound.surfaces import Motion
from femstruct.tags import stored_as

REFERENCE_J: Final = 1e-12
LINES_A_BAND: Final = 2.0  # lines of the record within a third octave from which on the band is shown
PADDED: Final = 2.0  # length of the transform over that of the record, and ...
RINGS: Final = (
    1.0  # ... of reverberation times after its end: what comes later, 60 dB down, folds back to its beginning
)
STILL: Final = (
    1e-8  # of the loudest surface's speed: degenerate modes of parts that are not joined mix up to about 1e-11
)
SEEN: Final = 4096  # samples of which a surface's largest speed is taken
_BAND: Final = ("band_hz", "Hz", "Nominal centre of the third octave")


@stored_as("surface shares/1")
@dataclass(frozen=True, eq=False)
class SurfaceShares:
    """What each surface of a room gives its air in a record, by third octaves, and what is heard of it alone.

    surfaces : their names; a leak of the room is the last of them. walls : those of the room that they move, "" of a
    leak. bands_hz [b] : nominal centres.
    energy_j [s, b] : active energy: the total pressure on each surface times its own velocity, over its area and the
    record. They sum to what the air takes up; a surface that the others push has a negative one, and there is no other
    way to share out sounds that are coherent.
    alone_db [s, b] : sound exposure level, mean over the receivers' energies, when this surface alone moves as it does.
    They add up to `together_db` [b] in pressure, not in energy. nan where nobody listens, beyond where the sound
    ends, and of a surface that does not move; its energy is 0.

    >>> two = SurfaceShares(("slab", "wall"), ("ceiling", "x0"), [63.0], [[3e-9], [-1e-9]], [[60.0], [55.0]], [61.0])
    >>> float(1e9 * two.total_j[0].round(12)), two.share.ravel().round(9).tolist(), round(two.over_db(1), 1)
    (2.0, [1.5, -0.5], 55.0)
    """

    surfaces: tuple[str, ...]
    walls: tuple[str, ...]
    bands_hz: Annotated[Floats, Reported("Hz", "Nominal centre of the third octave", along=("bands_hz",))]
    energy_j: Annotated[Floats, Reported("J", "Total pressure times own velocity", along=("surface", "bands_hz"))]
    alone_db: Annotated[
        Floats, Reported("dB re 20 µPa", "Sound exposure level of a surface alone", along=("surface", "bands_hz"))
    ]
    together_db: Annotated[Floats, Reported("dB re 20 µPa", "Sound exposure level of all", along=("bands_hz",))]

    def __post_init__(self) -> None:
        bands = frozen("shares.bands_hz", self.bands_hz, (None,))
        each = (len(self.surfaces), len(bands))
        freeze(
            self,
            bands_hz=bands,
            energy_j=frozen_with_gaps("shares.energy_j", self.energy_j, each),
            alone_db=frozen_with_gaps("shares.alone_db", self.alone_db, each),
            together_db=frozen_with_gaps("shares.together_db", self.together_db, each[1:]),
        )

    @property
    def total_j(self) -> Annotated[Floats, Reported("J", "What the air of the room absorbs", along=("bands_hz",))]:
        """Sum of the energies [b] [J]."""
        return np.asarray(self.energy_j.sum(axis=0))

    @property
    def share(self) -> Annotated[Floats, Reported("1", "Share of the energy", along=("surface", "bands_hz"))]:
        """Of what the air takes up [s, b]: they sum to 1, and may be negative or above 1; nan in silence."""
        total = self.total_j
        return np.divide(self.energy_j, total, out=np.full_like(self.energy_j, nan), where=np.abs(total) > 0)

    def over_db(self, surface: int) -> float:
        """Sound exposure level of one surface alone over all bands that are shown [dB re 20 uPa]."""
        return summed_db(self.alone_db[surface])


def summed_db(levels_db: Floats) -> float:
    """Level of the sum of the energies [dB]; nan where none is known."""
    known = levels_db[~np.isnan(levels_db)]
    return decibel(float((10 ** (known / 10)).sum()))


def surface_shares(
    motion: Motion, room: Placed, receivers: Sequence[Receiver], end_hz: float = inf
) -> SurfaceShares | None:
    """What each surface of a closed room gives its air while all move as recorded; None where no band is complete.

    Parameters
    ----------
    motion : Motion
        Of all surfaces, and of a leak, of `separate_leak`.
    end_hz : float
        Where the motion ends; bands above it are left out. Energies are nan in a room without losses, which takes
        nothing up.

    Notes
    -----
    Energy is the sum over lines of the active power spectrum, which lie close enough for the room to fall silent; the
    structure stands still after the record's end. Bands begin where a third octave has two lines, 4.3 / T.
    """
    first = motion[0]
    bands = {
        nominal: exact
        for nominal, exact in third_octave_bands(1.0 / first.dt, 10.0).items()
        if np.subtract(*band_edges(exact)[::-1]) >= LINES_A_BAND / (first.rates.shape[1] * first.dt)
        and is_below(exact, end_hz)
    }
    if not bands:
        return None
    samples = first.rates.shape[1]
    rings = RINGS * _rings(room, [*bands.values()][-1]) / first.dt
    length = fast_length(int(max(PADDED * samples, samples + rings)))
    step = 1.0 / (length * first.dt)
    low, high = band_edges(next(iter(bands.values())))[0], band_edges([*bands.values()][-1])[1]
    lines = np.asarray(step * np.arange(max(1, int(low / step)), int(np.ceil(high / step)) + 1), dtype=np.float64)
    energy = np.full((len(motion), len(bands)), nan)
    if room.room.loses:
        density = 4.0 * room.room.powers([_vibration(one, length, lines) for one in motion])  # both signs, 2 of 1/2
        energy = step * _by_band(density, lines, bands)
    still = _still(motion)
    energy[still & room.room.loses] = 0.0
    alone, together = np.full(energy.shape, nan), np.full(len(bands), nan)
    if receivers:
        pressures = [room.room.pressures([[one]], receivers, end_hz)[0] for one in motion]
        spectra = [_spectra(one.p, first.dt, length, lines) for one in pressures]
        squares = [(np.abs(one) ** 2).mean(axis=0)[None] for one in (*spectra, sum(spectra))]
        *each, whole = (decibels(2.0 * step * _by_band(one, lines, bands)[0] / REFERENCE_PA**2) for one in squares)
        alone, together = np.where(still[:, None], nan, np.array(each)), whole
    names, walls = [one.name for one in room.surfaces], [*room.walls]
    if len(motion) > len(names):
        names, walls = [*names, f"leak of {room.name}"], [*walls, ""]
    return SurfaceShares(tuple(names), tuple(walls), np.array([*bands]), energy, alone, together)


def _still(motion: Motion) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Which surfaces [s] move with rounding errors alone: parts that are not joined to what is struck."""
    peak = np.array([one.speed(SEEN).max() for one in motion])
    return np.asarray(peak <= STILL * peak.max())


def separate_leak(motion: Motion, flow: Floats) -> Motion:
    """Surfaces without the flow through a leak of their room, which is spread over all of them, and that flow.

    Parameters
    ----------
    flow : Floats
        Velocity of it in every coordinate [k], per unit of its rate.
    """
    own = [replace(one, shapes=one.shapes - flow) for one in motion]
    points, weights = (np.concatenate([getattr(one, word) for one in motion]) for word in ("points", "weights"))
    return (*own, replace(motion[0], points=points, weights=weights, shapes=np.tile(flow, (len(weights), 1))))


def _rings(room: Placed, highest_hz: float) -> float:
    """Longest reverberation time [s] of a room's modes up to a frequency, 0 for one whose modes are not known."""
    lowest_hz = room.room.mode_shapes(np.asarray(room.room.middle)[None], 1)[0][:1].tolist()
    times = [room.room.t60(f) for first in lowest_hz for f in np.geomspace(first, max(first, highest_hz), 8).tolist()]
    return max((t60 for t60 in times if isfinite(t60)), default=0.0)


def _vibration(motion: SurfaceVelocity, length: int, lines: Floats) -> SurfaceVibration:
    """A motion at some lines of a padded record: rates in m/s/Hz per unit of the shapes."""
    return SurfaceVibration(
        motion.points, motion.weights, motion.shapes, _spectra(motion.rates, motion.dt, length, lines), lines
    )


def _spectra(p: Floats, dt: float, length: int, lines: Floats) -> Complexes:
    """Fourier transform of histories [r, nt] at some lines of a padded record [r, nf]."""
    first = round(float(lines[0]) * length * dt)
    return dt * np.fft.rfft(p, length, axis=1)[:, first : first + len(lines)]


def _by_band(density: Floats, lines: Floats, bands: Mapping[float, float]) -> Floats:
    """Sums [s, b] of densities [s, nf] over the lines of each band, each half-way to the next: edges part a line."""
    half = 0.5 * (lines[1] - lines[0])
    edges = np.array([band_edges(exact) for exact in bands.values()]).clip(lines[0] - half, lines[-1] + half)
    summed = np.pad(np.cumsum(density, axis=1), ((0, 0), (1, 0)))
    until = np.append(lines - half, lines[-1] + half)
    low, high = (np.array([np.interp(edge, until, one) for one in summed]) for edge in edges.T)
    return np.asarray(high - low)


# ----------------------------------------------------------------------------------------------------------------------
# What is heard of forces without the motion between: transfers from what pushes the modes to the listeners of a room.
#
# A thousand impacts on one structure differ in their forces alone. The room's answer to each mode and each mode's
# answer to a force are the same in all of them; their sum over the modes is made once.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class PushTransfer:
    """Pressures at receivers of a room from forces on a structure, in a record of nt samples dt [s] apart.

    per_push [receivers, r, nf] : pressure over the moments of each force, on the first lines of the record's transform;
    weight [length] : of that transform.
    """

    nt: int
    dt: float
    per_push: Complexes
    weight: Floats

    def pressures(self, moments: Floats) -> Floats:
        """Pressures [runs, receivers, nt] of forces with these moments [runs, r, cells + 2] in cells of dt."""
        length, nf = len(self.weight), self.per_push.shape[2]
        weighted = moments[:, :, : self.nt] * self.weight[: self.nt]
        spectra = np.fft.rfft(weighted, length, axis=2)[:, :, :nf]
        spectrum = np.einsum("xrf,crf->cxf", self.per_push, spectra)
        found: Floats = np.fft.irfft(spectrum, length, axis=2)[:, :, : self.nt] / self.weight[: self.nt]
        return found


def push_transfer(
    basis: ModalBasis, shares: Floats, kept: KeptTransfer, moving: Integers, nt: int, dt: float
) -> PushTransfer:
    """The transfer of forces that act on the modes with shares [r, k].

    Parameters
    ----------
    basis : ModalBasis
        With damping that couples no modes.
    kept : KeptTransfer
        Of the room, for the modes `moving` of the basis, in a record of nt samples dt apart.

    Raises
    ------
    InputError
        For modes that damping couples.

    Notes
    -----
    On the lines s of the record's transform, weighted with exp(-a t) so that nothing wraps around, a force of transform
    F has the rates q'_k = s phi_k F / (s^2 + c_k s + omega_k^2), each of which is heard as `kept` knows. Moments m_j,
    integrals of the force times hats of width dt around t_j, have the transform sum m_j exp(-s t_j) = F (2 sinh(s dt /
    2) / (s dt))^2 and what lies beyond half the sampling, which is folded back with that square: 1e-3 of a force at a
    seventh of the sampling as large there as beyond.
    """
    damping = basis.time_damping
    if np.any(damping - np.diag(np.diag(damping))):
        raise InputError("damping", got="modes that it couples", expected="each mode by itself")
    whole = kept.per_rate
    s, weight = transform_axis(nt, dt)
    s = s[: whole.shape[2]]
    omega, losses = basis.omega[moving], np.diag(damping)[moving]
    hat = (2.0 * np.sinh(0.5 * s * dt) / (s * dt)) ** 2
    rate = s / (s**2 + losses[:, None] * s + (omega**2)[:, None])
    per_push = np.einsum("xkf,rk,kf->xrf", whole, shares[:, moving], rate, optimize=True) / (hat * dt)
    return PushTransfer(nt, dt, np.asarray(per_push, dtype=np.complex128), weight)
