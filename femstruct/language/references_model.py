"""The second pass over a model file: its names, and what its keys say about each other."""

from __future__ import annotations

import re

from femstruct.language.reader import Mistakes, Steps, Tree
from femstruct.language.references import Checker, Names
from femstruct.language.schema_model import ModelSpec, PointSpec
from femstruct.language.schema_parts import (
    BlockSpec,
    FoundationSpec,
    FrameSpec,
    ISpec,
    MassSpec,
    PlateSpec,
    SpringSpec,
)

_AXES_OF = {"plate": "", "frame": "global axes", "block": "from its lower corner"}
ROUNDING = 1e-9  # of a side: what a coordinate written in decimals may be off the edge


def check_model(model: ModelSpec, tree: Tree, mistakes: Mistakes) -> None:
    """Every name a model uses is there, of the right kind, and its keys agree with each other."""
    check = Checker(tree, mistakes)
    names = Names.of(model)
    plates = [name for name, part in model.parts.items() if isinstance(part, PlateSpec)]
    solid = [name for name, part in model.parts.items() if isinstance(part, PlateSpec | BlockSpec)]
    bodily = [name for name, part in model.parts.items() if isinstance(part, PlateSpec | FrameSpec | BlockSpec)]
    if model.structure is not None:
        for group in ("parts", "joints", "supports", "surfaces", "materials", "sections"):
            if getattr(model, group):
                check.wrong((group,), f"'{group}' beside 'structure'", "one of them", f"remove '{group}'", of_key=True)
    elif not model.parts:
        check.wrong((), "no parts", "'parts' or 'structure'", "add 'parts: ...', or 'structure: none' for bodies alone")
    for name, section in model.sections.items():
        _check_section(check, ("sections", name), section)
    for name, part in model.parts.items():
        steps: Steps = ("parts", name)
        if isinstance(part, PlateSpec | FrameSpec):
            check.known((*steps, "material"), part.material, "material", model.materials)
        if isinstance(part, FrameSpec):
            check.known((*steps, "section"), part.section, "section", model.sections)
        if isinstance(part, FoundationSpec) and _check_ends(check, steps, part, solid):
            _check_spread(check, steps, part)
        if isinstance(part, SpringSpec):
            _check_spring(check, steps, part, names)
        if isinstance(part, MassSpec):
            _check_mass(check, steps, part, names, model)
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


def _check_section(check: Checker, steps: Steps, section: object) -> None:
    if isinstance(section, ISpec):
        return
    thickness = getattr(section, "thickness", None)
    if thickness is not None:
        smallest = min(getattr(section, key) for key in ("outer", "width", "height") if hasattr(section, key))
        if not 2 * thickness < smallest:
            check.wrong((*steps, "thickness"), f"{thickness:g} m", f"less than half of {smallest:g} m")


def _check_ends(check: Checker, steps: Steps, part: FoundationSpec, solid: list[str]) -> bool:
    """Whether a foundation is on plates and blocks that are there."""
    if part.between is None:
        return check.known((*steps, "on"), part.on or "", "plate or block", solid)
    good = [check.known((*steps, "between", i), name, "plate or block", solid) for i, name in enumerate(part.between)]
    if all(good) and part.between[0] == part.between[1]:
        check.wrong((*steps, "between"), f"'{part.between[0]}' twice", "two different parts")
        return False
    return all(good)


def _check_spread(check: Checker, steps: Steps, part: FoundationSpec) -> None:
    along = part.region.rim is not None or part.region.line is not None
    right = "stiffness/length" if along else "stiffness/area"
    unit = "N/m^2 (per length of a rim or line)" if along else "N/m^3 (per area)"
    for key in ("normal", "shear"):
        measured = getattr(part.stiffness, key)
        if measured.dimension not in (None, right):
            other = "N/m^3" if along else "N/m^2"
            check.wrong((*steps, "stiffness", key), f"a stiffness in {other}", unit, "match the unit to the region")
    if not (part.stiffness.normal.value or part.stiffness.shear.value):
        check.wrong((*steps, "stiffness"), "no stiffness at all", "a positive normal or shear stiffness")


