"""The case control of a bulk data file of Nastran: its sets, and the supports that it puts to use."""

from __future__ import annotations

import re
from pathlib import Path

from femstruct.files.inputs.mesh_files.bulk_cards import Card
from femstruct.files.inputs.mesh_files.text_lines import wrong_line


def case_control(path: Path, control: list[tuple[int, str]]) -> tuple[dict[str, list[int]], list[int]]:
    """Sets by name, and the numbers of the sets of supports that hold, of numbered lines.

    SET 5 = 1, 2, 7 THRU 9: a line that ends in a comma goes on. SPC = 1 names the supports. Raises InputErrors.

    >>> case_control(Path("a.bdf"), [(1, "SPC = 2"), (2, "SET 5 = 1,"), (3, "7 THRU 9")])
    ({'SET 5': [1, 7, 8, 9]}, [2])
    """
    sets: dict[str, list[int]] = {}
    chosen: list[int] = []
    pending, first = "", 0
    for number, line in control:
        text = line.split("$", 1)[0].strip()
        pending, first = (pending + " " + text, first) if pending else (text, number)
        if pending.endswith(","):
            continue
        if (spc := re.match(r"SPC\s*=\s*(\d+)\s*$", pending, re.IGNORECASE)) is not None:
            chosen.append(int(spc[1]))
        found = re.match(r"SET\s+(\d+)\s*=\s*(.*)", pending, re.IGNORECASE)
        pending = ""
        if found is None or "ALL" in found[2].upper():
            continue
        card = Card(path, first, "SET", [found[1], *re.split(r"[,\s]+", found[2].strip())])
        if "EXCEPT" in (word.upper() for word in card.fields):
            raise wrong_line(path, first, "SET with EXCEPT", "the numbers that belong to it")
        sets[f"SET {found[1]}"] = card.several(1)
    return sets, chosen
