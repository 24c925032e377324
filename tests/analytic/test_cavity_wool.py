"""Wool as an equivalent fluid against Johnson-Champoux-Allard, and two plates with it by transfer matrices.

Numbers of the double plate: computed twice for this project, by transfer matrices and by a direct solve.
"""

from __future__ import annotations

import numpy as np
import pytest

from acoustics.air import Air
from acoustics.rooms.cavities import GAMMA, LEAST, MOST, PRANDTL, Wool

P0, RHO = 101325.0, 1.204
AIR = Air((1.4 * P0 / RHO) ** 0.5, RHO)
VISCOSITY, POROSITY = 1.84e-5, 0.98
HZ = np.array([20.0, 50.0, 100.0, 200.0, 500.0, 1000.0])


def champoux_allard(sigma: float, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Density and modulus per volume flux; thermal length twice the viscous one, sqrt(8 eta / (sigma phi))."""
    viscous = np.sqrt(8 * VISCOSITY / (sigma * POROSITY))
    thermal = 2 * viscous
    drag = sigma * np.sqrt(1 + 4 * s * VISCOSITY * RHO / (sigma * viscous * POROSITY) ** 2)
    density = RHO / POROSITY + drag / s
    slow = 8 * VISCOSITY / (PRANDTL * RHO * thermal**2)
    heat = 1 + slow / s * np.sqrt(1 + s * RHO * PRANDTL * thermal**2 / (16 * VISCOSITY))
    return density, GAMMA * P0 / POROSITY / (GAMMA - (GAMMA - 1) / heat)


@pytest.mark.parametrize("sigma", [LEAST, 1e4, MOST])
def test_wool_against_johnson_champoux_allard(sigma: float) -> None:
    wool, s = Wool(sigma, frame="held", porosity=POROSITY), 2j * np.pi * HZ
    density, modulus = champoux_allard(sigma, s)
    ours = wool.density_at(s, AIR), wool.modulus_at(s, AIR)
    np.testing.assert_allclose((s * ours[0]).real, (s * density).real, rtol=0.065)  # the model's error: 6 %
    np.testing.assert_allclose(ours[1].real, modulus.real, rtol=0.062)  # as stated in its notes
    assert np.abs(ours[1].imag - modulus.imag).max() < 0.09 * P0  # as stated in its notes
    assert (ours[1].imag > 0).all() and (ours[0].real > 0).all()  # passive


@pytest.mark.parametrize(("sigma", "hz"), [(5e3, 228.0), (1e4, 456.0), (30e3, 1368.0)])
def test_the_thermal_rate_follows_from_the_flow_resistivity(sigma: float, hz: float) -> None:
    thermal = 2 * np.sqrt(8 * VISCOSITY / (sigma * POROSITY))
    rate = 8 * VISCOSITY / (thermal**2 * RHO * PRANDTL)
    found = Wool(sigma, porosity=POROSITY).rate(AIR)
    assert found == pytest.approx(rate, rel=1e-12)  # rounding
    assert found / (2 * np.pi) == pytest.approx(hz, abs=0.5)  # digits of the source


def test_wool_of_the_reference_table() -> None:
    """10 kPa s/m^2 at 20, 100 and 500 Hz: Re, Im K / P0, Re rho / rho."""
    s, wool = 2j * np.pi * np.array([20.0, 100.0, 500.0]), Wool(1e4, frame="held", porosity=POROSITY)
    modulus = wool.modulus_at(s, AIR) / P0
    # digits of the table, whose viscosity is rounded no more than ours
    np.testing.assert_allclose(modulus.real, [1.0208081, 1.0301773, 1.17553], rtol=2e-6)
    np.testing.assert_allclose(modulus.imag, [0.012770524, 0.062385486, 0.1981218], rtol=2e-6)
    np.testing.assert_allclose(wool.density_at(s, AIR).real / RHO, 1 / POROSITY, rtol=1e-12)  # rounding


def test_limp_wool_goes_with_the_air_below_its_frequency() -> None:
    s, wool = 2j * np.pi * np.array([1e-2, 1e5]), Wool(1e4, 40.0)
    carried, still = wool.density_at(s, AIR)
    assert carried.real == pytest.approx(RHO + 40.0, rel=1e-6)  # (f / 40 Hz)^2
    assert still == pytest.approx(RHO + 1e4 / s[1], rel=1e-3)  # 40 Hz over f


@pytest.mark.parametrize(
    ("hz", "bare", "filled", "oblique"),
    [
        (31.5, 10.366759, 18.821336, 16.596828),
        (33.5, 6.5387655, 22.095309, 19.504579),
        (50.0, 33.436796, 38.339085, 35.018119),
        (100.0, 55.434839, 58.926894, 54.292456),
        (500.0, 93.021154, 102.02571, 111.1164),
    ],
)
def test_an_infinite_double_plate(hz: float, bare: float, filled: float, oblique: float) -> None:
    """80 and 20 kg/m^2, 2 MN m and 900 N m, 0.2 m apart: sound reduction index, normal and at 45 degrees with wool."""
    wool = Wool(1e4, frame="held", thermal_rate=2866.0)
    s = np.array([2j * np.pi * hz])
    within = wool.density_at(s, AIR)[0], wool.modulus_at(s, AIR)[0]
    air = complex(RHO), complex(AIR.bulk_modulus)
    for medium, angle, expected in ((air, 0.0, bare), (within, 0.0, filled), (within, np.pi / 4, oblique)):
        # digits of the reference
        assert reduction(hz, medium, angle) == pytest.approx(expected, abs=2e-5)


def reduction(hz: float, medium: tuple[complex, complex], angle: float) -> float:
    """R [dB] of two plates around a layer by transfer matrices of pressure and normal velocity."""
    w = 2 * np.pi * hz
    trace = w / AIR.c * np.sin(angle)
    outside = RHO * AIR.c / np.cos(angle)
    density, modulus = medium
    k = np.sqrt(w**2 * density / modulus - trace**2 + 0j)
    k = -k if k.imag > 0 else k
    z, d = w * density / k, 0.2
    layer = np.array([[np.cos(k * d), 1j * z * np.sin(k * d)], [1j * np.sin(k * d) / z, np.cos(k * d)]])

    def plate(m: float, stiffness: float) -> np.ndarray:
        return np.array([[1, 1j * w * m + stiffness * (1 + 0.02j) * trace**4 / (1j * w)], [0, 1]])

    whole = plate(80.0, 2e6) @ layer @ plate(20.0, 900.0)
    total = whole[0, 0] + whole[0, 1] / outside + outside * whole[1, 0] + whole[1, 1]
    return float(20 * np.log10(abs(total) / 2))
