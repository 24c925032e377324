"""From a checked study file to its rooms."""

from __future__ import annotations

import numpy as np

from acoustics.air import Air
from acoustics.errors import AcousticsError
from acoustics.fields.half_space import HalfSpace
from acoustics.fields.rectangular import Room
from acoustics.fields.shaped import ShapedRoom
from acoustics.losses import Losses, losses_from_beta, losses_from_loss_factor, losses_from_t60, losses_from_t60_bands
from acoustics.meshed.cut_box import cut_box
from acoustics.meshed.finite_elements import probe
from acoustics.meshed.meshed_two_way import HELD
from acoustics.meshed.walls import AnyWall, Wall, YieldingWall, absorbing
from acoustics.receivers import Receiver
from acoustics.rooms.box_two_way import Leak
from femstruct.language.schema_rooms import RoomSpec, WallSpec
from femstruct.language.yaml.build import Builder
from femstruct.language.yaml.meshes import read_mesh
from femstruct.language.yaml.opening import beside
from femstruct.language.yaml.reader import Steps, dotted, nearest
from femstruct.study.study import RoomPlan

SCALE_HZ = 1000.0  # a wall's one admittance is the same at all frequencies: this is as good as any


def room_of(
    name: str, spec: RoomSpec, builder: Builder, sources: dict[str, str], shaped: dict[str, ShapedRoom]
) -> RoomPlan | None:
    """A room with who listens in it; None with mistakes noted.

    sources : is given a digest of its mesh's file. shaped : see `study_of`.
    """
    receivers = []
    for receiver, places in spec.receivers.items():
        several = len(places) > 1
        receivers += [Receiver(f"{receiver}.{i}" if several else receiver, place) for i, place in enumerate(places, 1)]  # type: ignore[arg-type]
    room: Room | ShapedRoom | HalfSpace | None
    if spec.under is None:
        space = HalfSpace(Air(spec.air.c, spec.air.rho), np.array([0.0, 0.0, 1.0 if spec.above else -1.0]))
        return RoomPlan(name, space, spec.surface, tuple(receivers), directivity=spec.directivity)
    if spec.size is not None and spec.modes is None:
        room = Room(spec.size, Air(spec.air.c, spec.air.rho), _losses(spec))  # type: ignore[arg-type]
        middle = (spec.size[0] / 2.0, spec.size[1] / 2.0)
    else:
        room = _meshed(name, spec, builder, sources, shaped)
        if room is None or not (_all_inside(name, room, receivers, spec, builder) and _held(name, spec, builder)):
            return None
        middle = (float(room.middle[0]), float(room.middle[1]))
    offset = (spec.at[0] - middle[0], spec.at[1] - middle[1]) if spec.at is not None else (0.0, 0.0)
    asked = spec.losses.t60 if spec.losses is not None and isinstance(spec.losses.t60, dict) else {}
    return RoomPlan(
        name, room, spec.under, tuple(receivers), offset, spec.coupling, _leak(spec), asked, spec.levels, spec.animate
    )


def _meshed(
    name: str, spec: RoomSpec, builder: Builder, sources: dict[str, str], shaped: dict[str, ShapedRoom]
) -> ShapedRoom | None:
    """A room from a mesh file, or of a size with walls; the one that another case has where all that is said of it is
    the same."""
    said = repr((builder.tree.file, spec.size, spec.mesh, spec.ceiling, spec.walls, spec.modes, spec.air, spec.losses))
    if said in shaped:
        return shaped[said]
    air, up_to = Air(spec.air.c, spec.air.rho), spec.modes.up_to if spec.modes is not None else None
    if spec.size is not None:
        size, most = np.array(spec.size), up_to or 0.0
        mesh = builder.make(("rooms", name, "modes", "up_to"), lambda: cut_box(size, most, air))
    else:
        steps: Steps = ("rooms", name, "mesh")
        path = builder.make(steps, lambda: beside(builder.tree.file, spec.mesh or ""))
        if path is None:
            return None
        mesh = read_mesh(path, builder.tree.position(steps), dotted(steps), builder.mistakes, sources)
    if mesh is None:
        return None
    ceiling, cells = spec.ceiling or "ceiling", mesh
    for place, wall in ((("ceiling",), ceiling), *((("walls", wall), wall) for wall in spec.walls)):
        if wall not in cells.walls:
            here: Steps = ("rooms", name, *place)
            known = ", ".join(cells.walls) or "a mesh with named surfaces"
            at, do = builder.tree.position(here), nearest(wall, list(cells.walls))
            missing = f"no surface of '{spec.mesh}'" if spec.mesh else "no wall of a room with a size"
            builder.mistakes.add(at, dotted(here), got=f"'{wall}', {missing}", expected=known, do=do)
            return None
    walls = {wall: _wall(one, air) for wall, one in spec.walls.items()}
    at_fault = "walls" if spec.ceiling is None else "ceiling"
    room = builder.make(("rooms", name, at_fault), lambda: ShapedRoom(cells, ceiling, air, _losses(spec), walls, up_to))
    if room is not None:
        shaped[said] = room
    return room


def _wall(spec: WallSpec, air: Air) -> AnyWall:
    if spec.mass is not None or spec.stiffness > 0:
        return YieldingWall(spec.mass or 0.0, spec.stiffness, spec.resistance)
    if spec.absorption is None:
        return Wall({SCALE_HZ: air.rho * air.c / (spec.impedance or spec.resistance)})
    return absorbing(spec.absorption)


def _held(name: str, spec: RoomSpec, builder: Builder) -> bool:
    """Whether walls that yield are held in place where the air pushes back; notes those that are not."""
    loose = [wall for wall, one in spec.walls.items() if one.mass is not None and one.stiffness == 0.0]
    for wall in loose if spec.coupling == "two-way" else ():
        here: Steps = ("rooms", name, "walls", wall)
        builder.mistakes.add(builder.tree.position(here), dotted(here), got="a mass without a stiffness", expected=HELD)
    return not loose or spec.coupling == "one-way"


def _all_inside(name: str, room: ShapedRoom, receivers: list[Receiver], spec: RoomSpec, builder: Builder) -> bool:
    """Whether all receivers are in the mesh; notes those that are not."""
    sound = True
    for receiver in receivers:
        try:
            probe(room.mesh, receiver.position[None, :])
        except AcousticsError as error:
            written = receiver.name if receiver.name in spec.receivers else receiver.name.rpartition(".")[0]
            here: Steps = ("rooms", name, "receivers", written)
            got = f"{receiver.position.tolist()} m, a point outside the mesh"
            builder.mistakes.add(builder.tree.position(here), dotted(here), got=got, expected=error.expected)
            sound = False
    return sound


def _leak(spec: RoomSpec) -> Leak | None:
    leak = spec.leak
    if leak is None:
        return None
    if leak.inertance is not None:
        return Leak(leak.inertance, leak.resistance)
    return Leak(spec.air.rho * (leak.length or 0.0) / (leak.area or 1.0), leak.resistance)


def _losses(spec: RoomSpec) -> Losses:
    losses = spec.losses
    if losses is None:
        return Losses()
    if isinstance(losses.t60, dict):
        return losses_from_t60_bands(losses.t60)
    if losses.t60 is not None:
        return losses_from_t60(losses.t60)
    at = losses.at or 0.0
    if losses.beta is not None:
        return losses_from_beta(losses.beta, at, spec.form)
    return losses_from_loss_factor(losses.loss_factor or 0.0, at, spec.form)
