"""What pushes the modes, told to a listener of a batch: against closed forms of the force and its impulse."""

import numpy as np
import pytest
from scipy.integrate import quad

from femstruct.errors import InputError
from femstruct.impact.batch import Listener, simulate_batch
from femstruct.impact.scene import GROUND, Blows, Body, Clock, Contact, HalfSine, Load, Scene
from femstruct.laws.linear import Linear
from femstruct.modal.closed_form import given_modes, oscillator


def moments_of(basis, scene, vary, sampling, duration):  # type: ignore[no-untyped-def]
    """Moments [runs, r, cells + 2] and shares [r, k]."""
    found = []

    def of(moments, shares):  # type: ignore[no-untyped-def]
        found.append((moments, shares))
        return moments.sum(axis=2)[:, :1]

    cells = round(duration * sampling)
    batch = simulate_batch(
        basis, scene, Clock(duration, sampling), vary, 1, listener=Listener(1.0 / sampling, cells, 1, of)
    )
    return batch, np.concatenate([moments for moments, _ in found]), found[0][1]


def hat_moments(force, sampling, cells, end):  # type: ignore[no-untyped-def]
    """The integrals of a force until `end` times a hat around each time of the grid, by quadrature."""
    told = []
    for cell in range(cells + 2):
        centre = cell / sampling
        parts = ((centre - 1.0 / sampling, centre), (centre, centre + 1.0 / sampling))
        told.append(
            sum(
                quad(lambda t, c=centre: force(t) * (1.0 - abs(t - c) * sampling), max(low, 0.0), min(high, end))[0]
                for low, high in parts
                if max(low, 0.0) < min(high, end)
            )
        )
    return np.array(told)


@pytest.mark.parametrize("sampling", [100.0, 2e3, 40e3])
def test_moments_of_a_half_sine_of_contact(sampling: float) -> None:
    """A ball of mass m on a spring k to the ground: F = v sqrt(km) sin(sqrt(k / m) t) for half a period, 10 ms; with
    cells far longer than the steps, of their length, and far shorter."""
    k, mass = 1e4 * np.pi**2, 1.0
    scene = Scene((Body("ball", mass, -1.0),), (Contact("hit", upper="ball", lower=GROUND, law=Linear(k)),))
    basis, _ = given_modes([], [], {})
    batch, moments, _ = moments_of(basis, scene, {"ball.velocity": [-1.0, -2.0]}, sampling, 0.05)
    cells = round(0.05 * sampling)
    rate = np.sqrt(k / mass)
    chosen = np.unique(np.linspace(0, min(cells, 500), 40).astype(int))
    exact = hat_moments(lambda t: np.sqrt(k * mass) * np.sin(rate * t), sampling, cells if cells < 300 else 2, 0.01)
    if cells >= 300:
        # the integral of sin(w t) times a hat of width d around t_j is sin(w t_j) times that of cos(w u) times the hat
        hat = (2.0 * np.sin(0.5 * rate / sampling) / (rate / sampling)) ** 2 / sampling
        inside = np.arange(1, round(0.01 * sampling))
        chosen = chosen[(chosen > 0) & (chosen < len(inside))]
        exact = np.zeros(cells + 2)
        exact[inside] = np.sqrt(k * mass) * np.sin(rate * inside / sampling) * hat
    for run, speed in enumerate((1.0, 2.0)):
        own = moments[run, 0]
        # forces are held to 1e-8 of their largest in every step, and two points in a cell of a long step to 1e-6
        np.testing.assert_allclose(own[chosen], speed * exact[chosen], atol=2e-8 * speed * exact.max())
        assert own.sum() == pytest.approx(2.0 * speed * mass, rel=1e-7)  # the impulse turns the ball round
    np.testing.assert_allclose(batch.at_receivers[:, 0], [2.0, 4.0], rtol=1e-7)  # the same


def test_loads_push_as_they_are_and_where_they_act() -> None:
    basis, points = given_modes([20.0, 50.0], [0.01, 0.01], {"p": [0.3, -0.2], "q": [0.1, 0.4]})
    pulse = Load("tap", points["q"].probe("z"), HalfSine(5.0, 125.0))
    scene = Scene(
        (Body("ball", 1.0, -1.0),), (Contact("hit", "ball", points["p"].probe("z"), Linear(1e5)),), (), (pulse,)
    )
    _, moments, shares = moments_of(basis, scene, {"tap.amplitude": [5.0, 10.0]}, 5e3, 0.02)
    np.testing.assert_allclose(np.abs(shares), [[0.3, 0.2], [0.1, 0.4]], rtol=1e-12)  # as given
    for run, amplitude in enumerate((5.0, 10.0)):
        impulse = 2.0 * amplitude * 0.004 / np.pi
        # a half sine of 4 ms by polynomials of degree 7 over steps of its own length
        assert moments[run, 1].sum() == pytest.approx(impulse, rel=1e-7)
    assert np.abs(moments[:, 1, 22:]).max() < 1e-12 < np.abs(moments[:, 1, 20]).max()  # the pulse ends at 4 ms


def test_a_mass_moves_as_its_pushes_say() -> None:
    """Velocity of a mass of 2 kg at the end is the sum of all moments over its mass, whatever hits it and how often."""
    basis, points = oscillator(2.0, frequency_hz=0.0, axis="z")
    hit = Contact("hit", upper="ball", lower=points["m"].probe("z"), law=Linear(1e6))
    scene = Scene((Body("ball", 0.5, -1.0),), (hit,), blows=(Blows("ball", points["m"].probe("z"), 0.02, 3),))
    _, moments, shares = moments_of(basis, scene, {"ball.mass": [0.5, 1.0, 4.0]}, 10e3, 0.08)
    for run, mass in enumerate((0.5, 1.0, 4.0)):
        speed = 0.0
        for _ in range(3):  # an elastic blow of a ball of 1 m/s on the mass, which may be faster already
            speed += 2.0 * mass * max(1.0 - speed, 0.0) / (mass + 2.0)
        told = abs(float(shares[0] @ [1.0])) * moments[run, 0].sum() / np.sqrt(2.0)
        assert told == pytest.approx(speed, rel=1e-6)  # forces are held to 1e-8, and sum up over three blows


def test_no_listener_hears_nothing() -> None:
    basis, _ = given_modes([], [], {})
    scene = Scene((Body("ball", 1.0, -1.0),), (Contact("hit", upper="ball", lower=GROUND, law=Linear(1e4)),))
    assert simulate_batch(basis, scene, Clock(0.1, 1e3), {"ball.mass": [1.0, 2.0]}, 1).at_receivers.shape == (2, 0)
    with pytest.raises(InputError):
        simulate_batch(basis, scene, Clock(0.1, 1e3), {"nobody.mass": [1.0]}, 1)
