"""Figures: what is drawn is what analysis found, and a reader is told what it is."""

import dataclasses
import functools
import io
import math
from typing import Any

import matplotlib.colors
import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg

from asperity import History, age, figures, predict, press, relax
from asperity.analysis import aging_summary, contact_maps, distributions, with_limit
from asperity.analysis.aging import AgingSummary
from asperity.analysis.maps import ContactMaps, SiteState
from asperity.base.readable import written
from asperity.base.words import power
from asperity.figures.contacts import COLORS
from asperity.figures.surface import SurfaceView
from asperity.figures.writing import table_of
from asperity.fits import measured_growth
from asperity.protocols import Hold, Leg, Ramp, Repeat, Slide, Step
from asperity.solids import half_space, spring_lattice
from asperity.surfaces import Surface, gaussian, spectral
from asperity.theory import GaussianHeights
from tests.refusals import each_refuses

LONG_NAME = "after_polish_position_B2_" * 3 + "sample_7_channel_1_second_scan.opd"
GROWTH = measured_growth(np.geomspace(1, 1e4, 9), 1 + 0.1 * np.log(np.geomspace(1, 1e4, 9)))


@functools.cache
def history(*shape: int) -> xr.Dataset:
    contact = press(gaussian(shape), spring_lattice(k0=1.0, k1=3.0), load=0.02 * math.prod(shape))
    times = np.geomspace(1e-2, 100, 9)
    return with_limit(age(contact, times, fields_at=[0.0, 1.0, 100.0], rtol=1e-2).dataset, relax(contact))


@pytest.fixture(scope="module")
def aged() -> xr.Dataset:
    return history(64, 64)


@pytest.fixture(scope="module")
def summary(aged: xr.Dataset) -> AgingSummary:
    return aging_summary(aged, law=GaussianHeights())


def test_the_aging_curve_draws_the_numbers(aged: xr.Dataset, summary: AgingSummary) -> None:
    figure = figures.aging_curve(aged, summary)
    axes = figure.axes[0]
    markers = next(line for line in axes.lines if line.get_marker() == "o")
    np.testing.assert_array_equal(markers.get_xydata(), np.transpose([summary.time, summary.area_ratio]))
    drawn = {line.get_linestyle(): np.asarray(line.get_ydata()) for line in axes.lines}
    np.testing.assert_array_equal(drawn["-"], summary.fit_curve)
    np.testing.assert_array_equal(drawn["--"], summary.dilute_ratio)
    np.testing.assert_array_equal(drawn[":"], [summary.relaxed_ratio] * 2)
    assert axes.get_xscale() == "log"
    assert "hold time" in axes.get_xlabel()
    assert "A(t)" in axes.get_ylabel()
    assert "load 81.92 held" in figure.get_suptitle()
    (right,) = axes.child_axes
    assert "% of nominal area" in right.get_ylabel()
    figure.draw_without_rendering()
    share = 100 * summary.initial_area / summary.sites
    assert right.get_ylim() == pytest.approx([share * end for end in axes.get_ylim()])


@pytest.fixture(scope="module")
def separated() -> xr.Dataset:
    """A held separation: the load falls."""
    solid = spring_lattice(k0=1.0, k1=3.0, R_viscous=0.1)
    contact = press(Surface(gaussian((32, 32)), provenance={"file": LONG_NAME}), solid, separation=1.5)
    history = age(contact, np.geomspace(1e-2, 1e3, 11), fields_at=[0.0, 1e3], rtol=1e-2)
    return with_limit(history.dataset, relax(contact))


def test_the_load_is_drawn_where_the_separation_is_held(separated: xr.Dataset) -> None:
    figure = figures.aging_curve(separated, aging_summary(separated))
    lower = figure.axes[1]
    assert "load" in lower.get_ylabel()
    drawn = {f"{line.get_marker()}{line.get_linestyle()}": line.get_ydata() for line in lower.lines}
    load = separated["load"].values
    np.testing.assert_array_equal(drawn["oNone"], load[1:] / load[0])
    np.testing.assert_array_equal(drawn["None:"], [separated.attrs["relaxed_load"] / load[0]] * 2)
    assert "after_polish_position_B2" in figure.get_suptitle()
    assert "R_viscous = 0.1" in figure.get_suptitle()


