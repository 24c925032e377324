"""Signs and conventions along the whole chain, from YAML to pressure, by cases with obvious answers."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.typing import NDArray

from femstruct.errors import InputError
from femstruct.files.results_file import write_results
from femstruct.language.cases import read_study
from femstruct.study.results import CaseResult
from femstruct.view.terminal import main_tables
from femstruct.workflow.bases import static_states
from femstruct.workflow.run import run_study

ROUNDING = 1e-12  # rounding: 9e-15 here at most

Floats = NDArray[np.float64]
Run = Callable[[str, str], CaseResult]
G = 9.80665

NONE = "structure: none"
OSCILLATOR = """
structure: {type: oscillator, mass: 2 kg, stiffness: 800 N/m}
points: {m: {}}
"""
ROD = """
structure: {type: rod, length: 1 m, E: 200 GPa, rho: 7850, area: 3 cm2, modes: 8}
points: {left: {at: 0}, right: {at: 1 m}}
"""
FREE = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 8000}}
parts:
  plate: {type: plate, material: steel, thickness: 20 mm, origin: [-0.3, -0.2, 0], size: [0.6, 0.4], mesh: [6, 4]}
points:
  c: {on: plate, at: center}
  east: {on: plate, at: [0.5, 0.2]}
surfaces:
  under: {on: plate, side: below}
  top: {on: plate, side: above}
damping: {ratio: 10 %}
"""
MASS = 8000 * 0.02 * 0.6 * 0.4
BEDDED = FREE.replace(
    "points:", "  bed: {type: foundation, on: plate, region: whole, stiffness: {normal: 1e10, shear: 1e10}}\npoints:"
)
HELD = FREE + "supports: {edges: {on: plate, edge: all, fix: simple}}\n"
ROOM = """
rooms:
  box:
    size: [0.6, 0.4, 0.3]
    under: under
    losses: {t60: 30 ms}
    receivers: {mic: [0.3, 0.2, 0.15], west: [0.05, 0.2, 0.25], east: [0.55, 0.2, 0.25]}
"""


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """Run a study of one case, both files given as text."""

    def running(model: str, study: str) -> CaseResult:
        (tmp_path / "model.yaml").write_text(model)
        path = tmp_path / "study.yaml"
        path.write_text(f"model: model.yaml\n{study}")
        (case,) = run_study(read_study(path)).cases.values()
        return case

    return running


def values(case: CaseResult, channel: str) -> Floats:
    return case.channels[channel].values


def time(case: CaseResult) -> Floats:
    assert case.response is not None
    return case.response.t


def ledger_residual(case: CaseResult) -> float:
    assert case.response is not None
    return case.response.ledger.residual


# Loads


@pytest.mark.parametrize(("load", "force"), [("at: c.z", "-100 N"), ("on: top", "417 Pa")])
def test_a_push_from_above_goes_down_and_raises_the_pressure_below(run: Run, load: str, force: str) -> None:
    """Slow against all modes of a bedded plate: deflection, ground force and uniform compression are static."""
    study = f"""
modes: {{up_to: 3 kHz}}
loads: {{push: {{{load}, half_sine: {{amplitude: {force}, frequency: 5 Hz}}}}}}
record: {{c.z: displacement, bed: force, ground: force}}
time: {{duration: 0.1 s, sampling: 20 kHz}}
{ROOM}"""
    case = run(BEDDED, study)
    total = 100 if "N" in force else 417 * 0.24
    sine = np.sin(2 * np.pi * 5 * time(case))
    down, ground = values(case, "c.z displacement"), values(case, "ground force")
    # the load starts with a kink, which the plate on its bed answers at 1258 Hz: 5 / 1258
    assert np.abs(ground + total * sine).max() < 0.005 * total
    assert np.abs(values(case, "bed force") - ground).max() < ROUNDING * total
    # the plate yields locally under a force at a point
    assert down[1000] < -total / (1e10 * 0.24) * (1.0 if "N" in force else 0.995)
    volume = total / 1e10
    compression = 1.21 * 343**2 * volume / (0.6 * 0.4 * 0.3)
    # the mesh of the ceiling and 5 / 1258, squared: 8e-5 here
    assert values(case, "box.mic pressure")[1000] == pytest.approx(compression, rel=0.01)


