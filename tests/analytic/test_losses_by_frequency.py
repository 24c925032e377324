"""Loss factors by frequency: each mode has its own, against the definition U_part / U at its frequency and the direct
solution with the same table at every line."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from femstruct.assembly.matrices import Assembly, assemble
from femstruct.errors import InputError, InputErrors
from femstruct.language.models import read_model_file
from femstruct.modal.basis import ModalBasis
from femstruct.modal.damping import Damping, FromMaterials, with_damping
from femstruct.modal.frf import direct_frf, frf
from femstruct.modal.reduction import modal_basis
from femstruct.model.lay_ups import Laminate, Layer
from femstruct.model.materials import (
    EdgeWall,
    LossByFrequency,
    Material,
    laboratory_losses,
    measured_losses,
    of_plate,
    weighted,
)
from femstruct.model.mesher import mesh_structure
from femstruct.model.model import Model
from femstruct.model.regions import Region
from femstruct.model.sections import rectangle
from femstruct.model.structure import Joint, PlaceOn, Structure, Support, SurfaceOn
from femstruct.parts.foundation import Foundation
from femstruct.parts.frame import Frame
from femstruct.parts.loss_findings import total_loss_findings
from femstruct.parts.plate import Plate
from femstruct.workflow.structure_findings import structure_findings_before

TABLE = LossByFrequency(((50.0, 0.08), (100.0, 0.05), (400.0, 0.02)))
MATERIALS = Damping(FromMaterials())
MAT = LossByFrequency(((50.0, 0.2), (500.0, 0.1)))


def floor(slab: float | LossByFrequency = TABLE, mat: float | LossByFrequency = MAT) -> Model:
    """A slab on edges, on a mat under one half of it: its share of the energy differs from mode to mode."""
    concrete = Material("concrete", E=30e9, nu=0.2, rho=2400.0, loss_factor=slab)
    part = Plate("slab", concrete, 0.15, origin=(0.0, 0.0, 0.0), size=(4.0, 3.0), mesh=(8, 6))
    half = Region("rectangle", size=(2.0, 3.0), at=(1.0, 1.5))
    edges = Support("edges", "simple", on="slab", edge="all")
    points = (PlaceOn("a", "slab", ((1.3, 1.1),)), PlaceOn("b", "slab", ((3.1, 1.9),)))
    return mesh_structure(
        Structure(
            "floor", (part, Foundation("mat", "slab", half, 2e7, loss_factor=mat)), supports=(edges,), points=points
        )
    )


def solved(model: Model, up_to: float = 500.0) -> tuple[Assembly, ModalBasis]:
    assembly = assemble(model)
    return assembly, modal_basis(assembly, up_to=up_to)


def test_between_its_points_it_is_straight_over_the_logarithm_of_frequency() -> None:
    assert TABLE.at([50.0, 100.0, 200.0, 400.0]) == pytest.approx([0.08, 0.05, 0.035, 0.02], rel=1e-14)  # rounding
    assert TABLE.at([0.0, 1.0, 1e5]).tolist() == [0.08, 0.08, 0.02]
    assert TABLE.band == (50.0, 400.0)


def test_each_mode_has_its_own_by_the_strain_energy_of_the_parts() -> None:
    _, basis = solved(floor())
    damped = with_damping(basis, MATERIALS)
    modes, frequency = basis.modes, basis.frequency_hz[basis.modes]
    shares = {name: np.diag(part)[modes] / basis.omega[modes] ** 2 for name, part in basis.part_stiffness.items()}
    assert np.ptp(shares["mat"]) > 0.05 and len(frequency) > 8
    eta = shares["slab"] * np.interp(np.log(frequency), np.log([50, 100, 400]), [0.08, 0.05, 0.02])
    eta += shares["mat"] * np.interp(np.log(frequency), np.log([50, 500]), [0.2, 0.1])
    assert 2 * damped.damping_ratio[modes] == pytest.approx(eta, rel=1e-12)  # rounding
    assert np.linalg.eigvalsh(damped.hysteretic).min() > -1e-9 * np.abs(damped.hysteretic).max()  # rounding: passive


def test_one_number_is_the_table_of_it_and_its_results_are_unchanged() -> None:
    _, basis = solved(floor(0.03, 0.2))
    flat = replace(basis, loss_factors={"slab": LossByFrequency(((100.0, 0.03),)), "mat": 0.2})
    plain, table = with_damping(basis, MATERIALS), with_damping(flat, MATERIALS)
    expected = 0.03 * basis.part_stiffness["slab"] + 0.2 * basis.part_stiffness["mat"]
    assert (plain.hysteretic == expected).all()
    assert table.hysteretic == pytest.approx(plain.hysteretic, rel=1e-14, abs=1e-14 * expected.max())  # root squared
    assert [one.code for one in table.findings if one not in plain.findings] == ["loss-beyond-table"]


def test_responses_by_modes_are_those_of_the_table_at_every_line() -> None:
    """At a line the true loss factor is that of the line, a mode has that of its own frequency: they differ where the
    response is not the mode's. real_floors: up to 0.1 dB in bands; here lines, with three modes a band."""
    model = floor()
    assembly, basis = solved(model, up_to=2500.0)
    damped = with_damping(basis, MATERIALS)
    drive, at = (model.points[name].probe("z") for name in "ab")
    lines = basis.frequency_hz[basis.modes][:8]  # at resonances damping is all that counts
    modal, direct = (
        np.abs(one) for one in (frf(damped, drive, at, lines), direct_frf(assembly, drive, at, lines, MATERIALS))
    )
    assert modal == pytest.approx(direct, rel=0.01)  # 0.5 %: neighbours have their own values
    constant = direct_frf(assemble(floor(0.05, 0.15)), drive, at, lines, MATERIALS)
    assert np.abs(np.abs(constant) / direct - 1.0).max() > 0.3  # what one number would do


