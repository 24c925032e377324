"""The tables of a machine and of its limits that a person reads in the terminal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from itertools import product
from math import isnan, nan

from femstruct.files.tables.finding_tables import unquotable
from femstruct.study.machine import Companion, EnergyShare, GroundForce, Machine, Verdict
from femstruct.study.result import StudyResult
from femstruct.view.tables.finding_lines import doubted
from femstruct.view.tables.grid import Grid
from femstruct.view.tables.scales import scaled

SAGS, MODES = "sags [mm]", "modes of blocks [Hz], damping"
MODES_SHOWN = 6  # a block on springs has six; more are in summary.json
LEANS = 1e-6  # rad: a micrometre a metre is rounding, or nobody's concern


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
        bound = _amount(sample.limit, sample.unit) if len(bounds) == 1 else "see cases"
        grid.add(name, bound, *(_verdict(own.get(case), len(bounds) > 1) for case in result.cases))
    return grid


def _verdict(verdict: Verdict | None, with_limit: bool) -> str:
    if verdict is None:
        return "-"
    of = f" of {_amount(verdict.limit, verdict.unit)}" if with_limit else ""
    of += f" at {verdict.at}" if verdict.at else ""
    if verdict.least:
        told = "-" if verdict.value is None else f"at least {_amount(verdict.value, verdict.unit)}"
        return f"{'not known' if verdict.met is None else 'exceeded'}\n{told}{of}"
    if verdict.value is None:
        seen = f"not in {verdict.seen:.4g} s{of}"
        return f"exceeded\n{seen}" if verdict.met is False else f"not seen\n{seen}"
    margin, mark = abs(verdict.limit - verdict.value), "" if verdict.converged else " ?"
    share = "" if verdict.unit == "dB" else f" ({100.0 * margin / verdict.limit:.3g} %)"  # of a level it means nothing
    told = f"{_amount(verdict.value, verdict.unit)}{' (statistical bands)' if verdict.statistical else ''}{of}"
    if verdict.met is None:
        return f"not seen\n{told}"
    if verdict.met:
        return f"met{mark}\n{told}, {_amount(margin, verdict.unit)}{share} left"
    return f"exceeded by {_amount(margin, verdict.unit)}{share}{mark}\n{told}"


def _amount(value: float, unit: str) -> str:
    """A value in the unit a machine is spoken of.

    >>> _amount(6e5, "N"), _amount(8e-3, "m"), _amount(1.0, "s")
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
    first = next((m.ground for m in cases.values() if m.ground is not None), None)
    newton, force = scaled("N", 0.0 if first is None else first.dynamic)
    joule, energy = scaled("J", max((m.at_end.put_in for m in cases.values()), default=0.0))
    columns: list[tuple[str, Callable[[Machine], str]]] = [
        (f"ground [{force}]", lambda m: _of(m.ground, lambda g: _weighed(g.dynamic, newton))),
        (f"with weight [{force}]", lambda m: _of(m.ground, lambda g: _weighed(g.with_weight, newton))),
        ("beside baseline", lambda m: _of(m.ground, _beside)),
    ]
    travels = dict.fromkeys(name for one in cases.values() for name in one.travels)
    columns += [(f"{name.removesuffix(' displacement')} [mm]", partial(_travel, name)) for name in travels]
    columns += [
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
    cells = {name: [tell(one) for _, tell in columns] for name, one in cases.items()}
    doubts = {name: unquotable(result.cases[name]) for name in cases}
    starts = next(i for i, (column, _) in enumerate(columns) if column == SAGS) - len(travels)
    for (name, row), (i, travel) in product(cells.items(), enumerate(travels, starts)):
        row[i] += " ?" if travel in doubts[name] else ""
    told = doubted([code for found in doubts.values() for name, code in found.items() if name in travels], "; ")
    if any(result.verdicts.values()):
        columns.append(("limits", lambda m: ""))
        for name, row in cells.items():
            row.append(_judged(result.verdicts.get(name, ())))
    same = [i for i, (column, _) in enumerate(columns) if column in (SAGS, MODES)]
    baseline = cells.get(result.comparison.baseline)  # another run beside it may not be about a machine
    for row in cells.values():
        if baseline is not None and row is not baseline:
            row[:] = ["as baseline" if i in same and one == baseline[i] != "-" else one for i, one in enumerate(row)]
    kept = [i for i in range(len(columns)) if any(set(row[i]) - set("-\n 0.") for row in cells.values())]
    title = f"machine (energies: when the first contact ends, and at the end{told})"
    grid = Grid(title, ("", *(columns[i][0] for i in kept)))
    for name, row in cells.items():
        grid.add(name, *(row[i] for i in kept))
    return grid


def _of(ground: GroundForce | None, tell: Callable[[GroundForce], str]) -> str:
    return "-" if ground is None else tell(ground)


def _weighed(value: float | None, factor: float) -> str:
    return "-" if value is None or isnan(value) else f"{factor * value:.4g}"


def _judged(verdicts: Sequence[Verdict]) -> str:
    """The limits a case exceeds, a line each, and those that the window or the modes are too short for."""
    told = [f"{one.name} exceeded{'' if one.converged else ' ?'}" for one in verdicts if one.met is False]
    told += [
        f"{verdict.name} not {'known' if verdict.least else 'seen'}" for verdict in verdicts if verdict.met is None
    ]
    return "\n".join(told) or ("-" if not verdicts else "met" if all(one.converged for one in verdicts) else "met ?")


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
        leaning = f", leans {1e3 * sag.tilt:.2g} mm/m" if sag.tilt is not None and sag.tilt > LEANS else ""
        lines.append(f"{sag.part} {1e3 * sag.sag:.3g}{leaning}")
    return "\n".join(lines) or "-"


def _modes(machine: Machine) -> str:
    told = [
        f"{mode.frequency_hz:.2f} ({max(mode.shares, key=mode.shares.__getitem__)})"
        + ("" if isnan(mode.ratio) else f" {100 * mode.ratio:.3g} %")
        for mode in machine.modes[:MODES_SHOWN]
    ]
    return "\n".join(told) or "-"


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
    told = [f"{body} {value:.4g}" for body, value in machine.growth.items() if value is not None]
    return "\n".join(told) or "-"
