"""From a structure to its modal basis: what rests on it, its places, modes solved once, its sag, its hangers."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, is_dataclass, replace
from functools import cached_property
from typing import Any, Final, Literal

import numpy as np
from scipy.sparse import csr_array

from acoustics.errors import AcousticsError
from femstruct.arrays import Floats
from femstruct.assembly.matrices import assemble
from femstruct.conventions import GRAVITY
from femstruct.errors import FemstructError, Finding, InputError, InputErrors, NotConverged, list_some
from femstruct.language.models import ModelFile, with_position
from femstruct.modal.basis import ModalBasis
from femstruct.modal.closed_form import beam, given_modes, oscillator, rod
from femstruct.modal.damping import carry_damping, with_damping
from femstruct.modal.reduction import modal_basis
from femstruct.modal.statics import sag_displacements
from femstruct.model.library import LibraryEntry
from femstruct.model.library_entries import library
from femstruct.model.mesher import mesh_structure
from femstruct.model.model import Model, refuse_unweighed
from femstruct.model.part import Meshed
from femstruct.model.probe import Point, Probe, StressPlaces, Surface
from femstruct.model.structure import Structure
from femstruct.parts.hangers import Hangers
from femstruct.parts.joint_findings import pieces
from femstruct.sound.cavity_coupling import all_cavities, with_cavities
from femstruct.study.acting import MeasuredSource, PlacedBody, PlannedContact, PlannedLink
from femstruct.study.asked import VOLUME_VELOCITY, Extent, Sag, Spot, Vibration
from femstruct.study.structures import BeamModel, ModesModel, NoStructure, OscillatorModel, RodModel, StructureModel
from femstruct.study.study import Case, Plan, Study
from femstruct.yaml.reader import Position, near_one

# ----------------------------------------------------------------------------------------------------------------------
# Whether two descriptions are the same to the last number: a short name for all that is in them.
# ----------------------------------------------------------------------------------------------------------------------


def fingerprint(value: Any) -> str:
    """A name that changes with any number, word or array in a frozen description: dataclasses, mappings, sequences.

    Raises TypeError for what has no value of its own, such as a function: it would be told from itself.

    >>> fingerprint([1.0, {"a": np.arange(3)}]) == fingerprint([1.0, {"a": np.arange(3)}])
    True
    >>> fingerprint(csr_array([[1.0, 0.0]])) == fingerprint(csr_array([[0.0, 1.0]]))
    False
    >>> fingerprint(np.zeros(5000)) == fingerprint(np.append(np.zeros(4999), 1e-9))
    False
    """
    digest = hashlib.sha256()
    _add(digest, value)
    return digest.hexdigest()[:12]


def _add(digest: Any, value: Any) -> None:
    digest.update(f"({type(value).__qualname__}".encode())
    if is_dataclass(value) and not isinstance(value, type):
        for one in fields(value):
            digest.update(f" {one.name}:".encode())
            _add(digest, getattr(value, one.name))
    elif isinstance(value, np.ndarray):
        digest.update(f" {value.dtype} {value.shape}".encode() + np.ascontiguousarray(value).tobytes())
    elif isinstance(value, csr_array):
        for array in (np.array(value.shape), value.indptr, value.indices, value.data):
            _add(digest, array)
    elif isinstance(value, Mapping):
        for key, one in value.items():
            digest.update(f" {key!r}:".encode())
            _add(digest, one)
    elif isinstance(value, list | tuple):
        for one in value:
            _add(digest, one)
    elif isinstance(value, set | frozenset):
        for text in sorted(map(repr, value)):
            digest.update(text.encode())
    elif value is None or isinstance(value, bool | int | float | complex | str | bytes | np.generic):
        digest.update(f" {value!r}".encode())
    else:
        raise TypeError(f"{type(value).__qualname__} has no fingerprint")
    digest.update(b")")


# ----------------------------------------------------------------------------------------------------------------------
# Errors that only show once a structure is built, reported with the line of the file they come from.
# ----------------------------------------------------------------------------------------------------------------------


@contextmanager
def with_positions(source: ModelFile | Plan) -> Iterator[None]:
    """Errors of the input raised inside begin with ``file:line:column:`` where their path is in a file.

    What did not converge is put where the thing that it names is described, else at the beginning of the file.
    """
    try:
        yield
    except NotConverged as error:
        error.position = error.position or _position(source, error)
        raise
    except InputErrors:
        raise
    except FemstructError as error:
        raise InputErrors((with_position(source, error),)) from error
    except AcousticsError as error:
        raise InputErrors((str(error),)) from error


def _position(source: ModelFile | Plan, error: NotConverged) -> str:
    """``file:line:column: `` of the first of the quoted names that a file describes, or of its beginning."""
    quoted = re.findall(r"'([^']+)'", f"{error.got} {error.where}")
    named = [name for one in quoted for name in (one, *one.split(" on "))]
    for name in named:
        for path, (file, line, column) in source.positions.items():
            if path.count(".") == 1 and path.endswith(f".{name}"):
                return f"{Position(file, line, column)}: "
    files = [at[0] for at in source.positions.values()]
    return f"{Position(files[0], 1, 1)}: " if files else ""


# ----------------------------------------------------------------------------------------------------------------------
# What a study says before it has a structure: its contacts, its axis, and what rests on what under gravity.
# ----------------------------------------------------------------------------------------------------------------------


def planned_contacts(study: Study) -> tuple[PlannedContact, ...]:
    """Named contacts of a study, and those its bodies bring along, named "BODY on TARGET"."""
    own = tuple(
        PlannedContact(f"{body.name} on {body.target}", (body.name, body.target), body.law)
        for body in study.bodies
        if body.law is not None
    )
    return (*study.contacts, *own)


def axis_of(study: Study) -> Literal["x", "z"]:
    """The axis all bodies of a study move along: x where they are placed before and after, z above and below.

    Without bodies it is the axis of what the study starts or pushes, z where that is both; where nothing is, of what
    frequency responses and vibrations drive.
    """
    if study.bodies:
        return "x" if any(body.side in ("before", "after") for body in study.bodies) else "z"
    pushed = excitation_axis(study)
    if pushed:
        return "x" if pushed == {"x"} else "z"
    spots = [request.drive for request in study.frf]
    spots += [one.on for one in study.vibration if isinstance(one.on, Spot)]
    shaken = any(one.on == "x" for one in study.vibration)
    return "x" if shaken or any(spot.what == "x" for spot in spots) else "z"


def excitation_axis(study: Study) -> set[str]:
    """Which of x and z a study starts or pushes its structure along. What starts as a whole along both, or has gravity,
    comes down on what it meets."""
    spots = [spot for spot, _ in study.initial.velocities]
    spots += [load.on for load in study.loads if isinstance(load.on, Spot)]
    found = {spot.what for spot in spots if spot.what in ("x", "z")}
    rigid = study.initial.rigid
    if rigid is not None and any(rigid.velocity):
        x, _, z = rigid.velocity
        falls = study.time is not None and study.time.gravity
        found |= {"x"} if x and not z and not falls else {"z"}
    return found | ({"z"} if study.walks else set[str]())


def refuse_mixed_axes(study: Study) -> None:
    """Raise InputError for bodies along two axes, or contacts and links whose axis nothing says."""
    along_x = [body.name for body in study.bodies if body.side in ("before", "after")]
    along_z = [body.name for body in study.bodies if body.side in ("above", "below")]
    if along_x and along_z:
        raise InputError(
            f"bodies.{along_z[0]}",
            got=f"above or below, while {along_x[0]} is before or after",
            expected="bodies that move along one axis",
        )
    joins = [f"contacts.{one.name}" for one in study.contacts] + [f"links.{one.name}" for one in study.links]
    if joins and not study.bodies and len(excitation_axis(study)) > 1:
        raise InputError(
            joins[0],
            got="starts and loads along x and along z",
            expected="one of them: without bodies it is the axis of contacts and links",
            do="remove those along the other, or add a body: above or below for z, before or after for x",
        )


@dataclass(frozen=True)
class StaticState:
    """Gravity on a body that links carry: its weight with all that lies on it [N], and how far it has sunk [m]."""

    body: str
    weight: float
    sag: float


def static_states(study: Study) -> tuple[StaticState, ...]:
    """Weights and static sags of the bodies that links carry; empty without gravity.

    Notes: the structure and the contacts under lying bodies are taken as rigid beside the links.
    """
    return _carried(study) if weighs(study) else ()


def weights_on(study: Study) -> dict[str, float]:
    """What bodies that hang on links or lie weigh at the points of the structure that hold them [N], with gravity in
    the study and without, as the structure's own weight; empty where they move along x."""
    if axis_of(study) != "z":
        return {}
    bodies, lying = {body.name for body in study.bodies}, resting_bodies(study)
    sags = {state.body: state.sag for state in _carried(study)}
    found: dict[str, float] = {}
    for body in lying.values():
        if body.target not in (*bodies, "ground"):
            found[body.target] = found.get(body.target, 0.0) + mass_on(body, lying) * GRAVITY
    for link in _holding(study):
        for end, other in (link.between, link.between[::-1]):
            if end not in (*bodies, "ground") and other in sags:
                found[end] = found.get(end, 0.0) + link.stiffness * sags[other]
    return found


