"""Elastic layers with nothing above or below a part of them."""

from __future__ import annotations

import numpy as np

from femstruct.errors import Finding
from femstruct.model.layers import Solid, body_box, layer_of
from femstruct.model.model import Model
from femstruct.model.parts import Block, Foundation, Plate

WHOLE = 0.999  # of a side that a layer fills: less is more than rounding
_ALMOST = 1e-9  # of a gap: parts that touch, to rounding


def overhang_findings(model: Model) -> tuple[Finding, ...]:
    """Layers that fill all that two parts share, where that is not all of either of them."""
    parts = model.structure.parts
    solids: dict[str, Solid] = {part.name: part for part in parts if isinstance(part, Plate | Block)}
    layers = [part for part in parts if isinstance(part, Foundation) and part.region.kind == "whole"]
    return tuple(found for layer in layers if layer.to is not None for found in _overhang(layer, solids))


def _overhang(part: Foundation, solids: dict[str, Solid]) -> tuple[Finding, ...]:
    first, second = solids[part.on], solids[str(part.to)]
    layer = layer_of(part, solids, _ALMOST * max(*first.size, *second.size))
    x0, x1, y0, y1 = layer.box
    filled = (x1 - x0) * (y1 - y0)
    sides = {}
    for solid in (first, second):
        _, axes, size = body_box(solid)
        along = np.abs(layer.axes[:2] @ axes.T) @ size
        sides[solid.name] = float(along[0] * along[1])
    name = min(sides, key=lambda one: sides[one])
    share = filled / sides[name]
    if share >= WHOLE:
        return ()
    return (
        Finding(
            "layer-overhang",
            f"{part.name} fills {filled:.4g} m^2, all that {first.name} and {second.name} share, of the "
            f"{sides[name]:.4g} m^2 of {name}: {100 * (1 - share):.0f} % of it lies on nothing",
            {"filled_m2": filled, "side_m2": sides[name]},
        ),
    )
