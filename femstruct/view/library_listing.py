"""The library as tables: a table for each family, and entries with the source of every value."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import Final

from femstruct.model.library import Fact, LibraryEntry
from femstruct.model.materials import Given
from femstruct.view.console import Grid, console
from femstruct.view.page import amount

WHOLE: Final = 6  # entries of which every source is shown


def show_library(entries: Sequence[LibraryEntry], in_full: bool) -> None:
    """Print entries by family; of a few that were asked for, every value with its source."""
    screen = console()
    if in_full and len(entries) <= WHOLE:
        for entry in entries:
            screen.print(f"{entry.name}: {entry.what}", style="bold", soft_wrap=True)
            for one in entry.facts:
                screen.print(f"  {_fact_text(one)}", soft_wrap=True)
            screen.print(f"  in a model: {entry.use.value}", soft_wrap=True)
        return
    for family, some in groupby(entries, key=lambda entry: entry.family):
        family_table(family, tuple(some)).show(screen)
    screen.print("`femstruct materials NAME` shows the source of every value, and how a model takes it")


def family_table(family: str, entries: Sequence[LibraryEntry]) -> Grid:
    """The entries of a family with what is known of each.

    >>> from femstruct.model.library_entries import matching_entries
    >>> family_table("screeds", matching_entries(["screed"])).rows[0]
    ('screed sand-cement', '20.28 GPa', '0.2', '2000 kg/m³', '1 %')
    """
    keys = tuple(dict.fromkeys(one.key for entry in entries for one in entry.facts))
    grid = Grid(family, ("", *(_symbol(key) for key in keys)))
    for entry in entries:
        found = {one.key: value_text(one) for one in entry.facts}
        grid.add(entry.name, *(found.get(key, "-") for key in keys))
    return grid


def value_text(one: Fact) -> str:
    """A value with its unit, or the range where only that is known."""
    if one.value is not None:
        return _amount(one, one.value)
    low, high = one.between or (0.0, 0.0)
    return f"{_amount(one, low)} to {_amount(one, high)}"


def _fact_text(one: Fact) -> str:
    text = f"{_symbol(one.key)} {value_text(one)}"
    if one.value is not None and one.between is not None:
        text += f" ({_amount(one, one.between[0])} to {_amount(one, one.between[1])})"
    return f"{text}{f', {one.note}' if one.note else ''}; {one.source}"


def _amount(one: Fact, value: float | tuple[float, ...]) -> str:
    digits = tuple(float(f"{x:.4g}") for x in value) if isinstance(value, tuple) else float(f"{value:.4g}")
    return amount(Given(_symbol(one.key), digits, one.unit))


def _symbol(key: str) -> str:
    return key.replace("_", " ")
