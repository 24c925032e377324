"""What a study file varies, read: paths with their values, and how they are combined."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from femstruct.declared import expect
from femstruct.errors import InputError, InputErrors
from femstruct.language.models import override, refuse_kind, title_of
from femstruct.language.patch import MODEL_KEYS, Patch, study_keys
from femstruct.language.varied import CampaignSpec, varied_of
from femstruct.study.campaigns import Campaign, Listed, Sampling, Scattered
from femstruct.study.optima import Search
from femstruct.yaml.reader import Here, Mistakes, Position, Tree, mapping_in, near_one, nearest, parse_value, read_yaml
from femstruct.yaml.validation import validate

KEYS: Final = ("vary", "samples")
RANGE: Final = re.compile(r"\s*[-+.\d][^:]*:.*")  # what a decimal comma leaves of one
DRAWN: Final = re.compile(r"(\w+)\((.*)\)")
SHORT: Final = "write it like 'bodies.damper.mass=50 g:1.5 kg:40:log' or 'parts.slab.thickness=180 mm,200 mm'"


def read_campaign(
    path: str | Path,
    vary: Sequence[str] = (),
    overrides: Sequence[str] = (),
    case: str = "",
    count: int | None = None,
    only: Sequence[str] = (),
) -> Campaign:
    """What a study file varies under `vary:` and `samples:`.

    Parameters
    ----------
    vary : Sequence[str]
        Texts ``PATH=FROM:TO:STEPS``, ``PATH=FROM:TO:STEPS:log``, ``PATH=FROM:TO``, ``PATH=VALUE,VALUE``,
        ``PATH=normal(MEAN, SD)`` or ``PATH=uniform(FROM, TO)``, beside what the file says or in place of it for the
        same path.
    overrides : Sequence[str]
        Texts ``PATH=VALUE`` that change the files for all samples.
    case : str
        The only one to run, "" for all.
    count : int | None
        Of samples of a Latin hypercube, in place of what the file says.
    only : Sequence[str]
        Numbers that a row holds, likewise.

    Raises
    ------
    InputErrors
        Every mistake, on one line each; a file that varies nothing is one.

    Examples
    --------
    >>> from pathlib import Path
    >>> import tempfile
    >>> study = "model: m.yaml\\nvary: {bodies.ball.mass: {from: 1 kg, to: 2 kg, steps: 3}}"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "hit.study.yaml").write_text(study, encoding="utf-8")
    ...     read_campaign(Path(folder, "hit.study.yaml")).varied[0].texts
    ('1.0 kg', '1.5 kg', '2.0 kg')
    """
    vary = expect("read_campaign vary", vary, tuple[str, ...])
    overrides = expect("read_campaign overrides", overrides, tuple[str, ...])
    only = expect("read_campaign only", only, tuple[str, ...])
    mistakes = Mistakes()
    tree = override_study(path, overrides, KEYS, mistakes)
    own = {key: tree.value[key] for key in KEYS if tree.value.get(key) is not None}
    spec = validate(CampaignSpec, own, tree, mistakes)
    found = varied_of(spec.vary if spec else {}, Here(tree, mistakes)) | varied_by(vary, mistakes)
    for text in [one for one in overrides if one.partition("=")[0].strip() in found]:
        mistakes.add(
            Position(f"--set {text}"), "", got="a path that varies", expected="another path", do="leave it out"
        )
    mistakes.stop_if_any()
    if not found:
        near = next((f"write '{key.lower()}' for '{key}'" for key in tree.value if key.lower() == "vary" != key), "")
        do = near or "add 'vary: {PATH: {from: .., to: .., steps: ..}}' to it, or --vary"
        raise InputErrors((f"{path}: vary: got a study that varies nothing, expected one or more paths; {do}",))
    if case:
        refuse_other_cases(tree, found, case)
    refuse_set_by_cases(tree, found, [case] if case else list(mapping_in(tree.value, "cases")), swept=True)
    asked = spec.samples if spec is not None else None
    try:
        sampling = (
            Sampling("latin hypercube", count) if count is not None else asked.sampling() if asked else Sampling()
        )
        kept = tuple(only) or tuple(asked.only if asked else ())
        return Campaign(str(path), tuple(found.values()), sampling, tuple(overrides), case, title_of(tree), kept)
    except InputError as error:
        steps = ("vary", error.where.removeprefix("vary.")) if error.where.startswith("vary.") else ("samples", "count")
        at = tree.keys.get(steps, Position(str(path)))
        raise InputErrors((f"{at}: {error}",)) from None


def refuse_other_cases(tree: Tree, paths: Iterable[str], case: str) -> None:
    """Raise InputErrors for paths that only cases add which are not run; an unknown case is refused where the study is
    read.

    Parameters
    ----------
    tree : Tree
        Of the study.
    """
    listed = tree.value.get("cases")
    if isinstance(listed, dict) and case not in listed:
        return
    patch, mistakes = Patch(tree, None, Mistakes()), Mistakes()
    for path in paths:
        named = [one.removeprefix("cases.").removesuffix(f".add.{path}") for one in patch.added_by_cases(path)]
        if named and case not in named:
            others = " and ".join(f"'{one}'" for one in named)
            got, expected = f"a path that case {others} adds", f"a path of case '{case}', which is run"
            do = f"choose the case with --case '{named[0]}', or 'case: {named[0]}' under 'optimise:'"
            mistakes.note(f"{_place_of(tree, path)}: vary {path}: got {got}, expected {expected}; {do}")
    mistakes.stop_if_any()


def set_by_cases(study: Mapping[str, Any], paths: Iterable[str], cases: Collection[str]) -> dict[str, tuple[str, ...]]:
    """Paths that cases set themselves, by case: they do not vary there.

    Parameters
    ----------
    study : Mapping[str, Any]
        The file.

    Examples
    --------
    >>> set_by_cases({"cases": {"heavy": {"bodies.ram.mass": "9 kg"}}}, ["bodies.ram.mass"], ["heavy"])
    {'heavy': ('bodies.ram.mass',)}
    """
    listed, paths = mapping_in(study, "cases"), tuple(paths)
    found = {
        case: tuple(path for path in paths if any(_within(path, str(key)) for key in mapping_in(listed, case)))
        for case in cases
    }
    return {case: own for case, own in found.items() if own}


def _within(path: str, key: str) -> bool:
    """Whether one of two paths is the other or leads to it."""
    return f"{path}.".startswith(f"{key}.") or f"{key}.".startswith(f"{path}.")


def refuse_set_by_cases(tree: Tree, paths: Iterable[str], cases: Collection[str], swept: bool = False) -> None:
    """Raise InputErrors for paths that every case that is run sets itself.

    Parameters
    ----------
    tree : Tree
        Of the study.
    swept : bool
        `vary:` is asked for, not `optimise:`.
    """
    paths, mistakes = tuple(paths), Mistakes()
    own = set_by_cases(tree.value, paths, cases)
    for path in (one for one in paths if cases and all(one in own.get(case, ()) for case in cases)):
        named, at = " and ".join(f"'{case}'" for case in cases), _place_of(tree, path, swept)
        do = f"vary 'cases.{next(iter(cases))}.{path}', or remove it from the case"
        mistakes.note(f"{at}: vary {path}: got a path that case {named} sets itself, expected one that varies; {do}")
    mistakes.stop_if_any()


def _place_of(tree: Tree, path: str, swept: bool = False) -> Position | str:
    places = steps_of(path)[::-1] if swept else steps_of(path)
    return next((tree.keys[steps] for steps in places if steps in tree.keys), tree.file)


def steps_of(path: str) -> tuple[tuple[str, ...], ...]:
    """Where a study file may say what a path takes."""
    return (("optimise", "vary", path), ("vary", path))


def override_study(path: str | Path, overrides: Sequence[str], keys: Collection[str], mistakes: Mistakes) -> Tree:
    """A study file with those overrides of the command line that are of some keys. Raises InputErrors for another
    kind of file."""
    tree = read_yaml(path)
    refuse_kind(tree, "study", study_keys(), lambda: MODEL_KEYS)
    patch = Patch(tree, None, mistakes)
    override(patch, [text for text in overrides if text.partition(".")[0].strip() in keys])
    return patch.study.tree() if patch.study else tree


def varied_by(texts: Sequence[str], mistakes: Mistakes, *, ranges: bool = False) -> dict[str, Listed | Scattered]:
    """What the command line varies, by path.

    Parameters
    ----------
    ranges : bool
        Without steps, as in FROM:TO:log.
    """
    found: dict[str, Listed | Scattered] = {}
    for text in texts:
        tree = _short(text, mistakes, ranges)
        spec = validate(CampaignSpec, tree.value, tree, mistakes)
        found |= varied_of(spec.vary if spec else {}, Here(tree, mistakes))
    return found


def _short(text: str, mistakes: Mistakes, ranges: bool) -> Tree:
    """What the command line varies, as a file would say it."""
    path, equals, written = (part.strip() for part in text.partition("="))
    file = f"--vary {text}"
    value = _values(written, bool(equals and path), file, mistakes, ranges)
    whole = {"vary": {path: value}} if value else {}
    return Tree(file, whole, dict.fromkeys(((), ("vary", path)), Position(file)), {}, text)


def _values(written: str, with_path: bool, file: str, mistakes: Mistakes, ranges: bool) -> dict[str, Any]:
    """The values of a path: drawn, listed, one, or a range from end to end; {} with a mistake noted."""
    listed = parse_value(f"[{written}]", file, mistakes).value if "," in written else [written]
    ends = [one.strip() for one in written.split(":")] if len(listed) == 1 and "," not in written else [written]
    drawn = DRAWN.fullmatch(written)
    if drawn is not None and drawn[1] not in ("normal", "uniform"):
        do = near_one(drawn[1], ("normal", "uniform"))
        mistakes.add(Position(file), "", got=f"'{written}'", expected="normal(MEAN, SD) or uniform(FROM, TO)", do=do)
        return {}
    if drawn is not None and with_path:
        pair = [one.strip() for one in drawn[2].split(",")]
        return {"uniform": pair} if drawn[1] == "uniform" else {"normal": dict(zip(("mean", "sd"), pair, strict=False))}
    if not (with_path and written and all(ends)) or len(ends) > 4 or any(map(_range_in_list, listed[1:])):
        mistakes.add(Position(file), "", got="no range and no list", expected="PATH=FROM:TO:STEPS", do=SHORT)
        return {}
    if len(ends) == 1:
        return {"values": listed if "," in written else [parse_value(written, file, mistakes).value]}
    start, to, *more = ends
    more = ["", *more] if ranges else more
    value = {"from": start, "to": to}
    value |= {"steps": parse_value(more[0], file, mistakes).value} if more and more[0] else {}
    return value | ({"scale": more[1]} if len(more) > 1 else {})


def _range_in_list(value: object) -> bool:
    return isinstance(value, str) and RANGE.fullmatch(value) is not None


# ----------------------------------------------------------------------------------------------------------------------
# What a study file optimises, read.
# ----------------------------------------------------------------------------------------------------------------------

SEARCH_KEYS: Final = ("vary", "optimise")


def read_search(
    path: str | Path,
    goal: str | Sequence[str] = "",
    vary: Sequence[str] = (),
    limits: Sequence[str] = (),
    overrides: Sequence[str] = (),
    case: str = "",
    runs: int | None = None,
) -> Search:
    """What a study file optimises under `optimise:`.

    Parameters
    ----------
    goal : str | Sequence[str]
        "minimise NAME" or "maximise NAME", or several, in place of what the file says.
    vary : Sequence[str]
        Texts ``PATH=FROM:TO`` or ``PATH=FROM:TO:log`` of what may be chosen, beside what the file says.
    limits : Sequence[str]
        Texts ``NAME=VALUE``.
    overrides, case : Sequence[str], str
        As for `read_campaign`.
    runs : int | None
        Of the study at most.

    Raises
    ------
    InputErrors
        Every mistake, on one line each; a file that optimises nothing is one.

    Examples
    --------
    >>> from pathlib import Path
    >>> import tempfile
    >>> study = "model: m.yaml\\noptimise: {minimise: ground force, vary: {bodies.damper.mass: {from: 1 kg, to: 9 kg}}}"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "press.study.yaml").write_text(study, encoding="utf-8")
    ...     search = read_search(Path(folder, "press.study.yaml"), limits=["damper travel=18 mm"])
    >>> search.goal, search.designs[0].second, dict(search.limits)
    ('ground force', 9.0, {'damper travel': 0.018})
    """
    vary = expect("read_search vary", vary, tuple[str, ...])
    limits = expect("read_search limits", limits, tuple[str, ...])
    overrides = expect("read_search overrides", overrides, tuple[str, ...])
    mistakes = Mistakes()
    tree = override_study(path, overrides, SEARCH_KEYS, mistakes)
    asked_for = _goals([goal] if isinstance(goal, str) else goal, mistakes)
    block = dict(tree.value["optimise"]) if isinstance(tree.value.get("optimise"), dict) else {}
    if asked_for:
        block = {key: one for key, one in block.items() if key not in ("minimise", "maximise")} | asked_for
    if not block:
        do = "add 'optimise: {minimise: ground force, vary: {..}}' to it, or --minimise and --vary"
        raise InputErrors((f"{path}: optimise: got a study that optimises nothing, expected a goal; {do}",))
    block["limits"] = {**(block.get("limits") or {}), **_limits(limits, mistakes)}
    own = {"optimise": block} | ({"vary": tree.value["vary"]} if tree.value.get("vary") else {})
    spec = validate(CampaignSpec, own, tree, mistakes)
    mistakes.stop_if_any()
    assert spec is not None and spec.optimise is not None
    here, asked = Here(tree, mistakes), spec.optimise
    cases = mapping_in(tree.value, "cases")
    if asked.case is not None and not case:
        here.at("optimise", "case").need(asked.case in cases, f"'{asked.case}'", "a case", nearest(asked.case, cases))
    designs = varied_of(asked.vary, here.at("optimise")) | varied_by(vary, mistakes, ranges=True)
    varied = varied_of(spec.vary, here)
    mistakes.stop_if_any()
    try:
        first, *others = asked.goals()
        return Search(
            file=str(path),
            goal=first.name,
            designs=tuple(designs.values()),
            sense=first.sense,
            also=tuple(others),
            limits={name: one.value for name, one in asked.limits.items()},
            limit_dimensions={name: one.dimension for name, one in asked.limits.items() if one.dimension},
            over=asked.scattering(varied),
            runs=runs or asked.runs,
            seed=asked.seed,
            case=case or asked.case or "",
            overrides=tuple(overrides),
            title=title_of(tree),
            **asked.robustness(),
        )
    except InputError as error:
        at = tree.position(_steps(error.where), of_key=True)
        raise InputErrors((f"{at}: {error}",)) from None


def _steps(where: str) -> tuple[str, ...]:
    """The keys of a path in a message: what varies has dots in its name."""
    for start in ("optimise.vary.", "vary."):
        if where.startswith(start):
            return (*start.rstrip(".").split("."), where.removeprefix(start))
    return tuple(where.split("."))


def _goals(texts: Sequence[str], mistakes: Mistakes) -> dict[str, list[str]]:
    """Goals of the command line, as a file would say them.

    >>> _goals(["minimise total mass", "maximise mode 1 frequency"], Mistakes())
    {'minimise': ['total mass'], 'maximise': ['mode 1 frequency']}
    """
    found: dict[str, list[str]] = {}
    for sense, _, name in (text.partition(" ") for text in texts if text):
        found.setdefault(sense, []).append(name)
        if not name.strip():
            mistakes.add(Position(f"--{sense}"), "", got="an empty text", expected="the name of a number")
    mistakes.stop_if_any()
    return found


def _limits(texts: Sequence[str], mistakes: Mistakes) -> dict[str, Any]:
    """Limits of the command line."""
    found: dict[str, Any] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (equals and name and value):
            do = "write it like 'damper travel=18 mm'"
            mistakes.add(Position(f"--limit {text}"), "", got="no NAME=VALUE", expected="a limit", do=do)
            continue
        found[name] = parse_value(value, f"--limit {text}", mistakes).value
    return found
