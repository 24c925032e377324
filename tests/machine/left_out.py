"""What decks state and no part takes: told with its line and number, by how much it matters; what is spoilt is refused.

The lines are counted where the decks are written; how much each matters is judged here by what it does in its program.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from tests.machine.framework import Case, Door, Floats, Model, Refused, capability

Draft = dict[str, Any]
_FORBIDS, _LIMITS, _OTHERWISE, _IDLE = 3, 2, 1, 0
_CODES: Final = {"mesh-stated-otherwise": _OTHERWISE, "mesh-without-effect": _IDLE}
_EXACT: Final = "lines and numbers of them; they are whole"


@dataclass
class Deck:
    """Lines of a deck, and what must be told of it: how much it matters, its line, its number.

    others : things that forbid trust and have no line.
    """

    lines: list[str] = field(default_factory=list)
    told: list[tuple[int, int, int]] = field(default_factory=list)
    others: int = 0

    def add(self, *lines: str, matters: int | None = None, count: int = 1, at: int = 0) -> None:
        """Lines, of which one, from 0, is told."""
        if matters is not None:
            self.told.append((matters, len(self.lines) + at + 1, count))
        self.lines += lines

    @property
    def all_told(self) -> list[tuple[int, int, int]]:
        """Also how many things forbid trust, with line 0."""
        forbid = len([one for one in self.told if one[0] == _FORBIDS]) + self.others
        return sorted([*self.told, *([(_FORBIDS, 0, forbid)] if forbid else [])])

    def also(self, matters: int, count: int) -> None:
        """A further thing told of the last line."""
        self.told.append((matters, len(self.lines), count))


def _found(answer: Draft) -> list[tuple[int, int, int]]:
    """What an answer tells of the lines of a deck, and of its numbers as a whole with line 0."""
    found = []
    for one in answer.get("findings", ()):
        if not one["code"].startswith("mesh-"):
            continue
        severe = one.get("severe") or one.get("rank") == "forbids trust"
        matters = _FORBIDS if severe else _CODES.get(one["code"], _LIMITS)
        words = one["message"]
        if severe or "(line " not in words:
            found.append((matters, 0, int(one["values"].get("kinds", 0))))
        for there in re.finditer(r"\(line (\d+)\)(?: of (\d+) cells)?", words):
            before = re.split(r"[;\[\]:]|, (?=\d+ )", words[: there.start()])[-1]
            counted = re.match(r"\s*(\d+) ", before)
            count = there[2] or (counted[1] if counted else "1")
            found.append((matters, int(there[1]), int(count)))
    return sorted(found)


def _case(decks: Sequence[tuple[str, Deck, Draft]]) -> Case:
    """Each deck by its file, with keys of its shell."""
    draft: Draft = {f"deck {k}": {"file": name, **more} for k, (name, _, more) in enumerate(decks)}

    def asked(_: Model, door: Door) -> Floats:
        found: list[tuple[int, int, int]] = []
        for name, deck, more in decks:
            part = {"type": "shell", "mesh": name, "material": "m", **more}
            inner: Draft = {"materials": {"m": {"E": 2.1e11, "nu": 0.3, "rho": 7850.0}}, "parts": {"p": part}}
            inner["damping"] = {"ratio": 0.01}
            found += _found(door.ask(inner, "check", **{name: "\n".join([*deck.lines, ""])}))
        door.told = []
        return np.array(found)

    def right(_: Model, __: Door) -> Floats:
        return np.array([one for _, deck, _ in decks for one in deck.all_told])

    return Case(draft, asked, right, 1e-12, _EXACT)


_WIDE: Final = 8  # cells along; four across
_OF: Final = (1, 2, 3, 4, 5, 6, 7, 4)  # cells of each property


def _cells() -> list[tuple[int, list[int]]]:
    """Property and nodes, by numbers from 1, of each cell."""
    k = np.arange((_WIDE + 1) * 5).reshape(_WIDE + 1, 5) + 1
    quads = np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]], axis=-1).reshape(-1, 4)
    return list(zip(np.repeat(np.arange(8) + 1, _OF).tolist(), quads.tolist(), strict=True))


def _places() -> list[tuple[int, float, float]]:
    return [(5 * i + j + 1, 0.1 * i, 0.1 * j) for i in range(_WIDE + 1) for j in range(5)]


def _bulk(deck: Deck, sections: bool = True, skip: Sequence[int] = ()) -> None:
    deck.add("MAT1,1,2.1+11,,.3,7850.", "MAT1,9,7.+10,,.3,2700.", "MAT1,8,2.1+11,,.3,7850.")
    if sections:
        deck.add(*(f"PSHELL,{p},1,.01,1,,1" for p in range(1, 9) if p not in skip))
    deck.add(*(f"GRID,{n},,{x:.1f},{y:.1f},0." for n, x, y in _places()))


def _sections(rng: np.random.Generator) -> list[tuple[str, Deck, Draft]]:
    """Properties that no shell of one material has."""
    first, second = (Deck(["BEGIN BULK"]) for _ in range(2))
    made = {
        1: ["PSHELL,1,1,.01"],
        2: ["PSHELL,2,1,.01,9,,9"],
        3: [f"PSHELL,3,1,.01,1,{rng.uniform(1.01, 2):.4f},1"],
        4: [f"PSHELL,4,1,.01,1,,1,{rng.uniform(0.1, 0.8):.4f}"],
        5: ["PSHELL,5,1,.01,1,,1", ",,,1"],
        6: ["PSHELL,6,,.01,1,,1"],
        7: ["PSHELL,7,1,.01,-1"],
    }
    for number in rng.permutation(list(made)).tolist():
        first.add(*made[number], matters=_FORBIDS, count=number)
        if number == 7:
            first.told.append((_IDLE, len(first.lines), 1))  # no shear across
    first.add("PSHELL,8,8,.01,1,1.,8,.83333,0.", *["PSHELL,19,1,.01"])
    _bulk(first, sections=False)
    for number, (z, word) in {1: ("", ""), 2: ("-.01", "SYM"), 3: ("0.", "")}.items():
        second.add(f"PCOMP,{number},{z},,,,,,{word}", ",1,.005,0.,,,.005", matters=_FORBIDS, count=number)
    second.told.append((_FORBIDS, len(second.lines) - 1, 3))  # the lowest face of the third
    second.add("PSHELL,4,1,.01,1", matters=_IDLE)
    second.add("PSHELL,5,1,.01,1,,1,,2.5")
    second.add("PCOMPG,6", ",11,1,.004,30.", ",12,,.006", matters=_FORBIDS, count=6)
    second.add("PCOMP,7,,3.,,,,,MEM", ",1,.005,,,1,.005", matters=_FORBIDS, count=7)
    second.told.append((_FORBIDS, len(second.lines) - 1, 7))
    second.add("PSHELL,8,1,.01,1,,1")
    second.add("NSM1,3,PSHELL,2.,1,2", matters=_FORBIDS)
    _bulk(second, sections=False)
    for deck in (first, second):
        deck.add(*(f"CQUAD4,{c},{p},{','.join(map(str, of))}" for c, (p, of) in enumerate(_cells(), 1)), "ENDDATA")
    return [("a.bdf", first, {"thickness": 0.01}), ("b.bdf", second, {"thickness": 0.01})]


def _elements(rng: np.random.Generator) -> list[tuple[str, Deck, Draft]]:
    """What elements state of themselves, elements and cards that are not made, and those that do nothing."""
    deck = Deck(["SOL 103", "CEND"])
    deck.add("SPC = 1", "MPC = 4")
    deck.add("STATSUB = 3", matters=_FORBIDS)
    deck.add("DISPLACEMENT(PLOT) = ALL", matters=_IDLE)
    deck.add("WHATEVER = 7", matters=_IDLE)
    deck.add("METHOD = 3", matters=_IDLE)
    deck.told.append((_IDLE, 4, 1))
    deck.add("BEGIN BULK", "PARAM,WTMASS,1.-3")
    _bulk(deck)
    deck.lines = [one.replace("7850.", "7.85+6") for one in deck.lines]
    for c, (p, of) in enumerate(_cells(), 1):
        words = f"CQUAD4,{c},{p},{','.join(map(str, of))}"
        if c == 3:
            deck.add(f"{words},,.002", matters=_FORBIDS, count=2)
        elif c == 7:
            deck.add(f"{words},,{rng.uniform(0.001, 0.01):.5f}")
        elif c == 9:
            deck.add(f"{words},,,", ",,,.02,.01,.01,.01", matters=_FORBIDS, count=3)
        elif c == 10:
            deck.add(f"{words},,,", ",,,.01,.01,,.01")
        elif c == 11:
            deck.add(f"{words},,,", ",,1,1.,1.,1.,1.")
        elif c == 12:
            deck.add(f"{words},30.,,", ",,,.01,.01,.01,.0102")
        else:
            deck.add(f"{words},0.,0.")
    other = Deck(["BEGIN BULK"])
    cards = {
        "CELAS2,101,1.+6,2,3": _FORBIDS,
        "CMASS2,104,1.,2,3": _FORBIDS,
        "RBAR,105,2,3,123456": _FORBIDS,
        "SPC11,1,123,1": _FORBIDS,
        "CONM2,106,2,,1.,,,,7.": _FORBIDS,
        "PBAR,7,1,1.-4,1.-8,1.-8,1.-8,3.": _FORBIDS,
        "CPENTA,108,7,1,2,3,4,5,6": _FORBIDS,
        "FORCE,1,1,,1.,0.,0.,1.": _IDLE,
        "EIGRL,3,,,5": _IDLE,
        "PARAM,POST,-1": _IDLE,
        "PARAM,COUPMASS,1": _IDLE,
        "PARAM,NEVERHEARD,1": _IDLE,
        "DESVAR,1,A,1.": _IDLE,
    }
    for card in rng.permutation(list(cards)).tolist():
        other.add(card, matters=cards[card])
        if card.startswith("PBAR"):
            other.also(_IDLE, 1)
    other.add("CROD,111,7,1,2", "CROD,112,7,2,3", matters=_FORBIDS, count=2)
    _bulk(other)
    for c, (p, of) in enumerate(_cells(), 1):
        other.add(f"CQUAD4,{c},{p},{','.join(map(str, of))}")
    other.told.append((_LIMITS, 0, 1))  # the mass, which no part takes
    for one in (deck, other):
        one.add("ENDDATA")
    open_end = Deck(told=[(_LIMITS, 0, 0)], others=3)  # bars of two kinds, and two materials of one shell
    open_end.add("MAT1,1,2.1+11,8.0769+10,.3,7850.,1.-5,20.,.01", ",1.,1.,1.,0", "MAT1,9,,8.0769+10,.3,7850.")
    open_end.add("MAT1,8,2.1+11,8.0769+10,,7850.", *(f"PSHELL,{p},{9 if p == 5 else 8},.01,8,,8" for p in range(1, 9)))
    open_end.add("MAT1,7,7.+10,,.3,2700.", "PSHELL,19,7,.01,7,,7,,0.", ",-.005,.005", "CQUAD4,99,19,1,2,7,6")
    # fields of heat, strength and bars, all of them
    for name, head, count in (("MAT2", "22", 19), ("MAT3", "23", 19), ("MAT8", "28", 23), ("MAT9", "29", 39),
                              ("MAT10", "30", 19), ("MAT11", "31", 29), ("CBAR", "98,7,1,2", 20),
                              ("CBEAM", "97,7,1,2", 20)):  # fmt: skip
        fields = [*head.split(","), *["1."] * count]
        open_end.add(
            f"{name},{','.join(fields[:8])}", *(f",{','.join(fields[k : k + 8])}" for k in range(8, len(fields), 8))
        )
    open_end.add("PSOLID,30,1,,2,GAUSS,1")
    open_end.add("PBAR,7,1,1.-4,1.-8,1.-8,1.-8", matters=_IDLE)
    open_end.add(*(one for one in _GRIDS + _QUADS))
    return [("c.bdf", deck, {}), ("d.bdf", other, {}), ("e.bdf", open_end, {})]


def _abaqus(deck: Deck) -> None:
    deck.add("*NODE", *(f"{n}, {x:.1f}, {y:.1f}" for n, x, y in _places()), "*ELEMENT, TYPE=S4, ELSET=SKIN")
    deck.add(*(f"{c}, {', '.join(map(str, of))}" for c, (_, of) in enumerate(_cells(), 1)))
    ends = np.cumsum([0, *_OF]).tolist()
    for p in range(8):
        deck.add(f"*ELSET, ELSET=P{p + 1}, GENERATE", f"{ends[p] + 1}, {ends[p + 1]}")
    deck.add("*MATERIAL, NAME=STEEL", "*ELASTIC", "2.1e11, 0.3", "*DENSITY", "7850.")


def _keywords(rng: np.random.Generator) -> list[tuple[str, Deck, Draft]]:
    """Sections of sets, and keywords of all classes."""
    deck, other, last = Deck(), Deck(), Deck()
    _abaqus(deck)
    sections = {
        1: ["*SHELL SECTION, ELSET=P1, MATERIAL=STEEL, OFFSET=0.5", "0.01"],
        2: ["*SHELL SECTION, ELSET=p2, MATERIAL=STEEL, OFFSET=SNEG", "0.01"],
        3: ["*SHELL SECTION, ELSET=P3, MATERIAL=STEEL, NODAL THICKNESS", "0.01"],
        4: ["*SHELL SECTION, ELSET=P4, MATERIAL=STEEL, ORIENTATION=O, OFFSET=MIDDLE", "0.01"],
        5: ["*MEMBRANE SECTION, ELSET=P5, MATERIAL=STEEL", "0.01"],
        6: ["*SHELL SECTION, ELSET=P6, MATERIAL=STEEL, OFFSET=somewhere", "0.01"],
    }
    for number in rng.permutation(list(sections)).tolist():
        # a direction of steel is none
        deck.add(*sections[number], matters=None if number == 4 else _FORBIDS, count=number)
    deck.add("*SHELL SECTION, ELSET=P7, MATERIAL=STEEL", "0.01")
    deck.add("0.02", matters=_FORBIDS)
    deck.add("*SHELL SECTION, ELSET=P8, MATERIAL=STEEL, TWIST=3", "0.01", matters=_FORBIDS)
    # offsets and the like of several sets are told as one, by their first line
    ends = ("OFFSET=0.5", "OFFSET=SNEG", "OFFSET=somewhere")
    offsets = [one for one in deck.told if deck.lines[one[1] - 1].endswith(ends)]
    deck.told = [one for one in deck.told if one not in offsets]
    deck.told.append((_FORBIDS, min(one[1] for one in offsets), sum(one[2] for one in offsets)))
    _abaqus(other)
    other.add("*SHELL SECTION, ELSET=SKIN, MATERIAL=STEEL", "0.01")
    words = {
        ("*BOUNDRY", "1, 1, 3"): _FORBIDS,
        ("*EQUATION", "2", "1, 1, 1., 2, 1, -1."): _FORBIDS,
        ("*ELEMENT, TYPE=SPRING1, ELSET=S", "101, 1", "102, 2", "103, 3"): _FORBIDS,
        ("*INITIAL CONDITIONS, TYPE=STRESS", "1, 1e6"): _FORBIDS,
        ("*ROTARY INERTIA, ELSET=R", "1., 1., 1."): _FORBIDS,
        ("*NONSTRUCTURAL MASS, ELSET=P1, UNITS=MASS PER LENGTH", "3."): _FORBIDS,
        ("*MASS, ELSET=NOWHERE", "1."): _FORBIDS,
        ("*BOUNDARY", "1, 1, 1, 0.002"): _FORBIDS,
        ("*DAMPING, ALPHA=1.",): _IDLE,
        ("*INITIAL CONDITIONS, TYPE=TEMPERATURE", "1, 20."): _IDLE,
        ("*AMPLITUDE, NAME=A", "0., 1."): _IDLE,
    }
    for number in rng.permutation(len(words)).tolist():
        some = list(words)[number]
        other.add(*some, matters=words[some], count=3 if "SPRING1" in some[0] else 1)
    _abaqus(last)
    last.add("*SHELL SECTION, ELSET=SKIN, MATERIAL=STEEL", "0.01", "*NSET, NSET=turned", "1, 2, 3")
    last.add("*BOUNDARY", "1, 1, 2", "2, 1, 3", "3, 4", "5, 1, 3")
    last.add("*TRANSFORM, NSET=turned, TYPE=C", "0., 0., 0., 0., 0., 1.", matters=_FORBIDS, count=2)
    last.add("*TRANSFORM, NSET=turned", "1., 0., 0., 1., 2., 0.")
    last.add(
        "*NSET, NSET=follow", "7, 8, 9", "*RIGID BODY, REF NODE=1, PIN NSET=follow", "*KINEMATIC COUPLING, REF NODE=2"
    )
    last.add("12, 1, 2")
    last.told.append((_FORBIDS, last.told[-1][1], 1))
    last.add("*RIGID BODY, REF NODE=1, ELSET=P1", matters=_FORBIDS)
    last.add("*STEP, NLGEOM", matters=_IDLE, count=3)
    last.add("*STATIC", "1., 1.", matters=_IDLE)
    last.add("*CLOAD", "2, 3, 1.", matters=_IDLE)
    last.add("*END STEP", matters=_IDLE, count=3)
    last.add("*STEP", matters=_FORBIDS)
    last.add("*FREQUENCY", "3", "*END STEP", "*STEP", matters=_IDLE)
    last.add("*BOUNDARY", "9, 3", matters=_IDLE)
    last.add("*END STEP")
    last.told.append((_LIMITS, 0, 2))  # supports and links that no part takes
    return [("a.inp", deck, {}), ("b.inp", other, {}), ("c.inp", last, {})]


@capability("decks: what Nastran states and no part takes is told", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _case([*_sections(rng), *_elements(rng)])


@capability("decks: what Abaqus states and no part takes is told", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    return _case(_keywords(rng))


_NODES: Final = ["*NODE", *(f"{n}, {x:.1f}, {y:.1f}, 0." for n, x, y in _places())]
_SHELLS: Final = [
    "*ELEMENT, TYPE=S4, ELSET=SKIN",
    *(f"{c}, {', '.join(map(str, of))}" for c, (_, of) in enumerate(_cells(), 1)),
]
_GRIDS: Final = [f"GRID,{n},,{x:.1f},{y:.1f},0." for n, x, y in _places()]
_QUADS: Final = [f"CQUAD4,{c},1,{','.join(map(str, of))}" for c, (_, of) in enumerate(_cells(), 1)]
_SPOILT: Final[dict[str, dict[str, int]]] = {  # lines of a deck, and which of them, from 1, is at fault
    "bdf": {
        "CQUAD4,90,1,1,2,7": 1,
        "CTETRA,90,1,1,2,3,6,7": 1,
        "GRID,ninety,,0.,0.,0.": 1,
        "GRID,90,,0.,zero,0.": 1,
        "GRID,90,,0.,0.,0.,,,,1.": 1,
        "GRID,90,5,0.,0.,0.": 1,
        "CORD2R,5,5,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nGRID,90,5,0.,0.,0.": 1,
        "CORD2R,5,,0.,0.,0.,0.,0.,1.\n,0.,0.,2.\nGRID,90,5,0.,0.,0.": 1,
        "CORD1R,5,1,2,999\nGRID,90,5,0.,0.,0.": 1,
        "CORD1R,5,1,2,6\nCORD1C,5,1,2,6": 2,
        "GRDSET,,0\nGRDSET,,0,,,,,1": 2,
        "SPC1,1,127,1": 1,
        "SPC1,1,123,1,THRU,x": 1,
        "SPC1,1,123,1.5": 1,
        "CONM2,91,2,7,1.": 1,
        "RBE2,91,1,123": 1,
        "RBE3,91,,1,123,0.,123,2,3": 1,
        "SET3,5,PROP,1": 1,
        "PSHELL,3,1,thick,1": 1,
        "INCLUDE 'nowhere.dat'": 1,
        "CONM2,91,2,,inf": 1,
    },
    "inp": {
        "*NGEN\n1, 9": 1,
        "*NODE, SYSTEM=C\n90, 1., 1., 1.": 1,
        "*NODE, INPUT=other.inp": 1,
        "*NODE\n90, 0., 0., 0., 3.": 2,
        "*NODE\nninety, 0., 0., 0.": 2,
        "*NODE\n90, 0., zero, 0.": 2,
        "*ELEMENT, TYPE=S4\n90, 1, 2, 7": 2,
        "*ELEMENT, TYPE=S4\n90, 1, 2, 7, 6\n91, 1, 2, 7, 6, 8\n92, 1, 2, 7, 6": 3,
        "*ELEMENT, TYPE=S4\n90, 1, 2,\n7, 6\n91, 1, 2,\n7": 4,
        "*ELEMENT, TYPE=C3D6\n90, 1, 2, 3, 6, 7, 8": 1,
        "*ELEMENT\n90, 1, 2, 7, 6": 1,
        "*ELEMENT, TYPE=MASS, ELSET=L\n90, 1, 2": 2,
        "*NSET, NSET=A, GENERATE\n1, 9, 0": 2,
        "*NSET, NSET=A, GENERATE\n1, 9, 1, 1": 2,
        "*NSET, NSET=A\nnobody": 2,
        "*NSET\n1, 2": 1,
        "*BOUNDARY\nnobody, 1, 3": 2,
        "*BOUNDARY\n1,": 2,
        "*KINEMATIC\n1, 3": 1,
        "*PART, NAME=A\n*PART, NAME=B": 2,
        "*INSTANCE, NAME=A, PART=A\n1., 0., 0.": 1,
        "*INCLUDE, INPUT=nowhere.inp": 1,
        "*SHELL SECTION, ELSET=SKIN, COMPOSITE\n0.01, 3": 2,
        "*SHELL SECTION, MATERIAL=A\n0.01": 1,
    },
    "unv": {},
}
_SPOILT["unv"] = {
    "    -1\n  2411\n  90  1  1\n 0. 0. 0.\n    -1": 3,
    "    -1\n  2411\n  90  1  1  11\n 0. 0.\n    -1": 4,
    "    -1\n  2411\n  90  1  1  11\n 0. 0. zero\n    -1": 4,
    "    -1\n  2411\n  90  1  1  11\n    -1": 3,
    "    -1\n  2412\n  90  94  1  1  7\n 1 2 7 6\n    -1": 3,
    "    -1\n  2412\n  90  112  1  1  7  6\n 1 2 3 6 7 8\n    -1": 3,
    "    -1\n  2412\n  90  94  1  1  7  4\n 1 2 7\n    -1": 3,
    "    -1\n  2412\n  90  94  1  1  7  3\n 1 2 7\n    -1": 3,
    "    -1\n  2467\n  1 0 0 0 0 0 2\nA\n 8 1 0 0\n    -1": 3,
    "    -1\n  2467\n  1 0 0 0 0 0 0 2\nA\n 8 1 0 0\n    -1": 3,
    "    -1\n  2412\n  90  94  1  1  7  4": 1,
}


def _spoilt(form: str, mistake: str) -> tuple[str, int]:
    """A deck with a mistake, and the line, from 1, before the mistake's first."""
    if form == "bdf":
        lines = ["BEGIN BULK", "PSHELL,1,1,.01,1,,1", *_GRIDS, *_QUADS]
        return "\n".join([*lines, mistake, "ENDDATA", ""]), len(lines)
    if form == "inp":
        lines = [*_NODES, *_SHELLS]
        return "\n".join([*lines, mistake, ""]), len(lines)
    lines = ["    -1", "  2411"]
    for n, x, y in _places():
        lines += [f"{n} 1 1 11", f"{x:.1f} {y:.1f} 0."]
    lines += ["    -1", "    -1", "  2412"]
    for c, (_, of) in enumerate(_cells(), 1):
        lines += [f"{c} 94 1 1 7 4", " ".join(map(str, of))]
    lines.append("    -1")
    return "\n".join([*lines, mistake, ""]), len(lines)


@capability("decks: what is spoilt is refused with its line", "independent", slow=True)
def _(rng: np.random.Generator) -> Case:
    mistakes = [(form, mistake, at) for form, some in _SPOILT.items() for mistake, at in some.items()]
    rng.shuffle(mistakes)  # type: ignore[arg-type]
    thick = float(rng.uniform(0.01, 0.02))

    def asked(_: Model, door: Door) -> Floats:
        found = []
        for form, mistake, _at in mistakes:
            text, before = _spoilt(form, mistake)
            inner: Draft = {"materials": {"m": {"E": 2.1e11, "nu": 0.3, "rho": 7850.0}}}
            inner["parts"] = {"p": {"type": "shell", "mesh": f"a.{form}", "material": "m", "thickness": thick}}
            try:
                door.ask(inner, "modes", "--count", "1", **{f"a.{form}": text})
                found.append(0)
            except Refused as told:
                line = re.match(rf"\S*a\.{form}:(\d+):", str(told))
                found.append(int(line[1]) - before if line else -1)
        return np.array(found)

    return Case({"thickness": thick}, asked, lambda *_: np.array([at for *_of, at in mistakes]), 1e-12, _EXACT)
