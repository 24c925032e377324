"""Findings of two-way coupling: its effect, and where it is a rough approximation."""

from __future__ import annotations

import numpy as np

from acoustics.rooms.box_two_way import CoupledAir
from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.modal.basis import ModalBasis


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
    basis: ModalBasis, joined: ModalBasis, own: Floats, air: CoupledAir, between: tuple[float, bool], name: str
) -> Finding:
    """What the coupling did: the mode that the air stiffens most, before and after.

    between : what damping between modes makes of the motion, and whether it is kept.
    """
    stray, kept = between
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
        f"between its modes causes {stray:.1e} of the motion of the structure and is "
        f"{'included' if kept else 'left out'}",
        {
            "in_vacuo_hz": before,
            "coupled_hz": after,
            "in_vacuo_mode": stiffened + 1.0,
            "coupled_mode": partner + 1.0,
            "cavity_modes": float(n),
            "cavity_modes_up_to_hz": air.complete_below_hz,
            "damping_between_modes": stray,
        },
    )
