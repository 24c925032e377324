"""Matrices that other programs wrote: OUTPUT4 of Nastran, HDF5, Matrix Market with a table of nodes.

The files in tests/data/op4 were written by pyyeti 1.4.7 (`pyyeti.nastran.op4.write`), in each form that it has, from
the matrices of `written`.
"""

from __future__ import annotations

import re
import struct
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.sparse
from scipy.io import mmwrite

import femstruct as fs
from femstruct.errors import FemstructError, InputError, InputErrors
from femstruct.files.matrices_input import read_dof_table
from femstruct.files.op4 import read_op4
from femstruct.workflow.exchange import export_source

OP4 = Path(__file__).parents[1] / "data" / "op4"
FILES = sorted(path.name for path in OP4.glob("*.op4"))
TABLE = """node,x,y,z,direction
base,0,0,0,x
base,0,0,0,z
base,0,0,0,RY
tip,400,0,100,1
tip,400,0,100,z
tip,400,0,100,ry
"""
PART = "parts:\n  fan: {type: matrices, file: a.op4, nodes: a.csv}\npoints: {tip: {on: fan, at: [400, 0, 100]}}\n"


def written() -> dict[str, np.ndarray]:
    """As in the files."""
    i = np.arange(6)
    K = np.diag(2e3 + 100.0 * i) - np.diag(1e3 + 10.0 * i[1:], 1) - np.diag(1e3 + 10.0 * i[1:], -1)
    K[0, 5] = K[5, 0] = -1 / 3.0
    M = np.diag(1.0 + i / 7.0)
    M[1, 4] = M[4, 1] = 1e-3
    C = 1e-4 * K
    C[2] = C[:, 2] = 0.0
    return {"KAA": K, "MAA": M, "BAA": C}


@pytest.mark.parametrize("name", FILES)
def test_every_form_of_output4_has_the_same_matrices(name: str) -> None:
    found = read_op4(OP4 / name, (OP4 / name).read_bytes())
    assert list(found) == ["KAA", "MAA", "BAA"]
    for key, matrix in written().items():
        np.testing.assert_array_equal(found[key].toarray(), matrix)  # all digits are in the file


def test_there_are_seven_forms() -> None:
    assert len(FILES) == 7


def test_whole_numbers_of_eight_bytes(tmp_path: Path) -> None:
    """As ILP-64 versions write them: made here after the Programmer's Guide, no writer of them was at hand."""

    def record(*pieces: bytes) -> bytes:
        body = b"".join(pieces)
        return struct.pack("<i", len(body)) + body + struct.pack("<i", len(body))

    data = record(struct.pack("<4q", 2, -2, 6, 2), b"KAA".ljust(16))
    data += record(struct.pack("<3q", 1, 0, 4), struct.pack("<2q", 3, 1), struct.pack("<2d", 5.0, -1.0))
    data += record(struct.pack("<3q", 2, 1, 2), struct.pack("<2d", -1.0, 7.0))
    data += record(struct.pack("<3q", 3, 1, 1), struct.pack("<d", 1.0))
    assert read_op4(tmp_path / "a.op4", data)["KAA"].toarray().tolist() == [[5.0, -1.0], [-1.0, 7.0]]


def test_numbers_of_single_precision_and_bare_exponents(tmp_path: Path) -> None:
    head = struct.pack("<4i", 1, 1, 6, 1) + b"K".ljust(8)
    pieces = [head, struct.pack("<3if", 1, 1, 1, 0.5), struct.pack("<3if", 2, 1, 1, 1.0)]
    data = b"".join(struct.pack("<i", len(one)) + one + struct.pack("<i", len(one)) for one in pieces)
    assert read_op4(tmp_path / "a.op4", data)["K"].toarray().tolist() == [[0.5]]
    text = "       2       1       2       2K       1P,2D12.5\n       1       1       1\n 2.50000-101\n"
    text += "       2       1       1\n 1.00000D+02\n       3       1       1\n 1.00000D+00\n"
    assert read_op4(tmp_path / "a.op4", text.encode())["K"].toarray().tolist() == [[2.5e-101, 100.0]]


@pytest.mark.parametrize("name", FILES)
def test_no_damage_gives_a_traceback(name: str, tmp_path: Path) -> None:
    """Files that are cut off anywhere, or have a byte changed, are read or refused in a sentence."""
    data, random = (OP4 / name).read_bytes(), np.random.default_rng(7)
    for _ in range(300):
        at = int(random.integers(len(data)))
        flipped = bytes([data[at] ^ (1 << int(random.integers(8)))])
        for damaged in (data[:at], data[:at] + flipped + data[at + 1 :]):
            try:
                read_op4(tmp_path / "a.op4", damaged)
            except InputError as error:
                assert "got" in str(error) and "expected" in str(error)


