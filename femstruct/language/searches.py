"""What a study file optimises, read."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from femstruct.declared import expect
from femstruct.errors import InputError, InputErrors
from femstruct.language.campaigns import overridden, varied_by
from femstruct.language.models import title_of
from femstruct.language.study.campaign.optimise import CampaignSpec
from femstruct.language.study.campaign.vary import varied_of
from femstruct.language.yaml import Here, Mistakes, Position, mapping_in, nearest, parse_value, validate
from femstruct.study.campaign.sought import Search

KEYS: Final = ("vary", "optimise")


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

    goal : "minimise NAME" or "maximise NAME", or several, in place of what the file says. vary : texts
    ``PATH=FROM:TO`` or ``PATH=FROM:TO:log`` of what may be chosen, beside what the file says. limits : texts
    ``NAME=VALUE``. overrides, case : as for `read_campaign`. runs : of the study at most.

    Raises InputErrors: every mistake, on one line each; a file that optimises nothing is one.

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
    tree = overridden(path, overrides, KEYS, mistakes)
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