def _carried(study: Study) -> tuple[StaticState, ...]:
    carried, lying = carried_bodies(study), resting_bodies(study)
    names = [body.name for body in study.bodies if body.name in carried]
    weight = np.array([mass_on(body, lying) for body in study.bodies if body.name in carried]) * GRAVITY
    stiffness = np.zeros((len(names), len(names)))
    for link in _holding(study):
        row = np.array([float(name == link.between[0]) - float(name == link.between[1]) for name in names])
        stiffness += link.stiffness * np.outer(row, row)
    sag = np.linalg.solve(stiffness, weight)
    return tuple(StaticState(*values) for values in zip(names, weight.tolist(), sag.tolist(), strict=True))


def carried_bodies(study: Study) -> set[str]:
    """Bodies that springs connect, from the start and maybe through other bodies, to something that is held."""
    bodies, carried = {body.name for body in study.bodies}, set[str]()
    links = _holding(study)
    while True:
        firm = [end for link in links for end in link.between if end not in bodies or end in carried]
        more = {end for link in links if set(link.between) & set(firm) for end in link.between if end in bodies}
        if more <= carried:
            return carried
        carried |= more


def _holding(study: Study) -> list[PlannedLink]:
    """Links that can carry a weight at the start: not dashpots alone, nor springs that act later."""
    return [link for link in study.links if link.stiffness > 0.0 and link.release_at == 0.0]


