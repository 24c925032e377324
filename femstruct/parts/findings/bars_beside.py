"""Bars whose sections reach a plate or shell that nothing joins them to: ribs that hang in the air."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.model.grid.geometry import from_rectangle, to_rectangle
from femstruct.model.grid.ribs_apart import written
from femstruct.model.imported.nearest import nearest_places
from femstruct.model.model import Model
from femstruct.parts.findings.connections import Piece
from femstruct.parts.of_frames.frame_mesh import FrameMesh, frames_of
from femstruct.parts.of_meshes.shell_mesh import ShellMesh
from femstruct.parts.of_plates.plate_mesh import PlateMesh, plates_of

REACHED: Final = 1.01  # of half the depth and half the thickness: what is drawn to touch is rounded
MOST_PLACES: Final = 60  # along the bars of a piece


class Beside(NamedTuple):
    """A bar beside a face. place [3] : on the axis of the bar; apart : from there to the middle of the face [m]; offset
    : of the axis from there, as it is written."""

    bars: str
    face: str
    place: Floats
    apart: float
    offset: str


def bars_beside(model: Model, one: Piece, other: Piece) -> Beside | None:
    """The first place where the section of a bar of one of two pieces reaches a plate or shell of the other."""
    for here, there in ((one, other), (other, one)):
        faces: list[PlateMesh | ShellMesh] = [plate for plate in plates_of(model) if plate.name in there.parts]
        faces += [part for part in model.parts.values() if isinstance(part, ShellMesh) and part.name in there.parts]
        for frame in frames_of(model) if faces else ():
            if frame.name in here.parts:
                for place, axes in _along(frame, here):
                    for face in faces:
                        nearest, normal, half = _nearest(face, place)
                        if _reaches(frame, axes, nearest - place, normal, half):
                            apart = float(np.linalg.norm(nearest - place))
                            return Beside(frame.name, face.name, place, apart, written(place - nearest))
    return None


def _along(frame: FrameMesh, piece: Piece) -> Iterator[tuple[Floats, Floats]]:
    """Places on the axes of the bars of a piece, and the axes of the bars there."""
    own = np.flatnonzero(np.isin(frame.bars[:, :2], piece.nodes).all(axis=1))
    for bar in own[:: max(1, len(own) // (MOST_PLACES // 3))]:
        for share in (0.0, 0.5, 1.0):
            yield (1.0 - share) * frame.start[bar] + share * frame.end[bar], frame.axes[bar]


def _nearest(face: PlateMesh | ShellMesh, place: Floats) -> tuple[Floats, Floats, float]:
    """The place of the middle of a face nearest to one [3], the normal there, and half the thickness [m]."""
    if isinstance(face, PlateMesh):
        local = to_rectangle(face.part, face.axes, place)
        on_it = np.clip(local[:2], 0.0, face.part.size)
        return from_rectangle(face.part, face.axes, on_it), face.axes[2], face.part.thickness / 2.0
    found = nearest_places(face.cells, place[None])
    cell = int(found.cells[0])
    return found.positions[0], face.cells.normals[cell], float(face.thickness[cell]) / 2.0


def _reaches(frame: FrameMesh, axes: Floats, gap: Floats, normal: Floats, half: float) -> bool:
    """Whether the section of a bar reaches through a gap [3] [m] to a face; along the bar it reaches nowhere."""
    along = float(gap @ axes[0])
    across = gap - along * axes[0]
    size = float(np.linalg.norm(across))
    unit = across / size if size > 0.0 else normal
    section = frame.part.section
    if section.outline:
        deep = max(float(y * axes[1] @ unit + z * axes[2] @ unit) for y, z, *_ in section.outline)
    else:
        deep = float(np.sqrt(3.0 * max(section.Iy, section.Iz) / section.A))  # of a rectangle
    thick = half * abs(float(unit @ normal))
    return abs(along) <= REACHED * half and size <= REACHED * (deep + thick)
