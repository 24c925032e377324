"""Findings on sound in the half space: pressure, power, sound energy, and the sound of the bodies themselves."""

from __future__ import annotations

from typing import Final

from femstruct.findings.entry import CHOSEN, LIMITS, REMARK, Entry, Limit

_ONE_PER_CENT: Final = "0.04 dB"

OPEN_AIR: Final = (
    Entry(
        "surface-points-coarse",
        "The points of the surface are too far apart for the wavelength in air.",
        LIMITS,
        "the wavelength in air at the highest frequency spans fewer points than needed",
        "Use a finer mesh.",
        (
            Limit(
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
            Limit(
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
        (Limit(0.01, "% of the sound energy", _ONE_PER_CENT, "10 lg 1.01", "sound_energy.SHARE_ALLOWED"),),
    ),
    Entry(
        "sound-energy-not-taken",
        "The sound energy is not subtracted from the structure, although it is a part of its losses.",
        LIMITS,
        "the sound energy is more than the threshold share of what the structure lost in its own damping",
        "Increase the loss factor by this share, or read the levels as upper bounds.",
        (
            Limit(
                0.1,
                "% of the losses",
                "amplitudes would decay 10 % faster, and levels be 0.4 dB lower in a band",
                "rates of decay go as the loss factor; 10 lg 1.1",
                "femstruct.sound.power.LOSSES_ALLOWED",
            ),
        ),
    ),
    Entry(
        "sound-energy-not-decayed",
        "The structure still radiates sound when the record ends.",
        LIMITS,
        "the last tenth of the record has more than the threshold share of the sound energy",
        "Simulate longer.",
        (Limit(0.01, "% of the sound energy", _ONE_PER_CENT, "10 lg 1.01", "sound_energy.SHARE_ALLOWED"),),
    ),
    Entry(
        "sound-energy-points-coarse",
        "A part of the sound energy lies where the points of the surface are too far apart.",
        LIMITS,
        "the share of the sound energy above 6 points a wavelength is too large",
        "Use a finer mesh.",
        (
            Limit(0.01, "% of the sound energy", _ONE_PER_CENT, "10 lg 1.01", "sound_energy.SHARE_ALLOWED"),
            Limit(
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
        (Limit(0.01, "% of the mean square", _ONE_PER_CENT, "10 lg 1.01", "sound_energy._JUMP"),),
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
            Limit(
                0.1,
                "% of the radius",
                "1 dB, since its sound is proportional to the height of its centre above the surface",
                CHOSEN,
                "femstruct.sound.impactor.MOVED",
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
            Limit(1e-3, "% of the energy of the acceleration", "less is not audible", CHOSEN, "sphere.UNSAMPLED"),
            Limit(
                0.8,
                "of half the sampling frequency, from there on",
                "spectra are faded out",
                CHOSEN,
                "continuation.FADE",
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
            Limit(1e-3, "% of the energy of the acceleration", "less is not audible", CHOSEN, "sphere.UNSAMPLED"),
            Limit(24.0, "wavelengths, circumference", "multipoles end there", CHOSEN, "sphere.HIGHEST_KA"),
        ),
    ),
    Entry(
        "spheres-near",
        "Two spheres are so near that each changes the sound of the other.",
        LIMITS,
        "the distance of two centres is less than some sums of the radii",
        "Read their own sound to 1 dB at low and 8 dB at high frequencies.",
        (
            Limit(
                10.0,
                "sums of the radii",
                "scattered sound is then at most 10 %",
                "as of one sphere above a rigid plane",
                "multipoles.APART",
            ),
        ),
    ),
)