def test_maps_color_every_site_in_colors_that_differ_in_gray(aged: xr.Dataset) -> None:
    palette = {SiteState.FREE: "white", **COLORS}
    maps = contact_maps(aged)
    panels = [axes for axes in figures.contact_figure(maps).axes if "sites" in axes.get_title()]
    assert len(panels) == len(maps.times)
    for number, axes in enumerate(panels):
        shown = np.asarray(axes.images[0].get_array())
        for state, color in palette.items():
            colored = np.isclose(shown, matplotlib.colors.to_rgb(color)).all(axis=-1)
            np.testing.assert_array_equal(colored, maps.states[number] == state)
    assert f"{maps.area(0)} sites" in panels[0].get_title()
    assert "relaxed" in panels[-1].get_title()
    # Relative luminance, Rec. 709.
    gray = [np.dot([0.2126, 0.7152, 0.0722], matplotlib.colors.to_rgb(color)) for color in palette.values()]
    assert np.diff(np.sort(gray)).min() > 0.15


def some_maps(states: np.ndarray, **options: Any) -> ContactMaps:
    maps = ContactMaps(
        heights=np.zeros(states.shape[1:]),
        indentation=np.zeros(states.shape[1:]),
        times=np.arange(float(len(states))),
        states=states.astype(np.int8),
        surfaces=np.zeros(states.shape),
        height_range=(-1.0, 1.0),
        window=(0, states.shape[1]),
        unit="1",
    )
    return dataclasses.replace(maps, **options)


SCANNED: dict[str, Any] = {"copies": 4, "pixel_size": 0.25, "length_unit": "um"}


@pytest.mark.parametrize(("sites", "fraction"), [(60, 0.3), (300, 0.02), (2048, 0.01)])
def test_the_ink_of_a_map_is_the_contact_fraction(sites: int, fraction: float) -> None:
    states = (np.random.default_rng(0).random((1, sites, sites)) < fraction).astype(int)
    figure = figures.contact_figure(some_maps(states))
    canvas = FigureCanvasAgg(figure)
    figure.set_dpi(figures.style.RESOLUTION)
    canvas.draw()
    box = figure.axes[1].get_window_extent()
    pixels = np.asarray(canvas.buffer_rgba())[::-1, :, 0] / 255
    inside = pixels[int(box.y0) + 4 : int(box.y1) - 4, int(box.x0) + 4 : int(box.x1) - 4]
    assert 1 - float(inside.mean()) == pytest.approx(fraction, rel=0.1)
    # Marks are to be seen: colors of sites smaller than a pixel would thin to nothing.
    assert float(inside.min()) < 0.3


def test_a_scan_has_a_scale_and_says_that_it_is_mirrored() -> None:
    figure = figures.contact_figure(some_maps(np.ones((1, 40, 60)), **SCANNED))
    assert "40 × 60 sites of 250 nm" in figure.get_suptitle()
    assert "the scan is mirrored: one of 4 copies is shown" in figure.get_suptitle()
    topography = figure.axes[0]
    assert [text.get_text().strip() for text in topography.texts] == ["5 µm"]
    assert np.ptp(np.asarray(topography.lines[-1].get_xdata())) == pytest.approx(20)
    line = some_maps(np.ones((1, 40)), **SCANNED | {"copies": 2, "window": (0, 40)})
    lower = figures.contact_figure(line).axes[1]
    assert lower.get_xlabel() == "position [µm]"
    assert "one of 2 copies" in lower.get_title()
    assert lower.get_xlim() == pytest.approx((-0.125, 9.875))


