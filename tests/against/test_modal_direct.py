"""Modal superposition with residual vectors against the direct solution with the matrices, on a plate of our own."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csc_array, csr_array, eye_array
from scipy.sparse.linalg import splu

from femstruct.assembly.matrices import Assembly, DofMap, ForceRows
from femstruct.errors import InputError
from femstruct.modal.damping import Damping, FromMaterials, LossFactor, Ratio, Rayleigh, with_damping
from femstruct.modal.frf import direct_frf, frf
from femstruct.modal.reduction import modal_basis
from femstruct.model.probe import Probe

ROUNDING = 1e-11  # rounding: 5e-14 here at most

NODES, W, UZ = 15, 0, 2  # a 14 x 14 grid; component 0 of the plate is UZ of the node
TWIST_TO_SEVEN = (2, 3, 4, 6)


def plate_assembly(grid, held, springs=(), dashpot=0.0):
    """The plate as an Assembly, on springs of (node, stiffness) to the ground: two parts with losses of their own."""
    n = grid.K.shape[0]
    free = grid.free(held)
    select = csr_array(eye_array(n, format="csr")[:, free])
    spring, damper = np.zeros(n), np.zeros(n)
    for node, stiffness in springs:
        spring[node * grid.per_node] += stiffness
        damper[node * grid.per_node] += dashpot
    K_plate, K_spring = csc_array(select.T @ grid.K @ select), csc_array(np.diag(spring[free]))
    M, C = csc_array(select.T @ grid.M @ select), csc_array(np.diag(damper[free]))
    # Row of the ground: what holds the supports, r^T (K u + M u'') over all held translations, and the springs.
    rigid = np.zeros(n)
    rigid[np.arange(0, n, grid.per_node)] = 1.0
    reaction = np.zeros(n)
    reaction[held] = rigid[held]
    zero = np.zeros(len(free))
    rows = ForceRows(
        csr_array(np.stack([zero, zero, (spring * rigid)[free] - (grid.K @ reaction)[free]])),
        csr_array(np.stack([zero, zero, (damper * rigid)[free]])),
        csr_array(np.stack([zero, zero, -(grid.M @ reaction)[free]])),
        csr_array((3, 7 * len(grid.points))),
    )
    nodes, components = np.divmod(np.arange(n), grid.per_node)
    place = nodes * 7 + np.array(TWIST_TO_SEVEN)[components]
    T = csr_array((np.ones(n), (place, np.arange(n))), shape=(len(grid.points) * 7, n))
    return Assembly(
        M=M,
        K=csc_array(K_plate + K_spring),
        C=C,
        dofs=DofMap(csr_array(T @ select), tuple(f"dof {i}" for i in free)),
        points=np.column_stack([grid.points, np.zeros(len(grid.points))]),
        part_stiffness={"plate": K_plate, "springs": K_spring},
        loss_factors={"plate": 0.01, "springs": 0.3},
        forces={"ground": rows},
        momentum=np.stack([zero, zero, (grid.M @ rigid)[free]]),
        total_mass=float(rigid @ grid.M @ rigid),
    )


def point(node):
    return Probe([node], [UZ], [1.0])


DRIVE, LISTEN = point(3 * NODES + 4), point(9 * NODES + 10)
CORNERS = [0, NODES - 1, NODES * (NODES - 1), NODES * NODES - 1]


@pytest.fixture(scope="module")
def structures(plate_grid):
    """Supported all round, free, and free on soft springs at three corners and a stiff one."""
    grid = plate_grid("bfs16", NODES - 1, NODES - 1)
    on_springs = list(zip(CORNERS, (20.0, 30.0, 20.0, 500.0), strict=True))
    return {
        "supported": plate_assembly(grid, grid.held("SSSS")),
        "free": plate_assembly(grid, grid.held("FFFF")),
        "springs": plate_assembly(grid, grid.held("FFFF"), on_springs),
        "dashpots": plate_assembly(grid, grid.held("FFFF"), on_springs, dashpot=0.3),
    }


@pytest.fixture(scope="module")
def bases(structures):
    return {name: modal_basis(assembly, count=40, probes=[DRIVE, LISTEN]) for name, assembly in structures.items()}


def lines(basis, n=16):
    """Frequencies up to the highest mode / 2.5, the band the accuracy is promised for."""
    top = basis.frequency_hz[basis.modes][-1] / 2.5
    return np.linspace(top / n, top, n)


@pytest.mark.parametrize("law", [Rayleigh(0.4, 2e-5), LossFactor(0.02)], ids=["rayleigh", "loss-factor"])
@pytest.mark.parametrize("name", ["supported", "free", "springs", "dashpots"])
def test_modal_agrees_with_direct(structures, bases, name, law):
    basis = with_damping(bases[name], Damping(law))
    frequency = lines(basis)
    exact = direct_frf(structures[name], DRIVE, LISTEN, frequency, Damping(law))
    at_drive = direct_frf(structures[name], DRIVE, DRIVE, frequency, Damping(law))
    largest = np.abs(at_drive).max()
    # truncation: (f_max / f_r)^4 of a residual that is itself some percent, where f_r >= 2.5 f_max
    assert np.abs(frf(basis, DRIVE, LISTEN, frequency) - exact).max() <= 1e-3 * np.abs(exact).max()
    assert np.abs(frf(basis, DRIVE, DRIVE, frequency) - at_drive).max() <= 3e-3 * largest
    without = with_damping(modal_basis(structures[name], count=40), Damping(law))
    bare = np.abs(frf(without, DRIVE, DRIVE, frequency) - at_drive)[4:].max()
    assert bare > 3 * np.abs(frf(basis, DRIVE, DRIVE, frequency) - at_drive)[4:].max()  # the residuals matter


@pytest.mark.parametrize("kind", ["mobility", "accelerance", "transmissibility"])
def test_kinds_agree_with_direct(structures, bases, kind):
    basis = with_damping(bases["springs"], Damping(LossFactor(0.02)))
    frequency = lines(basis, 15)
    exact = direct_frf(structures["springs"], DRIVE, LISTEN, frequency, Damping(LossFactor(0.02)), kind)
    assert np.abs(frf(basis, DRIVE, LISTEN, frequency, kind) - exact).max() <= 2e-3 * np.abs(exact).max()


def test_unequal_losses_make_a_full_matrix_and_agree_with_direct(structures, bases):
    basis = with_damping(bases["springs"], Damping(FromMaterials()))
    off = basis.hysteretic - np.diag(np.diag(basis.hysteretic))
    assert np.abs(off).max() > 0.01 * np.abs(basis.hysteretic).max()
    frequency = lines(basis)
    exact = direct_frf(structures["springs"], DRIVE, LISTEN, frequency, Damping(FromMaterials()))
    # the residual vectors are those of the lossless structure: the loss factors times the residual remain
    assert np.abs(frf(basis, DRIVE, LISTEN, frequency) - exact).max() <= 5e-3 * np.abs(exact).max()


def test_reciprocity(bases):
    for basis in bases.values():
        damped = with_damping(basis, Damping(FromMaterials()))
        frequency = lines(damped)
        there, back = frf(damped, DRIVE, LISTEN, frequency), frf(damped, LISTEN, DRIVE, frequency)
        assert np.abs(there - back).max() <= ROUNDING * np.abs(there).max()


@pytest.mark.parametrize("name", ["supported", "springs"])
def test_static_response_is_exact_at_the_probes(structures, bases, name):
    assembly, basis = structures[name], bases[name]
    load = (DRIVE.row(len(assembly.points)) @ assembly.dofs.T).toarray()[0]
    exact = assembly.dofs.T @ splu(assembly.K).solve(load)
    exact = exact.reshape(-1, 7)
    modal = basis.shapes @ (DRIVE.of(basis.shapes) / basis.omega**2)
    # 1e-9: convergence of the eigenvectors; without the residual vectors 1e-3
    assert np.abs(modal - exact)[:, UZ].max() <= 1e-9 * np.abs(exact[:, UZ]).max()


@pytest.mark.parametrize("name", ["supported", "springs"])
def test_the_ground_carries_the_static_load(bases, name):
    ground = frf(bases[name], DRIVE, bases[name].outputs["ground.z"], 0.0, "transmissibility")
    assert abs(ground[0] - 1.0) <= 1e-9  # rounding: 4e-12 here


@pytest.mark.parametrize("law", [Rayleigh(0.4, 2e-5), LossFactor(0.02)], ids=["rayleigh", "loss-factor"])
@pytest.mark.parametrize("name", ["supported", "springs", "dashpots"])
def test_ground_force_agrees_with_direct(structures, bases, name, law):
    basis = with_damping(bases[name], Damping(law))
    frequency = lines(basis)
    exact = direct_frf(structures[name], DRIVE, "ground.z", frequency, Damping(law), "transmissibility")
    modal = frf(basis, DRIVE, basis.outputs["ground.z"], frequency, "transmissibility")
    assert np.abs(modal - exact).max() <= 1e-3 * np.abs(exact).max()


def test_ground_force_in_time_is_that_of_frequency_at_resonance(bases):
    # At omega_r the viscous equivalent and the loss factor are the same force.
    basis = with_damping(bases["springs"], Damping(LossFactor(0.02)))
    row, plain = basis.outputs["ground.z"], bases["springs"].outputs["ground.z"]
    elastic = basis.omega > 0
    np.testing.assert_allclose(row.hysteretic, 0.02 * plain.stiffness, rtol=1e-13)  # rounding: 2e-16 here
    # rounding: 2e-16 here
    np.testing.assert_allclose((row.damping * basis.omega)[elastic], row.hysteretic[elastic], rtol=1e-13)


def test_modes_and_residuals_are_orthonormal_and_carry_the_mass(structures, bases):
    for name, basis in bases.items():
        assembly = structures[name]
        weights = assembly.dofs.T.T @ basis.shapes.reshape(-1, len(basis.omega))  # T has orthonormal columns here
        np.testing.assert_allclose(weights.T @ (assembly.M @ weights), np.eye(len(basis.omega)), atol=ROUNDING)
        stiffness = weights.T @ (assembly.K @ weights)
        assert np.abs(stiffness - np.diag(basis.omega**2)).max() <= ROUNDING * basis.omega[-1] ** 2
        np.testing.assert_allclose(sum(basis.part_stiffness.values()), stiffness, atol=ROUNDING * basis.omega[-1] ** 2)
        if name == "free":  # heave is a mode: the effective masses add up to all of it
            assert basis.modal_mass[2].sum() == pytest.approx(basis.total_mass, rel=ROUNDING)
        assert basis.modal_mass[2].sum() <= basis.total_mass * (1 + ROUNDING)
        assert basis.residual_norm[basis.modes].max() < ROUNDING
        if name != "dashpots":  # two for every probe: static and first dynamic
            assert basis.kind.count("residual") == 4


def test_probes_at_one_place_and_held_ones_add_nothing(structures):
    assembly = structures["supported"]
    once = modal_basis(assembly, count=10, probes=[DRIVE])
    twice = modal_basis(assembly, count=10, probes=[DRIVE, DRIVE, Probe([0], [UZ], [1.0])])
    assert once.kind == twice.kind
    np.testing.assert_allclose(once.omega, twice.omega, rtol=ROUNDING)


def test_a_basis_cut_short_says_so(structures):
    basis = modal_basis(structures["supported"], count=1)
    (finding,) = basis.findings
    assert finding.code == "modal-mass-low"
    # closed form: the first mode of a simply supported plate carries 64 / pi^4 = 65.7 % of its mass
    assert finding.values["share_z"] == pytest.approx(64 / np.pi**4, rel=1e-3)


def test_what_has_no_answer_is_refused(structures, bases):
    with pytest.raises(InputError, match="the structure is free"):
        frf(bases["free"], DRIVE, LISTEN, [0.0, 1.0])
    with pytest.raises(InputError, match="forces are over the driving force"):
        frf(bases["springs"], DRIVE, bases["springs"].outputs["ground.z"], 1.0)
    with pytest.raises(InputError, match="frequencies >= 0"):
        frf(bases["springs"], DRIVE, LISTEN, -1.0)
    with pytest.raises(InputError, match="one damping ratio of all modes"):
        direct_frf(structures["springs"], DRIVE, LISTEN, 1.0, Damping(Ratio(0.02)))
    with pytest.raises(InputError, match=r"got 'roof.z'"):
        direct_frf(structures["springs"], DRIVE, "roof.z", 1.0, Damping(), "transmissibility")
