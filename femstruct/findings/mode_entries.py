"""Findings on meshes, plate theory, modes, damping, and what depends on the modes that are left out."""

from __future__ import annotations

from typing import Final

from femstruct.findings.entry import CHOSEN, FORBIDS, LIMITS, REMARK, Entry, Limit
from femstruct.findings.loss_entries import LOSSES

_STRIPS: Final = "three-dimensional solids, tests/analytic/test_plates_that_stretch.py"
_MINDLIN: Final = "estimated as of a Mindlin plate, doi:10.1115/1.4010217"

MODES: Final = (
    Entry(
        "wide-ribs",
        "Ribs are wide compared with their spacing, and the plate is fastened to them along lines.",
        REMARK,
        "the clear span of the plate between ribs is shorter than the distance of their lines, so that frequencies of "
        "the plate there are too low by more than the threshold if the ribs do not turn: 1 - (clear span / distance)^2",
        "Nothing, where the ribs bend with the plate, as in the first modes of a floor. Where modes of the plate "
        "between ribs count, use plates or solids for ribs.",
        (Limit(0.05, "of a frequency", "the bound; ribs that turn leave a third of it", _STRIPS, "wide_ribs.NOTABLE"),),
    ),
    Entry(
        "fewer-modes-than-usual",
        "A check describes fewer modes than it usually does, because the others did not converge.",
        LIMITS,
        "the first 30 modes of a model do not converge, and the first 10 or 3 do",
        "Nothing, where the modes that are shown are enough. Otherwise look for masses or stiffnesses in a wrong unit.",
    ),
    Entry(
        "coarse-mesh",
        "The mesh has too few cells or bars for the waves at the highest frequency.",
        LIMITS,
        "a wavelength spans fewer cells or bars than the element needs",
        "Use cells or bars of the stated length.",
        (
            Limit(
                6.0,
                "cells a bending wavelength",
                "frequencies of bfs16 and acm12 are right to about 1 %",
                CHOSEN,
                "waves.CELLS_PER_WAVE",
            ),
            Limit(
                8.0,
                "cells a bending wavelength of shells",
                "frequencies of linear cells are 2.6 % too high along their sides and 1.7 % too low along their "
                "diagonals",
                "tests/analytic/test_elements_shells.py",
                "shell_waves.CELLS",
            ),
            Limit(
                16.0,
                "linear cells a wavelength of solids",
                "bending frequencies of hex8 are 2 % too high",
                "tests/analytic/test_solid_meshes.py",
                "solid_waves.LINEAR",
            ),
            Limit(
                8.0,
                "quadratic cells a wavelength of solids",
                "bending frequencies of hex20 are 1.5 % too high",
                "tests/analytic/test_solid_meshes.py",
                "solid_waves.QUADRATIC",
            ),
            Limit(
                2.0,
                "cells a bending wavelength",
                "below, the mesh cannot represent the wave",
                "sampling theorem",
                "waves.NO_WAVE",
                forbids=True,
            ),
            Limit(
                4.0,
                "bars a wavelength, cubic interpolation",
                "frequencies are right to 0.4 %",
                "tests/analytic/test_frame_waves.py",
                "frame_waves.CUBIC",
            ),
            Limit(
                13.0,
                "bars a wavelength, linear interpolation",
                "frequencies are right to 1 %",
                "tests/analytic/test_frame_waves.py",
                "frame_waves.LINEAR",
            ),
        ),
        forbids="a bending wavelength of a plate spans fewer than 2 cells",
    ),
    Entry(
        "thick-plate",
        "The plate is so thick that its first frequency is too high without shear.",
        LIMITS,
        "the estimated error of the first frequency, for shear and rotary inertia, is more than the threshold",
        "Use 'type: slab', which shears. Or correct the first frequency by the error; higher ones are further off.",
        (
            Limit(
                0.005, "% of the first frequency", "less is below the error of a mesh", _MINDLIN, "theory.NOTABLE_SHEAR"
            ),
            Limit(
                0.5, "% of the first frequency", "it is no longer a plate", CHOSEN, "theory.GROSS_SHEAR", forbids=True
            ),
        ),
        forbids="the first frequency is more than 50 % too high",
    ),
    Entry(
        "layers-shear",
        "The plate is made of layers with much shear at the highest frequency, and plates have no shear.",
        LIMITS,
        "in a bending wave of the highest frequency, shear would make up more than the threshold share of the "
        "deflection",
        "Use 'type: slab' or 'shell', whose elements shear, or ask for modes up to the stated frequency only.",
        (
            Limit(
                0.1,
                "% of the deflection",
                "without shear a frequency is 5 % too high",
                "waves in layers, tests/analytic/test_laminates.py",
                "waves.SHEARED",
            ),
            Limit(
                1.0 / 6.0,
                "% of the deflection",
                "a frequency is 10 % too high",
                "waves in layers, tests/analytic/test_laminates.py",
                "waves.GROSSLY_SHEARED",
                forbids=True,
            ),
        ),
        forbids="frequencies are more than 10 % too high",
    ),
    Entry(
        "layers-lose-in-shear",
        "The layers of a thin plate have another loss factor in shear, and modes have that of bending.",
        LIMITS,
        "the part is a 'type: plate', and the two loss factors at 100 Hz differ by more than both thresholds",
        "Use 'type: slab' or 'shell': each layer loses there by its own share of stretching, bending and shear.",
        (
            Limit(
                0.01, "difference of the loss factors", "damping is rarely known better", CHOSEN, "layer_losses.APART"
            ),
            Limit(
                1.5,
                "ratio of the loss factors",
                "3.5 dB at a resonance, 1.8 dB in a band, if all is shear",
                "20 lg 1.5, 10 lg 1.5",
                "layer_losses.TIMES",
            ),
        ),
    ),
    Entry(
        "unsymmetric-layers",
        "The plate has layers that are not symmetric, so stretching it would also bend it.",
        LIMITS,
        "the lay-up is another one from below than from above, so its neutral surface is not the mid-surface",
        "Nothing where the plate is free to stretch: its bending is right. Where ribs, folds or supports hold it in "
        "its plane, use 'type: slab', whose elements couple stretching and bending.",
    ),
    Entry(
        "thick-for-short-waves",
        "The plate is thick for the short waves at the highest frequency.",
        LIMITS,
        "the bending wavelength is shorter than a number of thicknesses",
        "Read the highest bands as a lower bound (the message states the missing level), or use 'type: slab'.",
        (
            Limit(
                10.0,
                "thicknesses, bending wavelength",
                "shear shortens waves of a frequency by about 3 %, and lowers a mode of this wavelength by more "
                "than 5 %",
                "Mindlin plate, tests/analytic/test_shear_left_out.py",
                "waves.SLENDER",
            ),
        ),
    ),
    Entry(
        "twist-defect",
        "The element hermite12 is too stiff in twist at any mesh.",
        LIMITS,
        "a plate uses hermite12",
        "Use bfs16.",
    ),
    Entry(
        "no-modes",
        "The structure has no mode in the range that was asked for.",
        FORBIDS,
        "no natural frequency lies below the given one",
        "Ask for more modes; a plain number is in Hz.",
    ),
    Entry(
        "modal-mass-low",
        "The modes carry only a part of the mass.",
        REMARK,
        "the effective modal mass in a direction is less than the threshold share of the whole",
        "Ask for more modes, if the motion in that direction is of interest. Mass where supports fix it is in no mode.",
        (Limit(0.9, "% of the mass", "usual in response analysis by modes", CHOSEN, "reduction._CAPTURED"),),
    ),
    *LOSSES,
    Entry(
        "mode-damping-lost",
        "A damping given for one mode is unused, because no mode of this case has its shape.",
        LIMITS,
        "no mode of the case reaches the MAC below with a baseline mode that has damping of its own",
        "Give the case its own 'damping'.",
        (
            Limit(
                0.5,
                "MAC (likeness of two shapes, 0 to 1)",
                "below, the shapes are more different than similar",
                CHOSEN,
                "damping._MIN_MAC",
            ),
        ),
    ),
    Entry(
        "mode-damping-unused",
        "The damping of a mode is unused, because the mode lies above those that were computed.",
        REMARK,
        "damping is given for a mode above the last one",
        "Ask for more modes, or remove this mode from the damping of the model.",
    ),
    Entry(
        "peak-between-lines",
        "The lines of a frequency response are too far apart for its highest peak.",
        LIMITS,
        "the largest value between lines is above the largest on a line",
        "Use a smaller 'step' ('--step'). Sweeps and designs have the largest value itself, not that of a line.",
        (
            Limit(
                0.05,
                "of the largest value",
                "the peak of an oscillator is 5 % too low where its nearest line is a sixth of its half-power "
                "bandwidth away",
                CHOSEN,
                "between_lines.MISSED",
            ),
        ),
    ),
    Entry(
        "vibration-beyond-modes",
        "Modes are missing in the band of a harmonic or random excitation.",
        LIMITS,
        "the highest frequency of 'vibration' is above that to which the modes are complete",
        "Ask for modes up to the end of the band or more, or end the band below the last mode.",
    ),
    Entry(
        "accuracy-not-reached",
        "The result changes with the number of modes by more than the accuracy asked for.",
        FORBIDS,
        "the last two sets of modes differ by more than 'accuracy: within'",
        "Give 'accuracy' a higher 'up_to', or ask for less accuracy.",
    ),
    Entry(
        "peak-not-converged",
        "A peak depends on the modes that are left out.",
        LIMITS,
        "residual vectors change the peak by more than the threshold",
        "Do not quote the peak. Use 'peaks: {lowpass: F}' with F below the last mode.",
        (Limit(0.05, "% of the peak", "more changes a figure that is quoted", CHOSEN, "peaks.CONVERGED"),),
    ),
    Entry(
        "pressure-cut-off",
        "A low-passed pressure still changes when the window ends.",
        LIMITS,
        "its peak is another one by more than the threshold if there were silence after the window. What follows the "
        "window is computed for motions and forces; for pressures it is not",
        "Do not quote the peak. Simulate longer, until the room is quiet.",
        (Limit(0.01, "% of the peak", "less is not seen in decibels", CHOSEN, "peaks.CUT_OFF"),),
    ),
    Entry(
        "fatigue-coarsely-sampled",
        "Samples miss the peaks of the history whose cycles are counted.",
        LIMITS,
        "the largest sample is below the peak by more than the threshold share",
        "Raise 'time: sampling'.",
        (Limit(0.02, "% of the peak", "6 % of the damage with a slope of 3", CHOSEN, "peaks.MISSED"),),
    ),
    Entry(
        "damage-not-converged",
        "Damage of fatigue rests on a peak that changes with the modes left out or with the mesh.",
        LIMITS,
        "what is counted has the finding peak-not-converged or stress-uneven; or without residual vectors its largest "
        "range R differs by more than the threshold, or its damage, which goes as R^slope, by more than 1 - 0.95^slope",
        "Do not quote the damage. Compute more modes, and a finer mesh where the stress is uneven. The low-pass of "
        "'peaks' filters peaks, not what is counted.",
        (Limit(0.05, "% of the largest range", "with a slope of 3, 14 % of the damage", CHOSEN, "peaks.CONVERGED"),),
    ),
    Entry(
        "random-damage-estimated",
        "Damage under a random excitation is that of Dirlik's density of ranges.",
        REMARK,
        "'fatigue' has an S-N line and 'under'",
        "Where it matters, simulate a history with this spectrum as a load and count its cycles.",
        (
            Limit(
                0.2,
                "% of the damage",
                "Dirlik's damage is too low by up to this, for a spectrum with peaks far apart and a slope of 5",
                "tests/analytic/test_fatigue.py",
                "vibrations.DIRLIK_LOW",
            ),
        ),
    ),
    Entry(
        "change-not-converged",
        "The change of a peak against the baseline depends on the modes that are left out.",
        LIMITS,
        "the change with and without residual vectors differs by more than the threshold",
        "Do not quote the change. Use 'peaks: {lowpass: F}' with F below the last mode.",
        (Limit(5.0, "percentage points", "more changes a figure that is quoted", CHOSEN, "peaks.CHANGED"),),
    ),
)
