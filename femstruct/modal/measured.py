"""What was measured on a structure, modes, frequency responses, histories, and how a model fits it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from femstruct.arrays import Floats, Integers, freeze, frozen, frozen_integers
from femstruct.conventions import DIRECTIONS
from femstruct.declared import expect
from femstruct.errors import FemstructError, InputError
from femstruct.modal.basis import ForceRow, ModalBasis
from femstruct.modal.frf import A_PROBE, FrfKind, frf, frf_unit, modal_amplitudes, moves_probe
from femstruct.modal.likeness import Pairing, pairing_of
from femstruct.model.model import Refined
from femstruct.model.probe import Probe

# ----------------------------------------------------------------------------------------------------------------------
# What was measured on a structure: modes, frequency responses and histories at nodes with places.
# ----------------------------------------------------------------------------------------------------------------------

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


# ----------------------------------------------------------------------------------------------------------------------
# Frequency responses of several responses to several drives, as a test with a hammer and a set of sensors has them.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class FrfTable:
    """Frequency responses, many by many.

    frequency_hz [nf] : [Hz]. drives [nd], responses [nr] : their names, POINT.direction or NAME.force. kinds [nr] :
    what each response is. values [nr, nd, nf] : complex. title : of the structure.

    Raises FemstructError for arrays that do not fit each other.

    >>> kinds = ("mobility", "transmissibility")
    >>> table = FrfTable([1.0, 2.0], ("a.z",), ("b.z", "ground.force"), kinds, np.ones((2, 1, 2)))
    >>> table.unit(0, 0), table.unit(1, 0), table.name(1, 0)
    ('m/(N s)', '1', 'transmissibility ground.force / a.z')
    """

    frequency_hz: Floats
    drives: tuple[str, ...]
    responses: tuple[str, ...]
    kinds: tuple[FrfKind, ...]
    values: NDArray[np.complex128]
    title: str = ""

    def __post_init__(self) -> None:
        frequency = frozen("FrfTable frequency_hz", self.frequency_hz, (None,))
        values = np.array(self.values, dtype=np.complex128)
        expected = (len(self.responses), len(self.drives), len(frequency))
        if values.shape != expected or len(self.kinds) != len(self.responses):
            raise FemstructError("FrfTable values", got=f"shape {values.shape}", expected=f"shape {expected}")
        values.flags.writeable = False
        object.__setattr__(self, "frequency_hz", frequency)
        object.__setattr__(self, "values", values)

    def unit(self, response: int, drive: int) -> str:
        """Unit of one response to one drive, by their places."""
        directions = (name.rpartition(".")[2] for name in (self.drives[drive], self.responses[response]))
        return frf_unit(self.kinds[response], *directions)

    def name(self, response: int, drive: int) -> str:
        """What one of them is, without its unit."""
        return f"{self.kinds[response]} {self.responses[response]} / {self.drives[drive]}"


def frf_table(
    basis: ModalBasis,
    drives: Mapping[str, Probe],
    responses: Mapping[str, Probe | ForceRow],
    frequency_hz: ArrayLike,
    kind: FrfKind | None = None,
    title: str = "",
) -> FrfTable:
    """Frequency responses of all responses to harmonic unit forces at all drives, by superposition of modes.

    Parameters
    ----------
    drives, responses : Mapping[str, Probe], Mapping[str, Probe | ForceRow]
        By name, POINT.direction or NAME.force.
    kind : FrfKind | None
        As for `frf`; None for accelerance of places and transmissibility of forces.

    Raises
    ------
    InputError
        As `frf`: a direction without motion, zero frequency of a free structure, a kind that is none.

    Notes
    -----
    Modal amplitudes are computed once for every drive. Residual vectors are wanted for the probes on both sides.

    Examples
    --------
    >>> from femstruct import oscillator
    >>> basis, points = oscillator(2.0, stiffness=50.0)
    >>> here = points["m"].probe("x")
    >>> table = frf_table(basis, {"m.x": here}, {"m.x": here}, [0.0], "receptance")
    >>> float(table.values[0, 0, 0].real.round(12)), table.unit(0, 0)
    (0.02, 'm/N')
    """
    expect("frf basis", basis, ModalBasis, "modal_basis makes one of an Assembly")
    expect("frf drives", drives, Mapping[str, Probe], A_PROBE)
    expect("frf responses", responses, Mapping[str, Probe | ForceRow], A_PROBE)
    frequency = frozen("frf frequency", np.atleast_1d(np.asarray(frequency_hz)), (None,))
    kinds: list[FrfKind] = [
        kind or ("accelerance" if isinstance(one, Probe) else "transmissibility") for one in responses.values()
    ]
    for name, one in (*drives.items(), *responses.items()):
        if isinstance(one, Probe) and not moves_probe(basis, one):
            raise InputError(f"frf {name}", got="a direction without motion in any mode", expected="one with motion")
    values = np.empty((len(responses), len(drives), len(frequency)), dtype=np.complex128)
    for j, drive in enumerate(drives.values()):
        amplitudes = modal_amplitudes(basis, drive, frequency)
        for i, response in enumerate(responses.values()):
            if isinstance(response, Probe) and kinds[i] in _POWERS:
                rate = (2j * np.pi * frequency) ** _POWERS[kinds[i]]
                values[i, j] = rate * (response.of(basis.shapes) @ amplitudes)
            else:
                values[i, j] = frf(basis, drive, response, frequency, kinds[i])
    return FrfTable(frequency, tuple(drives), tuple(responses), tuple(kinds), values, title)


_POWERS: Mapping[str, int] = {"receptance": 0, "mobility": 1, "accelerance": 2}  # of j omega


# ----------------------------------------------------------------------------------------------------------------------
# How the modes of a model fit measured ones: shapes at the measured places, and which mode is which.
# ----------------------------------------------------------------------------------------------------------------------

NEAR_MEASURED: Final = 0.01
"""Relative width of a group of frequencies beside measured ones: a model differs by more, which mixes shapes within."""
FAR: Final = 0.05  # of the size of the model: a sensor may stand on an edge that is not modelled, not beside it

ROUNDING: Final = 1e-9  # of a distance: no cell that may be the nearest is left out


@dataclass(frozen=True, eq=False)
class Correlation:
    """Measured modes beside those of a model.

    pairs : measured modes as rows, the model's as columns. distances [n] : of the measured places from the model [m].
    directions : how many displacements are compared.
    """

    pairs: Pairing
    distances: Floats
    directions: int

    @property
    def too_few(self) -> bool:
        """Whether a group has as many modes as displacements are compared: everything would be like it."""
        groups = (self.pairs.groups_a, self.pairs.groups_b)
        return self.directions <= max(int(np.bincount(group).max(initial=0)) for group in groups)


def correlation(measured: MeasuredModes, basis: ModalBasis, shown: Refined, near: float = NEAR_MEASURED) -> Correlation:
    """Which mode of a model each measured one is, by the modal assurance criterion in the measured directions.

    Parameters
    ----------
    shown : Refined
        The model subdivided (`refine_model`); measured places take the motion of the nearest place on it.

    Raises
    ------
    InputError
        Where measured places are farther from the model than 5 % of its size, and where nothing is measured or there is
        nothing to compare it with.
    """
    size = float(np.ptp(shown.points, axis=0).max(initial=0.0))
    if not measured.directed.any():
        raise InputError("measured modes", got="no displacement other than 0", expected="shapes")
    if not basis.modes.stop:
        raise InputError("modes of the model", got="none", expected="modes to compare", do="ask for more of them")
    carry, distances = interpolation_weights(shown, measured.points)
    if distances.max(initial=0.0) > FAR * size:
        far, place = float(distances.max()), measured.points[int(distances.argmax())]
        coordinates = ", ".join(f"{x:.4g}" for x in place)
        raise InputError(
            "measured places",
            got=f"one at ({coordinates}) m, {far:.4g} m from a model of {size:.4g} m",
            expected="places on the model",
            do="give the file's unit of length with --length, or move the origin of the model",
        )
    moved = shown.displacement(basis.shapes[:, :, basis.modes])
    count = moved.shape[2]
    at = (carry @ moved.reshape(len(shown.points), -1)).reshape(len(measured.points), 3, count)
    own = at[measured.directed]
    pairs = pairing_of(measured.measured_shapes, own, measured.frequency_hz, basis.frequency_hz[basis.modes], near)
    return Correlation(pairs, distances, len(own))


def interpolation_weights(shown: Refined, points: Floats) -> tuple[csr_array, Floats]:
    """Weights [m, p] of the points of a subdivided model that give the motion at the places nearest to `points` [m, 3],
    and how far those are [m].

    >>> corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    >>> plate = Refined(corners, [[0, 1, 2, 3]], np.zeros((0, 2)), csr_array((12, 28)), ("plate",), [0, 0, 0, 0])
    >>> weights, distances = interpolation_weights(plate, np.array([[0.75, 0.25, 0.5], [2.0, 0.5, 0.0]]))
    >>> weights.toarray().tolist(), distances.tolist()
    ([[0.25, 0.5, 0.25, 0.0], [0.0, 0.5, 0.5, 0.0]], [0.5, 1.0])
    """
    quads, lines = shown.quads, shown.lines
    alone = np.setdiff1d(np.arange(len(shown.points)), np.concatenate([quads.ravel(), lines.ravel()]))
    cells = np.concatenate(
        [quads[:, [0, 1, 2]], quads[:, [0, 2, 3]], lines[:, [0, 1, 1]], np.stack([alone] * 3, axis=1)]
    )
    corners = shown.points[cells]
    rows: list[Integers] = []
    weights: list[Floats] = []
    distances = np.empty(len(points))
    middles = corners.mean(axis=1)
    reach = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1, initial=0.0)
    for number, place in enumerate(points):
        most = np.linalg.norm(shown.points - place, axis=1).min(initial=np.inf) * (1.0 + ROUNDING)
        near = np.flatnonzero(np.linalg.norm(middles - place, axis=1) - reach * (1.0 + ROUNDING) <= most)
        best, weight, distances[number] = _nearest(place, corners[near])
        rows.append(cells[near[best]])
        weights.append(weight)
    indptr = 3 * np.arange(len(points) + 1)
    shape = (len(points), len(shown.points))
    if not rows:
        return csr_array(shape), distances
    carry = csr_array((np.concatenate(weights), np.concatenate(rows), indptr), shape=shape)
    carry.sum_duplicates()
    return carry, distances


def _nearest(place: Floats, corners: Floats) -> tuple[int, Floats, float]:
    """The triangle [t, 3, 3] nearest to a place, the weights of its corners there, and the distance."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    options = [_inside(place, a, b, c)]
    for i, j in ((0, 1), (1, 2), (2, 0)):
        start, side = corners[:, i], corners[:, j] - corners[:, i]
        length = (side**2).sum(axis=1)
        along = np.divide(((place - start) * side).sum(axis=1), length, out=np.zeros(len(length)), where=length > 0)
        along = np.clip(along, 0.0, 1.0)
        weight = np.zeros((len(along), 3))
        weight[:, i] += 1.0 - along
        weight[:, j] += along
        options.append(weight)
    weights = np.stack(options)
    apart = np.linalg.norm(np.einsum("otk,tkx->otx", weights, corners) - place, axis=2)
    apart[0, np.isnan(apart[0])] = np.inf
    option, cell = np.unravel_index(int(apart.argmin()), apart.shape)
    return int(cell), weights[option, cell], float(apart[option, cell])


def _inside(place: Floats, a: Floats, b: Floats, c: Floats) -> Floats:
    """Weights [t, 3] of the corners at the foot of the perpendicular; nan where it is not inside."""
    first, second, to = b - a, c - a, place - a
    ff, fs, ss = ((x * y).sum(axis=1) for x, y in ((first, first), (first, second), (second, second)))
    tf, ts = (to * first).sum(axis=1), (to * second).sum(axis=1)
    area = ff * ss - fs**2
    flat = area > 1e-12 * ff * ss
    v, w = (
        np.divide(top, area, out=np.full_like(area, np.nan), where=flat)
        for top in (ss * tf - fs * ts, ff * ts - fs * tf)
    )
    weights = np.stack([1.0 - v - w, v, w], axis=1)
    weights[~(weights >= 0.0).all(axis=1)] = np.nan
    return np.asarray(weights)
