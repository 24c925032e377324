"""What is given of a noun: its numbers by name with their units, as they were put in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, Field, fields
from typing import Any, NamedTuple

import numpy as np

from femstruct.model.materials.loss_by_frequency import Loss, LossByFrequency
from femstruct.model.materials.orthotropic import AnyMaterial, Orthotropic
from femstruct.model.section import Section


class Given(NamedTuple):
    """One input: what it is called, its value in SI units (a number, several, a text, a material), its unit."""

    what: str
    value: Any
    unit: str = ""


def given(noun: Any, units: Mapping[str, str]) -> tuple[Given, ...]:
    """The fields of a frozen dataclass by name, its own name and what is as by default left out.

    units : of the fields that have one.

    >>> from femstruct.model.material import Material
    >>> given(Material("steel", E=210e9, nu=0.3, rho=7850.0), {"E": "Pa", "rho": "kg/m^3"})[0]
    Given(what='E', value=210000000000.0, unit='Pa')
    """
    return tuple(
        Given(field.name.removesuffix("_hz").replace("_", " "), plain(value), units.get(field.name, ""))
        for field in fields(noun)
        if field.name != "name" and not _as_by_default(field, value := getattr(noun, field.name))
    )


def plain(value: Any) -> Any:
    """A value that can be compared and kept: rows of numbers as tuples.

    >>> plain(np.zeros((2, 1)))
    ((0.0,), (0.0,))
    """
    rows = value.tolist() if isinstance(value, np.ndarray) else value
    return tuple(map(plain, rows)) if isinstance(rows, tuple | list) else rows


def _as_by_default(field: Field[Any], value: object) -> bool:
    default = field.default_factory() if field.default_factory is not MISSING else field.default
    return type(value) is type(default) and bool(value == default)


def of_material(material: AnyMaterial) -> tuple[Given, ...]:
    """All of a material; a loss factor of zero, too, and what was completed of an orthotropic one.

    >>> from femstruct.model.material import Material
    >>> of_material(Material("steel", E=210e9, nu=0.3, rho=7850.0))[-1]
    Given(what='loss factor', value=0.0, unit='')
    """
    first = (
        Given("E", material.E, "Pa"),
        Given("rho", material.rho, "kg/m^3"),
        Given("nu", material.nu),
        of_loss(material.loss_factor),
    )
    completed = (Given("completed", material.completed),) if material.completed else ()
    if not isinstance(material, Orthotropic):
        return (*first, *completed)
    return (*first, Given("G", material.G, "Pa"), *completed)


def of_loss(loss: Loss) -> Given:
    """A loss factor, by frequency in words.

    >>> of_loss(LossByFrequency(((63.0, 0.06), (125.0, 0.05)))).value
    ('6 % at 63 Hz', '5 % at 125 Hz')
    """
    return Given("loss factor", tuple(str(loss).split(", ")) if isinstance(loss, LossByFrequency) else loss)


def of_section(section: Section) -> tuple[Given, ...]:
    """All of a cross-section, but its shear coefficients.

    >>> of_section(Section("bar", A=1e-4, Iy=1e-9, Iz=1e-9, J=2e-9))[0]
    Given(what='A', value=0.0001, unit='m^2')
    """
    moments = (Given(name, getattr(section, name), "m^4") for name in ("Iy", "Iz", "J"))
    return (Given("A", section.A, "m^2"), *moments)
