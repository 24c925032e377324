"""Tables of cases that a person reads: arrays of bodies, blows, accuracy, energies, machines and their limits."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial
from itertools import product
from math import isnan, nan
from typing import Final

from femstruct.errors import list_some
from femstruct.files.study_tables import TERMS, array_tables, growth
from femstruct.files.tables import unquotable
from femstruct.impact.numerical_error import ErrorEstimate, Resolved
from femstruct.impact.response import EnergyLedger, Outcome, Response
from femstruct.impact.shares import ModeEnergies, energy_shares
from femstruct.study.asked import Companion, EnergyShare, GroundForce, Machine, Verdict
from femstruct.study.results import AccuracyCheck, StudyResult
from femstruct.units import readable_unit
from femstruct.view.console import Grid, digits, doubt_note, scaled

# ----------------------------------------------------------------------------------------------------------------------
# The table of arrays of bodies a person reads in the terminal: each with its energy at the end, and their sum.
# ----------------------------------------------------------------------------------------------------------------------


def arrays(result: StudyResult) -> Grid:
    """A row for every body of an array, and one for all of them."""
    found = {
        name: array_tables(case.response) if case.response is not None else {} for name, case in result.cases.items()
    }
    ends = [row for tables in found.values() for table in tables.values() for row in table["end"].values()]
    joules = [scaled("J", max((abs(row[term]) for row in ends), default=0.0)) for term in TERMS]  # each column its own
    words = ("kinetic", "stored in its joints", "dissipated there")
    heads = (f"{word} [{unit}]" for word, (_, unit) in zip(words, joules, strict=True))
    grid = Grid("arrays of bodies, at the end", ("", "case", "peak force [N]", *heads), keys=2)
    for case_name, tables in found.items():
        for array, table in tables.items():
            for name, row in table["end"].items():
                peak = table["peak_force_n"].get(name)
                grid.add(
                    f"{array}, all" if peak is None else name,
                    case_name,
                    "" if peak is None else digits(peak),
                    *(f"{joule * row[term]:.4g}" for term, (joule, _) in zip(TERMS, joules, strict=True)),
                )
    return grid


# ----------------------------------------------------------------------------------------------------------------------
# The table of blows a person reads in the terminal.
# ----------------------------------------------------------------------------------------------------------------------

SHOWN_BLOWS = 5  # at each end of a row of blows


def blows(result: StudyResult) -> Grid:
    """Blow by blow; of a long row the first and the last, all are in summary.json."""
    every = [blow for case in result.cases.values() if case.response is not None for blow in case.response.blows]
    joule, unit = scaled("J", max((blow.largest_energy for blow in every), default=0.0))
    grid = Grid(
        "blows",
        (
            "",
            "case",
            "blow",
            "t [ms]",
            "peak force [N]",
            "closings",
            f"structure at most [{unit}]",
            "at rest after [ms]",
        ),
        keys=3,
    )
    for case_name, case in result.cases.items():
        recorded = case.response.blows if case.response is not None else ()
        for body in dict.fromkeys(blow.body for blow in recorded):
            mine = [blow for blow in recorded if blow.body == body]
            for blow in mine if len(mine) <= 2 * SHOWN_BLOWS else (*mine[:SHOWN_BLOWS], *mine[-SHOWN_BLOWS:]):
                grown = growth((mine[0], blow))
                change = f" ({100.0 * (grown - 1.0):+.1f} %)" if blow.number > 1 and grown is not None else ""
                at_rest = "" if not blow.seen else f"not in {1e3 * blow.interval:.4g}"
                at_rest = at_rest if blow.rest_after is None else f"{1e3 * blow.rest_after:.4g}"
                none = not case.basis.omega.size  # no structure that could take up energy, or come to rest
                grid.add(
                    body,
                    case_name,
                    f"{blow.number} of {len(mine)}",
                    f"{1e3 * blow.t:.3f}",
                    digits(blow.peak_force),
                    str(blow.closings),
                    "no structure" if none else f"{joule * blow.largest_energy:.4g}{change}",
                    "" if none else at_rest,
                )
    return grid


# ----------------------------------------------------------------------------------------------------------------------
# How far the numbers of a case may be off, a line each: what more modes change, and what the steps leave.
# ----------------------------------------------------------------------------------------------------------------------

RESOLVED: Final = 1e-6  # share from which on an estimated error is of interest to whom measures to 1 %


def has_contacts(result: StudyResult) -> bool:
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
    accuracies = [
        f"{name}: {accuracy(case.accuracy)}" for name, case in result.cases.items() if case.accuracy is not None
    ]
    estimates = {
        name: case.errors for name, case in result.cases.items() if case.errors is not None and case.errors.peak
    }
    alike: dict[str, list[ErrorEstimate]] = {}
    for one in estimates.values():
        if _largest([one]) < RESOLVED:
            alike.setdefault(_against(one), []).append(one)
    sentences = {
        name: _all_small(one, alike[_against(one)]) if _largest([one]) < RESOLVED else errors(one)
        for name, one in estimates.items()
    }
    return accuracies + _together(sentences, len(result.cases))


def _all_small(one: ErrorEstimate, alike: Sequence[ErrorEstimate]) -> str:
    """One sentence for all cases that the integration is done with for every purpose; their own numbers are in the
    files."""
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


def _together(sentences: Mapping[str, str], count: int) -> list[str]:
    """Sentences, each once, after the cases they hold for.

    >>> _together({"a": "It opened.", "b": "It opened.", "c": "It stuck."}, 3)
    ['a, b: It opened.', 'c: It stuck.']
    >>> _together({"a": "It opened.", "b": "It opened."}, 2)
    ['all cases: It opened.']
    """
    cases: dict[str, list[str]] = {}
    for name, sentence in sentences.items():
        cases.setdefault(sentence, []).append(name)
    return [
        f"{'all cases' if 1 < count == len(names) else list_some(names)}: {sentence}"
        for sentence, names in cases.items()
    ]


def accuracy(check: AccuracyCheck) -> str:
    """What more modes still change, and which are used."""
    if check.worst is None:
        return "accuracy: the basis contains all modes"
    name, worst = check.worst
    factor, unit = readable_unit(worst.unit, max(worst.smaller, worst.larger))
    return (
        f"accuracy: {name} {factor * worst.smaller:.4g} / {factor * worst.larger:.4g} {unit} with the modes up to "
        f"{check.smaller_hz:.5g} / {check.larger_hz:.5g} Hz, at most {100 * worst.share:.2g} % apart in "
        f"{check.band[0]:g} to {check.band[1]:g} Hz until {1e3 * check.window:.4g} ms; {100 * check.within:g} % "
        "required; "
        f"used: {check.used_modes} modes up to {check.used_hz:.5g} Hz"
    )


def errors(found: ErrorEstimate) -> str:
    """What the integration may leave the worst peak force and the worst end velocity wrong by, as shares."""
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


# ----------------------------------------------------------------------------------------------------------------------
# Where the energy of every case is and went.
# ----------------------------------------------------------------------------------------------------------------------

SMALLEST = 1e-6  # share of the energy that is told in percent
LEAST_SHARE_NAMED = 0.01  # share of the energy from which on a terminal names what has it
SEEN = 5e-4  # share of the energy that the sum of a column misses visibly
OTHERS = f"others, below {100 * LEAST_SHARE_NAMED:g} % each"
LEDGER_NOISE = 1e-9  # share of the energy put in, below which a ledger holds the tail of a decay and rounding


def energies(result: StudyResult) -> Grid:
    """The ledger at the start, the separation and the end: what was put in until then, by work and later blows too, and
    what has it, bodies and what holds the modes' energy by name."""
    ledgers = [case.response.ledger for case in result.cases.values() if case.response is not None]
    factor, unit = scaled("J", max(map(_put_in, ledgers), default=0.0))
    grid = Grid(
        f"energy [{unit}]",
        ("case", "when", "t [ms]", "put in", "bodies", "structure", "contacts, links", "dissipated", "ledger residual"),
        keys=3,
    )
    for name, case in result.cases.items():
        if case.response is None:
            continue
        ledger, shares = case.response.ledger, case.shares
        then, last = ({}, {}) if shares is None else (shares.held_at_separation, shares.held_at_end)
        instants = (("start", ledger.start), ("separation", ledger.at_separation), ("end", ledger.end))
        for (label, balance), parts in zip(instants, ({}, then, last), strict=True):
            if balance is None and not case.response.contacts:
                continue  # nothing meets, so nothing parts
            if balance is None:
                grid.add(name, label, "never", "", "", "", "", "", "")
                continue
            kinetic: dict[str, float] = {}
            for body, energy in balance.bodies.items():  # an array of bodies is told as one
                array = body.rpartition(".")[0] or body
                kinetic[array] = kinetic.get(array, 0.0) + energy
            tell = partial(_amount, factor=factor, nothing=LEDGER_NOISE * _put_in(ledger))
            bodies = ", ".join(f"{body} {tell(energy)}" for body, energy in kinetic.items())
            stored = sum(balance.contacts.values()) + sum(balance.links.values())
            grid.add(
                name,
                label,
                f"{1e3 * balance.t:.3f}",
                tell(ledger.start.total + balance.work + balance.blows),
                bodies,
                ", ".join(_part(name, tell(energy)) for name, energy in parts.items()) or tell(balance.structure),
                tell(stored),
                tell(balance.dissipated),
                f"{ledger.residual:.1e}" if label == "end" else "",
            )
    return grid


