"""A law of your own: two Python functions, of the force and of the energy that its spring holds."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import ClassVar, Final

import numpy as np
import scipy
from numpy.typing import ArrayLike

from femstruct.arrays import Floats, freeze, frozen
from femstruct.compiled.kernels import call_at, kernel
from femstruct.compiled.records import NUMBERS, System
from femstruct.declared import checked
from femstruct.errors import Finding, InputError
from femstruct.laws.law import Code, Law, StoredLaw, refuse_unless_positive
from femstruct.tags import stored_as

STEP: Final = 6e-6  # of a depth or a rate, for central differences: the cube root of rounding
SLOW: Final = 0.1  # m/s: what a rate counts at least
DEPTHS: Final = np.geomspace(1e-4, 1.0, 33)  # of the deepest, where a law is checked
RATES: Final = (-1.0, -0.5, -0.1, 0.1, 0.5, 1.0)  # of the fastest
FITS: Final = 1e-5  # of a force: what the slope of the energy may differ by; a bend between two depths differs by less
JUMP: Final = 1e-3  # of the largest force: what it may be at 1e-9 of the deepest, and count as none
BEYOND: Final = "beyond-checked"


@kernel
def _spring(system: System, a: int, delta: float) -> tuple[float, float, float]:
    if delta <= 0.0:
        return 0.0, 0.0, 0.0
    at, numbers, step = system.interfaces[a]["force_at"], system.curves[system.interfaces[a]["first"]], STEP * delta
    slope = (call_at(at, delta + step, 0.0, numbers) - call_at(at, delta - step, 0.0, numbers)) / (2.0 * step)
    energy = call_at(system.interfaces[a]["energy_at"], delta, 0.0, numbers)
    return call_at(at, delta, 0.0, numbers), slope, energy


@kernel
def _force(system: System, a: int, delta: float, speed: float) -> tuple[float, float, float, float]:
    if delta <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    at, numbers = system.interfaces[a]["force_at"], system.curves[system.interfaces[a]["first"]]
    force, step, change = call_at(at, delta, speed, numbers), STEP * delta, STEP * max(abs(speed), SLOW)
    by_depth = (call_at(at, delta + step, speed, numbers) - call_at(at, delta - step, speed, numbers)) / (2.0 * step)
    by_speed = (call_at(at, delta, speed + change, numbers) - call_at(at, delta, speed - change, numbers)) / (
        2.0 * change
    )
    drag = by_speed if speed == 0.0 else (force - call_at(at, delta, 0.0, numbers)) / speed
    return force, by_depth, by_speed, drag


CODE: Final = Code(_spring, _force)


@stored_as("contact law of functions/1")
@dataclass(frozen=True, eq=False)
@checked("law")
class OwnLaw(Law):
    """f = force(d, rate, parameters): a law of your own, in Python that numba can compile.

    force : of indentation d > 0 [m], its rate [m/s], positive while the ends approach, and the parameters; it acts as
    it is, so that a dashpot that shall not pull is clamped in it: max(0.0, ...). energy : what its spring holds, of d
    and the parameters, zero at d = 0; its slope is force(d, 0, parameters), the rest of the force is a dashpot's.
    parameters [p]. deepest [m], fastest [m/s] : up to where the law is checked when it is made; a run that presses
    it in deeper has the finding `beyond-checked`.

    Both functions are compiled when the value is made, about 2 s for the first one, and again in every process: their
    machine code is not kept on disk. A study file cannot name them.

    Raises InputError, with the numbers, where the force is not finite, jumps at the first touch, does not rise with
    the indentation at rest, is not the slope of the energy, or a dashpot gives energy; and for what numba refuses.

    Notes: derivatives are central differences, good to 1e-10 of smooth functions: they decide how fast the forces are
    found, not which. A clamp inside a function is no event: the steps become short at its bend, and
    the contact counts as open from d = 0 on.

    >>> def force(d, rate, p):
    ...     return p[0] * d**1.5 * max(0.0, 1.0 + p[1] * rate)
    >>> def energy(d, p):
    ...     return 0.4 * p[0] * d**2.5
    >>> round(OwnLaw(force, energy, [1e6, 0.2], deepest=0.02, fastest=3.0).indentation(1000.0), 9)
    0.01
    """

    code: ClassVar = CODE
    doubts: ClassVar = {BEYOND: False}

    force: Callable[[float, float, Floats], float]
    energy: Callable[[float, Floats], float]
    parameters: ArrayLike
    deepest: float
    fastest: float
    tensile: bool = field(default=True, init=False)

    def __post_init__(self) -> None:
        freeze(self, parameters=frozen("own law parameters", self.parameters, (None,)))
        refuse_unless_positive("own law deepest", self.deepest)
        refuse_unless_positive("own law fastest", self.fastest)
        _check(self)

    @property
    def stored(self) -> StoredLaw:
        from femstruct.compiled.translate import own_code  # numba: of those who need it only

        numbers = np.atleast_1d(np.asarray(self.parameters, dtype=np.float64))
        rows = np.zeros((len(numbers) // NUMBERS + 1, NUMBERS))
        rows.flat[: len(numbers)] = numbers
        force, energy = own_code(self.force, True, len(numbers)), own_code(self.energy, False, len(numbers))
        return StoredLaw(rows=rows, force_at=force.address, energy_at=energy.address)

    def indentation(self, force: float) -> float:
        """Indentation under a force at rest [m]. Raises InputError beyond the force at the deepest."""
        stored = self.stored

        def miss(d: float) -> float:
            return (call_at(stored.force_at, d, 0.0, stored.rows) if d > 0.0 else 0.0) - force

        if miss(self.deepest) < 0.0:
            most = miss(self.deepest) + force
            raise InputError(
                "own law preload",
                got=f"{force:g} N",
                expected=f"at most {most:g} N, its force at the deepest, {self.deepest:g} m",
                do="raise 'deepest'",
            )
        return float(scipy.optimize.brentq(miss, 0.0, self.deepest, xtol=1e-16 * self.deepest, rtol=1e-15))

    def findings(self, contact: str, deepest: float) -> tuple[Finding, ...]:
        if not deepest > self.deepest:
            return ()
        return (
            Finding(
                BEYOND,
                f"Contact '{contact}' was compressed by {1e3 * deepest:.4g} mm; its law was checked up to "
                f"{1e3 * self.deepest:.4g} mm.",
                {"indentation_m": deepest, "checked_m": self.deepest},
            ),
        )

    @property
    def doubted_from(self) -> Mapping[str, float]:
        return {BEYOND: self.deepest}


def _refuse_beyond(law: OwnLaw) -> None:
    """Refuse parameters that are not there: machine code would read what lies behind them, Python says so."""
    count = len(np.atleast_1d(np.asarray(law.parameters)))
    for word, function, depth in (("force", law.force, (law.deepest, 0.0)), ("energy", law.energy, (law.deepest,))):
        plain: Callable[..., object] = getattr(function, "py_func", function)
        try:
            plain(*depth, law.parameters)
        except IndexError:
            got, expected = "a parameter beyond the last", f"p[0] to p[{count - 1}]" if count else "none"
            raise InputError(f"own law {word}", got=got, expected=expected, do="give it as many parameters") from None
        except (ArithmeticError, TypeError, ValueError):  # as Python has them; the machine code is checked below
            continue


def _check(law: OwnLaw) -> None:
    """Refuse a law by its numbers on a grid of depths and rates: what is checked is what will run."""
    stored = law.stored
    _refuse_beyond(law)

    def push(d: float, rate: float) -> float:
        return call_at(stored.force_at, d, rate, stored.rows)

    def held(d: float) -> float:
        return call_at(stored.energy_at, d, 0.0, stored.rows)

    def refuse(what: str, got: str, expected: str) -> None:
        raise InputError(f"own law {what}", got=got, expected=expected)

    depths, touch = DEPTHS * law.deepest, 1e-9 * law.deepest
    most = max(abs(push(depth, 0.0)) for depth in depths)
    for rate in (0.0, *(share * law.fastest for share in RATES)):
        if not abs(push(touch, rate)) <= JUMP * most:
            got = f"{push(touch, rate):.6g} N at {touch:.3g} m and {rate:g} m/s"
            refuse("force", got, "a force that starts at zero; for a jump use Linear with a dashpot")
    if not abs(held(touch)) <= JUMP * most * law.deepest:
        refuse("energy", f"{held(touch):.6g} J at {touch:.3g} m", "zero energy at zero indentation")
    before, last = 0.0, 0.0
    for depth in depths:
        force, step = push(depth, 0.0), 1e-4 * depth
        if not force > before:
            got = f"{force:.6g} N at {depth:.6g} m and rate 0, after {before:.6g} N at {last:.6g} m"
            refuse("force", got, "a force that rises with the indentation")
        rise = (held(depth + step) - held(depth - step)) / (2.0 * step)
        if not abs(rise - force) <= FITS * force:
            got = f"a slope of {rise:.6g} J/m at {depth:.6g} m, where the force at rate 0 is {force:.6g} N"
            refuse("energy", got, "an energy whose slope is the force")
        for rate in (share * law.fastest for share in RATES):
            dashpot = push(depth, rate) - force
            if not dashpot * rate >= -FITS * force * abs(rate):
                got = f"{dashpot:.6g} N in addition to the spring at {depth:.6g} m and {rate:g} m/s"
                refuse("force", got, "a dashpot that dissipates energy: a force in the direction of the rate, or none")
        before, last = force, depth
