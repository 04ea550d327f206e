"""Friction by Tabor's relation; rate and state: an integrator, known parameters, honest intervals."""

import csv
import dataclasses
import tomllib

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.stats import binom

import asperity as asp
from tests.refusals import each_refuses, refuses
from tests.surfaces import correlated

F = asp.friction
P = asp.protocols
AGING = F.RateAndState(a=0.010, b=0.015, D_c=10e-6, mu_0=0.6, V_0=1e-6)
SLIP = dataclasses.replace(AGING, law="slip")
LAWS = {"aging": AGING, "slip": SLIP}
HOLDS = F.slide_hold_slide([10.0, 100.0, 1000.0], velocity=1e-6, distance=50e-6)
STEPS = F.velocity_steps([1e-6, 1e-5, 1e-6, 3e-6, 1e-6], distance=60e-6)
NOISE = 5e-4
CONTACT = asp.press(correlated(16), asp.solids.spring_lattice(k0=1.0, k1=3.0), load=60.0)


def slid(*protocol, times=(1.0,)):
    """A history of that contact."""
    return asp.age(CONTACT, list(times), protocol=list(protocol))


HISTORY = slid(P.Hold(1.0), P.Slide(2.0, 1.0), P.Hold(1.0), P.Slide(2.0, 10.0), P.Hold(1.0), times=(0.5, 1.0))
DATASET = HISTORY.dataset


# -- Tabor's relation ----------------------------------------------------------------------------------------


def test_friction_is_strength_times_area():
    found = F.add_friction(DATASET, 4.0)
    expected = 4.0 * DATASET["area"] / DATASET["load"]
    np.testing.assert_allclose(found["friction"], expected, rtol=1e-14)
    np.testing.assert_allclose(found["friction_force"], 4.0 * DATASET["area"], rtol=1e-14)
    assert found["friction_force"].attrs["units"] == DATASET["load"].attrs["units"]
    assert found.attrs["shear_strength"] == 4.0
    assert "friction" not in DATASET
    apart = F.add_friction(
        DATASET.assign(load=DATASET["load"] * np.arange(-1.0, DATASET.sizes["time"] - 1)), 4.0
    )
    assert np.isnan(apart["friction"][:2]).all()  # a load that pulls, and none
    np.testing.assert_allclose(apart["friction"][2], expected[2], rtol=1e-14)
    np.testing.assert_array_equal(apart["friction_force"], found["friction_force"])


def test_a_half_space_has_the_friction_of_a_prediction():
    surface = asp.surfaces.Surface(correlated(16), unit="um", pixel_size=(1.0, 1.0), length_unit="um")
    solid = asp.solids.half_space(modulus=1e9, branches=[(0.5, 1.0)])
    dataset = asp.age(asp.press(surface, solid, pressure="10 MPa"), [1.0]).dataset
    found = F.add_friction(dataset, "40 MPa")
    expected = asp.theory.static_friction(dataset["contact_area_corrected"], dataset["load"], 4e7)
    np.testing.assert_allclose(found["friction"], expected, rtol=1e-14)
    assert found["friction_force"].attrs["units"] == "N"


def test_the_strength_grows_like_the_logarithm_of_the_velocity():
    law = F.ShearStrength(4.0, rate_coefficient=0.1, reference_velocity=1.0)
    assert law.at(np.exp(2.0)) == pytest.approx(4.8)
    ratio = F.add_friction(DATASET, law)["friction"] / F.add_friction(DATASET, 4.0)["friction"]
    # At rest, the friction is that at which the next slide begins, and after the last one that of the last.
    slower = DATASET["leg"] <= 1
    np.testing.assert_allclose(ratio.values, np.where(slower, 1.0, 1 + 0.1 * np.log(10.0)), rtol=1e-14)


# -- Rate and state ------------------------------------------------------------------------------------------


def rate(law, velocity, state):
    x = velocity * state / AGING.D_c
    return 1 - x if law == "aging" else -x * np.log(x)


@pytest.mark.parametrize("law", ["aging", "slip"])
def test_the_state_is_that_of_an_integrator(law):
    velocity = np.array([1.0, 1.0, 0.0, 1.0, 30.0, 0.1, 0.0, 10.0]) * 1e-6
    time = np.cumsum([0.0, 3.0, 20.0, 0.5, 4.0, 60.0, 5.0, 2.0])
    found = LAWS[law].state(time, velocity, start=4.0)
    state = [4.0]
    for n in range(1, time.size):
        solution = solve_ivp(
            lambda _, theta, V=velocity[n]: rate(law, V, theta) if V else [float(law == "aging")],  # type: ignore[misc]
            (time[n - 1], time[n]),
            state[-1:],
            rtol=1e-10,
            atol=1e-12,
        )
        state.append(solution.y[0, -1])
    np.testing.assert_allclose(found, state, rtol=1e-8)


