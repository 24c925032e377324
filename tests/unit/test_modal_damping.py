"""Damping laws, exceptions by mode, and damping carried along by mode shape."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from femstruct.errors import FemstructError, InputError
from femstruct.modal.basis import ForceRow, ModalBasis
from femstruct.modal.closed_form import beam
from femstruct.modal.damping import (
    Damping,
    FromMaterials,
    LossFactor,
    ModeDamping,
    Ratio,
    Rayleigh,
    carry_damping,
    with_damping,
)
from femstruct.modal.likeness import mac

F1 = 68.014  # the pinned-free beam of the source: 0, 68.014, 220.41, ...


@pytest.fixture
def basis():
    return beam(0.4, 5.9, 0.3, ("pinned", "free"), 5)[0]


@pytest.fixture
def in_parts(basis):
    """The same with two parts that share the strain energy, and a force of one of them."""
    stiff = np.diag(basis.omega**2)
    soft = 0.3 * stiff
    soft[1, 2] = soft[2, 1] = 0.05 * basis.omega[1] * basis.omega[2]
    row = ForceRow(np.arange(5.0), np.zeros(5), np.zeros(5))
    return replace(
        basis,
        part_stiffness={"soft": soft, "hard": stiff - soft},
        loss_factors={"soft": 0.2, "hard": 0.01},
        outputs={"soft.z": row, "ground.z": row},
    )


def test_ratio(basis):
    damped = with_damping(basis, Damping(Ratio(0.02)))
    np.testing.assert_allclose(damped.damping_ratio[1:], 0.02)
    assert np.isnan(damped.damping_ratio[0])  # a rigid mode has none
    assert damped.viscous[0, 0] == 0
    ground = damped.outputs["ground.z"]
    np.testing.assert_allclose(ground.damping[1:], ground.stiffness[1:] * 0.04 / basis.omega[1:])
    assert not ground.hysteretic.any()


def test_loss_factor_is_twice_the_ratio(basis):
    damped = with_damping(basis, Damping(LossFactor(0.04)))
    np.testing.assert_allclose(np.diag(damped.hysteretic), 0.04 * basis.omega**2)
    assert not damped.viscous.any()
    np.testing.assert_allclose(damped.damping_ratio[1:], 0.02)


def test_rayleigh_brakes_rigid_motion_too(basis):
    damped = with_damping(basis, Damping(Rayleigh(3.0, 1e-5)))
    np.testing.assert_allclose(np.diag(damped.viscous), 3.0 + 1e-5 * basis.omega**2)
    row = damped.outputs["ground.z"]
    np.testing.assert_allclose(row.damping, 1e-5 * row.stiffness)  # no inertia in this row
    heavy = replace(basis, outputs={"ground.z": ForceRow(row.stiffness, np.zeros(5), np.arange(5.0))})
    damped = with_damping(heavy, Damping(Rayleigh(3.0, 1e-5)))
    np.testing.assert_allclose(damped.outputs["ground.z"].damping, 3.0 * np.arange(5.0) + 1e-5 * row.stiffness)


def test_materials_weigh_by_strain_energy(in_parts):
    damped = with_damping(in_parts, Damping(FromMaterials()))
    expected = 0.2 * in_parts.part_stiffness["soft"] + 0.01 * in_parts.part_stiffness["hard"]
    np.testing.assert_allclose(damped.hysteretic, expected)
    np.testing.assert_allclose(damped.damping_ratio[1:], 0.5 * (0.3 * 0.2 + 0.7 * 0.01))
    # a part's own force has its own loss factor, a force of several the mean one of the mode
    np.testing.assert_allclose(damped.outputs["soft.z"].hysteretic[1:], 0.2 * np.arange(1.0, 5.0))
    np.testing.assert_allclose(damped.outputs["ground.z"].hysteretic[1:], 0.067 * np.arange(1.0, 5.0))


def test_materials_do_not_brake_rigid_motion(in_parts):
    """The parts' stiffnesses are sums with rounding: what strains no part loses nothing, exactly."""
    rounded = {name: stiffness + 1e-9 for name, stiffness in in_parts.part_stiffness.items()}
    damped = with_damping(replace(in_parts, part_stiffness=rounded), Damping(FromMaterials()))
    assert not damped.hysteretic[0].any() and not damped.hysteretic[:, 0].any()


def test_a_support_named_twice_counts_once_on_the_ground(in_parts):
    """What stands on the ground at several places has one force row for all of them."""
    rows = {f"{name}.{axis}": in_parts.outputs["soft.z"] for name in ("soft", "ground") for axis in "xyz"}
    twice = replace(in_parts, outputs=rows, grounded=("soft", "soft"))
    damped = with_damping(twice, Damping(FromMaterials()))
    np.testing.assert_allclose(damped.outputs["ground.z"].hysteretic, damped.outputs["soft.z"].hysteretic)


def test_an_exception_replaces_the_law_of_its_mode(in_parts):
    law = Damping(FromMaterials(), (ModeDamping(2, F1, ratio=0.06), ModeDamping(3, 221.0, loss_factor=0.02)))
    damped = with_damping(in_parts, law)
    np.testing.assert_allclose(damped.damping_ratio[1:4], [0.06, 0.01, 0.0335])
    assert not damped.hysteretic[1].any()
    omega = in_parts.omega
    row = damped.outputs["soft.z"]
    np.testing.assert_allclose(row.damping[1:3], [1 * 0.12 / omega[1], 2 * 0.02 / omega[2]])
    np.testing.assert_allclose(row.hysteretic[1:3], [0.0, 2 * 0.02])


