"""Model and study files that somebody spoilt: trees of the shipped ones with values, keys, names and nesting changed.

Loaded with ``runpy``: `shipped(folder)` writes what they need, `spoilt(folder, kind, seed)` one of them; `run_command`
runs the program on it in this process.
"""

from __future__ import annotations

import contextlib
import io
import json
import math
import random
import shutil
from collections.abc import Collection
from functools import cache
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from typer.main import get_command

MODELS = Path(__file__).parents[2] / "models"
NUMBERS: tuple[Any, ...] = (
    0, -1, 1, 0.5, 1e-308, 1e-12, 1e3, 1e9, 1e30, 1e308, math.nan, math.inf, -math.inf, 10**40, 2**63, -0.0,
)  # fmt: skip
OTHERS: tuple[Any, ...] = (
    None, True, "", " ", ".", "none", "1,5 m", "5 kg", "3 Hz", "1e400 m", "-2 mm", "whole", "center", "ground", "~",
    "$\\foo$", "../x.yaml", "/etc/passwd", ".", "\N{SNOWMAN}", "\N{HANGUL SYLLABLE GA}", "\ud800", "a\0b", "a\nb",
    "x" * 5000, [], {}, [[]], {"": ""}, [0, 0, 0], ["1 m", "2 m"], {"type": "plate"}, list(range(300)),
)  # fmt: skip


@cache
def tree_of(name: str) -> Any:
    """A shipped file as a plain tree, its meshes coarse: what is asked is what it says, not how long it takes."""
    return _coarse(YAML(typ="safe", pure=True).load((MODELS / name).read_text(encoding="utf-8")))


def _coarse(tree: Any) -> Any:
    if isinstance(tree, dict):
        made = {str(key): _coarse(value) for key, value in tree.items()}
        if isinstance(mesh := made.get("mesh"), list):
            made["mesh"] = [min(number, 4) if isinstance(number, int) else number for number in mesh]
        elif isinstance(mesh, str) and not mesh.endswith(".msh"):
            made["mesh"] = "0.6 m" if isinstance(made.get("size"), list) else mesh
        return made
    return [_coarse(item) for item in tree] if isinstance(tree, list) else tree


