"""Killed, out of disk, damaged: the results file is the complete old one, the complete new one, or refused."""

import json
import os
import runpy
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from femstruct.errors import FemstructError, InputError
from femstruct.files.results_file import read_results, write_results
from femstruct.files.writing import replacing

DATA = Path(__file__).parents[1] / "data" / "study_by_hand.py"
BY_HAND = runpy.run_path(str(DATA))
KILLER = """
import json, os, pathlib, random, runpy, signal, sys, time
from femstruct.files.results_file import write_results
from femstruct.files.results_file import read_results
make = runpy.run_path(sys.argv[1])["study_by_hand"]
path = pathlib.Path(sys.argv[2])
results = [make(duration=2.0, sampling=9600.0, tag=float(tag)) for tag in (1, 2)]
write_results(path, results[0])
begin = time.perf_counter()
write_results(path, results[1])
once = time.perf_counter() - begin
chance, seen, halves = random.Random(1), [], 0
for kill in range(10):
    size = path.stat().st_size
    child = os.fork()
    while not child:
        for result in results:
            write_results(path, result)
    if kill % 2:  # at any time; most of it HDF5 works in memory
        time.sleep(3 * once * chance.random())
    else:  # while bytes go to the disk
        while len(os.listdir(path.parent)) == 1 and path.stat().st_size == size:
            pass
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    halves += sum(item != path for item in path.parent.iterdir())
    seen.append(read_results(path).cases["without damper"].response.contacts["ball on floor"].peak_force)
write_results(path, results[0])
print(json.dumps([seen, halves, len(list(path.parent.iterdir()))]))
"""
LIMITED = """
import resource, runpy, signal, sys
from femstruct.errors import FemstructError
from femstruct.files.results_file import write_results
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))
try:
    write_results(sys.argv[2], runpy.run_path(sys.argv[1])["study_by_hand"](tag=2.0))
except FemstructError as error:
    print("told:", error)
"""


DAMAGED = """
import pathlib, random, sys
from femstruct.errors import InputError
from femstruct.files.results_file import read_results
path = pathlib.Path(sys.argv[1])
whole, chance, step = path.read_bytes(), random.Random(1), int(sys.argv[2])
def refused(data):
    path.write_bytes(data)
    try:
        read_results(path)
    except InputError as error:
        assert len(str(error).splitlines()) == 1, error
        return
    raise AssertionError("read")
for start in range(0, len(whole), step):
    sector = whole[start : start + 512]
    if sector.strip(bytes(1)):
        refused(whole[:start] + bytes(len(sector)) + whole[start + 512 :])
for _ in range(100):
    data = bytearray(whole)
    data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
    refused(bytes(data))
    refused(whole[: chance.randrange(len(whole))])
refused(whole[:-90])  # as an older version wrote it
refused(whole + b"more")
path.write_bytes(whole)
assert read_results(path).plan.title
"""


def test_killed_at_random_it_is_old_or_new(tmp_path):
    """Ten kills of a process that writes two kinds of results in turn; read_results refuses what is not complete."""
    command = [sys.executable, "-c", KILLER, str(DATA), str(tmp_path / "results.h5")]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    seen, halves, left = json.loads(done.stdout)
    assert len(seen) == 10 and set(seen) <= {200.0, 400.0}
    assert 0 < halves <= 10  # some fell into a write; at most one half file a kill, since the next writer sweeps
    assert left == 1  # and the last one leaves nothing but the results


def test_leftovers_of_the_dead_are_swept_those_of_the_living_are_not(tmp_path):
    path = tmp_path / "results.h5"
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    with replacing(path) as temporary:
        ours = temporary.name
        temporary.write_text("x")
    stale = tmp_path / ours.replace(str(os.getpid()), str(dead.pid))
    living = tmp_path / ours.replace(str(os.getpid()), str(os.getppid()))
    other = tmp_path / ours.replace(f"-{os.getpid()}", f"-elsewhere-{dead.pid}")
    for file in (stale, living, other):
        file.write_text("half")
    with replacing(path) as temporary:
        temporary.write_text("whole")
    assert sorted(item.name for item in tmp_path.iterdir()) == sorted(["results.h5", living.name, other.name])


def test_a_full_disk_leaves_the_old_file(tmp_path):
    path = tmp_path / "results.h5"
    write_results(path, BY_HAND["study_by_hand"](tag=1.0))
    before = path.read_bytes()
    done = subprocess.run([sys.executable, "-c", LIMITED, str(DATA), str(path)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "told:" in done.stdout and "untouched" in done.stdout
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_an_exception_while_writing_leaves_the_old_file(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(ZeroDivisionError), replacing(path) as temporary:
        temporary.write_text("half")
        raise ZeroDivisionError
    assert path.read_text() == "old" and list(tmp_path.iterdir()) == [path]


def test_a_folder_that_cannot_be_written_is_told(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(FemstructError, match="no folder"), replacing(tmp_path / "file" / "results.h5"):
        pass


@pytest.mark.parametrize("name", ["cases/without damper/channels/O_f.z velocity", "bases/abc123/frequency_hz"])
def test_a_flipped_byte_is_caught(tmp_path, name):
    path = tmp_path / "results.h5"
    write_results(path, BY_HAND["study_by_hand"]())
    with h5py.File(path, "r") as file:
        stored = file[name].id
        offset = stored.get_chunk_info(0).byte_offset if file[name].chunks else stored.get_offset()
    flip(path, offset + 3)
    with pytest.raises(InputError, match="damaged"):
        read_results(path)


def test_a_flipped_byte_of_a_text_is_caught(tmp_path):
    path = tmp_path / "results.h5"
    write_results(path, BY_HAND["study_by_hand"]())
    flip(path, path.read_bytes().index("title: ü".encode()))
    with pytest.raises(InputError, match="damaged"):
        read_results(path)


def test_a_truncated_file_is_refused(tmp_path):
    path = tmp_path / "results.h5"
    write_results(path, BY_HAND["study_by_hand"]())
    whole = path.read_bytes()
    for share in np.linspace(0.0, 0.999, 7):
        path.write_bytes(whole[: int(share * len(whole))])
        with pytest.raises(InputError):
            read_results(path)


def test_a_damaged_file_is_refused_and_never_hangs(tmp_path):
    """Zeroed sectors made HDF5 follow addresses in a circle for ever: the reader compares a checksum first."""
    path = tmp_path / "results.h5"
    write_results(path, BY_HAND["study_by_hand"]())
    command = [sys.executable, "-c", DAMAGED, str(path), str(512 * 3)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


def flip(path, offset):
    data = bytearray(path.read_bytes())
    data[offset] ^= 1
    path.write_bytes(data)
