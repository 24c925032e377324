"""Entries of the library as they are named in a model."""

from __future__ import annotations

from typing import Literal

from pydantic import BeforeValidator

from femstruct.language.yaml import Here, only, read_by
from femstruct.model.library.all_entries import library, names_for
from femstruct.model.library.library_entry import Use


def entry_for(use: Use, words: str, word: str = "") -> BeforeValidator:
    """Annotation of a text that names an entry; others are refused with the nearest. words : what it is; word : with
    which `femstruct materials` lists such."""
    known, do = names_for(use), f"femstruct materials {word} lists them".replace("  ", " ")
    return read_by(only(known, words, do), Literal.__getitem__(known))


def told_of(name: str | None) -> str:
    """An entry with the work behind its first value, for tables of inputs; "" of none.

    >>> told_of("CLT160 L5")
    'CLT160 L5: standard designs of CLT panels, husfabrik.eu/clt-panels-standard-design'
    """
    return f"{name}: {library()[name].facts[0].source.work}" if name else ""


def need_losses(here: Here, name: str | None, given: bool) -> None:
    """Note that an entry has no loss factor and none is given, where damping takes it."""
    found = library()[name].fact("loss_factor") if name else None
    if given or not name or (found is not None and found.value is not None):
        return
    low, high = found.between if found is not None and found.between is not None else (0.0, 0.0)
    here.wrong(
        f"no loss_factor, and {name} has none in the library",
        "'loss_factor', which damping from materials takes",
        "add 'loss_factor: ...'" + (f": printed are {100 * low:g} % to {100 * high:g} %" if high else ""),
        of_key=True,
    )
