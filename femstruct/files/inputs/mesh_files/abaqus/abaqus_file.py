"""Meshes of Abaqus and CalculiX: .inp.

Read here and not by meshio 5.3, which keeps the last of several *NODE blocks only, and neither sections nor materials.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

import numpy as np

from femstruct.arrays import Integers
from femstruct.errors import InputError
from femstruct.files.inputs.mesh_files.abaqus.abaqus_deck import Deck, Keyword, known_as
from femstruct.files.inputs.mesh_files.abaqus.abaqus_sections import (
    membrane_section,
    nonstructural_mass,
    shell_section,
    solid_section,
    spread_on,
)
from femstruct.files.inputs.mesh_files.abaqus.abaqus_stated import STATED, along_own_directions, is_number
from femstruct.files.inputs.mesh_files.abaqus.abaqus_words import LEFT_OUT, ONE_LINE, OPTIONS, WITHOUT_EFFECT
from femstruct.files.inputs.mesh_files.text_lines import floats, integers, lines_of, wrong_line
from femstruct.files.inputs.opening import beside, content
from femstruct.model.imported.cell_kinds import KINDS
from femstruct.model.imported.gathering import Block, Gathered
from femstruct.model.imported.imported_mesh import (
    Stated,
    StatedMaterial,
)
from femstruct.model.imported.stated.left_out import Makes

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
_PLANE: Final = ("CPS", "CPE", "CAX")
_ORDER: Final = {"line3": [0, 2, 1]}  # the middle node of a bar is its second one
_MOVES: Final = ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "SUBMODEL", "SYMMETRICMODELGENERATION")
_LOADING: Final = ("STATIC", "VISCO", "COUPLEDTEMPERATURE-DISPLACEMENT", "DYNAMIC")
_VIBRATING: Final = ("FREQUENCY", "COMPLEXFREQUENCY")
_LEFT_OUT: Final[Mapping[str, tuple[Makes, str]]] = {  # types of elements that are not made
    "MASS": (Makes.MASSES, "masses at nodes"),
    "ROTARYI": (Makes.MASSES, "moments of inertia at nodes"),
    **dict.fromkeys(("SPRINGA", "SPRING1", "SPRING2"), (Makes.SPRINGS, "springs at nodes")),
    **dict.fromkeys(("DASHPOTA", "DASHPOT1", "DASHPOT2"), (Makes.SPRINGS, "dashpots at nodes")),
    **dict.fromkeys(("GAPUNI", "GAPCYL", "GAPSPHER"), (Makes.SPRINGS, "gaps between nodes")),
    "DCOUP3D": (Makes.LINKS, "nodes that follow others"),
}
_FIRST: Final = ("NODE", "ELEMENT", "NSET", "ELSET")  # what other keywords may name before it stands there
_NAMES: Final = ("PART", "INSTANCE", "ASSEMBLY")


def read_abaqus(path: Path, data: bytes) -> Gathered:
    """What an input file has: nodes, elements, sets, sections, materials and held nodes of its model.

    What would move nodes is refused; every other keyword and option that no reader reads is counted among what is left
    out, as the tables of `words` have it. Raises InputErrors with file and line.
    """
    deck = Deck()
    keywords: list[Keyword] = []
    files = _keywords(path, data, 0, keywords)
    for keyword in keywords:
        if keyword.word in _FIRST:
            _take(keyword, deck)
    material, step, judged = "", 0, _step_that_vibrates(keywords)
    for keyword in keywords:
        step += keyword.word == "STEP"
        if keyword.word == "MATERIAL":
            material = keyword.option("NAME")
            deck.materials[material] = {}
        if step > judged and keyword.word == "BOUNDARY":
            keyword.leave_out(deck, Makes.SLIGHT, "held nodes of a later state", "BOUNDARY of a later step")
        elif keyword.word in ("ELASTIC", "DENSITY"):
            _constants(keyword, deck.materials.setdefault(material, {}))
        elif keyword.word not in _FIRST:
            if keyword.word == "BOUNDARY" and keyword.options.get("OP", "").upper() == "NEW" and step > deck.anew:
                deck.holds, deck.anew = [], step  # what was held before is free
            _take(keyword, deck)
    if not deck.nodes:
        raise InputError("", got=f"'{path.name}' without *NODE", expected="an input file with nodes and elements")
    _preload(keywords, deck)
    along_own_directions(deck)
    cell_sets = _without_others(deck)
    for name, what, makes, changes, line in deck.of_sets:
        deck.left_out.add(what, makes, changes, line, cell_sets.get(name, ()))
    spread = spread_on(deck, cell_sets)
    elements = _elements_by_type(deck, cell_sets)
    _plane_elements(deck, elements)
    stated = Stated(
        tuple(deck.properties),
        tuple(StatedMaterial(name, constants) for name, constants in deck.materials.items()),
        masses=tuple(deck.masses),
        links=tuple(deck.links),
        holds=tuple(deck.holds),
        left_out=deck.left_out.found,
        elements=elements,
        active=tuple(dict.fromkeys(one.name for one in deck.holds)),
        spread=spread,
    )
    return Gathered(
        np.concatenate(deck.nodes),
        np.concatenate(deck.points),
        deck.blocks,
        {name: np.concatenate(some) for name, some in deck.node_sets.items() if some},
        cell_sets,
        stated,
        included=files,
    )


def _step_that_vibrates(keywords: list[Keyword]) -> int:
    """The number of the step, from 1, whose supports are those of the model: the first that asks for modes, or the
    first one; what is held in steps before holds on."""
    step = 0
    for keyword in keywords:
        step += keyword.word == "STEP"
        if keyword.word in _VIBRATING:
            return step
    return 1


def _without_others(deck: Deck) -> dict[str, Integers]:
    """Sets of elements without those that are left out, such as springs; those that had no others are gone."""
    made = {name: np.concatenate(some) for name, some in deck.cell_sets.items() if some}
    kept = {name: some[~np.isin(some, deck.others)] for name, some in made.items()}
    return {name: some for name, some in kept.items() if len(some) or not len(made[name])}


def _elements_by_type(deck: Deck, cell_sets: Mapping[str, Integers]) -> dict[str, Integers]:
    """Elements that have stiffness or mass by their type: of those that mesh programs write as marks, those with a
    section."""
    of_sections = np.concatenate([np.zeros(0, np.int64), *(cell_sets.get(one.cells, ()) for one in deck.properties)])
    made = {name: np.concatenate(some) for name, some in deck.elements.items()}
    real = {name: some[np.isin(some, of_sections)] if name.startswith(_MARKS) else some for name, some in made.items()}
    return {name: some.astype(np.int64) for name, some in real.items() if len(some)}


def _plane_elements(deck: Deck, elements: Mapping[str, Integers]) -> None:
    """Name elements of a plane problem, which a part would make a shell of."""
    for name, some in elements.items():
        if name.startswith(_PLANE):
            what = "elements of a plane or axisymmetric problem, without stiffness in bending"
            deck.left_out.add(f"{name} elements", Makes.SECTION, what, 0, some.tolist(), len(some))


def _preload(keywords: list[Keyword], deck: Deck) -> None:
    """Name a step whose vibration is that of a body under load: PERTURBATION, or large displacements, after a load."""
    loaded, large, perturbed, start = False, False, False, 0
    for keyword in keywords:
        if keyword.word == "STEP":
            perturbed, start = "PERTURBATION" in keyword.options, keyword.number
            large |= "NLGEOM" in keyword.options and keyword.options["NLGEOM"].upper() != "NO"
        elif keyword.word in _LOADING and not perturbed:
            loaded = True
        elif keyword.word in _VIBRATING and loaded and (perturbed or large):
            what = "a body under load vibrates, whose forces change its stiffness"
            deck.left_out.add(f"*{keyword.written} after a step of loads", Makes.PRELOAD, what, start)


def _keywords(path: Path, data: bytes, depth: int, found: list[Keyword]) -> tuple[Path, ...]:
    """Put all keywords with their data lines behind those that are found already; included files, which are returned,
    stand in their places, also within the data of a keyword."""
    pending = ""
    included: tuple[Path, ...] = ()
    for number, line in enumerate(lines_of(path, data), 1):
        if line.lstrip(" \t>").startswith("**") or not line.strip():
            continue
        text = pending + line.strip()
        pending = text if text.startswith("*") and text.endswith(",") else ""
        if pending:
            continue
        if not text.startswith("*"):
            if not found:
                raise wrong_line(path, number, f"'{text[:60]}' before all keywords", "a keyword, such as *NODE")
            found[-1].rows.append((number, [word.strip() for word in text.rstrip(",").split(",")]))
            continue
        first, *others = (one.strip() for one in text[1:].split(","))
        pairs = (one.partition("=") for one in others if one)
        options = {key.strip().upper().replace(" ", ""): value.strip().strip('"') for key, _, value in pairs}
        keyword = Keyword(path, number, first.upper().replace(" ", ""), options, [], " ".join(first.upper().split()))
        if keyword.word != "INCLUDE":
            found.append(keyword)
            continue
        if depth > 5:
            raise wrong_line(path, number, "files that include each other", "an end to it")
        try:
            inner = beside(str(path), keyword.option("INPUT"))
            more = _keywords(inner, content(inner, LARGEST, "an included file"), depth + 1, found)
            included = (*included, inner, *more)
        except InputError as error:
            if getattr(error, "errors", ()):
                raise
            raise wrong_line(path, number, error.got, error.expected, error.do) from None
    return included


def _take(keyword: Keyword, deck: Deck) -> None:
    """Read a keyword, or count it among what is left out; there is no third way."""
    word = keyword.word
    if word in _MOVES:
        got = f"*{word}, which makes or moves nodes or elements"
        raise wrong_line(keyword.path, keyword.number, got, "nodes and elements in full")
    if word in _READERS:
        _READERS[word](keyword, deck)
    elif word in WITHOUT_EFFECT:
        keyword.leave_out(deck, Makes.NOTHING, WITHOUT_EFFECT[word])
    elif word in LEFT_OUT:
        keyword.leave_out(deck, *LEFT_OUT[word])
    else:
        keyword.leave_out(deck, Makes.UNKNOWN, "a keyword that is not known: is it misspelt?")
    if word in ONE_LINE and "COMPOSITE" not in keyword.options and len(keyword.rows) > 1:
        what = f"data line 2 of *{keyword.written}"
        deck.left_out.add(what, Makes.UNKNOWN, "a line that is not read", keyword.rows[1][0])
    if word in OPTIONS:
        for option in keyword.options:
            if option not in OPTIONS[word].split():
                what = f"option {option} of *{keyword.written}"
                deck.left_out.add(what, Makes.UNKNOWN, "an option that is not read", keyword.number)


def _named(keyword: Keyword, deck: Deck) -> None:
    """Parts and instances: one of each, in its own place."""
    if keyword.word == "ASSEMBLY":
        return
    seen = deck.parts if keyword.word == "PART" else deck.instances
    seen.append(keyword.options.get("NAME", ""))
    if len(seen) > 1 or (keyword.word == "INSTANCE" and keyword.rows):
        got = "a second part" if keyword.word == "PART" else "an instance that is moved, or a second one"
        do = "write the input file without parts"
        raise wrong_line(keyword.path, keyword.number, got, "one part in its own place", do)


def _nodes(keyword: Keyword, deck: Deck) -> None:
    path = keyword.path
    if keyword.options.get("SYSTEM", "R").upper() not in ("", "R"):
        got = f"nodes in the coordinate system {keyword.options['SYSTEM']}"
        raise wrong_line(path, keyword.number, got, "x, y, z", "write the file in global coordinates")
    if "INPUT" in keyword.options:
        raise wrong_line(path, keyword.number, "nodes of another file", "nodes in this one", "write *INCLUDE, INPUT=..")
    wide = [(number, words) for number, words in keyword.rows if len(words) > 4 and any(map(_says, words[4:]))]
    if wide:
        raise wrong_line(path, wide[0][0], f"{len(wide[0][1])} numbers of a node", "a number and x, y, z")
    numbers = integers(path, ((number, words[:1]) for number, words in keyword.rows))
    places = floats(
        path, ((number, [word or "0" for word in (*words[1:], "", "", "")[:3]]) for number, words in keyword.rows)
    )
    deck.nodes.append(numbers)
    deck.points.append(places.reshape(-1, 3))
    if "NSET" in keyword.options:
        deck.node_sets.setdefault(known_as(deck.node_sets, keyword.options["NSET"]), []).append(numbers)


def _says(word: str) -> bool:
    """Whether a field has something else in it than zeros."""
    return bool(word.strip("0.+-eE"))


def _elements(keyword: Keyword, deck: Deck) -> None:
    name = keyword.option("TYPE").upper()
    if name == "MASS" and "ELSET" in keyword.options:
        wrong = next((number for number, words in keyword.rows if len(words) != 2), None)
        if wrong is not None:
            raise wrong_line(keyword.path, wrong, "an element of type MASS", "its number and its node")
        deck.others += integers(keyword.path, keyword.rows)[::2].tolist()
        deck.lumps.setdefault(keyword.options["ELSET"], []).extend(integers(keyword.path, keyword.rows)[1::2].tolist())
        return
    if name in _LEFT_OUT:
        numbers = integers(keyword.path, [(number, words[:1]) for number, words in keyword.rows]).tolist()
        deck.others += numbers
        makes, changes = _LEFT_OUT[name]
        deck.left_out.add(f"*ELEMENT, TYPE={name}", makes, changes, keyword.number, count=len(numbers))
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
    deck.elements.setdefault(name, []).append(rows[:, 0])
    if "ELSET" in keyword.options:
        deck.cell_sets.setdefault(known_as(deck.cell_sets, keyword.options["ELSET"]), []).append(rows[:, 0])


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


def _set(keyword: Keyword, deck: Deck) -> None:
    """Numbers, names of other sets, or first, last and step."""
    sets = deck.node_sets if keyword.word == "NSET" else deck.cell_sets
    into = sets.setdefault(known_as(sets, keyword.option(keyword.word)), [])
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


def _nothing(keyword: Keyword, deck: Deck) -> None:
    """What has been read where it stands: materials."""


def _constants(keyword: Keyword, constants: dict[str, float]) -> None:
    if keyword.options.get("TYPE", "ISOTROPIC").upper() not in ("ISOTROPIC", "ISO") or not keyword.rows:
        constants["other than isotropic"] = 1.0
        return
    values = floats(keyword.path, keyword.rows[:1]).tolist()
    constants.update(zip(("E", "nu") if keyword.word == "ELASTIC" else ("rho",), values, strict=False))


_READERS: Final[Mapping[str, Callable[[Keyword, Deck], None]]] = {
    "NODE": _nodes,
    "ELEMENT": _elements,
    "NSET": _set,
    "ELSET": _set,
    "SHELLSECTION": shell_section,
    "SOLIDSECTION": solid_section,
    "MEMBRANESECTION": membrane_section,
    "NONSTRUCTURALMASS": nonstructural_mass,
    "MATERIAL": _nothing,
    **dict.fromkeys(_NAMES, _named),
    **STATED,
}
