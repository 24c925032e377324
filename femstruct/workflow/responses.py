"""Frequency responses and answers to steady excitations, as studies and the command line ask for them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from acoustics.errors import Advice
from acoustics.receivers import Receiver
from femstruct.arrays import Floats
from femstruct.errors import Finding, InputError, list_some
from femstruct.impact.fatigue import POWERS, Fatigue, expected, expected_on_planes, most_damaged_by_spectra
from femstruct.modal.basis import ForceRow, ModalBasis
from femstruct.modal.damping import UNDAMPED
from femstruct.modal.frf import Complex, frf, frf_unit, moves_probe
from femstruct.modal.residuals import AXES
from femstruct.modal.steady import (
    Excitation,
    HarmonicAnswer,
    Highest,
    Looked,
    MovedMass,
    RandomAnswer,
    Vibrated,
    base_excitation,
    force,
    force_excitation,
    harmonic_stress,
    largest_peak,
    missed_peak,
    motion,
    random_answer,
    random_stress,
    resonances,
    resonant_lines,
    stress_components,
    stress_moments,
    transfers,
)
from femstruct.model.probe import Probe, StressPlaces
from femstruct.sound.radiated_power import power_per_force
from femstruct.sound.surfaces import pressure_per_force, velocity_per_source
from femstruct.study.asked import VOLUME_VELOCITY, FrfRequest, RoomPlan, Spot, Vibration
from femstruct.study.placed_rooms import placed_room
from femstruct.study.recorded import LargestStress
from femstruct.study.results import Frf
from femstruct.study.study import Study
from femstruct.workflow.bases import Places
from femstruct.workflow.provenance import Progress, progress_counter
from femstruct.workflow.recorded_channels import (
    MOTIONS,
    SIDEWAYS,
    STRESS,
    UNITS,
    judged,
    refuse_absent_forces,
    stress_findings,
    uneven,
)

# ----------------------------------------------------------------------------------------------------------------------
# Frequency responses as studies and the command line ask for them.
# ----------------------------------------------------------------------------------------------------------------------


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

    Parameters
    ----------
    known : Highest | None
        The largest value in that band, where it was computed before.
    """
    frequency = lines_of(request)
    if request.drive.what == VOLUME_VELOCITY:
        return _from_source(request, places, basis, rooms, frequency)
    drive = places.point(request.drive.name, _name_of_end(request, "drive")).probe(request.drive.what)
    if request.kind == "pressure":
        return _pressure(request, drive, places, basis, rooms, frequency)
    if request.kind == "power":
        return _power(request, drive, places, basis, rooms, frequency)
    response = response_row(request.response, places, basis, _name_of_end(request, "response"))
    for end, spot, probe in (("drive", request.drive, drive), ("response", request.response, response)):
        if isinstance(probe, Probe) and not moves_probe(basis, probe):
            raise InputError(
                _name_of_end(request, end),
                got=f"'{spot}', no mode moves along {spot.what}",
                expected="a direction in which the structure can move",
            )
    kind = request.kind

    def respond(hz: Floats) -> Complex:
        lines = progress_counter(len(hz), f"lines, {len(basis.omega)} modes", progress)
        return frf(basis, drive, response, hz, kind, lines)

    values, unit = respond(frequency), frf_unit(request.kind, request.drive.what, request.response.what)
    sizes = np.abs(values)
    found = largest_peak(respond, basis, frequency, sizes) if known is None else known.on(frequency, sizes)
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
    plan, receiver = _receiver(request.response, rooms, _name_of_end(request, "response"))
    room = placed_room(plan, places.surfaces)
    values, advice = pressure_per_force(basis, drive, room, [receiver], frequency)
    unit = "Pa/(N m)" if request.drive.what.startswith("r") else "Pa/N"
    return Frf(request, frequency, values[0], unit), advice


