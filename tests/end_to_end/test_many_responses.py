"""Frequency responses many by many: each the same as one alone, and in every kind of file."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from femstruct.assembly.matrices import assemble
from femstruct.cli import app
from femstruct.errors import InputError
from femstruct.exits import leave_with
from femstruct.files.uff import read_uff
from femstruct.language.models import read_model
from femstruct.modal.damping import Damping, FromMaterials, with_damping
from femstruct.modal.frf import frf
from femstruct.modal.measured import frf_table
from femstruct.modal.reduction import modal_basis

MODEL = Path(__file__).parents[2] / "models" / "small_plate.yaml"
ASKED = [
    "--drive",
    "off.z",
    "--drive",
    "middle.z",
    "--response",
    "middle.z",
    "--response",
    "off.rx",
    "--band",
    "10:400",
]
FORCE = ["--response", "edges.force"]
SAME = 1e-12  # of the largest: the same sums in another order


def call(*words):
    told = CliRunner().invoke(app, ["frf", str(MODEL), *map(str, words)])
    assert told.exit_code == 0, told.output
    return told.stdout


@pytest.fixture(scope="module")
def alone():
    """Each response by a command of its own, by (response, drive)."""
    found = {}
    for response in ("middle.z", "off.rx", "edges.force"):
        for drive in ("off.z", "middle.z"):
            words = ["--drive", drive, "--response", response, "--band", "10:400", "--step", "10 Hz", "--json"]
            one = json.loads(call(*words))
            found[response, drive] = np.array(one["real"]) + 1j * np.array(one["imag"]), one["unit"], one["kind"]
    return found


def test_each_is_what_it_is_alone(alone):
    """Residual vectors of two drives in one basis: more is known of each, by less than 1e-3 of the largest."""
    told = json.loads(call(*ASKED, *FORCE, "--step", "10 Hz", "--json"))
    assert [(one["response"], one["drive"]) for one in told["responses"]][:3] == [
        ("middle.z", "off.z"),
        ("off.rx", "off.z"),
        ("edges.force", "off.z"),
    ]
    for one in told["responses"]:
        values, unit, kind = alone[one["response"], one["drive"]]
        own = np.array(one["real"]) + 1j * np.array(one["imag"])
        np.testing.assert_allclose(own, values, atol=1e-3 * np.abs(values).max())
        assert (one["unit"], one["kind"]) == (unit, kind)


@pytest.mark.parametrize("law", [None, FromMaterials()], ids=["diagonal", "full"])
@pytest.mark.parametrize("kind", ["receptance", "mobility", "accelerance", "transmissibility"])
def test_the_table_is_the_single_responses(kind, law):
    model = read_model(MODEL)
    probes = {"off.z": model.points["off"].probe("z"), "middle.z": model.points["middle"].probe("z")}
    basis = modal_basis(assemble(model), up_to=500.0, probes=list(probes.values()))
    basis = with_damping(basis, Damping(law)) if law else basis
    lines = np.linspace(20.0, 400.0, 30)
    table = frf_table(basis, probes, probes, lines, kind)
    for i, response in enumerate(probes.values()):
        for j, drive in enumerate(probes.values()):
            one = frf(basis, drive, response, lines, kind)
            np.testing.assert_allclose(table.values[i, j], one, atol=SAME * np.abs(one).max())
    if kind != "transmissibility":  # reciprocity
        np.testing.assert_allclose(table.values[0, 1], table.values[1, 0], atol=SAME * np.abs(table.values).max())


def test_files_have_what_is_printed(tmp_path):
    told = json.loads(call(*ASKED, "--step", "10 Hz", "--json"))["responses"]
    paths = {}
    for to in ("csv", "npz"):
        (paths[to],) = json.loads(call(*ASKED, "--step", "10 Hz", "--to", to, "-o", tmp_path, "--json"))["written"]
    with Path(paths["csv"]).open(encoding="utf-8-sig") as file:
        head, *rows = csv.reader(file)
    columns = np.array(rows, dtype=float).T
    assert columns[0].tolist() == [10.0 * line for line in range(1, 41)]
    assert head[:2] == ["frequency_hz", "accelerance middle.z / off.z [m/(N s^2)] real"]
    assert head[3] == "accelerance off.rx / off.z [rad/(N s^2)] real"
    for number, one in enumerate(told):
        assert columns[1 + 2 * number].tolist() == one["real"]
        assert columns[2 + 2 * number].tolist() == one["imag"]
    with np.load(paths["npz"]) as file:
        assert file["drives"].tolist() == ["off.z", "middle.z"]
        assert file["responses"].tolist() == ["middle.z", "off.rx"]
        assert file["values"][1, 0].imag.tolist() == told[1]["imag"]
        assert file["units"].tolist() == [["m/(N s^2)"] * 2, ["rad/(N s^2)"] * 2]
        assert json.loads(str(file["about"]))["provenance"]["command"].startswith("femstruct")


def test_a_universal_file_has_points_and_responses(tmp_path):
    pytest.importorskip("pyuff", reason="universal files need the package pyuff")
    told = json.loads(call(*ASKED, "--step", "10 Hz", "--json"))["responses"]
    (path,) = json.loads(call(*ASKED, "--step", "10 Hz", "--to", "uff", "-o", tmp_path, "--json"))["written"]
    read = read_uff(path)
    model = read_model(MODEL)
    np.testing.assert_array_equal(read.points, [model.points[name].position for name in ("off", "middle")])
    for one, frf_read in zip(told, read.frfs, strict=True):
        assert (str(frf_read.drive), str(frf_read.response)) == (one["drive"], one["response"])
        assert (frf_read.kind, frf_read.unit) == (one["kind"], one["unit"])
        np.testing.assert_allclose(frf_read.values.real, one["real"], rtol=1e-10)  # twelve digits of the file
        assert frf_read.frequency_hz.tolist() == [10.0 * line for line in range(1, 41)]


def test_they_are_printed_side_by_side():
    lines = call(*ASKED, "--step", "100 Hz").splitlines()
    assert "# 2: accelerance off.rx / off.z, rad/(N s^2)" in lines
    columns = next(line for line in lines if line.startswith("# frequency_hz")).split()
    assert len(columns) - 1 == len(lines[-1].split()) == 9


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([*ASKED, "--drive", "off.z"], "--drive: got 'off.z' twice, expected each place once"),
        ([*ASKED, "--method", "direct"], "--method: got 'direct' of several responses"),
        ([*ASKED, "--drive", "off.x"], "--drive: got 'off.x', no mode moves along x"),
        ([*ASKED, "--response", "nowhere.z"], "--response: got 'nowhere'"),
        ([*ASKED, *FORCE, "--kind", "mobility"], "got 'mobility' of a force"),
        ([*ASKED, "--kind", "mobile"], "--kind: got 'mobile'"),
    ],
)
def test_wrong_words_are_refused(words, told, capsys):
    assert leave_with(lambda: app(["frf", str(MODEL), *words])) == 2
    assert told in capsys.readouterr().err


def test_forces_are_not_for_universal_files(tmp_path, capsys):
    pytest.importorskip("pyuff", reason="universal files need the package pyuff")
    assert leave_with(lambda: app(["frf", str(MODEL), *ASKED, *FORCE, "--to", "uff", "-o", str(tmp_path)])) == 2
    assert "got 'edges.force', expected a point with one of x, y, z" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_table_that_does_not_fit_is_refused():
    from femstruct.errors import FemstructError
    from femstruct.modal.measured import FrfTable

    with pytest.raises(FemstructError, match=r"got shape \(1, 1, 3\), expected shape \(1, 1, 2\)"):
        FrfTable([1.0, 2.0], ("a.z",), ("a.z",), ("mobility",), np.ones((1, 1, 3)))
    assert issubclass(InputError, FemstructError)