def resting_bodies(study: Study) -> dict[str, PlacedBody]:
    """Bodies that lie still on the structure, the ground, a carried body or each other, their contact closed."""
    closed = [set(contact.between) for contact in planned_contacts(study) if contact.gap == 0.0]
    bodies, carried = {body.name for body in study.bodies}, carried_bodies(study)
    candidates = [
        body
        for body in study.bodies
        if body.side == "above"
        and not (body.dropped or body.speed or body.name in carried)
        and {body.name, body.target} in closed
    ]
    lying: dict[str, PlacedBody] = {}
    for _ in candidates:  # each round lays another layer
        lying |= {b.name: b for b in candidates if b.target not in bodies or b.target in carried or b.target in lying}
    return lying


def supported_bodies(study: Study) -> set[str]:
    """Bodies whose weight something holds."""
    return carried_bodies(study) | resting_bodies(study).keys()


def mass_on(body: PlacedBody, lying: Mapping[str, PlacedBody]) -> float:
    """Mass of a body and of all that lies on it [kg]."""
    return body.mass + sum(mass_on(other, lying) for other in lying.values() if other.target == body.name)


def weighs(study: Study) -> bool:
    """Whether gravity acts along the axis of the bodies."""
    return study.time is not None and study.time.gravity and axis_of(study) == "z"


def weight_of_bodies(study: Study) -> float:
    """Weight of the bodies that are at rest at first [N]: hung on links or lying, all of it ends on the ground."""
    carried, lying = carried_bodies(study), resting_bodies(study)
    return sum(body.mass for body in study.bodies if body.name in carried or body.name in lying) * GRAVITY


def refuse_unsupported(study: Study) -> None:
    """Raise InputError when gravity acts on a body that neither rests nor falls."""
    if not weighs(study):
        return
    resting = supported_bodies(study)
    for body in study.bodies:
        if body.name not in resting and not body.dropped and body.speed == 0.0:
            under = next((one for one in study.bodies if one.name == body.target and one.name not in resting), None)
            closed = any(
                one.gap == 0.0 and {*one.between} == {body.name, body.target} for one in planned_contacts(study)
            )
            if under is not None and closed:
                raise InputError(
                    f"bodies.{body.name}",
                    got=f"a body at rest on '{under.name}', which falls at first",
                    expected="one that falls with it, or lies on something at rest",
                    do=f"give it the drop_height or speed of '{under.name}', or let that one lie: remove its drop",
                )
            raise InputError(
                f"bodies.{body.name}",
                got="a body without a spring or a closed contact that carries it",
                expected="a state of rest under gravity",
                do="give it a link or a contact without a gap, drop it (drop_height or speed), or write gravity: false",
            )


