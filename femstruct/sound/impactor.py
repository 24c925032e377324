"""The crossing from striking bodies to the air: a body that is pushed becomes a sphere whose own sound is computed."""

from __future__ import annotations

from typing import Final

import numpy as np

from acoustics.errors import Advice
from acoustics.open_air.baffle import Baffle
from acoustics.open_air.sphere import Sphere
from femstruct.arrays import Floats
from femstruct.impact.result.response import Response
from femstruct.impact.scene.bodies import Body

MOVED: Final = 0.1  # radii by which a sphere may move while it is pushed: 1 dB, as the sound goes with its height


def pushed_velocity(response: Response, name: str) -> Floats:
    """What contacts, links and loads made of a body's velocity since the start [nt] [m/s], along its axis.

    Notes
    -----
    Left out is what makes no sound: the speed it starts with, as if it had always had it; its weight, which is there
    all the time and would add a constant of rho a^3 g / 2 r^2, 60 uPa of a ball of 1 cm a metre away; and the hand that
    gives it its starting state again for the next blow, in the interval of the samples where it does.
    """
    body, t = _body(response, name), response.t
    velocity = response.bodies[name].velocity
    gained = np.diff(velocity)
    blows = np.array([blow.t for blow in response.blows if blow.body == name])
    started = next((plan.first for plan in response.scene.blows if plan.body == name), 0.0)
    if body.falls:
        gained = gained + response.scene.gravity * np.diff(t)
    dt = 1.0 / response.clock.sampling
    handled = t[1:] <= started + 1e-9 * dt
    for blow in blows[blows > 0.0]:
        handled |= (t[:-1] - 1e-9 * dt <= blow) & (blow <= t[1:] + 1e-9 * dt)
    gained[handled] = 0.0
    return np.concatenate([[0.0], np.cumsum(gained)])


def sphere_of(response: Response, name: str, radius: float, place: Floats, space: Baffle) -> Sphere:
    """A body as a sphere in a half space above or below a surface; place [3] of its centre from the space's origin."""
    along = float(space.normal[2]) * pushed_velocity(response, name)
    return Sphere(radius, place, along, 1.0 / response.clock.sampling)


def moved_advice(response: Response, name: str, radius: float) -> tuple[Advice, ...]:
    """Advice on a sphere that moves far from where it is first pushed, and is pushed there, though it is heard from
    one place."""
    pushed = np.zeros(len(response.t), dtype=bool)
    for contact in response.scene.contacts:
        if name in (contact.upper, contact.lower):
            pushed |= response.contacts[contact.name].force != 0.0
    there = response.bodies[name].displacement[pushed]
    way = float(np.abs(there - there[:1]).max(initial=0.0))
    if way <= MOVED * radius:
        return ()
    return (
        Advice(
            "impactor-moves",
            f"{name} moves by {1e3 * way:.3g} mm during contact, {way / radius:.2g} of its radius; {MOVED:g} is "
            "allowed. "
            "Its own sound is computed for a sphere at a fixed place: the error may be more than 1 dB",
            {"moved_m": way, "radius_m": radius, "allowed": MOVED},
        ),
    )


def _body(response: Response, name: str) -> Body:
    return next(body for body in response.scene.bodies if body.name == name)
