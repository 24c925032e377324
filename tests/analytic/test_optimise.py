"""Optima that are known: in closed form, on a grid, or from the independent model of the press."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from femstruct.campaign.designs import Designs
from femstruct.campaign.optimise import _searched, optimise, set_aside, starting_designs
from femstruct.campaign.rows import Number, Row, open_journal, write_optimum
from femstruct.campaign.tasks import Task, rows_of
from femstruct.errors import InputError, InputErrors
from femstruct.files.campaign_tables import optimum_table, run_command
from femstruct.language.campaigns import read_search
from femstruct.language.cases import read_study
from femstruct.study.campaigns import Listed, Scattered, Swept
from femstruct.study.optima import Search
from femstruct.view.campaign_answers import optimum_pieces
from femstruct.workflow.run import run_study

DATA = Path(__file__).parents[1] / "data"
X, Y = Scattered("x", "uniform", -2.0, 2.0, "m"), Scattered("y", "uniform", -2.0, 2.0, "m")
MODEL = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\npoints: {m: {}}\n"
HAMMER = """
optimise:
  case: impact damper
  minimise: ground force
  limits: {die.z displacement: 8 mm, damper travel: 20 mm, die.z acceleration: 650 m/s^2}
  vary:
    bodies.damper.mass: {from: 1 t, to: 6 t}
    contacts.block on damper.gap: {from: 0 mm, to: 3 mm}
    links.damper spring.stiffness: {from: 0.5 MN/m, to: 20 MN/m, scale: log}
  runs: 120
