"""The curves: what is drawn is what the tables say, and the tables are what was simulated."""

import math
from collections import Counter
from itertools import pairwise, product
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from matplotlib.container import ErrorbarContainer
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from scipy import stats

import asperity as asp
from asperity_research.paper.figures import curves
from asperity_research.paper.figures.area import figure_2, figure_5
from asperity_research.paper.figures.growth import figure_3, figure_6
from asperity_research.paper.figures.indentation import figure_8, figure_9, indentation
from asperity_research.paper.figures.paper_figure import COLUMN, PAGE, PaperFigure
from asperity_research.paper.studies import PEAK
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.typeset import rich

SITES = 900
TIMES = np.concatenate([[0.0], np.geomspace(1e-2, 1e6, 25)])
POINT_TIMES = np.array([0.0, 0.1, 1.0, 10.0, 100.0, 1e3])
FIGURES = {2: figure_2, 3: figure_3, 5: figure_5, 6: figure_6, 8: figure_8, 9: figure_9}
SCALES = {2: "log log", 3: "log linear, log linear, log log", 5: "log log", 6: "log log, log linear"}
SCALES |= {8: "log linear, log log", 9: "log linear"}


def dataset(axes, values, times=None, sites=SITES):
    """Shaped as `asperity.app.campaign.open` gives it; `values` takes one value of each axis."""
    shape = tuple(len(axis) for axis in axes.values())
    dims = (*axes, "time") if times is not None else tuple(axes)
    results = [values(*place) for place in product(*axes.values())]
    coordinates = axes if times is None else axes | {"time": times}
    made = xr.Dataset(coords=coordinates)
    for name in results[0]:
        array = np.array([np.asarray(result[name], dtype=float) for result in results])
        made[name] = (dims if array.ndim > 1 else tuple(axes), array.reshape(shape + array.shape[1:]))
    return made.assign(sites=(tuple(axes), np.full(shape, float(sites))))


def of_seed(seed):
    """Surfaces differ by a factor of their areas, so that ratios of mean areas are those of each surface."""
    return 1 + 0.1 * math.sin(1 + 7 * seed)


@pytest.fixture(scope="module")
def evidence():
    """Studies in which all laws are known, and one simulated asperity."""
    seed = list(range(4))
    loads = [SITES * p for p in (0.003, 0.03, 0.3)]

    def load(k1, load, seed):
        area = SITES * (1 - math.exp(-load / SITES / (1 + k1)))
        return {"initial_area": of_seed(seed) * area, "relaxed_area": SITES * (1 - math.exp(-load / SITES))}

    def aging(k1, load, seed):
        a, q = 1 + k1, 2 * math.sqrt(load / SITES)
        return {"area": of_seed(seed) * 50 * load / SITES * (a - (a - 1) / (1 + TIMES * k1) ** q)}

    def self_affine_load(size, load, seed):
        return {"initial_area": of_seed(seed) * 9 * load**0.8, "relaxed_area": min(80 * load, size**2)}

    def self_affine_aging(size, k1, load, seed):
        return {"area": of_seed(seed) * load * (1 + 0.1 * k1 * np.log1p(np.minimum(TIMES, 1e4) * k1))}

    def point(k1, R_viscous):
        solid = asp.solids.spring_lattice(k0=1.0, k1=k1, R=1.0, R_viscous=R_viscous)
        history = asp.age(asp.press(heights, solid, load=2.0), times=POINT_TIMES[1:]).dataset
        return {"separation": history["separation"], "approach": history["approach"], "held": 2.0}

    heights = np.zeros((24, 24))
    heights.flat[0] = PEAK
    sizes, points = {"size": [16, 32, 64], "load": [1.0, 10.0, 100.0, 1000.0], "seed": seed}, [0.0, 0.5]
    growing = {"size": [16, 32], "k1": [3.0, 10.0], "load": [5.0, 20.0, 80.0], "seed": seed}
    studies = {
        "load": dataset({"k1": [0.01, 1.0, 10.0], "load": loads, "seed": seed}, load),
        "aging": dataset({"k1": [1.0, 10.0], "load": loads, "seed": seed}, aging, TIMES),
        "self_affine_load": dataset(sizes, self_affine_load),
        "self_affine_aging": dataset(growing, self_affine_aging, TIMES),
        "point": dataset({"k1": [1.0, 3.0], "R_viscous": points}, point, POINT_TIMES, heights.size),
    }
    return Evidence(Path(), studies)


