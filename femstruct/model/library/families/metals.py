"""Metals and glass."""

from __future__ import annotations

from typing import Final

from femstruct.model.library.library_entry import Entry, Fact, Source, Use
from femstruct.model.library.sources import HOPKINS, of_hopkins

_CREMER: Final = Source(
    "L. Cremer, M. Heckl, B. A. T. Petersson, Structure-Borne Sound, 3rd ed., Springer 2005, table 4.3, p. 191",
    HOPKINS.read,
)

ENTRIES: Final = (
    Entry(
        "steel",
        "metals and glass",
        Use.MATERIAL,
        "steel",
        (
            Fact("E", 210e9, _CREMER),
            Fact("nu", 0.31, _CREMER),
            Fact("rho", 7800.0, _CREMER),
            Fact("loss_factor", None, _CREMER, (2e-5, 3e-4), "of the material in bending: structures have far more"),
        ),
    ),
    Entry(
        "aluminium",
        "metals and glass",
        Use.MATERIAL,
        "aluminium",
        (
            Fact("E", 72e9, _CREMER),
            Fact("nu", 0.34, _CREMER),
            Fact("rho", 2700.0, _CREMER),
            Fact("loss_factor", None, _CREMER, (3e-6, 1e-4), "of the material in bending: structures have far more"),
        ),
    ),
    Entry(
        "glass",
        "metals and glass",
        Use.MATERIAL,
        "glass",
        (
            *(one for one in of_hopkins(5200.0, 0.24, 2500.0, None) if one.key != "nu"),
            Fact("nu", 0.24, HOPKINS),
            Fact("loss_factor", None, HOPKINS, (0.003, 0.006), "internal"),
        ),
    ),
)
