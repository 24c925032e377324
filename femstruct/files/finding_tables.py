"""A finding as a table for JSON."""

from __future__ import annotations

from typing import Any

from femstruct.errors import Finding
from femstruct.files.numbers import number


def finding_table(finding: Finding) -> dict[str, Any]:
    """A finding as a table."""
    values = {name: number(value) for name, value in finding.values.items()}
    return {"code": finding.code, "message": finding.message, "values": values, "severe": finding.severe}