def _part(name: str, energy: str) -> str:
    """What of the column "structure" something holds.

    >>> _part("structure", "12.3"), _part("air of box", "4.5")
    ('12.3', 'air of box 4.5')
    """
    return energy if name == "structure" else f"{name} {energy}"


def _put_in(ledger: EnergyLedger) -> float:
    """Energy at the start and what work and blows brought until the end [J]."""
    return ledger.start.total + ledger.end.work + ledger.end.blows


def _amount(energy: float, factor: float, nothing: float) -> str:
    """An energy [J] in the unit of the table, 0 for what is none.

    >>> _amount(0.1218, 1e3, 1e-10), _amount(2e-17, 1e3, 1e-10)
    ('121.8', '0')
    """
    return f"{factor * energy:.4g}" if abs(energy) >= nothing else "0"


def energy_destinations(result: StudyResult) -> Grid:
    """What holds the energy of a case and what took it: bodies, modes, contacts and links, losses."""
    moments = {
        name: _shares_at(case.response.ledger, case.shares)
        for name, case in result.cases.items()
        if case.response is not None and case.shares is not None
    }
    parted = any(first for first, _ in moments.values())  # nowhere: nothing meets, or what met stays together
    grid = Grid(f"where the energy went [% {'at the separation / ' if parted else ''}at the end]", ("", *moments))
    all_shares = [share for both in moments.values() for shares_then in both for share in shares_then.items()]
    named = dict.fromkeys(what for what, share in all_shares if share >= LEAST_SHARE_NAMED)
    rows = dict.fromkeys(named, moments)
    rest = {name: [_unnamed(then, named) for then in both] for name, both in moments.items()}
    if any(share >= SEEN for both in rest.values() for then in both for share in then.values()):
        rows[OTHERS] = rest
    for holder, of_cases in rows.items():
        texts = [[_share(then.get(holder)) for then in (both if parted else both[1:])] for both in of_cases.values()]
        grid.add(holder, *(" / ".join(both) for both in texts))
    return grid


