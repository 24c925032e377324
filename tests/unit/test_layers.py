"""Imports go down only: the order of the house, held by reading every import statement."""

import ast
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import femstruct
from femstruct.impact.laws.registry import LAWS

ROOT = Path(__file__).parents[2]

# A module may import from lower layers, and from names of its own layer to its left.
LAYERS = [
    [
        "femstruct.conventions",
        "femstruct.tags",
        "femstruct.errors",
        "femstruct.findings",
        "femstruct.arrays",
        "femstruct.dimensions",
        "femstruct.units",
        "femstruct.declared",
        "femstruct.reported",
        "femstruct.plugins",
    ],
    ["femstruct.sparse", "femstruct.elements", "femstruct.model", "femstruct.parts"],
    ["femstruct.assembly"],
    ["femstruct.modal"],
    ["femstruct.impact"],
    ["femstruct.sound"],
    ["femstruct.study"],
    ["femstruct.files.inputs", "femstruct.language.yaml", "femstruct.language", "femstruct.files", "femstruct.view"],
    ["femstruct.workflow"],
    ["femstruct.campaign"],
    ["femstruct.exits", "femstruct.commands", "femstruct.cli"],
    ["femstruct.__main__"],
]
ACOUSTICS = [
    [
        "acoustics.tags",
        "acoustics.errors",
        "acoustics.arrays",
        "acoustics.reported",
        "acoustics.air",
        "acoustics.losses",
        "acoustics.receivers",
        "acoustics.room_response",
        "acoustics.source",
        "acoustics.rooms.box",
        "acoustics.meshed.walls",
    ],
    [
        "acoustics.rooms.continuation",
        "acoustics.rooms.box_transfer",
        "acoustics.rooms.by_wall.box_walls",
        "acoustics.meshed.cavity_mesh",
        "acoustics.meshed.finite_elements",
        "acoustics.meshed.yielding_walls",
        "acoustics.meshed.cut_box",
    ],
    [
        "acoustics.rooms.cosine_orders",
        "acoustics.rooms.room_advice",
        "acoustics.meshed.absorbing_walls",
        "acoustics.meshed.coupled_wall_modes",
        "acoustics.meshed.reverberation",
        "acoustics.rooms.cosine_sums",
        "acoustics.rooms.box_pressure",
        "acoustics.rooms.kept_transfers",
        "acoustics.meshed.meshed_pressure",
        "acoustics.rooms.pressure_maps",
        "acoustics.rooms.box_harmonic",
        "acoustics.rooms.by_wall.wall_sums",
        "acoustics.rooms.box_two_way",
        "acoustics.cavities.equivalent_fluid",
        "acoustics.cavities.cavity",
        "acoustics.cavities.layer_fields",
        "acoustics.cavities.cavity_air",
        "acoustics.cavities.condensed",
        "acoustics.cavities.several",
        "acoustics.rooms.by_wall.walls_two_way",
        "acoustics.rooms.by_wall.wall_loads",
        "acoustics.rooms.by_wall.wall_powers",
        "acoustics.meshed.meshed_two_way",
        "acoustics.open_air.baffle",
        "acoustics.open_air.rayleigh",
        "acoustics.open_air.multipoles",
        "acoustics.open_air.sphere",
        "acoustics.open_air.sheet",
        "acoustics.open_air.radiated_power",
        "acoustics.open_air.directivity",
        "acoustics.rooms.receiver_grids",
        "acoustics.rooms.room_ways",
    ],
    ["acoustics.fields.returned", "acoustics.fields.sound_field", "acoustics.fields"],
    [
        "acoustics.levels.bands",
        "acoustics.levels.ending",
        "acoustics.levels.decibels",
        "acoustics.levels.filters",
        "acoustics.levels.weighting",
        "acoustics.levels.sound_levels",
        "acoustics.levels.iso",
        "acoustics.levels.jis_ks",
        "acoustics.levels.decay",
        "acoustics.levels.exposure",
        "acoustics.levels.single_number",
        "acoustics.levels.methods",
        "acoustics.statistical",
        "acoustics.levels.line_levels",
        "acoustics.levels.ensemble",
        "acoustics.levels.rated",
        "acoustics.open_air.sound_energy",
    ],
]
HEARS_ACOUSTICS = {
    "sound",
    "study",
    "language",
    "files",
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


def place(name: str, layers: list[list[str]]) -> tuple[int, int]:
    for i, layer in enumerate(layers):
        for j, member in enumerate(layer):
            if name == member or name.startswith(member + "."):
                return i, j
    raise AssertionError(f"{name} is in no layer: give it one in this test and in docs/architecture.md")


@pytest.mark.parametrize("path", [p for p in modules("femstruct") if name_of(p) != "femstruct"], ids=name_of)
def test_femstruct_imports_go_down(path: Path) -> None:
    layer, column = place(name_of(path), LAYERS)
    for imported in imports(path):
        if imported.startswith("femstruct."):
            other_layer, other_column = place(imported, LAYERS)
            down = other_layer < layer or (other_layer == layer and other_column <= column)
            assert down, f"{name_of(path)} imports {imported} from above or beside it"
        if imported.split(".")[0] == "acoustics":
            assert name_of(path).split(".")[1] in HEARS_ACOUSTICS, f"{name_of(path)} imports {imported}"


@pytest.mark.parametrize("path", [p for p in modules("acoustics") if p.name != "__init__.py"], ids=name_of)
def test_acoustics_imports_go_down(path: Path) -> None:
    layer, column = place(name_of(path), ACOUSTICS)
    for imported in imports(path):
        assert not imported.startswith("femstruct"), f"{name_of(path)} imports {imported}"
        if imported.startswith("acoustics."):
            other_layer, other_column = place(imported, ACOUSTICS)
            assert (other_layer, other_column) <= (layer, column), f"{name_of(path)} imports {imported}"


@pytest.mark.parametrize("path", modules("femstruct") + modules("acoustics"), ids=name_of)
def test_lower_layers_open_no_file_and_draw_nothing(path: Path) -> None:
    upper = {"language", "files", "view", "workflow", "commands", "cli"}
    parts = name_of(path).split(".")
    if len(parts) > 1 and parts[0] == "femstruct" and parts[1] in upper:
        return
    used = {imported.split(".")[0] for imported in imports(path)} & OPENS_FILES
    assert not used, f"{name_of(path)} imports {used}"


def test_the_page_of_the_architecture_is_up_to_date() -> None:
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    block = page.split("```text\n")[1].split("```")[0]
    assert [line.split() for line in block.splitlines()] == [[m.split(".", 1)[1] for m in layer] for layer in LAYERS]
    importers = page.split("Of `femstruct`, only ")[1].split(" import it")[0]
    assert set(re.findall(r"`(.*?)`", importers)) == HEARS_ACOUSTICS
    folders = {str(p.parent.relative_to(ROOT)) for name in ("femstruct", "acoustics") for p in modules(name)}
    assert {f for f in folders if f"| `{f}` |" not in page and "/" in f} == set(), "folders without a line"
    listed = set(re.findall(r"^\| `((?:femstruct|acoustics)/[\w/]+)` \|", page, re.MULTILINE))
    assert listed <= folders, "lines without a folder"


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
    code = "import sys, femstruct.workflow.check.asked_modes; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT).stdout
    others = ("femstruct.impact", "femstruct.study.result", "xarray", "h5netcdf", "h5py", "xlsxwriter")
    found = [name for name in loaded.split() if name.startswith(others)]
    assert not found


def test_tables_for_the_terminal_load_no_plots() -> None:
    """`impact` and `sound` draw nothing: matplotlib would be half of what their start takes."""
    code = "import sys, femstruct.view.tables.terminal; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT).stdout
    assert not {"matplotlib", "pyvista"} & set(loaded.split())


def test_every_noun_of_a_model_and_of_a_study_is_exported() -> None:
    """Whoever writes a study in Python finds all of it in `femstruct`."""
    files = [ROOT / "femstruct" / "study" / name for name in ("acting.py", "asked.py", "study.py", "structures.py")]
    files += [
        ROOT / "femstruct" / "model" / name for name in ("structure.py", "material.py", "section.py", "region.py")
    ]
    files += [*(ROOT / "femstruct" / "model" / "materials").glob("*.py")]
    nouns = {
        node.name
        for path in (*files, *(ROOT / "femstruct" / "parts").glob("*.py"))
        for node in ast.parse(path.read_text(encoding="utf-8")).body
        if isinstance(node, ast.ClassDef)
        and not node.name.endswith("Mesh")
        and "Protocol" not in [ast.unparse(base) for base in node.bases]
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
    """Packages are listed one by one: a new folder that is left out works from a checkout alone."""
    listed = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]["packages"]
    folders = [path.parent for package in ("femstruct", "acoustics") for path in (ROOT / package).rglob("__init__.py")]
    assert sorted(listed) == sorted(".".join(folder.relative_to(ROOT).parts) for folder in folders)


MOST_FILES = 16  # of a folder: what a reader takes in at a glance
# A file for each kind, found where it is: a new part, law or room splits no folder.
FOLDERS_OF_KINDS = {
    *("femstruct/parts", "femstruct/language/parts", "femstruct/impact/laws", "femstruct/language/laws"),
    *("acoustics/fields", "femstruct/language/rooms"),
}


def test_no_folder_holds_more_files_than_a_reader_takes_in() -> None:
    for package in ("femstruct", "acoustics"):
        for folder in {path.parent for path in modules(package)}:
            if folder.relative_to(ROOT).as_posix() in FOLDERS_OF_KINDS:
                continue
            files = [path.name for path in folder.glob("*.py") if path.name != "__init__.py"]
            assert len(files) <= MOST_FILES, (
                f"{folder.relative_to(ROOT)} holds {len(files)} files: split it by what they do"
            )


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
# A march is one loop: its parts share a dozen arrays and a step, and the compiler takes them as one function.
LONGER = {"march", "exact_march"}


@pytest.mark.parametrize("path", modules("femstruct") + modules("acoustics"), ids=name_of)
def test_no_function_is_too_long_to_be_read_at_once(path: Path) -> None:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef) and node.name not in LONGER:
            words = len((ast.get_docstring(node, clean=False) or "").splitlines())
            lines = (node.end_lineno or node.lineno) - node.lineno + 1 - words
            assert lines <= LONGEST, f"{node.name} has {lines} lines"