@pytest.fixture(scope="module")
def made(evidence) -> dict[int, PaperFigure]:
    return {number: draw(evidence) for number, draw in FIGURES.items()}


def drawn(axes):
    """Places of all points with error bars, and of the bars' ends (None without any)."""
    for container in axes.containers:
        if isinstance(container, ErrorbarContainer):
            symbols, _, bars = container.lines
            ends = np.array([segment[:, 1] for segment in bars[0].get_segments()]) if bars else None
            yield np.asarray(symbols.get_xydata()), ends, symbols


def lines(axes, style):
    return [line for line in axes.lines if line.get_linestyle() == style and len(line.get_xdata()) > 0]


def slope(line, x_scale=np.log, y_scale=np.log):
    x, y = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
    return (y_scale(y[-1]) - y_scale(y[0])) / (x_scale(x[-1]) - x_scale(x[0]))


def test_every_figure_fits_a_journal_and_says_of_how_many_surfaces_it_is(made):
    for number, one in made.items():
        assert one.number == number
        scales = [f"{axes.get_xscale()} {axes.get_yscale()}" for axes in one.figure.axes]
        assert ", ".join(scales) == SCALES[number]
        assert one.figure.get_size_inches()[0] in (COLUMN, PAGE)
        words = [text for text in one.figure.findobj(Text) if text.get_text() and text.get_visible()]
        assert min(float(text.get_fontsize()) for text in words) >= 7
        assert "&lt;" not in rich(one.caption)  # it raises for tags that are not closed, and escapes others
        assert ("Means over 4 surfaces" in one.caption) == (number < 8)
        assert "nan" not in one.caption
        for name, table in one.tables.items():
            assert len(table) > 0, (number, name)
            assert all(dtype.kind in "fib" for dtype in table.dtypes), (number, name)


