"""Units of compiled kernels: laid out by address, named by what they are made of, equal to their Python."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import FunctionType
from typing import NamedTuple

import numpy as np
import pytest

from femstruct.compiled.kernels import CompiledUnit, Matrix, Vector, kernels_of, laid_out, layout_of, unit, units_called
from femstruct.impact.batch_march import run_many
from femstruct.impact.collocation import integrate, state_at_start
from femstruct.impact.contact_events import empty_record
from femstruct.impact.exact import ExactSteps, exact_rule, exact_workspace, integrate_exactly
from femstruct.impact.scene import GROUND, Body, Clock, Contact, Scene
from femstruct.impact.simulate import ALL
from femstruct.impact.system import compile_scene
from femstruct.laws.linear import Linear
from femstruct.modal.closed_form import given_modes

ROOT = Path(__file__).parents[2]


class Inner(NamedTuple):
    weight: float
    counts: Vector


class Outer(NamedTuple):
    table: Matrix
    inner: Inner
    number: int


def test_words_hold_addresses_lengths_and_numbers() -> None:
    table, counts, alive = np.zeros((2, 3)), np.zeros(4), []
    laid_out(layout_of(Outer), Outer(table, Inner(0.5, counts), 7), alive)
    inner, outer = alive
    assert outer[:3].tolist() == [table.ctypes.data, 2, 3]
    assert (int(outer[3]), int(outer[4])) == (inner.ctypes.data, 7)
    assert (float(inner.view(np.float64)[0]), inner[1:].tolist()) == (0.5, [counts.ctypes.data, 4])


@pytest.mark.parametrize(
    "table",
    [np.zeros(3), np.zeros((2, 3), dtype=np.float32), np.zeros((3, 2)).T, np.zeros((2, 6))[:, ::2]],
    ids=["dimensions", "dtype", "transposed", "strided"],
)
def test_an_array_that_a_kernel_would_misread_is_refused(table: np.ndarray) -> None:
    with pytest.raises(TypeError, match=r"Outer\.table: got .* expected contiguous float64 in 2"):
        laid_out(layout_of(Outer), Outer(table, Inner(0.5, np.zeros(4)), 7), [])


def test_a_field_without_a_layout_is_refused() -> None:
    class Odd(NamedTuple):
        name: bytes

    with pytest.raises(TypeError, match="has no layout for a kernel"):
        layout_of(Odd)


def test_units_are_compiled_apart_from_those_they_call() -> None:
    assert {one.name.rpartition(".")[2] for one in units_called(run_many)} == {
        "integrate",
        "attempt",
        "integrate_exactly",
    }
    assert not {function.__name__ for function in kernels_of(integrate)} & {"try_step", "watch", "attempt"}


def test_a_fingerprint_changes_with_the_code_of_every_kernel_in_a_unit() -> None:
    """A copy of the unit whose module has one other kernel, or another constant."""

    def copied(**changed: object) -> CompiledUnit[..., int]:
        python = integrate_exactly.python
        code = {**python.__globals__, **changed}
        function = FunctionType(python.__code__, code, python.__name__, python.__defaults__)
        function.__module__, function.__qualname__ = python.__module__, python.__qualname__
        function.__annotations__ = python.__annotations__
        return unit(1.0)(function)

    def other_look(system: object, state: object, room: object) -> None:
        return None

    setattr(other_look, "_femstruct_sums", False)  # noqa: B010
    prints = {copied().fingerprint, copied(NEVER=3.0).fingerprint, copied(_look=other_look).fingerprint}
    assert len(prints) == 3
    assert copied().fingerprint == copied().fingerprint


def test_machine_code_and_python_agree() -> None:
    """A ball between two springs, 3 ms: the exact march compiled, and the same function in Python."""
    basis = given_modes([40.0], [0.01], {})[0]
    scene = Scene((Body("b", 1.0, -1.0),), (Contact("c", "b", GROUND, Linear(1e6, 30.0)),))
    compiled = compile_scene(basis, scene, Clock(3e-3, 1e3))
    ends = []
    for way in (integrate_exactly, integrate_exactly.python):
        state, record = state_at_start(compiled), empty_record(compiled.system, 0)
        with np.errstate(all="ignore"):
            steps = ExactSteps(3e-3, interval=np.inf, longest=np.inf, max_steps=1000)
            how = way(compiled.system, state, exact_rule(), exact_workspace(compiled.system), record, steps)
        ends.append((how, state.v.copy(), record.peak.copy(), record.ended.copy()))
    (how, v, peak, ended), (also, v_too, peak_too, ended_too) = ends
    assert how == also == 0
    for mine, theirs in ((v, v_too), (peak, peak_too), (ended, ended_too)):
        assert mine == pytest.approx(theirs, rel=1e-13)  # sums in another order


def test_a_simulation_needs_no_compiler() -> None:
    """numba takes half a second to import: only processes that compile do."""
    code = (
        "import sys\nfrom femstruct.compiled.store import code_of\n"
        "from femstruct.impact.simulate import ALL\n"
        "from femstruct.impact.scene import *\nfrom femstruct.laws.hertz import Hertz\n"
        "from femstruct.impact.simulate import simulate\nfrom femstruct.modal.closed_form import given_modes\n"
        "scene = Scene((Body('b', 1.0, -1.0),), (Contact('c', 'b', GROUND, Hertz(1e6)),))\n"
        "simulate(given_modes([], [], {})[0], scene, Clock(0.02, 1e4))\nassert 'numba' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=ROOT)


def test_every_unit_is_known_to_the_warm_up() -> None:
    named = {one.name for one in ALL} | {one.name for each in ALL for one in units_called(each)}
    marked = [path for path in (ROOT / "femstruct").rglob("*.py") if "\n@unit(" in path.read_text(encoding="utf-8")]
    modules = {".".join(path.relative_to(ROOT).with_suffix("").parts) for path in marked}
    assert {name.rpartition(".")[0] for name in named} == modules
