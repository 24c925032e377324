"""A row of a campaign is the run of its own study, whoever runs it and whatever ended meanwhile."""

import csv
import json
import multiprocessing
import os
import signal
import struct
import subprocess
import sys
import threading
import time
from concurrent.futures import Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray

from femstruct.campaign.designs import campaigns_of, refuse_values
from femstruct.campaign.executors import GONE, _pool, _Processes, crew
from femstruct.campaign.forecast import forecast_campaign
from femstruct.campaign.rows import Number, Row, is_of, open_journal, write_rows
from femstruct.campaign.sweep import ROWS, set_aside, sweep
from femstruct.campaign.tasks import Task, versions
from femstruct.errors import InputError, InputErrors
from femstruct.files.campaign_files import read_swept
from femstruct.files.campaign_tables import case_of_pictures, changing
from femstruct.language.campaigns import read_campaign, read_search
from femstruct.language.cases import read_study
from femstruct.study.campaigns import held_limits
from femstruct.view.campaign_figures import swept_figure
from femstruct.workflow.run import run_study

MODEL = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\npoints: {m: {}}\n"
STUDY = """
title: A hit
model: model.yaml
bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
record: {m.z: velocity}
limits: {m.z velocity: 1.2 m/s, settled: 0.5 s}
time: {duration: 10 ms, sampling: 10 kHz}
cases: {light: {}, heavy: {structure.mass: 4 kg}}
vary:
  bodies.ball.mass: {from: 0.5 kg, to: 2 kg, steps: 3, scale: log}
  bodies.ball.speed: {values: [1 m/s, 2 m/s]}
"""


@pytest.fixture
def study(tmp_path: Path) -> Path:
    (tmp_path / "model.yaml").write_text(MODEL, encoding="utf-8")
    path = tmp_path / "hit.study.yaml"
    path.write_text(STUDY, encoding="utf-8")
    return path


def test_a_row_is_the_run_of_its_study(study: Path) -> None:
    rows = sweep(read_campaign(study), workers=1)
    assert rows.texts[3] == ("1.0 kg", "2 m/s") and rows.cases == ("light", "heavy")
    masses, speeds = rows.values.T
    for case, mass in (("light", 1.0), ("heavy", 4.0)):
        given = 2.0 * masses * speeds / (masses + mass)  # what an elastic blow gives
        np.testing.assert_allclose(rows.of("m.z velocity", case), given, rtol=1e-3)  # the soft spring turns within 2 ms
    result = run_study(read_study(study, ("bodies.ball.mass=1 kg", "bodies.ball.speed=2 m/s")))
    for case, found in result.cases.items():
        assert rows.of("m.z velocity", case)[3] == found.channels["m.z velocity"].whole
        assert rows.of("ball on m peak force", case)[3] == found.response.contacts["ball on m"].peak_force
        ended = rows.of("energy / end / structure", case)[3]
        assert ended == found.response.ledger.end.structure
    assert rows.unit_of("m.z velocity") == "m/s" and rows.unit_of("energy / input_j") == "J"


class Dying(ThreadPoolExecutor):
    """Stands for processes, of which one dies whenever it is given a certain sample."""

    deadly = 5
    broken = False

    def submit(self, work: object, task: Task) -> Future:  # type: ignore[override]
        if self.broken:
            raise BrokenProcessPool
        if any(number == self.deadly for number, _ in task.samples):
            self.broken = True
            future: Future = Future()
            future.set_exception(BrokenProcessPool())
            return future
        return super().submit(work, task)  # type: ignore[arg-type]


