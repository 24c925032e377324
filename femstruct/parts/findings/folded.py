"""Plates joined at an angle: from which frequency on they would bend, shear or stretch in their own planes.

These plates are said to be rigid in their own planes. Folded ones have modes in which that matters: an angle or a
channel bends as a beam, which its plates can only follow by bending in their planes. The model has none of these modes,
and those that it has near them are wrong.

Plates joined along parallel lines are taken as a beam of the section they make together: its least second moment about
its centroid, the shear stiffness of the plates that stand along the deflection, the mass of all of them, and the
supports at its ends: 1 / f^2 = 1 / f_bending^2 + 1 / f_shear^2. A plate stretches from E / rho on as a rod.

Checked against three-dimensional solids: an angle and an I-beam (first mode left out 46.3 and 10.5 Hz), and an open
box, all of whose first twelve modes the model has to 0.2 % (`tests/analytic/test_rigid_in_plane.py`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding, InputError, some_of
from femstruct.model.grid.geometry import meeting_line
from femstruct.model.model import Model
from femstruct.parts.findings.connections import held_with_joined
from femstruct.parts.of_plates.plate_mesh import PlateMesh, rigid_plates

NEAR = 0.5  # of the first frequency left out: from here on modes are raised by some percent
_PARALLEL = 1e-3  # sine of an angle
_SHARED = 1e-6  # of the structure's size
_HELD = 1e-9
_UPRIGHT = 0.5  # of a plate that resists a deflection: its width along it over its width
# (beta L)^2 of a beam by what holds its two ends (Free, Pinned, Clamped), and half waves of the shear beam.
_BENDING = {"FF": 22.373, "CF": 3.516, "CC": 22.373, "PP": 9.870, "CP": 15.418, "FP": 15.418}
_SHEAR = {"FF": 1.0, "CF": 0.5, "CC": 1.0, "PP": 1.0, "CP": 1.0, "FP": 1.0}


@dataclass(frozen=True)
class InPlaneLimit:
    """The lowest frequency [Hz] at which some plates would move in their planes, and how."""

    frequency_hz: float
    plates: tuple[str, ...]
    how: str


def in_plane_limit(model: Model) -> InPlaneLimit | None:
    """The lowest frequency of folded plates in their own planes; None where no plates are joined at an angle."""
    found: list[InPlaneLimit] = []
    held: Floats | None = None
    rigid = rigid_plates(model)
    for along, names in _prisms(model):
        held = held_with_joined(model) if held is None else held
        plates = [plate for name, plate in rigid.items() if name in names]
        found += [_stretching(plate) for plate in plates]
        found += _bending(model, plates, along, held)
    return min(found, key=lambda limit: limit.frequency_hz, default=None)


def folded_findings(model: Model, up_to_hz: float) -> tuple[Finding, ...]:
    """Whether modes up to a frequency [Hz] reach to where folded plates would move in their planes."""
    limit = in_plane_limit(model)
    if limit is None or not up_to_hz >= NEAR * limit.frequency_hz:
        return ()
    names = some_of(limit.plates)
    there = up_to_hz >= limit.frequency_hz
    asked = f"modes up to {up_to_hz:.4g} Hz" if np.isfinite(up_to_hz) else "all modes"
    return (
        Finding(
            "folded-plates",
            f"{names}: plates joined at an angle {limit.how} from about {limit.frequency_hz:.3g} Hz on, but "
            f"these are rigid there. {'The model lacks such modes. Modes' if there else 'Modes'} above "
            f"{NEAR * limit.frequency_hz:.3g} Hz are too high by some percent or more; {asked} are requested",
            {"in_plane_hz": limit.frequency_hz, "up_to_hz": up_to_hz},
            severe=there,
        ),
    )


def _prisms(model: Model) -> list[tuple[Floats, tuple[str, ...]]]:
    """Directions of fold lines [3], and the plates that are joined along lines of each, two of them at an angle."""
    size = float(np.ptp(model.mesh.points, axis=0).max())
    folds: list[tuple[Floats, str, str]] = []
    flat: list[tuple[str, str]] = []
    rigid = rigid_plates(model)
    for joint in model.structure.joints:
        one, other = rigid.get(joint.a), rigid.get(joint.b)
        if one is None or other is None:
            continue
        if np.linalg.norm(np.cross(one.axes[2], other.axes[2])) < _PARALLEL:
            flat.append((joint.a, joint.b))
            continue
        try:
            start, end = meeting_line(one.part, other.part, _SHARED * size)
        except InputError:  # joined with less precision than asked for here
            continue
        length = float(np.linalg.norm(end - start))
        if length > 10.0 * _SHARED * size:
            folds.append(((end - start) / length, joint.a, joint.b))
    found: list[tuple[Floats, tuple[str, ...]]] = []
    directions: list[Floats] = []
    for along, _, _ in folds:
        if all(np.linalg.norm(np.cross(along, other)) > _PARALLEL for other in directions):
            directions.append(along)
    for along in directions:
        pairs = [(a, b) for other, a, b in folds if np.linalg.norm(np.cross(along, other)) <= _PARALLEL]
        found += [(along, names) for names in _groups(pairs, flat)]
    return found


def _groups(folds: Sequence[tuple[str, str]], flat: Sequence[tuple[str, str]]) -> list[tuple[str, ...]]:
    """Names that pairs connect, of groups with at least one fold."""
    owner = {name: name for pair in (*folds, *flat) for name in pair}

    def root(name: str) -> str:
        while owner[name] != name:
            name = owner[name]
        return name

    for a, b in (*folds, *flat):
        owner[root(a)] = root(b)
    folded = {root(a) for a, _ in folds}
    return [tuple(name for name in owner if root(name) == one) for one in sorted(folded)]


def _stretching(plate: PlateMesh) -> InPlaneLimit:
    """Half a wave over the longer side, as of a rod with free ends."""
    section, (width, height) = plate.part.section, plate.part.size
    stretch = section.stretching(0.0 if width >= height else np.pi / 2.0)
    speed = np.sqrt(stretch / section.m0) if section.m0 > 0.0 else np.inf
    return InPlaneLimit(float(speed / (2.0 * max(plate.part.size))), (plate.part.name,), "stretch in their planes")


def _bending(model: Model, plates: Sequence[PlateMesh], along: Floats, held: Floats) -> list[InPlaneLimit]:
    """The beam that plates make along a direction [3], bending about either principal axis of its section."""
    nodes = np.concatenate([plate.nodes.ravel() for plate in plates])
    places = model.mesh.points[nodes] @ along
    low, length = float(places.min()), float(np.ptp(places))
    widths, centres = zip(*(_across(plate, along) for plate in plates), strict=True)
    shares = np.array([_extent(plate, along) / length for plate in plates])  # of shorter plates: spread over all of it
    across = shares * [np.linalg.norm(width) for width in widths]
    angles = [np.arctan2(plate.axes[1] @ along, plate.axes[0] @ along) for plate in plates]
    sections = [plate.part.section for plate in plates]
    stretch = across * [section.stretching(angle) for section, angle in zip(sections, angles, strict=True)]
    sheared = [section.turned(-angle).A[2, 2] for section, angle in zip(sections, angles, strict=True)]
    shear = 5.0 / 6.0 * across * sheared
    mass = float((across * [section.m0 for section in sections]).sum())
    middle = (stretch[:, None] * centres).sum(axis=0) / stretch.sum()
    moments = np.zeros((3, 3))
    for weight, width, centre in zip(stretch, widths, centres, strict=True):
        moments += weight * (np.outer(width, width) / 12.0 + np.outer(centre - middle, centre - middle))
    stiffness, axes = np.linalg.eigh(moments)
    found = []
    for value, axis in zip(stiffness, axes.T, strict=True):
        leaning = np.array([abs(axis @ width) / np.linalg.norm(width) for width in widths])
        if abs(axis @ along) > _UPRIGHT or not (leaning > _UPRIGHT).any() or value <= 0.0 or mass <= 0.0:
            continue
        upright = [plate for plate, share in zip(plates, leaning, strict=True) if share > _UPRIGHT]
        ends = _ends(model, upright, along, axis, held, (low, length))
        if ends is None:
            continue
        bends = _BENDING[ends] / (2.0 * np.pi * length**2) * np.sqrt(value / mass)
        shears = _SHEAR[ends] / (2.0 * length) * np.sqrt(float((shear * leaning**2).sum()) / mass)
        names = tuple(plate.part.name for plate in plates)
        found.append(InPlaneLimit(float(1.0 / np.hypot(1.0 / bends, 1.0 / shears)), names, "bend in their planes"))
    return found


def _across(plate: PlateMesh, along: Floats) -> tuple[Floats, Floats]:
    """Width of a plate across a direction as a vector [3], and where its middle is across it [3]."""
    inside = [float(abs(axis @ along)) for axis in plate.axes[:2]]
    side = int(np.argmin(inside))
    middle = np.asarray(plate.part.origin) + np.asarray(plate.part.size) @ plate.axes[:2] / 2.0
    width: Floats = plate.part.size[side] * plate.axes[side]
    centre: Floats = middle - (middle @ along) * along
    return width, centre


def _extent(plate: PlateMesh, along: Floats) -> float:
    """Length of a plate along a direction [m]."""
    return float(sum(side * abs(axis @ along) for side, axis in zip(plate.part.size, plate.axes[:2], strict=True)))


def _ends(
    model: Model,
    upright: Sequence[PlateMesh],
    along: Floats,
    axis: Floats,
    held: Floats,
    span: tuple[float, float],
) -> str | None:
    """What holds both ends against moving along an axis: a key of the tables; None where it is held in between."""
    nodes = np.concatenate([plate.nodes.ravel() for plate in upright])
    low, length = span
    place = (model.mesh.points[nodes] @ along - low) / length
    depth = model.mesh.points[nodes] @ axis
    across = np.einsum("i,nij,j->n", axis, held[nodes], axis) > _HELD
    lengthwise = np.einsum("i,nij,j->n", along, held[nodes], along) > _HELD
    if (across & (place > 0.02) & (place < 0.98)).any():
        return None
    kinds = []
    for end in (place <= 0.02, place >= 0.98):
        turns = lengthwise & end
        if not (across & end).any():
            kinds.append("F")
        elif turns.any() and np.ptp(depth[turns]) > 0.5 * np.ptp(depth):
            kinds.append("C")
        else:
            kinds.append("P")
    return "".join(sorted(kinds))
