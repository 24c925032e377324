"""The law of Flores et al. (2011): its published factor, an independent integration, its energy, and its YAML."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from femstruct.errors import FemstructError
from femstruct.impact.scene import GROUND, Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.impact.system import compile_scene
from femstruct.language.cases import read_study
from femstruct.laws.flores import Flores
from femstruct.laws.registry import spring
from femstruct.modal.closed_form import given_modes

ROUNDING = 1e-9  # steps and rounding: 6e-12 here at most

NONE = given_modes([], [], {})[0]
K, M, V = 1e8, 0.3, 1.7


def wall(law: Flores, duration: float) -> Scene:
    return Scene((Body("ball", M, -V),), (Contact("wall", "ball", GROUND, law),))


@pytest.mark.parametrize("e", [0.9, 0.5, 0.1, 1.0])
def test_the_published_hysteresis_factor(e: float) -> None:
    """As published: chi = 8 K (1 - e) / (5 e v), of a dashpot chi d^n d' beside K d^n."""
    law = Flores(K, e, V)
    assert law.exponent == 1.5
    assert K * law.dissipation == pytest.approx(8.0 * K * (1.0 - e) / (5.0 * e * V), rel=1e-15)  # rounding: 2e-16 here


@pytest.mark.parametrize("n", [1.0, 1.5, 2.2])
@pytest.mark.parametrize("e", [0.9, 0.5, 0.2])
def test_a_collision_by_dop853(e: float, n: float) -> None:
    """Peak, rebound and loss of a ball on a wall, the law written out again; what it returns by its closed relation."""

    def rate(_: float, y: np.ndarray) -> list[float]:
        d = max(y[0], 0.0)
        return [y[1], -K * d**n * (1.0 + 8.0 * (1.0 - e) / (5.0 * e) * y[1] / V) / M]

    def opens(t: float, y: np.ndarray) -> float:
        return float(y[0]) if t > 0 and y[0] > 0 else (-1.0 if t > 0 else 1.0)

    opens.terminal, opens.direction = True, -1.0  # type: ignore[attr-defined]
    depth = ((n + 1) * M * V**2 / (2 * K)) ** (1 / (n + 1))
    path = solve_ivp(
        rate, (0.0, 200 * depth / V), [0.0, V], "DOP853", events=opens, rtol=1e-13, atol=1e-18,
        max_step=0.01 * depth / V,
    )  # fmt: skip
    lasting, parting = path.t_events[0][0], -path.y_events[0][0][1]
    law = Flores(K, e, V, n)
    response = simulate(NONE, wall(law, lasting), Clock(1.2 * lasting, 500 / lasting))
    contact = response.contacts["wall"]
    assert response.bodies["ball"].velocity[-1] == pytest.approx(parting, rel=ROUNDING)
    assert contact.first_open == pytest.approx(lasting, rel=1e-7)  # it leaves slowly: d is known to 1e-18 m
    assert law.returns * V == pytest.approx(parting, rel=ROUNDING)
    assert 0.0 < e - law.returns < 0.0455  # the most it misses, at e = 0.24
    ledger = response.ledger
    assert ledger.end.lost_contacts["wall"] == pytest.approx(0.5 * M * (V**2 - parting**2), rel=ROUNDING)
    assert ledger.residual < ROUNDING
    forces = [-M * rate(0.0, y)[1] for y in path.y.T]
    assert contact.peak_force >= max(forces) * (1.0 - 1e-9)
    assert contact.peak_force == pytest.approx(max(forces), rel=1e-3)  # the largest of its steps


def test_the_energy_is_the_integral_of_the_force() -> None:
    law = Flores(K, 0.6, V, 2.2)
    system = compile_scene(NONE, wall(law, 1.0), Clock(1.0, 1.0)).system
    for depth in (1e-5, 1e-3):
        taken = quad(lambda d: K * d**2.2, 0.0, depth, epsrel=1e-13)[0]
        assert spring(system, 0, depth)[2] == pytest.approx(taken, rel=1e-12)  # rounding: 3e-13 here


def test_in_a_study(tmp_path: Path) -> None:
    (tmp_path / "model.yaml").write_text(
        "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\npoints: {m: {}}\n"
    )
    text = (
        "model: model.yaml\nmodes: {count: 1}\nbodies:\n  ball: {mass: 200 g, above: m, speed: 2 m/s}\n"
        "contacts:\n  hit: {between: [ball, m], law: {type: flores, stiffness: 1e8 N/m^1.5, restitution: 0.5}}\n"
        "time: {duration: 20 ms, sampling: 20 kHz}\n"
    )
    (tmp_path / "hit.study.yaml").write_text(text)
    law = read_study(tmp_path / "hit.study.yaml").cases[0].study.contacts[0].law
    assert law == Flores(1e8, 0.5, 2.0)


def test_what_is_refused() -> None:
    for numbers, message in (
        ((-1.0, 0.5, 1.0), "flores law stiffness: got -1"),
        ((1.0, 0.0, 1.0), "restitution: got 0"),
        ((1.0, 0.5, 0.0), "flores law speed: got 0"),
        ((1.0, 0.5, 1.0, 0.5), "flores law exponent: got 0.5"),
    ):
        with pytest.raises(FemstructError, match=message):
            Flores(*numbers)
