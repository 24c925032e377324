"""Figures over time: channels, contact forces, bodies, energy; the first impact large, the whole window beside it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acoustics.levels.sound_levels import REFERENCE_PA, level_spectrum
from femstruct.arrays import Floats
from femstruct.files.tables import unquotable
from femstruct.impact.response import BodyHistory, EnergyLedger, Response
from femstruct.impact.shares import energy_by_holder_over_time
from femstruct.study.results import CaseResult, StudyResult
from femstruct.view.case_tables import first_impact, has_contacts
from femstruct.view.console import digits, doubt_note, scaled
from femstruct.view.drawing import case_lines, finish, legend_above, mode_lines, new_figure, panels, thin_history
from femstruct.view.spectra import DYNAMIC_RANGE_DB, LOWEST_HZ, numbered_modes, plain_ticks, spectrum_end_hz
from femstruct.view.undrawn import no_energy, no_spectrum

ZOOM_WITHOUT_RULE: Final = 0.05  # of the window, where no first-impact window is given
BEFORE: Final = 0.05  # of the panel of what begins late: a little of what was before
AROUND: Final = 1.25  # times the first-impact window, or the time that a force acts in it: what comes next begins
NEARLY: Final = 0.8  # of the window: a panel of the first impact that is hardly shorter would show the same again
FORCE_IS_OVER: Final = 1e-3  # of its largest: a force that is over
FEWEST: Final = 10  # samples in a panel
MARGIN: Final = 0.01  # of the whole window, shown before its start: what begins with a peak is not under the axis
LEGIBLE: Final = 0.1  # of a unit: numbers are read in the unit of the whole window down to this
RESTING: Final = 1e-6  # of its largest speed: a body that is told to be at rest

Row = tuple[str, str, Mapping[str, tuple[Floats, Floats]], Mapping[str, str]]  # ylabel, unit, by case (t, y), legend


def history(result: StudyResult, channel: str) -> Figure:
    """A recorded channel of all cases; the legend gives the peaks |x|, in the first impact and in the whole window."""
    cases = {name: case for name, case in result.cases.items() if channel in case.channels}
    first = next(iter(cases.values())).channels[channel]
    met = has_contacts(result)
    factor, unit = scaled(first.unit, max(case.channels[channel].whole for case in cases.values()))
    impact = f"in the first impact{first_impact(result)}"
    doubts = {name: found[channel] for name, case in cases.items() if channel in (found := unquotable(case))}
    legend = {
        name: f"{name}: peak "
        + (f"{digits(factor * case.channels[channel].first_impact)} {unit} {impact}, " if met else "")
        + f"{digits(factor * case.channels[channel].whole)} {unit} in all"
        + (" ?" if name in doubts else "")
        for name, case in cases.items()
    }
    curves = {name: (_times(case), case.channels[channel].values) for name, case in cases.items()}
    filtered = next(iter(cases.values())).case.study.peaks.lowpass_hz is not None
    title = (
        f"{channel}   (peaks of |x|; {result.comparison.filter}{'; the curves are not filtered' if filtered else ''}"
        f"{doubt_note(doubts.values(), '; ')})"
    )
    return _figure(result, title, [(channel, first.unit, curves, legend)])


def contact_forces(result: StudyResult) -> Figure | None:
    """Forces of the contacts that are not recorded channels, which have figures of their own; None without any."""
    recorded = {name for case in result.cases.values() for name in case.channels}
    return _rows_of(
        result,
        "Contact forces",
        "N",
        {
            case: {
                f"force of {name}": (contact.force, f"peak {_amount('N', contact.peak_force)}")
                for name, contact in r.contacts.items()
                if f"{name} force" not in recorded
            }
            for case, r in responses(result).items()
        },
    )


def travels(result: StudyResult) -> Figure | None:
    """Displacement of all bodies since the start, a row each; None without bodies."""
    return _rows_of(
        result,
        f"Displacement of the bodies{_weightless(result)}",
        "m",
        {
            case: {f"displacement of {name}": (body.displacement, _ending(body)) for name, body in r.bodies.items()}
            for case, r in responses(result).items()
        },
    )


def _weightless(result: StudyResult) -> str:
    """That bodies do not fall back, in brackets; "" where any case has gravity."""
    times = [case.case.study.time for case in result.cases.values()]
    return "" if any(time is None or time.gravity for time in times) else " (without gravity)"


def _amount(unit: str, value: float) -> str:
    """A value in a unit that is easy to read.

    >>> _amount("N", 5.865e5)
    '586.5 kN'
    """
    factor, shown = scaled(unit, abs(value))
    return f"{digits(factor * value)} {shown}"


def _ending(body: BodyHistory) -> str:
    """Where a body ends, and whether it still moves there."""
    where = f"ends at {_amount('m', float(body.displacement[-1]))}"
    fastest = float(np.abs(body.velocity).max(initial=0.0))
    if abs(body.end_velocity) <= RESTING * fastest:
        return f"{where}, at rest"
    return f"{where}, moving"


def scaled_time(end: float) -> tuple[float, str]:
    """Milliseconds up to half a second, then seconds.

    >>> scaled_time(0.02)
    (1000.0, 'ms')
    """
    return (1e3, "ms") if end < 0.5 else (1.0, "s")


def _rows_of(
    result: StudyResult, title: str, unit: str, found: Mapping[str, Mapping[str, tuple[Floats, str]]]
) -> Figure | None:
    """A row for every name that occurs in any case."""
    names = list(dict.fromkeys(name for rows in found.values() for name in rows))
    if not names:
        return None
    rows: list[Row] = []
    for name in names:
        having = {case: rows_[name] for case, rows_ in found.items() if name in rows_}
        curves = {case: (_times(result.cases[case]), values) for case, (values, _) in having.items()}
        rows.append((name, unit, curves, {case: f"{case}: {text}" for case, (_, text) in having.items()}))
    return _figure(result, title, rows)


def _figure(result: StudyResult, title: str, rows: list[Row]) -> Figure:
    """Rows of two panels: the first impact, or of what begins after it its own beginning, and the whole window; of one
    where these are hardly apart in any row."""
    drawn = case_lines(result.cases, result.plan.baseline)
    above = 0.12 + 0.155 * max(len(legend) for *_, legend in rows)  # inches a legend takes
    figure = new_figure(11.0, 0.8 + (2.8 + 0.55 + above) * len(rows) - 0.55, title)
    duration = max(float(response.t[-1]) for response in responses(result).values())
    firsts = [_first_panel(unit, curves, first_impact_end(result, duration)) for _, unit, curves, _ in rows]
    columns = 2 if any(differs_from_window(end - start, duration) for start, end in firsts) else 1
    ratios = (3, 2)[:columns]
    grid = panels(figure, len(rows), columns, between=0.55 + above, top=0.3 + above, width_ratios=ratios)
    for row, first, (label, unit, curves, legend) in zip(grid, firsts, rows, strict=True):
        last_label = ""  # beside it the same label would only take room
        in_all = max(float(np.abs(y).max()) for _, y in curves.values())
        for axes, (start, end) in zip(row, (first, (-MARGIN * duration, duration))[-columns:], strict=True):
            within = {name: (t >= start) & (t <= end) for name, (t, _) in curves.items()}
            shown = {name: (t[within[name]], y[within[name]]) for name, (t, y) in curves.items()}
            factor, named = scaled(unit, in_all)
            largest = max(float(np.abs(y).max(initial=0.0)) for _, y in shown.values())
            if factor * largest < LEGIBLE:
                factor, named = scaled(unit, largest)
            time, time_unit = scaled_time(end)
            for name, (t, y) in shown.items():
                x, values = thin_history(t, y)
                axes.plot(time * x, factor * values, **drawn[name], linewidth=1.0, label=legend[name])
            axes.set_xlim(time * start, time * end)
            text = f"{label} in {named}"
            finish(axes, f"time in {time_unit}", "" if text == last_label else text)
            last_label = text
        legend_above(row[0])
    return figure


def _begin(curves: Mapping[str, tuple[Floats, Floats]], window: float) -> float:
    """Where the panel of the first impact begins [s]: at 0, but of a row in which all is still 0 at the panel's end a
    little before it is not: the second hammer of a tapping machine strikes late.

    >>> t = np.linspace(0.0, 1.0, 11)
    >>> round(_begin({"late": (t, np.where(t > 0.45, 1.0, 0.0))}, 0.2), 6), _begin({"soon": (t, t)}, 0.2)
    (0.49, 0.0)
    """
    first = min((float(t[np.argmax(y != 0.0)]) for t, y in curves.values() if y.any()), default=0.0)
    if first < window:
        return 0.0
    return min(first - BEFORE * window, max(float(t[-1]) for t, _ in curves.values()) - window)


def responses(result: StudyResult) -> dict[str, Response]:
    """The responses of all cases that have one."""
    return {name: case.response for name, case in result.cases.items() if case.response is not None}


def _times(case: CaseResult) -> Floats:
    return np.empty(0) if case.response is None else case.response.t


def first_impact_end(result: StudyResult, duration: float) -> float:
    """End of the panel of the first impact [s]; without an impact, of the beginning."""
    window = next(iter(result.cases.values())).case.study.peaks.first_impact if has_contacts(result) else None
    return min(duration, AROUND * window if window else ZOOM_WITHOUT_RULE * duration)


def _first_panel(unit: str, curves: Mapping[str, tuple[Floats, Floats]], window: float) -> tuple[float, float]:
    """Start and end of the panel of the first impact of a row [s]: the window, of forces while they act in it."""
    begin = _begin(curves, window)
    if unit != "N":
        return begin, begin + window
    acting = []
    for t, y in curves.values():
        inside = (t >= begin) & (t <= begin + window)
        force = np.abs(y[inside])
        acting.append(t[inside][force > FORCE_IS_OVER * force.max(initial=0.0)])
    times = np.concatenate(acting)
    if not times.size:
        return begin, begin + window
    fewest = FEWEST * min(float(t[1] - t[0]) for t, _ in curves.values())
    length = min(window, max(AROUND * float(np.ptp(times)), fewest))
    if begin:
        begin = float(times.min()) - BEFORE * length
        return begin, begin + length
    return 0.0, min(window, float(times.min()) + length)


def differs_from_window(zoom: float, duration: float) -> bool:
    """Whether a panel of the first impact [s] shows more than one of the whole window."""
    return zoom < NEARLY * duration


# ----------------------------------------------------------------------------------------------------------------------
# Where the energy of an impact is over time: the ledger of every case, stacked.
# ----------------------------------------------------------------------------------------------------------------------

HELD_COLOURS: Final = {"bodies": "#0072b2", "structure": "#009e73", "contacts, links": "#e69f00"}
BESIDE_COLOURS: Final = ("#56b4e9", "#cc79a7", "#f0e442")  # of what holds energy of the modes beside the structure
LOST_COLOURS: Final = ("#e7b5ce", "#bcdff5", "#eab38a", "#f7f0a8", "#c9b8dd")  # pale: what is lost no longer moves
NOBODYS_COLOUR: Final = "#dddddd"  # of losses in the structure and all that is too little to be named
NAMED: Final = 0.01  # share of what was put in, from which on a loss has a colour of its own
LONG: Final = 2.0  # s: beyond it milliseconds have too many digits


def energy(result: StudyResult) -> Figure | None:
    """The ledger of every case, stacked: bodies, structure, contacts and links, what each contact and link took, other
    losses; up to what was put in.

    With two-way coupling, rooms and compliant walls stand beside the structure.
    """
    if no_energy(result):
        return None
    runs = responses(result)
    holders = dict.fromkeys(name for response in runs.values() for name in response.basis.holders)
    beside = [name for name in holders if name != "structure"]
    takers = _takers([response.ledger for response in runs.values()])
    above = 0.17 * ((len(beside) + len(takers) + 4) // 5)  # inches of further rows of the legend
    figure = new_figure(10.0, 1.25 + above + 2.3 * len(runs), "Energy over time")
    zooms = {name: first_impact_end(result, float(response.t[-1])) for name, response in runs.items()}
    columns = (
        2 if any(differs_from_window(zooms[name], float(response.t[-1])) for name, response in runs.items()) else 1
    )
    grid = panels(figure, len(runs), columns, between=0.75, top=0.8 + above, sharey="row")
    for row, (name, response) in zip(grid, runs.items(), strict=True):
        ledger = response.ledger
        factor, unit = scaled("J", float(_input(ledger).max()))
        whole = float(ledger.t[-1])
        time, time_unit = scaled_time(whole if whole > LONG or columns == 1 else zooms[name])  # one for both panels
        for axes, end in zip(row, (zooms[name], whole)[-columns:], strict=True):
            _stack(axes, response, (factor, time), end, beside, takers)
            finish(axes, f"time in {time_unit}", "")
            axes.set_xlim(0.0, time * end)
            axes.set_ylim(0.0, 1.08 * factor * float(_input(ledger).max()) or 1.0)
        row[0].set_ylabel(f"energy in {unit}")
        row[0].set_title(f"{name}   (ledger residual {ledger.residual:.1e})", fontsize=9, loc="left")
    grid[0, -1].legend(
        fontsize=8,
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        borderaxespad=2.2,  # above the titles of the panels
        frameon=False,
        ncols=4 if beside else 5,
        columnspacing=1.0,
    )
    return figure


def _losses(ledger: EnergyLedger) -> dict[str, Floats]:
    """What contacts and links took until now [m] [J]; an array of contacts, "NAME.1" and on, as one."""
    taken: dict[str, Floats] = {}
    for name, lost in (*ledger.lost_contacts.items(), *ledger.lost_links.items()):
        array = name.rpartition(".")[0] or name
        taken[array] = taken[array] + lost if array in taken else lost
    return taken


def _takers(ledgers: Sequence[EnergyLedger]) -> tuple[str, ...]:
    """The contacts and links that take most, as many as there are colours, in their own order."""
    share: dict[str, float] = {}
    for ledger in ledgers:
        for name, lost in _losses(ledger).items():
            share[name] = max(share.get(name, 0.0), float(lost[-1] / max(_input(ledger)[-1], np.finfo(float).tiny)))
    most = sorted(share, key=lambda name: -share[name])[: len(LOST_COLOURS)]
    return tuple(name for name in share if name in most and share[name] >= NAMED)


def _stack(
    axes: Axes, response: Response, by: tuple[float, float], end: float, beside: Sequence[str], takers: Sequence[str]
) -> None:
    factor, scale = by  # of energies and of times
    ledger, t = response.ledger, np.linspace(0.0, end, 500)
    bodies = np.sum(list(ledger.bodies.values()), axis=0) if ledger.bodies else np.zeros_like(ledger.t)
    structure, none = np.interp(t, ledger.t, ledger.structure), np.zeros_like(t)
    held, taken = energy_by_holder_over_time(response, t), _losses(ledger)
    lost = {f"lost in {name}": np.interp(t, ledger.t, taken[name]) if name in taken else none for name in takers}
    rest = np.interp(t, ledger.t, ledger.dissipated) - np.sum(list(lost.values()), axis=0)
    layers = {
        "bodies": np.interp(t, ledger.t, bodies),
        "structure": held.get("structure", structure),
        **{name: held.get(name, none) for name in beside},
        "contacts, links": np.interp(t, ledger.t, ledger.stored),
        **lost,
        "lost elsewhere" if takers else "dissipated": rest,
    }
    colours = {
        **{name: BESIDE_COLOURS[i % len(BESIDE_COLOURS)] for i, name in enumerate(beside)},
        **HELD_COLOURS,
        **dict(zip(lost, LOST_COLOURS, strict=False)),
    }
    axes.stackplot(
        scale * t,
        [factor * layer for layer in layers.values()],
        labels=list(layers),
        colors=[colours.get(name, NOBODYS_COLOUR) for name in layers],
        linewidth=0,
    )
    axes.plot(scale * t, factor * np.interp(t, ledger.t, _input(ledger)), "k--", linewidth=1.0, label="put in")


def _input(ledger: EnergyLedger) -> Floats:
    """Energy at the start and what work and blows brought since [nt] [J]."""
    put_in: Floats = ledger.start.total + ledger.work + ledger.blows
    return put_in


# ----------------------------------------------------------------------------------------------------------------------
# Figures of vibration over frequency: spectra of recorded velocities, accelerations and net forces in decibels.
# ----------------------------------------------------------------------------------------------------------------------

REFERENCES: Final = {  # what a channel's name ends or begins with: reference of its decibels (SI) and how it is written
    "velocity": (1e-9, "1 nm/s"),
    "acceleration": (1e-6, "1 µm/s²"),
    "net force": (1.0, "1 N"),
}


def spectrum(result: StudyResult, channel: str) -> Figure | None:
    """Lines of a velocity, an acceleration or a net force in all cases, as recorded; None where `no_spectrum`
    says why.

    The rms of each line, so that cases compare line by line. Frequencies end where the modal basis does: above, the
    answer is not complete.
    """
    if no_spectrum(result, channel):
        return None
    reference = next(one for word, one in REFERENCES.items() if channel.endswith(word) or channel.startswith(word))
    cases = {
        name: case for name, case in result.cases.items() if channel in case.channels and case.response is not None
    }
    drawn = case_lines(result.cases, result.plan.baseline)
    basis = result.cases[result.plan.baseline].basis
    modes = numbered_modes(basis)
    clocks = [case.response.clock for case in cases.values() if case.response is not None]
    top = min(spectrum_end_hz(basis, clock.sampling) for clock in clocks)
    figure = new_figure(11.0, 3.9 + 0.155 * len(cases), f"Spectrum of {channel}   (whole record, no filter)")
    ((axes,),) = panels(figure, 1, 1, between=0.5, top=0.55 + 0.155 * len(cases))
    peak, lowest, low, spacing = -np.inf, np.inf, LOWEST_HZ, 0.0
    for name, case in cases.items():
        assert case.response is not None
        values, sampling = case.channels[channel].values, case.response.clock.sampling
        frequency, level = level_spectrum(values * (REFERENCE_PA / reference[0]), 1.0 / sampling)
        spacing = float(frequency[1])
        low = max(min(LOWEST_HZ, 0.5 * min(modes.values(), default=LOWEST_HZ)), spacing)
        shown = (frequency >= low) & (frequency <= top) & (frequency < 0.5 * sampling)  # the last line is half a line
        x, y = thin_history(frequency[shown], level[shown], most=3000)
        axes.semilogx(x, y, **drawn[name], linewidth=0.9, label=name)
        peak = max(peak, float(np.fmax.reduce(level[shown], initial=-np.inf)))
        lowest = min(lowest, float(np.fmin.reduce(level[shown], initial=np.inf)))
    axes.set_xlim(low, top)
    if np.isfinite(peak):
        axes.set_ylim(max(lowest - 6, peak - DYNAMIC_RANGE_DB), peak + 6)
    label = mode_lines(axes, modes, low, top)
    finish(axes, label, f"level of lines {spacing:.3g} Hz apart, dB re {reference[1]}")
    legend_above(axes, up=12)
    plain_ticks(axes)
    return figure
