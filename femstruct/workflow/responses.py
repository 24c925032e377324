"""Frequency responses as studies and the command line ask for them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acoustics.errors import Advice
from acoustics.field import HalfSpace
from femstruct.arrays import Floats
from femstruct.assembly.assemble import assemble
from femstruct.errors import InputError, some_of
from femstruct.language import read_model_file
from femstruct.modal.basis import ForceRow, ModalBasis
from femstruct.modal.damping import Damping, with_damping
from femstruct.modal.frf import KINDS, direct_frf, frf, frf_unit, moves
from femstruct.model.probe import Probe
from femstruct.power import power_per_force
from femstruct.radiation import pressure_per_force
from femstruct.study.result import Frf
from femstruct.study.study import Extent, FrfRequest, RoomPlan, Spot, Study
from femstruct.units import quantity
from femstruct.workflow.air import ceiling
from femstruct.workflow.bases import Solved, solve
from femstruct.workflow.places import Places
from femstruct.workflow.positions import positioned

DEFAULT_LINES = 500
MOST_LINES = 1_000_000
Table = dict[str, Any]


def frequency_response(
    request: FrfRequest, places: Places, basis: ModalBasis, rooms: Sequence[RoomPlan] = ()
) -> tuple[Frf, tuple[Advice, ...]]:
    """One frequency response of a study from the modal basis, and advice where it is heard in a room."""
    start, stop = request.band
    lines = np.arange(int(np.floor((stop - start) / request.step + 1e-9)) + 1, dtype=np.float64)
    frequency = start + request.step * lines
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
    values = frf(basis, drive, response, frequency, request.kind)
    return Frf(request, frequency, values, frf_unit(request.kind, request.drive.what, request.response.what)), ()


def _pressure(
    request: FrfRequest, drive: Probe, places: Places, basis: ModalBasis, rooms: Sequence[RoomPlan], frequency: Floats
) -> tuple[Frf, tuple[Advice, ...]]:
    """Pressure at a receiver, ROOM.RECEIVER.pressure, per unit force."""
    heard = {f"{plan.name}.{receiver.name}": (plan, receiver) for plan in rooms for receiver in plan.receivers}
    if request.response.name not in heard:
        raise InputError(
            _asked(request, "response"), got=f"'{request.response}'", expected=" or ".join(heard) or "a room"
        )
    plan, receiver = heard[request.response.name]
    surface = ceiling(plan, places)
    values, advice = pressure_per_force(basis, drive, surface, plan.room, [receiver], frequency, plan.offset, plan.name)
    unit = "Pa/(N m)" if request.drive.what.startswith("r") else "Pa/N"
    return Frf(request, frequency, values[0], unit), advice


def _power(
    request: FrfRequest, drive: Probe, places: Places, basis: ModalBasis, rooms: Sequence[RoomPlan], frequency: Floats
) -> tuple[Frf, tuple[Advice, ...]]:
    """Sound power into an open room, ROOM.power, over the mean square of the force."""
    plans = {plan.name: plan for plan in rooms if isinstance(plan.room, HalfSpace)}
    plan = plans.get(request.response.name)
    if plan is None or not isinstance(plan.room, HalfSpace):
        expected = " or ".join(f"{name}.power" for name in plans) or "an open room"
        raise InputError(_asked(request, "response"), got=f"'{request.response}'", expected=expected)
    surface = ceiling(plan, places)
    sound, advice = power_per_force(basis, drive, surface, plan.room, frequency, plan.directivity, plan.name)
    unit = "W/(N m)^2" if request.drive.what.startswith("r") else "W/N^2"
    return Frf(request, frequency, sound.power.astype(np.complex128), unit, sound), advice


def response_row(spot: Spot, places: Places, basis: ModalBasis, asked_by: str) -> Probe | ForceRow:
    """What a frequency response listens to: a point's direction or a force of the structure.

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


