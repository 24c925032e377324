"""How blocks lean under their weight and move in the modes of a structure: what `check` reports of machines."""

from __future__ import annotations

from femstruct.arrays import Floats
from femstruct.conventions import DIRECTIONS
from femstruct.errors import Finding
from femstruct.modal.basis import ModalBasis
from femstruct.model.model import Model
from femstruct.study.machine import BlockMode, Sag

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
