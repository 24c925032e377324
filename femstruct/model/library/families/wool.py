"""Wool and felt for cavities."""

from __future__ import annotations

from typing import Final

from femstruct.model.library.library_entry import Entry, Fact, Source, Use
from femstruct.model.library.sources import HOPKINS

_ISOVER: Final = Source(
    "Isover Sweden, Piano Ljudskiva; calculated by the maker's engineer, declared (EN 13162) with at least 6 kPa s/m^2",
    "read in a public forum, gearslutz.com, thread 693015",
)
_ALLARD: Final = Source(
    "J. F. Allard, N. Atalla, Propagation of Sound in Porous Media, 2nd ed., Wiley 2009, table 6.1, p. 124",
    HOPKINS.read,
)
_COX: Final = Source(
    "T. J. Cox, P. D'Antonio, Acoustic Absorbers and Diffusers, 3rd ed., CRC Press 2017, table 6.2, p. 193",
    HOPKINS.read,
)

ENTRIES: Final = (
    Entry(
        "glass wool 14 kg/m^3",
        "wool",
        Use.FILL,
        "glass wool for partitions, such as Isover Piano",
        (
            Fact("rho", 14.0, _ISOVER, (13.0, 15.0), "middle of the range"),
            Fact("flow_resistivity", 7e3, _ISOVER, (6e3, 7e3)),
        ),
    ),
    Entry(
        "glass wool 130 kg/m^3",
        "wool",
        Use.FILL,
        "heavy glass wool, Domisol Coffrage",
        (Fact("rho", 130.0, _ALLARD), Fact("flow_resistivity", 40e3, _ALLARD)),
    ),
    Entry(
        "mineral wool",
        "wool",
        Use.NUMBERS,
        "mineral wool of any kind: the range that studies report",
        (Fact("flow_resistivity", None, _COX, (1e3, 150e3)),),
    ),
    Entry(
        "wood fibres",
        "wool",
        Use.NUMBERS,
        "wood fibres: the range that studies report (Wassilieff 1996)",
        (Fact("flow_resistivity", None, _COX, (11e3, 180e3)),),
    ),
    Entry(
        "hemp fibres",
        "wool",
        Use.NUMBERS,
        "hemp fibres (Bonfiglio and Pompoli 2013)",
        (Fact("flow_resistivity", 6.2e3, _COX),),
    ),
)
