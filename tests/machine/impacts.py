"""Bodies that strike, lie, hang and are joined, on the ground, oscillators and given modes, against events in scipy.

A case's model has a "study" and its "structure"; `chain_of` reads both again, by itself.
"""

from __future__ import annotations

import functools
import json
from collections.abc import Mapping
from math import pi, sqrt
from typing import Any, Final

import numpy as np

from tests.independent import contact_events as ev
from tests.independent import rods
from tests.machine.framework import Case, Door, Floats, Model, capability
from tests.machine.laws import LAWS, between, draw_law, law_of, rounded

G: Final = 9.80665
SIDES: Final = ("above", "below", "before", "after")
_KNOBS = ("study.bodies", "study.contacts", "study.links", "study.loads", "structure")
_WHY = "both integrate to 1e-9 and better; draws whose answer hangs on rounding are drawn again"


# ---- a study read again


def modes_of(structure: Mapping[str, Any]) -> tuple[list[float], list[float], dict[str, list[float]]]:
    """Angular frequencies, damping ratios and shapes of unit modal mass."""
    what = structure["structure"]
    if what == "none":
        return [], [], {}
    if what["type"] == "oscillator":
        omega = 2 * pi * what["frequency"] if "frequency" in what else sqrt(what["stiffness"] / what["mass"])
        return [omega], [structure["damping"]["ratio"]], {"m": [1 / sqrt(what["mass"])]}
    if what["type"] in ("rod", "beam"):
        at = {name: one["at"] for name, one in structure["points"].items()}
        known = {name: value for name, value in what.items() if name != "type"}
        found = rods.rod(**known, at=at) if what["type"] == "rod" else rods.beam(**known, at=at)
        return found[0], [structure["damping"]["ratio"]] * len(found[0]), found[1]
    shapes = {name: one["shape"] if isinstance(one, Mapping) else one for name, one in what["points"].items()}
    return [2 * pi * f for f in what["frequency"]], list(what["ratio"]), shapes


def walked(on: str, spec: Mapping[str, Any], first: float) -> ev.Push:
    """Steps at a place: m g (1 + sum a sin(2 pi h f t)), rising over the first and falling over the last as half a
    cosine."""
    end = spec["steps"] / spec["pace"]

    def force(t: float) -> float:
        steps = spec["pace"] * (t - first)
        if not 0.0 <= t - first <= end:
            return 0.0
        waves = sum(a * np.sin(2 * pi * h * steps) for h, a in enumerate(spec["harmonics"], 1))
        held = min(steps, spec["steps"] - steps, 1.0)
        return float(-spec["mass"] * G * (1 + waves) * (1 - np.cos(pi * held)) / 2)

    return ev.Push(on, force, (first, first + 1 / spec["pace"], first + end - 1 / spec["pace"], first + end))


