"""Examples of what is exported, as a user copies them: with the names of femstruct and numpy, and what they import."""

from __future__ import annotations

import ast
import builtins
import doctest

import pytest

import femstruct

EXAMPLES = {
    name: doctest.script_from_examples(doc)
    for name in femstruct.__all__
    if ">>>" in (doc := getattr(femstruct, name).__doc__ or "")
}
KNOWN = {*femstruct.__all__, *dir(builtins), "np"}


@pytest.mark.parametrize("name", sorted(EXAMPLES))
def test_an_example_needs_no_names_of_the_module_it_stands_in(name: str) -> None:
    nodes = list(ast.walk(ast.parse(EXAMPLES[name])))
    made = {one.id for one in nodes if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)}
    made |= {one.arg for one in nodes if isinstance(one, ast.arg)}
    made |= {one.name for one in nodes if isinstance(one, ast.FunctionDef | ast.ClassDef)}
    made |= {one.asname or one.name.partition(".")[0] for one in nodes if isinstance(one, ast.alias)}
    read = {one.id for one in nodes if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Load)}
    assert read - made - KNOWN == set()
