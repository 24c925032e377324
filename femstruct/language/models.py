"""Model files: one file, one structure and its damping; and what study files share with them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from femstruct.errors import FemstructError, InputErrors
from femstruct.language.model_file import ModelSpec
from femstruct.language.patch import MODEL_KEYS, Patch, check_names, study_keys
from femstruct.modal.damping import Damping
from femstruct.model.mesher import mesh_structure
from femstruct.model.model import Model
from femstruct.model.structure import Structure
from femstruct.study.structures import StructureModel
from femstruct.study.study import Plan
from femstruct.yaml.reader import Here, Mistakes, Position, Tree, dotted, near_name, parse_value, read_yaml
from femstruct.yaml.validation import validate


@dataclass(frozen=True)
class ModelFile:
    """A model file, read. sources : the YAML verbatim by file name. positions : (file, line, column) by path."""

    title: str
    structure: StructureModel
    damping: Damping
    sources: Mapping[str, str]
    positions: Mapping[str, tuple[str, int, int]] = field(default_factory=dict)


def read_model_file(path: str | Path, overrides: Sequence[str] = ()) -> ModelFile:
    """A model file as a structure in SI units and its damping.

    Parameters
    ----------
    overrides : Sequence[str]
        Texts ``PATH=VALUE`` that change the file before anything is read.

    Raises
    ------
    InputErrors
        Every mistake of the file, each on one line ``file:line:column: path: got, expected; do``.

    Examples
    --------
    >>> import tempfile
    >>> text = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\\npoints: {m: {}}"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "oscillator.yaml").write_text(text, encoding="utf-8")
    ...     model = read_model_file(Path(folder, "oscillator.yaml"), overrides=["structure.mass=500 g"])
    >>> model.title, model.structure.mass
    ('oscillator', 0.5)
    """
    mistakes, tree = Mistakes(), read_yaml(path)
    refuse_kind(tree, "model", MODEL_KEYS, study_keys)
    patch = Patch(None, tree, mistakes)
    override(patch, overrides)
    tree = patch.model.tree() if patch.model else tree
    check_names(tree, None, mistakes)
    sources = {tree.file: tree.text}
    spec = validate(ModelSpec, tree.value, tree, mistakes, sources)
    if spec is not None:
        spec.check(Here(tree, mistakes, spec.names()))
    mistakes.stop_if_any()
    structure, damping = built_model(spec, tree, mistakes, sources) if spec is not None else (None, None)
    mistakes.stop_if_any()
    assert structure is not None and damping is not None
    return ModelFile(title_of(tree), structure, damping, sources, positions_of(tree))


def read_model(path: str | Path, overrides: Sequence[str] = ()) -> Model:
    """A model file as a meshed structure, ready for `assemble`; its damping is in `read_model_file`.

    Parameters
    ----------
    overrides : Sequence[str]
        Texts ``PATH=VALUE`` that change the file before anything is read.

    Raises
    ------
    InputErrors
        As `read_model_file`, and for a structure in closed form, which has no mesh.

    Examples
    --------
    >>> from pathlib import Path
    >>> import tempfile
    >>> text = "materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}\\nparts: {sheet: {type: plate, material: steel, "
    >>> text += "thickness: 1 mm, origin: [0, 0, 0], size: [1, 1], mesh: [2, 2]}}"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "sheet.yaml").write_text(text, encoding="utf-8")
    ...     read_model(Path(folder, "sheet.yaml")).mesh.n_nodes
    9
    """
    file = read_model_file(path, overrides)
    if not isinstance(file.structure, Structure):
        raise InputErrors((f"{path}: structure: got a structure in closed form, expected parts to mesh",))
    try:
        return mesh_structure(file.structure)
    except FemstructError as error:
        raise InputErrors((with_position(file, error),)) from error


def with_position(source: ModelFile | Plan, error: FemstructError) -> str:
    """The error as ``file:line:column: path: got, expected; do`` where its path, or the start of it, is in a file."""
    where = error.where
    ends = [len(where)] + [i for i in range(len(where) - 1, 0, -1) if where[i] in ". [="]
    for end in ends:
        if where[:end] in source.positions:
            file, line, column = source.positions[where[:end]]
            return f"{Position(file, line, column)}: {error}"
    return str(error)


def built_model(
    spec: ModelSpec, tree: Tree, mistakes: Mistakes, sources: dict[str, str]
) -> tuple[StructureModel | None, Damping | None]:
    """Structure and damping of a checked model; None where a mistake was noted.

    Parameters
    ----------
    sources : dict[str, str]
        Is given the digests of the files that it names.
    """
    here = Here(tree, mistakes)
    return spec.build(title_of(tree), here, sources), here.at("damping").make(spec.damping.noun)


def override(patch: Patch, overrides: Sequence[str]) -> None:
    """Apply texts ``PATH=VALUE`` of the command line; mistakes are noted under ``--set``."""
    for text in overrides:
        path, equals, value = (part.strip() for part in text.partition("="))
        is_one, before = bool(equals and path and value), len(patch.mistakes.lines)
        there = Here(parse_value(value if is_one else "0", f"--set {text}", patch.mistakes), patch.mistakes)
        there.need(is_one, "no PATH=VALUE", "--set bodies.ball.mass='60 g'")
        if len(patch.mistakes.lines) == before:
            for one in patch.added_by_cases(path) or (path,):
                patch.assign(one, there.tree.value, there, of_cases=True)
            _refuse_if_set_again(patch, path, there)


def _refuse_if_set_again(patch: Patch, path: str, there: Here) -> None:
    """An override that every case undoes would do nothing."""
    cases = patch.study.value.get("cases") if patch.study else None
    if isinstance(cases, dict) and cases and all(isinstance(one, dict) and path in one for one in cases.values()):
        there.at(path).wrong(
            "a path that every case sets itself", "another path", f"set 'cases.{next(iter(cases))}.{path}' instead"
        )


def refuse_kind(tree: Tree, expected: str, own: frozenset[str], others: Callable[[], frozenset[str]]) -> bool:
    """True, or InputErrors: one sentence for the other kind of file, instead of one for each of its keys."""
    keys, mistakes = tree.value.keys(), Mistakes()
    if not keys or keys & own:
        return True
    other, here = others(), Here(tree, mistakes)
    if keys & other:
        found = "study" if expected == "model" else "model"
        here.at(next(key for key in tree.value if key in other)).wrong(
            f"a {found} file", f"a {expected} file", of_key=True
        )
    elif "title" not in keys and not any(near_name(key, own | other) for key in keys):
        here.wrong(
            "a file without a key of the language",
            f"a {expected} file",
            f"a {expected} has {', '.join(sorted(own)[:4])}, ...",
            of_key=True,
        )
    mistakes.stop_if_any()
    return True


def title_of(tree: Tree) -> str:
    """The title of a file, its name where it gives none."""
    title = tree.value.get("title")
    return title if isinstance(title, str) else Path(tree.file).name.partition(".")[0]


def positions_of(tree: Tree) -> dict[str, tuple[str, int, int]]:
    """File, line and column of every key of a file, by its path."""
    return {dotted(steps): (at.file, at.line, at.column) for steps, at in tree.keys.items()}
