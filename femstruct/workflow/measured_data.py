"""What was measured, a kind a section: histories, modes, frequency responses, levels, as a fit takes them."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from femstruct.arrays import Floats, Integers
from femstruct.errors import Finding, InputError, list_some, quote_value
from femstruct.files.band_tables import band_of
from femstruct.files.columns import read_measured
from femstruct.files.frf_files import read_frf_csv
from femstruct.files.measured_frequencies import MOST_SCATTER, read_frequencies
from femstruct.files.text_tables import TextTable, read_grid, wrong_in
from femstruct.files.uff import read_uff
from femstruct.impact.scene import Table
from femstruct.language.models import ModelFile
from femstruct.modal.frf import FrfKind, frf, frf_unit
from femstruct.modal.likeness import near_equal, pairing
from femstruct.modal.measured import MeasuredModes, MeasuredPlace, Measurement, correlation, interpolation_weights
from femstruct.modal.residuals import nodal_shapes
from femstruct.modal.sensitivity import POWERS, eigenvalue_slopes, frf_slopes, motions, shape_slopes
from femstruct.model.model import refine_model
from femstruct.model.probe import Probe
from femstruct.study.asked import Beside, FrfRequest, Spot
from femstruct.study.study import Plan, Study
from femstruct.units import quantity
from femstruct.workflow.bases import Places, meshed
from femstruct.workflow.fit import Fit, Parameter
from femstruct.workflow.recorded_channels import UNITS
from femstruct.workflow.responses import response_row
from femstruct.workflow.trial import Change, Moded, Needs, Trial
from femstruct.yaml.reader import nearest

# ----------------------------------------------------------------------------------------------------------------------
# One set of measured data as a fit takes it, and how its scatter is written.
# ----------------------------------------------------------------------------------------------------------------------

DOUBTED: Final = 0.2  # a share that has its % sign: 0.5 is 50 %, where 0.5 % may be meant
_SCATTERED: Final = re.compile(r"(?P<file>.+?)\s+(?:\+-|\+/-|±)\s*(?P<scatter>.+)")


@dataclass(frozen=True, eq=False)
class Datum(ABC):
    """A set of n measured numbers, such as natural frequencies or one frequency response.

    name : of its file or channel. known : whether its scatter was stated; else it has the weight of a usual one.
    """

    name: str
    known: bool

    @property
    @abstractmethod
    def needs(self) -> Needs:
        """What of a trial it is compared with."""

    @property
    @abstractmethod
    def size(self) -> float:
        """Norm of the residuals if all of what was measured were missing [1]."""

    @property
    def tracks(self) -> int:
        """How many series of neighbours its residuals are, such as samples in time, of which noise is independent; 0 of
        what has no order."""
        return 0

    @property
    def doubt(self) -> str:
        """What may be wrong with the comparison itself where residuals are large; "" for nothing."""
        return ""

    @abstractmethod
    def residuals(self, trial: Trial) -> Floats:
        """Computed less measured over the scatter [n]."""

    def count(self, trial: Trial) -> int:
        """How many independent numbers the residuals are: fewer than there are where some are combined or projected."""
        return len(self.residuals(trial))

    def slopes(self, trial: Trial, change: Change) -> Floats | None:
        """Derivatives [n] of the residuals by one parameter; None where differences are to be taken."""
        return None

    @abstractmethod
    def beside(self, trial: Trial) -> Sequence[Beside]:
        """Measured beside computed."""

    def findings(self, first: Trial, last: Trial) -> tuple[Finding, ...]:
        """What limits the trust in the comparison itself, of the trial at the start and that at the end."""
        return ()


def file_and_scatter(text: str, option: str, dimension: str, most: float = np.inf) -> tuple[Path, float | None]:
    """A file and its scatter, one standard deviation, of a text ``FILE +- SCATTER`` or ``FILE``.

    Parameters
    ----------
    most : float
        Of it, as `scatter_of`.

    Raises
    ------
    InputError
        That begins with the option's name.

    Examples
    --------
    >>> file_and_scatter("floor.csv +- 0.5 %", "--modes", "ratio")
    (PosixPath('floor.csv'), 0.005)
    """
    found = _SCATTERED.fullmatch(text.strip())
    if found is None:
        return Path(text.strip()), None
    return Path(found["file"]), scatter_of(found["scatter"], option, dimension, most)


def scatter_of(text: str, option: str, dimension: str, most: float = np.inf) -> float:
    """A scatter as it is written, above zero; raises as `file_and_scatter`.

    Parameters
    ----------
    most : float
        The largest that says anything. A share above `DOUBTED`, or a quarter of the most, needs its % sign: so a
        forgotten one is told.
    """
    try:
        value = quantity(text, dimension)
    except InputError as error:
        raise InputError(option, got=error.got, expected=f"{error.expected}, behind +-", do=error.do) from None
    if not value > 0.0:
        raise InputError(option, got=f"a scatter of {text}", expected="one above 0")
    if dimension != "ratio" or value <= min(DOUBTED, 0.25 * most):
        return value
    plain, shown = "%" not in text, f"{100.0 * value:g} %"
    if value > most:
        do = f"did you mean {value:g} %?" if plain else "state the standard deviation of repeated tests"
        raise InputError(option, got=f"a scatter of {shown}", expected=f"{100.0 * most:g} % or less", do=do)
    if plain:
        do = f"write {shown} if it is meant"
        raise InputError(option, got=f"a scatter of {text}: {shown}?", expected=f"a per cent sign: {value:g} %?", do=do)
    return value


def norm(values: Floats) -> float:
    """Root of the sum of squares."""
    return float(np.linalg.norm(values))


# ----------------------------------------------------------------------------------------------------------------------
# Measured natural frequencies and mode shapes: paired by MAC, near-equal frequencies as one space.
# ----------------------------------------------------------------------------------------------------------------------

USUAL_FREQUENCY: Final = 0.01  # of a natural frequency: what repeated tests and supports make of it
BEYOND: Final = 1.5  # times the highest measured frequency: a model too stiff by a third still has its partner
EQUAL: Final = 1e-6  # frequencies of shapes that may be turned into each other
LIKE: Final = 0.6  # MAC of a pair that is the same mode
SEEN: Final = 1e-6  # of the largest shape of a space at the measured places
DIVISIONS: Final = 4
_BY_ORDER: Final = (
    "A mode may be missing among the measured ones, which are compared in their order: give the table a column 'mode' "
    "with the numbers that 'femstruct modes' prints, or measure shapes"
)
UNIVERSAL: Final = (".uff", ".unv", ".uf", ".ufb")


@dataclass(frozen=True, eq=False)
class Pairs:
    """Partners in the model [k] of the measured modes, MAC of each [k] (of pairs by number with the mode at the starts,
    by order 1), and the space [k] that
    each belongs to: modes of near-equal frequencies, measured or computed, are one. groups : of the model's modes."""

    partner: Integers
    mac: Floats
    spaces: Integers
    groups: Integers


