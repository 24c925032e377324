"""Hangers, clips and channels of ceilings: springs in a regular spacing between a floor or its joists and a ceiling."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats
from femstruct.declared import checked
from femstruct.elements.polynomials import gauss_interval
from femstruct.errors import InputError
from femstruct.model.elastic_layers import LayerPlane, layer_of
from femstruct.model.layout import Layout
from femstruct.model.materials import Given, Loss, given_fields
from femstruct.model.model import Model
from femstruct.model.part import Elastic, FilledBox, Inert, Meshed, Part
from femstruct.model.regions import PARALLEL, Pair, Region, clip, line_points, sparse_rows
from femstruct.model.structure import bodies_of
from femstruct.parts.foundation import Foundation, lines_across
from femstruct.parts.frame import FrameMesh
from femstruct.tags import stored_as

ORDER = 4  # Gauss points of a piece of a line: exact for products of two cubic deflections
PIECES = 16  # of a bar under a line: its moment lacks p h^2 / 12 of them, 0.3 % of p L^2 / 8
MILLIMETRES = 20.0  # m: hangers are that many millimetres apart at least
MOST_PLACES = 100_000  # more is a slip of a unit
_Places = tuple[Floats, Floats, Floats]
"""Where hangers act: places [p, 3] [m], the share of each [p] (1, or the length [m] it stands for), and axes [3, 3],
rows x, y and the normal of the ceiling."""


@stored_as("hangers/1")
@dataclass(frozen=True)
@checked("parts")
class Hangers(Part):
    """Springs in a regular spacing between a floor, or its joists, and a ceiling: hangers, clips, resilient channels.

    They resist the motion of the floor less that of the ceiling at the same place, along the normal of the ceiling, and
    both ways along it in shear, in the middle of the gap through rigid arms of both: a rigid motion of both strains
    nothing. Nothing goes to the ground: a ceiling on few of them has modes of its own as a rigid plate.

    on : the floor: a plate, slab, block or frame. to : the ceiling, a plate or slab, parallel to it.
    per : "piece" for springs one by one: stiffness [N/m] and mass [kg] are of each; "length" for lines, as of channels:
    [N/m^2] and [kg/m].
    spacing : of pieces below a floor along x and y of the ceiling [m], one for both; of pieces along the bars of a
    frame, one; of lines below a floor, one across them; of lines along bars, none. The pattern is centred, with as many
    as fit nearest to it: the edge is about half a spacing away.
    along : of lines below a floor, the axis of the ceiling that they run along. at : places of pieces in the ceiling's
    coordinates instead of a spacing [m].
    mass : of the hangers themselves, half with each side. like : the entry of the library, with its source.

    Raises InputError, where it is meshed, for numbers that cannot be, sides that are not parallel or that overlap, and
    places or a spacing beyond the ceiling.

    A ceiling of 4 m^2 and 20 kg/m^2 on 4 hangers of 20 kN/m below a floor that is held: f = sqrt(4 k / m) / 2 pi.

    >>> from femstruct import Material, Plate, Structure, Support, assemble, mesh_structure, modal_basis
    >>> board = Material("board", E=3e12, nu=0.3, rho=1000.0)
    >>> floor = Plate("floor", board, 0.2, origin=(0.0, 0.0, 0.5), size=(2.0, 2.0), mesh=0.5)
    >>> ceiling = Plate("ceiling", board, 0.02, origin=(0.0, 0.0, 0.0), size=(2.0, 2.0), mesh=0.5)
    >>> hangers = Hangers("hangers", "floor", "ceiling", normal=20e3, shear=5e3, spacing=(1.0,))
    >>> held = Support("edges", "clamped", on="floor", edge="all")
    >>> model = mesh_structure(Structure("a ceiling", (floor, ceiling, hangers), supports=(held,)))
    >>> f = modal_basis(assemble(model), up_to=50.0).frequency_hz
    >>> bool(abs(f / ((4 * 20e3 / 80.0) ** 0.5 / 6.283185307) - 1.0).min() < 1e-3)
    True
    """

    name: str
    on: str
    to: str
    normal: float
    shear: float = 0.0
    per: Literal["piece", "length"] = "piece"
    spacing: tuple[float, ...] = ()
    along: Literal["x", "y"] | None = None
    at: tuple[Pair, ...] = ()
    loss_factor: Loss = 0.0
    mass: float = 0.0
    like: str = ""

    def described(self) -> tuple[Given, ...]:
        each, mass = ("N/m", "kg") if self.per == "piece" else ("N/m^2", "kg/m")
        return given_fields(self, {"normal": each, "shear": each, "mass": mass, "spacing": "m", "at": "m"})

    def identity(self, places: Mapping[str, object]) -> tuple[object, ...]:
        return "hangers", self.on, self.to, self.normal, self.shear, self.per, self.spacing, self.along, self.at

    def needs(self, layout: Layout) -> None:
        """Nodes of bars that have their own where pieces hang on them, and between `PIECES` of what lines hang along:
        between its nodes a bar bends too little."""
        body, pieces = layout.bodies.get(self.to), self.per == "piece"
        if body is None or body.across != 2 or (pieces and not (len(self.spacing) == 1 and self.spacing[0] > 0)):
            return
        size = (float(body.size[0]), float(body.size[1]))
        for segment in layout.segments.get(self.on, ()):
            run = (np.stack([segment.start, segment.end]) - body.corner) @ body.axes.T
            if pieces:
                places, _ = self._on_run(run, size, (), layout.tolerance)
            elif (over := clip(run[0], run[1], size, layout.tolerance)) is not None:
                places = run[0] + np.outer(np.linspace(*over, PIECES + 1), run[1] - run[0])
            else:
                continue
            layout.loaded += [(self.on, place) for place in body.corner + places @ body.axes]

    def bears(self) -> tuple[str, ...]:
        return (self.to,)

    def fastened(self, model: Model, tolerance: float) -> tuple[Elastic | Inert, ...]:
        """Springs at their places, or at Gauss points of lines, and half of their mass with each side."""
        self._refuse_numbers()
        for name in (self.on, self.to):
            if name not in model.parts:
                raise InputError(f"parts.{self.name}.between", got=f"'{name}'", expected="a part with nodes")
        sides = model.parts[self.on], model.parts[self.to]
        bodies = bodies_of(model.structure)
        if isinstance(sides[0], FrameMesh):
            at, shares, axes = self._along_bars(sides[0], sides[1], self._ceiling(bodies), tolerance)
        else:
            at, shares, axes = self._below_floor(sides, bodies, tolerance)
        values = np.array([self.shear, self.shear, self.normal])
        kept, n_nodes = values > 0, model.mesh.n_nodes
        moving = [side.motion_at(at, tolerance) for side in sides]
        relative = [
            sparse_rows(nodes, np.einsum("ij,pjkc->pikc", axes[kept], rows[:, :3]), n_nodes) for nodes, rows in moving
        ]
        stiffness = (shares[:, None] * values[kept]).ravel()
        elastic = Elastic(
            self.name,
            csr_array(relative[0] - relative[1]),
            stiffness,
            np.zeros(stiffness.size),
            np.tile(axes[kept], (len(at), 1)),
            grounded=False,
            loss_factor=self.loss_factor,
            places=at if self.per == "piece" else np.zeros((0, 3)),
        )
        if not self.mass:
            return (elastic,)
        rows = csr_array(vstack([sparse_rows(nodes, of_side[:, :3], n_nodes) for nodes, of_side in moving]))
        halves = np.repeat(np.tile(shares * self.mass / 2.0, 2), 3)
        return elastic, Inert(self.name, rows, halves, 2 * len(at))

    def _refuse_numbers(self) -> None:
        where = f"parts.{self.name}"
        if not (self.normal >= 0 and self.shear >= 0 and self.normal + self.shear > 0):
            got = f"{self.normal:g}, {self.shear:g}"
            raise InputError(f"{where}.stiffness", got=got, expected="values >= 0, one above")
        if not self.mass >= 0:
            raise InputError(f"{where}.mass", got=f"{self.mass:g}", expected="a mass >= 0")
        if self.on == self.to:
            raise InputError(f"{where}.between", got=f"'{self.on}' twice", expected="two parts")
        for step in self.spacing:
            if not step > 0:
                raise InputError(f"{where}.spacing", got=f"{step:g} m", expected="lengths above zero")

    def _ceiling(self, bodies: Mapping[str, FilledBox]) -> FilledBox:
        found = bodies.get(self.to)
        if found is None or found.across != 2:
            raise InputError(f"parts.{self.name}.between", got=f"'{self.to}'", expected="a ceiling: a plate or slab")
        return found

    def _spacings(self, count: tuple[int, ...], what: str, size: Pair) -> tuple[float, ...]:
        """The spacing, of one of so many numbers. Raises InputError for others, and for one wider than the ceiling of
        a size [m]: a slip of a unit, where one hanger in the middle would be all."""
        if len(self.spacing) in count:
            for step in self.spacing:
                if step > max(size):
                    raise InputError(
                        f"parts.{self.name}.spacing",
                        got=f"{step:g} m on a ceiling of {size[0]:g} m x {size[1]:g} m",
                        expected="a spacing within the ceiling",
                        do=f"a plain number is in metres: did you mean {step:g} mm?" if step >= MILLIMETRES else "",
                    )
            return self.spacing
        words = " or ".join(str(one) for one in count) if any(count) else "none"
        got = f"{len(self.spacing)} numbers" if self.spacing else "no spacing"
        raise InputError(f"parts.{self.name}.spacing", got=got, expected=f"{words} for {what}")

    def _regular(self, length: float, spacing: float, of_each: int = 1) -> Floats:
        """Places on a length in a spacing [m], centred; at least one.

        Parameters
        ----------
        of_each : int
            How many go with each of them.
        """
        count = max(1, int(min(length / spacing, MOST_PLACES + 1) + 0.5))
        if count * of_each > MOST_PLACES:
            got = f"{spacing:g} m on {length:g} m"
            raise InputError(f"parts.{self.name}.spacing", got=got, expected=f"at most {MOST_PLACES} places")
        return np.asarray((length - (count - 1) * spacing) / 2.0 + spacing * np.arange(count))

    def _below_floor(self, sides: Sequence[Meshed], bodies: Mapping[str, FilledBox], tolerance: float) -> _Places:
        self._ceiling(bodies)
        layer = layer_of(Foundation(self.name, self.to, Region("whole"), 1.0, to=self.on), bodies, tolerance)
        local, shares = self._lines(layer, sides, tolerance) if self.per == "length" else self._pieces(layer, tolerance)
        places = layer.places(local)
        there = np.all([side.covers(places, tolerance) for side in sides], axis=0)
        if not there.any() or (self.at and not there.all()):
            x, y = local[~there][0]
            raise InputError(
                f"parts.{self.name}.{'at' if self.at else 'between'}",
                got=f"({x:.4g}, {y:.4g}) m, over an opening or beside a slab",
                expected=f"places where both {self.on} and {self.to} are",
            )
        return places[there], shares[there], layer.axes

    def _pieces(self, layer: LayerPlane, tolerance: float) -> tuple[Floats, Floats]:
        x0, x1, y0, y1 = layer.box
        if self.at:
            local = np.array(self.at)
            beyond = float(np.max([local.min(axis=0) * -1 + [x0, y0], local.max(axis=0) - [x1, y1]]))
            if beyond > tolerance:
                raise InputError(
                    f"parts.{self.name}.at",
                    got=f"a place {beyond:.4g} m off",
                    expected=f"x from {x0:g} m to {x1:g} m, y from {y0:g} m to {y1:g} m, in coordinates of {self.to}",
                )
            return local, np.ones(len(local))
        steps = self._spacings((1, 2), "pieces below a floor", (x1 - x0, y1 - y0))
        x = x0 + self._regular(x1 - x0, steps[0])
        y = y0 + self._regular(y1 - y0, steps[-1], len(x))
        local = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
        return local, np.ones(len(local))

    def _lines(self, layer: LayerPlane, sides: Sequence[Meshed], tolerance: float) -> tuple[Floats, Floats]:
        """Gauss points [p, 2] and weights [p] (m) of lines along an axis of the ceiling."""
        x0, x1, y0, y1 = layer.box
        (step,) = self._spacings((1,), "lines below a floor", (x1 - x0, y1 - y0))
        if self.along is None:
            raise InputError(f"parts.{self.name}.along", got="no direction of the lines", expected="x or y")
        cuts = [lines_across(layer, direction, sides, tolerance) for direction in (0, 1)]
        if self.along == "x":
            ends = [((x0, float(y)), (x1, float(y))) for y in y0 + self._regular(y1 - y0, step)]
        else:
            ends = [((float(x), y0), (float(x), y1)) for x in x0 + self._regular(x1 - x0, step)]
        found = [line_points(cuts[0], cuts[1], one, tolerance, ORDER) for one in ends]
        return np.concatenate([places for places, _ in found]), np.concatenate([shares for _, shares in found])

    def _along_bars(self, frame: FrameMesh, plate: Meshed, body: FilledBox, tolerance: float) -> _Places:
        """Places in the middle between the sides of bars and of the ceiling that face each other."""
        if self.at or self.along is not None:
            key, got = ("at", "places") if self.at else ("along", "a direction")
            expected = "a spacing along its bars" if self.per == "piece" else "lines along its bars"
            raise InputError(f"parts.{self.name}.{key}", got=f"{got} below a frame", expected=expected)
        size = (float(body.size[0]), float(body.size[1]))
        if self.per == "length":
            self._spacings((0,), "lines along bars", size)
            runs = np.stack([frame.start, frame.end], axis=1)
        else:
            self._spacings((1,), "pieces along bars", size)
            runs = np.stack([(one.start, one.end) for one in frame.pieces(tolerance)])
        # a plate lies in its mid-surface, its body's corner is on a face
        local = (runs - body.corner) @ body.axes.T
        heights, thick = local[..., 2], float(body.size[2])
        if (np.abs(np.ptp(heights, axis=1)) > PARALLEL * np.linalg.norm(np.diff(runs, axis=1)[:, 0], axis=1)).any():
            got = f"bars of {self.on} at an angle to {self.to}"
            raise InputError(f"parts.{self.name}.between", got=got, expected="bars parallel to the ceiling")
        after = bool(heights.mean() > thick / 2.0)
        reach = frame.reach(-body.axes[2] if after else body.axes[2])
        gap = float((heights - thick).min() if after else -heights.max()) - reach
        if gap < -tolerance:
            raise InputError(
                f"parts.{self.name}.between",
                got=f"bars of {self.on} reaching {-gap:.4g} m into {self.to}",
                expected="a gap, or faces that touch",
            )
        cuts = [np.zeros(0), np.zeros(0)]
        if self.per == "length":
            cuts = [plate.lines_across(body.axes[axis], body.corner) for axis in (0, 1)]
        found = [self._on_run(one, size, cuts, tolerance) for one in local]
        places = np.concatenate([places for places, _ in found])
        if not len(places):
            got = f"no bar of {self.on} over {self.to}"
            raise InputError(f"parts.{self.name}.between", got=got, expected="bars over the ceiling")
        places[:, 2] = (places[:, 2] - reach + thick) / 2.0 if after else (places[:, 2] + reach) / 2.0
        there = body.corner + places @ body.axes
        inside = plate.covers(there, tolerance)
        return there[inside], np.concatenate([shares for _, shares in found])[inside], body.axes

    def _on_run(self, run: Floats, size: Pair, cuts: Sequence[Floats], tolerance: float) -> tuple[Floats, Floats]:
        """Places [p, 3] and shares [p] of the stretch of a straight run [2, 3] over the ceiling, in its coordinates."""
        over = clip(run[0], run[1], size, tolerance)
        length = float(np.linalg.norm(run[1] - run[0]))
        if over is None or (over[1] - over[0]) * length <= tolerance:
            return np.zeros((0, 3)), np.zeros(0)
        low, high = over
        if self.per == "piece":
            places = low * length + self._regular((high - low) * length, self.spacing[0])
            return run[0] + np.outer(places / length, run[1] - run[0]), np.ones(len(places))
        inner = [
            (lines - run[0, axis]) / (run[1, axis] - run[0, axis])
            for axis, lines in enumerate(cuts)
            if abs(run[1, axis] - run[0, axis]) > tolerance
        ]
        ends = np.sort(np.concatenate([[low, high], *inner]))
        ends = ends[(ends >= low) & (ends <= high)]
        kept = np.array([low, *(b for a, b in pairwise(ends) if (b - a) * length > tolerance)])
        points, weights = gauss_interval(ORDER)
        steps = np.diff(kept)
        shares = (kept[:-1, None] + steps[:, None] * points).ravel()
        return run[0] + np.outer(shares, run[1] - run[0]), (steps[:, None] * weights).ravel() * length
