"""The second pass over a model file: its names, and what its keys say about each other."""

from __future__ import annotations

import re

from femstruct.language.parts.base import Surroundings
from femstruct.language.references import names_of
from femstruct.language.schema_model import ModelSpec, PointSpec
from femstruct.language.sections import check_section
from femstruct.language.yaml.checker import Checker
from femstruct.language.yaml.reader import Mistakes, Steps, Tree


def check_model(model: ModelSpec, tree: Tree, mistakes: Mistakes) -> None:
    """Every name a model uses is there, of the right kind, and its keys agree with each other."""
    check = Checker(tree, mistakes)
    names = names_of(model)
    around = Surroundings(check, [*names.points, *names.places], model.materials, model.sections, model.parts)
    plates, bodily = around.named("has_edges"), around.named("has_nodes")
    if model.structure is not None:
        for group in ("parts", "joints", "supports", "surfaces", "materials", "sections"):
            if getattr(model, group):
                check.wrong((group,), f"'{group}' beside 'structure'", "one of them", f"remove '{group}'", of_key=True)
    elif not model.parts:
        check.wrong((), "no parts", "'parts' or 'structure'", "add 'parts: ...', or 'structure: none' for bodies alone")
    for name, section in model.sections.items():
        check_section(check, ("sections", name), section)
    for name, part in model.parts.items():
        part.check(("parts", name), around)
    for name, joint in model.joints.items():
        for number, part_name in enumerate(joint.connect):
            check.known(("joints", name, "connect", number), part_name, "part", bodily)
        if joint.connect[0] == joint.connect[1]:
            check.wrong(("joints", name, "connect"), f"'{joint.connect[0]}' twice", "two different parts")
        for direction in sorted(joint.stiffness.model_fields_set):
            if not getattr(joint.stiffness, direction):
                where = ("joints", name, "stiffness", direction)
                do = "leave the direction out: it is rigid then; 'kind: pinned' lets the parts turn"
                check.wrong(where, "0", "a positive stiffness", do)
    for name, point in model.points.items():
        _check_point(check, ("points", name), point, model, bodily)
    for name, surface in model.surfaces.items():
        check.known(("surfaces", name, "on"), surface.on, "plate", plates)
        if surface.region.rim is not None or surface.region.line is not None:
            check.wrong(("surfaces", name, "region"), "a rim or line", "an area", "use whole or rectangle")
    for name, support in model.supports.items():
        here: Steps = ("supports", name)
        if support.at is not None:
            check.known((*here, "at"), support.at, "point", [*names.points, *names.places])
            if support.edge is not None or support.line is not None:
                check.wrong(here, "an edge or line of a point", "a point alone, or 'on: PART' with an edge")
        elif support.on is not None:
            at_line = support.edge is not None or support.line is not None
            check.known((*here, "on"), support.on, "plate" if at_line else "part", plates if at_line else bodily)
            if support.edge is None and support.line is None and isinstance(support.fix, str):
                do = "add edge: all, or list the directions as in [x, y]"
                check.wrong((*here, "fix"), f"'{support.fix}' for a whole part", "an edge, a line or directions", do)
    for mode in model.damping.modes:
        if not re.fullmatch("[1-9][0-9]{0,5}", mode):
            check.wrong(("damping", "modes", mode), f"'{mode}'", "a mode number from 1", of_key=True)


def _check_point(check: Checker, steps: Steps, point: PointSpec, model: ModelSpec, bodily: list[str]) -> None:
    if model.structure is None:
        for key in ("on", "at"):
            if getattr(point, key) is None:
                check.wrong(steps, "nothing", f"'{key}'", f"add '{key}: ...'", of_key=True)
        if point.on is not None and check.known((*steps, "on"), point.on, "part", bodily):
            part = model.parts[point.on]
            if point.at is not None:
                part.check_place((*steps, "at"), point.at, check)
            if point.patch is not None and not part.has_edges:
                check.wrong((*steps, "patch"), f"a patch on a {part.type}", "a patch on a plate", "remove it")
        return
    kind = model.structure.type
    if point.patch is not None:
        check.wrong((*steps, "patch"), f"a patch of structure '{kind}'", "a patch on a plate", "remove it")
    if kind in ("none", "modes"):
        where = "the structure's own 'points'" if kind == "modes" else "no points: there is no structure"
        check.wrong(steps, f"a point of structure '{kind}'", where, "move or remove it", of_key=True)
    elif kind == "oscillator":
        if point.at is not None or point.on is not None:
            check.wrong(steps, "a place", "{} for a point of an oscillator")
    else:
        length = getattr(model.structure, "length", 0.0)
        for one in point.at if isinstance(point.at, tuple) else ((length / 2,),) if point.at else ():
            if len(one) != 1 or not 0 <= one[0] <= length:
                got = f"{one[0]:g} m" if len(one) == 1 else f"{len(one)} coordinates"
                check.wrong((*steps, "at"), got, f"a position from 0 to {length:g} m along it")
        if point.at in ("top", "bottom"):
            check.wrong((*steps, "at"), f"{point.at} of a {kind}", f"a position from 0 to {length:g} m", "write center")
        if point.at is None:
            check.wrong(steps, "nothing", "'at'", "add 'at: 0'", of_key=True)
        if point.on is not None:
            check.wrong((*steps, "on"), "'on'", f"a position along the {kind} only", "remove it", of_key=True)