# ----------------------------------------------------------------------------------------------------------------------
# Where a structure can be driven and observed, by name.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Places:
    """Where a structure can be driven and observed: its named points and surfaces, and its parts, none of a closed
    form."""

    points: Mapping[str, Point]
    surfaces: Mapping[str, Surface]
    parts: Mapping[str, Meshed] = field(default_factory=dict)

    def stresses(self, name: str, asked_by: str) -> StressPlaces:
        """Where a part is stressed. Raises InputError for a name that is no part, or a part without stresses."""
        if name not in self.parts:
            raise InputError(asked_by, got=f"'{name}'", expected=f"a part: {list_some(self.parts) or 'there is none'}")
        return self.parts[name].stresses(1 + max(int(part.nodes.max()) for part in self.parts.values()))

    def point(self, name: str, asked_by: str) -> Point:
        """The single place of that name.

        Raises InputError when there is none, or when the name stands for several places.
        """
        if name in self.points:
            return self.points[name]
        several = [key for key in self.points if key.startswith(f"{name}.")]
        raise InputError(
            asked_by,
            got=f"'{name}'" + (f", which has {len(several)} places" if several else ""),
            expected=f"one of {list_some(several or sorted(self.points)) or 'no points: the structure has none'}",
            do="name one place" if several else near_one(name, self.points),
        )

    def pushed(self, one: Vibration) -> Probe | None:
        """Where an excitation acts; None for a base, with which all moves that stands on the ground.

        Raises InputError for a point or a surface that is not there.
        """
        if one.kind == "base":
            return None
        if isinstance(one.on, Spot):
            return self.point(one.on.name, f"vibration.{one.name}.at").probe(one.on.what)
        if one.on not in self.surfaces:
            expected = f"a surface: {list_some(self.surfaces) or 'there is none'}"
            raise InputError(f"vibration.{one.name}.on", got=f"'{one.on}'", expected=expected)
        return self.surfaces[one.on].pressure()

    def contacts(self, one: MeasuredSource) -> list[Probe]:
        """Where a measured source stands, contact by contact. Raises InputError for a point that is not there, and for
        a contact that is named twice."""
        where = f"sources.{one.name}.at"
        names = [(place, spot.what) for spot in one.at for place in self.of(spot.name, where)]
        twice = next((f"{place}.{what}" for i, (place, what) in enumerate(names) if (place, what) in names[:i]), "")
        if twice:
            raise InputError(where, got=f"'{twice}' twice", expected="each contact once", do="remove one of them")
        return [self.point(place, where).probe(what) for place, what in names]

    def of(self, name: str, asked_by: str) -> tuple[str, ...]:
        """The names of all places of a point, in their order.

        Raises InputError when there is no such point.
        """
        several = [place for place in self.points if place.startswith(f"{name}.")]
        return tuple(several) if several and name not in self.points else (self.point(name, asked_by).name,)


def other_excitations(study: Study, places: Places) -> dict[str, Probe]:
    """Where the air of two-way rooms, requests, measured sources and vibrations push a structure, by address."""
    found: dict[str, Probe] = {}
    for plan in study.rooms:
        if plan.coupling == "two-way":
            for number, (wall, name) in enumerate(plan.moved):
                if name in places.surfaces:
                    at = f" on {wall} by {name}" if number else ""
                    found[f"air of {plan.name}{at}"] = places.surfaces[name].pressure()
    for request in study.frf:
        # a source in a room pushes surfaces: what its response lacks at rest is what a force there would lack
        end, spot = (
            ("drive", request.drive) if request.drive.what != VOLUME_VELOCITY else ("response", request.response)
        )
        asked_by = f"frf.{request.name}.{end}" if request.name else f"--{end}"
        found[str(spot)] = places.point(spot.name, asked_by).probe(spot.what)
    for source in study.sources:
        found |= {f"source {source.name} {i}": probe for i, probe in enumerate(places.contacts(source), start=1)}
    excited = {f"vibration {one.name}": places.pushed(one) for one in study.vibration}
    return found | {address: probe for address, probe in excited.items() if probe is not None}


