"""Derivatives of frequencies, shapes and frequency responses: against differences, and against closed forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.assembly.matrices import Assembly, assemble
from femstruct.language.models import read_model_file
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import oscillator
from femstruct.modal.damping import Damping, LossFactor, with_damping
from femstruct.modal.frf import FrfKind, frf
from femstruct.modal.likeness import near_equal
from femstruct.modal.reduction import modal_basis
from femstruct.modal.sensitivity import (
    BACKWARD,
    CENTRED,
    FORWARD,
    ORDERS,
    MatrixSlopes,
    ModalSlopes,
    damping_slopes,
    eigenvalue_slopes,
    free_shapes,
    frf_slopes,
    matrix_slopes,
    modal_slopes,
    motions,
    shape_slopes,
)
from femstruct.model.mesher import mesh_structure
from femstruct.model.probe import Probe
from femstruct.model.structure import Structure

FLOOR = Path(__file__).parents[1] / "data" / "floor_to_fit.yaml"
MATERIALS = "damping: {from: materials}"
PARAMETERS = {
    "materials.concrete.E": 30e9,  # K linear
    "parts.slab.thickness": 0.16,  # K of the third degree, M linear
    "materials.concrete.nu": 0.2,  # K rational
    "parts.posts.stiffness.z": 20e6,
    "parts.posts.damping.z": 5e3,  # C
    "materials.concrete.loss_factor": 0.03,
}
FEW = ("parts.slab.thickness", "parts.posts.damping.z")
OTHERS = tuple(path for path in PARAMETERS if path not in FEW)  # they take a second each
LINES = np.linspace(5.0, 60.0, 56)
STEP = 2e-5  # of a parameter, in differences of the fourth order: lines of 1 % width move by 1e-3 of it


@dataclass(frozen=True, eq=False)
class Floor:
    """The floor with a value of a parameter."""

    assembly: Assembly
    damping: Damping
    basis: ModalBasis
    probes: tuple[Probe, Probe]

    @property
    def response(self) -> NDArray[np.complex128]:
        return frf(with_damping(self.basis, self.damping), *self.probes, LINES, "accelerance")


@cache
def read(path: str, value: float, file: Path = FLOOR) -> Floor:
    source = read_model_file(file, [f"{path}={value!r}"])
    assert isinstance(source.structure, Structure)
    model = mesh_structure(source.structure)
    assembly, probes = assemble(model), (model.points["P"].probe("z"), model.points["Q"].probe("z"))
    return Floor(assembly, source.damping, modal_basis(assembly, up_to=120.0, probes=probes, orders=ORDERS), probes)


def difference(function: Callable[[float], NDArray[Any]], at: float) -> NDArray[Any]:
    """Central difference of the fourth order."""
    h = STEP * at
    near, far = (function(at + k * h) - function(at - k * h) for k in (1, 2))
    return np.asarray((8.0 * near - far) / (12.0 * h))


def slopes_of(path: str, file: Path = FLOOR, sides: tuple[int, ...] = CENTRED) -> tuple[Floor, MatrixSlopes]:
    at = PARAMETERS[path]
    here = read(path, at, file)
    found = matrix_slopes(lambda value: read(path, value, file).assembly, here.assembly, at, 0.01 * at, sides)
    assert found is not None
    return here, found


@pytest.mark.parametrize(
    "path", [one if one in FEW else pytest.param(one, marks=pytest.mark.stress) for one in PARAMETERS]
)
def test_derivatives_against_differences(path: str) -> None:
    """Frequencies, shapes and a response of a slab on posts with losses of its materials, by all kinds of numbers."""
    here, slopes = slopes_of(path)
    shapes, at, true = free_shapes(here.assembly, here.basis), PARAMETERS[path], here.basis.modes
    modal = modal_slopes(here.basis, here.damping, shapes, slopes)
    assert modal is not None
    damped = with_damping(here.basis, here.damping)
    found = frf_slopes(motions(damped, *here.probes, LINES), modal, LINES, "accelerance")
    expected = difference(lambda value: read(path, value).response, at)
    # at every line, 3e-9 here; with two residual vectors of each probe 4e-6
    assert (np.abs(found - expected) < 1e-6 * np.abs(expected)).all()
    if not slopes.K.nnz:
        return
    omega, groups = here.basis.omega[true], near_equal(here.basis.frequency_hz[true], 1e-6)
    squares = difference(lambda value: read(path, value).basis.omega[true] ** 2, at)
    assert np.abs(eigenvalue_slopes(omega, modal, groups) - squares).max() < 1e-6 * np.abs(squares).max()
    turned = shape_slopes(here.assembly, omega, shapes[:, true], slopes, np.arange(8), groups)
    moved = difference(lambda value: _shapes(read(path, value)), at)
    own = shapes[:, :8]
    moved = moved - own * (own * (here.assembly.M @ moved)).sum(axis=0)  # a shape keeps its length by itself
    assert np.abs(turned - moved).max() < 1e-6 * np.abs(moved).max()


def _shapes(floor: Floor) -> Floats:
    return free_shapes(floor.assembly, floor.basis)[:, :8]


LAWS: Final = {
    "loss_factor: 2 %": ("damping.loss_factor", 0.02),
    "ratio: 1 %": ("damping.ratio", 0.01),
    "rayleigh: {alpha: 5, beta: 1e-5}": ("damping.rayleigh.beta", 1e-5),
}


@pytest.mark.stress
@pytest.mark.parametrize("law", LAWS)
def test_responses_with_every_law_of_damping(law: str, tmp_path: Path) -> None:
    """By the thickness, which changes all matrices, and by the number of the law itself."""
    file = tmp_path / "floor.yaml"
    file.write_text(FLOOR.read_text(encoding="utf-8").replace(MATERIALS, f"damping: {{{law}}}"), encoding="utf-8")
    here, slopes = slopes_of("parts.slab.thickness", file)
    modal = modal_slopes(here.basis, here.damping, free_shapes(here.assembly, here.basis), slopes)
    assert modal is not None
    damped = with_damping(here.basis, here.damping)
    found = frf_slopes(motions(damped, *here.probes, LINES), modal, LINES, "accelerance")
    at = PARAMETERS["parts.slab.thickness"]
    expected = difference(lambda value: read("parts.slab.thickness", value, file).response, at)
    assert (np.abs(found - expected) < 1e-6 * np.abs(expected)).all()  # as above
    path, number = LAWS[law]
    less, more = (read(path, factor * number, file).damping for factor in (0.9, 1.1))
    by_law = damping_slopes(here.basis, less, more, 0.2 * number)
    found = frf_slopes(motions(damped, *here.probes, LINES), by_law, LINES, "accelerance")
    expected = difference(lambda value: read(path, value, file).response, number)
    assert (np.abs(found - expected) < 1e-6 * np.abs(expected)).all()  # as above


@pytest.mark.parametrize("sides", [FORWARD, BACKWARD])
def test_steps_to_one_side_are_as_good(sides: tuple[int, ...]) -> None:
    """At a bound. The third degree of a thickness is exact with four steps, whatever they are."""
    _, both = slopes_of("parts.slab.thickness")
    _, one = slopes_of("parts.slab.thickness", sides=sides)
    for name in ("K", "M"):
        apart = abs(getattr(both, name) - getattr(one, name)).max()
        assert apart < 1e-10 * abs(getattr(both, name)).max()  # rounding over a step of 1 %


def test_stiffness_by_its_modulus_is_itself_over_it() -> None:
    """K = E K1 of the slab: its derivative is its stiffness over E; the posts have none."""
    here, slopes = slopes_of("materials.concrete.E")
    slab = here.assembly.part_stiffness["slab"] / PARAMETERS["materials.concrete.E"]
    assert abs(slopes.K - slab).max() < 1e-11 * abs(slab).max()  # rounding over a step of 1 %
    assert [*slopes.parts] == ["slab"] and not slopes.M.nnz and not slopes.loss_factors


def test_equal_frequencies_separate_as_a_space() -> None:
    """Two equal oscillators, of which a parameter stiffens one: whatever their shapes, one frequency moves."""
    none = np.zeros((2, 2))
    turn = np.array([[np.cos(0.4), -np.sin(0.4)], [np.sin(0.4), np.cos(0.4)]])
    change = ModalSlopes(turn.T @ np.diag([3.0, 0.0]) @ turn, none, none, none)
    found = eigenvalue_slopes(np.array([10.0, 10.0]), change, np.array([0, 0]))
    assert found == pytest.approx([0.0, 3.0], abs=1e-14)  # rounding
    single = eigenvalue_slopes(np.array([10.0, 10.0]), change, np.array([0, 1]))
    assert single.sum() == pytest.approx(3.0) and single[0] > 0.1  # by itself each is a mixture


def test_a_mesh_that_moves_has_no_such_derivative() -> None:
    here = read("parts.slab.origin.2", 0.0)
    assert matrix_slopes(lambda value: read("parts.slab.origin.2", value).assembly, here.assembly, 0.0, 0.01) is None


def test_an_oscillator_in_closed_form() -> None:
    """H = 1 / (k (1 + j eta) - w^2 m): dH/dk = -(1 + j eta) H^2 and dH/dm = w^2 H^2."""
    mass, stiffness, eta = 2.0, 5e4, 0.04
    basis, points = oscillator(mass, stiffness=stiffness)
    damped, here = with_damping(basis, Damping(LossFactor(eta))), points["m"].probe("x")
    hertz = np.linspace(5.0, 50.0, 30)
    omega, none, unit = 2.0 * np.pi * hertz, np.zeros((1, 1)), np.ones((1, 1)) / mass
    H = 1.0 / (stiffness * (1.0 + 1j * eta) - omega**2 * mass)
    moving = motions(damped, here, here, hertz)
    kinds: dict[FrfKind, int] = {"receptance": 0, "mobility": 1, "accelerance": 2}
    for kind, power in kinds.items():
        rate = (1j * omega) ** power
        by_k = frf_slopes(moving, ModalSlopes(unit, none, none, eta * unit), hertz, kind)
        assert by_k == pytest.approx(-(1.0 + 1j * eta) * H**2 * rate, rel=1e-12)  # rounding
        by_m = frf_slopes(moving, ModalSlopes(none, unit, none, none), hertz, kind)
        assert by_m == pytest.approx(omega**2 * H**2 * rate, rel=1e-12)
