"""What a campaign is going to try, read before anything is computed; and where in the file its mistakes stand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from femstruct.errors import InputError, InputErrors
from femstruct.language import read_study
from femstruct.language.campaigns import overridden, refuse_other_cases, refuse_set_by_cases, steps_of
from femstruct.language.searches import read_search
from femstruct.language.study.campaign.optimise import CampaignSpec
from femstruct.language.study.campaign.vary import varied_of, written
from femstruct.language.yaml import Here, Mistakes, Tree, read_yaml, validate
from femstruct.study.campaign.sought import Search
from femstruct.study.campaign.varied import Listed, Scattered
from femstruct.study.study import Plan


def campaigns_of(file: str | Path, overrides: Sequence[str] = ()) -> dict[str, str]:
    """What a study varies and optimises, in words by the command that does it; {} for any other file.

    Raises InputErrors for what cannot be tried.
    """
    keys, found = read_yaml(file).value, {}
    if keys.get("vary"):
        _refuse_varied(file, overrides)
        varied = [*keys["vary"]] if isinstance(keys["vary"], dict) else []
        found["femstruct sweep"] = f"varies {', '.join(varied)}"
    if keys.get("optimise"):
        asked = read_search(file, overrides=overrides)
        plan = read_study(asked.file, asked.overrides, only=asked.case or None)
        search = with_limits_of_study(asked, plan)
        refuse_values(search, plan)
        goals = " and ".join(f"{goal.sense} {goal.name}" for goal in search.goals)
        of, chosen = f"of case '{search.case or plan.baseline}'", ", ".join(one.path for one in search.designs)
        held = ", ".join(f"{name} (of the study)" if name in search.of_study else name for name in search.limits)
        limits = f"; within the limits of {held}" if held else ""
        found["femstruct optimise"] = f"to {goals} {of} chooses {chosen}{limits}; at most {search.runs} runs"
    return found


def _refuse_varied(file: str | Path, overrides: Sequence[str]) -> None:
    """Raise InputErrors for paths under `vary:` of which the files can have neither the first nor the last value."""
    mistakes, asked = Mistakes(), tuple(overrides)
    tree = overridden(file, asked, ("vary",), mistakes)
    spec = validate(CampaignSpec, {"vary": tree.value["vary"]}, tree, mistakes)
    for one in varied_of(spec.vary if spec is not None else {}, Here(tree, mistakes)).values():
        texts = probes(one)
        told = [_refusal(str(file), asked, "", f"{one.path}={text}") for text in dict.fromkeys((texts[0], texts[-1]))]
        if all(told):
            mistakes.note(f"{_place(tree, one)}vary {one.path}, value {texts[0]}: {told[0]}")
    mistakes.stop_if_any()


def with_limits_of_study(search: Search, plan: Plan | None = None) -> Search:
    """The search with the limits that the study states itself, which designs hold too; its own limit of the same number
    comes first. plan : the study as it is written, None to read it."""
    plan = plan or read_study(search.file, search.overrides, only=search.case or None)
    study = next(one.study for one in plan.cases if one.name == (search.case or plan.baseline))
    own = {one.name: one.value for one in study.limits if one.name not in search.limits}
    return replace(search, limits={**search.limits, **own}, of_study=(*search.of_study, *own)) if own else search


def refuse_values(search: Search, plan: Plan) -> None:
    """Raise InputErrors for listed values that the files cannot have, for ranges and distributions of which they can
    have no end, and for paths of other cases. plan : the study as it is written."""
    tree = read_yaml(search.file)
    paths, case = [one.path for one in (*search.designs, *search.over)], search.case or plan.baseline
    refuse_other_cases(tree, paths, case)
    refuse_set_by_cases(tree, paths, [case])
    mistakes = Mistakes()
    for one in (*search.designs, *search.over):
        texts = probes(one)
        found = [_refusal(search.file, search.overrides, search.case, f"{one.path}={text}") for text in texts]
        if isinstance(one, Listed) or all(found):
            for text, told in zip(texts, found, strict=True):
                if told:
                    mistakes.note(f"{_place(tree, one)}vary {one.path}, value {text}: {told}")
                if told and not isinstance(one, Listed):
                    break
    mistakes.stop_if_any()


def refused_ends(search: Search) -> dict[str, tuple[str, str]]:
    """Of ranges of which the files cannot have one end, by path: that end, "lower" or "upper", and why. Designs there
    fail, those at the other end may not."""
    found = {}
    for one in search.designs:
        for end, text in zip(("lower", "upper"), () if isinstance(one, Listed) else probes(one), strict=False):
            if why := _refusal(search.file, search.overrides, search.case, f"{one.path}={text}"):
                found[one.path] = (end, why)
    return found


def probes(one: Listed | Scattered) -> Sequence[str]:
    """Values of what varies, as a file writes them: all of a list, both ends of a range, the mean.

    >>> probes(Scattered("bodies.ball.mass", "uniform", 1.0, 2.0, "kg"))
    ('1.0 kg', '2.0 kg')
    """
    if isinstance(one, Listed):
        return one.texts
    ends = (one.first,) if one.law == "normal" else (one.first, one.second)
    return tuple(written(end, one.unit) for end in ends)


def with_place(search: Search, error: InputError) -> InputError:
    """The error with its place in the file, if what is wrong stands there."""
    tree = read_yaml(search.file)
    steps = tuple(error.where.split(".", 2))
    value = tree.value
    for step in steps:
        value = value.get(step) if isinstance(value, dict) else None
    if value is None or (isinstance(value, str | list) and error.got.strip("'") not in value):
        return error
    return InputErrors((f"{tree.position(steps)}: {error}",))


def _refusal(file: str, overrides: Sequence[str], case: str, change: str) -> str:
    """Why the files cannot have a value; "" where they can. case : the only one to try, "" for all."""
    try:
        read_study(file, (*overrides, change), only=case or None, others=not case)
    except InputErrors as errors:
        return errors.errors[0].removeprefix(f"--set {change}: ")
    return ""


def _place(tree: Tree, one: Listed | Scattered) -> str:
    return next((f"{tree.keys[steps]}: " for steps in steps_of(one.path) if steps in tree.keys), "")
