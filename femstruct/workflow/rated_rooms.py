"""Rooms rated by standards, and reasons not to take their numbers for measured ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite, log, log10, pi, sqrt
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acoustics.errors import Advice
from acoustics.levels.rated import Ensemble, RatedRoom, rate_room
from acoustics.levels.sound_levels import Levels, equivalent_levels
from acoustics.levels.standards import Blows, Method, method_of, rating_of, sources_of
from acoustics.levels.statistical import StatisticalBands
from acoustics.losses import DECAY_OF_T60, single_modes_hz
from acoustics.room_response import RoomResponse
from acoustics.rooms.room_advice import t60_missed
from femstruct.arrays import Floats
from femstruct.errors import Finding, list_some
from femstruct.impact.scene import BETWEEN_BLOWS, HAMMERS, TAPPING_MACHINE
from femstruct.modal.basis import ModalBasis
from femstruct.model.structure import Structure
from femstruct.parts.foundation import Foundation
from femstruct.parts.plate import Plate
from femstruct.sound.placed import Placed
from femstruct.study.asked import RoomPlan
from femstruct.study.structures import StructureModel
from femstruct.study.study import Study

TURN_S: Final = HAMMERS * BETWEEN_BLOWS  # all hammers of a tapping machine once
FALLEN_DB: Final = 40.0  # between blows that are to be heard alone
NO_STATISTICS: Final[Mapping[str, StatisticalBands]] = MappingProxyType({})
NO_ENSEMBLES: Final[Mapping[str, Ensemble]] = MappingProxyType({})
BUILT_UP_DB: Final = 0.2  # what may be missing of a tapping machine's level when averaging begins


def blows_of(study: Study) -> Blows:
    """Which blows a study's rooms are rated for."""
    return "tapping" if any(body.source == TAPPING_MACHINE for body in study.bodies) else "heavy"


def method_for(plan: RoomPlan, study: Study) -> Method | None:
    """How a room's standards rate a study's blows; None for a room that is not to be rated."""
    return method_of(plan.levels, blows_of(study)) if plan.levels and plan.receivers else None


def band_levels(
    study: Study, method: Method, whole: RoomResponse, end_hz: float, levels: Sequence[Levels]
) -> list[Mapping[float, float]]:
    """What the standards rate at every receiver of a room {nominal band [Hz]: [dB]}: the largest Fast levels, of a
    tapping machine those of the mean square while it runs.

    Parameters
    ----------
    whole : RoomResponse
        The sound, before it ends at `end_hz`, above which bands are nan.
    levels : Sequence[Levels]
        Of the one that ends there.
    """
    if method.blows == "heavy":
        return [one.octaves_db if method.fraction == 1 else one.bands_db for one in levels]
    since, until = averaging_window(study)
    samples = round(until / whole.dt)
    more = (
        10 * log10((until - since) / TURN_S) if blow_interval(study) else 0.0
    )  # ten blows a second instead of five in all
    found = [equivalent_levels(p[:samples], whole.dt, since, method.fraction, end_hz) for p in whole.p]
    return [{band: level + more for band, level in one.items()} for one in found]


def blow_interval(study: Study) -> float:
    """Time between the blows of a tapping machine whose blows are uncorrelated [s]; 0 for any other."""
    alone = [body.blows for body in study.bodies if body.source == TAPPING_MACHINE and body.blows and body.blows.alone]
    return study.time.duration / HAMMERS if alone and study.time is not None else 0.0


