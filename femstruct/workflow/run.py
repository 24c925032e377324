"""A study, run: modes, frequency responses, impacts, rooms and levels of every case."""

from __future__ import annotations

import json
import re
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.compiled.store import compilation
from femstruct.declared import expect
from femstruct.errors import Finding, list_some
from femstruct.files.audio import listening_scale, write_sequence, write_wav
from femstruct.files.mode_files import write_room_modes
from femstruct.files.results_file import RESULTS, read_results, write_results
from femstruct.files.study_tables import summary
from femstruct.files.writing import NAME, Stage, file_name, replacing, same_file, short, staged_folder
from femstruct.findings.catalogue import rank_findings
from femstruct.modal.basis import ModalBasis
from femstruct.study.results import AccuracyCheck, CaseResult, StudyResult
from femstruct.study.study import Case, Plan, Study
from femstruct.view.page import write_report
from femstruct.workflow.accuracy import hold_accuracy
from femstruct.workflow.bases import Solved, add_cavities, changes_damping, fingerprint, key_of, solve_all
from femstruct.workflow.case import expected_units, run_case
from femstruct.workflow.case_comparison import Spectra, compare, machines, verdicts
from femstruct.workflow.coupled_air import RoomTransfers, couple_rooms
from femstruct.workflow.provenance import Progress, Stopwatch, inputs_of, provenance
from femstruct.workflow.recorded_channels import change_findings

# ----------------------------------------------------------------------------------------------------------------------
# What a run leaves behind: one results file, tables, sound, and pictures.
# ----------------------------------------------------------------------------------------------------------------------

NO_PICTURES: Final = "Pictures left out, because of --no-pictures; 'femstruct report RESULTS' draws them."
NAMED: Final = 4  # files of those that are removed


def write_all(
    result: StudyResult,
    folder: Path,
    progress: Progress = lambda line: None,
    pictures: bool = True,
    keep: Progress | None = None,
) -> tuple[dict[str, float], str]:
    """Write results.h5, summary.json, a WAV for every receiver and case, one to listen to with all cases in turn, all
    pictures, and report.html with tables, pictures and what to listen to.

    All files take their places together when the last is complete, so that a folder holds those of one run; those of an
    earlier run that this one does not make are then removed, and nothing else (files.belongings). All sounds of a study
    have one full scale, so that cases can be compared by ear.

    Parameters
    ----------
    pictures : bool
        False for numbers, tables, sound alone.
    keep : Progress | None
        A run of other inputs that is in the folder is kept beside it with a number, and keep is told where; None
        replaces it.

    Returns
    -------
    tuple[dict[str, float], str]
        CPU seconds by stage, and sentences, a line each, about pictures that were left out and files that were removed,
        or kept though they are older ("" for none).
    """
    folder.mkdir(parents=True, exist_ok=True)
    clock = Stopwatch(progress)
    with _folder_of(result, folder, keep) as stage:
        left_out = _write(result, stage.path, clock, pictures, lambda path: write_results(path, result))
    return clock.seconds, "\n".join(
        filter(None, (left_out, _cleared([] if stage.aside else stage.removed), _older(stage.older)))
    )


def redraw(
    source: Path,
    folder: Path,
    progress: Progress = lambda line: None,
    pictures: bool = True,
    keep: Progress | None = None,
) -> tuple[StudyResult, str]:
    """Write all that `write_all` does from a results file, which stays as it is or is copied to another folder.

    Nothing is solved. Returns what the file says, and sentences as `write_all` does.
    """
    result = read_results(source)
    folder.mkdir(parents=True, exist_ok=True)
    own = source.parent.resolve() == folder.resolve()
    with _folder_of(result, folder, None if own else keep) as stage:
        left_out = _write(result, stage.path, Stopwatch(progress), pictures, lambda path: same_file(source, path))
    return result, "\n".join(
        filter(None, (left_out, _cleared([] if stage.aside else stage.removed), _older(stage.older)))
    )


@contextmanager
def _folder_of(result: StudyResult, folder: Path, keep: Progress | None) -> Iterator[Stage]:
    """The stage of a folder for the files of a run; says where an earlier one of other inputs is kept."""
    finished = len(result.cases) == len(result.plan.cases)
    with staged_folder(folder, finished=finished, inputs=inputs_of(result.plan), keep=keep is not None) as stage:
        yield stage
    for place in stage.aside:
        if keep is not None:
            keep(f"The run of other inputs that was in {folder} is now in {place}")


