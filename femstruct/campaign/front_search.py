"""The front of a study with two or three goals, by NSGA-II: designs of which none is better than another in all."""

from __future__ import annotations

from collections.abc import Sequence
from math import isqrt
from pathlib import Path
from typing import Any, Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.campaign.designs import NEVER, DesignOutcome, Designs, with_limits_of_study
from femstruct.campaign.optimise import HELD, designs_of, ends_of, table_of
from femstruct.declared import Count, expect
from femstruct.errors import InputError
from femstruct.study.campaigns import Listed, Swept
from femstruct.study.optima import Front, Search, convergence_of, members_of
from femstruct.workflow.provenance import Progress

# ----------------------------------------------------------------------------------------------------------------------
# NSGA-II of pymoo, asked for a generation at a time: the only file that knows pymoo, which is an extra.
# ----------------------------------------------------------------------------------------------------------------------

INSTALL: Final = "pip install 'femstruct[design]'"


class Evolution:
    """Points of the unit cube [n, d], generation after generation, from the goals and excesses of those before.

    start : the first generation [n, d]. choices [d] : how many values a list has, 0 for a range; points along a list
    are the middles of so many parts of it. goals, limits : how many there are.

    Raises InputError without pymoo.

    Notes
    -----
    The course depends on the seed and on what is told alone. Crossover, mutation and their parameters are those that
    pymoo has for NSGA-II: simulated binary crossover (eta 15, probability 0.9), polynomial mutation (eta 20).
    """

    def __init__(self, start: Floats, choices: tuple[int, ...], goals: int, limits: int, seed: int) -> None:
        try:
            from pymoo.algorithms.moo.nsga2 import NSGA2
            from pymoo.core.evaluator import Evaluator
            from pymoo.core.problem import Problem
            from pymoo.core.repair import Repair
            from pymoo.core.termination import NoTermination
            from pymoo.problems.static import StaticProblem
        except ImportError:
            got, expected = "no package 'pymoo'", "it installed: it searches for several goals"
            raise InputError("optimise", got=got, expected=expected, do=INSTALL) from None
        parts = np.array(choices)

        class Middles(Repair):  # type: ignore[misc]
            def _do(self, problem: object, X: Floats, **kwargs: object) -> Floats:
                snapped = (np.minimum(np.floor(X * parts), parts - 1) + 0.5) / np.maximum(parts, 1)
                return np.asarray(np.where(parts > 0, snapped, X))

        self._problem: Any = Problem(n_var=len(choices), n_obj=goals, n_ieq_constr=limits, xl=0.0, xu=1.0)
        self._static, self._evaluator, self._asked = StaticProblem, Evaluator(), None
        self._algorithm: Any = NSGA2(pop_size=len(start), sampling=np.array(start), repair=Middles(), seed=seed)
        self._algorithm.setup(self._problem, termination=NoTermination())

    def ask(self, most: int) -> Floats:
        """The next generation [n, d], of at most so many points but for the first; none where no other can be made."""
        self._algorithm.n_offsprings = min(self._algorithm.pop_size, most)
        self._asked = self._algorithm.ask()
        return np.empty((0, self._problem.n_var)) if self._asked is None else np.asarray(self._asked.get("X"))

    def tell(self, small: Floats, excess: Floats) -> None:
        """What came of it, all finite: goals that are to be small [n, g]; by how much limits are exceeded [n, m]."""
        self._evaluator.eval(self._static(self._problem, F=small, G=excess), self._asked)
        self._algorithm.tell(infills=self._asked)


# ----------------------------------------------------------------------------------------------------------------------
# The front of a study with two or three goals, by NSGA-II.
# ----------------------------------------------------------------------------------------------------------------------

POPULATION_LIMITS: Final = (24, 100)  # designs of a generation, at least and at most
IDLE: Final = 10  # generations in a row without a design that was not tried before, after which there are none left


