"""Cards of Nastran that no reader makes, in two classes: of no effect on a linear model of vibration, and left out.

Names are those of the Quick Reference Guide of MSC Nastran. A card that stands in neither, and that no reader reads, is
unknown: it is named, and what comes of the file is not to be trusted.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from femstruct.model.imported.stated.left_out import Makes

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
