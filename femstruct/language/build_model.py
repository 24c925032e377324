"""From a checked model file to a structure and its damping."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from femstruct.errors import FemstructError
from femstruct.language.build import Builder
from femstruct.language.reader import Mistakes, Tree
from femstruct.language.schema_model import BeamSpec, GivenModesSpec, ModelSpec, OscillatorSpec, PointSpec, RodSpec
from femstruct.language.schema_parts import (
    BlockSpec,
    BoxSpec,
    CircleSpec,
    ConstantsSpec,
    FoundationSpec,
    FrameSpec,
    ISpec,
    MassSpec,
    PlateSpec,
    RectangleSpec,
    RegionSpec,
    SpringSpec,
    TubeSpec,
)
from femstruct.modal.damping import Damping, FromMaterials, LossFactor, ModeDamping, Ratio, Rayleigh
from femstruct.model.material import Material
from femstruct.model.part import Part
from femstruct.model.region import Region
from femstruct.model.section import Section, box, circle, i_section, rectangle, tube
from femstruct.model.structure import Joint, PlaceOn, Structure, Support, SurfaceOn
from femstruct.parts.block import Block
from femstruct.parts.foundation import Foundation
from femstruct.parts.frame import Frame
from femstruct.parts.mass import Mass
from femstruct.parts.plate import Plate
from femstruct.parts.spring import Spring
from femstruct.study.structures import BeamModel, ModesModel, NoStructure, OscillatorModel, RodModel, StructureModel


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
        return tube(name, spec.outer, spec.thickness)
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
    if isinstance(spec, BlockSpec):
        return Block(name, spec.mass, spec.origin, spec.size, spec.center, spec.inertia)
    if isinstance(spec, FoundationSpec):
        normal, shear = spec.stiffness.normal.value, spec.stiffness.shear.value
        on, to = spec.between or (spec.on or "", None)
        return Foundation(name, on, _region(spec.region), normal, shear, spec.loss_factor, to)
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
        return PlaceOn(name, on, spec.at, spec.side, spec.patch)
    if isinstance(part, BlockSpec):
        a, b, c = part.size
        height = {"bottom": 0.0, "top": c}.get(spec.at or "", c / 2)
        return PlaceOn(name, on, ((a / 2, b / 2, height),), spec.side)
    assert isinstance(part, PlateSpec)  # `references` lets words through for plates and blocks only
    return PlaceOn(name, on, ((part.size[0] / 2, part.size[1] / 2),), spec.side, spec.patch)


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
    if any(later < former for former, later in pairwise(spec.frequency)):
        told = ", ".join(f"{frequency:g}" for frequency in spec.frequency)
        raise FemstructError("structure.frequency", got=f"[{told}] Hz", expected="frequencies that ascend")
    for name, point in spec.points.items():
        if len(point.shape) != count:
            raise FemstructError(
                f"structure.points.{name}", got=f"{len(point.shape)} values", expected=f"{count}, one a mode"
            )
    shapes = {name: tuple(point.shape) for name, point in spec.points.items()}
    at = {name: point.at for name, point in spec.points.items() if point.at is not None}
    return ModesModel(tuple(spec.frequency), tuple(ratios), shapes, at)
