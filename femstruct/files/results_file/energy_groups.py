"""Where the energy of an impact is and went, as groups of the results file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from femstruct.files.results_file.datasets import axis, group, put
from femstruct.files.tables.described import write_described
from femstruct.impact.result.response import EnergyBalance, EnergyLedger
from femstruct.impact.result.shares import ModeEnergies

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py


def write_energy(target: h5py.Group, ledger: EnergyLedger, shares: ModeEnergies | None) -> None:
    """The ledger over time, what was lost and to what, and the structure's energy by modes and by what holds it."""
    energy = group(target, "energy", "The energy ledger, every term by itself")
    time = axis(energy, "time", ledger.t, "s", "Time since the start")
    write_described(energy, ledger)
    if ledger.bodies:
        body = axis(energy, "body", list(ledger.bodies), "1", "Name")
        rows = np.array(list(ledger.bodies.values()))
        put(energy, "bodies", rows, "J", "Kinetic and potential energy of the bodies", (body, time))
    _write_lost(group(energy, "lost", "What was dissipated, by what took it"), ledger, shares)
    if shares is not None and shares.end:
        modes = group(energy, "modes", "The structure's energy by modes: groups that add up to it")
        one = axis(modes, "group", [part.name for part in shares.end], "1", "Mode, modes of an octave, or rigid modes")
        put(modes, "from_hz", [part.from_hz for part in shares.end], "Hz", "Lowest natural frequency", (one,))
        put(modes, "to_hz", [part.to_hz for part in shares.end], "Hz", "Highest natural frequency", (one,))
        put(modes, "end", [part.energy for part in shares.end], "J", "At the end of the window", (one,))
        if shares.at_separation is not None:
            parted = [part.energy for part in shares.at_separation]
            put(modes, "at_separation", parted, "J", "When the collision was over", (one,))
    if shares is not None and shares.held_at_end:
        parts = group(energy, "held_by", "The same by what holds it: structure, air of rooms, walls that yield")
        one = axis(parts, "holder", list(shares.held_at_end), "1", "Name")
        put(parts, "end", list(shares.held_at_end.values()), "J", "At the end of the window", (one,))
        if shares.held_at_separation:
            put(parts, "at_separation", list(shares.held_at_separation.values()), "J", "When it was over", (one,))


def _write_lost(target: h5py.Group, ledger: EnergyLedger, shares: ModeEnergies | None) -> None:
    """Losses in the modes, in the structure's own dashpots, and in those of every contact and link, until the
    separation and until the end; and over time, where modes and dashpots of the structure are one."""

    def lost(balance: EnergyBalance | None, dashpots: float) -> list[float]:
        if balance is None:
            return [np.nan] * len(names)
        own = [balance.lost_modes - dashpots, dashpots]
        return [*own, *balance.lost_contacts.values(), *balance.lost_links.values()]

    end = ledger.end
    then, at_end = (0.0, 0.0) if shares is None else (shares.dashpots_at_separation or 0.0, shares.dashpots_at_end)
    kinds = ["structure", "structure", *["contact"] * len(end.lost_contacts), *["link"] * len(end.lost_links)]
    names = ["modes", "dashpots", *end.lost_contacts, *end.lost_links]
    taker = axis(target, "taker", names, "1", "Modes, dashpots of the structure, a contact or a link")
    put(target, "kind", kinds, "1", "structure, contact or link", (taker,))
    parted = lost(ledger.at_separation, then)
    put(target, "at_separation", parted, "J", "When the collision was over; nan if never", (taker,))
    put(target, "end", lost(end, at_end), "J", "At the end of the window", (taker,))
    histories = [ledger.lost_modes, *ledger.lost_contacts.values(), *ledger.lost_links.values()]
    where = ["structure", *ledger.lost_contacts, *ledger.lost_links]
    place = axis(target, "place", where, "1", "The structure with its dashpots, a contact or a link")
    target["time"] = target.parent["time"]
    put(target, "until_now", np.array(histories), "J", "Lost until now", (place, "time"))
