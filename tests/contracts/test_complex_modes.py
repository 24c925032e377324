"""Complex modes against the dense quadratic problem, proportional damping and closed forms."""

import numpy as np
import pytest
from scipy.linalg import eig
from scipy.sparse import csc_array

from femstruct.assembly.given_matrices import given_matrices
from femstruct.assembly.matrices import assemble
from femstruct.errors import InputError, InputErrors
from femstruct.modal.complex_modes import complex_modes
from femstruct.modal.damping import Damping, FromMaterials, LossFactor, Ratio, Rayleigh, with_damping
from femstruct.modal.reduction import modal_basis
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.sections import i_section
from femstruct.model.structure import PlaceOn, Structure, Support
from femstruct.parts.frame import Frame
from femstruct.parts.plate import Plate
from femstruct.parts.spring import Spring
from femstruct.study.asked import Extent
from femstruct.workflow.modes import complex_modes_of, modes_of

RUBBER = Material("rubber", E=2e9, nu=0.4, rho=1200.0, loss_factor=0.3)
STEEL = Material("steel", E=210e9, nu=0.3, rho=7850.0, loss_factor=0.01)


def braked_plate(dashpot=60.0, material=STEEL):
    """A plate on its edges with a dashpot off its middle: no mode is free of it, none is like another."""
    plate = Plate("plate", material, 0.003, origin=(0.0, 0.0, 0.0), size=(0.5, 0.4), mesh=(6, 5))
    spring = Spring("brake", "spot", None, stiffness=(0, 0, 2e3, 0, 0, 0), damping=(0, 0, dashpot, 0, 0, 0))
    return assemble(
        mesh_structure(
            Structure(
                "braked",
                (plate, spring),
                points=(PlaceOn("spot", "plate", at=((0.19, 0.13),)),),
                supports=(Support("rim", "simple", on="plate", edge="all"),),
            )
        )
    )


def dense(assembly, damping, top):
    """All eigenvalues of the companion form with |lambda| up to the top and positive imaginary part, ascending."""
    K, M, C = assembly.K.toarray(), assembly.M.toarray(), assembly.C.toarray()
    lossy = K.astype(complex)
    if isinstance(damping.base, LossFactor):
        lossy *= 1 + 1j * damping.base.value
    elif isinstance(damping.base, Rayleigh):
        C = C + damping.base.alpha * M + damping.base.beta * K
    elif isinstance(damping.base, FromMaterials):
        for part, stiffness in assembly.part_stiffness.items():
            lossy = lossy + 1j * assembly.loss_factors[part] * stiffness.toarray()
    n, scale = len(K), top  # time in units of 1 / top: otherwise the blocks of the pencil are 1e6 apart
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-lossy / scale**2, -C / scale]])
    B = np.block([[np.eye(n), np.zeros((n, n))], [np.zeros((n, n)), M]])
    values = scale * eig(A, B, right=False)
    kept = values[(values.imag > 1e-6 * np.abs(values)) & (np.abs(values) <= top)]
    return kept[np.argsort(np.abs(kept))]


@pytest.mark.parametrize("dashpot", [0.0, 60.0, 3000.0])
@pytest.mark.parametrize("law", [Ratio(0.0), LossFactor(0.05), Rayleigh(30.0, 1e-6), FromMaterials()])
def test_as_the_dense_quadratic_problem_has_them(law, dashpot):
    if isinstance(law, Ratio) and dashpot == 0.0:
        pytest.skip("no damping at all")
    assembly, damping = braked_plate(dashpot), Damping(law)
    found = complex_modes(assembly, damping, up_to=900.0)
    exact = dense(assembly, damping, 2 * np.pi * 900.0)
    assert len(found.eigenvalues) == len(exact) > 6
    np.testing.assert_allclose(found.eigenvalues, exact, rtol=1e-8)  # asked for; 1e-11 here, of the dense solver
    assert found.residual.max() < 1e-9  # of Arnoldi at rounding


def test_proportional_damping_has_the_real_modes():
    assembly, law = braked_plate(0.0), Damping(Rayleigh(20.0, 2e-6))
    found = complex_modes(assembly, law, up_to=900.0)
    real = with_damping(modal_basis(assembly, up_to=900.0), law)
    true = real.modes
    np.testing.assert_allclose(found.frequency_hz, real.frequency_hz[true], rtol=1e-8)  # rounding of two solvers
    np.testing.assert_allclose(found.damping_ratio, real.damping_ratio[true], rtol=1e-8)  # rounding of two solvers
    np.testing.assert_allclose(found.collinearity, 1.0, atol=1e-8)  # rounding of two solvers
    like = np.abs(np.einsum("nck,nck->k", found.shapes[:, :3].conj(), real.shapes[:, :3, true]))
    sizes = np.linalg.norm(found.shapes[:, :3], axis=(0, 1)) * np.linalg.norm(real.shapes[:, :3, true], axis=(0, 1))
    np.testing.assert_allclose(like, sizes, rtol=1e-7)  # shapes err by the root of the residual's gap


