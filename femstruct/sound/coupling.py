"""Two-way coupling: a basis of the structure together with the air of a closed room below it."""

from __future__ import annotations

from dataclasses import replace
from math import isfinite
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, eigh

from acoustics.fields.sound_field import SoundField
from acoustics.rooms.box_coupling import CoupledAir, Leak
from acoustics.source import SurfaceShapes, side_by_side
from femstruct.arrays import Floats
from femstruct.errors import Finding, InputError
from femstruct.modal.basis import ForceRow, Holder, Kind, ModalBasis, in_time
from femstruct.modal.eigen import fix_signs
from femstruct.sound.placed import Placed

# ----------------------------------------------------------------------------------------------------------------------
# What bases of structure and air share: all of the structure in the new modes, and whether damping couples them.
# ----------------------------------------------------------------------------------------------------------------------

Bools = NDArray[np.bool_]
# Of the motion of the structure, and of that of the air: damping between modes that makes less of both is left out.
NEGLIGIBLE_DAMPING_COUPLING: Final = 1e-3
_LOADS: Final = 8
_LIGHT: Final = 1e-6


def coupling_share(damping: Floats, omega: Floats, structure: Floats, true: Bools, of: Floats | None = None) -> float:
    """Share of a motion that damping between modes makes: rms over the resonances, under broad loads on the structure.

    To first order: off the diagonal it drives a mode with what the others do.

    Parameters
    ----------
    damping, omega : Floats [k, k], Floats [k]
        Of the modes [rad/s].
    structure : Floats [m, k]
        Motion of the structure in every mode.
    true : Bools [k]
        Has a resonance that means something.
    of : Floats | None [p, k]
        The motion of which the share is, in every mode, as that of the air; the structure's if left out.
    """
    between = damping - np.diag(np.diag(damping))
    if not between.any():
        return 0.0
    loads = structure.T @ np.random.default_rng(1).standard_normal((len(structure), _LOADS))
    at = omega[true & (omega > 0.0)][:, None]
    own = np.maximum(np.diag(damping), _LIGHT * omega)  # a mode without damping: its peak stays finite
    answer = 1.0 / (omega**2 - at**2 + 1j * at * own)
    motion = answer[:, :, None] * loads
    change = answer[:, :, None] * (at[:, :, None] * (between @ motion))
    rows = structure if of is None else of
    sizes = [float(np.linalg.norm(np.tensordot(rows, part, axes=(1, 1)))) for part in (change, motion)]
    return sizes[0] / sizes[1] if sizes[1] > 0.0 else 0.0


def completing(basis: ModalBasis, own: Floats, n_rigid: int) -> Bools:
    """Which of new coordinates [n] complete a response and are no modes: as many as the basis has behind its modes,
    those that lie most along these.

    Parameters
    ----------
    own : Floats [k, n]
        The coordinates of the basis in each.
    """
    found = np.zeros(own.shape[1], dtype=bool)
    share = (own[basis.modes.stop :] ** 2).sum(axis=0)
    found[np.argsort(-share, kind="stable")[: len(basis.omega) - basis.modes.stop]] = True
    found[:n_rigid] = False
    return found


def in_new_modes(
    basis: ModalBasis,
    omega: Floats,
    kind: tuple[Kind, ...],
    own: Floats,
    losses: tuple[Floats, Floats],
    *,
    coupled: bool,
    **of_air: Any,
) -> ModalBasis:
    """The basis in the modes of structure and air, all that is the structure's in terms of them.

    Parameters
    ----------
    omega : Floats [n]
        Their frequencies [rad/s].
    own : Floats [k, n]
        The coordinates of the basis in each.
    losses : tuple[Floats, Floats] [n, n]
        Viscous and hysteretic.
    coupled : bool
        Whether damping between modes is kept.
    **of_air : Any
        Fields that the air decides.
    """
    dashpots: Floats = own.T @ basis.dashpots @ own
    damping = [*losses, dashpots] if coupled else [np.diag(np.diag(one)) for one in (*losses, dashpots)]
    viscous, hysteretic, dashpots = (0.5 * (one + one.T) for one in damping)
    return replace(
        basis,
        omega=omega,
        kind=kind,
        shapes=basis.shapes @ own,
        viscous=viscous,
        hysteretic=hysteretic,
        dashpots=dashpots,
        outputs={key: transform_row(row, basis.omega, omega, own) for key, row in basis.outputs.items()},
        part_stiffness={key: own.T @ part @ own for key, part in basis.part_stiffness.items()},
        momentum=basis.momentum @ own,
        **of_air,
    )


