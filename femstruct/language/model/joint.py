"""Joints as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from femstruct.language.model.directions import SixStiffnesses
from femstruct.language.yaml import Here, Refers, Spec, Text
from femstruct.model.structure import Joint

PartName = Annotated[Text, Refers("part", goes_with="parts")]


class JointSpec(Spec):
    """Where two parts touch they move together; directions with a stiffness are springs instead."""

    makes = Joint
    connect: tuple[PartName, PartName]
    kind: Literal["rigid", "pinned"] = "rigid"
    stiffness: SixStiffnesses = SixStiffnesses()

    def check(self, here: Here) -> None:
        first, second = self.connect
        here.at("connect").need(first != second, f"'{first}' twice", "two different parts")
        do = "leave the direction out: it is rigid then; 'kind: pinned' lets the parts turn"
        for axis in sorted(self.stiffness.model_fields_set):
            here.at("stiffness", axis).need(getattr(self.stiffness, axis), "0", "a positive stiffness", do)

    def given(self) -> dict[str, Any]:
        a, b = self.connect
        stiffness = {axis: k for axis, k in self.stiffness.given().items() if k}
        return {"a": a, "b": b, "kind": self.kind, "stiffness": stiffness}
