"""Cavities of a structure: where they are, the basis with their air and wool, and findings on them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np
from scipy.linalg import cholesky, eigh, solve_triangular

from acoustics.air import Air
from acoustics.errors import AcousticsError
from acoustics.rooms.box import Box, room_modes
from acoustics.rooms.cavities import (
    ALLOWED,
    LEAST,
    MOST,
    MOST_MODES,
    STILL_HZ,
    Cavity,
    CavityAir,
    Wool,
    cavity_air,
    combine_cavities,
    condense_air,
)
from acoustics.source import SurfaceShapes
from femstruct.arrays import Floats, Integers
from femstruct.errors import Finding, InputError, list_some
from femstruct.modal.basis import Holder, Kind, ModalBasis, in_time
from femstruct.modal.eigen import fix_signs
from femstruct.model.probe import Surface
from femstruct.model.structure import AirBetween
from femstruct.sound.coupling import (
    NEGLIGIBLE_DAMPING_COUPLING,
    completing,
    coupling_residual,
    coupling_share,
    in_new_modes,
    pad_rows,
)

# ----------------------------------------------------------------------------------------------------------------------
# Cavities where they are: the points of two surfaces in the coordinates of the box between them, bay by bay.
# ----------------------------------------------------------------------------------------------------------------------

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
            raise InputError(f"{where}.between", got=f"'{name}'", expected=list_some(surfaces) or "a surface")
    pair = surfaces[between.first], surfaces[between.second]
    distance = _distance(f"{where}.between", pair)
    local = [(one.points - pair[0].outline[0]) @ pair[0].along.T for one in pair]
    corners = _corners(pair)
    low, high = shared_rectangle(pair)
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
    advice: list[Finding] = []
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
        advice += findings
    return tuple(found), tuple(advice)


def shared_rectangle(pair: tuple[Surface, Surface]) -> tuple[Floats, Floats]:
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
        found.append(_bay(between, name, pair=pair, local=local, low=floor, high=roof, axis=axis, clear=clear))
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


# ----------------------------------------------------------------------------------------------------------------------
# Findings on cavities: what their air did, and where it is a rough approximation.
# ----------------------------------------------------------------------------------------------------------------------

FEW = 0.7  # of the frequency up to which modes are needed
HELD = 0.5  # 1/s


def findings_of(
    basis: ModalBasis,
    coupled: ModalBasis,
    placed: Sequence[PlacedCavity],
    airs: Sequence[CavityAir],
) -> tuple[Finding, ...]:
    """All of them.

    Parameters
    ----------
    basis : ModalBasis
        In vacuo.
    """
    return (
        _what_it_did(basis, coupled, placed, airs),
        *_few(basis, placed, airs),
        *_wools(basis, placed),
    )


def _what_it_did(
    basis: ModalBasis, coupled: ModalBasis, placed: Sequence[PlacedCavity], airs: Sequence[CavityAir]
) -> Finding:
    added = sum((air.compression[:, : len(basis.omega)] ** 2).sum(axis=0) for air in airs)[basis.modes]
    share = np.divide(added, added + basis.omega[basis.modes] ** 2, out=np.zeros_like(added), where=added > 0)
    stiffened = int(share.argmax())
    # mass-normalised with the air: what a mode has of the motion of the other
    partner = int(_shared(basis.shapes[:, :, stiffened], coupled.shapes[:, :, coupled.modes]).argmax())
    before, after = float(basis.frequency_hz[stiffened]), float(coupled.frequency_hz[partner])
    n = sum(len(air.frequency_hz) for air in airs)
    lowest = min(air.complete_below_hz for air in airs)
    woolly = any(one.cavity.wool is not None for one in placed)
    also = ". With wool they are damped together: damping ratios of single modes do not say how they decay"
    return Finding(
        "cavity-coupling",
        f"The air of {len(placed)} {'cavity' if len(placed) == 1 else 'cavities'} reacts on the structure with {n} "
        f"{'mode' if n == 1 else 'modes'} of its own below {lowest:.4g} Hz; its higher modes add mass. It changes mode "
        f"{stiffened + 1} of the structure most: {before:.2f} Hz without the air, {after:.2f} Hz with it, where it is "
        f"mode {partner + 1}. Mode numbers and frequencies are those with the air{also if woolly else ''}",
        {
            "in_vacuo_hz": before,
            "coupled_hz": after,
            "in_vacuo_mode": stiffened + 1.0,
            "coupled_mode": partner + 1.0,
            "cavity_modes": float(n),
            "cavity_modes_up_to_hz": lowest,
        },
    )


def _shared(shape: Floats, shapes: Floats) -> Floats:
    """How much of every shape [k] lies along one: modes of the air hardly move the structure."""
    alike: Floats = (shape[:, :3].ravel() @ shapes[:, :3].reshape(-1, shapes.shape[2])) ** 2
    return alike


def _few(basis: ModalBasis, placed: Sequence[PlacedCavity], airs: Sequence[CavityAir]) -> tuple[Finding, ...]:
    """The cavity whose modes end lowest, of what the motions of the structure need."""
    top = basis.complete_below_hz
    if not 0 < top < np.inf:
        return ()
    shares = [air.complete_below_hz / one.cavity.kept_hz(top) for one, air in zip(placed, airs, strict=True)]
    worst = int(np.argmin(shares))
    if shares[worst] >= FEW:
        return ()
    one, kept = placed[worst], airs[worst].complete_below_hz
    needed, good = one.cavity.kept_hz(top), _good_up_to(one, kept, top)
    return (
        Finding(
            "cavity-modes-few",
            f"Modes of the air of {one.name} are kept up to {kept:.4g} Hz; motions up to {top:.4g} Hz, the last mode "
            f"of the structure, need {needed:.4g} Hz. Above {good:.4g} Hz the air follows too fast",
            {"kept_hz": kept, "needed_hz": needed, "top_hz": top, "good_up_to_hz": good, "least_share": FEW},
        ),
    )


def _good_up_to(one: PlacedCavity, kept: float, top: float) -> float:
    """Highest frequency for which modes up to `kept` are enough [Hz]."""
    tried = top * np.linspace(0.0, 1.0, 201)[1:]
    enough = np.array([one.cavity.kept_hz(float(hz)) <= kept for hz in tried])
    return float(tried[enough].max(initial=0.0))


def _wools(basis: ModalBasis, placed: Sequence[PlacedCavity]) -> tuple[Finding, ...]:
    findings: dict[tuple[str, Wool], Finding] = {}
    for one in placed:
        wool = one.cavity.wool
        if wool is None:
            continue
        sigma = wool.flow_resistivity
        if not LEAST <= sigma <= MOST:
            findings.setdefault(
                ("range", wool),
                Finding(
                    "wool-out-of-range",
                    f"Wool of {sigma / 1000:.4g} kPa*s/m^2 in {one.name}: its model was compared between "
                    f"{LEAST / 1000:g} and {MOST / 1000:g} kPa*s/m^2 only",
                    {"flow_resistivity": sigma, "least": LEAST, "most": MOST},
                ),
            )
    held = [one for one in placed if one.cavity.wool is not None and one.cavity.wool.frame == "held"]
    if held and basis.total_mass > 0:
        drag = sum(
            one.cavity.layers[0].box.volume * one.cavity.wool.flow_resistivity
            for one in held
            if one.cavity.wool is not None
        )
        rate = drag / basis.total_mass
        if rate > HELD:
            findings[("held", Wool(1.0))] = Finding(
                "held-wool",
                f"Wool held at rest is a dashpot to the ground: it damps the common movement of both surfaces of "
                f"{held[0].name} with up to {rate:.3g} 1/s, which loose wool does not",
                {"rate_1_s": rate, "allowed_1_s": HELD},
            )
    return tuple(findings.values())


# ----------------------------------------------------------------------------------------------------------------------
# Cavities of a structure: its basis together with the air and the wool between its surfaces.
# ----------------------------------------------------------------------------------------------------------------------

ALONE: Final = 0.25  # of what may be left out of all cavities: what is left out of each before they are joined
AIR: Final = "air of the cavities"
WOOL: Final = "wool of the cavities"
HIGHEST: Final = 4  # one in so many modes of the structure stands for those it lacks
_NONE: Final = 1e-9  # share of a motion below which it displaces no volume: rounding


def with_cavities(basis: ModalBasis, placed: Sequence[PlacedCavity], *, up_to_hz: float | None = None) -> ModalBasis:
    """The basis of a structure and the air and wool in cavities between its surfaces: mass-normalised, full damping.

    Parameters
    ----------
    basis : ModalBasis
        In vacuo, with the damping of the structure alone.
    placed : Sequence[PlacedCavity]
        All cavities, bays one by one.
    up_to_hz : float | None
        Modes of the air up to it are coordinates of their own; left out: as far as the modes of the structure need
        them, and at most the 400 lowest of each cavity.

    Returns
    -------
    ModalBasis
        A ModalBasis whose modes are those of structure and air without losses, isothermal in wool. Behind its residual
        vectors it has coordinates that no force meets and only drag moves, of kind "residual" too: frames of limp wool
        and layers of air that slide over wool, at 0 Hz, and what heat adds to the pressure in wool, far above the band.

    Raises
    ------
    InputError
        When an infinite basis (closed form) is given no `up_to_hz`.

    Notes
    -----
    See `acoustics.rooms.cavities`. Wool makes damping full: modes of the air are overdamped, and their ratios are
    no measure of it. Without wool damping between modes is left out where it makes less than 1e-3 of the motion.
    Energy is that of `holders`: the structure, the air of the cavities and the wool in them.
    Coordinates that the structure does not move in its band are left out (`acoustics.rooms.cavities`).
    All matrices are symmetric, mass is positive, stiffness and damping are not negative: nothing can grow.

    Two free boards on a cushion of air: one of their twelve rigid motions, one against the other, has a frequency.

    Examples
    --------
    >>> from femstruct import assemble, modal_basis, placed_cavities
    >>> from femstruct import AirBetween, Material, Plate, Structure, SurfaceOn, mesh_structure
    >>> board = Material("board", E=2.5e9, nu=0.2, rho=800.0)
    >>> leaves = [
    ...     Plate(name, board, 0.0125, origin=(0.0, 0.0, z), size=(1.2, 0.6), mesh=(8, 4))
    ...     for name, z in (("upper", 0.1), ("lower", 0.0))
    ... ]
    >>> faces = SurfaceOn("under", "upper", "below"), SurfaceOn("top", "lower", "above")
    >>> model = mesh_structure(Structure("two leaves", leaves, surfaces=faces))
    >>> void = AirBetween("void", "under", "top", depth=0.1, c=343.0)
    >>> free = modal_basis(assemble(model), up_to=60.0)
    >>> joined = with_cavities(free, placed_cavities(void, model.surfaces)[0])
    >>> free.n_rigid, joined.n_rigid
    (12, 11)
    """
    if not placed:
        return basis
    reach = basis.complete_below_hz
    if up_to_hz is None and not 0 < reach < np.inf:
        raise InputError(
            f"cavities.{placed[0].name}",
            got="a basis in closed form",
            expected="a frequency up to which modes of the air are kept",
            do="give up_to_hz",
        )
    top = reach if 0 < reach < np.inf else float(up_to_hz or 0.0)
    limits = [up_to_hz or one.up_to_hz or _limit(one, top) for one in placed]
    airs = [
        condense_air(cavity_air(one.cavity, *one.shapes(basis), limit), basis.omega, top, ALONE * ALLOWED)
        for one, limit in zip(placed, limits, strict=True)
    ]
    air = airs[0] if len(airs) == 1 else condense_air(combine_cavities(airs, len(basis.omega)), basis.omega, top)
    coupled = _coupled(basis, air, woolly=any(one.cavity.wool is not None for one in placed))
    return replace(coupled, findings=(*basis.findings, *findings_of(basis, coupled, placed, airs)))


def _coupled(basis: ModalBasis, air: CavityAir, *, woolly: bool) -> ModalBasis:
    """The basis with the air; without its findings."""
    k = len(basis.omega)
    omega, turn, n_rigid = _modes(basis, air)
    own = turn[:k]
    kinds, order = _ordered(basis, own, n_rigid, len(air.mass) - air.loose)
    omega, turn, own = omega[order], turn[:, order], own[:, order]
    viscous = turn.T @ (pad_rows(basis.viscous, len(turn)) + air.viscous) @ turn
    hysteretic = own.T @ basis.hysteretic @ own
    still = omega == 0.0
    hysteretic[still, :] = hysteretic[:, still] = 0.0
    true = np.array([kind != "residual" for kind in kinds], dtype=bool)
    stray = 1.0 if woolly else coupling_share(in_time(viscous, hysteretic, omega), omega, own[basis.modes], true)
    return in_new_modes(
        basis,
        omega,
        kinds,
        own,
        (viscous, hysteretic),
        coupled=stray >= NEGLIGIBLE_DAMPING_COUPLING or bool(basis.volumes),
        residual_norm=coupling_residual(basis.omega, air.mass, air.compression, omega, turn[: len(air.mass)]),
        complete_below_hz=min(basis.complete_below_hz / np.sqrt(1.0 + _heavier(basis, air)), air.complete_below_hz),
        holders=_holders(basis, air, turn, own),
        volumes={key: row @ own for key, row in basis.volumes.items()},
    )


def _heavier(basis: ModalBasis, air: CavityAir) -> float:
    """Mass of the air that moves with modes that the basis lacks: no more than with the highest that it has."""
    moved = np.diag(air.mass)[basis.modes]
    return float(moved[-max(len(moved) // HIGHEST, 1) :].max(initial=0.0))


def _limit(one: PlacedCavity, top_hz: float) -> float:
    """Up to where modes of a cavity are kept for motions up to a frequency: at most MOST of them."""
    limit_hz = one.cavity.kept_hz(top_hz)
    frequency_hz, _ = room_modes(Box(one.cavity.size, one.cavity.air), limit_hz)
    return limit_hz if len(frequency_hz) <= MOST_MODES else float(frequency_hz[MOST_MODES]) * (1.0 - 1e-9)


def _modes(basis: ModalBasis, air: CavityAir) -> tuple[Floats, Floats, int]:
    """Circular frequencies, coordinates in terms of the new ones [all, all], and the number of rigid modes.

    What is loose has no stiffness: the others are freed of what they move of its mass, and keep theirs.
    """
    k, loose, moving, added = len(basis.omega), air.loose, len(air.mass), len(air.viscous) - len(air.mass)
    first = moving - loose
    mass = air.mass.copy()
    mass[:k, :k] += np.eye(k)
    sliding: Floats = np.zeros((loose, first))
    half: Floats = np.zeros((0, 0))
    if loose:
        half = cholesky(mass[first:, first:], lower=True)
        sliding = solve_triangular(half.T, solve_triangular(half, mass[first:, :first], lower=True), lower=False)
    structure = np.concatenate([basis.omega, np.zeros(first - k)])
    pressed = air.compression[:, :first]
    freed = mass[:first, :first] - mass[:first, first:] @ sliding
    turn: Floats = eigh(np.diag(structure**2) + pressed.T @ pressed, 0.5 * (freed + freed.T))[1]
    turn = fix_signs(turn, np.ones(first))
    squared = ((structure[:, None] * turn) ** 2).sum(axis=0) + ((pressed @ turn) ** 2).sum(axis=0)
    n_rigid = _n_rigid(basis, air)
    squared[:n_rigid] = 0.0
    whole = np.zeros((moving + added, moving + added))
    whole[:first, :first], whole[first:moving, :first] = turn, -sliding @ turn
    if loose:
        whole[first:moving, first:moving] = solve_triangular(half.T, np.eye(loose), lower=False)
    whole[moving:, moving:] = np.eye(added)
    return np.concatenate([np.sqrt(squared), np.zeros(loose), _still(air)]), whole, n_rigid


def _still(air: CavityAir) -> Floats:
    """Circular frequencies of the coordinates that only drag moves."""
    return np.repeat([0.0, 2.0 * np.pi * STILL_HZ], [air.frames, len(air.viscous) - len(air.mass) - air.frames])


def _n_rigid(basis: ModalBasis, air: CavityAir) -> int:
    """How many rigid motions there still are: those that change the volume of no cavity."""
    free = np.array([kind == "rigid" for kind in basis.kind], dtype=bool)
    if not free.any():
        return 0
    k = len(free)
    q, inner = air.compression[:, :k][:, free], air.compression[:, k:]
    left = q - inner @ np.linalg.lstsq(inner, q)[0] if inner.size else q  # what the air can follow resists nothing
    largest = float(np.abs(air.compression[:, :k]).max(initial=0.0))
    return int(free.sum()) - int(np.linalg.matrix_rank(left, tol=_NONE * largest))


def _ordered(basis: ModalBasis, own: Floats, n_rigid: int, n_modes: int) -> tuple[tuple[Kind, ...], Integers]:
    """Kinds of the new coordinates in their order: modes, then residual vectors, then what only drag moves."""
    residual = np.ones(own.shape[1], dtype=bool)
    residual[:n_modes] = completing(basis, own[:, :n_modes], n_rigid)
    rigid = np.arange(len(residual)) < n_rigid
    order = np.argsort(residual, kind="stable").astype(np.int64)
    kinds: tuple[Kind, ...] = tuple(
        "residual" if residual[i] else "rigid" if rigid[i] else "elastic" for i in order.tolist()
    )
    return kinds, order


def _holders(basis: ModalBasis, air: CavityAir, turn: Floats, own: Floats) -> dict[str, Holder]:
    """Who holds the energy: those who held it before, the air of the cavities, and wool in them."""
    k, moving = len(basis.omega), len(air.mass)
    before = basis.holders or {"structure": Holder(np.eye(k), np.diag(basis.omega**2))}
    moved, of_wool, still = turn[:moving], turn[moving:], _still(air)
    squeezed = air.compression @ moved
    found = {key: holder.turned(own) for key, holder in before.items()}
    found[AIR] = Holder(moved.T @ air.mass @ moved, squeezed.T @ squeezed)
    if len(still):
        found[WOOL] = Holder(of_wool.T @ of_wool, (of_wool.T * still**2) @ of_wool)
    return found
