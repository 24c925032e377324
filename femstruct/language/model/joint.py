"""Joints as they are written."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from femstruct.conventions import DIRECTIONS
from femstruct.language.parts.part import MESHED
from femstruct.language.yaml import Here, Length, Measured, Quantity, Refers, Spec, Text
from femstruct.model.structure import Joint

Slip = Annotated[Measured, Quantity(("stiffness/length", "stiffness/area"), least=0.0, which=True)]
Sprung = Annotated[Measured, Quantity(("stiffness", "stiffness/length"), least=0.0, which=True)]
Turned = Annotated[Measured, Quantity(("rotational stiffness", "rotational stiffness/length"), least=0.0, which=True)]
PartName = Annotated[Text, Refers("part", goes_with="parts")]


class JointStiffnessSpec(Spec):
    """Stiffness by direction, global axes: of the springs at each pair of joined nodes, or per length of the lines on
    which the parts touch."""

    x: Sprung | None = None
    y: Sprung | None = None
    z: Sprung | None = None
    rx: Turned | None = None
    ry: Turned | None = None
    rz: Turned | None = None

    def written(self) -> dict[str, Measured]:
        return {axis: one for axis in DIRECTIONS if (one := getattr(self, axis)) is not None}

    @property
    def spread(self) -> dict[str, bool]:
        """Whether each is per length."""
        return {axis: (one.dimension or "").endswith("/length") for axis, one in self.written().items()}


class JointSpec(Spec):
    """Where two parts touch they move together; directions with a stiffness are springs instead, one at every
    pair of joined nodes, or spread along the lines on which the parts touch where it is per length. sets: of parts that
    are meshes, which set is joined. reach: nodes that far from each other are joined by rigid arms. slip: of a sliding
    joint, what resists along the line, per length, or per area of what touches, with its width."""

    makes = Joint
    only_written = ("connect", "width")
    connect: tuple[PartName, PartName]
    kind: Literal["rigid", "pinned", "sliding"] = "rigid"
    stiffness: JointStiffnessSpec = JointStiffnessSpec()
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
            not self.stiffness.written() or self.kind != "sliding",
            "springs of a sliding joint",
            "no stiffness",
            "write the stiffness along the line as 'slip', per length",
        )
        do = "leave the direction out: it is rigid then; 'kind: pinned' lets the parts turn"
        spread = self.stiffness.spread
        for axis, one in sorted(self.stiffness.written().items()):
            here.at("stiffness", axis).need(one.value, "0", "a positive stiffness", do)
            here.at("stiffness", axis).need(
                spread[axis] or not any(spread.values()),
                "a stiffness of springs at pairs of nodes beside one per length",
                f"{'N*m/m' if axis.startswith('r') else 'N/m^2'}, per length, as the others",
            )

    def given(self) -> dict[str, Any]:
        a, b = self.connect
        stiffness = {axis: one.value for axis, one in self.stiffness.written().items()}
        per = "length" if any(self.stiffness.spread.values()) else "pair"
        slip = 0.0 if self.slip is None else self.slip.value * (self.width or 1.0)
        return {**super().given(), "a": a, "b": b, "stiffness": stiffness, "slip": slip, "per": per}
