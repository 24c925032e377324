"""How many faults planted by a mutation tool the machine of random models finds by itself.

    python scripts/mutants.py --count 40 --seed 7 --workers 2 -o results/mutants

Mutants are made by the operators of cosmic-ray (`pip install '.[mutants]'`), in copies of the packages. A subject is
drawn first (elements, joints, losses, ..), then a place in its code, then one of the operators that apply there:
large files do not hide small ones. Annotations, decorators, `raise` statements and texts of messages are left out,
for they change no number; so are assignments to the words of a message (`got`, `expected`, ..), the kinds of exceptions
that are caught and the `strict` of `zip`. Each mutant meets `scripts/verify.py` alone; tests are not run. A first run
of the unchanged code keeps its verdicts and which lines each capability executes: those that execute the line come
first, the quickest before the others; where none does, those of its function, of its file, of its subject. Found is
what differs from the verdicts of the unchanged code, which is asked for those that were not kept: wrong, refused, told
or crashed. What survives is listed with its line, to be read: it is equivalent, or a place that no check reaches.
"""

import argparse
import ast
import difflib
import json
import os
import random
import shutil
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

TOP = Path(__file__).resolve().parents[1]

# Folders and files of each subject; a folder stands for all below it.
SUBJECTS: Mapping[str, tuple[str, ...]] = {
    "elements": (
        "femstruct/elements",
        *(f"femstruct/parts/{name}.py" for name in ("cells", "frame", "plate", "shell", "slab", "solid")),
    ),
    "joints": (
        "femstruct/assembly",
        *(f"femstruct/model/{name}.py" for name in ("constraints", "mesher", "plates_and_bars", "seams")),
        *(f"femstruct/model/{name}.py" for name in ("supports_and_joints", "unlike_meshes")),
    ),
    "losses": (
        *(f"femstruct/modal/{name}.py" for name in ("by_frequency", "coupled_damping", "oscillators")),
        *(f"femstruct/model/{name}.py" for name in ("lay_ups", "materials")),
    ),
    "laws": (
        "femstruct/laws",
        *(
            f"femstruct/impact/{name}.py"
            for name in ("contact_events", "energies", "exact", "motion", "propagation", "system")
        ),
    ),
    "rooms": ("acoustics/rooms", "acoustics/fields", "acoustics/meshed"),
    "levels": ("acoustics/levels",),
    "readers": (
        "femstruct/decks",
        *(f"femstruct/files/{name}.py" for name in ("band_tables", "matrices_input", "op4", "text_tables")),
        *(f"femstruct/language/{name}.py" for name in ("materials", "model_file", "parts", "places", "structures")),
    ),
    "sweeps": ("femstruct/campaign", "femstruct/study/campaigns.py", "femstruct/study/optima.py"),
}

_WORDS: Final = {"got", "expected", "do", "message"}  # names of what is said, never computed with

# Capabilities of the machine that are for a subject, by parts of their names.
FIRST: Mapping[str, tuple[str, ...]] = {
    "elements": ("elements", "any answer", "slabs", "plates", "solids", "closed form"),
    "joints": ("joints", "bars", "slabs: two", "limits", "any answer"),
    "losses": ("lose", "loses", "losses", "language", "damping", "any answer"),
    "laws": ("impacts", "evaluations"),
    "rooms": ("rooms", "levels"),
    "levels": ("levels", "rooms"),
    "readers": ("decks", "formats", "tables", "language", "exchange", "said otherwise"),
    "sweeps": ("sweeps: drawn", "sweeps: who", "sweeps: the best", "sweeps"),
}


@dataclass(frozen=True, slots=True)
class Mutant:
    """One changed place: the operator's name and which of its places in the file it is (from 0)."""

    subject: str
    file: str
    line: int
    operator: str
    occurrence: int

    def __str__(self) -> str:
        return f"{self.subject:9} {self.file}:{self.line} {self.operator.removeprefix('core/')}"


def _spans_without_numbers(source: str) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """From where to where (line, column) annotations, decorators, raise statements and texts stand."""
    spans = []
    for node in ast.walk(ast.parse(source)):
        found: list[ast.AST | None] = []
        if isinstance(node, ast.FunctionDef):
            found = [
                node.returns,
                *(each.annotation for each in node.args.args + node.args.kwonlyargs),
                *node.decorator_list,
            ]
        elif isinstance(node, ast.ClassDef):
            found = [*node.decorator_list, *(each.annotation for each in node.body if isinstance(each, ast.AnnAssign))]
        elif isinstance(node, ast.AnnAssign):
            found = [node.annotation]
        elif isinstance(node, ast.Raise | ast.JoinedStr | ast.Import | ast.ImportFrom):
            found = [node]
        elif isinstance(node, ast.Assign) and all(isinstance(one, ast.Name | ast.Tuple) for one in node.targets):
            targets = {each.id for one in node.targets for each in ast.walk(one) if isinstance(each, ast.Name)}
            found = [node.value] if targets and targets <= _WORDS else []
        elif isinstance(node, ast.keyword) and node.arg == "strict":  # of zip: sequences of one length by design
            found = [node.value]
        there = [each for each in found if each is not None]
        spans += [((each.lineno, each.col_offset), (each.end_lineno or 0, each.end_col_offset or 0)) for each in there]
    return spans


