"""`type: table`."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

from pydantic import Field

from femstruct.impact.laws.tabulated import Tabulated
from femstruct.language.laws.law import FactoredSpec, Site
from femstruct.language.yaml.opening import beside
from femstruct.language.yaml.reader import dotted
from femstruct.language.yaml.spec import Quantity, Text
from femstruct.language.yaml.tables import read_curve

Depth = Annotated[float, Quantity(("length",), least=0.0)]
Push = Annotated[float, Quantity(("force",), least=0.0)]


class TableSpec(FactoredSpec):
    """f = s(d) (1 + chi d') through measured points: [[indentation, force], ...], or a CSV file of these columns."""

    one_of = (("curve", "file"),)

    type: Literal["table"]
    curve: Annotated[list[tuple[Depth, Push]], Field(min_length=2)] | None = None
    file: Text | None = None

    def law(self, site: Site) -> Tabulated | None:
        chi = self.chi(site)
        if chi is None:
            return None
        curve = self._curve(site)
        return None if curve is None else replace(curve, dissipation=chi, tensile=self.tensile)

    def _curve(self, site: Site) -> Tabulated | None:
        if self.curve is not None:
            points = self.curve
            return site.builder.make(
                (*site.steps, "curve"),
                lambda: Tabulated([d for d, _ in points], [f for _, f in points]),  # type: ignore[arg-type]
            )
        where, tree = (*site.steps, "file"), site.builder.tree
        path = site.builder.make(where, lambda: beside(tree.file, self.file or ""))
        if path is None:
            return None
        return read_curve(path, tree.position(where), dotted(where), site.builder.mistakes, site.sources)
