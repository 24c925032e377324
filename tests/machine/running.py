"""Checks of drawn cases: one, shrunk where it fails, and many in several processes within a time."""

from __future__ import annotations

import copy
import itertools
import math
import re
import signal
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Literal

import numpy as np
from scipy.stats import beta

from tests.machine.framework import Capability, Case, Crashed, Door, Model, Refused, as_yaml, capabilities

Verdict = Literal["right", "fault", "crashed", "slow", "told", "refused", "generator"]
FAULTS = ("fault", "crashed", "slow")
_TRIES = 60  # of the shrinker a failing model


@dataclass(frozen=True)
class Checked:
    """What one check found. off : distance over tolerance; model : text of the failing model, shrunk; lines : of the
    program that it executed, by file, where that is asked for."""

    capability: str
    index: int
    verdict: Verdict
    off: float = 0.0
    got: tuple[float, ...] = ()
    right: tuple[float, ...] = ()
    words: str = ""
    model: str = ""
    seconds: float = 0.0
    lines: Mapping[str, Sequence[int]] = field(default_factory=dict)


class _Late(BaseException):
    """Not an Exception: a program that tells its own faults must not take it for one."""


@contextmanager
def _limited(seconds: float) -> Iterator[list[bool]]:
    late: list[bool] = []

    def ring(*_: object) -> None:
        late.append(True)
        raise _Late

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield late
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def judge(name: str, index: int, case: Case, refuses: bool = False, limit: float = 30.0) -> Checked:
    """One case: asked, compared, within a time."""
    found, door = Checked(name, index, "right"), Door()
    try:
        with _limited(limit) as late:
            try:
                right = np.atleast_1d(np.asarray(case.right(case.model, door), dtype=float)).ravel()
                got = np.atleast_1d(np.asarray(case.asked(case.model, door), dtype=float)).ravel()
            except Refused as told:
                return replace(found, verdict="right" if refuses else "refused", words=str(told))
            except Crashed as told:
                return replace(found, verdict="slow" if late else "crashed", words=str(told))
            except Exception as told:  # the machine's own: the case was drawn badly
                return replace(found, verdict="generator", words=f"{type(told).__name__}: {told}")
    except _Late:
        return replace(found, verdict="slow", words=f"no answer within {limit:g} s")
    if got.shape != right.shape or not np.all(np.isfinite(right)):
        off = math.inf
    else:
        size = np.abs(right) if case.each else np.max(np.abs(right), initial=0.0)
        off = float(
            np.max(np.abs(got - right) / (case.tolerance * np.maximum(size, np.finfo(float).tiny)), initial=0.0)
        )
    verdict: Verdict = "right" if off <= 1.0 else "told" if door.told else "fault"  # nan is not <= 1
    return replace(
        found,
        verdict=verdict,
        off=off,
        got=tuple(got.tolist()),
        right=tuple(right.tolist()),
        words="; ".join(door.told),
    )


def shrunk(name: str, index: int, case: Case, limit: float = 30.0) -> tuple[Case, Checked]:
    """The simplest case found that fails as this one does: entries dropped, then numbers made round."""
    found = judge(name, index, case, limit=limit)
    tries, better = 0, True
    while better and tries < _TRIES:
        better = False
        for model in _simpler(case):
            tries += 1
            simpler = replace(case, model=model)
            now = judge(name, index, simpler, limit=limit)
            if now.verdict == found.verdict:
                case, found, better = simpler, now, True
                break
            if tries >= _TRIES:
                break
    return case, found


def _simpler(case: Case) -> Iterator[Model]:
    """Models with one thing less or one number rounder, below the knobs of a case."""
    for knob in case.knobs:
        path = tuple(knob.split("."))
        there = _at(case.model, path)
        for key in list(there) if isinstance(there, Mapping) else ():
            yield _changed(case.model, (*path, key), None)
    for knob in case.knobs:
        path = tuple(knob.split("."))
        for leaf, number in _numbers(_at(case.model, path), path):
            for round_ in dict.fromkeys((0.0, 1.0, float(f"{number:.0e}"), float(f"{number:.1e}"))):
                if len(repr(round_)) < len(repr(float(number))):
                    yield _changed(case.model, leaf, round_)


