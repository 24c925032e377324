"""Cavities of a structure: its basis together with the air and the wool between its surfaces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from scipy.linalg import cholesky, eigh, solve_triangular

from acoustics.cavities.cavity_air import MOST, STILL_HZ, CavityAir, cavity_air
from acoustics.cavities.condensed import ALLOWED, condensed
from acoustics.cavities.several import together
from acoustics.rooms.box import Box, room_modes
from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError
from femstruct.modal.basis import Holder, Kind, ModalBasis, in_time
from femstruct.modal.solve import signed
from femstruct.sound.cavity_findings import findings_of
from femstruct.sound.coupled_modes import (
    NEGLIGIBLE_DAMPING_COUPLING,
    completing,
    in_new_modes,
    left_over,
    padded,
    stray_share,
)
from femstruct.sound.placed_cavity import PlacedCavity

ALONE: Final = 0.25  # of what may be left out of all cavities: what is left out of each before they are joined
AIR: Final = "air of the cavities"
WOOL: Final = "wool of the cavities"
HIGHEST: Final = 4  # one in so many modes of the structure stands for those it lacks
_NONE: Final = 1e-9  # share of a motion below which it displaces no volume: rounding


def with_cavities(basis: ModalBasis, placed: Sequence[PlacedCavity], *, up_to_hz: float | None = None) -> ModalBasis:
    """The basis of a structure and the air and wool in cavities between its surfaces: mass-normalised, full damping.

    basis : in vacuo, with the damping of the structure alone. placed : all cavities, bays one by one.
    up_to_hz : modes of the air up to it are coordinates of their own; left out: as far as the modes of the structure
    need them, and at most the 400 lowest of each cavity.

    Returns a ModalBasis whose modes are those of structure and air without losses, isothermal in wool. Behind its
    residual vectors it has coordinates that no force meets and only drag moves, of kind "residual" too: frames of limp
    wool and layers of air that slide over wool, at 0 Hz, and what heat adds to the pressure in wool, far above the
    band.

    Raises InputError when an infinite basis (closed form) is given no `up_to_hz`.

    Notes
    -----
    See `acoustics.cavities.cavity_air`. Wool makes damping full: modes of the air are overdamped, and their ratios are
    no measure of it. Without wool damping between modes is left out where it makes less than 1e-3 of the motion.
    Energy is that of `holders`: the structure, the air of the cavities and the wool in them.
    Coordinates that the structure does not move in its band are left out (`acoustics.cavities.condensed`).
    All matrices are symmetric, mass is positive, stiffness and damping are not negative: nothing can grow.

    Two free boards on a cushion of air: one of their twelve rigid motions, one against the other, has a frequency.

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
        condensed(cavity_air(one.cavity, *one.shapes(basis), limit), basis.omega, top, ALONE * ALLOWED)
        for one, limit in zip(placed, limits, strict=True)
    ]
    air = airs[0] if len(airs) == 1 else condensed(together(airs, len(basis.omega)), basis.omega, top)
    coupled = _coupled(basis, air, woolly=any(one.cavity.wool is not None for one in placed))
    return replace(coupled, findings=(*basis.findings, *findings_of(basis, coupled, placed, airs)))


def _coupled(basis: ModalBasis, air: CavityAir, *, woolly: bool) -> ModalBasis:
    """The basis with the air; without its findings."""
    k = len(basis.omega)
    omega, turn, n_rigid = _modes(basis, air)
    own = turn[:k]
    kinds, order = _ordered(basis, own, n_rigid, len(air.mass) - air.loose)
    omega, turn, own = omega[order], turn[:, order], own[:, order]
    viscous = turn.T @ (padded(basis.viscous, len(turn)) + air.viscous) @ turn
    hysteretic = own.T @ basis.hysteretic @ own
    still = omega == 0.0
    hysteretic[still, :] = hysteretic[:, still] = 0.0
    true = np.array([kind != "residual" for kind in kinds], dtype=bool)
    stray = 1.0 if woolly else stray_share(in_time(viscous, hysteretic, omega), omega, own[basis.modes], true)
    return in_new_modes(
        basis,
        omega,
        kinds,
        own,
        (viscous, hysteretic),
        coupled=stray >= NEGLIGIBLE_DAMPING_COUPLING or bool(basis.volumes),
        residual_norm=left_over(basis.omega, air.mass, air.compression, omega, turn[: len(air.mass)]),
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
    wanted = one.cavity.kept_hz(top_hz)
    frequency_hz, _ = room_modes(Box(one.cavity.size, one.cavity.air), wanted)
    return wanted if len(frequency_hz) <= MOST else float(frequency_hz[MOST]) * (1.0 - 1e-9)


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
    turn = signed(turn, np.ones(first))
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
