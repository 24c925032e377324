"""What mesh files state and no part of a structure has: cells of other kinds or sets, masses, links, held nodes, and
what no reader makes, such as bars, offsets and mass per area; most harmful first.

Where a part or the model states the thing itself, that is what holds: `thickness`, `offset`, `layers` and
`orientation` of a part stand in place of those of its cells in the file. Frames, springs, masses, joints and
supports of the model may stand for those of the file: the finding then limits trust only.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from femstruct.arrays import Integers
from femstruct.errors import Finding, list_some
from femstruct.model.attached import TAKEN, same_file
from femstruct.model.imported_mesh import HARMLESS, ImportedMesh, LeftOut, Makes, Stated, StatedMaterial, StatedProperty
from femstruct.model.materials import Material
from femstruct.model.part import Part
from femstruct.model.structure import Structure

WORDS: Final = {"line": "bars", "tri": "triangles", "quad": "quadrilaterals", "tet": "tetrahedra", "hex": "hexahedra"}
SHOWN: Final = 4  # kinds of what is not used
KINDS_SHOWN: Final = 8  # kinds of what forbids trust
DIFFERS: Final = 0.01  # of a modulus, density or thickness: steels differ by less
_OFFER: Final = "What the file states is taken as it is by a part"
_DO: Final = {  # what the model can state instead
    Makes.OFFSET: "write 'offset'",
    Makes.THICKNESS: "write 'thickness'",
    Makes.LAY_UP: "write 'layers'",
    Makes.SPREAD: "write 'nonstructural' of a shell, or masses",
    Makes.ORIENTATION: "write 'orientation'",
    Makes.MATERIAL: "write a part for each, with 'set'; the nodes that they share join them",
    Makes.BARS: "write frames",
    Makes.SPRINGS: "write springs",
    Makes.MASSES: "write masses",
    Makes.LINKS: "write joints or constraints",
    Makes.SUPPORTS: "write supports",
}
_NO_NOUN: Final = "nothing in a model stands for it"
_CONSISTENT: Final[Mapping[float, tuple[float, float]]] = {1.0: (1.0, 1.0), 1e-3: (1e6, 1e12)}  # Pa, kg/m^3


def unused_findings(structure: Structure) -> tuple[Finding, ...]:
    """What is not used of each mesh file, whichever of its parts would use it."""
    by_file: dict[tuple[object, ...], list[_User]] = {}
    for part in structure.parts:
        for mesh, cells in part.taken():
            counts = tuple((kind, len(some)) for kind, some in mesh.cells.items())
            by_file.setdefault((mesh.source, len(mesh.points), counts), []).append(_User(part, mesh, cells))
    return tuple(finding for users in by_file.values() for finding in _of_one(structure, users))


@dataclass(frozen=True, eq=False)
class _User:
    """A part that takes cells of a file, by the rows of them of each kind."""

    part: Part
    mesh: ImportedMesh
    cells: Mapping[str, Integers]

    @property
    def numbers(self) -> Integers:
        """Numbers of its cells in the file."""
        some = (self.mesh.cell_numbers[kind][rows] for kind, rows in self.cells.items())
        return np.concatenate([np.zeros(0, np.int64), *some])


def _of_one(structure: Structure, users_of_it: list[_User]) -> Iterator[Finding]:
    mesh, names = users_of_it[0].mesh, [one.part.name for one in users_of_it]
    used = {kind: np.zeros(len(cells), dtype=bool) for kind, cells in mesh.cells.items()}
    for one in users_of_it:
        for kind, rows in one.cells.items():
            used[kind][rows] = True
    users = tuple((one.mesh, one.cells) for one in users_of_it)
    taken = [some for part in structure.parts if (some := part.attaches(users)) and same_file(mesh, some.mesh)]
    open_ones = dict(_beside(structure, mesh, names, {word for some in taken for word in some.take}))
    left = [words for some in taken for words in some.left]
    yield from _cut(mesh, names)
    judged = _Judged.of(structure, users_of_it, _cells(mesh, used))
    owner = f"{', '.join(names)}: {mesh.source}"
    if judged.missing:
        yield Finding(
            "mesh-states-more",
            f"{owner} states what the model does not have, so that it is another structure: "
            f"{_listed(judged.missing, KINDS_SHOWN)}",
            {"kinds": len(judged.missing)},
            severe=True,
        )
    unused = [*judged.elsewhere, *open_ones.values(), *left]
    if unused:
        offer = "" if not open_ones else f". {_OFFER} {_written(mesh, list(open_ones))}"
        yield Finding(
            "mesh-states-more",
            f"{owner} states what no part uses: {list_some(unused, SHOWN)}. Their stiffness, "
            f"mass and supports are missing unless the model has them otherwise: write parts, masses, joints, supports"
            f"{offer}",
            {"kinds": len(unused)},
        )
    if replaced := [*judged.replaced, *_other_numbers(users_of_it)]:
        message = f"{owner} states otherwise what the model states, which holds: {_listed(replaced, KINDS_SHOWN)}"
        yield Finding("mesh-stated-otherwise", message, {"kinds": len(replaced)})
    if idle := _idle(mesh.stated):
        message = f"{owner} states what has little or no effect on a linear model of vibration: {'; '.join(idle)}"
        yield Finding("mesh-without-effect", message, {"kinds": len(idle)})


@dataclass(frozen=True)
class _Judged:
    """What a file states, in words. missing : and the model has not. elsewhere : and the model may have otherwise, or
    no part takes. replaced : and a part states itself."""

    missing: tuple[str, ...]
    elsewhere: tuple[str, ...]
    replaced: tuple[str, ...]

    @classmethod
    def of(cls, structure: Structure, users: list[_User], cells: Iterator[tuple[Makes, str]]) -> _Judged:
        stated = users[0].mesh.stated
        has = {makes for part in structure.parts for makes in part.stands_for()}
        has |= {Makes.LINKS} if structure.joints or structure.constraints else set()
        has |= {Makes.SUPPORTS} if structure.supports else set()
        missing, elsewhere, replaced = [], [], []
        for one in stated.left_out:
            if one.makes in HARMLESS:
                continue
            if one.cells is not None:
                for user in users:
                    count = int(np.isin(user.numbers, one.cells).sum())
                    if count and one.makes not in user.part.takes():
                        words = f"{one.what}{f' (line {one.line})' if one.line else ''} of {count} cells"
                        if one.makes not in user.part.stands_for():
                            missing.append(_harm(words, one.makes, one.changes))
                        elif not _has_no_direction(one, user.part):
                            replaced.append(words)
            elif one.makes in has:
                elsewhere.append(one.named)
            else:
                missing.append(_harm(one.named, one.makes, one.changes))
        for makes, words in cells:
            if makes in HARMLESS or makes in has:
                elsewhere.append(words)
            else:
                missing.append(_harm(words, makes, "stiffness and mass"))
        missing += [words for user in users for words in _several_materials(user, stated)]
        return cls(tuple(missing), tuple(elsewhere), tuple(replaced))


def _listed(words: Sequence[str], most: int) -> str:
    """Phrases one after the other, the first of them where they are many."""
    more = f"; and {len(words) - most} more" if len(words) > most else ""
    return "; ".join(words[:most]) + more


def _idle(stated: Stated) -> list[str]:
    """What has little or no effect, by the reason."""
    by_reason: dict[str, list[str]] = {}
    for one in stated.left_out:
        if one.makes in HARMLESS:
            by_reason.setdefault(one.changes, []).append(one.named)
    return [f"{', '.join(named)} [{reason}]" for reason, named in by_reason.items()]


def _harm(words: str, makes: Makes, changes: str) -> str:
    return f"{words} [{changes}; {_DO.get(makes, _NO_NOUN)}]"


def _has_no_direction(one: LeftOut, part: Part) -> bool:
    """Whether it is a direction of a material that has none."""
    return one.makes is Makes.ORIENTATION and all(isinstance(some, Material) for some in part.materials())


def _properties_of(user: _User, stated: Stated) -> Iterator[tuple[StatedProperty, int]]:
    """What a file states of cells of a part, with their number."""
    numbers = user.numbers
    for one in stated.properties:
        own = user.mesh.cell_sets.get(one.cells, {})
        of = [user.mesh.cell_numbers[kind][rows] for kind, rows in own.items()]
        if count := int(np.isin(numbers, np.concatenate([np.zeros(0, np.int64), *of])).sum()):
            yield one, count


def _materials_of(user: _User, stated: Stated) -> dict[str, int]:
    """Materials that a file states for cells of a part, with the number of these."""
    found: dict[str, int] = {}
    for one, count in _properties_of(user, stated):
        if one.material:
            found[one.material] = found.get(one.material, 0) + count
    return found


def _several_materials(user: _User, stated: Stated) -> Iterator[str]:
    """Materials of a file that differ, where a part has one for all of its cells."""
    named = _materials_of(user, stated)
    known = {one.name.upper(): one for one in stated.materials}
    different = {_constants(known.get(name.upper()), name) for name in named}
    if len(different) > 1:
        listed = [f"{name} of {count} cells{_shown(known.get(name.upper()))}" for name, count in named.items()]
        yield f"{len(different)} materials where {user.part.name} has one: {_listed(listed, 4)} [{_DO[Makes.MATERIAL]}]"


def _constants(one: StatedMaterial | None, name: str) -> tuple[object, ...]:
    return tuple(sorted(one.constants.items())) if one is not None and one.constants else (name.upper(),)


def _shown(one: StatedMaterial | None) -> str:
    words = [f"{key} {value:g}" for key, value in ({} if one is None else one.constants).items() if key in ("E", "rho")]
    return f" ({', '.join(words)})" if words else ""


def _other_numbers(users: list[_User]) -> Iterator[str]:
    """Thicknesses and the constants of the one material that the file states and the part has otherwise."""
    for user in users:
        stated = user.mesh.stated
        named = _materials_of(user, stated)
        units = _CONSISTENT.get(user.mesh.scale)
        made_of = user.part.materials()
        own = made_of[0] if len(made_of) == 1 else None
        if len(named) == 1 and units is not None and isinstance(own, Material):
            (name,) = named
            material = next((one for one in stated.materials if one.name.upper() == name.upper()), None)
            for key, unit, word, ours in (("E", units[0], "Pa", own.E), ("rho", units[1], "kg/m^3", own.rho)):
                theirs = unit * (material.constants.get(key, 0.0) if material is not None else 0.0)
                if theirs and abs(theirs - ours) > DIFFERS * ours:
                    yield f"{key} {theirs:.4g} {word} of {name}, {ours:.4g} {word} of {user.part.name}"
        written = user.part.written_thickness()
        for one, count in _properties_of(user, stated) if written else ():
            t = one.thickness
            if t and all(abs(t - mine) > DIFFERS * mine for mine in written):
                shown = ", ".join(f"{1e3 * mine:.4g}" for mine in written)
                yield f"thickness {1e3 * t:.4g} mm of {count} cells of {one.cells}, {shown} mm of {user.part.name}"


def _cut(mesh: ImportedMesh, names: list[str]) -> Iterator[Finding]:
    """What a file shows that ends too early: no word at its end, nodes without elements."""
    owner = f"{', '.join(names)}: {mesh.source}"
    if mesh.stated.open_end:
        yield Finding(
            "mesh-without-end", f"{owner} has no {mesh.stated.open_end}. If the file is cut, the rest is missing"
        )
    ours = np.zeros(len(mesh.points), dtype=bool)
    for nodes in (*mesh.cells.values(), *(one.nodes for one in mesh.stated.links)):
        ours[nodes.ravel()] = True
    ours[[one.node for one in mesh.stated.links] + [one.node for one in mesh.stated.masses]] = True
    if lone := int((~ours).sum()):
        yield Finding(
            "nodes-alone",
            f"{owner} has {lone} nodes of {len(ours)} that no element, link or mass uses, such as "
            f"{list_some(mesh.numbers[~ours].tolist(), SHOWN)}. They are left out. If they belong to the part, "
            "elements are missing: is the file cut?",
            {"nodes": lone},
        )


def _written(mesh: ImportedMesh, words: list[str]) -> str:
    """The part that takes something of a file, as it is written."""
    scale = {1.0: "", 1e-3: "scale: mm, "}.get(mesh.scale, f"scale: {mesh.scale:g}, ")
    return f"{{type: attachments, mesh: {mesh.source}, {scale}take: [{', '.join(words)}]}}"


def _cells(mesh: ImportedMesh, used: Mapping[str, np.ndarray]) -> Iterator[tuple[Makes, str]]:
    """Cells that no part takes: elements by their type in the file, or those with nodes that no part has. Bars are of
    no kind that a part could take; of the others it is the model's choice which it takes."""
    ours = np.zeros(len(mesh.points), dtype=bool)
    for kind, mask in used.items():
        ours[mesh.cells[kind][mask].ravel()] = True
    for kind, mask in used.items():
        numbers = mesh.cell_numbers[kind]
        left = ~mask
        for word, elements in mesh.stated.elements.items():
            of_type = left & np.isin(numbers, elements)
            if of_type.any():
                makes = Makes.BARS if kind.startswith("line") else Makes.SLIGHT
                yield makes, f"{of_type.sum()} {word} elements{_sets_of(mesh, kind, of_type)}"
            left &= ~of_type
        apart = left & ~ours[mesh.cells[kind]].all(axis=1)
        if apart.any():
            words = f"{apart.sum()} {WORDS[kind.rstrip('0123456789')]}{_sets_of(mesh, kind, apart)}"
            yield Makes.SLIGHT, words


def _sets_of(mesh: ImportedMesh, kind: str, which: np.ndarray) -> str:
    names = [name for name, of in mesh.cell_sets.items() if kind in of and which[of[kind]].any()]
    return f" (set {list_some(names, 3)})" if names else ""


def _beside(structure: Structure, mesh: ImportedMesh, names: list[str], taken: set[str]) -> Iterator[tuple[str, str]]:
    """Masses, links, and held nodes that no support of a set holds, by the word for what takes them; none taken."""
    stated = mesh.stated
    held = [
        mesh.nodes_of(one.region.named)
        for one in structure.supports
        if one.on in names and one.region is not None and one.region.named in mesh.set_names
    ]
    ours = np.concatenate([np.zeros(0, np.int64), *held])
    whole = any(one.on in names and one.region is None for one in structure.supports)
    open_ones = [one for one in stated.holds if not (whole or np.isin(one.nodes, ours).all())]
    counts = (len(open_ones), len(stated.links), len(stated.masses))
    for word, count, what in zip(TAKEN, counts, ("held sets", "links", "masses"), strict=True):
        if count and word not in taken:
            yield word, f"{count} {what}"