"""
HIT = """
title: A hit
model: model.yaml
bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
record: {m.z: velocity}
time: {duration: 10 ms, sampling: 10 kHz}
"""


@pytest.fixture
def study(tmp_path: Path) -> Path:
    (tmp_path / "model.yaml").write_text(MODEL, encoding="utf-8")
    path = tmp_path / "hit.study.yaml"
    path.write_text(HIT, encoding="utf-8")
    return path


@contextmanager
def searched(
    search: Search, row: Callable[[dict[str, str]], Row], first: np.ndarray | None = None
) -> Iterator[Designs]:
    """An optimisation of formulas in place of a study: what comes of the texts of a design."""

    def run(tasks: Sequence[Task], done: Callable[[list[Row]], None], tick: object = None) -> None:
        for task in tasks:
            for number, changes in task.samples:
                done([replace(row(dict(text.split("=") for text in changes)), sample=number)])

    with open_journal(Path(":memory:"), "formula") as journal:
        designs = Designs(search, "a", journal, run, lambda done: None)
        assert not _searched(search, designs, first)[1]
        yield designs


def numbers(**values: float) -> Row:
    return Row(0, "a", {name: Number(value, "m") for name, value in values.items()})


def number(texts: dict[str, str], name: str) -> float:
    return float(texts[name].removesuffix(" m"))


def himmelblau(texts: dict[str, str]) -> Row:
    """Within a circle about the origin its least value lies on the circle."""
    x, y = (2.5 * number(texts, name) for name in "xy")
    return numbers(f=(x * x + y - 11.0) ** 2 + (x + y * y - 7.0) ** 2, r=float(np.hypot(x, y)))


def test_a_limit_that_is_reached_is_held() -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 200_001)
    x, y = 3.0 * np.cos(angle), 3.0 * np.sin(angle)
    expected = float(((x * x + y - 11.0) ** 2 + (x + y * y - 7.0) ** 2).min())
    with searched(Search("", "f", (X, Y), limits={"r": 3.0}, runs=200), himmelblau) as found:
        best = found.outcomes[found.best]
        assert best.goal == pytest.approx(expected, rel=1e-3)  # the last radius of the search, squared in f
        assert best.limited[0] <= 3.0 * (1.0 + 1e-9) and len(found.outcomes) <= 200  # what counts as held


def test_a_limit_below_zero_is_a_limit() -> None:
    with searched(
        Search("", "f", (X,), limits={"g": -0.5}, runs=60),
        lambda texts: numbers(f=number(texts, "x"), g=-number(texts, "x")),
    ) as found:
        best = found.outcomes[found.best]
        assert best.goal == pytest.approx(0.5, rel=1e-3) and best.limited[0] <= -0.5 * (1.0 - 1e-9)  # the last radius


def test_a_limit_of_a_rating_is_of_the_number_that_a_run_judges() -> None:
    """The goal is followed before rounding, the limit holds for the rounded number: up to 55.5 dB."""

    def row(texts: dict[str, str]) -> Row:
        x = 55.0 + number(texts, "x")
        return Row(0, "a", {"f": Number(np.floor(x + 0.5), "dB"), "f before rounding": Number(x, "dB")})

    with searched(Search("", "f", (X,), "maximise", limits={"f": 55.0}, runs=80), row) as found:
        best = found.outcomes[found.best]
        assert best.limited == (55.0,) and best.goal > 55.4  # a step is found to a twentieth of the range of 4 dB
    with searched(Search("", "f", (X,), "minimise", limits={"f": 56.0}, runs=80), row) as found:
        assert found.outcomes[found.best].goal == pytest.approx(53.0, abs=1e-3)  # the last radius


def test_a_time_to_rest_that_is_not_seen_is_longer_than_its_limit() -> None:
    """Of 5 samples one does not come to rest: the median does not exceed the limit, the quantile of 90 % does."""

    def row(texts: dict[str, str]) -> Row:
        late = number(texts, "v") > 1.8
        return Row(0, "a", {"f": Number(number(texts, "x"), "m"), "settled": Number(np.nan if late else 0.2, "s")})

    scatter = Scattered("v", "uniform", 1.0, 2.0, "m")
    search = Search("", "f", (X,), "minimise", {"settled": 1.0}, (scatter,), quantile=0.5, scatter=5, runs=100)
    with searched(search, row) as found:
        best = found.outcomes[found.best]
        assert best.sound and best.limited == (0.2,) and best.beyond == 0.0
    with searched(replace(search, quantile=0.9), row) as found:
        best = found.outcomes[found.best]
        assert best.sound and np.isnan(best.limited[0]) and best.beyond == 1.0


def test_of_several_valleys_the_deepest_is_found() -> None:
    def row(texts: dict[str, str]) -> Row:
        x, y = number(texts, "x"), number(texts, "y")
        valleys = ((-1.3, 0.9, 1.0), (1.2, -1.1, 0.9), (1.4, 1.3, 0.8))
        return numbers(f=-max(d * np.exp(-4.0 * ((x - a) ** 2 + (y - b) ** 2)) for a, b, d in valleys))

    with searched(Search("", "f", (X, Y), runs=300), row) as found:
        assert found.outcomes[found.best].goal == pytest.approx(-1.0, abs=1e-6)  # f is flat there: radius 1e-4 squared


NARROW = (
    (-1.5, 1.5, 1.0, 2000.0),
    (1.0, -1.0, 0.9, 1.0),
)  # places, depths and rates of two valleys: the deeper is narrow


def valleys(texts: dict[str, str]) -> Row:
    x, y = number(texts, "x"), number(texts, "y")
    return numbers(f=-max(d * np.exp(-k * ((x - a) ** 2 + (y - b) ** 2)) for a, b, d, k in NARROW))


def swept(**more: object) -> Swept:
    """Five rows of a sweep: in both valleys, beside the first, one beyond a limit, one out of range."""
    x = np.array([-1.49, -1.48, 1.1, 0.0, 3.0])
    y = np.array([1.49, 1.49, -1.0, 0.0, 0.0])
    f = [
        number_of.value
        for a, b in zip(x, y, strict=True)
        for number_of in [valleys({"x": f"{a} m", "y": f"{b} m"}).numbers["f"]]
    ]
    told: dict[str, object] = {
        "title": "t",
        "paths": ("y", "x"),
        "units": ("m", "m"),
        "texts": tuple((f"{b} m", f"{a} m") for a, b in zip(x, y, strict=True)),
        "values": np.column_stack([y, x]),
        "method": "grid",
        "cases": ("a",),
        "baseline": "a",
        "names": ("f", "r"),
        "number_units": ("m", "m"),
        "main": ("f",),
        "numbers": np.array([[[v, r] for v, r in zip(f, (1.0, 1.0, 1.0, 9.0, 1.0), strict=True)]]),
        "done": np.ones(5, dtype=bool),
        "severe": (((),) * 5,),
        "findings": (((),) * 5,),
        "trouble": ("",) * 5,
    }
    return Swept(**(told | more))  # type: ignore[arg-type]


def test_a_search_begins_with_the_best_designs_of_a_sweep() -> None:
    """A valley of 1 % of the ranges, which no crowd meets, but a sweep has a row in it."""
    search = Search("", "f", (X, Y), limits={"r": 2.0}, runs=200)
    first = starting_designs(search, swept(), "a")
    right = [[0.775, 0.25], [0.1275, 0.8725], [0.5, 0.5]]  # (v + 2) / 4; no other near the best; beyond the limit last
    np.testing.assert_allclose(first, right, rtol=1e-12)  # rounding
    search = replace(search, limits={})
    with searched(search, valleys) as found:
        assert found.outcomes[found.best].goal > -0.95
    with searched(search, valleys, first) as found:
        assert found.outcomes[found.best].goal < -0.98  # the other valley has -0.9


def test_rows_of_a_sweep_over_something_else_are_left() -> None:
    z = Scattered("z", "uniform", 0.0, 1.0, "m")
    assert len(starting_designs(Search("", "f", (X, z)), swept(), "a")) == 0
    assert len(starting_designs(Search("", "g", (X, Y)), swept(), "a")) == 0
    assert len(starting_designs(Search("", "f", (X, Y)), swept(), "b")) == 0
    listed = Listed("y", ("0 m", "149 cm"), (0.0, 1.49)), Scattered("x", "log-uniform", 0.1, 10.0, "m")
    points = starting_designs(Search("", "f", listed), swept(), "a")
    np.testing.assert_allclose(points, [[0.25, np.log(30.0) / np.log(100.0)]], rtol=1e-12)  # rounding; x < 0 has no log


def test_nearly_as_good_names_each_valley(study: Path) -> None:
    """The speed of a mass by a ball of 1 or 2 kg: 2 m / (m + M) v, as good with 5 and 2.5 m/s as with less of both."""
    ranges = ["bodies.ball.mass=0.1 kg:2 kg"]
    search = read_search(study, "maximise m.z velocity", ranges, runs=20)
    best = optimise(search, workers=1)
    s = np.zeros(best.designs, dtype=bool)
    s[[0, 1]] = True
    values = best.rows.values.copy()
    values[:, 0] = np.linspace(0.4, 1.6, len(values))
    values[:2, 0] = 0.2, 1.9
    two = replace(best, rows=replace(best.rows, values=values), held=s, goals=np.full(best.designs, best.goal))
    assert "0.2 kg, 1.9 kg" in " ".join(
        str(one) for piece in optimum_pieces(two) for one in getattr(piece, "rows", [piece])
    )


def test_what_is_not_to_be_trusted_never_wins() -> None:
    def row(texts: dict[str, str]) -> Row:
        x = number(texts, "x")
        found = numbers(f=x)
        if x < -1.5:
            return replace(found, numbers={}, trouble="beyond")
        return replace(found, severe=("unsound",)) if x < -1.0 else found

    with searched(Search("", "f", (X,), runs=60), row) as found:
        assert -1.0 <= found.outcomes[found.best].goal < -0.99
        assert 0 < sum(not one.sound for one in found.outcomes) < len(found.outcomes)


def test_lists_are_chosen_too_and_a_large_goal_is_a_small_one_turned() -> None:
    def row(texts: dict[str, str]) -> Row:
        return numbers(f={"oak": 1.0, "fir": 3.0, "ash": 2.0}[texts["wood"]] - (number(texts, "x") - 0.5) ** 2)

    wood = Listed("wood", ("oak", "fir", "ash"))
    with searched(Search("", "f", (wood, X), "maximise", runs=80), row) as found:
        assert found.outcomes[found.best].goal == pytest.approx(3.0, abs=1e-6)  # flat at its top


def test_what_scatters_is_held_for_its_quantile() -> None:
    def row(texts: dict[str, str]) -> Row:
        return numbers(f=number(texts, "x"), load=number(texts, "x") * number(texts, "v"))

    scatter = Scattered("v", "uniform", 1.0, 2.0, "m")
    search = Search("", "f", (X,), "maximise", {"load": 1.5}, (scatter,), quantile=0.75, scatter=16, runs=16 * 25)
    with searched(search, row) as found:
        best, table = found.outcomes[found.best], found.samples()
        loads = np.quantile(table.numbers[:16, 1], 0.75)  # of the samples that all designs share
        assert best.goal == pytest.approx(1.5 / loads, rel=1e-3)  # the last radius of the search
        assert best.goal == pytest.approx(1.5 / 1.75, rel=0.04)  # a stratum of 16 about the true quantile
        assert table.texts[0][1] == table.texts[16][1] and len(table.texts) == 16 * len(found.outcomes)


@pytest.mark.parametrize("paths", [1, 3, 6, 9])
def test_the_fewest_runs_are_enough_for_many_paths(paths: int) -> None:
    """20 designs: some all over the ranges, the rest beside the best."""
    names = "abcdefghi"[:paths]
    varied = tuple(Scattered(one, "uniform", -1.0, 1.0, "m") for one in names)
    with searched(
        Search("s.yaml", "z", varied, runs=20), lambda texts: numbers(z=sum(number(texts, one) ** 2 for one in names))
    ) as designs:
        assert 12 <= len(designs.outcomes) <= 20 and designs.outcomes[designs.best].goals[0] < paths / 3.0  # the mean


def test_an_unknown_number_is_refused_with_the_nearest(study: Path) -> None:
    search = read_search(study, "minimise m.z velocty", ["bodies.ball.mass=1 kg:2 kg"])
    with pytest.raises(InputError, match=r"optimise.minimise: got 'm.z velocty'.*did you mean 'm.z velocity'"):
        optimise(search, workers=1)
    search = read_search(study, "minimise m.z velocity", ["bodies.bal.mass=1 kg:2 kg"])
    with pytest.raises(InputErrors, match=r"the path 'bodies\.bal\.mass'"):
        optimise(search, workers=1)


def test_a_limit_in_another_unit_is_refused(study: Path) -> None:
    ranges = ["bodies.ball.mass=1 kg:2 kg"]
    with pytest.raises(InputError, match=r"optimise\.limits\.m\.z velocity: got a length, expected .* \[m/s\]"):
        optimise(read_search(study, "minimise m.z velocity", ranges, ["m.z velocity=5 mm"], runs=30), workers=1)


def test_a_design_without_the_number_never_wins() -> None:
    def row(texts: dict[str, str]) -> Row:
        x = number(texts, "x")
        return numbers(f=x, g=1.0) if x > -1.0 else numbers(g=1.0)

    with searched(Search("", "f", (X,), runs=60), row) as found:
        assert -1.0 < found.outcomes[found.best].goal < -0.98


def test_an_interrupted_optimisation_goes_on_to_the_same_end(study: Path, tmp_path: Path) -> None:
    ranges = ["bodies.ball.mass=0.1 kg:2 kg"]
    search = read_search(study, "maximise m.z velocity", ranges, ["m.z velocity=0.5 m/s"], runs=40)
    whole = optimise(search, workers=1)

    def stop(line: str) -> None:
        if line.startswith("9 of"):
            raise KeyboardInterrupt

    folder = tmp_path / "kept"
    part = optimise(search, folder, workers=1, progress=stop)
    assert part.interrupted and part.runs < whole.runs
    told: list[str] = []
    rest = optimise(search, folder, workers=1, progress=told.append)
    assert rest.goal == whole.goal and rest.chosen == whole.chosen and told[0].startswith("10 of")
    assert whole.goal == pytest.approx(0.5, rel=2e-3) and whole.feasible  # 40 runs
    assert [path.name for path in write_optimum(rest, folder)] == [
        "optimise.h5",
        "optimise.csv",
        "optimise.png",
        "optimise.html",
    ]
    table = optimum_table(rest)
    assert table["maximise"] == "m.z velocity" and table["design"][0]["text"] in run_command(rest)
    assert set_aside(search, folder) is None
    assert set_aside(replace(search, runs=50), folder) == folder / "optimise.1.rows"


def test_rows_are_those_of_their_designs_whatever_the_course() -> None:
    """A search whose course has changed takes up the designs that it asks for, and no other."""
    asked: list[float] = []

    def run(tasks: Sequence[Task], done: Callable[[list[Row]], None], tick: object = None) -> None:
        for task in tasks:
            sample, (text,) = task.samples[0]
            asked.append(float(text.removeprefix("x=").removesuffix(" m")))
            done([replace(numbers(f=asked[-1]), sample=sample, again=asked[-1] == 2.0)])

    search, first, other = Search("", "f", (X,), runs=60), (0.0, 0.25, 1.0), (0.25, 0.75, 0.0, 1.0)
    with open_journal(Path(":memory:"), "formula") as journal:
        for course, ran in ((first, [-2.0, -1.0, 2.0]), (other, [1.0, 2.0]), (other, [2.0])):
            asked.clear()
            designs = Designs(search, "a", journal, run, lambda done: None)
            goals = [one.goal for one in designs(np.array(course)[:, None])]
            assert goals == [4.0 * u - 2.0 for u in course] and asked == ran
            assert [row.numbers["f"].value for row in designs.rows()] == goals
            assert [row.sample for row in designs.rows()] == [*range(len(course))]


def test_rows_of_a_design_from_a_changed_file_are_set_aside(study: Path, tmp_path: Path) -> None:
    """Also of a list, and where the files as they are written do not name it."""
    other, folder = study.parent / "other.yaml", tmp_path / "rows"
    other.write_text(MODEL.replace("1 kg", "2 kg"), encoding="utf-8")
    search = read_search(study, "maximise m.z velocity", ["model=model.yaml,other.yaml", "time.sampling=10 kHz,20 kHz"])
    assert optimise(search, folder, workers=1).goal == pytest.approx(1.0, rel=1e-3)  # the soft spring
    assert set_aside(search, folder) is None
    other.write_text(MODEL.replace("1 kg", "0.5 kg"), encoding="utf-8")
    assert set_aside(search, folder) == folder / "optimise.1.rows"
    assert optimise(search, folder, workers=1).goal == pytest.approx(4.0 / 3.0, rel=2e-3)  # the spring, twice as much


def test_a_design_that_cannot_be_read_is_named_as_such(study: Path, tmp_path: Path) -> None:
    """Each end of both ranges can be, and a short window with few samples a second cannot."""
    ranges = ["time.duration=0.6 ms:10 ms", "time.sampling=1 kHz:10 kHz"]
    search = read_search(study, "maximise m.z velocity", ranges, runs=40)
    found = optimise(search, tmp_path, workers=1)
    failed = [i for i, why in enumerate(found.rows.trouble) if why]
    lines = [one for one in optimum_pieces(found) if isinstance(one, str)]
    assert failed and any(one.startswith(f"No result for design {failed[0]} (") for one in lines)
    assert not any("sample 0" in one or "samples in all" in one for one in lines)
    again = optimise(search, tmp_path, workers=1)
    np.testing.assert_array_equal(again.rows.numbers, found.rows.numbers)
    assert again.rows.trouble == found.rows.trouble


def test_rows_of_another_version_are_set_aside(study: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    search = read_search(study, "maximise m.z velocity", ["bodies.ball.mass=1 kg,2 kg"])
    optimise(search, tmp_path, workers=1)
    monkeypatch.setattr("femstruct.campaign.optimise.version_of", lambda name: {name: "another"})
    assert set_aside(search, tmp_path) is None  # one goal takes no pymoo
    monkeypatch.setattr("femstruct.workflow.provenance._versions", lambda: {"scipy_version": "another"})
    assert set_aside(search, tmp_path) == tmp_path / "optimise.1.rows"


@pytest.mark.stress
def test_the_damper_of_the_press_is_that_of_the_independent_model() -> None:
    """Travel up to 18 mm: 1.51 % of the energy, the mass at its bound, contact frequencies 1.056 apart."""
    found = optimise(read_search(DATA / "press_with_damper.study.yaml"), workers=1)
    mass, stiffness = (one.number for one in found.chosen)
    assert found.feasible and found.goal / 0.864 == pytest.approx(0.0151, abs=5e-5)  # its digits
    assert found.chosen[0].at == "upper" and mass == pytest.approx(12.0)
    assert np.sqrt(stiffness / mass) / 6000.0 == pytest.approx(1.056, abs=1e-3)  # its digits


@pytest.mark.stress
def test_with_little_travel_the_deeper_of_two_valleys_is_found() -> None:
    """A damper of 3.8 kg leaves 24.8 %, as a local search finds from 5 kg. One of 12 kg stays below 12 mm only where a
    window ends before the largest travel: in 105 ms in a corner of 0.03 % of the ranges."""
    path = DATA / "press_with_damper.study.yaml"
    limits = ["damper travel=12 mm"]
    for window, most in (("120 ms", 0.2480), ("105 ms", 0.080), ("80 ms", 0.030)):
        search = read_search(path, limits=limits, overrides=[f"time.duration={window}"])
        found = optimise(search, workers=1)
        assert found.feasible and found.limits["damper travel"] <= 0.012 * (1.0 + 1e-9)  # what counts as held
        assert found.goal / 0.864 < most
        grid = [(r, m) for m in np.geomspace(0.5, 12.0, 14) for r in np.geomspace(0.5, 3.0, 18)]
        texts = [
            (f"bodies.damper.mass={m} kg", f"contacts.bed on damper.law.stiffness={m * (6000 * r) ** 2} N/m")
            for r, m in grid
        ]
        rows = [one[0].numbers for one in rows_of(Task(str(path), search.overrides, "", tuple(enumerate(texts))))]
        held = [one["structure energy"].value for one in rows if one["damper travel"].value <= 0.012]
        assert found.goal <= min(held)


@pytest.mark.stress
def test_the_boat_has_the_damper_of_equation_5_45() -> None:
    """Contact frequency 3 / sqrt(1 + 0.6) of the wave's; 0.5132 of the acceleration without a damper."""
    study = Path(__file__).parents[2] / "models" / "boat_wave.study.yaml"
    found = optimise(
        read_search(
            study,
            "minimise m.z acceleration",
            ["contacts.damper on m.law.stiffness=20 N/m:400 N/m:log"],
            overrides=["time.sampling=20 kHz"],
            case="damper",
            runs=150,
        ),
        workers=1,
    )
    assert found.goal == pytest.approx(0.5132, rel=1e-3)  # its digits
    ratio = np.sqrt(found.chosen[0].number / 0.6) / (2.0 * np.pi)
    assert ratio == pytest.approx(3.0 / np.sqrt(1.6), rel=1e-2)  # the goal is flat there: 1e-4 of it