def test_damping_adds_to_that_of_dashpots(basis):
    dashpots = 0.7 * np.ones((5, 5))
    damped = with_damping(replace(basis, viscous=dashpots), Damping(Ratio(0.02), (ModeDamping(2, F1, ratio=0.05),)))
    np.testing.assert_allclose(damped.viscous[1], 0.7 + np.eye(5)[1] * 0.1 * basis.omega[1])


def test_a_mode_elsewhere_is_refused_with_its_neighbours(basis):
    law = Damping(Ratio(0.0), (ModeDamping(2, 220.0, ratio=0.06),))
    with pytest.raises(InputError, match=r"damping.modes.2: got mode 2 at 68.01 Hz.*nearest are .*mode 3 at 220.4 Hz"):
        with_damping(basis, law)
    with pytest.raises(InputError, match="a rigid mode"):
        with_damping(basis, Damping(Ratio(0.0), (ModeDamping(1, 1e-9, ratio=0.1),)))


def test_near_is_five_percent(basis):
    with_damping(basis, Damping(Ratio(0.0), (ModeDamping(2, F1 / 1.049, ratio=0.06),)))
    with pytest.raises(InputError, match="within 5 %"):
        with_damping(basis, Damping(Ratio(0.0), (ModeDamping(2, F1 / 1.051, ratio=0.06),)))


def test_a_mode_above_the_basis_is_a_finding(basis):
    damped = with_damping(basis, Damping(Ratio(0.0), (ModeDamping(9, 5000.0, ratio=0.06),)))
    assert [finding.code for finding in damped.findings] == ["mode-damping-unused"]
    with pytest.raises(InputError, match="5 modes only"):
        with_damping(basis, Damping(Ratio(0.0), (ModeDamping(9, 500.0, ratio=0.06),)))


@pytest.mark.parametrize(
    "make",
    [
        lambda: Damping(Ratio(-0.1)),
        lambda: Damping(Rayleigh(1.0, float("nan"))),
        lambda: ModeDamping(2, 10.0),
        lambda: ModeDamping(2, 10.0, ratio=0.1, loss_factor=0.1),
        lambda: ModeDamping(0, 10.0, ratio=0.1),
        lambda: ModeDamping(2, 10.0, ratio=-0.1),
        lambda: Damping(Ratio(0.1), (ModeDamping(2, 10.0, ratio=0.1), ModeDamping(2, 20.0, ratio=0.1))),
    ],
)
def test_nonsense_is_refused(make):
    with pytest.raises(InputError):
        make()


def test_mac_of_a_basis_with_itself(basis):
    values = mac(basis, basis)
    np.testing.assert_allclose(np.diag(values), 1.0)
    assert values.shape == (5, 5)
    # modes orthogonal over the beam are nearly so over evenly spaced stations
    assert (values - np.eye(5)).max() < 0.05


def test_mac_compares_the_nodes_both_have(basis):
    order = np.random.default_rng(3).permutation(len(basis.points))[: len(basis.points) - 4]
    fewer = replace(basis, points=basis.points[order], shapes=basis.shapes[order])
    assert (np.diag(mac(basis, fewer)) > 0.999).all()
    elsewhere = replace(basis, points=basis.points + np.array([0.0, 1.0, 0.0]))
    with pytest.raises(FemstructError, match="no node in common"):
        mac(basis, elsewhere)


def test_nodes_at_one_place_are_told_apart_by_their_order(basis):
    def doubled(first: ModalBasis, second: ModalBasis) -> ModalBasis:
        return replace(
            first,
            points=np.repeat(first.points, 2, axis=0),
            shapes=np.stack([first.shapes, second.shapes], 1).reshape(-1, 7, 5),
        )

    other = replace(basis, shapes=basis.shapes[:, :, ::-1])
    assert np.diag(mac(doubled(basis, other), doubled(basis, other))).min() > 0.999
    assert np.diag(mac(doubled(basis, other), doubled(other, basis)))[:2].max() < 0.5


def test_damping_follows_its_mode(basis):
    # The changed structure has modes 2 and 3 in the other order (in shape), and mode 4 unlike any.
    order = [0, 2, 1, 3, 4]
    shapes = basis.shapes[:, :, order].copy()
    shapes[:, :, 3] = np.random.default_rng(1).standard_normal(shapes.shape[:2])
    changed = replace(basis, shapes=shapes)
    law = Damping(
        Ratio(0.01),
        (ModeDamping(2, F1, ratio=0.06), ModeDamping(3, 220.4, ratio=0.03), ModeDamping(4, 459.9, ratio=0.05)),
    )
    damped = carry_damping(law, basis, changed)
    np.testing.assert_allclose(damped.damping_ratio[1:], [0.03, 0.06, 0.01, 0.01])
    (lost,) = damped.findings
    assert lost.code == "mode-damping-lost"
    assert lost.values["mac"] < 0.5
    assert lost.values["mode"] == 4
