"""Plates of orthotropic materials, layers and smeared ribs: Navier's frequencies, what they weigh, what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from femstruct.assembly.matrices import assemble
from femstruct.errors import FemstructError
from femstruct.modal.reduction import modal_basis
from femstruct.model.lay_ups import Laminate, Layer, LayUp, Smeared, section_of
from femstruct.model.materials import AnyMaterial, Material, Orthotropic
from femstruct.model.mesher import mesh_structure
from femstruct.model.sections import rectangle
from femstruct.model.structure import Joint, Structure, Support
from femstruct.parts.frame import Frame
from femstruct.parts.loss_findings import layer_loss_findings
from femstruct.parts.plate import Plate, PlateMesh
from femstruct.parts.plausibility import material_findings, plausibility_findings
from femstruct.parts.rib_findings import rib_errors
from femstruct.parts.wave_findings import bending_wavelength, mesh_findings, model_findings, shear_excess
from femstruct.workflow.structure_findings import structure_findings_before

ROUNDING = 1e-12  # sums of some tens of terms in double precision
RIGHT = np.pi / 2
STEEL = Material("steel", E=210e9, nu=0.3, rho=7850.0)
SPRUCE = Orthotropic("spruce", E=(11e9, 370e6), G=(690e6, 50e6), nu=0.35, rho=420.0, loss_factor=0.03)
CLT = Laminate(tuple(Layer(SPRUCE, 0.04, angle) for angle in (0.0, RIGHT, 0.0, RIGHT, 0.0)))
SIZE = (5.0, 4.0)


def structure(made_of: AnyMaterial | LayUp, thickness: float, **more: Any) -> Structure:
    usual = {"origin": (0.0, 0.0, 0.0), "size": SIZE, "mesh": (10, 8)}
    slab = Plate("slab", made_of, thickness, **(usual | more))
    return Structure("slab", (slab,), supports=(Support("edges", "simple", on="slab", edge="all"),))


def meshed(made_of: AnyMaterial | LayUp, thickness: float, **more: Any) -> PlateMesh:
    part = mesh_structure(structure(made_of, thickness, **more)).parts["slab"]
    assert isinstance(part, PlateMesh)
    return part


def navier(section: Any, count: int) -> list[float]:
    """Thin simply supported plate: (2 pi f)^2 m0 = D11 x^4 + 2 (D12 + 2 D66) x^2 y^2 + D22 y^4."""
    x, y = (np.pi * np.arange(1, 9) / side for side in SIZE)
    x, y, D = x[:, None], y[None], section.bending
    squared = (D[0, 0] * x**4 + 2 * (D[0, 1] + 2 * D[2, 2]) * x**2 * y**2 + D[1, 1] * y**4) / section.m0
    return sorted((np.sqrt(squared) / 2 / np.pi).ravel().tolist())[:count]


@pytest.mark.parametrize(
    ("made_of", "thickness"),
    [
        (SPRUCE, 0.03),
        (CLT, 0.2),
        (Laminate((Layer(STEEL, 2e-3), Layer(SPRUCE, 0.04), Layer(STEEL, 1e-3))), 0.043),
        (Smeared(D=(5.9e6, 1.7e6, 0.09e6, 0.46e6), S=(16e6, 10e6), mass=84.0, thickness=0.2), 0.2),
    ],
    ids=["spruce", "clt", "unsymmetric sandwich", "smeared"],
)
def test_a_layered_plate_has_naviers_frequencies(made_of: AnyMaterial | LayUp, thickness: float) -> None:
    basis = modal_basis(assemble(mesh_structure(structure(made_of, thickness, mesh=(20, 24)))), count=6)
    found = basis.frequency_hz[basis.modes][:6]
    # bfs16 with 20 x 24 cells: 7e-5 of the sixth mode, as h^4
    assert found == pytest.approx(navier(section_of(made_of, thickness), 6), rel=1e-4)
    assert basis.total_mass == pytest.approx(section_of(made_of, thickness).m0 * 20.0, rel=ROUNDING)


def test_a_plate_whose_layers_are_turned_is_the_plate_turned() -> None:
    """Diagonal layers couple bending and twist (D16): free plates of a quarter turn, not of Navier's."""
    diagonal = Laminate((Layer(SPRUCE, 0.02, 0.5),))
    turned = Laminate((Layer(SPRUCE, 0.02, 0.5 - RIGHT),))
    found = []
    for made_of, size, mesh in ((diagonal, (1.2, 1.0), (6, 5)), (turned, (1.0, 1.2), (5, 6))):
        slab = Plate("slab", made_of, 0.02, origin=(0.0, 0.0, 0.0), size=size, mesh=mesh)
        basis = modal_basis(assemble(mesh_structure(Structure("free", (slab,)))), count=12)
        found.append(basis.frequency_hz[basis.modes][basis.n_rigid : 12])
    assert len(found[0]) >= 6
    assert found[0] == pytest.approx(found[1], rel=1e-7)  # of eigenvalues with the rounding of rigid modes
    assert abs(section_of(diagonal, 0.02).D[0, 2]) > 0.1 * section_of(diagonal, 0.02).D[1, 1]


