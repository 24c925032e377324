"""Kept machine code: damaged files, folders that cannot be written, several processes, a compiler that fails."""

from __future__ import annotations

import logging
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from femstruct.compiled import store
from femstruct.compiled import store as workers
from femstruct.compiled.store import code_of, compilation
from femstruct.errors import FemstructError
from femstruct.impact.contact_events import fill_forces

ROOT = Path(__file__).parents[2]


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An empty folder for machine code."""
    monkeypatch.setenv("FEMSTRUCT_CACHE", str(tmp_path / "kernels"))
    store.folder.cache_clear()
    yield tmp_path / "kernels"
    store.folder.cache_clear()


@pytest.fixture(scope="module")
def piece() -> bytes:
    """The machine code of a small unit."""
    return code_of([fill_forces])[fill_forces.symbol]


@pytest.mark.parametrize("damage", ["empty", "truncated", "flipped", "zeroed"])
def test_damaged_code_is_told_removed_and_made_again(
    damage: str, elsewhere: Path, piece: bytes, caplog: pytest.LogCaptureFixture
) -> None:
    store.store_code(fill_forces, piece, store.folder())
    (path,) = elsewhere.glob("*.unit")
    good = path.read_bytes()
    middle = len(good) // 2
    path.write_bytes(
        {
            "empty": b"",
            "truncated": good[:middle],
            "flipped": good[:middle] + bytes([good[middle] ^ 1]) + good[middle + 1 :],
            "zeroed": good[:middle] + bytes(512) + good[middle + 512 :],
        }[damage]
    )
    with caplog.at_level(logging.WARNING, "femstruct"):
        assert store.load_code(fill_forces) is None
    (told,) = caplog.messages
    assert path.name in told and "is damaged; it is removed and compiled again" in told and "\n" not in told
    assert not path.exists()


def test_damaged_code_is_compiled_again(elsewhere: Path, piece: bytes) -> None:
    store.store_code(fill_forces, piece, store.folder())
    (path,) = elsewhere.glob("*.unit")
    path.write_bytes(path.read_bytes()[:-1])
    assert code_of([fill_forces])[fill_forces.symbol]
    assert path.exists()


def test_a_command_survives_damaged_code(elsewhere: Path, piece: bytes) -> None:
    """Every file of the folder is noise: one line for each, the numbers, exit 0."""
    store.store_code(fill_forces, piece, store.folder())
    (path,) = elsewhere.glob("*.unit")
    path.write_bytes(b"noise" * 100)
    code = "from femstruct.impact.contact_events import fill_forces\nfrom femstruct.compiled.store import code_of\n"
    code += "code_of([fill_forces])"
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=True)
    assert ran.stderr.count("is damaged") == 1 and "Traceback" not in ran.stderr


def test_the_next_folder_is_taken_where_one_cannot_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    in_the_way = tmp_path / "file"
    in_the_way.touch()
    monkeypatch.setattr(store, "folders", lambda: (in_the_way / "kernels", tmp_path / "mine"))
    store.folder.cache_clear()
    assert store.folder() == tmp_path / "mine"
    store.folder.cache_clear()


def test_a_folder_of_one_process_goes_with_it(tmp_path: Path) -> None:
    """Where no folder can be written; its code is used while the process lives."""
    (tmp_path / "file").touch()
    code = "from pathlib import Path\nfrom femstruct.compiled import store\n"
    code += f"store.folders = lambda: (Path({str(tmp_path / 'file')!r}) / 'kernels',)\n"
    code += "from femstruct.impact.contact_events import fill_forces\n"
    code += "store.store_code(fill_forces, b'code', store.folder())\n"
    code += "assert store.load_code(fill_forces) == b'code'\nprint(store.folder())"
    ran = subprocess.run(
        [sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, cwd=ROOT, check=True
    )
    assert Path(ran.stdout.strip()).name.startswith("femstruct-") and not Path(ran.stdout.strip()).exists()
    assert not ran.stderr


def test_processes_that_keep_the_same_code_do_not_disturb_each_other(elsewhere: Path, piece: bytes) -> None:
    """Files are written beside and renamed: a reader sees all of one or none."""
    for _ in range(3):
        store.store_code(fill_forces, piece, store.folder())
        assert store.load_code(fill_forces) == piece
    assert [path.suffix for path in elsewhere.iterdir()] == [".unit"]


def test_code_that_nobody_used_for_long_is_removed(elsewhere: Path, piece: bytes) -> None:
    store.store_code(fill_forces, piece, store.folder())
    (path,) = elsewhere.glob("*.unit")
    store.sweep(elsewhere)
    assert path.exists()
    os.utime(path, (0.0, 0.0))
    store.sweep(elsewhere)
    assert not path.exists()


def test_a_compiler_that_fails_is_told(elsewhere: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers.sys, "executable", "/bin/false" if os.name == "posix" else "no-such-program")
    with pytest.raises(FemstructError, match="no machine code"):
        code_of([fill_forces])


def test_an_interrupted_compilation_leaves_no_process(elsewhere: Path) -> None:
    with pytest.raises(KeyboardInterrupt), compilation([fill_forces]) as running:
        raise KeyboardInterrupt
    assert all(process.poll() is not None for process in running.processes)
    assert not list(elsewhere.glob("*.part"))


def test_it_says_how_far_it_is(elsewhere: Path) -> None:
    told: list[str] = []
    with compilation([fill_forces]) as running:
        running.wait(told.append)
    assert told and all(line.startswith("compiling 1 of 1, about ") and line.endswith(" s left") for line in told)
    assert [one.name for one in running.done] == [fill_forces.name]
