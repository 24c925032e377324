"""Numbers of a study from a measured history: contact stiffness and damping from a force, or any others."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any, Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding, InputError, InputErrors
from femstruct.files.inputs.columns import read_measured
from femstruct.files.tables.finding_tables import finding_table
from femstruct.files.tables.json_numbers import number
from femstruct.findings.catalogue import ranked
from femstruct.impact.scene.bodies import Table as Measured
from femstruct.language import read_study
from femstruct.language.yaml.tree import nearest
from femstruct.study.result import CaseResult
from femstruct.study.study import Plan
from femstruct.workflow.identify.fit import Fit, fit
from femstruct.workflow.identify.fit_findings import fit_findings
from femstruct.workflow.run.case import run_case
from femstruct.workflow.run.provenance import Progress, Stopwatch
from femstruct.workflow.run.run import without_rooms
from femstruct.workflow.stages.modal_bases import Solved, key_of, solve_all
from femstruct.workflow.stages.positions import positioned
from femstruct.workflow.stages.recorded.channels import UNITS
from femstruct.workflow.stages.room_transfers import RoomTransfers

DIMENSIONS: Final = {
    "displacement": "length",
    "travel": "length",
    "velocity": "speed",
    "acceleration": "acceleration",
    "force": "force",
    "pressure": "pressure",
}
FROM_REST: Final = ("force", "acceleration", "pressure")  # zero before t = 0
DELAY: Final = "delay"
FINER = 8  # samples of the simulation to a measured one where the measured times lie between
_VALUE = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*")


@dataclass(frozen=True, eq=False)
class Identification:
    """Parameters of a study by path, found from a measured channel.

    units : in which each was asked for, "" for SI. t, measured, computed [N] : the channel and its best match.
    """

    channel: str
    unit: str
    units: Mapping[str, str]
    fit: Fit
    t: Floats
    measured: Floats
    computed: Floats
    findings: tuple[Finding, ...]

    def table(self) -> dict[str, Any]:
        """The numbers for JSON."""
        found = self.fit
        return {
            "channel": self.channel,
            "unit": self.unit,
            "samples": len(self.measured),
            "confidence": found.confidence,
            "parameters": {
                name: {
                    "value": number(value),
                    "low": number(found.low[name]),
                    "high": number(found.high[name]),
                    "standard_deviation": number(found.deviations[name]),
                    "unit": self.units[name],
                }
                for name, value in found.values.items()
            },
            "correlation": [[number(one) for one in row] for row in found.correlation.tolist()],
            "residual_deviation": number(found.noise),
            "explained": number(found.explained),
            "runs": found.runs,
            "findings": [finding_table(finding) for finding in self.findings],
        }


def identify(
    study: Path,
    measured: Path,
    channel: str,
    parameters: Sequence[str],
    delay: bool = False,
    case: str = "",
    overrides: Sequence[str] = (),
    progress: Progress = lambda line: None,
) -> Identification:
    """Values of numbers in a study, or its model, with which a recorded channel matches a measured one.

    measured : CSV of time and value; a header such as ``time [ms], force [N]`` gives their units, SI without.
    channel : as the study records it, "ball on floor force". parameters : texts ``PATH=START`` with a start other than
    zero, in the unit in which the result is wanted.
    delay : find the time by which the measured history begins later than the simulation [s], too.
    case : of the study, "" for its baseline.

    Raises InputErrors for what the files, the channel or the parameters do not have; InputError for parameters that the
    channel does not determine; NotConverged.

    Notes
    -----
    The study is simulated at the measured times, with the sampling and the duration that they ask for. Bases are
    solved anew for other structures only; `accuracy` plays no part. See `femstruct.workflow.identify.fit.fit` for what
    the intervals assume.

    A ball of 1 kg hits a wall at 1 m/s; its force is a half sine of 100 N, recorded every millisecond:

    >>> import tempfile
    >>> study = '''
    ... model: model.yaml
    ... bodies: {ball: {mass: 1 kg, above: ground, speed: 1 m/s, contact: {type: linear, stiffness: 1 kN/m}}}
    ... record: {ball on ground: force}
    ... time: {duration: 40 ms, sampling: 1 kHz}
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "model.yaml").write_text("structure: none", encoding="utf-8")
    ...     _ = Path(folder, "hit.study.yaml").write_text(study, encoding="utf-8")
    ...     t = np.arange(0.0, 0.04, 1e-3)
    ...     force = np.where(t < 0.01 * np.pi, 100.0 * np.sin(100.0 * t), 0.0)
    ...     np.savetxt(Path(folder, "force.csv"), np.column_stack((t, force)), delimiter=",")
    ...     found = identify(
    ...         Path(folder, "hit.study.yaml"),
    ...         Path(folder, "force.csv"),
    ...         "ball on ground force",
    ...         ["bodies.ball.contact.stiffness=5 kN/m"],
    ...     )
    >>> round(found.fit.values["bodies.ball.contact.stiffness"], 4)  # in kN/m, as asked
    10.0
    """
    starts, units = _starts(parameters)
    plan = _read(study, overrides, parameters, case)
    what = _quantity(plan, channel)
    if delay and what not in FROM_REST:
        raise InputError(
            "--delay",
            got=f"a {what}",
            expected=" or ".join(FROM_REST),
            do="a motion from before has no start in the record",
        )
    table = read_measured(measured, DIMENSIONS[what])
    spacing = float(np.median(np.diff(table.times)))
    timing = _timing(plan, table, spacing, delay)
    solved: dict[str, Solved] = {}
    rooms, tried = RoomTransfers(), count(1)

    def simulated(values: Mapping[str, float], *, trial: bool) -> CaseResult:
        progress(f"identify {', '.join(starts)}: run {next(tried)}")
        changed = tuple(f"{path}={values[path]!r} {units[path]}".rstrip() for path in starts)
        now = read_study(study, (*overrides, *changed, *timing), only=case or None)
        return _simulated(now, solved, rooms, what == "pressure", trial)

    def history(values: Mapping[str, float]) -> Floats:
        result = simulated(values, trial=True)
        assert result.response is not None
        later, values_then = values.get(DELAY, 0.0), result.channels[channel].values
        before = 0.0 if what in FROM_REST else None
        return np.interp(table.times - later, result.response.t, values_then, left=before)

    found = fit(history, table.values, starts, {DELAY: spacing} if delay else {})
    return Identification(
        channel=channel,
        unit=UNITS[what],
        units={**units, **({DELAY: "s"} if delay else {})},
        fit=found,
        t=table.times,
        measured=table.values,
        computed=table.values + found.residuals,
        findings=ranked((*fit_findings(found), *simulated(found.values, trial=False).findings)),
    )


def _read(study: Path, overrides: Sequence[str], parameters: Sequence[str], case: str) -> Plan:
    """The study with the parameters where they start."""
    try:
        return read_study(study, (*overrides, *parameters), only=case or None)
    except InputErrors as errors:
        told = errors.errors
        for text in parameters:
            told = tuple(line.replace(f"--set {text}", f"--fit {text}") for line in told)
        raise InputErrors(told) from None


def _starts(parameters: Sequence[str]) -> tuple[dict[str, float], dict[str, str]]:
    """Start values and units by path."""
    starts, units = {}, {}
    for text in parameters:
        path, equals, value = text.partition("=")
        read = _VALUE.fullmatch(value)
        if not equals or not path.strip() or read is None:
            raise InputError(
                f"--fit {text}",
                got="no PATH=START",
                expected="a path of the study or its model and a number",
                do="write it like bodies.ball.contact.stiffness='4 kN/m'",
            )
        starts[path.strip()], units[path.strip()] = float(read[1]), read[2]
    if not starts:
        raise InputError("--fit", got="no parameter", expected="one or more PATH=START")
    return starts, units


def _quantity(plan: Plan, channel: str) -> str:
    """What a channel of the baseline is: its last word."""
    study = next(one.study for one in plan.cases if one.name == plan.baseline)
    known = [str(record) for record in study.records]
    known += [f"{room.name}.{receiver.name} pressure" for room in study.rooms for receiver in room.receivers]
    if study.time is None:
        raise InputError("--channel", got="a study without `time`", expected="one that simulates")
    if channel not in known:
        raise InputError("--channel", got=f"'{channel}'", expected="a recorded channel", do=nearest(channel, known))
    return channel.rpartition(" ")[2]


def _timing(plan: Plan, table: Measured, spacing: float, delay: bool) -> tuple[str, ...]:
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


def _simulated(plan: Plan, solved: dict[str, Solved], rooms: RoomTransfers, heard: bool, trial: bool) -> CaseResult:
    """The baseline of a study, run; solved : bases found so far, by key; rooms : their transfers; trial : its findings
    are not looked at."""
    plan = plan if heard else without_rooms(plan)
    case = next(one for one in plan.cases if one.name == plan.baseline)
    key = key_of(case.study)
    if key not in solved:
        solved[key] = solve_all((case,))[case.name]
    with positioned(plan):
        silent = Stopwatch(lambda line: None)
        return run_case(case, {case.name: solved[key]}, case, silent, transfers=rooms, estimated=not trial)
