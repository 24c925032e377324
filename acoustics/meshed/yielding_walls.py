"""Walls that yield as coordinates: oscillators that pressure drives and that take volume from the room."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from acoustics.arrays import Floats, freeze, frozen
from acoustics.meshed.finite_elements import CavityModes, wall_traces
from acoustics.meshed.walls import AnyWall, YieldingWall


@dataclass(frozen=True, eq=False)
class WallMotion:
    """The displacement of the walls that yield, in shapes w_j: one oscillator each.

    loads : integrals of a unit source at each node times w_j over their walls [dofs, r], as of
    `acoustics.meshed.finite_elements.drive`.
    mass, stiffness, resistance : of each [r] [kg/m^2], [N/m^3], [Pa s/m]; the shapes are orthonormal over their wall.
    """

    loads: Floats
    mass: Floats
    stiffness: Floats
    resistance: Floats

    def __post_init__(self) -> None:
        loads = frozen("motion.loads", self.loads, (None, None))
        ones = {name: frozen(f"motion.{name}", getattr(self, name), (loads.shape[1],)) for name in _OSCILLATOR}
        freeze(self, loads=loads, **ones)


_OSCILLATOR = ("mass", "stiffness", "resistance")


def wall_motion(modes: CavityModes, walls: Mapping[str, AnyWall]) -> WallMotion:
    """The displacement of all walls that yield, in the traces that the modes have on them.

    A locally reacting wall moves as the pressure on it: the traces of the modes are all that it needs.
    """
    yielding = {name: wall for name, wall in walls.items() if isinstance(wall, YieldingWall)}
    traces = [wall_traces(modes, name) for name in yielding]
    many = [trace.shape[1] for trace in traces]
    each = {
        name: np.repeat([getattr(wall, name) for wall in yielding.values()], many).astype(np.float64)
        for name in _OSCILLATOR
    }
    return WallMotion(np.hstack([np.zeros((len(modes.shapes), 0)), *traces]), **each)
