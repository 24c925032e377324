"""Reading a results file back."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from femstruct.errors import FemstructError, InputError
from femstruct.files.results_file.results import FORMAT, FORMAT_VERSION
from femstruct.files.results_file.seal import refuse_broken_seal
from femstruct.files.results_file.whole import read_whole
from femstruct.study.result import StudyResult

if TYPE_CHECKING:  # slow to import, and most runs read no such file
    import h5py

_UNREADABLE: Final = (
    OSError,
    KeyError,
    RuntimeError,
    ValueError,
    TypeError,
    ImportError,
    AttributeError,
    FemstructError,
)


def read_results(path: str | Path) -> StudyResult:
    """What a study found, as `run_study` returned it; the example of `write_results` reads one.

    All nouns are there: responses, levels, findings, modes, the meshed model and the plan with its files verbatim. Of a
    contact law in Python only the name is kept.

    Raises InputError for a file that is not there, not of this format, incomplete, or damaged: the whole file is
    compared with the checksum at its end before anything else reads it.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(str(path), got="no such file", expected="a results file", do="run the study first")
    try:
        refuse_broken_seal(path)
        import h5py

        with h5py.File(path, "r") as file:
            _check(path, file)
            return read_whole(file)
    except InputError:
        raise
    except _UNREADABLE as error:
        raise InputError(
            str(path),
            got=f"a file that cannot be read ({error})",
            expected="a complete results file of this version",
            do="run the study again",
        ) from error


def _check(path: Path, file: h5py.File) -> None:
    if file.attrs.get("format") != FORMAT:
        raise InputError(str(path), got="an HDF5 file of another kind", expected=f"'{FORMAT}'")
    if file.attrs.get("complete") is not np.True_:
        raise InputError(
            str(path), got="an incomplete file", expected="complete = True, written last", do="run the study again"
        )
    if (version := file.attrs["format_version"]) != FORMAT_VERSION:
        raise InputError(
            str(path),
            got=f"format version {version}",
            expected=f"{FORMAT_VERSION}",
            do="run the study again" if version < FORMAT_VERSION else "use the version of femstruct that wrote it",
        )
