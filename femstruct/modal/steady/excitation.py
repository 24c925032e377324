"""What excites a structure and what is looked at of it, in modal coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import InputError
from femstruct.modal.basis import ForceRow, ModalBasis
from femstruct.modal.outputs import AXES
from femstruct.modal.superposition import Complex, Rows, amplitudes, of_force, of_motion, read
from femstruct.model.probe import Probe

_RIGID = 1e-6  # of the mass: what a rigid mode has of it along an axis that the structure is held in is rounding


@dataclass(frozen=True, eq=False)
class Excitation:
    """What excites a structure: pushed [k] : modal forces per unit of it. probe : a force or a pressure there [N, Pa];
    None for a base with the acceleration along `axis` [m/s^2]."""

    pushed: Floats
    probe: Probe | None = None
    axis: int | None = None


@dataclass(frozen=True, eq=False)
class Looked:
    """Something that is looked at: rows of modal coordinates, differentiated `rate` times; rigid : the share of the
    motion of a base that it has itself; direct : what passes on of what excites without any motion."""

    rows: Rows
    rate: int = 0
    rigid: float = 0.0
    direct: float = 0.0

    def of(self, q: Complex, omega: Floats) -> Complex:
        """Its transfer function [lines] from modal coordinates [lines, k] at omega [lines], all above 0."""
        turning = 1j * omega
        moved = read(self.rows, q, omega) + self.rigid / turning**2
        return np.asarray(turning**self.rate * moved + self.direct, dtype=np.complex128)


def pushing(basis: ModalBasis, probe: Probe) -> Excitation:
    """A force [N] at a probe, or a pressure [Pa] at that of a surface."""
    return Excitation(probe.of(basis.shapes), probe)


def moving_base(basis: ModalBasis, axis: str, where: str) -> Excitation:
    """A base that moves along x, y or z, and with it all that stands on the ground: supports, springs, foundations.

    Modal coordinates are of the motion on the base: M u'' + C u' + K u = -M r a, so their forces are the momenta of the
    modes along r, a rigid translation, with the other sign. Losses belong to the motion on the base.

    Raises InputError, from `where`, if the structure is free to stay behind, or nothing of it moves along that axis.

    >>> from femstruct.modal.analytic import oscillator
    >>> basis, _ = oscillator(4.0, stiffness=100.0)
    >>> moving_base(basis, "x", "vibration.shaker").pushed
    array([-2.])
    """
    number = AXES.index(axis)
    momentum = basis.momentum[number]
    free = np.array([kind == "rigid" for kind in basis.kind], dtype=bool)
    if (momentum[free] ** 2).sum() > _RIGID * basis.total_mass:
        raise InputError(
            where,
            got=f"a structure that is free to stay behind along {axis}",
            expected=f"supports or springs to the ground that hold it along {axis}",
            do="a base moves what stands on the ground; a free structure is excited by a force",
        )
    if not np.abs(momentum).max(initial=0.0) > 0.0:
        got = f"a structure of which no mode has a momentum along {axis}"
        raise InputError(where, got=got, expected="an axis along which the base can move it")
    return Excitation(-momentum, axis=number)


def motion(excitation: Excitation, basis: ModalBasis, probe: Probe, rate: int, relative: bool = False) -> Looked:
    """A displacement (rate 0), velocity (1) or acceleration (2) at a probe; relative : to the base that moves."""
    along = probe.weights[probe.components == excitation.axis].sum() if excitation.axis is not None else 0.0
    return Looked(of_motion(probe.of(basis.shapes)), rate, 0.0 if relative else float(along))


def force(excitation: Excitation, basis: ModalBasis, row: ForceRow) -> Looked:
    """A force of the structure."""
    if excitation.axis is not None:
        return Looked(of_force(basis, row), direct=float(row.carried[excitation.axis]))
    assert excitation.probe is not None
    return Looked(of_force(basis, row), direct=row.direct.meets(excitation.probe))


def transfers(basis: ModalBasis, excitation: Excitation, looked: Sequence[Looked], frequency_hz: Floats) -> Complex:
    """Transfer functions [n, nf] of all that is looked at, per unit of what excites.

    A base under an oscillator at its resonance, with 1 % of damping: the mass accelerates by
    sqrt(1 + 4 zeta^2) / 2 zeta of it:

    >>> from femstruct.modal.analytic import oscillator
    >>> from femstruct.modal.damping import Damping, Ratio, with_damping
    >>> bare, points = oscillator(2.0, frequency_hz=10.0)
    >>> basis = with_damping(bare, Damping(Ratio(0.01)))
    >>> shaker = moving_base(basis, "x", "vibration.shaker")
    >>> seen = motion(shaker, basis, points["m"].probe("x"), rate=2)
    >>> float(abs(transfers(basis, shaker, [seen], np.array([10.0]))[0, 0]).round(3))
    50.01
    """
    omega = 2.0 * np.pi * frequency_hz
    found: Complex = np.empty((len(looked), len(omega)), dtype=np.complex128)
    for lines, q in amplitudes(basis, excitation.pushed, omega):
        for number, one in enumerate(looked):
            found[number, lines] = one.of(q, omega[lines])
    return found
