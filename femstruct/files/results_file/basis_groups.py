"""Modal bases in the results file: modes, forces of the structure, damping."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from femstruct.conventions import COMPONENTS
from femstruct.files.results_file.datasets import axis, group, put
from femstruct.modal.basis import ModalBasis
from femstruct.model.probe import Probe
from femstruct.study.recorded import DAMPED_FORCE

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py


def write_basis(target: h5py.Group, basis: ModalBasis) -> None:
    """Modes, shapes and forces of a basis."""
    count = len(basis.omega)
    target.attrs["complete_below_hz"] = basis.complete_below_hz
    mode = axis(target, "mode", np.arange(1, count + 1), "1", "Mode number, rigid-body modes counted")
    node = axis(target, "node", np.arange(len(basis.points)), "1", "Node number")
    component = axis(target, "component", list(COMPONENTS), "1", "Component of a node, global axes; TWIST local")
    direction = axis(target, "direction", ["x", "y", "z"], "1", "Global direction")
    put(target, "frequency_hz", basis.frequency_hz, "Hz", "Natural frequency", (mode,))
    put(target, "kind", list(basis.kind), "1", "rigid, elastic, or residual (completes a static response)", (mode,))
    put(target, "residual_norm", basis.residual_norm, "1", "Convergence of the eigenpair", (mode,))
    put(target, "modal_mass", basis.modal_mass, "kg", "Effective modal mass", (direction, mode))
    put(target, "points", basis.points, "m", "Nodes, global axes", (node, direction))
    put(target, "shapes", basis.shapes, "kg^-0.5", "Mass-normalised shapes", (node, component, mode), whole=0)
    if basis.outputs:
        rows = np.array([[row.stiffness, row.damping, row.inertia] for row in basis.outputs.values()])
        about = f"Force of a spring, foundation, support or joint, {DAMPED_FORCE} where a case has one"
        output = axis(target, "output", list(basis.outputs), "1", about)
        acts_on = axis(target, "acts_on", ["q", "qd", "qdd"], "1", "What the row multiplies, to be summed")
        put(
            target,
            "force_rows",
            rows,
            "N, N s, N s^2 per kg^0.5 m",
            "Forces, of undamped parts; what of a load passes straight on is in direct",
            (output, acts_on, mode),
        )
        passed = [(name, row.direct) for name, row in basis.outputs.items() if len(row.direct.weights)]
        if passed:
            _write_direct(group(target, "direct", "What of a load passes straight on to a force"), passed)
    if basis.part_stiffness:
        omega2 = np.where(basis.omega > 0, basis.omega, np.nan) ** 2
        share = np.array([np.diag(matrix) / omega2 for matrix in basis.part_stiffness.values()])
        part = axis(target, "part", list(basis.part_stiffness), "1", "Part of the structure")
        put(target, "strain_energy_share", share, "1", "Share of the strain energy; nan if rigid", (part, mode))


def _write_direct(target: h5py.Group, passed: Sequence[tuple[str, Probe]]) -> None:
    """Entries of the sparse rows of `ForceRow.direct`: loads on held and joined nodes, times the weight, add to it."""
    names = [name for name, probe in passed for _ in probe.weights]
    nodes, components, weights = (
        np.concatenate([getattr(probe, word) for _, probe in passed]) for word in ("nodes", "components", "weights")
    )
    entry = axis(target, "entry", np.arange(1, len(names) + 1), "1", "Number")
    put(target, "output", names, "1", "Force that it adds to", (entry,))
    put(target, "node", nodes, "1", "Node that the load acts on", (entry,))
    put(target, "component", [COMPONENTS[i] for i in components], "1", "Its component, global axes", (entry,))
    put(target, "weight", weights, "N per unit load", "Share of the load", (entry,))


def write_damping(target: h5py.Group, basis: ModalBasis) -> None:
    """The damping that a basis has in a case."""
    numbers = np.arange(1, len(basis.omega) + 1)
    pair = tuple(axis(target, name, numbers, "1", "Mode number") for name in ("mode", "other_mode"))
    put(target, "damping_ratio", basis.damping_ratio, "1", "Damping ratio; nan for rigid-body modes", pair[:1])
    put(target, "viscous", basis.viscous, "rad/s", "Viscous damping, 2 zeta omega on the diagonal", pair)
    put(target, "hysteretic", basis.hysteretic, "rad^2/s^2", "Structural damping, eta omega^2 on the diagonal", pair)
