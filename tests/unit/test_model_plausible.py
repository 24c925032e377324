"""Findings about models that forgot a unit, or a part that hangs over the edge of what carries it."""

from __future__ import annotations

import pytest

from femstruct.errors import Finding
from femstruct.model.material import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.parts import Foundation, Plate, Region, Structure
from femstruct.model.plausible import plausible_findings


def floor(E: float = 30e9, rho: float = 2400.0, x: float = 0.5, turned: bool = False) -> tuple[Finding, ...]:
    """A slab of 4 x 3 m and a screed of 2 x 1 m, lying from x on, on a layer over all that both share."""
    stuff = Material("stuff", E=E, nu=0.2, rho=rho)
    slab = Plate("slab", stuff, 0.2, origin=(0.0, 0.0, 0.0), size=(4.0, 3.0), mesh=(4, 3))
    normal, along = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)) if turned else ((0.0, 0.0, 1.0), None)
    screed = Plate(
        "screed", stuff, 0.06, origin=(x, 0.5, 0.15), size=(2.0, 1.0), mesh=(2, 1), normal=normal, x_direction=along
    )
    wool = Foundation("wool", "screed", Region("whole"), 10e6, to="slab")
    return plausible_findings(mesh_structure(Structure("floor", (slab, screed, wool))))


@pytest.mark.parametrize("x", [0.0, 0.5, 2.0])
def test_nothing_is_said_of_a_floor_as_floors_are(x: float) -> None:
    assert floor(x=x) == ()


# sqrt(E / rho): 30 kPa in place of 30 GPa runs at 3.54 m/s, 2.4 kg/m^3 in place of 2.4 t/m^3 at 112 km/s
@pytest.mark.parametrize(("E", "rho", "speed"), [(30e3, 2400.0, 3.5355), (30e9, 2.4, 111803.4)])
def test_a_material_no_solid_has_is_told_once(E: float, rho: float, speed: float) -> None:
    (found,) = floor(E=E, rho=rho)
    assert found.code == "unlike-a-solid"
    assert found.values["wave_speed_m_s"] == pytest.approx(speed, rel=1e-4)  # digits above
    assert f"{rho:.4g} kg/m^3" in found.message


# rubber, polyurethane foam, acrylic, steel, beryllium and diamond: all are solids
@pytest.mark.parametrize(
    ("E", "rho"), [(1e6, 1100), (50e3, 30), (5.9e9, 1172), (210e9, 7850), (287e9, 1850), (1.05e12, 3510)]
)
def test_solids_are_solids(E: float, rho: float) -> None:
    assert floor(E=E, rho=rho) == ()


# the screed from x = 3 m is half on the slab, which ends at 4 m: 1 of its 2 m^2; turned, it spans y and x in 2..3.5
def test_a_screed_over_the_edge_is_told_with_both_areas() -> None:
    (found,) = floor(x=3.0)
    assert found.code == "layer-overhang"
    assert found.values == pytest.approx({"filled_m2": 1.0, "side_m2": 2.0})
    assert "50 % of it lies on nothing" in found.message


def test_a_turned_screed_over_the_edge() -> None:
    (found,) = floor(x=0.25, turned=True)  # its width of 1 m runs towards -x: 0.25 m of it are on the slab
    assert found.values == pytest.approx({"filled_m2": 0.5, "side_m2": 2.0})