def _from_source(
    request: FrfRequest, places: Places, basis: ModalBasis, rooms: Sequence[RoomPlan], frequency: Floats
) -> tuple[Frf, tuple[Advice, ...]]:
    """Velocity per volume velocity of a point source at the place of a receiver."""
    plan, source = _receiver(request.drive, rooms, _name_of_end(request, "drive"))
    where = _name_of_end(request, "response")
    response = places.point(request.response.name, where).probe(request.response.what)
    if not moves_probe(basis, response):
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
        raise InputError(_name_of_end(request, "response"), got=f"'{request.response}'", expected=expected)
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
            expected=f"a force of {list_some(forces) or 'nothing'}",
        )
    return basis.outputs[key]


def force_axis(spot: Spot) -> str:
    """The axis of a force: z where none is said."""
    return spot.what.removeprefix("force").lstrip("_") or "z"


def _name_of_end(request: FrfRequest, end: str) -> str:
    """Who asks for an end of a response: a named request of a study, or an option of the command line."""
    return f"frf.{request.name}.{end}" if request.name else f"--{end}"


# ----------------------------------------------------------------------------------------------------------------------
# Harmonic and random excitations as studies ask for them: what is recorded, answering each of them by itself.
# ----------------------------------------------------------------------------------------------------------------------

ON_THE_BASE: Final = " relative to the base"
"""Ends the names of answers that leave out the motion of the base."""
DIRLIK_LOW: Final = 0.2  # of the damage of counted cycles, slope 5
_TURNING: Final = {"m": "rad", "m/s": "rad/s", "m/s^2": "rad/s^2"}
_SAME: Final = 1e-3  # of a frequency: that to which modes are counted is just below the one asked for
_MOVES: Final = 1e-9  # the share of the motion of a base that is rounding of direction cosines


def vibrations(study: Study, places: Places, basis: ModalBasis) -> tuple[dict[str, Vibrated], list[Finding]]:
    """What came of the excitations of a study, by name, and what is to be known of it.

    Parameters
    ----------
    basis : ModalBasis
        With its damping.

    Raises
    ------
    InputError
        As `excited` does, and for a recorded force that nothing has.
    """
    found: dict[str, Vibrated] = {}
    findings: list[Finding] = []
    refuse_absent_forces(study, basis)
    for one in study.vibration:
        found[one.name], doubts = _vibrated(one, study, places, basis)
        findings += doubts
    findings += [_by_dirlik(one.name) for one in study.fatigue if one.under and one.sn is not None]
    return found, findings


def _by_dirlik(name: str) -> Finding:
    return Finding(
        "random-damage-estimated",
        f"{name}: its damage has Dirlik's density of ranges, which is up to {100 * DIRLIK_LOW:.0f} % low where a "
        "spectrum has peaks far apart. To count it, simulate a history with this spectrum as a load",
        {"low": DIRLIK_LOW},
    )


def excited(one: Vibration, places: Places, basis: ModalBasis) -> Excitation:
    """What excites the modes.

    Raises InputError for a place that is not there or cannot move, for a base that does not hold the structure, and for
    modes in the band that have no damping.
    """
    refuse_undamped(f"vibration.{one.name}", one.spectrum.band, basis)
    probe = places.pushed(one)
    if isinstance(one.on, Spot) and probe is not None and not moves_probe(basis, probe):
        expected = "a direction in which the structure can move"
        raise InputError(f"vibration.{one.name}.at", got=f"'{one.on}', which no mode moves", expected=expected)
    return (
        base_excitation(basis, str(one.on), f"vibration.{one.name}")
        if probe is None
        else force_excitation(basis, probe)
    )


