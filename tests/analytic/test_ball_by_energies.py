"""A rubber ball on a slab over a room, against statistical energies: no modes, no contact law, no room modes."""

from __future__ import annotations

from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

from femstruct.impact.scene import RUBBER_BALL
from femstruct.language.cases import read_study
from femstruct.workflow.run import run_study

MODELS = Path(__file__).parents[2] / "models"
C, RHO = 343.0, 1.21  # of air
E, NU, DENSITY = 30e9, 0.2, 2400.0  # of models/bedroom.yaml
ETA, VOLUME, FAST_S = 0.05, 50.0, 0.125
DENSE = (
    315.0,
    400.0,
    500.0,
    630.0,
)  # thirds of four modes of the slab and more, three times above its critical frequency


def exposure(band_hz: float) -> float:
    """Force exposure [N^2 s] of the ball in a third octave, by the octaves of the standard's table, a third of each at
    its centre."""
    table = RUBBER_BALL.exposure_db
    octaves, levels = np.log2(list(table)), np.array(list(table.values()))
    slope = levels[-1] - levels[-2]
    at = np.log2(band_hz)
    level = np.interp(at, octaves, levels) + slope * max(0.0, at - octaves[-1])
    return float(10 ** (level / 10) / 3)


def loudest_fast(thickness: float, band_hz: float, t60_s: float) -> float:
    """L_i,Fmax [dB] of one drop: the ball gives an infinite plate its energy at once, the plate's dies away by its own
    losses, radiates (rho c sigma S v^2) and the room's by its reverberation time."""
    stiffness, mass = E * thickness**3 / 12 / (1 - NU**2), DENSITY * thickness
    critical_hz = C**2 / (2 * pi) * sqrt(mass / stiffness)
    sigma = 1 / sqrt(1 - critical_hz / band_hz)
    power = RHO * C * sigma / mass * exposure(band_hz) / (8 * sqrt(stiffness * mass))
    plate, room = 2 * pi * band_hz * ETA, 6 * np.log(10) / t60_s
    t = np.linspace(0, 1, 20001)
    energy = power * (np.exp(-plate * t) - np.exp(-room * t)) / (room - plate)
    kept = np.exp(-t[1] / FAST_S)
    heard = lfilter([1 - kept], [1, -kept], RHO * C**2 / VOLUME * energy)
    return float(10 * np.log10(heard.max() / 4e-10))


@pytest.fixture(scope="module")
def rooms(tmp_path_factory: pytest.TempPathFactory) -> dict[float, dict[float, tuple[float, float]]]:
    """Of slabs of 180 and 200 mm: levels and reverberation times by third octave."""
    folder = tmp_path_factory.mktemp("bedroom")
    text = (MODELS / "bedroom.study.yaml").read_text(encoding="utf-8")
    text = text.replace("sampling: 20 kHz", "sampling: 8 kHz").replace("duration: 1.5 s", "duration: 1 s")
    text = text[: text.index("  floating screed:\n")] + "compare: {baseline: as is}\n"
    (folder / "bedroom.study.yaml").write_text(text, encoding="utf-8")
    (folder / "bedroom.yaml").write_text((MODELS / "bedroom.yaml").read_text(encoding="utf-8"), encoding="utf-8")
    result = run_study(read_study(folder / "bedroom.study.yaml"))
    found = {}
    for thickness, name in ((0.18, "as is"), (0.20, "200 mm")):
        rated = result.cases[name].rated["bedroom"]
        levels = 10 * np.log10(np.mean(10 ** (rated.measured_db / 10), axis=(0, 1)))
        found[thickness] = {
            band: (level, rated.t60_s[band]) for band, level in zip(rated.bands_hz, levels.tolist(), strict=True)
        }
    return found


@pytest.mark.parametrize("thickness", [0.18, 0.20])
def test_a_bare_slab_is_as_loud_as_statistical_energies_say(
    rooms: dict[float, dict[float, tuple[float, float]]], thickness: float
) -> None:
    """Cremer, Heckl, Petersson, Structure-Borne Sound, 3rd ed., sections 5.7 (infinite plate) and 6.5 (radiation)."""
    off = {band: rooms[thickness][band][0] - loudest_fast(thickness, band, rooms[thickness][band][1]) for band in DENSE}
    # four places on four modes scatter by some 3 dB in a band, by 1.5 over four bands
    assert max(map(abs, off.values())) < 4.0, off
    assert abs(np.mean(list(off.values()))) < 1.5, off
