"""Rooms of any shape in a study: a box as a mesh sounds as the box; the L; what is wrong with a mesh is said."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest
from scipy.optimize import brentq

from acoustics.meshed.cavity_mesh import CavityMesh, box_mesh
from acoustics.meshed.walls import AnyWall
from femstruct.errors import InputErrors
from femstruct.language.cases import read_study
from femstruct.workflow.check import inspect_file
from femstruct.workflow.run import run_study

MODELS = Path(__file__).parents[2] / "models"
SIZE = (0.5, 0.4, 0.3)
STUDY = """
model: plate.yaml
modes: {up_to: 1 kHz}
loads: {push: {at: P.z, half_sine: {amplitude: -10 N, frequency: 60 Hz}}}
record: {P.z: velocity}
time: {duration: 60 ms, sampling: 24 kHz}
frf: {mic: {drive: P.z, response: air.mic.pressure, kind: pressure, band: [20 Hz, 200 Hz], step: 5 Hz}}
rooms:
  air: {ROOM, under: below, losses: {loss_factor: 2 %, at: 340 Hz}, receivers: {mic: [0.1, 0.1, 0.1]}}
cases:
  one-way: {}
  two-way: {rooms.air.coupling: two-way}
"""
BOX, MESHED = "size: [0.5, 0.4, 0.3]", "mesh: box.msh, ceiling: top"


def write_box(path: Path, names: dict[str, str], shape: str = "hexahedron") -> None:
    mesh = box_mesh(SIZE, (6, 5, 4))
    cells = mesh.cells
    if shape == "tetra":
        six = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]]
        cells = cells[:, six].reshape(-1, 4)
        outer = CavityMesh(mesh.points, cells, {}).basis.mesh
        facets = outer.facets[:, outer.boundary_facets()].T
        walls = {"z1": facets[np.isclose(mesh.points[facets][:, :, 2], SIZE[2]).all(axis=1)]}
    else:
        walls = {wall: facets for wall, facets in mesh.walls.items() if wall in names}
    blocks = [("triangle" if shape == "tetra" else "quad", walls[wall]) for wall in names] + [(shape, cells)]
    tags = [np.full(len(block), tag) for tag, (_, block) in enumerate(blocks, 1)]
    field = {name: np.array([tag, 2]) for tag, name in enumerate(names.values(), 1)}
    written = meshio.Mesh(
        mesh.points, blocks, cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags}, field_data=field
    )
    written.write(path, file_format="gmsh22")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "plate.yaml").write_text(
        """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {plate: {type: plate, material: steel, thickness: 1 mm, origin: [0, 0, 0.3], size: [0.5, 0.4], mesh: [10, 8]}}
