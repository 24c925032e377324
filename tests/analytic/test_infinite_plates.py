"""Infinite plates: mobility, waves, modal density and radiation against closed forms and other derivations."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipk, j0

from acoustics.air import Air
from acoustics.errors import AcousticsError
from acoustics.levels.statistical import InfinitePlate, diffuse_radiation, isotropic_plate

THIRDS = 1000.0 * 10 ** (np.arange(-13, 6) / 10)
# cross-laminated timber of five layers of 40 mm: D and S of its section, D66 of full glue
CLT = ((5859306.7, 1720693.3, 0.0, 460000.0), (21462546.0, 13189651.0), 90.0)
# real part of its mobility with shear, no rotary inertia: residues along each angle, computed by us for the study of
# real floors, to all digits of it
CLT_SHEAR = {
    50.0: 1.0870709e-05,
    100.0: 1.3979016e-05,
    200.0: 2.1285247e-05,
    500.0: 4.7269712e-05,
    2000.0: 1.8673605e-4,
}


def mindlin(frequency_hz: float, plate: InfinitePlate) -> tuple[float, float]:
    """(Re Y, k) of an isotropic plate with shear, by the residue of its dispersion relation in closed form."""
    w, d, g, j, m = 2 * pi * frequency_hz, plate.rigidity[0], plate.shear[0], plate.rotary, plate.mass
    a, b, c = g * d, -(m * d + g * j) * w**2, -m * w**2 * (g - j * w**2)
    x = (-b + sqrt(b**2 - 4 * a * c)) / (2 * a)
    return w / 4 * (d * x + g - j * w**2) / (2 * g * d * x - m * d * w**2 - g * j * w**2), sqrt(x)


def test_a_thin_isotropic_plate_is_a_resistance() -> None:
    plate = isotropic_plate(30e9, 0.2, 2400.0, 0.14, thin=True)
    resistance = 8 * sqrt(plate.mass * plate.rigidity[0])
    assert plate.mobility(THIRDS) * resistance == pytest.approx(np.ones(19), rel=1e-12)  # rounding
    # S/2 sqrt(m/D)
    wanted = 6 * sqrt(plate.mass / plate.rigidity[0])
    assert plate.modes_per_hz(THIRDS, 12.0) == pytest.approx(wanted, rel=1e-12)  # rounding


@pytest.mark.parametrize(
    ("thickness", "hz", "above_db"),
    [(0.14, 250.0, 0.23), (0.14, 1000.0, 0.88), (0.14, 3162.0, 2.53), (0.18, 1000.0, 1.11)],
)
def test_shear_adds_to_the_mobility(thickness: float, hz: float, above_db: float) -> None:
    thin, thick = (isotropic_plate(30e9, 0.2, 2400.0, thickness, thin=one) for one in (True, False))
    f = np.array([hz])
    found = float(thick.mobility(f)[0])
    assert 10 * np.log10(found / thin.mobility(f)[0]) == pytest.approx(above_db, abs=0.006)  # digits of the study
    mobility, k = mindlin(hz, thick)
    assert found == pytest.approx(mobility, rel=1e-9)  # an eigenvalue against a root: rounding
    assert thick.waves(f).wavenumber[0] == pytest.approx(k, rel=1e-9)  # rounding


def test_a_thin_orthotropic_plate_has_an_elliptic_integral() -> None:
    for d66 in (460000.0, 299000.0):
        dx, dy, d12, _ = CLT[0]
        plate = InfinitePlate(CLT[2], (dx, dy, d12, d66))
        h = (d12 + 2 * d66) / sqrt(dx * dy)
        wanted = ellipk((1 - h) / 2) * 2 / pi / (8 * sqrt(CLT[2] * sqrt(dx * dy)))
        assert plate.mobility(np.array([100.0])) == pytest.approx(wanted, rel=1e-9)  # angles converge exponentially
    assert InfinitePlate(CLT[2], CLT[0]).mobility(np.array([100.0])) == pytest.approx(8.2267567e-6, rel=1e-7)  # digits


def test_cross_laminated_timber_with_shear() -> None:
    plate = InfinitePlate(CLT[2], CLT[0], CLT[1])
    assert plate.mobility(np.array(list(CLT_SHEAR))) == pytest.approx(list(CLT_SHEAR.values()), rel=1e-6)  # its digits
    # turned by a quarter it is the same plate
    turned = InfinitePlate(CLT[2], (CLT[0][1], CLT[0][0], *CLT[0][2:]), CLT[1][::-1], rotary=0.3)
    straight = InfinitePlate(CLT[2], CLT[0], CLT[1], rotary=0.3)
    assert turned.mobility(THIRDS) == pytest.approx(straight.mobility(THIRDS), rel=1e-9)  # rounding


def test_the_modal_density_counts_the_waves() -> None:
    """dN/df from the area that wavenumbers enclose: N = S / (4 pi) mean k^2, whatever the plate."""
    for plate in (isotropic_plate(30e9, 0.2, 2400.0, 0.2), InfinitePlate(CLT[2], CLT[0], CLT[1], rotary=0.3)):
        for f in (100.0, 1000.0, 3000.0):
            near = np.array([f * (1 - 1e-4), f * (1 + 1e-4)])
            enclosed = 20.0 / (4 * pi) * (plate.waves(near).wavenumber ** 2).mean(axis=1)
            wanted = (enclosed[1] - enclosed[0]) / (near[1] - near[0])
            assert plate.modes_per_hz(np.array([f]), 20.0)[0] == pytest.approx(wanted, rel=1e-6)  # central difference


def test_a_force_over_a_patch_drives_short_waves_less() -> None:
    plate = isotropic_plate(30e9, 0.2, 2400.0, 0.14)
    f = np.array([3162.0])
    k = float(plate.waves(f).wavenumber[0, 0])
    mean = quad(lambda r: 2 * r * j0(k * 0.1 * r), 0, 1)[0]  # of the wave over a disc of 100 mm
    assert plate.mobility(f, 0.1) / plate.mobility(f) == pytest.approx(mean**2, rel=1e-9)  # quad
    assert 10 * np.log10(plate.mobility(f, 0.015) / plate.mobility(f)) > -0.05  # a hammer is as good as a point


def test_radiation_is_that_of_yu_and_hopkins() -> None:
    """Their one integral over r, of the correlation J0(k_B r) and the overlap of a rectangle with itself."""
    a, b, slab = 5.0, 4.0, isotropic_plate(30e9, 0.2, 2400.0, 0.18, thin=True)

    def integral(k: float, k_b: float) -> float:
        angle = (np.arange(400) + 0.5) * pi / 800
        r = np.linspace(0.0, np.hypot(a, b), 20001)
        parts = []
        for some in np.array_split(r, 50):
            across = [(a, np.cos(angle)), (b, np.sin(angle))]
            inside = [np.clip(side - np.outer(some, one), 0, None) for side, one in across]
            parts.append(2 * pi * (inside[0] * inside[1]).mean(axis=1))
        return float(k / (2 * pi * a * b) * np.trapezoid(np.concatenate(parts) * j0(k_b * r) * np.sin(k * r), r))

    waves = slab.waves(THIRDS)
    found = diffuse_radiation(waves, THIRDS, (a, b), Air())
    for i in (0, 3, 8, 14):
        wanted = integral(2 * pi * THIRDS[i] / 343.0, float(waves.wavenumber[i, 0]))
        assert found[i] == pytest.approx(wanted, rel=1e-4)  # the rule along r
    told = [0.33, 0.46, 0.67, 0.98, 1.35, 1.56, 1.43, 1.27, 1.21, 1.15, 1.12, 1.09]  # of the study of levels
    assert found[:12] == pytest.approx(told, abs=0.006)  # digits
    assert found[-1] == pytest.approx(1 / sqrt(1 - 98.0 / THIRDS[-1]), rel=1e-3)  # a law far above f_c


def test_stiff_directions_radiate_first() -> None:
    """Between its two critical frequencies only a share of the directions of an orthotropic plate radiates well."""
    plate, f = InfinitePlate(CLT[2], CLT[0]), np.array([60.0, 100.0, 400.0])
    stiff, weak = (InfinitePlate(CLT[2], (d, d, 0.0, d / 2)) for d in CLT[0][:2])
    of = [diffuse_radiation(one.waves(f), f, (6.0, 5.0), Air()) for one in (weak, plate, stiff)]
    assert of[0][1] < of[1][1] < of[2][1]
    assert of[1][2] == pytest.approx(1.15, abs=0.15)  # far above both: near 1, f_c 73 and 136 Hz


@pytest.mark.parametrize(
    ("made", "told"),
    [
        (lambda: InfinitePlate(-1.0, CLT[0]), "plate.mass: got -1"),
        (lambda: InfinitePlate(90.0, (1e6, 1e6, 2e6, 1e5)), "plate.D12"),
        (lambda: InfinitePlate(90.0, CLT[0], (0.0, 1e6)), "plate.shear"),
        (lambda: InfinitePlate(90.0, CLT[0], CLT[1], -1.0), "plate.rotary"),
    ],
)
def test_plates_that_cannot_be(made: object, told: str) -> None:
    with pytest.raises(AcousticsError, match=told):
        made()  # type: ignore[operator]
