"""The catalogue of all findings by code, and the one order in which findings are reported."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from types import MappingProxyType
from typing import Final, Protocol, TypeVar

from femstruct.errors import InputError
from femstruct.findings.entry import FORBIDS, LIMITS, Entry, Rank
from femstruct.findings.on_impacts import IMPACT, SOURCES, STUDY
from femstruct.findings.on_modes import FITS, MODES
from femstruct.findings.on_sound import LEVELS, OPEN_AIR, ROOMS
from femstruct.findings.on_structures import CAVITIES, MESHES, STRUCTURE

SUBJECTS: Final[Mapping[str, tuple[Entry, ...]]] = MappingProxyType(
    {
        "structure": STRUCTURE,
        "meshes from files": MESHES,
        "modes and mesh": MODES,
        "impact": IMPACT,
        "rooms": ROOMS,
        "cavities": CAVITIES,
        "levels and sources": LEVELS,
        "measured sources": SOURCES,
        "open air": OPEN_AIR,
        "study": STUDY,
        "fits": FITS,
    }
)
CATALOGUE: Final[Mapping[str, Entry]] = MappingProxyType(
    {entry.code: entry for entries in SUBJECTS.values() for entry in entries}
)


class Ranked(Protocol):
    """What is ranked: a finding, with its code, its sentence and whether it forbids trust."""

    @property
    def code(self) -> str: ...
    @property
    def message(self) -> str: ...
    @property
    def severe(self) -> bool: ...


Found = TypeVar("Found", bound=Ranked)


def entry_of(code: str) -> Entry:
    """The entry of a code.

    Raises InputError that names the nearest code.

    >>> entry_of("twist-defect").do
    'Use bfs16.'
    """
    if code in CATALOGUE:
        return CATALOGUE[code]
    near = get_close_matches(code, CATALOGUE, n=1)
    do = f"the nearest is '{near[0]}'" if near else "'femstruct explain' lists all"
    raise InputError("explain", got=f"'{code}'", expected="the code of a finding", do=do)


def rank_of(code: str, severe: bool) -> Rank:
    """How much a finding takes from a result: what it says of itself if that is severe, else what the catalogue says.

    >>> rank_of("two-way-coupling", severe=False).value, rank_of("coarse-mesh", severe=True).value
    ('remark', 'forbids trust')
    """
    if severe:
        return FORBIDS
    return CATALOGUE[code].rank if code in CATALOGUE else LIMITS  # of a finding that another program made


def rank_findings(found: Iterable[Found]) -> tuple[Found, ...]:
    """Findings without repetitions: what forbids trust, then what limits it, then remarks, each in their order.

    >>> from femstruct.errors import Finding
    >>> air, stiff = Finding("two-way-coupling", "Air."), Finding("twist-defect", "Stiff.")
    >>> [finding.code for finding in rank_findings((air, stiff, stiff))]
    ['twist-defect', 'two-way-coupling']
    """
    once = {(one.code, one.message): one for one in found}
    return tuple(sorted(once.values(), key=rank_order))


def rank_order(one: Ranked) -> int:
    """Where a finding comes in a report: 0 for what forbids trust, 1 for what limits it, 2 for remarks."""
    return list(Rank).index(rank_of(one.code, one.severe))
