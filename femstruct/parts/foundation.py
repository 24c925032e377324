"""Winkler foundations: elastic layers under a part, or between two."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from femstruct.arrays import Floats
from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.model.elastic_layers import LayerPlane, layer_of
from femstruct.model.layout import Layout
from femstruct.model.materials import Given, Loss, given_fields
from femstruct.model.model import Model
from femstruct.model.part import Elastic, Meshed, Part
from femstruct.model.regions import Region, Touched, grid_points, sparse_rows, to_rectangle
from femstruct.model.structure import bodies_of
from femstruct.parts.plate import Plate
from femstruct.tags import stored_as

NOTABLE = 1e-3  # of a frequency: plates that a layer would raise by less stay rigid in their planes
ORDER = 4  # Gauss points a direction: exact for products of two cubic deflections


@stored_as("foundation/1")
@dataclass(frozen=True)
@checked("parts")
class Foundation(Part):
    """A Winkler foundation under a region of a plate, slab or block, to the ground or to another of them.

    to : the other part, None for the ground. Between two parts it fills the gap between their facing sides, which are
    parallel; its shear acts in the middle of the gap, through arms of the thickness of both, so that a rigid motion of
    both strains nothing. To the ground it acts on the face that it touches, with half the thickness of a plate or slab
    as the arm of its shear: the lower face, or that of a plate or slab on `side`; "middle" leaves the arm out.
    region : of `on`; the whole is all that faces the other part, openings of slabs left out.
    normal, shear : stiffness per area [N/m^3] of a whole or rectangle region, per length [N/m^2] of a rim or line.
    like : the entry of the library that it was taken from, with its source.

    A block of 500 kg on a mat of 0.5 m^2 with 20 MN/m^3: f = sqrt(s A / m) / 2 pi.

    >>> from femstruct import Block, Structure, assemble, mesh_structure, modal_basis
    >>> block = Block("block", 500.0, origin=(0.0, 0.0, 0.0), size=(1.0, 0.5, 0.2))
    >>> mat = Foundation("mat", "block", Region("whole"), normal=20e6, shear=8e6)
    >>> basis = modal_basis(assemble(mesh_structure(Structure("a block on a mat", (block, mat)))), up_to=100.0)
    >>> bool(abs(basis.frequency_hz - (20e6 * 0.5 / 500.0) ** 0.5 / 6.283185307).min() < 1e-6)
    True
    """

    name: str
    on: str
    region: Region
    normal: float
    shear: float = 0.0
    loss_factor: Loss = 0.0
    to: str | None = None
    like: str = ""
    side: Touched = "below"

    @property
    def ends(self) -> tuple[str, ...]:
        """Names of the parts it acts on."""
        return (self.on,) if self.to is None else (self.on, self.to)

    def described(self) -> tuple[Given, ...]:
        unit = "N/m^3" if self.region.kind in ("whole", "rectangle") else "N/m^2"
        fields = given_fields(self, {"normal": unit, "shear": unit})
        return tuple(one for one in fields if self.to is None or one.what != "side")

    def identity(self, places: Mapping[str, object]) -> tuple[object, ...]:
        return "layer", self.on, self.to, self.region, self.normal, self.shear, self.side

    def bears(self) -> tuple[str, ...]:
        return self.ends

    def needs(self, layout: Layout) -> None:
        layer = layer_of(self, layout.bodies, layout.tolerance)
        for name in self.ends:
            if name in layout.rectangles:
                rectangle = layout.rectangles[name]
                for corner in to_rectangle(rectangle, layout.axes_of[name], layer.corners):
                    layout.on_rectangle(name, np.clip(corner[:2], 0.0, rectangle.size))
        plates = [plate for name in self.ends if isinstance(plate := layout.rectangles.get(name), Plate)]
        if len(plates) == len(self.ends) and glue_ratio(layer, self.spread_shear(layer), *plates) > (1 + NOTABLE) ** 2:
            layout.pulled |= {plate.name for plate in plates}
        if self.shear > 0.0 and any(name in layout.given for name in self.ends):  # a slab stretches: so does the plate
            layout.pulled |= {plate.name for plate in plates}

    def spread_shear(self, layer: LayerPlane) -> float:
        """Its stiffness in shear per area [N/m^3]; per length it is spread over what a rim encloses, and over as much
        beside a line as this is long."""
        x, y = layer.box[1] - layer.box[0], layer.box[3] - layer.box[2]
        if self.region.kind == "rim":
            return self.shear * 2.0 * (x + y) / (x * y)
        return self.shear / max(x, y) if self.region.kind == "line" else self.shear

    def fastened(self, model: Model, tolerance: float) -> tuple[Elastic]:
        """A Winkler foundation at Gauss points: along its normal, and along both directions in its plane in shear.

        Between two parts it resists the motion of the first less that of the second, both carried to the middle of
        the gap; to the ground that of the face.
        """
        if not (self.normal >= 0 and self.shear >= 0 and self.normal + self.shear > 0):
            got = f"{self.normal:g}, {self.shear:g}"
            raise InputError(f"parts.{self.name}.stiffness", got=got, expected="values >= 0, one above")
        layer = layer_of(self, bodies_of(model.structure), tolerance)
        sides = [model.parts[name] for name in self.ends]
        local, weights = _layer_points(layer, self.region, sides, tolerance)
        there = np.all([side.covers(layer.places(local), tolerance) for side in sides], axis=0)
        self._refuse_gaps(local, weights, there)
        local, weights = local[there], weights[there]
        values = np.array([self.shear, self.shear, self.normal])
        kept = values > 0
        places, n_nodes = layer.places(local), model.mesh.n_nodes
        motions = [_motion(side, places, layer.axes[kept], n_nodes, tolerance) for side in sides]
        stiffness = (weights[:, None] * values[kept]).ravel()
        elastic = Elastic(
            self.name,
            motions[0] if self.to is None else csr_array(motions[0] - motions[1]),
            stiffness,
            np.zeros(stiffness.size),
            np.tile(layer.axes[kept], (len(local), 1)),
            grounded=self.to is None,
            loss_factor=self.loss_factor,
            places=layer.places(local) if all(side.rigid for side in sides) else np.zeros((0, 3)),
        )
        return (elastic,)

    def _refuse_gaps(self, local: Floats, weights: Floats, there: NDArray[np.bool_]) -> None:
        """Raise InputError for a region that is named and reaches off a slab, and for a layer on nothing."""
        if there.all() or (self.region.kind == "whole" and there.any()):
            return
        x, y = local[~there][0]
        unit = "m^2" if self.region.kind in ("whole", "rectangle") else "m"
        raise InputError(
            f"parts.{self.name}.region",
            got=f"a {self.region.kind} with {weights[~there].sum():.4g} {unit} beside a slab or over an opening, as at "
            f"({x:.4g}, {y:.4g}) m",
            expected=f"a region of {' and '.join(self.ends)}",
            do="leave 'region' out: the layer is where both parts are",
        )


def glue_ratio(layer: LayerPlane, shear: float, first: Plate, second: Plate | None = None) -> float:
    """Bending stiffness of two plates, or of one on the ground, and a layer of a shear per area [N/m^3] if they cannot
    stretch in their planes, over that if they can.

    Notes
    -----
    The layer makes them one section, as far as it does not shear. Per width and for one half wave over the longer side
    its shear k_s makes S = k_s (L / pi)^2, in series with E h of both plates: D1 + D2 + e^2 S where they are rigid, and
    D1 + D2 + e^2 / (1 / S + 1 / E1 h1 + 1 / E2 h2). On the ground e is half the thickness.
    """
    if shear <= 0.0:
        return 1.0
    plates = (first,) if second is None else (first, second)
    to = layer.origin if second is None else np.asarray(second.origin)
    apart = float(abs((to - np.asarray(first.origin)) @ layer.axes[2]))
    length = max(layer.box[1] - layer.box[0], layer.box[3] - layer.box[2])
    along_y = layer.box[3] - layer.box[2] > layer.box[1] - layer.box[0]
    alone = sum(float(one.section.bending[int(along_y), int(along_y)]) for one in plates)
    slide = 1.0 / (shear * (length / np.pi) ** 2)
    stretch = sum(1.0 / one.section.stretching(np.pi / 2.0 if along_y else 0.0) for one in plates)
    return float((alone + apart**2 / slide) / (alone + apart**2 / (slide + stretch)))


def _layer_points(
    layer: LayerPlane, region: Region, sides: Sequence[Meshed], tolerance: float
) -> tuple[Floats, Floats]:
    """Gauss points [p, 2] of a layer in its coordinates [m] and weights [p]: between the grid lines of all its parts,
    where the motions of all are polynomials."""
    grids = [lines_across(layer, direction, sides, tolerance) for direction in (0, 1)]
    return grid_points(grids[0], grids[1], region, layer.box, tolerance, ORDER)


def lines_across(layer: LayerPlane, direction: int, sides: Sequence[Meshed], tolerance: float) -> Floats:
    """Ascending coordinates of the grid lines of all parts of a layer inside its region, and of the region's ends."""
    low, high = layer.box[2 * direction : 2 * direction + 2]
    lines = [side.lines_across(layer.axes[direction], layer.origin) for side in sides]
    found = np.sort(np.concatenate([[low, high], *lines]))
    found = found[(found >= low) & (found <= high)]
    return np.array([low, *(b for a, b in pairwise(found) if b - a > tolerance)])


def _motion(side: Meshed, places: Floats, directions: Floats, n_nodes: int, tolerance: float) -> csr_array:
    """Rows [p * d, n_nodes * 7] of the displacements along directions [d, 3] of places [p, 3] that move with a part."""
    nodes, rows = side.motion_at(places, tolerance)
    return sparse_rows(nodes, np.einsum("ij,pjkc->pikc", directions, rows[:, :3]), n_nodes)
