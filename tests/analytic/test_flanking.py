"""A slab and a heavy wall joined to it around a room: energies close, surfaces share them out, and what the air pushes
back is what it pushes the surfaces with."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lsim

from acoustics.air import Air
from acoustics.fields.rectangular import Room
from acoustics.fields.shaped import ShapedRoom
from acoustics.fields.sound_field import SoundField
from acoustics.losses import losses_from_t60
from acoustics.meshed.finite_elements import cut_box
from acoustics.receivers import Receiver
from acoustics.source import SurfaceVelocity, SurfaceVibration
from femstruct.assembly.matrices import assemble
from femstruct.errors import InputError, InputErrors
from femstruct.files.results_file import read_results, write_results
from femstruct.files.study_tables import summary
from femstruct.language.cases import read_study
from femstruct.language.models import read_model
from femstruct.modal.damping import Damping, Ratio, with_damping
from femstruct.modal.frf import modal_amplitudes
from femstruct.modal.reduction import modal_basis
from femstruct.sound.coupling import with_cavity
from femstruct.sound.flanking import SurfaceShares, surface_shares
from femstruct.sound.placed import placed
from femstruct.sound.surfaces import pressure_per_force
from femstruct.view.answer_tables import bands_by_surface, shares_by_surface
from femstruct.workflow.run import run_study

AIR, LOSSES = Air(343.0, 1.21), losses_from_t60(0.5)
MODEL = """
title: A slab on a wall
materials:
  concrete: {E: 30 GPa, nu: 0.2, rho: 2400}
  brick: {E: 8 GPa, nu: 0.2, rho: 1600}
parts:
  slab: {type: plate, material: concrete, thickness: 120 mm, origin: [0, 0, 2.5], size: [4, 3], mesh: 500 mm}
  wall: {type: plate, material: brick, thickness: 115 mm, origin: [0, 0, 0], size: [3, 2.5], mesh: 500 mm,
    normal: [1, 0, 0], x_direction: [0, 1, 0]}
joints: {top: {connect: [wall, slab]}}
points: {drop: {on: slab, at: [1.3, 1.1]}}
supports:
  feet: {on: wall, edge: y0, fix: simple}
  side: {on: wall, edge: x0, fix: roller}
  far: {on: slab, edge: x1, fix: simple}
  front: {on: slab, edge: y0, fix: simple}
  back: {on: slab, edge: y1, fix: simple}
surfaces:
  under: {on: slab, side: below}
  floor: {on: slab, side: above}
  face: {on: wall, side: x}
  outside: {on: wall, side: -x}
  half: {on: wall, side: x, region: {rectangle: [1.5 m, 2.5 m], at: [0.75 m, 1.25 m]}}