def test_over_seeds_is_the_mean_with_the_interval_of_student(evidence):
    table = curves.over_seeds(evidence, "aging", "area", "area")
    raw = evidence["aging"]["area"]
    assert len(table) == raw.size / 4
    for row in table.iloc[:: len(table) // 7].to_dict("records"):
        runs = raw.sel(k1=row["k1"], load=row["load"], time=row["time"]).to_numpy()
        found = [row[name] for name in ("area", "area_low", "area_high", "seeds")]
        interval = stats.t.interval(0.95, 3, runs.mean(), stats.sem(runs))
        assert found == pytest.approx([runs.mean(), *interval, 4], rel=1e-12)


def test_error_bars_end_where_the_interval_does_and_never_below_zero():
    table = pd.DataFrame({"x": [1.0, 2.0], "y": [2.0, 1.0], "y_low": [1.5, -1.0], "y_high": [2.5, 3.0]})
    axes = Figure().add_subplot(xscale="log", yscale="log")
    curves.points(axes, table, "x", "y", curves.Look("#000000"))
    [(places, ends, _)] = drawn(axes)
    np.testing.assert_allclose(places, [[1, 2], [2, 1]])
    np.testing.assert_allclose(ends[0], [1.5, 2.5])
    assert 0 < ends[1, 0] < 1e-3
    assert ends[1, 1] == 3


def test_looks_darken_in_order_and_differ_in_markers():
    looks = list(curves.looks(range(6)).values())
    rgb = [[int(look.color[at : at + 2], 16) for at in (1, 3, 5)] for look in looks]
    gray = [0.299 * r + 0.587 * g + 0.114 * b for r, g, b in rgb]  # luma, ITU-R BT.601
    assert all(later - earlier > 15 for earlier, later in pairwise(gray))
    assert gray[-1] < 190
    assert len({look.marker for look in looks}) == 6


def test_figure_2_shows_contact_fractions_against_loads_per_site(made, evidence):
    one = made[2]
    [axes] = one.figure.axes
    raw = evidence["load"]["initial_area"].mean("seed")
    *shown, (places, _, symbols) = drawn(axes)
    for k1, (at, _, full) in zip(raw["k1"].values, shown, strict=True):
        np.testing.assert_allclose(at, np.column_stack([raw["load"], raw.sel(k1=k1)]) / SITES)
        assert full.get_markerfacecolor() != "none"
    assert symbols.get_markerfacecolor() == "none"
    np.testing.assert_allclose(places[:, 1], 1 - np.exp(-raw["load"] / SITES))
    assert slope(lines(axes, ":")[0]) == pytest.approx(1)
    assert "largest difference of their mean areas: 0 sites" in one.caption


def test_figure_2_draws_independent_asperities_only_where_they_are_apart(made):
    dilute = made[2].tables["dilute"]
    assert set(dilute["k1"]) == {1.0, 10.0}  # at 0.01 dips are 10 sites wide: they meet at a percent and less
    assert dilute["contact_fraction"].max() <= 0.1
    row = dilute[dilute["k1"] == 10.0].iloc[5]
    # Greenwood and Williamson: at the separation that bears the load, the tail of the normal law touches.
    stiffness = float(asp.theory.site_stiffness(10.0))
    separation = stats.norm.isf(row.contact_fraction)
    excess = stats.norm.pdf(separation) - separation * row.contact_fraction
    assert excess * stiffness == pytest.approx(row.load_per_site, rel=1e-9)


def test_figure_3_finds_the_laws_again(made, evidence):
    fits = made[3].tables["fits"]
    assert len(fits) == 6
    for name, law in (("a", 1 + fits.k1), ("q", 2 * np.sqrt(fits.load_per_site)), ("t0", 1 / fits.k1)):
        np.testing.assert_allclose(fits[name], law, rtol=1e-4)
    assert fits["rms_misfit"].max() < 1e-6
    growth = made[3].tables["growth"]
    np.testing.assert_allclose(growth["fitted"], growth["area_ratio"], rtol=1e-5)
    raw = evidence["aging"]["area"].isel(k1=1, load=2).sum("seed")
    last = growth.query("k1 == 10 and load == 270")["area_ratio"].iloc[-1]
    assert last == pytest.approx(float(raw[-1] / raw[0]))


def test_figure_3_has_a_panel_a_stiffness_ratio_and_the_inset(made, evidence):
    soft, stiff, inset = made[3].figure.axes
    for axes, k1 in ((soft, 1.0), (stiff, 10.0)):
        assert axes.get_title() == rf"$k_1/k_0 = {k1:g}$"
        symbols = [line for line in axes.lines if line.get_marker() not in ("None", None)]
        thin = lines(axes, "-")
        assert len(symbols) == len(thin) == 3
        table = made[3].tables["growth"].query("k1 == @k1 and load == 270 and time > 0")
        np.testing.assert_allclose(symbols[2].get_xydata(), table[["time", "area_ratio"]])
        np.testing.assert_allclose(thin[2].get_xydata(), table[["time", "fitted"]])
        assert len(axes.collections) == 3
    assert inset.get_title(loc="left") == "(c)"
    assert "= 1 (a) and 10 (b), and" in made[3].caption
    assert "(c), the inset of the paper's figure" in made[3].caption
    fitted = made[3].tables["fits"].groupby("k1")
    for (places, _, symbols), (k1, fits) in zip(drawn(inset), fitted, strict=True):
        np.testing.assert_allclose(places, fits[["load_per_site", "q"]])
        assert (symbols.get_markerfacecolor() == "none") == (k1 == 10)
    assert slope(lines(inset, ":")[0]) == pytest.approx(0.5)


def test_figure_5_counts_sites(made, evidence):
    [axes] = made[5].figure.axes
    raw = evidence["self_affine_load"]
    states = product(raw["size"].values, ("initial_area", "relaxed_area"))
    for (places, _, symbols), (size, name) in zip(drawn(axes), states, strict=True):
        means = raw[name].sel(size=size).mean("seed")
        np.testing.assert_allclose(places, np.column_stack([raw["load"], means]))
        assert (symbols.get_markerfacecolor() == "none") == (name == "relaxed_area")
    level = [y for _, y in (line.get_data() for line in axes.lines) if len(y) == 2 and y[0] == y[1]]
    assert [y[0] for y in level] == [16**2, 32**2, 64**2]
    [reference] = lines(axes, ":")
    assert slope(reference) == pytest.approx(0.8)
    means = raw["initial_area"].mean("seed").isel(size=0, load=0)
    assert 0.2 < reference.get_ydata()[0] / float(means) < 0.6  # beside the points, not on them


def test_figure_6_raw_and_normalized(made, evidence):
    raw_axes, scaled_axes = made[6].figure.axes
    assert raw_axes.get_title() == "$k_1/k_0 = 10$"
    raw = evidence["self_affine_aging"]["area"].mean("seed").sel(k1=10.0)
    for line, (load, size) in zip(raw_axes.lines, product(raw["load"], raw["size"]), strict=True):
        values = raw.sel(load=load, size=size)[1:]
        np.testing.assert_allclose(line.get_xydata(), np.column_stack([TIMES[1:], values]))
    fits = made[6].tables["fits"]  # the areas stop growing at 1e4, and the fit must not see that
    np.testing.assert_allclose(fits[["k1", "C", "t0"]], [[3, 0.3, 1 / 3], [10, 1, 0.1]], rtol=1e-4)
    dashed = lines(scaled_axes, "--")
    assert len(dashed) == 2
    assert dashed[1].get_ydata()[-1] == pytest.approx(1 + math.log1p(1e7), rel=1e-4)
    bars = list(drawn(scaled_axes))
    assert len(bars) == 6
    assert min(place[0, 0] for place, _, _ in bars) > TIMES[-1]
    assert "0.30 for 3, 1.00 for 10" in made[6].caption
    assert len({symbols.get_marker() for _, _, symbols in bars}) == 3  # gray print needs a shape a load
    assert len({symbols.get_markerfacecolor() == "none" for _, _, symbols in bars}) == 2  # and a fill a size
    curves = [line for line in scaled_axes.lines if len(line.get_xdata()) == len(TIMES) - 1]
    marked = [line for line in curves if line.get_marker() != "None"]
    turns = Counter(line.get_markevery() for line in marked)
    assert sorted(turns) == [(turn, 6) for turn in range(6)]  # no symbol of a load and size hides another's
    assert set(turns.values()) == {2}  # stiffness ratios
    bottom, top = scaled_axes.get_ylim()
    for label in scaled_axes.texts:
        x, y = label.xy
        assert x > TIMES[-1]  # right of all symbols
        assert bottom < y < top
        assert all(abs(y - end) > 0.01 * top for place, _, _ in bars for end in place[:, 1])


def test_indentation_agrees_with_the_closed_form_with_and_without_viscous_creep(evidence):
    table = indentation(evidence)
    assert len(table) == 4 * len(POINT_TIMES)
    # The steps' errors: rtol is 2e-3 of the deformation; at time 0 there are none.
    assert table["deviation"].abs().max() < 2e-3
    assert table[table["time"] == 0]["deviation"].abs().max() < 1e-9
    # Value of G(3, 0) on the endless lattice: 1 / (k_eff/k0), a complete elliptic integral.
    start = table.query("k1 == 3 and R_viscous == 0.5 and time == 0").iloc[0]
    assert start["plane"] == pytest.approx(1 / float(asp.theory.site_stiffness(3.0)), rel=1e-12)
    assert start["lattice"] == pytest.approx(start["plane"], rel=1e-6)
    # With viscous creep the body follows u0: the mean of u0 alone would not tell.
    late = table.query("k1 == 3 and R_viscous == 0.5").iloc[-1]
    assert late["depth"] > 0.5 * late["time"] / late["sites"]


def test_figure_8_shows_theory_and_simulation(made, evidence):
    above, below = made[8].figure.axes
    theory = made[8].tables["theory"]
    assert sorted(theory["x1"].unique()) == [0.1, 1, 3, 10, 100]
    late = theory[theory["x2"] == theory["x2"].max()].set_index("x1")["G"]
    # The leading terms for every x1, and the next: (4 - x1)/(64 x1 sqrt(pi x2)).
    leading = (math.log(1e8) + 10 * math.log(2) + np.euler_gamma) / (8 * math.pi)
    for x1 in (1.0, 3.0, 10.0):
        following = (4 - x1) / (64 * x1 * math.sqrt(math.pi * 1e8))
        assert late[x1] == pytest.approx(leading + following, abs=1e-9)
    [dotted] = lines(above, ":")
    law = (np.log(dotted.get_xdata()) + 10 * math.log(2) + np.euler_gamma) / (8 * math.pi)
    np.testing.assert_allclose(dotted.get_ydata(), law)
    simulated = made[8].tables["simulated"]
    assert set(simulated["R_viscous"]) == {0.0}
    deviations = np.sort(np.concatenate([line.get_ydata() for line in below.lines]))
    np.testing.assert_allclose(deviations, np.sort(simulated.query("time > 0")["deviation"].abs()))
    shown = [line for line in above.lines if line.get_marker() not in ("None", None)]
    on_paper = np.sort(np.concatenate([line.get_ydata() for line in shown]))
    kept = simulated[simulated["drawn"]]
    np.testing.assert_allclose(on_paper, np.sort(kept["depth"]))
    assert ((kept["lattice"] / kept["plane"] - 1).abs() <= 0.01).all()
    keys = {line.get_marker() for line in above.get_legend().findobj(Line2D)} - {"None", ""}
    assert keys == {line.get_marker() for line in shown}


def test_figure_9_has_twice_the_slope_with_viscous_creep(made):
    [axes] = made[9].figure.axes
    steep, flat = lines(axes, ":")
    assert {text.get_text() for text in axes.texts} == {r"slope $1/(4\pi)$", r"slope $1/(8\pi)$"}
    assert slope(flat, y_scale=np.asarray) == pytest.approx(1 / (8 * math.pi))
    assert slope(steep, y_scale=np.asarray) == pytest.approx(1 / (4 * math.pi))
    theory = made[9].tables["theory"]
    assert sorted(theory["R_viscous"].unique()) == [0, 0.01, 0.1, 0.5, 1, 10]
    for r, expected in ((0.0, 1 / (8 * math.pi)), (10.0, 1 / (4 * math.pi))):
        late = theory[theory["R_viscous"] == r].iloc[-2:]
        assert np.diff(late["depth"]) / np.diff(np.log(late["x2"])) == pytest.approx(expected, rel=1e-4)


def test_figure_9_draws_the_lattice_only_while_it_stands_for_the_plane(made):
    simulated = made[9].tables["simulated"]
    assert set(simulated["k1"]) == {3.0}
    shown = simulated[simulated["drawn"]]
    assert ((shown["depth"] / shown["plane"] - 1).abs() < 0.015).all()
    [axes] = made[9].figure.axes
    on_paper = [line.get_ydata() for line in axes.lines if line.get_marker() not in ("None", None)]
    np.testing.assert_allclose(np.sort(np.concatenate(on_paper)), np.sort(shown["depth"]))
    # 24 sites: the dip of width (r t)^(1/2) or t^(1/4) comes round before the end in the one case only.
    last = simulated[simulated["time"] == POINT_TIMES[-1]].set_index("R_viscous")
    assert not last.loc[0.5, "drawn"]
