"""The largest value of a frequency response between its lines, against closed forms and much finer lines."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from femstruct.arrays import Floats
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import given_modes, oscillator
from femstruct.modal.damping import Damping, Ratio, with_damping
from femstruct.modal.frf import frf
from femstruct.modal.steady import MISSED, Highest, Respond, largest_peak, missed_peak
from femstruct.study.asked import FrfRequest, Spot
from femstruct.study.results import Frf


def found(respond: Respond, basis: ModalBasis, lines: Floats) -> Highest:
    one = largest_peak(respond, basis, lines, np.abs(respond(lines)))
    assert one is not None
    return one


@given(some.floats(0.002, 0.3), some.floats(0.05, 20.0), some.floats(0.0, 1.0))
def test_an_oscillator_has_the_peak_of_its_closed_form(ratio: float, step: float, offset: float) -> None:
    """Its receptance is largest, 1 / (2 k zeta sqrt(1 - zeta^2)), at f sqrt(1 - 2 zeta^2), wherever the lines are."""
    hz, mass = 37.0, 2.0
    stiffness = mass * (2.0 * np.pi * hz) ** 2
    bare, points = oscillator(mass, stiffness=stiffness)
    basis, here = with_damping(bare, Damping(Ratio(ratio))), points["m"].probe("x")
    respond = partial(frf, basis, here, here)
    one = found(respond, basis, 10.0 + step * (offset + np.arange(int(60.0 / step) + 2)))
    largest = 0.5 / (stiffness * ratio * np.sqrt(1.0 - ratio**2))
    assert one.size == pytest.approx(largest, rel=1e-6)  # by the last width of the search
    assert one.frequency_hz == pytest.approx(hz * np.sqrt(1.0 - 2.0 * ratio**2), rel=1e-3)  # sqrt of 1e-6: it is flat
    if one.missed > MISSED:  # lines of the step that is proposed show it, wherever they begin
        begin = np.linspace(0.0, 1.0, 21)[:, None]
        lines = one.frequency_hz + one.needed * (np.arange(-2.0, 3.0) + begin)
        shown = np.abs(respond(lines.ravel())).reshape(lines.shape).max(axis=1)
        assert shown.min() >= (1.0 - MISSED) * one.size * (1.0 - 1e-6)  # the same rounding of the peak


def test_a_narrow_resonance_is_found_that_no_line_shows() -> None:
    """The second mode is 0.02 Hz wide and four times as high as the first; lines are 1 Hz apart."""
    basis, points = given_modes([20.0, 50.5], [0.02, 0.0002], {"P": [1.0, 0.5]})
    here = points["P"].probe("z")
    respond, lines = partial(frf, basis, here, here), np.arange(5.0, 100.0)
    fine = np.abs(respond(np.linspace(50.48, 50.52, 40_001))).max()  # 1e-6 Hz apart: 1e-9 of the peak
    one = found(respond, basis, lines)
    assert one.size == pytest.approx(fine, rel=1e-6)  # by the last width of the search
    assert one.frequency_hz == pytest.approx(50.5, abs=1e-4)  # a hundredth of half its width
    assert one.frequency_hz not in lines and one.line == np.abs(respond(lines)).max()
    (told,) = missed_peak(one, "m/N")
    assert told.code == "peak-between-lines" and told.values["step_hz"] == 1.0
    # half as far from the peak as where 1 / sqrt(1 + (d / zeta f)^2) is 0.95: 2 x 0.329 x 0.0101 Hz, in one digit
    assert told.values["needed_hz"] == pytest.approx(0.005, rel=1e-12)  # rounding
    assert "at 50.5 Hz, is between two lines. The lines are 1 Hz apart" in told.message


def test_a_narrow_resonance_of_what_a_dashpot_holds() -> None:
    """With its foot held by oil a mass resonates on its spring at 20 Hz, 0.05 % damped; the natural frequencies are
    those of a free foot. Between lines 1.7 Hz apart: of a much finer search."""
    mass, light, oil, spring = 1.0, 0.001 * 2 * np.pi * 20.0, 1e5, (2 * np.pi * 20.0) ** 2
    squares, shapes = np.linalg.eigh(spring * np.array([[2.0, -1.0], [-1.0, 1.0]]))
    bare, points = given_modes(np.sqrt(squares) / (2 * np.pi), [0.0, 0.0], {"foot": shapes[0], "head": shapes[1]})
    damping = np.array([[oil + light, -light], [-light, light]])
    basis, here = replace(bare, viscous=shapes.T @ damping @ shapes), points["head"].probe("z")
    one = found(partial(frf, basis, here, here), basis, np.arange(5.3, 60.0, 1.7))

    def answer(hz: Floats) -> Floats:
        w = 2 * np.pi * hz
        foot, neck = spring + 1j * w * oil - mass * w**2, spring + 1j * w * light
        return np.abs(1.0 / (foot * neck / (foot + neck) - mass * w**2))

    assert one.size == pytest.approx(answer(np.linspace(19.9, 20.1, 2_000_001)).max(), rel=1e-6)  # the last width
    assert one.missed > 0.9


def test_lines_that_show_the_peak_say_nothing() -> None:
    basis, points = given_modes([20.0, 50.5], [0.02, 0.02], {"P": [1.0, 0.5]})
    here = points["P"].probe("z")
    one = found(partial(frf, basis, here, here), basis, np.arange(5.0, 100.0, 0.1))
    assert missed_peak(one, "m/N") == () and one.needed == one.step


@pytest.mark.parametrize("step", [0.7, 0.01])
def test_the_largest_value_is_judged_on_other_lines_as_if_it_was_looked_for_there(step: float) -> None:
    basis, points = given_modes([20.0, 50.5], [0.02, 0.001], {"P": [1.0, 0.5]})
    here = points["P"].probe("z")
    respond = partial(frf, basis, here, here)
    hz = np.arange(5.5, 100.0, step)
    one, again = found(respond, basis, np.arange(5.5, 100.0)).on(hz, np.abs(respond(hz))), found(respond, basis, hz)
    for name in ("frequency_hz", "size", "line", "step", "needed"):
        assert getattr(one, name) == pytest.approx(getattr(again, name), rel=1e-6)  # peaks are found to 1e-6
    assert one.missed <= MISSED if step == 0.01 else one.missed > MISSED


def test_a_transmissibility_is_largest_where_the_driven_point_stands_still() -> None:
    """Not at a natural frequency: the ratio of two responses, on lines of 1 and of 0.001 Hz."""
    basis, points = given_modes([20.0, 50.0], [0.01, 0.01], {"P": [1.0, 0.8], "Q": [1.0, -0.8]})
    drive, response = points["P"].probe("z"), points["Q"].probe("z")
    respond = partial(frf, basis, drive, response, kind="transmissibility")
    fine = np.abs(respond(np.arange(10.0, 80.0, 0.001))).max()
    one = found(respond, basis, np.arange(10.0, 80.0))
    assert one.size == pytest.approx(fine, rel=1e-5)  # the fine lines: a peak 0.5 Hz wide is 4e-6 above them


@pytest.mark.parametrize(("ratios", "lines"), [((0.02, 0.0), 90), ((0.02, 0.02), 1), ((0.02, 0.02), 0)])
def test_there_is_no_such_number_without_damping_or_lines(ratios: tuple[float, float], lines: int) -> None:
    basis, points = given_modes([20.0, 50.5], ratios, {"P": [1.0, 0.5]})
    here = points["P"].probe("z")
    hz = 5.0 + np.arange(float(lines))
    assert largest_peak(partial(frf, basis, here, here), basis, hz, np.abs(frf(basis, here, here, hz))) is None


def test_the_peak_of_a_study_is_the_largest_value() -> None:
    request = FrfRequest("here", Spot("P", "z"), Spot("P", "z"), "receptance", (1.0, 3.0), 1.0)
    known = Highest(2.4, 7.0, 3.0, 1.0, 0.1)
    hz, values = np.array([1.0, 2.0, 3.0]), np.array([1.0, 3.0, 1.0]) + 0j
    assert Frf(request, hz, values, "m/N", highest=known).peak == 7.0
    # of lines alone: the parabola through 1, 1/9, 1 is symmetric, so its lowest point is the middle line
    assert Frf(request, hz, values, "m/N").peak == pytest.approx(3.0, rel=1e-12)  # rounding