def pareto_front(
    search: Search,
    folder: str | Path | None = None,
    workers: int | None = None,
    cluster: str = "",
    progress: Progress = lambda line: None,
    command: str = "",
) -> Front:
    """The designs that hold all limits and of which none is better than another in all of two or three goals.

    A design with a finding that forbids trust, or without one of its numbers, is never on the front. After Ctrl-C the
    front so far.

    Parameters
    ----------
    folder, workers, cluster : str | Path | None, int | None, str
        As for `femstruct.sweep`; rows that are kept there are not run again.

    Raises
    ------
    InputErrors
        And InputError as `femstruct.optimise`; InputError also for a search with one goal, and without the package
        pymoo.

    Notes
    -----
    NSGA-II (Deb and others 2002, IEEE Trans. Evol. Comput. 6, 182) as pymoo has it: designs that hold all limits come
    before those that do not, lists are choices, the first generation is a Latin hypercube. What scatters is treated as
    for one goal. The same seed gives the same designs, whoever runs them. That the front is the true one is not proven.

    Examples
    --------
    A ball and what it gives a mass; the lighter the ball, the less it gives, so that each is on the front:

    >>> from pathlib import Path
    >>> import tempfile
    >>> from femstruct import Goal, Scattered
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
    ...     also = (Goal("ball on m peak force", "maximise"),)
    ...     search = Search(str(Path(place, "hit.study.yaml")), "m.z velocity", (mass,), also=also, runs=25)
    ...     found = pareto_front(search, workers=1)
    >>> len(found.members), found.designs
    (25, 25)
    """
    expect("pareto_front", search, Search, "read_search(PATH) is that of a study file")
    expect("pareto_front workers", workers, Count | None)
    folder = Path(folder) if folder is not None else None
    if not search.also:
        raise InputError("optimise", got="one goal", expected="two or three", do="femstruct.optimise takes one")
    search = with_limits_of_study(search)
    course = evolution(search)  # before anything is run
    with designs_of(search, folder, workers, cluster, progress) as designs:
        generations, spent, interrupted = run_generations(designs, course)
        rows = table_of(search, designs, command)
    return _found(search, designs, generations, (spent, interrupted), rows)


def evolution(search: Search) -> Evolution:
    """The course of a search, from a Latin hypercube. Raises InputError without pymoo."""
    from scipy.stats import qmc

    d, most = len(search.designs), search.runs // search.samples
    crowd = min(max(isqrt(most) * (len(search.goals) - 1), POPULATION_LIMITS[0]), POPULATION_LIMITS[1])
    start = qmc.LatinHypercube(d, rng=np.random.default_rng(search.seed)).random(min(crowd, most))
    choices = tuple(len(one.texts) if isinstance(one, Listed) else 0 for one in search.designs)
    return Evolution(start, choices, len(search.goals), len(search.limits) + 1, search.seed)


def run_generations(designs: Designs, course: Evolution) -> tuple[tuple[int, ...], bool, bool]:
    """Try generations until the runs are spent or no new design comes up: how many designs were tried after each,
    whether the runs were spent, and whether Ctrl-C ended it."""
    designs.kept_back, idle = 0, 0
    generations: list[int] = []
    try:
        while designs.left and idle < IDLE:
            points, before = course.ask(designs.left), len(designs.outcomes)
            if not len(points):
                break
            outcomes = designs(points)
            course.tell(np.array([one.smalls for one in outcomes]), _excess(outcomes))
            idle = 0 if len(designs.outcomes) > before else idle + 1
            generations += [] if idle else [len(designs.outcomes)]
    except KeyboardInterrupt:
        if not designs.outcomes:
            raise
        return tuple(generations), False, True
    return tuple(generations), not designs.left, False


def _excess(outcomes: Sequence[DesignOutcome]) -> Floats:
    """By how much limits are exceeded [n, m + 1]; the last of them is that a design is to be trusted."""
    excess = np.array([(*one.excess, 0.0 if one.sound else NEVER) for one in outcomes])
    return np.where(excess <= HELD, 0.0, excess)


def _found(
    search: Search, designs: Designs, generations: tuple[int, ...], ended: tuple[bool, bool], rows: Swept
) -> Front:
    goals = np.array([one.goals for one in designs.outcomes])
    held = np.array([one.beyond <= HELD for one in designs.outcomes])
    small = goals * [one.sign for one in search.goals]
    members = members_of(small, held)
    return Front(
        search=search,
        units=designs.units,
        goals=goals,
        limited=np.array([one.limited for one in designs.outcomes]).reshape(len(goals), -1),
        held=held,
        at=tuple(ends_of(search, point) for point in designs.points),
        members=members,
        convergence=convergence_of(small, held, members, [count for count in generations if count <= len(goals)]),
        runs=len(designs.outcomes) * search.samples,
        spent=ended[0],
        interrupted=ended[1],
        rows=rows,
    )