@pytest.mark.parametrize("shape", [(128, 96), (512,)])
def test_a_surface_and_its_spectrum_are_drawn_in_readable_units(shape: tuple[int, ...]) -> None:
    size = (2e-7, 1e-7)[: len(shape)]
    heights = spectral(shape, spacing=size, cutoff=4e-7, rms_height=3e-9, seed=2)
    same = Surface(1e9 * heights, "nm", tuple(1e6 * d for d in size), "um")
    surfaces = Surface(heights, "m", size, "m"), same
    drawn, known = (figures.surface_figure(one, title="scan.npy", note="3 pixels filled") for one in surfaces)
    labels = {label for axes in drawn.axes for label in (axes.get_xlabel(), axes.get_ylabel())}
    power = "[nm² µm²]" if len(shape) == 2 else "[nm² µm]"
    assert labels > {"height [nm]", "position [µm]", "wave number q [1/µm]", f"power spectrum C(q) {power}"}
    assert drawn.get_suptitle() == "scan.npy\n3 pixels filled"
    for axes, expected in zip(drawn.axes, known.axes, strict=True):
        assert axes.get_legend_handles_labels()[1] == expected.get_legend_handles_labels()[1]
        for curve, other in zip(axes.lines, expected.lines, strict=True):
            points, expected_points = (np.asarray(one.get_xydata()) for one in (curve, other))
            np.testing.assert_allclose(points, expected_points, atol=1e-9)
        for image, other_image in zip(axes.images, expected.images, strict=True):
            np.testing.assert_allclose(np.asarray(image.get_array()), 1e9 * heights)
            assert image.get_extent() == pytest.approx(other_image.get_extent())


def test_a_figure_shows_the_measured_part_of_a_surface() -> None:
    measured = gaussian((30, 20), rms=5e-9, seed=2)
    mirrored = np.pad(measured, ((0, 30), (0, 20)), mode="symmetric")
    origin = {"original_shape": [30, 20], "periodic_rule": "mirror"}
    view = SurfaceView(Surface(mirrored, "m", (1e-7, 2e-7), "m", origin))
    np.testing.assert_allclose(view.heights, measured * 1e9)
    position, profile = view.profile()
    np.testing.assert_array_equal(profile, view.heights[15])
    np.testing.assert_allclose(position[:2], [0.1, 0.3])
    edges, density, _ = view.histogram()
    assert float(np.sum(density * np.diff(edges))) == pytest.approx(1.0)
    bare = SurfaceView(Surface(1e-6 * gaussian((6, 9), seed=1)))  # counts in pixels
    assert (bare.unit, bare.length_unit) == ("1e-06", "pixel")
    np.testing.assert_allclose(bare.heights, gaussian((6, 9), seed=1))
    figures.surface_figure(Surface(np.zeros((4, 4))), title="flat").draw_without_rendering()


def long_history(*, repeats: int) -> xr.Dataset:
    """A history of which there is much to say."""
    solid = spring_lattice(k0=1.0, k1=3.0, R_viscous=0.1)
    contact = press(Surface(gaussian((16, 16)), provenance={"file": LONG_NAME}), solid, load=123.456789)
    held, ramp = Hold(12.3456789, hold="separation", mobility=123.456789), Ramp(12.3456789, load=1e-4 / 3)
    legs: list[Leg] = [Step(load=100.123456), held, Step(separation=-1.23456789), ramp, Step(load=123.456789)]
    end = repeats * 2 * 12.3456789
    return age(contact, np.geomspace(0.01, end, 30), protocol=[Repeat(legs, repeats)], rtol=1e-2).dataset


@pytest.mark.slow
def test_everything_is_on_the_canvas(aged: xr.Dataset, separated: xr.Dataset) -> None:
    """Every kind of figure, with the longest words that it may meet."""
    many = dataclasses.replace(contact_maps(separated), **SCANNED)
    named = Surface(1e-6 * gaussian((30, 90)), provenance={"file": LONG_NAME})
    note = "512 × 512 pixels, 1234567 undefined pixels filled, plane removed, mirrored to 1024 × 1024 at last"
    drawn = {
        "load held": figures.aging_curve(aged, aging_summary(aged)),
        "separation held": figures.aging_curve(separated, aging_summary(separated)),
        "maps": figures.contact_figure(contact_maps(aged)),
        "one map": figures.contact_figure(some_maps(np.full((1, 700, 600), 3), **SCANNED)),
        "high map": figures.contact_figure(some_maps(np.full((2, 900, 30), 2), **SCANNED)),
        "wide map": figures.contact_figure(some_maps(np.full((2, 30, 900), 2), **SCANNED)),
        "maps of a scan": figures.contact_figure(many),
        "line": figures.contact_figure(contact_maps(history(300))),
        "surface": figures.surface_figure(named, title=LONG_NAME, note=note),
        "profile": figures.surface_figure(Surface(gaussian(64), "nm"), title=LONG_NAME, note=note),
        "history": figures.history_figure(long_history(repeats=3)),
        "history of many legs": figures.history_figure(long_history(repeats=4)),
        "patches": figures.patch_figure(aged),
        "patches that slip off": figures.patch_figure(separated),
        "fit": figures.fit_figure(GROWTH, quantity=LONG_NAME * 3, unit_time=LONG_NAME, window=True),
    }
    for name, figure in drawn.items():
        assert isinstance(figure, figures.style.Drawing), name
        figure.draw_without_rendering()
        box = figure.get_tightbbox()
        width, height = figure.get_size_inches()
        assert min(box.x0, box.y0) > 0, name
        assert (box.x1 < width, box.y1 < height) == (True, True), name


