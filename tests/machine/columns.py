"""One structure, any of its answers: modes, losses, at rest, frequency response, on a shaken base.

A subject of a capability draws a model and gives its independent form; which answer is asked is drawn as well.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import pi
from typing import Any, Final

import numpy as np

from tests.independent.linear import Floats, Law, Linear
from tests.independent.vibration import log_log
from tests.machine.framework import Case, Door, Model

Draft = dict[str, Any]
ANSWERS: Final = ("modes", "losses", "statics", "frf", "vibration")
_LAWS: Final = ("ratio", "loss_factor", "rayleigh")
_FOLD: Final = {"receptance": 0, "mobility": 1, "accelerance": 2}
Ask = Callable[[Model], Floats]


def as_it_is(model: Model, ask: Ask) -> Floats:
    """The answer on the mesh that is drawn."""
    return ask(model)


def nothing(_: Model) -> Mapping[str, Model | str]:
    """No files beside the model."""
    return {}


@dataclass(frozen=True)
class Subject:
    """draft : a model; form : its independent form; drives, seen : ways such as "q.z"; refine : how an answer is taken
    from meshes; accuracy : of natural frequencies, relative; at_rest : of answers at rest, where it is another; aside :
    findings that do not count; pushed : at rest too, where the form must be right beside a force; beside : files and
    models that a model takes; first : commands before what is asked; reach : how many times the first mode modes of
    a shaken base go up to; still : modes at rest, of what nothing holds; count : of modes that are compared.
    """

    draft: Draft
    form: Callable[[Model], Linear]
    drives: Sequence[str]
    seen: Sequence[str]
    accuracy: float
    reason: str
    refine: Callable[[Model, Ask], Floats] = as_it_is
    aside: tuple[str, ...] = ()
    knobs: tuple[str, ...] = ()
    answers: tuple[str, ...] = ANSWERS
    at_rest: float | None = None
    pushed: bool = True
    beside: Callable[[Model], Mapping[str, Model | str]] = nothing
    first: tuple[tuple[str, ...], ...] = ()
    reach: float = 30.0
    still: int = 0
    count: int = 3

    def ask(self, door: Door, model: Model, *command: str) -> dict[str, Any]:
        """An answer of the program."""
        return door.ask(model, *command, first=self.first, **self.beside(model))

    def clear(self, door: Door) -> None:
        door.told[:] = [one for one in door.told if not one.startswith(self.aside)] if self.aside else door.told


def case_of(rng: np.random.Generator, one: Subject) -> Case:
    """An answer of the subject, by lot."""
    return _MAKES[str(rng.choice(one.answers))](rng, one)


def way(words: str) -> tuple[str, str]:
    place, direction = words.rsplit(".", 1)
    return place, direction


def law_of(model: Model) -> Law:
    said = model["damping"]
    rayleigh = said.get("rayleigh", {})
    return Law(
        said.get("ratio", 0.0),
        said.get("loss_factor", 0.0),
        rayleigh.get("alpha", 0.0),
        rayleigh.get("beta", 0.0),
        said.get("from") == "materials",
    )


def _first(one: Subject) -> float:
    return float(one.form(one.draft).modes(1)[0][0])


def _damped(rng: np.random.Generator, one: Subject, least: float = 0.03) -> None:
    """3 to 8 % at the first mode, by a law drawn; or by losses where the model states some."""
    if one.draft.get("damping") == {"from": "materials"}:
        return
    first, size, law = 2 * pi * _first(one), float(rng.uniform(least, 0.08)), str(rng.choice(_LAWS))
    one.draft["damping"] = {
        "ratio": {"ratio": size},
        "loss_factor": {"loss_factor": 2 * size},
        "rayleigh": {"rayleigh": {"alpha": size * first, "beta": size / first}},
    }[law]


def _modes(rng: np.random.Generator, one: Subject) -> Case:
    """Natural frequencies, and modal masses along each axis beside the largest there is."""
    most = max(float(_modal_masses(one.form(one.draft)).sum(axis=0).max()), 1e-9)

    def asked(model: Model, door: Door) -> Floats:
        def ask(finer: Model) -> Floats:
            found = one.ask(door, finer, "modes", "--count", str(one.count + one.still))
            own, masses = np.array(found["frequency_hz"]), np.array([found["modal_mass_kg"][axis] for axis in "xyz"])
            return np.r_[own[own > 1e-3], 1 + _weighted(own[own > 1e-3], masses[:, own > 1e-3].T) / most]

        answer = one.refine(model, ask)
        one.clear(door)
        return answer

    def right(model: Model, _: Door) -> Floats:
        form = one.form(model)
        own = form.modes(one.count)[0]
        return np.r_[own, 1 + _weighted(own, _modal_masses(form)[: one.count]) / most]

    return Case(one.draft, asked, right, one.accuracy, one.reason, one.knobs, each=True)


def _modal_masses(form: Linear) -> Floats:
    """Of every mode along x, y, z [modes, 3]."""
    return np.asarray((form.rides @ form.modes()[1]).T ** 2)


def _weighted(own: Floats, masses: Floats) -> Floats:
    """Sum of modal masses along each axis, the last mode without weight: of modes of one frequency only the sum is
    known, and that of the last ones is cut."""
    return np.asarray((1 - (own / own[-1]) ** 2) @ masses)


def _losses(rng: np.random.Generator, one: Subject) -> Case:
    """Loss factors by energies; with dashpots, ratios of complex modes."""
    form = one.form(one.draft)
    if form.C.any():
        return _poles(one)
    if one.draft.get("damping") != {"from": "materials"}:
        return _modes(rng, one)

    def asked(model: Model, door: Door) -> Floats:
        def ask(finer: Model) -> Floats:
            found = one.ask(door, finer, "modes", "--count", str(one.count + one.still))
            return 2 * np.array(found["damping_ratio"])[np.array(found["frequency_hz"]) > 1e-3]

        answer = one.refine(model, ask)
        one.clear(door)
        return answer

    def right(model: Model, _: Door) -> Floats:
        return one.form(model).losses(one.count)

    return Case(one.draft, asked, right, 2 * one.accuracy, one.reason + "; shares of energy", one.knobs, each=True)


def _poles(one: Subject) -> Case:
    first = 2 * pi * _first(one)
    one.draft["damping"] = {"rayleigh": {"alpha": 0.02 * first, "beta": 0.01 / first}}
    upto = 1.3 * float(one.form(one.draft).modes(4)[0][-1])

    def asked(model: Model, door: Door) -> Floats:
        def ask(finer: Model) -> Floats:
            found = one.ask(door, finer, "modes", "--complex", "--up-to", f"{upto} Hz")
            return np.r_[np.array(found["frequency_hz"])[: one.count] / upto, found["damping_ratio"][: one.count]]

        answer = one.refine(model, ask)
        one.clear(door)
        return answer

    def right(model: Model, _: Door) -> Floats:
        poles = one.form(model).poles(one.count, law_of(model))
        return np.r_[abs(poles) / 2 / pi / upto, -poles.real / abs(poles)]

    return Case(one.draft, asked, right, one.accuracy, one.reason, one.knobs)


def _statics(rng: np.random.Generator, one: Subject) -> Case:
    """Under forces, weight, or both."""
    kind = rng.integers(3)
    if not (one.drives and one.pushed):
        kind = 1
    forces = {words: float(f"{rng.normal() * 100:.3g}") for words in one.drives} if kind != 1 else {}

    def asked(model: Model, door: Door) -> Floats:
        def ask(finer: Model) -> Floats:
            words = [word for words, size in forces.items() for word in ("--force", f"{words}={size} N")]
            found = one.ask(door, finer, "statics", *words, *["--weight"] * int(kind > 0))
            axes, points = ("x", "y", "z", "rx", "ry", "rz"), found["points"]
            moved = np.array([points[place][axes.index(direction)] for place, direction in map(way, one.seen)])
            return np.r_[moved, np.abs(moved).max() * _missing(found, forces)]

        answer = one.refine(model, ask)
        one.clear(door)
        return answer

    def right(model: Model, _: Door) -> Floats:
        form = one.form(model)
        found = form.rest(form.load({way(words): size for words, size in forces.items()}, bool(kind > 0)))
        return np.r_[[form.rows[way(words)] @ found for words in one.seen], np.zeros(6)]

    tolerance = one.accuracy if one.at_rest is None else one.at_rest
    return Case(one.draft, asked, right, tolerance, one.reason, one.knobs)


def _missing(found: Mapping[str, Any], forces: Mapping[str, float]) -> Floats:
    """What supports and springs to the ground miss of the load, and the load across z of the forces, over the load."""
    load, inside = np.array(found["load_n"]), found["held_inside"]
    held = np.sum([found["forces_n"][name] for name in found["on_the_ground"] if name != "ground"], axis=0)
    pushed = [sum(size for words, size in forces.items() if way(words)[1] == axis) for axis in "xyz"]
    aside = (load - pushed)[:2]
    missing = load - held - (inside["force_n"] if inside else 0.0)
    return np.asarray(np.r_[missing, aside, held[2] - found["forces_n"]["ground"][2]]) / np.linalg.norm(load)


def _top(sizes: Floats) -> float:
    """Largest magnitude between lines, 1 / |H|^2 being a parabola there: on a line of the flank of a peak, a frequency
    that is 1e-3 off makes 1 / (2 zeta) times that."""
    n = int(sizes.argmax())
    if not 0 < n < len(sizes) - 1:
        return float(sizes.max())
    low, middle, high = sizes[n - 1 : n + 2] ** -2.0
    bend, slope = (low - 2 * middle + high) / 2, (high - low) / 2
    return float((middle - slope**2 / (4 * bend)) ** -0.5)


def _frf(rng: np.random.Generator, one: Subject) -> Case:
    """The largest response to a force, over its first mode."""
    if not one.drives:
        return _vibration(rng, one)
    _damped(rng, one)
    step = float(f"{_first(one) / 40:.3g}")
    lines = step * np.arange(20, 60)
    drive, response, kind = str(rng.choice(one.drives)), str(rng.choice(one.seen)), str(rng.choice(list(_FOLD)))
    form = one.form(one.draft)
    moved = form.shaken(lines[:1], form.load({way(drive): 1.0}), law_of(one.draft))[0]
    if abs(form.rows[way(response)] @ moved) < 1e-9 * abs(form.rows[way(drive)] @ moved):
        response = drive  # nothing couples them: both answers are rounding
    directly = ["--method", "direct"] if "from" in one.draft["damping"] else []

    def asked(model: Model, door: Door) -> Floats:
        def ask(finer: Model) -> Floats:
            words = ("--drive", drive, "--response", response, "--band", f"{lines[0]} Hz:{lines[-1]} Hz")
            found = one.ask(door, finer, "frf", *words, "--step", f"{step}", "--kind", kind, *directly)
            return np.array([_top(np.hypot(found["real"], found["imag"]))])

        answer = one.refine(model, ask)
        one.clear(door)
        return answer

    def right(model: Model, _: Door) -> Floats:
        form = one.form(model)
        moved = form.shaken(lines, form.load({way(drive): 1.0}), law_of(model)) @ form.rows[way(response)]
        return np.array([_top(np.abs(moved * (2 * pi * lines) ** _FOLD[kind]))])

    why = one.reason + "; a peak over 3 % and more of damping, between lines 1/40 of the first mode apart"
    return Case(one.draft, asked, right, 2 * one.accuracy, why, one.knobs)


def _vibration(rng: np.random.Generator, one: Subject) -> Case:
    """Acceleration and relative displacement of a place, its base shaken along an axis, over the first mode."""
    _damped(rng, one)
    kind, first = str(rng.choice(["psd", "harmonic"])), _first(one)
    words = str(rng.choice(one.seen))
    along = way(words)[1]
    band = [float(f"{first * share:.4g}") for share in (0.5, 1.5)]
    level = [0.5, 1.3] if kind == "psd" else [0.8, 0.5]
    study = {
        "model": "m.yaml", "modes": {"up_to": f"{one.reach * first:.5g} Hz"},
        "vibration": {"v": {"base": along, kind: [[f, a] for f, a in zip(band, level, strict=True)]}},
        "record": {words: ["acceleration", "displacement"]},
    }  # fmt: skip

    def asked(model: Model, door: Door) -> Floats:
        def ask(finer: Model) -> Floats:
            found = door.ask(model["study"], "run", "--no-pictures", first=one.first, m=finer, **one.beside(finer))
            answers = found["cases"]["as given"]["vibration"]["v"]["answers"]
            word = "rms" if kind == "psd" else "largest"
            keys = (f"{words} acceleration", f"{words} displacement relative to the base")
            return np.array([answers[key][word] for key in keys]) * [1.0, (2 * pi * first) ** 2]

        answer = one.refine(model["m"], ask)
        one.clear(door)
        return answer

    def right(model: Model, _: Door) -> Floats:
        said, form = model["study"]["vibration"]["v"], one.form(model["m"])
        table = np.array(said[kind], float)
        axis, driven = "xyz".index(str(said["base"])), log_log([(float(f), float(a)) for f, a in table])

        def both(lines: Floats) -> Floats:
            z = form.shaken(lines, -form.rides[axis], law_of(model["m"])) @ form.rows[way(words)]
            return np.abs([1.0 - (2 * pi * lines) ** 2 * z, z])

        lines = np.linspace(table[0, 0], table[-1, 0], 601)
        if kind == "harmonic":
            near = (both(lines) * driven(lines)).argmax(axis=1).clip(1, 599)
            closer = [np.linspace(lines[n - 1], lines[n + 1], 41) for n in near]
            found = np.array([(both(some)[row] * driven(some)).max() for row, some in enumerate(closer)])
        else:
            found = np.sqrt(np.trapezoid(both(lines) ** 2 * driven(lines), lines, axis=1))
        return np.asarray(found * [1.0, (2 * pi * first) ** 2])

    why = one.reason + "; lines 1/600 of the band apart near a peak of 3 % and more"
    between_lines = 0.0
    if kind == "harmonic":
        why = one.reason + "; the program's lines are 1/24 of half a bandwidth apart: (1/48)^2 / 2 of a peak"
        between_lines = 0.5 / 48**2
    return Case({"study": study, "m": one.draft}, asked, right, 2 * one.accuracy + between_lines, why)


_MAKES: Final = {"modes": _modes, "losses": _losses, "statics": _statics, "frf": _frf, "vibration": _vibration}
