"""Harmonic and random excitations as studies ask for them: what is recorded, answering each of them by itself."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import Finding, InputError, some_of
from femstruct.impact.result.fatigue import Fatigue
from femstruct.impact.result.spectral_fatigue import POWERS, expected, expected_on_planes, most_damaged
from femstruct.modal.basis import ModalBasis
from femstruct.modal.frf import moves
from femstruct.modal.outputs import AXES
from femstruct.modal.steady.answers import HarmonicAnswer, MovedMass, RandomAnswer, Vibrated, random_answer
from femstruct.modal.steady.excitation import Excitation, Looked, force, motion, moving_base, pushing, transfers
from femstruct.modal.steady.resonances import resonances
from femstruct.modal.steady.resonant_lines import resonant_lines
from femstruct.modal.steady.steady_stresses import harmonic_stress, random_stress, stress_components, stress_moments
from femstruct.modal.superposition import Complex
from femstruct.model.probe import StressPlaces
from femstruct.study.asked import Spot
from femstruct.study.recorded import LargestStress
from femstruct.study.steady_vibration import Vibration
from femstruct.study.study import Study
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.recorded.channels import MOTIONS, SIDEWAYS, STRESS, UNITS, refuse_absent_forces
from femstruct.workflow.stages.recorded.stresses import judged, stress_findings, uneven

ON_THE_BASE: Final = " relative to the base"
"""Ends the names of answers that leave out the motion of the base."""
DIRLIK_LOW: Final = 0.2  # of the damage of counted cycles, slope 5
_TURNING: Final = {"m": "rad", "m/s": "rad/s", "m/s^2": "rad/s^2"}
_SAME: Final = 1e-3  # of a frequency: that to which modes are counted is just below the one asked for
_MOVES: Final = 1e-9  # the share of the motion of a base that is rounding of direction cosines


def vibrations(study: Study, places: Places, basis: ModalBasis) -> tuple[dict[str, Vibrated], list[Finding]]:
    """What came of the excitations of a study, by name, and what is to be known of it.

    basis : with its damping.

    Raises InputError as `excited` does, and for a recorded force that nothing has.
    """
    found: dict[str, Vibrated] = {}
    told: list[Finding] = []
    refuse_absent_forces(study, basis)
    for one in study.vibration:
        found[one.name], doubts = _vibrated(one, study, places, basis)
        told += doubts
    told += [_by_dirlik(one.name) for one in study.fatigue if one.under and one.sn is not None]
    return found, told


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
    if isinstance(one.on, Spot) and probe is not None and not moves(basis, probe):
        expected = "a direction in which the structure can move"
        raise InputError(f"vibration.{one.name}.at", got=f"'{one.on}', which no mode moves", expected=expected)
    return moving_base(basis, str(one.on), f"vibration.{one.name}") if probe is None else pushing(basis, probe)


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
    told: list[Finding] = []
    for record in study.records:
        if record.what == STRESS:
            answers[str(record)], stressed = _stress(one, places, record.target, excitation, basis, level, lines)
            told += stress_findings({f"{one.name}: {record}{' rms' if one.what == 'psd' else ''}": stressed})
    base = None if excitation.axis is None else _moved(basis, excitation.axis)
    return Vibrated(one.what, one.told, one.unit, lines, level, answers, base), told


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
            if abs(seen.rigid) > _MOVES and moves(basis, probe):
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
    told: dict[str, Fatigue] = {}
    excitations = {one.name: one for one in study.vibration}
    for request in (one for one in study.fatigue if one.under):
        where, of, sn = f"fatigue.{request.name}", request.of, request.sn
        one = excitations.get(request.under)
        if one is None or one.what != "psd" or one.duration is None:
            got, wanted = f"'{request.under}'", "the name of a random excitation with a duration"
            raise InputError(f"{where}.under", got=got, expected=wanted)
        answer, level = found[one.name].answers.get(of), found[one.name].excitation
        if not isinstance(answer, RandomAnswer):
            raise InputError(f"{where}.of", got=f"'{of}'", expected=f"one of {some_of(found[one.name].answers)}")
        lines = answer.frequency_hz
        if of.endswith(f" {STRESS}"):
            everywhere = places.stresses(of.removesuffix(f" {STRESS}"), f"{where}.of")
            shaken = excited(one, places, basis)
            moments = stress_moments(basis, shaken, everywhere, level, lines, POWERS)
            place = most_damaged(moments, everywhere.components, one.duration, sn)
            name, share = answer.where, answer.uneven
            if place != answer.place:
                found_there = _judged_at(place, everywhere, basis, shaken, level, lines)
                name, share = found_there.where, uneven(found_there)
            rows = everywhere.at(place)
            stresses = stress_components(basis, shaken, rows, 0, lines)
            axes = None if rows.axes is None else rows.axes[0]
            fatigue = expected_on_planes(
                of, stresses, rows.components, level, lines, one.duration, sn, name, share, axes
            )
            told[request.name] = replace(fatigue, converged=not share)
        else:
            told[request.name] = expected(of, answer.unit, answer.psd, lines, one.duration, sn)
    return told


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
