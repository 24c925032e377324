"""What kernels read: a System, the rows of laws, loads and strikes, and the numbers of their kinds."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.compiled.kernels import Counts, Cube, Matrix, Vector
from femstruct.modal.oscillators import Oscillators

LINK = -1  # kind of an interface that is no contact
CONSTANT, HALF_SINE, TABLE = 0, 1, 2  # kinds of loads
NUMBERS = 6  # of a row that a law brings

Records = NDArray[np.void]
INTERFACE = np.dtype(
    [
        ("kind", np.int64),
        ("factor", np.int64),
        ("straight", np.int64),
        ("stiffness", np.float64),
        ("closing", np.float64),
        ("opening", np.float64),
        ("offset", np.float64),
        ("preload", np.float64),
        ("tensile", np.int64),
        ("release", np.int64),
        ("shape", np.float64),
        ("first", np.int64),
        ("length", np.int64),
        ("force_at", np.int64),
        ("energy_at", np.int64),
    ]
)
LOAD = np.dtype(
    [
        ("kind", np.int64),
        ("value", np.float64),
        ("frequency", np.float64),
        ("first", np.int64),
        ("length", np.int64),
        ("start", np.float64),
        ("every", np.float64),
        ("count", np.int64),
        ("span", np.float64),
    ]
)
STRIKE = np.dtype([("tick", np.int64), ("over", np.int64), ("coordinate", np.int64), ("velocity", np.float64)])

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
    interfaces : laws of contacts and links (INTERFACE). kind : number of a contact's code in `laws.registry`, or LINK;
    factor : whether its dashpot is a factor of the spring, closing then chi; straight : whether its numbers are
    constants, so that the exact march may take it; indentation = displacement + offset; release in ticks, of a contact:
    of the first blow of a body it waits for; shape : a law's other number; first, length point into the rows of numbers
    curves [p, 6] that a law brings; force_at, energy_at : addresses of a user's functions.
    loads : histories (LOAD); first, length point into table [t, force]; each comes count times from start on, every
    `every`, and lasts for span [s].
    strikes : blows of bodies in the order of time (STRIKE): when, which of the rows `over` [b, n] the coordinate is
    placed on (row . z is what it becomes), and its velocity. Those at tick 0 are the start itself.
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
