"""Assembly: the matrices of a meshed model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from scipy.sparse import csc_array, csr_array

from femstruct.arrays import Floats, freeze, frozen
from femstruct.errors import FemstructError


@dataclass(frozen=True, eq=False)
class DofMap:
    """Which degrees of freedom exist and how the nodes follow them.

    T [n_nodes * 7, n_free] : nodal components from the free degrees of freedom; ties, joints and supports are in it.
    labels [n_free] : a name for each, for messages, made when asked for: "floor node 12 (0.1, 0.2, 0) RX".
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

    direct acts on the loads f at the nodal components: what of them acts on held or joined nodes themselves passes on
    without moving anything. So does a load in the plane of a plate held in its plane, or a part of one in a cell next
    to a support, whose shape functions give it to the held nodes.
    """

    stiffness: csr_array
    damping: csr_array
    inertia: csr_array
    direct: csr_array


@dataclass(frozen=True, eq=False)
class Assembly:
    """Matrices on the free degrees of freedom, and all that is read off them.

    M, K, C [n_free, n_free] : sparse, symmetric; C holds the permanent dashpots only.
    dofs : the map to the nodes. points [n_nodes, 3] : node coordinates [m].
    part_stiffness : K of every part that deforms, [n_free, n_free]; they add up to K.
    loss_factors : eta of every part in part_stiffness [1].
    forces : of every spring, foundation, support and joint by name, and "ground": the sum of what reaches the ground.
    momentum [3, n_free] : r^T M of the rigid translations along x, y, z. total_mass [kg].
    grounded : names of the forces that add up to "ground".
    """

    M: csc_array
    K: csc_array
    C: csc_array
    dofs: DofMap
    points: Floats
    part_stiffness: Mapping[str, csc_array]
    loss_factors: Mapping[str, float]
    forces: Mapping[str, ForceRows]
    momentum: Floats
    total_mass: float
    grounded: tuple[str, ...] = ()

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
