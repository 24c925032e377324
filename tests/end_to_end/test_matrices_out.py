"""Matrices of a model in files of NumPy and Matrix Market: read by hand, by scipy, and by read_matrices."""

import csv
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg
from scipy.io import mmread
from scipy.sparse import csc_array, csr_array
from typer.testing import CliRunner

from femstruct.assembly.given_matrices import given_matrices
from femstruct.assembly.matrices import assemble
from femstruct.cli import app
from femstruct.conventions import COMPONENTS, N_COMPONENTS
from femstruct.errors import FemstructError, InputError
from femstruct.exits import leave_with
from femstruct.files.matrices_input import read_matrices
from femstruct.language.models import read_model
from femstruct.modal.reduction import modal_basis

MODELS = Path(__file__).parents[2] / "models"
SAME = 1e-12  # of the largest: the matrices are the same to the last digit, and the solver is, too
PRESS = MODELS / "press.yaml"  # plates, bars, springs with joints: maps of all kinds
FLOOR = MODELS / "floor_frame_slab.yaml"  # plates that are rigid in their planes


def export(model, to, folder):
    told = CliRunner().invoke(app, ["export", str(model), "--to", to, "-o", str(folder), "--json"])
    assert told.exit_code == 0, told.output
    return [Path(path) for path in json.loads(told.stdout)["written"]]