def test_numbers_and_units_are_written_as_mathematics() -> None:
    said = {0.0: "0", 0.25: "0.25", 1000.0: "1000", 1e6: "10^{6}", 1e-5: "10^{-5}", math.inf: r"\infty"}
    said[1.78e4] = r"1.8 \times 10^{4}"
    assert {value: power(value) for value in said} == said
    labels = [figures.style.with_unit("height", unit) for unit in ("1", "um", "1e-06")]
    assert labels == ["height", "height [µm]", "height [$10^{-6}$ units]"]
    spelled = [
        figures.style.spelled(unit) for unit in ("um^2", "nm^3", "um/s", "K", "uN", "MPa", "rms", "unit")
    ]
    assert spelled == ["µm²", "nm³", "µm/s", "K", "µN", "MPa", "rms height", "unit"]
    assert figures.style.spaced("62 um^2") == "62\u00a0µm²"
    assert figures.style.spaced("62") == "62"


def test_a_value_is_written_with_a_prefix_in_si_and_as_it_is_elsewhere() -> None:
    for value, unit, text in (
        (1.5e6, "Pa", "1.5 MPa"),
        (-2e-6, "N", "-2 uN"),
        (0.0, "N", "0 N"),
        (2.5e-4, "m^2", "250 mm^2"),
        (1e-13, "m^2", "0.1 um^2"),
        (9.9e-14, "m^2", "99000 nm^2"),
        (1e-30, "m^2", "1e-30 m^2"),
        (1e7, "s", "1e+07 s"),
        (0.01, "s", "10 ms"),
        (1e-6, "1", "1e-06"),
        (math.inf, "N/m", "infinite"),
        (122.88, "stiffness unit * height unit", "122.9"),
        (7e-21, "m/s", "7e-21 m/s"),
        (5e-28, "m^3", "0.5 nm^3"),
        (2e-17, "m^3", "20 um^3"),
        (2e-15, "J", "0.002 pJ"),
        (1.2, "eV", "1.2 eV"),
        (300.0, "K", "300 K"),
        (0.0, "m/s", "0 m/s"),
    ):
        assert written(value, unit) == text


def test_names_from_outside_are_not_read_as_mathematics() -> None:
    figure = figures.fit_figure(GROWTH, quantity=r"$\frac{1}$", unit_time=r"$\foo$", window=False)
    figure.savefig(io.BytesIO())
    assert figure.axes[0].get_ylabel() == r"\$\frac{1}\$"


def gathered(loads: int, moduli: int, seeds: int) -> xr.Dataset:
    """What `asperity.campaign.open` gives of a study over load and k1; the means are known."""
    times = np.r_[0.0, np.geomspace(0.1, 100.0, 4)]
    load, k1 = np.arange(1.0, loads + 1), np.arange(1.0, moduli + 1)
    mean = 0.01 * load[:, None, None] * k1[:, None] * (1 + np.log1p(times))
    data = xr.Dataset(coords={"load": load, "k1": k1, "seed": np.arange(seeds), "time": times})
    data["contact_fraction_mean"] = (("load", "k1", "time"), mean)
    data["contact_fraction_stderr"] = 0.1 * data["contact_fraction_mean"]
    return data.assign_attrs(runs=loads * moduli * seeds, finished=loads * moduli * seeds)


