"""What a person reads of a model at rest under forces and weight."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from femstruct.assembly.forces import GROUND
from femstruct.errors import some_of
from femstruct.files.tables.finding_tables import finding_from
from femstruct.view.tables.console import console
from femstruct.view.tables.finding_lines import show_findings
from femstruct.view.tables.grid import Grid
from femstruct.view.tables.scales import rounded

AT_SEVERAL = "what stands at several places as one sum"
ON_THE_GROUND = f"forces on the ground: {AT_SEVERAL}"
BETWEEN = (
    f"forces between parts: {AT_SEVERAL}; on the second part of a joint; of a rigid link on its 'to', of an average on "
    "its 'of'"
)
SUM = " (sum of all)"
NOISE = 1e-6  # of the largest displacement or rotation: less has no meaning beside it


def show_rest(table: Mapping[str, Any], verbose: bool = False) -> None:
    """Displacements of points and parts, forces, largest stresses; verbose : remarks, too."""
    screen = console()
    screen.print(table["title"], style="bold")
    x, y, z = (f"{value:.4g}" for value in table["load_n"])
    screen.print(f"all that acts: ({x}, {y}, {z}) N")
    if table["points"]:
        points = Grid("points", ("", "x [mm]", "y [mm]", "z [mm]", "rx [mrad]", "ry [mrad]", "rz [mrad]"))
        rows = table["points"].values()
        noise = [NOISE * max(abs(one) for row in rows for one in row[half]) for half in (slice(3), slice(3, 6))]
        for name, values in table["points"].items():
            least = [noise[0]] * 3 + [noise[1]] * 3
            shown = [1e3 * one if abs(one) > least[i] else 0.0 for i, one in enumerate(values)]
            points.add(name, *(_number(one) for one in shown))
        points.show(screen)
    parts = Grid("parts", ("", "largest displacement [mm]", "largest stress of von Mises [MPa]", "where"))
    for name, moved in table["parts_m"].items():
        stress = table["stresses"].get(name)
        told = ("-", "") if stress is None else (f"{1e-6 * stress['largest_pa']:.4g}", stress["where"])
        parts.add(name, _number(1e3 * moved), *told)
    parts.show(screen)
    largest = max((abs(one) for force in table["forces_n"].values() for one in force), default=0.0)
    for words, on_the_ground in ((ON_THE_GROUND, True), (BETWEEN, False)):
        forces = Grid(words, ("", "x [N]", "y [N]", "z [N]"))
        own = [name for name in table["forces_n"] if (name in table["on_the_ground"]) is on_the_ground]
        for name in own:
            force = table["forces_n"][name]
            forces.add(f"{name}{SUM}" if name == GROUND else name, *(_number(rounded(one, largest)) for one in force))
        forces.show(screen)
    if table["held_inside"]:
        x, y, z = (_number(one) for one in table["held_inside"]["force_n"])
        names = some_of(table["held_inside"]["parts"])
        screen.print(f"held inside the matrices of {names}, which reaches no support: ({x}, {y}, {z}) N")
    show_findings(screen, [(finding_from(one), "") for one in table["findings"]], verbose)


def _number(value: float) -> str:
    return f"{value:.4g}" if value else "0"
