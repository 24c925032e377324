"""Cases and overrides as edits of one tree: the paths of a study and of its model together."""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping
from functools import cache
from typing import Any, Final

from femstruct.language.model.model import ModelSpec
from femstruct.language.yaml.reader import Mistakes, Position, Steps, Tree, dotted, nearest
from femstruct.units import shown_as

MODEL_KEYS: Final = frozenset(ModelSpec.model_fields) - {"title"}
_NAMED: Final = (  # top-level mappings from names: a new name is an addition, never a slip
    "materials", "sections", "parts", "joints", "points", "surfaces", "supports",
    "frf", "bodies", "contacts", "links", "loads", "rooms", "cases",
)  # fmt: skip
_NAMED_INSIDE: Final = (("damping", "modes"),)
_INDEX: Final = re.compile("[0-9]{1,6}")


@cache
def study_keys() -> frozenset[str]:
    """The keys of a study file; who reads a model alone has no need to load its schema."""
    from femstruct.language.study.study import StudySpec

    return frozenset(StudySpec.model_fields) - {"title"}


class Draft:
    """A tree being edited: what a case makes of a file."""

    def __init__(self, tree: Tree) -> None:
        self.file, self.text = tree.file, tree.text
        self.value: dict[str, Any] = copy.deepcopy(tree.value)
        self.keys, self.values = dict(tree.keys), dict(tree.values)

    def tree(self) -> Tree:
        """The tree as it is now."""
        return Tree(self.file, self.value, self.keys, self.values, self.text)

    def put(self, steps: Steps, value: Any, source: Tree, source_steps: Steps) -> None:
        """Set the value at a path; its positions are those it has in its source."""
        parent = self.at(steps[:-1])
        parent[steps[-1]] = copy.deepcopy(value)
        self._forget(steps)
        self.keys[steps] = source.position(source_steps, of_key=True)
        size = len(source_steps)
        for known, here in ((source.keys, self.keys), (source.values, self.values)):
            for path, position in known.items():
                if path[:size] == source_steps and (len(path) > size or known is source.values):
                    here[steps + path[size:]] = position

    def drop(self, steps: Steps) -> None:
        """Remove the value at a path, if it is there."""
        parent = self.at(steps[:-1])
        if isinstance(parent, dict) and steps[-1] in parent:
            del parent[steps[-1]]
            self._forget(steps)

    def at(self, steps: Steps) -> Any:
        """The value at a path."""
        value: Any = self.value
        for step in steps:
            value = value[step]
        return value

    def _forget(self, steps: Steps) -> None:
        for known in (self.keys, self.values):
            for path in [path for path in known if path[: len(steps)] == steps]:
                del known[path]