def test_a_surface_is_pushed_against_from_its_own_side(run: Run) -> None:
    """Pressure on the underside lifts; the room below then thins."""
    study = f"""
modes: {{up_to: 3 kHz}}
loads: {{push: {{on: under, half_sine: {{amplitude: 100 Pa, frequency: 5 Hz}}}}}}
record: {{c.z: displacement, ground: force}}
time: {{duration: 0.1 s, sampling: 20 kHz}}
{ROOM}"""
    case = run(BEDDED, study)
    assert values(case, "c.z displacement")[1000] == pytest.approx(100 / 1e10, rel=2e-3)  # (5 / 1258)^2 = 1.6e-5
    assert values(case, "ground force")[1000] == pytest.approx(100 * 0.24, rel=2e-3)  # the same
    assert values(case, "box.mic pressure")[1000] < 0


def test_what_presses_on_supports_reaches_the_ground(run: Run) -> None:
    study = """
modes: {up_to: 3 kHz}
loads: {push: {at: c.z, half_sine: {amplitude: -100 N, frequency: 5 Hz}}}
record: {edges: force, ground: force}
time: {duration: 0.1 s, sampling: 4 kHz}
"""
    case = run(HELD, study)
    sine = np.sin(2 * np.pi * 5 * time(case))
    for channel in ("edges force", "ground force"):
        # the load starts with a kink, which the plate answers at its first mode, 430 Hz: 5 / 430, and more above
        assert np.abs(values(case, channel) + 100 * sine).max() < 3


@pytest.mark.parametrize(("load", "total"), [("at: c.z", "50 N"), ("on: under", "250 Pa")])
def test_momentum_of_a_half_sine(run: Run, load: str, total: str) -> None:
    """A free plate: 2 / pi of amplitude times length, which is half a period."""
    study = f"""
modes: {{up_to: 3 kHz}}
loads: {{hit: {{{load}, half_sine: {{amplitude: {total}, frequency: 250 Hz}}}}}}
record: {{c.z: velocity}}
time: {{duration: 50 ms, sampling: 20 kHz}}
save: modal
"""
    case = run(FREE, study)
    assert case.response is not None
    assert case.basis.n_rigid == 6
    amplitude = 50.0 if "N" in total else 250 * 0.24
    momentum = amplitude * (2 / np.pi) * 0.5 / 250
    rigid = case.basis.shapes[:, 2, :6] @ case.response.qd[:6, -1]
    assert rigid == pytest.approx(np.full(len(rigid), momentum / MASS), rel=1e-11)  # rounding: 4e-14 here


def test_a_force_file_pushes_a_body_along_its_axis(run: Run, tmp_path: Path) -> None:
    (tmp_path / "force.csv").write_text("time [s], force [N]\n0, 0\n0.1, 6\n0.2, 0\n")
    study = """
bodies: {b: {mass: 3 kg, above: ground}}
loads: {pull: {body: b, file: force.csv}}
record: {b: velocity}
time: {duration: 0.3 s, sampling: 1 kHz}
"""
    assert values(run(NONE, study), "b velocity")[-1] == pytest.approx(0.6 / 3, rel=1e-12)  # a triangle of 0.6 N s


# Bodies and contacts


@pytest.mark.parametrize(("side", "sign"), [("above", -1.0), ("below", 1.0)])
def test_a_body_moves_towards_what_it_was_put_beside(run: Run, side: str, sign: float) -> None:
    study = f"""
modes: {{count: 1}}
bodies: {{ball: {{mass: 0.1 kg, {side}: m, speed: 2 m/s, contact: {{type: linear, stiffness: 1e6}}}}}}
record: {{m.z: velocity, ball: [velocity, travel], ball on m: force}}
time: {{duration: 5 ms, sampling: 100 kHz}}
"""
    case = run(OSCILLATOR, study)
    assert values(case, "ball velocity")[0] == sign * 2
    assert values(case, "ball on m force").min() == 0
    # 0.1 kg against 2 kg, elastic, the spring of the oscillator far too soft to matter: (omega t)^2 ~ 1e-4
    assert values(case, "ball velocity")[-1] == pytest.approx(-sign * 2 * 1.9 / 2.1, rel=1e-3)
    # (omega t)^2 and what the spring takes: 2e-4 here
    assert values(case, "m.z velocity")[150] == pytest.approx(sign * 2 * 0.2 / 2.1, rel=1e-2)
    assert -sign * values(case, "ball travel")[-1] > 0
    net = values(case, "net force on m")
    assert sign * net.max() >= 0 and sign * net.min() >= 0
    assert ledger_residual(case) < ROUNDING


