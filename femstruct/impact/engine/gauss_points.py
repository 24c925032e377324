"""The collocation rule: forces as polynomials through Gauss points of a step, and what is known about them."""

from __future__ import annotations

from functools import cache
from math import factorial
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from femstruct.arrays import Floats
from femstruct.impact.compiled.byte_layout import Cube, Matrix, Vector

STAGES = 8
POINTS = STAGES + 1  # the Gauss points and the end of the step
PLACES = STAGES + 2  # the start as well: where contacts are watched
TERMS = 20  # of the power series of a mode's response over a step with (omega + c) h <= 1
FINEST_HALVINGS = 36  # of the sampling interval: the resolution of event times
LONGEST_DOUBLINGS = 6  # of the sampling interval: the longest step


class Rule(NamedTuple):
    """Constants of Gauss collocation with `STAGES` points on the unit interval.

    nodes [s], weights [s]. at_start, at_end [s] : values of the polynomial there from its values at the nodes.
    top [s] : its last Legendre coefficient. left, right [s, s] : nodes of the first and second half.
    shift [p, s, s] : values at (theta_p + c_n) / 2. moments [m, p, s] : integrals of (theta_p - u)^m / m! l_n(u)
    from 0 to theta_p. slopes [s, s] : derivatives 0..s-1 at the start. ends [p] : the points theta_p.
    places [s + 2] : start, nodes, end. bernstein [s + 2, s + 2] : Bernstein coefficients from values at the places.
    barycentric [s + 2] : weights of interpolation at the places. lebesgue, node_polynomial : of that interpolation
    (norm of the operator; largest |product of distances|). pieces [i, s, s] : values at the nodes of part j of a
    step cut in 2^m parts, i = 2^m - 1 + j.
    """

    nodes: Vector
    weights: Vector
    at_start: Vector
    at_end: Vector
    top: Vector
    left: Matrix
    right: Matrix
    shift: Cube
    moments: Cube
    slopes: Matrix
    ends: Vector
    places: Vector
    bernstein: Matrix
    barycentric: Vector
    lebesgue: float
    node_polynomial: float
    pieces: Cube


@cache
def collocation_rule() -> Rule:
    """The rule with `STAGES` Gauss points.

    >>> rule = collocation_rule()
    >>> bool(np.isclose(rule.weights @ rule.nodes**9, 1 / 10, rtol=1e-14))
    True
    """
    s = STAGES
    x, w = legendre.leggauss(s)
    nodes, weights = (1.0 + x) / 2.0, w / 2.0
    # discrete orthogonality: Legendre coefficients from values at the nodes, without solving anything
    coefficients = (2.0 * np.arange(s) + 1.0)[:, None] * legendre.legvander(x, s - 1).T * weights

    def values(theta: Floats | list[float]) -> Floats:
        matrix: Floats = legendre.legvander(2.0 * np.asarray(theta) - 1.0, s - 1) @ coefficients
        return matrix

    slopes = np.stack(
        [2.0**j * np.array([legendre.legval(-1.0, legendre.legder(c, j)) for c in coefficients.T]) for j in range(s)]
    )
    ends = np.append(nodes, 1.0)
    xq, wq = legendre.leggauss(20)
    uq, wq = (1.0 + xq) / 2.0, wq / 2.0
    moments = np.zeros((TERMS, POINTS, s))
    for p, theta in enumerate(ends):
        basis = values(theta * uq)
        for m in range(TERMS):
            moments[m, p] = theta * (wq * (theta * (1.0 - uq)) ** m / factorial(m)) @ basis
    places = np.concatenate(([0.0], nodes, [1.0]))
    degree = PLACES - 1
    binomials = np.array([factorial(degree) // (factorial(i) * factorial(degree - i)) for i in range(PLACES)])
    shape = binomials * places[:, None] ** np.arange(PLACES) * (1.0 - places[:, None]) ** (degree - np.arange(PLACES))
    fine = np.linspace(0.0, 1.0, 4001)
    differences = places[:, None] - places
    np.fill_diagonal(differences, 1.0)
    products = np.prod(fine[:, None] - places, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        cardinal = products[:, None] / ((fine[:, None] - places) * differences.prod(axis=1))
    cardinal[~np.isfinite(cardinal)] = 0.0
    pieces = np.concatenate(
        [np.stack([values((j + nodes) / 2.0**m) for j in range(2**m)]) for m in range(LONGEST_DOUBLINGS + 1)]
    )
    return Rule(
        nodes=nodes,
        weights=weights,
        at_start=values([0.0])[0],
        at_end=values([1.0])[0],
        top=coefficients[-1],
        left=values(nodes / 2.0),
        right=values((1.0 + nodes) / 2.0),
        shift=np.stack([values((theta + nodes) / 2.0) for theta in ends]),
        moments=moments,
        slopes=slopes,
        ends=ends,
        places=places,
        bernstein=np.linalg.inv(shape).astype(np.float64),
        barycentric=1.0 / differences.prod(axis=1),
        lebesgue=float(np.abs(cardinal).sum(axis=1).max()),
        node_polynomial=float(np.abs(products).max()),
        pieces=pieces,
    )
