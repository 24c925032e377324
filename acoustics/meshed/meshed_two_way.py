"""The air of a room of any shape as a mechanical system joined to its moving ceiling: two-way coupling."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from acoustics.arrays import Floats, positive
from acoustics.errors import AcousticsError
from acoustics.meshed.absorbing_walls import absorbed
from acoustics.meshed.finite_elements import drive, left_out
from acoustics.meshed.meshed_room import ShapedRoom
from acoustics.meshed.walls import YieldingWall
from acoustics.meshed.yielding_walls import WallMotion, wall_motion
from acoustics.rooms.box_two_way import MOST, CoupledAir, joined

HELD: Final = "a stiffness above 0, as two-way coupling needs"


def coupled_cavity(room: ShapedRoom, points: Floats, weights: Floats, shapes: Floats, up_to_hz: float) -> CoupledAir:
    """The air of a closed room of any shape joined to the shapes of its ceiling.

    points [p, 3], weights [p], shapes [p, k] : as of a `SurfaceVelocity`: on the ceiling, into the room [m], [m^2].
    up_to_hz : modes of the room up to it are kept [Hz], at most those the room has and the 300 lowest; the others act
        as added mass.

    Notes
    -----
    As `acoustics.rooms.box_two_way.coupled_air`, with finite elements: the mass of the modes that were not even found
    is that of their answer at rest to the shapes.

    What walls take up damps each mode by itself. Walls that yield move as the ceiling does, with coordinates of their
    own; what gives way of them is in the traces of the modes kept. A wall without mass has that of the air next to it:
    of the modes left out.

    Raises AcousticsError: a wall that yields without a stiffness, which nothing holds in place.

    The piston of `coupled_air` over its box, whose next mode along z is at 1700 Hz:

    >>> from acoustics.air import Air
    >>> from acoustics.meshed.cavity_mesh import box_mesh
    >>> box = ShapedRoom(box_mesh([0.58, 0.47, 0.1], [4, 4, 4]), "z1", Air(340, 1.29))
    >>> area = 0.58 * 0.47
    >>> air = coupled_cavity(box, np.array([[0.29, 0.235, 0.1]]), np.array([area]), np.array([[29.68**-0.5]]), 200.0)
    >>> round(float(air.compression[0, 0] ** 2 / (1.29 * 340**2 * area / 0.1 / 29.68)), 6), len(air.frequency_hz)
    (1.0, 0)
    """
    modes, known = room.modes, room.frequency_hz
    loads = drive(modes, points, weights, shapes)
    complete = min(positive("up_to_hz", up_to_hz, "Hz"), modes.complete_below * room.air.c / (2 * np.pi))
    kept = known <= complete
    if kept.sum() > 1 + MOST:
        complete = float(known[1 + MOST])
        kept = known < complete * (1 - 1e-9)  # modes of one frequency are kept or left out together
    low = modes.shapes[:, kept]
    motion = wall_motion(replace(modes, wavenumber=modes.wavenumber[kept], shapes=low), room.walls)
    for name, wall in room.walls.items():
        if isinstance(wall, YieldingWall) and wall.stiffness == 0:
            raise AcousticsError(f"walls.{name}", got="a compliant wall without stiffness", expected=HELD)
    loads = np.hstack([loads, motion.loads])
    displaced = modes.shapes.T @ loads
    slow = displaced[~kept] / modes.wavenumber[~kept, None]
    added = room.air.rho * (loads.T @ left_out(modes, loads) + slow.T @ slow / room.volume)
    at = slice(shapes.shape[1], loads.shape[1])
    scale = np.ones(loads.shape[1])
    scale[at] = 1 / np.sqrt(motion.mass + np.diag(added)[at])  # coordinates of unit mass, their own and the air's
    displaced, added = displaced * scale, scale[:, None] * added * scale
    rates = room.air.c * np.diag(absorbed(modes, room.walls, room.air))[kept][1:] if room.walls else None
    air = joined(
        room, known[kept][1:], displaced[kept], 0.5 * (added + added.T), complete_below_hz=complete, absorbed=rates
    )
    return _with_walls(air, motion, at, scale[at])


def _with_walls(air: CoupledAir, motion: WallMotion, at: slice, scale: Floats) -> CoupledAir:
    """The air with the masses, springs and dashpots of the walls, whose coordinates are there, in units of scale."""
    springs = np.zeros((len(motion.mass), len(air.mass)))
    springs[:, at] = np.diag(np.sqrt(motion.stiffness) * scale)
    own, dashpots = np.zeros(len(air.mass)), np.zeros(len(air.mass))
    own[at] = motion.mass * scale**2
    dashpots[at] = motion.resistance * scale**2
    return replace(
        air,
        compression=np.vstack([air.compression, springs]),
        mass=air.mass + np.diag(own),
        viscous=air.viscous + np.diag(dashpots),
        walls=own,
    )
