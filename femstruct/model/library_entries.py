"""Entries of the library, family after family, each value with the work that prints it; materials like them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from difflib import get_close_matches
from functools import cache
from types import MappingProxyType
from typing import Any, Final

from femstruct.errors import FemstructError, InputError
from femstruct.model.library import (
    HOPKINS,
    HOPKINS_LAYERS,
    VIGRAN,
    VIGRAN_MODULI,
    Fact,
    LibraryEntry,
    Source,
    Use,
    of_hopkins,
    of_vigran,
)
from femstruct.model.materials import CLASSES, NU, ROLLING, AnyMaterial, Loss, Material, Orthotropic, timber

# ----------------------------------------------------------------------------------------------------------------------
# Hangers of ceilings, and studs and channels as line springs.
# ----------------------------------------------------------------------------------------------------------------------

_ARH: Final = Source(
    "Acoustic Isolation Hangers ARH-1, silentsource.com", "static deflection at the largest steady load"
)
_VIGRAN: Final = Source(
    "T. E. Vigran, Building Acoustics, Taylor & Francis 2008, section 8.2, figure 8.16",
    "read at what-when-how.com, Building-Acoustics-316",
)
POUND: Final = 4.4482216  # N
INCH: Final = 0.0254  # m


def _hanger(model: str, pounds: float, inches: float) -> LibraryEntry:
    load = pounds * POUND
    return LibraryEntry(
        f"hanger {model}",
        "hangers",
        Use.HANGERS,
        f"hanger with a gum rubber element, {model}",
        (
            Fact("stiffness", load / (inches * INCH), _ARH, note="static: dynamic stiffness of rubber is larger"),
            Fact("load", load, _ARH, note="the largest that is recommended"),
        ),
    )


CEILING_HANGERS: Final = (
    _hanger("ARH-1-20", 65.0, 5.0 / 16.0),
    _hanger("ARH-1-40", 120.0, 1.0 / 4.0),
    _hanger("ARH-1-70", 200.0, 3.0 / 16.0),
    LibraryEntry(
        "stud steel",
        "hangers",
        Use.HANGERS,
        "common steel stud between two boards of 13 mm, as a line spring",
        (
            Fact(
                "stiffness_per_length",
                2e5,
                _VIGRAN,
                note="1 / (5e-6 m^2/N), the compliance for which Davy's formula agrees with a measured wall",
            ),
        ),
    ),
)


# ----------------------------------------------------------------------------------------------------------------------
# Lay-ups of cross-laminated timber.
# ----------------------------------------------------------------------------------------------------------------------

_PAGE: Final = Source("standard designs of CLT panels, husfabrik.eu/clt-panels-standard-design")
_LAID: Final = {  # thicknesses of the layers [mm], the first along the panel; two equal ones are glued parallel
    "CLT60 L3": (20, 20, 20),
    "CLT80 L3": (30, 20, 30),
    "CLT90 L3": (30, 30, 30),
    "CLT100 L3": (30, 40, 30),
    "CLT120 L3": (40, 40, 40),
    "CLT100 L5": (20, 20, 20, 20, 20),
    "CLT120 L5": (30, 20, 20, 20, 30),
    "CLT140 L5": (40, 20, 20, 20, 40),
    "CLT160 L5": (40, 20, 40, 20, 40),
    "CLT180 L5": (40, 30, 40, 30, 40),
    "CLT200 L5": (40, 40, 40, 40, 40),
    "CLT180 L7": (30, 20, 30, 20, 30, 20, 30),
    "CLT200 L7": (20, 40, 20, 40, 20, 40, 20),
    "CLT240 L7": (30, 40, 30, 40, 30, 40, 30),
}


def _panel(name: str, layers: tuple[int, ...]) -> LibraryEntry:
    laid = tuple((one / 1e3, 90 * (number % 2)) for number, one in enumerate(layers))
    what = f"{len(layers)} layers of {'-'.join(map(str, layers))} mm, the outer ones along x"
    return LibraryEntry(name, "CLT lay-ups", Use.LAY_UP, what, (Fact("thickness", sum(layers) / 1e3, _PAGE),), laid)


CLT: Final = tuple(_panel(name, layers) for name, layers in _LAID.items())


# ----------------------------------------------------------------------------------------------------------------------
# Concrete by strength class.
# ----------------------------------------------------------------------------------------------------------------------

_CONCRETE_TABLE: Final = Source("EN 1992-1-1:2004, table 3.1", "read at buildinghow.com, volume C, concrete and steel")
_CONCRETE_RATIO: Final = Source(
    "EN 1992-1-1:2004, 3.1.3(4), uncracked", "read in the public data sets of BHoM, concrete"
)
_WEIGHT: Final = Source("T. E. Vigran, Building Acoustics, Taylor & Francis 2008, table 3.1, p. 88", VIGRAN.read)
_CONCRETE_MODULI: Final = {  # E_cm [GPa]
    "C12/15": 27.0, "C16/20": 29.0, "C20/25": 30.0, "C25/30": 31.0, "C30/37": 33.0, "C35/45": 34.0, "C40/50": 35.0,
    "C45/55": 36.0, "C50/60": 37.0, "C55/67": 38.0, "C60/75": 39.0, "C70/85": 41.0, "C80/95": 42.0, "C90/105": 44.0,
}  # fmt: skip


def _concrete(strength_class: str, modulus: float) -> LibraryEntry:
    secant = "mean secant modulus E_cm; the dynamic modulus is larger"
    return LibraryEntry(
        f"concrete {strength_class}",
        "concrete",
        Use.MATERIAL,
        f"concrete of strength class {strength_class}",
        (
            Fact("E", 1e9 * modulus, _CONCRETE_TABLE, note=secant),
            Fact("nu", 0.2, _CONCRETE_RATIO),
            Fact("rho", 2300.0, _WEIGHT, note="plain concrete: reinforcement adds to it"),
            Fact("loss_factor", 0.005, HOPKINS, (0.004, 0.008), "internal, an estimate; range of Vigran, table 3.1"),
        ),
    )


CONCRETE: Final = (
    *(_concrete(name, modulus) for name, modulus in _CONCRETE_MODULI.items()),
    LibraryEntry(
        "concrete cast in situ",
        "concrete",
        Use.MATERIAL,
        "concrete cast in situ, by its dynamic modulus",
        of_hopkins(3800.0, 0.2, 2200.0, 0.005),
    ),
)


# ----------------------------------------------------------------------------------------------------------------------
# Elastomers for strips and pads; their stiffness depends on load, form and frequency: the maker's sheet decides.
# ----------------------------------------------------------------------------------------------------------------------


def _sheet(name: str) -> Source:
    return Source(f"Getzner Werkstoffe, material data sheet {name}", "read in a public copy at scribd.com or yumpu.com")


def _elastomer(name: str, shear_modulus: float, loss_factor: float, pressure: float) -> LibraryEntry:
    sheet = _sheet(name)
    reference = "DIN 53513, depends on frequency, load and amplitude (reference value)"
    return LibraryEntry(
        f"elastomer {name}",
        "elastomers",
        Use.NUMBERS,
        f"cellular polyurethane {name}",
        (
            Fact("G", shear_modulus, sheet, note="dynamic, DIN ISO 1827, at the static load limit"),
            Fact("loss_factor", loss_factor, sheet, note=reference),
            Fact("pressure", pressure, sheet, note="static load limit, depends on the form"),
        ),
    )


ELASTOMERS: Final = (
    _elastomer("Sylodyn NF", 1.18e6, 0.10, 1.5e6),
    _elastomer("Sylodyn ND", 0.47e6, 0.08, 0.35e6),
    _elastomer("Sylomer W", 0.10e6, 0.20, 0.005e6),
)


# ----------------------------------------------------------------------------------------------------------------------
# Gypsum boards and plaster.
# ----------------------------------------------------------------------------------------------------------------------

GYPSUM: Final = (
    LibraryEntry(
        "gypsum board natural",
        "gypsum",
        Use.MATERIAL,
        "plasterboard of natural gypsum",
        of_hopkins(1490.0, 0.3, 860.0, 0.0141, estimated=False),
    ),
    LibraryEntry(
        "gypsum board flue gas",
        "gypsum",
        Use.MATERIAL,
        "plasterboard of flue gas gypsum and natural gypsum",
        of_hopkins(1810.0, 0.3, 680.0, 0.0125, estimated=False),
    ),
    LibraryEntry(
        "gypsum board glass fibre",
        "gypsum",
        Use.MATERIAL,
        "plasterboard with glass fibre and other additives, as fire boards have",
        of_hopkins(2010.0, 0.3, 800.0, None),
    ),
    LibraryEntry(
        "gypsum board stiff",
        "gypsum",
        Use.MATERIAL,
        "plasterboard by the largest modulus that a textbook prints",
        of_vigran(4.1e9, 0.3, (800.0, 900.0), (0.01, 0.015)),
    ),
    LibraryEntry(
        "gypsum plaster",
        "gypsum",
        Use.MATERIAL,
        "plaster, gypsum based",
        of_hopkins(1610.0, 0.2, 650.0, 0.012),
    ),
)


# ----------------------------------------------------------------------------------------------------------------------
# Masonry of solid blocks, for walls.
# ----------------------------------------------------------------------------------------------------------------------


def _wall(name: str, what: str, speed: float, rho: float, loss_factor: float, estimated: bool = True) -> LibraryEntry:
    return LibraryEntry(name, "masonry", Use.MATERIAL, what, of_hopkins(speed, 0.2, rho, loss_factor, estimated))


MASONRY: Final = (
    _wall("masonry calcium silicate", "calcium-silicate blocks in thin joints", 2500.0, 1800.0, 0.01, False),
    _wall("masonry dense aggregate", "dense aggregate blocks in mortar", 3200.0, 2000.0, 0.01),
    _wall("masonry light aggregate", "lightweight aggregate blocks in mortar", 2200.0, 1400.0, 0.01),
    _wall("masonry expanded clay", "expanded clay blocks in mortar", 2300.0, 800.0, 0.007),
    _wall("masonry clinker 1030", "clinker concrete blocks of 1030 kg/m^3 (Rindel 1994)", 1850.0, 1030.0, 0.01),
    _wall("masonry clinker 1720", "clinker concrete blocks of 1720 kg/m^3 (Rindel 1994)", 2200.0, 1720.0, 0.01),
)


# ----------------------------------------------------------------------------------------------------------------------
# Metals and glass.
# ----------------------------------------------------------------------------------------------------------------------

_CREMER: Final = Source(
    "L. Cremer, M. Heckl, B. A. T. Petersson, Structure-Borne Sound, 3rd ed., Springer 2005, table 4.3, p. 191",
    HOPKINS.read,
)


def _metal(name: str, E: float, nu: float, rho: float, losses: tuple[float, float]) -> LibraryEntry:
    note = "of the material in bending: structures have far more"
    facts = (
        Fact("E", E, _CREMER),
        Fact("nu", nu, _CREMER),
        Fact("rho", rho, _CREMER),
        Fact("loss_factor", None, _CREMER, losses, note),
    )
    return LibraryEntry(name, "metals and glass", Use.MATERIAL, name, facts)


METALS: Final = (
    _metal("steel", 210e9, 0.31, 7800.0, (2e-5, 3e-4)),
    _metal("aluminium", 72e9, 0.34, 2700.0, (3e-6, 1e-4)),
    LibraryEntry(
        "glass",
        "metals and glass",
        Use.MATERIAL,
        "glass",
        (
            *(one for one in of_hopkins(5200.0, 0.24, 2500.0, None) if one.key != "nu"),
            Fact("nu", 0.24, HOPKINS),
            Fact("loss_factor", None, HOPKINS, (0.003, 0.006), "internal"),
        ),
    ),
)


# ----------------------------------------------------------------------------------------------------------------------
# Resilient layers under floating floors, by their dynamic stiffness per area.
# ----------------------------------------------------------------------------------------------------------------------

_MEASURED: Final = (  # material, density [kg/m^3], thickness [mm], s' [MN/m^3]
    ("rock wool", 60, 30, 10), ("rock wool", 80, 30, 11), ("rock wool", 100, 30, 14), ("rock wool", 140, 30, 19),
    ("glass wool", 36, 13, 28), ("glass wool", 36, 25, 11), ("glass wool", 75, 25, 12), ("glass wool", 75, 40, 7),
    ("rebond foam", 64, 15, 12), ("rebond foam", 64, 20, 9), ("rebond foam", 64, 25, 7), ("rebond foam", 96, 15, 16),
    ("polystyrene", 14, 50, 78), ("polystyrene pre-compressed", 10, 50, 68), ("polyethylene foam", 45, 5, 115),
)  # fmt: skip
_DYNAMIC_MODULI: Final = (  # material, density [kg/m^3], its range, dynamic modulus [Pa]
    ("glass wool 125 kg/m^3", 125.0, None, (0.11e6, 0.13e6)),
    ("rock wool 110 to 135 kg/m^3", None, (110.0, 135.0), (0.25e6, 0.30e6)),
    ("rock wool 150 to 175 kg/m^3", None, (150.0, 175.0), (0.27e6, 0.33e6)),
    ("cork", None, (120.0, 250.0), (10e6, 30e6)),
)


def _layer(material: str, rho: int, thickness: int, stiffness: int) -> LibraryEntry:
    return LibraryEntry(
        f"layer {material} {rho} kg/m^3 {thickness} mm",
        "resilient layers",
        Use.LAYER,
        f"{material} of {thickness} mm, a measured specimen (ISO 9052-1)",
        (
            Fact("stiffness_per_area", 1e6 * stiffness, HOPKINS_LAYERS, note="s', dynamic"),
            Fact("rho", float(rho), HOPKINS_LAYERS),
            Fact("thickness", thickness / 1e3, HOPKINS_LAYERS, note="uncompressed"),
        ),
    )


def _modulus(
    name: str, rho: float | None, between: tuple[float, float] | None, moduli: tuple[float, float]
) -> LibraryEntry:
    note = "dynamic, under about 2 kPa; s' is this over the thickness"
    return LibraryEntry(
        f"layer of {name}",
        "resilient layers",
        Use.NUMBERS,
        "the modulus of a resilient layer of any thickness",
        (Fact("E", None, VIGRAN_MODULI, moduli, note), Fact("rho", rho, VIGRAN_MODULI, between)),
    )


RESILIENT_LAYERS: Final = (*(_layer(*one) for one in _MEASURED), *(_modulus(*one) for one in _DYNAMIC_MODULI))


# ----------------------------------------------------------------------------------------------------------------------
# Screeds.
# ----------------------------------------------------------------------------------------------------------------------

SCREEDS: Final = (
    LibraryEntry(
        "screed sand-cement",
        "screeds",
        Use.MATERIAL,
        "screed of sand and cement",
        of_hopkins(3250.0, 0.2, 2000.0, 0.01, estimated=False),
    ),
    LibraryEntry(
        "mortar",
        "screeds",
        Use.MATERIAL,
        "mortar (Maysenholder and Horvatic 1998)",
        of_hopkins(2450.0, 0.2, 1600.0, 0.013, estimated=False),
    ),
)


# ----------------------------------------------------------------------------------------------------------------------
# Structural timber by strength class; `femstruct.model.materials` makes the materials.
# ----------------------------------------------------------------------------------------------------------------------

_TIMBER_TABLE: Final = Source("EN 338, means", "read at kvh.eu, strength, rigidity and density characteristics")
_ROLLING: Final = Source(
    "the usual assumption for rolling shear", "measured: 65 to 101 MPa, doi:10.1186/s10086-021-01954-y"
)
_TIMBER_RATIO: Final = Source("an assumption: the standard has none, and plates hardly depend on it")


def _timber(name: str) -> LibraryEntry:
    wood = timber(name, name)
    along, across, _ = wood.E
    return LibraryEntry(
        name,
        "timber",
        Use.MATERIAL,
        f"softwood of strength class {name}, x along the grain",
        (
            Fact("E", (along, across), _TIMBER_TABLE, note="along and across the grain"),
            Fact("G", (wood.G[0], ROLLING * wood.G[0]), _ROLLING, note="Gxy of EN 338; Gyz a tenth of it"),
            Fact("nu", NU, _TIMBER_RATIO),
            Fact("rho", wood.rho, _TIMBER_TABLE, note="mean"),
            Fact("loss_factor", None, VIGRAN, (0.008, 0.01), "fir, spruce, internal; 0 where a model says nothing"),
        ),
    )


TIMBER_CLASSES: Final = tuple(_timber(name) for name in CLASSES)


# ----------------------------------------------------------------------------------------------------------------------
# Boards of wood: chipboard, OSB, plywood, fibreboard.
# ----------------------------------------------------------------------------------------------------------------------

_OSB: Final = Source(
    "EN 12369-1:2001, OSB/2 and OSB/3 of 6 to 25 mm", "read in the technical brochure of Sonae Arauco for the UK, p. 63"
)

WOOD_BOARDS: Final = (
    LibraryEntry("chipboard", "wood boards", Use.MATERIAL, "chipboard", of_hopkins(2200.0, 0.3, 760.0, 0.01)),
    LibraryEntry(
        "chipboard stiff",
        "wood boards",
        Use.MATERIAL,
        "chipboard by the modulus of another textbook",
        of_vigran(3.8e9, 0.2, (650.0, 800.0), (0.01, 0.03)),
    ),
    LibraryEntry(
        "OSB",
        "wood boards",
        Use.MATERIAL,
        "oriented strand board, taken as alike in all directions",
        of_hopkins(2570.0, 0.3, 590.0, 0.01, speeds=(2200.0, 3500.0)),
    ),
    LibraryEntry(
        "OSB/3",
        "wood boards",
        Use.MATERIAL,
        "oriented strand board of a standard, x along its major axis",
        (
            Fact("E", (4930e6, 1980e6), _OSB, note="mean, bending, along and across the major axis"),
            Fact("G", (1080e6, 50e6, 50e6), _OSB, note="mean, panel shear, and planar shear twice"),
            Fact("nu", 0.3, HOPKINS, note="an estimate of the author"),
            Fact("rho", 590.0, HOPKINS),
            Fact("loss_factor", 0.01, HOPKINS, note="internal, an estimate of the author"),
        ),
    ),
    LibraryEntry(
        "plywood birch",
        "wood boards",
        Use.MATERIAL,
        "plywood of birch, taken as alike in all directions",
        of_hopkins(3850.0, 0.3, 710.0, 0.016, estimated=False),
    ),
    LibraryEntry("MDF", "wood boards", Use.MATERIAL, "medium density fibreboard", of_hopkins(2560.0, 0.3, 760.0, 0.01)),
)


# ----------------------------------------------------------------------------------------------------------------------
# Wool and felt for cavities.
# ----------------------------------------------------------------------------------------------------------------------

_ISOVER: Final = Source(
    "Isover Sweden, Piano Ljudskiva; calculated by the maker's engineer, declared (EN 13162) with at least 6 kPa s/m^2",
    "read in a public forum, gearslutz.com, thread 693015",
)
_ALLARD: Final = Source(
    "J. F. Allard, N. Atalla, Propagation of Sound in Porous Media, 2nd ed., Wiley 2009, table 6.1, p. 124",
    HOPKINS.read,
)
_COX: Final = Source(
    "T. J. Cox, P. D'Antonio, Acoustic Absorbers and Diffusers, 3rd ed., CRC Press 2017, table 6.2, p. 193",
    HOPKINS.read,
)

WOOL: Final = (
    LibraryEntry(
        "glass wool 14 kg/m^3",
        "wool",
        Use.FILL,
        "glass wool for partitions, such as Isover Piano",
        (
            Fact("rho", 14.0, _ISOVER, (13.0, 15.0), "middle of the range"),
            Fact("flow_resistivity", 7e3, _ISOVER, (6e3, 7e3)),
        ),
    ),
    LibraryEntry(
        "glass wool 130 kg/m^3",
        "wool",
        Use.FILL,
        "heavy glass wool, Domisol Coffrage",
        (Fact("rho", 130.0, _ALLARD), Fact("flow_resistivity", 40e3, _ALLARD)),
    ),
    LibraryEntry(
        "mineral wool",
        "wool",
        Use.NUMBERS,
        "mineral wool of any kind: the range that studies report",
        (Fact("flow_resistivity", None, _COX, (1e3, 150e3)),),
    ),
    LibraryEntry(
        "wood fibres",
        "wool",
        Use.NUMBERS,
        "wood fibres: the range that studies report (Wassilieff 1996)",
        (Fact("flow_resistivity", None, _COX, (11e3, 180e3)),),
    ),
    LibraryEntry(
        "hemp fibres",
        "wool",
        Use.NUMBERS,
        "hemp fibres (Bonfiglio and Pompoli 2013)",
        (Fact("flow_resistivity", 6.2e3, _COX),),
    ),
)


# ----------------------------------------------------------------------------------------------------------------------
# All entries of the library, family after family.
# ----------------------------------------------------------------------------------------------------------------------


@cache
def library() -> MappingProxyType[str, LibraryEntry]:
    """The entries by name, family after family.

    Raises FemstructError for two of one name.

    >>> library()["concrete C30/37"].number("E")
    33000000000.0
    """
    found: dict[str, LibraryEntry] = {}
    for entry in _all():
        if entry.name in found:
            raise FemstructError(f"library {entry.name}", got="two entries", expected="one")
        found[entry.name] = entry
    return MappingProxyType(found)


def _all() -> Iterator[LibraryEntry]:
    for family in (CEILING_HANGERS, CLT, CONCRETE, ELASTOMERS, GYPSUM, MASONRY, METALS, RESILIENT_LAYERS, SCREEDS,
                   TIMBER_CLASSES, WOOD_BOARDS, WOOL):  # fmt: skip
        yield from family


def names_for(*uses: Use) -> tuple[str, ...]:
    """Names of the entries that a model can take so.

    >>> names_for(Use.HANGERS)[0]
    'hanger ARH-1-20'
    """
    return tuple(entry.name for entry in library().values() if entry.use in uses)


def matching_entries(words: Iterable[str]) -> tuple[LibraryEntry, ...]:
    """Entries whose name, family or description has all of these words, in any case.

    >>> [one.name for one in matching_entries(["osb/3"])]
    ['OSB/3']
    """
    lowered = [word.lower() for word in words]
    return tuple(
        entry
        for entry in library().values()
        if all(word in f"{entry.name} {entry.family} {entry.what}".lower() for word in lowered)
    )


def look_up(words: Iterable[str]) -> tuple[LibraryEntry, ...]:
    """`matching_entries`. Raises InputError where there is none, with the name that is nearest."""
    searched = list(words)
    found = matching_entries(searched)
    if not found:
        text = " ".join(searched)
        near = get_close_matches(text.lower(), [name.lower() for name in library()], n=1)
        name = next((one for one in library() if near and one.lower() == near[0]), "")
        do = f"did you mean '{name}'?" if name else "without a word, all entries are listed"
        raise InputError("WORD", got=f"'{text}'", expected="part of the name of an entry of the library", do=do)
    return found


# ----------------------------------------------------------------------------------------------------------------------
# Materials like an entry of the library, with what is known better in place of its values.
# ----------------------------------------------------------------------------------------------------------------------

_SYMBOLS = {"loss_factor": "loss factor"}


def material_like(
    name: str,
    like: str,
    E: float | tuple[float, ...] | None = None,
    nu: float | tuple[float, ...] | None = None,
    rho: float | None = None,
    G: tuple[float, ...] | None = None,
    loss_factor: Loss | None = None,
) -> AnyMaterial:
    """A material of the library under a name of its own; `completed` says what was taken, and from which work.

    Parameters
    ----------
    E, nu, rho, G, loss_factor
        In place of those of the entry. A loss factor that neither gives is 0.

    Raises
    ------
    InputError
        For an entry that is no material, for several moduli where the entry has one, and for one where it has several.

    Examples
    --------
    >>> slab = material_like("slab concrete", "concrete C30/37", rho=2500.0)
    >>> slab.E, slab.rho, slab.completed[0]
    (33000000000.0, 2500.0, 'E of concrete C30/37: EN 1992-1-1:2004, table 3.1')
    """
    where = f"materials.{name}"
    entry = library().get(like)
    if entry is None or entry.use is not Use.MATERIAL:
        raise InputError(f"{where}.like", got=f"'{like}'", expected="a material of the library")
    given = {"E": E, "nu": nu, "rho": rho, "G": G, "loss_factor": loss_factor}
    stated = {key: value for key, value in given.items() if value is not None}
    several = isinstance(entry.value("E"), tuple)
    if (E is not None and isinstance(E, tuple) != several) or (G is not None and not several):
        got = "G of an isotropic material" if E is None else "several moduli" if isinstance(E, tuple) else "one modulus"
        expected = f"{'[Ex, Ey] or [Ex, Ey, Ez]' if several else 'E, nu'} as {like} has"
        raise InputError(f"{where}.{'G' if E is None else 'E'}", got=got, expected=expected)
    if not several and isinstance(nu, tuple):
        raise InputError(f"{where}.nu", got="several ratios", expected=f"one, as {like} has")
    if like in CLASSES and E is None and nu is None:
        return timber(name, like, G, rho, 0.0 if loss_factor is None else loss_factor)
    taken = {one.key: one for one in entry.facts if one.value is not None and one.key not in stated}
    values: dict[str, Any] = {key: one.value for key, one in taken.items() if key in given} | stated
    sources = tuple(f"{_SYMBOLS.get(key, key)} of {like}: {taken[key].source.work}" for key in given if key in taken)
    if not several:
        return Material(name, **values, completed=sources)
    made = Orthotropic(name, **values)
    return replace(made, completed=(*sources, *made.completed))
