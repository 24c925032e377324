"""The crossing between structures and rooms: velocities of surfaces, and sources in rooms that move what is around."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acoustics.arrays import Complexes
from acoustics.errors import Advice
from acoustics.fields.sound_field import air_stiffness_ratio
from acoustics.receivers import Receiver
from acoustics.source import SurfaceVelocity, SurfaceVibration
from femstruct.arrays import Floats, Integers
from femstruct.declared import expect
from femstruct.errors import Finding, InputError
from femstruct.impact.response import Response
from femstruct.modal.basis import ModalBasis
from femstruct.modal.frf import amplitudes, modal_amplitudes, moves_probe
from femstruct.model.probe import Probe
from femstruct.sound.placed import Placed

# ----------------------------------------------------------------------------------------------------------------------
# The crossing from the structure to the room: a response and its surfaces become what moves the air.
# ----------------------------------------------------------------------------------------------------------------------

Motion = tuple[SurfaceVelocity, ...]  # of all surfaces of a room
MIN_SHARE_OF_SURFACE = (
    1e-9  # share of the speed of the mode that moves a surface most, below which a mode does not move it
)
STILL = 1e-8  # of the structure's speed: modes of parts that are not joined mix up to about 1e-11, and 1e-8 is 160 dB
STIFF_AIR = 0.1  # air stiffness over structural stiffness above which frequencies move by more than 5 %


def surface_velocity(response: Response, room: Placed) -> Motion:
    """Velocities of the surfaces of a room, each factored into shapes and modal rates.

    Parameters
    ----------
    response : Response
        Its basis must be the one of the meshed structure the surfaces belong to.

    Returns
    -------
    Motion
        A SurfaceVelocity for every surface, with shapes [p, k] in 1/sqrt(kg), positive into the room, and the same
        rates [k, nt], of the modes that move any of them: those below 1e-9 of the one that moves it most, by symmetry
        but for rounding, are left out.

    Examples
    --------
    A rigid square of 1 kg, its underside one point of 0.25 m^2, hit from above by an equal mass that hands over all
    its speed of 1 m/s: for the room below the ceiling moves inwards at 1 m/s.

    >>> from acoustics.fields.rectangular import Room
    >>> from femstruct.model.probe import Surface
    >>> from femstruct.sound.placed import placed
    >>> from scipy.sparse import csr_array
    >>> from femstruct.impact.scene import Body, Clock, Contact, Scene
    >>> from femstruct.laws.linear import Linear
    >>> from femstruct.impact.simulate import simulate
    >>> from femstruct.modal.closed_form import oscillator
    >>> square, points = oscillator(1.0, frequency_hz=0.0, axis="z")
    >>> hit = Contact("hit", upper="ball", lower=points["m"].probe("z"), law=Linear(1e6))
    >>> response = simulate(square, Scene((Body("ball", 1.0, -1.0),), (hit,)), Clock(0.01, 10e3))
    >>> corners = [[-0.25, -0.25, 0], [0.25, -0.25, 0], [0.25, 0.25, 0], [-0.25, 0.25, 0]]
    >>> below = Surface("below", [[0, 0, 0]], [0.25], [[0, 0, -1]], [[1, 0, 0], [0, 1, 0]], corners,
    ...                 csr_array([[0, 0, -1.0, 0, 0, 0, 0]]))
    >>> (moving,) = surface_velocity(response, placed(Room([0.5, 0.5, 1.0]), below))
    >>> round(float(moving.shapes[0] @ moving.rates[:, -1]), 9), moving.points.tolist()
    (1.0, [[0.25, 0.25, 1.0]])
    """
    expect("surface_velocity response", response, Response, "simulate makes one")
    expect("surface_velocity room", room, Placed, "placed(room, surface) is one")
    return surface_velocities([response], room)[0]


def surface_velocities(responses: Sequence[Response], room: Placed) -> list[Motion]:
    """The same of several responses of one basis, in the modes that move any of the surfaces in any of them.

    Of a response that moves none of them (`is_at_rest`) the rates are 0: what they have are rounding errors.
    """
    surfaces, moving = room.shapes(responses[0].basis), moving_modes(responses, room)
    found = []
    for response in responses:
        rates, dt = response.velocities(moving), 1.0 / response.clock.sampling
        if is_at_rest(response, room):
            rates = np.zeros_like(rates)
        found.append(
            tuple(SurfaceVelocity(one.points, one.weights, one.shapes[:, moving], rates, dt) for one in surfaces)
        )
    return found


def is_at_rest(response: Response, room: Placed) -> bool:
    """Whether a response moves none of a room's surfaces, but for rounding: a part of the structure that nothing joins
    to what is struck.

    Notes
    -----
    No surface has, of all modes together, more than 1e-8 of the largest speed of a mode times the largest shape there,
    which is no less than 1/sqrt(m) with m the mass of all.
    """
    return _still(response.basis, room, response.amplitudes())


def _still(basis: ModalBasis, room: Placed, speed: Floats) -> bool:
    """Whether modes with a speed each [k] move none of a room's surfaces but for rounding."""
    largest = np.max([np.abs(one.shapes).max(axis=0) for one in room.shapes(basis)], axis=0)
    shape = max(float(largest.max(initial=0.0)), basis.total_mass**-0.5 if basis.total_mass > 0.0 else 0.0)
    return float(np.linalg.norm(largest * speed)) <= STILL * shape * float(speed.max(initial=0.0))


def moving_modes(responses: Sequence[Response], room: Placed) -> Integers:
    """Numbers of the modes that move any of the surfaces in any of the responses."""
    surfaces = room.shapes(responses[0].basis)
    kept = np.zeros(surfaces[0].shapes.shape[1], dtype=bool)
    for one in surfaces:
        largest = np.abs(one.shapes).max(axis=0)
        for response in responses:
            speed = largest * response.amplitudes()
            kept |= speed >= MIN_SHARE_OF_SURFACE * speed.max(initial=0.0)
    return np.flatnonzero(kept)


