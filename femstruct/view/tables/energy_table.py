"""Where the energy of every case is and went."""

from __future__ import annotations

from functools import partial

from femstruct.impact.result.response import EnergyLedger
from femstruct.impact.result.shares import energy_shares
from femstruct.study.result import StudyResult
from femstruct.view.tables.grid import Grid
from femstruct.view.tables.scales import scaled

SMALLEST = 1e-6  # share of the energy that is told in percent
LEAST_SHARE_NAMED = 0.01  # share of the energy from which on a terminal names what has it
SEEN = 5e-4  # share of the energy that the sum of a column misses visibly
OTHERS = f"others, below {100 * LEAST_SHARE_NAMED:g} % each"
LEDGER_NOISE = 1e-9  # share of the energy put in, below which a ledger holds the tail of a decay and rounding


def energies(result: StudyResult) -> Grid:
    """The ledger at the start, the separation and the end: what was put in until then, by work and later blows too, and
    what has it, bodies and what holds the modes' energy by name."""
    ledgers = [case.response.ledger for case in result.cases.values() if case.response is not None]
    factor, unit = scaled("J", max(map(_put_in, ledgers), default=0.0))
    grid = Grid(
        f"energy [{unit}]",
        ("case", "when", "t [ms]", "put in", "bodies", "structure", "contacts, links", "dissipated", "ledger residual"),
        keys=3,
    )
    for name, case in result.cases.items():
        if case.response is None:
            continue
        ledger, shares = case.response.ledger, case.shares
        then, last = ({}, {}) if shares is None else (shares.held_at_separation, shares.held_at_end)
        instants = (("start", ledger.start), ("separation", ledger.at_separation), ("end", ledger.end))
        for (label, balance), parts in zip(instants, ({}, then, last), strict=True):
            if balance is None and not case.response.contacts:
                continue  # nothing meets, so nothing parts
            if balance is None:
                grid.add(name, label, "never", "", "", "", "", "", "")
                continue
            kinetic: dict[str, float] = {}
            for body, energy in balance.bodies.items():  # an array of bodies is told as one
                array = body.rpartition(".")[0] or body
                kinetic[array] = kinetic.get(array, 0.0) + energy
            tell = partial(_amount, factor=factor, nothing=LEDGER_NOISE * _put_in(ledger))
            bodies = ", ".join(f"{body} {tell(energy)}" for body, energy in kinetic.items())
            stored = sum(balance.contacts.values()) + sum(balance.links.values())
            grid.add(
                name,
                label,
                f"{1e3 * balance.t:.3f}",
                tell(ledger.start.total + balance.work + balance.blows),
                bodies,
                ", ".join(_part(name, tell(energy)) for name, energy in parts.items()) or tell(balance.structure),
                tell(stored),
                tell(balance.dissipated),
                f"{ledger.residual:.1e}" if label == "end" else "",
            )
    return grid


def _part(name: str, energy: str) -> str:
    """What of the column "structure" something holds.

    >>> _part("structure", "12.3"), _part("air of box", "4.5")
    ('12.3', 'air of box 4.5')
    """
    return energy if name == "structure" else f"{name} {energy}"


def _put_in(ledger: EnergyLedger) -> float:
    """Energy at the start and what work and blows brought until the end [J]."""
    return ledger.start.total + ledger.end.work + ledger.end.blows


def _amount(energy: float, factor: float, nothing: float) -> str:
    """An energy [J] in the unit of the table, 0 for what is none.

    >>> _amount(0.1218, 1e3, 1e-10), _amount(2e-17, 1e3, 1e-10)
    ('121.8', '0')
    """
    return f"{factor * energy:.4g}" if abs(energy) >= nothing else "0"


def energy_destinations(result: StudyResult) -> Grid:
    """What holds the energy of a case and what took it: bodies, modes, contacts and links, losses."""
    moments: dict[str, list[dict[str, float]]] = {}
    for name, case in result.cases.items():
        if case.response is not None and case.shares is not None:
            ledger, shares = case.response.ledger, case.shares
            triples = (
                (ledger.at_separation, shares.at_separation, shares.dashpots_at_separation),
                (ledger.end, shares.end, shares.dashpots_at_end),
            )
            moments[name] = [
                {} if balance is None or groups is None or taken is None else energy_shares(balance, groups, taken)
                for balance, groups, taken in triples
            ]
    parted = any(first for first, _ in moments.values())  # nowhere: nothing meets, or what met stays together
    grid = Grid(f"where the energy went [% {'at the separation / ' if parted else ''}at the end]", ("", *moments))
    told = [share for both in moments.values() for shares_then in both for share in shares_then.items()]
    named = dict.fromkeys(what for what, share in told if share >= LEAST_SHARE_NAMED)
    rest = {
        name: [{OTHERS: 1.0 - sum(abs(then.get(what, 0.0)) for what in named)} if then else {} for then in both]
        for name, both in moments.items()
    }
    left = any(share >= SEEN for both in rest.values() for then in both for share in then.values())
    for holder, of_cases in (*((one, moments) for one in named), *([(OTHERS, rest)] if left else [])):
        texts = [[_share(then.get(holder)) for then in (both if parted else both[1:])] for both in of_cases.values()]
        grid.add(holder, *(" / ".join(both) for both in texts))
    return grid


def _share(share: float | None) -> str:
    """Percent of what was put in, 0 for what is none.

    >>> _share(0.0333), _share(2.8e-31), _share(None)
    ('3.33', '0', '-')
    """
    return "-" if share is None else f"{100 * share:.3g}" if abs(share) >= SMALLEST else "0"
