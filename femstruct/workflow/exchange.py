"""What `export`, `reduce` and `mac` do: matrices, modes and responses to other programs, measured modes from them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np

from femstruct.assembly.matrices import Assembly, assemble
from femstruct.errors import Finding, InputError
from femstruct.files.datasets import nodes_alone
from femstruct.files.frf_files import write_frf_csv, write_frf_npz, write_frf_uff
from femstruct.files.matrices_file import write_mtx, write_npz
from femstruct.files.mode_files import write_vtu
from femstruct.files.tables import finding_table, number
from femstruct.files.uff import pyuff, read_uff, write_uff
from femstruct.files.writing import short
from femstruct.findings.catalogue import rank_findings
from femstruct.language.models import ModelFile, read_model_file
from femstruct.modal.basis import ForceRow, ModalBasis
from femstruct.modal.damping import Damping, FromMaterials, with_damping
from femstruct.modal.frf import KINDS, frf, moves_probe
from femstruct.modal.measured import Correlation, FrfTable, MeasuredModes, Measurement, correlation, frf_table
from femstruct.modal.steady import Highest, largest_peak, missed_peak
from femstruct.modal.substructures import reduce_part
from femstruct.model.materials import LossByFrequency
from femstruct.model.mesher import mesh_structure
from femstruct.model.model import Model, Refined, refine_model
from femstruct.model.probe import Probe
from femstruct.model.structure import Structure
from femstruct.study.asked import Extent, Spot
from femstruct.study.study import Study
from femstruct.units import quantity
from femstruct.workflow.bases import Solved, add_cavities, add_cavities_for_tables, solve, with_positions
from femstruct.workflow.model_answers import STRESS, checked_frf_request, finer
from femstruct.workflow.modes import DEFAULT_MODES, damp_computed_modes
from femstruct.workflow.provenance import Progress, provenance
from femstruct.workflow.responses import lines_of, response_row
from femstruct.workflow.study_findings import all_findings

# ----------------------------------------------------------------------------------------------------------------------
# Several frequency responses of a model at once, as the command line asks for them.
# ----------------------------------------------------------------------------------------------------------------------

Table = dict[str, Any]
To = Literal["csv", "npz", "uff"]


def frfs_of(
    path: Path,
    drives: Sequence[str],
    responses: Sequence[str],
    band: str,
    step: str,
    kind: str,
    overrides: tuple[str, ...] = (),
) -> tuple[FrfTable, Table, dict[str, Any]]:
    """Responses of a model file to several drives by modes with residuals, as a noun and as a table for JSON, and the
    positions of its points by name [m]."""
    for option, names in (("--drive", drives), ("--response", responses)):
        if twice := sorted({name for name in names if names.count(name) > 1}):
            raise InputError(option, got=f"'{twice[0]}' twice", expected="each place once")
    requests = [checked_frf_request(drive, response, band, step, kind) for drive in drives for response in responses]
    if stressed := [str(one.response) for one in requests if one.response.what == STRESS]:
        raise InputError("--response", got=f"'{stressed[0]}' with others or --to", expected="one drive and one stress")
    top = requests[0].band[1]
    source = read_model_file(path, overrides)
    with with_positions(source):
        asking = Study(source.title, source.structure, source.damping, Extent(), frf=tuple(requests))
        solved = solve(source.structure, Extent(up_to_hz=2.5 * top), (asking,))
        basis = add_cavities(with_damping(solved.basis, source.damping), solved)
        findings = all_findings(
            solved, basis, requests=requests[:1], up_to_hz=top
        )  # they are of the band, not of places
        pushed = {str(spot): _probe(spot, solved, "--drive") for spot in dict.fromkeys(one.drive for one in requests)}
        receivers: dict[str, Probe | ForceRow] = {}
        for spot in dict.fromkeys(one.response for one in requests):
            row = response_row(spot, solved.places, basis, "--response")
            receivers[str(spot)] = _moving(spot, row, solved, "--response") if isinstance(row, Probe) else row
        chosen = next((one for one in KINDS if one == kind), None)
        tabled = partial(frf_table, basis, pushed, receivers, kind=chosen, title=source.title)
        table = tabled(lines_of(requests[0]))
        missed = _most_missed(table, basis, pushed, receivers)
        if not step and missed is not None:
            table = tabled(lines_of(replace(requests[0], step=finer(requests[0], missed[0].needed))))
            missed = _most_missed(table, basis, pushed, receivers)
        findings = rank_findings((*findings, *(() if missed is None else _missed_peaks(table, *missed))))
    answer = {
        "title": source.title,
        "frequency_hz": table.frequency_hz.tolist(),
        "responses": [
            {
                "drive": drive,
                "response": response,
                "kind": table.kinds[i],
                "unit": table.unit(i, j),
                "real": table.values[i, j].real.tolist(),
                "imag": table.values[i, j].imag.tolist(),
            }
            for j, drive in enumerate(table.drives)
            for i, response in enumerate(table.responses)
        ],
        "findings": [finding_table(finding) for finding in findings],
    }
    return table, answer, {name: point.position for name, point in solved.places.points.items()}


def refuse_unknown(to: str, method: str) -> None:
    """Raise InputError, before anything is computed, for what a table of responses cannot be."""
    if method != "modal":
        raise InputError("--method", got=f"'{method}' of several responses, or with --to", expected="modal")
    if to == "uff":
        pyuff()


def write_frfs(table: FrfTable, positions: dict[str, Any], to: To, folder: Path, model: Path, command: str) -> Path:
    """Write a table of responses to MODEL.frf.csv, .npz or .uff in a folder; returns the file."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{short(model.name.removesuffix('.yaml').removesuffix('.yml'))}.frf.{to}"
    if to == "csv":
        return write_frf_csv(table, path)
    if to == "npz":
        return write_frf_npz(table, path, {"provenance": provenance(command)})
    return write_frf_uff(table, positions, path)