@pytest.mark.parametrize(("side", "end", "sign"), [("before", "left", 1.0), ("after", "right", -1.0)])
def test_before_and_after_run_along_x(run: Run, side: str, end: str, sign: float) -> None:
    study = f"""
modes: {{count: 8}}
bodies: {{ball: {{mass: 0.1 kg, {side}: {end}, speed: 2 m/s, contact: {{type: linear, stiffness: 1e6}}}}}}
record: {{{end}.x: displacement, ball: velocity}}
time: {{duration: 5 ms, sampling: 100 kHz}}
save: modal
"""
    case = run(ROD, study)
    assert values(case, "ball velocity")[0] == sign * 2
    assert values(case, "ball velocity")[-1] * sign < 0
    assert values(case, f"{end}.x displacement")[-1] * sign > 0
    assert case.response is not None
    rod = 7850 * 3e-4
    rigid = case.response.qd[0] / np.sqrt(rod)
    rigid *= np.sign(case.basis.shapes[0, 0, 0])
    assert 0.1 * values(case, "ball velocity") + rod * rigid == pytest.approx(sign * 0.2, rel=ROUNDING)


def test_a_gap_is_crossed_before_anything_happens(run: Run) -> None:
    study = """
modes: {count: 1}
bodies: {ball: {mass: 0.1 kg, above: m, speed: 2 m/s}}
contacts: {c: {between: [m, ball], law: {type: hertz, stiffness: 1e8}, gap: 3 mm}}
record: {m.z: displacement}
time: {duration: 5 ms, sampling: 100 kHz}
"""
    case = run(OSCILLATOR, study)
    assert case.response is not None
    assert case.response.events[0].t == pytest.approx(1.5e-3, rel=ROUNDING)
    assert (values(case, "m.z displacement")[time(case) < 1.5e-3] == 0).all()
    assert values(case, "m.z displacement")[-1] < 0


def test_a_stop_acts_both_ways(run: Run) -> None:
    """A body on a stop of 10 mm swings between its two sides, a stiff spring's half period spent in each."""
    study = """
bodies: {b: {mass: 1 kg, above: ground, speed: 1 m/s}}
contacts: {s: {between: [b, ground], law: {type: stop, stiffness: 1e6}, gap: 10 mm}}
record: {b: [displacement, velocity], s: force}
time: {duration: 0.2 s, sampling: 50 kHz}
"""
    case = run(NONE, study)
    place, depth = values(case, "b displacement"), 1 / 1e3  # v / omega
    assert place.max() == pytest.approx(10e-3 + depth, rel=1e-4)  # samples beside the turn: (omega dt)^2 / 8 = 5e-5
    assert place.min() == pytest.approx(-10e-3 - depth, rel=1e-4)  # the same
    assert case.response is not None
    closings = [event.t for event in case.response.events if event.what == "closes"]
    assert np.diff(closings) == pytest.approx(np.pi / 1e3 + 20e-3, rel=1e-11)  # rounding: 1e-14 here
    force = values(case, "s force")
    # pushes the body, the upper end, up at the lower side and down at the upper side
    assert force[place.argmin()] > 0 > force[place.argmax()]


# Links


@pytest.mark.parametrize(("half", "ratio"), [("closing", 0.3), ("opening", 0.3)])
def test_a_one_way_dashpot_acts_in_its_own_half(run: Run, half: str, ratio: float) -> None:
    """A mass on a spring to the ground, thrown down: closing damps the way down, opening the way up."""
    omega = 100.0
    study = f"""
bodies: {{b: {{mass: 1 kg, above: ground, speed: 1 m/s}}}}
links: {{l: {{between: [ground, b], stiffness: {omega**2} N/m, damping: {{{half}: {2 * ratio * omega} N*s/m}}}}}}
record: {{b: displacement, l: force}}
time: {{duration: 0.08 s, sampling: 50 kHz}}
"""
    case = run(NONE, study)
    place, root = values(case, "b displacement"), np.sqrt(1 - ratio**2)
    lowest = np.exp(-ratio / root * np.arccos(ratio)) if half == "closing" else 1.0
    highest = lowest if half == "closing" else np.exp(-ratio / root * np.pi)
    # samples are 0.002 rad apart
    assert place.min() == pytest.approx(-lowest / omega, rel=1e-5)
    assert place.max() == pytest.approx(highest / omega, rel=1e-5)
    assert values(case, "l force")[place.argmin()] == pytest.approx(lowest * omega, rel=1e-2)  # compressed: positive


