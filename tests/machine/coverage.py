"""Where checks reach: keys of the language crossed with the answers they can change.

A cell is covered when a change of its key by 10 %, or to its other word, in a drawn model moves the independent answer
by more than ten tolerances and the program follows within one.
"""

from __future__ import annotations

import copy
import json
import re
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np

from tests.data.command_line import femstruct
from tests.machine.framework import Capability, Case, Door, Floats, Model

STORED: Final = Path(__file__).resolve().parents[1] / "data" / "coverage.json"
COLUMNS: Final = ("modes", "losses", "statics", "frf", "vibration", "impacts", "levels")
_STATED: Final = {
    "model": ("materials", "sections", "parts", "joints", "supports", "constraints", "damping", "structure"),
    "study": ("bodies", "contacts", "links", "loads", "rooms", "vibration"),
}
_PLACES: Final = ("RegionSpec", "OthersSpec")  # where: one key, however it is written
_SAYS_HOW: Final = ("mesh", "modes", "through", "order")  # how finely, not what
_LOSES: Final = ("loss_factor", "damping", "ratio", "rayleigh", "dissipation", "losses")
_QUANTITY: Final = re.compile(r"^\s*([+-]?[\d.]+(?:[eE][+-]?\d+)?)\s*(\D.*)$")  # a number and its unit
Path_ = tuple[Any, ...]
Schema = Mapping[str, Any]


@cache
def schema(kind: str) -> Any:
    return json.loads(femstruct("schema", kind).stdout)


class _Noted(dict[str, Any]):
    """An answer of `modes` whose damping ratios, where they are looked at, are losses."""

    def __init__(self, answer: Mapping[str, Any], columns: set[str]) -> None:
        super().__init__(answer)
        self._columns = columns

    def __getitem__(self, key: str) -> Any:
        if key == "damping_ratio":
            self._columns -= {"modes"}
            self._columns |= {"losses"}
        return super().__getitem__(key)


@dataclass
class _Watched(Door):
    """Knows what it was asked for."""

    columns: set[str] = field(default_factory=set)

    def ask(self, model: Model, command: str, *words: str, **more: Any) -> dict[str, Any]:
        self.columns |= _columns(model, command, words)
        return _Noted(super().ask(model, command, *words, **more), self.columns)

    def histories(self, model: Model, **beside: Model) -> dict[str, Floats]:
        self.columns |= _columns(model, "run", ())
        return super().histories(model, **beside)


def _columns(model: Model, command: str, words: Sequence[str]) -> set[str]:
    if command in ("run", "impact", "sound") and "rooms" in model:  # what is asked of a blow in a room is its sound
        return {"levels"}
    if command in ("run", "impact", "sound"):
        named = {
            "vibration": "vibration",
            "bodies": "impacts",
            "loads": "impacts",
            "initial": "impacts",
        }
        return {column for key, column in named.items() if key in model}
    if command == "modes" and "--complex" in words:
        return {"losses"}
    return {command} & set(COLUMNS)


def _branches(node: Schema, root: Schema) -> Iterator[Schema]:
    """What a value may be, references followed."""
    if "$ref" in node:
        node = root["$defs"][node["$ref"].rsplit("/", 1)[1]]
    options = node.get("anyOf", node.get("oneOf"))
    if options is None:
        yield node
    else:
        for one in options:
            yield from _branches(one, root)


def _word(node: Schema) -> str:
    """The word by which a kind of thing is told, such as frame."""
    found = [node.get("properties", {}).get(key, {}).get("const") for key in ("type", "shape")]
    return next((str(one) for one in found if one), "")


def _is(node: Schema, value: Any) -> bool:
    if isinstance(value, Mapping):
        keys = node.get("properties")
        if keys is None:
            return "additionalProperties" in node
        said = all(keys[key].get("const", value[key]) == value[key] for key in value if key in keys)
        return said and set(value) <= set(keys) and set(node.get("required", ())) <= set(value)
    if isinstance(value, list | tuple):
        return node.get("type") == "array"
    if isinstance(value, str):
        said = node.get("enum", ())
        return value in said or (node.get("type") == "string" and _QUANTITY.match(value) is not None)
    return node.get("type") in ("number", "integer")


def leaves(value: Any, node: Schema, root: Schema, name: str, path: Path_) -> Iterator[tuple[str, Path_, Schema]]:
    """Numbers and words of a value: the key that each stands under, where, and what it may be."""
    fits = [one for one in _branches(node, root) if _is(one, value)]
    if not fits:
        return
    kind = fits[0]
    if isinstance(value, Mapping):
        base = f"{name} {_word(kind)}".strip()
        for key, one in value.items():
            if key in kind.get("properties", {}):
                inside = name if kind.get("title") in _PLACES else f"{base}.{key}"
                yield from leaves(one, kind["properties"][key], root, inside, (*path, key))
            elif isinstance(kind.get("additionalProperties"), Mapping):
                yield from leaves(one, kind["additionalProperties"], root, name, (*path, key))
    elif isinstance(value, list | tuple):
        each = kind.get("prefixItems", [kind.get("items", {})] * len(value))
        for place, one in enumerate(value):
            yield from leaves(one, each[min(place, len(each) - 1)], root, name, (*path, place))
    else:
        yield name, path, kind


