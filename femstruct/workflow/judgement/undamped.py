"""Structures whose modes ring on without end in what is simulated, because nothing damps them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from femstruct.errors import Finding, some_of
from femstruct.modal.basis import ModalBasis
from femstruct.modal.damping import FromMaterials
from femstruct.modal.loss_tables import UNDAMPED
from femstruct.model.materials.loss_by_frequency import loss_at
from femstruct.model.structure import Structure
from femstruct.study.study import Study

PERIODS = 10.0  # of the lowest such mode in the window: with a ratio of 1 % its motion would have halved


def undamped_motion(studies: Sequence[Study], basis: ModalBasis) -> tuple[Finding, ...]:
    """A finding where modes without damping ring through the window of a simulation.

    studies : of one case; they differ by what is struck. basis : with its damping.

    Severe: all modes are so, and a room hears them with air that does not react on the structure. Not of closed forms
    and given modes, whose damping is part of what they are given as.
    """
    study = studies[0] if studies else None
    if study is None or study.time is None or not isinstance(study.structure, Structure):
        return ()
    elastic = np.array([kind == "elastic" for kind in basis.kind], dtype=bool)
    bare = elastic & (basis.damping_ratio < UNDAMPED)
    if not bare.any() or basis.frequency_hz[bare][0] * study.time.duration <= PERIODS:
        return ()
    count, first = int(bare.sum()), float(basis.frequency_hz[bare][0])
    whole = bool(count == elastic.sum())
    heard = some_of([plan.name for plan in study.rooms if plan.coupling == "one-way"])
    which = "No mode has damping" if whole else f"{count} of {elastic.sum()} modes have no damping"
    return (
        Finding(
            "undamped",
            f"{which}: the first of them, at {first:.4g} Hz, vibrates through the whole window without decay. "
            + (f"Levels in {heard} are too high by as much as its damping would lower them. " if heard else "")
            + _advice(study, basis),
            {"modes": count, "first_hz": first, "damping_ratio": float(basis.damping_ratio[bare].max())},
            severe=whole and bool(heard),
        ),
    )


def _advice(study: Study, basis: ModalBasis) -> str:
    if isinstance(study.damping.base, FromMaterials):
        air = isinstance(study.structure, Structure) and study.structure.cavities
        beside = ". Air of a cavity without wool has no losses of its own" if air else ""
        return f"Give a 'loss_factor' to the materials of the parts that move in them{beside}"
    unused = [part for part, loss in basis.loss_factors.items() if np.max(loss_at(loss, basis.frequency_hz)) > 0.0]
    if not unused:
        return "Give the model a 'damping', such as 'damping: {loss_factor: 2 %}'"
    return (
        f"Loss factors of materials (of {some_of(unused)}) are used only with 'damping: {{from: materials}}'. Give "
        "the model this or another 'damping'"
    )