def _check_spring(check: Checker, steps: Steps, part: SpringSpec, names: Names) -> None:
    first, second = part.between
    known = [*names.points, *names.places]
    if first == "ground":
        check.wrong((*steps, "between", 0), "'ground'", "a point first", f"write [{second}, ground]")
    else:
        check.known((*steps, "between", 0), first, "point", known)
    if second != "ground":
        check.known((*steps, "between", 1), second, "point", [*known, "ground"])
    if not any((*part.stiffness.model_dump().values(), *part.damping.model_dump().values())):
        check.wrong(steps, "no stiffness and no damping", "one of them", "add stiffness: {z: ...}", of_key=True)


def _check_mass(check: Checker, steps: Steps, part: MassSpec, names: Names, model: ModelSpec) -> None:
    if (part.at is None) == (part.on is None):
        check.wrong(
            steps, "both 'at' and 'on'" if part.at else "no place", "one of at: POINT and on: PART", of_key=True
        )
        return
    frame = isinstance(model.parts.get(part.on or ""), FrameSpec)
    along = frame or (part.region is not None and (part.region.rim is not None or part.region.line is not None))
    allowed = ("mass",) if part.at is not None else ("mass", "mass/length") if along else ("mass", "mass/area")
    if part.mass.dimension not in (None, *allowed):
        units = {"mass": "kg", "mass/length": "kg/m", "mass/area": "kg/m^2"}
        got = f"a mass in {units[part.mass.dimension or 'mass']}"
        where = (
            "at a point"
            if part.at is not None
            else "along a frame"
            if frame
            else "along a rim or line"
            if along
            else "over an area"
        )
        check.wrong((*steps, "mass"), f"{got} {where}", " or ".join(units[one] for one in allowed))
    if part.at is not None:
        check.known((*steps, "at"), part.at, "point", [*names.points, *names.places])
        if part.region is not None:
            check.wrong((*steps, "region"), "a region at a point", "a region on a part", "use on: PART", of_key=True)
    elif part.on is not None:
        lined = [name for name, one in model.parts.items() if isinstance(one, PlateSpec | FrameSpec)]
        check.known((*steps, "on"), part.on, "plate or frame", lined)
        if frame and part.region is not None:
            check.wrong((*steps, "region"), "a region of a frame", "all of the frame", "remove 'region'", of_key=True)


def _check_inside(
    check: Checker, steps: Steps, places: tuple[tuple[float, ...], ...], part: PlateSpec | BlockSpec
) -> None:
    for place in places:
        if not all(-ROUNDING * side <= x <= side * (1 + ROUNDING) for x, side in zip(place, part.size, strict=True)):
            expected = f"a place on the {part.type}, {' x '.join(f'{side:g} m' for side in part.size)}"
            do = f"measure from the {part.type}'s own corner, along its own axes"
            check.wrong(steps, f"{list(place)} m", expected, do)


def _check_point(check: Checker, steps: Steps, point: PointSpec, model: ModelSpec, bodily: list[str]) -> None:
    if model.structure is None:
        for key in ("on", "at"):
            if getattr(point, key) is None:
                check.wrong(steps, "nothing", f"'{key}'", f"add '{key}: ...'", of_key=True)
        if point.on is not None and check.known((*steps, "on"), point.on, "part", bodily):
            part = model.parts[point.on]
            wanted = 2 if isinstance(part, PlateSpec) else 3
            if isinstance(part, FrameSpec) and isinstance(point.at, str):
                check.wrong((*steps, "at"), f"{point.at} of a frame", "global coordinates", "write [x, y, z]")
            elif isinstance(part, PlateSpec) and point.at in ("top", "bottom"):
                check.wrong((*steps, "at"), f"{point.at} of a plate", "center or [x, y]", "write center")
            if isinstance(point.at, tuple) and any(len(one) != wanted for one in point.at):
                got = f"{len(point.at[0])} coordinates"
                check.wrong((*steps, "at"), got, f"{wanted} on a {part.type}", _AXES_OF[part.type])
            elif isinstance(point.at, tuple) and isinstance(part, PlateSpec | BlockSpec):
                _check_inside(check, (*steps, "at"), point.at, part)
            if point.patch is not None and wanted == 3:
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
