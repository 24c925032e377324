"""Reading a results file back, lightly: tables, histories and frequencies, not the nouns."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import InputError
from femstruct.files.hdf5 import digest, key
from femstruct.files.results import FORMAT, FORMAT_VERSION
from femstruct.files.seal import refuse_broken_seal

if TYPE_CHECKING:  # slow to import, and most runs write no such file
    import h5py


@dataclass(frozen=True, eq=False)
class StoredBasis:
    """Modes of a basis: frequencies [Hz] and kinds, [k] each."""

    frequency_hz: Floats
    kind: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class StoredCase:
    """Histories of a case: t [nt] [s], channels [nt] by name in units by name; its basis and damping ratios [k]."""

    basis: str
    outcome: str | None
    damping_ratio: Floats
    t: Floats
    channels: Mapping[str, Floats]
    units: Mapping[str, str]


@dataclass(frozen=True, eq=False)
class StoredResults:
    """What a results file says. summary : the tables of `femstruct.files.tables.summary`; sources : files by name."""

    title: str
    baseline: str
    sources: Mapping[str, str]
    provenance: Mapping[str, str]
    findings: tuple[Mapping[str, Any], ...]
    summary: Mapping[str, Any]
    bases: Mapping[str, StoredBasis]
    cases: Mapping[str, StoredCase]


def read_results(path: str | Path) -> StoredResults:
    """The tables, channels and modes of a results file; the example of `write_results` reads one.

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
            return _read(path, file)
    except (OSError, KeyError, RuntimeError, ValueError) as error:
        raise InputError(
            str(path), got=f"a damaged file ({error})", expected="a complete results file", do="run the study again"
        ) from error


def _check(path: Path, file: h5py.File) -> None:
    if file.attrs.get("format") != FORMAT:
        raise InputError(str(path), got="an HDF5 file of another kind", expected=f"'{FORMAT}'")
    if file.attrs.get("complete") is not np.True_:
        raise InputError(
            str(path), got="an incomplete file", expected="complete = True, written last", do="run the study again"
        )
    if (version := file.attrs["format_version"]) != FORMAT_VERSION:
        raise InputError(str(path), got=f"format version {version}", expected=f"{FORMAT_VERSION}")


def _read(path: Path, file: h5py.File) -> StoredResults:
    summary = json.loads(_text(path, file["summary"])[0])
    return StoredResults(
        title=file.attrs["title"],
        baseline=file.attrs["baseline"],
        sources={item.attrs["path"]: _text(path, item)[0] for item in file["input"].values()},
        provenance={name: value for name, value in file["provenance"].attrs.items() if name != "description"},
        findings=tuple(json.loads(file.attrs["findings"])),
        summary=summary,
        bases={
            name: StoredBasis(item["frequency_hz"][()], _text(path, item["kind"]))
            for name, item in file["bases"].items()
        },
        cases={name: _case(file["cases"][key(name)], table["peaks"]) for name, table in summary["cases"].items()},
    )


def _case(item: h5py.Group, names: Iterable[str]) -> StoredCase:
    channels = {name: item["channels"][key(name)] for name in names}
    return StoredCase(
        basis=item.attrs["basis"],
        outcome=item.attrs.get("outcome"),
        damping_ratio=item["damping/damping_ratio"][()],
        t=item["channels/time"][()] if "channels" in item else np.empty(0),
        channels={name: data[()] for name, data in channels.items()},
        units={name: data.attrs["unit"] for name, data in channels.items()},
    )


def _text(path: Path, dataset: h5py.Dataset) -> tuple[str, ...]:
    """A text (one string) or the strings of a row, checked against their SHA-256."""
    if not dataset.size:  # a row of none, as the kinds of no modes
        return ()
    values = dataset.asstr()[()]
    lines = (values,) if isinstance(values, str) else tuple(values)
    if digest("\n".join(lines)) != dataset.attrs["sha256"]:
        raise InputError(
            f"{path}{dataset.name}", got="a damaged text", expected="its SHA-256", do="run the study again"
        )
    return lines
