"""The script of the forging hammer runs, draws, and keeps its numbers (Numbers changed? Then the CHANGELOG says so)."""

import runpy
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "scripts" / "08_forging_hammer.py"

# Computed with femstruct 0.1.0: force on the ground [kN], travel of the block [mm], time to rest [s], limits exceeded.
KEPT = {
    "as built": (319.9, 6.357, 0.6274, 0),
    "softer springs": (225.7, 8.192, 0.5306, 1),
    "stiffer springs": (646.0, 3.543, 0.5736, 1),
    "more damping": (404.6, 5.271, 0.3741, 0),
    "eccentric blow": (316.2, 7.546, 0.6115, 0),
    "impact damper": (295.5, 5.907, 0.6361, 0),
}


def test_hammer_keeps_its_numbers(tmp_path: Path) -> None:
    found = runpy.run_path(str(SCRIPT))["main"](str(tmp_path / "hammer.png"))
    assert (tmp_path / "hammer.png").stat().st_size > 20_000
    for case, (force, travel, rest, exceeded) in KEPT.items():
        assert found[f"ground force {case} kN"] == pytest.approx(force, abs=0.051)  # half of the last digit
        assert found[f"block travel {case} mm"] == pytest.approx(travel, abs=0.00051)  # half of the last digit
        assert found[f"rest {case} s"] == pytest.approx(rest, abs=0.0002)  # a sample
        assert found[f"limits exceeded {case}"] == exceeded
        assert found[f"ledger {case}"] < 1e-12  # rounding: the laws are linear
