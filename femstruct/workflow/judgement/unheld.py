"""Floors, ceilings and walls of rooms that nothing holds: they fly off as one, and rooms hear that."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from femstruct.errors import Finding, some_of
from femstruct.model.model import Model
from femstruct.parts.findings.connections import pieces
from femstruct.study.study import Study


def unheld_findings(model: Model, joined: Iterable[tuple[str, str]], studies: Sequence[Study]) -> list[Finding]:
    """A finding for every free piece whose surface moves the air of a closed room.

    joined : pairs of points that contacts and links of the studies hold together. studies : of one case.

    Severe: the room is rated. Not under gravity, where `nothing-carries-weight` is said of it, and not of the half
    space, where free plates and machines are measured.
    """
    study = next((one for one in studies if one.time is not None and not one.time.gravity), None)
    rooms = [plan for plan in study.rooms if plan.room.open_air is None] if study is not None else []
    if not rooms:
        return []
    parts = {surface.name: surface.on for surface in model.structure.surfaces}
    found = []
    for piece in pieces(model, joined):
        by = {plan.name: plan for plan in rooms for _, name in plan.moved if parts.get(name) in piece.parts}
        if not by or not piece.falls:
            continue
        rated = any(plan.levels for plan in by.values())
        found.append(
            Finding(
                "nothing-holds-it",
                f"{some_of(piece.parts)}: no support, layer or spring holds its {piece.mass:.4g} kg, and it moves the "
                f"air of {some_of(by)}. A blow sets all of it in motion, for good. Add 'supports' to the model",
                {"mass_kg": piece.mass, "free_motions": len(piece.free)},
                severe=rated,
            )
        )
    return found