def keys_of(node: Schema, root: Schema, name: str, seen: tuple[str, ...] = ()) -> Iterator[str]:
    """All keys of numbers and words below a node of a schema."""
    for kind in _branches(node, root):
        if str(kind.get("title")) in seen and kind.get("properties"):
            continue
        inside = (*seen, str(kind.get("title")))
        if "properties" in kind:
            base = f"{name} {_word(kind)}".strip()
            for key, one in kind["properties"].items():
                if key not in _SAYS_HOW:
                    below = name if kind.get("title") in _PLACES else f"{base}.{key}"
                    yield from keys_of(one, root, below, inside)
        elif kind.get("type") == "array":
            for one in kind.get("prefixItems", [kind.get("items", {})]):
                yield from keys_of(one, root, name, seen)
        elif isinstance(kind.get("additionalProperties"), Mapping):
            yield from keys_of(kind["additionalProperties"], root, name, seen)
        elif kind.get("type") in ("number", "integer") or len(kind.get("enum", ())) > 1:
            yield name


def cells() -> list[tuple[str, str]]:
    """Keys and the answers they can change: what loses energy does not change modes and statics, a law only blows."""
    found = []
    for kind, stated in _STATED.items():
        root = schema(kind)
        for top in stated:
            node = root["properties"][top]
            names = dict.fromkeys(keys_of(node, root, top))
            for name in names:
                found += [(name, column) for column in _can_change(kind, top, name)]
    return found


def _can_change(kind: str, top: str, name: str) -> tuple[str, ...]:
    if name.startswith("bodies.covering"):
        return ("levels",)
    if kind == "study":
        return {"vibration": ("vibration",), "rooms": ("levels",)}.get(top, ("impacts",))
    if top == "structure":
        return ("modes", "frf", "impacts")
    if any(word in name.split(".")[1:] for word in _LOSES) or top == "damping":
        return ("losses", "frf", "vibration")
    return ("modes", "statics", "frf", "vibration")


def changes(model: Model) -> Iterator[tuple[str, Model]]:
    """Each key of a model, or of what is beside it, and the model with that changed by 10 % or to its other word."""
    for kind, path, part in _documents(model, ()):
        root = schema(kind)
        for top in _STATED[kind]:
            if top not in part:
                continue
            for name, where, node in leaves(part[top], root["properties"][top], root, top, (*path, top)):
                yield from ((name, one) for one in _other(model, path, where, node))


def _documents(value: Any, path: Path_) -> Iterator[tuple[str, Path_, Mapping[str, Any]]]:
    if not isinstance(value, Mapping):
        return
    closed = value.get("structure")
    if "parts" in value or isinstance(closed, str) or (isinstance(closed, Mapping) and "type" in closed):
        yield "model", path, value
    elif {"bodies", "vibration", "loads", "time", "rooms"} & set(value):
        yield "study", path, value
    else:
        for key, one in value.items():
            yield from _documents(one, (*path, key))


def _other(model: Model, document: Path_, where: Path_, node: Schema) -> Iterator[Model]:
    if "lines" in where:
        if where[-3:] == (0, 0, 0):
            yield _stretched(model, document)
        return
    if "outline" in where:
        if where[-2:] == (0, 0):
            yield _widened(model, where[:-2])
        return
    fresh: Any = copy.deepcopy(model)
    there = fresh
    for key in where[:-1]:
        there = there[key]
    value = there[where[-1]]
    if isinstance(value, str) and "enum" not in node:
        found = _QUANTITY.match(value)
        assert found is not None
        there[where[-1]] = f"{1.1 * float(found[1])!r} {found[2]}"
        yield fresh
    elif isinstance(value, str):
        for word in node["enum"]:
            if word != value:
                there[where[-1]] = word
                yield copy.deepcopy(fresh)
    elif value and not isinstance(value, bool):
        there[where[-1]] = value + 1 if isinstance(value, int) and node.get("type") == "integer" else value * 1.1
        yield fresh


def _widened(model: Model, outline: Path_) -> Model:
    """All corners of an outline farther out, so that its sides stay along x and y."""
    fresh: Any = copy.deepcopy(model)
    there = fresh
    for key in outline[:-1]:
        there = there[key]
    there[outline[-1]] = (1.1 * np.array(there[outline[-1]])).tolist()
    return fresh


def _stretched(model: Model, document: Path_) -> Model:
    """All lines of frames, and points, longer."""
    fresh: Any = copy.deepcopy(model)
    there = fresh
    for key in document:
        there = there[key]
    for part in there["parts"].values():
        if "lines" in part:
            part["lines"] = [(np.array(line) * 1.1).tolist() for line in part["lines"]]
    for point in there.get("points", {}).values():
        if there["parts"].get(point.get("on"), {}).get("type") == "frame":
            point["at"] = (np.array(point["at"]) * 1.1).tolist()
    return fresh


