"""Joints as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from femstruct.language.model.directions import SixStiffnesses
from femstruct.language.parts.part import MESHED
from femstruct.language.yaml import Here, Length, Measured, Quantity, Refers, Spec, Text
from femstruct.model.structure import Joint

Slip = Annotated[Measured, Quantity(("stiffness/length", "stiffness/area"), least=0.0, which=True)]
PartName = Annotated[Text, Refers("part", goes_with="parts")]


class JointSpec(Spec):
    """Where two parts touch they move together; directions with a stiffness are springs instead, one at every
    pair of joined nodes. sets: of parts that are meshes, which set is joined. reach: nodes that far from each other
    are joined by rigid arms. slip: of a sliding joint, what resists along the line, per length, or per area of what
    touches, with its width."""

    makes = Joint
    only_written = ("connect", "width")
    connect: tuple[PartName, PartName]
    kind: Literal["rigid", "pinned", "sliding"] = "rigid"
    stiffness: SixStiffnesses = SixStiffnesses()
    sets: dict[str, Text] = Field(default_factory=dict)
    reach: Length | None = None
    slip: Slip | None = None
    width: Length | None = None

    def check(self, here: Here) -> None:
        first, second = self.connect
        for name in self.sets:
            here.at("sets", name).known(name, MESHED)
            here.at("sets", name).need(name in self.connect, f"'{name}'", f"{first} or {second}", of_key=True)
        here.at("connect").need(first != second, f"'{first}' twice", "two different parts")
        here.at("slip").need(
            self.slip is None or self.kind == "sliding", f"a slip of a {self.kind} joint", "kind: sliding"
        )
        per_area = self.slip is not None and self.slip.dimension == "stiffness/area"
        here.at("slip" if per_area else "width").need(
            per_area == (self.width is not None),
            "a slip per area and no width" if per_area else "a width and no slip per area",
            "slip in N/m^3 and width, of what touches, or slip in N/m^2",
            of_key=True,
        )
        here.at("stiffness").need(
            not self.stiffness.model_fields_set or self.kind != "sliding",
            "springs of a sliding joint",
            "no stiffness",
            "write the stiffness along the line as 'slip', per length",
        )
        do = "leave the direction out: it is rigid then; 'kind: pinned' lets the parts turn"
        for axis in sorted(self.stiffness.model_fields_set):
            here.at("stiffness", axis).need(getattr(self.stiffness, axis), "0", "a positive stiffness", do)

    def given(self) -> dict[str, Any]:
        a, b = self.connect
        stiffness = {axis: k for axis, k in self.stiffness.given().items() if k}
        slip = 0.0 if self.slip is None else self.slip.value * (self.width or 1.0)
        return {**super().given(), "a": a, "b": b, "stiffness": stiffness, "slip": slip}
