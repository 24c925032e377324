"""What is to be known of rated bands that are statistical, and of modes and statistics that differ."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from acoustics.levels.rated import RatedRoom
from acoustics.statistical.statistical_bands import MANY, Agreement
from femstruct.errors import Finding


def statistical_findings(rated: RatedRoom) -> tuple[Finding, ...]:
    """Findings of one room: which of its bands are statistical, and how those of its modes agree with them."""
    if rated.statistical is None:
        return ()
    beside = rated.agreement
    return (*_filled(rated, beside), *(() if beside is None or beside.agree else (_differs(beside),)))


def _filled(rated: RatedRoom, beside: Agreement | None) -> tuple[Finding, ...]:
    """Bands beyond the modes, with what is to be expected of one floor."""
    bands, statistical = rated.statistical_hz, rated.statistical
    if not bands or statistical is None:
        return ()
    scatter = [statistical.scatter_db[band] for band in bands]
    few = [band for band in bands if statistical.modes[band] < MANY]
    told = f"; the plate has fewer than {MANY:g} modes in those up to {max(few):g} Hz" if few else ""
    agreed = "no comparison of modes and statistics is possible: no band has both with enough modes"
    if beside is not None:
        agreed = f"where modes and statistics can be compared: {_beside(beside)}"
    return (
        Finding(
            "statistical-bands",
            f"the rated {rated.method.bands}s {spelt(bands)} lie beyond the modes and are from statistical energies of "
            f"plate and room: a single floor differs from them by {min(scatter):.1f} to {max(scatter):.1f} dB "
            f"(standard deviation){told}; {agreed}",
            {
                "bands": len(bands),
                "first_hz": bands[0],
                "scatter_db": max(scatter),
                "few_modes": len(few),
            },
        ),
    )


def _differs(beside: Agreement) -> Finding:
    return Finding(
        "statistical-disagrees",
        f"levels of modes and of statistical energies differ by more than scatter explains: {_beside(beside)}; "
        f"{beside.allowed_db:.1f} dB is allowed. Check the mesh, the loss factor and the reverberation time",
        {"mean_db": beside.mean_db, "allowed_db": beside.allowed_db, "bands": beside.bands},
    )


def _beside(beside: Agreement) -> str:
    scatter = f", standard deviation {beside.deviation_db:.1f} dB" if isfinite(beside.deviation_db) else ""
    bands = "1 band" if beside.bands == 1 else f"{beside.bands} bands"
    return f"modal levels are {beside.mean_db:+.1f} dB above statistical ones on the mean of {bands}{scatter}"


def spelt(bands: Sequence[float]) -> str:
    """Bands in words.

    >>> spelt((250.0, 315.0, 400.0)), spelt((500.0,))
    ('250 to 400 Hz', '500 Hz')
    """
    return f"{bands[0]:g} to {bands[-1]:g} Hz" if len(bands) > 1 else f"{bands[0]:g} Hz"
