"""Numbers that no sample has, and why."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from typing import Final

import numpy as np

from femstruct.errors import some_of
from femstruct.study.asked import SETTLED
from femstruct.study.campaign.swept import UNROUNDED, Swept

RATING: Final = " rating"  # ends the name of a room's number
BLANK: Final = "rating-beyond-modes"  # the finding of rated bands that are blank
SILENT: Final = "room-silent"
LEVEL: Final = " L_AFmax"  # ends the name of a receiver's number
NAMED: Final = 6  # numbers


def not_known(rows: Swept, names: Sequence[str]) -> list[str]:
    """Numbers that no sample has in any case, of those that are to be trusted; none where no sample is."""
    sound = np.array([rows.trusted(case) for case in rows.cases])
    if not sound.any():
        return []
    return [name for name in names if not (np.isfinite(rows.numbers[:, :, rows.names.index(name)]) & sound).any()]


def not_known_pieces(rows: Swept, names: Sequence[str], many: str) -> Iterator[str]:
    """A sentence for each reason. many : what rows are."""
    codes = {code for case in rows.findings for own in case for code in own}
    by_reason: dict[str, list[str]] = {}
    for name in not_known(rows, names):
        by_reason.setdefault(why_not_known(name, codes), []).append(name)
    for why, found in by_reason.items():
        yield f"Not known in any of the {many}: {some_of(found, NAMED)}" + (f" ({why})" if why else "")


def why_not_known(name: str, codes: Collection[str]) -> str:
    """Why a number cannot be had, as far as its name and the findings of its rows say; "" where they do not.

    >>> why_not_known("bedroom rating", ["rating-beyond-modes"])
    'it needs bands that are blank; femstruct explain rating-beyond-modes'
    >>> why_not_known("settled", [])
    'not at rest when the window, or the time between blows, ends'
    """
    if name == SETTLED:
        return "not at rest when the window, or the time between blows, ends"
    if name.removesuffix(UNROUNDED).endswith(RATING):
        known = [code for code in (BLANK, SILENT) if code in codes]
        return "it needs bands that are blank" + "".join(f"; femstruct explain {code}" for code in known)
    if name.endswith(LEVEL) and SILENT in codes:
        return f"nothing moves the room; femstruct explain {SILENT}"
    return ""
