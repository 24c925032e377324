"""Findings on sources that were measured by themselves, and on coverings of floors."""

from __future__ import annotations

from typing import Final

from femstruct.findings.entry import CHOSEN, LIMITS, REMARK, Entry, Limit

SOURCES: Final = (
    Entry(
        "source-beyond-modes",
        "Bands of a measured source are blank, because the modes end below them.",
        LIMITS,
        "the upper edge of a band of the source lies above the last mode of the structure, or of a room of any shape",
        "Give the structure or the room 'modes: {up_to: F}' with the stated F.",
    ),
    Entry(
        "source-phase-unknown",
        "The mobility of a measured source has no phase, so its power is known within limits only.",
        LIMITS,
        "the mobility is given by magnitudes, and the phases of a passive source leave more than the threshold open",
        "Give the complex mobility: 'mobility: {lines: FILE}'. EN 15657 and EN 12354-5 use magnitudes, as is done.",
        (
            Limit(
                1.0,
                "dB between the least and the largest power of a band",
                "less is within what measurements of sources repeat",
                CHOSEN,
                "installed_sources.OPEN_DB",
            ),
        ),
    ),
    Entry(
        "source-unrated",
        "The standards of the room do not rate a measured source, so it has no single number.",
        REMARK,
        "a room has 'levels' and the study has 'sources'",
        "Nothing: levels by band and the A-weighted level stand beside the ratings of standard sources.",
    ),
    Entry(
        "covering-in-ratings",
        "The rated levels include the measured reduction of a covering; all else is of the bare floor.",
        LIMITS,
        "a tapping machine has a 'covering', always; a study whose floor does not fit the reduction is refused by the "
        "threshold",
        "Quote the rated levels; sound files, L_AFmax and histories are louder by what the covering takes off. To "
        "compute them with the covering, give it as a contact law or as a layer of the model.",
        (
            Limit(
                1.0,
                "dB less force of the hammers than on a rigid floor: up to it a floor is heavy, beyond it light",
                "a reduction is a ratio of forces on a floor of far lower mobility than a hammer",
                CHOSEN,
                "covered.HEAVY_DB",
            ),
        ),
    ),
    Entry(
        "footstep-on-light-floor",
        "The floor gives way to a foot, so a force recorded on a stiff plate is too large.",
        LIMITS,
        "in a third octave between 20 and 100 Hz, a foot acts on this floor with a force that is lower than on a rigid "
        "floor by more than the threshold",
        "Record the force on this floor, or quote differences between floors of alike mobility.",
        (
            Limit(
                1.0,
                "dB of the force",
                "less is within what two steps differ by",
                "mass of foot and shank, 6.1 % of 75 kg (Winter), as the stiffest foot",
                "footsteps.TAKEN_DB",
            ),
        ),
    ),
)
