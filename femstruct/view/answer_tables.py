"""Tables that a person reads: largest stresses, evaluations of recorded histories, answers to excitations, fatigue."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import isfinite, isnan, nan
from typing import Any

from acoustics.levels.rated import RatedRoom
from acoustics.levels.standards import SingleNumber
from femstruct.files.tables import OF_EVALUATIONS, doubtful_answers, unquotable
from femstruct.modal.steady import HarmonicAnswer, RandomAnswer, with_axis
from femstruct.reported import OWN_UNIT, Reported, holdings, reported
from femstruct.sound.flanking import SurfaceShares, summed_db
from femstruct.study.results import CaseResult, StudyResult
from femstruct.view.console import ZEROS, Grid, digits, doubt_note, rounded, scaled


def stresses(result: StudyResult) -> Grid:
    """A row for every part whose stress is recorded and every case: how large, where, and when."""
    unsure = [
        code
        for case in result.cases.values()
        for name, code in unquotable(case).items()
        if case.channels[name].stressed
    ]
    title = "largest stresses of von Mises" + (f" ({doubt_note(unsure)})" if unsure else "")
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
        for key, holding, answers in holdings(case):
            for name, one in answers.items() if key in case.evaluations else ():
                kind: object = type(one)
                shown = {field: about for field, about in reported(kind).items() if about.symbol}
                columns = ("", "case", *(about.symbol for about in shown.values()))
                grid = found.setdefault(key, Grid(holding.long_name.lower(), columns, keys=2))
                doubts = doubtful_answers(case, key, name)
                cells = (
                    _cell(one, field, about) + (" ?" if about.symbol in doubts else "")
                    for field, about in shown.items()
                )
                grid.add(name, case_name, *cells)
                if doubts:
                    found[key] = replace(grid, title=f"{holding.long_name.lower()} ({doubt_note([OF_EVALUATIONS])})")
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


# ----------------------------------------------------------------------------------------------------------------------
# Sound energy into the open, what measured sources send into structures and rooms, and rooms that several surfaces
# move: who makes which band.
# ----------------------------------------------------------------------------------------------------------------------


def radiated(result: StudyResult) -> Grid:
    """Levels re 1 pJ, energy, difference to the baseline, efficiency, share of what was put in, loudest band."""
    rooms = dict.fromkeys(room for case in result.cases.values() for room in case.radiated)
    rows = [(room, name, c.radiated[room]) for room in rooms for name, c in result.cases.items() if room in c.radiated]
    factor, unit = scaled("J", max((one.energy.energy_j for _, _, one in rows), default=0.0))
    grid = Grid(
        "sound energy radiated by surfaces into the open, whole window",
        (
            "room",
            "case",
            "L_J [dB re 1 pJ]",
            "L_JA [dB]",
            "difference [dB]",
            f"energy [{unit}]",
            "efficiency",
            "of the energy put into the structure",
            "most at [Hz]",
        ),
        keys=2,
    )
    baseline = result.cases[result.comparison.baseline].radiated
    for room, name, one in rows:
        energy = one.energy
        first = baseline.get(room)
        bands = {band: one for band, one in energy.bands_j.items() if isfinite(one)}
        change = energy.level_db - first.energy.level_db if first is not None else float("nan")
        grid.add(
            room,
            name,
            _decibel(energy.level_db),
            _decibel(energy.weighted_db),
            "" if name == result.comparison.baseline else f"{change:+.1f}" if isfinite(change) else "-",
            f"{factor * energy.energy_j:.4g}",
            f"{energy.efficiency:.3g}" if isfinite(energy.efficiency) else "-",
            f"{100 * one.share:.2g} %" if isfinite(one.share) else "-",
            f"{max(bands, key=lambda band: bands[band]):g}" if energy.energy_j > 0 and bands else "-",
        )
    return grid


def installed(result: StudyResult) -> Grid:
    """A row for every measured source, quantity and case: its bands, and the A-weighted level of a receiver."""
    found = [(name, case, one) for case, own in result.cases.items() for name, one in own.sources.items()]
    bands = sorted({band for _, _, one in found for band in one.power_db})
    title = "measured sources: sound power into the structure [dB re 1 pW], levels [dB re 20 µPa] (-: beyond the modes)"
    grid = Grid(title, ("source", "", "case", *(f"{band:g} Hz" for band in bands), "A"), keys=3)
    for name, case, one in found:
        grid.add(name, "L_Ws", case, *(_decibel(one.power_db.get(band, nan)) for band in bands), "")
        for receiver, levels_there in one.levels.items():
            levels = (_decibel(levels_there.bands_db.get(band, nan)) for band in bands)
            grid.add(name, receiver, case, *levels, _decibel(levels_there.l_aeq_db))
    return grid


def _decibel(value: float) -> str:
    return f"{value:.1f}" if isfinite(value) else "-"


def shares_by_surface(result: StudyResult) -> Grid:
    """A row for every surface: its part of the energy that the air takes up, how loud it is alone, where it is most."""
    grid = Grid(
        "sound by surface, all third octaves that are complete, whole window; - of a surface: it does not move",
        ("room", "case", "surface", "wall", "active energy", "L_E alone [dB]", "together [dB]", "most at [Hz]"),
        keys=4,
    )
    for case, found in result.cases.items():
        for room, shares in found.by_surface.items():
            whole = float(shares.energy_j.sum())
            for row, name in enumerate(shares.surfaces):
                part = float(shares.energy_j[row].sum()) / whole if whole > 0 else float("nan")
                most = shares.bands_hz[shares.alone_db[row].argmax()] if not isnan(shares.over_db(row)) else None
                grid.add(
                    room,
                    case,
                    name,
                    shares.walls[row],
                    "-" if isnan(part) else f"{100 * part:.3g} %",
                    _level(shares.over_db(row)),
                    _level(summed_db(shares.together_db)),
                    "-" if most is None else f"{most:g}",
                )
    return grid


def bands_by_surface(result: StudyResult) -> Grid:
    """The baseline's bands: level of all surfaces together, of each alone, and its part of the active energy."""
    rooms = result.cases[result.comparison.baseline].by_surface
    names = dict.fromkeys(name for shares in rooms.values() for name in shares.surfaces)
    grid = Grid(
        f"sound by surface in third octaves, {result.comparison.baseline}: L_E alone [dB], part of the active energy",
        ("room", "f [Hz]", "together", *names),
        keys=2,
    )
    for room, shares in rooms.items():
        for band in range(len(shares.bands_hz)):
            cells = (_share_cell(shares, name, band) for name in names)
            grid.add(room, f"{shares.bands_hz[band]:g}", _level(float(shares.together_db[band])), *cells)
    return grid


