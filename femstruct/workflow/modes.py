"""The modes of a model, as the command line asks for them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from femstruct.assembly.matrices import assemble
from femstruct.errors import InputError
from femstruct.files.tables import finding_table, number
from femstruct.language.models import read_model_file
from femstruct.modal.basis import ModalBasis
from femstruct.modal.complex_modes import complex_modes, elastic_modes
from femstruct.modal.coupled_damping import damped_modes
from femstruct.modal.damping import Damping, with_damping
from femstruct.model.mesher import mesh_structure
from femstruct.model.structure import Structure
from femstruct.sparse import FASTEST
from femstruct.study.asked import Extent
from femstruct.units import quantity
from femstruct.workflow.bases import Solved, add_cavities_for_tables, solve, with_positions
from femstruct.workflow.structure_findings import structure_findings

DEFAULT_MODES = 30
Table = dict[str, Any]


def extent_of(count: int | None, up_to: str) -> Extent:
    """How many modes the command line asks for.

    Raises InputError when both a count and a frequency are given, or the frequency is none.
    """
    if count is not None and up_to:
        raise InputError("--count and --up-to", got="both", expected="one of them")
    if up_to:
        return Extent(up_to_hz=frequency_option(up_to, "--up-to"))
    return Extent(count=count or DEFAULT_MODES)


def frequency_option(text: str, option: str) -> float:
    """A frequency given on the command line [Hz].

    Raises InputError that begins with the option's name.
    """
    try:
        return quantity(text, "frequency")
    except InputError as error:
        raise InputError(option, got=error.got, expected=error.expected, do=error.do) from error


def modes_of(path: Path, extent: Extent, overrides: tuple[str, ...] = ()) -> Table:
    """Table of modes of a model file: frequencies, damping ratios, kinds, effective masses, findings."""
    source = read_model_file(path, overrides)
    with with_positions(source):
        solved = solve(source.structure, extent)
        basis = add_cavities_for_tables(damp_computed_modes(solved.basis, source.damping), solved)
    return {
        "title": source.title,
        **_listed(source.structure, basis),
        "rigid_body_modes": basis.n_rigid,
        "complete_below_hz": number(basis.complete_below_hz),
        "solver": FASTEST,
        "rigid_in_plane": _rigid_in_plane(solved),
        "mass_kg": basis.total_mass,
        "findings": [finding_table(finding) for finding in structure_findings(solved, basis)],
    }


def _listed(structure: object, basis: ModalBasis) -> Table:
    """Frequencies, damping ratios, kinds and effective masses; of structures over wool those of the damped modes."""
    wool = isinstance(structure, Structure) and any(one.fill is not None for one in structure.cavities)
    if (damped := damped_modes(basis) if wool else None) is not None:
        still = np.arange(basis.n_rigid)
        masses = np.hstack([basis.modal_mass[:, still], damped.modal_mass])
        return {
            "frequency_hz": [0.0] * basis.n_rigid + damped.frequency_hz.tolist(),
            "damping_ratio": [None] * basis.n_rigid + damped.damping_ratio.tolist(),
            "kind": ["rigid"] * basis.n_rigid + ["damped"] * len(damped.frequency_hz),
            "modal_mass_kg": {axis: masses[i].tolist() for i, axis in enumerate("xyz")},
        }
    true = basis.modes
    return {
        "frequency_hz": basis.frequency_hz[true].tolist(),
        "damping_ratio": [number(ratio) for ratio in basis.damping_ratio[true]],
        "kind": list(basis.kind[true]),
        "modal_mass_kg": {axis: basis.modal_mass[i, true].tolist() for i, axis in enumerate("xyz")},
    }


def complex_modes_of(path: Path, extent: Extent, overrides: tuple[str, ...] = ()) -> Table:
    """Table of complex modes of a model file: frequencies, damping ratios, how far places move in step.

    Raises InputError for a structure in closed form, and for damping that belongs to real modes.
    """
    if extent.up_to_hz is None:
        raise InputError("--complex", got="no --up-to", expected="--up-to F", do="say up to which frequency")
    source = read_model_file(path, overrides)
    with with_positions(source):
        if not isinstance(source.structure, Structure):
            raise InputError("--complex", got="a structure in closed form", expected="a model with parts")
        if source.structure.cavities:
            do = "leave out --complex, or remove the cavities"
            raise InputError("--complex", got="a model with cavities", expected="a structure without air", do=do)
        real = solve(source.structure, extent).basis
        found = complex_modes(assemble(mesh_structure(source.structure)), source.damping, extent.up_to_hz)
    rigid = [i for i, kind in enumerate(real.kind) if kind == "rigid"]
    found = elastic_modes(found, real.shapes[:, :, rigid])
    still: list[float] = [0.0] * len(rigid)
    unknown: list[float | None] = [None] * len(rigid)
    return {
        "title": source.title,
        "frequency_hz": still + found.frequency_hz.tolist(),
        "damped_hz": still + found.damped_hz.tolist(),
        "damping_ratio": unknown + found.damping_ratio.tolist(),
        "collinearity": unknown + found.collinearity.tolist(),
        "residual": unknown + found.residual.tolist(),
        "kind": ["rigid"] * len(rigid) + ["elastic"] * len(found.eigenvalues),
        "real_modes": real.modes.stop,
        "rigid_body_modes": real.n_rigid,
        "up_to_hz": extent.up_to_hz,
    }


def damp_computed_modes(basis: ModalBasis, damping: Damping) -> ModalBasis:
    """Damping of the modes there are; ratios of modes beyond the ones asked for have nothing to act on yet."""
    known = len(basis.kind[basis.modes])
    return with_damping(basis, Damping(damping.base, tuple(mode for mode in damping.modes if mode.number <= known)))


def _rigid_in_plane(solved: Solved) -> list[str]:
    parts = {} if solved.model is None else solved.model.parts
    return [name for name, part in parts.items() if part.rigid_in_plane]
