"""A campaign as a plain table, ready for JSON."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from femstruct.files.tables.json_numbers import number
from femstruct.findings.catalogue import rank_of
from femstruct.findings.entry import LIMITS
from femstruct.study.campaign.held_limits import HeldLimit, held_limits
from femstruct.study.campaign.influence import influences
from femstruct.study.campaign.spread import ROUNDING, Spread, spread
from femstruct.study.campaign.swept import Swept

Table = dict[str, Any]


def sweep_table(rows: Swept, names: Sequence[str] = ()) -> Table:
    """All rows with some of their numbers, and what they tell together. names : the main numbers if none; the others
    are in the file."""
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
    asked = [(name, case, "") for name in changed for case in rows.cases]
    asked += [(name, case, rows.baseline) for name in changed for case in others]
    return [one for one in (spread(rows, *each) for each in asked) if one is not None]


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
