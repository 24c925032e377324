"""Loads as they are written: histories of forces and pressures, and walking persons."""

from __future__ import annotations

from collections.abc import Collection
from typing import Annotated, Any

from pydantic import Field, model_validator

from femstruct.files.inputs.columns import read_footstep, read_history
from femstruct.files.inputs.opening import beside
from femstruct.impact.scene.bodies import HalfSine
from femstruct.impact.scene.walking import PACES_HZ, Walk, design_harmonics
from femstruct.language.not_computed import BASE_IN_TIME, GROUND, instead_of
from femstruct.language.study.request import spot_of
from femstruct.language.yaml import (
    Count,
    Duration,
    Frequency,
    Here,
    Instant,
    MassKg,
    Measured,
    PointName,
    Quantity,
    Ratio,
    Refers,
    Spec,
    SurfaceName,
    Text,
    read_by,
    refuse,
    several,
)
from femstruct.study.acting import PlannedLoad, PlannedWalk, Repeat


class HalfSineSpec(Spec):
    """The first half period of a sine."""

    makes = HalfSine
    amplitude: Annotated[Measured, Quantity(("force", "pressure"), which=True)]
    frequency: Frequency

    def given(self) -> dict[str, Any]:
        return {**super().given(), "amplitude": self.amplitude.value}


class WalkingSpec(Spec):
    """A walking person: mass, steps per second, number of steps, and amplitudes of the harmonics of the force over the
    weight, by default those of CCIP-016 for this pace."""

    makes = Walk
    mass: MassKg
    pace: Frequency
    steps: Count
    harmonics: Annotated[list[Ratio], Field(min_length=1, max_length=20)] | None = None

    @model_validator(mode="after")
    def _known_pace(self) -> WalkingSpec:
        low, high = PACES_HZ
        if self.harmonics is None and not low <= self.pace <= high:
            raise refuse(f"a pace of {self.pace:g} Hz", f"{low:g} to {high:g} Hz", "or give its 'harmonics: [..]'")
        if self.steps < 2:
            raise refuse("1 step", "2 or more: the force increases over the first and decreases over the last")
        return self

    def given(self) -> dict[str, Any]:
        harmonics = design_harmonics(self.pace) if self.harmonics is None else tuple(self.harmonics)
        return {**super().given(), "harmonics": harmonics}


class LoadSpec(Spec):
    """A force history on a point's direction or a body, or a pressure history on a surface; once or repeated. Or a
    person who walks along places. A force is positive along its direction: downwards it is negative. A file has two
    columns, time and value; what comes before t = 0 is left out. footstep: a file of the force of a foot, recorded with
    a stiff force plate, positive downwards, at POINT.z."""

    one_of = (("at", "body", "on", "along"), ("half_sine", "file", "walking", "footstep"))
    instead = instead_of(BASE_IN_TIME, "base", "acceleration", "displacement", "velocity")
    needs = (("along", ("walking",)), ("walking", ("along",)), ("footstep", ("at",)))

    at: Text | None = None
    along: Annotated[tuple[PointName, ...] | None, read_by(several(lambda one: one), Text | list[Text])] = None
    walking: WalkingSpec | None = None
    body: Annotated[Text, Refers(goes_with="bodies")] | None = None
    on: SurfaceName | None = None
    half_sine: HalfSineSpec | None = None
    file: Text | None = None
    footstep: Text | None = None
    first: Instant = 0.0
    every: Duration | None = None
    count: Count | None = None

    @property
    def kind(self) -> Any:
        """What it acts on."""
        return "point" if self.at is not None else "body" if self.body is not None else "surface"

    def check_in(self, here: Here, bodies: Collection[str]) -> None:
        """Note what is wrong with it; bodies : names of all, those of arrays too."""
        if self.at is not None:
            if here.at("at").need(
                not self.at.startswith(GROUND), f"'{self.at}'", "a direction of a point", BASE_IN_TIME
            ):
                here.at("at").spot(self.at)
            vertical = self.footstep is None or self.at.endswith(".z")
            here.at("at").need(vertical, f"a footstep along '{self.at}'", "POINT.z: feet press downwards")
        if self.body is not None and self.body not in bodies:
            here.at("body").known(self.body, "body", bodies)
        given, missing = ("count", "every") if self.every is None else ("every", "count")
        here.at(given).need(
            (self.count is None) == (self.every is None),
            f"'{given}' without '{missing}'",
            "both or none",
            f"add '{missing}: ...'",
        )
        if self.half_sine is not None:
            right, got = "pressure" if self.on is not None else "force", self.half_sine.amplitude.dimension
            here.at("half_sine", "amplitude").need(
                got in (None, right), f"a {got}", f"a {right}", "surfaces take Pa, points N"
            )

    def build(self, here: Here, name: str, sources: dict[str, str]) -> PlannedLoad | PlannedWalk | None:
        """The load it describes; None with a mistake noted. sources : is given the text of its file, by its name."""
        repeat = Repeat(self.count or 1, self.every or 0.0, self.first)
        if self.walking is not None:
            return PlannedWalk(name, self.along or (), self.walking.noun(), repeat)
        on = spot_of(self.at) if self.at is not None else self.body or self.on or ""
        if self.half_sine is not None:
            return PlannedLoad(name, on, self.kind, self.half_sine.noun(), repeat)
        if self.footstep is not None:
            step = self.footstep
            record = here.at("footstep").make(lambda: read_footstep(beside(here.tree.file, step), sources))
            return None if record is None else PlannedLoad(name, on, "point", record, repeat, footstep=True)
        what, file = "pressure" if self.on is not None else "force", self.file or ""
        history = here.at("file").make(lambda: read_history(beside(here.tree.file, file), what, sources))
        return None if history is None else PlannedLoad(name, on, self.kind, history, repeat)
