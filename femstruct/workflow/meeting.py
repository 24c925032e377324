"""What makes a rated level hang on a few hertz: floors that float in the rated bands, floor modes that meet modes of
the room; and rooms that the standard is not for."""

from __future__ import annotations

from math import inf, isfinite, pi, sqrt
from typing import Final

import numpy as np

from acoustics.cavity import cosines
from acoustics.field import HalfSpace
from acoustics.methods import Method
from acoustics.room import Room, modal_damping_ratio, room_modes, t60_of
from acoustics.shaped import ShapedRoom
from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.modal.basis import ModalBasis
from femstruct.model.parts import Foundation, Plate, Structure
from femstruct.model.probe import Surface
from femstruct.radiation import room_coordinates
from femstruct.study.structures import StructureModel
from femstruct.study.study import RoomPlan, Study
from femstruct.workflow.rated import method_for

TOLD: Final = 5  # pairs that are named
ALIKE: Final = 0.3  # of two shapes on the ceiling from which on one drives the other
SINGLE_MODES: Final = 2000.0  # sqrt(m^3/s)/s: above 2000 sqrt(T / V) modes of a room overlap (Schroeder)
DECAY_HZ: Final = 100.0  # where a room's reverberation time is taken to tell up to where its modes stand alone


def meeting_findings(plan: RoomPlan, study: Study, surface: Surface, basis: ModalBasis) -> tuple[Finding, ...]:
    """Findings on a rated room: its volume, floating floors in its bands, and floor modes that meet its own modes.

    surface : the ceiling. basis : of the structure without the air, damped.
    """
    method = method_for(plan, study)
    if method is None:
        return ()
    found = [*_volume(plan, method), *floating(study.structure, method.bands_hz)]
    pairs = meetings(plan, surface, basis)
    if pairs:
        told = ", ".join(
            f"{floor:.1f} Hz of the floor and {room:.1f} Hz of the room" for floor, room, _ in pairs[:TOLD]
        )
        more = f", and {len(pairs) - TOLD} more" if len(pairs) > TOLD else ""
        found.append(
            Finding(
                "modes-meet",
                f"modes within each other's bandwidth, of like shape on the ceiling: {told}{more}; there the levels "
                "hang on a few hertz of either",
                {"pairs": len(pairs), "floor_hz": pairs[0][0], "room_hz": pairs[0][1], "likeness": pairs[0][2]},
            )
        )
    return tuple(found)


def meetings(plan: RoomPlan, surface: Surface, basis: ModalBasis) -> list[tuple[float, float, float]]:
    """Modes of the floor and of the room that meet: (floor [Hz], room [Hz], likeness of shapes [1]), by frequency.

    Up to the frequency above which a room's modes overlap, 2000 sqrt(T60 / V) (M. R. Schroeder, J. Acoust. Soc. Am. 99,
    3240 (1996), doi:10.1121/1.414868). Likeness is the cosine of the angle between the two shapes on the ceiling.
    """
    room = plan.room
    t60 = t60_of(room.losses, DECAY_HZ)
    if isinstance(room, HalfSpace) or not isfinite(t60):
        return []
    top = SINGLE_MODES * sqrt(t60 / room.volume)
    elastic = np.flatnonzero((np.array(basis.kind) == "elastic") & (basis.frequency_hz <= top))
    points = room_coordinates(surface, room, plan.offset, plan.name)
    room_hz, sounds = _on_ceiling(room, points, top)
    if not (len(elastic) and len(room_hz)):
        return []
    likeness = _likeness(surface.shapes(basis.shapes[:, :, elastic]), sounds, surface.weights)
    floor_hz = basis.frequency_hz[elastic]
    floor_width = 2 * np.nan_to_num(basis.damping_ratio[elastic]) * floor_hz
    room_width = np.array([2 * modal_damping_ratio(room.losses, f) * f for f in room_hz.tolist()])
    apart = np.abs(floor_hz[:, None] - room_hz)
    meets = (apart <= 0.5 * (floor_width[:, None] + room_width)) & (likeness >= ALIKE)
    found = [(float(floor_hz[i]), float(room_hz[j]), float(likeness[i, j])) for i, j in np.argwhere(meets)]
    return sorted(found)


def _on_ceiling(room: Room | ShapedRoom, points: Floats, up_to_hz: float) -> tuple[Floats, Floats]:
    """Modes of a room up to a frequency, without the uniform one: frequencies [n] [Hz], shapes at the points [p, n]."""
    if isinstance(room, ShapedRoom):
        chosen = np.flatnonzero((room.frequency_hz <= up_to_hz) & (np.arange(len(room.frequency_hz)) > 0))
        return room.frequency_hz[chosen], room.modes.at(points)[:, chosen]
    frequency_hz, indices = room_modes(room, up_to_hz)
    return frequency_hz, cosines(room, indices[:, :2], points)


def floating(structure: StructureModel, bands_hz: tuple[float, ...]) -> list[Finding]:
    """Plates that float on others with a resonance up to the last of the bands: two masses per area on a spring per
    area, f = sqrt(s (1 / m1 + 1 / m2)) / 2 pi."""
    if not isinstance(structure, Structure):
        return []
    plates = {part.name: part for part in structure.parts if isinstance(part, Plate)}
    found = []
    for part in structure.parts:
        if not (
            isinstance(part, Foundation) and part.on in plates and part.to in plates and part.region.kind == "whole"
        ):
            continue
        upper, lower = (plates[str(name)].material.rho * plates[str(name)].thickness for name in (part.on, part.to))
        resonance = sqrt(part.normal * (1 / upper + 1 / lower)) / (2 * pi)
        if resonance <= bands_hz[-1]:
            found.append(
                Finding(
                    "floating-floor",
                    f"{part.name}: {part.on} and {part.to} resonate on it at {resonance:.1f} Hz; up to "
                    f"{sqrt(2) * resonance:.0f} Hz the floor is louder for it, above quieter, and both hang on its "
                    f"stiffness, {part.normal:.3g} N/m^3, under the load it has there",
                    {
                        "resonance_hz": resonance,
                        "stiffness_n_m3": part.normal,
                        "upper_kg_m2": upper,
                        "lower_kg_m2": lower,
                    },
                )
            )
    return found


def _volume(plan: RoomPlan, method: Method) -> list[Finding]:
    low, high = method.volume_m3 or (0.0, inf)
    if low <= plan.room.volume <= high:
        return []
    return [
        Finding(
            "rating-room-volume",
            f"{method.measured_by} is for rooms of {low:g} to {high:g} m^3; this one has {plan.room.volume:.4g} m^3",
            {"volume_m3": plan.room.volume, "least_m3": low, "most_m3": high},
        )
    ]


def _likeness(a: Floats, b: Floats, weights: Floats) -> Floats:
    """|cosine| of the angles between shapes a [p, n] and b [p, m] on a surface with weights [p]: [n, m]."""
    sizes = [np.sqrt(weights @ shapes**2) for shapes in (a, b)]
    products = np.abs(a.T @ (weights[:, None] * b))
    return np.divide(products, np.outer(*sizes), out=np.zeros_like(products), where=np.outer(*sizes) > 0)