def _mutants_of(subject: str, path: Path) -> Iterator[tuple[tuple[int, int], Mutant]]:
    """Every mutant of a file that may change a number, with its place."""
    from cosmic_ray.ast import ast_nodes, get_ast
    from cosmic_ray.plugins import get_operator, operator_names

    source = path.read_text(encoding="utf-8")
    tree, spans = get_ast(source), _spans_without_numbers(source)
    nodes = list(ast_nodes(tree))
    for name in operator_names():
        if get_operator(name).arguments() or "ExceptionReplacer" in name:
            continue
        operator = get_operator(name)()
        places = (start for node in nodes for start, _ in operator.mutation_positions(node))
        for occurrence, place in enumerate(places):
            if not any(first <= place < last for first, last in spans):
                yield place, Mutant(subject, str(path.relative_to(TOP)), place[0], name, occurrence)


def drawn(count: int, seed: int, subjects: Sequence[str]) -> list[Mutant]:
    """`count` mutants: subjects in turn, in each a place by chance and an operator that applies there by chance."""
    rng = random.Random(seed)
    pools: dict[str, dict[tuple[str, tuple[int, int]], list[Mutant]]] = {}
    for subject in subjects:
        pool: dict[tuple[str, tuple[int, int]], list[Mutant]] = {}
        for entry in SUBJECTS[subject]:
            top = TOP / entry
            if not top.exists():
                raise SystemExit(f"SUBJECTS: got {entry!r} of {subject!r}, expected a file or folder that exists")
            for path in [top] if top.suffix == ".py" else sorted(top.rglob("*.py")):
                for place, mutant in _mutants_of(subject, path):
                    pool.setdefault((mutant.file, place), []).append(mutant)
        pools[subject] = pool
    chosen: list[Mutant] = []
    for number in range(count):
        pool = pools[subjects[number % len(subjects)]]
        place = rng.choice(sorted(pool))
        chosen.append(rng.choice(pool.pop(place)))
    return chosen


def _environment(tree: Path, options: argparse.Namespace) -> dict[str, str]:
    """Of a process that runs a tree; kernels that a mutant leaves alone are shared."""
    kept = str(options.output.resolve() / "kernels")
    return {
        **os.environ,
        "PYTHONPATH": f"{tree}:{tree / 'scripts'}",
        "OMP_NUM_THREADS": "1",
        "FEMSTRUCT_CACHE": kept,
    }


def _checked(
    tree: Path, faults: Path, options: argparse.Namespace, names: Sequence[str] = (), words: Sequence[str] = ()
) -> tuple[str, list[str]]:
    """What the machine says of a tree: "found" or "survived", and its last lines. faults : where it writes models;
    names : capabilities, in this order, all if none. words : more of the command."""
    command = [sys.executable, "scripts/verify.py", "--limit", "60", "--seed", str(options.checks_seed)]
    command += ["--verdicts", str(options.output.resolve() / "verdicts.json"), "-o", str(faults)]
    command += ["--unchanged", str(TOP)] if tree != TOP else []
    command += [part for name in names for part in ("--named", name)] + list(words)
    try:
        ended = subprocess.run(
            command,
            cwd=tree,
            env=_environment(tree, options),
            capture_output=True,
            text=True,
            timeout=3 * options.seconds + 120 if names else None,
        )
    except subprocess.TimeoutExpired:
        return "found", ["it never ended"]
    found = [path.read_text(encoding="utf-8") for path in sorted(faults.glob("*.yaml"))]
    lines = "\n".join([*found, ended.stdout, ended.stderr]).strip().splitlines()
    return "survived" if ended.returncode == 0 else "found", lines


