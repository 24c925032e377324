"""Measured modes, frequency responses and histories from universal files, through pyuff."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.conventions import DIRECTIONS
from femstruct.errors import some_of
from femstruct.files.exchange.uff_codes import HISTORY, QUANTITIES, RESPONSE, Units, direction_of, kind_of
from femstruct.files.exchange.uff_sets import HEADER, Set, data_sets, wrong_set
from femstruct.modal.frf import frf_unit
from femstruct.modal.measured.measurement import MeasuredFrf, MeasuredHistory, MeasuredModes, MeasuredPlace, Measurement

NODES, TRACES, SHAPES, FUNCTIONS, UNITS = (15, 2411), 82, (55, 2414), 58, 164
CELLS, SYSTEMS = 2412, 2420
KNOWN: Final = (*NODES, TRACES, *SHAPES, FUNCTIONS, HEADER, UNITS, CELLS, SYSTEMS)
NORMAL, COMPLEX = 2, (3, 7)  # kinds of analysis: real modes, complex ones
CARTESIAN: Final = 0
_QUADS: Final = (44, 94)  # numbers of linear quadrilaterals, plane and of shells
_TOO_FEW: Final = "as many values as the head of the data set says"


@dataclass(eq=False)
class _Found:
    """What was read so far. nodes : places by number, in the file's unit."""

    path: Path
    title: str = ""
    units: Units = field(default_factory=Units)
    nodes: dict[int, tuple[float, float, float]] = field(default_factory=dict)
    systems: set[int] = field(default_factory=set)
    turned: set[int] = field(default_factory=set)
    traces: list[tuple[int, int]] = field(default_factory=list)
    quads: list[list[int]] = field(default_factory=list)
    modes: list[tuple[int, float, float, dict[int, Any]]] = field(default_factory=list)
    functions: list[tuple[int, Set]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    left_out: Counter[str] = field(default_factory=Counter)


def read_uff(path: str | Path, length: float = 1.0) -> Measurement:
    """What a universal file has: nodes (15, 2411), lines and cells (82, 2412), modes (55, 2414), functions (58, 58b).

    length : metres in the file's unit of length, where no data set 164 says it: 0.001 of a file in millimetres.

    Values are in SI. Directions with a minus are turned round. Data sets of other kinds, and functions that are neither
    frequency responses nor histories, are named in `notes`. Shapes have any scale; a direction in which no mode moves
    counts as not measured.

    Raises InputError where the package pyuff is not installed and for a file that is not there, InputErrors with the
    line of a data set that cannot be read.

    >>> read = read_uff("hammer_test.uff")  # doctest: +SKIP
    >>> read.modes.frequency_hz, len(read.frfs)  # doctest: +SKIP
    (array([41.2, 88.7]), 36)
    """
    found = _Found(Path(path), units=Units(1.0 / length))
    told = False
    for number, line, content in data_sets(found.path, KNOWN):
        if content is None:
            found.left_out[f"data set {number}"] += 1
            continue
        told |= number == UNITS
        _take(found, number, line, content)
    if not told:
        found.notes.append(f"no data set 164 (units): taken to be in units of {length:g} m, and newtons")
    frfs, histories = _functions(found)
    found.notes += [f"left out: {count} x {what}" for what, count in found.left_out.items()]
    numbers = np.array(sorted(found.nodes), dtype=np.int64)
    points = np.array([found.nodes[number] for number in numbers.tolist()], dtype=np.float64).reshape(-1, 3)
    points = points / found.units.length
    lines, quads = (
        _places(cells, numbers) for cells in (np.reshape(found.traces, (-1, 2)), np.reshape(found.quads, (-1, 4)))
    )
    modes = _modes(found, dict(zip(numbers.tolist(), points, strict=True)))
    return Measurement(found.title, numbers, points, lines, quads, modes, frfs, histories, tuple(found.notes))


def _take(found: _Found, number: int, line: int, content: Set) -> None:
    match number:
        case 151:
            found.title = content.get("model_name", "").strip()
        case 164:
            if not (content["length"] > 0 and content["force"] > 0):
                raise wrong_set(
                    found.path, line, f"factors {content['length']:g}, {content['force']:g}", "positive ones"
                )
            found.units = Units(content["length"], content["force"])
        case 15 | 2411:
            _take_nodes(found, line, content)
        case 2420:
            _take_systems(found, line, content)
        case 82:
            _take_trace(found, content)
        case 2412:
            quads = [cell["nodes_nums"] for kind in _QUADS for cell in content.get(kind, ())]
            found.quads += [nodes for nodes in quads if len(nodes) == 4]
        case 55 | 2414:
            (_take_shape if number == 55 else _take_result)(found, line, content)
        case _:
            found.functions.append((line, content))


def _take_nodes(found: _Found, line: int, content: Set) -> None:
    columns = [np.asarray(content[key], dtype=np.float64) for key in ("node_nums", "x", "y", "z", "def_cs", "disp_cs")]
    if len({len(column) for column in columns}) > 1:
        raise wrong_set(found.path, line, "nodes with numbers missing", "a number and three coordinates of each")
    numbers, x, y, z, own, moved = columns
    places = zip(x.tolist(), y.tolist(), z.tolist(), strict=True)
    found.nodes |= dict(zip(numbers.astype(int).tolist(), places, strict=True))
    found.systems |= set(own.astype(int).tolist()) | set(moved.astype(int).tolist())
    if used := found.systems & found.turned:
        got = f"nodes in coordinate system {some_of(used)}, which is turned or shifted"
        raise wrong_set(found.path, line, got, "nodes in global axes", "export them in the global system")


def _take_systems(found: _Found, line: int, content: Set) -> None:
    """Coordinate systems that are not the global one: turned, shifted, or not Cartesian."""
    same = np.vstack([np.eye(3), np.zeros((1, 3))])
    columns = [content[key] for key in ("CS_sys_labels", "CS_types", "CS_matrices")]
    if len({len(column) for column in columns}) > 1 or any(matrix.shape != same.shape for matrix in columns[2]):
        raise wrong_set(found.path, line, "coordinate systems with numbers missing", "four rows of three of each")
    for label, kind, matrix in zip(*columns, strict=True):
        if kind != CARTESIAN or not np.allclose(matrix, same):
            found.turned.add(label)


def _take_trace(found: _Found, content: Set) -> None:
    """Lines from node to node; a zero lifts the pen."""
    nodes = np.asarray(content["nodes"], dtype=np.int64)
    drawn = (nodes[:-1] > 0) & (nodes[1:] > 0)
    found.traces += list(zip(nodes[:-1][drawn].tolist(), nodes[1:][drawn].tolist(), strict=True))


def _take_shape(found: _Found, line: int, content: Set) -> None:
    """A mode of data set 55."""
    if content["analysis_type"] not in (NORMAL, *COMPLEX):
        found.left_out["data set 55 of another analysis than modes"] += 1
        return
    if content["n_data_per_node"] not in (3, 6):
        got = f"{content['n_data_per_node']} values at a node"
        raise wrong_set(found.path, line, got, "three displacements, or six with rotations")
    if content["analysis_type"] == NORMAL:
        frequency = content["freq"]
        ratio = content["modal_damp_vis"] + 0.5 * content["modal_damp_his"]
    else:
        frequency, ratio = _of_eigenvalue(content["eig"])
    moved = np.stack([content[key] for key in ("r1", "r2", "r3")], axis=1)
    _keep_mode(found, line, frequency, ratio, content["node_nums"], moved)


def _take_result(found: _Found, line: int, content: Set) -> None:
    """A mode of data set 2414."""
    if content["analysis_type"] not in (NORMAL, *COMPLEX) or content["dataset_location"] != 1:
        found.left_out["data set 2414 of another analysis than modes at nodes"] += 1
        return
    values = np.array([row for row in content["data_at_node"] if len(row)], dtype=np.float64)
    if content["data_type"] in (5, 6):
        values = values[:, ::2] + 1j * values[:, 1::2]
    if values.ndim != 2 or values.shape[1] not in (3, 6):
        raise wrong_set(found.path, line, "other values", "three displacements at every node, or six with rotations")
    if content["analysis_type"] == NORMAL:
        frequency = content["record12_field2"]
        ratio = content["record12_field5"] + 0.5 * content["record12_field6"]
    else:
        frequency, ratio = _of_eigenvalue(complex(content["record13_field1"], content["record13_field2"]))
    _keep_mode(found, line, frequency, ratio, content["node_nums"], values[:, :3])


def _of_eigenvalue(eigenvalue: complex) -> tuple[float, float]:
    """Frequency [Hz] and damping ratio [1] of lambda [1/s]."""
    size = abs(eigenvalue)
    return size / (2.0 * np.pi), -eigenvalue.real / size if size else 0.0


def _keep_mode(found: _Found, line: int, frequency: float, ratio: float, nodes: Any, moved: Any) -> None:
    if not (np.isfinite(moved).all() and np.isfinite([frequency, ratio]).all() and frequency >= 0):
        raise wrong_set(found.path, line, f"a mode of {frequency:g} Hz", "finite numbers and a frequency >= 0")
    if len(moved) != len(nodes):
        raise wrong_set(found.path, line, f"{len(moved)} rows of values of {len(nodes)} nodes", "one of each")
    found.modes.append((line, frequency, ratio, dict(zip(np.asarray(nodes, int).tolist(), moved, strict=True))))


def _modes(found: _Found, points: dict[int, Floats]) -> MeasuredModes | None:
    if not found.modes:
        return None
    order = sorted(found.modes, key=lambda mode: mode[1])
    numbers = sorted({node for *_, moved in order for node in moved})
    for line, _, _, moved in order:
        if lost := [node for node in moved if node not in points]:
            got = f"a mode with nodes without places: {some_of(lost)}"
            raise wrong_set(found.path, line, got, "their coordinates in data set 15 or 2411")
    none = np.zeros(3)
    shapes = np.stack([np.array([moved.get(node, none) for node in numbers]) for *_, moved in order], axis=2)
    return MeasuredModes(
        np.array([frequency for _, frequency, _, _ in order]),
        np.array([ratio for _, _, ratio, _ in order]),
        shapes,
        np.array([points[node] for node in numbers]),
        (shapes != 0.0).any(axis=2),
    )


def _functions(found: _Found) -> tuple[tuple[MeasuredFrf, ...], tuple[MeasuredHistory, ...]]:
    frfs: list[MeasuredFrf] = []
    histories: list[MeasuredHistory] = []
    for line, one in found.functions:
        x, values = np.asarray(one["x"]), np.asarray(one["data"])
        count = one["num_pts"]
        if min(len(x), len(values)) < count:
            raise wrong_set(found.path, line, f"{min(len(x), len(values))} values of {count}", _TOO_FEW)
        x, values = x[:count], values[:count]  # some programs fill the last line with zeros
        if not (np.isfinite(x).all() and np.isfinite(values).all()):
            raise wrong_set(found.path, line, "nan or infinity", "finite numbers")
        if max(abs(one["rsp_dir"]), abs(one["ref_dir"])) > len(DIRECTIONS):
            got = f"directions {one['rsp_dir']} and {one['ref_dir']}"
            raise wrong_set(found.path, line, got, "-6 to 6: x, y, z and the rotations about them, or 0")
        direction, sign = direction_of(one["rsp_dir"])
        place = MeasuredPlace(one["rsp_node"], direction, _name(one["rsp_ent_name"]))
        above = one["ordinate_spec_data_type"]
        scale = sign * found.units.si(
            above, one["rsp_dir"], one["ordinate_axis_units_lab"], _exponents(one, "ordinate")
        )
        if one["func_type"] == RESPONSE:
            frfs.append(_frf(found.units, one, place, scale, x, values))
        elif one["func_type"] == HISTORY and not np.iscomplexobj(values):
            what, unit = QUANTITIES.get(above, ("unknown", one["ordinate_axis_units_lab"].strip()))
            histories.append(MeasuredHistory(place, what, x, values * scale, unit))
        else:
            found.left_out[f"function of kind {one['func_type']} (no frequency response, no history)"] += 1
    return tuple(frfs), tuple(histories)


def _frf(units: Units, one: Set, place: MeasuredPlace, scale: float, x: Any, values: Any) -> MeasuredFrf:
    direction, sign = direction_of(one["ref_dir"])
    drive = MeasuredPlace(one["ref_node"], direction, _name(one["ref_ent_name"]))
    above, below = one["ordinate_spec_data_type"], one["orddenom_spec_data_type"]
    scale *= sign / units.si(below, one["ref_dir"], one["orddenom_axis_units_lab"], _exponents(one, "orddenom"))
    kind = kind_of(above, below)
    labels = (one[f"{which}_axis_units_lab"].strip() for which in ("ordinate", "orddenom"))
    unit = "/".join(labels) if kind == "unknown" else frf_unit(kind, direction or "z", place.direction or "z")
    return MeasuredFrf(drive, place, kind, x, np.asarray(values * scale, dtype=np.complex128), unit)


def _exponents(one: Set, which: str) -> tuple[int, int]:
    return one.get(f"{which}_len_unit_exp", 0), one.get(f"{which}_force_unit_exp", 0)


def _name(entity: str) -> str:
    return "" if entity.strip().upper() in ("NONE", "") else entity.strip()


def _places(cells: Any, numbers: Any) -> Any:
    """Numbers of nodes as places in the sorted list; cells of nodes that are not there are not drawn."""
    cells = np.asarray(cells, dtype=np.int64)
    there = np.isin(cells, numbers).all(axis=1)
    return np.searchsorted(numbers, cells[there])
