"""Nodes whose supports and links are along directions of their own: those in all three directions have none."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from femstruct.arrays import Integers
from femstruct.model.imported_mesh import Makes, StatedHold, StatedLink, Tally


def in_global_directions(
    holds: Sequence[StatedHold], links: Sequence[StatedLink], turned: Integers, tally: Tally, why: str, line: int
) -> tuple[list[StatedHold], list[StatedLink]]:
    """Supports and links without those of turned nodes that hold some of their own directions, which are counted.

    Parameters
    ----------
    turned : Integers [n]
        Numbers of the nodes.
    why : str
        What turns them, as the file calls it.
    line : int
        Where.

    Examples
    --------
    >>> holds = [StatedHold("a", np.array([1, 2]), (0, 1, 2)), StatedHold("b", np.array([1, 3]), (3,))]
    >>> tally = Tally()
    >>> kept, _ = in_global_directions(holds, [], np.array([1]), tally, "in directions of CD", 4)
    >>> [one.nodes.tolist() for one in kept], tally.found[0].named
    ([[1, 2], [3]], '1 held nodes in directions of CD (line 4)')
    """
    if not len(turned):
        return list(holds), list(links)
    of: dict[tuple[str, int], set[int]] = {}  # sets of supports may be of several load cases: one by one
    for one in holds:
        for node in one.nodes[np.isin(one.nodes, turned)].tolist():
            of.setdefault((one.name, node), set()).update(one.held)
    partly = {key for key, held in of.items() if not _in_all(held)}
    if partly:
        count = len({node for _, node in partly})
        tally.add(f"held nodes {why}", Makes.SUPPORTS, "held in other directions", line, count=count)
    kept = [
        replace(one, nodes=one.nodes[[(one.name, node) not in partly for node in one.nodes.tolist()]]) for one in holds
    ]
    bent = [one for one in links if not _in_all(one.follows) and np.isin((one.node, *one.nodes), turned).any()]
    if bent:
        tally.add(f"links {why}", Makes.LINKS, "links in other directions", line, count=len(bent))
    return [one for one in kept if len(one.nodes)], [one for one in links if not any(one is other for other in bent)]


def _in_all(held: Collection[int]) -> bool:
    """Whether held shifts are all three or none, and held turns as well."""
    return all(sum(one in held for one in some) in (0, 3) for some in ((0, 1, 2), (3, 4, 5)))