def pressure_per_force(
    basis: ModalBasis, drive: Probe, room: Placed, receivers: Sequence[Receiver], frequency_hz: Floats
) -> tuple[Complexes, tuple[Advice, ...]]:
    """Pressure at receivers of a room per unit of harmonic force on the structure [n_receivers, nf] [Pa/N], and
    advice.

    It is 0 where nothing joins the surfaces to what is driven.

    Parameters
    ----------
    basis : ModalBasis
        In vacuo for one-way coupling; coupled to the room by `with_cavity` for two-way coupling.
    frequency_hz : Floats [nf]
        Above 0 [Hz].

    Raises
    ------
    AcousticsError
        For a receiver outside the room, or a resonance of a room without losses.
    """
    velocity = 2j * np.pi * frequency_hz * modal_amplitudes(basis, drive, frequency_hz)
    if _still(basis, room, np.abs(velocity).max(axis=1, initial=0.0)):
        velocity = np.zeros_like(velocity)
    moving = [
        SurfaceVibration(one.points, one.weights, one.shapes, velocity, frequency_hz) for one in room.shapes(basis)
    ]
    return room.room.harmonic(moving, receivers)


def air_stiffness(basis: ModalBasis, room: Placed) -> Floats:
    """Stiffness of the sealed room's air over that of the structure, for every mode [k]; 0 for rigid modes and beyond.

    Notes
    -----
    A mode that displaces the volume L q stores the energy rho c^2 (L q)^2 / 2V in the room beside its own
    omega^2 q^2 / 2; see `acoustics.air_stiffness_ratio`.
    """
    displaced = sum(one.weights @ one.shapes(basis.shapes) for one in room.surfaces)
    elastic = np.array([kind == "elastic" for kind in basis.kind])
    ratios = air_stiffness_ratio(room.room, displaced, np.where(elastic, basis.omega**2, np.inf))
    return np.asarray(ratios, dtype=np.float64)


def coupling_findings(basis: ModalBasis, room: Placed) -> tuple[Finding, ...]:
    """A finding when the air of a sealed room is too stiff for one-way coupling."""
    ratios = air_stiffness(basis, room)
    if not room.room.pushes_back or not ratios.size or ratios.max() < STIFF_AIR:
        return ()
    worst = int(ratios.argmax())
    frequency, ratio = float(basis.frequency_hz[worst]), float(ratios[worst])
    return (
        Finding(
            "one-way-stiff-air",
            f"The air of the sealed room is {ratio:.2f} times as stiff as the structure in mode {worst + 1} "
            f"({frequency:.2f} Hz) and would raise it to about {frequency * np.sqrt(1 + ratio):.1f} Hz. Coupling is "
            "one-way: differences between cases remain valid, sound pressures and this frequency do not",
            {"air_to_structure_stiffness": ratio, "mode": worst + 1.0, "frequency_hz": frequency},
        ),
    )


# ----------------------------------------------------------------------------------------------------------------------
# The crossing from a room to the structure: a point source in the air of a room moves what is around it.
# ----------------------------------------------------------------------------------------------------------------------


def velocity_per_source(
    basis: ModalBasis, room: Placed, source: Receiver, response: Probe, frequency_hz: Floats
) -> tuple[Complexes, tuple[Advice, ...]]:
    """Velocity of a place of the structure per volume velocity of a harmonic point source in a room [nf] [1/m^2], and
    advice: what a loudspeaker of known volume velocity and an accelerometer on the floor measure.

    Parameters
    ----------
    basis : ModalBasis
        In vacuo for one-way coupling; coupled to the room by `with_cavity` for two-way coupling, where the source moves
        the surfaces and these move the air, which reacts on them.
    room, source : Placed, Receiver
        Where it stands, in the room's coordinates.
    response : Probe
        What moves, of a direction or a rotation [rad/m^3].
    frequency_hz : Floats [nf]
        Above 0 [Hz].

    Raises
    ------
    InputError
        For a response that no mode moves, AcousticsError for a source outside the room, or a resonance of a room
        without losses.

    Notes
    -----
    The pressure of the source on surfaces that are held, integrated over them with the shapes of the modes, is a force
    on the modes, out of the room. The air's answer to the motion that follows is in the modes of a coupled basis, so
    that nothing more acts. By reciprocity the result is minus the pressure at the source's place per force on the
    structure (`pressure_per_force`), which is computed without any of this.

    Examples
    --------
    A source at 1 Hz in half a cubic metre of sealed air, on which a rigid square of 1 kg floats, with a natural
    frequency of 19.4 Hz. It is lifted by the volume over its area, 4 / m^2, and 1/(1 - (1/19.4)^2) times that:

    >>> from acoustics import Receiver
    >>> from acoustics import Room
    >>> from scipy.sparse import csr_array
    >>> from femstruct.modal.closed_form import oscillator
    >>> from femstruct.model.probe import Surface
    >>> from femstruct.sound.placed import placed
    >>> from femstruct.sound.coupling import with_cavity
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
    if not moves_probe(basis, response):
        raise InputError("response", got="a direction without motion in any mode", expected="a direction with motion")
    loads, advice = room.room.loads(room.shapes(basis), source, hz)
    omega = 2.0 * np.pi * hz
    moved = np.empty(len(omega), dtype=np.complex128)
    for lines, q in amplitudes(basis, response.of(basis.shapes), omega):  # by reciprocity: one force for all lines
        moved[lines] = -(q * loads.T[lines]).sum(axis=1)
    return 1j * omega * moved, advice
