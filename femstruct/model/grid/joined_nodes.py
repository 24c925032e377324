"""Which nodes of two joined parts move together."""

from __future__ import annotations

import numpy as np
import scipy

from femstruct.arrays import Integers
from femstruct.errors import InputError
from femstruct.model.grid.ribs_apart import offsets_of
from femstruct.model.grid.touching import stretch_inside
from femstruct.model.model import Model
from femstruct.model.region import Region
from femstruct.model.structure import Joint


def coincident_pairs(item: Joint, model: Model, tolerance: float) -> Integers:
    """Coincident nodes of the two parts, or nodes within reach of each other [m, 2]: of each node of the first part, or
    of a set alone that is named, the nearest of the other."""
    first, second = (joined_nodes(item, name, model, tolerance) for name in (item.a, item.b))
    turned = set(item.sets) == {item.b}
    if turned:
        first, second = second, first
    reach = 4.0 * tolerance if item.reach is None else item.reach
    distances, nearest = scipy.spatial.KDTree(model.mesh.points[second]).query(
        model.mesh.points[first], distance_upper_bound=reach
    )
    met = np.isfinite(distances)
    if not met.any():
        apart = np.min(scipy.spatial.KDTree(model.mesh.points[second]).query(model.mesh.points[first])[0])
        arms = f"write 'reach: {1e3 * apart:.3g} mm' for rigid arms between them"
        offsets = offsets_of(model.parts[item.a], model.parts[item.b])
        raise InputError(
            f"joints.{item.name}",
            got=f"{item.a} and {item.b} without a common node; the nearest two are {apart:.4g} m apart",
            expected="a touch" if item.reach is None else f"nodes at most {item.reach:g} m apart",
            do=arms if offsets is None else f"{offsets}; if not, {arms}",
        )
    pairs = np.stack([first[met], second[np.asarray(nearest)[met]]], axis=1)
    return pairs[:, ::-1] if turned else pairs


def joined_nodes(item: Joint, name: str, model: Model, tolerance: float) -> Integers:
    """Nodes of a part that a joint is about: those of a set, where it names one."""
    if name not in item.sets:
        return model.parts[name].joinable
    return model.parts[name].within(f"joints.{item.name}.sets", Region("set", named=item.sets[name]), tolerance)


def box_pairs(item: Joint, model: Model, tolerance: float) -> Integers:
    """Nodes of the two parts of a joint that move together [m, 2]; at least one of the parts is a block.

    Of a plate all nodes whose thickness reaches the block, of a frame all nodes in it, of another block its only one.

    Raises InputError when nothing touches.
    """
    turned = model.parts[item.a].box is None
    part, other = (model.parts[name] for name in ((item.b, item.a) if turned else (item.a, item.b)))
    assert part.box is not None
    low, high = part.box
    if other.box is not None:
        if item.kind != "rigid" or item.stiffness:
            raise InputError(
                f"joints.{item.name}",
                got="a joint of two blocks that is not rigid",
                expected="kind: rigid",
                do="put a foundation or springs between them",
            )
        apart = float(np.linalg.norm(np.maximum(np.maximum(other.box[0] - high, low - other.box[1]), 0.0)))
        if apart > tolerance:
            raise _no_touch(item, f"{apart:.4g} m apart")
        return np.array([[part.first, other.first]])
    nodes = joined_nodes(item, other.name, model, tolerance)
    places = other.places[nodes - other.first]
    first, last = stretch_inside(places, other.across, low - tolerance, high + tolerance)
    met = nodes[first <= last]
    if not len(met):
        raise _no_touch(item, "without a common place")
    pairs = np.stack([np.full(len(met), part.first), met], axis=1)
    return pairs[:, ::-1] if turned else pairs


def _no_touch(item: Joint, how: str) -> InputError:
    return InputError(
        f"joints.{item.name}",
        got=f"{item.a} and {item.b} {how}",
        expected="a part that touches the block",
        do="move one of them, or put a foundation or springs between",
    )
