"""Two-way coupling: a basis of the structure together with the air of a closed room below it."""

from __future__ import annotations

from dataclasses import replace
from math import isfinite
from typing import Final

import numpy as np
from scipy.linalg import block_diag, eigh

from acoustics.fields.sound_field import SoundField
from acoustics.rooms.box_two_way import CoupledAir, Leak
from acoustics.source import SurfaceShapes, side_by_side
from femstruct.arrays import Floats
from femstruct.errors import Finding, InputError
from femstruct.modal.basis import Holder, Kind, ModalBasis, in_time
from femstruct.modal.solve import signed
from femstruct.sound.coupled_modes import (
    NEGLIGIBLE_DAMPING_COUPLING,
    Bools,
    completing,
    in_new_modes,
    left_over,
    padded,
    stray_share,
)
from femstruct.sound.placed import Placed
from femstruct.sound.two_way_findings import cut, what_it_did

_NONE: Final = 1e-9  # share of a surface's motion below which it displaces no volume: rounding


def with_cavity(
    basis: ModalBasis, placed: Placed, *, leak: Leak | None = None, up_to_hz: float | None = None
) -> ModalBasis:
    """The basis of a structure and the air of the closed room beside its surfaces: real, mass-normalised modes.

    basis : in vacuo, with the damping that belongs to the structure alone: a damping ratio measured with the air in
        place would be another.
    placed : the room; under its name the leak's volume is kept in `volumes`.
    leak : an opening of the room to still air outside.
    up_to_hz : cavity modes up to it are coordinates of their own, the others added mass; left out: as far as the
        structure's modes are complete, and at most the 300 lowest.

    Returns a ModalBasis of k + n modes, k of the structure with its residual vectors and n of the room, with one more
    for a leak, and one for every shape in which walls yield. Its shapes are the motion of the structure in each; modes
    of the air move it little. It may be coupled to another room in turn.

    Raises InputError when an infinite basis (closed form) is given no `up_to_hz`, AcousticsError for a kind of room
    without two-way coupling.

    Notes
    -----
    K = diag(Omega^2, 0) + b_0^T b_0 + B^T B and M = 1 + the air's: see `acoustics.rooms.box_two_way`. The air's losses
    are those of the room, the same that its pressure has. Frequencies are Rayleigh quotients of the energies, summed
    without cancellation. A room without a leak takes away one rigid mode, if any of them displaces volume.

    Damping couples the new modes. Where that makes less than 1e-3 of the structure's motion, and there is no leak and
    no resistance of a compliant wall, only the diagonal is kept, which halves the time of `simulate`; the finding
    ``two-way-coupling`` says which, and gives frequencies in vacuo and coupled.
    The shapes are not orthonormal with the mass of the structure alone, but with that of structure and air; `holders`
    has what of their energy is the structure's, the air's (with the plug of a leak) and that of walls that yield.

    Absorbing walls of a room of any shape damp each of its modes separately, with the rate c int beta P_n^2 / V
    of its energy; the finding ``two-way-absorption`` reports where that is not enough. Compliant walls are exact.

    A rigid square of 1 kg over half a cubic metre of air, its only spring, 1.21 343^2 0.25^2 / 0.5 N/m, a third of
    which moves with it:

    >>> from scipy.sparse import csr_array
    >>> from acoustics.fields.rectangular import Room
    >>> from femstruct.modal.analytic import oscillator
    >>> from femstruct.model.probe import Surface
    >>> from femstruct.sound.placed import placed
    >>> square, points = oscillator(1.0, frequency_hz=0.0, axis="z")
    >>> corners = [[-0.25, -0.25, 0], [0.25, -0.25, 0], [0.25, 0.25, 0], [-0.25, 0.25, 0]]
    >>> below = Surface("below", [[0, 0, 0]], [0.25], [[0, 0, -1]], [[1, 0, 0], [0, 1, 0]], corners,
    ...                 csr_array([[0, 0, -1.0, 0, 0, 0, 0]]))
    >>> floating = with_cavity(square, placed(Room([0.5, 0.5, 2.0]), below), up_to_hz=30.0)
    >>> floating.n_rigid, floating.frequency_hz.round(1)
    (0, array([19.4]))
    """
    room, name = placed.room, placed.name
    if up_to_hz is None and not isfinite(room.complete_up_to_hz) and not 0 < basis.complete_below_hz < np.inf:
        raise InputError(
            f"rooms.{name}",
            got="a basis in closed form",
            expected="a frequency up to which the room's modes are kept",
            do="give up_to_hz",
        )
    surfaces = placed.shapes(basis)
    omega, viscous = basis.omega, basis.viscous
    if leak is not None:
        surfaces = _leaking(surfaces, leak)
        omega, viscous = np.append(omega, 0.0), block_diag(viscous, np.array([[leak.resistance / leak.inertance]]))
    reach = up_to_hz or basis.complete_below_hz
    reach = reach if 0 < reach < np.inf else room.complete_up_to_hz
    air = room.coupled_air(surfaces, reach)
    free = np.append(np.array([kind == "rigid" for kind in basis.kind], dtype=bool), [True] * (leak is not None))
    n_rigid = int(free.sum()) - _resisted(air.compression[0, : len(omega)] * free, side_by_side(surfaces), room)
    # what no force meets, as wool in a cavity of the structure, no room meets either
    hidden = np.zeros(air.compression.shape[1], dtype=bool)
    hidden[: len(basis.omega)] = ~basis.shapes.any(axis=(0, 1)) & (np.array(basis.kind) == "residual")
    coupled, turn = _coupled_modes(omega, air, n_rigid, hidden)
    k, own = len(basis.omega), turn[: len(basis.omega)]
    residual = completing(basis, own, n_rigid)
    order = np.argsort(residual, kind="stable")
    coupled, turn, own, residual = coupled[order], turn[:, order], own[:, order], residual[order]
    viscous = turn.T @ (padded(viscous, len(turn)) + air.viscous) @ turn
    hysteretic = turn.T @ (padded(basis.hysteretic, len(turn)) + air.hysteretic) @ turn
    rigid = np.arange(len(coupled)) < n_rigid
    hysteretic[rigid, :] = hysteretic[:, rigid] = 0.0
    stray = stray_share(in_time(viscous, hysteretic, coupled), coupled, own[basis.modes], ~residual)
    # The resistance of a leak or of a wall that yields is a dashpot, never a modal ratio.
    kept = stray >= NEGLIGIBLE_DAMPING_COUPLING or leak is not None or bool(basis.volumes) or air.resisted
    kept = kept or bool(hidden.any())
    kinds: tuple[Kind, ...] = tuple(
        "rigid" if still else "residual" if pseudo else "elastic" for still, pseudo in zip(rigid, residual, strict=True)
    )
    heavier = float(np.linalg.eigvalsh(air.mass[:k, :k]).max(initial=0.0))  # lowers modes that the basis lacks
    joined = in_new_modes(
        basis,
        coupled,
        kinds,
        own,
        (viscous, hysteretic),
        coupled=kept,
        residual_norm=left_over(omega, air.mass, air.compression, coupled, turn),
        complete_below_hz=min(basis.complete_below_hz / np.sqrt(1.0 + heavier), air.complete_below_hz),
        holders=_holders(basis, air, turn, own, name, leak is not None),
        volumes={key: row @ own for key, row in basis.volumes.items()}
        | ({} if leak is None else {name: -turn[k] / np.sqrt(leak.inertance)}),
    )
    first_hz = float(joined.frequency_hz[np.array(kinds) == "elastic"][:1].sum())
    advised = [Finding(one.code, one.message, one.values) for one in room.coupling_advice(first_hz)]
    told = (what_it_did(basis, joined, own, air, (stray, kept), name), *cut(air, reach), *advised)
    return replace(joined, findings=(*basis.findings, *told))


