"""The equivalent stress of a part over time: largest anywhere at every sample, and largest ever at every place."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Final, NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.conventions import GRAVITY
from femstruct.elements.stresses import von_mises
from femstruct.errors import Finding, some_of
from femstruct.impact.result.response import Response
from femstruct.modal.statics import UP
from femstruct.modal.steady.steady_stresses import Amount
from femstruct.model.materials.orthotropic import Orthotropic
from femstruct.model.probe import StressPlaces
from femstruct.model.structure import Structure
from femstruct.study.recorded import LargestStress

AT_ONCE: Final = 4_000_000
"""Stresses that are evaluated at once, 32 MB: of all places at as many samples as that makes."""
UNEVEN: Final = 0.2
"""Share of the largest stress by which the cells at its place may differ, and by which it may fall to the next ones."""
AROUND: Final = 4  # places next to one in a grid of cells
SAME: Final = 1e-9  # of the extent of a part: ends of bars that meet are one place


class Walked(NamedTuple):
    """history [nt] : the largest equivalent stress anywhere. largest [p], sample [p] : the largest ever, and when."""

    history: Floats
    largest: Floats
    sample: Integers


def walked(places: StressPlaces, shapes: Floats, q: Floats) -> Walked:
    """The equivalent stress of von Mises over time.

    shapes [node, 7, k] : mass-normalised; q [k, nt] : modal coordinates.

    Notes
    -----
    Every place at every sample is looked at and none is kept: memory does not grow with their product.
    """
    rows = places.of(shapes).reshape(-1, shapes.shape[2])
    count, components, samples = len(places.places), len(places.components), q.shape[1]
    history, largest, sample = np.empty(samples), np.full(count, -1.0), np.zeros(count, np.int64)
    step = max(1, AT_ONCE // max(len(rows), 1))
    for first in range(0, samples, step):
        found = (rows @ q[:, first : first + step]).reshape(count, components, -1)
        equivalent = von_mises(found, places.components)
        history[first : first + step] = equivalent.max(axis=0)
        then = equivalent.argmax(axis=1)
        peak = equivalent[np.arange(count), then]
        higher = peak > largest
        largest[higher], sample[higher] = peak[higher], first + then[higher]
    return Walked(history, largest, sample)


def largest_stress(places: StressPlaces, response: Response, q: Floats) -> tuple[Floats, LargestStress]:
    """The largest equivalent stress anywhere [nt] [Pa], and at every place the largest ever.

    q [k, nt] : the modal coordinates of the response, filtered or not.
    """
    found = walked(places, response.basis.shapes, q)
    times = response.t[found.sample]
    then = q[:, found.sample[int(found.largest.argmax())]]
    return found.history, judged(places, response.basis.shapes, found.largest, _at(places, then), times)


def stressed_at(places: StressPlaces, place: int, response: Response, q: Floats) -> LargestStress:
    """The largest equivalent stress of one place alone, which counts for the most stressed one, and how well the mesh
    resolves it there. q [k, nt] : the modal coordinates of the response."""
    shapes = response.basis.shapes
    own = von_mises(places.at(place).of(shapes) @ q, places.components)[0]
    sample, largest = int(own.argmax()), np.zeros(len(places.places))
    largest[place] = own[sample]
    times = np.where(largest > 0.0, response.t[sample], 0.0)
    return judged(places, shapes, largest, _at(places, q[:, sample]), times)


def stress_at_rest(places: StressPlaces, displacement: Floats, weight: bool = False) -> LargestStress:
    """The equivalent stress at every place of a structure at rest. displacement [n_nodes, 7] : of its nodes. weight :
    whether it weighs."""
    shapes, q = displacement[:, :, None], np.ones((1, 1))
    stresses = places.of(shapes)
    if weight and places.carried is not None:
        stresses = stresses + GRAVITY * places.carried[:, :, UP, None]
    largest: Floats = von_mises(stresses, places.components)[:, 0]
    return judged(places, shapes, largest, _at(places, q[:, 0]))


def _at(places: StressPlaces, q: Floats) -> Amount:
    """The equivalent stress at one instant, from its modal coordinates [k]."""
    return lambda stresses: von_mises(stresses @ q, places.components)


def judged(
    places: StressPlaces, shapes: Floats, largest: Floats, amount: Amount, times: Floats | None = None
) -> LargestStress:
    """Where a part is stressed most, and how well the mesh resolves it there.

    largest [p] : equivalent stresses [Pa]. amount : how that of the most stressed place follows from the shapes; it is
    asked of the places beside, too. times [p] : when each was largest [s], 0 where that means nothing.

    Bars are judged by the length of their waves alone: moments that are linear along a bar are exact at its ends,
    however steep, and no point of a beam is stressed infinitely.
    """
    worst = int(largest.argmax())
    next_to = _neighbours(places, worst)
    peak = float(largest[worst]) or 1.0
    around = places.around(worst)
    jump = 0.0 if around is None else float(np.ptp(amount(around.of(shapes)))) / peak
    uneven = places.carried is None and len(next_to)
    falls = 1.0 - float(amount(places.of(shapes)[next_to]).mean()) / peak if uneven else 0.0
    return LargestStress(
        places.places, places.sides, largest, np.zeros(len(largest)) if times is None else times, jump, falls
    )


def _neighbours(places: StressPlaces, place: int) -> Integers:
    """Numbers of the nearest other places on the same side, as many as a grid has around one."""
    alike = np.arange(place % len(places.sides), len(places.places), len(places.sides))
    apart = np.linalg.norm(places.places[alike] - places.places[place], axis=1)
    other = apart > SAME * float(np.ptp(places.places, axis=0).max())
    found: Integers = alike[other][np.argsort(apart[other], kind="stable")[:AROUND]]
    return found


def orthotropic_findings(structure: object, names: Iterable[str]) -> Iterator[Finding]:
    """Parts of these names whose material has no equivalent stress that tells its strength. structure : with parts, or
    in closed form."""
    parts = structure.parts if isinstance(structure, Structure) else ()
    wanted = set(names)
    for part in parts:
        made_of = [one.name for one in part.materials() if isinstance(one, Orthotropic)]
        if part.name in wanted and made_of:
            yield Finding(
                "stress-of-orthotropic",
                f"{part.name}: do not judge its strength by the stress of von Mises, which supposes a metal: "
                f"{some_of(made_of)} is orthotropic, with strengths of its own along and across its axes. Look at "
                f"xx, yy and xy along them: 'frf --response {part.name}.stress' prints them where it is stressed most",
            )


def uneven(found: LargestStress) -> float:
    """The share of the largest stress that the mesh leaves open; 0 where that is no more than allowed."""
    share = max(found.jump, found.falls)
    return share if share > UNEVEN else 0.0


def stress_findings(stresses: Mapping[str, LargestStress | None]) -> Iterator[Finding]:
    """Largest stresses that the mesh does not resolve, by what they are called."""
    for name, found in stresses.items():
        if found is None or not uneven(found):
            continue
        how = (
            f"Between the cells that meet there it jumps by {100 * found.jump:.0f} %"
            if found.jump > found.falls
            else f"One cell further it is {100 * found.falls:.0f} % smaller"
        )
        yield Finding(
            "stress-uneven",
            f"{name}: do not quote its peak of {1e-6 * found.largest.max():.4g} MPa at {found.where}. {how}, more than "
            f"the {100 * UNEVEN:.0f} % allowed: the mesh does not resolve it. Use a finer mesh. If the stress then "
            "grows, it is infinite in the model, at a force or support on a point (use the nodes of a set or a patch) "
            "or at a re-entrant corner or clamped edge (quote the stress one thickness away)",
            {"jump": found.jump, "falls": found.falls, "allowed": UNEVEN, "peak_pa": float(found.largest.max())},
        )