def chain_of(model: Model) -> ev.Chain:
    """The mechanics of a case's study on its structure."""
    study = model["study"]
    omega, ratio, shapes = modes_of(model["structure"])
    kept = study.get("modes", {}).get("count", len(omega))
    omega, ratio, shapes = omega[:kept], ratio[:kept], {name: list(one[:kept]) for name, one in shapes.items()}
    bodies = study.get("bodies", {})
    masses = {name: one["mass"] for name, one in bodies.items()}
    heavy = bool(study["time"].get("gravity"))
    height: dict[str, float] = {"ground": -10.0, **dict.fromkeys(shapes, 0.0)}
    over = {name: "above" in one or "after" in one for name, one in bodies.items()}
    beside = {name: next(one[side] for side in SIDES if side in one) for name, one in bodies.items()}
    for name, target in beside.items():
        height[name] = height[target] + (1.0 if over[name] else -1.0)
    speeds = {n: one.get("speed", sqrt(2 * G * one.get("drop_height", 0.0))) for n, one in bodies.items()}
    flying = [name for name, speed in speeds.items() if speed]
    hung = {end for link in study.get("links", {}).values() for end in link["between"] if end in bodies}

    def ends(pair: list[str]) -> tuple[str | None, str | None]:
        upper, lower = sorted(pair, key=lambda end: -height[end])
        return (None if upper == "ground" else upper), (None if lower == "ground" else lower)

    def borne(name: str | None) -> float:  # mass of what lies on a body, and its own
        if name is None or name in flying or name not in bodies:
            return 0.0
        return masses[name] + sum(borne(one) for one in bodies if bodies[one].get("above") == name)

    def touch(name: str, spec: Mapping[str, Any], apart: bool = False) -> ev.Touch:
        upper, lower = ends(spec["between"])[:: -1 if apart else 1]
        shares = [1 / masses[end] for end in (upper, lower) if end in masses]
        law = law_of(spec["law"], 1 / sum(shares), max(speeds.get(end or "", 0.0) for end in (upper, lower)))
        weight = borne(upper) * G if heavy and upper not in hung and lower not in hung else 0.0
        return ev.Touch(name, upper, lower, law, spec.get("gap", 0.0), spec.get("preload", 0.0) + weight)

    contacts = dict(study.get("contacts", {}))
    for name, one in bodies.items():
        if "contact" in one:
            contacts[f"{name} on {beside[name]}"] = {"between": [name, beside[name]], "law": one["contact"]}
    touches = [touch(*one) for one in contacts.items()]
    stops = [(name, one) for name, one in contacts.items() if one["law"]["type"] == "stop"]
    touches += [touch(f"{name} apart", one, True) for name, one in stops]
    springs = []
    for link in study.get("links", {}).values():
        if "frequency" in link:
            mass = next(masses[end] for end in link["between"] if end in masses)
            k = mass * (2 * pi * link["frequency"]) ** 2
            c: Any = 2 * link["ratio"] * sqrt(k * mass)
        else:
            k, c = link["stiffness"], link.get("damping", 0.0)
        closing, opening = (c["closing"], c["opening"]) if isinstance(c, Mapping) else (c, c)
        push, since = link.get("preload", 0.0), link.get("release_at", 0.0)
        springs.append(ev.Spring(*ends(link["between"]), k, closing, opening, push, since))
    pulses, pushes = [], []
    for load in study.get("loads", {}).values():
        on = load["body"] if "body" in load else load.get("at", "").removesuffix(".z")
        for turn in range(load.get("count", 1) if "half_sine" in load else 0):
            first, half_sine = load.get("first", 0.0) + turn * load.get("every", 0.0), load["half_sine"]
            pulses.append(ev.Pulse(on, half_sine["amplitude"], half_sine["frequency"], first))
        if "walking" in load:
            pushes.append(walked(load["along"], load["walking"], load.get("first", 0.0)))
    again = []
    for name, one in bodies.items():
        if "blows" in one:
            count, every = one["blows"]["count"], one["blows"]["every"]
            target = None if beside[name] == "ground" else beside[name]
            first = one["blows"].get("first", 0.0)
            times = tuple(first + every * turn for turn in range(0 if first else 1, count))
            again.append(ev.Again(name, target, times, bool(first)))
    modal = np.zeros(len(omega))
    for point, speed in study.get("initial", {}).get("velocity", {}).items():
        shape = np.array(shapes[point.removesuffix(".z")])
        modal = modal + shape * speed / (shape @ shape)  # an impulse there
    return ev.Chain(
        omega, ratio, shapes, masses, touches, springs, pulses,
        {name: -masses[name] * G for name in flying} if heavy else {},
        {name: -speeds[name] if over[name] else speeds[name] for name in flying},
        modal.tolist() if modal.any() else (), again=again, pushes=pushes,
    )  # fmt: skip


def path_of(model: Model, rtol: float = 1e-11) -> ev.Path:
    """The motion of a case, kept for what asks again."""
    return _path(json.dumps(model), rtol)


