"""Results outlive the tree: what is stored has a tag of its own, and files of formats 4 and 5 are read for ever."""

from __future__ import annotations

import dataclasses
import hashlib
import importlib
import inspect
import lzma
import os
import pkgutil
import re
import shutil
import subprocess
import sys
import typing
from collections import Counter
from collections.abc import Callable, Iterator
from enum import Enum
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import stored_tags

import acoustics
import acoustics.tags
import femstruct
import femstruct.tags
from acoustics.levels.standards import STANDARDS, method_of
from femstruct.errors import FemstructError, Finding
from femstruct.evaluations.known_evaluations import EVALUATIONS
from femstruct.files import results_format_4, stored_values
from femstruct.files.results_file import read_results
from femstruct.files.stored_values import Newer, is_stored_class, kind_of, restore_value, store_value, tag_of
from femstruct.files.tagged_modules import MODULES
from femstruct.impact.response import ContactHistory, Outcome
from femstruct.study.optima import Found, Front
from femstruct.study.results import StudyResult
from femstruct.tags import stored_as

ROOT = Path(__file__).parents[2]
DATA = ROOT / "tests" / "data"
FROZEN = ("results_format_4", "results_format_5")  # of one study, written by the versions of then: never anew
PACKAGES = ("femstruct", "acoustics")
MEMBERS = {
    "outcome/1": ["SEPARATED", "CLOSED_AT_END", "RESTING", "HELD", "TOGETHER", "NEVER_TOUCHED", "NO_CONTACTS"],
    "what an unread entry makes/1": [
        *("UNKNOWN", "PRELOAD", "ELEMENTS", "SECTION", "SPREAD", "MATERIAL", "LAY_UP", "THICKNESS", "OFFSET"),
        *("ORIENTATION", "BARS", "SPRINGS", "MASSES", "LINKS", "SUPPORTS", "SLIGHT", "NOTHING"),
    ],
}


def all_modules() -> Iterator[ModuleType]:
    for package in (femstruct, acoustics):
        yield package
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if not found.name.endswith("__main__"):
                yield importlib.import_module(found.name)


def kinds_below(kind: type) -> Iterator[type]:
    for one in kind.__subclasses__():
        yield one
        yield from kinds_below(one)


def hints_of(kind: type, names: dict[str, object]) -> dict[str, object]:
    """Its annotations; names : of all modules, for what a module imports for type checkers alone."""
    unimported: dict[str, object] = {}
    while True:
        try:
            return typing.get_type_hints(kind, localns=unimported)
        except NameError as error:
            unimported[error.name] = names[error.name]


def reachable(roots: tuple[object, ...]) -> set[type]:
    """All classes of this project that fields of these can have by their annotations, and what extends them."""
    names = {name: value for module in all_modules() for name, value in vars(module).items()}
    seen: set[type] = set()
    waiting = list(roots)
    while waiting:
        hint = waiting.pop()
        if isinstance(hint, list | tuple):
            waiting += hint
        elif not isinstance(hint, type) or typing.get_origin(hint):
            waiting += typing.get_args(hint)
        elif hint not in seen and hint.__module__.partition(".")[0] in PACKAGES:
            seen.add(hint)
            waiting += kinds_below(hint)
            fields = getattr(hint, "_fields", ())
            if dataclasses.is_dataclass(hint):
                fields = tuple(field.name for field in dataclasses.fields(hint))
            hints = hints_of(hint, names) if fields else {}
            waiting += [hints[name] for name in fields]
    return {kind for kind in seen if is_stored_class(kind) and not inspect.isabstract(kind)}


def test_everything_that_results_can_hold_has_a_tag() -> None:
    roots = (StudyResult, Found, Front, *(one.gives for one in EVALUATIONS.values()))
    found = {kind for kind in reachable(roots) if kind.__module__.partition(".")[0] in PACKAGES}
    assert len(found) > 200
    known = {**femstruct.tags.TAGS, **acoustics.tags.TAGS}
    lacking = sorted(f"{kind.__module__}:{kind.__qualname__}" for kind in found - set(known))
    assert not lacking, f"write @stored_as('WORDS OF THE FIELD/1') above them: {lacking}"


