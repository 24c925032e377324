"""What a study optimises, as it is written."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from femstruct.errors import InputError, shown_as
from femstruct.language.study.campaign.vary import AnyQuantity, SamplesSpec, VarySpec, varied_of
from femstruct.language.yaml import Count, Here, Quantity, Spec, Text, refuse
from femstruct.language.yaml.tree import nearest
from femstruct.study.campaign.sought import Goal
from femstruct.study.campaign.varied import Listed, Scattered

Quantile = Annotated[float, Quantity(("ratio",), above=0.0, below=1.0)]


class RobustSpec(Spec):
    """What scatters and cannot be chosen: paths under `vary:` with a distribution, and for which share of it goal and
    limits are to hold."""

    over: list[Text]
    quantile: Quantile = 0.9
    samples: Count = 10


def _names(value: object) -> object:
    """One name as a list of one."""
    if not isinstance(value, str | list):
        raise refuse(
            shown_as(value),
            "the name of a number, or a list of names",
            "write it like [bodies.damper.mass, ground force]",
        )
    return [value] if isinstance(value, str) else value


Names = Annotated[list[Text], BeforeValidator(_names, json_schema_input_type=str | list[str])]


class OptimiseSpec(Spec):
    """A number that is to be small or large, or up to three, what may be chosen for it, and what other numbers should
    not exceed."""

    minimise: Names = Field(default_factory=list)
    maximise: Names = Field(default_factory=list)
    vary: dict[str, VarySpec] = Field(default_factory=dict)
    limits: dict[str, AnyQuantity] = Field(default_factory=dict)
    robust: RobustSpec | None = None
    case: Text | None = None
    runs: Count = 400
    seed: Count = 1

    def goals(self) -> tuple[Goal, ...]:
        """All goals, those that are to be small first. Raises InputError where there is none."""
        found = tuple(Goal(name, "minimise") for name in self.minimise)
        found += tuple(Goal(name, "maximise") for name in self.maximise)
        if not found:
            raise InputError(
                "optimise",
                got="none of minimise, maximise",
                expected="one or both of them",
                do="write it like 'minimise: ground force' or 'minimise: [bodies.damper.mass, ground force]'",
            )
        return found

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


class CampaignSpec(Spec):
    """What of a study file concerns many runs of it."""

    vary: dict[str, VarySpec] = Field(default_factory=dict)
    samples: SamplesSpec | None = None
    optimise: OptimiseSpec | None = None

    def check_campaign(self, here: Here) -> None:
        """Note what cannot vary as it is written."""
        varied = varied_of(self.vary, here)
        if self.optimise is not None:
            asked, there = self.optimise, here.at("optimise")
            varied_of(asked.vary, there)
            there.at("robust", "over").make(lambda: asked.scattering(varied))
