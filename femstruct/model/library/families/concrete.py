"""Concrete by strength class."""

from __future__ import annotations

from typing import Final

from femstruct.model.library.library_entry import Entry, Fact, Source, Use
from femstruct.model.library.sources import HOPKINS, VIGRAN, of_hopkins

_TABLE: Final = Source("EN 1992-1-1:2004, table 3.1", "read at buildinghow.com, volume C, concrete and steel")
_RATIO: Final = Source("EN 1992-1-1:2004, 3.1.3(4), uncracked", "read in the public data sets of BHoM, concrete")
_WEIGHT: Final = Source("T. E. Vigran, Building Acoustics, Taylor & Francis 2008, table 3.1, p. 88", VIGRAN.read)
_MODULI: Final = {  # E_cm [GPa]
    "C12/15": 27.0, "C16/20": 29.0, "C20/25": 30.0, "C25/30": 31.0, "C30/37": 33.0, "C35/45": 34.0, "C40/50": 35.0,
    "C45/55": 36.0, "C50/60": 37.0, "C55/67": 38.0, "C60/75": 39.0, "C70/85": 41.0, "C80/95": 42.0, "C90/105": 44.0,
}  # fmt: skip


def _of_class(strength_class: str, modulus: float) -> Entry:
    secant = "mean secant modulus E_cm; the dynamic modulus is larger"
    return Entry(
        f"concrete {strength_class}",
        "concrete",
        Use.MATERIAL,
        f"concrete of strength class {strength_class}",
        (
            Fact("E", 1e9 * modulus, _TABLE, note=secant),
            Fact("nu", 0.2, _RATIO),
            Fact("rho", 2300.0, _WEIGHT, note="plain concrete: reinforcement adds to it"),
            Fact("loss_factor", 0.005, HOPKINS, (0.004, 0.008), "internal, an estimate; range of Vigran, table 3.1"),
        ),
    )


ENTRIES: Final = (
    *(_of_class(name, modulus) for name, modulus in _MODULI.items()),
    Entry(
        "concrete cast in situ",
        "concrete",
        Use.MATERIAL,
        "concrete cast in situ, by its dynamic modulus",
        of_hopkins(3800.0, 0.2, 2200.0, 0.005),
    ),
)
