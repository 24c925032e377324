"""Write docs/clt_floor.md: models/clt_floor.study.yaml beside infinite layered floors and published ratings.

Nothing is tuned: the study is the shipped one, and the closed form has its numbers. `tests/published/test_clt_page.py`
says when the page is out of date (`-m stress`, it runs the study), and holds its formulas.
"""

from __future__ import annotations

from dataclasses import replace
from math import log10
from pathlib import Path

import numpy as np
from systems.layered_floor import Floor, Slab, impact_levels, sound_reduction, weighted_reduction

from acoustics.levels.standards import CURVE_THIRDS, weighted_impact_level
from femstruct.language.cases import read_study
from femstruct.workflow.run import run_study

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "clt_floor.md"
VOLUME = 5 * 4 * 2.6
CLT140, CLT160 = Slab.of_layers(40, 20, 20, 20, 40), Slab.of_layers(40, 20, 40, 20, 40)
DRY = (22.5, 2.941e9 * 0.025**3 / 12 / (1 - 0.3**2), 0.014)
SCREED = (150.0, 25e9 * 0.06**3 / 12 / (1 - 0.2**2), 0.01)
AS_STATED = Floor(CLT140, fill=90.0, wool=40e6, boards=DRY)
LOSSY = replace(AS_STATED, fill_speed=100.0, fill_loss=0.6)
SOFTER = replace(AS_STATED, wool=10e6)
WET = Floor(CLT160, fill=99.0, wool=10e6, boards=SCREED)
HEAVIER = (39.0, DRY[1], DRY[2])
WET_LOSSY = replace(WET, slab=replace(CLT160, loss=0.1), boards=(SCREED[0], SCREED[1], 0.05))
CASES = {
    "dry floor": AS_STATED,
    "lossy fill": LOSSY,
    "softer wool": SOFTER,
    "cement screed": WET,
    "lossy screed": WET_LOSSY,
    "bare": Floor(CLT140),
}
LIGHT = Floor(CLT140, fill=27.6, wool=50e6, boards=(30.0, DRY[1], DRY[2]))
PUBLISHED = {  # name: what is published, floors of the closed form
    "gdmtxn01-00": (
        "R_w 62 (-5; -13), L_n,w 50 (-1)",
        {
            "wool 40 MN/m^3, as stated": AS_STATED,
            "the same, fill of 100 m/s that loses 60 %": LOSSY,
            "wool 19 MN/m^3": replace(AS_STATED, wool=19e6),
            "wool 10 MN/m^3": SOFTER,
            "wool 8 MN/m^3": replace(AS_STATED, wool=8e6),
            "wool 10 MN/m^3, boards of 39 kg/m^2": replace(SOFTER, boards=HEAVIER),
        },
    ),
    "DE01a": (
        "R_w 55, L_n,w 64",
        {"wool 50 MN/m^3, as stated": LIGHT, "wool 12.5 MN/m^3": replace(LIGHT, wool=12.5e6)},
    ),
    "gdmnxn06-00": (
        "R_w 73 (-1; -6), L_n,w 45 (-1)",
        {
            "wool 10 MN/m^3, as stated": WET,
            "the same, 5 % of loss in the screed, 10 % in the slab": WET_LOSSY,
        },
    ),
}