class Patch:
    """Both trees of a study while a case changes them, and the record of what it changed."""

    def __init__(self, study: Tree | None, model: Tree | None, mistakes: Mistakes) -> None:
        self.study = Draft(study) if study else None
        self.model = Draft(model) if model else None
        self.mistakes = mistakes
        self.changes: dict[str, str] = {}

    def draft(self, path: str) -> Draft | None:
        """The tree a path belongs to: its first key tells."""
        first = path.split(".", 1)[0]
        if self.study is None or (self.model is not None and first in MODEL_KEYS):
            return self.model
        return self.study

    def case(self, changes: Mapping[str, Any], source: Tree, at: Steps) -> None:
        """Apply a case: values, then `remove`, then `add`."""
        for key, value in changes.items():
            if key not in ("add", "remove", "model"):
                self.assign(key, value, source, (*at, key))
        self._remove_all(changes.get("remove", []), source, (*at, "remove"))
        added = changes.get("add", {})
        if not isinstance(added, dict):
            self._refuse(source, (*at, "add"), got=shown_as(added), expected="a mapping of new paths to values")
            return
        for key, value in added.items():
            self.add(key, value, source, (*at, "add", key))

    def assign(self, path: str, value: Any, source: Tree, at: Steps) -> None:
        """Set what a path names to a value; a mapping patches a mapping."""
        draft = self.draft(path)
        steps = self._find(draft, path, source, at, may_be_new=True) if draft else None
        if draft is None or steps is None:
            return
        self.changes[path] = _told(value)
        self._merge(draft, steps, value, source, at)

    def _merge(self, draft: Draft, steps: Steps, value: Any, source: Tree, at: Steps) -> None:
        parent = draft.at(steps[:-1])
        old = parent.get(steps[-1]) if isinstance(parent, dict) else parent[steps[-1]]
        if not (isinstance(old, dict) and isinstance(value, dict)):
            draft.put(steps, value, source, at)
            return
        for key, item in value.items():
            if key not in old and _is_named(steps):
                self._unknown(dotted((*steps, key)), key, old, source, (*at, key), new=True)
                continue
            self._merge(draft, (*steps, key), item, source, (*at, key))

    def add(self, path: str, value: Any, source: Tree, at: Steps) -> None:
        """Put something new at a path."""
        draft = self.draft(path)
        if draft is None:
            return
        parent_text, _, name = path.rpartition(".")
        first = path.split(".", 1)[0]
        if first not in (MODEL_KEYS | study_keys()):
            self._unknown(path, first, MODEL_KEYS | study_keys(), source, at)
            return
        if parent_text == first and first in _NAMED:
            self._create(draft, first, source, at)
        steps = _resolve(draft.value, path)
        if steps is not None:
            self._refuse(source, at, got=f"'{path}', which is there already", expected="a new path", do="set its value")
            return
        parent = self._find(draft, parent_text, source, at) if parent_text else ()
        if parent is None:
            return
        if not isinstance(draft.at(parent), dict):
            self._refuse(source, at, got=f"'{path}'", expected="a path into a mapping")
            return
        draft.put((*parent, name), value, source, at)
        self.changes[path] = f"added: {_told(value)}"

    def _create(self, draft: Draft, first: str, source: Tree, at: Steps) -> None:
        if not isinstance(draft.value.get(first), dict):
            draft.value[first] = {}
            draft.keys[first,] = draft.values[first,] = source.position(at, of_key=True)

    def _remove_all(self, paths: Any, source: Tree, at: Steps) -> None:
        listed = paths if isinstance(paths, list) else [paths]
        for number, path in enumerate(listed):
            here = (*at, number) if isinstance(paths, list) else at
            if not isinstance(path, str):
                self._refuse(source, here, got=shown_as(path), expected="a path", do="write it like [bodies.damper]")
                continue
            draft = self.draft(path)
            steps = self._find(draft, path, source, here) if draft else None
            if draft is None or steps is None:
                continue
            if isinstance(steps[-1], int):
                self._refuse(source, here, got=f"'{path}'", expected="a key of a mapping", do="set the whole list")
                continue
            draft.drop(steps)
            self.changes[path] = "removed"
            if len(steps) == 2:
                self._drop_dependents(str(steps[0]), str(steps[1]))

    def _drop_dependents(self, kind: str, name: str) -> None:
        """What cannot be without the thing removed: a body's contacts, links, loads; anything's records,
        their limits, and FRFs."""
        gone = {name}
        study = self.study
        if study is not None and kind == "bodies":
            for group in ("contacts", "links"):
                for other, spec in list(_mapping(study.value, group).items()):
                    ends = spec.get("between") if isinstance(spec, dict) else None
                    if isinstance(ends, list) and name in ends:
                        study.drop((group, other))
                        gone.add(other)
            for other, spec in list(_mapping(study.value, "loads").items()):
                if isinstance(spec, dict) and spec.get("body") == name:
                    study.drop(("loads", other))
        if self.model is not None and kind == "parts":
            for other, spec in list(_mapping(self.model.value, "joints").items()):
                ends = spec.get("connect") if isinstance(spec, dict) else None
                if isinstance(ends, list) and name in ends:
                    self.model.drop(("joints", other))
                    gone.add(other)
        if study is None or kind in ("materials", "sections", "frf", "cases"):
            return
        dropped = {name} if kind in ("record", "rooms") else set()
        for target in list(_mapping(study.value, "record")):
            owner = target.rpartition(".")[0] or target
            if owner in gone or target in gone or (kind == "bodies" and target.startswith(f"{name} on ")):
                study.drop(("record", target))
                dropped.add(target)
        for limit in list(_mapping(study.value, "limits")):
            if limit.rpartition(" ")[0] in dropped:
                study.drop(("limits", limit))
        for request, spec in list(_mapping(study.value, "frf").items()):
            if isinstance(spec, dict) and any(
                str(spec.get(side, "")).rpartition(".")[0] in gone for side in ("drive", "response")
            ):
                study.drop(("frf", request))

    def _find(self, draft: Draft | None, path: str, source: Tree, at: Steps, may_be_new: bool = False) -> Steps | None:
        """The steps of a path; an unknown one is noted with the nearest key, and None returned."""
        if draft is None:
            return None
        steps = _resolve(draft.value, path)
        if steps:
            return steps
        parent_text, _, last = path.rpartition(".")
        first = path.split(".", 1)[0]
        if may_be_new and parent_text == first and first in MODEL_KEYS | study_keys() and first not in _NAMED:
            self._create(draft, first, source, at)
        parent = _resolve(draft.value, parent_text) if parent_text else ()
        if parent is not None and isinstance(draft.at(parent), dict):
            own_top = parent or last in MODEL_KEYS | study_keys()
            if may_be_new and own_top and not _is_named(parent) and "[" not in last:
                return (*parent, last)  # the schema knows whether there is such a key
            known = draft.at(parent) or {}
            self._unknown(path, last, known if parent else MODEL_KEYS | study_keys(), source, at, new=_is_named(parent))
            return None
        reached, rest = _reach(draft.value, path)
        known = draft.at(reached) if reached else MODEL_KEYS | study_keys()
        self._unknown(path, rest.split(".", 1)[0], known if isinstance(known, dict | frozenset) else (), source, at)
        return None

    def _unknown(self, path: str, word: str, known: Any, source: Tree, at: Steps, new: bool = False) -> None:
        hint = nearest(word, known)
        do = "; ".join(text for text in (hint, "a new one goes under 'add:'" if new else "") if text)
        self._refuse(source, at, got=f"the path '{path}', which does not exist", expected="a path of the files", do=do)

    def _refuse(self, source: Tree, at: Steps, *, got: str, expected: str, do: str = "") -> None:
        position: Position = source.position(at, of_key=True)
        path = "" if at == ("value",) else dotted(at)  # an override has no path in a file
        self.mistakes.add(position, path, got=got, expected=expected, do=do)