# ----------------------------------------------------------------------------------------------------------------------
# A structure at rest under its own weight: how far its parts sink, and whether it falls.
# ----------------------------------------------------------------------------------------------------------------------

CARRIED = 0.9  # of the mass upwards: with less in the modes a sum over them is no sag
_FALLS = 1e-6  # of the mass: what rigid modes may carry of it upwards and still be rounding


def sags(model: Model, basis: ModalBasis, point_loads: Sequence[tuple[Probe, float]] = ()) -> tuple[Sag, ...]:
    """Static sags of all parts but those that are only nodes of others, as attachments; none for a structure that
    nothing holds up, or whose weight matrices do not say.

    Parameters
    ----------
    basis : ModalBasis
        In vacuo; it tells what is free to move.
    point_loads : Sequence[tuple[Probe, float]]
        Forces [N] along probes of what hangs or lies on it.

    Notes
    -----
    One static solution (`sag_displacements`). A structure that is free to slide or turn has none: then the sum over the
    modes of the basis, each by what of the weight it carries, and nothing where they carry less than `CARRIED` of it.
    """
    if any("z" in part.unweighed for part in model.parts.values()):
        return ()
    moved = (
        _slid(basis, point_loads)
        if (basis.omega == 0.0).any()
        else sag_displacements(assemble(model), point_loads, held=True)
    )
    if moved is None:
        return ()
    found = []
    for name, part in model.parts.items():
        if not (part.mass or part.rigid or len(part.quads) or len(part.lines)):
            continue
        leaning = float(np.hypot(*moved[part.first, 3:5])) if part.rigid else None
        found.append(Sag(name, float(-part.moved(moved, GRAVITY)[:, 2].min()), leaning))
    return tuple(found)


def _slid(basis: ModalBasis, point_loads: Sequence[tuple[Probe, float]]) -> Floats | None:
    """Displacements [n_nodes, 7] under weight of a structure with modes at 0 Hz; None where it falls, or where the
    modes carry too little of the weight."""
    pulled, free = basis.momentum[2], basis.omega == 0.0
    if falls_freely(basis) or (pulled[~free] ** 2).sum() < CARRIED * basis.total_mass:
        return None
    push = -GRAVITY * pulled + sum(
        (force * probe.of(basis.shapes) for probe, force in point_loads), np.zeros(len(pulled))
    )
    return np.asarray(basis.shapes[:, :, ~free] @ (push[~free] / basis.omega[~free] ** 2))


def falls_freely(basis: ModalBasis) -> bool:
    """Whether a mode without frequency moves up and down: weight sets it in motion, and nothing holds it."""
    free = basis.omega == 0.0
    return bool((basis.momentum[2][free] ** 2).sum() > _FALLS * basis.total_mass)


# ----------------------------------------------------------------------------------------------------------------------
# From a structure to its modal basis, solved once for every distinct structure and set of pushed places.
# ----------------------------------------------------------------------------------------------------------------------


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
        point_loads = [(self.places.point(name, "bodies").probe("z"), -weight) for name, weight in weights.items()]
        return sags(self.model, self.basis, point_loads)


@dataclass(frozen=True, eq=False)
class MeshedStructure:
    """A structure without its modes; model is None for closed-form structures."""

    structure: StructureModel
    model: Model | None
    places: Places


def meshed(structure: StructureModel, studies: Sequence[Study] = ()) -> MeshedStructure:
    """Mesh a structure, or find the points of a closed form."""
    if isinstance(structure, Structure):
        model = mesh_structure(structure)
        return MeshedStructure(structure, model, Places(model.points, model.surfaces, model.parts))
    return MeshedStructure(structure, None, Places(_closed_form(structure, _axis(studies))[1], {}))


