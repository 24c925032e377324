"""What a kind of part offers to the rest of the program. The kinds stand in `femstruct.parts`, one file each.

A `Part` is described, a `Meshed` part has nodes (`femstruct.model.meshed`). Whoever adds a kind overrides what it has;
what it has not is nothing. The way of a part, in order::

    corners, body              how large it is, what it fills                  before there is a mesh
    lay_out, needs             grid lines of its own, nodes it needs of others  femstruct.model.grid.layout
    meshed -> Meshed           its nodes, and what they can do
    fastened -> Elastic, Inert, Tie    what it adds to nodes, its own or others'  once all parts are meshed

A kind may have nodes, be fastened to those of others, or both: then what is fastened may have the part's own name.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.errors import Finding
from femstruct.model.fastened import Elastic, Inert, Tie
from femstruct.model.given import Given, given
from femstruct.model.imported.stated.left_out import Makes
from femstruct.model.materials.orthotropic import AnyMaterial
from femstruct.model.meshed import Meshed

if TYPE_CHECKING:
    from femstruct.model.grid.layout import Grids, Layout
    from femstruct.model.imported.attached import Attached, Users
    from femstruct.model.imported.imported_mesh import ImportedMesh
    from femstruct.model.model import Model


class Body(NamedTuple):
    """The box that a part fills: a corner [3], axes [3, 3] as rows, sides [3] along them [m].

    across : the one of its axes that its sides face along; None for a box, whose sides face along all.
    """

    corner: Floats
    axes: Floats
    size: Floats
    across: int | None


class Part:
    """A part as it is described, by name; the base of all kinds."""

    name: str

    def described(self) -> tuple[Given, ...]:
        """What is given of it, for tables of inputs and for comparing cases: its fields; a kind adds units."""
        return given(self, {})

    def corners(self) -> Floats:
        """Places [n, 3] that bound it [m]; none for what acts between others. Raises InputError for sizes it cannot
        have."""
        return np.zeros((0, 3))

    def body(self) -> Body | None:
        """The box it fills, where layers can lie against it."""
        return None

    def middles(self) -> Floats:
        """Middles of its cells [n, 3] [m], of parts that are meshes, to see what is in one place twice."""
        return np.zeros((0, 3))

    def taken(self) -> tuple[tuple[ImportedMesh, Mapping[str, Integers]], ...]:
        """Meshes of files that it is made of, with the rows of their cells that it takes, by kind."""
        return ()

    def stands_for(self) -> frozenset[Makes]:
        """What it states itself of what a file may state of its cells, or what it is in place of cards of a file."""
        return frozenset()

    def takes(self) -> frozenset[Makes]:
        """What it takes of what a file states of its cells and readers count among what is left out."""
        return frozenset()

    def written_thickness(self) -> tuple[float, ...]:
        """Thicknesses [m] that the model states for cells of a mesh from a file; none where those of the file hold."""
        return ()

    def attaches(self, users: Users) -> Attached | None:
        """What it takes of what a mesh file states beside its cells. users : the cells that parts take of their
        files."""
        return None

    @property
    def cell_size(self) -> float:
        """Largest side of its cells where bars can lie on them beside its nodes [m]; infinite of others."""
        return np.inf

    def lay_out(self, layout: Layout) -> None:
        """Give the layout its grid lines, and the geometry that joints meet."""

    def needs(self, layout: Layout) -> None:
        """Ask for nodes of other parts where this one acts on them."""

    def carriers(self) -> tuple[str | None, ...]:
        """Names of the points it is fastened to: asked for here, each gets a node."""
        return ()

    def identity(self, places: Mapping[str, object]) -> tuple[object, ...] | None:
        """What it is called and all that makes it what it is but its name; two parts of one identity are one, given
        twice. None for what is judged by the space it fills. places : what to put for the name of a point."""
        return None

    def materials(self) -> tuple[AnyMaterial, ...]:
        """What it is made of."""
        return ()

    def bears(self) -> tuple[str, ...]:
        """Names of the parts that lie on it or under it all over, and so do not sag by themselves."""
        return ()

    def implausible(self, lies: bool) -> tuple[Finding, ...]:
        """Numbers of its own that are surely not meant, materials aside; lies : whether another part bears it."""
        return ()

    def meshed(self, layout: Layout, grids: Grids, first: int) -> Meshed | None:
        """The part with nodes, numbered from `first`; None for what has none of its own."""
        return None

    def fastened(self, model: Model, tolerance: float) -> tuple[Elastic | Inert | Tie, ...]:
        """What it adds to nodes: springs, masses, equations."""
        return ()
