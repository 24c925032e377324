"""A batch made ready for its kernel: shared tables, the tick, and the numbers of some of its runs."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError
from femstruct.impact.batch.batch_march import Columns, Marches, Out, Runs, Shared, columns, run_many
from femstruct.impact.batch.vary import Variation
from femstruct.impact.collocation.attempt import march_room
from femstruct.impact.collocation.collocation_march import ERROR_BUDGET
from femstruct.impact.engine.energy import ledger_width
from femstruct.impact.engine.gauss_points import FINEST_HALVINGS, collocation_rule
from femstruct.impact.engine.instant_forces import State
from femstruct.impact.engine.modal_tables import Tables, tabulated
from femstruct.impact.engine.records import Records, System
from femstruct.impact.engine.sampling import room_for
from femstruct.impact.engine.system import Compiled, compile_scene
from femstruct.impact.exact.choice import takes_exact_march
from femstruct.impact.exact.exact_constants import exact_room, exact_rule
from femstruct.impact.result.outcome import LAST
from femstruct.impact.scene.bodies import Clock, Contact
from femstruct.modal.basis import ModalBasis

MAX_STEPS = 2_000_000  # of a run
STEPS_BETWEEN_CHECKS = 50_000  # steps tried between two looks at its progress: a tenth of a second or more
SURVEYED = 4096  # runs looked at together for the tick
LEAST_HALVINGS = 12


@dataclass(frozen=True, eq=False)
class Fleet:
    """What all runs share, and where their numbers come from.

    compiled : the scene as given; exact : whether all runs take the exact march; top_level : of the steps of the
    other one; late : tick from which on bodies that rest hardly gain speed, -1 where none can rest; columns : of a row
    of metrics.
    """

    varied: Variation
    clock: Clock
    compiled: Compiled
    shared: Shared
    tables: Tables
    exact: bool
    top_level: int
    late: int
    columns: Columns

    @staticmethod
    def of(basis: ModalBasis, varied: Variation, window: Clock, *, heard: bool = False) -> Fleet:
        """A fleet on a basis. window : of one sample, so that its end is a power of two ticks away. heard : whether
        somebody listens, which takes the march that has forces as polynomials."""
        compiled = compile_scene(basis, varied.scene, window)
        exact = not heard and takes_exact_march(_hardest(varied, compiled), window.duration)
        halvings = FINEST_HALVINGS if exact else _halvings(varied, compiled, window)
        compiled = compile_scene(basis, varied.scene, window, halvings)
        system, k = compiled.system, compiled.system.n_modes
        levels = 0 if exact else halvings + 1
        scene, scale = varied.scene, compiled.scale[k:]
        late, end = -1, 1 << compiled.halvings
        if scene.contacts and scene.gravity and any(body.falls for body in scene.bodies):
            late = end - int(LAST * end)
            system = system._replace(kinks=np.union1d(system.kinks, [late]))  # a step ends there
            compiled = replace(compiled, system=system)
        weight = len(system.rows) - (len(system.loads) - len(scene.loads))
        entries = system.rows[:, k:] * scale
        entries[weight:] = system.rows[weight:, k:] / scale
        places = {body.name: i for i, body in enumerate(scene.bodies)}
        struck = np.array([places[blows.body] for blows in scene.blows], dtype=np.int64)
        waiting = {blows.body for blows in scene.blows if round(float(blows.times[0]) / system.tick) > 0}
        of_modes, drives = system.rows.copy(), system.drives.copy()
        of_modes[:, k:] = drives[:, k:] = 0.0
        modes = tabulated(system._replace(rows=of_modes, drives=drives), levels, collocation_rule())
        unit = system._replace(
            omega=np.zeros(1),
            damping=np.zeros(1),
            n_modes=0,
            rows=np.ones((1, 1)),
            sign=np.ones(1),
            mobility=np.ones(1),
            turn=np.zeros((0, 0, 0)),
        )
        shared = Shared(
            start=compiled.start[:, :k].copy(),
            waits=np.array([body.name in waiting for body in scene.bodies], dtype=np.int64),
            entries=entries,
            over=system.over * np.append(np.ones(k), scale) / scale[struck][:, None],
            over_tilts=system.over_tilts / scale[struck][:, None] if system.over_tilts.size else system.over_tilts,
            struck=struck,
            weight=weight,
            gravity=scene.gravity,
            mobility=(compiled.pushed**2).sum(axis=1),
            modes=modes,
            mass=tabulated(unit, levels, collocation_rule()),
        )
        width = ledger_width(system)
        at = columns(len(system.interfaces), len(varied.scene.bodies), width)
        return Fleet(varied, window, compiled, shared, modes, exact, halvings, late, at)


def run_some(fleet: Fleet, first: int, out: Floats, stop: Integers, cells: int = 0, spacing: float = 1.0) -> Floats:
    """Fill the rows of the runs from `first` on; all it changes is its own.

    stop [1] : not zero to end at once. Returns the moments [runs, r, cells + 2] of what pushes in cells of `spacing`
    seconds; of no columns where there are no cells.
    """
    system, tables = fleet.compiled.system, fleet.tables
    r, m, n = len(system.rows), len(system.interfaces), len(system.omega)
    columns = cells + 2 if cells else 0
    moments = np.zeros((len(out), r, columns))
    record = room_for(system, 0)._replace(stop=stop, moments=np.zeros((r, columns)), spacing=np.array([spacing]))
    record.late_at[0] = fleet.late
    run_many(
        system._replace(
            rows=system.rows.copy(),
            mobility=system.mobility.copy(),
            over=system.over.copy(),
            over_tilts=system.over_tilts.copy(),
            drives=system.drives.copy(),
            interfaces=system.interfaces.copy(),
            loads=system.loads.copy(),
            strikes=system.strikes.copy(),
        ),
        fleet.shared,
        tables._replace(
            free=tables.free.copy(),
            forced=tables.forced.copy(),
            stray_push=tables.stray_push.copy(),
        ),
        numbers(fleet.varied, fleet.compiled, first, first + len(out)),
        Marches(
            exact=fleet.exact,
            duration=fleet.clock.duration,
            quiet=fleet.clock.quiet,
            max_steps=MAX_STEPS,
            paced=STEPS_BETWEEN_CHECKS,
            halvings=fleet.compiled.halvings,
            top_level=fleet.top_level,
            tolerance=fleet.clock.tolerance * ERROR_BUDGET,
            rule=collocation_rule(),
            room=march_room(system),
            exact_rule=exact_rule(),
            exact_room=exact_room(system),
        ),
        record,
        State(
            z=np.zeros(n),
            v=np.zeros(n),
            status=np.zeros(m, dtype=np.int64),
            rest=np.zeros(m),
            pace=np.zeros(r),
            force=np.zeros(m),
        ),
        fleet.columns,
        Out(out, moments),
    )
    return moments


def numbers(varied: Variation, compiled: Compiled, first: int, last: int) -> Runs:
    """Masses, speeds, laws, loads and blows of the runs first .. last - 1."""
    scene, system, count = varied.scene, compiled.system, last - first

    def values(name: str, otherwise: float) -> Floats:
        return np.broadcast_to(varied.columns[name][first:last] if name in varied.columns else otherwise, (count,))

    interfaces = np.repeat(system.interfaces[None], count, axis=0)
    contacts = {contact.name: contact for contact in scene.contacts}
    for name, rows in compiled.contacts.items():
        for a in rows:
            for word, field in contacts[name].law.varies.items():
                if f"{name}.{word}" in varied.columns:
                    interfaces[field][:, a] = values(f"{name}.{word}", 0.0)
            interfaces["opening"][:, a] = interfaces["closing"][:, a]
            interfaces["preload"][:, a] = values(f"{name}.preload", float(system.interfaces[a]["preload"]))
            rest = _rest(contacts[name], varied, interfaces[:, a])
            interfaces["offset"][:, a] = rest - values(f"{name}.gap", contacts[name].gap)
    for name, a in compiled.links.items():
        for word in ("stiffness", "closing", "opening", "preload"):
            interfaces[word][:, a] = values(f"{name}.{word}", float(system.interfaces[a][word]))
    loads = np.repeat(system.loads[None], count, axis=0)
    for i, load in enumerate(scene.loads):
        loads["value"][:, i] = values(f"{load.name}.amplitude", float(system.loads[i]["value"]))
    masses = [values(f"{body.name}.mass", body.mass) for body in scene.bodies]
    speeds = [values(f"{body.name}.velocity", body.velocity) for body in scene.bodies]
    shape = (len(scene.bodies), count)
    mass, velocity = (np.array(columns).reshape(shape).T.copy() for columns in (masses, speeds))
    strikes = np.repeat(system.strikes[None], count, axis=0)
    coordinate = system.strikes["coordinate"] - system.n_modes
    strikes["velocity"] = velocity[:, coordinate] * np.sqrt(mass[:, coordinate])
    return Runs(mass, velocity, interfaces, loads, strikes)


def _rest(contact: Contact, varied: Variation, interfaces: Records) -> Floats:
    """Indentation under the preload of one contact in all runs [runs]."""
    preload, law, name = interfaces["preload"], contact.law, contact.name
    if not preload.any():
        return np.zeros(len(preload))
    rests = law.rests(preload, interfaces)
    if rests is not None:
        return rests
    springs = [word for word, field in law.varies.items() if field != "closing"]
    if {f"{name}.{word}" for word in ("preload", *springs)} & varied.columns.keys():
        raise InputError(f"vary.{name}", got="a spring or a preload that varies", expected="those of the scene", do=
                         f"a contact preloaded by {type(law).__name__} has one rest position in a batch")  # fmt: skip
    return np.full(len(preload), law.indentation(contact.preload))


def _hardest(varied: Variation, compiled: Compiled) -> System:
    """The system with the stiffest laws and the lightest bodies of all runs: none is faster."""
    system, k = compiled.system, compiled.system.n_modes
    interfaces, lightest = system.interfaces.copy(), np.full(len(varied.scene.bodies), np.inf)
    words = ("stiffness", "closing", "opening")
    for word in words:
        interfaces[word] = 0.0
    for first in range(0, varied.runs, SURVEYED):
        runs = numbers(varied, compiled, first, min(first + SURVEYED, varied.runs))
        lightest = np.minimum(lightest, runs.mass.min(axis=0))
        for word in words:
            interfaces[word] = np.maximum(interfaces[word], runs.interfaces[word].max(axis=0))
    entries = system.rows[:, k:] * compiled.scale[k:]
    mobility = (compiled.pushed**2).sum(axis=1) + (entries**2 / lightest).sum(axis=1)
    return system._replace(interfaces=interfaces, mobility=mobility)


def _halvings(varied: Variation, compiled: Compiled, window: Clock) -> int:
    """Halvings of the window to a tick in which no contact that closes or opens does anything.

    The step of a change is a tick long, and the force in it may be missed: what counts, as in all steps, is the speed
    it would give the mass behind the contact, against the tolerance. Energy bounds the speeds, where nothing is held
    or pushed at the start; else, and for laws with another spring, the tick is as short as numbers allow.
    """
    scene, system, k = varied.scene, compiled.system, compiled.system.n_modes
    simple = not (scene.loads or scene.gravity or scene.blows or any(link.release_at for link in scene.links))
    start = 0.0 if scene.velocity is None else scene.velocity
    structure = float(np.sum(np.square(start)))
    allowed, shortest = window.tolerance * ERROR_BUDGET, window.duration
    for first in range(0, varied.runs, SURVEYED):
        runs = numbers(varied, compiled, first, min(first + SURVEYED, varied.runs))
        if not simple or runs.interfaces["preload"].any():
            return FINEST_HALVINGS
        energy = 0.5 * ((runs.mass * runs.velocity**2).sum(axis=1) + structure)
        for law, a in ((contact.law, a) for contact in scene.contacts for a in compiled.contacts[contact.name]):
            mine = runs.interfaces[:, a]
            mobility = (compiled.pushed[a] ** 2).sum() + (
                (system.rows[a, k:] * compiled.scale[k:]) ** 2 / runs.mass
            ).sum(axis=1)
            speed = np.sqrt(2.0 * energy * mobility)
            with np.errstate(over="ignore"):  # a contact that stiff gets the shortest tick
                spring, dashpot = mobility * mine["stiffness"] / allowed, mobility * mine["closing"] / allowed
            rates = law.quickest(spring, dashpot, speed)
            if rates is None:
                return FINEST_HALVINGS
            shortest = min(shortest, 1.0 / np.clip(float(rates.max()), 1e-300, 1e300))
    return int(np.clip(np.ceil(np.log2(window.duration / shortest)), LEAST_HALVINGS, FINEST_HALVINGS))
