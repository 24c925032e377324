"""What commands share: how they end, and the arguments that several of them have."""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Final

import typer

from femstruct.exits import INTERRUPTED, refuse_unreadable_words

StudyFile = Annotated[Path, typer.Argument(metavar="STUDY", help="a study: what happens to a structure (YAML)")]
ModelFile = Annotated[Path, typer.Argument(metavar="MODEL", help="a model: what the structure is (YAML)")]
AsJson = Annotated[bool, typer.Option("--json", help="print JSON to stdout")]
Sets = Annotated[list[str], typer.Option("--set", metavar="PATH=VALUE", help="change one value of the input files")]
Verbose = Annotated[bool, typer.Option("-v", "--verbose", help="also print findings that are remarks")]
OnlyCase = Annotated[str, typer.Option("--case", metavar="CASE", help="run only this case")]
Modes = Annotated[int | None, typer.Option("--count", min=1, help="number of modes")]
FirstModes = Annotated[
    str, typer.Option("--up-to", metavar="F", help="all modes up to a frequency (default: the first 30)")
]
Near = Annotated[
    str, typer.Option("--near", metavar="PERCENT", help="width of a group of near-equal frequencies, one space")
]
Workers = Annotated[int, typer.Option("--workers", metavar="N", min=0, help="processes", show_default="one a core")]
Cluster = Annotated[str, typer.Option("--cluster", metavar="ADDRESS", help="of a Dask scheduler")]
NumbersOnly = Annotated[bool, typer.Option("--no-pictures", help="numbers and tables only")]
WithoutPictures = Annotated[
    bool,
    typer.Option("--no-pictures", help="numbers, tables and sound only, in half the time; removes earlier pictures"),
]
OutputHere = Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="folder", show_default="here")]
NONE: Final[list[str]] = []  # typer gives each call a list of its own


def as_typed() -> str:
    """The command that runs, for results that name it."""
    return " ".join(["femstruct", *sys.argv[1:]])


def command(function: Callable[..., int]) -> Callable[..., None]:
    """A command that exits with the code its function returns; an interruption is not a failure."""

    @functools.wraps(function)
    def called(*args: Any, **options: Any) -> None:
        refuse_unreadable_words(options)
        try:
            code = function(*args, **options)
        except KeyboardInterrupt:
            print("Interrupted. No partial files were written; existing files are unchanged.", file=sys.stderr)
            code = INTERRUPTED
        raise typer.Exit(code)

    return called
