"""From a checked contact law to the law: restitutions take the masses and speeds of the two ends."""

from __future__ import annotations

from math import inf, sqrt

from femstruct.conventions import GRAVITY
from femstruct.impact.laws.law import Law
from femstruct.language.laws.law import Ends, LawSpec, Site
from femstruct.language.schema_study import BodySpec, StudySpec
from femstruct.language.yaml.build import Builder
from femstruct.language.yaml.reader import Steps


def ends_of(study: StudySpec, a: str, b: str) -> Ends:
    """Mass and meeting speed of two ends. The speed is that of the one body that is placed at the other end and moves
    towards it; not when the other end moves as well."""
    bodies = {name: study.bodies[name] for name in (a, b) if name in study.bodies}
    masses = [body.mass for body in bodies.values()]
    mass = 1.0 / sum(1.0 / one for one in masses) if masses else None
    moving = [name for name, body in bodies.items() if start_speed(body)]
    placed = [name for name in moving if bodies[name].target == (b if name == a else a)]
    speed = start_speed(bodies[placed[0]]) if len(moving) == len(placed) == 1 else None
    radii = [inf if name not in bodies else bodies[name].radius for name in (a, b)]
    first, second = radii
    round_ = first is not None and second is not None and min(first, second) < inf
    return Ends(mass, speed, (first, second) if round_ else None)  # type: ignore[arg-type]


def start_speed(body: BodySpec) -> float:
    """Speed with which a body starts towards what it is placed at [m/s]."""
    return sqrt(2 * GRAVITY * body.drop_height) if body.drop_height is not None else body.speed or 0.0


def law_of(spec: LawSpec, ends: Ends, builder: Builder, steps: Steps, sources: dict[str, str]) -> Law | None:
    """The contact law of a spec that stands at `steps`; None with a mistake noted.

    sources : is given the texts of the files that the law names, by their names.
    """
    return builder.make(steps, lambda: spec.law(Site(ends, steps, builder, sources)))