def test_friction_becomes_steady_however_far_it_slides_and_a_fresh_contact_ages_from_nothing():
    assert AGING.steady_friction(1e-5) == pytest.approx(0.6 - 0.005 * np.log(10), rel=1e-12)
    for law in LAWS.values():
        friction = law.friction(np.array([0.0, 1.0, 1e9, 2e9]), np.full(4, 1e-5), start=1e6)
        assert friction[-1] == pytest.approx(AGING.steady_friction(1e-5), rel=1e-12)
    np.testing.assert_allclose(AGING.state([0.0, 2.0, 5.0], [0.0, 0.0, 0.0], start=0.0), [0.0, 2.0, 5.0])


@pytest.mark.parametrize("law", ["aging", "slip"])
def test_an_exact_record_gives_its_parameters(law):
    record = F.synthetic_record(STEPS, LAWS[law])
    fit = F.rate_and_state(record, law=law)
    for name in ("a", "b", "D_c", "mu_0"):
        assert getattr(fit, name) == pytest.approx(getattr(AGING, name), rel=1e-5)
    assert fit.a_minus_b == pytest.approx(-0.005, rel=1e-4)
    np.testing.assert_allclose(fit.predict(record), record.friction, rtol=1e-8)


def test_mu_0_is_the_steady_friction_of_the_velocity_asked_for():
    record = F.synthetic_record(STEPS, AGING, noise=NOISE)
    fit = F.rate_and_state(record, V_0=1e-4)
    low, high = fit.interval("mu_0")
    assert low < AGING.steady_friction(1e-4) < high
    assert fit.D_c == pytest.approx(F.rate_and_state(record).D_c, rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("protocol", "law", "count", "known"),
    [
        (STEPS, "slip", 60, {}),
        (HOLDS, "aging", 60, {"a": 0.010}),
        *(
            pytest.param(protocol, law, 500, {}, marks=pytest.mark.slow)
            for protocol in (STEPS, HOLDS + STEPS)
            for law in LAWS
        ),
    ],
)
def test_intervals_cover_the_truth_as_often_as_they_say(protocol, law, count, known):
    """And the spread of the fits is that of their standard errors."""
    truth = {"b": AGING.b, "D_c": AGING.D_c, "mu_0": AGING.mu_0, "a_minus_b": -0.005}
    hits, pulls = dict.fromkeys(truth, 0), []
    for seed in range(count):
        record = F.synthetic_record(protocol, LAWS[law], per_leg=30, noise=NOISE, seed=seed)
        fit = F.rate_and_state(record, law=law, **known)
        for name, value in truth.items():
            low, high = fit.interval(name)
            hits[name] += low <= value <= high
        pulls.append([(getattr(fit, name) - truth[name]) / getattr(fit, f"{name}_stderr") for name in truth])
    np.testing.assert_allclose(np.std(pulls, axis=0), 1.0, atol=3 / np.sqrt(2 * count))
    least, most = (460, 490) if count == 500 else (binom.ppf(0.001, count, 0.95), count)
    assert all(least <= covered <= most for covered in hits.values())


def test_correlated_residuals_widen_the_intervals():
    record = F.synthetic_record(STEPS, AGING, per_leg=200)
    white = np.random.default_rng(0).standard_normal(record.time.size)
    slow = np.convolve(white, np.ones(8) / np.sqrt(8), mode="same")
    widths = {}
    for name, noise in (("white", white), ("slow", slow)):
        fit = F.rate_and_state(dataclasses.replace(record, friction=record.friction + NOISE * noise))
        widths[name] = fit.b_stderr
    assert widths["slow"] > 1.8 * widths["white"]


@pytest.mark.parametrize("law", ["aging", "slip"])
def test_the_verdict_is_the_law_that_made_the_record(law):
    record = F.synthetic_record(STEPS + HOLDS, LAWS[law], noise=NOISE, seed=1)
    found = F.compare_state_laws(record)
    assert found.verdict == found.preferred == law
    assert found.relative_likelihood < 1e-3