@functools.lru_cache(maxsize=8)
def _path(text: str, rtol: float) -> ev.Path:
    model = json.loads(text)
    duration = model["study"]["time"]["duration"]
    # A contact that opens and closes within one is missed: where shorter ones see it, the draw is not taken (`clear`).
    steps = 900 if rtol < 1e-10 else 150
    return ev.run(chain_of(model), duration, rtol, duration / steps)


# ---- what is asked


def answered(model: Model, door: Door, *words: str) -> Any:
    """The first case of the study; given modes are the whole structure here, and a motion may go on at the end."""
    study = {"model": "structure.yaml", **model["study"]}
    answer = door.ask(study, "impact", *words, structure=model["structure"])
    door.told = [one for one in door.told if not expected_of_given_modes(one)]
    return next(iter(answer["cases"].values()))


def expected_of_given_modes(told: str) -> bool:
    """What is said of every structure that is its modes, or whose motion is not over."""
    code = told.split(":")[0]
    return code.endswith("-beyond-modes") or code in ("structure-not-decayed", "impact-not-over")


def numbers(model: Model, door: Door) -> Floats:
    """Peak and end of each contact and how bodies leave, over what they are by the path's own size."""
    case, size = answered(model, door), _sizes(model)
    forces = [case["contacts"][name]["peak_force_n"] / size["N"] for name in _names(model)]
    opened = [_or_zero(case["contacts"][name]["first_open_s"]) / size["s"] for name in _names(model)]
    return np.array([*forces, *opened, *(one["end_velocity"] / size["m/s"] for one in case["bodies"].values())])


def _or_zero(x: float | None) -> float:
    return 0.0 if x is None else x


def numbers_right(model: Model, _: Door | None = None, rtol: float = 1e-11) -> Floats:
    """The same by events."""
    path, size = path_of(model, rtol), _sizes(model)
    end = np.array([len(times_of(model)) / model["study"]["time"]["sampling"]])  # whole samples
    forces = [path.peak(name) / size["N"] for name in _names(model)]
    opened = []
    for name in _names(model):
        times = [b for _, b in path.touching(name) if b < end[0]]
        opened.append(times[0] / size["s"] if times else 0.0)
    return np.array([*forces, *opened, *(path.speed(name, end)[0] / size["m/s"] for name in path.chain.bodies)])


def _names(model: Model) -> list[str]:
    return [one.name for one in chain_of(model).touches]


def _sizes(model: Model) -> dict[str, float]:
    path = path_of(model)
    speed = max((abs(one) for one in path.chain.start.values()), default=1.0)
    force = max(path.peak(one.name) for one in path.chain.touches)
    return {"N": force, "s": model["study"]["time"]["duration"], "m/s": speed}


def motions(model: Model, door: Door) -> Floats:
    """Histories of all that moves, each over its largest by the path."""
    study = {"model": "structure.yaml", **model["study"]}
    found, path = door.histories(study, structure=model["structure"]), path_of(model)
    times = times_of(model)
    rows = []
    for name in [*path.chain.bodies, *(f"{point}.{axis_of(model)}" for point in path.chain.shapes)]:
        for what in ("displacement", "velocity"):
            size = np.abs(_moved(path, name, what, times)).max() or 1.0
            rows.append(np.interp(times, found["t"], found[f"{name} {what}"]) / size)
    return np.concatenate(rows)


def times_of(model: Model) -> Floats:
    time = model["study"]["time"]
    return np.arange(int(time["duration"] * time["sampling"] * (1 - 1e-9))) / time["sampling"]


def _moved(path: ev.Path, name: str, what: str, times: Floats) -> Floats:
    of = path.moved if what == "displacement" else path.speed
    return of(name.removesuffix(".z").removesuffix(".x"), times)


def motions_right(model: Model, _: Door | None = None, rtol: float = 1e-11) -> Floats:
    """The same by events."""
    path, best, times = path_of(model, rtol), path_of(model), times_of(model)
    rows = []
    for name in [*path.chain.bodies, *(f"{point}.{axis_of(model)}" for point in path.chain.shapes)]:
        for what in ("displacement", "velocity"):
            size = np.abs(_moved(best, name, what, times)).max() or 1.0
            rows.append(_moved(path, name, what, times) / size)
    return np.concatenate(rows)


