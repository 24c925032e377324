"""A campaign as a plain table, ready for JSON."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from math import isnan
from typing import Any

import numpy as np

from femstruct.files.tables import number
from femstruct.findings.catalogue import rank_of
from femstruct.findings.entry import LIMITS
from femstruct.study.campaigns import ROUNDING, HeldLimit, Spread, Swept, held_limits, influences, spread
from femstruct.study.optima import SAME, Chosen, Found, Front, Reference, Search

Table = dict[str, Any]


def sweep_table(rows: Swept, names: Sequence[str] = ()) -> Table:
    """All rows with some of their numbers, and what they tell together.

    Parameters
    ----------
    names : Sequence[str]
        The main numbers if none; the others are in the file.
    """
    names = names or rows.main
    return {
        "title": rows.title,
        "varied": [{"path": path, "unit": unit} for path, unit in zip(rows.paths, rows.units, strict=True)],
        "cases": list(rows.cases),
        "baseline": rows.baseline,
        "rows_made": rows.made or None,
        "units": {name: rows.unit_of(name) for name in names},
        "samples": [_sample(rows, i, names) for i in range(len(rows.texts))],
        "influence": [_influence(rows, name, case) for name in names for case in rows.cases],
        "statistics": [statistics_table(one) for one in spreads(rows, names)],
        "limits": [_limit(one) for one in held_limits(rows, names)],
        "not_run": int((~rows.done).sum()),
        "failed": sum(bool(one) for one in rows.trouble),
        "severe": left_out(rows),
        "limit_trust": limited(rows),
    }


def _sample(rows: Swept, i: int, names: Sequence[str]) -> Table:
    cases = {
        case: {
            "numbers": {name: number(float(rows.of(name, case)[i])) for name in names},
            "findings": list(rows.findings[c][i]),
            "severe": list(rows.severe[c][i]),
        }
        for c, case in enumerate(rows.cases)
    }
    varied = dict(zip(rows.paths, rows.texts[i], strict=True))
    return {"sample": i, "varied": varied, "done": bool(rows.done[i]), "trouble": rows.trouble[i], "cases": cases}


def spreads(rows: Swept, names: Sequence[str]) -> list[Spread]:
    """How the numbers of drawn samples scatter: of every case, and of its difference to the baseline. None of samples
    that were chosen, which have no distribution."""
    if not rows.drawn:
        return []
    others = [case for case in rows.cases if case != rows.baseline]
    changed = [name for name in names if name not in unchanged(rows, names)]
    requested = [(name, case, "") for name in changed for case in rows.cases]
    requested += [(name, case, rows.baseline) for name in changed for case in others]
    return [one for one in (spread(rows, *each) for each in requested) if one is not None]


def unchanged(rows: Swept, names: Sequence[str]) -> list[str]:
    """Numbers that are the same in all samples that are to be trusted, in every case."""
    changed = {name for case in rows.cases for name in changing(rows, names, case)}
    return [name for name in names if name not in changed]


def changing(rows: Swept, names: Sequence[str], case: str) -> list[str]:
    """Numbers that differ between samples of a case that are to be trusted."""

    def spans(name: str) -> bool:
        own = rows.of(name, case)[rows.trusted(case)]
        known = own[np.isfinite(own)]
        return bool(known.size and np.ptp(known) > ROUNDING * np.abs(known).max())

    return [name for name in names if spans(name)]


def case_of_pictures(rows: Swept, names: Sequence[str]) -> str:
    """The case that a picture of one shows: the baseline, or that in which more of the numbers change."""
    return max((rows.baseline, *rows.cases), key=lambda case: len(changing(rows, names, case)))


def limited(rows: Swept) -> dict[str, int]:
    """In how many samples a finding limits trust, by its code, in any case."""
    counts = Counter(
        code
        for i in range(len(rows.texts))
        for code in {code for case in rows.findings for code in case[i] if rank_of(code, severe=False) == LIMITS}
    )
    return dict(counts.most_common())


def _influence(rows: Swept, name: str, case: str) -> Table:
    """Shares of all paths in the variance of a number, with their 95 % intervals."""
    words = ("value", "low", "high")
    shares = {
        one.path: {"alone": dict(zip(words, one.alone, strict=True)), "total": dict(zip(words, one.total, strict=True))}
        for one in influences(rows, name, case)
    }
    return {"number": name, "case": case, "shares": shares}


def statistics_table(one: Spread) -> Table:
    """A distribution for JSON."""
    return {
        "number": one.name,
        "unit": one.unit,
        "case": one.case,
        "above": one.above,
        "count": one.count,
        "left_out": one.left_out,
        "not_at_rest": one.longer,
        "mean": number(one.mean),
        "deviation": number(one.deviation),
        "quantiles": dict(zip(("5 %", "50 %", "95 %"), map(number, one.quantiles), strict=True)),
        "follows": [number(share) for share in one.follows],
    }


def _limit(one: HeldLimit) -> Table:
    """What became of a limit, for JSON."""
    return {
        "number": one.name,
        "unit": one.unit,
        "case": one.case,
        "limit": {"low": one.limits[0], "high": one.limits[1]},
        "held": one.held,
        "exceeded": one.exceeded,
        "not_known": one.unknown,
        "share": {"value": number(one.share), "low": one.low, "high": one.high},
    }


def left_out(rows: Swept) -> dict[str, int]:
    """In how many samples a finding forbids trust, by its code, in any case."""
    counts = Counter(
        code for i in range(len(rows.texts)) for code in {code for case in rows.severe for code in case[i]}
    )
    return dict(counts.most_common())


# ----------------------------------------------------------------------------------------------------------------------
# The answer of an optimisation as a plain table, ready for JSON.
# ----------------------------------------------------------------------------------------------------------------------


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
    """Differences of the values, as `_statistic` says, and of the samples; each with the share of its own statistic."""
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


# ----------------------------------------------------------------------------------------------------------------------
# A front of designs as a plain table, ready for JSON.
# ----------------------------------------------------------------------------------------------------------------------


def front_table(found: Front) -> Table:
    """All designs of the front, what stands out among them, and how they were found."""
    search, s = found.search, found.search.samples
    return {
        "title": search.title,
        "case": search.case,
        "goals": [
            {"name": one.name, "sense": one.sense, "unit": unit}
            for one, unit in zip(search.goals, found.units, strict=True)
        ],
        "limits": [
            {"name": name, "limit": number(limit), "of_study": name in search.of_study}
            for name, limit in search.limits.items()
        ],
        "feasible": found.feasible,
        "front": [design_table(found, k) for k in found.members],
        "ends": dict(found.ends),
        "knee": found.knee,
        "nearest": None if found.nearest is None else design_table(found, found.nearest),
        "robust": None if not search.over else {"over": [one.path for one in search.over], "quantile": search.quantile},
        "runs": found.runs,
        "runs_of_a_design": s,
        "designs": found.designs,
        "left_out": found.left_out,
        "flat": list(found.flat),
        "still_improving": found.still_improving,
        "spent": found.spent,
        "interrupted": found.interrupted,
        "hypervolume": [{"designs": count, "share": number(share)} for count, share in found.convergence],
    }


def design_table(found: Front, k: int) -> Table:
    """A design: what was chosen, its goals and limited numbers, and the command that runs it."""
    search, texts = found.search, found.texts(k)
    row = k * search.samples
    return {
        "design": k,
        "sample": row,
        "notes": found.notes(k),
        "chosen": [
            {"path": one.path, "text": texts[one.path], "value": number(float(value)), "unit": one.unit, "at": end}
            for one, value, end in zip(search.designs, found.rows.values[row], found.at[k], strict=False)
        ],
        "goals": {one.name: number(float(value)) for one, value in zip(search.goals, found.goals[k], strict=True)},
        "limited": {name: number(float(value)) for name, value in zip(search.limits, found.limited[k], strict=True)},
        "findings": _codes(found, row),
        "run_it": command_of(search, texts),
    }


def _codes(found: Front, row: int) -> list[str]:
    """Of all runs of a design whose first has this number."""
    own = [codes for case in found.rows.findings for codes in case[row : row + found.search.samples]]
    return sorted({code for codes in own for code in codes})
