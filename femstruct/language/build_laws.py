"""From a checked contact law to the law: restitutions take the masses and speeds of the two ends."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, sqrt

from femstruct.conventions import GRAVITY
from femstruct.impact.factored import Cubic, HuntCrossley, LankaraniNikravesh, Tabulated
from femstruct.impact.laws import Hertz, Law, Linear, Stop
from femstruct.impact.restitution import dissipation_for
from femstruct.language.build import Builder
from femstruct.language.opening import beside
from femstruct.language.reader import Steps, dotted
from femstruct.language.schema_laws import (
    CubicSpec,
    HertzSpec,
    HuntCrossleySpec,
    LankaraniNikraveshSpec,
    LawSpec,
    LinearSpec,
    StopSpec,
    TableSpec,
)
from femstruct.language.schema_study import BodySpec, StudySpec
from femstruct.language.tables import read_curve


@dataclass(frozen=True)
class Ends:
    """What a restitution needs to know of two ends: the mass that meets [kg], that of a body alone or the reduced mass
    of two, None without a body; the speed they meet with [m/s], None where the file does not tell it; their radii [m],
    infinite for what is no body, None where a body has none."""

    mass: float | None
    speed: float | None
    radii: tuple[float, float] | None


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
    return builder.make(steps, lambda: _law(spec, ends, builder, steps, sources))


def _law(spec: LawSpec, ends: Ends, builder: Builder, steps: Steps, sources: dict[str, str]) -> Law | None:
    if isinstance(spec, HertzSpec):
        stiffness = spec.stiffness
        if spec.E is not None and spec.nu is not None:
            radii = ends.radii
            if spec.radius is not None:
                first, *second = spec.radius
                radii = (first, second[0] if second else inf)
            if radii is None:
                got, do = "a hertz law without a radius", "add 'radius: 5 mm', or the radius of the body"
                builder.mistakes.add(builder.tree.position(steps), dotted(steps), got=got, expected="one", do=do)
                return None
            stiffness = Hertz.of_spheres(radii, spec.E, spec.nu).stiffness
        assert stiffness is not None
        return Hertz(stiffness, spec.damping, spec.tensile)
    if isinstance(spec, LinearSpec):
        if spec.restitution is None:
            assert spec.stiffness is not None
            return Linear(spec.stiffness, spec.damping, spec.tensile)
        if ends.mass is None:
            _refuse(builder, steps, "a restitution between two ends without a body", "stiffness and damping")
            return None
        return Linear.returning(spec.restitution, ends.mass, spec.duration, spec.stiffness, spec.tensile)
    if isinstance(spec, StopSpec):
        return Stop(spec.stiffness, spec.damping, spec.tensile)
    speed = spec.at_speed or ends.speed
    if spec.restitution is not None and speed is None:
        _refuse(builder, steps, "a restitution without a meeting speed", "at_speed", "add 'at_speed: 2 m/s'")
        return None
    if isinstance(spec, LankaraniNikraveshSpec):
        assert speed is not None
        return LankaraniNikravesh(spec.stiffness, spec.restitution, speed, spec.exponent, spec.tensile)
    dissipation = spec.dissipation
    if spec.restitution is not None and speed is not None:
        dissipation = dissipation_for(spec.restitution, speed)
    if isinstance(spec, HuntCrossleySpec):
        return HuntCrossley(spec.stiffness, spec.exponent, dissipation, spec.tensile)
    if isinstance(spec, CubicSpec):
        return Cubic(spec.stiffness, spec.cubic, dissipation, spec.tensile)
    curve = _curve(spec, builder, steps, sources)
    return None if curve is None else replace(curve, dissipation=dissipation, tensile=spec.tensile)


def _refuse(builder: Builder, steps: Steps, got: str, expected: str, do: str = "") -> None:
    where = (*steps, "restitution")
    builder.mistakes.add(builder.tree.position(where), dotted(where), got=got, expected=expected, do=do)


def _curve(spec: TableSpec, builder: Builder, steps: Steps, sources: dict[str, str]) -> Tabulated | None:
    if spec.curve is not None:
        points = spec.curve
        return builder.make(
            (*steps, "curve"),
            lambda: Tabulated([d for d, _ in points], [f for _, f in points]),  # type: ignore[arg-type]
        )
    where = (*steps, "file")
    path = builder.make(where, lambda: beside(builder.tree.file, spec.file or ""))
    if path is None:
        return None
    return read_curve(path, builder.tree.position(where), dotted(where), builder.mistakes, sources)
