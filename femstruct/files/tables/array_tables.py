"""Arrays of bodies (NAME.1, NAME.2, ...) as tables: the energy of each with what joins it, and their sum."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from femstruct.impact.result.response import EnergyBalance, Response
from femstruct.impact.scene.bodies import Contact, Link

Table = dict[str, Any]
TERMS = ("kinetic_j", "stored_j", "dissipated_j")


def arrays_of(response: Response) -> dict[str, list[str]]:
    """The bodies of every array; a name without a dot stands alone."""
    found: dict[str, list[str]] = {}
    for name in response.bodies:
        array = name.rpartition(".")[0]
        if array:
            found.setdefault(array, []).append(name)
    return found


def array_tables(response: Response) -> Table:
    """For every array: peak contact force of each body, and energies at the separation and at the end, with their sum.

    stored_j, dissipated_j : in the contacts and links that join the body to something else than its array; those
    between two of an array count in the sum only.
    """
    ledger = response.ledger
    return {
        array: {
            "peak_force_n": {name: _peak(response, name) for name in names},
            "at_separation": None if ledger.at_separation is None else _energies(response, ledger.at_separation, names),
            "end": _energies(response, ledger.end, names),
        }
        for array, names in arrays_of(response).items()
    }


def _joins(response: Response, name: str) -> tuple[list[str], list[str]]:
    contacts = [c.name for c in response.scene.contacts if name in _ends(c)]
    return contacts, [link.name for link in response.scene.links if name in _ends(link)]


def _ends(join: Contact | Link) -> list[str]:
    return [end for end in (join.upper, join.lower) if isinstance(end, str)]


def _peak(response: Response, name: str) -> float:
    return max((response.contacts[contact].peak_force for contact in _joins(response, name)[0]), default=0.0)


def _energies(response: Response, balance: EnergyBalance, names: list[str]) -> dict[str, dict[str, float]]:
    joins = {name: _joins(response, name) for name in names}
    joining: tuple[Contact | Link, ...] = (*response.scene.contacts, *response.scene.links)
    shared = {join.name for join in joining if len(set(_ends(join)) & set(names)) > 1}
    table = {
        name: {
            "kinetic_j": balance.bodies[name],
            "stored_j": _sum(balance.contacts, contacts, shared) + _sum(balance.links, links, shared),
            "dissipated_j": _sum(balance.lost_contacts, contacts, shared) + _sum(balance.lost_links, links, shared),
        }
        for name, (contacts, links) in joins.items()
    }
    within = ((balance.contacts, balance.links), (balance.lost_contacts, balance.lost_links))
    own = {"kinetic_j": 0.0} | {
        term: sum(energies[join] for energies in both for join in energies if join in shared)
        for term, both in zip(TERMS[1:], within, strict=True)
    }
    return table | {"sum": {term: own[term] + sum(row[term] for row in table.values()) for term in TERMS}}


def _sum(energies: Mapping[str, float], names: list[str], without: set[str]) -> float:
    return sum(energies[name] for name in names if name not in without)
