"""Several frequency responses of a model at once, as the command line asks for them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np

from femstruct.errors import Finding, InputError
from femstruct.files.atomic import short
from femstruct.files.exchange.frf_files import write_frf_csv, write_frf_npz, write_frf_uff
from femstruct.files.exchange.uff_sets import pyuff
from femstruct.files.tables.finding_tables import finding_table
from femstruct.findings.catalogue import ranked
from femstruct.language import read_model_file
from femstruct.modal.basis import ForceRow, ModalBasis
from femstruct.modal.damping import with_damping
from femstruct.modal.frf import KINDS, frf, moves
from femstruct.modal.measured.frf_table import FrfTable, frf_table
from femstruct.modal.steady.between_lines import Highest, highest, missed_peak
from femstruct.model.probe import Probe
from femstruct.study.asked import Extent, Spot
from femstruct.study.study import Study
from femstruct.workflow.check.asked_response import asked_for, finer
from femstruct.workflow.check.asked_stress import STRESS
from femstruct.workflow.judgement.all_findings import all_findings
from femstruct.workflow.run.provenance import provenance
from femstruct.workflow.stages.modal_bases import Solved, in_air, solve
from femstruct.workflow.stages.positions import positioned
from femstruct.workflow.stages.responses import lines_of, response_row

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
    requests = [asked_for(drive, response, band, step, kind) for drive in drives for response in responses]
    if stressed := [str(one.response) for one in requests if one.response.what == STRESS]:
        raise InputError("--response", got=f"'{stressed[0]}' with others or --to", expected="one drive and one stress")
    top = requests[0].band[1]
    source = read_model_file(path, overrides)
    with positioned(source):
        asking = Study(source.title, source.structure, source.damping, Extent(), frf=tuple(requests))
        solved = solve(source.structure, Extent(up_to_hz=2.5 * top), (asking,))
        basis = in_air(with_damping(solved.basis, source.damping), solved)
        findings = all_findings(
            solved, basis, requests=requests[:1], up_to_hz=top
        )  # they are of the band, not of places
        pushed = {str(spot): _probe(spot, solved, "--drive") for spot in dict.fromkeys(one.drive for one in requests)}
        heard: dict[str, Probe | ForceRow] = {}
        for spot in dict.fromkeys(one.response for one in requests):
            row = response_row(spot, solved.places, basis, "--response")
            heard[str(spot)] = _moving(spot, row, solved, "--response") if isinstance(row, Probe) else row
        chosen = next((one for one in KINDS if one == kind), None)
        tabled = partial(frf_table, basis, pushed, heard, kind=chosen, title=source.title)
        table = tabled(lines_of(requests[0]))
        missed = _most_missed(table, basis, pushed, heard)
        if not step and missed is not None:
            table = tabled(lines_of(replace(requests[0], step=finer(requests[0], missed[0].needed))))
            missed = _most_missed(table, basis, pushed, heard)
        findings = ranked((*findings, *(() if missed is None else _told(table, *missed))))
    told = {
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
    return table, told, {name: point.position for name, point in solved.places.points.items()}


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
            one = highest(respond, basis, table.frequency_hz, np.abs(table.values[i, j]))
            found += [] if one is None else [(one, i, j)]
    return max(found, key=lambda each: each[0].missed, default=None)


def _told(table: FrfTable, one: Highest, response: int, drive: int) -> list[Finding]:
    name = f"{table.responses[response]} / {table.drives[drive]}"
    return [replace(told, message=f"{name}: {told.message}") for told in missed_peak(one, table.unit(response, drive))]


def _probe(spot: Spot, solved: Solved, option: str) -> Probe:
    return _moving(spot, solved.places.point(spot.name, option).probe(spot.what), solved, option)


def _moving(spot: Spot, probe: Probe, solved: Solved, option: str) -> Probe:
    if not moves(solved.basis, probe):
        expected = "a direction in which the structure can move"
        raise InputError(option, got=f"'{spot}', no mode moves along {spot.what}", expected=expected)
    return probe