def _vibrated(one: Vibration, study: Study, places: Places, basis: ModalBasis) -> tuple[Vibrated, list[Finding]]:
    excitation = excited(one, places, basis)
    lines = resonant_lines(basis, one.spectrum.band, tuple(f for f, _ in one.spectrum.points))
    level = one.spectrum.at(lines)
    looked = dict(_looked(study, places, basis, excitation))
    values = transfers(basis, excitation, [seen for seen, _ in looked.values()], lines)
    answers: dict[str, HarmonicAnswer | RandomAnswer] = {}
    forces: dict[str, float] = {}
    for (name, (_, unit)), transfer in zip(looked.items(), values, strict=True):
        answers[name] = _answer(one, unit, transfer, level, lines)
        if unit == "N":
            forces[name] = float(np.abs(transfer).max())
    largest = max(forces.values(), default=0.0)
    for name, size in forces.items():  # sideways there is only what is more than rounding of the shapes
        if name.endswith((" x", " y")) and size <= SIDEWAYS * largest:
            del answers[name]
    findings: list[Finding] = []
    for record in study.records:
        if record.what == STRESS:
            answers[str(record)], stressed = _stress(one, places, record.target, excitation, basis, level, lines)
            findings += stress_findings({f"{one.name}: {record}{' rms' if one.what == 'psd' else ''}": stressed})
    base = None if excitation.axis is None else _moved(basis, excitation.axis)
    return Vibrated(one.what, one.place_text, one.unit, lines, level, answers, base), findings


def _answer(
    one: Vibration, unit: str, transfer: Complex, level: Floats, lines: Floats
) -> HarmonicAnswer | RandomAnswer:
    if one.what == "harmonic":
        return HarmonicAnswer(unit, lines, transfer * level)
    return random_answer(unit, transfer, level, lines, one.duration)


def _looked(
    study: Study, places: Places, basis: ModalBasis, excitation: Excitation
) -> Iterator[tuple[str, tuple[Looked, str]]]:
    """What is recorded of points and forces of the structure, by channel, with its unit."""
    bodies = {body.name for body in study.bodies}
    for record in study.records:
        name, _, direction = record.target.rpartition(".")
        if record.what in MOTIONS and name and record.target not in bodies:
            probe = places.point(name, f"record.{record.target}").probe(direction)
            unit = UNITS[record.what]
            unit = _TURNING[unit] if direction.startswith("r") else unit
            seen = motion(excitation, basis, probe, MOTIONS.index(record.what))
            yield str(record), (seen, unit)
            if abs(seen.rigid) > _MOVES and moves_probe(basis, probe):
                beside = motion(excitation, basis, probe, MOTIONS.index(record.what), relative=True)
                yield f"{record}{ON_THE_BASE}", (beside, unit)
        elif record.what == "force":
            for axis in AXES:
                if (key := f"{record.target}.{axis}") in basis.outputs:
                    along = str(record) if axis == "z" else f"{record} {axis}"
                    yield along, (force(excitation, basis, basis.outputs[key]), "N")


def _stress(
    one: Vibration,
    places: Places,
    part: str,
    excitation: Excitation,
    basis: ModalBasis,
    level: Floats,
    lines: Floats,
) -> tuple[HarmonicAnswer | RandomAnswer, LargestStress]:
    """The equivalent stress of a part, and how well its mesh resolves it."""
    rows = places.stresses(part, f"record.{part}")
    found = (harmonic_stress if one.what == "harmonic" else random_stress)(basis, excitation, rows, level, lines)
    stressed = judged(rows, basis.shapes, found.largest, found.amount)
    if one.what == "harmonic":
        return HarmonicAnswer("Pa", lines, found.along.astype(np.complex128), stressed.where), stressed
    rms = float(found.largest.max())
    place, share = stressed.worst, uneven(stressed)
    return RandomAnswer("Pa", lines, found.along, rms, where=stressed.where, place=place, uneven=share), stressed