@dataclass(frozen=True, eq=False)
class ModesDatum(Datum):
    """Natural frequencies [k] [Hz] with their scatter [k] [Hz], and the shapes that pair them, if any.

    numbers [k] : of the modes of the model at the starts, where nothing was measured but frequencies; None for the
    elastic ones in their order. shapes : scatter of the shapes as a share of their rms; 0 where they only pair. near :
    relative width of a space.
    """

    frequency_hz: Floats
    scatter: Floats
    modes: MeasuredModes | None
    numbers: Integers | None
    shapes: float
    near: float

    @property
    def needs(self) -> Needs:
        top = float(self.frequency_hz[-1])
        return Needs(up_to_hz=BEYOND * top, top_hz=top)

    @property
    def doubt(self) -> str:
        return _BY_ORDER if self.modes is None and self.numbers is None else ""

    @property
    def size(self) -> float:
        both = norm(self.frequency_hz / self.scatter)
        return both if not self.shapes else norm(np.array([both, np.sqrt(self._measured.size) / self.shapes]))

    def residuals(self, trial: Trial) -> Floats:
        pairs, moded = self._pairs(trial), _moded(trial)
        computed = moded.undamped.frequency_hz[pairs.partner]
        found = self._over_scatter(pairs, computed - self.frequency_hz)
        return np.concatenate([found, self._shape_residuals(pairs, moded)]) if self.shapes else found

    def count(self, trial: Trial) -> int:
        """One mean frequency a space; of every measured shape what is not along the shapes of its partners."""
        pairs, moded = self._pairs(trial), _moded(trial)
        spaces = int(pairs.spaces.max()) + 1
        if not self.shapes:
            return spaces
        placed = self._placed(moded, moded.bare.shapes[:, :, moded.bare.modes])
        both = (self._space(pairs, space) for space in range(spaces))
        across = (len(members) * (len(placed) - len(_spanned(placed[:, own])[0].T)) for members, own in both)
        return spaces + sum(across)

    def slopes(self, trial: Trial, change: Change) -> Floats | None:
        pairs, moded = self._pairs(trial), _moded(trial)
        if self.shapes and moded.assembly is None:
            return None
        basis = moded.bare
        omega = basis.omega[basis.modes]
        groups = near_equal(basis.frequency_hz[basis.modes], EQUAL)
        slope = eigenvalue_slopes(omega, change.modal, groups)[pairs.partner]
        hertz = slope / (8.0 * np.pi**2 * basis.frequency_hz[pairs.partner])
        found = self._over_scatter(pairs, hertz)
        return np.concatenate([found, self._shape_slopes(pairs, moded, change)]) if self.shapes else found

    def beside(self, trial: Trial) -> Sequence[Beside]:
        pairs, moded = self._pairs(trial), _moded(trial)
        macs = [f", MAC {value:.2f}" if self.modes is not None else "" for value in pairs.mac]
        notes = tuple(f"mode {i + 1}{mac}" for i, mac in zip(pairs.partner.tolist(), macs, strict=True))
        along, computed = np.arange(1.0, 1.0 + len(self.frequency_hz)), moded.undamped.frequency_hz[pairs.partner]
        return (
            Beside(
                "modes",
                self.name,
                unit="Hz",
                along=along,
                measured=self.frequency_hz,
                computed=computed,
                scatter=self.scatter,
                notes=notes,
            ),
        )

    def findings(self, first: Trial, last: Trial) -> tuple[Finding, ...]:
        before, after = self._pairs(first), self._pairs(last)
        found = []
        lost = np.flatnonzero(after.mac < LIKE)
        if len(lost):
            worst = float(after.mac.min())
            listed = list_some(f"{self.frequency_hz[i]:.4g} Hz (MAC {after.mac[i]:.2f})" for i in lost)
            message = f"{self.name}: no mode of the model has the shape of that at {listed}; {LIKE:g} is asked for"
            found.append(Finding("mode-pair-lost", message, {"modes": float(len(lost)), "mac": worst}))
        if not np.array_equal(before.partner, after.partner):
            other = np.flatnonzero(before.partner != after.partner)
            listed = list_some(
                f"{self.frequency_hz[i]:.4g} Hz: mode {before.partner[i] + 1}, then {after.partner[i] + 1}"
                for i in other
            )
            message = f"{self.name}: measured modes have other partners at the end than at the start ({listed})"
            found.append(Finding("mode-pair-swapped", message, {"modes": float(len(other))}))
        if self.modes is None and self.numbers is None:
            message = (
                f"{self.name}: no shapes were measured, so the frequencies are compared with the elastic modes of the "
                "model in their order: none may be missing among them"
            )
            found.append(Finding("pairs-by-order", message, {"modes": float(len(self.frequency_hz))}))
        return tuple(found)

    def _pairs(self, trial: Trial) -> Pairs:
        found: Pairs = trial.once(
            f"pairs {id(self)}", lambda: self._paired(_moded(trial), _moded(trial.origin or trial))
        )
        return found

    def _paired(self, moded: Moded, origin: Moded) -> Pairs:
        basis = moded.undamped
        own = basis.frequency_hz[basis.modes]
        groups = near_equal(own, self.near)
        if self.modes is None:
            return self._by_number(moded, origin, groups)
        if moded.model is None:
            raise InputError("--modes", got="shapes and a structure in closed form", expected="a model with parts")
        found = correlation(self.modes, basis, refine_model(moded.model, DIVISIONS), self.near).pairs
        partner, count = found.partner, len(found.partner)
        mac = np.array([found.alike(i) for i in range(count)])
        return Pairs(partner, mac, _spaces(found.groups_a, found.groups_b[partner]), groups)

    def _by_number(self, moded: Moded, origin: Moded, groups: Integers) -> Pairs:
        """Partners by their numbers at the starts, followed by shape, or in the order of the elastic modes."""
        count, basis, first = len(self.frequency_hz), moded.undamped, origin.undamped
        known, own = len(first.omega[first.modes]), len(groups)
        partner = np.arange(basis.n_rigid, basis.n_rigid + count) if self.numbers is None else self.numbers - 1
        last, there = int(partner.max()) + 1, own if self.numbers is None else known
        if last > there:
            got = f"{there} modes of the model up to {BEYOND * self.frequency_hz[-1]:.4g} Hz"
            raise InputError("--modes", got=got, expected=f"mode {last}", do="start nearer to the data")
        mac = np.ones(count)
        if self.numbers is not None and moded is not origin:
            pairs = pairing(first, basis, self.near)
            mac = np.array([pairs.alike(i) for i in partner.tolist()])
            partner = pairs.partner[partner]
        return Pairs(partner, mac, np.arange(count), groups)

    def _over_scatter(self, pairs: Pairs, hertz: Floats) -> Floats:
        """Differences [k] [Hz] over their scatter: the mean of every space over that of a mean, once, and 0 of the
        other modes of it, as modes of near-equal frequencies are one choice of many. A space may gain or lose modes
        from trial to trial; how many numbers there are stays."""
        found = np.zeros(len(hertz))
        first = np.unique(pairs.spaces, return_index=True)[1]
        found[first] = np.bincount(pairs.spaces, hertz) / np.sqrt(np.bincount(pairs.spaces, self.scatter**2))
        return found

    @property
    def _measured(self) -> Floats:
        """Measured shapes [m, k] turned to be as real as they can, of rms one."""
        assert self.modes is not None
        shapes = self.modes.measured_shapes
        real = np.real(shapes * np.exp(-0.5j * np.angle((shapes**2).sum(axis=0))))
        return np.asarray(real / np.sqrt((real**2).mean(axis=0)))

    def _placed(self, moded: Moded, nodal: Floats) -> Floats:
        """Motion [m, w] at the measured places of shapes [n_nodes, 7, w]."""
        assert self.modes is not None and moded.model is not None
        shown = refine_model(moded.model, DIVISIONS)
        carry, _ = interpolation_weights(shown, self.modes.points)
        moved = shown.displacement(nodal)
        at = (carry @ moved.reshape(len(shown.points), -1)).reshape(len(self.modes.points), 3, moved.shape[2])
        return np.asarray(at[self.modes.directed])

    def _space(self, pairs: Pairs, space: int) -> tuple[Integers, Integers]:
        """Which measured modes a space has, and which of the model."""
        members = np.flatnonzero(pairs.spaces == space)
        return members, np.flatnonzero(np.isin(pairs.groups, pairs.groups[pairs.partner[members]]))

    def _shape_residuals(self, pairs: Pairs, moded: Moded) -> Floats:
        """What of every measured shape is in no combination of its partners, over the scatter [m k]."""
        placed, measured = self._placed(moded, moded.bare.shapes[:, :, moded.bare.modes]), self._measured
        found = np.zeros_like(measured)
        for space in range(int(pairs.spaces.max()) + 1):
            members, own = self._space(pairs, space)
            q, _ = _spanned(placed[:, own])
            found[:, members] = q @ (q.T @ measured[:, members]) - measured[:, members]
        return np.asarray(found / self.shapes).ravel()

    def _shape_slopes(self, pairs: Pairs, moded: Moded, change: Change) -> Floats:
        """Derivatives of the same: of the projection on the space of the partners."""
        assert moded.assembly is not None
        basis, measured = moded.bare, self._measured
        found = np.zeros_like(measured)
        if change.matrices is None:
            return found.ravel()
        shapes, omega = moded.free[:, basis.modes], basis.omega[basis.modes]
        chosen = np.flatnonzero(np.isin(pairs.groups, pairs.groups[pairs.partner]))
        turning = shape_slopes(moded.assembly, omega, shapes, change.matrices, chosen, pairs.groups)
        placed = self._placed(moded, basis.shapes[:, :, basis.modes])
        moving = self._placed(moded, nodal_shapes(moded.assembly, turning))
        for space in range(int(pairs.spaces.max()) + 1):
            members, own = self._space(pairs, space)
            q, inverse = _spanned(placed[:, own])
            out = moving[:, np.searchsorted(chosen, own)]
            tilted = (out - q @ (q.T @ out)) @ inverse
            found[:, members] = (tilted + tilted.T) @ measured[:, members]
        return np.asarray(found / self.shapes).ravel()


