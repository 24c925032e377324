"""Answers to steady excitation of frames and blocks: damping laws, dashpots, stresses, shaken bases, complex modes."""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from typing import Any

import numpy as np

from tests.independent.frames import Floats, Skeleton
from tests.independent.vibration import log_log
from tests.machine.bars import a_frame, a_section
from tests.machine.blocks import a_block
from tests.machine.framework import Case, Door, Model, capability
from tests.machine.skeletons import SIX, read

Draft = dict[str, Any]
_WAVES = "residual vectors keep 1e-3 of the largest; modes of the mesh are within 1e-5, over their damping"
_FOLD = {"receptance": 0, "mobility": 1, "accelerance": 2}


def _damped(rng: np.random.Generator, draft: Draft, law: str) -> Draft:
    """3 to 8 % at the first mode, by a law."""
    first = 2 * pi * read(draft)[0].modes(1)[0][0]
    size = float(rng.uniform(0.03, 0.08))
    if law == "materials":
        for one in draft["materials"].values():
            one["loss_factor"] = 2 * size
    draft["damping"] = {
        "ratio": {"ratio": size},
        "loss_factor": {"loss_factor": 2 * size},
        "rayleigh": {"rayleigh": {"alpha": size * first, "beta": size / first}},
        "materials": {"from": "materials"},
    }[law]
    return draft


def shaken(model: Model, bones: Skeleton, frequency: Floats, F: Floats) -> Floats:
    law = model["damping"]
    rayleigh = law.get("rayleigh", {})
    return bones.shaken(
        frequency,
        F,
        law.get("ratio", 0.0),
        law.get("loss_factor", 0.0),
        rayleigh.get("alpha", 0.0),
        rayleigh.get("beta", 0.0),
    )


def _lines(draft: Draft, upto: float = 1.5) -> Floats:
    """Frequencies that the program is asked for: even, from half of the first mode."""
    first = read(draft)[0].modes(1)[0][0]
    step = float(f"{first / 60:.3g}")
    return step * np.arange(30, int(60 * upto))


def frf_case(
    draft: Draft, drive: str, response: str, *more: str, tolerance: float = 1e-3, reason: str = _WAVES
) -> Case:
    lines = _lines(draft)
    kind = more[0] if more else "receptance"

    def asked(model: Model, door: Door) -> Floats:
        band = f"{lines[0]} Hz:{lines[-1]} Hz"
        found = door.ask(model, "frf", "--drive", drive, "--response", response, "--band", band, "--step",
                         f"{lines[1] - lines[0]}", "--kind", kind, *more[1:])  # fmt: skip
        return np.r_[found["real"], found["imag"]]

    def right(model: Model, _: Door) -> Floats:
        bones, where = read(model)
        (a, x), (b, y) = (one.split(".") for one in (drive, response))
        moved = shaken(model, bones, lines, bones.load({(where[a], SIX.index(x)): 1.0}))
        H = moved[:, 6 * where[b] + SIX.index(y)] * (2j * pi * lines) ** _FOLD[kind]
        return np.r_[H.real, H.imag]

    return Case(draft, asked, right, tolerance, reason)


def _axis(rng: np.random.Generator) -> str:
    return str(rng.choice(["x", "y", "z"]))


