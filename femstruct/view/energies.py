"""Where the energy of every case is and went."""

from __future__ import annotations

from femstruct.impact.shares import energy_shares
from femstruct.study.result import StudyResult
from femstruct.view.grid import Grid

TOLD = 0.01  # share of the energy from which on a terminal names what has it


def energies(result: StudyResult) -> Grid:
    """The ledger at the start, the separation and the end, bodies by name."""
    grid = Grid(
        "energy [mJ]",
        ("case", "when", "t [ms]", "bodies", "structure", "contacts, links", "dissipated", "ledger residual"),
        keys=3,
    )
    for name, case in result.cases.items():
        if case.response is None:
            continue
        ledger = case.response.ledger
        for label, balance in (("start", ledger.start), ("separation", ledger.at_separation), ("end", ledger.end)):
            if balance is None:
                grid.add(name, label, "never", "", "", "", "", "")
                continue
            kinetic: dict[str, float] = {}
            for body, energy in balance.bodies.items():  # an array of bodies is told as one
                array = body.rpartition(".")[0] or body
                kinetic[array] = kinetic.get(array, 0.0) + energy
            bodies = ", ".join(f"{body} {1e3 * energy:.4g}" for body, energy in kinetic.items())
            stored = sum(balance.contacts.values()) + sum(balance.links.values())
            grid.add(
                name,
                label,
                f"{1e3 * balance.t:.3f}",
                bodies,
                f"{1e3 * balance.structure:.4g}",
                f"{1e3 * stored:.4g}",
                f"{1e3 * balance.dissipated:.4g}",
                f"{ledger.residual:.1e}" if label == "end" else "",
            )
    return grid


def whither(result: StudyResult) -> Grid:
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
    grid = Grid("where the energy went [% at the separation / at the end]", ("", *moments))
    told = [share for both in moments.values() for shares_then in both for share in shares_then.items()]
    for holder in dict.fromkeys(what for what, share in told if share >= TOLD):
        texts = [[f"{100 * then[holder]:.3g}" if holder in then else "-" for then in both] for both in moments.values()]
        grid.add(holder, *(" / ".join(both) for both in texts))
    return grid
