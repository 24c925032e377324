"""Open air beside a surface as it is written."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Final

import numpy as np

from acoustics.fields.half_space import HalfSpace
from acoustics.fields.shaped import ShapedRoom
from femstruct.language.rooms.room import Asked, RoomSpec
from femstruct.language.yaml import FREQUENCY, Frequency, Here, SurfaceName, read_by, refuse, several
from femstruct.study.asked import RoomPlan

_CLOSED: Final = (
    "size", "mesh", "ceiling", "walls", "modes", "at", "losses", "form", "coupling", "leak", "levels", "animate",
    "surfaces",
)  # fmt: skip


class HalfSpaceSpec(RoomSpec):
    """Open air in place of a room, and its receivers.

    above, below: the surface in an infinite rigid baffle beside which it is. Receivers are measured from the centre of
    the surface, global axes. The own sound of bodies with a radius there is computed too.
    directivity: frequencies at which it is drawn where open air sends its sound, the loudest when left out.
    """

    one_of = (("under", "above", "below"),)
    signs = ("above", "below")
    is_open: ClassVar[bool] = True
    refused = (*_CLOSED, "under")

    above: SurfaceName | None = None
    below: SurfaceName | None = None
    directivity: Annotated[tuple[float, ...], read_by(several(FREQUENCY.read), Frequency | list[Frequency])] = ()

    @classmethod
    def refuse_keys(cls, given: Mapping[str, Any]) -> None:
        side = "above" if "above" in given else "below"
        for key in [key for key in _CLOSED if key in given][:1]:
            expected = f"air and receivers: there is no room {side} a surface"
            raise refuse(f"'{key}' beside '{side}'", expected, "write 'under' for a room")

    def check_in(self, here: Here, name: str, asked: Asked) -> None:
        """A directivity is of something that radiates, at frequencies that the sampling has."""
        super().check_in(here, name, asked)
        if self.directivity:
            there, moves = here.at("directivity"), asked.time is not None or f"{name}.power" in asked.powers
            there.need(
                moves,
                "a directivity of nothing that moves",
                "a simulation or a power",
                f"add 'time:', or a response of 'kind: power' to '{name}.power'",
            )
            if asked.time is not None:
                asked.time.carries(there, max(self.directivity))

    def check_receiver(self, here: Here, place: tuple[float, float, float]) -> None:
        side = "below" if self.above is None else "above"
        here.need(
            (place[2] > 0) == (self.above is not None),
            f"{list(place)} m",
            f"a point {side} the surface",
            "measure from the surface's centre, z up",
        )

    def build(self, here: Here, name: str, sources: dict[str, str], shaped: dict[str, ShapedRoom]) -> RoomPlan:
        space = HalfSpace(self.air.noun(), np.array([0.0, 0.0, 1.0 if self.above else -1.0]))
        surface = self.above or self.below or ""
        return RoomPlan(name, space, surface, tuple(self.heard_at()), directivity=self.directivity)
