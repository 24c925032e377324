"""Findings on damping: none at all, loss factors by frequency, unused, counted twice."""

from __future__ import annotations

from typing import Final

from femstruct.findings.entry import CHOSEN, FORBIDS, LIMITS, Entry, Limit

_UNDAMPED: Final = Limit(
    5e-5,
    "damping ratio",
    "a loss factor of 1e-4: metals alone have 1e-4 or more, structures more",
    CHOSEN,
    "loss_tables.UNDAMPED",
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
            Limit(10.0, "periods", "with a ratio of 1 % the motion has halved by then", CHOSEN, "undamped.PERIODS"),
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
            Limit(
                2.0**0.5,
                "ratio to the highest or lowest frequency",
                "half an octave",
                CHOSEN,
                "loss_tables.BEYOND",
            ),
            Limit(
                0.01, "% of a mode's elastic energy", "a part with less hardly damps it", CHOSEN, "loss_tables.STRAINED"
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
            Limit(
                0.1,
                "of the mode's loss factor",
                "0.8 dB at a resonance, 0.4 dB in a band",
                "20 lg 1.1, 10 lg 1.1",
                "loss_tables.UNUSED",
            ),
            Limit(1e-4, "loss factor", "no mode notices it", CHOSEN, "loss_tables.UNUSED_LEAST"),
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
            Limit(
                0.1,
                "loss factor",
                "third octaves of a strip were 0.6 dB off at a loss factor of 0.23, and 1.5 dB at 0.36",
                "tests/analytic/test_edge_walls.py",
                "edge_walls.STRONG",
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
            Limit(
                0.05,
                "of the loss factor at 100 Hz",
                "by radiation to one side with an efficiency of one; less is within what such numbers scatter",
                CHOSEN,
                "total_losses.RADIATED",
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
        (Limit(800.0, "kg/m^2", "the range of the formula", "ISO 12354-1, annex C", "total_losses.HEAVIEST"),),
    ),
)
