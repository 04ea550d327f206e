"""Friction under a normal stress that changes: own integration of shear stress and theta; closed forms."""

import csv
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import asperity as asp
from asperity.friction.loading import Drive
from asperity.friction.normal_stress import NormalStress
from asperity.friction.slider import Shape, follow
from tests.refusals import refuses

F = asp.friction
UM = 1e-6
TRUTH = {"a": 0.008, "b": 0.010, "D_c": 10.0, "k": 0.01, "alpha": 0.25}
SPEEDS, LASTS = [1.0, 10.0, 10.0], [40.0, 30.0, 40.0]
STRESS = np.array([[0.0, 60.0, 60.1, 85.0, 85.1, 110.0], [50.0, 50.0, 52.5, 52.5, 50.0, 50.0]])
STEP = 0.1


def pulled(law, speeds=SPEEDS, lasts=LASTS, stress=STRESS):
    """Times, normal stress (MPa), friction and load point (um) of a slider that a spring pulls.

    The state is the shear stress tau and ln theta. V follows from tau/sigma, and sigma enters d tau/dt and
    d theta/dt alone, as Linker and Dieterich (1992) print them.
    """
    a, b, D_c, k, alpha = TRUTH.values()
    ends = np.append(0.0, np.cumsum(lasts))
    time = np.arange(0.0, ends[-1] + STEP / 2, STEP)
    sigma, first = np.interp(time, *stress), speeds[0]
    cuts, y, states = np.union1d(ends, stress[0]), np.array([0.6 * sigma[0], np.log(D_c / first)]), []
    for start, end in pairwise(cuts):
        speed = speeds[np.searchsorted(ends, (start + end) / 2) - 1]
        low, high = np.interp([start, end], *stress)
        rises = (high - low) / (end - start)

        def rate(t, y, speed=speed, rises=rises, low=low, start=start):
            pressed = low + rises * (t - start)
            v = first * np.exp((y[0] / pressed - 0.6 - b * (y[1] + np.log(first / D_c))) / a)
            grown = np.exp(-y[1]) - v / D_c if law == "aging" else -v / D_c * (np.log(v / D_c) + y[1])
            return [k * sigma.mean() * (speed - v), grown - alpha / b * rises / pressed]

        inside = (time >= start) & ((time < end) | (end == cuts[-1]))
        at = np.unique(np.append(time[inside], end))
        found = solve_ivp(rate, (start, end), y, t_eval=at, method="LSODA", rtol=1e-10, atol=1e-12)
        states.append(found.y[0, : inside.sum()])
        y = found.y[:, -1]
    place = np.interp(time, ends, np.append(0.0, np.cumsum(np.multiply(speeds, lasts))))
    return time, sigma, np.concatenate(states) / sigma, place


def measured(law, seed, **how):
    """That record with noise of 0.02 % in the normal stress, 3 % of D_c in the load point, and 4e-4."""
    time, sigma, friction, place = pulled(law, **how)
    rng = np.random.default_rng(seed)
    friction = friction + 4e-4 * rng.standard_normal(time.size)
    place = place + 0.3 * rng.standard_normal(time.size)
    sigma = sigma + 0.01 * rng.standard_normal(time.size)
    normal = sigma / sigma.mean()
    return F.Record.of_machine(time, friction, load_point=UM * place, normal=normal, units=("s", "um"))


@pytest.mark.parametrize("law", ["aging", "slip"])
def test_the_course_of_a_slider_is_that_of_shear_stress_and_theta(law):
    time, sigma, friction, _ = pulled(law)
    normal = NormalStress(STRESS[0], STRESS[1] / sigma.mean(), 0.6)
    shape = Shape(TRUTH["a"], TRUTH["b"], TRUTH["D_c"] * UM, TRUTH["k"] / UM, TRUTH["alpha"])
    drive = Drive(np.array([40.0]), UM * np.array([1.0, 10.0]), np.array([STEP]))
    course = follow(law, shape, drive, time, normal=normal)
    np.testing.assert_allclose(0.6 + course.elastic(shape), friction, atol=1e-8)


ONE_VELOCITY: dict[str, Any] = {"speeds": [10.0], "lasts": [110.0]}
"""As Linker and Dieterich measured it."""


