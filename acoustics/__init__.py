"""The room and what is heard in it.

The way through this wing, each step a pure function or a frozen noun::

    Air, Losses -> Room, Receiver      what the room is                          air, room
    SurfaceVelocity                    how its ceiling moves: the one door in    source
    pressure(...) -> RoomResponse      what is heard, in time and frequency      pressure (transfer functions: cavity)
    sound_levels(...) -> Levels        peak, L_AFmax, third octaves              levels

Layers, lowest first: ``errors arrays | air room source | cavity extension | orders judgement pressure maps | levels``;
a module imports from lower ones only. Nothing here knows of finite elements, opens a file or prints.

Harmonic quantities are the real part of X exp(+j omega t). The surface's velocity is positive into the room, where it
raises the pressure. Coordinates are the room's own: from its lower corner, z up, the ceiling at z = Lz.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from acoustics.air import Air
from acoustics.errors import AcousticsError, Advice
from acoustics.maps import PressureMap, pressure_map
from acoustics.pressure import RoomResponse, pressure
from acoustics.room import (
    Losses,
    Receiver,
    Room,
    air_stiffness_ratio,
    losses_from_beta,
    losses_from_loss_factor,
    losses_from_t60,
    modal_damping_ratio,
    room_modes,
)
from acoustics.source import SurfaceVelocity

if TYPE_CHECKING:
    from acoustics.levels import Levels, level_spectrum, response_levels, sound_levels, third_octave_bands

# The filters need scipy.signal, slow to import: they are fetched when first asked for (PEP 562).
_FETCHED = ("Levels", "level_spectrum", "response_levels", "sound_levels", "third_octave_bands")

__all__ = [
    "AcousticsError",
    "Advice",
    "Air",
    "Levels",
    "Losses",
    "PressureMap",
    "Receiver",
    "Room",
    "RoomResponse",
    "SurfaceVelocity",
    "air_stiffness_ratio",
    "level_spectrum",
    "losses_from_beta",
    "losses_from_loss_factor",
    "losses_from_t60",
    "modal_damping_ratio",
    "pressure",
    "pressure_map",
    "response_levels",
    "room_modes",
    "sound_levels",
    "third_octave_bands",
]


def __getattr__(name: str) -> Any:
    if name in _FETCHED:
        return getattr(import_module("acoustics.levels"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
