"""Reverberation times of rooms whose walls absorb: what the standards take out of levels is what would be measured.

Nothing here is taken from the program's modes: waves in a tube, Sabine's formula, and decays of pulses in time.
"""

from __future__ import annotations

from math import log
from pathlib import Path

import numpy as np
import pytest

from acoustics.air import Air
from acoustics.fields.shaped import ShapedRoom
from acoustics.levels.bands import band_passes, third_octave_bands
from acoustics.levels.rated import rate_room
from acoustics.losses import Losses, losses_from_t60
from acoustics.meshed.cavity_mesh import box_mesh
from acoustics.meshed.finite_elements import cut_box
from acoustics.meshed.walls import Wall, YieldingWall, absorbing
from acoustics.receivers import Receiver
from acoustics.source import SurfaceVelocity
from femstruct.language.cases import read_study
from femstruct.workflow.run import run_study

AIR, SIZE = Air(), (4.0, 3.0, 2.5)
LINED = ("x0", "x1", "y0", "y1", "floor")


def lined(alpha: float, losses: Losses) -> ShapedRoom:
    return ShapedRoom(
        cut_box(np.array(SIZE), 130.0, AIR), "ceiling", AIR, losses, dict.fromkeys(LINED, absorbing(alpha)), 130.0
    )


@pytest.mark.parametrize("beta", [0.01, 0.2])
@pytest.mark.parametrize("air_t60", [0.0, 1.5])
def test_a_tube_with_one_end_that_absorbs(beta: float, air_t60: float) -> None:
    """A wave comes back (1 - beta) / (1 + beta) as large from each way to the end, 2 L long, whatever its frequency."""
    tube = box_mesh([4.0, 0.1, 0.1], [40, 1, 1])
    losses = losses_from_t60(air_t60) if air_t60 else Losses()
    room = ShapedRoom(tube, "z1", AIR, losses, {"x1": Wall({100.0: beta})}, 300.0)
    rate = AIR.c / 8.0 * log((1 + beta) / (1 - beta)) + (3 * log(10) / air_t60 if air_t60 else 0.0)
    for band in (63.0, 125.0, 200.0):
        assert room.t60(band) == pytest.approx(3 * log(10) / rate, rel=0.02)  # modes that the tube has beyond 300 Hz


@pytest.mark.parametrize("air_t60", [0.0, 1.5])
def test_damping_ratios_in_tables_are_those_of_the_room_with_its_walls(air_t60: float) -> None:
    losses = losses_from_t60(air_t60) if air_t60 else Losses()
    room = ShapedRoom(box_mesh([4.0, 0.1, 0.1], [40, 1, 1]), "z1", AIR, losses, {"x1": Wall({100.0: 0.01})}, 300.0)
    rate = AIR.c / 8.0 * log(1.01 / 0.99) + (3 * log(10) / air_t60 if air_t60 else 0.0)
    ratios = room.described()["damping_ratio"]
    assert isinstance(ratios, dict)
    for f in room.frequency_hz[1:4]:
        assert ratios[f"{f:g}"] == pytest.approx(rate / (2 * np.pi * f), rel=1e-3)  # the cube of 0.01 in the logarithm


def test_a_little_absorption_everywhere_is_sabines() -> None:
    room = lined(0.05, Losses())
    absorption = 0.05 * (2 * 4 * 2.5 + 2 * 3 * 2.5 + 4 * 3)
    sabine = 24 * log(10) * 30.0 / (AIR.c * absorption)
    # 5 modes in the band: those along one side alone graze fewer walls, and last longer
    assert room.t60(100.0) == pytest.approx(sabine, rel=0.2)


def test_walls_that_absorb_nothing_leave_the_losses() -> None:
    for walls in ({"x1": Wall({100.0: 0.0})}, {"x1": YieldingWall(stiffness=1e9)}):
        room = ShapedRoom(box_mesh(SIZE, (5, 4, 4)), "z1", AIR, losses_from_t60(0.7), walls, 100.0)
        assert room.t60(63.0) == pytest.approx(0.7, rel=1e-3)  # stiff, not rigid
    assert ShapedRoom(box_mesh(SIZE, (5, 4, 4)), "z1", AIR, Losses(), {"x1": YieldingWall(20.0)}).t60(63.0) == np.inf


