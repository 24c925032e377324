"""femstruct mac and export --to uff, vtu: measured modes made of known shapes, by the command line."""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

from femstruct.cli import app
from femstruct.errors import InputError
from femstruct.exits import leave_with
from femstruct.files.uff import write_uff
from femstruct.modal.measured import (
    MeasuredFrf,
    MeasuredModes,
    MeasuredPlace,
    Measurement,
    correlation,
    interpolation_weights,
)

pytest.importorskip("pyuff", reason="universal files need the package pyuff")
SIDE = 0.6
MODEL = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts:
  plate: {type: plate, material: steel, thickness: 3 mm, origin: [0.1, 0, 0.5], size: [0.6, 0.6], mesh: [10, 10]}
points: {corner: {on: plate, at: [0, 0]}}
supports: {edges: {on: plate, edge: all, fix: simple}}
damping: {ratio: 1 %}
"""
D = 210e9 * 0.003**3 / 12 / (1 - 0.3**2)


def navier(m, n):
    """Natural frequency of the simply supported square [Hz], closed form."""
    return np.pi / 2 * (m**2 + n**2) / SIDE**2 * np.sqrt(D / (7850 * 0.003))


def shape(m, n, places):
    x, y = (places[:, :2] - [0.1, 0.0]).T / SIDE
    return np.sin(m * np.pi * x) * np.sin(n * np.pi * y)


@pytest.fixture(scope="module")
def places():
    """Sensors that are no nodes, on a grid of 5 by 5."""
    x, y = np.meshgrid(np.linspace(0.083, 0.51, 5), np.linspace(0.09, 0.52, 5))
    return np.column_stack([0.1 + x.ravel(), y.ravel(), np.full(25, 0.5)])


@pytest.fixture(scope="module")
def measurement(places):
    """Modes (1, 1), (1, 2) and (2, 1) mixed by 30 degrees and 0.6 % apart, (2, 2) 3 % off, across the plate alone."""
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    one, two = shape(1, 2, places), shape(2, 1, places)
    moved = np.stack([shape(1, 1, places), c * one + s * two, c * two - s * one, shape(2, 2, places)], axis=1)
    shapes = np.zeros((25, 3, 4))
    shapes[:, 2] = moved * [2.0, -1.0, 5.0, 0.1]  # any scale
    hz = [navier(1, 1), navier(1, 2) * 0.997, navier(1, 2) * 1.003, navier(2, 2) / 1.03]
    directed = np.broadcast_to([False, False, True], (25, 3))
    modes = MeasuredModes(hz, [0.011, 0.012, 0.013, 0.014], shapes, places, directed)
    return Measurement("square plate", np.arange(101, 126), places, modes=modes)


@pytest.fixture
def files(tmp_path, measurement):
    (tmp_path / "model.yaml").write_text(MODEL, encoding="utf-8")
    write_uff(measurement, tmp_path / "test.uff")
    return tmp_path / "model.yaml", tmp_path / "test.uff"


def call(*words):
    told = CliRunner().invoke(app, [str(word) for word in words])
    assert told.exit_code == 0, told.output
    return told.stdout


def test_a_turned_pair_is_paired_as_a_space(files):
    """The model's (1, 2) and (2, 1) are equal; the measured ones are mixtures of them, cos^2 30 = 0.75 like at best."""
    table = json.loads(call("mac", *files, "--json"))
    rows = table["modes"]
    assert [row["frequency_hz"] for row in rows] == pytest.approx(
        [navier(1, 1), navier(1, 2) * 0.997, navier(1, 2) * 1.003, navier(2, 2) / 1.03], rel=5e-6
    )  # six digits of the file
    assert sorted(row["model_mode"] for row in rows) == [1, 2, 3, 4]
    # shapes of elements between nodes, straight over a quarter of a cell: (2 pi / 40)^2 / 8 = 3e-3 of the amplitude
    assert [row["group_mac"] for row in rows] == pytest.approx([1.0] * 4, abs=1e-3)
    assert [row["group"] for row in rows] == [[1], [2, 3], [2, 3], [4]]
    assert rows[3]["difference"] == pytest.approx(0.03, abs=1e-3)  # bfs16 of this mesh is within 1e-4
    assert [row["damping_ratio"] for row in rows] == pytest.approx([0.011, 0.012, 0.013, 0.014], rel=5e-6)  # digits
    assert [row["model_damping_ratio"] for row in rows] == pytest.approx([0.01] * 4)
    assert (table["places"], table["directions"]) == (25, 25)
    assert table["farthest_m"] < 1e-9  # six digits of a height of 0.5 m are all of it
    assert np.array(table["mac"])[:, 0] == pytest.approx([1.0, 0.0, 0.0, 0.0], abs=0.02)  # 25 places, not symmetric
    assert table["notes"] == []


