"""Places of source and microphones, and sides of rooms, drawn as a laboratory would choose them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.modal.basis import ModalBasis
from femstruct.model.structure import PlaceOn, Structure
from femstruct.parts.plate import Plate
from femstruct.parts.slab import Slab
from femstruct.study.study import Study
from femstruct.workflow.stages.places import Places

SIDES: Final = 0.05  # by which the sides of a room differ, to each direction
FROM_EDGES_M: Final = 0.5  # of the floor and of the room's walls, ISO 16283-2; ...
FROM_CEILING_M: Final = 1.0
AT_MOST: Final = 0.2  # ... of a side that is short
NEAR: Final = 1e-6  # of a part's size, by which a place may be off it


def drawn_sides(rooms: int, rng: np.random.Generator) -> Floats:
    """Factors [rooms, 3] of a room's sides, evenly spread over +-5 % (a Latin hypercube).

    >>> factors = drawn_sides(10, np.random.default_rng(1))
    >>> bool(((factors > 0.95) & (factors < 1.05)).all()), factors.mean(axis=0).round(2).tolist()
    (True, [1.0, 1.0, 1.0])
    """
    ranks = np.array([rng.permutation(rooms) for _ in range(3)]).T
    return np.asarray(1.0 - SIDES + 2.0 * SIDES * (ranks + rng.random((rooms, 3))) / rooms)


def drawn_receivers(size: Floats, receivers: int, sets: int, rng: np.random.Generator) -> Floats:
    """Places of microphones [sets, receivers, 3] in a room of a size [3] [m]: 0.5 m from its walls and floor, 1 m from
    its ceiling; the receivers of all sets are at the same heights.

    >>> spots = drawn_receivers(np.array([5.0, 4.0, 2.5]), 4, 6, np.random.default_rng(1))
    >>> spots.shape, bool((spots > 0.5).all()), bool((spots < [4.5, 3.5, 1.5]).all())
    ((6, 4, 3), True, True)
    """
    low = np.minimum(FROM_EDGES_M, AT_MOST * size)
    high = size - np.minimum(np.array([FROM_EDGES_M, FROM_EDGES_M, FROM_CEILING_M]), 2 * AT_MOST * size)
    spots = rng.random((sets, receivers, 3))
    spots[:, :, 2] = spots[0, :, 2]
    return np.asarray(low + spots * (high - low))


def drawn_drops(
    studies: Sequence[Study], places: Places, basis: ModalBasis, sets: int, rng: np.random.Generator
) -> list[list[Floats]] | None:
    """For each set, for each drop, rows [h, k] of all modes where its bodies strike a floor: each drop moved as it is,
    0.5 m from the edges of its rectangle; None where something else than these bodies acts, or the floor is no
    rectangle."""
    struck = [_struck(study) for study in studies]
    known = [one for one in struck if one is not None]
    if len(known) < len(struck):
        return None
    found: list[list[Floats]] = []
    for _ in range(sets):
        rows = []
        for place, part, at in known:
            size, half = np.array(part.size), np.ptp(at, axis=0) / 2.0
            edge = np.minimum(FROM_EDGES_M, AT_MOST * size) + half
            if (2.0 * edge >= size).any():
                return None
            centre = edge + rng.random(2) * (size - 2.0 * edge)
            moved = at - (at.max(axis=0) + at.min(axis=0)) / 2.0 + centre
            rows.append(_rows(place, part, moved, places, basis))
        found.append(rows)
    return found


def _rows(place: PlaceOn, part: Plate | Slab, at: Floats, places: Places, basis: ModalBasis) -> Floats:
    """Motion across the floor in every mode [h, k] at places [h, 2] of a part."""
    near = NEAR * max(part.size)
    points = [
        places.parts[part.name].point(place.name, replace(place, at=(tuple(one.tolist()),)), one, near) for one in at
    ]
    return np.array([one.probe("z").of(basis.shapes) for one in points])


def _struck(study: Study) -> tuple[PlaceOn, Plate | Slab, Floats] | None:
    """Which points of which rectangular floor a source strikes, and where [h, 2]; None for other floors or blows."""
    structure = study.structure
    if study.links or study.contacts or study.loads or study.walks or not isinstance(structure, Structure):
        return None
    own = [body for body in study.bodies if body.source and body.law is not None]
    if not own or len(own) < len(study.bodies) or any(body.side != "above" for body in own):
        return None
    parts = {part.name: part for part in structure.parts}
    at, found = [], None
    for body in own:
        name, _, number = body.target.rpartition(".")
        place = next((one for one in structure.points if one.name in (body.target, name)), None)
        part = None if place is None else parts.get(place.on)
        if place is None or place.named or not isinstance(part, Plate | Slab) or not _rectangular(part):
            return None
        found = place, part
        at.append(place.at[int(number) - 1 if place.name != body.target else 0])
    return None if found is None else (*found, np.array(at, dtype=np.float64))


def _rectangular(part: Plate | Slab) -> bool:
    """Whether its places run from its corner over a whole rectangle."""
    if isinstance(part, Plate):
        return True
    return len(part.outline) == 4 and not part.holes and min(min(one) for one in part.outline) == 0.0
