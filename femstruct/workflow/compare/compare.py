"""Cases beside their baseline: peaks in percent, bands and modes in decibels, modes by shape."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np

from femstruct.modal.basis import ModalBasis
from femstruct.modal.likeness import pairing, share_nodes
from femstruct.study.recorded import Channel
from femstruct.study.result import CaseComparison, CaseResult, Comparison, PeakChange
from femstruct.workflow.compare.at_modes import RESOLVED, Spectra, mode_attenuation
from femstruct.workflow.stages.recorded.peaks import agree, two_changes
from femstruct.workflow.stages.recorded.windowed_peaks import filter_sentence

NO_NODE: Final = "modes are not compared: the structures have no node in common"
SAME: Final = 1e-9  # relative rounding of a duration


def compare(baseline: str, results: Mapping[str, CaseResult], spectra: Spectra) -> Comparison:
    """All other cases beside the baseline.

    spectra : of channels that were compared before; those of these cases are added.

    Notes
    -----
    When all force enters a linear structure at one point, every output has the spectrum of that force times its own
    transfer function, so all attenuations of one mode are equal, and equal to that of the net force.
    """
    reference = results[baseline]
    others = {name: _beside(reference, result, spectra) for name, result in results.items() if name != baseline}
    return Comparison(baseline, others, filter_sentence(reference.case.study.peaks))


def _beside(reference: CaseResult, result: CaseResult, spectra: Spectra) -> CaseComparison:
    shared = [name for name in reference.channels if name in result.channels]
    alike = _comparable(reference.basis, result.basis)
    return CaseComparison(
        peaks={name: _peak_change(reference.channels[name], result.channels[name]) for name in shared},
        bands_db={
            name: _band_attenuation(levels.bands_db, result.levels[name].bands_db)
            for name, levels in reference.levels.items()
            if name in result.levels
        },
        modes_db={name: mode_attenuation(reference, result, name, spectra) for name in shared} if alike else {},
        frequencies=mode_table(reference.basis, result.basis) if alike else {},
        notes=tuple(_notes(reference, result, alike)),
    )


def _comparable(reference: ModalBasis, basis: ModalBasis) -> bool:
    """Whether the modes of two bases can be those of one structure; without modes there is nothing to tell them by."""
    return not (reference.modes.stop and basis.modes.stop) or share_nodes(reference, basis)


def _notes(reference: CaseResult, result: CaseResult, alike: bool) -> Iterator[str]:
    """Sentences on what of a case and its baseline is not compared, or not as a whole."""
    if not alike:
        yield NO_NODE
    first, second = (filter_sentence(one.case.study.peaks) for one in (reference, result))
    if first != second:
        yield f"its peaks have another filter than those of the baseline: {second}"
    if reference.response is None or result.response is None:
        return
    clock, own = reference.response.clock, result.response.clock
    modes = alike and not (reference.response.blows or result.response.blows)
    if not np.isclose(clock.duration, own.duration, rtol=SAME, atol=0.0):
        shorter = min(clock.duration, own.duration)
        over = f"; modes are compared over the first {shorter:g} s" if modes else ""
        whole = "peaks and levels are of each one's whole window"
        yield f"its window is {own.duration:g} s, that of the baseline {clock.duration:g} s: {whole}{over}"
    if own.sampling != clock.sampling and modes:
        top = RESOLVED * min(clock.sampling, own.sampling)
        samplings = f"its sampling is {own.sampling:g} Hz, that of the baseline {clock.sampling:g} Hz"
        yield f"{samplings}: modes are compared up to {top:g} Hz"


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


def mode_table(reference: ModalBasis, basis: ModalBasis) -> dict[int, tuple[int, float, float]]:
    """The mode most alike to each of the baseline's, its frequency [Hz] and the MAC; empty for the same basis.

    Empty, too, for a basis without a mode. Where frequencies are near-equal the MAC is that with their space, and every
    mode of it has its own partner.
    """
    if not (reference.modes.stop and basis.modes.stop):
        return {}
    if reference.omega.shape == basis.omega.shape and np.array_equal(reference.shapes, basis.shapes):
        return {}
    pairs = pairing(reference, basis)
    return {
        mode + 1: (int(partner) + 1, float(basis.frequency_hz[partner]), pairs.alike(mode))
        for mode, partner in enumerate(pairs.partner)
    }
