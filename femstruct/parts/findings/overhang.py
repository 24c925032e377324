"""Elastic layers with nothing above or below a part of them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from femstruct.errors import Finding
from femstruct.model.grid.layers import layer_of
from femstruct.model.model import Model
from femstruct.model.part import Body
from femstruct.model.structure import bodies_of
from femstruct.parts.foundation import Foundation

WHOLE = 0.999  # of a side that a layer fills: less is more than rounding
_ALMOST = 1e-9  # of a gap: parts that touch, to rounding


def overhang_findings(model: Model) -> tuple[Finding, ...]:
    """Layers that fill all that two parts share, where that is not all of either of them."""
    parts, bodies = model.structure.parts, bodies_of(model.structure)
    layers = [part for part in parts if isinstance(part, Foundation) and part.region.kind == "whole"]
    return tuple(found for layer in layers if layer.to is not None for found in _overhang(layer, bodies))


def _overhang(part: Foundation, bodies: Mapping[str, Body]) -> tuple[Finding, ...]:
    first, second = part.on, str(part.to)
    size = float(max(bodies[name].size.max() for name in (first, second)))
    layer = layer_of(part, bodies, _ALMOST * size)
    x0, x1, y0, y1 = layer.box
    filled = (x1 - x0) * (y1 - y0)
    sides = {}
    for name in (first, second):
        along = np.abs(layer.axes[:2] @ bodies[name].axes.T) @ bodies[name].size
        sides[name] = float(along[0] * along[1])
    name = min(sides, key=lambda one: sides[one])
    share = filled / sides[name]
    if share >= WHOLE:
        return ()
    return (
        Finding(
            "layer-overhang",
            f"{part.name} covers {filled:.4g} m^2, the common area of {first} and {second}, of the "
            f"{sides[name]:.4g} m^2 of {name}: {100 * (1 - share):.0f} % of {name} is not supported",
            {"filled_m2": filled, "side_m2": sides[name]},
        ),
    )