def read_modes(path: Path, scatter: float | None, shapes: float, near: float, length: float) -> ModesDatum:
    """Measured modes of a universal file (data sets 55, 2414), or natural frequencies of a table.

    Raises as the readers, and for a file without modes.

    Parameters
    ----------
    scatter : float | None
        Of the frequencies, as a share; None for that of the table, or a usual one.
    """
    if path.suffix.lower() in UNIVERSAL:
        modes = read_uff(path, length).modes
        if modes is None or not (modes.frequency_hz > 0.0).any():
            raise InputError(str(path), got="no modes", expected="modes in data sets 55 or 2414")
        modes = _elastic(modes)
        frequency = modes.frequency_hz
        return ModesDatum(
            path.name,
            scatter is not None,
            frequency_hz=frequency,
            scatter=(scatter or USUAL_FREQUENCY) * frequency,
            modes=modes,
            numbers=None,
            shapes=shapes,
            near=near,
        )
    if shapes:
        raise InputError("--shapes", got=f"'{path}', which has none", expected="a universal file with modes")
    table = read_frequencies(path)
    if table.scatter is not None and scatter is not None:
        raise InputError("--modes", got=f"'{path}' with a column of its scatter, and +-", expected="one of them")
    own = table.scatter if table.scatter is not None else (scatter or USUAL_FREQUENCY) * table.frequency_hz
    known = table.scatter is not None or scatter is not None
    return ModesDatum(
        path.name,
        known,
        frequency_hz=table.frequency_hz,
        scatter=own,
        modes=None,
        numbers=table.numbers,
        shapes=0.0,
        near=near,
    )


