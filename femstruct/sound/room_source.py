"""The crossing from a room to the structure: a point source in the air of a room moves what is around it."""

from __future__ import annotations

import numpy as np

from acoustics.arrays import Complexes
from acoustics.errors import Advice
from acoustics.receivers import Receiver
from femstruct.arrays import Floats
from femstruct.errors import InputError
from femstruct.modal.basis import ModalBasis
from femstruct.modal.frf import moves
from femstruct.modal.superposition import amplitudes
from femstruct.model.probe import Probe
from femstruct.sound.placed import Placed


def velocity_per_source(
    basis: ModalBasis, room: Placed, source: Receiver, response: Probe, frequency_hz: Floats
) -> tuple[Complexes, tuple[Advice, ...]]:
    """Velocity of a place of the structure per volume velocity of a harmonic point source in a room [nf] [1/m^2], and
    advice: what a loudspeaker of known volume velocity and an accelerometer on the floor measure.

    basis : in vacuo for one-way coupling; coupled to the room by `with_cavity` for two-way coupling, where the source
    moves the surfaces and these move the air, which reacts on them.
    room, source : where it stands, in the room's coordinates. response : what moves, of a direction or a rotation
    [rad/m^3]. frequency_hz [nf] : above 0 [Hz].

    Raises InputError for a response that no mode moves, AcousticsError for a source outside the room, or a resonance of
    a room without losses.

    Notes
    -----
    The pressure of the source on surfaces that are held, integrated over them with the shapes of the modes, is a force
    on the modes, out of the room. The air's answer to the motion that follows is in the modes of a coupled basis, so
    that nothing more acts. By reciprocity the result is minus the pressure at the source's place per force on the
    structure (`femstruct.sound.surface.pressure_per_force`), which is computed without any of this.

    A source at 1 Hz in half a cubic metre of sealed air, on which a rigid square of 1 kg floats, with a natural
    frequency of 19.4 Hz. It is lifted by the volume over its area, 4 / m^2, and 1/(1 - (1/19.4)^2) times that:

    >>> from acoustics import Receiver
    >>> from acoustics import Room
    >>> from scipy.sparse import csr_array
    >>> from femstruct.modal.analytic import oscillator
    >>> from femstruct.model.probe import Surface
    >>> from femstruct.sound.placed import placed
    >>> from femstruct.sound.two_way import with_cavity
    >>> square, points = oscillator(1.0, frequency_hz=0.0, axis="z")
    >>> corners = [[-0.25, -0.25, 0], [0.25, -0.25, 0], [0.25, 0.25, 0], [-0.25, 0.25, 0]]
    >>> under = Surface("below", [[0, 0, 0]], [0.25], [[0, 0, -1]], [[1, 0, 0], [0, 1, 0]], corners,
    ...                 csr_array([[0, 0, -1.0, 0, 0, 0, 0]]))
    >>> below = placed(Room([0.5, 0.5, 2.0]), under)
    >>> floating = with_cavity(square, below, up_to_hz=30.0)
    >>> speaker = Receiver("speaker", [0.1, 0.2, 0.3])
    >>> upwards, _ = velocity_per_source(floating, below, speaker, points["m"].probe("z"), np.array([1.0]))
    >>> print(f"{upwards[0].real:.2f}")
    4.01
    """
    hz = np.asarray(frequency_hz, dtype=np.float64)
    if not moves(basis, response):
        raise InputError("response", got="a direction without motion in any mode", expected="a direction with motion")
    loads, advice = room.room.loads(room.shapes(basis), source, hz)
    omega = 2.0 * np.pi * hz
    moved = np.empty(len(omega), dtype=np.complex128)
    for lines, q in amplitudes(basis, response.of(basis.shapes), omega):  # by reciprocity: one force for all lines
        moved[lines] = -(q * loads.T[lines]).sum(axis=1)
    return 1j * omega * moved, advice
