"""How far the numbers of a case may be off, as tables: what more modes change, and what the march leaves."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from femstruct.files.described import described
from femstruct.files.hdf5 import axis, group, put
from femstruct.files.numbers import number
from femstruct.impact.estimate import ErrorEstimate, Resolved
from femstruct.study.result import AccuracyCheck

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py

Table = dict[str, Any]
_KINDS: Final = (
    ("first_peak_force", "first_peak", "contact", "N", "Peak force before any contact closes again"),
    ("peak_force", "peak", "contact", "N", "Peak force of the whole window"),
    ("end_velocity", "velocity", "body", "m/s", "Velocity at the end of the window"),
)


def accuracy_table(check: AccuracyCheck) -> Table:
    """What more modes change, against what was asked; infinite numbers are None."""
    return {
        "asked": check.within,
        "reached": number(check.share),
        "holds": check.holds,
        "band_hz": list(check.band),
        "window_s": number(check.window),
        "smaller_hz": number(check.smaller_hz),
        "larger_hz": number(check.larger_hz),
        "used_hz": number(check.used_hz),
        "used_modes": check.used_modes,
        "largest": {
            name: {word: getattr(found, word) for word in ("smaller", "larger", "difference", "share", "unit")}
            for name, found in check.deviations.items()
        },
    }


def error_table(found: ErrorEstimate) -> Table:
    """Numbers of the impact and how far the march may be from them, by contact or body; infinite errors are None."""
    return {
        "from": "rounding" if found.exact else "a stricter run",
        "tolerance": found.tolerance,
        "against": found.against,
        "first_until_s": number(found.first_until),
        **{
            name: {of: described(one) | {"unit": unit} for of, one in getattr(found, field).items()}
            for name, field, _, unit, _ in _KINDS
        },
    }


def write_accuracy(target: h5py.Group, check: AccuracyCheck) -> None:
    """What two bases make of the first impact; numbers that do not exist (all modes are there) are infinite."""
    target.attrs.update(
        asked=check.within,
        holds=check.holds,
        band_hz=np.array(check.band),
        window_s=check.window,
        smaller_hz=check.smaller_hz,
        larger_hz=check.larger_hz,
        used_hz=check.used_hz,
        used_modes=check.used_modes,
    )
    if check.deviations:
        found = check.deviations.values()
        channel = axis(target, "channel", list(check.deviations), "1", "Channel, or contact peak force")
        put(target, "channel_unit", [d.unit for d in found], "1", "Unit of smaller, larger and difference", (channel,))
        for word, what in (("smaller", "Largest |value| with the smaller basis"), ("larger", "With the larger basis")):
            put(target, word, [getattr(d, word) for d in found], "see channel_unit", what, (channel,))
        put(target, "difference", [d.difference for d in found], "see channel_unit", "Largest at any time", (channel,))
        put(target, "share", [d.share for d in found], "1", "Difference over the larger basis's value", (channel,))


def write_errors(target: h5py.Group, found: ErrorEstimate) -> None:
    """The same in the results file, a group for each kind of number; tolerances of an exact march are nan."""
    target.attrs.update(
        exact=found.exact,
        tolerance=np.nan if found.tolerance is None else found.tolerance,
        against=np.nan if found.against is None else found.against,
        first_until_s=found.first_until,
    )
    for name, field, of, unit, description in _KINDS:
        numbers: Mapping[str, Resolved] = getattr(found, field)
        if not numbers:
            continue
        made = group(target, name, description)
        what = axis(made, of, list(numbers), "1", "Name")
        put(made, "value", [one.value for one in numbers.values()], unit, description, (what,))
        put(made, "error", [one.error for one in numbers.values()], unit, "Estimated error of it", (what,))
        put(made, "scale", [one.scale for one in numbers.values()], unit, "What the error is small against", (what,))
