"""Findings on what a structure is: parts, joints, supports, meshes of files, values that nothing has, cavities."""

from __future__ import annotations

from math import radians
from typing import Final

from femstruct.findings.entry import CHOSEN, FORBIDS, LIMITS, REMARK, Entry, Threshold

# ----------------------------------------------------------------------------------------------------------------------
# Findings on values that no material, section or thickness has.
# ----------------------------------------------------------------------------------------------------------------------

_ASHBY: Final = "M. F. Ashby, Materials Selection in Mechanical Design, chart of modulus and density"
_UNITS: Final = "Check the unit; the message names the value that was probably meant."

PLAUSIBILITY: Final = (
    Entry(
        "implausible-material",
        "No solid has this combination of modulus and density.",
        FORBIDS,
        "sqrt(E / rho) or rho lies outside the range of all solids",
        _UNITS,
        (
            Threshold(2.0, "m/s, slowest sqrt(E / rho)", "gelatine has 3 m/s", _ASHBY, "plausibility.SLOWEST"),
            Threshold(20e3, "m/s, fastest sqrt(E / rho)", "diamond has 18 km/s", _ASHBY, "plausibility.FASTEST"),
            Threshold(
                300.0,
                "m/s, slowest of what is denser than 1100 kg/m^3 and has a Poisson ratio below 0.4",
                "PTFE has 430 m/s; only rubbers and loose soils have less",
                _ASHBY,
                "plausibility.SLOWEST_HARD",
            ),
            Threshold(1.0, "kg/m^3, lightest solid", "aerogels have 3 kg/m^3", CHOSEN, "plausibility.LIGHTEST"),
            Threshold(23e3, "kg/m^3, densest solid", "osmium has 22 590 kg/m^3", CHOSEN, "materials.DENSEST"),
        ),
    ),
    Entry(
        "material-completed",
        "The orthotropic material has constants that were not given and are completed.",
        REMARK,
        "E has two values, G two, or nu one",
        "Give all nine constants where solids need them; plates and shells use Ex, Ey, nuxy and the shear moduli.",
    ),
    Entry(
        "implausible-thickness",
        "The plate is as thin as a foil.",
        FORBIDS,
        "the thickness is less than the threshold share of the shorter side",
        f"{_UNITS} A real foil is held by its tension, which plates do not have here.",
        (Threshold(1e-4, "of the shorter side", "sheet of 0.5 mm over 5 m", CHOSEN, "plausibility.THINNEST"),),
    ),
    Entry(
        "implausible-stiffness",
        "The plate sags far under its own weight.",
        FORBIDS,
        "the sag over the shorter side, simply supported, is more than the threshold share of that side",
        "Check E, the density, the thickness and the size.",
        (
            Threshold(
                0.05,
                "% of the shorter side",
                "floors sag by 0.1 %, thin sheets by 2 %",
                CHOSEN,
                "plausibility.SAGGING",
            ),
        ),
    ),
    Entry(
        "implausible-damping",
        "The damping is higher than that of any structure, or of any material so stiff.",
        LIMITS,
        "the loss factor of a stiff material, or the damping ratio of every mode, is at the threshold or above",
        "Check the unit: a plain number is a ratio, 1 is 100 %. Write 1 %.",
        (
            Threshold(0.5, "loss factor of a material", "asphalt has 0.4", CHOSEN, "plausibility.LOSSY"),
            Threshold(
                1e9, "Pa, E of it", "rubbers and foams are softer and may lose more", CHOSEN, "plausibility.STIFF"
            ),
            Threshold(
                0.25, "damping ratio of every mode", "earth dams reach it", CHOSEN, "structure_findings.OVERDAMPED"
            ),
        ),
    ),
    Entry(
        "implausible-section",
        "The section does not fit the bar, or its area does not fit its second moments.",
        FORBIDS,
        "the section is too thick or too slender for its line, or I / A^2 has no possible value",
        "Check the units: plain numbers are m, m^2 and m^4.",
        (
            Threshold(10.0, "line lengths, side of a section", "stubs reach 5", CHOSEN, "plausibility.THICKEST_BAR"),
            Threshold(2.0, "line lengths, side above 1 m", "piers reach 1", CHOSEN, "plausibility.THICKEST_LARGE"),
            Threshold(
                3e4, "radii of gyration, a straight piece", "wire of 4 mm over 30 m", CHOSEN, "plausibility.LONGEST_BAR"
            ),
            Threshold(1e-5, "of A^2, least second moment", "a strip of 1:8000", CHOSEN, "plausibility.PROPORTIONS[0]"),
            Threshold(1e2, "of A^2, largest", "a tube with a wall of 1:1000", CHOSEN, "plausibility.PROPORTIONS[1]"),
        ),
    ),
    Entry(
        "implausible-mass",
        "The density of the block is that of no solid or machine.",
        FORBIDS,
        "mass over volume lies outside the thresholds",
        "Check the mass and the size; a weight in newtons is not a mass.",
        (
            Threshold(
                5.0, "kg/m^3, lightest", "a rigid body of less is a balloon", CHOSEN, "plausibility.LIGHTEST_BLOCK"
            ),
            Threshold(23e3, "kg/m^3, densest", "osmium has 22 590 kg/m^3", CHOSEN, "materials.DENSEST"),
        ),
    ),
    Entry(
        "spring-with-long-arms",
        "A spring joins two places that are far apart beside each other, through rigid arms.",
        LIMITS,
        "the two places are apart, across a direction in which the spring has stiffness, by more than the threshold",
        "Give each place its own opposite ('between' of two points with as many places), or leave out the second end "
        "for springs to the ground. Props and ties may be as long as they are along their stiffness.",
        (
            Threshold(
                0.2,
                "% of the size of the structure",
                "isolators and hangers are shorter",
                CHOSEN,
                "joint_findings.FAR",
            ),
        ),
    ),
)


