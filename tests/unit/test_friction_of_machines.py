"""Records of machines: load points under noise, sliders on springs against closed forms, honest refusals."""

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import odeint, solve_ivp
from scipy.signal import lfilter
from scipy.stats import binom

import asperity as asp
from asperity.errors import InputError
from asperity.friction.loading import Drive, drive_of
from asperity.friction.pulling import oscillation, stiffness_of
from asperity.friction.slider import Shape, follow
from tests import CASES
from tests.refusals import each_refuses, refuses

F = asp.friction
UM = 1e-6
TRUTH = Shape(a=0.008, b=0.010, D_c=10 * UM, k=0.01 / UM)
LAWS = ("aging", "slip")
RAW = Path(os.environ.get("ASPERITY_DATA", "")) / "friction"
P655 = pytest.mark.skipif(not RAW.is_dir(), reason="the record is not ours to ship")


def exact(velocity, lasts, step=0.1, law="aging", shape=TRUTH):
    """Times, load point, slip and friction of a slider pulled at these velocities (um/s) for these times."""
    drive = Drive(np.cumsum(lasts)[:-1] * 1.0, UM * np.array(velocity), np.full(len(lasts) - 1, step))
    time = np.arange(0.0, sum(lasts) + step / 2, step)
    place = drive.place(time)
    elastic = follow(law, shape, drive, time).elastic(shape)
    return time, place, place - elastic / shape.k, 0.6 + elastic


STEPS = [1.0, 10.0, 1.0], [40.0, 10.0, 60.0]
HOLDS = [10.0, 0.0, 10.0, 0.0, 10.0], [10.0, 3.0, 15.0, 100.0, 15.0]


def noisy(time, friction, seed=0, **places):
    """A record with noise of 3 % of D_c and 4e-4, and a drift with displacement."""
    rng, along = np.random.default_rng(seed), next(iter(places.values()))
    places = {name: place + 0.3 * UM * rng.standard_normal(time.size) for name, place in places.items()}
    friction = friction + 4e-4 * rng.standard_normal(time.size) + 1e-6 * along / UM
    return F.Record.of_machine(time, friction, units=("s", "um"), **places)


# -- The slider ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", LAWS)
def test_a_load_point_at_rest_lets_friction_relax_as_a_logarithm(law):
    """With b = 0, mu = mu_i - a ln(1 + k V_i t/a)."""
    shape = TRUTH._replace(b=0.0)
    time, _, _, friction = exact([10.0, 0.0], [5.0, 1000.0], law=law, shape=shape)
    since = np.maximum(time - 5.0, 0.0)
    expected = 0.6 - shape.a * np.log1p(shape.k * 10 * UM * since / shape.a)
    np.testing.assert_allclose(friction, expected, atol=2e-8)


def test_a_stiff_machine_has_the_closed_form_of_a_step():
    """At k to infinity slip is the load point, and the fit is that which needs no integrator."""
    rigid = F.RateAndState(law="slip", a=0.008, b=0.010, D_c=10 * UM, mu_0=0.6, V_0=UM)
    stiff = TRUTH._replace(k=10 / UM)
    time, place, _, friction = exact([1.0, 10.0, 1.0], [30.001, 10.0, 40.0], law="slip", shape=stiff)
    velocity = np.append(UM, np.diff(place) / np.diff(time))
    late = np.abs(time[:, None] - np.array([30.0, 40.0])).min(axis=1) > 0.2
    np.testing.assert_allclose(friction[late], rigid.friction(time, velocity)[late], atol=3e-5)
    record = F.Record.of_machine(time, friction, load_point=place)
    pulled, at_once = (F.rate_and_state(record, law="slip", stiffness=k) for k in ("10/um", np.inf))
    assert isinstance(pulled, F.MachineFit)
    for name in ("a", "b", "D_c", "mu_0"):
        value, stderr = getattr(at_once, name), getattr(at_once, f"{name}_stderr")
        assert abs(getattr(pulled, name) - value) < 4 * stderr + 1e-3 * value


