"""Findings on meshes, theories, modes, damping, and on numbers fitted to what was measured."""

from __future__ import annotations

from typing import Final

from femstruct.findings.entry import CHOSEN, FORBIDS, LIMITS, REMARK, Entry, Threshold

# ----------------------------------------------------------------------------------------------------------------------
# Findings on damping: none at all, loss factors by frequency, unused, counted twice.
# ----------------------------------------------------------------------------------------------------------------------

_UNDAMPED: Final = Threshold(
    5e-5,
    "damping ratio",
    "a loss factor of 1e-4: metals alone have 1e-4 or more, structures more",
    CHOSEN,
    "damping.UNDAMPED",
)

LOSSES: Final = (
    Entry(
        "no-damping",
        "Peaks of the frequency response are infinite or have no meaning, because modes in the band have no damping.",
        FORBIDS,
        "the damping ratio of a mode in the band is below the threshold",
        "Give the model a 'damping'. With 'damping: {from: materials}', give the materials a 'loss_factor'.",
        (_UNDAMPED,),
    ),
    Entry(
        "undamped",
        "The structure has no damping, so what is simulated goes on without decay.",
        LIMITS,
        "in a simulation of a structure of parts, damping ratios of modes are below the first threshold, and the "
        "lowest such mode has more periods in the window than the second",
        "Give the model a 'damping'. Loss factors of materials are used only with 'damping: {from: materials}'. The "
        "first impact holds without damping; what follows it, its spectra and levels do not.",
        (
            _UNDAMPED,
            Threshold(
                10.0,
                "periods",
                "with a ratio of 1 % the motion has halved by then",
                CHOSEN,
                "structure_findings.PERIODS",
            ),
        ),
        forbids="no mode has damping, and a room with one-way coupling is under the structure",
    ),
    Entry(
        "loss-beyond-table",
        "The loss factor is given by frequency, and modes lie outside of that.",
        LIMITS,
        "a mode that strains the part lies above the highest frequency of the table times the threshold, or below the "
        "lowest divided by it",
        "Give loss factors for all bands of the study, or accept the value of the nearest frequency.",
        (
            Threshold(
                2.0**0.5,
                "ratio to the highest or lowest frequency",
                "half an octave",
                CHOSEN,
                "damping.BEYOND",
            ),
            Threshold(
                0.01, "% of a mode's elastic energy", "a part with less hardly damps it", CHOSEN, "damping.STRAINED"
            ),
        ),
    ),
    Entry(
        "loss-unused",
        "Springs along edges or a foundation have a loss factor, and the damping is one law for the whole structure.",
        LIMITS,
        "by strain energy, the loss factor that is not used would raise that of a mode by more than both thresholds",
        "Write damping: {from: materials} and a loss factor for each material, or remove the one that is not used.",
        (
            Threshold(
                0.1,
                "of the mode's loss factor",
                "0.8 dB at a resonance, 0.4 dB in a band",
                "20 lg 1.1, 10 lg 1.1",
                "damping.UNUSED",
            ),
            Threshold(1e-4, "loss factor", "no mode notices it", CHOSEN, "damping.UNUSED_LEAST"),
        ),
    ),
    Entry(
        "walls-damp-much",
        "Walls at the edges of a plate damp its modes so much that a sum of real modes is inexact.",
        LIMITS,
        "the loss factor of a mode by the walls alone is at least the threshold",
        "Frequencies and decays of modes are those of complex modes, each at its own frequency. For levels near the "
        "lowest modes compare with direct responses, `femstruct frf --method direct`, which are exact at every line. "
        "Walls are taken at normal incidence: modes with several half waves along an edge lose less.",
        (
            Threshold(
                0.1,
                "loss factor",
                "third octaves of a strip were 0.6 dB off at a loss factor of 0.23, and 1.5 dB at 0.36",
                "tests/analytic/test_edge_walls.py",
                "by_frequency.STRONG",
            ),
        ),
    ),
    Entry(
        "losses-counted-twice",
        "A part has a total loss factor, and the model has losses that are in it.",
        LIMITS,
        "a loss factor is that of a laboratory or from reverberation times, and at the edges of the part are springs "
        "with losses or walls, or other plates are joined to it; or the air of a two-way room takes more than the "
        "threshold",
        "Give the part the internal loss factor of its material (0.5 to 1 % for concrete), or keep the total one and "
        "remove the losses at the edges from the model. A total cannot be divided into its parts.",
        (
            Threshold(
                0.05,
                "of the loss factor at 100 Hz",
                "by radiation to one side with an efficiency of one; less is within what such numbers scatter",
                CHOSEN,
                "loss_findings.RADIATED",
            ),
        ),
    ),
    Entry(
        "laboratory-too-heavy",
        "A plate is too heavy for the formula of its loss factor in a laboratory.",
        LIMITS,
        "'ISO 12354-1 laboratory', internal loss factor + m' / (485 sqrt f), is used for a mass per "
        "area m' above the threshold",
        "Use measured reverberation times, or the internal loss factor with edges that are modelled.",
        (Threshold(800.0, "kg/m^2", "the range of the formula", "ISO 12354-1, annex C", "loss_findings.HEAVIEST"),),
    ),
)


