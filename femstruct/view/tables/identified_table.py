"""Parameters found from a measured history, with their intervals, in the terminal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from femstruct.files.tables.finding_tables import finding_from
from femstruct.view.tables.console import console
from femstruct.view.tables.finding_lines import show_findings
from femstruct.view.tables.grid import Grid


def show_identification(table: Mapping[str, Any], verbose: bool = False) -> None:
    """A row a parameter with its interval, what the fit leaves over, and findings."""
    screen = console()
    grid = Grid(
        f"found from {table['samples']} samples of '{table['channel']}'",
        ("parameter", "value", f"{100 * table['confidence']:g} % interval", "+-", "unit"),
    )
    for name, one in table["parameters"].items():
        value, low, high = one["value"], one["low"], one["high"]
        half = f"{50 * (high - low) / abs(value):.2g} %" if value else ""
        grid.add(name, f"{value:.5g}", f"{low:.5g} .. {high:.5g}", half, one["unit"] or "SI")
    grid.show(screen)
    screen.print(
        f"residuals {table['residual_deviation']:.3g} {table['unit']} (standard deviation); the fit explains "
        f"{100 * table['explained']:.2f} % of the measured squares; {table['runs']} simulations",
        soft_wrap=True,
    )
    show_findings(screen, [(finding_from(one), "") for one in table["findings"]], verbose)
