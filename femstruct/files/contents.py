"""What is in files now, by a digest of each: whether something that was made from them would be the same again."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path


def contents(names: Iterable[str]) -> dict[str, str]:
    """A digest of every file, by its name; "" of what cannot be read.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "a.csv")
    ...     _ = path.write_text("1")
    ...     before = contents([str(path)])
    ...     _ = path.write_text("2")
    ...     before == contents([str(path)]), contents([folder])[folder]
    (False, '')
    """
    return {name: _digest(Path(name)) for name in dict.fromkeys(names)}


def _digest(path: Path) -> str:
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return ""
