"""Findings for a person: by rank, remarks only where they are asked for."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rich.console import Console

from femstruct.errors import Finding
from femstruct.findings.catalogue import place_of, rank_of
from femstruct.findings.entry import REMARK, Rank

Told = tuple[Finding, str]  # and what is said after it


def finding_lines(found: Sequence[Told], verbose: bool) -> list[tuple[Rank | None, str]]:
    """Lines with their ranks, what forbids trust first; without `verbose` remarks are counted, in a line of no rank.

    >>> found = [(Finding("two-way-coupling", "It has air"), " (case a)"), (Finding("twist-defect", "It twists"), "")]
    >>> [line for _, line in finding_lines(found, verbose=True)]
    ['limits trust, twist-defect: It twists', 'remark, two-way-coupling: It has air (case a)']
    >>> [line for _, line in finding_lines(found, verbose=False)]
    ['limits trust, twist-defect: It twists', '1 remark: -v shows it']
    """
    lines: list[tuple[Rank | None, str]] = []
    hidden = 0
    for finding, after in sorted(found, key=lambda one: place_of(one[0])):
        rank = rank_of(finding.code, finding.severe)
        if rank is REMARK and not verbose:
            hidden += 1
        else:
            lines.append((rank, f"{rank.value}, {finding.code}: {finding.message}{after}"))
    if hidden:
        lines.append((None, "1 remark: -v shows it" if hidden == 1 else f"{hidden} remarks: -v shows them"))
    return lines


def doubted(codes: Iterable[str], before: str = "") -> str:
    """What the mark "?" in a table means, of findings that forbid to quote its numbers; nothing without any.

    >>> doubted(["stress-uneven", "peak-not-converged", "stress-uneven"], "; ")
    '; ? : do not quote, see stress-uneven and peak-not-converged'
    >>> doubted([])
    ''
    """
    named = " and ".join(dict.fromkeys(codes))
    return f"{before}? : do not quote, see {named}" if named else ""


def show_findings(screen: Console, found: Sequence[Told], verbose: bool) -> None:
    """Findings on a terminal, and how to learn more of them."""
    lines = finding_lines(found, verbose)
    if not lines:
        return
    hint = " (`femstruct explain CODE` explains one)" if any(rank for rank, _ in lines) else ""
    screen.print(f"findings{hint}", style="bold")
    for rank, line in lines:
        screen.print(f"  {line}", soft_wrap=True, style="bold red" if rank is Rank.FORBIDS else None)
