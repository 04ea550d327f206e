"""The study of activated creep: what it reads off areas, against made ones, and the proof on its page."""

import math

import numpy as np
import pytest

import asperity as asp
from asperity_research.studies.activated_creep import (
    RISE,
    Steps,
    fall_with_velocity,
    growth_at_rest,
    time_of_growth,
    time_of_minimum,
)

P = asp.protocols
TIME = np.append(0.0, np.geomspace(1e-2, 1e5, 29))


def test_the_time_of_a_minimum_is_that_of_its_parabola():
    for place in (1.0, 2.3, 70.0):
        area = 100 * (1 - 0.2 * np.exp(-(np.log(np.append(1e-9, TIME[1:]) / place) ** 2) / 20))
        assert time_of_minimum(TIME, area) == pytest.approx(place, rel=0.1)


def test_a_fall_too_small_to_see_or_without_an_end_has_no_minimum():
    assert math.isnan(time_of_minimum(TIME, 100 + np.log1p(TIME)))
    assert math.isnan(time_of_minimum(TIME, 100 - np.log1p(TIME)))
    assert math.isnan(time_of_growth(TIME, 100 - np.log1p(TIME)))


def test_growth_counts_from_the_smallest_area():
    """Areas that fall to 80 and then grow by 2 an e-fold, from the time 10 on: 3 % of 80 are 1.2 e-folds."""
    area = np.where(TIME > 5, 80 + 2 * np.log(np.maximum(TIME, 10.0) / 10), 80.0)
    area[0] = 100.0
    rise = (RISE - 1) * 80 / 2
    assert time_of_growth(TIME, area) == pytest.approx(10 * math.exp(rise), rel=0.05)


@pytest.mark.parametrize("power", [0.3, 1.0])
def test_the_power_of_the_waiting_time_is_found_again(power):
    wait = np.array([1e-4, 1e-2, 1.0, 10.0])
    surfaces = np.arange(1, 5)[:, np.newaxis]
    start = 3 * surfaces * wait ** (power - 1)  # of growth, over the waiting time
    area = 100 + 20 * np.log1p(TIME / start[:, :, np.newaxis])
    steps = Steps("lattice", 0.5, wait, 200.0, TIME, np.full(start.shape, 100.0), area)
    found = steps.power(time_of_growth)
    assert found is not None
    assert found.value == pytest.approx(power, abs=0.02)
    assert steps.power(time_of_minimum) is None


def test_the_estimate_of_the_time_of_growth_is_that_of_two_mean_forces():
    """200 over 100 and half of it over 80 contacts: forces of 2 and 1.25, with s0 = 0.05."""
    area = np.full((3, 2, TIME.size), 80.0)
    steps = Steps("lattice", 0.5, np.array([1.0, 10.0]), 200.0, TIME, np.full((3, 2), 100.0), area)
    np.testing.assert_allclose(steps.estimated(steps.before, steps.area), (2 - 1.25) / 0.05)


def test_the_growth_at_rest_is_found_again():
    temperature, time = np.array([0.02, 0.04]), np.geomspace(1.0, 1e5, 6)
    one = 1 + temperature[:, np.newaxis] * np.log(time)
    rest = np.stack([one * part for part in (0.99, 1.0, 1.01)])
    steady = np.tile(100 * (1 - 0.1 * np.log([1.0, 100.0, 0.01])), (3, 2, 1))
    np.testing.assert_allclose(growth_at_rest(time, rest), temperature, rtol=1e-9)
    np.testing.assert_allclose(fall_with_velocity(steady), 0.1, rtol=1e-9)


def _smallest_over_first(solid, heights, load, wait=1.0):
    contact = asp.press(heights, solid, load=load)
    protocol = [P.Hold(wait), P.Step(load=0.2 * load), P.Hold(100.0)]
    dataset = asp.age(contact, wait + np.geomspace(1e-3, 10.0, 13), protocol=protocol, rtol=1e-2).dataset
    after = dataset["area"].values[dataset["leg"].values >= 1]
    return after.min() / after[0]


@pytest.mark.parametrize("creep", [asp.solids.Eyring(rate=0.02, stress=0.05), asp.solids.Norton(1.0, 0.3, 3)])
def test_no_contact_is_lost_where_all_of_the_stiffness_creeps(creep):
    heights = asp.surfaces.spectral((16, 16), hurst=0.8, roll_off=8.0, cutoff=4.0, rms_height=1.0, seed=2)
    bed = asp.solids.spring_lattice(k0=0.0, k1=3.0, R=0.0, creep=creep)
    assert _smallest_over_first(bed, heights, 50.0) == 1.0
    half_space = asp.solids.half_space(modulus=1.0, creep=creep)
    assert _smallest_over_first(half_space, heights, 30.0) == 1.0
    lattice = asp.solids.spring_lattice(k0=1.0, k1=3.0, R=0.0, creep=creep)
    assert _smallest_over_first(lattice, heights, 50.0) < 0.95
