"""The mode shapes in a results file as VTK's own reader sees them, beside the closed form they were made from."""

import json
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from femstruct.files.results_file import write_results
from femstruct.workflow.exchange import export_source

DATA = Path(__file__).parents[1] / "data" / "study_by_hand.py"
BY_HAND = runpy.run_path(str(DATA))
READ = """
import json, sys
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader
reader = vtkHDFReader()
assert reader.CanReadFile(sys.argv[1])
reader.SetFileName(sys.argv[1])
reader.Update()
grid = reader.GetOutput()
data = grid.GetPointData()
names = [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())]
arrays = {name: vtk_to_numpy(data.GetArray(name)) for name in names}
np.savez(sys.argv[2], points=vtk_to_numpy(grid.GetPoints().GetData()), **arrays)
print(json.dumps({
    "class": grid.GetClassName(), "names": names,
    "cells": {str(kind): sum(grid.GetCellType(i) == kind for i in range(grid.GetNumberOfCells())) for kind in (3, 9)},
}))
"""


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    """What VTK reads, in a process of its own: its HDF5 is another than h5py's."""
    folder = tmp_path_factory.mktemp("vtk")
    write_results(folder / "results.h5", BY_HAND["study_by_hand"]())
    arguments = [sys.executable, "-c", READ, str(folder / "results.h5"), str(folder / "seen.npz")]
    told = subprocess.run(arguments, capture_output=True, text=True, check=True)
    return json.loads(told.stdout), dict(np.load(folder / "seen.npz"))


def test_grid_has_all_pieces_of_plate_and_bars(seen):
    told, _ = seen
    assert told["class"] == "vtkUnstructuredGrid"
    assert told["cells"] == {"9": (8 * 3) ** 2, "3": 2 * 3}  # 8 x 8 cells and 2 bars, 3 divisions a side


def test_modes_are_named_and_in_order(seen):
    told, _ = seen
    assert told["names"][:3] == ["mode 01 0.00 Hz", "mode 02 19.90 Hz", "mode 03 151.10 Hz"]


def test_shapes_are_smooth_between_the_nodes(seen):
    """sin sin of 2 half waves over 8 cells through its own bicubic: error (2 pi / 8)^4 / 384 = 1e-3 of the amplitude.

    Straight lines between the nodes would be wrong by (2 pi / 8)^2 / 8 = 8e-2.
    """
    _, arrays = seen
    points = arrays["points"]
    plate = points[: (8 * 3 + 1) ** 2]
    exact = BY_HAND["plate_modes"](plate)[:, :3]
    for place, name in enumerate(sorted(name for name in arrays if name.startswith("mode")), 0):
        half_waves = 1 if place == 0 else max(BY_HAND["INDICES"][place - 1])
        tolerance = 1.3 * (half_waves * np.pi / 8) ** 4 / 384 * 2 + 1e-6  # two directions, single precision
        np.testing.assert_allclose(arrays[name][: len(plate)], exact[:, :, place], atol=tolerance)
    assert np.ptp(points[:, 2]) == pytest.approx(0.2)


PYVISTA = """
import sys, json
import numpy as np, pyvista
options = {"force_ext": ".vtkhdf"} if sys.argv[1].endswith(".h5") else {}
grid = pyvista.read(sys.argv[1], **options)
arrays = {name: grid.point_data[name] for name in grid.point_data if name.startswith("mode")}
np.savez(sys.argv[2], points=grid.points, **arrays)
print(json.dumps({"class": type(grid).__name__, "cells": grid.n_cells, "names": list(arrays)}))
"""


@pytest.mark.parametrize("to", ["h5", "vtu"])
def test_pyvista_opens_results_and_what_is_exported_of_them_without_a_word(seen, tmp_path, to):
    told_by_vtk, arrays = seen
    path = tmp_path / "results.h5"
    write_results(path, BY_HAND["study_by_hand"]())
    if to == "vtu":
        (path,) = export_source(path, "vtu", tmp_path, None, (), "femstruct export", lambda stage: None)
    words = [sys.executable, "-W", "error", "-c", PYVISTA, str(path), str(tmp_path / "seen.npz")]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    told = json.loads(done.stdout)
    assert told["class"] == "UnstructuredGrid"
    assert told["cells"] == sum(told_by_vtk["cells"].values())
    assert told["names"] == told_by_vtk["names"]
    with np.load(tmp_path / "seen.npz") as file:
        for name in told["names"]:
            np.testing.assert_array_equal(file[name], arrays[name])
        # single precision of one of the readers
        np.testing.assert_allclose(file["points"], arrays["points"], atol=1e-6)