def _elastic(modes: MeasuredModes) -> MeasuredModes:
    kept = modes.frequency_hz > 0.0
    shapes: NDArray[Any] = modes.shapes[:, :, kept]
    return MeasuredModes(modes.frequency_hz[kept], modes.damping_ratio[kept], shapes, modes.points, modes.directed)


def _spaces(measured: Integers, partners: Integers) -> Integers:
    """Number of the space of every measured mode [k]: those that share a group on either side belong together.

    >>> _spaces(np.array([0, 1, 1, 2]), np.array([5, 6, 7, 7])).tolist()
    [0, 1, 1, 1]
    """
    k = len(measured)
    rows = np.concatenate([np.arange(k), np.arange(k)])
    columns = np.concatenate([k + measured, k + measured.max() + 1 + partners])
    size = int(columns.max()) + 1
    labels = connected_components(csr_array((np.ones(2 * k), (rows, columns)), shape=(size, size)), directed=False)[1]
    return np.unique(labels[:k], return_inverse=True)[1].astype(np.int64)


def _spanned(shapes: Floats) -> tuple[Floats, Floats]:
    """An orthonormal basis [m, r] of the space of shapes [m, g] and their pseudoinverse [g, m]; a shape that the places
    do not see has no part in them."""
    left, sizes, right = np.linalg.svd(shapes, full_matrices=False)
    kept = sizes > SEEN * sizes.max(initial=0.0)
    return left[:, kept], (right[kept].T / sizes[kept]) @ left[:, kept].T


def _moded(trial: Trial) -> Moded:
    assert trial.modes is not None
    return trial.modes


# ----------------------------------------------------------------------------------------------------------------------
# A measured frequency response: its amplitude by logarithm, and its phase.
# ----------------------------------------------------------------------------------------------------------------------

USUAL_FRF: Final = 0.1  # of every line: mounting, calibration and excitation of usual tests
BEYOND_LINES: Final = 2.5  # times the highest line: residual vectors have the rest
NEAR: Final = 1e-3  # of the size of a structure: a node of a universal file that is a point of the model

