"""What happens in the planes of plates: which of them have to stretch, and how simple supports hold those that do.

A plate that lies alone, or is joined only to what lies in its plane, bends and stretches independently of each other:
nothing that pushes it out of its plane stretches it. Any other part that is joined to it may: a plate at an angle, a
rib beside it, a post, a block.

A simple support carries a plate and keeps it in its place, but must not keep it from stretching: a ribbed floor held
lengthways at both ends would be an arch. So in the plane of a plate that stretches, the simple supports of it together
hold only what would be a rigid motion otherwise: the mean shifts and the mean rotation of all the edges and lines that
they hold, as far as no other support of it does. Plates in one plane that are joined count as one. The force is that of
the first of these supports.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.arrays import Floats
from femstruct.conventions import N_COMPONENTS
from femstruct.model.fastened import Tie
from femstruct.model.grid.geometry import to_rectangle
from femstruct.model.grid.layout import Layout
from femstruct.model.model import Model
from femstruct.model.structure import SIMPLE, Joint, Structure, Support

_PARALLEL = 1e-6  # sine of an angle: less is rounding
_FREE = 1e-6  # of what supports resist most: a rigid motion they resist by less is free


def stretched(structure: Structure, layout: Layout) -> frozenset[str]:
    """Names of the plates that what is joined to them can stretch."""
    found: set[str] = set()
    for group in _groups([(joint.a, joint.b) for joint in structure.joints]):
        rectangles = group & layout.rectangles.keys()
        if rectangles and (rectangles & layout.pulled or not _in_one_plane(group, layout)):
            found |= rectangles
    return frozenset(found | layout.pulled)


def steadied(ties: Mapping[str, Tie], model: Model, tolerance: float) -> list[Tie]:
    """Supports by name, the first simple one of every plane with what holds its plates in it."""
    held = csr_array(vstack([csr_array((0, model.mesh.n_nodes * N_COMPONENTS)), *(tie.rows for tie in ties.values())]))
    found = dict(ties)
    for plane in planes_of(model, tolerance):
        supports = [item for item in model.structure.supports if item.on in plane and _is_simple(item)]
        if supports:
            first = found[supports[0].name]
            rows = _mean_rows(supports, plane, held, model, tolerance)
            means = np.stack([rows[:, axis::N_COMPONENTS].sum(axis=1) for axis in range(3)], axis=1)
            directions = np.concatenate([first.directions, means])
            found[first.name] = Tie(first.name, csr_array(vstack([first.rows, rows])), directions, grounded=True)
    return list(found.values())


def planes_of(model: Model, tolerance: float) -> list[frozenset[str]]:
    """Names of the plates that stretch, those together that lie in one plane and are joined."""
    joined = [(joint.a, joint.b) for joint in model.structure.joints if _is_one_plane(joint, model, tolerance)]
    return _groups(joined, [name for name, part in model.parts.items() if part.drilling is not None])


def _groups(pairs: Sequence[tuple[str, str]], alone: Sequence[str] = ()) -> list[frozenset[str]]:
    """Names that pairs connect, and those that none does."""
    owner = {name: name for name in (*alone, *(name for pair in pairs for name in pair))}

    def root(name: str) -> str:
        while owner[name] != name:
            name = owner[name]
        return name

    for a, b in pairs:
        owner[root(a)] = root(b)
    return [frozenset(name for name in owner if root(name) == one) for one in owner if root(one) == one]


def _in_one_plane(group: frozenset[str], layout: Layout) -> bool:
    """Whether parts lie in one plane: rectangles, and bars whose axes and nodes do."""
    if not group <= layout.rectangles.keys() | layout.segments.keys():
        return False
    name = min(group & layout.rectangles.keys())
    plate, axes = layout.rectangles[name], layout.axes_of[name]
    places = []
    for other in group & layout.segments.keys():
        places += [layout.vertices[other], *(np.stack([one.start, one.end]) for one in layout.segments[other])]
    for other in group & layout.rectangles.keys():
        if np.linalg.norm(np.cross(layout.axes_of[other][2], axes[2])) > _PARALLEL:
            return False
        places.append(np.asarray(layout.rectangles[other].origin, dtype=np.float64)[None])
    heights = to_rectangle(plate, axes, np.concatenate(places))[:, 2]
    return bool(np.abs(heights).max() <= layout.tolerance)


def _is_one_plane(joint: Joint, model: Model, tolerance: float) -> bool:
    one, other = model.parts.get(joint.a), model.parts.get(joint.b)
    if (
        one is None
        or other is None
        or one.drilling is None
        or other.drilling is None
        or joint.stiffness
        or joint.kind == "sliding"
    ):
        return False
    apart = float(abs((other.places[0] - one.places[0]) @ one.drilling))
    return bool(np.linalg.norm(np.cross(one.drilling, other.drilling)) < _PARALLEL and apart <= tolerance)


def _is_simple(item: Support) -> bool:
    return item.fix in SIMPLE and (item.edge is not None or item.line is not None)


def _mean_rows(
    supports: Sequence[Support], plane: frozenset[str], held: csr_array, model: Model, tolerance: float
) -> csr_array:
    """Mean rigid motions [f, n_nodes * 7] in a plane of all that its simple supports hold, of which supports leave the
    plates free; held [m, n_nodes * 7] : what they hold in all."""
    lines = [line for item in supports for line, _ in model.parts[str(item.on)].edges(item, tolerance)]
    nodes, weights = np.concatenate(lines), np.concatenate([_lengths(model.mesh.points[line]) for line in lines])
    weights /= weights.sum()
    part = model.parts[str(supports[0].on)]
    assert part.own_axes is not None
    axes, points = part.own_axes, model.mesh.points
    middle = weights @ points[nodes]
    size = float(np.linalg.norm(points[nodes] - middle, axis=1).max())
    of_all = np.concatenate([model.parts[name].nodes for name in sorted(plane)])
    motion = np.zeros((model.mesh.n_nodes, N_COMPONENTS, 3))
    motion[of_all, :3, :2] = axes[:2].T
    motion[of_all, :3, 2] = np.cross(axes[2], points[of_all] - middle) / size
    motion[of_all, 3:6, 2] = axes[2] / size
    felt = held @ motion.reshape(-1, 3)
    # An oblique deflection that is held feels rigid motions in the plane by the rounding of its axes.
    sizes = np.sqrt(np.asarray(held.multiply(held).sum(axis=1), dtype=np.float64))
    free = _null(felt[np.linalg.norm(felt, axis=1) > _FREE * sizes])
    rows = np.zeros((len(free), model.mesh.n_nodes, N_COMPONENTS))
    pushes = np.einsum("nci,fi->fnc", motion[nodes, :3], free)
    for row, push in zip(rows, weights[:, None] * pushes, strict=True):
        np.add.at(row[:, :3], nodes, push)
    return csr_array(rows.reshape(len(free), model.mesh.n_nodes * N_COMPONENTS))


def _lengths(places: Floats) -> Floats:
    """Length of a line that belongs to each of its points [n] [m]."""
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    lengths: Floats = (np.append(steps, 0.0) + np.append(0.0, steps)) / 2.0
    return lengths


def _null(rows: Floats) -> Floats:
    """Orthonormal motions [f, 3] that the rows [m, 3] do not feel."""
    if not len(rows):
        return np.eye(3)
    _, values, vectors = np.linalg.svd(rows.T @ rows)
    found: Floats = vectors[int((values > _FREE**2 * values[0]).sum()) :]
    return found
