"""The JSON schema of summary.json: of declared numbers from what they declare, of the tables around them by hand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from functools import cached_property
from types import NoneType, UnionType
from typing import Any, Final, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np

from acoustics.levels.rated import RatedRoom
from acoustics.levels.sound_energy import SoundEnergy
from acoustics.levels.sound_levels import Levels
from acoustics.levels.standards import SingleNumber
from femstruct.evaluations.known_evaluations import EVALUATIONS
from femstruct.files.study_tables import KINDS, TERMS
from femstruct.findings.entry import Rank
from femstruct.impact.numerical_error import ErrorEstimate, Resolved
from femstruct.impact.response import Blow, BodyHistory, ContactHistory, Outcome
from femstruct.reported import OWN_UNIT, Reported, held, reported
from femstruct.sound.radiated_power import Radiated
from femstruct.study.asked import EnergyShare, Verdict
from femstruct.study.recorded import LargestStress
from femstruct.study.results import CaseResult

Schema = dict[str, Any]
DRAFT: Final = "https://json-schema.org/draft/2020-12/schema"
NUMBER: Final[Schema] = {"type": ["number", "null"]}
TEXT: Final[Schema] = {"type": "string"}
YES: Final[Schema] = {"type": "boolean"}
WHOLE: Final[Schema] = {"type": "integer"}


def summary_schema() -> Schema:
    """The schema of what `summary` gives, draft 2020-12.

    Numbers that do not exist are null; units stand in the names of keys or in descriptions. A later version may have
    more keys.

    >>> sorted(summary_schema()["properties"])
    ['cases', 'comparison', 'findings']
    """
    known: dict[str, Schema] = {}
    case = _case(known)
    whole = _table(
        {
            "cases": _by(case, "Cases by name"),
            "comparison": _by(_comparison(), "Cases beside the baseline, by name"),
            "findings": _list(_finding({"cases": _list(TEXT, "Cases it holds for; none for one of the run")})),
        }
    )
    return {"$schema": DRAFT, "title": "Summary of a study", **whole, "$defs": dict(sorted(known.items()))}


def _case(known: dict[str, Schema]) -> Schema:
    def noun(kind: Any, more: Mapping[str, Schema] | None = None) -> Schema:
        return _noun(kind, known, more)

    balance = _balance()
    rated = _merged(
        noun(RatedRoom),
        noun(get_type_hints(RatedRoom)["method"]),
        {
            "numbers": _by(noun(SingleNumber, _spreads()), "Single numbers by symbol, the first the one to state"),
            "statistical": _maybe(_part(RatedRoom, "statistical", known)),
            "statistical_agreement": _maybe(_part(RatedRoom, "agreement", known)),
            "ensemble": _maybe(_part(RatedRoom, "ensemble", known)),
        },
    )
    unit = {"unit": TEXT}
    errors = {name: _by(noun(Resolved, unit), about) for name, _, _, _, about in KINDS}
    errors["from"] = {"enum": ["rounding", "a stricter run"]}
    peak = {"first_impact": NUMBER, "whole": NUMBER, "unit": TEXT, "converged": YES}
    blows = noun(Blow)["properties"]
    energy = {"input_j": NUMBER, "at_separation": _maybe(balance), "end": balance, "ledger_residual": NUMBER}
    rows = {name: _list(one) for name, one in blows.items()} | {"energy_growth": NUMBER}
    tables = {
        "outcome": {"enum": [None, *(one.value for one in Outcome)]},
        "basis": _with_description(TEXT, "Key of its modal basis"),
        "peaks": _by(_table(peak), "Largest magnitudes of recorded channels"),
        "contacts": _by(noun(ContactHistory), "Contacts by name"),
        "bodies": _by(noun(BodyHistory), "Bodies by name"),
        "blows": _by(_table(rows), "Blow by blow, by body"),
        "arrays": _by(_array(), "Arrays of bodies"),
        "energy": _maybe(_table(energy)),
        "stresses": _by(noun(LargestStress), "Largest stresses of parts, by channel"),
        "sound_energy": _by(
            _merged(noun(SoundEnergy), noun(Radiated), {"directivity": _by(_pattern(), "By frequency [Hz]")}),
            "Sound energy into the open, by half space",
        ),
        "by_surface": _by(_shares(), "What each surface gives the air, by room"),
        "rated": _by(rated, "Rooms as the standards state them"),
        "error_estimate": _maybe(noun(ErrorEstimate, errors)),
        "findings": _list(_finding()),
        "limits": _by(noun(Verdict, {"at": {"type": ["string", "null"]}}), "Verdicts by name of the limit"),
        "machine": _maybe(_machine()),
    }
    made = noun(CaseResult, tables)
    for word, kind in EVALUATIONS.items():
        made["properties"][word] = _by(noun(kind.gives), kind.gives.table.long_name)
    made["properties"] |= {"levels": _by(noun(Levels), "Levels at the receivers, ROOM.RECEIVER")}
    return made


def _spreads() -> dict[str, Schema]:
    names = ("drops_spread_db", "receivers_spread_db", "mean_db", "low_db", "high_db")
    return dict.fromkeys(names, NUMBER)


def _balance() -> Schema:
    """Terms of an energy balance [J]; those of bodies go by their names."""
    lost = {"modes": NUMBER, "dashpots": NUMBER, "contacts": _by(NUMBER), "links": _by(NUMBER)}
    group = {"name": TEXT, "from_hz": NUMBER, "to_hz": NUMBER, "energy_j": NUMBER}
    properties = {
        **dict.fromkeys(("t_s", "structure", "stored", "dissipated", "work", "blows"), NUMBER),
        "modes": _list(_table(group), "Groups of modes that `structure` is the sum of"),
        "held_by": _by(NUMBER, "The same by what holds it"),
        "lost": _table(lost),
    }
    return _table(properties) | {"additionalProperties": NUMBER}


def _comparison() -> Schema:
    by_name = _by(_by(NUMBER))
    percent = {"first_impact_percent": NUMBER, "whole_percent": NUMBER, "converged": YES}
    return _table(
        {
            "peaks": _by(_table(percent), "Changes of largest magnitudes [%]"),
            "bands_db": _by(NUMBER, "Attenuation by band, of the first receiver [dB]"),
            "modes_db": _by(NUMBER, "Attenuation by mode, of the first channel [dB]"),
            "bands_db_by_receiver": by_name,
            "modes_db_by_channel": by_name,
            "notes": _list(TEXT),
            "rated_db": _with_description(by_name, "Single numbers above the baseline's [dB], by room"),
            "rated_spread_db": by_name,
            "sound_energy_db": _by(NUMBER, "Level of the sound energy above the baseline's [dB]"),
        }
    )


def _array() -> Schema:
    energies = _by(_table(dict.fromkeys(TERMS, NUMBER)), "By body, and their `sum`")
    return _table({"peak_force_n": _by(NUMBER), "at_separation": _maybe(energies), "end": energies})


def _pattern() -> Schema:
    return _table({"index_db": NUMBER, "along": TEXT, "angle_deg": NUMBER})


def _shares() -> Schema:
    band = _by(NUMBER, "By third octave [Hz]")
    surface = {"wall": TEXT, "energy_j": band, "share": band, "alone_db": band}
    return _table({"surfaces": _by(_table(surface)), "total_j": band, "together_db": band})


def _machine() -> Schema:
    ground = dict.fromkeys(("dynamic_n", "with_weight_n", "percent", "attenuation_db"), NUMBER)
    mode = {"mode": WHOLE, "frequency_hz": NUMBER, "damping_ratio": NUMBER, "shares": _by(NUMBER)}
    companion = {"travel_m": NUMBER, "closings": WHOLE, "seated": {"type": ["boolean", "null"]}}
    energy = _table({"t_s": NUMBER, **{f"{one.name}_j": NUMBER for one in fields(EnergyShare) if one.name != "t"}})
    return _table(
        {
            "ground_force": _maybe(_table(ground)),
            "travel_m": _by(NUMBER),
            "sags": _by(_table({"sag_m": NUMBER, "tilt_rad": NUMBER})),
            "block_modes": _list(_table(mode)),
            "rest": _maybe(_table({"after_s": NUMBER, "interval_s": NUMBER})),
            "companions": _by(_table(companion)),
            "energy": _table({"at_separation": _maybe(energy), "end": energy}),
            "energy_growth": _by(NUMBER),
        }
    )


def _finding(more: Mapping[str, Schema] | None = None) -> Schema:
    properties: dict[str, Schema] = {
        "code": _with_description(TEXT, "`femstruct explain CODE` says more"),
        "message": TEXT,
    }
    properties |= {"values": _by(NUMBER), "severe": YES, "rank": {"enum": [one.value for one in Rank]}}
    return _table({**properties, **(more or {})})


def _table(properties: Mapping[str, Schema]) -> Schema:
    """A table with these keys and no others."""
    return {
        "type": "object",
        "properties": dict(properties),
        "required": list(properties),
        "additionalProperties": False,
    }


def _merged(first: Schema, *others: Mapping[str, Any]) -> Schema:
    """One table with the keys of several; the last may be bare properties."""
    properties = dict(first["properties"])
    free = first["additionalProperties"]
    for one in others:
        properties |= one.get("properties", one)
        free = free or one.get("additionalProperties", False)
    return _table(properties) | {"additionalProperties": free}


def _by(item: Schema, about: str = "") -> Schema:
    return _with_description({"type": "object", "additionalProperties": item}, about)


def _list(item: Schema, about: str = "") -> Schema:
    return _with_description({"type": "array", "items": item}, about)


def _maybe(schema: Schema) -> Schema:
    return {"anyOf": [schema, {"type": "null"}]}


def _with_description(schema: Schema, about: str) -> Schema:
    return {**schema, "description": about} if about else schema


def _part(kind: Any, name: str, known: dict[str, Schema]) -> Schema:
    """Of a noun that a field of another may hold."""
    (one,) = (item for item in get_args(_hint(kind, name)) if item is not NoneType)
    return _noun(one, known)


def _noun(kind: Any, known: dict[str, Schema], more: Mapping[str, Schema] | None = None) -> Schema:
    """The table that `describe` makes of a noun, from what its fields and properties declare; arrays are not in it."""
    properties: dict[str, Schema] = {}
    free: Schema | bool = False
    for name, one in reported(kind).items():
        hint = _hint(kind, name)
        if _is_array(hint):
            continue
        if _is_mapping(hint) and one.axis is None:
            free = _value(get_args(hint)[1])  # what is reported has names of its own
            continue
        properties[one.key or name] = _with_description(_value(hint), _about(one))
    for name, holding in held(kind).items():
        if not holding.kinds:
            properties[holding.key or name] = _with_description(_holding(_hint(kind, name), known), holding.long_name)
    return _table({**properties, **(more or {})}) | {"additionalProperties": free}


def _holding(hint: Any, known: dict[str, Schema]) -> Schema:
    if _is_mapping(hint):
        return _by(_holding(get_args(hint)[1], known))
    options = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
    found = [{"type": "null"} if one is NoneType else _referred(one, known) for one in options]
    return found[0] if len(found) == 1 else {"anyOf": found}


def _referred(kind: Any, known: dict[str, Schema]) -> Schema:
    if kind.__name__ not in known:
        known[kind.__name__] = {}
        known[kind.__name__] = _noun(kind, known)
    return {"$ref": f"#/$defs/{kind.__name__}"}


def _hint(kind: Any, name: str) -> Any:
    hints = get_type_hints(kind)
    if name in hints:
        return hints[name]
    item = vars(kind)[name]
    return get_type_hints(item.func if isinstance(item, cached_property) else item.fget)["return"]


def _about(one: Reported) -> str:
    return one.long_name if one.unit in ("1", OWN_UNIT) else f"{one.long_name} [{one.unit}]"


def _is_mapping(hint: Any) -> bool:
    origin = get_origin(hint)
    return isinstance(origin, type) and issubclass(origin, Mapping)


def _is_array(hint: Any) -> bool:
    return get_origin(hint) is np.ndarray


def _value(hint: Any) -> Schema:
    """The schema of a plain value by its annotation; floats that do not exist are null."""
    origin, inner = get_origin(hint), get_args(hint)
    if origin in (Union, UnionType):
        return {"anyOf": [{"type": "null"} if one is NoneType else _value(one) for one in inner]}
    if origin is Literal:
        return {"enum": list(inner)}
    if _is_mapping(hint):
        return _by(_value(inner[1]))
    if origin in (tuple, list):
        if origin is list or inner[1:] == (Ellipsis,):
            return _list(_value(inner[0]))
        return {"type": "array", "prefixItems": [_value(one) for one in inner], "minItems": len(inner), "items": False}
    return {bool: YES, int: WHOLE, str: TEXT, float: NUMBER}[hint]
