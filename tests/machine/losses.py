"""Walls at edges, losses by frequency, and dashpots that couple modes: in closed form, and said in other words."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
from scipy.linalg import expm

from tests.machine.bars import a_frame
from tests.machine.blocks import a_block
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.skeletons import read

Draft = dict[str, Any]


def _plate(rng: np.random.Generator) -> Draft:
    """Of concrete or the like, held along its rim, thin; and the material of walls."""
    a, b = (float(f"{one:.3g}") for one in rng.uniform([3, 2], [5, 3]))
    thin = float(f"{b / rng.uniform(60, 90):.3g}")
    heavy = {"E": float(f"{rng.uniform(2, 4) * 1e10:.4g}"), "nu": float(f"{rng.uniform(0.15, 0.3):.3g}"), "rho": 2400.0}
    wall = {"E": float(f"{rng.uniform(3, 8) * 1e9:.4g}"), "nu": 0.2, "rho": 1400.0, "loss_factor": 0.02}
    part = {"type": "plate", "material": "m", "origin": [0, 0, 0], "size": [a, b], "thickness": thin, "mesh": b / 20}
    return {
        "materials": {"m": heavy, "w": wall},
        "parts": {"p": part},
        "points": {"q": {"on": "p", "at": [0.31 * a, 0.27 * b]}, "r": {"on": "p", "at": [0.62 * a, 0.55 * b]}},
        "supports": {name: {"on": "p", "edge": name, "fix": "simple"} for name in ("x0", "x1", "y0", "y1")},
        "damping": {"from": "materials"},
    }


def _bends(made: Draft, h: float) -> tuple[float, float]:
    """Bending stiffness and mass per area."""
    return made["E"] * h**3 / 12 / (1 - made["nu"] ** 2), made["rho"] * h


def _wall(model: Model, omega: complex) -> complex:
    """What the walls of an edge resist per length and radian: B k (1 + j), losses of their material within B."""
    held, made = model["supports"]["y0"], model["materials"]["w"]
    B, mass = _bends(made, held["wall"]["thickness"])
    B = B * (1 + 1j * made["loss_factor"])
    return complex(held["walls"] * (1 + 1j) * B * (mass * omega**2 / B) ** 0.25)


def _own(model: Model) -> list[complex]:
    """Complex frequencies [rad/s] of a plate with pinned sides and walls along two: sines along, and across what is
    even or odd about the middle line; followed from the pinned plate as the walls grow."""
    a, b = model["parts"]["p"]["size"]
    D, mass = _bends(model["materials"]["m"], model["parts"]["p"]["thickness"])

    def miss(omega: complex, along: int, even: bool, share: float) -> complex:
        square, n = omega * np.sqrt(mass / D), (along * pi / a) ** 2
        flat, steep = np.sqrt(square - n + 0j), np.sqrt(square + n + 0j)
        wave, held = flat * b / 2, share * _wall(model, omega)
        if even:
            return complex(
                2 * D * square * np.cos(wave)
                + held * (flat * np.sin(wave) + steep * np.tanh(steep * b / 2) * np.cos(wave))
            )
        return complex(
            2 * D * square * np.sin(wave) + held * (steep / np.tanh(steep * b / 2) * np.sin(wave) - flat * np.cos(wave))
        )

    found = []
    for along in range(1, 8):  # of a plate three times as long as wide the fourth mode has four half waves
        for across in (1, 2, 3):
            start = np.sqrt(D / mass) * ((along * pi / a) ** 2 + (across * pi / b) ** 2)
            omega = start * (1 + 1e-4 + 1e-4j)
            for share in np.geomspace(1e-4, 1.0, 60):
                for _ in range(30):
                    value, step = miss(omega, along, across % 2 == 1, share), omega * 1e-7
                    slope = (miss(omega + step, along, across % 2 == 1, share) - value) / step
                    change = value / slope
                    omega -= change
                    if abs(change) < 1e-12 * abs(omega):
                        break
            found.append(complex(omega))
    return sorted(found, key=lambda one: one.real)[:4]


@capability("losses: walls at the edges of a plate", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Natural frequencies and damping of modes that walls take away, each at its own complex frequency."""
    draft = _plate(rng)
    h = draft["parts"]["p"]["thickness"]
    wall = {"material": "w", "thickness": float(f"{h * rng.uniform(1.2, 2.5):.3g}")}
    for name in ("y0", "y1"):
        draft["supports"][name] |= {"walls": int(rng.integers(1, 3)), "wall": wall}
    draft["supports"]["y1"]["walls"] = draft["supports"]["y0"]["walls"]

    def asked(model: Model, door: Door) -> Floats:
        found = door.ask(model, "modes", "--count", "4")
        door.told = []
        return np.r_[found["frequency_hz"], found["damping_ratio"]]

    def right(model: Model, _: Door) -> Floats:
        own = np.array(_own(model))
        return np.r_[own.real / 2 / pi, own.imag / own.real]

    return Case(draft, asked, right, 1e-2, "cells of b / 20: (3 pi / 20)^2 / 12 of what bends most", each=True)


