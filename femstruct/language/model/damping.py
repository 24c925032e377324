"""The damping of a structure as it is written."""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from pydantic import Field

from femstruct.language.yaml import Frequency, Here, LossFactor, Quantity, Ratio, Spec
from femstruct.modal import damping


class RayleighSpec(Spec):
    """C = alpha M + beta K."""

    makes = damping.Rayleigh
    alpha: Annotated[float, Quantity(("rate",), least=0.0)] = 0.0
    beta: Annotated[float, Quantity(("time",), least=0.0)] = 0.0


class ModeDampingSpec(Spec):
    """The damping of one mode, and the frequency at which that mode is expected."""

    one_of = (("ratio", "loss_factor"),)

    ratio: Ratio | None = None
    loss_factor: LossFactor | None = None
    near: Frequency


class DampingSpec(Spec):
    """The structure's own damping: a general law and exceptions by mode number."""

    at_most_one_of = (("ratio", "loss_factor", "rayleigh", "from"),)

    makes = damping.Damping
    short = "loss_factor"
    ratio: Ratio | None = None
    loss_factor: LossFactor | None = None
    rayleigh: RayleighSpec | None = None
    source: Literal["materials"] | None = Field(default=None, alias="from")
    modes: dict[str, ModeDampingSpec] = Field(default_factory=dict)

    @classmethod
    def meant_by(cls, value: object) -> str:
        return "{from: materials}" if value == "materials" else super().meant_by(value)

    def check(self, here: Here) -> None:
        given, do = self.rayleigh is None or self.rayleigh.model_fields_set, "write it like {beta: 1e-5 s}"
        here.at("rayleigh").need(given, "no alpha and no beta", "one or both of them", do)
        for mode in self.modes:
            here.at("modes", mode).need(
                re.fullmatch("[1-9][0-9]{0,5}", mode), f"'{mode}'", "a mode number from 1", of_key=True
            )

    def given(self) -> dict[str, Any]:
        base = self.rayleigh.noun() if self.rayleigh is not None else damping.Ratio(self.ratio or 0.0)
        if self.loss_factor is not None:
            base = damping.LossFactor(self.loss_factor)
        elif self.source is not None:
            base = damping.FromMaterials()
        modes = [damping.ModeDamping(int(n), one.near, one.ratio, one.loss_factor) for n, one in self.modes.items()]
        return {"base": base, "modes": tuple(modes)}
