"""ModalBasis: the only way out of the finite-element part."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from femstruct.arrays import Floats, freeze, frozen
from femstruct.conventions import N_COMPONENTS
from femstruct.errors import FemstructError, Finding
from femstruct.model.materials import Loss
from femstruct.model.probe import Probe
from femstruct.tags import stored_as

Kind = Literal["rigid", "elastic", "residual"]


@stored_as("force row/1")
@dataclass(frozen=True, eq=False)
class ForceRow:
    """One force of the structure in modal coordinates: stiffness . q + damping . q' + inertia . q'' [N], and of loads.

    direct : the share of a load that passes on without moving a mode, as where it acts on held nodes: a load at a probe
    adds `direct.meets(probe)` times itself. The others are [k]. The damping row is that of the permanent dashpots until
    `with_damping` adds the structure's own; it is the one for the time domain. hysteretic [k] : the structural part of
    it, which is + j hysteretic in frequency and hysteretic / omega_r, at each mode's own frequency, in time and in
    `damping`. carried [3] : what it is per acceleration of the base along x, y, z without any motion on the base [kg].
    Both zero if left out.
    """

    stiffness: Floats
    damping: Floats
    inertia: Floats
    hysteretic: Floats = field(default_factory=lambda: np.zeros(0))
    direct: Probe = field(default_factory=lambda: Probe([], [], []))  # type: ignore[arg-type]
    carried: Floats = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        stiffness = frozen("ForceRow stiffness", self.stiffness, (None,))
        freeze(
            self,
            stiffness=stiffness,
            damping=frozen("ForceRow damping", self.damping, stiffness.shape),
            inertia=frozen("ForceRow inertia", self.inertia, stiffness.shape),
            hysteretic=frozen(
                "ForceRow hysteretic",
                self.hysteretic if np.size(self.hysteretic) else np.zeros_like(stiffness),
                stiffness.shape,
            ),
            carried=frozen("ForceRow carried", self.carried, (3,)),
        )


@stored_as("holder of energy/1")
@dataclass(frozen=True, eq=False)
class Holder:
    """What holds a share of the energy of the modes: q' . inertia q' / 2 + q . stiffness q / 2.

    inertia [k, k] : of modal velocities [1]. stiffness [k, k] : of modal coordinates [rad^2/s^2].
    """

    inertia: Floats
    stiffness: Floats

    def __post_init__(self) -> None:
        inertia = frozen("Holder inertia", self.inertia, (None, None))
        freeze(self, inertia=inertia, stiffness=frozen("Holder stiffness", self.stiffness, inertia.shape))

    def energy(self, q: Floats, qd: Floats) -> Floats:
        """Energy it holds [...] [J] of modal coordinates and velocities [k, ...]."""
        held: Floats = 0.5 * ((qd * (self.inertia @ qd)).sum(axis=0) + (q * (self.stiffness @ q)).sum(axis=0))
        return held

    def turned(self, modes: Floats) -> Holder:
        """The same in other modes.

        Parameters
        ----------
        modes : Floats [k, n]
            Those in terms of these.
        """
        return Holder(modes.T @ self.inertia @ modes, modes.T @ self.stiffness @ modes)


def in_time(viscous: Floats, hysteretic: Floats, omega: Floats) -> Floats:
    """Viscous damping of coordinates [k, k] [rad/s] in time: a loss factor acts as at each one's own frequency.

    viscous [k, k] [rad/s]; hysteretic [k, k] [rad^2/s^2]; omega [k] [rad/s], 0 of those without stiffness.
    """
    scale = np.sqrt(np.outer(omega, omega))
    return viscous + np.divide(hysteretic, scale, out=np.zeros_like(scale), where=scale > 0)


@stored_as("modal basis/1")
@dataclass(frozen=True, eq=False)
class ModalBasis:
    """Mass-normalised modes and residual vectors: q_r'' + (viscous q')_r + omega_r^2 q_r = phi_r . f.

    omega [k] : circular frequencies [rad/s], 0 for rigid modes; modes ascending, residual vectors appended.
    kind [k] : "rigid", "elastic" or "residual" (a pseudo-mode that completes the static response of a probe).
    shapes [n_nodes, 7, k] : phi, in 1/sqrt(kg), components of `femstruct.conventions`, global axes, TWIST local.
    points [n_nodes, 3] : where the nodes are [m].
    viscous [k, k] : damping matrix [rad/s]: 2 zeta omega on the diagonal, full where dashpots couple modes.
    hysteretic [k, k] : structural damping [rad^2/s^2]: eta omega^2 on the diagonal; acts as + j hysteretic in
        frequency. In time use `time_damping`, its viscous equivalent at each mode's own frequency.
    outputs : forces of springs, foundations, supports, joints and the ground, "NAME.x", "NAME.y", "NAME.z".
    grounded : names of the outputs that add up to "ground", where it has parts.
    part_stiffness : phi^T K_part phi [k, k] of every part: its share of the strain energy. Of structures with walls at
        edges, each mode at its own frequency, without what couples modes where loss factors of parts are alike.
    loss_factors : eta of the parts [1].
    residual_norm [k] : ||K phi - omega^2 M phi|| / ||K phi||-like measure of convergence [1].
    complete_below_hz : no mode is missing below it (inertia count, or known in closed form).
    momentum [3, k] : of the structure when each mode moves with unit rate, along x, y, z [sqrt(kg)].
    total_mass : of the structure [kg].
    findings : what to know before believing it.
    volumes : volume that the air plug of a room's leak displaces into it [k] [m^3/sqrt(kg)], by room.
    dashpots [k, k] : what the permanent dashpots are of `viscous` [rad/s]; zero if left out.
    holders : who holds the energy of modes that several share, as a structure and the air of a room; their sum is that
        of the modes. Empty where all of it is the structure's.

    Raises FemstructError: arrays that do not fit each other, a negative frequency.

    >>> from femstruct.modal.closed_form import given_modes
    >>> basis, points = given_modes([20.0, 50.0], [0.02, 0.03], {"P": [0.5, -0.4]})
    >>> basis.kind, basis.frequency_hz.round(6), basis.damping_ratio.round(6)
    (('elastic', 'elastic'), array([20., 50.]), array([0.02, 0.03]))
    """

    omega: Floats
    kind: tuple[Kind, ...]
    shapes: Floats
    points: Floats
    viscous: Floats
    hysteretic: Floats
    outputs: Mapping[str, ForceRow]
    part_stiffness: Mapping[str, Floats]
    loss_factors: Mapping[str, Loss]
    residual_norm: Floats
    complete_below_hz: float
    momentum: Floats
    total_mass: float
    findings: tuple[Finding, ...] = field(default=())
    volumes: Mapping[str, Floats] = field(default_factory=dict)
    grounded: tuple[str, ...] = field(default=())
    dashpots: Floats = field(default_factory=lambda: np.zeros((0, 0)))
    holders: Mapping[str, Holder] = field(default_factory=dict)

    def __post_init__(self) -> None:
        omega = frozen("ModalBasis omega", self.omega, (None,))
        k = len(omega)
        points = frozen("ModalBasis points", self.points, (None, 3))
        if len(self.kind) != k:
            raise FemstructError("ModalBasis kind", got=f"{len(self.kind)}", expected=f"{k}")
        if (omega < 0).any():
            raise FemstructError("ModalBasis omega", got="a negative frequency", expected="omega >= 0")
        freeze(
            self,
            omega=omega,
            points=points,
            shapes=frozen("ModalBasis shapes", self.shapes, (len(points), N_COMPONENTS, k)),
            viscous=frozen("ModalBasis viscous", self.viscous, (k, k)),
            dashpots=frozen(
                "ModalBasis dashpots", self.dashpots if np.size(self.dashpots) else np.zeros((k, k)), (k, k)
            ),
            hysteretic=frozen("ModalBasis hysteretic", self.hysteretic, (k, k)),
            part_stiffness={n: frozen(f"part_stiffness.{n}", m, (k, k)) for n, m in self.part_stiffness.items()},
            residual_norm=frozen("ModalBasis residual_norm", self.residual_norm, (k,)),
            momentum=frozen("ModalBasis momentum", self.momentum, (3, k)),
            volumes={n: frozen(f"volumes.{n}", row, (k,)) for n, row in self.volumes.items()},
        )

    @property
    def frequency_hz(self) -> Floats:
        """Natural frequencies [Hz], residual pseudo-modes included."""
        return self.omega / (2.0 * np.pi)

    @property
    def modes(self) -> slice:
        """The true modes, without the residual pseudo-modes."""
        return slice(0, sum(kind != "residual" for kind in self.kind))

    @property
    def modal_mass(self) -> Floats:
        """Effective modal masses along x, y, z [3, k] [kg]."""
        return self.momentum**2

    @property
    def n_rigid(self) -> int:
        """Number of rigid-body modes (zero frequency)."""
        return sum(kind == "rigid" for kind in self.kind)

    @property
    def time_damping(self) -> Floats:
        """Viscous damping for the time domain [rad/s]: a loss factor acts as at each mode's own frequency [k, k]."""
        return in_time(self.viscous, self.hysteretic, self.omega)

    @property
    def own_damping(self) -> Floats:
        """What `time_damping` has on its diagonal, of every mode by itself [rad/s] [k]."""
        structural, omega = np.diag(self.hysteretic), self.omega
        return np.diag(self.viscous) + np.divide(structural, omega, out=np.zeros_like(omega), where=omega > 0)

    @property
    def damping_ratio(self) -> Floats:
        """Damping ratio zeta of every mode [1]; nan for rigid modes, which have none."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(self.omega > 0, self.own_damping / (2.0 * self.omega), np.nan)