def test_a_machine_that_is_too_stiff_to_tell_gives_the_others():
    shape = TRUTH._replace(k=3 / UM)
    time, place, _, friction = exact([1.0, 10.0, 1.0], [30.03, 10.0, 40.0], law="slip", shape=shape)
    fit = F.rate_and_state(noisy(time, friction, load_point=place), law="slip")
    assert isinstance(fit, F.MachineFit)
    assert fit.stiffness_at_edge or fit.stiffness_stderr > fit.stiffness
    for name in ("a", "b", "D_c"):
        assert abs(getattr(fit, name) - getattr(TRUTH, name)) < 3 * getattr(fit, f"{name}_stderr")


# -- The fit -------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("protocol", "law", "measured"),
    [(STEPS, "slip", ("load_point",)), (STEPS, "slip", ("load_point", "slip")), (HOLDS, "aging", ("slip",))],
)
def test_a_record_gives_its_parameters_whatever_was_measured(protocol, law, measured):
    time, place, slip, friction = exact(protocol[0], protocol[1], law=law)
    places = {"load_point": place, "slip": slip}
    record = noisy(time, friction, **{name: places[name] for name in measured})
    fit = F.rate_and_state(record, law=law)
    assert isinstance(fit, F.MachineFit)
    for name, value in zip(("a", "b", "D_c", "stiffness"), TRUTH[:4], strict=True):
        low, high = fit.interval(name)
        middle = (low + high) / 2
        assert abs(value - middle) < 2 * (high - low) / 2, name  # twice 95 %
        assert high - low < 0.3 * value
    assert np.sqrt(np.mean((fit.slip - slip) ** 2)) < 0.3 * UM  # the noise of one row
    fixed = F.rate_and_state(record, law=law, stiffness="0.01 / um")
    assert isinstance(fixed, F.MachineFit)
    assert fixed.stiffness_stderr == 0
    assert fixed.a_stderr < fit.a_stderr


def held(seed):
    """Noise of 3e-4 on holds of 3 to 1129 s by the slip law, and slides of 60 um."""
    shape, slide = Shape(a=0.0103, b=0.0131, D_c=3.5 * UM, k=6750.0), 60 / 0.62
    lasts = [slide, 3.4, slide, 67.7, slide, 1129.0, slide]
    drive = Drive(np.cumsum(lasts)[:-1], 0.62 * UM * np.array([1, 0, 1, 0, 1, 0, 1]), np.ones(6))
    time = np.interp(np.arange(7 * 165 + 1) / 165, np.arange(8), np.append(0.0, np.cumsum(lasts)))
    elastic = follow("slip", shape, drive, time).elastic(shape)
    friction = 0.6 + elastic + 3e-4 * np.random.default_rng(seed).standard_normal(time.size)
    return shape, F.Record.of_machine(time, friction, load_point=drive.place(time), units=("s", "um"))


def test_a_search_does_not_end_where_the_course_is_sensitive():
    """After holds, differences over steps of 1e-4 have a gradient of the wrong sign."""
    shape, slide = Shape(a=0.01024, b=0.01386, D_c=1.926 * UM, k=2987.5), 31 / 0.62
    time, place, _, friction = exact(
        [0.62, 0.0, 0.62, 0.0, 0.62], [slide, 52.87, slide, 9.19, slide], step=0.28, law="slip", shape=shape
    )
    friction = friction + 3e-4 * np.random.default_rng(50).standard_normal(time.size)
    fit = F.rate_and_state(F.Record.of_machine(time, friction, load_point=place), law="slip")
    for name in ("a", "b", "D_c"):
        assert getattr(fit, name) == pytest.approx(getattr(shape, name), rel=0.05)


def test_no_false_minimum_where_the_load_point_seems_to_have_a_short_slide():
    """From D_c below that of the slide of 0.2 um, which is not there, the search ended at a of 0.021."""
    shape, record = held(1)
    drive = record.drive
    assert drive is not None
    at = drive.kinks[2]
    kinks = np.insert(np.delete(drive.kinks, 2), 2, [at - 0.36, at + 0.53])
    wrong = Drive(kinks, np.insert(drive.velocity, 3, 0.25 * UM), np.full(7, 0.1))
    fit = F.rate_and_state(replace(record, drive=wrong), law="slip", stiffness="6750 1/m")
    assert fit.determined
    for name in ("a", "b", "D_c"):
        assert getattr(fit, name) == pytest.approx(getattr(shape, name), rel=0.03)


