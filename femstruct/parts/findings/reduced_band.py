"""Findings on reduced parts that are asked for more than they were reduced for."""

from __future__ import annotations

from typing import Final

from femstruct.errors import Finding
from femstruct.model.model import Model
from femstruct.parts.substructure import SubstructureMesh

BEYOND: Final = 0.75
"""Of the highest frequency of the modes kept: a floor of two parts erred by 2e-6 at 0.67 of it, by 3e-4 at 0.86."""


def reduced_findings(model: Model, up_to_hz: float) -> tuple[Finding, ...]:
    """Reduced parts that lack modes for what is looked at [Hz]."""
    found = []
    for name, part in model.parts.items():
        kept = part.part.component.reduced_to_hz if isinstance(part, SubstructureMesh) else None
        if kept is not None and up_to_hz > BEYOND * kept:
            found.append(
                Finding(
                    "reduced-beyond",
                    f"{name} was reduced with modes up to {kept:.4g} Hz, which is good to {BEYOND * kept:.4g} Hz: "
                    f"{up_to_hz:.4g} Hz is looked at. Above, modes may be missing and frequencies are too high. Reduce "
                    f"it with modes up to {2.0 * up_to_hz:.3g} Hz.",
                    {"reduced_to_hz": kept, "up_to_hz": up_to_hz},
                )
            )
    return tuple(found)
