"""What sound fields give back beside numbers: their modes beside surfaces, and what a first motion found out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

from acoustics.arrays import Complexes, Floats
from acoustics.receivers import Receiver
from acoustics.room_response import RoomResponse
from acoustics.source import SurfaceVelocity


class ModesOnSurface(NamedTuple):
    """Modes of a field beside the shapes of what moves: frequencies [n] [Hz], without the uniform one; integrals over
    the surface of their shapes times the shapes that move [k, n]; roots of those of their squares [n]; integrals of
    their squares over the field [n] [m^3]."""

    frequency_hz: Floats
    products: Floats
    sizes: Floats
    squares: Floats


class KeptTransfer(Protocol):
    """What a first motion of surfaces found out, kept for motions to come."""

    def of(self, surface: SurfaceVelocity, room: object, receivers: Sequence[Receiver], up_to_hz: float) -> bool:
        """Whether a motion is one of its surfaces in its field, in a record of the same length and sampling."""

    def prepare(self) -> None:
        """Do now what the next motion would do."""

    @property
    def per_rate(self) -> Complexes:
        """Pressure over the rate of every mode of the surfaces [r, k, nf], on the first lines of
        `acoustics.rooms.box_pressure.transform_axis` of the record, as its transform is weighted."""

    def pressures(self, surfaces: Sequence[SurfaceVelocity]) -> list[RoomResponse] | None:
        """Pressures of other motions; None where they need another search."""
