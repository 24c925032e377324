"""The air of a room of any shape as a mechanical system joined to its moving ceiling: two-way coupling."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Floats, positive
from acoustics.errors import AcousticsError
from acoustics.losses import Losses
from acoustics.meshed.finite_elements import CavityModes, drive, left_out
from acoustics.meshed.walls import AnyWall, WallMotion, YieldingWall, wall_absorption, wall_motion
from acoustics.rooms.box_coupling import MOST, CoupledAir, join_air
from acoustics.source import SurfaceShapes

HELD: Final = "a stiffness above 0, as two-way coupling needs"


def coupled_cavity(
    surface: SurfaceShapes,
    modes: CavityModes,
    air: Air,
    losses: Losses,
    up_to_hz: float,
    walls: Mapping[str, AnyWall] | None = None,
) -> CoupledAir:
    """The air of a closed room of any shape joined to the shapes of what moves of its boundary.

    Parameters
    ----------
    modes : CavityModes
        As of `acoustics.meshed.meshed_pressure.cavity_pressure`.
    up_to_hz : float
        Modes of the room up to it are kept [Hz], at most those the room has and the 300 lowest; the others act as added
        mass.
    walls : Mapping[str, AnyWall] | None
        As of `acoustics.meshed.meshed_pressure.cavity_pressure`.

    Notes
    -----
    As `acoustics.rooms.box_coupling.coupled_air`, with finite elements: the mass of the modes that were not even found
    is that of their answer at rest to the shapes.

    What walls absorb damps each mode by itself. Walls that yield move as the ceiling does, with coordinates of their
    own; what gives way of them is in the traces of the modes kept. A wall without mass has that of the air next to it:
    of the modes left out.

    Raises AcousticsError: a wall that yields without a stiffness, which nothing holds in place.

    Examples
    --------
    The piston of `coupled_air` over its box, whose next mode along z is at 1700 Hz:

    >>> from acoustics.meshed.cavity_mesh import box_mesh
    >>> from acoustics.meshed.finite_elements import cavity_modes
    >>> modes, area = cavity_modes(box_mesh([0.58, 0.47, 0.1], [4, 4, 4]), up_to=10.0), 0.58 * 0.47
    >>> piston = SurfaceShapes([[0.29, 0.235, 0.1]], [area], [[29.68**-0.5]])
    >>> air = coupled_cavity(piston, modes, Air(340, 1.29), Losses(), 200.0)
    >>> round(float(air.compression[0, 0] ** 2 / (1.29 * 340**2 * area / 0.1 / 29.68)), 6), len(air.frequency_hz)
    (1.0, 0)
    """
    walls, known = walls or {}, modes.wavenumber * air.c / (2 * np.pi)
    loads = drive(modes, surface)
    complete = min(positive("up_to_hz", up_to_hz, "Hz"), modes.complete_below * air.c / (2 * np.pi))
    kept = known <= complete
    if kept.sum() > 1 + MOST:
        complete = float(known[1 + MOST])
        kept = known < complete * (1 - 1e-9)  # modes of one frequency are kept or left out together
    low = modes.shapes[:, kept]
    motion = wall_motion(replace(modes, wavenumber=modes.wavenumber[kept], shapes=low), walls)
    for name, wall in walls.items():
        if isinstance(wall, YieldingWall) and wall.stiffness == 0:
            raise AcousticsError(f"walls.{name}", got="a compliant wall without stiffness", expected=HELD)
    loads = np.hstack([loads, motion.loads])
    displaced = modes.shapes.T @ loads
    volume = modes.mesh.volume
    slow = displaced[~kept] / modes.wavenumber[~kept, None]
    added = air.rho * (loads.T @ left_out(modes, loads) + slow.T @ slow / volume)
    at = slice(surface.shapes.shape[1], loads.shape[1])
    scale = np.ones(loads.shape[1])
    scale[at] = 1 / np.sqrt(motion.mass + np.diag(added)[at])  # coordinates of unit mass, their own and the air's
    displaced, added = displaced * scale, scale[:, None] * added * scale
    coupled = join_air(
        air,
        losses,
        volume,
        known[kept][1:],
        displaced[kept],
        0.5 * (added + added.T),
        complete_below_hz=complete,
        absorbed=air.c * np.diag(wall_absorption(modes, walls, air))[kept][1:] if walls else None,
    )
    return _with_walls(coupled, motion, at, scale[at])


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
        resisted=bool(motion.resistance.any()),
    )
