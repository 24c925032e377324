"""What reaches the room of modes that hardly move its ceiling."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from acoustics.fields.rectangular import Room
from femstruct.impact.scene import Body, Clock, Contact, Scene
from femstruct.impact.simulate import simulate
from femstruct.laws.linear import Linear
from femstruct.modal.closed_form import given_modes
from femstruct.model.probe import Surface
from femstruct.sound.placed import placed
from femstruct.sound.surfaces import surface_velocity


def test_modes_that_do_not_move_the_ceiling_are_left_out_and_only_those():
    """Three modes, the ball on a node of the second: the others arrive as they are, sample for sample."""
    basis, points = given_modes([30.0, 55.0, 90.0], [0.01] * 3, {"p": [1.0, 0.0, 1e-6]})
    hit = Contact("hit", upper="ball", lower=points["p"].probe("z"), law=Linear(1e5))
    response = simulate(basis, Scene((Body("ball", 1.0, -1.0),), (hit,)), Clock(0.05, 10e3))
    below = Surface(
        "below", [[0, 0, 0]], [0.25], [[0, 0, -1]], [[1, 0, 0], [0, 1, 0]],
        [[-0.25, -0.25, 0], [0.25, -0.25, 0], [0.25, 0.25, 0], [-0.25, 0.25, 0]],
        csr_array([[0, 0, -1.0, 0, 0, 0, 0]]),
    )  # fmt: skip
    (moving,) = surface_velocity(response, placed(Room([0.5, 0.5, 1.0]), below))
    assert moving.rates.shape == (1, 500)  # the third moves 1e-12 as much: 1e-6 pushed, 1e-6 seen
    assert np.array_equal(moving.rates, response.qd[[0]])
    assert response.amplitudes()[0] >= np.abs(response.qd[0]).max() * (1 - 1e-9)
