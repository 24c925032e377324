"""Links as they are written: a spring and dashpot between two ends."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from math import pi, sqrt
from typing import Annotated, Any

from femstruct.language.model.directions import Dashpot, Stiffness
from femstruct.language.study.body import BodySpec
from femstruct.language.study.contact import BetweenSpec
from femstruct.language.yaml import Frequency, Here, Instant, Quantity, Ratio, Spec, read_by
from femstruct.study.acting import PlannedLink


class OneWaySpec(Spec):
    """A dashpot with one constant while its ends approach and another while they move apart."""

    closing: Dashpot = 0.0
    opening: Dashpot = 0.0


def _dashpot(value: object) -> object:
    constant = value if isinstance(value, dict) else Quantity(("damping",), least=0.0).read(value)
    return constant if isinstance(value, dict) else {"closing": constant, "opening": constant}


class LinkSpec(BetweenSpec):
    """A spring and dashpot that both pull and push.

    frequency, ratio: in place of stiffness and damping, the natural frequency and damping ratio of its body when the
    other end is held, as tuned dampers are given: k = m (2 pi f)^2, c = 2 ratio sqrt(k m).
    A link has no force at t = 0, or at release_at: what it carries at rest, such as weight, is in balance and left out.
    preload: a force that is not in balance then and pushes the ends apart, as that of a spring that is released. Of a
    spring that holds a contact closed the force is the preload of the contact alone: both act.
    """

    at_most_one_of = (("stiffness", "frequency"), ("damping", "ratio"))

    makes = PlannedLink
    only_written = ("frequency", "ratio", "damping")
    stiffness: Stiffness = 0.0
    frequency: Frequency | None = None
    ratio: Ratio | None = None
    damping: Annotated[OneWaySpec, read_by(_dashpot, Dashpot | OneWaySpec)] = OneWaySpec()
    release_at: Instant = 0.0
    preload: Annotated[float, Quantity(("force",))] = 0.0

    def given(self) -> dict[str, Any]:
        return {**super().given(), **self.damping.noun()}

    def build(self, name: str, bodies: Mapping[str, BodySpec]) -> PlannedLink:
        """The link it describes, tuned to its body."""
        link: PlannedLink = self.noun(name=name)
        if self.frequency is None and self.ratio is None:
            return link
        mass = next(bodies[end].mass for end in self.between if end in bodies)
        stiffness = mass * (2.0 * pi * self.frequency) ** 2 if self.frequency is not None else self.stiffness
        if self.ratio is None:
            return replace(link, stiffness=stiffness)
        damping = 2.0 * self.ratio * sqrt(stiffness * mass)
        return replace(link, stiffness=stiffness, closing=damping, opening=damping)

    def check_in(self, here: Here, struck: Collection[str]) -> None:
        """Note a link of nothing, and one to a body that is lifted off at every blow (struck)."""
        here.need(
            self.stiffness or self.frequency or self.damping.closing or self.damping.opening or self.preload,
            "no stiffness and no damping" if self.ratio is None else "a damping ratio without stiffness or frequency",
            "one of them" if self.ratio is None else "'frequency' or 'stiffness' beside 'ratio'",
            of_key=True,
        )
        for number, end in enumerate(self.between):
            here.at("between", number).need(
                end not in struck,
                f"'{end}', which is lifted off at every blow",
                "a body without blows",
                "remove one of them",
            )

    def check_tuned(self, here: Here, bodies: Collection[str]) -> None:
        """Note a frequency or ratio of a link that does not hold one body alone."""
        held = [end for end in self.between if end in bodies]
        for word in ("frequency", "ratio"):
            here.at(word).need(
                getattr(self, word) is None or len(held) == 1,
                f"a {word} of a link between {'two bodies' if held else 'two places'}",
                "one body, at one end: they are those of this body while the other end is held",
                "give 'stiffness' and 'damping'",
                of_key=True,
            )
