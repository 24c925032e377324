"""What was measured on a structure: modes, frequency responses and histories at nodes with places."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.conventions import DIRECTIONS
from femstruct.errors import InputError
from femstruct.modal.frf import FrfKind

Kind = FrfKind | Literal["unknown"]
AXES: Final = 3


@dataclass(frozen=True, eq=False)
class MeasuredModes:
    """Modes as they were measured, or as another program has them.

    frequency_hz [k] : ascending [Hz], undamped. damping_ratio [k] : [1], 0 where none is stated.
    shapes [n, 3, k] : displacements along x, y, z, real or complex, of any scale. points [n, 3] : where [m].
    directed [n, 3] : which of them were measured; the others say nothing.

    Raises InputError for arrays that do not fit each other, and for frequencies that do not ascend.

    >>> modes = MeasuredModes([20.0], [0.01], [[[0.0], [0.0], [1.0]]], [[0.1, 0.2, 0.0]], [[False, False, True]])
    >>> modes.measured_shapes.tolist()
    [[1.0]]
    """

    frequency_hz: Floats
    damping_ratio: Floats
    shapes: NDArray[Any]
    points: Floats
    directed: NDArray[np.bool_]

    def __post_init__(self) -> None:
        frequency = frozen("MeasuredModes frequency_hz", self.frequency_hz, (None,))
        points = frozen("MeasuredModes points", self.points, (None, AXES))
        shapes = _numbers("MeasuredModes shapes", self.shapes, (len(points), AXES, len(frequency)))
        directed = np.array(self.directed, dtype=bool)
        if directed.shape != points.shape:
            raise InputError("MeasuredModes directed", got=f"shape {directed.shape}", expected=f"{points.shape}")
        if (np.diff(frequency) < 0).any() or (frequency < 0).any():
            raise InputError("MeasuredModes frequency_hz", got=f"{frequency}", expected="frequencies >= 0 that ascend")
        directed.flags.writeable = False
        freeze(
            self,
            frequency_hz=frequency,
            damping_ratio=frozen("MeasuredModes damping_ratio", self.damping_ratio, frequency.shape),
            shapes=shapes,
            points=points,
            directed=directed,
        )

    @property
    def measured_shapes(self) -> NDArray[Any]:
        """Displacements [m, k] in the directions that were measured, node by node."""
        return np.asarray(self.shapes[self.directed])


@dataclass(frozen=True, eq=False)
class MeasuredPlace:
    """A node and a direction of it. direction : x, y, z, rx, ry, rz, or "" of a scalar. name : of its place, if any.

    >>> str(MeasuredPlace(12, "z")), str(MeasuredPlace(3, "x", "middle"))
    ('12.z', 'middle.x')
    """

    node: int
    direction: str
    name: str = ""

    def __post_init__(self) -> None:
        if self.direction not in (*DIRECTIONS, ""):
            raise InputError("direction", got=f"'{self.direction}'", expected=", ".join(DIRECTIONS))

    def __str__(self) -> str:
        return f"{self.name or self.node}.{self.direction}"


@dataclass(frozen=True, eq=False)
class MeasuredFrf:
    """A measured frequency response. frequency_hz [n] : ascending [Hz]. values [n] : complex, in `unit`.

    >>> drive, response = MeasuredPlace(1, "z"), MeasuredPlace(2, "z")
    >>> line = MeasuredFrf(drive, response, "mobility", [10.0, 20.0], [1.0, 1j], "m/(N s)")
    >>> abs(line.values).tolist()
    [1.0, 1.0]
    """

    drive: MeasuredPlace
    response: MeasuredPlace
    kind: Kind
    frequency_hz: Floats
    values: NDArray[np.complex128]
    unit: str

    def __post_init__(self) -> None:
        frequency = frozen("MeasuredFrf frequency_hz", self.frequency_hz, (None,))
        values = _numbers("MeasuredFrf values", np.asarray(self.values, dtype=np.complex128), frequency.shape)
        freeze(self, frequency_hz=frequency, values=values)


@dataclass(frozen=True, eq=False)
class MeasuredHistory:
    """A measured history. what : displacement, velocity, acceleration, force, or "unknown". t [n] : [s].

    >>> MeasuredHistory(MeasuredPlace(1, "z"), "force", [0.0, 0.1], [0.0, 5.0], "N").values.max()
    np.float64(5.0)
    """

    place: MeasuredPlace
    what: str
    t: Floats
    values: Floats
    unit: str

    def __post_init__(self) -> None:
        t = frozen("MeasuredHistory t", self.t, (None,))
        freeze(self, t=t, values=frozen("MeasuredHistory values", self.values, t.shape))


@dataclass(frozen=True, eq=False)
class Measurement:
    """All that one file has of a measured structure.

    nodes [n] : their numbers. points [n, 3] : where they are [m]. lines [m, 2], quads [q, 4] : what is drawn between
    them, as places in `nodes`. notes : what was left out, or taken for granted.

    >>> Measurement("beam", [1, 2], [[0, 0, 0], [1, 0, 0]], [[0, 1]]).points[1].tolist()
    [1.0, 0.0, 0.0]
    """

    title: str
    nodes: Integers
    points: Floats
    lines: Integers = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    quads: Integers = field(default_factory=lambda: np.zeros((0, 4), np.int64))
    modes: MeasuredModes | None = None
    frfs: tuple[MeasuredFrf, ...] = ()
    histories: tuple[MeasuredHistory, ...] = ()
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        nodes = frozen_integers("Measurement nodes", self.nodes, (None,))
        freeze(
            self,
            nodes=nodes,
            points=frozen("Measurement points", self.points, (len(nodes), AXES)),
            lines=frozen_integers("Measurement lines", self.lines, (None, 2)),
            quads=frozen_integers("Measurement quads", self.quads, (None, 4)),
        )


def _numbers(name: str, values: Any, shape: tuple[int, ...]) -> NDArray[Any]:
    """A read-only copy of real or complex numbers."""
    array = np.array(values)
    array = array.astype(np.complex128 if np.iscomplexobj(array) else np.float64)
    if array.shape != shape:
        raise InputError(name, got=f"shape {array.shape}", expected=f"shape {shape}")
    if not np.isfinite(array).all():
        raise InputError(name, got="nan or infinity", expected="finite numbers")
    array.flags.writeable = False
    return array