def _shares_at(ledger: EnergyLedger, shares: ModeEnergies) -> list[dict[str, float]]:
    """Shares of the energy by what has or took them, at the separation ({} where there is none) and at the end."""
    return [
        {} if balance is None or groups is None or taken is None else energy_shares(balance, groups, taken)
        for balance, groups, taken in (
            (ledger.at_separation, shares.at_separation, shares.dashpots_at_separation),
            (ledger.end, shares.end, shares.dashpots_at_end),
        )
    ]


def _unnamed(then: Mapping[str, float], named: Collection[str]) -> dict[str, float]:
    """What is left of the energy beside what is named, at one instant."""
    return {OTHERS: 1.0 - sum(abs(then.get(what, 0.0)) for what in named)} if then else {}


def _share(share: float | None) -> str:
    """Percent of what was put in, 0 for what is none.

    >>> _share(0.0333), _share(2.8e-31), _share(None)
    ('3.33', '0', '-')
    """
    return "-" if share is None else f"{100 * share:.3g}" if abs(share) >= SMALLEST else "0"


# ----------------------------------------------------------------------------------------------------------------------
# The tables of a machine and of its limits that a person reads in the terminal.
# ----------------------------------------------------------------------------------------------------------------------

SAGS, MODES = "sags [mm]", "modes of blocks [Hz], damping"
MODES_SHOWN = 6  # a block on springs has six; more are in summary.json
LEAST_TILT = 1e-6  # rad: a micrometre a metre is rounding, or nobody's concern


def limits(result: StudyResult) -> Grid:
    """A row for every limit, a column for every case: the verdict, what came out and what is left."""
    unsure = any(not verdict.converged for verdicts in result.verdicts.values() for verdict in verdicts)
    title = "limits (? : do not quote, see peak-not-converged and stress-uneven)" if unsure else "limits"
    grid = Grid(title, ("", "at most", *result.cases), keys=2)
    first: dict[str, Verdict] = {}
    for verdicts in result.verdicts.values():
        for verdict in verdicts:
            first.setdefault(verdict.name, verdict)
    for name, sample in first.items():
        own = {case: next((v for v in result.verdicts[case] if v.name == name), None) for case in result.verdicts}
        bounds = {verdict.limit for verdict in own.values() if verdict is not None}
        bound = _amount_in(sample.limit, sample.unit) if len(bounds) == 1 else "see cases"
        grid.add(name, bound, *(_verdict(own.get(case), len(bounds) > 1) for case in result.cases))
    return grid


