"""What a campaign is going to try, and designs of an optimisation, each run for every sample of what scatters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.campaign.executors import Crew
from femstruct.campaign.rows import APART, Journal, Number, Row
from femstruct.campaign.tasks import Samples, Task, at, samples_of
from femstruct.errors import InputError, InputErrors
from femstruct.language.campaigns import override_study, read_search, refuse_other_cases, refuse_set_by_cases, steps_of
from femstruct.language.cases import read_study
from femstruct.language.varied import CampaignSpec, varied_of, written
from femstruct.study.asked import SETTLED
from femstruct.study.campaigns import UNROUNDED, Campaign, Listed, Sampling, Scattered, quantiles_of, value_name
from femstruct.study.optima import NOT_AT_REST, Search
from femstruct.study.study import Plan
from femstruct.units import DIMENSIONS, QuantityError, quantity
from femstruct.yaml.reader import Here, Mistakes, Tree, near_one, read_yaml
from femstruct.yaml.validation import validate

# ----------------------------------------------------------------------------------------------------------------------
# What a campaign is going to try, read before anything is computed; and where in the file its mistakes stand.
# ----------------------------------------------------------------------------------------------------------------------


def campaigns_of(file: str | Path, overrides: Sequence[str] = ()) -> dict[str, str]:
    """What a study varies and optimises, in words by the command that does it; {} for any other file.

    Raises InputErrors for what cannot be tried.
    """
    keys, found = read_yaml(file).value, {}
    if keys.get("vary"):
        _refuse_varied(file, overrides)
        varied = [*keys["vary"]] if isinstance(keys["vary"], dict) else []
        found["femstruct sweep"] = f"varies {', '.join(varied)}"
    if keys.get("optimise"):
        request = read_search(file, overrides=overrides)
        plan = read_study(request.file, request.overrides, only=request.case or None)
        search = with_limits_of_study(request, plan)
        refuse_values(search, plan)
        goals = " and ".join(f"{goal.sense} {goal.name}" for goal in search.goals)
        of, chosen = f"of case '{search.case or plan.baseline}'", ", ".join(one.path for one in search.designs)
        held = ", ".join(f"{name} (of the study)" if name in search.of_study else name for name in search.limits)
        limits = f"; within the limits of {held}" if held else ""
        found["femstruct optimise"] = f"to {goals} {of} chooses {chosen}{limits}; at most {search.runs} runs"
    return found


def _refuse_varied(file: str | Path, overrides: Sequence[str]) -> None:
    """Raise InputErrors for paths under `vary:` of which the files can have neither the first nor the last value."""
    mistakes, settings = Mistakes(), tuple(overrides)
    tree = override_study(file, settings, ("vary",), mistakes)
    spec = validate(CampaignSpec, {"vary": tree.value["vary"]}, tree, mistakes)
    for one in varied_of(spec.vary if spec is not None else {}, Here(tree, mistakes)).values():
        texts = probes(one)
        refusals = [
            _refusal(str(file), settings, "", f"{one.path}={text}") for text in dict.fromkeys((texts[0], texts[-1]))
        ]
        if all(refusals):
            mistakes.note(f"{_place(tree, one)}vary {one.path}, value {texts[0]}: {refusals[0]}")
    mistakes.stop_if_any()


def with_limits_of_study(search: Search, plan: Plan | None = None) -> Search:
    """The search with the limits that the study states itself, which designs hold too; its own limit of the same
    number comes first.

    Parameters
    ----------
    plan : Plan | None
        The study as it is written, None to read it.
    """
    plan = plan or read_study(search.file, search.overrides, only=search.case or None)
    study = next(one.study for one in plan.cases if one.name == (search.case or plan.baseline))
    own = {one.name: one.value for one in study.limits if one.name not in search.limits}
    return replace(search, limits={**search.limits, **own}, of_study=(*search.of_study, *own)) if own else search


def refuse_values(search: Search, plan: Plan) -> None:
    """Raise InputErrors for listed values that the files cannot have, for ranges and distributions of which they can
    have no end, and for paths of other cases.

    Parameters
    ----------
    plan : Plan
        The study as it is written.
    """
    tree = read_yaml(search.file)
    paths, case = [one.path for one in (*search.designs, *search.over)], search.case or plan.baseline
    refuse_other_cases(tree, paths, case)
    refuse_set_by_cases(tree, paths, [case])
    mistakes = Mistakes()
    for one in (*search.designs, *search.over):
        texts = probes(one)
        found = [_refusal(search.file, search.overrides, search.case, f"{one.path}={text}") for text in texts]
        if isinstance(one, Listed) or all(found):
            for text, refusal in zip(texts, found, strict=True):
                if refusal:
                    mistakes.note(f"{_place(tree, one)}vary {one.path}, value {text}: {refusal}")
                if refusal and not isinstance(one, Listed):
                    break
    mistakes.stop_if_any()


def refused_ends(search: Search) -> dict[str, tuple[str, str]]:
    """Of ranges of which the files cannot have one end, by path: that end, "lower" or "upper", and why. Designs there
    fail, those at the other end may not."""
    found = {}
    for one in search.designs:
        for end, text in zip(("lower", "upper"), () if isinstance(one, Listed) else probes(one), strict=False):
            if why := _refusal(search.file, search.overrides, search.case, f"{one.path}={text}"):
                found[one.path] = (end, why)
    return found


def probes(one: Listed | Scattered) -> Sequence[str]:
    """Values of what varies, as a file writes them: all of a list, both ends of a range, the mean.

    >>> probes(Scattered("bodies.ball.mass", "uniform", 1.0, 2.0, "kg"))
    ('1.0 kg', '2.0 kg')
    """
    if isinstance(one, Listed):
        return one.texts
    ends = (one.first,) if one.law == "normal" else (one.first, one.second)
    return tuple(written(end, one.unit) for end in ends)


def with_place(search: Search, error: InputError) -> InputError:
    """The error with its place in the file, if what is wrong stands there."""
    tree = read_yaml(search.file)
    steps = tuple(error.where.split(".", 2))
    value = tree.value
    for step in steps:
        value = value.get(step) if isinstance(value, dict) else None
    if value is None or (isinstance(value, str | list) and error.got.strip("'") not in value):
        return error
    return InputErrors((f"{tree.position(steps)}: {error}",))


def _refusal(file: str, overrides: Sequence[str], case: str, change: str) -> str:
    """Why the files cannot have a value; "" where they can.

    Parameters
    ----------
    case : str
        The only one to try, "" for all.
    """
    try:
        read_study(file, (*overrides, change), only=case or None, others=not case)
    except InputErrors as errors:
        return errors.errors[0].removeprefix(f"--set {change}: ")
    return ""


def _place(tree: Tree, one: Listed | Scattered) -> str:
    return next((f"{tree.keys[steps]}: " for steps in steps_of(one.path) if steps in tree.keys), "")


# ----------------------------------------------------------------------------------------------------------------------
# Designs of an optimisation, each run for every sample of what scatters: goal and limits, and which to trust.
# ----------------------------------------------------------------------------------------------------------------------

MOST: Final = 12  # names in a message
NEVER: Final = 1e30  # excess of a design without a number, or that is not to be trusted: it never wins


class Spent(Exception):
    """As many runs were made as are allowed."""


@dataclass(frozen=True)
class DesignOutcome:
    """What came of a design: its goals [g]; the same with the sign with which they are to be small; what its limits are
    exceeded by, as shares of them [m]; the values that are limited [m]; the least and the largest of each goal over
    what scatters; whether its rows are to be trusted and have their numbers."""

    goals: tuple[float, ...]
    smalls: tuple[float, ...]
    excess: tuple[float, ...]
    limited: tuple[float, ...]
    spans: tuple[tuple[float, float], ...]
    sound: bool

    @property
    def goal(self) -> float:
        """The first goal, of most searches the only one."""
        return self.goals[0]

    @property
    def small(self) -> float:
        """The first goal with the sign with which it is to be small."""
        return self.smalls[0]

    @property
    def ends(self) -> tuple[float, float]:
        """The least and the largest first goal over what scatters."""
        return self.spans[0]

    @property
    def beyond(self) -> float:
        """By how much all limits together are exceeded; of what is not sound, by more than of anything that is."""
        return sum(max(one, 0.0) for one in self.excess) if self.sound else NEVER


class Designs:
    """All designs that were tried, in their order; what is tried again is not run again.

    Notes
    -----
    The runs of design k are the samples k s to k s + s - 1, s being those of the scatter. Rows of a journal are taken
    up by their case and texts, whatever their number: on another machine the last digits of a design may differ, and
    with them all designs that follow. kept_back : designs of those allowed that are left for the end.
    """

    def __init__(self, search: Search, case: str, journal: Journal, run: Crew, report: Callable[[int], None]) -> None:
        self._search, self._case, self._journal, self._run, self._told = search, case, journal, run, report
        self._scatter = _scatter(search)
        self._known = {row.design: row for row in journal.rows() if not row.again}
        self._rows: dict[int, Row] = {}
        self._numbers: dict[tuple[str, ...], int] = {}
        self.points: list[Floats] = []
        self.outcomes: list[DesignOutcome] = []
        self._seen = set[str]()
        self._units = dict[str, str]()
        self.kept_back = min(4 * len(search.designs), search.runs // search.samples // 4)

    def __call__(self, points: Floats) -> list[DesignOutcome]:
        """Outcomes of designs, points of the unit cube [n, d]. Raises Spent where they are more than are allowed;
        InputErrors where none of the first can be run, InputError for names of numbers that there are not."""
        texts = [self._texts(point) for point in points]
        new = {text: point for text, point in zip(texts, points, strict=True) if text not in self._numbers}
        if len(new) > self.left:
            raise Spent
        first, s = len(self.outcomes), self._search.samples
        requested = {
            (first + k) * s + j: text + more for k, text in enumerate(new) for j, more in enumerate(self._scatter)
        }
        self._finish({number: (self._case, *self._changes(text)) for number, text in requested.items()})
        for k, (text, point) in enumerate(new.items()):
            self._numbers[text] = first + k
            self.points.append(point)
            self.outcomes.append(self._outcome(self.of_design(first + k), point))
        if not first and all(row.trouble for row in self._rows.values()):
            raise InputErrors((self._rows[0].trouble,))
        return [self.outcomes[self._numbers[text]] for text in texts]

    @property
    def units(self) -> tuple[str, ...]:
        """Of the goals; "" before any design has a number."""
        return tuple(self._units.get(one.name, "") for one in self._search.goals)

    @property
    def left(self) -> int:
        """How many more designs may be tried."""
        return self._search.runs // self._search.samples - len(self.outcomes) - self.kept_back

    def known(self, point: Floats) -> DesignOutcome | None:
        """The outcome of a design that was tried, else None."""
        number = self._numbers.get(self._texts(point))
        return None if number is None else self.outcomes[number]

    def rank(self, k: int) -> tuple[float, float]:
        """The least is the best: those that hold all limits first, by their goal."""
        return self.outcomes[k].beyond, self.outcomes[k].small

    @property
    def best(self) -> int:
        """Number of the best design."""
        return min(range(len(self.outcomes)), key=self.rank)

    def samples(self) -> Samples:
        """All runs as samples: what was chosen, then what scatters."""
        varied = (*self._search.designs, *self._search.over)
        columns = [at(one, np.array([point[j] for point in self.points])) for j, one in enumerate(self._search.designs)]
        s, scattered = self._search.samples, _samples(self._search)
        texts = [own + more for own in zip(*(column[0] for column in columns), strict=True) for more in self._scatter]
        chosen = np.repeat(np.column_stack([column[1] for column in columns]), s, axis=0)
        beside = [] if scattered is None else [np.tile(scattered.numbers, (len(self.points), 1))]
        numbers = np.column_stack([chosen, *beside])
        return Samples(tuple(one.path for one in varied), tuple(one.unit for one in varied), tuple(texts), numbers)

    def rows(self) -> list[Row]:
        """The rows of all runs, by their numbers; not those of what is written."""
        most = len(self.outcomes) * self._search.samples
        return [self._rows[number] for number in range(most)]

    def of_design(self, k: int) -> list[Row]:
        """The rows of a design, one for each sample of what scatters."""
        s = self._search.samples
        return [self._rows[k * s + j] for j in range(s)]

    def as_written(self, cases: Sequence[str]) -> list[list[Row]]:
        """The rows of cases with what scatters and nothing chosen; they are none of the runs that are allowed, and have
        numbers below zero."""
        s, over = self._search.samples, self._search.over
        requested = {
            -1 - k * s - j: (case, *(f"{one.path}={text}" for one, text in zip(over, texts, strict=True)))
            for k, case in enumerate(cases)
            for j, texts in enumerate(self._scatter)
        }
        self._finish(requested)
        return [[self._rows[-1 - k * s - j] for j in range(s)] for k in range(len(cases))]

    def goals_of(self, rows: Sequence[Row]) -> tuple[float, tuple[float, float], Floats]:
        """The first goal of rows over what scatters: its quantile, its least and largest, and the values themselves,
        nan where there is none."""
        one = self._search.goals[0]
        values = np.array([_finer(row, one.name).value if one.name in row.numbers else np.nan for row in rows])
        return one.sign * self._quantile((one.sign * values).tolist()), (values.min(), values.max()), values

    def _texts(self, point: Floats) -> tuple[str, ...]:
        return tuple(at(one, point[j : j + 1])[0][0] for j, one in enumerate(self._search.designs))

    def _changes(self, texts: Sequence[str]) -> tuple[str, ...]:
        varied = (*self._search.designs, *self._search.over)
        return tuple(f"{one.path}={text}" for one, text in zip(varied, texts, strict=True))

    def _finish(self, requested: Mapping[int, tuple[str, ...]]) -> None:
        """Have the rows of samples, each a case and texts of it: those that are known, the others run and kept."""
        file, overrides = self._search.file, self._search.overrides
        known = {number: self._known[texts] for number, texts in requested.items() if texts in self._known}
        self._rows |= {number: replace(row, sample=number) for number, row in known.items()}
        left = {number: texts for number, texts in requested.items() if number not in self._rows}
        tasks = [Task(file, overrides, texts[0], ((number, texts[1:]),)) for number, texts in left.items()]

        def keep(rows: list[Row]) -> None:
            numbered = [replace(row, design=left[row.sample]) for row in rows]
            self._rows |= {row.sample: row for row in self._journal.append(numbered)}
            self._told(counted())

        def counted() -> int:
            return sum(number >= 0 for number in self._rows)

        self._run(tasks, keep, lambda: self._told(counted()))

    def _outcome(self, rows: Sequence[Row], point: Floats) -> DesignOutcome:
        search, goals = self._search, self._search.goals
        table = [self._of_goal(one.name, rows, point) for one in goals]
        smalls = tuple(
            self._quantile([one.sign * value for value in own]) for one, own in zip(goals, table, strict=True)
        )
        limited = tuple(self._limited(name, rows) for name in search.limits)
        excess = tuple(
            NOT_AT_REST if name == SETTLED and np.isnan(value) else (value - limit) / abs(limit or 1.0)
            for (name, limit), value in zip(search.limits.items(), limited, strict=True)
        )
        if any(row.trouble for row in rows):
            excess = (np.nan,) * len(excess)
        none, m = (np.nan,) * len(goals), len(excess)
        if any(row.severe or row.trouble for row in rows) or not np.isfinite((*smalls, *excess)).all():
            return DesignOutcome(
                none, (NEVER,) * len(goals), (NEVER,) * m, limited, tuple(zip(none, none, strict=True)), False
            )
        signed = tuple(one.sign * small for one, small in zip(goals, smalls, strict=True))
        return DesignOutcome(signed, smalls, excess, limited, tuple((min(own), max(own)) for own in table), sound=True)

    def _of_goal(self, name: str, rows: Sequence[Row], point: Floats) -> list[float]:
        """A goal in the rows of a design: a number of theirs, or what was chosen for a path."""
        for j, one in enumerate(self._search.designs):
            if one.path == name:
                self._units[name] = one.unit
                return [float(at(one, point[j : j + 1])[1][0])] * len(rows)
        return [self._number(row, name).value for row in rows]

    def _limited(self, name: str, rows: Sequence[Row]) -> float:
        """What a limit is compared with, as a run does it: a rating as it is rounded, of several places that are struck
        the worst; a time to rest that the window ends before is longer than all others, and nan where the quantile is
        such a one."""
        values = np.array([self._number(row, name, judged=True).value for row in rows])
        if name == SETTLED:
            values[np.isnan(values)] = np.inf
        return quantiles_of(values, (self._search.quantile,))[0]

    def _quantile(self, values: Sequence[float]) -> float:
        """Of what scatters, the value that the asked share of it does not exceed."""
        return float(np.quantile(values, self._search.quantile)) if len(values) > 1 else values[0]

    def _number(self, row: Row, name: str, *, judged: bool = False) -> Number:
        if row.trouble:
            return Number(np.nan, "")
        if name not in row.numbers and name in self._seen:
            return Number(np.nan, "")  # this design has no such number, as of a mode that it has not
        if name not in row.numbers:
            goal = next((one for one in self._search.goals if one.name == name), None)
            where = "optimise.limits" if goal is None else f"optimise.{goal.sense}"
            main = [one for one in row.numbers if APART not in one]
            paths = [one.path for one in self._search.designs] if goal is not None else []
            expected = f"a number of the case '{row.case}'" + (" or a path that may be chosen" if paths else "")
            do = (
                near_one(name, [*row.numbers, *paths])
                or f"it has {', '.join(main[:MOST])}; --case chooses another case"
            )
            raise InputError(where, got=f"'{name}'", expected=expected, do=do)
        self._refuse_other_dimension(name, row.numbers[name].unit)
        self._seen.add(name)
        if name in (one.name for one in self._search.goals):
            self._units[name] = row.numbers[name].unit
        return row.numbers.get(value_name(name), row.numbers[name]) if judged else _finer(row, name)

    def _refuse_other_dimension(self, name: str, unit: str) -> None:
        """A limit in kg of what is a length is a slip."""
        written = self._search.limit_dimensions.get(name)
        if written is None or name in self._seen:
            return
        try:
            quantity(f"1 {unit}" if unit else 1.0, written)
            fits = bool(unit) or written == "ratio"
        except QuantityError:
            fits = False
        if not fits:
            got, expected = DIMENSIONS[written].words, f"a number of '{name}' [{unit or '1'}]"
            raise InputError(f"optimise.limits.{name}", got=got, expected=expected, do="correct its unit")


def _finer(row: Row, name: str) -> Number:
    """A number before it is rounded: a rounded one says nothing of small changes."""
    return row.numbers.get(name + UNROUNDED, row.numbers[name])


def _samples(search: Search) -> Samples | None:
    """What scatters, the same for every design."""
    if not search.over:
        return None
    return samples_of(Campaign(search.file, search.over, Sampling("latin hypercube", search.scatter, search.seed)))


def _scatter(search: Search) -> tuple[tuple[str, ...], ...]:
    found = _samples(search)
    return ((),) if found is None else found.texts
