"""The crossing from the structure to the room: a response and a surface become a moving ceiling."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np

from acoustics.arrays import Complexes
from acoustics.errors import Advice
from acoustics.meshed.finite_elements import OFF_WALL, off_boundary
from acoustics.meshed.meshed_pressure import cavity_pressures, harmonic_cavity_pressure
from acoustics.meshed.meshed_room import ShapedRoom
from acoustics.open_air.half_space import HalfSpace, field_pressures, harmonic_field
from acoustics.rooms.box import Enclosed, Receiver, Room, air_stiffness_ratio
from acoustics.rooms.box_harmonic import harmonic_pressure
from acoustics.rooms.box_pressure import RoomResponse, pressures
from acoustics.source import SurfaceVelocity
from femstruct.arrays import Floats
from femstruct.errors import Finding, InputError
from femstruct.impact.result.response import Response
from femstruct.modal.basis import ModalBasis
from femstruct.modal.frf import modal_amplitudes
from femstruct.model.probe import Probe, Surface

AnyRoom = Room | ShapedRoom | HalfSpace
STILL = 1e-9  # share of the speed of the mode that moves a surface most, below which a mode does not move it
STIFF_AIR = 0.1  # air stiffness over structural stiffness above which frequencies move by more than 5 %


def surface_velocity(
    response: Response,
    surface: Surface,
    room: AnyRoom,
    offset: tuple[float, float] = (0.0, 0.0),
    name: str = "",
) -> SurfaceVelocity:
    """Velocity of a surface as the moving ceiling of a room, factored into shapes and modal rates.

    response : its basis must be the one of the meshed structure the surface belongs to.
    surface : its normal points into the room.
    offset : of its centre from the ceiling's centre, room axes [m].
    name : of the room; a basis that is coupled to it may have a leak of that name.

    Returns a SurfaceVelocity with shapes [p, k] in 1/sqrt(kg), positive into the room, and rates [k, nt], of the modes
    that move it: those below 1e-9 of the one that moves it most, by symmetry but for rounding, are left out.

    Raises InputError when the surface is not the underside of something horizontal, or is larger than the ceiling.

    Notes
    -----
    Room axes: x along the surface's own first side, z opposite to its normal, so that the room lies below.

    Examples
    --------
    A rigid square of 1 kg, its underside one point of 0.25 m^2, hit from above by an equal mass that hands over all
    its speed of 1 m/s: the room below hears a ceiling coming in at 1 m/s.

    >>> import numpy as np
    >>> from scipy.sparse import csr_array
    >>> from femstruct.impact.scene.bodies import Body, Clock, Contact, Scene
    >>> from femstruct.impact.laws.linear import Linear
    >>> from femstruct.impact.simulate import simulate
    >>> from femstruct.modal.analytic import oscillator
    >>> square, points = oscillator(1.0, frequency_hz=0.0, axis="z")
    >>> hit = Contact("hit", upper="ball", lower=points["m"].probe("z"), law=Linear(1e6))
    >>> response = simulate(square, Scene((Body("ball", 1.0, -1.0),), (hit,)), Clock(0.01, 10e3))
    >>> below = Surface("below", [[0, 0, 0]], [0.25], [0, 0, -1], [-0.25, -0.25, 0], [[1, 0, 0], [0, 1, 0]],
    ...                 [0.5, 0.5], csr_array([[0, 0, -1.0, 0, 0, 0, 0]]))
    >>> moving = surface_velocity(response, below, Room([0.5, 0.5, 1.0]))
    >>> round(float(moving.shapes[0] @ moving.rates[:, -1]), 9), moving.points.tolist()
    (1.0, [[0.25, 0.25, 1.0]])
    """
    return surface_velocities([response], surface, room, offset, name)[0]


def surface_velocities(
    responses: Sequence[Response],
    surface: Surface,
    room: AnyRoom,
    offset: tuple[float, float] = (0.0, 0.0),
    name: str = "",
) -> list[SurfaceVelocity]:
    """The same of several responses of one basis, with the same shapes: those of the modes that move it in any of them.

    Raises InputError as `surface_velocity` does.
    """
    shapes = ceiling_shapes(responses[0].basis, surface, name)
    largest = np.abs(shapes).max(axis=0)
    speeds = [largest * response.amplitudes() for response in responses]
    moving = np.flatnonzero(np.any([speed >= STILL * speed.max(initial=0.0) for speed in speeds], axis=0))
    points, kept = room_coordinates(surface, room, offset, name), shapes[:, moving]
    return [
        SurfaceVelocity(
            points=points,
            weights=surface.weights,
            shapes=kept,
            rates=response.velocities(moving),
            dt=1.0 / response.clock.sampling,
        )
        for response in responses
    ]


def heard(
    moving: Sequence[SurfaceVelocity], room: AnyRoom, receivers: Sequence[Receiver], up_to_hz: float = inf
) -> list[RoomResponse]:
    """Pressure at the receivers of a room for each motion of its ceiling: of a box by cosines, of any other room by its
    modes, of a half space by Rayleigh's integral.

    up_to_hz : the highest frequency of interest; what lies above it may be left out.
    """
    if isinstance(room, HalfSpace):
        return field_pressures(moving, room, receivers)
    if isinstance(room, ShapedRoom):
        return cavity_pressures(moving, room.modes, room.air, room.losses, receivers, room.walls)
    return pressures(moving, room, receivers, up_to_hz=up_to_hz)


def ceiling_shapes(basis: ModalBasis, surface: Surface, name: str = "") -> Floats:
    """Motion of a surface into the room in every mode [p, k], with the flow through a leak of that room spread over it.

    name : of the room.
    """
    shapes = surface.shapes(basis.shapes)
    return shapes + basis.volumes[name] / surface.weights.sum() if name in basis.volumes else shapes


def pressure_per_force(
    basis: ModalBasis,
    drive: Probe,
    surface: Surface,
    room: AnyRoom,
    receivers: Sequence[Receiver],
    frequency_hz: Floats,
    offset: tuple[float, float] = (0.0, 0.0),
    name: str = "",
) -> tuple[Complexes, tuple[Advice, ...]]:
    """Pressure at receivers of a room per unit of harmonic force on the structure [n_receivers, nf] [Pa/N], and advice.

    basis : in vacuo for one-way coupling; coupled to the room by `with_cavity` the air pushes back.
    frequency_hz [nf] : above 0 [Hz].

    Raises InputError as `surface_velocity` does; AcousticsError for a receiver outside the room, or a resonance of a
    room without losses.
    """
    velocity = 2j * np.pi * frequency_hz * modal_amplitudes(basis, drive, frequency_hz)
    points = room_coordinates(surface, room, offset, name)
    shapes = ceiling_shapes(basis, surface, name)
    return _harmonic(room, points, surface.weights, shapes, velocity, frequency_hz, receivers)


def pressure_spectrum(moving: SurfaceVelocity, room: AnyRoom, frequency_hz: Floats, places: Floats) -> Complexes:
    """Fourier transform [n, nf] [Pa/Hz] of the pressure at places [n, 3] of a room whose ceiling moves as recorded.

    As of `acoustics.rooms.pressure_maps.pressure_map`: of the velocity's record times the transfer function at that
    frequency.

    Raises AcousticsError: a place outside the room, a room without losses at a resonance.
    """
    kernel = moving.dt * np.exp(-2j * np.pi * np.outer(moving.t, frequency_hz))
    receivers = [Receiver(str(number), place) for number, place in enumerate(places)]
    rates = moving.rates @ kernel
    return _harmonic(room, moving.points, moving.weights, moving.shapes, rates, frequency_hz, receivers)[0]


def _harmonic(
    room: AnyRoom,
    points: Floats,
    weights: Floats,
    shapes: Floats,
    rates: Complexes,
    frequency_hz: Floats,
    receivers: Sequence[Receiver],
) -> tuple[Complexes, tuple[Advice, ...]]:
    """Of a box by cosines, of any other room by its modes, of a half space by Rayleigh's integral."""
    if isinstance(room, HalfSpace):
        return harmonic_field(room, points, weights, shapes, rates, frequency_hz, receivers)
    if isinstance(room, ShapedRoom):
        return harmonic_cavity_pressure(room, points, weights, shapes, rates, frequency_hz, receivers)
    return harmonic_pressure(room, points, weights, shapes, rates, frequency_hz, receivers)


