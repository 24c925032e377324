"""A checksum behind the last byte of a results file, compared before any library opens the file."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Final

from femstruct.errors import InputError
from femstruct.files.atomic import replacing

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py

LIBVER: Final = ("earliest", "v110")  # what the HDF5 of ParaView, VTK and older viewers can read
_MARK: Final = b"\nfemstruct sha256 "
LENGTH: Final = len(_MARK) + 64 + 1
_AT_ONCE: Final = 2**20


def seal(image: memoryview) -> bytes:
    r"""What is written behind the bytes of a file; HDF5 reads nothing behind its own end.

    >>> seal(memoryview(b"abc"))[:26]
    b'\nfemstruct sha256 ba7816bf'
    """
    return _MARK + hashlib.sha256(image).hexdigest().encode() + b"\n"


def write_sealed(path: str | Path, write: Callable[[h5py.File], None]) -> None:
    """Write an HDF5 file that is, at every instant, complete or not there. write : fills it.

    Raises FemstructError when the disk is full or refuses; the file that was there before is then untouched.

    Notes
    -----
    Made in memory, `complete = True` last: a disk that fills up while HDF5 itself writes leaves its library in a state
    that crashes the process; the price is the size of the file in memory.
    """
    import h5py

    image = BytesIO()
    with h5py.File(image, "w", libver=LIBVER) as file:
        write(file)
        file.flush()
        file.attrs["complete"] = True
    with replacing(path) as temporary, temporary.open("wb") as written:
        written.write(image.getbuffer())
        written.write(seal(image.getbuffer()))


def refuse_broken_seal(path: Path) -> None:
    """Raise InputError unless a file is, to the last byte, what was written.

    Notes
    -----
    HDF5 follows the addresses that a file holds, round and round where a damaged sector makes them a circle: it must
    not see a file that is not whole.
    """
    whole = hashlib.sha256()
    left = path.stat().st_size - LENGTH
    with path.open("rb") as file:
        while left > 0 and (block := file.read(min(left, _AT_ONCE))):
            whole.update(block)
            left -= len(block)
        found = file.read(LENGTH + 1)
    if not (found.startswith(_MARK) and len(found) == LENGTH):
        raise InputError(
            str(path),
            got="a file without its checksum at the end: cut short, changed, or of an older version",
            expected="a complete results file",
            do="run the study again",
        )
    if found[len(_MARK) : -1].decode("ascii", "replace") != whole.hexdigest():
        raise InputError(
            str(path),
            got="a damaged file: its bytes do not have the checksum at its end",
            expected="a complete results file",
            do="run the study again",
        )