# ----------------------------------------------------------------------------------------------------------------------
# Findings on meshes, plate theory, modes, damping, and what depends on the modes that are left out.
# ----------------------------------------------------------------------------------------------------------------------

_STRIPS: Final = "three-dimensional solids, tests/analytic/test_plates_that_stretch.py"
_MINDLIN: Final = "estimated as of a Mindlin plate, doi:10.1115/1.4010217"

_ROUNDED: Final = "tests/end_to_end/test_structural_findings.py: a slab on springs with lines 0.1 to 1 mm apart"
MODES: Final = (
    Entry(
        "wide-ribs",
        "Ribs are wide compared with their spacing, and the plate is fastened to them along lines.",
        REMARK,
        "the clear span of the plate between ribs is shorter than the distance of their lines, so that frequencies of "
        "the plate there are too low by more than the threshold if the ribs do not turn: 1 - (clear span / distance)^2",
        "Nothing, where the ribs bend with the plate, as in the first modes of a floor. Where modes of the plate "
        "between ribs count, use plates or solids for ribs.",
        (
            Threshold(
                0.05,
                "of a frequency",
                "the bound; ribs that turn leave a third of it",
                _STRIPS,
                "rib_findings.WIDE_NOTABLE",
            ),
        ),
    ),
    Entry(
        "fewer-modes-than-usual",
        "A check describes fewer modes than it usually does, because the others did not converge.",
        LIMITS,
        "the first 30 modes of a model do not converge, and the first 10 or 3 do",
        "Nothing, where the modes that are shown are enough. Otherwise look for masses or stiffnesses in a wrong unit.",
    ),
    Entry(
        "lost-in-rounding",
        "Frequencies are uncertain, because what holds a mode is lost in the rounding of something far stiffer.",
        LIMITS,
        "the strain energy of a mode that is not rigid is so small beside the terms it is summed from that their "
        "rounding changes its frequency by more than the threshold",
        "Look for grid lines of a plate that nearly meet (points, edges of regions and joints a millimetre apart give "
        "narrow cells: let them meet or leave more room), and for a size or modulus in a wrong unit.",
        (
            Threshold(1e-3, "of a frequency", "less is below other errors", _ROUNDED, "reduction.NOTABLE"),
            Threshold(1e-2, "of a frequency", "the usual error of a mesh", _ROUNDED, "reduction.SEVERE", forbids=True),
        ),
        forbids="the frequency is uncertain by more than 1 %",
    ),
    Entry(
        "coarse-mesh",
        "The mesh has too few cells or bars for the waves at the highest frequency.",
        LIMITS,
        "a wavelength spans fewer cells or bars than the element needs",
        "Use cells or bars of the stated length.",
        (
            Threshold(
                6.0,
                "cells a bending wavelength",
                "frequencies of bfs16 and acm12 are right to about 1 %",
                CHOSEN,
                "wave_findings.CELLS_PER_WAVE",
            ),
            Threshold(
                8.0,
                "cells a bending wavelength of shells",
                "frequencies of linear cells are 2.6 % too high along their sides and 1.7 % too low along their "
                "diagonals",
                "tests/analytic/test_elements_shells.py",
                "wave_findings.CELLS",
            ),
            Threshold(
                16.0,
                "linear cells a wavelength of solids",
                "bending frequencies of hex8 are 2 % too high",
                "tests/analytic/test_solid_meshes.py",
                "wave_findings.LINEAR",
            ),
            Threshold(
                8.0,
                "quadratic cells a wavelength of solids",
                "bending frequencies of hex20 are 1.5 % too high",
                "tests/analytic/test_solid_meshes.py",
                "wave_findings.QUADRATIC",
            ),
            Threshold(
                2.0,
                "cells a bending wavelength",
                "below, the mesh cannot represent the wave",
                "sampling theorem",
                "wave_findings.NO_WAVE",
                forbids=True,
            ),
            Threshold(
                4.0,
                "bars a wavelength, cubic interpolation",
                "frequencies are right to 0.4 %",
                "tests/analytic/test_frame_waves.py",
                "wave_findings.CUBIC",
            ),
            Threshold(
                13.0,
                "bars a wavelength, linear interpolation",
                "frequencies are right to 1 %",
                "tests/analytic/test_frame_waves.py",
                "wave_findings.LINEAR_BARS",
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
            Threshold(
                0.005,
                "% of the first frequency",
                "less is below the error of a mesh",
                _MINDLIN,
                "wave_findings.NOTABLE_SHEAR",
            ),
            Threshold(
                0.5,
                "% of the first frequency",
                "it is no longer a plate",
                CHOSEN,
                "wave_findings.GROSS_SHEAR",
                forbids=True,
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
            Threshold(
                0.1,
                "% of the deflection",
                "without shear a frequency is 5 % too high",
                "waves in layers, tests/analytic/test_laminates.py",
                "wave_findings.SHEARED",
            ),
            Threshold(
                1.0 / 6.0,
                "% of the deflection",
                "a frequency is 10 % too high",
                "waves in layers, tests/analytic/test_laminates.py",
                "wave_findings.GROSSLY_SHEARED",
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
            Threshold(
                0.01, "difference of the loss factors", "damping is rarely known better", CHOSEN, "loss_findings.APART"
            ),
            Threshold(
                1.5,
                "ratio of the loss factors",
                "3.5 dB at a resonance, 1.8 dB in a band, if all is shear",
                "20 lg 1.5, 10 lg 1.5",
                "loss_findings.TIMES",
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
            Threshold(
                10.0,
                "thicknesses, bending wavelength",
                "shear shortens waves of a frequency by about 3 %, and lowers a mode of this wavelength by more "
                "than 5 %",
                "Mindlin plate, tests/analytic/test_shear_left_out.py",
                "wave_findings.SLENDER",
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
        (Threshold(0.9, "% of the mass", "usual in response analysis by modes", CHOSEN, "reduction._CAPTURED"),),
    ),
    *LOSSES,
    Entry(
        "mode-damping-lost",
        "A damping given for one mode is unused, because no mode of this case has its shape.",
        LIMITS,
        "no mode of the case reaches the MAC below with a baseline mode that has damping of its own",
        "Give the case its own 'damping'.",
        (
            Threshold(
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
            Threshold(
                0.05,
                "of the largest value",
                "the peak of an oscillator is 5 % too low where its nearest line is a sixth of its half-power "
                "bandwidth away",
                CHOSEN,
                "steady.MISSED",
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
        (
            Threshold(
                0.05, "% of the peak", "more changes a figure that is quoted", CHOSEN, "recorded_channels.CONVERGED"
            ),
        ),
    ),
    Entry(
        "pressure-cut-off",
        "A low-passed pressure still changes when the window ends.",
        LIMITS,
        "its peak is another one by more than the threshold if there were silence after the window. What follows the "
        "window is computed for motions and forces; for pressures it is not",
        "Do not quote the peak. Simulate longer, until the room is quiet.",
        (Threshold(0.01, "% of the peak", "less is not seen in decibels", CHOSEN, "recorded_channels.CUT_OFF"),),
    ),
    Entry(
        "fatigue-coarsely-sampled",
        "Samples miss the peaks of the history whose cycles are counted.",
        LIMITS,
        "the largest sample is below the peak by more than the threshold share",
        "Raise 'time: sampling'.",
        (Threshold(0.02, "% of the peak", "6 % of the damage with a slope of 3", CHOSEN, "recorded_channels.MISSED"),),
    ),
    Entry(
        "damage-not-converged",
        "Damage of fatigue rests on a peak that changes with the modes left out or with the mesh.",
        LIMITS,
        "what is counted has the finding peak-not-converged or stress-uneven; or without residual vectors its largest "
        "range R differs by more than the threshold, or its damage, which goes as R^slope, by more than 1 - 0.95^slope",
        "Do not quote the damage. Compute more modes, and a finer mesh where the stress is uneven. The low-pass of "
        "'peaks' filters peaks, not what is counted.",
        (
            Threshold(
                0.05,
                "% of the largest range",
                "with a slope of 3, 14 % of the damage",
                CHOSEN,
                "recorded_channels.CONVERGED",
            ),
        ),
    ),
    Entry(
        "random-damage-estimated",
        "Damage under a random excitation is that of Dirlik's density of ranges.",
        REMARK,
        "'fatigue' has an S-N line and 'under'",
        "Where it matters, simulate a history with this spectrum as a load and count its cycles.",
        (
            Threshold(
                0.2,
                "% of the damage",
                "Dirlik's damage is too low by up to this, for a spectrum with peaks far apart and a slope of 5",
                "tests/analytic/test_fatigue.py",
                "responses.DIRLIK_LOW",
            ),
        ),
    ),
    Entry(
        "change-not-converged",
        "The change of a peak against the baseline depends on the modes that are left out.",
        LIMITS,
        "the change with and without residual vectors differs by more than the threshold",
        "Do not quote the change. Use 'peaks: {lowpass: F}' with F below the last mode.",
        (
            Threshold(
                5.0, "percentage points", "more changes a figure that is quoted", CHOSEN, "recorded_channels.CHANGED"
            ),
        ),
    ),
)


# ----------------------------------------------------------------------------------------------------------------------
# Findings on numbers that are fitted to what was measured.
# ----------------------------------------------------------------------------------------------------------------------

FITS: Final = (
    Entry(
        "poor-fit",
        "The best fit leaves a large part of the measured history unexplained.",
        LIMITS,
        "the rms of the residuals is more than the threshold share of that of the measured history",
        "Try another contact law, '--delay', or a start nearer to the minimum.",
        (
            Threshold(0.05, "% of the measured rms", "a good fit leaves less", CHOSEN, "fit.POOR"),
            Threshold(
                0.2,
                "% of it, if correlated",
                "the law is another one",
                CHOSEN,
                "fit.WRONG",
                forbids=True,
            ),
        ),
        forbids="residuals of more than 20 % are correlated, so that they are no noise",
    ),
    Entry(
        "residuals-not-noise",
        "The residuals of the fit are correlated, so the confidence intervals are too narrow.",
        LIMITS,
        "the correlation of neighbouring residuals is more than that of white noise",
        "Widen the intervals by the stated factor, or try another contact law.",
        (
            Threshold(
                4.0,
                "standard deviations of the correlation of white noise",
                "chance exceeds it once in 31 000",
                "normal distribution",
                "fit.WHITE",
            ),
        ),
    ),
    Entry(
        "fitted-zero",
        "The best value of a parameter is zero, the end of its range.",
        REMARK,
        "the fit ends at 0",
        "Remove the parameter, or quote the value that the message states with 'at most'.",
    ),
    Entry(
        "parameter-open",
        "The measurement does not determine the parameter.",
        LIMITS,
        "half the confidence interval is more than the threshold share of the value",
        "Fix the parameter, or measure a quantity that depends on it.",
        (Threshold(0.5, "% of the value", "not even the first digit is known", CHOSEN, "fit.OPEN"),),
    ),
    Entry(
        "fit-beyond-scatter",
        "The residuals of a set of data are larger than its scatter.",
        LIMITS,
        "their sum of squares, over the scatter, is more than chance makes it",
        "State a scatter that holds mounting and repetition, too; remove data of another state; free what is wrong in "
        "the model; give frequencies a column 'mode', as one may be missing among them.",
        (
            Threshold(
                4.0,
                "standard deviations of chi-squared",
                "chance hardly exceeds it",
                "normal distribution",
                "fit.EXCEEDED",
            ),
            Threshold(5.0, "times the scatter", "the model is another one", CHOSEN, "fit.FAR", forbids=True),
        ),
        forbids="the residuals are more than 5 times the scatter",
    ),
    Entry(
        "parameters-not-distinguished",
        "The data do not distinguish some parameters: they determine only a combination of them.",
        LIMITS,
        "a combination of changes alters nothing in the data, or so little that half its interval is more than the "
        "threshold",
        "Use what is determined, fix one of the parameters at a known value, or measure what distinguishes them: the "
        "mass, another mode, a force.",
        (
            Threshold(
                0.5,
                "% along the combination",
                "not even the first digit is known",
                CHOSEN,
                "fit.HARDLY",
            ),
        ),
    ),
    Entry(
        "parameter-at-bound",
        "The best value of a parameter is at a bound that was given.",
        LIMITS,
        "the fit ends at a bound of --fit",
        "Widen the bound, or find what else in the model asks for a value beyond it.",
    ),
    Entry(
        "mode-pair-lost",
        "A measured mode has no mode of the model of its shape.",
        LIMITS,
        "the largest MAC, among near-equal frequencies that with their space, is less than the threshold",
        "Start nearer to the data, look at 'femstruct mac', or remove the mode from the file.",
        (Threshold(0.6, "MAC", "the same mode shares more than half of its motion", CHOSEN, "measured_data.LIKE"),),
    ),
    Entry(
        "mode-pair-swapped",
        "A measured mode has another partner at the end of the fit than at its start.",
        REMARK,
        "the number of the mode that is most alike changed on the way",
        "Check the pairs that the table shows; they follow the shapes, not the order.",
    ),
    Entry(
        "pairs-by-order",
        "Measured frequencies without shapes are compared with the modes of the model in their order.",
        LIMITS,
        "a table of frequencies has no column of mode numbers",
        "Add a column 'mode' with the numbers that 'femstruct modes' prints, or measure shapes.",
    ),
)
