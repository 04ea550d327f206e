"""Measured relaxation, creep and dynamic moduli: read, fitted, refused, drawn."""

import itertools
import math
import re
from functools import partial
from math import pi, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.special import gamma
from scipy.stats import binom

from asperity.figures import relaxation_figure
from asperity.relaxation import Creep, Dynamic, PronySeries, Relaxation, fit, fractional_zener, material, read
from asperity.relaxation.files import Kind
from tests import CASES
from tests.continua import talbot
from tests.refusals import each_refuses, refuses

TABLE = Path(__file__).parents[2] / "docs" / "data" / "pmma_like_relaxation.csv"
SOLID = PronySeries(3e9, ((0.1, 1e-3), (0.2, 0.04), (0.15, 1.0), (0.25, 70.0), (0.1, 2e3)))
ENDS: dict[str, float] = {"first": 1e-6, "last": 1e6, "accuracy": 1e-4}
BROAD = fractional_zener(instantaneous=3e9, relaxed=3e8, exponent=0.4, time=1.0, **ENDS)
TWO = PronySeries(1.80539e9, ((184.62 / 1805.39, 8.93), (191.06 / 1805.39, 117.96)))
"""PMMA in compression, from a fit of W. W. Chen et al., J. Tribol. 133, 041404 (2011)."""
TO_LAST = PronySeries(2e9, ((0.3, 1.0), (0.2, 117.0)))
TIME = np.geomspace(1e-4, 1e4, 65)
SECONDS = np.geomspace(0.1, 1000.0, 41)
KINDS = ["relaxation", "creep", "dynamic"]


def noisy(values, noise, seed):
    return values * np.random.default_rng(seed).normal(1, noise, values.shape)


def measured(kind, solid, time, noise=0.0):
    """What a solid shows in an experiment of this kind."""
    if kind == "relaxation":
        return Relaxation(time, noisy(solid.modulus_at(time), noise, 0))
    if kind == "creep":
        return Creep(time, noisy(solid.compliance_at(time), noise, 0))
    storage, loss = noisy(solid.storage(1 / time), noise, 0), noisy(solid.loss(1 / time), noise, 100)
    return Dynamic(1 / time, storage, loss)


def test_the_glass_whose_table_we_ship_is_fitted_over_nine_decades_by_ten_branches():
    def formula(time):
        """Of the table's header, Pa."""
        return 350e6 + 3150e6 * np.exp(-((time / 1e7) ** 0.16))

    data = read(TABLE)
    assert isinstance(data, Relaxation)
    np.testing.assert_allclose(data.modulus, formula(data.time), rtol=1e-5)
    found = fit(data)
    t = np.geomspace(1e-3, 1e6, 1000)
    deviation = np.abs(found.series.modulus_at(t) / formula(t) - 1).max()
    assert deviation < 1.3 * found.series.error < 0.003
    assert len(found.series.branches) == 10
    assert found.decades == pytest.approx(9)
    assert found.rms < found.series.error
    assert fit(data, per_decade=2).series.error < found.series.error / 10


@pytest.mark.parametrize("kind", KINDS)
def test_noisy_data_give_the_solid_back_within_the_stated_error(kind):
    found = fit(measured(kind, BROAD, TIME, noise=0.01), per_decade=1.5)
    assert 0.7 * 0.01 < found.rms < 1.5 * 0.01
    assert found.rms < found.series.error < 6 * 0.01
    t = np.geomspace(1e-4, 1e4, 200)
    deviation = np.abs(found.series.modulus_at(t) / BROAD.modulus_at(t) - 1)
    assert deviation.max() < found.series.error


@pytest.mark.parametrize("kind", KINDS)
def test_two_exact_branches_are_found(kind):
    data = measured(kind, TWO, SECONDS)
    found = fit(data)
    np.testing.assert_allclose(found.series.branches, TWO.branches, rtol=1e-6)
    assert found.series.permanent == pytest.approx(TWO.permanent, rel=1e-6)
    assert found.series.modulus == pytest.approx(TWO.modulus, rel=1e-6)
    assert found.per_decade is None
    assert (np.diff(found.data.columns[0]) > 0).all()  # also of a frequency that was swept downward
    np.testing.assert_allclose(fit(data, branches=2).series.branches, TWO.branches, rtol=1e-6)
    on_grid = fit(data, per_decade=1)
    assert on_grid.systematic
    assert on_grid.resampled == ()