def test_functions_that_results_hold_have_tags() -> None:
    """How standards average, correct and rate."""
    for blows in ("heavy", "tapping"):
        for standard in STANDARDS:
            try:
                method = method_of([standard], blows)
            except acoustics.AcousticsError:
                continue  # a source that the standard does not rate
            for one in (method.average, method.correct, *(number.rate for number in method.numbers)):
                assert one is None or kind_of(tag_of(one)) is one


def test_tags_are_unique_and_their_table_is_up_to_date() -> None:
    """The table has each tag once, and every class is found where it says."""
    table = stored_tags.table(ROOT)
    assert (ROOT / stored_tags.TABLE).read_text(encoding="utf-8") == table, "run python scripts/stored_tags.py"
    tags = Counter(re.findall(r'^ +"(.*?/\d+)": "', table, re.MULTILINE))
    assert [tag for tag, number in tags.items() if number > 1] == [] and set(tags) == set(MODULES)
    for tag, module in MODULES.items():
        assert kind_of(tag).__module__ == module and tag_of(kind_of(tag)) == tag


def test_what_format_4_named_is_frozen_and_known() -> None:
    told = "\n".join(f"{name} {tag}" for name, tag in sorted(results_format_4._TAGS.items()))
    assert (
        hashlib.sha256(told.encode()).hexdigest() == "173fb671fb833560c3336b123ab33b0c91d27e06651f5ba9b187b4ca20d65128"
    )
    for name in results_format_4._TAGS:
        newest = tag = results_format_4.tag_of_format_4(name.replace("/", "."))
        while newest in stored_values.NEWER:
            newest = stored_values.NEWER[newest].tag
        assert tag is not None and kind_of(newest) is not None


def rope_of(module: str) -> type:
    """A noun that somebody wrote in a module."""
    kind = dataclasses.make_dataclass("Rope", ["mass"], frozen=True)
    kind.__module__ = module
    return kind


def test_a_class_without_a_tag_is_told_to_whoever_writes_it() -> None:
    kind = rope_of("femstruct.parts.rope")
    with pytest.raises(FemstructError, match=r"femstruct.parts.rope:Rope, which has no tag.*@stored_as\('WORDS"):
        store_value(kind(2.0), keep=lambda array: None)


@pytest.mark.parametrize(
    ("tag", "module", "told"),
    [
        ("contact history/1", "femstruct.parts.rope", "ContactHistory has it"),
        ("rope", "femstruct.parts.rope", "expected words of the field and a version"),
        ("guest: rope/1", "femstruct.parts.rope", "expected no package in it"),
        ("rope/1", "guest.rope", "expected the name of its package before it, 'guest: rope/1'"),
    ],
)
def test_tags_that_would_not_be_found_again_are_refused(tag: str, module: str, told: str) -> None:
    kind = rope_of(module)
    with pytest.raises(ValueError, match=told):
        stored_as(tag)(kind)


def made_with(change: Callable[[dict[str, object]], object]) -> object:
    """A finding whose stored fields somebody changed."""
    tables = store_value(Finding("mechanism", "It moves."), keep=lambda array: None)
    change(tables.nouns[0])
    return restore_value(tables, fetch=lambda place: np.zeros(0))


def test_fields_are_told_by_name() -> None:
    """More fields than the noun has are passed over, those that have a default may lack, others are named."""
    assert made_with(lambda one: one.update(colour="red")) == Finding("mechanism", "It moves.")
    assert made_with(lambda one: one.pop("severe")) == Finding("mechanism", "It moves.")
    with pytest.raises(FemstructError, match="'finding/1' without message"):
        made_with(lambda one: one.pop("message"))


def test_an_older_version_of_a_noun_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    """What its fields were called then is said in one place."""

    def of_then(fields: stored_values.Fields) -> stored_values.Fields:
        return {**fields, "code": fields["word"]}

    newer = {"remark/1": Newer("finding/1", of_then)}
    monkeypatch.setattr("femstruct.files.stored_values.NEWER", newer)
    found = made_with(lambda one: one.update({"is": "remark/1", "word": one.pop("code")}))
    assert found == Finding("mechanism", "It moves.")