def frf_of(
    path: Path,
    drive: str,
    response: str,
    band: str,
    step: str,
    kind: str,
    method: str,
    overrides: tuple[str, ...] = (),
) -> Table:
    """One frequency response of a model file, by modes with residuals or, as their check, line by line.

    kind : "" for accelerance, and transmissibility of a force.

    Notes
    -----
    The basis holds all modes up to 2.5 times the upper end of the band, where residual vectors leave 1e-3.
    """
    request = _request(drive, response, band, step, kind)
    if method not in ("modal", "direct"):
        raise InputError("--method", got=f"'{method}'", expected="modal or direct")
    source = read_model_file(path, overrides)
    with positioned(source):
        asking = Study(source.title, source.structure, source.damping, Extent(), frf=(request,))
        solved = solve(source.structure, Extent(up_to_hz=2.5 * request.band[1]), (asking,))
        basis = with_damping(solved.basis, source.damping)
        answer, _ = frequency_response(request, solved.places, basis)
        values = _direct(request, solved, source.damping, answer) if method == "direct" else answer.values
    return {
        "title": source.title,
        "drive": drive,
        "response": response,
        "kind": request.kind,
        "method": method,
        "frequency_hz": answer.frequency_hz.tolist(),
        "real": np.real(values).tolist(),
        "imag": np.imag(values).tolist(),
        "unit": answer.unit,
    }


def _direct(request: FrfRequest, solved: Solved, damping: Damping, answer: Frf) -> NDArray[np.complex128]:
    if solved.model is None:
        raise InputError(
            "--method", got="'direct' of a closed-form structure", expected="modal", do="it has no matrices"
        )
    response: Probe | str = f"{request.response.name}.{force_axis(request.response)}"
    if not request.response.what.startswith("force"):
        response = solved.places.point(request.response.name, "--response").probe(request.response.what)
    drive = solved.places.point(request.drive.name, "--drive").probe(request.drive.what)
    assert request.kind != "pressure" and request.kind != "power"  # a model has no rooms
    return direct_frf(assemble(solved.model), drive, response, answer.frequency_hz, damping, request.kind)


def _request(drive: str, response: str, band: str, step: str, kind: str) -> FrfRequest:
    """What the command line asks for, checked.

    Raises InputError that begins with the option's own name.
    """
    listened = _spot(response, "--response")
    chosen = kind or ("transmissibility" if listened.what.startswith("force") else "accelerance")
    if chosen not in KINDS:
        raise InputError("--kind", got=f"'{kind}'", expected=", ".join(KINDS))
    low, high = _band(band)
    width = frequency_option(step, "--step") if step else (high - low) / DEFAULT_LINES
    if not width > 0 or (high - low) / width > MOST_LINES:
        raise InputError("--step", got=f"'{step}'", expected=f"a positive step, for at most {MOST_LINES:,} lines")
    return FrfRequest("", _spot(drive, "--drive"), listened, chosen, (low, high), width)


def frequency_option(text: str, option: str) -> float:
    """A frequency given on the command line [Hz].

    Raises InputError that begins with the option's name.
    """
    try:
        return quantity(text, "frequency")
    except InputError as error:
        raise InputError(option, got=error.got, expected=error.expected, do=error.do) from error


def _band(text: str) -> tuple[float, float]:
    low, colon, high = text.partition(":")
    if not colon:
        raise InputError("--band", got=f"'{text}'", expected="two frequencies, such as '1 Hz:500 Hz'")
    band = frequency_option(low.strip(), "--band"), frequency_option(high.strip(), "--band")
    if not 0 <= band[0] < band[1]:
        raise InputError("--band", got=f"'{text}'", expected="a lower and a higher frequency")
    return band


def _spot(text: str, where: str) -> Spot:
    name, _, what = text.rpartition(".")
    if not name:
        raise InputError(where, got=f"'{text}'", expected="POINT.direction or NAME.force, such as O_s.z")
    return Spot(name, what)
