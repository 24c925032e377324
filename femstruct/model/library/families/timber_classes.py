"""Structural timber by strength class; `femstruct.model.materials.timber` makes the materials."""

from __future__ import annotations

from typing import Final

from femstruct.model.library.library_entry import Entry, Fact, Source, Use
from femstruct.model.library.sources import VIGRAN
from femstruct.model.materials.timber import CLASSES, NU, ROLLING, timber

_TABLE: Final = Source("EN 338, means", "read at kvh.eu, strength, rigidity and density characteristics")
_ROLLING: Final = Source(
    "the usual assumption for rolling shear", "measured: 65 to 101 MPa, doi:10.1186/s10086-021-01954-y"
)
_RATIO: Final = Source("an assumption: the standard has none, and plates hardly depend on it")


def _of_class(name: str) -> Entry:
    wood = timber(name, name)
    along, across, _ = wood.E
    return Entry(
        name,
        "timber",
        Use.MATERIAL,
        f"softwood of strength class {name}, x along the grain",
        (
            Fact("E", (along, across), _TABLE, note="along and across the grain"),
            Fact("G", (wood.G[0], ROLLING * wood.G[0]), _ROLLING, note="Gxy of EN 338; Gyz a tenth of it"),
            Fact("nu", NU, _RATIO),
            Fact("rho", wood.rho, _TABLE, note="mean"),
            Fact("loss_factor", None, VIGRAN, (0.008, 0.01), "fir, spruce, internal; 0 where a model says nothing"),
        ),
    )


ENTRIES: Final = tuple(_of_class(name) for name in CLASSES)
