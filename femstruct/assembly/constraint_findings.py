"""What is doubtful of constraints: equations that others say already, and those that hold what no support holds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from scipy.sparse import csr_array, vstack
from scipy.sparse.linalg import lsqr

from femstruct.arrays import Floats
from femstruct.assembly.ties import RANK, eliminate, number_dofs
from femstruct.conventions import DIRECTIONS, N_COMPONENTS
from femstruct.errors import Finding
from femstruct.model.model import Model, point_rows

_INVOLVED: Final = 1e-6  # of the largest factor: an equation with less is not part of a combination
_EXACT: Final = 1e-13  # residual of the least-squares solver: equations are normalised, so this is rounding


def constraint_findings(model: Model) -> tuple[Finding, ...]:
    """Findings on the constraints of a model; those of its joints and supports alone are not judged.

    Notes
    -----
    Equations are homogeneous, so they never contradict each other: what looks like a contradiction holds something at
    zero. The equations that take part are named: those of a least-squares combination that makes the one in question.
    """
    named = {constraint.name: constraint for constraint in model.structure.constraints}
    if not named:
        return ()
    dofs = number_dofs(model)
    empty = csr_array((0, dofs.count))
    rows = {tie.name: _normalised(csr_array(tie.rows @ dofs.output)) for tie in model.ties}
    others = {name: one for name, one in rows.items() if name not in named}
    known = csr_array(vstack([empty, *others.values()]))
    rank, before = len(eliminate(known).kept), dict(others)
    found: list[Finding] = []
    for name in named:
        known = csr_array(vstack([known, rows[name]]))
        added = len(eliminate(known).kept) - rank
        spare = rows[name].shape[0] - added
        if spare:
            found.append(_repeated(name, spare, rows[name], before))
        rank += added
        before[name] = rows[name]
        found += _grounding(name, model)
    return (*found, *_holding(model, dofs.output, others, rows, known))


def _normalised(rows: csr_array) -> csr_array:
    """Rows of a largest coefficient of one; those without any stay so."""
    largest = abs(rows).max(axis=1).toarray().ravel()
    scale = np.divide(1.0, largest, out=np.zeros_like(largest), where=largest > 0.0)
    return csr_array(rows.multiply(scale[:, None]))


def _repeated(name: str, spare: int, own: csr_array, before: Mapping[str, csr_array]) -> Finding:
    count = own.shape[0]
    partners = [one for one in _combined(own, before) if one != name]
    reason = f"those of {' and '.join(partners)} say it" if partners else "its places move as one without it"
    return Finding(
        "constraint-repeated",
        f"constraints.{name}: {spare} of {count} equations say nothing new: {reason}. Motions are right; the force "
        f"of {name} is one of many that are possible. Remove what is said twice.",
        {"repeated": spare, "equations": count},
    )


def _grounding(name: str, model: Model) -> list[Finding]:
    """A remark where a rigid motion of all the structure violates a constraint."""
    (tie,) = (one for one in model.ties if one.name == name)
    points = model.mesh.points
    arms = points - points.mean(axis=0)
    size = float(np.linalg.norm(arms, axis=1).max()) or 1.0
    rigid = np.zeros((len(points), N_COMPONENTS, 6))
    rigid[:, :3, :3] = np.eye(3)
    rigid[:, 3:6, 3:] = np.eye(3) / size
    for axis in range(3):
        rigid[:, :3, 3 + axis] = np.cross(np.eye(3)[axis], arms) / size
    felt = np.abs(tie.rows @ rigid.reshape(-1, 6))
    terms = abs(tie.rows) @ np.abs(rigid.reshape(-1, 6))
    violated = [DIRECTIONS[i] for i in range(6) if (felt[:, i] > RANK * terms.max(initial=0.0)).any()]
    if not violated:
        return []
    return [
        Finding(
            "constraint-to-ground",
            f"constraints.{name}: a rigid motion of the whole structure ({', '.join(violated)}) violates it, so it "
            "holds the structure as a support does: what its forces do not balance among themselves, the ground takes.",
            {"directions": len(violated)},
        )
    ]


def _holding(
    model: Model, output: csr_array, others: Mapping[str, csr_array], rows: Mapping[str, csr_array], known: csr_array
) -> list[Finding]:
    """Directions of points that constraints hold at zero without a support."""
    supports = {support.name for support in model.structure.supports}
    free = eliminate(csr_array(vstack([csr_array((0, known.shape[1])), *others.values()]))).E
    left = eliminate(known).E
    found: dict[tuple[str, ...], list[str]] = {}
    names = dict.fromkeys(name for one in model.structure.constraints for name in one.holds())
    for point in (place for name in names for place in model.places(name)):
        motion = csr_array(point_rows(point, np.zeros(3), model) @ output)
        moved, still = (_lengths(csr_array(motion @ one)) for one in (free, left))
        for number in np.flatnonzero((still <= RANK * moved) & (moved > 0.0)):
            partners = tuple(_combined(csr_array(motion[[number]]), rows))
            if not supports & set(partners):
                found.setdefault(partners, []).append(f"{point.name}.{DIRECTIONS[number]}")
    return [
        Finding(
            "constraint-holds",
            f"constraints.{' and '.join(partners)} together hold {', '.join(held)} at zero, which no support does: "
            "their equations have no other solution. Check their factors, or write a support.",
            {"held": len(held)},
        )
        for partners, held in found.items()
    ]


def _lengths(rows: csr_array) -> Floats:
    lengths: Floats = np.sqrt(np.asarray(rows.multiply(rows).sum(axis=1)).ravel())
    return lengths


def _combined(own: csr_array, rows: Mapping[str, csr_array]) -> list[str]:
    """Names of the equations of which some of the rows are a combination."""
    found: dict[str, None] = {}
    if not rows:
        return []
    owners = np.repeat(np.arange(len(rows)), [one.shape[0] for one in rows.values()])
    every = csr_array(vstack(list(rows.values()))).T
    names: Sequence[str] = list(rows)
    for number in range(own.shape[0]):
        equation = own[[number]].toarray().ravel()
        size = float(np.linalg.norm(equation))
        if not size > 0.0:
            continue
        factors, _, _, residual, *_ = lsqr(every, equation / size, atol=_EXACT, btol=_EXACT)
        if residual <= RANK:
            found |= {names[i]: None for i in np.unique(owners[np.abs(factors) > _INVOLVED])}
    return list(found)
