"""The answer of an optimisation as a plain table, ready for JSON."""

from __future__ import annotations

from collections.abc import Mapping
from math import isnan
from typing import Any

from femstruct.files.tables.json_numbers import number
from femstruct.study.campaign.sought import SAME, Chosen, Found, Reference, Search

Table = dict[str, Any]


def optimum_table(found: Found) -> Table:
    """The best design, what it does, and how it was found."""
    search = found.search
    return {
        "title": search.title,
        "case": search.case,
        search.sense: search.goal,
        "number": found.goal_name,
        "value": number(found.goal),
        "unit": found.unit,
        "over_the_scatter": [number(one) for one in found.ends],
        "feasible": found.feasible,
        "design": [_chosen(one) for one in found.chosen],
        "limits": [
            {
                "name": name,
                "limit": number(limit),
                "value": number(found.limits[name]),
                "of_study": name in search.of_study,
                "met": None if isnan(found.limits[name]) else bool(found.limits[name] - limit <= SAME * abs(limit)),
            }
            for name, limit in search.limits.items()
        ],
        "value_is": _statistic(search),
        "robust": None
        if not search.over
        else {
            "over": [one.path for one in search.over],
            "quantile": search.quantile,
            "samples": search.scatter,
        },
        "references": [_reference(found, one) for one in found.references],
        "runs": found.runs,
        "designs": found.designs,
        "left_out": found.left_out,
        "nearly_as_good": int(found.nearly.sum()),
        "begun_with_designs_of_a_sweep": found.begun,
        "flat": found.flat,
        "still_improving": found.still_improving,
        "interrupted": found.interrupted,
        "history": [{"designs": count, "value": number(value)} for count, value in found.history],
        "run_it": run_command(found),
    }


def run_command(found: Found) -> str:
    """The command that runs the best design as a study of its own."""
    return command_of(found.search, {one.path: one.text for one in found.chosen})


def command_of(search: Search, texts: Mapping[str, str]) -> str:
    """The command that runs a design, texts by path, as a study of its own."""
    words = ["femstruct", "run", search.file, *(("--case", search.case) if search.case else ())]
    changes = (*search.overrides, *(f"{path}={text}" for path, text in texts.items()))
    return " ".join([_quoted(word) for word in words] + [f"--set {_quoted(one)}" for one in changes])


def _quoted(word: str) -> str:
    import shlex

    return shlex.quote(word)


def _statistic(search: Search) -> str:
    """What a value is of its samples."""
    return f"{100.0 * search.quantile:g} % quantile of {search.scatter} samples" if search.over else "of one run"


def _reference(found: Found, one: Reference) -> Table:
    """Differences of the values, as `value_is` says, and of the samples; each with the share of its own statistic."""
    below, mean = found.goal - one.goal, float(one.less.mean())
    return {
        "case": one.name,
        "as_written": one.chosen,
        "value": number(one.goal),
        "over_the_scatter": [number(end) for end in one.ends],
        "value_less_this": number(below),
        "value_less_this_percent": number(_percent(found, below, one.goal)),
        "mean": number(one.mean),
        "mean_less_this": number(mean),
        "mean_less_this_percent": number(_percent(found, mean, one.mean)),
        "design_less_this": [number(value) for value in one.less],
        "why_none": one.why,
    }


def _percent(found: Found, difference: float, of: float) -> float:
    """A share of a level is none."""
    return 100.0 * difference / abs(of) if of and found.unit != "dB" else float("nan")


def _chosen(one: Chosen) -> Table:
    return {
        "path": one.path,
        "text": one.text,
        "value": number(one.number),
        "unit": one.unit,
        "at": one.at,
        "change_per_percent": number(one.change),
    }
