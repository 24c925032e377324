"""A measured history of a recorded channel: a force, a motion, a pressure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import InputError
from femstruct.impact.scene.bodies import Table
from femstruct.language.yaml.tree import nearest
from femstruct.study.matched import Beside
from femstruct.study.study import Plan
from femstruct.workflow.identify.data.datum import Datum, norm
from femstruct.workflow.identify.trial import Needs, Trial
from femstruct.workflow.stages.recorded.channels import UNITS

DIMENSIONS: Final = {
    "displacement": "length",
    "travel": "length",
    "velocity": "speed",
    "acceleration": "acceleration",
    "force": "force",
    "pressure": "pressure",
}
DELAY: Final = "delay"
FROM_REST: Final = ("force", "acceleration", "pressure")  # zero before t = 0
FINER: Final = 8  # samples of the simulation to a measured one where the measured times lie between
USUAL: Final = 0.05  # of the rms of a history


@dataclass(frozen=True, eq=False)
class HistoryDatum(Datum):
    """Samples of a channel. what : its quantity. scatter : in its unit. timing : of the study. The record begins later
    than the simulation by the parameter DELAY [s], if there is one."""

    table: Table
    what: str
    scatter: float
    timing: tuple[str, ...]

    @property
    def needs(self) -> Needs:
        return Needs(run=True, rooms=self.what == "pressure", timing=self.timing)

    @property
    def size(self) -> float:
        return norm(self.table.values) / self.scatter

    @property
    def tracks(self) -> int:
        return 1

    def residuals(self, trial: Trial) -> Floats:
        return (self._computed(trial) - self.table.values) / self.scatter

    def beside(self, trial: Trial) -> Sequence[Beside]:
        scatter = np.full(len(self.table.times), self.scatter)
        unit, computed = UNITS[self.what], self._computed(trial)
        return (Beside("history", self.name, unit, self.table.times, self.table.values, computed, scatter),)

    def _computed(self, trial: Trial) -> Floats:
        result = trial.result
        assert result is not None and result.response is not None
        before = 0.0 if self.what in FROM_REST else None
        values = result.channels[self.name].values
        return np.interp(self.table.times - trial.values.get(DELAY, 0.0), result.response.t, values, left=before)


def quantity_of_channel(plan: Plan, channel: str) -> str:
    """What a channel of the baseline is: its last word.

    Raises InputError for a channel that is not recorded, and for a study that simulates nothing.
    """
    study = next(one.study for one in plan.cases if one.name == plan.baseline)
    known = [str(record) for record in study.records]
    known += [f"{room.name}.{receiver.name} pressure" for room in study.rooms for receiver in room.receivers]
    if study.time is None:
        raise InputError("--channel", got="a study without `time`", expected="one that simulates")
    if channel not in known:
        raise InputError("--channel", got=f"'{channel}'", expected="a recorded channel", do=nearest(channel, known))
    return channel.rpartition(" ")[2]


def timing_of(plan: Plan, table: Table, spacing: float, delay: bool) -> tuple[str, ...]:
    """Sampling and duration, as changes of the study, that hold every measured time."""
    end = float(table.times[-1])
    if not end > 0.0:
        raise InputError("measured", got=f"times up to {end:g} s", expected="times after 0, when the study starts")
    places = table.times / spacing
    even = bool(np.abs(places - np.rint(places)).max() < 1e-3) and not delay
    sampling = (1 if even else FINER) / spacing
    plan_time = next(one.study.time for one in plan.cases if one.name == plan.baseline)
    assert plan_time is not None
    finer = max(1, int(np.ceil(plan_time.sampling / sampling)))
    sampling *= finer
    return (f"time.sampling={sampling!r}", f"time.duration={end + 2.0 / sampling!r}")