# ---- scenes


def oscillator(rng: np.random.Generator) -> dict[str, Any]:
    """A mass on a spring, with its point m."""
    mass, frequency = between(rng, 0.5, 50), between(rng, 3, 300)
    spring = (
        {"frequency": frequency} if rng.random() < 0.5 else {"stiffness": rounded(mass * (2 * pi * frequency) ** 2)}
    )
    ratio = rounded(float(rng.uniform(0, 0.1)))
    what = {"type": "oscillator", "mass": mass, **spring}
    return {"structure": what, "points": {"m": {}}, "damping": {"ratio": ratio}}


def given_modes(rng: np.random.Generator, lowest: float = 3.0) -> dict[str, Any]:
    """One to three modes with points P, and Q below it."""
    count = int(rng.integers(1, 4))
    frequency = sorted(between(rng, lowest, 400) for _ in range(count))
    ratio = [rounded(float(rng.uniform(0, 0.08))) for _ in frequency]
    points = {
        name: {"shape": [rounded(float(rng.uniform(-1, 1))) + 0.05 for _ in frequency], "at": at}
        for name, at in (("P", 0.5), ("Q", 0.0))
    }
    return {"structure": {"type": "modes", "frequency": frequency, "ratio": ratio, "points": points}}


def axis_of(model: Model) -> str:
    """Along which its structure moves."""
    what = model["structure"]["structure"]
    return "x" if what != "none" and what["type"] == "rod" else "z"


def base_of(structure: Mapping[str, Any]) -> str:
    """Where bodies strike."""
    what = structure["structure"]
    return "ground" if what == "none" else "m" if what["type"] == "oscillator" else "P"


def scene(
    rng: np.random.Generator, structure: Mapping[str, Any], kind: str = "", lying: int = 0, turns: float = 6.0
) -> dict[str, Any]:
    """A body that strikes a structure, or what lies on it. turns : duration, in contacts that last as drawn."""
    target, time, speed = base_of(structure), between(rng, 5e-4, 5e-3), between(rng, 0.1, 4)
    modes = modes_of(structure)[0]
    study: dict[str, Any] = {"bodies": {}, "contacts": {}, "record": {}}
    for number in range(lying):
        name, mass = f"b{number}", between(rng, 0.05, 2)
        study["bodies"][name] = {"mass": mass, "above": target}
        law = draw_law(rng, mass, speed, between(rng, 5e-4, 5e-3), any_law(rng), e=False)
        pair = [name, target] if rng.random() < 0.5 else [target, name]
        study["contacts"][f"under {name}"] = {"between": pair, "law": law}
        target = name
    mass = between(rng, 0.05, 2)
    met = study["bodies"][target]["mass"] if lying else np.inf
    law = draw_law(rng, 1 / (1 / mass + 1 / met), speed, time, kind or any_law(rng))
    body = {"mass": mass, "above": target}
    study["bodies"]["a"] = body | (
        {"drop_height": rounded(speed**2 / 2 / G)} if rng.random() < 0.5 else {"speed": speed}
    )
    if rng.random() < 0.6:
        study["bodies"]["a"]["contact"] = law
    else:
        study["contacts"]["hit"] = {"between": ["a", target], "law": law}
    duration = rounded(turns * time)
    study["time"] = {"duration": duration, "sampling": float(np.ceil(200 / duration))}
    if modes:
        study["modes"] = {"count": len(modes)}
    record(study, structure)
    return {"study": study, "structure": dict(structure)}


def record(study: dict[str, Any], structure: Mapping[str, Any]) -> None:
    """Ask for the histories of all."""
    for name in study["bodies"]:
        study["record"][name] = ["displacement", "velocity"]
    for name in modes_of(structure)[2]:
        study["record"][f"{name}.z"] = ["displacement", "velocity", "acceleration"]


def any_law(rng: np.random.Generator) -> str:
    """One of them."""
    return str(rng.choice(LAWS))