# ----------------------------------------------------------------------------------------------------------------------
# Findings on what a structure is: how its parts are arranged and joined, and how it rests.
# ----------------------------------------------------------------------------------------------------------------------

_SOLIDS: Final = "three-dimensional solids, tests/analytic/test_rigid_in_plane.py"

STRUCTURE: Final = (
    Entry(
        "constraint-repeated",
        "A constraint has equations that follow from those of others.",
        LIMITS,
        "equations of a constraint add nothing to those of joints, supports and the constraints before it",
        "Remove what is said twice. Motions and frequencies are right; the force of the constraint is one of many.",
        (Threshold(1e-9, "of an equation", "positions of joined nodes agree to 1e-12", CHOSEN, "ties.RANK"),),
    ),
    Entry(
        "constraint-holds",
        "Constraints hold a point at zero though no support does.",
        LIMITS,
        "the equations of constraints have only the solution zero for a direction of one of their points, and no "
        "support takes part",
        "Check the factors of the equations that are named; write a support if the point is to be held.",
    ),
    Entry(
        "reduced-beyond",
        "A reduced part is asked for frequencies that it was not reduced for.",
        LIMITS,
        "the highest frequency looked at is more than the threshold share of that of the modes that were kept",
        "Reduce the part anew with modes up to twice the highest frequency: femstruct reduce --up-to.",
        (
            Threshold(
                0.75,
                "of the highest frequency of the modes kept",
                "a floor of two parts erred by 2e-6 at 0.67 of it, by 3e-4 at 0.86",
                "tests/analytic/test_craig_bampton.py",
                "wave_findings.BEYOND",
            ),
        ),
    ),
    Entry(
        "matrices-held",
        "A part given by matrices is held inside of them.",
        REMARK,
        "no motion of the degrees of freedom shifts all nodes of the part alike, or its stiffness resists such a shift",
        "Forces of supports inside of the matrices are not recorded. Export or reduce the part without its supports, "
        "and write them in the model that it becomes a part of.",
        (
            Threshold(
                1e-4,
                "of the energy that the diagonal of K alone would have",
                "free parts have 1e-15",
                "tests/analytic/test_substructures.py",
                "substructure.RESISTS",
            ),
        ),
    ),
    Entry(
        "matrices-disorder",
        "Matrices contradict the nodes that are given for them.",
        LIMITS,
        "the mass of a part given by matrices differs along x, y and z, or its stiffness resists no shift of the whole "
        "part and resists a rotation of it",
        "Write the rows of the table of nodes in the order of the rows of the matrices. Check places and directions, "
        "and that the matrices are those of the whole part, without supports or springs to the ground.",
        (
            Threshold(
                1e-3,
                "of the largest of the three masses",
                "matrices in files of few digits agree to 1e-6",
                CHOSEN,
                "substructure.UNEVEN",
            ),
            Threshold(
                1e-4,
                "of the energy that the diagonal of K alone would have",
                "two nodes in each other's place have 1e-3 to 6e-2, free parts 1e-15",
                "tests/analytic/test_substructures.py",
                "substructure.RESISTS",
            ),
        ),
    ),
    Entry(
        "constraint-to-ground",
        "An equation holds the structure as a support does.",
        REMARK,
        "a rigid motion of the whole structure violates a constraint",
        "Nothing, where a lever is meant whose pivot is not in the model. Otherwise make the factors add up to zero in "
        "each direction, and couple points that lie on the line of the direction.",
    ),
    Entry(
        "stiff-cells",
        "A solid has tetrahedra of 4 nodes, which are far too stiff in bending.",
        LIMITS,
        "a part of type solid has linear tetrahedra",
        "Mesh with tetrahedra of 10 nodes (second order), or with hexahedra.",
    ),
    *PLAUSIBILITY,
    Entry(
        "parts-not-joined",
        "Nothing joins these parts to the rest of the structure.",
        LIMITS,
        "no joint, layer, spring, contact or link connects a part with the heaviest piece",
        "Add a joint, or remove the part. Bars beside a plate have their lines in it, 'offsets' to where they are, and "
        "a joint.",
        (
            Threshold(
                1.01,
                "of half the depth of a bar and half the thickness of a plate",
                "a bar nearer than that touches it",
                CHOSEN,
                "rib_findings.REACHED",
            ),
        ),
        forbids="the part can move freely, touches or reaches the others, or the rest is itself free",
    ),
    Entry(
        "nothing-carries-weight",
        "The study has gravity and nothing holds the part up.",
        FORBIDS,
        "gravity acts on a piece that can move along its weight",
        "Add a support, layer or spring, or write 'gravity: false'. Parts do not fall: start what is to strike with "
        "its speed then, 'initial: {rigid: {about: POINT, velocity: [0, 0, -4.43 m/s]}}' for 1 m.",
    ),
    Entry(
        "nothing-holds-it",
        "Nothing holds the part up, and its motion as a whole sounds in a room.",
        LIMITS,
        "a piece of the structure can move along its weight, has a surface of a closed room, and is simulated without "
        "gravity; not in the half space, where free plates are tested",
        "Add 'supports', a layer or springs. A floor that is free on purpose, as one hung on soft cords, may stay so: "
        "its levels contain its motion as a whole.",
        forbids="the room is rated ('levels')",
    ),
    Entry(
        "edge-only-turned",
        "The springs or walls of an edge only resist its rotation, and nothing holds the part along its normal.",
        FORBIDS,
        "a support has 'walls', or 'stiffness: {about edge: ..}' without 'z', and no support, layer or spring resists "
        "a shift of the part along its normal",
        "Add 'z' to the stiffness, 'fix: simple', or another support: an edge that is held against rotation is held "
        "against deflection, too.",
    ),
    Entry(
        "hangers-overloaded",
        "Hangers of a ceiling carry more than their maker recommends.",
        LIMITS,
        "the mass of the ceiling and of what is fastened to it, shared equally by its hangers, is more for each "
        "than the largest load of their entry of the library; not where other parts carry the ceiling, too",
        "Take more of them or stronger ones: beyond this load rubber is stiffer than its entry says. Hangers at edges "
        "and below stiff joists carry more than the mean.",
        (
            Threshold(
                1.0,
                "times the largest load of the entry",
                "its stiffness is that up to this load",
                "the makers' tables, `femstruct materials hanger`",
                "bases.ALLOWED",
            ),
        ),
    ),
    Entry(
        "nothing-moves",
        "Supports hold every node of the part.",
        FORBIDS,
        "no node of the part is free: of a plate its deflection, else all displacements",
        "Refine the mesh, or hold less.",
    ),
    Entry(
        "one-mass-dominates",
        "One part is so heavy that the others do not move it.",
        FORBIDS,
        "the mass of a part is many times that of all others",
        "Check the units, or replace the heavy part by a support.",
        (
            Threshold(
                1e6,
                "times the mass of the rest",
                "such a mass acts as ground",
                CHOSEN,
                "arrangement_findings.DOMINATES",
            ),
        ),
    ),
    Entry(
        "overlapping-parts",
        "Two parts fill the same space, so mass and stiffness count twice.",
        LIMITS,
        "two parallel plates, or two blocks, overlap by more than the threshold share of the thinner one, or "
        "cells of two meshes have one middle",
        "Move one part. The origin of a plate is on its mid-surface.",
        (
            Threshold(
                0.01, "% of the thinner part", "less is a rounded dimension", CHOSEN, "arrangement_findings.REACHES"
            ),
            Threshold(
                0.5,
                "of the thinner part",
                "most of it counts twice",
                CHOSEN,
                "arrangement_findings.INSIDE",
                forbids=True,
            ),
        ),
        forbids="half of the thinner part overlaps",
    ),
    Entry(
        "overlapping-lines",
        "Bars lie on each other, so mass and stiffness count twice.",
        LIMITS,
        "straight pieces of frames share more than a point",
        "Remove one of the lines. A joint between them makes a built-up bar, which is correct.",
        forbids="the pieces belong to one frame, or no joint connects the two frames",
    ),
    Entry(
        "duplicate-part",
        "A mass, spring or layer is given twice in one place.",
        FORBIDS,
        "two parts are equal except for their names",
        "Remove one, or write the sum of both as one.",
    ),
    Entry(
        "layer-overhang",
        "The elastic layer carries only a part of the smaller plate, slab or block.",
        REMARK,
        "a layer 'whole' fills less than the whole side of the smaller part",
        "Check the positions of both parts.",
        (Threshold(0.999, "of the side", "less is more than rounding", CHOSEN, "arrangement_findings.WHOLE"),),
    ),
    Entry(
        "eccentric-bars",
        "Ribs beside the mid-surface are too stiff, because the plate is rigid in its own plane.",
        LIMITS,
        "a frequency of the rib with its strip of plate is too high by more than the threshold",
        "Use 'in_plane: elastic' and the element bfs16.",
        (
            Threshold(1e-3, "of a frequency", "less is below other errors", _SOLIDS, "foundation.NOTABLE"),
            Threshold(
                1e-2, "of a frequency", "the usual error of a mesh", _SOLIDS, "rib_findings.SEVERE", forbids=True
            ),
        ),
        forbids="the frequency is more than 1 % too high",
    ),
    Entry(
        "arched-plate",
        "Supports hold a ribbed plate lengthways at both ends, so that it acts as an arch.",
        LIMITS,
        "the frequency of a rib with its strip of plate is higher than with sliding ends by more than the threshold",
        "Use 'simple' or 'roller' edges, or let a clamped end slide along the ribs, as 'fix: [y, z, rx, ry, rz]' for "
        "ribs along x; nothing where the supports are as stiff as rock along the ribs. On a set or box of a slab or "
        "shell 'simple' holds x, y and z of every node: write the directions, such as [y, z] at one of the two ends.",
        (Threshold(1e-2, "of a frequency", "the usual error of a mesh", CHOSEN, "rib_findings.ARCH_NOTABLE"),),
    ),
    Entry(
        "joint-springs-by-node",
        "The springs of a joint depend on the mesh: there is one at every pair of joined nodes.",
        LIMITS,
        "a joint with a stiffness joins neighbouring nodes, as along an edge or over a face",
        "Write the stiffness per length of the line, in N/m^2 or N*m/m: it is spread along it, whatever the mesh. Or "
        "check that the sum that is stated is the stiffness of the whole joint.",
    ),
    Entry(
        "joint-open",
        "A joint leaves nodes free that lie on the other part: it is open there.",
        FORBIDS,
        "nodes of a part lie on cells of the part that it is joined to, which has no node at their place, and parts of "
        "these kinds are not joined between nodes, as shells and frames on solids are not; the length or area of the "
        "edges, bars or cells with such nodes is said, and the whole of what touches",
        "Give both parts the same nodes where they touch, or write a seam.",
    ),
    Entry(
        "joint-at-a-point",
        "Two plates, shells or solids are joined at one point alone.",
        FORBIDS,
        "all nodes that a joint without springs holds together are at one place, and both parts have cells: under a "
        "force at a point a plate turns, and a solid gives way, without limit as cells get smaller",
        "See whether the parts are where they are meant to be. Where they are, state a stiffness of the joint, or let "
        "them overlap.",
    ),
    Entry(
        "parts-share-nodes",
        "Parts of one mesh file are joined at the nodes that they share there.",
        REMARK,
        "two parts of one mesh file share nodes, and the model has no joint or seam of them",
        "Nothing, where they are to move together. A joint of both takes the place of that: 'kind: pinned', springs, "
        "or a slip; parts that touch and are to move apart need nodes of their own in the file.",
    ),
    Entry(
        "shared-nodes-hinge",
        "A shell is on a hinge where it shares nodes of a mesh file with a solid.",
        FORBIDS,
        "nodes that a shell shares with a solid are of no cell of the shell that lies on the solid with all its nodes, "
        "and the model has no joint of them; nodes of solids do not turn",
        "Write a joint of both, which holds the rotations of the shell to the surface of the solid; or 'kind: pinned' "
        "if it is a hinge; or let a row of cells of the shell lie on the solid in the file.",
    ),
    Entry(
        "joint-rigid-arms",
        "A joint has rigid arms between nodes of parts that touch.",
        LIMITS,
        "a joint with a reach joins nodes that lie on cells of the other part to nodes beside them",
        "Leave out the reach where slabs, shells and frames touch: they are joined wherever they do.",
    ),
    Entry(
        "joint-inside-cells",
        "A slab or shell is too stiff where a wall stands on it between the lines of its cells.",
        LIMITS,
        "edges of a shell are joined to the insides of cells of another, rotations held, and a frequency can be too "
        "high by more than the threshold; it is estimated from the bending stiffness of both and from their spans, "
        "clamped at their far ends",
        "Let a line of cells run under the wall: name both ends of its foot in 'through' of the slab, or mesh the "
        "shell so. Or take smaller cells: the error goes with their width.",
        (
            Threshold(1e-2, "of a frequency", "the usual error of a mesh", CHOSEN, "joint_findings.STIFFER_NOTABLE"),
            Threshold(
                5e-2,
                "of a frequency",
                "more than materials are known to",
                CHOSEN,
                "joint_findings.STIFFER_SEVERE",
                forbids=True,
            ),
        ),
        forbids="frequencies can be more than 5 % too high",
    ),
    Entry(
        "stiff-layer",
        "The layer is so stiff in shear that the plates that it touches are too stiff in bending.",
        LIMITS,
        "a frequency is too high by more than the threshold, because the plates are rigid in their own planes",
        "Use 'in_plane: elastic' and the element bfs16.",
        (
            Threshold(1e-3, "of a frequency", "less is below other errors", _SOLIDS, "foundation.NOTABLE"),
            Threshold(
                1e-2, "of a frequency", "the usual error of a mesh", _SOLIDS, "rib_findings.SEVERE", forbids=True
            ),
        ),
        forbids="the frequency is more than 1 % too high",
    ),
    Entry(
        "folded-plates",
        "Plates joined at an angle move in their own planes, in which they are said to be rigid.",
        LIMITS,
        "modes are asked for up to the threshold share of the first in-plane frequency of the folded plates",
        "Use 'in_plane: elastic' and the element bfs16, or ask for modes below the stated frequency only.",
        (
            Threshold(
                0.5,
                "of the first in-plane frequency",
                "from there on modes are some per cent too high",
                _SOLIDS,
                "wave_findings.NEAR",
            ),
        ),
        forbids="modes are asked for beyond the first in-plane frequency",
    ),
    Entry(
        "mechanism",
        "Parts slide or turn on each other without resistance.",
        LIMITS,
        "there are more modes without frequency than free pieces have rigid motions",
        "Give the layer, spring or joint a stiffness in that direction.",
        forbids="gravity sets one of these motions going",
    ),
    Entry(
        "sags-far",
        "The structure sags far under its own weight.",
        LIMITS,
        "a part sags by more than the threshold share of the size of the structure; in studies without gravity, too",
        "Check the units of springs, layers and moduli, unless they are soft on purpose.",
        (Threshold(0.1, "% of the size", "springs are not built so soft", CHOSEN, "structure_findings.FAR"),),
    ),
    Entry(
        "leaning-block",
        "The block leans under its weight, because its centre of mass is not above the middle of its supports.",
        REMARK,
        "the tilt at rest is more than machines are levelled to",
        "Move the springs, or the block.",
        (Threshold(1e-3, "rad", "machines are levelled to 0.1 to 1 mm a metre", CHOSEN, "check.LEVEL"),),
    ),
)


