"""Input files of Abaqus and CalculiX (.inp): keywords, sections, what is stated beside the mesh, and the mesh."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final, Literal, NamedTuple

import numpy as np

from femstruct.arrays import Floats, Integers
from femstruct.decks.stated import in_global_directions
from femstruct.errors import InputError
from femstruct.files.text_tables import beside, content, floats, integers, lines_of, wrong_line
from femstruct.model.imported_mesh import (
    KINDS,
    CellBlock,
    Gathered,
    Makes,
    Stated,
    StatedHold,
    StatedLayer,
    StatedLink,
    StatedMass,
    StatedMaterial,
    StatedProperty,
    StatedSpread,
    Tally,
)

# ----------------------------------------------------------------------------------------------------------------------
# Keywords of Abaqus and CalculiX that no reader makes, in two classes: without effect on a linear model of vibration,
# and left out; and the options of those that are read.
#
# Names are those of the keyword manuals, without blanks. A keyword that stands in neither, and that no reader reads, is
# unknown: it is named, and what comes of the file is not to be trusted.
# ----------------------------------------------------------------------------------------------------------------------

_REASONS: Final = {
    "sensitivities and optimisation": "CORRELATIONLENGTH GEOMETRICTOLERANCES CONSTRAINT",
    "output of matrices or to other files": "SUBSTRUCTUREMATRIXOUTPUT FILEOUTPUT ELEMENTMATRIXOUTPUT MATRIXGENERATE",
    "plasticity, friction or contact that a step changes": "CHANGEPLASTIC CHANGESURFACEBEHAVIOR CHANGECONTACTTYPE",
    "text": ("HEADING PARAMETER"),
    "output": (
        "NODEPRINT NODEFILE NODEOUTPUT NODERESPONSE ELPRINT ELFILE ELEMENTOUTPUT ELOUTPUT OUTPUT CONTACTFILE "
        "CONTACTPRINT CONTACTOUTPUT ENERGYPRINT ENERGYFILE ENERGYOUTPUT SECTIONPRINT SECTIONFILE FILEFORMAT "
        "PREPRINT FILTER MODALFILE MODALOUTPUT MODALPRINT MONITOR PRINT RADIATIONFILE RADIATIONOUTPUT "
        "INTEGRATEDOUTPUT INTEGRATEDOUTPUTSECTION SURFACEOUTPUT FACEPRINT ELEMENTRESPONSE DESIGNRESPONSE "
        "MODALRESPONSE OBJECTIVE"
    ),
    "a step, its procedure and control": (
        "STEP ENDSTEP FREQUENCY STATIC DYNAMIC BUCKLE MODALDYNAMIC STEADYSTATEDYNAMICS COMPLEXFREQUENCY "
        "RANDOMRESPONSE RESPONSESPECTRUM CONTROLS TIMEPOINTS RESTART NOANALYSIS VISCO SOLUTIONTECHNIQUE "
        "HEATTRANSFER COUPLEDTEMPERATURE-DISPLACEMENT UNCOUPLEDTEMPERATURE-DISPLACEMENT GREEN SENSITIVITY "
        "SELECTEIGENMODES SELECTCYCLICSYMMETRYMODES ELECTROMAGNETICS CFD ERRORESTIMATE STEADYSTATE ROBUSTDESIGN "
        "FEASIBLEDIRECTION DESIGNVARIABLES CRACKPROPAGATION BULKVISCOSITY VARIABLEMASSSCALING FIXEDMASSSCALING "
        "GEOSTATIC ANNEAL DIRECTCYCLIC CONTACTCONTROLS SECTIONCONTROLS DIAGNOSTICS NETWORKMPC CONSTRAINTCONTROLS"
    ),
    "a load": (
        "CLOAD DLOAD DSLOAD DECHARGE CECHARGE CFLUX DFLUX DSFLUX FILM SFILM RADIATE SRADIATE TEMPERATURE FIELD "
        "AMPLITUDE BASEMOTION PSDDEFINITION CORRELATION MASSFLOWRATE LOADCASE ENDLOADCASE INCIDENTWAVE "
        "INERTIARELIEF CONNECTORLOAD CONNECTORMOTION SPECTRUM"
    ),
    "damping, which the model states": ("DAMPING MODALDAMPING GLOBALDAMPING DASHPOTDAMPING"),
    "heat, electricity and fluids": (
        "CONDUCTIVITY SPECIFICHEAT EXPANSION LATENTHEAT PHYSICALCONSTANTS ELECTRICALCONDUCTIVITY "
        "MAGNETICPERMEABILITY FLUIDCONSTANTS SPECIFICGASCONSTANT VALUESATINFINITY INELASTICHEATFRACTION "
        "GAPHEATGENERATION GAPCONDUCTANCE GAPRADIATION EMISSIVITY FLUIDSECTION VIEWFACTOR CAVITYDEFINITION "
        "VIEWFACTORMATRIX"
    ),
    "plasticity, creep and failure": (
        "PLASTIC CYCLICHARDENING CREEP DEFORMATIONPLASTICITY RATEDEPENDENT VISCOELASTIC MOHRCOULOMB "
        "MOHRCOULOMBHARDENING DRUCKERPRAGER CAPPLASTICITY POTENTIAL DAMAGEINITIATION DAMAGEEVOLUTION FAILSTRAIN "
        "FAILSTRESS TENSILEFAILURE SHEARFAILURE HYSTERESIS MULLINSEFFECT POLYMERDENT"
    ),
    "the material, which the model states": (
        "HYPERELASTIC HYPERFOAM USERMATERIAL DEPVAR MATERIALDAMPING UNIAXIALTESTDATA BIAXIALTESTDATA PLANARTESTDATA "
        "VOLUMETRICTESTDATA NOTENSION NOCOMPRESSION EOS"
    ),
    "a section or property of what is named itself": (
        "BEAMSECTION BEAMGENERALSECTION FRAMESECTION BEAMSECTIONOFFSET CENTROID SHEARCENTER SECTIONPOINTS "
        "TRANSVERSESHEAR CONNECTORBEHAVIOR CONNECTORELASTICITY CONNECTORDAMPING CONNECTORSTOP CONNECTORLOCK "
        "SURFACEINTERACTION SURFACEBEHAVIOR FRICTION CLEARANCE CONTACTDAMPING CONTACTINTERFERENCE CHANGEFRICTION "
        "FASTENERPROPERTY GAPELASTICITY SURFACEPROPERTY SURFACEPROPERTYASSIGNMENT CONTACTPROPERTYASSIGNMENT "
        "CONTACTFORMULATION CONTACTINITIALIZATIONDATA CONTACTINITIALIZATIONASSIGNMENT CONTACTEXCLUSIONS "
        "CONTACTCLEARANCE CONTACTCLEARANCEASSIGNMENT SLIDELINE ASYMMETRICAXISYMMETRICELEMENTS "
        "CONTACTCONTROLSASSIGNMENT CONTACTSTABILIZATION"
    ),
    "directions, where a section asks for them": ("ORIENTATION DISTRIBUTION DISTRIBUTIONTABLE NORMAL"),
    "thicknesses of nodes, where a section asks for them": ("NODALTHICKNESS"),
    "an end": ("ENDPART ENDASSEMBLY ENDINSTANCE"),
}
WITHOUT_EFFECT: Final[Mapping[str, str]] = {
    word: reason for reason, words in _REASONS.items() for word in words.split()
}
"""Keywords by why they have no effect."""

_LEFT: Final[tuple[tuple[Makes, str, str], ...]] = (
    (Makes.LINKS, "equations between nodes", "EQUATION MPC"),
    (Makes.LINKS, "surfaces or nodes that are joined", "TIE EMBEDDEDELEMENT SHELLTOSOLIDCOUPLING DISTRIBUTINGCOUPLING"),
    (Makes.LINKS, "joints between nodes", "CONNECTORSECTION FASTENER RELEASE"),
    (Makes.LINKS, "surfaces in contact", "CONTACTPAIR CONTACT CONTACTINCLUSIONS MODELCHANGE"),
    (Makes.LINKS, "a sector that is repeated about an axis", "CYCLICSYMMETRYMODEL"),
    (Makes.LINKS, "a rigid surface", "RIGIDSURFACE ANALYTICALSURFACE DISPLAYBODY"),
    (Makes.SPRINGS, "springs or dashpots between nodes", "SPRING DASHPOT GAP JOINT BUSHING"),
    (Makes.SPRINGS, "springs to the ground on faces", "FOUNDATION ELEMENTFOUNDATION"),
    (Makes.MASSES, "moments of inertia at nodes", "ROTARYINERTIA"),
    (Makes.SECTION, "materials or sections that a step changes", "CHANGEMATERIAL CHANGESOLIDSECTION"),
    (Makes.ELEMENTS, "elements that are made of others", "REFINEMESH"),
    (Makes.SECTION, "cells of another section", "SHELLGENERALSECTION COHESIVESECTION GASKETSECTION "
     "SURFACESECTION REBAR REBARLAYER REINFORCEMENT TRANSVERSESHEARSTIFFNESS HOURGLASSSTIFFNESS EULERIANSECTION"),
    (Makes.PRELOAD, "bolts that are drawn tight", "PRE-TENSIONSECTION"),
    (Makes.PRELOAD, "stress or strain that is there from the start", "PRESTRESSHOLD IMPORT MAPSOLUTION"),
    (Makes.ELEMENTS, "matrices, elements or other structures that are added",
     "SUPERELEMENT SUBSTRUCTURE SUBSTRUCTUREPROPERTY SUBSTRUCTUREPATH SUBSTRUCTUREGENERATE MATRIXINPUT MATRIXASSEMBLE "
     "MATRIX USERELEMENT UELPROPERTY ACOUSTICMEDIUM FLUIDCAVITY FLUIDBEHAVIOR RETAINEDNODALDOFS"),
    (Makes.SECTION, "nodes that are moved before the start", "IMPERFECTION ADAPTIVEMESH INITIALSTRAININCREASE"),
    (Makes.SUPPORTS, "held nodes", "BOUNDARYF SECONDARYBASE BASE"),
)  # fmt: skip
LEFT_OUT: Final[Mapping[str, tuple[Makes, str]]] = {
    word: (makes, changes) for makes, changes, words in _LEFT for word in words.split()
}
"""Keywords that no reader makes, by what they would make and change."""

OPTIONS: Final[Mapping[str, str]] = {
    "NODE": "NSET SYSTEM INPUT",
    "ELEMENT": "TYPE ELSET",
    "NSET": "NSET GENERATE INSTANCE INTERNAL UNSORTED",
    "ELSET": "ELSET GENERATE INSTANCE INTERNAL UNSORTED",
    "SHELLSECTION": "ELSET MATERIAL OFFSET NODALTHICKNESS COMPOSITE ORIENTATION STACKDIRECTION SYMMETRIC POISSON "
    "SECTIONINTEGRATION TEMPERATURE CONTROLS THICKNESSMODULUS ZEROINITIALSTRESS LAYUP",
    "SOLIDSECTION": "ELSET MATERIAL ORIENTATION COMPOSITE CONTROLS STACKDIRECTION REFNODE NODALTHICKNESS LAYUP",
    "NONSTRUCTURALMASS": "ELSET UNITS DISTRIBUTION",
    "MEMBRANESECTION": "ELSET MATERIAL CONTROLS POISSON",
    "BOUNDARY": "OP AMPLITUDE FIXED TYPE LOADCASE",
    "MASS": "ELSET ALPHA COMPOSITE",
    "RIGIDBODY": "REFNODE NSET TIENSET PINNSET ELSET ANALYTICALSURFACE POSITION ISOTHERMAL ROTNODE",
    "SURFACE": "TYPE NAME INTERNAL COMBINE",
    "COUPLING": "CONSTRAINTNAME REFNODE SURFACE ORIENTATION ALPHA",
    "KINEMATIC": "",
    "DISTRIBUTING": "COUPLING",
    "KINEMATICCOUPLING": "REFNODE ORIENTATION",
    "TRANSFORM": "NSET TYPE",
    "MATERIAL": "NAME RTOL SRATEFACTOR STRAINRATEREGULARIZATION",
    "ELASTIC": "TYPE MODULI DEPENDENCIES COMPRESSIONFACTOR",
    "DENSITY": "DEPENDENCIES PPORTION",
    "PART": "NAME",
    "INSTANCE": "NAME PART LIBRARY INSTANCE",
    "ASSEMBLY": "NAME",
    "INITIALCONDITIONS": "TYPE USER FILE INPUT STEP INC MIDSIDE",
}
"""Options of keywords that are read, or that have no effect on a linear model of vibration, by keyword."""

ONE_LINE: Final = ("SHELLSECTION", "SOLIDSECTION", "MEMBRANESECTION", "MASS")
"""Keywords that have one line of data."""


# ----------------------------------------------------------------------------------------------------------------------
# Keywords of an input file of Abaqus, and what has been read of it so far.
# ----------------------------------------------------------------------------------------------------------------------


class Keyword(NamedTuple):
    """A line with a star and the data that follow it. number : of the line, from 1. word : in capitals, without blanks;
    written : with those of the file."""

    path: Path
    number: int
    word: str
    options: Mapping[str, str]
    rows: list[tuple[int, list[str]]]
    written: str

    def option(self, name: str) -> str:
        """The value of an option that it must have."""
        if not self.options.get(name):
            raise wrong_line(self.path, self.number, f"*{self.word} without {name}", f"{name}=...")
        return self.options[name]

    def leave_out(self, deck: Deck, makes: Makes, changes: str, what: str = "") -> None:
        """Count it, or what it does, among what is left out."""
        deck.left_out.add(f"*{what or self.written}", makes, changes, self.number)


def known_as(sets: Mapping[str, object], name: str) -> str:
    """The name of a set as it was written first: Abaqus does not tell small letters from large ones."""
    name = name.strip().strip('"')
    return next((one for one in sets if one.upper() == name.upper()), name) if name not in sets else name


@dataclass
class Deck:
    """What has been read so far. lumps : nodes of elements of type MASS, by their sets. surfaces : nodes of
    those of TYPE=NODE, and their weights. coupling : the last *COUPLING, which the next keyword completes."""

    nodes: list[Integers] = field(default_factory=list)
    points: list[Floats] = field(default_factory=list)
    blocks: list[CellBlock] = field(default_factory=list)
    node_sets: dict[str, list[Integers]] = field(default_factory=dict)
    cell_sets: dict[str, list[Integers]] = field(default_factory=dict)
    properties: list[StatedProperty] = field(default_factory=list)
    materials: dict[str, dict[str, float]] = field(default_factory=dict)
    masses: list[StatedMass] = field(default_factory=list)
    links: list[StatedLink] = field(default_factory=list)
    holds: list[StatedHold] = field(default_factory=list)
    lumps: dict[str, list[int]] = field(default_factory=dict)
    surfaces: dict[str, tuple[Integers, tuple[float, ...]]] = field(default_factory=dict)
    coupling: Keyword | None = None
    left_out: Tally = field(default_factory=Tally)
    of_sets: list[tuple[str, str, Makes, str, int]] = field(default_factory=list)  # left out, of cells to come
    spread: list[tuple[str, StatedSpread, int]] = field(default_factory=list)  # set, mass on it, line
    others: list[int] = field(default_factory=list)  # elements that are left out, which sets may name
    turned: list[Integers] = field(default_factory=list)  # nodes with directions of their own, of *TRANSFORM
    turned_at: int = 0
    anew: int = 0  # the last step that lets go of what was held before
    elements: dict[str, list[Integers]] = field(default_factory=dict)
    parts: list[str] = field(default_factory=list)
    instances: list[str] = field(default_factory=list)


# ----------------------------------------------------------------------------------------------------------------------
# Sections of an input file of Abaqus: thickness and material of sets of cells, and what of it is not made.
# ----------------------------------------------------------------------------------------------------------------------

_PER: Final[Mapping[str, Literal["area", "volume", "total"]]] = {
    "MASS PER AREA": "area", "MASS PER VOLUME": "volume", "TOTAL MASS": "total",
}  # fmt: skip
_OFFSETS: Final = {"SPOS": 0.5, "SNEG": -0.5, "MIDDLE": 0.0, "MIDSURFACE": 0.0}  # of the thickness


def shell_section(keyword: Keyword, deck: Deck) -> None:
    """Thickness and material, or layers; offset, thickness by node and directions are named."""
    options, name = keyword.options, known_as(deck.cell_sets, keyword.option("ELSET"))

    def leave(option: str, makes: Makes, changes: str) -> None:
        deck.of_sets.append((name, f"{option} of *SHELL SECTION", makes, changes, keyword.number))

    if "COMPOSITE" in options:
        layers = _layers(keyword)
        leave("COMPOSITE", Makes.LAY_UP, f"{len(layers)} layers")
        deck.properties.append(StatedProperty(name, None, options.get("MATERIAL", ""), layers))
    else:
        given = [(number, words[:1]) for number, words in keyword.rows[:1] if words and words[0]]
        thickness = float(floats(keyword.path, given)[0]) if given else None
        deck.properties.append(StatedProperty(name, thickness, options.get("MATERIAL", "")))
        if "ORIENTATION" in options:
            leave("ORIENTATION", Makes.ORIENTATION, "a direction of the material")
    if _is_off(options.get("OFFSET", "0")):
        what = f"the middle of the thickness lies {options['OFFSET']} of the thickness beside the nodes"
        leave("OFFSET", Makes.OFFSET, what)
    if "NODALTHICKNESS" in options:
        leave("NODAL THICKNESS", Makes.THICKNESS, "a thickness at each node")


def nonstructural_mass(keyword: Keyword, deck: Deck) -> None:
    """Mass on the cells of a set: per area or volume of them, or all of it."""
    units = " ".join(keyword.options.get("UNITS", "").upper().split())
    if units not in _PER or not keyword.rows or not keyword.rows[0][1]:
        keyword.leave_out(deck, Makes.SECTION, "mass of cells")
        return
    number, words = keyword.rows[0]
    name = known_as(deck.cell_sets, keyword.option("ELSET"))
    amount = float(floats(keyword.path, [(number, words[:1])])[0])
    spread = StatedSpread(f"*{keyword.written} of {name}", np.zeros(0, np.int64), amount, _PER[units])
    deck.spread.append((name, spread, keyword.number))


def spread_on(deck: Deck, cell_sets: Mapping[str, Integers]) -> tuple[StatedSpread, ...]:
    """Mass on cells by their numbers, and count it, for parts that do not take it."""
    found = []
    for name, one, line in deck.spread:
        cells = cell_sets.get(name, np.zeros(0, np.int64))
        how = "in all" if one.per == "total" else f"per {one.per}"
        deck.left_out.add(one.what, Makes.SPREAD, f"{one.amount:g} of mass {how}, which does not stiffen", line, cells)
        found.append(replace(one, cells=cells))
    return tuple(found)


def _is_off(word: str) -> bool:
    """Whether an offset is another one than 0: a number, a face, or the name of a distribution."""
    try:
        return float(_OFFSETS.get(word.upper(), word or 0)) != 0.0
    except ValueError:
        return True


def membrane_section(keyword: Keyword, deck: Deck) -> None:
    """Cells without stiffness in bending, which shells here have."""
    options, name = keyword.options, known_as(deck.cell_sets, keyword.option("ELSET"))
    given = [(number, words[:1]) for number, words in keyword.rows[:1] if words and words[0]]
    thickness = float(floats(keyword.path, given)[0]) if given else None
    deck.properties.append(StatedProperty(name, thickness, options.get("MATERIAL", "")))
    what = "a membrane, without stiffness in bending"
    deck.of_sets.append((name, f"*{keyword.written}", Makes.SECTION, what, keyword.number))


def _layers(keyword: Keyword) -> tuple[StatedLayer, ...]:
    """Rows of a thickness, points over it, a material and an angle or the name of an orientation."""
    found = []
    for number, words in keyword.rows:
        thickness, _, material, turned, *_ = [*words, "", "", "", ""]
        if not material:
            raise wrong_line(keyword.path, number, f"'{', '.join(words)}'", "thickness, points, material, orientation")
        angle: float | str = turned
        with suppress(ValueError):
            angle = float(turned or 0)
        found.append(StatedLayer(material, float(floats(keyword.path, [(number, [thickness])])[0]), angle))
    return tuple(found + found[::-1] if "SYMMETRIC" in keyword.options else found)


def solid_section(keyword: Keyword, deck: Deck) -> None:
    """The material; layers and directions are named."""
    options, name = keyword.options, known_as(deck.cell_sets, keyword.option("ELSET"))
    deck.properties.append(StatedProperty(name, None, options.get("MATERIAL", "")))
    word = f"of *{keyword.written}"
    if "COMPOSITE" in options:
        what = "layers of other materials"
        deck.of_sets.append((name, f"COMPOSITE {word}", Makes.SECTION, what, keyword.number))
    elif "ORIENTATION" in options:
        what = "directions of the material"
        deck.of_sets.append((name, f"ORIENTATION {word}", Makes.ORIENTATION, what, keyword.number))


# ----------------------------------------------------------------------------------------------------------------------
# What an input file of Abaqus states beside its mesh: held nodes, masses, rigid bodies.
# ----------------------------------------------------------------------------------------------------------------------

_DIRECTIONS: Final = {  # held by the types of *BOUNDARY, counted from 1
    "ENCASTRE": (1, 2, 3, 4, 5, 6), "PINNED": (1, 2, 3), "XSYMM": (1, 5, 6), "YSYMM": (2, 4, 6), "ZSYMM": (3, 4, 5),
    "XASYMM": (2, 3, 4), "YASYMM": (1, 3, 5), "ZASYMM": (1, 2, 6),
}  # fmt: skip


def is_number(word: str) -> bool:
    """Whether a word is a whole number."""
    return word.lstrip("+-").isdigit()


def nodes_named(keyword: Keyword, number: int, which: str, deck: Deck) -> Integers:
    """A node by its number, or those of a set."""
    which = which.strip('"')
    if is_number(which):
        return np.array([int(which)])
    by_case = {one.upper(): one for one in deck.node_sets}
    if which.upper() not in by_case:
        raise wrong_line(keyword.path, number, f"'{which}', no set of nodes above", "a node or a set of nodes")
    return np.concatenate([np.zeros(0, np.int64), *deck.node_sets[by_case[which.upper()]]])


def held_nodes(keyword: Keyword, deck: Deck) -> None:
    """Nodes held at zero, by number or set."""
    for number, words in keyword.rows:
        which = words[0].strip('"')
        nodes = nodes_named(keyword, number, which, deck)
        if len(words) > 1 and words[1].upper() in _DIRECTIONS:
            held = _DIRECTIONS[words[1].upper()]
        else:
            given = [word for word in words[1:3] if word]
            ends = integers(keyword.path, [(number, given)]).tolist()
            if not ends:
                raise wrong_line(keyword.path, number, f"'{', '.join(words)}'", "a first and a last direction")
            held = tuple(one for one in range(ends[0], ends[-1] + 1) if 1 <= one <= 6)
        moved = [word for word in words[3:4] if word and floats(keyword.path, [(number, [word])])[0] != 0.0]
        if moved:
            keyword.leave_out(deck, Makes.SUPPORTS, "held nodes", "BOUNDARY that moves nodes")
        elif held:
            deck.holds.append(StatedHold(f"boundary {which}", nodes, tuple(one - 1 for one in held)))


def masses(keyword: Keyword, deck: Deck) -> None:
    """A mass at each node of a set of elements of type MASS."""
    name = keyword.option("ELSET")
    nodes = {one.upper(): some for one, some in deck.lumps.items()}.get(name.upper())
    if nodes is None:
        keyword.leave_out(deck, Makes.MASSES, "masses at nodes")
        return
    value = float(floats(keyword.path, keyword.rows[:1])[0]) if keyword.rows else 0.0
    deck.masses += [StatedMass(node, value, (0.0, 0.0, 0.0), (0.0,) * 6) for node in nodes]


def rigid_body(keyword: Keyword, deck: Deck) -> None:
    """Nodes that follow a reference node: with their rotations (NSET, TIE NSET), or their shifts only (PIN NSET)."""
    sets = {"NSET": range(6), "TIENSET": range(6), "PINNSET": range(3)}
    leads = nodes_named(keyword, keyword.number, keyword.option("REFNODE"), deck)
    if (
        len(leads) != 1
        or not sets.keys() & keyword.options.keys()
        or {"ELSET", "ANALYTICALSURFACE"} & keyword.options.keys()
    ):
        keyword.leave_out(deck, Makes.LINKS, "a rigid body of elements or of a surface")
        return
    for key, follows in sets.items():
        if key in keyword.options:
            nodes = nodes_named(keyword, keyword.number, keyword.options[key], deck)
            nodes = nodes[nodes != leads[0]]
            if len(nodes):
                deck.links.append(StatedLink(int(leads[0]), nodes, tuple(follows)))


def node_surface(keyword: Keyword, deck: Deck) -> None:
    """Nodes of a surface of TYPE=NODE, with a weight each; surfaces of faces of elements are not read."""
    if keyword.options.get("TYPE", "ELEMENT").upper() != "NODE":
        return
    nodes, weights = [], []
    for number, words in keyword.rows:
        some = nodes_named(keyword, number, words[0], deck)
        given = [word for word in words[1:2] if word]
        nodes.append(some)
        weights += len(some) * [float(floats(keyword.path, [(number, given)])[0]) if given else 1.0]
    deck.surfaces[keyword.option("NAME").upper()] = np.concatenate([np.zeros(0, np.int64), *nodes]), tuple(weights)


def coupling(keyword: Keyword, deck: Deck) -> None:
    """What *KINEMATIC or *DISTRIBUTING behind it completes; one that nothing completes says nothing."""
    deck.coupling = keyword


def couple_to_reference(keyword: Keyword, deck: Deck) -> None:
    """Nodes of a surface that follow a reference node, or whose mean motion it follows."""
    head = deck.coupling
    if head is None:
        raise wrong_line(keyword.path, keyword.number, f"*{keyword.word} alone", "*COUPLING before it")
    found = deck.surfaces.get(head.option("SURFACE").upper())
    leads = nodes_named(head, head.number, head.option("REFNODE"), deck)
    follows = _directions(keyword, keyword.rows)
    mean = keyword.word == "DISTRIBUTING"
    if found is None or len(leads) != 1 or "ORIENTATION" in head.options or (mean and not sum(found[1]) > 0.0):
        head.leave_out(deck, Makes.LINKS, "faces that follow a node")
        return
    nodes, weights = found
    others = nodes != leads[0]
    if not others.any():
        return
    kept = tuple(weight for weight, other in zip(weights, others.tolist(), strict=True) if other)
    deck.links.append(StatedLink(int(leads[0]), nodes[others], follows, kept if mean else None))


def kinematic_coupling(keyword: Keyword, deck: Deck) -> None:
    """Nodes or sets, each with a first and a last direction, that follow a reference node."""
    leads = nodes_named(keyword, keyword.number, keyword.option("REFNODE"), deck)
    if len(leads) != 1 or "ORIENTATION" in keyword.options:
        keyword.leave_out(deck, Makes.LINKS, "nodes that follow a node")
        return
    for number, words in keyword.rows:
        nodes = nodes_named(keyword, number, words[0], deck)
        follows = _directions(keyword, [(number, words[1:])])
        if (nodes != leads[0]).any():
            deck.links.append(StatedLink(int(leads[0]), nodes[nodes != leads[0]], follows))


def _directions(keyword: Keyword, rows: list[tuple[int, list[str]]]) -> tuple[int, ...]:
    """Directions out of 0 to 5 of rows of a first and a last one; all of them where none is given."""
    found: set[int] = set()
    for number, words in rows:
        ends = integers(keyword.path, [(number, [word for word in words[:2] if word])]).tolist()
        found |= set(range(ends[0], ends[-1] + 1)) if ends else set()
    return tuple(one for one in range(6) if one + 1 in found) or tuple(range(6))


def transform(keyword: Keyword, deck: Deck) -> None:
    """Nodes whose supports and links are along directions of their own; see `along_own_directions`."""
    kind = keyword.options.get("TYPE", "R").upper()
    row = floats(keyword.path, keyword.rows[:1])
    if kind == "R" and len(row) >= 6:
        x, y = row[:3], row[3:6]
        if not x[1:].any() and x[0] > 0.0 and y[1] > 0.0 and y[2] == 0.0:
            return  # along the global directions
    deck.turned.append(nodes_named(keyword, keyword.number, keyword.option("NSET"), deck))
    deck.turned_at = deck.turned_at or keyword.number


def along_own_directions(deck: Deck) -> None:
    """Leave out supports and links in some of the directions of *TRANSFORM; in all three they have no direction."""
    turned = np.unique(np.concatenate([np.zeros(0, np.int64), *deck.turned]))
    why = "in directions of *TRANSFORM"
    found = in_global_directions(deck.holds, deck.links, turned, deck.left_out, why, deck.turned_at)
    deck.holds, deck.links = found


def initial_conditions(keyword: Keyword, deck: Deck) -> None:
    """What is there from the start: stress changes the stiffness, the rest has no effect."""
    kind = keyword.options.get("TYPE", "").upper().replace(" ", "")
    if kind in ("STRESS", "PLASTICSTRAIN", "HARDENING"):
        keyword.leave_out(deck, Makes.PRELOAD, "stress that is there from the start", f"{keyword.written}, TYPE={kind}")
    else:
        keyword.leave_out(deck, Makes.NOTHING, "temperatures, speeds or other states at the start")


STATED: Final[Mapping[str, Callable[[Keyword, Deck], None]]] = {
    "BOUNDARY": held_nodes,
    "MASS": masses,
    "RIGIDBODY": rigid_body,
    "SURFACE": node_surface,
    "COUPLING": coupling,
    "KINEMATIC": couple_to_reference,
    "DISTRIBUTING": couple_to_reference,
    "KINEMATICCOUPLING": kinematic_coupling,
    "TRANSFORM": transform,
    "INITIALCONDITIONS": initial_conditions,
}


# ----------------------------------------------------------------------------------------------------------------------
# Meshes of Abaqus and CalculiX: .inp.
#
# Read here and not by meshio 5.3, which keeps the last of several *NODE blocks only, and neither sections nor
# materials.
# ----------------------------------------------------------------------------------------------------------------------

LARGEST: Final = 500_000_000  # bytes
_KINDS: Final = (  # names of element types in Abaqus and CalculiX, as patterns
    (r"(S3|STRI3|CPS3|CPE3|CAX3|M3D3|R3D3|SFM3D3)[A-Z]*", "tri3"),
    (r"(S4|CPS4|CPE4|CAX4|M3D4|R3D4|SFM3D4)(5|R5|[A-Z]*)", "quad4"),
    (r"(S6|STRI65|CPS6|CPE6|M3D6)[A-Z]*", "tri6"),
    (r"(S8|CPS8|CPE8|M3D8)(R5|[A-Z]*)", "quad8"),
    (r"S9R5|M3D9R?", "quad9"),
    (r"C3D4[A-Z]*", "tet4"),
    (r"C3D10[A-Z]*", "tet10"),
    (r"C3D8[A-Z]*", "hex8"),
    (r"C3D20[A-Z]*", "hex20"),
    (r"(B31|B33|T3D2)[A-Z]*", "line2"),
    (r"(B32|T3D3)[A-Z]*", "line3"),
)
_MARKS: Final = ("T3D", "CPS", "CPE", "CAX", "SFM", "R3D")  # as which mesh programs write edges and faces
_PLANE: Final = ("CPS", "CPE", "CAX")
_ORDER: Final = {"line3": [0, 2, 1]}  # the middle node of a bar is its second one
_MOVES: Final = ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "SUBMODEL", "SYMMETRICMODELGENERATION")
_LOADING: Final = ("STATIC", "VISCO", "COUPLEDTEMPERATURE-DISPLACEMENT", "DYNAMIC")
_VIBRATING: Final = ("FREQUENCY", "COMPLEXFREQUENCY")
_LEFT_OUT: Final[Mapping[str, tuple[Makes, str]]] = {  # types of elements that are not made
    "MASS": (Makes.MASSES, "masses at nodes"),
    "ROTARYI": (Makes.MASSES, "moments of inertia at nodes"),
    **dict.fromkeys(("SPRINGA", "SPRING1", "SPRING2"), (Makes.SPRINGS, "springs at nodes")),
    **dict.fromkeys(("DASHPOTA", "DASHPOT1", "DASHPOT2"), (Makes.SPRINGS, "dashpots at nodes")),
    **dict.fromkeys(("GAPUNI", "GAPCYL", "GAPSPHER"), (Makes.SPRINGS, "gaps between nodes")),
    "DCOUP3D": (Makes.LINKS, "nodes that follow others"),
}
_FIRST: Final = ("NODE", "ELEMENT", "NSET", "ELSET")  # what other keywords may name before it stands there
_NAMES: Final = ("PART", "INSTANCE", "ASSEMBLY")


def read_abaqus(path: Path, data: bytes) -> Gathered:
    """What an input file has: nodes, elements, sets, sections, materials and held nodes of its model.

    What would move nodes is refused; every other keyword and option that no reader reads is counted among what is left
    out, as the tables of `words` have it. Raises InputErrors with file and line.
    """
    deck = Deck()
    keywords: list[Keyword] = []
    files = _keywords(path, data, 0, keywords)
    for keyword in keywords:
        if keyword.word in _FIRST:
            _take(keyword, deck)
    material, step, judged = "", 0, _step_that_vibrates(keywords)
    for keyword in keywords:
        step += keyword.word == "STEP"
        if keyword.word == "MATERIAL":
            material = keyword.option("NAME")
            deck.materials[material] = {}
        if step > judged and keyword.word == "BOUNDARY":
            keyword.leave_out(deck, Makes.SLIGHT, "held nodes of a later state", "BOUNDARY of a later step")
        elif keyword.word in ("ELASTIC", "DENSITY"):
            _constants(keyword, deck.materials.setdefault(material, {}))
        elif keyword.word not in _FIRST:
            if keyword.word == "BOUNDARY" and keyword.options.get("OP", "").upper() == "NEW" and step > deck.anew:
                deck.holds, deck.anew = [], step  # what was held before is free
            _take(keyword, deck)
    if not deck.nodes:
        raise InputError("", got=f"'{path.name}' without *NODE", expected="an input file with nodes and elements")
    _preload(keywords, deck)
    along_own_directions(deck)
    cell_sets = _without_others(deck)
    for name, what, makes, changes, line in deck.of_sets:
        deck.left_out.add(what, makes, changes, line, cell_sets.get(name, ()))
    spread = spread_on(deck, cell_sets)
    elements = _elements_by_type(deck, cell_sets)
    _plane_elements(deck, elements)
    stated = Stated(
        tuple(deck.properties),
        tuple(StatedMaterial(name, constants) for name, constants in deck.materials.items()),
        masses=tuple(deck.masses),
        links=tuple(deck.links),
        holds=tuple(deck.holds),
        left_out=deck.left_out.found,
        elements=elements,
        active=tuple(dict.fromkeys(one.name for one in deck.holds)),
        spread=spread,
    )
    return Gathered(
        np.concatenate(deck.nodes),
        np.concatenate(deck.points),
        deck.blocks,
        {name: np.concatenate(some) for name, some in deck.node_sets.items() if some},
        cell_sets,
        stated,
        included=files,
    )


def _step_that_vibrates(keywords: list[Keyword]) -> int:
    """The number of the step, from 1, whose supports are those of the model: the first that asks for modes, or the
    first one; what is held in steps before holds on."""
    step = 0
    for keyword in keywords:
        step += keyword.word == "STEP"
        if keyword.word in _VIBRATING:
            return step
    return 1


def _without_others(deck: Deck) -> dict[str, Integers]:
    """Sets of elements without those that are left out, such as springs; those that had no others are gone."""
    made = {name: np.concatenate(some) for name, some in deck.cell_sets.items() if some}
    kept = {name: some[~np.isin(some, deck.others)] for name, some in made.items()}
    return {name: some for name, some in kept.items() if len(some) or not len(made[name])}


def _elements_by_type(deck: Deck, cell_sets: Mapping[str, Integers]) -> dict[str, Integers]:
    """Elements that have stiffness or mass by their type: of those that mesh programs write as marks, those with a
    section."""
    of_sections = np.concatenate([np.zeros(0, np.int64), *(cell_sets.get(one.cells, ()) for one in deck.properties)])
    made = {name: np.concatenate(some) for name, some in deck.elements.items()}
    real = {name: some[np.isin(some, of_sections)] if name.startswith(_MARKS) else some for name, some in made.items()}
    return {name: some.astype(np.int64) for name, some in real.items() if len(some)}


def _plane_elements(deck: Deck, elements: Mapping[str, Integers]) -> None:
    """Name elements of a plane problem, which a part would make a shell of."""
    for name, some in elements.items():
        if name.startswith(_PLANE):
            what = "elements of a plane or axisymmetric problem, without stiffness in bending"
            deck.left_out.add(f"{name} elements", Makes.SECTION, what, 0, some.tolist(), len(some))


def _preload(keywords: list[Keyword], deck: Deck) -> None:
    """Name a step whose vibration is that of a body under load: PERTURBATION, or large displacements, after a load."""
    loaded, large, perturbed, start = False, False, False, 0
    for keyword in keywords:
        if keyword.word == "STEP":
            perturbed, start = "PERTURBATION" in keyword.options, keyword.number
            large |= "NLGEOM" in keyword.options and keyword.options["NLGEOM"].upper() != "NO"
        elif keyword.word in _LOADING and not perturbed:
            loaded = True
        elif keyword.word in _VIBRATING and loaded and (perturbed or large):
            what = "a body under load vibrates, whose forces change its stiffness"
            deck.left_out.add(f"*{keyword.written} after a step of loads", Makes.PRELOAD, what, start)


def _keywords(path: Path, data: bytes, depth: int, found: list[Keyword]) -> tuple[Path, ...]:
    """Put all keywords with their data lines behind those that are found already; included files, which are returned,
    stand in their places, also within the data of a keyword."""
    pending = ""
    included: tuple[Path, ...] = ()
    for number, line in enumerate(lines_of(path, data), 1):
        if line.lstrip(" \t>").startswith("**") or not line.strip():
            continue
        text = pending + line.strip()
        pending = text if text.startswith("*") and text.endswith(",") else ""
        if pending:
            continue
        if not text.startswith("*"):
            if not found:
                raise wrong_line(path, number, f"'{text[:60]}' before all keywords", "a keyword, such as *NODE")
            found[-1].rows.append((number, [word.strip() for word in text.rstrip(",").split(",")]))
            continue
        first, *others = (one.strip() for one in text[1:].split(","))
        pairs = (one.partition("=") for one in others if one)
        options = {key.strip().upper().replace(" ", ""): value.strip().strip('"') for key, _, value in pairs}
        keyword = Keyword(path, number, first.upper().replace(" ", ""), options, [], " ".join(first.upper().split()))
        if keyword.word != "INCLUDE":
            found.append(keyword)
            continue
        if depth > 5:
            raise wrong_line(path, number, "files that include each other", "an end to it")
        try:
            inner = beside(str(path), keyword.option("INPUT"))
            more = _keywords(inner, content(inner, LARGEST, "an included file"), depth + 1, found)
            included = (*included, inner, *more)
        except InputError as error:
            if getattr(error, "errors", ()):
                raise
            raise wrong_line(path, number, error.got, error.expected, error.do) from None
    return included


def _take(keyword: Keyword, deck: Deck) -> None:
    """Read a keyword, or count it among what is left out; there is no third way."""
    word = keyword.word
    if word in _MOVES:
        got = f"*{word}, which makes or moves nodes or elements"
        raise wrong_line(keyword.path, keyword.number, got, "nodes and elements in full")
    if word in _READERS:
        _READERS[word](keyword, deck)
    elif word in WITHOUT_EFFECT:
        keyword.leave_out(deck, Makes.NOTHING, WITHOUT_EFFECT[word])
    elif word in LEFT_OUT:
        keyword.leave_out(deck, *LEFT_OUT[word])
    else:
        keyword.leave_out(deck, Makes.UNKNOWN, "a keyword that is not known: is it misspelt?")
    if word in ONE_LINE and "COMPOSITE" not in keyword.options and len(keyword.rows) > 1:
        what = f"data line 2 of *{keyword.written}"
        deck.left_out.add(what, Makes.UNKNOWN, "a line that is not read", keyword.rows[1][0])
    if word in OPTIONS:
        for option in keyword.options:
            if option not in OPTIONS[word].split():
                what = f"option {option} of *{keyword.written}"
                deck.left_out.add(what, Makes.UNKNOWN, "an option that is not read", keyword.number)


def _named(keyword: Keyword, deck: Deck) -> None:
    """Parts and instances: one of each, in its own place."""
    if keyword.word == "ASSEMBLY":
        return
    seen = deck.parts if keyword.word == "PART" else deck.instances
    seen.append(keyword.options.get("NAME", ""))
    if len(seen) > 1 or (keyword.word == "INSTANCE" and keyword.rows):
        got = "a second part" if keyword.word == "PART" else "an instance that is moved, or a second one"
        do = "write the input file without parts"
        raise wrong_line(keyword.path, keyword.number, got, "one part in its own place", do)


def _nodes(keyword: Keyword, deck: Deck) -> None:
    path = keyword.path
    if keyword.options.get("SYSTEM", "R").upper() not in ("", "R"):
        got = f"nodes in the coordinate system {keyword.options['SYSTEM']}"
        raise wrong_line(path, keyword.number, got, "x, y, z", "write the file in global coordinates")
    if "INPUT" in keyword.options:
        raise wrong_line(path, keyword.number, "nodes of another file", "nodes in this one", "write *INCLUDE, INPUT=..")
    wide = [(number, words) for number, words in keyword.rows if len(words) > 4 and any(map(_is_not_zero, words[4:]))]
    if wide:
        raise wrong_line(path, wide[0][0], f"{len(wide[0][1])} numbers of a node", "a number and x, y, z")
    numbers = integers(path, ((number, words[:1]) for number, words in keyword.rows))
    places = floats(
        path, ((number, [word or "0" for word in (*words[1:], "", "", "")[:3]]) for number, words in keyword.rows)
    )
    deck.nodes.append(numbers)
    deck.points.append(places.reshape(-1, 3))
    if "NSET" in keyword.options:
        deck.node_sets.setdefault(known_as(deck.node_sets, keyword.options["NSET"]), []).append(numbers)


def _is_not_zero(word: str) -> bool:
    """Whether a field has something else in it than zeros."""
    return bool(word.strip("0.+-eE"))


def _elements(keyword: Keyword, deck: Deck) -> None:
    name = keyword.option("TYPE").upper()
    if name == "MASS" and "ELSET" in keyword.options:
        wrong = next((number for number, words in keyword.rows if len(words) != 2), None)
        if wrong is not None:
            raise wrong_line(keyword.path, wrong, "an element of type MASS", "its number and its node")
        deck.others += integers(keyword.path, keyword.rows)[::2].tolist()
        deck.lumps.setdefault(keyword.options["ELSET"], []).extend(integers(keyword.path, keyword.rows)[1::2].tolist())
        return
    if name in _LEFT_OUT:
        numbers = integers(keyword.path, [(number, words[:1]) for number, words in keyword.rows]).tolist()
        deck.others += numbers
        makes, changes = _LEFT_OUT[name]
        deck.left_out.add(f"*ELEMENT, TYPE={name}", makes, changes, keyword.number, count=len(numbers))
        return
    kind = next((kind for pattern, kind in _KINDS if re.fullmatch(pattern, name)), None)
    if kind is None:
        raise wrong_line(
            keyword.path,
            keyword.number,
            f"elements of type {name}",
            "bars, shells, tetrahedra or hexahedra: B31, S3, S4, S8R, C3D4, C3D10, C3D8, C3D20 and their like",
        )
    width = 1 + KINDS[kind].nodes
    flat = integers(keyword.path, keyword.rows)
    if len(flat) % width:
        number, count = _odd_element(keyword, width)
        which = "the last element" if number == keyword.rows[-1][0] else "an element"
        got = f"{count} numbers of {which} of type {name}"
        raise wrong_line(keyword.path, number, got, f"{width}: its own and its nodes")
    rows = flat.reshape(-1, width)
    nodes = rows[:, 1:][:, _ORDER[kind]] if kind in _ORDER else rows[:, 1:]
    deck.blocks.append(CellBlock(kind, rows[:, 0], nodes))
    deck.elements.setdefault(name, []).append(rows[:, 0])
    if "ELSET" in keyword.options:
        deck.cell_sets.setdefault(known_as(deck.cell_sets, keyword.options["ELSET"]), []).append(rows[:, 0])


def _odd_element(keyword: Keyword, width: int) -> tuple[int, int]:
    """The line where the first element begins that has not `width` numbers, and how many it has."""
    start, count = keyword.number, 0
    for number, words in keyword.rows:
        if count and count + len(words) > width:
            break
        start = start if count else number
        count += len(words)
        if count > width:
            break
        count %= width
    return start, count


def _set(keyword: Keyword, deck: Deck) -> None:
    """Numbers, names of other sets, or first, last and step."""
    sets = deck.node_sets if keyword.word == "NSET" else deck.cell_sets
    into = sets.setdefault(known_as(sets, keyword.option(keyword.word)), [])
    by_case = {one.upper(): one for one in sets}
    for number, words in keyword.rows:
        if "GENERATE" in keyword.options:
            ends = integers(keyword.path, [(number, words)]).tolist()
            if len(ends) not in (2, 3) or (len(ends) == 3 and ends[2] < 1):
                raise wrong_line(keyword.path, number, f"'{', '.join(words)}'", "first, last and step")
            into.append(np.arange(ends[0], ends[1] + 1, ends[2] if len(ends) == 3 else 1))
            continue
        plain = [word for word in words if word and not is_number(word)]
        into.append(integers(keyword.path, [(number, [word for word in words if is_number(word)])]))
        for word in plain:
            other = by_case.get(word.strip('"').upper())
            if other is None:
                raise wrong_line(keyword.path, number, f"'{word}', no set above", "numbers or names of sets")
            into.extend(sets[other][:])


def _nothing(keyword: Keyword, deck: Deck) -> None:
    """What has been read where it stands: materials."""


def _constants(keyword: Keyword, constants: dict[str, float]) -> None:
    if keyword.options.get("TYPE", "ISOTROPIC").upper() not in ("ISOTROPIC", "ISO") or not keyword.rows:
        constants["other than isotropic"] = 1.0
        return
    values = floats(keyword.path, keyword.rows[:1]).tolist()
    constants.update(zip(("E", "nu") if keyword.word == "ELASTIC" else ("rho",), values, strict=False))


_READERS: Final[Mapping[str, Callable[[Keyword, Deck], None]]] = {
    "NODE": _nodes,
    "ELEMENT": _elements,
    "NSET": _set,
    "ELSET": _set,
    "SHELLSECTION": shell_section,
    "SOLIDSECTION": solid_section,
    "MEMBRANESECTION": membrane_section,
    "NONSTRUCTURALMASS": nonstructural_mass,
    "MATERIAL": _nothing,
    **dict.fromkeys(_NAMES, _named),
    **STATED,
}
