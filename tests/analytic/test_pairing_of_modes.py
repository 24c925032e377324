"""Modes of near-equal frequencies are paired as a space: squares, turned pairs, measured shapes."""

from dataclasses import replace

import numpy as np
import pytest

from femstruct.assembly.matrices import assemble
from femstruct.errors import FemstructError, InputError
from femstruct.modal.closed_form import given_modes
from femstruct.modal.damping import Damping, ModeDamping, Ratio, carry_damping
from femstruct.modal.likeness import mac, mac_of, near_equal, pairing, pairing_of
from femstruct.modal.reduction import modal_basis
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.structure import Structure, Support
from femstruct.parts.plate import Plate
from femstruct.workflow.case_comparison import mode_table

STEEL = Material("steel", E=210e9, nu=0.3, rho=7850.0)
ROUNDING = 1e-9  # of the eigenvectors, squared, and of sums of a hundred products


def square_plate(mesh=8, count=8, size=0.5):
    plate = Plate("plate", STEEL, 0.003, origin=(0.0, 0.0, 0.0), size=(size, 0.5), mesh=(mesh, mesh))
    held = Support("edges", "simple", "plate", edge="all")
    return modal_basis(assemble(mesh_structure(Structure("square", (plate,), supports=(held,)))), count=count)


@pytest.fixture(scope="module")
def square():
    return square_plate()


def turned(basis, pairs):
    """The basis with the shapes of some pairs of modes turned into each other by an angle [rad]."""
    shapes = basis.shapes.copy()
    for (i, j), angle in pairs.items():
        c, s = np.cos(angle), np.sin(angle)
        shapes[:, :, i], shapes[:, :, j] = (
            c * basis.shapes[:, :, i] + s * basis.shapes[:, :, j],
            c * basis.shapes[:, :, j] - s * basis.shapes[:, :, i],
        )
    return replace(basis, shapes=shapes)


@pytest.mark.parametrize("degrees", [0.0, 17.0, 45.0, 90.0, 133.0])
def test_a_turned_pair_of_a_square_plate_is_itself(square, degrees):
    """Simply supported square: modes (1, 2) and (2, 1), (1, 3) and (3, 1), (2, 3) and (3, 2) have equal frequencies."""
    hz = square.frequency_hz[square.modes]
    assert hz[1] == pytest.approx(hz[2], rel=1e-9)  # rounding of the eigensolution
    assert hz[4] == pytest.approx(hz[5], rel=1e-9)  # likewise
    other = turned(square, {(1, 2): np.radians(degrees), (4, 5): np.radians(70.0)})
    found = pairing(square, other)
    assert sorted(found.partner.tolist()) == list(range(8))  # every mode its own
    assert [found.alike(mode) for mode in range(8)] == pytest.approx([1.0] * 8, abs=ROUNDING)
    assert found.partner[[0, 3]].tolist() == [0, 3]
    assert found.mac[1, 1] == pytest.approx(np.cos(np.radians(degrees)) ** 2, abs=ROUNDING)


def test_a_pair_that_the_change_splits_is_still_found(square):
    """(1, 2) and (2, 1) are 0.13 % apart, as those of a measured square are, and single modes; turned by 45 degrees,
    those of the square are in their space and they in its."""
    turned_square = turned(square, {(1, 2): np.radians(45.0), (4, 5): np.radians(45.0), (6, 7): np.radians(45.0)})
    split = replace(square, omega=square.omega * (1.0 + 0.01 * np.arange(8) / 8))
    assert len(set(near_equal(split.frequency_hz).tolist())) == 8
    for a, b in ((turned_square, split), (split, turned_square)):
        found = pairing(a, b)
        assert [found.alike(mode) for mode in range(8)] == pytest.approx([1.0] * 8, abs=ROUNDING)
        assert sorted(found.partner.tolist()) == list(range(8))


def test_a_group_is_not_like_what_it_is_not(square):
    """Two groups of two: one shape in common, the others at right angles to it and to each other."""
    shapes = np.eye(6)
    found = pairing_of(shapes[:, [0, 1]], shapes[:, [0, 2]], [50.0, 50.0], [60.0, 60.0])
    np.testing.assert_array_equal(found.likeness, [[1.0, 0.0], [0.0, 0.0]])
    lost = pairing_of(shapes[:, [3, 4]], shapes[:, [0, 1, 2]], [50.0, 50.0], [60.0, 60.0, 70.0])
    assert lost.likeness.max() == 0.0


