"""The files as nouns: a model, a study with its cases, what an override changes, and where everything stands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel

from femstruct.errors import FemstructError, InputErrors
from femstruct.language.build_model import damping_of, structure_of
from femstruct.language.build_study import study_of
from femstruct.language.patch import MODEL_KEYS, STUDY_KEYS, Patch
from femstruct.language.reader import Mistakes, Position, Tree, dotted, nearest, parse_value, read_yaml
from femstruct.language.references import check_names
from femstruct.language.references_model import check_model
from femstruct.language.references_study import check_study
from femstruct.language.schema_model import ModelSpec
from femstruct.language.schema_study import StudySpec
from femstruct.language.validation import validate
from femstruct.modal.damping import Damping
from femstruct.model.mesher import mesh_structure
from femstruct.model.model import Model
from femstruct.model.parts import Structure
from femstruct.study.study import Case, Plan, StructureModel
from femstruct.units import shown_as

AS_GIVEN = "as given"


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

    overrides : texts ``PATH=VALUE`` that change the file before anything is read.

    Raises InputErrors: every mistake of the file, each on one line ``file:line:column: path: got, expected; do``.

    >>> import tempfile
    >>> text = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\\npoints: {m: {}}"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "oscillator.yaml").write_text(text, encoding="utf-8")
    ...     model = read_model_file(Path(folder, "oscillator.yaml"), overrides=["structure.mass=500 g"])
    >>> model.title, model.structure.mass
    ('oscillator', 0.5)
    """
    tree = read_yaml(path)
    _refuse_kind(tree, "model", MODEL_KEYS, STUDY_KEYS)
    mistakes = Mistakes()
    patch = Patch(None, tree, mistakes)
    _override(patch, overrides)
    tree = patch.model.tree() if patch.model else tree
    check_names(tree, None, mistakes)
    spec = validate(ModelSpec, tree.value, tree, mistakes)
    if spec is not None:
        check_model(spec, tree, mistakes)
    mistakes.stop_if_any()
    structure, damping = _built_model(spec, tree, mistakes) if spec is not None else (None, None)
    mistakes.stop_if_any()
    if structure is None or damping is None:
        raise InputErrors((f"{path}: cannot be read",))
    return ModelFile(_title(tree), structure, damping, {tree.file: tree.text}, _positions(tree))


