"""Matrices come and go: what is assembled here, carried away as plain matrices and brought back, answers the same."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import scipy

import femstruct as fs
from femstruct.conventions import N_COMPONENTS, UX, UY
from femstruct.errors import FemstructError
from femstruct.modal.frf import direct_frf
from femstruct.model.probe import Probe
from femstruct.model.sections import rectangle

STEEL = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0, loss_factor=0.01)
POST = fs.Frame("post", STEEL, rectangle("bar", 0.04, 0.03), (((0.0, 0.0, 0.0), (0.1, 0.0, 0.7)),), mesh=0.1)
PLACES = (fs.PlaceOn("foot", "post", ((0.0, 0.0, 0.0),)), fs.PlaceOn("top", "post", ((0.1, 0.0, 0.7),)))
DAMPER = fs.Spring("damper", "top", None, damping=(0.0, 30.0, 0.0, 0.0, 0.0, 0.0))
HELD = fs.Support("floor", "clamped", at="foot")


@pytest.fixture
def own() -> fs.Assembly:
    """A clamped post with a dashpot at its top, as it is assembled here."""
    return fs.assemble(fs.mesh_structure(fs.Structure("a post", (POST, DAMPER), points=PLACES, supports=(HELD,))))


def carried(own: fs.Assembly, folder: Path, factor: float = 1.0) -> fs.Assembly:
    """The same, written by scipy and given back: a degree of freedom here is one component of one node."""
    for name in "MKC":
        scipy.sparse.save_npz(folder / f"{name}.npz", getattr(own, name))
    M, K, C = (scipy.sparse.load_npz(folder / f"{name}.npz") for name in "MKC")
    places = own.dofs.T.tocsc()
    assert (np.diff(places.indptr), places.data.tolist()) == (pytest.approx(1), [1.0] * places.nnz)
    nodes, components = np.divmod(places.indices, N_COMPONENTS)
    return fs.given_matrices(M, factor * K, nodes, components, own.points, C, loss_factor=0.01)


def test_what_is_carried_away_and_brought_back_answers_the_same(own: fs.Assembly, tmp_path: Path) -> None:
    given = carried(own, tmp_path)
    top = int(np.argmax(own.points[:, 2]))
    damping = fs.Damping(fs.FromMaterials())
    drive, response = Probe([top], [UY], [1.0]), Probe([top, 1], [UY, UX], [0.5, 0.5])
    free = [fs.modal_basis(one, up_to=3000.0, probes=[drive, response]) for one in (own, given)]
    bases = [fs.with_damping(basis, damping) for basis in free]
    # rounding of one factorisation and its eigenvalues, of 1e-16
    assert bases[1].frequency_hz == pytest.approx(bases[0].frequency_hz, rel=1e-9)
    lines = np.array([10.0, 50.0, 333.0])
    answers = [fs.frf(one, drive, response, lines) for one in bases]
    assert np.allclose(answers[1], answers[0], rtol=1e-9, atol=0.0)
    direct = [direct_frf(one, drive, response, lines, damping) for one in (own, given)]
    assert np.allclose(direct[1], direct[0], rtol=1e-9, atol=0.0)
    assert given.dofs.labels[0] == f"node {own.dofs.T.tocsc().indices[0] // N_COMPONENTS} UX"


def test_the_mass_is_that_of_a_rigid_motion() -> None:
    """Two masses that both move along x, and one of them along y: 3 kg move along x, 2 along y."""
    points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]
    given = fs.given_matrices(np.diag([1.0, 2.0, 2.0]), np.eye(3), [0, 1, 1], [UX, UX, UY], points)
    assert given.total_mass == 3.0
    assert given.momentum.tolist() == [[1.0, 2.0, 0.0], [0.0, 0.0, 2.0], [0.0, 0.0, 0.0]]


def test_twice_the_stiffness_is_an_octave_in_two(own: fs.Assembly, tmp_path: Path) -> None:
    first, second = (fs.modal_basis(carried(own, tmp_path, k), up_to=500.0).frequency_hz[0] for k in (1.0, 2.0))
    assert second / first == pytest.approx(2**0.5, rel=1e-9)  # rounding


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"M": np.eye(3)}, r"given matrices M: got \(3, 3\), expected \(2, 2\), a row for each degree of freedom"),
        (
            {"K": [[2.0, -1.0], [-1.1, 2.0]]},
            r"given matrices K: got -1 at \(0, 1\) and -1\.1 at \(1, 0\), expected a",
        ),
        ({"C": [[np.nan, 0.0], [0.0, 1.0]]}, "given matrices C: got a value that is not finite"),
        ({"nodes": [0, 2]}, "given matrices nodes: got 0 to 2, expected 0 to 1"),
        ({"components": [0, 7]}, "given matrices components: got 0 to 7, expected 0 to 6"),
        ({"nodes": [1, 1]}, "given matrices: got two degrees of freedom at node 1 UX, expected one each"),
    ],
)
def test_what_does_not_fit_is_refused(changed: dict[str, object], told: str) -> None:
    usual = {"M": np.eye(2), "K": np.eye(2), "nodes": [0, 1], "components": [UX, UX], "points": np.eye(2, 3)}
    with pytest.raises(FemstructError, match=told):
        fs.given_matrices(**(usual | changed))


CHAIN = {"nodes": [0, 1, 2], "components": [UX] * 3, "points": np.eye(3)}
EYE = np.eye(3)


@pytest.mark.parametrize(
    ("matrices", "said"),
    [
        ({"M": -EYE, "K": EYE}, r"given matrices M: got a kinetic energy below 0: -1 at \(0, 0\).*look for a sign"),
        ({"M": EYE + 2.0 * np.eye(3, k=1) + 2.0 * np.eye(3, k=-1), "K": EYE}, "mean, 1"),
        ({"M": EYE, "K": EYE, "C": np.diag([1.0, 1.0, -3.0])}, r"given matrices C: .*energy: -3 at \(2, 2\)"),
    ],
)
def test_masses_and_dashpots_of_a_wrong_sign_are_refused(matrices: dict[str, np.ndarray], said: str) -> None:
    with pytest.raises(FemstructError, match=said):
        fs.given_matrices(**matrices, **CHAIN)


@pytest.mark.parametrize("beside", [0.499, 0.501])
def test_dashpots_that_only_three_masses_together_gain_energy_from_are_refused(beside: float) -> None:
    """1 on the diagonal and -b beside it: eigenvalues 1 + b, twice, and 1 - 2 b for all three together."""
    C = (1.0 + beside) * EYE - beside
    given = fs.given_matrices(EYE, np.diag([1.0, 4.0, 9.0]), C=C, **CHAIN)
    if beside < 0.5:
        assert fs.modal_basis(given, count=3).dashpots.any()
        return
    with pytest.raises(FemstructError, match=r"C: got dashpots that give energy to a motion, at up to 0\.002 1/s"):
        fs.modal_basis(given, count=3)


def test_one_dashpot_in_single_precision_is_no_gain() -> None:
    """A dashpot between masses in a slanted direction has no loss in the other, but for rounding of 1e-7."""
    along = np.array([0.6, 0.8, -0.3])
    C = np.outer(along, along).astype(np.float32).astype(np.float64)
    assert (np.linalg.eigvalsh(C)[0]) < 0.0
    basis = fs.modal_basis(fs.given_matrices(EYE, EYE, C=C, **CHAIN), count=3)
    # of three modes of one frequency some turn shows the dashpot alone: its rate is 0.36 + 0.64 + 0.09
    assert np.linalg.eigvalsh(basis.dashpots)[-1] == pytest.approx(1.09, rel=1e-6)  # single precision
