"""What a campaign varies: numbers of the files by their paths, the values that each takes, how they are combined."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

from femstruct.declared import checked
from femstruct.errors import InputError
from femstruct.tags import stored_as

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