def test_noise_leaves_the_verdict_open():
    small = F.velocity_steps([1e-6, 1.3e-6, 1e-6], distance=60e-6)
    record = F.synthetic_record(small, AGING, noise=5 * NOISE, seed=2)
    assert F.compare_state_laws(record).verdict == "undecided"


def test_several_surfaces_give_intervals_by_their_scatter():
    rng = np.random.default_rng(0)
    laws = [dataclasses.replace(AGING, b=0.015 * np.exp(0.1 * rng.standard_normal())) for _ in range(8)]
    several = [F.synthetic_record(STEPS + HOLDS, law, noise=NOISE, seed=n) for n, law in enumerate(laws)]
    found = F.compare_state_laws(several)
    alone = F.compare_state_laws(several[0])
    b = found.estimates["aging"]["b"]
    assert found.verdict == "aging"
    assert found.runs == 8
    assert b.low < 0.015 < b.high
    # The surfaces differ by 10 %, and the mean of 8 is worth 10 %/sqrt(8); the noise alone is far less.
    assert 0.4 < b.stderr / (0.0015 / np.sqrt(8)) < 2.0
    assert b.stderr > 5 * alone.estimates["aging"]["b"].stderr / np.sqrt(8)


def test_b_from_holds_is_b_from_steps():
    record = F.synthetic_record([*STEPS, *HOLDS], AGING, noise=NOISE)
    holds, steps = (F.rate_and_state(record, events=events, a=0.010) for events in ("holds", "steps"))
    assert holds.points < record.time.size
    assert steps.points < record.time.size
    spread = np.hypot(holds.b_stderr, steps.b_stderr)
    assert abs(holds.b - steps.b) < 3 * spread


def test_static_friction_against_hold_time_has_a_closed_form():
    """peak - before = b ln(1 + V t/D_c): the logarithm of `asperity.fits` finds b and D_c another way."""
    law = dataclasses.replace(AGING, a=0.0)
    holds = np.geomspace(1.0, 1e4, 9)
    protocol = F.slide_hold_slide(holds, velocity=1e-6, distance=200e-6)
    peaks = F.hold_peaks(F.synthetic_record(protocol, law, strength_at_rest=True))
    np.testing.assert_allclose(peaks.duration, holds)
    np.testing.assert_allclose(peaks.velocity, 1e-6)
    grown = asp.fits.logarithm(np.append(0.0, peaks.duration), np.append(peaks.before[0], peaks.peak))
    assert grown.slope == pytest.approx(law.b, rel=1e-6)
    assert grown.t0 * 1e-6 == pytest.approx(law.D_c, rel=1e-6)


def test_before_a_hold_counts_the_second_half_of_the_slip():
    velocity = np.array([1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0])
    friction = np.array([0.1, 0.2, 0.3, 0.5, 0.45, 0.42, 0.9, 0.8, 0.7])
    for at_rest, peak in ((False, 0.9), (True, 0.42)):
        found = F.hold_peaks(F.Record(np.arange(9.0), velocity, friction, strength_at_rest=at_rest))
        rows = [found.duration, found.peak, found.before, found.velocity]
        np.testing.assert_allclose(rows, [[2.0], [peak], [0.4], [1.0]])


def test_a_step_of_the_velocity_is_no_part_of_a_hold():
    """An interval with part of a slip, at 0.4 or 0.3, is no step."""
    velocity = np.array([1, 1, 30, 30, 1, 1, 1, 1, 0.4, 0, 0, 0.3, 1, 1, 1, 30, 30, 1])
    friction = np.array([5, 5, 9, 9, 7, 6, 4, 4, 4, 3, 3, 6, 7, 5, 5, 9, 9, 5]) / 10
    found = F.hold_peaks(F.Record(np.arange(18.0), velocity, friction))
    rows = [found.duration, found.peak, found.before, found.velocity]
    np.testing.assert_allclose(rows, [[2.0], [0.7], [0.4], [1.0]])


def test_rest_counts_only_where_it_is_the_strength():
    known = dataclasses.replace(AGING, a=0.0)
    machine = F.synthetic_record(HOLDS, known)
    strength = F.synthetic_record(HOLDS, known, strength_at_rest=True)
    assert F.rate_and_state(strength, a=0.0).points == strength.time.size
    assert F.rate_and_state(machine, a=0.0).points == np.count_nonzero(machine.velocity)


