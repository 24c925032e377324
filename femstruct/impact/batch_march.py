"""Many runs of one scene, a row of metrics each: the tables of the modes are shared, the bodies' added in closed form.

A body's coordinate is sqrt(m) x, so that its mass is in its entries of the rows and nowhere else: what the tables
owe to bodies is that of a free unit mass times these entries.
"""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from femstruct.arrays import Floats, Integers, frozen
from femstruct.compiled.kernels import Counts, Cube, Matrix, Vector, kernel, unit
from femstruct.compiled.records import ManyInterfaces, ManyLoads, ManyStrikes, Records, System
from femstruct.errors import InputError
from femstruct.impact.collocation import ERROR_BUDGET, CollocationSteps, Workspace, collocation_workspace, integrate
from femstruct.impact.contact_events import (
    ALL_OPEN,
    CLOSES,
    DONE,
    DRIFT,
    EVENTS,
    HELD,
    PEAK,
    PEAK_AT,
    ROWS,
    SINCE,
    WHAT,
    WHOSE,
    WORKED,
    RunRecord,
    empty_record,
    rests_on_contact,
)
from femstruct.impact.contact_events import STEPS as STEPS_TAKEN
from femstruct.impact.energies import TIME, ledger_width, part_energies
from femstruct.impact.exact import (
    ExactRule,
    ExactSteps,
    ExactWorkspace,
    exact_rule,
    exact_workspace,
    integrate_exactly,
    is_piecewise_linear,
)
from femstruct.impact.propagation import (
    FINEST_HALVINGS,
    POINTS,
    STAGES,
    State,
    Tables,
    collocation_rule,
    copy_to,
    tabulated,
)
from femstruct.impact.response import LAST
from femstruct.impact.scene import Clock, Contact, HalfSine, Scene
from femstruct.impact.system import Compiled, compile_scene
from femstruct.modal.basis import ModalBasis

# ----------------------------------------------------------------------------------------------------------------------
# What differs between the runs of a batch: numbers of a scene by name, a column over the runs each.
# ----------------------------------------------------------------------------------------------------------------------

Place = tuple[str, int, str]  # field of the scene, index in it, attribute


@dataclass(frozen=True, eq=False)
class Variation:
    """A scene and the columns of numbers [runs] that take the place of its own."""

    scene: Scene
    columns: Mapping[str, Floats]
    runs: int

    def __call__(self, i: int) -> Scene:
        """The scene of run i."""
        scene, places = self.scene, variable(self.scene)
        for name, column in self.columns.items():
            scene = _with(scene, places[name], float(column[i]))
        return scene

    def column(self, name: str, otherwise: float) -> Floats:
        """The values of a name in all runs [runs], or [1] the one that all share."""
        return self.columns[name] if name in self.columns else np.array([otherwise])


def variation(scene: Scene, vary: Mapping[str, ArrayLike]) -> Variation:
    """The columns checked against the scene.

    Raises InputError for an unknown name, columns of unequal length, or no run; FemstructError for a value that is
    not finite or that its body, contact or link refuses.
    """
    places = variable(scene)
    columns: dict[str, Floats] = {}
    for name, values in vary.items():
        if name not in places:
            near = difflib.get_close_matches(name, places, n=1)
            do = f"did you mean '{near[0]}'?" if near else ""
            expected = f"one of {', '.join(places)}" if places else "a scene with names"
            raise InputError(f"vary.{name}", got="an unknown name", expected=expected, do=do)
        columns[name] = frozen(f"vary.{name}", values, (None,))
    lengths = {name: len(column) for name, column in columns.items()}
    if not lengths or not min(lengths.values()):
        raise InputError("vary", got="no run", expected="names with a value for every run")
    first, runs = next(iter(lengths.items()))
    for name, length in lengths.items():
        if length != runs:
            raise InputError(f"vary.{name}", got=f"{length} values", expected=f"{runs}, as {first} has")
    varied = Variation(scene, columns, runs)
    for column in columns.values():  # what a constructor refuses lies beyond a bound
        varied(int(column.argmin()))
        varied(int(column.argmax()))
    for contact in scene.contacts:
        gaps, preloads = (varied.column(f"{contact.name}.{w}", getattr(contact, w)) for w in ("gap", "preload"))
        varied(int((gaps * preloads).argmax()))
    return varied


