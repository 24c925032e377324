"""Frequency responses as studies and the command line ask for them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acoustics.errors import Advice
from acoustics.receivers import Receiver
from femstruct.arrays import Floats
from femstruct.errors import Finding, InputError, some_of
from femstruct.modal.basis import ForceRow, ModalBasis
from femstruct.modal.frf import frf, frf_unit, moves
from femstruct.modal.loss_tables import UNDAMPED
from femstruct.modal.steady.between_lines import Highest, highest, missed_peak
from femstruct.modal.superposition import Complex
from femstruct.model.probe import Probe
from femstruct.sound.power import power_per_force
from femstruct.sound.room_source import velocity_per_source
from femstruct.sound.surface import pressure_per_force
from femstruct.study.asked import VOLUME_VELOCITY, FrfRequest, RoomPlan, Spot
from femstruct.study.result import Frf
from femstruct.study.room_surfaces import placed_room
from femstruct.workflow.progress import Progress, counted
from femstruct.workflow.stages.places import Places


def frequency_response(
    request: FrfRequest,
    places: Places,
    basis: ModalBasis,
    rooms: Sequence[RoomPlan] = (),
    progress: Progress = lambda line: None,
    known: Highest | None = None,
) -> tuple[Frf, tuple[Advice | Finding, ...]]:
    """One frequency response of a study from the modal basis, advice where it is heard in a room, and a finding where
    its lines miss its peak.

    known : the largest value in that band, where it was computed before.
    """
    frequency = lines_of(request)
    if request.drive.what == VOLUME_VELOCITY:
        return _from_source(request, places, basis, rooms, frequency)
    drive = places.point(request.drive.name, _asked(request, "drive")).probe(request.drive.what)
    if request.kind == "pressure":
        return _pressure(request, drive, places, basis, rooms, frequency)
    if request.kind == "power":
        return _power(request, drive, places, basis, rooms, frequency)
    response = response_row(request.response, places, basis, _asked(request, "response"))
    for end, spot, probe in (("drive", request.drive, drive), ("response", request.response, response)):
        if isinstance(probe, Probe) and not moves(basis, probe):
            raise InputError(
                _asked(request, end),
                got=f"'{spot}', no mode moves along {spot.what}",
                expected="a direction in which the structure can move",
            )
    kind = request.kind

    def respond(hz: Floats) -> Complex:
        lines = counted(len(hz), f"lines, {len(basis.omega)} modes", progress)
        return frf(basis, drive, response, hz, kind, lines)

    values, unit = respond(frequency), frf_unit(request.kind, request.drive.what, request.response.what)
    sizes = np.abs(values)
    found = highest(respond, basis, frequency, sizes) if known is None else known.on(frequency, sizes)
    return Frf(request, frequency, values, unit, highest=found), missed_peak(found, unit)


def lines_of(request: FrfRequest) -> Floats:
    """Frequencies [nf] [Hz] of a response."""
    low, high = request.band
    return low + request.step * np.arange(int(np.floor((high - low) / request.step + 1e-9)) + 1, dtype=np.float64)


def undamped_findings(basis: ModalBasis, request: FrfRequest) -> tuple[Finding, ...]:
    """A frequency response whose peaks are no numbers: modes with no damping to speak of in its band.

    Severe: at such a mode the response is infinite or nearly so, and a peak is as high as a line happens to be near.
    """
    low, high = request.band
    ratio, hz = basis.damping_ratio, basis.frequency_hz
    true = np.array([kind == "elastic" for kind in basis.kind], dtype=bool)
    bare = np.flatnonzero(true & (ratio < UNDAMPED) & (hz >= low) & (hz <= high))
    if not len(bare):
        return ()
    first = float(hz[bare[0]])
    name = f"frf.{request.name}" if request.name else f"{request.response} / {request.drive}"
    modes = "1 mode" if len(bare) == 1 else f"{len(bare)} modes"
    most = float(ratio[bare].max())
    lacks, high_as = (
        ("without damping", "infinite")
        if most == 0.0
        else (f"with a damping ratio of at most {100 * most:.2g} %", "without meaning")
    )
    return (
        Finding(
            "no-damping",
            f"{name}: {modes} between {low:g} and {high:g} Hz, the first at {first:.4g} Hz, {lacks}: "
            f"peaks there are {high_as}, and their drawn height depends only on the step of {request.step:g} Hz. "
            "Give the model a 'damping'",
            {"modes": len(bare), "first_hz": first, "damping_ratio": most, "step_hz": request.step},
            severe=True,
        ),
    )


def _pressure(
    request: FrfRequest, drive: Probe, places: Places, basis: ModalBasis, rooms: Sequence[RoomPlan], frequency: Floats
) -> tuple[Frf, tuple[Advice, ...]]:
    """Pressure at a receiver, ROOM.RECEIVER.pressure, per unit force."""
    plan, receiver = _receiver(request.response, rooms, _asked(request, "response"))
    room = placed_room(plan, places.surfaces)
    values, advice = pressure_per_force(basis, drive, room, [receiver], frequency)
    unit = "Pa/(N m)" if request.drive.what.startswith("r") else "Pa/N"
    return Frf(request, frequency, values[0], unit), advice


def _from_source(
    request: FrfRequest, places: Places, basis: ModalBasis, rooms: Sequence[RoomPlan], frequency: Floats
) -> tuple[Frf, tuple[Advice, ...]]:
    """Velocity per volume velocity of a point source at the place of a receiver."""
    plan, source = _receiver(request.drive, rooms, _asked(request, "drive"))
    where = _asked(request, "response")
    response = places.point(request.response.name, where).probe(request.response.what)
    if not moves(basis, response):
        expected = "a direction in which the structure can move"
        raise InputError(
            where, got=f"'{request.response}', no mode moves along {request.response.what}", expected=expected
        )
    values, advice = velocity_per_source(basis, placed_room(plan, places.surfaces), source, response, frequency)
    return Frf(request, frequency, values, "rad/m^3" if request.response.what.startswith("r") else "1/m^2"), advice


def _receiver(spot: Spot, rooms: Sequence[RoomPlan], asked_by: str) -> tuple[RoomPlan, Receiver]:
    """The room and the receiver of an address ROOM.RECEIVER."""
    known = {f"{plan.name}.{receiver.name}": (plan, receiver) for plan in rooms for receiver in plan.receivers}
    if spot.name not in known:
        raise InputError(asked_by, got=f"'{spot}'", expected=" or ".join(known) or "a room")
    return known[spot.name]


def _power(
    request: FrfRequest, drive: Probe, places: Places, basis: ModalBasis, rooms: Sequence[RoomPlan], frequency: Floats
) -> tuple[Frf, tuple[Advice, ...]]:
    """Sound power into an open room, ROOM.power, over the mean square of the force."""
    plans = {plan.name: plan for plan in rooms if plan.room.open_air is not None}
    plan = plans.get(request.response.name)
    if plan is None:
        expected = " or ".join(f"{name}.power" for name in plans) or "an open room"
        raise InputError(_asked(request, "response"), got=f"'{request.response}'", expected=expected)
    room = placed_room(plan, places.surfaces)
    sound, advice = power_per_force(basis, drive, room, frequency, plan.directivity)
    unit = "W/(N m)^2" if request.drive.what.startswith("r") else "W/N^2"
    return Frf(request, frequency, sound.power.astype(np.complex128), unit, sound), advice


def response_row(spot: Spot, places: Places, basis: ModalBasis, asked_by: str) -> Probe | ForceRow:
    """The response of a frequency response: a point's direction or a force of the structure.

    Raises InputError when there is no such force or place.
    """
    if not spot.what.startswith("force"):
        return places.point(spot.name, asked_by).probe(spot.what)
    key = f"{spot.name}.{force_axis(spot)}"
    if key not in basis.outputs:
        forces = sorted({name.rpartition(".")[0] for name in basis.outputs})
        raise InputError(
            asked_by,
            got=f"'{spot}'",
            expected=f"a force of {some_of(forces) or 'nothing'}",
        )
    return basis.outputs[key]


def force_axis(spot: Spot) -> str:
    """The axis of a force: z where none is said."""
    return spot.what.removeprefix("force").lstrip("_") or "z"


def _asked(request: FrfRequest, end: str) -> str:
    """Who asks for an end of a response: a named request of a study, or an option of the command line."""
    return f"frf.{request.name}.{end}" if request.name else f"--{end}"
