"""Findings on what a structure is: how its parts are arranged and joined, and how it rests."""

from __future__ import annotations

from typing import Final

from femstruct.findings.entry import CHOSEN, FORBIDS, LIMITS, REMARK, Entry, Limit
from femstruct.findings.plausibility_entries import PLAUSIBILITY

_SOLIDS: Final = "three-dimensional solids, tests/analytic/test_rigid_in_plane.py"

STRUCTURE: Final = (
    Entry(
        "constraint-repeated",
        "A constraint has equations that follow from those of others.",
        LIMITS,
        "equations of a constraint add nothing to those of joints, supports and the constraints before it",
        "Remove what is said twice. Motions and frequencies are right; the force of the constraint is one of many.",
        (Limit(1e-9, "of an equation", "positions of joined nodes agree to 1e-12", CHOSEN, "ties.RANK"),),
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
            Limit(
                0.75,
                "of the highest frequency of the modes kept",
                "a floor of two parts erred by 2e-6 at 0.67 of it, by 3e-4 at 0.86",
                "tests/analytic/test_craig_bampton.py",
                "reduced_band.BEYOND",
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
            Limit(
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
            Limit(
                1e-3,
                "of the largest of the three masses",
                "matrices in files of few digits agree to 1e-6",
                CHOSEN,
                "substructure.UNEVEN",
            ),
            Limit(
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
            Limit(
                1.01,
                "of half the depth of a bar and half the thickness of a plate",
                "a bar nearer than that touches it",
                CHOSEN,
                "bars_beside.REACHED",
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
            Limit(
                1.0,
                "times the largest load of the entry",
                "its stiffness is that up to this load",
                "the makers' tables, `femstruct materials hanger`",
                "hung.ALLOWED",
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
        (Limit(1e6, "times the mass of the rest", "such a mass acts as ground", CHOSEN, "arrangement.DOMINATES"),),
    ),
    Entry(
        "overlapping-parts",
        "Two parts fill the same space, so mass and stiffness count twice.",
        LIMITS,
        "two parallel plates, or two blocks, overlap by more than the threshold share of the thinner one, or "
        "cells of two meshes have one middle",
        "Move one part. The origin of a plate is on its mid-surface.",
        (
            Limit(0.01, "% of the thinner part", "less is a rounded dimension", CHOSEN, "twice.REACHES"),
            Limit(0.5, "of the thinner part", "most of it counts twice", CHOSEN, "twice.INSIDE", forbids=True),
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
        (Limit(0.999, "of the side", "less is more than rounding", CHOSEN, "arrangement.WHOLE"),),
    ),
    Entry(
        "eccentric-bars",
        "Ribs beside the mid-surface are too stiff, because the plate is rigid in its own plane.",
        LIMITS,
        "a frequency of the rib with its strip of plate is too high by more than the threshold",
        "Use 'in_plane: elastic' and the element bfs16.",
        (
            Limit(1e-3, "of a frequency", "less is below other errors", _SOLIDS, "eccentric.NOTABLE"),
            Limit(1e-2, "of a frequency", "the usual error of a mesh", _SOLIDS, "eccentric.SEVERE", forbids=True),
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
        (Limit(1e-2, "of a frequency", "the usual error of a mesh", CHOSEN, "arched.NOTABLE"),),
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
        "stiff-layer",
        "The layer is so stiff in shear that the plates that it touches are too stiff in bending.",
        LIMITS,
        "a frequency is too high by more than the threshold, because the plates are rigid in their own planes",
        "Use 'in_plane: elastic' and the element bfs16.",
        (
            Limit(1e-3, "of a frequency", "less is below other errors", _SOLIDS, "eccentric.NOTABLE"),
            Limit(1e-2, "of a frequency", "the usual error of a mesh", _SOLIDS, "eccentric.SEVERE", forbids=True),
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
            Limit(
                0.5,
                "of the first in-plane frequency",
                "from there on modes are some per cent too high",
                _SOLIDS,
                "folded.NEAR",
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
        (Limit(0.1, "% of the size", "springs are not built so soft", CHOSEN, "structure_findings.FAR"),),
    ),
    Entry(
        "leaning-block",
        "The block leans under its weight, because its centre of mass is not above the middle of its supports.",
        REMARK,
        "the tilt at rest is more than machines are levelled to",
        "Move the springs, or the block.",
        (Limit(1e-3, "rad", "machines are levelled to 0.1 to 1 mm a metre", CHOSEN, "weight.LEVEL"),),
    ),
)
