"""Junctions of slabs and walls against wave theory: what long plates send on of a bending wave that meets the line
where they are joined.

In a strip whose long sides are simply supported every wave is half a sine across; at a fixed frequency its width sets
the angle of incidence. Amplitudes of the waves towards the junction and away from it are fitted to the motion of each
plate under as many loads as there are plates, and give the scattering matrix: no absorbing ends are needed.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.sparse.linalg import splu

import femstruct as fs

E, RHO, NU = 30e9, 2300.0, 0.2
LONG, CELLS, ACROSS = 12.0, 20, 5  # m; elements along and across a strip
HZ = 15.0  # low, since the waves compared with take junctions for pinned: plates are stiff in their planes here
DIRECTIONS = ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (-1.0, 0.0, 0.0), (0.0, 0.0, -1.0))
PLATES = {"corner": (0, 1), "T": (0, 1, 2), "cross": (0, 1, 2, 3)}
# Diffuse transmission coefficients computed apart from this project, bending waves alone and a junction that is pinned:
# kind, thickness of the first plate and of those across [m], to a plate across, to the one opposite; None
# where angles beyond the cut-off of the thicker plates were not integrated exactly.
WAVES = [
    ("cross", 0.2, 0.1, 0.046821102, 0.24092911),
    ("cross", 0.2, 0.2, 0.083333333, 0.083333333),
    ("cross", 0.1, 0.2, 0.033107519, None),
    ("T", 0.2, 0.1, 0.054705356, 0.28154221),
    ("T", 0.2, 0.2, 0.14814815, 0.14814815),
    ("T", 0.1, 0.2, 0.10016399, None),
]


def rigidity(h: float) -> float:
    return E * h**3 / (12 * (1 - NU**2))


def wavenumber(h: float) -> float:
    return float(((2 * np.pi * HZ) ** 2 * RHO * h / rigidity(h)) ** 0.25)


@cache
def strip(kind: str, through: float, across: float, width: float) -> np.ndarray:
    """Scattering matrix [n, n] of bending waves at the junction of plates that are `width` wide [m]."""
    concrete = fs.Material("concrete", E=E, nu=NU, rho=RHO)
    directions = [np.array(DIRECTIONS[number]) for number in PLATES[kind]]
    if kind == "T":  # the first plate goes on opposite: the wall across stands on one side
        directions = [np.array(DIRECTIONS[number]) for number in (0, 1, 2)]
    thickness = [through if abs(one[0]) > 0 else across for one in directions]
    plates, supports = [], []
    for number, (along, h) in enumerate(zip(directions, thickness, strict=True)):
        normal = np.cross(along, [0.0, 1.0, 0.0])
        plates.append(
            fs.Plate(
                f"p{number}",
                concrete,
                h,
                (0.0, 0.0, 0.0),
                (LONG, width),
                (CELLS, ACROSS),
                normal=tuple(normal),
                x_direction=tuple(along),
                in_plane="elastic",
            )
        )
        sides = [fs.Support(f"p{number} {edge}", ("x", "z", "ry"), on=f"p{number}", edge=edge) for edge in ("y0", "y1")]
        # far away it is held lengthways: without that its mass alone would resist what moves the junction
        end = fs.Support(f"p{number} end", ("x" if abs(along[0]) > 0 else "z",), on=f"p{number}", edge="x1")
        supports += [*sides, end]
    joints = [fs.Joint(f"j{number}", "p0", f"p{number}") for number in range(1, len(plates))]
    model = fs.mesh_structure(fs.Structure(kind, tuple(plates), tuple(joints), supports=tuple(supports)))
    assembly = fs.assemble(model)
    places = assembly.points
    factor = splu((assembly.K - (2 * np.pi * HZ) ** 2 * assembly.M).tocsc())
    shape = np.sin(np.pi * places[:, 1] / width)
    readings, loads = [], []
    for along in directions:
        normal = np.cross(along, [0.0, 1.0, 0.0])
        here = np.flatnonzero((places @ along > 1e-9) & (np.abs(places @ normal) < 1e-9))
        x = np.unique((places[here] @ along).round(9))
        row = np.zeros((len(x), len(places), 7))
        for line, distance in enumerate(x):
            own = here[np.abs(places[here] @ along - distance) < 1e-6]
            row[line, own[:, None], np.arange(3)] = shape[own, None] * normal
        flat = row.reshape(len(x), -1) @ assembly.dofs.T
        readings.append((x, flat))
        loads.append(flat[-1])
    answers = factor.solve(np.array(loads).T)
    towards, away = np.zeros((2, len(directions), len(loads)), dtype=np.complex128)
    for number, ((x, row), h) in enumerate(zip(readings, thickness, strict=True)):
        k = wavenumber(h)
        kx, fades = np.sqrt(k**2 - (np.pi / width) ** 2 + 0j), np.sqrt(k**2 + (np.pi / width) ** 2)
        waves = np.column_stack(
            [np.exp(1j * kx * x), np.exp(-1j * kx * x), np.exp(-fades * x), np.exp(fades * (x - LONG))]
        )
        found = np.linalg.lstsq(waves[:-1], row[:-1] @ answers)[0]
        power = np.sqrt(rigidity(h) * k**2 * kx)
        towards[number], away[number] = found[0] * power, found[1] * power
    return away @ np.linalg.inv(towards)


def wave_theory(kind: str, through: float, across: float, sine: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Transmission to a plate across and to the one opposite, of bending waves at a pinned junction: in a plate that is
    turned at its edge with e^(j omega t), moment over angle is D (kappa + j kx)."""
    ky = wavenumber(through) * sine

    def moments(h: float) -> tuple[np.ndarray, np.ndarray]:
        k = wavenumber(h)
        kx = np.sqrt(k**2 - ky**2 + 0j)
        return rigidity(h) * (np.sqrt(k**2 + ky**2) + 1j * kx), rigidity(h) * kx.real

    (one, wave), (other, into) = moments(through), moments(across)
    straight, sideways = {"T": (2, 1), "cross": (2, 2)}[kind]
    whole = np.abs(straight * one + sideways * other) ** 2
    return 4 * wave * into / whole, 4 * wave**2 / whole