@capability("losses: walls at one frequency are lossy springs", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Directly, at single frequencies; and along frequency by modes, which keep what a decibel is of."""
    draft = _plate(rng)
    draft["materials"]["m"]["loss_factor"] = 0.05
    wall = {"material": "w", "thickness": float(f"{draft['parts']['p']['thickness'] * 1.5:.3g}")}
    draft["supports"]["y0"] |= {"walls": 2, "wall": wall}
    draft["parts"]["p"]["mesh"] *= 2
    lines = [round(one, 1) for one in rng.uniform(20, 80, 2)]

    def answers(model: Model, door: Door, line: float) -> Floats:
        words = ("--drive", "q.z", "--response", "r.z", "--band", f"{line} Hz:{line + 0.1} Hz", "--step", "0.1 Hz")
        found = door.ask(model, "frf", *words, "--method", "direct")
        door.told = []
        return np.array([found["real"][0], found["imag"][0]])

    def asked(model: Model, door: Door) -> Floats:
        return np.concatenate([answers(model, door, line) for line in lines])

    def right(model: Model, door: Door) -> Floats:
        out = []
        for line in lines:
            stiff = _wall(model, 2 * pi * line)
            springs = {"stiffness": {"about edge": stiff.real}, "loss_factor": stiff.imag / stiff.real}
            edge = {"on": "p", "edge": "y0", "fix": "simple", **springs}
            out.append(answers({**model, "supports": {**model["supports"], "y0": edge}}, door, line))
        return np.concatenate(out)

    return Case(draft, asked, right, 1e-6, "the same matrices at that frequency; rounding")


@capability("losses: of reverberation times, and of a laboratory", "relation", slow=True)
def _(rng: np.random.Generator) -> Case:
    """2.2 / (f T), and internal losses and m' / (485 sqrt f), beside tables of them."""
    draft = _plate(rng)
    del draft["materials"]["w"]
    draft["parts"]["p"]["mesh"] *= 2
    bands = [40.0, 63.0, 100.0, 160.0]
    times = [float(f"{2.2 / one / rng.uniform(0.03, 0.1):.4g}") for one in bands]
    internal = float(f"{rng.uniform(0.004, 0.03):.3g}")
    draft["losses"] = {"times": times, "internal": internal}

    def answer(model: Model, door: Door, loss: Any) -> Floats:
        inner: Draft = {key: one for key, one in model.items() if key != "losses"}
        inner["materials"] = {"m": {**model["materials"]["m"], "loss_factor": loss}}
        words = ("--drive", "q.z", "--response", "r.z", "--band", "45 Hz:145 Hz", "--step", "5 Hz")
        found = door.ask(inner, "frf", *words, "--method", "direct")
        door.told = []
        both = np.r_[found["real"], found["imag"]]
        return np.asarray(both / np.abs(both).max())

    def asked(model: Model, door: Door) -> Floats:
        losses = model["losses"]
        measured = {f"{f:g} Hz": f"{t} s" for f, t in zip(bands, losses["times"], strict=True)}
        words = [
            {"reverberation_times": measured},
            {"like": "ISO 12354-1 laboratory", "internal": losses["internal"]},
            "ISO 12354-1 laboratory",
        ]
        return np.concatenate([answer(model, door, one) for one in words])

    def right(model: Model, door: Door) -> Floats:
        losses, mass = model["losses"], model["materials"]["m"]["rho"] * model["parts"]["p"]["thickness"]
        measured = {f"{f:g} Hz": 2.2 / (f * t) for f, t in zip(bands, losses["times"], strict=True)}
        fine = np.geomspace(50, 500, 300)
        total = [
            {f"{f:.6g} Hz": float(own + mass / 485 / np.sqrt(f)) for f in fine} for own in (losses["internal"], 0.01)
        ]
        return np.concatenate([answer(model, door, one) for one in (measured, *total)])

    return Case(draft, asked, right, 1e-3, "twelve points an octave of 1 / sqrt f, straight over log f: 4e-4")


@capability("losses: a bar whose losses follow frequency", "independent")
def _(rng: np.random.Generator) -> Case:
    """Straight over log f between values, that of the nearest beyond them."""
    draft = a_frame(rng)
    first = float(read(draft)[0].modes(1)[0][0])
    at = [float(f"{first * one:.4g}") for one in (0.8, 1.1, 1.6)]
    values = [float(f"{one:.3g}") for one in rng.uniform(0.03, 0.15, 3)]
    for one in draft["materials"].values():
        one["loss_factor"] = {f"{f} Hz": v for f, v in zip(at, values, strict=True)}
    draft["damping"] = {"from": "materials"}
    lines = float(f"{first / 20:.3g}") * np.arange(12, 40)
    axis = str(rng.choice(["x", "y", "z"]))

    def asked(model: Model, door: Door) -> Floats:
        words = ("--drive", f"tip.{axis}", "--response", "corner.z", "--band", f"{lines[0]} Hz:{lines[-1]} Hz")
        found = door.ask(
            model, "frf", *words, "--step", f"{lines[1] - lines[0]}", "--kind", "receptance", "--method", "direct"
        )
        return np.r_[found["real"], found["imag"]]

    def right(model: Model, _: Door) -> Floats:
        plain = {name: {**one, "loss_factor": 0.0} for name, one in model["materials"].items()}
        bones, where = read({**model, "materials": plain})
        push = bones.load({(where["tip"], "xyz".index(axis)): 1.0})
        loss = np.interp(np.log(lines), np.log(at), values)
        rows = [bones.shaken(np.array([f]), push, 0.0, one)[0] for f, one in zip(lines, loss, strict=True)]
        H = np.array(rows)[:, 6 * where["corner"] + 2]
        return np.r_[H.real, H.imag]

    return Case(draft, asked, right, 1e-3, "modes of the mesh within 1e-5, over their losses")


@capability("losses: a struck block whose dashpots couple its modes", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Six motions and a ball, linear while they touch: by the exponential of their matrix, step by step."""
    structure = a_block(rng)
    mass, size = structure["parts"]["m"]["mass"], np.array(structure["parts"]["m"]["size"])
    for one in "abc":
        structure["parts"][f"k{one}"]["damping"] = {axis: float(mass * rng.uniform(2, 12)) for axis in "xyz"}
    structure["points"]["top"] = {"on": "m", "at": (size * [0.7, 0.4, 1.0]).tolist()}
    structure["damping"] = {"ratio": 0.0}
    ball = float(f"{mass * rng.uniform(0.02, 0.08):.4g}")
    stiff = float(f"{ball * (2 * pi * rng.uniform(40, 80)) ** 2:.4g}")
    contact = {"type": "linear", "stiffness": stiff}
    study = {
        "bodies": {"ball": {"mass": ball, "above": "top", "speed": 1.0, "contact": contact}},
        "record": {"top.z": "displacement", "d.x": "displacement"},
        "time": {"duration": 0.5, "sampling": 10000.0},
        "modes": {"up_to": 1000.0},
    }  # fmt: skip

    def asked(model: Model, door: Door) -> Floats:
        found = door.histories({"model": "s.yaml", **model["study"]}, s=model["structure"])
        steps = np.arange(0, 0.5, 0.005)
        t = found["t"]
        return np.concatenate([np.interp(steps, t, found[name]) for name in ("top.z displacement", "d.x displacement")])

    def right(model: Model, _: Door) -> Floats:
        bones, where = read(model["structure"])
        T = bones.free()
        K, M, C = (T.T @ bones.matrix(kind) @ T for kind in "KMC")
        n = len(K)
        across = np.r_[T[6 * where["top"] + 2], -1.0]  # how far apart they are, against the push
        masses = np.zeros((n + 1, n + 1))
        masses[:n, :n], masses[n, n] = M, ball
        stiffness, rates = np.zeros((2, n + 1, n + 1))
        stiffness[:n, :n], rates[:n, :n] = K, C
        step = 1e-4

        def march(k: float) -> Floats:
            held = stiffness + k * np.outer(across, across)
            back = np.linalg.solve(masses, np.hstack([-held, -rates]))
            return np.asarray(expm(step * np.vstack([np.hstack([np.zeros((n + 1, n + 1)), np.eye(n + 1)]), back])))

        touching, apart = march(stiff), march(0.0)
        state = np.zeros(2 * n + 2)
        state[-1] = -1.0
        path = [state]
        for _ in range(5000):
            deep = across @ path[-1][: n + 1]
            path.append((touching if deep > 0 or len(path) == 1 else apart) @ path[-1])
        moved = np.array(path)[::50, :n]
        moved = moved[:100]
        return np.concatenate([moved @ T[6 * where["top"] + 2], moved @ T[6 * where["d"]]])

    draft = {"structure": structure, "study": study}
    return Case(draft, asked, right, 5e-3, "they part within a step of 1/100 of the contact or less")
