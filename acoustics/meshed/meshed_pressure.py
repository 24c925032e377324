"""Pressure in a room of any shape, from its modes: the same moving surface, the same causal transform as a box."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, log
from typing import Final, Literal

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Complexes, Floats
from acoustics.errors import AcousticsError, Advice
from acoustics.losses import Losses, modal_damping_ratios
from acoustics.meshed.finite_elements import CELLS_PER_WAVE, CavityModes, drive, probe, wall_forces, with_answers
from acoustics.meshed.walls import (
    Answer,
    AnyWall,
    Wall,
    complex_modes,
    coupling,
    is_coupled,
    resonances,
    wall_absorption,
    wall_coupling_advice,
    wall_motion,
)
from acoustics.receivers import Receiver, positions
from acoustics.room_response import RoomResponse
from acoustics.rooms.box import wavenumber_squared
from acoustics.rooms.box_pressure import extend_to_rest, source_bandwidth, transform_axis
from acoustics.source import (
    SurfaceShapes,
    SurfaceVelocity,
    SurfaceVibration,
    refuse_unlike,
    side_by_side,
    with_own_coordinates,
)

# ----------------------------------------------------------------------------------------------------------------------
# How fast sound dies away in a room of any shape: decays of its modes, and the reverberation time that is measured.
# ----------------------------------------------------------------------------------------------------------------------

TOP_DB: Final = -5.0  # of the decay: a line is fitted to the level from here ...
BOTTOM_DB: Final = -25.0  # ... to here, T20 of ISO 3382-2, as ISO 16283 measures it
_TIMES: Final = 500
_STILL: Final = 1e-12  # rate [1/s] below which nothing decays


@dataclass(frozen=True, eq=False)
class Decays:
    """Damped modes of a room: their frequencies [n] [Hz], rates of their amplitudes [n] [1/s], and how much each is in
    the mean square of a pulse, over all places of its source and of microphones [n]."""

    frequency_hz: Floats
    rate: Floats
    square: Floats


def decays(modes: CavityModes, air: Air, losses: Losses, walls: Mapping[str, AnyWall]) -> Decays:
    """The modes of a room with its losses and what its walls absorb, without the uniform one: as its pressure has them.

    One by one they decay with the rate of the losses and c int beta P_n^2 / 2 V; where walls couple them, as their
    complex modes do.
    """
    taken = wall_absorption(modes, walls, air)
    if is_coupled(walls, coupling(modes, taken, air)):
        poles, at_receivers, driven = resonances(modes, air, losses, taken, wall_motion(modes, walls))
        squares = (np.abs(at_receivers) ** 2).sum(axis=0) * (np.abs(driven) ** 2).sum(axis=1)
        ring = poles.imag > 0
        return Decays(poles.imag[ring] / (2 * np.pi), -poles.real[ring], squares[ring])
    hz = modes.wavenumber[1:] * air.c / (2 * np.pi)
    rate = 2 * np.pi * hz * modal_damping_ratios(losses, hz) + 0.5 * air.c * np.diag(taken)[1:]
    return Decays(hz, rate, np.ones(len(hz)))


def measured_t60(modes: Decays, centre_hz: float, fraction: Literal[1, 3] = 3) -> float:
    """Reverberation time T20 [s] of a band, the mean over places of the squares of a pulse through its filter; infinite
    without losses.

    Notes
    -----
    The squares of modes add, each with its own rate: backward integration of them, and a line by least squares through
    the level from -5 to -25 dB. Where a band has no mode, those beside it are what its filter passes.

    >>> two = Decays(np.array([100.0, 101.0]), np.array([6.907755, 6.907755]), np.ones(2))
    >>> round(measured_t60(two, 100.0), 6)
    1.0
    """
    ratio, edge = modes.frequency_hz / centre_hz, 10 ** (0.15 / fraction)
    share = modes.square / (1 + ((ratio - 1 / ratio) / (edge - 1 / edge)) ** 8)  # order-4 Butterworth
    audible = share > 1e-6 * share.max(initial=0.0)
    rates, share = modes.rate[audible], share[audible]
    if not len(rates) or rates.min() <= _STILL:
        return inf
    t = np.linspace(0.0, -BOTTOM_DB / 10 * log(10) / (2 * rates.min()), _TIMES)
    left = (share / rates) @ np.exp(-2 * np.outer(rates, t))
    level = 10 * np.log10(left / left[0])
    part = (level <= TOP_DB) & (level >= BOTTOM_DB)
    return float(-60 / np.polyfit(t[part], level[part], 1)[0])


# ----------------------------------------------------------------------------------------------------------------------
# Pressure in a room of any shape, from its modes.
# ----------------------------------------------------------------------------------------------------------------------

_BATCH: Final = 1 << 23  # complex numbers of one batch


def cavity_pressure(
    surface: SurfaceVelocity,
    modes: CavityModes,
    air: Air,
    losses: Losses,
    receivers: Sequence[Receiver],
    walls: Mapping[str, AnyWall] | None = None,
) -> RoomResponse:
    """Pressure at the receivers of a room of any shape, part of whose boundary moves with the given velocity.

    Parameters
    ----------
    modes : CavityModes
        Of `cavity_modes`, up to twice the band of interest.
    walls : Mapping[str, AnyWall] | None
        What the named walls absorb, or how they yield; others are rigid.

    Returns
    -------
    RoomResponse
        RoomResponse; its findings name a velocity beyond the modes, a mesh too coarse for them, and walls that absorb
        too much for what is said of them.

    Raises
    ------
    AcousticsError
        Surface points off the boundary, receivers outside, walls without a name in the mesh, losses of kind ``source``,
        which are not causal.

    Notes
    -----
    With s = j omega + a as in `pressure`, mode n of a volume V answers the velocity of the surface with

        P_n = rho d(s) (integral of psi_n v) / (V (k_n^2 - k^2(s) + d(s)/c (integral of beta psi_n^2) / V))

    and the modes left out as pseudo-modes: their answers at rest to the shapes of the surface. Walls couple modes by
    the integrals of beta psi_n psi_m: then the coupled system is solved by its complex modes, and so it is with walls
    that yield, whose displacement is part of that system.

    Examples
    --------
    A piston that stops after pushing 0.1 mm into a box of 1 m height compresses it by 1e-4:

    >>> from acoustics.meshed.finite_elements import cavity_modes
    >>> from acoustics.meshed.cavity_mesh import box_mesh
    >>> t = np.arange(4800) / 48e3
    >>> push = np.where(t < 0.02, 0.01 * (1 - np.cos(2 * np.pi * t / 0.02)) / 2, 0)
    >>> ceiling = SurfaceVelocity([[0.25, 0.25, 1]], [0.25], [[1]], [push], dt=1 / 48e3)
    >>> modes = cavity_modes(box_mesh([0.5, 0.5, 1], [1, 1, 2]), up_to=1.0)
    >>> heard = cavity_pressure(ceiling, modes, Air(340, 1.29), Losses(), [Receiver("mic", [0.2, 0.2, 0.5])])
    >>> round(float(heard.p[0, -1]), 1)
    14.9
    """
    return cavity_pressures([surface], modes, air, losses, receivers, walls)[0]


def cavity_pressures(
    surfaces: Sequence[SurfaceVelocity],
    modes: CavityModes,
    air: Air,
    losses: Losses,
    receivers: Sequence[Receiver],
    walls: Mapping[str, AnyWall] | None = None,
) -> list[RoomResponse]:
    """Pressure at the receivers for each of several motions of one ceiling: as `cavity_pressure` of each, the transfer
    functions found once.

    Parameters
    ----------
    surfaces : Sequence[SurfaceVelocity]
        Of the same points, weights, shapes and sampling; they differ in their rates.

    Raises
    ------
    AcousticsError
        As `cavity_pressure` does, and for no surface or surfaces that differ.
    """
    if losses.kind == "source":
        raise AcousticsError("losses", got="kind source", expected="a causal kind", do="use form: causal")
    refuse_unlike(surfaces)
    first = surfaces[0]
    transfer = _transfer_of(modes, air, losses, walls or {}, first, positions(receivers))
    nt = first.rates.shape[1]
    s, weight = transform_axis(nt, first.dt)
    found = []
    for surface in surfaces:
        spectra = np.fft.rfft(extend_to_rest(transfer.driving @ surface.rates, len(weight)) * weight, axis=1)
        p = np.fft.irfft(transfer.pressure(s, spectra), len(weight), axis=1)[:, :nt] / weight[:nt]
        p.flags.writeable = False
        findings = (*_judgement(surface, modes, air), *transfer.advice)
        found.append(RoomResponse(tuple(receivers), surface.t, p, findings))
    return found


def harmonic_cavity_pressure(
    surface: SurfaceVibration,
    modes: CavityModes,
    air: Air,
    losses: Losses,
    receivers: Sequence[Receiver],
    walls: Mapping[str, AnyWall] | None = None,
) -> tuple[Complexes, tuple[Advice, ...]]:
    """Complex pressure [n_receivers, nf] [Pa] of a room of any shape, part of whose boundary vibrates, and advice.

    The rest as `cavity_pressure`, with the modes of the room and their answers at rest; losses of any kind.

    Raises AcousticsError: a room without losses at a resonance, and as `cavity_pressure`.
    """
    hz = surface.frequency_hz
    transfer = _transfer_of(modes, air, losses, walls or {}, surface, positions(receivers))
    with np.errstate(divide="ignore", invalid="ignore"):  # a resonance without losses is refused just below
        p = transfer.pressure(np.asarray(2j * np.pi * hz), transfer.driving @ surface.rates)
    if not np.isfinite(p).all():
        raise AcousticsError("frequency", got="a resonance of a room without losses", expected="losses")
    return p, (*_limits(float(hz.max()), modes, air), *transfer.advice)


def cavity_loads(
    surface: SurfaceShapes,
    modes: CavityModes,
    air: Air,
    losses: Losses,
    source: Receiver,
    frequency_hz: Floats,
    walls: Mapping[str, AnyWall] | None = None,
) -> tuple[Complexes, tuple[Advice, ...]]:
    """Integrals [k, nf] over a surface that is held, of the pressure that a point source in a room of any shape makes
    per volume velocity, times its shapes; and advice on it.

    The rest as `harmonic_cavity_pressure`: the source drives the modes by their values where it stands, and those left
    out are the answers at rest to the shapes of the surface.
    """
    hz = np.asarray(frequency_hz, dtype=np.float64)
    transfer = _transfer_of(modes, air, losses, walls or {}, surface, positions([source]), back=True)
    with np.errstate(divide="ignore", invalid="ignore"):  # a resonance without losses is refused just below
        found = transfer.pressure(np.asarray(2j * np.pi * hz), np.repeat(transfer.driving, len(hz), axis=1))
    if not np.isfinite(found).all():
        raise AcousticsError("frequency", got="a resonance of a room without losses", expected="losses")
    return found, (*_limits(float(hz.max()), modes, air), *transfer.advice)


def cavity_powers(
    surfaces: Sequence[SurfaceVibration],
    modes: CavityModes,
    air: Air,
    losses: Losses,
    walls: Mapping[str, AnyWall] | None = None,
) -> Floats:
    """Mean power [n_surfaces, nf] [W] that each surface gives the air of a room of any shape: 1/2 Re of the integral
    over it of the total pressure times the conjugate of its own velocity.

    The rest as `harmonic_cavity_pressure`, by whose pressure it is.
    """
    hz = surfaces[0].frequency_hz
    shapes, rates, columns = with_own_coordinates(surfaces)
    transfer = _transfer_of(modes, air, losses, walls or {}, side_by_side(shapes), None)
    with np.errstate(divide="ignore", invalid="ignore"):  # a resonance without losses is refused just below
        force = transfer.pressure(np.asarray(2j * np.pi * hz), transfer.driving @ rates)
    if not np.isfinite(force).all():
        raise AcousticsError("frequency", got="a resonance of a room without losses", expected="losses")
    flow = 0.5 * (rates.conj() * force).real
    return np.array([flow[own].sum(axis=0) for own in columns])


@dataclass(frozen=True, eq=False)
class _Transfer:
    """From integrals of the modes over what moves, driving [n, k] times rates, to pressures of the receivers."""

    driving: Floats
    mixed: Floats | Complexes
    right: Floats | Complexes
    term: Callable[[Complexes], Complexes]
    advice: tuple[Advice, ...]

    def pressure(self, s: Complexes, driven: Complexes) -> Complexes:
        """Pressures [n_receivers, nf] of the driven modes [n, nf] at complex frequencies s [nf]."""
        p = np.zeros((len(self.mixed), len(s)), dtype=np.complex128)
        width = max(1, _BATCH // len(self.right))
        for start in range(0, len(s), width):
            band = slice(start, start + width)
            p[:, band] = self.mixed @ (self.term(s[band]) * (self.right @ driven[:, band]))
        return p


def _transfer_of(
    modes: CavityModes,
    air: Air,
    losses: Losses,
    walls: Mapping[str, AnyWall],
    surface: SurfaceShapes,
    places: Floats | None,
    *,
    back: bool = False,
) -> _Transfer:
    """The transfer from what moves to places [r, 3], or to the forces on its own shapes, and advice on the walls.

    Parameters
    ----------
    back : bool
        From sources at the places to the forces on the shapes instead.
    """
    loads = drive(modes, surface)
    listening = loads.T if places is None else probe(modes.mesh, places)
    coupled = coupling(modes, wall_absorption(modes, walls, air), air)
    together = is_coupled(walls, coupled)
    resistive = {name: wall for name, wall in walls.items() if isinstance(wall, Wall)}
    forces = [wall_forces(modes, wall) for wall in resistive] if together else []
    modes = with_answers(modes, np.hstack([loads, wall_motion(modes, walls).loads, *forces]))
    motion = wall_motion(modes, walls)  # in all that there is now of pressure on the walls
    taken = wall_absorption(modes, resistive, air)
    if together:
        left, right, term = complex_modes(modes, air, losses, taken, motion)
    else:
        left, right, term = _separate_modes(modes, air, losses, taken)
    advice = wall_coupling_advice(walls, coupled)
    receiving, driving = np.asarray(listening @ modes.shapes), np.asarray(modes.shapes.T @ loads)
    if back:
        receiving, driving = driving.T, receiving.T
    return _Transfer(driving, receiving @ left, right, term, advice)


def _separate_modes(modes: CavityModes, air: Air, losses: Losses, absorbed: Floats) -> Answer:
    """(left, right, term): pressures of the modes are left @ (term(s) * (right @ integrals of psi_n v)), each mode by
    itself."""
    squared, own = modes.wavenumber[:, None] ** 2, np.diag(absorbed)[:, None]

    def term(s: Complexes) -> Complexes:
        below = squared - wavenumber_squared(losses, air, s) + (s + 2 * losses.decay_rate) / air.c * own
        ratio: Complexes = air.rho * (s + 2 * losses.decay_rate) / (modes.mesh.volume * below)
        return ratio

    unit = np.eye(len(absorbed))
    return unit, unit, term


def _judgement(surface: SurfaceVelocity, modes: CavityModes, air: Air) -> tuple[Advice, ...]:
    """Advice on a velocity beyond the modes and on cells too coarse for them."""
    # of the surface itself: the modes that are there cannot tell what drives those that are not
    loudest = np.abs(surface.shapes).max(axis=0)
    return _limits(source_bandwidth(loudest[:, None] * surface.rates, surface.dt), modes, air)


def _limits(highest_hz: float, modes: CavityModes, air: Air) -> tuple[Advice, ...]:
    """Advice on a source up to a frequency, beyond the modes, and on cells too coarse for them."""
    complete_hz = modes.complete_below * air.c / (2 * np.pi)
    found = []
    if highest_hz > complete_hz:
        found.append(
            Advice(
                "room-modes-missing",
                f"the surface moves up to {highest_hz:.4g} Hz, the modes of the room end at {complete_hz:.4g} Hz; "
                "above, only the static response of the room is included",
                {"source_highest_hz": highest_hz, "complete_below_hz": complete_hz},
            )
        )
    top_hz = min(highest_hz, complete_hz)
    per_wave = air.c / (top_hz * modes.mesh.largest_cell) if top_hz else np.inf
    if per_wave < CELLS_PER_WAVE:
        found.append(
            Advice(
                "room-mesh-coarse",
                f"the mesh has {per_wave:.1f} cells of {modes.mesh.largest_cell:.3g} m for a wavelength at "
                f"{top_hz:.4g} Hz; "
                f"{CELLS_PER_WAVE:g} are needed for an error of 0.1 % in frequency",
                {"cells_per_wave": per_wave, "needed": CELLS_PER_WAVE},
            )
        )
    return tuple(found)
