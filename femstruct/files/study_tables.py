"""The numbers of a study as plain tables, ready for JSON: what `--json` prints and the results file keeps."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from math import isfinite
from typing import TYPE_CHECKING, Any, Final

from acoustics.levels.rated import Interval, RatedRoom
from acoustics.open_air.power import Directivity
from femstruct.arrays import Floats
from femstruct.files.datasets import axis, group, put
from femstruct.files.described import columns, describe, write_described, write_rows
from femstruct.files.tables import finding_table, label, number, study_findings_table, unquotable
from femstruct.impact.numerical_error import ErrorEstimate, Resolved
from femstruct.impact.response import Blow, EnergyBalance, Response
from femstruct.impact.scene import Contact, Link
from femstruct.impact.shares import EnergyGroup, ModeEnergies
from femstruct.sound.flanking import SurfaceShares
from femstruct.sound.radiated_power import PowerResponse, Radiated
from femstruct.study.asked import EnergyShare, Machine, Verdict
from femstruct.study.results import CaseComparison, CaseResult, StudyResult

if TYPE_CHECKING:
    import h5py


# ----------------------------------------------------------------------------------------------------------------------
# How far the numbers of a case may be off by what the integration leaves, as tables.
# ----------------------------------------------------------------------------------------------------------------------

KINDS: Final = (
    ("first_peak_force", "first_peak", "contact", "N", "Peak force before any contact closes again"),
    ("peak_force", "peak", "contact", "N", "Peak force of the whole window"),
    ("end_velocity", "velocity", "body", "m/s", "Velocity at the end of the window"),
)


def error_table(found: ErrorEstimate) -> Table:
    """Numbers of the impact and how far the integration may be from them, by contact or body; infinite errors are
    None."""
    return (
        {"from": "rounding" if found.exact else "a stricter run"}
        | describe(found)
        | {
            name: {of: describe(one) | {"unit": unit} for of, one in getattr(found, field).items()}
            for name, field, _, unit, _ in KINDS
        }
    )


def write_errors(target: h5py.Group, found: ErrorEstimate) -> None:
    """The errors in the results file, a group for each kind of number in its unit; an exact integration has no
    tolerances."""
    write_described(target, found)
    for name, field, of, unit, description in KINDS:
        numbers: Mapping[str, Resolved] = getattr(found, field)
        if numbers:
            made = group(target, name, description)
            write_rows(made, list(numbers.values()), axis(made, of, list(numbers), "1", "Name"))
            for one in ("value", "error", "scale"):
                made[one].attrs["unit"] = made[one].attrs["units"] = unit


# ----------------------------------------------------------------------------------------------------------------------
# Verdicts on limits and the row of a machine as tables, for JSON and the results file.
# ----------------------------------------------------------------------------------------------------------------------


def verdict_tables(verdicts: Sequence[Verdict]) -> Table:
    """By name of the limit: value, limit, margin (negative where exceeded), the verdict, and of several drops the place
    of the worst."""
    return {one.name: describe(one) | {"at": one.at or None} for one in verdicts}


def write_verdicts(target: h5py.Group, verdicts: Sequence[Verdict]) -> None:
    """The same in the results file."""
    write_rows(target, verdicts, axis(target, "name", [one.name for one in verdicts], "1", "What is limited"))


def machine_table(machine: Machine) -> Table:
    """A row of the machine table; numbers that do not exist are None."""
    ground, rest = machine.ground, machine.rest
    return {
        "ground_force": None
        if ground is None
        else {
            "dynamic_n": number(ground.dynamic),
            "with_weight_n": number(ground.with_weight),
            "percent": ground.percent,
            "attenuation_db": ground.attenuation_db,
        },
        "travel_m": {name: number(travel) for name, travel in machine.travels.items()},
        "sags": {sag.part: {"sag_m": sag.sag, "tilt_rad": sag.tilt} for sag in machine.sags},
        "block_modes": [
            {
                "mode": mode.number,
                "frequency_hz": mode.frequency_hz,
                "damping_ratio": mode.ratio if isfinite(mode.ratio) else None,
                "shares": mode.shares,
            }
            for mode in machine.modes
        ],
        "rest": None if rest is None else {"after_s": rest.after, "interval_s": rest.interval},
        "companions": {
            name: {"travel_m": number(one.travel), "closings": one.closings, "seated": one.seated}
            for name, one in machine.companions.items()
        },
        "energy": {
            "at_separation": None if machine.at_separation is None else _share(machine.at_separation),
            "end": _share(machine.at_end),
        },
        "energy_growth": dict(machine.growth),
    }


def _share(share: EnergyShare) -> Table:
    terms = asdict(share)
    return {"t_s": terms.pop("t"), **{f"{name}_j": value for name, value in terms.items()}}


# ----------------------------------------------------------------------------------------------------------------------
# Sound energies, powers and directivities as tables, for JSON and the results file.
# ----------------------------------------------------------------------------------------------------------------------


def radiated_table(radiated: Radiated) -> Table:
    """What a surface radiated into a half space; levels re 1 pJ, None in silence."""
    pattern = {"directivity": _pattern_table(radiated.pattern)}
    return describe(radiated.energy) | describe(radiated) | pattern


def radiated_difference(case: CaseResult, baseline: CaseResult | None) -> Table:
    """By half space, what the level of the sound energy is above the baseline's [dB]; None in silence."""
    before = {} if baseline is None else baseline.radiated
    return {
        room: number(one.energy.level_db - before[room].energy.level_db)
        for room, one in case.radiated.items()
        if room in before and isfinite(before[room].energy.level_db)
    }