def test_displacement_and_velocity_are_one_record():
    record = F.synthetic_record(STEPS + HOLDS, AGING)
    again = F.Record.of_displacement(record.time, record.displacement, record.friction)
    np.testing.assert_allclose(again.velocity, record.velocity, rtol=1e-6, atol=1e-15)
    # Of two entries at a shift the one before it counts.
    slip, friction = [0.0, 1.0, 1.0, 2.0, 2.0, 2.0], [0.5, 0.4, 0.5, 0.4, 0.5, 0.6]
    shifted = F.Record.of_displacement([0.0, 0.0, 1.0, 1.0, 2.0, 7.0], slip, friction)
    np.testing.assert_array_equal(shifted.friction, [0.5, 0.5, 0.5, 0.6])
    np.testing.assert_array_equal(shifted.velocity, [1.0, 1.0, 1.0, 0.0])


def table(path, names, *columns):
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=names, comments="")
    return path


def test_a_table_is_read_with_its_units(tmp_path):
    record = F.synthetic_record(STEPS, AGING)
    time, slip, friction = record.time / 60, record.displacement * 1e6, record.friction
    names = "time_min,displacement [um],friction"
    read = F.read_record(table(tmp_path / "a.csv", names, time, slip, friction))
    np.testing.assert_allclose(read.displacement, record.displacement, rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(read.time, record.time)
    assert read.si
    speed = record.velocity * 1e6
    names = "time_s,velocity_um/s,shear_stress_MPa,normal_stress_kPa"
    stresses = 5 * friction, np.full(time.size, 5000.0)
    read = F.read_record(table(tmp_path / "b.csv", names, record.time, speed, *stresses))
    np.testing.assert_allclose(read.velocity, record.velocity)
    np.testing.assert_allclose(read.friction, friction)
    assert read.normal_stress == pytest.approx(5e6)
    bare = F.read_record(table(tmp_path / "c.csv", "time,velocity,mu", time, speed, friction))
    assert not bare.si


def test_files_say_the_parameters_and_their_units(here):
    record = dataclasses.replace(F.synthetic_record(STEPS, AGING, noise=NOISE), normal_stress=5e6)
    found = F.compare_state_laws(record)
    F.save_parameters(found, here / "f.toml")
    F.save_parameters(found, here / "f.csv", law="slip")
    written = tomllib.loads((here / "f.toml").read_text())
    aging = found.fits["aging"]
    expected = {name: getattr(aging, name) for name in ("law", "mu_0", "a", "b", "D_c", "a_minus_b", "V_0")}
    assert written["parameters"] == expected | {"normal_stress": 5e6}
    assert written["units"]["D_c"] == "m"
    assert written["intervals_95"]["D_c"] == list(aging.interval("D_c"))
    assert written["origin"]["asperity_version"] == asp.__version__
    own = F.compare_state_laws(dataclasses.replace(record, si=False))
    F.save_parameters(own, here / "own.toml")
    bare = tomllib.loads((here / "own.toml").read_text())["units"]
    assert (bare["D_c"], bare["a"], bare["normal_stress"]) == ("length of the record", "1", "Pa")
    first, second = csv.DictReader((here / "f.csv").read_text().splitlines())
    assert [first["law"], second["law"]] == ["slip", "aging"]
    assert float(second["D_c_m"]) == aging.D_c
    with refuses("path", "f.txt"):
        F.save_parameters(found, "f.txt")


def test_a_history_becomes_a_record():
    """States between two shifts belong to the slide."""
    history = slid(P.Slide(4.0, 1.0), P.Hold(1.0), P.Slide(2.0, 2.0), times=(2.5, 3.25))
    record = F.record_of(history, shear_strength=1.0)
    np.testing.assert_array_equal(record.time, [0.0, 1.0, 2.0, 2.5, 3.0, 3.25, 4.0, 5.0, 5.5, 6.0])
    np.testing.assert_allclose(record.velocity, [1.0] * 7 + [0.0, 2.0, 2.0])
    np.testing.assert_allclose(record.displacement, [0, 1, 2, 2.5, 3, 3.25, 4, 4, 5, 6])
    assert record.a == 0.0
    assert F.record_of(history, shear_strength=F.ShearStrength(1.0, 0.1, 1.0)).a is None


# -- Bad input -----------------------------------------------------------------------------------------------

FAST = F.ShearStrength(4.0, rate_coefficient=0.1, reference_velocity=1e6)
JUMP = P.Slide(4.0, np.inf)
TIMES, ONE = np.arange(9.0), np.ones(9)
RECORD = F.synthetic_record(HOLDS, AGING)
BAD = {
    "time falls": ("time", lambda: F.Record(TIMES[::-1], ONE, ONE)),
    "velocity below 0": ("velocity", lambda: F.Record(TIMES, -ONE, ONE)),
    "few velocities": ("velocity", lambda: F.Record(TIMES, ONE[:3], ONE)),
    "no friction": ("friction", lambda: F.Record(TIMES, ONE, 0 * ONE)),
    "few frictions": ("friction", lambda: F.Record(TIMES, ONE, ONE[:3])),
    "slides back": ("displacement", lambda: F.Record.of_displacement(TIMES, TIMES[::-1], ONE)),
    "few displacements": ("displacement", lambda: F.Record.of_displacement(TIMES, TIMES[:3], ONE)),
    "no event": ("record", lambda: F.rate_and_state(F.Record(TIMES, ONE, ONE))),
    "no slip": ("velocity", lambda: F.rate_and_state(F.Record(TIMES, 0 * ONE, ONE))),
    "one velocity": ("a", lambda: F.rate_and_state(RECORD)),
    "no steps": ("record", lambda: F.rate_and_state(RECORD, events="steps")),
    "too short": ("record", lambda: F.rate_and_state(F.synthetic_record(HOLDS[:3], AGING, per_leg=2), a=0.0)),
    "other events": ("events", lambda: F.rate_and_state(RECORD, events="both")),  # type: ignore[arg-type]
    "other law": ("law", lambda: F.rate_and_state(RECORD, law="ageing")),  # type: ignore[arg-type]
    "none": ("records", lambda: F.compare_state_laws([])),
    "two kinds": ("records", lambda: F.compare_state_laws([RECORD, F.synthetic_record(STEPS, AGING)])),
    "no age": ("start", lambda: SLIP.state([0.0, 1.0], [1.0, 1.0], start=0.0)),
    "few a leg": ("per_leg", lambda: F.synthetic_record(STEPS, AGING, per_leg=1)),
    "a step of the load": ("protocol", lambda: F.synthetic_record([P.Step(load=1.0)], AGING)),
    "no hold": ("holds", lambda: F.slide_hold_slide([], velocity=1.0, distance=1.0)),
    "hardly a step": ("velocities", lambda: F.velocity_steps([1.0, 1.1], distance=1.0)),
    "no history": ("history", lambda: F.record_of(3.0)),  # type: ignore[arg-type]
    "no slide": ("history", lambda: F.record_of(slid(P.Hold(1.0)), shear_strength=1.0)),
    "a jump alone": ("history", lambda: F.record_of(slid(JUMP, P.Hold(1.0)), shear_strength=1.0)),
    "no strength": ("shear_strength", lambda: F.record_of(HISTORY)),
    "strength 0": ("shear_strength", lambda: F.add_friction(DATASET, 0.0)),
    "other units": ("units", lambda: F.add_friction(DATASET, "40 MPa")),
    "no velocity of reference": ("rate_coefficient", lambda: F.ShearStrength(4.0, rate_coefficient=0.1)),
    "far from the reference": ("rate_coefficient", lambda: F.add_friction(DATASET, FAST)),
    "a strength at rest": ("velocity", lambda: F.add_friction(slid(P.Hold(1.0)).dataset, FAST)),
    "a strength of a jump": ("velocity", lambda: F.add_friction(slid(JUMP, times=(0.0,)).dataset, FAST)),
    "no dataset": ("dataset", lambda: F.add_friction(HISTORY, 4.0)),
}


def test_bad_records_are_refused():
    each_refuses(
        *BAD.values(),
        got=(
            "8.0 before 7.0 | -1.0 | 3 | 0.0 | 3 | 7 after 8 m | 9 | 1 | rest at all times | none | "
            "rests only | 5 | 'both' | 'ageing' | none | 251 and 351 times | 0.0 | 1 | 1.0 | none | "
            "1, 1.1 | float | none | a slide at once | none | 0.0 | '40 MPa' |  | -1.5262 at 1 |  |  | "
            "History"
        ),
    )


@pytest.mark.parametrize(
    ("file", "names"),
    [
        ("no_friction.csv", "time_s,velocity_m/s,angle"),
        ("twice.csv", "time_s,slip_um,displacement_um"),
        ("half.csv", "time_s,velocity,friction"),
    ],
)
def test_tables_that_are_no_record(tmp_path, file, names):
    with pytest.raises(asp.errors.InputError, match=file):
        F.read_record(table(tmp_path / file, names, TIMES, ONE, ONE))
