"""What touches a block: the places it takes along in a joint."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError
from femstruct.model.geometry import PARALLEL, to_plate
from femstruct.model.model import Model
from femstruct.model.parts import Block, Joint, Plate


def block_pairs(item: Joint, model: Model, tolerance: float) -> Integers:
    """Nodes of the two parts of a joint that move together [m, 2]; at least one of the parts is a block.

    Of a plate all nodes whose thickness reaches the block, of a frame all nodes in it, of another block its only one.

    Raises InputError when nothing touches.
    """
    turned = item.a not in model.blocks
    name, other = (item.b, item.a) if turned else (item.a, item.b)
    block = model.blocks[name]
    if other in model.blocks:
        if item.kind != "rigid" or item.stiffness:
            raise InputError(
                f"joints.{item.name}",
                got="a joint of two blocks that is not rigid",
                expected="kind: rigid",
                do="put a foundation or springs between them",
            )
        apart = blocks_apart(block.part, model.blocks[other].part)
        if apart > tolerance:
            raise _no_touch(item, f"{apart:.4g} m apart")
        return np.array([[block.node, model.blocks[other].node]])
    nodes = model.mesh.nodes[other]
    across = np.zeros(3)
    if other in model.plates:
        plate = model.plates[other]
        across = plate.axes[2] * plate.part.thickness / 2.0
    low, high = block.corners
    first, last = stretch_inside(model.mesh.points[nodes], across, low - tolerance, high + tolerance)
    met = nodes[first <= last]
    if not len(met):
        raise _no_touch(item, "without a common place")
    pairs = np.stack([np.full(len(met), block.node), met], axis=1)
    return pairs[:, ::-1] if turned else pairs


def stretch_inside(places: Floats, across: Floats, low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Where the lines from place - across (-1) to place + across (1) enter and leave a box, for places [p, 3].

    low, high [3] : corners of the box. A line that misses it enters after it leaves.

    >>> places = np.array([[0.5, 0.5, 1.2], [0.5, 0.5, 1.8]])
    >>> first, last = stretch_inside(places, np.array([0.0, 0.0, 0.4]), np.zeros(3), np.ones(3))
    >>> first <= last, last.round(6)[0]
    (array([ True, False]), np.float64(-0.5))
    """
    first, last = np.full(len(places), -1.0), np.full(len(places), 1.0)
    for axis in range(3):
        ends = np.stack([low[axis] - places[:, axis], high[axis] - places[:, axis]])
        if across[axis] == 0.0:
            outside = (ends[0] > 0.0) | (ends[1] < 0.0)
            last = np.where(outside, -np.inf, last)
            continue
        shares = np.sort(ends / across[axis], axis=0)
        first, last = np.maximum(first, shares[0]), np.minimum(last, shares[1])
    return first, last


def lines_under(block: Block, plate: Plate, axes: Floats) -> Floats:
    """Two places [2, 2] of a plate, in its coordinates, whose grid lines bound what a block covers of it.

    Raises InputError for a plate whose sides are not parallel to the block's.
    """
    if np.abs(np.abs(axes) - np.round(np.abs(axes))).max() > PARALLEL:
        raise InputError(
            f"parts.{plate.name}",
            got=f"a plate at an angle to {block.name}, which it is joined to",
            expected="sides parallel to those of the block",
            do="turn the plate, or join it with springs",
        )
    ends = to_plate(plate, axes, np.stack([block.origin, np.add(block.origin, block.size)]))
    found: Floats = np.clip(ends[:, :2], 0.0, plate.size)
    return found


def blocks_apart(first: Block, second: Block) -> float:
    """Distance between two blocks [m], zero where they touch or reach into each other."""
    low, other = np.asarray(first.origin), np.asarray(second.origin)
    between = np.maximum(other - (low + first.size), low - (other + second.size))
    return float(np.linalg.norm(np.maximum(between, 0.0)))


def _no_touch(item: Joint, how: str) -> InputError:
    return InputError(
        f"joints.{item.name}",
        got=f"{item.a} and {item.b} {how}",
        expected="a part that touches the block",
        do="move one of them, or put a foundation or springs between",
    )