def _share_cell(shares: SurfaceShares, name: str, band: int) -> str:
    if name not in shares.surfaces:
        return ""
    row = shares.surfaces.index(name)
    level, part = float(shares.alone_db[row, band]), float(shares.share[row, band])
    return f"{_level(level)}, {'-' if isnan(part) else f'{100 * part:.0f} %'}"


def _level(value: float) -> str:
    return "-" if isnan(value) else f"{value:.1f}"


# ----------------------------------------------------------------------------------------------------------------------
# Rooms as the standards state them: a row for every case, and their bands side by side.
# ----------------------------------------------------------------------------------------------------------------------

BLANK = "blank"  # of a band that reaches beyond the modes
STATISTICAL = "statistical"  # of one that statistical energies fill
OVER = ("drop", "receiver")
ASSUMED = "only the floor radiates, no flanking; the room is rigid except for its reverberation time"


def ratings(result: StudyResult) -> Grid:
    """A row for every rated room, single number and case: the number and what is stated with it, difference to the
    baseline, spreads, deciding band."""
    rated = [(room, name, one) for name, case in result.cases.items() for room, one in case.rated.items()]
    besides = list(
        dict.fromkeys(name for _, _, one in rated for number in one.numbers.values() for name in number.beside)
    )
    counts = {(one.drops, one.receivers) for _, _, one in rated}
    alike = len(counts) == 1
    of = "; spreads are over " + " and ".join(map(_counted, counts.copy().pop(), OVER)) if alike else ""
    grid = Grid(
        f"impact sound by the standards ({ASSUMED}{of})",
        (
            "room",
            "single number",
            "case",
            "[dB]",
            *besides,
            "difference\n(its spread\nover drops)\n[dB]",
            "spread over\ndrops\n[dB]",
            "over\nreceivers\n[dB]",
            "over rooms\nand places:\nmean [90 %]",
            "deciding\nband [Hz]",
        ),
        keys=3,
    )
    baseline = result.comparison.baseline
    for room, symbol in dict.fromkeys((room, symbol) for room, _, one in rated for symbol in one.numbers):
        beside = result.cases[baseline].rated.get(room)
        for there, name, one in rated:
            if there != room or symbol not in one.numbers:
                continue
            change = "" if name == baseline else _change(one, beside, symbol)
            number = one.numbers[symbol]
            grid.add(
                room,
                symbol,
                name,
                bounded_text(number),
                *(f"{number.beside[other]:g}" if other in number.beside else "" for other in besides),
                change,
                _number(one.drops_spread_db[symbol]) + ("" if alike else f" ({_counted(one.drops, OVER[0])})"),
                _number(one.receivers_spread_db[symbol]) + ("" if alike else f" ({_counted(one.receivers, OVER[1])})"),
                _over_rooms(one, symbol),
                f"{number.deciding_hz:g}" if isfinite(number.deciding_hz) else "-",
            )
    return grid


