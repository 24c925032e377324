"""Floor modes that meet room modes, floating floors, rooms beyond the standard: against closed forms."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from acoustics.fields.shaped import ShapedRoom
from acoustics.meshed.cavity_mesh import box_mesh
from femstruct.language.cases import read_study
from femstruct.modal.damping import with_damping
from femstruct.sound.coupling import with_cavity
from femstruct.sound.placed import placed
from femstruct.sound.surfaces import pressure_per_force
from femstruct.study.placed_rooms import placed_room
from femstruct.workflow.bases import solve_all
from femstruct.workflow.rated_rooms import coincidence_findings, floating_floors, modal_coincidences, mode_pairs

MODEL = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}, screed: {E: 25 GPa, nu: 0.2, rho: 2000}}
parts:
  slab: {type: plate, material: concrete, thickness: THICKNESS, origin: [0, 0, 2.5], size: [5, 4], mesh: [10, 8]}
  top: {type: plate, material: screed, thickness: 60 mm, origin: [0, 0, 2.65], size: [5, 4], mesh: [10, 8]}
  wool: {type: foundation, between: [top, slab], region: REGION, stiffness: {normal: 10 MN/m^3}, loss_factor: 20 %}
supports: {edges: {on: slab, edge: all, fix: simple}, low: {on: top, edge: all, fix: simple}}
points: {drop: {on: top, at: [1.85, 1.45]}}
surfaces: {ceiling: {on: slab, side: below}}
damping: {loss_factor: 5 %}
"""
STUDY = """model: model.yaml
modes: {up_to: 250 Hz}
bodies: {ball: {source: rubber ball, above: drop}}
time: {duration: 0.2 s, sampling: 4 kHz}
rooms:
  bedroom:
    size: [5, 4, 2.5]
    under: ceiling
    losses: {t60: 0.5 s}
    receivers: {mic: [1, 1, 1]}
    levels: [ISO 16283-2, ISO 717-2]
"""


def plan(folder: Path, thickness: str = "180 mm", region: str = "whole", study: str = STUDY, model: str = MODEL):
    text = model.replace("THICKNESS", thickness).replace("REGION", region)
    (folder / "model.yaml").write_text(text, encoding="utf-8")
    (folder / "one.study.yaml").write_text(study, encoding="utf-8")
    return read_study(folder / "one.study.yaml")


BARE = (
    "\n".join(line for line in MODEL.splitlines() if not line.startswith(("  top:", "  wool:")))
    .replace(", low: {on: top, edge: all, fix: simple}", "")
    .replace("on: top", "on: slab")
)


def solved(folder: Path, thickness: str):
    case = plan(folder, thickness, model=BARE).cases[0]
    own = solve_all([case])[case.name]
    room = case.study.rooms[0]
    return case.study, room, own.places.surfaces[room.under], with_damping(own.basis, case.study.damping)


def pairs_of(plan, surface, basis):
    return mode_pairs(placed_room(plan, {plan.under: surface}), basis)


def findings_of(plan, study, surface, basis):
    return coincidence_findings(plan, study, placed_room(plan, {plan.under: surface}), basis)


def first_mode(thickness: float) -> float:
    stiffness = 30e9 * thickness**3 / 12 / (1 - 0.2**2)
    return np.pi / 2 * np.sqrt(stiffness / (2400 * thickness)) * (1 / 25 + 1 / 16)


def test_a_floor_tuned_to_the_height_of_the_room_meets_it(tmp_path: Path) -> None:
    """sin sin on a 5 x 4 ceiling against the uniform one of mode (0, 0, 1): (2/pi)^2 over 1/2, .811."""
    height = 343 / 2 / 2.5
    thickness = 0.18 * height / first_mode(0.18)  # a plate's frequency goes as its thickness
    study, room, surface, basis = solved(tmp_path, f"{thickness:.6f} m")
    found = modal_coincidences(pairs_of(room, surface, basis))
    pairs = {(round(floor, 1), round(air, 1)): likeness for floor, air, likeness in found}
    together = {air: likeness for (floor, air), likeness in pairs.items() if abs(floor - height) < 0.5}
    assert together[round(height, 1)] == pytest.approx(8 / np.pi**2, abs=5e-3)  # the mesh's sums over the ceiling
    assert together[68.6] == max(together.values())
    told = {one.code: one for one in findings_of(room, study, surface, basis)}
    assert told["floor-room-resonance"].values["floor_hz"] == pytest.approx(found[0][0])
    assert "68.6 Hz of the room" in told["floor-room-resonance"].message


def test_a_box_given_as_a_mesh_meets_the_same(tmp_path: Path) -> None:
    """A room of any shape is told of as the box it is, as far as its cells resolve the modes."""
    _, room, surface, basis = solved(tmp_path, "180 mm")
    mesh = ShapedRoom(box_mesh([5, 4, 2.5], [10, 8, 5]), "z1", room.room.air, room.room.losses, up_to_hz=130.0)
    one, other = (
        modal_coincidences(pairs_of(room, surface, basis)),
        modal_coincidences(pairs_of(replace(room, room=mesh), surface, basis)),
    )
    resolved = [pair for pair in one if pair[1] < 130.0]
    assert resolved and len(other) == len(resolved)
    assert np.array(other) == pytest.approx(np.array(resolved), rel=1e-3)  # five quadratic cells to a wave


