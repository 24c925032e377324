"""Cavities where they are: the points of two surfaces in the coordinates of the box between them, bay by bay."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from acoustics.air import Air
from acoustics.cavities.cavity import Cavity
from acoustics.cavities.equivalent_fluid import Wool
from acoustics.errors import AcousticsError
from acoustics.source import SurfaceShapes
from femstruct.arrays import Floats, Integers
from femstruct.errors import Finding, InputError, some_of
from femstruct.modal.basis import ModalBasis
from femstruct.model.materials.air_between import AirBetween
from femstruct.model.probe import Surface

PARALLEL: Final = 0.9998  # cosine of 1 degree between a surface's normals and the depth
OVERLAP: Final = 0.5  # of the sides of the larger surface that the two must share
SAME: Final = 0.01  # of a side: surfaces that differ less are one rectangle
DEPTH: Final = 0.2  # of the distance of the faces
FILLED: Final = 0.02  # of a rectangle's area that its points may miss
TWICE: Final = 0.5  # of what the smaller of two cavities has of a surface: neighbours share points of an edge
_NEAR: Final = 1e-9


@dataclass(frozen=True, eq=False)
class PlacedCavity:
    """A cavity, or one bay of it, and what of two surfaces moves its air.

    cavity : the box. surfaces : first, second. own : numbers of their points that it has. points [p, 3] : of these in
    its coordinates; weights [p] : areas that add up to its own. up_to_hz : modes of the air up to it are kept; None for
    as many as are needed.

    `placed_cavities` makes them. Two leaves in two bays, the joist between them 60 mm wide:

    >>> from femstruct import AirBetween, Bays, Material, Plate, Structure, SurfaceOn, mesh_structure
    >>> board = Material("board", E=2.5e9, nu=0.2, rho=800.0)
    >>> leaves = [
    ...     Plate(name, board, 0.0125, origin=(0.0, 0.0, z), size=(1.2, 0.6), mesh=(8, 4))
    ...     for name, z in (("upper", 0.1), ("lower", 0.0))
    ... ]
    >>> faces = SurfaceOn("under", "upper", "below"), SurfaceOn("top", "lower", "above")
    >>> model = mesh_structure(Structure("two leaves", leaves, surfaces=faces))
    >>> void = AirBetween("void", "under", "top", depth=0.1, bays=Bays("x", (0.6,), width=0.06))
    >>> [(bay.name, bay.cavity.size.round(3).tolist()) for bay in placed_cavities(void, model.surfaces)[0]]
    [('void 1', [0.57, 0.6, 0.1]), ('void 2', [0.57, 0.6, 0.1])]
    """

    name: str
    cavity: Cavity
    surfaces: tuple[Surface, Surface]
    own: tuple[Integers, Integers]
    points: tuple[Floats, Floats]
    weights: tuple[Floats, Floats]
    up_to_hz: float | None = None

    def shapes(self, basis: ModalBasis) -> tuple[SurfaceShapes, SurfaceShapes]:
        """Motion of both surfaces into the cavity in every mode."""
        first, second = (
            SurfaceShapes(points, weights, surface.shapes(basis.shapes)[own])
            for surface, own, points, weights in zip(self.surfaces, self.own, self.points, self.weights, strict=True)
        )
        return first, second


def placed_cavities(
    between: AirBetween, surfaces: Mapping[str, Surface]
) -> tuple[tuple[PlacedCavity, ...], tuple[Finding, ...]]:
    """A cavity between two of the surfaces, or its bays, and what to know before believing it.

    Raises InputError: no such surface, surfaces that are not flat rectangles, do not face each other or hardly overlap,
    a bay without area or points.

    Boards of gypsum on both sides of 0.1 m of air and wool:

    >>> from femstruct import AirBetween, Fill, Material, Plate, Structure, SurfaceOn, mesh_structure
    >>> board = Material("board", E=2.5e9, nu=0.2, rho=800.0)
    >>> leaves = [
    ...     Plate(name, board, 0.0125, origin=(0.0, 0.0, z), size=(1.2, 0.6), mesh=(8, 4))
    ...     for name, z in (("upper", 0.1), ("lower", 0.0))
    ... ]
    >>> faces = SurfaceOn("under", "upper", "below"), SurfaceOn("top", "lower", "above")
    >>> model = mesh_structure(Structure("two leaves", leaves, surfaces=faces))
    >>> void = AirBetween("void", "under", "top", depth=0.1, fill=Fill(10e3, 40.0))
    >>> (placed,), findings = placed_cavities(void, model.surfaces)
    >>> placed.cavity.wool.flow_resistivity, findings
    (10000.0, ())
    """
    where = f"cavities.{between.name}"
    for name in (between.first, between.second):
        if name not in surfaces:
            raise InputError(f"{where}.between", got=f"'{name}'", expected=some_of(surfaces) or "a surface")
    pair = surfaces[between.first], surfaces[between.second]
    distance = _distance(f"{where}.between", pair)
    local = [(one.points - pair[0].outline[0]) @ pair[0].along.T for one in pair]
    corners = _corners(pair)
    low, high = shared(pair)
    sides = [np.ptp(corner, axis=0) for corner in corners]
    _check_rectangles(f"{where}.between", pair, sides, high - low)
    findings = (*_sizes(between.name, sides, high - low), *_depths(between, distance))
    return tuple(_bays(between, pair, local, low, high)), findings


def all_cavities(
    cavities: Sequence[AirBetween], surfaces: Mapping[str, Surface]
) -> tuple[tuple[PlacedCavity, ...], tuple[Finding, ...]]:
    """All cavities of a structure, their bays one by one, and what to know before believing them.

    Raises InputError: as `placed_cavities`, and for two cavities on one part of a surface, whose air would count twice.
    """
    found: list[PlacedCavity] = []
    told: list[Finding] = []
    taken: dict[str, list[tuple[str, Integers]]] = {}
    for between in cavities:
        own, findings = placed_cavities(between, surfaces)
        for side, name in enumerate((between.first, between.second)):
            points = np.unique(np.concatenate([bay.own[side] for bay in own]))
            for other, theirs in taken.setdefault(name, []):
                both = surfaces[name].weights[np.intersect1d(points, theirs)].sum()
                if both > TWICE * min(surfaces[name].weights[one].sum() for one in (points, theirs)):
                    raise InputError(
                        f"cavities.{between.name}.between",
                        got=f"'{name}', {both:.3g} m^2 of which bound the air of '{other}' already",
                        expected="air that is in one cavity",
                        do="give each of them surfaces with a region of its own",
                    )
            taken[name].append((between.name, points))
        found += own
        told += findings
    return tuple(found), tuple(told)


def shared(pair: tuple[Surface, Surface]) -> tuple[Floats, Floats]:
    """Corners [2], low and high [m], of what two surfaces share, along x and y of the first from its first corner."""
    corners = _corners(pair)
    low = np.max([corner.min(axis=0) for corner in corners], axis=0)
    high = np.min([corner.max(axis=0) for corner in corners], axis=0)
    return low, high


def _corners(pair: tuple[Surface, Surface]) -> list[Floats]:
    return [(one.outline - pair[0].outline[0]) @ pair[0].along.T for one in pair]


def _distance(where: str, pair: tuple[Surface, Surface]) -> float:
    """Distance of two parallel surfaces that face each other, from face to face [m]; negative where they overlap."""
    first, second = pair
    inwards = first.normal
    for one, normal in ((first, inwards), (second, -inwards)):
        if (one.normals @ normal).min() < PARALLEL:
            mean = one.normal
            raise InputError(
                where,
                got=f"'{one.name}' with normal ({mean[0]:.2g}, {mean[1]:.2g}, {mean[2]:.2g}), not flat or not opposite "
                f"to '{(second if one is first else first).name}'",
                expected="two flat parallel surfaces whose sides face each other",
                do="the upper one has `side: below`, the lower one `side: above`",
            )
    distance = float((second.centre - first.centre) @ inwards)
    if not distance > 0:
        raise InputError(
            where,
            got=f"'{second.name}' {abs(distance):.3g} m behind '{first.name}'",
            expected="surfaces that face each other",
            do="choose the other side of both",
        )
    return distance - first.out - second.out


def _check_rectangles(where: str, pair: tuple[Surface, Surface], sides: list[Floats], shared: Floats) -> None:
    for one, side in zip(pair, sides, strict=True):
        area, covered = float(np.prod(side)), float(one.weights.sum())
        if abs(covered - area) > FILLED * area:
            raise InputError(
                where,
                got=f"'{one.name}', which covers {covered:.4g} m^2 of the rectangle round it, {area:.4g} m^2",
                expected="a rectangle along the axes of the first surface",
                do="give the surface a `region: {rectangle: [..]}`",
            )
    if (shared < OVERLAP * np.max(sides, axis=0)).any():
        raise InputError(
            where,
            got=f"surfaces that share {max(shared[0], 0.0):.3g} x {max(shared[1], 0.0):.3g} m of "
            f"{sides[0][0]:.3g} x {sides[0][1]:.3g} m and {sides[1][0]:.3g} x {sides[1][1]:.3g} m",
            expected="surfaces that lie opposite to each other",
            do="choose regions of one size, one over the other",
        )


def _sizes(name: str, sides: list[Floats], shared: Floats) -> tuple[Finding, ...]:
    larger = np.max(sides, axis=0)
    left = float((1.0 - shared / larger).max())
    if left <= SAME:
        return ()
    return (
        Finding(
            "cavity-sizes-differ",
            f"The surfaces of {name} differ: they share {shared[0]:.4g} x {shared[1]:.4g} m of {larger[0]:.4g} x "
            f"{larger[1]:.4g} m. The air is taken between what they share; the rest has none on it",
            {"shared_x_m": float(shared[0]), "shared_y_m": float(shared[1]), "left_out": left, "allowed": SAME},
        ),
    )


def _depths(between: AirBetween, distance: float) -> tuple[Finding, ...]:
    miss = abs(between.depth / distance - 1.0) if distance > 0.0 else float("inf")
    if miss <= DEPTH:
        return ()
    lie = f"are {1000 * distance:.4g} mm apart" if distance > 0.0 else f"overlap by {-1000 * distance:.4g} mm"
    return (
        Finding(
            "cavity-depth",
            f"The depth of {between.name} is {1000 * between.depth:.4g} mm, but its surfaces {lie}, from face to face. "
            "The air is as stiff as the depth says",
            {"depth_m": between.depth, "distance_m": distance, "miss": miss, "allowed": DEPTH},
        ),
    )


def _bays(
    between: AirBetween, pair: tuple[Surface, Surface], local: list[Floats], low: Floats, high: Floats
) -> list[PlacedCavity]:
    """The cavity itself, or one for every bay.

    A bay has the points up to the middles of its joists, squeezed into what the joists leave of it: where the nodes are
    says nothing of how wide a joist is.
    """
    bays = between.bays
    axis = 0 if bays is None or bays.across == "x" else 1
    where = f"cavities.{between.name}.bays"
    length = float(high[axis] - low[axis])
    at = [0.0, *(() if bays is None else sorted(bays.at)), length]
    if any(not start < end for start, end in pairwise(at)):
        raise InputError(
            f"{where}.at",
            got=", ".join(f"{one:g} m" for one in at[1:-1]),
            expected=f"different places between 0 and {length:.4g} m, the length of the cavity along "
            f"{'xy'[axis]}, without its ends",
            do="measure from the corner of the cavity; joists at its ends are not named",
        )
    width = 0.0 if bays is None else bays.width
    found = []
    for number, (start, end) in enumerate(pairwise(at)):
        inset = (0.5 * width * (number > 0), 0.5 * width * (number < len(at) - 2))
        name = between.name if bays is None else f"{between.name} {number + 1}"
        clear = end - start - sum(inset)
        if not clear > 0:
            raise InputError(f"{where}.width", got=f"{width:g} m", expected=f"less than a bay of {end - start:.4g} m")
        floor, roof = low.copy(), high.copy()
        floor[axis], roof[axis] = low[axis] + start, low[axis] + end
        found.append(_bay(between, name, pair, local, floor, roof, axis, clear))
    return found


def _bay(
    between: AirBetween,
    name: str,
    pair: tuple[Surface, Surface],
    local: list[Floats],
    low: Floats,
    high: Floats,
    axis: int,
    clear: float,
) -> PlacedCavity:
    """The air of the rectangle from `low` to `high`, `clear` of it along the axis."""
    sides = high - low
    squeezed = sides.copy()
    squeezed[axis] = clear
    fill, air = between.fill, Air(between.c, between.rho)
    try:
        wool = None if fill is None else Wool(fill.flow_resistivity, fill.density, fill.frame)
        cavity = Cavity(np.append(squeezed, between.depth), air, wool, None if fill is None else fill.thickness)
    except AcousticsError as error:
        raise InputError(
            f"cavities.{between.name}.{error.where.removeprefix('cavity.')}",
            got=error.got,
            expected=error.expected,
            do=error.do,
        ) from error
    own, points, weights = [], [], []
    for surface, place in zip(pair, local, strict=True):
        inside = ((place > low - _NEAR) & (place < high + _NEAR)).all(axis=1)
        if not inside.any():
            raise InputError(
                f"cavities.{between.name}.bays.at",
                got=f"a bay of {sides[0]:.3g} x {sides[1]:.3g} m without a point of '{surface.name}'",
                expected="bays wider than the mesh of the surface",
                do="refine the mesh",
            )
        own.append(np.flatnonzero(inside).astype(np.int64))
        scaled = (place[inside] - low) / sides * squeezed
        points.append(np.column_stack([scaled.clip(0.0, squeezed), np.zeros(len(scaled))]))
        area = surface.weights[inside]
        weights.append(area / area.sum() * float(np.prod(squeezed)))
    first, second = own
    moving = (points[0], points[1]), (weights[0], weights[1])
    return PlacedCavity(name, cavity, pair, (first, second), *moving, up_to_hz=between.up_to)
