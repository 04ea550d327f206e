"""The sketch and the maps: what is drawn is what was simulated."""

import math
import re

import matplotlib.colors
import numpy as np
import pytest
import xarray as xr
from matplotlib.patches import Rectangle
from matplotlib.text import Text

from asperity import age, press, relax
from asperity.analysis import clustering, contact_maps, patches, turnover, with_limit
from asperity.figures import style
from asperity.solids import spring_lattice
from asperity.surfaces import gaussian, self_affine
from asperity_research.paper.figures.maps import figure_4, figure_7
from asperity_research.paper.figures.paper_figure import PAGE
from asperity_research.paper.figures.sketch import figure_1

SIZE = 32
TIMES = [0.0, 1.0, 100.0]


class InMemory:
    """Studies that were never on a disk: the runs of each, by load or by seed."""

    def __init__(self, **runs):
        self.runs = runs

    def __getitem__(self, study):
        seeds = [0] if study == "load_maps" else list(self.runs[study])
        load = next(iter(self.runs[study].values()))["load"].values[:1]
        return xr.Dataset({"load": (("seed", "time"), [load] * len(seeds))}, coords={"seed": seeds})

    def values(self, study, name):
        return list(self.runs[study])

    def fields(self, study, seed, load=None):
        return self.runs[study][seed if load is None else load]


def history(heights, times, k1=10.0, load=3.0):
    contact = press(heights, spring_lattice(k0=1.0, k1=k1), load=load)
    return with_limit(age(contact, times[1:], fields_at=times, rtol=1e-2).dataset, relax(contact))


@pytest.fixture(scope="module")
def evidence():
    rough = [self_affine(SIZE, hurst=0.5, delta=0.01, seed=seed) for seed in range(3)]
    return InMemory(
        sketch={0: history(gaussian((32,)), [0.0, 100.0], k1=1.0, load=10.0)},
        load_maps={load: history(rough[0], [0.0, 0.01], load=load) for load in (3.0, 30.0, 300.0)},
        maps={seed: history(heights, TIMES) for seed, heights in enumerate(rough)},
    )


@pytest.fixture(scope="module")
def made(evidence):
    return [figure_1(evidence), figure_4(evidence), figure_7(evidence)]


def points(axes, color):
    """Columns and rows of the square marks of a color."""
    wanted = matplotlib.colors.to_rgba(color)
    return {
        (int(x), int(y))
        for marks in axes.collections
        if np.allclose(marks.get_facecolor()[0], wanted)
        for x, y in np.asarray(marks.get_offsets())
    }


def listed(table, **where):
    for name, value in where.items():
        table = table[table[name] == value]
    return set(zip(table["x"].tolist(), table["y"].tolist(), strict=True))


def sites_of(mask):
    rows, columns = np.nonzero(mask.values)
    return set(zip(columns.tolist(), rows.tolist(), strict=True))


def panel(drawn, title):
    (axes,) = [
        axes for axes in drawn.figure.axes if title in axes.get_title() or title in axes.get_title("left")
    ]
    return axes


def test_the_sketch_draws_the_simulated_line(evidence, made):
    sketch = made[0]
    run = evidence.fields("sketch", seed=0)
    table = sketch.tables["sites"]
    assert sketch.number == 1
    assert list(table["state"].unique()) == ["before contact", "0", "100"]
    for index, state in enumerate(("0", "100")):
        here = table[table["state"] == state]
        for name in ("u", "u0", "in_contact"):
            np.testing.assert_array_equal(here[name], run[name][index])
        axes = panel(sketch, f"({'bc'[index]})")
        touching = run["in_contact"][index].values
        diamonds = next(line for line in axes.lines if line.get_marker() == "D")
        np.testing.assert_array_equal(diamonds.get_xdata(), np.flatnonzero(touching))
        np.testing.assert_array_equal(diamonds.get_ydata(), run["u"][index].values[touching])
        tops = [bar.get_y() + bar.get_height() for bar in axes.patches if isinstance(bar, Rectangle)]
        np.testing.assert_allclose(tops, run["heights"], rtol=1e-12)
        # Circles stand above u0 by one length, and above u at every site: each spring has a length.
        circles = np.asarray(next(line for line in axes.lines if line.get_marker() == "o").get_ydata())
        assert np.ptp(circles - run["u0"][index].values) < 1e-12
        assert (circles > run["u"][index].values).all()
    before = table[table["state"] == "before contact"]
    assert (before["u"] > before["xi"].max()).all()
    assert (before["u"] == before["u0"]).all()


