"""`femstruct reduce`: one part of a model as a file of reduced matrices."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from femstruct.errors import InputError
from femstruct.files.exchange.matrices_file import write_npz
from femstruct.language import read_model_file
from femstruct.modal.substructures.reduced_part import reduced_part
from femstruct.model.mesher import mesh_structure
from femstruct.model.structure import Structure
from femstruct.study.asked import Extent
from femstruct.workflow.progress import Progress
from femstruct.workflow.run.provenance import provenance
from femstruct.workflow.stages.positions import positioned

Table = dict[str, Any]


def reduce_model(
    path: Path, part: str, extent: Extent, output: Path, overrides: tuple[str, ...], command: str, tell: Progress
) -> Table:
    """Write one part of a model, reduced to what others touch of it; returns what was written.

    Raises InputError for a model in closed form and for a part that cannot be reduced.
    """
    if output.suffix != ".npz":
        raise InputError("--output", got=f"'{output}'", expected="a file NAME.npz")
    source = read_model_file(path, overrides)
    with positioned(source):
        if not isinstance(source.structure, Structure):
            raise InputError(str(path), got="a structure in closed form", expected="a model with parts")
        tell("reduction")
        model = mesh_structure(source.structure)
        found = reduced_part(model, part, up_to=extent.up_to_hz, count=extent.count)
    counts = {
        "interface nodes": len(found.interface),
        "interface degrees of freedom": len(found.reduced.boundary),
        "modes": found.reduced.n_modes,
        "residual vectors": len(found.reduced.frequency_hz) - found.reduced.n_modes,
        "degrees of freedom": found.assembly.K.shape[0],
        "degrees of freedom before": len(found.reduced.recovery),
    }
    about = {
        "title": f"{part} of {source.title}",
        "reduction": counts,
        "sets": {name: nodes.tolist() for name, nodes in found.sets.items()},
        "provenance": provenance(command),
    }
    more = {
        "interface": found.interface,
        "quads": found.quads,
        "lines": found.lines,
        "axes": found.axes,
        "girth": found.girth,
        "depth": found.depth,
        "beside": found.beside,
        "loss_factor": found.loss_factor,
        "share_names": np.array([one.name for one in found.shares], dtype=np.str_),
        "share_losses": np.array([one.loss_factor for one in found.shares], dtype=np.float64),
        "share_K": np.array([one.stiffness.toarray() for one in found.shares]),
        "reduced_to_hz": extent.up_to_hz or found.reduced.frequency_hz[: found.reduced.n_modes].max(initial=0.0),
    }
    output.parent.mkdir(parents=True, exist_ok=True)
    (written,) = write_npz(found.assembly, output.parent, output.stem, about, more)
    return {"written": str(written), **counts, "supports": list(found.supports), "sets": sorted(found.sets)}


def told_of(found: Table) -> tuple[str, ...]:
    """What was written, in lines for the terminal."""
    shown = ("written", "interface nodes", "interface degrees of freedom", "modes")
    lines = [f"{word}: {found[word]}" for word in shown]
    lines.append(
        f"residual vectors: {found['residual vectors']}; {found['degrees of freedom']} in place of "
        f"{found['degrees of freedom before']} degrees of freedom"
    )
    lines += [f"supports {one}: not in the file; hold set '{one}' again where it is used" for one in found["supports"]]
    return tuple(lines)