def _holders(
    basis: ModalBasis, air: CoupledAir, turn: Floats, own: Floats, name: str, leaks: bool
) -> dict[str, Holder]:
    """Who holds the energy of the new modes: those who held it before, the air of the room, walls that yield."""
    k, rows = len(basis.omega), 1 + len(air.frequency_hz)
    before = basis.holders or {"structure": Holder(np.eye(k), np.diag(basis.omega**2))}
    plug = np.zeros(len(turn))
    plug[k : k + leaks] = 1.0
    squeezed, sprung = air.compression[:rows] @ turn, air.compression[rows:] @ turn
    moving = turn.T @ (air.mass + np.diag(plug - air.walls)) @ turn
    walls = {f"walls of {name}": Holder((turn.T * air.walls) @ turn, sprung.T @ sprung)} if len(sprung) else {}
    return {
        **{key: holder.turned(own) for key, holder in before.items()},
        f"air of {name}": Holder(moving, squeezed.T @ squeezed),
        **walls,
    }


def _leaking(surfaces: list[SurfaceShapes], leak: Leak) -> list[SurfaceShapes]:
    """The surfaces with one more coordinate: the plug of a leak, whose flow is spread over them."""
    flow = -1.0 / (np.sqrt(leak.inertance) * sum(one.area for one in surfaces))
    return [replace(one, shapes=np.hstack([one.shapes, np.full((len(one.shapes), 1), flow)])) for one in surfaces]


def _resisted(volume: Floats, moving: SurfaceShapes, room: SoundField) -> int:
    """1 if a free motion compresses the air, 0 if none does."""
    root = np.sqrt(room.air.bulk_modulus / room.volume)
    largest = root * (moving.weights @ np.abs(moving.shapes))
    return int((np.abs(volume) > _NONE * largest).any())


def _coupled_modes(omega: Floats, air: CoupledAir, n_rigid: int, hidden: Bools) -> tuple[Floats, Floats]:
    """Circular frequencies and mass-normalised modes over [structure; leak; cavity]; what is hidden is last."""
    k, whole = len(omega), air.compression.shape[1]
    structure = np.concatenate([omega, np.zeros(whole - k)])
    mass = air.mass + np.diag(np.concatenate([np.ones(k), np.zeros(whole - k)]))
    stiffness = np.diag(structure**2) + air.compression.T @ air.compression
    seen = np.flatnonzero(~hidden)
    turn = np.zeros((whole, whole))
    moving: Floats = eigh(stiffness[np.ix_(seen, seen)], mass[np.ix_(seen, seen)])[1]
    turn[seen, : len(seen)] = signed(moving, np.ones(len(seen)))
    turn[np.flatnonzero(hidden), len(seen) + np.arange(int(hidden.sum()))] = 1.0
    squared = ((structure[:, None] * turn) ** 2).sum(axis=0) + ((air.compression @ turn) ** 2).sum(axis=0)
    squared[:n_rigid] = 0.0
    return np.sqrt(squared), turn