def _pattern_table(pattern: Directivity) -> Table:
    """By frequency [Hz]: how much louder the loudest direction is than the mean of the half sphere, and where it is."""
    table = {}
    for line, (frequency, index) in enumerate(zip(pattern.frequency_hz, pattern.index_db, strict=True)):
        circle, angle = pattern.loudest(line)
        table[label(frequency)] = {"index_db": number(index), "along": pattern.sides[circle], "angle_deg": angle}
    return table


def write_radiated(target: h5py.Group, radiated: Radiated) -> None:
    """The same in the results file, with the density of the energy and the directivities."""
    write_described(target, radiated.energy)
    write_described(target, radiated)
    write_pattern(group(target, "directivity", "Where the sound goes"), radiated.pattern, "Pa m/Hz")


def write_power(target: h5py.Group, sound: PowerResponse, frequency: str, unit: str) -> None:
    """What goes with a sound power over frequency: its efficiency, the power put in, directivities."""
    put(target, "efficiency", sound.efficiency, "1", "Radiation efficiency", (frequency,))
    put(target, "put_in", sound.put_in, unit, "Power that the force puts in", (frequency,))
    pattern = group(target, "directivity", "Where the sound goes")
    write_pattern(pattern, sound.pattern, "Pa/N" if unit.endswith("m)^2") else "Pa m/N")


def write_pattern(target: h5py.Group, pattern: Directivity, unit: str) -> None:
    """Far field on two half circles through the surface's normal."""
    frequency = axis(target, "frequency_hz", pattern.frequency_hz, "Hz", "Frequency")
    side = axis(target, "side", list(pattern.sides), "1", "Side of the surface along which the half circle lies")
    angle = axis(target, "angle_deg", pattern.angle_deg, "deg", "From the normal, positive along the side")
    put(target, "pressure", pattern.pressure, unit, "|p| times the distance, far away", (frequency, side, angle))
    mean = "Root of its mean square over the half sphere"
    put(target, "half_sphere", pattern.half_sphere, unit, mean, (frequency,))


def shares_table(shares: SurfaceShares) -> Table:
    """What each surface gives the air of a room: by surface, by third octave; None where nothing is known."""
    bands = [label(band) for band in shares.bands_hz]

    def by_band(values: Floats) -> Table:
        return {band: number(value) for band, value in zip(bands, values, strict=True)}

    each = {
        name: {
            "wall": shares.walls[row],
            "energy_j": by_band(shares.energy_j[row]),
            "share": by_band(shares.share[row]),
            "alone_db": by_band(shares.alone_db[row]),
        }
        for row, name in enumerate(shares.surfaces)
    }
    return {"surfaces": each, "total_j": by_band(shares.total_j), "together_db": by_band(shares.together_db)}


def write_shares(target: h5py.Group, shares: SurfaceShares) -> None:
    """The same in the results file."""
    axis(target, "surface", list(shares.surfaces), "1", "Surface that moves the air")
    put(target, "wall", list(shares.walls), "1", "Wall of the room that it moves", ("surface",))
    write_described(target, shares)


