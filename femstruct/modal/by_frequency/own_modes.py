"""Modes of structures with walls at their edges, whose stiffness and losses grow with the square root of frequency.

(K + sqrt(omega / omega_w) W - omega^2 M) phi = 0 with complex W, which makes omega complex: each mode at its own
frequency, not to first order in the losses. Solved on modes and residual vectors of a real reference.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.errors import NotConverged

Complex = NDArray[np.complex128]
GRID: Final = 24  # frequencies at which real modes are solved for, to start from
STEPS: Final = (0.25, 0.5, 0.75, 1.0)  # of the losses, one after the other, so that each mode is followed
TURNS: Final = 12  # of the iteration with one inverse; each gains a digit or more where modes are apart
INVERSES: Final = 8  # at the frequencies found so far, where they are not
BESIDE: Final = 1e-5j  # of a frequency: where the inverse is, since that of a mode without walls would be singular
SETTLED: Final = 1e-11  # relative change of a frequency
DEPENDENT: Final = 1e-6  # of the largest: what others leave of a vector is rounding
_CHUNK: Final = 2**21  # complex numbers held at once: 32 MB


@dataclass(frozen=True, eq=False)
class OwnModes:
    """Modes at their own frequencies. omega [m] : real part of the complex frequency [rad/s]. loss [m] : twice the
    imaginary over the real part [1]. turn [k, n] : orthonormal, to rigid modes, these, and what is left of the residual
    vectors, whose squared frequencies are rest [n - m] [rad^2/s^2]. shares [w, m] : of each wall's losses [1].
    first_order [m] : loss factors by strain energy [1]."""

    omega: Floats
    loss: Floats
    turn: Floats
    rest: Floats
    shares: Floats
    first_order: Floats


def own_modes(
    stiffness: Floats, walls: Sequence[Complex], reference_hz: float, rigid: int, count: int, residual: int
) -> OwnModes:
    """Modes at their own frequencies, from what spans them at a reference.

    stiffness [k, k] : on modes, residual vectors of probes, and those of edges, all orthonormal to the mass, with the
    walls at the reference. walls : complex stiffness [k, k] of each wall there. rigid, count : how many rigid and how
    many modes in all; residual : how many vectors of probes follow them.

    Raises NotConverged where a mode is not found.
    """
    k, reference = len(stiffness), 2.0 * np.pi * reference_hz
    lossy: Complex = np.sum(walls, axis=0)
    bare = stiffness - lossy.real
    omega, vectors = _real_ones(bare, lossy.real, reference, rigid, count)
    stiff = np.einsum("ir,ij,jr->r", vectors, lossy, vectors) * np.sqrt(omega / reference)
    first_order = stiff.imag / omega**2
    roots, shapes = omega.astype(np.complex128), vectors.astype(np.complex128)
    size = max(1, _CHUNK // k**2)
    for step in STEPS:
        at = lossy.real + 1j * step * lossy.imag
        pieces = [
            _followed(bare, at, reference, roots[i : i + size], shapes[:, i : i + size])
            for i in range(0, len(roots), size)
        ]
        roots, shapes = (np.concatenate([piece[j] for piece in pieces], axis=-1) for j in (0, 1))
    order = np.argsort(roots.real, kind="stable")
    roots, shapes, first_order = roots[order], shapes[:, order], first_order[order]
    _refuse_twins(roots, shapes, reference)
    lost = np.array([np.einsum("ir,ij,jr->r", shapes.conj(), wall.imag, shapes).real for wall in walls])
    turn, rest = _turned(stiffness, shapes.real, rigid, np.eye(k)[:, count : count + residual])
    loss = 2.0 * roots.imag / roots.real
    return OwnModes(roots.real, loss, turn, rest, lost / lost.sum(axis=0).clip(1e-300), first_order)


def _real_ones(bare: Floats, wall: Floats, reference: float, rigid: int, count: int) -> tuple[Floats, Floats]:
    """Frequencies [m] [rad/s] and shapes [k, m] of modes with real walls, each near its own frequency."""
    stiffest = np.sqrt(np.linalg.eigvalsh(bare + 100.0 * wall)[count - 1])
    lowest = np.sqrt(max(float(np.linalg.eigvalsh(bare)[rigid]), 1e-6 * stiffest**2))
    grid = np.geomspace(0.9 * lowest, 1.1 * stiffest, GRID)
    found, vectors = np.linalg.eigh(bare + np.sqrt(grid / reference)[:, None, None] * wall)
    squared = found[:, rigid:count].clip(1e-300)
    nearest = np.argmin(np.abs(np.log(squared / grid[:, None] ** 2)), axis=0)
    own = np.arange(count - rigid)
    return np.sqrt(squared[nearest, own]), np.ascontiguousarray(vectors[nearest, :, rigid + own].T)


def _followed(
    bare: Floats, wall: Complex, reference: float, roots: Complex, shapes: Complex
) -> tuple[Complex, Complex]:
    """Complex frequencies [m] and shapes [k, m] by residual inverse iteration, with an inverse for each.

    A. Neumaier, SIAM Journal on Numerical Analysis 22 (1985) 914-923.
    """
    k = len(bare)
    x = shapes
    w = _functional(bare, wall, reference, roots, x)
    for _ in range(INVERSES):
        start = w * (1.0 + BESIDE)
        stiff = bare + np.sqrt(start / reference)[:, None, None] * wall
        fixed = np.linalg.inv(stiff - (start**2)[:, None, None] * np.eye(k))
        for _ in range(TURNS):
            left = bare @ x + np.sqrt(w / reference) * (wall @ x) - w**2 * x
            x = x - np.einsum("rij,jr->ir", fixed, left)
            x = x / np.sqrt((x * x).sum(axis=0))
            before, w = w, _functional(bare, wall, reference, w, x)
            if np.abs(w / before - 1.0).max() < SETTLED:
                return w, x
    worst = int(np.argmax(np.abs(w / before - 1.0)))
    got = f"a frequency near {w[worst].real / (2.0 * np.pi):.4g} Hz that does not settle"
    raise NotConverged("modes with walls", got=got, do="ask for a few more modes")


def _functional(bare: Floats, wall: Complex, reference: float, w: Complex, x: Complex) -> Complex:
    """The root of each shape's own equation x^T (K + sqrt(w / reference) W - w^2) x = 0, by Newton's method."""
    stiff, grows, mass = ((x * part).sum(axis=0) for part in (bare @ x, wall @ x, x))
    for _ in range(8):
        scale = np.sqrt(w / reference)
        w = w - (stiff + scale * grows - w**2 * mass) / (scale * grows / (2.0 * w) - 2.0 * w * mass)
    return w


def _refuse_twins(roots: Complex, shapes: Complex, reference: float) -> None:
    """Raise NotConverged where two modes ended in one."""
    for after in range(1, min(4, len(roots))):
        near = np.abs(roots[after:] - roots[:-after]) < 1e-8 * np.abs(roots[after:])
        alike = np.abs((shapes[:, after:] * shapes[:, :-after]).sum(axis=0)) > 1.0 - 1e-6
        if (near & alike).any():
            hz = float(roots.real[after:][near & alike][0]) / (2.0 * np.pi)
            raise NotConverged("modes with walls", got=f"one mode twice, at {hz:.4g} Hz", do="use a weaker wall")


def _turned(stiffness: Floats, shapes: Floats, rigid: int, residual: Floats) -> tuple[Floats, Floats]:
    """Orthonormal [k, n]: rigid modes, those nearest to real parts of shapes [k, m], and of residual vectors [k, r]
    what these leave, diagonal in the stiffness, with their squared frequencies."""
    first = np.eye(len(stiffness))[:, :rigid]
    own = shapes - first @ (first.T @ shapes)
    left, _, right = np.linalg.svd(own, full_matrices=False)
    modes = np.concatenate([first, left @ right], axis=1)
    others = residual
    for _ in range(2):  # twice, for the rounding of the first pass
        others = others - modes @ (modes.T @ others)
    span, sizes, _ = np.linalg.svd(others, full_matrices=False)
    kept = span[:, sizes > DEPENDENT]
    rest, turn = np.linalg.eigh(kept.T @ stiffness @ kept)
    return np.concatenate([modes, kept @ turn], axis=1), rest


def wall_shares(own: OwnModes, index: int, loss: float, wall: Floats, rigid: int) -> Floats:
    """What a wall has of the stiffness of the modes [n, n], diagonal, so that its loss factor gives its losses.

    wall [k, k] : its real stiffness on modes and residual vectors at the reference.
    """
    first = len(own.omega) + rigid
    held: Floats = np.einsum("ir,ij,jr->r", own.turn, wall, own.turn)
    held[:rigid] = 0.0
    held[rigid:first] = own.shares[index] * own.loss * own.omega**2 / loss
    return np.diag(held)
