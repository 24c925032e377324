"""Materials as they are written."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from inspect import getdoc, signature
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, ValidationInfo, create_model

from acoustics.air import Air
from femstruct.errors import InputError, quote_value
from femstruct.model import sections
from femstruct.model.library import Use
from femstruct.model.library_entries import library, material_like, names_for
from femstruct.model.materials import (
    CLASSES,
    INTERNAL,
    MOST_LOSSES,
    AnyMaterial,
    LossByFrequency,
    Material,
    Orthotropic,
    laboratory_losses,
    measured_losses,
)
from femstruct.model.structure import AirBetween, Bays, Fill
from femstruct.quantities import LENGTH, AnyRatio, Factor, Frequency, Gap, Length, Modulus, Quantity, SideLength, refuse
from femstruct.yaml.reader import Here, near_name
from femstruct.yaml.spec import (
    BandFile,
    MaterialLossFactor,
    Spec,
    SurfaceName,
    Text,
    brought_by_key,
    by_band,
    only,
    read_by,
    several,
    so_many,
    word_of,
)

# ----------------------------------------------------------------------------------------------------------------------
# The air of a room or a cavity, or another fluid, as it is written.
# ----------------------------------------------------------------------------------------------------------------------

DENSEST_GAS, SLOWEST_LIQUID = 1000.0, 500.0  # kg/m^3: carbon dioxide at 700 bar; m/s: fluorinated liquids have 550
_IN_AIR: Final = "air has 343 m/s and 1.21 kg/m^3"
_SOUND: Final = Quantity(("speed",), above=0.0, least=50.0, most=2000.0, too_small=_IN_AIR, too_large=_IN_AIR)
"""From the heaviest gases (sulphur hexafluoride 134 m/s) to hydrogen, 1300 m/s, and water, 1480 m/s."""
_FLUID: Final = Quantity(("density",), above=0.0, least=0.01, most=2000.0, too_small=_IN_AIR, too_large=_IN_AIR)
"""From air at a hundredth of an atmosphere to the heaviest liquids but metals."""


class AirSpec(Spec):
    """Speed of sound and density."""

    makes = Air
    c: Annotated[float, _SOUND] = 343.0
    rho: Annotated[float, _FLUID] = 1.21

    def check(self, here: Here) -> None:
        """A fluid is a gas or a liquid."""
        here.at("rho").need(
            self.rho <= DENSEST_GAS or self.c >= SLOWEST_LIQUID,
            f"{self.rho:g} kg/m^3 beside a speed of sound of {self.c:g} m/s",
            f"a gas below {DENSEST_GAS:g} kg/m^3, or a liquid above {SLOWEST_LIQUID:g} m/s",
            "air has 1.21 kg/m^3 and 343 m/s",
        )


# ----------------------------------------------------------------------------------------------------------------------
# Entries of the library as they are named in a model.
# ----------------------------------------------------------------------------------------------------------------------


def entry_for(use: Use, words: str, word: str = "") -> BeforeValidator:
    """Annotation of a text that names an entry; others are refused with the nearest.

    Parameters
    ----------
    words : str
        What it is.
    word : str
        With which `femstruct materials` lists such.
    """
    known, do = names_for(use), f"femstruct materials {word} lists them".replace("  ", " ")
    return read_by(only(known, words, do), Literal.__getitem__(known))


def entry_source(name: str | None) -> str:
    """An entry with the work behind its first value, for tables of inputs; "" of none.

    >>> entry_source("CLT160 L5")
    'CLT160 L5: standard designs of CLT panels, husfabrik.eu/clt-panels-standard-design'
    """
    return f"{name}: {library()[name].facts[0].source.work}" if name else ""


def need_losses(here: Here, name: str | None, given: bool) -> None:
    """Note that an entry has no loss factor and none is given, where damping takes it."""
    found = library()[name].fact("loss_factor") if name else None
    if given or not name or (found is not None and found.value is not None):
        return
    low, high = found.between if found is not None and found.between is not None else (0.0, 0.0)
    here.wrong(
        f"no loss_factor, and {name} has none in the library",
        "'loss_factor', which damping from materials takes",
        "add 'loss_factor: ...'" + (f": printed are {100 * low:g} % to {100 * high:g} %" if high else ""),
        of_key=True,
    )


# ----------------------------------------------------------------------------------------------------------------------
# Materials as they are written.
# ----------------------------------------------------------------------------------------------------------------------

_MODULUS, _RATIO = Quantity(("pressure",), above=0.0), Quantity(("ratio",))
Density = Annotated[float, Quantity(("density",), least=0.0)]
_LOSS = by_band(
    Quantity(("ratio",), least=0.0, most=MOST_LOSSES, too_large="2 % is 0.02: did you mean {number:g} %?"),
    "one loss factor, or one for each frequency",
    "write it like {63 Hz: 6 %, 125 Hz: 5 %}",
)
_ROLLING = "Gyz is the rolling shear of timber, Ey / 2(1 + nuyz) of fibre composites"


_MODULI_MEANT = "write one for all directions, [Ex, Ey] or [Ex, Ey, Ez]"
_RATIOS_MEANT = "nuij is the contraction along j under stress along i"
_moduli = so_many(_MODULUS.read, (2, 3), "one, two or three", _MODULI_MEANT, many="moduli", or_one=True)
_shear_moduli = so_many(_MODULUS.read, (2, 3), "[Gxy, Gyz] or [Gxy, Gyz, Gzx]", _ROLLING, many="moduli")
_ratios = so_many(_RATIO.read, (3,), "nuxy, or [nuxy, nuyz, nuzx]", _RATIOS_MEANT, many="ratios", or_one=True)


def _losses(value: object, info: ValidationInfo) -> object:
    """A loss factor, or one for each frequency."""
    read = _LOSS(value, info)
    return LossByFrequency(tuple(sorted(read.items()))) if isinstance(read, dict) else read


Losses = Annotated[
    float | LossByFrequency, read_by(_losses, MaterialLossFactor | BandFile | dict[str, MaterialLossFactor])
]


LABORATORY: Final = "ISO 12354-1 laboratory"
_TIMES = by_band(
    Quantity(("time",), above=0.0), "a reverberation time for each frequency", "write it like {63 Hz: 0.4 s}"
)


class LaboratorySpec(Spec):
    """The loss factor of a plate in a laboratory after ISO 12354-1, with the internal one of its material."""

    like: Annotated[Literal["ISO 12354-1 laboratory"], word_of((LABORATORY,))]
    internal: MaterialLossFactor = INTERNAL


class DecaySpec(Spec):
    """Loss factors by the structural reverberation times of a plate by frequency, 2.2 / (f T)."""

    reverberation_times: dict[str, Annotated[float, Quantity(("time",), above=0.0)]] | BandFile


def _plate_losses(value: object, info: ValidationInfo) -> object:
    """A loss factor, one for each frequency, that of a laboratory, or reverberation times."""
    if isinstance(value, str) and value.strip() == LABORATORY:
        return laboratory_losses()
    if isinstance(value, dict) and "like" in value:
        read = LaboratorySpec.model_validate(value)
        return laboratory_losses(read.internal)
    if isinstance(value, dict) and "reverberation_times" in value:
        if len(value) > 1:
            raise refuse("other keys beside reverberation_times", "reverberation_times alone", "remove them")
        times = _TIMES(value["reverberation_times"], info)
        if not isinstance(times, dict):
            raise refuse(quote_value(value), "a reverberation time for each frequency", "write it like {63 Hz: 0.4 s}")
        try:
            return measured_losses(times)
        except InputError as error:
            do = "reverberation times of structures are 0.05 to 2 s"
            raise refuse(f"times that make it {error.got}", error.expected, do) from None
    return _losses(value, info)


PlateLosses = Annotated[
    float | LossByFrequency,
    read_by(
        _plate_losses,
        MaterialLossFactor
        | Literal["ISO 12354-1 laboratory"]
        | LaboratorySpec
        | DecaySpec
        | BandFile
        | dict[str, MaterialLossFactor],
    ),
]
"""Of what plates are made of; a number or a table where it is something else."""


class MaterialSpec(Spec):
    """A linear elastic material: isotropic by E and nu; orthotropic by E: [Ex, Ey, Ez], G: [Gxy, Gyz, Gzx] and nu:
    [nuxy, nuyz, nuzx] along its own axes, of which Ez, Gzx, and all ratios but nuxy can be left out."""

    makes = Material
    only_written = ("G",)
    E: Annotated[float | tuple[float, ...], read_by(_moduli, Modulus | list[Modulus])]
    nu: Annotated[float | tuple[float, ...], read_by(_ratios, AnyRatio | list[AnyRatio])]
    rho: Density
    G: Annotated[tuple[float, ...] | None, read_by(_shear_moduli, list[Modulus])] = None
    loss_factor: PlateLosses = 0.0

    @classmethod
    def refuse_keys(cls, given: Mapping[str, Any]) -> None:
        listed = isinstance(given.get("E"), list)
        if listed and given.get("G") is None:
            raise refuse("a list E without G", "'G: [Gxy, Gyz, Gzx]' beside it", _ROLLING)
        for key in ("G", "nu") if "E" in given and not listed else ():
            if given.get(key) is not None and (key == "G" or isinstance(given[key], list)):
                raise refuse(
                    f"{key} of an orthotropic material beside one E",
                    "E: [Ex, Ey, Ez] with G: [Gxy, Gyz, Gzx], or E and nu alone",
                    "G of an isotropic material is E / 2(1 + nu)" if key == "G" else "write one nu",
                )

    def noun(self, **others: Any) -> AnyMaterial:
        """The isotropic or the orthotropic material."""
        values = {**self.given(), **others}
        return Material(**values) if self.G is None else Orthotropic(G=self.G, **values)


class LikeSpec(Spec):
    """A material of the library, as concrete C30/37 or C24 (timber, x along the grain); values that are known better
    in place of its own."""

    makes = material_like
    like: Annotated[Text, entry_for(Use.MATERIAL, "a material of the library")]
    E: Annotated[float | tuple[float, ...] | None, read_by(_moduli, Modulus | list[Modulus])] = None
    nu: Annotated[float | tuple[float, ...] | None, read_by(_ratios, AnyRatio | list[AnyRatio])] = None
    rho: Density | None = None
    G: Annotated[tuple[float, ...] | None, read_by(_shear_moduli, list[Modulus])] = None
    loss_factor: PlateLosses | None = None

    @classmethod
    def meant_by(cls, value: object) -> str:
        near = near_name(value, names_for(Use.MATERIAL)) if isinstance(value, str) else ""
        return f"{{like: {near}}}" if near else "{E: 210 GPa, nu: 0.3, rho: 7850} or {like: C24}"

    def check_losses(self, here: Here) -> None:
        """Note a loss factor that the damping takes and nobody has given; timber classes have 0 then."""
        need_losses(here, self.like, self.loss_factor is not None or self.like in CLASSES)


def _kind(value: Any) -> str:
    return LikeSpec.__name__ if isinstance(value, dict) and "like" in value else MaterialSpec.__name__


if TYPE_CHECKING:
    AnyMaterialSpec = MaterialSpec | LikeSpec
else:
    AnyMaterialSpec = Annotated[
        Annotated[MaterialSpec, Tag(MaterialSpec.__name__)] | Annotated[LikeSpec, Tag(LikeSpec.__name__)],
        Discriminator(_kind),
    ]


# ----------------------------------------------------------------------------------------------------------------------
# Cross-sections of bars as they are written.
# ----------------------------------------------------------------------------------------------------------------------

Area = Annotated[float, Quantity(("area",), above=0.0)]
SecondMoment = Annotated[float, Quantity(("second moment",), above=0.0)]


class ConstantsSpec(Spec):
    """A cross-section by its constants; shear coefficients 5/6 unless given."""

    makes = sections.Section
    A: Area
    Iy: SecondMoment
    Iz: SecondMoment
    J: SecondMoment
    ky: Factor = 5.0 / 6.0
    kz: Factor = 5.0 / 6.0


class ShapeSpec(Spec):
    """A cross-section by its outline."""

    shape: str

    def check(self, here: Here) -> None:
        """Note a wall thicker than half of what it is the wall of."""
        sides = self.given()
        thickness, least = sides.pop("thickness", 0.0), min(sides.values())
        here.at("thickness").need(2 * thickness < least, f"{thickness:g} m", f"less than half of {least:g} m")


def _outlined(word: str, function: Callable[..., sections.Section]) -> Any:
    """The spec of a shape: the keys are the arguments of its function, all of them lengths."""
    keys: Any = dict.fromkeys(list(signature(function).parameters)[1:], (Length, ...))
    doc = (getdoc(function) or "").partition("\n\n")[0]
    keys["shape"] = (Literal[word], ...)
    spec = create_model(f"{word.capitalize()}Spec", __base__=ShapeSpec, __doc__=doc, **keys)
    spec.makes = function
    return Annotated[spec, Tag(word)]


def _shape(value: Any) -> Any:
    """Its shape; `given` for one with a constant and without a shape, None for one with neither."""
    if not isinstance(value, dict):
        return "given"
    return value.get("shape", "given" if value.keys() & ConstantsSpec.keys() else None)


if TYPE_CHECKING:
    AnySection = ConstantsSpec | ShapeSpec
else:
    AnySection = Annotated[
        _outlined("rectangle", sections.rectangle)
        | _outlined("circle", sections.circle)
        | _outlined("tube", sections.tube)
        | _outlined("box", sections.box)
        | _outlined("I", sections.i_section)
        | Annotated[ConstantsSpec, Tag("given")],
        Discriminator(_shape),
    ]


# ----------------------------------------------------------------------------------------------------------------------
# Cavities as they are written.
# ----------------------------------------------------------------------------------------------------------------------

Resistivity = Annotated[
    float,
    Quantity(
        ("flow resistivity",),
        above=0.0,
        least=100.0,
        most=1e6,
        too_small="mineral wool has 5 to 30 kPa*s/m^2; a plain number is in Pa*s/m^2",
        too_large="mineral wool has 5 to 30 kPa*s/m^2; a plain number is in Pa*s/m^2",
    ),
]
Bulk = Annotated[
    float,
    Quantity(
        ("density",),
        above=0.0,
        least=1.0,
        most=500.0,
        too_small="mineral wool has 10 to 200 kg/m^3",
        too_large="it is the density of the wool, not of its fibres: 10 to 200 kg/m^3",
    ),
]
Places = Annotated[tuple[float, ...], read_by(several(LENGTH.read), Length | list[Length])]


class FillSpec(Spec):
    """Wool in a cavity, against its second surface: all of the depth, or a thickness. frame: limp for loose wool, held
    for wool that is fixed. like: one of the library, which brings what is not given."""

    model_config = brought_by_key("flow_resistivity", "density")

    makes = Fill
    like: Annotated[Text | None, entry_for(Use.FILL, "a wool of the library", "wool")] = None
    flow_resistivity: Resistivity
    density: Bulk
    thickness: SideLength | None = None
    frame: Literal["limp", "held"] = "limp"

    @classmethod
    def completed(cls, given: dict[str, Any]) -> dict[str, Any]:
        like, known = given.get("like"), names_for(Use.FILL)
        if like is None and given.keys() <= cls.keys():
            return given
        entry = library()[like if like in known else known[0]]  # a misspelt name or key is one mistake
        return {"flow_resistivity": entry.number("flow_resistivity"), "density": entry.number("rho"), **given}

    def given(self) -> dict[str, Any]:
        return {**super().given(), "like": entry_source(self.like)}


class BaysSpec(Spec):
    """Joists that close a cavity: where their middles are along x or y of the first surface, from the corner of the
    cavity, and their width."""

    makes = Bays
    across: Literal["x", "y"]
    at: Places
    width: Gap = 0.0


class CavitySpec(Spec):
    """Air between two surfaces that face each other: a void over a ceiling, the inside of a double wall."""

    makes = AirBetween
    only_written = ("between", "air")
    between: tuple[SurfaceName, SurfaceName] = Field(
        description="two surfaces that face each other; wool lies on the second"
    )
    depth: SideLength
    air: AirSpec = AirSpec()
    fill: FillSpec | None = None
    bays: BaysSpec | None = None
    up_to: Frequency | None = None

    def check(self, here: Here) -> None:
        first, second = self.between
        here.at("between").need(first != second, f"'{first}' twice", "two surfaces that face each other")
        self.air.check(here.at("air"))
        thickness = None if self.fill is None else self.fill.thickness
        here.at("fill", "thickness").need(
            thickness is None or thickness <= self.depth * (1 + 1e-9),
            f"{thickness} m of wool in a cavity {self.depth:g} m deep",
            "at most the depth",
            "leave it out to fill the cavity",
        )

    def given(self) -> dict[str, Any]:
        first, second = self.between
        return {**super().given(), "first": first, "second": second, "c": self.air.c, "rho": self.air.rho}
