"""The numbers of a study as plain tables, ready for JSON: what `--json` prints and the results file keeps."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from acoustics.levels.ensemble import Interval
from acoustics.levels.rated import RatedRoom
from femstruct.files.tables.array_tables import array_tables
from femstruct.files.tables.described import columns, described
from femstruct.files.tables.error_tables import error_table
from femstruct.files.tables.finding_tables import finding_table, study_findings_table, unquotable
from femstruct.files.tables.json_numbers import label, number
from femstruct.files.tables.machine_tables import machine_table, verdict_tables
from femstruct.files.tables.radiated_tables import radiated_beside, radiated_table, shares_table
from femstruct.impact.result.response import Blow, EnergyBalance, Response
from femstruct.impact.result.shares import EnergyGroup, ModeEnergies
from femstruct.study.result import CaseComparison, CaseResult, StudyResult

Table = dict[str, Any]


def summary(result: StudyResult) -> Table:
    """All cases and their comparison in the layout of ``--json``; numbers that do not exist are None.

    In the comparison, `bands_db` and `modes_db` are those of the first receiver's pressure (without a room, of the
    first recorded channel); `bands_db_by_receiver` and `modes_db_by_channel` have all. Attenuations are positive where
    the case is quieter than the baseline; `rated_db` is what a room's single numbers are above the baseline's, negative
    then, `rated_spread_db` what that spreads over the drops, `sound_energy_db` what the sound energy into the open is
    above the baseline's. `levels` are those of what the structure radiates; where striking bodies have own sound,
    `own_levels` are theirs and `total_levels` those of all. A sound ends at its `complete_below_hz`, where its modes
    do; bands that reach above it are None, and a single number that needs them is what it is `at_least`.
    """
    baseline = result.cases[result.comparison.baseline] if result.comparison.cases else None
    comparison = {
        name: _comparison(result.cases[name], beside)
        | {
            "rated_db": _rated_beside(result.cases[name], baseline, RatedRoom.above),
            "rated_spread_db": _rated_beside(result.cases[name], baseline, RatedRoom.above_spread_db),
            "sound_energy_db": radiated_beside(result.cases[name], baseline),
        }
        for name, beside in result.comparison.cases.items()
    }
    cases = {
        name: case_table(case)
        | {
            "limits": verdict_tables(result.verdicts.get(name, ())),
            "machine": machine_table(result.machine[name]) if name in result.machine else None,
        }
        for name, case in result.cases.items()
    }
    return {"cases": cases, "comparison": comparison, "findings": study_findings_table(result)}


def case_table(case: CaseResult) -> Table:
    """The numbers of one case by itself, as `summary` has them."""
    response, unsure = case.response, unquotable(case)
    return described(case) | {
        "outcome": None if response is None else response.outcome.value,
        "basis": case.basis_key,
        "peaks": {
            name: {
                "first_impact": number(channel.first_impact),
                "whole": number(channel.whole),
                "unit": channel.unit,
                "converged": name not in unsure,
            }
            for name, channel in case.channels.items()
        },
        "contacts": {} if response is None else {name: described(one) for name, one in response.contacts.items()},
        "bodies": {} if response is None else {name: described(one) for name, one in response.bodies.items()},
        "blows": {} if response is None else _blows(response),
        "arrays": {} if response is None else array_tables(response),
        "energy": None if response is None else _energy(response, case.shares),
        "stresses": {name: described(one.stressed) for name, one in case.channels.items() if one.stressed is not None},
        "sound_energy": {name: radiated_table(radiated) for name, radiated in case.radiated.items()},
        "by_surface": {name: shares_table(shares) for name, shares in case.by_surface.items()},
        "rated": {name: _rated(rated) for name, rated in case.rated.items()},
        "error_estimate": None if case.errors is None else error_table(case.errors),
        "findings": [finding_table(finding) for finding in case.findings],
    }


def _blows(response: Response) -> Table:
    """Blow by blow, by body; energy_growth is what the last blow leaves the structure at most over what the first."""
    names = dict.fromkeys(blow.body for blow in response.blows)
    own = {name: [blow for blow in response.blows if blow.body == name] for name in names}
    return {name: columns(blows) | {"energy_growth": number(growth(blows))} for name, blows in own.items()}


def growth(blows: Sequence[Blow]) -> float | None:
    """Largest energy of the structure after the last blow over that after the first; None when that is zero."""
    return blows[-1].largest_energy / blows[0].largest_energy if blows[0].largest_energy > 0.0 else None


def _energy(response: Response, shares: ModeEnergies | None) -> Table:
    """The ledger; `modes` are the groups that "structure" is the sum of, `held_by` the same by what holds it where air
    pushes back; `lost` are the parts of "dissipated": in modes, in the structure's own dashpots, in contacts and
    links."""
    ledger = response.ledger
    separation = ledger.at_separation
    parted, end = (None, None) if shares is None else (shares.at_separation, shares.end)
    taken_then, taken = (None, 0.0) if shares is None else (shares.dashpots_at_separation, shares.dashpots_at_end)
    held_then, held = ({}, {}) if shares is None else (shares.held_at_separation, shares.held_at_end)
    start = ledger.start
    stored = sum(start.bodies.values()) + start.structure + sum(start.contacts.values()) + sum(start.links.values())
    return {
        "input_j": number(stored + ledger.end.work + ledger.end.blows),
        "at_separation": None if separation is None else _balance(separation, parted, taken_then or 0.0, held_then),
        "end": _balance(ledger.end, end, taken, held),
        "ledger_residual": number(ledger.residual),
    }


def _balance(
    balance: EnergyBalance, groups: Sequence[EnergyGroup] | None, dashpots: float, held: Mapping[str, float]
) -> Table:
    return {
        "t_s": number(balance.t),
        **{name: number(value) for name, value in balance.bodies.items()},
        "structure": number(balance.structure),
        "modes": [
            {"name": g.name, "from_hz": number(g.from_hz), "to_hz": number(g.to_hz), "energy_j": number(g.energy)}
            for g in groups or ()
        ],
        "held_by": {name: number(energy) for name, energy in held.items()},
        "stored": number(sum(balance.contacts.values()) + sum(balance.links.values())),
        "dissipated": number(balance.dissipated),
        "lost": {
            "modes": number(balance.lost_modes - dashpots),
            "dashpots": number(dashpots),
            "contacts": {name: number(lost) for name, lost in balance.lost_contacts.items()},
            "links": {name: number(lost) for name, lost in balance.lost_links.items()},
        },
        "work": number(balance.work),
        "blows": number(balance.blows),
    }


def _comparison(case: CaseResult, beside: CaseComparison) -> Table:
    bands = {name: _by_frequency(values) for name, values in beside.bands_db.items()}
    modes = {
        name: {str(mode): number(value) for mode, value in values.items()} for name, values in beside.modes_db.items()
    }
    return {
        "peaks": {
            name: {
                "first_impact_percent": number(change.first_impact_percent),
                "whole_percent": number(change.whole_percent),
                "converged": change.converged,
            }
            for name, change in beside.peaks.items()
        },
        "bands_db": next(iter(bands.values()), {}),
        "modes_db": _first(case, modes),
        "bands_db_by_receiver": bands,
        "modes_db_by_channel": modes,
        "notes": list(beside.notes),
    }


def _first(case: CaseResult, modes: Mapping[str, Table]) -> Table:
    """Attenuations of the first receiver's pressure, or of the first channel where there is no room."""
    heard = (f"{room}.{receiver} pressure" for room in case.rooms for receiver in _receivers(case, room))
    return next((modes[name] for name in heard if name in modes), next(iter(modes.values()), {}))


