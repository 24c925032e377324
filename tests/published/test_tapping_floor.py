"""The tapping machine of models/tapping.study.yaml, from the hammers' contact to the rating, against EN ISO 12354-2."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from acoustics.levels.rated import RatedRoom
from acoustics.levels.standards import ImpactRating, normalised_impact_level, weighted_impact_level
from femstruct.language.cases import read_study
from femstruct.study.results import StudyResult
from femstruct.workflow.run import run_study

STUDY = Path(__file__).parents[2] / "models" / "tapping.study.yaml"
VOLUME = 4.2 * 3.1 * 2.5


@pytest.fixture(scope="module")
def result() -> StudyResult:
    return run_study(read_study(STUDY))


def rated(result: StudyResult, case: str) -> RatedRoom:
    return result.cases[case].rated["bedroom"]


def normalised(room: RatedRoom) -> ImpactRating:
    """L_n,w: of L_nT with 10 lg(0.032 V) added in every band."""
    in_bands = {band: level + 10 * np.log10(0.032 * VOLUME) for band, level in room.bands_db.items()}
    plain = dict(zip(room.bands_hz, 10 * np.log10(np.mean(10 ** (room.measured_db / 10), axis=(0, 1))), strict=True))
    assert in_bands == pytest.approx(normalised_impact_level(plain, VOLUME, room.t60_s))
    return weighted_impact_level(in_bands, step_db=0.1)


@pytest.mark.stress  # some 70 s of CPU time for the study; all tests here share it
@pytest.mark.parametrize(("case", "thickness"), [("bare", 0.14), ("200 mm", 0.2)])
def test_a_bare_slab_is_as_loud_as_its_mass_says(result: StudyResult, case: str, thickness: float) -> None:
    """L_n,w = 164 - 35 lg(m' / 1 kg/m^2), EN 12354-2 annex B, for homogeneous floors of 100 to 600 kg/m^2, as quoted in
    https://github.com/jmrplens/phonometry (tests/reference_data.py)."""
    found = normalised(rated(result, case))
    wanted = 164 - 35 * np.log10(thickness * 2400)
    # Elastic hammers hand over 1.96 m v, real ones between 1 and 2 m v: up to 3 dB above the middle, where we take the
    # formula to be; 1 dB for a loss factor that is the same at all frequencies. Found: 1.6 and 2.5 dB above
    assert -1.0 < found.weighted_db - wanted < 4.0
    # bare concrete: all bands alike, so that the highest decides and C_I is near the -11 dB of ISO 717-2's bare floor
    assert found.deciding_hz >= 2000.0
    assert found.adaptation_db == pytest.approx(-11.0, abs=3.0)


@pytest.mark.stress  # with the one above
def test_a_floating_screed_improves_it_as_the_standard_says(result: StudyResult) -> None:
    """Delta L_w = 13 lg m' - 14.2 lg s' + 20.8 for cement screeds, EN ISO 12354-2 annex C, as quoted by several public
    codes; m' in kg/m^2, s' in MN/m^3."""
    wanted = 13 * np.log10(0.06 * 2000) - 14.2 * np.log10(10.0) + 20.8
    # the standard's is of a reference floor and of measured screeds, with a scatter of 3 dB or so; found 32.5
    least, bare = (rated(result, case).numbers["L'_nT,w"] for case in ("floating screed", "bare"))
    assert least.blank_hz[0] == 1250.0  # from there on screeds are far below the reference curve
    assert bare.unrounded_db - least.unrounded_db == pytest.approx(wanted, abs=4.0)


def modes_with_shear(hz: float, h: float, E: float = 30e9, nu: float = 0.2, rho: float = 2400.0) -> float:
    """Modal density of a plate of Mindlin's over that of a thin one, d(k^2)/d omega sqrt(D / rho h), by differences of
    the larger root of (D k^2 - rho h^3/12 w^2) (kappa G h k^2 - rho h w^2) = kappa G h rho h w^2."""
    shear, D, turning = 5 / 6 * E / (2 * (1 + nu)) * h, E * h**3 / (12 * (1 - nu**2)), rho * h**3 / 12

    def squared(w: float) -> float:
        linear, rest = -(w**2) * (D * rho * h + turning * shear), (turning * w**2 - shear) * rho * h * w**2
        return float(np.roots([D * shear, linear, rest]).real.max())

    w, step = 2 * np.pi * hz, 2e-4 * np.pi * hz
    return (squared(w + step) - squared(w - step)) / (2 * step * np.sqrt(rho * h / D))


@pytest.mark.stress  # with those above
def test_the_numbers_of_the_shipped_study_and_its_verdicts(result: StudyResult) -> None:
    expected = {"bare": (77, -9), "carpet": (61, 2), "200 mm": (72, -9)}
    for case, (weighted, adaptation) in expected.items():
        rating = rated(result, case).rating
        assert rating is not None
        assert (rating.value_db, dict(rating.beside)) == (weighted, {"C_I": adaptation}), case
        (verdict,) = result.verdicts[case]
        assert (verdict.value, verdict.limit, verdict.met) == (weighted, 62.0, weighted <= 62), case
    screed = rated(result, "floating screed").rating
    assert screed is not None
    assert (screed.value_db, dict(screed.beside), len(screed.blank_hz)) == (44, {}, 5)
    (verdict,) = result.verdicts["floating screed"]
    assert (verdict.met, verdict.least) == (None, True)
    codes = {found.code: found for found in result.cases["bare"].findings}
    assert codes["one-way-resonance"].values["kappa"] == pytest.approx(0.15, abs=0.01)  # 0.15 at 76 Hz by hand
    # the fall from 40 mm onto 140 mm of concrete, by the test of statistical energies: 1.959 m v
    assert codes["hammers-rebound"].values["restitution"] == pytest.approx(0.959, abs=0.01)
    denser = codes["thick-for-short-waves"].values["density_ratio"]
    assert denser == pytest.approx(modes_with_shear(3960.0, 0.14), rel=1e-6)  # differences of the second order
