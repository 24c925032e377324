"""Losses of materials in modes, also of loss factors that depend on frequency: each mode at its own."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.modal.basis import ModalBasis
from femstruct.model.materials.loss_by_frequency import LossByFrequency, loss_at

BEYOND = 2.0**0.5  # ratio of frequencies from which on a mode is outside a table: half an octave, half a band
STRAINED = 0.01  # of a mode's elastic energy: parts with less hardly damp it
UNUSED = 0.1  # of a mode's loss factor: what is left out by more changes a resonance by 0.8 dB, a band by 0.4 dB
UNUSED_LEAST = 1e-4  # loss factor that no mode notices
UNDAMPED = 5e-5  # damping ratio: a loss factor of 1e-4, which metals have by themselves and no built structure has


def material_losses(basis: ModalBasis) -> Floats:
    """Structural damping [k, k] of the parts' loss factors [rad^2/s^2]: the sum of eta K of all parts.

    Notes
    -----
    Of a table sqrt(eta(f_r) eta(f_s)) K_rs: the diagonal is the strain energy with the loss factor at the mode's own
    frequency, and the whole is never active. A rigid mode strains no part.
    """
    losses = np.zeros_like(basis.hysteretic)
    for part, stiffness in basis.part_stiffness.items():
        loss = basis.loss_factors.get(part, 0.0)
        if isinstance(loss, LossByFrequency):
            roots = np.sqrt(loss.at(basis.frequency_hz))
            losses += roots[:, None] * stiffness * roots
        else:
            losses += loss * stiffness
    rigid = basis.omega == 0.0
    losses[rigid, :] = losses[:, rigid] = 0.0  # rounding
    return losses


def unused_losses(basis: ModalBasis, damping: Floats) -> tuple[Finding, ...]:
    """Springs, foundations and edges on the ground whose loss factors a general law leaves out, where they matter.

    damping [k, k] : loss factors of the modes times their omega^2 on the diagonal, as the law gives them [rad^2/s^2].
    """
    elastic = np.array([kind == "elastic" for kind in basis.kind])
    found = []
    for part in dict.fromkeys(basis.grounded):
        if part not in basis.part_stiffness or not elastic.any():
            continue
        loss = loss_at(basis.loss_factors.get(part, 0.0), basis.frequency_hz)
        lost, squared = (loss * np.diag(basis.part_stiffness[part]))[elastic], basis.omega[elastic] ** 2
        given, own = np.diag(damping)[elastic] / squared, lost / squared
        if not (own > np.maximum(UNUSED * given, UNUSED_LEAST)).any():
            continue
        worst = int(np.argmax(own))
        hz = float(basis.frequency_hz[elastic][worst])
        found.append(
            Finding(
                "loss-unused",
                f"{part}: its loss factor is not used, because 'damping' gives one law for the whole structure. By "
                f"strain energy it would add {100 * own[worst]:.3g} % to the loss factor of {100 * given[worst]:.3g} % "
                f"of the mode at {hz:.4g} Hz. Write damping: {{from: materials}} to have it",
                {"unused_loss_factor": float(own[worst]), "loss_factor": float(given[worst]), "frequency_hz": hz},
            )
        )
    return tuple(found)


def beyond_tables(basis: ModalBasis) -> tuple[Finding, ...]:
    """Parts whose loss factor is given by frequency, and modes strained in them that are outside of what is given."""
    found = []
    elastic = np.array([kind == "elastic" for kind in basis.kind])
    frequency, squared = basis.frequency_hz[elastic], basis.omega[elastic] ** 2
    for part, stiffness in basis.part_stiffness.items():
        loss = basis.loss_factors.get(part, 0.0)
        if not isinstance(loss, LossByFrequency):
            continue
        low, high = loss.band
        strained = np.diag(stiffness)[elastic] > STRAINED * squared
        outside = strained & ((frequency < low / BEYOND) | (frequency > high * BEYOND))
        if not outside.any():
            continue
        first, last = frequency[outside].min(), frequency[outside].max()
        found.append(
            Finding(
                "loss-beyond-table",
                f"{part}: its loss factor is given from {low:g} to {high:g} Hz. {int(outside.sum())} of the "
                f"{int(strained.sum())} modes that strain it are outside, {_told(first, last)}, and have "
                "the value of the nearest frequency",
                {"modes": float(outside.sum()), "lowest_hz": float(first), "highest_hz": float(last)},
            )
        )
    return tuple(found)


def _told(first: float, last: float) -> str:
    """A range of frequencies [Hz] in words, or the one there is."""
    low, high = f"{first:.4g}", f"{last:.4g}"
    return f"at {low} Hz" if low == high else f"from {low} to {high} Hz"
