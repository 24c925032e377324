"""Springs as they are written."""

from __future__ import annotations

from typing import Literal

from femstruct.language.directions import SixDashpots, SixStiffnesses
from femstruct.language.parts.base import Library, PartSpec, Surroundings
from femstruct.language.yaml.reader import Steps
from femstruct.language.yaml.spec import Text
from femstruct.parts.spring import Spring


class SpringSpec(PartSpec):
    """A spring and dashpot between a place and another, or the ground; several places of a point: one each."""

    type: Literal["spring"]
    between: tuple[Text, Text]
    stiffness: SixStiffnesses = SixStiffnesses()
    damping: SixDashpots = SixDashpots()

    def check(self, steps: Steps, around: Surroundings) -> None:
        first, second = self.between
        check, known = around.check, list(around.points)
        if first == "ground":
            check.wrong((*steps, "between", 0), "'ground'", "a point first", f"write [{second}, ground]")
        else:
            check.known((*steps, "between", 0), first, "point", known)
        if second != "ground":
            check.known((*steps, "between", 1), second, "point", [*known, "ground"])
        if not any((*self.stiffness.model_dump().values(), *self.damping.model_dump().values())):
            check.wrong(steps, "no stiffness and no damping", "one of them", "add stiffness: {z: ...}", of_key=True)

    def build(self, name: str, of: Library) -> Spring:
        first, second = self.between
        k, c = self.stiffness, self.damping
        return Spring(
            name,
            first,
            None if second == "ground" else second,
            (k.x, k.y, k.z, k.rx, k.ry, k.rz),
            (c.x, c.y, c.z, c.rx, c.ry, c.rz),
        )
