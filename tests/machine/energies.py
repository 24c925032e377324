"""All numbers of a blow: when and how contacts push and close, how far bodies go, and where the energy is.

Windows end anywhere, in mid-blow, too: there springs of contacts hold energy.
"""

from __future__ import annotations

import functools
import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from tests.independent.contact_events import Path, Touch, rises
from tests.independent.ledgers import Ledger, ledger_at
from tests.machine.framework import Case, Door, Floats, Model, capabilities, capability
from tests.machine.impacts import NOTHING, answered, clear, given_modes, oscillator, path_of, scene, times_of
from tests.machine.laws import LAWS, between, rounded

_WHY = "both integrate to 1e-9 and better, energies of quadratures of both; draws that hang on rounding are drawn again"
_SCENES = (
    "a stack is struck", "what lies on a structure is struck", "a body below across a gap", "a preloaded contact",
    "a tuned damper on a link", "a half sine on a body or a point", "repeated blows", "a gap before the first touch",
    "the structure moves at the start", "a dashpot that closes and opens", "a link with a preload or released later",
    "a stop on both sides", "loads that come again", "blows that begin later",
)  # fmt: skip
_KNOBS = ("study.bodies", "study.contacts", "study.links", "study.loads", "structure")


def _end_of(model: Model) -> float:
    """Of the window, in whole samples."""
    return len(times_of(model)) / float(model["study"]["time"]["sampling"])


def _spans(path: Path, one: Touch) -> list[tuple[float, float]]:
    """When a contact counts as closed: a preloaded one above its preload, a stop on either side; a body that is lifted
    off opens it."""
    if one.preload:
        return rises(path, one.name)
    lifts = sorted({t for each in path.chain.again for t in each.times})
    spans = [span for side in _sides(path, one.name) for span in path.touching(side)]
    for lift in lifts:
        spans = [cut for a, b in spans for cut in ([(a, lift), (lift, b)] if a < lift < b else [(a, b)])]
    return sorted(spans)


def _sides(path: Path, name: str) -> list[str]:
    return [one.name for one in path.chain.touches if one.name in (name, f"{name} apart")]


def _separated(model: Model, rtol: float = 1e-11) -> float | None:
    """When all contacts are open for the first time, and stay so for a quiet time that the window shows."""
    path, end, quiet = path_of(model, rtol), _end_of(model), float(model["study"].get("quiet", 0.0))
    spans = [span for one in path.chain.touches for span in _spans(path, one)]
    opened = sorted(b for _, b in spans if b < end)
    for t in opened:
        touching = any(a <= t < b for a, b in spans)
        if not touching and t + quiet <= end and not any(t < a <= t + quiet for a, _ in spans):
            return t
    return None


def _energies(of: Ledger, names: Mapping[str, Any]) -> list[float]:
    """In the order of the answer; `names` : its contacts, those of a stop as one."""
    contacts = [of.contacts[name] + of.contacts.get(f"{name} apart", 0.0) for name in names]
    bodies = list(of.bodies.values())
    return [*bodies, of.structure, of.stored, of.taken, of.modes, *contacts, *of.links, of.work, of.blows]


def _answered(found: Mapping[str, Any], bodies: Mapping[str, Any], names: Mapping[str, Any]) -> list[float]:
    lost = found["lost"]
    own = [found[name] for name in bodies]
    contacts = [lost["contacts"][name] for name in names]
    spent = [found["dissipated"], lost["modes"], *contacts, *lost["links"].values()]
    return [*own, found["structure"], found["stored"], *spent, found["work"], found["blows"]]


def _names(model: Model) -> dict[str, Any]:
    return {one.name: one for one in path_of(model).chain.touches if not one.name.endswith(" apart")}


def _sizes(model: Model) -> tuple[float, float]:
    """Energy and length that others are told by."""
    return _measured(json.dumps(model))


@functools.lru_cache(maxsize=8)
def _measured(text: str) -> tuple[float, float]:
    model = json.loads(text)
    path = path_of(model)
    first = ledger_at(path, 0.0)
    end = ledger_at(path, _end_of(model))
    energy = max(first.total, abs(end.work) + abs(end.blows), end.taken)
    times = times_of(model)
    return energy, max(float(np.ptp(path.moved(name, times))) for name in path.chain.bodies)