def _stage_sentences(stage: Stage, left_out: str = "") -> str:
    """Sentences about what a run left out, removed, or kept that is older; what is kept elsewhere is told by itself."""
    return "\n".join(filter(None, (left_out, "" if stage.aside else _cleared(stage.removed), _older(stage.older))))


def _older(kept: Sequence[str]) -> str:
    """What is said of files of an earlier run beside those of one with cases missing.

    >>> _older(["a.wav"])
    'Some cases are missing. These files are of an earlier run: a.wav (written_by_femstruct.json lists them)'
    """
    names = list_some(kept, NAMED)
    return f"Some cases are missing. These files are of an earlier run: {names} ({NAME} lists them)" if kept else ""


def _cleared(removed: Sequence[str]) -> str:
    """What is said of files that are no longer there.

    >>> _cleared(["a.wav", "b.wav"]), _cleared([])
    ('Removed files of an earlier run: a.wav, b.wav', '')
    """
    names = list_some(removed, NAMED)
    return f"Removed files of an earlier run: {names}" if removed else ""


def write_numbers(
    result: StudyResult, folder: Path, progress: Progress = lambda line: None, keep: Progress | None = None
) -> str:
    """Write summary.json, the sounds, and report.html without pictures: what a person changes a number for.

    Files take their places as those of `write_all` do.

    Parameters
    ----------
    keep : Progress | None
        Likewise.

    Returns
    -------
    str
        Sentences about what was removed or is older.
    """
    folder.mkdir(parents=True, exist_ok=True)
    clock = Stopwatch(progress)
    with _folder_of(result, folder, keep) as stage:
        _write_summary(result, stage.path)
        with clock("sound"):
            sounds = _write_sounds(result, stage.path)
        sound_files = {name: (stage.path / name).read_bytes() for name in sounds}
        write_report(result, stage.path / "report.html", sounds=sound_files)
    return _stage_sentences(stage)


def _write_summary(result: StudyResult, folder: Path) -> None:
    with replacing(folder / "summary.json") as path:
        path.write_text(json.dumps(summary(result), indent=1, allow_nan=False) + "\n", encoding="utf-8")


def _write(
    result: StudyResult, folder: Path, clock: Stopwatch, pictures: bool, results_file: Callable[[Path], None]
) -> str:
    """All files in their order; a sentence about pictures that were left out.

    Parameters
    ----------
    results_file : Callable[[Path], None]
        Makes results.h5.
    """
    with clock("sound"):
        sounds = _write_sounds(result, folder)
    with clock("results file"):
        results_file(folder / RESULTS)
        _write_summary(result, folder)
        for plan in result.cases[result.plan.baseline].case.study.rooms:
            write_room_modes(plan, (folder / file_name("room_modes", plan.name)).with_suffix(".vtu"))
    shown, left_out = _drawn(result, folder, clock) if pictures else ([], NO_PICTURES)
    with clock("report"):
        inside = [{name: (folder / name).read_bytes() for name in names} for names in (shown, sounds)]
        write_report(result, folder / "report.html", *inside)
    return left_out


def _drawn(result: StudyResult, folder: Path, clock: Stopwatch) -> tuple[list[str], str]:
    """Draw all pictures, those in three dimensions in a process beside this one: their names in the order of the page,
    and a sentence about those that were left out."""
    from femstruct.view.model_scene import NoOpenGL, draw_in_process, model_picture, shapes_all
    from femstruct.view.plots import plot_all
    from femstruct.view.room_scene import room_pictures, stress_pictures

    with clock("pictures"):
        scenes = (shapes_all, room_pictures, model_picture, stress_pictures)
        solid = draw_in_process(lambda: [draw(result, folder) for draw in scenes])
        flat = plot_all(result, folder)
    with clock("pictures in three dimensions"):
        try:
            (shapes, left_out), (moving, _), (model, _), (stressed, _) = solid()
        except NoOpenGL as error:
            shapes, moving, model, stressed, left_out = [], [], [], [], str(error)
    model = model or _outline(result, folder)
    first = sorted(flat, key=lambda path: not path.name.startswith(("rated", "level", "own_sound")))
    return [path.name for path in (*model, *first, *stressed, *moving, *shapes)], left_out


def _outline(result: StudyResult, folder: Path) -> list[Path]:
    """The model in lines, where it cannot be drawn in three dimensions."""
    from femstruct.view.drawing import save
    from femstruct.view.model_scene import baseline_model, outline

    model = baseline_model(result)
    rooms = result.cases[result.plan.baseline].case.study.rooms
    return [] if model is None else [save(outline(model, rooms), folder / file_name("model"))]


