"""What was asked, as tables: the inputs of the baseline, and what every case gives otherwise."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from femstruct.model.given import Given
from femstruct.study.inputs import Difference, Inputs, differences, inputs
from femstruct.study.study import Case, Plan
from femstruct.view.page.words import amount, spoken
from femstruct.view.tables.grid import Grid

FRONT: Final[Mapping[str, tuple[str, ...]]] = {  # tables of groups; of the others there is one more
    "structure": ("structure", "parts", "supports"),
    "what acts on it": ("bodies", "contacts", "links", "loads"),
    "rooms": ("rooms",),
    "analysis": ("analysis",),
}
LOSS: Final = "loss factor"  # of a material: used only where the damping is
OF_MATERIALS: Final = Given(LOSS, "of the materials")
FURTHER: Final = "further inputs"


def baseline_inputs(plan: Plan) -> Inputs:
    """The inputs of a study's baseline."""
    return inputs(next(case.study for case in plan.cases if case.name == plan.baseline))


def input_tables(asked: Inputs) -> tuple[Grid, ...]:
    """The inputs that a reader asks for first: materials, structure, what acts on it, rooms, analysis."""
    grids = [_materials(asked), *(_items(title, asked, groups) for title, groups in FRONT.items())]
    return tuple(grid for grid in grids if grid.rows)


def further_inputs(asked: Inputs) -> Grid:
    """All other inputs: sections, joints, points, surfaces, frequency responses."""
    shown = {"materials", *(group for groups in FRONT.values() for group in groups)}
    return _items(FURTHER, asked, [group for group in asked.groups if group not in shown])


def _materials(asked: Inputs) -> Grid:
    items = asked.groups.get("materials", ())
    columns = list(dict.fromkeys(one.what for item in items for one in item.given))
    damping = [one for item in asked.groups.get("analysis", ()) if item.name == "damping" for one in item.given]
    unused = bool(damping) and not any(one == OF_MATERIALS for one in damping)
    shown = [f"{column}\n(not used)" if unused and column == LOSS else column for column in columns]
    grid = Grid("materials", ("", *shown))
    for item in items:
        told = {one.what: amount(one) for one in item.given}
        grid.add(item.name, *(told.get(column, "") for column in columns))
    return grid


def _items(title: str, asked: Inputs, groups: Sequence[str]) -> Grid:
    grid = Grid(title, ("", "kind" if groups != ("analysis",) else "", "given"), keys=3)
    for group in groups:
        for item in asked.groups.get(group, ()):
            grid.add(item.name, item.kind, ", ".join(map(spoken, item.given)))
    return grid


def cases_table(plan: Plan, finished: Sequence[str]) -> Grid:
    """A row for everything that a case gives otherwise than the baseline; finished : names of the cases that were run.

    What a case changes in words that are no input, as a mesh file of its room, is told in the words of its file.
    """
    grid = Grid(f"cases (baseline: {plan.baseline})", ("case", "input", "baseline", "case has"), keys=4)
    asked = baseline_inputs(plan)
    for case in plan.cases if len(plan.cases) > 1 else ():
        mark = "" if case.name in finished else ", not run"
        if case.name == plan.baseline:
            grid.add(case.name, f"the baseline{mark}", "", "")
            continue
        rows = [row for one in differences(asked, inputs(case.study)) for row in _rows(one)] or _as_written(case)
        for number, row in enumerate(rows):
            grid.add("" if number else f"{case.name}{mark}", *row)
    return grid


def _rows(found: Difference) -> Iterator[tuple[str, str, str]]:
    if not (found.before and found.after):
        before, after = (", ".join(map(_told, side)) or "-" for side in (found.before, found.after))
        yield f"{found.group}: {found.name}", before, after
        return
    first, second = ({one.what: amount(one) for one in side} for side in (found.before, found.after))
    for what in dict.fromkeys((*first, *second)):
        yield f"{found.name}: {what}", first.get(what, "-"), second.get(what, "-")


def _told(one: Given) -> str:
    return amount(one) if one.what == "kind" else spoken(one)


def _as_written(case: Case) -> list[tuple[str, str, str]]:
    return [(path, "", text) for path, text in case.changes.items()] or [("nothing differs", "", "")]