def test_a_sample_that_kills_its_process_costs_its_task_only(
    study: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And is run once more by the next command."""
    monkeypatch.setattr("femstruct.campaign.executors._pool", Dying)
    campaign = read_campaign(study, ["bodies.ball.mass=0.5 kg:2 kg:6"], case="light")
    rows = sweep(campaign, tmp_path / "rows", workers=2)
    assert rows.done.all() and [i for i, told in enumerate(rows.trouble) if told] == [4, 5, 6, 7]
    assert rows.trouble[5] == GONE
    assert np.isfinite(rows.of("m.z velocity")[[0, 1, 2, 3, 8, 9, 10, 11]]).all()
    told: list[str] = []
    again = sweep(campaign, tmp_path / "rows", workers=2, progress=told.append)  # it dies again, once for each command
    assert [bool(one) for one in again.trouble] == [bool(one) for one in rows.trouble]
    monkeypatch.undo()
    whole = sweep(campaign, tmp_path / "rows", workers=1, progress=told.append)
    assert told[-1].startswith("4 of 4 samples") and not any(whole.trouble)
    np.testing.assert_array_equal(whole.numbers, sweep(campaign, workers=1).numbers)


@pytest.mark.stress
def test_rows_do_not_depend_on_who_runs_them_nor_on_who_is_killed(study: Path, tmp_path: Path) -> None:
    campaign = read_campaign(study, ["bodies.ball.mass=0.5 kg:2 kg:12"])
    alone, killed = sweep(campaign, workers=1), []

    def kill_one(line: str) -> None:
        children = multiprocessing.active_children()
        if not killed and children and line.startswith("4 of"):
            os.kill(children[0].pid or 0, signal.SIGKILL)
            killed.append(children[0].pid)

    together = sweep(campaign, tmp_path, workers=2, progress=kill_one)
    assert killed and together.done.all()
    np.testing.assert_array_equal(together.numbers, alone.numbers)


def test_what_was_finished_is_not_run_again(study: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    campaign, whole = read_campaign(study), sweep(read_campaign(study), workers=1)

    def stop(line: str) -> None:
        if line.startswith("2 of"):
            raise KeyboardInterrupt

    part = sweep(campaign, tmp_path, workers=1, progress=stop)
    assert part.done.tolist() == [True, True, False, False, False, False]
    again: list[str] = []
    rest = sweep(campaign, tmp_path, workers=1, progress=again.append)
    assert again[-1].startswith("4 of 4 samples")
    np.testing.assert_array_equal(rest.numbers, whole.numbers)
    monkeypatch.setattr("femstruct.campaign.tasks.run_cases", None)
    sweep(campaign, tmp_path, workers=1)  # nothing is left to run


def test_rows_of_another_campaign_are_set_aside(study: Path, tmp_path: Path) -> None:
    folder = tmp_path / "rows"
    sweep(read_campaign(study), folder, workers=1)
    other = read_campaign(study, ["bodies.ball.mass=1 kg,3 kg"])
    with pytest.raises(InputError, match="rows of another campaign"):
        sweep(other, folder, workers=1)
    assert set_aside(read_campaign(study), folder) is None
    (folder / "mine.txt").write_text("whoever else put a file here")
    write_rows(sweep(read_campaign(study), folder, workers=1), folder, pictures=False)
    assert set_aside(other, folder) == folder / "sweep.1.rows"
    names = sorted(path.name for path in folder.iterdir())
    assert names == ["mine.txt", "sweep.1.csv", "sweep.1.h5", "sweep.1.html", "sweep.1.rows"]


FILES = """
model: a/model.yaml
bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: table, file: a/law.csv}}}
record: {m.z: velocity}
time: {duration: 10 ms, sampling: 10 kHz}
vary:
  model: {values: [a/model.yaml, b/model.yaml]}
  bodies.ball.contact.file: {values: [a/law.csv, b/law.csv]}
