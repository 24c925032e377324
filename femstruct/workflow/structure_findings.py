"""All there is to know of a structure before anything hits it, in two functions: without its modes, and with them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.assembly.constraint_findings import constraint_findings
from femstruct.conventions import GRAVITY
from femstruct.errors import Finding, list_some
from femstruct.findings.catalogue import rank_findings
from femstruct.modal.basis import ModalBasis
from femstruct.modal.coupled_damping import damped_modes
from femstruct.modal.damping import UNDAMPED, FromMaterials
from femstruct.model.materials import Material, loss_at
from femstruct.model.model import Model
from femstruct.model.structure import AirBetween, Bays, Structure
from femstruct.model.unused import unused_findings
from femstruct.parts.arrangement_findings import arrangement_findings, duplicate_findings, overhang_findings
from femstruct.parts.joint_findings import (
    far_spring_findings,
    joint_open_findings,
    joint_spring_findings,
    pieces,
    shared_node_findings,
)
from femstruct.parts.loss_findings import layer_loss_findings, total_loss_findings
from femstruct.parts.plausibility import material_findings, plausibility_findings
from femstruct.parts.rib_findings import arched_findings, eccentric_findings, wide_rib_findings
from femstruct.parts.wave_findings import folded_findings, mesh_findings, model_findings, reduced_findings
from femstruct.sound.cavity_coupling import all_cavities, shared_rectangle
from femstruct.study.structures import RodModel, StructureModel
from femstruct.study.study import Study
from femstruct.workflow.bases import Solved, falls_freely, hanger_findings, planned_contacts, weighs

# ----------------------------------------------------------------------------------------------------------------------
# Findings on cavities that need no modes: how they lie, and what crosses them.
# ----------------------------------------------------------------------------------------------------------------------

DEEP: Final = 0.5  # of the depth that what crosses a cavity takes of it
WITHIN: Final = 0.02  # of the sides: what lies nearer to them closes the cavity there
_STRAIGHT: Final = 0.1  # of its length that a bar runs aside and still lies along an axis


def cavity_findings(model: Model) -> tuple[Finding, ...]:
    """Cavities whose depth or sides do not fit their surfaces, those that joists cross, and bays beside their joists.

    Raises InputError: as `all_cavities` does.
    """
    found = list(all_cavities(model.structure.cavities, model.surfaces)[1])
    for cavity in model.structure.cavities:
        bars, sides = _bars(model, cavity)
        found += _crossed(cavity, bars) if cavity.bays is None else _beside(cavity, cavity.bays, bars, sides)
    return tuple(found)


def _bars(model: Model, cavity: AirBetween) -> tuple[dict[str, Floats], Floats]:
    """Bars of every frame that runs through the air of a cavity along its surfaces {frame: ends [k, 2, 2] [m]}, along x
    and y of the first from the corner of the cavity, and the sides of the cavity [2] [m]."""
    first, second = pair = model.surfaces[cavity.first], model.surfaces[cavity.second]
    axes = np.vstack([first.along, first.normal])
    low, high = shared_rectangle(pair)
    margin = WITHIN * (high - low)
    apart = float((second.centre - first.centre) @ first.normal)
    found = {}
    for name, part in model.parts.items():
        if not len(part.lines):
            continue
        places: Floats = (model.mesh.points[part.lines] - first.outline[0]) @ axes.T  # [lines, 2, 3]
        middle, along = places.mean(axis=1), np.ptp(places, axis=1)
        inside = ((middle[:, :2] > low + margin) & (middle[:, :2] < high - margin)).all(axis=1)
        level = along[:, 2] < DEEP * np.linalg.norm(along, axis=1)
        between = (middle[:, 2] > -DEEP * apart) & (middle[:, 2] < apart * (1.0 + DEEP))
        crossing = inside & level & between
        if crossing.any():
            found[name] = places[crossing][:, :, :2] - low
    return found, high - low


def _crossed(cavity: AirBetween, bars: dict[str, Floats]) -> list[Finding]:
    """A finding on every frame in a cavity that is described as one."""
    found = []
    for name, ends in bars.items():
        across = ends.mean(axis=1)
        axis = int(np.ptp(across, axis=0).argmin()) if len(across) > 1 else 0
        found.append(
            Finding(
                "cavity-crossed",
                f"{name} runs through the cavity {cavity.name}, and air flows past it there as if it were not: if "
                "it closes the cavity, every bay is one of its own. Name them with 'bays'",
                {"lines": float(len(ends)), "first_place_m": float(across[:, axis].round(3).min())},
            )
        )
    return found


def _beside(cavity: AirBetween, bays: Bays, bars: dict[str, Floats], sides: Floats) -> list[Finding]:
    """A finding on bays that end where no bar lies, although there are bars in the cavity."""
    if not bars:
        return []
    axis = 0 if bays.across == "x" else 1
    ends = np.concatenate(list(bars.values()))
    aside, lengths = np.ptp(ends[:, :, axis], axis=1), np.linalg.norm(np.ptp(ends, axis=1), axis=1)
    closing = ends[aside <= _STRAIGHT * lengths].mean(axis=1)[:, axis]
    near = max(bays.width / 2.0, WITHIN * float(sides[axis]))
    empty = [at for at in bays.at if not (np.abs(closing - at) <= near).any()]
    if not empty:
        return []
    there = list_some([f"{at:.4g}" for at in np.unique(closing.round(3))]) if len(closing) else ""
    lie = f"bars that close it lie at {bays.across} = {there} m" if there else f"no bar closes it across {bays.across}"
    return [
        Finding(
            "bays-beside-joists",
            f"{cavity.name}: no bar of {list_some(bars)} lies where its bays end, at {bays.across} = "
            f"{list_some([f'{at:.4g}' for at in empty])} m from the corner of the cavity; {lie}. Is 'across' the other "
            "axis, or another corner meant?",
            {"bays": len(bays.at) + 1, "ends_beside": len(empty), "first_place_m": empty[0]},
        )
    ]


# ----------------------------------------------------------------------------------------------------------------------
# Structures whose modes ring on without end in what is simulated, because nothing damps them.
# ----------------------------------------------------------------------------------------------------------------------

PERIODS = 10.0  # of the lowest such mode in the window: with a ratio of 1 % its motion would have halved


def undamped_motion(studies: Sequence[Study], basis: ModalBasis) -> tuple[Finding, ...]:
    """A finding where modes without damping ring through the window of a simulation.

    Severe: all modes are so, and a room hears them with air that does not react on the structure. Not of closed forms
    and given modes, whose damping is part of what they are given as.

    Parameters
    ----------
    studies : Sequence[Study]
        Of one case; they differ by what is struck.
    basis : ModalBasis
        With its damping.
    """
    study = studies[0] if studies else None
    if study is None or study.time is None or not isinstance(study.structure, Structure):
        return ()
    elastic = np.array([kind == "elastic" for kind in basis.kind], dtype=bool)
    bare = elastic & (basis.damping_ratio < UNDAMPED)
    if not bare.any() or basis.frequency_hz[bare][0] * study.time.duration <= PERIODS:
        return ()
    count, first = int(bare.sum()), float(basis.frequency_hz[bare][0])
    whole = bool(count == elastic.sum())
    one_way = list_some([plan.name for plan in study.rooms if plan.coupling == "one-way"])
    which = "No mode has damping" if whole else f"{count} of {elastic.sum()} modes have no damping"
    return (
        Finding(
            "undamped",
            f"{which}: the first of them, at {first:.4g} Hz, vibrates through the whole window without decay. "
            + (f"Levels in {one_way} are too high by as much as its damping would lower them. " if one_way else "")
            + _advice(study, basis),
            {"modes": count, "first_hz": first, "damping_ratio": float(basis.damping_ratio[bare].max())},
            severe=whole and bool(one_way),
        ),
    )


def _advice(study: Study, basis: ModalBasis) -> str:
    if isinstance(study.damping.base, FromMaterials):
        air = isinstance(study.structure, Structure) and study.structure.cavities
        beside = ". Air of a cavity without wool has no losses of its own" if air else ""
        return f"Give a 'loss_factor' to the materials of the parts that move in them{beside}"
    unused = [part for part, loss in basis.loss_factors.items() if np.max(loss_at(loss, basis.frequency_hz)) > 0.0]
    if not unused:
        return "Give the model a 'damping', such as 'damping: {loss_factor: 2 %}'"
    return (
        f"Loss factors of materials (of {list_some(unused)}) are used only with 'damping: {{from: materials}}'. Give "
        "the model this or another 'damping'"
    )


# ----------------------------------------------------------------------------------------------------------------------
# Floors, ceilings and walls of rooms that nothing holds: they fly off as one, and rooms hear that.
# ----------------------------------------------------------------------------------------------------------------------


def unsupported_findings(model: Model, joined: Iterable[tuple[str, str]], studies: Sequence[Study]) -> list[Finding]:
    """A finding for every free piece whose surface moves the air of a closed room.

    Severe: the room is rated. Not under gravity, where `nothing-carries-weight` is said of it, and not of the half
    space, where free plates and machines are measured.

    Parameters
    ----------
    joined : Iterable[tuple[str, str]]
        Pairs of points that contacts and links of the studies hold together.
    studies : Sequence[Study]
        Of one case.
    """
    study = next((one for one in studies if one.time is not None and not one.time.gravity), None)
    rooms = [plan for plan in study.rooms if plan.room.open_air is None] if study is not None else []
    if not rooms:
        return []
    parts = {surface.name: surface.on for surface in model.structure.surfaces}
    found = []
    for piece in pieces(model, joined):
        by = {plan.name: plan for plan in rooms for _, name in plan.moved if parts.get(name) in piece.parts}
        if not by or not piece.falls:
            continue
        rated = any(plan.levels for plan in by.values())
        found.append(
            Finding(
                "nothing-holds-it",
                f"{list_some(piece.parts)}: no support, layer or spring holds its {piece.mass:.4g} kg, and it moves "
                f"the air of {list_some(by)}. A blow sets all of it in motion, for good. Add 'supports' to the model",
                {"mass_kg": piece.mass, "free_motions": len(piece.free)},
                severe=rated,
            )
        )
    return found


# ----------------------------------------------------------------------------------------------------------------------
# All there is to know of a structure before anything hits it, in two functions.
# ----------------------------------------------------------------------------------------------------------------------

HIGH_DROP, FAST = 10.0, 50.0  # m and m/s: from here on air counts, or a unit was mistaken
OVERDAMPED = 0.25  # damping ratio of all modes: earth dams in strong earthquakes reach it
FAR = 0.1  # of the size of a structure: springs that sag by more have a slip of a unit, or are to stand for none


def structure_findings(
    solved: Solved, basis: ModalBasis, studies: Sequence[Study] = (), up_to_hz: float | None = None
) -> tuple[Finding, ...]:
    """All that can be said of a structure and its modes, by rank.

    Parameters
    ----------
    basis : ModalBasis
        With its damping.
    up_to_hz : float | None
        The highest frequency that is looked at [Hz]; without it the mesh is judged as far as the modes are complete.
    """
    return rank_findings(
        (
            *structure_findings_before(solved.structure, solved.model, studies),
            *structure_findings_after(solved.model, basis, studies, up_to_hz),
            *_far_sags(solved),
        )
    )


def structure_findings_before(
    structure: StructureModel,
    model: Model | None,
    studies: Sequence[Study] = (),
    up_to_hz: float | None = None,
) -> tuple[Finding, ...]:
    """All that can be said of a structure without its modes, by rank.

    Parameters
    ----------
    structure, model : StructureModel, Model | None
        What is described, and its mesh; None in closed form.
    studies : Sequence[Study]
        What happens to it, for what they join (contacts, links), for gravity, and for their bodies.
    up_to_hz : float | None
        The highest frequency asked for [Hz]; without it meshes and plates joined at an angle are not judged, since that
        takes a frequency.

    Notes
    -----
    Materials, sections and thicknesses, theories that do not fit (thick plates, ribs beside plates, folded plates),
    arches, parts that nothing joins or holds up, that cannot move or are there twice, and drops no laboratory has; see
    `femstruct.parts`.
    """
    found: list[Finding] = []
    if isinstance(structure, RodModel):
        found += material_findings(Material("the rod", structure.E, 0.3, structure.rho))
    if isinstance(structure, Structure) and model is not None:
        found += plausibility_findings(structure.parts)
        used = {material for part in structure.parts for material in part.materials()}
        walls = dict.fromkeys(wall.material for support in structure.supports for wall in support.walls)
        found += [one for material in walls if material not in used for one in material_findings(material)]
        found += unused_findings(structure)
        found += model_findings(model)
        found += layer_loss_findings(model)
        rooms = [room for study in studies for room in study.rooms if room.coupling == "two-way"]
        found += total_loss_findings(model, {surface: room.name for room in rooms for _, surface in room.moved})
        found += overhang_findings(model)
        found += duplicate_findings(structure)
        found += arrangement_findings(model, _joined(model, studies), any(weighs(study) for study in studies))
        found += unsupported_findings(model, _joined(model, studies), studies)
        found += eccentric_findings(model)
        found += arched_findings(model)
        found += wide_rib_findings(model)
        found += joint_spring_findings(model)
        found += joint_open_findings(model)
        found += shared_node_findings(model)
        found += far_spring_findings(model)
        found += constraint_findings(model)
        found += cavity_findings(model)
        found += hanger_findings(model)
        if up_to_hz is not None:
            found += _of_frequencies(model, up_to_hz)
    for study in studies:
        found += _hasty(study)
    return rank_findings(found)


def structure_findings_after(
    model: Model | None,
    basis: ModalBasis,
    studies: Sequence[Study] = (),
    up_to_hz: float | None = None,
) -> tuple[Finding, ...]:
    """What the modes of a structure show of it, by rank: their own findings, whether the mesh carries them, and
    whether parts slide or turn on each other.

    Parameters
    ----------
    up_to_hz : float | None
        The highest frequency that is looked at [Hz]; without it that to which the modes are complete.
    """
    found = list(basis.findings)
    if model is None:
        return rank_findings(found)
    top = up_to_hz or basis.complete_below_hz
    if not 0.0 < top < np.inf:
        top = float(basis.frequency_hz[basis.modes].max(initial=0.0))
    if top > 0.0:
        of_modes = _of_frequencies(model, top)
        ends = f". {top:.4g} Hz is where the modes that are looked at end"
        found += of_modes if up_to_hz else [replace(one, message=one.message.rstrip(".") + ends) for one in of_modes]
    found += _overdamped(basis)
    found += _mechanisms(model, basis, studies, any(weighs(study) for study in studies))
    return rank_findings(found)


def _of_frequencies(model: Model, up_to_hz: float) -> tuple[Finding, ...]:
    return (
        *mesh_findings(model, up_to_hz),
        *folded_findings(model, up_to_hz),
        *reduced_findings(model, up_to_hz),
    )


def _joined(model: Model, studies: Sequence[Study]) -> set[tuple[str, str]]:
    """Pairs of points that contacts and links of studies hold together, directly or through bodies between them."""
    known = {point.name for point in model.structure.points} | set(model.points)
    pairs: set[tuple[str, str]] = set()
    for study in studies:
        between = [item.between for item in planned_contacts(study)] + [item.between for item in study.links]
        beside: dict[str, set[str]] = {}
        for a, b in between:
            beside.setdefault(a, set()).add(b)
            beside.setdefault(b, set()).add(a)
        for start in known & beside.keys():
            reached, ahead = {start}, [start]
            while ahead:
                new = {name for name in beside[ahead.pop()] if name != "ground"} - reached
                reached |= new
                ahead += [name for name in new if name not in known]  # a body hands on, a point is of a part
            pairs |= {(start, other) for other in reached & known if other > start}
    return pairs


def _hasty(study: Study) -> list[Finding]:
    """Bodies that fall from higher or come faster than most that is tested."""
    findings = []
    for body in study.bodies:
        height = body.speed**2 / (2.0 * GRAVITY)
        if body.dropped and height > HIGH_DROP:
            findings.append(
                Finding(
                    "high-drop",
                    f"{body.name} falls {height:.4g} m and arrives at {body.speed:.3g} m/s. Air drag is left out, "
                    "and contact "
                    f"laws are measured at a few m/s. Did you mean {height:.4g} mm?",
                    {"height_m": height, "speed_m_s": body.speed},
                )
            )
        elif not body.dropped and abs(body.speed) > FAST:
            findings.append(
                Finding(
                    "fast-body",
                    f"{body.name} has {body.speed:.4g} m/s; contact laws are measured at a few m/s. Did you mean "
                    f"{body.speed:.4g} mm/s?",
                    {"speed_m_s": body.speed},
                )
            )
    return findings


def _mechanisms(model: Model, basis: ModalBasis, studies: Sequence[Study], gravity: bool) -> list[Finding]:
    """Rigid modes beyond those of the pieces as wholes: parts that slide or turn on each other without resistance."""
    if not basis.n_rigid:
        return []
    extra = basis.n_rigid - sum(len(piece.free) for piece in pieces(model))
    if extra <= 0:
        return []
    told_before = any(piece.falls for piece in pieces(model, _joined(model, studies)))
    falls = gravity and falls_freely(basis) and not told_before
    return [
        Finding(
            "mechanism",
            f"{extra} of the {basis.n_rigid} modes at 0 Hz are not rigid-body motions of the structure or of a piece: "
            "parts slide or turn on each other without resistance, as on a layer or spring without stiffness in that "
            "direction, or grid lines nearly coincide, so that springs are below the rounding error"
            + (". Gravity sets one of them in motion" if falls else ""),
            {"mechanisms": extra, "rigid_modes": basis.n_rigid},
            severe=falls,
        )
    ]


def _overdamped(basis: ModalBasis) -> list[Finding]:
    """A remark on damping that no structure has as a whole, as 1 for 1 %."""
    ratios = basis.damping_ratio[basis.modes]
    least = float(np.nanmin(ratios, initial=np.inf)) if np.isfinite(ratios).any() else 0.0
    if least >= OVERDAMPED and (coupled := damped_modes(basis)) is not None:  # as wool does
        least = float(coupled.damping_ratio.min(initial=0.0))
    if not least >= OVERDAMPED:
        return []
    return [
        Finding(
            "implausible-damping",
            f"Every mode has a damping ratio of {100 * least:.3g} % or more, a loss factor of {200 * least:.3g} %; "
            f"whole structures have 0.1 to 20 %. Did you mean a loss factor of {2 * least:.3g} %?",
            {"damping_ratio": least},
        )
    ]


def _far_sags(solved: Solved) -> list[Finding]:
    """A finding where springs sag by more than is meant; without gravity, too: their stiffness is as wrong then."""
    under_weight, model = solved.under_weight, solved.model
    if not under_weight or model is None:
        return []
    size = float(np.ptp(model.mesh.points, axis=0).max())
    size = max([size, *(float(np.ptp(part.bounds, axis=0).max()) for part in model.parts.values() if part.rigid)])
    worst = max(under_weight, key=lambda sag: sag.sag)
    if worst.sag <= FAR * size:
        return []
    return [
        Finding(
            "sags-far",
            f"{worst.part} sags by {worst.sag:.4g} m under its weight; the size of the structure is "
            f"{size:.4g} m. "
            "Check the units of springs, layers and moduli, unless they are soft on purpose",
            {"sag_m": worst.sag, "size_m": size},
        )
    ]