"""


@pytest.fixture(scope="module")
def corner(tmp_path_factory):
    path = tmp_path_factory.mktemp("corner") / "corner.yaml"
    path.write_text(MODEL, encoding="utf-8")
    model = read_model(path)
    basis = with_damping(modal_basis(assemble(model), up_to=160.0), Damping(Ratio(0.02)))
    return basis, model.surfaces, model.points["drop"].probe("z")


@pytest.mark.parametrize("meshed", [False, True], ids=["box", "mesh"])
def test_powers_of_the_surfaces_are_what_the_room_takes_up_and_close_with_the_structure(meshed: bool, corner) -> None:
    """A force on a slab, whose air pushes back on slab and wall: what it puts in is what the structure loses and what
    the surfaces give the air; and that is what the air loses."""
    basis, surfaces, drive = corner
    size = np.array([4.0, 3.0, 2.5])
    room: SoundField = Room(size, AIR, LOSSES)
    if meshed:
        room = ShapedRoom(cut_box(size, 80.0, AIR), "ceiling", AIR, LOSSES, up_to_hz=80.0)
    around = placed(room, surfaces["under"], walls={"x0": surfaces["face"]})
    hz = np.array([15.0, 31.0] if meshed else [15.0, 31.0, 42.9, 63.0, 90.0])
    coupled = with_cavity(basis, around, up_to_hz=80.0 if meshed else 3 * 90.0)
    velocity = 2j * np.pi * hz * modal_amplitudes(coupled, drive, hz)
    put_in = 0.5 * (drive.of(coupled.shapes) @ velocity).real
    shapes = around.shapes(coupled)
    powers = room.powers([SurfaceVibration(one.points, one.weights, one.shapes, velocity, hz) for one in shapes])
    assert (np.abs(powers) > 0.01 * powers.sum(axis=0)).all()  # both take part
    before, after = (one.shapes.reshape(-1, len(one.omega)) for one in (basis, coupled))
    own = np.linalg.lstsq(before, after)[0] @ velocity  # of the modes in vacuo, what they move in those with the air
    lost = 0.5 * np.einsum("kf,kl,lf->f", own.conj(), basis.viscous, own).real
    taken = 0.5 * np.einsum("kf,kl,lf->f", velocity.conj(), coupled.viscous, velocity).real - lost
    # of a mesh, the modes above 80 Hz answer as at rest in one and at their own frequencies in the other
    allowed = 3e-2 if meshed else 1e-6
    assert lost.max() < 0.999 * put_in.max()
    assert powers.sum(axis=0) == pytest.approx(put_in - lost, rel=allowed)
    assert powers.sum(axis=0) == pytest.approx(taken, rel=allowed)


STUDY = """
model: corner.yaml
modes: {up_to: 160 Hz}
bodies: {ball: {mass: 2 kg, above: drop, speed: 3 m/s, contact: {type: linear, stiffness: 400 kN/m}}}
time: {duration: 1.5 s, sampling: 4 kHz}
rooms:
  living:
    size: [4, 3, 2.5]
    surfaces: {ceiling: under, x0: face}
    coupling: two-way
    losses: {t60: 0.5 s}
    receivers: {mic: [[1.0, 0.8, 1.2], [3.1, 1.0, 1.0]]}
  above:
    size: [4, 3, 2.8]
    surfaces: {floor: floor}
    losses: {t60: 0.5 s}
    receivers: {bed: [1.0, 0.8, 1.2]}
  beside:
    size: [2.5, 3, 2.5]
    surfaces: {x1: outside}
    losses: {t60: 0.5 s}
    receivers: {sofa: [1.0, 0.8, 1.2]}
"""


def written(folder: Path, study: str = STUDY, model: str = MODEL) -> Path:
    (folder / "corner.yaml").write_text(model, encoding="utf-8")
    (folder / "corner.study.yaml").write_text(study, encoding="utf-8")
    return folder / "corner.study.yaml"


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    return run_study(read_study(written(tmp_path_factory.mktemp("ran"))))


def test_a_study_says_who_makes_which_band(ran) -> None:
    """The surfaces' energies are what the air takes up, and that is what the whole loses beside the structure's own."""
    case = ran.cases["as given"]
    shares = case.by_surface["living"]
    assert [*case.by_surface] == ["living"] and isinstance(shares, SurfaceShares)  # the others have one surface
    assert shares.surfaces == ("under", "face") and shares.walls == ("ceiling", "x0")
    assert shares.share.sum(axis=0) == pytest.approx(np.ones(len(shares.bands_hz)))
    assert (shares.total_j > 0).all() and shares.bands_hz[-1] == 125.0  # complete below 160 Hz, less the air's mass
    ledger = case.response.ledger
    # the structure has no losses of its own and stands still at the end of the record, which is a jump
    taken = ledger.end.dissipated + case.shares.held_at_end["air of living"]
    assert shares.total_j.sum() == pytest.approx(taken, rel=2e-2)  # that jump
    # exposure levels of the room are those of both together, on average over the receivers
    heard = [case.levels[f"living.mic.{number}"].exposure_db for number in (1, 2)]
    for band in (31.5, 40.0):  # 63 Hz is 9 dB below 50 Hz, of which its filter hears
        mean = 10 * np.log10(np.mean([10 ** (one[band] / 10) for one in heard]))
        assert shares.together_db[shares.bands_hz.tolist().index(band)] == pytest.approx(
            mean, abs=0.5
        )  # slopes of filters


def test_a_room_that_rings_longer_than_the_record_takes_up_what_its_surfaces_do_in_time() -> None:
    """The work of each on the air, pressure times velocity over surface and record, marched by modes of the room:
    p_n'' + 2 gamma p_n' + w_n^2 p_n = (rho c^2 / V) (d/dt + 2 gamma) int psi_n v dS."""
    size, t60, rate, duration = np.array([4.0, 3.0, 2.5]), 2.0, 2000.0, 0.3
    t, gamma, volume = np.arange(int(duration * rate)) / rate, 3 * np.log(10) / t60, 30.0
    burst = np.exp(-(((t - 0.2) / 0.03) ** 2))
    x, y = (one.ravel() for one in np.meshgrid((np.arange(12) + 0.5) / 3, (np.arange(9) + 0.5) / 3))
    low, z = (one.ravel() for one in np.meshgrid((np.arange(9) + 0.5) / 3, (np.arange(8) + 0.5) / 3.2))
    slab = SurfaceVelocity(
        np.stack([x, y, 0 * x + 2.5], axis=1),
        np.full(len(x), 12.0 / len(x)),
        (np.sin(np.pi * x / 4) * np.sin(np.pi * y / 3))[:, None],
        [np.sin(2 * np.pi * 57 * t) * burst],
        1 / rate,
    )
    wall = SurfaceVelocity(
        np.stack([0 * low, low, z], axis=1),
        np.full(len(low), 7.5 / len(low)),
        (np.sin(np.pi * low / 3) * np.sin(np.pi * z / 2.5))[:, None],
        [0.5 * np.sin(2 * np.pi * 70 * t) * burst],
        1 / rate,
    )
    room = Room(size, AIR, losses_from_t60(t60))
    around = SimpleNamespace(room=room, surfaces=[SimpleNamespace(name=n) for n in "ab"], walls=["ceiling", "x0"])
    found = surface_shares([slab, wall], around, [], 320.0)  # type: ignore[arg-type]
    assert found is not None
    work = np.zeros(2)
    for order in np.ndindex(10, 8, 7):
        mean = np.prod(np.where(order, 0.5, 1.0))
        drive = []
        for one in (slab, wall):
            shape = np.cos(np.pi * np.array(order) * one.points / size).prod(axis=1) / np.sqrt(mean)
            drive.append((one.weights * shape) @ one.shapes @ one.rates)
        if not np.abs(drive).max() > 1e-6 * 12.0:
            continue  # orders that the symmetry of both surfaces leaves still
        squared = (np.pi * AIR.c * np.array(order) / size) @ (np.pi * AIR.c * np.array(order) / size)
        numerator, denominator = [1.0, 2 * gamma], [1.0, 2 * gamma, squared]
        if not any(order):
            numerator, denominator = [1.0], [1.0, 0.0]  # compression is not lossy
        # driven linearly between the samples
        p = AIR.bulk_modulus / volume * lsim((numerator, denominator), sum(drive), t)[1]
        work += [one @ p / rate for one in drive]
    # bands from 31.5 to 250 Hz have all of it; modes above 400 Hz, whose air is dragged, are not in the sum
    assert found.energy_j.sum(axis=1) == pytest.approx(work, rel=0.015)
    assert found.total_j[found.bands_hz == 63.0] > 0.5 * work.sum()


