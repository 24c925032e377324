"""From checked specs to the nouns: a structure with its damping, and a study."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from math import sqrt
from pathlib import Path
from typing import Any, TypeVar

from acoustics.air import Air
from acoustics.errors import AcousticsError
from acoustics.room import Losses, Receiver, Room, losses_from_beta, losses_from_loss_factor, losses_from_t60
from femstruct.conventions import GRAVITY
from femstruct.errors import FemstructError
from femstruct.impact.bodies import HalfSine, Table
from femstruct.impact.laws import Hertz, Law, Linear, Stop
from femstruct.language.reader import Mistakes, Steps, Tree, dotted
from femstruct.language.schema_model import (
    BeamSpec,
    BoxSpec,
    CircleSpec,
    ConstantsSpec,
    FoundationSpec,
    FrameSpec,
    GivenModesSpec,
    ISpec,
    MassSpec,
    ModelSpec,
    OscillatorSpec,
    PlateSpec,
    PointSpec,
    RectangleSpec,
    RegionSpec,
    RodSpec,
    SpringSpec,
    TubeSpec,
)
from femstruct.language.schema_study import SIDES, BodySpec, HertzSpec, LinearSpec, LoadSpec, RoomSpec, StudySpec
from femstruct.language.tables import read_history
from femstruct.modal.damping import Damping, FromMaterials, LossFactor, ModeDamping, Ratio, Rayleigh
from femstruct.model.material import Material
from femstruct.model.parts import (
    Foundation,
    Frame,
    Joint,
    Mass,
    Part,
    PlaceOn,
    Plate,
    Region,
    Spring,
    Structure,
    Support,
    SurfaceOn,
)
from femstruct.model.section import Section, box, circle, i_section, rectangle, tube
from femstruct.study.study import (
    BeamModel,
    Extent,
    FrfRequest,
    InitialMotion,
    ModesModel,
    NoStructure,
    OscillatorModel,
    PeakRule,
    PlacedBody,
    PlannedContact,
    PlannedLink,
    PlannedLoad,
    Record,
    RigidMotion,
    RodModel,
    RoomPlan,
    Spot,
    StructureModel,
    Study,
    TimePlan,
)

T = TypeVar("T")


class Builder:
    """Makes nouns, and turns what their constructors refuse into mistakes with positions."""

    def __init__(self, tree: Tree, mistakes: Mistakes) -> None:
        self.tree, self.mistakes = tree, mistakes

    def make(self, steps: Steps, maker: Callable[[], T]) -> T | None:
        """What `maker` makes, or None with the refusal noted at a path."""
        try:
            return maker()
        except (FemstructError, AcousticsError) as error:
            path = dotted(steps)
            inner = error.where.removeprefix(f"{path}.")
            if inner != error.where and (*steps, inner) in self.tree.keys:
                steps, path = (*steps, inner), f"{path}.{inner}"
            got = error.got or str(error)
            self.mistakes.add(self.tree.position(steps), path, got=got, expected=error.expected, do=error.do)
            return None

    def each(self, group: str, specs: Mapping[str, Any], maker: Callable[[str, Any], T | None]) -> dict[str, T]:
        """One noun for every name of a group; those refused are left out."""
        made = {name: self.make((group, name), partial(maker, name, spec)) for name, spec in specs.items()}
        return {name: noun for name, noun in made.items() if noun is not None}


def structure_of(model: ModelSpec, title: str, tree: Tree, mistakes: Mistakes) -> StructureModel | None:
    """The structure of a checked model file; None with mistakes noted."""
    builder = Builder(tree, mistakes)
    if model.structure is not None:
        return builder.make(("structure",), lambda: _closed_form(model))
    materials = builder.each("materials", model.materials, lambda n, s: Material(n, s.E, s.nu, s.rho, s.loss_factor))
    sections = builder.each("sections", model.sections, _section)
    if mistakes.lines:
        return None

    def part(name: str, spec: object) -> Part:
        return _part(name, spec, materials, sections)

    parts: dict[str, Part] = builder.each("parts", model.parts, part)
    points = {name: _place(name, spec, model) for name, spec in model.points.items()}
    surfaces = (SurfaceOn(n, s.on, s.side, _region(s.region)) for n, s in model.surfaces.items())
    supports = (Support(n, s.fix, s.on, s.edge, s.line, s.at) for n, s in model.supports.items())
    joints = (
        Joint(n, *s.connect, s.kind, {axis: value for axis, value in s.stiffness.model_dump().items() if value})
        for n, s in model.joints.items()
    )
    return Structure(
        title, tuple(parts.values()), tuple(joints), tuple(points.values()), tuple(surfaces), tuple(supports)
    )


def damping_of(model: ModelSpec, tree: Tree, mistakes: Mistakes) -> Damping | None:
    """The damping of a checked model file; without a general law there is none."""
    spec = model.damping
    base: Ratio | LossFactor | Rayleigh | FromMaterials = Ratio(0.0)
    if spec.ratio is not None:
        base = Ratio(spec.ratio)
    elif spec.loss_factor is not None:
        base = LossFactor(spec.loss_factor)
    elif spec.rayleigh is not None:
        base = Rayleigh(spec.rayleigh.alpha, spec.rayleigh.beta)
    elif spec.source is not None:
        base = FromMaterials()

    def make() -> Damping:
        modes = tuple(
            ModeDamping(int(number), near_hz=one.near, ratio=one.ratio, loss_factor=one.loss_factor)
            for number, one in spec.modes.items()
        )
        return Damping(base, modes)

    return Builder(tree, mistakes).make(("damping",), make)


def _section(name: str, spec: Any) -> Section:
    if isinstance(spec, RectangleSpec):
        return rectangle(name, spec.width, spec.height)
    if isinstance(spec, CircleSpec):
        return circle(name, spec.diameter)
    if isinstance(spec, TubeSpec):
        return tube(name, spec.diameter, spec.thickness)
    if isinstance(spec, BoxSpec):
        return box(name, spec.width, spec.height, spec.thickness)
    if isinstance(spec, ISpec):
        return i_section(name, spec.width, spec.height, spec.web, spec.flange)
    given: ConstantsSpec = spec
    return Section(name, given.A, given.Iy, given.Iz, given.J, given.ky, given.kz)


def _region(spec: RegionSpec) -> Region:
    if spec.rim is not None:
        return Region("rim", spec.rim, spec.at)
    if spec.rectangle is not None:
        return Region("rectangle", spec.rectangle, spec.at)
    if spec.line is not None:
        return Region("line", line=spec.line)
    return Region("whole")


def _part(name: str, spec: Any, materials: Mapping[str, Material], sections: Mapping[str, Section]) -> Part:
    if isinstance(spec, PlateSpec):
        return Plate(
            name,
            materials[spec.material],
            spec.thickness,
            spec.origin,
            spec.size,
            spec.mesh,
            spec.element,
            spec.normal,
            spec.x_direction,
        )
    if isinstance(spec, FrameSpec):
        return Frame(
            name,
            materials[spec.material],
            sections[spec.section],
            tuple(tuple(line) for line in spec.lines),
            spec.mesh,
            spec.orientation,
            spec.element,
            spec.offsets.start,
            spec.offsets.end,
        )
    if isinstance(spec, FoundationSpec):
        stiffness = spec.stiffness
        return Foundation(
            name, spec.on, _region(spec.region), stiffness.normal.value, stiffness.shear.value, spec.loss_factor
        )
    if isinstance(spec, SpringSpec):
        first, second = spec.between
        k, c = spec.stiffness, spec.damping
        return Spring(
            name,
            first,
            None if second == "ground" else second,
            (k.x, k.y, k.z, k.rx, k.ry, k.rz),
            (c.x, c.y, c.z, c.rx, c.ry, c.rz),
        )
    mass: MassSpec = spec
    if mass.at is not None:
        return Mass(name, mass.mass.value, at=mass.at)
    per = {"mass/length": "length", "mass/area": "area"}.get(mass.mass.dimension or "mass", "total")
    region = _region(mass.region) if mass.region is not None else Region("whole")
    return Mass(name, mass.mass.value, on=mass.on, region=region, per=per)  # type: ignore[arg-type]


def _place(name: str, spec: PointSpec, model: ModelSpec) -> PlaceOn:
    on = spec.on or ""
    part = model.parts[on]
    if isinstance(spec.at, tuple):
        return PlaceOn(name, on, spec.at, spec.side)
    assert isinstance(part, PlateSpec)  # `references` lets "center" through for plates only
    return PlaceOn(name, on, ((part.size[0] / 2, part.size[1] / 2),), spec.side)


def _closed_form(model: ModelSpec) -> StructureModel:
    spec = model.structure
    along = {
        name: (point.at[0][0] if isinstance(point.at, tuple) else getattr(spec, "length", 0.0) / 2)
        for name, point in model.points.items()
    }
    if isinstance(spec, OscillatorSpec):
        return OscillatorModel(spec.mass, spec.frequency, spec.stiffness, dict.fromkeys(model.points, 0.0))
    if isinstance(spec, RodSpec):
        return RodModel(spec.length, spec.E, spec.rho, spec.area, spec.modes, along)
    if isinstance(spec, BeamSpec):
        return BeamModel(spec.length, spec.ends, spec.EI, spec.mass_per_length, spec.modes, along)
    if isinstance(spec, GivenModesSpec):
        return _given_modes(spec)
    return NoStructure()


def _given_modes(spec: GivenModesSpec) -> ModesModel:
    count = len(spec.frequency)
    ratios = spec.ratio if spec.ratio is not None else [0.0] * count
    if len(ratios) != count:
        raise FemstructError("structure.ratio", got=f"{len(ratios)} ratios", expected=f"{count}, one a frequency")
    for name, shape in spec.points.items():
        if len(shape) != count:
            raise FemstructError(
                f"structure.points.{name}", got=f"{len(shape)} values", expected=f"{count}, one a mode"
            )
    return ModesModel(tuple(spec.frequency), tuple(ratios), {name: tuple(shape) for name, shape in spec.points.items()})


def study_of(
    study: StudySpec,
    titles: tuple[str, str],
    structure: StructureModel,
    damping: Damping,
    tree: Tree,
    mistakes: Mistakes,
) -> Study | None:
    """The study of a checked study file on a structure; None with mistakes noted. titles : of study and model."""
    builder = Builder(tree, mistakes)
    bodies = builder.each("bodies", study.bodies, lambda n, s: _body(n, s, study))
    contacts = builder.each(
        "contacts", study.contacts, lambda n, s: PlannedContact(n, s.between, law_of(s.law), s.gap, s.preload)
    )
    links = builder.each(
        "links",
        study.links,
        lambda n, s: PlannedLink(
            n, s.between, s.stiffness, s.damping.closing, s.damping.opening, s.release_at, s.preload
        ),
    )
    loads = builder.each("loads", study.loads, lambda n, s: _load(n, s, builder))
    rooms = builder.each("rooms", study.rooms, _room)
    if mistakes.lines:
        return None
    frf = tuple(
        FrfRequest(name, spot_of(one.drive), spot_of(one.response), one.kind, one.band, one.step)
        for name, one in study.frf.items()
    )
    records = tuple(Record(target, what) for target, wanted in study.record.items() for what in wanted)  # type: ignore[arg-type]
    extent = Extent(study.modes.up_to, study.modes.count) if study.modes is not None else Extent()
    time = study.time
    return Study(
        title=titles[0],
        model_title=titles[1],
        structure=structure,
        damping=damping,
        extent=extent,
        frf=frf,
        bodies=tuple(bodies.values()),
        contacts=tuple(contacts.values()),
        links=tuple(links.values()),
        loads=tuple(loads.values()),
        initial=_initial(study),
        records=records,
        time=TimePlan(time.duration, time.sampling, time.gravity, study.quiet) if time is not None else None,
        peaks=PeakRule(study.peaks.first_impact, study.peaks.lowpass),
        rooms=tuple(rooms.values()),
        save_modal=study.save == "modal",
    )


def spot_of(text: str) -> Spot:
    """An address such as ``O_s.z`` or ``ground.force``.

    >>> spot_of("rail.2.z")
    Spot(name='rail.2', what='z')
    """
    name, _, what = text.rpartition(".")
    return Spot(name, what)


def law_of(spec: Any) -> Law:
    """The contact law of a spec."""
    if isinstance(spec, HertzSpec):
        return Hertz(spec.stiffness, spec.damping, spec.tensile)
    if isinstance(spec, LinearSpec):
        return Linear(spec.stiffness, spec.damping, spec.tensile)
    return Stop(spec.stiffness, spec.damping, spec.tensile)


def _body(name: str, spec: BodySpec, study: StudySpec) -> PlacedBody:
    side = next(side for side in SIDES if getattr(spec, side) is not None)
    target = getattr(spec, side)
    named = any({name, target} == set(contact.between) for contact in study.contacts.values())
    law = law_of(spec.contact) if spec.contact is not None and not named else None
    dropped = spec.drop_height is not None
    speed = sqrt(2 * GRAVITY * spec.drop_height) if spec.drop_height is not None else spec.speed or 0.0
    return PlacedBody(name, spec.mass, side, target, speed, dropped, law)  # type: ignore[arg-type]


def _load(name: str, spec: LoadSpec, builder: Builder) -> PlannedLoad | None:
    history: HalfSine | Table | None
    if spec.half_sine is not None:
        history = HalfSine(spec.half_sine.amplitude.value, spec.half_sine.frequency)
    else:
        steps: Steps = ("loads", name, "file")
        path = Path(builder.tree.file).parent / (spec.file or "")
        what = "pressure" if spec.on is not None else "force"
        history = read_history(path, what, builder.tree.position(steps), dotted(steps), builder.mistakes)
        if history is None:
            return None
    if spec.at is not None:
        return PlannedLoad(name, spot_of(spec.at), "point", history)
    return PlannedLoad(name, spec.body or spec.on or "", "body" if spec.body is not None else "surface", history)


def _initial(study: StudySpec) -> InitialMotion:
    spec = study.initial
    velocities = tuple((spot_of(address), one.value) for address, one in (spec.velocity or {}).items())
    rigid = RigidMotion(spec.rigid.about, spec.rigid.velocity, spec.rigid.spin) if spec.rigid is not None else None
    return InitialMotion(velocities, rigid)


def _room(name: str, spec: RoomSpec) -> RoomPlan:
    receivers = []
    for receiver, places in spec.receivers.items():
        several = len(places) > 1
        receivers += [Receiver(f"{receiver}.{i}" if several else receiver, place) for i, place in enumerate(places, 1)]  # type: ignore[arg-type]
    room = Room(spec.size, Air(spec.air.c, spec.air.rho), _losses(spec))  # type: ignore[arg-type]
    return RoomPlan(name, room, spec.under, tuple(receivers), spec.at)


def _losses(spec: RoomSpec) -> Losses:
    losses = spec.losses
    if losses is None:
        return Losses()
    if losses.t60 is not None:
        return losses_from_t60(losses.t60)
    at = losses.at or 0.0
    if losses.beta is not None:
        return losses_from_beta(losses.beta, at, spec.form)
    return losses_from_loss_factor(losses.loss_factor or 0.0, at, spec.form)
