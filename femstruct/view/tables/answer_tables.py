"""Tables that a person reads: largest stresses, evaluations of recorded histories, answers to excitations, fatigue."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from femstruct.files.tables.finding_tables import OF_EVALUATIONS, doubtful_answers, unquotable
from femstruct.modal.steady.answers import HarmonicAnswer, RandomAnswer, with_axis
from femstruct.reported import OWN_UNIT, Reported, holdings, reported
from femstruct.study.result import StudyResult
from femstruct.view.tables.finding_lines import doubted
from femstruct.view.tables.grid import Grid
from femstruct.view.tables.scales import ZEROS, digits, rounded, scaled


def stresses(result: StudyResult) -> Grid:
    """A row for every part whose stress is recorded and every case: how large, where, and when."""
    unsure = [
        code
        for case in result.cases.values()
        for name, code in unquotable(case).items()
        if case.channels[name].stressed
    ]
    title = "largest stresses of von Mises" + (f" ({doubted(unsure)})" if unsure else "")
    grid = Grid(title, ("", "case", "stress [MPa]", "where", "at [ms]"), keys=2)
    for case_name, case in result.cases.items():
        doubts = unquotable(case)
        for name, channel in case.channels.items():
            if (found := channel.stressed) is not None:
                worst = found.worst
                amount = f"{1e-6 * found.largest[worst]:.4g}{' ?' if name in doubts else ''}"
                time = f"{1e3 * found.time[worst]:.3f}"
                grid.add(name.rpartition(" ")[0], case_name, amount, found.where, time)
    return grid


def evaluations(result: StudyResult) -> Iterator[Grid]:
    """A table for each kind of evaluation of recorded histories, a row for each and every case: what its answers report
    with a symbol."""
    found: dict[str, Grid] = {}
    for case_name, case in result.cases.items():
        for key, told, answers in holdings(case):
            for name, one in answers.items() if key in case.evaluations else ():
                kind: object = type(one)
                shown = {field: about for field, about in reported(kind).items() if about.symbol}
                columns = ("", "case", *(about.symbol for about in shown.values()))
                grid = found.setdefault(key, Grid(told.long_name.lower(), columns, keys=2))
                doubts = doubtful_answers(case, key, name)
                cells = (
                    _cell(one, field, about) + (" ?" if about.symbol in doubts else "")
                    for field, about in shown.items()
                )
                grid.add(name, case_name, *cells)
                if doubts:
                    found[key] = replace(grid, title=f"{told.long_name.lower()} ({doubted([OF_EVALUATIONS])})")
    yield from found.values()


def _cell(noun: Any, field: str, about: Reported) -> str:
    """A number with its unit, or a text."""
    value = getattr(noun, field)
    if value is None or isinstance(value, str):
        return value or "-"
    factor, unit = scaled(noun.unit if about.unit == OWN_UNIT else about.unit, abs(value))
    return digits(factor * value) + (f" {unit}" if unit != "1" else "")


def harmonic(result: StudyResult) -> Grid:
    """A row for every harmonic excitation, case and channel: the largest amplitude, and at which frequency."""
    grid = Grid("harmonic vibration: largest amplitudes", ("", "channel", "case", "largest", "at [Hz]"), keys=3)
    for name, case, channel, answer in _answers(result):
        if isinstance(answer, HarmonicAnswer):
            largest = rounded(answer.largest, _beside(result, name, case, answer.unit))
            factor, unit = scaled(answer.unit, largest)
            at = f"{answer.largest_at_hz:.4g}" if largest else "-"
            grid.add(name, channel, case, f"{digits(factor * largest)} {unit}", at, answer.where)
    return _noted(_with_places(grid))


def random(result: StudyResult) -> Grid:
    """A row for every random excitation, case and channel: its rms, mean frequency and expected largest."""
    lasting = {(case, one.name): one.duration for case, own in result.cases.items() for one in own.case.study.vibration}
    durations = {seconds for seconds in lasting.values() if seconds is not None}
    title = "random vibration: rms, mean frequency (upward crossings of zero)"
    columns = ["", "channel", "case", "rms", "mean frequency [Hz]"]
    if durations:
        title += ", expected peak"
        columns.append(f"expected peak in {durations.copy().pop():g} s" if len(durations) == 1 else "expected peak")
    grid = Grid(title, columns, keys=3)
    for name, case, channel, answer in _answers(result):
        if isinstance(answer, RandomAnswer):
            rms = rounded(answer.rms, _beside(result, name, case, answer.unit))
            peak = rms and answer.peak  # what is rounding has none
            factor, unit = scaled(answer.unit, peak or rms)
            often = "-" if answer.crossings is None or not rms else f"{answer.crossings:.4g}"
            cells = [f"{digits(factor * rms)} {unit}", often]
            if durations:
                seconds = lasting[case, name]
                within = f" in {seconds:g} s" if len(durations) > 1 else ""
                cells.append("-" if peak is None or not rms else f"{digits(factor * peak)} {unit}{within}")
            grid.add(name, channel, case, *cells, answer.where)
    grid = _noted(grid)
    placed = _with_places(grid)
    if placed is grid:
        return grid
    reason = "; a stress of von Mises has neither sign nor a Gaussian distribution: no mean frequency, no expected peak"
    return replace(placed, title=title + reason)


def _answers(result: StudyResult) -> Iterator[tuple[str, str, str, HarmonicAnswer | RandomAnswer]]:
    """Excitation, case, channel with its axis, and what came of it."""
    for case_name, case in result.cases.items():
        for name, one in case.vibration.items():
            for channel, answer in one.answers.items():
                yield name, case_name, with_axis(channel, answer.unit), answer


def _beside(result: StudyResult, excitation: str, case: str, unit: str) -> float:
    """The largest answer in a unit to one excitation of one case, what rounding is judged by."""
    answers = result.cases[case].vibration[excitation].answers.values()
    sizes = [one.rms if isinstance(one, RandomAnswer) else one.largest for one in answers if one.unit == unit]
    return max(sizes, default=0.0)


def _noted(grid: Grid) -> Grid:
    """With what its zeros are relative to in its title, where it has any."""
    zeros = any(cell.partition(" ")[0] == "0" for row in grid.rows for cell in row[3:4])
    return replace(grid, title=grid.title + ZEROS) if zeros else grid


def _with_places(grid: Grid) -> Grid:
    """With a column for the places that end its rows, where there are any; without, the grid itself."""
    rows = grid.rows.copy()
    placed = any(row[-1] for row in rows)
    grid.rows[:] = [[*row[:-1], row[-1] or "-"] if placed else row[:-1] for row in rows]
    return replace(grid, columns=(*grid.columns, "where")) if placed else grid


def fatigue(result: StudyResult) -> Grid:
    """A row for every channel whose cycles are counted and every case."""
    columns = ("", "case", "of", "cycles", "largest range", "damage", "of these to failure", "where")
    title = "fatigue: rainflow cycles and Miner's damage of one record or duration, no partial factors"
    if any(one.on for case in result.cases.values() for one in case.fatigue.values()):
        title += "; planes by their normal in global axes, that of most damage by the S-N line"
    if any(not one.converged for case in result.cases.values() for one in case.fatigue.values()):
        title += " (? : do not quote, see damage-not-converged)"
    grid = Grid(title, columns, keys=2)
    for case_name, case in result.cases.items():
        for name, one in case.fatigue.items():
            factor, unit = scaled(one.unit, one.largest)
            mark = "" if one.converged else " ?"
            damage = "-" if one.damage is None else f"{one.damage:.3g}{mark}"
            life = "-" if one.damage is None else f"{'no end' if one.life is None else f'{one.life:.3g}'}{mark}"
            largest = f"{digits(factor * one.largest)} {unit}{mark}"
            grid.add(name, case_name, one.channel, f"{one.cycles:g}", largest, damage, life, one.on or "-")
    return grid


def moved_masses(result: StudyResult) -> Grid:
    """A row for every base that moves: the effective mass of its modes, as a share of all."""
    columns = ("", "case", "along", "modes", "effective mass", "share")
    grid = Grid("effective mass of the modes along the motion of the base", columns, keys=2)
    for case_name, case in result.cases.items():
        for name, one in case.vibration.items():
            if (moved := one.base) is not None:
                mass = f"{digits(rounded(moved.moved, moved.total))} of {digits(moved.total)} kg"
                grid.add(name, case_name, moved.axis, str(len(moved.mass)), mass, f"{100.0 * moved.share:.0f} %")
    return grid