Complex = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class FrfDatum(Datum):
    """Lines [n] of a response: frequency [n] [Hz], above 0, values [n], not 0, scatter [n] as a share of each.

    Notes
    -----
    Residuals are ln(computed / measured) over the scatter, real and imaginary part: the amplitude in Neper and the
    phase in radian. Resonances and the valleys between them weigh alike, and a peak that is beside its place is no huge
    number. For small differences they are those of the complex values as shares of the measured ones.
    """

    request: FrfRequest
    frequency_hz: Floats
    values: Complex
    scatter: Floats

    @property
    def needs(self) -> Needs:
        top = float(self.frequency_hz[-1])
        return Needs(up_to_hz=BEYOND_LINES * top, top_hz=top, frfs=(self.request,))

    @property
    def size(self) -> float:
        return float(np.sqrt(2.0 * (1.0 / self.scatter**2).sum()))

    @property
    def tracks(self) -> int:
        return 2

    def residuals(self, trial: Trial) -> Floats:
        computed = self._computed(trial)
        if not computed.all():
            raise InputError("--frf", got=f"'{self.name}', which the model answers with 0", expected="a motion")
        return _both(np.asarray(np.log(computed / self.values) / self.scatter, dtype=np.complex128))

    def slopes(self, trial: Trial, change: Change) -> Floats | None:
        moded, request = _frf_trial(trial), self.request
        drive, response = self._ends(moded)
        if not change.of_damping or request.kind not in POWERS or not isinstance(response, Probe):
            return None
        kind: FrfKind = request.kind  # type: ignore[assignment]  # one of a model: no pressure, no power
        moving = trial.once(f"moving {id(self)}", lambda: motions(moded.damped, drive, response, self.frequency_hz))
        slope = frf_slopes(moving, change.modal, self.frequency_hz, kind)
        return _both(slope / self._computed(trial) / self.scatter)

    def beside(self, trial: Trial) -> Sequence[Beside]:
        unit = frf_unit(self.request.kind, self.request.drive.what, self.request.response.what)  # type: ignore[arg-type]
        scatter, computed = self.scatter * np.abs(self.values), self._computed(trial)
        return (Beside("frf", self.name, unit, self.frequency_hz, self.values, computed, scatter),)

    def _computed(self, trial: Trial) -> Complex:
        found: Complex = trial.once(f"frf {id(self)}", lambda: self._answer(_frf_trial(trial)))
        return found

    def _answer(self, moded: Moded) -> Complex:
        drive, response = self._ends(moded)
        return frf(moded.damped, drive, response, self.frequency_hz, self.request.kind)  # type: ignore[arg-type]

    def _ends(self, moded: Moded) -> tuple[Probe, object]:
        request = self.request
        drive = moded.places.point(request.drive.name, "--frf").probe(request.drive.what)
        return drive, response_row(request.response, moded.places, moded.damped, "--frf")


def read_frfs(
    path: Path, scatter: float | None, places: Places, band: tuple[float, float] | None, length: float
) -> tuple[FrfDatum, ...]:
    """Frequency responses of a table of `femstruct frf --to csv`, or of a universal file (data set 58).

    Parameters
    ----------
    scatter : float | None
        Of real and imaginary part, as a share of the amplitude of each line.
    places : Places
        Of the model, which nodes of a universal file are found in by name, else by position.
    band : tuple[float, float] | None
        What of them is fitted [Hz]; all without it.

    Raises
    ------
    InputError
        For a file without responses of motion or force, places that the model does not have, and a band without lines.
    """
    if path.suffix.lower() in UNIVERSAL:
        measured = read_uff(path, length)
        read: list[tuple[Spot, Spot, FrfKind, Floats, Complex, Floats | None]] = [
            (_spot(one.drive, measured, places), _spot(one.response, measured, places), one.kind, one.frequency_hz,
             one.values, None) for one in measured.frfs if one.kind != "unknown"
        ]  # fmt: skip
        if not read:
            raise InputError(str(path), got="no frequency responses", expected="functions of data set 58")
    else:
        read = [
            (_named(one.drive), _named(one.response), one.kind, one.frequency_hz, one.values, one.scatter)
            for one in read_frf_csv(path)
        ]
    return tuple(_datum(path, *one, scatter, band) for one in read)


def _datum(
    path: Path,
    drive: Spot,
    response: Spot,
    kind: FrfKind,
    frequency: Floats,
    values: Complex,
    column: Floats | None,
    scatter: float | None,
    band: tuple[float, float] | None,
) -> FrfDatum:
    if column is not None and scatter is not None:
        raise InputError("--frf", got=f"'{path}' with a column of its scatter, and +-", expected="one of them")
    low, high = band or (0.0, np.inf)
    kept = (frequency > 0.0) & (frequency >= low) & (frequency <= high) & (values != 0.0)
    if not kept.any():
        raise InputError(
            "--band", got=f"no line of '{path}' from {low:g} to {high:g} Hz", expected="lines other than 0"
        )
    frequency, values = frequency[kept], values[kept]
    share = np.full(len(values), scatter or USUAL_FRF) if column is None else column[kept] / np.abs(values)
    name, ends = f"{kind} {response} / {drive}", (float(frequency[0]), float(np.nextafter(frequency[-1], np.inf)))
    step = float(np.median(np.diff(frequency))) if len(frequency) > 1 else 1.0
    request = FrfRequest("", drive, response, kind, ends, step)
    return FrfDatum(name, column is not None or scatter is not None, request, frequency, values, share)


def _named(text: str) -> Spot:
    name, _, what = text.rpartition(".")
    return Spot(name, what)


