"""The noun of modes that damping couples: oscillators in their place, and what their motion is worth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.modal.coupled_damping.loss_form import loss_surplus
from femstruct.modal.coupled_damping.relaxing import Relaxing, relaxing_of

KNOWN: Final = 1e-9  # of an energy: losses that differ from it by less are not told state by state


@dataclass(frozen=True, eq=False)
class Oscillators:
    """Oscillators in place of K modes that damping couples; rates are in rad/s.

    omega, damping [k] : w and c of each. modes [K] : circular frequencies of the modes. turn [4, K, k] : places, tilts,
    swings and rates; q = places z + tilts v and q' = swings z + rates v. kicks, drives [k, K] : z' = v + kicks u,
    v' = -w^2 z - c v + drives u under modal forces u. gram [2 k, 2 k] : the energy is y . gram y / 2 for y = [z, v].
    surplus : by the damping alone free motion loses that and y . surplus y / 2 from now on: [2 k, 2 k], symmetric, or
    [0, 0] where it is below |misses y|^2 / 2 and 1e-9 of the energies of all y; misses [2 k]. Both are zero but for
    errors of the oscillators.
    residual : what they miss of damping and stiffness, over the rates of the modes [1]. added : share of the damping
    that was added [1]. largest : eigenvalue of the damping matrix [rad/s]. relaxing : sums of few exponentials for many
    of them, None where there are none. ringing : the number of the others, which are first, the longest ringing ahead.
    """

    omega: Floats
    damping: Floats
    modes: Floats
    turn: Floats
    kicks: Floats
    drives: Floats
    gram: Floats
    surplus: Floats
    misses: Floats
    residual: float
    added: float
    largest: float
    relaxing: Relaxing | None
    ringing: int

    @property
    def places(self) -> Floats:
        """What displacements are of z."""
        places: Floats = self.turn[0]
        return places

    @property
    def tilts(self) -> Floats:
        """What displacements are of v."""
        tilts: Floats = self.turn[1]
        return tilts

    @property
    def swings(self) -> Floats:
        """What velocities are of z."""
        swings: Floats = self.turn[2]
        return swings

    @property
    def rates(self) -> Floats:
        """What velocities are of v."""
        rates: Floats = self.turn[3]
        return rates


def in_order(
    modes: Floats,
    w: Floats,
    c: Floats,
    parts: tuple[Floats, Floats, Floats, Floats],
    damping: Floats,
    residual: float,
    added: float,
) -> Oscillators:
    """Oscillators w, c [k] with these places, tilts [K, k], kicks and drives [k, K] of modes with this damping [K, K],
    the longest ringing first."""
    order, k = np.argsort(_slowest(w, c), kind="stable"), len(w)
    creeping, relaxing = relaxing_of(w[order], c[order])
    order = np.append(np.delete(order, creeping), order[creeping])
    w, c = w[order], c[order]
    places, tilts, kicks, drives = parts[0][:, order], parts[1][:, order], parts[2][order], parts[3][order]
    turn = np.array([places, tilts, -tilts * w**2, places - tilts * c], order="C")
    speeds = np.hstack([turn[2], turn[3]])
    gram = speeds.T @ speeds
    held = modes[:, None] * np.hstack([places, tilts])
    gram += held.T @ held
    size = np.sqrt(np.diag(gram))
    reach = np.maximum(np.linalg.norm(kicks, axis=1) * size[:k], np.linalg.norm(drives, axis=1) * size[k:])
    surplus = loss_surplus(w, c, speeds, damping, gram, reach)
    scale = np.where(size > 0.0, size, 1.0)
    shares = np.abs(surplus) / np.outer(scale, scale)
    missed = min(float(shares.sum(axis=1).max(initial=0.0)), float(np.linalg.norm(shares)))  # of a symmetric matrix
    return Oscillators(
        omega=w,
        damping=c,
        modes=modes,
        turn=turn,
        kicks=kicks,
        drives=drives,
        gram=gram,
        surplus=surplus if missed > KNOWN else np.zeros((0, 0)),
        misses=np.sqrt(missed) * size,
        residual=residual,
        added=added,
        largest=float(np.abs(np.linalg.eigvalsh(damping)).max()),
        relaxing=relaxing,
        ringing=k - len(creeping),
    )


def _slowest(omega: Floats, damping: Floats) -> Floats:
    """The rate at which the slower part of an oscillator dies away; of one that nothing holds, that of its speed."""
    half = 0.5 * damping
    fast = half + np.sqrt(np.maximum(half**2 - omega**2, 0.0))
    creeps = np.divide(omega**2, fast, out=np.zeros_like(fast), where=fast > 0.0)
    slow: Floats = np.where(omega == 0.0, damping, np.where(half > omega, creeps, half))
    return slow
