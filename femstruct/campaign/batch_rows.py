"""Rows of many samples at once by the batch engine, where impacts alone vary."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from math import isfinite, pi
from typing import Final

import numpy as np

from acoustics.errors import Advice
from acoustics.levels.bands import truncate_response
from acoustics.levels.sound_levels import a_levels
from acoustics.room_response import RoomResponse
from femstruct.arrays import Floats
from femstruct.campaign.rows import MODES, Number, Row, choose_numbers, numbers_of, numbers_of_limit
from femstruct.campaign.tasks import Samples, Split, Task, read_sample
from femstruct.errors import FemstructError, Finding, InputError
from femstruct.files.writing import contents
from femstruct.impact.batch import Batch, Energies, Listener, simulate_batch
from femstruct.impact.batch_march import numbers_of_scene, variation
from femstruct.impact.blow_by_blow import NOT_TRUSTED, drifts
from femstruct.impact.scene import Clock, Scene
from femstruct.impact.simulate import simulate
from femstruct.language.models import with_position
from femstruct.laws.registry import DOUBTS
from femstruct.modal.basis import ModalBasis
from femstruct.sound.flanking import PushTransfer, push_transfer
from femstruct.sound.surfaces import is_at_rest, moving_modes, surface_velocities
from femstruct.study.asked import RoomPlan
from femstruct.study.campaigns import Campaign
from femstruct.study.placed_rooms import placed_room
from femstruct.study.results import CaseResult
from femstruct.study.study import Case, Plan, Study
from femstruct.workflow.bases import Places, Solved, damp_basis, fingerprint, key_of, meshed, solve_all
from femstruct.workflow.case import clock_of, findings_before_run, room_mode_findings, run_impact
from femstruct.workflow.staging import build_scene as staged
from femstruct.workflow.study_findings import room_silent

# ----------------------------------------------------------------------------------------------------------------------
# Which numbers of a scene follow what a campaign varies: read from a few of its samples, foreseen for all others.
# ----------------------------------------------------------------------------------------------------------------------

ROUNDING: Final = 1e-13  # of the largest value: some multiplications, and texts of 17 digits
TABLED: Final = 12  # values of a path, all of which are read if there are no more
LOOKS: Final = 5  # values of a path that are read where there are more; whole samples that are compared
READ: Final = 50  # samples after which it is told how many were read
IN_SCENE: Final = frozenset({"bodies", "contacts", "links", "loads"})  # of a study: what its scene is made of

Staged = Callable[[Sequence[str]], Mapping[str, tuple[Study, Scene]]]
Numbers = Mapping[str, Mapping[str, float]]  # of scenes, by case
Columns = Mapping[str, Mapping[str, Floats]]  # of scenes, by case: the numbers of all samples


@dataclass(frozen=True, eq=False)
class SceneColumns:
    """The scene of the first sample by case, and the numbers of it that differ between n samples, by name [n]."""

    scenes: Mapping[str, Scene]
    columns: Columns


def scene_columns(
    samples: Samples, staged: Staged, report: Callable[[str], None] = lambda line: None
) -> SceneColumns | None:
    """What all samples change, where that is nothing but numbers of scenes; None where it is more.

    Parameters
    ----------
    staged : Staged
        Study and scene of every case for texts ``PATH=VALUE``.
    report : Callable[[str], None]
        Is given a line while all are read.

    Raises
    ------
    InputErrors
        For a sample that cannot be read, FemstructError for numbers that a body, contact or link refuses, TypeError for
        a law with functions of its own.

    Notes
    -----
    The effect of a path on a number of a scene is read at each of its values up to 12 of them; else it is a straight
    line through those at its least and largest value, on which three others have to lie. A number is that of the first
    sample and the sum of all effects; five whole samples are read and compared. All to rounding. Where that cannot be,
    as of the speed after a height of fall, or of a spring that follows a mass and a frequency, each sample is read.
    """
    first = staged(samples.changes(0))
    start = {case: numbers_of_scene(scene) for case, (_, scene) in first.items()}
    columns = _foreseen_columns(samples, staged, first, start)
    if columns is None:
        columns = _read_columns(samples, staged, first, report)
    if columns is None:
        return None
    for case, (_, scene) in first.items():
        if columns[case]:
            variation(scene, columns[case])
    return SceneColumns({case: scene for case, (_, scene) in first.items()}, columns)


def _foreseen_columns(
    samples: Samples, staged: Staged, first: Mapping[str, tuple[Study, Scene]], start: Numbers
) -> Columns | None:
    """The numbers of scenes that differ, from a few samples; None where they cannot be foreseen."""
    n = len(samples.texts)
    columns: dict[str, dict[str, Floats]] = {case: {} for case in first}
    for j in range(len(samples.paths)):
        looked, spread = _looks([one[j] for one in samples.texts], samples.numbers[:, j])
        changed = [[*samples.changes(0)[:j], samples.changes(i)[j], *samples.changes(0)[j + 1 :]] for i in looked]
        effects = [one for texts in changed if (one := _alike(first, staged(texts))) is not None]
        if len(effects) < len(looked):
            return None
        for case, name, value in [(case, name, value) for case, own in start.items() for name, value in own.items()]:
            values = np.array([one[case][name] for one in effects])
            if (values == value).all():
                continue
            followed = spread(values)
            if followed is None:
                return None
            before = columns[case].get(name)
            columns[case][name] = followed if before is None else before + (followed - value)
    for i in np.unique(np.linspace(0, n - 1, LOOKS + 1).astype(int))[1:].tolist():
        whole = _alike(first, staged(samples.changes(i)))
        if whole is None or not _foreseen(whole, start, columns, i):
            return None
    return columns


def _read_columns(
    samples: Samples, staged: Staged, first: Mapping[str, tuple[Study, Scene]], report: Callable[[str], None]
) -> Columns | None:
    """The numbers of scenes that differ, from every sample; None where more than numbers differs."""
    n, read = len(samples.texts), []
    for i in range(n):
        if i % READ == 0:
            report(f"reading sample {i + 1} of {n}")
        one = _alike(first, staged(samples.changes(i)))
        if one is None:
            return None
        read.append(one)
    columns = {}
    for case, own in read[0].items():
        values = {name: np.array([one[case][name] for one in read]) for name in own}
        columns[case] = {name: one for name, one in values.items() if (one != one[0]).any()}
    return columns


def _looks(texts: Sequence[str], numbers: Floats) -> tuple[list[int], Callable[[Floats], Floats | None]]:
    """Samples at which the effect of a path is read, and what all samples have by what was read there; that is None
    where it is no straight line."""
    known, at = np.unique(np.array(texts, dtype=object).astype(str), return_inverse=True)
    if len(known) <= TABLED:
        return [texts.index(one) for one in known.tolist()], lambda values: values[at]
    order = np.argsort(numbers, kind="stable")
    looked = order[np.linspace(0, len(order) - 1, LOOKS).astype(int)]
    x = (numbers - numbers[looked[0]]) / (numbers[looked[-1]] - numbers[looked[0]])

    def line(values: Floats) -> Floats | None:
        found: Floats = values[0] + (values[-1] - values[0]) * x
        straight = np.abs(found[looked] - values).max() <= ROUNDING * np.abs(values).max()
        return found if straight else None

    return looked.tolist(), line


def _alike(
    first: Mapping[str, tuple[Study, Scene]], other: Mapping[str, tuple[Study, Scene]]
) -> dict[str, dict[str, float]] | None:
    """The numbers of other scenes by case and name; None where more than numbers differs."""
    if first.keys() != other.keys():
        return None
    found = {}
    for case, (study, scene) in other.items():
        numbers = numbers_of_scene(scene)
        base_study, base = first[case]
        if numbers.keys() != numbers_of_scene(base).keys() or _beside(study) != _beside(base_study):
            return None
        moved = variation(base, {name: [value] for name, value in numbers.items()})(0) if numbers else base
        if fingerprint(moved) != fingerprint(scene):
            return None
        found[case] = numbers
    return found


def _beside(study: Study) -> str:
    """A name for all of a study that is not in its scene."""
    return fingerprint([getattr(study, one.name) for one in fields(study) if one.name not in IN_SCENE])


def _foreseen(whole: Numbers, start: Numbers, columns: Columns, i: int) -> bool:
    """Whether the columns have the numbers of sample i."""
    for case, own in whole.items():
        for name, value in own.items():
            column = columns[case].get(name)
            expected, size = (start[case][name], 0.0) if column is None else (column[i], np.abs(column).max())
            if abs(expected - value) > ROUNDING * size:
                return False
    return True


# ----------------------------------------------------------------------------------------------------------------------
# Levels in rooms among the numbers of a batch: from what pushes the modes, without the motion between.
# ----------------------------------------------------------------------------------------------------------------------

MADE: Final = ("l_afmax_db", "l_asmax_db", "l_ae_db")  # of every receiver, in the order of `a_levels`
MAIN: Final = "L_AFmax"  # what the first is called among the main numbers


@dataclass(frozen=True, eq=False)
class RoomReceivers:
    """Who listens in the rooms of a case. names : of the numbers made [x], all in dB; told : what is known of rooms."""

    listener: Listener
    names: tuple[str, ...]
    findings: tuple[Advice | Finding, ...]


def level_names(study: Study) -> list[str]:
    """Names of the levels that a batch can have, `MADE` of each receiver of each rectangular room."""
    return [f"levels / {one} / {level}" for one in _receiver_names(study) for level in MADE]


def main_names(study: Study) -> dict[str, str]:
    """The same for those that are main numbers, too, by their names there."""
    return {f"{one} {MAIN}": f"levels / {one} / {MADE[0]}" for one in _receiver_names(study)}


def _receiver_names(study: Study) -> list[str]:
    rooms = [room for room in study.rooms if room.room.keeps_transfers]
    return [f"{room.name}.{receiver.name}" for room in rooms for receiver in room.receivers]


def receiver_rooms(study: Study, places: Places, basis: ModalBasis, scene: Scene, clock: Clock) -> RoomReceivers:
    """Listeners in all rooms of a study that keep their transfers, for what pushes the modes.

    Parameters
    ----------
    basis : ModalBasis
        Damped.
    scene : Scene
        Of the impact from which the rooms' transfers are found, to 1e-4 of the pressure.

    Raises
    ------
    InputError
        Where they cannot be had: for modes that damping couples and a structure that moves at the start.
    """
    if scene.velocity is not None:
        raise InputError("initial", got="a structure that moves at the start", expected="one at rest")
    response = simulate(basis, scene, clock)
    nt, dt = len(response.t), 1.0 / clock.sampling
    rooms = [room for room in study.rooms if room.room.keeps_transfers]
    findings: list[Advice | Finding] = [one for _, one in room_mode_findings(study, places, basis, basis)]
    kept, ends, silent = [], [], []
    for room in rooms:
        placed, end = placed_room(room, places.surfaces), room.heard_to_hz(basis.complete_below_hz)
        responses, one = room.room.pressures_to_keep(surface_velocities([response], placed), room.receivers, end)
        if one is None:
            raise InputError(f"rooms.{room.name}", got="a room without a transfer", expected="losses that have one")
        findings += responses[0].findings
        kept.append((one, moving_modes([response], placed)))
        ends.append(end)
        silent.append(is_at_rest(response, placed))
    findings += [room_silent()] * any(silent)
    made: dict[bytes, list[PushTransfer]] = {}

    def transfers(shares: Floats) -> list[PushTransfer]:
        """Of all rooms, once: threads that come first may make the same."""
        key = shares.tobytes()
        if key not in made:
            made[key] = [push_transfer(basis, shares, one, moving, nt, dt) for one, moving in kept]
        return made[key]

    def of(moments: Floats, shares: Floats) -> Floats:
        found = []
        for room, transfer, end, still in zip(rooms, transfers(shares), ends, silent, strict=True):
            pressures = transfer.pressures(moments) * (not still)
            found.append([_levels(room, response.t, p, end) for p in pressures])
        return np.concatenate(found, axis=1)

    names = level_names(study)
    return RoomReceivers(Listener(dt, nt, len(names), of), tuple(names), tuple(findings))


def _levels(room: RoomPlan, t: Floats, p: Floats, end_hz: float) -> list[float]:
    """Levels at all receivers of a room, one after the other."""
    response = truncate_response(RoomResponse(room.receivers, t, p), end_hz)
    return [level for one in response.p for level in a_levels(one, response.dt)]


# ----------------------------------------------------------------------------------------------------------------------
# What all samples of a batch share, and which numbers of theirs it makes: by the batch engine and from histories.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class BatchStage:
    """What all samples share, by case: solved structures, damped bases, scenes of the first sample, who listens, codes
    of what is known before an impact and of what of it forbids trust."""

    plan: Plan
    solved: Mapping[str, Solved]
    bases: Mapping[str, ModalBasis]
    scenes: Mapping[str, Scene]
    rooms: Mapping[str, RoomReceivers]
    codes: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]]

    def batch(self, case: Case, columns: Mapping[str, Floats], runs: int, threads: int) -> Batch:
        """So many runs of a case, which differ in columns; all the same where there are none."""
        scene, time = self.scenes[case.name], case.study.time
        assert time is not None
        if not columns:
            name, value = next(iter(numbers_of_scene(scene).items()))
            columns = {name: np.full(runs, value)}
        listener = self.rooms[case.name].listener if case.name in self.rooms else None
        return simulate_batch(self.bases[case.name], scene, clock_of(time), columns, threads, listener=listener)

    def history(self, case: Case, scene: Scene) -> CaseResult:
        """A run of a case whose scene this is, with its history."""
        own = self.solved[case.name]
        return run_impact(case, own.key, own.places, self.bases[case.name], scene)

    def offered(self, case: Case, batch: Batch) -> dict[str, tuple[Floats, str]]:
        """All numbers of the runs of a case, with their units, named as in a full row."""
        found = batch_numbers(batch, self.bases[case.name])
        for record in case.study.records:  # a full row has these in place of the peak forces
            if record.what == "force" and record.target in batch.peak_force:
                found[str(record)] = found.pop(f"{record.target} peak force")
        if case.name in self.rooms:
            levels = dict(zip(self.rooms[case.name].names, batch.at_receivers.T, strict=True))
            found |= {name: (one, "dB") for name, one in levels.items()}
            found |= {name: (levels[of], "dB") for name, of in main_names(case.study).items()}
        return found


def batch_numbers(batch: Batch, basis: ModalBasis) -> dict[str, tuple[Floats, str]]:
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


def stage_of(first: Task, only: tuple[str, ...]) -> BatchStage:
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


def _made(plan: Plan, only: Sequence[str]) -> BatchStage:
    solved = solve_all(plan.cases)
    baseline = next(case for case in plan.cases if case.name == plan.baseline)
    bases = {case.name: damp_basis(case, solved, baseline) for case in plan.cases}
    scenes = {case.name: staged(case.study, solved[case.name].places, bases[case.name]) for case in plan.cases}
    codes, rooms = {}, {}
    for case in plan.cases:
        study, own, basis = case.study, solved[case.name], bases[case.name]
        found: list[Finding | Advice] = [*findings_before_run(case, own, basis, None)]
        if study.time is not None and not {*level_names(study), *main_names(study)}.isdisjoint(only):
            rooms[case.name] = receiver_rooms(study, own.places, basis, scenes[case.name], clock_of(study.time))
            found += rooms[case.name].findings
        severe = dict.fromkeys(one.code for one in found if isinstance(one, Finding) and one.severe)
        codes[case.name] = tuple(dict.fromkeys(one.code for one in found)), tuple(severe)
    return BatchStage(plan, solved, bases, scenes, rooms, codes)


_STAGES: Final[dict[str, BatchStage]] = {}  # of this process, the latest


# ----------------------------------------------------------------------------------------------------------------------
# Rows of many samples at once: where they hold some numbers of impacts, and numbers of impacts alone vary.
# ----------------------------------------------------------------------------------------------------------------------

BY_BATCH: Final = (
    "by the batch engine: findings that take a history are not looked for, such as structure-not-decayed or "
    "contact-beyond-modes"
)
BY_HISTORY: Final = (
    "from impacts alone, on modes that are solved once: their numerical error is not estimated, and findings that need "
    "the sound of a sample are not looked for"
)
AT_ONCE: Final = 512  # samples of a task at most: what a kill costs
FEW_AT_ONCE: Final = 16  # of them with a history


@dataclass(frozen=True, eq=False)
class BatchTask:
    """Samples to run together.

    first : the task of the sample whose scenes are those of all but for columns, which are what differs between the
    samples in the scene of every case, by name. numbers : of the samples. only : what a row holds; histories : which of
    it take the history of a run. threads : of the batch engine. files : from which they were read.
    """

    first: Task
    numbers: tuple[int, ...]
    columns: Mapping[str, Mapping[str, Floats]]
    only: tuple[str, ...]
    histories: tuple[str, ...]
    threads: int
    files: tuple[str, ...]

    def left(self, known: set[int]) -> BatchTask | None:
        """The task, None where the rows of all its samples are known: they are kept together or not at all."""
        return None if known.issuperset(self.numbers) else self

    def first_of(self, count: int) -> BatchTask:
        """The first samples alone."""
        return _part(self, 0, count)

    def rows(self) -> Iterator[list[Row]]:
        """The rows of all samples at once."""
        stage = stage_of(self.first, self.only)
        found: dict[int, dict[str, Row]] = {number: {} for number in self.numbers}
        metrics = tuple(name for name in self.only if name not in self.histories)
        for case in stage.plan.cases:
            columns, made = self.columns[case.name], []
            if metrics:
                batch = stage.batch(case, columns, len(self.numbers), self.threads)
                made.append(_of_batch(case, self.numbers, batch, stage, metrics))
            if self.histories:
                made.append(_of_histories(case, self.numbers, columns, stage, self.histories))
            for parts in zip(*made, strict=True):
                row = _joined(parts, stage.codes[case.name], self.only)
                found[row.sample][row.case] = row
        files = contents(self.files)
        yield [replace(row, files=files) for own in found.values() for row in _of_sample(own)]


def batch_tasks(
    campaign: Campaign, samples: Samples, threads: int, report: Callable[[str], None] = lambda line: None
) -> Split | str:
    """All samples as tasks of the batch engine; why it takes full runs where it does.

    It takes them where a row is to hold every number, or one that needs a history; where anything but numbers of
    bodies, contacts, links and loads varies (`scene_columns`).

    Parameters
    ----------
    report : Callable[[str], None]
        Is given a line while all samples are read.
    """
    if not campaign.only:
        return "a row holds all numbers; name those that you need under 'samples: {only: [..]}' or by --only"
    first = Task(campaign.file, campaign.overrides, campaign.case, ((0, samples.changes(0)),))
    try:
        plan = read_sample(first, samples.changes(0))
        if more := next((f"case '{case.name}' {what}" for case in plan.cases if (what := _beyond(case))), ""):
            return more
        structures = {case.name: key_of(case.study) for case in plan.cases}
        places = {case.name: meshed(case.study.structure, case.studies).places for case in plan.cases}
        files = dict.fromkeys(plan.sources)

        def scenes(texts: Sequence[str]) -> dict[str, tuple[Study, Scene]]:
            read = read_sample(first, texts)
            files.update(dict.fromkeys(read.sources))
            cases = read.cases
            same = {case.name: key_of(case.study) for case in cases} == structures
            return {one.name: (one.study, staged(one.study, places[one.name])) for one in cases} if same else {}

        histories = _by_history(stage_of(first, campaign.only), campaign.only)
        if isinstance(histories, str):  # before all samples are read, which takes long
            return histories
        found = scene_columns(samples, scenes, report)
        if found is None or not all(map(numbers_of_scene, found.scenes.values())):
            return "more varies than numbers of bodies, contacts, links and loads"
    except (FemstructError, TypeError) as error:  # full runs say it of each sample
        return f"the batch engine does not take this study: {error}"
    n = len(samples.texts)
    size = FEW_AT_ONCE if histories else AT_ONCE
    whole = BatchTask(
        first, tuple(range(n)), found.columns, campaign.only, histories, 1 if histories else threads, (*files,)
    )
    return Split(
        tuple(_part(whole, start, start + size) for start in range(0, n, size)),
        plan,
        {},
        len(set(structures.values())),
        n * len(plan.cases),
        made=BY_HISTORY if histories else BY_BATCH,
        threaded=not histories,
    )


def _part(task: BatchTask, start: int, end: int) -> BatchTask:
    """Some samples of a task."""
    columns = {case: {name: one[start:end] for name, one in own.items()} for case, own in task.columns.items()}
    return replace(task, numbers=task.numbers[start:end], columns=columns)


def _by_history(stage: BatchStage, only: Sequence[str]) -> tuple[str, ...] | str:
    """The names for which a run's history is needed, with those of them that the batch engine has as well: none where
    it has all. Why it takes full runs where neither has a name in any case."""
    cases = stage.plan.cases
    metrics = {name for case in cases for name in stage.offered(case, stage.batch(case, {}, 1, 1))}
    if metrics.issuperset(only):
        return ()
    known = {name for case in cases for name in numbers_of(stage.history(case, stage.scenes[case.name]))}
    missing = next((name for name in only if name not in known | metrics), None)
    if missing is not None:
        return f"'{missing}' is a number of full runs"
    return tuple(name for name in only if name in known)


def _beyond(case: Case) -> str:
    """What a case has beyond one impact on modes that are solved once, "" for nothing."""
    study = case.study
    if study.time is None:
        return "has no 'time:', and so no impact"
    if case.drops:
        return f"has blows at {len(case.drops)} places, and each is an impact of its own"
    if study.accuracy is not None:
        return "has 'accuracy:', for which modes are added until it holds"
    two_way = next((room.name for room in study.rooms if room.coupling == "two-way"), "")
    return two_way and f"has room '{two_way}' with 'coupling: two-way', so that its air changes the modes"


def _of_batch(
    case: Case, numbers: Sequence[int], batch: Batch, stage: BatchStage, only: Sequence[str]
) -> Iterator[Row]:
    """What the batch engine has of every run of a case."""
    own = stage.offered(case, batch)
    columns = [(name, own[name][0].tolist(), own[name][1]) for name in only if name in own]
    flags = {code: flag.tolist() for code, flag in batch.flags.items() if flag.any()}
    forbids = {code: flags[code] for code, forbid in DOUBTS.items() if forbid and code in flags}
    forbids["energy-drift"] = drifts(batch.residual, NOT_TRUSTED).tolist()
    for i, number in enumerate(numbers):
        if trouble := batch.trouble(i):
            yield Row(number, case.name, {}, trouble=trouble)
            continue
        codes = tuple(code for code, flag in flags.items() if flag[i])
        severe = tuple(code for code, flag in forbids.items() if flag[i])
        found = {name: Number(column[i], unit) for name, column, unit in columns}
        yield Row(number, case.name, _with_limits(found, case), codes, severe)


def _with_limits(numbers: dict[str, Number], case: Case) -> dict[str, Number]:
    """Numbers of the batch engine, which are exact, with the limits that the case has of them and the verdicts."""
    for limit in case.study.limits:
        if one := numbers.get(limit.name):
            met = one.value <= limit.value if isfinite(one.value) else None
            numbers |= numbers_of_limit(limit.name, limit.value, one.unit, one.value, met)
    return numbers


def _of_histories(
    case: Case, numbers: Sequence[int], columns: Mapping[str, Floats], stage: BatchStage, only: Sequence[str]
) -> Iterator[Row]:
    """What the histories have of every run of a case."""
    scene = stage.scenes[case.name]
    varied: Callable[[int], Scene] = variation(scene, columns) if columns else lambda i: scene
    for i, number in enumerate(numbers):
        try:
            run = stage.history(case, varied(i))
        except FemstructError as error:
            yield Row(number, case.name, {}, trouble=with_position(stage.plan, error))
            continue
        codes = tuple(one.code for one in run.findings)
        severe = tuple(one.code for one in run.findings if one.severe)
        yield Row(number, case.name, choose_numbers(numbers_of(run), only), codes, severe)


def _joined(parts: Sequence[Row], known: tuple[tuple[str, ...], tuple[str, ...]], only: Sequence[str]) -> Row:
    """One row of several of a sample in a case.

    Parameters
    ----------
    known : tuple[tuple[str, ...], tuple[str, ...]]
        Codes of findings that all samples have, and of severe ones.
    """
    failed = next((part for part in parts if part.trouble), None)
    if failed is not None:
        return failed
    values = {name: one for part in parts for name, one in part.numbers.items()}
    return Row(
        parts[0].sample,
        parts[0].case,
        choose_numbers(values, only),
        tuple(dict.fromkeys([*known[0], *(code for part in parts for code in part.findings)])),
        tuple(dict.fromkeys([*known[1], *(code for part in parts for code in part.severe)])),
    )


def _of_sample(rows: Mapping[str, Row]) -> list[Row]:
    """The rows of a sample by case; the one that failed, if there is one."""
    failed = next((row for row in rows.values() if row.trouble), None)
    return list(rows.values()) if failed is None else [replace(failed, case="")]
