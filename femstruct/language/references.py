"""The names of both files: what a model offers, and names that cannot be."""

from __future__ import annotations

import re
from typing import Any

from femstruct.language.yaml.checker import Checker
from femstruct.language.yaml.reader import Mistakes, Steps, Tree

_NAMESPACE = ("parts", "joints", "points", "surfaces", "supports", "bodies", "contacts", "links", "loads", "rooms")
_ALL_NAMED = (*_NAMESPACE, "materials", "sections", "frf")


def _check_dotted_names(study: Tree, check: Checker) -> None:
    """The names of cases and receivers, which become names of groups and files."""
    groups: list[tuple[Steps, Any]] = [(("cases",), study.value.get("cases"))]
    rooms = study.value.get("rooms")
    for room, one in rooms.items() if isinstance(rooms, dict) else ():
        if isinstance(one, dict):
            groups.append((("rooms", room, "receivers"), one.get("receivers")))
    for place, named in groups:
        files: dict[str, str] = {}
        for name in named if isinstance(named, dict) else ():
            file = re.sub(r"\W+", "_", name).lower()
            if files.setdefault(file, name) != name:
                got = f"'{name}' and '{files[file]}', whose files would have one name"
                check.wrong((*place, name), got, "names that differ in letters or digits", "rename one", of_key=True)
            if check.is_name((*place, name), name) and not name.strip(". "):
                got = f"the name '{name}'"
                check.wrong((*place, name), got, "a name with a letter or a digit", of_key=True)


def check_names(model: Tree | None, study: Tree | None, mistakes: Mistakes) -> None:
    """Names contain no dots, and no two things share one. Cases and receivers may have dots: `damper 0.6`."""
    seen: dict[str, str] = {}
    if study is not None:
        _check_dotted_names(study, Checker(study, mistakes))
    for tree in (model, study):
        if tree is None:
            continue
        check = Checker(tree, mistakes)
        for group in _ALL_NAMED:
            named = tree.value.get(group)
            for name in named if isinstance(named, dict) else ():
                steps = (group, name)
                if not check.is_name(steps, name):
                    continue
                if "." in name or "[" in name or not name.strip():
                    clean = name.replace(".", "_").replace("[", "_") or "a name"
                    check.wrong(steps, f"the name '{name}'", "a name without dots", f"write {clean}", of_key=True)
                elif name == "ground":
                    check.wrong(steps, "the name 'ground'", "another name", "ground is what does not move", of_key=True)
                elif group in _NAMESPACE and name in seen:
                    got = f"'{name}', which names one of the {seen[name]} already"
                    check.wrong(steps, got, "one name for one thing", "rename one", of_key=True)
                elif group in _NAMESPACE:
                    seen[name] = group
