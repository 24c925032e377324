"""Gypsum boards and plaster."""

from __future__ import annotations

from typing import Final

from femstruct.model.library.library_entry import Entry, Use
from femstruct.model.library.sources import of_hopkins, of_vigran

ENTRIES: Final = (
    Entry(
        "gypsum board natural",
        "gypsum",
        Use.MATERIAL,
        "plasterboard of natural gypsum",
        of_hopkins(1490.0, 0.3, 860.0, 0.0141, estimated=False),
    ),
    Entry(
        "gypsum board flue gas",
        "gypsum",
        Use.MATERIAL,
        "plasterboard of flue gas gypsum and natural gypsum",
        of_hopkins(1810.0, 0.3, 680.0, 0.0125, estimated=False),
    ),
    Entry(
        "gypsum board glass fibre",
        "gypsum",
        Use.MATERIAL,
        "plasterboard with glass fibre and other additives, as fire boards have",
        of_hopkins(2010.0, 0.3, 800.0, None),
    ),
    Entry(
        "gypsum board stiff",
        "gypsum",
        Use.MATERIAL,
        "plasterboard by the largest modulus that a textbook prints",
        of_vigran(4.1e9, 0.3, (800.0, 900.0), (0.01, 0.015)),
    ),
    Entry(
        "gypsum plaster",
        "gypsum",
        Use.MATERIAL,
        "plaster, gypsum based",
        of_hopkins(1610.0, 0.2, 650.0, 0.012),
    ),
)