TEXT = """# The CLT floor study beside published floors

The cases of `models/clt_floor.study.yaml` beside infinite floors of the same layers in closed form, and beside ratings that are
published of such floors. Written by `scripts/clt_page.py`; nothing is fitted.

No band of a published floor of the like was found, only ratings. So the study cannot be held against a measurement band by band; what
can be asked is which of the numbers that are not stated would have to be other ones.

| | here | published |
|---|---|---|
| gdmtxn01-00, dataholz.eu | `dry floor`, `lossy fill`, `softer wool` | dry screed 25 mm (900 kg/m^3), mineral wool 30 mm of 40 MN/m^3, elastically bonded fill 60 mm (90 kg/m^2), CLT 140 mm: R_w 62 (-5; -13), L_n,w 50 (-1) |
| DE01a, Solid timber manual 2.0 of binderholz and Rigips | no case, closed form only | screed element 25 mm (1200 kg/m^3), wool 20 mm of at most 50 MN/m^3, loose fill 60 mm (460 kg/m^3), CLT 140 mm: R_w 55, L_n,w 64 |
| gdmnxn06-00, dataholz.eu | `cement screed`, `lossy screed` | cement screed 60 mm (150 kg/m^2), wool of at most 10 MN/m^3, loose fill 80 mm (99 kg/m^2), CLT 160 mm: R_w 73 (-1; -6), L_n,w 45 (-1) |
| edges, losses, size of the floor | pinned and hard; 3 % of timber, 20 % of wool; 4 m x 2.8 m | not stated |

The closed form has waves of every length and direction in slab (with shear), fill, wool and boards, a hammer that is rigid and does
not rebound on the mobility of the floor, and a field in the room that is diffuse. It knows no edges, so below the coincidence of the
slab it radiates less than a floor that ends somewhere. For R_w the field arrives at up to 78 degrees.

## Bands

L_n [dB] of the study, mean of ten rooms where it has one (100 to 160 Hz), L_n = L'_nT + {shift:.1f} dB; in brackets the closed form.
Above 250 Hz the modes of the study end, and what it rates is a lower bound.
"""  # noqa: E501

RATINGS = """
## Ratings

Of infinite floors, beside what is published:

| | R_w (C; C_tr) [dB] | L_n,w (C_I) [dB] |
|---|---|---|
"""

END = """
## What the missing knowledge does

- **The wool under dry boards decides.** As stated (40 MN/m^3) boards and floor move against each other at 227 Hz, in the middle of
  what is rated: the study has L_n,w of at least {dry} dB where 50 dB is published, and R_w comes out at {dry_R} dB where 62 dB is
  published. Both published numbers, one of hammers and one of airborne sound, ask for a spring of a quarter of that or less, and so
  does L_n,w of DE01a (its R_w stays 7 dB apart). 30 mm of rock wool is printed with 8 to 10 MN/m^3 (Vigran, Building Acoustics, 2008, table 8.3) and with 10 to 19 MN/m^3 (Hopkins,
  Sound Insulation, 2007, table A3). And s' is measured under 2 kPa; ISO 9052-1 does not hold below 0.4 kPa, and dry boards weigh
  0.22 kPa. With 10 MN/m^3 the study has at least {soft} dB.
- **A loose layer makes the spring softer, not only the slab heavier.** ift Rosenheim found that of dry screeds on concrete (reported
  by Wolf Bavaria); of what stiffness the layer is, is not stated.
- **Losses of the fill are not what is missing below 315 Hz.** In grains sound travels at 100 to 300 m/s (Valenza and others, Phys.
  Rev. E 80, 051304, 2009), so 60 mm stand on a quarter wave at 420 Hz and above; only near it do grains take much. With the lowest
  speed and a loss factor of 60 %, the largest that textbooks print for dry sand, the fill adds 1 % at 100 Hz and 12 % at 250 Hz:
  {lossy:.1f} dB in the band of 250 Hz, 1 dB in the rating.
- **The mass of the boards.** The total that is published with gdmtxn01-00, 202.5 kg/m^2, leaves 39 kg/m^2 for dry boards where their
  layer is stated with 22.5. Both, softer wool and heavier boards, bring the infinite floor within 2 dB of both published ratings.
  Which of them was on the floor that was measured is not known.
- **Losses of screed and slab.** With 5 % instead of 1 % in the screed and 10 % instead of 3 % in the slab the study falls from at
  least {wet} to at least {wet_lossy} dB, where 45 dB is published: what edges and joints of a laid screed take is not stated anywhere.
  Infinite floors hardly show it. The study is up to {edges:.0f} dB louder than they are in single bands: a floor that ends rings and radiates.
- **Hammers** rebound with 0.8 from screed and bare slab here; real machines keep 0 to 1 (Acta Acustica 9, 14, 2025). That is up to
  5.3 dB less. On dry boards they do not rebound.

What is left of the dry floor is {left} dB in L_n,w by the study with softer wool. It is a comparison of kinds, no validation. Pages and
abstracts were read, not the reports; the tables of Vigran and Hopkins in the transcription of the public package phonometry; ISO 9052-1
by its scope in a catalogue; the loss factor of sand is from memory of textbooks.
"""  # noqa: E501


