"""Shear strength that grows with the age of each site in contact, beside the area."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import asperity as asp
from asperity.analysis.rows import friction_rows
from tests.refusals import each_refuses
from tests.surfaces import correlated

P = asp.protocols
S: Any = asp.friction.ShearStrength
AGED = S(0.5, growth=0.02, after=0.1, renewal=3.0)
NEW = S(0.5, growth=0.02, after=1e-7, renewal=3.0)
"""Its state is as good as never far below the onset."""
SPRINGS = asp.solids.spring_lattice(k0=1.0, k1=3.0)
MAXWELL = asp.solids.half_space(modulus=1.0, branches=[(0.2, 10.0**n) for n in range(-1, 3)])
RELAXES = asp.press(correlated(32), MAXWELL, load=20.0)
GROWS = asp.press(correlated(32), SPRINGS, load=150.0)


def punch():
    """A flat square that is pressed onto an elastic half-space: its contacts never change."""
    heights = np.full((16, 16), -1.0)
    heights[4:10, 5:12] = 0.0
    return asp.press(heights, asp.solids.half_space(modulus=1.0), load=0.1)


FLAT = punch()
OVER_LOAD = FLAT.contact_area_corrected / FLAT.load


def aged(contact, times, law=AGED, **how):
    return asp.age(contact, times, carried=asp.Carried(strength=law), **how).dataset


@pytest.mark.parametrize("solid", [SPRINGS, MAXWELL], ids=["springs", "half-space"])
def test_without_growth_all_is_what_it_was(solid):
    contact, slide = asp.press(correlated(16), solid, load=5.0), P.Slide(3.0, velocity=2.0)
    how: dict[str, Any] = {"protocol": [slide, P.Hold(10.0), P.Step(load=4.0), slide]}
    plain = asp.friction.add_friction(asp.age(contact, [1.0, 5.0], **how).dataset, 0.5)
    for law in (S(0.5), S(0.5, growth=0.0, after=0.1, renewal=3.0)):
        found = aged(contact, [1.0, 5.0], law, **how)
        for name, values in plain.variables.items():
            np.testing.assert_array_equal(found[name], values)
        np.testing.assert_array_equal(found["friction_by_area"], plain["friction"])
        assert (found["strength_mean"] == 0.5).all()
        assert ("contact_age_mean" in found) == law.ages


def test_a_contact_that_does_not_change_strengthens_by_the_logarithm():
    found = aged(FLAT, np.geomspace(1e-2, 1e4, 13))
    t = found["time"].values
    strength = 0.5 * (1 + 0.02 * np.log1p(t / 0.1))
    np.testing.assert_allclose(found["strength_mean"], strength, rtol=1e-12)
    np.testing.assert_allclose(found["friction"], strength * OVER_LOAD, rtol=1e-12)
    np.testing.assert_allclose(found["contact_age_mean"], t, rtol=1e-12)
    assert found["strength_mean"].attrs["units"] == "force unit / length unit^2"


def test_in_steady_sliding_contacts_are_as_old_as_slip_over_velocity():
    steady = []
    for velocity in (1.0, 0.1):
        found = aged(FLAT, [0.0], NEW, protocol=P.Slide(100.0, velocity=velocity))
        assert found["contact_age_mean"][-1] == pytest.approx(3.0 / velocity, rel=1e-12)
        steady.append(float(found["friction"][-1]))
        assert steady[-1] == pytest.approx(0.5 * OVER_LOAD * (1 + NEW.settled(velocity)), rel=1e-12)
    # d mu / d ln V = -beta mu_0, where D / V is far above the onset.
    assert (steady[0] - steady[1]) / np.log(10) == pytest.approx(-0.02 * 0.5 * OVER_LOAD, rel=1e-7)


LEGS: list[Any] = [
    P.Slide(60.0, 0.2),
    P.Slide(30.0, 2.0),
    P.Slide(60.0, 0.2),
    P.Hold(1000.0),
    P.Slide(30.0, 0.2),
]


def ages_by_dieterich(times, spans):
    """The age at rising times, of spans (velocity, duration), by an integrator."""
    age, begun, found = 0.0, 0.0, np.full(len(times), np.nan)
    for velocity, duration in spans:
        span, per_age = (begun, begun + duration), velocity / AGED.renewal
        solved: Any = solve_ivp(
            lambda _, theta, per_age: 1 - per_age * theta,
            span,
            [age],
            args=(per_age,),
            rtol=1e-11,
            atol=1e-13,
            dense_output=True,
        )
        inside = (times >= span[0]) & (times <= span[1] * (1 + 1e-12))
        found[inside] = solved.sol(np.minimum(times[inside], span[1]))[0]
        age, begun = solved.y[0, -1], span[1]
    return found


def test_slides_and_holds_of_a_flat_patch_follow_dieterichs_law_and_give_its_numbers_back():
    found = aged(FLAT, [0.0], NEW, protocol=LEGS)
    age = ages_by_dieterich(
        found["time"].values, [(leg.speed, leg.distance / leg.speed if leg.speed else 1e3) for leg in LEGS]
    )
    np.testing.assert_allclose(found["contact_age_mean"], age, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(found["friction"], 0.5 * OVER_LOAD * (1 + NEW.grown(age)), rtol=1e-6)
    noise = np.random.default_rng(0).normal(0, 1e-3, found.sizes["time"])
    fit = asp.friction.rate_and_state(
        asp.friction.record_of(found.assign(friction=found["friction"] + noise)), law="aging"
    )
    for name, value in (("b", 0.02 * 0.5 * OVER_LOAD), ("D_c", 3.0)):
        low, high = fit.interval(name)
        assert low < value < high
        assert high - low < 0.01 * value


def test_a_slip_in_no_time_renews_and_ages_count_seconds_and_not_creep():
    legs = [P.Hold(10.0, mobility=100.0), P.Slide(2.0, velocity=np.inf), P.Hold(1.0)]
    found = aged(FLAT, [10.0], protocol=legs)["contact_age_mean"].values
    assert found[1] == 10.0
    np.testing.assert_allclose(found[-2:], [10 * np.exp(-2 / 3), 10 * np.exp(-2 / 3) + 1], rtol=1e-12)


@pytest.mark.parametrize("contact", [GROWS, RELAXES], ids=["springs", "half-space"])
def test_friction_of_a_growing_contact_is_the_sum_over_its_sites(contact):
    times = np.geomspace(1e-2, 1e2, 25)
    found = aged(contact, times, fields_at=[0.0, *times])
    touching, ages = found["in_contact"].values, found["site_age"].values
    assert np.array_equal(np.isfinite(ages), touching)
    assert found["area"][-1] > 1.3 * found["area"][0]
    area = found["contact_area_corrected" if contact is RELAXES else "area"].values / found["area"].values
    for n in range(len(times) + 1):
        forces = 0.5 * area[n] * (1 + 0.02 * np.log1p(ages[n][touching[n]] / 0.1))
        assert found["friction_force"][n] == pytest.approx(forces.sum(), rel=1e-12)
        assert found["contact_age_mean"][n] == pytest.approx(ages[n][touching[n]].mean(), rel=1e-12)
    assert (found["contact_age_mean"] < found["time"])[1:].all()


def test_a_site_is_as_old_as_it_has_touched():
    """Between two maps it began at some time; under a load that stays this solid loses no contact."""
    times = np.geomspace(1e-2, 1e2, 25)
    found = aged(RELAXES, times, fields_at=[0.0, *times])
    touching, ages = found["in_contact"].values, found["site_age"].values
    own = np.where(touching[0], 0.0, np.nan)
    for n, lapse in enumerate(np.diff([0.0, *times]), start=1):
        assert not (touching[n - 1] & ~touching[n]).any()
        latest = np.where(np.isnan(own), 0.0, own + lapse)
        earliest = np.where(np.isnan(own), lapse, own + lapse)
        inside = touching[n]
        assert (latest[inside] - 1e-12 <= ages[n][inside]).all()
        assert (ages[n][inside] <= earliest[inside] + 1e-12).all()
        own = ages[n]


def test_more_time_steps_change_little():
    times = np.geomspace(1e-2, 1e2, 9)
    usual, finer = (aged(GROWS, times, rtol=rtol)["strength_mean"].values for rtol in (2e-3, 2e-5))
    np.testing.assert_allclose(usual / 0.5 - 1, finer / 0.5 - 1, atol=0.02 * 0.1)


def test_a_site_that_opens_loses_its_age():
    legs = [P.Hold(10.0), P.Step(load=40.0), P.Step(load=150.0), P.Hold(1.0)]
    found = aged(GROWS, [10.0, 11.0], protocol=legs, fields_at=[10.0, 11.0])
    least = aged(GROWS, [10.0], protocol=legs[:2], fields_at=[10.0])["in_contact"].values[-1]
    held = found["in_contact"].values[0] & least
    after = found["site_age"].values[-1]
    assert held.any()
    np.testing.assert_array_equal(after[held & (found["site_age"].values[0] > 10)], 11.0)
    opened = found["in_contact"].values[-1] & ~least
    assert opened.any()
    assert (after[opened] <= 1.0).all()


@pytest.mark.parametrize("slide", [P.Slide(3.0, 2.0), P.Slide(2.0, 2.0, "-y")])
def test_ages_move_with_the_rough_surface(slide):
    found = aged(FLAT, [100.0], protocol=[P.Hold(100.0), slide], fields_at=[100.0, 100 + slide.duration])
    before, *_, after = found["site_age"].values
    shift = [int(found[f"field_shift_{axis}"][-1]) for axis in "yx"]
    kept = np.exp(-slide.distance / 3.0)
    expected = np.roll(before, shift, (0, 1)) * kept + 1.5 * (1 - kept)
    inside = found["in_contact"].values[-1]
    np.testing.assert_allclose(after[inside], expected[inside], rtol=1e-12)


def test_shifts_by_parts_of_a_site_renew_by_parts():
    whole = asp.press(np.zeros((8, 8)), asp.solids.spring_lattice(k0=1.0, k1=3.0), load=10.0)
    legs = [P.Hold(100.0), P.Slide(3.0, 2.0, substeps=4)]
    found = aged(whole, [100.0], protocol=legs)
    assert found["contact_age_mean"][-1] == pytest.approx(
        100 * np.exp(-1) + 1.5 * (1 - np.exp(-1)), rel=1e-12
    )


def test_growth_of_friction_is_that_of_the_area_and_that_of_the_strength():
    times = np.geomspace(1e-1, 1e3, 17)
    found = aged(GROWS, times)
    (row,) = friction_rows(found)
    parts = [float(word) for word in row.note.split() if word[0].isdigit()]
    mu, area, s = (found[name].values[[-5, -1]] for name in ("friction", "area", "strength_mean"))
    lapse = np.log(10.0)
    assert row.value == pytest.approx((mu[1] - mu[0]) / lapse, rel=1e-12)
    assert parts[0] == pytest.approx(s.mean() * (area[1] - area[0]) / 150.0 / lapse, rel=2e-3)
    assert parts[1] == pytest.approx(area.mean() / 150.0 * (s[1] - s[0]) / lapse, rel=2e-3)
    assert "protocol" not in found.attrs
    slid = aged(GROWS, [1.5, 11.5], protocol=[P.Slide(3.0, 2.0), P.Hold(10.0)])
    assert [row.name for row in friction_rows(slid)] == []
    slid = aged(GROWS, [4.5, 11.5], protocol=[P.Slide(3.0, 2.0), P.Hold(10.0)])
    assert [row.name for row in friction_rows(slid)] == ["growth of friction, leg 1"]
    (flat,) = friction_rows(aged(FLAT, times))
    assert "0 by the area" in flat.note


def test_steady_sliding_has_contacts_as_old_as_slip_over_velocity():
    how: dict[str, Any] = {"load": 5.0, "speeds": [0.1, 1.0]}
    plain, grown = (asp.steady_sliding(MAXWELL, correlated(16), shear_strength=s, **how) for s in (0.5, AGED))
    hysteresis = plain["hysteresis_friction_coefficient"].values
    ratio = (grown["friction_coefficient"] - hysteresis) / (plain["friction_coefficient"] - hysteresis)
    np.testing.assert_allclose(ratio[[0, -1]], 1 + 0.02 * np.log1p(np.array([30.0, 3.0]) / 0.1), rtol=1e-12)


def test_a_strength_with_both_a_velocity_and_an_age_adds_both():
    law = S(0.5, rate_coefficient=0.01, reference_velocity=1.0, growth=0.02, after=1e-7, renewal=3.0)
    found = aged(FLAT, [0.0], law, protocol=P.Slide(100.0, velocity=0.1))
    whole = 1 + 0.01 * np.log(0.1) + float(law.settled(0.1))
    assert found["friction"][-1] == pytest.approx(0.5 * OVER_LOAD * whole, rel=1e-12)


def test_wrong_strengths_are_refused():
    weak, zero_at = S(0.5, growth=-0.2, after=0.1, renewal=3.0), 0.1 * np.expm1(5.0)
    # After 30 of slip at 10, contacts are 0.3 old, and a little more.
    slow, legs = zero_at - 0.3 - 4.7 * np.exp(-10) + 8.0, [P.Hold(5.0), P.Slide(30.0, 10.0), P.Hold(50.0)]
    aged(FLAT, [14.0], weak)
    aged(FLAT, [0.0], weak, protocol=[P.Hold(10.0), P.Slide(30.0, np.inf), P.Hold(10.0)])
    plain, rough, carried = asp.age(FLAT, [1.0]).dataset, correlated(16), asp.Carried(strength=AGED)
    each_refuses(
        ("after", lambda: S(0.5, growth=0.02, after=0.0, renewal=1.0)),
        ("renewal", lambda: S(0.5, growth=0.02, after=1.0, renewal=-1.0)),
        ("growth", lambda: S(0.5, growth=0.02, renewal=1.0)),
        ("after", lambda: S(0.5, growth=0.02, after=1.0)),
        ("growth", aged, FLAT, [100.0], weak),
        ("growth", lambda: aged(FLAT, [5.0], weak, protocol=legs)),
        ("strength", lambda: asp.Carried(strength=0.5)),  # type: ignore[arg-type]
        ("strength", lambda: asp.law(MAXWELL, rough, pressures=[0.1, 0.2], times=[1.0], carried=carried)),
        ("strength", lambda: asp.predict(MAXWELL, rough, load=1.0, carried=carried)),
        ("shear_strength", asp.friction.add_friction, plain, AGED),
        ("units", aged, FLAT, [1.0], S("0.5 Pa", growth=0.02, after="0.1 s", renewal="3 um")),
        got="0 | -1 | none | none | "
        f"one that is 0 at time {zero_at:.4g} | one that is 0 at time {slow:.4g} | float |  |  | "
        "one that does | '0.5 Pa'",
    )


@pytest.mark.slow
def test_at_a_constant_area_friction_grows_by_the_falling_load_and_by_the_strength():
    """The numbers of docs/experiments.md, beside T. Pilvelait et al. (2020)."""
    table = Path(__file__).parents[2] / "docs/data/pmma_like_relaxation.csv"
    pmma = asp.relaxation.material(table, poisson=0.38).solid
    heights = asp.surfaces.spectral((64, 64), hurst=0.8, roll_off=32.0, cutoff=8.0, rms_height=1.0, seed=0)
    scan = asp.surfaces.Surface(heights, unit="um", pixel_size=(10.0, 10.0), length_unit="um")
    contact = asp.press(scan, pmma, pressure="5 MPa")
    legs, times = [P.Hold(1.0), P.Hold(2999.0, hold="area")], np.geomspace(1, 3e3, 9)
    grown = {}
    for growth in (0.0, 0.01):
        found = aged(
            contact, times, S("100 MPa", growth=growth, after="0.1 s", renewal="1 um"), protocol=legs
        )
        late = found.isel(time=found["time"] >= 10)
        assert np.ptp(found["area"].values[1:]) <= 0.005 * found["area"].values[1]
        for name in ("friction", "friction_force"):
            slope = np.polyfit(np.log(late["time"]), late[name], 1)[0]
            grown[growth, name] = float(slope / late[name][0])
    assert grown[0.0, "friction"] == pytest.approx(0.028, abs=0.0005)
    assert grown[0.01, "friction"] == pytest.approx(0.039, abs=0.0005)
    assert grown[0.0, "friction_force"] == pytest.approx(0.0, abs=0.0005)
    assert grown[0.01, "friction_force"] == pytest.approx(0.010, abs=0.0005)
