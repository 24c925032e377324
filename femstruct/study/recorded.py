"""Channel: a recorded history and its peaks; of a stress, the most stressed place of its part."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated, Final

from femstruct.arrays import Floats
from femstruct.reported import Reported
from femstruct.tags import stored_as

NET_FORCE: Final = "net force on "  # begins the names of channels that no study asks for
WITH_WEIGHT: Final = " with weight"
GROUND_WITH_WEIGHT: Final = f"ground force{WITH_WEIGHT}"  # a channel where a limit is of it
DAMPED_FORCE: Final = "with its share of the damping of the modes"


def damped_forces(channels: Iterable[str], outputs: Iterable[str]) -> list[str]:
    """Channels that are forces of springs, foundations, supports, joints or the ground: beside k u and c v they have
    their share of what damps the modes, a damping ratio in proportion to the elastic force.

    Parameters
    ----------
    outputs : Iterable[str]
        Of a basis, "NAME.z".

    Examples
    --------
    >>> damped_forces(["edges force", "edges force x", "ball on off force", "p.z velocity"], ["edges.x", "edges.z"])
    ['edges force', 'edges force x']
    """
    names = {one.rpartition(".")[0] for one in outputs}
    return [one for one in channels if one.removesuffix(" x").removesuffix(" y").removesuffix(" force") in names]


@stored_as("largest stress/1")
@dataclass(frozen=True, eq=False)
class LargestStress:
    """The largest equivalent stress of von Mises that every place of a part ever has, filtered as peaks are.

    places [p, 3] [m], sides : as `femstruct.model.probe.StressPlaces`. largest [p] [Pa], time [p] [s] : when it has it.
    jump, falls : of the largest stress of all, the share by which the cells differ that meet at its place, and the
    share by which it is smaller at the places next to it.
    """

    places: Annotated[Floats, Reported("m", "Where, global axes", along=("place", "direction"))]
    sides: tuple[str, ...]
    largest: Annotated[Floats, Reported("Pa", "Largest equivalent stress of von Mises", along=("place",))]
    time: Annotated[Floats, Reported("s", "When", along=("place",))]
    jump: Annotated[float, Reported("1", "Difference between the cells at the most stressed place, as a share")]
    falls: Annotated[float, Reported("1", "How much smaller it is next to the most stressed place, as a share")]

    @property
    def worst(self) -> int:
        """Number of the most stressed place."""
        return int(self.largest.argmax())

    @property
    def where(self) -> Annotated[str, Reported("1", "The most stressed place")]:
        """The most stressed place in words."""
        x, y, z = self.places[self.worst].round(6) + 0.0  # no -0, no traces of rounding
        side = self.sides[self.worst % len(self.sides)]
        return f"({x:.4g}, {y:.4g}, {z:.4g}) m{f', {side}' if side else ''}"


@stored_as("channel/1")
@dataclass(frozen=True, eq=False)
class Channel:
    """A recorded history: values [nt] at the times of its case, ``case.response.t`` [nt] [s], its unit, and the peaks
    of |values| [unit] in the first impact (as `PeakRule` has it) and in the whole window.

    by_modes : the same peaks of the motion of a point in its true modes, without residual vectors; None for what is no
    such motion, or where there are none; of a stress likewise. stressed : of a stress, which is the largest anywhere in
    its part at each time, where it is largest ever. struck : False where nothing meets: there is no first impact,
    tables have the peak of the whole window alone, and that alone is judged. silent_after : of a low-passed pressure,
    the same peaks if it were silent after the window, where it was held: what follows is not computed. None of others.
    """

    name: str
    values: Floats
    unit: str
    first_impact: float
    whole: float
    by_modes: tuple[float, float] | None = None
    stressed: LargestStress | None = None
    struck: bool = True
    silent_after: tuple[float, float] | None = None
