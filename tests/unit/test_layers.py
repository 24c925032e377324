"""Imports go down only: the order of the house, held by reading every import statement."""

import ast
import re
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

import femstruct
from femstruct.laws.registry import LAWS

ROOT = Path(__file__).parents[2]

# Folders, and modules in none. Each imports from earlier lines alone; two of one line do not know each other.
LAYERS = [
    ["conventions", "reported", "tags"],
    ["errors"],
    ["arrays", "exits", "findings", "plugins", "units", "templates"],
    ["quantities"],
    ["declared", "elements", "sparse"],
    ["evaluations", "model"],
    ["assembly", "parts"],
    ["modal"],
    ["compiled"],
    ["laws"],
    ["impact"],
    ["sound"],
    ["study"],
    ["files"],
    ["decks", "yaml"],
    ["language"],
    ["view"],
    ["workflow"],
    ["campaign"],
    ["commands"],
    ["cli"],
    ["__main__"],
]
ACOUSTICS = [
    ["reported", "tags"],
    ["errors"],
    ["arrays"],
    ["air", "losses", "receivers", "source"],
    ["room_response"],
    ["rooms"],
    ["meshed", "open_air"],
    ["fields"],
    ["levels"],
]
HEARS_ACOUSTICS = {
    "sound",
    "study",
    "language",
    "files",
    "yaml",
    "view",
    "workflow",
    "campaign",
    "exits",
    "commands",
}
OPENS_FILES = {"h5py", "pyvista", "matplotlib", "pydantic", "ruamel", "meshio", "rich", "typer"}


def modules(package: str) -> list[Path]:
    return sorted((ROOT / package).rglob("*.py"))


def name_of(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def imports(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def layer_of(name: str) -> tuple[int, str]:
    """Line and entry of a module, `femstruct.modal.frf` being of `modal`."""
    package, member = name.split(".")[:2]
    for number, layer in enumerate(LAYERS if package == "femstruct" else ACOUSTICS):
        if member in layer:
            return number, member
    raise AssertionError(f"{name} is in no layer: give it one in this test and in docs/architecture.md")


@pytest.mark.parametrize("path", modules("femstruct") + modules("acoustics"), ids=name_of)
def test_imports_go_down(path: Path) -> None:
    name = name_of(path)
    if name in ("femstruct", "acoustics"):  # they give what all others have
        return
    layer, member = layer_of(name)
    for imported in imports(path):
        package = imported.split(".")[0]
        if package == name.split(".")[0]:
            other, beside = layer_of(imported)
            assert other < layer or beside == member, f"{name} imports {imported} from above or beside it"
        elif package == "acoustics":
            assert member in HEARS_ACOUSTICS, f"{name} imports {imported}"
        else:
            assert package != "femstruct", f"{name} imports {imported}"


def test_modules_of_a_folder_form_no_circle() -> None:
    """What is imported when a module is: statements at its top that are not for the type checker alone."""
    needs = {name_of(path): _needed_at_once(path) for path in modules("femstruct") + modules("acoustics")}
    known = {name: {found for one in used if (found := _module(one, needs)) and found != name} for name, used in
             needs.items()}  # fmt: skip
    left = {name: used for name, used in known.items() if name not in ("femstruct", "acoustics")}
    while ready := {name for name, used in left.items() if not used & set(left)}:
        left = {name: used for name, used in left.items() if name not in ready}
    assert not left, f"modules that need each other: {sorted(left)}"


def _needed_at_once(path: Path) -> set[str]:
    found = set()
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ImportFrom):
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def _module(imported: str, known: Mapping[str, object]) -> str | None:
    if imported in known:
        return imported
    above = imported.rpartition(".")[0]
    return above if above in known and above not in ("femstruct", "acoustics") else None


def test_folders_are_one_level_deep() -> None:
    folders = {p.parent.relative_to(ROOT).as_posix() for p in modules("femstruct") + modules("acoustics")}
    assert {folder for folder in folders if folder.count("/") > 1} == set()


@pytest.mark.parametrize("path", modules("femstruct") + modules("acoustics"), ids=name_of)
def test_lower_layers_open_no_file_and_draw_nothing(path: Path) -> None:
    upper = {"language", "yaml", "decks", "files", "view", "workflow", "commands", "cli"}
    parts = name_of(path).split(".")
    if len(parts) > 1 and parts[0] == "femstruct" and parts[1] in upper:
        return
    used = {imported.split(".")[0] for imported in imports(path)} & OPENS_FILES
    assert not used, f"{name_of(path)} imports {used}"


def test_the_page_of_the_architecture_is_up_to_date() -> None:
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    blocks = [block.split("```")[0] for block in page.split("```text\n")[1:]]
    assert [[layer.split() for layer in block.split("|")] for block in blocks] == [LAYERS, ACOUSTICS]
    importers = page.split("Of `femstruct`, only ")[1].split(" import it")[0]
    assert set(re.findall(r"`(.*?)`", importers)) == HEARS_ACOUSTICS
    folders = {p.parent.relative_to(ROOT).as_posix() for p in modules("femstruct") + modules("acoustics")}
    listed = set(re.findall(r"^\| `((?:femstruct|acoustics)/\w+)` \|", page, re.MULTILINE))
    assert listed == {folder for folder in folders if "/" in folder}


def test_import_loads_no_heavy_library() -> None:
    code = "import femstruct, sys; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT).stdout
    heavy = {
        "h5py",
        "xarray",
        "h5netcdf",
        "pyvista",
        "matplotlib",
        "pydantic",
        "ruamel",
        "numba",
        "scipy",
        "numpy",
    } & set(loaded.split())
    assert not heavy, f"import femstruct loads {heavy}"


def test_help_loads_nothing_but_the_command_line() -> None:
    """What makes `--help` answer in 0.3 s of CPU: nothing from numpy upward is loaded (a clock here would be noise)."""
    code = "import atexit, sys, femstruct.cli; sys.argv = ['femstruct', '--help']\n"
    code += "atexit.register(lambda: print('loaded', *sys.modules))\nfemstruct.cli.main()"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT).stdout
    assert "Commands" in told
    loaded = {name.split(".")[0] for name in told.split("loaded", 1)[1].split()}
    assert not loaded & {"numpy", "scipy", "numba", "h5py", "pyvista", "matplotlib", "pydantic", "ruamel"}


