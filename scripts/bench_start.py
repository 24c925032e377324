"""`femstruct modes` of a plate of 20 x 20 from a cold process, over importing numpy and scipy.sparse.linalg alone.

CPU seconds of whole processes, one BLAS thread, best of `rounds` taken in turns. The goal is a ratio of 2.

    python scripts/bench_start.py [rounds]
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

PLATE = """\
title: A simply supported steel plate
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {plate: {type: plate, material: steel, thickness: 3 mm, origin: [0, 0, 0], size: [0.5, 0.4], mesh: [20, 20]}}
supports: {edges: {on: plate, edge: all, fix: simple}}
"""


def seconds(*command: str) -> float:
    """CPU seconds of a Python process."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(
        [sys.executable, *command], env=environment | {"OMP_NUM_THREADS": "1"}, check=True, stdout=subprocess.DEVNULL
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main(rounds: int = 5) -> dict[str, float]:
    """CPU seconds of each process and their ratio."""
    with tempfile.TemporaryDirectory() as folder:
        model = Path(folder, "plate.yaml")
        model.write_text(PLATE, encoding="utf-8")
        ways = {
            "numpy, scipy.sparse.linalg": ("-c", "import numpy, scipy.sparse.linalg"),
            "read_model": ("-c", "from femstruct import read_model"),
            "femstruct modes": ("-m", "femstruct", "modes", str(model)),
        }
        taken = [{name: seconds(*way) for name, way in ways.items()} for _ in range(rounds + 1)][1:]
    best = {name: min(one[name] for one in taken) for name in ways}
    return best | {"ratio": best["femstruct modes"] / best["numpy, scipy.sparse.linalg"]}


if __name__ == "__main__":
    for key, value in main(*(int(argument) for argument in sys.argv[1:2])).items():
        print(f"{key:28s} {value:.3g}")
