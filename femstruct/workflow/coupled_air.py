"""Air of rooms coupled to structures of a study, and transfers of rooms kept over cases and runs."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from typing import Final

import numpy as np

from acoustics.fields.returned import KeptTransfer
from acoustics.fields.sound_field import SoundField
from acoustics.receivers import Receiver
from acoustics.room_response import RoomResponse
from acoustics.source import combine_surfaces
from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.impact.response import Response
from femstruct.modal.basis import ModalBasis
from femstruct.model.probe import Probe
from femstruct.sound.coupling import with_cavity
from femstruct.sound.surfaces import Motion
from femstruct.study.asked import RoomPlan
from femstruct.study.placed_rooms import placed_room
from femstruct.workflow.bases import Places

# ----------------------------------------------------------------------------------------------------------------------
# Two-way coupling: bases of structures joined to the air of rooms of a study.
# ----------------------------------------------------------------------------------------------------------------------

CARRIED_BY_AIR: Final = 0.05  # share of a weight at rest that sealed air may carry
_HELD: Final = 1e-9  # share of a probe's motion in rigid modes that is rounding


def couple_rooms(
    basis: ModalBasis, rooms: Sequence[RoomPlan], places: Places
) -> tuple[ModalBasis, list[tuple[str, Finding]]]:
    """The basis with the air of all rooms whose coupling is two-way, and what is to be known of it, by room.

    Parameters
    ----------
    basis : ModalBasis
        In vacuo, damped; rooms are joined to it one after the other.
    """
    findings: list[tuple[str, Finding]] = []
    for plan in rooms:
        if plan.coupling == "two-way":
            known = len(basis.findings)
            basis = with_cavity(basis, placed_room(plan, places.surfaces), leak=plan.leak)
            findings += [(plan.name, found) for found in basis.findings[known:]]
    return basis, findings


def weight_on_air(response: Response, vacuo: ModalBasis, rooms: Sequence[RoomPlan]) -> list[tuple[str, Finding]]:
    """What came to rest on a structure whose weight sealed air helps to carry, by room.

    Only bodies that fall put a static load on a simulation: its structure is at rest under its own weight at t = 0,
    where the air has no pressure of its own.

    Parameters
    ----------
    response : Response
        Of the basis with the air.
    vacuo : ModalBasis
        The basis without it.
    """
    scene = response.scene
    falling = {body.name: body.mass * scene.gravity for body in scene.bodies if body.falls and scene.gravity}
    found = []
    for contact in scene.contacts:
        ends = (contact.upper, contact.lower)
        body = next((end for end in ends if isinstance(end, str) and end in falling), None)
        place = next((end for end in ends if isinstance(end, Probe)), None)
        if body is None or place is None or contact.preload or not response.contacts[contact.name].force[-1] > 0.0:
            continue
        weight, stiffness, alone = falling[body], *(static_stiffness(one, place) for one in (response.basis, vacuo))
        share = 1.0 - alone / stiffness
        if not share > CARRIED_BY_AIR:
            continue
        sinks = f"{1e6 * weight / alone:.4g} um" if alone else "no limit"
        finding = Finding(
            "sealed-air-carries-load",
            f"{body} ends at rest on {contact.name} with a static stiffness of {stiffness:.4g} N/m, of which the "
            "structure "
            f"has {alone:.4g} N/m: the sealed air carries {100 * share:.0f} % of the weight. A real room leaks, and "
            "the "
            f"deflection increases from {1e6 * weight / stiffness:.4g} um to {sinks}. Use only the motion, not the "
            "position at rest, or give the room a leak",
            {"with_air_n_m": stiffness, "without_air_n_m": alone, "share": share, "allowed": CARRIED_BY_AIR},
        )
        found += [(plan.name, finding) for plan in rooms if plan.coupling == "two-way"]
    return found


def static_stiffness(basis: ModalBasis, place: Probe) -> float:
    """Force over displacement at rest at a place of the structure [N/m]; 0 where nothing holds it."""
    row: Floats = place.of(basis.shapes)
    free = basis.omega == 0.0
    if np.abs(row[free]).max(initial=0.0) > _HELD * np.abs(row).max(initial=0.0):
        return 0.0
    return 1.0 / float(((row[~free] / basis.omega[~free]) ** 2).sum())


def coupled_key(key: str, rooms: Sequence[RoomPlan]) -> str:
    """The name of a basis joined to rooms: that of the structure alone where none is two-way."""
    joined = [
        (plan.name, plan.under, plan.offset, plan.room.identity, plan.room.air.c, plan.room.air.rho)
        + tuple(sorted(plan.moved[1:]))
        + ((plan.on,) if plan.on else ())
        + (() if plan.leak is None else (plan.leak.inertance,))
        for plan in rooms
        if plan.coupling == "two-way"
    ]
    return hashlib.sha256(repr((key, joined)).encode()).hexdigest()[:12] if joined else key


# ----------------------------------------------------------------------------------------------------------------------
# What rooms cost, paid once: their transfers, kept by the value of what they are of, over cases and over runs.
# ----------------------------------------------------------------------------------------------------------------------

MOST: Final = 8  # rooms kept, the latest


class RoomTransfers:
    """Transfers of rooms, held by who runs cases: a run, or a caller who runs a study again and again.

    The first motion of a room's surfaces finds what it takes; with the second, or with `prepare`, the transfer is made,
    and that and every further one cost little more than their Fourier transforms. A kind of room that keeps nothing is
    asked anew.

    Notes
    -----
    Rooms, surfaces (points, shapes of the modes), receivers and records are compared by value; where anything differs,
    or a motion needs another search, it is made anew.
    """

    def __init__(self) -> None:
        self._kept: list[KeptTransfer] = []

    def pressures(
        self, moving: Sequence[Motion], room: SoundField, receivers: Sequence[Receiver], up_to_hz: float
    ) -> list[RoomResponse]:
        """Pressures as `SoundField.pressures` has them."""
        whole = [combine_surfaces(motion) for motion in moving]
        for kept in self._kept:
            if kept.of(whole[0], room, receivers, up_to_hz):
                found = kept.pressures(whole)
                if found is not None:
                    return found
                self._kept.remove(kept)
                break
        found, new = room.pressures_to_keep(moving, receivers, up_to_hz)
        if new is not None:
            self._kept = [*self._kept[1 - MOST :], new]
        return found

    def prepare(self) -> None:
        """Make the transfers of all rooms that were heard, for motions to come."""
        for kept in self._kept:
            kept.prepare()