@pytest.mark.parametrize("tuned", ["frequency: 20 Hz, ratio: 7 %", "stiffness: {k}, ratio: 7 %"])
def test_a_tuned_link_swings_its_body_at_its_frequency_and_ratio(run: Run, tuned: str) -> None:
    """A thrown mass on it: -v / omega_d exp(-ratio omega t) sin(omega_d t), for masses that differ."""
    omega, ratio, speed = 2 * np.pi * 20.0, 0.07, 0.5
    study = """
bodies: {b: {mass: %g kg, above: ground, speed: 0.5 m/s}}
links: {l: {between: [b, ground], %s}}
record: {b: displacement}
time: {duration: 0.3 s, sampling: 4 kHz}
"""
    for mass in (0.3, 40.0):
        case = run(NONE, study % (mass, tuned.format(k=mass * omega**2)))
        t, damped = time(case), omega * np.sqrt(1 - ratio**2)
        expected = -speed / damped * np.exp(-ratio * omega * t) * np.sin(damped * t)
        # rounding of a linear system that is stepped exactly
        assert values(case, "b displacement") == pytest.approx(expected, abs=1e-9 * speed / damped)


@pytest.mark.parametrize(
    ("link", "message"),
    [
        ("between: [b, c], frequency: 20 Hz", "got a frequency of a link between two bodies, expected one body"),
        ("between: [m, ground], ratio: 3 %, stiffness: 1", "got a ratio of a link between two places, expected one"),
        ("between: [b, ground], ratio: 3 %", "got a damping ratio without stiffness or frequency"),
        ("between: [b, ground], ratio: 3, stiffness: 1", "2 % is 0.02: did you mean 3 %?"),
        ("between: [b, ground], frequency: 3 Hz, stiffness: 1", "exactly one of stiffness, frequency"),
        ("between: [b, ground], frequency: 0 Hz", "expected a positive value: a frequency"),
        ("between: [b, ground], frequency: 3 Hz, ratio: 3 %, damping: 3", "exactly one of damping, ratio"),
    ],
)
def test_links_that_cannot_be_tuned(run: Run, link: str, message: str) -> None:
    bodies = "bodies: {b: {mass: 1 kg, above: m}, c: {mass: 1 kg, above: b}}\n"
    with pytest.raises(InputError) as caught:
        run(
            OSCILLATOR,
            f"modes: {{count: 1}}\n{bodies}links: {{l: {{{link}}}}}\ntime: {{duration: 1 s, sampling: 1 kHz}}",
        )
    assert message in str(caught.value), caught.value


def test_a_loaded_link_pushes_its_ends_apart_when_released(run: Run) -> None:
    study = """
bodies: {low: {mass: 1 kg, above: ground}, high: {mass: 1 kg, above: low}}
links: {l: {between: [low, high], stiffness: 800 N/m, preload: 4 N, release_at: 50 ms}}
record: {low: displacement, high: displacement}
time: {duration: 0.3 s, sampling: 10 kHz}
"""
    case = run(NONE, study)
    low, high = values(case, "low displacement"), values(case, "high displacement")
    assert (high[time(case) <= 0.05] == 0).all()
    assert (high - low).max() == pytest.approx(2 * 4 / 800, rel=1e-5)  # twice the static stroke
    assert (high - low).min() == pytest.approx(0, abs=ROUNDING)
    assert np.abs(high + low).max() < ROUNDING


@pytest.mark.parametrize("law", ["{type: linear, stiffness: 1e5}", "{type: hertz, stiffness: 1e7}"])
def test_a_preloaded_contact_stays_at_rest(run: Run, law: str) -> None:
    study = f"""
modes: {{count: 1}}
bodies: {{damper: {{mass: 0.4 kg, below: m}}}}
contacts: {{c: {{between: [m, damper], law: {law}, preload: 5 N}}}}
links: {{l: {{between: [damper, ground], stiffness: 500 N/m}}}}
record: {{m.z: velocity, damper: velocity, c: force}}
time: {{duration: 0.1 s, sampling: 10 kHz}}
"""
    case = run(OSCILLATOR, study)
    # rounding: 5 N less 5 N
    assert np.abs(values(case, "m.z velocity")).max() < 1e-15
    assert np.abs(values(case, "damper velocity")).max() < 1e-15
    assert values(case, "c force") == pytest.approx(5, rel=ROUNDING)


# Gravity


def test_a_hanging_body_stays_where_it_hangs(run: Run, tmp_path: Path) -> None:
    study = """
modes: {count: 1}
bodies: {b: {mass: 0.4 kg, below: m}}
links: {l: {between: [m, b], stiffness: 200 N/m, damping: 3}}
record: {b: velocity, m.z: velocity}
time: {duration: 0.5 s, sampling: 1 kHz, gravity: true}
"""
    case = run(OSCILLATOR, study)
    assert not values(case, "b velocity").any()
    assert not values(case, "m.z velocity").any()
    (rest,) = static_states(case.case.study)
    assert rest.weight == pytest.approx(0.4 * G)
    assert rest.sag == pytest.approx(0.4 * G / 200)


