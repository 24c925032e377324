"""The energy ledger of an impact: every term evaluated or integrated by itself, none a remainder."""

from __future__ import annotations

from femstruct.arrays import Floats
from femstruct.compiled.kernels import kernel, summing
from femstruct.compiled.records import LINK, System
from femstruct.impact.propagation import AWAY, CLAMPED, CLOSED, OPEN, STAGES, Rule, State, StepTrial, law
from femstruct.impact.response import EnergyBalance, EnergyLedger
from femstruct.impact.scene import Scene
from femstruct.impact.system import Compiled
from femstruct.laws.registry import beside, spring

TIME, STRUCTURE, BODIES = 0, 1, 2  # columns of a ledger row; then stored [i], lost in modes, lost [i], work, blows
MODES, WORK, BROUGHT, GIVEN = 0, 1, 2, 3  # of what is integrated, behind the interfaces: by modes; by loads; by blows;
INTEGRATED = 4  # and what coupled modes had at the start and were given since


def ledger_width(system: System) -> int:
    """Columns of a ledger row."""
    return BODIES + len(system.omega) - system.n_modes + 2 * len(system.interfaces) + 3


@kernel
def potential(system: System, a: int, delta: float) -> float:
    """Energy of the spring of a contact at an indentation, none when it is open."""
    return spring(system, a, delta)[2] if delta > 0.0 else 0.0


@kernel
def stored(system: System, state: State, a: int, displacement: float) -> float:
    """Energy interface a holds, from zero at rest; a link's preload counts from the start, released or not."""
    stiffness, preload = system.interfaces[a]["stiffness"], system.interfaces[a]["preload"]
    if system.interfaces[a]["kind"] == LINK:
        held = 0.5 * preload * preload / stiffness if stiffness > 0.0 else 0.0
        if state.status[a] != CLOSED:
            return float(held)
        moved = displacement - state.rest[a]
        return float(held + 0.5 * stiffness * moved * moved + preload * moved)
    static_indentation = system.interfaces[a]["offset"]
    delta = displacement + static_indentation if state.status[a] != OPEN and state.status[a] != AWAY else 0.0
    if preload > 0.0:
        if delta > 0.0:
            return float(beside(system, a, static_indentation, displacement))
        return float(-potential(system, a, static_indentation) - preload * displacement)
    return potential(system, a, delta)


@kernel
def fill_ledger_row(t: float, system: System, state: State, place: Floats, lost: Floats, row: Floats) -> float:
    """Fill a ledger row; lost [m + INTEGRATED] holds what was integrated: by interface, then modes, work, what blows
    brought and what coupled modes were given. Returns the total: stored and dissipated less the work and the blows.

    Of coupled modes the row has what they were given, stored and lost together, until `part_energies` or
    `modal_energies` parts it."""
    k, n, m = system.n_modes, len(system.omega), len(system.interfaces)
    structure = 0.0
    if len(system.turn):
        structure = lost[m + GIVEN]
    else:
        for i in range(k):
            structure += 0.5 * (state.v[i] ** 2 + (system.omega[i] * state.z[i]) ** 2)
    row[TIME], row[STRUCTURE] = t, structure
    total = structure
    for i in range(k, n):
        row[BODIES + i - k] = 0.5 * state.v[i] ** 2
        total += row[BODIES + i - k]
    at = BODIES + n - k
    for a in range(m):
        row[at + a] = stored(system, state, a, place[a])
        row[at + m + 1 + a] = lost[a]
        total += row[at + a] + lost[a]
    row[at + m] = lost[m + MODES]
    row[at + 2 * m + 1], row[at + 2 * m + 2] = lost[m + WORK], lost[m + BROUGHT]
    return float(total + lost[m + MODES] - lost[m + WORK] - lost[m + BROUGHT])


@summing
def modal_energies(system: System, state: State) -> tuple[float, float]:
    """Energy of coupled modes as they are, and what they would lose from now on: the same, told in two ways."""
    k, held, surplus, moving = system.n_modes, 0.0, 0.0, 0
    for j in range(k):
        if state.z[j] != 0.0 or state.v[j] != 0.0:
            moving += 1
    if moving == 0:
        return 0.0, 0.0
    for i in range(len(system.modes)):
        place, speed = 0.0, 0.0
        for j in range(k):
            place += system.turn[0, i, j] * state.z[j] + system.turn[1, i, j] * state.v[j]
            speed += system.turn[2, i, j] * state.z[j] + system.turn[3, i, j] * state.v[j]
        held += 0.5 * ((system.modes[i] * place) ** 2 + speed * speed)
    for i in range(2 * k):
        if len(system.surplus) == 0:
            surplus += 0.5 * (system.misses[i] * (state.z[i] if i < k else state.v[i - k])) ** 2
            continue
        more = 0.0
        for j in range(k):
            more += system.surplus[i, j] * state.z[j] + system.surplus[i, k + j] * state.v[j]
        surplus += 0.5 * more * (state.z[i] if i < k else state.v[i - k])
    return held, held + surplus