@pytest.mark.filterwarnings("error")
def test_a_surface_that_stands_still_is_silent_and_gives_nothing() -> None:
    """Modes that cancel, as those of two equal parts that are not joined: a sum of rounding errors is no level. The
    Gram matrix made their square negative."""
    random, rate = np.random.default_rng(1), 2000.0
    t = np.arange(1000) / rate
    x, y = (one.ravel() for one in np.meshgrid((np.arange(12) + 0.5) / 3, (np.arange(9) + 0.5) / 3))
    tones = np.array([np.sin(2 * np.pi * f * t) * np.exp(-20 * t) * (1 - np.exp(-40 * t)) for f in (40, 57, 80)])
    rates = np.vstack([tones, -tones])
    moves, rests = random.normal(size=(len(x), 6)), random.normal(size=(len(x), 3))
    still = np.hstack([rests, rests]) * 1.1
    plates = [
        SurfaceVelocity(np.stack([x, y, 0 * x + z], axis=1), np.full(len(x), 12.0 / len(x)), shapes, rates, 1 / rate)
        for z, shapes in ((2.5, moves), (0.0, still * (1 + 1e-15 * random.normal(size=still.shape))))
    ]
    room = Room(np.array([4.0, 3.0, 2.5]), AIR, losses_from_t60(0.5))
    around = SimpleNamespace(room=room, surfaces=[SimpleNamespace(name=n) for n in "ab"], walls=["ceiling", "floor"])
    heard = room.pressures([plates], [Receiver("ear", [1.0, 1.0, 1.2])], 200.0)[0]
    assert np.isfinite(heard.p).all()
    found = surface_shares(plates, around, [Receiver("ear", [1.0, 1.0, 1.2])], 200.0)  # type: ignore[arg-type]
    assert found is not None
    assert np.isfinite(found.alone_db[0]).all() and np.isnan(found.alone_db[1]).all() and np.isnan(found.over_db(1))
    assert (found.energy_j[1] == 0.0).all() and found.share[0] == pytest.approx(1.0)
    assert plates[1].speed(1000).max() < 1e-12 * plates[0].speed(1000).max()  # rounding of sums of 6