def test_a_dropped_ball_returns_after_twice_its_speed_over_g(run: Run) -> None:
    study = """
bodies: {ball: {mass: 0.2 kg, above: ground, drop_height: 0.1 m, contact: {type: linear, stiffness: 1e6}}}
record: {ball: [displacement, velocity], ball on ground: force}
time: {duration: 0.5 s, sampling: 20 kHz, gravity: true}
"""
    case = run(NONE, study)
    speed = np.sqrt(2 * G * 0.1)
    assert values(case, "ball velocity")[0] == pytest.approx(-speed, rel=ROUNDING)
    assert case.response is not None
    contact = case.response.contacts["ball on ground"]
    closings = [event.t for event in case.response.events if event.what == "closes"]
    assert closings[1] - contact.first_open == pytest.approx(2 * speed / G, rel=ROUNDING)
    # samples beside the top: g dt^2 / 8 = 3e-9 m
    assert values(case, "ball displacement").max() == pytest.approx(0.1, rel=1e-7)
    weight = 0.2 * G
    assert contact.peak_force == pytest.approx(weight + np.sqrt(weight**2 + 1e6 * 0.2 * speed**2), rel=ROUNDING)


def test_bodies_that_lie_on_each_other_stay(run: Run) -> None:
    """The lower contact carries both weights, and nothing moves."""
    study = """
modes: {count: 1}
bodies:
  low: {mass: 2 kg, above: m, contact: {type: hertz, stiffness: 1e7}}
  high: {mass: 1 kg, above: low, contact: {type: linear, stiffness: 1e5}}
record: {low on m: force, high on low: force, m.z: velocity, low: velocity, high: velocity}
time: {duration: 0.2 s, sampling: 5 kHz, gravity: true}
"""
    case = run(OSCILLATOR, study)
    assert values(case, "low on m force") == pytest.approx(3 * G, rel=ROUNDING)
    assert values(case, "high on low force") == pytest.approx(G, rel=ROUNDING)
    for channel in ("m.z velocity", "low velocity", "high velocity"):
        assert np.abs(values(case, channel)).max() < ROUNDING


def test_a_lying_body_thrown_up_falls_with_its_weight(run: Run) -> None:
    study = """
modes: {count: 1}
bodies: {b: {mass: 0.1 kg, above: m, contact: {type: linear, stiffness: 1e6}}}
initial: {velocity: {m.z: 1 m/s}}
record: {b: velocity, m.z: velocity, b on m: force}
time: {duration: 0.1 s, sampling: 20 kHz, gravity: true}
"""
    case = run(OSCILLATOR, study)
    assert values(case, "m.z velocity")[0] == pytest.approx(1, rel=ROUNDING)
    force, speed = values(case, "b on m force"), values(case, "b velocity")
    assert force[0] == pytest.approx(0.1 * G, rel=ROUNDING)
    flying = (force[1:] == 0) & (force[:-1] == 0)
    assert flying.sum() > 500
    assert np.diff(speed)[flying] * 20e3 == pytest.approx(-G, rel=1e-9)  # rounding: 1e-12 here
    assert speed.max() > 1.5  # a light body struck by a heavy one leaves at nearly twice its speed
    assert ledger_residual(case) < ROUNDING


def test_the_sag_of_a_link_is_that_of_all_it_carries(run: Run) -> None:
    study = """
modes: {count: 1}
bodies:
  tray: {mass: 0.4 kg, below: m}
  load: {mass: 0.6 kg, above: tray, contact: {type: linear, stiffness: 1e5}}
links: {l: {between: [m, tray], stiffness: 200 N/m}}
record: {tray: velocity, load: velocity, load on tray: force}
time: {duration: 0.1 s, sampling: 1 kHz, gravity: true}
"""
    case = run(OSCILLATOR, study)
    assert np.abs(values(case, "tray velocity")).max() < ROUNDING
    assert np.abs(values(case, "load velocity")).max() < ROUNDING
    assert values(case, "load on tray force") == pytest.approx(0.6 * G, rel=ROUNDING)
    (rest,) = static_states(case.case.study)
    assert rest.sag == pytest.approx(1.0 * G / 200)


@pytest.mark.parametrize(
    "bodies",
    [
        "{b: {mass: 1 kg, above: m}}",
        "{b: {mass: 1 kg, below: m, contact: {type: linear, stiffness: 1e5}}}",
        "{b: {mass: 1 kg, above: m}}\ncontacts: {c: {between: [b, m], law: {type: linear, stiffness: 1e5}, gap: 1 mm}}",
        "{d: {mass: 1 kg, above: m, drop_height: 1 cm, contact: {type: linear, stiffness: 1e5}}, "
        "b: {mass: 1 kg, above: d, contact: {type: linear, stiffness: 1e5}}}",
    ],
    ids=["no contact", "below", "a gap", "on something that falls"],
)
def test_gravity_needs_a_state_of_rest(run: Run, bodies: str) -> None:
    study = f"modes: {{count: 1}}\nbodies: {bodies}\ntime: {{duration: 10 ms, sampling: 1 kHz, gravity: true}}\n"
    with pytest.raises(InputError, match=r"bodies\.b"):
        run(OSCILLATOR, study)


