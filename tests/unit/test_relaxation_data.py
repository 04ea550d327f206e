"""Measured relaxation, creep and dynamic moduli: read, fitted, refused, drawn."""

import math
import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asperity.errors import Remark
from asperity.figures import relaxation_figure
from asperity.relaxation import Creep, Dynamic, PronySeries, Relaxation, fit, fractional_zener, read
from tests.refusals import refuses

TABLE = Path(__file__).parents[2] / "docs" / "data" / "pmma_like_relaxation.csv"
SOLID = PronySeries(3e9, ((0.1, 1e-3), (0.2, 0.04), (0.15, 1.0), (0.25, 70.0), (0.1, 2e3)))
BROAD = fractional_zener(
    instantaneous=3e9, relaxed=3e8, exponent=0.4, time=1.0, first=1e-6, last=1e6, accuracy=1e-4
)
TIME = np.geomspace(1e-4, 1e4, 65)


def pmma_like(time: np.ndarray) -> np.ndarray:
    """The formula in the table's header, Pa."""
    return 350e6 + 3150e6 * np.exp(-((time / 1e7) ** 0.16))


def noisy(values: np.ndarray, noise: float, seed: int) -> np.ndarray:
    return values * np.random.default_rng(seed).normal(1, noise, values.shape)


def test_the_table_that_we_ship_is_its_formula() -> None:
    data = read(TABLE)
    assert isinstance(data, Relaxation)
    assert data.span == pytest.approx((1e-3, 1e6))
    np.testing.assert_allclose(data.modulus, pmma_like(data.time), rtol=1e-5)
    head = TABLE.read_text().splitlines()[0]
    assert "Made up" in head


def test_a_glass_over_nine_decades_by_ten_branches() -> None:
    found = fit(read(TABLE), over=(1e-3, 1e6))
    t = np.geomspace(1e-3, 1e6, 1000)
    deviation = np.abs(found.series.modulus_at(t) / pmma_like(t) - 1).max()
    assert deviation < 1.3 * found.series.error < 0.003
    assert len(found.series.branches) == 10
    assert found.decades == pytest.approx(9)
    assert found.rms < found.series.error
    closer = fit(read(TABLE), per_decade=2)
    assert closer.series.error < found.series.error / 10


@pytest.mark.parametrize("kind", ["relaxation", "creep", "dynamic"])
def test_noisy_data_give_the_solid_back_within_the_stated_error(kind: str) -> None:
    noise, seed = 0.01, 0
    data: Relaxation | Creep | Dynamic
    if kind == "relaxation":
        data = Relaxation(TIME, noisy(BROAD.modulus_at(TIME), noise, seed))
    elif kind == "creep":
        data = Creep(TIME, noisy(BROAD.compliance_at(TIME), noise, seed))
    else:
        values = BROAD.storage(1 / TIME), BROAD.loss(1 / TIME)
        data = Dynamic(1 / TIME, noisy(values[0], noise, seed), noisy(values[1], noise, seed + 100))
    found = fit(data, per_decade=1.5)
    assert 0.7 * noise < found.rms < 1.5 * noise
    assert found.rms < found.series.error < 6 * noise
    t = np.geomspace(1e-4, 1e4, 200)
    deviation = np.abs(found.series.modulus_at(t) / BROAD.modulus_at(t) - 1)
    assert deviation.max() < found.series.error


def test_exact_dynamic_moduli_on_the_fits_own_times_are_met_exactly() -> None:
    own = PronySeries(2.0, ((0.2, 0.01), (0.3, 1.0), (0.4, 100.0)))
    frequency = np.geomspace(1e2, 1e-2, 33)  # falling, as instruments sweep
    found = fit(Dynamic(frequency, own.storage(frequency), own.loss(frequency)))
    np.testing.assert_allclose(np.array(found.series.branches), np.array(own.branches), rtol=1e-9)
    assert found.series.error < 1e-12
    assert found.data.columns[0][0] == frequency[-1]


