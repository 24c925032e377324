"""A mesh of any format that is read, as an `ImportedMesh` in metres."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

from femstruct.decks.abaqus import read_abaqus
from femstruct.decks.gmsh import read_gmsh
from femstruct.decks.nastran import read_nastran
from femstruct.decks.unv import read_unv
from femstruct.decks.vtu import read_vtu
from femstruct.errors import FemstructError, InputError, InputErrors
from femstruct.files.text_tables import content
from femstruct.model.imported_mesh import Gathered, ImportedMesh, import_mesh

LARGEST: Final = 500_000_000  # bytes
_READERS: Final[Mapping[str, Callable[[Path, bytes], Gathered]]] = {
    ".msh": read_gmsh,
    ".inp": read_abaqus,
    ".bdf": read_nastran,
    ".dat": read_nastran,
    ".nas": read_nastran,
    ".unv": read_unv,
    ".uff": read_unv,
    ".vtu": read_vtu,
}


def read_mesh_file(path: str | Path, scale: float = 1.0, sources: dict[str, str] | None = None) -> ImportedMesh:
    """The mesh of a file: Gmsh (.msh 2.2 and 4.1), Abaqus and CalculiX (.inp), Nastran (.bdf, .dat, .nas), universal
    files (.unv, .uff), VTK (.vtu).

    Parameters
    ----------
    scale : float
        Metres in the file's unit of length, 0.001 of one in millimetres.
    sources : dict[str, str] | None
        Is given a digest of the file under its name, and of those that it includes.

    Raises
    ------
    InputError
        And InputErrors with the line where the format is text.

    Examples
    --------
    >>> from pathlib import Path
    >>> import tempfile
    >>> text = "*NODE\\n1, 0, 0, 0\\n2, 40, 0, 0\\n3, 0, 30, 0\\n*ELEMENT, TYPE=S3, ELSET=SKIN\\n7, 1, 2, 3\\n"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "skin.inp").write_text(text, encoding="utf-8")
    ...     mesh = read_mesh_file(Path(folder, "skin.inp"), scale=1e-3)
    >>> mesh.points[1].tolist(), mesh.set_names
    ([0.04, 0.0, 0.0], ('SKIN',))
    """
    path = Path(path)
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError("", got=f"'{path.name}'", expected=f"a mesh file: {', '.join(_READERS)}")
    data = content(path, LARGEST, "a mesh file, named from the model's folder")
    try:
        found = reader(path, data)
        mesh = import_mesh(path.name, found, scale)
    except InputErrors:
        raise
    except FemstructError as error:  # numbers that are none, too
        got = error.got if path.name in error.got else f"'{path.name}' with {error.got}"
        raise InputError("", got=got, expected=error.expected, do=error.do) from None
    if sources is not None:
        for other in found.included:
            digest = hashlib.sha256(content(other, LARGEST, "an included file")).hexdigest()
            sources[str(other)] = f"sha256 {digest}, included by {path.name}\n"
        cells = ", ".join(f"{len(some)} {kind}" for kind, some in mesh.cells.items()) or "no cells"
        digest = hashlib.sha256(data).hexdigest()
        sources[str(path)] = f"sha256 {digest}, {cells}, {len(mesh.points)} nodes, sets {', '.join(mesh.set_names)}\n"
    return mesh
