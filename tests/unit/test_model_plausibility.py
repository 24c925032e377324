"""Findings about models that mistook a unit, or a part that hangs over the edge of what carries it."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from femstruct.assembly.matrices import assemble
from femstruct.errors import FemstructError, Finding, InputError
from femstruct.modal.damping import Damping, LossFactor, Ratio, with_damping
from femstruct.modal.reduction import modal_basis
from femstruct.model.lay_ups import Laminate, Layer
from femstruct.model.materials import LossByFrequency, Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.part import Part
from femstruct.model.regions import Region
from femstruct.model.sections import Section, circle, rectangle, tube
from femstruct.model.structure import PlaceOn, Structure, Support
from femstruct.parts.arrangement_findings import overhang_findings
from femstruct.parts.block import Block
from femstruct.parts.foundation import Foundation
from femstruct.parts.frame import Frame
from femstruct.parts.plate import Plate
from femstruct.parts.plausibility import material_findings, plausibility_findings, sag_of
from femstruct.parts.slab import Slab
from femstruct.parts.spring import Spring
from femstruct.parts.wave_findings import model_findings
from femstruct.workflow.structure_findings import structure_findings_after, structure_findings_before

CONCRETE = Material("concrete", E=30e9, nu=0.2, rho=2400.0)
STEEL = Material("steel", E=210e9, nu=0.3, rho=7850.0)
SLAB = Plate("slab", CONCRETE, 0.18, origin=(0.0, 0.0, 0.0), size=(5.0, 4.0), mesh=(4, 3))


def floor(x: float = 0.5, turned: bool = False) -> tuple[Finding, ...]:
    """A slab of 4 x 3 m and a screed of 2 x 1 m, lying from x on, on a layer over all that both share."""
    slab = Plate("slab", CONCRETE, 0.2, origin=(0.0, 0.0, 0.0), size=(4.0, 3.0), mesh=(4, 3))
    normal, along = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)) if turned else ((0.0, 0.0, 1.0), None)
    screed = Plate(
        "screed", CONCRETE, 0.06, origin=(x, 0.5, 0.15), size=(2.0, 1.0), mesh=(2, 1), normal=normal, x_direction=along
    )
    wool = Foundation("wool", "screed", Region("whole"), 10e6, to="slab")
    model = mesh_structure(Structure("floor", (slab, screed, wool)))
    return (*overhang_findings(model), *plausibility_findings(model.structure.parts))


def told(*parts: Part) -> Finding:
    """The one finding about some parts, which is severe."""
    (found,) = plausibility_findings(parts)
    assert found.severe
    return found


@pytest.mark.parametrize("x", [0.0, 0.5, 2.0])
def test_nothing_is_said_of_a_floor_as_floors_are(x: float) -> None:
    assert floor(x=x) == ()


# name, E, nu, rho: what is written, what was meant, and the numbers of the message
SLIPS = [
    ("a weight for a mass", 30e9, 0.2, 24000.0, "rho 2.4e+04 kg/m^3, the densest solid has 23000", "rho 2447 kg/m^3?"),
    ("kN/m^3 of steel", 210e9, 0.3, 78500.0, "rho 7.85e+04 kg/m^3", "rho 8005 kg/m^3?"),
    ("MPa for GPa", 30e6, 0.2, 2400.0, "a bar is 112 m/s", "E 30 GPa?"),
    ("MPa for GPa, steel", 210e6, 0.3, 7850.0, "a bar is 164 m/s", "E 210 GPa?"),
    ("MPa for GPa, acrylic", 5.9e6, 0.35, 1172.0, "a bar is 71 m/s", "E 5.9 GPa?"),
    ("kPa for GPa", 30e3, 0.2, 2400.0, "a bar is 3.54 m/s", "E 30 GPa?"),
    ("GPa without a unit", 210.0, 0.3, 7850.0, "E 210 Pa", "E 210 GPa?"),
    ("TPa for GPa", 30e12, 0.2, 2400.0, "a bar is 1.12e+05 m/s", "E 30 GPa?"),
    ("t/m^3", 30e9, 0.2, 2.4, "a bar is 1.12e+05 m/s", "rho 2400 kg/m^3?"),
    ("t/mm^3", 210e9, 0.3, 7.85e-9, "lighter than any solid", "rho: 0 is a part without mass"),
]


@pytest.mark.parametrize(("E", "nu", "rho", "got", "meant"), [slip[1:] for slip in SLIPS], ids=[s[0] for s in SLIPS])
def test_a_material_no_solid_has_is_told_with_what_was_meant(
    E: float, nu: float, rho: float, got: str, meant: str
) -> None:
    found = told(Frame("bar", Material("stuff", E, nu, rho), circle("rod", 0.02), (((0, 0, 0), (1.0, 0, 0)),)))
    assert found.code == "implausible-material"
    assert got in found.message
    assert meant in found.message
    assert found.values == pytest.approx({"wave_speed_m_s": (E / rho) ** 0.5, "E_pa": E, "rho_kg_m3": rho})


# E, nu, rho of solids: Ashby's charts and makers' sheets; effective plates carry more than they are
SOLIDS = {
    "rubber": (1e6, 0.48, 1100),
    "filled rubber, a heavy mat": (20e6, 0.45, 2300),
    "flexible foam": (50e3, 0.3, 30),
    "elastic mat of granulate": (0.3e6, 0.2, 700),
    "rigid foam": (20e6, 0.3, 35),
    "the foam of the hull": (107e6, 0.3, 100),
    "gelatine": (10e3, 0.45, 1000),
    "cork": (30e6, 0.1, 160),
    "balsa along the grain": (5e9, 0.3, 150),
    "timber": (11e9, 0.2, 420),
    "acrylic": (5.9e9, 0.35, 1172),
    "PTFE": (0.4e9, 0.46, 2200),
    "asphalt": (1e9, 0.35, 2400),
    "concrete": (30e9, 0.2, 2400),
    "aerated concrete": (1.5e9, 0.2, 500),
    "a board that stands for the screed on it": (3e9, 0.2, 4500),
    "lead": (16e9, 0.44, 11340),
    "steel": (210e9, 0.3, 7850),
    "tungsten": (400e9, 0.28, 19300),
    "beryllium": (287e9, 0.03, 1850),
    "carbon fibre along it": (230e9, 0.3, 1600),
    "diamond": (1.05e12, 0.1, 3510),
    "no mass": (210e9, 0.3, 0.0),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_solids_are_solids(name: str) -> None:
    assert material_findings(Material(name, *SOLIDS[name])) == ()


@pytest.mark.parametrize(("rho", "meant"), [(2.4e6, "2400?"), (7.85e6, "7850?"), (1e12, "plain numbers are kg/m")])
def test_a_density_beyond_all_is_refused(rho: float, meant: str) -> None:
    with pytest.raises(FemstructError, match="the densest solid has 23000") as refused:
        replace(CONCRETE, rho=rho)
    assert refused.value.where == "materials.concrete.rho"
    assert meant in refused.value.do


def test_a_loss_factor_of_two_is_refused() -> None:
    assert replace(CONCRETE, loss_factor=1.5).loss_factor == 1.5
    with pytest.raises(FemstructError, match=r"got 1\.99.*did you mean 1\.99 %"):
        replace(CONCRETE, loss_factor=1.99)


@pytest.mark.parametrize(("thickness", "meant"), [(210.0, "210 mm?"), (180.0, "180 mm?"), (4.1, "4.1 mm?")])
def test_a_plate_thicker_than_wide_is_refused(thickness: float, meant: str) -> None:
    with pytest.raises(InputError, match="at most the plate's shorter side, 4 m") as refused:
        replace(SLAB, thickness=thickness)
    assert refused.value.where == "parts.slab.thickness"
    assert meant in refused.value.do


def test_layers_in_metres_are_refused_in_plates_and_slabs() -> None:
    layers = Laminate((Layer(CONCRETE, 0.06), Layer(CONCRETE, 40.0)))
    corners = ((0.0, 0.0), (5.0, 0.0), (5.0, 1.0), (0.0, 1.0))
    with pytest.raises(
        InputError, match=r"got 40\.06 m in all, expected at most the plate's shorter side, 4 m"
    ) as refused:
        replace(SLAB, material=layers, thickness=layers.thickness)
    assert refused.value.where == "parts.slab.layers" and refused.value.do.endswith(": 40 mm?")
    with pytest.raises(
        InputError, match=r"got 40\.06 m in all, expected at most the slab's shorter side, 1 m"
    ) as refused:
        Slab("deck", layers, layers.thickness, corners, 0.1)
    assert refused.value.where == "parts.deck.layers" and refused.value.do.endswith(": 40 mm?")
    with pytest.raises(InputError, match=r"got 180 m, expected at most the slab's shorter side, 1 m; .*: 180 mm"):
        Slab("deck", CONCRETE, 180.0, corners, 0.1)
    Slab("deck", CONCRETE, 0.9, corners, 0.1)  # thick, and possible


def test_a_slab_of_a_fifth_of_a_millimetre_is_told() -> None:
    found = told(replace(SLAB, thickness=0.18e-3))
    assert found.code == "implausible-thickness"
    assert "0.18 mm thick, 1/22222 of its shorter side of 4 m" in found.message
    assert found.message.endswith("180 mm?")
    assert plausibility_findings([Plate("sheet", STEEL, 0.5e-3, (0, 0, 0), (4.9, 4.9), 0.1)]) == ()


def test_a_plate_written_in_millimetres_is_told_its_side() -> None:
    found = told(Plate("sheet", STEEL, 8e-3, (0, 0, 0), (1200.0, 800.0), 50.0))
    assert found.code == "implausible-thickness"
    assert found.message.endswith("Plain numbers are metres: did you mean a side of 800 mm?")


@pytest.mark.parametrize("thickness", [0.3, 0.5, 1.0])
def test_a_plate_as_thick_as_half_its_side_is_no_plate(thickness: float) -> None:
    """(k h)^2 / 24 (1 + 2 / (5/6 (1 - nu))) of the first frequency: 0.33, 0.9 and 3.7 for a square."""
    sheet = Plate("sheet", STEEL, thickness, (0, 0, 0), (1.0, 1.0), (4, 4))
    (found,) = model_findings(mesh_structure(Structure("thick", (sheet,))))
    assert found.code == "thick-plate"
    assert found.severe == (thickness >= 0.5)


# 60 (1 - nu^2) rho g a^3 / 384 E h^2 of its shorter side: 0.023 % as meant
SOFT = {
    "E of a thousandth, timber": Plate("deck", Material("timber", 8e6, 0.3, 450.0), 0.16, (0, 0, 0), (3.6, 2.7), 0.15),
    "all in millimetres": replace(SLAB, thickness=180.0, size=(5000.0, 4000.0)),
}


@pytest.mark.parametrize("name", SOFT)
def test_a_floor_that_would_hang_through_is_told(name: str) -> None:
    found = told(SOFT[name])
    assert found.code == "implausible-stiffness"
    assert found.values["sag_m"] > 0.05 * found.values["side_m"]


def test_the_sag_of_a_strip_and_what_may_sag() -> None:
    q, D = 2400 * 9.80665 * 0.18, 30e9 * 0.18**3 / 12 / (1 - 0.2**2)
    # rounding: none here
    assert sag_of(SLAB.section, 4.0) == pytest.approx(5 * q * 4.0**4 / (384 * D), rel=1e-13)
    soft = SOFT["E of a thousandth, timber"]
    mat = Foundation("bed", "deck", Region("whole"), 1e7)
    assert plausibility_findings([soft, mat]) == ()  # it lies on something
    assert plausibility_findings([replace(soft, normal=(0.0, 1.0, 0.0))]) == ()  # it stands
    rubber = Plate("mat", Material("rubber", 3e6, 0.48, 1100.0), 0.02, (0, 0, 0), (0.5, 0.5), 0.1)
    assert plausibility_findings([rubber]) == ()
    assert plausibility_findings([Plate("sheet", STEEL, 1e-3, (0, 0, 0), (1.2, 1.0), 0.1)]) == ()


LINE = (((0.0, 0.0, 0.0), (2.0, 0.0, 0.0)),)
SECTIONS = {
    "in millimetres": rectangle("post", 15.7, 15.7),
    "a wire of micrometres": circle("wire", 60e-6),
    "an area in mm^2": Section("post", A=300.0, Iy=7.5e-9, Iz=7.5e-9, J=1e-8),
    "moments in mm^4": Section("post", A=3e-4, Iy=7500.0, Iz=7500.0, J=1e4),
}


@pytest.mark.parametrize("name", SECTIONS)
def test_a_section_that_does_not_fit_its_lines_is_told(name: str) -> None:
    found = told(Frame("posts", STEEL, SECTIONS[name], LINE))
    assert found.code == "implausible-section"
    assert "posts: its section" in found.message


@pytest.mark.parametrize(
    "section", [rectangle("flat", 0.3, 0.3e-3), tube("pipe", 1.0, 1e-3), circle("wire", 1e-3), rectangle("stub", 2, 3)]
)
def test_sections_are_sections(section: Section) -> None:
    assert plausibility_findings([Frame("bar", STEEL, section, LINE)]) == ()


def test_blocks_lighter_than_foam_or_denser_than_metal_are_told() -> None:
    block = Block("block", 45e3, (0.0, 0.0, 0.0), (4.0, 3.0, 1.5))
    assert plausibility_findings([block]) == ()
    for wrong in (replace(block, mass=45.0), replace(block, mass=45e6), replace(block, size=(4e3, 3e3, 1.5e3))):
        assert told(wrong).code == "implausible-mass"


# the screed from x = 3 m is half on the slab, which ends at 4 m: 1 of its 2 m^2; turned, it spans y and x in 2..3.5
def test_a_screed_over_the_edge_is_told_with_both_areas() -> None:
    (found,) = floor(x=3.0)
    assert found.code == "layer-overhang"
    assert found.values == pytest.approx({"filled_m2": 1.0, "side_m2": 2.0})
    assert re.search(r"50 % of \w+ is not supported", found.message)


def test_a_turned_screed_over_the_edge() -> None:
    (found,) = floor(x=0.25, turned=True)  # its width of 1 m runs towards -x: 0.25 m of it are on the slab
    assert found.values == pytest.approx({"filled_m2": 0.5, "side_m2": 2.0})


@pytest.mark.parametrize(
    ("material", "asked"),
    [
        (replace(STEEL, loss_factor=1.0), "steel: a loss factor of 100 %, with E 210 GPa; .* Did you mean 1 %"),
        (
            replace(CONCRETE, loss_factor=LossByFrequency(((63.0, 0.02), (250.0, 0.8)))),
            "concrete: a loss factor of 80 %",
        ),
        (Material("asphalt", 5e9, 0.35, 2300.0, loss_factor=0.4), ""),
        (Material("rubber", 5e6, 0.49, 1100.0, loss_factor=1.0), ""),
    ],
)
def test_a_loss_factor_of_a_hundred_percent_is_asked_for(material: Material, asked: str) -> None:
    found = material_findings(material)
    assert bool(found) is bool(asked)
    if asked:
        (one,) = found
        assert one.code == "implausible-damping" and not one.severe and re.search(asked, one.message)


@pytest.mark.parametrize(
    ("law", "least"),
    [(LossFactor(1.0), 50.0), (Ratio(0.25), 25.0), (Ratio(0.24), None), (LossFactor(0.02), None)],
)
def test_damping_that_no_structure_has_is_asked_for(law: LossFactor | Ratio, least: float | None) -> None:
    model = mesh_structure(Structure("a", (SLAB,), supports=(Support("edges", "simple", on="slab", edge="all"),)))
    basis = with_damping(modal_basis(assemble(model), count=3), Damping(law))
    found = [one for one in structure_findings_after(model, basis) if one.code == "implausible-damping"]
    assert bool(found) is (least is not None)
    if least is not None:
        assert f"damping ratio of {least:g} % or more, a loss factor of {2 * least:g} %" in found[0].message


def springs(at: tuple[tuple[float, float, float], ...], stiffness: tuple[float, ...], to: float) -> tuple[Finding, ...]:
    """Four feet of a machine of 2 x 1.6 x 1 m, `to` above the mid-surface of the slab, and what they stand on."""
    machine = Block("machine", 1200.0, origin=(1.0, 1.0, to), size=(2.0, 1.6, 1.0))
    corners = ((0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (0.0, 1.6, 0.0), (2.0, 1.6, 0.0))
    points = (PlaceOn("feet", "machine", at=corners), PlaceOn("below", "slab", at=at))
    isolators = Spring("isolators", "feet", "below", stiffness=(*stiffness, 0.0, 0.0, 0.0))
    held = (Support("rim", "simple", on="slab", edge="all"),)
    model = mesh_structure(Structure("machine", (SLAB, machine, isolators), points=points, supports=held))
    return structure_findings_before(model.structure, model)


def test_feet_that_are_tied_to_one_place_far_away_are_named() -> None:
    """Four feet and one point below the middle: arms of sqrt(1 + 0.8^2) m, of 5 m, and in silence."""
    own = ((1.0, 1.0), (3.0, 1.0), (1.0, 2.6), (3.0, 2.6))
    soft = (2e5, 2e5, 1e6)
    (far,) = (one for one in springs(((2.0, 1.8),), soft, 0.15) if one.code == "spring-with-long-arms")
    longest = np.sqrt(1.0 + 0.8**2 + 0.15**2)  # across x or y the height counts, too
    level = np.sqrt(1.0 + 0.8**2)
    assert far.values["arm_m"] <= longest and far.values["arm_m"] == pytest.approx(level, rel=1e-9)  # rounding
    assert "all 4 springs act on the one place 'below'" in far.message
    for at, stiffness, to in ((own, soft, 0.15), (own, (0.0, 0.0, 1e6), 2.5)):  # isolators, and props of 2.5 m
        assert "spring-with-long-arms" not in {one.code for one in springs(at, stiffness, to)}