def variable(scene: Scene) -> dict[str, Place]:
    """Names of all numbers of a scene that may vary, and where they are."""
    found: dict[str, Place] = {}
    for i, body in enumerate(scene.bodies):
        found |= {f"{body.name}.{word}": ("bodies", i, word) for word in ("mass", "velocity")}
    for i, contact in enumerate(scene.contacts):
        words = ("gap", "preload", *contact.law.varies)
        found |= {f"{contact.name}.{word}": ("contacts", i, word) for word in words}
    for i, link in enumerate(scene.links):
        words = ("stiffness", "closing", "opening", "preload")
        found |= {f"{link.name}.{word}": ("links", i, word) for word in words}
    for i, load in enumerate(scene.loads):
        if isinstance(load.history, HalfSine):
            found[f"{load.name}.amplitude"] = ("loads", i, "amplitude")
    return found


def numbers_of_scene(scene: Scene) -> dict[str, float]:
    """All numbers of a scene that may vary, by name.

    >>> from femstruct.impact.scene import Body
    >>> numbers_of_scene(Scene((Body("ball", 2.0, -1.0),)))
    {'ball.mass': 2.0, 'ball.velocity': -1.0}
    """
    return {name: _of(scene, place) for name, place in variable(scene).items()}


def _of(scene: Scene, place: Place) -> float:
    field, index, word = place
    item = getattr(scene, field)[index]
    if field == "contacts" and word in item.law.varies:
        return float(getattr(item.law, word))
    return float(getattr(item.history if field == "loads" else item, word))


def _with(scene: Scene, place: Place, value: float) -> Scene:
    field, index, word = place
    items: list[Any] = list(getattr(scene, field))
    item = items[index]
    if field == "contacts" and word in item.law.varies:
        items[index] = replace(item, law=replace(item.law, **{word: value}))
    elif field == "loads":
        items[index] = replace(item, history=replace(item.history, amplitude=value))
    else:
        items[index] = replace(item, **{word: value})
    changed: dict[str, Any] = {field: tuple(items)}
    return replace(scene, **changed)


# ----------------------------------------------------------------------------------------------------------------------
# Many runs of one scene, a row of metrics each.
# ----------------------------------------------------------------------------------------------------------------------

STATUS, STEPS, RESIDUAL, SEPARATED, FIRST = 0, 1, 2, 3, 4  # columns; then what `columns` says


class Columns(NamedTuple):
    """First columns of what has one for each interface, body or term of the ledger, and the number of columns."""

    peak: int
    peak_time: int
    deepest: int
    closings: int
    first_open: int
    shortest: int
    last: int
    closed: int
    velocity: int
    travel: int
    gain: int
    lifts: int
    lift_number: int
    lift_force: int
    lift_since: int
    separation: int
    end: int
    width: int


def columns(interfaces: int, bodies: int, ledger: int) -> Columns:
    """Layout of a row of metrics."""
    sizes = np.array([FIRST, *8 * [interfaces], *7 * [bodies], *2 * [ledger]])
    return Columns(*(int(start) for start in np.cumsum(sizes)))


class SharedTables(NamedTuple):
    """What all runs share. start [2, k] of the modes; waits [b] : 1 for a body that is at rest until its first blow;
    entries [r, b] of the bodies in the rows and over [o, n] of what struck bodies are placed on, for unit masses;
    struck [o] : which bodies; weight : the first row of the bodies' weight, and all rows from there on; gravity
    [m/s^2]; quiet [s] : as of the clock; mobility [r] of the modes; tables of the modes, and of a free unit mass with a
    row of its own."""

    start: Matrix
    waits: Counts
    entries: Matrix
    over: Matrix
    over_tilts: Matrix
    impacting: Counts
    weight: int
    gravity: float
    quiet: float
    mobility: Vector
    modes: Tables
    mass: Tables


class Runs(NamedTuple):
    """Some runs: mass, velocity [c, b] of the bodies, interfaces [c, m], loads [c, l], strikes [c, s]."""

    mass: Matrix
    velocity: Matrix
    interfaces: ManyInterfaces
    loads: ManyLoads
    strikes: ManyStrikes


class IntegratorSettings(NamedTuple):
    """What both integrations need, the exact one and the one by collocation. exact : whether it is the exact one, which
    needs no tables."""

    exact: bool
    steps: CollocationSteps
    scratch: Workspace
    exact_steps: ExactSteps
    exact_rule: ExactRule
    exact_scratch: ExactWorkspace


class Out(NamedTuple):
    """A row of metrics for each run [c, width], and the moments of what pushes [c, r, cells + 2] where asked for."""

    rows: Matrix
    moments: Cube


