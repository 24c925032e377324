"""A run that gets nowhere says so in seconds, not after the last of twenty million steps; and it can be interrupted."""

from __future__ import annotations

import signal
import threading
import time

import numpy as np
import pytest

import femstruct.impact.collocation as march
from femstruct.errors import NotConverged
from femstruct.impact.batch import simulate_batch
from femstruct.impact.scene import GROUND, Body, Clock, Contact, Link, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.hertz import Hertz
from femstruct.modal.closed_form import given_modes

FREE = given_modes([], [], {})[0]


def ringing(hertz: float, duration: float) -> tuple[Scene, Clock]:
    """A ball on a clamp that rings as fast as that: 1 g, a preload of 100 N, Hertz."""
    # slope of k d^1.5 at k d^1.5 = F : 1.5 k^(2/3) F^(1/3) = m omega^2
    omega2 = 1e-3 * (2.0 * np.pi * hertz) ** 2
    k = (omega2 / (1.5 * 100.0 ** (1.0 / 3.0))) ** 1.5
    return Scene((Body("ball", 1e-3, 1e-6),), (Contact("clamp", "ball", GROUND, Hertz(k), preload=100.0),)), Clock(
        duration, 1e3
    )


def test_a_march_that_stalls_says_so_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """25 000 periods in one sample, and steps for a sixth of them; looked at every 50 000 of them."""
    monkeypatch.setattr(march, "MAX_STEPS", 60_000)
    monkeypatch.setattr(march, "STEPS_BETWEEN_CHECKS", 50_000)
    monkeypatch.setattr(march, "WORK_BETWEEN_CHECKS", 0.0)
    bodies = (Body("mite", 1.0, 1e-3), Body("ball", 1.0))
    links = (Link("spring", "mite", GROUND, (2 * np.pi * 25_000.0) ** 2),)
    scene = Scene(bodies, (Contact("wall", "ball", GROUND, Hertz(1.0), gap=1.0),), links)
    with pytest.raises(NotConverged, match=r"t = 0\.\d+ s after the last 50000 steps: .* change is 'wall'"):
        simulate(FREE, scene, Clock(1.0, 1.0))


def test_a_stiffness_mistyped_is_refused_in_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ball that rings at 100 MHz for 10 s would take 1e9 periods of a few steps each: 20 million are far too few.

    The shortest look at the pace, half a second where steps take 2 us; alone they would look after 1.6 million.
    """
    monkeypatch.setattr(march, "WORK_BETWEEN_CHECKS", 0.0)
    scene, clock = ringing(1e8, 10.0)
    start = time.process_time()
    with pytest.raises(
        NotConverged, match="20000000 such steps are too few; the contact nearest to a change is 'clamp'"
    ):
        simulate(FREE, scene, clock)
    assert time.process_time() - start < 10.0


@pytest.mark.parametrize("batch", [False, True])
def test_the_keyboard_is_heard(batch: bool) -> None:
    """Ctrl-C a while after the start of a run of a minute ends it at once."""
    scene, clock = ringing(2e6, 1.0)
    simulate_batch(FREE, scene, Clock(1e-5, 1e7), {"ball.velocity": [1e-6]})  # compiled by now
    main = threading.main_thread().ident
    assert main is not None
    timer = threading.Timer(0.3, lambda: signal.pthread_kill(main, signal.SIGINT))
    start = time.process_time()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        if batch:
            simulate_batch(FREE, scene, clock, {"ball.velocity": np.full(1000, 1e-6)}, threads=1)
        else:
            simulate(FREE, scene, clock)
    timer.join()
    assert time.process_time() - start < 10.0
    assert simulate(FREE, scene, Clock(1e-5, 1e7)).contacts["clamp"].peak_force > 100.0  # and the next run runs