def test_a_force_of_a_part_has_the_parts_own_losses() -> None:
    model = floor()
    assembly, basis = solved(model, up_to=2500.0)
    damped = with_damping(basis, MATERIALS)
    lines = basis.frequency_hz[basis.modes][:3]
    drive = model.points["a"].probe("z")
    modal = frf(damped, drive, damped.outputs["mat.z"], lines, "transmissibility")
    direct = direct_frf(assembly, drive, "mat.z", lines, MATERIALS, "transmissibility")
    # 2.9 % in the third: there the mat is pressed most by the first mode, with the loss factor of that
    assert modal == pytest.approx(direct, rel=0.04)


def test_modes_outside_of_the_table_are_told() -> None:
    """By more than half an octave; of the mat only modes that strain it."""
    _, basis = solved(floor(mat=LossByFrequency(((150.0, 0.2), (200.0, 0.1)))), up_to=1500.0)
    found = [one for one in with_damping(basis, MATERIALS).findings if one.code == "loss-beyond-table"]
    told = {one.message.partition(":")[0]: one for one in found}
    frequency = basis.frequency_hz[basis.modes]
    assert told["slab"].values["modes"] == (frequency > 400 * 2**0.5).sum() > 0
    assert told["slab"].values["highest_hz"] == frequency[-1] and "given from 50 to 400 Hz" in told["slab"].message
    strained = np.diag(basis.part_stiffness["mat"])[basis.modes] > 0.01 * basis.omega[basis.modes] ** 2
    outside = (frequency < 150 / 2**0.5) | (frequency > 200 * 2**0.5)
    assert told["mat"].values["modes"] == (outside & strained).sum() < outside.sum()
    unused = with_damping(basis, Damping()).findings[len(basis.findings) :]
    assert [one.code for one in unused] == ["loss-unused"]  # of the mat, on the ground
    first = frequency[frequency > 400 * 2**0.5][0]
    alone = with_damping(solved(floor(), up_to=float(first) + 0.1)[1], MATERIALS).findings
    assert any(f" are outside, at {first:.4g} Hz, and have" in one.message for one in alone)
    near = with_damping(solved(floor(), up_to=500.0)[1], MATERIALS).findings
    assert not [one for one in near if one.code == "loss-beyond-table"]


