"""Reasons not to believe a contact's law: used beyond its measured points, or where its formula does not hold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from femstruct.errors import Finding
from femstruct.impact.bodies import Contact
from femstruct.impact.factored import LankaraniNikravesh, Tabulated

RESTITUTION_MISSED = 0.05  # of a restitution: the law of Lankarani and Nikravesh misses it from 0.79 down


def law_findings(contacts: Sequence[Contact], deepest: Mapping[str, float]) -> tuple[Finding, ...]:
    """Findings about the laws of contacts; deepest : largest indentation of each in the run [m]."""
    found = []
    for contact in contacts:
        law, depth = contact.law, deepest[contact.name]
        if isinstance(law, Tabulated) and depth > law.indentations[-1]:
            last = float(law.indentations[-1])
            found.append(
                Finding(
                    "beyond-table",
                    f"Contact '{contact.name}' was pressed in by {1e3 * depth:.4g} mm; its table ends at "
                    f"{1e3 * last:.4g} mm. Beyond, the force went on along the last slope: a guess.",
                    {"indentation_m": depth, "last_m": last},
                    severe=True,
                )
            )
        if isinstance(law, LankaraniNikravesh) and law.returns - law.restitution > RESTITUTION_MISSED:
            found.append(
                Finding(
                    "restitution-missed",
                    f"Contact '{contact.name}' wants a restitution of {law.restitution:g} at {law.speed:g} m/s; the "
                    f"law of Lankarani and Nikravesh returns {law.returns:.3f}. It holds near 1; hunt-crossley "
                    "returns what it is asked for.",
                    {"restitution": law.restitution, "returned": law.returns, "speed_m_s": law.speed},
                )
            )
    return tuple(found)