@unit(seconds=3.0)
def run_many(frame: System, shared: SharedTables, tables: Tables, runs: Runs, settings: IntegratorSettings,
             record: RunRecord, state: State, at: Columns, out: Out) -> int:  # fmt: skip
    """Fill a row of metrics [c, width] for each run.

    Parameters
    ----------
    frame, tables : System, Tables
        What of them depends on a run is this call's own.
    """
    k, bodies = frame.n_modes, runs.mass.shape[1]
    for i in range(len(out.rows)):
        new = i == 0
        for b in range(bodies):
            new = new or runs.mass[i, b] != runs.mass[i - 1, b]
        if new:
            _weigh(frame, shared, tables, runs.mass[i])
        for a in range(len(frame.interfaces)):
            frame.interfaces[a] = runs.interfaces[i, a]
        for a in range(len(frame.loads)):
            frame.loads[a] = runs.loads[i, a]
        for a in range(len(frame.strikes)):
            frame.strikes[a] = runs.strikes[i, a]
        state.z[:], state.v[:] = 0.0, 0.0
        copy_to(state.z, shared.start[0])
        copy_to(state.v, shared.start[1])
        for b in range(bodies):
            state.v[k + b] = 0.0 if shared.waits[b] else np.sqrt(runs.mass[i, b]) * runs.velocity[i, b]
        state.status[:], state.rest[:], state.pace[:], state.force[:] = 0, 0.0, 0.0, 0.0
        record.kept[:], record.peak[:], record.shortest[:] = 0, 0.0, np.inf
        record.totals[:], record.travel[:], record.deepest[:], record.late[:] = 0.0, 0.0, 0.0, np.nan
        record.strikes[:], record.latest[:], record.strike_peak[:], record.moments[:] = 0.0, -1, 0.0, 0.0
        if settings.exact:
            status = integrate_exactly(
                frame, state, settings.exact_rule, settings.exact_scratch, record, settings.exact_steps
            )
        else:
            status = integrate(frame, state, tables, settings.scratch, record, settings.steps)
        if out.moments.shape[2] > 0:
            for a in range(len(record.moments)):
                copy_to(out.moments[i, a], record.moments[a])
        rows, events = int(record.ended[ROWS]), int(record.ended[EVENTS])
        end = record.history[rows - 1 if settings.exact else rows]  # collocation counts it with samples only
        record.totals[DRIFT] += abs(part_energies(frame, state, end))
        mass, row = runs.mass[i], out.rows[i]
        _measure(
            frame, state, record, at, row,
            status=status, events=events, last=end, mass=mass, gravity=shared.gravity, quiet=shared.quiet,
        )  # fmt: skip
    return len(out.rows)


@kernel
def _weigh(frame: System, shared: SharedTables, tables: Tables, mass: Floats) -> None:
    """The rows, and all of the tables that depends on them, for these masses."""
    k, r, rows = frame.n_modes, len(frame.rows), frame.rows
    modes, unit = shared.modes, shared.mass
    _weigh_rows(frame, shared, mass)
    for level in range(len(tables.flow)):
        for a in range(r):
            for p in range(POINTS):
                for x in range(2):
                    for c in range(r):
                        copy_to(tables.forced[level, a, p, x, c], modes.forced[level, a, p, x, c])
        for x in range(2):
            for j in range(STAGES + 1):
                for a in range(r):
                    copy_to(tables.stray_push[level, x, j, a], modes.stray_push[level, x, j, a])
        for b in range(len(mass)):
            for a in range(r):
                here = rows[a, k + b]
                if here == 0.0:
                    continue
                for p in range(2 * POINTS):
                    for x in range(2):
                        tables.free[level, x, k + b, a * 2 * POINTS + p] = here * unit.free[level, x, 0, p]
                for c in range(r):
                    pair = here * rows[c, k + b]
                    if pair == 0.0:
                        continue
                    acts = pair * frame.sign[c]
                    for p in range(POINTS):
                        for x in range(2):
                            for s in range(STAGES):
                                tables.forced[level, a, p, x, c, s] += acts * unit.forced[level, 0, p, x, 0, s]
                    for x in range(2):
                        for s in range(STAGES + 1):
                            tables.stray_push[level, x, s, a, c] += abs(pair) * unit.stray_push[level, x, s, 0, 0]