def test_one_isotropic_layer_is_the_plate_of_its_material() -> None:
    one, other = section_of(STEEL, 5e-3), Laminate((Layer(STEEL, 2e-3), Layer(STEEL, 3e-3, 0.4))).section
    for name in ("A", "D", "As"):
        largest = getattr(one, name).max()
        assert getattr(other, name) == pytest.approx(getattr(one, name), rel=1e-11, abs=1e-12 * largest)  # rounding
    assert not other.coupled and (other.m0, other.m2) == pytest.approx((one.m0, one.m2), rel=ROUNDING)


def test_layers_weigh_the_loss_factor_by_their_share_of_bending() -> None:
    """Equal layers with other losses: (13 + 1 + 13) / 27 of three; the skins of a sandwich take all."""
    lossy = Material("lossy", E=210e9, nu=0.3, rho=7850.0, loss_factor=0.27)
    for layers, told in (((STEEL, lossy, STEEL), 0.01), ((lossy, STEEL, STEEL), 0.13), ((lossy,) * 3, 0.27)):
        made_of = Laminate(tuple(Layer(one, 1e-3) for one in layers))
        assert made_of.section.loss_factor == pytest.approx(told, rel=1e-11)  # rounding
    # two layers, about their neutral surface as a transformed section
    soft = Material("soft", E=21e9, nu=0.3, rho=1000.0, loss_factor=1.0)
    E, thick, centre = np.array([210e9, 21e9]), np.array([2e-3, 5e-3]), np.array([1e-3, 4.5e-3])
    neutral = (E * thick * centre).sum() / (E * thick).sum()
    energies = E * (thick**3 / 12 + thick * (centre - neutral) ** 2)
    both = Laminate((Layer(STEEL, thick[0]), Layer(soft, thick[1])))
    assert both.section.loss_factor == pytest.approx(energies[1] / energies.sum(), rel=1e-11)  # rounding
    rubber = Material("rubber", E=3e6, nu=0.48, rho=1100.0, loss_factor=1.0)
    sandwich = Laminate((Layer(STEEL, 1e-3), Layer(rubber, 5e-3), Layer(STEEL, 1e-3)))
    assert 0.0 < sandwich.section.loss_factor < 1e-3
    assert sandwich.section.shear_loss_factor == pytest.approx(1.0, abs=1e-3)  # the skins hardly shear: 1e-4 of it
    floor = structure(sandwich, 7e-3)
    found = structure_findings_before(floor, mesh_structure(floor), ())
    (told,) = (one for one in found if one.code == "layers-lose-in-shear")
    assert told.values["shear_loss_factor"] == sandwich.section.shear_loss_factor
    assert "0.00" in told.message and "100 % in transverse shear" in told.message
    assert not layer_loss_findings(mesh_structure(structure(CLT, 0.2)))


def test_turned_axes_turn_back() -> None:
    section = Laminate((Layer(STEEL, 2e-3), Layer(SPRUCE, 0.04))).section
    back = section.turned(0.4).turned(-0.4)
    assert pytest.approx(section.D, rel=ROUNDING, abs=ROUNDING * section.D.max()) == back.D


