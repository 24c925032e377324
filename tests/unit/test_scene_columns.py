"""Numbers of scenes that follow what varies are foreseen for all samples, or not at all."""

from collections.abc import Callable, Mapping, Sequence
from math import sqrt

import numpy as np
import pytest

from femstruct.campaign.batch_rows import scene_columns
from femstruct.campaign.tasks import Samples
from femstruct.errors import InputError
from femstruct.impact.scene import GROUND, Body, Contact, Scene
from femstruct.laws.linear import Linear
from femstruct.modal.damping import Damping, Ratio
from femstruct.study.asked import Extent
from femstruct.study.structures import NoStructure
from femstruct.study.study import Study

STUDY = Study("none", NoStructure(), Damping(Ratio(0.0)), Extent(count=1))
N = 40  # samples, more than are read


def samples() -> Samples:
    rng = np.random.default_rng(3)
    numbers = rng.uniform(1.0, 2.0, (N, 3))
    texts = tuple(tuple(f"{value!r}" for value in row) for row in numbers.tolist())
    return Samples(("a", "b", "c"), ("", "", ""), texts, numbers)


def staged(
    mass: Callable[[float, float, float], float], preload: Callable[[float, float, float], float], title: str = ""
) -> Callable[[Sequence[str]], Mapping[str, tuple[Study, Scene]]]:
    def read(texts: Sequence[str]) -> dict[str, tuple[Study, Scene]]:
        a, b, c = (float(text.partition("=")[2]) for text in texts)
        wall = Contact("wall", upper="ball", lower=GROUND, law=Linear(1e4), preload=preload(a, b, c))
        return {"one": (STUDY, Scene((Body("ball", mass(a, b, c), -1.0),), (wall,), gravity=c if title else 0.0))}

    return read


def test_sums_in_proportion_are_foreseen() -> None:
    found = scene_columns(samples(), staged(lambda a, b, c: a, lambda a, b, c: 9.81 * (a + 2.0 * b) - 0.5 * c))
    assert found is not None
    a, b, c = samples().numbers.T
    assert found.columns["one"].keys() == {"ball.mass", "wall.preload"}
    np.testing.assert_allclose(found.columns["one"]["ball.mass"], a, rtol=1e-14)  # rounding
    np.testing.assert_allclose(found.columns["one"]["wall.preload"], 9.81 * (a + 2.0 * b) - 0.5 * c, rtol=1e-14)  # same


@pytest.mark.parametrize(
    "mass",
    [
        lambda a, b, c: a * b,
        lambda a, b, c: a**2,
        lambda a, b, c: sqrt(c),
        lambda a, b, c: max(a, 1.5),
        lambda a, b, c: a + 1e-9 * b * c,
    ],
    ids=["a product", "a square", "a root", "a bend", "a little of a product"],
)
def test_what_is_not_in_proportion_is_read_of_each_sample(mass: Callable[[float, float, float], float]) -> None:
    lines = list[str]()
    found = scene_columns(samples(), staged(mass, lambda a, b, c: 1.0), lines.append)
    assert found is not None and found.columns["one"].keys() == {"ball.mass"}
    assert found.columns["one"]["ball.mass"].tolist() == [mass(*row) for row in samples().numbers.tolist()]
    assert lines == [f"reading sample 1 of {N}"]
    scene_columns(samples(), staged(lambda a, b, c: a, lambda a, b, c: 1.0), lines.append)
    assert len(lines) == 1  # what is in proportion is not read of each


def test_what_changes_more_than_numbers_is_not_foreseen() -> None:
    assert scene_columns(samples(), staged(lambda a, b, c: a, lambda a, b, c: 1.0, title="gravity")) is None


def test_numbers_that_a_body_refuses_are_refused() -> None:
    with pytest.raises(InputError, match="mass"):
        scene_columns(samples(), staged(lambda a, b, c: a - 1.3, lambda a, b, c: 1.0))
