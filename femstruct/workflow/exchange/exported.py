"""A model, or the tables of a results file, as files of other programs."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any, Final, Literal

from femstruct.assembly.assemble import assemble
from femstruct.assembly.matrices import Assembly
from femstruct.errors import InputError
from femstruct.files.exchange.matrices_file import write_mtx, write_npz
from femstruct.language import ModelFile, read_model_file
from femstruct.modal.damping import Damping, FromMaterials
from femstruct.model.materials.loss_by_frequency import LossByFrequency
from femstruct.model.mesher import mesh_structure
from femstruct.model.structure import Structure
from femstruct.study.asked import Extent
from femstruct.workflow.check.asked_modes import DEFAULT_MODES
from femstruct.workflow.exchange.exported_modes import write_basis, write_modes
from femstruct.workflow.progress import Progress
from femstruct.workflow.run.provenance import provenance
from femstruct.workflow.stages.positions import positioned

To = Literal["csv", "xlsx", "npz", "mtx", "uff", "vtu"]
OF_RESULTS: Final = ("csv", "xlsx")
OF_MATRICES: Final = ("npz", "mtx")
OF_MODES: Final = ("uff", "vtu")
Table = dict[str, Any]


def exported(
    file: Path,
    to: To,
    folder: Path,
    extent: Extent | None,
    overrides: tuple[str, ...],
    command: str,
    tell: Progress,
    data_sets: str = "",
) -> list[Path]:
    """Write what there is in a file to a folder; returns the files.

    file : results of a run, a sweep or an optimisation for `csv` and `xlsx`, a model for `npz` and `mtx`, a run or a
    model for modes. extent : how many modes of a model, for `uff` and `vtu`. data_sets : of a universal file, as in
    "15,2414"; "" for the usual ones.

    Raises InputError for the other kind of file, and for a number of modes or data sets where none are written.
    """
    _refuse_other(file, to)
    sets = _numbers(data_sets)
    if sets and to != "uff":
        raise InputError("--data-sets", got=f"--to {to}", expected="a universal file: --to uff")
    if extent is not None and to not in OF_MODES:
        raise InputError("--count and --up-to", got=f"--to {to}", expected="modes: --to uff or vtu")
    if _is_results(file):
        if overrides:
            raise InputError("--set", got="results", expected="a model", do="results are not computed anew")
        return _tables(file, to, folder) if to in OF_RESULTS else _shapes(file, to, folder, extent, sets)
    source = read_model_file(file, overrides)
    name = file.name.removesuffix(".yaml").removesuffix(".yml")
    if to in OF_MODES:
        return write_modes(source, to, folder, name, extent or Extent(count=DEFAULT_MODES), tell, sets)
    with positioned(source):
        if not isinstance(source.structure, Structure):
            got = "a structure in closed form, which has no matrices"
            raise InputError(f"--to {to}", got=got, expected="a model with parts")
        if source.structure.cavities:
            do = "remove the cavities: what the air does is no matrix of the structure's nodes"
            raise InputError(f"--to {to}", got="a model with cavities", expected="a structure without air", do=do)
        tell("matrices")
        assembly = assemble(mesh_structure(source.structure))
        if assembly.growing:
            got = f"{', '.join(assembly.growing)}, whose stiffness depends on frequency"
            raise InputError(f"--to {to}", got=got, expected="constant matrices", do="give the edge a stiffness")
    folder.mkdir(parents=True, exist_ok=True)
    return (write_npz if to == "npz" else write_mtx)(assembly, folder, name, _about(source, assembly, command))


def _refuse_other(file: Path, to: str) -> None:
    """Raise InputError for a model where results are wanted, and for results where a model is."""
    if to in OF_RESULTS and not _is_results(file):
        got, expected = f"'{file}', a YAML file", "results.h5 of a run, or its folder"
        raise InputError(f"--to {to}", got=got, expected=expected, do="run the study, or use --to npz, mtx, uff or vtu")
    if to in OF_MATRICES and _is_results(file):
        got = f"'{file}', results of a run"
        raise InputError(f"--to {to}", got=got, expected="a model (YAML)", do="matrices are not kept in results")


def _is_results(file: Path) -> bool:
    return file.suffix not in (".yaml", ".yml")


def _tables(file: Path, to: str, folder: Path) -> list[Path]:
    from femstruct.files.results_file.campaign_folder import campaign_file
    from femstruct.files.results_file.found_file import read_found
    from femstruct.files.results_file.stored import read_results, results_file
    from femstruct.files.results_file.swept_file import SWEEP, read_swept
    from femstruct.files.tables.campaign_sheets import campaign_sheets
    from femstruct.files.tables.sheets import sheets, write_csv, write_workbook

    source = campaign_file(file)
    if source is not None:
        tables = campaign_sheets((read_swept if source.name == SWEEP else read_found)(source))
    else:
        source = results_file(file)
        tables = sheets(read_results(source))
    folder.mkdir(parents=True, exist_ok=True)
    return (write_csv if to == "csv" else write_workbook)(tables, folder, _name_of(source))


def _numbers(data_sets: str) -> tuple[int, ...]:
    """Numbers of data sets as they are written on the command line."""
    words = [word.strip() for word in data_sets.split(",")] if data_sets else []
    if any(not word.isdigit() for word in words):
        expected = "numbers of data sets: 15 or 2411 of nodes, 55 or 2414 of modes"
        raise InputError("--data-sets", got=f"'{data_sets}'", expected=expected, do="write --data-sets 15,2414")
    return tuple(map(int, words))


def _shapes(file: Path, to: str, folder: Path, extent: Extent | None, sets: tuple[int, ...]) -> list[Path]:
    """The modes of the baseline of a results file."""
    from femstruct.files.results_file.stored import read_results, results_file

    if extent is not None:
        raise InputError("--count and --up-to", got="results", expected="a model", do="all modes there are are written")
    source = results_file(file)
    result = read_results(source)
    baseline = result.cases[result.plan.baseline]
    return write_basis(
        baseline.basis, result.models.get(baseline.basis_key), result.plan.title, to, folder, _name_of(source), sets
    )


def _name_of(source: Path) -> str:
    return source.absolute().parent.name if source.stem in ("results", "sweep", "optimise") else source.stem


def _about(source: ModelFile, assembly: Assembly, command: str) -> Table:
    return {
        "title": source.title,
        "damping": damping_table(source.damping, assembly),
        "model": dict(source.sources),
        "provenance": provenance(command),
    }


def damping_table(damping: Damping, assembly: Assembly) -> Table:
    """A damping law as JSON: its name and numbers, by materials the loss factors of all parts [1].

    >>> from femstruct import LossFactor, given_matrices
    >>> mass = given_matrices([[1.0]], [[1.0]], [0], [0], [[0.0, 0.0, 0.0]], loss_factor=0.1)
    >>> damping_table(Damping(LossFactor(0.02)), mass), damping_table(Damping(FromMaterials()), mass)["loss_factors"]
    ({'law': 'LossFactor', 'value': 0.02}, {'given': 0.1})
    """
    table: Table = {"law": type(damping.base).__name__, **asdict(damping.base)}
    if isinstance(damping.base, FromMaterials):
        table["loss_factors"] = {
            part: dict(loss.points) if isinstance(loss, LossByFrequency) else loss
            for part, loss in assembly.loss_factors.items()
        }
    if damping.modes:
        table["modes"] = [asdict(mode) for mode in damping.modes]
    return table
