"""`type: table`."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, Literal

from pydantic import Field

from femstruct.files.inputs.columns import read_columns
from femstruct.files.inputs.opening import beside
from femstruct.impact.laws.tabulated import Tabulated
from femstruct.language.laws.law import FactoredSpec, Site
from femstruct.language.yaml import Quantity, Text

Depth = Annotated[float, Quantity(("length",), least=0.0)]
Push = Annotated[float, Quantity(("force",), least=0.0)]


class TableSpec(FactoredSpec):
    """f = s(d) (1 + chi d') through measured points: [[indentation, force], ...], or a CSV file of these columns.
    Between them are straight lines; with 'smooth: true' a curve of continuous slope (monotone cubics, PCHIP)."""

    one_of = (("curve", "file"),)

    type: Literal["table"]
    curve: Annotated[list[tuple[Depth, Push]], Field(min_length=2)] | None = None
    file: Text | None = None
    smooth: bool = False

    def with_dissipation(self, chi: float, site: Site) -> Tabulated | None:
        points, file = self.curve, site.here.at("file")
        if points is not None:
            columns: Any = zip(*points, strict=True)
            curve = site.here.at("curve").make(lambda: Tabulated(*columns))
        else:
            name, ends = self.file or "", ("length", "force")
            curve = file.make(lambda: read_columns(beside(file.tree.file, name), ends, site.sources, Tabulated))
        return None if curve is None else replace(curve, dissipation=chi, tensile=self.tensile, smooth=self.smooth)