def _receivers(case: CaseResult, room: str) -> tuple[str, ...]:
    return tuple(receiver.name for plan in case.case.study.rooms if plan.name == room for receiver in plan.receivers)


def _by_frequency(values: Mapping[float, float]) -> Table:
    return {label(frequency): number(value) for frequency, value in values.items()}


def _rated(rated: RatedRoom) -> Table:
    """A room as the standards state it: its single numbers by symbol, the first the one to state, and its bands."""
    spreads = {"drops_spread_db": rated.drops_spread_db, "receivers_spread_db": rated.receivers_spread_db}
    numbers = {
        symbol: described(one)
        | {name: number(spread[symbol]) for name, spread in spreads.items()}
        | _interval(rated.number_intervals.get(symbol))
        for symbol, one in rated.numbers.items()
    }
    told = None if rated.statistical is None else described(rated.statistical)
    beside = None if rated.agreement is None else described(rated.agreement)
    statistical = {"statistical": told, "statistical_agreement": beside}
    statistical["ensemble"] = None if rated.ensemble is None else described(rated.ensemble)
    return described(rated.method) | described(rated) | statistical | {"numbers": numbers}


def _interval(one: Interval | None) -> Table:
    """Mean and 90 % interval of a number over rooms and places."""
    found = (None, None, None) if one is None else one
    return {name: number(value) for name, value in zip(("mean_db", "low_db", "high_db"), found, strict=True)}


def _rated_beside(
    case: CaseResult, baseline: CaseResult | None, told: Callable[[RatedRoom, RatedRoom], Mapping[str, float]]
) -> Table:
    """By room and symbol, what is told of its single numbers beside the baseline's [dB]."""
    before = {} if baseline is None else baseline.rated
    return {
        room: {symbol: number(value) for symbol, value in told(rated, before[room]).items()}
        for room, rated in case.rated.items()
        if room in before
    }
