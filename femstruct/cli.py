"""The command line: `femstruct run | report | plot | export | check | modes | frf | impact | sound | ..`."""

from __future__ import annotations

import gc
import os
from typing import Annotated, Final

import typer

from femstruct.commands.on_campaigns import optimise, sweep
from femstruct.commands.on_itself import explain, materials, new, schema, warm_up
from femstruct.commands.on_models import check, export, frf, identify, mac, modes, reduce, statics
from femstruct.commands.on_studies import compare, impact, plot, report, run, sound
from femstruct.exits import GOOD, end, heed_signals, leave_with

app: Final = typer.Typer(
    help="Impact vibration of structures and the sound it makes in a room.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
_OF_STUDIES_AND_MODELS = (run, check, modes, statics, frf, impact, sound, identify, sweep, optimise)
_OF_FILES_AND_ITSELF = (report, plot, compare, export, mac, reduce, new, materials, explain, schema, warm_up)
for _one in (*_OF_STUDIES_AND_MODELS, *_OF_FILES_AND_ITSELF):
    app.command()(_one)


def _print_version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        print(f"femstruct {version('femstruct')}")
        raise typer.Exit(GOOD)


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="print the version and exit")
    ] = False,
) -> None:
    """Impact vibration of structures and the sound it makes in a room."""


def main() -> None:
    """Entry point: exit 0 good, 1 our bug, 2 bad input, 3 a result not to be trusted, 130 interrupted.

    A limit of the study that is exceeded in a run is a result: exit 0. An optimisation in which no design holds all
    limits: exit 3.
    """
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "LP_NUM_THREADS"):
        os.environ.setdefault(name, "1")  # two threads are slower on the small blocks of an eigensolution
    gc.set_threshold(200_000)  # what is imported lives to the end: looking through it again and again finds nothing
    heed_signals()
    end(leave_with(app))
