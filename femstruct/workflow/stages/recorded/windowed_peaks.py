"""Peaks of recorded histories: between the samples, in the first impact and in all, and what they are filtered with."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import nan
from typing import Final, NamedTuple

import numpy as np
import scipy

from acoustics.rooms.continuation import extended, fast_length
from femstruct.arrays import Floats
from femstruct.impact.closer import CLOSER, ENOUGH, FOLDED, closer, last_mode_hz
from femstruct.impact.result.response import ContactHistory, Event, Response
from femstruct.impact.simulate import simulate
from femstruct.study.asked import PeakRule

FILTER_ORDER = 4
AHEAD = 6.0  # periods of a low-pass after which nothing of what follows is left in it, e^-2.4 a period backwards
SETTLED = 10.0  # periods of a band's lowest edge after which a filter of order 4 has forgotten
PEAK_NOISE_FLOOR = 1e-9  # share of the largest value below which a peak is rounding, or a filter's tail


def filter_sentence(rule: PeakRule) -> str:
    """What every peak went through."""
    if rule.lowpass_hz is None:
        return "no filter"
    filtered = f"low-pass {rule.lowpass_hz:g} Hz (Butterworth, order {FILTER_ORDER}, forwards and backwards)"
    return f"{filtered}; contact forces: no filter"


def first_window(rule: PeakRule, response: Response) -> float:
    """End of the first impact [s]: its window after the first closing, or until a contact closes again.

    A preloaded contact is a clamp that may rattle: it neither begins nor ends an impact.
    """
    closed = closings(response)
    start = min((event.t for event in closed), default=0.0)
    if rule.first_impact is not None:
        return start + rule.first_impact
    seen: set[str] = set()
    for event in closed:
        if event.contact in seen:
            return event.t
        seen.add(event.contact)
    return float(response.t[-1])


def closings(response: Response) -> list[Event]:
    """The closings that begin and end impacts: those of contacts without a preload."""
    clamps = {contact.name for contact in response.scene.contacts if contact.preload > 0.0}
    return [event for event in response.events if event.what == "closes" and event.contact not in clamps]


def first_alone(response: Response, window: float) -> Response | None:
    """The same scene up to the end of the first impact alone, on a grid that shows its pulses, where that of the run
    need not: it follows those of the largest forces, which come later. None where they do not, or nothing struck.

    window : end of the first impact [s].
    """
    later = any(one.peak_time > window for one in response.contacts.values())
    if not later or not any(0.0 <= event.t < window for event in closings(response)):
        return None
    asked = response.clock
    sampling = float(np.ceil(window * asked.sampling)) / window  # so that it ends with the window
    run = simulate(response.basis, response.scene, replace(asked, duration=window, sampling=sampling))
    return closer(run) or run


def beyond(response: Response, rule: PeakRule) -> Response:
    """The same run and what comes after its window, as far ahead as a low-pass looks: what still vibrates at the end
    goes on, and a filter that took it to stop there would ring."""
    assert rule.lowpass_hz is not None
    clock = response.clock
    more = int(np.ceil(AHEAD * clock.sampling / rule.lowpass_hz))
    duration = (len(response.t) + more) / clock.sampling
    return simulate(response.basis, response.scene, replace(clock, duration=duration))


def raised(peaks: tuple[float, float], values: Floats) -> tuple[float, float]:
    """Peaks in the first impact and in the whole record, and at least those of values in the first impact."""
    first = float(np.abs(values).max(initial=0.0))
    return max(peaks[0], first), max(peaks[1], first)


class Before(NamedTuple):
    """A history before its first sample: `level` at the start, to which it came by `rate` a second."""

    level: float = 0.0
    rate: float = 0.0


AT_REST: Final = Before()


def in_band(values: Floats, sampling: float, band: tuple[float, float], before: Before = AT_REST) -> Floats:
    """Histories [.., nt] between two frequencies: Butterworth, order 4, forwards and backwards; low-pass if one is 0.

    before : what they were before the start; nothing, of a structure at rest. After the end they keep their last value:
    of what still changes there, give what follows (`beyond`) and leave its end out.

    Notes
    -----
    The first sample is no state of rest: an acceleration jumps when a dashpot is struck. What was before is a straight
    line, which a low-pass leaves as it is and a band-pass removes; the rest begins from zero, and so does the filter.

    The impulse of 2 N s of a triangle on 1 kg, its acceleration below 50 Hz: dv 2 f (pi/8) / sin(pi/8)

    >>> t = np.arange(80000) / 400e3
    >>> found = in_band(np.maximum(4000.0 * (1.0 - 1000.0 * t), 0.0), 400e3, (0.0, 50.0))
    >>> round(float(found.max() / (2.0 * 2.0 * 50.0 * (np.pi / 8) / np.sin(np.pi / 8))), 2)
    1.0
    """
    low, high = band
    if low > 0.0:
        sos = scipy.signal.butter(FILTER_ORDER, (low, high), "bandpass", fs=sampling, output="sos")
    else:
        sos = scipy.signal.butter(FILTER_ORDER, high, "lowpass", fs=sampling, output="sos")
    count, tail = values.shape[-1], int(SETTLED * sampling / (low or high))
    line = before.level + before.rate * np.arange(count + tail) / sampling
    found = np.empty(values.shape)
    for row, out in zip(values.reshape(-1, count), found.reshape(-1, count), strict=True):  # long tails, one at a time
        whole = np.concatenate((row, np.full(tail, row[-1]))) - line
        there = scipy.signal.sosfilt(sos, whole)[::-1]
        back, _ = scipy.signal.sosfilt(sos, there, zi=scipy.signal.sosfilt_zi(sos) * there[0])
        out[:] = back[::-1][:count]
    return found if low > 0.0 else found + line[:count]


@dataclass(frozen=True)
class Peaks:
    """How peaks are found. window : end of the first impact [s]. count : of samples in the whole window, where
    histories go on after it."""

    rule: PeakRule
    sampling: float
    window: float
    count: int | None = None

    def of(self, values: Floats, before: Before = AT_REST) -> tuple[float, float]:
        """Peaks of |values| in the first impact and in the whole record."""
        if self.rule.lowpass_hz is not None:
            values = in_band(values, self.sampling, (0.0, self.rule.lowpass_hz), before)
        size = np.abs(values[: self.count])
        largest = float(size.max())
        first = float(size[np.arange(len(size)) / self.sampling <= self.window].max(initial=0.0))
        return first if first > PEAK_NOISE_FLOOR * largest else 0.0, largest

    def of_contact(self, values: Floats, contact: ContactHistory) -> tuple[float, float]:
        """The peaks of a contact's force, never filtered: its law is followed between the samples, and a low-pass
        filter would hide what the contact has to carry."""
        first, largest = replace(self, rule=replace(self.rule, lowpass_hz=None)).of(values)
        whole = max(contact.peak_force, largest)
        return whole if contact.peak_time <= self.window else first, whole


def between(pressure: Floats, response: Response) -> tuple[Floats, int]:
    """A pressure [nt] on a finer grid where its samples are coarse, and by what factor: it has nothing above the last
    mode, so its samples say what lies between them; nan where they do not."""
    last, sampling = last_mode_hz(response.basis), response.clock.sampling
    if sampling >= ENOUGH * last:
        return pressure, 1
    if sampling < FOLDED * last:
        return np.full_like(pressure, nan), 1
    factor = int(np.ceil(CLOSER * last / sampling))
    count = len(pressure)
    length = fast_length(2 * count)
    fine = scipy.fft.irfft(scipy.fft.rfft(extended(pressure[None], length)[0]), factor * length)[: factor * count]
    return np.asarray(factor * fine, dtype=np.float64), factor