@pytest.mark.stress
def test_the_damper_of_the_forging_hammer_by_one_block(tmp_path: Path) -> None:
    """Mass, gap and spring for the least ground force, with limits of travel and of the die's acceleration: every row
    is the full run of its design, and the damper lowers the force of the hammer without it."""
    models = Path(__file__).parents[2] / "models"
    (tmp_path / "forging_hammer.yaml").write_text((models / "forging_hammer.yaml").read_text(encoding="utf-8"))
    text = (models / "forging_hammer.study.yaml").read_text(encoding="utf-8")
    study = tmp_path / "hammer.study.yaml"
    study.write_text(
        text[: text.index("optimise:")].replace("[displacement, velocity]", "[displacement, acceleration]") + HAMMER,
        encoding="utf-8",
    )
    found = optimise(read_search(study), workers=1)
    assert found.feasible and found.limits["damper travel"] <= 0.02 and found.goal < 290e3
    k = found.best
    changes = [f"{path}={value}" for path, value in zip(found.rows.paths, found.rows.texts[k], strict=True)]
    case = run_study(read_study(study, changes, only="impact damper")).cases["impact damper"]
    for name in ("ground force", "damper travel", "die.z acceleration"):
        # the same program with the same numbers
        assert case.channels[name].whole == pytest.approx(float(found.rows.of(name)[k]), rel=1e-9)
    bare = run_study(read_study(study, only="as built")).cases["as built"]
    assert found.goal < bare.channels["ground force"].whole