def computed() -> dict[str, tuple[dict[float, float], dict[float, float]]]:
    """L'_nT [dB] of the study by case: of its room, and the mean of ten rooms."""
    cases = run_study(read_study(ROOT / "models" / "clt_floor.study.yaml")).cases
    rated = {name: case.rated["laboratory"] for name, case in cases.items()}
    return {name: (dict(one.bands_db), dict(one.mean_db)) for name, one in rated.items()}


def least(levels: dict[float, float]) -> int:
    """The lowest L_n,w [dB] that some of its bands allow: unfavourable deviations of at most 32 dB."""
    curve = dict(zip(CURVE_THIRDS, (62.0,) * 6 + (61, 60, 59, 58, 57, 54, 51, 48, 45, 42), strict=True))
    over = {n: sum(max(level - curve[band] - n + 60, 0.0) for band, level in levels.items()) for n in range(120)}
    return min(n for n, sum_over in over.items() if sum_over <= 32.0)


def _all(levels: dict[float, float], shift: float) -> dict[float, float]:
    return {band: round(level + shift, 1) for band, level in levels.items()}


def page(found: dict[str, tuple[dict[float, float], dict[float, float]]]) -> str:
    """The page of levels by case: of the room [dB], and the mean of rooms."""
    shift = 10 * log10(0.032 * VOLUME)
    bands = [band for band in CURVE_THIRDS if band <= 250]
    own, mine = dict[str, dict[float, float]](), {name: impact_levels(floor) for name, floor in CASES.items()}
    for name, (levels, means) in found.items():
        own[name] = {
            band: round((means[band] if np.isfinite(means[band]) else levels[band]) + shift, 1) for band in bands
        }
    lines = [TEXT.format(shift=shift), "| band [Hz] | " + " | ".join(CASES) + " |\n|" + "---|" * (1 + len(CASES))]
    beside = ((band, [f"{own[n][band]:.1f} ({mine[n][band]:.1f})" for n in CASES]) for band in bands)
    lines += [f"| {band:g} | {' | '.join(cells)} |" for band, cells in beside]
    least_of = {name: least(levels) for name, levels in own.items()} | {"bare": least(_all(found["bare"][0], shift))}
    whole = {name: weighted_impact_level(levels) for name, levels in mine.items()}
    rated = " | ".join(f"{least_of[name]} ({whole[name].weighted_db:.0f})" for name in CASES)
    lines += [f"| L_n,w, at least (closed form, all bands) | {rated} |", RATINGS.rstrip("\n")]
    for name, (published, floors) in PUBLISHED.items():
        airborne, impact = published.split(", ")
        lines.append(f"| **{name}, published** | {airborne.removeprefix('R_w ')} | {impact.removeprefix('L_n,w ')} |")
        for words, floor in floors.items():
            number, pink, traffic = weighted_reduction(sound_reduction(floor))
            struck = weighted_impact_level(impact_levels(floor))
            cells = f"{number} ({pink:+d}; {traffic:+d}) | {struck.weighted_db:.0f} ({struck.adaptation_db:+.0f})"
            lines.append(f"| {words} | {cells} |")
    end = END.format(
        dry=least_of["dry floor"],
        dry_R=weighted_reduction(sound_reduction(AS_STATED))[0],
        soft=least_of["softer wool"],
        wet=least_of["cement screed"],
        wet_lossy=least_of["lossy screed"],
        lossy=own["dry floor"][250.0] - own["lossy fill"][250.0],
        edges=max(own["cement screed"][band] - mine["cement screed"][band] for band in bands),
        left=least_of["softer wool"] - 50,
    )
    return "\n".join(lines) + "\n" + end


if __name__ == "__main__":
    PAGE.write_text(page(computed()), encoding="utf-8")
    print(f"written to {PAGE}")
