"""Supports as they are written."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Final, Literal, get_args

from pydantic import BeforeValidator, Field

from femstruct.conventions import DIRECTIONS
from femstruct.errors import InputError, shown_as
from femstruct.language.model.material import Losses
from femstruct.language.parts.part import MESHED, MaterialName
from femstruct.language.yaml import (
    Here,
    PointName,
    Position2,
    Position3,
    Quantity,
    Refers,
    Spec,
    Text,
    only,
    read_by,
    refuse,
)
from femstruct.model.material import Material
from femstruct.model.materials.edge_wall import EdgeWall
from femstruct.model.materials.orthotropic import AnyMaterial
from femstruct.model.region import Region
from femstruct.model.structure import ABOUT, ACROSS, HARD, SOFT, Edge, Fix, Support, pins

THICKEST: Final = 3.0  # m: no wall of a building is thicker
MOST_WALLS: Final = 4  # two plates go on from an edge in each of two directions


def _fix(value: object) -> object:
    if isinstance(value, str) and value in get_args(Fix):
        return value
    if isinstance(value, list) and value:
        return tuple(only(DIRECTIONS)(one) for one in value)
    expected = "simple, roller, clamped, simple hard, simple soft or a list of x, y, z, rx, ry, rz"
    raise refuse(shown_as(value), expected, "write it like [z, rx]")


def _walls(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= MOST_WALLS:
        raise refuse(
            shown_as(value), f"1 to {MOST_WALLS}: how many walls stand at the edge", "write 2: above and below"
        )
    return value


class EdgeStiffnessSpec(Spec):
    """Springs along an edge, per length of it: z along the normal of the part, about edge against rotation about it."""

    short = "z"
    z: Annotated[float, Quantity(("stiffness/length",), above=0.0)] | None = None
    about_edge: Annotated[float, Quantity(("rotational stiffness/length",), above=0.0)] | None = Field(
        default=None, alias=ABOUT
    )

    def given(self) -> dict[str, Any]:
        both = {ACROSS: self.z, ABOUT: self.about_edge}
        return {key: value for key, value in both.items() if value is not None}


class EdgeWallSpec(Spec):
    """What walls at an edge are made of: an isotropic material and its thickness."""

    material: MaterialName
    thickness: Annotated[
        float,
        Quantity(("length",), above=0.0, most=THICKEST, too_large="a plain number is in metres: {number:g} mm?"),
    ]


class SupportSpec(Spec):
    """Held directions of an edge or line of a plate (a line: a wall under it), of a set or a box of a part that is a
    mesh, of a point, or of a whole part. Along the rim or a side of a slab or shell simple is soft, free to turn every
    way; simple hard holds its rotation about the normal to the edge, as thin plates have it. Springs along an edge with
    their loss factor; or walls: how many stand at a pinned edge and take bending waves away, wall: of what."""

    one_of = (("on", "at"),)
    at_most_one_of = (("edge", "line", "set", "box"), ("stiffness", "walls"))
    needs = (("loss_factor", ("stiffness",)), ("walls", ("wall",)), ("wall", ("walls",)))

    makes = Support
    only_written = ("wall", "set", "box")
    fix: (
        Annotated[Fix | tuple[str, ...], read_by(_fix, Fix | list[Literal["x", "y", "z", "rx", "ry", "rz"]])] | None
    ) = None
    stiffness: EdgeStiffnessSpec | None = None
    loss_factor: Losses | None = None
    walls: Annotated[int, BeforeValidator(_walls)] | None = None
    wall: EdgeWallSpec | None = None
    on: Annotated[Text, Refers()] | None = None
    edge: Edge | None = None
    line: tuple[Position2, Position2] | None = None
    at: PointName | None = None
    set: Text | None = None
    box: tuple[Position3, Position3] | None = None

    @classmethod
    def refuse_keys(cls, given: Mapping[str, Any]) -> None:
        springs = given.get("stiffness") is not None or given.get("walls") is not None
        if given.get("fix") is None and not springs:
            raise refuse(
                "a support without 'fix'",
                "'fix', or springs along an edge",
                "add 'fix: simple', or 'stiffness: {z: ..}'",
            )
        if springs and all(given.get(key) is None for key in ("edge", "line", "set", "box")):
            key = "a stiffness" if given.get("stiffness") is not None else "walls"
            raise refuse(f"{key} of no edge", "an edge of a plate, or a set or box of a mesh", "add 'edge: all'")

    def check(self, here: Here) -> None:
        self._check_springs(here)
        along = self.edge is not None or self.line is not None
        among = self.set is not None or self.box is not None
        if self.on is None:
            here.at("fix").need(self.fix != HARD, f"'{HARD}' of a point", "an edge of a slab or shell", "write simple")
            got = "a set or a box of a point" if among else "an edge or line of a point"
            here.need(not along and not among, got, "only a point, or 'on: PART' with an edge")
            return
        if along and self.on in here.names.known[MESHED]:
            do = "of a slab write 'set: rim' or 'set: side 1', of another mesh a set or a box of it"
            here.at("on").wrong(f"'{self.on}'", "the name of a plate", do)
            return
        hard = here.at("fix")
        hard.need(not (along and self.fix == SOFT), f"'{SOFT}' of a thin plate", "simple", "soft edges take a slab")
        hard.need(among or along or self.fix != HARD, f"'{HARD}' of a whole part", "a set or box of a slab or shell")
        here.at("on").known(self.on, "plate" if along else MESHED if among else "part")
        if self.fix is None:
            return
        here.at("fix").need(
            along or self.fix != "roller", "a roller that is no edge or line", "directions", "write [z]"
        )
        here.at("fix").need(
            along or among or isinstance(self.fix, tuple),
            f"'{self.fix}' for a whole part",
            "an edge, a line or directions",
            "add edge: all, or list the directions as in [x, y]",
        )

    def _check_springs(self, here: Here) -> None:
        """Springs are in directions that nothing holds, and walls at a pinned edge."""
        if self.stiffness is None and self.walls is None:
            return
        there = here.at("fix")
        there.need(
            self.fix is None or pins(self.fix),
            f"{shown_as(self.fix)} beside {'walls' if self.walls else 'springs'}",
            "simple, roller, directions of x, y, z, or nothing",
            "what is clamped cannot turn; hold other directions by a support of their own",
        )
        if self.stiffness is not None:
            keys = self.stiffness.given()
            here.at("stiffness").need(keys, "no stiffness", "z, about edge or both", "write {z: 5 MN/m^2}")
            here.at("stiffness", "z").need(
                not isinstance(self.fix, str) or ACROSS not in keys,  # of directions the part's normal decides
                f"a stiffness beside fix: {self.fix}, which holds z",
                "one of them",
                "remove 'fix': the springs carry the edge",
                of_key=True,
            )

    def of(self, name: str, materials: Mapping[str, AnyMaterial]) -> Support:
        """The noun, of walls of the materials. Raises InputError for walls of an orthotropic one."""
        walls: tuple[EdgeWall, ...] = ()
        if self.wall is not None and self.walls:
            material = materials[self.wall.material]
            if not isinstance(material, Material):
                where = f"supports.{name}.wall.material"
                raise InputError(
                    where, got=f"a wall of '{material.name}', orthotropic", expected="an isotropic material"
                )
            walls = (EdgeWall(material, self.wall.thickness),) * self.walls
        made = self.noun(name=name, walls=walls)
        assert isinstance(made, Support)
        return made

    def given(self) -> dict[str, Any]:
        values = super().given()
        values["fix"] = self.fix or ("simple" if self.walls else ())
        values["stiffness"], values["loss_factor"] = values["stiffness"] or {}, self.loss_factor or 0.0
        if self.set is not None or self.box is not None:
            values["region"] = Region("box" if self.set is None else "set", named=self.set, box=self.box)
        return values
