"""Tables that a person reads in the terminal: largest stresses, and what answers harmonic and random excitations."""

from __future__ import annotations

from femstruct.modal.steady.answers import HarmonicAnswer, RandomAnswer
from femstruct.study.result import StudyResult
from femstruct.view.tables.grid import Grid
from femstruct.view.tables.scales import digits, scaled


def stresses(result: StudyResult) -> Grid:
    """A row for every part whose stress is recorded and every case: how large, where, and when."""
    grid = Grid("largest stresses of von Mises", ("", "case", "stress [MPa]", "where", "at [ms]"), keys=2)
    for case_name, case in result.cases.items():
        for name, channel in case.channels.items():
            if (found := channel.stressed) is not None:
                worst = found.worst
                amount, time = f"{1e-6 * found.largest[worst]:.4g}", f"{1e3 * found.time[worst]:.3f}"
                grid.add(name.rpartition(" ")[0], case_name, amount, found.where, time)
    return grid


def vibration(result: StudyResult) -> Grid:
    """A row for every excitation, case and channel: how large, where along frequency, and the expected largest."""
    kinds = {one.kind for case in result.cases.values() for one in case.vibration.values()}
    head = {"harmonic": "amplitude", "psd": "rms"}
    size = " or ".join(word for kind, word in head.items() if kind in kinds)
    where = " or ".join(word for kind, word in (("harmonic", "at"), ("psd", "crossings")) if kind in kinds)
    columns = ("", "channel", "case", size, f"{where} [Hz]", *(["expected peak"] if "psd" in kinds else []))
    title = "vibration: " + "; ".join(
        text
        for kind, text in (
            ("harmonic", "largest amplitude and where it is"),
            ("psd", "root mean square and crossings of zero upwards"),
        )
        if kind in kinds
    )
    grid = Grid(title, columns, keys=3)
    for case_name, case in result.cases.items():
        for name, one in case.vibration.items():
            for channel, answer in one.answers.items():
                grid.add(name, channel, case_name, *_cells(answer, len(columns) - 3))
    return grid


def fatigue(result: StudyResult) -> Grid:
    """A row for every channel whose cycles are counted and every case."""
    columns = ("", "case", "of", "cycles", "largest range", "damage", "of these to failure", "where")
    title = "fatigue: rainflow cycles and Miner's damage of one record or duration, no partial factors"
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
    grid = Grid("moved by the base", ("", "case", "axis", "modes", "effective mass [kg]", "of all"), keys=2)
    for case_name, case in result.cases.items():
        for name, one in case.vibration.items():
            if one.base is not None:
                moved = one.base
                share = f"{100.0 * moved.share:.1f} %"
                grid.add(name, case_name, moved.axis, str(len(moved.mass)), digits(moved.moved), share)
    return grid


def _cells(answer: HarmonicAnswer | RandomAnswer, count: int) -> list[str]:
    """Size with its unit, frequency, and the expected largest where there is a column for it."""
    if isinstance(answer, HarmonicAnswer):
        factor, unit = scaled(answer.unit, answer.largest)
        return [f"{digits(factor * answer.largest)} {unit}", f"{answer.largest_at_hz:.4g}", "-"][:count]
    factor, unit = scaled(answer.unit, answer.peak or answer.rms)
    crossings = "-" if answer.crossings is None else f"{answer.crossings:.4g}"
    peak = "-" if answer.peak is None else f"{digits(factor * answer.peak)} {unit}"
    return [f"{digits(factor * answer.rms)} {unit}", crossings, peak]
