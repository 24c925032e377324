"""What kernels read: a System, the rows of laws, loads and strikes, and the numbers of their kinds."""

from __future__ import annotations

from typing import Annotated, NamedTuple, get_type_hints

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.compiled.kernels import Counts, Cube, Matrix, Vector
from femstruct.modal.oscillators import Oscillators

LINK = -1  # kind of an interface that is no contact
CONSTANT, HALF_SINE, TABLE = 0, 1, 2  # kinds of loads
NUMBERS = 6  # of a row that a law brings

Records = NDArray[np.void]


def _dtype_of(kind: type) -> np.dtype[np.void]:
    """Records of whole and of real numbers, by the names of a named tuple."""
    hints = get_type_hints(kind)
    return np.dtype([(name, np.int64 if hints[name] is int else np.float64) for name in kind._fields])  # type: ignore[attr-defined]


class InterfaceRecord(NamedTuple):
    """What kernels know of a contact or a link.

    kind : number of a contact's code in `laws.registry`, or LINK; factor : whether its dashpot is a factor of the
    spring, closing then chi; straight : whether its numbers are constants, so that the exact integration may take it;
    indentation = displacement + offset; release in ticks, of a contact: of the first blow of a body it waits for;
    shape : a law's other number; first, length point into the rows of numbers `System.curves` that a law brings;
    force_at, energy_at : addresses of a user's functions.
    """

    kind: int
    straight: int
    stiffness: float
    closing: float
    opening: float
    preload: float
    release: int
    factor: int = 0
    offset: float = 0.0
    tensile: int = 0
    shape: float = 0.0
    first: int = 0
    length: int = 0
    force_at: int = 0
    energy_at: int = 0


class LoadRecord(NamedTuple):
    """What kernels know of a load: of a constant its value, of a half sine its value and frequency, of a table where
    it begins (first, length) in `System.table`. It comes `repeats` times from start on, every `every`, and lasts for
    span [s]."""

    kind: int
    start: float
    value: float = 0.0
    frequency: float = 0.0
    first: int = 0
    length: int = 0
    every: float = 0.0
    repeats: int = 1
    span: float = 0.0


class StrikeRecord(NamedTuple):
    """A blow of a body: its tick, which of the rows `System.over` its coordinate is placed on, and its velocity."""

    tick: int
    over: int
    coordinate: int
    velocity: float


INTERFACE, LOAD, STRIKE = _dtype_of(InterfaceRecord), _dtype_of(LoadRecord), _dtype_of(StrikeRecord)

Interfaces = Annotated[Records, (INTERFACE, 1)]
LoadRecords = Annotated[Records, (LOAD, 1)]
StrikeRecords = Annotated[Records, (STRIKE, 1)]
ManyInterfaces = Annotated[Records, (INTERFACE, 2)]  # of many runs
ManyLoads = Annotated[Records, (LOAD, 2)]
ManyStrikes = Annotated[Records, (STRIKE, 2)]


class System(NamedTuple):
    """What the kernels need to know. n coordinates of unit mass: k modes, then bodies as sqrt(m) x.

    omega, damping [n] : z'' + damping z' + omega^2 z of each. Modes that damping couples are taken as the oscillators
    that `femstruct.modal.coupled_damping` makes of them, for which z' is not the rate v, and which have the rest:
    rows [r, n] : contacts, links, then loads; displacement of a row is lower end less upper end (approach), its force
    acts as sign * row. mobility [r] : row . row, the inverse mass behind it at high frequency.
    tilts, kicks, drives [r, n] : displacement = rows . z + tilts . v, its force adds sign * kicks to z' and sign *
    drives to v'; over_tilts [b, n] : beside over. modes, turn, surplus, misses : see `Oscillators`. All empty where
    nothing couples: then tilts and kicks are zero and drives are the rows. reach [2] : no mode's squared frequency and
    no damping of modes is larger, in their own coordinates.
    interfaces : laws of contacts and links (`InterfaceRecord`); curves [p, 6] : rows of numbers that laws bring.
    loads : histories (`LoadRecord`); table [t, force] : of those that have one.
    strikes : blows of bodies in the order of time (`StrikeRecord`); over [b, n] : row . z is what a struck body's
    coordinate becomes. Those at tick 0 are the start itself.
    kinks : ticks at which a load or a link changes its formula or a body strikes; tick [s].
    """

    omega: Vector
    damping: Vector
    n_modes: int
    rows: Matrix
    sign: Vector
    mobility: Vector
    interfaces: Interfaces
    curves: Matrix
    loads: LoadRecords
    table: Matrix
    strikes: StrikeRecords
    over: Matrix
    kinks: Counts
    tick: float
    tilts: Matrix
    kicks: Matrix
    drives: Matrix
    over_tilts: Matrix
    modes: Vector
    turn: Cube
    surplus: Matrix
    misses: Vector
    reach: Vector


def uncoupled(system: System, start: Floats, found: Oscillators) -> tuple[System, Floats]:
    """The system and its start [2, n] with oscillators in place of its modes; bodies stay as they are."""
    k, m = system.n_modes, len(found.omega)
    rows, over, strikes = system.rows, system.over, system.strikes.copy()
    strikes["coordinate"] += m - k
    turned = np.zeros((2, m + len(system.omega) - k))
    turned[:, m:] = start[:, k:]
    if start[1, :k].any():
        turned[0, :m], turned[1, :m] = found.kicks @ start[1, :k], found.drives @ start[1, :k]
    return system._replace(
        omega=np.append(found.omega, system.omega[k:]),
        damping=np.append(found.damping, system.damping[k:]),
        n_modes=m,
        rows=_seen(rows, found.places, k),
        tilts=_seen(rows, found.tilts, k, bodies=False),
        kicks=_seen(rows, found.kicks.T, k, bodies=False),
        drives=_seen(rows, found.drives.T, k),
        strikes=strikes,
        over=_seen(over, found.places, k),
        over_tilts=_seen(over, found.tilts, k, bodies=False),
        modes=found.modes,
        turn=found.turn,
        surplus=found.surplus,
        misses=found.misses,
        reach=np.array([system.reach[0], found.largest]),
    ), turned


def _seen(rows: Floats, matrix: Floats, k: int, bodies: bool = True) -> Floats:
    """Rows over [modes; bodies] through a matrix of the modes; 0 for bodies where they have no such part."""
    own = rows[:, k:] if bodies else np.zeros_like(rows[:, k:])
    return np.hstack([rows[:, :k] @ matrix, own])
