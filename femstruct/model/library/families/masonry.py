"""Masonry of solid blocks, for walls."""

from __future__ import annotations

from typing import Final

from femstruct.model.library.library_entry import Entry, Use
from femstruct.model.library.sources import of_hopkins


def _wall(name: str, what: str, speed: float, rho: float, loss_factor: float, estimated: bool = True) -> Entry:
    return Entry(name, "masonry", Use.MATERIAL, what, of_hopkins(speed, 0.2, rho, loss_factor, estimated))


ENTRIES: Final = (
    _wall("masonry calcium silicate", "calcium-silicate blocks in thin joints", 2500.0, 1800.0, 0.01, False),
    _wall("masonry dense aggregate", "dense aggregate blocks in mortar", 3200.0, 2000.0, 0.01),
    _wall("masonry light aggregate", "lightweight aggregate blocks in mortar", 2200.0, 1400.0, 0.01),
    _wall("masonry expanded clay", "expanded clay blocks in mortar", 2300.0, 800.0, 0.007),
    _wall("masonry clinker 1030", "clinker concrete blocks of 1030 kg/m^3 (Rindel 1994)", 1850.0, 1030.0, 0.01),
    _wall("masonry clinker 1720", "clinker concrete blocks of 1720 kg/m^3 (Rindel 1994)", 2200.0, 1720.0, 0.01),
)
