"""How large the house is, and how its rooms hang together: `python scripts/counts.py` prints a count a line.

Of the packages: files, folders, folders that import each other (every import statement counted), lines of imports,
modules that one other module imports, long functions, branches of the most complex ones, class names that mean two
things, statements. Of the tests: how many module paths they import. None is a goal in itself; they show a trend.
"""

import ast
from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path

TOP = Path(__file__).resolve().parents[1]
PACKAGES = ("femstruct", "acoustics")
_BRANCHES = (ast.If, ast.IfExp, ast.For, ast.While, ast.ExceptHandler, ast.With, ast.Assert, ast.comprehension)
LONG = 80  # lines of a function beside its docstring
COMPLEX = 25  # ways through a function, by McCabe's count


def sources(*tops: str) -> dict[str, ast.Module]:
    """Modules by name."""
    found = {}
    for path in sorted(path for top in tops for path in (TOP / top).rglob("*.py")):
        name = ".".join(path.relative_to(TOP).with_suffix("").parts).removesuffix(".__init__")
        found[name] = ast.parse(path.read_text(encoding="utf-8"))
    return found


def imported(tree: ast.Module, known: dict[str, ast.Module]) -> Iterator[str]:
    """Modules of the packages that a module imports, anywhere in it."""
    for node in ast.walk(tree):
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        if isinstance(node, ast.ImportFrom):
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        for name in names:
            while name and name not in known:
                name = name.rpartition(".")[0]
            if name not in ("", *PACKAGES):
                yield name


def complexity(function: ast.FunctionDef) -> int:
    """Ways through a function: 1, and one more for each branch and each further operand of `and` and `or`."""
    nodes = list(ast.walk(function))
    more = sum(len(node.values) - 1 for node in nodes if isinstance(node, ast.BoolOp))
    return 1 + more + sum(isinstance(node, _BRANCHES) for node in nodes)


def counts() -> dict[str, str]:
    """Each count, as it is printed."""
    modules = sources(*PACKAGES)
    texts = {name: ast.unparse(tree) for name, tree in modules.items()}
    arrows = {(a, b) for a, tree in modules.items() for b in imported(tree, modules) if a not in PACKAGES and a != b}
    importers = Counter(b for _, b in arrows)
    folder = {name: name.rpartition(".")[0] for name in modules}
    pairs = {(folder[a], folder[b]) for a, b in arrows if folder[a] != folder[b] and folder[a] not in PACKAGES}
    nodes = [node for tree in modules.values() for node in ast.walk(tree)]
    functions = [node for node in nodes if isinstance(node, ast.FunctionDef)]
    imports = [node for node in nodes if isinstance(node, ast.Import | ast.ImportFrom)]
    lines = sum((TOP / _path(name)).read_text(encoding="utf-8").count("\n") for name in modules)
    classes: dict[str, set[str]] = defaultdict(set)
    for name, tree in modules.items():
        for node in tree.body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                classes[node.name].add(name)
    tests = {module for tree in sources("tests").values() for module in imported(tree, modules)}
    several = sorted(name for name, where in classes.items() if len(where) > 1)
    import_lines = sum((node.end_lineno or 0) - node.lineno + 1 for node in imports)
    long = [one for one in functions if _length(one) > LONG]
    return {
        "source files": str(len([name for name, text in texts.items() if text.count("\n") > 0])),
        "folders": str(len({where for where in folder.values() if where})),
        "folders that import each other": str(
            len([pair for pair in pairs if pair < pair[::-1] and pair[::-1] in pairs])
        ),
        "lines": str(lines),
        "lines of imports": f"{import_lines} ({import_lines / lines:.1%})",
        "modules with one importer": str(sum(count == 1 for count in importers.values())),
        f"functions over {LONG} lines without docstring": " ".join([str(len(long)), *(one.name for one in long)]),
        f"functions of more than {COMPLEX} ways": " ".join(
            f"{one.name} {complexity(one)}" for one in functions if complexity(one) > COMPLEX
        )
        or "0",
        "class names that mean two things": " ".join([str(len(several)), *several]),
        "statements": str(sum(isinstance(node, ast.stmt) for node in nodes)),
        "module paths that tests import": str(len(tests)),
    }


def _path(name: str) -> str:
    plain = name.replace(".", "/")
    return f"{plain}/__init__.py" if (TOP / plain / "__init__.py").exists() else f"{plain}.py"


def _length(function: ast.FunctionDef) -> int:
    """Lines of a function beside its docstring."""
    first, described = function.body[0], ast.get_docstring(function) is not None
    docstring = (first.end_lineno or first.lineno) - first.lineno + 1 if described else 0
    return (function.end_lineno or function.lineno) - function.lineno + 1 - docstring


if __name__ == "__main__":
    for what, count in counts().items():
        print(f"{what:41} {count}")