def test_modes_load_nothing_of_impacts_or_results() -> None:
    """A third of what `femstruct modes` takes to start would be nouns that it does not use."""
    code = "import sys, femstruct.workflow.modes; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT).stdout
    others = ("femstruct.impact", "femstruct.study.results", "xarray", "h5netcdf", "h5py", "xlsxwriter")
    found = [name for name in loaded.split() if name.startswith(others)]
    assert not found


def test_tables_for_the_terminal_load_no_plots() -> None:
    """`impact` and `sound` draw nothing: matplotlib would be half of what their start takes."""
    code = "import sys, femstruct.view.terminal; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT).stdout
    assert not {"matplotlib", "pyvista"} & set(loaded.split())


def _decorator(node: ast.expr) -> str:
    return ast.unparse(node.func if isinstance(node, ast.Call) else node)


def test_every_noun_of_a_model_and_of_a_study_is_exported() -> None:
    """Whoever writes a study in Python finds all of it in `femstruct`."""
    files = [ROOT / "femstruct" / "study" / name for name in ("acting.py", "asked.py", "study.py", "structures.py")]
    files += [
        ROOT / "femstruct" / "model" / f"{name}.py"
        for name in ("structure", "materials", "lay_ups", "sections", "regions")
    ]
    nouns = {
        node.name
        for path in (*files, *(ROOT / "femstruct" / "parts").glob("*.py"))
        for node in ast.parse(path.read_text(encoding="utf-8")).body
        if isinstance(node, ast.ClassDef) and "checked" in {_decorator(one) for one in node.decorator_list}
    }
    nouns |= {law.__name__ for law in LAWS if law.__module__.startswith("femstruct.")}
    assert nouns <= set(femstruct.__all__), nouns - set(femstruct.__all__)


def test_public_names_come_from_where_the_type_checker_looks() -> None:
    """The lists for people who type-check and for those who run are two; each name must be in both."""
    looked_up = {name for name in imports(ROOT / "femstruct/__init__.py") if name.startswith("femstruct.")}
    assert looked_up == {f"{femstruct._HOMES[name]}.{name}" for name in femstruct.__all__}
    assert all(getattr(femstruct, name).__doc__ for name in femstruct.__all__)
    with pytest.raises(AttributeError, match="no attribute 'fly'"):
        femstruct.fly  # noqa: B018


def test_every_package_is_installed() -> None:
    """setuptools finds packages by their `__init__.py`: a folder without one works from a checkout alone."""
    folders = {path.parent for path in modules("femstruct") + modules("acoustics")}
    assert [folder for folder in folders if not (folder / "__init__.py").exists()] == []


# What both packages have because neither may import the other, and what Python runs by name.
IN_BOTH_PACKAGES = {"arrays.py", "errors.py", "reported.py", "tags.py", "__main__.py", "__init__.py"}


def test_a_file_name_has_one_meaning() -> None:
    """One noun may have its file where it lives, in `elements` and in `language`; nothing else shares a name."""
    homes: dict[str, list[str]] = {}
    for path in modules("femstruct") + modules("acoustics"):
        folder = path.parent.relative_to(ROOT).as_posix()
        if path.name not in IN_BOTH_PACKAGES and not folder.startswith(("femstruct/language", "femstruct/elements")):
            homes.setdefault(path.name, []).append(folder)
    assert {name: folders for name, folders in homes.items() if len(folders) > 1} == {}
    language = [path.name for path in modules("femstruct/language") if path.name != "__init__.py"]
    assert len(language) == len(set(language))


LONGEST = 80  # lines of a function beside its docstring


@pytest.mark.parametrize("path", modules("femstruct") + modules("acoustics"), ids=name_of)
def test_no_function_is_too_long_to_be_read_at_once(path: Path) -> None:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef):
            words = len((ast.get_docstring(node, clean=False) or "").splitlines())
            lines = (node.end_lineno or node.lineno) - node.lineno + 1 - words
            assert lines <= LONGEST, f"{node.name} has {lines} lines"
