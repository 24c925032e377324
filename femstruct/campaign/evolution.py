"""NSGA-II of pymoo, asked for a generation at a time: the only file that knows pymoo, which is an extra."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import InputError

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