def test_a_campaign_shows_the_mean_of_each_point_and_its_standard_error() -> None:
    figure = figures.campaign_figure(gathered(3, 2, 6))
    assert [axes.get_title() for axes in figure.axes] == ["k1 = 1", "k1 = 2"]
    curve = figure.axes[1].lines[2]  # k1 = 2, load = 3
    assert curve.get_label() == "load = 3"
    times, area = (np.asarray(values) for values in curve.get_data())
    np.testing.assert_allclose(area, 100 * 0.06 * (1 + np.log1p(times)))
    edges = np.asarray(figure.axes[1].collections[2].get_paths()[0].vertices)[:, 1]
    assert edges.max() == pytest.approx(1.1 * 6 * (1 + np.log1p(100.0)))
    assert edges.min() == pytest.approx(0.9 * 6 * (1 + np.log1p(0.1)))
    assert "mean of 6 seeds ± standard error" in figure.get_suptitle()
    assert "drawn" not in figure.get_suptitle()
    names = next(line for line in table_of(figure).splitlines() if line[0] != "#")
    assert '"k1 = 1, load = 1: real contact [% of nominal area]"' in names


def test_a_campaign_of_many_points_shows_some_and_says_so() -> None:
    figure = figures.campaign_figure(gathered(20, 9, 3))
    assert [len(axes.lines) for axes in figure.axes if axes.lines] == [7] * 6
    assert {"6 of 9 panels drawn", "7 of 20 curves a panel drawn"} <= set(
        figure.get_suptitle().replace("\n", ", ").split(", ")
    )
    (axes,) = figures.campaign_figure(gathered(1, 1, 1).isel(load=0, k1=0)).axes
    assert (len(axes.lines), axes.get_title()) == (1, "")


@pytest.fixture(scope="module")
def yielded() -> History:
    solid = spring_lattice(k0=1.0, k1=3.0, hardness=2.0)
    legs = [Hold(1.0), Slide(3.0, velocity=1.0), Step(load=0.5), Hold(1.0)]
    contact = press(gaussian((24, 24)), solid, load=60.0)
    return age(contact, [1.0], fields_at=[0.0, 2.0, 4.0, 5.0], protocol=legs)


def test_maps_show_what_has_yielded_where_it_has_slid(yielded: History) -> None:
    maps = contact_maps(yielded.dataset)
    figure = figures.contact_figure(maps)
    titles = [axes.get_title().split(":")[0] for axes in figure.axes[1:6] if axes.get_title()]
    assert titles[:3] == ["$t$ = $0$", "$t$ = $2$, just before", "$t$ = $2$, just after"]
    lower = np.roll(yielded.dataset["permanent_indentation"].values[-1], -3, axis=1)
    np.testing.assert_array_equal(maps.indentation, lower)
    drawn = np.asarray(figure.axes[0].images[1].get_array())
    np.testing.assert_array_equal(drawn[..., 3] > 0, lower > 0)
    assert f"{lower.max():.2g}" in figure.axes[0].get_title()
    assert "rough surface has yielded" in [text.get_text() for text in figure.legends[0].texts]


def test_a_profile_shows_what_has_yielded_and_where_it_touches_now() -> None:
    solid = spring_lattice(k0=1.0, k1=3.0, hardness=1.0)
    profile = age(press(gaussian((64,)), solid, load=10.0), [1.0], fields_at=[0.0, 1.0])
    upper = figures.contact_figure(contact_maps(profile.dataset)).axes[0]
    assert "has yielded" in upper.get_legend_handles_labels()[1]
    (touches,) = (line for line in upper.lines if line.get_label() == "contact at the end")
    heights = profile.final.heights[profile.final.in_contact]
    np.testing.assert_allclose(np.asarray(touches.get_ydata()), heights, rtol=0, atol=1e-12)


def test_gaps_are_above_the_surface_where_it_has_slid_and_yielded(yielded: History) -> None:
    assert yielded.dataset["field_shift_x"][-1] == 3
    *_, last = found = distributions(yielded.dataset)
    assert min(one.gap.min() for one in found) > 0
    final = yielded.final
    assert final.permanent_indentation[~final.in_contact].max() > 0.1
    np.testing.assert_allclose(last.gap, np.sort(final.gap[~final.in_contact]), rtol=0, atol=1e-12)


