"""From a structure to its modal basis, solved once for every distinct structure and set of pushed places."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from femstruct.assembly.assemble import assemble
from femstruct.modal.basis import ModalBasis
from femstruct.modal.damping import carry_damping, with_damping
from femstruct.modal.reduction import modal_basis
from femstruct.model.mesher import mesh_structure
from femstruct.model.model import Model
from femstruct.model.parts import Structure
from femstruct.model.probe import Probe
from femstruct.study.study import Case, Extent, StructureModel, Study
from femstruct.workflow.staging import Places, force_probes


@dataclass(frozen=True, eq=False)
class Solved:
    """A structure with its undamped basis; model is None for closed-form structures."""

    key: str
    model: Model | None
    places: Places
    basis: ModalBasis


def solve_all(cases: Sequence[Case]) -> dict[str, Solved]:
    """The undamped basis of every case, by case name; cases of one structure share one.

    Notes
    -----
    Shared bases hold residual vectors for the places that any of their cases pushes, so that cases differ by what
    happens to the structure and never by the basis it is described in.
    """
    groups: dict[str, list[Case]] = {}
    for case in cases:
        groups.setdefault(_key(case.study.structure, case.study.extent), []).append(case)
    solved: dict[str, Solved] = {}
    for key, members in groups.items():
        shared = solve(members[0].study.structure, members[0].study.extent, [case.study for case in members], key)
        solved |= {case.name: shared for case in members}
    return solved


def solve(structure: StructureModel, extent: Extent, studies: Sequence[Study] = (), key: str = "") -> Solved:
    """Mesh, assemble and solve one structure, with residual vectors for what the studies push."""
    if isinstance(structure, Structure):
        model = mesh_structure(structure)
        places = Places(model.points, model.surfaces)
        probes: dict[str, Probe] = {}
        for study in studies:
            probes |= force_probes(study, places)
        basis = modal_basis(
            assemble(model), up_to=extent.up_to_hz, count=extent.count, probes=[probes[name] for name in sorted(probes)]
        )
        return Solved(key, model, places, basis)
    basis, points = _closed_form(structure)
    return Solved(key, None, Places(points, {}), basis)


def damped(case: Case, solved: Mapping[str, Solved], baseline: Case) -> ModalBasis:
    """The basis of a case with its damping.

    Notes
    -----
    A case that changes the structure but not the damping keeps the baseline's ratios mode by mode, by shape (MAC);
    mode numbers would give them to other modes.
    """
    own, reference = solved[case.name], solved[baseline.name]
    changes_damping = any(path.split(".")[0] == "damping" for path in case.changes)
    if own.key == reference.key or changes_damping:
        return with_damping(own.basis, case.study.damping)
    return carry_damping(case.study.damping, with_damping(reference.basis, baseline.study.damping), own.basis)


def _key(structure: StructureModel, extent: Extent) -> str:
    """A short stable name for all that an undamped basis depends on."""
    return hashlib.sha256(repr((structure, extent)).encode()).hexdigest()[:12]
