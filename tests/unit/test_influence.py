"""Sobol' indices of a campaign: the Ishigami function in closed form, and scipy's own estimates."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from femstruct.campaign.tasks import samples_of
from femstruct.errors import InputError
from femstruct.study.campaigns import Campaign, Sampling, Scattered, Swept, influences, spread

ANGLES = tuple(Scattered(f"x{j}", "uniform", -np.pi, np.pi) for j in range(3))


def ishigami(x: np.ndarray) -> np.ndarray:
    """Ishigami and Homma (1990), a = 7, b = 0.1; x [n, 3]."""
    return np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


def swept(count: int) -> Swept:
    found = samples_of(Campaign("s", ANGLES, Sampling("sobol indices", count)))
    n = len(found.texts)
    none = (tuple(() for _ in range(n)),)
    return Swept(
        title="t",
        paths=found.paths,
        units=found.units,
        texts=found.texts,
        values=found.numbers,
        method="sobol indices",
        cases=("a",),
        baseline="a",
        names=("f",),
        number_units=("",),
        main=("f",),
        numbers=ishigami(found.numbers)[None, :, None],
        done=np.ones(n, dtype=bool),
        severe=none,
        findings=none,
        trouble=("",) * n,
    )


def test_the_ishigami_function() -> None:
    a, b, square = 7.0, 0.1, np.pi**4
    first, second, both = 0.5 * (1.0 + b * square / 5.0) ** 2, a * a / 8.0, b * b * square**2 * 8.0 / 225.0
    variance = first + second + both
    rows = swept(2048)
    found = influences(rows, "f")
    for one, alone, total in zip(found, (first, second, 0.0), (first + both, second, both), strict=True):
        assert one.alone[0] == pytest.approx(alone / variance, abs=0.02)  # asked for; 1 / sqrt(2048)
        assert one.total[0] == pytest.approx(total / variance, abs=0.02)  # the same
        assert one.alone[1] <= one.alone[0] <= one.alone[2] and one.total[1] <= one.total[0] <= one.total[2]
    told = spread(rows, "f")
    assert told is not None and told.count == 4096  # A and B alone
    assert told.mean == pytest.approx(a / 2.0, rel=0.01)  # 1 / sqrt(4096)
    assert told.deviation**2 == pytest.approx(variance, rel=0.02)  # the same


def test_the_estimates_are_those_of_scipy() -> None:
    rows = swept(256)
    values = rows.of("f").reshape(5, -1)
    expected = scipy.stats.sobol_indices(
        func={"f_A": values[0][None], "f_B": values[1][None], "f_AB": values[2:, None]}, n=256
    )
    found = influences(rows, "f")
    np.testing.assert_allclose([one.alone[0] for one in found], expected.first_order, rtol=1e-10)  # rounding
    np.testing.assert_allclose([one.total[0] for one in found], expected.total_order, rtol=1e-10)  # rounding


def test_a_sample_that_is_not_to_be_trusted_goes_with_all_its_rows() -> None:
    rows = swept(64)
    numbers = rows.numbers.copy()
    numbers[0, 64 * 3 + 5, 0] = 1e9
    severe = (tuple(("unsound",) if i == 64 * 3 + 5 else () for i in range(64 * 5)),)
    spoilt = influences(replace(rows, numbers=numbers, severe=severe), "f")
    assert all(one.total[0] < 2.0 for one in spoilt) and influences(replace(rows, method="sobol"), "f") == ()


def test_a_count_that_is_no_power_of_two_is_refused() -> None:
    with pytest.raises(InputError, match="write 64 or 128"):
        Sampling("sobol indices", 100)