@dataclass(frozen=True)
class Reached:
    """A key and an answer, by which check; off : how far the program is from the moved answer, in tolerances."""

    key: str
    column: str
    capability: str
    seed: int
    index: int
    off: float


def reached(
    one: Capability, seed: int, index: int, wanted: frozenset[str] | None = None, end: float = np.inf,
    have: frozenset[tuple[str, str]] = frozenset(),
) -> list[Reached]:  # fmt: skip
    """Cells that a check reaches. wanted : these keys alone; have : cells that are not asked again; off above 1 : the
    program did not follow."""
    case, found, done, asked = one.case(seed, index), [], set(), _Watched()
    before = _flat(case.right(case.model, Door()))
    if have:
        case.asked(case.model, asked)
    for key, model in changes(case.model):
        if key in done or (wanted is not None and key not in wanted) or time.monotonic() > end:
            continue
        if have and all((key, column) in have for column in asked.columns):
            continue
        off, columns = _follows(case, model, before)
        if off is not None:
            done.add(key)
            found += [Reached(key, column, one.name, seed, index, off) for column in sorted(columns)]
    return found


def _follows(case: Case, model: Model, before: Floats) -> tuple[float | None, set[str]]:
    """How far the program is from an answer that has moved; None where it has not, or there is none."""
    door = _Watched()
    try:
        after = _flat(case.right(model, Door()))
        scale = case.tolerance * float(np.abs(after).max(initial=0.0))
        if after.shape != before.shape or not np.abs(after - before).max(initial=0.0) > 10 * scale > 0:
            return None, set()
        got = _flat(case.asked(model, door))
    except Exception:  # refused, or nothing that the reference can be asked
        return None, set()
    if got.shape != after.shape or not np.isfinite(got).all() or (door.told and not np.abs(got - after).max() <= scale):
        return None, set()
    return float(np.abs(got - after).max()) / scale, door.columns


def _flat(answer: Any) -> Floats:
    return np.atleast_1d(np.asarray(answer, dtype=float)).ravel()


def survey(chosen: Sequence[Capability], seed: int, seconds: float, count: int = 2) -> Iterator[list[Reached]]:
    """Cells that capabilities with an independent answer reach, check by check, within a time."""
    end = time.monotonic() + seconds
    have = {(key, column) for key, _, column in (cell.partition(" | ") for cell in stored())}
    for index in range(count):
        for one in chosen:
            if one.kind == "independent" and time.monotonic() < end:
                found = _all_of(one, seed, index, end, frozenset(have))
                have |= {(cell.key, cell.column) for cell in found if cell.off <= 1}
                yield found


def _all_of(one: Capability, seed: int, index: int, end: float, have: frozenset[tuple[str, str]]) -> list[Reached]:
    """Nothing of a case that cannot be drawn or is refused."""
    try:
        found = reached(one, seed, index, end=end, have=have)
    except Exception:  # what is wrong with the case is for `running` to say
        return []
    return [cell for cell in found if (cell.key, cell.column) not in have]


def stored() -> dict[str, list[Any]]:
    """Cells that were reached, "KEY | ANSWER", and by which check: capability, seed, index."""
    kept: dict[str, list[Any]] = json.loads(STORED.read_text(encoding="utf-8"))
    return kept


def keep(found: Sequence[Reached]) -> None:
    """More cells in the stored list; none is taken out."""
    kept = stored() if STORED.exists() else {}
    for cell in found:
        if cell.off <= 1:
            kept.setdefault(f"{cell.key} | {cell.column}", [cell.capability, cell.seed, cell.index])
    STORED.write_text(json.dumps(dict(sorted(kept.items())), indent=0) + "\n", encoding="utf-8")


def table(covered: frozenset[tuple[str, str]]) -> str:
    """x where a check reaches, o where none does yet, blank where no answer is expected to change; the share of all."""
    every = cells()
    rows = ["x: a change of the key moves this answer, and the program follows; o: not shown yet; blank: not asked for"]
    rows += [f"{'key':56} {' '.join(COLUMNS)}"]
    for name in dict.fromkeys(name for name, _ in every):
        can = [column for key, column in every if key == name]
        marks = [
            "" if c not in can and (name, c) not in covered else "x" if (name, c) in covered else "o" for c in COLUMNS
        ]
        rows.append(
            f"{name:56} {' '.join(f'{mark:{len(c)}}' for mark, c in zip(marks, COLUMNS, strict=True))}".rstrip()
        )
    there = len(set(every) & covered)
    return "\n".join(
        [
            *rows,
            f"covered {there} of {len(every)} cells, {there / len(every):.0%}; {len(covered - set(every))} beside them",
        ]
    )