TWO = PronySeries(1.80539e9, ((184.62 / 1805.39, 8.93), (191.06 / 1805.39, 117.96)))
"""PMMA in compression, from a fit of W. W. Chen et al., J. Tribol. 133, 041404 (2011)."""
SECONDS = np.geomspace(0.1, 1000.0, 41)
TO_LAST = PronySeries(2e9, ((0.3, 1.0), (0.2, 117.0)))


@pytest.mark.parametrize(
    "data",
    [
        Relaxation(SECONDS, TWO.modulus_at(SECONDS)),
        Creep(SECONDS, TWO.compliance_at(SECONDS)),
        Dynamic(1 / SECONDS, TWO.storage(1 / SECONDS), TWO.loss(1 / SECONDS)),
    ],
)
def test_two_exact_branches_are_found(data: Relaxation | Creep | Dynamic) -> None:
    found = fit(data)
    np.testing.assert_allclose(found.series.branches, TWO.branches, rtol=1e-6)
    assert found.series.permanent == pytest.approx(TWO.permanent, rel=1e-6)
    assert found.series.modulus == pytest.approx(TWO.modulus, rel=1e-6)
    assert found.per_decade is None
    np.testing.assert_allclose(fit(data, branches=2).series.branches, TWO.branches, rtol=1e-6)
    on_grid = fit(data, per_decade=1)
    assert on_grid.systematic
    assert on_grid.resampled == ()


@pytest.mark.parametrize("tables", [1, pytest.param(10, marks=pytest.mark.slow)])
def test_two_noisy_branches_are_found_within_their_intervals(tables: int) -> None:
    held, widths = np.zeros((2, 2)), []
    # Standard errors of ln G(t) with shares and times of two branches, by propagation of 1 % of noise.
    numbers = np.array([1.0, *np.ravel(TWO.branches)])

    def logarithm(numbers: np.ndarray) -> np.ndarray:
        (modulus, *branches), t = numbers, SECONDS
        pairs = zip(branches[::2], branches[1::2], strict=True)
        return np.asarray(np.log(modulus * (1 + sum(share * np.expm1(-t / time) for share, time in pairs))))

    steps = 1e-6 * np.diag(numbers)
    slopes = [(logarithm(numbers + d) - logarithm(numbers - d)) / (2 * d.sum()) for d in steps]
    errors = 0.01 * np.sqrt(np.diag(np.linalg.inv(np.array(slopes) @ np.transpose(slopes))))[1:].reshape(2, 2)
    for seed in range(tables):
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
    assert held.min() >= 0.8 * tables  # of 95 %
    assert held.sum() >= 0.88 * 4 * tables


@pytest.mark.parametrize("seed", [None, 0])
def test_a_broad_spectrum_gets_a_time_for_each_decade(seed: int | None) -> None:
    time = np.geomspace(1e-3, 1e6, 46)
    modulus = 1e9 * (time / 1e-3) ** -0.1
    found = fit(Relaxation(time, modulus if seed is None else noisy(modulus, 0.01, seed), noise=0.2))
    assert found.per_decade == 1
    np.testing.assert_allclose(found.times, 10.0 ** np.arange(-3, 7), rtol=1e-12)
    assert found.systematic == (seed is None)
    assert found.intervals is None


def test_waves_are_told_from_noise() -> None:
    deviations = np.random.default_rng(0).normal(0, 0.01, (60, SECONDS.size))
    flat = [fit(Relaxation(SECONDS, 1e9 * (1 + one), noise=0.2), branches=1) for one in deviations]
    assert np.mean([one.systematic for one in flat]) < 0.04  # 1 % by definition
    wave = 0.01 * np.sin(np.log(SECONDS) * 3)
    assert fit(Relaxation(SECONDS, 1e9 * (1 + wave), noise=0.2), branches=1).systematic


def test_creep_that_flows_is_a_fluid_and_creep_that_does_not_a_solid() -> None:
    fluid = PronySeries(5.0, ((0.3, 0.1), (0.7, 20.0)))
    found = fit(Creep(TIME, fluid.compliance_at(TIME)), per_decade=2)
    assert found.series.permanent == 0
    assert found.series.error < 0.02
    solid = fit(Creep(TIME, SOLID.compliance_at(TIME)), per_decade=1)
    assert solid.series.permanent == pytest.approx(0.2, abs=0.03)


