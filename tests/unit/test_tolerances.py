"""A tolerance has a reason: rounding, discretisation, digits that are printed, steps. Without one nobody can tell a
tolerance that is too wide from one that is right.

A tolerance is a number below 0.5 after rel=, abs=, rtol= or atol=, or one below 0.001 after < or <= in an assert.
Its reason is a comment in its statement, alone on the line above, or at the constant that names it; one for a number
holds in the whole test, and so does the docstring of the test where it names that number.
"""

import ast
import io
import re
import tokenize
from collections.abc import Iterable, Iterator
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
COMPARE = {"approx", "isclose", "allclose", "assert_allclose"}
KEYWORDS = {"rel", "abs", "rtol", "atol"}


def small_numbers(node: ast.AST, below: float) -> list[ast.Constant]:
    found = [one for one in ast.walk(node) if isinstance(one, ast.Constant) and isinstance(one.value, float)]
    return [one for one in found if 0.0 < one.value < below]


def only_numbers(node: ast.AST) -> bool:
    parts = (ast.Constant, ast.BinOp, ast.operator)
    return bool(small_numbers(node, 0.5)) and all(isinstance(part, parts) for part in ast.walk(node))


def tolerances(statement: ast.stmt) -> Iterator[tuple[ast.expr, list[ast.Constant]]]:
    """Expressions that say how far off is near enough, with their numbers."""
    for node in ast.walk(statement):
        if isinstance(node, ast.Call) and ast.unparse(node.func).split(".")[-1] in COMPARE:
            given = (keyword.value for keyword in node.keywords if keyword.arg in KEYWORDS)
            yield from ((one, small_numbers(one, 0.5)) for one in given)
        if isinstance(node, ast.Compare) and isinstance(statement, ast.Assert):
            bounds = zip(node.ops, node.comparators, strict=True)
            yield from ((one, small_numbers(one, 1e-3)) for op, one in bounds if isinstance(op, ast.Lt | ast.LtE))


def without_reason(text: str) -> list[str]:
    """Tolerances of a file that have no reason, as 'line: number or name'."""
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    commented = {
        token.start[0]: token.line.lstrip().startswith("#") for token in tokens if token.type == tokenize.COMMENT
    }
    tree = ast.parse(text)

    def named(statements: Iterable[ast.AST]) -> dict[str, ast.stmt]:
        """Statements that give a number a name."""
        found = [node for node in statements if isinstance(node, ast.Assign) and only_numbers(node.value)]
        return {target.id: node for node in found for target in node.targets if isinstance(target, ast.Name)}

    def reasoned(statement: ast.stmt) -> bool:
        lines = range(statement.lineno, (statement.end_lineno or 0) + 1)
        return any(line in commented for line in lines) or commented.get(statement.lineno - 1, False)

    missing = []
    tests = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    for test in tests:
        told, asked, names = ast.get_docstring(test) or "", [], named(tree.body) | named(ast.walk(test))
        for statement in (node for node in ast.walk(test) if isinstance(node, ast.stmt) and not hasattr(node, "body")):
            for tolerance, found in tolerances(statement):
                used = [] if found else [node.id for node in ast.walk(tolerance) if isinstance(node, ast.Name)]
                missing += [f"{names[n].lineno}: {n}" for n in used if n in names and not reasoned(names[n])]
                numbers = [ast.get_source_segment(text, number) or "" for number in found]
                if reasoned(statement):
                    told = " ".join((told, *numbers))
                asked += [(statement.lineno, number) for number in numbers]
        missing += [
            f"{line}: {number}"
            for line, number in asked
            if not re.search(rf"(?<![\w.]){re.escape(number)}(?!\w)", told)
        ]
    return sorted(set(missing))


@pytest.mark.parametrize(
    "path",
    sorted(TESTS.rglob("test_*.py")),
    ids=lambda path: f"{path.parent.name}/{path.stem}",
)
def test_tolerances_have_reasons(path: Path) -> None:
    assert without_reason(path.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(
    ("lines", "missing"),
    [
        (["assert a == approx(1.0, rel=1e-9)"], ["2: 1e-9"]),
        (["assert a == approx(1.0, rel=1e-9)  # rounding"], []),
        (["# rounding", "assert a == approx(1.0, rel=1e-9)"], []),
        (["a = 1.0  # metres", "assert a == approx(1.0, rel=1e-9)"], ["3: 1e-9"]),
        (["assert a < 1e-9 * b", "assert a < 0.1"], ["2: 1e-9"]),
        (["assert a < 1e-9 * b  # rounding", "assert b < 1e-9", "assert b < 1e-8"], ["4: 1e-8"]),
        (['"""Within 1e-9, rounding."""', "assert a < 1e-9"], []),
        (["near = 1e-9", "assert a == approx(b, rel=near)"], ["2: near"]),
        (["near = 1e-9  # rounding", "assert a == approx(b, rel=near)"], []),
        (["np.testing.assert_allclose(a, b, rtol=0, atol=0.02)"], ["2: 0.02"]),
    ],
)
def test_what_counts_as_a_reason(lines: list[str], missing: list[str]) -> None:
    assert without_reason("\n    ".join(["def test():", *lines])) == missing
