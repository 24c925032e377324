"""Pressure in a room of any shape, from its modes: the same moving surface, the same causal transform as a box."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final

import numpy as np
from scipy.linalg import eig

from acoustics.air import Air
from acoustics.arrays import Complexes, Floats
from acoustics.cavity import wavenumber_squared
from acoustics.errors import AcousticsError, Advice
from acoustics.extension import extended, source_bandwidth, transform_axis
from acoustics.fem import CELLS_PER_WAVE, CavityModes, drive, probe, wall_forces, wall_integrals, with_answers
from acoustics.pressure import RoomResponse
from acoustics.room import Losses, Receiver
from acoustics.source import SurfaceVelocity
from acoustics.walls import Wall

COUPLED: Final = 0.05  # what walls couple two modes by, over the distance of their frequencies, to need complex modes
_BATCH: Final = 1 << 23  # complex numbers of one batch


def cavity_pressure(
    surface: SurfaceVelocity,
    modes: CavityModes,
    air: Air,
    losses: Losses,
    receivers: Sequence[Receiver],
    walls: Mapping[str, Wall] | None = None,
) -> RoomResponse:
    """Pressure at the receivers of a room of any shape, part of whose boundary moves with the given velocity.

    modes : of `cavity_modes`, up to twice the band of interest. walls : what the named walls take up; others are
    rigid.

    Returns RoomResponse; its findings name a velocity beyond the modes, a mesh too coarse for them, and walls that
    take up too much for what is said of them.

    Raises AcousticsError: surface points off the boundary, receivers outside, walls without a name in the mesh, losses
    of kind ``source``, which are not causal.

    Notes
    -----
    With s = j omega + a as in `pressure`, mode n of a volume V answers the velocity of the surface with

        P_n = rho d(s) (integral of psi_n v) / (V (k_n^2 - k^2(s) + (s/c) (integral of beta psi_n^2) / V))

    and the modes left out as pseudo-modes: their answers at rest to the shapes of the surface. Walls couple modes by
    the integrals of beta psi_n psi_m; where these matter, beside the distance of the frequencies, and the walls are
    constant in frequency, the coupled system is solved by its complex modes instead.

    A piston that stops after pushing 0.1 mm into a box of 1 m height compresses it by 1e-4:

    >>> from acoustics.fem import box_mesh, cavity_modes
    >>> t = np.arange(4800) / 48e3
    >>> push = np.where(t < 0.02, 0.01 * (1 - np.cos(2 * np.pi * t / 0.02)) / 2, 0)
    >>> ceiling = SurfaceVelocity([[0.25, 0.25, 1]], [0.25], [[1]], [push], dt=1 / 48e3)
    >>> modes = cavity_modes(box_mesh([0.5, 0.5, 1], [1, 1, 2]), up_to=1.0)
    >>> heard = cavity_pressure(ceiling, modes, Air(340, 1.29), Losses(), [Receiver("mic", [0.2, 0.2, 0.5])])
    >>> round(float(heard.p[0, -1]), 1)
    14.9
    """
    if losses.kind == "source":
        raise AcousticsError("losses", got="kind source", expected="a causal kind", do="use form: causal")
    if not receivers:
        raise AcousticsError("receivers", got="none", expected="at least one", do="name a place to listen")
    places = np.stack([receiver.position for receiver in receivers])
    loads = drive(modes, surface.points, surface.weights, surface.shapes)
    listening = probe(modes.mesh, places)
    walls = walls or {}
    coupled = _coupling(modes, _absorbed(modes, walls, air), air)
    constant = all(wall.constant for wall in walls.values())
    advice = _judgement(surface, modes, air)
    together = coupled > COUPLED and constant
    forces = [wall_forces(modes, wall) for wall in walls] if together else []
    modes = with_answers(modes, np.hstack([loads, *forces]))
    absorbed = _absorbed(modes, walls, air)
    answer = (_complex_modes if together else _separate_modes)(modes, air, losses, absorbed)
    driving, hearing = modes.shapes.T @ loads, np.asarray(listening @ modes.shapes)
    s, weight = transform_axis(surface.rates.shape[1], surface.dt)
    if coupled > COUPLED and not constant:
        advice.append(
            Advice(
                "walls-couple-modes",
                f"walls couple two modes by {coupled:.2g} of the distance of their frequencies, above {COUPLED:g}; "
                "with absorption that depends on frequency each mode is damped by itself, which is then rough",
                {"coupling": coupled, "allowed": COUPLED},
            )
        )
    nt, length = surface.rates.shape[1], len(weight)
    spectra = np.fft.rfft(extended(driving @ surface.rates, length) * weight, axis=1)
    heard = np.zeros((len(receivers), len(s)), dtype=np.complex128)
    left, right, term = answer
    mixed = hearing @ left
    width = max(1, _BATCH // len(right))
    for start in range(0, len(s), width):
        band = slice(start, start + width)
        heard[:, band] += mixed @ (term(s[band]) * (right @ spectra[:, band]))
    p = np.fft.irfft(heard, length, axis=1)[:, :nt] / weight[:nt]
    p.flags.writeable = False
    return RoomResponse(tuple(receivers), surface.t, p, tuple(advice))


_Answer = tuple[Floats | Complexes, Floats | Complexes, Callable[[Complexes], Complexes]]


def _separate_modes(modes: CavityModes, air: Air, losses: Losses, absorbed: Floats) -> _Answer:
    """(left, right, term): pressures of the modes are left @ (term(s) * (right @ integrals of psi_n v)), each mode by
    itself."""
    squared, own = modes.wavenumber[:, None] ** 2, np.diag(absorbed)[:, None]

    def term(s: Complexes) -> Complexes:
        below = squared - wavenumber_squared(losses, air, s) + s / air.c * own
        ratio: Complexes = air.rho * (s + 2 * losses.decay_rate) / (modes.mesh.volume * below)
        return ratio

    unit = np.eye(len(absorbed))
    return unit, unit, term


def _complex_modes(modes: CavityModes, air: Air, losses: Losses, absorbed: Floats) -> _Answer:
    """The same by the complex modes of the system that walls couple.

    With tau the relaxation time and gamma the decay rate, times c^2 (1 + tau s):

        (1 + tau c A) s^2 + (2 gamma + tau c^2 k^2 + c A) s + c^2 k^2 = rho c^2 (s + 2 gamma) (1 + tau s) v.
    """
    n, tau = len(absorbed), losses.relaxation_time
    stiffness = np.diag((air.c * modes.wavenumber) ** 2)
    mass = np.eye(n) + tau * air.c * absorbed
    damping = 2 * losses.decay_rate * np.eye(n) + tau * stiffness + air.c * absorbed
    state = np.block(
        [[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)]]
    )
    poles, vectors = eig(state)
    driven = np.linalg.solve(vectors, np.vstack([np.zeros((n, n)), np.linalg.inv(mass)]).astype(np.complex128))

    def term(s: Complexes) -> Complexes:
        front = air.bulk_modulus / modes.mesh.volume * (s + 2 * losses.decay_rate) * (1 + tau * s)
        ratio: Complexes = front / (s - poles[:, None])
        return ratio

    return vectors[:n], driven, term


def _absorbed(modes: CavityModes, walls: Mapping[str, Wall], air: Air) -> Floats:
    """Integrals of beta psi_n psi_m over all walls, over the volume [n, n] [1/m]; beta is the two modes' geometric
    mean."""
    frequency_hz = modes.wavenumber * air.c / (2 * np.pi)
    total = np.zeros((len(frequency_hz), len(frequency_hz)))
    for name, wall in walls.items():
        root = np.sqrt(wall.at(frequency_hz))
        total += root[:, None] * wall_integrals(modes, name) * root / modes.mesh.volume
    return total


def _coupling(modes: CavityModes, absorbed: Floats, air: Air) -> float:
    """Largest rate by which walls couple two modes, c |A_nm|, over the distance of their frequencies or, where they lie
    closer than that, over their own rates."""
    distance = air.c * np.abs(modes.wavenumber[:, None] - modes.wavenumber)
    rates = air.c * np.abs(absorbed)
    off = rates - np.diag(np.diag(rates))
    span = np.hypot(distance, np.add.outer(np.diag(rates), np.diag(rates)))
    ratio = np.divide(off, span, out=np.zeros_like(off), where=off > 0)
    return float(ratio.max(initial=0.0))


def _judgement(surface: SurfaceVelocity, modes: CavityModes, air: Air) -> list[Advice]:
    """Advice on a velocity beyond the modes and on cells too coarse for them."""
    # of the surface itself: the modes that are there cannot tell what drives those that are not
    loudest = np.abs(surface.shapes).max(axis=0)
    highest_hz = source_bandwidth(loudest[:, None] * surface.rates, surface.dt)
    complete_hz = modes.complete_below * air.c / (2 * np.pi)
    found = []
    if highest_hz > complete_hz:
        found.append(
            Advice(
                "room-modes-missing",
                f"the surface moves up to {highest_hz:.4g} Hz, the modes of the room end at {complete_hz:.4g} Hz; "
                "above it only their answer at rest is there",
                {"source_highest_hz": highest_hz, "complete_below_hz": complete_hz},
            )
        )
    per_wave = 2 * np.pi / (modes.complete_below * modes.mesh.largest_cell)
    if per_wave < CELLS_PER_WAVE:
        found.append(
            Advice(
                "room-mesh-coarse",
                f"a wave at {complete_hz:.4g} Hz has {per_wave:.1f} cells of {modes.mesh.largest_cell:.3g} m, "
                f"{CELLS_PER_WAVE:g} are needed for 0.1 % in frequency",
                {"cells_per_wave": per_wave, "needed": CELLS_PER_WAVE},
            )
        )
    return found