def _verdict(verdict: Verdict | None, with_limit: bool) -> str:
    if verdict is None:
        return "-"
    of = f" of {_amount_in(verdict.limit, verdict.unit)}" if with_limit else ""
    of += f" at {verdict.at}" if verdict.at else ""
    if verdict.least:
        value_text = "-" if verdict.value is None else f"at least {_amount_in(verdict.value, verdict.unit)}"
        return f"{'not known' if verdict.met is None else 'exceeded'}\n{value_text}{of}"
    if verdict.value is None:
        seen = f"not in {verdict.seen:.4g} s{of}"
        return f"exceeded\n{seen}" if verdict.met is False else f"not seen\n{seen}"
    margin, mark = abs(verdict.limit - verdict.value), "" if verdict.converged else " ?"
    share = "" if verdict.unit == "dB" else f" ({100.0 * margin / verdict.limit:.3g} %)"  # of a level it means nothing
    value_text = f"{_amount_in(verdict.value, verdict.unit)}{' (statistical bands)' if verdict.statistical else ''}{of}"
    if verdict.met is None:
        return f"not seen\n{value_text}"
    if verdict.met:
        return f"met{mark}\n{value_text}, {_amount_in(margin, verdict.unit)}{share} left"
    return f"exceeded by {_amount_in(margin, verdict.unit)}{share}{mark}\n{value_text}"


def _amount_in(value: float, unit: str) -> str:
    """A value in the unit a machine is spoken of.

    >>> _amount_in(6e5, "N"), _amount_in(8e-3, "m"), _amount_in(1.0, "s")
    ('600 kN', '8 mm', '1 s')
    """
    if unit == "N" and abs(value) >= 1e3:
        return f"{1e-3 * value:.4g} kN"
    if unit == "Pa" and abs(value) >= 1e4:
        return f"{1e-6 * value:.4g} MPa"
    return f"{1e3 * value:.4g} m{unit}" if unit in ("m", "m/s") else f"{value:.4g} {unit}"


def machine(result: StudyResult) -> Grid:
    """One row a case: what a press engineer looks at first."""
    cases = result.machine
    travels = list(dict.fromkeys(name for one in cases.values() for name in one.travels))
    columns = _machine_columns(cases, travels)
    titles = [title for title, _ in columns]
    cells = {name: [tell(one) for _, tell in columns] for name, one in cases.items()}
    note = _mark_doubtful(result, travels, titles.index(SAGS) - len(travels), cells)
    if any(result.verdicts.values()):
        titles.append("limits")
        for name, row in cells.items():
            row.append(_judged(result.verdicts.get(name, ())))
    _refer_to_baseline(result, [i for i, title in enumerate(titles) if title in (SAGS, MODES)], cells)
    kept = [i for i in range(len(titles)) if any(set(row[i]) - set("-\n 0.") for row in cells.values())]
    title = f"machine (energies: when the first contact ends, and at the end{note})"
    grid = Grid(title, ("", *(titles[i] for i in kept)))
    for name, row in cells.items():
        grid.add(name, *(row[i] for i in kept))
    return grid


def _machine_columns(
    cases: Mapping[str, Machine], travels: Sequence[str]
) -> list[tuple[str, Callable[[Machine], str]]]:
    """Title of each column and what stands in it, in units that suit all cases; columns of travels end before SAGS."""
    first = next((m.ground for m in cases.values() if m.ground is not None), None)
    newton, force = scaled("N", 0.0 if first is None else first.dynamic)
    joule, energy = scaled("J", max((m.at_end.put_in for m in cases.values()), default=0.0))
    return [
        (f"ground [{force}]", lambda m: _of(m.ground, lambda g: _weighed(g.dynamic, newton))),
        (f"with weight [{force}]", lambda m: _of(m.ground, lambda g: _weighed(g.with_weight, newton))),
        ("beside baseline", lambda m: _of(m.ground, _beside)),
        *((f"{name.removesuffix(' displacement')} [mm]", partial(_travel, name)) for name in travels),
        (SAGS, _sags),
        (MODES, _modes),
        ("at rest after [s]", _rest),
        ("damper: travel, closings", _companions),
        ("forged [%]", lambda m: _shares(m, "forged")),
        ("striker", lambda m: _shares(m, "strikers")),
        ("structure", lambda m: _shares(m, "structure")),
        ("damper", lambda m: _shares(m, "companions")),
        ("dissipated", lambda m: _shares(m, "dissipated")),
        (f"of [{energy}]", lambda m: "\n".join(f"{joule * share.put_in:.4g}" for share in _instants(m))),
        ("last blow / first", _growth),
    ]