def coupling_residual(before: Floats, mass: Floats, compression: Floats, after: Floats, x: Floats) -> Floats:
    """|K x - omega^2 M x| over the terms it is summed from, for every coordinate [n].

    before [k], after [n] [rad/s] : of the structure, of both.

    Parameters
    ----------
    mass, compression : Floats [m, m], Floats [r, m]
        Of the air over all coordinates, those of the structure first.
    x : Floats [m, n]
        The new coordinates.
    """
    k, whole = len(before), len(x)
    structure = np.concatenate([before, np.zeros(whole - k)])[:, None] ** 2 * x
    pressed = compression.T @ (compression @ x)
    inertia = (mass @ x + np.concatenate([x[:k], np.zeros((whole - k, x.shape[1]))])) * after**2
    sizes = [np.linalg.norm(part, axis=0) for part in (structure, pressed, inertia)]
    left: Floats = np.linalg.norm(structure + pressed - inertia, axis=0)
    terms: Floats = np.sum(sizes, axis=0)
    share: Floats = np.divide(left, terms, out=np.zeros_like(left), where=terms > 0)
    return share


def pad_rows(matrix: Floats, size: int) -> Floats:
    padded = np.zeros((size, size))
    padded[: len(matrix), : len(matrix)] = matrix
    return padded


def transform_row(row: ForceRow, before: Floats, after: Floats, own: Floats) -> ForceRow:
    """A force in the new modes; its structural damping acts in time as at their frequencies."""
    hysteretic = row.hysteretic @ own
    at_own = np.divide(row.hysteretic, before, out=np.zeros_like(before), where=before > 0)
    at_new = np.divide(hysteretic, after, out=np.zeros_like(after), where=after > 0)
    damping = (row.damping - at_own) @ own + at_new
    return ForceRow(row.stiffness @ own, damping, row.inertia @ own, hysteretic, row.direct, row.carried)


# ----------------------------------------------------------------------------------------------------------------------
# Findings of two-way coupling: its effect, and where it is a rough approximation.
# ----------------------------------------------------------------------------------------------------------------------


def cut(air: CoupledAir, asked_hz: float) -> tuple[Finding, ...]:
    """A finding when cavity modes are added mass already below the frequency asked for."""
    kept = air.complete_below_hz
    if kept >= asked_hz:
        return ()
    return (
        Finding(
            "cavity-modes-cut",
            f"The {len(air.frequency_hz)} room modes below {kept:.4g} Hz react on the structure. From there to "
            f"{asked_hz:.4g} "
            "Hz, the last mode of the structure, the air acts as a mass only: resonances of the room affect the sound "
            "at the receivers, not the structure",
            {"cavity_modes_up_to_hz": kept, "asked_hz": asked_hz},
        ),
    )