def _alike(model: Model, name: str) -> bool:
    """Whether rounding says which push of a contact is the hardest: repeated blows, and bounces without losses."""
    path = path_of(model)
    tops = sorted(top for one in _sides(path, name) for top in path.peaks(one, _end_of(model)))
    return bool(path.chain.again) or (len(tops) > 1 and tops[-1] - tops[-2] < 1e-7 * tops[-1])


def all_numbers(model: Model, door: Door) -> Floats:
    case, (energy, length) = answered(model, door), _sizes(model)
    door.told.clear()  # of the window, of samples, of a lift in contact: none makes one of these numbers less true
    names, bodies, end = _names(model), model["study"]["bodies"], _end_of(model)
    found, contacts = case["energy"], case["contacts"]
    apart = found["at_separation"]
    out = [0.0 if _alike(model, name) else contacts[name]["peak_time_s"] / end for name in names]
    out += [contacts[name]["closings"] / 10 for name in names]
    out += [(contacts[name]["first_open_s"] or 0.0) / end for name in names]
    out += [case["bodies"][name]["travel"] / length for name in bodies]
    out += [one / energy for one in [found["input_j"], *_answered(found["end"], bodies, names)]]
    if apart is None:
        return np.array([*out, 0.0])
    return np.array([*out, apart["t_s"] / end, *(one / energy for one in _answered(apart, bodies, names))])


def all_right(model: Model, _: Door | None = None, rtol: float = 1e-11) -> Floats:
    path, (energy, length), names = path_of(model, rtol), _sizes(model), _names(model)
    end, times, bodies = _end_of(model), times_of(model), model["study"]["bodies"]
    hardest = [max((path.peak(one), path.peak_time(one, end)) for one in _sides(path, name))[1] for name in names]
    out = [0.0 if _alike(model, name) else t / end for name, t in zip(names, hardest, strict=True)]
    spans = {name: [span for span in _spans(path, one) if span[0] < end] for name, one in names.items()}
    out += [len(spans[name]) / 10 for name in names]
    out += [next((b for _, b in spans[name] if b < end), 0.0) / end for name in names]
    out += [float(np.ptp(path.moved(name, times))) / length for name in bodies]
    last, first = ledger_at(path, end), ledger_at(path, 0.0)
    out += [one / energy for one in [first.total + last.work + last.blows, *_energies(last, names)]]
    apart = _separated(model, rtol)
    if apart is None:
        return np.array([*out, 0.0])
    return np.array([*out, apart / end, *(one / energy for one in _energies(ledger_at(path, apart), names))])


def _case(draw: Any) -> Case:
    return Case(clear(draw, all_right, 3e-9), all_numbers, all_right, 1e-6, _WHY, _KNOBS)


def _cut(rng: np.random.Generator, model: dict[str, Any]) -> dict[str, Any]:
    """A window that ends anywhere in it, half of the draws."""
    time = model["study"]["time"]
    if rng.random() < 0.5:
        time["duration"] = rounded(time["duration"] * float(rng.uniform(0.15, 0.9)))
        time["sampling"] = float(np.ceil(200 / time["duration"]))
    if rng.random() < 0.5:
        model["study"]["quiet"] = rounded(time["duration"] * float(rng.uniform(0.02, 0.3)))
    return model


def _law_capability(kind: str) -> None:
    @capability(f"impacts: all numbers of a blow with a {kind} law", "independent", slow=True)
    def _(rng: np.random.Generator) -> Case:
        structure = [NOTHING, oscillator(rng), given_modes(rng)][rng.integers(3)]
        return _case(lambda: _cut(rng, scene(rng, structure, kind, turns=float(rng.uniform(1.0, 5)))))


for _kind in LAWS:
    _law_capability(_kind)


def _scene_capability(words: str) -> None:
    @capability(f"impacts: all numbers, {words}", "independent", slow=True)
    def _(rng: np.random.Generator) -> Case:
        """As another capability draws it, which compares its motions."""
        drawn = capabilities()[f"impacts: {words}"].draw
        return _case(lambda: _cut(rng, dict(drawn(rng).model)))