def _mark_doubtful(result: StudyResult, travels: Sequence[str], starts: int, cells: Mapping[str, list[str]]) -> str:
    """Put a mark beside travels that are not to be quoted; what the title says of it, "" without any.

    Parameters
    ----------
    starts : int
        Number of the first column of travels.
    """
    doubts = {name: unquotable(result.cases[name]) for name in cells}
    for (name, row), (i, travel) in product(cells.items(), enumerate(travels, starts)):
        row[i] += " ?" if travel in doubts[name] else ""
    return doubt_note([code for found in doubts.values() for name, code in found.items() if name in travels], "; ")


def _refer_to_baseline(result: StudyResult, columns: Sequence[int], cells: Mapping[str, list[str]]) -> None:
    """In some columns, write "as baseline" for what a case has in common with it."""
    baseline = cells.get(result.comparison.baseline)  # another run beside it may not be about a machine
    for row in cells.values():
        if baseline is not None and row is not baseline:
            for i in columns:
                row[i] = "as baseline" if row[i] == baseline[i] != "-" else row[i]


def _of(ground: GroundForce | None, tell: Callable[[GroundForce], str]) -> str:
    return "-" if ground is None else tell(ground)


def _weighed(value: float | None, factor: float) -> str:
    return "-" if value is None or isnan(value) else f"{factor * value:.4g}"


def _judged(verdicts: Sequence[Verdict]) -> str:
    """The limits a case exceeds, a line each, and those that the window or the modes are too short for."""
    lines = [f"{one.name} exceeded{'' if one.converged else ' ?'}" for one in verdicts if one.met is False]
    lines += [
        f"{verdict.name} not {'known' if verdict.least else 'seen'}" for verdict in verdicts if verdict.met is None
    ]
    return "\n".join(lines) or ("-" if not verdicts else "met" if all(one.converged for one in verdicts) else "met ?")


def _travel(channel: str, machine: Machine) -> str:
    travel = machine.travels.get(channel, nan)
    return "-" if isnan(travel) else f"{1e3 * travel:.3g}"


def _beside(ground: GroundForce) -> str:
    if ground.percent is None or ground.attenuation_db is None:
        return "-"
    return f"{ground.percent:+.1f} %\n{-ground.attenuation_db:+.1f} dB"


def _sags(machine: Machine) -> str:
    lines = []
    for sag in machine.sags:
        leaning = f", leans {1e3 * sag.tilt:.2g} mm/m" if sag.tilt is not None and sag.tilt > LEAST_TILT else ""
        lines.append(f"{sag.part} {1e3 * sag.sag:.3g}{leaning}")
    return "\n".join(lines) or "-"


def _modes(machine: Machine) -> str:
    lines = [
        f"{mode.frequency_hz:.2f} ({max(mode.shares, key=mode.shares.__getitem__)})"
        + ("" if isnan(mode.ratio) else f" {100 * mode.ratio:.3g} %")
        for mode in machine.modes[:MODES_SHOWN]
    ]
    return "\n".join(lines) or "-"


def _rest(machine: Machine) -> str:
    if machine.rest is None:
        return "-"
    if machine.rest.after is None:
        return f"not in {machine.rest.interval:.4g}"
    return f"{machine.rest.after:.3g} of {machine.rest.interval:.4g}"


def _companions(machine: Machine) -> str:
    return "\n".join(_companion(name, one) for name, one in machine.companions.items()) or "-"


def _companion(name: str, one: Companion) -> str:
    seated = "" if one.seated is None else ", seated" if one.seated else ", not seated"
    travel = "-" if isnan(one.travel) else f"{1e3 * one.travel:.3g} mm"
    return f"{name} {travel}, {one.closings}{seated}"


def _instants(machine: Machine) -> list[EnergyShare]:
    return [share for share in (machine.at_separation, machine.at_end) if share is not None]


def _shares(machine: Machine, term: str) -> str:
    """Percent of what was put in, a line when the first contact ends and one at the end."""
    return "\n".join(
        f"{100.0 * getattr(share, term) / share.put_in:.1f}" if share.put_in > 0.0 else "-"
        for share in _instants(machine)
    )


def _growth(machine: Machine) -> str:
    lines = [f"{body} {value:.4g}" for body, value in machine.growth.items() if value is not None]
    return "\n".join(lines) or "-"
