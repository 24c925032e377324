"""Elastomers for strips and pads; their stiffness depends on load, form and frequency: the maker's sheet decides."""

from __future__ import annotations

from typing import Final

from femstruct.model.library.library_entry import Entry, Fact, Source, Use


def _sheet(name: str) -> Source:
    return Source(f"Getzner Werkstoffe, material data sheet {name}", "read in a public copy at scribd.com or yumpu.com")


def _elastomer(name: str, shear_modulus: float, loss_factor: float, pressure: float) -> Entry:
    sheet = _sheet(name)
    reference = "DIN 53513, depends on frequency, load and amplitude (reference value)"
    return Entry(
        f"elastomer {name}",
        "elastomers",
        Use.NUMBERS,
        f"cellular polyurethane {name}",
        (
            Fact("G", shear_modulus, sheet, note="dynamic, DIN ISO 1827, at the static load limit"),
            Fact("loss_factor", loss_factor, sheet, note=reference),
            Fact("pressure", pressure, sheet, note="static load limit, depends on the form"),
        ),
    )


ENTRIES: Final = (
    _elastomer("Sylodyn NF", 1.18e6, 0.10, 1.5e6),
    _elastomer("Sylodyn ND", 0.47e6, 0.08, 0.35e6),
    _elastomer("Sylomer W", 0.10e6, 0.20, 0.005e6),
)
