"""Modes, frequency responses and histories as universal files, through pyuff."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.errors import InputError
from femstruct.files.exchange.uff_codes import (
    DISPLACEMENT,
    FREQUENCY,
    HISTORY,
    KINDS,
    QUANTITIES,
    RESPONSE,
    TIME,
    direction_code,
)
from femstruct.files.exchange.uff_results import STRUCTURAL, TRANSLATIONS, eigenvalue, result_lines
from femstruct.files.exchange.uff_sets import LINES, Set, write_sets
from femstruct.modal.measured.measurement import MeasuredFrf, MeasuredHistory, MeasuredModes, Measurement

WIDTH: Final = 80  # characters of a line of text
NAME: Final = 10  # of a name of a place
LABEL: Final = 20  # of a unit
TRACE: Final = 80  # lines of one data set 82, which holds 250 numbers, three for each
ROD, QUAD = 11, 44  # kinds of cells; of the kinds of bars pyuff writes the line on sections for this one alone
OF_NODES: Final = (2411, 15)  # data sets, those without which a file is written by default first
OF_MODES: Final = (55, 2414)
RESULTS: Final = 2414


def write_uff(measurement: Measurement, path: str | Path, sets: Sequence[int] = (2411, 55)) -> Path:
    """Write a universal file: header, units (SI), nodes, cells (2412), lines (82), modes, functions (58).

    sets : numbers of the data sets of nodes, 15 or 2411, and of modes, 55 or 2414, as the program that reads the file
    knows them. Shapes and frequencies of modes have six digits there, places in 15, too, values of functions twelve;
    frequencies of functions are written one by one where the file's six digits do not hold their step.

    Raises InputError where the package pyuff is not installed, and for other data sets.

    >>> write_uff(read_uff("hammer_test.unv"), "hammer_test.uff")  # doctest: +SKIP
    """
    write_sets(_sets(measurement, *_chosen(sets)), Path(path))
    return Path(path)


def _chosen(sets: Sequence[int]) -> tuple[int, int]:
    """The data sets of nodes and of modes out of some numbers."""
    nodes, modes = ([number for number in sets if number in known] for known in (OF_NODES, OF_MODES))
    if len(nodes) > 1 or len(modes) > 1 or len(nodes) + len(modes) < len(sets):
        got = ", ".join(map(str, sets))
        raise InputError("data sets", got=got, expected="one of nodes, 15 or 2411, and one of modes, 55 or 2414")
    return (*nodes, OF_NODES[0])[0], (*modes, OF_MODES[0])[0]


def _sets(measurement: Measurement, of_nodes: int, of_modes: int) -> Iterator[Set]:
    program = f"femstruct {version('femstruct')}"
    title = text(measurement.title)
    yield {
        "type": 151,
        "model_name": title,
        "description": "written by femstruct",
        "db_app": program,
        "program": program,
    }
    factors = {"length": 1.0, "force": 1.0, "temp": 1.0, "temp_offset": 273.15}
    yield {"type": 164, "units_code": 1, "units_description": "SI: Meter (newton)", "temp_mode": 2, **factors}
    nodes = measurement.nodes
    if len(nodes):
        none = np.zeros(len(nodes), dtype=np.int64)
        places = dict(zip("xyz", measurement.points.T, strict=True))
        yield {"type": of_nodes, "node_nums": nodes, "def_cs": none, "disp_cs": none, "color": none + 1, **places}
    if len(measurement.quads) or len(measurement.lines):
        yield _cells(nodes[measurement.lines], nodes[measurement.quads])
        yield from _traces(nodes[_edges(measurement.lines, measurement.quads)])
    if measurement.modes is not None:
        yield from _mode_sets(measurement.modes, nodes, measurement.points, of_modes)
    for frf in measurement.frfs:
        yield _frf_set(frf)
    for history in measurement.histories:
        yield _history_set(history)


def text(words: str, most: int = WIDTH) -> str:
    """A line of text that a universal file holds: one line of ASCII, cut; NONE where nothing is left.

    >>> text("a floor\\n10 µm"), text("µ")
    ('a floor 10 ?m', '?')
    """
    return " ".join(words.split()).encode("ascii", "replace").decode("ascii")[:most] or "NONE"


def _cells(lines: Integers, quads: Integers) -> Set:
    def cell(number: int, kind: int, nodes: list[int]) -> Set:
        head = {"element_nums": number, "fe_descriptor": kind, "phys_table": 1, "mat_table": 1, "color": 1}
        sections = {"beam_orientation": 0, "beam_foreend_cross": 1, "beam_aftend_cross": 1}
        return {**head, **sections, "num_nodes": len(nodes), "nodes_nums": nodes}

    bars = [cell(number, ROD, nodes) for number, nodes in enumerate(lines.tolist(), 1)]
    faces = [cell(number, QUAD, nodes) for number, nodes in enumerate(quads.tolist(), len(bars) + 1)]
    return {"type": 2412, ROD: bars, QUAD: faces}


def _edges(lines: Integers, quads: Integers) -> Integers:
    """All lines and sides of cells once [m, 2]."""
    sides = np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2)
    edges = np.sort(np.concatenate([lines, sides]), axis=1)
    return np.unique(edges[edges[:, 0] != edges[:, 1]], axis=0)


def _traces(edges: Integers) -> Iterator[Set]:
    for number, start in enumerate(range(0, len(edges), TRACE), 1):
        some = edges[start : start + TRACE]
        nodes = np.concatenate([some, np.zeros((len(some), 1), np.int64)], axis=1).ravel()[:-1]
        yield {
            "type": 82,
            "trace_num": number,
            "n_nodes": len(nodes),
            "color": 1,
            "id": f"lines {number}",
            "nodes": nodes,
        }


def _mode_sets(modes: MeasuredModes, nodes: Integers, points: Floats, number: int) -> Iterator[Set]:
    numbers = nodes if len(modes.points) == len(points) and np.array_equal(modes.points, points) else None
    if numbers is None:
        numbers = _numbers_at(modes.points, nodes, points)
    if number == RESULTS:
        yield from ({"type": RESULTS, LINES: result_lines(modes, k, numbers)} for k in range(len(modes.frequency_hz)))
        return
    is_complex = np.iscomplexobj(modes.shapes)
    for k, (frequency, ratio) in enumerate(zip(modes.frequency_hz.tolist(), modes.damping_ratio.tolist(), strict=True)):
        one: Set = {
            "type": 55,
            "id1": f"mode {k + 1}, {frequency:.6g} Hz, damping ratio {ratio:.4g}",
            "model_type": STRUCTURAL,
            "data_ch": TRANSLATIONS,
            "spec_data_type": DISPLACEMENT,
            "load_case": 1,
            "mode_n": k + 1,
            "node_nums": numbers,
            **{f"r{axis + 1}": modes.shapes[:, axis, k] for axis in range(3)},
        }
        if is_complex:
            yield {**one, "analysis_type": 3, "eig": eigenvalue(frequency, ratio)}
        else:
            damping = {"modal_m": 1.0, "modal_damp_vis": ratio, "modal_damp_his": 0.0}
            yield {**one, "analysis_type": 2, "freq": frequency, **damping}


def _numbers_at(some: Floats, nodes: Integers, points: Floats) -> Integers:
    """Numbers of the nodes at some of the points."""
    where = {tuple(place): number for number, place in zip(nodes.tolist(), points.tolist(), strict=True)}
    return np.array([where[tuple(place)] for place in some.tolist()], dtype=np.int64)


def _frf_set(frf: MeasuredFrf) -> Set:
    above, below = next((codes for kind, codes in KINDS.items() if kind == frf.kind), (0, 0))
    labels = [QUANTITIES[code][1] if code else "" for code in (above, below)]
    if frf.kind == "unknown":
        labels = [*frf.unit.split("/", 1), ""][:2]
    drive = {"ref_ent_name": text(frf.drive.name, NAME), "ref_node": frf.drive.node}
    return {
        **_function(
            RESPONSE, frf.response.node, frf.response.direction, frf.response.name, frf.frequency_hz, frf.values
        ),
        **drive,
        "ref_dir": direction_code(frf.drive.direction),
        "id1": text(f"{frf.kind} {frf.response} / {frf.drive}"),
        "abscissa_spec_data_type": FREQUENCY,
        "abscissa_axis_lab": "Frequency",
        "abscissa_axis_units_lab": "Hz",
        "ordinate_spec_data_type": above,
        "ordinate_axis_units_lab": text(labels[0], LABEL),
        "orddenom_spec_data_type": below,
        "orddenom_axis_units_lab": text(labels[1], LABEL),
    }


def _history_set(history: MeasuredHistory) -> Set:
    code = next((code for code, (what, _) in QUANTITIES.items() if what == history.what), 0)
    place = history.place
    return {
        **_function(HISTORY, place.node, place.direction, place.name, history.t, history.values),
        "ref_ent_name": "NONE",
        "ref_node": 0,
        "ref_dir": 0,
        "id1": text(f"{history.what} {place}"),
        "abscissa_spec_data_type": TIME,
        "abscissa_axis_lab": "Time",
        "abscissa_axis_units_lab": "s",
        "ordinate_spec_data_type": code,
        "ordinate_axis_units_lab": text(history.unit, LABEL),
        "orddenom_spec_data_type": 0,
    }


def _function(kind: int, node: int, direction: str, name: str, x: Floats, values: Any) -> Set:
    return {
        "type": 58,
        "func_type": kind,
        "rsp_ent_name": text(name, NAME),
        "rsp_node": node,
        "rsp_dir": direction_code(direction),
        "x": x,
        "data": np.array(values),
        "abscissa_spacing": int(evenly(x)),
        "z_axis_value": 0.0,
    }


def evenly(x: Floats) -> bool:
    """Whether a first value and a step of six digits each give all of them, to a millionth of the step.

    >>> evenly(np.arange(500) * 0.5), evenly(np.arange(500) * np.pi), evenly(np.array([1.0, 2.0, 4.0]))
    (True, False, False)
    """
    if len(x) < 2:
        return False
    start, step = float(f"{x[0]:.5e}"), float(f"{x[1] - x[0]:.5e}")
    return bool(np.abs(start + step * np.arange(len(x)) - x).max() <= 1e-6 * abs(step))