def test_a_group_within_a_larger_one_is_found_whole():
    """A mode of another part may come near: two of the space of three, turned by any angles, are in it; of the three,
    two have a partner, and the third is told to be like none."""
    space = np.linalg.qr(np.random.default_rng(3).standard_normal((9, 5)))[0]
    turn = np.linalg.qr(np.random.default_rng(4).standard_normal((3, 3)))[0]
    three, two = space[:, :3] @ turn, space[:, :2] @ np.array([[0.6, -0.8], [0.8, 0.6]])
    found = pairing_of(two, three, [50.0, 50.0], [50.0] * 3)
    assert found.likeness == pytest.approx(np.ones((2, 3)), abs=ROUNDING)
    assert len(set(found.partner.tolist())) == 2
    other = pairing_of(three, np.column_stack([two, space[:, 4]]), [50.0] * 3, [50.0, 50.0, 70.0])
    assert sorted(other.partner.tolist()) == [0, 1, 2]
    assert sorted(other.alike(mode) for mode in range(3)) == pytest.approx([0.0, 1.0, 1.0], abs=ROUNDING)


def test_single_modes_are_paired_by_the_mac_alone():
    random = np.random.default_rng(5)
    a, b = random.standard_normal((30, 6)), random.standard_normal((30, 4))
    found = pairing_of(a, b, 10.0 * np.arange(1, 7), 11.0 * np.arange(1, 5))
    by_hand = [[(x @ y) ** 2 / ((x @ x) * (y @ y)) for y in b.T] for x in a.T]
    np.testing.assert_allclose(found.mac, by_hand, rtol=1e-12)  # rounding of sums
    np.testing.assert_array_equal(found.likeness, found.mac)
    np.testing.assert_array_equal(found.partner, found.mac.argmax(axis=1))


def test_the_mac_does_not_know_a_complex_factor():
    """A measured shape has any phase; one in quadrature to itself is like itself."""
    random = np.random.default_rng(6)
    a = random.standard_normal((12, 3))
    assert np.diag(mac_of(a, a * (0.3 - 2.0j))).tolist() == pytest.approx([1.0] * 3, abs=1e-12)  # rounding
    travelling = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False))[:, None]
    assert mac_of(travelling, travelling.conj())[0, 0] == pytest.approx(0.0, abs=1e-12)  # rounding: it runs backwards


def test_rigid_modes_are_one_space():
    plate = Plate("plate", STEEL, 0.003, origin=(0.0, 0.0, 0.0), size=(0.5, 0.4), mesh=(4, 4))
    basis = modal_basis(assemble(mesh_structure(Structure("free", (plate,)))), count=9)
    n = basis.n_rigid
    mixed = basis.shapes.copy()
    mixed[:, :, :n] = basis.shapes[:, :, :n] @ np.linalg.qr(np.random.default_rng(2).standard_normal((n, n)))[0]
    table = mode_table(basis, replace(basis, shapes=mixed))
    assert [row[2] for row in table.values()] == pytest.approx([1.0] * 9, abs=ROUNDING)
    assert sorted(row[0] for row in table.values()) == list(range(1, 10))


def test_a_model_without_modes_has_no_partners(square):
    none, _ = given_modes((), (), {"P": ()})
    nowhere = replace(none, points=square.points[:1])
    assert pairing(nowhere, square).partner.tolist() == []
    assert pairing(square, nowhere).likeness.shape == (8, 0)
    assert near_equal([]).tolist() == []


def test_shapes_at_other_places_are_refused(square):
    with pytest.raises(InputError, match=r"\(3, 2\) and \(4, 2\), expected two tables of shapes"):
        mac_of(np.ones((3, 2)), np.ones((4, 2)))
    with pytest.raises(FemstructError, match="no node in common"):
        pairing(square, replace(square, points=square.points + 1.0))


def test_damping_follows_a_turned_pair(square):
    """Both modes of the pair have their exception; turned by 45 degrees each is like each of the others by half."""
    f = float(square.frequency_hz[1])
    law = Damping(Ratio(0.01), (ModeDamping(2, f, ratio=0.05), ModeDamping(3, f, ratio=0.05)))
    other = turned(square, {(1, 2): np.radians(45.3)})
    assert mac(square, other)[1:3, 1:3].max() < 0.51
    damped = carry_damping(law, square, other)
    assert damped.damping_ratio[:4] == pytest.approx([0.01, 0.05, 0.05, 0.01])
    assert "mode-damping-lost" not in [finding.code for finding in damped.findings]