def _spot(place: MeasuredPlace, measured: Measurement, places: Places) -> Spot:
    """The point of the model at a node of a universal file: by its name, else where it is."""
    if place.name in places.points:
        return Spot(place.name, place.direction)
    at = measured.points[measured.nodes == place.node]
    names = [*places.points]
    points = np.array([places.points[name].position for name in names]).reshape(-1, 3)
    size = float(np.ptp(np.concatenate([points, at]), axis=0).max(initial=0.0))
    apart = np.linalg.norm(points - at[:1], axis=1) if len(at) else np.full(len(names), np.inf)
    if not len(names) or not apart.min(initial=np.inf) <= NEAR * size:
        where = f" at ({', '.join(f'{x:.4g}' for x in at[0])}) m" if len(at) else ""
        do = "give the model a point there, or a name of the file to one"
        got, known = f"'{place}'{where}, which is no point of the model", list_some(names) or "none"
        raise InputError("--frf", got=got, expected=f"one of its points: {known}", do=do)
    return Spot(names[int(apart.argmin())], place.direction)


def _both(values: Complex) -> Floats:
    return np.concatenate([values.real, values.imag])


def _frf_trial(trial: Trial) -> Moded:
    assert trial.modes is not None
    return trial.modes


# ----------------------------------------------------------------------------------------------------------------------
# A measured history of a recorded channel: a force, a motion, a pressure.
# ----------------------------------------------------------------------------------------------------------------------

DIMENSIONS: Final = {
    "displacement": "length",
    "travel": "length",
    "velocity": "speed",
    "acceleration": "acceleration",
    "force": "force",
    "pressure": "pressure",
}
DELAY: Final = "delay"
FROM_REST: Final = ("force", "acceleration", "pressure")  # zero before t = 0
MARGIN: Final = 0.5  # of a record: a recorder that starts later than that has missed what is to be fitted
FINER: Final = 8  # samples of the simulation to a measured one where the measured times lie between
DIGITS: Final = 9  # of a sampling: the rounding of written times doubles none
USUAL_HISTORY: Final = 0.05  # of the rms of a history


@dataclass(frozen=True, eq=False)
class HistoryDatum(Datum):
    """Samples of a channel. what : its quantity. scatter : in its unit. window : sampling [Hz] and duration [s] that it
    asks of the study. The record begins later than the simulation by the parameter DELAY [s], if there is one."""

    table: Table
    what: str
    scatter: float
    window: tuple[float, float]

    @property
    def needs(self) -> Needs:
        return Needs(run=True, rooms=self.what == "pressure", sampling=self.window[0], duration=self.window[1])

    @property
    def size(self) -> float:
        return norm(self.table.values) / self.scatter

    @property
    def tracks(self) -> int:
        return 1

    def residuals(self, trial: Trial) -> Floats:
        return (self._computed(trial) - self.table.values) / self.scatter

    def beside(self, trial: Trial) -> Sequence[Beside]:
        scatter = np.full(len(self.table.times), self.scatter)
        unit, computed = UNITS[self.what], self._computed(trial)
        return (Beside("history", self.name, unit, self.table.times, self.table.values, computed, scatter),)

    def _computed(self, trial: Trial) -> Floats:
        result = trial.result
        assert result is not None and result.response is not None
        before = 0.0 if self.what in FROM_REST else None
        values = result.channels[self.name].values
        return np.interp(self.table.times - trial.values.get(DELAY, 0.0), result.response.t, values, left=before)


def quantity_of_channel(plan: Plan, channel: str) -> str:
    """What a channel of the baseline is: its last word.

    Raises InputError for a channel that is not recorded, and for a study that simulates nothing.
    """
    study = next(one.study for one in plan.cases if one.name == plan.baseline)
    known = [str(record) for record in study.records]
    known += [f"{room.name}.{receiver.name} pressure" for room in study.rooms for receiver in room.receivers]
    if study.time is None:
        raise InputError("--channel", got="a study without `time`", expected="one that simulates")
    if channel not in known:
        raise InputError("--channel", got=f"'{channel}'", expected="a recorded channel", do=nearest(channel, known))
    return channel.rpartition(" ")[2]


def window_of(plan: Plan, table: Table, spacing: float, delay: bool) -> tuple[float, float]:
    """Sampling [Hz] and duration [s] of a simulation that holds every measured time, and with a delay to fit the margin
    beyond them, which a negative one reaches into."""
    end = float(table.times[-1])
    if not end > 0.0:
        raise InputError("measured", got=f"times up to {end:g} s", expected="times after 0, when the study starts")
    places = table.times / spacing
    even = bool(np.abs(places - np.rint(places)).max() < 1e-3) and not delay
    sampling = float(f"{(1 if even else FINER) / spacing:.{DIGITS}g}")
    plan_time = next(one.study.time for one in plan.cases if one.name == plan.baseline)
    assert plan_time is not None
    finer = max(1, int(np.ceil(plan_time.sampling / sampling)))
    sampling *= finer
    return sampling, end + margin_of(table) * delay + 2.0 / sampling


def margin_of(table: Table) -> float:
    """How far a simulation goes beyond a record whose delay is fitted [s]."""
    return MARGIN * float(table.times[-1])


def delay_parameter(table: Table, spacing: float) -> Parameter:
    """The delay to find [s]: what is later than the simulation is compared with none of it, and counts as rest."""
    return Parameter(DELAY, 0.0, -margin_of(table), np.inf, spacing)