for _words in _SCENES:
    _scene_capability(_words)


@capability("impacts: all numbers of bounces on straight pieces", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """Under gravity, slow enough to come back several times; linear laws and tables are integrated piece by piece."""

    def draw() -> dict[str, Any]:
        structure = [NOTHING, oscillator(rng), given_modes(rng)][rng.integers(3)]
        model = scene(rng, structure, str(rng.choice(["linear", "table"])), turns=float(rng.uniform(10, 40)))
        body = model["study"]["bodies"]["a"]
        body.pop("drop_height", None)
        body["speed"] = between(rng, 0.01, 0.1)
        model["study"]["time"]["gravity"] = True
        return _cut(rng, model)

    return _case(draw)


# ---- blow by blow

_COLUMNS = ("t_s", "input_j", "impulse_ns", "peak_force_n", "closings", "structure_largest_j", "structure_left_j",
            "rest_after_s", "interval_s", "held_force_n")  # fmt: skip


def _blow_sizes(model: Model) -> Floats:
    """Of each column."""
    path, (energy, _), end = path_of(model), _sizes(model), _end_of(model)
    impulse = 2 * path.chain.bodies["a"] * abs(path.chain.start["a"])
    force = max(path.peak(one.name) for one in path.chain.touches)
    return np.array([end, energy, impulse, force, 10.0, energy, energy, end, end, force])


def blows(model: Model, door: Door) -> Floats:
    found = answered(model, door)["blows"]["a"]
    door.told.clear()  # as above
    table = np.array([[one or 0.0 for one in found[key]] for key in _COLUMNS])
    return np.asarray((table / _blow_sizes(model)[:, None]).ravel())


def blows_right(model: Model, _: Door | None = None, rtol: float = 1e-11) -> Floats:
    path, end, rate = path_of(model, rtol), _end_of(model), float(model["study"]["time"]["sampling"])
    (again,), touch, modes, n = path.chain.again, path.chain.touches[0], len(path.chain.omega), path.chain.size
    at = [*([] if again.late else [0.0]), *(t for t in again.times if t < end)]
    times, every = times_of(model), model["study"]["bodies"]["a"]["blows"]["every"]
    states, omega = path.at(times), np.array(path.chain.omega)
    energy = (states[n : n + modes] ** 2).sum(axis=0) / 2 + ((omega[:, None] * states[:modes]) ** 2).sum(axis=0) / 2
    mass, start = path.chain.bodies["a"], path.chain.start["a"]
    columns = []
    for number, t in enumerate(at):
        until = at[number + 1] if number + 1 < len(at) else t + every
        low, high = (int(np.ceil(one * rate - 1e-6)) for one in (t, min(until, end)))
        own = energy[low:high]
        loud = np.flatnonzero(own > 0.01 * own.max(initial=0.0))
        quiet = int(loud[-1]) + 1 if loud.size else 0
        before = path.speed("a", np.array([t]))[0] if t else 0.0
        brought = ledger_at(path, min(until, end)).blows - ledger_at(path, t).blows if t else mass * start**2 / 2
        last = number + 1 == len(at)
        columns.append([
            t, brought, mass * (start - before), path.peak(touch.name, t, np.inf if last else until),
            sum(t <= a < (np.inf if last else until) for a, _ in _spans(path, touch) if a < end), own.max(initial=0.0),
            own[-1] if own.size else 0.0, low / rate - t + quiet / rate if quiet < len(own) else 0.0,
            min(until, end) - t, 0.0 if last else path.force(touch.name, np.array([until]))[0],
        ])  # fmt: skip
    return np.asarray((np.array(columns).T / _blow_sizes(model)[:, None]).ravel())


@capability("impacts: blow by blow", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    """What each brings, how hard it is, and what the structure has of it until the next."""
    drawn = capabilities()[f"impacts: {rng.choice(['repeated blows', 'blows that begin later'])}"].draw
    model = clear(lambda: dict(drawn(rng).model), blows_right, 3e-9)
    return Case(model, blows, blows_right, 1e-6, _WHY, _KNOBS)
