"""Sections of an input file of Abaqus: thickness and material of sets of cells, and what of it is not made."""

from __future__ import annotations

from contextlib import suppress
from typing import Final

from femstruct.files.inputs.mesh_files.abaqus.abaqus_deck import Deck, Keyword, known_as
from femstruct.files.inputs.mesh_files.text_lines import floats, wrong_line
from femstruct.model.imported.imported_mesh import StatedLayer, StatedProperty
from femstruct.model.imported.stated.left_out import Makes

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
