"""Modes of a model in files of other programs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from femstruct.files.atomic import short
from femstruct.files.exchange.uff_sets import pyuff
from femstruct.files.exchange.uff_writing import write_uff
from femstruct.files.exchange.vtu_modes import write_vtu
from femstruct.files.results_file.vtkhdf import bare
from femstruct.language import ModelFile
from femstruct.modal.basis import ModalBasis
from femstruct.modal.measured.measurement import MeasuredModes, Measurement
from femstruct.model.model import Model
from femstruct.model.refine import Refined, refined
from femstruct.study.asked import Extent
from femstruct.workflow.check.asked_modes import damped_as_far_as_solved
from femstruct.workflow.progress import Progress
from femstruct.workflow.stages.modal_bases import shown_in_air, solve
from femstruct.workflow.stages.positions import positioned


def write_modes(
    source: ModelFile, to: str, folder: Path, name: str, extent: Extent, tell: Progress, sets: Sequence[int] = ()
) -> list[Path]:
    """Write the modes of a model to NAME.uff or NAME.vtu; returns the file. sets : as of `write_uff`."""
    if to == "uff":
        pyuff()  # told before the work
    with positioned(source):
        tell("modes")
        solved = solve(source.structure, extent)
        basis = shown_in_air(damped_as_far_as_solved(solved.basis, source.damping), solved)
    return write_basis(basis, solved.model, source.title, to, folder, name, sets)


def write_basis(
    basis: ModalBasis,
    model: Model | None,
    title: str,
    to: str,
    folder: Path,
    name: str,
    sets: Sequence[int] = (),
) -> list[Path]:
    """Write the modes of a basis to NAME.uff or NAME.vtu; returns the file. model : None of a closed form. sets : as of
    `write_uff`."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{short(name)}.{to}"
    if to == "vtu":
        return [write_vtu(basis, model, path, basis.modes.stop)]
    return [write_uff(modes_as_measured(title, basis, model), path, sets)]


def modes_as_measured(title: str, basis: ModalBasis, model: Model | None) -> Measurement:
    """The modes of a basis as if every node had been measured, mass-normalised, cells between the nodes."""
    shown = bare(basis) if model is None else refined(model, 1)
    points, quads, lines, first = _once(shown)
    k = basis.modes
    modes = MeasuredModes(
        basis.frequency_hz[k],
        np.nan_to_num(basis.damping_ratio[k]),
        shown.displacement(basis.shapes[:, :, k])[first],
        points,
        np.ones(points.shape, dtype=bool),
    )
    return Measurement(title, np.arange(1, len(points) + 1), points, lines, quads, modes)


def _once(shown: Refined) -> tuple[Any, Any, Any, Any]:
    """Points, cells and first places without what is drawn twice: nodes of one part that several cells share.

    Nodes of two parts at one place stay two: they may move apart.
    """
    keys = np.column_stack([shown.points, shown.part_of_point])
    _, first, back = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    back = back.ravel()
    order = np.argsort(first)
    new = np.empty_like(order)
    new[order] = np.arange(len(order))
    return shown.points[first[order]], new[back[shown.quads]], new[back[shown.lines]], first[order]
