"""A small press whose die a ram strikes, for every contact law and with modes to three limits: shock spectrum, Wk and a
low-passed peak of the struck point against bars of a high order and a ram by scipy, stopped at every touch."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq
from scipy.signal import butter, sosfiltfilt

from femstruct.language.cases import read_study
from femstruct.laws.registry import LAWS as ALL_LAWS
from femstruct.study.results import CaseResult
from femstruct.workflow.run import run_study
from tests.independent import contact_events as by_events
from tests.independent.contact_events import Chain, Law, Touch, chi_of_restitution
from tests.independent.frames import Skeleton, section
from tests.independent.vibration import running_rms, shock_spectrum, w_k, weighted

MODEL = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
sections: {beam: {shape: rectangle, width: 60 mm, height: 80 mm}, column: {shape: circle, diameter: 40 mm}}
parts:
  bed: {type: frame, material: steel, section: beam, mesh: 20 mm, lines: [[[-0.4, 0, 0.5], [0.4, 0, 0.5]]]}
  columns:
    type: frame
    material: steel
    section: column
    mesh: 20 mm
    lines: [[[-0.4, 0, 0], [-0.4, 0, 0.5]], [[0.4, 0, 0], [0.4, 0, 0.5]]]
  isolators: {type: spring, between: [feet, ground], stiffness: {x: 1 MN/m, z: 1 MN/m}}
joints: {corners: {connect: [columns, bed]}}
points: {die: {on: bed, at: [0, 0, 0.5]}, feet: {on: columns, at: [[-0.4, 0, 0], [0.4, 0, 0]]}}
supports: {guide: {at: feet, fix: [y, rx, rz]}}
damping: {ratio: 2 %}
"""
STUDY = """
model: model.yaml
modes: {up_to: 800 Hz}
bodies: {ram: {mass: 5 kg, above: die, speed: 1 m/s}}
contacts: {blow: {between: [ram, die], gap: GAP, law: LAW}}
record: {die.z: acceleration}
time: {duration: 100 ms, sampling: 40 kHz, gravity: false}
peaks: {lowpass: 200 Hz}
shock_spectra: {die: {of: die.z, band: [50 Hz, 400 Hz], per_octave: 1}}
perception: {felt: {of: die.z, weighting: Wk}}
"""
RAM, FINE = 5.0, 200e3


def dashpot_of_restitution(k: float, e: float) -> float:
    """c with which a ram that meets a wall at 1 m/s with k d + c d' parts at e, where the force has come to zero."""

    def miss(c: float) -> float:
        over: Any = lambda _, y: k * y[0] + c * y[1]  # noqa: E731
        over.terminal, over.direction = True, -1.0
        path = solve_ivp(
            lambda _, y: [y[1], -(k * y[0] + c * y[1]) / RAM], (0.0, 1.0), [0.0, 1.0], "DOP853", events=over,
            rtol=1e-9, atol=1e-15, first_step=1e-7,
        )  # fmt: skip
        return float(-path.y[1, -1]) - e

    return float(brentq(miss, 1e-3 * (k * RAM) ** 0.5, 1.9 * (k * RAM) ** 0.5, rtol=1e-6))


def monotone(depths: list[float], forces: list[float], chi: float) -> Law:
    curve = PchipInterpolator(depths, forces)
    return by_events.factored(lambda d, _: float(curve(d)), chi)


def hertz_of(radius: float, E: float, nu: float) -> float:
    """A ball on a flat of the same material."""
    return 4.0 / 3.0 * E / (2.0 * (1.0 - nu**2)) * radius**0.5