def test_the_shear_that_plates_leave_out_is_told_for_layers() -> None:
    """CLT of 5 x 40 mm: laminates with shear have 23.05 Hz (`test_laminates`), the plate 24.9 Hz. With rolling shear of
    50 MPa, at 100 Hz in the direction that shears most: k^2 D / S with k^2 = omega sqrt(m0 / D)."""
    part, section = meshed(CLT, 0.2), CLT.section
    first = navier(section, 1)[0]
    assert shear_excess(part) == pytest.approx(first / 23.0465 - 1.0, rel=0.15)  # of first order in the excess
    model = mesh_structure(structure(CLT, 0.2))
    assert [one.code for one in model_findings(model)] == ["thick-plate"]
    (told,) = (one for one in mesh_findings(model, 100.0) if one.code == "layers-shear")
    ratio = 2 * np.pi * 100.0 * np.sqrt(84.0 * section.D[0, 0]) / section.As[0, 0]
    assert told.values["shear_share"] == pytest.approx(ratio / (1 + ratio), rel=1e-9)  # rounding
    assert told.severe and "at 0 degrees to its x" in told.message
    across = Laminate(tuple(Layer(layer.material, layer.thickness, layer.angle + RIGHT) for layer in CLT.layers))
    (turned,) = (one for one in mesh_findings(mesh_structure(structure(across, 0.2)), 100.0) if "shear" in one.code)
    assert "at 90 degrees to its x" in turned.message
    # stiff in bending and in shear along x, soft in both along y: there it shears more although it bends less
    deck = Smeared(D=(4e6, 1e6, 0.0, 0.3e6), S=(90e6, 5e6), mass=84.0, thickness=0.2)
    (weak,) = (one for one in mesh_findings(mesh_structure(structure(deck, 0.2)), 100.0) if one.code == "layers-shear")
    assert "at 90 degrees to its x" in weak.message
    limit = told.values["carried_hz"]
    assert limit == pytest.approx(100.0 / 9.0 / ratio, rel=1e-9)  # rounding
    assert not [one for one in mesh_findings(model, 0.99 * limit) if one.code == "layers-shear"]
    near = [one for one in mesh_findings(model, 1.01 * limit) if one.code == "layers-shear"]
    assert len(near) == 1 and not near[0].severe
    # the mesh is judged by the direction with the shortest waves: nearly the weak one, the twist is weaker still
    weak = 2 * np.pi * (section.D[1, 1] / section.m0) ** 0.25 / np.sqrt(2 * np.pi * 100.0)
    assert 0.98 * weak < bending_wavelength(part, 100.0) < weak


def test_stresses_of_layers_are_those_of_a_clamped_strip_in_its_layers() -> None:
    """A strip bent to a known curvature: sigma = E_k z kappa in every layer, at both faces of it; nu 0, so no width."""
    board = Orthotropic("board", E=(10e9, 1e9), G=(1e9, 1e8), nu=0.0, rho=400.0)
    part = meshed(Laminate((Layer(board, 0.01), Layer(board, 0.02, RIGHT), Layer(board, 0.01))), 0.04, size=(1.0, 0.2))
    places = part.stresses(part.first + len(part.places))
    kappa, x = 1e-3, part.local[:, 0]
    moved = np.zeros((len(x), 7, 1))  # w = -kappa x^2 / 2, RY = -dw/dx
    moved[:, 2, 0], moved[:, 4, 0] = -kappa * x**2 / 2, kappa * x
    found = places.of(moved)[:, :, 0].reshape(len(x), 6, 3)
    expected = kappa * np.array([-0.02 * 10e9, -0.01 * 10e9, -0.01 * 1e9, 0.01 * 1e9, 0.01 * 10e9, 0.02 * 10e9])
    assert found[:, :, 0] == pytest.approx(np.tile(expected, (len(x), 1)), rel=1e-9)  # rounding
    assert np.abs(found[:, :, 1:]).max() < 1e-9 * 2e5  # rounding
    assert places.sides[:2] == ("below layer 1", "above layer 1") and len(places.sides) == 6
    assert places.places.reshape(-1, 6, 3)[0, :, 2] == pytest.approx([-0.02, -0.01, -0.01, 0.01, 0.01, 0.02])
    with pytest.raises(FemstructError, match=r"stresses: got smeared ribs"):
        meshed(Smeared((1e6, 1e6, 0.0, 1e5), (1e7, 1e7), 80.0, 0.2), 0.2).stresses(99)


