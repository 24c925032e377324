"""Damping laws, given to a basis after it is solved, and carried from one basis to another by mode shape."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from femstruct.arrays import Floats, Integers
from femstruct.declared import checked, expect
from femstruct.errors import Finding, InputError
from femstruct.modal.basis import ForceRow, ModalBasis
from femstruct.modal.likeness import TIE, pairing
from femstruct.modal.residuals import AXES
from femstruct.model.materials import LossByFrequency, loss_at
from femstruct.tags import stored_as

# ----------------------------------------------------------------------------------------------------------------------
# Losses of materials in modes, also of loss factors that depend on frequency: each mode at its own.
# ----------------------------------------------------------------------------------------------------------------------

BEYOND = 2.0**0.5  # ratio of frequencies from which on a mode is outside a table: half an octave, half a band
STRAINED = 0.01  # of a mode's elastic energy: parts with less hardly damp it
UNUSED = 0.1  # of a mode's loss factor: what is left out by more changes a resonance by 0.8 dB, a band by 0.4 dB
UNUSED_LEAST = 1e-4  # loss factor that no mode notices
UNDAMPED = 5e-5  # damping ratio: a loss factor of 1e-4, which metals have by themselves and no built structure has


def material_losses(basis: ModalBasis) -> Floats:
    """Structural damping [k, k] of the parts' loss factors [rad^2/s^2]: the sum of eta K of all parts.

    Notes
    -----
    Of a table sqrt(eta(f_r) eta(f_s)) K_rs: the diagonal is the strain energy with the loss factor at the mode's own
    frequency, and the whole is never active. A rigid mode strains no part.
    """
    losses = np.zeros_like(basis.hysteretic)
    for part, stiffness in basis.part_stiffness.items():
        loss = basis.loss_factors.get(part, 0.0)
        if isinstance(loss, LossByFrequency):
            roots = np.sqrt(loss.at(basis.frequency_hz))
            losses += roots[:, None] * stiffness * roots
        else:
            losses += loss * stiffness
    rigid = basis.omega == 0.0
    losses[rigid, :] = losses[:, rigid] = 0.0  # rounding
    return losses


def unused_losses(basis: ModalBasis, damping: Floats) -> tuple[Finding, ...]:
    """Springs, foundations and edges on the ground whose loss factors a general law leaves out, where they matter.

    Parameters
    ----------
    damping : Floats [k, k]
        Loss factors of the modes times their omega^2 on the diagonal, as the law gives them [rad^2/s^2].
    """
    elastic = np.array([kind == "elastic" for kind in basis.kind])
    found = []
    for part in dict.fromkeys(basis.grounded):
        if part not in basis.part_stiffness or not elastic.any():
            continue
        loss = loss_at(basis.loss_factors.get(part, 0.0), basis.frequency_hz)
        lost, squared = (loss * np.diag(basis.part_stiffness[part]))[elastic], basis.omega[elastic] ** 2
        given, own = np.diag(damping)[elastic] / squared, lost / squared
        if not (own > np.maximum(UNUSED * given, UNUSED_LEAST)).any():
            continue
        worst = int(np.argmax(own))
        hz = float(basis.frequency_hz[elastic][worst])
        found.append(
            Finding(
                "loss-unused",
                f"{part}: its loss factor is not used, because 'damping' gives one law for the whole structure. By "
                f"strain energy it would add {100 * own[worst]:.3g} % to the loss factor of {100 * given[worst]:.3g} % "
                f"of the mode at {hz:.4g} Hz. Write damping: {{from: materials}} to have it",
                {"unused_loss_factor": float(own[worst]), "loss_factor": float(given[worst]), "frequency_hz": hz},
            )
        )
    return tuple(found)


def beyond_tables(basis: ModalBasis) -> tuple[Finding, ...]:
    """Parts whose loss factor is given by frequency, and modes strained in them that are outside of what is given."""
    found = []
    elastic = np.array([kind == "elastic" for kind in basis.kind])
    frequency, squared = basis.frequency_hz[elastic], basis.omega[elastic] ** 2
    for part, stiffness in basis.part_stiffness.items():
        loss = basis.loss_factors.get(part, 0.0)
        if not isinstance(loss, LossByFrequency):
            continue
        low, high = loss.band
        strained = np.diag(stiffness)[elastic] > STRAINED * squared
        outside = strained & ((frequency < low / BEYOND) | (frequency > high * BEYOND))
        if not outside.any():
            continue
        first, last = frequency[outside].min(), frequency[outside].max()
        found.append(
            Finding(
                "loss-beyond-table",
                f"{part}: its loss factor is given from {low:g} to {high:g} Hz. {int(outside.sum())} of the "
                f"{int(strained.sum())} modes that strain it are outside, {_band_text(first, last)}, and have "
                "the value of the nearest frequency",
                {"modes": float(outside.sum()), "lowest_hz": float(first), "highest_hz": float(last)},
            )
        )
    return tuple(found)


def _band_text(first: float, last: float) -> str:
    """A range of frequencies [Hz] in words, or the one there is."""
    low, high = f"{first:.4g}", f"{last:.4g}"
    return f"at {low} Hz" if low == high else f"from {low} to {high} Hz"


# ----------------------------------------------------------------------------------------------------------------------
# Damping laws, given to a basis after it is solved, and carried from one basis to another by mode shape.
# ----------------------------------------------------------------------------------------------------------------------

_NEAR = 0.05  # how far mode N may be from where its damping was measured
_MIN_MAC = 0.5  # the least MAC at which two shapes count as the same mode


@stored_as("damping by ratio/1")
@dataclass(frozen=True)
@checked("damping")
class Ratio:
    """The same damping ratio zeta of every elastic mode [1]: viscous 2 zeta omega.

    >>> Damping(Ratio(0.02)).base.value  # 2 %
    0.02
    """

    value: float


@stored_as("damping by loss factor/1")
@dataclass(frozen=True)
@checked("damping")
class LossFactor:
    """One loss factor eta of the whole structure [1]: K (1 + j eta).

    >>> Damping(LossFactor(0.04)).base.value  # at resonance as a ratio of 2 %
    0.04
    """

    value: float


@stored_as("damping of Rayleigh/1")
@dataclass(frozen=True)
@checked("damping")
class Rayleigh:
    """C = alpha M + beta K: alpha [1/s], beta [s]. alpha also brakes rigid motion.

    Ratios of (alpha / omega + beta omega) / 2, 1 % at 10 Hz here:

    >>> from math import pi
    >>> law = Rayleigh(alpha=0.01 * 2 * pi * 10.0, beta=0.01 / (2 * pi * 10.0))
    >>> round((law.alpha / (2 * pi * 10.0) + law.beta * 2 * pi * 10.0) / 2, 9)
    0.01
    """

    alpha: float
    beta: float


@stored_as("damping from materials/1")
@dataclass(frozen=True)
class FromMaterials:
    """The loss factor of every part's own material or foundation: sum of eta_part K_part, a full matrix.

    One that depends on frequency is taken for each mode at its own: sqrt(eta(f_r) eta(f_s)) K_part of modes r, s.

    >>> Damping(FromMaterials()).modes
    ()
    """


@stored_as("damping of a mode/1")
@dataclass(frozen=True)
@checked("damping")
class ModeDamping:
    """The damping of one mode instead of the general law.

    number : our mode number, from 1, rigid ones counted. near_hz : where that mode is expected [Hz], to 5 %.
    ratio, loss_factor : exactly one of them [1].

    >>> ModeDamping(4, near_hz=19.9, ratio=0.06).loss_factor is None
    True
    """

    number: int
    near_hz: float
    ratio: float | None = None
    loss_factor: float | None = None

    def __post_init__(self) -> None:
        where = f"damping.modes.{self.number}"
        if (self.ratio is None) == (self.loss_factor is None):
            raise InputError(where, got="both or neither", expected="one of ratio and loss_factor")
        if self.number < 1:
            raise InputError(where, got=f"mode {self.number}", expected="a mode number from 1")
        _check(f"{where}.near", self.near_hz)
        _check(where, self.ratio if self.ratio is not None else self.loss_factor)


@stored_as("damping law/1")
@dataclass(frozen=True)
@checked("damping", base="Ratio, LossFactor, Rayleigh or FromMaterials; Ratio({value})?")
class Damping:
    """How the structure itself dissipates: a general law and the exceptions from it, each mode once.

    base : Ratio, LossFactor, Rayleigh or FromMaterials. modes : exceptions by mode number.

    Raises InputError: a number alone, a negative value, a mode named twice.

    >>> Damping(LossFactor(0.04), (ModeDamping(4, near_hz=19.9, ratio=0.06),)).modes[0].number
    4
    """

    base: Ratio | LossFactor | Rayleigh | FromMaterials = Ratio(0.0)
    modes: tuple[ModeDamping, ...] = ()

    def __post_init__(self) -> None:
        values = [getattr(self.base, name) for name in ("value", "alpha", "beta") if hasattr(self.base, name)]
        for value in values:
            _check("damping", value)
        numbers = [mode.number for mode in self.modes]
        if len(set(numbers)) < len(numbers):
            raise InputError("damping.modes", got=f"numbers {numbers}", expected="each mode once")


def with_damping(basis: ModalBasis, damping: Damping) -> ModalBasis:
    """The basis with the structure's own damping added to what it has (the permanent dashpots').

    Ratios are viscous, 2 zeta omega; loss factors hysteretic, eta omega^2; the residual pseudo-modes follow the
    general law. Rigid modes have no damping ratio; only alpha of Rayleigh's law brakes them. Force rows get the same
    damping, so that reactions are right in motion: for ratios and loss factors a mode's share of every force is its
    elastic force times (1 + 2 zeta j omega / omega_r) or (1 + j eta); by materials a part's own force has its own
    eta, and forces of several parts together (joints, supports) the mode's mean one; the ground has the sum of its own.

    Raises InputError when mode N is not within 5 % of where it is said to be, naming the modes that are near, and
    when a rigid mode is given a damping. A mode above a basis cut short is a finding, not an error.

    Notes
    -----
    A damping matrix that is not diagonal (materials) keeps its off-diagonal terms, but an exception clears
    the row and column of its mode.

    >>> from femstruct.modal.closed_form import oscillator
    >>> basis, _ = oscillator(2.0, frequency_hz=10.0)
    >>> with_damping(basis, Damping(LossFactor(0.04))).damping_ratio.round(12)
    array([0.02])
    """
    expect("with_damping basis", basis, ModalBasis, "modal_basis makes one of an Assembly")
    expect("with_damping damping", damping, Damping, "Damping(Ratio(0.02)) is 2 % of critical in all modes")
    exceptions, findings = _exceptions(basis, damping.modes)
    viscous, hysteretic = _base(basis, damping.base)
    if isinstance(damping.base, FromMaterials):
        of_parts = beyond_tables(basis)
    else:
        of_parts = unused_losses(basis, hysteretic + viscous * basis.omega)
    for index, mode in exceptions.items():
        viscous[index, :] = viscous[:, index] = hysteretic[index, :] = hysteretic[:, index] = 0.0
        if mode.ratio is not None:
            viscous[index, index] = 2.0 * mode.ratio * basis.omega[index]
        elif mode.loss_factor is not None:
            hysteretic[index, index] = mode.loss_factor * basis.omega[index] ** 2
    named = np.array(sorted(exceptions), dtype=np.int64)
    outputs = {
        name: _with_losses(basis, name, row, damping.base, viscous, hysteretic, named)
        for name, row in basis.outputs.items()
    }
    outputs |= _of_the_ground(outputs, basis.grounded)
    return replace(
        basis,
        viscous=basis.viscous + viscous,
        hysteretic=basis.hysteretic + hysteretic,
        outputs=outputs,
        findings=basis.findings + findings + of_parts,
    )


def carry_damping(damping: Damping, baseline: ModalBasis, changed: ModalBasis) -> ModalBasis:
    """`changed` with the damping of `baseline`: exceptions follow their mode by shape, whatever its new number.

    Modes are paired one to one with the largest total MAC, which among near-equal frequencies is that with their space
    (`pairing`). A mode without a partner of 0.5 or more gets the general law, and a finding says so. Neither basis has
    the damping yet.
    """
    exceptions, _ = _exceptions(baseline, damping.modes)
    pairs = pairing(baseline, changed)
    likeness = pairs.likeness
    elastic = np.array([kind == "elastic" for kind in changed.kind[changed.modes]], dtype=bool)
    rows, columns = scipy.optimize.linear_sum_assignment(
        np.where(elastic, likeness + TIE * pairs.mac, 0.0), maximize=True
    )
    partner = dict(zip(rows.tolist(), columns.tolist(), strict=True))
    carried: list[ModeDamping] = []
    findings: list[Finding] = []
    for index, mode in exceptions.items():
        to = partner.get(index)
        alike = float(likeness[index, to]) if to is not None and elastic[to] else 0.0
        if to is not None and alike >= _MIN_MAC:
            carried.append(replace(mode, number=to + 1, near_hz=float(changed.frequency_hz[to])))
            continue
        message = (
            f"No mode of the changed structure resembles mode {mode.number} ({baseline.frequency_hz[index]:.4g} Hz) of "
            f"the baseline (best MAC {alike:.2f}): it has the general damping."
        )
        values = {"mode": float(mode.number), "mac": alike, "frequency_hz": float(baseline.frequency_hz[index])}
        findings.append(Finding("mode-damping-lost", message, values))
    damped = with_damping(changed, Damping(damping.base, tuple(carried)))
    return replace(damped, findings=damped.findings + tuple(findings))


def _base(basis: ModalBasis, base: Ratio | LossFactor | Rayleigh | FromMaterials) -> tuple[Floats, Floats]:
    """(viscous, hysteretic) matrices of the general law [k, k]."""
    none = np.zeros_like(basis.viscous)
    omega = basis.omega
    if isinstance(base, Ratio):
        return np.diag(2.0 * base.value * omega), none
    if isinstance(base, LossFactor):
        return none, np.diag(base.value * omega**2)
    if isinstance(base, Rayleigh):
        return np.diag(base.alpha + base.beta * omega**2), none
    losses = material_losses(basis)
    return none, losses


def _with_losses(
    basis: ModalBasis,
    name: str,
    row: ForceRow,
    base: Ratio | LossFactor | Rayleigh | FromMaterials,
    viscous: Floats,
    hysteretic: Floats,
    exceptions: Integers,
) -> ForceRow:
    """A force row with the damping of the structure that goes with it."""
    squared = np.where(basis.omega > 0, basis.omega**2, np.inf)
    rate, loss = np.diag(viscous) / squared, np.diag(hysteretic) / squared  # [s] and [1] of every mode's elastic force
    dashpots, structural = row.stiffness * rate, row.stiffness * loss
    general = np.ones(len(squared), dtype=bool)
    general[exceptions] = False
    if isinstance(base, Rayleigh):
        dashpots = np.where(general, base.alpha * row.inertia + base.beta * row.stiffness, dashpots)
    part = name.rpartition(".")[0]
    if isinstance(base, FromMaterials) and part in basis.loss_factors:
        own = loss_at(basis.loss_factors[part], basis.frequency_hz)
        structural = np.where(general, row.stiffness * own, structural)
    structural = np.where(basis.omega > 0, structural, 0.0)
    return replace(
        row,
        damping=row.damping + dashpots + structural / np.sqrt(squared),
        hysteretic=row.hysteretic + structural,
    )


def _of_the_ground(outputs: Mapping[str, ForceRow], grounded: Sequence[str]) -> dict[str, ForceRow]:
    """The force on the ground with the losses of all that stands on it, each by its own."""
    rows: dict[str, ForceRow] = {}
    for axis in AXES if grounded else ():
        parts = [outputs[f"{name}.{axis}"] for name in dict.fromkeys(grounded)]
        damping = np.sum([part.damping for part in parts], axis=0)
        hysteretic = np.sum([part.hysteretic for part in parts], axis=0)
        rows[f"ground.{axis}"] = replace(outputs[f"ground.{axis}"], damping=damping, hysteretic=hysteretic)
    return rows


def _exceptions(
    basis: ModalBasis, modes: tuple[ModeDamping, ...]
) -> tuple[dict[int, ModeDamping], tuple[Finding, ...]]:
    """The exceptions by index of their mode, checked, and findings for those above the basis."""
    frequency = basis.frequency_hz[basis.modes]
    found: dict[int, ModeDamping] = {}
    findings: list[Finding] = []
    for mode in modes:
        index = mode.number - 1
        if index >= len(frequency) and mode.near_hz > basis.complete_below_hz * (1.0 - _NEAR):
            message = f"Mode {mode.number} (near {mode.near_hz:.4g} Hz) is above this basis: its damping is not used."
            findings.append(Finding("mode-damping-unused", message, {"mode": mode.number, "near_hz": mode.near_hz}))
            continue
        if index < basis.n_rigid:
            raise InputError(f"damping.modes.{mode.number}", got="a rigid mode", expected="an elastic mode")
        if index >= len(frequency) or abs(frequency[index] - mode.near_hz) > _NEAR * mode.near_hz:
            raise _misplaced(basis, mode)
        found[index] = mode
    return found, tuple(findings)


def _misplaced(basis: ModalBasis, mode: ModeDamping) -> InputError:
    frequency = basis.frequency_hz[basis.modes]
    nearest = np.sort(np.argsort(np.abs(frequency - mode.near_hz), kind="stable")[:3])
    listed = ", ".join(f"mode {i + 1} at {frequency[i]:.4g} Hz" for i in nearest)
    inside = mode.number <= len(frequency)
    got = f"mode {mode.number} at {frequency[mode.number - 1]:.4g} Hz" if inside else f"{len(frequency)} modes only"
    return InputError(
        f"damping.modes.{mode.number}",
        got=got,
        expected=f"mode {mode.number} within 5 % of {mode.near_hz:.4g} Hz",
        do=f"nearest are {listed}",
    )


def _check(where: str, value: float | None) -> None:
    if value is None or not (np.isfinite(value) and value >= 0):
        raise InputError(where, got=f"{value}", expected="a number >= 0")
