"""Materials like an entry of the library, with what is known better in place of its values."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from femstruct.errors import InputError
from femstruct.model.library.all_entries import library
from femstruct.model.library.library_entry import Use
from femstruct.model.material import Material
from femstruct.model.materials.loss_by_frequency import Loss
from femstruct.model.materials.orthotropic import AnyMaterial, Orthotropic
from femstruct.model.materials.timber import CLASSES, timber

_SYMBOLS = {"loss_factor": "loss factor"}


def alike(
    name: str,
    like: str,
    E: float | tuple[float, ...] | None = None,
    nu: float | tuple[float, ...] | None = None,
    rho: float | None = None,
    G: tuple[float, ...] | None = None,
    loss_factor: Loss | None = None,
) -> AnyMaterial:
    """A material of the library under a name of its own; `completed` says what was taken, and from which work.

    E, nu, rho, G, loss_factor : in place of those of the entry. A loss factor that neither gives is 0.

    Raises InputError for an entry that is no material, for several moduli where the entry has one, and for one where it
    has several.

    >>> slab = alike("slab concrete", "concrete C30/37", rho=2500.0)
    >>> slab.E, slab.rho, slab.completed[0]
    (33000000000.0, 2500.0, 'E of concrete C30/37: EN 1992-1-1:2004, table 3.1')
    """
    where = f"materials.{name}"
    entry = library().get(like)
    if entry is None or entry.use is not Use.MATERIAL:
        raise InputError(f"{where}.like", got=f"'{like}'", expected="a material of the library")
    given = {"E": E, "nu": nu, "rho": rho, "G": G, "loss_factor": loss_factor}
    stated = {key: value for key, value in given.items() if value is not None}
    several = isinstance(entry.value("E"), tuple)
    if (E is not None and isinstance(E, tuple) != several) or (G is not None and not several):
        got = "G of an isotropic material" if E is None else "several moduli" if isinstance(E, tuple) else "one modulus"
        expected = f"{'[Ex, Ey] or [Ex, Ey, Ez]' if several else 'E, nu'} as {like} has"
        raise InputError(f"{where}.{'G' if E is None else 'E'}", got=got, expected=expected)
    if not several and isinstance(nu, tuple):
        raise InputError(f"{where}.nu", got="several ratios", expected=f"one, as {like} has")
    if like in CLASSES and E is None and nu is None:
        return timber(name, like, G, rho, 0.0 if loss_factor is None else loss_factor)
    taken = {one.key: one for one in entry.facts if one.value is not None and one.key not in stated}
    values: dict[str, Any] = {key: one.value for key, one in taken.items() if key in given} | stated
    told = tuple(f"{_SYMBOLS.get(key, key)} of {like}: {taken[key].source.work}" for key in given if key in taken)
    if not several:
        return Material(name, **values, completed=told)
    made = Orthotropic(name, **values)
    return replace(made, completed=(*told, *made.completed))