def deck(made_of: AnyMaterial | LayUp, size: tuple[float, float], along_x: bool) -> Structure:
    """A plate that is rigid in its plane, with a rib under its middle line."""
    plate = Plate("deck", made_of, 0.03, origin=(0.0, 0.0, 0.0), size=size, mesh=0.1, in_plane="rigid")
    x, y = size
    line = ((0.0, y / 2, 0.0), (x, y / 2, 0.0)) if along_x else ((x / 2, 0.0, 0.0), (x / 2, y, 0.0))
    down = (0.0, 0.0, -0.075)
    rib = Frame("rib", SPRUCE, rectangle("r", 0.04, 0.12), (line,), start_offset=down, end_offset=down)
    return Structure("deck", (plate, rib), (Joint("glue", "rib", "deck"),))


def test_ribs_on_a_plate_of_layers_are_judged_along_their_own_direction() -> None:
    """A deck with its rib, and the same deck and rib turned by a right angle: the same ratios. Per width along the rib
    a board has E t, here 11 GPa: rigid over true stiffness of the T as of beams."""
    board = Laminate((Layer(SPRUCE, 0.03),))
    turned = Laminate((Layer(SPRUCE, 0.03, RIGHT),))
    one, other = (
        rib_errors(mesh_structure(deck(*given)))[0]
        for given in ((board, (2.0, 0.6), True), (turned, (0.6, 2.0), False))
    )
    assert (one.bending, one.torsion) == pytest.approx((other.bending, other.torsion), rel=1e-9)  # rounding
    stiff, strip, e = 11e9 * 0.04 * 0.12, 11e9 * 0.03 * 0.6, 0.075
    alone = board.section.D[0, 0] * 0.6 + 11e9 * 0.04 * 0.12**3 / 12
    expected = (alone + stiff * e**2) / (alone + e**2 * stiff * strip / (stiff + strip))
    assert one.bending == pytest.approx(expected, rel=1e-9)  # rounding


def test_layers_that_are_not_symmetric_are_told_with_both_rigidities() -> None:
    """Concrete on timber: the neutral surface of a transformed section, nu alike."""
    timber = Material("timber", E=10e9, nu=0.2, rho=450.0)
    concrete = Material("concrete", E=30e9, nu=0.2, rho=2400.0)
    floor = structure(Laminate((Layer(timber, 0.12), Layer(concrete, 0.06))), 0.18)
    (told,) = (one for one in model_findings(mesh_structure(floor)) if one.code == "unsymmetric-layers")
    E, thick, centre = np.array([10e9, 30e9]) / 0.96, np.array([0.12, 0.06]), np.array([0.06, 0.15])
    neutral = (E * thick * centre).sum() / (E * thick).sum()
    assert told.values["off_m"] == pytest.approx(neutral - 0.09, rel=ROUNDING)
    for key, axis in (("free_n_m", neutral), ("held_n_m", 0.09)):
        rigidity = (E * (thick**3 / 12 + thick * (centre - axis) ** 2)).sum()
        assert told.values[key] == pytest.approx(rigidity, rel=1e-11)  # rounding
    assert not [one for one in model_findings(mesh_structure(structure(CLT, 0.2))) if one.code == "unsymmetric-layers"]


