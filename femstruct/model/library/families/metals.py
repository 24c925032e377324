"""Metals and glass."""

from __future__ import annotations

from typing import Final

from femstruct.model.library.library_entry import Entry, Fact, Source, Use
from femstruct.model.library.sources import HOPKINS, of_hopkins

_CREMER: Final = Source(
    "L. Cremer, M. Heckl, B. A. T. Petersson, Structure-Borne Sound, 3rd ed., Springer 2005, table 4.3, p. 191",
    HOPKINS.read,
)


def _metal(name: str, E: float, nu: float, rho: float, losses: tuple[float, float]) -> Entry:
    note = "of the material in bending: structures have far more"
    facts = (
        Fact("E", E, _CREMER),
        Fact("nu", nu, _CREMER),
        Fact("rho", rho, _CREMER),
        Fact("loss_factor", None, _CREMER, losses, note),
    )
    return Entry(name, "metals and glass", Use.MATERIAL, name, facts)


ENTRIES: Final = (
    _metal("steel", 210e9, 0.31, 7800.0, (2e-5, 3e-4)),
    _metal("aluminium", 72e9, 0.34, 2700.0, (3e-6, 1e-4)),
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
