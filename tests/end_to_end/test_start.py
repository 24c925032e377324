"""What the first second of a command loads: nothing that only other commands need."""

from __future__ import annotations

import subprocess
import sys

import pytest

OTHERS = [
    "scipy.signal",
    "scipy.stats",
    "scipy.optimize",
    "scipy.integrate",
    "numba",
    "h5py",
    "matplotlib",
    "pyvista",
    "skfem",
    "meshio",
]
PLATE = """\
title: A simply supported steel plate
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {plate: {type: plate, material: steel, thickness: 3 mm, origin: [0, 0, 0], size: [0.5, 0.4], mesh: [20, 20]}}
supports: {edges: {on: plate, edge: all, fix: simple}}
"""
READ = "import sys; from femstruct import assemble, modal_basis, read_model; read_model(sys.argv[1])"
MODES = "import sys; from femstruct.cli import app; app(['modes', sys.argv[1]], standalone_mode=False)"


@pytest.mark.parametrize("code", [READ, MODES], ids=["read_model", "modes"])
def test_only_what_is_needed_is_imported(code, tmp_path):
    model = tmp_path / "plate.yaml"
    model.write_text(PLATE, encoding="utf-8")
    told = f"{code}; print(*(name for name in {OTHERS} if name in sys.modules), sep=' ', file=sys.stderr)"
    run = subprocess.run([sys.executable, "-c", told, str(model)], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert run.stderr.split() == []
