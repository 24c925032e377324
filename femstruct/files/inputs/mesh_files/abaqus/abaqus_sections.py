"""Sections of an input file of Abaqus: thickness and material of sets of cells, and what of it is not made."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Final, Literal

import numpy as np

from femstruct.arrays import Integers
from femstruct.files.inputs.mesh_files.abaqus.abaqus_deck import Deck, Keyword, known_as
from femstruct.files.inputs.mesh_files.text_lines import floats, wrong_line
from femstruct.model.imported.imported_mesh import StatedLayer, StatedProperty, StatedSpread
from femstruct.model.imported.stated.left_out import Makes

_PER: Final[Mapping[str, Literal["area", "volume", "total"]]] = {
    "MASS PER AREA": "area", "MASS PER VOLUME": "volume", "TOTAL MASS": "total",
}  # fmt: skip
_OFFSETS: Final = {"SPOS": 0.5, "SNEG": -0.5, "MIDDLE": 0.0, "MIDSURFACE": 0.0}  # of the thickness


def shell_section(keyword: Keyword, deck: Deck) -> None:
    """Thickness and material, or layers; offset, thickness by node and directions are named."""
    options, name = keyword.options, known_as(deck.cell_sets, keyword.option("ELSET"))

    def leave(option: str, makes: Makes, changes: str) -> None:
        deck.of_sets.append((name, f"{option} of *SHELL SECTION", makes, changes, keyword.number))

    if "COMPOSITE" in options:
        layers = _layers(keyword)
        leave("COMPOSITE", Makes.LAY_UP, f"{len(layers)} layers")
        deck.properties.append(StatedProperty(name, None, options.get("MATERIAL", ""), layers))
    else:
        given = [(number, words[:1]) for number, words in keyword.rows[:1] if words and words[0]]
        thickness = float(floats(keyword.path, given)[0]) if given else None
        deck.properties.append(StatedProperty(name, thickness, options.get("MATERIAL", "")))
        if "ORIENTATION" in options:
            leave("ORIENTATION", Makes.ORIENTATION, "a direction of the material")
    if _is_off(options.get("OFFSET", "0")):
        what = f"the middle of the thickness lies {options['OFFSET']} of the thickness beside the nodes"
        leave("OFFSET", Makes.OFFSET, what)
    if "NODALTHICKNESS" in options:
        leave("NODAL THICKNESS", Makes.THICKNESS, "a thickness at each node")


def nonstructural_mass(keyword: Keyword, deck: Deck) -> None:
    """Mass on the cells of a set: per area or volume of them, or all of it."""
    units = " ".join(keyword.options.get("UNITS", "").upper().split())
    if units not in _PER or not keyword.rows or not keyword.rows[0][1]:
        keyword.leave_out(deck, Makes.SECTION, "mass of cells")
        return
    number, words = keyword.rows[0]
    name = known_as(deck.cell_sets, keyword.option("ELSET"))
    amount = float(floats(keyword.path, [(number, words[:1])])[0])
    spread = StatedSpread(f"*{keyword.written} of {name}", np.zeros(0, np.int64), amount, _PER[units])
    deck.spread.append((name, spread, keyword.number))


def spread_on(deck: Deck, cell_sets: Mapping[str, Integers]) -> tuple[StatedSpread, ...]:
    """Mass on cells by their numbers, and count it, for parts that do not take it."""
    found = []
    for name, one, line in deck.spread:
        cells = cell_sets.get(name, np.zeros(0, np.int64))
        how = "in all" if one.per == "total" else f"per {one.per}"
        deck.left_out.add(one.what, Makes.SPREAD, f"{one.amount:g} of mass {how}, which does not stiffen", line, cells)
        found.append(replace(one, cells=cells))
    return tuple(found)


def _is_off(word: str) -> bool:
    """Whether an offset is another one than 0: a number, a face, or the name of a distribution."""
    try:
        return float(_OFFSETS.get(word.upper(), word or 0)) != 0.0
    except ValueError:
        return True


def membrane_section(keyword: Keyword, deck: Deck) -> None:
    """Cells without stiffness in bending, which shells here have."""
    options, name = keyword.options, known_as(deck.cell_sets, keyword.option("ELSET"))
    given = [(number, words[:1]) for number, words in keyword.rows[:1] if words and words[0]]
    thickness = float(floats(keyword.path, given)[0]) if given else None
    deck.properties.append(StatedProperty(name, thickness, options.get("MATERIAL", "")))
    what = "a membrane, without stiffness in bending"
    deck.of_sets.append((name, f"*{keyword.written}", Makes.SECTION, what, keyword.number))


def _layers(keyword: Keyword) -> tuple[StatedLayer, ...]:
    """Rows of a thickness, points over it, a material and an angle or the name of an orientation."""
    found = []
    for number, words in keyword.rows:
        thickness, _, material, turned, *_ = [*words, "", "", "", ""]
        if not material:
            raise wrong_line(keyword.path, number, f"'{', '.join(words)}'", "thickness, points, material, orientation")
        angle: float | str = turned
        with suppress(ValueError):
            angle = float(turned or 0)
        found.append(StatedLayer(material, float(floats(keyword.path, [(number, [thickness])])[0]), angle))
    return tuple(found + found[::-1] if "SYMMETRIC" in keyword.options else found)


def solid_section(keyword: Keyword, deck: Deck) -> None:
    """The material; layers and directions are named."""
    options, name = keyword.options, known_as(deck.cell_sets, keyword.option("ELSET"))
    deck.properties.append(StatedProperty(name, None, options.get("MATERIAL", "")))
    word = f"of *{keyword.written}"
    if "COMPOSITE" in options:
        what = "layers of other materials"
        deck.of_sets.append((name, f"COMPOSITE {word}", Makes.SECTION, what, keyword.number))
    elif "ORIENTATION" in options:
        what = "directions of the material"
        deck.of_sets.append((name, f"ORIENTATION {word}", Makes.ORIENTATION, what, keyword.number))