def _most_missed(
    table: FrfTable, basis: ModalBasis, drives: Mapping[str, Probe], responses: Mapping[str, Probe | ForceRow]
) -> tuple[Highest, int, int] | None:
    """The largest value of a response, and which response and drive it is of: that of all which the lines miss most."""
    found: list[tuple[Highest, int, int]] = []
    for j, drive in enumerate(drives.values()):
        for i, response in enumerate(responses.values()):
            respond = partial(frf, basis, drive, response, kind=table.kinds[i])
            one = largest_peak(respond, basis, table.frequency_hz, np.abs(table.values[i, j]))
            found += [] if one is None else [(one, i, j)]
    return max(found, key=lambda each: each[0].missed, default=None)


def _missed_peaks(table: FrfTable, one: Highest, response: int, drive: int) -> list[Finding]:
    name = f"{table.responses[response]} / {table.drives[drive]}"
    return [
        replace(finding, message=f"{name}: {finding.message}")
        for finding in missed_peak(one, table.unit(response, drive))
    ]


def _probe(spot: Spot, solved: Solved, option: str) -> Probe:
    return _moving(spot, solved.places.point(spot.name, option).probe(spot.what), solved, option)


def _moving(spot: Spot, probe: Probe, solved: Solved, option: str) -> Probe:
    if not moves_probe(solved.basis, probe):
        expected = "a direction in which the structure can move"
        raise InputError(option, got=f"'{spot}', no mode moves along {spot.what}", expected=expected)
    return probe


# ----------------------------------------------------------------------------------------------------------------------
# Modes of a model in files of other programs.
# ----------------------------------------------------------------------------------------------------------------------


def write_modes(
    source: ModelFile, to: str, folder: Path, name: str, extent: Extent, tell: Progress, sets: Sequence[int] = ()
) -> list[Path]:
    """Write the modes of a model to NAME.uff or NAME.vtu; returns the file.

    Parameters
    ----------
    sets : Sequence[int]
        As of `write_uff`.
    """
    if to == "uff":
        pyuff()  # told before the work
    with with_positions(source):
        tell("modes")
        solved = solve(source.structure, extent)
        basis = add_cavities_for_tables(damp_computed_modes(solved.basis, source.damping), solved)
    return write_basis(basis, solved.model, source.title, to, folder, name, sets)


