"""Each layer of a plate loses by its own share of the energy of any motion: in modes, responses and reduced parts.

By the theorem of Hellmann and Feynman the share of a layer in the energy of a mode is d ln omega^2 / d ln E, E all
moduli of the layer: it comes from frequencies alone, of models without any losses.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import femstruct as fs
from femstruct.cli import app
from femstruct.elements import membrane, quad_shell, triangle_shell
from femstruct.files.matrices_input import read_component
from femstruct.language.models import read_model_file
from femstruct.modal.damping import material_losses
from femstruct.modal.frf import direct_frf
from femstruct.model.imported_mesh import ImportedMesh
from femstruct.model.materials import LossByFrequency
from femstruct.model.sections import rectangle

MATERIALS = fs.Damping(fs.FromMaterials())
STIFF = fs.Material("stiff", 30e9, 0.2, 2400.0, loss_factor=0.01)
SOFT = fs.Material("soft", 5e9, 0.3, 800.0, loss_factor=0.10)
WOOD = fs.Orthotropic("wood", E=(15e9, 8e9), G=(5e9, 4e9, 5e9), nu=0.25, rho=420.0, loss_factor=0.03)
OUTLINE = ((0.0, 0.0), (2.0, 0.0), (2.0, 1.4), (0.0, 1.4))
STEP = 1e-3  # of moduli: its square is what the difference is off by


def lay_up(bond: float = 1.0, **scales: float) -> fs.Laminate:
    """Three layers of three losses, nothing symmetric, one turned; moduli of layers times a factor, by name."""
    layers = []
    for material, thickness, angle in ((STIFF, 0.05, 0.0), (WOOD, 0.03, 0.6), (SOFT, 0.06, 0.0)):
        by = scales.get(material.name, 1.0)
        if isinstance(material, fs.Orthotropic):
            made = replace(
                material, E=(by * material.E[0], by * material.E[1]), G=tuple(by * one for one in material.G)
            )
        else:
            made = replace(material, E=by * material.E)
        layers.append(fs.Layer(made, thickness, angle))
    return fs.Laminate(tuple(layers), bond=bond)


def held_slab(made_of: fs.Laminate) -> fs.Structure:
    """Held in its plane at two sides, on a mat, off its nodes."""
    slab = fs.Slab("slab", made_of, made_of.thickness, OUTLINE, 0.35, offset=0.02)
    mat = fs.Foundation("mat", "slab", fs.Region("whole"), 2e6, loss_factor=0.2)
    sides = tuple(
        fs.Support(name, ("x", "y", "z"), on="slab", region=fs.Region("set", named=f"side {number}"))
        for name, number in (("l", 4), ("r", 2))
    )
    return fs.Structure("held", (slab, mat), supports=sides)


def ribbed_slab(made_of: fs.Laminate) -> fs.Structure:
    """The flange of a rib that lies below it."""
    slab = fs.Slab("slab", made_of, made_of.thickness, OUTLINE, 0.35)
    line = ((0.0, 0.7, 0.0), (2.0, 0.7, 0.0))
    offset = (0.0, 0.0, -0.17)
    rib = fs.Frame("rib", WOOD_BAR, rectangle("bar", 0.1, 0.2), (line,), 0.35, start_offset=offset, end_offset=offset)
    ends = tuple(
        fs.Support(name, ("x", "y", "z"), on="slab", region=fs.Region("set", named=f"side {number}"))
        for name, number in (("l", 4), ("r", 2))
    )
    return fs.Structure("ribbed", (slab, rib), supports=ends, joints=(fs.Joint("j", "rib", "slab"),))


WOOD_BAR = fs.Material("bar", 11e9, 0.3, 450.0, loss_factor=0.02)


def free_triangles(made_of: fs.Laminate) -> fs.Structure:
    """A free shell of triangles and quadrilaterals, folded."""
    x, y = np.meshgrid(np.linspace(0.0, 2.0, 6), np.linspace(0.0, 1.4, 5), indexing="ij")
    points = np.stack([x, y, 0.4 * np.maximum(x - 1.2, 0.0)], axis=-1).reshape(-1, 3)
    n = np.arange(len(points)).reshape(x.shape)
    quads = np.stack([n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]], axis=-1).reshape(-1, 4)
    triangles = np.concatenate([quads[:10, [0, 1, 2]], quads[:10, [0, 2, 3]]])
    cells = {"quad4": quads[10:], "tri3": triangles}
    numbers = {kind: np.arange(len(some)) for kind, some in cells.items()}
    mesh = ImportedMesh("folded", points, np.arange(len(points)), cells, numbers)
    return fs.Structure("folded", (fs.Shell("slab", mesh, made_of, orientation=(1.0, 0.0, 0.0)),))


def thin_plate(made_of: fs.Laminate) -> fs.Structure:
    """A thin plate that stretches, too: bending about its neutral surface, and sways in its plane."""
    plate = fs.Plate("slab", made_of, made_of.thickness, (0.0, 0.0, 0.0), (2.0, 1.4), (4, 4), in_plane="elastic")
    return fs.Structure("plate", (plate,))


CASES: dict[str, Callable[[fs.Laminate], fs.Structure]] = {
    "slab": held_slab, "ribbed": ribbed_slab, "triangles": free_triangles, "plate": thin_plate,
}  # fmt: skip


def solved(structure: fs.Structure, count: int = 14) -> Any:
    return fs.modal_basis(fs.assemble(fs.mesh_structure(structure)), count=count)


def elastic_modes(basis: Any) -> Any:
    return np.arange(len(basis.omega))[basis.modes][basis.n_rigid :]


@pytest.mark.parametrize("bond", [1.0, 0.3])
@pytest.mark.parametrize("case", CASES)
def test_a_layer_loses_by_its_share_of_each_mode(case: str, bond: float) -> None:
    made = CASES[case]
    basis = solved(made(lay_up(bond)))
    elastic = elastic_modes(basis)
    squared = basis.omega[elastic] ** 2
    found = {}
    for name in ("stiff", "wood", "soft"):
        more, less = (solved(made(lay_up(bond, **{name: 1.0 + by}))).omega[elastic] ** 2 for by in (STEP, -STEP))
        share = np.diag(basis.part_stiffness[f"slab ({name})"])[elastic] / squared
        # 4e-6 of the step, 1e-9 / 1e-3 of the eigensolver: 1e-5, of shares up to 0.9. The strains that triangles assume
        # depend on the section: 1.6e-3 with these few
        near = 2e-3 if case == "triangles" else 2e-5
        assert share == pytest.approx((more - less) / (2.0 * STEP * squared), abs=near)
        found[name] = share
    damped = fs.with_damping(basis, MATERIALS)
    eta = 0.01 * found["stiff"] + 0.03 * found["wood"] + 0.10 * found["soft"]
    others = {"mat": 0.2, "rib": 0.02}
    for name in others.keys() & basis.part_stiffness.keys():
        eta = eta + others[name] * np.diag(basis.part_stiffness[name])[elastic] / squared
    assert 2.0 * damped.damping_ratio[elastic] == pytest.approx(eta, rel=1e-12)  # rounding
    assert np.ptp(found["soft"]) > 0.02  # bending, stretching and shear share differently


def test_shares_of_elements_add_up_whatever_their_shape() -> None:
    """K of all losses at once, as the imaginary part of complex rigidities has it, is the sum of the shares."""
    section = lay_up().section
    whole = (section.A, section.B, section.D, section.As)
    shares = [(one.A, one.B, one.D, one.As) for one in section.shares]
    losses = np.array([one.loss_factor for one in section.shares])
    at_once = tuple(sum(eta * one[i] for eta, one in zip(losses, shares, strict=True)) for i in range(4))
    warped = [[[0, 0, 0], [0.1, 1.1, 0.05], [1.2, 0.9, 0], [1.0, 0.1, 0.04]]]
    for kind, corners in ((quad_shell, warped), (triangle_shell, [[[0, 0, 0], [1.1, 0.1, 0], [0.3, 0.9, 0.2]]])):
        each = np.array([kind.stiffness(corners, *whole, share=one)[0] for one in shares])
        K = kind.stiffness(corners, *whole)[0]
        assert each.sum(axis=0) == pytest.approx(K, abs=1e-12 * np.abs(K).max())  # rounding
        lost = kind.stiffness(corners, *whole, share=at_once)[0]
        assert np.tensordot(losses, each, 1) == pytest.approx(lost, abs=1e-12 * np.abs(lost).max())  # rounding
    square = membrane.rectangle(1.0, 0.7)
    each = np.array([membrane.stiffness(square, section.A, share=one[0])[0] for one in shares])
    K = membrane.stiffness(square, section.A)[0]
    assert each.sum(axis=0) == pytest.approx(K, abs=1e-12 * np.abs(K).max())  # rounding


def test_a_sandwich_loses_in_its_plane_as_its_layers_stretch() -> None:
    """Equal skins, a core: sum eta E h / sum E h of all motions in the plane, by far not the loss of bending."""
    core = replace(SOFT, nu=0.2)
    made_of = fs.Laminate((fs.Layer(STIFF, 0.01), fs.Layer(core, 0.1), fs.Layer(STIFF, 0.01)))
    structure = fs.Structure("free", (fs.Slab("slab", made_of, 0.12, OUTLINE, 0.2),))
    basis = fs.with_damping(solved(structure, 24), MATERIALS)
    in_plane = np.abs(basis.shapes[:, :2]).max(axis=(0, 1)) > 10.0 * np.abs(basis.shapes[:, 2]).max(axis=0)
    chosen = np.intersect1d(np.flatnonzero(in_plane), elastic_modes(basis))
    expected = (0.01 * 30e9 * 0.02 + 0.10 * 5e9 * 0.1) / (30e9 * 0.02 + 5e9 * 0.1)
    assert len(chosen) >= 2
    assert 2.0 * basis.damping_ratio[chosen] == pytest.approx(expected, rel=1e-9)  # of the eigensolver
    assert abs(made_of.section.loss_factor / expected - 1.0) > 0.3  # what all modes had


def test_resonances_and_decays_follow_and_losses_by_frequency_do() -> None:
    table = LossByFrequency(((20.0, 0.06), (400.0, 0.14)))
    layers = (fs.Layer(STIFF, 0.05), fs.Layer(replace(SOFT, loss_factor=table), 0.06))
    structure = held_slab(fs.Laminate(layers))
    point = fs.PlaceOn("q", "slab", ((0.9, 0.6),))
    model = fs.mesh_structure(replace(structure, points=(point,)))
    assembly = fs.assemble(model)
    basis = fs.modal_basis(assembly, up_to=1500.0)
    damped, q = fs.with_damping(basis, MATERIALS), model.points["q"].probe("z")
    hz = basis.frequency_hz[basis.modes][:3]
    squared = basis.omega[:3] ** 2
    shares = {name: np.diag(part)[:3] / squared for name, part in basis.part_stiffness.items()}
    eta = 0.01 * shares["slab (stiff)"] + table.at(hz) * shares["slab (soft)"] + 0.2 * shares["mat"]
    assert 2.0 * damped.damping_ratio[:3] == pytest.approx(eta, rel=1e-12)  # rounding
    modal, direct = (np.abs(one) for one in (fs.frf(damped, q, q, hz), direct_frf(assembly, q, q, hz, MATERIALS)))
    assert modal == pytest.approx(direct, rel=0.01)  # neighbours have losses of their own frequency


MODEL = """
materials:
  stiff: {E: 30 GPa, nu: 0.2, rho: 2400, loss_factor: 1 %}
  soft: {E: 5 GPa, nu: 0.3, rho: 800, loss_factor: 10 %}
