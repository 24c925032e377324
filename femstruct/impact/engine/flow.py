"""The exact motion of the modes under forces that are polynomials over a step, given at its Gauss points."""

from __future__ import annotations

from femstruct.arrays import Floats
from femstruct.impact.compiled.kernels import kernel
from femstruct.impact.engine.gauss_points import STAGES
from femstruct.impact.engine.instant_forces import move_to
from femstruct.impact.engine.modal_tables import Tables
from femstruct.impact.engine.records import System


@kernel
def advance(level: int, system: System, tables: Tables, forces: Floats, z: Floats, v: Floats,
            work: Floats) -> float:  # fmt: skip
    """Move z, v over a step under forces at the nodes; returns the energy the damping took.

    Of oscillators in place of coupled modes it is 0: their losses follow from where they are
    (`femstruct.impact.engine.energy.modal_energies`).

    work [STAGES + 4, n] : room; the modal forces at the nodes are left in its first STAGES rows.
    """
    n = len(z)
    if len(system.turn):
        _advance_oscillators(level, system, tables, forces, z, v, work)
        return 0.0
    for j in range(STAGES):
        work[j] = 0.0
        for a in range(len(system.rows)):
            force = system.sign[a] * forces[a, j]
            if force != 0.0:
                for i in range(n):
                    work[j, i] += system.rows[a, i] * force
    flow, push, loss = tables.flow[level], tables.push[level], tables.loss[level]
    basis = STAGES + 2
    for i in range(n):
        work[basis, i] = flow[0, i] * z[i] + flow[1, i] * v[i]
        work[basis + 1, i] = flow[2, i] * z[i] + flow[3, i] * v[i]
    for j in range(STAGES):
        for i in range(n):
            work[basis, i] += push[0, j, i] * work[j, i]
            work[basis + 1, i] += push[1, j, i] * work[j, i]
    work[STAGES] = 0.0
    q = 0
    for a in range(basis):
        left = z if a == 0 else (v if a == 1 else work[a - 2])
        for b in range(a, basis):
            right = z if b == 0 else (v if b == 1 else work[b - 2])
            for i in range(n):
                work[STAGES, i] += loss[q, i] * left[i] * right[i]
            q += 1
    taken = 0.0
    for i in range(n):
        taken += work[STAGES, i]
    move_to(z, v, work[basis], work[basis + 1])
    return taken


@kernel
def _advance_oscillators(level: int, system: System, tables: Tables, forces: Floats, z: Floats, v: Floats,
                         work: Floats) -> None:  # fmt: skip
    """The same where a force also acts on z': it gives v + c x in place of x, and -w^2 x in place of v."""
    n, flow, push = len(z), tables.flow[level], tables.push[level]
    place, rate, kick, drive = work[STAGES], work[STAGES + 1], work[STAGES + 2], work[STAGES + 3]
    for i in range(n):
        place[i] = flow[0, i] * z[i] + flow[1, i] * v[i]
        rate[i] = flow[2, i] * z[i] + flow[3, i] * v[i]
    for j in range(STAGES):
        for i in range(n):
            kick[i], drive[i] = 0.0, 0.0
        acting = 0
        for a in range(len(system.rows)):
            force = system.sign[a] * forces[a, j]
            if force != 0.0:
                acting += 1
                for i in range(n):
                    kick[i] += system.kicks[a, i] * force
                    drive[i] += system.drives[a, i] * force
        if acting:
            for i in range(n):
                x, y = push[0, j, i], push[1, j, i]
                place[i] += x * drive[i] + (y + system.damping[i] * x) * kick[i]
                rate[i] += y * drive[i] - system.omega[i] * system.omega[i] * x * kick[i]
    move_to(z, v, place, rate)
