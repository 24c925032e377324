"""Springs as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from femstruct.language.model.directions import SixDashpots, SixStiffnesses
from femstruct.language.parts.part import PartSpec
from femstruct.language.yaml import Here, Refers, Text
from femstruct.parts.spring import Spring

End = Annotated[Text, Refers()]


class SpringSpec(PartSpec):
    """A spring and dashpot between a place and another, or the ground; several places of a point: one each."""

    makes = Spring
    type: Literal["spring"]
    between: tuple[End, End] = Field(description="a point, and another or ground")
    stiffness: SixStiffnesses = SixStiffnesses()
    damping: SixDashpots = SixDashpots()

    def check(self, here: Here) -> None:
        first, second = self.between
        there = here.at("between", 0)
        if there.need(first != "ground", "'ground'", "a point first", f"write [{second}, ground]"):
            there.known(first, "point")
        here.at("between", 1).known(second, "point", ["ground"])
        here.at("between").need(first != second, f"'{first}' twice", "two different places")
        here.need(
            any((*self.stiffness.noun(), *self.damping.noun())),
            "no stiffness and no damping",
            "one of them",
            "add stiffness: {z: ...}",
            of_key=True,
        )

    def given(self) -> dict[str, Any]:
        values = super().given()
        first, second = values.pop("between")
        return {**values, "a": first, "b": None if second == "ground" else second}