def test_other_temperatures_shift_the_data() -> None:
    data = read(TABLE)
    warm = fit(data.shifted(1e-2))
    assert warm.series.span == pytest.approx((1e-5, 1e4))
    cold = fit(data).series.shifted(1e-2)
    t = np.geomspace(1e-5, 1e4, 30)
    np.testing.assert_allclose(warm.series.modulus_at(t), cold.modulus_at(t), rtol=1e-9)
    swept = Dynamic(TIME, SOLID.storage(TIME), SOLID.loss(TIME)).shifted(10.0)
    np.testing.assert_allclose(swept.frequency, TIME / 10)


G = np.array([5.0, 4.0, 3.0, 2.5, 2.2, 2.1])
T = np.array([0.1, 1.0, 10.0, 100.0, 1e3, 1e4])


def changed(values: np.ndarray, at: int, to: float) -> np.ndarray:
    copy = values.copy()
    copy[at] = to
    return copy


def test_what_is_no_relaxation_or_no_fit_is_refused() -> None:
    falling, measured = Relaxation(T, G), read(TABLE)
    flat = Relaxation(SECONDS, TO_LAST.modulus_at(SECONDS))
    frequency = 1 / SECONDS[::-1]
    swept = Dynamic(frequency, TO_LAST.storage(frequency), TO_LAST.loss(frequency))
    found = fit(measured, per_decade=1)
    found.require(1e-3, 1e6)
    calls: list[tuple[str, Callable[[], Any]]] = [
        ("time", lambda: Relaxation(changed(T, 2, 0.5), G)),
        ("time", lambda: Relaxation(changed(T, 0, 0.0), G)),
        ("modulus", lambda: Relaxation(T, changed(G, 3, 3.3))),
        ("modulus", lambda: Relaxation(T, changed(G, 5, -1))),
        ("modulus", lambda: Relaxation(T, changed(G, 5, math.nan))),
        # Each step is small; their sum is not.
        ("modulus", lambda: Relaxation(T, np.array([5.0, 5.2, 5.4, 5.6, 5.8, 6.0]))),
        ("time", lambda: Relaxation(T[:4], G[:4])),
        ("modulus", lambda: Relaxation(T, G[:5])),
        ("compliance", lambda: Creep(T, G)),
        ("storage", lambda: Dynamic(T, G, G)),
        ("loss", lambda: Dynamic(T, 1 / G, changed(G, 1, -2))),
        ("data", lambda: fit(T)),  # type: ignore[arg-type]
        ("per_decade", lambda: fit(falling, per_decade=99)),
        ("branches", lambda: fit(falling, branches=3)),
        ("branches", lambda: fit(falling, branches=0)),
        ("branches", lambda: fit(falling, branches=1, per_decade=1.0)),
        ("compliance", lambda: fit(Creep(TIME, 1e-3 * TIME))),
        ("times", lambda: found.require(1e-4, 1.0)),
        ("times", lambda: fit(measured, per_decade=1, over=(1e-3, 1e7))),
        ("over", lambda: fit(measured, per_decade=1, over=3)),  # type: ignore[arg-type]
        ("extrapolate", lambda: fit(swept, extrapolate="plateau")),
        ("extrapolate", lambda: fit(flat, extrapolate="flat")),  # type: ignore[arg-type]
        ("times", lambda: fit(flat, over=(0.1, 5e3))),
        ("times", lambda: fit(flat, over=(0.01, 5e3), extrapolate="plateau")),
    ]
    for name, call in calls:
        with refuses(name):
            call()
    assert Relaxation(T, changed(G, 3, 3.3), noise=0.11).noise == 0.11


def write(path: Path, header: str, *columns: np.ndarray) -> Path:
    rows = [", ".join(f"{value:.9g}" for value in row) for row in zip(*columns, strict=True)]
    file = path / "table.csv"
    file.write_text("\n".join([header, *rows] if header else rows) + "\n")
    return file


