"""What a study varies, as it is written: lists and steps of values, scatter, and how many samples are made of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Final, Literal

import numpy as np
from pydantic import BeforeValidator, Field

from femstruct.errors import InputError, quote_value
from femstruct.quantities import Measured, Quantity, refuse
from femstruct.study.campaigns import Listed, Sampling, Scattered
from femstruct.study.optima import Goal
from femstruct.units import DIMENSIONS, QuantityError, quantity_of
from femstruct.yaml.reader import Here, nearest
from femstruct.yaml.spec import Count, Spec, Text, read_by, so_many

KINDS: Final = ("from", "values", "normal", "uniform")
EXAMPLE: Final = "write it like 50 g"


def _quantity(value: object) -> object:
    """A number with any unit there is."""
    if isinstance(value, Measured):
        return value
    try:
        return Measured(*quantity_of(value, tuple(DIMENSIONS)))
    except QuantityError as error:
        got = error.got.partition(", which is")[0]
        raise refuse(got, "a number with its unit", EXAMPLE) from None


_pair = so_many(_quantity, (2,), "two numbers [from, to]", "write it like [25 GPa, 35 GPa]")


def _values(value: object) -> object:
    if not isinstance(value, list) or not value:
        raise refuse(
            "an empty list" if value == [] else quote_value(value), "a list of values", "write it like [180 mm, 200 mm]"
        )
    return value


AnyQuantity = Annotated[Measured, read_by(_quantity, float | str)]
Bounds = Annotated[tuple[Measured, Measured], read_by(_pair, list[float | str])]
Values = Annotated[list[Any], read_by(_values, list[Any])]


class NormalSpec(Spec):
    """A normal distribution; a deviation in percent is of the mean."""

    mean: AnyQuantity
    sd: AnyQuantity

    def scattered(self, path: str) -> Scattered:
        """The noun. Raises InputError for a mean and a deviation of different dimensions, and for both in percent: of
        what is not clear."""
        mean, sd = self.mean, self.sd
        if sd.dimension == mean.dimension == "ratio":
            percent = f"{100.0 * sd.value:g} %"
            got = f"a mean and a deviation in percent, {100.0 * mean.value:g} % and {percent}"
            of_mean = f"'sd: {sd.value * abs(mean.value):g}' for {percent} of the mean"
            do = f"write {of_mean}, or 'sd: {sd.value:g}' for a deviation of {percent}"
            raise InputError(f"vary.{path}", got=got, expected="a deviation as a plain number", do=do)
        if sd.dimension == "ratio" and mean.dimension != "ratio":
            return Scattered(path, "normal", mean.value, sd.value * abs(mean.value), _unit(f"vary.{path}", mean))
        return Scattered(path, "normal", mean.value, sd.value, _unit(f"vary.{path}", mean, sd))


class VarySpec(Spec):
    """The values that a number of the files takes: in steps from one to another, a list, or a distribution."""

    one_of = (KINDS,)
    only_with = (("from", ("to",)), ("to", ("from",)), ("steps", ("from",)), ("scale", ("from",)))
    start: AnyQuantity | None = Field(default=None, alias="from")
    to: AnyQuantity | None = None
    steps: Count | None = None
    scale: Literal["linear", "log"] | None = None
    values: Values | None = None
    normal: NormalSpec | None = None
    uniform: Bounds | None = None

    def varied(self, path: str) -> Listed | Scattered:
        """The noun. Raises InputError for bounds of different dimensions, and what the noun refuses."""
        where = f"vary.{path}"
        if self.values is not None:
            return _listed(path, self.values)
        if self.normal is not None:
            return self.normal.scattered(path)
        if self.uniform is not None:
            one, other = self.uniform
            return Scattered(path, "uniform", one.value, other.value, _unit(where, one, other))
        assert self.start is not None and self.to is not None
        unit, log = _unit(where, self.start, self.to), self.scale == "log"
        low, high = self.start.value, self.to.value
        if self.steps is None:
            return Scattered(path, "log-uniform" if log else "uniform", low, high, unit)
        if log and not min(low, high) > 0.0:
            raise InputError(where, got=f"{min(low, high):g} on a logarithmic scale", expected="a positive number")
        between = np.geomspace(low, high, self.steps) if log else np.linspace(low, high, self.steps)
        numbers = tuple(float(f"{one:.15g}") for one in between)  # 0.02, not 0.019999999999999997
        if len(set(numbers)) < len(numbers):
            raise InputError(where, got=f"{self.steps} steps from {low:g} to {high:g}", expected="different values")
        return Listed(path, tuple(written(one, unit) for one in numbers), numbers, unit)


class SamplesSpec(Spec):
    """How many samples are made of what varies, and how; without a count each value with each. Only: numbers that a row
    holds; where the batch engine has all of them, thousands of samples take seconds."""

    only_with = (("method", ("count",)), ("seed", ("count",)))
    method: Literal["latin hypercube", "sobol", "sobol indices"] | None = None
    count: Count | None = None
    seed: Count | None = None
    only: list[Text] = Field(default_factory=list)

    def sampling(self) -> Sampling:
        """How samples are made. Raises what the noun refuses."""
        if self.count is None:
            return Sampling()
        return Sampling(self.method or "latin hypercube", self.count, self.seed or 1)


def varied_of(specs: Mapping[str, VarySpec], here: Here) -> dict[str, Listed | Scattered]:
    """The nouns of all paths under `vary:` of a mapping, by path; those refused are noted and left out."""
    return here.each("vary", specs, lambda there, path, one: one.varied(path))


def written(number: float, unit: str) -> str:
    """A number in SI units as a file writes it, to its last digit.

    >>> written(0.05, "kg"), written(0.3, "1"), written(2.0, "")
    ('0.05 kg', '0.3', '2.0')
    """
    return repr(number) if unit in ("", "1") else f"{number!r} {unit}"


def _listed(path: str, values: list[Any]) -> Listed:
    """Values as they stand; numbers, too, where all are of one dimension."""
    texts = tuple(_text(one) for one in values)
    twice = next((text for number, text in enumerate(texts) if text in texts[:number]), None)
    if twice is not None:
        raise InputError(f"vary.{path}", got=f"{twice} twice", expected="each value once", do="remove one of them")
    try:
        found = [Measured(*quantity_of(one, tuple(DIMENSIONS))) for one in values]
    except QuantityError:
        return Listed(path, texts)
    _refuse_without_unit(f"vary.{path}", found)
    try:
        unit = _unit(path, *found)
    except InputError:
        return Listed(path, texts)
    return Listed(path, texts, tuple(one.value for one in found), unit)


def _refuse_without_unit(where: str, several: Sequence[Measured]) -> None:
    """Raise InputError for a plain number beside numbers with a unit, as a decimal comma makes it; 0 has no need of
    one."""
    plain = [one.value for one in several if one.dimension is None and one.value]
    with_unit = [one.dimension for one in several if one.dimension not in (None, "ratio")]
    if with_unit and plain:
        got = f"{plain[0]:g} without a unit beside {DIMENSIONS[with_unit[0]].words}"
        unit = DIMENSIONS[with_unit[0]].unit
        do = f"values are separated by commas, decimals by a point, as 1.5 {unit}; write {plain[0]:g} with its unit"
        raise InputError(where, got=got, expected="a unit with every value, or with none", do=do)


def _text(value: Any) -> str:
    """A value in the flow style of YAML.

    >>> _text([2.0, "1.5 m"]), _text({"a": 1}), _text("50 g"), _text(None)
    ('[2.0, 1.5 m]', '{a: 1}', '50 g', 'null')
    """
    if isinstance(value, list):
        return f"[{', '.join(map(_text, value))}]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_text(one)}" for key, one in value.items()) + "}"
    if value is None:
        return "null"
    return ("true" if value else "false") if isinstance(value, bool) else str(value)


def _unit(where: str, *several: Measured) -> str:
    """The unit of numbers that all have one dimension; 0 has that of the others."""
    _refuse_without_unit(where, several)
    known = {one.dimension for one in several} - {None}
    if len(known) > 1:
        words = " and ".join(DIMENSIONS[one].words for one in sorted(filter(None, known)))
        raise InputError(where, got=words, expected="numbers of one dimension", do="correct a unit")
    return DIMENSIONS[known.pop() or ""].unit if known else ""


# ----------------------------------------------------------------------------------------------------------------------
# What a study optimises, as it is written.
# ----------------------------------------------------------------------------------------------------------------------

Quantile = Annotated[float, Quantity(("ratio",), above=0.0, below=1.0)]


class RobustSpec(Spec):
    """What scatters and cannot be chosen: paths under `vary:` with a distribution, and for which share of it goal and
    limits are to hold."""

    over: list[Text]
    quantile: Quantile = 0.9
    samples: Count = 10


def _names(value: object) -> object:
    """One name as a list of one."""
    if not isinstance(value, str | list):
        raise refuse(
            quote_value(value),
            "the name of a number, or a list of names",
            "write it like [bodies.damper.mass, ground force]",
        )
    return [value] if isinstance(value, str) else value


Names = Annotated[list[Text], BeforeValidator(_names, json_schema_input_type=str | list[str])]


class OptimiseSpec(Spec):
    """A number that is to be small or large, or up to three, what may be chosen for it, and what other numbers should
    not exceed."""

    minimise: Names = Field(default_factory=list)
    maximise: Names = Field(default_factory=list)
    vary: dict[str, VarySpec] = Field(default_factory=dict)
    limits: dict[str, AnyQuantity] = Field(default_factory=dict)
    robust: RobustSpec | None = None
    case: Text | None = None
    runs: Count = 400
    seed: Count = 1

    def goals(self) -> tuple[Goal, ...]:
        """All goals, those that are to be small first. Raises InputError where there is none."""
        found = tuple(Goal(name, "minimise") for name in self.minimise)
        found += tuple(Goal(name, "maximise") for name in self.maximise)
        if not found:
            raise InputError(
                "optimise",
                got="none of minimise, maximise",
                expected="one or both of them",
                do="write it like 'minimise: ground force' or 'minimise: [bodies.damper.mass, ground force]'",
            )
        return found

    def scattering(self, varied: Mapping[str, Listed | Scattered]) -> tuple[Listed | Scattered, ...]:
        """What scatters, of all that varies. Raises InputError for a path that does not."""
        found = []
        for path in self.robust.over if self.robust else ():
            if path not in varied:
                do = nearest(path, varied) if varied else "add it under 'vary:'"
                raise InputError("optimise.robust.over", got=f"'{path}'", expected="a path under 'vary:'", do=do)
            found.append(varied[path])
        return tuple(found)

    def robustness(self) -> dict[str, Any]:
        """Quantile and samples, where something scatters."""
        return {} if self.robust is None else {"quantile": self.robust.quantile, "scatter": self.robust.samples}


class CampaignSpec(Spec):
    """What of a study file concerns many runs of it."""

    vary: dict[str, VarySpec] = Field(default_factory=dict)
    samples: SamplesSpec | None = None
    optimise: OptimiseSpec | None = None

    def check_campaign(self, here: Here) -> None:
        """Note what cannot vary as it is written."""
        varied = varied_of(self.vary, here)
        if self.optimise is not None:
            asked, there = self.optimise, here.at("optimise")
            varied_of(asked.vary, there)
            there.at("robust", "over").make(lambda: asked.scattering(varied))