@pytest.mark.slow
def test_two_noisy_branches_are_found_within_their_intervals():
    held, widths = np.zeros((2, 2)), []
    # Standard errors of ln G(t) with shares and times of two branches, by propagation of 1 % of noise.
    numbers = np.array([1.0, *np.ravel(TWO.branches)])

    def logarithm(numbers):
        return np.log(PronySeries(numbers[0], numbers[1:].reshape(2, 2)).modulus_at(SECONDS))

    steps = 1e-6 * np.diag(numbers)
    slopes = [(logarithm(numbers + d) - logarithm(numbers - d)) / (2 * d.sum()) for d in steps]
    errors = 0.01 * np.sqrt(np.diag(np.linalg.inv(np.array(slopes) @ np.transpose(slopes))))[1:].reshape(2, 2)
    for seed in range(CASES):
        found = fit(Relaxation(SECONDS, noisy(TWO.modulus_at(SECONDS), 0.01, seed), noise=0.2))
        assert len(found.series.branches) == 2
        assert not found.systematic
        intervals = found.intervals
        assert intervals is not None
        widths.append(np.diff(np.log(intervals), axis=-1)[..., 0])
        held += (intervals[..., 0] <= TWO.branches) & (TWO.branches <= intervals[..., 1])
    # A single table finds its own time, and its interval is as wide as that time says: the median is judged.
    expected = 2 * 1.96 * errors / TWO.branches
    np.testing.assert_allclose(np.median(widths, axis=0), expected, rtol=0.3)
    # Of 95 %: within what chance leaves to one number in a thousand tests.
    least, most = binom.ppf(np.array([0.001, 0.999]), CASES, 0.95)
    assert np.all((held >= least) & (held <= most))


@pytest.mark.slow
@pytest.mark.parametrize(("noise", "per_decade"), [(0.0, 2), (0.01, 1)])
def test_a_broad_spectrum_gets_as_many_times_a_decade_as_its_noise_allows(noise, per_decade):
    time = np.geomspace(1e-3, 1e6, 46)
    data = Relaxation(time, noisy(1e9 * (time / 1e-3) ** -0.1, noise, 0), noise=0.2)
    found = fit(data)
    assert found.per_decade == per_decade
    np.testing.assert_allclose(np.diff(np.log10(found.times)), 1 / per_decade)
    assert not found.systematic
    assert found.intervals is None
    assert fit(data, per_decade=1).finer == (None if noise else 2)


WINDOW = np.geomspace(0.01, 100.0, 25)


def power_solid(kind, exponent, plateau):
    """A table of the solid G* = plateau + (i omega)^exponent, and its J(t): closed, or by Talbot."""
    frequency, n = 1 / WINDOW, exponent
    modulus = plateau + (1j * frequency) ** n
    exact = WINDOW**n / gamma(1 + n)
    if plateau:
        exact = np.array([talbot(lambda s: 1 / (s * (plateau + s**n)), t) for t in WINDOW])
    tables = {
        "relaxation": Relaxation(WINDOW, plateau + WINDOW**-n / gamma(1 - n)),
        "creep": Creep(WINDOW, exact),
        "dynamic": Dynamic(frequency, modulus.real, modulus.imag),
    }
    return tables[kind], exact


FEW = [("relaxation", 0.2, 0.0), ("relaxation", 0.6, 1.0), ("dynamic", 0.6, 1.0)]
MANY = itertools.product(KINDS, [0.05, 0.1, 0.2, 0.4, 0.6], [0.0, 1.0])


@pytest.mark.parametrize(
    ("kind", "exponent", "plateau"),
    [pytest.param(*one, marks=[] if one in FEW else pytest.mark.slow) for one in MANY],
)
def test_one_solid_creeps_alike_by_its_three_tables(kind, exponent, plateau):
    data, exact = power_solid(kind, exponent, plateau)
    found = fit(data)
    creep = found.series.compliance_at(WINDOW)
    # Two times a decade leave 0.3 % of J; what relaxes before the first time is assumed, and its end a guess.
    np.testing.assert_allclose(creep, exact, rtol=0.03 if (kind, exponent) == ("relaxation", 0.6) else 0.006)
    growths = [one.compliance_at(WINDOW[[0, -1]]) for one in found.alternatives]
    low, high = np.quantile([last / first for first, last in growths], (0.025, 0.975))
    assert 0.997 * low < exact[-1] / exact[0] < 1.003 * high
    assert found.rms < 0.006
    if kind == "relaxation":
        # G(first) J(first) of a power; 1 where nothing precedes.
        before = sin(pi * exponent) / (pi * exponent)
        assert (found.assumed != "") == (before < (0.99 if plateau == 0 else 0.97))
        assert high / low > 1 + (1 - before) / 2


