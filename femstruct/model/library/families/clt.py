"""Lay-ups of cross-laminated timber."""

from __future__ import annotations

from typing import Final

from femstruct.model.library.library_entry import Entry, Fact, Source, Use

_PAGE: Final = Source("standard designs of CLT panels, husfabrik.eu/clt-panels-standard-design")
_LAID: Final = {  # thicknesses of the layers [mm], the first along the panel; two equal ones are glued parallel
    "CLT60 L3": (20, 20, 20),
    "CLT80 L3": (30, 20, 30),
    "CLT90 L3": (30, 30, 30),
    "CLT100 L3": (30, 40, 30),
    "CLT120 L3": (40, 40, 40),
    "CLT100 L5": (20, 20, 20, 20, 20),
    "CLT120 L5": (30, 20, 20, 20, 30),
    "CLT140 L5": (40, 20, 20, 20, 40),
    "CLT160 L5": (40, 20, 40, 20, 40),
    "CLT180 L5": (40, 30, 40, 30, 40),
    "CLT200 L5": (40, 40, 40, 40, 40),
    "CLT180 L7": (30, 20, 30, 20, 30, 20, 30),
    "CLT200 L7": (20, 40, 20, 40, 20, 40, 20),
    "CLT240 L7": (30, 40, 30, 40, 30, 40, 30),
}


def _panel(name: str, layers: tuple[int, ...]) -> Entry:
    laid = tuple((one / 1e3, 90 * (number % 2)) for number, one in enumerate(layers))
    what = f"{len(layers)} layers of {'-'.join(map(str, layers))} mm, the outer ones along x"
    return Entry(name, "CLT lay-ups", Use.LAY_UP, what, (Fact("thickness", sum(layers) / 1e3, _PAGE),), laid)


ENTRIES: Final = tuple(_panel(name, layers) for name, layers in _LAID.items())
