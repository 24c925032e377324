"""The library against what is not in its tables: formulas of the standards, another column of the same table."""

from __future__ import annotations

import json
from math import pi, sqrt

import pytest
from typer.testing import CliRunner

from femstruct.cli import app
from femstruct.errors import InputError
from femstruct.model.library import Use
from femstruct.model.library_entries import library, look_up, matching_entries, material_like
from femstruct.model.materials import Orthotropic

# Thickness times critical frequency [m Hz] that Hopkins' table A2 prints beside speed, density and nu, at c = 343 m/s.
CRITICAL = {
    "concrete cast in situ": 17.1,
    "screed sand-cement": 20.0,
    "mortar": 26.5,
    "gypsum board natural": 43.5,
    "gypsum board flue gas": 35.8,
    "gypsum board glass fibre": 32.3,
    "gypsum plaster": 40.3,
    "chipboard": 29.5,
    "OSB": 25.2,
    "plywood birch": 16.8,
    "MDF": 25.3,
    "masonry calcium silicate": 25.9,
    "masonry dense aggregate": 20.3,
    "masonry light aggregate": 29.5,
    "masonry expanded clay": 28.2,
    "masonry clinker 1030": 35.1,
    "masonry clinker 1720": 29.5,
    "glass": 12.5,
}


def test_every_value_has_a_source_and_is_within_its_range() -> None:
    for entry in library().values():
        assert entry.facts and entry.what
        assert len({one.key for one in entry.facts}) == len(entry.facts), entry.name
        for one in entry.facts:
            assert len(one.source.work) > 5, entry.name
            if one.between is not None:
                low, high = one.between
                assert low < high, entry.name
                assert one.value is None or low <= one.value <= high, entry.name


@pytest.mark.parametrize("name", CRITICAL)
def test_critical_frequencies_are_those_of_the_table(name: str) -> None:
    """f_c h = c^2 sqrt(12 rho (1 - nu^2) / E) / 2 pi, a column of the table that no entry was made of."""
    material = material_like("one", name)
    assert not isinstance(material, Orthotropic)
    product = 343.0**2 / (2.0 * pi) * sqrt(12.0 * material.rho * (1.0 - material.nu**2) / material.E)
    assert product == pytest.approx(CRITICAL[name], abs=0.1)  # printed with one decimal; speeds are, too, rounded


def test_moduli_of_concrete_are_those_of_the_formula() -> None:
    """E_cm = 22 GPa (f_cm / 10 MPa)^0.3 with f_cm = f_ck + 8 MPa (EN 1992-1-1, table 3.1), rounded to GPa."""
    classes = [one for one in matching_entries(["concrete C"]) if "/" in one.name]
    assert len(classes) == 14
    for entry in classes:
        strength = float(entry.name.split("C")[1].split("/")[0])
        formula = 22.0 * ((strength + 8.0) / 10.0) ** 0.3
        assert (entry.number("E") or 0.0) / 1e9 == pytest.approx(formula, abs=0.6)  # printed without decimals


def test_timber_classes_follow_the_rules_of_the_standard() -> None:
    """E90 = E0 / 30 and G = E0 / 16 (EN 338), printed with two figures."""
    for entry in (one for one in library().values() if one.family == "timber"):
        E, G = entry.value("E"), entry.value("G")
        assert isinstance(E, tuple) and isinstance(G, tuple)
        assert E[1] == pytest.approx(E[0] / 30.0, rel=0.015)  # two figures
        assert G[0] == pytest.approx(E[0] / 16.0, rel=0.015)  # two figures


def test_lay_ups_are_as_thick_as_their_names_say() -> None:
    for entry in (one for one in library().values() if one.use is Use.LAY_UP):
        millimetres, layers = entry.name.removeprefix("CLT").split(" L")
        assert sum(thickness for thickness, _ in entry.layers) == pytest.approx(
            float(millimetres) / 1e3, rel=1e-12
        )  # rounding
        assert len(entry.layers) == int(layers)
        assert [angle for _, angle in entry.layers] == [90 * (n % 2) for n in range(len(entry.layers))]
        assert list(entry.layers) == list(entry.layers[::-1])


def test_hangers_are_load_over_deflection() -> None:
    """65 lbf at 5/16 inch: 208 lbf/in; a pound-force over an inch is 175.12684 N/m."""
    assert library()["hanger ARH-1-20"].number("stiffness") == pytest.approx(208.0 * 175.12684, rel=1e-6)  # its digits


def test_a_material_takes_what_is_known_better() -> None:
    slab = material_like("slab", "concrete C30/37", E=35e9, loss_factor=0.02)
    assert (slab.E, slab.rho, slab.loss_factor) == (35e9, 2300.0, 0.02)
    assert [one.split(" ")[0] for one in slab.completed] == ["nu", "rho"]
    board = material_like("board", "OSB/3", rho=620.0)
    assert isinstance(board, Orthotropic)
    assert (board.E[:2], board.G, board.rho) == ((4930e6, 1980e6), (1080e6, 50e6, 50e6), 620.0)
    assert any("EN 12369-1" in one for one in board.completed)
    joist = material_like("joist", "C24", E=(12e9, 400e6))
    assert isinstance(joist, Orthotropic) and joist.E == (12e9, 400e6, 400e6) and joist.G[1] == 69e6


def test_what_is_no_material_is_refused() -> None:
    for like, values, told in (
        ("hanger ARH-1-20", {}, "expected a material of the library"),
        ("OSB/3", {"E": 3e9}, "got one modulus, expected .* as OSB/3 has"),
        ("chipboard", {"E": (3e9, 2e9)}, "got several moduli, expected E, nu as chipboard has"),
        ("chipboard", {"G": (1e9, 1e9)}, "got G of an isotropic material"),
        ("chipboard", {"nu": (0.3, 0.3, 0.3)}, "got several ratios"),
    ):
        with pytest.raises(InputError, match=told):
            material_like("one", like, **values)  # type: ignore[arg-type]


def test_the_command_lists_and_explains() -> None:
    run = CliRunner().invoke
    everything = run(app, ["materials"]).output
    assert all(entry.name in everything for entry in library().values())
    told = run(app, ["materials", "C30/37"]).output
    assert "E 33 GPa" in told and "EN 1992-1-1:2004, table 3.1" in told and "like: ENTRY" in told
    (table,) = json.loads(run(app, ["materials", "layer", "rock", "100", "--json"]).output)
    assert table["values"]["stiffness_per_area"]["value"] == 14e6
    assert table["values"]["stiffness_per_area"]["source"].startswith("C. Hopkins")
    with pytest.raises(InputError, match=r"WORD: got 'concrete c30/35', expected .*did you mean 'concrete C30/37'"):
        look_up(["concrete", "c30/35"])