@kernel
def _weigh_rows(frame: System, shared: SharedTables, mass: Floats) -> None:
    """The rows, and what of the system depends on them."""
    k, rows = frame.n_modes, frame.rows
    for a in range(len(rows)):
        frame.mobility[a] = shared.mobility[a]
        for b in range(len(mass)):
            root = np.sqrt(mass[b])
            rows[a, k + b] = shared.entries[a, b] * (root if a >= shared.weight else 1.0 / root)
            frame.mobility[a] += rows[a, k + b] ** 2
            if len(frame.turn):
                frame.drives[a, k + b] = rows[a, k + b]
    for o in range(len(shared.impacting)):
        root = np.sqrt(mass[shared.impacting[o]])
        for j in range(len(frame.omega)):
            frame.over[o, j] = shared.over[o, j] * (root if j < k else root / np.sqrt(mass[j - k]))
        for j in range(frame.over_tilts.shape[1]):
            frame.over_tilts[o, j] = shared.over_tilts[o, j] * root


@kernel
def _measure(system: System, state: State, record: RunRecord, at: Columns, row: Floats, status: int, events: int,
             last: Floats, mass: Floats, gravity: float, quiet: float) -> None:  # fmt: skip
    """One row of metrics; a run that failed has its status and steps only.

    Parameters
    ----------
    last : Floats
        The ledger row at the end.
    """
    m, k, log, times = len(system.interfaces), system.n_modes, record.events, record.event_rows[:, TIME]
    row[:] = np.nan
    row[STATUS], row[STEPS] = status, record.totals[STEPS_TAKEN]
    if status != DONE:
        return
    first = record.history[0]
    ledger, end = len(first), last[TIME]
    total = 0.0
    for i in range(1, ledger - 2):  # nothing has worked yet
        total += first[i]
    scale = max(abs(total), record.totals[WORKED])
    row[RESIDUAL] = record.totals[DRIFT] / scale if scale > 0.0 else 0.0
    for a in range(m):
        row[at.peak + a], row[at.peak_time + a] = record.peak[a, PEAK], record.peak[a, PEAK_AT]
        for s in range(len(record.strike_peak)):  # peaks are those since the last blow
            peak = record.strike_peak[s, a]
            if peak[PEAK] > row[at.peak + a]:
                row[at.peak + a], row[at.peak_time + a] = peak[PEAK], peak[PEAK_AT]
        row[at.closings + a], row[at.deepest + a] = 0.0, record.deepest[a]
        row[at.shortest + a], row[at.closed + a] = record.shortest[a], record.closed[a]
    for e in range(events):
        a = log[e, WHOSE]
        row[at.last + a] = times[e]
        if log[e, WHAT] == CLOSES:
            row[at.closings + a] += 1.0
        elif np.isnan(row[at.first_open + a]):
            row[at.first_open + a] = times[e]
    again = np.inf  # when the next closing is, going back
    row[SEPARATED] = 0.0
    for e in range(events - 1, -1, -1):
        if log[e, WHAT] == CLOSES:
            again = times[e]
        elif log[e, ALL_OPEN] and times[e] + quiet <= end and again > times[e] + quiet:
            row[SEPARATED] = 1.0
            for i in range(ledger):
                row[at.separation + i] = record.event_rows[e, i]
    for i in range(ledger):
        row[at.end + i] = last[i]
    for b in range(len(mass)):
        root = np.sqrt(mass[b])
        row[at.velocity + b], row[at.travel + b] = state.v[k + b] / root, record.travel[b] / root
        row[at.gain + b] = abs(state.v[k + b] - record.late[k + b]) / (root * (end - record.late_at[0] * system.tick))
        row[at.lifts + b] = 0.0
        blows = 0
        for s in range(len(system.strikes)):
            if system.strikes[s]["coordinate"] != k + b:
                continue
            held = record.strikes[s, HELD]
            if held > 0.0 and not rests_on_contact(held, gravity * mass[b]):
                if row[at.lifts + b] == 0.0:
                    row[at.lift_number + b], row[at.lift_force + b] = blows, held
                    row[at.lift_since + b] = system.strikes[s]["tick"] * system.tick - record.strikes[s, SINCE]
                row[at.lifts + b] += 1.0
            blows += 1


# ----------------------------------------------------------------------------------------------------------------------
# A batch made ready for its kernel: shared tables, the tick, and the numbers of some of its runs.
# ----------------------------------------------------------------------------------------------------------------------

MAX_STEPS = 2_000_000  # of a run
STEPS_BETWEEN_CHECKS = 50_000  # steps tried between two looks at its progress: a tenth of a second or more
SURVEYED = 4096  # runs looked at together for the tick
LEAST_HALVINGS = 12