def test_a_leak_is_no_surface_that_moves(tmp_path: Path) -> None:
    """A wall beside a slab that does not reach it, stiff and held all round: with an open door or without it is silent,
    and all that the door's resistance takes is the door's."""
    still = MODEL.replace("E: 8 GPa, nu: 0.2, rho: 1600", "E: 900 GPa, nu: 0.2, rho: 20000")
    still = still.replace("joints: {top: {connect: [wall, slab]}}\n", "")
    still = still.replace(
        "edge: y0, fix: simple}\n  side: {on: wall, edge: x0, fix: roller}", "edge: all, fix: simple}"
    )
    still = still.replace("far: {on: slab,", "near: {on: slab, edge: x0, fix: simple}\n  far: {on: slab,")
    door = "coupling: two-way\n    leak: {area: 1.6 m^2, length: 500 mm, resistance: 20 Pa*s/m^3}"
    study = STUDY[: STUDY.index("  above:")].replace("coupling: two-way", door)
    case = run_study(read_study(written(tmp_path, study, still))).cases["as given"]
    shares = case.by_surface["living"]
    assert shares.surfaces == ("under", "face", "leak of living") and shares.walls == ("ceiling", "x0", "")
    assert np.abs(shares.share[1]).max() < 1e-3
    assert (shares.alone_db[1] < shares.alone_db[0] - 60.0).all()
    assert shares.alone_db[2, 0] > shares.alone_db[0, 0] - 10.0  # at 10 Hz, the air of the door swings at 18 Hz
    velocity = case.basis.volumes["living"] @ case.response.velocities(np.arange(len(case.basis.omega)))
    lost = 20.0 * float((velocity**2).sum()) / 4000.0
    assert lost > 0.01 * shares.total_j.sum()
    # bands end above 10 Hz, and the record with a jump of the door's slow swing
    assert -shares.energy_j[2].sum() == pytest.approx(lost, rel=0.1)


def test_files_and_tables_have_it(ran, tmp_path: Path) -> None:
    shares = ran.cases["as given"].by_surface["living"]
    table = summary(ran)["cases"]["as given"]["by_surface"]["living"]
    assert table["surfaces"]["face"]["wall"] == "x0" and [*table["total_j"]] == [
        f"{band:g}" for band in shares.bands_hz
    ]
    assert sum(one["share"]["40"] for one in table["surfaces"].values()) == pytest.approx(1.0)
    write_results(tmp_path / "results.h5", ran)
    again = read_results(tmp_path / "results.h5").cases["as given"].by_surface["living"]
    assert again.surfaces == shares.surfaces and np.array_equal(again.energy_j, shares.energy_j)
    rows, bands = (grid(ran).rows for grid in (shares_by_surface, bands_by_surface))
    assert [row[2:4] for row in rows] == [("under", "ceiling"), ("face", "x0")]
    assert bands[0][:2] == ("living", "10") and len(bands) == len(shares.bands_hz)


def test_energy_of_structure_and_room_closes(ran) -> None:
    ledger = ran.cases["as given"].response.ledger
    assert abs(ledger.residual) < 1e-6  # of the energy put in: rounding and the steps


def test_rooms_above_and_beside_hear_the_other_sides(ran) -> None:
    """Above the slab what moves up pushes; the same room mirrored below hears the opposite of it."""
    case = ran.cases["as given"]
    above, beside = (case.rooms[name].p for name in ("above", "beside"))
    assert np.abs(above).max() > 0 and np.abs(beside).max() > 0
    plan = next(one for one in case.case.study.rooms if one.name == "above")
    assert (plan.on, plan.under, plan.moved) == ("floor", "floor", (("floor", "floor"),))


def test_a_room_above_is_the_room_below_mirrored(corner) -> None:
    basis, surfaces, drive = corner
    hz = np.linspace(20.0, 120.0, 11)
    below = placed(Room([4.0, 3.0, 2.5], AIR, LOSSES), surfaces["under"])
    above = placed(Room([4.0, 3.0, 2.5], AIR, LOSSES), surfaces["floor"], on="floor")
    assert below.origin == pytest.approx([0, 0, 0], abs=1e-12)  # rounding
    assert above.origin == pytest.approx([0, 0, 2.5])
    heard = [
        pressure_per_force(basis, drive, room, [Receiver("mic", [1.2, 0.7, z])], hz)[0]
        for room, z in ((below, 1.0), (above, 1.5))
    ]
    assert np.abs(heard[0] + heard[1]).max() < 1e-9 * np.abs(heard[0]).max()  # rounding


