"""Rows by the batch engine are those of full runs; what it cannot do is run in full."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from femstruct.campaign.batch_rows import BY_BATCH, BY_HISTORY, BatchTask, _of_batch, batch_tasks, stage_of
from femstruct.campaign.forecast import forecast_campaign
from femstruct.campaign.rows import write_rows
from femstruct.campaign.sweep import set_aside, sweep
from femstruct.campaign.tasks import samples_of
from femstruct.errors import InputError, InputErrors
from femstruct.files.campaign_files import read_swept
from femstruct.language.campaigns import read_campaign
from femstruct.study.campaigns import Campaign, held_limits

MODEL = """
structure: {type: modes, frequency: [40 Hz, 130 Hz], points: {m: {shape: [0.3, 0.2]}}}
damping: {ratio: 1 %}
"""
STUDY = """
title: A hit
model: model.yaml
bodies:
  ball: {mass: 1 kg, above: m, speed: 1 m/s}
  damper: {mass: 0.5 kg, below: m}
contacts:
  hit: {between: [ball, m], law: {type: linear, stiffness: 1 MN/m}}
  stop: {between: [m, damper], law: {type: linear, stiffness: 2 MN/m}, gap: 0.1 mm}
links: {spring: {between: [damper, m], stiffness: 10 kN/m, damping: {closing: 20 N*s/m, opening: 0}}}
time: {duration: 50 ms, sampling: 10 kHz}
cases: {soft: {}, hard: {contacts.hit.law.stiffness: 4 MN/m}}
vary:
  bodies.damper.mass: {from: 0.2 kg, to: 2 kg, steps: 4, scale: log}
  contacts.stop.gap: {values: [0 mm, 0.2 mm]}
  links.spring.stiffness: {from: 5 kN/m, to: 50 kN/m, steps: 2}