def _at(model: Any, path: Sequence[Any]) -> Any:
    for key in path:
        if not isinstance(model, Mapping) or key not in model:
            return None
        model = model[key]
    return model


def _numbers(value: Any, path: tuple[Any, ...]) -> Iterator[tuple[tuple[Any, ...], float]]:
    if isinstance(value, int | float | np.number) and not isinstance(value, bool):
        yield path, float(value)
    elif isinstance(value, Mapping):
        for key, one in value.items():
            yield from _numbers(one, (*path, key))
    elif isinstance(value, list | tuple):
        for place, one in enumerate(value):
            yield from _numbers(one, (*path, place))


def _changed(model: Model, path: Sequence[Any], value: float | None) -> Model:
    """A copy with one number in place of another, or without an entry."""
    fresh: Any = copy.deepcopy(model)
    there = fresh
    for key in path[:-1]:
        if isinstance(there[key], tuple):
            there[key] = list(there[key])
        there = there[key]
    if value is None:
        del there[path[-1]]
    else:
        there[path[-1]] = value
    return fresh


def check(one: Capability, seed: int, index: int, limit: float = 30.0, shrink: bool = True) -> Checked:
    """A case drawn and judged; a failing one is shrunk and keeps its model."""
    try:
        case = one.case(seed, index)
    except Exception as told:
        return Checked(one.name, index, "generator", words=f"{type(told).__name__}: {told}")
    found = judge(one.name, index, case, one.refuses, limit)
    if shrink and found.verdict in ("fault", "crashed"):
        case, found = shrunk(one.name, index, case, limit)
    told = found.verdict not in ("right",)
    return replace(found, model=as_yaml(case.model)) if told else found


def _check_named(name: str, seed: int, index: int, limit: float, shrink: bool, trace: bool) -> Checked:
    one = capabilities()[name]
    return traced(one, seed, index, limit) if trace else check(one, seed, index, limit, shrink)


def traced(one: Capability, seed: int, index: int, limit: float = 30.0) -> Checked:
    """A check, its seconds, and which lines of the packages it executed; compiled kernels have none."""
    from coverage import Coverage  # an extra of those who plant mutants

    began, top = time.monotonic(), Path(__file__).resolve().parents[2]
    watch = Coverage(data_file=None, include=[f"{top / name}/*" for name in ("femstruct", "acoustics")])
    watch.set_option("run:disable_warnings", ["no-data-collected"])
    watch.start()
    try:
        found = check(one, seed, index, limit, shrink=False)
    finally:
        watch.stop()
    data = watch.get_data()
    lines = {str(Path(file).relative_to(top)): sorted(data.lines(file) or ()) for file in data.measured_files()}
    return replace(found, seconds=time.monotonic() - began, lines={file: some for file, some in lines.items() if some})


def is_fault(one: Checked) -> bool:
    """Of a program by itself: what is refused or told is none."""
    return one.verdict in FAULTS


def differs(
    kept: Mapping[str, str], unchanged: Callable[[Checked], str | None] | None = None
) -> Callable[[Checked], bool]:
    """Of a changed program: what the unchanged one was not.

    kept : its verdicts by capability and index; unchanged : gives that on a fault that is not kept, or where either was
    slow, as a busy machine makes anything. Without it such a fault counts.
    """
    known, asked = dict(kept), set[str]()

    def differing(one: Checked) -> bool:
        key = f"{one.capability} {one.index}"
        before = known.get(key)
        if before is None and not is_fault(one):
            return False
        doubtful = one.verdict != before and (before is None or "slow" in (before, one.verdict))
        if unchanged is not None and doubtful and key not in asked:
            asked.add(key)
            before = known[key] = unchanged(one) or "no verdict"
        return one.verdict != before

    return differing


