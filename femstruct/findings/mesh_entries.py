"""Findings on meshes from files."""

from __future__ import annotations

from math import radians
from typing import Final

from femstruct.findings.entry import CHOSEN, LIMITS, REMARK, Entry, Limit

_MEASURED: Final = "tests on plates, beams and a twisted strip, femstruct/elements/quality.py"
_FIVE: Final = "frequencies err five times as much as with squares"
MESHES: Final = (
    Entry(
        "mesh-in-other-units",
        "The mesh is far too large, too small or too heavy, or its cells do not fit its thickness.",
        LIMITS,
        "the size of the mesh, its mass, or a typical side of a cell over the thickness lies outside the thresholds",
        "Give the unit of length of the file: 'scale: mm'. Where the size is right, check the thickness.",
        (
            Limit(200.0, "m, size of a part", "a large building", CHOSEN, "unit_slips.LARGEST"),
            Limit(2e-3, "m, least size of a solid", "a chip", CHOSEN, "unit_slips.SMALLEST"),
            Limit(1e7, "kg of a solid", "a block of concrete of 16 m a side", CHOSEN, "unit_slips.HEAVIEST"),
            Limit(5e3, "kg/m^2, thickness from the file", "2 m of concrete", CHOSEN, "unit_slips.HEAVIEST_SHELL"),
            Limit(2e4, "kg of stated masses per size^3", "metal all through has 22600", CHOSEN, "attachments.HEAVIEST"),
            Limit(200.0, "times the thickness", "sheet of 0.5 mm in 50 mm cells has 100", CHOSEN, "unit_slips.WIDEST"),
            Limit(0.05, "times, least", "a wall of 200 mm in 20 mm cells has 0.1", CHOSEN, "unit_slips.NARROWEST"),
        ),
    ),
    Entry(
        "bad-cells",
        "Some cells of the mesh have a shape that costs accuracy.",
        LIMITS,
        "an angle, the warp or the aspect of a cell is beyond a threshold",
        "Mesh the places that the message names more evenly. A few such cells away from what matters do no harm.",
        (
            Limit(radians(30.0), "rad, sharpest of a quadrilateral", _FIVE, _MEASURED, "quality.SHARPEST"),
            Limit(radians(150.0), "rad, bluntest of a quadrilateral", _FIVE, _MEASURED, "quality.BLUNTEST[4]"),
            Limit(
                radians(120.0), "rad, bluntest of a triangle", "a beam is 7 % stiff", _MEASURED, "quality.BLUNTEST[3]"
            ),
            Limit(radians(20.0), "rad, warp", "a twisted strip errs by 1 %", _MEASURED, "quality.MOST_WARPED"),
            Limit(20.0, "aspect, longest side squared over area", "16 lost nothing", _MEASURED, "quality.LONGEST"),
        ),
    ),
    Entry(
        "cells-twice",
        "Several cells of the mesh have the same nodes, so their stiffness and mass are counted for each.",
        LIMITS,
        "two cells of a part have the same corner nodes",
        "Remove one of each pair in the mesh, unless both are meant, as skins of one wall.",
    ),
    Entry(
        "open-seam",
        "The mesh has two nodes at one place: the cells on both sides are not joined there.",
        LIMITS,
        "nodes of a part are nearer to each other than the threshold share of its size",
        "Merge equal nodes in the program that makes the mesh. Nothing, where the gap is meant.",
        (Limit(1e-6, "of the size of the mesh", "coordinates have six digits or more", CHOSEN, "doubts.SEAM"),),
    ),
    Entry(
        "mesh-states-more",
        "The mesh file has cells, masses, links, supports or other data that the model does not have.",
        LIMITS,
        "cells of the file are of no part, or the file states masses, links or supports that the model does not hold",
        "Give the cells a part. Take supports, rigid links and masses as the file has them by a part of type "
        "'attachments', or write them in the model; sets name their places. "
        "Where the model has them already, nothing is missing. Brackets of the message say what each would change and "
        "what to write in its place.",
        forbids="the file states what no reader makes and the model does not have: bars without a frame, springs, "
        "masses, links or supports without one of the model, an offset, layers or varying thickness that the part does "
        "not state, mass per area, membranes, several materials in one part, a load before the vibration, or a card, "
        "keyword, option or field that is not known",
    ),
    Entry(
        "mesh-stated-otherwise",
        "The mesh file states something of its cells that the model states otherwise; the model holds.",
        REMARK,
        "a part has a thickness, offset, orientation, layers or constants of its material of its own, and the file has "
        "others",
        "Nothing, where the model is meant. Otherwise take the key out of the part, or write what the file has.",
        (Limit(0.01, "% of a modulus or a density", "steels differ by less", CHOSEN, "unused.DIFFERS"),),
    ),
    Entry(
        "mesh-without-effect",
        "The mesh file states loads, output or other data that a linear model of vibration does not need.",
        REMARK,
        "a card, keyword or section of the file is in the table of those with little or no effect",
        "Nothing. Loads of the file are not applied: a study states what acts.",
    ),
    Entry(
        "nodes-alone",
        "The mesh file has nodes that no element uses.",
        REMARK,
        "a node of the file is of no cell, rigid link, average or mass that it states",
        "Nothing, where they are centres of arcs or marks. Otherwise the file is cut among its elements, or they are "
        "of a kind that is not read: write it again.",
    ),
    Entry(
        "mesh-without-end",
        "The mesh file lacks the word that ends it.",
        REMARK,
        "bulk data of Nastran without BEGIN BULK has no ENDDATA; with BEGIN BULK it is refused",
        "Look at the last card of the file, which the message names. If it was not meant to be the last, the file is "
        "cut: write it again. Otherwise there is nothing to do.",
    ),
)