@dataclass(frozen=True, eq=False)
class Fleet:
    """What all runs share, and where their numbers come from.

    compiled : the scene as given; exact : whether all runs take the exact integration; top_level : of the steps of the
    other one; late : tick from which on bodies that rest hardly gain speed, -1 where none can rest; columns : of a row
    of metrics.
    """

    varied: Variation
    clock: Clock
    compiled: Compiled
    shared: SharedTables
    tables: Tables
    exact: bool
    top_level: int
    late: int
    columns: Columns

    @staticmethod
    def of(basis: ModalBasis, varied: Variation, window: Clock, *, with_receivers: bool = False) -> Fleet:
        """A fleet on a basis.

        Parameters
        ----------
        window : Clock
            Of one sample, so that its end is a power of two ticks away.
        with_receivers : bool
            Whether forces are needed as polynomials, which collocation has.
        """
        compiled = compile_scene(basis, varied.scene, window)
        exact = not with_receivers and is_piecewise_linear(_hardest(varied, compiled), window.duration)
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
        impacting = np.array([places[blows.body] for blows in scene.blows], dtype=np.int64)
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
        shared = SharedTables(
            start=compiled.start[:, :k].copy(),
            waits=np.array([body.name in waiting for body in scene.bodies], dtype=np.int64),
            entries=entries,
            over=system.over * np.append(np.ones(k), scale) / scale[impacting][:, None],
            over_tilts=system.over_tilts / scale[impacting][:, None] if system.over_tilts.size else system.over_tilts,
            impacting=impacting,
            weight=weight,
            gravity=scene.gravity,
            quiet=window.quiet,
            mobility=(compiled.pushed**2).sum(axis=1),
            modes=modes,
            mass=tabulated(unit, levels, collocation_rule()),
        )
        width = ledger_width(system)
        at = columns(len(system.interfaces), len(varied.scene.bodies), width)
        return Fleet(
            varied,
            window,
            compiled=compiled,
            shared=shared,
            tables=modes,
            exact=exact,
            top_level=halvings,
            late=late,
            columns=at,
        )


def run_some(fleet: Fleet, first: int, out: Floats, stop: Integers, cells: int = 0, spacing: float = 1.0) -> Floats:
    """Fill the rows of the runs from `first` on; all it changes is its own.

    Parameters
    ----------
    stop : Integers [1]
        Not zero to end at once.

    Returns
    -------
    Floats
        The moments [runs, r, cells + 2] of what pushes in cells of `spacing` seconds; of no columns where there are no
        cells.
    """
    system, tables = fleet.compiled.system, fleet.tables
    r, m, n = len(system.rows), len(system.interfaces), len(system.omega)
    columns = cells + 2 if cells else 0
    moments = np.zeros((len(out), r, columns))
    record = empty_record(system, 0)._replace(stop=stop, moments=np.zeros((r, columns)), spacing=np.array([spacing]))
    record.late_at[0] = fleet.late
    run_many(
        frame=system._replace(
            rows=system.rows.copy(),
            mobility=system.mobility.copy(),
            over=system.over.copy(),
            over_tilts=system.over_tilts.copy(),
            drives=system.drives.copy(),
            interfaces=system.interfaces.copy(),
            loads=system.loads.copy(),
            strikes=system.strikes.copy(),
        ),
        shared=fleet.shared,
        tables=tables._replace(
            free=tables.free.copy(),
            forced=tables.forced.copy(),
            stray_push=tables.stray_push.copy(),
        ),
        runs=numbers(fleet.varied, fleet.compiled, first, first + len(out)),
        settings=IntegratorSettings(
            exact=fleet.exact,
            steps=CollocationSteps(
                halvings=fleet.compiled.halvings,
                top_level=fleet.top_level,
                tolerance=fleet.clock.tolerance * ERROR_BUDGET,
                max_steps=MAX_STEPS,
                paced=STEPS_BETWEEN_CHECKS,
            ),
            scratch=collocation_workspace(system),
            exact_steps=ExactSteps(fleet.clock.duration, interval=np.inf, longest=np.inf, max_steps=MAX_STEPS),
            exact_rule=exact_rule(),
            exact_scratch=exact_workspace(system),
        ),
        record=record,
        state=State(
            z=np.zeros(n),
            v=np.zeros(n),
            status=np.zeros(m, dtype=np.int64),
            rest=np.zeros(m),
            pace=np.zeros(r),
            force=np.zeros(m),
        ),
        at=fleet.columns,
        out=Out(out, moments),
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
            static_indentation = _preload_indentation(contacts[name], varied, interfaces[:, a])
            interfaces["offset"][:, a] = static_indentation - values(f"{name}.gap", contacts[name].gap)
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


def _preload_indentation(contact: Contact, varied: Variation, interfaces: Records) -> Floats:
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
