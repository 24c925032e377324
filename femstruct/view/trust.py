"""How far the numbers of a case may be off, a line each: what more modes change, and what the steps leave."""

from __future__ import annotations

from collections.abc import Mapping

from femstruct.impact.estimate import ErrorEstimate, Resolved
from femstruct.study.result import AccuracyCheck, StudyResult


def trust(result: StudyResult) -> list[str]:
    """All cases by name: first what came of an asked accuracy, then the error estimates."""
    asked = [f"{name}: {accuracy(case.accuracy)}" for name, case in result.cases.items() if case.accuracy is not None]
    return asked + [
        f"{name}: {errors(case.errors)}"
        for name, case in result.cases.items()
        if case.errors is not None and case.errors.peak
    ]


def accuracy(check: AccuracyCheck) -> str:
    """What more modes still change, and which are used."""
    if check.worst is None:
        return "accuracy: the basis holds every mode there is"
    name, worst = check.worst
    return (
        f"accuracy: {name} {worst.smaller:.4g} / {worst.larger:.4g} {worst.unit} with the modes up to "
        f"{check.smaller_hz:.5g} / {check.larger_hz:.5g} Hz, at most {100 * worst.share:.2g} % apart in "
        f"{check.band[0]:g} to {check.band[1]:g} Hz until {1e3 * check.window:.4g} ms; {100 * check.within:g} % asked; "
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
        return f"estimated error, rounding alone: {forces}{speeds}"
    return f"estimated error of the steps: {forces}{speeds}; against a run at a tolerance of {found.against:.0e}"


def _worst(numbers: Mapping[str, Resolved]) -> str:
    """The largest share that a number is wrong by, and whose it is."""
    if not numbers:
        return ""
    name, one = max(numbers.items(), key=lambda item: item[1].relative)
    return f"{one.relative:.1e} ({name})"