def what_it_did(
    basis: ModalBasis, joined: ModalBasis, own: Floats, air: CoupledAir, between: tuple[float, float, bool], name: str
) -> Finding:
    """What the coupling did: the mode that the air stiffens most, before and after.

    Parameters
    ----------
    between : tuple[float, float, bool]
        What damping between modes makes of the motion of the structure and of the air, and whether it is kept.
    """
    in_structure, in_air, kept = between
    added = air.compression[0, : len(basis.omega)][basis.modes] ** 2
    share = np.divide(added, added + basis.omega[basis.modes] ** 2, out=np.zeros_like(added), where=added > 0)
    stiffened = int(share.argmax())
    partner = int((own[stiffened] ** 2)[joined.modes].argmax())
    before, after = float(basis.frequency_hz[stiffened]), float(joined.frequency_hz[partner])
    n = len(air.frequency_hz)
    leaks = name in joined.volumes
    closed, yielding = "with a leak" if leaks else "sealed", len(air.mass) - n - leaks - len(basis.omega)
    also = f" and {yielding} mode shapes of its compliant walls" if yielding else ""
    return Finding(
        "two-way-coupling",
        f"The air of the room ({closed}) reacts on the structure with {n} room modes below {air.complete_below_hz:.4g} "
        f"Hz{also}, the others as added mass: mode {stiffened + 1}, {before:.2f} Hz in vacuo, is mode {partner + 1} at "
        f"{after:.2f} Hz. Mode numbers, frequencies and the energy of the modes are those with the air. Damping "
        f"between its modes causes {in_structure:.1e} of the motion of the structure, {in_air:.1e} of that of the air, "
        f"and is {'included' if kept else 'left out'}",
        {
            "in_vacuo_hz": before,
            "coupled_hz": after,
            "in_vacuo_mode": stiffened + 1.0,
            "coupled_mode": partner + 1.0,
            "cavity_modes": float(n),
            "cavity_modes_up_to_hz": air.complete_below_hz,
            "damping_between_modes": in_structure,
            "damping_between_modes_in_air": in_air,
        },
    )


# ----------------------------------------------------------------------------------------------------------------------
# Two-way coupling.
# ----------------------------------------------------------------------------------------------------------------------

_NONE: Final = 1e-9  # share of a surface's motion below which it displaces no volume: rounding