def room_coordinates(
    surface: Surface, room: AnyRoom, offset: tuple[float, float] = (0.0, 0.0), name: str = ""
) -> Floats:
    """Quadrature points [p, 3] of a surface in the coordinates of its room, below it or beside it [m].

    name : of the room, with which an error begins; the surface's own path if left out.

    Raises InputError as `surface_velocity` does.
    """
    if isinstance(room, HalfSpace):
        return _beside(surface, room, name)
    if surface.normal[2] > -0.99:
        raise InputError(
            f"rooms.{name}" if name else f"surfaces.{surface.name}",
            got=f"a surface with normal ({surface.normal[0]:.2g}, {surface.normal[1]:.2g}, {surface.normal[2]:.2g})",
            expected="a normal that points down: the ceiling of its room",
            do="use `side: below` on a horizontal plate",
        )
    centre = surface.corner + surface.size @ surface.along / 2.0
    flat = (surface.points - centre) @ surface.along.T
    if isinstance(room, ShapedRoom):
        points = np.column_stack([flat, np.zeros(len(flat))]) + room.centre + [*offset, 0.0]
        off, reach = off_boundary(room.mesh, points, room.ceiling)
        if off.max() > OFF_WALL * reach:
            raise InputError(
                f"rooms.{name}" if name else f"surfaces.{surface.name}",
                got=f"a surface that reaches beyond the wall '{room.ceiling}' of the room, at "
                f"{points[off.argmax(), :2].round(6).tolist()} m",
                expected="a surface within it",
                do="place its centre with `at`, or give it a `region: {rectangle: [..]}`",
            )
        return points
    middle = np.asarray(room.size[:2]) / 2.0 + offset
    beyond = np.abs(offset) + surface.size / 2.0 - np.asarray(room.size[:2]) / 2.0
    if beyond.max() > 1e-9:
        raise InputError(
            f"rooms.{name}" if name else f"surfaces.{surface.name}",
            got=f"a surface of {surface.size[0]:g} x {surface.size[1]:g} m over a room of "
            f"{room.size[0]:g} x {room.size[1]:g} m, {beyond.max():.3g} m beyond its walls",
            expected="a surface within the ceiling",
            do="give the surface a `region: {rectangle: [..]}` of the room's size, or another `at`",
        )
    return np.column_stack([flat + middle, np.full(len(flat), room.size[2])])