NOTHING: Final = {"structure": "none"}


def clear(draw: Any, right: Any, allowed: float = 1e-9) -> Any:
    """A draw whose answer does not hang on the tolerance of an integration."""
    for _ in range(20):
        model = draw()
        try:
            if np.abs(right(model, rtol=1e-9) - right(model)).max() < allowed * 100:
                return model
        except (RuntimeError, ValueError, ZeroDivisionError):  # events without end; a window in which nothing moves
            continue
    raise ValueError("20 draws that hang on rounding")


def _of_numbers(draw: Any) -> Case:
    return Case(clear(draw, numbers_right), numbers, numbers_right, 1e-6, _WHY, _KNOBS)


def _of_motions(draw: Any) -> Case:
    return Case(clear(draw, motions_right), motions, motions_right, 1e-6, _WHY, _KNOBS)


def _law_capability(kind: str) -> None:
    @capability(f"impacts: a blow with a {kind} law", "independent")
    def _(rng: np.random.Generator) -> Case:
        structure = NOTHING if rng.random() < 0.5 else oscillator(rng)
        return _of_numbers(lambda: scene(rng, structure, kind, turns=float(rng.uniform(1.5, 6))))


for _kind in LAWS:
    _law_capability(_kind)


@capability("impacts: a stack is struck", "independent")
def _(rng: np.random.Generator) -> Case:
    return _of_motions(lambda: _weighed(rng, scene(rng, NOTHING, lying=int(rng.integers(1, 3)))))


@capability("impacts: what lies on a structure is struck", "independent")
def _(rng: np.random.Generator) -> Case:
    return _of_motions(lambda: _weighed(rng, scene(rng, _some(rng), lying=1)))


@capability("impacts: a blow on given modes", "independent")
def _(rng: np.random.Generator) -> Case:
    return _of_motions(lambda: _weighed(rng, scene(rng, given_modes(rng))))


def _some(rng: np.random.Generator) -> dict[str, Any]:
    return oscillator(rng) if rng.random() < 0.5 else given_modes(rng)


def _weighed(rng: np.random.Generator, model: dict[str, Any]) -> dict[str, Any]:
    """With gravity, in half of the draws."""
    if rng.random() < 0.5:
        model["study"]["time"]["gravity"] = True
    return model


def _hung(rng: np.random.Generator, model: dict[str, Any], gap: bool = False, preload: bool = False) -> dict[str, Any]:
    """A body below the structure, held by a link, that it touches at rest or across a gap."""
    study, base = model["study"], base_of(model["structure"])
    mass, q = between(rng, 0.05, 2), "Q" if base == "P" and rng.random() < 0.5 else base
    study["bodies"]["d"] = {"mass": mass, "below": q}
    speed = study["bodies"]["a"].get("speed", 1.0)
    law = draw_law(rng, mass, speed, between(rng, 5e-4, 5e-3), any_law(rng), e=False)
    study["contacts"]["under"] = {"between": [q, "d"], "law": law}
    if gap:
        study["contacts"]["under"]["gap"] = rounded(float(rng.uniform(0, 2e-4)))
    if preload:
        force = rounded(float(rng.uniform(0.1, 30)))
        study["contacts"]["under"]["preload"] = min(force, 0.5 * law["curve"][-1][1] if "curve" in law else force)
    k, c = rounded(mass * (2 * pi * between(rng, 2, 80)) ** 2), rounded(float(rng.uniform(0, 0.5)) * mass * 100)
    ways: list[dict[str, Any]] = [
        {"stiffness": k, "damping": c},
        {"stiffness": k, "damping": {"closing": 0.0, "opening": c}},
        {"frequency": between(rng, 2, 80), "ratio": rounded(float(rng.uniform(0, 0.4)))},
    ]
    study["links"] = {"hold": {"between": ["d", "ground" if rng.random() < 0.6 else base], **ways[rng.integers(3)]}}
    record(study, model["structure"])
    return model


