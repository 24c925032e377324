"""Entries of the library for JSON."""

from __future__ import annotations

from typing import Any

from femstruct.model.library.library_entry import Entry


def library_table(entry: Entry) -> dict[str, Any]:
    """An entry with all of its values in SI units, and where each is printed.

    >>> from femstruct.model.library.all_entries import library
    >>> table = library_table(library()["screed sand-cement"])
    >>> table["family"], table["values"]["rho"]["value"], table["values"]["rho"]["unit"]
    ('screeds', 2000.0, 'kg/m^3')
    """
    return {
        "name": entry.name,
        "family": entry.family,
        "what": entry.what,
        "use": entry.use.value,
        "layers": [{"thickness_m": thickness, "angle_deg": angle} for thickness, angle in entry.layers] or None,
        "values": {
            one.key: {
                "value": one.value,
                "unit": one.unit or "1",
                "between": one.between,
                "note": one.note or None,
                "source": one.source.work,
                "read_at": one.source.read or None,
            }
            for one in entry.facts
        },
    }