@pytest.mark.parametrize(
    ("law", "how", "given", "most"),
    [("aging", {}, "0.01 / um", 0.1), ("slip", {}, "fit", 0.1), ("slip", ONE_VELOCITY, None, 3.0)],
    ids=["stiffness given", "stiffness fitted", "one velocity"],
)
def test_a_record_gives_alpha_and_the_other_parameters(law, how, given, most):
    fit = F.rate_and_state(measured(law, 0, **how), law=law, stiffness=given)
    assert fit.determined
    for name, unit in (("a", 1.0), ("b", 1.0), ("D_c", UM), ("alpha", 1.0)):
        assert abs(getattr(fit, name) - unit * TRUTH[name]) < 3 * getattr(fit, f"{name}_stderr")
        # Rows of 0.1 s do not show when within them a ramp of 0.1 s begins.
        assert getattr(fit, f"{name}_stderr") < most * getattr(fit, name)
    assert fit.parameters.alpha == fit.alpha


def test_at_a_prescribed_velocity_friction_falls_by_alpha_and_recovers_over_D_c():
    """Slip law: -alpha ln(sigma_2/sigma_1) exp(-slip/D_c)."""
    law = F.RateAndState(law="slip", a=0.01, b=0.012, D_c=2.0, mu_0=0.6, V_0=1.0, alpha=0.3)
    time = np.linspace(0.0, 20.0, 201)
    normal = np.where(time > 5.0, 1.2, 1.0)
    found = law.friction(time, np.ones(201), normal=normal)
    late = time > 5.0
    np.testing.assert_allclose(found[~late], 0.6, atol=1e-14)
    np.testing.assert_allclose(
        found[late] - 0.6, -0.3 * np.log(1.2) * np.exp((5 - time[late]) / 2), atol=1e-14
    )
    aging = F.RateAndState(a=0.01, b=0.012, D_c=2.0, mu_0=0.6, V_0=1.0, alpha=0.3)
    theta = aging.state(time, np.ones(201), normal=normal)
    assert theta[51] == pytest.approx(2 + (2 * 1.2 ** (-0.3 / 0.012) - 2) * np.exp(-0.1 / 2), rel=1e-12)


def test_a_table_with_steps_is_read_fitted_and_written(here):
    time, sigma, friction, place = pulled("slip")
    noise = 4e-4 * np.random.default_rng(0).standard_normal(time.size)
    columns = np.column_stack([time, place, (friction + noise) * sigma, sigma])
    header = "time_s,load_point_um,shear_stress_MPa,normal_stress_MPa"
    np.savetxt("steps.csv", columns, delimiter=",", header=header, comments="")
    record = F.read_record("steps.csv")
    with refuses("stiffness", "inf"):
        F.rate_and_state(record, stiffness="inf")
    laws = F.compare_state_laws(record)
    assert laws.preferred == "slip"
    assert any(row.name == "  alpha" and "at least 95 %" in row.words() for row in laws.rows())
    F.save_parameters(laws, "found.csv")
    first, *_ = csv.DictReader(Path("found.csv").read_text().splitlines())
    assert float(first["alpha_low"]) < TRUTH["alpha"] < float(first["alpha_high"])
    F.save_parameters(laws, "found.toml")
    assert "alpha" in Path("found.toml").read_text().partition("[intervals_at_least_95]")[2]
    columns[3, 3] = -1.0
    np.savetxt("wrong.csv", columns, delimiter=",", header=header, comments="")
    with refuses("wrong.csv", "-1"):
        F.read_record("wrong.csv")


def test_intervals_count_that_rows_do_not_show_when_the_normal_stress_turns():
    """Ramps of 0.1 s between rows of 0.1 s: the record tells their ends to a row only."""
    off = []
    for seed in range(6):
        rng = np.random.default_rng(seed)
        shape = Shape(0.008, 0.010, 10 * UM, 0.012 / UM, 0.25)
        drive = Drive(np.array([40.0]), UM * np.array([1.0, 10.0]), np.array([STEP]))
        time = np.append(0.0, np.arange(rng.uniform(0.02, 0.08), 110.0, STEP))
        sigma = np.interp(time, *STRESS)
        normal = NormalStress(STRESS[0], STRESS[1] / sigma.mean(), 0.6)
        friction = 0.6 + follow("slip", shape, drive, time, normal=normal).elastic(shape)
        friction, place = (
            values + scale * rng.standard_normal(time.size)
            for values, scale in ((friction, 4e-4), (drive.place(time), 0.3 * UM))
        )
        record = F.Record.of_machine(time, friction, load_point=place, normal=sigma / sigma.mean())
        fit = F.rate_and_state(record, law="slip", stiffness="fit")
        assert isinstance(fit, F.MachineFit)
        k_off = np.log(fit.stiffness / shape.k) * fit.stiffness / fit.stiffness_stderr
        off.append([k_off, (fit.alpha - shape.alpha) / fit.alpha_stderr])
    assert (np.sqrt(np.mean(np.square(off), axis=0)) < 2).all()