@capability("impacts: a body below across a gap", "independent")
def _(rng: np.random.Generator) -> Case:
    return _of_motions(lambda: _hung(rng, scene(rng, _some(rng)), gap=True))


@capability("impacts: a preloaded contact", "independent")
def _(rng: np.random.Generator) -> Case:
    return _of_motions(lambda: _hung(rng, scene(rng, _some(rng)), preload=True))


@capability("impacts: a tuned damper on a link", "independent")
def _(rng: np.random.Generator) -> Case:
    def draw() -> dict[str, Any]:
        model = scene(rng, _some(rng), turns=30.0)
        study, base = model["study"], base_of(model["structure"])
        study["bodies"]["d"] = {"mass": between(rng, 0.05, 2), "below": base}
        tuned = {"frequency": between(rng, 2, 200), "ratio": rounded(float(rng.uniform(0, 0.4)))}
        study["links"] = {"damper": {"between": ["d", base], **tuned}}
        record(study, model["structure"])
        return model

    return _of_motions(draw)


@capability("impacts: a half sine on a body or a point", "independent")
def _(rng: np.random.Generator) -> Case:
    def draw() -> dict[str, Any]:
        model = scene(rng, _some(rng))
        study, base = model["study"], base_of(model["structure"])
        size = study["bodies"]["a"]["mass"] * study["bodies"]["a"].get("speed", 1.0) / 2e-3
        push = {"amplitude": rounded(float(rng.uniform(-1, 1)) * size), "frequency": between(rng, 50, 500)}
        on = {"body": "a"} if rng.random() < 0.5 else {"at": f"{base}.z"}
        study["loads"] = {"push": {**on, "half_sine": push, "first": rounded(float(rng.uniform(0, 1e-3)))}}
        return model

    return _of_motions(draw)


@capability("impacts: repeated blows", "independent")
def _(rng: np.random.Generator) -> Case:
    def draw() -> dict[str, Any]:
        model = scene(rng, NOTHING if rng.random() < 0.3 else _some(rng), turns=12.0)
        study = model["study"]
        count = int(rng.integers(2, 4))
        study["bodies"]["a"]["blows"] = {"count": count, "every": rounded(study["time"]["duration"] / 3)}
        return model

    return _of_motions(draw)


@capability("impacts: a gap before the first touch", "independent")
def _(rng: np.random.Generator) -> Case:
    def draw() -> dict[str, Any]:
        model = scene(rng, NOTHING if rng.random() < 0.3 else _some(rng))
        body, study = model["study"]["bodies"]["a"], model["study"]
        if "contact" in body:
            study["contacts"]["hit"] = {"between": ["a", body["above"]], "law": body.pop("contact")}
        speed = body.get("speed") or sqrt(2 * G * body["drop_height"])
        study["contacts"]["hit"]["gap"] = rounded(float(rng.uniform(0, 0.4)) * speed * study["time"]["duration"])
        return _weighed(rng, model)

    return _of_motions(draw)


@capability("impacts: the structure moves at the start", "independent")
def _(rng: np.random.Generator) -> Case:
    def draw() -> dict[str, Any]:
        model = scene(rng, oscillator(rng))
        model["study"]["initial"] = {"velocity": {"m.z": rounded(float(rng.uniform(-1, 1)))}}
        return model

    return _of_motions(draw)


# ---- relations and limits


def _scaled(model: Model, force: float) -> dict[str, Any]:
    """All masses, springs, dashpots and forces times a number: the same motion."""
    fresh = json.loads(json.dumps(model))
    for body in fresh["study"]["bodies"].values():
        body["mass"] *= force
    for name in ("mass", "stiffness"):
        if name in fresh["structure"]["structure"]:
            fresh["structure"]["structure"][name] *= force
    laws = [one["law"] for one in fresh["study"]["contacts"].values()]
    for law in laws + [one["contact"] for one in fresh["study"]["bodies"].values() if "contact" in one]:
        for name in ("stiffness", "damping", "cubic"):
            if name in law:
                law[name] *= force
        if "E" in law:
            law["E"] = [one * force for one in law["E"]]
        if "curve" in law:
            law["curve"] = [[d, f * force] for d, f in law["curve"]]
    return fresh  # type: ignore[no-any-return]


