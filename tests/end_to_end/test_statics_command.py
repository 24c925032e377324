"""Statics from the command line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from femstruct.files.results_file import read_results
from tests.data.command_line import Ended, femstruct


def statics(*words: str) -> Ended:
    return femstruct("statics", *words)


MODEL = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850 kg/m^3}}
sections: {bar: {shape: rectangle, width: 20 mm, height: 40 mm}}
parts: {bar: {type: frame, material: steel, section: bar, lines: [[[0, 0, 0], [1, 0, 0]]], mesh: 0.1}}
points: {foot: {on: bar, at: [0, 0, 0]}, tip: {on: bar, at: [1, 0, 0]}}
supports: {wall: {at: foot, fix: clamped}}
"""


def test_the_command_says_displacement_force_and_stress(tmp_path: Path) -> None:
    (tmp_path / "m.yaml").write_text(MODEL, encoding="utf-8")
    done = statics(str(tmp_path / "m.yaml"), "--force", "tip.z=-100 N", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    table = json.loads(done.stdout)
    bends = 0.02 * 0.04**3 / 12
    assert table["stresses"]["bar"]["largest_pa"] == pytest.approx(100.0 * 0.02 / bends, rel=1e-6)  # solved system
    assert table["forces_n"]["wall"][2] == pytest.approx(-100.0, rel=1e-9)  # solved system
    assert "18.75" in statics(str(tmp_path / "m.yaml"), "--force", "tip.z=-100 N").stdout  # MPa


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ((), "--force and --weight: got nothing that acts"),
        (("--force", "tip.z"), "--force: got 'tip.z', expected POINT.direction=FORCE"),
        (("--force", "tip.q=1 N"), "--force: got direction 'q', expected x, y, z or n"),
        (("--force", "tup.z=1 N"), "--force: got 'tup', expected one of foot, tip"),
        (("--force", "tip.z=1 m"), "--force"),
    ],
)
def test_mistakes_on_the_command_line(words: tuple[str, ...], told: str, tmp_path: Path) -> None:
    (tmp_path / "m.yaml").write_text(MODEL, encoding="utf-8")
    done = statics(str(tmp_path / "m.yaml"), *words)
    assert (done.returncode, done.stdout) == (2, "")
    assert told in done.stderr


def test_a_link_puts_no_force_on_the_ground(tmp_path: Path) -> None:
    """What follows a link pulls at what leads it; only the wall stands on the ground."""
    tip = "tip: {on: bar, at: [1, 0, 0]}"
    text = MODEL.replace(tip, f"{tip}, elbow: {{on: arm, at: [1, 0, 0]}}")
    arm = "arm: {type: frame, material: steel, section: bar, lines: [[[1, 0, 0], [1, 1, 0]]], mesh: 0.5}}"
    text = text.replace("mesh: 0.1}}", "mesh: 0.1}, " + arm) + "constraints: {spider: {rigid: tip, to: elbow}}\n"
    (tmp_path / "m.yaml").write_text(text, encoding="utf-8")
    told = statics(str(tmp_path / "m.yaml"), "--weight")
    table = json.loads(statics(str(tmp_path / "m.yaml"), "--weight", "--json").stdout)
    assert table["on_the_ground"] == ["wall", "ground"] and "spider" in table["forces_n"]
    head, _, rest = told.stdout.partition("forces between parts")
    ground = [line.split() for line in head.splitlines() if line.startswith(("wall", "ground"))]
    assert ground[1] == ["ground", "(sum", "of", "all)", *ground[0][1:]]
    assert "forces on the ground: what stands at several places as one sum" in head
    assert "spider" in rest and "spider" not in head and "wall" in head.partition("forces on the ground")[2], told


ENDS = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850 kg/m^3}}
sections: {bar: {shape: rectangle, width: 20 mm, height: 40 mm}}
parts:
  inner: {type: frame, material: steel, section: bar, lines: [[[0, 0, 0], [1, 0, 0]]], mesh: 0.1}
  outer: {type: frame, material: steel, section: bar, lines: [[[1, 0, 0], [2, 0, 0]]], mesh: 0.1}