supports: {edges: {on: plate, edge: all, fix: simple}}
points: {P: {on: plate, at: [0.2, 0.15]}}
surfaces: {below: {on: plate, side: below}}
damping: {loss_factor: 2 %}
"""
    )
    write_box(tmp_path / "box.msh", {"z1": "top", "x0": "left"})
    return tmp_path


def study(folder: Path, room: str) -> Path:
    path = folder / "hit.study.yaml"
    path.write_text(STUDY.replace("ROOM", room))
    return path


@pytest.mark.parametrize("shape", ["hexahedron", "tetra"])
def test_a_box_as_a_mesh_sounds_as_the_box(folder: Path, shape: str) -> None:
    if shape == "tetra":
        write_box(folder / "box.msh", {"z1": "top"}, "tetra")
    expected = run_study(read_study(study(folder, BOX)))
    found = run_study(read_study(study(folder, f"{MESHED}, modes: {{up_to: 1 kHz}}")))
    assert found.cases["one-way"].basis_key == expected.cases["one-way"].basis_key
    assert found.cases["two-way"].basis_key not in (
        found.cases["one-way"].basis_key,
        expected.cases["two-way"].basis_key,
    )
    for name in expected.cases:
        ours, theirs = found.cases[name], expected.cases[name]
        # 0.3 %: 8 cells of 0.08 m a wave at 500 Hz, where the push has no energy left
        p, wanted = ours.rooms["air"].p[0], theirs.rooms["air"].p[0]
        assert np.abs(p - wanted).max() < 3e-3 * np.abs(wanted).max(), name
        heard, exact = ours.frf["mic"].values, theirs.frf["mic"].values
        # 1 %: a shift of 1e-4 of the resonance at 40 Hz, which is 2 % wide and falls on a line
        assert np.abs(heard - exact).max() < 1e-2 * np.abs(exact).max(), name
    first = [result.cases["two-way"].basis.frequency_hz[:6] for result in (found, expected)]
    assert first[0] == pytest.approx(first[1], rel=2e-4)  # shapes of 0.08 m: the shift said above, twice
    codes = {finding.code for finding in found.cases["two-way"].findings}
    assert "two-way-coupling" in codes and "one-way-stiff-air" not in codes


def test_walls_that_take_up_sound_make_the_room_ring_less(folder: Path) -> None:
    rms = []
    for walls in (
        "",
        "walls: {left: {absorption: {100 Hz: 30 %, 400 Hz: 50 %}}}, ",
        "walls: {left: {impedance: 2 kPa*s/m}}, ",
    ):
        path = study(folder, f"{MESHED}, {walls}modes: {{up_to: 1 kHz}}")
        case = run_study(read_study(path, ("time.duration=100 ms",), only="one-way")).cases["one-way"]
        rms.append(float(np.sqrt(np.mean(case.rooms["air"].p[0, 1200:] ** 2))))
    assert rms[2] < 0.8 * rms[1] < 0.8 * 0.97 * rms[0]


def test_walls_that_yield_are_heard_and_push_back_less(folder: Path) -> None:
    """A push of 0.1 Hz: the compliance of the wall, S / s'', adds to that of the air, and the plate moves further."""
    soft = "walls: {left: {mass: 4 kg/m^2, stiffness: 0.5 MN/m^3, resistance: 300 Pa*s/m}}, "
    found = []
    for walls in ("", soft):
        path = study(folder, f"{MESHED}, {walls}modes: {{up_to: 1 kHz}}")
        found.append(run_study(read_study(path, ("frf.mic.band=[0.1 Hz, 0.3 Hz]", "frf.mic.step=0.1 Hz"))).cases)
    rigid, yields = found
    air = np.prod(SIZE) / (1.21 * 343.0**2)
    wall = SIZE[1] * SIZE[2] / 0.5e6
    assert wall > 0.4 * air
    ratio = [yields[case].frf["mic"].values[0] / rigid[case].frf["mic"].values[0] for case in rigid]
    assert abs(ratio[0]) == pytest.approx(air / (air + wall), rel=1e-4)  # 0.1 Hz, (f / f_1)^2 of the plate: 1e-6 here
    assert abs(ratio[0]) < abs(ratio[1]) < 1.0  # the plate gives way to both
    assert yields["two-way"].basis.frequency_hz[0] < rigid["two-way"].basis.frequency_hz[0]
    for case in rigid:  # and in time
        quiet, loud = (cases[case].rooms["air"].p[0] for cases in (yields, rigid))
        assert np.abs(quiet - loud).max() > 0.1 * np.abs(loud).max()


def test_walls_of_a_room_with_a_size_are_those_of_its_mesh(folder: Path) -> None:
    """The same cells, 6 x 5 x 4: six to a wave at 686 Hz in a room of 0.5 x 0.4 x 0.3 m."""
    wall = "mass: 4 kg/m^2, stiffness: 0.5 MN/m^3, resistance: 300 Pa*s/m"
    found = []
    for room, name in ((MESHED, "left"), (BOX, "x0")):
        path = study(folder, f"{room}, walls: {{{name}: {{{wall}}}}}, modes: {{up_to: 650 Hz}}")
        found.append(run_study(read_study(path, ("time.duration=30 ms",), only="two-way")).cases["two-way"])
    p, wanted = (case.rooms["air"].p[0] for case in found)
    assert np.abs(p - wanted).max() < 1e-12 * np.abs(wanted).max()  # the same matrices: equal here
    heard = [case.frf["mic"].values for case in found]
    assert heard[0] == pytest.approx(heard[1], rel=1e-12)  # the same matrices


def test_bases_of_other_walls_have_other_names(folder: Path) -> None:
    path = study(folder, f"{BOX}, walls: {{x0: {{mass: 4, stiffness: 5e5}}}}, modes: {{up_to: 300 Hz}}")
    path.write_text(path.read_text().replace("one-way: {}", "soft: {rooms.air.coupling: two-way, ROOM: 1e5}"))
    path.write_text(path.read_text().replace("ROOM", "rooms.air.walls.x0.stiffness"))
    result = run_study(read_study(path, ("time.duration=10 ms",)))
    keys = {name: case.basis_key for name, case in result.cases.items()}
    assert keys["soft"] != keys["two-way"]
    first = [result.bases[keys[name]].frequency_hz[0] for name in ("soft", "two-way")]
    assert first[0] < 0.99 * first[1]


def test_a_resistance_alone_is_an_impedance_and_a_stiffness_needs_no_mass(folder: Path) -> None:
    def left(wall: str) -> AnyWall:
        path = study(folder, f"{MESHED}, walls: {{left: {{{wall}}}}}")
        return read_study(path, only="two-way").cases[0].study.rooms[0].room.walls["left"]

    assert left("resistance: 2 kPa*s/m").admittance == left("impedance: 2 kPa*s/m").admittance
    spring = left("stiffness: 2 MN/m^3, resistance: 300 Pa*s/m")
    assert (spring.mass, spring.stiffness, spring.resistance) == (0.0, 2e6, 300.0)


@pytest.mark.parametrize(
    ("room", "told"),
    [
        ("mesh: box.msh", "ceiling"),
        (f"{BOX}, mesh: box.msh, ceiling: top", "exactly one of size, mesh"),
        (
            f"{BOX}, walls: {{x0: {{absorption: 5 %}}}}",
            "'walls' of a room with a size, expected 'modes' beside",
        ),
        (f"{BOX}, modes: {{up_to: 200 Hz}}", "'modes' of a room with a size, expected 'walls' beside 'modes'"),
        (
            f"{BOX}, modes: {{up_to: 4 kHz}}, walls: {{x0: {{absorption: 5 %}}}}",
            r"modes\.up_to: got 4000 Hz, for which the room is cut into 20580 cells, expected about 2371 Hz or less",
        ),
        (
            f"{BOX}, modes: {{up_to: 200 Hz}}, walls: {{x2: {{absorption: 5 %}}}}",
            r"walls\.x2: got 'x2', no wall of a room with a size, expected x0, x1, y0, y1, floor, ceiling",
        ),
        (
            f"{BOX}, modes: {{up_to: 200 Hz}}, walls: {{ceiling: {{stiffness: 1e6}}}}",
            r"air\.walls: got a compliant wall that",
        ),
        (f"{BOX}, modes: {{up_to: 200 Hz}}, walls: {{x0: {{stiffness: 1e6}}}}, form: source", "in a meshed room"),
        (
            "mesh: box.msh, ceiling: tip",
            r"rooms\.air\.ceiling: got 'tip', no surface of 'box\.msh', expected top, left",
        ),
        (f"{MESHED}, walls: {{rigth: {{absorption: 5 %}}}}", r"walls\.rigth: got 'rigth'"),
        (f"{MESHED}, walls: {{left: {{absorption: 99 %}}}}", r"absorption.*at most 0\.951"),
        (f"{MESHED}, walls: {{left: {{}}}}", "absorption, impedance, mass, stiffness, resistance"),
        (f"{MESHED}, walls: {{left: {{mass: 10 kg/m^2, impedance: 2 kPa*s/m}}}}", "both impedance and mass"),
        (
            f"{MESHED}, walls: {{left: {{stiffness: 0, resistance: 0}}}}",
            r"left: got a wall of no mass, no stiffness",
        ),
        (f"{MESHED}, walls: {{left: {{absorption: 5 %, resistance: 3}}}}", "both absorption and resistance"),
        (f"{MESHED}, walls: {{left: {{mass: 10 kg}}}}", r"walls\.left\.mass: got '10 kg'.*a mass per area"),
        (f"{MESHED}, walls: {{left: {{mass: 10, stiffness: -1}}}}", r"walls\.left\.stiffness"),
        (f"{MESHED}, walls: {{top: {{mass: 10, stiffness: 1e6}}}}", "a compliant wall that is the ceiling"),
        (
            f"{MESHED}, walls: {{left: {{mass: 10 kg/m^2}}}}",  # in the case that is two-way
            r"walls\.left: got a mass without a stiffness, expected a stiffness above 0, as two-way",
        ),
        ("mesh: none.msh, ceiling: top", r"rooms\.air\.mesh: got no file"),
        ("mesh: plate.yaml, ceiling: top", "which is no mesh"),
        ("mesh: left.msh, ceiling: top", r"ceiling: got 'top', 0 to 0\.3 m high, expected a horizontal wall"),
        (f"{MESHED}, form: source", "a meshed room"),
        (f"{MESHED}, at: [0.1, 0.1]", "reaches beyond the wall 'top'"),
    ],
)
def test_what_is_wrong_is_said(folder: Path, room: str, told: str) -> None:
    write_box(folder / "left.msh", {"x0": "top"})
    with pytest.raises(InputErrors, match=told) as refused:
        inspect_file(study(folder, room))
    assert str(refused.value).count("hit.study.yaml:") >= 1


def test_a_receiver_outside_the_mesh_is_told_with_its_line(folder: Path) -> None:
    path = study(folder, MESHED)
    path.write_text(path.read_text().replace("[0.1, 0.1, 0.1]", "[0.1, 0.1, 0.4]"))
    with pytest.raises(
        InputErrors, match=r"hit\.study\.yaml:9:.*receivers\.mic: got \[0\.1, 0\.1, 0\.4\] m, a point outside"
    ):
        read_study(path)


def test_the_lined_room_does_what_its_file_says() -> None:
    """A tube closed by the lining has modes where its reactance, omega m - s / omega, is rho c cot(omega L / c)."""
    cases = run_study(read_study(MODELS / "lined_room.study.yaml", ("time.duration=2 ms",))).cases
    mass, stiffness, length, c, rho = 18.0, 1.69e6, 3.6, 343.0, 1.21

    def closed(f: float) -> float:
        omega = 2 * np.pi * f
        return omega * mass - stiffness / omega - rho * c / np.tan(omega * length / c)

    found = cases["lined"].basis.frequency_hz
    for low, high in ((30.0, 47.0), (49.0, 60.0)):
        # 0.05 %: the ceiling and the modes left out move them
        assert np.abs(found / brentq(closed, low, high) - 1).min() < 5e-4
    frf = {name: 20 * np.log10(np.abs(case.frf["mic"].values)) for name, case in cases.items()}
    f = cases["bare"].frf["mic"].frequency_hz
    # one decimal of the file, lines of its step
    assert (frf["lined"] - frf["bare"])[np.abs(f - 47.75).argmin()] == pytest.approx(-6.3, abs=0.3)
    meeting = (f > 60) & (f < 80)
    assert frf["lined, one-way"][meeting].max() - frf["lined"][meeting].max() == pytest.approx(6.1, abs=0.3)  # the same
    shifted = [mode for mode in cases["bare"].basis.frequency_hz if 60 < mode < 75]
    assert shifted == pytest.approx([63.5, 67.1, 73.1], abs=0.05)  # half a unit of the last digit


def test_the_shipped_mesh_is_what_its_script_makes() -> None:
    plan = read_study(MODELS / "l_room.study.yaml")
    rooms = [case.study.rooms[0].room for case in plan.cases]
    assert rooms[0] is rooms[2]  # cases share a room that is the same: its modes are solved once
    assert rooms[0] is not rooms[1]
    assert rooms[0].volume == pytest.approx((5.0 * 4.0 + 2.5 * 3.0) * 2.5, rel=1e-13)  # volumes of cells: 4e-16 here
    areas = {name: len(facets) for name, facets in rooms[0].mesh.walls.items()}
    assert areas["floor"] == areas["ceiling"] == 141
    few = "rooms.living room.modes={up_to: 30 Hz}"
    (first,) = inspect_file(MODELS / "l_room.study.yaml", (few,)).table()["rooms"]["living room"]["first_modes_hz"]
    assert first == pytest.approx(23.2, abs=0.1)  # one decimal, at the modes of a coarse mesh
