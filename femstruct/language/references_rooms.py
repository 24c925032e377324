"""The second pass over the rooms of a study file: who listens where, to what, and by which standard."""

from __future__ import annotations

from acoustics.errors import AcousticsError
from acoustics.levels.methods import method_of, refuse_source
from femstruct.impact.scene.impact_sources import BETWEEN_BLOWS, HAMMERS, TAPPING_MACHINE
from femstruct.language.model.model import ModelSpec
from femstruct.language.schema_rooms import RoomSpec
from femstruct.language.schema_study import FrfSpec, StudySpec
from femstruct.language.yaml.checker import Checker
from femstruct.language.yaml.reader import Steps, nearest

DENSEST_GAS, SLOWEST_LIQUID = 1000.0, 500.0  # kg/m^3: carbon dioxide at 700 bar; m/s: fluorinated liquids have 550


def check_rooms(check: Checker, study: StudySpec, model: ModelSpec) -> None:
    """Every room is beside a surface that is there, and its keys agree with each other and with the study's."""
    for name, room in study.rooms.items():
        check.known(("rooms", name, room.beside), room.surface, "surface", model.surfaces)
        _check_mesh(check, name, room)
        _check_air(check, name, room)
        if room.losses is not None and room.losses.t60 is not None and room.form == "source":
            check.wrong(
                ("rooms", name, "form"), "the source's form with t60", "beta or loss_factor", "leave out 'form'"
            )
        _check_coupling(check, study, name, room)
        _check_levels(check, study, name, room)
        if room.animate and not room.receivers:
            got = "a moving picture without receivers"
            check.wrong(("rooms", name, "animate"), got, "a receiver to cut the room at", "add 'receivers:'")
        _check_receivers(check, name, room)
        _check_directivity(check, study, name, room)


def check_pressure(check: Checker, study: StudySpec, name: str, request: FrfSpec) -> None:
    """A pressure is heard at ROOM.RECEIVER, and never at 0 Hz."""
    here: Steps = ("frf", name)
    if request.kind != "pressure":
        check.wrong((*here, "kind"), f"'{request.kind}' of a pressure", "pressure", "write 'kind: pressure'")
        return
    known = [
        f"{room}.{receiver}.pressure" if len(places) == 1 else f"{room}.{receiver}.{number}.pressure"
        for room, spec in study.rooms.items()
        for receiver, places in spec.receivers.items()
        for number in range(1, len(places) + 1)
    ]
    if request.response not in known:
        do = nearest(request.response, known) or "there are no receivers: add 'rooms:'"
        check.wrong((*here, "response"), f"'{request.response}'", "ROOM.RECEIVER.pressure", do)
    if request.band[0] == 0.0:
        check.wrong((*here, "band"), "0 Hz", "a band above 0 Hz")


def check_power(check: Checker, study: StudySpec, name: str, request: FrfSpec) -> None:
    """A sound power is that of an open room, ROOM.power, and never at 0 Hz."""
    here: Steps = ("frf", name)
    if request.kind != "power":
        check.wrong((*here, "kind"), f"'{request.kind}' of a power", "power", "write 'kind: power'")
        return
    known = [f"{room}.power" for room, spec in study.rooms.items() if spec.under is None]
    if request.response not in known:
        do = nearest(request.response, known) or "only rooms 'above' or 'below' a surface have a power"
        check.wrong((*here, "response"), f"'{request.response}'", "ROOM.power", do)
    if request.band[0] == 0.0:
        check.wrong((*here, "band"), "0 Hz", "a band above 0 Hz")


def _check_directivity(check: Checker, study: StudySpec, name: str, room: RoomSpec) -> None:
    """A directivity is of something that radiates, at frequencies that the sampling has."""
    here: Steps = ("rooms", name, "directivity")
    if not room.directivity:
        return
    powers = [one for one in study.frf.values() if one.kind == "power" and one.response == f"{name}.power"]
    if study.time is None and not powers:
        do = f"add 'time:', or a response of 'kind: power' to '{name}.power'"
        check.wrong(here, "a directivity of nothing that moves", "a simulation or a power", do)
    half = study.time.sampling / 2 if study.time is not None else float("inf")
    if max(room.directivity) >= half:
        got = f"{max(room.directivity):g} Hz"
        check.wrong(here, got, f"less than half the sampling, {half:g} Hz", "sample faster")