points:
  foot: {on: inner, at: [0, 0, 0]}
  seats: {on: inner, at: [[0.9, 0, 0], [1, 0, 0]]}
  seat: {on: inner, at: [1, 0, 0]}
  heel: {on: outer, at: [1, 0, 0]}
  tip: {on: outer, at: [2, 0, 0]}
supports: {wall: {at: foot, fix: clamped}, rest: {at: tip, fix: [rx]}}
"""


@pytest.mark.parametrize(
    ("tie", "on_outer"),
    [
        ("joints: {tie: {connect: [inner, outer]}}", True),  # on the second part
        ("joints: {tie: {connect: [outer, inner]}}", False),
        ("constraints: {tie: {rigid: seat, to: heel}}", True),  # on its 'to'
        ("constraints: {tie: {rigid: heel, to: seat}}", False),
        ("constraints: {tie: {average: heel, of: seats, directions: [x, y, z, ry, rz]}}", False),  # on its 'of'
    ],
)
def test_forces_between_parts_are_on_what_the_table_says(tie: str, on_outer: bool, tmp_path: Path) -> None:
    """By hand: the outer bar is pushed down by 100 N, so the inner one pushes it up and is itself pushed down."""
    (tmp_path / "m.yaml").write_text(ENDS + tie, encoding="utf-8")
    done = statics(str(tmp_path / "m.yaml"), "--force", "tip.z=-100 N", "--json")
    assert done.returncode == 0, done.stderr
    (_, _, force) = json.loads(done.stdout)["forces_n"]["tie"]
    assert force == pytest.approx(100.0 if on_outer else -100.0, rel=1e-6)  # solved system
    told = " ".join(statics(str(tmp_path / "m.yaml"), "--force", "tip.z=-100 N").stdout.split())
    for one in ("on the second part of a joint", "of a rigid link on its 'to'", "of an average on its 'of'"):
        assert one in told


HELD = """
parts: {fan: {type: matrices, file: fan.npz}}
points: {hub: {on: fan, at: [0, 0, 0]}}
"""


def test_what_matrices_hold_inside_is_told(tmp_path: Path) -> None:
    """99 kg on springs whose other ends are in no matrix: their force on the ground is the weight."""
    place = {"nodes": [0, 0, 0], "components": [0, 1, 2], "points": [[0.0, 0.0, 0.0]]}
    np.savez(tmp_path / "fan.npz", M=99.0 * np.eye(3), K=np.diag([1e5, 2e5, 3e5]), **place)
    (tmp_path / "m.yaml").write_text(HELD, encoding="utf-8")
    told = statics(str(tmp_path / "m.yaml"), "--weight").stdout
    assert "held inside the matrices of fan, which reaches no support: (0, 0, -970.9) N" in told
    table = json.loads(statics(str(tmp_path / "m.yaml"), "--weight", "--json").stdout)
    assert table["held_inside"] == {"parts": ["fan"], "force_n": [0.0, 0.0, pytest.approx(-970.85835)]}  # 99 kg g
    two = {"nodes": [0, 0, 0, 1, 1, 1], "components": [0, 1, 2] * 2, "points": [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]}
    K = np.kron([[1e5, -1e5], [-1e5, 1e5]], np.eye(3))
    np.savez(tmp_path / "fan.npz", M=99.0 * np.eye(6), K=K, **two)
    text = HELD + "supports: {bolts: {at: hub, fix: [x, y, z]}}\n"
    (tmp_path / "m.yaml").write_text(text, encoding="utf-8")
    assert "held inside" not in statics(str(tmp_path / "m.yaml"), "--weight").stdout


BEAM = """
materials: {s: {E: 210 GPa, nu: 0.3, rho: 7850}}
sections: {b: {shape: rectangle, width: 30 mm, height: 50 mm}}
parts: {f: {type: frame, material: s, section: b, mesh: 1, element: euler, lines: [[[0, 0, 0], [2, 0, 0]]]}}
points: {a: {on: f, at: [0, 0, 0]}, b: {on: f, at: [2, 0, 0]}, c: {on: f, at: [1, 0, 0]}}
supports: {left: {at: a, fix: [x, y, z, rx]}, right: {at: b, fix: [y, z]}}
damping: {ratio: 1 %}
"""
TAKEN = "parts: {f: {type: matrices, file: FILE}}\npoints: {c: {on: f, at: [1, 0, 0]}}\ndamping: {ratio: 1 %}\n"
SHAKEN = """
model: MODEL
modes: {count: 2}
record: {c.z: displacement}
vibration: {h: {base: z, harmonic: [[0.5 Hz, 1 m/s^2], [2 Hz, 1 m/s^2]]}}
"""


@pytest.mark.parametrize("to", ["npz", "mtx"])
def test_matrices_with_their_supports_weigh_what_the_structure_weighs(to: str, tmp_path: Path) -> None:
    """Two elements: half of the mass is coupled to the held ends. 5 q L^4 / 384 E I, and the same on a shaken base."""
    (tmp_path / "beam.yaml").write_text(BEAM, encoding="utf-8")
    assert femstruct("export", tmp_path / "beam.yaml", "--to", to, "-o", tmp_path).returncode == 0
    file = "beam.npz" if to == "npz" else "beam.json"
    (tmp_path / "taken.yaml").write_text(TAKEN.replace("FILE", file), encoding="utf-8")
    table = json.loads(femstruct("statics", tmp_path / "taken.yaml", "--weight", "--json").stdout)
    exact = 5 * 7850 * 9.80665 * 0.03 * 0.05 * 2.0**4 / (384 * 210e9 * 0.03 * 0.05**3 / 12)
    assert -table["points"]["c"][2] == pytest.approx(exact, rel=1e-9)  # of a solve: an Euler beam is exact at its nodes
    found = []
    for name in ("beam", "taken"):
        (tmp_path / f"{name}.study.yaml").write_text(SHAKEN.replace("MODEL", f"{name}.yaml"), encoding="utf-8")
        done = femstruct("run", tmp_path / f"{name}.study.yaml", "-o", tmp_path / name, "--no-pictures")
        assert done.returncode in (0, 3), done.stdout
        (case,) = read_results(tmp_path / name / "results.h5").cases.values()
        found.append([one.largest for one in case.vibration["h"].answers.values()])
    assert found[1] == pytest.approx(found[0], rel=1e-9)  # the same basis


def test_the_weight_of_matrices_that_lack_what_supports_carry_is_refused(tmp_path: Path) -> None:
    """Consistent masses of another program without the held node; lumped ones say all."""
    place = {"nodes": [1, 2], "components": [2, 2], "points": [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]}
    K = np.array([[2.0, -1.0], [-1.0, 1.0]]) * 1e5
    (tmp_path / "m.yaml").write_text(TAKEN.replace("FILE", "bar.npz"), encoding="utf-8")
    (tmp_path / "m.study.yaml").write_text(SHAKEN.replace("MODEL", "m.yaml"), encoding="utf-8")
    np.savez(tmp_path / "bar.npz", M=np.array([[4.0, 1.0], [1.0, 2.0]]), K=K, **place)
    for words in (("statics", tmp_path / "m.yaml", "--weight"), ("run", tmp_path / "m.study.yaml", "--no-pictures")):
        done = femstruct(*words)
        assert done.returncode == 2
        told = " ".join((done.stdout + done.stderr).split())
        assert "parts.f: got" in told and "of matrices that hold some of their nodes along z" in told
        assert "write the supports in the model" in told
    assert femstruct("statics", tmp_path / "m.yaml", "--force", "c.z=1 N").returncode == 0
    np.savez(tmp_path / "bar.npz", M=np.diag([6.0, 3.0]), K=K, **place)
    table = json.loads(femstruct("statics", tmp_path / "m.yaml", "--weight", "--json").stdout)
    assert -table["points"]["c"][2] == pytest.approx(9.0 * 9.80665 / 1e5, rel=1e-9)  # of a solve
