"""Restitution and dissipation: what a contact law gives back of the speed two bodies meet with.

Restitution e is the speed they part with over the speed they meet with, the laws' own loss in a collision that
nothing else pushes. Two kinds of dashpot have closed relations: one that is a factor of the spring, and a linear
one.
"""

from __future__ import annotations

from math import acos, acosh, exp, expm1, log, log1p, pi, sqrt

import scipy

from femstruct.errors import InputError

NEARLY_ONE = 0.999  # restitution above which the relation is solved as a series: its logarithms cancel


def dissipation_for(restitution: float, speed: float) -> float:
    """Dissipation factor chi [s/m] with which f = s(d) (1 + chi d') returns a restitution at a meeting speed [m/s].

    The exact relation a (1 + e) = ln((1 + a) / (1 - a e)), a = chi speed, solved for a: it follows from
    m v dv = -s(d) (1 + chi v) dd on the way in and out, and holds for every spring s(d) and every pair of masses.

    Raises InputError unless 0 < restitution <= 1 and speed > 0.

    References: Gonthier et al., Multibody System Dynamics 11 (2004) 209, in other letters (d = a e); Zhang and Sharf,
    J. Appl. Mech. 76 (2009) 051002. Hunt and Crossley's a = 3/2 (1 - e) and Lankarani and Nikravesh's
    a = 3/4 (1 - e^2) are its limits for e near 1.

    >>> round(restitution_of(dissipation_for(0.3, 2.0), 2.0), 12)
    0.3
    """
    refuse_restitution(restitution)
    if not speed > 0:
        raise InputError("meeting speed", got=f"{speed:g} m/s", expected="a positive speed")
    e = restitution
    if e == 1.0:
        return 0.0
    if e > NEARLY_ONE:  # terms of third order and on: what is left out is below 1e-12 of a
        a = 0.0
        for _ in range(6):
            a = (0.5 * (1 - e**2) + a * a * ((1 - e**4) / 4 - a * (1 + e**5) / 5)) * 3 / (1 + e**3)
        return a / speed
    # w = -ln(1 - a e): well placed for every e, while 1 - a e itself vanishes for a small e

    def miss(w: float) -> float:
        a = -expm1(-w) / e
        return a * (1 + e) - log1p(a) - w

    low = -log1p(-0.5 * e * 1.5 * (1 - e))  # half of Hunt and Crossley's a, which is below the exact one
    w = scipy.optimize.brentq(miss, low, 4.0 / e, xtol=1e-15, rtol=1e-15)
    return -expm1(-w) / e / speed


def restitution_of(dissipation: float, speed: float) -> float:
    """Restitution of f = s(d) (1 + chi d') at a meeting speed [m/s]; dissipation chi [s/m].

    e = (1 + W(-(1 + a) exp(-(1 + a)))) / a with a = chi speed and Lambert's W: `dissipation_for`, turned round.

    >>> round(restitution_of(0.5, 1.0), 6), restitution_of(0.0, 3.0)
    (0.748435, 1.0)
    """
    a = dissipation * speed
    if a < 1e-4:  # the next term is below 1e-12
        return 1.0 - 2.0 * a / 3.0 + 4.0 * a * a / 9.0
    part = float(1.0 + scipy.special.lambertw(-(1.0 + a) * exp(-(1.0 + a))).real)  # a e
    if a < 1.0:  # near its branch point W has half the digits: Newton gives them back
        for _ in range(2):
            part += (part + log1p(-part) + a - log1p(a)) * (1.0 - part) / part
    return part / a


def damping_ratio_for(restitution: float, tensile: bool = False) -> float:
    """Ratio c / (2 sqrt(k m)) with which f = k d + c d' returns a restitution, at every speed.

    A contact that may not pull opens when its force is zero: e = exp(-2 z acos(z) / sqrt(1 - z^2)), for z > 1 with
    acosh(z) / sqrt(z^2 - 1) (Schwager and Poeschel, Granular Matter 9 (2007) 465). One that pulls (tensile) opens
    when its indentation is zero: e = exp(-pi z / sqrt(1 - z^2)), and never from z = 1 on, a restitution of 0.

    >>> round(damping_ratio_for(0.5), 6), round(damping_ratio_for(0.5, tensile=True), 6)
    (0.255276, 0.215454)
    """
    if tensile and restitution == 0.0:
        return 1.0
    refuse_restitution(restitution)
    loss = -log(restitution)
    if restitution == 1.0:
        return 0.0
    if tensile:
        return loss / sqrt(pi**2 + loss**2)
    return float(
        scipy.optimize.brentq(
            lambda z: 2.0 * z * swing(z) - loss, 0.0, max(1.0, 1.0 / restitution), xtol=1e-16, rtol=1e-15
        )
    )


def swing(ratio: float) -> float:
    """acos(z) / sqrt(1 - z^2), and its continuation beyond z = 1: half the contact time over sqrt(m / k) of a linear
    contact that may not pull."""
    if ratio == 1.0:
        return 1.0
    root = sqrt(abs((1.0 - ratio) * (1.0 + ratio)))
    return acos(ratio) / root if ratio < 1.0 else acosh(ratio) / root


def refuse_restitution(restitution: float) -> None:
    """Raise InputError unless 0 < restitution <= 1."""
    if not 0.0 < restitution <= 1.0:
        raise InputError("restitution", got=f"{restitution:g}", expected="a value above 0 and at most 1")