@pytest.mark.parametrize(("kind", "through", "across", "around", "opposite"), WAVES)
def test_the_wave_theory_is_that_of_the_digits(
    kind: str, through: float, across: float, around: float, opposite: float | None
) -> None:
    sine = (np.arange(20000) + 0.5) / 20000  # of angles in a diffuse field
    found = [float(one.mean()) for one in wave_theory(kind, through, across, sine)]
    assert found[0] == pytest.approx(around, rel=1e-6)  # the digits written down
    if opposite is not None:
        assert found[1] == pytest.approx(opposite, rel=1e-6)


@pytest.mark.parametrize(("kind", "n"), [("corner", 2), ("T", 3), ("cross", 4)])
def test_energy_and_reciprocity_at_a_junction(kind: str, n: int) -> None:
    found = np.abs(strip(kind, 0.2, 0.2, 12.0)) ** 2
    assert found.sum(axis=0) == pytest.approx(np.ones(n), abs=5e-3)  # five elements to half a wave
    assert found == pytest.approx(found.T, abs=5e-3)
    if kind == "corner":
        assert (
            abs(10 * np.log10(found[1, 0] / 0.5)) < 1.0
        )  # dB; 2 / n^2 at every angle, of plates stiff in their planes


SINES = (0.33, 0.6, 0.69, 0.85)
FEW = {("cross", 0.2, 0.1, 0.6), ("T", 0.1, 0.2, 0.33), ("T", 0.1, 0.2, 0.85)}


@pytest.mark.parametrize(
    ("kind", "through", "across", "sine"),
    [
        pytest.param(*case[:3], sine, marks=() if (*case[:3], sine) in FEW else pytest.mark.stress)
        for case in WAVES
        for sine in SINES
    ],
)
def test_transmission_at_an_angle_is_that_of_wave_theory(kind: str, through: float, across: float, sine: float) -> None:
    """Beyond the angle at which a thicker plate across carries no wave, only the one opposite takes any."""
    found = np.abs(strip(kind, through, across, np.pi / (wavenumber(through) * sine))[:, 0]) ** 2
    wanted = [float(one[0]) for one in wave_theory(kind, through, across, np.array([sine]))]
    for got, want in zip(found[1:3], wanted, strict=True):
        if want > 0:
            # stiffness of the plates in their planes, which the theory has as infinite; elements across
            assert abs(10 * np.log10(got / want)) < 0.6
