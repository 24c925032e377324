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
from femstruct.workflow.identify.intervals import Fit, Parameter
from femstruct.workflow.identify.needs import Needs
from femstruct.workflow.identify.trial import Trial
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
MARGIN: Final = 0.5  # of a record: a recorder that starts later than that has missed what is to be fitted
FINER: Final = 8  # samples of the simulation to a measured one where the measured times lie between
DIGITS: Final = 9  # of a sampling: the rounding of written times doubles none
USUAL: Final = 0.05  # of the rms of a history


@dataclass(frozen=True, eq=False)
class HistoryDatum(Datum):
    """Samples of a channel. what : its quantity. scatter : in its unit. window : sampling [Hz] and duration [s] that it
    asks of the study. The record begins later than the simulation by the parameter DELAY [s], if there is one."""

    table: Table
    what: str
    scatter: float
    window: tuple[float, float]

    @property
    def needs(self) -> Needs:
        return Needs(run=True, rooms=self.what == "pressure", sampling=self.window[0], duration=self.window[1])

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


def window_of(plan: Plan, table: Table, spacing: float, delay: bool) -> tuple[float, float]:
    """Sampling [Hz] and duration [s] of a simulation that holds every measured time, and with a delay to fit the margin
    beyond them, which a negative one reaches into."""
    end = float(table.times[-1])
    if not end > 0.0:
        raise InputError("measured", got=f"times up to {end:g} s", expected="times after 0, when the study starts")
    places = table.times / spacing
    even = bool(np.abs(places - np.rint(places)).max() < 1e-3) and not delay
    sampling = float(f"{(1 if even else FINER) / spacing:.{DIGITS}g}")
    plan_time = next(one.study.time for one in plan.cases if one.name == plan.baseline)
    assert plan_time is not None
    finer = max(1, int(np.ceil(plan_time.sampling / sampling)))
    sampling *= finer
    return sampling, end + margin_of(table) * delay + 2.0 / sampling


def margin_of(table: Table) -> float:
    """How far a simulation goes beyond a record whose delay is fitted [s]."""
    return MARGIN * float(table.times[-1])


def delay_parameter(table: Table, spacing: float) -> Parameter:
    """The delay to find [s]: what is later than the simulation is compared with none of it, and counts as rest."""
    return Parameter(DELAY, 0.0, -margin_of(table), np.inf, spacing)


def refuse_early(fit: Fit) -> None:
    """Raise InputError for a delay that asks for more of a simulation than there is."""
    if DELAY not in fit.at_bound:
        return
    most = f"{-1e3 * fit.values[DELAY]:.3g} ms"
    raise InputError(
        "--delay",
        got=f"a record that seems to lack the first {most} of the simulated history, or more",
        expected=f"one that lacks less, as the simulation ends {most} after the record",
        do="give a longer record, or write its times so that t = 0 is near the beginning of the event",
    )
