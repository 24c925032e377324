"""Write docs/tapping.md: the bare slab of models/tapping.study.yaml beside a closed form and a published floor.

Nothing is tuned: the study is the shipped one. `tests/published/test_tapping_page.py` says when the page is out of date
(`-m stress`, it runs the study), and holds its formulas.
"""

from __future__ import annotations

from math import log10, pi, sqrt
from pathlib import Path

from acoustics.levels.rated import RatedRoom
from acoustics.levels.standards import CURVE_THIRDS, weighted_impact_level
from femstruct.language.cases import read_study
from femstruct.workflow.run import run_study

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "tapping.md"
# ISO 717-2 table C.1: a bare heavy floor, of which the standard says nothing else
C1 = (62.1, 63.2, 63.5, 66.2, 68.5, 70.0, 71.7, 73.1, 73.8, 73.5, 73.8, 73.3, 73.1, 73.0, 72.4, 71.2)
C, RHO = 343.0, 1.21  # of air
VOLUME, MASS, STIFFNESS, LOSS = 4.2 * 3.1 * 2.5, 2400 * 0.14, 30e9 * 0.14**3 / 12 / (1 - 0.2**2), 0.05

TEXT = """# The tapping study beside a published floor

The case `bare` of `models/tapping.study.yaml`, third octave by third octave, beside the closed form of ISO 12354-2 for its slab and
beside the bare heavy floor of ISO 717-2 table C.1. Written by `scripts/tapping_page.py`; nothing is fitted.

It is a comparison of kinds, not of one floor: table C.1 states levels, and neither the slab, nor its edges, nor its losses. What
may differ, and what is assumed here:

| | here | table C.1 |
|---|---|---|
| slab | 140 mm of concrete, 4.2 m x 3.1 m, E 30 GPa, nu 0.2, 2400 kg/m^3 (336 kg/m^2), thin plate | not stated |
| edges | simply supported, rigid | not stated |
| loss factor | 5 % at all frequencies, edges included | not stated; ISO 12354-1 has 0.006 + m' / (485 sqrt f): 10 % at 50 Hz, 2 % at 2 kHz |
| hammers | steel on concrete by Hertz, no losses: they rebound with 0.96 of their speed, and a blow is 1.96 m v | real machines: 1 to 2 m v, up to 6 dB less |
| blows | uncorrelated | as of a real machine |
| room | 32.6 m^3 below the slab, reverberation time 0.5 s at all frequencies, its walls do not radiate; one-way coupling | laboratory |
| positions | 4 of the machine, 4 microphones | those of ISO 10140 |

L_n = L_nT + 10 lg(0.032 V / m^3). The closed form is L_n = 155 - 30 lg m' + 10 lg T_s + 10 lg sigma + 10 lg(f / 1 kHz) with T_s =
2.2 / (f eta) of the 5 % above and sigma = 1 / sqrt(1 - f_c / f) above 2 f_c = {critical:.0f} Hz; it has hammers that do not rebound.
"""  # noqa: E501

END = """
Rated, L_n,w (C_I): {own_w:.0f} ({own_c:+.0f}) dB here, {c1_w:.0f} ({c1_c:+.0f}) dB in table C.1. Mean difference to table C.1: {low:+.1f} dB from
100 to 315 Hz, where the slab has one to four modes in a band and one room is no mean of rooms, and {high:+.1f} dB from 400 to 3150 Hz.
Hammers that do not rebound would make all bands up to {rebound:.1f} dB lower, and losses of ISO 12354-1 instead of 5 % the upper bands
up to {losses:.1f} dB louder.
"""  # noqa: E501


def critical_hz() -> float:
    """Critical frequency of the slab [Hz]."""
    return C**2 / (2 * pi) * sqrt(MASS / STIFFNESS)


def by_standard(f: float, mass: float = MASS, loss: float = LOSS, sigma: float = 1.0) -> float:
    """L_n [dB] of a homogeneous floor by ISO 12354-2:2017 (B.2)."""
    return 155 - 30 * log10(mass) + 10 * log10(2.2 / (f * loss)) + 10 * log10(sigma) + 10 * log10(f / 1000)


def computed() -> dict[float, float]:
    """L_nT [dB] of the study by band."""
    plan = read_study(ROOT / "models" / "tapping.study.yaml", only="bare")
    rated: RatedRoom = run_study(plan).cases["bare"].rated["bedroom"]
    return dict(rated.bands_db)


def page(standardised: dict[float, float]) -> str:
    """The page of levels L_nT {band [Hz]: [dB]}."""
    own = {band: level + 10 * log10(0.032 * VOLUME) for band, level in standardised.items()}
    c1 = dict(zip(CURVE_THIRDS, C1, strict=True))
    lines = [TEXT.format(critical=2 * critical_hz())]
    lines += [
        "| band [Hz] | L_nT [dB] | L_n [dB] | ISO 12354-2 [dB] | table C.1 [dB] | L_n less C.1 [dB] |\n|" + "---|" * 6
    ]
    for band, level in own.items():
        above = band >= 2 * critical_hz()
        closed = f"{by_standard(band, sigma=1 / sqrt(1 - critical_hz() / band)):.1f}" if above else "-"
        cells = (f"{standardised[band]:.1f}", f"{level:.1f}", closed, f"{c1[band]:.1f}", f"{level - c1[band]:+.1f}")
        lines.append(f"| {band:g} | {' | '.join(cells)} |")
    mine, theirs = weighted_impact_level(own), weighted_impact_level(c1)
    difference = {band: level - c1[band] for band, level in own.items()}
    low = [one for band, one in difference.items() if band <= 315]
    high = [one for band, one in difference.items() if band > 315]
    end = END.format(
        own_w=mine.weighted_db,
        own_c=mine.adaptation_db,
        c1_w=theirs.weighted_db,
        c1_c=theirs.adaptation_db,
        low=sum(low) / len(low),
        high=sum(high) / len(high),
        rebound=20 * log10(1.96),
        losses=10 * log10(LOSS / (0.006 + MASS / (485 * sqrt(3150.0)))),
    )
    return "\n".join(lines) + "\n" + end


if __name__ == "__main__":
    PAGE.write_text(page(computed()), encoding="utf-8")
    print(f"written to {PAGE}")