def test_members_and_functions_are_told_by_tags() -> None:
    tables = store_value([Outcome.SEPARATED, kind_of("energy average/1")], keep=lambda array: None)
    assert tables.value == {"list": [{"enum": ["outcome/1", "SEPARATED"]}, {"function": "energy average/1"}]}
    assert restore_value(tables, fetch=lambda place: np.zeros(0)) == [Outcome.SEPARATED, kind_of("energy average/1")]


@pytest.fixture(scope="module")
def frozen(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results files of older versions, as they were written."""
    folder = tmp_path_factory.mktemp("frozen")
    for name in FROZEN:
        packed = DATA / f"{name}.h5.xz"
        assert packed.stat().st_size < 200_000
        (folder / f"{name}.h5").write_bytes(lzma.decompress(packed.read_bytes()))
    return folder


@pytest.mark.parametrize("name", FROZEN)
def test_files_of_then_are_read_for_ever(frozen: Path, name: str) -> None:
    """A ball on a plate over a room, two cases: the numbers that these versions computed."""
    result = read_results(frozen / f"{name}.h5")
    assert list(result.cases) == ["as it is", "thick"] and result.plan.title == "A ball on a small plate"
    case = result.cases["as it is"]
    assert case.basis.frequency_hz.tolist() == [
        *(111.24585495751397, 224.0655758157705),
        *(452.3810742235483, 899.3955450504374),
    ]
    assert case.channels["ball on middle force"].whole == 31.583691212773797
    assert case.channels["middle.z velocity"].values[37] == 0.004627609098411322
    assert case.levels["box.mic"].l_peak_db == 109.8411467462671
    assert abs(case.frf["drive point"].values[5]) == 0.0004893521713322592
    assert case.basis.shapes[4, 2, 0] == 0.6614012729249994
    assert case.response is not None and case.response.outcome is Outcome.SEPARATED
    assert isinstance(case.response.contacts["ball on middle"], ContactHistory)
    assert case.rated["box"].method.average([60.0, 60.0]) == pytest.approx(60.0, abs=1e-12)  # rounding of a logarithm
    thick = result.cases["thick"]
    assert thick.case.changes == {"parts.plate.thickness": "8 mm"}
    assert thick.levels["box.mic"].l_peak_db == 114.54681315533625
    assert result.verdicts["thick"][0].met is True


READ = """
import sys
from femstruct import read_results
for path in sys.argv[1:]:
    case = read_results(path).cases["thick"]
    print(type(case.response).__module__, case.channels["ball on middle force"].whole)
"""


def test_files_of_then_are_read_after_a_module_was_renamed(frozen: Path, tmp_path: Path) -> None:
    """In a copy of the packages: the file, the imports of it and the table of tags are what a renaming changes."""
    old, new = "impact.response", "impact.what_happened"
    for package in PACKAGES:
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "femstruct" / f"{old.replace('.', '/')}.py").rename(
        tmp_path / "femstruct" / f"{new.replace('.', '/')}.py"
    )
    for path in (tmp_path / "femstruct").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        if old in text:
            path.write_text(
                text.replace(f"femstruct.{old}", f"femstruct.{new}").replace(f'"{old}"', f'"{new}"'), "utf-8"
            )
    (tmp_path / stored_tags.TABLE).write_text(stored_tags.table(tmp_path), encoding="utf-8")
    files = [str(frozen / f"{name}.h5") for name in FROZEN]
    done = subprocess.run(
        [sys.executable, "-c", READ, *files],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path), "PYTHONDONTWRITEBYTECODE": "1"},
    )
    assert done.stdout.splitlines() == [f"femstruct.{new} 31.814197137765714"] * 2, done.stderr


def test_enumerations_keep_the_names_of_their_members() -> None:
    """A member is stored by its name: one that gets another makes a new version of the enumeration."""
    kinds = [kind for kind in map(kind_of, MODULES) if isinstance(kind, type) and issubclass(kind, Enum)]
    assert {tag_of(kind): [one.name for one in kind] for kind in kinds} == MEMBERS
