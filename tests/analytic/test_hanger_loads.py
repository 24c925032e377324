"""Loads of hangers against the weight that they carry, and the finding on loads beyond what their maker recommends."""

from __future__ import annotations

from dataclasses import replace

import pytest

from femstruct.conventions import GRAVITY
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.part import Part
from femstruct.model.structure import PlaceOn, Structure, Support
from femstruct.parts.hangers import Hangers
from femstruct.parts.mass import Mass
from femstruct.parts.plate import Plate
from femstruct.workflow.bases import hanger_loads
from femstruct.workflow.structure_findings import structure_findings_before

STONE = Material("stone", E=30e9, nu=0.2, rho=2300.0)
GYPSUM = Material("gypsum", E=3.0e9, nu=0.3, rho=800.0)
FLOOR = Plate("floor", STONE, 0.15, (0.0, 0.0, 0.4), (4.0, 3.0), 1.0)
CEILING = Plate("ceiling", GYPSUM, 0.025, (0.0, 0.0, 0.0), (4.0, 3.0), 1.0)
KILOGRAMS = 0.025 * 4.0 * 3.0 * 800.0
FOUR = Hangers("four", "floor", "ceiling", 36e3, spacing=(2.0, 1.5), like="hanger ARH-1-20: its source")
HELD = Support("edges", "simple", on="floor", edge="all")
LUMP = PlaceOn("lump", "ceiling", ((1.0, 1.0),))
POUNDS_65 = 65.0 * 0.45359237 * GRAVITY  # the largest load of an ARH-1-20
EXACT = 1e-9  # of sums of a few masses


def told(*parts: Part, supports: tuple[Support, ...] = (HELD,)) -> tuple[list[str], dict[str, float | None]]:
    """Messages on hangers, and the mean load of each [N]."""
    points = (LUMP,) if any(isinstance(part, Mass) for part in parts) else ()
    structure = Structure("hung", (FLOOR, CEILING, *parts), points=points, supports=supports)
    model = mesh_structure(structure)
    found = [one.message for one in structure_findings_before(structure, model) if one.code == "hangers-overloaded"]
    return found, {name: one["mean_load_n"] for name, one in hanger_loads(model).items()}


def test_too_few_hangers_are_told_with_how_many_it_takes() -> None:
    """240 kg on 4 hangers of 289 N: 588 N for each, 9 would do."""
    (message,), loads = told(FOUR)
    assert loads["four"] == pytest.approx(KILOGRAMS * GRAVITY / 4, rel=EXACT)
    needed = KILOGRAMS * GRAVITY / POUNDS_65  # 8.14
    assert f"At least {int(needed) + 1} of them" in message
    assert told(replace(FOUR, spacing=(4.0 / 3.0, 1.0)))[0] == []  # nine of them


def test_what_is_fastened_to_a_ceiling_hangs_on_it_too() -> None:
    """262 N for each of nine hangers of 240 kg; 289 N are allowed, 25.4 kg more in all."""
    nine = replace(FOUR, spacing=(4.0 / 3.0, 1.0))
    for more, messages in ((19.0, 0), (45.0, 1)):
        found, loads = told(nine, Mass("lamp", more, at="lump"))
        assert loads["four"] == pytest.approx((KILOGRAMS + more) * GRAVITY / 9, rel=EXACT)
        assert len(found) == messages


def test_a_ceiling_shares_its_weight_among_all_its_hangers() -> None:
    other = replace(FOUR, name="other", like="")
    found, loads = told(FOUR, other)
    assert loads == pytest.approx(dict.fromkeys(("four", "other"), KILOGRAMS * GRAVITY / 8), rel=EXACT)
    assert len(found) == 1  # nothing is known of the others


@pytest.mark.parametrize("beside", ["a support", "lines of springs"])
def test_nothing_is_said_where_something_else_carries_the_ceiling(beside: str) -> None:
    lines = Hangers("lines", "floor", "ceiling", 1e5, per="length", spacing=(1.0,), along="x")
    wall = Support("wall", "simple", on="ceiling", edge="x0")
    found, loads = told(FOUR, supports=(HELD, wall)) if beside == "a support" else told(FOUR, lines)
    assert (found, loads["four"]) == ([], None)


def test_a_ceiling_that_is_only_kept_from_sliding_hangs_with_all_its_weight() -> None:
    stays = Support("stays", ("x", "y"), on="ceiling", edge="x0")
    assert told(FOUR, supports=(HELD, stays))[1]["four"] == pytest.approx(KILOGRAMS * GRAVITY / 4, rel=EXACT)
