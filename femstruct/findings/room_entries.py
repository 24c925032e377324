"""Findings on sound in rooms: coupling with the air, losses, sampling of the surface, modes and cosines."""

from __future__ import annotations

from typing import Final

from femstruct.findings.entry import CHOSEN, LIMITS, REMARK, Entry, Limit

ROOMS: Final = (
    Entry(
        "one-way-stiff-air",
        "The sealed air is too stiff for one-way coupling.",
        LIMITS,
        "the stiffness of the air is more than the threshold share of that of a mode",
        "Use 'coupling: two-way', or quote differences between cases only.",
        (
            Limit(
                0.1,
                "% of the stiffness of a mode",
                "the frequency rises by more than 5 %",
                "sqrt(1 + 0.1)",
                "femstruct.sound.surface.STIFF_AIR",
            ),
        ),
    ),
    Entry(
        "flanking-incomplete",
        "A room among several surfaces has walls that are rigid.",
        REMARK,
        "a room has two surfaces or more, and less than the threshold share of one of its walls moves",
        "Give walls that matter parts and surfaces of their own; flanking is never more complete than the model.",
        (Limit(0.95, "of each wall moves", "what is left is edges", CHOSEN, "flanking_findings.COVERED"),),
    ),
    Entry(
        "one-way-resonance",
        "A floor mode and a room mode exchange energy, so levels of one-way coupling are too high.",
        LIMITS,
        "coupling is one-way and kappa, the coupling of a floor mode and a room mode over their damping, is large",
        "Use 'coupling: two-way'.",
        (
            Limit(
                0.12,
                "kappa",
                "0.5 dB in a band, 1 dB at a line",
                "10 lg(1 + kappa), tests/analytic/test_meeting.py",
                "meeting.EXCHANGED",
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
            Limit(
                0.3, "correlation of the two shapes", "one drives the other", CHOSEN, "meeting.MIN_SHAPE_CORRELATION"
            ),
            Limit(0.1, "of the largest motion of the ceiling", "other modes do not matter", CHOSEN, "meeting.MOVES"),
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
        (Limit(300.0, "coupled room modes at most", "each costs as much as a mode", CHOSEN, "box_two_way.MOST"),),
    ),
    Entry(
        "two-way-absorption",
        "Two-way coupling is a rough approximation, because the walls absorb too much.",
        LIMITS,
        "the walls couple two room modes, or absorb uniform pressure, by more than the threshold",
        "Use one-way coupling as well, and compare.",
        (
            Limit(
                0.05,
                "of the distance of two frequencies, and of a loss factor",
                "modes are then not damped one by one",
                CHOSEN,
                "absorbing_walls.COUPLED",
            ),
        ),
    ),
    Entry(
        "coupled-absorption",
        "Absorbing walls couple the room modes, which damping of each mode by itself does not describe.",
        LIMITS,
        "the absorption depends on frequency and couples two modes by more than the threshold",
        "Read single room modes with care; third octaves are less affected.",
        (
            Limit(
                0.05,
                "of the distance of two frequencies",
                "complex modes would be needed",
                CHOSEN,
                "absorbing_walls.COUPLED",
            ),
        ),
    ),
    Entry(
        "sealed-air-carries-load",
        "The sealed air carries a part of the weight, although a real room has leaks.",
        LIMITS,
        "a body ends at rest and the air adds more than the threshold to the static stiffness",
        "Give the room a 'leak', or do not quote the position at rest.",
        (Limit(0.05, "% of the weight", "less does not change a sag visibly", CHOSEN, "coupled_air.CARRIED"),),
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
            Limit(
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
            Limit(
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
        (Limit(1e-3, "of the peak velocity", "60 dB below the peak", CHOSEN, "acoustics.rooms.room_advice.DECAYED"),),
    ),
    Entry(
        "surface-not-decayed",
        "The surface still moves when the record ends.",
        LIMITS,
        "the velocity in the last 5 % of the record is more than the threshold share of its peak",
        "Simulate longer. Largest Fast levels of a single blow are hardly affected.",
        (Limit(1e-3, "of the peak velocity", "60 dB below the peak", CHOSEN, "acoustics.rooms.room_advice.DECAYED"),),
    ),
    Entry(
        "ceiling-points-coarse",
        "The points of the ceiling are too few for the highest cosines of the room.",
        LIMITS,
        "the quadrature error of the highest cosine is more than the threshold",
        "Use a finer mesh of the slab.",
        (Limit(0.05, "quadrature error", "0.4 dB of that cosine", "20 lg 1.05", "acoustics.rooms.room_advice.COARSE"),),
    ),
    Entry(
        "orders-truncated",
        "The sum over cosines ends too early.",
        LIMITS,
        "the last block of cosines adds more than the threshold share of the rms pressure",
        "Place the receiver further from the ceiling. In Python, give 'pressure' more orders.",
        (
            Limit(
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
            Limit(
                0.1,
                "% of a reverberation time",
                "0.4 dB of a standardised level",
                "10 lg 1.1",
                "acoustics.rooms.room_advice.T60_MISSED",
            ),
        ),
    ),
)