def test_layers_weigh_tables_by_their_energy() -> None:
    lossy = Material("lossy", E=210e9, nu=0.3, rho=7850.0, loss_factor=TABLE)
    plain = Material("plain", E=210e9, nu=0.3, rho=7850.0, loss_factor=0.01)
    found = Laminate((Layer(lossy, 1e-3), Layer(plain, 1e-3), Layer(lossy, 1e-3))).section.loss_factor
    assert isinstance(found, LossByFrequency)
    expected = (26 * np.array([0.08, 0.05, 0.02]) + 0.01) / 27
    assert [one for _, one in found.points] == pytest.approx(expected, rel=1e-12)  # rounding
    assert weighted([TABLE, TABLE], [0.3, 0.7]) is TABLE


MODEL = """
materials: {clt: {E: 9 GPa, nu: 0.2, rho: 450, loss_factor: {500 Hz: 2 %, 63 Hz: 6 %, 125: 0.05}}}
parts:
  slab: {type: plate, material: clt, thickness: 0.2 m, origin: [0, 0, 0], size: [4, 3], mesh: [4, 3]}
  mat: {type: foundation, on: slab, stiffness: {normal: 10 MN/m^3}, loss_factor: {50 Hz: 20 %, 500 Hz: 10 %}}
damping: {from: materials}
"""


def test_a_table_is_read_in_any_order(tmp_path: Path) -> None:
    (tmp_path / "slab.yaml").write_text(MODEL, encoding="utf-8")
    structure = read_model_file(tmp_path / "slab.yaml").structure
    assert isinstance(structure, Structure)
    slab, mat = structure.parts
    assert isinstance(slab, Plate) and isinstance(mat, Foundation) and isinstance(slab.material, Material)
    assert slab.material.loss_factor == LossByFrequency(((63.0, 0.06), (125.0, 0.05), (500.0, 0.02)))
    assert mat.loss_factor == MAT


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("500 Hz: 2 %", "500 kg: 2 %", r"slab\.yaml:2:\d+: materials\.clt\.loss_factor.*'500 kg', which is a mass"),
        ("500 Hz: 2 %", "500 Hz: 2", r"clt\.loss_factor.*got 2, expected a ratio of at most 1\.5; .*did you mean 2 %"),
        (
            "{500 Hz: 2 %, 63 Hz: 6 %, 125: 0.05}",
            "{}",
            r"clt\.loss_factor: got no band, expected one loss factor, or one",
        ),
        ("500 Hz: 2 %", "0 Hz: 2 %", r"clt\.loss_factor.*expected a positive value: a frequency"),
    ],
)
def test_a_mistake_in_a_table_has_its_place(old: str, new: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "slab.yaml").write_text(MODEL.replace(old, new), encoding="utf-8")
    with pytest.raises(InputErrors, match=told):
        read_model_file(tmp_path / "slab.yaml")


@pytest.mark.parametrize("points", [(), ((0.0, 0.1),), ((100.0, 0.1), (50.0, 0.1)), ((50.0, -0.1),), ((50.0, 2.0),)])
def test_a_table_that_cannot_be_is_refused(points: tuple[tuple[float, float], ...]) -> None:
    with pytest.raises(InputError, match="loss_factor"):
        LossByFrequency(points)


def test_the_loss_factor_of_a_laboratory_is_that_of_the_standard() -> None:
    """eta_int + m' / (485 sqrt f) at the bands that it is for, with the digits of real_floors."""
    for mass, internal in ((322.0, 0.006), (90.0, 0.03), (460.0, 0.006)):
        loss = of_plate(laboratory_losses(internal), mass)
        assert isinstance(loss, LossByFrequency) and loss.band == (50.0, pytest.approx(5000.0))
        frequency = np.geomspace(50.0, 5000.0, 300)
        expected = internal + mass / (485.0 * np.sqrt(frequency))
        assert loss.at(frequency) == pytest.approx(expected, rel=1.2e-4)  # straight between twelve points an octave
    assert of_plate(laboratory_losses(0.006), 322.0).at(50.0) == pytest.approx(0.099892117, rel=1e-8)  # its digits
    assert measured_losses({100.0: 0.30390202}).at([100.0])[0] == pytest.approx(0.072391753, rel=1e-7)  # its digits


