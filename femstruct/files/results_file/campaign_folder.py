"""The results file of a campaign where that of a run is asked for."""

from __future__ import annotations

from pathlib import Path

from femstruct.errors import InputError
from femstruct.files.results_file.found_file import OPTIMUM
from femstruct.files.results_file.swept_file import SWEEP

KINDS = {SWEEP: "a sweep", OPTIMUM: "an optimisation"}


def campaign_file(given: str | Path) -> Path | None:
    """The sweep.h5 or optimise.h5 that is meant by its name or by that of its folder; None where there is none, and for
    a folder with the results file of a run.

    >>> campaign_file("results/no_such_study.sweep")
    """
    path = Path(given)
    if path.is_dir():
        files = [] if (path / "results.h5").exists() else [path / name for name in KINDS]
    else:
        files = [path] if path.name in KINDS else []
    return next((file for file in files if file.is_file()), None)


def refuse_campaign(given: str | Path) -> None:
    """Raise InputError, with where its table and its page are, for a campaign in place of a run."""
    file = campaign_file(given)
    if file is not None:
        there = [file.with_suffix(ending) for ending in (".csv", ".html")]
        listed = " and ".join(str(one) for one in there if one.is_file())
        open_it = f"open {listed}, or " if listed else ""
        do = f"{open_it}write its table with 'femstruct export {file.parent} --to xlsx'"
        raise InputError(str(given), got=f"{KINDS[file.name]}", expected="one run, with its results.h5", do=do)
