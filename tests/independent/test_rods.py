"""Rods and beams in closed form against printed roots and rules; links that are released."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest

from tests.independent import contact_events as ev
from tests.independent.rods import beam, beam_roots, rod


def test_roots_as_printed() -> None:
    """Blevins, Formulas for Natural Frequency and Mode Shape, table 8-1."""
    printed = {
        ("clamped", "free"): (1.87510407, 4.69409113, 7.85475744), ("free", "free"): (4.73004074, 7.85320462),
        ("clamped", "pinned"): (3.92660231, 7.06858275), ("pinned", "pinned"): (pi, 2 * pi),
    }  # fmt: skip
    for ends, roots in printed.items():
        # as many digits as printed
        assert beam_roots(ends, len(roots)) == pytest.approx(roots, abs=1e-8)


def test_shapes_of_unit_mass() -> None:
    """A pinned beam has sines, a cantilever 2 / sqrt(m L) at its tip, a free one its mass and its inertia at rest."""
    omega, shapes = beam(2.0, ("pinned", "pinned"), 300.0, 1.5, 3, {"p": 0.3})
    right = [sqrt(2 / 3) * np.sin(n * pi * 0.15) for n in (1, 2, 3)]
    # quadrature of a smooth shape: rounding
    assert np.abs(shapes["p"]) == pytest.approx(np.abs(right), rel=1e-9)
    assert omega == pytest.approx([(n * pi / 2) ** 2 * sqrt(200) for n in (1, 2, 3)], rel=1e-9)  # rounding of roots
    tip = beam(2.0, ("clamped", "free"), 300.0, 1.5, 3, {"p": 2.0})[1]["p"]
    # exact of every mode of a cantilever
    assert np.abs(tip) == pytest.approx([2 / sqrt(3)] * 3, rel=1e-9)
    still = beam(2.0, ("free", "free"), 300.0, 1.5, 3, {"p": 2.0})
    # exact of rigid motions: 1 / sqrt(m L), and sqrt(12 / (m L^3)) L / 2
    assert (still[0][:2], np.abs(still[1]["p"][:2])) == ([0, 0], pytest.approx([1 / sqrt(3), 1.0], rel=1e-9))
    omega, shapes = rod(2.0, 8e9, 2e3, 1e-3, 3, {"p": 0.0})
    # exact
    assert omega == pytest.approx([0, 1000 * pi, 2000 * pi]) and shapes["p"] == pytest.approx(
        [0.5, sqrt(0.5), sqrt(0.5)]
    )


def test_a_link_that_is_released() -> None:
    """A body that flies 1 m at 2 m/s, then swings on a spring without force there; a push moves the middle."""
    late = ev.Spring("a", None, 100.0, push=5.0, since=0.5)
    path = ev.run(ev.Chain(bodies={"a": 1.0}, springs=[late], start={"a": 2.0}), 1.5, 1e-11)
    t = np.array([0.25, 1.0])
    swing = 0.2 * np.sin(10 * 0.5) + 0.05 * (1 - np.cos(10 * 0.5))
    # tolerance of the integration
    assert path.moved("a", t) == pytest.approx([0.5, 1.0 + swing], rel=1e-8)


def test_a_body_that_begins_later_and_a_push() -> None:
    again = ev.Again("a", None, (0.4,), late=True)
    path = ev.run(ev.Chain(bodies={"a": 1.0}, start={"a": 3.0}, again=[again]), 1.0)
    # straight lines: rounding
    assert path.moved("a", np.array([0.2, 0.9])) == pytest.approx([0.0, 1.5], abs=1e-9)
    push = ev.Push("a", lambda t: max(0.0, min(t - 0.1, 0.3 - t)), (0.1, 0.2, 0.3))
    path = ev.run(ev.Chain(bodies={"a": 1.0}, pushes=[push]), 1.0)
    # tolerance of the integration
    assert path.speed("a", np.array([0.9])) == pytest.approx([0.01], rel=1e-8)
