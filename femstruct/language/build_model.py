"""From a checked model file to a structure and its damping."""

from __future__ import annotations

from itertools import pairwise

from femstruct.errors import FemstructError
from femstruct.language.parts.base import Library
from femstruct.language.schema_model import BeamSpec, GivenModesSpec, ModelSpec, OscillatorSpec, PointSpec, RodSpec
from femstruct.language.yaml.build import Builder
from femstruct.language.yaml.reader import Mistakes, Tree
from femstruct.modal.damping import Damping, FromMaterials, LossFactor, ModeDamping, Ratio, Rayleigh
from femstruct.model.part import Part
from femstruct.model.structure import Joint, PlaceOn, Structure, Support, SurfaceOn
from femstruct.study.structures import BeamModel, ModesModel, NoStructure, OscillatorModel, RodModel, StructureModel


def structure_of(model: ModelSpec, title: str, tree: Tree, mistakes: Mistakes) -> StructureModel | None:
    """The structure of a checked model file; None with mistakes noted."""
    builder = Builder(tree, mistakes)
    if model.structure is not None:
        return builder.make(("structure",), lambda: _closed_form(model))
    materials = builder.each("materials", model.materials, lambda name, spec: spec.build(name))
    sections = builder.each("sections", model.sections, lambda name, spec: spec.build(name))
    if mistakes.lines:
        return None
    of = Library(materials, sections)
    parts: dict[str, Part] = builder.each("parts", model.parts, lambda name, spec: spec.build(name, of))
    points = {name: _place(name, spec, model) for name, spec in model.points.items()}
    surfaces = (SurfaceOn(n, s.on, s.side, s.region.build()) for n, s in model.surfaces.items())
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


def _place(name: str, spec: PointSpec, model: ModelSpec) -> PlaceOn:
    on = spec.on or ""
    at = spec.at if isinstance(spec.at, tuple) else (model.parts[on].place(spec.at or ""),)
    return PlaceOn(name, on, at, spec.side, spec.patch)


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