def test_a_strong_dashpot_makes_modes_travel():
    weak, strong = (complex_modes(braked_plate(c), Damping(Ratio(0.0)), up_to=600.0) for c in (1.0, 200.0))
    assert weak.collinearity.min() > 0.999
    assert strong.collinearity.min() < 0.98


def test_two_masses_in_closed_form():
    """lambda^2 + c lambda + k = 0 of the mode in antiphase, of two masses on one dashpot between them."""
    k, c = 400.0, 6.0
    K = csc_array([[k, -k], [-k, k]])
    C = csc_array([[c, -c], [-c, c]])
    pair = given_matrices(
        csc_array(np.eye(2)), K + 1e-6 * csc_array(np.eye(2)), nodes=[0, 1], components=[2, 2],
        points=[[0, 0, 0.0], [0, 0, 1.0]], C=C,
    )  # fmt: skip
    found = complex_modes(pair, Damping(Ratio(0.0)), up_to=10.0)
    exact = -c + 1j * np.sqrt(2 * k - c**2)
    assert found.eigenvalues[-1] == pytest.approx(exact, rel=1e-8)  # the ground spring shifts it by 1e-9
    np.testing.assert_allclose(
        found.shapes[:, 2, -1], np.array([1, -1]) * np.sign(found.shapes[0, 2, -1].real), atol=1e-9
    )  # rounding


def test_ratios_of_single_modes_are_refused():
    with pytest.raises(
        InputError, match=r"loss_factor, rayleigh or from: materials.*; write loss_factor: 4 %, the same"
    ):
        complex_modes(braked_plate(), Damping(Ratio(0.02)), up_to=500.0)


def test_damping_that_complex_modes_cannot_take_has_its_line(tmp_path):
    text = "parts:\n  b: {type: block, mass: 5 kg, origin: [0, 0, 0], size: [1, 1, 1]}\n"
    text += "  s: {type: spring, between: [foot, ground], stiffness: {z: 500 N/m}}\n"
    text += "points: {foot: {on: b, at: [0.5, 0.5, 0]}}\ndamping: {ratio: 2 %}\n"
    (tmp_path / "a.yaml").write_text(text, encoding="utf-8")
    told = "a.yaml:5:11: damping.ratio: got one damping ratio of all modes, expected damping of the whole structure"
    with pytest.raises(InputErrors, match=told):
        complex_modes_of(tmp_path / "a.yaml", Extent(up_to_hz=100.0))


def test_a_free_structure_has_rigid_modes_and_no_rounding_beside_them(tmp_path):
    """lambda = 0 is a double root: what is found near it are rounding errors, with dampings of -99 % and 100 %."""
    model = tmp_path / "free.yaml"
    model.write_text(
        "materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850, loss_factor: 1 %}}\n"
        "parts: {plate: {type: plate, material: steel, thickness: 8 mm, origin: [0, 0, 0], size: [1, 0.8], "
        "mesh: [8, 6], in_plane: elastic}}\n"
        "damping: {from: materials}\n",
        encoding="utf-8",
    )
    extent = Extent(up_to_hz=150.0)
    table, real = complex_modes_of(model, extent), modes_of(model, extent)
    assert table["kind"] == real["kind"] and table["kind"].count("rigid") == 6 < len(table["kind"])
    assert table["frequency_hz"][:6] == table["damped_hz"][:6] == [0.0] * 6
    assert table["damping_ratio"][:6] == table["collinearity"][:6] == table["residual"][:6] == [None] * 6
    # half the loss factor; |lambda| is (1 + eta^2 / 8) of the undamped one, 1.25e-5
    np.testing.assert_allclose(table["damping_ratio"][6:], 0.005, rtol=1e-4)
    np.testing.assert_allclose(table["frequency_hz"][6:], real["frequency_hz"][6:], rtol=1e-4)  # as above


def test_rates_that_gather_eigenvalues_do_not_stop_it():
    """An I beam held by beta K at 2 to 60 %: eigenvalues gather at -1 / beta; it ended "not converged: 22 of 20"."""
    section = i_section("s", 95e-3, 66e-3, 6.6e-3, 4.6e-3)
    line = ((0.0, 0.0, 0.0), (-0.644, 0.269, -0.28), (-0.377, -0.603, -0.675))
    soft = Material("soft", E=1.523e10, nu=0.342, rho=4589.0)
    points = tuple(PlaceOn(name, "f", at=(line[i],)) for name, i in (("root", 0), ("corner", 1)))
    brake = Spring("c", "corner", None, damping=(4.06, 6.38, 3.87, 0, 0, 0))
    frame = Frame("f", soft, section, (line,), 0.08, orientation=(0.252, 0.15, -0.676))
    held = (Support("wall", "clamped", at="root"),)
    assembly = assemble(mesh_structure(Structure("braked", (frame, brake), points=points, supports=held)))
    damping = Damping(Rayleigh(alpha=0.1506, beta=1.328e-3))
    found = complex_modes(assembly, damping, up_to=200.0)
    expected = dense(assembly, damping, 2 * np.pi * 200.0)
    assert found.eigenvalues == pytest.approx(expected, rel=1e-7)  # rounding of the dense problem
