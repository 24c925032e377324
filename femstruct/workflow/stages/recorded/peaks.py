"""Peaks that depend on the modes left out: reported with the peak of the modes alone beside them.

Residual vectors hold the static share of all modes beyond the last one at the places that are pushed. A displacement
or a velocity hardly feels them; the acceleration of the struck point may be theirs for a half, and then moves with
the number of modes and with the mesh.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from femstruct.errors import Finding
from femstruct.impact.result.fatigue import Fatigue, SNLine, counted, counted_on_planes, most_damaged
from femstruct.impact.result.response import Response
from femstruct.study.counting import FatigueRequest
from femstruct.study.recorded import Channel
from femstruct.study.study import Study
from femstruct.units import readable
from femstruct.workflow.stages.places import Places
from femstruct.workflow.stages.recorded.channels import motion_rows, moved
from femstruct.workflow.stages.recorded.stresses import stressed_at, uneven

CONVERGED = 0.05  # of a peak: what residual vectors may make of it
MISSED = 0.02  # of a peak: what samples may miss of it before cycles are counted from them
CUT_OFF = 0.01  # of a peak: what a low-pass may make of where a pressure ends
CHANGED = 5.0  # per cent: by how much a change against the baseline may depend on them


def fatigues(study: Study, channels: Mapping[str, Channel], places: Places, response: Response) -> dict[str, Fatigue]:
    """Rainflow cycles of the histories that a study asks for, by name.

    Of a stress the components at the place with the most damage are counted: the recorded history, which is the largest
    equivalent stress anywhere, has no sign, and what is largest once need not be what comes often. Histories without
    residual vectors are counted beside them.
    """
    found: dict[str, Fatigue] = {}
    basis = response.basis
    true = np.array([kind != "residual" for kind in basis.kind])
    motions = {} if true.all() else motion_rows(study, places, basis)
    for request in (one for one in study.fatigue if not one.under):
        channel = channels[request.of]
        if channel.stressed is not None:
            part = request.of.rpartition(" ")[0]
            everywhere, q = places.stresses(part, f"fatigue.{request.name}.of"), response.q
            place = most_damaged(everywhere.of(basis.shapes), q, everywhere.components, request.sn)
            stressed = stressed_at(everywhere, place, response, q)
            rows = everywhere.at(place)
            in_modes, names, where = rows.of(basis.shapes)[0], rows.components, stressed.where
            alone = None if true.all() else (in_modes * true) @ q
            open_share = uneven(stressed)
            axes = None if rows.axes is None else rows.axes[0]
            one = counted_on_planes(request.of, in_modes @ q, names, request.sn, where, alone, open_share, axes)
        else:
            what, row = motions.get(request.of, ("", None))
            alone = None if row is None else moved(response, what, row * true)
            one = counted(request.of, channel.unit, channel.values, request.sn, alone=alone)
        found[request.name] = replace(one, converged=converged(channel) and not _differs(one, request.sn))
    return found


def converged(channel: Channel) -> bool:
    """Whether neither the modes left out, the mesh nor the end of the window change more than a little of its peak."""
    by_modes = channel.by_modes is None or max(map(_apart, _both(channel))) <= CONVERGED
    return by_modes and not _cut_off(channel) and (channel.stressed is None or not uneven(channel.stressed))


def _differs(found: Fatigue, line: SNLine | None) -> bool:
    """Whether ranges are others without residual vectors than peaks may be, or damage by what that makes of it."""
    if found.largest_modes_alone is None:
        return False
    if _apart((found.largest, found.largest_modes_alone)) > CONVERGED:
        return True
    if line is None or found.damage is None or found.damage_modes_alone is None:
        return False
    return _apart((found.damage, found.damage_modes_alone)) > 1.0 - float((1.0 - CONVERGED) ** line.slope)


def damage_findings(found: Mapping[str, Fatigue]) -> Iterator[Finding]:
    """Damage, or without an S-N line ranges, that rest on a peak which is not to be quoted."""
    for name, one in found.items():
        if one.converged:
            continue
        factor, unit = readable(one.unit, one.largest)
        if one.damage is None:
            told, alone, beside = f"largest range of {factor * one.largest:.4g} {unit}", one.largest_modes_alone, None
            others = [] if alone is None else [f"{factor * alone:.4g} {unit} without the residual vectors"]
        else:
            told, alone, beside = f"damage of {one.damage:.3g}", one.damage_modes_alone, one.damage_beside
            others = [] if alone is None else [f"{alone:.3g} without the residual vectors"]
            others += [] if beside is None else [f"{beside:.3g} with the smaller stress beside the most stressed place"]
        yield Finding(
            "damage-not-converged",
            f"{name}: do not quote its {told}: {one.channel} changes with the modes or the mesh"
            f"{'. It is ' if others else ''}{', and '.join(others)}. Compute more modes, or "
            "a finer mesh where it is uneven. A low-pass of 'peaks' does not filter what is counted",
            {
                key: value
                for key, value in (
                    ("damage", one.damage), ("largest_range", one.largest), ("modes_alone", alone), ("beside", beside)
                )
                if value is not None
            },
        )  # fmt: skip


def fatigue_findings(study: Study, channels: Mapping[str, Channel]) -> Iterator[Finding]:
    """Histories whose cycles are counted and whose peaks the samples miss."""
    for request in (one for one in study.fatigue if not one.under):
        yield from _missed(request, channels[request.of], study.peaks.lowpass_hz is not None)


def _missed(request: FatigueRequest, channel: Channel, filtered: bool) -> Iterator[Finding]:
    """Samples that miss the peak of a history; filtered : its peak is another one."""
    short = 0.0 if filtered or not channel.whole > 0.0 else 1.0 - float(np.abs(channel.values).max()) / channel.whole
    if short > MISSED:
        slope = request.sn.slope if request.sn is not None else SNLine.slope
        damage = 1.0 - (1.0 - short) ** slope
        yield Finding(
            "fatigue-coarsely-sampled",
            f"{request.name}: the largest sample of {request.of} is {100.0 * short:.1f} % below its peak, so ranges "
            f"are too small, and damage by up to {100.0 * damage:.0f} %. Sample faster",
            {"short": short, "allowed": MISSED, "peak": channel.whole},
        )


def peak_findings(channels: Mapping[str, Channel]) -> Iterator[Finding]:
    """Channels of which residual vectors make more than a little."""
    for name, channel in channels.items():
        if channel.by_modes is None:
            continue
        pairs = _both(channel)
        peak, alone = max(pairs, key=_apart)
        window = " in the first impact" if (peak, alone) != pairs[0] else ""
        if _apart((peak, alone)) > CONVERGED:
            factor, unit = readable(channel.unit, max(peak, alone))
            yield Finding(
                "peak-not-converged",
                f"{name}: do not quote its peak{window}. It is {factor * peak:.4g} {unit}, and "
                f"{factor * alone:.4g} {unit} without the residual vectors (the static correction for the modes that "
                "are left out), so it changes with the number of modes and with the mesh. Give the study "
                "'peaks: {lowpass: F}' with F below the last mode",
                {"peak": peak, "modes_alone": alone, "apart": _apart((peak, alone)), "allowed": CONVERGED},
            )


def cut_off_findings(channels: Mapping[str, Channel]) -> Iterator[Finding]:
    """Low-passed pressures whose peak depends on what follows the window, the worst of all as one finding."""
    cut = [one for one in channels.values() if _cut_off(one)]
    if cut:
        worst = max(cut, key=lambda one: max(map(_apart, _ends(one))))
        peak, silent = max(_ends(worst), key=_apart)
        factor, unit = readable(worst.unit, max(peak, silent))
        more = f" (and {len(cut) - 1} more)" if len(cut) > 1 else ""
        yield Finding(
            "pressure-cut-off",
            f"{worst.name}: do not quote its low-passed peak{more}. It is {factor * peak:.4g} {unit} if the pressure "
            f"stays as it is at the end of the window, and {factor * silent:.4g} {unit} if there is silence then. Give "
            "the study a longer time",
            {"peak": peak, "silent": silent, "apart": _apart((peak, silent)), "allowed": CUT_OFF},
        )


def _ends(channel: Channel) -> list[tuple[float, float]]:
    """Its peaks with either end of the window, in the first impact and in all."""
    pair = channel.silent_after or (channel.first_impact, channel.whole)
    return list(zip((channel.first_impact, channel.whole), pair, strict=True))


def _cut_off(channel: Channel) -> bool:
    return max(map(_apart, _ends(channel))) > CUT_OFF


def change_findings(reference: Mapping[str, Channel], channels: Mapping[str, Channel]) -> Iterator[Finding]:
    """Changes of peaks against the baseline's that are others in the modes alone."""
    for name, channel in channels.items():
        found = two_changes(reference[name], channel) if name in reference else None
        if found is not None and not agree(found):
            whole, modes = found
            yield Finding(
                "change-not-converged",
                f"{name}: do not quote the change of its peak against the baseline. It is {whole:+.1f} %, and "
                f"{modes:+.1f} % without the residual vectors (the static correction for the modes that are left out)",
                {"change_percent": whole, "modes_alone_percent": modes, "allowed": CHANGED},
            )