def test_relaxation_beyond_the_last_time_is_found_where_the_data_ask_for_it():
    beyond = PronySeries(2e9, ((0.3, 2.0), (0.4, 5e3)))
    found = fit(Relaxation(SECONDS, beyond.modulus_at(SECONDS)))
    np.testing.assert_allclose(found.series.branches, beyond.branches, rtol=1e-3)


@pytest.mark.parametrize("kind", ["relaxation", "creep"])
def test_a_value_at_time_0_is_the_instantaneous_one(kind):
    solid = PronySeries(2e9, ((0.3, 1e-3), (0.2, 2.0)))  # a time that no other point knows
    time = np.append(0.0, np.geomspace(0.01, 100.0, 25))
    found = fit(measured(kind, solid, time, noise=1e-4))
    assert found.data.span == pytest.approx((0.01, 100.0))
    assert found.series.modulus == pytest.approx(2e9, rel=1e-3)
    np.testing.assert_allclose(found.series.compliance_at(time), solid.compliance_at(time), rtol=1e-3)
    assert found.curve()[0][0] == pytest.approx(0.01)


def test_waves_are_told_from_noise():
    deviations = np.random.default_rng(0).normal(0, 0.01, (60, SECONDS.size))
    flat = [fit(Relaxation(SECONDS, 1e9 * (1 + one), noise=0.2), branches=1) for one in deviations]
    assert np.mean([one.systematic for one in flat]) < 0.04  # 1 % by definition
    wave = 0.01 * np.sin(np.log(SECONDS) * 3)
    assert fit(Relaxation(SECONDS, 1e9 * (1 + wave), noise=0.2), branches=1).systematic


def test_creep_that_flows_is_a_fluid_and_creep_that_does_not_a_solid():
    found = fit(measured("creep", PronySeries(5.0, ((0.3, 0.1), (0.7, 20.0))), TIME), per_decade=2)
    assert found.series.permanent == 0
    assert found.series.error < 0.02
    solid = fit(measured("creep", SOLID, TIME), per_decade=1)
    assert solid.series.permanent == pytest.approx(0.2, abs=0.03)


def test_other_temperatures_shift_the_data():
    for kind, factor in (("relaxation", 10), ("creep", 10), ("dynamic", 1 / 10)):
        data = measured(kind, SOLID, TIME)
        shifted = data.shifted(10.0)
        np.testing.assert_allclose(shifted.columns[0], factor * data.columns[0])
        np.testing.assert_array_equal(shifted.columns[1], data.columns[1])


G = np.array([5.0, 4.0, 3.0, 2.5, 2.2, 2.1])
T = np.array([0.1, 1.0, 10.0, 100.0, 1e3, 1e4])


def changed(values, at, to):
    copy = values.copy()
    copy[at] = to
    return copy


def test_what_is_no_relaxation_or_no_fit_is_refused():
    falling = Relaxation(T, G)
    flat, swept = (measured(kind, TO_LAST, SECONDS) for kind in ("relaxation", "dynamic"))
    calls: list[tuple[Any, ...]] = [
        ("time", "0.5", lambda: Relaxation(changed(T, 2, 0.5), G)),
        ("time", "-0.1", lambda: Relaxation(changed(T, 0, -0.1), G)),
        ("modulus", "3", lambda: Relaxation(T, changed(G, 3, 3.3))),
        ("modulus", "1", lambda: Relaxation(T, changed(G, 5, math.nan))),
        # Each step is small; their sum is not.
        ("modulus", "5", lambda: Relaxation(T, np.array([5.0, 5.2, 5.4, 5.6, 5.8, 6.0]))),
        ("time", "4", lambda: Relaxation(T[:4], G[:4])),
        ("modulus", "5", lambda: Relaxation(T, G[:5])),
        ("compliance", "5", lambda: Creep(T, G)),
        ("storage", "5", lambda: Dynamic(T, G, G)),
        ("loss", "2", lambda: Dynamic(T, 1 / G, changed(G, 1, -2))),
        ("data", "ndarray", lambda: fit(T)),  # type: ignore[arg-type]
        ("per_decade", "99", lambda: fit(falling, per_decade=99)),
        ("branches", "3", lambda: fit(falling, branches=3)),
        ("branches", "1", lambda: fit(falling, branches=1, per_decade=1.0)),
        ("compliance", "0.0001", lambda: fit(Creep(TIME, 1e-3 * TIME))),
        ("extrapolate", "'plateau'", lambda: fit(swept, extrapolate="plateau")),
        ("extrapolate", "'flat'", lambda: fit(flat, extrapolate="flat")),  # type: ignore[arg-type]
    ]
    each_refuses(*calls)
    assert Relaxation(T, changed(G, 3, 3.3), noise=0.11).noise == 0.11