LAWS: dict[str, tuple[str, Any]] = {
    "linear": (
        "{type: linear, stiffness: 100 MN/m, restitution: 0.3}",
        lambda: by_events.linear(1e8, dashpot_of_restitution(1e8, 0.3)),
    ),
    "linear of c": (
        "{type: linear, stiffness: 100 MN/m, damping: 15 kN*s/m}",
        lambda: by_events.linear(1e8, 15e3),
    ),
    "linear that pulls": (
        "{type: linear, stiffness: 100 MN/m, damping: 15 kN*s/m, tensile: true}",
        lambda: by_events.linear(1e8, 15e3, True),
    ),
    "stop": ("{type: stop, stiffness: 100 MN/m, damping: 10 kN*s/m}", lambda: by_events.linear(1e8, 10e3)),
    "hertz": ("{type: hertz, stiffness: 5 GN/m^1.5}", lambda: by_events.hertz(5e9)),
    "hertz of balls": (
        "{type: hertz, radius: 50 mm, E: [210 GPa, 210 GPa], nu: [0.3, 0.3]}",
        lambda: by_events.hertz(hertz_of(0.05, 210e9, 0.3)),
    ),
    "hertz with loss": (
        "{type: hertz, stiffness: 5 GN/m^1.5, damping: 1e6}",
        lambda: by_events.hertz(5e9, 1e6),
    ),
    "hunt-crossley": (
        "{type: hunt-crossley, stiffness: 5 GN/m^1.5, restitution: 0.3, at_speed: 1 m/s}",
        lambda: by_events.power(5e9, 1.5, chi_of_restitution(0.3, 1.0)),
    ),
    "lankarani-nikravesh": (
        "{type: lankarani-nikravesh, stiffness: 5 GN/m^1.5, restitution: 0.8, at_speed: 1 m/s}",
        lambda: by_events.power(5e9, 1.5, 0.75 * (1.0 - 0.8**2)),
    ),
    "flores": (
        "{type: flores, stiffness: 5 GN/m^1.5, restitution: 0.3, at_speed: 1 m/s}",
        lambda: by_events.power(5e9, 1.5, 8.0 * 0.7 / (5.0 * 0.3)),
    ),
    "cubic": (
        "{type: cubic, stiffness: 50 MN/m, cubic: 1e15 N/m^3, restitution: 0.3, at_speed: 1 m/s}",
        lambda: by_events.cubic(5e7, 1e15, chi_of_restitution(0.3, 1.0)),
    ),
    "table": (
        "{type: table, curve: [[0 mm, 0 N], [0.1 mm, 4 kN], [2 mm, 300 kN]], restitution: 0.3, at_speed: 1 m/s}",
        lambda: by_events.table([0.0, 1e-4, 2e-3], [0.0, 4e3, 3e5], chi_of_restitution(0.3, 1.0)),
    ),
    "table that is smooth": (
        "{type: table, curve: [[0 mm, 0 N], [0.1 mm, 4 kN], [2 mm, 300 kN]], dissipation: 1, smooth: true}",
        lambda: monotone([0.0, 1e-4, 2e-3], [0.0, 4e3, 3e5], 1.0),
    ),
}  # fmt: skip
FREQUENCIES = np.array([50.0, 100.0, 200.0, 400.0])
BOTH_SIDES = ("stop",)
MOST = 0.05  # what is asked of every number


@dataclass(frozen=True)
class Right:
    """What another program says of the die."""

    spectrum: dict[float, float]
    felt: float
    low: float


@lru_cache
def press() -> tuple[np.ndarray, np.ndarray]:
    """Natural frequencies [Hz] up to 20 kHz that move the die, and how much, by elements of the 11th degree."""
    frame = Skeleton(11)
    E, G, rho = 210e9, 210e9 / 2.6, 7850.0
    left, right, a, b, die = (
        frame.place(np.array(one))
        for one in ([-0.4, 0, 0.0], [0.4, 0, 0.0], [-0.4, 0, 0.5], [0.4, 0, 0.5], [0.0, 0, 0.5])
    )
    beam, column = section("rectangle", width=0.06, height=0.08), section("circle", diameter=0.04)
    for one, other, shape in ((a, die, beam), (die, b, beam), (left, a, column), (right, b, column)):
        frame.bar(one, other, shape, E, G, rho)
    for foot in (left, right):
        frame.hold(foot, (1, 3, 5))
        frame.spring(foot, None, np.array([1e6, 0, 1e6, 0, 0, 0]))
    hertz, shapes = frame.modes()
    moves = shapes[6 * die + 2]
    kept = (hertz < 20e3) & (np.abs(moves) > 1e-6)
    return hertz[kept], moves[kept]