"""
ALL = (
    "structure energy", "hit peak force", "stop peak force", "contacts / stop / closings",
    "contacts / hit / first_open_s", "contacts / hit / peak_time_s", "bodies / ball / end_velocity",
    "energy / at_separation / t_s", "energy / at_separation / ball", "energy / at_separation / stored",
    "energy / end / damper", "energy / end / dissipated", "energy / end / lost / contacts / stop",
    "energy / end / lost / links / spring", "energy / end / work", "energy / end / blows", "mode 2 frequency",
    "total mass",
)  # fmt: skip


@pytest.fixture
def study(tmp_path: Path) -> Path:
    (tmp_path / "model.yaml").write_text(MODEL, encoding="utf-8")
    path = tmp_path / "hit.study.yaml"
    path.write_text(STUDY, encoding="utf-8")
    return path


def by_batch(campaign: Campaign) -> bool:
    return not isinstance(batch_tasks(campaign, samples_of(campaign), 1), str)


def why_not(campaign: Campaign) -> str:
    found = batch_tasks(campaign, samples_of(campaign), 1)
    assert isinstance(found, str)
    return found


def test_rows_are_those_of_full_runs(study: Path) -> None:
    full, quick = sweep(read_campaign(study), workers=1), sweep(read_campaign(study, only=ALL), workers=2)
    assert quick.made == BY_BATCH and not full.made and quick.names == quick.main
    assert quick.names == ALL and quick.texts == full.texts and len(quick.texts) == 16
    for case in ("soft", "hard"):
        for name in ALL:
            size = np.nanmax(np.abs(full.of(name, case)))
            # both marches are exact to rounding; energies of a ledger row are sums of terms of 0.5 J
            np.testing.assert_allclose(quick.of(name, case), full.of(name, case), rtol=1e-9, atol=1e-9 * size + 1e-13)
            assert quick.unit_of(name) == full.unit_of(name)
    assert np.ptp(quick.of("stop peak force")) > 100.0


def test_limits_of_the_batch_engine_are_judged_as_in_full_runs(study: Path) -> None:
    """A recorded force of a contact is a number of the batch engine; its limit is 0.3 kN in one case."""
    text = STUDY.replace("soft: {}", "soft: {limits.stop force: 0.3 kN}")
    study.write_text(f"{text}record: {{stop: force}}\nlimits: {{stop force: 0.5 kN}}\n", encoding="utf-8")
    full = sweep(read_campaign(study), workers=1)
    quick = sweep(read_campaign(study, only=["stop force"]), workers=1)
    assert quick.made == BY_BATCH and quick.main == ("stop force",)
    found = list(held_limits(quick, quick.main))
    assert found == list(held_limits(full, ["stop force"])) and [one.limits[0] for one in found] == [300.0, 500.0]
    assert all(one.held and one.exceeded for one in found)


def test_a_run_whose_energy_does_not_close_is_not_to_be_trusted(study: Path) -> None:
    campaign = read_campaign(study, only=ALL)
    found = batch_tasks(campaign, samples_of(campaign), 1)
    assert not isinstance(found, str)
    task = found.tasks[0]
    assert isinstance(task, BatchTask)
    stage = stage_of(task.first, ALL)
    case = stage.plan.cases[0]
    batch = replace(stage.batch(case, {}, 2, 1), residual=np.array([0.0, 0.5]))
    sound, drifting = _of_batch(case, (0, 1), batch, stage, ALL)
    assert sound.severe == () and drifting.severe == ("energy-drift",)


RECORDED = """
record: {m.z: [displacement, acceleration], damper: travel, ground: force, stop: force}
peaks: {first_impact: 10 ms, lowpass: 2 kHz}
limits: {damper travel: 1 mm, settled: 40 ms}
"""
OF_HISTORIES = (
    "m.z acceleration", "peaks / m.z displacement / first_impact", "damper travel", "ground force", "stop force",
    "settled", "bodies / ball / travel", "energy / end / structure", "energy / at_separation / lost / modes",
    "mode 1 frequency",
)  # fmt: skip


def test_rows_of_histories_are_those_of_full_runs(study: Path) -> None:
    link = "post: {between: [m, ground], stiffness: 20 kN/m, damping: 100 N*s/m}"
    cases = "cases: {bare: {remove: [bodies.damper]}, hard: {contacts.hit.law.stiffness: 4 MN/m}}"
    text = STUDY.replace("links: {", f"links: {{{link}, ")
    vary = "vary: {bodies.ball.mass: {from: 0.2 kg, to: 2 kg, steps: 4}, contacts.hit.gap: {values: [0 mm, 0.2 mm]}}\n"
    study.write_text(f"{text[: text.index('cases:')]}{cases}\n{vary}{RECORDED}", encoding="utf-8")
    damped = ["damping.ratio=40 %"]  # so that it comes to rest in the window
    full = sweep(read_campaign(study, overrides=damped), workers=1)
    quick = sweep(read_campaign(study, overrides=damped, only=OF_HISTORIES), workers=2)
    assert quick.made == BY_HISTORY and set(quick.main) == set(OF_HISTORIES)
    assert list(held_limits(quick, quick.main)) == list(held_limits(full, full.main))
    assert len(list(held_limits(quick, quick.main))) == 3  # the bare case has no damper, and so no limit of its travel
    for case in ("bare", "hard"):
        for name in OF_HISTORIES:
            own, whole = quick.of(name, case), full.of(name, case)
            # one and the same simulation, whose masses are known to rounding; what the bare case has not is blank
            np.testing.assert_allclose(own, whole, rtol=1e-9, atol=1e-9 * np.nanmax(np.abs([*whole, 0.0])))
            assert quick.unit_of(name) == full.unit_of(name)
            assert np.isnan(own).all() == (case == "bare" and name in ("damper travel", "stop force"))
    assert np.ptp(quick.of("m.z acceleration", "hard")) > 10.0
    told = {code for case in full.findings for codes in case for code in codes}
    assert {code for case in quick.findings for codes in case for code in codes} <= told


def test_rows_of_histories_depend_neither_on_processes_nor_on_kills(study: Path, tmp_path: Path) -> None:
    study.write_text(f"{STUDY}{RECORDED.replace(', ground: force', '')}", encoding="utf-8")
    campaign = read_campaign(study, ["bodies.ball.mass=uniform(0.5 kg, 2 kg)"], only=["damper travel"], count=40)
    one = sweep(campaign, workers=1)

    def stop(line: str) -> None:
        if line.startswith("16 of"):
            raise KeyboardInterrupt

    assert sweep(campaign, tmp_path / "rows", workers=1, progress=stop).done.sum() == 16
    two = sweep(campaign, tmp_path / "rows", workers=2)
    assert one.made == BY_HISTORY
    np.testing.assert_array_equal(one.numbers, two.numbers)


def test_hertz_contacts_by_batch_are_near_those_of_full_runs(study: Path) -> None:
    law = ["contacts.hit.law={type: hertz, stiffness: 1 GN/m^1.5}"]
    vary = ["bodies.ball.mass=uniform(0.5 kg, 2 kg)", "contacts.hit.law.stiffness=uniform(0.3 GN/m^1.5, 1 GN/m^1.5)"]
    text = study.read_text(encoding="utf-8")
    study.write_text(text[: text.index("cases:")], encoding="utf-8")
    told = {"vary": vary, "overrides": law, "count": 20}
    full = sweep(read_campaign(study, **told), workers=1)
    quick = sweep(read_campaign(study, **told, only=ALL), workers=1)
    assert quick.made == BY_BATCH and np.ptp(full.of("hit peak force")) > 100.0
    for name, within in (("hit peak force", 1e-7), ("bodies / ball / end_velocity", 1e-7), ("structure energy", 1e-5)):
        # steps are held to 1e-8 of forces; an instant of separation to a tick, 2e-7 of the window
        np.testing.assert_allclose(quick.of(name), full.of(name), rtol=within)


def test_what_takes_histories_or_other_structures_is_run_in_full(study: Path) -> None:
    only = ["hit peak force"]
    assert by_batch(read_campaign(study, only=only))
    assert "all numbers" in why_not(read_campaign(study))
    errors = ["error_estimate / contacts / hit / peak_force"]
    assert f"'{errors[0]}' is a number of full runs" in why_not(read_campaign(study, only=errors))
    more = "more varies than numbers of bodies"
    assert more in why_not(read_campaign(study, ["structure.frequency[0]=30 Hz,40 Hz"], only=only))
    assert more in why_not(read_campaign(study, ["damping.ratio=1 %,2 %"], only=only))
    assert more in why_not(read_campaign(study, ["time.duration=50 ms,60 ms"], only=only))


def test_what_is_no_straight_line_is_read_of_each_sample(study: Path) -> None:
    """Heights of fall, and springs that follow a mass and a frequency."""
    tuned = "{between: [damper, m], frequency: 20 Hz, ratio: 5 %}"
    text = re.sub(r"spring: \{.*\}\}", f"spring: {tuned}}}", STUDY.replace("speed: 1 m/s", "drop_height: 1 m"))
    study.write_text(text[: text.index("vary:")], encoding="utf-8")
    drawn = ["uniform(0.1 m, 2 m)", "uniform(0.5 kg, 2 kg)", "uniform(10 Hz, 40 Hz)"]
    paths = ["bodies.ball.drop_height", "bodies.damper.mass", "links.spring.frequency"]
    vary = [f"{path}={law}" for path, law in zip(paths, drawn, strict=True)]
    names, lines = ["hit peak force", "energy / end / damper"], []
    campaign = read_campaign(study, vary, only=names, count=20)
    with_lines = batch_tasks(campaign, samples_of(campaign), 1, lines.append)
    assert not isinstance(with_lines, str) and lines == ["reading sample 1 of 20"]
    rows, full = sweep(campaign, workers=1), sweep(read_campaign(study, vary, count=20), workers=1)
    assert rows.made and not full.made
    for name in names:
        assert np.ptp(full.of(name)) > 0.1 * np.abs(full.of(name)).max()
        # both march exactly to rounding; an energy is the difference of larger ones
        np.testing.assert_allclose(rows.of(name), full.of(name), rtol=1e-8)


def test_a_refused_value_is_told_by_full_runs(study: Path) -> None:
    campaign = read_campaign(study, ["bodies.ball.mass=1 kg,-1 kg"], only=["hit peak force"], case="soft")
    rows = sweep(campaign, workers=1)
    assert not rows.made and "positive" in next(filter(None, rows.trouble))


def test_numbers_that_no_study_has_are_refused(study: Path) -> None:
    for only in (["hit peak forc"], ["hit peak force", "hit peak forc"]):
        with pytest.raises(InputError, match=r"samples.only: got 'hit peak forc'.*did you mean 'hit peak force'"):
            sweep(read_campaign(study, only=only), workers=1)


def test_only_stands_in_a_study_with_or_without_a_count(study: Path) -> None:
    text = study.read_text(encoding="utf-8")
    study.write_text(f"{text}samples: {{only: [hit peak force]}}\n", encoding="utf-8")
    assert read_campaign(study).only == ("hit peak force",) and len(samples_of(read_campaign(study)).texts) == 16
    study.write_text(f"{text}samples: {{count: 8, only: [hit peak force]}}\n", encoding="utf-8")
    assert len(samples_of(read_campaign(study)).texts) == 8
    study.write_text(f"{text}samples: {{method: sobol, only: [hit peak force]}}\n", encoding="utf-8")
    with pytest.raises(InputErrors, match="count"):
        read_campaign(study)


def test_a_plan_says_how_rows_are_made(study: Path) -> None:
    told = forecast_campaign(read_campaign(study, only=["hit peak force"]))
    assert told["rows"] == BY_BATCH and told["impacts to simulate"] == 32
    assert str(forecast_campaign(read_campaign(study))["rows"]).startswith("full runs: a row holds all numbers")


def test_batch_rows_are_kept_by_tasks(study: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("femstruct.campaign.batch_rows.AT_ONCE", 6)
    campaign, folder = read_campaign(study, only=ALL), tmp_path / "rows"
    whole = sweep(campaign, workers=1)

    def stop(line: str) -> None:
        if line.startswith("6 of"):
            raise KeyboardInterrupt

    part = sweep(campaign, folder, workers=1, progress=stop)
    assert part.done.sum() == 6
    assert set_aside(campaign, folder) is None
    again: list[str] = []
    rest = sweep(campaign, folder, workers=1, progress=again.append)
    assert again[-1].startswith("10 of 10 samples")
    np.testing.assert_array_equal(rest.numbers, whole.numbers)
    write_rows(rest, folder, pictures=False)
    assert read_swept(folder).made == BY_BATCH
    assert (folder / "sweep.csv").read_text(encoding="utf-8").splitlines()[0].count("hit peak force [N]") == 1
    assert set_aside(read_campaign(study, only=ALL[:2]), folder) == folder / "sweep.1.rows"


def test_batch_rows_of_a_changed_file_are_set_aside(study: Path, tmp_path: Path) -> None:
    """Also of one that had the same in it as that of the first sample, so that the batch engine took both."""
    other, folder = study.parent / "other.yaml", tmp_path / "rows"
    other.write_text(MODEL, encoding="utf-8")
    study.write_text(STUDY[: STUDY.index("vary:")], encoding="utf-8")
    campaign = read_campaign(study, ["model=model.yaml,other.yaml"], only=["hit peak force"])
    before = sweep(campaign, folder, workers=1)
    assert before.made and set_aside(campaign, folder) is None
    other.write_text(MODEL.replace("0.3", "0.5"), encoding="utf-8")
    assert set_aside(campaign, folder) == folder / "sweep.1.rows"
    first, second = sweep(campaign, folder, workers=1).of("hit peak force", "soft")
    assert first == pytest.approx(before.of("hit peak force", "soft")[0], rel=1e-3)  # of the engine and of full runs
    assert second < 0.95 * first  # what is struck gives way more


def test_findings_of_structure_and_batch_are_in_the_rows(study: Path) -> None:
    short = read_campaign(study, overrides=["time.duration=0.5 ms"], only=["hit peak force"])
    found = sweep(short, workers=1)
    assert found.made and all("contact-closed-at-end" in codes for codes in found.findings[0])


def test_all_names_offered_are_those_of_a_full_row(study: Path) -> None:
    campaign = read_campaign(study, only=["hit peak force"])
    tasks = batch_tasks(campaign, samples_of(campaign), 1)
    assert not isinstance(tasks, str)
    (task,) = tasks.tasks
    assert isinstance(task, BatchTask)
    stage = stage_of(task.first, campaign.only)
    case = stage.plan.cases[0]
    assert set(stage.offered(case, stage.batch(case, {}, 1, 1))) <= set(sweep(read_campaign(study), workers=1).names)


PLATE = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
parts: {plate: {type: plate, material: steel, thickness: 3 mm, origin: [0, 0, 0.3], size: [0.5, 0.4], mesh: [10, 8]}}
points: {hit: {on: plate, at: [0.21, 0.13]}, under: {on: plate, at: [0.33, 0.22]}}
supports: {edges: {on: plate, edge: all, fix: simple}}
surfaces: {below: {on: plate, side: below}, side: {on: plate, side: below}}
damping: {ratio: 1 %}
"""
HEARD = """
model: plate.yaml
modes: {count: 12}
bodies: {ball: {mass: 20 g, above: hit, speed: 2 m/s}, damper: {mass: 50 g, below: under}}
contacts:
  strike: {between: [ball, hit], law: {type: hertz, stiffness: 10 MN/m^1.5}}
  stop: {between: [under, damper], law: {type: linear, stiffness: 100 kN/m}, gap: 0.02 mm}
links: {spring: {between: [damper, under], stiffness: 500 N/m, damping: {closing: 0, opening: 2 N*s/m}}}
record: {strike: force}
time: {duration: 0.2 s, sampling: 20 kHz}
rooms:
  box:
    size: [0.5, 0.4, 0.25]
    under: below
    losses: {beta: 1 %, at: 293 Hz}
    receivers: {a: [0.1, 0.1, 0.1], b: [0.3, 0.3, 0.05]}
vary:
  bodies.ball.mass: {values: [10 g, 20 g, 40 g]}
  contacts.strike.law.stiffness: {values: [5 MN/m^1.5, 20 MN/m^1.5]}
"""
LEVELS = (
    "box.a L_AFmax",
    "box.b L_AFmax",
    *(f"levels / box.{one} / l_{what}_db" for one in "ab" for what in ("ae", "asmax")),
)


