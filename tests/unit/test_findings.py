"""The catalogue of findings: all codes that the source raises and no others, true thresholds, plain sentences."""

from __future__ import annotations

import ast
import importlib
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import findings_page
import pytest

from femstruct.errors import Finding, InputError
from femstruct.findings.catalogue import CATALOGUE, SUBJECTS, entry_of, rank_findings, rank_of
from femstruct.findings.entry import FORBIDS, LIMITS, REMARK, Entry
from femstruct.findings.explain import explanation, listing, page

ROOT = Path(__file__).parents[2]
FILES = sorted([*(ROOT / "femstruct").rglob("*.py"), *(ROOT / "acoustics").rglob("*.py")])
TREES = {path: ast.parse(path.read_text(encoding="utf-8")) for path in FILES}
RAISES = {"Finding", "Advice"}
SPOKEN = re.compile(r"\b(told|heard itself|hang on|hangs on|meets|march)\b")
# One of these is in every sentence after its subject; none of them is used as a noun.
VERBS = re.compile(
    r"\b(is|are|was|has|have|does|do|holds?|fills?|sags|lies?|moves?|leans?|slide|turn|depends?|changes|contains?"
    r"|carry|carries|react|couples?|ends?|comes?|vibrates|radiates|uses?|needs|leaves|exchange|covers|miss|joins)\b"
)


def calls() -> Iterator[tuple[Path, ast.Call]]:
    """Where findings and advice are made."""
    for path, tree in TREES.items():
        for node in ast.walk(tree):
            name = getattr(node.func, "id", getattr(node.func, "attr", "")) if isinstance(node, ast.Call) else ""
            if name in RAISES:
                assert isinstance(node, ast.Call)
                yield path, node


def given(call: ast.Call, name: str, place: int) -> ast.expr | None:
    named = {keyword.arg: keyword.value for keyword in call.keywords}
    return named.get(name, call.args[place] if len(call.args) > place else None)


def is_passed_on(code: ast.expr | None) -> bool:
    """Whether a code is that of another finding: `found.code`, or what a table of one holds."""
    if isinstance(code, ast.Attribute):
        return code.attr == "code"
    return isinstance(code, ast.Subscript) and isinstance(code.slice, ast.Constant) and code.slice.value == "code"


def constant(path: Path, name: str) -> ast.expr:
    """What a name of a module stands for."""
    for node in TREES[path].body:
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        if name in {getattr(target, "id", "") for target in targets}:
            return node.value
    raise AssertionError(f"{path}: {name} is no constant: write codes out")


@cache
def raised() -> dict[str, list[bool | None]]:
    """Whether a code is severe wherever it is raised: always (True), never (False), or by its numbers (None)."""
    found: dict[str, list[bool | None]] = {}
    for path, call in calls():
        code = given(call, "code", 0)
        if is_passed_on(code):
            continue
        name = getattr(constant(path, code.id) if isinstance(code, ast.Name) else code, "value", None)
        assert isinstance(name, str), f"{path}:{call.lineno}: a code that cannot be read from the source"
        severe = given(call, "severe", 3)
        says = severe.value if isinstance(severe, ast.Constant) else None
        found.setdefault(name, []).append(False if severe is None else says)
    return found


def looked_for() -> Iterator[tuple[str, str]]:
    """Codes that are compared with, looked for, or flagged, with their files."""
    for path, tree in TREES.items():
        found: list[ast.AST | None] = []
        for node in ast.walk(tree):
            if isinstance(node, ast.Compare) and getattr(node.left, "attr", "") == "code":
                others = [one for one in node.comparators if not getattr(one, "id", "").islower()]  # but `known`
                found += [constant(path, one.id) if isinstance(one, ast.Name) else one for one in others]
            if isinstance(node, ast.Subscript) and "flags" in (getattr(node.value, key, "") for key in ("attr", "id")):
                found.append(node.slice)
            if isinstance(node, ast.FunctionDef) and node.name == "_flags":
                found += [key for one in ast.walk(node) if isinstance(one, ast.Dict) for key in one.keys]
        constants = (one for node in found if node is not None for one in ast.walk(node))
        yield from ((str(path), one.value) for one in constants if isinstance(getattr(one, "value", None), str))


def test_every_code_that_is_raised_is_in_the_catalogue_and_every_one_of_it_is_raised() -> None:
    assert set(raised()) == set(CATALOGUE)
    assert len(CATALOGUE) == sum(len(entries) for entries in SUBJECTS.values())  # no code in two subjects


