"""Constants of the exact march, and its work space."""

from __future__ import annotations

from functools import cache
from math import comb, factorial
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from femstruct.arrays import Floats
from femstruct.impact.compiled.byte_layout import Counts, CountTable, Matrix, Vector
from femstruct.impact.engine.energy import INTEGRATED
from femstruct.impact.engine.records import System

ORDER = 26  # of the power series of a step
SHORT = 4  # of a first look at what switches at this very instant
THETA = 2.0  # longest step times the bound of the system's frequencies
TRUNCATION = 1e-17  # of the exponential series at the order used: a tenth of rounding
GAUSS = 10  # points: energies of a longest step are good to 1e-18
COARSE = 8  # degree of the first look at a polynomial; what is left out of it is a margin
PROBES = 6  # parts of a step in one of which its largest value is bracketed
DEPTH = 60  # halvings of a step while a root is bracketed


class ExactRule(NamedTuple):
    """bernstein [j, k] : Bernstein coefficients of degree ORDER on (0, 1) from powers k; every weight is in 0..1, so
    nothing is amplified; coarse [j, k] : the same of degree COARSE. nodes, weights [g] : Gauss's rule on (0, 1).
    at_nodes [g, k], at_probes [p, k] : powers of the nodes, and of p / PROBES from p = 0. factors [k] : 1 / k!.
    reach [p] : largest bound times step for which order p leaves out no more than TRUNCATION."""

    bernstein: Matrix
    coarse: Matrix
    nodes: Vector
    weights: Vector
    at_nodes: Matrix
    at_probes: Matrix
    factors: Vector
    reach: Vector


@cache
def exact_rule() -> ExactRule:
    """The constants.

    >>> rule = exact_rule()
    >>> bool(rule.reach[ORDER] >= THETA), bool(np.isclose(rule.weights @ rule.nodes**19, 1 / 20, rtol=1e-14))
    (True, True)
    """
    size = ORDER + 1
    x, w = legendre.leggauss(GAUSS)
    nodes = (1.0 + x) / 2.0
    return ExactRule(
        bernstein=_bernstein(ORDER),
        coarse=_bernstein(COARSE),
        nodes=nodes,
        weights=w / 2.0,
        at_nodes=nodes[:, None] ** np.arange(size),
        at_probes=np.linspace(0.0, 1.0, PROBES + 1)[:, None] ** np.arange(size),
        factors=np.array([1.0 / factorial(k) for k in range(size)]),
        reach=np.array([0.0] + [(TRUNCATION * factorial(p)) ** (1.0 / p) for p in range(1, size)]),
    )


def _bernstein(degree: int) -> Floats:
    return np.array([[comb(j, k) / comb(degree, k) for k in range(degree + 1)] for j in range(degree + 1)])


class ExactRoom(NamedTuple):
    """Work space of one march, used by every step: nothing is allocated on the way.

    z [ORDER + 1, n] : power series of the coordinates over the step, in parts of it; w : of the rates of oscillators in
    place of coupled modes [1/s], else empty. place, rate, force [r, ORDER + 1]
    : of the rows' displacements, velocities [1/s] and forces as they act. spring, dash, held [m] : force of an
    interface in the present regime = spring place + dash rate + held. way [m] : sign of a link's speed. fresh [m, 3] :
    whether a contact's indentation, its force, a link's speed is zero by an event at this very instant. loaded [m] :
    whether a contact has a force. lost [m + INTEGRATED] : dissipated by interfaces, by modes; work; nothing
    by blows; given to coupled modes.
    here [r, 2] : displacement and velocity. watched [ORDER + 1] : a polynomial. boxes [DEPTH, ORDER + 1],
    spans [DEPTH, 2] : its Bernstein coefficients on parts of the step. terms [m, 3] : sizes of what the interfaces'
    displacements and velocities are summed from, and the roots of their mobilities. q, v [n] : coordinates and rates
    somewhere in the step.
    """

    z: Matrix
    w: Matrix
    place: Matrix
    rate: Matrix
    force: Matrix
    spring: Vector
    dash: Vector
    held: Vector
    way: Counts
    fresh: CountTable
    loaded: Vector
    lost: Vector
    here: Matrix
    watched: Vector
    boxes: Matrix
    spans: Matrix
    terms: Matrix
    q: Vector
    v: Vector


def exact_room(system: System) -> ExactRoom:
    """Work space for marches of a system of this size."""
    n, r, m, size = len(system.omega), len(system.rows), len(system.interfaces), ORDER + 1
    return ExactRoom(
        z=np.zeros((size, n)),
        w=np.zeros((size, n) if len(system.turn) else (0, 0)),
        place=np.zeros((r, size)),
        rate=np.zeros((r, size)),
        force=np.zeros((r, size)),
        spring=np.zeros(m),
        dash=np.zeros(m),
        held=np.zeros(m),
        way=np.zeros(m, dtype=np.int64),
        fresh=np.zeros((m, 3), dtype=np.int64),
        loaded=np.zeros(m),
        lost=np.zeros(m + INTEGRATED),
        here=np.zeros((r, 2)),
        watched=np.zeros(size),
        boxes=np.zeros((DEPTH, size)),
        spans=np.zeros((DEPTH, 2)),
        terms=np.zeros((m, 3)),
        q=np.zeros(n),
        v=np.zeros(n),
    )
