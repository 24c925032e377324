"""Cards of the bulk data of Nastran: fields and continuations, what has been read, cards that no reader makes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import isfinite, nan
from pathlib import Path
from typing import Final, Literal, NamedTuple

from femstruct.errors import InputError, InputErrors, quote_value
from femstruct.files.text_tables import beside, content, lines_of, wrong_line
from femstruct.model.imported_mesh import Makes, StatedLayer, StatedLink, StatedMass, StatedMaterial, Tally

# ----------------------------------------------------------------------------------------------------------------------
# Cards of Nastran that no reader makes, in two classes: of no effect on a linear model of vibration, and left out.
#
# Names are those of the Quick Reference Guide of MSC Nastran. A card that stands in neither, and that no reader reads,
# is unknown: it is named, and what comes of the file is not to be trusted.
# ----------------------------------------------------------------------------------------------------------------------

_REASONS: Final = {
    "a load": "FORCE FORCE1 FORCE2 FORCEAX MOMENT MOMENT1 MOMENT2 MOMAX PLOAD PLOAD1 PLOAD2 PLOAD4 PLOADX1 PRESAX "
    "GRAV ACCEL ACCEL1 SLOAD LOAD LSEQ DLOAD RLOAD1 RLOAD2 TLOAD1 TLOAD2 ACSRCE DAREA DELAY DPHASE SPCD DEFORM TIC "
    "LOADCYN LOADCYH LOADCYT RANDPS RANDT1 NOLIN1 NOLIN2 NOLIN3 NOLIN4 RFORCE",
    "a table of loads, damping or the solution": "TABLED1 TABLED2 TABLED3 TABLED4 TABRND1 TABRNDG TABDMP1 TABLEM1 "
    "TABLEM2 TABLEM3 TABLEM4 TABLES1 TABLEHT",
    "temperatures and heat": "TEMP TEMPD TEMPP1 TEMPP2 TEMPP3 TEMPRB TEMPN1 TEMPBC MAT4 MAT5 MATT4 MATT5 RADM RADMT "
    "RADSET RADBC RADLST RADMTX RADCAV CHBDYE CHBDYG CHBDYP PHBDY CONV CONVM PCONV PCONVM QHBDY QVOL QBDY1 QBDY2 QBDY3 "
    "QVECT VIEW VIEW3D VIEWEX",
    "control of the solution": "EIGRL EIGR EIGC EIGB EIGP FREQ FREQ1 FREQ2 FREQ3 FREQ4 FREQ5 TSTEP TSTEPNL NLPARM "
    "NLPCI NLADAPT NLSTEP MDLPRM ITER DOMAINS",
    "output, plots and notes": "PLOTEL PLOTEL3 PLOTEL4 DTI POINT BNDGRID STRNLOC SET4 SET5 MONPNT1 MONPNT2 MONPNT3 "
    "CHOUR GMNOTE",
    "an optimisation": "DESVAR DVPREL1 DVPREL2 DVCREL1 DVCREL2 DVMREL1 DVMREL2 DVGRID DVBSHAP DVSHAP DRESP1 DRESP2 "
    "DRESP3 DCONSTR DCONADD DEQATN DLINK DOPTPRM DSCREEN DTABLE DDVAL MODTRAK TOPVAR BEADVAR",
    "aeroelasticity": "AERO AEROS AECOMP AEFACT AELINK AELIST AEPARM AEPRESS AEFORCE AESTAT AESURF AESURFS CAERO1 "
    "CAERO2 CAERO3 CAERO4 CAERO5 PAERO1 PAERO2 PAERO3 PAERO4 PAERO5 SPLINE1 SPLINE2 SPLINE3 SPLINE4 SPLINE5 SET2 TRIM "
    "FLUTTER FLFACT MKAERO1 MKAERO2 GUST DIVERG CSSCHD",
    "a property of elements that are named themselves": "PBAR PBARL PBEAM PBEAML PBEAM3 PBCOMP PBEND PROD PTUBE PELAS "
    "PELAST PBUSH PBUSHT PBUSH1D PDAMP PDAMPT PDAMP5 PVISC PGAP PFAST PWELD PMASS PSHEAR PRAC2D PRAC3D BAROR BEAMOR",
    "degrees of freedom that a solution keeps: here it keeps all": "ASET ASET1 OMIT OMIT1 BSET BSET1 CSET CSET1 QSET "
    "QSET1 USET USET1 SUPORT SUPORT1",
    "plasticity and failure": "MATS1 CREEP MATF MATTC",
    "points without a place, of elements that are named themselves": "SPOINT EPOINT",
    "a coordinate system that nothing uses which is read": "CORD3G",
    "a sum of sets of equations that are named themselves": "MPCADD NSMADD",
}
WITHOUT_EFFECT: Final[Mapping[str, str]] = {
    card: reason for reason, cards in _REASONS.items() for card in cards.split()
}
"""Cards by why they have no effect."""

_LEFT: Final[tuple[tuple[Makes, str, str], ...]] = (
    (Makes.BARS, "rods: stiffness and mass", "CROD CONROD CTUBE"),
    (Makes.BARS, "bars: stiffness and mass", "CBEND CBEAM3"),
    (
        Makes.SPRINGS,
        "springs or dashpots between nodes",
        "CELAS1 CELAS2 CELAS3 CELAS4 CBUSH CBUSH1D CBUSH2D CDAMP1 CDAMP2 CDAMP3 CDAMP4 CDAMP5 CVISC CGAP GENEL",
    ),
    (Makes.LINKS, "fasteners and welds between nodes", "CFAST CWELD CSEAM"),
    (Makes.MASSES, "mass at nodes", "CMASS1 CMASS2 CMASS3 CMASS4 CONM1"),
    (Makes.SECTION, "mass of cells, where the case control chooses it", "NSM NSM1 NSML NSML1"),
    (
        Makes.LINKS,
        "rigid links or equations between nodes",
        "RBAR RBAR1 RBE1 RROD RTRPLT RTRPLT1 RSPLINE RSSCON RJOINT MPC MPCY MPCAX",
    ),
    (
        Makes.LINKS,
        "surfaces that are glued or in contact",
        "BCTABLE BCTABL1 BCONP BCONECT BCBODY BCBODY1 BCPROP BSURF BSURFS BCTSET BCTADD BCTPARM BGSET BGADD BGPARM "
        "BLSEG BFRIC BWIDTH BCRPARA BCPARA",
    ),
    (Makes.LINKS, "a sector that is repeated about an axis", "CYSYM CYJOIN CYAX CYSUP"),
    (Makes.ELEMENTS, "wedges and pyramids: stiffness and mass", "CPENTA CPYRAM CPYRA"),
    (
        Makes.ELEMENTS,
        "elements of a kind that is not made",
        "CSHEAR CQUAD CQUADX CQUADX4 CQUADX8 CTRIAX CTRIAX6 CTRIAX3 CTRAX3 CTRAX6 CPLSTN3 CPLSTN4 CPLSTN6 CPLSTN8 "
        "CPLSTS3 CPLSTS4 CPLSTS6 CPLSTS8 CRAC2D CRAC3D CHEXCZ CPENTCZ CCONEAX CHACAB CHACBR CIHEX1 CIHEX2 CHEXA1 "
        "CHEXA2 CFLUID2 CFLUID3 CFLUID4 CAABSF",
    ),
    (
        Makes.ELEMENTS,
        "superelements: other parts of the structure",
        "CSUPER CSUPEXT SEBULK SESET SELOC SEELT SEBNDRY SECONCT SEEXCLD SELABEL SEMPLN SETREE SEUPRES SEQSET SEQSET1 "
        "SESUP RELEASE EXTRN BEGIN",
    ),
    (Makes.SECTION, "matrices that are added, where the case control chooses them", "DMIG DMIGOUT DMI DMIJ DMIJI DMIK"),
    (Makes.SECTION, "moduli that change with temperature", "MATT1 MATT2 MATT3 MATT8 MATT9 MATT11"),
    (Makes.SUPPORTS, "held nodes", "SPCAX SPCR BNDFIX BNDFIX1 BNDFREE BNDFRE1"),
)
LEFT_OUT: Final[Mapping[str, tuple[Makes, str]]] = {
    card: (makes, changes) for makes, changes, cards in _LEFT for card in cards.split()
}
"""Cards that no reader makes, by what they would make and change."""

FIELDS_WITHOUT_EFFECT: Final[Mapping[str, Mapping[int, str]]] = {
    "MAT1": dict.fromkeys((5, 6, 8, 9, 10, 11), "heat and strength") | {7: "damping, which the model states"},
    "MAT2": dict.fromkeys(range(1, 20), "the material, which the model states"),
    "MAT9": dict.fromkeys(range(1, 40), "the material, which the model states"),
    "MAT8": dict.fromkeys(range(8, 24), "heat, strength and damping"),
    "MAT3": dict.fromkeys(range(1, 20), "the material, which the model states"),
    "MAT10": dict.fromkeys(range(1, 20), "the material, which the model states"),
    "MAT11": dict.fromkeys(range(1, 30), "the material, which the model states"),
    "PSHELL": dict.fromkeys((8, 9), "where stresses are printed"),
    "PSOLID": dict.fromkeys((3, 4, 5), "how elements are integrated, and where stresses are printed"),
    "CBAR": dict.fromkeys(range(4, 24), "of a bar that is named itself"),
    "CBEAM": dict.fromkeys(range(4, 24), "of a bar that is named itself"),
    "CONM2": {0: "its number"},
    "RBE2": {0: "its number"},
    "RBE3": {0: "its number"},
}
"""Fields of cards that are read, counted from 0 after the name, that have no effect, with the reason."""

PARAMETERS: Final[Mapping[str, tuple[Makes, str]]] = {
    "COUPMASS": (Makes.SLIGHT, "coupled masses of elements; here they always are"),
    "K6ROT": (Makes.NOTHING, "drilling stiffness, which vibration hardly depends on"),
    "SNORM": (Makes.NOTHING, "normals at nodes of curved shells"),
    "LGDISP": (Makes.NOTHING, "large displacements of another solution"),
    "CK1": (Makes.SECTION, "a factor of matrices that are added"),
    "CK2": (Makes.SECTION, "a factor of matrices that are added"),
    "CK3": (Makes.SECTION, "a factor of matrices that are added"),
    "CM1": (Makes.SECTION, "a factor of matrices that are added"),
    "CM2": (Makes.SECTION, "a factor of matrices that are added"),
}
_CONTROL: Final = (
    "POST USETSEL AUTOSPC AUTOSPCR GRDPNT PRGPST MAXRATIO BAILOUT PRTMAXIM NEWSEQ USETPRT RESVEC RESVINER OGEOM "
    "OUGCORD SRCOMPS NOCOMPS G GFL W3 W4 W3FL W4FL LMODES LMODESFL LFREQ HFREQ DDRMM LSTRN PATVER EPZERO TINY SEQOUT "
    "TOLRSC PRTRESLT INREL DBALL DYNSPCF EXTOUT EXTDRUN EXTUNIT KDAMP ALPHA1 ALPHA2 CURVPLOT PVALINIT ERROR "
    "SIGMA TABS MODACC CHECKOUT RSPECTRA NMSOL COMPARE CONFAC VREF MACH Q AUNITS OPTION PLTMSG RPOSTS1 SESEF "
    "ASING BIGER CDIF IRES NINTPTS NLAYERS NOELOF NOELOP NOGPF OG OPGEOM OPPHIP OPTEXIT DESPCH DESPCH1 DPEPS "
    "NASPRT PEDGEP PRPHIVZ QUADINT RMS SDRPOPT SKPAMP START STIME TSTATIC UNITSYS WRBEAMB XYUNIT PRTPCH MODEL "
    "OEE OES OEF OQG OUG OUNITS POSTEXT DIGITS OMID OIBULK OMACHPR SDRDENS F56 WTMASS"
)
CONTROL: Final = tuple(_CONTROL.split())
"""Parameters of the solution and its output."""

COMMANDS: Final[Mapping[str, tuple[Makes, str]]] = {
    "STATSUB": (Makes.PRELOAD, "the vibration of a body under load, whose forces change its stiffness"),
    "K2GG": (Makes.SECTION, "a matrix that is added to the stiffness"),
    "K2PP": (Makes.SECTION, "a matrix that is added to the stiffness"),
    "M2GG": (Makes.SECTION, "a matrix that is added to the mass"),
    "M2PP": (Makes.SECTION, "a matrix that is added to the mass"),
    "A2GG": (Makes.SECTION, "a matrix of a fluid"),
    "NSM": (Makes.SECTION, "mass of cells"),
    "DSYM": (Makes.LINKS, "a sector that is repeated about an axis"),
}
"""Commands of the case control that change a linear model of vibration."""

READ_COMMANDS: Final = ("SPC", "SET", "NSM")  # NSM by its cards, which are named where they are not read
_OUTPUT: Final = (
    "ACCE AERO AEUX ANAL APP APRE ASSI AUXC AUXM AXES BEGI BOUT CEND CMET CSCA CSSC CURV DATA DEFO DESG DESM DESO "
    "DESS DESV DIAG DISP DIVE DLOA DRSP DSAP EBDR ECHO EDE EFF EKE ELFO ELST ENTH ESE ESEL FIND FLSF FLUX FMET "
    "FORC FREQ GPFO GPKE GPST GUST HDOT IC ID INIT LABE LINE LOAD MAST MAXL MAXM MEFF METH MFLU MINM MODE MODT "
    "MPC MPCF NAST NLIC NLLO NLPA NLST NOUT OFRE OLOA OMOD ORIG OTIM OUTP PAGE PARA PART PFMO PLOT POST PRES RAND "
    "RCRO REPC RESV RGYR RIGI SACC SDAM SDIS SEAL SEDR SEDV SEEX SEFI SEKR SELG SELR SEMG SEMR SERE SETS SKIP "
    "SMET SOL SPCF STAT STRA STRE STRF SUBC SUBS SUBT SUPE SUPO SURF SVEC SVEL SYM SYMC TCUR TEMP TERM TFL THER "
    "TIME TITL TRAC TRIM TSTE VECT VELO VIEW VOLU VUGR WEIG XAXI XGRI XMAX XMIN XTIT XYOU XYPL XYPR XYPU YAXI "
    "YGRI YMAX YMIN YTIT"
)
OUTPUT: Final = tuple(_OUTPUT.split())
"""Commands of the case control by the four letters that tell them, of no effect on a linear model of vibration."""


# ----------------------------------------------------------------------------------------------------------------------
# Cards of the bulk data of Nastran: free, small and large fields, with their continuations, as words.
#
# Fields are those of the Quick Reference Guide, "Format of Bulk Data Entries". meshio 5.3 reads nodes and elements but
# neither sets nor properties, and takes coordinates of any coordinate system as they are.
# ----------------------------------------------------------------------------------------------------------------------

LARGEST: Final = 500_000_000  # bytes
_DEEPEST: Final = 5  # files that include files
_SMALL, _LARGE = 8, 16
_GOES_ON = re.compile(r"(^|,)\s*[+*](?!\d|\.)\w*\s*$")  # a mark of continuation as the last field of a line
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD]?[+-]?\d+)?")
_BARE_EXPONENT = re.compile(r"^([+-]?(?:\d+\.?\d*|\.\d+))([+-]\d+)$")


class DeckLine(NamedTuple):
    """A line of a file, from 1."""

    path: Path
    number: int
    text: str


class Card(NamedTuple):
    """A card. number : of its first line, from 1. fields : after its name, all continuations in one row. seen : those
    that have been read, counted from 0: what is left at the end is named."""

    path: Path
    number: int
    name: str
    fields: list[str]
    seen: set[int]

    def refuse(self, got: str, expected: str, do: str = "") -> InputErrors:
        """A mistake in it."""
        return wrong_line(self.path, self.number, f"{self.name} with {got}", expected, do)

    def field(self, index: int) -> str:
        """A field, counted from 0 after the name; "" beyond its end."""
        self.seen.add(index)
        return self.fields[index] if index < len(self.fields) else ""

    @property
    def unread(self) -> list[int]:
        """Fields with something in them that nobody has read."""
        return [index for index, word in enumerate(self.fields) if word and index not in self.seen]

    def whole(self, index: int, default: int | None = None) -> int:
        """A whole number; `default` where the field is empty, refused without one."""
        word = self.field(index)
        if not word and default is not None:
            return default
        try:
            return int(word)
        except ValueError:
            raise self.refuse(f"{quote_value(word)} in field {index + 2}", "a whole number") from None

    def real(self, index: int, default: float | None = None) -> float:
        """A number, also as 1.5-3; `default` where the field is empty, refused without one."""
        word = self.field(index)
        if not word and default is not None:
            return default
        found = _BARE_EXPONENT.match(word)
        plain = f"{found[1]}e{found[2]}" if found else word.replace("D", "E").replace("d", "e")
        try:
            number = float(plain)
        except ValueError:
            number = nan
        if not isfinite(number):
            raise self.refuse(f"{quote_value(word)} in field {index + 2}", "a number")
        return number

    def several(self, first: int) -> list[int]:
        """Whole numbers from a field on, FIRST THRU LAST written out."""
        self.seen.update(range(first, len(self.fields)))
        words = [word for word in self.fields[first:] if word]
        numbers: list[int] = []
        at = 0
        while at < len(words):
            if at + 2 < len(words) and words[at + 1].upper() == "THRU":
                if not (words[at].isdigit() and words[at + 2].isdigit()):
                    raise self.refuse(f"'{' '.join(words[at : at + 3])}'", "FIRST THRU LAST")
                numbers += range(int(words[at]), int(words[at + 2]) + 1)
                at += 3
            elif words[at].isdigit():
                numbers.append(int(words[at]))
                at += 1
            else:
                raise self.refuse(quote_value(words[at]), "whole numbers, or FIRST THRU LAST")
        return numbers


def cards_of(path: Path, lines: list[str]) -> tuple[list[DeckLine], list[Card], bool]:
    """Lines of the case control, cards of the bulk data up to ENDDATA, and whether there is one.

    Lines of files that it includes stand in their places. Raises InputErrors for a file that ends before its last card
    does, and for a whole one, with BEGIN BULK, that has no ENDDATA: Nastran asks for it, so that such a file is cut.
    Bulk data alone is often written without.
    """
    every = list(_with_included([DeckLine(path, number, line) for number, line in enumerate(lines, 1)], depth=0))
    begin = next((n for n, one in enumerate(every) if re.match(r"\s*BEGIN\s+BULK", one.text, re.IGNORECASE)), -1)
    found: list[Card] = []
    ended, last = False, ""
    for one in every[begin + 1 :]:
        text = one.text.split("$", 1)[0].rstrip()
        if not text.strip():
            continue
        if text.strip().upper().startswith("ENDDATA"):
            ended = True
            break
        last = text
        name, fields = _split(one, text)
        if name == "" or name[0] in "+*":
            if not found:
                raise wrong_line(one.path, one.number, "a continuation of nothing", "a card before it")
            found[-1].fields.extend(fields)
        else:
            found.append(Card(one.path, one.number, name.rstrip("*").upper(), fields, set()))
    goes_on = not ended and _GOES_ON.search(last if "," in last else last.expandtabs(_SMALL)[72:80]) is not None
    if found and not ended and (goes_on or begin >= 0):
        got = f"the end of the file {'within' if goes_on else 'after'} {found[-1].name} of line {found[-1].number}"
        expected = "its continuation" if goes_on else "ENDDATA"
        do = "the file is cut: write it again" if goes_on else "is the file cut? If not, write ENDDATA as its last line"
        raise wrong_line(path, len(lines), got, expected, do)
    return every[: begin + 1], found, ended


def _with_included(lines: list[DeckLine], depth: int) -> Iterator[DeckLine]:
    """All lines, those of INCLUDE 'FILE' replaced by those of the file, which is sought beside the one that names it.

    A name may go on over lines until its quotation mark. Raises InputErrors with the line for a file that is not there,
    and for files that include each other.
    """
    at = 0
    while at < len(lines):
        one = lines[at]
        at += 1
        found = re.match(r"\s*INCLUDE\b\s*(.*)", one.text, re.IGNORECASE)
        if found is None:
            yield one
            continue
        name = found[1].strip()
        while name[:1] in ("'", '"') and name.count(name[0]) < 2 and at < len(lines):
            name += lines[at].text.strip()
            at += 1
        if depth > _DEEPEST:
            raise wrong_line(one.path, one.number, "files that include each other", "an end to it")
        name = name.split("$", 1)[0].strip().strip("'\"").replace("\\", "/")
        try:
            inner = beside(str(one.path), name)
            texts = lines_of(inner, content(inner, LARGEST, "an included file"))
        except InputError as error:
            if getattr(error, "errors", ()):
                raise
            raise wrong_line(one.path, one.number, error.got, error.expected, error.do) from None
        yield from _with_included([DeckLine(inner, number, text) for number, text in enumerate(texts, 1)], depth + 1)


def _split(line: DeckLine, text: str) -> tuple[str, list[str]]:
    """Name of a line, or its mark of continuation, and its fields: eight, or four of a large one.

    Raises InputErrors for more, which would be lost: a field behind the last is the mark of continuation, in words.
    """
    if "," in text:
        name, *fields = (word.strip() for word in text.split(","))
        if fields and re.fullmatch(r"[+*](?!\d|\.).*", fields[-1]):
            fields.pop()  # the mark of the line that goes on
        count = 4 if name.endswith("*") or name.startswith("*") else 8
        behind = [word for word in fields[count:] if word]
        if len(behind) > 1 or any(_NUMBER.fullmatch(word) for word in behind):
            got = f"{len(fields)} fields behind {name or 'a continuation'}"
            do = "write the others in a line of their own that begins with a comma"
            raise wrong_line(line.path, line.number, got, f"{count} in a line", do)
        return name, [*fields[:count], *[""] * (count - len(fields))]
    text = text.expandtabs(_SMALL)
    name = text[:_SMALL].strip()
    width = _LARGE if name.endswith("*") or name.startswith("*") else _SMALL
    row = text[_SMALL:72].ljust(64)
    return name, [row[at : at + width].strip() for at in range(0, 64, width)]


# ----------------------------------------------------------------------------------------------------------------------
# What has been read of a bulk data file of Nastran so far.
# ----------------------------------------------------------------------------------------------------------------------

OF_GRID: Final = 0  # in place of the number of a set of supports: those of GRID, which always hold


class Shelled(NamedTuple):
    """A PSHELL. materials : of membrane, bending, shear and their coupling, 0 where it names none. bending : 12 I/T^3.
    shear : TS/T. nsm : mass per area. card : itself."""

    thickness: float | None
    materials: tuple[int, int, int, int]
    bending: float
    shear: float
    nsm: float
    card: Card


class SpreadMass(NamedTuple):
    """Mass on the cells of properties, or on elements, by their numbers. what : as the card calls it. line : its first
    one. per : "area", or all of it."""

    what: str
    amount: float
    per: Literal["area", "total"]
    line: int
    properties: tuple[int, ...]
    elements: tuple[int, ...] = ()


@dataclass
class Bulk:
    """What has been read so far."""

    numbers: list[int] = field(default_factory=list)
    points: list[tuple[float, float, float]] = field(default_factory=list)
    placed: list[int] = field(default_factory=list)  # systems of the places of nodes
    moving: list[int] = field(default_factory=list)  # systems of their motion
    of_systems: dict[int, Card] = field(default_factory=dict)  # cards of nodes that have such a system
    systems: list[Card] = field(default_factory=list)
    cells: dict[str, list[list[int]]] = field(default_factory=dict)
    by_property: dict[int, list[int]] = field(default_factory=dict)
    bars: dict[str, list[int]] = field(default_factory=dict)  # numbers of bars by their card
    shells: dict[int, Shelled] = field(default_factory=dict)
    solids: dict[int, str] = field(default_factory=dict)  # material
    lay_ups: dict[int, tuple[StatedLayer, ...]] = field(default_factory=dict)  # layers of PCOMP
    corners: list[tuple[Card, int, int, list[float]]] = field(default_factory=list)  # card, element, property, T1..
    materials: list[StatedMaterial] = field(default_factory=list)
    masses: list[StatedMass] = field(default_factory=list)
    links: list[StatedLink] = field(default_factory=list)
    holds: dict[tuple[int, str], list[int]] = field(default_factory=dict)
    sets: dict[str, list[int]] = field(default_factory=dict)
    left_out: Tally = field(default_factory=Tally)
    of_property: list[tuple[int, str, Makes, str, int]] = field(default_factory=list)  # left out, of cells to come
    spread: list[SpreadMass] = field(default_factory=list)
    added: dict[int, list[int]] = field(default_factory=dict)  # sets of supports that SPCADD makes one
    chosen: list[int] = field(default_factory=list)  # sets of supports by SPC = N of the case control
    open_end: str = ""  # the word that would end the file, and its last card, where it has none
    mass_factor: float = 1.0
    ranged: set[int] = field(default_factory=set)  # nodes of cards with FIRST THRU LAST, some of which may be missing
    of_grids: Card | None = None  # GRDSET: what GRID leaves out

    def leave_out_of(self, number: int, what: str, makes: Makes, changes: str, line: int) -> None:
        """Count what is not made of all cells of a property, which may stand further down."""
        self.of_property.append((number, what, makes, changes, line))