def read_model(path: str | Path, overrides: Sequence[str] = ()) -> Model:
    """A model file as a meshed structure, ready for `assemble`; its damping is in `read_model_file`.

    overrides : texts ``PATH=VALUE`` that change the file before anything is read.

    Raises InputErrors: as `read_model_file`, and for a structure in closed form, which has no mesh.

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


def read_study(path: str | Path, overrides: Sequence[str] = (), only: str | None = None) -> Plan:
    """A study file, its model and its cases, resolved and in SI units.

    overrides : texts ``PATH=VALUE`` that change the files before the cases do; paths of the study, its cases and its
        model.
    only : run this case alone; it is then the baseline, too.

    Returns a Plan: cases in the order of the file, without `cases:` one named "as given".

    Raises InputErrors: every mistake of both files and all cases, each on one line
    ``file:line:column: path: got, expected; do``.

    >>> import tempfile
    >>> model = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\\npoints: {m: {}}"
    >>> study = '''
    ... model: model.yaml
    ... bodies: {ball: {mass: 1 kg, above: m, drop_height: 5 cm, contact: {type: linear, stiffness: 1 MN/m}}}
    ... time: {duration: 1 s, sampling: 1 kHz}
    ... cases: {light: {}, heavy: {bodies.ball.mass: 2 kg}}
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "model.yaml").write_text(model, encoding="utf-8")
    ...     _ = Path(folder, "drop.study.yaml").write_text(study, encoding="utf-8")
    ...     plan = read_study(Path(folder, "drop.study.yaml"))
    >>> [(case.name, case.study.bodies[0].mass) for case in plan.cases], plan.baseline
    ([('light', 1.0), ('heavy', 2.0)], 'light')
    """
    study = read_yaml(path)
    _refuse_kind(study, "study", STUDY_KEYS, MODEL_KEYS)
    mistakes = Mistakes()
    first = _model_tree(study, study.value.get("model"), study.position(("model",)), "model", mistakes)
    patch = Patch(study, first, mistakes)
    _override(patch, overrides)
    base_study = patch.study.tree() if patch.study else study
    base_model = patch.model.tree() if patch.model else None
    if base_study.value.get("model") != study.value.get("model"):
        base_model = _model_tree(base_study, base_study.value.get("model"), Position("--set"), "model", mistakes)
    base = _Resolved.of(base_study, base_model, patch.changes, mistakes)
    sound = not mistakes.lines
    resolved = _cases(base_study, base_model, mistakes)
    if sound and not mistakes.lines:
        cases = [
            (name, _Resolved.of(one.study.tree(), one.model.tree() if one.model else None, one.changes, mistakes))
            for name, one in resolved
            if one.study
        ]
    else:
        cases = []
    mistakes.stop_if_any()
    if not cases:
        cases = [(AS_GIVEN, base)]
    names = [name for name, _ in cases]
    baseline = _baseline(base_study, names)
    if only is not None:
        if only not in names:
            raise InputErrors((f"--case: got '{only}', expected a case of {path}; {nearest(only, names)}",))
        cases = [(name, one) for name, one in cases if name == only]
        baseline = only
    sources: dict[str, str] = {}
    positions: dict[str, tuple[str, int, int]] = {}
    for _, one in [("", base), *cases]:
        for tree in (one.study, one.model):
            if tree is not None:
                sources[tree.file] = tree.text
                positions = {**_positions(tree), **positions}
    built = tuple(_case(name, one, patch.changes, mistakes, sources) for name, one in cases)
    mistakes.stop_if_any()
    whole = tuple(case for case in built if case is not None)
    return Plan(_title(base_study), whole, baseline, sources, positions)


def read_any(path: str | Path, overrides: Sequence[str] = ()) -> ModelFile | Plan:
    """A model or a study file, told apart by their keys: a study has `model`."""
    tree = read_yaml(path)
    return read_study(path, overrides) if _study_like(tree) else read_model_file(path, overrides)


def with_position(source: ModelFile | Plan, error: FemstructError) -> str:
    """The error as ``file:line:column: path: got, expected; do`` where its path, or the start of it, is in a file."""
    where = error.where
    ends = [len(where)] + [i for i in range(len(where) - 1, 0, -1) if where[i] in ". [="]
    for end in ends:
        if where[:end] in source.positions:
            file, line, column = source.positions[where[:end]]
            return f"{Position(file, line, column)}: {error}"
    return str(error)


def json_schema(kind: Literal["model", "study"]) -> dict[str, Any]:
    """JSON Schema (2020-12) of a model or study file, for editors."""
    schema: type[BaseModel] = ModelSpec if kind == "model" else StudySpec
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema.model_json_schema()}


@dataclass(frozen=True)
class _Resolved:
    """Both files as a case makes them, checked; the specs are None when there are mistakes."""

    study: Tree
    model: Tree | None
    study_spec: StudySpec | None
    model_spec: ModelSpec | None
    changes: Mapping[str, str]

    @classmethod
    def of(cls, study: Tree, model: Tree | None, changes: Mapping[str, str], mistakes: Mistakes) -> _Resolved:
        check_names(model, study, mistakes)
        model_spec = validate(ModelSpec, model.value, model, mistakes) if model is not None else None
        study_spec = validate(StudySpec, study.value, study, mistakes)
        if model is not None and model_spec is not None:
            check_model(model_spec, model, mistakes)
            if study_spec is not None:
                check_study(study_spec, study, model_spec, mistakes)
        return cls(study, model, study_spec, model_spec, dict(changes))


def _cases(study: Tree, model: Tree | None, mistakes: Mistakes) -> list[tuple[str, Patch]]:
    listed = study.value.get("cases")
    done = []
    for name, changes in listed.items() if isinstance(listed, dict) else ():
        own = model
        if isinstance(changes, dict) and "model" in changes:
            at = study.position(("cases", name, "model"))
            own = _model_tree(study, changes["model"], at, dotted(("cases", name, "model")), mistakes)
        patch = Patch(study, own, mistakes)
        if isinstance(changes, dict):
            patch.case(changes, study, ("cases", name))
            if "model" in changes and patch.study is not None:
                patch.study.put(("model",), changes["model"], study, ("cases", name, "model"))
                patch.changes["model"] = str(changes["model"])
        done.append((name, patch))
    return done


def _case(
    name: str, one: _Resolved, overrides: Mapping[str, str], mistakes: Mistakes, sources: dict[str, str]
) -> Case | None:
    if one.study_spec is None or one.model_spec is None or one.model is None:
        return None
    structure, damping = _built_model(one.model_spec, one.model, mistakes)
    if structure is None or damping is None:
        return None
    study = study_of(one.study_spec, _title(one.study), structure, damping, one.study, mistakes, sources)
    return Case(name, study, {**overrides, **one.changes}) if study is not None else None


def _built_model(spec: ModelSpec, tree: Tree, mistakes: Mistakes) -> tuple[StructureModel | None, Damping | None]:
    return structure_of(spec, _title(tree), tree, mistakes), damping_of(spec, tree, mistakes)


def _override(patch: Patch, overrides: Sequence[str]) -> None:
    for text in overrides:
        path, equals, value_text = text.partition("=")
        where = f"--set {text}"
        if not equals or not path.strip():
            patch.mistakes.add(Position(where), "", got="no PATH=VALUE", expected="--set bodies.ball.mass='60 g'")
            continue
        tree = parse_value(value_text, where, patch.mistakes)
        patch.assign(path.strip(), tree.value["value"], tree, ("value",))
        _warn_if_set_again(patch, path.strip(), where)


def _warn_if_set_again(patch: Patch, path: str, where: str) -> None:
    """An override that every case undoes would do nothing: refuse it."""
    cases = patch.study.value.get("cases") if patch.study else None
    if isinstance(cases, dict) and cases and all(isinstance(one, dict) and path in one for one in cases.values()):
        name = next(iter(cases))
        do = f"set 'cases.{name}.{path}' instead"
        patch.mistakes.add(
            Position(where), path, got="a path that every case sets itself", expected="another path", do=do
        )


def _baseline(study: Tree, names: Sequence[str]) -> str:
    compare = study.value.get("compare")
    chosen = compare.get("baseline") if isinstance(compare, dict) else None
    return str(chosen) if chosen in names else names[0]


def _model_tree(study: Tree, name: Any, at: Position, asked_path: str, mistakes: Mistakes) -> Tree | None:
    """The model file a study names, beside it; None with mistakes noted."""
    if name is None:
        return None  # the schema notes that it is missing
    if not isinstance(name, str) or not name.strip():
        mistakes.add(at, asked_path, got=shown_as(name), expected="the name of a model file")
        return None
    try:
        tree = read_yaml(Path(study.file).parent / name, at, asked_path)
        _refuse_kind(tree, "model", MODEL_KEYS, STUDY_KEYS)
    except InputErrors as errors:
        for line in errors.errors:
            mistakes.note(line)
        return None
    return tree


def _study_like(tree: Tree) -> bool:
    return "model" in tree.value or (not MODEL_KEYS & tree.value.keys() and bool(STUDY_KEYS & tree.value.keys()))


def _refuse_kind(tree: Tree, wanted: str, own: frozenset[str], other: frozenset[str]) -> None:
    """One sentence for the other kind of file, instead of one for each of its keys."""
    keys = tree.value.keys()
    if keys & other and not keys & own:
        found = "study" if wanted == "model" else "model"
        first = next(key for key in tree.value if key in other)
        at = tree.position((first,), of_key=True)
        raise InputErrors((f"{at}: {first}: got a {found} file, expected a {wanted} file",))


def _title(tree: Tree) -> str:
    title = tree.value.get("title")
    return title if isinstance(title, str) else Path(tree.file).name.partition(".")[0]


def _positions(tree: Tree) -> dict[str, tuple[str, int, int]]:
    return {dotted(steps): (at.file, at.line, at.column) for steps, at in tree.keys.items()}
