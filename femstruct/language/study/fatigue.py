"""fatigue: cycles of recorded histories, and the damage they do."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Annotated, Any, Final

from femstruct.dimensions import DIMENSIONS
from femstruct.impact.result.fatigue import SNLine
from femstruct.language.study.limit import dimension_of
from femstruct.language.study.window import TimeSpec
from femstruct.language.yaml import (
    Factor,
    Here,
    Measured,
    Quantity,
    Refers,
    Spec,
    Text,
    nearest,
    refuse,
)
from femstruct.study.counting import FatigueRequest

OF_CATEGORIES: Final = 3.0  # slope m of EN 1993-1-9 up to five million cycles


_RANGE: Final = Quantity(("pressure", "force", "length", "speed", "acceleration"), above=0.0, which=True)
_CATEGORY: Final = Quantity(("pressure",), above=0.0, least=1e6, too_small="a plain number is in Pa")


class SNSpec(Spec):
    """An S-N line: a range that is endured 'at' so many cycles, and its slope m, positive; or a detail category of EN
    1993-1-9 for direct stress, such as 71 MPa, with its slopes of 3 and 5 and its cut-off. Without partial factors."""

    makes = SNLine
    one_of = (("range", "category"),)
    range: Annotated[Measured, _RANGE] | None = None
    category: Annotated[float, _CATEGORY] | None = None
    at: Factor = 2e6
    slope: Factor | None = None

    @classmethod
    def refuse_keys(cls, given: Mapping[str, Any]) -> None:
        if "category" in given and given.keys() & {"at", "slope"}:
            raise refuse(
                "a slope or cycles beside a category", "a category alone", "write 'range' for a line of your own"
            )
        if "range" in given and "category" not in given and given.get("slope") is None:
            do = "add 'slope: 3', as of welds, or 'slope: 5' and more, as of machined parts"
            raise refuse("a range without its slope", "'slope' beside 'range'", do)

    def given(self) -> dict[str, Any]:
        value = self.category if self.range is None else self.range.value
        category = self.category is not None
        return {"range": value, "at": self.at, "slope": self.slope or OF_CATEGORIES, "category": category}


class FatigueSpec(Spec):
    """Rainflow cycles of a recorded channel, of: TARGET QUANTITY, and the damage they do. Of a stress it is the normal
    stress on the worst plane at the place with the most damage. Of the history in time or, under: NAME, on the average
    in the duration of a random excitation of 'vibration', at the place with the most damage, too."""

    makes = FatigueRequest
    of: Annotated[Text, Refers()]
    sn: SNSpec | None = None
    under: Annotated[Text, Refers()] | None = None

    def given(self) -> dict[str, Any]:
        return {**super().given(), "under": self.under or ""}

    def check_in(
        self,
        here: Here,
        records: Mapping[str, Collection[str]],
        time: TimeSpec | None,
        random: Collection[str],
    ) -> None:
        """Note what is wrong with its channel and its S-N line. random : excitations that have a psd and a duration."""
        known = [f"{target} {what}" for target, wanted in records.items() for what in wanted]
        expected = "a recorded channel, such as 'brace force' of 'record: {brace: force}'"
        do = "add 'time: {duration: 1 s, sampling: 48 kHz}'"
        if self.under is None:
            here.need(time is not None, "no time", "a history to count", f"{do} or 'under: EXCITATION'")
        else:
            expected_of = "an excitation of 'vibration' with 'psd' and 'duration'"
            here.at("under").need(self.under in random, f"'{self.under}'", expected_of, nearest(self.under, random))
        if not here.at("of").need(self.of in known, f"'{self.of}'", expected, nearest(self.of, known)):
            return
        if self.sn is None:
            return
        got = "pressure" if self.sn.range is None else self.sn.range.dimension
        wanted = dimension_of(self.of)
        words = DIMENSIONS[wanted].words if wanted in DIMENSIONS else "a plain number"
        there = here.at("sn")
        there.need(got in (None, wanted), DIMENSIONS[got or "ratio"].words, f"{words}, as '{self.of}' is")
