"""Findings on levels, ratings, and the standard sources that they are for."""

from __future__ import annotations

from typing import Final

from femstruct.findings.entry import CHOSEN, LIMITS, REMARK, Entry, Limit

LEVELS: Final = (
    Entry(
        "band-not-settled",
        "The record is shorter than the ringing of the lowest band filters.",
        LIMITS,
        "a third-octave filter needs longer than the record to decay by 60 dB",
        "Simulate longer, unless the sound begins and ends within the record.",
        (Limit(60.0, "dB of decay", "the usual measure of reverberation", "IEC 61260-1 filters, order 4", ""),),
    ),
    Entry(
        "rating-beyond-modes",
        "Rated bands are blank, because the modes end below them.",
        LIMITS,
        "the filter of a rated band passes frequencies above the last mode of the floor or of the room. Filters pass "
        "up "
        "to 1.25 times the centre of a third octave, 1.76 times that of an octave: what lies above and is 10 dB louder "
        "than the band changes its level by 0.2 dB",
        "Give 'modes: {up_to: F}' with the stated F. Single numbers are lower bounds ('at least').",
    ),
    Entry(
        "room-silent",
        "A room has no levels, because none of its surfaces moves.",
        LIMITS,
        "all surfaces together have less than the threshold share of the speed of the structure: what they have are "
        "rounding errors, of which levels near -185 dB would be made",
        "Join what moves the room to what is struck, or leave the room out of this case.",
        (Limit(1e-8, "of the speed of the structure", "160 dB", CHOSEN, "femstruct.sound.surface.STILL"),),
    ),
    Entry(
        "band-of-one-room",
        "Low bands of this room and these places are outside what rooms like it have.",
        LIMITS,
        "a rated band is outside the 90 % interval of rooms with sides within 5 % and of other places",
        "Use the mean over rooms and places, and its interval.",
        (
            Limit(
                1.0,
                "dB beyond the interval",
                "one band of ten is outside by itself",
                CHOSEN,
                "ensemble_findings.BEYOND_DB",
            ),
        ),
    ),
    Entry(
        "statistical-bands",
        "Rated bands beyond the modes are from statistical energies.",
        LIMITS,
        "the floor is one bare plate, and the filter of a rated band passes frequencies above its last mode: up to "
        "1.25 "
        "times the centre of a third octave, 1.76 times that of an octave",
        "Give 'modes: {up_to: F}' where a single floor matters; 'beyond_modes: blank' leaves these bands blank.",
        (
            Limit(
                1.0,
                "modes in a band: with fewer the band is blank",
                "with fewer its level is that of one mode beside it, or of none",
                CHOSEN,
                "statistical_bands.FEWEST",
            ),
            Limit(
                4.0,
                "modes in a band: with fewer its level scatters more than the statistics state",
                "ensembles of floors have the statistical mean from there on",
                "tests/analytic/test_statistical_levels.py",
                "statistical_bands.MANY",
            ),
        ),
    ),
    Entry(
        "statistical-disagrees",
        "The difference between modes and statistical energies is larger than scatter explains.",
        LIMITS,
        "the mean difference in bands that both have exceeds 1 dB and twice its standard deviation by scatter",
        "Check the mesh, the loss factor and the reverberation time; use few bands beyond the modes.",
        (
            Limit(
                1.0,
                "dB that the mean may always be",
                "edges and corners are in no infinite plate; 0.3 and 0.1 dB are seen",
                "tests/analytic/test_statistical_levels.py",
                "statistical_bands.SYSTEMATIC_DB",
            ),
        ),
    ),
    Entry(
        "rating-of-few-places",
        "The rating uses fewer source positions or microphones than the standard.",
        LIMITS,
        "a rated room has fewer positions than the standard of measurement",
        "Add positions; compare cases meanwhile, not absolute numbers.",
        (
            Limit(
                4.0,
                "source positions, and microphones",
                "the standard asks for four or more",
                "ISO 16283-2, secondary source (sonorasrl.com)",
                "",
            ),
        ),
    ),
    Entry(
        "microphone-near-surface",
        "A microphone of a rated room is nearer to a surface that radiates than the standard allows.",
        LIMITS,
        "a receiver of a room with 'levels' is nearer to the plane of a surface that moves than the threshold",
        "Move the microphone into the room. At a hard wall the mean square is twice that of the room.",
        (
            Limit(
                0.5,
                "m",
                "least distance of a microphone from the boundaries of the room",
                "ISO 16283-2, minimum distances for microphone positions",
                "flanking_findings.NEAR_M",
            ),
        ),
    ),
    Entry(
        "rating-of-other-blows",
        "The source is not the one that the standard rates.",
        LIMITS,
        "not exactly one standard source strikes (one ball, or one tapping machine with five hammers), or other "
        "bodies, "
        "loads or walkers act besides",
        "Use the standard source, or another standard. Single numbers are withheld.",
    ),
    Entry(
        "rating-room-volume",
        "The volume of the room is outside the scope of the standard.",
        LIMITS,
        "a rated room is smaller or larger than the standard allows",
        "Quote levels of the bands, not the single number.",
        (
            Limit(10.0, "m^3 at least", "scope of the standard", "ISO 16283-2", ""),
            Limit(250.0, "m^3 at most", "scope of the standard", "ISO 16283-2", ""),
        ),
    ),
    Entry(
        "floating-floor",
        "A floating floor has its resonance in or below the rated bands.",
        REMARK,
        "the mass-spring-mass resonance of two plates on a layer lies below the last rated band",
        "Use the dynamic stiffness of the layer under its load; the result depends on it.",
    ),
    Entry(
        "blows-overlap",
        "The sound of a blow has not decayed when the next blow comes.",
        LIMITS,
        "a tapping machine is rated by single blows and the sound decays by too little between them",
        "Give the study the stated duration.",
        (
            Limit(
                40.0,
                "dB of decay between blows",
                "levels are then right to 0.1 dB",
                "tests/end_to_end/test_tapping_timing.py",
                "rated_rooms.FALLEN_DB",
            ),
        ),
    ),
    Entry(
        "tapping-not-steady",
        "The tapping machine has not run long enough for a steady level.",
        LIMITS,
        "the level at the beginning of the average is too low by more than the threshold",
        "Give the machine more blows, and the time for them.",
        (
            Limit(
                0.2,
                "dB below the steady level",
                "less than the digits of a rating",
                CHOSEN,
                "rated_rooms.BUILT_UP_DB",
            ),
        ),
    ),
    Entry(
        "source-off-standard",
        "The standard source has other forces on this floor than on the rigid floor of its standard.",
        LIMITS,
        "on this floor the force exposure in an octave, the restitution or the contact time of a dropped source is "
        "outside "
        "the tolerances that the standard has on a rigid floor",
        "Nothing, if the floor is soft. On a stiff floor check the sampling and the contact law.",
        (
            Limit(1.0, "dB, octave at 31.5 Hz", "tolerance of the standard", "ISO 16283-2 table A.1", ""),
            Limit(1.5, "dB, octaves at 63 and 125 Hz", "tolerance of the standard", "ISO 16283-2 table A.1", ""),
            Limit(2.0, "dB, octaves at 250 and 500 Hz", "tolerance of the standard", "ISO 16283-2 table A.1", ""),
            Limit(0.1, "of restitution, from 0.8", "tolerance of the standard", "ISO 16283-2 annex A", ""),
            Limit(0.002, "s of contact time, from 0.02 s", "tolerance of the standard", "ISO 16283-2 annex A", ""),
        ),
    ),
    Entry(
        "source-coarsely-sampled",
        "The sampling is too low to compare the source with its standard.",
        REMARK,
        "a dropped standard source is sampled below the threshold",
        "Sample faster.",
        (
            Limit(
                1600.0, "Hz", "the octave at 500 Hz needs it", "band edges, IEC 61260-1", "exposure.LEAST_SAMPLING_HZ"
            ),
        ),
    ),
    Entry(
        "hammers-rebound",
        "The levels of a tapping machine depend on how far its hammers rebound, which no standard fixes.",
        LIMITS,
        "a tapping machine strikes, always: the message states in dB how far levels would be lower or higher with a "
        "restitution of 0 and of 1, between which real machines are reported to lie",
        "Quote the range with the level. Source: Acta Acustica 9, 14 (2025).",
    ),
    Entry(
        "tapping-hammer-spacing",
        "The hammers of the tapping machine do not have the spacing of the standard.",
        LIMITS,
        "two neighbouring hammers are further from the standard spacing than allowed",
        "Use five positions for each position of the machine.",
        (
            Limit(0.1, "m apart", "the standard's spacing", "ISO 10140-5 annex E", "impact_findings.HAMMERS_APART"),
            Limit(
                0.003,
                "m of tolerance",
                "the tolerance of the standard",
                "ISO 10140-5 annex E",
                "impact_findings.HAMMERS_WITHIN",
            ),
        ),
    ),
    Entry(
        "walking-below-modes",
        "The harmonics of the walker are all below the first mode.",
        LIMITS,
        "the first mode of the floor is higher than the last harmonic",
        "Use a measured force: such a floor reacts to heel strikes, which a Fourier series does not contain.",
    ),
    Entry(
        "walking-low-frequency-only",
        "The walking model covers low-frequency vibration only.",
        LIMITS,
        "a room with receivers has a walker",
        "Use a measured force history ('loads.NAME.file') for audible footsteps.",
    ),
)
