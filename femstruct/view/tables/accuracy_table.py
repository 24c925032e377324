"""How far the numbers of a case may be off, a line each: what more modes change, and what the steps leave."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from femstruct.errors import some_of
from femstruct.impact.estimate import ErrorEstimate, Resolved
from femstruct.impact.result.response import Outcome, Response
from femstruct.study.result import AccuracyCheck, StudyResult
from femstruct.units import readable

RESOLVED: Final = 1e-6  # share from which on an estimated error is of interest to whom measures to 1 %


def anything_meets(result: StudyResult) -> bool:
    """Whether a study has contacts; in one without, as of a walker, there is no first impact."""
    return any(case.response.contacts for case in result.cases.values() if case.response is not None)


def first_impact(result: StudyResult) -> str:
    """How long the first impact is whose peaks are told, in brackets; "" where cases differ."""
    rules = {case.case.study.peaks.first_impact for case in result.cases.values()}
    if len(rules) > 1:
        return ""
    window = rules.pop()
    return " (until a contact closes again)" if window is None else f" ({1e3 * window:.4g} ms)"


def outcomes(result: StudyResult) -> list[str]:
    """How the cases ended, those that ended alike on one line."""
    return _together(
        {name: _outcome(case.response) for name, case in result.cases.items() if case.response is not None},
        len(result.cases),
    )


def _outcome(response: Response) -> str:
    preloaded = response.outcome is Outcome.SEPARATED and any(one.preload > 0.0 for one in response.scene.contacts)
    return response.outcome.value + (" A preloaded one is open below its preload." if preloaded else "")


def trust(result: StudyResult) -> list[str]:
    """All cases by name: first what came of an asked accuracy, then the error estimates."""
    asked = [f"{name}: {accuracy(case.accuracy)}" for name, case in result.cases.items() if case.accuracy is not None]
    estimates = {
        name: case.errors for name, case in result.cases.items() if case.errors is not None and case.errors.peak
    }
    alike: dict[str, list[ErrorEstimate]] = {}
    for one in estimates.values():
        if _largest([one]) < RESOLVED:
            alike.setdefault(_against(one), []).append(one)
    told = {
        name: _all_small(one, alike[_against(one)]) if _largest([one]) < RESOLVED else errors(one)
        for name, one in estimates.items()
    }
    return asked + _together(told, len(result.cases))


def _all_small(one: ErrorEstimate, alike: Sequence[ErrorEstimate]) -> str:
    """One sentence for all cases that the march is done with for every purpose; their own numbers are in the files."""
    kind = "estimated error, rounding only" if one.exact else "estimated error of the steps"
    return f"{kind}: peak forces and end velocities at most {_largest(alike):.1e} off{_against(one)}"


def _largest(found: Sequence[ErrorEstimate]) -> float:
    """The largest share that any peak force or end velocity is wrong by."""
    return max(
        number.relative
        for one in found
        for numbers in (one.first_peak, one.peak, one.velocity)
        for number in numbers.values()
    )


def _against(found: ErrorEstimate) -> str:
    return "" if found.exact else f"; against a run at a tolerance of {found.against:.0e}"


def _together(told: Mapping[str, str], count: int) -> list[str]:
    """Sentences, each once, after the cases they hold for.

    >>> _together({"a": "It opened.", "b": "It opened.", "c": "It stuck."}, 3)
    ['a, b: It opened.', 'c: It stuck.']
    >>> _together({"a": "It opened.", "b": "It opened."}, 2)
    ['all cases: It opened.']
    """
    cases: dict[str, list[str]] = {}
    for name, sentence in told.items():
        cases.setdefault(sentence, []).append(name)
    return [
        f"{'all cases' if 1 < count == len(names) else some_of(names)}: {sentence}" for sentence, names in cases.items()
    ]


def accuracy(check: AccuracyCheck) -> str:
    """What more modes still change, and which are used."""
    if check.worst is None:
        return "accuracy: the basis contains all modes"
    name, worst = check.worst
    factor, unit = readable(worst.unit, max(worst.smaller, worst.larger))
    return (
        f"accuracy: {name} {factor * worst.smaller:.4g} / {factor * worst.larger:.4g} {unit} with the modes up to "
        f"{check.smaller_hz:.5g} / {check.larger_hz:.5g} Hz, at most {100 * worst.share:.2g} % apart in "
        f"{check.band[0]:g} to {check.band[1]:g} Hz until {1e3 * check.window:.4g} ms; {100 * check.within:g} % "
        "required; "
        f"used: {check.used_modes} modes up to {check.used_hz:.5g} Hz"
    )


def errors(found: ErrorEstimate) -> str:
    """What the march may leave the worst peak force and the worst end velocity wrong by, as shares."""
    first, whole, speed = (_worst(numbers) for numbers in (found.first_peak, found.peak, found.velocity))
    forces = f"peak forces {whole}"
    if first and first != whole:
        forces = f"peak forces {first} until {1e3 * found.first_until:.4g} ms, {whole} in all"
    speeds = f", end velocities {speed}" if speed else ""
    if found.exact:
        return f"estimated error, rounding only: {forces}{speeds}"
    return f"estimated error of the steps: {forces}{speeds}{_against(found)}"


def _worst(numbers: Mapping[str, Resolved]) -> str:
    """The largest share that a number is wrong by, and whose it is."""
    if not numbers:
        return ""
    name, one = max(numbers.items(), key=lambda item: item[1].relative)
    return f"{one.relative:.1e} ({name})"