def test_gravity_does_not_act_along_x(run: Run) -> None:
    study = """
modes: {count: 4}
bodies: {ball: {mass: 0.1 kg, before: left, speed: 2 m/s}}
contacts: {c: {between: [ball, left], law: {type: linear, stiffness: 1e6}, gap: 1 m}}
record: {ball: velocity}
time: {duration: 50 ms, sampling: 1 kHz, gravity: true}
"""
    assert values(run(ROD, study), "ball velocity") == pytest.approx(2.0, rel=ROUNDING)


# Start velocities, and where it is loud


def test_start_velocity_of_an_oscillator(run: Run) -> None:
    study = """
modes: {count: 1}
initial: {velocity: {m.z: -3 m/s}}
record: {m.z: displacement}
time: {duration: 0.5 s, sampling: 2 kHz}
"""
    case = run(OSCILLATOR, study)
    # 1e-12: rounding of the propagator
    assert values(case, "m.z displacement") == pytest.approx(-3 / 20 * np.sin(20 * time(case)), abs=1e-12)


def test_a_turning_ceiling_presses_where_it_goes_down(run: Run) -> None:
    """A right-handed turn about y moves the east side of a plate down and displaces no volume."""
    study = f"""
modes: {{up_to: 3 kHz}}
initial: {{rigid: {{about: c, spin: [0, 0.1 rad/s, 0]}}}}
record: {{east.z: velocity, c.z: velocity}}
time: {{duration: 20 ms, sampling: 20 kHz}}
{ROOM}"""
    case = run(FREE, study)
    assert values(case, "east.z velocity") == pytest.approx(-0.1 * 0.2, rel=ROUNDING)
    assert np.abs(values(case, "c.z velocity")).max() < ROUNDING
    early = slice(0, 17)  # a quarter period of the air's swing from east to west, 1.2 m / 343 m/s
    assert values(case, "box.east pressure")[early].mean() > 1
    # Pa, rounding: 2e-10 here
    assert values(case, "box.east pressure") == pytest.approx(-values(case, "box.west pressure"), abs=1e-7)


def test_every_contact_closes_before_it_opens(run: Run) -> None:
    """A contact that touches without speed is armed by another's blow; both are logged once."""
    study = """
modes: {count: 1}
bodies:
  ball: {mass: 0.1 kg, above: m, speed: 2 m/s, contact: {type: hertz, stiffness: 1e8}}
  damper: {mass: 0.3 kg, below: m, contact: {type: hertz, stiffness: 1e8}}
time: {duration: 5 ms, sampling: 100 kHz}
peaks: {first_impact: until next contact}
record: {m.z: velocity}
"""
    case = run(OSCILLATOR, study)
    assert case.response is not None
    assert case.response.bodies["damper"].velocity[-1] < 0
    for name, contact in case.response.contacts.items():
        words = [event.what for event in case.response.events if event.contact == name]
        assert words == ["closes", "opens"] * contact.closings, name
    assert case.channels["m.z velocity"].first_impact > 0


def test_the_ledger_of_a_slow_push_closes(run: Run) -> None:
    """The push lasts fifty periods of the first mode: its work must be integrated through all of them."""
    study = """
modes: {up_to: 3 kHz}
loads: {push: {at: c.z, half_sine: {amplitude: -100 N, frequency: 5 Hz}}}
record: {ground: force}
time: {duration: 0.1 s, sampling: 4 kHz}
"""
    assert ledger_residual(run(HELD, study)) < 1e-10  # rounding: 1e-13 here


def test_sound_comes_from_where_the_ceiling_moves(run: Run) -> None:
    """A plate over one corner of a larger room is heard below itself first; `at` is its centre in the ceiling."""
    room = ROOM.replace("size: [0.6, 0.4, 0.3]", "size: [1.6, 1.4, 0.3]\n    at: [0.4, 0.3]")
    room = room.replace(
        "west: [0.05, 0.2, 0.25], east: [0.55, 0.2, 0.25]", "below: [0.4, 0.3, 0.2], far: [1.4, 1.2, 0.2]"
    )
    study = f"""
modes: {{up_to: 3 kHz}}
initial: {{rigid: {{about: c, velocity: [0, 0, -0.1]}}}}
record: {{c.z: velocity}}
time: {{duration: 20 ms, sampling: 20 kHz}}
{room}"""
    case = run(FREE, study)
    below, far = (np.abs(values(case, f"box.{name} pressure")) for name in ("below", "far"))
    # to the far one it is .9 m from the plate's nearest corner, 2.7 ms: 54 samples
    assert far[:45].max() < 1e-2 * below[:45].max()


