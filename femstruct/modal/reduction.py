"""From an assembly to its modal basis: the way through the door out of the finite-element wing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from femstruct.arrays import Floats
from femstruct.assembly.matrices import Assembly
from femstruct.declared import expect
from femstruct.errors import Finding, InputError
from femstruct.modal.basis import Kind, ModalBasis
from femstruct.modal.by_frequency import (
    at_frequency,
    complex_walls,
    edge_vectors,
    losses_alike,
    own_modes,
    wall_findings,
    wall_shares,
)
from femstruct.modal.eigen import Modes, modes, relative_energy
from femstruct.modal.residuals import AXES, convergence, force_rows, nodal_shapes, project, residual_vectors
from femstruct.model.probe import Probe

_GAIN = 1e-6  # of the largest damping of a motion: matrices in single precision leave 1e-7
_CAPTURED = 0.9  # of the mass: the share below which a direction counts as cut short
_ROUNDING = 1e-16  # of the terms that a strain energy is summed from: what is measured at most (`eigen.UNSTRAINED`)
NOTABLE = 1e-3  # of a frequency
SEVERE = 1e-2


def modal_basis(
    assembly: Assembly,
    *,
    up_to: float | None = None,
    count: int | None = None,
    probes: Sequence[Probe] = (),
    base: Sequence[str] = (),
    orders: int = 2,
) -> ModalBasis:
    """Mass-normalised modes up to a frequency or a number of them, with two residual vectors for every probe.

    Parameters
    ----------
    up_to : float | None
        Upper frequency [Hz]; all modes with f <= up_to are returned, none is skipped (inertia count).
    count : int | None
        Number of modes, rigid ones counted. Give one of the two.
    probes : Sequence[Probe]
        Where the structure will be driven or observed; the static response to forces there is exact. The places of
        permanent dashpots are added to them.
    base : Sequence[str]
        Axes "x", "y", "z" along which all that stands on the ground will be moved as one; the static response to such
        an acceleration is exact, too.
    orders : int
        How many residual vectors a probe has: derivatives of responses need the motion itself, not its work.

    Returns
    -------
    ModalBasis
        A ModalBasis with no other damping than the permanent dashpots': `with_damping` adds the structure's own.

    Raises
    ------
    SingularSystem
        When K and M share a null vector (a massless mechanism); it names node and component. NotConverged when modes
        and inertia count do not agree. InputError for dashpots that give energy to a motion.

    Notes
    -----
    Bit-reproducible on one machine and number of threads. Modes come first, ascending; the residual
    pseudo-modes after them have frequencies above, which mean nothing by themselves. `complete_below_hz` ignores them;
    it is infinite for a basis of every mode there is.

    Examples
    --------
    >>> from femstruct.assembly.matrices import assemble
    >>> from femstruct.model.materials import Material
    >>> from femstruct.model.mesher import mesh_structure
    >>> from femstruct.model.structure import Structure, Support
    >>> from femstruct.parts.plate import Plate
    >>> steel = Material("steel", E=210e9, nu=0.3, rho=7850.0)
    >>> plate = Plate("plate", steel, 0.003, origin=(0.0, 0.0, 0.0), size=(0.5, 0.4), mesh=(10, 8))
    >>> edges = Support("edges", "simple", on="plate", edge="all")
    >>> assembly = assemble(mesh_structure(Structure("on all edges", (plate,), supports=(edges,))))

    Mode (1, 1) of the closed form, (pi / 2) sqrt(D / rho h) (1 / a^2 + 1 / b^2), is at 75.6 Hz:

    >>> basis = modal_basis(assembly, up_to=200.0)
    >>> basis.frequency_hz.round(1)
    array([ 75.6, 164.1])
    """
    expect("modal_basis", assembly, Assembly, "assemble makes one of a Model")
    expect("modes up_to", up_to, float | None)
    expect("modes count", count, int | None)
    probes = expect("modes probes", probes, tuple[Probe, ...], 'model.points["NAME"].probe("z") is one')
    if unknown := [axis for axis in base if axis not in AXES]:
        raise InputError("modes base", got=f"{unknown[0]!r}", expected="axes of x, y, z")
    assembly = _with_walls_near(assembly, up_to, count)
    found = modes(assembly.K, assembly.M, up_to_hz=up_to, count=count, labels=assembly.dofs.labels)
    moved = assembly.momentum[[AXES.index(axis) for axis in base]].T
    loads = np.concatenate([_loads(assembly, probes), moved, _dashpots(assembly)], axis=1)
    extra_values, extra_shapes = residual_vectors(assembly.K, assembly.M, found, loads, orders)
    values = np.concatenate([found.eigenvalues, extra_values])
    shapes = np.concatenate([found.shapes, extra_shapes], axis=1)
    residual_norm = convergence(assembly.K, assembly.M, values, shapes)
    n_modes = len(found.eigenvalues)
    values, shapes, walls, of_walls = _at_own_frequencies(assembly, found, values, shapes)
    n_extra, residual_norm = len(values) - n_modes, residual_norm[: len(values)]
    parts = {name: project(part, shapes) for name, part in assembly.part_stiffness.items()}
    if walls and losses_alike(assembly):
        parts = {name: np.diag(np.diag(part)) for name, part in parts.items()}
    rigid: tuple[Kind, ...] = ("rigid",)
    elastic: tuple[Kind, ...] = ("elastic",)
    extra: tuple[Kind, ...] = ("residual",)
    momentum: Floats = assembly.momentum @ shapes
    dashpots = _without_gain(project(assembly.C, shapes))
    complete_below_hz = float(np.sqrt(found.complete_below)) / (2.0 * np.pi)
    return ModalBasis(
        omega=np.sqrt(values),
        kind=rigid * found.n_rigid + elastic * (n_modes - found.n_rigid) + extra * n_extra,
        shapes=nodal_shapes(assembly, shapes),
        points=assembly.points,
        viscous=dashpots,
        dashpots=dashpots,
        hysteretic=np.zeros((len(values), len(values))),
        outputs=force_rows(assembly.forces, shapes),
        part_stiffness=parts | walls,
        loss_factors=dict(assembly.loss_factors),
        residual_norm=residual_norm,
        complete_below_hz=complete_below_hz,
        momentum=momentum,
        total_mass=assembly.total_mass,
        findings=(
            *_truncation(assembly, momentum[:, :n_modes] ** 2, values[:n_modes], complete_below_hz),
            *of_walls,
            *_rounded(assembly, found),
        ),
        grounded=assembly.grounded,
    )


def _with_walls_near(assembly: Assembly, up_to: float | None, count: int | None) -> Assembly:
    """The assembly with walls at its edges, if any, as they are at half the highest frequency: modes left out are
    higher at their own frequencies than there."""
    if not assembly.growing:
        return assembly
    if up_to is None:
        found = modes(assembly.K, assembly.M, count=count, labels=assembly.dofs.labels)
        up_to = float(np.sqrt(found.eigenvalues.max(initial=0.0))) / (2.0 * np.pi)
    return at_frequency(assembly, up_to / 2.0) if up_to > 0.0 else assembly


def _at_own_frequencies(
    assembly: Assembly, found: Modes, values: Floats, shapes: Floats
) -> tuple[Floats, Floats, dict[str, Floats], tuple[Finding, ...]]:
    """(omega^2, shapes, stiffness of walls at the edges, findings) with each mode at its own frequency, of structures
    with such walls; as they are without."""
    rigid, count, residual = found.n_rigid, len(found.eigenvalues), len(values) - len(found.eigenvalues)
    if not assembly.growing or count <= rigid:
        return values, shapes, {}, ()
    spanned = np.concatenate([shapes, edge_vectors(assembly, found, shapes)], axis=1)
    walls = complex_walls(assembly, spanned)
    reference = next(iter(assembly.growing.values()))
    own = own_modes(project(assembly.K, spanned), list(walls.values()), reference, rigid, count, residual)
    held = {
        name: wall_shares(own, i, float(wall.imag.trace() / wall.real.trace()), wall.real, rigid)
        for i, (name, wall) in enumerate(walls.items())
    }
    squared = np.concatenate([values[:rigid], own.omega**2, own.residual_squared])
    return squared, spanned @ own.turn, held, wall_findings(own, assembly.growing)


def _loads(assembly: Assembly, probes: Sequence[Probe]) -> Floats:
    """Forces on the free degrees of freedom of a unit force at every probe [n_free, p]."""
    transposed = assembly.dofs.T.T
    columns = [(transposed @ probe.row(len(assembly.points)).T).toarray() for probe in probes]
    return np.concatenate([np.zeros((assembly.K.shape[0], 0)), *columns], axis=1)


def _dashpots(assembly: Assembly) -> Floats:
    """Forces of the permanent dashpots [n_free, d]: they push where they sit, as a probe does."""
    touched = np.flatnonzero(assembly.C.diagonal())
    forces: Floats = assembly.C[:, touched].toarray()
    return forces


def _without_gain(dashpots: Floats) -> Floats:
    """Modal matrix of dashpots [k, k], none of whose motions gains energy.

    Raises InputError for one that does, as with a wrong sign in a matrix of another program.
    """
    if not dashpots.any():
        return dashpots
    rounding = _GAIN * float(np.diag(dashpots).max()) * np.eye(len(dashpots))
    try:
        scipy.linalg.cholesky(dashpots + rounding, check_finite=False)
    except scipy.linalg.LinAlgError:
        least = float(scipy.linalg.eigvalsh(dashpots, subset_by_index=(0, 0))[0])
        got = f"dashpots that give energy to a motion, at up to {-least:.3g} 1/s"
        raise InputError("C", got=got, expected="dashpots that take energy from every motion") from None
    return dashpots


def _truncation(
    assembly: Assembly, modal_mass: Floats, eigenvalues: Floats, complete_below_hz: float
) -> tuple[Finding, ...]:
    """A finding if the modes carry little of the mass in a direction the structure can move in, or there are none."""
    if not len(eigenvalues):
        message = (
            f"The structure has no mode below {complete_below_hz:.4g} Hz: only its residual vectors "
            "answer, which are meant for what the modes leave out. Ask for more modes; a plain number is in Hz."
        )
        return (Finding("no-modes", message, {"complete_below_hz": complete_below_hz, "modes": 0}, severe=True),)
    share = modal_mass.sum(axis=1) / assembly.total_mass if assembly.total_mass > 0 else np.ones(3)
    moves = np.abs(assembly.momentum).max(axis=1, initial=0.0) > 0.0
    short = moves & (share < _CAPTURED)
    if not short.any():
        return ()
    top = float(np.sqrt(eigenvalues[-1])) / (2.0 * np.pi) if len(eigenvalues) else 0.0
    listed = ", ".join(f"{axis} {100.0 * share[i]:.0f} %" for i, axis in enumerate(AXES) if moves[i])
    values = {f"share_{axis}": float(share[i]) for i, axis in enumerate(AXES)} | {"top_frequency_hz": top}
    message = (
        f"The effective masses of the {len(eigenvalues)} modes up to {top:.4g} Hz sum to this share of the total mass: "
        f"{listed}; {100.0 * _CAPTURED:.0f} % is asked for. The rest belongs to higher modes, which answer statically "
        "through the residual vectors, and to supports, which cannot move."
    )
    return (Finding("modal-mass-low", message, values),)


def _rounded(assembly: Assembly, found: Modes) -> tuple[Finding, ...]:
    """A finding if rounding of K changes an elastic frequency: of the strain energy by `_ROUNDING` of its terms."""
    elastic = slice(found.n_rigid, None)
    share = relative_energy(assembly.K, found.shapes[:, elastic])
    uncertain = np.divide(_ROUNDING / 2.0, share, out=np.full_like(share, np.inf), where=share > 0)
    if not uncertain.max(initial=0.0) > NOTABLE:
        return ()
    worst = int(np.argmax(uncertain))
    hz = float(np.sqrt(found.eigenvalues[elastic][worst])) / (2.0 * np.pi)
    largest = int(np.argmax(assembly.K.diagonal()))
    how = f"may be off by {uncertain[worst]:.1%}" if uncertain[worst] < 1.0 else "cannot be determined"
    message = (
        f"The frequency of the mode at {hz:.4g} Hz {how}: the stiffness that holds it is below the rounding error "
        f"of the largest stiffness, at {assembly.dofs.labels[largest]}. Where grid lines of a plate nearly coincide "
        "(those of points, edges of regions, joints), move them together or farther apart"
    )
    values = {"uncertain": min(float(uncertain[worst]), 1.0), "frequency_hz": hz}
    return (Finding("lost-in-rounding", message, values, severe=bool(uncertain[worst] > SEVERE)),)
