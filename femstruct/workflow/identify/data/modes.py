"""Measured natural frequencies and mode shapes: paired by MAC, near-equal frequencies as one space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from femstruct.arrays import Floats, Integers
from femstruct.errors import Finding, InputError, some_of
from femstruct.files.exchange.uff_reading import read_uff
from femstruct.files.inputs.measured_frequencies import read_frequencies
from femstruct.modal.likeness import near_equal, pairing
from femstruct.modal.measured.correlation import carried_to, correlation
from femstruct.modal.measured.measurement import MeasuredModes
from femstruct.modal.outputs import nodal_shapes
from femstruct.modal.sensitivity.modal_slopes import eigenvalue_slopes, shape_slopes
from femstruct.model.refine import refined
from femstruct.study.matched import Beside
from femstruct.workflow.identify.data.datum import Datum, norm
from femstruct.workflow.identify.needs import Needs
from femstruct.workflow.identify.trial import Change, Moded, Trial

USUAL: Final = 0.01  # of a natural frequency: what repeated tests and supports make of it
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
        return (Beside("modes", self.name, "Hz", along, self.frequency_hz, computed, self.scatter, notes),)

    def findings(self, first: Trial, last: Trial) -> tuple[Finding, ...]:
        before, after = self._pairs(first), self._pairs(last)
        found = []
        lost = np.flatnonzero(after.mac < LIKE)
        if len(lost):
            worst = float(after.mac.min())
            told = some_of(f"{self.frequency_hz[i]:.4g} Hz (MAC {after.mac[i]:.2f})" for i in lost)
            message = f"{self.name}: no mode of the model has the shape of that at {told}; {LIKE:g} is asked for"
            found.append(Finding("mode-pair-lost", message, {"modes": float(len(lost)), "mac": worst}))
        if not np.array_equal(before.partner, after.partner):
            other = np.flatnonzero(before.partner != after.partner)
            told = some_of(
                f"{self.frequency_hz[i]:.4g} Hz: mode {before.partner[i] + 1}, then {after.partner[i] + 1}"
                for i in other
            )
            message = f"{self.name}: measured modes have other partners at the end than at the start ({told})"
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
        found = correlation(self.modes, basis, refined(moded.model, DIVISIONS), self.near).pairs
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
        shown = refined(moded.model, DIVISIONS)
        carry, _ = carried_to(shown, self.modes.points)
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
        wanted = np.flatnonzero(np.isin(pairs.groups, pairs.groups[pairs.partner]))
        turning = shape_slopes(moded.assembly, omega, shapes, change.matrices, wanted, pairs.groups)
        placed = self._placed(moded, basis.shapes[:, :, basis.modes])
        moving = self._placed(moded, nodal_shapes(moded.assembly, turning))
        for space in range(int(pairs.spaces.max()) + 1):
            members, own = self._space(pairs, space)
            q, inverse = _spanned(placed[:, own])
            out = moving[:, np.searchsorted(wanted, own)]
            tilted = (out - q @ (q.T @ out)) @ inverse
            found[:, members] = (tilted + tilted.T) @ measured[:, members]
        return np.asarray(found / self.shapes).ravel()


def read_modes(path: Path, scatter: float | None, shapes: float, near: float, length: float) -> ModesDatum:
    """Measured modes of a universal file (data sets 55, 2414), or natural frequencies of a table.

    scatter : of the frequencies, as a share; None for that of the table, or a usual one. Raises as the readers, and for
    a file without modes.
    """
    if path.suffix.lower() in UNIVERSAL:
        modes = read_uff(path, length).modes
        if modes is None or not (modes.frequency_hz > 0.0).any():
            raise InputError(str(path), got="no modes", expected="modes in data sets 55 or 2414")
        modes = _elastic(modes)
        frequency = modes.frequency_hz
        return ModesDatum(
            path.name, scatter is not None, frequency, (scatter or USUAL) * frequency, modes, None, shapes, near
        )
    if shapes:
        raise InputError("--shapes", got=f"'{path}', which has none", expected="a universal file with modes")
    table = read_frequencies(path)
    if table.scatter is not None and scatter is not None:
        raise InputError("--modes", got=f"'{path}' with a column of its scatter, and +-", expected="one of them")
    own = table.scatter if table.scatter is not None else (scatter or USUAL) * table.frequency_hz
    known = table.scatter is not None or scatter is not None
    return ModesDatum(path.name, known, table.frequency_hz, own, None, table.numbers, 0.0, near)


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