@capability("answers: damping of the structure, directly", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = _damped(rng, a_frame(rng), str(rng.choice(["loss_factor", "rayleigh", "materials"])))
    kind = str(rng.choice(list(_FOLD)))
    return frf_case(draft, f"tip.{_axis(rng)}", f"corner.{_axis(rng)}", kind, "--method", "direct")


@capability("answers: damping laws by modes", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = _damped(rng, a_frame(rng), str(rng.choice(["ratio", "loss_factor", "rayleigh", "materials"])))
    return frf_case(draft, f"tip.{_axis(rng)}", f"corner.{_axis(rng)}", str(rng.choice(list(_FOLD))))


@capability("answers: two materials of their own losses", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_frame(rng)
    corner = np.array(draft["points"]["corner"]["at"])
    draft["materials"]["n"] = {**draft["materials"]["m"], "loss_factor": 0.15}
    draft["materials"]["m"]["loss_factor"] = 0.05
    draft["sections"]["t"] = a_section(rng)
    end = (corner + rng.uniform(0.4, 0.8, 3)).round(3).tolist()
    draft["parts"]["g"] = {
        "type": "frame",
        "material": "n",
        "section": "t",
        "mesh": 0.08,
        "lines": [[corner.tolist(), end]],
    }
    draft["joints"] = {"j": {"connect": ["f", "g"]}}
    draft["points"]["end"] = {"on": "g", "at": end}
    draft["damping"] = {"from": "materials"}
    return frf_case(draft, f"end.{_axis(rng)}", f"tip.{_axis(rng)}", "receptance", "--method", "direct")


def _dashpot(rng: np.random.Generator, draft: Draft, point: str) -> None:
    """Some tenths of what stops the first mode."""
    bones, _ = read(draft)
    f, shapes = bones.modes(1)
    size = 2 * pi * f[0] * 0.2 / max(float(np.abs(shapes[:, 0]).max()) ** 2, 1e-30)
    rates = {one: float(size * rng.uniform(0.3, 2)) for one in "xyz"}
    draft["parts"]["c"] = {"type": "spring", "between": [point, "ground"], "damping": rates}


@capability("answers: a dashpot", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = _damped(rng, a_frame(rng), str(rng.choice(["ratio", "loss_factor", "rayleigh"])))
    _dashpot(rng, draft, "tip")
    return frf_case(draft, f"tip.{_axis(rng)}", f"corner.{_axis(rng)}")


@capability("answers: a tuned mass", "independent")
def _(rng: np.random.Generator) -> Case:
    """A body on a spring and dashpot, tuned to the first mode, as an upright bar's stub has it."""
    draft = _damped(rng, a_frame(rng), "ratio")
    bones, _ = read(draft)
    f, shapes = bones.modes(1)
    weight = 0.1 / float(np.abs(shapes[:, 0]).max() ** 2)
    tip = draft["points"]["tip"]["at"]
    size = 0.1
    draft["parts"]["tuned"] = {"type": "block", "mass": weight, "origin": tip, "size": [size, size, size]}
    draft["points"]["hung"] = {"on": "tuned", "at": [0.0, 0.0, 0.0]}
    k = weight * (2 * pi * f[0]) ** 2
    draft["parts"]["k"] = {
        "type": "spring", "between": ["tip", "hung"],
        "stiffness": {**dict.fromkeys("xyz", k), **dict.fromkeys(SIX[3:], k * size**2 * 10)},
        "damping": dict.fromkeys("xyz", 2 * 0.15 * weight * 2 * pi * f[0]),
    }  # fmt: skip
    axis = _axis(rng)
    return frf_case(draft, f"tip.{axis}", f"tip.{axis}")


@capability("answers: reciprocity", "relation")
def _(rng: np.random.Generator) -> Case:
    draft = _damped(rng, a_frame(rng), str(rng.choice(["ratio", "loss_factor", "rayleigh", "materials"])))
    ends = [f"tip.{_axis(rng)}", f"mid.{_axis(rng)}"]
    one, other = frf_case(draft, *ends), frf_case(draft, *ends[::-1])

    def beside(case: Case) -> Callable[[Model, Door], Floats]:
        """Its response, and the root of the product of both ends' own, below the first mode."""

        def ask(model: Model, door: Door) -> Floats:
            bones, where = read(model)
            at = [6 * where[place] + SIX.index(axis) for place, axis in (end.split(".") for end in ends)]
            loads = [bones.load({(row // 6, row % 6): 1.0}) for row in at]
            own = [shaken(model, bones, _lines(model)[:1], F)[0, row] for row, F in zip(at, loads, strict=True)]
            return np.r_[case.asked(model, door), np.sqrt(np.abs(np.prod(own)))]

        return ask

    why = (
        "symmetric matrices; what residual vectors of the drive lack of modes left out, 1e-3, is by Cauchy and Schwarz "
    )
    return Case(draft, beside(one), beside(other), 1e-3, why + "of the root of both own responses")


@capability("answers: directly or by modes", "relation")
def _(rng: np.random.Generator) -> Case:
    draft = _damped(rng, a_frame(rng), str(rng.choice(["loss_factor", "rayleigh", "materials"])))
    if draft["damping"].keys() != {"from"}:
        _dashpot(rng, draft, "mid")
    ends = [f"tip.{_axis(rng)}", f"mid.{_axis(rng)}"]
    one, other = frf_case(draft, *ends), frf_case(draft, *ends, "receptance", "--method", "direct")
    return Case(draft, one.asked, other.asked, 1e-3, "modes with residual vectors keep 1e-3 of the largest response")


@capability("answers: a block on springs and dashpots", "independent")
def _(rng: np.random.Generator) -> Case:
    draft = a_block(rng)
    mass = draft["parts"]["m"]["mass"]
    for one in "abc":
        draft["parts"][f"k{one}"]["damping"] = {axis: float(mass * rng.uniform(0.5, 2)) for axis in "xyz"}
    draft["damping"] = {"ratio": 0.03}
    exact = "six modes are all there are; rounding"
    return frf_case(draft, f"d.{_axis(rng)}", f"inside.{_axis(rng)}", tolerance=1e-5, reason=exact)


@capability("answers: complex modes with dashpots", "independent")
def _(rng: np.random.Generator) -> Case:
    """Frequencies and ratios of three."""
    draft = a_frame(rng)
    first = 2 * pi * read(draft)[0].modes(1)[0][0]
    draft["damping"] = {"rayleigh": {"alpha": float(0.02 * first), "beta": float(0.01 / first)}}
    _dashpot(rng, draft, str(rng.choice(["tip", "corner"])))
    upto = 1.3 * float(read(draft)[0].modes(4)[0][3])

    def asked(model: Model, door: Door) -> Floats:
        found = door.ask(model, "modes", "--complex", "--up-to", f"{upto} Hz")
        return np.r_[np.array(found["frequency_hz"])[:3] / upto, found["damping_ratio"][:3]]

    def right(model: Model, _: Door) -> Floats:
        law = model["damping"]["rayleigh"]
        poles = read(model)[0].poles(3, law["alpha"], law["beta"])
        return np.r_[abs(poles) / 2 / pi / upto, -poles.real / abs(poles)]

    return Case(
        draft, asked, right, 5e-5, "the first modes of the mesh; of the largest, a frequency over the upper end"
    )


def _base(rng: np.random.Generator, kind: str) -> Case:
    """Absolute acceleration or relative displacement of a place, its base shaken along an axis."""
    draft = a_frame(rng) if rng.random() < 0.5 else a_block(rng)
    if "materials" in draft:
        draft = _damped(rng, draft, "ratio")
    place = "tip" if "tip" in draft["points"] else "d"
    axis, other = _axis(rng), _axis(rng)
    first = float(read(draft)[0].modes(1)[0][0])
    band = [float(f"{first * share:.4g}") for share in (0.4, 1.6)]
    level = [0.5, 1.3] if kind == "psd" else [0.8, 0.5]
    study = {
        "model": "m.yaml", "modes": {"up_to": f"{30 * first} Hz"},
        "vibration": {"v": {"base": axis, kind: [[f, a] for f, a in zip(band, level, strict=True)]}},
        "record": {f"{place}.{other}": ["acceleration", "displacement"]},
    }  # fmt: skip
    draft = {"study": study, "m": draft}

    def asked(model: Model, door: Door) -> Floats:
        found = door.ask(model["study"], "run", "--no-pictures", m=model["m"])
        answers = found["cases"]["as given"]["vibration"]["v"]["answers"]
        word = "rms" if kind == "psd" else "largest"
        relative = " relative to the base" * (
            model["study"]["vibration"]["v"]["base"] == other
        )  # across it, all motion is
        keys = (f"{place}.{other} acceleration", f"{place}.{other} displacement{relative}")
        return np.array([answers[key][word] for key in keys]) * [1.0, (2 * pi * first) ** 2]

    def right(model: Model, _: Door) -> Floats:
        said = model["study"]["vibration"]["v"]
        along, law = str(said["base"]), np.array(said[kind], float)
        lines = np.linspace(law[0, 0], law[-1, 0], 3001)
        bones, where = read(model["m"])
        ride = np.tile([along == one for one in SIX], len(bones.at)).astype(float)
        z = shaken(model["m"], bones, lines, -bones.matrix("M") @ ride)[:, 6 * where[place] + SIX.index(other)]
        return _measured(z, lines, along == other, law, kind) * [1.0, (2 * pi * first) ** 2]

    why = "modes of the mesh; lines 1/3000 of the band apart near a peak of 2 % and more"
    return Case(draft, asked, right, 1e-3, why)


def _measured(z: Floats, lines: Floats, along: bool, law: Floats, kind: str) -> Floats:
    """Root mean square, or the largest, of acceleration and displacement per unit acceleration of the base."""
    both = np.array([1.0 * along - (2 * pi * lines) ** 2 * z, z])
    if kind == "harmonic":
        return np.asarray(np.abs(both * log_log([(float(f), float(a)) for f, a in law])(lines)).max(axis=1))
    density = np.abs(both) ** 2 * log_log([(float(f), float(a)) for f, a in law])(lines)
    return np.sqrt(np.trapezoid(density, lines, axis=1))


@capability("answers: a harmonic base", "independent")
def _(rng: np.random.Generator) -> Case:
    return _base(rng, "harmonic")


@capability("answers: a random base", "independent")
def _(rng: np.random.Generator) -> Case:
    return _base(rng, "psd")


@capability("answers: stress along frequency", "independent")
def _(rng: np.random.Generator) -> Case:
    """Bending of one straight bar by a force at its tip, at its root."""
    draft = _damped(rng, a_frame(rng, 1), "loss_factor")
    draft["sections"]["s"] = a_section(rng, ("rectangle", "box", "I"))
    draft = _damped(rng, draft, "loss_factor")
    axis, lines = _axis(rng), _lines(draft)

    def asked(model: Model, door: Door) -> Floats:
        band = f"{lines[0]} Hz:{lines[-1]} Hz"
        found = door.ask(model, "frf", "--drive", f"tip.{axis}", "--response", "f.stress", "--band", band, "--step",
                         f"{lines[1] - lines[0]}")  # fmt: skip
        return np.array([max(abs(one) for one in found["real"])])

    def right(model: Model, _: Door) -> Floats:
        bones, where = read(model)
        moved = shaken(model, bones, lines, bones.load({(where["tip"], SIX.index(axis)): 1.0}))
        return np.array([np.abs(bones.stresses(one)).max() for one in moved]).max(keepdims=True)

    return Case(draft, asked, right, 1e-3, "modes of the mesh, and stresses at the ends of bars")