def test_a_misfit_above_the_noise_is_remarked_and_determines_nothing():
    laws = F.compare_state_laws(held(0)[1])
    assert laws.fits["slip"].determined
    assert not laws.fits["aging"].determined
    (note,) = [text for row in laws.rows() if "times the noise" in (text := str(row.value))]
    assert note.startswith("aging law, k fitted")
    assert "6 starts with D_c from 0.06 to 60 um" in note


@pytest.mark.parametrize("text", ["0.01 / um", "1e4 1/m", "0.5 MPa/um", "20 N/um", "10 / mm"])
def test_a_stiffness_has_a_unit(text):
    record = F.Record.of_machine(TIME, FRICTION, load_point=PLACE, normal_stress=50e6, normal_force=2000.0)
    assert stiffness_of(record, text) == pytest.approx(TRUTH.k, rel=1e-12)


def test_a_kink_between_two_rows_is_one_kink():
    """The load points of 50 protocols of holds have the kinks of the protocol, and no others."""
    rng = np.random.default_rng(0)
    for _ in range(50):
        slide, holds = rng.uniform(20.0, 60.0), 10 ** rng.uniform(1.0, 3.0, 3)
        lasts = np.array([slide, *(part for hold in holds for part in (hold, slide))])
        drive = Drive(np.cumsum(lasts)[:-1], np.array([1.0, *[0.0, 1.0] * 3]), np.ones(6))
        ends = np.append(0.0, np.cumsum(lasts))
        time = np.interp(np.arange(7 * 150 + 1) / 150, np.arange(8), ends)
        found = drive_of(time, drive.place(time))
        np.testing.assert_allclose(found.kinks, drive.kinks, rtol=1e-6)


def test_what_rests_is_the_load_point():
    """Hold times are those of the machine, to a row, although the slider creeps on; B is that of the law."""
    time, place, slip, friction = exact(
        [10.0, *[0.0, 10.0] * 3], [10.0, 10.0, 20.0, 100.0, 20.0, 1000.0, 20.0]
    )
    for measured in ({"load_point": place}, {"slip": slip}, {"slip": np.round(slip / UM, 1) * UM}):
        peaks = F.hold_peaks(noisy(time, friction, **measured))
        np.testing.assert_allclose(peaks.duration, [10.0, 100.0, 1000.0], atol=0.25)
        healing = np.diff(peaks.peak - peaks.before)[-1] / np.log(10.0)
        assert healing == pytest.approx(TRUTH.b, rel=0.15)


def solved(velocity, lasts, k, a=0.008, b=0.012, D_c=2.0):
    """Times, load point (um) and friction by the aging law, integrated by scipy; k in 1/um."""
    state: Any = [0.6, np.log(D_c / velocity[0])]
    ends, rows = np.cumsum([0.0, *lasts]), [[0.6]]
    for speed, start, end in zip(velocity, ends, ends[1:], strict=False):

        def flow(t, y, speed=speed):
            slip = np.exp((y[0] - 0.6 - b * (y[1] - np.log(D_c))) / a)
            return k * (speed - slip), np.exp(-y[1]) - slip / D_c

        times = np.arange(round(10 * start) + 1, round(10 * end) + 1) / 10
        found = solve_ivp(
            flow, (start, end), state, "LSODA", np.append(times[:-1], end), rtol=1e-9, atol=1e-12
        )
        state = found.y[:, -1]
        rows.append(found.y[0])
    time = np.arange(round(10 * ends[-1]) + 1) / 10
    return time, np.interp(time, ends, np.cumsum([0.0, *np.multiply(velocity, lasts)])), np.concatenate(rows)


def test_a_fast_slide_between_holds_is_no_peak():
    """Slides contain 5 s at 30 um/s, whose friction is larger than that after short holds."""
    holds, slide = [3.0, 10.0], ([1.0, 30.0, 1.0], [25.0, 5.0, 40.0])
    velocity = [1.0, *(v for _ in holds for v in (0.0, *slide[0]))]
    lasts = [60.0, *(t for hold in holds for t in (hold, *slide[1]))]
    time, place, friction = solved(velocity, lasts, k=5e-3)
    peaks = F.hold_peaks(F.Record.of_machine(time, friction, load_point=place * UM))
    after = np.cumsum(lasts)[1::4]
    expected = [friction[(time >= start) & (time < start + 25)].max() for start in after]
    np.testing.assert_allclose(peaks.peak, expected, atol=1e-5)
    np.testing.assert_allclose(peaks.before, 0.6, atol=1e-4)
    assert max(expected) < friction.max()