def run(
    chosen: Sequence[Capability], seed: int, seconds: float, workers: int = 1, count: int | None = None,
    limit: float = 30.0, until_fault: bool = False, fault: Callable[[Checked], bool] = is_fault, trace: bool = False,
) -> list[Checked]:  # fmt: skip
    """Checks in turn of the capabilities until the time is over, or `count` of each is done; in the order drawn.

    until_fault : no new check is begun after the first fault, and none is shrunk; trace : with their lines.
    """
    end = time.monotonic() + seconds
    indices = range(count) if count is not None else itertools.count()
    jobs = ((one, index) for index in indices for one in chosen)
    done: list[Checked] = []

    def goes_on() -> bool:
        return time.monotonic() < end and not (until_fault and any(map(fault, done)))

    if workers == 1:
        for one, index in itertools.takewhile(lambda _: goes_on(), jobs):
            done.append(_check_named(one.name, seed, index, limit, not until_fault, trace))
        return done
    waiting: set[Future[Checked]] = set()
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        while True:
            while len(waiting) < 2 * workers and goes_on() and (job := next(jobs, None)):
                waiting.add(pool.submit(_check_named, job[0].name, seed, job[1], limit, not until_fault, trace))
            if not waiting:
                break
            ready, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            done += [one.result() for one in ready]
    place = {one.name: number for number, one in enumerate(chosen)}
    return sorted(done, key=lambda one: (one.index, place[one.capability]))


def reached(found: Sequence[Checked]) -> dict[str, dict[str, Any]]:
    """By capability: seconds of its quickest check (the first may have compiled), and lines of its checks by file."""
    by_name: dict[str, dict[str, Any]] = {}
    for one in found:
        known = by_name.setdefault(one.capability, {"seconds": math.inf, "lines": {}})
        known["seconds"] = min(known["seconds"], one.seconds)
        for file, lines in one.lines.items():
            known["lines"][file] = sorted({*known["lines"].get(file, ()), *lines})
    return by_name


def interval(faults: int, checks: int) -> tuple[float, float]:
    """Clopper and Pearson's 95 % interval of a rate."""
    low = 0.0 if faults == 0 else float(beta.ppf(0.025, faults, checks - faults + 1))
    high = 1.0 if faults == checks else float(beta.ppf(0.975, faults + 1, checks - faults))
    return low, high


def table(chosen: Sequence[Capability], found: Sequence[Checked]) -> str:
    """Checks and faults by capability. A model that was refused, or drawn badly, is no check."""
    rows = [f"{'capability':40} {'kind':12} {'checks':>6} {'faults':>6} {'told':>5} {'refused':>7} {'drawn badly':>11}"]
    for one in chosen:
        of = [each.verdict for each in found if each.capability == one.name]
        rows.append(f"{one.name:40} {one.kind:12} {_counts(of)}")
    verdicts = [each.verdict for each in found]
    rows.append(f"{'all':40} {'':12} {_counts(verdicts)}")
    faults = sum(each in FAULTS for each in verdicts)
    checks = sum(each not in ("refused", "generator") for each in verdicts)
    low, high = interval(faults, checks)
    rate = f"{faults / checks:.2%}" if checks else "unknown"
    return "\n".join([*rows, f"faults {rate} of checks, 95 % interval {low:.2%} to {high:.2%}"])


def _counts(verdicts: Sequence[Verdict]) -> str:
    told, refused, badly = (verdicts.count(each) for each in ("told", "refused", "generator"))
    faults = sum(each in FAULTS for each in verdicts)
    return f"{len(verdicts) - refused - badly:6} {faults:6} {told:5} {refused:7} {badly:11}"


def write(found: Sequence[Checked], folder: Path) -> list[Path]:
    """A file for each check that was not right: the model, and both numbers above it."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for one in (each for each in found if each.verdict != "right"):
        head = [f"{one.capability}, index {one.index}: {one.verdict}, {one.off:.4g} tolerances off"]
        head += [f"got   {list(one.got)}", f"right {list(one.right)}", *one.words.splitlines()]
        path = folder / f"{one.verdict}_{re.sub('[^a-zA-Z0-9]+', '_', one.capability)}_{one.index}.yaml"
        path.write_text("".join(f"# {line}\n" for line in head) + one.model, encoding="utf-8")
        paths.append(path)
    return paths
