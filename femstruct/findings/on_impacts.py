"""Findings on simulated impacts, on standard and measured sources, and on a run as a whole."""

from __future__ import annotations

from typing import Final

from femstruct.findings.entry import CHOSEN, FORBIDS, LIMITS, REMARK, Entry, Threshold

# ----------------------------------------------------------------------------------------------------------------------
# Findings on simulated impacts: numerical errors, contacts, blows and loads.
# ----------------------------------------------------------------------------------------------------------------------

IMPACT: Final = (
    Entry(
        "energy-drift",
        "The energy balance does not close.",
        LIMITS,
        "the residual of the energy balance is more than the threshold share of the energy put in",
        "Shorten the window. In Python, give 'Clock' a smaller tolerance.",
        (
            Threshold(
                1e-8,
                "of the energy put in",
                "a resolved run stays below",
                CHOSEN,
                "blow_by_blow.ENERGY_DRIFT",
            ),
            Threshold(
                1e-6,
                "of the energy put in",
                "100 times what is allowed",
                CHOSEN,
                "blow_by_blow.NOT_TRUSTED",
                forbids=True,
            ),
        ),
        forbids="the residual is more than 1e-6 of the energy put in",
    ),
    Entry(
        "stress-uneven",
        "The largest stress of a part depends on the mesh.",
        LIMITS,
        "at the most stressed place of a plate, shell or solid, the cells that meet there, or the next places, differ "
        "by more than the threshold; bars have `coarse-mesh` alone, since their section forces are exact under loads "
        "at their ends and under weight",
        "Use a finer mesh. If the stress then grows, it is infinite in the model: put a force or support on a set of "
        "nodes or on a patch, and at a re-entrant corner or a clamped edge quote the stress one thickness away.",
        (
            Threshold(
                0.2,
                "of the largest stress",
                "a smooth stress changes by less from cell to cell",
                CHOSEN,
                "recorded_channels.UNEVEN",
            ),
        ),
    ),
    Entry(
        "stress-of-orthotropic",
        "The equivalent stress of an orthotropic part is no measure of its strength.",
        LIMITS,
        "the stress of von Mises is recorded or printed of a part with an orthotropic material",
        "Judge the stresses along the axes of the material, each beside its own strength: 'frf --response PART.stress' "
        "has its components xx, yy and xy. The stress of von Mises supposes a metal, as strong in all directions.",
    ),
    Entry(
        "contact-closed-at-end",
        "A contact is still closed when the window ends.",
        LIMITS,
        "the window ends while a contact is closed; not where bodies have come to rest on their contacts under gravity",
        "Simulate longer.",
    ),
    Entry(
        "contact-unresolved",
        "The peak force of a contact has a numerical error that is too large.",
        LIMITS,
        "the estimated error of a peak force is above the first threshold, or above the second where 'accuracy' is "
        "asked "
        "for; or a contact is shorter than the last threshold and the energy balance does not close ('energy-drift')",
        "Shorten the window, or study the scatter of many runs. In Python, give 'Clock' a smaller tolerance.",
        (
            Threshold(
                1e-3, "of the peak force", "figures are quoted to three digits", CHOSEN, "numerical_error.UNRESOLVED"
            ),
            Threshold(
                1e-2,
                "of the peak force",
                "more than 1 % is visible",
                CHOSEN,
                "numerical_error.NOT_TRUSTED",
                forbids=True,
            ),
            Threshold(
                0.1,
                "of 'accuracy: within', where that is less",
                "the rest of the accuracy is for the modes",
                CHOSEN,
                "numerical_error.ASKED",
            ),
            Threshold(
                100.0,
                "event resolutions (shortest time steps) in the shortest contact",
                "peaks are then right to 1e-3",
                "(pi / n)^2 / 2, and 3.3 / n^2.5 of Hertz",
                "blow_by_blow.TICKS_PER_CONTACT",
            ),
        ),
        forbids="the error of the peak is more than 1 %",
    ),
    Entry(
        "end-unresolved",
        "The velocity at the end of the window has a numerical error that is too large.",
        LIMITS,
        "the estimated error is more than the threshold share of the largest speed",
        "Do not quote the end state. Each collision multiplies the errors before it; shorten the window.",
        (Threshold(1e-2, "of the largest speed", "more than 1 % is visible", CHOSEN, "numerical_error.NOT_TRUSTED"),),
    ),
    Entry(
        "beyond-table",
        "The contact was compressed beyond the last point of its measured table.",
        FORBIDS,
        "the largest indentation is more than the last one of the table; the last slope is continued",
        "Measure further, or use a smaller drop height.",
    ),
    Entry(
        "beyond-checked",
        "The contact was compressed beyond the depth to which its own law was checked.",
        LIMITS,
        "the largest indentation is more than 'deepest' of a law given as Python functions",
        "Make the law with a larger 'deepest', so that it is checked there too.",
    ),
    Entry(
        "restitution-missed",
        "The contact law does not give the restitution that was asked for.",
        LIMITS,
        "the law of Lankarani and Nikravesh misses the restitution by more than the threshold",
        "Use 'hunt-crossley', which gives it.",
        (
            Threshold(
                0.05,
                "of restitution",
                "it is missed by more than this where less than 0.79 is asked for",
                "doi:10.1115/1.2912617, integrated",
                "law.RESTITUTION_MISSED",
            ),
        ),
    ),
    Entry(
        "structure-not-decayed",
        "The structure still vibrates when the window ends.",
        LIMITS,
        "the energy at the end is more than the threshold share of the largest",
        "Simulate longer, if spectra are of interest. Peaks of motions and forces are not affected.",
        (Threshold(1e-2, "of the largest energy", "a decay by 20 dB", CHOSEN, "blow_by_blow.NOT_DECAYED"),),
    ),
    Entry(
        "contact-coarsely-sampled",
        "The contact is so short that samples of its force miss the peak.",
        LIMITS,
        "the shortest contact has fewer samples than the first threshold, or the largest sample of a recorded contact "
        "force is lower than the peak by more than the second",
        "Sample faster. The table of contacts has the true peak, and so have peaks and limits.",
        (
            Threshold(
                10.0,
                "samples a contact",
                "the peak is missed by 1 %",
                "half sine between two samples",
                "blow_by_blow.SAMPLES_PER_CONTACT",
            ),
            Threshold(0.05, "% of the peak", "more is visible", CHOSEN, "impact_findings.PEAK_MISSED"),
        ),
    ),
    Entry(
        "motion-coarsely-sampled",
        "The motion is sampled too coarsely for what vibrates in it.",
        LIMITS,
        "of histories and sound: the last mode has fewer samples in a period than the first threshold, a history "
        "misses "
        "its peak by more than the fourth, or modes above half the sampling have more than the fifth of an "
        "acceleration. "
        "Of peaks: the finer grid on which they are found has fewer samples than the second",
        "Sample faster. Peaks and limits are found on a finer grid and hold; histories, spectra and sound have the "
        "samples of the study.",
        (
            Threshold(
                2.0,
                "samples in a period of the last mode",
                "a vibration with fewer shows at a lower frequency",
                "doi:10.1109/JRPROC.1949.232969",
                "resampled.FOLDED",
            ),
            Threshold(
                16.0,
                "samples in a period of the last mode or pulse, on the finer grid for peaks",
                "with fewer, peaks are more than 1.9 % low",
                "(pi / 16)^2 / 2",
                "resampled.ENOUGH",
            ),
            Threshold(
                8.0,
                "samples in a period of a pulse, on the finer grid for peaks",
                "with fewer, peaks may be more than 8 % low",
                "(pi / 8)^2 / 2",
                "impact_findings.FEW",
                forbids=True,
            ),
            Threshold(
                0.05,
                "% of a peak that a history misses",
                "more is visible",
                CHOSEN,
                "impact_findings.RECORDED_PEAK_MISSED",
            ),
            Threshold(
                0.05,
                "% of the rms of an acceleration",
                "less changes the rms by 0.1 %",
                "0.05^2 / 2",
                "impact_findings.ALIASED",
            ),
        ),
        forbids="sound is computed from fewer than 2 samples in a period of the last mode, or the finer grid for peaks "
        "does not fit into memory: peaks are then blank or lower bounds",
    ),
    Entry(
        "contact-beyond-modes",
        "The contact force contains frequencies above the last mode.",
        LIMITS,
        "more than the threshold share of the energy of the force spectrum lies above the last mode",
        "Ask for more modes. Accelerations above the last mode are too low.",
        (
            Threshold(
                0.01, "% of the force spectrum", "a small part of what is excited", CHOSEN, "impact_findings.CONTENT"
            ),
        ),
    ),
    Entry(
        "force-beyond-modes",
        "A contact force depends on the modes that are left out.",
        LIMITS,
        "the force has the finding contact-beyond-modes, and its peak differs by more than the threshold from that of "
        "the same blow on the infinite plate that is struck; on other parts, from that without residual vectors",
        "Do not quote the force and the rebound. Compute more modes, until both numbers agree.",
        (
            Threshold(
                0.05, "% of the peak", "more changes a figure that is quoted", CHOSEN, "recorded_channels.CONVERGED"
            ),
        ),
    ),
    Entry(
        "preloads-add",
        "A link with a preload pushes a body whose contact has a preload, too.",
        LIMITS,
        "a link without release_at and a contact, both with a preload, act on one body",
        "The preload of a contact is in balance with what presses it; that of a link is not. Remove the preload of a "
        "link that presses the contact, or give it a release_at.",
    ),
    Entry(
        "blow-before-rest",
        "A blow comes before the structure is at rest again.",
        REMARK,
        "the energy that is left of a blow is more than the threshold share of its largest",
        "Increase 'every', if single blows are of interest.",
        (Threshold(1e-2, "of the largest energy", "a decay by 20 dB", CHOSEN, "blow_by_blow.AT_REST"),),
    ),
    Entry(
        "lifted-in-contact",
        "The body is lifted for the next blow while its contact is closed.",
        LIMITS,
        "a contact carries a force when the body is lifted; not where the body lies still and the force is its weight",
        "Increase 'every'.",
    ),
    Entry(
        "blows-left-out",
        "The window is too short for all blows.",
        LIMITS,
        "blows begin after the end of the window",
        "Simulate longer, or ask for fewer blows.",
    ),
    Entry(
        "load-cut",
        "A part of the load lies outside the window.",
        LIMITS,
        "more than the threshold share of the impulse lies before t = 0 or after the end",
        "Shift the times of the load, or simulate longer.",
        (Threshold(0.01, "% of the impulse", "less is rounding of a measured record", CHOSEN, "impact_findings.CUT"),),
        forbids="99 % of the load lies outside",
    ),
    Entry(
        "load-coarsely-sampled",
        "The load is so short that recorded histories and spectra miss its effect.",
        LIMITS,
        "the load has fewer samples than needed",
        "Sample at the stated frequency.",
        (
            Threshold(
                10.0,
                "samples a load",
                "the peak of a half sine is then missed by 1 %",
                "half sine between two samples",
                "study_findings.SAMPLES_OF_A_LOAD",
            ),
        ),
    ),
    Entry(
        "high-drop",
        "The drop height is larger than in usual tests.",
        LIMITS,
        "a body falls from more than the threshold",
        "Check the unit, which may be mm. Air drag is not modelled.",
        (Threshold(10.0, "m", "contact laws are measured at some m/s", CHOSEN, "structure_findings.HIGH_DROP"),),
    ),
    Entry(
        "fast-body",
        "The impact speed is higher than in usual tests.",
        LIMITS,
        "a body is faster than the threshold at the start",
        "Check the unit, which may be mm/s.",
        (Threshold(50.0, "m/s", "contact laws are measured at some m/s", CHOSEN, "structure_findings.FAST"),),
    ),
    Entry(
        "failed",
        "A run of a batch has no result.",
        FORBIDS,
        "the time integration of a run of the batch engine stopped; the message states why",
        "In Python, look at run number i alone with 'simulate(basis, batch.scene(i), clock)'.",
    ),
)


