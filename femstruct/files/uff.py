"""Measured modes, frequency responses and histories from universal files, through pyuff."""

from __future__ import annotations

import io
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.conventions import DIRECTIONS, GRAVITY
from femstruct.errors import InputError, InputErrors, list_some, sentence
from femstruct.files.text_tables import content
from femstruct.files.writing import replacing
from femstruct.modal.frf import FrfKind, frf_unit
from femstruct.modal.measured import Kind, MeasuredFrf, MeasuredHistory, MeasuredModes, MeasuredPlace, Measurement

# ----------------------------------------------------------------------------------------------------------------------
# Numbers that universal files have for quantities and directions, and the units that go with them.
#
# Source: descriptions of data sets 55, 58, 164 and 2414, Structural Dynamics Research Laboratory, University of
# Cincinnati, https://www.ceas3.uc.edu/sdrluff/.
# ----------------------------------------------------------------------------------------------------------------------

TIME, FREQUENCY = 17, 18
DISPLACEMENT, VELOCITY, ACCELERATION, FORCE = 8, 11, 12, 13
HISTORY, RESPONSE = 1, 4
KINDS: Final[dict[FrfKind, tuple[int, int]]] = {  # what is over what
    "receptance": (DISPLACEMENT, FORCE),
    "mobility": (VELOCITY, FORCE),
    "accelerance": (ACCELERATION, FORCE),
    "transmissibility": (DISPLACEMENT, DISPLACEMENT),
}
QUANTITIES: Final = {
    DISPLACEMENT: ("displacement", "m"),
    VELOCITY: ("velocity", "m/s"),
    ACCELERATION: ("acceleration", "m/s^2"),
    FORCE: ("force", "N"),
}
GRAVITIES: Final = ("g", "g's", "gn")


@dataclass(frozen=True)
class Units:
    """How many of the file's units a metre and a newton are: data set 164.

    >>> Units(1000.0, 1.0).si(ACCELERATION, 3, "", (0, 0)), Units().si(ACCELERATION, 3, "g", (0, 0))
    (0.001, 9.80665)
    """

    length: float = 1.0
    force: float = 1.0

    def si(self, quantity: int, direction: int, label: str, exponents: tuple[int, int]) -> float:
        """What makes SI of a value; exponents of length and force count for a quantity that is not told.

        A label in g counts whatever the units are: it is what analysers write.
        """
        if quantity == ACCELERATION and label.strip().lower() in GRAVITIES:
            return GRAVITY
        turning = abs(direction) > 3
        if quantity in (DISPLACEMENT, VELOCITY, ACCELERATION):
            exponents = (0, 0) if turning else (1, 0)
        elif quantity == FORCE:
            exponents = (1, 1) if turning else (0, 1)
        return float(self.length ** -exponents[0] * self.force ** -exponents[1])


def kind_of(numerator: int, denominator: int) -> Kind:
    """The kind of a frequency response by what it is of what.

    >>> kind_of(12, 13), kind_of(11, 11), kind_of(0, 13)
    ('accelerance', 'transmissibility', 'unknown')
    """
    if numerator == denominator and numerator in (DISPLACEMENT, VELOCITY, ACCELERATION):
        return "transmissibility"
    return next((kind for kind, codes in KINDS.items() if codes == (numerator, denominator)), "unknown")


def direction_code(direction: str) -> int:
    """1 to 6 of x, y, z, rx, ry, rz; 0 of none."""
    return DIRECTIONS.index(direction) + 1 if direction else 0


def direction_of(code: int) -> tuple[str, float]:
    """The direction of a number and its sign: -3 is z the other way round.

    >>> direction_of(-3), direction_of(0)
    (('z', -1.0), ('', 1.0))
    """
    return (DIRECTIONS[abs(code) - 1] if code else ""), (-1.0 if code < 0 else 1.0)


# ----------------------------------------------------------------------------------------------------------------------
# Data sets of a universal file, as dictionaries of pyuff: opened, read one by one, written one after the other.
# ----------------------------------------------------------------------------------------------------------------------

LARGEST: Final = 4 * 2**30  # bytes
_WHAT: Final = "a universal file (.uff, .unv)"
_MARK: Final = re.compile(rb"    -1(?=[\r\n]|\Z| {74})")  # behind binary data not at the beginning of a line
HEADER: Final = 151
LINES: Final = "lines"  # key of a data set that is written as it stands
Set = dict[Any, Any]