def two_changes(before: Channel, after: Channel) -> tuple[float, float] | None:
    """By how much a peak changes, and in the modes alone [%], where the two differ most; None for other channels."""
    if before is after or before.by_modes is None or after.by_modes is None:
        return None
    changes = [
        (100.0 * (then / peak - 1.0), 100.0 * (alone_then / alone - 1.0))
        for (peak, alone), (then, alone_then) in zip(_both(before), _both(after), strict=False)
        if peak > 0.0 and alone > 0.0
    ]
    return max(changes, key=lambda change: abs(change[0] - change[1]), default=None)


def agree(changes: tuple[float, float]) -> bool:
    """Whether two changes are one to what may be quoted."""
    return abs(changes[0] - changes[1]) <= CHANGED


def _both(channel: Channel) -> list[tuple[float, float]]:
    """Its peaks with residual vectors and without, of the windows that tables have: the whole one first."""
    assert channel.by_modes is not None
    first, whole = zip((channel.first_impact, channel.whole), channel.by_modes, strict=True)
    return [whole, first] if channel.struck else [whole]


def _apart(peaks: tuple[float, float]) -> float:
    """Difference of two peaks, as a share of the larger."""
    larger = max(peaks)
    return abs(peaks[0] - peaks[1]) / larger if larger > 0.0 else 0.0