def test_headers_say_what_columns_are_and_in_which_unit(tmp_path: Path) -> None:
    headers: list[tuple[str, tuple[float, ...]]] = [
        ("time_s,E_MPa", (1, 1e6)),
        ("t/s,E/GPa", (1, 1e9)),
        ("Time (h),E(t) [MPa]", (3600, 1e6)),
        ("t [ms],relaxation modulus (psi)", (1e-3, 6894.757293168)),
        ("elapsed time (min),G in N/mm^2", (60, 1e6)),
        ("t_s,J_1/GPa", (1, 1e-9)),
        ("time [s],J(t) [GPa^-1]", (1, 1e-9)),
        ("time_s,compliance_per_MPa", (1, 1e-6)),
        ("time_s,creep compliance [1/Pa]", (1, 1)),
        ("frequency_Hz,storage_MPa,loss_MPa", (2 * math.pi, 1e6, 1e6)),
        ("omega_rad_s,G' (kPa),G'' (kPa)", (1, 1e3, 1e3)),
        ("f [Hz],E' [MPa],E'' [MPa],tan delta", (2 * math.pi, 1e6, 1e6)),
        ("angular frequency (1/s),E'(omega) [Pa],E''(omega) [Pa]", (1, 1, 1)),
        ("Frequency (Hz),Storage Modulus (MPa),Loss Modulus (MPa),T [degC]", (2 * math.pi, 1e6, 1e6)),
    ]
    for header, factors in headers:
        columns = [T, 1 / G, G, G][: header.count(",") + 1]
        if len(factors) == 2 and "J" not in header and "ompliance" not in header:
            columns = [T, G]
        data = read(write(tmp_path, header, *columns))
        x, values = data.columns
        for found, column, factor in zip((x, *values), columns, factors, strict=False):
            np.testing.assert_allclose(found, column * factor, rtol=1e-8, err_msg=header)
        assert len(values) == len(factors) - 1
        assert isinstance(data, (Relaxation if values[0][0] > values[0][-1] else Creep, Dynamic))


def test_columns_without_units_are_taken_in_si_with_a_remark(tmp_path) -> None:
    def remarks(*columns, **options):
        with warnings.catch_warnings(record=True, category=Remark, action="always") as caught:
            data = read(write(tmp_path, *columns), **options)
        return data, [str(one.message).partition("csv: ")[2] for one in caught]

    data, told = remarks("time_s,E", T, G)
    assert isinstance(data, Relaxation)
    assert told == ["no unit beside 'E', taken as Pa"]
    data, told = remarks("frequency,G,G", T, 1 / G, G)
    np.testing.assert_allclose(data.columns[0], 2 * math.pi * T)
    assert "no unit beside 'frequency', taken as Hz" in told
    data, told = remarks("", T, 1 / G, kind="creep")
    assert isinstance(data, Creep)
    assert "column 0 has no name, taken as time in s" in told


def test_columns_can_be_chosen(tmp_path: Path) -> None:
    file = write(tmp_path, "time_s,E_MPa,J_1/MPa,more_MPa", T, G, 1 / G, 2 * G)
    assert isinstance(read(file, kind="creep"), Creep)
    assert isinstance(read(file, columns=["time_s", "J_1/MPa"]), Creep)


def test_tables_that_are_none_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write(Path(), "time_s,E_MPa,J_1/MPa,more_MPa", T, G, 1 / G, 2 * G)
    calls: list[tuple[str, dict[str, Any]]] = [
        ("table.csv", {}),
        ("column 'nope' of table.csv", {"columns": ["time_s", "nope"]}),
        ("columns", {"columns": [0, 0], "kind": "relaxation"}),
        ("kind", {"kind": "dma"}),
    ]
    for name, options in calls:
        with refuses(name):
            read("table.csv", **options)
    for header, columns, name in (
        ("time_s,E_MPa", [changed(T, 2, 0.5), G], "table.csv, time"),
        ("time_s,E_MPa", [T, G[::-1]], "table.csv, modulus"),
        ("time_s,E_MPa", [T, changed(G, 2, math.nan)], "table.csv"),
        ("time_s,E [furlong]", [T, G], "column 'E [furlong]' of table.csv"),
        ("time [m],E [Pa]", [T, G], "column 'time [m]' of table.csv"),
        ("a,b", [T, G], "table.csv"),
        ("", [T, G], "table.csv"),
        ("log t [s],E [Pa]", [T, G], "table.csv"),
    ):
        write(Path(), header, *columns)
        with refuses(name):
            read("table.csv")