def simulated(law: Law, gap: float, both: bool) -> Right:
    """The ram and many modes; what a spectrum, a weighting and a filter see is the change of the die's speed between
    times 5 us apart, which misses nothing between them."""
    hertz, moves = press()
    touches = [Touch("blow", "ram", "die", law, gap)]
    if both:
        touches.append(Touch("back", "die", "ram", law, gap))
    chain = Chain(
        (2 * np.pi * hertz).tolist(), [0.02] * len(hertz), {"die": moves.tolist()}, {"ram": RAM}, touches,
        start={"ram": -1.0},
    )  # fmt: skip
    path = by_events.run(chain, 0.1, rtol=1e-6, max_step=1e-4)  # trial steps of a steep law overflow
    a = FINE * np.diff(path.speed("die", np.arange(int(0.1 * FINE) + 1) / FINE))
    up, down = shock_spectrum(np.concatenate([[0.0], a]), 1 / FINE, FREQUENCIES, 0.05)
    felt = running_rms(weighted(a, FINE, w_k), FINE, 1.0).max()
    still = np.zeros(int(0.05 * FINE))
    low = sosfiltfilt(butter(4, 200.0, fs=FINE, output="sos"), np.concatenate([still, a, still]))
    inside = np.abs(low[len(still) : len(still) + int(0.09 * FINE)])  # what follows the window is not known here
    return Right(dict(zip(FREQUENCIES, np.maximum(up, down), strict=True)), float(felt), float(inside.max()))


def run(folder: Path, law: str, gap: float, limit: str) -> CaseResult:
    (folder / "model.yaml").write_text(MODEL, encoding="utf-8")
    path = folder / "press.study.yaml"
    path.write_text(STUDY.replace("GAP", f"{1e3 * gap} mm").replace("LAW", law), encoding="utf-8")
    return run_study(read_study(path, (f"modes.up_to={limit}",))).cases["as given"]


def marked(case: CaseResult) -> set[str]:
    told = [one for one in case.findings if one.code == "evaluation-not-converged"]
    return {f"{one.message.split(':')[0]} {name}" for one in told for name in one.values}


def compared(case: CaseResult, right: Right) -> dict[str, float]:
    """Relative differences of all that is not marked."""
    doubts, spectrum = marked(case), case.evaluations["shock_spectra"]["die"]
    found = {
        f"shock_spectra.die value at {hertz:.4g} Hz": value / right.spectrum[round(hertz)] - 1.0
        for value, hertz in zip(spectrum.maximax, spectrum.frequency_hz, strict=True)
    }
    found["perception.felt KB_Fmax, MTVV"] = case.evaluations["perception"]["felt"].largest / right.felt - 1.0
    found = {name: apart for name, apart in found.items() if name not in doubts}
    if not [one for one in case.findings if one.code == "peak-not-converged"]:
        found["low-passed peak"] = case.channels["die.z acceleration"].whole / right.low - 1.0
    return found


def test_every_law_is_here() -> None:
    """Every law that has a word in study files, and no other."""
    assert {law.split(",")[0].removeprefix("{type: ") for law, _ in LAWS.values()} == {
        law.word for law in ALL_LAWS if law.word
    }


CASES = [(name, gap) for name in LAWS for gap in (0.0, 1e-3) if gap or name not in BOTH_SIDES]
FEW = [("linear", 0.0), ("stop", 1e-3)]


@pytest.mark.parametrize(
    ("name", "gap"),
    [pytest.param(*one, marks=[] if one in FEW else [pytest.mark.stress]) for one in CASES],
)
def test_what_a_struck_die_does_is_right_or_marked(tmp_path: Path, name: str, gap: float) -> None:
    """Within 5 % of the simulation with modes to three limits, or marked."""
    law, of = LAWS[name]
    right = simulated(of(), gap, name in BOTH_SIDES)
    for limit in ("800 Hz", "2 kHz", "5 kHz"):
        found = compared(run(tmp_path, law, gap, limit), right)
        assert not {which: apart for which, apart in found.items() if abs(apart) > MOST}, limit
        # marks are no way out where the modes are enough; a ram between two stops hits six times, each time otherwise
        assert limit == "800 Hz" or len(found) == 6 or name in BOTH_SIDES
