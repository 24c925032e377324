"""The best design of a study: searched everywhere first, then near the best one, with what lies beside it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import numpy as np
from scipy import optimize

from femstruct.arrays import Floats
from femstruct.campaign.designs import (
    NEVER,
    DesignOutcome,
    Designs,
    Spent,
    refuse_values,
    with_limits_of_study,
    with_place,
)
from femstruct.campaign.executors import crew
from femstruct.campaign.rows import Row, open_journal, rename_previous
from femstruct.campaign.tasks import gather_rows, make_ready, versions
from femstruct.declared import Count, expect
from femstruct.errors import InputError, InputErrors
from femstruct.language.cases import read_study
from femstruct.study.campaigns import Listed, Scattered, Swept
from femstruct.study.optima import VALLEYS, Chosen, End, Found, Reference, Search
from femstruct.study.study import Plan
from femstruct.workflow.bases import fingerprint
from femstruct.workflow.provenance import Progress, progress_counter, version_of

# ----------------------------------------------------------------------------------------------------------------------
# What all searches for good designs share: the rows that are kept, who runs them, and a name for all they hang on.
# ----------------------------------------------------------------------------------------------------------------------

ROWS: Final = "optimise.rows"  # where rows are kept as they come
HELD: Final = 1e-9  # share by which a limit may be exceeded: rounding
AT_END: Final = 0.002  # of a range: so near to its end, a design lies at it
SEEN: Final = 3  # designs of a sweep that a search begins with


@contextmanager
def designs_of(
    search: Search,
    folder: Path | None,
    workers: int | None,
    cluster: str,
    progress: Progress,
) -> Iterator[Designs]:
    """The designs of a search, to be tried; they end with the block."""
    plan = read_study(search.file, search.overrides, only=search.case or None)
    refuse_values(search, plan)
    with ExitStack() as stack:
        place = folder or Path(stack.enter_context(TemporaryDirectory()))
        place.mkdir(parents=True, exist_ok=True)
        make_ready(plan, progress)
        journal = stack.enter_context(open_journal(place / ROWS, name_of(search, plan)))
        run = stack.enter_context(crew(workers or os.cpu_count() or 1, cluster))
        report = progress_counter(search.runs, "runs", progress, most=True)
        try:
            yield Designs(search, search.case or plan.baseline, journal, run, report)
        except KeyboardInterrupt:
            if not journal.rows():
                journal.remove()
            raise
        except InputError as error:
            raise with_place(search, error) from None


def table_of(search: Search, designs: Designs, command: str) -> Swept:
    """The rows of all designs, in their order."""
    samples = designs.samples()
    plan = read_study(search.file, search.overrides, only=search.case or None)
    whole = plan if search.case else read_study(search.file, search.overrides, only=plan.baseline)
    rows = gather_rows(search.title, whole, samples, designs.rows(), {}, command=command)
    return replace(rows, provenance={**rows.provenance, **_course(search)})


def ends_of(search: Search, point: Floats) -> tuple[End, ...]:
    """For every path the end of its range that a design, a point of the unit cube, lies at; "" inside and of lists."""
    return tuple(
        "" if isinstance(one, Listed) else "lower" if u < AT_END else "upper" if u > 1.0 - AT_END else ""
        for one, u in zip(search.designs, np.asarray(point), strict=True)
    )


def starting_designs(search: Search, rows: Swept, case: str) -> Floats:
    """The best designs of a sweep that lie apart, as points of the unit cube [n, d]: those that hold all limits first.

    Parameters
    ----------
    rows : Swept
        Of a sweep over all paths that may be chosen, and of a case; none of one over fewer, or without a number.
    """
    names = [search.goal, *(name for name in search.limits if name not in rows.paths)]
    columns = [rows.paths.index(one.path) if one.path in rows.paths else -1 for one in search.designs]
    if case not in rows.cases or not set(names) <= set(rows.names) or min(columns) < 0:
        return np.empty((0, len(columns)))
    points = np.array([_unit_of(one, rows, j) for one, j in zip(search.designs, columns, strict=True)]).T
    known = np.isfinite(points).all(axis=1) & rows.trusted(case) & np.isfinite(rows.of(search.goal, case))
    beyond = np.zeros(len(points))
    for name, limit in search.limits.items():
        own = rows.values[:, rows.paths.index(name)] if name in rows.paths else rows.of(name, case)
        over = np.where(np.isfinite(own), (own - limit) / (abs(limit) or 1.0), np.inf)
        beyond += np.where(over > HELD, over, 0.0)
    small = search.goals[0].sign * rows.of(search.goal, case)
    found: list[Floats] = []
    for k in sorted(np.flatnonzero(known & np.isfinite(beyond)), key=lambda k: (beyond[k], small[k])):
        if len(found) < SEEN and all(np.linalg.norm(points[k] - one) > VALLEYS for one in found):
            found.append(points[k])
    return np.array(found).reshape(-1, len(columns))


def _unit_of(one: Listed | Scattered, rows: Swept, j: int) -> Floats:
    """Where the values of a path of a sweep lie in the range, or the list, of what may be chosen [n]; nan outside."""
    values = rows.values[:, j]
    if isinstance(one, Listed):
        count = len(one.texts)
        texts = {text: (k + 0.5) / count for k, text in enumerate(one.texts)}
        numbers = {value: (k + 0.5) / count for k, value in enumerate(one.numbers)}
        pairs = zip(rows.texts, values.tolist(), strict=True)
        return np.array([texts.get(own[j], numbers.get(value, np.nan)) for own, value in pairs])
    if one.law == "log-uniform":
        values = np.log(np.where(values > 0.0, values, np.nan) / one.first) / np.log(one.second / one.first)
    else:
        values = (values - one.first) / (one.second - one.first)
    inside = (values > -AT_END) & (values < 1.0 + AT_END)
    return np.where(inside, np.clip(values, 0.0, 1.0), np.nan)


def set_aside(search: Search, folder: Path) -> Path | None:
    """Give the files of another optimisation in a folder names with a number; returns that of its rows, None where
    there are none."""
    if not (folder / ROWS).exists():
        return None
    plan = read_study(search.file, search.overrides, only=search.case or None)
    return rename_previous(folder / ROWS, name_of(search, plan))


def name_of(search: Search, plan: Plan) -> str:
    """A name for all that the rows of an optimisation hang on, but for files that some of its designs alone are read
    from: these the journal knows."""
    return fingerprint((dict(plan.sources), with_limits_of_study(search, plan), versions() | _course(search)))


def _course(search: Search) -> dict[str, str]:
    """The version of what leads a search for several goals, of others none."""
    return version_of("pymoo") if search.also else {}


# ----------------------------------------------------------------------------------------------------------------------
# What the best design is held against: its case as the file has it, and the baseline, with the same scatter.
# ----------------------------------------------------------------------------------------------------------------------


def references(search: Search, designs: Designs) -> tuple[Reference, ...]:
    """The case whose numbers are chosen as it is written, then the baseline where that is another."""
    plan = _plan(search)
    case = search.case or plan.baseline
    cases = tuple(dict.fromkeys((case, plan.baseline)))
    if search.goal in [one.path for one in search.designs]:
        none, why = np.full(search.samples, np.nan), f"'{search.goal}' is chosen, and no number of a run"
        return tuple(Reference(name, name == case, np.nan, (np.nan, np.nan), np.nan, none, why) for name in cases)
    own = designs.goals_of(designs.of_design(designs.best))[2]
    found = []
    for name, rows in zip(cases, designs.as_written(cases), strict=True):
        why = _missing(search, rows)
        goal, ends, values = designs.goals_of(rows)
        if why:
            goal, ends, values = np.nan, (np.nan, np.nan), np.full(len(rows), np.nan)
        found.append(Reference(name, name == case, goal, ends, float(values.mean()), own - values, why))
    return tuple(found)


def _plan(search: Search) -> Plan:
    """The study with all its cases, or with its own alone where another cannot be read."""
    try:
        return read_study(search.file, search.overrides)
    except InputErrors:
        return read_study(search.file, search.overrides, only=search.case or None)


def _missing(search: Search, rows: list[Row]) -> str:
    """Why rows have no goal to compare with, "" where they have."""
    if trouble := next((row.trouble for row in rows if row.trouble), ""):
        return trouble
    if severe := dict.fromkeys(code for row in rows for code in row.severe):
        return f"{', '.join(severe)}, which forbids trust"
    if any(search.goal not in row.numbers or not np.isfinite(row.numbers[search.goal].value) for row in rows):
        return f"no {search.goal}"
    return ""


# ----------------------------------------------------------------------------------------------------------------------
# The best design of a study.
# ----------------------------------------------------------------------------------------------------------------------

scipy_optimize: Any = optimize  # its types know nothing of vectorised functions
EVERYWHERE: Final = 0.7  # of the runs, for the search in all of the ranges
GENERATIONS: Final = 8  # of the search everywhere, about; a larger crowd sees more than a longer search
POPULATION_LIMITS: Final = (12, 100)  # designs of a generation, at least and at most
BESIDES: Final = 2  # times that these are tried
BESIDE: Final = 0.01  # of a range, from the best design to those beside it
FIRST: Final = 0.05  # of the ranges: radius at which the search near the best designs begins
ROUGH: Final = 2e-3  # and that at which it ends without limits; from there on only the best is followed
LAST: Final = 1e-4  # and that at which it ends with limits, and the last search
FINE: Final = 1e-7  # of the goal: what still counts as better there
REACHED: Final = 1e-3  # of a limit: so near to it, it is what holds a design
SPREAD: Final = 0.02  # of the ranges: first steps of the last search
STARTS: Final = 3  # of the search near the best, from designs of different valleys


def optimise(
    search: Search,
    folder: str | Path | None = None,
    workers: int | None = None,
    cluster: str = "",
    progress: Progress = lambda line: None,
    command: str = "",
    seen: Swept | None = None,
) -> Found:
    """The design with the least or largest goal that holds all limits, its own and those of the study.

    Parameters
    ----------
    folder, workers, cluster : str | Path | None, int | None, str
        As for `femstruct.sweep`; rows that are kept there are not run again.
    seen : Swept | None
        A sweep over the same paths, of which the search begins with the best designs, those that lie apart.

    Returns
    -------
    Found
        The best design, with those beside it. A design with a finding that forbids trust, or without one of its
        numbers, never wins. After Ctrl-C the best so far.

    Raises
    ------
    InputErrors
        Where the files cannot be read, InputError for names of numbers that there are not, and where no design of the
        first generation can be run.

    Notes
    -----
    Differential evolution with feasibility rules in place of penalties (Lampinen 2002, as scipy has it), from a Latin
    hypercube, in the first 70 % of the runs; then COBYQA, a trust region method without derivatives (Ragonneau 2022),
    from the best designs, lists as they are there; then the simplexes of Nelder and Mead from the best, where no limit
    holds it. Where something scatters, goal and limits are their quantiles over
    the same samples for every design. A global optimum is not proven: `seed` gives another course. The case as the file
    has it, and the baseline, are run beside it with the same samples; these runs are not counted.

    Examples
    --------
    The lightest ball that gives a mass half a metre per second:

    >>> from pathlib import Path
    >>> import tempfile
    >>> from femstruct import Scattered
    >>> model = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\\npoints: {m: {}}"
    >>> study = '''
    ... model: model.yaml
    ... bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
    ... record: {m.z: velocity}
    ... time: {duration: 10 ms, sampling: 10 kHz}
    ... '''
    >>> with tempfile.TemporaryDirectory() as place:
    ...     _ = Path(place, "model.yaml").write_text(model, encoding="utf-8")
    ...     _ = Path(place, "hit.study.yaml").write_text(study, encoding="utf-8")
    ...     mass = Scattered("bodies.ball.mass", "uniform", 0.1, 2.0, "kg")
    ...     file = str(Path(place, "hit.study.yaml"))
    ...     search = Search(file, "m.z velocity", (mass,), "maximise", {"m.z velocity": 0.5}, runs=60)
    ...     found = optimise(search, workers=1)
    >>> round(found.chosen[0].number, 2), round(found.goal, 3), found.feasible  # 2 m / (m + M) = 0.5
    (0.33, 0.5, True)
    """
    expect("optimise", search, Search, "read_search(PATH) is that of a study file")
    expect("optimise workers", workers, Count | None)
    folder = Path(folder) if folder is not None else None
    if search.also:
        expected = "one; femstruct.pareto_front finds designs for several"
        raise InputError("optimise", got=f"{len(search.goals)} goals", expected=expected)
    search = with_limits_of_study(search)
    with designs_of(search, folder, workers, cluster, progress) as designs:
        case = search.case or (seen.baseline if seen is not None else "")
        first = np.empty((0, len(search.designs))) if seen is None else starting_designs(search, seen, case)
        (spent, stopped), beside = _searched(search, designs, first), tuple[Reference, ...]()
        if not stopped:
            try:
                beside = references(search, designs)
            except KeyboardInterrupt:
                stopped = True
        table = table_of(search, designs, command)
    return replace(_found(search, designs, (spent, stopped), table), references=beside, begun=len(first))


def _searched(search: Search, designs: Designs, first: Floats | None = None) -> tuple[bool, bool]:
    """Try designs, the `first` [n, d] among them, until the runs are spent or nothing gets better; which of them, and
    whether Ctrl-C ended it."""
    spent = False
    try:
        for stage in (partial(_everywhere, first=first), _nearby):
            try:
                stage(search, designs)
            except Spent:
                spent = True
        designs.kept_back = 0
        with suppress(Spent):
            _beside(search, designs)
    except KeyboardInterrupt:
        if not designs.outcomes:
            raise
        return spent, True
    return spent, False


def _everywhere(search: Search, designs: Designs, first: Floats | None = None) -> None:
    """Differential evolution in all of the ranges; the `first` designs stand in place of as many that are drawn."""
    from scipy.stats import qmc

    d, most = len(search.designs), search.runs // search.samples
    crowd = min(
        max(int(EVERYWHERE * most) // GENERATIONS, 4 * d, POPULATION_LIMITS[0]), POPULATION_LIMITS[1], designs.left
    )
    start = qmc.LatinHypercube(d, rng=np.random.default_rng(search.seed)).random(crowd)
    if first is not None:
        start[: len(first)] = first
    scipy_optimize.differential_evolution(
        lambda x: np.array([one.small for one in designs(np.atleast_2d(x.T))]),
        [(0.0, 1.0)] * d,
        init=start,
        rng=np.random.default_rng(search.seed),
        constraints=_limits(search, lambda x: designs(np.atleast_2d(x.T))),
        maxiter=max(int(EVERYWHERE * most) // crowd - 1, 1),
        tol=1e-3,
        polish=False,
        vectorized=True,
        updating="deferred",
    )


def _nearby(search: Search, designs: Designs) -> None:
    """A trust region method from the best designs that lie apart; then from the best, where it reaches no limit, by
    simplexes, which go down a valley with a kink in its floor, as the larger of two peaks has. Lists stay as they are
    there."""
    free = [j for j, one in enumerate(search.designs) if not isinstance(one, Listed)]
    if not free:
        return
    for start in _starts(designs):
        _downhill(search, designs, start, free, LAST if search.limits else ROUGH)
    if max(designs.outcomes[designs.best].excess, default=-np.inf) < -REACHED:
        _by_simplexes(search, designs, designs.points[designs.best], free)


def _starts(designs: Designs) -> list[Floats]:
    """The best design; that which exceeds limits least for what it gains over the best, as a valley that reaches them
    with its end alone has no other; then the best of those that are far from these, and so on."""
    outcomes, best = designs.outcomes, designs.outcomes[designs.best]
    order = sorted((k for k, one in enumerate(outcomes) if one.sound), key=designs.rank)
    gained = {k: best.small - outcomes[k].small for k in order if outcomes[k].beyond > HELD}
    promising = [k for k, gain in gained.items() if best.beyond <= HELD and gain > FINE * abs(best.small)]
    beyond = sorted(promising, key=lambda k: outcomes[k].beyond / gained[k])
    found: list[Floats] = []
    for k in (*order[:1], *beyond[:1], *order[1:]):
        if len(found) < STARTS and all(np.linalg.norm(designs.points[k] - one) > VALLEYS for one in found):
            found.append(designs.points[k])
    return found


def _downhill(search: Search, designs: Designs, best: Floats, free: Sequence[int], last: float) -> None:
    """A trust region method from one design, along the paths that are no lists, to a last radius."""
    scale = abs(designs.outcomes[designs.best].small) or 1.0

    def at(x: Floats) -> DesignOutcome:
        point = best.copy()
        point[free] = np.clip(x, 0.0, 1.0)
        return designs(point[None])[0]

    scipy_optimize.minimize(
        lambda x: at(x).small / scale,
        best[free],
        method="COBYQA",
        bounds=[(0.0, 1.0)] * len(free),
        constraints=_limits(search, lambda x: [at(x)]),
        options={"initial_tr_radius": FIRST, "final_tr_radius": last, "maxfev": search.runs},
    )


def _by_simplexes(search: Search, designs: Designs, best: Floats, free: Sequence[int]) -> None:
    """The method of Nelder and Mead from one design; what exceeds a limit is worse than all that does not."""
    scale = abs(designs.outcomes[designs.best].small) or 1.0

    def at(x: Floats) -> float:
        point = best.copy()
        point[free] = np.clip(x, 0.0, 1.0)
        one = designs(point[None])[0]
        return one.small / scale if one.beyond <= HELD else NEVER

    start = best[free]
    steps = np.diag(np.where(start < 0.5, SPREAD, -SPREAD))
    scipy_optimize.minimize(
        at,
        start,
        method="Nelder-Mead",
        bounds=[(0.0, 1.0)] * len(free),
        options={
            "initial_simplex": np.vstack([start, start + steps]),
            "xatol": LAST,
            "fatol": FINE,
            "maxfev": search.runs,
        },
    )


def _limits(search: Search, outcomes: Callable[[Floats], list[DesignOutcome]]) -> tuple[Any, ...]:
    """The limits of one design [d], or of several [d, n], for scipy."""
    if not search.limits:
        return ()

    def excess(x: Floats) -> Floats:
        table = np.array([one.excess for one in outcomes(x)]).T
        return table if x.ndim == 2 else table[:, 0]

    return (scipy_optimize.NonlinearConstraint(excess, -np.inf, 0.0),)


def _beside(search: Search, designs: Designs) -> None:
    """Designs on both sides of the best one, for what each path changes; again where one of them is better."""
    for _ in range(BESIDES):
        number = designs.best
        best = designs.points[number]
        designs(
            np.array([point for j in range(len(best)) for point in neighbours(search, best, j)]).reshape(-1, len(best))
        )
        if designs.best == number:
            return


def neighbours(search: Search, best: Floats, j: int) -> list[Floats]:
    """The points on both sides of a design along a range, as far as there are; none along a list."""
    if isinstance(search.designs[j], Listed):
        return []
    found = []
    for step in (-BESIDE, BESIDE):
        point = best.copy()
        point[j] = np.clip(point[j] + step, 0.0, 1.0)
        if point[j] != best[j]:
            found.append(point)
    return found


def _found(search: Search, designs: Designs, ended: tuple[bool, bool], rows: Swept) -> Found:
    """The answer, from all that was tried."""
    best, points, outcomes = designs.best, designs.points, designs.outcomes
    own = outcomes[best]
    held = [(k + 1, one) for k, one in enumerate(outcomes) if one.beyond <= HELD]
    least = np.minimum.accumulate([one.small for _, one in held])
    better = [i for i in range(len(held)) if i == 0 or least[i] < least[i - 1]]
    return Found(
        search=search,
        unit=designs.units[0],
        goal=own.goal,
        ends=own.ends,
        chosen=tuple(_chosen(search, designs, j, rows) for j in range(len(search.designs))),
        limits=dict(zip(search.limits, own.limited, strict=True)),
        feasible=own.beyond <= HELD,
        best=best * search.samples,
        runs=len(outcomes) * search.samples,
        designs=len(points),
        left_out=sum(not one.sound for one in outcomes),
        history=tuple((held[i][0], held[i][1].goal) for i in better),
        goals=np.array([one.goal for one in outcomes]),
        held=np.array([one.beyond <= HELD for one in outcomes]),
        spent=ended[0],
        interrupted=ended[1],
        rows=rows,
    )


def _chosen(search: Search, designs: Designs, j: int, rows: Swept) -> Chosen:
    one, row = search.designs[j], designs.best * search.samples
    end = ends_of(search, designs.points[designs.best])[j]
    return Chosen(one.path, rows.texts[row][j], float(rows.values[row, j]), one.unit, end, _change(search, designs, j))


def _change(search: Search, designs: Designs, j: int) -> float:
    """What the goal changes for 1 % of a range, from the designs beside the best one; nan where they were not run."""
    best = designs.points[designs.best]
    around = [best, *neighbours(search, best, j)]
    known = [(point[j], one) for point in around if (one := designs.known(point)) is not None and one.sound]
    if len(known) < 2:
        return float("nan")
    (low, first), (high, last) = min(known, key=lambda pair: pair[0]), max(known, key=lambda pair: pair[0])
    return float(0.01 * (last.goal - first.goal) / (high - low))
