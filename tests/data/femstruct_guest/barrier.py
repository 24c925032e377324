"""A law with kernels of its own: a spring that becomes stiff as it nears the depth of a layer."""

from dataclasses import dataclass
from typing import ClassVar

from scipy.optimize import brentq

from femstruct.compiled.kernels import kernel
from femstruct.declared import checked
from femstruct.laws.law import Code, Dissipation, FactorLaw, PositiveStiffness, StoredLaw
from femstruct.quantities import Length
from femstruct.tags import stored_as


@kernel
def _spring(system, a, delta):
    if delta <= 0.0:
        return 0.0, 0.0, 0.0
    k, depth = system.interfaces[a]["stiffness"], system.interfaces[a]["shape"]
    share = (delta / depth) ** 4.0
    return k * delta * (1.0 + share), k * (1.0 + 5.0 * share), k * delta * delta * (0.5 + share / 6.0)


CODE = Code(_spring)


@stored_as("femstruct_guest: barrier/1")
@dataclass(frozen=True)
@checked("{word} law")
class Barrier(FactorLaw):
    """f = k d (1 + (d / depth)^4) (1 + chi d'): the spring of a layer."""

    word: ClassVar = "barrier"
    code: ClassVar = CODE

    stiffness: PositiveStiffness
    depth: Length
    dissipation: Dissipation = 0.0
    tensile: bool = False

    @property
    def stored(self):
        return StoredLaw(self.stiffness, self.dissipation, self.depth)

    def force(self, d):
        return self.stiffness * d * (1.0 + (d / self.depth) ** 4)

    def energy(self, d):
        return self.stiffness * d**2 * (0.5 + (d / self.depth) ** 4 / 6.0)

    def indentation(self, force):
        return float(brentq(lambda d: self.force(d) - force, 0.0, force / self.stiffness))