def pyuff() -> Any:
    """The package that reads and writes universal files. Raises InputError where it is not installed."""
    try:
        import pyuff as package
    except ImportError:
        raise InputError(
            "universal files",
            got="no package pyuff",
            expected="it installed",
            do="pip install '.[uff]' in the clone, or pip install pyuff",
        ) from None
    return package


def data_sets(path: Path, numbers: Iterable[int]) -> Iterator[tuple[int, int, Set | None]]:
    """(number, line, content) of the data sets of a file, in their order; content is None of those not wanted,
    and of a header that says things its own way: no number depends on it.

    line : where it begins. Raises InputError for a file that is none, InputErrors with the line of a data set that has
    no end or cannot be read.
    """
    package = pyuff()
    starts = _starts(path)
    file = package.UFF(str(path))
    known = frozenset(numbers)
    for index, (number, line) in enumerate(zip(file.get_set_types().tolist(), starts, strict=True)):
        if number not in known:
            yield number, line, None
            continue
        try:
            with redirect_stdout(io.StringIO()):  # pyuff prints what it does not know
                found = file.read_sets(index)
        except Exception as error:  # pyuff raises nothing more precise
            if number != HEADER:
                raise wrong_set(path, line, f"data set {number}, which cannot be read ({_reason(error)})") from None
            found = None
        yield number, line, found


def _reason(error: BaseException) -> str:
    """What pyuff stumbled over, below the sentences it puts over it."""
    while error.__context__ is not None:
        error = error.__context__
    return str(error)


def wrong_set(path: Path, line: int, got: str, expected: str = "", do: str = "") -> InputErrors:
    """A mistake in the data set that begins in a line."""
    expected = expected or "what the description of the data set says"
    return InputErrors((f"{path}:{line}:1: {sentence('', got, expected, do)}",))


def _starts(path: Path) -> list[int]:
    """Lines, counted from 1, in which data sets begin; those behind binary data count its bytes as text."""
    data = content(path, LARGEST, _WHAT)
    places = [mark.start() for mark in _MARK.finditer(data)]
    if not places:
        got = f"'{path}' without a line of -1 in columns 5 and 6"
        raise InputError(str(path), got=got, expected=_WHAT)
    ends = np.flatnonzero(np.frombuffer(data, np.uint8) == ord("\n"))
    lines: list[int] = (np.searchsorted(ends, places) + 1).tolist()
    if len(lines) % 2:
        raise wrong_set(path, lines[-1], "a data set without its end", "a line with -1", "the file is cut off")
    return lines[::2]


def write_sets(sets: Iterable[Set], path: Path) -> None:
    """Write data sets to a file, whole or not at all. Raises InputError for one that pyuff refuses."""
    package = pyuff()
    with replacing(path) as temporary, temporary.open("wb") as file:
        piece = temporary.with_name(f"{temporary.name}.set")  # pyuff reads all it has written after every set
        try:
            for one in sets:
                if LINES in one:
                    file.write(("\n".join(one[LINES]) + "\n").encode("ascii"))
                    continue
                try:
                    package.UFF(str(piece)).write_sets([one], mode="overwrite")
                except OSError:
                    raise
                except Exception as error:  # pyuff raises nothing more precise
                    got = f"a data set {one['type']} that cannot be written ({_reason(error)})"
                    raise InputError(str(path), got=got, expected="numbers that fit each other") from None
                file.write(piece.read_bytes())
        finally:
            piece.unlink(missing_ok=True)


