"""Docstrings have the sections of numpydoc, so that tools and editors show what each argument is."""

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCES = [path for package in ("femstruct", "acoustics") for path in sorted((ROOT / package).rglob("*.py"))]
SECTIONS = ("Parameters", "Returns", "Yields", "Raises", "Notes", "References", "Examples")
HEADING = re.compile(r"^(\w+)\n-+$", re.MULTILINE)


def described(path: Path) -> Iterator[tuple[ast.FunctionDef, list[str], str]]:
    """Public functions that have a docstring, the names of their arguments, and it."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef) and node.name[0] != "_" and (text := ast.get_docstring(node)):
            of = node.args
            every = [*of.posonlyargs, *of.args, of.vararg, *of.kwonlyargs, of.kwarg]
            yield node, [one.arg for one in every if one], text


def parameters(text: str) -> list[str]:
    """Names of the section Parameters."""
    found = re.search(r"^Parameters\n-+\n(.*?)(?=\n\n\w+\n-+\n|\Z)", text, re.MULTILINE | re.DOTALL)
    heads = re.findall(r"^([\w*, ]+?)(?: :|$)", found[1], re.MULTILINE) if found else []
    return [name.strip("* ") for head in heads for name in head.split(",") if not head.startswith(" ")]


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_arguments_are_described_in_sections(path: Path) -> None:
    wrong = []
    for node, names, text in described(path):
        listed = parameters(text)
        inline = re.search(rf"(?:^|[.;] )(?:{'|'.join(map(re.escape, names)) or '$^'})(?: \[[^\]]*\])? : ", text, re.M)
        if inline and not listed:
            wrong.append(f"{node.name}: arguments in running text")
        if listed != [name for name in names if name in listed]:
            wrong.append(f"{node.name}: {listed} are not its arguments in their order")
        headings = [heading for heading in HEADING.findall(text) if heading in SECTIONS]
        if headings != sorted(headings, key=SECTIONS.index):
            wrong.append(f"{node.name}: sections in the order {headings}")
    assert not wrong, f"write numpydoc sections in the order {SECTIONS}: {wrong}"


@cache
def known_names() -> frozenset[str]:
    """Identifiers of the packages, words of their texts (keys of files and of answers), and names of files."""
    names = {part for path in ROOT.rglob("*.py") for part in (path.stem, path.parent.name)}
    for path in SOURCES:
        for token in tokenize.generate_tokens(io.StringIO(path.read_text(encoding="utf-8")).readline):
            if token.type == tokenize.NAME:
                names.add(token.string)
            elif token.type == tokenize.STRING and not token.string.endswith('"""'):
                names.update(re.findall(r"\w+", token.string))
    return frozenset(names)


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_names_in_back_quotes_exist(path: Path) -> None:
    """What a docstring or comment sends its reader to is there: `a.dotted.name` or `a_name_with_underscores`."""
    wrong = []
    for token in tokenize.generate_tokens(io.StringIO(path.read_text(encoding="utf-8")).readline):
        if token.type == tokenize.COMMENT or (token.type == tokenize.STRING and token.string.endswith('"""')):
            for name in re.findall(r"(?<!`)`([A-Za-z]\w*(?:\.\w+)*)`(?!`)", token.string):
                named = "." in name or "_" in name
                if named and not set(name.removesuffix(".py").split(".")) <= known_names():
                    wrong.append(f"line {token.start[0]}: {name}")
    assert not wrong, f"these names are not there any more: {wrong}"
