"""A structure at rest under its own weight, and how its blocks move in its modes: what `check` reports of machines."""

from __future__ import annotations

import numpy as np

from femstruct.arrays import Floats
from femstruct.assembly.assemble import assemble
from femstruct.conventions import DIRECTIONS, GRAVITY
from femstruct.errors import Finding
from femstruct.modal.basis import ModalBasis
from femstruct.modal.statics import sunk
from femstruct.model.model import Model
from femstruct.study.machine import BlockMode, Sag

LEVEL = 1e-3  # rad; machines are set up level to 0.1 to 1 mm a metre
MOVES = 0.9  # of the kinetic energy: from here on a mode is one of the blocks
CARRIED = 0.9  # of the mass upwards: with less in the modes a sum over them is no sag
NAMED = 0.05  # of the kinetic energy: what is worth a name
_FALLS = 1e-6  # of the mass: what rigid modes may carry of it upwards and still be rounding


def sags(model: Model, basis: ModalBasis) -> tuple[Sag, ...]:
    """Static sags of all parts but those that are only nodes of others, as attachments; none for a structure that
    nothing holds up.

    basis : in vacuo; it tells what is free to move.

    Notes
    -----
    One static solution (`sunk`). A structure that is free to slide or turn has none: then the sum over the modes of the
    basis, each by what of the weight it carries, and nothing where they carry less than `CARRIED` of it.
    """
    moved = _slid(basis) if (basis.omega == 0.0).any() else sunk(assemble(model))
    if moved is None:
        return ()
    found = []
    for name, part in model.parts.items():
        if not (part.mass or part.rigid or len(part.quads) or len(part.lines)):
            continue
        leaning = float(np.hypot(*moved[part.first, 3:5])) if part.rigid else None
        found.append(Sag(name, float(-moved[part.nodes, 2].min()), leaning))
    return tuple(found)


def _slid(basis: ModalBasis) -> Floats | None:
    """Displacements [n_nodes, 7] under weight of a structure with modes at 0 Hz; None where it falls, or where the
    modes carry too little of the weight."""
    pulled, free = basis.momentum[2], basis.omega == 0.0
    if falling(basis) or (pulled[~free] ** 2).sum() < CARRIED * basis.total_mass:
        return None
    return np.asarray(basis.shapes[:, :, ~free] @ (-GRAVITY * pulled[~free] / basis.omega[~free] ** 2))


def falling(basis: ModalBasis) -> bool:
    """Whether a mode without frequency moves up and down: weight sets it in motion, and nothing holds it."""
    free = basis.omega == 0.0
    return bool((basis.momentum[2][free] ** 2).sum() > _FALLS * basis.total_mass)


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
        told = {name: share for name, share in largest if share >= NAMED}
        ratio = float(basis.damping_ratio[mode])
        found.append(BlockMode(mode + 1, float(basis.frequency_hz[mode]), ratio, told))
    return tuple(found)


def weight_findings(rest: tuple[Sag, ...]) -> tuple[Finding, ...]:
    """Blocks that lean at rest: what carries them is not below their centre of mass."""
    return tuple(
        Finding(
            "leaning-block",
            f"{sag.part} leans by {1e3 * sag.tilt:.2g} mm/m under its weight; machines are levelled to "
            f"{1e3 * LEVEL:g} mm/m. "
            "Its centre of mass is not above the centre of its supports",
            {"tilt_rad": sag.tilt, "level_rad": LEVEL},
        )
        for sag in rest
        if sag.tilt is not None and sag.tilt > LEVEL
    )