parts:
  s: PART
supports: {l: {on: s, set: side 4, fix: [x, y, z]}, r: {on: s, set: side 2, fix: [x, y, z]}}
damping: {from: materials}
"""
SLAB = (
    "{type: slab, layers: [[stiff, 50 mm], [soft, 60 mm]], mesh: 0.35, outline: [[0, 0], [2, 0], [2, 1.4], [0, 1.4]]}"
)


def test_a_reduced_part_keeps_the_losses_of_its_layers(tmp_path: Path) -> None:
    def losses(name: str) -> Any:
        source = read_model_file(tmp_path / name)
        assert isinstance(source.structure, fs.Structure)
        basis = fs.with_damping(solved(source.structure, 3), source.damping)
        return 2.0 * basis.damping_ratio[:3]

    (tmp_path / "whole.yaml").write_text(MODEL.replace("PART", SLAB), encoding="utf-8")
    words = ("reduce", tmp_path / "whole.yaml", "--part", "s", "--up-to", "2 kHz", "-o", tmp_path / "s.npz")
    done = CliRunner().invoke(app, [str(word) for word in words])
    assert done.exit_code == 0, done.output
    built = MODEL.replace("PART", "{type: reduced, file: s.npz}").replace("side 4", "l").replace("side 2", "r")
    (tmp_path / "built.yaml").write_text(built, encoding="utf-8")
    one = built.replace("s.npz}", "s.npz, loss_factor: 2 %}")
    (tmp_path / "one.yaml").write_text(one, encoding="utf-8")
    whole = losses("whole.yaml")
    assert losses("built.yaml") == pytest.approx(whole, rel=1e-4)  # modes to 2 kHz
    assert np.ptp(whole) > 0.01
    assert losses("one.yaml") == pytest.approx(0.02, rel=1e-9)  # what is given for the part goes first
    component = read_component(tmp_path / "s.npz")
    total = sum(share.stiffness.toarray() for share in component.shares)
    K = component.K.toarray()
    assert total == pytest.approx(K, abs=1e-12 * np.abs(K).max())  # rounding


def test_layers_that_lose_alike_are_one_and_nothing_is_driven() -> None:
    alike = fs.Laminate(tuple(fs.Layer(replace(one, loss_factor=0.03), 0.02) for one in (STIFF, SOFT)))
    assert alike.section.shares == () and alike.section.loss_factor == 0.03
    rubber = fs.Material("rubber", 3e6, 0.48, 1100.0)
    lossy = replace(STIFF, loss_factor=0.5)
    skins = fs.Laminate((fs.Layer(lossy, 1e-3), fs.Layer(rubber, 5e-3), fs.Layer(replace(lossy, E=3e9), 4e-3)))
    for share in skins.section.shares:
        assert np.linalg.eigvals(np.linalg.solve(skins.section.As, share.As)).real.min() > -1e-12  # rounding
    assembly = fs.assemble(fs.mesh_structure(fs.Structure("s", (fs.Slab("s", skins, 0.01, OUTLINE, 0.35),))))
    basis = fs.modal_basis(assembly, count=20)
    losses = material_losses(basis)
    assert np.linalg.eigvalsh(losses).min() > -1e-9 * np.abs(losses).max()  # rounding of rigid modes
