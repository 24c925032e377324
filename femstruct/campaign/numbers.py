"""The numbers of a case by name: those that are asked for first, in the words of `limits:`, then all others."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches
from math import isfinite, nan, pi
from typing import Any, Final, NamedTuple

from femstruct.errors import InputError
from femstruct.files.tables.study_tables import case_table
from femstruct.study.asked import SETTLED
from femstruct.study.campaign.swept import EXCEEDED, MET, UNKNOWN, UNROUNDED, limit_name, value_name, verdict_name
from femstruct.study.result import CaseResult
from femstruct.workflow.compare.verdicts import verdicts

MODES: Final = 10  # natural frequencies among the numbers
APART: Final = " / "  # between the steps of a name
_LEFT_OUT: Final = ("basis", "outcome", "findings", "error_estimate", "accuracy")
_UNITS: Final = {
    "hz": "Hz", "db": "dB", "n": "N", "s": "s", "m": "m", "j": "J", "pa": "Pa", "w": "W", "kg": "kg", "rad": "rad",
    "percent": "%",
}  # fmt: skip


class Number(NamedTuple):
    """A number and its unit; nan where it cannot be had, for a reason that the findings give."""

    value: float
    unit: str


def numbers_of(case: CaseResult) -> dict[str, Number]:
    """All numbers of a case by name.

    The first are the main ones (`main_numbers`); the names of the others are their paths in summary.json, as in
    "levels / living.middle / bands_db / 63". Between them are limits, `numbers_of_limit`.
    """
    own = dict(main_numbers(case))
    own |= _of_limits(case)
    for name, number in _flat({key: one for key, one in case_table(case).items() if key not in _LEFT_OUT}):
        own.setdefault(name, number)
    return own


def only_numbers(cases: Mapping[str, Mapping[str, Number]], only: Sequence[str]) -> dict[str, dict[str, Number]]:
    """The numbers of these names, by case. A case may be without some, such as one without the body that they are of;
    all may be without one of a table where there is none, such as a time of separation.

    Raises InputError for a name of no number of any case.

    >>> cases = {"bare": {"total mass": Number(2.0, "kg")}, "damped": {"total mass": Number(2.0, "kg")}}
    >>> only_numbers(cases, ["total mass"])["bare"]
    {'total mass': Number(value=2.0, unit='kg')}
    """
    known = {name for numbers in cases.values() for name in numbers}
    tables = {name.partition(APART)[0] for name in known if APART in name}
    for name in only:
        table, apart, _ = name.partition(APART)
        if name not in known and not (apart and table in tables):
            near = get_close_matches(name, known, n=1, cutoff=0.5)
            do = f"did you mean '{near[0]}'?" if near else "femstruct sweep STUDY --plan lists the main ones"
            raise InputError("samples.only", got=f"'{name}'", expected="a number of the study", do=do)
    return {case: chosen(own, only) for case, own in cases.items()}


def chosen(numbers: Mapping[str, Number], only: Sequence[str]) -> dict[str, Number]:
    """The numbers of these names that there are, each with its limit, what is compared with it, and the verdict."""
    of_limit = (limit_name, value_name, verdict_name)
    with_limits = (each for name in only for each in (name, *(one(name) for one in of_limit)))
    return {name: numbers[name] for name in with_limits if name in numbers}


def numbers_of_limit(name: str, limit: float, unit: str, value: float | None, met: bool | None) -> dict[str, Number]:
    """A limit, what is compared with it and the verdict as numbers of a row; met : None where the run cannot tell.

    >>> [one.value for one in numbers_of_limit("settled", 0.7, "s", None, False).values()]
    [0.7, nan, 0.0]
    """
    verdict = UNKNOWN if met is None else MET if met else EXCEEDED
    return {
        limit_name(name): Number(limit, unit),
        value_name(name): _number(None if met is None else value, unit),
        verdict_name(name): Number(verdict, "1"),
    }


def _of_limits(case: CaseResult) -> dict[str, Number]:
    found: dict[str, Number] = {}
    for limit, one in zip(case.case.study.limits, verdicts(case), strict=False):  # no impact has no verdicts
        found |= numbers_of_limit(limit.name, limit.value, one.unit, one.value, one.met)
    return found


def main_numbers(case: CaseResult) -> Iterator[tuple[str, Number]]:
    """What a limit can be set to, and what else is asked of a case first: the time to rest where it is limited, ratings
    and levels of rooms, the peaks of recorded channels in the whole window, the energy in the structure when the
    contacts have opened (at the end where they do not), peak forces of contacts, peaks of frequency responses, natural
    frequencies, the mass. There is no rating where bands are blank that it needs."""
    for verdict in verdicts(case):
        if verdict.name == SETTLED:
            yield SETTLED, _number(verdict.value, "s")
    for name, room in case.rated.items():
        known = None if room.rating is None or room.rating.blank_hz else room.rating
        yield f"{name} rating", _number(None if known is None else known.value_db, "dB")
        yield f"{name} rating{UNROUNDED}", _number(None if known is None else known.unrounded_db, "dB")
    of_drop = f" of {next(iter(case.drops))}" if len(case.drops) > 1 else ""
    for name, one in (case.heard.total_levels or case.levels).items():
        yield f"{name} L_AFmax{of_drop}", _number(one.l_afmax_db, "dB")
    for name, channel in case.channels.items():
        yield name, _number(channel.whole, channel.unit)
    if case.response is not None:
        ledger = case.response.ledger
        yield "structure energy", _number((ledger.at_separation or ledger.end).structure, "J")
        for name, contact in case.response.contacts.items():
            if f"{name} force" in case.channels:
                continue  # the same number
            yield f"{name} peak force", _number(contact.peak_force, "N")
    for name, response in case.frf.items():
        yield f"{name} peak", _number(response.peak, response.unit)
    basis = case.basis
    for number, omega in enumerate(basis.omega[basis.modes][:MODES], 1):
        yield f"mode {number} frequency", _number(float(omega) / (2.0 * pi), "Hz")
    yield "total mass", _number(basis.total_mass, "kg")


def _number(value: float | None, unit: str) -> Number:
    return Number(nan if value is None or not isfinite(value) else float(value), unit)


def _flat(table: Mapping[str, Any], before: tuple[str, ...] = ()) -> Iterator[tuple[str, Number]]:
    """Numbers of nested mappings, named by their path. A mapping's "unit" is that of the numbers beside it."""
    told = table.get("unit")
    for key, one in table.items():
        steps = (*before, str(key))
        if isinstance(one, Mapping):
            yield from _flat(one, steps)
        elif isinstance(one, int | float):
            yield APART.join(steps), _number(float(one), told if isinstance(told, str) else _unit(steps))


def _unit(steps: tuple[str, ...]) -> str:
    """The unit that the last word of a key states, else that of a mapping around it.

    >>> _unit(("levels", "a.b", "bands_db", "63")), _unit(("contacts", "a", "closings"))
    ('dB', '')
    """
    for step in reversed(steps):
        _, joined, last = step.rpartition("_")
        if joined and last in _UNITS:
            return _UNITS[last]
    return "J" if steps[0] == "energy" and steps[-1] != "ledger_residual" else ""
