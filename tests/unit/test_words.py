"""Words that a reader in a second language has to guess stand in no message, help text or document: docs/terms.md."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TERMS = ROOT / "docs" / "terms.md"
HEADING = "## Words that are not used"
PAGES = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")]
SOURCES = [path for package in ("femstruct", "acoustics") for path in sorted((ROOT / package).rglob("*.py"))]


def avoided() -> dict[str, str]:
    """What to write instead, by the words of the table; a number stands for any number."""
    rows = [line.split("|")[1:3] for line in TERMS.read_text(encoding="utf-8").split(HEADING)[1].splitlines()]
    table = {word.strip(): right.strip() for left, right in filter(None, rows) for word in left.split(",")}
    return {word: right for word, right in table.items() if word not in ("not", "---")}


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


def test_every_comparison_of_the_documents_is_a_test():
    page = (ROOT / "docs" / "validation.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`(tests/[^`]+)`", page))
    assert len(named) > 10 and all((ROOT / name).exists() for name in named)
