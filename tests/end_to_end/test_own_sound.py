"""Bodies that are heard themselves beside a surface: pressures, what is left out, what is refused, and the files."""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import numpy as np
import pytest

from acoustics.air import Air
from acoustics.fields.half_space import HalfSpace
from acoustics.levels.sound_levels import sound_levels
from acoustics.open_air.sphere import Sphere, sphere_pressures
from acoustics.receivers import Receiver
from femstruct.conventions import GRAVITY
from femstruct.errors import InputErrors
from femstruct.language.cases import read_study
from femstruct.sound.radiated_power import velocity_from_forces
from femstruct.study.results import CaseResult
from femstruct.view.terminal import study_tables
from femstruct.workflow.check import inspect_file
from femstruct.workflow.run import run_study, write_all

PLATE = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {plate: {type: plate, material: steel, thickness: 6 mm, origin: [1, 2, 0.3], size: [0.3, 0.2], mesh: [6, 4]}}
supports: {edges: {on: plate, edge: all, fix: simple}}
points: {hit: {on: plate, at: [0.1, 0.12]}, other: {on: plate, at: [0.2, 0.05]}}
surfaces: {low: {on: plate, side: below}, top: {on: plate, side: above}}
damping: {ratio: 5 %}
"""
LAW = "{type: hertz, E: [210 GPa, 210 GPa], nu: [0.3, 0.3]}"
BALL = f"ball: {{mass: 33 g, radius: 10 mm, above: hit, speed: 1 m/s, contact: {LAW}}}"
OPEN = "open: {above: top, receivers: {over: [0, 0, 0.3], aside: [0.2, 0.1, 0.2]}}"


def case_of(
    folder: Path,
    bodies: str = BALL,
    rooms: str = OPEN,
    *,
    time: str = "duration: 5 ms, sampling: 192 kHz",
    more: str = "",
) -> CaseResult:
    return run_study(read_study(written(folder, bodies, rooms, time, more))).cases["as given"]


def written(
    folder: Path, bodies: str = BALL, rooms: str = OPEN, time: str = "duration: 5 ms, sampling: 192 kHz", more: str = ""
) -> Path:
    (folder / "plate.yaml").write_text(PLATE)
    path = folder / "hit.study.yaml"
    path.write_text(
        f"model: plate.yaml\nmodes: {{up_to: 3 kHz}}\nbodies:\n  {bodies}\nrooms:\n  {rooms}\n"
        f"record: {{hit.z: velocity}}\ntime: {{{time}}}\n{more}\n"
    )
    return path


def codes(case: CaseResult) -> set[str]:
    return {finding.code for finding in case.findings}


def test_a_ball_is_heard_beside_the_plate(tmp_path: Path) -> None:
    """Its sound is that of a sphere one radius above the place it strikes, pushed by the contact force."""
    case = case_of(tmp_path)
    response = case.response
    assert response is not None
    force, dt = response.contacts["ball on hit"].force, 1 / 192e3
    gained = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1])) * dt / 0.033])
    mics = [Receiver("over", [0, 0, 0.3]), Receiver("aside", [0.2, 0.1, 0.2])]
    ball = Sphere(0.01, [0.1 - 0.15, 0.12 - 0.1, 0.01], gained, dt)
    wanted = sphere_pressures([ball], HalfSpace(Air()), mics)
    own, total = case.heard.own["open"], case.heard.total["open"]
    # 1 %: the force between its samples, 14 of them
    assert np.abs(own.p - wanted.p).max() < 1e-2 * np.abs(wanted.p).max()
    assert total.p == pytest.approx(case.rooms["open"].p + own.p, abs=1e-12)  # Pa, rounding
    first = own.p[0][np.flatnonzero(np.abs(own.p[0]) > 0.1 * np.abs(own.p[0]).max())[0]]
    assert first > 0 > case.rooms["open"].p[0].min()  # the ball is thrown up, the plate pushed down
    levels = sound_levels(total.p[1], dt)
    assert case.heard.total_levels["open.aside"].l_afmax_db == pytest.approx(levels.l_afmax_db, abs=1e-9)  # rounding
    assert case.levels["open.aside"].l_peak_db == sound_levels(case.rooms["open"].p[1], dt).l_peak_db
    assert not codes(case) & {"own-sound-left-out", "radius-unused", "impactor-moves", "push-coarsely-sampled"}


def test_from_below_it_is_the_same(tmp_path: Path) -> None:
    above = case_of(tmp_path).heard.own["open"].p
    mirrored = OPEN.replace("above: top", "below: low").replace("0.3]", "-0.3]").replace("0.2]", "-0.2]")
    below = case_of(tmp_path, BALL.replace("above", "below"), mirrored).heard.own["open"].p
    assert below == pytest.approx(above, abs=1e-9 * np.abs(above).max())  # rounding


def test_the_radius_of_a_body_is_that_of_its_hertz_law(tmp_path: Path) -> None:
    own = case_of(tmp_path).response
    given = case_of(tmp_path, BALL.replace("hertz,", "hertz, radius: 10 mm,")).response
    assert own is not None
    assert given is not None
    assert own.contacts["ball on hit"].peak_force == given.contacts["ball on hit"].peak_force
    two = "a: {mass: 33 g, radius: 10 mm, above: hit, speed: 1 m/s}\n  b: {mass: 33 g, radius: 5 mm, above: a}"
    law = f"contacts: {{ab: {{between: [a, b], law: {LAW}}}, ah: {{between: [a, hit], law: {LAW}}}}}"
    study = read_study(written(tmp_path, two, more=law)).cases[0].study
    stiffness = 4 / 3 * 210e9 / 2 / (1 - 0.3**2)
    assert study.contacts[0].law.stiffness == pytest.approx(stiffness * np.sqrt(0.01 / 3))  # type: ignore[union-attr]
    assert study.contacts[1].law.stiffness == pytest.approx(stiffness * np.sqrt(0.01))  # type: ignore[union-attr]


def test_what_lies_on_a_ball_is_above_it(tmp_path: Path) -> None:
    """Two balls, the upper one 2 x 10 mm + 5 mm above the plate as they touch; forces have two ends."""
    bodies = "a: {mass: 33 g, radius: 10 mm, above: hit, speed: 1 m/s}\n  b: {mass: 33 g, radius: 5 mm, above: a}"
    more = f"contacts: {{ab: {{between: [a, b], law: {LAW}, gap: 1 mm}}, ah: {{between: [a, hit], law: {LAW}}}}}"
    case = case_of(tmp_path, bodies, more=more)
    assert case.response is not None
    centres = {"a": 0.01, "b": 0.02 + 0.005}
    spheres = [
        Sphere(
            height if name == "a" else 0.005,
            [-0.05, 0.02, height],
            velocity_from_forces(case.response, name),
            1 / 192e3,
        )
        for name, height in centres.items()
    ]
    wanted = sphere_pressures(spheres, HalfSpace(Air()), case.heard.own["open"].receivers)
    assert case.heard.own["open"].p == pytest.approx(wanted.p, abs=1e-9)  # Pa, rounding
    (near,) = (finding for finding in case.findings if finding.code == "spheres-near")
    assert near.values["distance_m"] == pytest.approx(0.015)


def test_weight_and_lifting_make_no_sound(tmp_path: Path) -> None:
    """A ball that falls, rebounds, flies and is lifted for its next blow is heard at its blows alone."""
    bodies = BALL.replace("speed: 1 m/s", "speed: 1 m/s, blows: {count: 2, every: 8.013 ms, first: 1.007 ms}")
    case = case_of(tmp_path, bodies, time="duration: 16 ms, sampling: 96 kHz, gravity: true")
    response = case.response
    assert response is not None
    assert response.scene.gravity == GRAVITY
    velocity, t = velocity_from_forces(response, "ball"), response.t
    force = response.contacts["ball on hit"].force
    pushed = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]))]) / 96e3 / 0.033
    assert np.abs(velocity - pushed).max() < 2e-2 * pushed[-1]  # 7 samples of a contact
    own = case.heard.own["open"].p[0]
    for start, end in ((0.0, 1.007e-3), (1.007e-3 + 1.5e-3, 1.007e-3 + 8.013e-3)):  # flights, with the sound's way
        quiet = own[(t > start) & (t < end)]
        assert np.abs(quiet).max() < 1e-4 * np.abs(own).max()  # samples of the force at the ends of flights: 7e-5 here
    blows = [np.abs(own[(t > start) & (t < start + 2e-3)]).max() for start in (1.007e-3, 9.02e-3)]
    assert blows[1] == pytest.approx(blows[0], rel=0.05)  # samples of the two blows lie differently: 0.6 % here


def test_what_is_not_heard_is_said(tmp_path: Path) -> None:
    point = BALL.replace(" radius: 10 mm,", "").replace("hertz,", "hertz, radius: 10 mm,")
    case = case_of(tmp_path, point)
    (found,) = (finding for finding in case.findings if finding.code == "own-sound-left-out")
    assert found.message.startswith("open: ball strikes on the side of the receivers")
    assert not case.heard.own
    other_side = OPEN.replace("above: top", "below: low").replace("0.3]", "-0.3]").replace("0.2]", "-0.2]")
    assert "own-sound-left-out" not in codes(case_of(tmp_path, point, other_side))
    misses = point.replace("speed: 1 m/s, ", "")
    assert "own-sound-left-out" not in codes(case_of(tmp_path, misses))
    beneath = case_of(tmp_path, BALL.replace("above", "below"))  # its law takes the radius
    assert "radius-unused" in codes(beneath)
    assert not beneath.heard.own
    soft = BALL.replace(LAW, "{type: linear, stiffness: 10 kN/m}")  # 1.8 mm deep
    (found,) = (finding for finding in case_of(tmp_path, soft).findings if finding.code == "impactor-moves")
    assert found.values["moved_m"] == pytest.approx(
        np.sqrt(0.033 / 10e3), rel=0.02
    )  # the plate yields, too: 0.2 % here
    coarse = case_of(tmp_path, time="duration: 5 ms, sampling: 24 kHz")
    assert "push-coarsely-sampled" in codes(coarse)


@pytest.mark.parametrize(
    ("bodies", "rooms", "told"),
    [
        (
            BALL.replace("hertz,", "hertz, radius: 10 mm,"),
            OPEN.replace("above: top", "below: low").replace("0.3]", "-0.3]").replace("0.2]", "-0.2]"),
            r"hit\.study\.yaml:4:30: bodies\.ball\.radius: got a radius, and no receivers above a surface",
        ),
        (BALL.replace("hertz,", "hertz, radius: 10 mm,"), "open: {above: top}", "no receivers above"),
        (BALL.replace("above: hit", "above: null"), OPEN, "got none of above, below, before, after, expected exactly"),
        (BALL, OPEN.replace("above: top", "above: null"), "got none of under, above, below, expected exactly one"),
        (BALL.replace("10 mm", "0 mm"), OPEN, "expected a positive value: a length"),
        (BALL.replace(" radius: 10 mm,", ""), OPEN, "got a hertz law without a radius, expected one; add"),
        (BALL, OPEN.replace("[0, 0, 0.3]", "[-0.05, 0.02, 0.012]"), r"inside a sphere of 0\.01 m"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, bodies: str, rooms: str, told: str) -> None:
    with pytest.raises(InputErrors, match=told):
        inspect_file(written(tmp_path, bodies, rooms))


def test_files_keep_both(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("femstruct.view.model_scene.shapes_all", lambda *_: ([], ""))  # they take time
    result = run_study(read_study(written(tmp_path, more="cases: {ball: {}, hollow: {bodies.ball.mass: 10 g}}")))
    write_all(result, tmp_path)
    case = result.cases["hollow"]
    with h5py.File(tmp_path / "results.h5") as file:
        room = file["cases/hollow/rooms/open"]
        assert room["own_pressure"].attrs["unit"] == room["total_pressure"].attrs["unit"] == "Pa"
        assert room["total_pressure"][()] == pytest.approx(room["pressure"][()] + room["own_pressure"][()])
        stored = file["cases/hollow/total_levels/open.over"].attrs["l_afmax_db"]
        assert stored == case.heard.total_levels["open.over"].l_afmax_db
    told = json.loads((tmp_path / "summary.json").read_text())["cases"]["hollow"]
    assert told["levels"]["open.over"]["peak_pa"] == pytest.approx(np.abs(case.rooms["open"].p[0]).max())
    assert told["own_levels"]["open.over"]["peak_pa"] == pytest.approx(np.abs(case.heard.own["open"].p[0]).max())
    assert told["total_levels"]["open.over"]["peak_pa"] == pytest.approx(np.abs(case.heard.total["open"].p[0]).max())
    scales = {
        name: json.loads((tmp_path / f"{name}.wav.json").read_text())
        for name in ("hollow.open.over", "hollow.open.over.total", "ball.open.aside", "listen.open.over")
    }
    assert len({scale["full_scale"] for name, scale in scales.items() if not name.startswith("listen")}) == 1
    assert list(scales["listen.open.over"]["starts_s"]) == ["ball", "ball, total", "hollow", "hollow, total"]
    assert (tmp_path / "own_sound_open.png").exists()
    page = (tmp_path / "report.html").read_text()
    assert "ball, ball with the bodies&#x27; own sound, hollow" in page
    (levels,) = (grid for grid in study_tables(result) if grid.title.startswith("levels"))
    rows = {row[0]: row[1:] for row in levels.rows}
    total = case.heard.total_levels["open.over"]
    assert rows["open.over total L_peak / L_AFmax [dB]"][1] == f"{total.l_peak_db:.1f} / {total.l_afmax_db:.1f}"
    assert len(rows) == 7  # two of the structure and one in total, for two receivers


def test_the_shipped_ball_clicks() -> None:
    """What models/click_and_ring.study.yaml says to expect of its peaks and of who is heard first."""
    study = Path(__file__).parents[2] / "models" / "click_and_ring.study.yaml"
    case = run_study(read_study(study, ("time.duration=3 ms",), "thick")).cases["thick"]
    over, aside = (
        [levels[f"open.{mic}"].l_peak_db for levels in (case.levels, case.heard.own_levels, case.heard.total_levels)]
        for mic in ("over", "aside")
    )
    assert over == pytest.approx([110.3, 109.9, 114.1], abs=0.06)  # half a unit of the last digit
    assert aside == pytest.approx([103.4, 102.7, 103.7], abs=0.06)  # half a unit of the last digit
    own, borne = case.heard.own["open"], case.rooms["open"]
    click, ring = (
        one.t[np.flatnonzero(np.abs(one.p[0]) > rise * np.abs(one.p[0]).max())[0]]
        for one, rise in ((own, 0.01), (borne, 0.1))
    )
    # ball: from the near side of the sphere, when it has risen to 1 %, samples of 5 us later; plate: 0.5 m, blurred by
    # half a period of 10 kHz, where its sound ends
    assert click == pytest.approx((np.hypot(0.49, 0.0335) - 0.01) / 343, abs=15e-6)
    assert ring == pytest.approx(0.5 / 343, abs=50e-6)  # half a period of 10 kHz