def test_single_modes_are_told_as_single_ones(files):
    rows = json.loads(call("mac", *files, "--near", "0", "--json"))["modes"]
    assert rows[0]["group_mac"] == rows[0]["mac"]
    assert rows[0]["group"] == [1]


def test_the_table_is_printed(files):
    told = call("mac", *files)
    assert "square plate beside" in told and "1.00 with 2 to 3" in told
    assert "25 places, 25 displacements" in told
    assert "MAC, measured modes down" in told


def test_modes_written_are_the_same_modes_read(files, tmp_path):
    (path,) = json.loads(call("export", files[0], "--to", "uff", "--count", "6", "-o", tmp_path, "--json"))["written"]
    table = json.loads(call("mac", files[0], path, "--json"))
    assert [row["group_mac"] for row in table["modes"]] == pytest.approx([1.0] * 6, abs=1e-9)  # six digits, squared
    assert max(abs(row["difference"]) for row in table["modes"]) < 5e-6  # six digits
    assert table["farthest_m"] == 0.0
    assert table["places"] == 11 * 11


def test_older_data_sets_are_written_where_they_are_asked_for(files, tmp_path, capsys):
    asked = ("export", files[0], "--to", "uff", "--count", "6", "-o", tmp_path, "--data-sets")
    (path,) = json.loads(call(*asked, "15,2414", "--json"))["written"]
    import pyuff

    assert {int(one) for one in pyuff.UFF(path).get_set_types()} == {151, 164, 15, 2412, 82, 2414}
    table = json.loads(call("mac", files[0], path, "--json"))
    assert [row["group_mac"] for row in table["modes"]] == pytest.approx([1.0] * 6, abs=1e-9)  # six digits, squared
    for given, told in (
        ("15,58", "data sets: got 15, 58"),
        ("fifteen", "--data-sets: got 'fifteen', expected numbers"),
    ):
        assert leave_with(lambda given=given: app([*map(str, asked), given])) == 2
        assert told in capsys.readouterr().err
    assert leave_with(lambda: app(["export", str(files[0]), "--to", "vtu", "--data-sets", "15"])) == 2
    assert "--data-sets: got --to vtu, expected a universal file" in capsys.readouterr().err


def test_millimetres_without_a_word_are_refused_and_can_be_told(files, tmp_path, measurement, capsys):
    m = measurement.modes
    in_mm = replace(measurement, points=1e3 * measurement.points, modes=replace(m, points=1e3 * m.points))
    path = write_uff(in_mm, tmp_path / "mm.uff")
    lines = path.read_text(encoding="ascii").splitlines()
    at = lines.index("   164" + " " * 74)
    path.write_text("\n".join([*lines[: at - 1], *lines[at + 5 :], ""]), encoding="ascii")  # the units are cut out
    assert leave_with(lambda: app(["mac", str(files[0]), str(path)])) == 2
    assert "m from a model of 0.6 m, expected places on the model; give the file's unit" in capsys.readouterr().err
    table = json.loads(call("mac", files[0], path, "--length", "mm", "--json"))
    assert table["modes"][0]["mac"] == pytest.approx(1.0, abs=1e-3)  # as above
    assert table["notes"] == ["no data set 164 (units): taken to be in units of 0.001 m, and newtons"]


def test_too_few_places_are_told(files, tmp_path, measurement):
    m = measurement.modes
    two = MeasuredModes(m.frequency_hz, m.damping_ratio, m.shapes[:2], m.points[:2], m.directed[:2])
    path = write_uff(replace(measurement, nodes=[1, 2], points=m.points[:2], modes=two), tmp_path / "two.uff")
    (note,) = json.loads(call("mac", files[0], path, "--json"))["notes"]
    assert note.startswith("a group of near-equal frequencies has as many modes as displacements")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--near", "wide"], "--near: got 'wide'"),
        (["--near", "200 %"], "--near: got 200 %, expected 0 % to below 100 %"),
        (["--length", "kg"], "--length: got"),
        (["--up-to", "1 kHz", "--count", "3"], "--count and --up-to: got both"),
        (["--up-to", "5 Hz"], "modes of the model: got none, expected modes to compare"),
    ],
)
def test_wrong_words_are_refused(files, words, told, capsys):
    assert leave_with(lambda: app(["mac", *map(str, files), *words])) == 2
    assert told in capsys.readouterr().err