@pytest.mark.parametrize(
    "data",
    [
        Relaxation(TIME, SOLID.modulus_at(TIME)),
        Creep(TIME, SOLID.compliance_at(TIME)),
        Dynamic(TIME, SOLID.storage(TIME), SOLID.loss(TIME)),
    ],
)
def test_the_figure_draws_the_numbers(data: Relaxation | Creep | Dynamic) -> None:
    found = fit(data, per_decade=1)
    upper, middle, lower = relaxation_figure(found).axes
    scale = 1e9 if isinstance(data, Creep) else 1e-9
    x, values = data.columns
    drawn = [line for line in upper.lines if line.get_linestyle() == "None"]
    assert len(drawn) == len(values)
    for line, column, name in zip(drawn, values, data.quantities, strict=True):
        np.testing.assert_array_equal(line.get_xdata(), x)
        np.testing.assert_allclose(np.asarray(line.get_ydata(), dtype=float), column * scale)
        assert line.get_label() == name
    np.testing.assert_allclose(
        np.asarray(middle.lines[0].get_ydata(), dtype=float), 100 * found.residuals()[0]
    )
    (marks,) = lower.lines
    shares, times = np.array(found.series.branches).T
    np.testing.assert_allclose(np.asarray(marks.get_ydata(), dtype=float), 100 * shares)
    np.testing.assert_allclose(
        np.asarray(marks.get_xdata(), dtype=float), 1 / times if isinstance(data, Dynamic) else times
    )
    said = re.search(r"missed by (\S+) % rms, (\S+) % at most", upper.get_title())
    assert said is not None
    assert float(said[1]) == pytest.approx(100 * found.rms, rel=0.05)
    assert float(said[2]) == pytest.approx(100 * found.series.error, rel=0.05)


@pytest.mark.parametrize(
    ("modulus", "per_decade", "count"),
    [(TO_LAST.modulus_at(SECONDS), None, 2), (2e9 * (1 + SECONDS) ** -0.1, 1.0, 4)],
    ids=["two branches", "power law"],
)
def test_on_a_plateau_the_last_modulus_stays_within_the_misfit(
    modulus: np.ndarray, per_decade: float | None, count: int
) -> None:
    data = Relaxation(SECONDS, modulus)
    found = fit(data, per_decade=per_decade, extrapolate="plateau", over=(0.1, 5e3))
    assert found.series.span == pytest.approx((0.1, math.inf))
    assert len(found.series.branches) == count
    later = found.series.modulus_at([5e3, 1e5, 1e8])
    np.testing.assert_allclose(later, modulus[-1], rtol=found.series.error)
    np.testing.assert_array_equal(found.data.columns[0], SECONDS)  # the table stays what was measured
    assert found.decades == pytest.approx(4)
    assert (found.assumed != "", fit(data, per_decade=1).assumed) == (True, "")
    compliance = 1 / modulus
    crept = fit(Creep(SECONDS, compliance), per_decade=per_decade, extrapolate="plateau")
    np.testing.assert_allclose(
        crept.series.compliance_at([5e3, 1e5]), compliance[-1], rtol=crept.series.error
    )


@pytest.mark.slow
def test_the_tables_that_noise_would_give_end_in_a_plateau_too() -> None:
    data = Relaxation(SECONDS, noisy(TO_LAST.modulus_at(SECONDS), 0.01, 0))
    drawn = fit(data, extrapolate="plateau").resampled
    assert len(drawn) > 100
    for one in drawn:
        last = one.data.columns[1][0][-1]
        np.testing.assert_allclose(one.series.modulus_at(5e3), last, rtol=one.series.error)
