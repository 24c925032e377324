"""Rooms as the standards state them: a row for every case, and their bands side by side."""

from __future__ import annotations

from math import isfinite

from acoustics.levels.rated import RatedRoom
from acoustics.levels.single_number import SingleNumber
from femstruct.study.result import CaseResult, StudyResult
from femstruct.view.tables.grid import Grid

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
                bounded(number),
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
    return f"the source strikes {count} places; {whole}, other results are of the first, {struck_first(result)}"


def struck_first(result: StudyResult) -> str:
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


def told(number: SingleNumber) -> str:
    """A single number as its standard states it, with what goes with it in brackets.

    >>> told(SingleNumber(72.0, 71.6, 1000.0, {}, "", {"C_I": -11.0}))
    '72 dB (C_I -11)'
    """
    beside = ", ".join(f"{name} {value:g}" for name, value in number.beside.items())
    least = "at least " if number.blank_hz and isfinite(number.value_db) else ""
    value = f"{number.value_db:g}" if isfinite(number.value_db) else "-"
    beside += (
        f"{', ' if beside else ''}{STATISTICAL} from {number.statistical_hz[0]:g} Hz" if number.statistical else ""
    )
    return f"{least}{value} dB" + (f" ({beside})" if beside else "")


def bounded(number: SingleNumber) -> str:
    """A single number without its unit, "at least" one some of whose bands are blank, "-" where all of them are.

    >>> bounded(SingleNumber(51.0, 51.2, 80.0, {}, "", blank_hz=(250.0, 315.0)))
    'at least 51'
    >>> bounded(SingleNumber(55.0, 54.9, 315.0, {}, "", statistical_hz=(250.0, 315.0)))
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