def averaging_window(study: Study) -> tuple[float, float]:
    """From when to when the sound of a tapping machine is averaged [s]: whole turns of its hammers, the later half; of
    blows that are apart all of it.

    Notes
    -----
    Blows of a real machine come a few milliseconds early or late, so that above about 100 Hz their sounds are
    uncorrelated and add in energy: p^2 = f_r mean_k int p_k^2 dt, p_k the sound of hammer k alone, f_r = 10/s. Those of
    blows exactly 0.1 s apart have lines at multiples of 10 Hz, which meet single modes or miss them.
    """
    assert study.time is not None
    if blow_interval(study):
        return 0.0, study.time.duration
    count = max(body.blows.count if body.blows else 1 for body in study.bodies if body.source == TAPPING_MACHINE)
    turns = min(count, int(study.time.duration / TURN_S + 1e-9))
    return (turns - max(1, turns // 2)) * TURN_S, turns * TURN_S


def rate_rooms(
    study: Study,
    drops: Sequence[Mapping[str, Sequence[Mapping[float, float]]]],
    statistical: Mapping[str, StatisticalBands] = NO_STATISTICS,
    ensembles: Mapping[str, Ensemble] = NO_ENSEMBLES,
) -> dict[str, RatedRoom]:
    """Every room that is to be rated, by name, from the levels of its receivers {room: [receivers]} at every drop.

    Of blows that the standards do not rate there are bands, and no single numbers.

    Parameters
    ----------
    statistical : Mapping[str, StatisticalBands]
        Levels by room that stand where modes have none.
    ensembles : Mapping[str, Ensemble]
        Of low bands, by room.
    """
    found = {}
    for plan in study.rooms:
        method = method_for(plan, study)
        if method is not None:
            beside = statistical.get(plan.name), ensembles.get(plan.name)
            rated = rate_room([drop[plan.name] for drop in drops], plan.room, plan.levels, method.blows, *beside)
            other = bool(_other_blows(method, study))
            found[plan.name] = replace(rated, method=replace(rated.method, numbers=())) if other else rated
    return found


def missed_times(plan: RoomPlan) -> tuple[Advice, ...]:
    """Reverberation times that the losses of a room do not have, whatever is computed in it."""
    return t60_missed({f: plan.room.t60(f) for f in plan.t60_asked}, plan.t60_asked)


def rated_findings(plan: RoomPlan, study: Study, drops: int = 1) -> tuple[Finding, ...]:
    """Few places, and blows that the standards do not rate: what takes no modes.

    Parameters
    ----------
    drops : int
        At how many places the source strikes.
    """
    method = method_for(plan, study)
    if method is None:
        return ()
    found: list[Finding] = []
    if min(drops, len(plan.receivers)) < method.fewest:
        found.append(
            Finding(
                "rating-of-few-places",
                f"{method.measured_by} requires {method.fewest} or more positions of the source and of microphones; "
                "here "
                f"are {drops} and {len(plan.receivers)}",
                {"drops": drops, "receivers": len(plan.receivers), "wanted": method.fewest},
            )
        )
    return (
        *found,
        *_other_blows(method, study),
        *(_building_up(plan, method, study) if method.blows == "tapping" and not blow_interval(study) else ()),
    )


def overlap_findings(plan: RoomPlan, study: Study, basis: ModalBasis) -> tuple[Finding, ...]:
    """Blows of a tapping machine, rated one by one, of which the floor or the room remembers the one before.

    Parameters
    ----------
    basis : ModalBasis
        Damped.
    """
    method = method_for(plan, study)
    return _overlapping(plan, method, study, basis) if method is not None and blow_interval(study) else ()


def _other_blows(method: Method, study: Study) -> tuple[Finding, ...]:
    """A rating of something else than the one source that the standards rate."""
    tapping = method.blows == "tapping"
    standard_source, count = method.source, HAMMERS if tapping else 1
    impacting = [body for body in study.bodies if body.speed and body.side == "above"]
    others = [body.source or body.name for body in impacting if body.source != standard_source]
    here = len(impacting) - len(others)
    pushed = [load.name for load in study.loads] + [walker.name for walker in study.walks]
    if not others and here == count and not pushed:
        return ()
    listed = list_some(dict.fromkeys([*others, *pushed]))
    one = f"one {standard_source} with five hammers" if tapping else f"one {standard_source}"
    if not tapping and TAPPING_MACHINE in sources_of(method.standards):
        one += f" or a {TAPPING_MACHINE}"
    what = "hammers" if tapping else f"{standard_source}s"
    here_are = (
        f"{here} {what}{' and ' + listed if listed else ''} strike" if here else f"the source is {listed or 'missing'}"
    )
    elsewhere = rating_of(others[0]) if len(others) == 1 and not here else ()
    here_are += f", for {' or '.join(elsewhere)}" if elsewhere and not set(elsewhere) & set(method.standards) else ""
    return (
        Finding(
            "rating-of-other-blows",
            f"levels by {' and '.join(method.standards)} require {one}; here {here_are}"
            f"{': single numbers are withheld' if method.numbers else ''}",
            {what.replace(" ", "_"): here, "others": len(others) + len(pushed)},
        ),
    )


def _overlapping(plan: RoomPlan, method: Method, study: Study, basis: ModalBasis) -> tuple[Finding, ...]:
    """Uncorrelated blows that come before the sound of the last one has died away, so that they are not heard alone."""
    lowest = method.bands_hz[0] * 10**-0.05
    t60 = max(plan.room.t60(band, method.fraction) for band in method.bands_hz)
    rated = (basis.frequency_hz >= lowest) & (np.array(basis.kind) == "elastic")
    decay = np.diag(basis.time_damping)[rated].min(initial=inf)  # of a mode's energy [1/s]
    floor_t60 = 6 * log(10) / decay if decay > 0 else inf
    fallen, least = 60 * blow_interval(study) / max(t60, floor_t60), HAMMERS * max(t60, floor_t60) * FALLEN_DB / 60
    if fallen >= FALLEN_DB:
        return ()
    decaying = "room" if t60 >= floor_t60 else "floor"
    enough = f"'time: {{duration: {least:.2g} s}}'" if isfinite(least) else "a 'damping', without which it never decays"
    return (
        Finding(
            "blows-overlap",
            f"uncorrelated blows are {blow_interval(study):.3g} s apart; the sound of the {decaying}, with a "
            f"reverberation time of {max(t60, floor_t60):.2g} s, decays by {fallen:.0f} dB between them; "
            f"{FALLEN_DB:g} dB are needed for an error below 0.1 dB. Give the study {enough}",
            {
                "apart_s": blow_interval(study),
                "fallen_db": fallen,
                "wanted_db": FALLEN_DB,
                "t60_s": max(t60, floor_t60),
            },
        ),
    )


def _building_up(plan: RoomPlan, method: Method, study: Study) -> tuple[Finding, ...]:
    """A tapping machine that has not run long enough for the room to fill with sound before levels are averaged."""
    since, until = averaging_window(study)
    t60 = max(plan.room.t60(band, method.fraction) for band in method.bands_hz)
    missing = -10 * log10(1 - 10 ** (-6 * since / t60)) if since else float("inf")
    if missing <= BUILT_UP_DB:
        return ()
    short = f"is then {missing:.2g} dB below its steady level" if since else "is then silent"
    return (
        Finding(
            "tapping-not-steady",
            f"levels are averaged from {since:g} to {until:g} s; a room with a reverberation time of {t60:.2g} s "
            f"{short}. Give the machine more blows, and a longer time",
            {"since_s": since, "until_s": until, "t60_s": t60},
        ),
    )


# ----------------------------------------------------------------------------------------------------------------------
# What makes a level sensitive to a few hertz: floating floors, floor modes close to modes of the room, what one-way
# coupling leaves out there; and rooms that a standard is not for.
# ----------------------------------------------------------------------------------------------------------------------

MOST_PAIRS_NAMED: Final = 5  # pairs that are named
MIN_SHAPE_CORRELATION: Final = 0.3  # of two shapes on the ceiling from which on one drives the other
MOVES: Final = 0.1  # rms motion of the ceiling, of the floor mode that moves it most, from which on a mode counts
EXCHANGED: Final = 0.12  # kappa: 0.5 dB in a band, 1 dB at a line
BESIDE: Final = 1.5  # of the last mode of the floor: modes of the room above it exchange nothing with any
DECAY_HZ: Final = 100.0  # where a room's reverberation time is taken to tell up to where its modes stand alone


@dataclass(frozen=True, eq=False)
class ModePairs:
    """Modes of a floor beside those of the room below it: frequencies [m] and [n] [Hz]; for every pair [m, n] whether
    they are within each other's bandwidth, the likeness of their shapes on the ceiling [1], and what they exchange,
    kappa [1]; and how far each mode of the floor moves the ceiling [m], of the one that moves it most [1]."""

    floor_hz: Floats
    room_hz: Floats
    near: NDArray[np.bool_]
    likeness: Floats
    kappa: Floats
    motion: Floats


def coincidence_findings(plan: RoomPlan, study: Study, placed: Placed, basis: ModalBasis) -> tuple[Finding, ...]:
    """Findings on a rated room: its volume, floating floors in its bands, and floor modes that meet its own modes; and
    on any room what one-way coupling leaves out where they do.

    Parameters
    ----------
    placed : Placed
        The room.
    basis : ModalBasis
        Of the structure without the air, damped.
    """
    pairs = mode_pairs(placed, basis)
    left_out = exchange_findings(plan, pairs) if plan.receivers else ()
    method = method_for(plan, study)
    if method is None:
        return left_out
    found = [*_volume(plan, method), *floating_floors(study.structure, method.bands_hz)]
    meet = modal_coincidences(pairs)
    if meet:
        listed = ", ".join(
            f"{floor:.1f} Hz of the floor and {room:.1f} Hz of the room" for floor, room, _ in meet[:MOST_PAIRS_NAMED]
        )
        more = f", and {len(meet) - MOST_PAIRS_NAMED} more" if len(meet) > MOST_PAIRS_NAMED else ""
        found.append(
            Finding(
                "floor-room-resonance",
                f"natural frequencies of floor and room lie within each other's bandwidths, with similar shapes on the "
                f"ceiling: {listed}{more}. A few hertz in either frequency change the levels of their third "
                f"octaves{_exchanged(pairs) if plan.coupling == 'one-way' else ''}",
                {
                    "pairs": len(meet),
                    "floor_hz": meet[0][0],
                    "room_hz": meet[0][1],
                    "likeness": meet[0][2],
                    "kappa": float(pairs.kappa.max()),
                },
            )
        )
    return (*found, *left_out)


def mode_pairs(placed: Placed, basis: ModalBasis) -> ModePairs:
    """All modes of a floor, as far as none is missing, and of the room below it, up to where modes of the room overlap.

    That is `single_modes_hz`. No pairs in the open, in a room without losses, and in one that is not known by modes.

    Notes
    -----
    Likeness is the cosine of the angle between the two shapes on the ceiling. With a structure's mode phi of unit modal
    mass and a room's psi, damped with the rates d_p and d_r of their energies, and frequencies apart by w,

        kappa = g^2 / (d_p d_r) / (1 + (2 w / (d_p + d_r))^2),  g = c sqrt(rho) int_S phi psi dS / sqrt(int_V psi^2 dV),

    of two oscillators that gyroscopic forces g couple. In resonance the room's answer to a given force on the structure
    is 1 + kappa times smaller with the air pushing back, its energy under forces of all frequencies as much.
    """
    room = placed.room
    t60 = room.t60(DECAY_HZ)
    if not isfinite(t60):
        return _no_pairs()
    top = single_modes_hz(t60, room.volume)
    known = min(top, basis.complete_below_hz) if basis.complete_below_hz > 0 else top  # air adds modes beyond
    rings = np.nan_to_num(basis.damping_ratio) < 1.0  # over wool the diagonal of the damping is that of no motion
    elastic = np.flatnonzero((np.array(basis.kind) == "elastic") & (basis.frequency_hz <= known) & rings)
    if not len(elastic):
        return _no_pairs()
    top = min(top, BESIDE * float(basis.frequency_hz[elastic].max()))
    surfaces = [replace(one, shapes=one.shapes[:, elastic]) for one in placed.shapes(basis)]
    room_hz, products, others, squares = room.modes_on(surfaces, top)
    if not len(room_hz):
        return _no_pairs()
    sizes = np.sqrt(sum(one.weights @ one.shapes**2 for one in surfaces))
    products = np.abs(products)
    both = np.outer(sizes, others)
    floor_hz = basis.frequency_hz[elastic]
    floor_width = 2 * np.nan_to_num(basis.damping_ratio[elastic]) * floor_hz
    room_width = DECAY_OF_T60 / pi / np.array([room.t60(f) for f in room_hz.tolist()])
    apart = np.abs(floor_hz[:, None] - room_hz)
    widths = floor_width[:, None] + room_width
    exchange = room.air.c * np.sqrt(room.air.rho / squares) * products / (2 * pi)  # g / 2 pi
    losses = np.outer(floor_width, room_width) * (1 + (2 * apart / widths) ** 2)
    return ModePairs(
        floor_hz,
        room_hz,
        near=apart <= 0.5 * widths,
        likeness=np.divide(products, both, out=np.zeros_like(products), where=both > 0),
        kappa=np.divide(exchange**2, losses, out=np.full_like(losses, inf), where=losses > 0),
        motion=sizes / sizes.max() if sizes.max() > 0 else sizes,
    )


def _no_pairs() -> ModePairs:
    none = np.zeros((0, 0))
    return ModePairs(np.zeros(0), np.zeros(0), none.astype(bool), none, none, np.zeros(0))


def modal_coincidences(pairs: ModePairs) -> list[tuple[float, float, float]]:
    """Modes of the floor that move the ceiling and modes of the room that meet: (floor [Hz], room [Hz], likeness of
    shapes [1]), by frequency."""
    meets = pairs.near & (pairs.likeness >= MIN_SHAPE_CORRELATION) & (pairs.motion >= MOVES)[:, None]
    at = np.argwhere(meets)
    return sorted((float(pairs.floor_hz[i]), float(pairs.room_hz[j]), float(pairs.likeness[i, j])) for i, j in at)


def exchange_findings(plan: RoomPlan, pairs: ModePairs) -> tuple[Finding, ...]:
    """A finding where one-way coupling leaves out that a room takes energy back from the floor mode that drives it."""
    if plan.coupling != "one-way" or not pairs.kappa.size or pairs.kappa.max() < EXCHANGED:
        return ()
    i, j = np.unravel_index(int(pairs.kappa.argmax()), pairs.kappa.shape)
    kappa = float(pairs.kappa[i, j])
    line, band = 20 * log10(1 + kappa), 10 * log10(1 + kappa)
    return (
        Finding(
            "one-way-resonance",
            f"the floor mode at {pairs.floor_hz[i]:.1f} Hz and the room mode at {pairs.room_hz[j]:.1f} Hz exchange "
            "energy. One-way coupling leaves out that the air acts back on the floor: the coupling factor is "
            f"{kappa:.2f}, and {EXCHANGED:g} is allowed. Levels are up to {line:.1f} dB too high at that frequency, "
            f"and {band:.1f} dB in its third octave where blows have no fixed interval. Give the room "
            "'coupling: two-way'",
            {
                "kappa": kappa,
                "allowed": EXCHANGED,
                "floor_hz": float(pairs.floor_hz[i]),
                "room_hz": float(pairs.room_hz[j]),
                "line_db": line,
                "band_db": band,
            },
        ),
    )


def _exchanged(pairs: ModePairs) -> str:
    """What one-way coupling makes of the pair that exchanges most."""
    band = 10 * log10(1 + float(pairs.kappa.max()))
    return f", and one-way coupling makes them up to {band:.1f} dB too high"


def floating_floors(structure: StructureModel, bands_hz: tuple[float, ...]) -> list[Finding]:
    """Plates that float on others with a resonance up to the last of the bands: two masses per area on a spring per
    area, f0 = sqrt(s (1 / m1 + 1 / m2)) / 2 pi.

    Under a force on the upper mass m2 the lower one, m1, moves m1 / (m1 + m2) / |1 - (f / f0)^2| times as much as
    alone: less from (f / f0)^2 = 2 - m2 / (m1 + m2) on.
    """
    if not isinstance(structure, Structure):
        return []
    plates = {part.name: part for part in structure.parts if isinstance(part, Plate)}
    found = []
    for part in structure.parts:
        if not (
            isinstance(part, Foundation) and part.on in plates and part.to in plates and part.region.kind == "whole"
        ):
            continue
        upper, lower = (plates[str(name)].section.m0 for name in (part.on, part.to))
        resonance = sqrt(part.normal * (1 / upper + 1 / lower)) / (2 * pi)
        lowers = resonance * sqrt(2 - upper / (upper + lower))
        if resonance <= bands_hz[-1]:
            found.append(
                Finding(
                    "floating-floor",
                    f"{part.name}: the mass-spring-mass resonance of {part.on} and {part.to} is {resonance:.1f} Hz. "
                    f"Beside the bare {part.to} the layer raises levels near it and lowers them above {lowers:.0f} Hz "
                    f"(as two rigid masses). Both frequencies follow from the stiffness of the layer under its load, "
                    f"here {part.normal:.3g} N/m^3",
                    {
                        "resonance_hz": resonance,
                        "lowers_from_hz": lowers,
                        "stiffness_n_m3": part.normal,
                        "upper_kg_m2": upper,
                        "lower_kg_m2": lower,
                    },
                )
            )
    return found


def _volume(plan: RoomPlan, method: Method) -> list[Finding]:
    low, high = method.volume_m3 or (0.0, inf)
    if low <= plan.room.volume <= high:
        return []
    return [
        Finding(
            "rating-room-volume",
            f"{method.measured_by} is for rooms of {low:g} to {high:g} m^3; this one has {plan.room.volume:.4g} m^3",
            {"volume_m3": plan.room.volume, "least_m3": low, "most_m3": high},
        )
    ]