def test_rooms_on_both_sides_of_a_wall_are_placed_by_it(corner) -> None:
    basis, surfaces, drive = corner
    hz = np.linspace(20.0, 120.0, 11)
    size = np.array([4.0, 3.0, 2.5])
    inner = placed(Room(size, AIR, LOSSES), surfaces["face"], on="x0")
    outer = placed(Room(size, AIR, LOSSES), surfaces["outside"], on="x1")
    assert inner.origin == pytest.approx([0, 0, 0], abs=1e-12)  # rounding
    assert outer.origin == pytest.approx([-4, 0, 0])
    assert inner.axes == pytest.approx(np.eye(3)) and outer.axes == pytest.approx(np.eye(3))
    heard = [
        pressure_per_force(basis, drive, room, [Receiver("mic", [x, 0.7, 1.1])], hz)[0]
        for room, x in ((inner, 1.3), (outer, 2.7))
    ]
    assert np.abs(heard[0] + heard[1]).max() < 1e-9 * np.abs(heard[0]).max()  # rounding
    under = placed(Room(size, AIR, LOSSES), surfaces["under"], walls={"x0": surfaces["face"]})
    by_wall = placed(Room(size, AIR, LOSSES), surfaces["face"], on="x0", walls={"ceiling": surfaces["under"]})
    one, other = (
        pressure_per_force(basis, drive, room, [Receiver("m", [1, 1, 1])], hz)[0] for room in (under, by_wall)
    )
    assert np.abs(one - other).max() < 1e-12 * np.abs(one).max()  # rounding


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("x0: face", "x0: [face, half]", r"rooms\.living\.surfaces\.x0: got 'half' over 'face' on 3\.75 m\^2"),
        ("x0: face", "x1: outside", r"surfaces\.x1: got a surface that lies 4 m off the wall x1.*compare the room's"),
        ("x0: face", "x1: face", r"rooms\.living: got a surface on 'x1' that faces out, expected one that faces in"),
        ("x0: face", "y0: face", r"got a surface on 'y0' that faces along \[1\.0, 0\.0, 0\.0\] of the room"),
        ("x0: face", "left: face", r":9:38: rooms\.living\.surfaces\.left: got a surface on 'left' of .* one on ceil"),
        ("x0: face", "x0: [face, fcae]", r"rooms\.living\.surfaces\.x0\[1\]: got 'fcae'.*'face'"),
        ("x0: face", "x0: 3", r"rooms\.living\.surfaces\.x0: got 3, expected the name of a surface, or a list"),
        ("surfaces: {x1: outside}", "at: [1, 1]", r"got none of under, above, below, expected exactly one of"),
        ("[4, 3, 2.5]", "[4, 2.9, 2.5]", r"reaches 0\.05 m beyond the ceiling of 4 x 2\.9 m"),
        (
            "[4, 3, 2.5]",
            "[4, 3, 2.4]",
            r"surfaces\.x0: got a surface that reaches 0\.1 m beyond the wall x0 of 3 x 2",
        ),
        ("floor: floor", "floor: under", r"got a surface with normal \(0, 0, -1\), expected a normal that points up"),
        ("{x1: outside}", "{x1: under}", r"got a surface with normal \(0, 0, -1\), expected a normal that points sid"),
        (
            "    size: [2.5, 3, 2.5]\n    surfaces: {x1: outside}",
            "    above: floor\n    surfaces: {x1: outside}",
            r"got 'losses' beside 'above', expected air and receivers: there is no room above",
        ),
    ],
)
def test_what_cannot_be_a_room_is_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in STUDY
    with pytest.raises((InputError, InputErrors), match=message):
        run_study(read_study(written(tmp_path, STUDY.replace(old, new, 1))))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("side: x}", "side: above}", r"surfaces\.face\.side: got 'above' of a plate at 90 degrees.*x, -x, y or -y"),
        ("side: x}", "side: y}", r"surfaces\.face\.side: got 'y' of a plate at 90 degrees"),
        ("side: x}", "side: +x}", r"surfaces\.face\.side: got '\+x', expected"),
    ],
)
def test_sides_of_upright_plates_are_named_by_where_they_face(tmp_path: Path, old: str, new: str, message: str) -> None:
    with pytest.raises((InputError, InputErrors), match=message):
        run_study(read_study(written(tmp_path, model=MODEL.replace(old, new, 1))))