def orthotropic(**changed: Any) -> Orthotropic:
    usual: dict[str, Any] = {"E": (11e9, 370e6), "G": (690e6, 50e6), "nu": 0.35, "rho": 420.0}
    return Orthotropic("spruce", **(usual | changed))


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: orthotropic(E=(11e9,)), r"materials\.spruce\.E: got .*expected two or three positive moduli"),
        (lambda: orthotropic(E=(11e9, -1.0)), r"spruce\.E: got \(1\.1e\+10, -1\) Pa, expected two or three positive"),
        (lambda: orthotropic(G=690e6), r"spruce\.G: got 690000000\.0, expected a tuple of numbers"),
        (lambda: orthotropic(nu=(0.35, 0.4)), r"spruce\.nu: got 2 ratios, expected nuxy, or nuxy, nuyz and nuzx"),
        (
            # 0.35 is nuxz, as books list it for timber: nuzx = nuxz Ez / Ex
            lambda: orthotropic(nu=(0.35, 0.4, 0.35)),
            r"spruce\.nu: got nuzx = 0\.35 with Ez = 3\.7e\+08 Pa and Ex = 1\.1e\+10 Pa, expected less than "
            r"sqrt\(Ez / Ex\) = 0\.1834; .*if 0\.35 is nuxz, write 0\.01177",
        ),
        (lambda: orthotropic(nu=(6.0, 0.4, 0.01)), r"nuxy = 6 .*less than sqrt\(Ex / Ey\) = 5\.452"),
        (lambda: orthotropic(nu=(4.0, 0.9, 0.15)), r"nuzx nuxz - 2 nuxy nuyz nuzx = -.*expected a sum above 0"),
        (lambda: orthotropic(rho=-1.0), r"spruce\.rho: got -1 kg/m\^3"),
        (lambda: orthotropic(loss_factor=3.0), r"spruce\.loss_factor: got 3"),
        (lambda: Layer("spruce", 0.04), r"layers\.material: got 'spruce', expected a Material or an Orthotropic"),
        (lambda: Layer(SPRUCE, 0.0), r"layers\.thickness: got 0 m, expected a positive length"),
        (lambda: Laminate(()), r"laminate\.layers: got no layer"),
        (lambda: Laminate((SPRUCE,)), r"laminate\.layers: got \(Orthotropic.*expected a tuple of Layer"),
        (
            lambda: Smeared((1e6, 1e6, 2e6, 1e5), (1e7, 1e7), 80.0, 0.2),
            r"D12 = 2e\+06, expected less than sqrt.* 1e\+06",
        ),
        (lambda: Smeared((1e6, 1e6, 0.0, 1e5), (1e7, 0.0), 80.0, 0.2), r"smeared\.S: got 1e\+07, 0, expected 2"),
        (lambda: meshed(CLT, 0.18), r"parts\.slab\.thickness: got 0\.18 m, expected 0\.2 m, that of its layers"),
        (lambda: meshed(CLT, 0.2, element="hermite12"), r"slab\.element: got hermite12 with .*expected bfs16 or acm12"),
    ],
)
def test_refused(make: Any, told: str) -> None:
    with pytest.raises(FemstructError, match=told):
        make()


def test_an_orthotropic_material_that_no_solid_has_is_told() -> None:
    """MPa meant and GPa written, along the grain or across it."""
    for E in ((11e12, 370e6), (11e9, 370.0)):
        found = [one for one in material_findings(orthotropic(E=E, nu=0.001)) if one.severe]
        assert [one.code for one in found] == ["implausible-material"]


def test_what_is_not_given_is_completed_and_said() -> None:
    assert SPRUCE.E == (11e9, 370e6, 370e6) and SPRUCE.G == (690e6, 50e6, 690e6)
    assert SPRUCE.ratios == (0.35, 0.35, pytest.approx(0.35 * 370 / 11000, rel=ROUNDING))
    assert SPRUCE.completed == ("Ez = Ey", "Gzx = Gxy", "nuyz = nuxy", "nuzx = nuxy Ez / Ex")
    (told,) = plausibility_findings((Plate("board", SPRUCE, 0.04, (0.0, 0.0, 0.0), (1.0, 1.0), 0.5),))
    assert told.code == "material-completed" and not told.severe
    assert "spruce: Ez = Ey, Gzx = Gxy, nuyz = nuxy, nuzx = nuxy Ez / Ex complete what was given" in told.message
    assert told.message.endswith(
        "Ex, Ey, Ez: 11 GPa, 370 MPa, 370 MPa; Gxy, Gyz, Gzx: 690 MPa, 50 MPa, 690 MPa; "
        "nuxy, nuyz, nuzx: 0.35, 0.35, 0.0118"
    )
    whole = orthotropic(E=SPRUCE.E, G=SPRUCE.G, nu=SPRUCE.nu)
    assert material_findings(whole) == ()
    assert whole.completed == () and whole.elasticity == pytest.approx(SPRUCE.elasticity, rel=ROUNDING)
    isotropic = orthotropic(E=(210e9,) * 3, G=(210e9 / 2.6,) * 3, nu=0.3)
    assert isotropic.elasticity[3, 3] == pytest.approx(STEEL.G, rel=ROUNDING)
    assert isotropic.elasticity[0, 1] == pytest.approx(210e9 * 0.3 / 1.3 / 0.4, rel=ROUNDING)  # Lamé's lambda
