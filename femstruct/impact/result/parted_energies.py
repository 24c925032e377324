"""Energies of coupled modes at the rows of a ledger: what they have and what they lost, of all rows at once."""

from __future__ import annotations

import numpy as np

from femstruct.impact.engine.energy import BODIES, STRUCTURE
from femstruct.impact.engine.sampling import DRIFT, Record
from femstruct.impact.engine.system import Compiled
from femstruct.modal.coupled_damping.energies_of_states import energies_of_states


def part_history(compiled: Compiled, record: Record, rows: int) -> None:
    """Part what coupled modes were given, in the first rows of a ledger, into what they have and what they lost.

    Notes: what they have is kinetic and elastic energy. What they lost is what they were given less what they would
    still lose if nothing acted on them any more: the integral of their damping over all of that time
    (`femstruct.modal.coupled_damping.loss_form`), in which masses and stiffnesses do not enter. The ledger closes if
    both agree: its drift is raised to what they differ by.
    """
    found, system = compiled.oscillators, compiled.system
    if found is None:
        return
    history = record.history[:rows]
    given = history[:, STRUCTURE]
    held, surplus = energies_of_states(
        found, record.rows_z[:rows], record.rows_v[:rows], float(np.abs(given).max(initial=0.0))
    )
    lost_at = BODIES + len(system.omega) - system.n_modes + len(system.interfaces)
    history[:, lost_at] = given - (held + surplus)
    history[:, STRUCTURE] = held
    record.totals[DRIFT] += np.abs(surplus).max(initial=0.0)
