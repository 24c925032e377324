"""What a study optimises, as it is written."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field

from femstruct.errors import InputError
from femstruct.language.study.campaign.vary import AnyQuantity, VarySpec
from femstruct.language.yaml import Count, Quantity, Spec, Text
from femstruct.language.yaml.tree import nearest
from femstruct.study.campaign.varied import Listed, Scattered

Quantile = Annotated[float, Quantity(("ratio",), above=0.0, below=1.0)]


class RobustSpec(Spec):
    """What scatters and cannot be chosen: paths under `vary:` with a distribution, and for which share of it goal and
    limits are to hold."""

    over: list[Text]
    quantile: Quantile = 0.9
    samples: Count = 8


class OptimiseSpec(Spec):
    """A number that is to be small or large, what may be chosen for it, and what other numbers should not exceed."""

    one_of = (("minimise", "maximise"),)
    minimise: Text | None = None
    maximise: Text | None = None
    vary: dict[str, VarySpec] = Field(default_factory=dict)
    limits: dict[str, AnyQuantity] = Field(default_factory=dict)
    robust: RobustSpec | None = None
    case: Text | None = None
    runs: Count = 400
    seed: Count = 1

    def scattering(self, varied: Mapping[str, Listed | Scattered]) -> tuple[Listed | Scattered, ...]:
        """What scatters, of all that varies. Raises InputError for a path that does not."""
        found = []
        for path in self.robust.over if self.robust else ():
            if path not in varied:
                do = nearest(path, varied) if varied else "add it under 'vary:'"
                raise InputError("optimise.robust.over", got=f"'{path}'", expected="a path under 'vary:'", do=do)
            found.append(varied[path])
        return tuple(found)

    def robustness(self) -> dict[str, Any]:
        """Quantile and samples, where something scatters."""
        return {} if self.robust is None else {"quantile": self.robust.quantile, "scatter": self.robust.samples}
