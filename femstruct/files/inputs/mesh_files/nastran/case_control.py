"""The case control of a bulk data file of Nastran: its sets, the supports that it puts to use, and its commands."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from femstruct.files.inputs.mesh_files.nastran.bulk_cards import Card, Line
from femstruct.files.inputs.mesh_files.text_lines import wrong_line


class Control(NamedTuple):
    """What the case control says. sets : by name. chosen : numbers of the sets of supports that hold; masses : of
    mass on cells. commands : each
    command NAME = VALUE with its first line, from 1. whole : whether there is a case control at all."""

    sets: dict[str, list[int]]
    chosen: list[int]
    commands: dict[str, int]
    whole: bool
    masses: list[int]


def case_control(lines: Sequence[Line]) -> Control:
    """What lines of the case control say.

    SET 5 = 1, 2, 7 THRU 9: a line that ends in a comma goes on. SPC = 1 names the supports. Raises InputErrors.

    >>> from pathlib import Path
    >>> texts = ["CEND", "SPC = 2", "SET 5 = 1,", "7 THRU 9"]
    >>> found = case_control([Line(Path("a.bdf"), number, text) for number, text in enumerate(texts, 1)])
    >>> found.sets, found.chosen, found.commands
    ({'SET 5': [1, 7, 8, 9]}, [2], {'SPC': 2})
    """
    sets: dict[str, list[int]] = {}
    chosen: list[int] = []
    masses: list[int] = []
    commands: dict[str, int] = {}
    pending, first = "", 0
    for one in lines:
        text = one.text.split("$", 1)[0].strip()
        pending, first = (pending + " " + text, first) if pending else (text, one.number)
        if pending.endswith(","):
            continue
        if (spc := re.match(r"SPC\s*=\s*(\d+)\s*$", pending, re.IGNORECASE)) is not None:
            chosen.append(int(spc[1]))
        if (nsm := re.match(r"NSM\s*=\s*(\d+)\s*$", pending, re.IGNORECASE)) is not None:
            masses.append(int(nsm[1]))
        command = re.match(r"(\w+)\s*(?:\([^)]*\))?\s*=\s*(\S+)", pending)
        if command is not None and command[2].upper() != "NONE":
            commands.setdefault(command[1].upper(), first)
        found = re.match(r"SET\s+(\d+)\s*=\s*(.*)", pending, re.IGNORECASE)
        pending = ""
        if found is None or "ALL" in found[2].upper():
            continue
        card = Card(one.path, first, "SET", [found[1], *re.split(r"[,\s]+", found[2].strip())], set())
        if "EXCEPT" in (word.upper() for word in card.fields):
            raise wrong_line(one.path, first, "SET with EXCEPT", "the numbers that belong to it")
        sets[f"SET {found[1]}"] = card.several(1)
    whole = any(one.text.strip().upper().startswith("CEND") for one in lines)
    return Control(sets, chosen, commands, whole, masses)
