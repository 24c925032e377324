"""From a structure to its modal basis, solved once for every distinct structure and set of pushed places."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

from femstruct.assembly.assemble import assemble
from femstruct.modal.analytic import beam, given_modes, oscillator, rod
from femstruct.modal.basis import ModalBasis
from femstruct.modal.damping import carry_damping, with_damping
from femstruct.modal.reduction import modal_basis
from femstruct.model.facts import refuse_unweighed
from femstruct.model.mesher import mesh_structure
from femstruct.model.model import Model
from femstruct.model.probe import Point, Probe
from femstruct.model.structure import Structure
from femstruct.sound.cavities import with_cavities
from femstruct.sound.placed_cavity import all_cavities
from femstruct.study.asked import Extent
from femstruct.study.machine import Sag
from femstruct.study.structures import BeamModel, ModesModel, NoStructure, OscillatorModel, RodModel, StructureModel
from femstruct.study.study import Case, Study
from femstruct.workflow.stages.fingerprint import fingerprint
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.rest import axis_of, weights_on
from femstruct.workflow.stages.sags import sags


@dataclass(frozen=True, eq=False)
class Solved:
    """A structure with its undamped basis; model is None for closed-form structures.

    pushed : names of the places that its residual vectors are for, and axes along which its base moves.
    under_weight : static sags of its parts, of the structure without air, which leaks at rest; solved for when asked.
    """

    key: str
    structure: StructureModel
    model: Model | None
    places: Places
    basis: ModalBasis
    pushed: frozenset[str] = frozenset()

    @cached_property
    def under_weight(self) -> tuple[Sag, ...]:
        return () if self.model is None else sags(self.model, self.basis)

    def under_all(self, study: Study | None) -> tuple[Sag, ...]:
        """The same with the weight of the bodies that hang or lie on the structure in a study."""
        weights = {} if study is None else weights_on(study)
        if self.model is None or not weights:
            return self.under_weight
        hung = [(self.places.point(name, "bodies").probe("z"), -weight) for name, weight in weights.items()]
        return sags(self.model, self.basis, hung)


@dataclass(frozen=True, eq=False)
class Meshed:
    """A structure without its modes; model is None for closed-form structures."""

    structure: StructureModel
    model: Model | None
    places: Places


def meshed(structure: StructureModel, studies: Sequence[Study] = ()) -> Meshed:
    """Mesh a structure, or find the points of a closed form."""
    if isinstance(structure, Structure):
        model = mesh_structure(structure)
        return Meshed(structure, model, Places(model.points, model.surfaces, model.parts))
    return Meshed(structure, None, Places(_closed_form(structure, _axis(studies))[1], {}))


def solve_all(cases: Sequence[Case], before: Iterable[Solved] = ()) -> dict[str, Solved]:
    """The undamped basis of every case, by case name; cases of one structure share one.

    before : bases of another run, taken where they are of the same structure, as many modes and the same places.

    Notes
    -----
    Shared bases hold residual vectors for the places that any of their cases pushes, so that cases differ by what
    happens to the structure and never by the basis it is described in.
    """
    groups: dict[str, list[Case]] = {}
    for case in cases:
        groups.setdefault(key_of(case.study), []).append(case)
    solved: dict[str, Solved] = {}
    for key, members in groups.items():
        studies = [study for case in members for study in case.studies]
        shared = next((one for one in before if one.key == key and one.pushed == _pushed(one.places, studies)), None)
        if shared is None:
            shared = solve(members[0].study.structure, members[0].study.extent, studies, key)
        solved |= {case.name: shared for case in members}
    return solved


def solve(structure: StructureModel, extent: Extent, studies: Sequence[Study] = (), key: str = "") -> Solved:
    """Mesh, assemble and solve one structure, with residual vectors for what the studies push."""
    if isinstance(structure, Structure):
        model = mesh_structure(structure)
        places = Places(model.points, model.surfaces, model.parts)
        probes: dict[str, Probe] = {}
        for study in studies:
            probes |= _force_probes(study, places)
        assembly = assemble(model)
        # A structure of a few rigid blocks has fewer modes than anyone asks for: then all there are.
        count = None if extent.count is None else min(extent.count, assembly.K.shape[0])
        base = _shaken(studies)
        refuse_unweighed(model, "".join(base), "a motion of the base")
        basis = modal_basis(
            assembly, up_to=extent.up_to_hz, count=count, probes=[probes[name] for name in sorted(probes)], base=base
        )
        return Solved(key, structure, model, places, basis, frozenset((*probes, *base)))
    basis, points = _closed_form(structure, _axis(studies))
    return Solved(key, structure, None, Places(points, {}), basis)


def _pushed(places: Places, studies: Sequence[Study]) -> frozenset[str]:
    """Names of all places of a meshed structure that studies push; of a closed form none has a residual vector."""
    if not places.surfaces and not isinstance(studies[0].structure, Structure):
        return frozenset()
    return frozenset((*(name for study in studies for name in _force_probes(study, places)), *_shaken(studies)))


def _shaken(studies: Sequence[Study]) -> list[str]:
    """Axes along which studies move the base."""
    return sorted({str(one.on) for study in studies for one in study.vibration if one.kind == "base"})


def _force_probes(study: Study, places: Places) -> dict[str, Probe]:
    from femstruct.workflow.stages.staging import force_probes  # modes alone need nothing of impacts

    return force_probes(study, places)


def damped(case: Case, solved: Mapping[str, Solved], baseline: Case) -> ModalBasis:
    """The basis of a case with its damping and the air of its cavities.

    Notes
    -----
    A case that changes the structure but not the damping keeps the baseline's ratios mode by mode, by shape (MAC);
    mode numbers would give them to other modes.
    """
    own, reference = solved[case.name], solved[baseline.name]
    if own.key == reference.key or changes_damping(case):
        return in_air(with_damping(own.basis, case.study.damping), own)
    return in_air(carry_damping(baseline.study.damping, reference.basis, own.basis), own)


def in_air(basis: ModalBasis, own: Solved) -> ModalBasis:
    """The basis of a structure with the air of its cavities. basis : in vacuo, with its damping if it has one."""
    cavities = own.structure.cavities if isinstance(own.structure, Structure) else ()
    return with_cavities(basis, all_cavities(cavities, own.places.surfaces)[0])


def shown_in_air(basis: ModalBasis, own: Solved) -> ModalBasis:
    """The same for tables and files of modes: what lies beyond the modes of the structure completes a response only."""
    joined = in_air(basis, own)
    if joined is basis:
        return basis
    top = float(basis.omega[basis.modes].max(initial=0.0))
    beyond = joined.omega > top
    kinds = ("residual" if high and kind == "elastic" else kind for high, kind in zip(beyond, joined.kind, strict=True))
    return replace(joined, kind=tuple(kinds))


def changes_damping(case: Case) -> bool:
    """Whether a case says itself how its structure is damped."""
    return any(path.split(".")[0] == "damping" for path in case.changes)


def _closed_form(
    structure: OscillatorModel | RodModel | BeamModel | ModesModel | NoStructure, axis: Literal["x", "z"]
) -> tuple[ModalBasis, Mapping[str, Point]]:
    match structure:
        case OscillatorModel(mass, frequency_hz, stiffness, points):
            return oscillator(mass, frequency_hz=frequency_hz, stiffness=stiffness, points=tuple(points), axis=axis)
        case RodModel(length, E, rho, area, modes, points):
            return rod(length, E, rho, area, modes, points)
        case BeamModel(length, ends, EI, mass_per_length, modes, points):
            return beam(length, EI, mass_per_length, ends, modes, points)
        case ModesModel(frequency_hz, ratio, shapes, at):
            return given_modes(frequency_hz, ratio, shapes, axis=axis, at=at)
        case NoStructure():
            return given_modes((), (), {})


def _axis(studies: Sequence[Study]) -> Literal["x", "z"]:
    """Oscillators and given modes have no direction of their own: they move along the axis their study uses."""
    return axis_of(studies[0]) if studies else "z"


def key_of(study: Study) -> str:
    """A short stable name for all that an undamped basis depends on."""
    return fingerprint((study.structure, study.extent, axis_of(study)))
