"""Cases and overrides as edits of one tree: the paths of a study and of its model together."""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, Final, get_origin

from femstruct.errors import list_some, quote_value
from femstruct.language.model_file import ModelSpec
from femstruct.language.not_computed import FALLING_PARTS
from femstruct.yaml.reader import Here, Mistakes, Steps, Tree, dotted, mapping_in, nearest
from femstruct.yaml.spec import Spec, names_at, references

MODEL_KEYS: Final = frozenset(ModelSpec.model_fields) - {"title"}
_CHANNELS: Final = ("record", "limits")  # top-level mappings from channels, which have dots
_NAMED_INSIDE: Final = (("damping", "modes"),)
_OF_ALL_CASES: Final = ("cases", "compare", "vary", "samples", "optimise")
_INDEX: Final = re.compile("[0-9]{1,6}")


@cache
def study_schema() -> type[Spec]:
    """The schema of a study file, which who reads a model alone has no need to load."""
    from femstruct.language.studies import StudySpec

    return StudySpec


def study_keys() -> frozenset[str]:
    """The keys of a study file."""
    return frozenset(study_schema().model_fields) - {"title"}


@cache
def groups(schema: type[Spec]) -> tuple[str, ...]:
    """The top-level mappings from names: a new name there is an addition, never a slip."""
    mappings = [key for key, field in schema.model_fields.items() if get_origin(field.annotation) is dict]
    return tuple(key for key in mappings if key not in (*_CHANNELS, "vary"))


def _is_group(key: str | int) -> bool:
    return key in groups(ModelSpec) or key in groups(study_schema())


