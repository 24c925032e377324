"""Contact laws: force from indentation and its rate, compressive and positive."""

from __future__ import annotations

from dataclasses import dataclass

from femstruct.errors import FemstructError


@dataclass(frozen=True)
class Hertz:
    """f = k delta^1.5 + c delta^0.5 delta': two rounded bodies.

    stiffness k [N/m^1.5]; damping c [N s/m^1.5]; tensile : let the dashpot pull while it opens (False clamps f >= 0).
    """

    stiffness: float
    damping: float = 0.0
    tensile: bool = False

    def __post_init__(self) -> None:
        _refuse_negative(self)


@dataclass(frozen=True)
class Linear:
    """f = k delta + c delta': a unilateral spring and dashpot.

    stiffness k [N/m]; damping c [N s/m]; tensile : let the dashpot pull while it opens (False clamps f >= 0).
    """

    stiffness: float
    damping: float = 0.0
    tensile: bool = False

    def __post_init__(self) -> None:
        _refuse_negative(self)


@dataclass(frozen=True)
class Stop:
    """A bumper on both sides: a linear contact where the ends have moved further than the gap, towards or apart.

    stiffness k [N/m]; damping c [N s/m].
    """

    stiffness: float
    damping: float = 0.0
    tensile: bool = False

    def __post_init__(self) -> None:
        _refuse_negative(self)


Law = Hertz | Linear | Stop


def _refuse_negative(law: Law) -> None:
    kind = type(law).__name__.lower()
    if not law.stiffness > 0:
        raise FemstructError(f"{kind} law stiffness", got=f"{law.stiffness:g}", expected="a positive stiffness")
    if not law.damping >= 0:
        raise FemstructError(f"{kind} law damping", got=f"{law.damping:g}", expected="a damping >= 0")
