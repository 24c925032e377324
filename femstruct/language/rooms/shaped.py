"""Rooms of any shape as they are written, and boxes with walls, which are cut into cells."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from pydantic import Field

from acoustics.errors import AcousticsError
from acoustics.fields.shaped import ShapedRoom
from acoustics.meshed.cavity_mesh import CavityMesh
from acoustics.meshed.cut_box import cut_box
from acoustics.meshed.finite_elements import probe
from acoustics.meshed.meshed_two_way import HELD
from acoustics.receivers import Receiver
from femstruct.files.inputs.cavity_meshes import read_mesh
from femstruct.files.inputs.opening import beside
from femstruct.language.rooms.closed import ClosedSpec
from femstruct.language.rooms.losses import WallSpec
from femstruct.language.rooms.room import Asked
from femstruct.language.yaml import Frequency, Here, Spec, Text, nearest, refuse


class RoomModesSpec(Spec):
    """Up to which frequency the modes of a meshed room are computed."""

    up_to: Frequency


class MeshedRoomSpec(ClosedSpec):
    """A room of any shape under a surface by its mesh, or a rectangular one with walls, and its receivers.

    mesh: a file of tetrahedra or hexahedra [m] with named surfaces, its own coordinates, z up.
    ceiling: the surface of the mesh that moves, or part of which does.
    walls: absorption or compliance of surfaces of the mesh; the others are rigid. Walls of a room with a size are
    x0, x1, y0, y1, floor and ceiling; it is then meshed with six cells a wavelength at `modes: {up_to: }`.
    modes: of a meshed room; by default up to the frequency that its mesh allows.
    at: centre of the surface in the ceiling, from the room's corner or in the mesh; by default the middle.
    surfaces: further surfaces of the structure, by the wall of the room that they move.
    coupling, animate, levels: as of a rectangular room.
    """

    signs = ("mesh", "ceiling", "walls", "modes")

    mesh: Text | None = Field(default=None, description="a file of tetrahedra or hexahedra [m]")
    ceiling: Text | None = None
    walls: dict[str, WallSpec] = Field(default_factory=dict)
    modes: RoomModesSpec | None = None

    @classmethod
    def refuse_keys(cls, given: Mapping[str, Any]) -> None:
        super().refuse_keys(given)
        got, wanted, do = "modes", "walls", "remove 'modes'"
        if "walls" in given:
            got, wanted, do = "walls", "modes", "write 'modes: {up_to: 200 Hz}', up to which walls are included"
        if "size" in given and ("walls" in given) != ("modes" in given):
            raise refuse(f"'{got}' of a room with a size", f"'{wanted}' beside '{got}'", do)

    @property
    def takes_up_sound(self) -> bool:
        return super().takes_up_sound or any(wall.absorbs for wall in self.walls.values())

    def check_in(self, here: Here, name: str, asked: Asked) -> None:
        here.at("form").need(self.form == "causal", "the source's form in a meshed room", "causal", "leave out 'form'")
        super().check_in(here, name, asked)

    def room(
        self, here: Here, receivers: list[Receiver], sources: dict[str, str], shaped: dict[str, ShapedRoom]
    ) -> ShapedRoom | None:
        """The room that another case has where all that is said of it is the same, else a new one."""
        shape = self.model_dump(include={"size", "mesh", "ceiling", "walls", "modes", "air", "losses"})
        said = repr((here.tree.file, shape))
        room = shaped[said] if said in shaped else self._new(here, sources)
        if room is None or not (self._all_inside(here, room, receivers) and self._held(here)):
            return None
        shaped[said] = room
        return room

    def _new(self, here: Here, sources: dict[str, str]) -> ShapedRoom | None:
        mesh, ceiling, air = self._cells(here, sources), self.ceiling or "ceiling", self.air.noun()
        if mesh is None:
            return None
        named = [(ceiling, here.at("ceiling")), *((wall, here.at("walls", wall)) for wall in self.walls)]
        for wall, there in named:
            if wall not in mesh.walls:
                known = ", ".join(mesh.walls) or "a mesh with named surfaces"
                missing = f"no surface of '{self.mesh}'" if self.mesh else "no wall of a room with a size"
                there.wrong(f"'{wall}', {missing}", known, nearest(wall, list(mesh.walls)))
                return None
        walls = {wall: one.wall(air) for wall, one in self.walls.items()}
        up_to = self.modes.up_to if self.modes is not None else None
        at_fault = here.at("walls" if self.ceiling is None else "ceiling")
        return at_fault.make(lambda: ShapedRoom(mesh, ceiling, air, self.losses_of(), walls, up_to))

    def _cells(self, here: Here, sources: dict[str, str]) -> CavityMesh | None:
        """The mesh of its file, or a box cut into cells; None with mistakes noted."""
        if self.size is not None:
            size, most, air = np.array(self.size), self.modes.up_to if self.modes is not None else 0.0, self.air.noun()
            return here.at("modes", "up_to").make(lambda: cut_box(size, most, air))
        return here.at("mesh").make(lambda: read_mesh(beside(here.tree.file, self.mesh or ""), sources))

    def _held(self, here: Here) -> bool:
        """Whether compliant walls have a stiffness where coupling is two-way; notes those without."""
        loose = [wall for wall, one in self.walls.items() if one.mass is not None and one.stiffness == 0.0]
        for wall in loose if self.coupling == "two-way" else ():
            here.at("walls", wall).wrong("a mass without a stiffness", HELD)
        return not loose or self.coupling == "one-way"

    def _all_inside(self, here: Here, room: ShapedRoom, receivers: list[Receiver]) -> bool:
        """Whether all receivers are in the mesh; notes those that are not."""
        sound = True
        for receiver in receivers:
            try:
                probe(room.mesh, receiver.position[None, :])
            except AcousticsError as error:
                here.at(
                    "receivers",
                    receiver.name if receiver.name in self.receivers else receiver.name.rpartition(".")[0],
                ).wrong(f"{receiver.position.tolist()} m, a point outside the mesh", error.expected)
                sound = False
        return sound
