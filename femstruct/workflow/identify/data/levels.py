"""Measured levels by band at the receivers or in the rooms of a study."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import InputError, shown_as, some_of
from femstruct.files.inputs.band_tables import band_of
from femstruct.files.inputs.grids import Grid, read_grid, wrong_in
from femstruct.study.matched import Beside
from femstruct.study.study import Plan
from femstruct.workflow.identify.data.datum import Datum, norm
from femstruct.workflow.identify.needs import Needs
from femstruct.workflow.identify.trial import Trial

USUAL: Final = 1.5  # dB: repeated measurements of one room
_COLUMN: Final = re.compile(r"(?:(?P<case>.+): )?(?P<place>[^:]+?)(?: bands_db(?: \([^)]*\))?)?")


@dataclass(frozen=True, eq=False)
class LevelsDatum(Datum):
    """Levels [n] [dB] of bands [n] [Hz] at one receiver, ROOM.RECEIVER, or of a rated room. scatter : [dB]. planned :
    how long the study simulates [s], of which the levels are."""

    place: str
    bands_hz: Floats
    levels_db: Floats
    scatter: float
    planned: float

    @property
    def needs(self) -> Needs:
        return Needs(run=True, rooms=True, duration=self.planned)

    @property
    def size(self) -> float:
        return norm(np.full(len(self.levels_db), 20.0 / np.log(10.0))) / self.scatter

    def residuals(self, trial: Trial) -> Floats:
        return (self._computed(trial) - self.levels_db) / self.scatter

    def beside(self, trial: Trial) -> Sequence[Beside]:
        scatter, computed = np.full(len(self.bands_hz), self.scatter), self._computed(trial)
        return (Beside("levels", self.place, "dB", self.bands_hz, self.levels_db, computed, scatter),)

    def _computed(self, trial: Trial) -> Floats:
        result = trial.result
        assert result is not None
        own: Mapping[float, float]
        if self.place in result.rated:
            own = result.rated[self.place].bands_db
        else:
            own = (result.heard.total_levels or result.levels)[self.place].bands_db
        found = np.array([own.get(band, np.nan) for band in self.bands_hz.tolist()])
        if not np.isfinite(found).all():
            blank = some_of(f"{band:g}" for band in self.bands_hz[~np.isfinite(found)])
            do = "compute more modes, or leave out their lines"
            raise InputError("--levels", got=f"bands that the study does not compute: {blank} Hz", expected="", do=do)
        return found


def read_levels(path: Path, scatter: float | None, plan: Plan) -> tuple[LevelsDatum, ...]:
    """Levels of a table of bands, a column for every place of the study: ``ROOM.RECEIVER``, ``ROOM``, or as `femstruct
    export` heads it, ``CASE: ROOM.RECEIVER bands_db (L_Fmax)``, of which only the case that is fitted is taken.

    Raises InputError for a table in which no column is a place of the study.
    """
    study = next(one.study for one in plan.cases if one.name == plan.baseline)
    known = [f"{room.name}.{receiver.name}" for room in study.rooms for receiver in room.receivers]
    known += [room.name for room in study.rooms]
    if not known:
        raise InputError("--levels", got="a study without rooms", expected="one with receivers")
    if study.time is None:
        raise InputError("--levels", got="a study without `time`", expected="one that simulates")
    grid = read_grid(path, {}, "a table of levels")
    head = grid.rows[0].cells if grid.rows else []
    places: dict[str, int] = {}
    for at, cell in enumerate(head[1:], 1):
        found = _COLUMN.fullmatch(cell.split("[")[0].strip())
        if found is not None and found["place"] in known and (found["case"] or plan.baseline) == plan.baseline:
            if found["place"] in places:
                raise grid.wrong(
                    grid.rows[0], f"two columns of {found['place']}", "one", "keep one, or rename the other"
                )
            places[found["place"]] = at
    if not places:
        got, expected = f"'{path}' with columns {some_of(head[1:]) or 'without heads'}", f"a column {some_of(known)}"
        do = f"of the case '{plan.baseline}', which is fitted" if any(": " in cell for cell in head) else ""
        raise InputError("--levels", got=got, expected=expected, do=do)
    return tuple(_one(grid, scatter, study.time.duration, place, at) for place, at in places.items())


def _one(grid: Grid, scatter: float | None, planned: float, place: str, at: int) -> LevelsDatum:
    """The bands of one column that have a level; blank cells were not measured."""
    found: dict[float, float] = {}
    for row in grid.rows[1:]:
        grid.refuse_longer(row)
        try:
            band = band_of(row.cells[0])
        except InputError as error:
            raise wrong_in(grid.path, row.line, error) from None
        if band is None or band in found:
            raise grid.wrong(row, shown_as(row.cells[0]), "a third octave or octave, such as 63, each once")
        cell = row.cells[at] if at < len(row.cells) else ""
        value = grid.number(row, cell) if cell else None
        if cell and value is None:
            raise grid.wrong(row, shown_as(cell), "a level in dB, or nothing")
        if value is not None:
            found[band] = value
    if not found:
        raise grid.wrong(grid.rows[0], f"no level below '{grid.rows[0].cells[at]}'", "one or more")
    name = f"{grid.path.name} {place}"
    return LevelsDatum(
        name, scatter is not None, place, np.array([*found]), np.array([*found.values()]), scatter or USUAL, planned
    )