@pytest.fixture
def write(here):
    """Write a table of a header and columns."""

    def table(header, *columns):
        np.savetxt("table.csv", np.transpose(columns), fmt="%.9g", delimiter=", ", header=header, comments="")
        return "table.csv"

    return table


def test_columns_without_units_are_refused_unless_units_are_stated(write):
    cases: list[tuple[str, tuple[Any, ...], str, Any, tuple[float, ...]]] = [
        ("time_s,E", (T, G), "'E'", "E=GPa", (1, 1e9)),
        ("frequency,G,G", (T, 1 / G, G), "'frequency'", {0: "Hz", 1: "Pa", "2": "kPa"}, (2 * pi, 1, 1e3)),
        ("time,J", (T, 1 / G), "'time'", ["time=min", "compliance=1/GPa"], (60, 1e-9)),
        ("", (T, 1 / G), "0", ("0=s", "1=1/Pa"), (1, 1)),
    ]
    for header, columns, name, units, factors in cases:
        kind: Kind | None = None if header else "creep"
        file = write(header, *columns)
        with refuses(f"column {name} of table.csv", "none"):
            read(file, kind=kind)
        x, values = read(file, kind=kind, units=units).columns
        for found, column, factor in zip((x, *values), columns, factors, strict=True):
            np.testing.assert_allclose(found, column * factor, rtol=1e-8)


def test_tables_that_are_several_or_none(write):
    file = write("time_s,E_MPa,J_1/MPa,more_MPa", T, G, 1 / G, 2 * G)
    for chosen in ({"kind": "creep"}, {"columns": ["time_s", "J_1/MPa"]}):
        assert isinstance(read(file, **chosen), Creep)
    calls: list[tuple[str, dict[str, Any]]] = [
        ("table.csv", {}),
        ("column 'nope' of table.csv", {"columns": ["time_s", "nope"]}),
        ("columns", {"columns": [0, 0], "kind": "relaxation"}),
        ("kind", {"kind": "dma"}),
    ]
    each_refuses(
        *((name, partial(read, file, **options)) for name, options in calls),
        got="'time_s' | no such column | 0 0 | 'dma'",
    )
    for header, got, columns, name in (
        ("time_s,E_MPa", "0.5", [changed(T, 2, 0.5), G], "table.csv, time"),
        ("time_s,E_MPa", "'10, nan'", [T, changed(G, 2, math.nan)], "table.csv"),
        ("a,b", "columns 'a', 'b'", [T, G], "table.csv"),
        ("", "2 columns without names", [T, G], "table.csv"),
    ):
        write(header, *columns)
        with refuses(name, got):
            read(file)


@pytest.mark.parametrize("kind", KINDS)
def test_the_figure_draws_the_numbers(kind):
    def points(line):
        return np.array(line.get_xydata(), dtype=float)

    data = measured(kind, SOLID, TIME)
    found = fit(data, per_decade=1)
    upper, middle, lower = relaxation_figure(found).axes
    scale = 1e9 if kind == "creep" else 1e-9
    x, values = data.columns
    drawn = [line for line in upper.lines if line.get_linestyle() == "None"]
    for line, column, name in zip(drawn, values, data.quantities, strict=True):
        np.testing.assert_allclose(points(line), np.column_stack([x, column * scale]))
        assert line.get_label() == name
    np.testing.assert_allclose(points(middle.lines[0])[:, 1], 100 * found.residuals()[0])
    (marks,) = lower.lines
    shares, times = np.array(found.series.branches).T
    places = 1 / times if kind == "dynamic" else times
    np.testing.assert_allclose(points(marks), np.column_stack([places, 100 * shares]))
    said = re.search(r"fit error (\S+) % rms, (\S+) % at most", upper.figure.get_suptitle())
    assert said is not None
    assert float(said[1]) == pytest.approx(100 * found.rms, rel=0.05)
    assert float(said[2]) == pytest.approx(100 * found.series.error, rel=0.05)