def test_bands_of_a_slab_with_the_laboratory_loss_factor() -> None:
    """Energy in third octaves against the hysteretic eta(f) of every line: at most 0.15 dB with each mode's own, the
    slab of real_floors (loss-factor-by-mode: 0.10 dB) driven and received at places without symmetry."""
    B, mass, a, b = 7.15e6, 322.0, 5.0, 4.0
    thickness = (12.0 * B / 30e9) ** (1 / 3)
    concrete = Material("concrete", E=30e9, nu=0.0, rho=mass / thickness, loss_factor=laboratory_losses(0.006))
    slab = Plate("slab", concrete, thickness, origin=(0.0, 0.0, 0.0), size=(a, b), mesh=(2, 2))
    loss = slab.section.loss_factor
    assert isinstance(loss, LossByFrequency)
    m, n = (one.ravel() for one in np.meshgrid(np.arange(1, 26), np.arange(1, 21), indexing="ij"))
    omega = np.sqrt(B / mass) * ((m * np.pi / a) ** 2 + (n * np.pi / b) ** 2)
    shapes = np.sin(m * np.pi * 0.273) * np.sin(n * np.pi * 0.381)
    lines = 2.0 * np.pi * np.geomspace(44.0, 1130.0, 8000)
    eta = 0.006 + mass / (485.0 * np.sqrt(lines / (2.0 * np.pi)))
    own = loss.at(omega / (2.0 * np.pi))
    exact, modal = np.zeros_like(lines), np.zeros_like(lines)
    for w, shape, at_own in zip(omega, shapes, own, strict=True):  # velocity squared, summed over the area
        exact += shape**2 * lines**2 / np.abs(w**2 * (1.0 + 1j * eta) - lines**2) ** 2
        modal += shape**2 * lines**2 / np.abs(w**2 - lines**2 + 1j * at_own * w * lines) ** 2
    for center in (50, 63, 80, 100, 125, 160, 200, 250, 315, 400, 500, 630, 800, 1000):
        band = (lines / (2 * np.pi) > center / 2 ** (1 / 6)) & (lines / (2 * np.pi) < center * 2 ** (1 / 6))
        weight = np.gradient(lines)[band]
        off = 10.0 * np.log10((modal[band] @ weight) / (exact[band] @ weight))
        assert abs(off) < 0.15  # of the issue


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ("ISO 12354-1 laboratory", laboratory_losses()),
        ("{like: ISO 12354-1 laboratory, internal: 0.6 %}", laboratory_losses(0.006)),
        ("{reverberation_times: {100 Hz: 304 ms, 50: 0.44}}", measured_losses({50.0: 0.44, 100.0: 0.304})),
    ],
)
def test_total_loss_factors_are_read(written: str, expected: LossByFrequency, tmp_path: Path) -> None:
    text = MODEL.replace("{500 Hz: 2 %, 63 Hz: 6 %, 125: 0.05}", written)
    (tmp_path / "slab.yaml").write_text(text, encoding="utf-8")
    structure = read_model_file(tmp_path / "slab.yaml").structure
    assert isinstance(structure, Structure) and isinstance(structure.parts[0], Plate)
    assert structure.parts[0].material.loss_factor == expected  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("written", "told"),
    [
        ("ISO 12354 laboratory", r"slab\.yaml:2:\d+: materials\.clt\.loss_factor: got 'ISO 12354 laboratory'"),
        ("{like: ISO 12354-2 laboratory}", r"loss_factor\.like: got .*did you mean 'ISO 12354-1 laboratory'"),
        (
            "{reverberation_times: {50 Hz: 1 ms}}",
            r"loss_factor: got times that make it 44, expected a loss factor",
        ),
        ("{reverberation_times: {50 Hz: 3 kg}}", r"clt\.loss_factor: got '3 kg', which is a mass, expected a time"),
        ("{reverberation_times: 0.3 s}", r"expected a reverberation time for each frequency"),
    ],
)
def test_a_mistake_in_a_total_loss_factor_has_its_place(written: str, told: str, tmp_path: Path) -> None:
    text = MODEL.replace("{500 Hz: 2 %, 63 Hz: 6 %, 125: 0.05}", written)
    (tmp_path / "slab.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(InputErrors, match=told):
        read_model_file(tmp_path / "slab.yaml")


def test_what_has_no_mass_per_area_has_no_loss_factor_of_a_laboratory(tmp_path: Path) -> None:
    wood = Material("wood", E=11e9, nu=0.3, rho=450.0, loss_factor=laboratory_losses())
    leg = Frame("leg", wood, rectangle("s", 0.1, 0.2), (((0.0, 0.0, 0.0), (0.0, 0.0, 3.0)),), mesh=0.5)
    with pytest.raises(InputError, match=r"leg\.material: got a loss factor of ISO 12354-1 in a part without mass per"):
        assemble(mesh_structure(Structure("leg", (leg,))))
    other = Material("other", E=11e9, nu=0.3, rho=450.0, loss_factor=0.01)
    with pytest.raises(InputError, match="ISO 12354-1"):
        _ = Laminate((Layer(wood, 0.1), Layer(other, 0.1))).section
    (tmp_path / "slab.yaml").write_text(MODEL.replace("{50 Hz: 20 %, 500 Hz: 10 %}", "ISO 12354-1 laboratory"))
    with pytest.raises(InputErrors, match=r"parts\.mat\.loss_factor: got 'ISO 12354-1 laboratory'"):
        read_model_file(tmp_path / "slab.yaml")


def test_losses_that_are_counted_twice_are_told() -> None:
    """Springs with losses at the edge of a part with a total loss factor, plates joined to it, heavy ones, rooms."""
    heavy = Material("concrete", E=30e9, nu=0.2, rho=2400.0, loss_factor=laboratory_losses(0.006))
    light = Material("board", E=3e9, nu=0.2, rho=700.0, loss_factor=measured_losses({100.0: 0.6, 200.0: 0.4}))
    slab = Plate("slab", heavy, 0.35, origin=(0.0, 0.0, 0.0), size=(4.0, 3.0), mesh=(4, 3))
    board = Plate("board", light, 0.02, origin=(0.0, 0.0, 1.0), size=(4.0, 3.0), mesh=(4, 3))
    wall = Plate("wall", heavy, 0.2, origin=(0.0, 0.0, 0.0), size=(3.0, 3.0), mesh=(3, 3), normal=(1.0, 0.0, 0.0))
    strip = Support("strip", on="slab", edge="x1", stiffness={"z": 1e7}, loss_factor=0.2)
    under = SurfaceOn("under", "board", "below")
    joint = Joint("corner", "slab", "wall")
    model = mesh_structure(
        Structure("floor", (slab, board, wall), joints=(joint,), supports=(strip,), surfaces=(under,))
    )
    found = total_loss_findings(model, {"under": "living"})
    told = {(one.code, one.message.partition(" ")[0].rstrip(":")): one.message for one in found}
    assert set(told) == {
        ("losses-counted-twice", "slab"), ("losses-counted-twice", "wall"), ("losses-counted-twice", "board"),
        ("laboratory-too-heavy", "slab"),
    }  # fmt: skip
    assert "strip (springs with losses), corner (joined to wall)" in told["losses-counted-twice", "slab"]
    assert "internal 0.6 %, 840 kg/m^2" in told["losses-counted-twice", "slab"]
    assert "the air of living (two-way)" in told["losses-counted-twice", "board"]
    plain = replace(heavy, loss_factor=0.01)
    alone = mesh_structure(Structure("floor", (replace(slab, material=plain),), supports=(strip,)))
    assert not total_loss_findings(alone)
    brick = EdgeWall(replace(plain, name="brick"), 0.175)
    edges = Support("edges", "simple", on="slab", edge="all", walls=(brick, brick))
    (once,) = total_loss_findings(
        mesh_structure(Structure("floor", (replace(slab, thickness=0.2),), supports=(edges,)))
    )
    assert once.code == "losses-counted-twice" and ": edges (walls at the edge). " in once.message
    assert [one.code for one in structure_findings_before(model.structure, model)].count("losses-counted-twice") == 2
