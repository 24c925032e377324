"""Tabulated: a spring through measured points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, Final

import numpy as np
import scipy

from femstruct.arrays import Floats, freeze, frozen
from femstruct.compiled.kernels import kernel
from femstruct.compiled.records import NUMBERS, System
from femstruct.declared import Key, checked
from femstruct.errors import Finding, InputError
from femstruct.laws.law import Code, Dissipation, FactorLaw, StoredLaw
from femstruct.quantities import Quantity
from femstruct.tags import stored_as


@kernel
def _spring(system: System, a: int, delta: float) -> tuple[float, float, float]:
    """Its cubic pieces, and straight on at both ends."""
    left = system.interfaces[a]["first"]
    right = left + system.interfaces[a]["length"]
    while right - left > 1:
        middle = (left + right) // 2
        if system.curves[middle, 0] <= delta:
            left = middle
        else:
            right = middle
    x = delta - system.curves[left, 0]
    force, slope, energy = system.curves[left, 1], system.curves[left, 2], system.curves[left, 5]
    c2, c3 = (system.curves[left, 3], system.curves[left, 4]) if x > 0.0 else (0.0, 0.0)
    return (
        force + x * (slope + x * (c2 + x * c3)),
        slope + x * (2.0 * c2 + 3.0 * x * c3),
        energy + x * (force + x * (slope / 2.0 + x * (c2 / 3.0 + x * c3 / 4.0))),
    )


CODE: Final = Code(_spring)
BEYOND: Final = "beyond-table"


@stored_as("tabulated contact law/1")
@dataclass(frozen=True, eq=False)
@checked("{word} law")
class Tabulated(FactorLaw):
    """f = s(d) (1 + chi d') with s through measured points: indentation [n] [m], force [n] [N].

    Between the points s is a straight line, as it is drawn; smooth : a monotone cubic (PCHIP) in its place, whose slope
    is continuous and which has no ripple of its own, for a few points of a smooth curve. Both columns begin at 0 and
    rise. Beyond the last point s goes on along its last slope, and a run that gets there has a
    severe finding, `beyond-table`: the force is then a guess.

    dissipation chi [s/m]; tensile : let the dashpot pull.

    Raises InputError for columns of unequal length, fewer than two points, or ones that do not rise from 0.

    References: Fritsch and Carlson, SIAM J. Numer. Anal. 17 (1980) 238; slopes as in scipy's PchipInterpolator.

    >>> pad = Tabulated([0.0, 1e-3, 2e-3], [0.0, 10.0, 40.0])
    >>> round(pad.indentation(10.0), 9)
    0.001
    """

    word: ClassVar = "table"
    code: ClassVar = CODE
    varies: ClassVar = {"dissipation": "closing"}
    doubts: ClassVar = {BEYOND: True}

    indentations: Annotated[Floats, Quantity(("length",)), Key(None)]
    forces: Annotated[Floats, Quantity(("force",)), Key(None)]
    dissipation: Dissipation = 0.0
    tensile: bool = False
    smooth: bool = False

    def __post_init__(self, restitution: float | None, at_speed: float | None) -> None:
        super().__post_init__(restitution, at_speed)
        depth = frozen("table law indentations", self.indentations, (None,))
        freeze(self, indentations=depth, forces=frozen("table law forces", self.forces, depth.shape))
        if len(depth) < 2:
            raise InputError("table law", got=f"{len(depth)} points", expected="two or more, the first at 0")
        for word, column, unit in (("indentation", depth, "m"), ("force", self.forces, "N")):
            if column[0] != 0.0:
                raise InputError(
                    "table law",
                    got=f"a first {word} of {column[0]:g} {unit}",
                    expected="0: no force at zero indentation",
                )
            falls = np.flatnonzero(np.diff(column) <= 0)
            if len(falls):
                a, b = column[falls[0]], column[falls[0] + 1]
                raise InputError("table law", got=f"{word} {b:g} {unit} after {a:g} {unit}", expected="a rise")

    @property
    def pieces(self) -> Floats:
        """Rows of indentation, force, slope, the coefficients of x^2 and x^3 after it, and energy [J] up to it."""
        x = np.diff(self.indentations)
        if self.smooth:
            c3, c2, slope, force = scipy.interpolate.PchipInterpolator(self.indentations, self.forces).c
        else:
            c3, c2, slope, force = 0.0 * x, 0.0 * x, np.diff(self.forces) / x, self.forces[:-1]
        energy = np.cumsum(x * (force + x * (slope / 2 + x * (c2 / 3 + x * c3 / 4))))
        last = slope[-1] + x[-1] * (2 * c2[-1] + 3 * x[-1] * c3[-1])
        rows = np.zeros((len(self.indentations), NUMBERS))
        rows[:, 0], rows[:, 1] = self.indentations, self.forces
        rows[:, 2] = np.append(slope, last)
        rows[:-1, 3], rows[:-1, 4], rows[1:, 5] = c2, c3, energy
        return rows

    def indentation(self, force: float) -> float:
        """Indentation under a force at rest [m].

        Raises InputError for a force beyond the last point.
        """
        if force > self.forces[-1]:
            raise InputError(
                "table law preload",
                got=f"{force:g} N",
                expected=f"at most the last force of the table, {self.forces[-1]:g} N",
                do="extend the table",
            )
        if not self.smooth:
            return float(np.interp(force, self.forces, self.indentations))
        depth = self.indentations[-1]
        spring = scipy.interpolate.PchipInterpolator(self.indentations, self.forces)
        return float(
            scipy.optimize.brentq(lambda d: float(spring(d)) - force, 0.0, depth, xtol=1e-16 * depth, rtol=1e-15)
        )

    @property
    def stored(self) -> StoredLaw:
        return StoredLaw(damping=self.dissipation, rows=self.pieces)

    def findings(self, contact: str, deepest: float) -> tuple[Finding, ...]:
        last = float(self.indentations[-1])
        if not deepest > last:
            return ()
        return (
            Finding(
                BEYOND,
                f"Contact '{contact}' was compressed by {1e3 * deepest:.4g} mm; its table ends at {1e3 * last:.4g} mm. "
                "Beyond, the force is extrapolated with the last slope.",
                {"indentation_m": deepest, "last_m": last},
                severe=True,
            ),
        )

    @property
    def doubted_from(self) -> Mapping[str, float]:
        return {BEYOND: float(self.indentations[-1])}
