"""The force at a held displacement after a partial release: its maximum, and that of superposition."""

import math

import numpy as np

import asperity as asp
from asperity_research.studies.release import maximum, superposed

P = asp.protocols


def test_the_superposed_maximum_of_a_modulus_like_a_logarithm_is_a_fixed_multiple_of_the_wait():
    # E = c - ln t: E(t + w) - f E(t) is greatest at t = w f/(1 - f).
    series = asp.relaxation.PronySeries(1.0, tuple((0.01, time) for time in np.geomspace(1e-8, 1e12, 81)))
    for wait in (1.0, 100.0):
        for fall in (0.1, 0.4):
            assert abs(superposed(series, wait, fall) / wait / (fall / (1 - fall)) - 1) < 0.01


def test_one_relaxation_time_gives_no_maximum():
    assert math.isnan(superposed(asp.relaxation.PronySeries(1.0, ((0.75, 10.0),)), 10.0, 0.1))


def test_a_maximum_is_that_of_the_parabola_in_the_logarithm_of_time():
    time = np.geomspace(1e-2, 1e2, 33)
    assert abs(maximum(time, -(np.log(time / 3.3) ** 2)) - 3.3) < 1e-9
    assert math.isnan(maximum(time, time))
    assert math.isnan(maximum(time, -time))


def test_the_force_at_a_held_displacement_is_smooth():
    rough = asp.surfaces.spectral((48, 48), hurst=0.8, roll_off=24.0, cutoff=4.0, rms_height=1.0, seed=0)
    branches = [(0.03, 10.0**k) for k in range(-6, 7)]
    solid = asp.solids.half_space(modulus=1.0, branches=branches, apparatus=np.inf)
    contact = asp.press(rough, solid, separation=0.5)
    times = np.append(1.0, 1.0 + np.geomspace(0.01, 30.0, 29))
    legs = [P.Hold(1.0), P.Step(approach=-0.1), P.Hold(30.0)]
    usual, accurate = (asp.age(contact, times, protocol=legs, rtol=rtol)["load"] for rtol in (2e-3, 2e-4))
    assert abs(usual - accurate).max() < 1e-4 * contact.load
