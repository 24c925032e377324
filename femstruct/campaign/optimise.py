"""The best design of a study: searched everywhere first, then near the best one, with what lies beside it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np
from scipy import optimize

from femstruct.arrays import Floats
from femstruct.campaign.designs import NEVER, Designs, Outcome, Spent
from femstruct.campaign.references import references
from femstruct.campaign.searching import HELD, designs_of, ends_of, seen_before, table_of
from femstruct.campaign.tried import with_limits_of_study
from femstruct.declared import Count, expect
from femstruct.errors import InputError
from femstruct.study.campaign.sought import VALLEYS, Chosen, Found, Reference, Search
from femstruct.study.campaign.swept import Swept
from femstruct.study.campaign.varied import Listed
from femstruct.workflow.progress import Progress

scipy_optimize: Any = optimize  # its types know nothing of vectorised functions
EVERYWHERE: Final = 0.7  # of the runs, for the search in all of the ranges
GENERATIONS: Final = 8  # of the search everywhere, about; a larger crowd sees more than a longer search
CROWD: Final = (12, 100)  # designs of a generation, at least and at most
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

    folder, workers, cluster : as for `femstruct.sweep`; rows that are kept there are not run again. seen : a sweep over
    the same paths, of which the search begins with the best designs, those that lie apart.

    Returns the best design, with those beside it. A design with a finding that forbids trust, or without one of its
    numbers, never wins. After Ctrl-C the best so far.

    Raises InputErrors where the files cannot be read, InputError for names of numbers that there are not, and where no
    design of the first generation can be run.

    Notes
    -----
    Differential evolution with feasibility rules in place of penalties (Lampinen 2002, as scipy has it), from a Latin
    hypercube, in the first 70 % of the runs; then COBYQA, a trust region method without derivatives (Ragonneau 2022),
    from the best designs, lists as they are there; then the simplexes of Nelder and Mead from the best, where no limit
    holds it. Where something scatters, goal and limits are their quantiles over
    the same samples for every design. A global optimum is not proven: `seed` gives another course. The case as the file
    has it, and the baseline, are run beside it with the same samples; these runs are not counted.

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
        first = np.empty((0, len(search.designs))) if seen is None else seen_before(search, seen, case)
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
    crowd = min(max(int(EVERYWHERE * most) // GENERATIONS, 4 * d, CROWD[0]), CROWD[1], designs.left)
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

    def at(x: Floats) -> Outcome:
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


def _limits(search: Search, outcomes: Callable[[Floats], list[Outcome]]) -> tuple[Any, ...]:
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
        designs(np.array([point for j in range(len(best)) for point in beside(search, best, j)]).reshape(-1, len(best)))
        if designs.best == number:
            return


def beside(search: Search, best: Floats, j: int) -> list[Floats]:
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
    around = [best, *beside(search, best, j)]
    known = [(point[j], one) for point in around if (one := designs.known(point)) is not None and one.sound]
    if len(known) < 2:
        return float("nan")
    (low, first), (high, last) = min(known, key=lambda pair: pair[0]), max(known, key=lambda pair: pair[0])
    return float(0.01 * (last.goal - first.goal) / (high - low))
