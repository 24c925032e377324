"""What of a structure depends on frequency: walls at edges and loss factors, each mode at its own."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array

from femstruct.arrays import Floats
from femstruct.assembly.matrices import Assembly
from femstruct.errors import Finding, NotConverged
from femstruct.modal.eigen import Modes, factorise
from femstruct.modal.residuals import complement_solve, project
from femstruct.model.materials import LossByFrequency, loss_at

# ----------------------------------------------------------------------------------------------------------------------
# Stiffnesses that depend on frequency, for solutions at one frequency after the other.
# ----------------------------------------------------------------------------------------------------------------------


class Varying(NamedTuple):
    """What a part adds at an angular frequency [rad/s], which may be complex: factor(omega) stiffness.

    grows : with the square root of frequency.
    """

    stiffness: csc_array
    factor: Callable[[complex], complex]
    grows: bool


def loss_terms(assembly: Assembly, lossy: bool) -> tuple[Varying, ...]:
    """Walls at edges, and the losses of parts whose loss factors depend on frequency.

    Parameters
    ----------
    lossy : bool
        Whether the law of damping asks for those of parts, else walls are springs alone.
    """
    found = []
    for name, stiffness in assembly.part_stiffness.items():
        loss = assembly.loss_factors.get(name, 0.0)
        if name in assembly.growing:
            own = 1.0 + 1j * float(loss) * lossy if isinstance(loss, float) else 1.0
            found.append(Varying(stiffness, _growing(assembly.growing[name], own), True))
        elif lossy and isinstance(loss, LossByFrequency):
            found.append(Varying(stiffness, _tabled(loss), False))
    return tuple(found)


def _growing(at_hz: float, factor: complex) -> Callable[[complex], complex]:
    return lambda omega: complex(factor * np.sqrt(complex(omega) / (2.0 * np.pi * at_hz)))


def _tabled(loss: LossByFrequency) -> Callable[[complex], complex]:
    return lambda omega: 1j * float(loss.at(abs(omega) / (2.0 * np.pi)))


# ----------------------------------------------------------------------------------------------------------------------
# Modes of structures with walls at their edges, whose stiffness and losses grow with the square root of frequency.
#
# (K + sqrt(omega / omega_w) W - omega^2 M) phi = 0 with complex W, which makes omega complex: each mode at its own
# frequency, not to first order in the losses. Solved on modes and residual vectors of a real reference.
# ----------------------------------------------------------------------------------------------------------------------

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
    residual_squared: Floats
    shares: Floats
    first_order: Floats


def own_modes(
    stiffness: Floats, walls: Sequence[Complex], reference_hz: float, rigid: int, count: int, residual: int
) -> OwnModes:
    """Modes at their own frequencies, from what spans them at a reference.

    Parameters
    ----------
    stiffness : Floats [k, k]
        On modes, residual vectors of probes, and those of edges, all orthonormal to the mass, with the walls at the
        reference.
    walls : Sequence[Complex]
        Complex stiffness [k, k] of each wall there.
    rigid, count : int
        How many rigid and how many modes in all.
    residual : int
        How many vectors of probes follow them.

    Raises
    ------
    NotConverged
        Where a mode is not found.
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
    turn, residual_squared = _turned(stiffness, shapes.real, rigid, np.eye(k)[:, count : count + residual])
    loss = 2.0 * roots.imag / roots.real
    return OwnModes(roots.real, loss, turn, residual_squared, lost / lost.sum(axis=0).clip(1e-300), first_order)


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
    residual_squared, turn = np.linalg.eigh(kept.T @ stiffness @ kept)
    return np.concatenate([modes, kept @ turn], axis=1), residual_squared


def wall_shares(own: OwnModes, index: int, loss: float, wall: Floats, rigid: int) -> Floats:
    """What a wall has of the stiffness of the modes [n, n], diagonal, so that its loss factor gives its losses.

    Parameters
    ----------
    wall : Floats [k, k]
        Its real stiffness on modes and residual vectors at the reference.
    """
    first = len(own.omega) + rigid
    held: Floats = np.einsum("ir,ij,jr->r", own.turn, wall, own.turn)
    held[:rigid] = 0.0
    held[rigid:first] = own.shares[index] * own.loss * own.omega**2 / loss
    return np.diag(held)


# ----------------------------------------------------------------------------------------------------------------------
# Walls at the edges of plates in an assembly: at another frequency, left out, on modes, and what they bend it to.
# ----------------------------------------------------------------------------------------------------------------------

Complex = NDArray[np.complex128]
TRACES: Final = 1e-4  # of the largest: moments along edges that are nearly those of other modes
ALIKE: Final = 3.0  # ratio of loss factors up to which modes do not couple by them
STRONG: Final = 0.1  # loss factor from which on a sum of real modes is off by half a decibel
OFF_DB: Final = 4.0  # dB for a loss factor of one: measured 1.5 at 0.36 and 0.6 at 0.23


