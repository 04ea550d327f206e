"""What the study of the sizes of patches computes, against samples of known laws and growth by hand."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.special import zeta

from asperity_research.studies.patch_sizes import SMALLEST, Laws, growth, overlap, sums_of

LARGEST = 4096
SIZES = np.arange(SMALLEST, LARGEST + 1.0)


def sample(weights, count, seed=0):
    return np.random.default_rng(seed).choice(SIZES, p=weights / weights.sum(), size=count).astype(int)


def fitted(sizes):
    return Laws.of(sums_of(sizes)[None], LARGEST)


def test_the_laws_that_made_the_samples_are_found_and_preferred():
    cut = fitted(sample(SIZES**-1.5 * np.exp(-SIZES / 200), 20_000))
    assert cut.cut.exponent == pytest.approx(1.5, abs=0.06)
    assert 1 / cut.cut.second == pytest.approx(200, rel=0.1)
    assert cut.cut.likelihood > max(cut.lognormal.likelihood, cut.power.likelihood) + 1e-3
    logs = np.log(SIZES)
    log = fitted(sample(np.exp(-((logs - 4) ** 2) / 1.6) / SIZES, 20_000))
    assert log.lognormal.second == pytest.approx(1 / 1.6, rel=0.1)
    assert log.lognormal.exponent == pytest.approx(1 - 8 / 1.6, rel=0.1)
    assert log.lognormal.likelihood > log.cut.likelihood + 1e-3


def test_a_power_law_is_that_of_the_zeta_function_and_of_a_search():
    # With no end, the norm is Hurwitz's zeta function; here almost: tau = 3.5.
    sizes = sample(SIZES**-3.5, 5000)
    found = fitted(sizes).power

    def lack(tau):
        return tau[0] * np.log(sizes).mean() + np.log(zeta(tau[0], SMALLEST))

    search = minimize(lack, [2.0], method="Nelder-Mead", options={"xatol": 1e-8, "fatol": 1e-12})
    assert found.exponent == pytest.approx(search.x[0], abs=1e-3)
    assert found.likelihood == pytest.approx(-search.fun, abs=1e-4)


def test_no_law_grows_with_size_beyond_a_power():
    rising = SIZES**-2 * np.exp(SIZES / LARGEST)
    found = fitted(sample(rising, 50_000))
    assert found.cut.second == 0
    assert found.cut.exponent == pytest.approx(found.power.exponent, rel=1e-12)
    assert found.cut.likelihood == pytest.approx(found.power.likelihood, rel=1e-12)


def test_growth_by_hand_and_its_balance():
    before = np.zeros((6, 8), dtype=bool)
    after = before.copy()
    before[1, 0:3] = True  # loses 1 of 3 sites, gains 2, and meets ...
    before[1, 4:5] = True  # ... a patch of 1 site
    before[4, 4] = True  # goes
    after[1, 1:6] = True
    after[4, 0:2] = True  # new
    sizes, net, born = growth(before, after)
    # 5 sites come from 2 and 1 that are kept: 10/3 and 5/3.
    assert sizes.tolist() == [3, 1, 1]
    np.testing.assert_allclose(net, [10 / 3 - 3, 5 / 3 - 1, -1])
    assert born == 2
    rng = np.random.default_rng(1)
    for _ in range(20):
        one, other = rng.random((2, 12, 12)) < 0.4
        _, net, born = growth(one, other)
        assert net.sum() + born == pytest.approx(other.sum() - one.sum())


def test_an_overlap_holds_the_highest_sites():
    heights = np.random.default_rng(2).normal(size=(9, 9))
    touching = overlap(heights, 20)
    assert touching.sum() == 20
    assert heights[touching].min() > heights[~touching].max()