# ----------------------------------------------------------------------------------------------------------------------
# Measured modes, frequency responses and histories from universal files, through pyuff.
# ----------------------------------------------------------------------------------------------------------------------

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

    Values are in SI. Directions with a minus are turned round. Data sets of other kinds, and functions that are neither
    frequency responses nor histories, are named in `notes`. Shapes have any scale; a direction in which no mode moves
    counts as not measured.

    Parameters
    ----------
    length : float
        Metres in the file's unit of length, where no data set 164 says it: 0.001 of a file in millimetres.

    Raises
    ------
    InputError
        Where the package pyuff is not installed and for a file that is not there, InputErrors with the line of a data
        set that cannot be read.

    Examples
    --------
    >>> read = read_uff("hammer_test.uff")  # doctest: +SKIP
    >>> read.modes.frequency_hz, len(read.frfs)  # doctest: +SKIP
    (array([41.2, 88.7]), 36)
    """
    found = _Found(Path(path), units=Units(1.0 / length))
    has_units = False
    for number, line, found_set in data_sets(found.path, KNOWN):
        if found_set is None:
            found.left_out[f"data set {number}"] += 1
            continue
        has_units |= number == UNITS
        _take(found, number, line, found_set)
    if not has_units:
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
    return Measurement(
        found.title,
        numbers,
        points=points,
        lines=lines,
        quads=quads,
        modes=modes,
        frfs=frfs,
        histories=histories,
        notes=tuple(found.notes),
    )


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
        got = f"nodes in coordinate system {list_some(used)}, which is turned or shifted"
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
            got = f"a mode with nodes without places: {list_some(lost)}"
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


# ----------------------------------------------------------------------------------------------------------------------
# Modes as data set 2414 of universal files, written here: pyuff 2.5 moves the columns of numbers below zero in it.
#
# Source: description of data set 2414, Structural Dynamics Research Laboratory, University of Cincinnati,
# https://www.ceas3.uc.edu/sdrluff/.
# ----------------------------------------------------------------------------------------------------------------------

AT_NODES: Final = 1
STRUCTURAL, TRANSLATIONS = 1, 2
NORMAL_2414, COMPLEX_2414 = 2, 3  # kinds of analysis
REAL, BOTH = 2, 5  # kinds of values: real, complex, both of single precision


def eigenvalue(frequency_hz: float, ratio: float) -> complex:
    """lambda [1/s] of a mode.

    >>> round(abs(eigenvalue(10.0, 0.05)) / 2 / np.pi, 9)
    10.0
    """
    return 2.0 * np.pi * frequency_hz * complex(-ratio, np.sqrt(max(1.0 - ratio**2, 0.0)))


def result_lines(modes: MeasuredModes, k: int, nodes: Integers) -> list[str]:
    """The lines of data set 2414 for one mode, with its marks.

    Parameters
    ----------
    nodes : Integers [p]
        Numbers of its places.
    """
    frequency, ratio = float(modes.frequency_hz[k]), float(modes.damping_ratio[k])
    shapes = modes.shapes[:, :, k]
    is_complex = np.iscomplexobj(shapes)
    whole = [0.0, frequency, 0.0, 1.0, ratio, 0.0]  # time, frequency, eigenvalue, modal mass, damping
    parts = [0.0] * 6
    if is_complex:
        root = eigenvalue(frequency, ratio)
        whole, parts[:2] = [0.0] * 6, [root.real, root.imag]
    kinds = (
        STRUCTURAL,
        COMPLEX_2414 if is_complex else NORMAL_2414,
        TRANSLATIONS,
        DISPLACEMENT,
        BOTH if is_complex else REAL,
        3,
    )
    values = np.stack([shapes.real, shapes.imag], axis=2).reshape(len(shapes), 6) if is_complex else shapes
    lines = [f"{-1:6d}", f"{2414:6d}", _whole([k + 1]), f"mode {k + 1}", _whole([AT_NODES])]
    lines += [f"mode {k + 1}, {frequency:.6g} Hz, damping ratio {ratio:.4g}", *["NONE"] * 4, _whole(kinds)]
    lines += [_whole([1, 1, 1, 1, 1, k + 1, 0, 0]), _whole([0] * 8), _real(whole), _real(parts)]
    for node, row in zip(nodes.tolist(), values.tolist(), strict=True):
        lines += [_whole([node]), _real(row)]
    return [*lines, f"{-1:6d}"]


def _whole(values: Sequence[int]) -> str:
    return "".join(f"{value:10d}" for value in values)


def _real(values: Sequence[float]) -> str:
    return "".join(f"{value:13.5E}" for value in values)


# ----------------------------------------------------------------------------------------------------------------------
# Modes, frequency responses and histories as universal files, through pyuff.
# ----------------------------------------------------------------------------------------------------------------------

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

    Parameters
    ----------
    sets : Sequence[int]
        Numbers of the data sets of nodes, 15 or 2411, and of modes, 55 or 2414, as the program that reads the file
        knows them. Shapes and frequencies of modes have six digits there, places in 15, too, values of functions
        twelve; frequencies of functions are written one by one where the file's six digits do not hold their step.

    Raises
    ------
    InputError
        Where the package pyuff is not installed, and for other data sets.

    Examples
    --------
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