def model(folder: Path, text: str = PART, op4: str = "binary_bigmat.op4", table: str = TABLE) -> fs.Model:
    (folder / "a.op4").write_bytes((OP4 / op4).read_bytes())
    (folder / "a.csv").write_text(table, encoding="utf-8")
    (folder / "a.yaml").write_text(text, encoding="utf-8")
    return fs.read_model(folder / "a.yaml")


def test_an_op4_with_a_table_is_a_part(tmp_path: Path) -> None:
    assembly = fs.assemble(model(tmp_path))
    for key, matrix in zip(("K", "M", "C"), written().values(), strict=True):
        np.testing.assert_allclose(getattr(assembly, key).toarray(), matrix, rtol=1e-14)  # rounding
    labels = ["UX", "UZ", "RY"]
    assert list(assembly.dofs.labels) == [f"fan node {node} {one}" for node in (0, 1) for one in labels]
    renamed = PART.replace("a.csv", "a.csv, names: {M: KAA, K: MAA}")
    other = fs.assemble(model(tmp_path, renamed))
    np.testing.assert_allclose(other.K.toarray(), written()["MAA"], rtol=1e-14)  # rounding


def test_matrices_in_newtons_and_millimetres(tmp_path: Path) -> None:
    """Frequencies do not depend on units; points are in metres, and a push in N moves by metres."""
    text = PART.replace("a.csv", "a.csv, scale: mm").replace("[400, 0, 100]", "[0.4, 0, 0.1]")
    mm, plain = fs.assemble(model(tmp_path, text)), fs.assemble(model(tmp_path))
    omega, same = (fs.modal_basis(one, count=4).omega for one in (mm, plain))
    np.testing.assert_allclose(omega, same, rtol=1e-10)  # rounding of the solver
    K = written()["KAA"]
    assert mm.K[0, 0] == pytest.approx(1e3 * K[0, 0], rel=1e-14)  # N/mm is 1e3 N/m: rounding
    assert mm.K[1, 2] == pytest.approx(K[1, 2], rel=1e-14)  # N: rounding
    assert mm.K[2, 2] == pytest.approx(1e-3 * K[2, 2], rel=1e-14)  # N mm: rounding
    assert mm.M[0, 0] == pytest.approx(1e3, rel=1e-14)  # t: rounding


def test_hdf5_dense_and_sparse(tmp_path: Path) -> None:
    K, M, C = written().values()
    table = read_dof_table(_file(tmp_path / "a.csv", TABLE))
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["M"] = M
        rows, columns = scipy.sparse.csr_array(K), scipy.sparse.csc_array(C)
        for name, one in (("K", rows), ("C", columns)):
            group = file.create_group(name)
            for part in ("data", "indices", "indptr"):
                group[part] = getattr(one, part)
            group.attrs["shape"] = one.shape
        file["C"].attrs["format"] = "csc"
        file["nodes"], file["components"], file["points"] = table
    found = fs.read_matrices(tmp_path / "a.h5")
    for key, matrix in (("K", K), ("M", M), ("C", C)):
        np.testing.assert_array_equal(getattr(found, key).toarray(), matrix)
    (tmp_path / "a.yaml").write_text(PART.replace("a.op4, nodes: a.csv", "a.h5"), encoding="utf-8")
    assert fs.read_model(tmp_path / "a.yaml").parts["fan"].mass == pytest.approx(
        found.total_mass, rel=1e-14
    )  # rounding
    data, random = (tmp_path / "a.h5").read_bytes(), np.random.default_rng(3)
    for _ in range(150):
        at = int(random.integers(len(data)))
        flipped = bytes([data[at] ^ (1 << int(random.integers(8)))])
        for damaged in (data[:at], data[:at] + flipped + data[at + 1 :]):
            (tmp_path / "b.h5").write_bytes(damaged)
            try:
                fs.read_matrices(tmp_path / "b.h5")
            except FemstructError as error:
                assert "got" in str(error) and "expected" in str(error)


def test_matrix_market_of_another_program(tmp_path: Path) -> None:
    for name, matrix in zip("KMC", written().values(), strict=True):
        mmwrite(tmp_path / f"{name}.mtx", scipy.sparse.coo_array(matrix), precision=17)
    files = "file: {M: M.mtx, K: K.mtx, C: C.mtx}"
    assembly = fs.assemble(model(tmp_path, PART.replace("file: a.op4", files)))
    for key, matrix in zip(("K", "M", "C"), written().values(), strict=True):
        np.testing.assert_allclose(getattr(assembly, key).toarray(), matrix, rtol=1e-14)  # rounding
    again = fs.read_matrices({one: tmp_path / f"{one}.mtx" for one in "MK"}, nodes=tmp_path / "a.csv")
    assert again.C.nnz == 0


