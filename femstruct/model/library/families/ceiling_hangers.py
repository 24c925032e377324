"""Hangers of ceilings, and studs and channels as line springs."""

from __future__ import annotations

from typing import Final

from femstruct.model.library.library_entry import Entry, Fact, Source, Use

_ARH: Final = Source(
    "Acoustic Isolation Hangers ARH-1, silentsource.com", "static deflection at the largest steady load"
)
_VIGRAN: Final = Source(
    "T. E. Vigran, Building Acoustics, Taylor & Francis 2008, section 8.2, figure 8.16",
    "read at what-when-how.com, Building-Acoustics-316",
)
POUND: Final = 4.4482216  # N
INCH: Final = 0.0254  # m


def _hanger(model: str, pounds: float, inches: float) -> Entry:
    load = pounds * POUND
    return Entry(
        f"hanger {model}",
        "hangers",
        Use.HANGERS,
        f"hanger with a gum rubber element, {model}",
        (
            Fact("stiffness", load / (inches * INCH), _ARH, note="static: dynamic stiffness of rubber is larger"),
            Fact("load", load, _ARH, note="the largest that is recommended"),
        ),
    )


ENTRIES: Final = (
    _hanger("ARH-1-20", 65.0, 5.0 / 16.0),
    _hanger("ARH-1-40", 120.0, 1.0 / 4.0),
    _hanger("ARH-1-70", 200.0, 3.0 / 16.0),
    Entry(
        "stud steel",
        "hangers",
        Use.HANGERS,
        "common steel stud between two boards of 13 mm, as a line spring",
        (
            Fact(
                "stiffness_per_length",
                2e5,
                _VIGRAN,
                note="1 / (5e-6 m^2/N), the compliance for which Davy's formula agrees with a measured wall",
            ),
        ),
    ),
)