def test_the_first_impact_begins_when_something_closes(run: Run) -> None:
    """A ball 5 mm away at 2 m/s arrives after 2.5 ms: a window of 2 ms ends at 4.5 ms."""
    study = """
modes: {count: 1}
bodies: {ball: {mass: 0.1 kg, above: m, speed: 2 m/s}}
contacts: {hit: {between: [ball, m], law: {type: hertz, stiffness: 1e8}, gap: 5 mm}}
time: {duration: 20 ms, sampling: 100 kHz}
peaks: {first_impact: 2 ms}
record: {m.z: displacement}
"""
    case = run(OSCILLATOR, study)
    assert case.response is not None
    channel, t = case.channels["m.z displacement"], case.response.t
    size = np.abs(channel.values)
    # rounding of times
    assert channel.first_impact == size[t <= 4.5e-3 + 1e-6].max() > size[t <= 4.4e-3].max() > 0


def test_a_clamp_that_rattles_ends_no_impact(run: Run) -> None:
    """The ball closes its contact once; the preloaded shoe between two blows of it opens and closes at its own pace."""
    study = """
modes: {count: 1}
bodies:
  ball: {mass: 0.1 kg, above: m, speed: 2 m/s, contact: {type: hertz, stiffness: 1e8}}
  shoe: {mass: 0.3 kg, below: m}
contacts: {clamp: {between: [m, shoe], law: {type: linear, stiffness: 1e6}, preload: 5 N}}
links: {bolt: {between: [shoe, ground], stiffness: 1e4}}
time: {duration: 50 ms, sampling: 100 kHz}
peaks: {first_impact: until next contact}
record: {m.z: displacement}
"""
    case = run(OSCILLATOR, study)
    assert case.response is not None
    rattles = [event for event in case.response.events if event.contact == "clamp" and event.what == "closes"]
    assert len(rattles) > 2
    channel = case.channels["m.z displacement"]
    assert channel.first_impact == np.abs(channel.values).max()  # the ball does not come back: one impact, to the end


HUNG = """
parts:
  block: {type: block, mass: 100 kg, origin: [0, 0, 0], size: [1, 1, 1]}
  feet: {type: spring, between: [under, ground], stiffness: {x: 1e6, y: 1e6, z: 1e6, rx: 1e6, ry: 1e6, rz: 1e6}}
points: {under: {on: block, at: [0.5, 0.5, 0]}, top: {on: block, at: [0.5, 0.5, 1]}}
damping: {ratio: 10 %}
"""


def test_a_force_of_a_spring_has_its_share_of_the_damping_and_says_so(run: Run, tmp_path: Path) -> None:
    """k u (1 + 2 zeta j omega / omega_0) on one mode, by hand; in the title of peaks and in the results file."""
    study = """
modes: {up_to: 100 Hz}
loads: {push: {at: top.z, half_sine: {amplitude: -100 N, frequency: 5 Hz}}}
vibration: {shake: {at: top.z, harmonic: [[5 Hz, 1 N], [30 Hz, 1 N]]}}
record: {top.z: displacement, feet: force}
time: {duration: 0.1 s, sampling: 5 kHz}
"""
    case = run(HUNG, study)
    answers = case.vibration["shake"].answers
    displacement, force = answers["top.z displacement"], answers["feet force"]
    frequency, own = displacement.frequency_hz, np.sqrt(1e6 / 100.0) / (2 * np.pi)
    share = np.abs(1.0 + 0.2j * frequency / own)
    found = np.abs(force.values) / np.abs(displacement.values)  # type: ignore[union-attr]
    assert found == pytest.approx(1e6 * share, rel=1e-9)  # rounding
    assert share.max() > 1.05
    result = run_study(read_study(tmp_path / "study.yaml"))
    titles = [grid.title for grid in main_tables(result) if grid.title.startswith("peaks")]
    assert "; force of a part or support with its share of the damping of the modes" in titles[0]
    write_results(tmp_path / "results.h5", result)
    with h5py.File(tmp_path / "results.h5") as file:
        (one,) = file["cases"].values()
        told = {name: one["channels"][name].attrs["long_name"] for name in ("feet force", "top.z displacement")}
    assert told["feet force"] == "feet force, recorded, with its share of the damping of the modes"
    assert "damping" not in told["top.z displacement"]


