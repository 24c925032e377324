"""Coordinate systems of Nastran: rectangular, cylindrical and spherical, by points or by nodes, and places in them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.files.inputs.mesh_files.nastran.bulk_cards import Card

BASIC: Final = 0
_NEAR: Final = 1e-12  # of unit vectors: rounding


class _Frame(NamedTuple):
    """A system: its origin [3] and its axes [3, 3] as rows, in basic coordinates; the letter of its kind, R, C or S."""

    origin: Floats
    axes: Floats
    kind: str

    def basic(self, places: Floats) -> Floats:
        """Basic coordinates [n, 3] of places [n, 3] in it; angles are in degrees."""
        first, second, third = places.T
        if self.kind == "C":  # r, theta, z
            angle = np.radians(second)
            places = np.stack([first * np.cos(angle), first * np.sin(angle), third], axis=1)
        elif self.kind == "S":  # r, theta from the z axis, phi about it
            tilt, turn = np.radians(second), np.radians(third)
            flat = first * np.sin(tilt)
            places = np.stack([flat * np.cos(turn), flat * np.sin(turn), first * np.cos(tilt)], axis=1)
        return np.asarray(self.origin + places @ self.axes)


class Systems:
    """Systems of a file by their numbers. cards : CORD2R and its like, each with those of CORD1R apart."""

    def __init__(self, cards: Sequence[Card]) -> None:
        self._cards: dict[int, tuple[Card, int]] = {}
        for card in cards:
            for first in (0, 4) if card.name[4] == "1" else (0,):
                if first == 0 or card.field(first):
                    number = card.whole(first)
                    if number in self._cards:
                        raise card.refuse(f"the number {number} again", "systems whose numbers differ")
                    self._cards[number] = card, first
        self._found: dict[int, _Frame] = {BASIC: _Frame(np.zeros(3), np.eye(3), "R")}
        self._asked: list[int] = []

    def places(self, numbers: Integers, points: Floats, of: Integers, where: Mapping[int, Card]) -> Floats:
        """Basic coordinates [n, 3] of nodes. numbers [n] : of them; points [n, 3] : in the system of each; of [n] :
        numbers of these. where : cards of those that are in another system than the basic one. Raises InputErrors."""
        found = np.array(points)
        self._rows = {int(node): row for row, node in enumerate(numbers.tolist())} if self._cards else {}
        self._points, self._of, self._where = points, of, where
        for system in np.unique(of[of != BASIC]).tolist():
            rows = np.flatnonzero(of == system)
            found[rows] = self._frame(int(system), where[int(numbers[rows[0]])]).basic(points[rows])
        return found

    def turned(self, numbers: Integers, of: Integers, where: Mapping[int, Card]) -> Integers:
        """Nodes whose directions are not the basic ones. of [n] : numbers of the systems of their motion."""
        along = [
            system
            for system in np.unique(of).tolist()
            if (frame := self._frame(int(system), where[int(numbers[of == system][0])]) if system else None) is None
            or (frame.kind == "R" and np.abs(frame.axes - np.eye(3)).max() < _NEAR)
        ]
        return numbers[~np.isin(of, along)]

    def _frame(self, system: int, asking: Card) -> _Frame:
        """A system by its number, whatever it is defined in."""
        if system in self._found:
            return self._found[system]
        if system not in self._cards:
            raise asking.refuse(f"the coordinate system {system}, which the file does not have", "one of its own")
        if system in self._asked:
            raise asking.refuse(f"the coordinate system {system}, which is defined by itself", "one that is not")
        self._asked.append(system)
        card, first = self._cards[system]
        if card.name[4] == "1":
            three = np.stack([self._node(card, card.whole(first + 1 + at)) for at in range(3)])
        else:
            given = np.array([card.real(2 + at, 0.0) for at in range(9)]).reshape(3, 3)
            three = self._frame(card.whole(1, default=BASIC), card).basic(given)
        z, to = three[1] - three[0], three[2] - three[0]
        y = np.cross(z, to)
        if not np.linalg.norm(y) > _NEAR * np.linalg.norm(z) * np.linalg.norm(to):
            raise card.refuse("three points on a line", "three that span its plane x z")
        z, y = z / np.linalg.norm(z), y / np.linalg.norm(y)
        self._found[system] = _Frame(three[0], np.stack([np.cross(y, z), y, z]), card.name[5])
        self._asked.pop()
        return self._found[system]

    def _node(self, card: Card, node: int) -> Floats:
        if node not in self._rows:
            raise card.refuse(f"node {node}, which the file does not have", "nodes of its own")
        row = self._rows[node]
        system = int(self._of[row])
        frame = self._found[BASIC] if system == BASIC else self._frame(system, self._where[node])
        return np.asarray(frame.basic(self._points[row][None])[0])