@kernel
def part_energies(system: System, state: State, row: Floats) -> float:
    """Part what coupled modes were given, in a ledger row, into what they have and what they lost; returns by how much
    the row's total changes. Without coupled modes it is parted already."""
    if len(system.turn) == 0:
        return 0.0
    held, lasting = modal_energies(system, state)
    lost_at = BODIES + len(system.omega) - system.n_modes + len(system.interfaces)
    row[lost_at] = row[STRUCTURE] - lasting
    row[STRUCTURE] = held
    return float(held - lasting)


@kernel
def integrate_losses(h: float, system: System, state: State, rule: Rule, trial: StepTrial, lost: Floats) -> None:
    """Add what dashpots took and loads gave over a step, by Gauss quadrature at its nodes."""
    m = len(system.interfaces)
    for a in range(m):
        status = state.status[a]
        if status == CLOSED:
            for p in range(STAGES):
                speed = trial.rate[a, p + 1]
                damping = law(system, a, trial.place[a, p + 1] + system.interfaces[a]["offset"], speed)[3]
                lost[a] += h * rule.weights[p] * damping * speed * speed
        elif status == CLAMPED:  # the spring drives its own dashpot, without force to the outside
            for p in range(STAGES):
                delta = max(trial.place[a, p + 1] + system.interfaces[a]["offset"], 0.0)
                lost[a] -= h * rule.weights[p] * spring(system, a, delta)[0] * trial.rate[a, p + 1]
    for a in range(m, len(system.rows)):
        for p in range(STAGES):
            lost[m + WORK] += h * rule.weights[p] * trial.forces[a, p] * trial.rate[a, p + 1]
    if len(system.turn):
        lost[m + GIVEN] += _given(h, system, state, rule, trial)


@kernel
def _given(h: float, system: System, state: State, rule: Rule, trial: StepTrial) -> float:
    """Work of all rows on the structure in a step: their forces times their velocities, less those of the bodies.

    A body moves by itself: its velocity at a node is the integral of the forces until then.
    """
    total, k = 0.0, system.n_modes
    for p in range(STAGES):
        power = 0.0
        for a in range(len(system.rows)):
            power += system.sign[a] * trial.forces[a, p] * trial.rate[a, p + 1]
        for i in range(k, len(system.omega)):
            push, speed = 0.0, state.v[i]
            for a in range(len(system.rows)):
                weight = system.sign[a] * system.rows[a, i]
                if weight != 0.0:
                    push += weight * trial.forces[a, p]
                    for s in range(STAGES):
                        speed += h * rule.moments[0, p, s] * weight * trial.forces[a, s]
            power -= push * speed
        total += h * rule.weights[p] * power
    return total


def balance(row: Floats, scene: Scene, compiled: Compiled) -> EnergyBalance:
    """A ledger row with names."""
    system = compiled.system
    m, at = len(system.interfaces), BODIES + len(scene.bodies)
    held, lost = row[at : at + m], row[at + m + 1 : at + 2 * m + 1]
    return EnergyBalance(
        t=float(row[TIME]),
        bodies={body.name: float(row[BODIES + i]) for i, body in enumerate(scene.bodies)},
        structure=float(row[STRUCTURE]),
        contacts={name: float(sum(held[a] for a in rows)) for name, rows in compiled.contacts.items()},
        links={name: float(held[a]) for name, a in compiled.links.items()},
        lost_modes=float(row[at + m]),
        lost_contacts={name: float(sum(lost[a] for a in rows)) for name, rows in compiled.contacts.items()},
        lost_links={name: float(lost[a]) for name, a in compiled.links.items()},
        work=float(row[at + 2 * m + 1]),
        blows=float(row[at + 2 * m + 2]),
    )


def ledger(
    history: Floats, separation: Floats | None, largest_work: float, residual: float, scene: Scene, compiled: Compiled
) -> EnergyLedger:
    """The ledger of a run from its rows: first and last are its start and end.

    Parameters
    ----------
    largest_work : float [J]
        Largest |work| + |energy brought by blows|.
    residual : float [J]
        Largest change of the total.
    """
    m, at = len(compiled.system.interfaces), BODIES + len(scene.bodies)
    lost = history[:, at + m + 1 : at + 2 * m + 1]
    start, end = balance(history[0], scene, compiled), balance(history[-1], scene, compiled)
    scale = max(abs(start.total), largest_work)
    return EnergyLedger(
        start=start,
        at_separation=None if separation is None else balance(separation, scene, compiled),
        end=end,
        t=history[:, TIME].copy(),
        bodies={body.name: history[:, BODIES + i].copy() for i, body in enumerate(scene.bodies)},
        structure=history[:, STRUCTURE].copy(),
        stored=history[:, at : at + m].sum(axis=1),
        lost_modes=history[:, at + m].copy(),
        lost_contacts={name: lost[:, rows].sum(axis=1) for name, rows in compiled.contacts.items()},
        lost_links={name: lost[:, a].copy() for name, a in compiled.links.items()},
        work=history[:, at + 2 * m + 1].copy(),
        blows=history[:, at + 2 * m + 2].copy(),
        residual=residual / scale if scale > 0.0 else 0.0,
    )