def _counted(count: int, what: str) -> str:
    """A number of drops or receivers.

    >>> _counted(1, "drop"), _counted(4, "receiver")
    ('1 drop', '4 receivers')
    """
    return f"{count} {what}{'' if count == 1 else 's'}"


def first_drop(result: StudyResult) -> str:
    """A sentence that says which drop all but the ratings is of, where a source strikes several places; "" else."""
    count = max((len(case.drops) for case in result.cases.values()), default=0)
    if not count:
        return ""
    whole = "ratings are of all" if not any(result.verdicts.values()) else "ratings are of all, limits of the worst"
    return f"the source strikes {count} places; {whole}, other results are of the first, {first_drop_place(result)}"


def first_drop_place(result: StudyResult) -> str:
    """The place that histories and pictures are of, where a source strikes several; "" else."""
    return ", ".join(dict.fromkeys(next(iter(case.drops)) for case in result.cases.values() if case.drops))


def bands(result: StudyResult) -> Grid:
    """Bands of every rated room and their spread over drops and receivers; rows only where there are any."""
    rated = [(room, one.method) for case in result.cases.values() for room, one in case.rated.items()]
    kinds = " and ".join(dict.fromkeys(method.bands for _, method in rated))
    blank = any(one.blank_hz for case in result.cases.values() for one in case.rated.values())
    silent = any(one.code == "room-silent" for case in result.cases.values() for one in case.findings)
    why = f"; {BLANK}: beyond the modes{', or silent' * silent}" if blank else ""
    if any(one.statistical_hz for case in result.cases.values() for one in case.rated.values()):
        why += f"; {STATISTICAL}: beyond the modes, from statistical energies (deviation to expect of one floor)"
    if any(one.ensemble for case in result.cases.values() for one in case.rated.values()):
        why += "; behind low bands their mean over rooms with sides within 5 % and places [90 % interval]"
    about = f"impact sound by {kinds}, re 20 µPa: average over drops and receivers (spread){why}"
    grid = Grid(about, ("", *result.cases))
    for room, quantity, kind, band in dict.fromkeys(
        (room, method.band_quantity, method.bands, band) for room, method in rated for band in method.bands_hz
    ):
        row = (_band(case, room, quantity, kind, band) for case in result.cases.values())
        grid.add(f"{room} {quantity} {band:g} Hz [dB]", *row)
    return grid