# ----------------------------------------------------------------------------------------------------------------------
# Findings on meshes from files.
# ----------------------------------------------------------------------------------------------------------------------

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
            Threshold(200.0, "m, size of a part", "a large building", CHOSEN, "flat_cells.LARGEST"),
            Threshold(2e-3, "m, least size of a solid", "a chip", CHOSEN, "flat_cells.SMALLEST"),
            Threshold(1e7, "kg of a solid", "a block of concrete of 16 m a side", CHOSEN, "flat_cells.HEAVIEST"),
            Threshold(5e3, "kg/m^2, thickness from the file", "2 m of concrete", CHOSEN, "flat_cells.HEAVIEST_SHELL"),
            Threshold(
                2e4, "kg of stated masses per size^3", "metal all through has 22600", CHOSEN, "attachments.HEAVIEST"
            ),
            Threshold(
                200.0, "times the thickness", "sheet of 0.5 mm in 50 mm cells has 100", CHOSEN, "flat_cells.WIDEST"
            ),
            Threshold(0.05, "times, least", "a wall of 200 mm in 20 mm cells has 0.1", CHOSEN, "flat_cells.NARROWEST"),
        ),
    ),
    Entry(
        "bad-cells",
        "Some cells of the mesh have a shape that costs accuracy.",
        LIMITS,
        "an angle, the warp or the aspect of a cell is beyond a threshold",
        "Mesh the places that the message names more evenly. A few such cells away from what matters do no harm.",
        (
            Threshold(radians(30.0), "rad, sharpest of a quadrilateral", _FIVE, _MEASURED, "quality.SHARPEST"),
            Threshold(radians(150.0), "rad, bluntest of a quadrilateral", _FIVE, _MEASURED, "quality.BLUNTEST[4]"),
            Threshold(
                radians(120.0), "rad, bluntest of a triangle", "a beam is 7 % stiff", _MEASURED, "quality.BLUNTEST[3]"
            ),
            Threshold(radians(20.0), "rad, warp", "a twisted strip errs by 1 %", _MEASURED, "quality.MOST_WARPED"),
            Threshold(20.0, "aspect, longest side squared over area", "16 lost nothing", _MEASURED, "quality.LONGEST"),
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
        (Threshold(1e-6, "of the size of the mesh", "coordinates have six digits or more", CHOSEN, "flat_cells.SEAM"),),
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
        (Threshold(0.01, "% of a modulus or a density", "steels differ by less", CHOSEN, "unused.DIFFERS"),),
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


# ----------------------------------------------------------------------------------------------------------------------
# Findings on cavities: air and wool between two surfaces of a structure.
# ----------------------------------------------------------------------------------------------------------------------

CAVITIES: Final = (
    Entry(
        "cavity-coupling",
        "The frequencies and mode numbers are those of the structure with the air of its cavities.",
        REMARK,
        "the model has 'cavities'",
        "Nothing; the message states the mode that the air changes most. With wool read frequency responses: modes of "
        "the air are overdamped, and a damping ratio of one mode is not how it decays.",
    ),
    Entry(
        "cavity-modes-few",
        "The air of a cavity follows the highest motions too fast, because too few of its modes are kept.",
        LIMITS,
        "the modes of the air that are kept end below the threshold share of the frequency that they need to reach: "
        "twice that of the last mode of the structure, f, or where that is more, in loose wool 2 sqrt(f sigma / (2 pi "
        "rho)), in held wool 5 times this root",
        "Ask for fewer modes of the structure, give the cavity 'up_to: F' with the frequency that is needed, or "
        "name its 'bays' where joists close it.",
        (
            Threshold(
                0.7,
                "of the frequency that is needed",
                "motions of a ceiling of 4 x 3 m at the top of the band are wrong by 3 %",
                "tests/analytic/test_cavity_boxes.py",
                "femstruct.sound.cavity_coupling.FEW",
            ),
        ),
    ),
    Entry(
        "wool-out-of-range",
        "The model of the wool was not compared at its flow resistivity.",
        LIMITS,
        "the flow resistivity lies outside 5 to 30 kPa*s/m^2",
        "Check its unit; beyond the range the drag is right at low frequencies, its change with frequency is not known "
        "to be.",
        (
            Threshold(
                5e3,
                "Pa*s/m^2 at least",
                "within 6.5 % of Johnson-Champoux-Allard from there, 20 Hz to 1 kHz",
                "tests/analytic/test_cavity_wool.py",
                "cavities.LEAST",
            ),
            Threshold(30e3, "Pa*s/m^2 at most", "the same", "tests/analytic/test_cavity_wool.py", "cavities.MOST"),
        ),
    ),
    Entry(
        "held-wool",
        "Wool that is held at rest damps the common movement of both surfaces, which loose wool does not.",
        LIMITS,
        "the fill has 'frame: held', and its drag on a movement of all of the structure is more than the threshold",
        "Use 'frame: limp', but for wool that something at rest holds.",
        (Threshold(0.5, "1/s", "a loss factor of 1 % at 16 Hz", CHOSEN, "femstruct.sound.cavity_coupling.HELD"),),
    ),
    Entry(
        "cavity-sizes-differ",
        "The two surfaces of a cavity differ in size or do not lie opposite to each other.",
        LIMITS,
        "a side of what they share is shorter than the longer of the two by more than the threshold",
        "Give the surfaces a 'region' of one size.",
        (Threshold(0.01, "% of a side", "a hundredth of the volume", CHOSEN, "cavity_coupling.SAME"),),
    ),
    Entry(
        "cavity-depth",
        "The depth of a cavity is not the distance of its surfaces.",
        LIMITS,
        "they differ by more than the threshold, from face to face",
        "Correct the depth, or the place of the parts.",
        (Threshold(0.2, "% of the distance", "10 % of a frequency on the air", CHOSEN, "cavity_coupling.DEPTH"),),
    ),
    Entry(
        "cavity-crossed",
        "A frame runs through a cavity that is described as one.",
        LIMITS,
        "bars lie between the surfaces of a cavity without 'bays', level with them, away from its sides",
        "Name the bays; leave it where the bars do not close the cavity.",
        (
            Threshold(
                0.02, "% of a side", "nearer to a side they close the cavity", CHOSEN, "structure_findings.WITHIN"
            ),
            Threshold(
                0.5, "% of the depth", "joists reach beyond the mesh of a plate", CHOSEN, "structure_findings.DEEP"
            ),
        ),
    ),
    Entry(
        "bays-beside-joists",
        "Bays of a cavity end where no joist of the model lies.",
        LIMITS,
        "bars lie between the surfaces of a cavity with 'bays', and one of its 'at' is farther from all that run along "
        "it than half its 'width' and the threshold",
        "Check 'across', the axis along which the places are counted, across the joists, and 'at', from the corner of "
        "the cavity. Leave it where the joists are no frames of the model.",
        (Threshold(0.02, "% of a side", "a tenth of a usual bay", CHOSEN, "structure_findings.WITHIN"),),
    ),
)