# ----------------------------------------------------------------------------------------------------------------------
# Findings on sources that were measured by themselves, and on coverings of floors.
# ----------------------------------------------------------------------------------------------------------------------

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
            Threshold(
                1.0,
                "dB between the least and the largest power of a band",
                "less is within what measurements of sources repeat",
                CHOSEN,
                "measured_sources.OPEN_DB",
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
            Threshold(
                1.0,
                "dB less force of the hammers than on a rigid floor: up to it a floor is heavy, beyond it light",
                "a reduction is a ratio of forces on a floor of far lower mobility than a hammer",
                CHOSEN,
                "measured_sources.HEAVY_DB",
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
            Threshold(
                1.0,
                "dB of the force",
                "less is within what two steps differ by",
                "mass of foot and shank, 6.1 % of 75 kg (Winter), as the stiffest foot",
                "measured_sources.TAKEN_DB",
            ),
        ),
    ),
)


# ----------------------------------------------------------------------------------------------------------------------
# Findings on a run as a whole, and on what is asked of recorded histories.
# ----------------------------------------------------------------------------------------------------------------------

STUDY: Final = (
    Entry(
        "interrupted",
        "The run was interrupted, so cases are missing.",
        FORBIDS,
        "Ctrl-C or a signal ended the run after the baseline; exit code 130",
        "Run again.",
    ),
    Entry(
        "spectrum-beyond-modes",
        "A shock response spectrum is asked for beyond the modes.",
        LIMITS,
        "the modes are complete below the end of the band of a shock response spectrum only",
        "Compute modes up to the end of the band, or do not quote the spectrum above the last mode.",
    ),
    Entry(
        "evaluation-not-converged",
        "A shock response spectrum or a weighted vibration depends on the modes that are left out.",
        LIMITS,
        "residual vectors change a number of it by more than the threshold, or it is at a frequency beyond the modes; "
        "where contacts reach beyond the modes, also what half of the residual vectors change, and twice the threshold "
        "what all change, in the contact forces too, and what the rebound of a force with force-beyond-modes changes",
        "Do not quote the numbers with '?'. Compute more modes.",
        (
            Threshold(
                0.05, "% of the number", "more changes a figure that is quoted", CHOSEN, "recorded_channels.CONVERGED"
            ),
        ),
    ),
    Entry(
        "perception-beyond-modes",
        "The modes end below the highest frequency at which people feel vibration.",
        LIMITS,
        "the modes are complete below the threshold only; vibration above them is missing in what is weighted",
        "Compute modes up to the threshold or more. Where nothing excites vibration above the last mode, the numbers "
        "hold.",
        (
            Threshold(
                80.0,
                "Hz",
                "upper end of the range that ISO 2631 and DIN 4150-2 judge",
                "ISO 2631-2:2003, title; DIN 4150-2:1999",
                "perception.FELT_HZ",
            ),
        ),
    ),
)