def rating_text(number: SingleNumber) -> str:
    """A single number as its standard states it, with what goes with it in brackets.

    >>> rating_text(SingleNumber(72.0, 71.6, 1000.0, {}, "", {"C_I": -11.0}))
    '72 dB (C_I -11)'
    """
    beside = ", ".join(f"{name} {value:g}" for name, value in number.beside.items())
    least = "at least " if number.blank_hz and isfinite(number.value_db) else ""
    value = f"{number.value_db:g}" if isfinite(number.value_db) else "-"
    beside += (
        f"{', ' if beside else ''}{STATISTICAL} from {number.statistical_hz[0]:g} Hz" if number.statistical else ""
    )
    return f"{least}{value} dB" + (f" ({beside})" if beside else "")


def bounded_text(number: SingleNumber) -> str:
    """A single number without its unit, "at least" one some of whose bands are blank, "-" where all of them are.

    >>> bounded_text(SingleNumber(51.0, 51.2, 80.0, {}, "", blank_hz=(250.0, 315.0)))
    'at least 51'
    >>> bounded_text(SingleNumber(55.0, 54.9, 315.0, {}, "", statistical_hz=(250.0, 315.0)))
    '55 (statistical from 250 Hz)'
    """
    if not isfinite(number.value_db):
        return "-"
    from_hz = f" ({STATISTICAL} from {number.statistical_hz[0]:g} Hz)" if number.statistical_hz else ""
    return f"{'at least ' if number.blank_hz else ''}{number.value_db:g}{from_hz}"


def _over_rooms(rated: RatedRoom, symbol: str) -> str:
    """A number over an ensemble, "-" without one, with the reason where no low band, which vary over it, decides."""
    if symbol not in rated.number_intervals:
        decides = rated.numbers[symbol].deciding_hz
        return "-" if rated.ensemble is None or not isfinite(decides) else "- (no low band)"
    one = rated.number_intervals[symbol]
    return f"{one.mean:.1f} [{one.low:.1f}, {one.high:.1f}]"


def _change(rated: RatedRoom, baseline: RatedRoom | None, symbol: str) -> str:
    """What a single number is above the baseline's, and what that spreads over the drops."""
    above = {} if baseline is None else rated.above(baseline)
    if baseline is None or symbol not in above:
        return "-"
    spread = rated.above_spread_db(baseline)[symbol]
    if not isfinite(above[symbol]):
        return "-"
    return f"{above[symbol]:+z.1f}" + (f" ({spread:.1f})" if isfinite(spread) else "")


def _number(value: float) -> str:
    return f"{value:.1f}" if isfinite(value) else "-"


def _band(case: CaseResult, room: str, quantity: str, kind: str, band: float) -> str:
    found = case.rated.get(room)
    if found is None or (found.band_quantity, found.method.bands) != (quantity, kind) or band not in found.bands_db:
        return "-"
    if not isfinite(found.bands_db[band]):
        return BLANK
    if found.statistical is not None and band in found.statistical_hz:
        return f"{found.bands_db[band]:.1f} {STATISTICAL} ({found.statistical.scatter_db[band]:.1f})"
    spread = found.spread_db[band]
    own = f"{found.bands_db[band]:.1f}" + (f" ({spread:.1f})" if isfinite(spread) else "")
    if not isfinite(found.mean_db[band]):
        return own
    return f"{own}; {found.mean_db[band]:.1f} [{found.low_db[band]:.1f}, {found.high_db[band]:.1f}]"


def add_totals(grid: Grid, result: StudyResult) -> None:
    """A line for every receiver where own sound is computed: levels of the total."""
    for name in dict.fromkeys(name for case in result.cases.values() for name in case.heard.total_levels):
        grid.add(f"{name} total L_peak / L_AFmax [dB]", *(_total(case, name) for case in result.cases.values()))


def _total(case: CaseResult, name: str) -> str:
    if name not in case.heard.total_levels:
        return "-"
    total = case.heard.total_levels[name]
    return f"{_number(total.l_peak_db)} / {_number(total.l_afmax_db)}"
