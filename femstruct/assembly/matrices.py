"""Assembly: the matrices of a meshed model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csc_array, csr_array

from femstruct.arrays import Floats, freeze, frozen
from femstruct.errors import FemstructError
from femstruct.model.materials.loss_by_frequency import Loss


@dataclass(frozen=True, eq=False)
class DofMap:
    """Which degrees of freedom exist and how the nodes follow them.

    T [n_nodes * 7, n_free] : nodal components from the free degrees of freedom; ties, joints and supports are in it.
    labels [n_free] : a name for each, for messages, made when asked for: "floor node 12 (0.1, 0.2, 0) RX".

    Two degrees of freedom of one node, UX and UZ, that is held along y and does not turn:

    >>> from scipy.sparse import csr_array
    >>> places = csr_array(([1.0, 1.0], ([0, 2], [0, 1])), shape=(7, 2))
    >>> DofMap(places, ("UX", "UZ")).T.shape
    (7, 2)
    """

    T: csr_array
    labels: Sequence[str]

    def __post_init__(self) -> None:
        if self.T.shape[1] != len(self.labels):
            raise FemstructError("DofMap labels", got=f"{len(self.labels)}", expected=f"{self.T.shape[1]}")


@dataclass(frozen=True, eq=False)
class ForceRows:
    """A force of the structure as rows on the free degrees of freedom: S u + B u' + A u'', and of loads: + D f.

    Each is [3, n_free], direct [3, n_nodes * 7], the global x, y, z components [N]. The sign is that of the force on
    what carries the part away from it: on the ground for springs to ground, foundations and supports (so a weight
    pressing down is negative along z), on the second end for a spring between two places, on the second part for a
    joint or a foundation between two.

    carried [3, 3] : the force [N] per acceleration of the base along x, y, z [m/s^2] (columns) when all that stands on
    the ground moves with it and nothing moves on it: what is held carries the mass of its own nodes along.

    direct acts on the loads f at the nodal components: what of them acts on held or joined nodes themselves passes on
    without moving anything. So does a load in the plane of a plate held in its plane, or a part of one in a cell next
    to a support, whose shape functions give it to the held nodes.
    """

    stiffness: csr_array
    damping: csr_array
    inertia: csr_array
    direct: csr_array
    carried: Floats = field(default_factory=lambda: np.zeros((3, 3)))

    def __post_init__(self) -> None:
        freeze(self, carried=frozen("ForceRows carried", self.carried, (3, 3)))


@dataclass(frozen=True, eq=False)
class Assembly:
    """Matrices on the free degrees of freedom, and all that is read off them.

    M, K, C [n_free, n_free] : sparse, symmetric; C holds the permanent dashpots only.
    dofs : the map to the nodes. points [n_nodes, 3] : node coordinates [m].
    part_stiffness : K of every part that deforms, [n_free, n_free]; they add up to K.
    loss_factors : eta of every part in part_stiffness [1].
    forces : of every spring, foundation, support and joint by name, and "ground": the sum of what reaches the ground.
    momentum [3, n_free] : r^T M of the rigid translations along x, y, z. total_mass [kg].
    grounded : names of the forces that add up to "ground". growing : parts whose stiffness grows with the square root
    of frequency, as walls at edges, and the frequency [Hz] at which K and part_stiffness have it.

    Its matrices are scipy's, for any other program; `given_matrices` makes one of those of another program:

    >>> from femstruct import Block, PlaceOn, Spring, Structure, assemble, mesh_structure
    >>> block = Block("block", 500.0, origin=(0.0, 0.0, 0.0), size=(1.0, 0.5, 0.2))
    >>> feet = PlaceOn("feet", "block", at=((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.5, 0.0), (1.0, 0.5, 0.0)))
    >>> springs = Spring("springs", "feet", None, stiffness=(0.0, 0.0, 1e6, 0.0, 0.0, 0.0))
    >>> assembly = assemble(mesh_structure(Structure("a block on springs", (block, springs), points=(feet,))))
    >>> float(assembly.K[2, 2]), float(assembly.M[2, 2]), assembly.dofs.labels[2]
    (4000000.0, 500.0, 'block node 0 (0.5, 0.25, 0.1) UZ')
    """

    M: csc_array
    K: csc_array
    C: csc_array
    dofs: DofMap
    points: Floats
    part_stiffness: Mapping[str, csc_array]
    loss_factors: Mapping[str, Loss]
    forces: Mapping[str, ForceRows]
    momentum: Floats
    total_mass: float
    grounded: tuple[str, ...] = ()
    growing: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        n = self.dofs.T.shape[1]
        freeze(
            self,
            points=frozen("Assembly points", self.points, (None, 3)),
            momentum=frozen("Assembly momentum", self.momentum, (3, n)),
        )
        for name in ("M", "K", "C"):
            if getattr(self, name).shape != (n, n):
                raise FemstructError(f"Assembly.{name}", got=f"{getattr(self, name).shape}", expected=f"{(n, n)}")
