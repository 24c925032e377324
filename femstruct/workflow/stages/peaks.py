"""Peaks that depend on the modes left out: reported with the peak of the modes alone beside them.

Residual vectors hold the static share of all modes beyond the last one at the places that are pushed. A displacement
or a velocity hardly feels them; the acceleration of the struck point may be theirs for a half, and then moves with
the number of modes and with the mesh.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from femstruct.errors import Finding
from femstruct.impact.result.fatigue import Fatigue, SNLine, counted, counted_on_planes
from femstruct.impact.result.response import Response
from femstruct.impact.result.shock import ShockSpectrum, shock_spectrum
from femstruct.study.counting import FatigueRequest
from femstruct.study.result import Channel
from femstruct.study.study import Study
from femstruct.workflow.stages.places import Places

CONVERGED = 0.05  # of a peak: what residual vectors may make of it
MISSED = 0.02  # of a peak: what samples may miss of it before cycles are counted from them
CHANGED = 5.0  # per cent: by how much a change against the baseline may depend on them


def shock_spectra(study: Study, channels: Mapping[str, Channel]) -> dict[str, ShockSpectrum]:
    """The shock response spectra that a study asks for, by name; frequencies evenly over the logarithm."""
    found: dict[str, ShockSpectrum] = {}
    if study.time is None:
        return found
    for request in study.shock_spectra:
        low, high = request.band
        count = max(2, round(request.per_octave * np.log2(high / low)) + 1)
        channel, lines = channels[f"{request.of} acceleration"], np.geomspace(low, high, count)
        found[request.name] = shock_spectrum(channel.values, study.time.sampling, lines, request.damping, channel.name)
    return found


def fatigues(study: Study, channels: Mapping[str, Channel], places: Places, response: Response) -> dict[str, Fatigue]:
    """Rainflow cycles of the histories that a study asks for, by name.

    Of a stress the components at the place where the part is stressed most are counted: the recorded history, which is
    the largest equivalent stress anywhere, has no sign.
    """
    found: dict[str, Fatigue] = {}
    for request in (one for one in study.fatigue if not one.under):
        channel = channels[request.of]
        if channel.stressed is not None:
            part = request.of.rpartition(" ")[0]
            rows = places.stresses(part, f"fatigue.{request.name}.of").at(channel.stressed.worst)
            components = rows.of(response.basis.shapes)[0] @ response.q
            where = channel.stressed.where
            found[request.name] = counted_on_planes(request.of, components, rows.components, request.sn, where)
        else:
            found[request.name] = counted(request.of, channel.unit, channel.values, request.sn)
    return found


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
        peak, alone = max(zip(_peaks(channel), channel.by_modes, strict=True), key=_apart)
        if _apart((peak, alone)) > CONVERGED:
            yield Finding(
                "peak-not-converged",
                f"{name}: do not quote its peak. It is {peak:.4g} {channel.unit}, and {alone:.4g} {channel.unit} "
                "without the residual vectors (the static correction for the modes that are left out), so it changes "
                "with the number of modes and with the mesh. Give the study 'peaks: {lowpass: F}' with F below "
                "the last mode",
                {"peak": peak, "modes_alone": alone, "apart": _apart((peak, alone)), "allowed": CONVERGED},
            )


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
        for peak, then, alone, alone_then in zip(
            _peaks(before), _peaks(after), before.by_modes, after.by_modes, strict=True
        )
        if peak > 0.0 and alone > 0.0
    ]
    return max(changes, key=lambda change: abs(change[0] - change[1]), default=None)


def agree(changes: tuple[float, float]) -> bool:
    """Whether two changes are one to what may be quoted."""
    return abs(changes[0] - changes[1]) <= CHANGED


def _peaks(channel: Channel) -> tuple[float, float]:
    return channel.first_impact, channel.whole


def _apart(peaks: tuple[float, float]) -> float:
    """Difference of two peaks, as a share of the larger."""
    larger = max(peaks)
    return abs(peaks[0] - peaks[1]) / larger if larger > 0.0 else 0.0
