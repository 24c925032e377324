"""A material as a bar has it: one modulus along the axis, shear in two planes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from femstruct.model.material import Material
from femstruct.model.materials.orthotropic import AnyMaterial
from femstruct.model.section import Section


def of_bar(material: AnyMaterial, section: Section) -> tuple[float, float, Section]:
    """E along a bar [Pa], G of its torsion [Pa], and the section with shear coefficients that go with this G.

    The x of an orthotropic material is along the axis, its y and z along those of the section. Bending along y shears
    with Gxy, along z with Gzx; torsion with the root of both, which is exact where they are alike, as nearly in timber.

    >>> from femstruct.model.materials.orthotropic import Orthotropic
    >>> spruce = Orthotropic("spruce", E=(11e9, 370e6), G=(690e6, 50e6, 690e6), nu=0.35, rho=420.0)
    >>> of_bar(spruce, Section("joist", A=0.02, Iy=1e-4, Iz=2e-5, J=5e-5))[:2]
    (11000000000.0, 690000000.0)
    """
    if isinstance(material, Material):
        return material.E, material.G, section
    xy, _, zx = material.G
    G = float(np.sqrt(xy * zx))
    return material.E[0], G, replace(section, ky=section.ky * xy / G, kz=section.kz * zx / G)
