"""Springs and dashpots between two places, or a place and the ground."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.conventions import DIRECTIONS
from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.model.imported_mesh import Makes
from femstruct.model.materials import Given
from femstruct.model.model import Model, places_of, point_rows
from femstruct.model.part import Elastic, Part
from femstruct.tags import stored_as

Six = tuple[float, float, float, float, float, float]  # x y z rx ry rz, global axes
NO_STIFFNESS: Six = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@stored_as("spring/1")
@dataclass(frozen=True)
@checked("parts")
class Spring(Part):
    """A spring and dashpot between two places, or a place and the ground; several places of a point: one each.

    Two places apart from each other are joined in the middle between them, through rigid arms.

    stiffness, damping : x y z rx ry rz along global axes [N/m, N m/rad] and [N s/m, N m s/rad].

    Four isolators under a machine, its centre of mass halfway between them and low: f = sqrt(4 k / m) / 2 pi along z.

    >>> from femstruct import Block, PlaceOn, Structure, assemble, mesh_structure, modal_basis
    >>> machine = Block("machine", 1200.0, origin=(0.0, 0.0, 0.0), size=(1.0, 0.8, 0.6))
    >>> feet = PlaceOn("feet", "machine", at=((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.8, 0.0), (1.0, 0.8, 0.0)))
    >>> isolators = Spring("isolators", "feet", None, stiffness=(4e5, 4e5, 4e5, 0.0, 0.0, 0.0))
    >>> model = mesh_structure(Structure("a machine", (machine, isolators), points=(feet,)))
    >>> frequencies = modal_basis(assemble(model), up_to=50.0).frequency_hz
    >>> bool(abs(frequencies - (4 * 4e5 / 1200.0) ** 0.5 / 6.283185307).min() < 1e-6)
    True
    """

    name: str
    a: str
    b: str | None
    stiffness: Six = NO_STIFFNESS
    damping: Six = NO_STIFFNESS

    def stands_for(self) -> frozenset[Makes]:
        return frozenset((Makes.SPRINGS,))

    def described(self) -> tuple[Given, ...]:
        return (
            Given("between", (self.a, self.b or "ground")),
            *(
                Given(f"{word} {direction}", value, units[len(direction) - 1])
                for word, values, units in (
                    ("stiffness", self.stiffness, ("N/m", "N m/rad")),
                    ("damping", self.damping, ("N s/m", "N m s/rad")),
                )
                for direction, value in zip(DIRECTIONS, values, strict=True)
                if value
            ),
        )

    def carriers(self) -> tuple[str | None, ...]:
        return self.a, self.b

    def identity(self, places: Mapping[str, object]) -> tuple[object, ...]:
        ends = frozenset(str(places.get(end, end)) for end in (self.a, self.b) if end is not None)
        return "spring", self.stiffness, self.damping, ends

    def fastened(self, model: Model, tolerance: float) -> tuple[Elastic]:
        """Springs between places, one for each pair, or one for each place to the ground.

        Two places apart from each other act in the middle between them, each through a rigid arm of its own rotation,
        so that a rigid motion of both strains nothing.
        """
        where = f"parts.{self.name}"
        values = np.array([self.stiffness, self.damping], dtype=np.float64)
        if not (np.isfinite(values) & (values >= 0)).all() or not values.any():
            raise InputError(
                where, got="stiffness and damping without one positive value", expected="values >= 0, one above"
            )
        kept = np.flatnonzero(values.any(axis=0))
        first = places_of(f"{where}.between", self.a, model)
        positions = np.stack([point.position for point in first])
        if self.b is None:
            matrices = [point_rows(point, np.zeros(3), model)[kept] for point in first]
        else:
            second = places_of(f"{where}.between", self.b, model)
            if len(first) != len(second) and min(len(first), len(second)) != 1:
                got = f"{len(first)} and {len(second)} places"
                raise InputError(f"{where}.between", got=got, expected="as many, or one of either")
            count = max(len(first), len(second))
            positions = (positions + np.stack([point.position for point in second])) / 2.0
            matrices = []
            for one, other in zip(first * (count // len(first)), second * (count // len(second)), strict=True):
                half = (other.position - one.position) / 2.0
                matrices.append((point_rows(one, half, model) - point_rows(other, -half, model))[kept])
        count = len(matrices)
        directions = np.zeros((len(DIRECTIONS), 3))
        directions[:3] = np.eye(3)
        elastic = Elastic(
            self.name,
            csr_array(vstack(matrices)),
            np.tile(values[0, kept], count),
            np.tile(values[1, kept], count),
            np.tile(directions[kept], (count, 1)),
            grounded=self.b is None,
            places=positions,
        )
        return (elastic,)
