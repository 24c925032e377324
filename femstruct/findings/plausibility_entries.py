"""Findings on values that no material, section or thickness has."""

from __future__ import annotations

from typing import Final

from femstruct.findings.entry import CHOSEN, FORBIDS, LIMITS, REMARK, Entry, Limit

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
            Limit(2.0, "m/s, slowest sqrt(E / rho)", "gelatine has 3 m/s", _ASHBY, "plausibility.SLOWEST"),
            Limit(20e3, "m/s, fastest sqrt(E / rho)", "diamond has 18 km/s", _ASHBY, "plausibility.FASTEST"),
            Limit(
                300.0,
                "m/s, slowest of what is denser than 1100 kg/m^3 and has a Poisson ratio below 0.4",
                "PTFE has 430 m/s; only rubbers and loose soils have less",
                _ASHBY,
                "plausibility.SLOWEST_HARD",
            ),
            Limit(1.0, "kg/m^3, lightest solid", "aerogels have 3 kg/m^3", CHOSEN, "plausibility.LIGHTEST"),
            Limit(23e3, "kg/m^3, densest solid", "osmium has 22 590 kg/m^3", CHOSEN, "material.DENSEST"),
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
        (Limit(1e-4, "of the shorter side", "sheet of 0.5 mm over 5 m", CHOSEN, "plausibility.THINNEST"),),
    ),
    Entry(
        "implausible-stiffness",
        "The plate sags far under its own weight.",
        FORBIDS,
        "the sag over the shorter side, simply supported, is more than the threshold share of that side",
        "Check E, the density, the thickness and the size.",
        (
            Limit(
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
            Limit(0.5, "loss factor of a material", "asphalt has 0.4", CHOSEN, "plausibility.LOSSY"),
            Limit(1e9, "Pa, E of it", "rubbers and foams are softer and may lose more", CHOSEN, "plausibility.STIFF"),
            Limit(0.25, "damping ratio of every mode", "earth dams reach it", CHOSEN, "structure_findings.OVERDAMPED"),
        ),
    ),
    Entry(
        "implausible-section",
        "The section does not fit the bar, or its area does not fit its second moments.",
        FORBIDS,
        "the section is too thick or too slender for its line, or I / A^2 has no possible value",
        "Check the units: plain numbers are m, m^2 and m^4.",
        (
            Limit(10.0, "line lengths, side of a section", "stubs reach 5", CHOSEN, "plausibility.THICKEST_BAR"),
            Limit(2.0, "line lengths, side above 1 m", "piers reach 1", CHOSEN, "plausibility.THICKEST_LARGE"),
            Limit(
                3e4, "radii of gyration, a straight piece", "wire of 4 mm over 30 m", CHOSEN, "plausibility.LONGEST_BAR"
            ),
            Limit(1e-5, "of A^2, least second moment", "a strip of 1:8000", CHOSEN, "plausibility.PROPORTIONS[0]"),
            Limit(1e2, "of A^2, largest", "a tube with a wall of 1:1000", CHOSEN, "plausibility.PROPORTIONS[1]"),
        ),
    ),
    Entry(
        "implausible-mass",
        "The density of the block is that of no solid or machine.",
        FORBIDS,
        "mass over volume lies outside the thresholds",
        "Check the mass and the size; a weight in newtons is not a mass.",
        (
            Limit(5.0, "kg/m^3, lightest", "a rigid body of less is a balloon", CHOSEN, "plausibility.LIGHTEST_BLOCK"),
            Limit(23e3, "kg/m^3, densest", "osmium has 22 590 kg/m^3", CHOSEN, "material.DENSEST"),
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
            Limit(
                0.2,
                "% of the size of the structure",
                "isolators and hangers are shorter",
                CHOSEN,
                "joint_springs.FAR",
            ),
        ),
    ),
)
