"""Boards of wood: chipboard, OSB, plywood, fibreboard."""

from __future__ import annotations

from typing import Final

from femstruct.model.library.library_entry import Entry, Fact, Source, Use
from femstruct.model.library.sources import HOPKINS, of_hopkins, of_vigran

_OSB: Final = Source(
    "EN 12369-1:2001, OSB/2 and OSB/3 of 6 to 25 mm", "read in the technical brochure of Sonae Arauco for the UK, p. 63"
)

ENTRIES: Final = (
    Entry("chipboard", "wood boards", Use.MATERIAL, "chipboard", of_hopkins(2200.0, 0.3, 760.0, 0.01)),
    Entry(
        "chipboard stiff",
        "wood boards",
        Use.MATERIAL,
        "chipboard by the modulus of another textbook",
        of_vigran(3.8e9, 0.2, (650.0, 800.0), (0.01, 0.03)),
    ),
    Entry(
        "OSB",
        "wood boards",
        Use.MATERIAL,
        "oriented strand board, taken as alike in all directions",
        of_hopkins(2570.0, 0.3, 590.0, 0.01, speeds=(2200.0, 3500.0)),
    ),
    Entry(
        "OSB/3",
        "wood boards",
        Use.MATERIAL,
        "oriented strand board of a standard, x along its major axis",
        (
            Fact("E", (4930e6, 1980e6), _OSB, note="mean, bending, along and across the major axis"),
            Fact("G", (1080e6, 50e6, 50e6), _OSB, note="mean, panel shear, and planar shear twice"),
            Fact("nu", 0.3, HOPKINS, note="an estimate of the author"),
            Fact("rho", 590.0, HOPKINS),
            Fact("loss_factor", 0.01, HOPKINS, note="internal, an estimate of the author"),
        ),
    ),
    Entry(
        "plywood birch",
        "wood boards",
        Use.MATERIAL,
        "plywood of birch, taken as alike in all directions",
        of_hopkins(3850.0, 0.3, 710.0, 0.016, estimated=False),
    ),
    Entry("MDF", "wood boards", Use.MATERIAL, "medium density fibreboard", of_hopkins(2560.0, 0.3, 760.0, 0.01)),
)