def write_basis(
    basis: ModalBasis,
    model: Model | None,
    title: str,
    to: str,
    folder: Path,
    name: str,
    sets: Sequence[int] = (),
) -> list[Path]:
    """Write the modes of a basis to NAME.uff or NAME.vtu; returns the file.

    Parameters
    ----------
    model : Model | None
        None of a closed form.
    sets : Sequence[int]
        As of `write_uff`.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{short(name)}.{to}"
    if to == "vtu":
        return [write_vtu(basis, model, path, basis.modes.stop)]
    return [write_uff(modes_as_measured(title, basis, model), path, sets)]


def modes_as_measured(title: str, basis: ModalBasis, model: Model | None) -> Measurement:
    """The modes of a basis as if every node had been measured, mass-normalised, cells between the nodes."""
    shown = nodes_alone(basis) if model is None else refine_model(model, 1)
    points, quads, lines, first = _once(shown)
    k = basis.modes
    modes = MeasuredModes(
        basis.frequency_hz[k],
        np.nan_to_num(basis.damping_ratio[k]),
        shown.displacement(basis.shapes[:, :, k])[first],
        points,
        np.ones(points.shape, dtype=bool),
    )
    return Measurement(title, np.arange(1, len(points) + 1), points, lines, quads, modes)


def _once(shown: Refined) -> tuple[Any, Any, Any, Any]:
    """Points, cells and first places without what is drawn twice: nodes of one part that several cells share.

    Nodes of two parts at one place stay two: they may move apart.
    """
    keys = np.column_stack([shown.points, shown.part_of_point])
    _, first, back = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    back = back.ravel()
    order = np.argsort(first)
    new = np.empty_like(order)
    new[order] = np.arange(len(order))
    return shown.points[first[order]], new[back[shown.quads]], new[back[shown.lines]], first[order]


# ----------------------------------------------------------------------------------------------------------------------
# A model, or the tables of a results file, as files of other programs.
# ----------------------------------------------------------------------------------------------------------------------

Ending = Literal["csv", "xlsx", "npz", "mtx", "uff", "vtu"]
OF_RESULTS: Final = ("csv", "xlsx")
OF_MATRICES: Final = ("npz", "mtx")
OF_MODES: Final = ("uff", "vtu")


def export_source(
    file: Path,
    to: Ending,
    folder: Path,
    extent: Extent | None,
    overrides: tuple[str, ...],
    command: str,
    tell: Progress,
    data_sets: str = "",
) -> list[Path]:
    """Write what there is in a file to a folder; returns the files.

    Parameters
    ----------
    file : Path
        Results of a run, a sweep or an optimisation for `csv` and `xlsx`, a model for `npz` and `mtx`, a run or a model
        for modes.
    extent : Extent | None
        How many modes of a model, for `uff` and `vtu`.
    data_sets : str
        Of a universal file, as in "15,2414"; "" for the usual ones.

    Raises
    ------
    InputError
        For the other kind of file, and for a number of modes or data sets where none are written.
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
    with with_positions(source):
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
    from femstruct.files.campaign_files import SWEEP, campaign_sheets, read_found, read_swept
    from femstruct.files.results_file import campaign_file, read_results, results_file
    from femstruct.files.sheets import sheets, write_csv, write_workbook

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
    from femstruct.files.results_file import read_results, results_file

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


# ----------------------------------------------------------------------------------------------------------------------
# Measured modes of a universal file beside the modes of a model, as the command line asks for it.
# ----------------------------------------------------------------------------------------------------------------------

BEYOND: Final = 1.5  # times the highest measured frequency: a model too stiff by a third still has its partner
DIVISIONS: Final = 4
_TOO_FEW: Final = (
    "a group of near-equal frequencies has as many modes as displacements were measured, so everything is like it; "
    "use a smaller --near, or more places"
)


def compare_measured_modes(
    path: Path,
    file: Path,
    extent: Extent | None,
    near: str,
    length: str,
    overrides: tuple[str, ...],
    tell: Progress,
) -> Table:
    """Table of measured modes with their partners in a model, and of the MAC of all of them.

    Parameters
    ----------
    extent : Extent | None
        Of the model's modes; None for all up to 1.5 times the highest measured frequency.

    Raises
    ------
    InputError
        For a file without modes, and as `correlation` and `read_uff`.
    """
    width, unit = _option(near, "--near", "ratio"), _option(f"1 {length}", "--length", "length")
    if not 0.0 <= width < 1.0:
        raise InputError("--near", got=near, expected="0 % to below 100 %")
    measurement = read_uff(file, unit)
    measured = measurement.modes
    if measured is None:
        raise InputError(str(file), got="no modes", expected="modes in data sets 55 or 2414")
    highest = BEYOND * float(measured.frequency_hz[-1])
    if extent is None and not highest > 0.0:
        raise InputError(str(file), got="rigid modes alone", expected="a frequency above 0 Hz", do="give --count")
    source = read_model_file(path, overrides)
    with with_positions(source):
        tell("modes")
        solved = solve(source.structure, extent or Extent(up_to_hz=highest))
        if solved.model is None:
            raise InputError(str(path), got="a structure in closed form", expected="a model with parts")
        basis = add_cavities_for_tables(damp_computed_modes(solved.basis, source.damping), solved)
        found = correlation(measured, basis, refine_model(solved.model, DIVISIONS), width)
    return {
        "title": source.title,
        "measured": measurement.title or file.name,
        "places": len(measured.points),
        "directions": found.directions,
        "farthest_m": float(found.distances.max(initial=0.0)),
        "notes": [*measurement.notes, *([_TOO_FEW] if found.too_few else [])],
        "modes": [_row(measured, basis, found, mode) for mode in range(len(measured.frequency_hz))],
        "model_frequency_hz": basis.frequency_hz[basis.modes].tolist(),
        "mac": found.pairs.mac.tolist(),
    }


