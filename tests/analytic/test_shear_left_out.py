"""What a thin plate leaves out of the modes of a thick one, and the finding that tells it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import femstruct as fs
from femstruct.language.models import read_model_file
from femstruct.model.lay_ups import section_of
from femstruct.model.materials import Material
from femstruct.model.mesher import mesh_structure
from femstruct.model.structure import Structure
from femstruct.parts.wave_findings import SLENDER, bending_wavelength, cell_for, mesh_findings, with_shear

CONCRETE = Material("concrete", 30e9, 0.2, 2400.0)
MODEL = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts: {slab: {type: plate, material: concrete, thickness: 140 mm, origin: [0, 0, 0], size: [4, 3], mesh: 85 mm}}
"""


def mindlin(omega: float, h: float) -> float:
    """Wavenumber at which Mindlin's two equations for deflection and rotation have a solution, by their determinant."""
    shear = 5 / 6 * CONCRETE.E / 2 / (1 + CONCRETE.nu) * h
    bending, mass = CONCRETE.E * h**3 / 12 / (1 - CONCRETE.nu**2), CONCRETE.rho * h

    def determinant(k: float) -> float:
        deflection = shear * k**2 - mass * omega**2
        rotation = bending * k**2 + shear - mass * h**2 / 12 * omega**2
        return deflection * rotation - (shear * k) ** 2

    return float(brentq(determinant, 1e-6, 1e3, xtol=1e-12, rtol=1e-14))


@pytest.mark.parametrize(("h", "frequency_hz"), [(0.14, 100.0), (0.14, 3150.0), (0.2, 3150.0), (0.06, 3600.0)])
def test_shear_shortens_waves_and_crowds_modes(h: float, frequency_hz: float) -> None:
    """N(f) = S k^2 / 4 pi: modes are as dense as k^2 grows, here by a central difference."""
    omega, step = 2 * np.pi * frequency_hz, 1e-4
    thin = np.sqrt(12 * (1 - CONCRETE.nu**2) * CONCRETE.rho / CONCRETE.E) / h  # k^2 = omega sqrt(rho h / D)
    shorter, denser = with_shear(section_of(CONCRETE, h), frequency_hz)
    assert shorter == pytest.approx(mindlin(omega, h) / np.sqrt(omega * thin), rel=1e-12)  # rounding: 2e-15 here
    up, down = (mindlin(omega * (1 + sign * step), h) ** 2 for sign in (1, -1))
    # central difference of 1e-4: 2e-10 here
    assert denser == pytest.approx((up - down) / (2 * step * omega) / thin, rel=2e-8)


@pytest.mark.parametrize("nu", [0.0, 0.2, 0.4])
def test_what_shear_takes_where_a_plate_begins_to_be_thick(nu: float) -> None:
    """The numbers of the catalogue at SLENDER: of the wave of one frequency, and of the frequency of one wavelength.
    Mindlin's two equations, as above."""
    h, k = 0.1, 2.0 * np.pi / (SLENDER * 0.1)
    shear, bending, mass = 5 / 6 * 30e9 / 2 / (1 + nu) * h, 30e9 * h**3 / 12 / (1 - nu**2), 2400.0 * h
    thin = k**2 * np.sqrt(bending / mass)

    def determinant(k: float, omega: float) -> float:
        rotation = bending * k**2 + shear - mass * h**2 / 12 * omega**2
        return (shear * k**2 - mass * omega**2) * rotation - (shear * k) ** 2

    lower = 1.0 - brentq(lambda omega: determinant(k, omega), 0.5 * thin, thin) / thin
    shorter = 1.0 - k / brentq(lambda k: determinant(k, thin), k, 2.0 * k)
    assert 0.025 < shorter < 0.04 and 0.05 < lower < 0.075  # "3 %" and "5 %": 2.7 to 3.9, 5.1 to 7.2


def test_a_thick_slab_is_told_with_its_numbers(tmp_path: Path) -> None:
    (tmp_path / "slab.yaml").write_text(MODEL, encoding="utf-8")
    structure = read_model_file(tmp_path / "slab.yaml").structure
    assert isinstance(structure, Structure)
    model = mesh_structure(structure)
    (told,) = (found for found in mesh_findings(model, 3150.0) if found.code == "thick-for-short-waves")
    wave = bending_wavelength(model.parts["slab"], 3150.0)
    assert told.values["wavelength_m"] == wave == pytest.approx(3.85 * 0.14, rel=1e-3)  # three digits of 3.85
    assert told.values["thickness_m"] == 0.14
    assert told.values["density_ratio"] == with_shear(section_of(CONCRETE, 0.14), 3150.0)[1]
    assert "3.9 times the thickness" in told.message
    assert "modal density is too low by a factor of 1.96, and levels of a blow by up to 2.9 dB" in told.message
    # ten thicknesses to a wave: 100 / 0.14 ... lambda goes as 1 / sqrt(f)
    assert not [found for found in mesh_findings(model, 3150.0 * (0.384) ** 2) if found.code == "thick-for-short-waves"]


@pytest.mark.parametrize("kind", ["plate", "slab"])
def test_the_cell_that_is_advised_is_just_enough(kind: str) -> None:
    """20 x 20 cells a little smaller and a little larger than the cell for 2 kHz."""
    for share in (0.999, 1.001):
        one = fs.Plate("p", CONCRETE, 0.14, (0.0, 0.0, 0.0), (1.0, 1.0), (2, 2))
        slab = fs.Slab("p", CONCRETE, 0.14, ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)), mesh=0.5)
        cell = cell_for(one if kind == "plate" else slab, 2000.0)
        assert cell is not None
        side = 20 * share * cell
        corners = ((0.0, 0.0), (side, 0.0), (side, side), (0.0, side))
        part = replace(one, size=(side, side), mesh=(20, 20)) if kind == "plate" else replace(slab, outline=corners,
                       mesh=1.0001 * share * cell)  # fmt: skip
        codes = {found.code for found in mesh_findings(mesh_structure(Structure("s", (part,))), 2000.0)}
        assert ("coarse-mesh" in codes) is (share > 1.0), (share, codes)