class _PressureHistory(NamedTuple):
    """A pressure history at ROOM.RECEIVER in a case: of what the structure radiates, or with the bodies themselves."""

    case: str
    total: bool
    receiver: str
    p: Floats
    sampling: float


def _write_sounds(result: StudyResult, folder: Path) -> list[str]:
    """A WAV for every receiver and case, and for every receiver one of all cases in turn, for listening: their names.

    Where striking bodies are heard themselves there are two of a case: of what the structure radiates, as elsewhere,
    and CASE.ROOM.RECEIVER.total.wav, which follows it in the sequence. All are at one scale, the sequence a decibel
    below it. Cases of another sampling than the baseline's cannot follow it in one file: they are not in the sequence.
    """
    responses = [
        _PressureHistory(case, total, f"{room}.{receiver.name}", p, item.case.study.time.sampling)
        for case, item in result.cases.items()
        if item.case.study.time is not None
        for room, borne in item.rooms.items()
        for i, receiver in enumerate(borne.receivers)
        for total, of in ((False, item.rooms), (True, item.heard.total))
        if room in of
        for p in (of[room].p[i],)
    ]
    loudest = max((float(np.abs(one.p).max()) for one in responses), default=0.0)
    if not loudest > 0.0:
        return []
    for one in responses:
        name = _sound_name(one.case, one.receiver, *(["total"] if one.total else []))
        write_wav(folder / name, one.p, one.sampling, full_scale=loudest)
    baseline = result.cases[result.plan.baseline].case.study.time
    names = []
    for receiver in dict.fromkeys(one.receiver for one in responses):
        sounds = {
            f"{one.case}{', total' if one.total else ''}": one.p
            for one in responses
            if one.receiver == receiver and baseline is not None and one.sampling == baseline.sampling
        }
        if sounds and baseline is not None:
            names.append(_sound_name("listen", receiver))
            scale = listening_scale(loudest)
            write_sequence(folder / names[-1], sounds, baseline.sampling, full_scale=scale, form="pcm24")
    return names


def _sound_name(*words: str) -> str:
    """A name for a sound, with the spaces of its words; what some system does not take in a name is a line.

    >>> _sound_name("damper 0.6 / new", "box.mic")
    'damper 0.6 _ new.box.mic.wav'
    """
    return short(re.sub(r'[/\\:*?"<>|]', "_", ".".join(words))) + ".wav"


@dataclass(frozen=True, eq=False)
class KeptStages:
    """What a run leaves for the next one: its bases, its cases by what each was made from, transfers of rooms and
    spectra of channels (see `run_again`).

    reused : what it took from the one before itself, in words; "nothing" where all was new.
    """

    solved: tuple[Solved, ...] = ()
    cases: Mapping[str, CaseResult] = field(default_factory=dict)
    rooms: RoomTransfers = field(default_factory=RoomTransfers)
    spectra: Spectra = field(default_factory=Spectra)
    reused: str = "nothing"


# ----------------------------------------------------------------------------------------------------------------------
# A study, run: modes, responses, impacts, rooms and levels of every case.
# ----------------------------------------------------------------------------------------------------------------------


def run_study(plan: Plan, progress: Progress = lambda line: None, command: str = "") -> StudyResult:
    """All stages of all cases of a study, and their comparison.

    Raises what the stages raise: InputError for names and numbers that do not fit the meshed model, NotConverged for
    a result that cannot be had.

    Parameters
    ----------
    progress : Progress
        Is told the name of every stage as it starts.
    command : str
        The command line to be kept with the results.

    Returns
    -------
    StudyResult
        A StudyResult; bases are solved once for every distinct model.

    Notes
    -----
    A KeyboardInterrupt once the baseline is finished ends the run with the cases finished so far and a severe
    finding.

    Examples
    --------
    A ball of 1 kg hits a mass of 1 kg on a soft spring and hands over its speed of 1 m/s:

    >>> import tempfile
    >>> from pathlib import Path
    >>> from femstruct.language.cases import read_study
    >>> model = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\\npoints: {m: {}}"
    >>> study = '''
    ... model: model.yaml
    ... bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
    ... record: {m.z: velocity}
    ... time: {duration: 10 ms, sampling: 10 kHz}
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "model.yaml").write_text(model, encoding="utf-8")
    ...     _ = Path(folder, "hit.study.yaml").write_text(study, encoding="utf-8")
    ...     result = run_study(read_study(Path(folder, "hit.study.yaml")))
    >>> case = result.cases["as given"]
    >>> round(case.channels["m.z velocity"].whole, 3), case.response.contacts["ball on m"].closings
    (1.0, 1)
    """
    of_study = 'Plan(title, (Case("as given", study),), baseline="as given") is one of a Study'
    expect("run_study", plan, Plan, f"{of_study}, read_study(PATH) that of a file")
    return run_again(plan, KeptStages(), progress, command)[0]


