"""What a file means, without hitting anything: its structure and its modes."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from femstruct.arrays import Floats
from femstruct.assembly.matrices import assemble
from femstruct.conventions import DIRECTIONS
from femstruct.errors import Finding, NotConverged
from femstruct.files.tables import finding_table, number
from femstruct.findings.catalogue import rank_findings
from femstruct.impact.resampled import last_mode_hz
from femstruct.language.cases import read_any
from femstruct.language.models import ModelFile
from femstruct.modal.basis import ModalBasis
from femstruct.modal.damping import Damping, FromMaterials, LossFactor, Ratio, Rayleigh
from femstruct.model.model import Model, ModelFacts, model_facts, simple_edges
from femstruct.parts.joint_findings import joined_over
from femstruct.study.asked import BlockMode, Extent, RoomPlan, Sag
from femstruct.study.placed_rooms import placed_room
from femstruct.study.structures import ModesModel, StructureModel
from femstruct.study.study import Case, Plan, Study
from femstruct.workflow.bases import (
    MeshedStructure,
    Places,
    Solved,
    StaticState,
    add_cavities_for_tables,
    hanger_loads,
    key_of,
    meshed,
    solve,
    static_states,
    with_positions,
)
from femstruct.workflow.impact_findings import coarse_sampling, room_findings
from femstruct.workflow.modes import DEFAULT_MODES, damp_computed_modes
from femstruct.workflow.provenance import Progress
from femstruct.workflow.recorded_channels import refuse_absent_forces
from femstruct.workflow.responses import excited, response_row
from femstruct.workflow.staging import build_scene, force_probes, spheres_before
from femstruct.workflow.study_findings import (
    all_findings,
    blanks_before,
    early_findings,
    merge_case_findings,
    study_findings,
)

# ----------------------------------------------------------------------------------------------------------------------
# How blocks lean under their weight and move in the modes of a structure: what `check` reports of machines.
# ----------------------------------------------------------------------------------------------------------------------

LEVEL = 1e-3  # rad; machines are set up level to 0.1 to 1 mm a metre
MOVES = 0.9  # of the kinetic energy: from here on a mode is one of the blocks
NAMED = 0.05  # of the kinetic energy: what is worth a name


def block_modes(model: Model, basis: ModalBasis) -> tuple[BlockMode, ...]:
    """The modes whose kinetic energy is that of blocks, and along what each of them moves."""
    energy: dict[str, Floats] = {}
    for name, part in model.parts.items():
        inertia = part.stiffness_and_mass()[1].diagonal() if part.rigid else ()
        shapes = basis.shapes[part.first, : len(inertia)]
        for direction, value, shape in zip(DIRECTIONS, inertia, shapes, strict=False):
            energy[f"{name} {direction}"] = value * shape**2  # of mass-normalised modes: shares of one
    found = []
    for mode in range(basis.modes.stop if energy else 0):
        shares = {name: float(values[mode]) for name, values in energy.items()}
        if sum(shares.values()) < MOVES:
            continue
        largest = sorted(shares.items(), key=lambda item: -item[1])
        directions = {name: share for name, share in largest if share >= NAMED}
        ratio = float(basis.damping_ratio[mode])
        found.append(BlockMode(mode + 1, float(basis.frequency_hz[mode]), ratio, directions))
    return tuple(found)


def weight_findings(sags: tuple[Sag, ...]) -> tuple[Finding, ...]:
    """Blocks that lean at rest: what carries them is not below their centre of mass."""
    return tuple(
        Finding(
            "leaning-block",
            f"{sag.part} leans by {1e3 * sag.tilt:.2g} mm/m under its weight; machines are levelled to "
            f"{1e3 * LEVEL:g} mm/m. "
            "Its centre of mass is not above the centre of its supports",
            {"tilt_rad": sag.tilt, "level_rad": LEVEL},
        )
        for sag in sags
        if sag.tilt is not None and sag.tilt > LEVEL
    )


# ----------------------------------------------------------------------------------------------------------------------
# What a file means, without hitting anything.
# ----------------------------------------------------------------------------------------------------------------------

Table = dict[str, Any]
FEWER: Final = (10, 3)  # modes of a model where as many as usual do not converge


@dataclass(frozen=True, eq=False)
class Inspection:
    """What `check` reports of a file. model and facts are None for closed-form structures; plan for a model file.

    drops : places that a source strikes, where it strikes several. positions : of points; None for one of given modes
    that does not say where it is.
    """

    title: str
    plan: Plan | None
    model: Model | None
    facts: ModelFacts | None
    degrees_of_freedom: int | None
    basis: ModalBasis
    positions: Mapping[str, tuple[float, float, float] | None]
    damping: tuple[str, ...]
    rests: tuple[StaticState, ...]
    sags: tuple[Sag, ...]
    block_modes: tuple[BlockMode, ...]
    rooms: tuple[RoomPlan, ...]
    drops: tuple[str, ...]
    findings: tuple[Finding, ...]

    def table(self) -> Table:
        """The same for JSON."""
        facts = self.facts
        return {
            "title": self.title,
            **({} if self.plan is None else _study_table(self.plan)),
            "masses_kg": {} if facts is None else facts.masses,
            "mass_kg": self.basis.total_mass,
            "box_m": None if facts is None else [facts.low.tolist(), facts.high.tolist()],
            "counts": {} if facts is None else facts.counts,
            "hangers": {} if self.model is None else hanger_loads(self.model),
            "joints": {} if self.model is None else _joint_tables(self.model),
            "simple_supports": {} if self.model is None else simple_edges(self.model),
            "degrees_of_freedom": self.degrees_of_freedom,
            "rigid_body_modes": self.basis.n_rigid,
            "first_frequencies_hz": [float(f) for f in self.basis.frequency_hz[self.basis.modes]],
            "points_m": {
                name: None if position is None else list(position) for name, position in self.positions.items()
            },
            "damping": list(self.damping),
            "rest": {state.body: {"weight_n": state.weight, "sag_m": state.sag} for state in self.rests},
            "sags": {sag.part: {"sag_m": sag.sag, "tilt_rad": sag.tilt} for sag in self.sags},
            "block_modes": [
                {
                    "mode": mode.number,
                    "frequency_hz": mode.frequency_hz,
                    "damping_ratio": number(mode.ratio),
                    "shares": mode.shares,
                }
                for mode in self.block_modes
            ],
            "rooms": {plan.name: _room_table(plan) for plan in self.rooms},
            "drops": list(self.drops),
            "findings": [finding_table(finding) for finding in self.findings],
        }


def _joint_tables(model: Model) -> Table:
    tables: Table = {}
    for name, one in joined_over(model).items():
        unit = one.unit.replace("^", "")
        sizes = {} if one.size is None else {f"joined_{unit}": one.size, f"touching_{unit}": one.of}
        tables[name] = {"between": [one.a, one.b], "nodes": one.nodes, **sizes}
    return tables


def inspect_file(path: Path, overrides: tuple[str, ...] = (), progress: Progress = lambda line: None) -> Inspection:
    """Read a model or a study, mesh it, and solve for its modes, the first 30 of a model; of a study, its baseline is
    inspected, and all its cases are judged as far as they can be without their own modes.

    Raises InputError as reading, meshing and staging do, so that what passes here can be run.
    """
    progress("reading")
    source = read_any(path, overrides)
    progress("modes")
    if isinstance(source, ModelFile):
        title, structure, damping, case = source.title, source.structure, source.damping, None
    else:
        case = next(case for case in source.cases if case.name == source.baseline)
        title, structure, damping = source.title, case.study.structure, case.study.damping
    study = None if case is None else case.study
    with with_positions(source):
        fewer: tuple[Finding, ...] = ()
        if case is None:
            solved, fewer = _first_modes(structure)
        else:
            solved = solve(structure, case.study.extent, case.studies)
        vacuo = damp_computed_modes(solved.basis, damping)
        basis = add_cavities_for_tables(vacuo, solved)
        progress("judgement")
        early = _early(source, case, solved, basis)
    model = solved.model
    sags = solved.under_all(study)
    return Inspection(
        title=title,
        plan=None if isinstance(source, ModelFile) else source,
        model=model,
        facts=None if model is None else model_facts(model),
        degrees_of_freedom=None if model is None else assemble(model).K.shape[0],
        basis=basis,
        positions=_positions(solved),
        damping=damping_sentences(damping, given=isinstance(structure, ModesModel)),
        rests=() if study is None else static_states(study),
        sags=sags,
        block_modes=() if model is None else block_modes(model, vacuo),
        rooms=() if study is None else study.rooms,
        drops=() if case is None else tuple(case.drops),
        findings=rank_findings((*fewer, *early, *weight_findings(sags), *_left_blank(source, basis))),
    )


def _first_modes(structure: StructureModel) -> tuple[Solved, tuple[Finding, ...]]:
    """The modes of a model that nobody has asked for a number of: fewer, with a finding, where as many are not found.

    Raises NotConverged, as of the first try, where not even the fewest are found.
    """
    try:
        return solve(structure, Extent(count=DEFAULT_MODES)), ()
    except NotConverged as error:
        for count in FEWER:
            with suppress(NotConverged):
                solved = solve(structure, Extent(count=count))
                message = (
                    f"{DEFAULT_MODES} modes did not converge: {error.got}, expected {error.expected}. The first "
                    f"{count} are described; further ones are not to be had"
                )
                values = {"wanted": float(DEFAULT_MODES), "described": float(count)}
                return solved, (Finding("fewer-modes-than-usual", message, values),)
        raise


def _left_blank(source: ModelFile | Plan, basis: ModalBasis) -> tuple[Finding, ...]:
    """Rated bands that the modes of a study's cases leave blank.

    Parameters
    ----------
    basis : ModalBasis
        Of its baseline.
    """
    if isinstance(source, ModelFile):
        return ()
    return tuple(room_findings(blanks_before(source.cases, {source.baseline: basis.complete_below_hz})))


def _positions(solved: Solved) -> dict[str, tuple[float, float, float] | None]:
    """Where the points are; given modes know it along their axis only, and of the points that say so."""
    structure, points = solved.structure, solved.places.points
    if isinstance(structure, ModesModel):
        return {name: (0.0, 0.0, structure.at[name]) if name in structure.at else None for name in points}
    return {name: tuple(point.position.tolist()) for name, point in points.items()}


def damping_sentences(damping: Damping, given: bool = False) -> tuple[str, ...]:
    """The damping of a file in both of its usual measures.

    Parameters
    ----------
    given : bool
        To modes that bring ratios of their own.

    Examples
    --------
    >>> damping_sentences(Damping(Ratio(0.02)))
    ('damping: ratio 2 % = loss factor 4 %',)
    """
    match damping.base:
        case Ratio(value):
            base = _ratio_and_loss_factor(value)
        case LossFactor(value):
            base = _ratio_and_loss_factor(value / 2.0)
        case Rayleigh(alpha, beta):
            base = f"Rayleigh, alpha {alpha:g} 1/s, beta {beta:g} s"
        case FromMaterials():
            base = "loss factors of the materials and foundations"
    exceptions = (
        f"mode {mode.number} near {mode.near_hz:g} Hz: "
        + _ratio_and_loss_factor(mode.ratio if mode.ratio is not None else (mode.loss_factor or 0.0) / 2.0)
        for mode in damping.modes
    )
    if given:
        none = damping.base == Ratio(0.0) and not damping.modes
        base = "the ratios given with the modes" if none else f"{base}, added to the ratios given with the modes"
    return (f"damping: {base}", *exceptions)


def _ratio_and_loss_factor(ratio: float) -> str:
    return f"ratio {100 * ratio:g} % = loss factor {200 * ratio:g} %"


def _early(source: ModelFile | Plan, baseline: Case | None, solved: Solved, basis: ModalBasis) -> tuple[Finding, ...]:
    """Findings of a model, or of all cases of a study: of the baseline's structure with its modes, of others without.

    Raises what running any of the cases would raise before anything is computed.
    """
    if isinstance(source, ModelFile) or baseline is None:
        return all_findings(solved, basis)
    others: dict[str, MeshedStructure] = {}
    by_case: dict[str, tuple[Finding, ...]] = {}
    for case in source.cases:
        key = key_of(case.study)
        if key == key_of(baseline.study):
            for study in case.studies:
                _try(study, solved, basis)
            found = all_findings(solved, basis, case.studies, case.study.frf)
            coarse = coarse_sampling(case.study, last_mode_hz(basis), len(basis.omega))
            by_case[case.name] = (*found, *study_findings(case, solved.places), *coarse)
            continue
        if key not in others:
            others[key] = meshed(case.study.structure, case.studies)
        own = others[key]
        for study in case.studies:
            _try_places(study, own.places)
        coarse = coarse_sampling(case.study, case.study.extent.up_to_hz or 0.0, case.study.extent.count or 0)
        by_case[case.name] = (*early_findings(case, own), *coarse)
    return merge_case_findings(by_case)


def _try(study: Study, solved: Solved, basis: ModalBasis) -> None:
    """Raise what running the study would raise before anything is computed."""
    build_scene(study, solved.places, basis)
    refuse_absent_forces(study, basis)
    for request in study.frf:
        if request.kind not in ("pressure", "power"):
            response_row(request.response, solved.places, basis, f"frf.{request.name}.response")
    for one in study.vibration:
        excited(one, solved.places, basis)
    _try_places(study, solved.places)


def _try_places(study: Study, places: Places) -> None:
    """The same as far as it takes no modes."""
    force_probes(study, places)
    for plan in study.rooms:
        placed_room(plan, places.surfaces)
        spheres_before(plan, study, places)


def _study_table(plan: Plan) -> Table:
    """What happens to the structure, in the baseline."""
    study = next(case.study for case in plan.cases if case.name == plan.baseline)
    time = study.time
    return {
        "cases": [case.name for case in plan.cases],
        "baseline": plan.baseline,
        "bodies": {
            body.name: {"mass_kg": body.mass, "side": body.side, "target": body.target, "speed_m_s": body.speed}
            for body in study.bodies
        },
        "time": None if time is None else {"duration_s": time.duration, "sampling_hz": time.sampling},
    }


def _room_table(plan: RoomPlan) -> Table:
    return {
        **plan.room.described(),
        **({"coupling": plan.coupling} if plan.room.pushes_back else {}),
        "receivers_m": {receiver.name: receiver.position.tolist() for receiver in plan.receivers},
        **({"directivity_hz": list(plan.directivity)} if plan.directivity else {}),
    }
