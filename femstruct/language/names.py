"""Names that cannot be, in both files."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, Final

from femstruct.language.model.model import ModelSpec
from femstruct.language.not_computed import FALLING_PARTS
from femstruct.language.patch import groups, study_schema
from femstruct.language.yaml import Here, Mistakes, Tree, mapping_in

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