@pytest.mark.parametrize("rows", [0, 2])
def test_a_hold_without_rows_is_refused(rows):
    time, place, _, friction = exact([1.0, 0.0, 1.0], [40.0, 30.0, 40.0])
    kept = (time < 40.1) | (time > 69.9)
    kept[np.linspace(400, 700, rows + 2).astype(int)] = True
    with refuses("load point", "between 40 and"):
        F.Record.of_machine(time[kept], friction[kept], load_point=place[kept])


def test_noisy_slip_is_not_prescribed():
    """With k of 1/um, slip differs from the load point by half its noise."""
    about = {"a": 0.010, "b": 0.014, "D_c": 5.0}
    time, place, friction = solved([1.0, 10.0, 1.0], [40.0, 15.0, 65.0], k=1.0, **about)
    for seed in range(2):
        rng = np.random.default_rng(seed)
        slip = place - (friction - 0.6) + 0.02 * rng.standard_normal(time.size)
        assert (np.diff(slip) > 0).all()
        noisy_friction = friction + 2e-4 * rng.standard_normal(time.size)
        record = F.Record.of_machine(time, noisy_friction, slip=slip * UM, units=("s", "um"))
        fit = F.rate_and_state(record)
        assert isinstance(fit, F.MachineFit)
        assert abs(fit.V_0 - UM) < 1e-3 * UM
        for name, unit in (("a", 1.0), ("b", 1.0), ("D_c", UM)):
            assert abs(getattr(fit, name) / unit - about[name]) < 3 * getattr(fit, f"{name}_stderr") / unit
            assert getattr(fit, f"{name}_stderr") < 0.05 * getattr(fit, name)


@pytest.mark.slow
@pytest.mark.parametrize(("protocol", "law"), [(STEPS, "slip"), (HOLDS, "aging")])
def test_intervals_cover_the_truth_as_often_as_they_say(protocol, law):
    time, place, _, friction = exact(protocol[0], protocol[1], law=law)
    hits = dict.fromkeys(("a", "b", "D_c", "stiffness"), 0)
    for seed in range(CASES):
        fit = F.rate_and_state(noisy(time, friction, seed, load_point=place), law=law, stiffness="fit")
        for name, value in zip(hits, TRUTH[:4], strict=True):
            low, high = fit.interval(name)
            hits[name] += low <= value <= high
    assert min(hits.values()) >= binom.ppf(0.004, CASES, 0.95)


@pytest.mark.slow
def test_intervals_count_the_errors_of_the_velocities_of_the_load_point():
    """D_c is a slip. Friction, with little noise, would give it to 0.01 %, the load point to 0.1 %."""
    time, place, _, friction = exact(*STEPS, law="slip")
    off, stated = [], []
    for seed in range(8):
        rng = np.random.default_rng(seed)
        noisy_place = place + 0.3 * UM * rng.standard_normal(time.size)
        record = F.Record.of_machine(
            time, friction + 1e-5 * rng.standard_normal(time.size), load_point=noisy_place
        )
        fit = F.rate_and_state(record, law="slip", stiffness="fit")
        off.append(np.log(fit.D_c / TRUTH.D_c))
        stated.append(fit.D_c_stderr / fit.D_c)
    assert 0.5 < np.sqrt(np.mean(np.square(off))) / np.mean(stated) < 2.0


# -- A measured record ---------------------------------------------------------------------------------------


def p655(name, first, last):
    """A part of the record that the reduction program xlook has as its example."""
    time, place, shear, normal = np.loadtxt(RAW / name, delimiter=",", skiprows=1).T
    kept = (time >= first) & (time <= last)
    friction = (shear / normal)[kept]
    return F.Record.of_machine(time[kept], friction, load_point=place[kept] * UM, units=("s", "um"))