def _functions(source: str) -> Iterator[range]:
    """Lines of the bodies of functions, outer ones first."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef):
            yield range(node.body[0].lineno, (node.end_lineno or node.lineno) + 1)


def _statement(source: str, line: int) -> range:
    """Lines of the innermost statement around a line; of a compound one its head."""
    found = range(line, line + 1)
    for node in ast.walk(ast.parse(source)):  # outer ones come first
        if isinstance(node, ast.stmt) and node.lineno <= line <= (node.end_lineno or node.lineno):
            body = getattr(node, "body", None)
            last = body[0].lineno - 1 if body else node.end_lineno or node.lineno
            found = range(node.lineno, max(last, line) + 1)
    return found


def _who_meets(mutant: Mutant, source: str, reached: Mapping[str, Mapping[str, Any]]) -> tuple[str, list[str]]:
    """Capabilities that execute the changed line, then those of its function and file, the quickest first; or those of
    its subject, where no line is known, as in compiled kernels. How near they come is said, too."""
    bodies = list(_functions(source))
    around = [set(body) for body in bodies if mutant.line in body]
    anywhere = set().union(*bodies)
    quickest = sorted(reached, key=lambda name: float(reached[name]["seconds"]))
    near: dict[str, set[int]] = {"line": set(_statement(source, mutant.line)), "function": around[-1]} if around else {}
    of_subject = [name for name in quickest if any(part in name for part in FIRST[mutant.subject])]
    found: dict[str, list[str]] = {}
    for how, lines in (near | {"file": anywhere}).items():
        found[how] = [name for name in quickest if lines & set(reached[name]["lines"].get(mutant.file, ()))]
    found["file"].sort(key=lambda name: name not in of_subject)
    nearest = next((how for how, names in found.items() if names), "subject")
    # What is kept from one check to the next hides lines from all but the first: others of the file follow.
    return nearest, list(dict.fromkeys([*(name for names in found.values() for name in names)])) or of_subject


def _met(mutant: Mutant, options: argparse.Namespace) -> tuple[Mutant, str, float]:
    """What becomes of a mutant: "found", "survived", or "does not apply"."""
    from cosmic_ray.mutating import mutate_code
    from cosmic_ray.plugins import get_operator

    began = time.monotonic()
    with TemporaryDirectory() as folder:
        copy = Path(folder)
        for name in ("femstruct", "acoustics", "scripts", "tests", "models", "meshes"):
            shutil.copytree(TOP / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
        changed = copy / mutant.file
        before = changed.read_text(encoding="utf-8")
        code = mutate_code(before, get_operator(mutant.operator)(), mutant.occurrence)
        if code is None:
            return mutant, "does not apply", 0.0
        changed.write_text(code, encoding="utf-8")
        near, names = _who_meets(mutant, before, json.loads((options.output / "reached.json").read_text()))
        # Compiled kernels have no lines, and are compiled anew before they are met.
        seconds = options.seconds * {"line": 1.0, "function": 1 / 3, "file": 1.5, "subject": 1.0}[near]
        words = ["--workers", "1", "--until-fault", "--seconds", str(seconds)]
        word, lines = _checked(copy, copy / "faults", options, names, words)
    difference = difflib.unified_diff(before.splitlines(), code.splitlines(), lineterm="", n=1)
    kept = options.output / f"{word}_{Path(mutant.file).stem}_{mutant.line}_{mutant.occurrence}.txt"
    kept.write_text(
        "\n".join([f"{mutant}: {len(names)} capabilities meet its {near}", *difference, *lines[:60]]) + "\n",
        encoding="utf-8",
    )
    return mutant, word, time.monotonic() - began


def main() -> int:
    """Draw mutants, run the machine on each, print what it found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1, help="draws the mutants")
    parser.add_argument(
        "--checks-seed", type=int, default=1, help="draws the random models; the unchanged code must pass"
    )
    parser.add_argument("--seconds", type=float, default=150.0, help="of checks for one mutant")
    parser.add_argument("--checks", type=int, default=3, help="of each capability on the unchanged code")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--subjects", nargs="*", choices=sorted(SUBJECTS), default=sorted(SUBJECTS))
    parser.add_argument("--list", action="store_true", help="print the mutants that are drawn, and run nothing")
    parser.add_argument("-o", "--output", type=Path, default=Path("results/mutants"))
    options = parser.parse_args()
    try:
        mutants = drawn(options.count, options.seed, options.subjects)
    except ModuleNotFoundError as missing:
        print(f"{missing.name} is not installed: pip install '.[mutants]'", file=sys.stderr)
        return 2
    print(f"{len(mutants)} mutants, seed {options.seed}", flush=True)
    if options.list:
        print("\n".join(map(str, mutants)))
        return 0
    options.output.mkdir(parents=True, exist_ok=True)
    (options.output / "verdicts.json").unlink(missing_ok=True)
    warm_up = [sys.executable, "-m", "femstruct", "warm-up"]
    subprocess.run(warm_up, cwd=TOP, env=_environment(TOP, options), check=True, capture_output=True)
    words = ["--workers", str(options.workers), "--seconds", "900", "--count", str(options.checks)]
    words += ["--reached", str(options.output.resolve() / "reached.json")]
    word, lines = _checked(TOP, options.output / "unchanged", options, words=words)
    if not (options.output / "verdicts.json").exists():
        print("\n".join(["the unchanged code could not be checked", *lines]), file=sys.stderr)
        return 2
    if word == "found":
        print("the unchanged code has faults with these seeds (mend them): what a mutant does otherwise counts")
    counts: Counter[str] = Counter()
    with ThreadPoolExecutor(options.workers) as pool:
        for mutant, word, seconds in pool.map(lambda each: _met(each, options), mutants):
            counts[word] += 1
            print(f"{word:10} {seconds:5.0f} s  {mutant}", flush=True)
    print(f"found {counts['found']} of {counts['found'] + counts['survived']} before any is read as equivalent")
    return 0


if __name__ == "__main__":
    sys.exit(main())
