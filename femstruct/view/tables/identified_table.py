"""Parameters found from what was measured, with their intervals, in the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from femstruct.files.tables.finding_tables import finding_from
from femstruct.study.matched import Beside
from femstruct.view.tables.console import console
from femstruct.view.tables.finding_lines import show_findings
from femstruct.view.tables.grid import Grid

LISTED: Final = ("modes", "levels")  # kinds whose numbers are few enough to be listed


def show_identification(table: Mapping[str, Any], beside: Sequence[Beside] = (), verbose: bool = False) -> None:
    """A row a parameter with its interval, measured beside computed numbers, what the fit leaves over, the values as
    changes of the input files, and findings."""
    screen = console()
    told = f"'{table['channel']}'" if "channel" in table else ", ".join(one["name"] for one in table["data"])
    what = "samples" if "channel" in table else "numbers"
    grid = Grid(
        f"found from {table['samples']} {what} of {told}",
        ("parameter", "value", f"{100 * table['confidence']:g} % interval", "+-", "unit"),
    )
    for name, one in table["parameters"].items():
        value, low, high = one["value"], one["low"], one["high"]
        half = f"{50 * (high - low) / abs(value):.2g} %" if _known(one) and value else ""
        grid.add(name, f"{value:.5g}", _between(one), half, one["unit"])
    grid.show(screen)
    for one in beside:
        if one.kind in LISTED:
            _show_beside(screen, one)
    if "channel" in table:
        screen.print(
            f"residuals {table['residual_deviation']:.3g} {table['unit']} (standard deviation); the fit explains "
            f"{100 * table['explained']:.2f} % of the measured squares; {table['runs']} simulations",
            soft_wrap=True,
        )
    else:
        for one in table["data"]:
            taken = "stated" if one["scatter_stated"] else "usual"
            screen.print(
                f"{one['name']}: {one['numbers']} numbers, residuals {one['rms_over_scatter']:.2g} times the {taken} "
                "scatter (rms)",
                soft_wrap=True,
            )
        screen.print(f"{table['runs']} trials")
    screen.print(f"to use the values: {table['command']}", soft_wrap=True)
    show_findings(screen, [(finding_from(one), "") for one in table["findings"]], verbose)


def found_lines(table: Mapping[str, Any]) -> list[str]:
    """A line a parameter, below the title of a picture: its value, unit and interval."""
    share = f"{100 * table['confidence']:g} %"
    return [
        f"{name} = {one['value']:.5g} {one['unit']}".rstrip()
        + (f"  ({share} interval {_between(one)})" if _known(one) else f"  ({one['no_interval']})")
        for name, one in table["parameters"].items()
    ]


def _known(one: Mapping[str, Any]) -> bool:
    return one["low"] is not None and one["high"] is not None


def _between(one: Mapping[str, Any]) -> str:
    return f"{one['low']:.5g} .. {one['high']:.5g}" if _known(one) else str(one["no_interval"])


def _show_beside(screen: Any, one: Beside) -> None:
    modes = one.kind == "modes"
    columns = ("mode" if modes else "band [Hz]", f"measured [{one.unit}]", f"computed [{one.unit}]", "difference", "")
    grid = Grid(one.name, columns)
    for i, (along, measured, computed) in enumerate(zip(one.along, one.measured, one.computed, strict=True)):
        off = f"{100 * (computed / measured - 1.0):+.2f} %" if modes else f"{computed - measured:+.1f} dB"
        digits = f"{measured:.5g}", f"{computed:.5g}"
        grid.add(f"{along:g}", *digits, off, one.notes[i] if one.notes else "")
    grid.show(screen)
