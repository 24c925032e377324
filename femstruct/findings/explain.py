"""A code explained: as text for a person, as a table for a machine, as a page for the documentation."""

from __future__ import annotations

from textwrap import fill
from typing import Any, Final

from femstruct.findings.catalogue import CATALOGUE, SUBJECTS
from femstruct.findings.entry import MEANING, Entry, Rank, Threshold

WIDTH: Final = 88  # characters of a line


def explanation(entry: Entry) -> str:
    """An entry as lines.

    >>> from femstruct.findings.catalogue import entry_of
    >>> print(explanation(entry_of("sags-far")))
    sags-far (limits trust)
      The structure sags far under its own weight.
    <BLANKLINE>
      raised when    a part sags by more than the threshold share of the size of the
                     structure; in studies without gravity, too
      threshold      10 % of the size: springs are not built so soft (source: engineering
                     judgement)
      what to do     Check the units of springs, layers and moduli, unless they are soft on
                     purpose.
    """
    lines = [
        f"{entry.code} ({_ranks(entry)})",
        fill(entry.sentence, WIDTH, initial_indent="  ", subsequent_indent="  "),
        "",
    ]
    rows = [("raised when", entry.when)]
    rows += [("threshold", _limit(limit)) for limit in entry.limits if not limit.forbids]
    rows += [("no trust if", entry.forbids)] if entry.forbids else []
    rows += [("no trust from", _limit(limit)) for limit in entry.limits if limit.forbids]
    rows.append(("what to do", entry.do))
    return "\n".join([*lines, *(_row(name, text) for name, text in rows)])


def listing() -> str:
    """All codes with their sentences, by rank."""
    parts = []
    for rank in Rank:
        parts.append(f"{rank.value}: {MEANING[rank]}")
        parts += [
            f"  {entry.code}\n{fill(entry.sentence, WIDTH, initial_indent='    ', subsequent_indent='    ')}"
            for entry in CATALOGUE.values()
            if entry.rank is rank
        ]
        parts.append("")
    raised = ", ".join(entry.code for entry in CATALOGUE.values() if entry.forbids)
    parts.append(fill(f"Depending on their numbers, these forbid trust too: {raised}", WIDTH, break_on_hyphens=False))
    return "\n".join(parts)


def entry_table(entry: Entry) -> dict[str, Any]:
    """An entry for JSON."""
    return {
        "code": entry.code,
        "sentence": entry.sentence,
        "rank": entry.rank.value,
        "forbids_trust_if": entry.forbids or None,
        "when": entry.when,
        "thresholds": [
            {
                "value": one.value,
                "of": one.of.removeprefix("% "),
                "forbids_trust": one.forbids,
                "reason": one.reason,
                "source": one.source,
            }
            for one in entry.limits
        ],
        "do": entry.do,
    }


def page() -> str:
    """The catalogue as Markdown, by subject."""
    parts = [
        "# Findings",
        "",
        "A finding is a reason to trust a result less, with its numbers. Every command reports what forbids trust",
        "first, then what limits it; `-v` adds remarks. `femstruct explain CODE` prints one entry of this page, which",
        "`scripts/findings_page.py` writes from the catalogue in `femstruct/findings`.",
        "",
        "| rank | meaning | codes |",
        "|---|---|---|",
        *(
            f"| {rank.value} | {MEANING[rank]} | {sum(entry.rank is rank for entry in CATALOGUE.values())} |"
            for rank in Rank
        ),
    ]
    for subject, entries in SUBJECTS.items():
        parts += ["", f"## {subject.capitalize()}"]
        for entry in entries:
            parts += ["", f"### {entry.code}", "", f"{entry.sentence} *{_ranks(entry).capitalize()}.*", ""]
            parts.append(f"- Raised when {entry.when}.")
            if entry.forbids:
                parts.append(f"- Forbids trust if {entry.forbids}.")
            for limit in entry.limits:
                parts.append(f"- {'Forbids trust from' if limit.forbids else 'Threshold:'} {_limit(limit)}.")
            parts.append(f"- What to do: {entry.do}")
    return "\n".join(parts) + "\n"


def _ranks(entry: Entry) -> str:
    return f"{entry.rank.value}, or {Rank.FORBIDS.value}" if entry.forbids else entry.rank.value


def _limit(limit: Threshold) -> str:
    return f"{limit.shown}: {limit.reason} (source: {limit.source})"


def _row(name: str, text: str) -> str:
    kept = text.replace(" %", "\N{NO-BREAK SPACE}%")  # a number and its unit stay on one line
    whole = fill(kept, WIDTH, initial_indent=f"  {name:<15}", subsequent_indent=" " * 17, break_on_hyphens=False)
    return whole.replace("\N{NO-BREAK SPACE}", " ")