def places(tree: Any, here: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Every path of a tree but its root."""
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    return [path for key, item in items for path in ((*here, key), *places(item, (*here, key)))]


def at(tree: Any, path: tuple[Any, ...]) -> Any:
    for step in path:
        tree = tree[step]
    return tree


def replaced(tree: Any, path: tuple[Any, ...], value: Any) -> Any:
    """The tree with another value at a path."""
    if not path:
        return value
    step, *rest = path
    if isinstance(tree, dict):
        return {key: replaced(item, tuple(rest), value) if key == step else item for key, item in tree.items()}
    return [replaced(item, tuple(rest), value) if key == step else item for key, item in enumerate(tree)]


def without(tree: Any, path: tuple[Any, ...]) -> Any:
    parent = at(tree, path[:-1])
    left = (
        {key: item for key, item in parent.items() if key != path[-1]}
        if isinstance(parent, dict)
        else [item for number, item in enumerate(parent) if number != path[-1]]
    )
    return replaced(tree, path[:-1], left)


def mutated(tree: Any, chance: random.Random) -> tuple[Any, str]:
    """The tree with one thing spoilt, and what."""
    paths = places(tree)
    if not paths:
        return {}, "emptied"
    path, other = chance.choice(paths), chance.choice(paths)
    value = at(tree, path)
    kind = chance.randrange(10)
    if chance.random() < 0.5:  # half of all: a number, most often one that still means something
        numbers = [one for one in paths if _number(at(tree, one)) is not None]
        path = chance.choice(numbers or paths)
        value, kind = at(tree, path), 0
    told = f"{'.'.join(map(str, path))}"
    if kind <= 2:
        factor = chance.choice((-1, 0, 1e-12, 1e-6, 1e-3, 0.1, 0.5, 0.999, 2, 10, 1e3, 1e6, 1e12))
        found = _number(value)
        new = chance.choice(NUMBERS)
        if found is not None and chance.random() < 0.7:
            new = found * factor if isinstance(value, float | str) or factor < 1 else int(found * factor)
        if isinstance(value, str) and found is not None:
            new = f"{new} {value.partition(' ')[2]}".strip()
        return replaced(tree, path, new), f"{told} = {new!r}"
    if kind == 3:
        new = chance.choice(OTHERS)
        return replaced(tree, path, new), f"{told} = {str(new)[:60]!r}"
    if kind == 4:
        return without(tree, path), f"{told} removed"
    if kind == 5:
        return replaced(replaced(tree, path, at(tree, other)), other, value) if not _inside(path, other) else (
            tree
        ), f"{told} and {'.'.join(map(str, other))} exchanged"
    if kind == 6:
        names = [step for one in paths for step in one if isinstance(step, str)]
        name = chance.choice([*names, "\N{HANGUL SYLLABLE GA}", "$x$", "_", "a/b", "y" * 200, ".", "ground"])
        if isinstance(value, str) and chance.random() < 0.5:
            return replaced(tree, path, name), f"{told} = name {name[:40]!r}"
        parent = at(tree, path[:-1])
        if isinstance(parent, dict):
            renamed = {(name if key == path[-1] else key): item for key, item in parent.items()}
            return replaced(tree, path[:-1], renamed), f"{told} renamed {name[:40]!r}"
        return replaced(tree, path, name), f"{told} = name {name[:40]!r}"
    if kind == 7:
        parent = at(tree, path[:-1])
        if isinstance(parent, dict):
            return replaced(tree, path[:-1], {**parent, f"{path[-1]} again": value}), f"{told} twice"
        return replaced(tree, path[:-1], [*parent, value]), f"{told} twice"
    if kind == 8:
        new = chance.choice(([value], {"value": value}, {str(path[-1]): value}, [value, value], str(value)))
        return replaced(tree, path, new), f"{told} wrapped as {str(new)[:40]!r}"
    return replaced(tree, path, at(tree, other)), f"{told} = copy of {'.'.join(map(str, other))}"


def _number(value: Any) -> float | None:
    """The number of a value such as 3 or "5 mm"."""
    if isinstance(value, bool):
        return None
    try:
        return float(str(value).partition(" ")[0])
    except ValueError:
        return None


def _inside(path: tuple[Any, ...], other: tuple[Any, ...]) -> bool:
    short = min(len(path), len(other))
    return path[:short] == other[:short]


def dumped(tree: Any) -> str:
    """A tree as YAML in flow style, what is no text escaped."""
    if isinstance(tree, dict):
        return "{" + ", ".join(f"{json.dumps(str(key))}: {dumped(item)}" for key, item in tree.items()) + "}"
    if isinstance(tree, list):
        return "[" + ", ".join(map(dumped, tree)) + "]"
    if isinstance(tree, float) and not math.isfinite(tree):
        return ".nan" if math.isnan(tree) else ".inf" if tree > 0 else "-.inf"
    return json.dumps(tree)


def top_level(tree: Any, chance: random.Random) -> str:
    """A tree as a file, a key a line; now and then one of them twice."""
    lines = [f"{json.dumps(str(key))}: {dumped(item)}" for key, item in tree.items()] if isinstance(tree, dict) else []
    if lines and chance.random() < 0.03:
        lines.append(chance.choice(lines))
    return "\n".join(lines) + "\n" if lines else dumped(tree)


def shipped(folder: Path) -> None:
    """All coarse models, tables and meshes in their places, for studies to name."""
    (folder / "models").mkdir(parents=True, exist_ok=True)
    shutil.copytree(MODELS.parent / "meshes", folder / "meshes", dirs_exist_ok=True)
    for path in MODELS.iterdir():
        if path.suffix == ".csv":
            shutil.copy(path, folder / "models")
        elif path.suffix == ".yaml" and ".study." not in path.name:
            text = top_level(tree_of(path.name), random.Random(1))
            (folder / "models" / path.name).write_text(text, encoding="utf-8")


def spoilt(folder: Path, kind: str, seed: int, left_out: Collection[str] = ()) -> tuple[Path, str, str]:
    """Write a spoilt model or study beside the shipped ones; its path, what it was, and what was done to it."""
    chance = random.Random(f"{kind} {seed}")
    names = sorted(path.name for path in MODELS.glob("*.yaml") if (".study." in path.name) == (kind == "study"))
    name = chance.choice([name for name in names if name.partition(".")[0] not in left_out])
    tree = tree_of(name)
    if kind == "study":
        tree = {key: value for key, value in tree.items() if key != "accuracy"}
        if isinstance(tree.get("time"), dict):
            tree = {**tree, "time": {**tree["time"], "duration": "20 ms"}}
    done = []
    for _ in range(chance.choice((1, 1, 2, 3))):
        tree, what = mutated(tree, chance)
        done.append(what)
    path = folder / "models" / f"spoilt{'.study' if kind == 'study' else ''}.yaml"
    path.write_text(top_level(tree, chance), encoding="utf-8")
    return path, name.partition(".")[0], "; ".join(done)


def command_on(path: Path, name: str, kind: str, seed: int, out: Path, *, quick: bool = False) -> list[str]:
    """What is asked of a spoilt file: most often what it means, now and then all of it."""
    file, turn = str(path), seed % 6
    if kind == "model":
        points = list((tree_of(f"{name}.yaml").get("points") or {"m": {}}).items())
        point = points[seed % len(points)][0]
        frf = ["frf", file, "--drive", f"{point}.z", "--response", f"{point}.z", "--band", "1:200"]
        return ["modes", file, "--count", "6"] if turn in (1, 3) else frf if turn == 5 else ["check", file]
    if name == "l_room":  # a whole run of it takes most of a minute as it is
        return ["check", file]
    if quick:
        return ["impact" if turn in (1, 3) else "sound" if turn == 5 else "check", file]
    return ["run", file, "-o", str(out)] if turn in (1, 4) else ["impact" if turn == 3 else "check", file]


@cache
def program() -> Any:
    """All commands, whose options are looked up once."""
    from femstruct.cli import app

    return get_command(app)


def run_command(words: list[str]) -> tuple[int, str, str]:
    """Exit code, stdout and stderr of a command of the program, in this process."""
    from femstruct.exits import leave_with

    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = leave_with(lambda: program()(words))
    return code, out.getvalue(), err.getvalue()
