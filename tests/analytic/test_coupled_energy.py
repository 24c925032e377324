"""Who holds the energy of modes that a structure, the air of its room and walls that yield share.

A piston on a spring over air that moves linearly between it and a floor that yields: two degrees of freedom, integrated
by another solver. The air is so fast that it has no mode of its own.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.sparse import csr_array

from acoustics.air import Air
from acoustics.fields.rectangular import Room
from acoustics.fields.shaped import ShapedRoom
from acoustics.losses import Losses, losses_from_beta
from acoustics.meshed.cavity_mesh import box_mesh
from acoustics.meshed.walls import YieldingWall
from acoustics.rooms.box_coupling import Leak
from femstruct.impact.scene import Clock, HalfSine, Load, Scene
from femstruct.impact.shares import energy_by_holder_over_time, mode_energies
from femstruct.impact.simulate import simulate
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import oscillator
from femstruct.model.probe import Surface
from femstruct.sound.coupling import with_cavity
from femstruct.sound.placed import placed

ROUNDING = 1e-13  # rounding: 8e-16 here at most

LX, LY, L, MASS, STIFFNESS = 0.58, 0.47, 0.1, 29.68, 4.641e5
AREA = LX * LY
FAST = Air(34e3, 1.29e-4)  # as stiff as air, without a resonance below 29 kHz
WALL = YieldingWall(100.0, 100.0 * (2 * np.pi * 60.0) ** 2)
PISTON, _points = oscillator(MASS, stiffness=STIFFNESS, axis="z")
PLACE = _points["m"].probe("z")
PUSH = Load("push", PLACE, HalfSine(-100.0, 50.0))


def underside() -> Surface:
    gauss, parts = np.polynomial.legendre.leggauss(3)
    x, y = (part.ravel() for part in np.meshgrid(0.5 * LX * gauss, 0.5 * LY * gauss, indexing="ij"))
    area = np.outer(0.5 * LX * parts, 0.5 * LY * parts).ravel()
    rows = csr_array(np.tile([[0, 0, -1.0, 0, 0, 0, 0]], (len(x), 1)))
    points = np.column_stack([x, y, 0 * x])
    corners = np.array([[-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]]) * [LX / 2, LY / 2, 0]
    return Surface("under", points, area, np.tile([0, 0, -1], (len(x), 1)), [[1, 0, 0], [0, -1, 0]], corners, rows)


def over(wall: YieldingWall | None, air: Air = FAST) -> ModalBasis:
    walls = {} if wall is None else {"z0": wall}
    room = ShapedRoom(box_mesh((LX, LY, L), (1, 1, 3)), "z1", air, Losses(), walls, 1000.0)
    return with_cavity(PISTON, placed(room, underside(), name="box"))


def by_hand(wall: YieldingWall, t: np.ndarray) -> dict[str, np.ndarray]:
    """Energies of piston, air and wall of two degrees of freedom: x of the piston, w of the wall, both downwards."""
    gas = FAST.bulk_modulus * AREA / L
    inertia = FAST.rho * AREA * L / 6 * np.array([[2.0, 1.0], [1.0, 2.0]])
    parts = {
        "structure": (np.diag([MASS, 0.0]), np.diag([STIFFNESS, 0.0])),
        "air of box": (inertia, gas * np.array([[1.0, -1.0], [-1.0, 1.0]])),
        "walls of box": (np.diag([0.0, wall.mass * AREA]), np.diag([0.0, wall.stiffness * AREA])),
    }
    M, K = (sum(part[i] for part in parts.values()) for i in (0, 1))

    def rates(now: float, y: np.ndarray) -> np.ndarray:
        push = 100.0 * np.sin(2 * np.pi * 50.0 * now) if now < 0.01 else 0.0
        return np.concatenate([y[2:], np.linalg.solve(M, np.array([push, 0.0]) - K @ y[:2])])

    begun = solve_ivp(rates, (0.0, 0.01), np.zeros(4), "DOP853", rtol=1e-12, atol=1e-16)
    run = solve_ivp(rates, (0.01, t[-1]), begun.y[:, -1], "DOP853", rtol=1e-12, atol=1e-16, t_eval=t)
    u, v = run.y[:2], run.y[2:]
    return {name: 0.5 * ((v * (m @ v)).sum(axis=0) + (u * (k @ u)).sum(axis=0)) for name, (m, k) in parts.items()}


def test_energies_of_piston_air_and_wall() -> None:
    response = simulate(over(WALL), Scene(loads=(PUSH,)), Clock(0.1, 8e3))
    t = np.linspace(0.02, 0.095, 301)  # on samples
    found, exact = energy_by_holder_over_time(response, t), by_hand(WALL, t)
    whole = sum(exact.values()).max()
    assert list(found) == list(exact)
    for name, energy in exact.items():
        assert energy.max() > 0.02 * whole, name  # each has its part
        # 1e-10: tolerance of the other solver; 7e-13 measured, as sound crosses this air in 3 us
        assert np.abs(found[name] - energy).max() < 1e-10 * whole, name


@pytest.mark.parametrize("wall", [None, WALL, replace(WALL, mass=0.0, resistance=200.0)])
def test_what_is_held_adds_up_to_the_ledger(wall: YieldingWall | None) -> None:
    response = simulate(over(wall, Air(340.0, 1.29)), Scene(loads=(PUSH,)), Clock(0.05, 24e3))
    shares, end = mode_energies(response), response.ledger.end
    assert sum(shares.held_at_end.values()) == pytest.approx(end.structure, rel=ROUNDING)
    assert all(energy > 0.0 for energy in shares.held_at_end.values())
    assert shares.held_at_separation == {}


def test_a_leak_and_two_rooms() -> None:
    """The plug of a leak is air; a second room leaves what the first holds with it."""
    air = Air(340.0, 1.29)
    first = Room([LX, LY, L], air, losses_from_beta(0.01, 300.0))
    leaking = with_cavity(PISTON, placed(first, underside(), name="box"), leak=Leak(20.0, 2000.0), up_to_hz=1000.0)
    both = with_cavity(leaking, placed(Room([LX, LY, 0.2], air), underside(), name="hall"), up_to_hz=1000.0)
    assert list(both.holders) == ["structure", "air of box", "air of hall"]
    for basis in (leaking, both):
        inertia, stiffness = (
            sum(getattr(h, which) for h in basis.holders.values()) for which in ("inertia", "stiffness")
        )
        assert np.abs(inertia - np.eye(len(inertia))).max() < ROUNDING
        assert np.abs(stiffness - np.diag(basis.omega**2)).max() < ROUNDING * basis.omega.max() ** 2
    assert not PISTON.holders