"""


@pytest.fixture
def files(tmp_path: Path) -> Path:
    """A study whose model and whose table of forces both vary."""
    for name, stiffness in (("a", 1.0), ("b", 4.0)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "model.yaml").write_text(MODEL, encoding="utf-8")
        table = f"indentation [mm],force [kN]\n0,0\n1,{stiffness:g}\n"
        (tmp_path / name / "law.csv").write_text(table, encoding="utf-8")
    path = tmp_path / "files.study.yaml"
    path.write_text(FILES, encoding="utf-8")
    return path


@pytest.mark.parametrize("changed", ["b/model.yaml", "b/law.csv"])
def test_rows_of_a_file_that_has_changed_are_set_aside(files: Path, tmp_path: Path, changed: str) -> None:
    """Also where the first sample is not read from it."""
    campaign, folder, path = read_campaign(files), tmp_path / "rows", tmp_path / changed
    before = sweep(campaign, folder, workers=1)
    assert set_aside(campaign, folder) is None
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("1 kg", "3 kg").replace("1,4", "1,9"), encoding="utf-8")
    with pytest.raises(InputError, match=f"rows from before '.*{changed}' was changed"):
        sweep(campaign, folder, workers=1)
    assert set_aside(campaign, folder) == folder / "sweep.1.rows"
    after = sweep(campaign, folder, workers=1)
    given = 2.0 * 1.0 / (1.0 + np.array([1.0, 1.0, 3.0, 3.0]))  # what an elastic blow gives
    if changed == "b/model.yaml":
        np.testing.assert_allclose(after.of("m.z velocity"), given, rtol=2e-3)  # the soft spring turns within 5 ms
    else:  # the largest force goes with the square root of the stiffness
        force = after.of("ball on m peak force")[1] / before.of("ball on m peak force")[1]
        assert force == pytest.approx(1.5, rel=1e-3)  # the soft spring


def test_a_file_that_changes_meanwhile_ends_the_sweep(files: Path, tmp_path: Path) -> None:
    path = tmp_path / "b" / "law.csv"
    text = path.read_text(encoding="utf-8")

    def change(line: str) -> None:
        if line.startswith("2 of"):
            path.write_text(text.replace("1,4", "1,9"), encoding="utf-8")

    with pytest.raises(InputError, match=r"b/law\.csv: got a file that was changed while rows were computed from it"):
        sweep(read_campaign(files), tmp_path / "rows", workers=1, progress=change)
    path.write_text(text, encoding="utf-8")
    told: list[str] = []
    rest = sweep(read_campaign(files), tmp_path / "rows", workers=1, progress=told.append)
    assert told[-1].startswith("1 of 1 samples")
    np.testing.assert_array_equal(rest.numbers, sweep(read_campaign(files), workers=1).numbers)


def test_rows_of_another_version_are_set_aside(study: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    campaign, folder = read_campaign(study), tmp_path / "rows"
    sweep(campaign, folder, workers=1)
    assert {"femstruct_version", "numpy_version", "scipy_version", "numba_version"} <= versions().keys()
    assert set_aside(campaign, folder) is None
    monkeypatch.setattr("femstruct.workflow.provenance._versions", lambda: {"scipy_version": "another"})
    assert set_aside(campaign, folder) == folder / "sweep.1.rows"


def test_rows_without_a_number_are_not_set_aside(study: Path, tmp_path: Path) -> None:
    path = tmp_path / ROWS
    with open_journal(path, "another") as journal:
        journal.append([Row(0, "", {}, trouble="why")])
    assert set_aside(read_campaign(study), tmp_path) is None and not path.exists()
    with open_journal(path, "another") as journal:
        journal.append([Row(0, "", {}, trouble="why"), Row(1, "light", {"total mass": Number(1.0, "kg")})])
    assert set_aside(read_campaign(study), tmp_path) == tmp_path / "sweep.1.rows"


def test_a_sample_that_fails_says_why(study: Path, tmp_path: Path) -> None:
    campaign = read_campaign(study, ["bodies.ball.mass=1 kg,-1 kg,2 kg"], case="light")
    rows = sweep(campaign, tmp_path, workers=1)
    assert [bool(one) for one in rows.trouble] == [False, False, True, True, False, False]
    assert "vary bodies.ball.mass=-1 kg" in rows.trouble[2] and "positive" in rows.trouble[2]
    assert np.isnan(rows.of("m.z velocity")[2]) and not rows.trusted()[2] and rows.trusted()[0]
    write_rows(rows, tmp_path, pictures=False)
    table = list(csv.reader((tmp_path / "sweep.csv").read_text(encoding="utf-8").splitlines()))
    assert table[3][table[0].index("m.z velocity [m/s]")] == "" and "positive" in table[3][-1]
    assert float(table[1][table[0].index("m.z velocity [m/s]")]) == rows.of("m.z velocity")[0]


def test_where_no_sample_can_be_read_nothing_is_computed(study: Path) -> None:
    with pytest.raises(InputErrors, match=r"vary bodies\.bal\.mass=1 kg: .*did you mean"):
        sweep(read_campaign(study, ["bodies.bal.mass=1 kg,2 kg"]), workers=1)


def test_what_it_takes_is_told_beforehand(study: Path) -> None:
    told = forecast_campaign(read_campaign(study, ["structure.mass=1 kg,2 kg"]), workers=1)
    assert told["varies: structure.mass"] == "one of 1 kg, 2 kg"
    assert told["varies: bodies.ball.mass"].startswith("one of 0.5 kg, 1.0 kg")
    # the heavy case sets its mass itself: one more structure
    assert told["samples"] == 12 and told["structures to solve"] == 3 and told["impacts to simulate"] == 24
    assert str(told["about how long"]).endswith(" s on 1 core")  # 24 runs of some milliseconds


def test_the_file_is_the_rows_and_opens_in_xarray(study: Path, tmp_path: Path) -> None:
    rows = sweep(read_campaign(study), workers=1)
    written = write_rows(rows, tmp_path)
    assert [path.name for path in written] == ["sweep.h5", "sweep.csv", "sweep.png", "sweep.html"]
    read = read_swept(tmp_path)
    for name in (
        "title",
        "paths",
        "units",
        "texts",
        "cases",
        "names",
        "main",
        "findings",
        "severe",
        "limits",
        "sources",
    ):
        assert getattr(read, name) == getattr(rows, name), name
    np.testing.assert_array_equal(read.numbers, rows.numbers)
    with xarray.open_dataset(tmp_path / "sweep.h5", engine="h5netcdf") as table:
        velocity = table["value"].sel(case="heavy", number="m.z velocity")
        np.testing.assert_array_equal(velocity, rows.of("m.z velocity", "heavy"))
        assert table["varied"].sel(parameter="bodies.ball.mass").values.tolist() == rows.values[:, 0].tolist()
    image = bytearray((tmp_path / "sweep.h5").read_bytes())
    image[len(image) // 2] ^= 1
    (tmp_path / "sweep.h5").write_bytes(image)
    with pytest.raises(InputError, match="damaged"):
        read_swept(tmp_path)


def test_limits_are_judged_as_each_run_judges_them(study: Path, tmp_path: Path) -> None:
    """By the limit of the case and of the sample; not at rest in time is exceeded, and too short a window not known."""
    own = (
        "cases: {as given: {}, strict: {limits.m.z velocity: 0.8 m/s, limits.settled: 5 ms}}\n"
        "vary:\n  bodies.ball.speed: {values: [0.5 m/s, 1 m/s, 1.5 m/s]}\n"
        "  limits.m.z velocity: {values: [0.7 m/s, 1.2 m/s]}"
    )
    study.write_text(STUDY[: STUDY.index("cases:")] + own, encoding="utf-8")
    rows = sweep(read_campaign(study), workers=1)
    expected: dict[tuple[str, str], list[str]] = {}
    for texts in rows.texts:
        sets = tuple(f"{path}={text}" for path, text in zip(rows.paths, texts, strict=True))
        for case, told in run_study(read_study(study, overrides=sets)).verdicts.items():
            for one in told:
                expected.setdefault((one.name, case), []).append(one.verdict)
    found = {(one.name, one.case): one for one in held_limits(rows, rows.names)}
    assert found.keys() == expected.keys() and len(found) == 4
    for key, words in expected.items():
        one = found[key]
        counts = tuple(sum(word in which for word in words) for which in (["met"], ["exceeded"], ["not seen"]))
        assert (one.held, one.exceeded, one.unknown) == counts, key
    assert found["settled", "as given"].unknown == 6 and found["settled", "strict"].exceeded == 6
    assert found["m.z velocity", "strict"].limits == (0.8, 0.8) and found["m.z velocity", "as given"].limits == (
        0.7,
        1.2,
    )


def test_a_case_that_is_not_there_is_named(study: Path) -> None:
    added = "bodies.other: {mass: 1 kg, above: m, speed: 2 m/s, contact: {type: linear, stiffness: 1 MN/m}}"
    own = f"cases: {{light: {{}}, heavy: {{add: {{{added}}}}}}}\nvary: {{bodies.other.mass: {{values: [1 kg]}}}}"
    study.write_text(STUDY[: STUDY.index("cases:")] + own, encoding="utf-8")
    with pytest.raises((InputError, InputErrors), match=r"got 'heafy', expected a case .* did you mean 'heavy'"):
        sweep(read_campaign(study, case="heafy"), workers=1)


def test_a_picture_shows_the_case_in_which_something_changes(study: Path) -> None:
    """What varies is of the second case alone: its maps are drawn, with the numbers that change there."""
    own = (
        "cases:\n  light: {}\n  heavy:\n    structure.mass: 4 kg\n    add:\n"
        "      bodies.other: {mass: 1 kg, above: m, speed: 2 m/s, contact: {type: linear, stiffness: 1 MN/m}}\n"
        "vary:\n  bodies.other.mass: {values: [1 kg, 2 kg, 3 kg]}\n  bodies.other.speed: {values: [2 m/s, 3 m/s]}"
    )
    study.write_text(STUDY[: STUDY.index("cases:")] + own, encoding="utf-8")
    rows = sweep(read_campaign(study), workers=1)
    assert case_of_pictures(rows, rows.main) == "heavy" and not changing(rows, rows.main, "light")
    figure = swept_figure(rows, rows.main)
    assert figure is not None and figure.texts[0].get_text() == "A hit: heavy"
    titles = [axes.get_title(loc="left").partition(" [")[0] for axes in figure.axes if axes.get_title(loc="left")]
    assert titles == changing(rows, rows.main, "heavy")[:6] and len(titles) > 1


def test_what_a_case_adds_varies_too(study: Path) -> None:
    text = STUDY.replace("heavy: {structure.mass: 4 kg}", "two: {add: {bodies.other: {mass: 1 kg, above: ground}}}")
    study.write_text(text, encoding="utf-8")
    plan = read_study(study, ("bodies.other.mass=3 kg",))
    assert [body.mass for body in plan.cases[1].study.bodies] == [1.0, 3.0] and len(plan.cases[0].study.bodies) == 1


def test_a_journal_keeps_what_it_was_given(tmp_path: Path) -> None:
    row = Row(3, "a", {}, ("x",), ("x",), "why", again=True, design=("a", "x=1 m"))
    with open_journal(tmp_path / "j", "one") as journal:
        journal.append([row])
    with open_journal(tmp_path / "j", "one") as journal:
        assert journal.rows() == [row]
        assert journal.append([replace(row, trouble="", again=False)]) == journal.rows()
    assert is_of(tmp_path / "j", "one") and not is_of(tmp_path / "j", "two")
    (tmp_path / "k").write_bytes(b"no database at all, but longer than a page header" * 40)
    with pytest.raises(InputError, match="not a database"), open_journal(tmp_path / "k", "one"):
        pass


def test_the_command_prints_and_goes_on(study: Path, tmp_path: Path) -> None:
    words = [sys.executable, "-m", "femstruct", "sweep", str(study), "-o", str(tmp_path / "out"), "--workers", "1"]
    done = subprocess.run([*words, "--json", "--no-pictures"], capture_output=True, text=True, timeout=120)
    table = json.loads(done.stdout)
    assert done.returncode == 0 and not done.stderr
    assert table["samples"][0]["cases"]["light"]["numbers"]["m.z velocity"] == pytest.approx(
        2.0 / 3.0, rel=1e-3
    )  # the spring


@pytest.mark.stress
def test_killed_twenty_times_the_table_is_the_same(study: Path, tmp_path: Path) -> None:
    vary = "bodies.ball.mass=0.5 kg:2 kg:200"
    whole = sweep(read_campaign(study, [vary]), workers=1)
    words = [sys.executable, "-m", "femstruct", "sweep", str(study), "--vary", vary, "-o", str(tmp_path / "out")]
    chance, seen = np.random.default_rng(1), []
    for _ in range(20):
        child = subprocess.Popen([*words, "--workers", "1"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(1.5 + 2.0 * chance.random())
        child.kill()
        child.wait()
        kept = tmp_path / "out" / ROWS
        seen.append(kept.stat().st_size if kept.exists() else 0)
    subprocess.run([*words, "--no-pictures"], check=True, stdout=subprocess.DEVNULL, timeout=300)
    np.testing.assert_array_equal(read_swept(tmp_path / "out").numbers, whole.numbers)
    assert seen == sorted(seen)


@pytest.mark.stress
def test_a_cluster_gives_the_same_rows_and_survives_a_kill(study: Path) -> None:
    from distributed import LocalCluster

    campaign = read_campaign(study, ["bodies.ball.mass=0.5 kg:2 kg:30"])
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        killed: list[int] = []

        def kill_one(line: str) -> None:
            if not killed and not line.startswith(("0 of", "reading")):
                killed.append(next(iter(cluster.workers.values())).pid)
                os.kill(killed[0], signal.SIGKILL)

        rows = sweep(campaign, cluster=cluster.scheduler_address, progress=kill_one)
    assert killed
    np.testing.assert_array_equal(rows.numbers, sweep(campaign, workers=1).numbers)


def test_a_number_that_no_row_has_ends_the_sweep_with_its_first_row(study: Path, tmp_path: Path) -> None:
    told: list[str] = []
    campaign, expected = read_campaign(study), r"results: got 'm\.z velocty', .* did you mean 'm\.z velocity'\?"
    with pytest.raises(InputError, match=expected):
        sweep(campaign, tmp_path, workers=1, progress=told.append, names=["ball on m peak force", "m.z velocty"])
    assert not any(line.startswith("1 of") for line in told)
    with pytest.raises(InputError, match=expected):  # at once, from the row that is kept
        sweep(campaign, tmp_path, workers=1, progress=told.append, names=["m.z velocty"])
    assert not any(line.startswith("1 of") for line in told)
    with pytest.raises(InputError, match=r"got 'colour', expected a number of the study; it has .*total mass"):
        sweep(campaign, tmp_path, workers=1, names=["colour"])
    assert sweep(campaign, tmp_path, workers=1, names=["m.z velocity"]).done.all()


def test_processes_are_ended_without_ending_this_one() -> None:
    """A write to a process that was killed is no signal to this one, as long as there are processes."""
    before = signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    try:
        with crew(2):
            assert signal.getsignal(signal.SIGPIPE) == signal.SIG_IGN
        assert signal.getsignal(signal.SIGPIPE) == signal.SIG_DFL
    finally:
        signal.signal(signal.SIGPIPE, before)


def test_a_process_that_is_killed_while_it_sends_rows_keeps_nobody_waiting() -> None:
    """Half of a message is in the pipe, as when the kill comes in the middle of it: 100 bytes announced, 1 sent."""
    processes = _Processes(1)
    before = set(threading.enumerate())
    processes._threads, processes._others = before, set(multiprocessing.active_children())
    processes._executor = executor = _pool(1)
    assert executor.submit(int).result() == 0
    os.write(executor._result_queue._writer.fileno(), struct.pack("!i", 100) + b"x")
    processes.end()
    assert set(threading.enumerate()) <= before


@pytest.mark.stress
@pytest.mark.parametrize("seconds", [3.0, 5.0, 7.0, 9.0])
def test_a_request_to_terminate_ends_all_processes_and_leaves_nothing(study: Path, seconds: float) -> None:
    study.write_text(STUDY.replace("10 ms", "2 s").replace("steps: 3", "steps: 300"), encoding="utf-8")
    line = [sys.executable, "-m", "femstruct", "sweep", str(study), "--workers", "2", "-o", str(study.parent / "out")]
    process = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    time.sleep(seconds)
    process.terminate()
    _, told = process.communicate(timeout=60)
    assert process.returncode == 130 and "leaked" not in told, told


MODELS = Path(__file__).parents[2] / "models"
SOUGHT = [path for path in sorted(MODELS.glob("*.study.yaml")) if "\noptimise:" in path.read_text(encoding="utf-8")]


@pytest.mark.parametrize("path", SOUGHT, ids=lambda path: path.name)
def test_what_shipped_studies_optimise_can_be_tried(path: Path) -> None:
    search = read_search(path)
    refuse_values(search, read_study(path, only=search.case))
    assert search.case and len(search.designs) == 3
    told = campaigns_of(path)["femstruct optimise"]
    assert told.startswith(f"to minimise {search.goal} of case '{search.case}' chooses bodies.damper.mass, ")


def test_the_page_on_campaigns_shows_the_block_of_its_study() -> None:
    page = (MODELS.parent / "docs" / "campaigns.md").read_text(encoding="utf-8")
    block = page.split("```yaml\n")[1].split("```")[0]
    assert "optimise:" in block and block in (MODELS / "bedroom.study.yaml").read_text(encoding="utf-8")
