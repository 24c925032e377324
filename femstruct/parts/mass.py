"""Masses without elasticity: at points, over regions of plates, along frames."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.sparse import csr_array, vstack

from femstruct.declared import checked
from femstruct.errors import InputError, list_some
from femstruct.model.imported_mesh import Makes
from femstruct.model.layout import Layout
from femstruct.model.materials import Given, given_fields
from femstruct.model.model import Model, places_of, point_rows
from femstruct.model.part import Inert, Part
from femstruct.model.regions import Region, sparse_rows
from femstruct.tags import stored_as

Per = Literal["total", "length", "area"]
ORDER = 4  # Gauss points a direction: exact for products of two cubic deflections


@stored_as("mass/1")
@dataclass(frozen=True)
@checked("parts")
class Mass(Part):
    """A mass without elasticity: at the places of a point (kg each), over a region of a plate, or along a frame.

    per : what `mass` is counted by: "total" [kg], "length" [kg/m] along a rim, a line or all bars of a frame, "area"
    [kg/m^2].

    Two masses of 5 kg at the places of a point, and a covering of 8 kg/m^2 over all of a plate of 0.2 m^2:

    >>> from femstruct import Material, PlaceOn, Plate, Structure, assemble, mesh_structure
    >>> light = Material("light", E=3e9, nu=0.3, rho=100.0)
    >>> plate = Plate("plate", light, thickness=0.01, origin=(0.0, 0.0, 0.0), size=(0.5, 0.4), mesh=0.1)
    >>> places = PlaceOn("places", "plate", at=((0.1, 0.1), (0.4, 0.3)))
    >>> parts = (plate, Mass("lumps", 5.0, at="places"), Mass("covering", 8.0, on="plate", per="area"))
    >>> round(assemble(mesh_structure(Structure("loaded", parts, points=(places,)))).total_mass, 9)  # 0.2 + 10 + 1.6
    11.8
    """

    name: str
    mass: float
    at: str | None = None
    on: str | None = None
    region: Region | None = None
    per: Per = "total"

    def stands_for(self) -> frozenset[Makes]:
        return frozenset((Makes.MASSES,))

    def described(self) -> tuple[Given, ...]:
        return given_fields(self, {"mass": {"total": "kg", "length": "kg/m", "area": "kg/m^2"}[self.per]})

    def carriers(self) -> tuple[str | None, ...]:
        return (self.at,)

    def identity(self, places: Mapping[str, object]) -> tuple[object, ...]:
        where = places.get(self.at, self.at) if self.at is not None else (self.on, self.region)
        return "mass", self.mass, self.per, where

    def needs(self, layout: Layout) -> None:
        if self.on is not None and self.on not in layout.segments:
            layout.on_region(f"parts.{self.name}.region", self.on, self.region or Region("whole"))
        elif self.on is not None:
            each = self.mass if self.per == "length" else self.mass / layout.length(self.on)
            layout.covering[self.on] = layout.covering.get(self.on, 0.0) + each

    def fastened(self, model: Model, tolerance: float) -> tuple[Inert]:
        if not self.mass > 0:
            raise InputError(f"parts.{self.name}.mass", got=f"{self.mass:g}", expected="a positive mass")
        return (self._lumped(model) if self.at is not None else self._spread(model, tolerance),)

    def _lumped(self, model: Model) -> Inert:
        """A particle at every place of a point; the mass is that of each."""
        if self.per != "total":
            got = f"a mass per {self.per} at a point"
            raise InputError(f"parts.{self.name}.mass", got=got, expected="a mass in kg")
        points = places_of(f"parts.{self.name}.at", self.at or "", model)
        rows = csr_array(vstack([point_rows(point, np.zeros(3), model)[:3] for point in points]))
        return Inert(self.name, rows, np.full(rows.shape[0], self.mass), len(points))

    def _spread(self, model: Model, tolerance: float) -> Inert:
        """Mass over an area or along lines of a plate, or along a frame; it follows the mid-surface or the axis."""
        where = f"parts.{self.name}"
        region = self.region or Region("whole")
        part = model.parts.get(self.on or "")
        over = None if part is None else part.spread(f"{where}.region", region, tolerance, ORDER)
        if over is None:
            known = list_some([name for name, one in model.parts.items() if not one.rigid])
            raise InputError(f"{where}.on", got=f"'{self.on}'", expected=f"a plate or a frame: {known}")
        if self.per not in ("total", over.per):
            got = f"a mass per {self.per} over a {over.over}"
            raise InputError(f"{where}.mass", got=got, expected=f"kg or per {over.per}")
        mass = self.mass * over.weights / (over.weights.sum() if self.per == "total" else 1.0)
        rows = sparse_rows(over.nodes, over.rows[:, :3], model.mesh.n_nodes)
        return Inert(self.name, rows, np.repeat(mass, 3), len(mass))