def test_codes_that_are_looked_for_exist() -> None:
    found = list(looked_for())
    known = {"interrupted", "structure-not-decayed", "contact-coarsely-sampled", "failed", "lifted-in-contact"}
    assert known <= {code for _, code in found}
    assert not [one for one in found if one[1] not in CATALOGUE]


@pytest.mark.parametrize("code", CATALOGUE)
def test_the_rank_is_what_the_source_says(code: str) -> None:
    entry, severe = CATALOGUE[code], raised()[code]
    if all(one is True for one in severe):
        assert entry.rank is FORBIDS and not entry.forbids
    elif all(one is False for one in severe):
        assert entry.rank in (LIMITS, REMARK) and not entry.forbids and not any(one.forbids for one in entry.limits)
    else:
        assert entry.rank in (LIMITS, REMARK) and entry.forbids


HOMES = [(entry.code, limit) for entry in CATALOGUE.values() for limit in entry.limits if limit.home]


@pytest.mark.parametrize(("code", "limit"), HOMES, ids=[f"{code} {limit.home}" for code, limit in HOMES])
def test_thresholds_are_those_that_the_program_computes_with(code: str, limit) -> None:
    """Modules are found by the ends of their names, so that a folder may be renamed."""
    home, _, name = limit.home.rpartition(".")
    name, _, index = name.partition("[")
    names = [".".join(path.relative_to(ROOT).with_suffix("").parts) for path in FILES]
    modules = [importlib.import_module(one) for one in names if f".{one}".endswith(f".{home}")]
    (found,) = (getattr(module, name) for module in modules if hasattr(module, name))
    value = found[int(index[:-1])] if index else found
    assert value == limit.value


@pytest.mark.parametrize("entry", CATALOGUE.values(), ids=lambda entry: entry.code)
def test_sentences_are_plain(entry: Entry) -> None:
    assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", entry.code)
    words, verb = re.findall(r"[\w-]+", entry.sentence), VERBS.search(entry.sentence)
    assert verb and verb.start() > 0, f"a subject and a verb: {entry.sentence}"
    assert entry.sentence[0].isupper() and entry.sentence.endswith(".") and entry.sentence.count(". ") == 0
    assert len(words) <= 20 and entry.do.endswith(".") and entry.do[0].isupper() and not entry.when.endswith(".")
    whole = explanation(entry)
    assert not SPOKEN.search(whole), SPOKEN.search(whole)
    assert max(map(len, whole.splitlines())) <= 90


def test_an_unknown_code_is_refused_with_the_nearest() -> None:
    with pytest.raises(InputError, match="the nearest is 'thick-plate'"):
        entry_of("thikc-plate")
    with pytest.raises(InputError, match=r"got 'xx', expected the code of a finding; 'femstruct explain' lists all$"):
        entry_of("xx")


def test_the_list_has_every_code_under_its_rank() -> None:
    parts = re.split(r"^(?=forbids trust:|limits trust:|remark:|Depending)", listing(), flags=re.M)[1:]
    for rank, part in zip((FORBIDS, LIMITS, REMARK), parts, strict=False):
        codes = re.findall(r"^  ([\w-]+)$", part, flags=re.M)
        assert codes == [entry.code for entry in CATALOGUE.values() if entry.rank is rank]
    assert "coarse-mesh" in parts[3]


def test_a_finding_that_says_it_is_severe_comes_first() -> None:
    mesh = Finding("coarse-mesh", "Coarse.", severe=True)
    found = (Finding("two-way-coupling", "Air."), Finding("own", "Of another program."), mesh, mesh)
    assert [one.code for one in rank_findings(found)] == ["coarse-mesh", "own", "two-way-coupling"]
    assert rank_of("own", severe=False) is LIMITS and rank_of("coarse-mesh", severe=False) is LIMITS


def test_the_page_is_not_stale() -> None:
    told = "run scripts/findings_page.py: docs/findings.md is not what the catalogue says"
    assert findings_page.PAGE.read_text(encoding="utf-8") == page(), told


@pytest.mark.parametrize(
    ("words", "code"), [([], 0), (["t60-missed"], 0), (["t60-misst"], 2), (["t60-missed", "--json"], 0)]
)
def test_explain_loads_no_numpy(words: list[str], code: int) -> None:
    program = f"import sys, femstruct.cli; sys.argv = ['femstruct', 'explain', *{words}]\n"
    program += "import atexit; atexit.register(lambda: print('loaded', *sys.modules))\nfemstruct.cli.main()"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == code
    assert "t60-missed" in (done.stderr if code else done.stdout)
    assert not {"numpy", "scipy", "matplotlib"} & set(done.stdout.split("loaded", 1)[1].split())