@P655
@pytest.mark.parametrize(
    ("law", "stiffness", "published"),
    [
        ("slip", "1.6e-3 / um", ((0.006005, 53e-6), (0.004230, 51e-6), (17.75, 0.33))),
        ("slip", "1e-3 / um", ((0.005823, 98e-6), (0.004094, 94e-6), (12.8, 0.4))),
        ("aging", "1e-3 / um", ((0.006043, 113e-6), (0.004279, 109e-6), (6.5, 0.2))),
    ],
)
def test_a_step_of_rock_on_rock(law, stiffness, published):
    """Parameters published with the record, and their standard errors; the joint ones are below 2.5."""
    fit = F.rate_and_state(p655("p655_step_100MPa.csv", 3845, 3868), law=law, stiffness=stiffness)
    for name, (value, error), unit in zip(("a", "b", "D_c"), published, (1, 1, UM), strict=True):
        found, stderr = getattr(fit, name) / unit, getattr(fit, f"{name}_stderr") / unit
        assert abs(found - value) < 2.5 * np.hypot(error, stderr), name
    assert 4.2e-4 < np.std(fit.residual) < 5.3e-4
    assert 0.8 < fit.autocorrelation < 0.9


@P655
def test_a_hold_whose_load_point_is_recorded_too_early():
    """The column stops 3 s before friction falls, and goes on 5 s after it rises: friction counts."""
    fit = F.rate_and_state(p655("p655_hold_75MPa.csv", 2600, 2720))
    assert isinstance(fit, F.MachineFit)
    np.testing.assert_allclose(fit.kinks, [2639.6, 2679.1], atol=0.3)
    assert fit.released == (0, 1)
    assert np.std(fit.residual) < 4.5e-4


@P655
@pytest.mark.parametrize(
    ("name", "a", "a_minus_b"),
    [("basalt_b819.txt", (0.008, 0.014), 0.0), ("sepiolite.txt", (0.012, 0.02), 0.0236)],
)
def test_records_of_another_laboratory(name, a, a_minus_b):
    """As their machine writes them; the bounds are those of the peak, and of steady friction."""
    fit = F.rate_and_state(F.read_record(RAW / name), law="slip")
    assert a[0] < fit.a < a[1]
    assert fit.a_minus_b == pytest.approx(a_minus_b, abs=0.0015)


@P655
def test_events_are_drawn_as_published_fits_are():
    """Twelve steps of p4309 (Leeman et al., 2016): D_c falls from 27 to 5 um, and a - b changes its sign."""
    known = pd.read_csv(RAW / "leeman_p4309_slip_law_fits.csv", comment="#")
    table = {"displacement": known["row"]}
    for name, error in (("a", "a_error"), ("b", "b_error"), ("D_c", "D_c_error_um"), ("a_minus_b", None)):
        value = known[name + "_um" * (name == "D_c")]
        spread = np.hypot(known["a_error"], known["b_error"]) if error is None else known[error]
        table |= {name: value, f"{name}_low": value - 1.96 * spread, f"{name}_high": value + 1.96 * spread}
    ours = F.events_table(F.fit_events(GOOD, law="aging"), GOOD)
    assert {str(name).removesuffix("_m") for name in ours} > set(table)
    above, middle, below = F.events_figure(pd.DataFrame(table)).axes
    of_D_c = np.array(below.lines[0].get_ydata())
    assert of_D_c[[0, -1]] == pytest.approx([27, 5], abs=0.3)
    assert middle.get_ylim()[0] < 0 < middle.get_ylim()[1]
    assert [label.get_text() for label in above.get_legend().get_texts()] == ["$a$", "$b$"]


def test_a_table_that_is_none_of_events_is_refused():
    with refuses("table", "none of D_c"):
        F.events_figure(pd.DataFrame({"displacement": [1.0]}))


def test_no_law_is_preferred_that_does_not_describe_the_record():
    """With a third of the stiffness both laws miss the noise."""
    record = F.Record.of_machine(TIME, FRICTION + 2e-4 * np.sin(TIME**2), load_point=PLACE)
    laws = F.compare_state_laws(record, stiffness="0.003 / um")
    assert laws.verdict == "undecided"
    assert laws.doubt.startswith("neither law")
    assert any(laws.doubt in str(row.value) for row in laws.rows())


# -- Stick-slip ----------------------------------------------------------------------------------------------


