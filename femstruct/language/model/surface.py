"""Surfaces as they are written."""

from __future__ import annotations

from typing import Annotated

from femstruct.language.model.region import Region, RegionSpec
from femstruct.language.yaml import Here, Refers, Spec, Text
from femstruct.model.region import Facing
from femstruct.model.structure import SurfaceOn


class SurfaceSpec(Spec):
    """A named side of a region of a plate, or of a set or all of a shell. side: above or below; of a wall x, -x, y or
    -y, the global direction in which it faces."""

    makes = SurfaceOn
    on: Annotated[Text, Refers("plate or shell")]
    side: Facing = "above"
    region: Region = RegionSpec()

    def check(self, here: Here) -> None:
        do = "use whole or {rectangle: [2.5, 4], at: [1.25, 2]}, its sides and its centre"
        here.at("region").need(not self.region.is_line, "a rim or line", "an area", do)
