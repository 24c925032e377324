"""What a person reads of a study: its cases side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from math import inf, isfinite, isnan, nan

from rich.console import Console

from acoustics.levels.sound_levels import Levels
from femstruct.errors import list_some
from femstruct.files.tables import doubtful_forces, findings_by_case, unquotable
from femstruct.reported import reported
from femstruct.study.recorded import DAMPED_FORCE, NET_FORCE, damped_forces
from femstruct.study.results import CaseComparison, CaseResult, StudyResult
from femstruct.view.answer_tables import (
    add_totals,
    bands,
    bands_by_surface,
    evaluations,
    fatigue,
    first_drop,
    harmonic,
    installed,
    moved_masses,
    radiated,
    random,
    ratings,
    shares_by_surface,
    stresses,
)
from femstruct.view.case_tables import (
    arrays,
    blows,
    energies,
    energy_destinations,
    first_impact,
    has_contacts,
    limits,
    machine,
    outcomes,
    trust,
)
from femstruct.view.console import ZEROS, Grid, console, digits, doubt_note, rounded, scaled, show_findings

SPOKEN_RECEIVERS = 2  # of a room
SPOKEN_MODES = 12  # of a channel
SPOKEN_HZ = 500.0  # modes above it are in summary.json; a terminal shows those that floors and presses are judged by


def show_study(result: StudyResult, written: Mapping[str, float], folder: str = "", verbose: bool = False) -> None:
    """Cases side by side: ratings, machine, limits, peaks, contacts, energy, levels, changes, findings, timings.

    Parameters
    ----------
    verbose : bool
        Show remarks, too.
    """
    screen = console()
    screen.print(result.plan.title, style="bold")
    for line in result.comparison.inputs:
        screen.print(f"  {line}", soft_wrap=True)
    for line in (*outcomes(result), *trust(result), *notes(result)):
        screen.print(f"  {line}", soft_wrap=True)
    if sentence := first_drop(result):
        screen.print(f"  {sentence}", soft_wrap=True)
    for table in study_tables(result):
        table.show(screen)
    show_findings(
        screen,
        [
            (finding, "" if len(cases) in (0, len(result.cases)) else _in_cases(cases))
            for finding, cases in findings_by_case(result)
        ],
        verbose,
    )
    _show_timings(screen, {**result.timings, **written})
    if folder:
        screen.print(f"written to {folder}")


def notes(result: StudyResult) -> list[str]:
    """What of the cases and their baseline is not compared, or over which part of them; each sentence once."""
    others = result.comparison.cases
    found = {
        note: [name for name, one in others.items() if note in one.notes] for o in others.values() for note in o.notes
    }
    return [f"{', '.join(cases)}: {note}" for note, cases in found.items()]


def study_tables(result: StudyResult) -> tuple[Grid, ...]:
    """All tables of a study in their order, the empty ones among them."""
    return (*main_tables(result), *other_tables(result))


def main_tables(result: StudyResult) -> tuple[Grid, ...]:
    """What a study is run for: ratings, limits, what is asked of a machine, levels, peaks, vibration, fatigue."""
    return (
        ratings(result),
        limits(result),
        machine(result),
        _levels(result),
        installed(result),
        _peaks(result),
        *evaluations(result),
        harmonic(result),
        random(result),
        fatigue(result),
    )


def other_tables(result: StudyResult) -> tuple[Grid, ...]:
    """Where those numbers come from: contacts, blows, energy, sound energy, bands, attenuation by modes."""
    return (
        _contacts(result),
        stresses(result),
        moved_masses(result),
        blows(result),
        energies(result),
        energy_destinations(result),
        arrays(result),
        radiated(result),
        shares_by_surface(result),
        bands_by_surface(result),
        bands(result),
        _modes_db(result),
    )


def _peaks(result: StudyResult) -> Grid:
    window = f"first impact{first_impact(result)} / whole window" if has_contacts(result) else "whole window"
    changed = any(not one.converged for beside in result.comparison.cases.values() for one in beside.peaks.values())
    codes = [code for case in result.cases.values() for code in unquotable(case).values()]
    told_of = doubt_note([*codes, *(["change-not-converged"] if changed else [])], "; ")
    tiny = any(
        rounded(one.whole, _largest(case, one.unit)) != one.whole
        for case in result.cases.values()
        for one in case.channels.values()
        if not isnan(one.whole)
    )
    damped = any(damped_forces(case.channels, case.basis.outputs) for case in result.cases.values())
    shared = f"; force of a part or support {DAMPED_FORCE}" if damped else ""
    title = f"peaks: {window} ({result.comparison.filter}{told_of}{shared}{ZEROS if tiny else ''})"
    grid = Grid(title, ("", *result.cases))
    names = list(dict.fromkeys(name for case in result.cases.values() for name in case.channels))
    for name in names:
        found = [case.channels[name] for case in result.cases.values() if name in case.channels]
        unit, factor = found[0].unit, 1.0
        if any(channel.stressed is not None for channel in found):
            factor, unit = scaled(unit, max(channel.whole for channel in found))
        grid.add(f"{name} [{unit}]", *(_peak(result, case, name, factor) for case in result.cases))
    return grid


def _peak(result: StudyResult, case: str, name: str, factor: float) -> str:
    channel = result.cases[case].channels.get(name)
    if channel is None:
        return "-"
    beside = result.comparison.cases.get(case)
    change = beside.peaks.get(name) if beside else None
    largest = _largest(result.cases[case], channel.unit)
    mark = " ?" if name in unquotable(result.cases[case]) else ""
    texts = [[f"{digits(factor * rounded(one, largest))}{mark}" for one in (channel.first_impact, channel.whole)]]
    if change is not None:
        mark = "" if change.converged else " ?"
        texts.append([f"{_percent(one)}{mark}" for one in (change.first_impact_percent, change.whole_percent)])
    start = 0 if has_contacts(result) else 1
    return "\n".join(" / ".join(both[start:]) for both in texts)


def _largest(case: CaseResult, unit: str) -> float:
    """The largest peak of a case in a unit, what rounding is judged by."""
    return max((one.whole for one in case.channels.values() if one.unit == unit), default=0.0)


def _percent(value: float | None) -> str:
    return "-" if value is None else f"{value:+.1f} %"


def _contacts(result: StudyResult) -> Grid:
    grid = Grid(
        "contacts (true peak forces, also between samples)",
        ("", "case", "peak force [N]", "closings", "first opens [ms]"),
        keys=2,
    )
    for case_name, case in result.cases.items():
        if case.response is None:
            continue
        for name, contact in case.response.contacts.items():
            opens = "never" if contact.first_open is None else f"{1e3 * contact.first_open:.3f}"
            mark = " ?" if name in doubtful_forces(case) else ""
            grid.add(name, case_name, f"{digits(contact.peak_force)}{mark}", str(contact.closings), opens)
    if any(doubtful_forces(case) for case in result.cases.values()):
        return replace(grid, title=f"{grid.title[:-1]}; {doubt_note(['force-beyond-modes'])})")
    return grid


def _levels(result: StudyResult) -> Grid:
    ending = "; total: with the bodies' own sound" if any(c.heard.total for c in result.cases.values()) else ""
    ends = {
        name: min((one.complete_below_hz for one in case.levels.values()), default=inf)
        for name, case in result.cases.items()
    }
    cut = any(isfinite(end) for end in ends.values())
    ending += "; only sound below the last mode is included: lower bounds" if cut else ""
    grid = Grid(f"levels re 20 µPa{ending}", ("receiver", *result.cases))
    names = list(dict.fromkeys(name for case in result.cases.values() for name in case.levels))
    for name in names:
        for what, entry in reported(Levels).items():
            if entry.symbol:
                grid.add(f"{name} {entry.symbol} [dB]", *(_level(case, name, what) for case in result.cases.values()))
    add_totals(grid, result)
    if cut:
        grid.add("sound ends at [Hz]", *(f"{end:.4g}" if isfinite(end) else "-" for end in ends.values()))
    return grid


def _level(case: CaseResult, name: str, what: str) -> str:
    value = getattr(case.levels[name], what) if name in case.levels else nan
    return f"{value:.1f}" if isfinite(value) else "-"


def _modes_db(result: StudyResult) -> Grid:
    """Attenuation at the baseline's spectral peaks: motion, pressures and the net force side by side.

    Modes that follow each other and are attenuated alike have one row: those near one peak, and all of a blow that is
    only weaker.
    """
    others = result.comparison.cases
    grid = Grid(
        f"attenuation at the modes of '{result.comparison.baseline}' [dB]",
        ("channel", "mode", "f [Hz]", *others),
        keys=3,
    )
    reference = result.cases[result.comparison.baseline]
    moving = [name for name in reference.channels if name.endswith("velocity") or _only_accelerates(reference, name)]
    pressures = [name for name in reference.channels if name.endswith(" pressure")]
    channels = [*moving, *_first_receivers(pressures)]
    forces = [name for name in reference.channels if name.startswith(NET_FORCE) and _changes(result, name)]
    modes = {name: {mode for beside in others.values() for mode in beside.modes_db.get(name, {})} for name in channels}
    spoken = set().union(*modes.values())
    unspoken = 0
    for channel in (*channels, *forces):
        numbers = sorted(modes.get(channel, spoken))
        shown = [mode for mode in numbers if reference.basis.frequency_hz[mode - 1] <= SPOKEN_HZ][:SPOKEN_MODES]
        unspoken = max(unspoken, len(numbers) - len(shown))
        rows = {mode: tuple(_mode_db(one, channel, mode) for one in others.values()) for mode in shown}
        for (cells, _), alike in groupby(shown, key=lambda mode: (rows[mode], mode - numbers.index(mode))):
            group = list(alike)
            ends = [f"{reference.basis.frequency_hz[mode - 1]:.1f}" for mode in (group[0], group[-1])]
            grid.add(channel, _from_to([str(group[0]), str(group[-1])]), _from_to(ends), *cells)
    left = len(pressures) + len(moving) - len(channels)
    more = [f"{count} more {word}" for count, word in ((left, "receivers"), (unspoken, "modes")) if count]
    return replace(grid, title=f"{grid.title} ({' and '.join(more)} in summary.json)") if more else grid


def _from_to(ends: Sequence[str]) -> str:
    """Both ends of what has one row, or one where they are alike.

    >>> _from_to(["4", "6"]), _from_to(["5.5", "5.5"])
    ('4 to 6', '5.5')
    """
    return " to ".join(dict.fromkeys(ends))


def _only_accelerates(case: CaseResult, name: str) -> bool:
    """Whether a channel is the acceleration of what has no velocity recorded, which would be attenuated alike."""
    where = name.removesuffix("acceleration")
    return where != name and f"{where}velocity" not in case.channels


def _first_receivers(pressures: Sequence[str]) -> list[str]:
    """Of many receivers in a room the first two.

    >>> _first_receivers(["hall.a pressure", "bed.a.1 pressure", "bed.a.2 pressure", "bed.a.3 pressure"])
    ['hall.a pressure', 'bed.a.1 pressure', 'bed.a.2 pressure']
    """
    rooms: dict[str, list[str]] = {}
    for name in pressures:  # names hold no dots
        rooms.setdefault(name.partition(".")[0], []).append(name)
    return [name for names in rooms.values() for name in names[:SPOKEN_RECEIVERS]]


def _changes(result: StudyResult, channel: str) -> bool:
    """Whether any case changes a channel at any mode by what two decimals show; a force that none does says nothing."""
    others = result.comparison.cases.values()
    return any(abs(value) >= 0.005 for beside in others for value in beside.modes_db.get(channel, {}).values())


def _mode_db(beside: CaseComparison, channel: str, mode: int) -> str:
    value = beside.modes_db.get(channel, {}).get(mode)
    return "-" if value is None else f"{value:z.2f}"


def _in_cases(names: Sequence[str]) -> str:
    """The cases a finding holds for.

    >>> _in_cases(["light", "heavy"])
    ' (cases light, heavy)'
    """
    return f" (case{'s' if len(names) > 1 else ''} {list_some(names)})"


def _show_timings(screen: Console, seconds: Mapping[str, float]) -> None:
    timings = ", ".join(f"{stage} {spent:.2f}" for stage, spent in seconds.items())
    if timings:
        screen.print(f"CPU seconds: {timings}", soft_wrap=True)