def _row(measured: MeasuredModes, basis: ModalBasis, found: Correlation, mode: int) -> Table:
    pairs = found.pairs
    partner = int(pairs.partner[mode])
    own, hz = float(measured.frequency_hz[mode]), float(basis.frequency_hz[partner])
    together = np.flatnonzero(pairs.groups_b == pairs.groups_b[partner])
    return {
        "mode": mode + 1,
        "frequency_hz": own,
        "damping_ratio": float(measured.damping_ratio[mode]),
        "model_mode": partner + 1,
        "model_frequency_hz": hz,
        "model_damping_ratio": number(basis.damping_ratio[partner]),
        "difference": hz / own - 1.0 if own else None,
        "mac": float(pairs.mac[mode, partner]),
        "group_mac": pairs.alike(mode),
        "group": (together + 1).tolist(),
    }


def _option(text: str, option: str, dimension: str) -> float:
    try:
        return quantity(text, dimension)
    except InputError as error:
        raise InputError(option, got=error.got, expected=error.expected, do=error.do) from error


# ----------------------------------------------------------------------------------------------------------------------
# `femstruct reduce`: one part of a model as a file of reduced matrices.
# ----------------------------------------------------------------------------------------------------------------------


def reduce_model(
    path: Path, part: str, extent: Extent, output: Path, overrides: tuple[str, ...], command: str, tell: Progress
) -> Table:
    """Write one part of a model, reduced to what others touch of it; returns what was written.

    Raises InputError for a model in closed form and for a part that cannot be reduced.
    """
    if output.suffix != ".npz":
        raise InputError("--output", got=f"'{output}'", expected="a file NAME.npz")
    source = read_model_file(path, overrides)
    with with_positions(source):
        if not isinstance(source.structure, Structure):
            raise InputError(str(path), got="a structure in closed form", expected="a model with parts")
        tell("reduction")
        model = mesh_structure(source.structure)
        found = reduce_part(model, part, up_to=extent.up_to_hz, count=extent.count)
    counts = {
        "interface nodes": len(found.interface),
        "interface degrees of freedom": len(found.reduced.boundary),
        "modes": found.reduced.n_modes,
        "residual vectors": len(found.reduced.frequency_hz) - found.reduced.n_modes,
        "degrees of freedom": found.assembly.K.shape[0],
        "degrees of freedom before": len(found.reduced.recovery),
    }
    about = {
        "title": f"{part} of {source.title}",
        "reduction": counts,
        "sets": {name: nodes.tolist() for name, nodes in found.sets.items()},
        "provenance": provenance(command),
    }
    more = {
        "interface": found.interface,
        "quads": found.quads,
        "lines": found.lines,
        "axes": found.axes,
        "girth": found.girth,
        "depth": found.depth,
        "beside": found.beside,
        "loss_factor": found.loss_factor,
        "share_names": np.array([one.name for one in found.shares], dtype=np.str_),
        "share_losses": np.array([one.loss_factor for one in found.shares], dtype=np.float64),
        "share_K": np.array([one.stiffness.toarray() for one in found.shares]),
        "reduced_to_hz": extent.up_to_hz or found.reduced.frequency_hz[: found.reduced.n_modes].max(initial=0.0),
    }
    output.parent.mkdir(parents=True, exist_ok=True)
    (written,) = write_npz(found.assembly, output.parent, output.stem, about, more)
    return {"written": str(written), **counts, "supports": list(found.supports), "sets": sorted(found.sets)}


def export_lines(found: Table) -> tuple[str, ...]:
    """What was written, in lines for the terminal."""
    shown = ("written", "interface nodes", "interface degrees of freedom", "modes")
    lines = [f"{word}: {found[word]}" for word in shown]
    lines.append(
        f"residual vectors: {found['residual vectors']}; {found['degrees of freedom']} in place of "
        f"{found['degrees of freedom before']} degrees of freedom"
    )
    lines += [f"supports {one}: not in the file; hold set '{one}' again where it is used" for one in found["supports"]]
    return tuple(lines)