def test_a_yielding_wall_with_a_resistance_alone_matters_is_an_absorbing_one() -> None:
    mesh, r = box_mesh(SIZE, (7, 5, 5)), 50 * AIR.rho * AIR.c
    found = [
        ShapedRoom(mesh, "z1", AIR, losses_from_t60(1.0), {"x1": wall}, 120.0).t60(80.0)
        for wall in (Wall({100.0: 0.02}), YieldingWall(mass=1e-3, resistance=r))
    ]
    assert found[0] < 0.9
    assert found[0] == pytest.approx(found[1], rel=0.01)  # a mass of 1 g/m^2 is left of it


def test_what_is_taken_out_of_levels_is_what_pulses_show() -> None:
    """Pulses at places of the ceiling, heard at random places: filtered, squared, summed, integrated backwards."""
    room = lined(0.1, losses_from_t60(3.0))
    dt = 1 / 1200.0
    t = np.arange(2400) * dt
    pulse = np.exp(-(((t - 0.02) / 0.002) ** 2)) * (t - 0.02) / 0.002
    rng = np.random.default_rng(1)
    microphones = [Receiver(str(i), place) for i, place in enumerate(rng.uniform([0, 0, 0], SIZE, (16, 3)))]
    left = {80.0: np.zeros(len(t)), 100.0: np.zeros(len(t))}
    passes = band_passes(len(t), 1 / dt, 3, thinned=False)
    places = rng.uniform([0, 0, 2.5], SIZE, (10, 3))
    blows = [np.outer(one, pulse) for one in np.eye(10)]
    pushes = [[SurfaceVelocity(places, np.full(10, 0.01), np.eye(10), blow, dt)] for blow in blows]
    for heard_at in room.pressures(pushes, microphones):
        for p in heard_at.p:
            for band, decay in left.items():
                heard = passes[band].of(np.fft.rfft(p, passes[band].length), 0.0).values[: len(t)]
                decay += np.cumsum(heard[::-1] ** 2)[::-1]
    rated = rate_room([[dict.fromkeys(third_octave_bands(1e4), 60.0)]], room)
    for band, decay in left.items():
        level = 10 * np.log10(decay / decay[0])
        part = (level <= -5) & (level >= -25)
        measured = -60 / np.polyfit(dt * np.flatnonzero(part), level[part], 1)[0]
        # ten places of the ceiling and the ringing of the filter: 0.4 dB; the losses alone are 5 dB off
        assert rated.t60_s[band] == pytest.approx(measured, rel=0.1)


MODEL = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts: {slab: {type: plate, material: concrete, thickness: 0.14 m, origin: [0, 0, 2.5], size: [4, 3], mesh: [8, 6]}}
supports: {edges: {on: slab, edge: all, fix: simple}}
points: {drop: {on: slab, at: [1, 1]}}
surfaces: {ceiling: {on: slab, side: below}}
damping: {loss_factor: 4 %}
"""
STUDY = """model: model.yaml
modes: {up_to: 120 Hz}
bodies: {ball: {source: rubber ball, above: drop}}
time: {duration: 0.5 s, sampling: 2 kHz}
rooms:
  lab:
    size: [4, 3, 2.5]
    under: ceiling
    walls: {x0: {absorption: ALPHA}, floor: {absorption: ALPHA}}
    modes: {up_to: 110 Hz}
    receivers: {mic: [1, 1, 1.2]}
    levels: [ISO 16283-2, ISO 717-2]
"""


def test_walls_that_absorb_need_no_losses_beside_them(tmp_path: Path) -> None:
    (tmp_path / "model.yaml").write_text(MODEL, encoding="utf-8")
    (tmp_path / "one.study.yaml").write_text(STUDY.replace("ALPHA", "30 %"), encoding="utf-8")
    room = run_study(read_study(tmp_path / "one.study.yaml")).cases["as given"].rated["lab"]
    sabine = 24 * log(10) * 30.0 / (AIR.c * 0.3 * (3 * 2.5 + 4 * 3))
    assert room.t60_s[80.0] == pytest.approx(sabine, rel=0.4)  # single modes: those between the bare walls last longer
    rigid = STUDY.replace("ALPHA", "0 %")
    (tmp_path / "one.study.yaml").write_text(rigid, encoding="utf-8")
    with pytest.raises(Exception, match="in a room without losses"):
        read_study(tmp_path / "one.study.yaml")
