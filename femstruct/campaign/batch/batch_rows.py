"""Rows of many samples at once, by the batch engine: where numbers of impacts alone are asked for, and alone vary."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import pi
from typing import Final

import numpy as np

from acoustics.errors import Advice
from femstruct.arrays import Floats
from femstruct.campaign.batch.heard_rows import HeardRooms, heard_rooms, level_names, main_names
from femstruct.campaign.batch.scene_columns import scene_columns
from femstruct.campaign.journal import Row
from femstruct.campaign.numbers import MODES, Number
from femstruct.campaign.samples import Samples
from femstruct.campaign.tasks import Split, Task, read_sample
from femstruct.errors import FemstructError, Finding
from femstruct.impact.batch.batch import simulate_batch
from femstruct.impact.batch.metrics import Batch, Energies
from femstruct.impact.batch.vary import numbers_of_scene
from femstruct.impact.laws.registry import DOUBTS
from femstruct.impact.result.contact_findings import NOT_TRUSTED, drifts
from femstruct.impact.scene.bodies import Clock, Scene
from femstruct.modal.basis import ModalBasis
from femstruct.study.asked import TimePlan
from femstruct.study.campaign.varied import Campaign
from femstruct.study.study import Case, Plan, Study
from femstruct.workflow.run.case import known_before
from femstruct.workflow.stages.fingerprint import fingerprint
from femstruct.workflow.stages.modal_bases import damped, key_of, meshed, solve_all
from femstruct.workflow.stages.staging import scene as staged

BY_BATCH: Final = (
    "by the batch engine: findings that take a history are not looked for, such as structure-not-decayed or "
    "contact-beyond-modes"
)
AT_ONCE: Final = 512  # samples of a task at most: what a kill costs


@dataclass(frozen=True, eq=False)
class BatchTask:
    """Samples to run by the batch engine.

    first : the task of the sample whose scenes are those of all but for columns, which are what differs between the
    samples in the scene of every case, by name. numbers : of the samples. only : what a row holds. threads : of the
    engine.
    """

    first: Task
    numbers: tuple[int, ...]
    columns: Mapping[str, Mapping[str, Floats]]
    only: tuple[str, ...]
    threads: int

    def left(self, known: set[int]) -> BatchTask | None:
        """The task, None where the rows of all its samples are known: they are kept together or not at all."""
        return None if known.issuperset(self.numbers) else self

    def first_of(self, count: int) -> BatchTask:
        """The first samples alone."""
        columns = {case: {name: one[:count] for name, one in own.items()} for case, own in self.columns.items()}
        return replace(self, numbers=self.numbers[:count], columns=columns)

    def rows(self) -> Iterator[list[Row]]:
        """The rows of all samples at once."""
        stage = stage_of(self.first, self.only)
        found: dict[int, dict[str, Row]] = {number: {} for number in self.numbers}
        for case in stage.plan.cases:
            batch = stage.batch(case, self.columns[case.name], len(self.numbers), self.threads)
            for row in _rows(case.name, self.numbers, batch, stage, self.only):
                found[row.sample][row.case] = row
        yield [row for own in found.values() for row in _of_sample(own)]


@dataclass(frozen=True, eq=False)
class Stage:
    """What all samples share, by case: damped bases, scenes of the first sample, who listens, codes of what is known
    before an impact and of what of it forbids trust."""

    plan: Plan
    bases: Mapping[str, ModalBasis]
    scenes: Mapping[str, Scene]
    rooms: Mapping[str, HeardRooms]
    codes: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]]

    def batch(self, case: Case, columns: Mapping[str, Floats], runs: int, threads: int) -> Batch:
        """So many runs of a case, which differ in columns; all the same where there are none."""
        scene, time = self.scenes[case.name], case.study.time
        assert time is not None
        if not columns:
            name, value = next(iter(numbers_of_scene(scene).items()))
            columns = {name: np.full(runs, value)}
        listener = self.rooms[case.name].listener if case.name in self.rooms else None
        return simulate_batch(self.bases[case.name], scene, _clock(time), columns, threads, listener=listener)

    def offered(self, case: Case, batch: Batch) -> dict[str, tuple[Floats, str]]:
        """All numbers of the runs of a case, with their units, named as in a full row."""
        found = offered(batch, self.bases[case.name])
        for record in case.study.records:  # a full row has these in place of the peak forces
            if record.what == "force" and record.target in batch.peak_force:
                found[str(record)] = found.pop(f"{record.target} peak force")
        if case.name in self.rooms:
            levels = dict(zip(self.rooms[case.name].names, batch.heard.T, strict=True))
            found |= {name: (one, "dB") for name, one in levels.items()}
            found |= {name: (levels[of], "dB") for name, of in main_names(case.study).items()}
        return found


def batch_tasks(campaign: Campaign, samples: Samples, threads: int) -> Split | str:
    """All samples as tasks of the batch engine; why it takes full runs where it does.

    It takes them where a row is to hold every number, or one that needs a history; where anything but numbers of
    bodies, contacts, links and loads varies; and where these cannot be foreseen (`scene_columns`).
    """
    if not campaign.only:
        return "a row holds all numbers; name those that you need under 'samples: {only: [..]}' or by --only"
    first = Task(campaign.file, campaign.overrides, campaign.case, ((0, samples.changes(0)),))
    try:
        plan = read_sample(first, samples.changes(0))
        if not all(_impact_alone(case) for case in plan.cases):
            return "a case is more than one impact in the modes that were asked for"
        structures = {case.name: key_of(case.study) for case in plan.cases}
        places = {case.name: meshed(case.study.structure, case.studies).places for case in plan.cases}

        def scenes(texts: Sequence[str]) -> dict[str, tuple[Study, Scene]]:
            cases = read_sample(first, texts).cases
            same = {case.name: key_of(case.study) for case in cases} == structures
            return {one.name: (one.study, staged(one.study, places[one.name])) for one in cases} if same else {}

        found = scene_columns(samples, scenes)
        if found is None or not all(map(numbers_of_scene, found.scenes.values())):
            return "more varies than numbers of bodies, contacts, links and loads, or not in proportion to them"
        stage = stage_of(first, campaign.only)
        for case in plan.cases:
            known = stage.offered(case, stage.batch(case, {}, 1, 1))
            if missing := [name for name in campaign.only if name not in known]:
                return f"'{missing[0]}' is a number of full runs"
    except (FemstructError, TypeError) as error:  # full runs say it of each sample
        return f"the batch engine does not take this study: {error}"
    n = len(samples.texts)
    tasks = tuple(
        BatchTask(
            first,
            tuple(range(start, min(start + AT_ONCE, n))),
            {
                case: {name: column[start : start + AT_ONCE] for name, column in own.items()}
                for case, own in found.columns.items()
            },
            campaign.only,
            threads,
        )
        for start in range(0, n, AT_ONCE)
    )
    return Split(tasks, plan, {}, len(set(structures.values())), n * len(plan.cases))


def offered(batch: Batch, basis: ModalBasis) -> dict[str, tuple[Floats, str]]:
    """All numbers of impacts that the batch engine has, [runs] with their units, named as in a full row."""
    runs = len(batch.status)
    parted = np.isfinite(batch.at_separation.t)
    found = {"structure energy": (np.where(parted, batch.at_separation.structure, batch.end.structure), "J")}
    for name, peak in batch.peak_force.items():
        table = f"contacts / {name} /"
        found |= {
            f"{name} peak force": (peak, "N"),
            f"{table} peak_force_n": (peak, "N"),
            f"{table} peak_time_s": (batch.peak_time[name], "s"),
            f"{table} closings": (batch.closings[name], ""),
            f"{table} first_open_s": (batch.first_open[name], "s"),
        }
    found |= {f"bodies / {name} / end_velocity": (one, "") for name, one in batch.end_velocity.items()}
    for when, energies in (("at_separation", batch.at_separation), ("end", batch.end)):
        found |= {f"energy / {when} / {name}": one for name, one in _balance(energies).items()}
    found["energy / ledger_residual"] = batch.residual, ""
    for number, omega in enumerate(basis.omega[basis.modes][:MODES], 1):
        found[f"mode {number} frequency"] = np.full(runs, float(omega) / (2.0 * pi)), "Hz"
    found["total mass"] = np.full(runs, basis.total_mass), "kg"
    return found


def _balance(one: Energies) -> dict[str, tuple[Floats, str]]:
    """Energies at one instant; those lost in dashpots of the structure are not told from those lost in modes."""
    stored = sum((*one.contacts.values(), *one.links.values()), np.zeros_like(one.t))
    lost = {f"lost / contacts / {name}": energy for name, energy in one.lost_contacts.items()}
    lost |= {f"lost / links / {name}": energy for name, energy in one.lost_links.items()}
    energies = {
        **one.bodies,
        "structure": one.structure,
        "stored": stored,
        "dissipated": sum(lost.values(), one.lost_modes),
        **lost,
        "work": one.work,
        "blows": one.blows,
    }
    return {"t_s": (one.t, "s"), **{name: (energy, "J") for name, energy in energies.items()}}


def _impact_alone(case: Case) -> bool:
    """Whether a case is one impact without air that reacts on it, in the modes that were asked for."""
    study = case.study
    two_way = any(room.coupling == "two-way" for room in study.rooms)
    return study.time is not None and not case.drops and study.accuracy is None and not two_way


def _clock(time: TimePlan) -> Clock:
    return Clock(time.duration, time.sampling, time.quiet)


def stage_of(first: Task, only: tuple[str, ...]) -> Stage:
    """The stage of a sample, for numbers to be made of it; that of the last task where it is the same.

    Raises what reading, solving and staging raise.
    """
    plan = read_sample(first, first.samples[0][1])
    key = fingerprint((dict(plan.sources), first.overrides, first.case, first.samples, only))
    if key not in _STAGES:
        stage = _made(plan, only)
        _STAGES.clear()
        _STAGES[key] = stage
    return _STAGES[key]


def _made(plan: Plan, only: Sequence[str]) -> Stage:
    solved = solve_all(plan.cases)
    baseline = next(case for case in plan.cases if case.name == plan.baseline)
    bases = {case.name: damped(case, solved, baseline) for case in plan.cases}
    scenes = {case.name: staged(case.study, solved[case.name].places, bases[case.name]) for case in plan.cases}
    codes, rooms = {}, {}
    for case in plan.cases:
        study, own, basis = case.study, solved[case.name], bases[case.name]
        found: list[Finding | Advice] = [*known_before(case, own, basis, None)]
        if study.time is not None and not {*level_names(study), *main_names(study)}.isdisjoint(only):
            rooms[case.name] = heard_rooms(study, own.places, basis, scenes[case.name], _clock(study.time))
            found += rooms[case.name].told
        severe = dict.fromkeys(one.code for one in found if isinstance(one, Finding) and one.severe)
        codes[case.name] = tuple(dict.fromkeys(one.code for one in found)), tuple(severe)
    return Stage(plan, bases, scenes, rooms, codes)


def _rows(case: str, numbers: Sequence[int], batch: Batch, stage: Stage, only: Sequence[str]) -> Iterator[Row]:
    """The rows of one case."""
    known, severe = stage.codes[case]
    own = stage.offered(next(one for one in stage.plan.cases if one.name == case), batch)
    columns = [(name, own[name][0].tolist(), own[name][1]) for name in only]
    flags = {code: flag.tolist() for code, flag in batch.flags.items() if flag.any()}
    forbids = {code: flags[code] for code, forbid in DOUBTS.items() if forbid and code in flags}
    forbids["energy-drift"] = drifts(batch.residual, NOT_TRUSTED).tolist()
    for i, number in enumerate(numbers):
        if told := batch.trouble(i):
            yield Row(number, case, {}, trouble=told)
            continue
        codes = dict.fromkeys((*known, *(code for code, flag in flags.items() if flag[i])))
        worst = dict.fromkeys((*severe, *(code for code, flag in forbids.items() if flag[i])))
        values = {name: Number(column[i], unit) for name, column, unit in columns}
        yield Row(number, case, values, tuple(codes), tuple(worst))


def _of_sample(rows: Mapping[str, Row]) -> list[Row]:
    """The rows of a sample by case; the one that failed, if there is one."""
    failed = next((row for row in rows.values() if row.trouble), None)
    return list(rows.values()) if failed is None else [replace(failed, case="")]


_STAGES: Final[dict[str, Stage]] = {}  # of this process, the latest