def with_cavity(
    basis: ModalBasis, placed: Placed, *, leak: Leak | None = None, up_to_hz: float | None = None
) -> ModalBasis:
    """The basis of a structure and the air of the closed room beside its surfaces: real, mass-normalised modes.

    Parameters
    ----------
    basis : ModalBasis
        In vacuo, with the damping that belongs to the structure alone: a damping ratio measured with the air in place
        would be another.
    placed : Placed
        The room; under its name the leak's volume is kept in `volumes`.
    leak : Leak | None
        An opening of the room to still air outside.
    up_to_hz : float | None
        Cavity modes up to it are coordinates of their own, the others added mass; left out: as far as the structure's
        modes are complete, and at most the 300 lowest.

    Returns
    -------
    ModalBasis
        A ModalBasis of k + n modes, k of the structure with its residual vectors and n of the room, with one more for a
        leak, and one for every shape in which walls yield. Its shapes are the motion of the structure in each; modes of
        the air move it little. It may be coupled to another room in turn.

    Raises
    ------
    InputError
        When an infinite basis (closed form) is given no `up_to_hz`, AcousticsError for a kind of room without two-way
        coupling.

    Notes
    -----
    K = diag(Omega^2, 0) + b_0^T b_0 + B^T B and M = 1 + the air's: see `acoustics.rooms.box_coupling`. The air's losses
    are those of the room, the same that its pressure has. Frequencies are Rayleigh quotients of the energies, summed
    without cancellation. A room without a leak takes away one rigid mode, if any of them displaces volume.

    Damping couples the new modes. Where that makes less than 1e-3 of the motion of the structure and of that of the
    air, and there is no leak and no resistance of a compliant wall, only the diagonal is kept, which halves the time of
    `simulate`; the finding ``two-way-coupling`` says which, and gives frequencies in vacuo and coupled.
    The shapes are not orthonormal with the mass of the structure alone, but with that of structure and air; `holders`
    has what of their energy is the structure's, the air's (with the plug of a leak) and that of walls that yield.

    Absorbing walls of a room of any shape damp each of its modes separately, with the rate c int beta P_n^2 / V
    of its energy; the finding ``two-way-absorption`` reports where that is not enough. Compliant walls are exact.

    Examples
    --------
    A rigid square of 1 kg over half a cubic metre of air, its only spring, 1.21 343^2 0.25^2 / 0.5 N/m, a third of
    which moves with it:

    >>> from scipy.sparse import csr_array
    >>> from acoustics.fields.rectangular import Room
    >>> from femstruct.modal.closed_form import oscillator
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
    reach = _reach(basis, placed, up_to_hz)
    surfaces = placed.shapes(basis)
    omega, viscous = basis.omega, basis.viscous
    if leak is not None:
        surfaces = _leaking(surfaces, leak)
        omega, viscous = np.append(omega, 0.0), block_diag(viscous, np.array([[leak.resistance / leak.inertance]]))
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
    viscous = turn.T @ (pad_rows(viscous, len(turn)) + air.viscous) @ turn
    hysteretic = turn.T @ (pad_rows(basis.hysteretic, len(turn)) + air.hysteretic) @ turn
    hysteretic[:n_rigid, :] = hysteretic[:, :n_rigid] = 0.0
    damping, moved = in_time(viscous, hysteretic, coupled), own[basis.modes]
    rates_of_air = turn[k : k + len(air.frequency_hz)] * coupled  # pressures go with them
    in_structure = coupling_share(damping, coupled, moved, ~residual)
    in_air = coupling_share(damping, coupled, moved, ~residual, rates_of_air)
    # The resistance of a leak or of a wall that yields is a dashpot, never a modal ratio.
    dashpots = leak is not None or bool(basis.volumes) or air.resisted or bool(hidden.any())
    kept = dashpots or max(in_structure, in_air) >= NEGLIGIBLE_DAMPING_COUPLING
    kinds: tuple[Kind, ...] = tuple(
        "rigid" if number < n_rigid else "residual" if pseudo else "elastic" for number, pseudo in enumerate(residual)
    )
    heavier = float(np.linalg.eigvalsh(air.mass[:k, :k]).max(initial=0.0))  # lowers modes that the basis lacks
    joined = in_new_modes(
        basis,
        coupled,
        kinds,
        own,
        (viscous, hysteretic),
        coupled=kept,
        residual_norm=coupling_residual(omega, air.mass, air.compression, coupled, turn),
        complete_below_hz=min(basis.complete_below_hz / np.sqrt(1.0 + heavier), air.complete_below_hz),
        holders=_holders(basis, air, turn, own, name, leak is not None),
        volumes={key: row @ own for key, row in basis.volumes.items()}
        | ({} if leak is None else {name: -turn[k] / np.sqrt(leak.inertance)}),
    )
    first_hz = float(joined.frequency_hz[np.array(kinds) == "elastic"][:1].sum())
    advised = [Finding(one.code, one.message, one.values) for one in room.coupling_advice(first_hz)]
    findings = (what_it_did(basis, joined, own, air, (in_structure, in_air, kept), name), *cut(air, reach), *advised)
    return replace(joined, findings=(*basis.findings, *findings))


def _reach(basis: ModalBasis, placed: Placed, up_to_hz: float | None) -> float:
    """Frequency up to which modes of the room are coordinates of their own [Hz]: the one that is given, else as far as
    the structure's modes are complete, else as far as the room's are. Raises InputError where none is finite."""
    if up_to_hz is None and not isfinite(placed.room.complete_up_to_hz) and not 0 < basis.complete_below_hz < np.inf:
        raise InputError(
            f"rooms.{placed.name}",
            got="a basis in closed form",
            expected="a frequency up to which the room's modes are kept",
            do="give up_to_hz",
        )
    reach = up_to_hz or basis.complete_below_hz
    return reach if 0 < reach < np.inf else placed.room.complete_up_to_hz


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
    turn[seen, : len(seen)] = fix_signs(moving, np.ones(len(seen)))
    turn[np.flatnonzero(hidden), len(seen) + np.arange(int(hidden.sum()))] = 1.0
    squared = ((structure[:, None] * turn) ** 2).sum(axis=0) + ((air.compression @ turn) ** 2).sum(axis=0)
    squared[:n_rigid] = 0.0
    return np.sqrt(squared), turn
