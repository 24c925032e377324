"""A structure at rest under its own weight: how far its parts sink, and whether it falls."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from femstruct.arrays import Floats
from femstruct.assembly.assemble import assemble
from femstruct.conventions import GRAVITY
from femstruct.modal.basis import ModalBasis
from femstruct.modal.statics import sunk
from femstruct.model.model import Model
from femstruct.model.probe import Probe
from femstruct.study.machine import Sag

CARRIED = 0.9  # of the mass upwards: with less in the modes a sum over them is no sag
_FALLS = 1e-6  # of the mass: what rigid modes may carry of it upwards and still be rounding


def sags(model: Model, basis: ModalBasis, hung: Sequence[tuple[Probe, float]] = ()) -> tuple[Sag, ...]:
    """Static sags of all parts but those that are only nodes of others, as attachments; none for a structure that
    nothing holds up, or whose weight matrices do not say.

    basis : in vacuo; it tells what is free to move. hung : forces [N] along probes of what hangs or lies on it.

    Notes
    -----
    One static solution (`sunk`). A structure that is free to slide or turn has none: then the sum over the modes of the
    basis, each by what of the weight it carries, and nothing where they carry less than `CARRIED` of it.
    """
    if any("z" in part.unweighed for part in model.parts.values()):
        return ()
    moved = _slid(basis, hung) if (basis.omega == 0.0).any() else sunk(assemble(model), hung, held=True)
    if moved is None:
        return ()
    found = []
    for name, part in model.parts.items():
        if not (part.mass or part.rigid or len(part.quads) or len(part.lines)):
            continue
        leaning = float(np.hypot(*moved[part.first, 3:5])) if part.rigid else None
        found.append(Sag(name, float(-part.moved(moved, GRAVITY)[:, 2].min()), leaning))
    return tuple(found)


def _slid(basis: ModalBasis, hung: Sequence[tuple[Probe, float]]) -> Floats | None:
    """Displacements [n_nodes, 7] under weight of a structure with modes at 0 Hz; None where it falls, or where the
    modes carry too little of the weight."""
    pulled, free = basis.momentum[2], basis.omega == 0.0
    if falling(basis) or (pulled[~free] ** 2).sum() < CARRIED * basis.total_mass:
        return None
    push = -GRAVITY * pulled + sum((force * probe.of(basis.shapes) for probe, force in hung), np.zeros(len(pulled)))
    return np.asarray(basis.shapes[:, :, ~free] @ (push[~free] / basis.omega[~free] ** 2))


def falling(basis: ModalBasis) -> bool:
    """Whether a mode without frequency moves up and down: weight sets it in motion, and nothing holds it."""
    free = basis.omega == 0.0
    return bool((basis.momentum[2][free] ** 2).sum() > _FALLS * basis.total_mass)
