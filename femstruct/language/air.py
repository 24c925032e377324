"""The air of a room or a cavity, or another fluid, as it is written."""

from __future__ import annotations

from typing import Annotated, Final

from acoustics.air import Air
from femstruct.language.yaml import Here, Quantity, Spec

DENSEST_GAS, SLOWEST_LIQUID = 1000.0, 500.0  # kg/m^3: carbon dioxide at 700 bar; m/s: fluorinated liquids have 550
_IN_AIR: Final = "air has 343 m/s and 1.21 kg/m^3"
_SOUND: Final = Quantity(("speed",), above=0.0, least=50.0, most=2000.0, too_small=_IN_AIR, too_large=_IN_AIR)
"""From the heaviest gases (sulphur hexafluoride 134 m/s) to hydrogen, 1300 m/s, and water, 1480 m/s."""
_FLUID: Final = Quantity(("density",), above=0.0, least=0.01, most=2000.0, too_small=_IN_AIR, too_large=_IN_AIR)
"""From air at a hundredth of an atmosphere to the heaviest liquids but metals."""


class AirSpec(Spec):
    """Speed of sound and density."""

    makes = Air
    c: Annotated[float, _SOUND] = 343.0
    rho: Annotated[float, _FLUID] = 1.21

    def check(self, here: Here) -> None:
        """A fluid is a gas or a liquid."""
        here.at("rho").need(
            self.rho <= DENSEST_GAS or self.c >= SLOWEST_LIQUID,
            f"{self.rho:g} kg/m^3 beside a speed of sound of {self.c:g} m/s",
            f"a gas below {DENSEST_GAS:g} kg/m^3, or a liquid above {SLOWEST_LIQUID:g} m/s",
            "air has 1.21 kg/m^3 and 343 m/s",
        )