def _mapping(value: Mapping[str, Any], key: str) -> dict[str, Any]:
    found = value.get(key)
    return found if isinstance(found, dict) else {}


def _is_named(steps: Steps) -> bool:
    return (len(steps) == 1 and steps[0] in _NAMED) or steps in _NAMED_INSIDE


def _told(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_told(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_told(item) for item in value) + "]"
    return shown_as(value).strip("'")


def _resolve(value: Any, path: str) -> Steps | None:
    """Steps of a dotted path in a tree, keys that contain dots included; None when it does not lead anywhere.

    >>> _resolve({"record": {"O_s.z": ["velocity"]}}, "record.O_s.z[0]")
    ('record', 'O_s.z', 0)
    """
    steps, rest = _reach(value, path)
    return steps if not rest else None


def _reach(value: Any, path: str) -> tuple[Steps, str]:
    """How far a path leads: the steps that exist, and the rest of the text."""
    steps: list[str | int] = []
    rest = path.replace("[", ".").replace("]", "")
    while rest:
        pieces = rest.split(".")
        if isinstance(value, dict):
            longest = next((n for n in range(len(pieces), 0, -1) if ".".join(pieces[:n]) in value), 0)
            if not longest:
                break
            step: str | int = ".".join(pieces[:longest])
        elif isinstance(value, list) and _INDEX.fullmatch(pieces[0]) and int(pieces[0]) < len(value):
            longest, step = 1, int(pieces[0])
        else:
            break
        value = value[step]
        steps.append(step)
        rest = ".".join(pieces[longest:])
    return tuple(steps), rest