# ----------------------------------------------------------------------------------------------------------------------
# The numbers of a study as plain tables, ready for JSON.
# ----------------------------------------------------------------------------------------------------------------------

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
            "sound_energy_db": radiated_difference(result.cases[name], baseline),
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
    return describe(case) | {
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
        "contacts": {} if response is None else {name: describe(one) for name, one in response.contacts.items()},
        "bodies": {} if response is None else {name: describe(one) for name, one in response.bodies.items()},
        "blows": {} if response is None else _blows(response),
        "arrays": {} if response is None else array_tables(response),
        "energy": None if response is None else _energy(response, case.shares),
        "stresses": {name: describe(one.stressed) for name, one in case.channels.items() if one.stressed is not None},
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
    channels = (f"{room}.{receiver} pressure" for room in case.rooms for receiver in _receivers(case, room))
    return next((modes[name] for name in channels if name in modes), next(iter(modes.values()), {}))


def _receivers(case: CaseResult, room: str) -> tuple[str, ...]:
    return tuple(receiver.name for plan in case.case.study.rooms if plan.name == room for receiver in plan.receivers)


def _by_frequency(values: Mapping[float, float]) -> Table:
    return {label(frequency): number(value) for frequency, value in values.items()}


def _rated(rated: RatedRoom) -> Table:
    """A room as the standards state it: its single numbers by symbol, the first the one to state, and its bands."""
    spreads = {"drops_spread_db": rated.drops_spread_db, "receivers_spread_db": rated.receivers_spread_db}
    numbers = {
        symbol: describe(one)
        | {name: number(spread[symbol]) for name, spread in spreads.items()}
        | _interval(rated.number_intervals.get(symbol))
        for symbol, one in rated.numbers.items()
    }
    levels = None if rated.statistical is None else describe(rated.statistical)
    beside = None if rated.agreement is None else describe(rated.agreement)
    statistical = {"statistical": levels, "statistical_agreement": beside}
    statistical["ensemble"] = None if rated.ensemble is None else describe(rated.ensemble)
    return describe(rated.method) | describe(rated) | statistical | {"numbers": numbers}


def _interval(one: Interval | None) -> Table:
    """Mean and 90 % interval of a number over rooms and places."""
    found = (None, None, None) if one is None else one
    return {name: number(value) for name, value in zip(("mean_db", "low_db", "high_db"), found, strict=True)}


def _rated_beside(
    case: CaseResult, baseline: CaseResult | None, differences: Callable[[RatedRoom, RatedRoom], Mapping[str, float]]
) -> Table:
    """By room and symbol, what is told of its single numbers beside the baseline's [dB]."""
    before = {} if baseline is None else baseline.rated
    return {
        room: {symbol: number(value) for symbol, value in differences(rated, before[room]).items()}
        for room, rated in case.rated.items()
        if room in before
    }


# ----------------------------------------------------------------------------------------------------------------------
# Arrays of bodies (NAME.1, NAME.2, ...) as tables: the energy of each with what joins it, and their sum.
# ----------------------------------------------------------------------------------------------------------------------

TERMS = ("kinetic_j", "stored_j", "dissipated_j")


def arrays_of(response: Response) -> dict[str, list[str]]:
    """The bodies of every array; a name without a dot stands alone."""
    found: dict[str, list[str]] = {}
    for name in response.bodies:
        array = name.rpartition(".")[0]
        if array:
            found.setdefault(array, []).append(name)
    return found


def array_tables(response: Response) -> Table:
    """For every array: peak contact force of each body, and energies at the separation and at the end, with their sum.

    stored_j, dissipated_j : in the contacts and links that join the body to something else than its array; those
    between two of an array count in the sum only.
    """
    ledger = response.ledger
    return {
        array: {
            "peak_force_n": {name: _peak(response, name) for name in names},
            "at_separation": None if ledger.at_separation is None else _energies(response, ledger.at_separation, names),
            "end": _energies(response, ledger.end, names),
        }
        for array, names in arrays_of(response).items()
    }


def _joins(response: Response, name: str) -> tuple[list[str], list[str]]:
    contacts = [c.name for c in response.scene.contacts if name in _ends(c)]
    return contacts, [link.name for link in response.scene.links if name in _ends(link)]


def _ends(join: Contact | Link) -> list[str]:
    return [end for end in (join.upper, join.lower) if isinstance(end, str)]


def _peak(response: Response, name: str) -> float:
    return max((response.contacts[contact].peak_force for contact in _joins(response, name)[0]), default=0.0)


def _energies(response: Response, balance: EnergyBalance, names: list[str]) -> dict[str, dict[str, float]]:
    joins = {name: _joins(response, name) for name in names}
    joining: tuple[Contact | Link, ...] = (*response.scene.contacts, *response.scene.links)
    shared = {join.name for join in joining if len(set(_ends(join)) & set(names)) > 1}
    table = {
        name: {
            "kinetic_j": balance.bodies[name],
            "stored_j": _sum(balance.contacts, contacts, shared) + _sum(balance.links, links, shared),
            "dissipated_j": _sum(balance.lost_contacts, contacts, shared) + _sum(balance.lost_links, links, shared),
        }
        for name, (contacts, links) in joins.items()
    }
    within = ((balance.contacts, balance.links), (balance.lost_contacts, balance.lost_links))
    own = {"kinetic_j": 0.0} | {
        term: sum(energies[join] for energies in both for join in energies if join in shared)
        for term, both in zip(TERMS[1:], within, strict=True)
    }
    return table | {"sum": {term: own[term] + sum(row[term] for row in table.values()) for term in TERMS}}


def _sum(energies: Mapping[str, float], names: list[str], without: set[str]) -> float:
    return sum(energies[name] for name in names if name not in without)