def solve_all(cases: Sequence[Case], before: Iterable[Solved] = ()) -> dict[str, Solved]:
    """The undamped basis of every case, by case name; cases of one structure share one.

    Parameters
    ----------
    before : Iterable[Solved]
        Bases of another run, taken where they are of the same structure, as many modes and the same places.

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
    from femstruct.workflow.staging import force_probes  # modes alone need nothing of impacts

    return force_probes(study, places)


def damp_basis(case: Case, solved: Mapping[str, Solved], baseline: Case) -> ModalBasis:
    """The basis of a case with its damping and the air of its cavities.

    Notes
    -----
    A case that changes the structure but not the damping keeps the baseline's ratios mode by mode, by shape (MAC);
    mode numbers would give them to other modes.
    """
    own, reference = solved[case.name], solved[baseline.name]
    if own.key == reference.key or changes_damping(case):
        return add_cavities(with_damping(own.basis, case.study.damping), own)
    return add_cavities(carry_damping(baseline.study.damping, reference.basis, own.basis), own)


def add_cavities(basis: ModalBasis, own: Solved) -> ModalBasis:
    """The basis of a structure with the air of its cavities.

    Parameters
    ----------
    basis : ModalBasis
        In vacuo, with its damping if it has one.
    """
    cavities = own.structure.cavities if isinstance(own.structure, Structure) else ()
    return with_cavities(basis, all_cavities(cavities, own.places.surfaces)[0])


def add_cavities_for_tables(basis: ModalBasis, own: Solved) -> ModalBasis:
    """The same for tables and files of modes: what lies beyond the modes of the structure completes a response only."""
    joined = add_cavities(basis, own)
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


# ----------------------------------------------------------------------------------------------------------------------
# How many hangers a ceiling has and what each of them carries in the mean: what `check` and findings tell of them.
# ----------------------------------------------------------------------------------------------------------------------

ALLOWED: Final = 1.0  # of the largest load that the maker of a hanger recommends
_WHOLE: Final = 1.0 - 1e-9  # of a shift that nothing resists


def hanger_loads(model: Model) -> dict[str, dict[str, Any]]:
    """Of all hangers one by one, by name: the ceiling, how many there are, and the mean load of each [N].

    mean_load_n : of all that hangs on the ceiling, shared by all hangers that it has; None where other parts or
    supports carry it, too. largest_load_n : what the library recommends at most; None where the hangers are not of it.
    """
    counts = {one.name: len(one.places) for one in model.elastics}
    singles = _singles(model)
    carried = {ceiling: _carried_by_hangers(model, ceiling) for ceiling in {part.to for part in singles}}
    found = {}
    for part in singles:
        together = sum(counts[other.name] for other in singles if other.to == part.to)
        entry, mass = _entry(part), carried[part.to]
        found[part.name] = {
            "ceiling": part.to,
            "count": counts[part.name],
            "mean_load_n": None if mass is None else mass * GRAVITY / together,
            "largest_load_n": None if entry is None else entry.number("load"),
        }
    return found


def hanger_findings(model: Model) -> tuple[Finding, ...]:
    """Hangers of the library whose mean load is more than their maker recommends."""
    entries, findings = {part.name: _entry(part) for part in _singles(model)}, []
    for name, one in hanger_loads(model).items():
        entry, load, most = entries[name], one["mean_load_n"], one["largest_load_n"]
        if entry is None or load is None or most is None or load <= ALLOWED * most:
            continue
        fact = entry.fact("load")
        assert fact is not None, "a number has its fact"
        count = one["count"]
        needed = int(np.ceil(count * load / (ALLOWED * most)))
        findings.append(
            Finding(
                "hangers-overloaded",
                f"{name}: each of the {count} hangers carries {load:.4g} N of {one['ceiling']} in the mean, and "
                f"{most:.4g} N are the most for {entry.name} ({fact.source.work}). At least {needed} of them, or "
                "stronger ones, are needed",
                {"mean_load_n": load, "largest_load_n": most, "hangers": count},
            )
        )
    return tuple(findings)


def _singles(model: Model) -> list[Hangers]:
    return [part for part in model.structure.parts if isinstance(part, Hangers) and part.per == "piece"]


def _entry(part: Hangers) -> LibraryEntry | None:
    return library().get(part.like.partition(": ")[0])  # the rest is its source


def _carried_by_hangers(model: Model, ceiling: str) -> float | None:
    """The mass of all that hangs on a ceiling [kg]; None where something else than its hangers resists its fall."""
    own = {part.name for part in _singles(model) if part.to == ceiling}
    loose = replace(model, elastics=tuple(one for one in model.elastics if one.name not in own))
    piece = next(one for one in pieces(loose) if ceiling in one.parts)
    alone = not any(part.on in piece.parts for part in _singles(model) if part.to == ceiling)
    return piece.mass if alone and np.linalg.norm(piece.free[:, 2]) >= _WHOLE else None