def _ends(model: Model, door: Door, *words: str) -> Floats:
    """Peaks and how bodies leave, by name."""
    case = answered(model, door, *words)
    forces = [one["peak_force_n"] for _, one in sorted(case["contacts"].items())]
    return np.array([*forces, *(one["end_velocity"] for _, one in sorted(case["bodies"].items()))])


@capability("impacts: masses and springs twice as large", "relation")
def _(rng: np.random.Generator) -> Case:
    model = clear(lambda: scene(rng, oscillator(rng), lying=int(rng.integers(0, 2))), numbers_right)

    def right(model: Model, door: Door) -> Floats:
        found, count = _ends(_scaled(model, 2.0), door), len(_names(model))
        return np.concatenate([found[:count] / 2, found[count:]])

    return Case(model, _ends, right, 1e-8, "the same motion; two, a power of two, changes rounding little", _KNOBS)


@capability("impacts: bodies and contacts in another order", "relation")
def _(rng: np.random.Generator) -> Case:
    model = clear(lambda: _hung(rng, scene(rng, _some(rng), lying=1), gap=True), numbers_right)

    def right(model: Model, door: Door) -> Floats:
        study = dict(model["study"])
        for group in ("bodies", "contacts"):
            study[group] = dict(reversed(study[group].items()))
        return _ends({**model, "study": study}, door)

    return Case(model, _ends, right, 1e-8, "sums in another order", _KNOBS)


@capability("impacts: a mass by --set or in the file", "relation")
def _(rng: np.random.Generator) -> Case:
    model = clear(lambda: scene(rng, _some(rng)), numbers_right)
    mass = between(rng, 0.05, 2)

    def asked(model: Model, door: Door) -> Floats:
        return _ends(model, door, "--set", f"bodies.a.mass={mass!r}")

    def right(model: Model, door: Door) -> Floats:
        fresh = json.loads(json.dumps(model))
        fresh["study"]["bodies"]["a"]["mass"] = mass
        return _ends(fresh, door)

    return Case(model, asked, right, 1e-12, "the same input", _KNOBS)


@capability("impacts: energies add up at the end", "limit")
def _(rng: np.random.Generator) -> Case:
    model = clear(lambda: _hung(rng, scene(rng, _some(rng)), gap=True), numbers_right)

    def asked(model: Model, door: Door) -> Floats:
        energy = answered(model, door)["energy"]
        end = energy["end"]
        kept = sum(end[name] for name in model["study"]["bodies"]) + end["structure"] + end["stored"]
        return np.array([(kept + end["dissipated"]) / energy["input_j"]])

    return Case(model, asked, lambda *_: np.ones(1), 1e-6, "first law; quadrature of the losses", _KNOBS)


@capability("impacts: energy of bodies at the end", "independent")
def _(rng: np.random.Generator) -> Case:
    model = clear(lambda: scene(rng, _some(rng), lying=int(rng.integers(0, 2))), numbers_right)

    def asked(model: Model, door: Door) -> Floats:
        end = answered(model, door)["energy"]["end"]
        return np.array([end[name] for name in model["study"]["bodies"]] + [end["structure"]])

    def right(model: Model, _: Door) -> Floats:
        path, time = path_of(model), model["study"]["time"]
        end = np.array([np.floor(time["duration"] * time["sampling"]) / time["sampling"]])
        state, modes, n = path.at(end)[:, 0], len(path.chain.omega), path.chain.size
        z, v = state[:modes], state[n : n + modes]
        bodies = [m * path.speed(name, end)[0] ** 2 / 2 for name, m in path.chain.bodies.items()]
        return np.array(
            [*bodies, float(v @ v + (np.array(path.chain.omega) * z) @ (np.array(path.chain.omega) * z)) / 2]
        )

    return Case(model, asked, right, 1e-6, _WHY + "; the end is the last sample", _KNOBS)
