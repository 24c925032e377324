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
NONE: Final[list[str]] = []  # typer gives each call a list of its own


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
