"""Screeds."""

from __future__ import annotations

from typing import Final

from femstruct.model.library.library_entry import Entry, Use
from femstruct.model.library.sources import of_hopkins

ENTRIES: Final = (
    Entry(
        "screed sand-cement",
        "screeds",
        Use.MATERIAL,
        "screed of sand and cement",
        of_hopkins(3250.0, 0.2, 2000.0, 0.01, estimated=False),
    ),
    Entry(
        "mortar",
        "screeds",
        Use.MATERIAL,
        "mortar (Maysenholder and Horvatic 1998)",
        of_hopkins(2450.0, 0.2, 1600.0, 0.013, estimated=False),
    ),
)
