"""All contact laws: those of the modules of this package, those that other packages add, and their codes by number."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import is_dataclass
from importlib import import_module
from inspect import isabstract
from pkgutil import iter_modules
from typing import Any, Final

from femstruct.compiled.kernels import kernel
from femstruct.compiled.records import System
from femstruct.laws import __name__ as package
from femstruct.laws import __path__ as places
from femstruct.laws.law import Code, Kernel, Law
from femstruct.plugins import added_kinds, with_added


def _laws() -> Iterator[type[Law]]:
    for name in sorted(module.name for module in iter_modules(places)):
        if name not in ("registry", "dispatch"):
            module = import_module(f"{package}.{name}")
            mine = [one for one in vars(module).values() if isinstance(one, type) and issubclass(one, Law)]
            here = [one for one in mine if one.__module__ == module.__name__ and is_dataclass(one)]
            yield from (one for one in here if not isabstract(one))


LAWS: Final[tuple[type[Law], ...]] = with_added(
    tuple(_laws()), added_kinds("femstruct.laws", Law, "femstruct.language.laws"), lambda law: (law.word,)
)
CODES: Final[tuple[Code, ...]] = tuple(dict.fromkeys(law.code for law in LAWS))
DOUBTS: Final = {code: severe for law in LAWS for code, severe in law.doubts.items()}


# ----------------------------------------------------------------------------------------------------------------------
# The kernels of all laws as one: each looks for the kind of its interface, and goes on as that law says.
# ----------------------------------------------------------------------------------------------------------------------


def _of_one(kind: int, mine: Kernel, other: Kernel) -> Kernel:
    """A kernel of one number that is `mine` for interfaces of a kind."""

    @kernel
    def choose(system: System, a: int, delta: float) -> Any:
        return mine(system, a, delta) if system.interfaces[a]["kind"] == kind else other(system, a, delta)

    return choose


def _of_two(kind: int, mine: Kernel, other: Kernel) -> Kernel:
    """A kernel of two numbers that is `mine` for interfaces of a kind."""

    @kernel
    def choose(system: System, a: int, x: float, y: float) -> Any:
        return mine(system, a, x, y) if system.interfaces[a]["kind"] == kind else other(system, a, x, y)

    return choose


def _springs() -> Kernel:
    chosen = CODES[-1].spring
    for kind in range(len(CODES) - 2, -1, -1):
        chosen = _of_one(kind, CODES[kind].spring, chosen)
    return chosen


spring: Final = _springs()  # (system, a, delta): force of a contact's spring, its slope, and the energy it holds


@kernel
def _as_factor(system: System, a: int, delta: float, speed: float) -> tuple[float, float, float, float]:
    force, slope, _ = spring(system, a, delta)
    damping = system.interfaces[a]["closing"]
    factor = 1.0 + damping * speed
    return force * factor, slope * factor, force * damping, force * damping


@kernel
def _difference(system: System, a: int, static_indentation: float, moved: float) -> float:
    there = spring(system, a, static_indentation + moved)[2] if static_indentation + moved > 0.0 else 0.0
    force, _, here = spring(system, a, static_indentation)
    return float(there - here - force * moved)


def _forces() -> Kernel:
    chosen: Kernel = _as_factor
    for kind, code in enumerate(CODES):
        chosen = chosen if code.force is None else _of_two(kind, code.force, chosen)
    return chosen


def _besides() -> Kernel:
    chosen: Kernel = _difference
    for kind, code in enumerate(CODES):
        chosen = chosen if code.beside is None else _of_two(kind, code.beside, chosen)
    return chosen


force: Final = _forces()  # (system, a, delta, speed): as `Code.force`, of every law
beside: Final = _besides()  # (system, a, rest, moved): as `Code.beside`, of every law
