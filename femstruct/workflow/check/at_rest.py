"""A model at rest under its weight and constant forces, as the command line asks for it."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any, Final

import numpy as np

from femstruct.assembly.assemble import assemble
from femstruct.assembly.forces import GROUND
from femstruct.conventions import DIRECTIONS, GRAVITY
from femstruct.errors import InputError
from femstruct.files.tables.finding_tables import finding_table
from femstruct.language import read_model_file
from femstruct.modal.statics import AtRest, statics
from femstruct.model.imported.component import Component, rigid_resistance
from femstruct.model.meshed import Meshed
from femstruct.model.mesher import mesh_structure
from femstruct.model.model import Model
from femstruct.model.probe import Probe
from femstruct.model.structure import Structure
from femstruct.parts.substructure import Substructure
from femstruct.study.recorded import LargestStress
from femstruct.units import quantity
from femstruct.workflow.judgement.structure_findings import structure_findings_before
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.positions import positioned
from femstruct.workflow.stages.recorded.stresses import orthotropic_findings, stress_at_rest, stress_findings

Table = dict[str, Any]
_SOLVED: Final = 1e-6  # of the load, or of the stiffness: less is rounding of a file or a solution


def at_rest(path: Path, forces: list[str], weight: bool, overrides: tuple[str, ...] = ()) -> Table:
    """Table of a model at rest: displacements of its points and parts, forces that hold it, largest stresses.

    forces : each "POINT.direction=FORCE".

    Raises InputError where nothing acts, for a force it cannot read, and for a structure in closed form or one that can
    move as a whole.
    """
    if not forces and not weight:
        got, do = "nothing that acts", "such as --force 'P.z=-10 kN'"
        raise InputError("--force and --weight", got=got, expected="one of them", do=do)
    source = read_model_file(path, overrides)
    with positioned(source):
        if not isinstance(source.structure, Structure):
            raise InputError(str(path), got="a structure in closed form", expected="a model with parts")
        model = mesh_structure(source.structure)
        places = Places(model.points, model.surfaces, model.parts)
        assembly = assemble(model)
        rest = statics(model, assembly, [_force(text, places) for text in forces], weight)
    stresses = _stresses(model, places, rest, weight)
    return {
        "title": source.title,
        "load_n": rest.load.tolist(),
        "points": {
            name: [rest.of(point.probe(direction)) for direction in DIRECTIONS] for name, point in model.points.items()
        },
        "parts_m": {name: _largest(part, rest, weight) for name, part in model.parts.items()},
        "forces_n": {name: force.tolist() for name, force in rest.forces.items()},
        "on_the_ground": [name for name in rest.forces if name in (*assembly.grounded, GROUND)],
        "held_inside": _held_inside(source.structure, rest),
        "stresses": {
            name: {"largest_pa": float(one.largest.max()), "where": one.where} for name, one in stresses.items()
        },
        "findings": [
            finding_table(finding)
            for finding in (
                *structure_findings_before(source.structure, model),
                *stress_findings(stresses),
                *orthotropic_findings(source.structure, stresses),
            )
        ],
    }


def _largest(part: Meshed, rest: AtRest, weight: bool) -> float:
    """Largest displacement of a part [m]: of its nodes; of a block, of its corners: its only node is in it."""
    if part.box is None:
        moved = part.moved(rest.displacement, GRAVITY if weight else 0.0)
    else:
        corners = np.array(list(product(*part.box.T)))
        nodes, rows = part.motion_at(corners, 0.0)
        moved = np.einsum("pikc,pkc->pi", rows[:, :3], rest.displacement[nodes])
    return float((moved**2).sum(axis=1).max() ** 0.5)


def _held_inside(structure: Structure, rest: AtRest) -> Table | None:
    """What of the load reaches no support, since matrices of parts are held inside; None where all of it does."""
    held = [part.name for part in structure.parts if isinstance(part, Substructure) and _holds(part.component)]
    missing = rest.load - rest.forces[GROUND]
    if not held or np.abs(missing).max() <= _SOLVED * np.abs(rest.load).max():
        return None
    return {"parts": held, "force_n": missing.tolist()}


def _holds(component: Component) -> bool:
    """Whether something inside of it stands on the ground."""
    return not component.free or float(rigid_resistance(component)[:3].max()) > _SOLVED


def _force(text: str, places: Places) -> tuple[Probe, float]:
    """A force as it is written on the command line, at its probe."""
    spot, equals, amount = text.partition("=")
    name, _, direction = spot.strip().rpartition(".")
    if not equals or not name:
        raise InputError("--force", got=f"'{text}'", expected="POINT.direction=FORCE, such as 'P.z=-10 kN'")
    point = places.point(name, "--force")
    try:
        value = quantity(amount.strip(), "force")
    except InputError as error:
        raise InputError("--force", got=error.got, expected=error.expected, do=error.do) from error
    if direction not in (*DIRECTIONS[:3], "n"):
        raise InputError("--force", got=f"direction '{direction}'", expected="x, y, z or n")
    return point.probe(direction), value


def _stresses(model: Model, places: Places, rest: AtRest, weight: bool) -> dict[str, LargestStress]:
    """Of the parts that have stresses."""
    found: dict[str, LargestStress] = {}
    for name in model.parts:
        try:
            rows = places.stresses(name, name)
        except InputError:  # a part without stresses, such as a block, or a bar without an outline
            continue
        found[name] = stress_at_rest(rows, rest.displacement, weight)
    return found
