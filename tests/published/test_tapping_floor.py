"""A tapping machine on a bare slab, from the hammers' contact to the rating, against EN 12354-2."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from acoustics import energy_average, normalised_impact_level, weighted_impact_level
from femstruct.language import read_study
from femstruct.workflow.run import run_study

MODEL = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts: {slab: {type: plate, material: concrete, thickness: 180 mm, origin: [0, 0, 2.5], size: [5, 4], mesh: 100 mm}}
supports: {walls: {on: slab, edge: all, fix: simple}}
points: {feet: {on: slab, at: [[2, 1.5], [2.07, 1.57], [2.14, 1.64], [2.21, 1.71], [2.28, 1.78]]}}
surfaces: {ceiling: {on: slab, side: below}}
damping: {loss_factor: 5 %}
"""
STUDY = """model: model.yaml
modes: {up_to: 3600 Hz}
bodies:
  hammer:
    source: tapping machine
    above: feet
    contact: {type: hertz, radius: 0.5 m, E: [210 GPa, 30 GPa], nu: [0.3, 0.2]}
    blows: {count: 2}
time: {duration: 1 s, sampling: 16 kHz}
rooms:
  below:
    size: [5, 4, 2.5]
    under: ceiling
    losses: {t60: 0.5 s}
    receivers: {mic: [[1, 0.8, 1.2], [3.9, 1, 1.2]]}
    levels: [ISO 16283-2, ISO 717-2]
"""


@pytest.mark.stress  # two to three minutes of CPU time, nearly all for the room up to 3.5 kHz
def test_a_bare_slab_is_as_loud_as_its_mass_says(tmp_path: Path) -> None:
    """L_n,w = 164 - 35 lg(m' / 1 kg/m^2), EN 12354-2 annex B, for homogeneous floors of 100 to 600 kg/m^2, as quoted in
    https://github.com/jmrplens/phonometry (tests/reference_data.py)."""
    (tmp_path / "model.yaml").write_text(MODEL, encoding="utf-8")
    (tmp_path / "one.study.yaml").write_text(STUDY, encoding="utf-8")
    case = run_study(read_study(tmp_path / "one.study.yaml")).cases["as given"]
    rated = case.rated["below"]
    plain = energy_average(rated.measured_db.reshape(-1, len(rated.bands_hz)))
    in_bands = dict(zip(rated.bands_hz, plain.tolist(), strict=True))
    normalised = weighted_impact_level(normalised_impact_level(in_bands, 50.0, rated.t60_s))
    wanted = 164 - 35 * np.log10(0.18 * 2400)
    # one place, two microphones, one damping for all frequencies, a plate without shear: 71.8 wanted, 73 found
    assert normalised.weighted_db == pytest.approx(wanted, abs=3.0)
    # bare concrete: all bands alike, so that the highest decides and C_I is near the -11 dB of ISO 717-2's bare floor
    assert normalised.deciding_hz >= 2000.0
    assert normalised.adaptation_db == pytest.approx(-11.0, abs=3.0)
