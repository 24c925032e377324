"""Samples of a campaign and what they tell: against scipy's own distributions and closed forms."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from femstruct.campaign.tasks import quantile, samples_of
from femstruct.errors import InputError
from femstruct.study.campaigns import (
    Campaign,
    Listed,
    Sampling,
    Scattered,
    Swept,
    held_limits,
    limit_name,
    spread,
    verdict_name,
    wilson,
)

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
    assert found is not None
    # a stratified sample of 1000: mean and quantiles to a small part of their scatter
    assert found.mean == pytest.approx(1.0, abs=1e-3) and found.deviation == pytest.approx(0.1, rel=0.01)
    assert found.quantiles == pytest.approx((1.0 - 0.16449, 1.0, 1.0 + 0.16449), abs=2e-3)  # two strata of 1000
    assert found.follows == (pytest.approx(-1.0),)  # its negative


def test_the_difference_of_two_cases_has_its_own_scatter() -> None:
    x = np.linspace(0.0, 1.0, 20)
    found = spread(rows(x, np.stack([x, x + 0.5])), "y", "two", above="one")
    assert found is not None
    assert found.mean == pytest.approx(0.5) and found.deviation < 1e-12  # rounding


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


def judged(limits: np.ndarray, verdicts: np.ndarray) -> Swept:
    """Rows of one number with limits and verdicts [c, n]."""
    bare = rows(np.arange(float(limits.shape[1])), np.zeros_like(limits))
    numbers = np.stack([bare.numbers[:, :, 0], limits, verdicts], axis=-1)
    names = ("y", limit_name("y"), verdict_name("y"))
    return replace(bare, names=names, number_units=("m", "m", "1"), numbers=numbers)


def test_a_limit_is_judged_by_the_verdict_of_each_run() -> None:
    """Limits of each case and sample; 12 of 20 hold, which is 60 % in the interval that scipy has for it."""
    verdicts = np.array([[1.0] * 12 + [0.0] * 8, [1.0] * 20])
    limits = np.stack([np.full(20, 2.0), np.linspace(1.0, 3.0, 20)])
    one, two = held_limits(judged(limits, verdicts), ["y"])
    expected = scipy.stats.binomtest(12, 20).proportion_ci(0.95, method="wilson")
    assert (one.case, one.limits, one.held, one.exceeded, one.unknown, one.share) == ("one", (2.0, 2.0), 12, 8, 0, 0.6)
    assert (one.low, one.high) == pytest.approx((expected.low, expected.high), abs=1e-9)  # its digits of the quantile
    assert (two.case, two.limits, two.held, two.count) == ("two", (1.0, 3.0), 20, 20)


def test_samples_that_cannot_be_judged_widen_the_share() -> None:
    """5 held, 3 exceeded, 2 not known: between 5 and 7 of 10; a case without the limit has no row."""
    verdicts = np.array([[1.0] * 5 + [0.0] * 3 + [-1.0] * 2, [np.nan] * 10])
    (one,) = held_limits(judged(np.where(np.isfinite(verdicts), 2.0, np.nan), verdicts), ["y"])
    assert (one.held, one.exceeded, one.unknown) == (5, 3, 2) and np.isnan(one.share)
    assert (one.low, one.high) == (wilson(5, 10)[1], wilson(7, 10)[2])


def test_what_is_not_to_be_trusted_is_not_judged() -> None:
    verdicts = np.ones((1, 10))
    whole = judged(np.ones((1, 10)), verdicts)
    (one,) = held_limits(replace(whole, severe=((("unsound",), *((),) * 9),)), ["y"])
    assert one.count == 9


def test_times_to_rest_that_are_not_seen_are_longer_than_all_others() -> None:
    """Of 1 .. 20 s only those below 15.5 s end in the window: the median is known, 95 % and the mean are not."""
    x = np.arange(1.0, 21.0)
    seen = replace(rows(x, np.where(x > 15.5, np.nan, x)[None]), names=("settled",), limits={})
    found = spread(seen, "settled")
    assert found is not None and (found.count, found.left_out, found.longer) == (20, 0, 5)
    assert found.quantiles[:2] == (np.quantile(x, 0.05), np.quantile(x, 0.5)) and np.isnan(found.quantiles[2])
    assert np.isnan(found.mean) and np.isnan(found.deviation) and found.follows[0] > 0.98  # all but ties of five
    other = replace(seen, names=("y",))
    bare = spread(other, "y")
    assert bare is not None and (bare.count, bare.left_out, bare.longer) == (15, 5, 0)


def test_a_difference_of_times_to_rest_is_none_where_one_is_not_seen() -> None:
    x = np.arange(1.0, 21.0)
    both = replace(rows(x, np.stack([x, np.where(x > 15.5, np.nan, x)])), names=("settled",), limits={})
    assert spread(both, "settled", "two", above="one") is None
    assert spread(both, "settled", "one", above="one") is not None


def test_a_difference_is_of_samples_that_are_to_be_trusted_in_both_cases() -> None:
    x = np.linspace(0.0, 1.0, 20)
    whole = rows(x, np.stack([x, x + 0.5]))
    bad = tuple(("unsound",) if i < 4 else () for i in range(20))
    found = spread(replace(whole, severe=(bad, ((),) * 20)), "y", "two", above="one")
    assert found is not None and (found.count, found.left_out) == (16, 4)