class Draft:
    """A tree being edited: what a case makes of a file."""

    def __init__(self, tree: Tree) -> None:
        self.file, self.text = tree.file, tree.text
        self.value: dict[str, Any] = copy.deepcopy(tree.value)
        self.keys, self.values = dict(tree.keys), dict(tree.values)

    def tree(self) -> Tree:
        """The tree as it is now."""
        return Tree(self.file, self.value, self.keys, self.values, self.text)

    def put(self, steps: Steps, value: Any, there: Here) -> None:
        """Set the value at a path to one that stands elsewhere; its positions are those it has there."""
        self.at(steps[:-1])[steps[-1]] = copy.deepcopy(value)
        self._forget(steps)
        self.keys[steps] = there.tree.position(there.steps, of_key=True)
        size = len(there.steps)
        for known, here in ((there.tree.keys, self.keys), (there.tree.values, self.values)):
            own = known.items() if known is there.tree.values else ((p, at) for p, at in known.items() if len(p) > size)
            here |= {steps + path[size:]: position for path, position in own if path[:size] == there.steps}

    def drop(self, steps: Steps) -> None:
        """Remove the value at a path, if it is there."""
        parent = self.at(steps[:-1])
        if isinstance(parent, dict) and parent.pop(steps[-1], self) is not self:
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
    """Both trees of a study while a case changes them, and the record of what it changed.

    What its functions call `there` is where a change is written.
    """

    def __init__(self, study: Tree | None, model: Tree | None, mistakes: Mistakes) -> None:
        self.study = Draft(study) if study else None
        self.model = Draft(model) if model else None
        self.mistakes = mistakes
        self.keys = MODEL_KEYS if study is None else MODEL_KEYS | study_keys()
        self.changes: dict[str, str] = {}

    def draft(self, path: str) -> Draft | None:
        """The tree a path belongs to: its first key tells."""
        of_model = self.model is not None and path.split(".", 1)[0] in MODEL_KEYS
        return self.model if self.study is None or of_model else self.study

    def case(self, changes: Mapping[str, Any], there: Here) -> None:
        """Apply a case: values, then `remove`, then `add`."""
        for key in [key for key in changes if key not in ("add", "remove", "model")]:
            first, own = key.partition(".")[0], there.at(key)
            got, do = f"'{first}' in a case", f"'{first}:' is for all cases: move it out of 'cases:'"
            if own.need(first not in _OF_ALL_CASES, got, "what a case can change", do, of_key=True):
                self.assign(key, changes[key], own)
        listed, removed = changes.get("remove", []), there.at("remove")
        for number, path in enumerate(listed if isinstance(listed, list) else [listed]):
            self._remove(path, removed.at(number) if isinstance(listed, list) else removed)
        added = changes.get("add", {})
        if not isinstance(added, dict):
            there.at("add").wrong(quote_value(added), "a mapping of new paths to values", of_key=True)
            return
        for key, value in added.items():
            self.add(key, value, there.at("add", key))

    def assign(self, path: str, value: Any, there: Here, of_cases: bool = False) -> None:
        """Set what a path names to a value; a mapping patches a mapping.

        Parameters
        ----------
        of_cases : bool
            Whether it may be what cases add.
        """
        draft = self.draft(path)
        steps = self._find(draft, path, there, may_be_new=True, of_cases=of_cases)
        if draft is not None and steps is not None:
            self.changes[path] = _value_text(value)
            self._merge(draft, steps, value, there)

    def _merge(self, draft: Draft, steps: Steps, value: Any, there: Here) -> None:
        parent = draft.at(steps[:-1])
        old = parent.get(steps[-1]) if isinstance(parent, dict) else parent[steps[-1]]
        if not (isinstance(old, dict) and isinstance(value, dict)):
            draft.put(steps, value, there)
            return
        for key, item in value.items():
            if key not in old and _is_named(steps):
                self._unknown(dotted((*steps, key)), steps, key, draft, there.at(key))
            else:
                self._merge(draft, (*steps, key), item, there.at(key))

    def add(self, path: str, value: Any, there: Here) -> None:
        """Put something new at a path."""
        draft, first = self.draft(path), path.partition(".")[0]
        if draft is None:
            return
        if first in _CHANNELS or (_is_group(first) and path.count(".") == 1):
            _create(draft, first, there)
        steps, rest = _reach(draft.value, path)
        if steps and not rest:
            there.wrong(f"'{path}', which is there already", "a new path", "set its value", of_key=True)
        elif ("." in rest and not _of_channels(steps)) or (not steps and rest not in self.keys):
            self._unknown(path, steps, rest, draft, there)
        elif there.need(isinstance(draft.at(steps), dict), f"'{path}'", "a path into a mapping", of_key=True):
            draft.put((*steps, rest), value, there)
            self.changes[path] = f"added: {_value_text(value)}"

    def _remove(self, path: Any, there: Here) -> None:
        if not there.need(
            isinstance(path, str), quote_value(path), "a path", "write it like [bodies.damper]", of_key=True
        ):
            return
        draft = self.draft(path)
        steps = self._find(draft, path, there)
        if draft is None or steps is None:
            return
        if there.need(
            not isinstance(steps[-1], int), f"'{path}'", "a key of a mapping", "set the whole list", of_key=True
        ):
            draft.drop(steps)
            self.changes[path] = "removed"
            if len(steps) == 2:
                self._drop_dependents(str(steps[0]), str(steps[1]))

    def _drop_dependents(self, kind: str, name: str) -> None:
        """What cannot be without the thing removed: what refers to it and goes with it; anything's records, their
        limits, and FRFs."""
        removed, study = {name}, self.study
        for draft, schema in ((study, study_schema), (self.model, lambda: ModelSpec)):
            if draft is not None:
                going = [one.path for one in references(schema()) if one.refers.goes_with == kind]
                for owner in {
                    steps[:2] for path in going for steps, used in names_at(draft.value, path) if used == name
                }:
                    draft.drop(owner)
                    removed.add(str(owner[1]))
        if study is None or kind in ("materials", "sections", "frf", "cases"):
            return
        dropped = {name} if kind in ("record", "rooms") else set()
        for target in list(mapping_in(study.value, "record")):
            own = kind == "bodies" and target.startswith(f"{name} on ")
            if own or not removed.isdisjoint((target, target.rpartition(".")[0])):
                study.drop(("record", target))
                dropped.add(target)
        for limit in list(mapping_in(study.value, "limits")):
            if limit.rpartition(" ")[0] in dropped:
                study.drop(("limits", limit))
        for request, spec in list(mapping_in(study.value, "frf").items()):
            ends = [str(spec.get(side, "")) for side in ("drive", "response")] if isinstance(spec, dict) else []
            if any(end.rpartition(".")[0] in removed for end in ends):
                study.drop(("frf", request))

    def added_by_cases(self, path: str) -> tuple[str, ...]:
        """Where cases add what a path names, if the files themselves do not have it.

        >>> tree = Tree("s", {"cases": {"damped": {"add": {"bodies.damper": {"mass": "1 kg"}}}}}, {}, {}, "")
        >>> Patch(tree, None, Mistakes()).added_by_cases("bodies.damper.mass")
        ('cases.damped.add.bodies.damper.mass',)
        """
        draft = self.draft(path)
        if draft is None or self.study is None or not _reach(draft.value, path)[1]:
            return ()
        cases = {name: case for name, case in mapping_in(self.study.value, "cases").items() if isinstance(case, dict)}
        found = (name for name, case in cases.items() if not _reach(mapping_in(case, "add"), path)[1])
        return tuple(f"cases.{name}.add.{path}" for name in found)

    def refuse_unknown_in(self, group: Steps) -> None:
        """Note paths of a group that is named by paths, such as `vary:`, that neither the files nor cases have."""
        if self.study is None:
            return
        tree = self.study.tree()
        listed: Any = tree.value
        for step in group:
            listed = listed.get(step) if isinstance(listed, dict) else None
        for path in listed if isinstance(listed, dict) else ():
            if not self.added_by_cases(path):
                there = Here(tree, self.mistakes).at(*group, path)
                self._find(self.draft(path), path, there, may_be_new=True, of_cases=True)

    def _find(
        self, draft: Draft | None, path: str, there: Here, may_be_new: bool = False, of_cases: bool = False
    ) -> Steps | None:
        """The steps of a path; an unknown one is noted with the nearest key, of cases if they may have it, and None
        returned."""
        if draft is None:
            return None
        steps, rest = _reach(draft.value, path)
        first = path.partition(".")[0]
        below = first in _CHANNELS or (path.count(".") == 1 and first in self.keys and not _is_group(first))
        if may_be_new and rest and below:
            _create(draft, first, there)
            steps, rest = _reach(draft.value, path)
        if steps and not rest:
            return steps
        own = _of_channels(steps) or ("." not in rest and "[" not in path)
        may_be_there = own and isinstance(draft.at(steps), dict) and (steps or rest in self.keys)
        if may_be_new and may_be_there and not _is_named(steps):
            return (*steps, rest)  # the schema knows whether there is such a key
        self._unknown(path, steps, rest, draft, there, self._added(steps) if of_cases else ())
        return None

    def _unknown(self, path: str, steps: Steps, rest: str, draft: Draft, there: Here, also: Sequence[str] = ()) -> None:
        """Note a path that is there as far as some steps, with the nearest key, or name in `also`, in place of the
        rest."""
        known, first = draft.at(steps) if steps else self.keys, rest.partition(".")[0]
        do = nearest(first, [*(known if isinstance(known, dict | frozenset) else ()), *also])
        if not steps and first in self.keys:
            do = f"there is no '{first}:' in the file"
        elif not steps and first in study_keys():
            do = f"'{first}:' is a key of studies: name the study file"
        elif steps == ("model",):
            do = f"write paths of the model without 'model.': {rest}"
        elif not steps and (ends := self._ending_with(rest)):
            do = f"did you mean one of {list_some(ends)}?" if len(ends) > 1 else f"did you mean '{ends[0]}'?"
        named = _is_named(steps) and isinstance(known, dict) and "." not in rest
        new = "a new one goes under 'add:'" if named else ""
        advice = "; ".join(text for text in (do, new) if text)
        there.wrong(f"the path '{path}', which does not exist", "a path of the files", advice, of_key=True)

    def _ending_with(self, rest: str) -> list[str]:
        """The paths of the files that end with a text, as `thickness` does for `parts.slab.thickness`."""
        drafts = [draft for draft in (self.study, self.model) if draft is not None]
        paths = [path for draft in drafts for path in draft.keys if path[0] not in _OF_ALL_CASES]
        return [text for path in paths if (text := dotted(path)).endswith(f".{rest}")]

    def _added(self, steps: Steps) -> tuple[str, ...]:
        """Names that cases add to a group."""
        cases = mapping_in(self.study.value, "cases").values() if self.study is not None and len(steps) == 1 else ()
        added = [path for case in cases if isinstance(case, dict) for path in mapping_in(case, "add")]
        return tuple(path.split(".", 1)[1] for path in added if path.startswith(f"{steps[0]}."))