def at_frequency(assembly: Assembly, frequency_hz: float) -> Assembly:
    """The assembly with the walls at its edges as they are at another frequency [Hz]."""
    scales = {name: (frequency_hz / at) ** 0.5 for name, at in assembly.growing.items()}
    parts = {name: csc_array(scales.get(name, 1.0) * part) for name, part in assembly.part_stiffness.items()}
    return replace(
        assembly,
        K=_sum(list(parts.values())),
        part_stiffness=parts,
        growing=dict.fromkeys(assembly.growing, frequency_hz),
    )


def without_walls(assembly: Assembly) -> Assembly:
    """The assembly without the walls at its edges: as it is at rest."""
    if not assembly.growing:
        return assembly
    parts = {name: part for name, part in assembly.part_stiffness.items() if name not in assembly.growing}
    losses = {name: loss for name, loss in assembly.loss_factors.items() if name not in assembly.growing}
    K = _sum([*parts.values(), csc_array(assembly.K.shape)])
    return replace(assembly, K=K, part_stiffness=parts, loss_factors=losses, growing={})


def _sum(matrices: Sequence[csc_array]) -> csc_array:
    total = matrices[0]
    for matrix in matrices[1:]:
        total = csc_array(total + matrix)
    return total


def complex_walls(assembly: Assembly, shapes: Floats) -> dict[str, Complex]:
    """Complex stiffness [k, k] of every wall on shapes [n_free, k]."""
    found: dict[str, Complex] = {}
    for name in assembly.growing:
        loss = assembly.loss_factors[name]
        assert isinstance(loss, float)
        found[name] = np.asarray((1.0 + 1j * loss) * project(assembly.part_stiffness[name], shapes))
    return found


def losses_alike(assembly: Assembly) -> bool:
    """Whether the loss factors of all parts but walls are within a factor of three: then what couples modes through
    them changes nothing that shows, and is left out, which makes simulations sixty times as fast."""
    hz = np.array([50.0, 500.0])
    parts = [name for name in assembly.part_stiffness if name not in assembly.growing]
    losses = np.array([loss_at(assembly.loss_factors.get(name, 0.0), hz) for name in parts]).reshape(-1, len(hz))
    return bool((losses.max(axis=0, initial=0.0) <= ALIKE * losses.min(axis=0, initial=np.inf)).all())


def edge_vectors(assembly: Assembly, found: Modes, shapes: Floats) -> Floats:
    """What walls bend a structure to beside its modes [n_free, e]: static deflections under the moments that they give
    to the modes, orthonormal to the mass and to shapes [n_free, k]: modes and residual vectors.

    Without them the modes of one stiffness of the walls cannot be those of another: their sum converges slowly there.
    """
    loads = np.concatenate([assembly.part_stiffness[name] @ found.shapes for name in assembly.growing], axis=1)
    size = np.linalg.norm(loads, axis=0)
    span, sizes, _ = np.linalg.svd(loads[:, size > 0.0] / size[size > 0.0], full_matrices=False)
    moments = span[:, sizes > TRACES * sizes.max(initial=0.0)]
    if not moments.shape[1]:
        return moments
    bent = complement_solve(assembly.M, found.shapes, factorise(found.pencil, found.sigma), moments)
    for _ in range(3):
        bent = bent - shapes @ (shapes.T @ (assembly.M @ bent))
        left, sizes, _ = np.linalg.svd(bent.T @ (assembly.M @ bent))
        bent = bent @ (left / np.sqrt(sizes.clip(1e-300)))[:, sizes > DEPENDENT**2 * sizes.max()]
    return bent


def wall_findings(own: OwnModes, names: Iterable[str]) -> tuple[Finding, ...]:
    """A finding where walls take so much that a sum of real modes is inexact."""
    if not own.loss.size or own.loss.max() < STRONG:
        return ()
    worst = int(np.argmax(own.loss))
    hz, loss = float(own.omega[worst] / (2.0 * np.pi)), float(own.loss[worst])
    return (
        Finding(
            "walls-damp-much",
            f"{', '.join(names)}: the mode at {hz:.4g} Hz has a loss factor of {100 * loss:.3g} % by the walls alone "
            f"({100 * own.first_order[worst]:.3g} % by strain energy). Its frequency and decay are exact; a response "
            f"as the sum of real modes is lower than the exact one by up to {OFF_DB * loss:.1f} dB near it, and by "
            "more below the first mode, where the walls are softer than at any mode",
            {"loss_factor": loss, "first_order": float(own.first_order[worst]), "frequency_hz": hz},
        ),
    )
