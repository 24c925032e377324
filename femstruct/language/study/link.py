"""Links as they are written: a spring and dashpot between two ends."""

from __future__ import annotations

from collections.abc import Collection
from typing import Annotated, Any

from femstruct.language.model.directions import Dashpot, Stiffness
from femstruct.language.study.contact import BetweenSpec
from femstruct.language.yaml import Here, Instant, Quantity, Spec, read_by
from femstruct.study.acting import PlannedLink


class OneWaySpec(Spec):
    """A dashpot with one constant while its ends approach and another while they move apart."""

    closing: Dashpot = 0.0
    opening: Dashpot = 0.0


def _dashpot(value: object) -> object:
    constant = value if isinstance(value, dict) else Quantity(("damping",), least=0.0).read(value)
    return constant if isinstance(value, dict) else {"closing": constant, "opening": constant}


class LinkSpec(BetweenSpec):
    """A spring and dashpot that both pull and push."""

    makes = PlannedLink
    stiffness: Stiffness = 0.0
    damping: Annotated[OneWaySpec, read_by(_dashpot, Dashpot | OneWaySpec)] = OneWaySpec()
    release_at: Instant = 0.0
    preload: Annotated[float, Quantity(("force",))] = 0.0

    def given(self) -> dict[str, Any]:
        values = super().given()
        dashpot = values.pop("damping")
        return {**values, **dashpot}

    def check_in(self, here: Here, struck: Collection[str]) -> None:
        """Note a link of nothing, and one to a body that is lifted off at every blow (struck)."""
        here.need(
            self.stiffness or self.damping.closing or self.damping.opening or self.preload,
            "no stiffness and no damping",
            "one of them",
            of_key=True,
        )
        for number, end in enumerate(self.between):
            here.at("between", number).need(
                end not in struck,
                f"'{end}', which is lifted off at every blow",
                "a body without blows",
                "remove one of them",
            )