def correlated(rng, rows, rho=0.45):
    return lfilter([np.sqrt(1 - rho**2)], [1, -rho], rng.standard_normal(rows + 100))[100:]


def oscillates(time, place, friction):
    record = F.Record.of_machine(time, friction, load_point=place, units=("s", "um"))
    assert record.drive is not None
    return str(oscillation(record, record.drive, record.drive.edges(time)) or "")


def test_noise_whose_rows_correlate_is_no_stick_slip():
    time, place, _, friction = exact([3.0, 10.0], [40.0, 40.0], shape=TRUTH._replace(b=0.008))
    for seed in range(50):
        noise = 1e-3 * correlated(np.random.default_rng(seed), time.size)
        assert not oscillates(time, place, friction + noise)


def test_a_slider_that_sticks_and_slips_is_refused_with_its_period():
    """A spring at 0.4 to 0.8 of (b - a)/D_c; friction, with the damping of radiation, limits the velocity."""
    a, b, D_c, damping = 0.008, 0.012, 10.0, 1e-5

    def rate(y, _, k):
        v, grown = np.exp(y[0]), np.exp(-y[1]) - np.exp(y[0]) / D_c
        return [(k * (1.0 - v) - b * grown) / (a + damping * v), grown]

    for n, part in enumerate(np.linspace(0.4, 0.8, 5)):
        time = np.linspace(0.0, 3000.0, 3001)
        k = part * (b - a) / D_c
        y = odeint(rate, [0.5, np.log(D_c)], time, args=(k,), rtol=1e-8, mxstep=100000)
        late, friction = time > 600, 0.6 + y @ [a, b]
        noise = 3e-4 * correlated(np.random.default_rng(n), time.size)
        text = oscillates(time[late], UM * time[late], (friction + noise)[late])
        assert "with a period of" in text
        spectrum = np.abs(np.fft.rfft((friction - friction.mean())[late]))
        period = late.sum() / np.argmax(spectrum)
        assert float(text.split("with a period of ")[1].split(" s,")[0]) == pytest.approx(period, rel=0.2)


def sticking(seed: int) -> Any:
    """A step of the velocity of a slider at random below (b - a)/D_c, with two cycles or more."""
    rng = np.random.default_rng(seed)
    a, fall, D_c, part = (
        10 ** rng.uniform(*ends) for ends in ((-2.3, -1.8), (-2.7, -2), (0.3, 1.5), (-0.7, -0.07))
    )
    law, first = LAWS[seed % 2], 10 ** rng.uniform(-0.5, 0.7)
    speeds = [first, first * 10 ** (rng.choice([-1, 1]) * rng.uniform(0.3, 1.0))]
    k, damping = part * fall / D_c, fall / first / 10 ** rng.uniform(2.5, 4.0)
    slides = rng.uniform(8, 25, 2) * 4 * fall / k

    def rate(y, _, pulled):
        v = np.exp(y[0])
        grown = np.exp(-y[1]) - v / D_c if law == "aging" else -v / D_c * (y[0] + y[1] - np.log(D_c))
        return [(k * (pulled - v) - (a + fall) * grown) / (a + damping * v), grown]

    step = sum(slides / speeds) / rng.uniform(600, 3000)
    y, states = np.array([np.log(first) + 0.3, np.log(D_c / first)]), list[np.ndarray]()
    for speed, slide in zip([first, *speeds], [2 * slides[0], *slides], strict=True):
        course = odeint(
            rate, y, np.arange(0, slide / speed, step), (speed,), rtol=1e-8, atol=1e-8, mxstep=200000
        )
        states, y = [*states, course[:-1]], course[-1]
    mu = np.concatenate(states[1:]) @ [a, a + fall]
    lasts = [len(state) * step for state in states[1:]]
    time = step * np.arange(mu.size)
    place = np.interp(time, [0, lasts[0], sum(lasts)], np.append(0, np.cumsum(np.multiply(speeds, lasts))))
    place = place + 0.03 * D_c * rng.standard_normal(mu.size)
    return time, UM * place, 0.6 + mu - mu.mean() + 3e-4 * correlated(rng, mu.size), law


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_no_law_is_fitted_to_stick_slip(seed):
    time, place, friction, law = sticking(seed)
    record = F.Record.of_machine(time, friction, load_point=place, units=("s", "um"))
    with pytest.raises(InputError, match="stable sliding"):
        F.rate_and_state(record, law=law)


