"""What a campaign varies, the rows that came of it, how far numbers scatter and who makes them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import nan, sqrt
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats, freeze, frozen_with_gaps
from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.study.asked import SETTLED
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# What a campaign varies: numbers of the files by their paths, the values that each takes, how they are combined.
# ----------------------------------------------------------------------------------------------------------------------

MOST_SAMPLES: Final = 100_000
INDICES: Final = "sobol indices"


@stored_as("listed values/1")
@dataclass(frozen=True)
@checked("vary")
class Listed:
    """Listed values of what a path names.

    path : of a study or its model, such as "bodies.damper.mass". texts : the values as a file writes them. numbers :
    the same in SI units, of `unit`; none where they are words or lists.

    >>> Listed("bodies.damper.mass", ("50 g", "100 g"), (0.05, 0.1), "kg").unit
    'kg'
    """

    path: str
    texts: tuple[str, ...]
    numbers: tuple[float, ...] = ()
    unit: str = ""

    def __post_init__(self) -> None:
        if not self.texts:
            raise InputError(f"vary.{self.path}", got="no value", expected="one or more")
        if self.numbers and len(self.numbers) != len(self.texts):
            raise InputError(
                f"vary.{self.path}", got=f"{len(self.numbers)} numbers", expected=f"{len(self.texts)}, one a text"
            )


@stored_as("scattered values/1")
@dataclass(frozen=True)
@checked("vary")
class Scattered:
    """A number that is not known better than by a distribution.

    law : uniform between first and second; log-uniform, likewise on a logarithmic scale; normal, of mean first and
    standard deviation second. first, second : in SI units, of `unit`.

    Raises InputError for bounds that do not rise, a deviation that is not positive, and bounds of a logarithmic scale
    that are not positive.

    >>> Scattered("materials.concrete.E", "normal", 30e9, 1.5e9, "Pa").law
    'normal'
    """

    path: str
    law: Literal["uniform", "log-uniform", "normal"]
    first: float
    second: float
    unit: str = ""

    def __post_init__(self) -> None:
        where = f"vary.{self.path}"
        if self.law == "normal":
            if not self.second > 0.0:
                raise InputError(where, got=f"a deviation of {self.second:g}", expected="a positive one")
        elif not self.first < self.second:
            got = f"{self.first:g} to {self.second:g} {self.unit}".strip()
            raise InputError(where, got=got, expected="rising bounds")
        elif self.law == "log-uniform" and not self.first > 0.0:
            raise InputError(where, got=f"{self.first:g} on a logarithmic scale", expected="a positive number")


@dataclass(frozen=True)
@checked("samples")
class Sampling:
    """How the values of several paths are combined: each with each, or in as many samples as are asked for.

    method : "grid", each listed value with each; "latin hypercube" or "sobol" (scrambled), which fill the range of all
    evenly; "sobol indices", samples from which the shares of all paths in the variance follow, count (p + 2) of them
    for p paths. count : of samples, for the indices a power of two; None for a grid. seed : the same one gives the same
    samples.

    >>> Sampling("latin hypercube", 64).seed
    1
    """

    method: Literal["grid", "latin hypercube", "sobol", "sobol indices"] = "grid"
    count: int | None = None
    seed: int = 1

    def __post_init__(self) -> None:
        if (self.method == "grid") != (self.count is None):
            got = "a count for a grid" if self.count is not None else f"no count for {self.method}"
            raise InputError("samples.count", got=got, expected="a count for samples, none for a grid")
        if self.count is not None and not 0 < self.count <= MOST_SAMPLES:
            raise InputError("samples.count", got=f"{self.count}", expected=f"1 to {MOST_SAMPLES}")
        if self.method == INDICES and self.count is not None and self.count & (self.count - 1):
            near = 1 << self.count.bit_length()
            got, expected = f"{self.count} for {INDICES}", "a power of two"
            raise InputError("samples.count", got=got, expected=expected, do=f"write {near // 2} or {near}")


@dataclass(frozen=True)
@checked("campaign")
class Campaign:
    """A study file, and what is varied in it and in its model.

    file : of the study. overrides : texts ``PATH=VALUE`` for all samples. case : the only one to run, "" for all.
    only : names of the numbers that a row holds, none for all of them.

    Two masses of a damper; `femstruct.sweep` runs them:

    >>> Campaign("hit.study.yaml", (Listed("bodies.damper.mass", ("50 g", "100 g")),)).sampling.method
    'grid'
    """

    file: str
    varied: tuple[Listed | Scattered, ...]
    sampling: Sampling = Sampling()
    overrides: tuple[str, ...] = ()
    case: str = ""
    title: str = ""
    only: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.varied:
            raise InputError("vary", got="nothing that varies", expected="one or more paths")
        paths = [one.path for one in self.varied]
        twice = next((path for path in paths if paths.count(path) > 1), None)
        if twice is not None:
            raise InputError(f"vary.{twice}", got="a path that varies twice", expected="each path once")
        scattered = next((one for one in self.varied if isinstance(one, Scattered)), None)
        if self.sampling.method == "grid" and scattered is not None:
            normal = scattered.law == "normal"
            got = "a distribution without a number of samples" if normal else "a range without steps"
            steps = "" if normal else "'steps: 10' to a 'from .. to', or "
            do = f"add {steps}'samples: {{count: 64}}' to the study, or --samples 64"
            raise InputError(f"vary.{scattered.path}", got=got, expected="steps, values or samples", do=do)
        size = 1
        for one in self.varied:
            size *= len(one.texts) if isinstance(one, Listed) else 1
        if self.sampling.method == INDICES and self.sampling.count is not None:
            size = self.sampling.count * (len(self.varied) + 2)
        if size > MOST_SAMPLES and self.sampling.method in ("grid", INDICES):
            raise InputError("vary", got=f"{size:.3g} samples", expected=f"at most {MOST_SAMPLES}")


# ----------------------------------------------------------------------------------------------------------------------
# What came of a campaign: a row of numbers for every sample and case.
# ----------------------------------------------------------------------------------------------------------------------

UNROUNDED: Final = " before rounding"  # ends the name of a number of which the standard states a rounded one
MET, EXCEEDED, UNKNOWN = 1.0, 0.0, -1.0  # verdicts as numbers of a row
_LIMITS: Final = "limits / "  # begins the names of limits and verdicts, which are numbers of a row too
Flags = NDArray[np.bool_]


@stored_as("rows of a campaign/1")
@dataclass(frozen=True, eq=False)
class Swept:
    """Rows of n samples and c cases, with k numbers each, in SI units and dB.

    paths, units [p] : what varied. texts [n][p] : its values as a file writes them; values [n, p] : as numbers, nan for
    words and lists. method : how the samples were combined, as `Sampling` has it.
    cases [c], baseline. names, number_units [k] : of the numbers. main : how many of them, from the first on, are asked
    for first. numbers [c, n, k] : nan where there is none.
    done [n] : False for samples that were not run. severe [c][n], findings [c][n] : codes of those that forbid trust in
    a row, and of all. trouble [n] : why a sample has no numbers, "" where it has.
    limits : of the baseline in the first sample, by the name of the number that should not exceed it; rows have their
    own, `limit_name` and `verdict_name`. sources : the files of the study
    verbatim, by name. provenance : of the campaign. made : how rows were made, "" for full runs.

    `xarray.open_dataset("sweep.h5", engine="h5netcdf")` is the same as a labelled table.
    """

    title: str
    paths: tuple[str, ...]
    units: tuple[str, ...]
    texts: tuple[tuple[str, ...], ...]
    values: Floats
    method: str
    cases: tuple[str, ...]
    baseline: str
    names: tuple[str, ...]
    number_units: tuple[str, ...]
    main: tuple[str, ...]
    numbers: Floats
    done: Flags
    severe: tuple[tuple[tuple[str, ...], ...], ...]
    findings: tuple[tuple[tuple[str, ...], ...], ...]
    trouble: tuple[str, ...]
    limits: Mapping[str, float] = field(default_factory=dict)
    sources: Mapping[str, str] = field(default_factory=dict)
    provenance: Mapping[str, str] = field(default_factory=dict)
    made: str = ""

    def __post_init__(self) -> None:
        n, c = len(self.texts), len(self.cases)
        freeze(
            self,
            values=frozen_with_gaps("sweep values", self.values, (n, len(self.paths))),
            numbers=frozen_with_gaps("sweep numbers", self.numbers, (c, n, len(self.names))),
        )

    @property
    def drawn(self) -> bool:
        """Whether the samples are drawn from distributions, and not chosen."""
        return self.method != "grid"

    def of(self, name: str, case: str = "") -> Floats:
        """A number of all samples [n] by its name, in the baseline or another case.

        Raises InputError for a name or a case that is not there.
        """
        if name not in self.names:
            raise InputError("results", got=f"'{name}'", expected="a number of the study", do=self._near(name))
        case = case or self.baseline
        if case not in self.cases:
            raise InputError("case", got=f"'{case}'", expected=f"one of {', '.join(self.cases)}")
        return self.numbers[self.cases.index(case), :, self.names.index(name)]

    def of_or_nan(self, name: str, case: str) -> Floats:
        """A number of all samples [n] of a case; nan where there is none of this name at all."""
        return self.of(name, case) if name in self.names else np.full(len(self.texts), np.nan)

    def trusted(self, case: str = "") -> Flags:
        """Whether the row of a sample was run and has no finding that forbids trust [n]."""
        at = self.cases.index(case or self.baseline)
        sound = np.array([not codes for codes in self.severe[at]])
        fine: Flags = self.done & sound & np.array([not one for one in self.trouble])
        return fine

    def unit_of(self, name: str) -> str:
        """The unit of a number."""
        return self.number_units[self.names.index(name)]

    def finer(self, names: Sequence[str]) -> list[str]:
        """These numbers, each that is rounded with itself before rounding after it.

        Raises InputError for a name that is not there.
        """
        both = [one for name in names if self.of(name) is not None for one in (name, name + UNROUNDED)]
        return [name for name in dict.fromkeys(both) if name in self.names]

    def _near(self, name: str) -> str:
        import difflib

        near = difflib.get_close_matches(name, self.names, n=1, cutoff=0.5)
        return f"did you mean '{near[0]}'?" if near else f"known here: {', '.join(self.main)}"


def limit_name(name: str) -> str:
    """The name of what a number should not exceed in a row.

    >>> limit_name("settled"), verdict_name("settled"), is_of_limit(limit_name("settled"))
    ('limits / settled / limit', 'limits / settled / verdict', True)
    """
    return f"{_LIMITS}{name} / limit"


def value_name(name: str) -> str:
    """The name of what a limit is compared with in a row: of several places that are struck the worst; nan where the
    run cannot tell."""
    return f"{_LIMITS}{name} / value"


def verdict_name(name: str) -> str:
    """The name of the verdict on a limit in a row: 1 met, 0 exceeded, -1 where the run cannot tell."""
    return f"{_LIMITS}{name} / verdict"


def is_of_limit(name: str) -> bool:
    """Whether a name of a row is that of a limit or a verdict."""
    return name.startswith(_LIMITS)


def independent(rows: Swept) -> Flags:
    """The samples that are independent of each other [n]: of those for indices the first two tables."""
    n = len(rows.texts)
    return np.arange(n) < (2 * n // (len(rows.paths) + 2) if rows.method == INDICES else n)


# ----------------------------------------------------------------------------------------------------------------------
# What drawn samples tell of a number: how far it scatters, and what it follows.
# ----------------------------------------------------------------------------------------------------------------------

LEVELS: Final = (0.05, 0.5, 0.95)  # of the quantiles that are told
ROUNDING: Final = 1e-9  # of a number: differences below are none
FEWEST: Final = 8  # samples, below which nothing is said of a distribution
_HUGE: Final = 1e300  # in place of infinity, of which quantiles have none
_INFINITE: Final = 1e250  # what a quantile beside it is above


@dataclass(frozen=True)
class Spread:
    """How a number scatters over the samples that are to be trusted.

    above : the case whose own number is taken off, sample by sample, "" for none. count of samples; left_out : because
    of findings that forbid trust, or without a number. longer : how many of the count have no time to rest, since the
    window ends before; they are longer than all others. mean, deviation : of the samples, nan where some are longer.
    quantiles : 5, 50 and 95 %, nan where it is one of those. follows : rank correlation with each path that varies
    (Spearman), nan for words and for what is constant.
    """

    name: str
    unit: str
    case: str
    above: str
    count: int
    left_out: int
    longer: int
    mean: float
    deviation: float
    quantiles: tuple[float, float, float]
    follows: tuple[float, ...]


def spread(rows: Swept, name: str, case: str = "", above: str = "") -> Spread | None:
    """How a number of a case scatters, or what it is above that of another case, sample by sample.

    Parameters
    ----------
    above : str
        The other case; a difference of two cases has a scatter of its own, often much smaller than that of either.

    Returns
    -------
    Spread | None
        None for fewer than 8 samples that are to be trusted, and for a difference of times to rest of which some are
        not seen.

    Raises
    ------
    InputError
        For unknown names.

    Examples
    --------
    The velocity of a mass that a ball of uncertain mass hits:

    >>> import tempfile
    >>> from pathlib import Path
    >>> import femstruct as fs
    >>> model = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\\npoints: {m: {}}"
    >>> study = '''
    ... model: model.yaml
    ... bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
    ... record: {m.z: velocity}
    ... time: {duration: 10 ms, sampling: 10 kHz}
    ... vary: {bodies.ball.mass: {normal: {mean: 1 kg, sd: 10 %}}}
    ... samples: {count: 16}
    ... '''
    >>> with tempfile.TemporaryDirectory() as place:
    ...     _ = Path(place, "model.yaml").write_text(model, encoding="utf-8")
    ...     _ = Path(place, "hit.study.yaml").write_text(study, encoding="utf-8")
    ...     rows = fs.sweep(fs.read_campaign(Path(place, "hit.study.yaml")), workers=1)
    >>> found = spread(rows, "m.z velocity")
    >>> round(found.mean, 2), round(found.deviation, 2), round(found.follows[0], 3)
    (1.0, 0.05, 1.0)
    """
    case = case or rows.baseline
    values, sound = rows.of(name, case), rows.trusted(case)
    if above:
        values, sound = values - rows.of(name, above), sound & rows.trusted(above)
    sound = sound & independent(rows)
    longer = sound & np.isnan(values) & (name == SETTLED)
    known = sound & (np.isfinite(values) | longer)
    own = np.where(longer, _HUGE, values)[known]
    many = bool(longer.any())
    if len(own) < FEWEST or (many and (above or longer[known].all())):
        return None
    low, middle, high = quantiles_of(own, LEVELS)
    return Spread(
        name=name,
        unit=rows.unit_of(name),
        case=case,
        above=above,
        count=len(own),
        left_out=int((rows.done & independent(rows)).sum()) - len(own),
        longer=int(longer.sum()),
        mean=nan if many else float(own.mean()),
        deviation=nan if many else float(own.std(ddof=1)),
        quantiles=(low, middle, high),
        follows=tuple(_rank_correlation(column[known], own) for column in rows.values.T),
    )


def quantiles_of(values: Floats, shares: Sequence[float]) -> tuple[float, ...]:
    """Quantiles of values [n], of which some may be infinite; nan for those that are.

    >>> quantiles_of(np.array([1.0, 2.0, 3.0, np.inf, np.inf]), (0.5, 0.9))
    (3.0, nan)
    """
    found = np.quantile(np.minimum(values, _HUGE), shares)
    return tuple(float(one) if one < _INFINITE else nan for one in found)


def _rank_correlation(x: Floats, y: Floats) -> float:
    from scipy.stats import spearmanr

    if not np.isfinite(x).all() or np.ptp(x) == 0.0 or np.ptp(y) <= ROUNDING * np.abs(y).max():
        return nan
    return float(spearmanr(x, y).statistic)


# ----------------------------------------------------------------------------------------------------------------------
# Who makes a number scatter: the share of each path that varies in its variance, alone and with the others.
# ----------------------------------------------------------------------------------------------------------------------

FEWEST_OF_TABLES: Final = 8  # samples of each table
DRAWN_AGAIN: Final = 500  # times, for the intervals
SHARE: Final = 0.95  # of the intervals


@dataclass(frozen=True)
class Influence:
    """Sobol' indices of a path: the share of the variance that goes with it if it alone were known, and the share that
    is left if all others were known; each with the low and high end of its 95 % interval (bootstrap)."""

    path: str
    alone: tuple[float, float, float]
    total: tuple[float, float, float]


def influences(rows: Swept, name: str, case: str = "") -> tuple[Influence, ...]:
    """The indices of all paths, of samples for indices; none of others, or of a number that hardly varies.

    A sample of which one row is not to be trusted, or has no number, is left out with all rows that belong to it.

    Raises InputError for unknown names.

    Notes
    -----
    S_j = mean(f(B) (f(AB_j) - f(A))) / V, T_j = mean((f(A) - f(AB_j))^2) / (2 V), V the variance of f(A) and f(B);
    their errors fall with the root of the number of samples.

    References
    ----------
    Saltelli et al., Comput. Phys. Commun. 181 (2010) 259, doi:10.1016/j.cpc.2009.09.018, table 2 (b) and (f).

    The Ishigami function is in tests/unit/test_influence.py.
    """
    if rows.method != INDICES:
        return ()
    p = len(rows.paths)
    values, sound = rows.of(name, case).reshape(p + 2, -1), rows.trusted(case).reshape(p + 2, -1)
    values = values[:, (sound & np.isfinite(values)).all(axis=0)]
    if values.shape[1] < FEWEST_OF_TABLES or np.ptp(values) <= 1e-12 * np.abs(values).max():
        return ()
    alone, total = _indices(values[:, None, :])
    again = np.random.default_rng(1).integers(values.shape[1], size=(DRAWN_AGAIN, values.shape[1]))
    ends = [np.quantile(one, (0.5 - 0.5 * SHARE, 0.5 + 0.5 * SHARE), axis=1) for one in _indices(values[:, again])]
    return tuple(
        Influence(
            path,
            (float(alone[j, 0]), float(ends[0][0, j]), float(ends[0][1, j])),
            (float(total[j, 0]), float(ends[1][0, j]), float(ends[1][1, j])),
        )
        for j, path in enumerate(rows.paths)
    )


def _indices(values: Floats) -> tuple[Floats, Floats]:
    """First-order and total indices [p, r] of tables A, B, AB_1 .. AB_p [p + 2, r, n]."""
    a, b, mixed = values[0], values[1], values[2:]
    variance = np.concatenate([a, b], axis=-1).var(axis=-1)
    centred = b - np.concatenate([a, b], axis=-1).mean(axis=-1)[..., None]  # the mean adds noise, and nothing else
    alone = (centred * (mixed - a)).mean(axis=-1) / variance
    total = 0.5 * ((a - mixed) ** 2).mean(axis=-1) / variance
    return alone, total


# ----------------------------------------------------------------------------------------------------------------------
# In how many samples of a campaign a limit is held, exceeded, or cannot be judged.
# ----------------------------------------------------------------------------------------------------------------------

SURE: Final = 1.959963984540054  # standard deviations of a 95 % interval


@dataclass(frozen=True)
class HeldLimit:
    """What became of the limit of a number over the samples of a case that are to be trusted.

    limits : the smallest and the largest limit, which are one unless it varies. held, exceeded, unknown : how many
    samples; of the last the run cannot tell, such as of a rating some of whose bands are blank. share : of the samples
    that hold it [1], nan where some are unknown; low, high : its 95 % interval (Wilson) as far as they may be either.
    """

    name: str
    unit: str
    case: str
    limits: tuple[float, float]
    held: int
    exceeded: int
    unknown: int
    share: float
    low: float
    high: float

    @property
    def count(self) -> int:
        """All samples that it is of."""
        return self.held + self.exceeded + self.unknown


def held_limits(rows: Swept, names: Sequence[str]) -> Iterator[HeldLimit]:
    """What became of the limits of these numbers, by number and case; nothing of a case without the limit.

    Every sample is judged as its own run judges it: by the limit of its case and sample, of several places that are
    struck by the worst, and "not at rest in time" is an answer.

    >>> import tempfile
    >>> from pathlib import Path
    >>> import femstruct as fs
    >>> model = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\\npoints: {m: {}}"
    >>> study = '''
    ... model: model.yaml
    ... bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
    ... record: {m.z: velocity}
    ... limits: {m.z velocity: 1.2 m/s}
    ... time: {duration: 10 ms, sampling: 10 kHz}
    ... vary: {bodies.ball.mass: {values: [0.5 kg, 1 kg, 2 kg]}}
    ... '''
    >>> with tempfile.TemporaryDirectory() as place:
    ...     _ = Path(place, "model.yaml").write_text(model, encoding="utf-8")
    ...     _ = Path(place, "hit.study.yaml").write_text(study, encoding="utf-8")
    ...     rows = fs.sweep(fs.read_campaign(Path(place, "hit.study.yaml")), workers=1)
    >>> [(one.held, one.exceeded) for one in held_limits(rows, ["m.z velocity"])]
    [(2, 1)]
    """
    for name in names:
        for case in rows.cases:
            known = rows.trusted(case) & independent(rows)
            verdicts, limits = (rows.of_or_nan(each(name), case)[known] for each in (verdict_name, limit_name))
            if not np.isfinite(verdicts).any():
                continue
            held, exceeded = (int((verdicts == one).sum()) for one in (MET, EXCEEDED))
            unknown = int(known.sum()) - held - exceeded
            of = held + exceeded + unknown
            yield HeldLimit(
                name=name,
                unit=rows.unit_of(limit_name(name)),
                case=case,
                limits=(float(np.nanmin(limits)), float(np.nanmax(limits))),
                held=held,
                exceeded=exceeded,
                unknown=unknown,
                share=nan if unknown else held / of,
                low=wilson(held, of)[1],
                high=wilson(held + unknown, of)[2],
            )


def wilson(held: int, of: int) -> tuple[float, float, float]:
    """A share and its 95 % interval, which stays within 0 and 1 where all are held.

    References
    ----------
    Wilson, J. Am. Stat. Assoc. 22 (1927) 209, doi:10.1080/01621459.1927.10502953.

    >>> [round(one, 3) for one in wilson(10, 10)]
    [1.0, 0.722, 1.0]
    """
    share, square = held / of, SURE**2 / of
    middle = (share + 0.5 * square) / (1.0 + square)
    half = sqrt(share * (1.0 - share) * square + 0.25 * square**2) / (1.0 + square)
    return share, max(middle - half, 0.0), min(middle + half, 1.0)
