"""Where a structure can be driven and observed, by name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from femstruct.errors import InputError, some_of
from femstruct.language.yaml import near_one
from femstruct.model.meshed import Meshed
from femstruct.model.probe import Point, Probe, StressPlaces, Surface
from femstruct.study.asked import VOLUME_VELOCITY, Spot
from femstruct.study.measured_source import MeasuredSource
from femstruct.study.steady_vibration import Vibration
from femstruct.study.study import Study


@dataclass(frozen=True, eq=False)
class Places:
    """Where a structure can be driven and observed: its named points and surfaces, and its parts, none of a closed
    form."""

    points: Mapping[str, Point]
    surfaces: Mapping[str, Surface]
    parts: Mapping[str, Meshed] = field(default_factory=dict)

    def stresses(self, name: str, asked_by: str) -> StressPlaces:
        """Where a part is stressed. Raises InputError for a name that is no part, or a part without stresses."""
        if name not in self.parts:
            raise InputError(asked_by, got=f"'{name}'", expected=f"a part: {some_of(self.parts) or 'there is none'}")
        return self.parts[name].stresses(1 + max(int(part.nodes.max()) for part in self.parts.values()))

    def point(self, name: str, asked_by: str) -> Point:
        """The single place of that name.

        Raises InputError when there is none, or when the name stands for several places.
        """
        if name in self.points:
            return self.points[name]
        several = [key for key in self.points if key.startswith(f"{name}.")]
        raise InputError(
            asked_by,
            got=f"'{name}'" + (f", which has {len(several)} places" if several else ""),
            expected=f"one of {some_of(several or sorted(self.points)) or 'no points: the structure has none'}",
            do="name one place" if several else near_one(name, self.points),
        )

    def pushed(self, one: Vibration) -> Probe | None:
        """Where an excitation acts; None for a base, with which all moves that stands on the ground.

        Raises InputError for a point or a surface that is not there.
        """
        if one.kind == "base":
            return None
        if isinstance(one.on, Spot):
            return self.point(one.on.name, f"vibration.{one.name}.at").probe(one.on.what)
        if one.on not in self.surfaces:
            expected = f"a surface: {some_of(self.surfaces) or 'there is none'}"
            raise InputError(f"vibration.{one.name}.on", got=f"'{one.on}'", expected=expected)
        return self.surfaces[one.on].pressure()

    def contacts(self, one: MeasuredSource) -> list[Probe]:
        """Where a measured source stands, contact by contact. Raises InputError for a point that is not there, and for
        a contact that is named twice."""
        where = f"sources.{one.name}.at"
        names = [(place, spot.what) for spot in one.at for place in self.of(spot.name, where)]
        twice = next((f"{place}.{what}" for i, (place, what) in enumerate(names) if (place, what) in names[:i]), "")
        if twice:
            raise InputError(where, got=f"'{twice}' twice", expected="each contact once", do="remove one of them")
        return [self.point(place, where).probe(what) for place, what in names]

    def of(self, name: str, asked_by: str) -> tuple[str, ...]:
        """The names of all places of a point, in their order.

        Raises InputError when there is no such point.
        """
        several = [place for place in self.points if place.startswith(f"{name}.")]
        return tuple(several) if several and name not in self.points else (self.point(name, asked_by).name,)


def pushed_otherwise(study: Study, places: Places) -> dict[str, Probe]:
    """Where the air of two-way rooms, requests, measured sources and vibrations push a structure, by address."""
    found: dict[str, Probe] = {}
    for plan in study.rooms:
        if plan.coupling == "two-way":
            for number, (wall, name) in enumerate(plan.moved):
                if name in places.surfaces:
                    at = f" on {wall} by {name}" if number else ""
                    found[f"air of {plan.name}{at}"] = places.surfaces[name].pressure()
    for request in study.frf:
        # a source in a room pushes surfaces: what its response lacks at rest is what a force there would lack
        end, spot = (
            ("drive", request.drive) if request.drive.what != VOLUME_VELOCITY else ("response", request.response)
        )
        asked_by = f"frf.{request.name}.{end}" if request.name else f"--{end}"
        found[str(spot)] = places.point(spot.name, asked_by).probe(spot.what)
    for source in study.sources:
        found |= {f"source {source.name} {i}": probe for i, probe in enumerate(places.contacts(source), start=1)}
    excited = {f"vibration {one.name}": places.pushed(one) for one in study.vibration}
    return found | {address: probe for address, probe in excited.items() if probe is not None}
