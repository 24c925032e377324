"""Words that a reader in a second language has to guess stand in no message, help text or document, and in no name of a
function, class, variable, field or module: docs/terms.md."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TERMS = ROOT / "docs" / "terms.md"
HEADING = "## Words that are not used\n"
HEADING_OF_NAMES = "## Words that are not used in names\n"
ALLOWED = Path(__file__).with_name("words_in_names.txt")
MOST_ALLOWED = 176  # entries: less whenever one is gone
PAGES = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")]
SOURCES = [path for package in ("femstruct", "acoustics") for path in sorted((ROOT / package).rglob("*.py"))]


def avoided() -> dict[str, str]:
    """What to write instead, by the words of the table; a number stands for any number."""
    return {word: right for left, right in rows_below(HEADING) for word in left.split(", ")}


def rows_below(heading: str) -> list[list[str]]:
    """The cells of the table below a heading of docs/terms.md."""
    section = TERMS.read_text(encoding="utf-8").split(heading)[1].split("\n## ")[0]
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in section.splitlines() if line.startswith("|")]
    return rows[2:]


PATTERNS = {re.compile(rf"\b{re.sub('[0-9]+', '[0-9]+', word)}\b", re.IGNORECASE): word for word in avoided()}


def words_in(text: str) -> list[str]:
    return [word for pattern, word in PATTERNS.items() if pattern.search(text)]


def is_help(path: Path, node: ast.AST) -> bool:
    """Whether users read a docstring: the help of a command, or what the schema shows in an editor."""
    if isinstance(node, ast.FunctionDef):
        return path.name == "cli.py" and not node.name.startswith("_")
    return isinstance(node, ast.ClassDef) and node.name.endswith("Spec")


def messages(path: Path) -> Iterator[tuple[int, str]]:
    """Lines and texts of the strings of a source file that have several words; of docstrings those that users read."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    within = {id(part) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for part in ast.walk(node)}
    docstrings = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            parts = (part.value if isinstance(part, ast.Constant) else "..." for part in node.values)
            yield node.lineno, "".join(map(str, parts))
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in within | docstrings:
            yield node.lineno, node.value
        elif is_help(path, node):
            assert isinstance(node, ast.FunctionDef | ast.ClassDef)
            yield node.lineno, ast.get_docstring(node) or ""


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_messages_use_the_terms_of_the_field(path: Path) -> None:
    found = [(line, words_in(text)) for line, text in messages(path) if len(text.split()) > 2]
    told = [f"{path.relative_to(ROOT)}:{line}: {', '.join(words)}" for line, words in found if words]
    assert not told, f"docs/terms.md says what to write instead: {told}"


DOCUMENTS = [*PAGES, *sorted((ROOT / "docs").glob("*.md")), *sorted((ROOT / "models").glob("*.yaml"))]


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)
def test_documents_use_the_terms_of_the_field(path: Path) -> None:
    lines = re.sub("`[^`\n]*`", "CODE", path.read_text(encoding="utf-8").split(HEADING)[0]).splitlines()
    told = [f"{path.name}:{number}: {words}" for number, line in enumerate(lines, 1) if (words := words_in(line))]
    assert not told, f"docs/terms.md says what to write instead: {told}"


def test_the_table_is_read() -> None:
    assert len(PATTERNS) > 30
    assert avoided()["told"] == "reported; the message states"
    assert words_in("Some 15 seconds; the finding is told.") == ["told", "some 10"]
    assert not words_in("The finding is reported after about 15 seconds.")


def avoided_in_names() -> tuple[set[str], list[str]]:
    """Words that names do not have, and what has such a word and is a term of the field all the same."""
    rows = rows_below(HEADING_OF_NAMES)
    return {word for left, _, _ in rows for word in left.split(", ")}, [
        term for _, _, stays in rows for term in stays.split(", ") if term
    ]


AVOIDED, STAYS = avoided_in_names()


def is_avoided(name: str) -> bool:
    """Whether a name has such a word: words end at underscores and before capitals."""
    words = " ".join(re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])", name)).lower()
    for term in STAYS:
        words = re.sub(rf"\b{term}\b", "", words)
    return not AVOIDED.isdisjoint(words.split())


def names_given(path: Path) -> set[str]:
    """Names that a source file gives to functions, classes, arguments, variables and fields, and its own."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    given = {path.stem}
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            given.add(node.name)
        elif isinstance(node, ast.arg):
            given.add(node.arg)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            given.add(node.id)
    return given


def test_names_use_the_terms_of_the_field() -> None:
    """What is older is in a list that gets shorter: an entry that is no longer needed has to go, and none is added."""
    lines = ALLOWED.read_text(encoding="utf-8").splitlines()
    found = {f"{path.relative_to(ROOT).as_posix()} {name}" for path in SOURCES for name in names_given(path)}
    found = {entry for entry in found if is_avoided(entry.split()[1])}
    assert not found - set(lines), f"docs/terms.md says what to write instead: {sorted(found - set(lines))}"
    assert not set(lines) - found, f"{ALLOWED.name} need no longer have: {sorted(set(lines) - found)}"
    assert len(lines) <= MOST_ALLOWED and lines == sorted(set(lines))


def test_names_are_read_by_their_words() -> None:
    assert is_avoided("told_of") and is_avoided("HeardRooms") and is_avoided("_TOLD") and is_avoided("rest")
    assert not is_avoided("at_rest") and not is_avoided("AtRest") and not is_avoided("restitution")
    assert not is_avoided("two_way_absorption") and is_avoided("two_ways")


def test_every_comparison_of_the_documents_is_a_test():
    page = (ROOT / "docs" / "validation.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`(tests/[^`]+)`", page))
    assert len(named) > 10 and all((ROOT / name).exists() for name in named)