def random_fatigues(
    study: Study, found: Mapping[str, Vibrated], places: Places, basis: ModalBasis
) -> dict[str, Fatigue]:
    """Cycles that random excitations make on the average in their durations, by the names a study has for them.

    Raises InputError for an excitation that is not random or has no duration, and for what does not answer it.
    """
    fatigues: dict[str, Fatigue] = {}
    excitations = {one.name: one for one in study.vibration}
    for request in (one for one in study.fatigue if one.under):
        where, of, sn = f"fatigue.{request.name}", request.of, request.sn
        one = excitations.get(request.under)
        if one is None or one.what != "psd" or one.duration is None:
            got, needed = f"'{request.under}'", "the name of a random excitation with a duration"
            raise InputError(f"{where}.under", got=got, expected=needed)
        answer, level = found[one.name].answers.get(of), found[one.name].excitation
        if not isinstance(answer, RandomAnswer):
            raise InputError(f"{where}.of", got=f"'{of}'", expected=f"one of {list_some(found[one.name].answers)}")
        lines = answer.frequency_hz
        if of.endswith(f" {STRESS}"):
            everywhere = places.stresses(of.removesuffix(f" {STRESS}"), f"{where}.of")
            shaken = excited(one, places, basis)
            moments = stress_moments(basis, shaken, everywhere, level, lines, POWERS)
            place = most_damaged_by_spectra(moments, everywhere.components, one.duration, sn)
            name, share = answer.where, answer.uneven
            if place != answer.place:
                found_there = _judged_at(place, everywhere, basis, shaken, level, lines)
                name, share = found_there.where, uneven(found_there)
            rows = everywhere.at(place)
            stresses = stress_components(basis, shaken, rows, 0, lines)
            axes = None if rows.axes is None else rows.axes[0]
            fatigue = expected_on_planes(
                of,
                stresses,
                components=rows.components,
                psd=level,
                frequency_hz=lines,
                duration=one.duration,
                line=sn,
                place=name,
                uneven=share,
                axes=axes,
            )
            fatigues[request.name] = replace(fatigue, converged=not share)
        else:
            fatigues[request.name] = expected(of, answer.unit, answer.psd, lines, one.duration, sn)
    return fatigues


def _judged_at(
    place: int, places: StressPlaces, basis: ModalBasis, excitation: Excitation, level: Floats, lines: Floats
) -> LargestStress:
    """The rms of the equivalent stress at one place, which counts for the most stressed one, and how well the mesh
    resolves it there."""
    found = random_stress(basis, excitation, places, level, lines)
    own = np.where(np.arange(len(found.largest)) == place, found.largest, 0.0)
    return judged(places, basis.shapes, own, found.amount)


def _moved(basis: ModalBasis, axis: int) -> MovedMass:
    true = basis.modes
    return MovedMass(AXES[axis], basis.frequency_hz[true], basis.modal_mass[axis, true], basis.total_mass)


def refuse_undamped(where: str, band: tuple[float, float], basis: ModalBasis) -> None:
    """Raise InputError where modes in the band of an excitation have no damping: they answer without limit."""
    low, high = band
    hz, half = resonances(basis)
    bare = np.sort(hz[(half == 0.0) & (hz >= low) & (hz <= high)])
    if len(bare):
        raise InputError(
            where,
            got=f"{len(bare)} of the modes from {low:g} to {high:g} Hz without damping, the first at {bare[0]:.4g} Hz",
            expected="damping: without it they answer without limit",
            do="give the model a 'damping', or end the band below them",
        )


def beyond_modes(one: Vibration, basis: ModalBasis) -> Iterator[Finding]:
    """A band of an excitation that goes on above the last mode."""
    top = basis.complete_below_hz or float(basis.frequency_hz[basis.modes].max(initial=0.0))
    high = one.spectrum.band[1]
    if high > top * (1.0 + _SAME):
        yield Finding(
            "vibration-beyond-modes",
            f"{one.name}: its band goes up to {high:.4g} Hz, the modes to {top:.4g} Hz. Resonances above are "
            f"left out, which accelerations feel first. Ask for modes up to {high:.4g} Hz or more, or end the band at "
            f"{top:.4g} Hz",
            {"band_hz": high, "complete_below_hz": top},
        )