def refuse_early(fit: Fit) -> None:
    """Raise InputError for a delay that asks for more of a simulation than there is."""
    if DELAY not in fit.at_bound:
        return
    most = f"{-1e3 * fit.values[DELAY]:.3g} ms"
    raise InputError(
        "--delay",
        got=f"a record that seems to lack the first {most} of the simulated history, or more",
        expected=f"one that lacks less, as the simulation ends {most} after the record",
        do="give a longer record, or write its times so that t = 0 is near the beginning of the event",
    )


# ----------------------------------------------------------------------------------------------------------------------
# Measured levels by band at the receivers or in the rooms of a study.
# ----------------------------------------------------------------------------------------------------------------------

USUAL_LEVEL: Final = 1.5  # dB: repeated measurements of one room
_COLUMN: Final = re.compile(r"(?:(?P<case>.+): )?(?P<place>[^:]+?)(?: bands_db(?: \([^)]*\))?)?")


@dataclass(frozen=True, eq=False)
class LevelsDatum(Datum):
    """Levels [n] [dB] of bands [n] [Hz] at one receiver, ROOM.RECEIVER, or of a rated room. scatter : [dB]. planned :
    how long the study simulates [s], of which the levels are."""

    place: str
    bands_hz: Floats
    levels_db: Floats
    scatter: float
    planned: float

    @property
    def needs(self) -> Needs:
        return Needs(run=True, rooms=True, duration=self.planned)

    @property
    def size(self) -> float:
        return norm(np.full(len(self.levels_db), 20.0 / np.log(10.0))) / self.scatter

    def residuals(self, trial: Trial) -> Floats:
        return (self._computed(trial) - self.levels_db) / self.scatter

    def beside(self, trial: Trial) -> Sequence[Beside]:
        scatter, computed = np.full(len(self.bands_hz), self.scatter), self._computed(trial)
        return (Beside("levels", self.place, "dB", self.bands_hz, self.levels_db, computed, scatter),)

    def _computed(self, trial: Trial) -> Floats:
        result = trial.result
        assert result is not None
        own: Mapping[float, float]
        if self.place in result.rated:
            own = result.rated[self.place].bands_db
        else:
            own = (result.heard.total_levels or result.levels)[self.place].bands_db
        found = np.array([own.get(band, np.nan) for band in self.bands_hz.tolist()])
        if not np.isfinite(found).all():
            blank = list_some(f"{band:g}" for band in self.bands_hz[~np.isfinite(found)])
            do = "compute more modes, or leave out their lines"
            raise InputError("--levels", got=f"bands that the study does not compute: {blank} Hz", expected="", do=do)
        return found


def read_levels(path: Path, scatter: float | None, plan: Plan) -> tuple[LevelsDatum, ...]:
    """Levels of a table of bands, a column for every place of the study: ``ROOM.RECEIVER``, ``ROOM``, or as `femstruct
    export` heads it, ``CASE: ROOM.RECEIVER bands_db (L_Fmax)``, of which only the case that is fitted is taken.

    Raises InputError for a table in which no column is a place of the study.
    """
    study = next(one.study for one in plan.cases if one.name == plan.baseline)
    known = [f"{room.name}.{receiver.name}" for room in study.rooms for receiver in room.receivers]
    known += [room.name for room in study.rooms]
    if not known:
        raise InputError("--levels", got="a study without rooms", expected="one with receivers")
    if study.time is None:
        raise InputError("--levels", got="a study without `time`", expected="one that simulates")
    grid = read_grid(path, {}, "a table of levels")
    head = grid.rows[0].cells if grid.rows else []
    places: dict[str, int] = {}
    for at, cell in enumerate(head[1:], 1):
        found = _COLUMN.fullmatch(cell.split("[")[0].strip())
        if found is not None and found["place"] in known and (found["case"] or plan.baseline) == plan.baseline:
            if found["place"] in places:
                raise grid.wrong(
                    grid.rows[0], f"two columns of {found['place']}", "one", "keep one, or rename the other"
                )
            places[found["place"]] = at
    if not places:
        got, expected = (
            f"'{path}' with columns {list_some(head[1:]) or 'without heads'}",
            f"a column {list_some(known)}",
        )
        do = f"of the case '{plan.baseline}', which is fitted" if any(": " in cell for cell in head) else ""
        raise InputError("--levels", got=got, expected=expected, do=do)
    return tuple(_one(grid, scatter, study.time.duration, place, at) for place, at in places.items())


def _one(grid: TextTable, scatter: float | None, planned: float, place: str, at: int) -> LevelsDatum:
    """The bands of one column that have a level; blank cells were not measured."""
    found: dict[float, float] = {}
    for row in grid.rows[1:]:
        grid.refuse_longer(row)
        try:
            band = band_of(row.cells[0])
        except InputError as error:
            raise wrong_in(grid.path, row.line, error) from None
        if band is None or band in found:
            raise grid.wrong(row, quote_value(row.cells[0]), "a third octave or octave, such as 63, each once")
        cell = row.cells[at] if at < len(row.cells) else ""
        value = grid.number(row, cell) if cell else None
        if cell and value is None:
            raise grid.wrong(row, quote_value(cell), "a level in dB, or nothing")
        if value is not None:
            found[band] = value
    if not found:
        raise grid.wrong(grid.rows[0], f"no level below '{grid.rows[0].cells[at]}'", "one or more")
    name = f"{grid.path.name} {place}"
    return LevelsDatum(
        name,
        scatter is not None,
        place,
        np.array([*found]),
        np.array([*found.values()]),
        scatter or USUAL_LEVEL,
        planned,
    )