def _beside(surface: Surface, space: HalfSpace, name: str) -> Floats:
    """Points of a surface from its centre, global axes [p, 3] [m]; its normal is that of the half space."""
    if surface.normal @ space.normal < 0.99:
        towards = "up" if space.normal[2] > 0 else "down"
        raise InputError(
            f"rooms.{name}" if name else f"surfaces.{surface.name}",
            got=f"a surface with normal ({surface.normal[0]:.2g}, {surface.normal[1]:.2g}, {surface.normal[2]:.2g})",
            expected=f"a normal that points {towards}, into the air",
            do=f"use `side: {'above' if towards == 'up' else 'below'}` on a horizontal plate",
        )
    points: Floats = surface.points - (surface.corner + surface.size @ surface.along / 2.0)
    return points


def air_stiffness(basis: ModalBasis, surface: Surface, room: Enclosed) -> Floats:
    """Stiffness of the sealed room's air over that of the structure, for every mode [k]; 0 for rigid modes and beyond.

    Notes
    -----
    A mode that displaces the volume L q stores the energy rho c^2 (L q)^2 / 2V in the room beside its own
    omega^2 q^2 / 2; see `acoustics.air_stiffness_ratio`.
    """
    displaced = surface.weights @ surface.shapes(basis.shapes)
    elastic = np.array([kind == "elastic" for kind in basis.kind])
    ratios = air_stiffness_ratio(room, displaced, np.where(elastic, basis.omega**2, np.inf))
    return np.asarray(ratios, dtype=np.float64)


def coupling_findings(basis: ModalBasis, surface: Surface, room: AnyRoom) -> tuple[Finding, ...]:
    """A finding when the air of a sealed room is too stiff for one-way coupling."""
    if isinstance(room, HalfSpace):
        return ()
    ratios = air_stiffness(basis, surface, room)
    if not ratios.size or ratios.max() < STIFF_AIR:
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
