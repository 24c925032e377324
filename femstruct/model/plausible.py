"""What a model says that no structure is like: materials no solid has, layers with nothing above or below them."""

from __future__ import annotations

import numpy as np

from femstruct.errors import Finding
from femstruct.model.layers import Solid, body_box, layer_of
from femstruct.model.material import Material
from femstruct.model.model import Model
from femstruct.model.parts import Block, Foundation, Frame, Plate

SLOWEST, FASTEST = 10.0, 20e3  # sqrt(E / rho) [m/s]: soft gels have some 10 m/s, rubber 30 to 50, diamond 18 km/s
WHOLE = 0.999  # of a side that a layer fills: less is more than rounding
_ALMOST = 1e-9  # of a gap: parts that touch, to rounding


def plausible_findings(model: Model) -> tuple[Finding, ...]:
    """Units that were forgotten, as far as they show: materials, and layers that fill a share of what they carry."""
    parts = model.structure.parts
    materials = {part.material.name: part.material for part in parts if isinstance(part, Plate | Frame)}
    solids: dict[str, Solid] = {part.name: part for part in parts if isinstance(part, Plate | Block)}
    layers = [part for part in parts if isinstance(part, Foundation) and part.region.kind == "whole"]
    return (
        *(_unlike_a_solid(material) for material in materials.values() if not _is_solid(material)),
        *(found for layer in layers if layer.to is not None for found in _overhang(layer, solids)),
    )


def _is_solid(material: Material) -> bool:
    return SLOWEST <= float(np.sqrt(material.E / material.rho)) <= FASTEST


def _unlike_a_solid(material: Material) -> Finding:
    speed = float(np.sqrt(material.E / material.rho))
    return Finding(
        "unlike-a-solid",
        f"{material.name}: with E {material.E:.4g} Pa and rho {material.rho:.4g} kg/m^3 sound runs along a bar of it "
        f"at {speed:.3g} m/s; gels have {SLOWEST:g} m/s, diamond has 18000 m/s. Plain numbers are Pa and kg/m^3",
        {"wave_speed_m_s": speed, "E_pa": material.E, "rho_kg_m3": material.rho},
    )


def _overhang(part: Foundation, solids: dict[str, Solid]) -> tuple[Finding, ...]:
    """A finding for a layer over all that two parts share, where that is not all of either of them."""
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