CANTILEVER = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
sections: {flat: {shape: rectangle, width: 20 mm, height: 10 mm}}
parts:
  bar: {type: frame, material: steel, section: flat, lines: [[[0, 0, 0], [1, 0, 0]]], mesh: 25 mm}
  LUMP
points: {foot: {on: bar, at: [0, 0, 0]}, tip: {on: bar, at: [1, 0, 0]}}
supports: {wall: {at: foot, fix: clamped}}
damping: {ratio: 1 %}
"""
STARTED = """
modes: {up_to: END}
initial: {velocity: {tip.z: 1 m/s}}
record: {tip.z: displacement}
time: {duration: 0.5 s, sampling: 20 kHz}
"""


@pytest.mark.parametrize("lump", ["", "lump: {type: mass, mass: 50 g, at: tip}"])
def test_a_start_velocity_of_an_elastic_point_is_refused(run: Run, lump: str) -> None:
    """What moves with it, 0.4 kg of one mode, falls with the number of modes, and the displacement with it."""
    with pytest.raises(InputError) as refused:
        run(CANTILEVER.replace("LUMP", lump), STARTED.replace("END", "1 kHz"))
    assert "tip.z" in str(refused.value) and "kg move with it" in str(refused.value)
    with pytest.raises(InputError):
        run(ROD, STARTED.replace("tip.z", "left.x").replace("modes: {up_to: END}", ""))


def test_a_start_velocity_of_a_heavy_mass_on_a_bar_does_not_depend_on_the_modes(run: Run) -> None:
    """20 kg on a bar of 1.57 kg: the displacement is v / w of the mass on the bar's stiffness, 3 E I / l^3."""
    found = []
    for end in ("1 kHz", "4 kHz"):
        case = run(CANTILEVER.replace("LUMP", "lump: {type: mass, mass: 20 kg, at: tip}"), STARTED.replace("END", end))
        found.append(case.channels["tip.z displacement"].whole)
    assert found[1] == pytest.approx(found[0], rel=2e-3)  # 33/140 of the bar moves with it in the first mode alone
    stiffness = 3.0 * 210e9 * 0.02 * 0.01**3 / 12.0
    by_hand = np.sqrt(20.0 / stiffness) * np.exp(-0.01 * np.pi / 2.0)
    assert found[0] == pytest.approx(by_hand, rel=2e-2)  # the bar's 0.37 kg: half of 1.9 %


def test_a_body_that_lies_on_a_dropped_one_is_answered_with_that(run: Run) -> None:
    """It was told to have a contact without a gap, which it has."""
    with pytest.raises(InputError) as refused:
        run(
            "structure: none\n",
            "bodies: {x: {mass: 1 kg, above: ground, drop_height: 1 m}, y: {mass: 2 kg, above: x}}\n"
            "contacts:\n  cx: {between: [x, ground], law: {type: linear, stiffness: 1 MN/m}}\n"
            "  cy: {between: [y, x], law: {type: linear, stiffness: 1 MN/m}}\n"
            "record: {x: velocity}\ntime: {duration: 1 s, sampling: 1 kHz, gravity: true}\n",
        )
    assert "at rest on 'x', which falls at first" in str(refused.value)


def test_travel_over_the_ground_is_the_displacement(run: Run) -> None:
    case = run(
        "structure: none\n",
        "bodies: {ball: {mass: 100 g, above: ground, speed: 2 m/s}}\n"
        "contacts: {hit: {between: [ball, ground], law: {type: linear, stiffness: 1 MN/m}}}\n"
        "record: {ball: [travel, displacement], hit: force}\ntime: {duration: 10 ms, sampling: 200 kHz}\n",
    )
    assert (values(case, "ball travel") == values(case, "ball displacement")).all()
    assert values(case, "ball travel").min() == pytest.approx(-2.0 * np.sqrt(0.1 / 1e6), rel=1e-4)  # v sqrt(m / k)


@pytest.mark.parametrize("limit", ["0.5 g", "4.903325 m/s^2"])
def test_a_limit_of_an_acceleration_takes_g(run: Run, limit: str) -> None:
    study = f"""
modes: {{count: 1}}
initial: {{velocity: {{m.z: -3 m/s}}}}
record: {{m.z: acceleration}}
time: {{duration: 0.5 s, sampling: 2 kHz}}
limits: {{m.z acceleration: {limit}}}
"""
    # 0.5 x 9.80665, a product of two numbers: rounding
    assert run(OSCILLATOR, study).case.study.limits[0].value == pytest.approx(4.903325, rel=1e-12)
