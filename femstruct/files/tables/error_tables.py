"""How far the numbers of a case may be off by what the march leaves, as tables."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

from femstruct.files.results_file.datasets import axis, group
from femstruct.files.tables.described import described, write_described, write_rows
from femstruct.impact.estimate import ErrorEstimate, Resolved

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py

Table = dict[str, Any]
KINDS: Final = (
    ("first_peak_force", "first_peak", "contact", "N", "Peak force before any contact closes again"),
    ("peak_force", "peak", "contact", "N", "Peak force of the whole window"),
    ("end_velocity", "velocity", "body", "m/s", "Velocity at the end of the window"),
)


def error_table(found: ErrorEstimate) -> Table:
    """Numbers of the impact and how far the march may be from them, by contact or body; infinite errors are None."""
    return (
        {"from": "rounding" if found.exact else "a stricter run"}
        | described(found)
        | {
            name: {of: described(one) | {"unit": unit} for of, one in getattr(found, field).items()}
            for name, field, _, unit, _ in KINDS
        }
    )


def write_errors(target: h5py.Group, found: ErrorEstimate) -> None:
    """The errors in the results file, a group for each kind of number in its unit; an exact march has no tolerances."""
    write_described(target, found)
    for name, field, of, unit, description in KINDS:
        numbers: Mapping[str, Resolved] = getattr(found, field)
        if numbers:
            made = group(target, name, description)
            write_rows(made, list(numbers.values()), axis(made, of, list(numbers), "1", "Name"))
            for one in ("value", "error", "scale"):
                made[one].attrs["unit"] = made[one].attrs["units"] = unit