def test_what_we_export_reads_back_through_the_formats_of_others(tmp_path: Path) -> None:
    """Our matrices, told by a table in place of our own map; plain nodes without joints, so that each is one."""
    steel = fs.Material("steel", E=210e9, nu=0.3, rho=7850.0)
    mesh = fs.ImportedMesh(
        "t", [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], range(4), {"quad4": [range(4)]}, {"quad4": [1]}
    )
    own = fs.assemble(fs.mesh_structure(fs.Structure("t", (fs.Shell("t", mesh, steel, 0.01),))))
    with h5py.File(tmp_path / "t.h5", "w") as file:
        file["M"], file["K"] = own.M.toarray(), own.K.toarray()
    words = ("x", "y", "z", "rx", "ry", "rz")
    rows = [f"{n},{x:.17g},{y:.17g},{z:.17g},{one}" for n, (x, y, z) in enumerate(own.points.tolist()) for one in words]
    table = _file(tmp_path / "t.csv", "\n".join(["node,x,y,z,direction", *rows]))
    again = fs.modal_basis(fs.read_matrices(tmp_path / "t.h5", nodes=table), count=14)
    first = fs.modal_basis(own, count=14)
    np.testing.assert_allclose(again.omega, first.omega, rtol=1e-9, atol=1e-9 * first.omega.max())  # rounding
    np.testing.assert_array_equal(again.points, own.points)


WRONG = [
    (
        PART.replace("a.csv", "a.csv, names: {M: MGG, K: KAA}"),
        TABLE,
        r"2:\d+: parts\.fan\.file: got 'MGG', no matrix of",
    ),
    (PART.replace(", nodes: a.csv", ""), TABLE, r"parts\.fan\.file: got 'a\.op4' without nodes, components, points"),
    (PART, TABLE + "tip,400,0,100,rz\n", r"got 7 rows in 'a\.csv', expected 6, one for each row of M"),
    (PART, TABLE.replace("RY", "ry2"), r"a\.csv:4:1: got the direction 'ry2', expected x, y, z, rx, ry, rz or 1 to 6"),
    (PART, TABLE.replace("tip,400,0,100,z", "tip,401,0,100,z"), r"a\.csv:6:1: got a second place of node tip"),
    (PART, TABLE.replace("100,ry", "100,x"), r"a\.csv:7:1: got a direction of a node that is above"),
    (PART, TABLE.replace("400", "4OO"), r"a\.csv:5:1: got '4OO, 0, 100', expected numbers"),
    (PART, TABLE.replace("base,0,0,0,z", "base,0,0,z"), r"a\.csv:3:1: got a row of another length"),
    (PART, TABLE.replace("direction", "dof"), r"a\.csv:1:1: got 'node, x, y, z, dof', expected a table of commas"),
    (PART.replace("a.op4", "{M: a.op4, K: a.op4}"), TABLE, r"'a\.op4', which does not begin with %%MatrixMarket"),
    (PART.replace("a.op4", "{M: a.op4}"), TABLE, r"parts\.fan\.file"),
    (PART.replace("a.csv", "none.csv"), TABLE, r"parts\.fan\.file: got no file"),
]


@pytest.mark.parametrize("at", range(len(WRONG)))
def test_a_mistake_is_one_line(at: int, tmp_path: Path) -> None:
    text, table, message = WRONG[at]
    with pytest.raises(InputError) as caught:
        model(tmp_path, text, table=table)
    assert re.search(message, str(caught.value)), str(caught.value)


def _file(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def test_our_own_export_is_taken_back_by_its_json(tmp_path: Path) -> None:
    """NAME.dofs.csv is no table of nodes: the message says what to write, and that is taken."""
    steel = (
        "materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}\nsections: {s: {shape: rectangle, width: 1, height: 2}}\n"
    )
    bar = "parts: {bar: {type: frame, material: steel, section: s, lines: [[[0, 0, 0], [20, 0, 0]]], mesh: 5}}\n"
    (tmp_path / "free.yaml").write_text(steel + bar, encoding="utf-8")
    export_source(tmp_path / "free.yaml", "mtx", tmp_path, None, (), "", print)
    taken = "parts: {fan: {type: matrices, file: {M: free.M.mtx, K: free.K.mtx}, nodes: free.dofs.csv}}\n"
    (tmp_path / "again.yaml").write_text(taken, encoding="utf-8")
    with pytest.raises(InputErrors) as refused:
        fs.read_model(tmp_path / "again.yaml")
    assert "free.dofs.csv:1:1: got the table of an export of femstruct" in str(refused.value)
    assert "write 'file: free.json' without 'nodes'" in str(refused.value)
    (tmp_path / "again.yaml").write_text("parts: {fan: {type: matrices, file: free.json}}\n", encoding="utf-8")
    mass = fs.read_model(tmp_path / "again.yaml").parts["fan"].mass
    assert mass == pytest.approx(2.0 * 20.0 * 7850.0, rel=1e-12)  # rounding
