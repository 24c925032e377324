"""Cases beside their baseline: peaks in percent, bands and modes in decibels, modes by shape."""

from __future__ import annotations

from collections.abc import Mapping
from weakref import WeakKeyDictionary

import numpy as np

from femstruct.arrays import Floats
from femstruct.modal.basis import ModalBasis
from femstruct.modal.likeness import pairing
from femstruct.study.result import NET_FORCE, CaseComparison, CaseResult, Channel, Comparison, PeakChange
from femstruct.workflow.stages.recorded.peaks import agree, two_changes
from femstruct.workflow.stages.recorded.windowed_peaks import filter_sentence

NEAR = 0.02  # a spectral peak belongs to a mode within 2 % of its frequency
FINENESS = 0.2  # Hz between spectral lines at most, so that 2 % of the lowest modes holds some, ...
PADDING = 100  # ... but no more lines than that many times the record's own: two in 2 % of the lowest mode it shows


class Spectra:
    """Amplitude spectra of channels, held by who compares cases: a channel that is compared again keeps its own."""

    def __init__(self) -> None:
        self._kept: WeakKeyDictionary[Channel, tuple[float, Floats]] = WeakKeyDictionary()

    def of(self, channel: Channel, sampling: float) -> Floats:
        """|FFT| of the whole record, padded with zeros; sampling [Hz]."""
        kept = self._kept.get(channel)
        if kept is not None and kept[0] == sampling:
            return kept[1]
        wanted = min(sampling / FINENESS, PADDING * len(channel.values))
        length = 2 ** int(np.ceil(np.log2(max(2 * len(channel.values), wanted))))
        spectrum = np.abs(np.fft.rfft(channel.values, length))
        self._kept[channel] = sampling, spectrum
        return spectrum


def compare(baseline: str, results: Mapping[str, CaseResult], spectra: Spectra) -> Comparison:
    """All other cases beside the baseline.

    spectra : of channels that were compared before; those of these cases are added.

    Notes
    -----
    When all force enters a linear structure at one point, every output has the spectrum of that force times its own
    transfer function, so all attenuations of one mode are equal, and equal to that of the net force.
    """
    reference = results[baseline]
    sampling = reference.response.clock.sampling if reference.response is not None else 1.0
    before = {name: spectra.of(channel, sampling) for name, channel in reference.channels.items()}
    others = {name: _beside(reference, before, result, spectra) for name, result in results.items() if name != baseline}
    return Comparison(baseline, others, filter_sentence(reference.case.study.peaks))


def _beside(
    reference: CaseResult, before: Mapping[str, Floats], result: CaseResult, spectra: Spectra
) -> CaseComparison:
    shared = [name for name in reference.channels if name in result.channels]
    return CaseComparison(
        peaks={name: _peak_change(reference.channels[name], result.channels[name]) for name in shared},
        bands_db={
            name: _band_attenuation(levels.bands_db, result.levels[name].bands_db)
            for name, levels in reference.levels.items()
            if name in result.levels
        },
        modes_db={name: _mode_attenuation(reference, before[name], result, name, spectra) for name in shared},
        frequencies=mode_table(reference.basis, result.basis),
    )


def _peak_change(reference: Channel, channel: Channel) -> PeakChange:
    def percent(before: float, after: float) -> float | None:
        return 100.0 * (after / before - 1.0) if before > 0.0 else None

    changes = two_changes(reference, channel)
    return PeakChange(
        percent(reference.first_impact, channel.first_impact),
        percent(reference.whole, channel.whole),
        converged=changes is None or agree(changes),
    )


def _band_attenuation(reference: Mapping[float, float], levels: Mapping[float, float]) -> dict[float, float]:
    return {
        centre: reference[centre] - levels[centre]
        for centre in reference
        if centre in levels and np.isfinite(reference[centre]) and np.isfinite(levels[centre])
    }


def _mode_attenuation(
    reference: CaseResult, before: Floats, result: CaseResult, channel: str, spectra: Spectra
) -> dict[int, float]:
    """Attenuation [dB] of a channel's spectrum at the baseline's own peaks, by the number of the mode they belong to.

    A mode is listed when the baseline's spectrum has a local maximum within 2 % of its frequency; a net force, which
    has no peaks at modes, is compared at the frequency of every mode. A record shorter than one period of a mode does
    not show it, nor does a room above its own modes. The spectrum is that of the whole record, not windowed; of
    repeated blows it is a comb of their interval, and no mode is listed.
    """
    if reference.response is None or result.response is None or reference.response.blows or result.response.blows:
        return {}
    after = spectra.of(result.channels[channel], result.response.clock.sampling)
    if len(before) != len(after):
        return {}
    sampling = reference.response.clock.sampling
    step = sampling / (2.0 * (len(before) - 1))
    slowest = sampling / len(reference.channels[channel].values)  # one period in the record
    rooms = reference.case.study.rooms
    highest = min((plan.complete_below_hz for plan in rooms if channel.startswith(f"{plan.name}.")), default=np.inf)
    top = np.flatnonzero((before[1:-1] > before[:-2]) & (before[1:-1] >= before[2:])) + 1
    table = {}
    for number, (kind, frequency) in enumerate(zip(reference.basis.kind, reference.basis.frequency_hz, strict=True), 1):
        near = top[slice(*np.searchsorted(top, np.array([1.0 - NEAR, 1.0 + NEAR]) * frequency / step))]
        if channel.startswith(NET_FORCE):
            near = np.array([round(frequency / step)])
        if kind == "elastic" and slowest <= frequency <= highest and near.size and near[-1] < len(before):
            peak = near[before[near].argmax()]
            if before[peak] > 0.0 and after[peak] > 0.0:
                table[number] = float(20.0 * np.log10(before[peak] / after[peak]))
    return table


def mode_table(reference: ModalBasis, basis: ModalBasis) -> dict[int, tuple[int, float, float]]:
    """The mode most alike to each of the baseline's, its frequency [Hz] and the MAC; empty for the same basis.

    Empty, too, for a basis without a mode. Where frequencies are near-equal the MAC is that with their space, and every
    mode of it has its own partner.
    """
    if not basis.modes.stop:
        return {}
    if reference.omega.shape == basis.omega.shape and np.array_equal(reference.shapes, basis.shapes):
        return {}
    pairs = pairing(reference, basis)
    return {
        mode + 1: (int(partner) + 1, float(basis.frequency_hz[partner]), pairs.alike(mode))
        for mode, partner in enumerate(pairs.partner)
    }
