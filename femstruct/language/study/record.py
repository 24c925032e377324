"""Records as they are written: which histories are kept, by what they are of."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Annotated, get_args

from femstruct.language.parts.part import STRESSED
from femstruct.language.yaml import Here, nearest, words_of
from femstruct.study.asked import RecordedQuantity

QUANTITIES: tuple[str, ...] = get_args(RecordedQuantity)
Recorded = Annotated[tuple[RecordedQuantity, ...], words_of(QUANTITIES)]


def check_records(
    here: Here, records: Mapping[str, Collection[str]], bodies: Collection[str], forced: Collection[str]
) -> None:
    """Note what cannot be recorded. bodies : their names. forced : names of all that has a force."""
    for target, what in ((target, what) for target, wanted in records.items() for what in wanted):
        there, got = here.at("record", target), f"'{target}'"
        if what == "stress":
            stressed = here.names.known.get(STRESSED, ())
            expected = f"the name of a {STRESSED}"
            there.need(target in stressed, f"'stress' of {got}", expected, nearest(target, stressed), of_key=True)
        elif target in bodies:
            there.need(
                what in ("displacement", "velocity", "acceleration", "travel"),
                f"'{what}' of a body",
                "displacement, velocity, acceleration or travel",
            )
        elif target in forced:
            there.need(what == "force", f"'{what}' of {got}", "force")
        elif what == "travel":
            there.wrong(got, "the name of a body", nearest(target, bodies), of_key=True)
        elif what == "force":
            there.wrong(
                got, "the name of a contact, link, part, joint, support or ground", nearest(target, forced), of_key=True
            )
        elif "." in target:
            there.spot(target, of_key=True)
        else:
            there.wrong(
                got,
                "a direction of a point, or a body",
                nearest(target, [*bodies, *(f"{place}.z" for place in here.names.places)]),
                of_key=True,
            )
