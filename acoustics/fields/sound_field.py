"""What every sound field has: the air into which surfaces radiate, whatever is round it.

A kind of field (a box, a room of any shape, a half space) is one module of this package with a frozen class, and is
entered nowhere else: `known_fields` finds it. A new kind overrides what it has; what it has not is nothing: no air that
pushes back, no modes, no picture. Places are in the field's own coordinates [m].
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from math import inf
from typing import ClassVar, Literal

import numpy as np

from acoustics.air import Air
from acoustics.arrays import Complexes, Floats
from acoustics.errors import AcousticsError, Advice
from acoustics.fields.receiver_grids import RoomGrid
from acoustics.fields.returned import KeptTransfer, ModesOnSurface
from acoustics.losses import Losses, modal_damping_ratio, t60_of
from acoustics.open_air.rayleigh import Baffle
from acoustics.receivers import Receiver
from acoustics.room_response import RoomResponse
from acoustics.rooms.box_coupling import CoupledAir
from acoustics.rooms.box_harmonic import PressureMap
from acoustics.source import SurfaceShapes, SurfaceVelocity, SurfaceVibration

T60_OF_ALL = "reverberation_time_of_all_modes_s"
LOW_HZ = 20.0  # where hearing begins: a damping ratio is told there too
FACING = 0.99  # least cosine of the angle between a surface and the way it should face
DOWN = np.array([0.0, 0.0, -1.0])
DOWN.flags.writeable = False


class SoundField(ABC):
    """Air that surfaces radiate into, and the sound at its receivers; the base of all kinds.

    air, losses : what it is filled with, and how sound dies away in it.
    word : what messages call its kind. pushes_back : whether it can be coupled two-way. bounded : whether it has a form
    that can be drawn: an outline, cells that fill it, maps.
    """

    air: Air
    losses: Losses
    word: ClassVar[str]
    pushes_back: ClassVar[bool] = False
    bounded: ClassVar[bool] = False

    # what it is

    @property
    def keeps_transfers(self) -> bool:
        """Whether `pressures_to_keep` gives back something to keep."""
        return False

    @property
    @abstractmethod
    def volume(self) -> float:
        """Volume of its air [m^3], infinite in the open."""

    @property
    def all_walls_area(self) -> float:
        """Area of its walls [m^2] where it is closed and has one reverberation time for all of them, as a diffuse field
        needs; infinite for others."""
        return inf

    @property
    def complete_up_to_hz(self) -> float:
        """Frequency [Hz] up to which it answers with all it has, infinite for a closed form."""
        return inf

    @property
    def loses(self) -> bool:
        """Whether its air takes up any energy."""
        losses = self.losses
        return bool(losses.relaxation_time or losses.decay_rate or losses.beta)

    def t60(self, frequency_hz: float, fraction: Literal[1, 3] = 3) -> float:
        """Reverberation time [s] that is measured in it in an octave (1) or third octave (3) about a frequency [Hz]: of
        its losses, and of all else that takes up sound; infinite without any."""
        return t60_of(self.losses, frequency_hz)

    @property
    def identity(self) -> object:
        """What tells it from others of its kind with two-way coupling, except its air and losses: numbers and words."""
        return ()

    @property
    def open_air(self) -> Baffle | None:
        """The plane that it lies in front of, if it is a half space: its sound power and directivity can be stated, and
        bodies in it are heard themselves; None for any other field."""
        return None

    def described(self) -> dict[str, object]:
        """What is to be said of it in tables, by name with its unit."""
        return {}

    # where surfaces are, and who listens

    @property
    @abstractmethod
    def movable(self) -> tuple[str, ...]:
        """Names of the walls that surfaces may move; the surface on the first one places the field."""

    @property
    @abstractmethod
    def middle(self) -> Floats:
        """Where on the first wall the centre of a surface comes to lie that is not placed otherwise [3]."""

    def middle_of(self, wall: str) -> Floats:
        """The same on another wall, where the kind can be placed by it."""
        return self.middle

    def wall_area(self, wall: str) -> float:
        """Area of a wall that surfaces may move [m^2], infinite in the open."""
        return inf

    def along(self, wall: str) -> list[int]:
        """The two of its axes that lie along a wall by which it can be placed."""
        return [0, 1]

    @property
    def facing(self) -> Floats:
        """Direction, global axes [3], in which the surface that places it must face."""
        return DOWN

    def axes(self, along: Floats, normal: Floats) -> Floats:
        """Its axes x, y, z as rows, global [3, 3], given the two sides [2, 3] and the normal [3] of the surface that
        places it: of a room below, x along the first side and z up."""
        return np.stack([*along, -normal])

    def placed_by(self, wall: str, along: Floats, normal: Floats) -> tuple[Floats, Floats]:
        """Its axes as of `axes`, and where on a wall the centre of a surface comes to lie that is not placed otherwise
        [3], when the surface on that wall, of sides `along` [2, 3] and with that normal [3], places it.

        Raises AcousticsError for a wall that cannot place it, and a normal that does not face into it.
        """
        first = self.movable[0]
        self.on_wall(wall)
        if wall != first:
            got, expected = f"no surface on '{first}' of {self.word}", "one there, which places it"
            raise AcousticsError("surfaces", got=got, expected=expected)
        if normal @ self.facing < FACING:
            towards = "up" if self.facing[2] > 0 else "down"
            raise AcousticsError(
                "surface.normals",
                got=f"a surface with normal ({normal[0]:.2g}, {normal[1]:.2g}, {normal[2]:.2g})",
                expected=f"a normal that points {towards}, into the air of the room",
                do=f"use `side: {'above' if towards == 'up' else 'below'}` on a horizontal plate",
            )
        return self.axes(along, normal), self.middle_of(wall)

    def on_wall(self, wall: str) -> None:
        """Refuse a wall that surfaces cannot move, by an AcousticsError that names it."""
        if wall not in self.movable:
            got, expected = f"a surface on '{wall}' of {self.word}", f"one on {', '.join(self.movable)}"
            raise AcousticsError("surface.wall", got=got, expected=expected)

    @abstractmethod
    def accept(self, wall: str, points: Floats, normals: Floats) -> None:
        """Refuse a surface that the field cannot take there.

        Parameters
        ----------
        points : Floats [p, 3]
            Of the surface, and corners of its outline.
        normals : Floats [p, 3]
            Unit vectors into the field.

        Raises
        ------
        AcousticsError
            As `on_wall` does, for points that are not on the wall, and for normals out of the field.
        """

    @abstractmethod
    def places(self, receivers: Sequence[Receiver]) -> Floats:
        """Where the receivers are [n, 3]; raises AcousticsError for none, or one that is not in the field."""

    # what is heard

    @abstractmethod
    def pressures(
        self, motions: Sequence[Sequence[SurfaceVelocity]], receivers: Sequence[Receiver], up_to_hz: float = inf
    ) -> list[RoomResponse]:
        """Pressure at the receivers for each of several motions of the same surfaces, summed over the surfaces.

        Parameters
        ----------
        motions : Sequence[Sequence[SurfaceVelocity]]
            Of each, the velocities of all surfaces; they differ in their rates.
        up_to_hz : float
            The highest frequency of interest; what lies above it may be left out.

        Returns
        -------
        list[RoomResponse]
            RoomResponse of each; its findings are reasons to trust it less.
        """

    def pressures_to_keep(
        self, motions: Sequence[Sequence[SurfaceVelocity]], receivers: Sequence[Receiver], up_to_hz: float = inf
    ) -> tuple[list[RoomResponse], KeptTransfer | None]:
        """As `pressures`, and what makes further motions of these surfaces cheap; None where nothing does."""
        return self.pressures(motions, receivers, up_to_hz), None

    @abstractmethod
    def harmonic(
        self, surfaces: Sequence[SurfaceVibration], receivers: Sequence[Receiver]
    ) -> tuple[Complexes, tuple[Advice, ...]]:
        """Complex pressure [n_receivers, nf] [Pa] of surfaces that move with exp(+j omega t), and advice on it."""

    @abstractmethod
    def loads(
        self, surfaces: Sequence[SurfaceShapes], source: Receiver, frequency_hz: Floats
    ) -> tuple[Complexes, tuple[Advice, ...]]:
        """Integrals [k, nf] over surfaces that are held, of a point source's pressure per volume velocity [Pa s/m^3],
        times their shapes, in common coordinates; and advice.

        Parameters
        ----------
        source : Receiver
            Its place.
        frequency_hz : Floats [nf]
            Above 0 [Hz].
        """

    def spectrum(self, surfaces: Sequence[SurfaceVelocity], frequency_hz: Floats, points: Floats) -> Complexes:
        """Fourier transform of the pressure [p, nf] [Pa/Hz] at points [p, 3]: of the record of the velocity, times the
        transfer at that frequency.

        What a record long enough for the air to fall silent would give, the surfaces standing still after its end.
        """
        receivers = [Receiver(str(number), place) for number, place in enumerate(points)]
        return self.harmonic([one.at(frequency_hz) for one in surfaces], receivers)[0]

    def powers(self, surfaces: Sequence[SurfaceVibration]) -> Floats:
        """Mean power [n_surfaces, nf] [W] that each surface gives the air: 1/2 Re of the integral over it of the total
        pressure times the conjugate of its own velocity. They sum to what the air takes up.

        Raises AcousticsError as `harmonic` does, and for a field without a boundary to which that can be related.
        """
        points = np.concatenate([one.points for one in surfaces])
        p = self.harmonic(surfaces, [Receiver(str(number), place) for number, place in enumerate(points)])[0]
        ends = np.cumsum([len(one.points) for one in surfaces])[:-1]
        flows = zip(surfaces, np.split(p, ends), strict=True)
        return np.array([0.5 * (one.weights @ (own * (one.shapes @ one.rates).conj()).real) for one, own in flows])

    # air that reacts on the structure, and its modes

    def coupled_air(self, surfaces: Sequence[SurfaceShapes], up_to_hz: float) -> CoupledAir:
        """Its air as a mechanical system joined to the shapes of surfaces, which move in the same coordinates.

        Parameters
        ----------
        up_to_hz : float
            Modes of the air up to it are kept [Hz]; the others act as added mass.

        Raises
        ------
        AcousticsError
            Where the kind has no two-way coupling.
        """
        raise AcousticsError("coupling", got=f"two-way with {self.word}", expected="one-way")

    def coupling_advice(self, first_hz: float) -> tuple[Advice, ...]:
        """Advice on what `coupled_air` leaves out.

        Parameters
        ----------
        first_hz : float
            The lowest mode of structure and air, 0 for none [Hz].
        """
        return ()

    def modes_on(self, surfaces: Sequence[SurfaceShapes], up_to_hz: float) -> ModesOnSurface:
        """Its modes up to a frequency beside shapes of surfaces; none where it is not known by modes."""
        none = np.zeros(0)
        return ModesOnSurface(none, np.zeros((surfaces[0].shapes.shape[1], 0)), none, none)

    # the same air in rooms of other sizes

    def varied(self, factors: Floats) -> SoundField | None:
        """The field with its sides times factors [3], losses and air as they are; None for a kind without sides."""
        return None

    def transfers(self, surface: SurfaceShapes, places: Floats, s: Complexes) -> Complexes:
        """Pressure over modal rate [r, k, nf] at places [r, 3], at complex frequencies s [nf] [1/s], for kinds that can
        be varied; what of the surface lies beyond its wall moves no air."""
        raise AcousticsError("ways", got=self.word, expected="a room with sides")

    # what is drawn

    @property
    def outline(self) -> Floats:
        """Ends of the edges that show its form [m, 2, 3]; none where it is not bounded."""
        return np.zeros((0, 2, 3))

    def grid(self) -> RoomGrid:
        """Cells that fill it, fine enough for pictures; raises AcousticsError where it is not bounded."""
        raise AcousticsError("grid", got=self.word, expected="a room with a form")

    def mode_shapes(self, points: Floats, count: int) -> tuple[Floats, Floats]:
        """Frequencies [k] [Hz] and shapes [n, k] at points [n, 3] of its first modes, at most `count`, without the
        uniform one; of unit mean square."""
        return np.zeros(0), np.zeros((len(points), 0))

    def pressure_map(
        self,
        surfaces: Sequence[SurfaceVelocity],
        frequencies_hz: Sequence[float] | Floats,
        *,
        normal: str = "z",
        at: float,
        divisions: tuple[int, int] = (48, 40),
    ) -> PressureMap:
        """Spectrum of the pressure on the plane x, y or z = `at`, as of `spectrum`; nan where the plane leaves it.

        Raises AcousticsError: a field that is not bounded, a plane outside, a room without losses at a resonance.
        """
        raise AcousticsError("map", got=self.word, expected="a room with a form")


def faces_out(wall: str) -> AcousticsError:
    """What is said of a surface whose normals point out of the field."""
    return AcousticsError("surface.normals", got=f"a surface on '{wall}' that faces out", expected="one that faces in")


def described_modes(losses: Losses, frequency_hz: Floats, walls: Floats | None = None) -> dict[str, object]:
    """What is said in tables of a closed room's modes: the first three, and how they are damped; where it is one for
    all of them, their reverberation time.

    Parameters
    ----------
    walls : Floats | None
        Rates at which walls damp the amplitudes of the modes [1/s], beside the losses.
    """
    first = [float(f) for f in frequency_hz[:3]]
    ratios = {f"{f:g}": modal_damping_ratio(losses, f) for f in (LOW_HZ, *first) if f > 0}
    for f, rate in zip(first, [] if walls is None else walls.tolist(), strict=False):
        ratios[f"{f:g}"] += rate / (2 * np.pi * f)
    alone = walls is None or not walls.any()
    one = {T60_OF_ALL: t60_of(losses, LOW_HZ)} if alone and losses.kind == "constant_decay" else {}
    return {"first_modes_hz": first, "damping_ratio": ratios, **one}


def air_stiffness_ratio(room: SoundField, area: float | Floats, stiffness: float | Floats) -> float | Floats:
    """Stiffness rho c^2 area^2 / V of the sealed room's air over that of the structure which moves its ceiling [-].

    Parameters
    ----------
    area : float | Floats
        Area of the moving surface [m^2], or of a mode: the integral of its mass-normalised shape over the surface
        [m^2/sqrt(kg)].
    stiffness : float | Floats
        Stiffness of the structure under it [N/m], or of a mode: omega^2 [rad^2/s^2].

    Notes
    -----
    A mode's frequency with the air is about sqrt(1 + ratio) times that without. The room is compressed uniformly,
    which holds well below its first mode.

    References
    ----------
    F. Fahy, P. Gardonio, Sound and Structural Vibration, 2nd ed., section 7.4 (uniform pressure in an enclosure).

    Examples
    --------
    >>> from acoustics.fields.rectangular import Room
    >>> box = Room([0.58, 0.47, 0.1], Air(340, 1.29))
    >>> round(air_stiffness_ratio(box, box.ceiling_area, 4.641e5), 3)
    0.876
    """
    return room.air.bulk_modulus * area**2 / (room.volume * stiffness)
