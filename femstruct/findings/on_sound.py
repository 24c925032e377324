"""Findings on levels and ratings, on sound in rooms, and on sound in the open."""

from __future__ import annotations

from typing import Final

from femstruct.findings.entry import CHOSEN, LIMITS, REMARK, Entry, Threshold

# ----------------------------------------------------------------------------------------------------------------------
# Findings on levels, ratings, and the standard sources that they are for.
# ----------------------------------------------------------------------------------------------------------------------

LEVELS: Final = (
    Entry(
        "band-not-settled",
        "The record is shorter than the ringing of the lowest band filters.",
        LIMITS,
        "a third-octave filter needs longer than the record to decay by 60 dB",
        "Simulate longer, unless the sound begins and ends within the record.",
        (Threshold(60.0, "dB of decay", "the usual measure of reverberation", "IEC 61260-1 filters, order 4", ""),),
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
        (Threshold(1e-8, "of the speed of the structure", "160 dB", CHOSEN, "femstruct.sound.surfaces.STILL"),),
    ),
    Entry(
        "band-of-one-room",
        "Low bands of this room and these places are outside what rooms like it have.",
        LIMITS,
        "a rated band is outside the 90 % interval of rooms with sides within 5 % and of other places",
        "Use the mean over rooms and places, and its interval.",
        (
            Threshold(
                1.0,
                "dB beyond the interval",
                "one band of ten is outside by itself",
                CHOSEN,
                "rated_floors.BEYOND_DB",
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
            Threshold(
                1.0,
                "modes in a band: with fewer the band is blank",
                "with fewer its level is that of one mode beside it, or of none",
                CHOSEN,
                "statistical.FEWEST",
            ),
            Threshold(
                4.0,
                "modes in a band: with fewer its level scatters more than the statistics state",
                "ensembles of floors have the statistical mean from there on",
                "tests/analytic/test_statistical_levels.py",
                "statistical.MANY",
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
            Threshold(
                1.0,
                "dB that the mean may always be",
                "edges and corners are in no infinite plate; 0.3 and 0.1 dB are seen",
                "tests/analytic/test_statistical_levels.py",
                "statistical.SYSTEMATIC_DB",
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
            Threshold(
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
            Threshold(
                0.5,
                "m",
                "least distance of a microphone from the boundaries of the room",
                "ISO 16283-2, minimum distances for microphone positions",
                "study_findings.NEAR_M",
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
            Threshold(10.0, "m^3 at least", "scope of the standard", "ISO 16283-2", ""),
            Threshold(250.0, "m^3 at most", "scope of the standard", "ISO 16283-2", ""),
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
            Threshold(
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
            Threshold(
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
            Threshold(1.0, "dB, octave at 31.5 Hz", "tolerance of the standard", "ISO 16283-2 table A.1", ""),
            Threshold(1.5, "dB, octaves at 63 and 125 Hz", "tolerance of the standard", "ISO 16283-2 table A.1", ""),
            Threshold(2.0, "dB, octaves at 250 and 500 Hz", "tolerance of the standard", "ISO 16283-2 table A.1", ""),
            Threshold(0.1, "of restitution, from 0.8", "tolerance of the standard", "ISO 16283-2 annex A", ""),
            Threshold(0.002, "s of contact time, from 0.02 s", "tolerance of the standard", "ISO 16283-2 annex A", ""),
        ),
    ),
    Entry(
        "source-coarsely-sampled",
        "The sampling is too low to compare the source with its standard.",
        REMARK,
        "a dropped standard source is sampled below the threshold",
        "Sample faster.",
        (
            Threshold(
                1600.0,
                "Hz",
                "the octave at 500 Hz needs it",
                "band edges, IEC 61260-1",
                "sound_levels.LEAST_SAMPLING_HZ",
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
            Threshold(0.1, "m apart", "the standard's spacing", "ISO 10140-5 annex E", "impact_findings.HAMMERS_APART"),
            Threshold(
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


# ----------------------------------------------------------------------------------------------------------------------
# Findings on sound in rooms: coupling with the air, losses, sampling of the surface, modes and cosines.
# ----------------------------------------------------------------------------------------------------------------------

ROOMS: Final = (
    Entry(
        "one-way-stiff-air",
        "The sealed air is too stiff for one-way coupling.",
        LIMITS,
        "the stiffness of the air is more than the threshold share of that of a mode",
        "Use 'coupling: two-way', or quote differences between cases only.",
        (
            Threshold(
                0.1,
                "% of the stiffness of a mode",
                "the frequency rises by more than 5 %",
                "sqrt(1 + 0.1)",
                "femstruct.sound.surfaces.STIFF_AIR",
            ),
        ),
    ),
    Entry(
        "flanking-incomplete",
        "A room among several surfaces has walls that are rigid.",
        REMARK,
        "a room has two surfaces or more, and less than the threshold share of one of its walls moves",
        "Give walls that matter parts and surfaces of their own; flanking is never more complete than the model.",
        (Threshold(0.95, "of each wall moves", "what is left is edges", CHOSEN, "study_findings.COVERED"),),
    ),
    Entry(
        "one-way-resonance",
        "A floor mode and a room mode exchange energy, so levels of one-way coupling are too high.",
        LIMITS,
        "coupling is one-way and kappa, the coupling of a floor mode and a room mode over their damping, is large",
        "Use 'coupling: two-way'.",
        (
            Threshold(
                0.12,
                "kappa",
                "0.5 dB in a band, 1 dB at a line",
                "10 lg(1 + kappa), tests/analytic/test_meeting.py",
                "rated_rooms.EXCHANGED",
            ),
        ),
    ),
    Entry(
        "floor-room-resonance",
        "A floor mode and a room mode are close, so the levels are sensitive to a few hertz in either.",
        LIMITS,
        "both lie within half the sum of their bandwidths, with similar shapes on the ceiling, in a rated room",
        "Vary the stiffness or the size of the room by a few per cent and report the scatter.",
        (
            Threshold(
                0.3,
                "correlation of the two shapes",
                "one drives the other",
                CHOSEN,
                "rated_rooms.MIN_SHAPE_CORRELATION",
            ),
            Threshold(
                0.1, "of the largest motion of the ceiling", "other modes do not matter", CHOSEN, "rated_rooms.MOVES"
            ),
        ),
    ),
    Entry(
        "two-way-coupling",
        "The frequencies and mode numbers are those of the structure with the air.",
        REMARK,
        "a room has 'coupling: two-way'",
        "Nothing; the message states the mode that the air changes most.",
    ),
    Entry(
        "cavity-modes-cut",
        "The highest room modes do not react on the structure.",
        LIMITS,
        "the room modes that are coupled end below the frequency asked for",
        "Ask for a lower frequency, or read the highest bands as those of one-way coupling.",
        (Threshold(300.0, "coupled room modes at most", "each costs as much as a mode", CHOSEN, "box_coupling.MOST"),),
    ),
    Entry(
        "two-way-absorption",
        "Two-way coupling is a rough approximation, because the walls absorb too much.",
        LIMITS,
        "the walls couple two room modes, or absorb uniform pressure, by more than the threshold",
        "Use one-way coupling as well, and compare.",
        (
            Threshold(
                0.05,
                "of the distance of two frequencies, and of a loss factor",
                "modes are then not damped one by one",
                CHOSEN,
                "walls.COUPLED",
            ),
        ),
    ),
    Entry(
        "coupled-absorption",
        "Walls whose absorption depends on frequency couple the room modes.",
        LIMITS,
        "they couple two modes by more than the threshold: the geometric mean of both admittances is used",
        "Read single lines between the room modes with care; third octaves are less affected.",
        (
            Threshold(
                0.05,
                "of the distance of two frequencies",
                "the dependence on frequency matters between the modes",
                CHOSEN,
                "walls.COUPLED",
            ),
        ),
    ),
    Entry(
        "sealed-air-carries-load",
        "The sealed air carries a part of the weight, although a real room has leaks.",
        LIMITS,
        "a body ends at rest and the air adds more than the threshold to the static stiffness",
        "Give the room a 'leak', or do not quote the position at rest.",
        (
            Threshold(
                0.05, "% of the weight", "less does not change a sag visibly", CHOSEN, "coupled_air.CARRIED_BY_AIR"
            ),
        ),
    ),
    Entry(
        "room-modes-missing",
        "The surface moves at frequencies above the last room mode.",
        LIMITS,
        "the bandwidth of the surface is higher than the last computed mode of a meshed room",
        "Give the room 'modes: {up_to: F}' with a higher F.",
    ),
    Entry(
        "room-mesh-coarse",
        "The mesh of the room has too few cells for the shortest wave.",
        LIMITS,
        "the wavelength at the highest frequency spans fewer cells than needed",
        "Use a finer mesh.",
        (
            Threshold(
                6.0,
                "cells a wavelength, second order",
                "frequencies are right to 0.1 %",
                "measured, 0.08 % along the cells",
                "finite_elements.CELLS_PER_WAVE",
            ),
        ),
    ),
    Entry(
        "surface-coarsely-sampled",
        "The sampling is too low for the highest frequencies of the surface.",
        LIMITS,
        "a third octave at the highest frequency of the surface, or of the last mode where that is lower, loses more "
        "than the threshold to the sampling",
        "Sample at the stated frequency.",
        (
            Threshold(
                0.1,
                "dB, at 5.5 samples a period",
                "levels are quoted to one decimal; at 7.5 samples it is 0.05 dB",
                "measured with a bang machine and two rubber balls, tests/analytic/test_acoustics_sampling.py",
                "acoustics.rooms.room_advice.ALLOWED_DB",
            ),
        ),
    ),
    Entry(
        "surface-starts-moving",
        "The surface moves already at t = 0, so the sound begins with a click.",
        LIMITS,
        "the velocity at t = 0 is more than the threshold share of its peak",
        "Start from rest, or start the blow a little later.",
        (
            Threshold(
                1e-3, "of the peak velocity", "60 dB below the peak", CHOSEN, "acoustics.rooms.room_advice.DECAYED"
            ),
        ),
    ),
    Entry(
        "surface-not-decayed",
        "The surface still moves when the record ends.",
        LIMITS,
        "the velocity in the last 5 % of the record is more than the threshold share of its peak",
        "Simulate longer. Largest Fast levels of a single blow are hardly affected.",
        (
            Threshold(
                1e-3, "of the peak velocity", "60 dB below the peak", CHOSEN, "acoustics.rooms.room_advice.DECAYED"
            ),
        ),
    ),
    Entry(
        "ceiling-points-coarse",
        "The points of the ceiling are too few for the highest cosines of the room.",
        LIMITS,
        "the quadrature error of the highest cosine is more than the threshold",
        "Use a finer mesh of the slab.",
        (
            Threshold(
                0.05, "quadrature error", "0.4 dB of that cosine", "20 lg 1.05", "acoustics.rooms.room_advice.COARSE"
            ),
        ),
    ),
    Entry(
        "orders-truncated",
        "The sum over cosines ends too early.",
        LIMITS,
        "the last block of cosines adds more than the threshold share of the rms pressure",
        "Place the receiver further from the ceiling. In Python, give 'pressure' more orders.",
        (
            Threshold(
                1e-3, "of the rms pressure", "less than 0.01 dB", "20 lg 1.001", "acoustics.rooms.room_advice.TRUNCATED"
            ),
        ),
    ),
    Entry(
        "non-causal-losses",
        "The losses are not causal, so a part of the pressure comes before its cause.",
        LIMITS,
        "the losses have the kind 'source', a constant damping ratio",
        "Use another kind of losses, except to reproduce a publication.",
    ),
    Entry(
        "t60-missed",
        "The room model does not have the reverberation times that were asked for.",
        LIMITS,
        "a reverberation time of a band is missed by more than the threshold",
        "Use absorbing walls with values by band, or ask for times that fall smoothly with frequency.",
        (
            Threshold(
                0.1,
                "% of a reverberation time",
                "0.4 dB of a standardised level",
                "10 lg 1.1",
                "acoustics.rooms.room_advice.T60_MISSED",
            ),
        ),
    ),
)


# ----------------------------------------------------------------------------------------------------------------------
# Findings on sound in the half space: pressure, power, sound energy, and the sound of the bodies themselves.
# ----------------------------------------------------------------------------------------------------------------------

_ONE_PER_CENT: Final = "0.04 dB"

OPEN_AIR: Final = (
    Entry(
        "surface-points-coarse",
        "The points of the surface are too far apart for the wavelength in air.",
        LIMITS,
        "the wavelength in air at the highest frequency spans fewer points than needed",
        "Use a finer mesh.",
        (
            Threshold(
                6.0,
                "points a wavelength in air",
                "each point is then small beside the wave",
                CHOSEN,
                "rayleigh.POINTS_PER_WAVE",
            ),
        ),
    ),
    Entry(
        "field-receiver-near",
        "The receiver is so near that single points of the surface matter.",
        LIMITS,
        "a receiver is nearer than some point distances",
        "Place the receiver further away, or use a finer mesh.",
        (
            Threshold(
                2.0,
                "point distances",
                "nearer, single points matter in the sum for Rayleigh's integral",
                CHOSEN,
                "rayleigh.NEAR",
            ),
        ),
    ),
    Entry(
        "power-beyond-modes",
        "The band of the sound power ends above the last mode.",
        LIMITS,
        "a band is asked for above the last mode",
        "Ask for more modes. Above the last mode the power is too low.",
    ),
    Entry(
        "sound-energy-beyond-modes",
        "A part of the sound energy lies above the last mode and is not counted.",
        LIMITS,
        "the share of the sound energy above the last mode, plain or A-weighted, is too large",
        "Ask for more modes.",
        (Threshold(0.01, "% of the sound energy", _ONE_PER_CENT, "10 lg 1.01", "sound_energy.SHARE_ALLOWED"),),
    ),
    Entry(
        "sound-energy-not-taken",
        "The sound energy is not subtracted from the structure, although it is a part of its losses.",
        LIMITS,
        "the sound energy is more than the threshold share of what the structure lost in its own damping",
        "Increase the loss factor by this share, or read the levels as upper bounds.",
        (
            Threshold(
                0.1,
                "% of the losses",
                "amplitudes would decay 10 % faster, and levels be 0.4 dB lower in a band",
                "rates of decay go as the loss factor; 10 lg 1.1",
                "femstruct.sound.radiated_power.LOSSES_ALLOWED",
            ),
        ),
    ),
    Entry(
        "sound-energy-not-decayed",
        "The structure still radiates sound when the record ends.",
        LIMITS,
        "the last tenth of the record has more than the threshold share of the sound energy",
        "Simulate longer.",
        (Threshold(0.01, "% of the sound energy", _ONE_PER_CENT, "10 lg 1.01", "sound_energy.SHARE_ALLOWED"),),
    ),
    Entry(
        "sound-energy-points-coarse",
        "A part of the sound energy lies where the points of the surface are too far apart.",
        LIMITS,
        "the share of the sound energy above 6 points a wavelength is too large",
        "Use a finer mesh.",
        (
            Threshold(0.01, "% of the sound energy", _ONE_PER_CENT, "10 lg 1.01", "sound_energy.SHARE_ALLOWED"),
            Threshold(
                3.0,
                "points a wavelength, counted at all",
                "below, the sum over points is not valid",
                CHOSEN,
                "sound_energy.FEWEST_POINTS",
            ),
        ),
    ),
    Entry(
        "sound-energy-starts-moving",
        "The surface moves already when the record starts, so the sound energy contains a click.",
        LIMITS,
        "the velocity squared at the start is more than the threshold share of the mean square",
        "Start from rest. The energy of the click grows with the sampling.",
        (Threshold(0.01, "% of the mean square", _ONE_PER_CENT, "10 lg 1.01", "sound_energy._JUMP"),),
    ),
    Entry(
        "own-sound-left-out",
        "The direct sound of the impacting body is not computed.",
        LIMITS,
        "a body without 'radius' strikes on the side of a receiver in the open half space",
        "Give a 'radius' if the body is roughly spherical.",
    ),
    Entry(
        "radius-unused",
        "The radius of the body has no effect on the sound.",
        REMARK,
        "a body with 'radius' is not in front of the surface of a half space with receivers",
        "Remove the radius, or place the body on the side of the receivers.",
    ),
    Entry(
        "impactor-moves",
        "The impacting body moves while it is pushed, but its sound comes from a fixed place.",
        LIMITS,
        "the body moves during contact by more than the threshold share of its radius",
        "Do not quote its own sound more exactly than to a few decibels.",
        (
            Threshold(
                0.1,
                "% of the radius",
                "1 dB, since its sound is proportional to the height of its centre above the surface",
                CHOSEN,
                "femstruct.sound.radiated_power.MOVED",
            ),
        ),
    ),
    Entry(
        "push-coarsely-sampled",
        "The push on the sphere is too short for the sampling.",
        LIMITS,
        "more than the threshold share of the energy of the push lies near half the sampling frequency or above",
        "Sample faster.",
        (
            Threshold(1e-3, "% of the energy of the acceleration", "less is not audible", CHOSEN, "sphere.UNSAMPLED"),
            Threshold(
                0.8,
                "of half the sampling frequency, from there on",
                "spectra are faded out",
                CHOSEN,
                "box_pressure.FADE",
            ),
        ),
    ),
    Entry(
        "sphere-too-large",
        "The sphere is too large for the highest frequencies of its push.",
        LIMITS,
        "more than the threshold share of the energy of the push lies above the last computed frequency",
        "Read the highest bands of its own sound as lower bounds.",
        (
            Threshold(1e-3, "% of the energy of the acceleration", "less is not audible", CHOSEN, "sphere.UNSAMPLED"),
            Threshold(24.0, "wavelengths, circumference", "multipoles end there", CHOSEN, "sphere.HIGHEST_KA"),
        ),
    ),
    Entry(
        "spheres-near",
        "Two spheres are so near that each changes the sound of the other.",
        LIMITS,
        "the distance of two centres is less than some sums of the radii",
        "Read their own sound to 1 dB at low and 8 dB at high frequencies.",
        (
            Threshold(
                10.0,
                "sums of the radii",
                "scattered sound is then at most 10 %",
                "as of one sphere above a rigid plane",
                "sphere.APART",
            ),
        ),
    ),
)