@pytest.mark.parametrize(
    ("modulus", "per_decade", "count"),
    [(TO_LAST.modulus_at(SECONDS), None, 2), (2e9 * (1 + SECONDS) ** -0.1, 1.0, 4)],
    ids=["two branches", "power law"],
)
def test_on_a_plateau_the_last_modulus_stays_within_the_misfit(modulus, per_decade, count):
    data = Relaxation(SECONDS, modulus)
    found = fit(data, per_decade=per_decade, extrapolate="plateau")
    assert found.series.span == pytest.approx((0.1, math.inf))
    assert len(found.series.branches) == count
    later = found.series.modulus_at([5e3, 1e5, 1e8])
    np.testing.assert_allclose(later, modulus[-1], rtol=found.series.error)
    np.testing.assert_array_equal(found.data.columns[0], SECONDS)  # the table stays what was measured
    assert found.decades == pytest.approx(4)
    assert (found.assumed != "", fit(data, per_decade=1).assumed) == (True, "")
    crept = fit(Creep(SECONDS, 1 / modulus), per_decade=1.0, extrapolate="plateau")
    compliance = crept.series.compliance_at([5e3, 1e5])
    np.testing.assert_allclose(compliance, 1 / modulus[-1], rtol=crept.series.error)


TIMES = np.geomspace(0.1, 100, 30)
FALLING = 0.4 + 0.6 * np.exp(-TIMES / 3)


def table_of(folder, header, *columns):
    path = folder / "table.csv"
    rows = [",".join(map(repr, map(float, row))) for row in zip(TIMES, *columns, strict=True)]
    path.write_text("\n".join([header, *rows]))
    return path


@pytest.mark.parametrize(
    ("header", "values"), [("time_s,force_nN", 300 * FALLING), ("t [s],stress [kPa]", 7 * FALLING)]
)
def test_a_force_at_a_held_depth_is_a_relaxation_up_to_a_factor(header, values, tmp_path):
    path = table_of(tmp_path, header, values)
    assert not read(path).absolute
    with refuses("young", "none"):
        material(path)
    for how, modulus in (({"young": "2 MPa", "poisson": 0.5}, 2e6 / 0.75), ({"modulus": "3 MPa"}, 3e6)):
        made = material(path, branches=1, **how)
        assert made.solid.modulus == pytest.approx(modulus)
        np.testing.assert_allclose(made.solid.relaxing, [(0.6, 3.0)], rtol=1e-3)
        # The table has the modulus of the fit, as the picture shows both.
        assert made.fit.data.columns[1][0][0] == pytest.approx(made.fit.series.modulus_at(TIMES[:1])[0])


def test_a_force_of_a_ball_is_a_modulus_by_its_radius_and_depth(tmp_path):
    """Hertz: F = 4/3 E* sqrt(R d^3), with the contact modulus of the series at each time."""
    series = PronySeries(1e6, ((0.6, 3.0),))
    force = 4 / 3 * series.modulus_at(TIMES) * np.sqrt(5e-6 * (1e-6) ** 3)
    path = table_of(tmp_path, "time_s,force_nN", 1e9 * force)
    made = material(path, ball_radius="5 um", ball_depth="1 um", branches=1)
    assert made.solid.modulus == pytest.approx(1e6)
    np.testing.assert_allclose(made.solid.relaxing, [(0.6, 3.0)], rtol=1e-3)
    with refuses("ball_depth", "none"):
        material(path, ball_radius="5 um")
    with refuses("ball_radius", "5 um"):
        material(table_of(tmp_path, "time_s,E_MPa", force / force[0]), ball_radius="5 um", ball_depth="1 um")


def test_a_strain_is_a_creep_by_its_stress(tmp_path):
    series = PronySeries(5e6, ((0.6, 3.0),))
    compliance = series.compliance_at(TIMES)
    path = table_of(tmp_path, "time_s,strain_%", compliance * 2e4 * 100)
    data = read(path, stress="20 kPa")
    np.testing.assert_allclose(data.compliance, compliance)
    made = material(path, stress="20 kPa", poisson=0.0, branches=1)
    assert made.solid.modulus == pytest.approx(5e6, rel=1e-3)
    np.testing.assert_allclose(made.solid.relaxing, [(0.6, 3.0)], rtol=1e-3)
    without = material(path, young="5 MPa", poisson=0.0, branches=1)
    np.testing.assert_allclose(without.solid.relaxing, made.solid.relaxing)
    with refuses("stress", "1.0"):
        read(table_of(tmp_path, "time_s,E_MPa", FALLING), stress=1.0)


@pytest.mark.parametrize(
    "header", ["time_s,force_nN,depth_nm", "time_s,strain,stress_MPa", "time_s,displacement_um"]
)
def test_what_is_held_must_be_clear(header, tmp_path):
    path = table_of(tmp_path, header, *[FALLING] * header.count(","))
    with refuses(str(path), header.split(",")[1]):
        read(path)
