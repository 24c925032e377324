"""The room of any shape: its cells, its losses, what its walls absorb, and its modes."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import inf
from types import MappingProxyType
from typing import ClassVar, Final, Literal

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Complexes, Floats, freeze, positive
from acoustics.errors import AcousticsError, Advice
from acoustics.fields.receiver_grids import RoomGrid, halved_grid
from acoustics.fields.returned import ModesOnSurface
from acoustics.fields.sound_field import SoundField, described_modes, faces_out
from acoustics.losses import Losses
from acoustics.meshed.cavity_mesh import CavityMesh
from acoustics.meshed.finite_elements import (
    CELLS_PER_WAVE,
    OFF_WALL,
    CavityModes,
    boundary_distances,
    cavity_modes,
    probe,
)
from acoustics.meshed.meshed_coupling import coupled_cavity
from acoustics.meshed.meshed_pressure import (
    Decays,
    cavity_loads,
    cavity_powers,
    cavity_pressures,
    decays,
    harmonic_cavity_pressure,
    measured_t60,
)
from acoustics.meshed.walls import AnyWall, YieldingWall, two_way_absorption, wall_absorption
from acoustics.receivers import Receiver, positions
from acoustics.room_response import RoomResponse
from acoustics.rooms.box_coupling import CoupledAir
from acoustics.rooms.box_harmonic import PressureMap, map_within
from acoustics.source import SurfaceShapes, SurfaceVelocity, SurfaceVibration, combine_surfaces, side_by_side
from acoustics.tags import stored_as

MOST: Final = 300  # modes of a room that nobody limits, about
FLAT: Final = 1e-6  # of the room's size: heights of a ceiling's corners differ by less
INTO: Final = 1e-2  # of the way to the middle of a surface, and of its size into the air: where air must be


@stored_as("room of any shape/1")
@dataclass(frozen=True, eq=False)
class ShapedRoom(SoundField):
    """A closed room of any shape with rigid walls, some of which may absorb sound or be compliant; a named, level wall
    moves.

    mesh : its cells and named walls; receivers are measured in the mesh's own coordinates [m], z up.
    ceiling : name of the wall that moves, or part of which does, and that the room is placed by; surfaces may move
        any other named wall too.
    walls : absorption or compliance of the named walls; the others are rigid.
    up_to_hz : modes up to it are its own, the others answer as at rest; None: as far as the cells carry six to a
        wave, and about 300 modes at most.

    Raises AcousticsError: no such wall, a ceiling that is not level, or that yields beside moving.

    >>> from acoustics.meshed.cavity_mesh import box_mesh
    >>> room = ShapedRoom(box_mesh([0.58, 0.47, 0.1], [6, 5, 1]), "z1", Air(340, 1.29))
    >>> round(room.volume, 5), room.middle.round(3).tolist(), room.up_to_hz
    (0.02726, [0.29, 0.235, 0.1], 566.7)
    """

    mesh: CavityMesh
    ceiling: str
    air: Air = field(default_factory=Air)
    losses: Losses = field(default_factory=Losses)
    walls: Mapping[str, AnyWall] = field(default_factory=dict)
    up_to_hz: float | None = None

    word: ClassVar[str] = "a meshed room"
    pushes_back: ClassVar[bool] = True
    bounded: ClassVar[bool] = True

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
        up_to = self.carried_hz if self.up_to_hz is None else positive("up_to_hz", self.up_to_hz, "Hz")
        freeze(self, walls=MappingProxyType(dict(self.walls)), up_to_hz=up_to)

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
        return cavity_modes(self.mesh, 2 * np.pi * self.complete_up_to_hz / self.air.c)

    @property
    def complete_up_to_hz(self) -> float:
        """Where its modes end [Hz]."""
        return self.up_to_hz or self.carried_hz

    @property
    def frequency_hz(self) -> Floats:
        """Frequencies of its modes with rigid walls [n] [Hz], the uniform one at 0 first."""
        return self.modes.wavenumber * self.air.c / (2 * np.pi)

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return self.mesh.volume

    @property
    def middle(self) -> Floats:
        """Middle of the rectangle around the ceiling [3] [m]."""
        corners = self.mesh.points[self.mesh.walls[self.ceiling].ravel()]
        middle: Floats = (corners.min(axis=0) + corners.max(axis=0)) / 2
        return middle

    def wall_area(self, wall: str) -> float:
        return self.mesh.wall_area(wall)

    @property
    def extent(self) -> Floats:
        """Lower and upper corner of the box around the room [2, 3] [m]."""
        return np.stack([self.mesh.points.min(axis=0), self.mesh.points.max(axis=0)])

    @property
    def loses(self) -> bool:
        return super().loses or bool(self.walls)

    @cached_property
    def decays(self) -> Decays:
        """How its modes die away, up to `up_to_hz`."""
        return decays(self.modes, self.air, self.losses, self.walls)

    def t60(self, frequency_hz: float, fraction: Literal[1, 3] = 3) -> float:
        """With walls, of its modes as they are damped; beyond them, of the last of them."""
        if not self.walls:
            return super().t60(frequency_hz, fraction)
        return measured_t60(self.decays, frequency_hz, fraction)

    @property
    def identity(self) -> object:
        """Its cells, its ceiling, how far its modes go, and the walls that yield."""
        cells = hashlib.sha256(self.mesh.points.tobytes() + self.mesh.cells.tobytes()).hexdigest()
        yielding = {name: wall for name, wall in self.walls.items() if isinstance(wall, YieldingWall)}
        springs = [(name, wall.mass, wall.stiffness) for name, wall in sorted(yielding.items())]
        return cells, self.ceiling, self.up_to_hz, springs

    def described(self) -> dict[str, object]:
        return {
            "size_m": np.ptp(self.extent, axis=0).tolist(),
            "largest_cell_m": self.mesh.largest_cell,
            "own_modes_up_to_hz": self.up_to_hz,
            **({"walls": {name: str(wall) for name, wall in self.walls.items()}} if self.walls else {}),
            **described_modes(
                self.losses,
                self.frequency_hz[1:],
                0.5 * self.air.c * np.diag(wall_absorption(self.modes, self.walls, self.air))[1:],
            ),
        }

    @property
    def movable(self) -> tuple[str, ...]:
        """The ceiling and all other walls of the mesh that do not yield by themselves."""
        others = [name for name in self.mesh.walls if not isinstance(self.walls.get(name), YieldingWall)]
        return tuple(dict.fromkeys([self.ceiling, *others]))

    def accept(self, wall: str, points: Floats, normals: Floats) -> None:
        """Refuse a surface that is not within its wall, or faces out of the room."""
        self.on_wall(wall)
        off, reach = boundary_distances(self.mesh, points, wall)
        if off.max() > OFF_WALL * reach:
            raise AcousticsError(
                "surface.points",
                got=f"a surface that reaches beyond the wall '{wall}' of the room, at "
                f"{points[off.argmax()].round(6).tolist()} m",
                expected="a surface within it",
            )
        inward = points + INTO * (points.mean(axis=0) - points)
        size = np.ptp(points, axis=0).max() or reach
        if not self.mesh.contains(inward + INTO * size * normals).all():
            raise faces_out(wall)

    def places(self, receivers: Sequence[Receiver]) -> Floats:
        where = positions(receivers)
        probe(self.mesh, where)
        return where

    def pressures(
        self, motions: Sequence[Sequence[SurfaceVelocity]], receivers: Sequence[Receiver], up_to_hz: float = inf
    ) -> list[RoomResponse]:
        """By its modes: see `acoustics.meshed.meshed_pressure.cavity_pressure`."""
        moving = [combine_surfaces(motion) for motion in motions]
        return cavity_pressures(moving, self.modes, self.air, self.losses, receivers, self.walls)

    def harmonic(
        self, surfaces: Sequence[SurfaceVibration], receivers: Sequence[Receiver]
    ) -> tuple[Complexes, tuple[Advice, ...]]:
        """By its modes: see `acoustics.meshed.meshed_pressure.harmonic_cavity_pressure`."""
        moving = combine_surfaces(surfaces)
        return harmonic_cavity_pressure(moving, self.modes, self.air, self.losses, receivers, self.walls)

    def loads(
        self, surfaces: Sequence[SurfaceShapes], source: Receiver, frequency_hz: Floats
    ) -> tuple[Complexes, tuple[Advice, ...]]:
        """By its modes: see `acoustics.meshed.meshed_pressure.cavity_loads`."""
        moving = side_by_side(surfaces)
        return cavity_loads(moving, self.modes, self.air, self.losses, source, frequency_hz, self.walls)

    def powers(self, surfaces: Sequence[SurfaceVibration]) -> Floats:
        """By its modes: see `acoustics.meshed.meshed_pressure.cavity_powers`."""
        return cavity_powers(surfaces, self.modes, self.air, self.losses, self.walls)

    def coupled_air(self, surfaces: Sequence[SurfaceShapes], up_to_hz: float) -> CoupledAir:
        """By its modes: see `acoustics.meshed.meshed_coupling.coupled_cavity`."""
        return coupled_cavity(side_by_side(surfaces), self.modes, self.air, self.losses, up_to_hz, self.walls)

    def coupling_advice(self, first_hz: float) -> tuple[Advice, ...]:
        return two_way_absorption(self.modes, self.walls, self.air, first_hz)

    def modes_on(self, surfaces: Sequence[SurfaceShapes], up_to_hz: float) -> ModesOnSurface:
        moving = side_by_side(surfaces)
        hz = self.frequency_hz
        chosen = np.flatnonzero((hz <= up_to_hz) & (np.arange(len(hz)) > 0))
        sounds = self.modes.at(moving.points)[:, chosen]
        products = moving.shapes.T @ (moving.weights[:, None] * sounds)
        return ModesOnSurface(
            hz[chosen], products, np.sqrt(moving.weights @ sounds**2), np.full(len(chosen), self.volume)
        )

    @property
    def outline(self) -> Floats:
        """The edges of its mesh where its boundary bends [m, 2, 3] [m]."""
        return self.mesh.edges

    def grid(self) -> RoomGrid:
        return halved_grid(self.mesh)

    def mode_shapes(self, points: Floats, count: int) -> tuple[Floats, Floats]:
        """As many as there are up to `up_to_hz`."""
        own = slice(1, 1 + count)
        return self.frequency_hz[own], self.modes.at(points)[:, own]

    def pressure_map(
        self,
        surfaces: Sequence[SurfaceVelocity],
        frequencies_hz: Sequence[float] | Floats,
        *,
        normal: str = "z",
        at: float,
        divisions: tuple[int, int] = (48, 40),
    ) -> PressureMap:

        def spectrum(frequency_hz: Floats, points: Floats) -> Complexes:
            return self.spectrum(surfaces, frequency_hz, points).T

        return map_within(
            spectrum, self.mesh.contains, self.extent, frequencies_hz, normal=normal, at=at, divisions=divisions
        )