@pytest.fixture
def heard(tmp_path: Path) -> Path:
    (tmp_path / "plate.yaml").write_text(PLATE, encoding="utf-8")
    path = tmp_path / "heard.study.yaml"
    path.write_text(HEARD, encoding="utf-8")
    return path


def test_levels_in_a_room_are_those_of_full_runs(heard: Path) -> None:
    full = sweep(read_campaign(heard), workers=1)
    quick = sweep(read_campaign(heard, only=[*LEVELS, "strike force", "structure energy"]), workers=2)
    assert quick.made == BY_BATCH
    for name in LEVELS:
        # cosines of a room are those of the first sample, to 1e-4 of the pressure: 1e-3 dB
        np.testing.assert_allclose(quick.of(name), full.of(name), atol=2e-3)
        assert np.ptp(full.of(name)) > 3.0
    np.testing.assert_allclose(quick.of("strike force"), full.of("strike force"), rtol=1e-7)  # as their steps are held
    told = set(full.findings[0][0]) & {"coarse-mesh", "one-way-stiff-air", "sealed-room"}
    assert told <= set(quick.findings[0][0])


def test_a_room_that_nothing_moves_has_no_levels_in_either(heard: Path) -> None:
    """Below another plate that nothing joins to what is struck: it had -185 dB, of rounding errors."""
    other = "other: {type: plate, material: steel, thickness: 2 mm, origin: [0, 0, 0], size: [0.5, 0.4], mesh: [10, 8]}"
    model = PLATE.replace("parts: {", f"parts: {{{other}, ").replace("below: {on: plate", "below: {on: other")
    model = model.replace("supports: {", "supports: {others: {on: other, edge: all, fix: simple}, ")
    (heard.parent / "plate.yaml").write_text(model, encoding="utf-8")
    full = sweep(read_campaign(heard), workers=1)
    quick = sweep(read_campaign(heard, only=LEVELS), workers=1)
    assert quick.made == BY_BATCH
    for rows in (full, quick):
        assert all("room-silent" in codes for codes in rows.findings[0])
        assert not any(np.isfinite(rows.of(name)).any() for name in LEVELS if name in rows.names)


