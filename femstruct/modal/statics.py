"""A structure at rest under its weight and constant forces: displacements and what holds it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Floats, freeze, frozen
from femstruct.assembly.matrices import Assembly
from femstruct.conventions import GRAVITY, N_COMPONENTS
from femstruct.errors import InputError
from femstruct.modal.by_frequency import without_walls
from femstruct.modal.eigen import modes
from femstruct.model.model import Model, part_masses, refuse_unweighed
from femstruct.model.probe import Probe
from femstruct.sparse import FASTEST, SOLVERS, aligned

UP: Final = 2  # the global axis that weight acts against


@dataclass(frozen=True, eq=False)
class AtRest:
    """A structure at rest. displacement [n_nodes, 7] : components of its nodes [m, rad]. forces : of every spring,
    foundation, support, joint and on the ground, by name [3] [N], signs as of `ForceRows`. load [3] : the sum of all
    that acts [N].

    Two nodes, the second 2 mm lower:

    >>> low = np.zeros((2, 7)); low[1, 2] = -2e-3
    >>> AtRest(low, {}, np.array([0.0, 0.0, -50.0])).of(Probe([1], [2], [1.0]))
    -0.002
    """

    displacement: Floats
    forces: Mapping[str, Floats]
    load: Floats

    def __post_init__(self) -> None:
        freeze(
            self,
            displacement=frozen("AtRest displacement", self.displacement, (None, N_COMPONENTS)),
            load=frozen("AtRest load", self.load, (3,)),
        )

    def of(self, probe: Probe) -> float:
        """Displacement or rotation at a probe [m, rad]."""
        return float(probe.of(self.displacement[:, :, None])[0])


def statics(model: Model, assembly: Assembly, forces: Sequence[tuple[Probe, float]], weight: bool = False) -> AtRest:
    """A meshed structure under constant forces [N] at probes and, if asked for, its own weight.

    Raises InputError for a structure that can move as a whole, and for the weight of matrices that hold a part of
    themselves and lack the mass beside it.

    Notes
    -----
    Linear: displacements are small, and weight and forces do not change the stiffness. Weight is M g, with the mass
    matrix that modes have: that of a bar under its own weight is exact at its nodes. Of matrices that hold a part of
    themselves, the load is the weight of all, and what is held inside reaches nothing.

    The tip of a cantilever under its own weight, q L^4 / 8 E I:

    >>> from femstruct import Frame, Material, PlaceOn, Structure, Support, assemble, mesh_structure
    >>> from femstruct.model.sections import rectangle
    >>> steel = Material("steel", E=210e9, nu=0.3, rho=7850.0)
    >>> bar = Frame("bar", steel, rectangle("s", 0.01, 0.02), (((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),), mesh=0.05)
    >>> points = tuple(PlaceOn(name, "bar", at=((x, 0.0, 0.0),)) for name, x in (("foot", 0.0), ("tip", 1.0)))
    >>> wall = Support("wall", "clamped", at="foot")
    >>> model = mesh_structure(Structure("a bar", (bar,), points=points, supports=(wall,)))
    >>> rest = statics(model, assemble(model), [], weight=True)
    >>> round(1e3 * rest.of(model.points["tip"].probe("z")), 2), round(float(rest.forces["wall"][2]), 2)
    (-1.38, -15.4)
    """
    assembly = without_walls(assembly)
    _refuse_free(assembly)
    if weight:
        refuse_unweighed(model, "z", "the weight")
    nodal = _nodal(assembly, forces)
    gravity = GRAVITY if weight else 0.0
    pushed = _pushes(assembly, forces) - gravity * assembly.momentum[UP]
    moved = _moved(assembly, pushed)
    load = nodal.reshape(-1, N_COMPONENTS)[:, :3].sum(axis=0)
    load[UP] -= gravity * sum(part_masses(model).values())
    return AtRest(
        displacement=(assembly.dofs.T @ moved).reshape(-1, N_COMPONENTS),
        forces={
            # Mass on held nodes pulls at what holds it, as it resists a base that rises.
            name: np.asarray(rows.stiffness @ moved + rows.direct @ nodal + gravity * rows.carried[:, UP])
            for name, rows in assembly.forces.items()
        },
        load=load,
    )


def sag_displacements(
    assembly: Assembly, forces: Sequence[tuple[Probe, float]] = (), *, held: bool = False
) -> Floats | None:
    """Displacements [n_nodes, 7] of a structure under its own weight [m, rad]; None for one that can move as a whole.

    Parameters
    ----------
    forces : Sequence[tuple[Probe, float]] [N]
        At probes, beside the weight.
    held : bool
        Whether its modes say that it cannot, which else takes a search for one. Walls at edges hold nothing at rest.

    Notes
    -----
    One static solution, exact for the mesh: a sum over modes lacks what the modes beyond it carry, most of the weight
    of a floor whose first modes are those of a light ceiling.

    Examples
    --------
    A block of 2 t on a spring of 1 MN/m that holds it every way sinks by m g / k:

    >>> from femstruct import Block, PlaceOn, Spring, Structure, assemble, mesh_structure
    >>> block = Block("block", 2000.0, origin=(0.0, 0.0, 0.0), size=(1.0, 1.0, 1.0))
    >>> foot = PlaceOn("foot", "block", at=((0.5, 0.5, 0.0),))
    >>> spring = Spring("spring", "foot", None, stiffness=(1e6,) * 6)
    >>> moved = sag_displacements(assemble(mesh_structure(Structure("a block", (block, spring), points=(foot,)))))
    >>> round(-1e3 * float(moved[0, 2]), 2)
    19.61
    """
    known = held and not assembly.growing
    assembly = without_walls(assembly)
    if not known and _free(assembly):
        return None
    pushed = _pushes(assembly, forces) - GRAVITY * assembly.momentum[UP]
    moved = _moved(assembly, pushed)
    return np.asarray((assembly.dofs.T @ moved).reshape(-1, N_COMPONENTS))


def _nodal(assembly: Assembly, forces: Sequence[tuple[Probe, float]]) -> Floats:
    """Forces at probes on all nodes [n_nodes * 7] [N]."""
    nodal = np.zeros(len(assembly.points) * N_COMPONENTS)
    for probe, force in forces:
        nodal += force * probe.row(len(assembly.points)).toarray()[0]
    return nodal


def _pushes(assembly: Assembly, forces: Sequence[tuple[Probe, float]]) -> Floats:
    """The same on the free degrees of freedom [n_free] [N]."""
    return np.asarray((csr_array(_nodal(assembly, forces)[None]) @ assembly.dofs.T).toarray()[0])


def _moved(assembly: Assembly, pushed: Floats) -> Floats:
    """Static displacements of free degrees of freedom [n_free] under forces on them [n_free] [N]."""
    pattern, (values,) = aligned([assembly.K])
    factor = SOLVERS[FASTEST](pattern).factor(values)
    moved = np.asarray(factor.solve(pushed), dtype=np.float64)
    moved += np.asarray(factor.solve(pushed - assembly.K @ moved), dtype=np.float64)
    return moved


def _free(assembly: Assembly) -> int:
    """How many rigid modes there are."""
    return modes(assembly.K, assembly.M, count=1, labels=assembly.dofs.labels).n_rigid


def _refuse_free(assembly: Assembly) -> None:
    """Raise InputError for a structure with rigid modes."""
    if _free(assembly):
        raise InputError(
            "supports",
            got="a structure that can move as a whole",
            expected="supports or springs that hold it every way",
            do="'femstruct modes MODEL' counts its rigid-body modes; if springs hold it every way, look for grid lines "
            "that nearly coincide: the springs are below their rounding error",
        )
