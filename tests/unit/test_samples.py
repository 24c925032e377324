"""Samples of a campaign and what they tell: against scipy's own distributions and closed forms."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from femstruct.campaign.samples import quantile, samples_of
from femstruct.errors import InputError
from femstruct.study.campaign.spread import spread, wilson
from femstruct.study.campaign.swept import Swept
from femstruct.study.campaign.varied import Campaign, Listed, Sampling, Scattered

NORMAL = Scattered("E", "normal", 30e9, 1.5e9, "Pa")


def drawn(*varied: Listed | Scattered, method: str = "latin hypercube", count: int = 64, seed: int = 1) -> Campaign:
    return Campaign("s.yaml", varied, Sampling(method, count, seed))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("one", "law"),
    [
        (NORMAL, scipy.stats.norm(30e9, 1.5e9)),
        (Scattered("a", "uniform", 2.0, 5.0), scipy.stats.uniform(2.0, 3.0)),
        (Scattered("a", "log-uniform", 2.0, 50.0), scipy.stats.loguniform(2.0, 50.0)),
    ],
    ids=lambda value: value.law if isinstance(value, Scattered) else "",
)
def test_quantiles_are_those_of_scipy(one: Scattered, law: object) -> None:
    u = np.linspace(0.01, 0.99, 9)
    np.testing.assert_allclose(quantile(one, u), law.ppf(u), rtol=1e-13)  # type: ignore[attr-defined]  # rounding


def test_a_latin_hypercube_has_one_sample_in_every_stratum() -> None:
    found = samples_of(drawn(Scattered("a", "uniform", 0.0, 1.0), Scattered("b", "uniform", 0.0, 1.0), count=50))
    for column in found.numbers.T:
        assert sorted((50 * column).astype(int)) == list(range(50))


def test_samples_are_written_to_their_last_digit_and_hang_on_the_seed_alone() -> None:
    one, same, other = (samples_of(drawn(NORMAL, seed=seed, count=5)) for seed in (1, 1, 2))
    assert one.texts == same.texts and one.texts != other.texts
    assert [float(text.removesuffix(" Pa")) for (text,) in one.texts] == one.numbers[:, 0].tolist()


def test_the_first_points_of_sobol_are_balanced() -> None:
    found = samples_of(drawn(Scattered("a", "uniform", 0.0, 1.0), Listed("b", ("x", "y")), method="sobol", count=16))
    assert sorted((16 * found.numbers[:, 0]).astype(int)) == list(range(16))
    assert [text for _, text in found.texts].count("x") == 8


@pytest.mark.parametrize(("held", "of"), [(0, 5), (3, 7), (20, 20), (180, 200)])
def test_the_interval_of_a_share_is_that_of_scipy(held: int, of: int) -> None:
    expected = scipy.stats.binomtest(held, of).proportion_ci(0.95, method="wilson")
    assert wilson(held, of)[1:] == pytest.approx((expected.low, expected.high), abs=1e-9)  # its digits of the quantile


def rows(values: np.ndarray, numbers: np.ndarray) -> Swept:
    """Numbers [c, n] of one name over one path."""
    c, n = numbers.shape
    none: tuple[tuple[tuple[str, ...], ...], ...] = tuple(tuple(() for _ in range(n)) for _ in range(c))
    return Swept(
        title="t",
        paths=("a",),
        units=("kg",),
        texts=tuple((repr(float(one)),) for one in values),
        values=values[:, None],
        method="sobol",
        cases=("one", "two")[:c],
        baseline="one",
        names=("y",),
        number_units=("m",),
        main=("y",),
        numbers=numbers[:, :, None],
        done=np.ones(n, dtype=bool),
        severe=none,
        findings=none,
        trouble=("",) * n,
        limits={"y": 1.0},
    )


def test_scatter_of_a_linear_answer_is_that_of_its_cause() -> None:
    x = samples_of(drawn(Scattered("a", "normal", 1.0, 0.1, "kg"), count=1000)).numbers[:, 0]
    found = spread(rows(x, np.stack([2.0 - x, 2.0 - x + 0.5])), "y")
    assert found is not None and found.held is not None
    # a stratified sample of 1000: mean and quantiles to a small part of their scatter
    assert found.mean == pytest.approx(1.0, abs=1e-3) and found.deviation == pytest.approx(0.1, rel=0.01)
    assert found.quantiles == pytest.approx((1.0 - 0.16449, 1.0, 1.0 + 0.16449), abs=2e-3)  # two strata of 1000
    assert found.follows == (pytest.approx(-1.0),) and found.held[0] == pytest.approx(0.5, abs=0.002)  # two samples


def test_the_difference_of_two_cases_has_its_own_scatter() -> None:
    x = np.linspace(0.0, 1.0, 20)
    found = spread(rows(x, np.stack([x, x + 0.5])), "y", "two", above="one")
    assert found is not None
    assert found.mean == pytest.approx(0.5) and found.deviation < 1e-12 and found.limit is None  # rounding


def test_samples_that_are_not_to_be_trusted_are_left_out() -> None:
    x = np.arange(10.0)
    bad = tuple(("unsound",) if i in (3, 4) else () for i in range(10))
    whole = rows(x, np.where(x == 7, np.nan, x)[None])
    found = spread(replace(whole, severe=(bad,)), "y")
    assert found is None  # seven are too few to say anything
    found = spread(replace(whole, severe=((("unsound",), *((),) * 9),)), "y")
    assert found is not None and (found.count, found.left_out) == (8, 2) and found.quantiles[0] > 1.0


def test_a_number_of_another_name_is_refused() -> None:
    with pytest.raises(InputError, match="expected a number of the study"):
        rows(np.arange(3.0), np.zeros((1, 3))).of("z")


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: Scattered("a", "uniform", 2.0, 1.0), "rising bounds"),
        (lambda: Scattered("a", "log-uniform", -1.0, 1.0), "logarithmic"),
        (lambda: Scattered("a", "normal", 1.0, 0.0), "deviation"),
        (lambda: Listed("a", ()), "no value"),
        (lambda: Listed("a", ("1", "2"), (1.0,)), "1 numbers"),
        (lambda: Sampling("grid", 3), "a count for a grid"),
        (lambda: Sampling("sobol"), "no count"),
        (lambda: Campaign("s", ()), "nothing that varies"),
        (lambda: Campaign("s", (Listed("a", ("1",)), Listed("a", ("1",)))), "varies twice"),
        (lambda: Campaign("s", (NORMAL,)), "a distribution without a number of samples"),
        (lambda: Campaign("s", tuple(Listed(f"{i}", ("1",) * 100) for i in range(3))), "1e.06 samples"),
    ],
)
def test_what_makes_no_samples_is_refused(make: object, told: str) -> None:
    with pytest.raises(InputError, match=told):
        make()  # type: ignore[operator]
