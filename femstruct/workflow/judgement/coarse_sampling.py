"""Samples too few for what vibrates: of recorded histories, of the motion that is heard, of peaks between them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import ceil

import numpy as np

from femstruct.errors import Finding
from femstruct.impact.closer import ENOUGH, FOLDED, factor_for, factor_of, pulses_hz, samples_of_a_pulse
from femstruct.impact.result.response import Response
from femstruct.study.asked import RoomPlan
from femstruct.study.recorded import Channel
from femstruct.study.study import Study
from femstruct.units import readable

HEARD = 10.0  # samples in a period of the last mode that are advised where sound is computed from them
FEW = 8.0  # samples in a period of a pulse, 4 in its half sine, below which peaks are 8 % low: (pi / 8)^2 / 2
PEAK_MISSED = 0.05  # of a recorded peak, by which the samples of its history may miss it


def coarse_sampling(study: Study, last_hz: float, modes: int) -> Iterator[Finding]:
    """What the sampling of a study says against it, of modes up to a frequency [Hz]; modes : how many of them."""
    time = study.time
    if time is None or time.sampling >= ENOUGH * last_hz:
        return
    factor = factor_for(last_hz, modes + len(study.bodies), max(round(time.duration * time.sampling), 1), time.sampling)
    period = f"the last mode, {last_hz:.5g} Hz, has {time.sampling / last_hz:.2g} samples in a period"
    values = {
        "last_mode_hz": last_hz,
        "sampling_hz": time.sampling,
        "samples": time.sampling / last_hz,
        "peaks_at_hz": factor * time.sampling,
    }
    if factor == 0:
        yield Finding(
            "motion-coarsely-sampled",
            f"At the sampling of {time.sampling:g} Hz {period}, and the {ENOUGH:g} samples that peaks need do not fit "
            f"into memory with a window of {time.duration:g} s. Peaks are blank and their limits are not known. Use a "
            "shorter window or fewer modes",
            values | {"needed": ENOUGH},
            severe=True,
        )
        return
    heard = any(_is_heard(plan) for plan in study.rooms)
    if time.sampling >= FOLDED * last_hz or not (study.records or heard):
        return
    needed = HEARD if heard else FOLDED
    sound = "sound is computed from these samples: pressures, levels and ratings are wrong, and peaks of pressures are "
    shown = f"recorded histories and their spectra show what is above {time.sampling / 2.0:g} Hz at lower frequencies. "
    hold = f"Peaks and limits of the structure are found at {factor * time.sampling:g} Hz and hold. "
    yield Finding(
        "motion-coarsely-sampled",
        f"At the sampling of {time.sampling:g} Hz {period}: "
        + (f"{sound}blank" + ("; " if study.records else ". ") if heard else "")
        + (shown + hold if study.records else "")
        + f"Sample at {ceil(needed * last_hz)} Hz or more",
        values | {"needed": needed},
        severe=heard,
    )


def missed_pulses(study: Study, response: Response) -> Iterator[Finding]:
    """A pulse that even the grid of the peaks does not follow: they are lower bounds."""
    samples, factor = samples_of_a_pulse(response), factor_of(response)
    if samples >= ENOUGH or not factor or not study.records:
        return
    name = max(pulses_hz(response).items(), key=lambda one: one[1], default=("a load", 0.0))[0]
    yield Finding(
        "motion-coarsely-sampled",
        f"{name}: its pulse has {0.5 * samples:.2g} samples at the {factor * response.clock.sampling:g} Hz with which "
        f"peaks are found, and {0.5 * ENOUGH:g} do not fit into memory with a window of {response.clock.duration:g} s. "
        "Peaks are lower bounds, but for that of its force: a limit is exceeded or not known. Use a shorter window",
        {"samples": 0.5 * samples, "needed": 0.5 * ENOUGH, "sampling_hz": response.clock.sampling},
        severe=samples < FEW,
    )


def _is_heard(plan: RoomPlan) -> bool:
    return bool(plan.receivers) or plan.room.open_air is not None


def missed_peaks(study: Study, response: Response, channels: Mapping[str, Channel]) -> Iterator[Finding]:
    """Recorded histories whose samples miss their peak, the worst first, as one finding."""
    if study.peaks.lowpass_hz is not None or factor_of(response) <= 1:
        return
    found = []
    for record in study.records:
        channel = channels.get(str(record))
        if channel is None or record.target in response.contacts:  # of a contact its own finding says it
            continue
        sampled = float(np.abs(channel.values).max(initial=0.0))
        if sampled < (1.0 - PEAK_MISSED) * channel.whole:
            found.append((sampled / channel.whole, sampled, channel))
    if found:
        share, sampled, worst = min(found, key=lambda one: one[0])
        more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
        factor, unit = readable(worst.unit, worst.whole)
        yield Finding(
            "motion-coarsely-sampled",
            f"{worst.name}: the largest sample of the history is {factor * sampled:.4g} {unit}; the peak is "
            f"{factor * worst.whole:.4g} {unit} and lies between two samples at {response.clock.sampling:g} Hz{more}. "
            "Peaks and limits are found there too; histories, pictures and spectra do not show it. Sample faster",
            {"sampled_peak": sampled, "peak": worst.whole, "share": share, "allowed": PEAK_MISSED},
        )
