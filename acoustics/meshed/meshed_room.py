"""The room of any shape: its cells, its losses, what its walls take up, and its modes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Final

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Floats, freeze, positive
from acoustics.errors import AcousticsError
from acoustics.meshed.cavity_mesh import CavityMesh, box_mesh
from acoustics.meshed.finite_elements import CELLS_PER_WAVE, CavityModes, cavity_modes
from acoustics.meshed.walls import AnyWall, YieldingWall
from acoustics.rooms.box import Losses

MOST: Final = 300  # modes of a room that nobody limits, about
MOST_CELLS: Final = 5000  # of a box that is cut for somebody: its modes take a minute then
FLAT: Final = 1e-6  # of the room's size: heights of a ceiling's corners differ by less


def cut_box(size: Floats, up_to_hz: float, air: Air) -> CavityMesh:
    """A box [0, size] cut into cells, six to a wave at a frequency; its walls are x0, x1, y0, y1, floor and ceiling.

    Raises AcousticsError: more than 5000 cells.

    >>> cut_box(np.array([4.0, 3.0, 2.5]), 100.0, Air()).cells.shape
    (210, 8)
    """
    cells = [int(n) for n in np.ceil(size * CELLS_PER_WAVE * positive("up_to_hz", up_to_hz, "Hz") / air.c - 1e-9)]
    if np.prod(cells) > MOST_CELLS:
        share = (MOST_CELLS / np.prod(cells)) ** (1 / 3)
        raise AcousticsError(
            "up_to_hz",
            got=f"{up_to_hz:g} Hz, for which the room is cut into {np.prod(cells)} cells",
            expected=f"about {0.95 * share * up_to_hz:.0f} Hz or less, for {MOST_CELLS} cells at most",
        )
    mesh = box_mesh([float(side) for side in size], cells)
    names = {"z0": "floor", "z1": "ceiling"}
    return CavityMesh(mesh.points, mesh.cells, {names.get(wall, wall): at for wall, at in mesh.walls.items()})


@dataclass(frozen=True, eq=False)
class ShapedRoom:
    """A closed room of any shape with rigid walls, some of which may take up sound or yield; a named, level wall
    moves.

    mesh : its cells and named walls; receivers are measured in the mesh's own coordinates [m], z up.
    ceiling : name of the wall that moves, or part of which does.
    walls : what the named walls take up, or how they yield; the others are rigid.
    up_to_hz : modes up to it are its own, the others answer as at rest; None: as far as the cells carry six to a
        wave, and some 300 modes at most.

    Raises AcousticsError: no such wall, a ceiling that is not level, or that yields beside moving.

    >>> from acoustics.meshed.cavity_mesh import box_mesh
    >>> room = ShapedRoom(box_mesh([0.58, 0.47, 0.1], [6, 5, 1]), "z1", Air(340, 1.29))
    >>> round(room.volume, 5), room.centre.round(3).tolist(), room.up_to_hz
    (0.02726, [0.29, 0.235, 0.1], 566.7)
    """

    mesh: CavityMesh
    ceiling: str
    air: Air = field(default_factory=Air)
    losses: Losses = field(default_factory=Losses)
    walls: Mapping[str, AnyWall] = field(default_factory=dict)
    up_to_hz: float | None = None

    def __post_init__(self) -> None:
        for wall in (self.ceiling, *self.walls):
            self.mesh.facets(wall)
        heights = self.mesh.points[self.mesh.walls[self.ceiling].ravel(), 2]
        if np.ptp(heights) > FLAT * np.ptp(self.mesh.points, axis=0).max():
            raise AcousticsError(
                "ceiling",
                got=f"'{self.ceiling}', {heights.min():g} to {heights.max():g} m high",
                expected="a horizontal wall",
            )
        if isinstance(self.walls.get(self.ceiling), YieldingWall):
            raise AcousticsError(
                f"walls.{self.ceiling}",
                got="a compliant wall that is the ceiling",
                expected="another wall",
                do="remove it: the ceiling moves with its structure",
            )
        asked = self.carried_hz if self.up_to_hz is None else positive("up_to_hz", self.up_to_hz, "Hz")
        freeze(self, walls=MappingProxyType(dict(self.walls)), up_to_hz=asked)

    @property
    def carried_hz(self) -> float:
        """As far as the cells carry sound [Hz], six to a wave, rounded to 0.1; less where there are too many modes.

        Weyl's law: 4 pi V f^3 / (3 c^3) modes below f.
        """
        most = (3 * MOST / (4 * np.pi * self.volume)) ** (1 / 3) * self.air.c
        return round(min(self.air.c / (CELLS_PER_WAVE * self.mesh.largest_cell), float(most)), 1)

    @cached_property
    def modes(self) -> CavityModes:
        """Its modes with rigid walls up to `up_to_hz`."""
        return cavity_modes(self.mesh, 2 * np.pi * (self.up_to_hz or self.carried_hz) / self.air.c)

    @property
    def frequency_hz(self) -> Floats:
        """Frequencies of its modes with rigid walls [n] [Hz], the uniform one at 0 first."""
        return self.modes.wavenumber * self.air.c / (2 * np.pi)

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return self.mesh.volume

    @property
    def centre(self) -> Floats:
        """Middle of the rectangle around the ceiling [3] [m]."""
        corners = self.mesh.points[self.mesh.walls[self.ceiling].ravel()]
        middle: Floats = (corners.min(axis=0) + corners.max(axis=0)) / 2
        return middle

    @property
    def extent(self) -> Floats:
        """Lower and upper corner of the box around the room [2, 3] [m]."""
        return np.stack([self.mesh.points.min(axis=0), self.mesh.points.max(axis=0)])