def test_the_load_maps_mark_every_site_in_contact(evidence, made):
    load_maps = made[1]
    loads = evidence.values("load_maps", "load")
    for letter, load in zip("bcd", loads, strict=True):
        touching = evidence.fields("load_maps", load=load, seed=0)["in_contact"][0]
        axes = panel(load_maps, f"({letter})")
        assert points(axes, style.INK) == sites_of(touching)
        assert listed(load_maps.tables["contacts"], load=load) == sites_of(touching)
        assert f"F_N/k_0 = {load:g}" in axes.get_title()
        assert f"$A$ = {int(touching.sum())}" in axes.get_title()
        # The sites themselves lie below the marks, so that no seams show between these.
        sites = np.asarray(axes.images[-1].get_array())
        np.testing.assert_array_equal(sites[..., 3] > 0, touching.values)
    heights = evidence.fields("load_maps", load=loads[0], seed=0)["heights"].values
    topography = load_maps.tables["topography"]
    np.testing.assert_array_equal(topography["height"], heights[topography["y"], topography["x"]])
    image = panel(load_maps, "(a)").images[0]
    np.testing.assert_array_equal(image.get_array(), heights)
    assert image.get_clim() == (heights.min(), heights.max())
    assert f"{SIZE} × {SIZE} sites" in load_maps.caption


def test_the_aging_maps_mark_what_came_and_went(evidence, made):
    maps = made[2]
    run = evidence.fields("maps", seed=0)
    first = run["in_contact"][0]
    states = [*run["in_contact"], run["in_contact_relaxed"]]
    assert (first & ~states[-1]).any()  # some sites are lost, or nothing would be tested
    for letter, time, now in zip("abcd", [*TIMES, math.inf], states, strict=True):
        axes = panel(maps, f"({letter})")
        expected = {"kept": first & now, "new": ~first & now, "lost": first & ~now}
        for state, mask in expected.items():
            assert listed(maps.tables["contacts"], state=state, time=time) == sites_of(mask)
        assert points(axes, style.INK) == sites_of(expected["kept"])
        assert points(axes, style.VERMILION) == sites_of(expected["new"])
        circles = next(line for line in axes.lines if line.get_marker() == "o")
        x, y = (np.asarray(values).astype(int).tolist() for values in circles.get_data())
        assert set(zip(x, y, strict=True)) == sites_of(expected["lost"])
        assert f"$A$ = {int(now.sum())}" in axes.get_title()
        for sign, change in (("+", expected["new"]), ("−", expected["lost"])):
            count = int(change.sum())
            assert (f"{sign}{count}" in axes.get_title()) == (count > 0)  # zeros are not news
    assert r"t \to \infty" in panel(maps, "(d)").get_title()


def test_the_curves_are_means_over_the_seeds(evidence, made):
    maps = made[2]
    seeds = evidence["maps"]["seed"].values
    runs = [contact_maps(evidence.fields("maps", seed=int(seed))) for seed in seeds]
    contacts = [[np.isin(states, (1, 2)) for states in run.states] for run in runs]
    counts = np.array([[patches(now).count for now in run] for run in contacts])
    index = np.array([[clustering(now, SIZE // 8) for now in run] for run in contacts])
    detached = np.array([[turnover(run[0], now).gained_detached for now in run] for run in contacts])
    ensemble = maps.tables["patches_ensemble"].set_index(["quantity", "time"])
    for name, values in (("patches", counts), ("dispersion", index), ("gained_detached", detached)):
        here = ensemble.loc[name].loc[[*TIMES, math.inf]]
        np.testing.assert_allclose(here["mean"], values.mean(axis=0), rtol=1e-12)
        np.testing.assert_allclose(here["stderr"], values.std(axis=0, ddof=1) / math.sqrt(3), rtol=1e-9)
        assert (here["seeds"] == 3).all()
    axes = panel(maps, "(e)")
    line = next(line for line in axes.lines if line.get_linestyle() == "-")
    np.testing.assert_allclose(np.asarray(line.get_ydata()), counts.mean(axis=0))
    # 0 and infinity stand a step before the first and after the last of the logarithms, which are 0 and 2.
    np.testing.assert_allclose(np.asarray(line.get_xdata(), dtype=float), [-2.0, 0.0, 2.0, 4.0])
    assert axes.get_yscale() == "log"
    assert panel(maps, "(f)").get_ylim()[0] == 0
    low, high = panel(maps, "(h)").get_ylim()
    assert low < 1 < high  # the reference: contacts strewn at random
    assert "means over 3 surfaces" in maps.caption
    assert "95 % intervals" in maps.caption


def test_figures_have_journal_width_legible_text_and_simple_tags(made):
    for drawn in made:
        assert drawn.figure.get_figwidth() == PAGE
        assert {"i", "sub"} <= set(re.findall(r"</?(\w+)>", drawn.caption)) <= {"i", "sub", "sup"}
        assert "{" not in drawn.caption
        assert min(float(text.get_fontsize()) for text in drawn.figure.findobj(Text) if text.get_text()) >= 7