def test_modes_further_apart_than_their_bandwidths_do_not_meet(tmp_path: Path) -> None:
    """The first mode at 30.2 Hz: its 5 % and the room's 2.2 / T60 = 4.4 Hz reach nowhere near 34.3 Hz, (1, 0, 0)."""
    _, room, surface, basis = solved(tmp_path, "180 mm")
    assert basis.frequency_hz[0] == pytest.approx(first_mode(0.18), rel=1e-3)  # the mesh: 7e-6 here
    found = modal_coincidences(pairs_of(room, surface, basis))
    assert found
    assert min(floor for floor, _, _ in found) > 40.0
    for floor, air, likeness in found:
        assert abs(floor - air) <= 0.5 * (0.05 * floor + 2.2 / 0.5 * 1.01)
        assert 0.3 <= likeness <= 1.0


def test_a_meshed_box_meets_as_the_box_does(tmp_path: Path) -> None:
    _, room, surface, basis = solved(tmp_path, "180 mm")
    mesh = box_mesh(room.room.size, [12, 10, 6])
    shaped = replace(room, room=ShapedRoom(mesh, "z1", room.room.air, room.room.losses, up_to_hz=200.0))
    assert shaped.room.middle.tolist() == pytest.approx([2.5, 2.0, 2.5])
    box, meshed = (
        modal_coincidences(pairs_of(room, surface, basis)),
        modal_coincidences(pairs_of(shaped, surface, basis)),
    )
    assert len(box) == len(meshed) > 2
    # quadratic cells of 0.42 m, four to a wave at 200 Hz: .5 % of the frequency
    assert [air for _, air, _ in meshed] == pytest.approx([air for _, air, _ in box], rel=5e-3)
    # of shapes at cells' points: 0.003 here
    assert [alike for _, _, alike in meshed] == pytest.approx([alike for _, _, alike in box], abs=0.02)


def test_a_floating_floor_is_two_masses_on_a_spring(tmp_path: Path) -> None:
    structure = plan(tmp_path).cases[0].study.structure
    (found,) = floating_floors(structure, (630.0,))
    wanted = np.sqrt(10e6 * (1 / 120 + 1 / 432)) / 2 / np.pi
    assert found.values["resonance_hz"] == pytest.approx(wanted, rel=1e-13)  # steps and rounding: none here
    assert f"is {wanted:.1f} Hz" in found.message
    # the slab under a force on the screed, by the dynamic stiffness of both, beside the slab alone under the force
    spin = (2 * np.pi * found.values["lowers_from_hz"]) ** 2
    both = np.array([[10e6 - spin * 432, -10e6], [-10e6, 10e6 - spin * 120]])
    moved = np.linalg.solve(both, [0.0, 1.0])[0]
    assert abs(moved) == pytest.approx(1.0 / (432 * spin), rel=1e-12)  # rounding of a 2 by 2 system
    assert floating_floors(structure, (50.0,)) == []
    part = plan(tmp_path, region="{rectangle: [2 m, 2 m]}").cases[0].study.structure
    assert floating_floors(part, (630.0,)) == []  # not two plates over all of their area


def test_small_and_large_rooms_are_not_the_standards(tmp_path: Path) -> None:
    study, room, surface, basis = solved(tmp_path, "180 mm")
    assert "rating-room-volume" not in {one.code for one in findings_of(room, study, surface, basis)}
    high = plan(tmp_path, model=BARE, study=STUDY.replace("[5, 4, 2.5]", "[5, 4, 13]")).cases[0].study.rooms[0]
    told = {one.code: one for one in findings_of(high, study, surface, basis)}
    assert told["rating-room-volume"].values["volume_m3"] == pytest.approx(260.0)
    assert "rooms of 10 to 250 m^3; this one has 260 m^3" in told["rating-room-volume"].message


LAB = """
materials: {concrete: {E: 30 GPa, nu: 0.2, rho: 2400}}
parts: {slab: {type: plate, material: concrete, thickness: 140 mm, origin: [0, 0, 2.6], size: [4, 3], mesh: [16, 12]}}
supports: {edges: {on: slab, edge: all, fix: simple}}
points: {drop: {on: slab, at: [0.75, 0.75]}}
surfaces: {ceiling: {on: slab, side: below}}
damping: {loss_factor: ETA}
"""
LAB_STUDY = """model: model.yaml
modes: {up_to: 450 Hz}
bodies: {ball: {mass: 1 kg, above: drop, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
time: {duration: 0.1 s, sampling: 4 kHz}
rooms: {lab: {size: [5, 4, 2.6], under: ceiling, losses: {t60: T60}, receivers: {mic: [0.01, 0.01, 0.01]}}}
"""


