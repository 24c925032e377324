"""Materials as they are written."""

from __future__ import annotations

from typing import Annotated

from femstruct.language.yaml import AnyRatio, MaterialLossFactor, Quantity, Spec
from femstruct.model.material import Material

Modulus = Annotated[float, Quantity(("pressure",), above=0.0)]


class MaterialSpec(Spec):
    """A linear elastic isotropic material."""

    makes = Material
    E: Modulus
    nu: AnyRatio
    rho: Annotated[float, Quantity(("density",), least=0.0)]
    loss_factor: MaterialLossFactor = 0.0
