"""Meshes of Abaqus and CalculiX: .inp.

Read here and not by meshio 5.3, which keeps the last of several *NODE blocks only, and neither sections nor materials.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

import numpy as np

from femstruct.arrays import Integers
from femstruct.errors import InputError
from femstruct.files.inputs.mesh_files.abaqus_deck import Deck, Keyword
from femstruct.files.inputs.mesh_files.abaqus_stated import STATED, is_number
from femstruct.files.inputs.mesh_files.text_lines import floats, integers, lines_of, wrong_line
from femstruct.files.inputs.opening import beside, content
from femstruct.model.imported.cell_kinds import KINDS
from femstruct.model.imported.gathering import Block, Gathered
from femstruct.model.imported.imported_mesh import (
    Stated,
    StatedMaterial,
    StatedProperty,
)

LARGEST: Final = 500_000_000  # bytes
_KINDS: Final = (  # names of element types in Abaqus and CalculiX, as patterns
    (r"(S3|STRI3|CPS3|CPE3|CAX3|M3D3|R3D3|SFM3D3)[A-Z]*", "tri3"),
    (r"(S4|CPS4|CPE4|CAX4|M3D4|R3D4|SFM3D4)(5|R5|[A-Z]*)", "quad4"),
    (r"(S6|STRI65|CPS6|CPE6|M3D6)[A-Z]*", "tri6"),
    (r"(S8|CPS8|CPE8|M3D8)(R5|[A-Z]*)", "quad8"),
    (r"S9R5|M3D9R?", "quad9"),
    (r"C3D4[A-Z]*", "tet4"),
    (r"C3D10[A-Z]*", "tet10"),
    (r"C3D8[A-Z]*", "hex8"),
    (r"C3D20[A-Z]*", "hex20"),
    (r"(B31|B33|T3D2)[A-Z]*", "line2"),
    (r"(B32|T3D3)[A-Z]*", "line3"),
)
_MARKS: Final = ("T3D", "CPS", "CPE", "CAX", "SFM", "R3D")  # as which mesh programs write edges and faces
_ORDER: Final = {"line3": [0, 2, 1]}  # the middle node of a bar is its second one
_MOVES: Final = ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "SUBMODEL", "SYMMETRICMODELGENERATION")
_JOINS: Final = (
    "MPC", "EQUATION", "TIE", "DISTRIBUTINGCOUPLING",
    "CONNECTORSECTION", "SPRING", "DASHPOT", "ROTARYINERTIA", "CONTACTPAIR", "TRANSFORM", "NONSTRUCTURALMASS",
)  # fmt: skip


def read_abaqus(path: Path, data: bytes) -> Gathered:
    """What an input file has: nodes, elements, sets, sections, materials and held nodes of its model.

    Steps and loads are passed over; what would join or move nodes is named as left out, and refused where it makes
    nodes or elements. Raises InputErrors with file and line.
    """
    deck = Deck()
    material, in_step = "", False
    for keyword in _keywords(path, data, depth=0):
        in_step |= keyword.word == "STEP"
        if in_step:
            if keyword.word == "BOUNDARY":
                deck.left_out.setdefault("BOUNDARY of a step", keyword.number)
            continue
        if keyword.word == "MATERIAL":
            material = keyword.option("NAME")
            deck.materials[material] = {}
        elif keyword.word in ("ELASTIC", "DENSITY"):
            _constants(keyword, deck.materials.setdefault(material, {}))
        else:
            _read(keyword, deck)
    if not deck.nodes:
        raise InputError("", got=f"'{path.name}' without *NODE", expected="an input file with nodes and elements")
    if "TRANSFORM" in deck.left_out and (deck.holds or deck.links):  # their directions are not the global ones
        deck.left_out.setdefault("BOUNDARY and *RIGID BODY in directions of *TRANSFORM", deck.left_out["TRANSFORM"])
        deck.holds, deck.links = [], []
    stated = Stated(
        tuple(deck.properties),
        tuple(StatedMaterial(name, constants) for name, constants in deck.materials.items()),
        masses=tuple(deck.masses),
        links=tuple(deck.links),
        holds=tuple(deck.holds),
        left_out=tuple(f"*{word} (line {number})" for word, number in deck.left_out.items()),
        elements={name: np.concatenate(some) for name, some in deck.elements.items()},
        active=tuple(dict.fromkeys(one.name for one in deck.holds)),
    )
    return Gathered(
        np.concatenate(deck.nodes),
        np.concatenate(deck.points),
        deck.blocks,
        {name: np.concatenate(some) for name, some in deck.node_sets.items() if some},
        {name: np.concatenate(some) for name, some in deck.cell_sets.items() if some},
        stated,
    )


def _keywords(path: Path, data: bytes, depth: int) -> list[Keyword]:
    """All keywords with their data lines, those of included files in their places."""
    found: list[Keyword] = []
    pending = ""
    for number, line in enumerate(lines_of(path, data), 1):
        if line.startswith("**") or not line.strip():
            continue
        text = pending + line.strip()
        pending = text if line.startswith("*") and text.endswith(",") else ""
        if pending:
            continue
        if not text.startswith("*"):
            if found:
                found[-1].rows.append((number, [word.strip() for word in text.rstrip(",").split(",")]))
            continue
        first, *others = (one.strip() for one in text[1:].split(","))
        pairs = (one.partition("=") for one in others if one)
        options = {key.strip().upper().replace(" ", ""): value.strip().strip('"') for key, _, value in pairs}
        keyword = Keyword(path, number, first.upper().replace(" ", ""), options, [])
        if keyword.word != "INCLUDE":
            found.append(keyword)
            continue
        if depth > 5:
            raise wrong_line(path, number, "files that include each other", "an end to it")
        try:
            inner = beside(str(path), keyword.option("INPUT"))
            found += _keywords(inner, content(inner, LARGEST, "an included file"), depth + 1)
        except InputError as error:
            if getattr(error, "errors", ()):
                raise
            raise wrong_line(path, number, error.got, error.expected, error.do) from None
    return found


def _read(keyword: Keyword, deck: Deck) -> None:
    word, path, number = keyword.word, keyword.path, keyword.number
    if word == "NODE":
        _nodes(keyword, deck)
    elif word == "ELEMENT":
        _elements(keyword, deck)
    elif word in ("NSET", "ELSET"):
        _set(keyword, deck.node_sets if word == "NSET" else deck.cell_sets, keyword.option(word))
    elif word in ("SHELLSECTION", "SOLIDSECTION"):
        given = float(floats(path, keyword.rows[:1])[0]) if word[1] == "H" and keyword.rows else None
        deck.properties.append(StatedProperty(keyword.option("ELSET"), given, keyword.options.get("MATERIAL", "")))
    elif word in STATED:
        STATED[word](keyword, deck)
    elif word in ("PART", "INSTANCE"):
        seen = deck.parts if word == "PART" else deck.instances
        seen.append(keyword.options.get("NAME", ""))
        if len(seen) > 1 or (word == "INSTANCE" and keyword.rows):
            got = "a second part" if word == "PART" else "an instance that is moved, or a second one"
            raise wrong_line(path, number, got, "one part in its own place", "write the input file without parts")
    elif word in _MOVES:
        raise wrong_line(path, number, f"*{word}, which makes or moves nodes or elements", "nodes and elements in full")
    elif word in _JOINS:
        deck.left_out.setdefault(word, number)


def _nodes(keyword: Keyword, deck: Deck) -> None:
    path = keyword.path
    wide = [(number, words) for number, words in keyword.rows if not 3 <= len(words) <= 4]
    if wide:
        raise wrong_line(path, wide[0][0], f"{len(wide[0][1])} numbers of a node", "a number and x, y, z")
    numbers = integers(path, ((number, words[:1]) for number, words in keyword.rows))
    places = floats(path, ((number, [word or "0" for word in (*words[1:], "0")[:3]]) for number, words in keyword.rows))
    deck.nodes.append(numbers)
    deck.points.append(places.reshape(-1, 3))
    if "NSET" in keyword.options:
        deck.node_sets.setdefault(keyword.options["NSET"], []).append(numbers)


def _elements(keyword: Keyword, deck: Deck) -> None:
    name = keyword.option("TYPE").upper()
    if name == "MASS" and "ELSET" in keyword.options:
        wrong = next((number for number, words in keyword.rows if len(words) != 2), None)
        if wrong is not None:
            raise wrong_line(keyword.path, wrong, "an element of type MASS", "its number and its node")
        deck.lumps.setdefault(keyword.options["ELSET"], []).extend(integers(keyword.path, keyword.rows)[1::2].tolist())
        return
    if name in ("MASS", "ROTARYI", "SPRINGA", "SPRING1", "SPRING2", "DASHPOTA"):
        deck.left_out.setdefault(f"ELEMENT, TYPE={name}", keyword.number)
        return
    kind = next((kind for pattern, kind in _KINDS if re.fullmatch(pattern, name)), None)
    if kind is None:
        raise wrong_line(
            keyword.path,
            keyword.number,
            f"elements of type {name}",
            "bars, shells, tetrahedra or hexahedra: B31, S3, S4, S8R, C3D4, C3D10, C3D8, C3D20 and their like",
        )
    width = 1 + KINDS[kind].nodes
    flat = integers(keyword.path, keyword.rows)
    if len(flat) % width:
        number, count = _odd_element(keyword, width)
        which = "the last element" if number == keyword.rows[-1][0] else "an element"
        got = f"{count} numbers of {which} of type {name}"
        raise wrong_line(keyword.path, number, got, f"{width}: its own and its nodes")
    rows = flat.reshape(-1, width)
    nodes = rows[:, 1:][:, _ORDER[kind]] if kind in _ORDER else rows[:, 1:]
    deck.blocks.append(Block(kind, rows[:, 0], nodes))
    if not name.startswith(_MARKS):
        deck.elements.setdefault(name, []).append(rows[:, 0])
    if "ELSET" in keyword.options:
        deck.cell_sets.setdefault(keyword.options["ELSET"], []).append(rows[:, 0])


def _odd_element(keyword: Keyword, width: int) -> tuple[int, int]:
    """The line where the first element begins that has not `width` numbers, and how many it has."""
    start, count = keyword.number, 0
    for number, words in keyword.rows:
        if count and count + len(words) > width:
            break
        start = start if count else number
        count += len(words)
        if count > width:
            break
        count %= width
    return start, count


def _set(keyword: Keyword, sets: dict[str, list[Integers]], name: str) -> None:
    """Numbers, names of other sets, or first, last and step."""
    into = sets.setdefault(name, [])
    by_case = {one.upper(): one for one in sets}
    for number, words in keyword.rows:
        if "GENERATE" in keyword.options:
            ends = integers(keyword.path, [(number, words)]).tolist()
            if len(ends) not in (2, 3) or (len(ends) == 3 and ends[2] < 1):
                raise wrong_line(keyword.path, number, f"'{', '.join(words)}'", "first, last and step")
            into.append(np.arange(ends[0], ends[1] + 1, ends[2] if len(ends) == 3 else 1))
            continue
        plain = [word for word in words if word and not is_number(word)]
        into.append(integers(keyword.path, [(number, [word for word in words if is_number(word)])]))
        for word in plain:
            other = by_case.get(word.strip('"').upper())
            if other is None:
                raise wrong_line(keyword.path, number, f"'{word}', no set above", "numbers or names of sets")
            into.extend(sets[other][:])


def _constants(keyword: Keyword, constants: dict[str, float]) -> None:
    if keyword.options.get("TYPE", "ISOTROPIC").upper() not in ("ISOTROPIC", "ISO") or not keyword.rows:
        constants["other than isotropic"] = 1.0
        return
    values = floats(keyword.path, keyword.rows[:1]).tolist()
    constants.update(zip(("E", "nu") if keyword.word == "ELASTIC" else ("rho",), values, strict=False))