def lab(folder: Path, t60: str = "1.2 s", eta: str = "2 %"):
    text = LAB_STUDY.replace("T60", t60)
    case = plan(folder, model=LAB.replace("ETA", eta), study=text).cases[0]
    own = solve_all([case])[case.name]
    room = case.study.rooms[0]
    return case.study, room, own.places.surfaces[room.under], with_damping(own.basis, case.study.damping), own.places


@pytest.mark.parametrize(
    ("t60", "eta", "wanted"),
    # by hand, of sines and cosines; the first also in a study of its own: g 12.2, d_p 29.0, d_r 11.5 1/s
    [("1.2 s", "2 %", 0.411), ("2 s", "1 %", 1.14), ("1.2 s", "5 %", 0.18)],
)
def test_what_two_modes_exchange_is_that_of_sines_and_cosines(
    tmp_path: Path, t60: str, eta: str, wanted: float
) -> None:
    """Slab mode (3, 2) at 230.7 Hz and room mode (4, 3, 2) at 229.7 Hz."""
    study, room, surface, basis, _ = lab(tmp_path, t60, eta)
    pairs = pairs_of(room, surface, basis)
    i, j = np.abs(pairs.floor_hz - 230.7).argmin(), np.abs(pairs.room_hz - 229.7).argmin()
    # Hz, one decimal and the mesh
    assert (pairs.floor_hz[i], pairs.room_hz[j]) == pytest.approx((230.7, 229.7), abs=0.3)
    # half a unit of 1.14, and the mesh: 0.005 here
    assert pairs.kappa[i, j] == pytest.approx(wanted, abs=0.005 + 0.02 * wanted)
    found = {one.code: one for one in findings_of(room, study, surface, basis)}["one-way-resonance"]
    assert found.values["line_db"] == pytest.approx(20 * np.log10(1 + pairs.kappa.max()))
    assert "coupling: two-way" in found.message and not found.severe
    both = replace(room, coupling="two-way")
    assert "one-way-resonance" not in {one.code for one in findings_of(both, study, surface, basis)}


def test_the_air_takes_back_what_kappa_says(tmp_path: Path) -> None:
    """At the line where the two modes meet, 20 lg(1 + kappa) = 3.0 dB; 2.8 dB in an independent closed form."""
    _, room, surface, basis, places = lab(tmp_path)
    f = np.arange(224.0, 237.0, 0.1)
    drive = places.point("drop", "test").probe("z")
    levels = []
    for one in (basis, with_cavity(basis, placed(room.room, surface))):
        p, _ = pressure_per_force(one, drive, placed(room.room, surface), room.receivers, f)
        levels.append(20 * np.log10(np.abs(p[0]).max()))
    assert levels[0] - levels[1] == pytest.approx(2.9, abs=0.4)  # between both numbers, and steps of 0.1 Hz


def test_modes_that_do_not_move_the_ceiling_meet_nothing(tmp_path: Path) -> None:
    """A second slab beside the first, on its own supports: none of its modes reaches the ceiling of the room."""
    beside = BARE.replace(
        "  slab:",
        "  other: {type: plate, material: concrete, thickness: 180 mm, origin: [9, 0, 2.5], size: [5, 4.3], "
        "mesh: [10, 8]}\n  slab:",
    ).replace("supports: {", "supports: {far: {on: other, edge: all, fix: simple}, ")
    case = plan(tmp_path, model=beside).cases[0]
    own = solve_all([case])[case.name]
    room = case.study.rooms[0]
    basis = with_damping(own.basis, case.study.damping)
    # rounding of the eigen solver gives the other slab's modes a likeness, but no motion
    pairs = pairs_of(room, own.places.surfaces[room.under], basis)
    still = pairs.motion < 1e-6
    assert 3 <= still.sum() < len(still)
    met = sorted({floor for floor, _, _ in modal_coincidences(pairs)})
    assert met and not set(met) & set(pairs.floor_hz[still].tolist())
    _, alone, surface, bare = solved(tmp_path, "180 mm")
    assert met == pytest.approx(sorted({floor for floor, _, _ in modal_coincidences(pairs_of(alone, surface, bare))}))


def test_modes_beyond_where_all_are_known_and_modes_that_do_not_ring_are_in_no_pair(tmp_path: Path) -> None:
    """Air in a void adds modes above the last one that is known; wool makes the diagonal of the damping huge."""
    _, room, surface, basis = solved(tmp_path, "180 mm")
    every = pairs_of(room, surface, basis).floor_hz
    some = pairs_of(room, surface, replace(basis, complete_below_hz=float(every[2]) + 0.1)).floor_hz
    assert some.tolist() == every[:3].tolist()
    drowned = replace(basis, viscous=basis.viscous + np.diag(4.0 * basis.omega))
    assert not len(pairs_of(room, surface, drowned).floor_hz)
