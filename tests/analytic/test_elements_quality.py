"""Shapes of shell elements: angles and aspects of plain geometry, and faults that are real ones."""

import numpy as np
import pytest

from femstruct.elements import quad_shell
from femstruct.elements.quality import BLUNTEST, LONGEST, MOST_WARPED, SHARPEST, shapes
from femstruct.errors import InputError

ROUNDING = 1e-12  # rounding of angles and square roots


def in_space(*corners):
    """One element, tilted and moved."""
    turn = np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))[0]
    points = np.array([[*corner, 0.0][:3] for corner in corners]) @ turn.T
    return points[None] + np.array([10.0, -3.0, 5.0])


@pytest.mark.parametrize(
    ("corners", "sharpest", "bluntest", "aspect"),
    [
        ([(0, 0), (1, 0), (1, 1), (0, 1)], 90, 90, 1),
        ([(0, 0), (0, 1), (4, 1), (4, 0)], 90, 90, 4),
        ([(0, 0), (2, 0), (3, 1), (1, 1)], 45, 135, 2),  # a parallelogram of height 1
        ([(0, 0), (1, 0), (0.5, np.sqrt(3) / 2)], 60, 60, 1),
        ([(0, 0), (1, 0), (0, 1)], 45, 90, np.sqrt(3)),
        ([(0, 0), (2, 0), (0.5, 0.5), (0, 2)], np.degrees(np.arctan(1 / 3)), 360 - 2 * np.degrees(np.arctan(2)), 4),
    ],
)
def test_angles_and_aspect(corners, sharpest, bluntest, aspect):
    for order in (corners, corners[::-1], corners[1:] + corners[:1]):
        found = shapes(in_space(*order))
        assert np.degrees(found.sharpest[0]) == pytest.approx(sharpest, rel=ROUNDING)
        assert np.degrees(found.bluntest[0]) == pytest.approx(bluntest, rel=ROUNDING)
        assert found.aspect[0] == pytest.approx(aspect, rel=ROUNDING)
        if bluntest < 180:
            assert found.warp[0] == pytest.approx(0, abs=1e-7)  # half the digits near an angle of zero


def test_warp_is_the_angle_of_a_folded_square():
    """Corners 0 and 2 raised: twice the angle of a half; seen from above it is a square."""
    h = 0.1
    found = shapes(in_space((0, 0, h), (1, 0, 0), (1, 1, h), (0, 1, 0)))
    assert found.warp[0] == pytest.approx(2 * np.arctan(h * np.sqrt(2)), rel=ROUNDING)
    assert (found.sharpest[0], found.bluntest[0]) == pytest.approx((np.pi / 2, np.pi / 2), rel=ROUNDING)


def leaning(angle):
    return in_space((0, 0), (1, 0), (1 + 1 / np.tan(angle), 1), (1 / np.tan(angle), 1))


@pytest.mark.parametrize(
    ("good", "bad", "fault"),
    [
        (leaning(1.02 * SHARPEST), leaning(0.98 * SHARPEST), "sharp"),
        (
            in_space((0, 0), (1, 0), (0.5, 0.5 / np.tan(0.49 * BLUNTEST[3]))),
            in_space((0, 0), (1, 0), (0.5, 0.5 / np.tan(0.51 * BLUNTEST[3]))),
            "blunt",
        ),
        (
            in_space((0, 0, np.tan(0.49 * MOST_WARPED) / np.sqrt(2)), (1, 0), (1, 1), (0, 1)),
            in_space((0, 0, 2.1 * np.tan(0.5 * MOST_WARPED) / np.sqrt(2)), (1, 0), (1, 1), (0, 1)),
            "warped",
        ),
        (
            in_space((0, 0), (0.98 * LONGEST, 0), (0.98 * LONGEST, 1), (0, 1)),
            in_space((0, 0), (1.02 * LONGEST, 0), (1.02 * LONGEST, 1), (0, 1)),
            "long",
        ),
        (leaning(1.0), in_space((0, 0), (1, 0), (0.2, 0.2), (0, 1)), "impossible"),
        (leaning(1.0), in_space((0, 0), (1, 0), (2, 0), (3, 0)), "impossible"),
        (leaning(1.0), in_space((0, 0), (1, 0), (0, 1), (1, 1)), "impossible"),
        (leaning(1.0), in_space((0, 0), (1, 0), (1, 1), (1, 1)), "impossible"),
        (in_space((0, 0), (1, 0), (0, 1)), in_space((0, 0), (1, 0), (1, 0)), "impossible"),
    ],
)
def test_faults_begin_at_their_limits(good, bad, fault):
    found = shapes(np.concatenate([good, bad])).faults()
    assert found[fault].tolist() == [1]
    assert set(found) == {fault} | ({"blunt"} if fault == "sharp" else set())  # of a parallelogram both


def test_the_worst_comes_first():
    found = shapes(np.concatenate([leaning(0.4), leaning(1.0), leaning(0.1), leaning(0.3)])).faults()
    assert found["sharp"].tolist() == [2, 3, 0]


def test_what_is_impossible_has_no_matrices_and_all_else_has():
    cells = 0.7 * np.random.default_rng(4).standard_normal((300, 4, 3)) + [[0, 0, 0], [3, 0, 0], [3, 3, 0], [0, 3, 0]]
    cells[:50, 2] = (cells[:50, 1] + cells[:50, 3]) / 2 - 0.1  # a corner pushed in
    impossible = shapes(cells).faults()["impossible"]
    t = 0.1
    A = np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]])
    rigidities = (t * A, 0 * A, t**3 / 12 * A, t * np.eye(2))
    assert 20 < len(impossible) < 100
    quad_shell.stiffness(np.delete(cells, impossible, axis=0), *rigidities)
    for number in impossible:
        with pytest.raises(InputError, match="cell 0"):
            quad_shell.stiffness(cells[[number]], *rigidities)


def test_corners_of_another_number_are_refused():
    with pytest.raises(InputError, match="corners: got shape"):
        shapes(np.zeros((2, 5, 3)))