@pytest.fixture(scope="module", params=[PRESS, FLOOR], ids=lambda path: path.stem)
def written(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("matrices")
    (npz,) = export(request.param, "npz", folder)
    return request.param, npz, export(request.param, "mtx", folder)


def opened(npz):
    with np.load(npz) as file:
        return dict(file)


def kept(npz, letter, rows, n):
    file = opened(npz)
    return csc_array(tuple(file[f"{letter}_{part}"] for part in ("data", "indices", "indptr")), shape=(rows, n))


def test_matrices_read_back_have_the_same_modes(written):
    model, npz, files = written
    own = modal_basis(assemble(read_model(model)), count=12)
    for path in (npz, files[-1]):
        again = modal_basis(read_matrices(path), count=12)
        np.testing.assert_allclose(again.omega, own.omega, rtol=SAME, atol=SAME * own.omega.max())
        np.testing.assert_allclose(again.shapes, own.shapes, atol=SAME * np.abs(own.shapes).max())
        np.testing.assert_allclose(again.modal_mass, own.modal_mass, atol=SAME * own.total_mass)
        np.testing.assert_array_equal(again.points, own.points)
        assert again.total_mass == own.total_mass


def test_given_matrices_reads_what_the_file_has(written):
    """By the nodes and components of the degrees of freedom alone, as someone with the README has it."""
    model, npz, _ = written
    file = opened(npz)
    n, rows = len(file["nodes"]), len(file["points"]) * N_COMPONENTS
    if (file["nodes"] < 0).any():  # plates that are rigid in their planes move no node alone: their places are free
        free = np.flatnonzero(file["nodes"] < 0)
        places = np.setdiff1d(np.arange(rows), file["nodes"] * N_COMPONENTS + file["components"])[: len(free)]
        file["nodes"][free], file["components"][free] = np.divmod(places, N_COMPONENTS)
    M, C, K = (kept(npz, letter, n, n) for letter in "MCK")
    again = modal_basis(given_matrices(M, K, file["nodes"], file["components"], file["points"], C), count=12)
    own = modal_basis(assemble(read_model(model)), count=12)
    np.testing.assert_allclose(again.omega, own.omega, rtol=SAME, atol=SAME * own.omega.max())


def test_a_dense_solver_finds_them_too(tmp_path):
    """LAPACK on the matrices as Matrix Market has them, halves and all: largest 1 / omega^2 of M x = K x / omega^2."""
    M, C, K = (mmread(path).toarray() for path in export(PRESS, "mtx", tmp_path)[:3])
    for matrix in (M, C, K):
        np.testing.assert_array_equal(matrix, matrix.T)
    inverse = scipy.linalg.eigh(M, K, eigvals_only=True, subset_by_index=[len(M) - 12, len(M) - 1])
    own = modal_basis(assemble(read_model(PRESS)), count=12)
    # two solvers: rounding times the condition of K, 1e8 between bending of plates and stretching in their planes
    np.testing.assert_allclose(1.0 / inverse[::-1], own.omega**2, rtol=1e-7)


def test_the_map_says_which_component_each_is(written):
    _, npz, files = written
    file = opened(npz)
    T = csr_array(mmread(files[3]))
    with files[4].open(encoding="utf-8-sig") as table:
        rows = list(csv.DictReader(table))
    for dof, (node, component) in enumerate(zip(file["nodes"], file["components"], strict=True)):
        assert rows[dof]["name"] == file["labels"][dof]
        if node < 0:
            assert rows[dof]["component"] == ""
            continue
        assert rows[dof]["component"] == COMPONENTS[component]
        assert int(rows[dof]["node"]) == node
        place = node * N_COMPONENTS + component
        assert T.indices[T.indptr[place] : T.indptr[place + 1]].tolist() == [dof]
        assert T.data[T.indptr[place]] == 1.0
    assert (file["nodes"] >= 0).mean() > 0.9


def test_it_says_where_it_comes_from_and_how_it_is_damped(written):
    model, npz, files = written
    for about in (json.loads(str(opened(npz)["about"])), json.loads(files[-1].read_text(encoding="utf-8"))):
        assert about["provenance"]["femstruct_version"]
        assert about["provenance"]["command"].startswith("femstruct")
        assert model.read_text(encoding="utf-8") in about["model"].values()
        assert about["damping"] == (
            {"law": "Ratio", "value": 0.01} if model == PRESS else about["damping"] | {"law": about["damping"]["law"]}
        )
        assert about["degrees_of_freedom"] == len(opened(npz)["nodes"])


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (lambda path: path.write_bytes(path.read_bytes()[:1000]), "which cannot be read"),
        (lambda path: path.write_text("{}"), "its format is not 'femstruct matrices 1'"),
        (lambda path: path.write_text("M"), "which cannot be read"),
        (lambda path: path.unlink(), "no file"),
        (lambda path: np.savez(path, about=np.array('{"format": "femstruct matrices 1"}')), "without 'degrees"),
    ],
    ids=["cut off", "other", "text", "gone", "empty"],
)
def test_files_that_are_no_matrices_are_refused(written, tmp_path, spoil, told):
    path = tmp_path / written[1].name
    shutil.copy(written[1], path)
    spoil(path)
    with pytest.raises(InputError, match=told):
        read_matrices(path)


def test_a_table_that_does_not_fit_is_refused(written, tmp_path):
    for path in written[2]:
        shutil.copy(path, tmp_path / path.name)
    nodes = tmp_path / written[2][5].name
    nodes.write_text("\n".join(nodes.read_text(encoding="utf-8").splitlines()[:-1]), encoding="utf-8")
    with pytest.raises(FemstructError, match=r"map: got \d+ rows, expected \d+ nodes x 7"):
        read_matrices(tmp_path / written[2][-1].name)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([MODELS / "oscillator.yaml", "--to", "npz"], "got a structure in closed form, which has no matrices"),
        ([PRESS, "--to", "csv"], "a YAML file, expected results.h5 of a run, or its folder; run the study"),
        (["results.h5", "--to", "mtx"], "results of a run, expected a model"),
        (["results.h5", "--set", "a=b"], "--set: got results, expected a model"),
        ([PRESS, "--to", "npz", "--set", "parts.bed.thickness=thick"], "parts.bed.thickness"),
    ],
)
def test_what_cannot_be_exported_is_said(words, told, tmp_path, capsys):
    code = leave_with(lambda: app(["export", *map(str, words), "-o", str(tmp_path)]))
    assert code == 2
    assert told in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