def run_again(
    plan: Plan, before: KeptStages, progress: Progress = lambda line: None, command: str = ""
) -> tuple[StudyResult, KeptStages]:
    """A study as `run_study` runs it, with what an earlier run of it, or of another study, has left.

    Parameters
    ----------
    before : KeptStages
        Of the last run, `KeptStages()` for none. A basis is taken from it where structure, number of modes and the
        places that are pushed are the same; a case where nothing differs that it depends on, the baseline's structure
        and damping among them. Cases of a study that asks for an accuracy are run anew.

    Returns
    -------
    tuple[StudyResult, KeptStages]
        The result and what it leaves for the next run. The result is that of `run_study`, exactly but in rooms, where
        another choice of cosines leaves out at most 1e-4 of the pressure.

    Examples
    --------
    One number of a study changes; its basis does not:

    >>> import tempfile
    >>> from pathlib import Path
    >>> from femstruct.language.cases import read_study
    >>> ball = "{mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     model = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\\npoints: {m: {}}"
    ...     _ = Path(folder, "model.yaml").write_text(model, encoding="utf-8")
    ...     study = f"model: model.yaml\\nbodies: {{ball: {ball}}}\\nrecord: {{m.z: velocity}}\\n"
    ...     path = Path(folder, "hit.study.yaml")
    ...     _ = path.write_text(study + "time: {duration: 10 ms, sampling: 10 kHz}", encoding="utf-8")
    ...     first, kept = run_again(read_study(path), KeptStages())
    ...     second, later = run_again(read_study(path, ("bodies.ball.mass=2 kg",)), kept)
    >>> later.reused, later.solved[0] is kept.solved[0]
    ('the modes', True)
    >>> [round(one.cases["as given"].channels["m.z velocity"].whole, 3) for one in (first, second)]
    [1.0, 1.333]
    """
    clock = Stopwatch(progress)
    solved, checks = _solved(plan, before.solved, clock)
    baseline = next(case for case in plan.cases if case.name == plan.baseline)
    order = sorted(plan.cases, key=lambda case: case.name != plan.baseline)
    made_from = {case.name: _made_from(case, baseline, solved[case.name]) for case in order if not checks}
    known = {name: before.cases[key] for name, key in made_from.items() if key in before.cases}
    results = _results(order, known, solved, checks, clock, before.rooms)
    left = len(order) - len(results)
    with clock("comparison"):
        finished = {case.name: results[case.name] for case in plan.cases if case.name in results}
        comparison = compare(plan.baseline, finished, before.spectra)
        reference = finished[plan.baseline].channels
        finished = {
            name: replace(one, findings=rank_findings((*one.findings, *change_findings(reference, one.channels))))
            for name, one in finished.items()
        }
        kept = {name: verdicts(result) for name, result in finished.items()}
        machine = machines(plan.baseline, finished, solved)
    bases = tuple({id(one): one for one in solved.values()}.values())
    left_behind = KeptStages(
        solved=bases,
        cases={made_from[name]: results[name] for name in finished if name in made_from},
        rooms=before.rooms,
        spectra=before.spectra,
        reused=_reused(any(one in before.solved for one in bases), tuple(known)),
    )
    result = StudyResult(
        plan=plan,
        bases=_bases(finished, solved),
        models={result.basis_key: solved[name].model for name, result in finished.items()},
        cases=finished,
        comparison=comparison,
        findings=(_interrupted(left, len(order)),) if left else (),
        timings=clock.seconds,
        provenance=provenance(command),
        verdicts=kept,
        machine=machine,
    )
    return result, left_behind