# ----------------------------------------------------------------------------------------------------------------------
# All that was measured, read and made ready for a fit, as the command line names it.
# ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class MeasuredFiles:
    """What was measured, and where it stands.

    history, channel : a table of time and value, and the recorded channel that it is of. modes : universal files or
    tables of natural frequencies. frfs : universal files or tables. levels : tables of bands. Each is a text ``FILE``
    or ``FILE +- SCATTER``, one standard deviation. shapes : scatter of the mode shapes as a share of their rms, ""
    where they only pair. band : "A:B", of the frequency responses. near : width of a group of near-equal frequencies.
    length : unit of length of universal files that do not state it.

    >>> MeasuredFiles(modes=("floor.csv +- 0.5 %",)).any
    True
    """

    history: str = ""
    channel: str = ""
    modes: tuple[str, ...] = ()
    frfs: tuple[str, ...] = ()
    levels: tuple[str, ...] = ()
    shapes: str = ""
    band: str = ""
    near: str = "1 %"
    length: str = "m"

    @property
    def any(self) -> bool:
        """Whether there is anything to fit to."""
        return bool(self.history or self.modes or self.frfs or self.levels)


def read_data(
    files: MeasuredFiles, source: ModelFile | Plan, delay: bool
) -> tuple[tuple[Datum, ...], tuple[Parameter, ...]]:
    """All data, and the parameters that they bring with them: the delay of a history, where it is to be found.

    Raises InputError for options that do not fit each other or the study; InputErrors for what is wrong in a file.
    """
    if not files.any:
        do = "give --modes, --frf, --levels, or --measured with --channel"
        raise InputError("identify", got="no measured data", expected="one file or more", do=do)
    for option, given in (("--measured", files.history), ("--levels", files.levels)):
        if given and not isinstance(source, Plan):
            raise InputError(option, got="a model", expected="a study, in which something happens")
    if bool(files.history) != bool(files.channel):
        raise InputError("--measured and --channel", got="one of them", expected="both, or neither")
    data: list[Datum] = []
    own: tuple[Parameter, ...] = ()
    if files.history and isinstance(source, Plan):
        history, own = _history(files, source, delay)
        data.append(history)
    elif delay:
        raise InputError("--delay", got="no history", expected="--measured and --channel")
    length = _option(f"1 {files.length}", "--length", "length")
    data += _modes(files, length)
    if files.frfs:
        structure = source.structure if isinstance(source, ModelFile) else _baseline(source).structure
        places, band = meshed(structure).places, _band(files.band)
        for text in files.frfs:
            path, scatter = file_and_scatter(text, "--frf", "ratio")
            data += read_frfs(path, scatter, places, band, length)
    elif files.band:
        raise InputError("--band", got="no frequency response", expected="--frf")
    for text in files.levels:
        path, scatter = file_and_scatter(text, "--levels", "level")
        assert isinstance(source, Plan)
        data += read_levels(path, scatter, source)
    return tuple(data), own


def _modes(files: MeasuredFiles, length: float) -> list[Datum]:
    near = _option(files.near, "--near", "ratio")
    if not 0.0 <= near < 1.0:
        raise InputError("--near", got=files.near, expected="0 % to below 100 %")
    shapes = scatter_of(files.shapes, "--shapes", "ratio") if files.shapes else 0.0
    if shapes and not files.modes:
        raise InputError("--shapes", got="no modes", expected="--modes with a universal file")
    read = [file_and_scatter(text, "--modes", "ratio", MOST_SCATTER) for text in files.modes]
    return [read_modes(path, scatter, shapes, near, length) for path, scatter in read]


def _history(files: MeasuredFiles, plan: Plan, delay: bool) -> tuple[HistoryDatum, tuple[Parameter, ...]]:
    what = quantity_of_channel(plan, files.channel)
    if delay and what not in FROM_REST:
        raise InputError(
            "--delay",
            got=f"a {what}",
            expected=" or ".join(FROM_REST),
            do="a motion from before has no start in the record",
        )
    path, scatter = file_and_scatter(files.history, "--measured", DIMENSIONS[what])
    table = read_measured(path, DIMENSIONS[what])
    spacing = float(np.median(np.diff(table.times)))
    window = window_of(plan, table, spacing, delay)
    rms = norm(table.values) / np.sqrt(len(table.values))
    if not rms > 0.0:
        raise InputError(str(path), got="a history of zeros", expected="one that moves")
    taken = USUAL_HISTORY * float(rms) if scatter is None else scatter
    datum = HistoryDatum(files.channel, scatter is not None, table, what, taken, window)
    return datum, (delay_parameter(table, spacing),) if delay else ()


def _baseline(plan: Plan) -> Study:
    return next(one.study for one in plan.cases if one.name == plan.baseline)


def _band(text: str) -> tuple[float, float] | None:
    if not text:
        return None
    low, _, high = text.partition(":")
    ends = _option(low.strip(), "--band", "frequency"), _option(high.strip(), "--band", "frequency")
    if not 0.0 <= ends[0] < ends[1]:
        raise InputError("--band", got=f"'{text}'", expected="a lower and a higher frequency, such as '5 Hz:200 Hz'")
    return ends


def _option(text: str, option: str, dimension: str) -> float:
    try:
        return quantity(text, dimension)
    except InputError as error:
        raise InputError(option, got=error.got, expected=error.expected, do=error.do) from error