def test_the_figure_of_patches_shows_their_series(aged: xr.Dataset, yielded: History) -> None:
    number, size, growth, age_of_contact = figures.patch_figure(aged).axes
    drawn = [line.get_xydata() for line in (*number.lines, *size.lines)]
    names = ["patches", *(f"{which}_patch_size" for which in ("largest", "mean", "median"))]
    time = aged["field_time"].values
    np.testing.assert_array_equal(drawn, [np.transpose([time, aged[name].values]) for name in names])
    np.testing.assert_array_equal(age_of_contact.lines[0].get_ydata(), aged["contact_age"].sel(quantile=0.5))
    gains = [aged[f"gained_by_{how}"].sum() for how in ("expansion", "coalescence", "births")]
    tops = [part.get_paths()[0].get_extents().y1 for part in growth.collections]
    assert tops[:3] == np.cumsum(gains).tolist()
    assert growth.get_xscale() == "symlog"
    lost = sum(yielded.dataset[f"lost_by_{how}"].sum() for how in ("shrinkage", "deaths"))
    lowest = figures.patch_figure(yielded.dataset).axes[2].collections[-1].get_paths()[0].get_extents().y0
    assert lowest == -lost < 0


def test_the_figure_of_distributions_shows_which_part_has_more() -> None:
    heights = spectral((32, 32), hurst=0.8, spacing=1e-6, rms_slope=0.1, seed=1)
    solid = half_space(modulus=3e9, branches=[(0.5, 1.0)])
    contact = press(Surface(heights, "m", (1e-6, 1e-6), "m"), solid, pressure=5e6)
    data = age(contact, [10.0], fields_at=[0.0, 10.0]).dataset
    *_, last = distributions(data)
    assert (last.time, last.patch.sum()) == (10.0, int(data["area"][-1]))
    figure = figures.distribution_figure(data)
    labels = [axes.get_xlabel() for axes in figure.axes]
    assert labels == ["gap [µm]", "area of a patch [µm²]", "contact pressure [MPa]"]
    gap, patch, pressure = figure.axes
    assert [line.get_label() for line in gap.lines] == ["$t$ = $0$ s", "$t$ = $10$ s"]
    levels, above = (np.asarray(values) for values in gap.lines[-1].get_data())
    gaps = 1e6 * (data["u"] - data["heights"]).values[-1]
    assert last.gap.size == gaps.size - int(data["area"][-1])
    for k in (0, 100, -1):
        assert above[k] == pytest.approx(np.mean(gaps >= levels[k] * (1 - 1e-12)))
    assert np.asarray(patch.lines[0].get_ydata())[0] == 1.0
    assert patch.get_xscale() == patch.get_yscale() == "log"
    pressures, above = (np.asarray(values) for values in pressure.lines[0].get_data())
    mean = pressures[0] + np.sum(np.diff(pressures) * above[1:])  # the mean is the integral of the part above
    assert mean == pytest.approx(float(data["mean_contact_pressure"][0]) / 1e6)


def test_what_cannot_be_drawn_is_refused(aged: xr.Dataset) -> None:
    at_once = aged.isel(time=[0]).drop_dims("field_time")
    without = aged.drop_dims("field_time")
    each_refuses(
        ("summary", figures.aging_curve, at_once, aging_summary(at_once)),
        ("dataset", figures.history_figure, at_once),
        *(("dataset", figures.patch_figure, few) for few in (aged.isel(field_time=[0]), without)),
        ("dataset", distributions, without),
        *(
            ("dataset", figures.campaign_figure, one)
            for one in (aged.drop_vars("contact_fraction"), aged.drop_vars("time"), 3)
        ),
        got="none | none | 1 | 0 | none | another | another | int",
    )


@pytest.mark.parametrize("pixel", [0.014, 0.14, 14.0, 40.0])
def test_areas_of_a_prediction_have_the_unit_of_its_text(pixel):
    rough = spectral((32, 32), pixel_size=pixel, unit="um", rms_slope=0.1, seed=1)
    solid = half_space(modulus="2.4 MPa", branches=[(0.3, "1 s")])
    prediction = predict(solid, rough, pressure="40 kPa", first="0.1 s", last="10 s")
    text = written(float(prediction.series("contact_area").max()), "m^2").split()[1]
    label = prediction.plot("area").get_ylabel()
    assert label.endswith(f"[{text.replace('u', 'µ').replace('^2', '²')}]")
