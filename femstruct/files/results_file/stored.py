"""Reading a results file back."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from femstruct.errors import FemstructError, InputError
from femstruct.files.results_file.campaign_folder import refuse_campaign
from femstruct.files.results_file.results import FORMAT, FORMAT_VERSION
from femstruct.files.results_file.seal import refuse_broken_seal
from femstruct.files.results_file.unread import with_derived
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


OLDEST: Final = 4  # format that is still read
RESULTS: Final = "results.h5"  # of a run, in its folder


def results_file(given: str | Path) -> Path:
    """The results file that is meant by its name or by that of its folder.

    >>> results_file("results/no_such_study/results.h5").name
    'results.h5'
    """
    path = Path(given)
    return path / RESULTS if path.is_dir() else path


def read_results(path: str | Path) -> StudyResult:
    """What a study found, as `run_study` returned it.

    path : a results.h5, or the folder of a run that it is in.

    All nouns are there: responses, levels, findings, modes, the meshed model and the plan with its files verbatim. Of a
    contact law in Python only the name is kept, and the motion of the modes where the study says ``save: modal``: who
    asks for it elsewhere is told so. ``docs/results_file.md`` says what else is left out.

    Raises InputError for a file that is not there, not of this format, incomplete, or damaged: the whole file is
    compared with the checksum at its end before anything else reads it.

    A ball strikes a mass on a spring. After ``femstruct run`` the folder would be ``results/hit``:

    >>> from pathlib import Path
    >>> import tempfile
    >>> from femstruct import read_study, run_study, write_results
    >>> folder = tempfile.TemporaryDirectory()
    >>> model = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\\npoints: {m: {}}"
    >>> _ = Path(folder.name, "model.yaml").write_text(model, encoding="utf-8")
    >>> study = '''
    ... model: model.yaml
    ... bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
    ... record: {m.z: velocity}
    ... time: {duration: 10 ms, sampling: 10 kHz}
    ... '''
    >>> _ = Path(folder.name, "hit.study.yaml").write_text(study, encoding="utf-8")
    >>> write_results(Path(folder.name, "results.h5"), run_study(read_study(Path(folder.name, "hit.study.yaml"))))

    Its histories are channels of its cases, at the times of the response:

    >>> case = read_results(folder.name).cases["as given"]
    >>> list(case.channels)
    ['m.z velocity', 'net force on m']
    >>> velocity, times = case.channels["m.z velocity"], case.response.t
    >>> round(float(times[-1]), 6), round(float(velocity.values[-1]), 3), velocity.unit
    (0.0099, -0.996, 'm/s')
    >>> folder.cleanup()
    """
    path = results_file(path)
    refuse_campaign(path.parent if path.name == RESULTS else path)
    if not path.is_file():
        expected = f"a results file, or the folder of a run with its {RESULTS}"
        raise InputError(str(path), got="no such file", expected=expected, do="run the study first")
    try:
        refuse_broken_seal(path)
        import h5py

        with h5py.File(path, "r") as file:
            _check(path, file)
            found: StudyResult = read_whole(file)
            return with_derived(found)
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
    if not OLDEST <= (version := file.attrs["format_version"]) <= FORMAT_VERSION:
        raise InputError(
            str(path),
            got=f"format version {version}",
            expected=f"{OLDEST} to {FORMAT_VERSION}",
            do="run the study again" if version < FORMAT_VERSION else "use the version of femstruct that wrote it",
        )