def run_cases(plan: Plan, before: Sequence[Solved] = ()) -> tuple[dict[str, CaseResult], tuple[Solved, ...]]:
    """The cases of a study as `run_study` has them, without their comparison, for who runs many studies.

    Raises as `run_study` does.

    Parameters
    ----------
    before : Sequence[Solved]
        Bases of other studies, taken where they are of the same structure, as many modes and the same places.

    Returns
    -------
    tuple[dict[str, CaseResult], tuple[Solved, ...]]
        The cases by name, and their bases.
    """
    clock = Stopwatch(lambda line: None)
    solved, checks = _solved(plan, before, clock)
    order = sorted(plan.cases, key=lambda case: case.name != plan.baseline)
    rooms = RoomTransfers()
    found = {
        case.name: run_case(case, solved, order[0], clock, checks.get(case.name), transfers=rooms) for case in order
    }
    bases = tuple({id(one): one for one in solved.values()}.values())
    return {case.name: found[case.name] for case in plan.cases}, bases


def _solved(
    plan: Plan, before: Sequence[Solved], clock: Stopwatch
) -> tuple[dict[str, Solved], dict[str, AccuracyCheck]]:
    """The bases of all cases, with as many modes as the accuracy takes that they ask for; kernels are ready then."""
    with compilation(expected_units(plan.cases)) as kernels:
        with clock("modes"):
            solved = solve_all(plan.cases, before)
        if kernels.units:
            with clock("kernels"):
                kernels.wait(clock.tell)
    if all(case.study.accuracy is None for case in plan.cases):
        return solved, {}
    baseline = next(case for case in plan.cases if case.name == plan.baseline)
    with clock("accuracy"):
        return hold_accuracy(plan.cases, baseline, solved)


def _results(
    order: Sequence[Case],
    known: Mapping[str, CaseResult],
    solved: Mapping[str, Solved],
    checks: Mapping[str, AccuracyCheck],
    clock: Stopwatch,
    rooms: RoomTransfers,
) -> dict[str, CaseResult]:
    """The cases by name, the baseline first; those that are known are taken. After Ctrl-C those finished so far, if the
    baseline is among them."""
    results: dict[str, CaseResult] = {}
    begun = time.monotonic()
    for number, case in enumerate(order, 1):
        clock.at(number, len(order), begun)
        if case.name in known:
            results[case.name] = replace(known[case.name], case=case)
            continue
        try:
            results[case.name] = run_case(case, solved, order[0], clock, checks.get(case.name), transfers=rooms)
        except KeyboardInterrupt:
            if not results:
                raise
            break
    clock.at(1, 1, begun)
    return results


def _interrupted(left: int, cases: int) -> Finding:
    """What is said of a run that was ended before all of its cases were run."""
    return Finding("interrupted", f"Interrupted: {left} of {cases} cases were not run", {"left": left}, severe=True)


def _made_from(case: Case, baseline: Case, own: Solved) -> str:
    """A name for all that the result of a case hangs on."""
    damping = (baseline.study.damping, key_of(baseline.study), changes_damping(case))
    return fingerprint((case.study, case.drops, damping, sorted(own.pushed)))


def _reused(modes: bool, cases: Sequence[str]) -> str:
    """What a run took from the one before it, in words.

    >>> _reused(True, ["as given", "soft"]), _reused(False, [])
    ("the modes, cases 'as given', 'soft'", 'nothing')
    """
    words = ["the modes"] if modes else []
    words += [f"case{'s' if len(cases) > 1 else ''} {list_some(map(repr, cases))}"] if cases else []
    return ", ".join(words) or "nothing"


def without_rooms(plan: Plan) -> Plan:
    """The same plan, impacts only: nobody listens, but air that reacts on the structure still does."""

    def deaf(study: Study) -> Study:
        rooms = tuple(replace(room, receivers=()) for room in study.rooms if room.coupling == "two-way")
        frf = tuple(one for one in study.frf if not one.of_room)
        return replace(study, rooms=rooms, frf=frf, limits=tuple(limit for limit in study.limits if not limit.room))

    return replace(
        plan,
        cases=tuple(
            replace(case, study=deaf(case.study), drops={place: deaf(one) for place, one in case.drops.items()})
            for case in plan.cases
        ),
    )


def _bases(finished: Mapping[str, CaseResult], solved: Mapping[str, Solved]) -> dict[str, ModalBasis]:
    """The undamped bases of the cases by key, with the air that reacts on the structure."""
    bases: dict[str, ModalBasis] = {}
    for name, result in finished.items():
        key, own = result.basis_key, solved[name]
        if key in bases:
            continue
        joined, _ = couple_rooms(add_cavities(own.basis, own), result.case.study.rooms, own.places)
        bases[key] = replace(joined, findings=own.basis.findings)
    return bases
