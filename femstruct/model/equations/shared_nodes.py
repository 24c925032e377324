"""Parts of one mesh file that share nodes there: they are joined by that, as in the program that wrote the file."""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array

from femstruct.arrays import Integers
from femstruct.conventions import N_COMPONENTS
from femstruct.model.equations.seam import Seam
from femstruct.model.fastened import Tie
from femstruct.model.imported.attached import same_file
from femstruct.model.model import Model
from femstruct.model.rows import node_rows


class Shared(NamedTuple):
    """Two parts of one file and the nodes they share there, as numbers of both [m, 2]."""

    a: str
    b: str
    pairs: Integers

    @property
    def name(self) -> str:
        """What the force between them is called."""
        return f"{self.a} and {self.b}"


def shared_nodes(model: Model) -> tuple[Shared, ...]:
    """All pairs of parts of a mesh file that share nodes and that no joint or seam of the model joins."""
    joined = {frozenset((joint.a, joint.b)) for joint in model.structure.joints}
    joined |= {frozenset((one.on, one.onto)) for one in model.structure.constraints if isinstance(one, Seam)}
    found = []
    own = {name: of for name, part in model.parts.items() if len(part.quads) and (of := part.of_file) is not None}
    for a, b in combinations(own, 2):
        if frozenset((a, b)) in joined or not same_file(own[a][0], own[b][0]):
            continue
        rows, first, second = np.intersect1d(own[a][1], own[b][1], return_indices=True)
        pairs = np.stack([model.parts[a].nodes[first], model.parts[b].nodes[second]], axis=1)
        free = np.isin(pairs[:, 0], model.parts[a].joinable) & np.isin(pairs[:, 1], model.parts[b].joinable)
        if (kept := free & (rows >= 0)).any():
            found.append(Shared(a, b, pairs[kept]))
    return tuple(found)


def shared_tie(shared: Shared, model: Model) -> Tie:
    """Displacements of shared nodes are the same, and their rotations where both parts have them."""
    turns = model.parts[shared.a].has_rotations and model.parts[shared.b].has_rotations
    components = np.eye(6 if turns else 3, N_COMPONENTS)
    one, other = (
        node_rows(np.repeat(nodes, len(components)), np.tile(components, (len(nodes), 1)), model.mesh.n_nodes)
        for nodes in shared.pairs.T
    )
    directions = np.tile(components[:, :3], (len(shared.pairs), 1))
    return Tie(shared.name, csr_array(one - other), directions, grounded=False)