def test_a_file_without_modes_is_refused(files, tmp_path, capsys):
    frf = MeasuredFrf(MeasuredPlace(1, "z"), MeasuredPlace(1, "z"), "mobility", [1.0, 2.0], [1.0, 1.0], "m/(N s)")
    path = write_uff(Measurement("none", [1], [[0, 0, 0]], frfs=(frf,)), tmp_path / "none.uff")
    assert leave_with(lambda: app(["mac", str(files[0]), str(path)])) == 2
    assert "got no modes, expected modes in data sets 55 or 2414" in capsys.readouterr().err
    assert leave_with(lambda: app(["export", str(files[0]), "--to", "npz", "--count", "3"])) == 2
    assert "--count and --up-to: got --to npz, expected modes" in capsys.readouterr().err


READ = """
import sys, json
import numpy as np, pyvista
grid = pyvista.read(sys.argv[1])
np.savez(sys.argv[2], points=grid.points, **{name: grid.point_data[name] for name in grid.point_data})
print(json.dumps({"cells": sorted(set(grid.celltypes.tolist())), "n": grid.n_cells, "names": list(grid.point_data)}))
"""


def test_pyvista_opens_the_shapes_without_a_word(files, tmp_path):
    """10 x 10 cells in 3 x 3 pieces; the first shape is sin sin of amplitude 2 / sqrt(m), by the closed form."""
    (path,) = json.loads(call("export", files[0], "--to", "vtu", "--count", "4", "-o", tmp_path, "--json"))["written"]
    words = [sys.executable, "-W", "error", "-c", READ, path, str(tmp_path / "seen.npz")]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    told = json.loads(done.stdout)
    assert (told["cells"], told["n"]) == ([9], 900)
    assert told["names"][0].startswith("mode 01 ") and len(told["names"]) == 4
    assert float(told["names"][0].split()[2]) == pytest.approx(navier(1, 1), abs=0.01)  # digits of the name
    with np.load(tmp_path / "seen.npz") as kept:
        seen = dict(kept)
    amplitude = 2.0 / np.sqrt(7850 * 0.003 * SIDE**2)
    exact = amplitude * shape(1, 1, seen["points"])
    np.testing.assert_allclose(np.abs(seen[told["names"][0]][:, 2]), exact, atol=1e-4 * amplitude)  # bicubic cells
    assert np.abs(seen[told["names"][0]][:, :2]).max() == 0.0


def test_the_nearest_place_is_the_nearest_of_all(places, files):
    """Beside a search of every triangle: a plate and places beside, above and on it."""
    from femstruct.language.models import read_model
    from femstruct.model.model import refine_model

    shown = refine_model(read_model(files[0]), 2)
    some = np.random.default_rng(9).uniform([0.0, -0.1, 0.4], [0.8, 0.7, 0.6], (40, 3))
    carry, distances = interpolation_weights(shown, np.concatenate([some, places, shown.points[:3]]))
    inside = np.clip(some, [0.1, 0.0, 0.5], [0.7, 0.6, 0.5])  # the nearest place of a rectangle
    np.testing.assert_allclose(distances[:40], np.linalg.norm(some - inside, axis=1), atol=1e-12)  # rounding
    np.testing.assert_allclose((carry @ shown.points)[:40], inside, atol=1e-12)  # rounding
    assert distances[40:].max() < 1e-12  # rounding
    np.testing.assert_allclose(carry.sum(axis=1), 1.0, atol=1e-12)  # rounding


def test_shapes_without_motion_are_refused(places, files):
    from femstruct.assembly.matrices import assemble
    from femstruct.language.models import read_model
    from femstruct.modal.reduction import modal_basis
    from femstruct.model.model import refine_model

    model = read_model(files[0])
    still = MeasuredModes([1.0], [0.0], np.zeros((25, 3, 1)), places, np.zeros((25, 3)))
    with pytest.raises(InputError, match="no displacement other than 0, expected shapes"):
        correlation(still, modal_basis(assemble(model), count=1), refine_model(model))