@pytest.mark.parametrize(
    ("law", "speed"), [pytest.param("aging", 10.0, marks=pytest.mark.slow), ("slip", 3.0)]
)
def test_a_slider_near_the_limit_of_stability_is_fitted(law, speed):
    """At k of 1.08 (b - a)/D_c friction falls faster than it rises, in cycles that die out."""
    shape = Shape(a=0.008, b=0.012, D_c=10 * UM, k=1.08 * 0.004 / (10 * UM))
    time, place, _, friction = exact([1.0, speed, 1.0], [300.0, 600.0 / speed, 600.0], 0.5, law, shape)
    friction = friction + 3e-4 * correlated(np.random.default_rng(0), time.size)
    assert "oscillations" in oscillates(time, place, friction)
    fit = F.rate_and_state(F.Record.of_machine(time, friction, load_point=place), law=law)
    for name in ("a", "b", "D_c", "stiffness"):
        truth, stderr = shape[("a", "b", "D_c", "stiffness").index(name)], getattr(fit, f"{name}_stderr")
        assert abs(getattr(fit, name) - truth) < 4 * stderr


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_a_step_without_change_of_steady_friction_is_fitted(seed):
    shape = TRUTH._replace(b=TRUTH.a + 2e-4 * (seed % 5 - 2))
    time, place, _, friction = exact([1.0, 10.0], [100.0, 20.0], law=LAWS[seed % 2], shape=shape)
    friction = friction + 5e-4 * correlated(np.random.default_rng(seed), time.size)
    record = F.Record.of_machine(time, friction, load_point=place, units=("s", "um"))
    law: Any = LAWS[seed % 2]
    fit = F.rate_and_state(record, law=law)
    assert abs(fit.a_minus_b + shape.b - shape.a) < 4 * fit.a_minus_b_stderr


# -- Bad input -----------------------------------------------------------------------------------------------

TIME, PLACE, SLIP, FRICTION = exact(*STEPS)
GOOD = F.Record.of_machine(TIME, FRICTION, load_point=PLACE, units=("s", "um"))
BACK = np.where(TIME < 50, PLACE, PLACE[500] - (PLACE - PLACE[500]))
SAW = 0.6 + 0.01 * (TIME % 7.0) / 7.0 * (TIME > 45)
GROWS = FRICTION + 1e-4 * np.exp(np.maximum(TIME - 50, 0) / 11) * np.sin(TIME)
NOISE = np.round(SLIP / UM, 1) * UM
BAD = {
    "no unit": ("stiffness", lambda: F.rate_and_state(GOOD, stiffness="1.6e-3")),
    "a number": ("stiffness", lambda: F.rate_and_state(GOOD, stiffness=1.6e-3)),
    "of a time": ("stiffness", lambda: F.rate_and_state(GOOD, stiffness="1.6e-3 / s")),
    "over nothing": ("stiffness", lambda: F.rate_and_state(GOOD, stiffness="0.16 MPa/um")),
    "grows": ("record", lambda: F.rate_and_state(F.Record.of_machine(TIME, GROWS, load_point=PLACE))),
    "saw": ("record", lambda: F.rate_and_state(F.Record.of_machine(TIME, SAW, load_point=PLACE))),
    "back": ("load point", lambda: F.Record.of_machine(TIME, FRICTION, load_point=BACK, units=("s", "um"))),
    "one velocity": (
        "record",
        lambda: F.rate_and_state(F.Record.of_machine(TIME[:300], FRICTION[:300], load_point=PLACE[:300])),
    ),
    "nothing": ("load_point", lambda: F.Record.of_machine(TIME, FRICTION)),
    "few": ("load_point", lambda: F.Record.of_machine(TIME, FRICTION, load_point=PLACE[1:])),
    "rounded": ("record", lambda: F.hold_peaks(F.Record.of_displacement(TIME, NOISE, FRICTION))),
}


def test_what_no_machine_records_is_refused():
    each_refuses(
        *BAD.values(),
        got="'1.6e-3' | 0.0016 | '1.6e-3 / s' | '0.16 MPa/um' | 4 | 8 | 1 | 1e-06 | 1101 | 1101 | 18",
    )