def test_rooms_that_a_batch_cannot_hear_are_run_in_full(heard: Path) -> None:
    only, text = list(LEVELS[:1]), heard.read_text(encoding="utf-8")
    assert by_batch(read_campaign(heard, only=only))
    more = {
        "'levels / box.a / peak_pa' is a number of full runs": (text, ["levels / box.a / peak_pa"]),
        "room 'box' with 'coupling: two-way'": (text.replace("losses:", "coupling: two-way\n    losses:"), only),
        "a structure that moves at the start": (f"{text}initial: {{velocity: {{hit.z: 0.1 m/s}}}}\n", only),
        "modes that it couples": (text, only),
    }
    model = heard.with_name("plate.yaml")
    more["'accuracy:'"] = (f"{text}accuracy: {{within: 5 %, band: [0 Hz, 500 Hz]}}\n", only)
    for why, (written, names) in more.items():
        heard.write_text(written, encoding="utf-8")
        post = ", post: {type: spring, between: [hit, ground], stiffness: {z: 1 kN/m}, damping: {z: 50 N*s/m}}}"
        coupled = PLATE.replace("[10, 8]}}", f"[10, 8]}}{post}")
        lump = PLATE.replace("[10, 8]}}", "[10, 8]}, lump: {type: mass, mass: 100 kg, at: hit}}")
        models = {"modes that it couples": coupled, "a structure that moves at the start": lump}
        model.write_text(models.get(why, PLATE), encoding="utf-8")
        assert why in why_not(read_campaign(heard, only=names))
