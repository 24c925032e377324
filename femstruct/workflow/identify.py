"""Numbers of a model or a study from what was measured: histories, modes, frequency responses, levels, or several."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from femstruct.arrays import Floats
from femstruct.declared import expect
from femstruct.errors import Finding, InputErrors
from femstruct.files.tables import finding_table, number
from femstruct.findings.catalogue import rank_findings
from femstruct.study.asked import Beside
from femstruct.workflow.fit import (
    Combination,
    Fit,
    Left,
    Parameter,
    Values,
    combinations,
    differences,
    fit_findings,
    fit_parameters,
)
from femstruct.workflow.measured_data import DELAY, Datum, HistoryDatum, MeasuredFiles, read_data, refuse_early
from femstruct.workflow.provenance import Progress
from femstruct.workflow.trial import Needs, Trial, Trials, parameters_of, read_source, refused_as_fit, start_texts

DIGITS = 6  # of values as they are written into a file


@dataclass(frozen=True, eq=False)
class DataLeft:
    """What a fit leaves of one set of data: how many independent numbers, the rms of their residuals over the scatter,
    whether that was stated."""

    name: str
    count: int
    rms: float
    known: bool


@dataclass(frozen=True, eq=False)
class Identification:
    """Parameters of a model or study by path, found from measured data.

    units : in which each was asked for, "" for SI. beside : measured beside computed. left : what is left of each set
    of data. combinations : of parameters that the data do not distinguish. runs : how often it was computed.
    """

    title: str
    units: Mapping[str, str]
    fit: Fit
    beside: tuple[Beside, ...]
    left: tuple[DataLeft, ...]
    combinations: tuple[Combination, ...]
    findings: tuple[Finding, ...]
    runs: int

    @property
    def changes(self) -> tuple[str, ...]:
        """The values as changes of the input files, ``PATH=VALUE``, to six digits."""
        found = [(name, value) for name, value in self.fit.values.items() if name != DELAY]
        return tuple(f"{name}={value:.{DIGITS}g} {self.units[name]}".rstrip() for name, value in found)

    def table(self) -> dict[str, Any]:
        """The numbers for JSON."""
        found = self.fit
        history = next((one for one in self.beside if one.kind == "history"), None)
        alone = history is not None and len(self.left) == 1
        of_history = {
            "channel": history.name,
            "unit": history.unit,
            "residual_deviation": number(found.noise * float(history.scatter[0])),
            "explained": number(found.explained),
        } if history is not None and alone else {}  # fmt: skip
        return {
            "title": self.title,
            **of_history,
            "samples": found.numbers,
            "data": [
                {"name": one.name, "numbers": one.count, "rms_over_scatter": number(one.rms), "scatter_stated":
                one.known} for one in self.left
            ],
            "confidence": found.confidence,
            "parameters": {
                name: {
                    "value": number(value),
                    "low": number(found.low[name]),
                    "high": number(found.high[name]),
                    "standard_deviation": number(found.deviations[name]),
                    "no_interval": found.why_no_interval(name),
                    "unit": self.units[name],
                }
                for name, value in found.values.items()
            },
            "correlation": [[number(one) for one in row] for row in found.correlation.tolist()],
            "not_distinguished": [
                {
                    "parameters": list(one.names),
                    "changes": list(one.changes),
                    "half_along": number(one.half_along),
                    "determined": [
                        {"formula": kept.formula, "value": number(kept.value), "half_width": number(kept.half *
                        abs(kept.value))} for kept in one.kept
                    ],
                    "sentence": one.sentence,
                }
                for one in self.combinations
            ],
            "set": list(self.changes),
            "command": " ".join(f"--set {shlex.quote(one)}" for one in self.changes),
            "runs": self.runs,
            "findings": [finding_table(finding) for finding in self.findings],
        }  # fmt: skip


def identify(
    study: Path,
    measured: Path | str | MeasuredFiles,
    channel: str = "",
    parameters: Sequence[str] = (),
    delay: bool = False,
    case: str = "",
    overrides: Sequence[str] = (),
    progress: Progress = lambda line: None,
) -> Identification:
    """Values of numbers in a study or a model with which what is computed matches what was measured.

    Parameters
    ----------
    study : Path
        A study, or a model where nothing but modes and frequency responses were measured.
    measured : Path | str | MeasuredFiles
        What was measured; or a CSV of time and value, whose header such as ``time [ms], force [N]`` gives their units,
        SI without.
    channel : str
        Then what it is of, as the study records it, "ball on floor force".
    parameters : Sequence[str]
        Texts ``PATH=START`` or ``PATH=START:LOW:HIGH`` with a start other than zero, in the unit in which the result is
        wanted. Without bounds a parameter keeps its sign.
    delay : bool
        Find the time by which the measured history begins later than the simulation [s], too.
    case : str
        Of the study, "" for its baseline.

    Raises
    ------
    InputErrors
        For what the files, the channel or the parameters do not have; InputError for parameters of which the data do
        not depend; NotConverged.

    Notes
    -----
    The study is simulated at the measured times, with the sampling and the duration that they ask for. Bases are
    solved anew for other structures only; `accuracy` plays no part. Derivatives of modes and frequency responses are
    those of the matrices, of others differences. See `femstruct.workflow.fit.fit` for what the intervals
    assume. Scatter that is stated gives each set of data its weight, and the intervals are normal; without it sets have
    weights as usual (1 % of a frequency, 10 % of a line, 1.5 dB of a band, 5 % of the rms of a history), and the
    intervals follow the residuals.

    Examples
    --------
    A ball of 1 kg hits a wall at 1 m/s; its force is a half sine of 100 N, recorded every millisecond:

    >>> from pathlib import Path
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
    parameters = expect("identify parameters", parameters, tuple[str, ...])
    overrides = expect("identify overrides", overrides, tuple[str, ...])
    files = measured if isinstance(measured, MeasuredFiles) else MeasuredFiles(str(measured), channel)
    sought, units = parameters_of(parameters)
    try:
        source = read_source(study, (*overrides, *start_texts(parameters)), case)
    except InputErrors as errors:
        raise refused_as_fit(parameters, errors) from None
    data, own = read_data(files, source, delay)
    sought += own
    needs = sum((one.needs for one in data), start=Needs())
    trials = Trials(study, sought, units, needs, case, overrides, progress)
    start = {one.name: one.start for one in sought}
    fit = _fitted(trials, data, sought)
    refuse_early(fit)
    last = trials.at(fit.values)
    sets = _by_set(data, last)
    mixed = combinations(fit, units, partial(_computed, trials, data))
    findings = (
        *fit_findings(fit, sets, mixed),
        *(finding for one in data for finding in one.findings(trials.at(start), last)),
        *trials.findings(fit.values),
    )
    return Identification(
        title=source.title,
        units={**units, **({DELAY: "s"} if delay else {})},
        fit=fit,
        beside=tuple(beside for one in data for beside in one.beside(last)),
        left=tuple(DataLeft(one.name, one.numbers, one.rms, one.known) for one in sets),
        combinations=mixed,
        findings=rank_findings(findings),
        runs=trials.runs,
    )


