"""Findings on ribs: lines of bars along a plate, in the air, eccentric, wide, or held so that they act as arches."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding
from femstruct.model.elastic_layers import layer_of
from femstruct.model.lay_ups import PlateSection, section_of
from femstruct.model.model import Model
from femstruct.model.plates_and_bars import planes_of, written
from femstruct.model.regions import Pair, Vector, distance_to_rectangle, from_rectangle, to_rectangle
from femstruct.model.shell_cells import nearest_places
from femstruct.model.structure import Joint
from femstruct.parts.foundation import NOTABLE, Foundation, glue_ratio
from femstruct.parts.frame import FrameMesh, frames_of
from femstruct.parts.joint_findings import TOUCHING, Piece, held_with_joined
from femstruct.parts.plate import Plate, PlateMesh, plates_of, rigid_plates
from femstruct.parts.shell import ShellMesh

# ----------------------------------------------------------------------------------------------------------------------
# Lines of bars that run along a plate, and the strip of plate that belongs to each.
# ----------------------------------------------------------------------------------------------------------------------

_TOUCHING = 1e-6  # of the plate's longer side


@dataclass(frozen=True, eq=False)
class RibLine:
    """Bars of a frame that lie on one straight line in a plate.

    along [2] : its direction in the plate's coordinates, across : where it is across that [m]. arm : from the
    mid-surface to the bars, along the normal [m]. spacing : least distance of its nodes, length : of all of it [m].
    axes [3, 3] : of its first bar.
    """

    frame: FrameMesh
    joint: Joint
    along: Floats
    across: float
    arm: float
    spacing: float
    length: float
    axes: Floats


@dataclass(frozen=True, eq=False)
class Face:
    """A flat part that ribs can be beside: a plate, or the rectangle round a slab or a flat shell.

    origin : a corner of its mid-surface [m]; size : along its x and y [m]; axes [3, 3] : rows are its x, y and normal.
    section : of the thickest of its cells.
    """

    name: str
    origin: Vector
    size: Pair
    axes: Floats
    section: PlateSection

    @property
    def normal(self) -> Vector:
        """Unit vector."""
        x, y, z = self.axes[2].tolist()
        return x, y, z

    @property
    def x_direction(self) -> Vector:
        """Unit vector."""
        x, y, z = self.axes[0].tolist()
        return x, y, z


def face_of(plate: PlateMesh) -> Face:
    """A plate as ribs see it."""
    return Face(plate.name, plate.part.origin, plate.part.size, plate.axes, plate.part.section)


def stretching_faces(model: Model) -> list[Face]:
    """Flat parts that stretch in their planes: plates that do, slabs, and flat shells."""
    faces = [face_of(plate) for plate in plates_of(model) if plate.stretches]
    for part in model.parts.values():
        axes = part.own_axes if isinstance(part, ShellMesh) else None
        if isinstance(part, ShellMesh) and axes is not None:
            local = part.places @ axes.T
            low = local.min(axis=0)
            x, y, z = (low @ axes).tolist()
            a, b, _ = np.ptp(local, axis=0).tolist()
            section = section_of(part.part.material, float(part.thickness.max()))
            faces.append(Face(part.name, (x, y, z), (a, b), axes, section))
    return faces


def rib_lines(plate: Face, joint: Joint, model: Model) -> list[RibLine]:
    """The straight lines of bars that a joint fastens to a plate along it."""
    names = {joint.a, joint.b}
    others = [frame for frame in frames_of(model) if frame.name in names]
    if plate.name not in names or not others:
        return []
    frame, size = others[0], plate.size
    ends = to_rectangle(plate, plate.axes, model.mesh.points[frame.bars[:, :2]])
    inside = (distance_to_rectangle(ends, size) <= _TOUCHING * max(size)).all(axis=1)
    steps = ends[:, 1, :2] - ends[:, 0, :2]
    spacing = np.linalg.norm(steps, axis=1)
    arms = (frame.arms[:, :2] @ plate.axes[2]).mean(axis=1)
    groups: dict[tuple[int, ...], list[int]] = {}
    for bar in np.flatnonzero(inside & (spacing > _TOUCHING * max(size))):
        along = steps[bar] / spacing[bar]
        along = along if (along > -1e-9).all() or along[0] > 1e-9 else -along
        across = float(along[0] * ends[bar, 0, 1] - along[1] * ends[bar, 0, 0])
        key = (*np.round(1e4 * along).astype(int), round(1e4 * across / max(size)))
        groups.setdefault(tuple(int(one) for one in key), []).append(int(bar))
    lines = []
    for bars in groups.values():
        first = bars[0]
        along = steps[first] / spacing[first]
        along = along if (along > -1e-9).all() or along[0] > 1e-9 else -along
        across = float(along[0] * ends[first, 0, 1] - along[1] * ends[first, 0, 0])
        arm = float(arms[bars][np.argmax(np.abs(arms[bars]))])
        step = spacing[bars]
        lines.append(
            RibLine(
                frame,
                joint,
                along=along,
                across=across,
                arm=arm,
                spacing=float(step.min()),
                length=float(step.sum()),
                axes=frame.axes[first],
            )
        )
    return lines


def edges_across(plate: Face, line: RibLine) -> tuple[float, float]:
    """Where the plate begins and ends across a rib [m], as `RibLine.across` counts."""
    corners = np.array([[0, 0], [1, 0], [0, 1], [1, 1]]) * np.asarray(plate.size)
    edges = line.along[0] * corners[:, 1] - line.along[1] * corners[:, 0]
    return float(edges.min()), float(edges.max())


def strip_width(plate: Face, line: RibLine, others: list[RibLine]) -> float:
    """Width of the plate that belongs to a rib: half way to the next ones beside it, or to the edges [m]."""
    low, high = edges_across(plate, line)
    beside = [other.across for other in others if abs(other.along @ line.along) > 1.0 - 1e-6]
    tiny = 1e-6 * (high - low)
    below = [(line.across + one) / 2.0 for one in beside if one < line.across - tiny]
    above = [(line.across + one) / 2.0 for one in beside if one > line.across + tiny]
    return min(above, default=high) - max(below, default=low)


def percent(share: float) -> str:
    """A share for a message, in two digits.

    >>> percent(0.0123), percent(2.5)
    ('1.2 %', '250 %')
    """
    return f"{100.0 * share:.2g} %" if share < 0.995 else f"{100.0 * share:.0f} %"


# ----------------------------------------------------------------------------------------------------------------------
# Ribbed plates that their supports hold lengthways at both ends, so that they act as arches.
#
# When a T of a plate and a rib bends, the ends of the plate slide along. Held there, at z from the common neutral axis,
# it is pushed by a force N, the same all along the rib. For one half wave of amplitude w0 over the length L
#
#     N = E A z 2 pi w0 / L^2,    energy N^2 L / 2 E A = (8 / pi^2) (E A z^2 / E I) times that of bending
#
# with E A and E I of the T. The half wave is a bound from above: the ends turn back a little.
#
# Checked against a model that is within 0.1 % of a three-dimensional solid
# (`tests/analytic/test_supports_in_plane.py`).
# ----------------------------------------------------------------------------------------------------------------------

ARCH_NOTABLE = 1e-2  # of a frequency
_BOTH = 0.5  # of a rib's length: supports that are so far apart along it hold both ends
_HELD = 1e-9


def arched_findings(model: Model) -> tuple[Finding, ...]:
    """Plates that stretch, slabs and flat shells, with ribs beside them, held lengthways at both ends; the worst rib of
    each pair of parts."""
    worst: dict[tuple[str, str], float] = {}
    stretching = stretching_faces(model) if frames_of(model) else []
    planes = planes_of(model, TOUCHING * float(np.ptp(model.mesh.points, axis=0).max())) if stretching else []
    held = held_with_joined(model) if stretching else np.zeros((0, 3, 3))
    for plate in stretching:
        plane = next(names for names in planes if plate.name in names)
        nodes = np.concatenate([model.parts[name].nodes for name in sorted(plane)])
        lines = [line for joint in model.structure.joints for line in rib_lines(plate, joint, model)]
        for line in lines:
            along = line.along @ plate.axes[:2]
            places = model.mesh.points[nodes[np.einsum("i,nij,j->n", along, held[nodes], along) > _HELD]] @ along
            if line.arm != 0.0 and len(places) and np.ptp(places) > _BOTH * line.length:
                key = (line.frame.name, plate.name)
                worst[key] = max(worst.get(key, 0.0), arch_excess(plate, line, lines))
    return tuple(
        Finding(
            "arched-plate",
            f"Supports hold {plate} lengthways at both ends of its eccentric rib {frame}. Both act as an arch: "
            f"frequencies of bending are up to {percent(excess)} higher than with ends that can slide",
            {"frequency_excess": excess},
        )
        for (frame, plate), excess in worst.items()
        if excess > ARCH_NOTABLE
    )


def arch_excess(plate: Face, line: RibLine, others: list[RibLine]) -> float:
    """Relative excess of the first frequency of a rib with its strip of plate over that with ends that slide [1]."""
    E, _, section = line.frame.part.along
    base = plate.section.turned(-float(np.arctan2(line.along[1], line.along[0])))
    width, normal = strip_width(plate, line, others), plate.axes[2]
    upright = section.Iy * (line.axes[2] @ normal) ** 2 + section.Iz * (line.axes[1] @ normal) ** 2
    rib, strip = E * section.A, base.stretching() * width
    off = line.arm * rib / (rib + strip)  # of the plate from the common neutral axis
    bending = float(base.bending[0, 0]) * width + E * upright + line.arm**2 * rib * strip / (rib + strip)
    return float(np.sqrt(1.0 + 8.0 / np.pi**2 * (rib + strip) * off**2 / bending) - 1.0)


# ----------------------------------------------------------------------------------------------------------------------
# Bars whose sections reach a plate or shell that nothing joins them to: ribs that hang in the air.
# ----------------------------------------------------------------------------------------------------------------------

REACHED: Final = 1.01  # of half the depth and half the thickness: what is drawn to touch is rounded
MOST_PLACES: Final = 60  # along the bars of a piece


class BarBeside(NamedTuple):
    """A bar beside a face. place [3] : on the axis of the bar; apart : from there to the middle of the face [m]; offset
    : of the axis from there, as it is written."""

    bars: str
    face: str
    place: Floats
    apart: float
    offset: str


def bars_beside(model: Model, one: Piece, other: Piece) -> BarBeside | None:
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
                            return BarBeside(frame.name, face.name, place, apart, written(place - nearest))
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


# ----------------------------------------------------------------------------------------------------------------------
# Ribs beside a plate that is said to be rigid in its own plane: how much too stiff they are.
#
# Two errors, both of the model and not of its mesh alone:
#
# Bending. A rib at e from the mid-surface acts with the plate as a T: its neutral axis lies between both, where their
# stretching balances. A plate that cannot stretch keeps it in its mid-surface. Per rib with a strip of plate of width b
#
#     rigid   D b + E I_r + E A_r e^2
#     true    D b + E I_r + e^2 E A_r E A_p / (E A_r + E A_p),    A_p = h b
#
# Torsion. Where the plate twists along the rib, the rib's axis moves sideways by e times the twist, and its rotation
# about the plate's normal is tied to the plate, which does not turn. So between any two nodes, a distance d apart, the
# rib bends sideways as a beam clamped at both ends, which is a torsional stiffness that does not exist:
#
#     12 E I_s e^2 / (d^2 (1 + phi)),    phi = 12 E I_s / (k G A d^2),  0 for bars without shear
#
# It grows as the mesh is refined, up to k G A e^2, without a limit for bars without shear.
#
# Checked against three-dimensional solids: T strips of timber and of concrete and a plate with one rib
# (`tests/analytic/test_rigid_in_plane.py`).
# ----------------------------------------------------------------------------------------------------------------------

SEVERE = 1e-2  # of a frequency


@dataclass(frozen=True)
class RibError:
    """How much too stiff a rib is with its plate: ratios of stiffness; arm [m], spacing of its nodes [m].

    bending : with a plate that cannot stretch over that with one that can. torsion : with what it is tied by over that
    without.
    """

    frame: str
    plate: str
    arm: float
    spacing: float
    bending: float
    torsion: float

    @property
    def excess(self) -> float:
        """Largest relative excess of a frequency [1]: the root of the larger ratio, less one."""
        return float(np.sqrt(max(self.bending, self.torsion)) - 1.0)


def rib_errors(model: Model) -> tuple[RibError, ...]:
    """The errors of every line of bars that are joined to a plate through arms out of its plane."""
    found = []
    for plate in rigid_plates(model).values():
        lines = [line for joint in model.structure.joints for line in rib_lines(face_of(plate), joint, model)]
        found += [_error(plate, line, lines) for line in lines if abs(line.arm) > 0.0]
    return tuple(found)


def eccentric_findings(model: Model) -> tuple[Finding, ...]:
    """Ribs and layers that a plate rigid in its own plane makes too stiff, the worst line of each pair of parts."""
    worst: dict[tuple[str, str], RibError] = {}
    for error in rib_errors(model):
        key = (error.frame, error.plate)
        if key not in worst or error.excess > worst[key].excess:
            worst[key] = error
    findings = [_rib_finding(error) for error in worst.values() if error.excess > NOTABLE]
    plates = {name: plate.part for name, plate in rigid_plates(model).items()}
    for part in model.structure.parts:
        if isinstance(part, Foundation) and set(part.ends) <= plates.keys():
            findings += _layer(part, *(plates[name] for name in part.ends))
    return tuple(findings)


def _rib_finding(error: RibError) -> Finding:
    bends, twists = (percent(np.sqrt(ratio) - 1.0) for ratio in (error.bending, error.torsion))
    return Finding(
        "eccentric-bars",
        f"{error.frame} on {error.plate}: the bars are {1e3 * error.arm:.3g} mm from the mid-surface of the plate, "
        f"which is rigid in its plane. A rib with its strip of plate is {error.bending:.3g} times too stiff in bending "
        f"(frequencies up to {bends} too high). It is {error.torsion:.3g} times too stiff in torsion (up to {twists} "
        f"too high) with nodes {1e3 * error.spacing:.3g} mm apart, and more with a finer mesh. A plate with 'in_plane: "
        "elastic' has neither error",
        {
            "bending_ratio": error.bending,
            "torsion_ratio": error.torsion,
            "frequency_excess": error.excess,
            "arm_m": error.arm,
            "spacing_m": error.spacing,
        },
        severe=error.excess > SEVERE,
    )


def _error(plate: PlateMesh, line: RibLine, others: list[RibLine]) -> RibError:
    part, (E, G, section) = plate.part, line.frame.part.along
    angle = float(np.arctan2(line.along[1], line.along[0]))
    base = part.section.turned(-angle)  # along the rib
    b, e = strip_width(face_of(plate), line, others), abs(line.arm)
    normal = plate.axes[2]
    sideways = np.cross(normal, line.along @ plate.axes[:2])
    upright = section.Iy * (line.axes[2] @ normal) ** 2 + section.Iz * (line.axes[1] @ normal) ** 2
    lateral = section.Iy * (line.axes[2] @ sideways) ** 2 + section.Iz * (line.axes[1] @ sideways) ** 2
    shear = section.A * (section.kz * (line.axes[2] @ sideways) ** 2 + section.ky * (line.axes[1] @ sideways) ** 2)
    alone = float(base.bending[0, 0]) * b + E * upright
    slip = _slip(plate, line)
    rigid = alone + e**2 / (1.0 / (E * section.A) + slip)
    true = alone + e**2 / (1.0 / (E * section.A) + 1.0 / (base.stretching() * b) + slip)
    twist = 4.0 * float(base.bending[2, 2]) * b + G * section.J
    false = 0.0
    if line.joint.kind != "pinned" and not set(line.joint.stiffness) & {"rx", "ry", "rz"}:
        clamped = 12.0 * E * lateral / line.spacing**2
        phi = 0.0 if line.frame.part.element == "euler" else clamped / (G * shear)
        false = clamped * e**2 / (1.0 + phi)
    names = line.frame.part.name, part.name
    return RibError(*names, e, line.spacing, float(rigid / true), float(1.0 + false / twist))


def _slip(plate: PlateMesh, line: RibLine) -> float:
    """1 / (E A) of springs between rib and plate along it, for one half wave over its length; 0 for a rigid joint."""
    along = line.along @ plate.axes[:2]
    if line.joint.kind == "sliding":
        return float(np.pi**2 / (line.joint.slip * line.length**2)) if line.joint.slip > 0.0 else np.inf
    for axis, direction in enumerate(("x", "y", "z")):
        if direction in line.joint.stiffness and abs(along[axis]) > 0.7:
            stiffness = line.joint.stiffness[direction]
            spacing = 1.0 if line.joint.per == "length" else line.spacing
            return float(np.pi**2 * spacing / (stiffness * line.length**2)) if stiffness > 0.0 else np.inf
    return 0.0


def _layer(part: Foundation, *plates: Plate) -> list[Finding]:
    """A layer so stiff in shear that plates would stretch before it yields: two act as one section, and one is held by
    its face."""
    bodies = {one.name: one.body() for one in plates}
    layer = layer_of(part, bodies, 1e-9 * max(side for one in plates for side in one.size))
    ratio = glue_ratio(layer, part.spread_shear(layer), *plates)
    excess = float(np.sqrt(ratio) - 1.0)
    if excess <= NOTABLE:
        return []
    both = len(plates) > 1
    plane = "in their planes, but they are rigid there" if both else "in its plane, but it is rigid there"
    return [
        Finding(
            "stiff-layer",
            f"{part.name} is so stiff in shear that {' and '.join(bodies)} would stretch {plane}: {ratio:.3g} times "
            f"too stiff in bending, frequencies up to {percent(excess)} too high",
            {"bending_ratio": ratio, "frequency_excess": excess},
            severe=excess > SEVERE,
        )
    ]


# ----------------------------------------------------------------------------------------------------------------------
# Ribs as wide as a share of the plate between them, which are fastened to it along lines.
#
# The plate bends between the faces of ribs that do not turn, b of s narrower than between their lines: its waves there
# have frequencies that are higher by (s / (s - b))^2. Ribs that turn, as most do, leave a part of it: chipboard on
# timber joists of 45 mm every 600 mm is 5 to 6 % higher in three-dimensional solids, where the bound is 17 %
# (`tests/analytic/test_plates_that_stretch.py`).
# ----------------------------------------------------------------------------------------------------------------------

WIDE_NOTABLE = 0.05  # of a frequency, by the bound


def wide_rib_findings(model: Model) -> tuple[Finding, ...]:
    """Ribs whose width leaves less of a plate to bend than their lines do; the widest of each pair of parts."""
    worst: dict[tuple[str, str], tuple[float, float]] = {}
    for plate in stretching_faces(model) if frames_of(model) else ():
        lines = [line for joint in model.structure.joints for line in rib_lines(plate, joint, model)]
        for line in lines:
            wide, span = _between(plate, line, lines)
            key = (line.frame.name, plate.name)
            if wide < span and wide / span > np.divide(*worst.get(key, (0.0, 1.0))):
                worst[key] = wide, span
    return tuple(
        Finding(
            "wide-ribs",
            f"{frame} on {plate}: ribs {1e3 * wide:.3g} mm wide are fastened along lines {1e3 * span:.3g} mm apart, "
            f"and {plate} bends over {1e3 * (span - wide):.3g} mm between them. Modes in which it bends between ribs "
            f"are up to {percent(low)} too low, if the ribs do not turn. Modes in which the ribs bend too are right",
            {"width_m": wide, "strip_m": span, "frequency_too_low": low},
        )
        for (frame, plate), (wide, span) in worst.items()
        if (low := 1.0 - (1.0 - wide / span) ** 2) > WIDE_NOTABLE
    )


def _between(plate: Face, line: RibLine, lines: list[RibLine]) -> tuple[float, float]:
    """What ribs cover of the span to the nearest line beside this one, and that span [m]; of a rib alone, both for a
    line as far away as twice its farther edge, half of the rib to each side."""
    wide = width_on(plate, line)
    beside = [other for other in lines if abs(other.along @ line.along) > 1.0 - 1e-6]
    low, high = edges_across(plate, line)
    apart = [(abs(other.across - line.across), other) for other in beside]
    apart = [(span, other) for span, other in apart if span > 1e-6 * (high - low)]
    if not apart:
        return wide, 2.0 * max(high - line.across, line.across - low)
    span, other = min(apart, key=lambda one: one[0])
    return (wide + width_on(plate, other)) / 2.0, span


def width_on(plate: Face, line: RibLine) -> float:
    """Width of the section of a rib across its line, in the plane of a plate [m]; 0 where its outline is unknown."""
    across = np.array([-line.along[1], line.along[0]]) @ plate.axes[:2]
    outline = np.array(line.frame.part.section.outline).reshape(-1, 2)
    return float(np.ptp(outline @ (line.axes[1:] @ across))) if len(outline) else 0.0
