"""Pictures of sound in rooms: surfaces, moving pictures, modes for ParaView."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest
from PIL import Image

from acoustics.fields import receiver_grids as grids
from acoustics.fields.rectangular import Room
from femstruct.errors import InputErrors
from femstruct.files.mode_files import write_room_modes
from femstruct.language.cases import read_study
from femstruct.view import room_scene
from femstruct.view.model_scene import NoOpenGL, require_opengl
from femstruct.workflow.run import run_study

STUDY = """
model: plate.yaml
modes: {up_to: 1 kHz}
loads: {push: {at: P.z, half_sine: {amplitude: -10 N, frequency: 60 Hz}}}
time: {duration: 400 ms, sampling: 4 kHz}
rooms:
  air:
    {size: [0.5, 0.4, 0.3], under: below, losses: {loss_factor: 5 %, at: 340 Hz}, animate: [343 Hz, pulse], RECEIVERS}
  open: {below: below, receivers: {mic: [0, 0, -1]}}
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "plate.yaml").write_text(
        """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {plate: {type: plate, material: steel, thickness: 1 mm, origin: [0, 0, 0.3], size: [0.5, 0.4], mesh: [8, 6]}}
supports: {edges: {on: plate, edge: all, fix: simple}}
points: {P: {on: plate, at: [0.2, 0.15]}}
surfaces: {below: {on: plate, side: below}}
damping: {ratio: 2 %}
"""
    )
    path = tmp_path / "hit.study.yaml"
    path.write_text(STUDY.replace("RECEIVERS", "receivers: {mic: [0.1, 0.1, 0.1]}"))
    return path


def test_pictures_of_a_room(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    try:
        require_opengl()
    except NoOpenGL as error:
        pytest.skip(str(error))
    monkeypatch.setattr(grids, "FINE", 8)
    monkeypatch.setattr(room_scene, "FRAMES", 4)
    monkeypatch.setattr(room_scene, "PULSE", 3)
    paths, left_out = room_scene.room_pictures(run_study(read_study(path)), path.parent)
    assert not left_out
    assert [one.name for one in paths] == [
        "pressure_surfaces_air.png", "animation_air_343_Hz.gif", "animation_air_pulse.gif"
    ]  # fmt: skip
    with Image.open(paths[0]) as sheet:
        colours = np.asarray(sheet.convert("RGB")).reshape(-1, 3).astype(int)
    assert (np.ptp(colours, axis=1) > 60).mean() > 0.01  # red and blue are there
    for one, frames in ((paths[1], 4), (paths[2], 3)):
        with Image.open(one) as moving:
            assert moving.n_frames == frames
            seen = []
            for frame in range(frames):
                moving.seek(frame)
                seen.append(np.asarray(moving.convert("RGB")).astype(int))
        assert np.abs(seen[1] - seen[0]).max() > 60  # it moves


def test_modes_of_a_room_open_elsewhere(path: Path) -> None:
    plan, field = read_study(path).cases[0].study.rooms
    written = write_room_modes(plan, path.parent / "modes.vtu", 3)
    assert written is not None
    assert write_room_modes(field, path.parent / "none.vtu") is None
    assert not (path.parent / "none.vtu").exists()
    mesh = meshio.read(written)
    assert list(mesh.point_data) == ["mode 01 343.00 Hz", "mode 02 428.75 Hz", "mode 03 549.07 Hz"]
    exact = np.sqrt(2) * np.cos(np.pi * mesh.points[:, 0] / 0.5)
    assert mesh.point_data["mode 01 343.00 Hz"] == pytest.approx(exact, abs=1e-6)  # single precision
    assert len(mesh.cells_dict["hexahedron"]) == 28 * 22 * 17


def test_shapes_have_a_mean_square_of_one() -> None:
    room = Room([2.0, 1.5, 1.0])
    grid = room.grid()
    _, shapes = room.mode_shapes(grid.points, 6)
    x = np.sort(np.unique(grid.points[:, 0]))
    assert len(x) == 29
    inner = np.all((grid.points > 1e-9) & (grid.points < room.size - 1e-9), axis=1)
    # cos^2 over whole half waves, ends counted half: here the inner points stand for all but a layer of 1/28
    assert (shapes[inner] ** 2).mean(axis=0) == pytest.approx(np.ones(6), abs=0.2)


def test_moving_pictures_need_somebody_who_listens(path: Path) -> None:
    path.write_text(path.read_text().replace("receivers: {mic: [0.1, 0.1, 0.1]}", "receivers: {}"))
    with pytest.raises(InputErrors, match=r"rooms\.air\.animate: got a moving picture without receivers"):
        read_study(path)
    path.write_text(path.read_text().replace("343 Hz, pulse", "343 Hz, pulls"))
    with pytest.raises(InputErrors, match=r"animate.*'pulls'"):
        read_study(path)
