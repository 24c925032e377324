"""Materials as they are written."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

from pydantic import Discriminator, Tag, ValidationInfo

from femstruct.errors import InputError, shown_as
from femstruct.language.model.like import entry_for, need_losses
from femstruct.language.yaml import (
    AnyRatio,
    BandFile,
    Here,
    MaterialLossFactor,
    Quantity,
    Spec,
    Text,
    by_band,
    near_name,
    read_by,
    refuse,
    so_many,
    word_of,
)
from femstruct.model.library.alike import alike
from femstruct.model.library.all_entries import names_for
from femstruct.model.library.library_entry import Use
from femstruct.model.material import Material
from femstruct.model.materials.loss_by_frequency import (
    INTERNAL,
    MOST_LOSSES,
    LossByFrequency,
    laboratory_losses,
    measured_losses,
)
from femstruct.model.materials.orthotropic import AnyMaterial, Orthotropic
from femstruct.model.materials.timber import CLASSES

_MODULUS, _RATIO = Quantity(("pressure",), above=0.0), Quantity(("ratio",))
Modulus = Annotated[float, _MODULUS]
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
            raise refuse(shown_as(value), "a reverberation time for each frequency", "write it like {63 Hz: 0.4 s}")
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

    makes = alike
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
