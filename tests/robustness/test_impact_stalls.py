"""Contacts that graze so long that collocation gets nowhere: told in seconds; the exact march goes through."""

from __future__ import annotations

import pytest

import femstruct.impact.simulate as engine
from femstruct.errors import NotConverged
from femstruct.impact.bodies import Body, Clock, Contact, Scene
from femstruct.impact.laws import Linear
from femstruct.impact.response import Response
from femstruct.modal.analytic import given_modes


def in_a_row(damper: float, ratio: float) -> Response:
    """A ball of 0.5 kg, a free body of 1 kg and a damper, joined by contact springs; ratio = omega_d / omega_b."""
    bodies = (Body("ball", 0.5, 1.0), Body("m", 1.0), Body("damper", damper))
    contacts = (
        Contact("ball", "m", "ball", Linear(0.5)),
        Contact("damper", "damper", "m", Linear(damper * ratio**2)),
    )
    return engine.simulate(given_modes([], [], {})[0], Scene(bodies, contacts), Clock(8.0, 10.0))


@pytest.mark.parametrize(("damper", "ratio"), [(0.25, 99.0), (0.5, 50.0)])
def test_a_march_that_stalls_says_so_soon(monkeypatch: pytest.MonkeyPatch, damper: float, ratio: float) -> None:
    """50 000 steps, 2 s; all 20 million of them would be ten minutes."""
    monkeypatch.setattr(engine, "takes_exact_march", lambda *_: False)
    with pytest.raises(NotConverged, match=r"no progress in 50000 steps at t = 2\.\d+ s, .* contact 'damper'"):
        in_a_row(damper, ratio)


@pytest.mark.parametrize(("damper", "ratio"), [(0.25, 99.0), (0.25, 120.0), (0.5, 50.0)])
def test_the_exact_march_goes_through(damper: float, ratio: float) -> None:
    """All energy is kept and the bodies part in order."""
    response = in_a_row(damper, ratio)
    assert response.ledger.residual < 1e-12  # rounding of some hundred steps
    ball, body, far = (float(response.bodies[name].velocity[-1]) for name in ("ball", "m", "damper"))
    assert ball < body < far
    assert 0.5 * ball + body + damper * far == pytest.approx(0.5, rel=1e-12)  # momentum; rounding
