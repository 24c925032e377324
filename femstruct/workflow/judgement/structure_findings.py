"""All there is to know of a structure before anything hits it, in two functions: without its modes, and with them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from femstruct.assembly.constraint_findings import constraint_findings
from femstruct.conventions import GRAVITY
from femstruct.errors import Finding
from femstruct.findings.catalogue import ranked
from femstruct.modal.basis import ModalBasis
from femstruct.modal.coupled_damping.damped_modes import damped_modes
from femstruct.model.imported.stated.unused import unused_findings
from femstruct.model.material import Material
from femstruct.model.model import Model
from femstruct.model.structure import Structure
from femstruct.parts.findings.arched import arched_findings
from femstruct.parts.findings.arrangement import arrangement_findings, overhang_findings
from femstruct.parts.findings.connections import pieces
from femstruct.parts.findings.eccentric import eccentric_findings
from femstruct.parts.findings.folded import folded_findings
from femstruct.parts.findings.joint_springs import (
    far_spring_findings,
    joint_open_findings,
    joint_spring_findings,
    shared_node_findings,
)
from femstruct.parts.findings.losses.layer_losses import layer_loss_findings
from femstruct.parts.findings.losses.total_losses import total_loss_findings
from femstruct.parts.findings.reduced_band import reduced_findings
from femstruct.parts.findings.theory import model_findings
from femstruct.parts.findings.twice import twice_findings
from femstruct.parts.findings.waves import mesh_findings
from femstruct.parts.findings.wide_ribs import wide_rib_findings
from femstruct.parts.plausibility import material_findings, plausibility_findings
from femstruct.study.structures import RodModel, StructureModel
from femstruct.study.study import Study
from femstruct.workflow.judgement.cavity_crossings import cavity_findings
from femstruct.workflow.judgement.unheld import unheld_findings
from femstruct.workflow.stages.hung import hanger_findings
from femstruct.workflow.stages.modal_bases import Solved
from femstruct.workflow.stages.rest import planned_contacts, weighs
from femstruct.workflow.stages.sags import falling

HIGH_DROP, FAST = 10.0, 50.0  # m and m/s: from here on air counts, or a unit was mistaken
OVERDAMPED = 0.25  # damping ratio of all modes: earth dams in strong earthquakes reach it
FAR = 0.1  # of the size of a structure: springs that sag by more have a slip of a unit, or are to stand for none


def structure_findings(
    solved: Solved, basis: ModalBasis, studies: Sequence[Study] = (), up_to_hz: float | None = None
) -> tuple[Finding, ...]:
    """All that can be said of a structure and its modes, by rank.

    basis : with its damping. up_to_hz : the highest frequency that is looked at [Hz]; without it the mesh is judged as
    far as the modes are complete.
    """
    return ranked(
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

    structure, model : what is described, and its mesh; None in closed form. studies : what happens to it, for what they
    join (contacts, links), for gravity, and for their bodies. up_to_hz : the highest frequency asked for [Hz]; without
    it meshes and plates joined at an angle are not judged, since that takes a frequency.

    Notes
    -----
    Materials, sections and thicknesses, theories that do not fit (thick plates, ribs beside plates, folded plates),
    arches, parts that nothing joins or holds up, that cannot move or are there twice, and drops no laboratory has; see
    `femstruct.parts.findings`.
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
        found += twice_findings(structure)
        found += arrangement_findings(model, _joined(model, studies), any(weighs(study) for study in studies))
        found += unheld_findings(model, _joined(model, studies), studies)
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
    return ranked(found)


def structure_findings_after(
    model: Model | None,
    basis: ModalBasis,
    studies: Sequence[Study] = (),
    up_to_hz: float | None = None,
) -> tuple[Finding, ...]:
    """What the modes of a structure show of it, by rank: their own findings, whether the mesh carries them, and whether
    parts slide or turn on each other.

    up_to_hz : the highest frequency that is looked at [Hz]; without it that to which the modes are complete.
    """
    found = list(basis.findings)
    if model is None:
        return ranked(found)
    top = up_to_hz or basis.complete_below_hz
    if not 0.0 < top < np.inf:
        top = float(basis.frequency_hz[basis.modes].max(initial=0.0))
    if top > 0.0:
        of_modes = _of_frequencies(model, top)
        ends = f". {top:.4g} Hz is where the modes that are looked at end"
        found += of_modes if up_to_hz else [replace(one, message=one.message.rstrip(".") + ends) for one in of_modes]
    found += _overdamped(basis)
    found += _mechanisms(model, basis, studies, any(weighs(study) for study in studies))
    return ranked(found)


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
    told = []
    for body in study.bodies:
        height = body.speed**2 / (2.0 * GRAVITY)
        if body.dropped and height > HIGH_DROP:
            told.append(
                Finding(
                    "high-drop",
                    f"{body.name} falls {height:.4g} m and arrives at {body.speed:.3g} m/s. Air drag is left out, "
                    "and contact "
                    f"laws are measured at a few m/s. Did you mean {height:.4g} mm?",
                    {"height_m": height, "speed_m_s": body.speed},
                )
            )
        elif not body.dropped and abs(body.speed) > FAST:
            told.append(
                Finding(
                    "fast-body",
                    f"{body.name} has {body.speed:.4g} m/s; contact laws are measured at a few m/s. Did you mean "
                    f"{body.speed:.4g} mm/s?",
                    {"speed_m_s": body.speed},
                )
            )
    return told


def _mechanisms(model: Model, basis: ModalBasis, studies: Sequence[Study], gravity: bool) -> list[Finding]:
    """Rigid modes beyond those of the pieces as wholes: parts that slide or turn on each other without resistance."""
    if not basis.n_rigid:
        return []
    extra = basis.n_rigid - sum(len(piece.free) for piece in pieces(model))
    if extra <= 0:
        return []
    told_before = any(piece.falls for piece in pieces(model, _joined(model, studies)))
    falls = gravity and falling(basis) and not told_before
    return [
        Finding(
            "mechanism",
            f"{extra} of the {basis.n_rigid} modes at 0 Hz are not rigid-body motions of the structure or of a piece: "
            "parts slide or turn on each other without resistance, as on a layer or spring without stiffness in that "
            "direction" + (". Gravity sets one of them in motion" if falls else ""),
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
