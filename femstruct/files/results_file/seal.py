"""A checksum behind the last byte of a results file, compared before any library opens the file."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Final

from femstruct.errors import InputError

_MARK: Final = b"\nfemstruct sha256 "
LENGTH: Final = len(_MARK) + 64 + 1
_AT_ONCE: Final = 2**20


def seal(image: memoryview) -> bytes:
    r"""What is written behind the bytes of a file; HDF5 reads nothing behind its own end.

    >>> seal(memoryview(b"abc"))[:26]
    b'\nfemstruct sha256 ba7816bf'
    """
    return _MARK + hashlib.sha256(image).hexdigest().encode() + b"\n"


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
