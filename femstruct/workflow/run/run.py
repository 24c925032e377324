"""A study, run: modes, frequency responses, impacts, rooms and levels of every case."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from femstruct.declared import expect
from femstruct.errors import Finding, some_of
from femstruct.findings.catalogue import ranked
from femstruct.impact.compiled.workers import compilation
from femstruct.modal.basis import ModalBasis
from femstruct.study.result import AccuracyCheck, CaseResult, StudyResult
from femstruct.study.study import Case, Plan, Study
from femstruct.workflow.compare.at_modes import Spectra
from femstruct.workflow.compare.compare import compare
from femstruct.workflow.compare.machines import machines
from femstruct.workflow.compare.verdicts import verdicts
from femstruct.workflow.progress import Progress
from femstruct.workflow.run.accuracy import hold_accuracy
from femstruct.workflow.run.case import run_case
from femstruct.workflow.run.needed_kernels import expected_units
from femstruct.workflow.run.provenance import Stopwatch, provenance
from femstruct.workflow.stages.coupled_air import coupled
from femstruct.workflow.stages.fingerprint import fingerprint
from femstruct.workflow.stages.modal_bases import Solved, changes_damping, in_air, key_of, solve_all
from femstruct.workflow.stages.recorded.peaks import change_findings
from femstruct.workflow.stages.room_transfers import RoomTransfers


@dataclass(frozen=True, eq=False)
class Kept:
    """What a run leaves for the next one: its bases, its cases by what each was made from, transfers of rooms and
    spectra of channels (see `run_again`).

    reused : what it took from the one before itself, in words; "nothing" where all was new.
    """

    solved: tuple[Solved, ...] = ()
    cases: Mapping[str, CaseResult] = field(default_factory=dict)
    rooms: RoomTransfers = field(default_factory=RoomTransfers)
    spectra: Spectra = field(default_factory=Spectra)
    reused: str = "nothing"


def run_study(plan: Plan, progress: Progress = lambda line: None, command: str = "") -> StudyResult:
    """All stages of all cases of a study, and their comparison.

    progress : is told the name of every stage as it starts.
    command : the command line to be kept with the results.

    Returns a StudyResult; bases are solved once for every distinct model.

    Raises what the stages raise: InputError for names and numbers that do not fit the meshed model, NotConverged for
    a result that cannot be had.

    Notes
    -----
    A KeyboardInterrupt once the baseline is finished ends the run with the cases finished so far and a severe
    finding.

    A ball of 1 kg hits a mass of 1 kg on a soft spring and hands over its speed of 1 m/s:

    >>> import tempfile
    >>> from pathlib import Path
    >>> from femstruct.language import read_study
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
    return run_again(plan, Kept(), progress, command)[0]


def run_again(
    plan: Plan, before: Kept, progress: Progress = lambda line: None, command: str = ""
) -> tuple[StudyResult, Kept]:
    """A study as `run_study` runs it, with what an earlier run of it, or of another study, has left.

    before : of the last run, `Kept()` for none. A basis is taken from it where structure, number of modes and the
    places that are pushed are the same; a case where nothing differs that it depends on, the baseline's structure and
    damping among them. Cases of a study that asks for an accuracy are run anew.

    Returns the result and what it leaves for the next run. The result is that of `run_study`, exactly but in
    rooms, where another choice of cosines leaves out at most 1e-4 of the pressure.

    One number of a study changes; its basis does not:

    >>> import tempfile
    >>> from pathlib import Path
    >>> from femstruct.language import read_study
    >>> ball = "{mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     model = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\\npoints: {m: {}}"
    ...     _ = Path(folder, "model.yaml").write_text(model, encoding="utf-8")
    ...     study = f"model: model.yaml\\nbodies: {{ball: {ball}}}\\nrecord: {{m.z: velocity}}\\n"
    ...     path = Path(folder, "hit.study.yaml")
    ...     _ = path.write_text(study + "time: {duration: 10 ms, sampling: 10 kHz}", encoding="utf-8")
    ...     first, kept = run_again(read_study(path), Kept())
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
            name: replace(one, findings=ranked((*one.findings, *change_findings(reference, one.channels))))
            for name, one in finished.items()
        }
        kept = {name: verdicts(result) for name, result in finished.items()}
        machine = machines(plan.baseline, finished, solved)
    bases = tuple({id(one): one for one in solved.values()}.values())
    left_behind = Kept(
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

    before : bases of other studies, taken where they are of the same structure, as many modes and the same places.

    Returns the cases by name, and their bases. Raises as `run_study` does.
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
    words += [f"case{'s' if len(cases) > 1 else ''} {some_of(map(repr, cases))}"] if cases else []
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
        joined, _ = coupled(in_air(own.basis, own), result.case.study.rooms, own.places)
        bases[key] = replace(joined, findings=own.basis.findings)
    return bases
