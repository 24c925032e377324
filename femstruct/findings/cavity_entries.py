"""Findings on cavities: air and wool between two surfaces of a structure."""

from __future__ import annotations

from typing import Final

from femstruct.findings.entry import CHOSEN, LIMITS, REMARK, Entry, Limit

CAVITIES: Final = (
    Entry(
        "cavity-coupling",
        "The frequencies and mode numbers are those of the structure with the air of its cavities.",
        REMARK,
        "the model has 'cavities'",
        "Nothing; the message states the mode that the air changes most. With wool read frequency responses: modes of "
        "the air are overdamped, and a damping ratio of one mode is not how it decays.",
    ),
    Entry(
        "cavity-modes-few",
        "The air of a cavity follows the highest motions too fast, because too few of its modes are kept.",
        LIMITS,
        "the modes of the air that are kept end below the threshold share of the frequency that they need to reach: "
        "twice that of the last mode of the structure, f, or in wool 2 sqrt(f sigma / (2 pi rho)) where that is more",
        "Ask for fewer modes of the structure, give the cavity 'up_to: F' with the frequency that is needed, or "
        "name its 'bays' where joists close it.",
        (
            Limit(
                0.7,
                "of the frequency that is needed",
                "motions of a ceiling of 4 x 3 m at the top of the band are wrong by 3 %",
                "tests/analytic/test_cavity_boxes.py",
                "femstruct.sound.cavity_findings.FEW",
            ),
        ),
    ),
    Entry(
        "wool-out-of-range",
        "The model of the wool was not compared at its flow resistivity.",
        LIMITS,
        "the flow resistivity lies outside 5 to 30 kPa*s/m^2",
        "Check its unit; beyond the range the drag is right at low frequencies, its change with frequency is not known "
        "to be.",
        (
            Limit(
                5e3,
                "Pa*s/m^2 at least",
                "within 6.5 % of Johnson-Champoux-Allard from there, 20 Hz to 1 kHz",
                "tests/analytic/test_cavity_wool.py",
                "equivalent_fluid.LEAST",
            ),
            Limit(30e3, "Pa*s/m^2 at most", "the same", "tests/analytic/test_cavity_wool.py", "equivalent_fluid.MOST"),
        ),
    ),
    Entry(
        "held-wool",
        "Wool that is held at rest damps the common movement of both surfaces, which loose wool does not.",
        LIMITS,
        "the fill has 'frame: held', and its drag on a movement of all of the structure is more than the threshold",
        "Use 'frame: limp', but for wool that something at rest holds.",
        (Limit(0.5, "1/s", "a loss factor of 1 % at 16 Hz", CHOSEN, "femstruct.sound.cavity_findings.HELD"),),
    ),
    Entry(
        "cavity-sizes-differ",
        "The two surfaces of a cavity differ in size or do not lie opposite to each other.",
        LIMITS,
        "a side of what they share is shorter than the longer of the two by more than the threshold",
        "Give the surfaces a 'region' of one size.",
        (Limit(0.01, "% of a side", "a hundredth of the volume", CHOSEN, "placed_cavity.SAME"),),
    ),
    Entry(
        "cavity-depth",
        "The depth of a cavity is not the distance of its surfaces.",
        LIMITS,
        "they differ by more than the threshold, from face to face",
        "Correct the depth, or the place of the parts.",
        (Limit(0.2, "% of the distance", "10 % of a frequency on the air", CHOSEN, "placed_cavity.DEPTH"),),
    ),
    Entry(
        "cavity-crossed",
        "A frame runs through a cavity that is described as one.",
        LIMITS,
        "bars lie between the surfaces of a cavity without 'bays', level with them, away from its sides",
        "Name the bays; leave it where the bars do not close the cavity.",
        (
            Limit(0.02, "% of a side", "nearer to a side they close the cavity", CHOSEN, "cavity_crossings.WITHIN"),
            Limit(0.5, "% of the depth", "joists reach beyond the mesh of a plate", CHOSEN, "cavity_crossings.DEEP"),
        ),
    ),
    Entry(
        "bays-beside-joists",
        "Bays of a cavity end where no joist of the model lies.",
        LIMITS,
        "bars lie between the surfaces of a cavity with 'bays', and one of its 'at' is farther from all that run along "
        "it than half its 'width' and the threshold",
        "Check 'across', the axis along which the places are counted, across the joists, and 'at', from the corner of "
        "the cavity. Leave it where the joists are no frames of the model.",
        (Limit(0.02, "% of a side", "a tenth of a usual bay", CHOSEN, "cavity_crossings.WITHIN"),),
    ),
)
