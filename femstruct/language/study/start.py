"""How a structure starts, as it is written."""

from __future__ import annotations

from typing import Annotated, Any

from femstruct.language.not_computed import BASE_IN_TIME, FALLING_PARTS, GROUND, instead_of
from femstruct.language.study.request import spot_of
from femstruct.language.yaml import Here, Measured, Quantity, Refers, Spec, Speed, Text
from femstruct.study.acting import InitialMotion, RigidMotion

Spin = Annotated[float, Quantity(("angular speed",))]


class RigidMotionSpec(Spec):
    """A structure that moves as a whole."""

    makes = RigidMotion
    instead = instead_of(FALLING_PARTS, "drop_height", "falls", "gravity")
    about: Annotated[Text, Refers()]
    velocity: tuple[Speed, Speed, Speed] = (0.0, 0.0, 0.0)
    spin: tuple[Spin, Spin, Spin] = (0.0, 0.0, 0.0)


class InitialSpec(Spec):
    """Start velocities of points, or of the whole structure."""

    at_most_one_of = (("velocity", "rigid"),)

    makes = InitialMotion
    instead = (
        *instead_of(FALLING_PARTS, "drop_height", "falls", "gravity"),
        *instead_of(BASE_IN_TIME, "base", "ground", "acceleration"),
    )
    velocity: dict[str, Annotated[Measured, Quantity(("speed", "angular speed"), which=True)]] | None = None
    rigid: RigidMotionSpec | None = None

    def check(self, here: Here) -> None:
        for address, measured in (self.velocity or {}).items():
            there, turns = here.at("velocity", address), address.rpartition(".")[2] in ("rx", "ry", "rz")
            if not there.need(
                not address.startswith(GROUND), f"'{address}'", "a direction of a point", BASE_IN_TIME, of_key=True
            ):
                continue
            there.spot(address, of_key=True)
            right, unit = ("angular speed", "rad/s") if turns else ("speed", "m/s")
            there.need(measured.dimension in (None, right), f"a {measured.dimension}", unit)
        if self.rigid is not None:
            here.at("rigid", "about").place(self.rigid.about)
            moves, do = any((*self.rigid.velocity, *self.rigid.spin)), "add 'velocity: [0, 0, -1 m/s]'"
            here.at("rigid").need(moves, "no velocity and no spin", "a motion", do)

    def given(self) -> dict[str, Any]:
        velocities = tuple((spot_of(address), one.value) for address, one in (self.velocity or {}).items())
        return {"velocities": velocities, "rigid": super().given()["rigid"]}
