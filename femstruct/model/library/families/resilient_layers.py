"""Resilient layers under floating floors, by their dynamic stiffness per area."""

from __future__ import annotations

from typing import Final

from femstruct.model.library.library_entry import Entry, Fact, Use
from femstruct.model.library.sources import HOPKINS_LAYERS, VIGRAN_MODULI

_MEASURED: Final = (  # material, density [kg/m^3], thickness [mm], s' [MN/m^3]
    ("rock wool", 60, 30, 10), ("rock wool", 80, 30, 11), ("rock wool", 100, 30, 14), ("rock wool", 140, 30, 19),
    ("glass wool", 36, 13, 28), ("glass wool", 36, 25, 11), ("glass wool", 75, 25, 12), ("glass wool", 75, 40, 7),
    ("rebond foam", 64, 15, 12), ("rebond foam", 64, 20, 9), ("rebond foam", 64, 25, 7), ("rebond foam", 96, 15, 16),
    ("polystyrene", 14, 50, 78), ("polystyrene pre-compressed", 10, 50, 68), ("polyethylene foam", 45, 5, 115),
)  # fmt: skip
_MODULI: Final = (  # material, density [kg/m^3], its range, dynamic modulus [Pa]
    ("glass wool 125 kg/m^3", 125.0, None, (0.11e6, 0.13e6)),
    ("rock wool 110 to 135 kg/m^3", None, (110.0, 135.0), (0.25e6, 0.30e6)),
    ("rock wool 150 to 175 kg/m^3", None, (150.0, 175.0), (0.27e6, 0.33e6)),
    ("cork", None, (120.0, 250.0), (10e6, 30e6)),
)


def _layer(material: str, rho: int, thickness: int, stiffness: int) -> Entry:
    return Entry(
        f"layer {material} {rho} kg/m^3 {thickness} mm",
        "resilient layers",
        Use.LAYER,
        f"{material} of {thickness} mm, a measured specimen (ISO 9052-1)",
        (
            Fact("stiffness_per_area", 1e6 * stiffness, HOPKINS_LAYERS, note="s', dynamic"),
            Fact("rho", float(rho), HOPKINS_LAYERS),
            Fact("thickness", thickness / 1e3, HOPKINS_LAYERS, note="uncompressed"),
        ),
    )


def _modulus(name: str, rho: float | None, between: tuple[float, float] | None, moduli: tuple[float, float]) -> Entry:
    note = "dynamic, under about 2 kPa; s' is this over the thickness"
    return Entry(
        f"layer of {name}",
        "resilient layers",
        Use.NUMBERS,
        "the modulus of a resilient layer of any thickness",
        (Fact("E", None, VIGRAN_MODULI, moduli, note), Fact("rho", rho, VIGRAN_MODULI, between)),
    )


ENTRIES: Final = (*(_layer(*one) for one in _MEASURED), *(_modulus(*one) for one in _MODULI))
