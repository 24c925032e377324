"""The files as nouns: a model, a study with its cases, what an override changes, and where everything stands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel

from acoustics.fields.shaped import ShapedRoom
from femstruct.errors import InputErrors
from femstruct.files.text_tables import beside
from femstruct.language.model_file import ModelSpec
from femstruct.language.models import (
    ModelFile,
    built_model,
    override,
    positions_of,
    read_model_file,
    refuse_kind,
    title_of,
)
from femstruct.language.patch import MODEL_KEYS, Patch, check_names, study_keys
from femstruct.language.studies import StudySpec, check_study, drops, expand_arrays, study_of
from femstruct.study.study import Case, Plan, Study
from femstruct.yaml.reader import Here, Mistakes, Tree, nearest, read_yaml
from femstruct.yaml.validation import validate

AS_GIVEN = "as given"


def read_study(
    path: str | Path, overrides: Sequence[str] = (), only: str | None = None, *, others: bool = True
) -> Plan:
    """A study file, its model and its cases, resolved and in SI units.

    Parameters
    ----------
    overrides : Sequence[str]
        Texts ``PATH=VALUE`` that change the files before the cases do; paths of the study, its cases and its model.
    only : str | None
        Run this case alone; it is then the baseline, too.
    others : bool
        False to leave the other cases unread, for who reads a study again and again.

    Returns
    -------
    Plan
        A Plan: cases in the order of the file, without `cases:` one named "as given".

    Raises
    ------
    InputErrors
        Every mistake of both files and all cases that are read, each on one line ``file:line:column: path: got,
        expected; do``.

    Examples
    --------
    >>> from pathlib import Path
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
    mistakes, study = Mistakes(), read_yaml(path)
    refuse_kind(study, "study", study_keys(), lambda: MODEL_KEYS)
    patch = Patch(study, _model_tree(Here(study, mistakes).at("model"), study.value.get("model")), mistakes)
    override(patch, overrides)
    for group in (("vary",), ("optimise", "vary")):
        patch.refuse_unknown_in(group)
    base = patch.study.tree() if patch.study else study
    model = patch.model.tree() if patch.model else None
    if base.value.get("model") != study.value.get("model"):
        model = _model_tree(Here(base, mistakes).at("model"), base.value.get("model"))
    sources: dict[str, str] = {}
    as_given = _Resolved.of(base, model, patch.changes, mistakes, sources)
    sound, patches = not mistakes.lines, _cases(base, model, mistakes, None if others else only)
    cases: dict[str, _Resolved] = {}
    for name, one in patches.items() if sound and not mistakes.lines else ():
        drafts = [draft.tree() if draft is not None else None for draft in (one.study, one.model)]
        cases[name] = _Resolved.of(drafts[0] or base, drafts[1], one.changes, mistakes, sources)
    mistakes.stop_if_any()
    cases = cases or {AS_GIVEN: as_given}
    baseline = _baseline(base, [*cases]) if only is None else only
    if baseline not in cases:
        raise InputErrors((f"--case: got '{only}', expected a case of {path}; {nearest(baseline, cases)}",))
    positions: dict[str, tuple[str, int, int]] = {}
    for tree in (tree for one in (as_given, *cases.values()) for tree in (one.study, one.model) if tree is not None):
        sources[tree.file] = tree.text
        positions = {**positions_of(tree), **positions}
    shaped: dict[str, ShapedRoom] = {}
    chosen = {only: cases[only]} if only is not None else cases
    built = [_case(name, one, patch.changes, mistakes, sources, shaped) for name, one in chosen.items()]
    mistakes.stop_if_any()
    return Plan(title_of(base), tuple(case for case in built if case is not None), baseline, sources, positions)


def read_any(path: str | Path, overrides: Sequence[str] = ()) -> ModelFile | Plan:
    """A model or a study file, told apart by their keys: a study has `model`."""
    tree = read_yaml(path)
    return read_study(path, overrides) if _study_like(tree) else read_model_file(path, overrides)


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
    def of(
        cls,
        study: Tree,
        model: Tree | None,
        changes: Mapping[str, str],
        mistakes: Mistakes,
        sources: dict[str, str],
    ) -> _Resolved:
        check_names(model, study, mistakes)
        model_spec = validate(ModelSpec, model.value, model, mistakes, sources) if model is not None else None
        study_spec = validate(StudySpec, study.value, study, mistakes, sources)
        if model is not None and model_spec is not None:
            names = model_spec.names()
            model_spec.check(Here(model, mistakes, names))
            if study_spec is not None:
                check_study(study_spec, Here(study, mistakes, names), model_spec)
        return cls(study, model, study_spec, model_spec, dict(changes))


def _cases(study: Tree, model: Tree | None, mistakes: Mistakes, only: str | None) -> dict[str, Patch]:
    """What every case of a study makes of both files, or one of them."""
    listed, done = study.value.get("cases"), {}
    for name, changes in listed.items() if isinstance(listed, dict) else ():
        if only is not None and name != only and only in listed:
            continue
        there, own = Here(study, mistakes).at("cases", name), model
        if isinstance(changes, dict) and "model" in changes:
            own = _model_tree(there.at("model"), changes["model"])
        patch = done[name] = Patch(study, own, mistakes)
        if isinstance(changes, dict):
            patch.case(changes, there)
            if "model" in changes and patch.study is not None:
                patch.study.put(("model",), changes["model"], there.at("model"))
                patch.changes["model"] = str(changes["model"])
    return done


def _case(
    name: str,
    one: _Resolved,
    overrides: Mapping[str, str],
    mistakes: Mistakes,
    sources: dict[str, str],
    shaped: dict[str, ShapedRoom],
) -> Case | None:
    if one.study_spec is None or one.model_spec is None or one.model is None:
        return None
    structure, damping = built_model(one.model_spec, one.model, mistakes, sources)
    if structure is None or damping is None:
        return None
    names, tree = one.model_spec.names(), one.study
    changes = {**overrides, **one.changes}

    def built(spec: StudySpec) -> Study | None:
        return study_of(spec, title_of(tree), structure, damping, Here(tree, mistakes), sources, shaped)

    places = {place: built(spec) for place, spec in drops(one.study_spec, names).items()}
    studies = {place: study for place, study in places.items() if study is not None}
    study = next(iter(studies.values())) if studies else built(expand_arrays(one.study_spec, names))
    return Case(name, study, changes, studies) if study is not None and len(studies) == len(places) else None


def _baseline(study: Tree, names: Sequence[str]) -> str:
    compare = study.value.get("compare")
    chosen = compare.get("baseline") if isinstance(compare, dict) else None
    return str(chosen) if chosen in names else names[0]


def _model_tree(there: Here, name: Any) -> Tree | None:
    """The model file a study names, beside it; None with mistakes noted."""
    if not isinstance(name, str) or not name.strip():
        return None  # the schema notes what it is
    tree = there.make(lambda: read_yaml(beside(there.tree.file, name), there.position, there.path))
    sound = tree is not None and there.make(lambda: refuse_kind(tree, "model", MODEL_KEYS, study_keys))
    return tree if sound else None


def _study_like(tree: Tree) -> bool:
    return "model" in tree.value or (not MODEL_KEYS & tree.value.keys() and bool(study_keys() & tree.value.keys()))