def _check_receivers(check: Checker, name: str, room: RoomSpec) -> None:
    """Receivers are inside a box, and on the surface's side of a half space."""
    for receiver, places in room.receivers.items():
        for place in places:
            if room.under is None and (place[2] > 0) != (room.above is not None):
                got, expected = f"{list(place)} m", f"a point {room.beside} the surface"
                do = "measure from the surface's centre, z up"
                check.wrong(("rooms", name, "receivers", receiver), got, expected, do)
            if room.size and not all(0 <= x <= length for x, length in zip(place, room.size, strict=True)):
                steps: Steps = ("rooms", name, "receivers", receiver)
                size = " x ".join(f"{length:g}" for length in room.size)
                check.wrong(steps, f"{list(place)} m", f"a point of the room, {size} m", "from its lower corner")


def _check_air(check: Checker, name: str, room: RoomSpec) -> None:
    """A fluid is a gas or a liquid; sound of a box goes from wall to wall at least once while it dies away."""
    if room.air.rho > DENSEST_GAS and room.air.c < SLOWEST_LIQUID:
        got = f"{room.air.rho:g} kg/m^3 beside a speed of sound of {room.air.c:g} m/s"
        expected = f"a gas below {DENSEST_GAS:g} kg/m^3, or a liquid above {SLOWEST_LIQUID:g} m/s"
        check.wrong(("rooms", name, "air", "rho"), got, expected, "air has 1.21 kg/m^3 and 343 m/s")
    t60 = room.losses.t60 if room.losses is not None else None
    if room.size is None or t60 is None:
        return
    x, y, z = room.size
    between = 4.0 * x * y * z / (2.0 * (x * y + y * z + z * x)) / room.air.c
    shortest = min(t60.values()) if isinstance(t60, dict) else t60
    if shortest < between:
        got = f"{1e3 * shortest:g} ms, less than sound takes from wall to wall, {1e3 * between:.2g} ms"
        do = f"did you mean {1e3 * shortest:g} s?"
        check.wrong(("rooms", name, "losses", "t60"), got, "a reverberation time: sound falls by 60 dB in it", do)


def _check_coupling(check: Checker, study: StudySpec, name: str, room: RoomSpec) -> None:
    """Air that pushes back is causal, and fills one room under a surface."""
    if room.coupling == "one-way":
        if room.leak is not None:
            check.wrong(
                ("rooms", name, "leak"), "a leak with one-way coupling", "coupling: two-way", "add it", of_key=True
            )
        return
    if room.form == "source" and study.time is not None:
        check.wrong(
            ("rooms", name, "form"), "the source's form with two-way coupling in time", "causal", "leave out 'form'"
        )
    others = [other for other, spec in study.rooms.items() if spec.coupling == "two-way" and spec.under == room.under]
    if others[0] != name:
        got = f"'{room.under}', which '{others[0]}' with two-way coupling is under already"
        check.wrong(("rooms", name, "under"), got, "another surface", "one of the two can be one-way")


def _check_mesh(check: Checker, name: str, room: RoomSpec) -> None:
    """A meshed room is causal."""
    if room.form == "source" and (room.mesh is not None or room.modes is not None):
        check.wrong(("rooms", name, "form"), "the source's form in a meshed room", "causal", "leave out 'form'")


def _check_levels(check: Checker, study: StudySpec, name: str, room: RoomSpec) -> None:
    """Levels need standards that go together and rate what strikes, somebody who listens, a reverberation time to take
    out, and a sampling that has their bands."""
    steps: Steps = ("rooms", name, "levels")
    if not room.levels:
        return
    if not room.receivers:
        check.wrong(steps, "levels without receivers", "at least one receiver", "add 'receivers: {mic: [x, y, z]}'")
    tapping = any(body.source == TAPPING_MACHINE for body in study.bodies.values())
    try:
        method = method_of(room.levels, "tapping" if tapping else "heavy")
        for body in study.bodies.values():
            refuse_source(room.levels, body.source or "")
    except AcousticsError as error:
        check.wrong(steps, error.got, error.expected, error.do)
        return
    if method.correct is not None and room.losses is None:
        check.wrong(
            steps,
            f"{method.measured_by} in a room without losses",
            "its reverberation time",
            "add 'losses: {t60: 0.5 s}'",
        )
    if study.time is None:
        return
    least, highest = method.least_sampling_hz, method.bands_hz[-1]
    if study.time.sampling < least:
        got = f"a sampling of {study.time.sampling:g} Hz"
        check.wrong(steps, got, f"{least:g} Hz or more for the bands up to {highest:g} Hz", "sample faster")
    turn = HAMMERS * BETWEEN_BLOWS
    if tapping and study.time.duration < turn:
        got = f"a tapping machine for {study.time.duration:g} s"
        check.wrong(("time", "duration"), got, f"{turn:g} s or more: one turn of its five hammers", "simulate longer")
