"""Where the structure's energy is: by mode, in groups, and by what holds it, at any instant of a run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy

from femstruct.arrays import Floats
from femstruct.compiled.records import LINK, System
from femstruct.impact.motion import DISPLACEMENT, VELOCITY, modal_motion, modes_of, state_at, weighted_motion
from femstruct.impact.propagation import law, load_at
from femstruct.impact.response import EnergyBalance, Response
from femstruct.impact.system import Compiled, compile_scene
from femstruct.modal.basis import ModalBasis
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# What the structure's own dashpots took of the energy that its modes lost.
# ----------------------------------------------------------------------------------------------------------------------

CHUNK = 32  # rows or modes whose samples are in memory at a time
EIGENVALUE_ROUNDING = 1e-14  # of the largest eigenvalue of a damping matrix: rounding


def dashpot_losses(response: Response) -> tuple[float | None, float]:
    """Lost in the dashpots of springs and foundations until the separation (None without one) and until the end [J].

    They are a part of `EnergyBalance.lost_modes`.

    Notes: the integration books all damping of the structure as one term, exactly. The share of the dashpots in it is
    that of their power in the power of all damping, both summed over the samples, which cancels most of what samples
    miss.
    """
    basis, ledger = response.basis, response.ledger
    if not basis.dashpots.any():
        return None if ledger.at_separation is None else 0.0, 0.0
    taken, whole = _energies(response, (basis.dashpots, basis.time_damping))

    def until(balance: EnergyBalance) -> float:
        mine, all_of_it = (float(np.interp(balance.t, response.t, energy)) for energy in (taken, whole))
        return balance.lost_modes * mine / all_of_it if all_of_it > 0.0 else 0.0

    return None if ledger.at_separation is None else until(ledger.at_separation), until(ledger.end)


def _energies(response: Response, dampings: Sequence[Floats]) -> list[Floats]:
    """What damping matrices [k, k] take until every sample [nt] [J], by trapezoids."""
    k = len(response.basis.omega)
    if k <= CHUNK:
        rate = modal_motion(response.motion, VELOCITY, np.arange(k))
        powers = [(rate * (damping @ rate)).sum(axis=0) for damping in dampings]
    else:
        powers = [_power(response, damping) for damping in dampings]
    return [scipy.integrate.cumulative_trapezoid(power, response.t, initial=0) for power in powers]


def _power(response: Response, damping: Floats) -> Floats:
    """What a damping matrix takes at every sample [nt] [W], a few rows at a time."""
    values, vectors = np.linalg.eigh(damping)
    kept = np.abs(values) > EIGENVALUE_ROUNDING * np.abs(values).max()
    values, rows = values[kept], vectors[:, kept].T
    power = np.zeros(len(response.t))
    for first in range(0, len(rows), CHUNK):
        speeds = weighted_motion(response.motion, VELOCITY, rows[first : first + CHUNK])
        power += values[first : first + CHUNK] @ speeds**2
    return power


# ----------------------------------------------------------------------------------------------------------------------
# Where the structure's energy is.
# ----------------------------------------------------------------------------------------------------------------------

ALONE = 10  # elastic modes that are told one by one
EXACT = 3e-14  # relative tolerance from a sample to the instant: the least that the integrator takes
FASTEST = 1e-3  # of the largest speed of the run: what a motion is small against that has come to rest
ROUNDED = 1e-15  # of forces that hold each other: what is left of their sum


@stored_as("energy group/1")
@dataclass(frozen=True)
class EnergyGroup:
    """Energy [J] of some modes of the structure: "rigid", "mode 4" (rigid ones counted), "modes 14 to 29" of an octave,
    "residual vectors"; their natural frequencies reach from from_hz to to_hz."""

    name: str
    from_hz: float
    to_hz: float
    energy: float


@stored_as("mode energies/1")
@dataclass(frozen=True)
class ModeEnergies:
    """The structure's term of the ledger by groups of modes, at the separation (None without one) and at the end; and
    what of the losses in modes its own dashpots took until then [J].

    held_at_separation, held_at_end : the same term by what holds it [J], as structure and air of a room; empty where
    all of it is the structure's.
    """

    at_separation: tuple[EnergyGroup, ...] | None
    end: tuple[EnergyGroup, ...]
    dashpots_at_separation: float | None
    dashpots_at_end: float
    held_at_separation: Mapping[str, float] = field(default_factory=dict)
    held_at_end: Mapping[str, float] = field(default_factory=dict)


def mode_energies(response: Response) -> ModeEnergies:
    """How the structure's energy is shared among rigid modes, the first ten elastic ones and octaves of the others.

    Notes: modes are normalised to the mass and share no energy, however they are damped: the groups add up to
    `EnergyBalance.structure`. From the last sample before the instant the motion is integrated to it, to 3e-14 of it;
    of a motion that has come to rest to 3e-17 of what it was, and to the rounding of the forces that hold it there.
    """
    basis, separation, end = response.basis, response.ledger.at_separation, response.ledger.end
    if not len(basis.omega):
        return ModeEnergies(None if separation is None else (), (), *dashpot_losses(response))
    compiled = compile_scene(basis, response.scene, response.clock)
    then = None if separation is None else modes_at(response, compiled, separation.t)
    last = modes_at(response, compiled, end.t)
    return ModeEnergies(
        None if then is None else grouped(basis, _by_mode(basis, *then)),
        grouped(basis, _by_mode(basis, *last)),
        *dashpot_losses(response),
        {} if then is None else energy_by_holder(basis, *then),
        energy_by_holder(basis, *last),
    )


def energy_by_holder(basis: ModalBasis, q: Floats, qd: Floats) -> dict[str, float]:
    """Energy of the modes by what holds it [J], of modal coordinates and velocities [k]; empty for one holder."""
    return {name: float(holder.energy(q, qd)) for name, holder in basis.holders.items()}


def energy_by_holder_over_time(response: Response, t: Floats) -> dict[str, Floats]:
    """The same at the samples next to times [m] of the run: histories [m] [J], for pictures."""
    if not response.basis.holders:
        return {}
    samples = np.clip(np.round(t * response.clock.sampling).astype(int), 0, len(response.t) - 1)
    k = response.motion.turn.shape[2] or len(response.basis.omega)
    z, v = (
        np.stack([state_at(response.motion, what, int(sample))[:k] for sample in samples], axis=1)
        for what in (DISPLACEMENT, VELOCITY)
    )
    q, qd = modes_of(response.motion, z, v)
    return {name: holder.energy(q, qd) for name, holder in response.basis.holders.items()}


def _by_mode(basis: ModalBasis, q: Floats, qd: Floats) -> Floats:
    """Kinetic and elastic energy of every mode [k] [J]."""
    energy: Floats = 0.5 * (qd**2 + (basis.omega * q) ** 2)
    return energy


def grouped(basis: ModalBasis, energy: Floats) -> tuple[EnergyGroup, ...]:
    """Energies of modes [k] [J] in groups, in the order of their frequencies; none is empty."""
    kinds, hz = np.array(basis.kind, dtype=object), basis.frequency_hz
    elastic = np.flatnonzero(kinds == "elastic")
    groups: dict[str, list[int]] = {"rigid": np.flatnonzero(kinds == "rigid").tolist()}
    groups |= {f"mode {i + 1}": [int(i)] for i in elastic[:ALONE]}
    left = elastic[ALONE:]
    while left.size:
        octave = left[hz[left] <= 2.0 * hz[left[0]]]
        groups[f"modes {octave[0] + 1} to {octave[-1] + 1}" if octave.size > 1 else f"mode {octave[0] + 1}"] = (
            octave.tolist()
        )
        left = left[len(octave) :]
    groups["residual vectors"] = np.flatnonzero(kinds == "residual").tolist()
    return tuple(
        EnergyGroup(name, float(hz[own].min()), float(hz[own].max()), float(energy[own].sum()))
        for name, own in groups.items()
        if own
    )


def modes_at(response: Response, compiled: Compiled, t: float) -> tuple[Floats, Floats]:
    """Modal coordinates and velocities [k] at a time of the run."""
    system, sampling = compiled.system, response.clock.sampling
    sample = min(int(t * sampling), compiled.n_samples - 1)
    if sample / sampling > t:
        sample -= 1
    z, v = (state_at(response.motion, what, sample) for what in (DISPLACEMENT, VELOCITY))
    now = sample / sampling
    unloaded, book = _rests(response, compiled, sample, z, v), response.ledger
    fastest = float(np.sqrt(2.0 * np.max(book.structure + book.stored + sum(book.bodies.values(), 0.0 * book.t))))
    while now < t:
        then = min((when for when in _breaks(system) if now < when < t), default=t)
        z, v = _carry(system, unloaded, now, then, z, v, FASTEST * fastest)
        now = then
        if now < t:
            _renew(system, unloaded, now, z, v)
    return modes_of(response.motion, z[: system.n_modes], v[: system.n_modes])


def _rests(response: Response, compiled: Compiled, sample: int, z: Floats, v: Floats) -> Floats:
    """Elongations of links at their release, from the forces they have at a sample."""
    system, unloaded = compiled.system, np.zeros(len(compiled.system.interfaces))
    released = sample << compiled.halvings
    for name, a in compiled.links.items():
        link = system.interfaces[a]
        if 0 < link["release"] <= released and link["stiffness"] > 0.0:
            place, rate = (float(seen[a]) for seen in _seen(system, z, v))
            damping = link["opening"] if rate < 0.0 else link["closing"]
            force = response.links[name][sample] - damping * rate - link["preload"]
            unloaded[a] = place - force / link["stiffness"]
    return unloaded


def _breaks(system: System) -> list[float]:
    """Times at which a link is released or a body strikes [s]."""
    links = system.interfaces["kind"] == LINK
    ticks = {*system.interfaces["release"][links].tolist(), *system.strikes["tick"].tolist()}
    return [tick * system.tick for tick in sorted(ticks)]


def _renew(system: System, unloaded: Floats, now: float, z: Floats, v: Floats) -> None:
    """Release the links and place the bodies whose time is now."""
    for a in np.flatnonzero((system.interfaces["kind"] == LINK) & (system.interfaces["release"] * system.tick == now)):
        unloaded[a] = _seen(system, z, v)[0][a]
    for blow in system.strikes[system.strikes["tick"] * system.tick == now]:
        below = system.over[blow["over"]] @ z
        z[blow["coordinate"]] = below + (system.over_tilts[blow["over"]] @ v if len(system.over_tilts) else 0.0)
        v[blow["coordinate"]] = blow["velocity"]


def _carry(
    system: System, unloaded: Floats, begin: float, end: float, z: Floats, v: Floats, floor: float
) -> tuple[Floats, Floats]:
    """The state some fraction of a sample later, by scipy's DOP853.

    Parameters
    ----------
    floor : float
        Of the speed of coordinates that errors are measured by; what moves by rounding alone has none of its own.
    """
    n, lasts = len(z), end - begin
    pace = max(float(np.sqrt(np.sum(v**2 + (system.omega * z) ** 2))), floor) or 1.0
    held = np.abs(_forces(begin, system, unloaded, z, v))
    held[: len(system.interfaces)] += system.interfaces["preload"]
    acts = np.abs(system.drives if len(system.turn) else system.rows)
    speeds = EXACT * pace + ROUNDED * lasts * (held @ acts)
    run = scipy.integrate.solve_ivp(
        _rates,
        (begin, end),
        np.concatenate((z, v)),
        "DOP853",
        rtol=EXACT,
        atol=np.concatenate((lasts * speeds, speeds)),
        args=(system, unloaded),
    )
    return run.y[:n, -1], run.y[n:, -1]


def _rates(t: float, y: Floats, system: System, unloaded: Floats) -> Floats:
    """Velocities and accelerations of all coordinates, from their values alone."""
    n = len(system.omega)
    z, v = y[:n], y[n:]
    inner, push = -(system.omega**2) * z - system.damping * v, system.sign * _forces(t, system, unloaded, z, v)
    if len(system.turn):
        return np.concatenate((v + push @ system.kicks, inner + push @ system.drives))
    return np.concatenate((v, inner + push @ system.rows))


def _forces(t: float, system: System, unloaded: Floats, z: Floats, v: Floats) -> Floats:
    """Forces of all interfaces and loads [r]."""
    place, rate = _seen(system, z, v)
    return np.array(
        [_force(t, system, unloaded, a, place[a], rate[a]) for a in range(len(system.interfaces))]
        + [load_at(system, i, t) for i in range(len(system.loads))]
    )


def _seen(system: System, z: Floats, v: Floats) -> tuple[Floats, Floats]:
    """Displacements and velocities of all rows [r]."""
    place, rate = system.rows @ z, system.rows @ v
    if len(system.turn):
        place, rate = place + system.tilts @ v, rate - system.tilts @ (system.omega**2 * z + system.damping * v)
    return place, rate


def _force(t: float, system: System, unloaded: Floats, a: int, place: float, rate: float) -> float:
    """Force of an interface: a contact acts while it is indented, and pulls only if it is tensile."""
    kind, begun = system.interfaces[a]["kind"], t >= system.interfaces[a]["release"] * system.tick
    if kind == LINK:
        return law(system, a, place - unloaded[a], rate)[0] if begun else 0.0
    delta, force = place + system.interfaces[a]["offset"], 0.0
    if begun and delta > 0.0:
        force = law(system, a, delta, rate)[0]
        if system.interfaces[a]["tensile"] == 0:
            force = max(force, 0.0)
    return float(force - system.interfaces[a]["preload"])


def energy_shares(balance: EnergyBalance, groups: Sequence[EnergyGroup], dashpots: float = 0.0) -> dict[str, float]:
    """What holds energy and what took it, by name, as shares of all that is stored and lost at that instant [1].

    An array of bodies, "NAME.1" and on, counts as one.

    Parameters
    ----------
    dashpots : float
        What of `lost_modes` the structure's own took [J].
    """
    held: dict[str, float] = {}
    for body, energy in balance.bodies.items():
        array = body.rpartition(".")[0] or body
        held[array] = held.get(array, 0.0) + energy
    for group in groups:
        hz = f" ({group.from_hz:.4g} Hz)" if group.from_hz == group.to_hz > 0.0 else ""
        held[group.name + hz] = group.energy
    held |= {
        "held by contacts": sum(balance.contacts.values()),
        "held by links": sum(balance.links.values()),
        "lost in modes": balance.lost_modes - dashpots,
        "lost in dashpots of the structure": dashpots,
        "lost in contacts": sum(balance.lost_contacts.values()),
        "lost in links": sum(balance.lost_links.values()),
    }
    whole = sum(abs(energy) for energy in held.values())
    return {name: energy / whole for name, energy in held.items()} if whole else {}