def _fitted(trials: Trials, data: Sequence[Datum], sought: Sequence[Parameter]) -> Fit:
    """The fit of all data together, each derivative by the way that is there for it."""

    def jacobian(values: Values) -> Floats:
        trial = trials.at(values)
        columns = []
        for one in sought:
            change = trials.change(values, one.name)
            known = [each.slopes(trial, change) if change is not None else None for each in data]
            others = [each for each, slope in zip(data, known, strict=True) if slope is None]
            if others:
                stepped = differences(partial(_computed, trials, others), sought, values, [one.name])
                parts = iter(np.split(stepped[:, 0], np.cumsum([len(each.residuals(trial)) for each in others])[:-1]))
                known = [next(parts) if slope is None else slope for slope in known]
            columns.append(np.concatenate([slope for slope in known if slope is not None]))
        return np.stack(columns, axis=1)

    size = float(np.sqrt(sum(one.size**2 for one in data)))
    return fit_parameters(
        lambda values: _residuals(trials.at(values), data),
        sought,
        size,
        jacobian,
        all(one.known for one in data),
        count=lambda values: sum(one.count(trials.at(values)) for one in data),
    )


def _computed(trials: Trials, data: Sequence[Datum], values: Values) -> Floats:
    return _residuals(trials.at(values), data)


def _residuals(trial: Trial, data: Sequence[Datum]) -> Floats:
    return np.concatenate([one.residuals(trial) for one in data])


def _by_set(data: Sequence[Datum], last: Trial) -> list[Left]:
    """The residuals of every set of data. Only a history of unknown scatter is judged by its own size."""
    return [
        Left(
            one.name,
            one.residuals(last),
            one.tracks,
            one.known,
            one.size if _by_size(one) else 0.0,
            one.count(last),
            one.doubt,
        )
        for one in data
    ]


def _by_size(one: Datum) -> bool:
    return isinstance(one, HistoryDatum) and not one.known