def _create(draft: Draft, first: str, there: Here) -> None:
    if not isinstance(draft.value.get(first), dict):
        draft.value[first] = {}
        draft.keys[first,] = draft.values[first,] = there.tree.position(there.steps, of_key=True)


def _is_named(steps: Steps) -> bool:
    return (len(steps) == 1 and _is_group(steps[0])) or steps in _NAMED_INSIDE


def _of_channels(steps: Steps) -> bool:
    return len(steps) == 1 and steps[0] in _CHANNELS


def _value_text(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_value_text(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_value_text(item) for item in value) + "]"
    return quote_value(value).strip("'")


def _reach(value: Any, path: str) -> tuple[Steps, str]:
    """How far a path leads in a tree, keys that contain dots included: the steps that exist, and the rest of the text.

    >>> _reach({"record": {"O_s.z": ["velocity"]}}, "record.O_s.z[0].x")
    (('record', 'O_s.z', 0), 'x')
    """
    steps: list[str | int] = []
    pieces = path.replace("[", ".").replace("]", "").split(".") if path else []
    while pieces:
        longest, step = 0, ""  # type: int, str | int
        if isinstance(value, dict):
            longest = next((n for n in range(len(pieces), 0, -1) if ".".join(pieces[:n]) in value), 0)
            step = ".".join(pieces[:longest])
        elif isinstance(value, list) and _INDEX.fullmatch(pieces[0]) and int(pieces[0]) < len(value):
            longest, step = 1, int(pieces[0])
        if not longest:
            break
        value, pieces = value[step], pieces[longest:]
        steps.append(step)
    return tuple(steps), ".".join(pieces)


# ----------------------------------------------------------------------------------------------------------------------
# Names that cannot be, in both files.
# ----------------------------------------------------------------------------------------------------------------------

LONGEST: Final = 80  # characters
NAMESPACE: Final = (
    "parts",
    "joints",
    "constraints",
    "points",
    "surfaces",
    "cavities",
    "supports",
    "bodies",
    "contacts",
    "links",
    "loads",
    "rooms",
)
_READABLE: Final = (  # what is wrong, got, expected, do
    (lambda name: len(name) > LONGEST, "a name of {size} characters", f"at most {LONGEST}", "shorten it"),
    (lambda name: "\n" in name or "\t" in name, "a name with a tab or a new line", "a name in one line", ""),
    (lambda name: name != name.strip(), "the name '{name}'", "a name without blanks at its ends", "remove them"),
    # legends of pictures leave such lines out
    (lambda name: name.startswith("_"), "the name '{name}'", "a name that does not begin with _", "rename it"),
)
_FILE: Final = (
    *_READABLE,
    (lambda name: not name.strip(". "), "the name '{name}'", "a name with a letter or a digit", ""),
)
_PLAIN: Final = (
    *_READABLE,
    (
        lambda name: not name.strip() or "." in name or "[" in name,
        "the name '{name}'",
        "a name without dots",
        "write {clean}",
    ),
    (lambda name: name == "ground", "the name 'ground'", "another name", "ground is what does not move"),
)


def check_names(model: Tree | None, study: Tree | None, mistakes: Mistakes) -> None:
    """Names contain no dots, and no two things share one. Cases and receivers may have dots: `damper 0.6`."""
    seen: dict[str, str] = {}
    if study is not None:
        here = Here(study, mistakes)
        _check_file_names(here.at("cases"), mapping_in(study.value, "cases"))
        for room in mapping_in(study.value, "rooms"):
            _check_file_names(
                here.at("rooms", room, "receivers"), mapping_in(mapping_in(study.value["rooms"], room), "receivers")
            )
    of_study = groups(study_schema()) if study is not None else ()
    files = [(tree, own) for tree, own in ((model, groups(ModelSpec)), (study, of_study)) if tree is not None]
    for tree, own in files:
        for group in own:
            for name in mapping_in(tree.value, group) if group != "cases" else ():
                there = Here(tree, mistakes).at(group, name)
                if _is_good(there, name, _PLAIN) and group in NAMESPACE:
                    there.need(
                        name not in seen,
                        f"'{name}', which names one of the {seen.get(name)} already",
                        "one name for one thing",
                        f"rename one; {FALLING_PARTS}"
                        if (seen.get(name), group) == ("parts", "bodies")
                        else "rename one",
                        of_key=True,
                    )
                    seen.setdefault(name, group)


def _check_file_names(here: Here, names: Mapping[str, Any]) -> None:
    """Names that become names of groups and files."""
    files: dict[str, str] = {}
    for name in names:
        first = files.setdefault(re.sub(r"\W+", "_", name).lower(), name)
        here.at(name).need(
            first == name,
            f"'{name}' and '{first}', whose files would have one name",
            "names that differ in letters or digits",
            "rename one",
            of_key=True,
        )
        _is_good(here.at(name), name, _FILE)


def _is_good(here: Here, name: str, rules: Any) -> bool:
    """Whether a name can be read in a line and used for a file; notes why it cannot."""
    clean = name.replace(".", "_").replace("[", "_") or "a name"
    for is_wrong, got, expected, do in rules:
        if is_wrong(name):
            here.wrong(got.format(name=name, size=len(name)), expected, do.format(clean=clean), of_key=True)
            return False
    return True
